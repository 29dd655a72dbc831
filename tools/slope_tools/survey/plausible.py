"""Whether heights can be those of a ground: pits of a NODATA value that no file declares, slopes of heights in feet."""
import math
from typing import Any, Callable, NamedTuple, Optional

import numpy as np
from affine import Affine

from ..errors import SlopeError
from ..findings import Finding
from .grids import UNITS, Raster
from .marks import Marks, format_mark

DEEP = 10.0         # m; a pit is deeper than this and than STEEP_SIDES cells, on all sides
STEEP_SIDES = 2.0
FEW = 100           # cells; fewer do not show what a ground spans
STEEPEST = 50.0     # degrees, mean of a terrain; steeper ones may be in feet
ROWS = 1000         # of a terrain that are looked at for its slope
DEGREE = 111_195.0  # m along a meridian
BRIGHT, MOST = 240.0, 255.0     # of a picture: its brightest cell is between these


class Pits(NamedTuple):
    """Cells of one mark that lie far below all cells around them, or above."""
    mark: float             # m
    stored: str             # what the file has for it
    cells: np.ndarray       # mask
    largest: int            # cells of the largest group
    least: float            # m, depth of the shallowest
    side: str = "below"     # or above

    @property
    def shown(self) -> str:
        """The mark in words."""
        return f"{self.mark:g} m" + f" ({self.stored} in the file)" * (self.stored != f"{self.mark:g}")


def pits(z: np.ndarray, cell: float, marks: Marks) -> Optional[Pits]:
    """The pits of the first mark that a terrain has; None if it has none."""
    deep = max(DEEP, STEEP_SIDES * cell)
    for mark, stored in marks.known.items():
        at = z == mark
        if at.any() and float(stored) <= 0 and (found := pits_of(z, at, mark, stored, deep)):
            return found
        if at.any() and float(stored) > 0 and (found := pits_of(-z, at, -mark, stored, deep)):
            return found._replace(mark=mark, side="above")
    return apart(z, marks, deep)


def apart(z: np.ndarray, marks: Marks, deep: float) -> Optional[Pits]:
    """The cells of the lowest, or the highest, value if it is farther from all others than these span, and than deep.

    No ground has such a gap: a mark that is none of the usual ones, or 9999 in feet.
    """
    known = z[np.isfinite(z)]
    if known.size < FEW or known.max() - known.min() <= deep:
        return None
    for side, last, inner, other in (("below", known.min(), known[known > known.min()].min(), known.max()),
                                     ("above", known.max(), known[known < known.max()].max(), known.min())):
        gap, span = abs(inner - last), abs(other - inner)
        if span > 0 and gap > max(deep, span):
            at = z == last
            mark = float(last)
            return Pits(mark, marks.extremes.get(mark, format_mark(mark)), at, largest_group(at), float(gap), side)
    return None


def largest_group(at: np.ndarray) -> int:
    """Cells of the largest group of a mask; corners touch."""
    from scipy import ndimage
    groups, _ = ndimage.label(at, np.ones((3, 3)))
    return int(np.bincount(groups.ravel())[1:].max())


def pits_of(z: np.ndarray, at: np.ndarray, mark: float, stored: str, deep: float) -> Optional[Pits]:
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
    return Pits(mark, stored, is_pit[groups], int(sizes[is_pit].max()), float(depth[is_pit[1:]].min()))


def suggest_pit_remedy(pits_: Pits, marks: Marks) -> str:
    """What can be done about pits."""
    at_edge = any(side.any() for side in (pits_.cells[[0, -1]], pits_.cells[:, [0, -1]]))
    return f"{marks.options(pits_.stored)} makes them NODATA, " + (
        "which stays where it goes on to the edge" if at_edge else f"with --fill {pits_.largest} they are filled")


def pits_said(raster: Raster, marks: Marks) -> Optional[Finding]:
    """The warning of pits in a terrain, if it has any."""
    pits_ = pits(raster.z, abs(raster.transform.a), marks)
    if pits_ is None:
        return None
    row, column = np.argwhere(pits_.cells)[0]
    x, y = raster.transform @ (column + 0.5, row + 0.5)
    x, y = x + raster.offset[0], y + raster.offset[1]
    return Finding("pits", {"cells": int(pits_.cells.sum()), "mark": pits_.shown, "depth": pits_.least,
                            "side": pits_.side, "east": float(x), "north": float(y),
                            "remedy": suggest_pit_remedy(pits_, marks)})


def warn_of_picture(raster: Raster, warn: Callable[[Finding], Any]) -> None:
    """Warn of values that only a picture of 8 bits has as a rule, such as a hillshade that was converted."""
    known = raster.z[np.isfinite(raster.z)]
    if known.min() >= 0 and BRIGHT <= known.max() <= MOST and not (known % 1).any():
        warn(Finding("picture", {"low": float(known.min()), "high": float(known.max())}))


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
    return math.degrees(math.atan(math.tan(math.radians(slope)) * UNITS["ft"]))


def ask(path, raster: Raster, crs, unit: str) -> None:
    """Raise SlopeError where a plan that is not in feet has heights (of a Raster) that the file says are: many such
    tags are wrong, and a plan in degrees speaks for them no more than one in metres.

    crs: of the plan; None: metres.
    """
    degrees = crs is not None and crs.is_geographic
    if not np.isfinite(raster.z).any() or not degrees and crs is not None and not math.isclose(
            crs.linear_units_factor[1], 1):
        return
    if degrees:
        _, north = raster.transform @ (0, len(raster.z) / 2)
        raster = raster._replace(transform=Affine.scale(DEGREE * math.cos(math.radians(north)), DEGREE)
                                 @ raster.transform)
    feet = raster._replace(z=raster.z * UNITS[unit])
    raise SlopeError(path, f"heights in feet over a plan in {'degrees' if degrees else 'metres'} must be confirmed, as "
                     f"many such tags are wrong: --z-unit m if they are metres, and the ground falls by "
                     f"{mean_slope(raster):.3g} degrees on average, --z-unit ft or us-ft if they are feet, "
                     f"{mean_slope(feet):.3g} degrees (slope terrain, site, route)", unit)


def warn_of_slope(raster: Raster, warn: Callable[[Finding], Any]) -> None:
    """Warn of a terrain that is too steep for one in metres."""
    slope = mean_slope(raster)
    if slope > STEEPEST > in_feet(slope):
        warn(Finding("in feet", {"degrees": slope, "in_feet": in_feet(slope)}))
    elif slope > STEEPEST:
        warn(Finding("no ground's slope", {"degrees": slope, "in_feet": in_feet(slope)}))
