"""How far a mass goes, by its runs and by known events together, and who of both comes to a road.

Both count half (a linear pool; Stone, Annals of Mathematical Statistics, 32, 1339 (1961)), so that its quantiles lie
between theirs. Lengths are along the fall path.
"""
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..deposits import deposit
from ..mobility import body, known
from ..mobility.known import Mobility
from ..mobility.run_length import ON_PATH
from ..statistics import entries
from .rows import Finished, Row, finished_of

TAIL = 0.05             # of the pool, which ends before near_m and goes beyond far_m
BAND = 0.1              # of each of both, whose bands may lie apart


@dataclass(frozen=True)
class Reach:
    """What half of the pool, and TAIL at either end, stay within; None: they go beyond the terrain (end_m).

    runs: how many, of which study (entries.Source; None: a run alone); along: run_length.ON_PATH or STRAIGHT; events:
    whether known events count; why: not; farther: who goes farther, where the bands lie apart; least_m: nearer the
    events tell nothing; cut: how many of the runs were not at rest when they ended, and may go farther;
    failed: others, of which nobody knows.
    """
    near_m: Optional[float]
    middle_m: Optional[float]
    far_m: Optional[float]
    end_m: Optional[float]
    least_m: float
    runs: int
    source: Optional[str]
    along: str
    events: bool
    why: str
    farther: Optional[str]
    cut: int = 0
    failed: int = 0


def known_of(prefix: Path, terrain: Optional[Path], choice: Mapping[str, Any],
             site: Optional[Path] = None) -> known.Known:
    """The mass of a run among known events; prefix: of its deposit; terrain: the ground before it; choice: of the
    events, see known.of_about(); site: see known.among_events()."""
    def read() -> body.Body:
        return body.of_run(deposit.read_deposit(prefix, terrain, lambda text: None), terrain)
    return known.among_events(site, read, choice)


def reach(rows: Sequence[Row], source: Optional[entries.Source], among: known.Known) -> Optional[Reach]:
    """How far the mass of runs goes, without those that were added for their length; source: None of a run alone."""
    planned = [row for row in rows if not row.batch]
    mine = [row for row in finished_of(planned) if row.length_m is not None or row.left_box]
    lengths = [math.inf if row.left_box else row.length_m or 0.0 for row in mine]
    pooled = pool(lengths, among.found and among.found.decides, source.value if source else None,
                  mine[0].length_is or ON_PATH if mine else ON_PATH, among.why)
    return pooled and replace(pooled, cut=sum(not row.at_rest for row in mine),
                              failed=len(planned) - len(finished_of(planned)))


def pool(lengths: Sequence[float], known: Optional[Mobility], source: Optional[str] = None, along: str = ON_PATH,
         why: str = "") -> Optional[Reach]:
    """lengths: of runs (m), infinite where a run left the terrain; the others as of Reach. None without a run."""
    if not lengths:
        return None
    if known is not None and not known.in_range:
        why = "; ".join(known.outside)
        known = None
    near, middle, far = (quantile(lengths, known, share) for share in (TAIL, 0.5, 1 - TAIL))
    finite = [one for one in lengths if np.isfinite(one)]
    longest = max(finite, default=0.0)
    return Reach(near, middle, far, known.end(longest) if known else None, said_from(known), len(lengths),
                 source, along, known is not None, why, farther(lengths, known) if known else None)


def quantile(lengths: Sequence[float], known: Optional[Mobility], share: float) -> Optional[float]:
    """The length (m) that a share of the pool stays within; None where that goes beyond the terrain."""
    runs = np.sort(np.asarray(lengths, float))
    at = np.unique(np.append(known.path.length, runs[np.isfinite(runs)])) if known else runs[np.isfinite(runs)]
    before, after = np.searchsorted(runs, at) / len(runs), np.searchsorted(runs, at, "right") / len(runs)
    if known:
        ended = 1 - np.interp(at, known.path.length, known.curves[known.chosen])
        before, after = (before + ended) / 2, (after + ended) / 2
    found = np.flatnonzero(after >= share - 1e-12)
    if not len(found):
        return None
    k = int(found[0])
    if k and known and before[k] > share:      # between two points, where no run ends
        return float(np.interp(share, [after[k - 1], before[k]], at[k - 1:k + 1]))
    return float(at[k])


