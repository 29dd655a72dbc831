"""Displacement of a sliding block in an earthquake (Newmark 1965): a rigid body on a surface that yields.

The acceleration of the ground is a straight line between two points, as in fix ground/motion; the displacement is
the exact integral of that, for many yield accelerations at once. A body slides downhill only.
"""
from typing import Tuple

import numpy as np


def displacement(t: np.ndarray, ground: np.ndarray, yields: np.ndarray) -> np.ndarray:
    """Displacement (m) until the body rests, or until the end of the record, for each yield acceleration (m/s2).

    t in s, at any steps; ground: acceleration (m/s2) against the direction of sliding, which drives the body, (points,)
    or (points, yields). yields must not be negative: such a body moves without an earthquake.
    """
    yields = np.atleast_1d(np.asarray(yields, float))
    driving = np.asarray(ground, float)
    driving = np.broadcast_to(driving[:, None] if driving.ndim == 1 else driving, (len(t), len(yields)))
    speed, way = np.zeros(len(yields)), np.zeros(len(yields))
    for h, before, after in zip(np.diff(t), driving[:-1], driving[1:]):
        moving = (speed > 0) | (before > yields) | (after > yields)
        if h <= 0 or not moving.any():      # two points of one time are a jump
            continue
        speed[moving], more = over_step(h, before[moving] - yields[moving], after[moving] - yields[moving],
                                        speed[moving])
        way[moving] += more
    return way


def over_step(h: float, first: np.ndarray, last: np.ndarray, speed: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Speed at the end of a step h and the way in it; first and last: excess of the acceleration over the yield's."""
    slope = (last - first) / h
    rest = (speed <= 0) & (first <= 0)
    stop = np.where(rest, 0.0, first_zero(h, slope, first, speed))     # when it comes to rest, h if it does not
    way = np.where(rest, 0.0, speed * stop + first * stop ** 2 / 2 + slope * stop ** 3 / 6)
    end = np.where(rest, 0.0, np.maximum(speed + first * h + slope * h ** 2 / 2, 0.0))
    rested = rest | (stop < h)
    again = rested & (last > 0) & (slope > 0)           # it starts once more where the excess crosses 0
    left = np.where(again, last / np.where(again, slope, 1.0), 0.0)
    left = np.minimum(left, h - stop)
    return np.where(rested, slope * left ** 2 / 2, end), way + slope * left ** 3 / 6


def first_zero(h: float, slope: np.ndarray, first: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """The first time in (0, h] at which speed + first t + slope t^2 / 2 falls to 0, else h."""
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(first ** 2 - 2 * slope * speed)      # NaN: the speed has no zero
        time = np.where(first >= 0, -(first + root) / slope, 2 * speed / (root - first))
    return np.where((time > 0) & (time < h), time, h)


def project_acceleration(acceleration: np.ndarray, direction: float) -> np.ndarray:
    """Horizontal acceleration (points,) towards a direction, degrees counterclockwise from +x, of (points, 2 or 3)."""
    turned = np.radians(direction)
    return acceleration[:, 0] * np.cos(turned) + acceleration[:, 1] * np.sin(turned)


def both_ways(t: np.ndarray, acceleration: np.ndarray, direction: float, yields: np.ndarray,
              vertical: float = 0.0) -> np.ndarray:
    """The larger displacement (m) of the record and of its negative, for each yield acceleration (m/s2).

    acceleration: of the ground, (points, 3) in m/s2; direction as in project_acceleration(). vertical: how much the
    yield acceleration grows per upward acceleration of the ground, which makes the body heavier; 0 without the vertical
    component. For a dry body without cohesion it is the yield coefficient.
    """
    horizontal = project_acceleration(acceleration, direction)
    lift = vertical * acceleration[:, 2]
    return np.maximum(displacement(t, horizontal - lift, yields), displacement(t, -horizontal - lift, yields))
