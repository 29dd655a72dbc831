"""slope terrain: survey rasters to the plain terrain.asc that `region terrain` reads, with a sidecar.

Order of the work: read, merge, fill holes, crop or resample, move to the local origin, write.
"""
import argparse
import math
import sys
from pathlib import Path

import numpy as np
import rasterio
import rasterio.warp
from affine import Affine
from rasterio.crs import CRS
from rasterio.errors import CRSError

from . import fggml, rasters
from .cli import number
from .errors import SlopeError
from .rasters import Raster, crs_name, epsg

ON_GRID = 0.01         # cells; grids of two files that differ by less than this are the same grid
SAME_CELL = 1e-6       # relative; a smaller difference of cell sizes is noise of the header's digits
FINEST = 100           # a wanted cell may be this many times smaller than the input's
STRETCH = 0.01         # relative error of lengths in a CRS from which on the user is warned
STRIP = 250_000        # points resampled at a time

EPILOG = """\
units: metres for heights, --cell, and coordinates; N of --fill is a number of cells of the input.

FG-GML of Japan's Geospatial Information Authority (DEM1A, DEM5A to 5C, DEM10A, 10B) is taken as it is downloaded. Its
--crs is the zone of the plane rectangular system at the site if none is given, and its --cell 1, 5 or 10 m. Tiles of
several resolutions need a --cell: finer ones count where they have heights.

examples: two tiles in degrees, to zone IX of the Japanese plane rectangular system, cells of 2 m; a download of FG-GML:
  tools/slope terrain north.tif south.tif -o terrain.asc --crs EPSG:6677 --cell 2 --fill 20
  tools/slope terrain FG-GML-5439-23-DEM5A.zip -o terrain.asc

Writes terrain.asc and terrain.yaml (CRS, origin, sources, what was done).
"""


def add_parser(commands, **kwargs):
    """Add `terrain` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "terrain", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Survey rasters (GeoTIFF, ESRI ASCII grid, FG-GML) to the plain terrain.asc that decks read.",
        **kwargs)
    parser.add_argument("inputs", metavar="IN", nargs="+",
                        help="raster of heights in metres, or FG-GML (.xml, or .zip of them); several are merged, "
                             "which needs one CRS and one grid")
    parser.add_argument("-o", dest="output", metavar="OUT.asc", required=True, type=Path,
                        help="the terrain; OUT.yaml beside it is its sidecar")
    parser.add_argument("--crs", metavar="EPSG:n",
                        help="wanted CRS, in metres: an input in another CRS is reprojected to it (bilinear); an input "
                             "without a CRS cannot be, and is taken to be in this one")
    parser.add_argument("--bounds", nargs=4, type=number, metavar=("W", "S", "E", "N"),
                        help="crop to this box, in the output's CRS, m")
    parser.add_argument("--cell", type=number, metavar="S",
                        help="wanted cell size, m (bilinear; larger cells get the mean of several points)")
    parser.add_argument("--origin", nargs="+", default=["auto"], metavar=("auto|E", "N"),
                        help="what becomes 0 0: auto (default), the lower left corner rounded down to whole metres; "
                             "or E N, in the output's CRS, m")
    parser.add_argument("--fill", type=int, default=0, metavar="N",
                        help="fill NODATA holes of at most N cells (default 0: none); holes at the edge stay")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints what was done, a summary and the line for the deck."""
    crs, origin = check(args)
    steps = []  # what was done, for stdout and the sidecar

    def tell(step):
        steps.append(step)
        print(step)

    cell = args.cell
    if any(map(fggml.is_one, args.inputs)):
        raster, crs, cell = read_fggml(args.inputs, crs, cell, tell)
    else:
        raster = merge([declare(path, crs, tell) for path in args.inputs], args.inputs, tell)
        crs = crs or raster.crs
    require_metres(crs, args.inputs[0])
    if not np.isfinite(raster.z).any():
        raise SlopeError(", ".join(args.inputs), "must have a height, all cells are NODATA")
    filled = 0
    if args.fill:
        holes, count = small_holes(np.isnan(raster.z), args.fill)
        filled = int(holes.sum())
        raster = raster._replace(z=fill(raster.z, holes))
        tell(f"filled {count} NODATA holes of at most {args.fill} cells, {filled} cells")
    raster = regrid(raster, crs, cell, args.bounds, tell)
    if crs is not None:
        warn_of_stretch(raster)

    z = np.round(raster.z, 3) + 0.0  # as they are written; + 0.0 because of -0.0
    if origin is None:
        origin = tuple(math.floor(corner + 1e-6) for corner in raster.transform * (0, len(z)))  # 1e-6: rounding noise
    local = Raster(z, Affine.translation(-origin[0], -origin[1]) * raster.transform, crs, origin)
    about = rasters.write_asc_local(args.output, local,
                                    {"filled_cells": filled, "sources": args.inputs, "steps": steps})
    print(summary(args.output, about))


