"""Rasters of several files and formats as one."""
import math
from typing import NamedTuple

import numpy as np
from affine import Affine

from ..errors import SlopeError
from ..findings import Finding
from . import fggml, japan, rasters
from .crs import require_degrees, same_crs
from .grids import check_memory, progress
from .marks import Marks
from .rasters import Raster, crs_name
from .resampling import STRIP, footprint, padded, sample

ON_GRID = 0.01         # cells; grids of two files that differ by less than this are the same grid
DIFFER = 5.0           # m, at the median, by which heights of two files may differ where both have them
SAID = 1.0             # m; a larger difference of two heights is said
# where two files meet, see seam():
GAP = 2                # cells without a height that may lie between them
DEEP = 10              # cells of each file that are looked at
PAIRS = 10             # of cells across the seam, at least; as many cells that both have make an overlap of them
CLEAR = 3.0            # times the scatter along the seam, and the steps beside it: a step of the files, not the ground


class Tile(NamedTuple):
    """A raster in coordinates of its CRS, the file that it is of, and its place."""
    name: str
    raster: Raster          # the part that is wanted
    whole: Raster           # without heights


class Placed(NamedTuple):
    """A file's heights on the merged grid, from a row and a column on."""
    name: str
    top: int
    left: int
    z: np.ndarray

    def end(self):
        """The row and column behind its last ones."""
        return self.top + self.z.shape[0], self.left + self.z.shape[1]

    def cut(self, first, last):
        """Those from a first to a last row and column, NaN beyond its own."""
        begin = np.subtract(first, (self.top, self.left))
        end = begin + np.subtract(last, first)
        (above, before), (below, behind) = np.maximum(-begin, 0), np.maximum(end - self.z.shape, 0)
        (top, left), (bottom, right) = np.maximum(begin, 0), np.maximum(end, 0)
        return np.pad(self.z[top:bottom, left:right], ((above, below), (before, behind)), constant_values=np.nan)


def declare(path, crs, tell, warn, assigned=None, unit=None, marks=None, part=None):
    """Read a raster into a Tile, in coordinates of its CRS; one without is taken to be in crs, or warned of if that is
    None.

    assigned: the CRS of its coordinates, unit: that of its heights, whatever the file says; marks: see
    rasters.read_raster(); part: which of its cells are wanted, see there.
    """
    place = []      # of a file that is not read as a whole

    def wanted(whole):
        place.append(whole)
        return part(whole._replace(crs=assigned or whole.crs or crs))
    whole_file = not part or rasters.read_sidecar(path) is not None
    file = rasters.opened(path, True, unit, None if whole_file else wanted, assigned)
    local = rasters.placed(path, rasters.in_metres(path, file, True, unit, marks, assigned))
    if file.is_picture:
        raise SlopeError(path, "must be heights, not a picture such as a hillshade; if they are heights, "
                         "gdal_translate -ot Float32 stores them as such", "values of 8 bits")
    if unit and file.unit and file.unit != unit:
        tell(f"{path} says heights in {file.unit}: taken as {unit}")
    if (unit or file.unit or "m") != "m":
        tell(f"{path}: heights in {unit or file.unit} brought to metres")
    raster = Raster(local.z, Affine.translation(*local.offset) @ local.transform, local.crs)
    if assigned is not None:
        if raster.crs is not None and not same_crs(raster.crs, assigned):
            tell(f"{path} says {crs_name(raster.crs)}: taken as {crs_name(assigned)}")
        raster = raster._replace(crs=assigned)
    whole = raster._replace(z=np.broadcast_to(np.nan, raster.z.shape))
    whole = place[0]._replace(crs=raster.crs) if place else whole
    rows, columns = whole.z.shape
    corners = [whole.transform @ corner for corner in ((0, rows), (columns, 0))]
    require_degrees(raster.crs, [*corners[0], *corners[1]], path)
    if raster.crs is None and crs is not None:
        tell(f"{path} has no CRS: taken as {crs_name(crs)}")
        raster, whole = raster._replace(crs=crs), whole._replace(crs=crs)
    if raster.crs is None:
        warn(Finding("no CRS", {"file": str(path), "coordinates": "taken as metres; --crs declares one"}))
    if part and not place:
        top, bottom, left, right = part(whole)
        raster = raster._replace(z=raster.z[top:bottom, left:right],
                                 transform=raster.transform @ Affine.translation(left, top))
    return Tile(str(path), raster, whole)


