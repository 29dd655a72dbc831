"""Whether heights can be those of a ground: pits of a NODATA value that no file declares, slopes of heights in feet."""
import math
from typing import Any, Callable, NamedTuple, Optional

import numpy as np

from ..warned import Warned
from .rasters import UNITS, Raster

MARKS = (0.0, -99.0, -999.0, -3276.8)   # m, heights with which programs fill what they do not know
DEEP = 10.0         # m; a pit is deeper than this and than STEEP_SIDES cells, on all sides
STEEP_SIDES = 2.0
STEEPEST = 50.0     # degrees, mean of a terrain; steeper ones may be in feet
BRIGHT, MOST = 240.0, 255.0     # of a picture: its brightest cell is between these
ROWS = 1000         # of a terrain that are looked at for its slope
FOOT = UNITS["ft"]


class Pits(NamedTuple):
    """Groups of cells of one mark that lie far below all cells around them."""
    mark: float             # m
    cells: np.ndarray       # mask
    largest: int            # cells of the largest group
    least: float            # m, depth of the shallowest


def pits(z: np.ndarray, cell: float) -> Optional[Pits]:
    """The pits of the first mark that a terrain has; None if it has none."""
    for mark in MARKS:
        at = z == mark
        if at.any() and (found := pits_of(z, at, mark, max(DEEP, STEEP_SIDES * cell))):
            return found
    return None


def pits_of(z: np.ndarray, at: np.ndarray, mark: float, deep: float) -> Optional[Pits]:
    """The groups of a mask of cells (corners touch) whose neighbours are all more than `deep` (m) higher than mark."""
    from scipy import ndimage
    others = np.where(at | np.isnan(z), np.inf, z)
    lowest = ndimage.minimum_filter(others, 3, mode="nearest")      # of the neighbours
    groups, number = ndimage.label(at, np.ones((3, 3)))
    depth = ndimage.minimum(lowest, groups, np.arange(1, number + 1)) - mark
    is_pit = np.concatenate([[False], (depth > deep) & np.isfinite(depth)])
    if not is_pit.any():
        return None
    sizes = np.bincount(groups.ravel(), minlength=number + 1)
    return Pits(mark, is_pit[groups], int(sizes[is_pit].max()), float(depth[is_pit[1:]].min()))


def remedy(found: Pits) -> str:
    """What can be done about pits."""
    return f"--nodata {found.mark:g} makes them NODATA, with --fill {found.largest} they are filled"


def warn_of_pits(raster: Raster, warn: Callable[[Warned], Any]) -> None:
    """Warn of pits in a terrain."""
    found = pits(raster.z, abs(raster.transform.a))
    if found is None:
        return
    row, column = np.argwhere(found.cells)[0]
    x, y = raster.transform * (column + 0.5, row + 0.5)
    x, y = x + raster.offset[0], y + raster.offset[1]
    warn(Warned("pits", {"cells": int(found.cells.sum()), "mark": found.mark, "depth": found.least, "east": float(x),
                         "north": float(y), "remedy": remedy(found)}))


def warn_of_picture(raster: Raster, warn: Callable[[Warned], Any]) -> None:
    """Warn of values that only a picture of 8 bits has as a rule, such as a hillshade that was converted."""
    known = raster.z[np.isfinite(raster.z)]
    if known.min() >= 0 and BRIGHT <= known.max() <= MOST and not (known % 1).any():
        warn(Warned("picture", {"low": float(known.min()), "high": float(known.max())}))


def mean_slope(raster: Raster) -> float:
    """Of a terrain in metres, degrees, by differences in some of its rows; NaN where there are none."""
    rows = len(raster.z)
    if min(raster.z.shape) < 2:
        return math.nan
    first = np.unique(np.linspace(0, rows - 2, min(ROWS, rows - 1)).astype(int))
    upper, lower = raster.z[first], raster.z[first + 1]
    east = (upper[:, 1:] - upper[:, :-1]) / raster.transform.a
    north = (upper - lower)[:, :-1] / abs(raster.transform.e)
    slopes = np.degrees(np.arctan(np.hypot(east, north)))
    return float(np.nanmean(slopes)) if np.isfinite(slopes).any() else math.nan


def in_feet(slope: float) -> float:
    """The slope (degrees) of a ground whose heights are not metres but feet."""
    return math.degrees(math.atan(math.tan(math.radians(slope)) * FOOT))


def warn_of_slope(raster: Raster, warn: Callable[[Warned], Any]) -> None:
    """Warn of a terrain that is too steep for one in metres."""
    slope = mean_slope(raster)
    if slope > STEEPEST > in_feet(slope):
        warn(Warned("in feet", {"degrees": slope, "in_feet": in_feet(slope)}))
    elif slope > STEEPEST:
        warn(Warned("no ground's slope", {"degrees": slope, "in_feet": in_feet(slope)}))
