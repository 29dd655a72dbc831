"""A raster beside a terrain, of another origin, CRS, unit of height or grid: the one place that brings both together.

A raster with a sidecar or a CRS says where it lies. Without either its coordinates are those of the survey, in the CRS
of the terrain, or the terrain's local metres.
"""
from pathlib import Path
from typing import Any, Callable, NamedTuple, Optional, Tuple, Union

import numpy as np
from affine import Affine
from rasterio.crs import CRS

from ..digits import metres
from ..errors import SlopeError
from ..findings import Finding
from ..geometry import extent, format_numbers
from . import rasters
from .crs import same_crs, transform
from .rasters import Raster, crs_name
from .resampling import sample

ON_GRID = 1e-6      # cells; grids that differ by less are the same


class Local(NamedTuple):
    """What is known of coordinates that no file explains."""
    given: bool = False         # they are in the terrain's local metres
    guessed: bool = False       # they may be: they are where that alone puts the raster on the terrain


def read_raster_beside(path: Union[str, Path], terrain: Raster, heights: bool = True, crs: Optional[CRS] = None,
                       local: Local = Local(), warn: Optional[Callable[[Finding], Any]] = None,
                       remedy: str = "") -> Raster:
    """A raster file, in a CRS if the terrain has one: coordinates are transform @ (column, row) + offset.

    heights: the values are, and become metres; crs: of the raster, whatever it says. warn: called with what is taken
    for granted, remedy: of that, where the raster has no CRS. Raises SlopeError where the file is no raster, has no
    value, or says that its heights are feet while those of the terrain speak for metres.
    """
    stored = rasters.opened(path, heights)
    raster = rasters.placed(path, rasters.in_metres(path, stored, heights, ask=False))
    if not np.isfinite(raster.z).any():
        raise SlopeError(path, "must hold a value, all cells are NODATA")
    bare = rasters.read_sidecar(path) is None
    if local.given and bare:
        raster = raster._replace(crs=terrain.crs, offset=terrain.offset)
    elif crs or raster.crs:
        raster = raster._replace(crs=crs or raster.crs)
    else:
        raster = unexplained(path, raster._replace(crs=terrain.crs), terrain, bare and local.guessed, warn, remedy)
    if heights and stored.unit not in (None, "m"):
        check_unit(path, raster, terrain, stored.unit)
    return raster


def unexplained(path: Union[str, Path], of_survey: Raster, terrain: Raster, guess: bool,
                warn: Optional[Callable[[Finding], Any]], remedy: str) -> Raster:
    """A raster without a CRS in the survey's coordinates, or by a guess in the terrain's local metres, see
    read_raster_beside()."""
    as_local = of_survey._replace(offset=terrain.offset)
    if guess and terrain.offset != (0.0, 0.0) and touches(as_local, terrain):
        if not touches(of_survey, terrain):
            tell(warn, "local raster", path)
            return as_local
        tell(warn, "survey raster", path)
    elif terrain.crs is not None:
        tell(warn, "CRS of terrain", path, remedy=remedy)
    return of_survey


def tell(warn: Optional[Callable[[Finding], Any]], kind: str, path: Union[str, Path], **more: str) -> None:
    """Warn of a file, if anybody listens."""
    if warn:
        warn(Finding(kind, {"file": str(path), **more}))


def in_local(raster: Raster, terrain: Raster) -> Affine:
    """The transform of a raster in the CRS of the terrain to the terrain's local metres."""
    return Affine.translation(*np.subtract(raster.offset, terrain.offset)) @ raster.transform


def box(raster: Raster, terrain: Raster) -> Tuple[float, ...]:
    """xlo, ylo, xhi, yhi of a raster in the CRS of the terrain, in the terrain's local metres."""
    rows, columns = raster.z.shape
    x, y = in_local(raster, terrain) @ (np.array([0, columns, 0, columns]), np.array([0, 0, rows, rows]))
    return x.min(), y.min(), x.max(), y.max()


def touches(raster: Raster, terrain: Raster) -> bool:
    """Whether a raster in the CRS of the terrain has a part in common with it."""
    one, other = box(raster, terrain), extent(terrain)
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def on_cells(path: Union[str, Path], raster: Raster, terrain: Raster) -> np.ndarray:
    """The values of read_raster_beside() at the cells of the terrain: bilinear, exact at the raster's own centres.

    NaN where it has none; raises SlopeError if it has none on the whole terrain.
    """
    rows, columns = terrain.z.shape
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    x, y = Affine.translation(*terrain.offset) @ terrain.transform @ (x, y)
    if raster.crs is not None and terrain.crs is None:
        raise SlopeError(path, f"is in {crs_name(raster.crs)}, and the terrain must have a CRS, too: slope terrain "
                         "--crs", "none")
    same = raster.crs is None or same_crs(raster.crs, terrain.crs)
    if not same:
        x, y = transform(terrain.crs, raster.crs, x, y)
    values = sample(raster._replace(transform=Affine.translation(*raster.offset) @ raster.transform), x, y)
    if np.isfinite(values).any():
        return values
    origins = "" if raster.offset == terrain.offset else (
        f" (origin {format_numbers(raster.offset)}, the terrain's {format_numbers(terrain.offset)})")
    raise SlopeError(path, f"must overlap the terrain, local x y {format_numbers(extent(terrain))}",
                     (format_numbers(box(raster, terrain)) if same else f"coordinates in {crs_name(raster.crs)}") +
                     origins)


def heights_on(path: Union[str, Path], terrain: Raster, local: bool = False,
               warn: Optional[Callable[[Finding], Any]] = None) -> np.ndarray:
    """Heights (m) of a raster file at the cells of a terrain; local: those that no file places are in local metres."""
    return on_cells(path, read_raster_beside(path, terrain, local=Local(local, True), warn=warn), terrain)


def check_unit(path: Union[str, Path], raster: Raster, terrain: Raster, unit: str) -> None:
    """Raise SlopeError if heights that were taken for feet are nearer to the terrain's as metres: the tag is wrong."""
    z = on_cells(path, raster, terrain)
    as_tagged, as_metres = (float(np.nanmedian(np.abs(one - terrain.z))) for one in (z, z / rasters.UNITS[unit]))
    if as_metres < as_tagged:
        raise SlopeError(path, f"heights in {unit} must be confirmed, as in metres they are nearer to the terrain's, "
                         f"{metres(as_metres)} off at the median: slope terrain --z-unit m, ft or us-ft makes a raster "
                         "in metres of it", f"{metres(as_tagged)} off")


def has_cells(raster: Raster, terrain: Raster) -> bool:
    """Whether a raster has all cells of the terrain, and may be others."""
    if not (raster.crs is None or same_crs(raster.crs, terrain.crs)):
        return False
    there = ~terrain.transform @ in_local(raster, terrain)
    left, top = round(there.c), round(there.f)
    rows, columns = np.subtract(raster.z.shape, terrain.z.shape)
    return bool(np.allclose(there[:6], [1, 0, left, 0, 1, top], rtol=0, atol=ON_GRID)
                and 0 <= -left <= columns and 0 <= -top <= rows)
