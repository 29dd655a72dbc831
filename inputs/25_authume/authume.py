#!/usr/bin/python3
"""Authume's blocks: fit of the rolling resistance on profile 1, prediction of profile 2, sensitivities.

    authume.py fit|predict|sensitivity [-o FOLDER] [--jobs J]
    authume.py compare ENDPOINTS [-o FOLDER]      measured end points of profile 2 against the prediction

SLOPE_DATA names the folder with authume/, the public data (README.md says where they are from); without them nothing is
done. LMP names the program, otherwise build/lmp.
"""
import argparse
import csv
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import shapely.geometry
import shapely.ops
from scipy import ndimage

HERE = Path(__file__).resolve().parent
LMP = os.environ.get("LMP", str(HERE.parents[1] / "build" / "lmp"))
DATA = Path(os.environ.get("SLOPE_DATA", HERE.parents[2] / "shared" / "data")) / "authume"
ZONES = {"vegetated": "DTM_Blue_zone.stl", "hard": "DTM_Gray_zone.stl", "red": "DTM_Red_zone.stl"}
FILES = *ZONES.values(), "positions_P1.xyz", "positions_P2.xyz", "Endpoints_P1.txt"
CELL = 0.5                      # m, of the raster: the distance of the survey's points
SEEDS = 1, 2, 3, 4, 5
ROLLING = [round(0.01 * k, 2) for k in range(10, 21)]
SHARES = 0.05, 0.25, 0.5, 0.75, 0.95
DENSITY = 2600                  # kg/m3
DRAWS = 1000                    # samples with replacement
BLOCKS_P2 = 48                  # of the experiment on profile 2


# --- the data: y is up in them, here z is; along is x in both, across is their z ---

def triangles(path):
    """Corners of an ASCII STL: (n, 3, 3), x y z of the deck."""
    words = [line.split()[1:4] for line in path.read_text().splitlines() if line.split()[:1] == ["vertex"]]
    return np.array(words, float).reshape(-1, 3, 3)[:, :, [0, 2, 1]]


