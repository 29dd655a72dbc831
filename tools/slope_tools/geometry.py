"""Polygons and rasters in index coordinates: what a polygon covers of each cell, meshes of squares."""
import math

import numpy as np
import shapely.geometry
from shapely.affinity import affine_transform
from shapely.geometry import MultiPolygon
from shapely.geometry.polygon import orient

from .errors import SlopeError

MOST_MESH = 4_000_000  # mesh cells
ON_LINE = 1e-9         # cells; lines that are closer to each other are one


def extent(raster):
    """Local xlo, ylo, xhi, yhi of a north-up raster."""
    rows, columns = raster.z.shape
    (xlo, yhi), (xhi, ylo) = raster.transform @ (0, 0), raster.transform @ (columns, rows)
    return xlo, ylo, xhi, yhi


def extent_of(transform, mask):
    """The same of the cells of a mask, of which there must be one."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    (xlo, yhi), (xhi, ylo) = transform @ (columns[0], rows[0]), transform @ (columns[-1] + 1, rows[-1] + 1)
    return xlo, ylo, xhi, yhi


def box_of(raster):
    """The grid of a north-up raster as a polygon in local metres."""
    return shapely.geometry.box(*extent(raster))


def format_numbers(values):
    """Coordinates or bounds in a message."""
    return " ".join(f"{value:.10g}" for value in values)


def to_index(geometry, raster):
    """A geometry in local metres to index coordinates."""
    t = ~raster.transform
    return affine_transform(geometry, [t.a, t.b, t.d, t.e, t.c, t.f])


def shares_of_cells(geometry, raster):
    """What polygons, in local metres, cover of each cell of a raster."""
    rows, columns = raster.z.shape
    return coverage(to_index(geometry, raster), np.arange(columns + 1.0), np.arange(rows + 1.0))[0]


def polygons_of(geometry):
    """The polygons in a geometry, as a list; lines and points in it are dropped."""
    if geometry.geom_type == "Polygon":
        return [geometry] if not geometry.is_empty else []
    return [part for inner in getattr(geometry, "geoms", ()) for part in polygons_of(inner)]


def contains(geometry, x, y):
    """Whether points (arrays) lie in polygons."""
    if hasattr(shapely, "contains_xy"):
        return shapely.contains_xy(geometry, x, y)
    from shapely import vectorized      # of shapely 1
    return vectorized.contains(geometry, x, y)


def edges(geometry):
    """Start and end of every edge of the polygons in a geometry, interior on the left: two arrays (number, 2)."""
    rings = [np.asarray(ring.coords)[:, :2] for part in polygons_of(geometry)
             for ring in (lambda p: [p.exterior, *p.interiors])(orient(part))]
    if not rings:
        return np.empty((0, 2)), np.empty((0, 2))
    start, end = (np.concatenate([ring[cut] for ring in rings]) for cut in (slice(None, -1), slice(1, None)))
    real = (start != end).any(axis=1)
    return start[real], end[real]


def cut_at(lines, start, end):
    """Places (edge number, share of the edge) at which edges from start to end (one coordinate) cross the lines."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    first, last = np.searchsorted(lines, low, "right"), np.searchsorted(lines, high, "left")
    count = np.maximum(last - first, 0)
    edge = np.repeat(np.arange(len(start)), count)
    line = lines[np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + first[edge]]
    return edge, (line - start[edge]) / (end - start)[edge]


def pieces(x, y, start, end):
    """Edges cut at the lines x and y (ascending): number of the edge, start and end of each piece, in order."""
    edge = np.arange(len(start))
    cuts = [(edge, np.zeros(len(edge))), (edge, np.ones(len(edge))),
            cut_at(x, start[:, 0], end[:, 0]), cut_at(y, start[:, 1], end[:, 1])]
    edge, share = (np.concatenate(values) for values in zip(*cuts))
    order = np.lexsort((share, edge))
    edge, share = edge[order], share[order]
    points = start[edge] + share[:, None] * (end - start)[edge]
    points[share == 1] = end[edge[share == 1]]
    same = (edge[1:] == edge[:-1]) & (share[1:] > share[:-1])
    return edge[:-1][same], points[:-1][same], points[1:][same]


