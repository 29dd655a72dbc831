"""Rasters on another grid: other CRS, other cell, other bounds, heights between the nodes."""
import math

import numpy as np
import rasterio
import rasterio.warp
from affine import Affine

from ..errors import SlopeError
from ..findings import Finding
from ..geometry import format_numbers
from .crs import not_covered, same_crs, transform
from .grids import check_memory, progress
from .rasters import Raster, crs_name

SAME_CELL = 1e-6       # relative; a smaller difference of cell sizes is noise of the header's digits
FINEST = 100           # a wanted cell may be this many times smaller than the input's
STRIP = 250_000        # points resampled at a time


def regrid(raster, crs, cell, bounds, tell, warn, whole=None):
    """The raster in crs, on square cells, inside bounds: the input's own cells where that suffices, else resampled.

    whole: the input, of which the raster has the cells that this needs, see needed().
    cell and bounds may be None: then the input's, or in a new CRS its cell at the middle of the raster to three digits.
    """
    moved = not same_crs(raster.crs, crs)
    whole = whole or raster
    extent, native = footprint(whole, crs)
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
            raise SlopeError("--bounds", f"must overlap the input, {format_numbers(extent)}", format_numbers(bounds))
        if not np.allclose(wanted, bounds, rtol=0, atol=cell * SAME_CELL):
            warn(Finding("cut to input", {"extent": format_numbers(extent)}))

    if not np.isfinite(raster.z).any():
        raise SlopeError("--bounds", "must hold a height, all cells are NODATA")
    t = raster.transform
    square = t.b == t.d == 0 and t.a > 0 and abs(t.a + t.e) <= SAME_CELL * t.a
    if square and not moved and abs(cell - t.a) <= SAME_CELL * t.a:
        out, done = raster, None
        if bounds:
            out = crop(raster, wanted)
            done = (f"cropped to {out.z.shape[1]} x {out.z.shape[0]} of {whole.z.shape[1]} x {whole.z.shape[0]} "
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


def needed(whole, crs, cell, bounds, more):
    """Top, bottom, left, right of the cells of a raster that regrid() needs, and `more` cells around them."""
    rows, columns = whole.z.shape
    extent, native = footprint(whole, crs)
    side = max(cell or 0.0, *native)
    west, south = np.maximum(bounds[:2], extent[:2]) - side
    east, north = np.minimum(bounds[2:], extent[2:]) + side
    if west >= east or south >= north:
        return 0, 0, 0, 0
    if not same_crs(whole.crs, crs):
        west, south, east, north = rasterio.warp.transform_bounds(crs, whole.crs, west, south, east, north)
        if not np.isfinite([west, south, east, north]).all():
            raise not_covered(whole.crs, crs)
    across, down = ~whole.transform @ (np.array([west, east, west, east]), np.array([south, south, north, north]))
    top, bottom, left, right = (int(np.clip(edge, 0, limit)) for edge, limit in (
        (math.floor(down.min()) - more, rows), (math.ceil(down.max()) + more, rows),
        (math.floor(across.min()) - more, columns), (math.ceil(across.max()) + more, columns)))
    return top, bottom, left, right


def check_size(rows, columns):
    if min(rows, columns) < 2:
        raise SlopeError("output", "must have at least 2 x 2 cells", f"{columns} x {rows}")


def footprint(raster, crs):
    """(W, S, E, N) of a raster in crs, and the width and height of its middle cell there (m)."""
    rows, columns = raster.z.shape
    x, y = raster.transform @ (np.array([0, columns, 0, columns]), np.array([0, 0, rows, rows]))
    extent = x.min(), y.min(), x.max(), y.max()
    x, y = raster.transform @ (columns / 2 + np.array([0, 1, 0]), rows / 2 + np.array([0, 0, 1]))
    if not same_crs(raster.crs, crs):
        x, y = transform(raster.crs, crs, x, y)
        extent = rasterio.warp.transform_bounds(raster.crs, crs, *extent)
        if not np.isfinite([*extent, *x, *y]).all():
            raise not_covered(raster.crs, crs)
    return tuple(map(float, extent)), tuple(float(math.hypot(x[i] - x[0], y[i] - y[0])) for i in (1, 2))


def crop(raster, bounds):
    """The cells of a north-up raster that the bounds (which overlap it) touch."""
    (left, bottom), (right, top) = (~raster.transform @ corner for corner in (bounds[:2], bounds[2:]))
    left, top = (max(0, math.floor(value + SAME_CELL)) for value in (left, top))
    right, bottom = (math.ceil(value - SAME_CELL) for value in (right, bottom))
    return raster._replace(z=raster.z[top:bottom, left:right],
                           transform=raster.transform @ Affine.translation(left, top))


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
    check_memory(rows, columns, "output")
    out_transform = Affine(cell, 0, west, 0, -cell, south + rows * cell)
    fine = out_transform @ Affine.scale(1 / points)
    moved = not same_crs(raster.crs, crs)
    z = np.empty((rows, columns))
    strip = max(1, STRIP // (columns * points * points))
    for first in progress(range(0, rows, strip), "resampling"):
        count = min(strip, rows - first)
        x, y = fine @ np.meshgrid(np.arange(columns * points) + 0.5,
                                  np.arange(first * points, (first + count) * points) + 0.5)
        if moved:
            x, y = transform(crs, raster.crs, x, y)
        z[first:first + count] = sample(raster, x, y).reshape(count, points, columns, points).mean(axis=(1, 3))
    return Raster(z, out_transform, crs)


def sample(raster, x, y):
    """Heights at points x, y (arrays, the raster's CRS), bilinear between cell centres; NaN outside of these."""
    rows, columns = raster.z.shape
    column, row = (snap(index - 0.5) for index in ~raster.transform @ (x, y))
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


def padded(raster):
    """The raster with one more cell on each side, linear beyond its outermost centres, of which half may count."""
    if min(raster.z.shape) < 2:
        return raster
    return raster._replace(z=np.pad(raster.z, 1, mode="reflect", reflect_type="odd"),
                           transform=raster.transform @ Affine.translation(-1, -1))


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
                           transform=raster.transform @ Affine.translation(columns[0], rows[0]))
