#!/usr/bin/python3
"""Force on the wall over time: plot.py LABEL=FILE.csv...; writes wall_force.png."""
import sys

import numpy as np
from matplotlib import pyplot as plt

figure, ax = plt.subplots(figsize=(6, 3), constrained_layout=True)
for label, path in (word.split("=") for word in sys.argv[1:]):
    ax.plot(*np.genfromtxt(path, delimiter=",", skip_header=1).T, label=label)
ax.set(xlabel="s since the gate opened", ylabel="force, mean of 10 ms, N")
ax.legend(frameon=False)
figure.savefig("wall_force.png", dpi=120)
