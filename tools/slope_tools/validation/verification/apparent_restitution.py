"""A ball that falls on fixed balls at a random place rebounds with less than the restitution

inputs/05_apparent_restitution: balls that fall on the balls of a plan grid. The closed form is that of a hard ball: the
claims are made with balls a hundred times as stiff as the case's and nearly without weight.
"""
import importlib.util

import numpy as np

from .claims import AtMost, Claim, Control, INPUTS, Run

CASE = "05_apparent_restitution"
HARD = Run("05_apparent_restitution/in.apparent_restitution")(
    balls=300, spacing=1.4, kn=3.67e9, dt=1e-6, tdump=1e-4, tend=0.04, g=0.1)
SOURCE = "paper, section 3: e cos^2(b) - sin^2(b) after a frictionless impact at b from the top"


def drops(result):
    """What the case's own plot.py reads."""
    spec = importlib.util.spec_from_file_location("plot_apparent_restitution", INPUTS / CASE / "plot.py")
    assert spec and spec.loader
    plot = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(plot)
    return plot.read(str(result.folder / "bounce"))


def error(e):
    """Largest difference of a ball from the closed form, of those whose first contact is with one fixed ball alone."""
    def largest(result):
        drop, = drops(result)
        at = drop.r[drop.alone]
        return np.abs(drop.first[drop.alone] - (e * (1 - at ** 2) - at ** 2)).max()
    return largest


CLAIMS = [
    Claim(f"apparent_restitution_{e}", f"e {e}, 300 balls, spacing 1.4 d: vertical velocity after the impact over that "
          "before, largest difference from the closed form", "", SOURCE, (HARD(e=e),), error(e), AtMost(0.002),
          Control("friction 30 degrees", (HARD(e=e, friction=30),)))
    for e in (0.25, 0.445)]
