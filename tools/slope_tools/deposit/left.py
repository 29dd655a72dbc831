"""How much of what left the grid did so before it reached a road, or beside it."""
import numpy as np
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry
from shapely.prepared import prep

from ..survey.rasters import Raster


def before_road(volume: float, max_thickness: Raster, released: np.ndarray, road: BaseGeometry) -> float:
    """The part (m3) of a volume that left the grid which did not pass the road first; an estimate.

    Where it left is not recorded: it is divided among the cells of the edge by their largest thickness. A cell lies
    beyond the road (polygons in local metres) if the straight line to it from the middle of the released mass (a mask)
    crosses the road and does not end on it. All of the volume counts where no cell of the edge saw any mass.
    """
    if volume <= 0:
        return 0.0
    edge = np.ones(released.shape, bool)
    edge[1:-1, 1:-1] = False
    rows, columns = np.nonzero(edge & (max_thickness.z > 0))
    if not len(rows) or not released.any():
        return volume
    start = max_thickness.transform * (np.array([np.nonzero(released)[1].mean(), np.nonzero(released)[0].mean()]) + 0.5)
    crossed = prep(road)
    before = []
    for row, column in zip(rows, columns):
        end = max_thickness.transform * (column + 0.5, row + 0.5)
        before.append(crossed.contains(Point(end)) or not crossed.intersects(LineString([start, end])))
    weights = max_thickness.z[rows, columns]
    return float(volume * weights[before].sum() / weights.sum())
