"""What study.yaml has of quantiles, of emulators and of the headline: see tables/study_types."""
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

from .withheld import Kind as Rule


class Quantile(NamedTuple):
    """The value that a share of the runs stays at or below, with its bounds; None: nothing bounds it."""
    share: float
    value: float
    low: Optional[float]
    high: Optional[float]


class KnownQuantile(NamedTuple):
    """That of known events, which may have no value at all.

    gap: the values if the events that end where no run does count as the runs on either side, where these differ; the
    value is the larger of them then. transfer: how far the value may lie below and above, as runs are of several sizes.
    """
    share: float
    value: Optional[float]
    low: Optional[float]
    high: Optional[float]
    gap: Optional[Sequence[float]] = None
    transfer: Optional[Sequence[float]] = None


@dataclass(frozen=True)
class Influence:
    """What a variable does to a quantity. rank: rank correlation; first, total: Sobol indices, with their errors.

    The indices are shares of the variance that the variables make; they are None where the emulator is bad. An error is
    that of the jackknife over the folds and the share of the variance that the emulator does not explain, added as
    squares: all fits may leave out the same variable, and then differ in nothing.
    """
    rank: float
    rank_clear: bool            # whether it is larger than chance, in one of twenty
    first: Optional[float]
    first_error: Optional[float]
    total: Optional[float]
    total_error: Optional[float]


@dataclass(frozen=True)
class Check:
    """What an emulator is worth, by its cross-validation.

    explained: share of the variance of the runs left out that it explains (1 is perfect, 0 is the mean of all runs);
    error: root mean square of what it is wrong by; noise: standard deviation of a run by chance, as the process has it;
    standard_deviation: of all runs.
    """
    verdict: str
    explained: float
    error: float
    noise: float
    standard_deviation: float

    @property
    def unseen(self) -> float:
        """Share of the variance that the variables make, without chance, that it does not explain: from 0 to 1."""
        wrong, whole = self.error ** 2 - self.noise ** 2, self.standard_deviation ** 2 - self.noise ** 2
        return min(max(wrong / whole, 0.0), 1.0) if whole > 0 else 1.0


@dataclass(frozen=True)
class Analysis:
    """On which variables a quantity depends; emulator is None, and text says why, where none was made."""
    text: str
    emulator: Optional[Check]
    variables: Dict[str, Influence]


class Brought(NamedTuple):
    """Of runs: how many there are, bring a ball to the road, past it; the most that one brings, m3 and balls.

    least_m3, most_m3: to remove, of the runs after which something is; 0: of none.
    """
    runs: int
    reach: int
    passing: int
    volume: float
    balls: float
    least_m3: float = 0.0
    most_m3: float = 0.0

    def and_of(self, other: "Brought") -> "Brought":
        """Of the runs of both."""
        most = max(self, other, key=lambda at_road: at_road.balls)
        least = min((one.least_m3 for one in (self, other) if one.least_m3), default=0.0)
        return Brought(self.runs + other.runs, self.reach + other.reach, self.passing + other.passing, most.volume,
                       most.balls, least, max(self.most_m3, other.most_m3))


@dataclass(frozen=True)
class SweepPart:
    volume_m3: Optional[float]
    withheld: List[Rule]
    runs: int


@dataclass(frozen=True)
class EnsemblePart(SweepPart):
    far: float


@dataclass(frozen=True)
class Road:
    """A road on the fall path: its edges, and the shares of the known events that reach the near and pass the far one.

    Two of each, the smaller one first: of a row of landslides by the smaller and the larger scatter, of a set of events
    twice the same. longest_m: of the runs, without lobes below 1 % of the mass; None: none has a length. brought: what
    the runs bring to it, all of it. behind_m: m from the path to a road behind the crown, of which known
    events say nothing; else 0.
    """
    near_m: float
    far_m: float
    reached: Sequence[float]
    passed: Sequence[float]
    longest_m: Optional[float]
    brought: Brought
    behind_m: float = 0.0

    @property
    def missed(self) -> bool:
        """Whether no run reaches it."""
        return self.brought.reach == 0

    def and_of(self, other: "Road") -> "Road":
        """With the runs of both; the shares are those of the one body."""
        lengths = [road.longest_m for road in (self, other) if road.longest_m is not None]
        return replace(other, longest_m=max(lengths, default=None), brought=self.brought.and_of(other.brought))


class Share(NamedTuple):
    """Of a band: how far (m3) the number may lie below and above for one cause (Cause)."""
    cause: str
    below_m3: float
    above_m3: float


# --- the headline ---

class Kind(Enum):
    """What the number is."""
    NUMBER = "number"
    FLOOR = "floor"             # at least so much
    OPEN = "open"               # that of the runs, and neither an upper nor a lower bound
    WITHHELD = "withheld"
    NOTHING = "nothing"         # 0: no run of any study reaches the road, and no more than MANY of the known events


class Source(Enum):
    """Which study it is of."""
    SWEEP = "paper"             # a parametric study, as --paper makes it alone
    ENSEMBLE = "ensemble"


class Code(Enum):
    """Of a reason: why a number is a floor, why no more runs were added, what a rule says."""
    BEYOND = "known beyond runs"
    NOT_REACHED = "road not reached"
    SOME = "some runs reach"
    ONE_SCATTER = "one scatter reaches"
    TERRAIN = "terrain ends"
    RANGE = "range ends"
    RUNS = "no more runs"
    FEW = "too few runs"
    SIZE = "size of balls"
    RULE = "rule"


class Reason(NamedTuple):
    """A code and its numbers."""
    code: Code
    numbers: Mapping[str, Any]


class Cause(Enum):
    """Of a share of a band."""
    RUNS = "chance and parameters"
    TRANSFER = "transfer to the finest balls"
    SIZE = "finer balls"
    OTHER = "the other study"       # whose upper end is higher


class Headline(NamedTuple):
    """See the page on `slope study`."""
    kind: Kind
    volume_m3: Optional[float]
    share: Optional[float]
    low_m3: Optional[float]
    high_m3: Optional[float]
    source: Optional[Source]
    paper: Optional[SweepPart]
    ensemble: Optional[EnsemblePart]
    road: Optional[Road]
    reasons: List[Reason]
    band: List[Share]
    open_above: bool = False        # nothing but the runs bounds it from above
