"""The headline of study.yaml in words, for the console."""
from typing import Any, List, Mapping, Optional

from ..digits import rounded
from ..mobility.results import percent
from ..statistics.answer import Answer, Code, Kind, Reason, Source
from . import quantities

OF = {Source.PAPER: "the conservative volume of the paper's study", Source.ENSEMBLE: "by known events"}
STUDY = {Source.PAPER.value: "the paper's study", Source.ENSEMBLE.value: "the runs weighted by known events"}


def lines(found: Answer) -> List[str]:
    """The number, what it is of, and the reasons; a line each."""
    return [f"headline: {number(found)}", *(f"  {text(one)}" for one in found.reasons)]


def number(found: Answer) -> str:
    """A sentence without its full stop."""
    if found.kind is Kind.WITHHELD:
        return "withheld, neither study gives a number"
    assert found.source
    volume = f"{quantities.number(found.volume or 0.0)} m3 to remove"
    share = f", {percent(found.share)} of them stay within" if found.share else ""
    least = "at least " * (found.kind is Kind.FLOOR)
    return f"{least}{volume}, {OF[found.source]}{share}{beside(found)}"


def beside(found: Answer) -> str:
    """What the other study gives."""
    if found.source is Source.ENSEMBLE:
        return of_other("the paper's study", found.paper and found.paper.volume)
    return of_other("95 % of known events", found.ensemble and found.ensemble.quantiles[0.95][0])


def of_other(what: str, volume: Optional[float]) -> str:
    return "" if volume is None else f"; {what}: {quantities.number(volume)} m3"


def text(reason: Reason) -> str:
    """A reason as a sentence without its full stop."""
    code, of = reason.code, reason.numbers
    if code is Code.BEYOND:
        return f"no run goes beyond {rounded(of['longest_m'], 4)} m, where {percent(of['far'])} of known events go on"
    if code in (Code.NOT_REACHED, Code.ONE_SCATTER):
        shares = " to ".join(dict.fromkeys(map(percent, (of["low"], of["high"]))))
        longest = "no run leaves a deposit" if of["longest_m"] is None else \
            f"the longest one ends at {rounded(of['longest_m'], 4)} m"
        return (f"no run reaches the road, {rounded(of['near_m'], 4)} m along the fall path ({longest}), but {shares} "
                "of known events do" + (", by one of the two scatters that are known of them" if code is
                                        Code.ONE_SCATTER else ""))
    if code is Code.TERRAIN:
        return (f"the fall path, or the terrain, ends at {rounded(of['path_m'], 4)} m, which {percent(of['share'])} of "
                "known events go beyond: take a larger terrain")
    if code is Code.RANGE:
        ends = f", which end at {of['ends']}," if of["ends"] else ""
        return f"no values within the ranges{ends} are expected to go farther: give wider ranges"
    if code is Code.RUNS:
        return f"{of['points']} runs were added towards longer ones; a larger --sample allows more"
    if code is Code.FEW:
        return "the runs are too few to tell which parameters go farther: take more points"
    if code is Code.SIZE:
        return of_size(of)
    return f"{STUDY[of['source']]}: withheld by the rule {of['rule']}"


def of_size(of: Mapping[str, Any]) -> str:
    """Why smaller balls may bring more, and how much they brought elsewhere."""
    run, balls = of.get("run", "finished"), of["balls_thick"]
    if not run:
        text = "what smaller balls bring is not known, no run with them was made: the number is not conservative"
    elif run == "failed" or balls is None:
        text = "the run with smaller balls, which may bring more, did not finish"
    else:
        text = (f"the finest balls are {balls:.2g} over the thickness of the body: smaller ones, {of['enough']:g} or "
                "more, may bring more")
    return f"{text}{grown(of)}"


def grown(of: Mapping[str, Any]) -> str:
    """By which factors slides of the family grew with smaller balls, "" where none tells."""
    growth = of.get("growth")       # none in older files
    if not growth:
        return ""
    slides = f"{growth['slides']} slides" if growth["slides"] > 1 else "one slide"
    factors = f"{growth['median']:.2f}" + (f" (median; {growth['low']:.2f} to {growth['high']:.2f})"
                                           if growth["slides"] > 1 else "")
    return (f"; from {of['balls_thick']:.2g} to up to {growth['finest']:.2g} balls over the thickness {slides} brought "
            f"{factors} times as much")
