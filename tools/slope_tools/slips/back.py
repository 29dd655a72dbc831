"""Back-analysis: the pairs of cohesion and friction with which a body that failed has F = 1.

At F = 1 Bishop's balance is linear in the cohesion, so that each friction angle has one.
"""
import math
from typing import NamedTuple, Tuple

import numpy as np
import scipy

from ..errors import SlopeError
from ..survey.rasters import Raster
from . import bishop
from .columns import GRAVITY, Columns, centres

POINTS = 91
STEEPEST = 89.0     # degrees
FAR = 10.0          # lengths of the body to an axis from which a surface is nearly a plane


class Line(NamedTuple):
    friction: np.ndarray        # degrees, from 0 to where the cohesion is 0, or to STEEPEST
    cohesion: np.ndarray        # Pa


def cohesion_of(body: Columns, tangent, horizontal: float = 0.0, vertical: float = 0.0, water: float = 0.0):
    """The cohesion (Pa) with which F is 1, at each tangent of the friction angle; negative: it would stand without."""
    a, b, w = bishop.sums(body, np.atleast_1d(np.asarray(tangent, float)))
    ratio = water if body.pressure is None else 1.0
    return (bishop.driving(body, horizontal, vertical) - (1 - vertical) * b - ratio * w) / a


def line(body: Columns, horizontal: float = 0.0, vertical: float = 0.0, water: float = 0.0) -> Line:
    """The line on which F is 1; SlopeError for a body that nothing drives."""
    def of(degrees):
        return cohesion_of(body, np.tan(np.radians(degrees)), horizontal, vertical, water)

    if not of(0.0)[0] > 0:
        raise SlopeError("--failed", "must be a body that its weight, or the earthquake, drives in the direction of "
                         "sliding: without strength it would stand")
    angles = np.linspace(0.0, STEEPEST, 179)
    below = np.flatnonzero(of(angles) <= 0)
    end = STEEPEST
    if len(below):
        end = scipy.optimize.brentq(lambda angle: float(of(angle)[0]), *angles[below[0] - 1:below[0] + 1], xtol=1e-9)
    friction = np.linspace(0.0, end, POINTS)
    return Line(friction, np.maximum(of(friction), 0.0))


def plane_of(points: np.ndarray) -> Tuple[np.ndarray, np.ndarray, float]:
    """Middle and upward normal of the plane z(x, y) nearest to points (number, 3), and the rms distance from it."""
    middle = points.mean(axis=0)
    off = points - middle
    (east, north), *_ = np.linalg.lstsq(off[:, :2], off[:, 2], rcond=None)
    normal = np.array([-east, -north, 1.0]) / math.sqrt(1 + east ** 2 + north ** 2)
    return middle, normal, float(np.sqrt(np.mean((off @ normal) ** 2)))


def list_base_points(raster: Raster, bottom: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """x, y, z of a base under the middle of each cell, (number, 3)."""
    return np.column_stack([*(one[inside] for one in centres(raster)), bottom[inside]])


def far_centre(points: np.ndarray) -> np.ndarray:
    """A point FAR lengths above the plane nearest to a base, along its normal."""
    middle, normal, _ = plane_of(points)
    return middle + FAR * np.ptp(points[:, :2], axis=0).max() * normal


def sphere_of(points: np.ndarray) -> Tuple[np.ndarray, float]:
    """Centre and radius of the sphere nearest to a base (least squares).

    Where the base is nearer to a plane, or no hollow: far_centre(), and an infinite radius.
    """
    middle, normal, flat = plane_of(points)
    scale = float(np.abs(points - middle).max())
    off = (points - middle) / scale
    found, *_ = np.linalg.lstsq(np.column_stack([2 * off, np.ones(len(off))]), (off ** 2).sum(axis=1), rcond=None)
    centre = middle + scale * found[:3]
    radius = scale * math.sqrt(max(found[3] + found[:3] @ found[:3], 0.0))
    miss = float(np.sqrt(np.mean((np.linalg.norm(points - centre, axis=1) - radius) ** 2)))
    if (centre - middle) @ normal > 0 and miss < flat:
        return centre, radius
    return far_centre(points), math.inf


def steepest(raster: Raster, bottom: np.ndarray, inside: np.ndarray, centre) -> float:
    """Direction in which the weight has the largest moment about a centre, degrees counterclockwise from +x."""
    x, y = (one[inside] for one in centres(raster))
    weight = GRAVITY * (raster.z - bottom)[inside]
    return math.degrees(math.atan2(-(weight @ (y - centre[1])), -(weight @ (x - centre[0])))) % 360.0
