#!/usr/bin/python3
"""Angles and shapes of heaps: plot.py OUT...  (names that the deck was given as out, HEAP_SEED); writes heap.png, of
seed 1, and heaps.csv."""
import csv
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims, heap as case  # noqa: E402


def main(names):
    plt.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(figsize=(5.2, 3.4), constrained_layout=True)
    rows = []
    for name in names:
        before, after = (claims.read_claim_frames(Path(f"{name}.{when}.dump")) for when in (1, 2))
        angles, way = [case.angle_of(balls) for balls in (before, after)], case.creep_of(before, after)
        heap, _, seed = name.partition("_")
        rows.append((heap, seed or "1", *(f"{angle:.4f}" for angle in angles), f"{way:.3g}"))
        print(f"{name}: {angles[0]:.1f}, then {angles[1]:.1f} degrees; {after['id'].size} balls; "
              f"median way between, in diameters: {way:.2g}")
        if seed in ("", "1"):
            points = case.tops(after)
            line, = axes.plot(*points.T, "o", ms=4, label=f"{heap}: {angles[1]:.1f} degrees")
            axes.plot(points[:, 0], np.polyval(np.polyfit(*points.T, 1), points[:, 0]), color=line.get_color(), lw=1)
    with open("heaps.csv", "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([("heap", "seed", "first_deg", "angle_deg", "way_d"), *rows])
    axes.set(xlabel="x / diameter", ylabel="height of the surface / diameter", aspect="equal",
             xlim=(0, None), ylim=(0, None))
    axes.legend(frameon=False)
    figure.savefig("heap.png", dpi=160)


if __name__ == "__main__":
    main(sys.argv[1:] or ["heap"])
