#!/usr/bin/python3
"""Depth at the gauge of in.sarno over time: sarno.py OUT... [--measured heightSarno2018.dat]

OUT: names that the deck was given as out, in this folder; its log is OUT.log, or log.lammps.
"""
import argparse
import re
from pathlib import Path

import numpy as np

WINDOW, WIDTH, BEAD = (0.93, 0.97), 0.08, 0.0033        # m
TIMES = 0.53, 1.2, 2.0, 3.0, 4.0, 5.0                   # s after the arrival
HALF = 0.25                                             # s, half of what a depth is a mean of
ARRIVED = 0.0066                                        # m, of the first measured depth


def frames(path):
    """Step and places of the balls of each frame of a dump."""
    lines = iter(path.read_text().splitlines())
    for line in lines:
        if line == "ITEM: TIMESTEP":
            step = int(next(lines))
        elif line == "ITEM: NUMBER OF ATOMS":
            count = int(next(lines))
        elif line.startswith("ITEM: ATOMS"):
            yield step, np.array([next(lines).split() for _ in range(count)], float).reshape(-1, 5)


def depth(balls, d):
    """Median over squares of a diameter of the highest top in them, above the bed (m); 0 where half of them are empty.

    The bed ends half a diameter above z = 0, so this is the height of the centre.
    """
    shape = [int(np.ceil(length / d - 1e-9)) for length in (WINDOW[1] - WINDOW[0], WIDTH)]
    tops = np.zeros(shape)
    cell = [np.clip((balls[:, k] - low) / d, 0, count - 1).astype(int) for k, low, count in
            ((1, WINDOW[0], shape[0]), (2, 0, shape[1]))]
    np.maximum.at(tops, tuple(cell), balls[:, 3])
    return float(np.median(tops))


def history(name):
    """Times from the arrival (s), depths (m) and mean speed along the chute (m/s)."""
    log = next(path for path in (Path(f"{name}.log"), Path("log.lammps")) if path.is_file()).read_text()
    d, _, opened, dt = map(float, re.search(
        r"^sarno: d (\S+) beads (\S+) opened at step (\S+) time step (\S+)", log, re.MULTILINE).groups())
    rows = [((step - opened) * dt, depth(balls, d), balls[:, 4].mean() if len(balls) else 0.0)
            for step, balls in frames(Path(f"{name}.gauge.dump"))]
    time, deep, speed = np.array(rows).T
    return time - time[np.argmax(deep > ARRIVED)], deep, speed


def at(time, values, when):
    near = np.abs(time - when) <= HALF if when > 1 else np.abs(time - when) <= 0.05
    return values[near].mean() if near.any() else np.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", metavar="OUT")
    parser.add_argument("--measured", type=Path)
    args = parser.parse_args()
    print("s after the arrival", *TIMES)
    if args.measured:
        time, deep = np.loadtxt(args.measured).T
        print("measured, mm", *(f"{1000 * at(time, deep, when):.1f}" for when in TIMES))
    for name in args.names:
        time, deep, speed = history(name)
        print(f"{name}, mm", *(f"{1000 * at(time, deep, when):.1f}" for when in TIMES))
        print(f"{name}, m/s", *(f"{at(time, speed, when):.2f}" for when in TIMES))


if __name__ == "__main__":
    main()
