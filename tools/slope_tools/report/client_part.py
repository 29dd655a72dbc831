"""The first page of a report, which a client reads: body, number or why there is none, band, result, caveats.

No names of options, variables or files: these are in the appendix, and on the console.
"""
from typing import Any, Dict, List, Optional, Sequence

from .. import digits
from ..deposits import travel_shares
from ..ensembles import known_study
from ..statistics import headline
from . import body, road_part, structures_part, warnings
from .numbers import farthest_of

WORDS = {"rolling": "the rolling resistance", "friction": "the friction", "d": "the size of the model's balls",
         "field_d": "the roughness of the ground", "spacing": "the roughness of the ground",
         "angle": "the direction of the ground's grid",
         "restitution": "the restitution", "field_e": "the restitution", "peak": "the strength of the earthquake",
         "pga": "the strength of the earthquake", "depth": "the depth of the body", "slip": "the friction of the slip "
         "surface", "step": "the time step"}


def content(data, ground, numbers, answers: Sequence[Optional[Dict[str, Any]]], found,
            listed: int) -> Dict[str, Any]:
    """What the template takes; answers: those of the study, the first that there is counts; found: all findings.

    listed: how many warnings the appendix has.
    """
    main = next((one for one in answers if one), None)
    return {"body": body.sentence(body.of_data(data, ground)),
            "answer": of_answer(data, main, numbers) if main else of_reach(data, numbers),
            "sentences": sentences(data, ground, numbers, bool(main))
            + road_part.on_first_page(data, numbers, bool(main and main["withheld"])),
            "caveats": warnings.first_page(found, ground)[:warnings.MOST], "rest": warnings.rest_of(listed),
            "basis": basis(data)}


# --- the number ---

def of_answer(data, answer: Dict[str, Any], numbers) -> Dict[str, Any]:
    """Of an answer as the appendix has it: title, number, unit, reasons, band."""
    reasons = [one["text"] for one in answer["withheld"]]
    if reasons:
        return {"title": answer["title"], "number": None, "unit": "", "reasons": reasons, "band": ""}
    best = data.study["conservative"]
    if answer.get("zero"):
        band = f"{answer['zero'][0].upper()}{answer['zero'][1:]}."
    elif "band" in answer:
        band = f"Between {answer['band']}."
    elif best["chance_m3"] is None:
        band = "No band: no run was repeated, so that chance is unknown."
    else:
        mean, chance = (best["rounded"][key] for key in ("mean_m3", "chance_m3"))
        low, high = (headline.text(value, best["place_m3"]) for value in (max(0.0, mean - chance), mean + chance))
        band = f"Another run gives {low} to {high} m3, in 95 % of cases; the mean is {answer['parts'][0]['number']} m3."
    return {"title": answer["title"], "number": answer["number"], "unit": answer.get("unit", "m3"), "reasons": [],
            "band": band}


def of_reach(data, numbers) -> Dict[str, Any]:
    """Without a road the reach is the result."""
    title = f"{travel_shares.HEADLINE} % of the volume stays within"
    values = reaches(data)
    if not values:
        return {"title": title, "number": None, "unit": "", "band": "",
                "reasons": ["more than 1 % of the volume left the terrain, farther than anybody knows"]}
    low, high = (numbers("99 % within", "m", value) for value in (min(values), max(values)))
    band = f"{low} to {high} m over {len(values)} runs." if len(values) > 1 else "One run: no band."
    return {"title": title, "number": high, "unit": "m", "reasons": [], "band": band}


def reaches(data) -> List[float]:
    """The 99 % distances of all runs; empty where one of them is unknown."""
    key = travel_shares.DISTANCE
    rows = data.finished or [travel_shares.columns(data.result.summary)]
    return [] if any(row.get(key) is None for row in rows) else [row[key] for row in rows]


# --- what else is found ---

def sentences(data, ground, numbers, has_road_number: bool) -> List[str]:
    """Three at most: how far, what lies on the road, what else."""
    found = [distance(data, numbers, has_road_number), road(data, numbers), structures(data, ground),
             thickness(data, numbers)]
    return [text for text in found if text][:3]


