"""The first page of a report, which a client reads: body, number or why there is none, band, result, caveats.

No names of options, variables or files: these are in the appendix, and on the console.
"""
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from .. import digits
from ..deposits import travel_shares
from ..digits import percent
from ..findings import Finding
from ..statistics import rounding, size_family
from ..statistics.answer import SHARE, Code, Kind, Source
from ..tables import answer_words, combinations, elastic, ensemble_types, fine_run, next_step, study_types
from ..tables.quantities import ALL, DISTANCE, REMOVE as QUANTITY
from . import body, mobility_part, road_part, structures_part, warnings
from .data import Data
from .numbers import MainCard, Numbers, basis, farthest_of


class First(NamedTuple):
    """What stands first: a number, or why there is none; kind: see statistics.answer; step: what to do next."""
    title: str
    number: Optional[str]
    unit: str = "m3"
    band: str = ""
    kind: str = Kind.NUMBER.value
    reasons: Sequence[str] = ()
    step: Optional[next_step.Step] = None


def content(data: Data, ground, numbers: Numbers, answers: Sequence[Optional[MainCard]], found,
            listed: int) -> Dict[str, Any]:
    """What the template takes; answers: those of the study, the first that there is counts; found: all findings.

    listed: how many warnings the appendix has.
    """
    main, spoken = next((one for one in answers if one), None), of_headline(data, numbers)
    return {"body": body.sentence(body.of_data(data, ground)),
            "answer": spoken or (floored(data, of_answer(data, main), numbers) if main else
                                 of_reach(data, numbers)),
            "basis": basis(data),
            "sentences": [*road_part.others(data), mobility_part.on_first_page(data, ground, numbers),
                          *sentences(data, ground, numbers, bool(main)),
                          *road_part.on_first_page(data, numbers, bool(main and main.withheld)),
                          Finding("dry").client()],
            "caveats": warnings.first_page(unsaid(data, found))[:warnings.MOST], "rest": warnings.rest_of(listed)}


def unsaid(data: Data, found: Sequence[Finding]) -> List[Finding]:
    """The findings without what the reasons of the number say already."""
    about = data.study.headline if data.study else None
    said = {"no sizes"} if about and any(one.code is Code.SIZE for one in answer_words.told(about)) else set()
    return [one for one in found if one.kind not in said]


# --- the number, from the headline of study.yaml: of both studies of a site ---
# It is that of of_headline() where an ensemble stands beside, and governs or makes a floor; else the conservative
# volume of numbers.answer(), by of_answer().

REMOVE = "Volume to remove from the road"
WHO = "known events of this volume and height"
ALIKE = "each counted alike"
ON_ROAD = "remove_on_road_m3"


def of_headline(data: Data, numbers: Numbers) -> Optional[First]:
    """That of both studies of a site; None without a headline, and where the paper's study says all, with its parts."""
    about = data.study.headline if data.study else None
    if not about or not about.ensemble:
        return None
    kind = Kind(about.kind)
    if kind is Kind.NUMBER and about.source == Source.PAPER.value:
        return None
    found = {Kind.NUMBER: of_number, Kind.FLOOR: of_floor, Kind.WITHHELD: of_withheld, Kind.NOTHING: of_nothing}[kind](
        about, numbers)
    return found._replace(kind=kind.value, reasons=reasons(about), step=step_of(data),
                          band=found.band + in_gap(data, about, numbers))


def step_of(data: Data) -> Optional[next_step.Step]:
    """The next step of the headline."""
    said = data.of_study.next_step
    return next_step.Step(**vars(said)) if said else None


def in_gap(data: Data, about: study_types.Headline, numbers: Numbers) -> str:
    """A sentence, where the share's known events end between two runs; raised for smaller balls as the number is."""
    known = known_of(data)
    if about.source != Source.ENSEMBLE.value or not known:
        return ""
    gap = next((one.gap for one in known.to_remove or () if one.share == about.share), None)
    if not gap:
        return ""
    effect = fine_run.read_effect(data.study.size if data.study else None, QUANTITY)
    low, high = (numbers(f"{REMOVE.lower()}, {end} of the gap where no run ends", "m3",
                         value + (effect.added(value) if effect else 0.0))
                 for end, value in zip(("begin", "end"), gap))
    return f" No run ends where these known events do: between {low} m3 and {high} m3, of which the larger counts."


