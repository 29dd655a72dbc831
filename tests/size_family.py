#!/usr/bin/python3
"""A family of slides whose balls are made smaller, for tests/size.sh; one run of one of them, as a line of CSV.

tests/size_family.py site CASE FOLDER: terrain, body and road of a case, and its site by `slope site`, in a new folder
tests/size_family.py row CASE FOLDER PREFIX FINER SEED DIAMETER [SECONDS]: the line of a run there
tests/size_family.py list: all cases; rolling CASE: its rolling resistance; head: of the lines
tests/size_family.py judge SIZE.csv: the finest runs, and what a study says of finer balls by the coarser ones
"""
import csv
import math
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml

TOP = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TOP / "tools"))
BALLS = 800             # of a run whose balls are not made smaller
CELL = 1.0              # m, of the terrain
SIDE = 45.0             # m, beside the body
BEHIND = 25.0           # m, beyond its upper edge
CORNERS = 48            # of an oval outline
FLOW = 4.0              # m, of the cells in which the flow is averaged
MOVES = 0.5             # m/s
GRAVITY, SOLID = 9.80665, 0.60
HEAD = "case,finer,seed,d,balls,balls_thick,remove,on_road,beyond,length,travel,inertial,released,time,cpu_s"


class Slide(NamedTuple):
    """Lengths in m, in plan; angles in degrees. The face rises along x, from the break in slope on."""
    shape: str              # slab: of one depth with flanks of 45 degrees; prism: at its sides alone; or of --shape
    length: float
    width: float
    depth: float
    face: float
    below: float            # slope of the ground below the break; that of the face: there is none
    friction: float
    rolling: float
    road: float             # of the road's near edge, below the break
    slip: float = 0.0       # friction angle of the slip surface
    gap: float = 4.0        # from the break to the body's lower edge
    room: float = 100.0     # of the terrain below the break
    wide: float = 8.0       # of the road
    balls: int = BALLS      # of a run whose balls are not made smaller
    diameter: float = 0.0   # of these balls; 0: by their number


# those that take least time first
CASES = {
    "thin": Slide("slab", 40, 40, 3, 35, 10, 25, 0.10, 10, 20),
    "compact": Slide("slab", 26, 24, 7, 33, 0, 30, 0.05, 4, 20),
    "rough": Slide("slab", 30, 30, 5, 36, 18, 20, 0.15, 12, 10),
    "oval": Slide("ellipsoid", 40, 30, 8, 30, 0, 35, 0.10, 4),
    "wide": Slide("sphere", 24, 50, 5, 40, 15, 20, 0.15, 10),
    "bowl": Slide("sphere", 44, 30, 7, 36, 0, 30, 0.0, 10),
    "narrow": Slide("ellipsoid", 44, 14, 5, 38, 5, 25, 0.0, 16),
    "deep": Slide("sphere", 50, 34, 10, 40, 0, 35, 0.05, 10),
    "gentle": Slide("ellipsoid", 40, 30, 8, 28, 12, 25, 0.10, 4),
    "steady": Slide("slab", 30, 24, 6, 25, 25, 35, 0.15, 4, 30, room=130),
}

# not of the family: 7,680 m3, 8 m thick at right angles to the face; with balls of 1.45, 0.7 and 0.5 m:
# CASES=slide tests/size.sh OUT 1:3 2.0714:1 2.9:1
OTHERS = {"slide": Slide("prism", 33.5, 32, 9.54, 33, 0, 30, 0.05, 0, 30, 20, room=80, wide=10, diameter=1.45)}
ALL = {**CASES, **OTHERS}


# --- geometry ---

def size(one: Slide):
    """Cells of the terrain along x and y."""
    return (round((one.room + one.gap + one.length + BEHIND) / CELL), round((one.width + 2 * SIDE) / CELL))


def centres(one: Slide):
    """x from the break and y from the middle of the body, of the cells, rows from the north."""
    columns, rows = size(one)
    return np.meshgrid((np.arange(columns) + 0.5) * CELL - one.room,
                       (rows - 0.5 - np.arange(rows)) * CELL - rows * CELL / 2)


