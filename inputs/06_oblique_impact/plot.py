#!/usr/bin/python3
"""Alumina on glass: runs both decks of the README, prints the spins, writes spin.png. Argument: the program."""
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims, oblique_impact as case  # noqa: E402

LMP = sys.argv[1] if len(sys.argv) > 1 else "lmp"
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3), constrained_layout=True)
for run, mark in ((case.ALUMINA(first=0, each=5), "o"), (case.ALUMINA, ".")):
    with tempfile.TemporaryDirectory() as top:
        folder = Path(top) / "run"
        run.write(folder)
        subprocess.run([LMP, "-in", run.source.name, *run.options], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        balls = case.frames(claims.Result(folder))
    theta, spin, vx = balls["v_theta"][0], balls["omegay"][-1], balls["vx"]
    contact = (vx[-1] - case.RADIUS * spin)[theta > 0] / vx[0][theta > 0]
    slides = 2.5 * case.MU * (1 + case.E) * -balls["vz"][0] / case.RADIUS
    print("theta, spin, sliding throughout, contact:")
    print(np.column_stack([theta[theta > 0], spin[theta > 0], slides[theta > 0], contact]).round(3))
    left.plot(theta, spin, mark, color="#1b6ca8")
    right.plot(theta[theta > 0], contact, mark, color="#1b6ca8")
    left.plot(theta, slides, color="#d1603d", label="slides throughout" if mark == "o" else None)
left.axhline(610, color="0.6", lw=0.8, label="another code, largest")
left.legend(frameon=False)
left.set(xlabel="angle from the normal, degrees", ylabel="spin after, rad/s")
right.set(xlabel="angle from the normal, degrees", ylabel="velocity at the contact, after / before")
figure.savefig("spin.png", dpi=160)
