"""The first page of a report, which a client reads: body, number or why there is none, band, result, caveats.

No names of options, variables or files: these are in the appendix, and on the console.
"""
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from .. import digits
from ..deposits import travel_shares
from ..digits import percent
from ..findings import Finding
from ..statistics import rounding
from ..statistics.answer import SHARE, Code, Kind, Source
from ..tables import answer_words, combinations, elastic, ensemble_types, next_step, study_types
from ..tables.quantities import ALL, DISTANCE
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
            "answer": spoken or (of_answer(data, main) if main else of_reach(data, numbers)),
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


# --- the number, from the headline of study.yaml ---

REMOVE = "Volume to remove from the road"
WHO = "known events of this volume and height"
ALIKE = "each counted alike"
ON_ROAD = "remove_on_road_m3"


def of_headline(data: Data, numbers: Numbers) -> Optional[First]:
    """That of a study, or of both of a site; None without a headline."""
    about = data.study.headline if data.study else None
    if not about:
        return None
    kind = Kind(about.kind)
    found = {Kind.NUMBER: of_number, Kind.FLOOR: of_floor, Kind.WITHHELD: of_withheld, Kind.NOTHING: of_nothing}[kind](
        about, numbers)
    return found._replace(kind=kind.value, reasons=reasons(about), step=step_of(data),
                          band=found.band + of_runs(data) + in_gap(data, about, numbers))


def step_of(data: Data) -> Optional[next_step.Step]:
    """The next step of the headline."""
    said = data.of_study.next_step
    return next_step.Step(**vars(said)) if said else None


def of_runs(data: Data) -> str:
    """What another run gives, where the number is of the paper's study and this is the one; else ""."""
    best, about = data.of_study.conservative, data.of_study.headline
    if not best or not best.volume_m3 or not about or about.source != Source.PAPER.value:
        return ""
    if best.chance_m3 is None:
        return " No run was repeated, so that chance is not in it."
    mean, chance = (best.rounded[key] or 0.0 for key in ("mean_m3", "chance_m3"))
    low, high, middle = (rounding.text(value, best.place_m3)
                         for value in (max(0.0, mean - chance), mean + chance, mean))
    return (f" Another run gives {low} to {high} m3, in 95 % of cases; the mean is {middle} m3." +
            "".join(f" {one[0].upper()}{one[1:]}." for one in combinations.starts(best)))


def in_gap(data: Data, about: study_types.Headline, numbers: Numbers) -> str:
    """A sentence, where the share's known events end between two runs."""
    known = known_of(data)
    if about.source != Source.ENSEMBLE.value or not known:
        return ""
    gap = next((one.gap for one in known.to_remove or () if one.share == about.share), None)
    if not gap:
        return ""
    low, high = (numbers(f"{REMOVE.lower()}, {end} of the gap where no run ends", "m3", value)
                 for end, value in zip(("begin", "end"), gap))
    return f" No run ends where these known events do: between {low} m3 and {high} m3, of which the larger counts."


# --- what stands in the place of the number ---

def of_number(about: study_types.Headline, numbers: Numbers) -> First:
    return First(title_of(about), numbers(REMOVE.lower(), "m3", about.volume_m3),
                 band=bounds(about, numbers) + of_paper(about, numbers))


def title_of(about: study_types.Headline) -> str:
    """What the number is."""
    if about.source == Source.PAPER.value:
        return f"Conservative {REMOVE[0].lower()}{REMOVE[1:]}" if answer_words.is_conservative(about) else REMOVE
    return f"{REMOVE}: {percent(about.share or 0.0)} of known events stay within"


def bounds(about: study_types.Headline, numbers: Numbers) -> str:
    """Its bounds, each with its unit, and what they are made of."""
    low, high = (numbers(f"{REMOVE.lower()}, {name} end", "m3", value)
                 for value, name in ((about.low_m3 or 0.0, "lower"), (about.high_m3, "upper")))
    parts = [f"{one.cause} -{digits.three(one.below_m3)} +{digits.three(one.above_m3)} m3" for one in about.band
             if one.below_m3 or one.above_m3]
    return f"Between {low} m3 and {high} m3, with 90 % confidence" + (f": {', '.join(parts)}." if parts else ".")


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
    band = "The lower end of what the runs give, with 90 % confidence; no number to design with."
    if about.source == Source.ENSEMBLE.value and about.share:
        band += f" It is of the volume that {percent(about.share)} of {WHO} stay within."
    return First(REMOVE, f"at least {numbers(f'{REMOVE.lower()}, at least', 'm3', about.volume_m3)}",
                 band=band + of_paper(about, numbers))


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
    """Of an answer as the appendix has it: of an ensemble that no known events weigh."""
    if answer.withheld:
        return First(answer.title, None, kind=Kind.WITHHELD.value, reasons=[one.text for one in answer.withheld],
                     step=next_step.first_remedy(next_step.Made(data.of_study, data.folder)))
    return First(answer.title, answer.number, answer.unit, answer.band or "")


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
    """Four at most: the size of the balls, how far, what lies on the road, what else."""
    found = [size(data), mobility_part.mapped_sentence(data, numbers), distance(data, numbers, has_road_number),
             road(data, numbers), structures(data, ground), thickness(data, numbers)]
    return [text for text in found if text][:4]


def size(data: Data) -> str:
    """The sentence on the size of the balls, where there are several."""
    about = data.study.size if data.study else None
    return f"{about.text[0].upper()}{about.text[1:]}." if about else ""


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
        text += f"; beyond it come to lie up to {numbers.quantity('beyond_road_m3', max(beyond))} m³"
    return f"{text}."


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
