"""How large the coarsest balls of a site are, how many of its points run with finer ones, and how long that takes.

Trial runs with coarse balls measure this machine (site_trial). Times in s, lengths in m.
"""
import math
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

from ..case.settings import normalise_value
from ..digits import at_least, rounded
from ..errors import SlopeError
from ..heads import GRAVITY
from ..releases import packing
from .site_sections import Balls, OfMass

DEFAULT = 400           # of the coarsest balls, if nothing is given
THIN = 1.3              # of these over the mean thickness of the body, at least, unless they are
MANY = 2000             # more than so many, of a thin body, or take too long:
COARSER = 1.1           # each so much larger than those before
MINUTES = 10.0          # that a study may take, if nothing is given,
HOUR = 60.0             # or so many where fewer sizes of balls than a number needs would fit
FEW_POINTS = 16         # of the ensemble, at least, and
COARSE_SHARE = 0.5      # of the time, at most, that all runs with the coarsest balls take with more of them
SIZES = 3               # of balls, where nobody knows how long they take: fewer give no number
MOST_SIZES = 5
PAIRS = 12, 5           # points with the next finer balls, and with those after, where no time decides
LEAST = 8, 4            # of them, at least: fewer say too little of what is between two sizes
ENOUGH = 24, 8          # at most: more time is for finer balls
LATE = 2                # of the finest, on which numbers rest once all values are at the finest size
FEWEST = 100            # balls that a budget must allow for
MOST = 10 ** 9          # far below LAMMPS' own limit, and more than any memory holds
PER_BALL = 800e-9       # GB, see the page on scaling
PER_RUN = 0.06          # GB, program and libraries
PER_CELL = 16e-9        # GB, two terrains of doubles; the deposit's rasters only cover where balls were
COLLECT = 1.5           # s of a run's volume and maps: after all runs, one after the other
REPORT = 15.0           # s of the report
LONGER = 3.0            # times as long rests the mass on the ensemble's grounds, where no trial tells
CACHED = 1200           # balls whose contacts stay in the cache
LEDGER = 1.4            # times as long takes a run that keeps account of its energy: that with half the step
SPEED = 47.0            # m/s, where no trial run tells
SLOW = 1.0              # m/s, least speed; that of the trial run, which has the stiffness that the weight needs
STIFFNESS_NUMBER = 2e4          # K: least stiffness over density of the ground, gravity, thickness and diameter
LAYERS = 7.0            # balls; bodies thicker than this need harder contacts, in proportion
STEP = 1.5              # of the rule's: the longest that holds the restitution where several contacts begin at once,
CLOSE = 0.4             # with fixed balls not closer than this, in diameters (tests/step_restitution.py)
OVERLAP = 0.05          # of the diameter: that of a contact at the largest speed
AIR = 1.2               # margin of the stiffness over the trial run's largest speed
PATIENCE = 8.0          # duration: times the trial's time to rest; runs of an ensemble on smooth ground took 4 times it
LEAST_DURATION = 120.0  # s
LONGEST = 600.0         # s of a collapse in the trial run


class Trial(NamedTuple):
    """What a run with coarse balls measured."""
    balls: int
    diameter: float
    rest: float             # s of the collapse, until it is at rest or the run ends
    at_rest: bool
    speed: float            # largest, m/s
    cost: float             # s of a core of this machine per ball and step: all of it, or what each ball adds
    setup: float            # s of a core for what does not depend on balls and steps
    seconds: float          # s of a core that it took
    left: float             # share of the mass that left the terrain
    middle: Optional[float] = None      # rest of a second trial, with the rolling resistance in the study's middle
    step: float = 0.0       # s of a core per step, whatever the number of balls
    late: Optional[float] = None        # rest of a third trial, as most runs of the ensemble have it

    @property
    def typical(self) -> float:
        """s of the collapse in most runs of the study; rest is of the first, lowest rolling resistance."""
        return self.rest if self.middle is None else self.middle

    @property
    def of_ensemble(self) -> float:
        """s of the collapse in most runs of the ensemble."""
        return LONGER * self.typical if self.late is None else self.late

    def finer(self, k: int) -> float:
        """s of the collapse on average with balls of 1/2^k of the diameter: of points that rest soon, but for the one
        on which numbers rest; 0: of the sweep, some of which has smoother grounds or the largest restitution."""
        late = 0.5 if k < 2 else 0.25
        return (1 - late) * self.typical + late * self.of_ensemble

    def run(self, d: float, balls: float, soil: "Soil", rest: float) -> float:
        """s of a core that a run with balls of diameter d (m) takes whose collapse takes so long (s)."""
        # what more balls save of a step's own time is lost again where they leave the cache
        own = self.step * max(1.0, balls / CACHED)
        return self.setup + rest / time_step(d, soil) * (own + balls * self.cost)


