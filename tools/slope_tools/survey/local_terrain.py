"""Survey rasters to one terrain in local metres.

Order of the work: read, merge, fill holes, crop or resample, move to the local origin, write.
"""
import math
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from affine import Affine
from rasterio.crs import CRS

from ..errors import SlopeError
from ..findings import Finding
from ..geometry import format_numbers
from . import fggml, plausible, rasters, xyz, zips
from .crs import as_crs, require_axes, require_metres, require_order, warn_of_north, warn_of_stretch
from .marks import Marks, format_mark
from .rasters import Raster
from .resampling import needed, regrid
from .terrain import DIFFER, Tile, declare, merge, read_fggml


class Wanted(NamedTuple):
    """How the terrain shall be; None: as it is in the files."""
    crs: Optional[str] = None           # such as EPSG:6677
    origin: Optional[Tuple[float, float]] = None    # E N of local 0 0; None: the lower left corner, whole metres
    cell: Optional[float] = None        # m
    bounds: Optional[Sequence[float]] = None        # W S E N, m
    fill: int = 0                       # holes of at most this many cells are filled
    assigned: Optional[str] = None      # CRS that the files are in, whatever they say
    own: Mapping[str, str] = {}         # the same of single files, by their paths
    z_unit: Optional[str] = None        # of the heights in the files, of rasters.UNITS, whatever they say
    nodata: Sequence[float] = ()        # values of the files that stand for none, beside the declared one
    pits: bool = True                   # are warned of; else refused
    differ: Optional[float] = None      # m, at the median, by which the heights of two files may differ


def checked_crs(wanted: Wanted) -> Tuple[Optional[CRS], Optional[CRS]]:
    """The wanted CRS and that of the files, None if not given; SlopeError, which names the option, if one is wrong."""
    if wanted.cell is not None and wanted.cell <= 0:
        raise SlopeError("--cell", "must be > 0", f"{wanted.cell:g}")
    if wanted.differ is not None and wanted.differ <= 0:
        raise SlopeError("--differ", "must be > 0", f"{wanted.differ:g}")
    if wanted.fill < 0:
        raise SlopeError("--fill", "must be >= 0", wanted.fill)
    if wanted.bounds and not (wanted.bounds[0] < wanted.bounds[2] and wanted.bounds[1] < wanted.bounds[3]):
        raise SlopeError("--bounds", "W S E N must have W < E and S < N", format_numbers(wanted.bounds))
    crs = assigned = None
    if wanted.crs:
        crs = as_crs("--crs", wanted.crs)
        require_metres(crs, "--crs")
        require_axes(crs, "--crs")
    if wanted.assigned:
        assigned = as_crs("--assign-crs", wanted.assigned)
    return crs, assigned


def own_crs(path: str, wanted: Wanted, assigned: Optional[CRS]) -> Optional[CRS]:
    """The CRS that is assigned to a file, to it alone or to all."""
    return as_crs(f"--assign-crs {path}", wanted.own[path]) if path in wanted.own else assigned


def make_local_terrain(inputs: Sequence[str], output: Path, wanted: Wanted, tell: Callable[[str], Any],
                       warn: Callable[[Finding], Any]) -> Dict[str, Any]:
    """Write the terrain of survey files to output (.asc, with its sidecar); returns the sidecar, and surveyed_cell: the
    size (m) of the largest cells of the files, about; 0 for FG-GML.

    tell is called with a line for each thing that was done, warn with warnings. Raises SlopeError on bad input.
    """
    crs, assigned = checked_crs(wanted)
    steps: List[str] = []

    def keep(step: str) -> None:
        steps.append(step)
        tell(step)

    surveyed = 0.0
    cell, marks, differ = wanted.cell, Marks(wanted.nodata), wanted.differ or DIFFER
    files = [(path, name) for path in inputs for name in zips.rasters_in(path) or [path]]
    if any(fggml.is_one(name) for _, name in files):
        for option, value in (("--assign-crs", wanted.assigned or "".join(wanted.own.values()) or None),
                              ("--z-unit", wanted.z_unit)):
            if value is not None:
                raise SlopeError(option, "must not be given for FG-GML, which has its CRS and heights in metres", value)
        raster, crs, cell = read_fggml(inputs, crs, cell, keep, warn, marks, differ)
        tile, listed = Tile(inputs[0], raster, raster), False
    else:
        def part(whole: Raster) -> Tuple[int, int, int, int]:
            return needed(whole, crs or whole.crs, wanted.cell, wanted.bounds, wanted.fill + 2)
        tiles = [declare(name, crs, keep, warn, own_crs(path, wanted, assigned), wanted.z_unit, marks,
                         part if wanted.bounds else None) for path, name in files]
        surveyed = max(surveyed_cell(tile.whole) for tile in tiles)
        listed = any(xyz.form_of(rasters.only(name)) for _, name in files)
        tile = merge(tiles, keep, warn, wanted.cell, differ)
        crs = crs or tile.whole.crs
    raster = tile.raster
    require_metres(crs, inputs[0])
    require_axes(crs, inputs[0])
    if listed:      # rasters say which way their axes go
        require_order(tile.whole, inputs[0])
    if not np.isfinite(raster.z).any():
        if wanted.bounds:
            regrid(raster, crs, cell, wanted.bounds, keep, warn, tile.whole)        # says what is wrong with them
        raise SlopeError(", ".join(inputs), "must have a height, all cells are NODATA")
    for absent in marks.not_found:
        warn(Finding("no such cell", {"value": format_mark(absent), "low": float(np.nanmin(raster.z)),
                                      "high": float(np.nanmax(raster.z))}))
    check_pits(raster, marks, ", ".join(inputs), wanted.pits, warn)
    plausible.warn_of_picture(raster, warn)
    filled = 0
    if wanted.fill:
        holes, count = small_holes(np.isnan(raster.z), wanted.fill)
        filled = int(holes.sum())
        raster = raster._replace(z=fill(raster.z, holes))
        keep(f"filled {count} NODATA holes of at most {wanted.fill} cells, {filled} cells")
    raster = regrid(raster, crs, cell, wanted.bounds, keep, warn, tile.whole)
    if crs is not None:
        warn_of_stretch(raster, warn)
        warn_of_north(raster, warn)
    if wanted.z_unit is None:
        plausible.warn_of_slope(raster, warn)
    z = np.round(raster.z, 3) + 0.0  # as they are written; + 0.0 because of -0.0
    origin = wanted.origin
    if origin is None:
        east, north = raster.transform @ (0, len(z))
        origin = math.floor(east + 1e-6), math.floor(north + 1e-6)  # 1e-6: rounding noise
    local = Raster(z, Affine.translation(-origin[0], -origin[1]) @ raster.transform, crs, origin)
    about = rasters.write_asc_local(output, local, {"filled_cells": filled, "sources": list(inputs), "steps": steps})
    return {**about, "surveyed_cell": surveyed}


