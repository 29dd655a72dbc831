"""The angle of repose of glass beads between walls and without them

inputs/14_repose_walls: beads settle in a container, and what stays on a plate when the floor beside it vanishes is a
heap. Its angle is the slope of the surface between 15 and 85 % of the plate's half-width, mean of both flanks.
"""
from typing import Dict, Tuple

import numpy as np

from .claims import Claim, Control, Near, Run

CASE = "14_repose_walls"
DECK = Run("14_repose_walls/in.repose_walls")
PLATE = 30              # diameters
SEEDS = 1, 2, 3         # an angle scatters by a degree or two
PART = 0.15, 0.85       # of the half-width
SOURCE = "Zhou et al. (2002)"


def measure_repose_angle(d, thickness=None):
    """Degrees; d in mm, thickness between front and rear wall in diameters, None without them."""
    wall = 0.0 if thickness is None else np.exp(-0.18 * thickness)
    return 29.6 * d ** -0.206 * (1 + wall)


def surface(x, y, z):
    """x and height of the surface, all in diameters: mean across of the highest bead in each cell of one diameter."""
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    tops: Dict[Tuple[int, int], float] = {}
    for cell, height in zip(zip(column, row), z):
        tops[cell] = max(height, tops.get(cell, height))
    return np.array([(left + 0.5, np.mean([top for cell, top in tops.items() if cell[0] == left]))
                     for left in sorted(set(column))])


def angles_of(beads, d, plate=PLATE):
    """Of the left and of the right flank, degrees."""
    places, heights = surface(*(beads[axis][0] / d for axis in "xyz")).T
    return [np.degrees(np.arctan(-side * np.polyfit(places[on], heights[on], 1)[0])) for side in (-1, 1)
            for on in [(side * places > PART[0] * plate / 2) & (side * places < PART[1] * plate / 2)]]


def angle(*results):
    """Mean of both flanks and all fillings, degrees."""
    return np.mean([angles_of(result.frames("repose.dump"), 0.01) for result in results])


WITHOUT = tuple(DECK(walls="no", thickness=8, seed=seed) for seed in SEEDS)
CLAIMS = [
    Claim("repose_without_walls", "Angle of repose of beads of 10 mm, no front and rear wall, three fillings",
          "degrees", SOURCE, WITHOUT, angle, Near(measure_repose_angle(10), 2.0),
          Control("rolling resistance 0.1", (WITHOUT[0](rolling=0.1),)), quick=False,
          remark="The rolling resistance, 0.033, was fitted on the first of these fillings."),
]
