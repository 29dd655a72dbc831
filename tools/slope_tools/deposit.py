"""What fix deposit/grid wrote, read back, and what the commands that evaluate it share.

Plan geometry on its grid is done in index coordinates: x in columns from the west edge, y in rows from the north edge.
There a cell is the unit square between whole numbers, and areas are in cells.
"""
import math
import os
import shutil
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple, Optional

import numpy as np
import shapely.geometry
import yaml
from shapely.affinity import affine_transform
from shapely.geometry import MultiPolygon
from shapely.geometry.polygon import orient

from . import rasters, runs
from .errors import SlopeError
from .rasters import Raster

SAME_BALANCE = 1e-6    # relative; volume of the raster and in the summary
SAME_HEIGHT = 1e-7     # of the largest height; two rasters of nine digits
ON_LINE = 1e-9         # cells; lines that are closer to each other are one


class Deposit(NamedTuple):
    """A run's deposit: thickness on the raster (m, >= 0, 0 outside of it), ground below it (m, NaN where none)."""
    prefix: str
    raster: Raster          # z is the thickness; CRS and offset of the terrain
    base: np.ndarray
    summary: dict           # PREFIX.summary.yaml
    terrain: Optional[str]  # file that gave CRS and offset

    @property
    def cell(self):
        return float(self.raster.transform.a)

    @property
    def volume(self):
        """Bulk volume on the grid (m3)."""
        return float(self.raster.z.sum()) * self.cell ** 2

    @property
    def bulk(self):
        """The run's bulk factor: volume of ground / volume of the balls."""
        return float(self.summary["bulk_factor"])


def read(prefix, terrain, warn):
    """The Deposit that a run wrote to PREFIX, in the CRS of terrain (None: terrain.asc in the same folder, if any).

    warn is called with one line for each thing that makes the numbers doubtful.
    """
    names = [f"{prefix}.{kind}" for kind in ("thickness.asc", "surface.asc", "summary.yaml")]
    for name in names:
        if not Path(name).is_file():
            raise SlopeError(name, f"must be an existing file; {prefix} must be the output of fix deposit/grid")
    summary = read_summary(names[2])
    thickness, surface = (rasters.read(name, heights=False) for name in names[:2])
    if thickness.z.shape != surface.z.shape or thickness.transform != surface.transform:
        raise SlopeError(names[1], f"must have the grid of {names[0]}")
    if min(thickness.z.shape) < 2:
        raise SlopeError(names[0], "must have at least 2 x 2 cells", f"{thickness.z.shape[1]} x {thickness.z.shape[0]}")
    wrong = np.argwhere(~(thickness.z >= 0))  # NaN too
    if len(wrong):
        row, column = wrong[0]
        raise SlopeError(f"{names[0]}: row {row + 1} column {column + 1}", "must be a thickness >= 0",
                         f"{thickness.z[row, column]:g}")
    terrain, place = find_terrain(prefix, terrain, thickness, warn)
    raster = thickness._replace(crs=place.crs, offset=place.offset) if place else thickness
    deposit = Deposit(str(prefix), raster, read_base(prefix, thickness, surface), summary, terrain)
    told = summary["volume"]["on_grid"]
    if abs(deposit.volume - told) > SAME_BALANCE * max(told, 1e-30):
        raise SlopeError(names[0], f"must hold the volume that {names[2]} tells, {told:.10g} m3: are they of one run?",
                         f"{deposit.volume:.10g} m3")
    if summary["moving"]:
        warn(f"{names[2]}: the mass was still moving at {summary['time']:g} s: these are not final numbers")
    lost = summary["volume"]["off_grid"] + summary["volume"]["lost"]
    if lost > SAME_BALANCE * deposit.volume:
        warn(f"{names[2]}: {lost:.6g} m3 of the mass left the grid or the box and are not counted")
    return deposit


def read_base(prefix, thickness, surface):
    """The ground without the body (m): PREFIX.base.asc; of an older run, which wrote none, surface - thickness."""
    name = f"{prefix}.base.asc"
    difference = surface.z - thickness.z
    if not Path(name).is_file():
        return difference
    base = rasters.read(name, heights=False)
    if base.z.shape != thickness.z.shape or base.transform != thickness.transform:
        raise SlopeError(name, f"must have the grid of {prefix}.thickness.asc")
    largest = np.nanmax(np.abs(surface.z), initial=1.0)
    wrong = np.argwhere((np.isnan(base.z) != np.isnan(difference))
                        | (np.abs(base.z - difference) > SAME_HEIGHT * largest))
    if len(wrong):
        row, column = wrong[0]
        raise SlopeError(f"{name}: row {row + 1} column {column + 1}",
                         f"must be {prefix}.surface.asc less the thickness, {difference[row, column]:.9g}: are they of "
                         "one run?", f"{base.z[row, column]:.9g}")
    return base.z


