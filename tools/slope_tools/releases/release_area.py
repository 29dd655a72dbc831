"""Where a body may be released: the nodes of a terrain inside of a polygon, their fall line, its toe and shoulder.

A node is the centre of a cell of the terrain; between nodes the ground is bilinear, as region terrain has it. Lengths
in metres, coordinates local to the terrain, arrays (rows, columns), rows from north to south. An Area is the part of
the terrain around the polygon only, so that large terrains cost nothing.
"""
import math
from typing import NamedTuple, Tuple

import numpy as np
from rasterio.features import geometry_mask
from scipy.ndimage import binary_dilation, label, map_coordinates
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from ..errors import SlopeError
from ..geometry import polygons_of
from ..survey.rasters import Raster

FLAT = 1.0      # degrees; ground that falls less has no fall line
FEWEST = 9      # nodes of a body
RIM = 2         # nodes between a body and the end of the heights: the outermost half cell is extrapolated from two


class Area(NamedTuple):
    """A part of a terrain with the nodes that may belong to the body."""
    z: np.ndarray               # ground, m
    x: np.ndarray               # of the columns, m
    y: np.ndarray               # of the rows, m
    cell: float                 # m
    inside: np.ndarray          # bool: nodes that may be in the body
    corner: Tuple[int, int]     # row and column of the first node in the terrain
    downhill: np.ndarray        # unit vector (x, y) of the fall line of the plane through the ground in `inside`
    slope: float                # degrees, of that plane

    @property
    def centre(self) -> np.ndarray:
        """x, y of the middle of the nodes inside, m."""
        row, column = np.nonzero(self.inside)
        return np.array([self.x[column].mean(), self.y[row].mean()])

    def height(self, x, y) -> np.ndarray:
        """The ground at points within the area, m, bilinear."""
        row, column = (self.y[0] - np.asarray(y)) / self.cell, (np.asarray(x) - self.x[0]) / self.cell
        return map_coordinates(self.z, [np.atleast_1d(row), np.atleast_1d(column)], order=1, mode="nearest")

    def along(self) -> Tuple[np.ndarray, np.ndarray]:
        """Of every node, from the centre: metres uphill along the fall line, and to the left of that."""
        dx, dy = self.x[None, :] - self.centre[0], self.y[:, None] - self.centre[1]
        ux, uy = -self.downhill
        return dx * ux + dy * uy, dy * ux - dx * uy


class FallLine(NamedTuple):
    """The fall line through the middle of a polygon, from its lower rim to its upper one."""
    toe: np.ndarray         # x, y, z, m
    shoulder: np.ndarray    # x, y, z, m

    @property
    def chord(self) -> float:
        """Metres from toe to shoulder, in space."""
        return float(np.linalg.norm(self.shoulder - self.toe))


def nodes_inside(raster: Raster, geometry: BaseGeometry) -> np.ndarray:
    """Mask of the nodes of a terrain that lie in polygons (local metres)."""
    parts = polygons_of(geometry)       # none of one that is as good as a point
    if not parts:
        return np.zeros(raster.z.shape, bool)
    return geometry_mask(parts, raster.z.shape, raster.transform, invert=True)


def area_of(raster: Raster, inside: np.ndarray, where: str, terrain: str, remedy: str = "") -> Area:
    """The Area of the nodes in a mask; where, terrain: what messages name; remedy: of an area too
    close to the edge.

    Raises SlopeError where there are too few of them, or where they come to the end of the heights: the body would
    have a wall there that is none in nature, and region terrain has no ground beyond.
    """
    row, column = np.nonzero(inside)
    cell = float(raster.transform.a)
    if len(row) < FEWEST:
        raise SlopeError(where, f"must hold at least {FEWEST} centres of the cells of {terrain}, which are {cell:g} m "
                         "wide: take a larger area or a finer terrain", len(row))
    rows, columns = raster.z.shape
    low, high = (row.min() - RIM, column.min() - RIM), (row.max() + RIM, column.max() + RIM)
    part = tuple(slice(max(0, a), b + 1) for a, b in zip(low, high))
    z, mask = raster.z[part], inside[part]
    missing = np.isnan(z) & binary_dilation(mask, np.ones((2 * RIM + 1, 2 * RIM + 1)))
    if min(low) < 0 or high[0] >= rows or high[1] >= columns or missing.any():
        if missing.any():
            bad = np.argwhere(missing)[0] + [part[0].start, part[1].start]
        else:
            bad = next((r, c) for r, c in zip(row, column)
                       if min(r, c) < RIM or r >= rows - RIM or c >= columns - RIM)
        x, y = raster.transform @ (bad[1] + 0.5, bad[0] + 0.5)
        east, north = x + raster.offset[0], y + raster.offset[1]
        if missing.any():
            remedy += fill_remedy(raster.z, int(bad[0]), int(bad[1]))
        raise SlopeError(where, f"must stay at least {RIM} cells away from NODATA and from the edge of {terrain}"
                         f"{remedy}",
                         f"{'NODATA' if missing.any() else 'its edge'} at east {east:.1f} north {north:.1f}")
    x, _ = raster.transform @ (np.arange(part[1].start, part[1].stop) + 0.5, 0.0)
    _, y = raster.transform @ (0.0, np.arange(part[0].start, part[0].stop) + 0.5)
    downhill, slope = fall(x, y, z, mask)
    return Area(z, x, y, cell, mask, (part[0].start, part[1].start), downhill, slope)


