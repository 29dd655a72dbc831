"""The columns of a body above a sphere, one per cell of the terrain: see doc/src/slip_analysis.rst.

u is the horizontal distance from the centre against the direction of sliding, v the one across; the base is
e = sqrt(R^2 - u^2 - v^2) below the centre.
"""
from typing import NamedTuple, Optional, Sequence

import numpy as np
from scipy import ndimage

from ..errors import SlopeError
from ..survey.rasters import Raster

GRAVITY = 9.80665       # m/s2
WATER = 1000.0          # kg/m3
FEWEST = 50             # columns, below which a factor of safety is rough


class Columns(NamedTuple):
    """What the balance of moments needs of each column, arrays of one length; forces per column in N."""
    area: np.ndarray        # in plan, m2
    base: np.ndarray        # area of the base, m2
    weight: np.ndarray
    u: np.ndarray           # m
    depth: np.ndarray       # of the centre of gravity below the axis, m
    lever: np.ndarray       # of the shear force, m
    sine: np.ndarray        # of the dip of the base in the direction of sliding
    cosine: np.ndarray      # of the true dip of the base
    pressure: Optional[np.ndarray] = None    # of water at the base, Pa; None: as a ratio of the weight
    volume: float = 0.0
    normal: Optional[np.ndarray] = None      # lever of the normal force, which drives, m; None: 0, as on a sphere


def centres(raster: Raster):
    """x and y of the middles of the cells, (rows, columns) each."""
    rows, columns = np.indices(raster.z.shape)
    return raster.transform * (columns + 0.5, rows + 0.5)


def base_of(raster: Raster, centre: Sequence[float], radius: float) -> np.ndarray:
    """Height of the lower half of a sphere under each cell's middle, NaN beside it."""
    x, y = centres(raster)
    left = radius ** 2 - (x - centre[0]) ** 2 - (y - centre[1]) ** 2
    return centre[2] - np.sqrt(np.where(left > 0, left, np.nan))


def largest(raster: Raster, base: np.ndarray) -> np.ndarray:
    """The largest connected part of where the ground is above the base, as a mask; SlopeError without any."""
    with np.errstate(invalid="ignore"):
        parts, count = ndimage.label(raster.z > base)
    if not count:
        raise SlopeError("the slip surface", "must be below the ground somewhere")
    return parts == 1 + np.argmax(np.bincount(parts.ravel())[1:])


def of_sphere(ground: Raster, centre: Sequence[float], radius: float, direction: float, density: float,
              inside: Optional[np.ndarray] = None, table: Optional[np.ndarray] = None) -> Columns:
    """The columns of the body above a sphere; direction of sliding in degrees counterclockwise from +x, density kg/m3.

    inside: mask of the cells of the body (default: its largest connected part); table: heights of the water table,
    NaN where there is no water. It does not change the density.
    """
    bottom = base_of(ground, centre, radius)
    kept = largest(ground, bottom) if inside is None else inside & (ground.z > bottom)
    top, low = ground.z[kept], bottom[kept]
    u, v = from_axis(ground, kept, centre, direction)
    e = centre[2] - low
    area = np.full(len(u), abs(ground.transform.a * ground.transform.e))
    cosine = e / radius
    volume = area * (top - low)
    return Columns(area, area / cosine, density * GRAVITY * volume, u, centre[2] - (top + low) / 2,
                   np.sqrt(radius ** 2 - v ** 2), u / np.hypot(u, e), cosine, pressure_of(table, kept, low),
                   float(volume.sum()))


def of_raster(ground: Raster, bottom: np.ndarray, kept: np.ndarray, centre: Sequence[float], direction: float,
              density: float, table: Optional[np.ndarray] = None) -> Columns:
    """The columns of a body above any surface: the cells `kept`, between the heights `bottom` and the ground.

    The dip of the base is that of the raster. The axis of moments goes through `centre`, across the direction.
    """
    top, low = ground.z[kept], bottom[kept]
    south, east = (one[kept] for one in np.gradient(bottom, abs(ground.transform.a)))
    turned = np.radians(direction)
    dip = -(east * np.cos(turned) - south * np.sin(turned))       # tangent, in the direction of sliding
    u, _ = from_axis(ground, kept, centre, direction)
    e = centre[2] - low
    area = np.full(len(u), abs(ground.transform.a * ground.transform.e))
    cosine = 1 / np.sqrt(1 + east ** 2 + south ** 2)
    sine = dip / np.hypot(1, dip)
    volume = area * (top - low)
    return Columns(area, area / cosine, density * GRAVITY * volume, u, centre[2] - (top + low) / 2,
                   u * sine + e / np.hypot(1, dip), sine, cosine, pressure_of(table, kept, low), float(volume.sum()),
                   cosine * (e * dip - u))


def from_axis(ground: Raster, kept: np.ndarray, centre: Sequence[float], direction: float):
    """u and v of the cells of a mask, m."""
    x, y = (one[kept] for one in centres(ground))
    along = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    dx, dy = x - centre[0], y - centre[1]
    return -(dx * along[0] + dy * along[1]), dy * along[0] - dx * along[1]


def pressure_of(table: Optional[np.ndarray], kept: np.ndarray, low: np.ndarray) -> Optional[np.ndarray]:
    """Pressure of the water at the base of columns, Pa; None without a water table."""
    return None if table is None else WATER * GRAVITY * np.nan_to_num(np.maximum(table[kept] - low, 0.0))
