#!/usr/bin/python3
"""Run-out of cylinders that have collapsed: plot.py OUT...  (names that the deck was given as out)

Prints a, run-out and height over the radius, and the run-out measured by Lube et al.; then, of columns of one a and
several radii, the limit A of run-out = A + B d/r0 with its standard error, and A by other definitions of the front;
writes axisymmetric.png. Names with "glass" and "plane" (smooth floor) in them are drawn as such.
"""
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import axisymmetric as case, claims  # noqa: E402


def main(names):
    plt.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), constrained_layout=True)
    a = np.linspace(0.3, 3.3, 100)
    left.plot(a, [case.lube(one) for one in a], "C0", label="Lube et al. (2004)")
    left.plot(a, a, "C1", label="Lajeunesse et al. (2004)")
    groups = {}
    for name in names:
        start, end = (claims.read_claim_frames(Path(f"{name}.{when}.dump")) for when in ("start", "end"))
        radius, height = case.size(start)
        runout, left_high = case.runout_of(start, end), height_of(end) / radius
        print(f"{name}: a {height / radius:.2f}, r0 {radius:g} d, {len(end['x'][0])} balls: run-out {runout:.3f}, "
              f"height {left_high:.2f}; Lube {case.lube(height / radius):.2f}")
        kind = "glass" * ("glass" in name) or "sand", ", smooth floor" * ("plane" in name), round(height / radius, 2)
        groups.setdefault(kind, []).append((radius, start, end))
        style = {"color": "C1" if "glass" in name else "C0", "ms": radius / 3}
        left.plot(height / radius, runout, "s" if "plane" in name else "o", **style)
        right.plot(*case.profile(end, radius), color=style["color"], lw=0.4 + radius / 16)
    for (material, floor, a_), columns in groups.items():
        radii = [radius for radius, _, _ in columns]
        if len(radii) < 3 or len(set(radii)) < 2:
            continue
        lines = {cover: case.line_of(radii, [case.runout_between(start, end, cover) for _, start, end in columns])
                 for cover in case.COVERS}
        line = lines[case.COVER]
        others = ", ".join(f"{lines[cover].limit:.2f} at {100 * cover:g} % of a layer" for cover in case.COVERS)
        print(f"{material}{floor}, a {a_:g}: limit {line.limit:.3f} +- {line.error:.3f} ({others}), "
              f"B {line.slope:.2f}, of {len(radii)} columns; at r0 32 d {line.at(32):.2f}")
    left.plot([], [], "ko", ms=4, label="SLOPE, larger: more balls")
    left.plot([], [], "ks", ms=4, label="smooth floor")
    left.set(xlabel="height / radius of the column, a", ylabel="run-out / radius", xlim=(0, None), ylim=(0, None))
    right.set(xlabel="r / radius of the column", ylabel="height / radius", xlim=(0, None), ylim=(0, None))
    left.legend(frameon=False)
    figure.savefig("axisymmetric.png", dpi=140)


def height_of(balls, within=2.0):
    """Of the deposit at its axis, in diameters."""
    away, height = case.tops(balls)
    return height[away < within].mean()


if __name__ == "__main__":
    main(sys.argv[1:] or ["cylinder"])
