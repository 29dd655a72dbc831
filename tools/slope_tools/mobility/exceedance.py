"""How likely a mass goes beyond each point of its fall path, as known events of its volume and fall did.

At a point at the length L the fall H is that of the ground there (as in PRE-RA of Mitchell et al. 2020): the
probability is that of a longer event with this H. It begins at the toe of the body, where H and L begin to be those of
a mass that has left its scar. Where the path is steep it may rise, though a mass that goes beyond a point was beyond
all before: the running minimum counts. Of a fall that none of the events had they say nothing: there the curve is that
of the last point before of which they do, 1 before the first one, and `said` is False.
"""
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from .. import digits
from . import fall_path
from .body import Body
from .fall_path import FallPath
from .landslides import LandslideKind
from .relation import Relation

FAR = 0.999             # the path is followed to where so many events ended
HALF = 0.5
WORDS = {"confined": "laterally confined", "unconfined": "not laterally confined",
         "mixture": "confined or not, as often as known events",
         "landslides_narrow": "the smaller scatter", "landslides_wide": "the larger scatter",
         "landslides": "whichever scatter says more"}
CONFINED = {"yes": "confined", "no": "unconfined", "unknown": "mixture"}        # what is asked for, and its curve
Law = Union[Relation, LandslideKind]


class Lies(NamedTuple):
    """Share of known events of a volume and fall that go at least, and at most, as far as a length.

    beyond: the length is that of the path's end, or more: at_least is an upper limit.
    """
    at_least: float
    at_most: float
    beyond: bool


class Mobility(NamedTuple):
    """Of a body on its fall path.

    curves: {kind, of the law: probability that the mass goes beyond each point of the path}, 1 up to the body's toe;
    chosen: kind of the curve that counts; said: of which points the law's events had the fall; outside: why they say
    nothing of this mass, a line each; none of them: in range.
    """
    path: FallPath
    volume: float                   # million m3
    law: Law
    curves: Dict[str, np.ndarray]
    chosen: str
    said: np.ndarray
    outside: List[str]

    @property
    def in_range(self) -> bool:
        """Whether the events cover the volume, and the fall at their median; else nothing may be conditioned on it."""
        return not self.outside

    def exceedance(self, length, kind: Optional[str] = None):
        """Probability of going beyond a length (m, a number or an array) of the path; beyond its end that of its end.

        kind: None for the curve that counts.
        """
        return np.interp(length, self.path.length, self.curves[kind or self.chosen])

    def end(self, longest: float) -> float:
        """Length (m) up to which the terrain shows the way: that of the path, or of the longest run where this one ends
        beside the path, farther from its beginning than the path's end (run_length)."""
        return max(float(self.path.length[-1]), longest)

    def beyond_path(self, kind: Optional[str] = None) -> float:
        """Share that goes beyond the end of the path."""
        return float(self.curves[kind or self.chosen][-1])

    def length_at(self, share: float, kind: Optional[str] = None) -> Optional[float]:
        """Length (m) that this share of known events goes beyond; None where that is beyond the path's end."""
        curve = self.curves[kind or self.chosen]
        if curve[-1] > share:
            return None
        k = int(np.argmax(curve <= share))
        if k == 0:
            return 0.0
        return float(np.interp(-share, -curve[k - 1:k + 1], self.path.length[k - 1:k + 1]))

    def where_lies(self, length: float, kind: Optional[str] = None) -> Lies:
        """Where a run that reaches a length (m, along the path) lies among known events."""
        share = float(self.exceedance(length, kind))
        return Lies(share, 1 - share, bool(length >= self.path.length[-1]))

    def shares(self, length: float) -> Tuple[float, float]:
        """The shares that go beyond a length (m) by a row's both scatters, the smaller first; of a set twice the same.

        So near to the body that the events say nothing, those at the next point of which they do.
        """
        if not self.says(length):
            after = np.flatnonzero(self.said & (self.path.length >= length))
            length = float(self.path.length[after[0]]) if len(after) else length
        kinds = self.law.both if isinstance(self.law, LandslideKind) else (self.chosen, self.chosen)
        low, high = sorted(float(self.exceedance(length, kind)) for kind in kinds)
        return low, high

    def at_most(self, share: float, kind: Optional[str] = None) -> Optional[float]:
        """The length (m) at which the events begin to say something, where fewer than a share go beyond that.

        None where they say how far this share goes: length_at() does. From the point before it the curve falls by what
        is not known; at_most() is the longest that the length can be.
        """
        curve = self.curves[kind or self.chosen]
        k = int(np.argmax(curve <= share))
        return float(self.path.length[k]) if curve[k] <= share and k > 0 and not self.said[k - 1] else None

    def says(self, length: float) -> bool:
        """Whether the events had the fall of the path at a length (m)."""
        at = min(int(np.searchsorted(self.path.length, length)), len(self.said) - 1)
        return self.in_range and bool(self.said[at])


def compute_mobility(body: Body, law: Law, chosen: Optional[str] = None, path: Optional[FallPath] = None) -> Mobility:
    """The Mobility of a body; chosen: kind of the curve that counts, None: the law's last one; path: another one.

    Raises SlopeError for a body on level ground.
    """
    path = path or path_of(body, [law])
    volume, toe = body.volume / 1e6, fall_path.from_toe(body, path).length[0]
    low, high = law.falls
    covered = (path.fall >= low) & (path.fall <= high) & (path.fall > 0) & (path.length > 0) & (path.length >= toe)
    curves = {}
    for kind in law.kinds:
        share = np.ones(len(path.length))
        share[covered] = law.beyond(kind, path.length[covered], volume, path.fall[covered])
        curves[kind] = np.minimum.accumulate(share)
    mobility = Mobility(path, volume, law, curves, chosen or law.kinds[-1], covered, [])
    return mobility._replace(outside=outside(mobility))


def path_of(body: Body, laws: Sequence[Law]) -> FallPath:
    """The fall path as far as hardly any of the laws' events went."""
    volume, relief = body.volume / 1e6, body.crown[2] - float(np.nanmin(body.raster.z))
    return fall_path.trace(body, max(law.farthest(FAR, volume, relief) for law in laws))


def outside(mobility: Mobility) -> List[str]:
    """Lines on volume and fall outside of the events' range: the fall where half of them end, or the path does."""
    law, path, covered = mobility.law, mobility.path, np.flatnonzero(mobility.said)
    lines = []
    low, high = law.volumes
    if not low <= mobility.volume <= high:
        lines.append("the set of known events does not cover this volume, "
                     f"{digits.format_volume(1e6 * mobility.volume)}: it has {low:g} to {high:g} million m3")
    low, high = law.falls
    median = mobility.length_at(HALF)
    fall = float(np.interp(path.length[-1] if median is None else median, path.length, path.fall))
    if len(covered) and mobility.curves[mobility.chosen][covered[0]] <= HALF:     # before any fall of the set
        fall = min(fall, float(path.fall[max(covered[0] - 1, 0)]))
    if not (len(covered) and low <= fall <= high):
        lines.append(f"the set of known events does not cover this height, {fall:.4g} m where half of them end (or "
                     f"the path does): they fell {low:g} to {high:g} m")
    return lines
