"""How far beyond the slope's foot blocks come, where a ditch would be.

On the straight way of a block, prolonged as far as the farthest one goes, or to the road, the foot is the place that
lies lowest against a line that falls 1 : 4: above it the ground is steeper on the whole, below it gentler, as the
catchment areas of Pierson et al., Rockfall catchment area design guide, FHWA-OR-RD-02-04 (2001), are.
"""
from typing import NamedTuple, Optional

import numpy as np
from rasterio.features import geometry_mask
from shapely.geometry.base import BaseGeometry

from ..survey.rasters import Raster
from ..survey.resampling import sample

GENTLE = 0.25           # fall over length
STEP = 0.5              # cells, between places of a way
CHUNK = 4_000_000       # places at a time


class Feet(NamedTuple):
    """By block, m: how far beyond the foot it ended, 0 on the slope; from the foot to the road on its way, NaN where
    that does not lead to one."""
    beyond: np.ndarray
    road: np.ndarray


def feet(raster: Raster, start: np.ndarray, end: np.ndarray, down: np.ndarray, road: Optional[BaseGeometry]) -> Feet:
    """Of blocks from start to end (n, 2); down: unit vector, the way of one that stays where it began."""
    way, step = end - start, STEP * float(raster.transform.a)
    length = np.hypot(*way.T)
    unit = np.where(length[:, None] > 0, way / np.maximum(length, 1e-30)[:, None], down)
    along = np.arange(0.0, length.max() + 2 * step, step)
    on_road = np.zeros(raster.z.shape, bool) if road is None else geometry_mask(
        [road], raster.z.shape, raster.transform, all_touched=True, invert=True)
    places = np.empty((2, len(start)))
    each = max(1, CHUNK // len(along))
    for some in (slice(first, first + each) for first in range(0, len(start), each)):
        x, y = (start[some, k, None] + unit[some, k, None] * along for k in (0, 1))
        column, row = np.floor(~raster.transform @ (x, y)).astype(int)
        inside = (row >= 0) & (row < raster.z.shape[0]) & (column >= 0) & (column < raster.z.shape[1])
        on = inside & on_road[np.where(inside, row, 0), np.where(inside, column, 0)]
        there = on.any(axis=1)
        first_on = np.where(there, on.argmax(axis=1), len(along))
        low = sample(raster, x, y) + GENTLE * along
        low[np.isnan(low) | (np.arange(len(along)) >= first_on[:, None])] = np.inf
        foot = along[low.argmin(axis=1)]
        places[0, some] = np.maximum(0.0, length[some] - foot)
        places[1, some] = np.where(there, np.append(along, 0.0)[first_on] - foot, np.nan)
    return Feet(*places)
