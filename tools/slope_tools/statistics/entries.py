"""What study.yaml has of emulators and of the headline: see tables/study_types."""
from typing import Any, Dict, List, Optional, TypedDict


class Influence(TypedDict):
    """What a variable does to a quantity (emulator.Influence)."""
    rank: float
    rank_clear: bool
    first: Optional[float]
    first_error: Optional[float]
    total: Optional[float]
    total_error: Optional[float]


class Check(TypedDict):
    """What an emulator is worth (emulator.Check)."""
    verdict: str
    explained: float
    error: float
    noise: float
    standard_deviation: float


class Analysis(TypedDict):
    """On which variables a quantity depends (emulator.Analysis)."""
    text: str
    emulator: Optional[Check]
    variables: Dict[str, Influence]


class PaperPart(TypedDict):
    volume_m3: Optional[float]
    withheld: List[str]


class EnsemblePart(PaperPart):
    far: float


class Brought(TypedDict):
    """What runs bring to the road (answer.AtRoad)."""
    runs: int
    reach: int
    passing: int
    volume: float
    balls: float


class HeadlineRoad(TypedDict):
    """The road on the fall path (answer.Road)."""
    near_m: float
    far_m: float
    reached: List[float]
    passed: List[float]
    longest_m: Optional[float]
    brought: Brought


class Headline(TypedDict):
    """The number that counts (answer.Answer): see the page on `slope study`."""
    kind: str
    volume_m3: Optional[float]
    share: Optional[float]
    low_m3: Optional[float]
    high_m3: Optional[float]
    source: Optional[str]
    paper: Optional[PaperPart]
    ensemble: Optional[EnsemblePart]
    road: Optional[HeadlineRoad]
    reasons: List[Dict[str, Any]]   # answer.Reason.about()
