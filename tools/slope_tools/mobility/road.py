"""Where a fall path meets a road."""
from typing import NamedTuple

import numpy as np
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from .fall_path import FallPath


class AtRoad(NamedTuple):
    """The first point of a path on a road; of a path that does not meet it, its point nearest to the road."""
    met: bool
    beside: float       # m from that point to the road, 0 where they meet
    length: float       # m, along the path
    fall: float         # m below the crown
    x: float            # local m
    y: float


def at_road(path: FallPath, road: BaseGeometry) -> AtRoad:
    """road: polygons in local metres."""
    line = LineString(np.column_stack([path.x, path.y]))
    for k, (one, other) in enumerate(zip(line.coords[:-1], line.coords[1:])):
        # piece by piece: a path that crosses itself has no other order
        piece = LineString([one, other])
        crossed = piece.intersection(road)
        if not crossed.is_empty:
            return point_on(path, path.length[k] + piece.project(nearest_points(crossed, Point(one))[0]), True, 0.0)
    here, there = nearest_points(line, road)
    return point_on(path, line.project(here), False, here.distance(there))


def point_on(path: FallPath, length: float, met: bool, beside: float) -> AtRoad:
    return AtRoad(met, float(beside), float(length),
                  *(float(np.interp(length, path.length, values)) for values in (path.fall, path.x, path.y)))