def part_of(area: Area, inside: np.ndarray) -> Tuple[Area, Tuple[slice, slice]]:
    """The Area of some of the nodes inside, with its own fall line, and where in the arrays of the whole one it is."""
    row, column = np.nonzero(inside)
    rows, columns = (slice(one.min() - RIM, one.max() + RIM + 1) for one in (row, column))
    x, y, z, mask = area.x[columns], area.y[rows], area.z[rows, columns], inside[rows, columns]
    corner = area.corner[0] + rows.start, area.corner[1] + columns.start
    return Area(z, x, y, area.cell, mask, corner, *fall(x, y, z, mask)), (rows, columns)


def fill_remedy(z: np.ndarray, row: int, column: int) -> str:
    """What can be done about NODATA (NaN) at a row and column."""
    groups, _ = label(np.isnan(z), np.ones((3, 3)))
    hole = groups == groups[row, column]
    if np.count_nonzero(hole) == np.count_nonzero(hole[1:-1, 1:-1]):
        return f"; --fill {np.count_nonzero(hole)} of slope terrain and site fills this hole"
    return "; it goes on to the edge, where --fill does not fill: take a larger elevation model"


def fall(x: np.ndarray, y: np.ndarray, z: np.ndarray, mask: np.ndarray) -> Tuple[np.ndarray, float]:
    """Unit vector downhill, and slope in degrees, of the plane that fits the ground in a mask best.

    Parts that do not touch have planes of one slope, each at its own height: that one lies above the other is no fall.
    """
    row, column = np.nonzero(mask)
    part = label(mask, np.ones((3, 3)))[0][mask]

    def within(values: np.ndarray) -> np.ndarray:
        return values - (np.bincount(part, values) / np.maximum(np.bincount(part), 1))[part]

    points = np.column_stack([within(x[column]), within(y[row])])
    gradient = np.linalg.lstsq(points, within(z[mask]), rcond=None)[0]
    size = float(np.hypot(*gradient))
    downhill = -gradient / size if size > 1e-12 else np.array([1.0, 0.0])
    return downhill, math.degrees(math.atan(size))


def require_slope(area: Area, where: str) -> None:
    """Raise SlopeError if the ground has no fall line."""
    if area.slope < FLAT:
        raise SlopeError(where, f"the ground in it must fall by at least {FLAT:g} degree", f"{area.slope:.3g}, flat")


def fall_line(area: Area, geometry: BaseGeometry, where: str) -> FallLine:
    """The fall line of a polygon: through its centroid, or through a point inside where that is not in it."""
    middle = geometry.centroid
    if not geometry.contains(middle):
        middle = geometry.representative_point()
    middle = np.array(middle.coords[0])
    reach = math.hypot(geometry.bounds[2] - geometry.bounds[0], geometry.bounds[3] - geometry.bounds[1])
    line = LineString([middle - reach * area.downhill, middle + reach * area.downhill])
    crossed = line.intersection(geometry)
    points = np.concatenate([np.asarray(part.coords) for part in getattr(crossed, "geoms", [crossed])])
    place = (points - middle) @ area.downhill
    ends = points[[np.argmax(place), np.argmin(place)]]
    toe, shoulder = (np.append(end, height) for end, height in zip(ends, area.height(*ends.T)))
    if not shoulder[2] > toe[2]:
        raise SlopeError(where, "its shoulder, the upper end of the fall line through its middle, must be higher than "
                         f"its toe, {toe[2]:.6g} m", f"{shoulder[2]:.6g} m")
    return FallLine(toe, shoulder)


def across(geometry: BaseGeometry, line: FallLine) -> Tuple[float, float]:
    """How far polygons reach from a fall line, m: the least and the largest, to the left of its way up positive."""
    way = line.shoulder[:2] - line.toe[:2]
    way = way / np.hypot(*way)
    points = np.concatenate([np.asarray(part.exterior.coords)[:, :2] for part in polygons_of(geometry)])
    aside = (points - line.toe[:2]) @ np.array([-way[1], way[0]])
    return float(aside.min()), float(aside.max())
