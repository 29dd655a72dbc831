#!/usr/bin/python3
"""Where the bodies come to rest: plot.py FOLDER...  (runs, named GROUND_AZIMUTH_SEED, both azimuths of each seed).

Writes pyramid.png, of the first ground's seed 1, travel.csv, a line for each body, and spread.csv, one for each ground.
"""
import csv
import sys
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims, pyramid  # noqa: E402


def draw(folders):
    figure, axes = plt.subplots(1, 2, figsize=(8, 4), constrained_layout=True, sharey=True)
    for ax, folder in zip(axes, folders):
        for when, colour in (("start", "0.7"), ("end", "#1b6ca8")):
            balls = claims.Result(folder).frames(f"pyramid.{when}.dump")
            ax.plot(balls["x"][0], balls["y"][0], ".", ms=1, color=colour)
        ax.set(xlabel="x, m", aspect="equal")
    figure.savefig("pyramid.png", dpi=120)


def write(path, head, rows):
    with open(path, "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *rows])


def main(folders):
    runs = [folder.split("_") for folder in folders]
    bodies, spreads = [], []
    for ground in dict.fromkeys(run[0] for run in runs):
        seeds = sorted({run[2] for run in runs if run[0] == ground})
        results = [claims.Result(f"{ground}_{azimuth}_{seed}") for azimuth in pyramid.AZIMUTHS for seed in seeds]
        travel, aside = pyramid.travels(results)
        bodies += [(ground, azimuth, face, seed, f"{travel[i, j, k]:.2f}", f"{aside[i, j, k]:.2f}")
                   for i, azimuth in enumerate(pyramid.AZIMUTHS) for j, seed in enumerate(seeds)
                   for k, face in enumerate(pyramid.FACES)]
        means, aside = travel.mean(axis=(1, 2)), np.abs(aside.mean(axis=1)).max()
        spreads.append((ground, *(f"{share:.5f}" for share in (pyramid.measure_face_spread(*results),
                                                               means[1] / means[0] - 1, aside / means.mean())),
                        f"{aside:.2f}"))
    write("travel.csv", ("ground", "azimuth", "face", "seed", "travel_m", "aside_m"), bodies)
    write("spread.csv", ("ground", "largest", "longer_at_45", "aside", "aside_m"), spreads)
    print(Path("spread.csv").read_text(encoding="utf-8"), end="")
    draw([f"{runs[0][0]}_{azimuth}_1" for azimuth in pyramid.AZIMUTHS])


if __name__ == "__main__":
    main(sys.argv[1:])
