"""How much of what left the grid did so before it reached a road, or beside it."""
import numpy as np
from rasterio.features import geometry_mask
from scipy import ndimage
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry
from shapely.prepared import prep

from ..survey.rasters import Raster
from .flow_path import distances

HOLES = 2       # cells; fast balls leave gaps in where they were seen


def before_road(volume: float, max_thickness: Raster, released: np.ndarray, road: BaseGeometry) -> float:
    """The part (m3) of a volume that left the grid which did not pass the road first; an estimate.

    Where it left is not recorded: it is divided among the cells of the edge by their largest thickness. A cell lies
    beyond the road (polygons in local metres) if the shortest way to it from the released mass (a mask), over the
    ground that the mass touched, crosses the road and does not end on it; where no such way leads to the cell, the
    straight line from the middle of the mass counts. All of the volume counts where no cell of the edge saw any mass.
    """
    if volume <= 0:
        return 0.0
    edge = np.ones(released.shape, bool)
    edge[1:-1, 1:-1] = False
    rows, columns = np.nonzero(edge & (max_thickness.z > 0))
    if not len(rows) or not released.any():
        return volume
    touched = ndimage.binary_dilation(released | (max_thickness.z > 0), np.ones((3, 3), bool), HOLES)
    free = touched & geometry_mask([road], touched.shape, max_thickness.transform, all_touched=True)
    if not (released & free).any():     # the road passes below all of the mass
        return volume
    ways, around = (distances(cells, released & cells, 1.0)[rows, columns] for cells in (touched, free))
    start = max_thickness.transform * (np.array([np.nonzero(released)[1].mean(), np.nonzero(released)[0].mean()]) + 0.5)
    crossed = prep(road)
    before = []
    for row, column, way, other in zip(rows, columns, ways, around):
        end = max_thickness.transform * (column + 0.5, row + 0.5)
        crosses = other > way + 1e-6 if np.isfinite(way) else crossed.intersects(LineString([start, end]))
        before.append(crossed.contains(Point(end)) or not crosses)
    weights = max_thickness.z[rows, columns]
    return float(volume * weights[before].sum() / weights.sum())
