"""How far the volume travels, by the shares that stay within a distance: what a summary's travel: quantiles say."""
from typing import Any, Dict, Mapping, Optional, Protocol, Sequence, TypeVar

SHARES = (50, 90, 95, 99)       # percent of the volume
HEADLINE = SHARES[-1]           # the distance that counts: one stray ball does not move it
COLUMNS = (*(f"distance_{share}_m" for share in SHARES), *(f"reach_{share}_deg" for share in SHARES))
DISTANCE = f"distance_{HEADLINE}_m"
REACH = f"reach_{HEADLINE}_deg"
BEYOND = 1 - HEADLINE / 100       # of the volume; where more left the box, that distance is beyond it


def read_share_columns(summary: Mapping[str, Any]) -> Dict[str, Optional[float]]:
    """{column: m in plan from the highest released ball, or degrees} of a summary (run_folders.load_summary).

    None: a run of an older version, or so much left the box that this share of the released volume lies beyond it.
    """
    found: Dict[str, Optional[float]] = dict.fromkeys(COLUMNS)
    for entry in summary["travel"].get("quantiles") or ():
        share = round(100 * entry["share"])
        if share in SHARES:
            found.update({f"distance_{share}_m": entry["distance"], f"reach_{share}_deg": entry["reach_angle"]})
    return found


class Traveled(Protocol):
    """What a run (a rows.Finished) says of it: volumes in m3, distances in m."""
    @property
    def lost_m3(self) -> float: ...
    @property
    def released_m3(self) -> float: ...
    @property
    def front_m(self) -> float: ...
    @property
    def distance_99_m(self) -> Optional[float]: ...


One = TypeVar("One", bound=Traveled)


def lost(row: Traveled) -> bool:
    """Whether so much of a run left the box that nobody knows how far it went."""
    return row.lost_m3 > BEYOND * row.released_m3


def find_farthest_run(rows: Sequence[One]) -> One:
    """The run that went farthest.

    Of those that left the box, which went beyond all others, it is the one that lost most. Where a run of an older
    version has no shares, the farthest balls are compared.
    """
    gone = [row for row in rows if lost(row)]
    if gone:
        return max(gone, key=lambda row: row.lost_m3 / row.released_m3)
    known = all(row.distance_99_m is not None for row in rows)
    return max(rows, key=lambda row: row.distance_99_m or 0.0 if known else row.front_m)
