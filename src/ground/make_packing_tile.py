#!/usr/bin/python3
"""Makes packing_tile.cpp, the table of a disordered packing of equal balls: src/ground/make_packing_tile.py

Balls at random places of a periodic cube push each other apart, without friction (FIRE, Bitzek et al. 2006), until none
touches another. The densest such packings have a solid fraction of 0.64; at 0.60 the balls have just become free. Takes
10 s. Another version of numpy rounds otherwise, and makes another packing of the same kind: the table that is committed
is the one that counts.
"""
import math
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

BALLS = 3000
SOLID = 0.60            # solid fraction
SEED = 60
REACH = 1.0005          # diameters: balls push each other at this distance of their centres,
APART = 1.0003          # and are far enough apart at this one
UNITS = 1000000         # of the table, along a side
FASTEST = 0.5           # of FIRE: time step
SIDE = (BALLS * math.pi / 6 / SOLID) ** (1 / 3)     # of the cube, in diameters


def pushes(x):
    """The push on each ball and the least distance of two centres, in diameters."""
    pairs = cKDTree(x % SIDE, boxsize=SIDE).query_pairs(REACH, output_type="ndarray")
    if not len(pairs):
        return np.zeros_like(x), REACH
    first, second = pairs.T
    apart = x[first] - x[second]
    apart -= SIDE * np.round(apart / SIDE)
    distance = np.linalg.norm(apart, axis=1)
    push = ((REACH - distance) / distance)[:, None] * apart
    total = np.zeros_like(x)
    np.add.at(total, first, push)
    np.add.at(total, second, -push)
    return total, distance.min()


def packed():
    """The centres in the cube, in diameters."""
    x = np.random.default_rng(SEED).random((BALLS, 3)) * SIDE
    v, step, steer, downhill = np.zeros_like(x), 0.1, 0.1, 0
    while True:
        push, least = pushes(x)
        if least >= APART:
            return x % SIDE
        if (push * v).sum() > 0:
            downhill += 1
            v = (1 - steer) * v + steer * push * np.linalg.norm(v) / np.linalg.norm(push)
            if downhill > 5:
                step, steer = min(1.1 * step, FASTEST), 0.99 * steer
        else:
            downhill, step, steer, v = 0, step / 2, 0.1, np.zeros_like(x)
        v += step * push
        x += step * v


def text(x):
    """packing_tile.cpp of these centres."""
    units = np.round(x / SIDE * UNITS).astype(int) % UNITS
    units = units[np.lexsort(units.T)]
    cells = [f"{{{a}, {b}, {c}}}" for a, b, c in units]
    rows = ",\n".join("    " + ", ".join(cells[k:k + 4]) for k in range(0, len(cells), 4))
    return f"""// No LAMMPS
/* ----------------------------------------------------------------------
   SLOPE package for LAMMPS: collapse of slopes by the simple DEM model
   Distributed under the GNU General Public License, version 2
------------------------------------------------------------------------- */

/* Made by make_packing_tile.py. */

#include "packing_tile.h"

// clang-format off
const int Slope::PACKING_TILE[PACKING_BALLS][3] = {{
{rows}}};
// clang-format on
"""


if __name__ == "__main__":
    Path(__file__).with_name("packing_tile.cpp").write_text(text(packed()))
