"""Whether the number of a study may be used: the Facts that withheld looks at, from its rows; the command that mends
each reason, and what is said in the place of the number."""
from pathlib import Path
from shlex import quote
from typing import Any, List, Mapping, NamedTuple, Optional, Sequence

from ..deposits import left_words
from ..deposits.passed import COUNT
from ..digits import cents, percent
from ..findings import Finding, texts
from ..runs import again
from ..statistics.withheld import (BALLS, CONFIDENCE, Facts, Kind, exceeded_at_most, judge_lost_mass, reasons,
                                   unfinished)
from . import how_far, study_types
from .how_far import EventsAtRoad
from .rows import Finished, Row, finished_of

UNUSABLE = "not usable as a number to design with"
MARGIN = 1.1            # of the balls: chance
LEAST = 2.0             # times the balls: fewer tell hardly more than the study that is there


class Case(NamedTuple):
    """What was run: for the command that mends a reason."""
    deck: Path
    site: Optional[Path]            # its folder, where it is one
    variables: Mapping[str, Any]    # of a run: name and value
    balls: int                      # in the body
    sampled: bool = False           # an ensemble
    given: Any = None               # the request of the study; None: not known


def left_before(row: Finished) -> float:
    """m3 that left the terrain with the road ahead, on it or close to it; where nobody knows which, all that left."""
    known = row.at_road.left_before_road_m3
    return row.off_grid_m3 + row.lost_m3 if known is None else known


def facts(rows: Sequence[Row], volume: float, on_road: float, events: Optional[EventsAtRoad]) -> Facts:
    """Of the rows of a study with a road, of which one finished at least.

    volume, on_road: the number that is to be used, and its part on the road itself, m3.
    """
    finished = finished_of(rows)
    worst = max(finished, key=lambda row: left_before(row) / row.released_m3)
    left = [one for one in worst.left or () if one.get("where") in COUNT]
    where = f": {left_words.where(left)}" if left else ": it is not known where, as the runs are of an older version" \
        if worst.at_road.left_before_road_m3 is None else ""
    return Facts(volume, on_road, min(row.ball_m3 for row in finished), len(rows), len(rows) - len(finished),
                 sum(not row.at_rest for row in finished), left_before(worst) / worst.released_m3,
                 how_far.longest(finished), events and events.median, where, left_words.to_add(left))


def reasons_of_ensemble(rows: Sequence[Row], events: Optional[EventsAtRoad], case: Case) -> List[Finding]:
    """Why the quantiles of an ensemble are withheld; empty: they may stand.

    Of volumes the largest of all runs count: where even those govern nothing, no quantile does. Without a road lengths
    count, which runs that were cut short do not tell.
    """
    finished = finished_of(rows)
    if not all(row.road for row in finished):
        cut = unfinished(Facts(0.0, 0.0, 1.0, len(rows), len(rows) - len(finished),
                               sum(not row.at_rest for row in finished), 0.0, None, None))
        return with_remedies([cut] if cut else [], case)
    largest = max(row.at_road.remove_m3 for row in finished)
    on_road = max(row.at_road.remove_on_road_m3 for row in finished)
    return with_remedies(reasons(facts(rows, largest, on_road, events)), case)


def reasons_of_sweep(best: study_types.Conservative, rows: Sequence[Row], events: Optional[EventsAtRoad],
                     case: Case) -> List[Finding]:
    """Why the conservative volume is withheld; empty: it may stand."""
    mine = [row.at_road.remove_on_road_m3 for row in finished_of(rows) if row.set == best.set]
    assert best.volume_m3 is not None        # until it is judged
    return with_remedies(reasons(facts(rows, best.volume_m3, sum(mine) / len(mine), events)), case)


def doubts_of_shares(rows: Sequence[Row]) -> List[Finding]:
    """Why more of the runs, of which one finished at least, may block a road than are seen to."""
    known = facts(rows, 0.0, 0.0, None)
    return [found for rule in (judge_lost_mass, unfinished) if (found := rule(known))]


# --- what mends a reason ---

