#!/usr/bin/python3
"""Angles of heaps: plot.py OUT=THICKNESS[,D]...  (OUT: name that the deck was given; THICKNESS no: periodic; D: mm)

Prints both flanks and the measured angle; writes repose.png.
"""
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims, repose_walls as case  # noqa: E402

FAR = 13                # d, where the heaps without walls are drawn


def main(wanted):
    plt.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2), constrained_layout=True)
    for one in wanted:
        name, about = one.split("=")
        about, _, d = about.partition(",")
        d, thickness = float(d or 10), None if about == "no" else float(about)
        beads = claims.read_claim_frames(Path(f"{name}.dump"))
        plate = case.PLATE * 10 / d
        angles, measured = case.angles_of(beads, d / 1000, plate), case.measure_repose_angle(d, thickness)
        print(f"{name}: {len(beads['x'][0])} beads, flanks {angles[0]:.1f} and {angles[1]:.1f}, "
              f"mean {np.mean(angles):.1f}, measured {measured:.1f} degrees")
        if d == 10:
            colour = {4: "C0", 8: "C1"}.get(thickness, "C2")
            left.plot(*case.surface(*(beads[axis][0] / 0.01 for axis in "xyz")).T, color=colour, lw=0.8)
            right.plot(thickness or FAR, np.mean(angles), "o", color=colour, ms=4)
    thickness = np.linspace(3, 10, 50)
    right.plot(thickness, case.measure_repose_angle(10, thickness), "k", label="measured, Zhou et al. (2002)")
    right.plot(FAR, case.measure_repose_angle(10), "k_", ms=14)
    right.plot([], [], "o", color="grey", ms=4, label="SLOPE")
    left.set(xlabel="x / d", ylabel="height / d", aspect="equal", ylim=(0, None))
    right.set(xlabel="thickness / d", ylabel="angle, degrees", ylim=(10, 34))
    right.set_xticks([4, 6, 8, 10, FAR], ["4", "6", "8", "10", "periodic"])
    right.legend(frameon=False, loc="lower left")
    figure.savefig("repose.png", dpi=140)


if __name__ == "__main__":
    main(sys.argv[1:] or ["repose=4"])