class Size(NamedTuple):
    """The balls of a site, and the time and memory of its study."""
    diameter: float
    balls: int
    runs: int
    seconds: Optional[float]    # of the study on this machine; None without a trial run
    most: Optional[float]       # with all runs that may be added to it
    gigabytes: float            # of all runs that are active at a time
    text: str                   # the runs in words
    finest: float               # diameter of the finest balls, m


class Soil(NamedTuple):
    """What the time step depends on, beside the diameter of the balls."""
    density: float          # of a ball, kg/m3
    thick: float            # largest thickness of the body, m
    speed: float            # largest, m/s
    spacing: float          # the least of the ground's balls, diameters: the step depends on it, too


def time_step(d: float, soil: Soil) -> float:
    """The deck's time step (s) for balls of diameter d (m)."""
    density, thick, speed, spacing = soil
    mass = density * math.pi / 6 * d ** 3
    by_weight = STIFFNESS_NUMBER * max(1.0, thick / (LAYERS * d)) * density * packing.SOLID * GRAVITY * thick * d
    by_speed = mass * (speed / (OVERLAP * d)) ** 2
    return (STEP if spacing >= CLOSE else 1.0) * 0.25 * math.sqrt(mass / max(by_weight, by_speed))


def in_steps(rest: float, spacing: Optional[str]) -> float:
    """The time (s) of a collapse, longer where it has more steps; spacing: of the ground's balls, a deck's variable."""
    close = normalise_value(spacing or "")
    return rest * (STEP if isinstance(close, float) and close < CLOSE else 1.0)


def three_digits(value: float) -> float:
    return float(f"{value:.3g}")


# --- the size ---

class Plan(NamedTuple):
    """The runs that `slope study` makes of a site."""
    sweep: int                          # runs of the sweep, on which its number rests
    elastic: int                        # those with the largest restitution
    half_step: bool                     # and one with half the time step, which is compared by the volume to remove
    points: int                         # of the ensemble, which may become twice as many
    words: str                          # of the sweep

    @property
    def text(self) -> str:
        """All runs in words."""
        return self.words + (f"; {self.points} runs weighted by known events, and up to as many more where these go "
                             "farther (study --paper leaves them out)") * bool(self.points)

    @property
    def runs(self) -> int:
        return self.sweep + self.elastic + self.points


def plan_budget(choices: OfMass) -> Plan:
    """Of the sweep, and of the ensemble that is weighted by known events."""
    study, points, grounds = choices.study, choices.study.points, choices.other_grounds
    each = 1 + len(study.packing)
    elastic = each if study.largest_restitution else 0
    sweep = each * len(study.rolling) + len(grounds)
    text = f"{sweep + elastic} runs: {len(study.rolling)} rolling resistances x {each} packings"
    if grounds:
        text += f", {len(grounds)} on other grounds"
    if elastic:
        text += f", {elastic} with the largest restitution"
    return Plan(sweep, elastic, bool(choices.road.file), points, text)


# --- finer balls ---

def pairs(points: int, sizes: int) -> List[int]:
    """How many of so many points run with each of the finer balls, where no time decides."""
    return [min(points, PAIRS[min(k, 1)]) for k in range(sizes - 1)]


