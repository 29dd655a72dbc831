"""The reasons of the headline of study.yaml in words, and its number for tables; its sentence: studies/letter."""
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple

from ..digits import metres, percent, three
from ..findings import Finding
from ..statistics.entries import Code, Headline, Kind, Reason, Source
from . import quantities

STUDY = {Source.SWEEP.value: "the sweep", Source.ENSEMBLE.value: "the runs weighted by known events"}
CLIENT = {Source.SWEEP.value: "runs with chosen settings", Source.ENSEMBLE.value: "runs weighted by known events"}


def describe_volume(kind: Optional[Kind], value: Optional[float], unit: str = "") -> str:
    """A number and what it is, for tables."""
    text = f"{three(value or 0.0)} {unit}".strip()
    if kind is Kind.WITHHELD:
        return "not usable"
    if kind is Kind.FLOOR:
        return f"at least {text}" if value else f"more than {text}"
    return f"{text} (no bound)" if kind is Kind.OPEN else text


# --- why ---

def told(headline: Headline) -> List[Reason]:
    """The reasons as they are printed, each once: of a rule that both studies break, of the one that decides."""
    found: Dict[Tuple[Code, Any], Reason] = {}
    for one in headline.reasons:
        found.setdefault((one.code, one.numbers.get("rule")), one)
    return list(found.values())


def describe_reason(reason: Reason) -> str:
    """A reason as a sentence without its full stop."""
    return finding(reason).text


def client(reason: Reason) -> str:
    """The same for the first page of a report."""
    code, of = reason.code, reason.numbers
    if code is not Code.RULE:
        found = finding(reason)
        return found.client().rstrip(".") or found.text
    return f"{Finding(of['rule']).client().rstrip('.')} ({CLIENT[of['source']]})"


def finding(reason: Reason) -> Finding:
    """A reason as the Finding that has its words."""
    code, of = reason.code, reason.numbers
    if code is Code.RULE:
        return Finding("rule", {"study": STUDY[of["source"]], "rule": of["rule"]})
    if code is Code.SIZE:
        return of_size(of)
    words = {"far": lambda: percent(of["far"]), "most": lambda: f"{quantities.format_quantity(of['most_m3'])} m3",
             "runs": lambda: f"{of['runs']}", "path": lambda: metres(of["path_m"]),
             "share": lambda: percent(of["share"]), "shares": lambda: format_shares((of["low"], of["high"])),
             "reach": lambda: f"{of['reach']} of {of['runs']}", "left": lambda: describe_left_volume(of),
             "ends": lambda: ends(of), "points": lambda: f"{of['points']:g}"}
    return Finding(code.value, {name: words[name]() for name in TAKES.get(code, ())})


def of_size(of: Mapping[str, Any]) -> Finding:
    """What the sizes of balls that were run leave open."""
    number, grown = of["sizes"], of["grown"]
    if number > 2 and grown is not None:
        return Finding(f"{Code.SIZE.value} grows", {"grown": percent(grown)})
    return Finding(Code.SIZE.value, {"sizes": "one size" if number == 1 else f"{number} sizes"})


# of each code the words that its sentence takes
TAKES = {Code.BEYOND: ("far", "runs", "most"), Code.ONE_SCATTER: ("shares",), Code.TERRAIN: ("path", "share"),
         Code.RANGE: ("ends",), Code.RUNS: ("points",), Code.SOME: ("reach", "left")}


def describe_share_beyond(far: float, path_end: Optional[float]) -> str:
    """The share of known events beyond all runs, and where it is counted if that is not where the longest ends."""
    return percent(far) + ("" if path_end is None else f" (beyond {metres(path_end)}, where the fall path ends)")


def describe_left_volume(of: Mapping[str, Any]) -> str:
    """What is to be removed after the runs that leave something, "" if none does."""
    least, most = (quantities.format_quantity(of[key]) for key in ("least_m3", "most_m3"))
    return f", which leave {least if least == most else f'{least} to {most}'} m3 to remove" * bool(of["most_m3"])


def ends(of: Mapping[str, Any]) -> str:
    """Where the ranges do."""
    ranges = ", ".join(map(" ".join, of["ends"].items()))
    return f", which end at {ranges}," if ranges else ""


def format_shares(several: Iterable[float]) -> str:
    """Shares by the smaller and the larger scatter, as one text."""
    return " to ".join(dict.fromkeys(map(percent, several)))