def read_fggml(paths, crs, cell, tell, warn, marks=None, differ=DIFFER):
    """One raster in degrees of all FG-GML tiles in the files, and the wanted CRS and cell, found if they are None.

    marks: of heights that are none, too.
    """
    tiles = []
    for path in paths:
        if not fggml.is_one(path):
            raise SlopeError(path, "must be FG-GML as other inputs are: make a terrain of each kind")
        found = [fggml.without(tile, marks or Marks()) for tile in fggml.read_fggml_tiles(path)]
        sizes = {f"{z.shape[1]} x {z.shape[0]} cells" for z in (tile.raster.z for tile in found)}
        tell(f"{path}: FG-GML, {len(found)} tile{'s' * (len(found) > 1)} of {' or '.join(sorted(sizes))}, "
             f"{' and '.join(sorted({tile.datum for tile in found}))}")
        tiles += found
    tiles = fggml.one_datum(tiles, warn)
    groups = fggml.by_resolution(tiles)
    if len(groups) > 1 and cell is None:
        raise SlopeError(groups[1][0].name, f"must have the resolution of {groups[0][0].name}, "
                         f"{seconds(groups[0][0])}, unless a --cell is given", seconds(groups[1][0]))
    merged = [merge([Tile(tile.name, tile.raster, tile.raster) for tile in group], tell, warn, differ=differ).raster
              for group in groups]
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
    (left, top), (right, bottom) = (~fine.transform @ (coarse.transform @ corner)
                                    for corner in ((0, 0), coarse.z.shape[::-1]))
    left, top = (min(0, math.floor(value + ON_GRID)) for value in (left, top))
    right, bottom = max(columns, math.ceil(right - ON_GRID)), max(rows, math.ceil(bottom - ON_GRID))
    check_memory(bottom - top, right - left, "merged raster")
    z = np.full((bottom - top, right - left), np.nan)
    z[-top:rows - top, -left:columns - left] = fine.z
    transform = fine.transform @ Affine.translation(left, top)
    strip = max(1, STRIP // z.shape[1])
    for first in progress(range(0, len(z), strip), "merging"):
        part = z[first:first + strip]
        row, column = np.nonzero(np.isnan(part))
        part[row, column] = sample(coarse, *(transform @ (column + 0.5, row + first + 0.5)))
    return Raster(z, transform, fine.crs)


def merge(tiles, tell, warn, cell=None, differ=DIFFER):
    """One Tile of all, which must share the CRS. In an overlap the first one with a height counts.

    They must share the grid, too, unless a cell is wanted: then all are brought to the grid of the finest one,
    bilinearly. differ: the median difference (m) of two files, or step where they meet, that is an error.
    """
    first = tiles[0]
    if len(tiles) == 1:
        return first
    for tile in tiles:
        if not same_crs(tile.whole.crs, first.whole.crs):
            raise SlopeError(f"{tile.name}: CRS", f"must be that of {first.name}, {crs_name(first.whole.crs)}",
                             crs_name(tile.whole.crs))
    others = [tile for tile in tiles if not on_grid(tile.whole, first.whole)]
    if others and cell is None:
        raise SlopeError(f"{others[0].name}: grid", f"must share the grid of {first.name}, {grid(first.whole)}, unless "
                         f"a --cell is given, to which all are resampled, such as --cell "
                         f"{max(abs(one.whole.transform.a) for one in (first, others[0])):.3g}", grid(others[0].whole))
    base = min(tiles, key=lambda tile: abs(tile.whole.transform.determinant)).whole if others else first.whole
    if others:
        tell(f"{len(others)} of {len(tiles)} rasters resampled to the grid of the finest, {grid(base)}, bilinear")
    whole = make_grid_around(base, [tile.whole for tile in tiles])
    used = [tile for tile in tiles if tile.raster.z.size]
    if not used:
        return Tile(first.name, first.raster, whole)
    merged = make_grid_around(base, [tile.raster for tile in used])
    check_memory(len(merged.z), merged.z.shape[1], "merged raster")
    z, overlaps = np.full(merged.z.shape, np.nan), []
    placed: list[Placed] = []
    seams = []
    beyond = []         # by up to half a cell, of tiles on another grid: they may leave a gap where they meet
    for tile in used:
        top, left, heights, more = on_cells(tile.raster, merged, base)
        beyond += more
        part = z[top:top + heights.shape[0], left:left + heights.shape[1]]
        difference = np.abs(part - heights)
        if np.isfinite(difference).any():
            overlaps.append(differing(tile.name, difference, merged.transform @ Affine.translation(left, top), differ))
        np.copyto(part, heights, where=np.isnan(part))
        here = Placed(tile.name, top, left, heights)
        seams += [seam(before, here, merged.transform, differ) for before in placed]
        placed.append(here)
    for top, left, heights in beyond:
        part = z[top:top + heights.shape[0], left:left + heights.shape[1]]
        np.copyto(part, heights, where=np.isnan(part))
    twice = sum(one["cells"] for one in overlaps)
    most = max(overlaps, key=lambda overlap: overlap["largest"], default={"largest": 0.0})
    tell(f"merged {len(tiles)} rasters; {twice} cells in more than one, the first file counts"
         + (f", heights differ by up to {most['largest']:.3f} m" if twice else ""))
    if most["largest"] > SAID:
        warn(Finding("tiles differ", most))
    clear = [step for step in seams if step]
    if clear:
        warn(Finding("step between tiles", max(clear, key=lambda step: abs(step["median"]))))
    return Tile(first.name, merged._replace(z=z), whole)


def differing(name, difference, transform, differ):
    """How far the heights (m) of a file differ from those before it, and where; SlopeError if that is too much."""
    median = float(np.nanmedian(difference))
    row, column = np.unravel_index(np.nanargmax(difference), difference.shape)
    east, north = transform @ (column + 0.5, row + 0.5)
    difference_ = {"file": name, "largest": float(difference[row, column]), "east": float(east), "north": float(north),
                   "cells": int(np.isfinite(difference).sum()), "median": median}
    if median > differ:
        raise SlopeError(name, f"must have the heights of the files before it, to {differ:g} m at the median of the "
                         "cells of both: are all in one unit and one datum? --differ M accepts M m, as of surveys "
                         "before and after a landslide",
                         "{median:.1f} m in {cells} cells, up to {largest:.1f} m at east {east:.10g}, north "
                         "{north:.10g}".format(**difference_))
    return difference_


def seam(before, here, transform, differ):
    """The step (m) from one Placed to another where they meet, and where; None where none is clear or they overlap,
    SlopeError if it is larger than differ.

    Another datum makes a step that is the same all along the seam, and that the ground beside it does not have. Rough
    ground, a bank, or a cliff on a part of the seam does not.
    """
    top, left = max(before.top, here.top), max(before.left, here.left)
    bottom, right = min(before.end()[0], here.end()[0]), min(before.end()[1], here.end()[1])
    if bottom - top < -GAP or right - left < -GAP:
        return None
    first, last = np.array([top, left]), np.array([bottom, right])
    if (last > first).all() and np.isfinite(before.cut(first, last) + here.cut(first, last)).sum() >= PAIRS:
        return None
    margin = DEEP + GAP     # cells that are looked at from those that face the other file
    first, last = first - margin - GAP - 1, last + margin + GAP + 1
    pairs = across(before.cut(first, last), here.cut(first, last), margin)
    places, steps, beside = (np.concatenate(part) for part in zip(*pairs))
    known = np.isfinite(steps)
    often = np.isfinite(beside).sum(axis=0) >= PAIRS
    if known.sum() < PAIRS or not often.any():
        return None
    median = float(np.median(steps[known]))
    scatter = 1.4826 * np.median(np.abs(steps[known] - median))     # the standard deviation of a normal distribution
    if abs(median) <= max(SAID, CLEAR * scatter, CLEAR * np.abs(np.nanmedian(beside[:, often], axis=0)).max()):
        return None
    row, column = places[known][known.sum() // 2] + first
    east, north = transform @ (column + 0.5, row + 0.5)
    step = {"file": here.name, "other": before.name, "median": median, "pairs": int(known.sum()), "east": float(east),
            "north": float(north)}
    if abs(median) > differ:
        raise SlopeError(here.name, f"must meet {before.name} without a step of more than {differ:g} m at the median: "
                         "are both in one unit and one datum? --differ M accepts M m, as of a cliff that is there",
                         "{median:+.1f} m in {pairs} pairs of cells, as at east {east:.10g}, north {north:.10g}"
                         .format(**step))
    return step


def across(a, b, margin):
    """Of the pairs of a cell of a and one of b that face each other, by directions and gaps: rows and columns, the
    step from a to b, and the steps at places in a and b beside (m).
    """
    known = [np.isfinite(z) for z in (a, b)]
    for down, right in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        def seen(count):
            return (part[margin + count * down:len(part) - margin + count * down,
                         margin + count * right:part.shape[1] - margin + count * right] for part in known)
        in_a, in_b = seen(0)
        facing = in_a & ~in_b
        for count in range(1, GAP + 2):
            in_a, in_b = seen(count)
            cells = np.argwhere(facing & in_b & ~in_a) + margin
            facing &= ~(in_a | in_b)
            lines = [z[tuple(np.moveaxis(cells[:, None] + np.outer(places, (down, right)), -1, 0))]
                     for z, places in ((a, np.arange(1 - DEEP, 1)), (b, np.arange(count, count + DEEP)))]
            ground = [rise(line[:, at:at + 2], line[:, at + count + 1:at + count + 3], count)
                      for line in lines for at in range(DEEP - GAP - 3)]
            yield cells, rise(lines[0][:, -2:], lines[1][:, :2], count), np.transpose(ground)


def rise(before, behind, count):
    """By how much the ground rises more, or less, from a pair of heights to one `count` cells on than in either."""
    slopes = count * np.diff(before)[:, 0], count * np.diff(behind)[:, 0]
    step = behind[:, 0] - before[:, 1]
    return step - np.clip(step, np.minimum(*slopes), np.maximum(*slopes))


def on_grid(raster, base):
    """Whether the cells of a raster are cells of another one's grid."""
    (left, top), (right, bottom) = (~base.transform @ corner for corner in
                                    (raster.transform @ (0, 0), raster.transform @ raster.z.shape[::-1]))
    expected = round(left), round(top), round(left) + raster.z.shape[1], round(top) + raster.z.shape[0]
    return bool(np.abs(np.subtract((left, top, right, bottom), expected)).max() <= ON_GRID)


def box(raster, base):
    """Top, bottom, left, right of a raster in cells of a grid: those whose centres are in it."""
    rows, columns = raster.z.shape
    across, down = np.transpose([~base.transform @ (raster.transform @ corner) for corner in
                                 ((0, 0), (columns, 0), (0, rows), (columns, rows))])
    return tuple(int(math.ceil(edge - 0.5 - ON_GRID)) if low else int(math.floor(edge - 0.5 + ON_GRID)) + 1
                 for edge, low in ((down.min(), True), (down.max(), False), (across.min(), True),
                                   (across.max(), False)))


def make_grid_around(base, parts):
    """A Raster on a grid around others, without heights."""
    boxes = np.array([box(part, base) for part in parts])
    (top, left), (bottom, right) = boxes[:, ::2].min(axis=0), boxes[:, 1::2].max(axis=0)
    return Raster(np.broadcast_to(np.nan, (int(bottom - top), int(right - left))),
                  base.transform @ Affine.translation(int(left), int(top)), base.crs)


def on_cells(raster, merged, base):
    """First row and column of a raster in a grid that is around it, its heights on that; and a list of the same with
    those beyond its edge, by up to half a cell, of one on another grid.
    """
    top, bottom, left, right = box(raster, merged)
    if on_grid(raster, base):
        return top, left, raster.z, []
    rows, columns = merged.z.shape
    first, start = max(0, top - 1), max(0, left - 1)
    heights = np.empty((min(rows, bottom + 1) - first, min(columns, right + 1) - start))
    more = padded(raster)
    strip = max(1, STRIP // max(1, heights.shape[1]))
    for row in range(0, len(heights), strip):
        count = min(strip, len(heights) - row)
        x, y = np.meshgrid(np.arange(heights.shape[1]) + start + 0.5, np.arange(row, row + count) + first + 0.5)
        heights[row:row + count] = sample(more, *(merged.transform @ (x, y)))
    inner = heights[top - first:bottom - first, left - start:right - start]
    return top, left, inner, [(first, start, heights)]


def grid(raster):
    t = raster.transform
    return f"cells of {t.a:.10g} x {-t.e:.10g} from {t.c:.10g} {t.f:.10g}"
