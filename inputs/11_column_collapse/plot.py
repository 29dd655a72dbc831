#!/usr/bin/python3
"""Run-out and shape of columns that have collapsed: plot.py OUT...  (names that the deck was given as out)

Prints a, run-out over length and the published range; writes column_collapse.png.
"""
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims, column_collapse as case  # noqa: E402


def profile(balls, quantile=0.98):
    """x and height of the surface in diameters, slice by slice."""
    x, z = balls["x"][0] / case.D, balls["z"][0] / case.D
    slices = [left for left in range(int(x.max()) + 1) if (np.floor(x) == left).any()]
    return [left + 0.5 for left in slices], [np.quantile(z[np.floor(x) == left], quantile) for left in slices]


def main(names):
    plt.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), constrained_layout=True)
    a = np.geomspace(0.35, 12, 200)
    for law, name, colour in ((case.LUBE, "Lube et al.", "#1b6ca8"), (case.LAJEUNESSE, "Lajeunesse et al.", "#d1603d")):
        left.loglog(a, [case.law(one, law) if not 2.7 < one < 3.3 else np.nan for one in a], color=colour, label=name)
    for name in names:
        start, end = (claims.read_claim_frames(Path(f"{name}.{when}.dump")) for when in ("start", "end"))
        length, height = case.size(start)
        got = case.runout_of(start, end)
        low, high = (case.law(height / length, law) for law in (case.LUBE, case.LAJEUNESSE))
        print(f"a {height / length:.2f}: run-out {got:.3f}, published {low:.2f} to {high:.2f}")
        left.plot(height / length, got, "ko", ms=5)
        x, z = profile(end)
        right.plot(np.array(x) / length, np.array(z) / length, label=f"a {height / length:.1f}")
    left.plot([], [], "ko", ms=5, label="SLOPE")
    left.set(xlabel="height / length of the column, a", ylabel="run-out / length")
    right.set(xlabel="x / length of the column", ylabel="height / length", ylim=(0, None), xlim=(0, None))
    for axes in (left, right):
        axes.legend(frameon=False)
    left.set_xticks([0.5, 1, 2, 4, 8], ["0.5", "1", "2", "4", "8"])
    left.set_yticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    left.minorticks_off()
    figure.savefig("column_collapse.png", dpi=160)


if __name__ == "__main__":
    main(sys.argv[1:] or ["column"])
