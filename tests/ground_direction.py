#!/usr/bin/python3
"""Has the ground of fixed balls a direction? The block of inputs/13_ground_direction, turned about the vertical.

    tests/ground_direction.py [--spacing 0.5,0.7,0.9] [--slope 22,27,35,45] [--azimuth 0,15,22.5,30,45,67.5] [--seeds 5]
                              [--pattern scattered] [--set NAME=VALUE ...] [--jobs 1] [--lmp FILE] -o DIR

Makes what runs are missing in DIR, and prints for each spacing and slope the mean travel at each azimuth, its largest
distance from the mean of all in pooled standard errors (bound 3.5) and, where the mean exceeds 50 d, in percent
(bound 1), and the largest mean way aside (bound: 3.5 standard errors, and 0.5 % of the travel where that exceeds 50 d).
Exit status 1 where a bound does not hold, a ball is lost, or a run has not come to rest.
"""
import argparse
import itertools
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parents[1]
DECK = TOP / "inputs" / "13_ground_direction" / "in.ground_direction"
RESULT = re.compile(r"^travel (\S+) m, aside (\S+) m, left on the slope (\S+) %, lost (\d+), moving (\d+) of (\d+)",
                    re.M)
FAR = 50.0          # d: from here on bounds in percent count, too
ERRORS, PERCENT, ASIDE = 3.5, 1.0, 0.5


def numbers(text):
    return [float(word) for word in text.split(",")]


def run(options, folder, values):
    """travel, aside, left, lost, moving of one run, made if it is missing."""
    name = "_".join(f"{key}{value:g}" if isinstance(value, float) else f"{key}{value}" for key, value in values.items())
    log = folder / f"{name}.log"
    if not (log.is_file() and RESULT.search(log.read_text())):
        words = [word for key, value in values.items() for word in ("-var", key, str(value))]
        subprocess.run([options.lmp, "-in", DECK, "-log", log, "-screen", "none", *words], check=True, cwd=folder,
                       env=dict(os.environ, OMP_NUM_THREADS="1"))
    found = RESULT.search(log.read_text())
    if not found:
        raise SystemExit(f"{log}: no result")
    return [float(word) for word in found.groups()]


def judge(table):
    """Of travel, aside, left, lost, moving, balls by azimuth and seed: a line, and whether the bounds hold."""
    travel, aside = table[:, :, 0], table[:, :, 1]
    seeds = travel.shape[1]
    error = np.sqrt(travel.var(axis=1, ddof=1).mean() / seeds)
    off = np.abs(travel.mean(axis=1) - travel.mean()).max()
    error_aside = np.sqrt(aside.var(axis=1, ddof=1).mean() / seeds)
    most_aside = np.abs(aside.mean(axis=1)).max()
    mean = travel.mean()
    holds = off <= ERRORS * error and most_aside <= ERRORS * error_aside
    if mean > FAR:
        holds &= off <= PERCENT / 100 * mean and most_aside <= ASIDE / 100 * mean
    moving, lost = table[:, :, 4].max() / table[:, :, 5].max(), table[:, :, 3].max()
    holds &= moving < 0.003 and lost == 0
    line = (" ".join(f"{value:7.2f}" for value in travel.mean(axis=1)) + f"   off {off / error:4.1f} errors, "
            f"{100 * off / mean:4.2f} %; aside {most_aside:5.2f} m, {most_aside / error_aside:4.1f} errors, "
            f"{100 * most_aside / mean:4.2f} %; left {table[:, :, 2].mean():5.1f} %; lost {lost:.0f}, "
            f"moving {100 * moving:.1f} %")
    return line, bool(holds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value in (("spacing", "0.5,0.7,0.9"), ("slope", "22,27,35,45"), ("azimuth", "0,15,22.5,30,45,67.5")):
        parser.add_argument(f"--{name}", type=numbers, default=numbers(value))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--pattern", default="scattered")
    parser.add_argument("--set", action="append", default=[], help="a variable of the deck, NAME=VALUE")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--lmp", type=Path, default=TOP / "build" / "lmp")
    parser.add_argument("-o", dest="out", type=Path, required=True)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    more = dict(word.split("=", 1) for word in options.set)
    cases = list(itertools.product(options.spacing, options.slope))
    seeds = range(1, options.seeds + 1)

    def one(spacing, slope, azimuth, seed):
        return run(options, options.out.resolve(), {"pattern": options.pattern, "spacing": spacing, "slope": slope,
                                                    "azimuth": azimuth, "seed": seed, **more})
    good = True
    print("spacing slope   mean travel at " + " ".join(f"{azimuth:g}" for azimuth in options.azimuth) + " degrees")
    with ThreadPoolExecutor(options.jobs) as pool:
        for spacing, slope in cases:
            rows = [[pool.submit(one, spacing, slope, azimuth, seed) for seed in seeds] for azimuth in options.azimuth]
            line, holds = judge(np.array([[cell.result() for cell in row] for row in rows]))
            good &= holds
            print(f"{spacing:7g} {slope:5g} {line}{'' if holds else '   NOT'}", flush=True)
    sys.exit(not good)


if __name__ == "__main__":
    main()
