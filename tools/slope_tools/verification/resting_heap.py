"""Contacts at rest: a heap of low restitution stays where it is, and so does a ball under any dashpot

inputs/12_heap, in.resting_heap: 504 balls from a column, looked at after 10 and after 60 s; in.rest: a ball on a fixed
ball, damping ratios from 0.05 to 69.
"""
from typing import NamedTuple

import numpy as np

from .claims import Run

CASE = "12_heap"
HEAP, REST = Run("12_heap/in.resting_heap"), Run("12_heap/in.rest")
RESTITUTIONS, FILLINGS = (0.05, 0.1, 0.2, 0.3, 0.5), (1, 2, 3, 4, 5)
ZETAS = (0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.95, 1, 1.05, 1.5, 2, 3.5, 6.9, 17, 35, 69)    # of in.rest


class Moved(NamedTuple):
    """Between the two looks at a heap."""
    most: float             # the ball that moved farthest, over its radius
    centroid: float         # of all balls, over the mean radius
    creeping: int           # balls that moved by more than 1e-3 of their radius
    lost: int


def moved(result):
    """Of a run of in.resting_heap."""
    before, after = (result.frames(f"resting_heap.{when}.dump") for when in (1, 2))
    same = np.isin(before["id"][0], after["id"][0])
    radius = before["radius"][0][same]
    way = np.stack([after[axis][0] - before[axis][0][same] for axis in "xyz"], axis=1)
    each = np.linalg.norm(way, axis=1) / radius
    mass = radius ** 3
    centroid = np.linalg.norm((way * mass[:, None]).sum(axis=0) / mass.sum()) / radius.mean()
    return Moved(each.max(), centroid, int((each > 1e-3).sum()), int((~same).sum()))


def overlaps(result):
    """Of a run of in.rest: overlap over m g/kn, for each of ZETAS."""
    return result.frames("rest.dump")["v_overlap"][0]