def heights(faces, low, shape):
    """Highest surface at the middles of cells, rows from the south; NaN where there is none."""
    found = np.full(shape, -np.inf)
    for face in faces:
        (x0, y0), (x1, y1) = ((edge(face[:, :2], axis=0) - low) / CELL - 0.5 for edge in (np.min, np.max))
        i, j = (np.arange(max(0, int(np.ceil(a))), int(np.floor(b)) + 1) for a, b in ((x0, x1), (y0, y1)))
        if not len(i) or not len(j):
            continue
        normal = np.cross(face[1] - face[0], face[2] - face[0])
        if abs(normal[2]) < 1e-9:
            continue
        x, y = np.meshgrid(low[0] + (i + 0.5) * CELL, low[1] + (j + 0.5) * CELL)
        parts = [((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) * np.sign(normal[2])
                 for a, b in zip(face, np.roll(face, -1, axis=0))]
        inside = np.all([part >= -1e-6 for part in parts], axis=0)
        z = face[0, 2] - (normal[0] * (x - face[0, 0]) + normal[1] * (y - face[0, 1])) / normal[2]
        part = found[j[0]:j[-1] + 1, i[0]:i[-1] + 1]
        part[inside] = np.maximum(part[inside], z[inside])
    return np.where(np.isfinite(found), found, np.nan)


def filled(values):
    """Holes of the survey have the height of the nearest cell; beyond its outline there is no ground."""
    known = np.isfinite(values)
    nearest = ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
    return np.where(ndimage.binary_fill_holes(known), values[tuple(nearest)], np.nan)


def prepare(folder):
    """terrain.asc, vegetated.csv and red.csv."""
    zones = {name: triangles(DATA / file) for name, file in ZONES.items()}
    every = np.concatenate(list(zones.values()))
    low = np.floor(every[:, :, :2].min(axis=(0, 1)))
    shape = np.ceil((every[:, :, :2].max(axis=(0, 1)) - low) / CELL).astype(int)[::-1]
    ground = filled(heights(every, low, shape))
    lines = [f"ncols {shape[1]}", f"nrows {shape[0]}", f"xllcorner {low[0]:g}", f"yllcorner {low[1]:g}",
             f"cellsize {CELL:g}", "NODATA_value -9999"]
    lines += [" ".join("-9999" if np.isnan(z) else f"{z:.3f}" for z in row) for row in ground[::-1]]
    (folder / "terrain.asc").write_text("\n".join(lines) + "\n", encoding="ascii")
    for name in ("vegetated", "red"):
        plan = [shapely.geometry.Polygon(face[:, :2]).buffer(0.01) for face in zones[name]]
        whole = shapely.ops.unary_union(plan).simplify(0.02)
        parts = [one.exterior for one in getattr(whole, "geoms", [whole]) if one.area > 1]
        (folder / f"{name}.csv").write_text("\n\n".join(
            "\n".join(f"{x:.3f},{y:.3f}" for x, y in ring.coords[:-1]) for ring in parts) + "\n", encoding="ascii")


def middle(profile):
    """Middle of a drop zone, x y z of the deck."""
    return np.loadtxt(DATA / f"positions_P{profile}.xyz")[:, [0, 2, 1]].mean(axis=0)


def measured(path, profile):
    """End points from the middle of the drop zone, along and across, m; masses, kg."""
    rows = np.loadtxt(path)
    return rows[:, [0, 2]] - middle(profile)[:2], rows[:, 3]


# --- runs ---

def balls(path):
    """Lines of a dump, sorted by id: id, type, diameter, x, y, z, ...; none, where all have left the terrain."""
    rows = [line.split() for line in path.read_text().splitlines()[9:]]
    return np.array(rows, float) if rows else np.empty((0, 9))


def run(folder, name, profile=1, sizes=None, **variables):
    """End points from the middle of the drop zone, along and across, m; infinite: the block left the terrain."""
    run_folder = folder / name
    run_folder.mkdir(exist_ok=True)
    for file in ("terrain.asc", "vegetated.csv", "red.csv"):
        (run_folder / file).unlink(missing_ok=True)
        (run_folder / file).symlink_to(folder / file)
    if sizes is not None:
        (run_folder / "sizes").write_text(f"{len(sizes)}\n" + "".join(f"{k} {d:.4f}\n" for k, d in enumerate(sizes, 1)))
        variables.update(sizes="sizes", smallest=round(float(sizes.min()), 4), blocks=len(sizes))
    at = dict(zip(("x0", "y0", "z0"), middle(profile).round(2)), **variables)
    at["z0"] -= at.pop("lower", 0)
    words = [word for key, value in at.items() for word in ("-var", key, str(value))]
    done = subprocess.run([LMP, "-in", str(HERE / "in.authume"), "-log", "log.authume", "-screen", "none", *words],
                          cwd=run_folder, check=False)
    if done.returncode:
        sys.exit(f"{run_folder}/log.authume: the run must end without an error, see its last lines")
    start, rest = (balls(run_folder / f"authume.{when}.dump") for when in ("start", "rest"))
    ends = np.full((len(start), 2), np.inf)
    ends[np.searchsorted(start[:, 0], rest[:, 0])] = rest[:, 3:5] - (at["x0"], at["y0"])
    return ends


def runs(folder, jobs, cases):
    """End points of each case and seed: {name: [ends]}."""
    todo = [(name, seed) for name in cases for seed in SEEDS]
    with ThreadPoolExecutor(jobs) as pool:
        ends = list(pool.map(lambda one: run(folder, f"{one[0]}.{one[1]}", seed=one[1], **cases[one[0]]), todo))
    return {name: [found for (of, _), found in zip(todo, ends) if of == name] for name in cases}


def distance(one, other):
    """The largest difference of two cumulative distributions (Kolmogorov and Smirnov)."""
    at = np.concatenate([one, other])
    below = [np.searchsorted(np.sort(values), at, "right") / len(values) for values in (one, other)]
    return float(np.abs(below[0] - below[1]).max())


def quantiles(ends):
    """Those of all seeds, along and across; across of the blocks that stay on the terrain."""
    every = np.concatenate(ends)
    stay = np.isfinite(every[:, 0])
    return [np.quantile(values, SHARES, method="inverted_cdf") for values in (every[:, 0], every[stay, 1])]


HEAD = ["case", *(f"along_{100 * share:.0f}" for share in SHARES), *(f"across_{100 * share:.0f}" for share in SHARES),
        "sd_across", "left", "distance_along", "lowest", "highest", "distance_across"]


def row(name, ends, truth):
    """A line of a table."""
    every = np.concatenate(ends)
    stay = every[np.isfinite(every[:, 0])]
    words = [name, *(f"{x:.1f}" for part in quantiles(ends) for x in part), f"{stay[:, 1].std():.1f}",
             f"{1 - len(stay) / len(every):.3f}"]
    if truth is not None:
        along = [distance(one[:, 0], truth[:, 0]) for one in ends]
        across = [distance(one[np.isfinite(one[:, 0]), 1], truth[:, 1]) for one in ends]
        words += [f"{np.mean(along):.3f}", f"{min(along):.3f}", f"{max(along):.3f}", f"{np.mean(across):.3f}"]
    return words


def tell(path, rows, head=HEAD):
    with open(path, "w", encoding="ascii", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])
    print(path.read_text(), end="")


# --- what is asked ---

