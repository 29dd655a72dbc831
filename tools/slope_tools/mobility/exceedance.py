"""How likely a mass goes beyond each point of its fall path, as known events of its volume and fall did.

At a point at the length L the fall H is that of the ground there (as in PRE-RA of Mitchell et al. 2020): the
probability is that of a longer event with this H. Where the path is steep it may rise, though a mass that goes beyond
a point was beyond all before: the running minimum counts. Where the fall is below the set's least, near the crown, the
set says nothing, and it is 1.
"""
from typing import Dict, List, NamedTuple, Optional, Sequence

import numpy as np

from . import fall_path, relation
from .body import Body
from .events import Event
from .fall_path import FallPath
from .relation import Relation

FAR = 0.999             # the path is followed to where so many events ended
WORDS = {True: "laterally confined", False: "not laterally confined"}


class Lies(NamedTuple):
    """Share of known events of a volume and fall that go at least, and at most, as far as a length.

    beyond: the length is that of the path's end, or more: at_least is an upper limit.
    """
    at_least: float
    at_most: float
    beyond: bool


class Mobility(NamedTuple):
    """Of a body on its fall path.

    curves: {laterally confined: probability that the mass goes beyond each point of the path}, 1 at its beginning.
    outside: why known events say nothing of this mass, a line each; none of them: in range.
    """
    path: FallPath
    volume: float                   # million m3
    relation: Relation
    curves: Dict[bool, np.ndarray]
    outside: List[str]

    @property
    def in_range(self) -> bool:
        """Whether the set covers the volume, and the fall at its median; else nothing may be conditioned on it."""
        return not self.outside

    @property
    def severe(self) -> bool:
        """Whether `confined` is that of the curve that counts: the confined one, if it was asked for."""
        return True in self.curves

    def exceedance(self, length, confined: Optional[bool] = None):
        """Probability of going beyond a length (m, a number or an array) of the path; beyond its end that of its end.

        confined: None for the severe curve.
        """
        return np.interp(length, self.path.length, self.curves[self.severe if confined is None else confined])

    def beyond_path(self, confined: Optional[bool] = None) -> float:
        """Share that goes beyond the end of the path."""
        return float(self.curves[self.severe if confined is None else confined][-1])

    def length_at(self, share: float, confined: Optional[bool] = None) -> Optional[float]:
        """Length (m) that this share of known events goes beyond; None where that is beyond the path's end."""
        curve = self.curves[self.severe if confined is None else confined]
        if curve[-1] > share:
            return None
        k = int(np.argmax(curve <= share))
        if k == 0:
            return 0.0
        return float(np.interp(-share, -curve[k - 1:k + 1], self.path.length[k - 1:k + 1]))

    def where_lies(self, length: float, confined: Optional[bool] = None) -> Lies:
        """Where a run that reaches a length (m, along the path) lies among known events."""
        share = float(self.exceedance(length, confined))
        return Lies(share, 1 - share, bool(length >= self.path.length[-1]))


def of_body(body: Body, events: Sequence[Event], confined: Optional[bool] = None, where="the set of events",
            path: Optional[FallPath] = None) -> Mobility:
    """The Mobility of a body; confined: None for both curves; where: what messages name of the set; path: another one.

    Raises SlopeError for a set that gives no relation, and for a body on level ground.
    """
    found = relation.of_events(events, where)
    volume = body.volume / 1e6
    if path is None:
        relief = body.crown[2] - float(np.nanmin(body.raster.z))
        path = fall_path.trace(body, max(found.quantile(FAR, volume, relief, kind) for kind in (False, True)))
    curves = {kind: curve(path, found, volume, kind) for kind in ((True, False) if confined is None else (confined,))}
    mobility = Mobility(path, volume, found, curves, [])
    return mobility._replace(outside=outside(mobility))


def curve(path: FallPath, found: Relation, volume: float, confined: bool) -> np.ndarray:
    """Probability of going beyond each point of a path."""
    least = found.falls[0]
    if path.fall.max() < least:     # out of range, and said so
        least = 0.0
    known = (path.length > 0) & (path.fall > 0) & (path.fall >= least)
    share = np.ones(len(path.length))
    share[known] = found.exceedance(path.length[known], volume, path.fall[known], confined)
    return np.minimum.accumulate(share)


def outside(mobility: Mobility) -> List[str]:
    """Lines on volume and fall outside of the set's range: the fall where half of the events end, or the path does."""
    found, path = mobility.relation, mobility.path
    lines = []
    low, high = found.volumes
    if not low <= mobility.volume <= high:
        lines.append(f"no set of known events covers this volume, {mobility.volume:.4g} million m3: those of the set "
                     f"have {low:g} to {high:g}")
    low, high = found.falls
    falls = sorted(float(np.interp(end, path.length, path.fall)) for end in
                   (path.length[-1] if length is None else length for length in
                    (mobility.length_at(0.5, kind) for kind in mobility.curves)))
    wrong = [fall for fall in falls if not low <= fall <= high]
    if wrong:
        lines.append(f"no set of known events covers this height, {wrong[0]:.4g} m where half of them end (or the path "
                     f"does): those of the set fell {low:g} to {high:g} m")
    return lines
