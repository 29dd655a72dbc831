#!/usr/bin/python3
"""Alumina on glass: plot.py DUMP...  prints and draws spin and contact against the angle; writes spin.png."""
import sys
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from slope_tools.validation.verification import claims, oblique_impact as case  # noqa: E402

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3), constrained_layout=True)
for path in sys.argv[1:]:
    balls = claims.read_claim_frames(path)
    theta, spin, vx, v = balls["v_theta"][0], balls["omegay"][-1], balls["vx"], -balls["vz"][0]
    contact = (vx[-1] - case.RADIUS * spin) / np.where(theta > 0, vx[0], np.nan)
    slides = 2.5 * case.MU * (1 + case.E) * v / case.RADIUS
    print("angle, spin, spin if it slides throughout, tangential velocity at the contact after over before")
    print(np.column_stack([theta, spin, slides, contact]).round(3))
    left.plot(theta, spin, "o", theta, slides, "-", ms=3)
    right.plot(theta, contact, "o", ms=3)
left.axhline(610, color="0.6", lw=0.8)
left.set(xlabel="angle from the normal, degrees", ylabel="spin after, rad/s")
right.set(xlabel="angle from the normal, degrees", ylabel="velocity at the contact, after / before")
figure.savefig("spin.png", dpi=120)
