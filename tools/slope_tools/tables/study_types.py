"""What a study says, as study.yaml has it: every entry, its keys and their kinds. Volumes in m3 of ground (bulk).

A study is such a value from where its runs are evaluated (studies/outcome) to console, files and page: one that the
type checker knows. What makes an entry is named beside it. None: there is none, or it is not known; where that is the
default, study.yaml does not have the key then.
"""
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional

from ..findings import Finding
from ..sites.site_budget import duration_text
from ..statistics.ball_sizes import Left
from ..statistics.entries import Headline, Road
from .ensemble_types import Ensemble, MapEntry
from .how_far import Reach
from .rows import Row

PROGRAM = "tools/slope "
Settings = Mapping[str, List[str]]


@dataclass(frozen=True)
class Header:
    """What was asked, of whom, and by which programs (studies/results)."""
    deck: str
    known: Mapping[str, Any]        # known.Choice.about()
    set: Settings                   # of what was chosen
    repeat: Settings                # of what is chance
    runs: int
    finished: int
    method: str                     # of a site's study, in words
    ranks: int
    jobs: int
    package: Optional[str]
    governs: str                    # folder of the study whose number counts, of those of a site
    balls_thick: Optional[float]    # balls over the thickness of the body
    collected: str                  # date and time
    machine: Mapping[str, Any]
    body: Optional[str] = None      # folder of the site whose body known events are of, from here; None: of a run's
    road: Optional[Mapping[str, Any]] = None        # setup.Road.about(); local: its file in the study's folder

    @property
    def the_road(self) -> Mapping[str, Any]:
        """The same of a study with one."""
        assert self.road is not None
        return self.road


@dataclass(frozen=True)
class Largest:
    """The largest value of a quantity, and whose it is."""
    value: float
    run: str


@dataclass(frozen=True)
class Difference:
    """What a variable changes in the volume to remove; clear: whether by more than chance, None: nobody knows."""
    variable: str
    largest_at: str
    smallest_at: str
    by_m3: float
    chance_m3: Optional[float]
    clear: Optional[bool]


@dataclass(frozen=True)
class Zero:
    """What a volume of 0 is worth (usable.zero)."""
    runs: int
    exceeded_at_most: float
    known_events: Optional[float]
    text: str


@dataclass(frozen=True)
class Conservative:
    """The conservative volume (combinations.conservative), its parts and what it is based on."""
    volume_m3: Optional[float]      # None: withheld
    mean_m3: float
    chance_m3: Optional[float]
    rounded: Dict[str, Optional[float]]         # the three above, to what is known
    place_m3: float                 # power of ten of the last digit that is known
    kind: str
    combination: str
    set: Mapping[str, str]
    label: str
    ground: Optional[str]
    repeats: int
    runs: int
    combinations: int
    scatter_m3: Optional[float]
    degrees_of_freedom: Optional[float]
    quantile: Optional[float]
    starts_m3: Optional[List[float]]
    run: str
    remove_m3: float
    differences: List[Difference]
    doubts: List[Finding]
    withheld: List[Finding]         # why: usable.with_remedies()
    zero: Optional[Zero]
    transfer_m3: Optional[List[float]] = None   # how far the mean may be below and above, as balls are of several sizes


@dataclass(frozen=True)
class SizeRuns:
    """The runs with balls of a diameter (m): balls in the body and over its thickness, and how many runs there are."""
    d: float
    balls: int
    balls_thick: Optional[float]
    runs: int


@dataclass(frozen=True)
class SizeStep:
    """From a size to one that is so many times finer: the factor of a quantity by so many pairs, the deviation of a
    pair that was left out (of the logarithm), whether the factor depends on parameters; None: no pair has ten balls."""
    finer: float
    pairs: int
    factor: Optional[float]
    deviation: Optional[float]
    on_parameters: bool


@dataclass(frozen=True)
class SizeEffect:
    """What the size of the balls changes in a quantity."""
    steps: List[SizeStep]
    left: Optional[Left]


@dataclass(frozen=True)
class Size:
    """What runs with balls of several sizes say (tables/sizes), the coarsest first; parameters: of steps.

    text: a sentence without its full stop.
    """
    sizes: List[SizeRuns]
    parameters: List[str]
    effects: Dict[str, SizeEffect]
    text: str


@dataclass(frozen=True)
class HalfStep:
    """What half the time step changes (step_check.compare)."""
    step: Optional[float]
    rolling: str
    volume_m3: Optional[float]
    mean_m3: Optional[float]
    chance_m3: Optional[float]
    within_chance: Optional[bool]
    energy: Optional[Mapping[str, Any]]         # step_check.read_energies()
    text: str


@dataclass(frozen=True)
class Span:
    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class ElasticQuantity(Span):
    usual: Optional[Span]           # of the runs that are otherwise the same
    study: Optional[Span]           # of all runs of the study


