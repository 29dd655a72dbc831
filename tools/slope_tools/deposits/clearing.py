"""How a road is cleared (how much: volume.py): blocked stretches, what passes beside the deposit, what each takes, the
least volume that opens a lane through all, and the hours.

What must be removed anywhere belongs to the stretch that is nearest along the axis, so that the stretches add up to the
whole. The lanes of several stretches may cut the same ground, which counts once in their total.

Definitions, with chainage s and offset n as in axis.py (m), the thickness t of the deposit (m, even in a cell), the
road's width W and a thickness T0 that vehicles pass:

* a stretch is a largest range [s0, s1] in which the deposit is thicker than T0 somewhere within W/2 of the axis;
* its passable width is the longest run of n within the road in which T(n) <= T0, T(n) being the largest thickness over
  s of the stretch at the offset n; beside polygons that are narrower than W somewhere in the stretch nothing passes;
* its lane of a width w at the offset n0 is the ground with s in [s0, s1] and |n - n0| <= w/2, n0 being constant.
  Removed is what `cut` removes of a road of that shape; the lane is where that is least, |n0| <= (W - w)/2, and on the
  road where polygons are narrower.

Stretches and passable widths are exact for the cells; so are the volumes of lanes on plane ground beside a straight
axis.
"""
import functools
import math
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import rasterio
import scipy
from shapely import wkb
from shapely.geometry import LineString, box
from shapely.geometry.base import BaseGeometry

from .. import geometry
from ..geometry import Mesh
from ..survey.rasters import Raster
from ..survey.roads import Asked
from . import cut
from .axis import SAME, Axis, Span, longest_gap, merged, opened, parts_of_mask

DIGITS = 6              # of lengths in m and of hours
STEPS = 4               # positions of a lane in the width of a cell
COARSE = 2              # samples of a cell along a side while the best position is searched for
FINE = 0.01             # of a cell: to this the best position is refined
RAGGED = 0.05           # m, half of the width of what lies beside a road by its outline's points alone
FLAT = 1e-9             # relative: volumes that differ less are the same


class Stretch(NamedTuple):
    """A blocked stretch of a road."""
    axis: Axis
    along: Span         # chainage, m
    passable: float     # width, m
    free: Span          # offsets at which there is road in all of it, the longest range


class Place(NamedTuple):
    """Where a lane goes, and what it takes."""
    offset: float       # of its middle, m
    volume: float       # m3 of ground


def find_lane_stretches(deposit: Raster, axes: Sequence[Axis], width: float, blocked: float,
                        road: Optional[BaseGeometry] = None) -> List[Stretch]:
    """The blocked stretches of a road, by chainage.

    deposit: thickness (m) in local metres; axes: the parts of the road's axis; width: W, m; blocked: T0, m; road: only
    what lies in this area counts, too.
    """
    mask, stretches = deposit.z > blocked, []
    for axis in axes:
        near = box(*LineString(axis.points).buffer(width).bounds)
        if not parts_of_mask(mask, deposit.transform, near):        # of many runs: nothing on the road
            continue
        with rasterio.Env():        # one for all parts
            parts = [(piece, part) for piece in axis.pieces(width / 2)
                     for part in parts_of_mask(mask, deposit.transform, piece.area)]
        if road is not None:
            parts = [(piece, one) for piece, part in parts for one in geometry.polygons_of(part.intersection(road))]
        spans = [axis.spans(piece, part) for piece, part in parts if part.area > 0]
        for along in merged([s for s, _ in spans], SAME):
            across = [n for s, n in spans if along.low <= s.low <= along.high]
            whole = Span(-width / 2, width / 2)
            off = [n for s, n in beside_road(axis.points.tobytes(), axis.s[0], width, road.wkb)
                   if s.low <= along.high and s.high >= along.low] if road is not None else []
            stretches.append(Stretch(axis, along, longest_gap([*across, *off], whole), find_free_offsets(off, whole)))
    return stretches


