"""Where a slip surface comes out of the ground: on the slope, as it should, beyond the toe, under a road, or inside."""
import math
from typing import NamedTuple, Optional

import numpy as np
from affine import Affine
from rasterio.features import geometry_mask
from scipy.ndimage import binary_erosion

from .. import geometry
from ..findings import Finding
from ..survey.rasters import Raster
from .release_area import Area

FOOT = 0.2      # of the body's fall: its lowest part
LEVEL = 0.25    # of the mean slope of its ground: flatter ground is level
SOME = 0.02     # of its area; less level ground at its foot is none, nor less ground below the slip surface
CLEAR = 0.05    # of the largest depth: a slip surface that lies less above the ground does not count
ROUNDING = 1e-9         # of a cell, that geometry.coverage leaves of a polygon elsewhere
WHOLLY = 0.99   # of a road's area on the body: all of it


class Level(NamedTuple):
    """A part of a body that does not lie on a slope."""
    area: float         # m2
    depth: float        # m, largest, of the slip surface below it


def depth_of(area: Area, slip: np.ndarray) -> np.ndarray:
    """The depth (m) of a slip surface, 0 beside the body."""
    return np.nan_to_num(area.z - slip)


def beyond_toe(area: Area, slip: np.ndarray) -> Optional[Level]:
    """The level ground at the foot of a body, None where there is next to none."""
    depth = depth_of(area, slip)
    body = depth > 0
    down, across = np.gradient(area.z, area.cell)
    slope = np.hypot(down, across)
    low, high = area.z[body].min(), area.z[body].max()
    with np.errstate(invalid="ignore"):
        level = body & (area.z < low + FOOT * (high - low)) & (slope < LEVEL * np.nanmean(slope[body]))
    if level.sum() <= SOME * body.sum():
        return None
    return Level(float(level.sum()) * area.cell ** 2, float(depth[level].max()))


class OnBody(NamedTuple):
    """What of a road lies on a body, and goes with it."""
    area: float         # m2
    wholly: bool        # all of the road does

    @property
    def part(self) -> str:
        """Which part of the road, in words."""
        return "the road" if self.wholly else "a part of the road"

    def finding(self, file: str) -> Finding:
        return Finding("road on body", {"file": file, "part": self.part, "Part": self.part.capitalize()})


def on_body(body: np.ndarray, raster: Raster, road, rim: int) -> Optional[OnBody]:
    """The OnBody of a road (polygons in local metres); None where it meets the rim only, so many cells wide.

    body: mask of the cells of the raster, whose values do not count.
    """
    inside = road.intersection(geometry.box_of(raster))
    share = sum(geometry.shares_of_cells(part, raster) for part in geometry.polygons_of(inside))
    if not (share * binary_erosion(body, iterations=rim) > ROUNDING).any():
        return None
    area = float((share * body).sum() * raster.transform.a ** 2)
    return OnBody(area, area >= WHOLLY * road.area)


def rim(ball: float, cell: float) -> int:
    """How many cells (m) the rim of a body of balls is wide, each of which stands for so much ground (m3)."""
    return 1 + math.ceil(ball ** (1 / 3) / cell / 2)


def above_ground(z: np.ndarray, slip: np.ndarray, inside: np.ndarray, cell: float) -> Optional[Level]:
    """Where a slip surface lies above the ground z (m) inside a polygon, None where it hardly does; depth: how high.

    Ground that is lower than the whole body does not count: there the slip surface has come out, as it should.
    """
    with np.errstate(invalid="ignore"):
        depth = np.where(inside, z - slip, 0.0)
        body = depth > 0
        if not body.any():
            return None
        above = (depth < -CLEAR * depth[body].max()) & (z > z[body].min())
    if above.sum() <= SOME * body.sum():
        return None
    return Level(float(above.sum()) * cell ** 2, float(-depth[above].min()))


def under(area: Area, slip: np.ndarray, road) -> Optional[Level]:
    """What of a road (a polygon in local metres) lies on a body, None where nothing does."""
    step = area.y[1] - area.y[0]
    nodes = Affine(area.cell, 0, area.x[0] - area.cell / 2, 0, step, area.y[0] - step / 2)
    depth = np.where(geometry_mask([road], area.z.shape, nodes, invert=True), depth_of(area, slip), 0.0)
    on = depth > 0
    return Level(float(on.sum()) * area.cell ** 2, float(depth.max())) if on.any() else None
