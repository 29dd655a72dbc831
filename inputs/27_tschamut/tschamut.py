#!/usr/bin/python3
"""Tschamut's stones: a site of single blocks by the defaults, and how far they go against what was measured.

    tschamut.py [-o FOLDER] [--whole] [--jobs J]

--whole: the terrain as it stands, not cut where the data end. Two minutes of processor time. LMP names the program.
"""
import argparse
import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
from shapely.geometry import MultiPoint, Point

HERE = Path(__file__).resolve().parent
SLOPE = HERE.parents[1] / "tools" / "slope"
CUT = 120.0                     # m from the releases, in plan: beyond, the terrain is a plane that nobody measured
ASIDE = 0.5                     # m around the releases
SITE = ["--blocks", "600", "--size", "0.32:0.40", "--speed", "0.8"]     # the stones; all else is the default
BEYOND, FARTHEST = 1e6, 1e3      # m, of a block that left a terrain that was cut; of a distance
SHARES = 0.05, 0.25, 0.5, 0.75, 0.95


def measured():
    """Where the stones began and ended, x y."""
    rows = np.loadtxt(HERE / "trajectories.csv", delimiter=",", skiprows=1, usecols=(2, 3, 4, 5))
    return rows[:, :2], rows[:, 2:]


def seen():
    """What the README has of the measured distances, for tests/made_numbers.py."""
    start, end = measured()
    distance = np.hypot(*(end - start).T)
    stone = np.loadtxt(HERE / "trajectories.csv", str, delimiter=",", skiprows=1, usecols=1)
    return {**{f"measured.{share:g}": round(float(np.quantile(distance, share)), 1) for share in SHARES},
            **{f"stone.{one}": round(float(np.median(distance[stone == one])), 1) for one in np.unique(stone)},
            "stones": len(distance), "beyond": int((distance > CUT).sum()), "shortest": round(float(distance.min()), 1)}


def area():
    """The outline of the releases."""
    return MultiPoint(measured()[0]).convex_hull.buffer(ASIDE)


def cut(lines):
    """The lines of terrain.asc without the cells farther than CUT from the releases."""
    columns, rows, west, south, cell, none = (float(line.split()[1]) for line in lines[:6])
    x, y = np.meshgrid(west + (np.arange(columns) + 0.5) * cell, south + (rows - np.arange(rows) - 0.5) * cell)
    far = np.array([area().distance(Point(place)) > CUT for place in zip(x.flat, y.flat)]).reshape(x.shape)
    words = np.array([line.split() for line in lines[6:]], object)
    words[far] = f"{none:g}"
    return [*lines[:6], *(" ".join(row) for row in words)]


def prepare(folder, whole):
    """terrain.asc and release.csv."""
    lines = (HERE / "terrain.asc").read_text(encoding="ascii").splitlines()
    (folder / "terrain.asc").write_text("\n".join(lines if whole else cut(lines)) + "\n", encoding="ascii")
    (folder / "release.csv").write_text("".join(f"{x:.3f},{y:.3f}\n" for x, y in area().exterior.coords[:-1]),
                                        encoding="ascii")


def row(name, distance, left=()):
    """A line of the table; a block that left a terrain that was cut went farther than all others."""
    found = np.quantile(np.where(np.isinf(distance), BEYOND, distance), SHARES)
    return [name, len(distance), *(f"{one:.1f}" if one < FARTHEST else "beyond" for one in found), int(sum(left))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", dest="folder", type=Path, default=Path("tschamut"))
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--jobs", default="1")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    prepare(args.folder, args.whole)
    site = args.folder / "site"
    for words in (["site", "--terrain", args.folder / "terrain.asc", "--release", args.folder / "release.csv", *SITE,
                   "-o", site], ["study", site, "--jobs", args.jobs]):
        if subprocess.run([sys.executable, SLOPE, *words], check=False).returncode:
            sys.exit(f"tschamut.py: slope {words[0]} must end without an error")
    start, end = measured()
    with open(site / "study" / "blocks.csv", encoding="ascii") as file:
        blocks = list(csv.DictReader(file))
    rows = [row("measured", np.hypot(*(end - start).T))]
    for rolling in sorted({one["rolling"] for one in blocks}, key=float):
        distance, left = np.array([(float(one["distance_m"]), int(one["left"])) for one in blocks
                                   if one["rolling"] == rolling]).T
        rows.append(row(f"rolling {rolling}", distance if args.whole else np.where(left, np.inf, distance), left))
    with open(args.folder / "compare.csv", "w", encoding="ascii", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(
            [["case", "blocks", *(f"distance_{100 * share:.0f}_m" for share in SHARES), "left"], *rows])
    print((args.folder / "compare.csv").read_text(encoding="ascii"), end="")


if __name__ == "__main__":
    main()
