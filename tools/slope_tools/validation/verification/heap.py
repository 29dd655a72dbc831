"""A heap: its angle grows with the rolling resistance, and it rests

inputs/12_heap: balls on a ledge; a gate vanishes, what is too steep falls off the edge. The angle is that of a line
through the tops; it is measured twice, at two times.
"""
import numpy as np

from .claims import AtLeast, AtMost, Claim, Control, Run

CASE = "12_heap"
HEAP = Run("12_heap/in.heap")
SMALL = HEAP(length=12, height=11, once=40)
ROLLING = 0, 0.05, 0.1, 0.2         # mu_r
SEEDS = range(1, 7)                 # an angle scatters by a degree or two
D = 0.01                            # m
AI = "Ai et al. (2011)"
NO_SPRING = "no rolling spring, a rolling dashpot only"
NOTHING = "rolling_spring $(v_spring*v_kn) ${cr}", "rolling_spring 0 1e-30"


def tops(balls):
    """x and z, in diameters, of the surface: mean of the three highest balls of each slice, away from wall and edge."""
    x, z = balls["x"][0] / D, balls["z"][0] / D
    edge = np.argmax(np.histogram(x, np.arange(x.max() + 3))[0] < 3)    # beyond it, only what is falling
    return np.array([(left + 0.5, np.sort(z[(x >= left) & (x < left + 1)])[-3:].mean())
                     for left in np.arange(2, edge - 3)])


def angle_of(balls):
    """Degrees."""
    x, z = tops(balls).T
    return -np.degrees(np.arctan(np.polyfit(x, z, 1)[0]))


def angle(result):
    """At the second measurement, degrees."""
    return angle_of(result.frames("heap.2.dump"))


def smallest_step(*results):
    """Of the angle, the mean over seeds, from one rolling resistance to the next, degrees."""
    return np.diff(np.reshape([angle(result) for result in results], (len(ROLLING), -1)).mean(axis=1)).min()


def creep_of(before, after):
    """Median displacement of the balls still there, in diameters: a single ball that drops later is no creep."""
    same = np.isin(before["id"][0], after["id"][0])
    way = [before[key][0][same] - after[key][0] for key in "xz"]
    return np.median(np.hypot(*way)) / D


def creep(result):
    """The same, between the two measurements of a run."""
    return creep_of(*(result.frames(f"heap.{when}.dump") for when in (1, 2)))


def _keeps(name, which, deck, **more):
    return Claim(name, f"{which}: median path of the balls between the two measurements over their diameter", "", AI,
                 (deck(rolling=0.2),), creep, AtMost(1e-3), Control(NO_SPRING, (deck(rolling=0.2, spring=0),)), **more)


CLAIMS = [
    _keeps("heap_rests_small", "A small heap, mu_r 0.2, rests", SMALL),
    _keeps("heap_rests", "A heap, mu_r 0.2, rests", HEAP(seed=1), quick=False),
    Claim("heap_angle", "Angle at mu_r 0, 0.05, 0.1, 0.2, mean of six seeds: smallest step from one to the next",
          "degrees", AI + ": it grows with the rolling resistance",
          tuple(HEAP(seed=seed, rolling=mu) for mu in ROLLING for seed in SEEDS), smallest_step, AtLeast(1.0),
          Control("neither rolling spring nor dashpot: mu_r limits nothing",
                  tuple(HEAP(NOTHING, rolling=mu) for mu in ROLLING)),
          quick=False, remark="Three seeds, as before, gave 0.7 degrees from 0.1 to 0.2, within their scatter."),
]
