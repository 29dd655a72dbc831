"""The runs of points with finer balls: how many points, which, and their rows at the finest size (tables/sizes).

All points run with the coarsest balls.  Of these some run with finer ones, too: such on which numbers rest, and such
that parameters and lengths are spread; those with the finest rest soon, and have all sizes.
"""
import math
from dataclasses import replace
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .. import disk
from ..case.settings import normalise_value, check_settings
from ..digits import metres
from ..errors import SlopeError
from ..findings import Finding
from ..runs import jobs, store
from ..runs.repeats import Repeat
from ..sites import site_budget
from ..statistics import ball_sizes, conservative_volume
from ..tables import combinations, judged, sizes, study_table, study_types
from ..tables.quantities import REMOVE
from ..tables.rows import Finished, find_farthest_run, finished_of
from ..tables.sizes import VARIABLE, Sizes
from . import body_depth
from .run_rows import read_run_rows
from .setup import Setup

OPTION = "--levels"
FILE = "levels.csv"
MORE = 4                # of the finest than were wanted, on which numbers rest once all values are at the finest size
LONG = 1.5              # times the usual time to rest: points that take longer have none of the finest balls,
SLOW = 4.0              # and, as those on which numbers rest of these, none finer than the coarsest
FINER = 1.5             # times, at least, from a size to the next one


class Wanted(NamedTuple):
    """values: diameters for the deck, the coarsest first; points: how many with each of the finer ones; time: that
    these may take, None: not known; more: finished runs with finer ones count, too."""
    values: Sequence[str]
    points: Sequence[int]
    time: Optional[site_budget.Time] = None
    more: bool = False

    def with_finished(self, finished: Callable[[str], int]) -> "Wanted":
        """With all diameters of which there are enough; finished: how many runs of one are."""
        values = list(self.values)
        while self.more and finished(next_ := halved_times(values[0], len(values))) >= sizes.FEWEST:
            values.append(next_)
        return self._replace(values=values)

    def fitted(self, rests: Sequence[Sequence[float]]) -> "Wanted":
        """With as many points as time allows; rests: for each finer size, of all that may be, in their order, the times
        of their coarse runs."""
        if not self.time or not self.points:
            return self
        means = [float(np.mean([self.time.one(k, rest) for rest in several[:number]]))
                 for k, (several, number) in enumerate(zip(rests, self.points), 1)]
        return self._replace(points=site_budget.within(
            len(rests[-1]), lambda k: means[k - 1], self.time.whole, len(self.points) + 1))

    @property
    def settings(self) -> Dict[str, List[str]]:
        """As a study of lists has it."""
        return {VARIABLE: list(self.values)}


class SizeRun(Repeat):
    """The run of a point with balls of a diameter."""

    def __init__(self, output: Path, point: Repeat, value: str):
        super().__init__(output, point.combination, point.repeat)
        self.batch = point.batch
        self.chosen = {**self.chosen, VARIABLE: value}
        self.move(Path(output) / jobs.name_run(self.chosen))
        self.varied = f"{point.varied}, {VARIABLE} {value}"

    def made(self, runs: store.Store) -> bool:
        """Whether it is there."""
        runs.admit([self])
        return self.finished


class Made(NamedTuple):
    """Points, and those of their runs that have finer balls: {folder of a point: of each finer size, None: not run}.

    next: points that may have them, in the order in which they come.
    """
    points: Sequence[Repeat]
    finer: Dict[Path, List[Optional[Repeat]]]
    next: Sequence[Repeat] = ()

    def runs(self, point: Repeat) -> List[Optional[Repeat]]:
        """Of a point, that finished, the coarsest first."""
        return [run if run and run.finished and not run.error else None
                for run in (point, *self.finer.get(point.folder, ()))]

    def has(self, point: Repeat, k: int) -> bool:
        """Whether the run of a point with the k-th of the finer balls was wanted."""
        return point.folder in self.finer and self.finer[point.folder][k] is not None

    def finest(self, points: Sequence[Repeat], levels: int) -> List[Repeat]:
        """The finest run of each point that finished, of so many sizes; the point's own where none did."""
        return [next((run for run in self.runs(one)[:levels][::-1] if run), one) for one in points]


