"""How far the volume travels, by the shares that stay within a distance and a reach angle from the highest released
ball: what a summary's travel: quantiles say, and the same of balls and of other deposits."""
from typing import Any, Dict, List, Mapping, NamedTuple, Optional

import numpy as np

from ..quantiles import within

SHARES = (50, 90, 95, 99)       # percent of the volume, as fix deposit/grid tells them
PARTS = tuple(share / 100 for share in SHARES)
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


class Quantile(NamedTuple):
    """This share of the volume stays within both, each for itself; infinite where it lies beyond, among lost balls."""
    share: float            # 0 to 1
    distance: float         # m, in plan
    reach_angle: float      # degrees below the horizontal: the share is seen at this angle or a steeper one


def compute_reach_quantiles(places, top, volumes, lost=0.0) -> List[Quantile]:
    """Of balls at places (x y z, m) of some volumes (any unit), seen from top (x y z): a Quantile of each of PARTS.

    lost: volume of the balls that are not there; they went farther than the others.
    As fix deposit/grid counts them, which takes bins of 1/8192 of the range. A ball at the top itself went nowhere: its
    angle is 90 degrees.
    """
    x, y, z = np.asarray(places, float).T
    distance = np.hypot(x - top[0], y - top[1])
    angle = np.where(distance > 0, np.degrees(np.arctan2(top[2] - z, distance)), 90.0)
    return [Quantile(share, within(distance, volumes, share, lost), -within(-angle, volumes, share, lost))
            for share in PARTS]
