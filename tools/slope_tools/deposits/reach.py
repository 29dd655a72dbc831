"""How far shares of a mass went: distance in plan and reach angle from the highest released ball, by volume."""
import math
from typing import List, NamedTuple

import numpy as np

SHARES = 0.5, 0.9, 0.95, 0.99    # as fix deposit/grid tells them


class Quantile(NamedTuple):
    """This share of the volume stays within both, each for itself; infinite where it lies beyond, among lost balls."""
    share: float            # 0 to 1
    distance: float         # m, in plan
    reach_angle: float      # degrees below the horizontal: the share is seen at this angle or a steeper one


def within(values, weights, share, lost=0.0):
    """The smallest of values that a share of their weights lies at or below; NaN without weight.

    lost: weight of what lies beyond all of them; infinite if the share does, too.
    """
    order = np.argsort(values, kind="stable")
    below = np.cumsum(np.asarray(weights, float)[order])
    if not len(below) or not below[-1] > 0:
        return math.nan
    wanted = share * (below[-1] + lost)
    if wanted > below[-1] * (1 + 1e-9):         # all that is there counts, whatever the rounding
        return math.inf
    return float(np.asarray(values)[order][np.searchsorted(below, min(wanted, below[-1]) * (1 - 1e-12))])


def quantiles(places, top, volumes, lost=0.0) -> List[Quantile]:
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
