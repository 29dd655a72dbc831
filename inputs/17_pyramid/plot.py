#!/usr/bin/python3
"""Where the bodies come to rest: plot.py FOLDER...  (runs at azimuths of 0 and 45 degrees); writes pyramid.png."""
import sys
from pathlib import Path

from matplotlib import pyplot as plt

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims  # noqa: E402

figure, axes = plt.subplots(1, len(sys.argv) - 1, figsize=(8, 4), constrained_layout=True, sharey=True)
for ax, folder in zip(axes, sys.argv[1:]):
    for when, colour in (("start", "0.7"), ("end", "#1b6ca8")):
        balls = claims.Result(folder).frames(f"pyramid.{when}.dump")
        ax.plot(balls["x"][0], balls["y"][0], ".", ms=1, color=colour)
    ax.set(xlabel="x, m", aspect="equal")
figure.savefig("pyramid.png", dpi=120)