# --- what stands in the place of the number ---

def of_number(about: study_types.Headline, numbers: Numbers) -> First:
    share = percent(about.share or 0.0)
    return First(f"{REMOVE}: {share} of known events stay within",
                 numbers(f"{REMOVE.lower()}, {share} of known events", "m3", about.volume_m3),
                 band=bounds(about, numbers) + of_paper(about, numbers))


def bounds(about: study_types.Headline, numbers: Numbers) -> str:
    """Its bounds, each with its unit."""
    low, high = (None if value is None else numbers(f"{REMOVE.lower()}, {name} bound", "m3", value)
                 for value, name in ((about.low_m3, "lower"), (about.high_m3, "upper")))
    if low is None and high is None:
        return "No bounds: the runs are too few for them."
    if high is None:
        return f"At least {low} m3 with 90 % confidence; an upper bound would need more runs."
    return f"Between {low or 0} m3 and {high} m3, with 90 % confidence."


def of_paper(about: study_types.Headline, numbers: Numbers) -> str:
    """The conservative volume of the other study, where it has one and does not govern."""
    volume = about.paper.volume_m3 if about.paper else None
    if volume is None or about.source != Source.ENSEMBLE.value:
        return ""
    return (" A study that takes the largest of few settings, without known events, gives "
            f"{numbers('conservative volume', 'm3', volume)} m3.")


def of_floor(about: study_types.Headline, numbers: Numbers) -> First:
    """At least so much; where no run reaches the road, how many known events do."""
    if not about.volume_m3:
        return not_reached(about)
    text = numbers(f"{REMOVE.lower()}, at least", "m3", about.volume_m3)
    share = about.share
    if share:
        band = f"{percent(share)} of {WHO} stay within {text} m3; what the others bring these runs do not show."
    elif about.source == Source.PAPER.value:
        band = ("A further run of the governing settings stays below, in 97.5 % of such studies; more mobile masses "
                "may bring more.")
    else:
        band = ""
    title = f"{REMOVE}, with {percent(share)}" if share else REMOVE
    return First(title, f"at least {text}", band=band + by_family(about, numbers) + of_paper(about, numbers))


def by_family(about: study_types.Headline, numbers: Numbers) -> str:
    """What the number becomes by the largest factor that a slide of the family grew by with smaller balls."""
    growth = [one["numbers"]["growth"] for one in about.reasons if one["numbers"].get("growth")]
    if not growth:
        return ""
    most = max(size_family.Growth(**one).covered(about.volume_m3 or 0.0) for one in growth)
    text = numbers(f"{REMOVE.lower()}, by the largest growth with smaller balls", "m3", most)
    return f" With as much more by smaller balls as the slide that grew most, {text} m3."


def not_reached(about: study_types.Headline) -> First:
    road = about.road
    if not road or road.brought.reach:
        reached = f"{answer_words.shares(road.reached)} of {WHO} reach the road." if road else ""
        return First(REMOVE, "more than 0", "m3", reached)
    return First("No run reaches the road, but known events do", answer_words.shares(road.reached),
                 "of known events reach it", "More than 0 m3 is to be removed then; how much, these runs do not show.")


def of_withheld(about: study_types.Headline, numbers: Numbers) -> First:
    del about, numbers
    return First(f"{REMOVE}: not usable", None)


def of_nothing(about: study_types.Headline, numbers: Numbers) -> First:
    road = about.road
    band = f"{answer_words.shares(road.reached)} of {WHO} reach the road." if road else \
        "No known events can be compared with this mass."
    return First(REMOVE, numbers(REMOVE.lower(), "m3", 0.0),
                 band=f"Nothing comes to lie on the road in any run. {band}")


# --- why ---

