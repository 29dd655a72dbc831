"""What fix deposit/grid wrote, read back, and what the commands that evaluate it share.

Plan geometry on its grid is done in index coordinates: x in columns from the west edge, y in rows from the north edge.
There a cell is the unit square between whole numbers, and areas are in cells.
"""
import math
import os
from pathlib import Path
from typing import NamedTuple, Optional

import numpy as np

from ..case import run_folders
from ..errors import SlopeError
from ..findings import Finding
from ..geometry import extent, format_numbers
from ..survey import rasters
from ..survey.rasters import Raster

SAME_BALANCE = 1e-6    # relative; volume of the raster and in the summary
SAME_HEIGHT = 1e-7     # of the largest height; two rasters of nine digits
EIGHT = np.ones((3, 3), int)    # neighbours of a cell, for ndimage.label


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


class Top(NamedTuple):
    """The highest released point, local metres; z is NaN where the ground below it is not known."""
    x: float
    y: float
    z: float
    source: str                 # where it is known from, for people


def read_deposit(prefix, terrain, warn):
    """The Deposit that a run wrote to PREFIX, in the CRS of terrain (None: terrain.asc in the same folder, if any).

    warn is called with a Finding for each thing that makes the numbers doubtful.
    """
    names = [f"{prefix}.{kind}" for kind in ("thickness.asc", "surface.asc", "summary.yaml")]
    for name in names:
        if not Path(name).is_file():
            raise SlopeError(name, f"must be an existing file; {prefix} must be the output of fix deposit/grid")
    summary = run_folders.load_summary(names[2], run_folders.OF_DEPOSIT)
    thickness, surface = (rasters.read_raster(name, heights=False) for name in names[:2])
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
    reported = summary["volume"]["on_grid"]
    if abs(deposit.volume - reported) > SAME_BALANCE * max(reported, 1e-30):
        raise SlopeError(names[0], f"must hold the volume of {names[2]}, {reported:.10g} m3: are they of one run?",
                         f"{deposit.volume:.10g} m3")
    if summary["moving"]:
        warn(Finding("moves", {"file": names[2], "seconds": summary["time"]}))
    lost = summary["volume"]["off_grid"] + summary["volume"]["lost"]
    if lost > SAME_BALANCE * deposit.volume:
        warn(Finding("not counted", {"file": names[2], "volume": lost}))
    return deposit


def read_base(prefix, thickness, surface):
    """The ground without the body (m): PREFIX.base.asc; of an older run, which wrote none, surface - thickness."""
    name = f"{prefix}.base.asc"
    difference = surface.z - thickness.z
    if not Path(name).is_file():
        return difference
    base = rasters.read_raster(name, heights=False)
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


def find_terrain(prefix, terrain, raster, warn):
    """The file that tells where the run's grid lies and its Place; a warning and None, None without one."""
    path = terrain or Path(prefix).with_name("terrain.asc")
    if terrain is None and not path.is_file():
        warn(Finding("no terrain", {"file": str(path)}))
        return None, None
    place = rasters.read_place(path)
    grid, slack = extent(raster), 1e-6 * raster.transform.a
    # fix deposit/grid covers its extent with whole cells from the south-west corner on: the last ones, in the east and
    # in the north, may reach beyond the terrain
    slack = np.array([slack, slack, raster.transform.a, raster.transform.a])
    outside = np.subtract(place.extent, grid) * [1, 1, -1, -1] > slack
    if outside.any():
        raise SlopeError(path, f"must be the terrain of the run, whose grid is {format_numbers(grid)}; --terrain "
                         "names " "another", format_numbers(place.extent))
    own = Path(prefix).with_name("terrain.asc")
    if own.is_file() and not os.path.samefile(own, path):
        there = rasters.read_place(own)
        if (there.crs, there.offset) not in ((None, (0, 0)), (place.crs, place.offset)):
            raise SlopeError(path, f"must lie where the run's terrain.asc does, {there.crs}, origin "
                             f"{format_numbers(there.offset)}; --terrain names another",
                             f"{place.crs}, {format_numbers(place.offset)}")
    if place.crs is None:
        warn(Finding("no CRS", {"file": str(path), "coordinates": "metres as in that file" if place.offset != (0, 0)
                                else "the local metres of the run"}))
    return str(path), place


def top(deposit):
    """The Top of a deposit.Deposit: where its highest ball was released, from its summary.

    A summary of an older run does not tell it. Then it is the centre of the highest cell that the mass was ever in, or,
    without PREFIX.max_thickness.asc, of the deposit, which is lower on the slope.
    """
    top = (deposit.summary.get("travel") or {}).get("top")
    if isinstance(top, list) and len(top) == 3 and all(isinstance(v, (int, float)) for v in top):
        return Top(float(top[0]), float(top[1]), float(top[2]), "summary: highest released ball")
    name = f"{deposit.prefix}.max_thickness.asc"
    source, thickness = "highest cell of the deposit", deposit.raster.z
    if Path(name).is_file():
        largest = rasters.read_raster(name, heights=False)
        if largest.z.shape == thickness.shape and largest.transform == deposit.raster.transform:
            source, thickness = "highest cell that the mass was in", largest.z
    surface = np.where((thickness > 0) & np.isfinite(deposit.base), deposit.base + thickness, -np.inf)
    row, column = np.unravel_index(surface.argmax(), surface.shape)
    x, y = deposit.raster.transform @ (column + 0.5, row + 0.5)
    z = float(surface[row, column])
    return Top(float(x), float(y), z if math.isfinite(z) else math.nan, source)
