"""What a study says of an ensemble, as study.yaml has it: the part of study_types that is of its runs together."""
from dataclasses import dataclass
from typing import Any, Dict, List, NamedTuple, Optional, Union

from ..findings import Finding
from ..statistics.entries import Analysis, KnownQuantile, Quantile, Reason

CALIBRATED = "calibrated"           # a design: sets of values that a calibration found equally good
MapEntry = Dict[str, Any]           # of a map over all runs: file, what it shows, and of which threshold or quantile


class Gap(NamedTuple):
    """Two lengths (m) between which no run ends, and the share of known events that do."""
    low_m: float
    high_m: float
    share: float


@dataclass(frozen=True)
class OfKnown:
    """A quantity as known events weigh it."""
    name: str
    unit: str
    quantiles: List[KnownQuantile]


@dataclass(frozen=True)
class OfRuns:
    """A quantity as the runs have it."""
    name: str
    unit: str
    mean: float
    standard_deviation: Optional[float]
    smallest: float
    largest: float
    quantiles: List[Quantile]


@dataclass(frozen=True)
class KnownVariable:
    """A variable in the weighted runs: values that 5, 50 and 95 % of the weight stay within; rank correlations."""
    quantiles: List[str]
    rank: Dict[str, Optional[float]]


@dataclass(frozen=True)
class Added:
    """The runs towards longer ones (farther.Added)."""
    points: int
    stopped: Optional[Reason]
    batches: List[Dict[str, Any]]


@dataclass(frozen=True)
class Known:
    """Which known events an ensemble was held against; outside: why they weigh nothing, reached is None then."""
    set: str
    events: Optional[int]
    left_out: List[str]
    confined: Optional[str]
    path: str
    volume_Mm3: float
    outside: List[str]
    reached: Optional[float]
    doubts: List[Finding]


@dataclass(frozen=True)
class Weighted(Known):
    """An ensemble that known events weigh (known_events.evaluate_known_events): how much of them the runs reach, as how
    many runs these count, and their numbers."""
    short: float
    far: float
    runs: int
    failed: int
    effective: float
    distance: float
    far_by_lobe: List[float]
    gaps: List[Gap]
    shortest_m: float
    longest_m: float
    half_beyond_m: Optional[float]
    path_m: float
    beyond_path: float
    added: Added
    quantities: Dict[str, OfKnown]
    to_remove: Optional[List[KnownQuantile]]
    variables: Dict[str, KnownVariable]
    influence: Dict[str, Analysis]
    weights: Dict[str, float]
    maps: List[MapEntry]
    path_end_m: Optional[float] = None      # of a fall path that ends before the longest run, beyond which far counts


@dataclass(frozen=True)
class Design:
    """The points of an ensemble (sample.Sample)."""
    kind: str
    seed: int
    points: int
    variables: Dict[str, str]
    wide: Optional[Dict[str, List[float]]] = None
    fit: Optional[str] = None           # SHA-256 of the calibration's file whose sets they are


@dataclass(frozen=True)
class Ensemble:
    """An ensemble (ensemble.evaluate_ensemble)."""
    design: Design
    runs: int
    finished: int
    failed: int
    points: int
    confidence: float
    of: Optional[str]               # the quantity that counts
    quantities: Dict[str, OfRuns]
    influence: Dict[str, Analysis]
    doubts: List[Finding]
    maps: List[MapEntry]
    known_events: Optional[Union[Weighted, Known]]
    withheld: List[Finding]         # why: usable.with_remedies()


def weighted(ensemble: Optional[Ensemble]) -> Optional[Weighted]:
    """What known events say of an ensemble, where they weigh its runs."""
    return ensemble.known_events if ensemble and isinstance(ensemble.known_events, Weighted) else None
