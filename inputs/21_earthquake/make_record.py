#!/usr/bin/python3
"""Makes motion.txt of this case: a synthetic earthquake of 300 gal, the same on every machine.

A stationary noise with the spectrum of Kanai and Tajimi (2.5 Hz, damping 0.6: stiff soil), without its slow part by
the filter of Clough and Penzien (0.25 Hz, 0.6): cosines every 0.05 Hz from 0.1 to 12 Hz, amplitudes from the spectrum,
phases from Python's Mersenne Twister with a fixed seed. Its envelope is that of Jennings, Housner and Tsai: (t/3)^2
to 3 s, 1 to 10 s, exp(-0.4 (t - 10)) to 20 s. A correction (a + b t) times the envelope makes the ground end at rest
where it began.

Two horizontal components and a vertical one, 1 : 0.85 : 0.5, of phases of their own; x is along the fall of the face.
All are scaled so that the largest horizontal acceleration, of both components together, is 300 gal.

Writes "t ax ay az", s and m/s2, every 0.02 s. Run it in this folder; it overwrites motion.txt. --axes x or xy: the
other components are 0, and the file is motion_x.txt or motion_xy.txt.
"""
import argparse
import math
import random

import numpy as np

PEAK = 3.0                      # m/s2
DT, END = 0.02, 20.0            # s
RISE, FLAT, DECAY = 3.0, 10.0, 0.4
SEED = {"x": 1, "y": 2, "z": 3}
SHARE = {"x": 1.0, "y": 0.85, "z": 0.5}
FREQUENCIES = np.arange(0.1, 12.0, 0.05)        # Hz

t = np.round(np.arange(0.0, END + DT / 2, DT), 6)
envelope = np.where(t < RISE, (t / RISE) ** 2, np.where(t < FLAT, 1.0, np.exp(-DECAY * (t - FLAT))))


def spectrum(f):
    """Power of the noise at frequencies f (Hz), up to a factor."""
    def below(corner, damping):
        return (1 - (f / corner) ** 2) ** 2 + (2 * damping * f / corner) ** 2

    return (1 + (2 * 0.6 * f / 2.5) ** 2) / below(2.5, 0.6) * (f / 0.25) ** 4 / below(0.25, 0.6)


def ends(a):
    """Velocity and displacement at the end, of straight lines between the points."""
    velocity = np.concatenate([[0.0], np.cumsum((a[1:] + a[:-1]) / 2 * DT)])
    return velocity[-1], np.sum(velocity[:-1] * DT + (2 * a[:-1] + a[1:]) * DT ** 2 / 6)


def component(seed):
    phases = random.Random(seed)
    a = envelope * sum(math.sqrt(power) * np.cos(2 * np.pi * (f * t + phases.random()))
                       for f, power in zip(FREQUENCIES, spectrum(FREQUENCIES)))
    # two shapes that take off what is left of velocity and displacement
    shapes = [envelope, envelope * t]
    return a - np.linalg.solve(np.transpose([ends(one) for one in shapes]), ends(a)) @ shapes


parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
parser.add_argument("--axes", choices=("x", "xy", "xyz"), default="xyz", help="components that are not 0")
axes = parser.parse_args().axes
a = np.transpose([SHARE[axis] * component(SEED[axis]) if axis in axes else 0 * t for axis in "xyz"])
a *= PEAK / np.hypot(a[:, 0], a[:, 1]).max()
name = "motion.txt" if axes == "xyz" else f"motion_{axes}.txt"
with open(name, "w", encoding="ascii") as out:
    out.write("# synthetic earthquake, 300 gal, by make_record.py; t (s) ax ay az (m/s2)\n")
    for at, row in zip(t, a):
        out.write(f"{at:.2f} " + " ".join(f"{x:.6f}" for x in row) + "\n")