@functools.lru_cache(maxsize=8)
def beside_road(points: bytes, start: float, width: float, road: bytes) -> List[Tuple[Span, Span]]:
    """Chainages and offsets of what lies within half of a width of an axis and beside a road: nothing passes there.
    Not at its ends, which may be cut askew."""
    axis, area = Axis(np.frombuffer(points).reshape(-1, 2), start), wkb.loads(road)
    spans = [axis.spans(piece, part) for piece in axis.pieces(width / 2)
             for part in geometry.polygons_of(opened(piece.area.difference(area), -RAGGED))]
    return [(s, n) for s, n in spans if s.high > axis.s[0] + width and s.low < axis.s[-1] - width]


def find_free_offsets(off: Sequence[Span], whole: Span) -> Span:
    """The longest of the ranges of a range that are not off a road; all of it where none is left."""
    ends = merged([Span(-math.inf, whole.low), *off, Span(whole.high, math.inf)])
    gaps = [Span(before.high, after.low) for before, after in zip(ends, ends[1:])]
    return max(gaps, key=lambda gap: gap.high - gap.low, default=whole)


def nearest(stretches: Sequence[Stretch], x, y):
    """The index of the stretch that is nearest along the axis to points x, y (1-d arrays); there must be one."""
    places = {axis: axis.locate(x, y) for axis in {one.axis for one in stretches}}
    far = [np.abs(places[one.axis][1]) + np.clip(np.maximum(one.along.low - places[one.axis][0],
                                                            places[one.axis][0] - one.along.high), 0, None)
           for one in stretches]        # of several axes, the one beside which they lie
    return np.argmin(far, axis=0)


class Cutter:
    """What lanes remove of a deposit.

    deposit: thickness (m); base: the ground below it (m); angle: rise of the cut, degrees; samples: see cut; road: on
    which they lie, in local metres; None: only themselves.
    """

    def __init__(self, deposit: Raster, base: np.ndarray, angle: float, samples: int,
                 road: Optional[BaseGeometry] = None):
        self.deposit, self.ground, self.samples = deposit, cut.Ground(base), samples
        self.road = road and geometry.to_index(road, deposit)
        self.cell = float(deposit.transform.a)
        self.tangent = math.tan(math.radians(angle)) * self.cell

    def area(self, stretch: Stretch, offset: float, width: float) -> BaseGeometry:
        """The lane of a width (m) at an offset (m), as far as it lies in the grid, in local metres."""
        lane = stretch.axis.band(stretch.along, Span(offset - width / 2, offset + width / 2))
        return geometry.as_multi(lane.intersection(geometry.box_of(self.deposit)))

    def removed(self, areas: Sequence[BaseGeometry], mesh=None, samples: Optional[int] = None) -> cut.Removed:
        """What lanes remove, together: the union of their cuts."""
        inside = [geometry.to_index(one, self.deposit) for one in areas if one.area > 0]
        return cut.removed(self.deposit.z, self.ground, inside, self.tangent, mesh or cut.one_cell(self.deposit.z),
                           samples or self.samples, silent=True, surface=self.road)

    def least(self, stretch: Stretch, lane: float) -> Place:
        """The place of a lane (width, m) on the road through a stretch where it takes least."""
        low, high = stretch.free
        middle = (low + high) / 2

        def volume(offset: float, samples: Optional[int] = COARSE) -> float:
            place = self.area(stretch, middle + offset, lane)
            return float(self.removed([place], None, samples).cells.sum()) * self.cell ** 2
        offset = minimise_offset(volume, max(0.0, high - low - lane) / 2, self.cell / STEPS, FINE * self.cell)
        return Place(middle + offset, volume(offset, None))


def minimise_offset(volume: Callable[[float], float], most: float, step: float, fine: float) -> float:
    """Where a function of the offset is least within +-most: in steps, then to `fine` beside the best one.

    Of places that are equally good the one nearest to 0. All lengths in m.
    """
    count = max(0, math.ceil(most / step - 1e-9))
    known = {float(one): volume(float(one)) for one in most * np.arange(-count, count + 1) / max(count, 1)}

    def best():
        floor = min(known.values())
        return min((one for one in known if known[one] <= floor + FLAT * abs(floor)), key=abs)

    if count:
        between = max(-most, best() - most / count), min(most, best() + most / count)
        scipy.optimize.minimize_scalar(lambda offset: known.setdefault(float(offset), volume(float(offset))),
                                       bounds=between, method="bounded", options={"xatol": fine})
    return best()