def heights(one: Slide):
    """Of the ground."""
    x, _ = centres(one)
    return 100 + np.where(x > 0, x * math.tan(math.radians(one.face)), x * math.tan(math.radians(one.below)))


def thicknesses(one: Slide):
    """Of a slab or a prism on the ground, vertical."""
    x, y = centres(one)
    along, across = one.length / 2 - abs(x - one.gap - one.length / 2), one.width / 2 - abs(y)
    if one.shape == "prism":
        return np.where(along > 0, np.clip(across / math.cos(math.radians(one.face)), 0, one.depth), 0)
    return np.clip(np.minimum(along, across), 0, one.depth)


def write_asc(path: Path, z) -> None:
    rows, columns = z.shape
    head = f"ncols {columns}\nnrows {rows}\nxllcorner 0\nyllcorner 0\ncellsize {CELL}\nNODATA_value -9999\n"
    path.write_text(head + "".join(" ".join(f"{value:.6f}" for value in row) + "\n" for row in z))


def write_polygon(path: Path, points) -> None:
    path.write_text("".join(f"{x:.3f},{y:.3f}\n" for x, y in points))


def write_case(one: Slide, folder: Path) -> list:
    """dem.asc, road.csv and the body's file; the words of `slope site` for the body."""
    middle = size(one)[1] * CELL / 2
    write_asc(folder / "dem.asc", heights(one))
    near = one.room - one.road
    far = near - one.wide
    write_polygon(folder / "road.csv", [(far, 0), (near, 0), (near, 2 * middle), (far, 2 * middle)])
    if one.shape in ("slab", "prism"):
        write_asc(folder / "height.asc", thicknesses(one))
        return ["--scar", "height.asc", "--scar-is", "height"]
    turn = 2 * math.pi * np.arange(CORNERS) / CORNERS
    write_polygon(folder / "release.csv", np.transpose([
        one.room + one.gap + one.length / 2 * (1 + np.cos(turn)), middle + one.width / 2 * np.sin(turn)]))
    return ["--release", "release.csv", "--shape", one.shape, "--depth", f"{one.depth:g}"]


def make_site(one: Slide, folder: Path) -> None:
    """The site in folder/site."""
    folder.mkdir(parents=True)
    words = write_case(one, folder)
    subprocess.run([sys.executable, str(TOP / "tools" / "slope"), "site", "--terrain", "dem.asc", *words,
                    "--road", "road.csv", "--friction", f"{one.friction:g}", "--rolling", f"{one.rolling:g}",
                    "--slip-friction", f"{one.slip:g}",
                    *(["--diameter", f"{one.diameter:g}"] if one.diameter else ["--balls", str(one.balls)]),
                    "-o", "site"], cwd=folder, check=True, stdout=subprocess.DEVNULL)


# --- a run ---

def inertial_number(one: Slide, prefix: Path, d: float, ball: float) -> float:
    """Of the flow below the break, the median over its mass: d (u / h) / sqrt(pressure / density of a ball).

    u: velocity averaged over the depth, h: thickness, in cells of FLOW, in all snapshots; pressure: of the weight, at
    half the thickness; ball: m3 of ground, for which each ball stands.
    """
    numbers, weights = [], []
    for path in sorted(prefix.parent.glob(f"{prefix.name}.*.dump")):
        x, y, *v = np.loadtxt(path, skiprows=9, usecols=(3, 4, 6, 7, 8), ndmin=2).T
        below = x < one.room
        if not below.any():
            continue
        _, cell, count = np.unique(np.floor(np.array([x, y])[:, below] / FLOW), axis=1, return_inverse=True,
                                   return_counts=True)
        u = np.sqrt(sum((np.bincount(cell.ravel(), part[below]) / count) ** 2 for part in v))
        h = count * ball / FLOW ** 2
        numbers.append((d * u / h / np.sqrt(SOLID * GRAVITY * h / 2))[u > MOVES])
        weights.append(count[u > MOVES])
    values, weight = np.concatenate(numbers), np.concatenate(weights)
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(weight[order]), weight.sum() / 2)])