def check(args):
    """Check what can be checked before any reading; return the wanted CRS and origin, each None if not given."""
    if args.output.suffix != ".asc" or args.output.is_dir():
        raise SlopeError("-o", "must be a file that ends in .asc", args.output)
    if not args.output.parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", args.output)
    for path in args.inputs:
        if args.output.exists() and Path(path).exists() and args.output.samefile(path):
            raise SlopeError("-o", "must not be an input", args.output)
    if args.cell is not None and args.cell <= 0:
        raise SlopeError("--cell", "must be > 0", f"{args.cell:g}")
    if args.fill < 0:
        raise SlopeError("--fill", "must be >= 0", args.fill)
    if args.bounds and not (args.bounds[0] < args.bounds[2] and args.bounds[1] < args.bounds[3]):
        raise SlopeError("--bounds", "W S E N must have W < E and S < N", box(args.bounds))
    crs = origin = None
    if args.crs:
        try:
            with rasterio.Env():  # GDAL's own message is not for stderr
                crs = CRS.from_user_input(args.crs)
        except CRSError:
            raise SlopeError("--crs", "must be a CRS such as EPSG:6677", args.crs) from None
        require_metres(crs, "--crs")
    if args.origin != ["auto"]:
        try:
            origin = tuple(map(number, args.origin))
        except argparse.ArgumentTypeError:
            origin = ()
        if len(origin) != 2:
            raise SlopeError("--origin", "must be auto or two numbers, E N", " ".join(args.origin))
    return crs, origin


def box(bounds):
    return " ".join(f"{value:.10g}" for value in bounds)


def warn(text):
    print(f"slope terrain: warning: {text}", file=sys.stderr)


def same_crs(a, b):
    """Whether two CRS (or None) are one, however they are spelt."""
    return a == b or (a is not None and b is not None and epsg(a) is not None and epsg(a) == epsg(b))


def require_metres(crs, where):
    """Raise SlopeError unless crs is in metres; None is taken to be (the caller has warned)."""
    if crs is None:
        return
    try:
        unit, factor = crs.linear_units_factor
    except CRSError:
        unit, factor = "degrees" if crs.is_geographic else "no plane unit", None
    if crs.is_geographic or factor != 1:
        raise SlopeError(where, "CRS must be in metres; give --crs EPSG:n of a projected one",
                         f"{crs_name(crs)} in {unit}")


def warn_of_stretch(raster):
    """Warn where a metre of the CRS is not a metre on the ground (Web Mercator at 37 N: 0.8 m), by more than 1 %."""
    x, y = raster.transform * (raster.z.shape[1] / 2, raster.z.shape[0] / 2)
    lon, lat = np.radians(transform(raster.crs, CRS.from_epsg(4326), x + np.array([0, 1, 0]), y + np.array([0, 0, 1])))
    a, e2 = 6378137.0, 0.00669438  # WGS 84: half axis (m), eccentricity squared
    n = a / math.sqrt(1 - e2 * math.sin(lat[0]) ** 2)  # radii of curvature, m: prime vertical, meridian
    m = n ** 3 * (1 - e2) / a ** 2
    for i in (1, 2):
        metre = math.hypot(n * math.cos(lat[0]) * (lon[i] - lon[0]), m * (lat[i] - lat[0]))
        if not abs(metre - 1) < STRETCH:
            return warn(f"a metre in {crs_name(raster.crs)} is {metre:.3f} m on the ground: choose a local CRS")


