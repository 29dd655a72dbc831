"""The columns of a body: those that find_slip wrote, or of one that failed one per cell of the terrain.

doc/src/slip_analysis.rst has the equations. u is the horizontal distance from the centre against the direction of
sliding, v the one across; the base of a sphere is e = sqrt(R^2 - u^2 - v^2) below the centre, or where the bedrock is.
"""
from pathlib import Path
from typing import Callable, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy import ndimage

from ..errors import SlopeError
from ..heads import GRAVITY
from ..survey.rasters import Raster

WATER = 1000.0          # kg/m3
FEWEST = 50             # cells of a body, below which a factor of safety is rough
LEAST_NORMAL = 1e-6     # lever of the normal force over that of the shear force that is more than rounding
HEAD = "dx_m,dy_m,depth_m,area_m2,slope_x,slope_y,weight_n,weight_depth_m,pressure_pa"     # of PREFIX.N.columns.csv


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
    return raster.transform @ (columns + 0.5, rows + 0.5)


def height_at(x, y, centre: Sequence[float], radius: float, direction: float = 0.0, shape: Shape = SPHERE):
    """Height of the lower half of a surface at places, NaN beside it; direction of sliding in degrees from +x."""
    u, v = turn_distances(x - centre[0], y - centre[1], direction)
    left = radius ** 2 - (u / shape.along) ** 2 - (shape.beyond(v) / shape.across) ** 2
    return centre[2] - np.sqrt(np.where(left > 0, left, np.nan))


def base_of(raster: Raster, centre: Sequence[float], radius: float, direction: float = 0.0,
            shape: Shape = SPHERE) -> np.ndarray:
    """Height of the lower half of a surface under each cell's middle, NaN beside it."""
    x, y = centres(raster)
    return height_at(x, y, centre, radius, direction, shape)


def find_largest_part(raster: Raster, base: np.ndarray) -> np.ndarray:
    """The largest connected part of where the ground is above the base, as a mask; SlopeError without any."""
    with np.errstate(invalid="ignore"):
        parts, count = ndimage.label(raster.z > base)
    if not count:
        raise SlopeError("the slip surface", "must be below the ground somewhere")
    return parts == 1 + np.argmax(np.bincount(parts.ravel())[1:])


def limit_by_rock(surface: np.ndarray, rock: Optional[np.ndarray]) -> np.ndarray:
    """Heights of the base of a body: of the surface, or of the bedrock where that is higher; NaN beside the surface."""
    return surface if rock is None else np.where(np.isfinite(surface), np.fmax(surface, rock), np.nan)


def read_slip_columns(path: Path, direction: float, level: Optional[Callable] = None) -> Columns:
    """Of PREFIX.N.columns.csv, without the volume; direction of sliding in degrees counterclockwise from +x.

    level: the height of another water table over the centre of the surface, of dx and dy.
    """
    try:
        with open(path, encoding="ascii") as lines:
            head = lines.readline().strip()
            rows = np.loadtxt(lines, delimiter=",", ndmin=2)
        if head != HEAD or not len(rows) or not np.isfinite(rows).all() or not (rows[:, 2:4] > 0).all():
            raise ValueError(f"other columns or values than {HEAD}")
    except (OSError, ValueError) as error:
        raise SlopeError(path, f"must be what find_slip wrote ({error})") from None
    dx, dy, e, area, slope_x, slope_y, weight, depth, pressed = rows.T
    if level is not None:
        pressed = pressure(level(dx, dy) + e)
    dip, across = turn_distances(slope_x, slope_y, direction)
    return balanced(area, turn_distances(dx, dy, direction)[0], e, dip, across, weight, depth,
                    pressed if pressed.any() else None)


def of_sphere(ground: Raster, centre: Sequence[float], radius: float, direction: float, density: float,
              table: Optional[np.ndarray] = None, rock: Optional[np.ndarray] = None) -> Columns:
    """The columns of the largest connected part of what is above a sphere; direction as in read_slip_columns(), density
    kg/m3.

    table: heights of the water table, NaN where there is no water. It does not change the density. rock: heights of
    the bedrock, NaN where there is none.
    """
    surface = base_of(ground, centre, radius)
    bottom = limit_by_rock(surface, rock)
    kept = find_largest_part(ground, bottom)
    u, v = from_axis(ground, kept, centre, direction)
    e = centre[2] - surface[kept]
    dip, across = u / e, v / e
    cut = bottom[kept] > surface[kept]
    if rock is not None:
        dip, across = (np.where(cut, *two) for two in zip(dips(slopes(rock, ground), kept, direction), (dip, across)))
    return of_cells(ground, bottom, kept, dip, across, centre, direction, density, table)