class Clearing(NamedTuple):
    """What a road takes, for volume.yaml, tables and maps."""
    stretches: List[Stretch]
    entries: List[Dict[str, Any]]       # of each stretch: lengths in m, volumes in m3 of ground, hours
    totals: Dict[str, Any]
    lanes: List[BaseGeometry]           # of each stretch, local metres; none where no lane is asked for
    mesh: Optional[np.ndarray]          # m3 of the lanes together in each mesh cell


def evaluate_clearing(run_, result, profile, axes: Sequence[Axis], width: float, road: BaseGeometry, drawn: bool,
                      asked: Asked, mesh: Mesh, angle: float, samples: int) -> Clearing:
    """The Clearing of a Deposit's road.

    result: volume.Result; profile: along the axis; width: of the road, m; drawn: as a line; angle: of the cut, degrees.
    """
    stretches = find_lane_stretches(run_.raster, axes, width, asked.blocked, None if drawn else road)
    entries = [{"from": round(one.along.low, DIGITS), "to": round(one.along.high, DIGITS),
                "largest_thickness_on_axis": thickest(profile, one), "passable_width": round(one.passable, DIGITS),
                "remove": result.rounded(volume)} for one, volume in zip(stretches,
                                                                         compute_stretch_volumes(run_, result,
                                                                                                 stretches))]
    totals = {"road_width": round(width, DIGITS), "blocked_above": asked.blocked,
              "blocked_length": round(sum(one.along.high - one.along.low for one in stretches), DIGITS),
              "remove": result.total(result.volume)}
    areas, by_mesh = [], None
    if asked.lane is not None:
        lane = min(asked.lane, width)
        cutter = Cutter(run_.raster, run_.base, angle, samples, road)
        for stretch, entry in zip(stretches, entries):
            place = cutter.least(stretch, lane)
            areas.append(cutter.area(stretch, place.offset, lane))
            steep = cutter.removed(areas[-1:]).steep * run_.cell ** 2
            entry.update(lane_offset=round(place.offset, DIGITS), remove_lane=result.rounded(place.volume),
                         remove_lane_where_cut_below_ground=result.rounded(steep))
        together = cutter.removed(areas, mesh)
        by_mesh = result.rounded((together.mesh_road + together.mesh_beside) * run_.cell ** 2)
        totals.update(lane=asked.lane, remove_lane=result.total(by_mesh))
        totals["remove_lane_twice"] = max(0.0, result.rounded(sum(one["remove_lane"] for one in entries)
                                                              - totals["remove_lane"]))
    if asked.hours is not None:
        totals.update(clearing=asked.clearing, loosening=asked.loosening)
        for entry in (*entries, totals):
            entry.update({hours: round(entry[volume] * asked.hours, DIGITS) for hours, volume in
                          (("hours", "remove"), ("hours_lane", "remove_lane")) if volume in entry})
    return Clearing(stretches, entries, totals, areas, by_mesh)


def thickest(profile, stretch: Stretch) -> float:
    """The largest thickness on the axis within a stretch, m."""
    inside = (profile["to"] > stretch.along.low) & (profile["from"] < stretch.along.high)
    return round(float(profile["thickness"][inside].max(initial=0.0)), DIGITS)


def compute_stretch_volumes(run_, result, stretches: Sequence[Stretch]) -> np.ndarray:
    """What must be removed of each stretch, m3; together all of it."""
    row, column = np.nonzero(result.removed > 0)
    if not (stretches and len(row)):
        return np.zeros(len(stretches))
    mine = nearest(stretches, *(run_.raster.transform @ (column + 0.5, row + 0.5)))
    return np.bincount(mine, result.removed[row, column], len(stretches)) * run_.cell ** 2