def declare(path, crs, tell):
    """Read a raster, in coordinates of its CRS; one without is taken to be in crs, or warned of if that is None."""
    local = rasters.read_asc_local(path)
    raster = Raster(local.z, Affine.translation(*local.offset) * local.transform, local.crs)
    if raster.crs is None and crs is not None:
        tell(f"{path} has no CRS: taken as {crs_name(crs)}")
        return raster._replace(crs=crs)
    if raster.crs is None:
        warn(f"{path} has no CRS: its coordinates are taken as metres; --crs declares one")
    return raster


def read_fggml(paths, crs, cell, tell):
    """One raster in degrees of all FG-GML tiles in the files, and the wanted CRS and cell, found if they are None."""
    tiles = []
    for path in paths:
        if not fggml.is_one(path):
            raise SlopeError(path, "must be FG-GML as other inputs are: make a terrain of each kind")
        found = fggml.read(path)
        sizes = {f"{z.shape[1]} x {z.shape[0]} cells" for z in (tile.raster.z for tile in found)}
        tell(f"{path}: FG-GML, {len(found)} tile{'s' * (len(found) > 1)} of {' or '.join(sorted(sizes))}, "
             f"{' and '.join(sorted({tile.datum for tile in found}))}")
        tiles += found
    tiles = fggml.one_datum(tiles, warn)
    groups = fggml.by_resolution(tiles)
    if len(groups) > 1 and cell is None:
        raise SlopeError(groups[1][0].name, f"must have the resolution of {groups[0][0].name}, "
                         f"{seconds(groups[0][0])}, unless a --cell is given", seconds(groups[1][0]))
    merged = [merge([tile.raster for tile in group], [tile.name for tile in group], tell) for group in groups]
    raster = merged[0]
    for group, coarse in zip(groups[1:], merged[1:]):
        raster = enlarge(raster, coarse)
        tell(f"where there was no height: bilinear from the tiles of {seconds(group[0])}")
    if crs is None:
        number, crs = fggml.zone(raster, tiles[0].datum)
        tell(f"CRS {crs_name(crs)}, zone {number} of the plane rectangular system, the site's; --crs names another")
    return raster, crs, cell or fggml.nominal_cell(min(footprint(raster, crs)[1]))


def seconds(tile):
    return "{:.4g} x {:.4g} seconds of arc".format(*fggml.spacing(tile))