def suggest_withheld_remedy(reason: Finding, case: Case) -> str:
    """The command that mends it."""
    if reason.kind == Kind.BALLS:
        return finer(case, times_the_balls(reason.numbers["number"]))
    if reason.kind == Kind.MOBILITY:
        return mobile(case)
    if reason.kind == Kind.LEFT:
        more = f", by {reason.numbers['add']}" if reason.numbers["add"] else ""
        return changed(case, f"a larger elevation model{more} (terrain.files, terrain.bounds)",
                       f"a larger terrain and box in the deck{more}")
    if 2 * reason.numbers["failed"] > reason.numbers["number"]:
        return f"once the cause of the failures is removed: {repeat_command(case, 'the same command again')}"
    if case.site is None and "duration" in case.variables:
        return with_value(case, "duration", twice(case))
    return changed(case, "more time (model.duration)", "more time in the deck")


def times_the_balls(on_road: float) -> float:
    """How many times the balls bring enough of them to a road on which so many lie."""
    return max(LEAST, MARGIN * BALLS / max(on_road, 1.0))


def finer(case: Case, factor: float) -> str:
    """The same with so many times the balls."""
    number = round(float(f"{factor * case.balls:.2g}"))
    if case.site:
        return anew(case, f" --balls {number}")
    try:
        return with_value(case, "d", f"{float(case.variables['d']) / factor ** (1 / 3):.3g}")
    except (KeyError, ValueError):
        return f"the same with smaller balls, about {number:,.0f} of them"


def mobile(case: Case) -> str:
    """An ensemble that has mobile masses too, weighted by the known events."""
    if case.sampled:
        return "the same command with --vary of more mobile masses: less friction and rolling, a denser field"
    known = {"sample": 64, "known": "rock_avalanches"}
    ranges = {name: span for name, span in (("friction", "10:30"), ("rolling", "0:0.1")) if name in case.variables}
    if case.site:
        place = quote(str(case.site))
        return again.command(case.given, paper=False, fine=None, **known) if case.given else (
            f"tools/slope study {place} --sample 64 --known rock_avalanches")
    if not ranges:
        return "a calibration with a past event: tools/slope calibrate --help"
    if case.given:
        return again.command(case.given, **again.as_ensemble(case.given, ranges, **known))
    return ("the same command with --sample 64 --known rock_avalanches " +
            " ".join(f"--vary {name}={span}" for name, span in ranges.items()) + " instead of --set")


def changed(case: Case, in_site: str, in_deck: str) -> str:
    """What must be changed, and what is run then."""
    if not case.site:
        return f"{in_deck}, then: {repeat_command(case, 'the same command with --anew', anew=True)}"
    return f"{in_site} in {quote(str(case.site))}/site.yaml, then: {anew(case)}"


def anew(case: Case, options: str = "") -> str:
    """A site and its study, or ensemble, once more; runs of the deck before are not mixed with new ones."""
    study = f" && {again.command(case.given, anew=True)}" if case.given else "; the same command with --anew"
    return f"tools/slope site {quote(str(case.site))}{options}{study}"


def repeat_command(case: Case, words: str, **changes: Any) -> str:
    """The command once more; words: for it, where it is not known."""
    return again.command(case.given, **changes) if case.given else words


def with_value(case: Case, name: str, value: str) -> str:
    """The same with another value of a variable."""
    words = f"the same command with --set {name}={value}"
    return again.command(case.given, **again.with_value(case.given, name, value)) if case.given else words


def twice(case: Case) -> str:
    try:
        return f"{2 * float(case.variables['duration']):g}"
    except ValueError:
        return "SECONDS"


def with_remedies(several: Sequence[Finding], case: Case) -> List[Finding]:
    """Reasons with what mends each."""
    return [one._replace(remedy=suggest_withheld_remedy(one, case)) for one in several]


def describe_withheld(withheld: Sequence[Finding]) -> List[str]:
    """What stands in the place of the number, of with_remedies()."""
    return [f"{UNUSABLE}:", *(f"  {text}" for text in texts(withheld))]


def zero(runs: int, known: Optional[float]) -> study_types.Zero:
    """What study.yaml says of a volume of 0: with which probability it is exceeded.

    known: the share of known events that go as far as the road, None where no set covers the mass.
    """
    most = exceeded_at_most(runs)
    which = f"any of {runs} runs" if runs > 1 else "the only run"
    words = (f"nothing is to be removed in {which}: in another one something is with a probability of at most "
             f"{cents(most)} ({100 * CONFIDENCE:g} % confidence)")
    if known is not None:
        words += f"; {percent(known)} of known events of this volume and height go as far as the road"
    return study_types.Zero(runs, most, known, words)
