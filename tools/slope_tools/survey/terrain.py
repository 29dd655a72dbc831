"""Rasters of several files and formats as one."""
import math

import numpy as np
from affine import Affine

from ..errors import SlopeError
from ..findings import Finding
from . import fggml, japan, rasters
from .crs import require_degrees, same_crs
from .marks import Marks
from .rasters import Raster, crs_name
from .resampling import STRIP, footprint, sample

ON_GRID = 0.01         # cells; grids of two files that differ by less than this are the same grid


def declare(path, crs, tell, warn, assigned=None, unit=None, marks=None):
    """Read a raster, in coordinates of its CRS; one without is taken to be in crs, or warned of if that is None.

    assigned: the CRS of its coordinates, unit: that of its heights, whatever the file says; marks: see
    rasters.read().
    """
    local = rasters.read_asc_local(path, unit=unit, marks=marks)
    if rasters.is_picture(path):
        raise SlopeError(path, "must be heights, not a picture such as a hillshade; if they are heights, "
                         "gdal_translate -ot Float32 stores them as such", "values of 8 bits")
    said = rasters.height_unit(path)
    if unit and said and said != unit:
        tell(f"{path} says heights in {said}: taken as {unit}")
    if (unit or said or "m") != "m":
        tell(f"{path}: heights in {unit or said} brought to metres")
    raster = Raster(local.z, Affine.translation(*local.offset) * local.transform, local.crs)
    if assigned is not None:
        if raster.crs is not None and not same_crs(raster.crs, assigned):
            tell(f"{path} says {crs_name(raster.crs)}: taken as {crs_name(assigned)}")
        raster = raster._replace(crs=assigned)
    rows, columns = raster.z.shape
    corners = [raster.transform * corner for corner in ((0, rows), (columns, 0))]
    require_degrees(raster.crs, [*corners[0], *corners[1]], path)
    if raster.crs is None and crs is not None:
        tell(f"{path} has no CRS: taken as {crs_name(crs)}")
        return raster._replace(crs=crs)
    if raster.crs is None:
        warn(Finding("no CRS", {"file": str(path), "coordinates": "taken as metres; --crs declares one"}))
    return raster


def read_fggml(paths, crs, cell, tell, warn, marks=None):
    """One raster in degrees of all FG-GML tiles in the files, and the wanted CRS and cell, found if they are None.

    marks: of heights that are none, too.
    """
    tiles = []
    for path in paths:
        if not fggml.is_one(path):
            raise SlopeError(path, "must be FG-GML as other inputs are: make a terrain of each kind")
        found = [fggml.without(tile, marks or Marks()) for tile in fggml.read(path)]
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
        number, crs = japan.zone(raster, tiles[0].datum)
        tell(f"CRS {crs_name(crs)}, zone {number} of the plane rectangular system, the site's; --crs names another")
    return raster, crs, cell or japan.nominal_cell(min(footprint(raster, crs)[1]))


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