def enlarge(fine, coarse):
    """A raster on the grid of `fine` over both, in one CRS; where fine has no height, it is coarse's, bilinear."""
    rows, columns = fine.z.shape
    (left, top), (right, bottom) = (~fine.transform * (coarse.transform * corner)
                                    for corner in ((0, 0), coarse.z.shape[::-1]))
    left, top = (min(0, math.floor(value + ON_GRID)) for value in (left, top))
    right, bottom = max(columns, math.ceil(right - ON_GRID)), max(rows, math.ceil(bottom - ON_GRID))
    rasters.check_memory(bottom - top, right - left, "merged raster")
    z = np.full((bottom - top, right - left), np.nan)
    z[-top:rows - top, -left:columns - left] = fine.z
    transform = fine.transform * Affine.translation(left, top)
    strip = max(1, STRIP // z.shape[1])
    for first in rasters.progress(range(0, len(z), strip), "merging"):
        part = z[first:first + strip]
        row, column = np.nonzero(np.isnan(part))
        part[row, column] = sample(coarse, *(transform * (column + 0.5, row + first + 0.5)))
    return Raster(z, transform, fine.crs)


def merge(inputs, paths, tell):
    """One raster over all inputs, which must share CRS and grid. In an overlap the first one with a height counts."""
    first = inputs[0]
    if len(inputs) == 1:
        return first
    places = []  # row and column of each input's first cell, in cells of the first input
    for path, raster in zip(paths, inputs):
        if not same_crs(raster.crs, first.crs):
            raise SlopeError(f"{path}: CRS", f"must be that of {paths[0]}, {crs_name(first.crs)}", crs_name(raster.crs))
        across, down = (~first.transform * corner for corner in
                        (raster.transform * (0, 0), raster.transform * raster.z.shape[::-1]))
        column, row = (round(value) for value in across)
        expected = (column, row, column + raster.z.shape[1], row + raster.z.shape[0])
        if np.abs(np.subtract(across + down, expected)).max() > ON_GRID:
            raise SlopeError(f"{path}: grid", f"must share the grid of {paths[0]}, {grid(first)}", grid(raster))
        places.append((row, column))
    top, left = np.min(places, axis=0)
    bottom, right = np.max([np.add(place, raster.z.shape) for place, raster in zip(places, inputs)], axis=0)
    rasters.check_memory(int(bottom - top), int(right - left), "merged raster")

    z = np.full((bottom - top, right - left), np.nan)
    twice, largest = 0, 0.0
    for (row, column), raster in zip(places, inputs):
        part = z[row - top:row - top + raster.z.shape[0], column - left:column - left + raster.z.shape[1]]
        difference = np.abs(part - raster.z)[np.isfinite(part) & np.isfinite(raster.z)]
        if difference.size:
            twice += difference.size
            largest = max(largest, difference.max())
        np.copyto(part, raster.z, where=np.isnan(part))
    tell(f"merged {len(inputs)} rasters; {twice} cells in more than one, the first file counts"
         + (f", heights differ by up to {largest:.3f} m" if twice else ""))
    return Raster(z, first.transform * Affine.translation(int(left), int(top)), first.crs)


def grid(raster):
    t = raster.transform
    return f"cells of {t.a:.10g} x {-t.e:.10g} from {t.c:.10g} {t.f:.10g}"


def small_holes(empty, most):
    """Mask and number of the holes in a boolean array: groups of at most `most` True cells, none of them at the edge.

    Cells that touch, corners included, are one group. Works on runs of cells along the rows, so that large empty
    areas cost little.
    """
    steps = np.diff(np.pad(empty, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = (index.tolist() for index in np.nonzero(steps == 1))
    stops = np.nonzero(steps == -1)[1].tolist()  # one past the end; runs are in the same order
    parent = list(range(len(rows)))

    def root(run):
        while parent[run] != run:
            parent[run] = run = parent[parent[run]]
        return run

    above = 0  # first run of the row above that does not end left of this one
    for run, (row, start, stop) in enumerate(zip(rows, starts, stops)):
        while rows[above] < row - 1 or (rows[above] == row - 1 and stops[above] < start):
            above += 1
        touching = above
        while rows[touching] == row - 1 and starts[touching] <= stop:
            parent[root(touching)] = root(run)
            touching += 1

    mask = np.zeros_like(empty)
    if not rows:
        return mask, 0
    group = np.array([root(run) for run in range(len(rows))])
    rows, starts, stops = map(np.array, (rows, starts, stops))
    at_edge = (rows == 0) | (rows == empty.shape[0] - 1) | (starts == 0) | (stops == empty.shape[1])
    hole = (np.bincount(group, stops - starts) <= most) & (np.bincount(group, at_edge) == 0)
    chosen = hole[group]
    for row, start, stop in zip(rows[chosen], starts[chosen], stops[chosen]):
        mask[row, start:stop] = True
    return mask, len(np.unique(group[chosen]))


def fill(z, holes):
    """Heights with the holes (a mask, none of it at the edge) filled: each cell is the mean of its four neighbours.

    That is the membrane on the rim; it fills a hole in a plane exactly. GDAL's fillnodata leaves a step: on a slope of
    0.76 and cells of 5 m, 1.4 m at a single cell. All holes are one linear system, solved by conjugate gradients.
    """
    row, column = np.nonzero(holes)
    if not len(row):
        return z
    near_row, near_column = row[:, None] + [-1, 1, 0, 0], column[:, None] + [0, 0, -1, 1]
    number = np.full(z.shape, len(row))  # of an unknown; past the last one for a known height
    number[row, column] = np.arange(len(row))
    near = number[near_row, near_column]
    rim = np.where(near == len(row), z[near_row, near_column], 0).sum(axis=1)

    def matrix(x):
        return 4 * x - np.append(x, 0)[near].sum(axis=1)

    heights = np.full(len(row), np.nanmean(z))
    residual = rim - matrix(heights)
    direction = residual
    for _ in range(10 * len(row)):  # as many as unknowns would do, but for rounding
        if np.abs(residual).max() < 1e-7:
            break
        image = matrix(direction)
        length = residual @ residual / (direction @ image)
        heights = heights + length * direction
        left = residual - length * image
        direction = left + (left @ left) / (residual @ residual) * direction
        residual = left
    filled = z.copy()
    filled[row, column] = heights
    return filled


def regrid(raster, crs, cell, bounds, tell):
    """The raster in crs, on square cells, inside bounds: the input's own cells where that suffices, else resampled.

    cell and bounds may be None: then the input's, or in a new CRS its cell at the middle of the raster to three digits.
    """
    moved = not same_crs(raster.crs, crs)
    extent, native = footprint(raster, crs)
    if cell is None:
        cell = min(native)
        if moved:
            cell = float(f"{cell:.3g}")
    if cell * FINEST < min(native):
        raise SlopeError("--cell", f"must be at least 1/{FINEST} of the input's, {min(native):.6g} m", f"{cell:g}")
    wanted = extent
    if bounds:
        wanted = *np.maximum(bounds[:2], extent[:2]), *np.minimum(bounds[2:], extent[2:])
        if wanted[0] >= wanted[2] or wanted[1] >= wanted[3]:
            raise SlopeError("--bounds", f"must overlap the input, {box(extent)}", box(bounds))
        if not np.allclose(wanted, bounds, rtol=0, atol=cell * SAME_CELL):
            warn(f"--bounds reaches beyond the input, {box(extent)}: cut to it")

    t = raster.transform
    square = t.b == t.d == 0 and t.a > 0 and abs(t.a + t.e) <= SAME_CELL * t.a
    if square and not moved and abs(cell - t.a) <= SAME_CELL * t.a:
        out, done = raster, None
        if bounds:
            out = crop(raster, wanted)
            done = (f"cropped to {out.z.shape[1]} x {out.z.shape[0]} of {raster.z.shape[1]} x {raster.z.shape[0]} "
                    "cells, whole cells")
    else:
        if moved and not bounds:
            wanted = *np.floor(np.divide(wanted[:2], cell)) * cell, *wanted[2:]  # round coordinates
        points = max(1, round(cell / min(native)))
        out = trim(resample(raster, crs, cell, wanted, points))
        what = f"reprojected from {crs_name(raster.crs)} to {crs_name(crs)}" if moved else "resampled"
        how = "bilinear" if points == 1 else f"bilinear, mean of {points} x {points} points"
        done = f"{what}, cells of {native[0]:.6g} x {native[1]:.6g} m to {cell:.6g} m, {how}"
    if not np.isfinite(out.z).any():
        raise SlopeError("--bounds" if bounds else "output", "must hold a height, all cells are NODATA")
    check_size(*out.z.shape)
    if done:
        tell(done)
    return out


def check_size(rows, columns):
    if min(rows, columns) < 2:
        raise SlopeError("output", "must have at least 2 x 2 cells", f"{columns} x {rows}")


def footprint(raster, crs):
    """(W, S, E, N) of a raster in crs, and the width and height of its middle cell there (m)."""
    rows, columns = raster.z.shape
    x, y = raster.transform * (np.array([0, columns, 0, columns]), np.array([0, 0, rows, rows]))
    extent = x.min(), y.min(), x.max(), y.max()
    x, y = raster.transform * (columns / 2 + np.array([0, 1, 0]), rows / 2 + np.array([0, 0, 1]))
    if not same_crs(raster.crs, crs):
        x, y = transform(raster.crs, crs, x, y)
        extent = rasterio.warp.transform_bounds(raster.crs, crs, *extent)
        if not np.isfinite([*extent, *x, *y]).all():
            raise not_covered(raster.crs, crs)
    return tuple(map(float, extent)), tuple(float(math.hypot(x[i] - x[0], y[i] - y[0])) for i in (1, 2))


def transform(source, target, x, y):
    """Coordinate arrays x, y from one CRS to another; inf, or SlopeError, where there is no answer."""
    try:
        new_x, new_y = rasterio.warp.transform(source, target, x.ravel(), y.ravel())
    except Exception as error:  # GDAL's, of a class that rasterio keeps private
        raise not_covered(source, target) from error
    return np.reshape(new_x, x.shape), np.reshape(new_y, y.shape)


def not_covered(source, target):
    return SlopeError("--crs", f"must cover the input, which is in {crs_name(source)}", crs_name(target))


def crop(raster, bounds):
    """The cells of a north-up raster that the bounds (which overlap it) touch."""
    (left, bottom), (right, top) = (~raster.transform * corner for corner in (bounds[:2], bounds[2:]))
    left, top = (max(0, math.floor(value + SAME_CELL)) for value in (left, top))
    right, bottom = (math.ceil(value - SAME_CELL) for value in (right, bottom))
    return raster._replace(z=raster.z[top:bottom, left:right],
                           transform=raster.transform * Affine.translation(left, top))


def resample(raster, crs, cell, bounds, points):
    """Heights on square cells (m) in crs, from the lower left corner of bounds on.

    The input's surface is bilinear between its cell centres, as `region terrain` has it. A cell gets the mean of its
    heights at points x points places: 1, the centre, unless cells are larger than the input's, whose heights then all
    count. This keeps a plane exactly. GDAL's warper would not: it carries heights half a cell beyond the outermost
    centres and around NODATA, moves points by up to 1/8 cell, and weighs unevenly when cells grow by a factor that is
    not whole. NaN where an input cell that counts is NODATA or missing.
    """
    west, south, east, north = bounds
    columns, rows = (max(1, math.ceil(side / cell - SAME_CELL)) for side in (east - west, north - south))
    check_size(rows, columns)
    rasters.check_memory(rows, columns, "output")
    out_transform = Affine(cell, 0, west, 0, -cell, south + rows * cell)
    fine = out_transform * Affine.scale(1 / points)
    moved = not same_crs(raster.crs, crs)
    z = np.empty((rows, columns))
    strip = max(1, STRIP // (columns * points * points))
    for first in rasters.progress(range(0, rows, strip), "resampling"):
        count = min(strip, rows - first)
        x, y = fine * np.meshgrid(np.arange(columns * points) + 0.5,
                                  np.arange(first * points, (first + count) * points) + 0.5)
        if moved:
            x, y = transform(crs, raster.crs, x, y)
        z[first:first + count] = sample(raster, x, y).reshape(count, points, columns, points).mean(axis=(1, 3))
    return Raster(z, out_transform, crs)


def sample(raster, x, y):
    """Heights at points x, y (arrays, the raster's CRS), bilinear between cell centres; NaN outside of these."""
    rows, columns = raster.z.shape
    column, row = (snap(index - 0.5) for index in ~raster.transform * (x, y))
    inside = (column >= 0) & (column <= columns - 1) & (row >= 0) & (row <= rows - 1)
    column, row = np.where(inside, column, 0), np.where(inside, row, 0)
    # On a centre both neighbours are the same cell: one without weight must not bring in its NaN.
    left, right, top, bottom = (index.astype(int) for index in
                                (np.floor(column), np.ceil(column), np.floor(row), np.ceil(row)))
    east, south = column - left, row - top
    z = raster.z
    heights = ((z[top, left] * (1 - east) + z[top, right] * east) * (1 - south)
               + (z[bottom, left] * (1 - east) + z[bottom, right] * east) * south)
    return np.where(inside, heights, np.nan)


def snap(index):
    """Indices with rounding noise near whole numbers removed."""
    whole = np.round(index)
    with np.errstate(invalid="ignore"):  # inf - inf, for points that have no answer
        return np.where(np.abs(index - whole) < SAME_CELL, whole, index)


def trim(raster):
    """The raster without the outermost rows and columns that have no height at all; unchanged if none has."""
    known = np.isfinite(raster.z)
    if not known.any():
        return raster
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    return raster._replace(z=raster.z[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1],
                           transform=raster.transform * Affine.translation(columns[0], rows[0]))


def summary(path, about):
    """What the user needs to know of the written terrain, and the line for the deck."""
    size, extent, height, origin = (about[key] for key in ("size", "extent", "height", "origin"))
    quoted = f'"{path}"' if " " in str(path) else path
    return (f"{path}: {size['columns']} x {size['rows']} cells of {about['cell']:.6g} m, "
            f"x {extent['xlo']:.3f} to {extent['xhi']:.3f}, y {extent['ylo']:.3f} to {extent['yhi']:.3f}, "
            f"z {height['min']:.3f} to {height['max']:.3f} m, {about['nodata_cells']} NODATA cells, "
            f"0 0 at {origin['east']:.10g} {origin['north']:.10g}\n"
            f"region ground terrain {quoted}")
