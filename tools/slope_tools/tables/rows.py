"""The row of a run in the table of a study: what the run is, and its numbers, each once, with its unit in its name.

A run that failed has an error, one that finished has numbers; study.yaml has both in one list (plain, read).
"""
from dataclasses import dataclass, fields, replace
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Union

from .. import records
from ..deposits.travel_shares import BEYOND
from ..findings import Finding
from .released import Release

FAILED, FINISHED = "failed", "finished"         # what study.yaml has as status
Numbers = Mapping[str, Any]                     # of a structure or a control line, see structures


@dataclass(frozen=True)
class Run:
    """What any row has: name; values of what was chosen (set) and of what is chance (repeat); batch: which one of those
    that an ensemble added it is of, 0: none; log_warnings: what LAMMPS warned of."""
    run: str
    set: Mapping[str, str]
    repeat: Mapping[str, str]
    batch: int


@dataclass(frozen=True)
class Failed(Run):
    error: str
    log_warnings: Sequence[str] = ()


@dataclass(frozen=True)
class OnRoad:
    """What `slope volume` says of a run: volumes in m3 of ground (bulk); None is not known, or was not asked for."""
    road_on_body_m2: float
    remove_m3: float
    remove_on_road_m3: float
    remove_beside_road_m3: float
    before_road_m3: Optional[float]
    on_road_m3: Optional[float]
    beyond_road_m3: Optional[float]
    past_end_m3: Optional[float]
    unknown_m3: Optional[float]
    left_before_road_m3: Optional[float]
    blocked_m: float
    axis_thickness_m: Optional[float]
    remove_lane_m3: Optional[float]
    lane_hours: Optional[float]
    clear_hours: Optional[float]
    stretches: Sequence[Mapping[str, float]]        # of the axis that are blocked, see deposits.clearing
    clearing: Mapping[str, float]                   # their sums
    road_warnings: Sequence[Finding]
    axis_m: Optional[float] = None                  # length of the road
    by_10_m: Sequence[Sequence[float]] = ()         # [from, m3 on the road] of each 10 m of it that has any


@dataclass(frozen=True)
class Mapped:
    """How a run compares with the mapped deposit: the area of both over that of either; how much longer it is, m."""
    overlap: float
    beyond_mapped_m: Optional[float]


@dataclass(frozen=True)
class Finished(Run):
    """Volumes in m3 of ground (bulk), lengths in plan; None is not known. Of what is not a number see quantities."""
    variables: Mapping[str, str]                    # of the deck
    stop_angle_deg: Optional[float]
    ranks: Optional[int]
    package: Optional[str]
    length_m: Optional[float]
    length_is: Optional[str]
    length_by_lobe_m: Optional[Sequence[float]]
    length_deg: Optional[float]
    left: Optional[Sequence[Numbers]]               # what left the terrain, see deposits.gone
    ball_m3: float
    mass_error: float
    released_m3: float
    on_grid_m3: float
    off_grid_m3: float
    lost_m3: float
    residual_m3: float
    front_m: float
    reach_angle_deg: float
    centroid_m: float
    thickness_m: float
    max_thickness_m: float
    max_speed_m_s: float
    stop_time_s: float
    stop_reason: str
    moving: bool
    distance_50_m: Optional[float]
    distance_90_m: Optional[float]
    distance_95_m: Optional[float]
    distance_99_m: Optional[float]
    reach_50_deg: Optional[float]
    reach_90_deg: Optional[float]
    reach_95_deg: Optional[float]
    reach_99_deg: Optional[float]
    at_rest: bool
    end: str
    end_short: str
    moves_share: float
    moving_share: float
    fast_share: Optional[float]
    stiffness_number: Optional[float]
    fast_volume_m3: Optional[float]
    fast_speed_m_s: Optional[float]
    release: Release
    log_warnings: Sequence[str]
    change_rate: Optional[float]
    wall_s: Optional[float]
    summary: str                                    # path from the study's folder
    slope_version: Any
    lammps_version: Any
    lmp_sha256: Optional[str]
    structures: Mapping[str, Numbers]
    lines: Mapping[str, Numbers]
    road: Optional[OnRoad] = None
    mapped: Optional[Mapped] = None
    # {quantity: between which it lies with the finest balls, with 90 %} of a study with several sizes
    bands: Optional[Mapping[str, Sequence[float]]] = None

    @property
    def at_road(self) -> OnRoad:
        """What it says of the road, in a study with one."""
        assert self.road is not None
        return self.road

    @property
    def left_box(self) -> bool:
        """Whether so much of it left the box that nobody knows how far it went."""
        return self.lost_m3 > BEYOND * self.released_m3

    def value(self, key: str) -> Any:
        """That of a quantity (see quantities); None: the run has none."""
        return next((getattr(part, key) for part in (self, self.road, self.mapped) if hasattr(part, key)), None)


Row = Union[Failed, Finished]
PARTS = {"road": OnRoad, "mapped": Mapped}      # of Finished, flat in a file


def finished_of(rows: Iterable[Row]) -> List[Finished]:
    return [row for row in rows if isinstance(row, Finished)]


def find_farthest_run(rows: Sequence[Finished]) -> Finished:
    """The run that went farthest.

    Of those that left the box, which went beyond all others, it is the one that lost most. Where a run of an older
    version has no shares, the farthest balls are compared.
    """
    gone = [row for row in rows if row.left_box]
    if gone:
        return max(gone, key=lambda row: row.lost_m3 / row.released_m3)
    known = all(row.distance_99_m is not None for row in rows)
    return max(rows, key=lambda row: row.distance_99_m or 0.0 if known else row.front_m)


def encode_row(row: Row) -> Dict[str, Any]:
    """What study.yaml has of it."""
    about: Dict[str, Any] = records.encode_record(row)
    parts = [about.pop(part, None) or {} for part in PARTS]
    status = FINISHED if isinstance(row, Finished) else FAILED
    return {"run": about.pop("run"), "status": status, **about, **parts[0], **parts[1]}


def read_row(entry: Mapping[str, Any]) -> Row:
    """The same back, of a mapping with a status; NoRecord if it is none."""
    if entry["status"] not in (FAILED, FINISHED):
        raise records.NoRecord(f"status: must be {FAILED} or {FINISHED}, got {entry['status']!r:.60}")
    if entry["status"] == FAILED:
        return records.read_record(Failed, entry)
    parts: Dict[str, Any] = {part: {one.name: entry[one.name] for one in fields(kind) if one.name in entry}
                             for part, kind in PARTS.items()}
    return replace(records.read_record(Finished, {**entry, **dict.fromkeys(PARTS)}),
                   **{part: records.read_record(PARTS[part], mine) for part, mine in parts.items() if mine})
