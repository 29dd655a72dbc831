"""What offices ask of a deposit: distances over the height of the slope, and pressures at an edge.

Height and toe are those of the body: from the crown down to where its fall path leaves it.
"""
from typing import List, NamedTuple, Optional

import numpy as np
from rasterio.features import geometry_mask
from shapely.geometry.base import BaseGeometry

from ..deposits.deposit import Deposit
from ..heads import GRAVITY
from ..quantiles import within
from ..survey.rasters import Raster
from . import fall_path, run_length
from .body import Body
from .fall_path import FallPath

SHARES = 0.5, 0.9, 0.99         # of the volume
HEIGHTS, MOST = 2.0, 50.0       # from the toe, in heights, and m at most: Japan's Sediment Disaster Act, steep slopes


class Slope(NamedTuple):
    """Of a body: m below the crown, and along the fall path, at which its toe lies."""
    height: float
    toe: float

    @property
    def zone(self) -> float:
        """m from the toe: HEIGHTS, at most MOST."""
        return min(HEIGHTS * self.height, MOST)


class Edge(NamedTuple):
    """The largest at the outline of a road: m, m/s."""
    depth: float
    speed: float


def slope(mass: Body, path: FallPath) -> Optional[Slope]:
    """None of a body whose toe is not below its crown."""
    beyond = fall_path.from_toe(mass, path)
    return Slope(float(beyond.fall[0]), float(beyond.length[0])) if beyond.fall[0] > 0 else None


def measure_office_distances(deposit: Deposit, path: FallPath) -> List[float]:
    """How far along the path, from the crown, SHARES of the volume on the grid stay, m: cells by their middles."""
    rows, columns = np.nonzero(deposit.raster.z > 0)
    places = np.column_stack(deposit.raster.transform @ np.array([columns + 0.5, rows + 0.5]))
    far, _ = run_length.lengths_of(places, path, deposit)
    return within(far, deposit.raster.z[rows, columns], SHARES).tolist()


def at_edge(road: BaseGeometry, raster: Raster, thickness: np.ndarray, speed: np.ndarray) -> Edge:
    """Of the cells that a road's outline crosses; both of all times, and not of one."""
    on = geometry_mask([road.boundary], thickness.shape, raster.transform, all_touched=True, invert=True)
    return Edge(*(float(np.nan_to_num(values[on]).max(initial=0.0)) for values in (thickness, speed)))


def of_movement(density: float, speed: float) -> float:
    """Pa, rho v^2: of a bulk density (kg/m3) that is stopped by a wall across its way."""
    return density * speed ** 2


def of_deposit(density: float, depth: float) -> float:
    """Pa, rho g h: at the foot of a deposit, as a liquid of its density would press; soil at rest presses less."""
    return density * GRAVITY * depth