def read_summary(path):
    what = "a summary that fix deposit/grid wrote"
    summary = runs.parse_yaml(path, what)
    try:
        for value in (summary["bulk_factor"], summary["time"],
                      *(summary["volume"][key] for key in ("on_grid", "off_grid", "lost"))):
            if not runs.is_number(value):
                raise ValueError(str(value)[:60])
        if not (isinstance(summary["moving"], bool) and summary["bulk_factor"] > 0):
            raise ValueError("moving, bulk_factor")
    except (ValueError, KeyError, TypeError) as error:
        raise SlopeError(path, f"must be {what} ({error!r})") from error
    return summary


def find_terrain(prefix, terrain, raster, warn):
    """The file that tells where the run's grid lies and its Place; a warning and None, None without one."""
    found = terrain or Path(prefix).with_name("terrain.asc")
    if terrain is None and not found.is_file():
        warn(f"no --terrain and no {found}: no CRS, coordinates are the local metres of the run")
        return None, None
    place = rasters.read_place(found)
    grid, slack = extent(raster), 1e-6 * raster.transform.a
    # fix deposit/grid covers its extent with whole cells from the south-west corner on: the last ones, in the east and
    # in the north, may reach beyond the terrain
    slack = np.array([slack, slack, raster.transform.a, raster.transform.a])
    outside = np.subtract(place.extent, grid) * [1, 1, -1, -1] > slack
    if outside.any():
        raise SlopeError(found, f"must be the terrain of the run, whose grid is {box(grid)}; --terrain names another",
                         box(place.extent))
    if place.crs is None:
        warn(f"{found} has no CRS: coordinates are metres as in that file" if place.offset != (0, 0) else
             f"{found} has no CRS: coordinates are the local metres of the run")
    return str(found), place


def extent(raster):
    """Local xlo, ylo, xhi, yhi of a north-up raster."""
    rows, columns = raster.z.shape
    (xlo, yhi), (xhi, ylo) = raster.transform * (0, 0), raster.transform * (columns, rows)
    return xlo, ylo, xhi, yhi


def box_of(raster):
    """The grid of a north-up raster as a polygon in local metres."""
    return shapely.geometry.box(*extent(raster))


def box(bounds):
    return " ".join(f"{value:.10g}" for value in bounds)


def to_index(geometry, raster):
    """A geometry in local metres to index coordinates."""
    t = ~raster.transform
    return affine_transform(geometry, [t.a, t.b, t.d, t.e, t.c, t.f])


def to_local(geometry, raster):
    """A geometry in index coordinates to local metres."""
    t = raster.transform
    return affine_transform(geometry, [t.a, t.b, t.d, t.e, t.c, t.f])


# --- areas on a grid of lines ---

def polygons_of(geometry):
    """The polygons in a geometry, as a list; lines and points in it are dropped."""
    if geometry.geom_type == "Polygon":
        return [geometry] if not geometry.is_empty else []
    return [part for inner in getattr(geometry, "geoms", ()) for part in polygons_of(inner)]


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


# --- output ---

@contextmanager
def complete(folder):
    """A folder to write results into; when all are there they move to `folder`, by renames, else nothing changes."""
    told, folder = folder, Path(folder).resolve()
    # on the disk of the folder, so that renames do
    new = (folder if folder.is_dir() else folder.parent) / f".{folder.name}.{os.getpid()}.new"
    try:
        new.mkdir()
        yield new
        folder.mkdir(exist_ok=True)
        for path in sorted(new.iterdir()):
            os.replace(path, folder / path.name)
    except OSError as error:
        raise SlopeError(told, f"cannot be written: {error.strerror or error}") from error
    finally:
        shutil.rmtree(new, ignore_errors=True)


def check_folder(folder):
    """Raise SlopeError if results cannot go to that folder, before the work is done."""
    if folder.exists() and not folder.is_dir():
        raise SlopeError("-o", "must be a folder", folder)
    if not folder.resolve().parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", folder)


def plain(value):
    """numpy's numbers, tuples and paths as what YAML and JSON know."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(inner) for inner in value]
    if isinstance(value, np.generic):
        return value.item()
    return str(value) if isinstance(value, Path) else value


def write_yaml(path, about, comment):
    with open(path, "w", encoding="utf-8") as out:
        out.write(f"# {comment}\n")
        yaml.safe_dump(plain(about), out, sort_keys=False, allow_unicode=True)


def warner(command, kept):
    """A function that prints a warning of a command on standard error, and keeps it in a list."""
    def warn(text):
        kept.append(text)
        print(f"slope {command}: warning: {text}", file=sys.stderr)
    return warn


def as_multi(geometry):
    return MultiPolygon(polygons_of(geometry))
