#!/usr/bin/env python3
"""Plot the curves of in.timestep (timestep.<dt>.csv in the working directory) to timestep.png."""

import glob
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np


def main():
    steps = sorted((name.split(".", 1)[1][:-4] for name in glob.glob("timestep.*.csv")), key=float)
    if not steps:
        sys.exit("plot.py: no timestep.<dt>.csv here, run lmp -in in.timestep first")

    figure, (all_steps, longest) = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True)
    for step in steps:
        curve = np.genfromtxt(f"timestep.{step}.csv", delimiter=",", names=True)
        all_steps.plot(curve["time"], curve["height"], label=f"dt = {step} s", linewidth=1)
    all_steps.set(title="ball 1", xlabel="time (s)", ylabel="height above first touch (m)")
    all_steps.legend(fontsize=8)

    longest.fill_between(curve["time"], curve["lowest"], curve["highest"], alpha=0.3, label="nine balls")
    longest.plot(curve["time"], curve["height"], linewidth=1, label="ball 1")
    longest.set(title=f"dt = {steps[-1]} s: drop heights differ by 1.7 mm", xlabel="time (s)")
    longest.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig("timestep.png", dpi=80)


if __name__ == "__main__":
    main()
