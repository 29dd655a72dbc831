#!/usr/bin/python3
"""Run-out against the number of blocks, stacked and loose: okada.py [-o FOLDER] [--set NAME=VALUE ...]

Writes FOLDER/okada.csv: run-out in plan from the lower edge of the blocks, of the blocks of all seeds; errors by seeds.
LMP names the program, otherwise build/lmp.
"""
import argparse
import csv
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
LMP = os.environ.get("LMP", str(HERE.parents[1] / "build" / "lmp"))
NUMBERS = {20: ((2, 5, 2), 25), 100: ((5, 5, 4), 10), 1000: ((10, 10, 10), 3)}        # rows; seeds
HOW = {"stacked": {"apart": 1.02, "stir": 0.01}, "loose": {"apart": 1.4, "stir": 0.13}}
EDGE = 4 * np.cos(np.radians(35))       # m, the lower edge of the blocks
DRAWS = 1000


def run(folder, **variables):
    """Places of the blocks at the start and at rest, x from the toe upwards, of those that are still there."""
    folder.mkdir(exist_ok=True)
    words = [word for key, value in variables.items() for word in ("-var", key, str(value))]
    done = subprocess.run([LMP, "-in", str(HERE / "in.okada"), "-log", "log.okada", "-screen", "none", *words],
                          cwd=folder, check=False)
    if done.returncode:
        sys.exit(f"{folder}/log.okada: the run must end without an error, see its last lines")
    start, rest = (np.loadtxt(folder / f"okada.{when}.dump", skiprows=9, ndmin=2) for when in ("start", "rest"))
    if len(start) != len(rest):
        sys.exit(f"{folder}: all blocks must stay on the ground, got {len(rest)} of {len(start)}")
    return start[:, 3], rest[:, 3]


def numbers(runs):
    """Mean and 95 % of the run-out, mean travel, share that stays on the slope."""
    start, rest = (np.concatenate(part) for part in zip(*runs))
    return np.array([EDGE - rest.mean(), np.quantile(EDGE - rest, 0.95), (start - rest).mean(), (rest > 0).mean()])


def row(runs):
    """The numbers, each with its standard error: seeds with replacement."""
    random = np.random.default_rng(1)
    error = np.std([numbers([runs[k] for k in random.integers(0, len(runs), len(runs))]) for _ in range(DRAWS)], axis=0)
    return [f"{value:.3f}" for pair in zip(numbers(runs), error) for value in pair]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", dest="folder", type=Path, default=Path("okada"))
    parser.add_argument("--set", nargs="*", default=[], metavar="NAME=VALUE")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    given = dict(word.split("=", 1) for word in args.set)
    head = [name for of in ("mean_m", "p95_m", "travel_m", "on_slope") for name in (of, f"{of}_error")]
    rows = [["blocks", "how", "seeds", *head]]
    for count, ((long, wide, high), seeds) in NUMBERS.items():
        for how, places in HOW.items():
            size = {"long": long, "wide": wide, "high": high}
            runs = [run(args.folder / f"{how}.{count}.{seed}", seed=seed, **size, **places, **given)
                    for seed in range(1, seeds + 1)]
            rows.append([count, how, seeds, *row(runs)])
            print(*rows[-1], flush=True)
    with open(args.folder / "okada.csv", "w", encoding="ascii", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
