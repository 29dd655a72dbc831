"""How far shares of a mass went: distance in plan and reach angle from the highest released ball, by volume."""
from typing import List, NamedTuple

import numpy as np

from ..quantiles import within

SHARES = 0.5, 0.9, 0.95, 0.99    # as fix deposit/grid tells them


class Quantile(NamedTuple):
    """This share of the volume stays within both, each for itself; infinite where it lies beyond, among lost balls."""
    share: float            # 0 to 1
    distance: float         # m, in plan
    reach_angle: float      # degrees below the horizontal: the share is seen at this angle or a steeper one


def compute_reach_quantiles(places, top, volumes, lost=0.0) -> List[Quantile]:
    """Of balls at places (x y z, m) of some volumes (any unit), seen from top (x y z): a Quantile of each of SHARES.

    lost: volume of the balls that are not there; they went farther than the others.
    As fix deposit/grid counts them, which takes bins of 1/8192 of the range. A ball at the top itself went nowhere: its
    angle is 90 degrees.
    """
    x, y, z = np.asarray(places, float).T
    distance = np.hypot(x - top[0], y - top[1])
    angle = np.where(distance > 0, np.degrees(np.arctan2(top[2] - z, distance)), 90.0)
    return [Quantile(share, within(distance, volumes, share, lost), -within(-angle, volumes, share, lost))
            for share in SHARES]
