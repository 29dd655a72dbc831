#!/usr/bin/python3
"""What many ranks would have to do with a collapse: for a dump of the moving balls, the load, the ghosts and the bytes
of each of N parts, as LAMMPS' ways to divide a box make them.

    tests/scaling/decomposition.py DUMP --diameter D [--parts 8,64,512,1024] [--refine F] [-o FILE.csv]

Ways: rcb (fix balance ... rcb with comm_style tiled: recursive bisection of the longest side, equal numbers of balls);
shift (fix balance ... shift xy with processors * * 1: columns of equal numbers of balls, one set of borders per axis,
for the whole box); strips (processors 1 * 1 and shift y, what inputs/20_embankment does).

--refine F: as if the same mass were made of balls F times smaller. The borders stay, a part has F^3 times the balls,
and the shell of ghosts is F times thinner. Lengths in m.
"""
import argparse
import csv
import sys
from pathlib import Path
from typing import List, NamedTuple

import numpy as np

SKIN = 0.2              # of a diameter
FORWARD = 9 * 8         # bytes per ghost and step: position, velocity, spin
REVERSE = 6 * 8         # force and torque back
COUNTS = 5 * 8          # numbers of contacts, there and back, and the velocity that is expected (BallStates)
SWAPS = 6               # messages of one exchange in a brick: two for each axis
EXCHANGES = 4           # of a step: positions, numbers of contacts there and back, forces


class Part(NamedTuple):
    lower: np.ndarray   # m; of its box
    upper: np.ndarray
    balls: int


def rcb(places: np.ndarray, parts: int, lower=None, upper=None) -> List[Part]:
    """Recursive coordinate bisection: (n, 3) places, m, into any number of parts of equal numbers of balls."""
    lower = places.min(axis=0) if lower is None else lower
    upper = places.max(axis=0) if upper is None else upper
    if parts == 1:
        return [Part(lower, upper, len(places))]
    axis = int(np.argmax(upper - lower))
    few = parts // 2
    count = round(len(places) * few / parts)
    order = np.argpartition(places[:, axis], count)
    low, high = places[order[:count]], places[order[count:]]
    cut = 0.5 * (low[:, axis].max() + high[:, axis].min()) if count else lower[axis]
    middle_upper, middle_lower = upper.copy(), lower.copy()
    middle_upper[axis] = middle_lower[axis] = cut
    return rcb(low, few, lower, middle_upper) + rcb(high, parts - few, middle_lower, upper)


def bricks(places: np.ndarray, across: int, along: int) -> List[Part]:
    """A grid of columns, its borders where each axis on its own has equal numbers of balls."""
    lower, upper = places.min(axis=0), places.max(axis=0)
    borders = []
    for axis, parts in enumerate((across, along)):
        inner = np.quantile(places[:, axis], np.arange(1, parts) / parts)
        borders.append(np.concatenate([[lower[axis]], inner, [upper[axis]]]))
    found = []
    for i in range(across):
        for j in range(along):
            low = np.array([borders[0][i], borders[1][j], lower[2]])
            high = np.array([borders[0][i + 1], borders[1][j + 1], upper[2]])
            found.append(Part(low, high, count_inside(places, low, high)))
    return found


def count_inside(places, lower, upper) -> int:
    return int(np.count_nonzero(np.all((places >= lower) & (places < upper), axis=1)))


def nearly_square(parts: int, places: np.ndarray):
    """(across, along): the grid of so many columns whose cells are nearest to squares."""
    size = np.ptp(places[:, :2], axis=0)
    pairs = [(n, parts // n) for n in range(1, parts + 1) if parts % n == 0]
    return min(pairs, key=lambda p: abs(np.log((size[0] / p[0]) / (size[1] / p[1]))))


def ghosts(places: np.ndarray, part: Part, reach: float, refine: float) -> float:
    """Balls within reach (m) of a part's box and outside of it, for balls refine times smaller: the shell is refine
    times thinner, the balls refine^3 times as many."""
    thin = reach / refine
    sample = thin if refine == 1 else min(reach, max(thin, 0.5 * reach))    # as thin as the sample can show
    shell = (count_inside(places, part.lower - sample, part.upper + sample)
             - count_inside(places, part.lower, part.upper))
    return shell * refine ** 3 * thin / sample


def row(way: str, parts: List[Part], places: np.ndarray, reach: float, refine: float) -> dict:
    owned = np.array([part.balls for part in parts]) * refine ** 3
    shell = np.array([ghosts(places, part, reach, refine) for part in parts])
    thinnest = min(float((part.upper - part.lower)[:2].min()) for part in parts)
    return {"way": way, "parts": len(parts), "balls_mean": owned.mean(), "balls_most": owned.max(),
            "imbalance": owned.max() / owned.mean(), "ghosts_mean": shell.mean(), "ghosts_most": shell.max(),
            "ghosts_per_ball": shell.sum() / owned.sum(), "thinnest_m": thinnest,
            "thinnest_in_reach": thinnest / (reach / refine),
            "bytes_per_step_mean": shell.mean() * (FORWARD + REVERSE + COUNTS),
            "messages_per_step": EXCHANGES * SWAPS}


def read_places(path: Path) -> np.ndarray:
    """x, y, z (m) of the last step of a text dump."""
    lines = path.read_text(encoding="ascii").splitlines()
    start = max(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    names = lines[start].split()[2:]
    columns = [names.index(axis) for axis in "xyz"]
    return np.loadtxt(lines[start + 1:], usecols=columns, ndmin=2)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dump", type=Path)
    parser.add_argument("--diameter", type=float, required=True, metavar="D", help="of the balls in the dump, m")
    parser.add_argument("--parts", default="8,64,512,1024", metavar="N1,N2,...")
    parser.add_argument("--refine", type=float, default=1.0, metavar="F", help="balls F times smaller (default 1)")
    parser.add_argument("-o", dest="output", type=Path, metavar="FILE.csv", help="(default: standard output)")
    args = parser.parse_args(arguments)
    places = read_places(args.dump)
    reach = (1.0 + SKIN) * args.diameter
    rows = []
    for parts in (int(word) for word in args.parts.split(",")):
        rows.append(row("rcb", rcb(places, parts), places, reach, args.refine))
        rows.append(row("shift", bricks(places, *nearly_square(parts, places)), places, reach, args.refine))
        rows.append(row("strips", bricks(places, 1, parts), places, reach, args.refine))
    out = open(args.output, "w", newline="", encoding="ascii") if args.output else sys.stdout
    with out:
        writer = csv.DictWriter(out, rows[0], lineterminator="\n")
        writer.writeheader()
        for line in rows:
            writer.writerow({name: value if isinstance(value, (str, int)) else f"{value:.4g}"
                             for name, value in line.items()})


if __name__ == "__main__":
    main()