def surveyed_cell(raster: Raster) -> float:
    """The size (m) of the cells of a raster in its CRS, about."""
    crs = raster.crs
    unit = 1.0 if crs is None else plausible.DEGREE if crs.is_geographic else crs.linear_units_factor[1]
    return abs(raster.transform.e) * unit


def check_pits(raster: Raster, marks: Marks, where: str, allowed: bool, warn: Callable[[Finding], Any]) -> None:
    """Warn of pits that a mark of NODATA makes; SlopeError if they are not allowed."""
    said = plausible.pits_said(raster, marks)
    if said is None:
        return
    if not allowed:
        raise SlopeError(where, f"the ground must have no pits of a NODATA value: {said}")
    warn(said)


def describe_terrain(name: object, sidecar: Dict[str, Any]) -> str:
    """What the user needs to know of a terrain."""
    size, extent, height, origin = (sidecar[key] for key in ("size", "extent", "height", "origin"))
    return (f"{name}: {size['columns']} x {size['rows']} cells of {sidecar['cell']:.6g} m, "
            f"x {extent['xlo']:.3f} to {extent['xhi']:.3f}, y {extent['ylo']:.3f} to {extent['yhi']:.3f}, "
            f"z {height['min']:.3f} to {height['max']:.3f} m, {sidecar['nodata_cells']} NODATA cells, "
            f"local origin at east {origin['east']:.10g}, north {origin['north']:.10g}")


# --- holes of NODATA ---

def small_holes(empty: np.ndarray, most: int) -> Tuple[np.ndarray, int]:
    """Mask and number of the holes in a boolean array: groups of at most `most` True cells, none of them at the edge.

    Cells that touch, corners included, are one group.
    """
    from scipy import ndimage
    groups, number = ndimage.label(empty, np.ones((3, 3)))
    hole = np.bincount(groups.ravel(), minlength=number + 1) <= most
    hole[0] = False         # no group
    for side in (groups[0], groups[-1], groups[:, 0], groups[:, -1]):
        hole[side] = False
    return hole[groups], int(hole.sum())


def fill(z: np.ndarray, holes: np.ndarray) -> np.ndarray:
    """Heights with the holes (a mask, none of it at the edge) filled: each cell is the mean of its four neighbours.

    That is the membrane on the rim; it fills a hole in a plane exactly. GDAL's fillnodata leaves a step: on a slope of
    0.76 and cells of 5 m, 1.4 m at a single cell. All holes are one sparse linear system.
    """
    row, column = np.nonzero(holes)
    if not len(row):
        return z
    from scipy import sparse
    from scipy.sparse.linalg import spsolve
    near_row, near_column = row[:, None] + [-1, 1, 0, 0], column[:, None] + [0, 0, -1, 1]
    number = np.full(z.shape, -1)       # of an unknown; -1 for a known height
    number[row, column] = np.arange(len(row))
    near = number[near_row, near_column]
    rim = np.where(near < 0, z[near_row, near_column], 0).sum(axis=1)
    cell, side = np.nonzero(near >= 0)
    matrix = sparse.diags(np.full(len(row), 4.0)) - sparse.coo_matrix(
        (np.ones(len(cell)), (cell, near[cell, side])), shape=(len(row), len(row)))
    middle = np.nanmean(z)      # heights against it, so that digits of a high mountain are not lost
    filled = z.copy()
    filled[row, column] = middle + spsolve(matrix.tocsc(), rim - middle * (near < 0).sum(axis=1))
    return filled
