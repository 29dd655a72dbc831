"""The columns of a body above a sphere, one per cell of the terrain: see doc/src/slip_analysis.rst.

u is the horizontal distance from the centre against the direction of sliding, v the one across; the base of a sphere is
e = sqrt(R^2 - u^2 - v^2) below the centre, or where the bedrock is.
"""
from typing import NamedTuple, Optional, Sequence, Tuple

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


class Shape(NamedTuple):
    """What an ellipsoid is beside a sphere: see SlipSurface in src/slips."""
    along: float = 1.0      # horizontal semi-axis in the direction of sliding / radius, which is the vertical one
    across: float = 1.0     # the other one / radius
    straight: float = 0.0   # length of a straight part across the direction, m

    def beyond(self, v):
        """Distance across from the straight part, with sign."""
        return v - np.clip(v, -0.5 * self.straight, 0.5 * self.straight)


SPHERE = Shape()


def centres(raster: Raster):
    """x and y of the middles of the cells, (rows, columns) each."""
    rows, columns = np.indices(raster.z.shape)
    return raster.transform * (columns + 0.5, rows + 0.5)


def height_at(x, y, centre: Sequence[float], radius: float, direction: float = 0.0, shape: Shape = SPHERE):
    """Height of the lower half of a surface at places, NaN beside it; direction of sliding in degrees from +x."""
    u, v = turned(x - centre[0], y - centre[1], direction)
    left = radius ** 2 - (u / shape.along) ** 2 - (shape.beyond(v) / shape.across) ** 2
    return centre[2] - np.sqrt(np.where(left > 0, left, np.nan))


def base_of(raster: Raster, centre: Sequence[float], radius: float, direction: float = 0.0,
            shape: Shape = SPHERE) -> np.ndarray:
    """Height of the lower half of a surface under each cell's middle, NaN beside it."""
    x, y = centres(raster)
    return height_at(x, y, centre, radius, direction, shape)


def largest(raster: Raster, base: np.ndarray) -> np.ndarray:
    """The largest connected part of where the ground is above the base, as a mask; SlopeError without any."""
    with np.errstate(invalid="ignore"):
        parts, count = ndimage.label(raster.z > base)
    if not count:
        raise SlopeError("the slip surface", "must be below the ground somewhere")
    return parts == 1 + np.argmax(np.bincount(parts.ravel())[1:])


def above(surface: np.ndarray, rock: Optional[np.ndarray]) -> np.ndarray:
    """Heights of the base of a body: of the surface, or of the bedrock where that is higher; NaN beside the surface."""
    return surface if rock is None else np.where(np.isfinite(surface), np.fmax(surface, rock), np.nan)


def of_surface(ground: Raster, centre: Sequence[float], radius: float, direction: float, density: float,
               inside: Optional[np.ndarray] = None, table: Optional[np.ndarray] = None,
               shape: Shape = SPHERE, rock: Optional[np.ndarray] = None) -> Columns:
    """The columns of the body above a surface; direction of sliding in degrees counterclockwise from +x, density kg/m3.

    inside: mask of the cells of the body (default: its largest connected part); table: heights of the water table,
    NaN where there is no water. It does not change the density. rock: heights of the bedrock, NaN where there is none.
    """
    surface = base_of(ground, centre, radius, direction, shape)
    bottom = above(surface, rock)
    kept = largest(ground, bottom) if inside is None else inside & (ground.z > bottom)
    u, v = from_axis(ground, kept, centre, direction)
    e = centre[2] - surface[kept]
    dip, across = u / (shape.along ** 2 * e), shape.beyond(v) / (shape.across ** 2 * e)
    cut = bottom[kept] > surface[kept]
    if rock is not None:
        dip, across = (np.where(cut, *two) for two in zip(dips(slopes(rock, ground), kept, direction), (dip, across)))
    return balanced(ground, bottom, kept, dip, across, centre, direction, density, table,
                    turns=shape.along == 1.0 and not cut.any())


def of_raster(ground: Raster, bottom: np.ndarray, kept: np.ndarray, centre: Sequence[float], direction: float,
              density: float, table: Optional[np.ndarray] = None) -> Columns:
    """The columns of a body above any surface: the cells `kept`, between the heights `bottom` and the ground.

    The dip of the base is that of the raster. The axis of moments goes through `centre`, across the direction.
    """
    south, east = np.gradient(bottom, abs(ground.transform.a))
    dip, across = dips((south, east), kept, direction)
    return balanced(ground, bottom, kept, dip, across, centre, direction, density, table)


def balanced(ground: Raster, bottom: np.ndarray, kept: np.ndarray, dip: np.ndarray, across: np.ndarray,
             centre: Sequence[float], direction: float, density: float, table: Optional[np.ndarray],
             turns: bool = False) -> Columns:
    """Columns from the tangents of the dip of their base; turns: all normals of the base meet the axis of moments."""
    top, low = ground.z[kept], bottom[kept]
    u, _ = from_axis(ground, kept, centre, direction)
    e = centre[2] - low
    area = np.full(len(u), abs(ground.transform.a * ground.transform.e))
    cosine = 1 / np.sqrt(1 + dip ** 2 + across ** 2)
    sine = dip / np.hypot(1, dip)
    volume = area * (top - low)
    return Columns(area, area / cosine, density * GRAVITY * volume, u, centre[2] - (top + low) / 2,
                   u * sine + e / np.hypot(1, dip), sine, cosine, pressure_of(table, kept, low), float(volume.sum()),
                   None if turns else cosine * (e * dip - u))


def slopes(heights: np.ndarray, raster: Raster) -> Tuple[np.ndarray, np.ndarray]:
    """dz to the south and to the east, between the neighbours of each cell that have a value."""
    found = []
    for axis in (0, 1):
        wide = np.pad(heights, [(1, 1) if one == axis else (0, 0) for one in (0, 1)], constant_values=np.nan)
        before, after = (np.take(wide, np.arange(heights.shape[axis]) + k, axis) for k in (0, 2))
        cells = np.isfinite(before).astype(int) + np.isfinite(after)
        rise = np.where(np.isfinite(after), after, heights) - np.where(np.isfinite(before), before, heights)
        found.append(rise / np.maximum(cells, 1) / abs(raster.transform.a))
    return found[0], found[1]


def dips(gradient: Tuple[np.ndarray, np.ndarray], kept: np.ndarray,
         direction: float) -> Tuple[np.ndarray, np.ndarray]:
    """Tangents of the dip in the direction of sliding and across it, from dz to the south and to the east."""
    south, east = (one[kept] for one in gradient)
    along = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    return -(east * along[0] - south * along[1]), east * along[1] + south * along[0]


def from_axis(ground: Raster, kept: np.ndarray, centre: Sequence[float], direction: float):
    """u and v of the cells of a mask, m."""
    x, y = (one[kept] for one in centres(ground))
    return turned(x - centre[0], y - centre[1], direction)


def turned(dx, dy, direction: float):
    """u, against the direction of sliding, and v, across it, of distances in x and y."""
    along = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    return -(dx * along[0] + dy * along[1]), dy * along[0] - dx * along[1]


def pressure_of(table: Optional[np.ndarray], kept: np.ndarray, low: np.ndarray) -> Optional[np.ndarray]:
    """Pressure of the water at the base of columns, Pa; None without a water table."""
    return None if table is None else WATER * GRAVITY * np.nan_to_num(np.maximum(table[kept] - low, 0.0))
