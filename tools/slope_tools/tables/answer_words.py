"""The headline of study.yaml in words, for the console."""
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple

from ..digits import metres, percent
from ..findings import Finding
from ..statistics.answer import Cause, Code, Kind, Reason, Source
from . import quantities, study_types

OF = {Source.PAPER: "by the sweep", Source.ENSEMBLE: "by known events"}
CONSERVATIVE = "the conservative volume of the sweep"       # what is only said where chance is in it
STUDY = {Source.PAPER.value: "the sweep", Source.ENSEMBLE.value: "the runs weighted by known events"}


def lines(about: study_types.Headline) -> List[str]:
    """The number, what it is of, and the reasons; a line each."""
    said = band(about)
    return [f"headline: {number(about)}", *([f"  {said}"] if said else []), *(f"  {text(one)}" for one in told(about))]


def number(about: study_types.Headline) -> str:
    """A sentence without its full stop."""
    if Kind(about.kind) is Kind.WITHHELD:
        return "withheld, neither study gives a number" if about.paper and about.ensemble else "withheld"
    source, floor = Source(about.source), Kind(about.kind) is Kind.FLOOR
    volume = f"{quantities.number(about.volume_m3 or 0.0)} m3"
    if about.high_m3:
        volume += f" ({quantities.number(about.low_m3 or 0.0)} to {quantities.number(about.high_m3)})"
    share = f", {percent(about.share)} of them stay within" if about.share else ""
    of = CONSERVATIVE if is_conservative(about) and not floor else OF[source]
    return (f"{('at least ' if about.volume_m3 else 'more than ') * floor}{volume} to remove, {of}{share}"
            f"{beside(about, source)}")


def is_conservative(about: study_types.Headline) -> bool:
    """Whether it is the paper's volume, and what chance adds is in it."""
    known = about.volume_m3 == 0 or any(one.cause == Cause.RUNS.value and one.below_m3 for one in about.band)
    return about.source == Source.PAPER.value and known


def band(about: study_types.Headline) -> str:
    """What a band is made of, a sentence without its full stop; "" without one."""
    parts = [f"{one.cause} -{quantities.number(one.below_m3)} +{quantities.number(one.above_m3)} m3"
             for one in about.band if one.below_m3 or one.above_m3]
    return f"90 % band: {', '.join(parts)}" if parts and about.high_m3 else ""


def beside(about: study_types.Headline, source: Source) -> str:
    """What the other study gives."""
    if source is Source.ENSEMBLE:
        return of_other("the sweep", about.paper.volume_m3 if about.paper else None)
    return of_other("95 % of known events", about.ensemble.volume_m3 if about.ensemble else None)


def of_other(what: str, volume: Optional[float]) -> str:
    return "" if volume is None else f"; {what}: {quantities.number(volume)} m3"


# --- why ---

def told(about: study_types.Headline) -> List[Reason]:
    """The reasons as they are printed, each once: of a rule that both studies break, of the one that decides."""
    found: Dict[Tuple[Code, Any], Reason] = {}
    for one in map(Reason.read, about.reasons):
        found.setdefault((one.code, one.numbers.get("rule")), one)
    return list(found.values())


def text(reason: Reason) -> str:
    """A reason as a sentence without its full stop."""
    return finding(reason).text


def client(reason: Reason) -> str:
    """The same for the first page of a report."""
    code, of = reason.code, reason.numbers
    if code is not Code.RULE:
        return finding(reason).client().rstrip(".")
    return Finding(of["rule"]).client().rstrip(".") + (
        "" if of["source"] == Source.PAPER.value else " (runs weighted by known events)")


def finding(reason: Reason) -> Finding:
    """A reason as the Finding that has its words."""
    code, of = reason.code, reason.numbers
    if code is Code.RULE:
        return Finding("rule", {"study": STUDY[of["source"]], "rule": of["rule"]})
    if code is Code.SIZE:
        return of_size(of)
    words = {"longest": lambda: metres(of["longest_m"]), "far": lambda: beyond(of["far"], of.get("path_end_m")),
             "most": lambda: f"{quantities.number(of['most_m3'])} m3",
             "near": lambda: metres(of["near_m"]), "path": lambda: metres(of["path_m"]),
             "share": lambda: percent(of["share"]), "shares": lambda: shares((of["low"], of["high"])),
             "reach": lambda: f"{of['reach']} of {of['runs']}", "left": lambda: left(of),
             "ends": lambda: ends(of), "points": lambda: f"{of['points']:g}"}
    return Finding(code.value, {name: words[name]() for name in TAKES.get(code, ())})


def of_size(of: Mapping[str, Any]) -> Finding:
    """What the sizes of balls that were run leave open."""
    number, grown = of["sizes"], of["grown"]
    if number > 2 and grown is not None:
        return Finding(f"{Code.SIZE.value} grows", {"grown": percent(grown)})
    return Finding(Code.SIZE.value, {"sizes": "balls of one size" if number == 1 else f"balls of {number} sizes"})


# of each code the words that its sentence takes
TAKES = {Code.BEYOND: ("longest", "far", "most"), Code.NOT_REACHED: ("near", "shares", "ends"),
         Code.ONE_SCATTER: ("near", "shares", "ends"), Code.TERRAIN: ("path", "share"), Code.RANGE: ("ends",),
         Code.RUNS: ("points",), Code.SOME: ("reach", "left")}


def beyond(far: float, path_end: Optional[float]) -> str:
    """The share of known events beyond all runs, and where it is counted if that is not where the longest ends."""
    return percent(far) + ("" if path_end is None else f" (beyond {metres(path_end)}, where the fall path ends)")


def left(of: Mapping[str, Any]) -> str:
    """What is to be removed after the runs that leave something, "" if none does."""
    least, most = (quantities.number(of[key]) for key in ("least_m3", "most_m3"))
    return f", which leave {least if least == most else f'{least} to {most}'} m3 to remove" * bool(of["most_m3"])


def ends(of: Mapping[str, Any]) -> str:
    """Where the longest run ends, or where the ranges do."""
    if "ends" in of:
        # text: of older versions
        ranges = of["ends"] if isinstance(of["ends"], str) else ", ".join(map(" ".join, of["ends"].items()))
        return f", which end at {ranges}," if ranges else ""
    return "no run leaves a deposit" if of["longest_m"] is None else \
        f"the longest run ends after {metres(of['longest_m'])}"


def shares(several: Iterable[float]) -> str:
    """Shares by the smaller and the larger scatter, as one text."""
    return " to ".join(dict.fromkeys(map(percent, several)))