def reasons(about: study_types.Headline) -> List[str]:
    """A sentence each, without its full stop; the one that decides comes first."""
    return list(dict.fromkeys(map(answer_words.client, answer_words.told(about))))


# --- the number of one study ---

def of_answer(data: Data, answer: MainCard) -> First:
    """Of an answer as the appendix has it."""
    if answer.withheld:
        return First(answer.title, None, kind=Kind.WITHHELD.value, reasons=[one.text for one in answer.withheld],
                     step=next_step.first_remedy(next_step.Made(data.of_study, data.folder)))
    best = data.of_study.conservative
    if answer.zero:
        band = f"{answer.zero[0].upper()}{answer.zero[1:]}."
    elif answer.band is not None:
        band = answer.band
    elif best is None or best.chance_m3 is None:
        band = "No band: no run was repeated, so that chance is unknown."
    else:
        mean, chance = (best.rounded[key] or 0.0 for key in ("mean_m3", "chance_m3"))
        low, high = (rounding.text(value, best.place_m3) for value in (max(0.0, mean - chance), mean + chance))
        band = f"Another run gives {low} to {high} m3, in 95 % of cases; the mean is {answer.parts[0].number} m3."
        band += "".join(f" {one[0].upper()}{one[1:]}." for one in combinations.starts(best))
    return First(answer.title, answer.number, answer.unit, band)


def floored(data: Data, first: First, numbers: Numbers) -> First:
    """The same as a floor, where the headline of the one study says so."""
    about = data.study.headline if data.study else None
    if first.number is None or not about or about.ensemble or Kind(about.kind) is not Kind.FLOOR:
        return first
    return first._replace(kind=Kind.FLOOR.value, title=REMOVE, number=f"at least {first.number}",
                          reasons=reasons(about), band=first.band + by_family(about, numbers), step=step_of(data))


def of_reach(data: Data, numbers: Numbers) -> First:
    """Without a road the reach is the result."""
    title = f"{travel_shares.HEADLINE} % of the volume stays within"
    values = reaches(data)
    if not values:
        return First(title, None, kind=Kind.WITHHELD.value,
                     reasons=["more than 1 % of the volume left the terrain, farther than anybody knows"])
    low, high = (numbers.quantity(DISTANCE, value) for value in (min(values), max(values)))
    band = f"{low} to {high} m over {len(values)} runs." if len(values) > 1 else "One run: no band."
    return First(title, high, "m", band)


def reaches(data: Data) -> List[float]:
    """The 99 % distances of all runs; empty where one of them is unknown."""
    key = DISTANCE
    found = [row.value(key) for row in data.compared]
    return [] if None in found else found


# --- what else is found ---

def sentences(data: Data, ground, numbers: Numbers, has_road_number: bool) -> List[str]:
    """Three at most: how far, what lies on the road, what else."""
    found = [mobility_part.mapped_sentence(data, numbers), distance(data, numbers, has_road_number),
             road(data, numbers), structures(data, ground), thickness(data, numbers)]
    return [text for text in found if text][:3]


def span(numbers, key, values) -> str:
    """The smallest and the largest values of a quantity as text with its unit."""
    low, high = (numbers.quantity(key, value) for value in (min(values), max(values)))
    unit = ALL[key].unit
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def runs_of(data: Data) -> str:
    return f"In all {len(data.finished)} runs" if len(data.finished) > 1 else "In the run"


def weighted(data: Data, numbers: Numbers, key: str) -> str:
    """What SHARE of known events stay within, where they weigh the runs and tell it; else ""."""
    known = known_of(data)
    entry = known.quantities.get(key) if known else None
    at = {one.share: one.value for one in entry.quantiles}.get(SHARE) if entry else None
    return "" if at is None else f"{numbers.quantity(key, at)} {ALL[key].unit}"


def known_of(data: Data) -> Optional[ensemble_types.Weighted]:
    """What known events say, where they weigh the runs of the number."""
    return ensemble_types.weighted(data.study.ensemble) if data.study else None


