"""Whether the number of a study may be used: the Facts that withheld looks at, from its rows; and how far known events
of the mass, and its runs, go: reach(), and at a road compute_events_at_road()."""
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..deposits import deposit, left_words, scar, travel_shares
from ..deposits.road_sides import BEFORE
from ..findings import Finding
from ..mobility import how_far, known
from ..mobility.road import at_road
from ..mobility.run_length import ON_PATH
from ..statistics import entries, withheld
from ..statistics.withheld import Facts
from . import study_types, withheld_words
from .rows import Finished, Row, finished_of
from .withheld_words import Case


class Events(NamedTuple):
    """What known events of the mass's volume and height did.

    median: m, length that half of them exceed, that of the fall path where it ends before; None: they withhold nothing,
    see known.Found.strict. near, far: m, the edges of the road; reached, passed: shares of them beyond these, by the
    smaller and the larger scatter.
    """
    median: Optional[float]
    near: float
    far: float
    reached: Tuple[float, float]
    passed: Tuple[float, float]

    def road(self, rows: Sequence[Finished]) -> entries.Road:
        """With the runs of a study."""
        return entries.Road(self.near, self.far, sorted(self.reached), sorted(self.passed), longest(rows),
                            at_the_road(rows))


def known_of(prefix: Path, terrain: Optional[Path], choice: Mapping[str, Any],
             site: Optional[Path] = None) -> known.Known:
    """The mass of a run among known events; prefix: of its deposit; terrain: the ground before it; choice: of the
    events, see known.of_about(); site: see known.of_mass()."""
    read = deposit.read_deposit(prefix, terrain, lambda text: None)
    return known.of_mass(read.raster, *scar.before(read.raster, read.base, terrain), choice, site)


def reach(rows: Sequence[Finished], source: Optional[entries.Source], among: known.Known) -> Optional[how_far.Reach]:
    """How far the mass of runs goes, without those that were added for their length; source: None of a run alone."""
    mine = [row for row in rows if row.length_m is not None and not row.batch]
    lengths = [math.inf if travel_shares.lost(row) else row.length_m or 0.0 for row in mine]
    return how_far.pool(lengths, among.found and among.found.decides, source.value if source else None,
                        mine[0].length_is or ON_PATH if mine else ON_PATH, among.why)


def compute_events_at_road(mobilities: Optional[known.Found], road: Any) -> Optional[Events]:
    """What they did at a road, polygons in local metres; None where the mass has no fall path."""
    if mobilities is None:
        return None
    one, median = mobilities.decides, mobilities.strict and mobilities.strict.length_at(0.5)
    if mobilities.strict and median is None:
        median = float(one.path.length[-1])
    at = at_road(one.path, road)
    return Events(median, at.length, at.passed, one.shares(at.length), one.shares(at.passed))


def longest(rows: Sequence[Finished]) -> Optional[float]:
    """Length (m) of the longest of the runs that finished."""
    return max((row.length_m for row in rows if row.length_m is not None), default=None)


def at_the_road(rows: Sequence[Finished]) -> entries.AtRoad:
    """How many of the runs that finished bring a ball to the road, or past it: what lies there at the end, or left the
    terrain there. A lobe counts, however small.
    """
    ball = [row.ball_m3 for row in rows]
    past = [row.at_road.beyond_road_m3 or 0.0 for row in rows]
    brought = [(row.at_road.on_road_m3 or 0.0) + one for row, one in zip(rows, past)]
    balls, most = max((one / size, one) for one, size in zip(brought, ball))
    left = [row.at_road.remove_m3 for row in rows if row.at_road.remove_m3]
    return entries.AtRoad(len(rows), sum(one >= size for one, size in zip(brought, ball)),
                          sum(one >= size for one, size in zip(past, ball)), most, balls, min(left, default=0.0),
                          max(left, default=0.0))


def left_before(row: Finished) -> float:
    """m3 that left the terrain with the road ahead; where it is not known which balls did, all that left."""
    known = row.at_road.left_before_road_m3
    return row.off_grid_m3 + row.lost_m3 if known is None else known


def facts(rows: Sequence[Row], volume: float, on_road: float, events: Optional[Events]) -> Facts:
    """Of the rows of a study with a road, of which one finished at least.

    volume, on_road: the number that is to be used, and its part on the road itself, m3.
    """
    finished = finished_of(rows)
    worst = max(finished, key=lambda row: left_before(row) / row.released_m3)
    left = [one for one in worst.left or () if one.get("where") == BEFORE]
    where = f": {left_words.where(left)}" if left else ": it is not known where, as the runs are of an older version" \
        if worst.at_road.left_before_road_m3 is None else ""
    return Facts(volume, on_road, min(row.ball_m3 for row in finished), len(rows), len(rows) - len(finished),
                 sum(not row.at_rest for row in finished), left_before(worst) / worst.released_m3,
                 longest(finished), events and events.median, where, left_words.to_add(left))


def reasons_of_ensemble(rows: Sequence[Row], events: Optional[Events], case: Case) -> List[Finding]:
    """Why the quantiles of an ensemble with a road are withheld; empty: they may stand.

    Of volumes the largest of all runs count: where even those govern nothing, no quantile does.
    """
    finished = finished_of(rows)
    largest = max(row.at_road.remove_m3 for row in finished)
    on_road = max(row.at_road.remove_on_road_m3 for row in finished)
    return withheld_words.with_remedies(withheld.reasons(facts(rows, largest, on_road, events)), case)


def judge(best: study_types.Conservative, rows: Sequence[Row], events: Optional[Events],
          case: Case) -> study_types.Conservative:
    """The entry of the conservative volume with why it is withheld, and if it is 0, with what that is worth.

    A volume that is withheld is None there, so that no reader takes it for one.
    """
    mine = [row.at_road.remove_on_road_m3 for row in finished_of(rows) if row.set == best.set]
    assert best.volume_m3 is not None        # until it is judged
    found = withheld.reasons(facts(rows, best.volume_m3, sum(mine) / len(mine), events))
    if found:
        return replace(best, withheld=withheld_words.with_remedies(found, case), volume_m3=None,
                       rounded={**best.rounded, "volume_m3": None})
    if best.volume_m3 == 0:
        return replace(best, zero=withheld_words.zero(len(finished_of(rows)), events and max(events.reached)))
    return best
