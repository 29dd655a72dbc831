"""A second opinion on the reach of a mass: friction that falls with its volume, whatever the landslide.

mu = V ** EXPONENT, V in m3, log10 mu normal about it with the standard deviation DEVIATION: A. Lucas, A. Mangeney and
J. P. Ampuero, Frictional velocity-weakening in landslides on Earth and on other planetary bodies, Nature Communications
5 (2014), 3417; the scatter as the program tilupy 2.1.1 has it. mu is the friction with which their model of a sliding
mass goes as far as the landslide did; here it is the slope of the line from crown to tip.
"""
import math
from typing import NamedTuple, Optional

import numpy as np
from scipy import special

from . import fall_path
from .body import Body
from .fall_path import FallPath
from .known import Mobility

EXPONENT, DEVIATION = -0.0774, 0.0667
BAND = 0.95             # of the landslides lie in it
NAME = "Lucas et al. (2014)"
ENDS = (1 - BAND) / 2, (1 + BAND) / 2


class Opinion(NamedTuple):
    """Degrees of the line from crown to tip, and both ends of its band; m along the path, None beyond its end.

    toe: m, of the body: a reach of no more is one of nobody knows how much less.
    """
    angle: float
    steep: float
    flat: float
    reach: Optional[float]
    near: Optional[float]
    far: Optional[float]
    toe: float


class Band(NamedTuple):
    """m along a path: where BAND of the landslides end; infinite: beyond the path."""
    near: float
    far: float


def friction(volume: float, share: float = 0.5) -> float:
    """The coefficient that this share of the landslides of a volume (m3) is below."""
    return float(10 ** (EXPONENT * math.log10(volume) + special.ndtri(share) * DEVIATION))


def reach(path: FallPath, slope: float) -> Optional[float]:
    """Length (m) at which a line of a slope from the crown comes out of the ground on a path that begins at the toe;
    None: it ends before."""
    above = path.fall - slope * path.length
    below = np.flatnonzero(above < 0)
    if not len(below):
        return None
    k = int(below[0])
    if k == 0:
        return float(path.length[0])
    share = above[k - 1] / (above[k - 1] - above[k])
    return float(path.length[k - 1] + share * (path.length[k] - path.length[k - 1]))


def opinion(mass: Body, path: FallPath) -> Opinion:
    """Of a body on its fall path."""
    beyond_toe = fall_path.from_toe(mass, path)
    slopes = [friction(mass.volume, share) for share in (0.5, *ENDS[::-1])]
    angle, steep, flat = (math.degrees(math.atan(one)) for one in slopes)
    middle, near, far = (reach(beyond_toe, one) for one in slopes)
    return Opinion(angle, steep, flat, middle, near, far, float(beyond_toe.length[0]))


def differ(opinion_: Opinion, counts: Mobility) -> Optional[Band]:
    """The band of known events, where it has nothing in common with that of the opinion; None: they agree."""
    if not counts.in_range:
        return None
    near, far = (counts.length_at(share) for share in ENDS[::-1])
    known = Band(0.0 if counts.at_most(ENDS[1]) is not None else or_infinite(near), or_infinite(far))
    return known if known.near > or_infinite(opinion_.far) or known.far < or_infinite(
        opinion_.near) else None


def or_infinite(length: Optional[float]) -> float:
    """A length (m); None: beyond all."""
    return math.inf if length is None else length