def distance(data: Data, numbers: Numbers, has_road_number: bool) -> str:
    values = reaches(data)
    if not values:
        return f"How far the mass goes is unknown: more than 1 % of it left the terrain.{most_elastic(data, numbers)}"
    if not has_road_number:
        front = [row.front_m for row in data.finished] or [farthest_of(data.result.summary)[0]]
        return (f"Distances are in plan from the highest point of the body; single blocks go farther, up to "
                f"{numbers.quantity('front_m', max(front))} m in the model.{most_elastic(data, numbers)}")
    far = span(numbers, DISTANCE, values)
    known = weighted(data, numbers, DISTANCE)
    if known:
        return (f"In {percent(SHARE)} of known events 99 % of the volume stays within {known} of the highest point of "
                f"the body, in plan; in single runs, {ALIKE}, within {far}.{most_elastic(data, numbers)}")
    return (f"{runs_of(data)} 99 % of the volume stays within {far} of the highest point of the body, in plan."
            f"{most_elastic(data, numbers)}")


def most_elastic(data: Data, numbers: Numbers) -> str:
    """A sentence on how far it goes with the largest restitution; "" without such runs."""
    about = data.study.largest_restitution if data.study else None
    if not about or not about.runs:
        return ""
    text = f" With the most elastic rock, a restitution of {about.restitution:g},"
    far = elastic.far(about)
    return f"{text} more than 1 % of it leaves the terrain." if far is None else \
        f"{text} within {numbers.quantity(DISTANCE, far)} m."


def road(data: Data, numbers: Numbers) -> str:
    if data.road is None:
        return ""
    on = [row.value(ON_ROAD) for row in data.finished]
    if not max(on) > 0:
        return f"{runs_of(data)} nothing comes to lie on the road."
    known, far = weighted(data, numbers, ON_ROAD), span(numbers, ON_ROAD, on)
    if known:
        text = f"On the road itself {percent(SHARE)} of known events leave at most {known}; single runs, {ALIKE}, {far}"
    elif known_of(data):
        text = f"On the road itself single runs, {ALIKE}, leave {far}"
    else:
        text = f"On the road itself lie {far}"
    blocked = [row.at_road.blocked_m for row in data.finished if row.road]
    if blocked and max(blocked) > 0:
        text += f", over a length of up to {numbers.quantity('blocked_m', max(blocked))} m"
    beyond = [past for row in data.finished if row.road and (past := row.road.beyond_road_m3) is not None]
    if beyond and max(beyond) > 0:
        text += f"; beyond it come to lie up to {numbers.quantity('beyond_road_m3', max(beyond))} m³" + finer(data)
    return f"{text}."


def finer(data: Data) -> str:
    """By how much what lies beyond the road grew with smaller balls in a family of slides; "" where nobody can tell."""
    balls = data.study.study.balls_thick if data.study else None
    grown = None if balls is None else size_family.told(balls, quantity="beyond_road_m3")
    if grown is None:
        return ""
    return (f"; smaller balls in the model brought up to {digits.rounded(grown.high, 2)} times as much there in "
            f"{grown.slides} other slides (median {digits.rounded(grown.median, 2)})")


def structures(data: Data, ground) -> str:
    """The largest lasting force on a structure."""
    found = [(numbers["mean_force_n"], name) for row in data.finished
             for name, numbers in row.structures.items()]
    if not found:
        return ""
    force, name = max(found)
    if not force > 0:
        return "Nothing touches the structures."
    length = structures_part.lengths(ground.obstacles).get(name)
    each = f", {digits.si(force / length, 'N')} per metre of its length" if length else ""
    return f"The largest force that lasts half a second on a structure is {digits.si(force, 'N')}, on {name}{each}."


def thickness(data: Data, numbers: Numbers) -> str:
    if data.study:
        value, speed = (data.study.largest[key].value for key in ("thickness_m", "max_speed_m_s"))
    else:
        value, speed = (data.result.summary["largest"][key] for key in ("thickness", "max_speed"))
    return (f"The deposit is up to {numbers.quantity('thickness_m', value)} m thick; the "
            f"fastest part of the mass reaches {numbers.quantity('max_speed_m_s', speed)} m/s.")