@dataclass(frozen=True)
class Elastic:
    """Reach and area with the largest restitution (elastic.evaluate_elastic)."""
    restitution: float
    rolling: str
    thicker_than_m: float
    runs: List[str]
    failed: List[str]
    moving: List[str]
    quantities: Dict[str, ElasticQuantity]
    text: str


@dataclass(frozen=True)
class Observed:
    """A mapped deposit (studies/mapped)."""
    file: str
    threshold_m: float
    length_m: Optional[float]
    area_m2: float
    volume_m3: Optional[float]
    released_m3: float
    best: str


@dataclass(frozen=True)
class Exceeded:
    """How many runs have more than a volume on the road."""
    more_than_m3: float
    runs: int
    probability: float
    low: float
    high: float


@dataclass(frozen=True)
class Point:
    """The runs of one intensity."""
    at: float
    runs: int
    mean_m3: float
    scatter_m3: Optional[float]
    smallest_m3: float
    largest_m3: float
    released_m3: float
    share_of_released: float
    not_on_road: int
    stood: int
    exceed: List[Exceeded]


@dataclass(frozen=True)
class Line:
    set: Dict[str, str]
    points: List[Point]


@dataclass(frozen=True)
class Intensity:
    """The volume on the road against an intensity (intensity.entry)."""
    variable: str
    quantity: str
    more_than_m3: List[float]
    confidence: float
    lines: List[Line]


@dataclass(frozen=True)
class ChainBody:
    """A body of a chain."""
    body: str
    weight: float
    volume_m3: Optional[float]
    runs: int
    finished: int


@dataclass(frozen=True)
class ChainCurve:
    """How likely more than a volume is at each peak acceleration."""
    more_than_m3: float
    probability: List[float]
    low: List[float]
    high: List[float]


@dataclass(frozen=True)
class PerYear:
    """How often a volume is exceeded; contributions: of ranges of the peak acceleration."""
    more_than_m3: float
    value: float
    low: float
    high: float
    more_at_most: float
    contributions: List[Dict[str, Any]]


@dataclass(frozen=True)
class Chain:
    """From the earthquake to the blocked road (chain_files.evaluate_chain)."""
    fragility: str
    quantity: str
    confidence: float
    bodies: List[ChainBody]
    more_than_m3: List[float]
    peaks_gal: List[float]
    curves: List[ChainCurve]
    per_year: Optional[List[PerYear]]
    withheld: List[Finding]         # why: usable.with_remedies()
    files: List[str]
    doubts: List[Finding]


@dataclass(frozen=True)
class NextStep:
    """What to do next (next_step); command: words to do before, if there are some, and a command; seconds: of
    computing, None: not known."""
    text: str
    command: str
    seconds: Optional[float]

    @property
    def time(self) -> str:
        return "" if self.seconds is None else f", about {duration_text(self.seconds)} of computing on this machine"

    @property
    def before(self) -> str:
        """What is to be done before the command, in words."""
        return self.command.partition(PROGRAM)[0].strip()

    @property
    def line(self) -> str:
        """What is to be typed, "" where that is not known."""
        return "".join(self.command.partition(PROGRAM)[1:])

    def __str__(self) -> str:
        return f"next step: {self.text}{self.time}: {self.command}"


@dataclass(frozen=True)
class Stretches:
    """The stretches of the road that runs block (road_runs.evaluate_road_runs); of_known_events: whether these weigh
    the runs."""
    runs: int
    share_blocked: float
    totals: Dict[str, List[float]]
    stretches: List[Dict[str, Any]]
    shares: List[List[float]]
    of_known_events: Optional[bool] = None
    bodies: Optional[List[Dict[str, Any]]] = None       # of a site with several (road_runs.by_body)


@dataclass(frozen=True)
class Study:
    """study.yaml."""
    study: Header
    largest: Dict[str, Largest]
    farthest: Optional[str]
    conservative: Optional[Conservative]
    size: Optional[Size]            # None: of one size
    ensemble: Optional[Ensemble]
    step: Optional[HalfStep]
    largest_restitution: Optional[Elastic]
    scatter: Mapping[str, Optional[Mapping[str, float]]]
    combinations: List[Dict[str, Any]]          # combinations.list_combination_entries()
    envelope: Optional[Dict[str, MapEntry]]
    exceedance: Optional[List[MapEntry]]
    observed: Optional[Observed]
    roads: List[Dict[str, Any]]     # road_numbers.Number
    warnings: List[Finding]
    runs: List[Row]
    headline: Optional[Headline]
    reach: Optional[Reach]          # None: no run left a deposit
    stretches: Optional[Stretches]              # None without a road
    chain: Optional[Chain]
    intensity: Optional[Intensity]
    next_step: Optional[NextStep]
    at_road: Optional[Road] = None  # of the study alone, for its headline (headline.conclude), which has it then