class AtFinest(NamedTuple):
    """Runs of points, and what they say of sizes; sizes: None of one size."""
    made: Made
    sizes: Optional[Sizes]
    warnings: Sequence[Finding] = ()

    @property
    def finest(self) -> Optional[float]:
        """The diameter of the finest balls that tell, m; None of one size."""
        return self.sizes.diameters[-1] if self.sizes else None

    def runs(self, points: Sequence[Repeat]) -> List[Repeat]:
        """The finest run of each point."""
        return self.made.finest(points, len(self.sizes.diameters) if self.sizes else 1)


# --- how many ---

def of_deck(option: Optional[str], deck: Path, points: int, names: Sequence[str]) -> Optional[Wanted]:
    """What --levels d=5,2.5,1.25 asks of so many points; None without it; names: of what the study varies or sets."""
    if option is None:
        return None
    if "=" not in option:
        raise SlopeError(OPTION, f"must give diameters for a deck, such as {VARIABLE}=5,2.5,1.25", option)
    if VARIABLE in names:
        raise SlopeError(OPTION, "must not name a variable that --set, --vary or --repeat names", VARIABLE)
    [(name, values)] = check_settings([option], deck, OPTION).items()
    numbers = [normalise_value(value) for value in values]
    if name != VARIABLE:
        raise SlopeError(OPTION, f"must name {VARIABLE}, the variable of the deck that is the diameter of the balls",
                         name)
    sizes_ = [one if isinstance(one, float) and one < math.inf else 0.0 for one in numbers]
    for one, other in zip(sizes_, [*sizes_[1:], 0.0]):
        if one <= 0 or one < (1 - 1e-9) * FINER * other:
            raise SlopeError(OPTION, f"must give diameters > 0, each at most 1/{FINER:g} of the one before, such as "
                             f"{VARIABLE}=5,2.5,1.25", ",".join(values))
    return Wanted(values, site_budget.pairs(points, len(values)))


def halved_times(diameter: str, number: int) -> str:
    return f"{float(diameter) / 2 ** number:.10g}"


def halved(diameter: str, numbers: Sequence[int], time: Optional[site_budget.Time] = None, more=False) -> Wanted:
    """Diameters d, d/2, d/4 and so on; time, more: as of Wanted."""
    d = normalise_value(diameter)
    if not (isinstance(d, float) and d > 0):
        raise SlopeError(OPTION, f"must be of a deck whose variable {VARIABLE} is the diameter of the balls", diameter)
    return Wanted([diameter, *(halved_times(diameter, k) for k in range(1, len(numbers) + 1))], numbers, time, more)


# --- which, and making them ---

def at_first(setup: Setup, todo: Sequence[Repeat], wanted: Optional[Wanted]) -> List[Repeat]:
    """The points with the coarsest balls that are asked for."""
    return [SizeRun(setup.runs, one, wanted.values[0]) for one in todo] if wanted else list(todo)


class Pick(NamedTuple):
    """Which points come first: names of those on which numbers rest; along: of each how far it goes, from 0 to 1."""
    first: Sequence[str]
    along: np.ndarray


def lengths_of(rows: Sequence[Finished]) -> np.ndarray:
    return np.array([row.length_m or 0.0 for row in rows])


def pick_largest(rows: Sequence[Finished]) -> Pick:
    """Of a sweep: of the combination that governs the run with most; without a road the farthest one."""
    lengths = lengths_of(rows)
    along = lengths / max(lengths.max(initial=0.0), 1e-9)
    if not rows or not rows[0].road:
        return Pick([find_farthest_run(rows).run] if rows else [], along)
    groups = combinations.grouped(rows)
    best = conservative_volume.predict([one.of(REMOVE) for one in groups]).combination
    rows = next(one.rows for one in groups if one.name == best)
    return Pick([max(rows, key=lambda row: row.at_road.remove_m3).run], along)


