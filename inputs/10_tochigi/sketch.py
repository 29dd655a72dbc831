#!/usr/bin/env python3
"""Draw in.tochigi to sketch.png: lengths as it reads them, and the rocks of tochigi.<seed>.*.dump where there are."""

import glob
import math
import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Polygon, Rectangle

DECK = (Path(__file__).parent / "in.tochigi").read_text(encoding="ascii")


def length(name):
    """A variable of the deck, m."""
    return float(re.search(rf"^variable {name} +index (\S+)", DECK, re.MULTILINE)[1])


def places(path):
    """x y z of the rocks in a dump of id type diameter x y z ..."""
    return np.loadtxt(path, skiprows=9)[:, 3:6]


def measure(axes, start, end, text, away):
    """A dimension line with its length in cm."""
    axes.annotate("", start, end, arrowprops={"arrowstyle": "<->", "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0})
    middle = np.add(start, end) / 2
    axes.annotate(text, middle, xytext=away, textcoords="offset points", ha="center", va="center", fontsize=8)


def draw_side(axes, run, platform, rise, door, box):
    axes.add_patch(Polygon([(-1.2, 0), (0, 0), (run, rise), (run + platform, rise), (run + platform, -0.12),
                            (-1.2, -0.12)], closed=True, facecolor="#d5d5d5", edgecolor="black", linewidth=0.8))
    top = rise + 0.1
    for x, y, style in ((door, door * rise / run, "--"), (run, rise, "-")):
        axes.plot([x, x], [y, top], "k", linewidth=1.2, linestyle=style)
    axes.plot(door, top, "ko", markersize=4)
    axes.annotate("hinge; the door is taken away", (door, top), xytext=(-12, -12), textcoords="offset points",
                  fontsize=8, ha="right")
    axes.plot([door, run], [door * rise / run, rise], color="tab:red", linewidth=2.5)
    axes.annotate("release surface,\nno friction", ((door + run) / 2, (door + run) / 2 * rise / run), fontsize=8,
                  xytext=(45, -32), textcoords="offset points", color="tab:red", ha="center",
                  arrowprops={"arrowstyle": "-", "color": "tab:red", "linewidth": 0.7})
    normal = np.array([-rise, run]) / math.hypot(rise, run) * 0.55
    measure(axes, np.add((door, door * rise / run), normal), np.add((run, rise), normal), f"{100 * box:g}", (-8, 8))
    measure(axes, (0, -0.22), (run, -0.22), f"{100 * run:g}", (0, -8))
    measure(axes, (run, -0.22), (run + platform, -0.22), f"{100 * platform:g}", (0, -8))
    measure(axes, (-0.91, -0.22), (0, -0.22), "91", (0, -8))
    measure(axes, (-0.91, -0.5), (run + platform, -0.5), "350", (0, -8))
    axes.annotate(f"{length('angle'):g} deg", (0.28, 0.07), fontsize=8)
    axes.annotate("x = 0", (0, 0), xytext=(-4, 6), textcoords="offset points", fontsize=8, ha="right")
    for path in sorted(glob.glob("tochigi.1.start.dump")):
        axes.plot(*places(path)[:, [0, 2]].T, "o", markersize=3, color="tab:blue", alpha=0.5)
    axes.set(xlim=(-1.4, 2.8), ylim=(-0.75, 2.1), aspect="equal", xlabel="x (m)", ylabel="z (m)", title="side")


def draw_plan(axes, run, platform, door):
    width, broad = length("width"), length("broad")
    axes.add_patch(Rectangle((0, -width / 2), run + platform, width, facecolor="#d5d5d5", edgecolor="black",
                             linewidth=0.8))
    axes.plot([run, run], [-width / 2, width / 2], "k", linewidth=0.6)
    axes.add_patch(Rectangle((door, -broad / 2), run - door, broad, facecolor="none", edgecolor="tab:red", linewidth=2))
    measure(axes, (run + 0.25, -broad / 2), (run + 0.25, broad / 2), f"{100 * broad:g}", (10, 0))
    measure(axes, (3.0, -width / 2), (3.0, width / 2), f"{100 * width:g}", (12, 0))
    for side in (1, -1):
        measure(axes, (3.0, side * width / 2), (3.0, side * 1.45), "55", (10, 0))
    measure(axes, (3.9, -1.45), (3.9, 1.45), "290", (12, 0))
    found = sorted(glob.glob("tochigi.*.rest.dump"))
    if found:
        rest = np.concatenate([places(path) for path in found])
        axes.plot(*rest[:, :2].T, ".", markersize=3, color="tab:blue", alpha=0.4)
    axes.set(xlim=(-5, 4.6), ylim=(-4, 4), aspect="equal", xlabel="x (m)", ylabel="y (m)",
             title=f"plan; rocks at rest, {len(found)} seeds" if found else "plan")


def main():
    run, platform, box = length("run"), length("platform"), length("length")
    slope = math.radians(length("angle"))
    figure, (side, plan) = plt.subplots(1, 2, figsize=(13, 5.2))
    draw_side(side, run, platform, run * math.tan(slope), run - box * math.cos(slope), box)
    draw_plan(plan, run, platform, run - box * math.cos(slope))
    figure.tight_layout()
    figure.savefig("sketch.png", dpi=80)


if __name__ == "__main__":
    main()
