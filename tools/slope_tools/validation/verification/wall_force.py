"""The force of sand on a wall, which is compared with nothing yet

inputs/19_wall_force: sand slides down a flume onto a rigid wall.
"""
from typing import Tuple

import numpy as np

from .claims import Claim, Run, Seen

CASE = "19_wall_force"
DECK = Run("19_wall_force/in.wall_force")
CLAIMS: Tuple[Claim, ...] = ()      # they wait for the measured curves
CHANCE = 0.1                        # of the filling: a build that rounds otherwise has another one
SEEN = [Seen(f"{angle}.{sand}.{key}", (DECK(angle=angle, sand=sand),),
             lambda result, name=name: result.number(name, "wall_force:"), False, CHANCE)
        for angle, sand in ((45, 62), (45, 50), (65, 62))
        for key, name in (("largest", "largest force"), ("end", "at the end"), ("left", "on the flume"))]
SEEN.append(Seen("mass_ratio", (DECK(angle=45, sand=62), DECK(angle=45, sand=50)),
                 lambda *results: np.divide(*(one.number("largest force", "wall_force:") for one in results)),
                 False, CHANCE))