def make_finer_runs(setup: Setup, work: jobs.Work, points: Sequence[Repeat], wanted: Optional[Wanted],
                    pick: Callable[[Sequence[Finished]], Pick] = pick_largest) -> Made:
    """Make the runs with finer balls of points that ran with the coarsest ones, the longest first; pick: of the rows of
    these.  Runs of before that are not wanted any more are taken."""
    common = setup.road is not None and setup.road.name != ""       # studies of several roads have these runs in common
    known = finished_of(read_run_rows(setup._replace(road=None) if common else setup, points)) \
        if wanted and wanted.values[1:] else []
    if not wanted or not known:
        return Made(points, {})
    chosen, names = pick(known), {one.name: one for one in points}
    times = np.array([site_budget.in_steps(row.stop_time_s, row.variables.get("spacing")) for row in known])
    first = np.array([row.run in chosen.first for row in known])
    # without those that were added as longer ones
    usual = np.median([one for one, row in zip(times, known) if not row.batch] or times)
    orders = orders_of(times / max(usual, 1e-9), first, places_of(known, chosen.along), wanted.points)
    wanted = wanted.fitted([times[order].tolist() for order in orders])
    made = Made(points, {}, [names[known[k].run] for k in orders[-1]])
    planned = [(k, each) for k, (order, number) in enumerate(zip(orders, wanted.points)) for each in order[:number]]
    there = {(k, each) for k, value in enumerate(wanted.values[1:]) for each, row in enumerate(known)
             if SizeRun(setup.runs, names[row.run], value).made(work.store)}
    have = [sum(which == k for which, _ in there) for k in range(len(orders))]      # of those before, others, too
    missing = [(k, times[each]) for k, (order, number) in enumerate(zip(orders, wanted.points)) for each in
               [one for one in order[:number] if (k, one) not in there][:max(0, number - have[k])]]
    if wanted.points:
        setup.tell(told(wanted, len(missing), wanted.time and sum(
            wanted.time.one(k + 1, rest) for k, rest in missing) / work.jobs))
    todo = {(j, each) for k, each in without_late(planned, len(orders) - 1) for j in range(k + 1)} | there  # in pairs
    runs = [add(setup, made, wanted, names[known[each].run], k) for k, each in sorted(todo, reverse=True)]
    work.store.admit(runs)
    work.do(runs)
    return made


def without_late(planned: Sequence[Tuple[int, int]], finest: int) -> Sequence[Tuple[int, int]]:
    """Of planned runs (size, point), the finest ones last, those that come first: settle() chooses the last of the
    finest, where as many are left as tell of that size."""
    late = min(site_budget.LATE, max(0, sum(k == finest for k, _ in planned) - sizes.FEWEST))
    return planned[:len(planned) - late]


def orders_of(times: np.ndarray, first: np.ndarray, where: np.ndarray, numbers: Sequence[int]) -> List[List[int]]:
    """For each finer size the points that may have it, in the order in which they come: of the finest one on which
    numbers rest, then such as rest soon and spread out; of the first finer size these, then such as rest late, too.

    times: to rest of each, over the usual one; first: on which numbers rest; where: (n, d); numbers: of each size.
    """
    def ordered(limits, start: Sequence[int]) -> List[int]:
        inside = np.flatnonzero(times <= limits)
        return inside[ball_sizes.order_spread_points(where[inside], [int(k) for k in np.searchsorted(inside, start)],
                                                     len(inside))].tolist()

    quick = np.where(first, SLOW, LONG)
    fine = ordered(quick, np.flatnonzero(first & (times <= SLOW))[:1].tolist())
    start = fine[:numbers[-1] if len(numbers) > 1 else 1]
    return [ordered(np.full(len(times), SLOW), start), *[fine] * (len(numbers) - 1)]


def add(setup: Setup, made: Made, wanted: Wanted, point: Repeat, k: int) -> SizeRun:
    """The run of a point with the k-th of the finer balls."""
    run = SizeRun(setup.runs, point, wanted.values[k + 1])
    made.finer.setdefault(point.folder, [None] * (len(wanted.values) - 1))[k] = run
    return run


