#!/usr/bin/python3
"""Profiles of beds that have spread: plot.py OUT...  (names that the deck was given as out)

Writes flume.png; crosses are what was measured.
"""
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims, flume as case  # noqa: E402

MEASURED = {(0.6, 0.2): ([0.4, 0.8], [0.2, 0.025]), (0.6, 0.4): ([1.1], [0]), (0.2, 0.14): ([0.02, 0.475], [0.14, 0])}


def main(names):
    plt.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(figsize=(8, 3), constrained_layout=True)
    for name in names:
        start, end = (claims.read_claim_frames(Path(f"{name}.{when}.dump")) for when in ("start", "end"))
        length = round(start["x"].max() + case.NEAR / 4, 1)
        height = min((bed[1] for bed in MEASURED if bed[0] == length), key=lambda z: abs(z - start["z"].max()))
        x = np.arange(case.NEAR, end["x"].max(), case.NEAR)
        z = [case.thickness_of(start, end, length, height, place) for place in x]
        line, = axes.plot(x, z, label=name)
        axes.plot(*MEASURED[length, height], "x", color=line.get_color())
        print(name, *(f"{place:.2f} m: {deep:.4f}" for place, deep in zip(x, z)))
    axes.set(xlabel="m from the back", ylabel="thickness, m", ylim=(0, None), xlim=(0, 1.5))
    axes.legend(frameon=False)
    figure.savefig("flume.png", dpi=160)


if __name__ == "__main__":
    main(sys.argv[1:] or ["flume"])
