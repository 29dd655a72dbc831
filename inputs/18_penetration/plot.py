#!/usr/bin/python3
"""Way and speed of the steel ball: plot.py LABEL=LOG...  (log files of LAMMPS); writes penetration.png."""
import re
import sys
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

figure, axes = plt.subplots(1, 2, figsize=(8, 3), constrained_layout=True)
for style, (label, path) in zip(("-", "--"), (word.split("=") for word in sys.argv[1:])):
    table = re.search(r"Step +Time .*v_velocity *\n(.*?)Loop", Path(path).read_text(), re.DOTALL)
    time, way, speed = np.loadtxt(table[1].splitlines(), usecols=(1, 4, 5)).T
    time, way = time - time[0], way - way[0]
    for axis, values in zip(axes, (1000 * way, speed)):
        axis.plot(1000 * time, values, style, label=label)
axes[0].set(xlabel="ms", ylabel="way of the steel ball, mm")
axes[1].set(xlabel="ms", ylabel="speed, m/s")
axes[0].legend(frameon=False)
figure.savefig("penetration.png", dpi=120)