def settle(setup: Setup, work: jobs.Work, points: Sequence[Repeat], wanted: Optional[Wanted],
           pick: Callable[[Sequence[Finished]], Pick] = pick_largest) -> AtFinest:
    """make_finer_runs(), then the finest runs of those on which numbers rest once all rows are at the finest size, as
    these change what others are there; at last of others, so that there are as many as were wanted. Made again, with
    the same runs there, it has nothing to make."""
    if wanted:
        wanted = wanted.with_finished(
            lambda value: sum(SizeRun(setup.runs, one, value).made(work.store) for one in points))
    made = make_finer_runs(setup, work, points, wanted, pick)
    at = at_finest(setup, made)
    while at.sizes and wanted and wanted.points:
        have = sum(several[len(wanted.points) - 1] is not None for several in made.finer.values())
        left = max(0, wanted.points[-1] - have)
        rows = [replace(row, run=one.name) for one, row in zip(points, sizes.transfer_rows(
            at.sizes, read_run_rows(setup, at.runs(points))))]
        first = pick(finished_of(rows)).first
        without = [one for one in made.next if not made.has(one, len(wanted.points) - 1)]
        asked = [one for one in without if one.name in first] if have < wanted.points[-1] + MORE else []
        now = asked[:max(left, 1)] or without[:left]
        if not now:
            break
        todo = [add(setup, made, wanted, one, k) for k in range(len(wanted.points))[::-1] for one in now
                if not made.has(one, k)]
        work.store.admit(todo)
        finest = float(wanted.values[len(wanted.points)])
        setup.tell(f"{len(now)} more with balls of {metres(finest)}, as the values so far ask for")
        work.do(todo, share=True)
        at = at_finest(setup, made)
    return at


def told(wanted: Wanted, number: int, seconds: Optional[float]) -> str:
    """Which runs with finer balls are made, so many of them now, in how many seconds, in words."""
    parts = [f"{number} points with balls of {metres(float(value))}" for value, number in
             zip(wanted.values[1:], wanted.points)]
    took = f", about {site_budget.duration_text(seconds)}" if seconds else ""
    return f"finer balls: {', '.join(parts)}; {number} of these runs to make{took}"


def places_of(rows: Sequence[Finished], along: np.ndarray) -> np.ndarray:
    """Where points lie: their parameters, and twice as far apart as these how far they go."""
    where = sizes.places_of(rows)
    return np.column_stack([np.array([where.of(row) for row in rows]).reshape(len(rows), -1), 2 * along])


def at_finest(setup: Setup, made: Made) -> AtFinest:
    """What the runs of points say of sizes."""
    if not made.finer:
        return AtFinest(made, None)
    failed = [run for several in made.finer.values() for run in several if run and run.error]
    rows = [row for row in read_run_rows(setup, failed) if not isinstance(row, Finished)]
    warnings = [one._replace(part="finer balls") for one in judged.failed(rows)]
    several = [[run and read_run_rows(setup, [run])[0] for run in made.runs(one)] for one in made.points]
    points = [[row if isinstance(row, Finished) else None for row in one] for one in several]
    return AtFinest(made, sizes.combine_sizes(points), warnings)


def write_levels(setup: Setup, finer: AtFinest, settings, repeated, defaults) -> None:
    """levels.csv: all runs of points with several sizes, as they were run; none of one size."""
    path = setup.output / FILE
    if not finer.sizes:
        path.unlink(missing_ok=True)
        return
    runs = [run for one in finer.made.points if one.folder in finer.made.finer for run in finer.made.runs(one) if run]
    rows = [row for row in read_run_rows(setup, runs) if isinstance(row, Finished)]
    disk.write_file(path, study_table.tabulate_study({**settings, VARIABLE: []}, repeated, rows, defaults))


def summarise_finer_runs(setup: Setup, finer: AtFinest) -> Optional[study_types.Size]:
    """The entry of study.yaml."""
    if not finer.sizes:
        return None
    finest = max((run for one in finer.made.points for run in finer.made.runs(one) if run),
                 key=lambda run: -float(run.chosen.get(VARIABLE, "inf")))
    [row] = finished_of(read_run_rows(setup._replace(road=None), [finest]))
    of_run = row.released_m3 / row.ball_m3 * float(row.variables[VARIABLE]) ** 3
    return sizes.summarise_sizes(finer.sizes, body_depth.mean(setup, row),
                                 [of_run / d ** 3 for d in finer.sizes.diameters])