def within(points: int, seconds: Callable[[int], float], left: float, asked: Optional[int] = None,
           least: int = 1) -> List[int]:
    """The same where time decides: seconds(k) of a run with balls of 1/2^k of the diameter, left (s) for all of these.

    asked: so many sizes, and least: so many at least, whatever they take. First one size more with the least of points,
    then points of the finest.
    """
    def cost(numbers: List[int]) -> float:
        return sum(number * seconds(k) for k, number in enumerate(numbers, 1))

    def of(sizes: int, last: int) -> List[int]:
        """So many points of the finest, three times as many of the first of several sizes."""
        first = max(LEAST[0], min(ENOUGH[0], 3 * last))
        return [min(points, first if k == 0 and sizes > 2 else last) for k in range(sizes - 1)]

    sizes = asked or max([least, *(one for one in range(2, MOST_SIZES + 1) if cost(of(one, LEAST[1])) <= left)])
    fits = [last for last in range(LEAST[1], ENOUGH[1] + 1) if cost(of(sizes, last)) <= left]
    return of(sizes, max(fits, default=LEAST[1]))


class Time(NamedTuple):
    """That runs with finer balls may take: one(k, rest) s of a core of a run with balls of 1/2^k of the diameter whose
    collapse takes rest (s); rest(k): of these on average; whole: of all of these runs, where these are more sizes than
    least: as many as a number needs, if they fit in an HOUR and no minutes are given."""
    one: Callable[[int, float], float]
    rest: Callable[[int], float]
    whole: float
    least: int              # sizes of balls, whatever they take


def time_of(d: float, volume: float, trial: Trial, soil: Soil, wanted: Plan, jobs: int,
            minutes: Optional[float]) -> Time:
    """What a study of so many minutes, None: not given, leaves them; d: of the coarsest balls."""
    coarse = study_seconds(d, volume, trial, soil, wanted, jobs, ())[0]

    def one(k: int, rest: float) -> float:
        return trial.run(d / 2 ** k, packing.count_balls(volume, d / 2 ** k), soil, rest) + COLLECT * jobs

    def left(budget: float) -> float:
        return jobs * (60 * budget - coarse)

    def seconds(k: int) -> float:
        return one(k, trial.finer(k))

    enough = sum(each * seconds(k) for k, each in enumerate(
        within(wanted.sweep + wanted.points, seconds, 0.0, SIZES), 1))
    least = SIZES if not minutes and enough <= left(HOUR) else 1
    return Time(one, trial.finer, left(minutes or (MINUTES if least > 1 else HOUR)), least)


def finer(points: int, time: Optional[Time], asked: Optional[int]) -> List[int]:
    """How many of so many points run with each of the finer balls; asked: sizes, None: as time allows; where no time
    is known, as many as a number needs."""
    if time is None:
        return pairs(points, asked or SIZES)
    one, rest = time.one, time.rest
    return within(points, lambda k: one(k, rest(k)), time.whole, asked, time.least)


