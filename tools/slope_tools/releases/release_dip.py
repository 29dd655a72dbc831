"""The sphere through toe and shoulder that dips least below the foundation, and contains the most of what is above it.

"A spherical surface that contains as much of the old embankment as possible with a minimal dip in the foundation"
(Nakase et al.). Of all spheres through two points the one with the larger sagitta is lower everywhere between them, and
contains more: the wanted one is the largest that dips no more than the smallest does. The dip is that of the section
through toe and shoulder, as beside an embankment its foundation is the ground itself.
"""
from typing import Any, Dict, Mapping, NamedTuple, Optional, Union

import numpy as np
from rasterio.crs import CRS
import scipy
from scipy.ndimage import map_coordinates

from ..digits import rounded
from ..errors import SlopeError
from ..survey import beside
from ..survey.rasters import Raster
from . import release_bodies
from .release_area import Area, FallLine

LEAST = "least"     # --dip
SAMPLES = 4001      # of the section
EXACT = 1e-9        # of the chord: a dip that is so much larger is the same


class Foundation(NamedTuple):
    """What an embankment stands on."""
    name: str                               # level or file, for messages
    z: Union[float, np.ndarray]             # m: a level, or heights on the nodes of the area


def foundation(given: Union[float, str, None], raster: Raster, area: Area, line: FallLine,
               crs: Optional[CRS] = None) -> Foundation:
    """The foundation: a level (m), the path of a raster, or None, the level of the toe; crs: of the raster."""
    if given is None:
        return Foundation(f"the toe's level, {line.toe[2]:.4g} m", float(line.toe[2]))
    if isinstance(given, str):
        row, column = area.corner
        z = beside.on_cells(given, beside.read_raster_beside(given, raster, crs=crs), raster)
        return Foundation(given, z[row:row + area.z.shape[0], column:column + area.z.shape[1]])
    if not given < line.shoulder[2]:
        raise SlopeError("--foundation", f"must be lower than the shoulder, {line.shoulder[2]:.6g} m", f"{given:g}")
    return Foundation(f"the level {given:.6g} m", given)


def find_least_sagitta(area: Area, line: FallLine, below: Foundation) -> float:
    """The sagitta (m) of the sphere that dips least and contains the most."""
    share = np.linspace(0, 1, SAMPLES)
    x, y = (line.toe[:2, None] + (line.shoulder - line.toe)[:2, None] * share)
    heights = np.full(SAMPLES, below.z) if np.isscalar(below.z) else map_coordinates(
        below.z, [(area.y[0] - y) / area.cell, (x - area.x[0]) / area.cell], order=1, mode="nearest")
    if not np.isfinite(heights).all():
        bad = np.flatnonzero(~np.isfinite(heights))[0]
        raise SlopeError(below.name, "must have heights from the toe to the shoulder of the release polygon",
                         f"none at local x y {x[bad]:.1f} {y[bad]:.1f}")

    def dip(sagitta: float) -> float:
        return float((heights - release_bodies.compute_cap_section(line, sagitta, share)).max())

    smallest, largest = release_bodies.STRAIGHT * line.chord, line.chord / 2
    most = max(0.0, dip(smallest)) + EXACT * line.chord
    if dip(largest) <= most:
        return largest
    return float(scipy.optimize.brentq(lambda sagitta: dip(sagitta) - most, smallest, largest, xtol=1e-12 * line.chord))


def dips(area: Area, slip: np.ndarray, below: Foundation) -> Dict[str, Union[str, float]]:
    """What NAME.yaml says of a body: its foundation, how far (m) it dips below that, the volume (m3) there."""
    deep = np.nan_to_num(np.where(slip < area.z, np.minimum(below.z, area.z) - slip, 0.0)).clip(0)
    return {"foundation": below.name, "dip_m": float(deep.max()),
            "below_foundation_m3": float(deep.sum()) * area.cell ** 2}


def describe_dip(choices: Mapping[str, Any]) -> str:
    """The same in words."""
    return (f"\nof the spheres that dip least below {choices['foundation']}, the one with the most above it: dips "
            f"{rounded(choices['dip_m'], 3)} m below it, with {rounded(choices['below_foundation_m3'])} m3")