def said_from(known: Optional[Mobility]) -> float:
    """The length (m) at which the events begin to say something, where some of them end before; else 0."""
    if known is None or not known.said.any():
        return 0.0
    first = int(np.argmax(known.said))
    return float(known.path.length[first]) if known.curves[known.chosen][first] < 1 else 0.0


def farther(lengths: Sequence[float], known: Mobility) -> Optional[str]:
    """Who goes farther, where the middle of each lies outside of what nine tenths of the other go beyond, and a tenth;
    None: neither."""
    several = np.sort(np.asarray(lengths, float))
    middle = float(np.median(several))
    near, half, far = (bounds(known, share) for share in (1 - BAND, 0.5, BAND))
    if half[0] > several[-1] and near[0] > middle:
        return "known events"
    return "the runs" if half[1] < several[0] and far[1] < middle else None


def bounds(known: Mobility, share: float) -> Tuple[float, float]:
    """Between which lengths (m) that lies which a share of known events goes beyond; twice the same where it is known.
    """
    most, length = known.at_most(share), known.length_at(share)
    if most is not None:
        return 0.0, most
    return (float(known.path.length[-1]), math.inf) if length is None else (length, length)


# --- at a road ---

class EventsAtRoad(NamedTuple):
    """What known events of the mass's volume and height did.

    median: m, length that half of them exceed, that of the fall path where it ends before; None: they withhold nothing,
    see known.Found.strict. near, far: m, the edges of the road; reached, passed: shares of them beyond these, by the
    smaller and the larger scatter; behind: m from the path to a road behind the crown, of which they say
    nothing, else 0.
    """
    median: Optional[float]
    near: float
    far: float
    reached: Tuple[float, float]
    passed: Tuple[float, float]
    behind: float = 0.0

    def road(self, rows: Sequence[Finished]) -> entries.Road:
        """With the runs of a study."""
        return entries.Road(self.near, self.far, sorted(self.reached), sorted(self.passed), longest(rows),
                            count_brought(rows), self.behind)


def compute_events_at_road(among: known.Known, road: Any) -> Optional[EventsAtRoad]:
    """What they did at a road, polygons in local metres; None where the mass has no fall path."""
    mobilities = among.found
    if mobilities is None or among.mass is None:
        return None
    counts, median = mobilities.decides, mobilities.strict and mobilities.strict.length_at(0.5)
    if mobilities.strict and median is None:
        median = float(counts.path.length[-1])
    at, events, _ = known.way_to_road(among.mass, mobilities, road)
    if at.behind:
        return EventsAtRoad(median, at.length, at.passed, (0.0, 0.0), (0.0, 0.0), at.beside)
    shares = events.decides.shares
    return EventsAtRoad(median, at.length, at.passed, shares(at.length), shares(at.passed))


def longest(rows: Sequence[Finished]) -> Optional[float]:
    """Length (m) of the longest of the runs that finished."""
    return max((row.length_m for row in rows if row.length_m is not None), default=None)


def count_brought(rows: Sequence[Finished]) -> entries.Brought:
    """How many of the runs that finished bring a ball to the road, or past it: what lies there at the end, or left the
    terrain there. A lobe counts, however small; so does a part of a ball, or what lies beside the road, of which
    something is to be removed.
    """
    ball = [row.ball_m3 for row in rows]
    past = [row.at_road.beyond_road_m3 or 0.0 for row in rows]
    brought = [(row.at_road.on_road_m3 or 0.0) + one for row, one in zip(rows, past)]
    balls, most = max((one / size, one) for one, size in zip(brought, ball))
    removed = [row.at_road.remove_m3 for row in rows]
    left = [one for one in removed if one]
    reached = sum(bool(one >= size or volume) for one, size, volume in zip(brought, ball, removed))
    return entries.Brought(len(rows), reached, sum(one >= size for one, size in zip(past, ball)), most, balls,
                           min(left, default=0.0), max(left, default=0.0))