def fit_points(d: float, volume: float, trial: Optional[Trial], soil: Soil, wanted: Plan, jobs: int,
               minutes: Optional[float]) -> Plan:
    """With half of the ensemble's points or fewer, where all would take most of the time; as of time_of()."""
    most = COARSE_SHARE * 60 * (minutes or HOUR)
    while trial and wanted.points >= 2 * FEW_POINTS and \
            study_seconds(d, volume, trial, soil, wanted, jobs, ())[0] > most:
        wanted = wanted._replace(points=wanted.points // 2)
    return wanted


def study_seconds(d: float, volume: float, trial: Trial, soil: Soil, wanted: Plan, jobs: int,
                  numbers: Sequence[int]) -> Tuple[float, float]:
    """What a study takes on this machine, with coarsest balls of diameter d in a body of that volume (m3); and at most.

    numbers: of points with each of the finer balls.
    """
    def run(size: float, rest: float) -> float:
        return trial.run(size, packing.count_balls(volume, size), soil, rest)

    total = (wanted.sweep + wanted.elastic) * run(d, trial.finer(0))
    total += sum(number * run(d / 2 ** k, trial.finer(k)) for k, number in enumerate(numbers, 1))
    if wanted.half_step:
        total += run(d, 2 * LEDGER * trial.typical)
    points = wanted.points * (run(d, trial.of_ensemble) / jobs + COLLECT)
    least = total / jobs + COLLECT * (wanted.runs - wanted.points + wanted.half_step + sum(numbers)) + REPORT + points
    return least, least + points


def gigabytes(d: float, volume: float, cells: int, jobs: int, sizes: int) -> float:
    """The memory of all runs that are active at a time, with the finest balls; sizes: of balls."""
    return jobs * (PER_RUN + PER_CELL * cells + PER_BALL * packing.count_balls(volume, d / 2 ** (sizes - 1)))


def fit_budget(budget: float, cost: Callable[[float], float], volume: float) -> float:
    """The smallest diameter (m) whose cost(d), which falls with d, is within a budget; SlopeError if none is."""
    low, high = packing.compute_diameter(volume, MOST), packing.compute_diameter(volume, FEWEST)
    if cost(high) > budget:
        raise SlopeError("--memory", f"must be at least {at_least(cost(high), 3)} GB, which a study with {FEWEST} "
                         "balls takes", f"{budget:g}")
    if cost(low) <= budget:
        return low
    for _ in range(60):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if cost(middle) > budget else (low, middle)
    return high


def stiff_to(trial: Optional[Trial]) -> float:
    """The speed (m/s) for which the stiffness must be sufficient."""
    return max(SLOW, float(f"{AIR * trial.speed:.2g}")) if trial else SPEED


def duration(trial: Optional[Trial]) -> float:
    """The time limit of a run, s."""
    return max(LEAST_DURATION, 10.0 * math.ceil(PATIENCE * trial.rest / 10)) if trial else LONGEST


def size(choices: OfMass, volume: float, depth: float, soil: Soil, trial: Optional[Trial], jobs: int,
         cells: int) -> Size:
    """The coarsest balls by the first of diameter, number, memory that is given; SlopeError if there are none such.

    volume: of the body, m3; depth: its mean thickness, m; cells: of the terrain.
    """
    balls, levels = choices.balls, choices.study.levels

    def wanted_of(d: float) -> Plan:
        return fit_points(d, volume, trial, soil, plan_budget(choices), jobs, balls.minutes)

    if balls.diameter:
        d = balls.diameter
    elif balls.number:
        d = three_digits(packing.compute_diameter(volume, balls.number))
    elif balls.memory:
        d = up(fit_budget(balls.memory, lambda diameter: gigabytes(diameter, volume, cells, jobs, levels or SIZES),
                          volume))
    else:
        least, most = (packing.compute_diameter(volume, number) for number in (MANY, DEFAULT))
        d = min(most, max(least, depth / THIN))
        while trial and d < most and study_seconds(d, volume, trial, soil, wanted_of(d), jobs, ())[0] > \
                COARSE_SHARE * 60 * (balls.minutes or HOUR):
            d = min(most, COARSER * d)      # a thin body is rough with all of them
        d = three_digits(d)
    wanted = wanted_of(d)
    time = time_of(d, volume, trial, soil, wanted, jobs, balls.minutes) if trial else None
    numbers = finer(wanted.sweep + wanted.points, time, levels)
    seconds = study_seconds(d, volume, trial, soil, wanted, jobs, numbers) if trial else (None, None)
    return Size(d, number_of(balls, volume, d), wanted.runs, *seconds,
                gigabytes(d, volume, cells, jobs, 1 + len(numbers)), wanted.text + finer_text(numbers),
                d / 2 ** len(numbers))


def finer_text(numbers: Sequence[int]) -> str:
    """Of how many points run with finer balls, "" of none."""
    parts = [f"{number} with balls of 1/{2 ** k} of the diameter" for k, number in enumerate(numbers, 1)]
    return f"; of all points {', '.join(parts)}" if parts else ""


def number_of(balls: Balls, volume: float, d: float) -> int:
    """The balls of diameter d (m) that a body (m3) is made of; SlopeError if they are too large or too many."""
    number = round(packing.count_balls(volume, d))
    if not 1 <= number <= MOST:
        raise SlopeError("--diameter" if balls.diameter else "--balls", f"must make 1 to {MOST:,} balls "
                         f"of a body of {rounded(volume)} m3: {'smaller' if number < 1 else 'larger'} ones",
                         f"{number:,} of {d:g} m")
    return number


def up(value: float) -> float:
    """Three digits, not less than the value."""
    rounded = three_digits(value)
    return rounded if rounded >= value else three_digits(value * 1.005)


def duration_text(seconds: float) -> str:
    """A time in words."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} minutes" if seconds < 5400 else f"{seconds / 3600:.1f} hours"
