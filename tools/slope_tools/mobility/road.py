"""Where a fall path meets a road."""
from typing import NamedTuple, Optional

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
    passed: float       # m, where the path leaves the road after it; length where it does not meet it
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
            length = path.length[k] + piece.project(nearest_points(crossed, Point(one))[0])
            return point_on(path, length, True, 0.0, far_edge(path, line, k, road))
    here, there = nearest_points(line, road)
    return point_on(path, line.project(here), False, here.distance(there))


def far_edge(path: FallPath, line: LineString, k: int, road: BaseGeometry) -> float:
    """Length (m) at which a path leaves the road that it meets in its piece k."""
    length = path.length[k]
    for one, other, start in zip(line.coords[k:-1], line.coords[k + 1:], path.length[k:]):
        piece = LineString([one, other])
        crossed = piece.intersection(road)
        if not crossed.is_empty:
            length = start + piece.project(nearest_points(crossed, Point(other))[0])
        if not road.intersects(Point(other)):
            break
    return float(length)


def point_on(path: FallPath, length: float, met: bool, beside: float, passed: Optional[float] = None) -> AtRoad:
    return AtRoad(met, float(beside), float(length), float(length if passed is None else passed),
                  *(float(np.interp(length, path.length, values)) for values in (path.fall, path.x, path.y)))