def coverage(geometry, x, y):
    """Area of a polygon in each cell of the grid of lines x and y (ascending), and its moments about x = 0, y = 0.

    The polygon must lie within the lines. Three arrays (len(y) - 1, len(x) - 1): area, integral of x, integral of y.
    Exact: the areas to the right of the edges are added up (Green's theorem), edge by edge and cell by cell.
    """
    shape = len(y) - 1, len(x) - 1
    _, a, b = pieces(x, y, *edges(geometry))
    middle = (a + b) / 2
    column = np.clip(np.searchsorted(x, middle[:, 0], "right") - 1, 0, shape[1] - 1)
    row = np.clip(np.searchsorted(y, middle[:, 1], "right") - 1, 0, shape[0] - 1)
    place = row * shape[1] + column
    (ax, ay), (bx, by) = a.T, b.T
    fall = ay - by  # the interior is on the left: right of an edge that falls

    def total(values):
        return np.bincount(place, values, shape[0] * shape[1]).reshape(shape)

    def to_the_right(values):  # what the cells to the right of each cell get per unit of their width
        return np.cumsum(values, axis=1) - values

    right, width = x[column + 1], np.diff(x)
    fall_x_y = fall * (2 * ax * ay + 2 * bx * by + ax * by + bx * ay) / 6  # integral of x y
    fall_x_x = fall * (ax * ax + ax * bx + bx * bx) / 3
    crossed, crossed_y = to_the_right(total(fall)), to_the_right(total(fall * middle[:, 1]))
    area = total(fall * (right - middle[:, 0])) + width * crossed
    in_x = total((fall * right ** 2 - fall_x_x) / 2) + np.diff(x ** 2) / 2 * crossed
    in_y = total(fall * middle[:, 1] * right - fall_x_y) + width * crossed_y
    return area, in_x, in_y


class Lines:
    """Lines across one axis of a grid of n cells: the edges of the cells, k parts of each, and those of a mesh.

    at: where they are, in cells; first[i]: number of the line at the start of cell i; mesh[j]: mesh cell between
    lines j and j + 1. mesh_lines: ascending, from <= 0 to >= n.
    """

    def __init__(self, n, k, mesh_lines):
        regular = np.arange(n * k + 1) / k
        inner = mesh_lines[(mesh_lines > 0) & (mesh_lines < n)]
        inner = inner[np.abs(inner * k - np.round(inner * k)) > ON_LINE * k]
        self.at = np.sort(np.concatenate([regular, inner]))
        self.first = np.searchsorted(self.at, np.arange(n + 1))
        self.mesh = np.searchsorted(mesh_lines, (self.at[1:] + self.at[:-1]) / 2) - 1


class Mesh:
    """Squares of a size (m) that cover a raster, their corners at multiples of the size in local x and y.

    shape: rows from the north and columns; x, y: their lines in index coordinates of the raster, ascending.
    """

    def __init__(self, size, raster):
        xlo, ylo, xhi, yhi = extent(raster)
        cell = raster.transform.a
        slack = ON_LINE * cell
        first = [math.floor((low + slack) / size) for low in (xlo, ylo)]
        last = [math.ceil((high - slack) / size) for high in (xhi, yhi)]
        self.size, self.first = size, first
        self.shape = last[1] - first[1], last[0] - first[0]
        self.x = (size * np.arange(first[0], last[0] + 1) - xlo) / cell
        self.y = (yhi - size * np.arange(last[1], first[1] - 1, -1)) / cell
        for lines, n in ((self.x, raster.z.shape[1]), (self.y, raster.z.shape[0])):
            lines[0], lines[-1] = min(lines[0], 0), max(lines[-1], n)  # rounding must not leave a cell outside
        self.transform = type(raster.transform)(size, 0, first[0] * size, 0, -size, last[1] * size)

    def corner(self, row, column):
        """Local x, y of the lower left corner of mesh cells."""
        return self.transform.c + column * self.size, self.transform.f - (row + 1) * self.size

    def sums(self, values):
        """Integral of cell values over each mesh cell, in units of value x cell area; values are even in a cell."""
        for axis, lines in ((0, self.y), (1, self.x)):
            parts = Lines(values.shape[axis], 1, lines)
            cell = np.repeat(np.arange(values.shape[axis]), np.diff(parts.first))
            width = np.diff(parts.at)
            values = np.take(values, cell, axis) * (width if axis else width[:, None])
            starts = np.flatnonzero(np.diff(parts.mesh, prepend=-1))
            values = np.add.reduceat(values, starts, axis)
        return values


def make_mesh(size, raster):
    """The Mesh of that size over the raster; SlopeError if it would have too many cells."""
    xlo, ylo, xhi, yhi = extent(raster)
    count = ((xhi - xlo) / size + 1) * ((yhi - ylo) / size + 1)
    if count > MOST_MESH:
        raise SlopeError("--mesh", f"must give at most {MOST_MESH} mesh cells, the grid would need {count:.3g}",
                         f"{size:g}")
    return Mesh(size, raster)


def as_multi(geometry):
    return MultiPolygon(polygons_of(geometry))


def parts_of(geometry):
    """The single geometries of any geometry."""
    return [part for one in getattr(geometry, "geoms", [geometry]) for part in getattr(one, "geoms", [one])
            if not part.is_empty]


def coordinates(geometry) -> np.ndarray:
    """All x and y of lines, points and the outer rings of polygons, rows."""
    found = [np.asarray(getattr(one, "exterior", one).coords)[:, :2] for one in parts_of(geometry)]
    return np.concatenate(found) if found else np.zeros((0, 2))