def span(numbers, what, unit, values) -> str:
    """The smallest and the largest of values as text with a unit."""
    low, high = (numbers(what, unit, value) for value in (min(values), max(values)))
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def runs_of(data) -> str:
    return f"In all {len(data.finished)} runs" if len(data.finished) > 1 else "In the run"


def distance(data, numbers, has_road_number: bool) -> str:
    values = reaches(data)
    if not values:
        return "How far the mass goes is unknown: more than 1 % of it left the terrain."
    if not has_road_number:
        front = [row["front_m"] for row in data.finished] or [farthest_of(data.result.summary)[0]]
        return (f"Distances are in plan from the highest point of the body; single blocks go farther, up to "
                f"{numbers('farthest ball', 'm', max(front))} m in the model.")
    far = span(numbers, "99 % within", "m", values)
    return (f"{runs_of(data)} 99 % of the volume stays within {far} of the highest point of the body, in plan.")


def road(data, numbers) -> str:
    if data.road is None:
        return ""
    on = [row["remove_on_road_m3"] for row in data.finished]
    if not max(on) > 0:
        return f"{runs_of(data)} nothing comes to lie on the road."
    text = (f"On the road itself lie {span(numbers, 'on the road', 'm3', on)}")
    blocked = [row["blocked_m"] for row in data.finished if row.get("blocked_m") is not None]
    if blocked and max(blocked) > 0:
        text += f", over a length of up to {numbers('road blocked', 'm', max(blocked))} m"
    beyond = [row["beyond_road_m3"] for row in data.finished if row.get("beyond_road_m3") is not None]
    if beyond and max(beyond) > 0:
        text += f"; beyond it come to lie up to {numbers('beyond the road', 'm3', max(beyond))} m³"
    return f"{text}."


def structures(data, ground) -> str:
    """The largest lasting force on a structure."""
    found = [(numbers["mean_force_n"], name) for row in data.finished
             for name, numbers in (row.get("structures") or {}).items()]
    if not found:
        return ""
    force, name = max(found)
    if not force > 0:
        return "Nothing touches the structures."
    length = structures_part.lengths(ground.obstacles).get(name)
    each = f", {digits.si(force / length, 'N')} per metre of its length" if length else ""
    return f"The largest force that lasts half a second on a structure is {digits.si(force, 'N')}, on {name}{each}."


def thickness(data, numbers) -> str:
    if data.study:
        value, speed = (data.study["largest"][key]["value"] for key in ("thickness_m", "max_speed_m_s"))
    else:
        value, speed = (data.result.summary["largest"][key] for key in ("thickness", "max_speed"))
    return (f"The deposit is up to {numbers('largest thickness at the end', 'm', value)} m thick; the "
            f"fastest part of the mass reaches {numbers('largest speed', 'm/s', speed)} m/s.")


def basis(data) -> str:
    """What the numbers come from."""
    if not data.study:
        return "One run of a computer model of equal balls."
    varied = [name for name, values in data.settings.items() if len(values) > 1]
    known = list(dict.fromkeys(WORDS[name] for name in varied if name in WORDS))
    unknown = sum(name not in WORDS for name in varied)
    if unknown:
        known.append(f"{unknown} other setting{'s' * (unknown > 1)}")
    runs = len(data.finished)
    text = f"{runs} run{'s' * (runs != 1)} of a computer model of equal balls"
    if known:
        text += f", which differ in {listed(known)}"
    if data.repeats:
        text += f"{' and' if known else ', which differ'}, by chance, in how the balls lie at the start"
    method = data.study["study"].get("method") or ""        # of a site's study
    if method.startswith(known_study.PAPER) and method != known_study.BESIDE:
        why = method.removeprefix(known_study.PAPER).removeprefix("; ")
        text += ". Known events of this size do not count in them" + ("" if method == known_study.ASKED else f": {why}")
    return f"{text}."


def listed(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