def fit(folder, jobs):
    truth, _ = measured(DATA / "Endpoints_P1.txt", 1)
    found = runs(folder, jobs, {f"rolling {mu:.2f}": {"rolling": mu} for mu in ROLLING})
    rows = [row(name, ends, truth) for name, ends in found.items()]
    tell(folder / "fit.csv", [row("measured", [truth], None), *rows])
    others = [truth[chosen, 0] for chosen in np.random.default_rng(1).integers(0, len(truth), (DRAWS, len(truth)))]
    least = [min(found, key=lambda name: np.mean([distance(one[:, 0], other) for one in found[name]]))
             for other in others]
    tell(folder / "fit_again.csv", [[name, f"{least.count(name) / DRAWS:.3f}"] for name in found],
         ["least in a share of samples of the measured blocks", "share"])
    median = np.quantile([np.median(other) for other in others], (0.05, 0.95))
    print(f"median of the measured blocks: {median[0]:.1f} to {median[1]:.1f} m (90 %)")


def predict(folder, jobs):
    """Profile 2 with the deck's defaults, the values of the fit."""
    found = runs(folder, jobs, {"profile 2": {"profile": 2}})["profile 2"]
    every, each = np.concatenate(found), [quantiles([one]) for one in found]
    draws = np.random.default_rng(1).integers(0, len(every), (DRAWS, BLOCKS_P2))
    low, high = np.quantile([quantiles([every[chosen]]) for chosen in draws], (0.05, 0.95), axis=0)
    rows = [[name, f"{share:g}", *(f"{value:.1f}" for value in (
        quantiles(found)[k][m], min(one[k][m] for one in each), max(one[k][m] for one in each), low[k][m], high[k][m]))]
        for k, name in enumerate(("along", "across")) for m, share in enumerate(SHARES)]
    left = [np.isinf(one[:, 0]).mean() for one in found]
    rows.append(["left the terrain", "", f"{np.mean(left):.3f}", f"{min(left):.3f}", f"{max(left):.3f}", "", ""])
    tell(folder / "prediction_P2.csv", rows, ["direction", "share", "all_m", "lowest_seed_m", "highest_seed_m",
                                              f"sample_of_{BLOCKS_P2}_low_m", f"sample_of_{BLOCKS_P2}_high_m"])
    np.savetxt(folder / "ends_P2.txt", np.concatenate(found), "%.2f")


def sensitivity(folder, jobs):
    truth, masses = measured(DATA / "Endpoints_P1.txt", 1)
    sizes = np.resize((6 * masses / (np.pi * DENSITY)) ** (1 / 3), 205)        # five times the 41 blocks
    close = round(0.9 * (0.8 + float(sizes.min())) / 2 / 0.8, 3)                # for the smallest block
    cases = {
        "as fitted": {}, "e 0.48, rolling 0": {"e": 0.48, "rolling": 0}, "e 0.48": {"e": 0.48},
        "rolling 0.05": {"rolling": 0.05}, "d 0.65 m": {"d": 0.65}, "d 0.95 m": {"d": 0.95},
        f"measured masses, spacing {close}": {"sizes": sizes, "spacing": close, "field_d": 0.8},
        f"d 0.80 m, spacing {close}": {"spacing": close},
        "shovel 2.5 m lower": {"lower": 2.5},
        "zones as mapped": {"zones": "yes"},
        "zones, hard e 0.3": {"zones": "yes", "e": 0.3, "vegetated_e": 0.1, "red_e": 0.1},
        "zones, hard rolling 0.10": {"zones": "yes", "rolling": 0.10, "vegetated_rolling": 0.15, "red_rolling": 0.15},
        "zones, vegetated rolling 0.20": {"zones": "yes", "vegetated_rolling": 0.20}}
    found = runs(folder, jobs, cases)
    tell(folder / "sensitivity.csv", [row(name, ends, truth) for name, ends in found.items()])


def compare(folder, path):
    """Measured end points of profile 2 against those of predict."""
    truth, _ = measured(path, 2)
    ends = np.loadtxt(folder / "ends_P2.txt").reshape(len(SEEDS), -1, 2)
    tell(folder / "compare_P2.csv", [row("measured", [truth], None), row("predicted", list(ends), truth)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("fit", "predict", "sensitivity", "compare"))
    parser.add_argument("endpoints", type=Path, nargs="?")
    parser.add_argument("-o", dest="folder", type=Path, default=Path("authume"))
    parser.add_argument("--jobs", type=int, default=1)
    args = parser.parse_args()
    missing = [name for name in FILES if not (DATA / name).is_file()]
    if missing:
        print(f"25_authume skipped: {DATA / missing[0]} must be an existing file (SLOPE_DATA): see README.md")
        return
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    if args.what == "compare":
        if args.endpoints is None or not args.endpoints.is_file():
            parser.error("ENDPOINTS must be an existing file: x, y (up), z, mass in its lines")
        return compare(folder, args.endpoints)
    prepare(folder)
    globals()[args.what](folder, args.jobs)


if __name__ == "__main__":
    main()