def row(name: str, folder: Path, prefix: Path, finer: str, seed: str, d: float, seconds: str = "") -> list:
    """The line of a run, as HEAD has it: volumes in m3, lengths in m."""
    from slope_tools.deposits import deposit, volume
    from slope_tools.mobility import run_length
    terrain = folder / "site" / "terrain.asc"
    about = volume.compute_removal(str(prefix), volume.Wanted(folder / "road.csv", 10.0, local=True), terrain).about
    summary = yaml.safe_load(Path(f"{prefix}.summary.yaml").read_text())
    body = yaml.safe_load((folder / "site" / "site.yaml").read_text())["found"]["body"]
    left = deposit.read_deposit(str(prefix), terrain, lambda said: None)
    balls, released = summary["balls"]["released"], summary["volume"]["released"]
    return [name, finer, seed, d, balls, body["mean_depth"] / d, about["volume"]["remove"],
            about["volume"]["remove_on_road"], about["divided"]["past"],
            run_length.measure_run_length(left, terrain).distance,
            summary["travel"]["centroid"], inertial_number(ALL[name], prefix, d, released / balls), released,
            summary["stop"]["time"], seconds]


# --- what slope study would say ---

def judge(path: Path) -> None:
    """Print the finest run of each slide beside what `slope study` says of finer balls by the three coarser sizes."""
    from slope_tools.statistics import ball_sizes
    with open(path, newline="", encoding="ascii") as lines:
        rows = list(csv.DictReader(lines))
    *sizes, finest = sorted({row["finer"] for row in rows}, key=float)
    print("quantity,case,balls_thick,mean,low,high,truth,within")
    for quantity in ("remove", "on_road", "beyond", "length"):
        inside = []
        for name in CASES:
            runs = {size: [row for row in rows if (row["case"], row["finer"]) == (name, size)]
                    for size in (*sizes, finest)}
            if not all(runs.values()):
                continue
            values = {size: [float(row[quantity]) for row in found] for size, found in runs.items()}
            steps = []
            for coarse, fine in zip(sizes, sizes[1:]):
                pairs = list(zip(values[coarse], values[fine]))
                first = runs[coarse][0]
                ball = 0.0 if quantity == "length" else float(first["released"]) / float(first["balls"])
                steps.append(ball_sizes.fit_step(*zip(*pairs), np.empty((len(pairs), 0)), float(fine) / float(coarse),
                                                 ball, steps[-1] if steps else None))
            left = ball_sizes.estimate_remaining_step(steps)
            mean, truth = (float(np.mean(values[size])) for size in (sizes[-1], finest))
            low, high = (mean * (1 + share) for share in ((left.low, left.high) if left else (-1.0, math.inf)))
            inside.append(low <= truth <= high)
            print(f"{quantity},{name},{float(runs[sizes[-1]][0]['balls_thick']):.1f},"
                  f"{mean:.5g},{low:.5g},{high:.5g},{truth:.5g},{inside[-1]}")
        print(f"{quantity}: {sum(inside)} of {len(inside)} within")


def main(words):
    if words == ["list"]:
        print(*CASES)
    elif words == ["head"]:
        print(HEAD)
    elif words[:1] == ["rolling"] and len(words) == 2:
        print(f"{ALL[words[1]].rolling:g}")
    elif words[:1] == ["judge"] and len(words) == 2:
        judge(Path(words[1]))
    elif words[:1] == ["site"] and len(words) == 3:
        make_site(ALL[words[1]], Path(words[2]))
    elif words[:1] == ["row"] and len(words) >= 7:
        values = row(words[1], Path(words[2]), Path(words[3]), words[4], words[5], float(words[6]), *words[7:])
        print(",".join(f"{value:.5g}" if isinstance(value, float) else str(value) for value in values))
    else:
        raise SystemExit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
