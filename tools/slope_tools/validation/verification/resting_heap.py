"""Contacts at rest: a heap of low restitution stays where it is, and so does a ball under any dashpot

inputs/12_heap, in.resting_heap: 504 balls from a column, looked at after 10 and after 60 s; in.rest: a ball on a fixed
ball, damping ratios from 0.05 to 69.
"""
from typing import NamedTuple

import numpy as np

from .claims import AtMost, Claim, Control, Run

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
    shift = np.stack([after[axis][0] - before[axis][0][same] for axis in "xyz"], axis=1)
    each = np.linalg.norm(shift, axis=1) / radius
    mass = radius ** 3
    centroid = np.linalg.norm((shift * mass[:, None]).sum(axis=0) / mass.sum()) / radius.mean()
    return Moved(each.max(), centroid, int((each > 1e-3).sum()), int((~same).sum()))


def overlaps(result):
    """Of a run of in.rest: overlap over m g/kn, for each of ZETAS."""
    return result.frames("rest.dump")["v_overlap"][0]


def measure_farthest_shift(*results):
    """Displacement of the ball that moved most between the looks, over its radius; a lost ball is infinitely far."""
    return max(np.inf if one.lost else one.most for one in map(moved, results))


def centroid(*results):
    """Displacement of the centroid between the looks, over the mean radius."""
    return max(moved(result).centroid for result in results)


def softening(result):
    """Largest error of the overlap at rest, over m g/kn."""
    return np.abs(overlaps(result) - 1).max()


AT_REST = "what rests stays"


def _heaps(name, title, which, broken, **more):
    plain = Control("scheme plain, twice the rule's step", (broken(scheme="plain", part=2),))
    yield Claim(f"heap_stays_{name}", f"{title}: largest displacement of a ball over its radius", "", AT_REST,
                tuple(which), measure_farthest_shift, AtMost(1e-3), plain, **more)
    yield Claim(f"heap_centroid_{name}", f"{title}: displacement of the centroid over the radius", "", AT_REST,
                tuple(which), centroid, AtMost(1e-5), plain, **more)


def _five_heaps(large, e):
    name, balls = (f"{e}", "heaps") if large == 1 else (f"mixed_{e}", f"heaps of diameters 1:{large}")
    heap = HEAP(e=e, large=large)
    return _heaps(name, f"Five {balls}, e {e}, from 10 to 60 s", [heap(seed=seed) for seed in FILLINGS], heap(end=12),
                  quick=False)


SHORT = HEAP(begin=6, end=8)
CLAIMS = [
    Claim("rest_overlap", "A ball at rest on a fixed ball, damping ratios 0.05 to 69: largest error of the overlap "
          "over m g/kn", "", "balance of forces", (REST,), softening, AtMost(0.01),
          Control("2 % more weight", (REST(("gravity $g vector", "gravity $(1.02*v_g) vector")),))),
    *_heaps("short", "A heap of 504 balls, e 0.1, from 6 to 8 s", [SHORT], SHORT),
    *(claim for large in (1, 3) for e in RESTITUTIONS for claim in _five_heaps(large, e)),
]