def of_raster(ground: Raster, bottom: np.ndarray, kept: np.ndarray, centre: Sequence[float], direction: float,
              density: float, table: Optional[np.ndarray] = None) -> Columns:
    """The columns of a body above any surface: the cells `kept`, between the heights `bottom` and the ground.

    The dip of the base is that between its cells: what the raster has beside the body, the ground or nothing, is no
    base. The axis of moments goes through `centre`, across the direction.
    """
    dip, across = dips(slopes(np.where(kept, bottom, np.nan), ground), kept, direction)
    return of_cells(ground, bottom, kept, dip, across, centre, direction, density, table)


def of_cells(ground: Raster, bottom: np.ndarray, kept: np.ndarray, dip: np.ndarray, across: np.ndarray,
             centre: Sequence[float], direction: float, density: float, table: Optional[np.ndarray]) -> Columns:
    """The cells of a mask as columns, from the tangents of the dip of their base."""
    top, low = ground.z[kept], bottom[kept]
    u, _ = from_axis(ground, kept, centre, direction)
    area = np.full(len(u), abs(ground.transform.a * ground.transform.e))
    volume = area * (top - low)
    return balanced(area, u, centre[2] - low, dip, across, density * GRAVITY * volume, centre[2] - (top + low) / 2,
                    table if table is None else pressure(table[kept] - low))._replace(volume=float(volume.sum()))


def balanced(area: np.ndarray, u: np.ndarray, e: np.ndarray, dip: np.ndarray, across: np.ndarray, weight: np.ndarray,
             depth: np.ndarray, pressed: Optional[np.ndarray]) -> Columns:
    """Columns from their places below the axis of moments, and the tangents of the dip of their base."""
    cosine = 1 / np.sqrt(1 + dip ** 2 + across ** 2)
    sine = dip / np.hypot(1, dip)
    lever = u * sine + e / np.hypot(1, dip)
    normal = cosine * (e * dip - u)
    turns = np.abs(normal).max() <= LEAST_NORMAL * np.abs(lever).max()      # all normals of the base meet the axis
    return Columns(area, area / cosine, weight, u, depth, lever, sine, cosine, pressed,
                   normal=None if turns else normal)


def slopes(heights: np.ndarray, raster: Raster) -> Tuple[np.ndarray, np.ndarray]:
    """dz to the south and to the east, between the neighbours of each cell that have a value.

    A cell without any on an axis has the slope of the nearest that has one, 0 if there is none.
    """
    gradients = []
    for axis in (0, 1):
        wide = np.pad(heights, [(1, 1) if one == axis else (0, 0) for one in (0, 1)], constant_values=np.nan)
        before, after = (np.take(wide, np.arange(heights.shape[axis]) + k, axis) for k in (0, 2))
        cells = np.isfinite(before).astype(int) + np.isfinite(after)
        rise = np.where(np.isfinite(after), after, heights) - np.where(np.isfinite(before), before, heights)
        slope = rise / np.maximum(cells, 1) / abs(raster.transform.a)
        known, alone = (np.isfinite(heights) & one for one in (cells > 0, cells == 0))
        if alone.any() and known.any():
            nearest = ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
            slope = slope[tuple(nearest)]
        gradients.append(slope)
    return gradients[0], gradients[1]


def count_alone(inside: np.ndarray) -> int:
    """The cells of a mask without a neighbour in it on one axis: see slopes()."""
    wide = np.pad(inside, 1)
    south, east = wide[:-2, 1:-1] | wide[2:, 1:-1], wide[1:-1, :-2] | wide[1:-1, 2:]
    return int((inside & ~(south & east)).sum())


def dips(gradient: Tuple[np.ndarray, np.ndarray], kept: np.ndarray,
         direction: float) -> Tuple[np.ndarray, np.ndarray]:
    """Tangents of the dip in the direction of sliding and across it, from dz to the south and to the east."""
    south, east = (one[kept] for one in gradient)
    along = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    return -(east * along[0] - south * along[1]), east * along[1] + south * along[0]


def from_axis(ground: Raster, kept: np.ndarray, centre: Sequence[float], direction: float):
    """u and v of the cells of a mask, m."""
    x, y = (one[kept] for one in centres(ground))
    return turn_distances(x - centre[0], y - centre[1], direction)


def turn_distances(dx, dy, direction: float):
    """u, against the direction of sliding, and v, across it, of distances in x and y."""
    along = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    return -(dx * along[0] + dy * along[1]), dy * along[0] - dx * along[1]


def pressure(below: np.ndarray) -> np.ndarray:
    """Of water at these depths below its table, Pa; 0 where they are NaN."""
    return WATER * GRAVITY * np.nan_to_num(np.maximum(below, 0.0))
