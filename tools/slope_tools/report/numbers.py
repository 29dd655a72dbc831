"""The numbers of a report: rounded to what is known, and as they are in a table; the answer on top of the page, and on
which runs it rests."""
import csv
import io
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

from .. import disk
from ..deposits import rest, travel_shares
from ..digits import format_measured_share, rounded
from ..findings import Finding
from ..heads import is_number
from ..mobility.run_length import ON_PATH
from ..statistics import rounding
from ..statistics.entries import Source
from ..tables import named_run, usable
from ..tables.quantities import ALL, KNOWN, LENGTH, REACH, written
from ..tables.released import over_runs
from .data import Data

UNKNOWN = "unknown"


class Numbers:
    """Writes numbers, and keeps them: each that was shown, with all its digits, is a row of the table."""

    def __init__(self):
        self.rows = []

    def __call__(self, what, unit, value, of=""):
        """A number as text, with three digits."""
        if value is None:
            return UNKNOWN
        text = rounding.format_rounded(value, rounding.place_of_digits(value, unit))
        self.rows.append((what, unit, of, text, value))
        return text

    def quantity(self, key, value, of="", unknown=UNKNOWN):
        """A quantity of a run, as pages have it."""
        quantity = ALL[key]
        if value is None:
            return unknown
        if quantity.page in ("", KNOWN):
            return self(quantity.name, quantity.unit, value, of)
        text = written(quantity.page, value)
        self.rows.append((quantity.name, quantity.unit, of, text, value))
        return text

    def mean(self, what, unit, value, scatter, of):
        """A mean and the scatter of a run: both to the second digit of the scatter, but no finer than three digits

        of the mean.
        """
        if not scatter:
            return self(f"mean: {what}", unit, value, of)
        place = max(10 * rounding.place_of_digits(scatter), rounding.place_of_digits(value) / 10)
        texts = [rounding.format_rounded(one, place) for one in (value, scatter)]
        for name, text, one in zip(("mean", "scatter"), texts, (value, scatter)):
            self.rows.append((f"{name}: {what}", unit, of, text, one))
        return " \N{PLUS-MINUS SIGN} ".join(texts)

    def whole(self, what, unit, value, of=""):
        """A volume that has no scatter, to the cubic metre."""
        self.rows.append((what, unit, of, f"{value:,.0f}", value))
        return f"{value:,.0f}"

    def table(self):
        """All numbers that were shown, as CSV."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["what", "unit", "of", "shown", "value"])
        for what, unit, of, shown, value in dict.fromkeys(self.rows):
            writer.writerow([what, unit, of, shown.replace(",", ""), repr(float(value))])
        return text.getvalue()


# --- the answer ---

class CardPart(NamedTuple):
    """A number of which an answer is made, or another one of its kind; unit: None: that of the answer."""
    number: Optional[str]
    what: str
    note: str
    sign: str = ""
    unit: Optional[str] = None


class MainCard(NamedTuple):
    """The number of a study, on top of the appendix; withheld: why there is none; note: on which runs it rests.

    Of the conservative volume: predicted: whether chance is in it; zero: what a volume of 0 is worth; below, ground:
    what else is said of it; road: see study_types.Header.
    """
    title: str
    number: Optional[str]
    unit: str = "m3"
    parts: Sequence[CardPart] = ()
    withheld: Sequence[Finding] = ()
    band: Optional[str] = None
    note: str = ""
    predicted: bool = False
    zero: Optional[str] = None
    below: str = ""
    ground: str = ""
    road: Optional[Mapping[str, Any]] = None


def sweep_card(data: Data, numbers: Numbers) -> Optional[MainCard]:
    """The conservative volume on top of the appendix: its number (or why it is withheld), what it may be called, parts.

    None without a road.
    """
    best = data.study.conservative if data.study else None
    if not best or not data.study:
        return None
    road, place = data.study.study.road, best.place_m3
    if best.withheld:
        return MainCard(usable.UNUSABLE.capitalize(), None, withheld=best.withheld, road=road)
    who = best.label or best.combination
    rounded_ = best.rounded

    def part(key: str, exact: Optional[float]):
        value = rounded_[key]
        if value is None:
            return None
        text = rounding.format_rounded(value, place)
        numbers.rows.append((f"conservative: {key}", "m3", who, text, exact))
        return text

    predicted, scatter = best.chance_m3 is not None, best.scatter_m3 or 0.0
    parts = [CardPart(part("mean_m3", best.mean_m3), "mean" if predicted else "largest run",
                      f"of {best.repeats} runs, {who}" if predicted else f"{who}; of {best.runs} runs")]
    if predicted:
        parts.append(CardPart(
            part("chance_m3", best.chance_m3), "chance",
            f"97.5 % of single runs lie below: t {best.quantile:.3g} x standard deviation of a run "
            f"{rounding.format_rounded(scatter, rounding.place_of_digits(scatter))} m3 x sqrt(1 + 1/{best.repeats}), "
            f"{best.degrees_of_freedom:.3g} degrees of freedom", "+"))
    else:
        parts.append(CardPart(UNKNOWN, "chance", "no run was repeated (study --repeat seed=..., xoffset=...)", "+"))
    title = "Conservative volume to remove from the road" if predicted else \
        f"Volume to remove from the road: {best.kind}"
    return MainCard(title, part("volume_m3", best.volume_m3), parts=parts, predicted=predicted, road=road,
                    zero=best.zero.text if best.zero else None, below=below_ground(data, numbers),
                    ground=best.ground or "")


def below_ground(data: Data, numbers: Numbers):
    """A sentence on what is to be removed where the cut lies below the ground; "" where it does not."""
    found = data.below_ground()
    if found is None:
        return ""
    below, whole, name = found[0], data.volumes["remove"], data.label(data.result)
    texts = [numbers(what, "m3", value, name)
             for what, value in (("to remove where the cut is below the ground", below), ("to remove", whole))]
    return (f"{texts[0]} m3 of the {texts[1]} m3 of the run {name} lie where the cut surface is below the ground "
            "before the collapse.")


def cards(data: Data, numbers: Numbers):
    """What stands below the conservative volume: dicts of what, number, unit, note, and status of the last one."""
    return [released_card(data, numbers), travel_card(data, numbers), thickness_card(data, numbers), rest_card(data)]


def released_card(data: Data, numbers: Numbers):
    values = sorted({round(row.released_m3, 3) for row in data.finished}
                    or {data.result.summary["volume"]["released"]})
    texts = list(dict.fromkeys(numbers.whole("released", "m3", value) for value in (values[0], values[-1])))
    for row in data.compared:
        if row.release.body is not None:
            numbers.whole("body", "m3", row.release.body, data.label_of(row) if data.study else "")
    return {"what": "Released", "number": " - ".join(texts), "unit": "m3",
            "note": over_runs([row.release for row in data.compared], False)}


OLD = "of an older version"
LOST = "from which more than 1 % of the volume left the terrain, farther than anybody knows: enlarge it"


def travel_card(data: Data, numbers: Numbers):
    key, row, name = travel_shares.DISTANCE, data.compared[0], ""
    what = f"{travel_shares.HEADLINE} % of the volume stays within"
    if data.study:
        largest, rows = data.study.largest, {row.run: row for row in data.finished}
        far, row = largest["front_m"], rows[largest[key].run] if key in largest else row
        who, name = data.label_of(rows[far.run]), data.label_of(row)
        farthest = f"; farthest ball {numbers.quantity('front_m', far.value, who)} m, {who}"
    else:
        farthest = f"; farthest ball {numbers.quantity('front_m', farthest_of(data.result.summary)[0])} m"
    if any(one.value(key) is None for one in data.compared):
        left = any(one.left_box for one in data.compared)
        return {"what": what, "number": UNKNOWN, "unit": "", "note": f"a run {LOST if left else OLD}{farthest}"}
    note = ("in plan from the highest released ball, reach angle "
            f"{numbers.quantity(REACH, row.value(REACH), name)} degrees")
    if (length := row.value(LENGTH)) is not None:
        kind = row.length_is or ON_PATH      # none in older files
        note += f"; {numbers(f'length, {kind}', 'm', length, name)} m {kind}"
    return {"what": what, "number": numbers.quantity(key, row.value(key), name), "unit": "m",
            "note": note + farthest + (f". Run: {name}" if name else "")}


def farthest_of(summary):
    """Distance (m) and reach angle (degrees) of the one farthest ball."""
    far = summary["travel"].get("farthest")
    if isinstance(far, dict) and all(disk.is_finite_number(far.get(key)) for key in ("distance", "reach_angle")):
        return far["distance"], far["reach_angle"]
    return summary["travel"]["front"], summary["travel"]["reach_angle"]


def thickness_card(data: Data, numbers: Numbers):
    if data.study:
        largest = data.study.largest
        value, ever, speed = (largest[key].value for key in ("thickness_m", "max_thickness_m", "max_speed_m_s"))
    else:
        about = data.result.summary["largest"]
        value, ever, speed = (about[key] for key in ("thickness", "max_thickness", "max_speed"))
    return {"what": "Thickest deposit", "number": numbers.quantity("thickness_m", value),
            "unit": "m", "note": f"at the end; {numbers.quantity('max_thickness_m', ever)} m in the course of "
            f"{'a' if data.study else 'the'} run. Fastest ball {numbers.quantity('max_speed_m_s', speed)} m/s"}


def rest_card(data: Data):
    ends = data.compared
    resting = [end for end in ends if end.at_rest]
    worst = next((end for level in (True, False) for end in ends if not end.at_rest and end.moving == level), None)
    status = "rest" if worst is None else "moving" if worst.moving else "doubt"
    if data.study:
        note = f"{data.label_of(worst)}: {worst.end}, at {worst.stop_time_s:.1f} s" if worst else \
            "ended by their rest criterion, at most " \
            f"{format_measured_share(max(end.moves_share for end in ends))} of the volume faster than {rest.FAST:g} m/s"
        return {"what": "At rest at the end", "number": f"{len(resting)} of {len(ends)}", "unit": "runs", "note": note,
                "status": status}
    return {"what": "At the end of the run", "number": f"{ends[0].stop_time_s:.1f}", "unit": "s", "status": status,
            "note": ends[0].end + (", ended by its rest criterion" if worst is None else "")}


# --- on which runs the number rests, and which run the map shows ---

CHANCE = "how the balls lie at the start"
WORDS = {"rolling": "the rolling resistance", "friction": "the friction", "d": "the size of the model's balls",
         "field_d": "the roughness of the ground", "spacing": "the roughness of the ground",
         "angle": "the direction of the ground's grid",
         "restitution": "the restitution", "field_e": "the restitution", "peak": "the strength of the earthquake",
         "pga": "the strength of the earthquake", "depth": "the depth of the body", "body": "the body",
         "slip": "the friction of the slip surface", "step": "the time step", "packing": CHANCE, "seed": CHANCE,
         "xoffset": CHANCE, "yoffset": CHANCE, "zoffset": CHANCE}


def shown_run(data: Data) -> str:
    """Which run the map shows, for its caption."""
    if not data.study:
        return ""
    one, row = data.result, data.result.row
    number, of = data.number(one.name), values_of(data, row.set)
    said, own = data.study.headline, Source.ENSEMBLE if data.study.ensemble else Source.SWEEP
    rests = said and said.volume_m3 and said.source is own and one.name == named_run.governing(data.study)
    text = f"A run that leaves about as much, {number} of the appendix" if rests else f"Run {number} of the appendix"
    return f" {text}{of and f': {of}'}."


def values_of(data: Data, of: Mapping[str, Any]) -> str:
    """The values in which a run, or a combination, differs from others; "" if they have no words."""
    found: Dict[str, str] = {}
    for name, value in of.items():
        if len(data.settings.get(name) or ()) > 1 and WORDS.get(name, CHANCE) != CHANCE:
            text = rounded(float(value), 3) if is_number(value) else str(value)
            found.setdefault(WORDS[name].removeprefix("the "), text)
    return join_words([f"{name} {text}" for name, text in found.items()])


def join_words(words: Sequence[str]) -> str:
    several: List[str] = list(words)
    return " and ".join([", ".join(several[:-1]), several[-1]] if len(several) > 1 else several)
