"""A ball that falls on fixed balls at a random place rebounds with less than the restitution

inputs/05_apparent_restitution: balls that fall on the balls of a plan grid. The closed form is that of a hard ball: the
claims are made with balls a hundred times as stiff as the case's and nearly without weight.
"""
import functools
import importlib.util
import re

import numpy as np

from .claims import AtMost, Claim, Control, INPUTS, Run, Seen

CASE = "05_apparent_restitution"
HARD = Run("05_apparent_restitution/in.apparent_restitution")(
    balls=300, spacing=1.4, kn=3.67e9, dt=1e-6, tdump=1e-4, tend=0.04, g=0.1)
SOURCE = "hard ball: e cos^2(b) - sin^2(b) after a frictionless impact at b from the top"


def plots():
    """The case's own plot.py."""
    spec = importlib.util.spec_from_file_location("plot_apparent_restitution", INPUTS / CASE / "plot.py")
    assert spec and spec.loader
    plot = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(plot)
    return plot


def drops(result):
    """What it reads of a run."""
    return drops_in(result.folder)


@functools.lru_cache(maxsize=8)
def drops_in(folder):
    return plots().read(str(folder / "bounce"))


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

BALLS = Run("05_apparent_restitution/in.apparent_restitution")
CLOSE = BALLS(cells=12)
SPACINGS = "1.0", "1.1", "1.2", "1.3", "1.4", "1.6", "1.8", "2.0", "2.5", "3.0"
CLOSER = "0.5", "0.7", "0.9", "0.95"


def of_table(spacing, column):
    """Of plot.py's table."""
    return lambda result: next(drop.table()[column] for drop in drops(result) if drop.spacing == float(spacing))


def of_means(k):
    """Mean (0) and standard deviation (1) of the first rebound over the speed at the start, of several cells."""
    def got(result):
        line, = plots().means(str(result.folder / "bounce"))
        return float(re.findall(r"[\d.]+", line.split(": ")[1])[k])
    return got


PAIRS = [(e, friction) for e in (0.25, 0.445, 0.48) for friction in (0, 30)]
SEEN = [Seen(f"{what}.{e}.{friction}.{spacing}", (BALLS(e=e, friction=friction),), of_table(spacing, what), False)
        for e, friction in PAIRS for spacing in SPACINGS
        for what in ("mean", "sd", "first_impact_mean", "first_impact_up", "alone", "median_error", "largest_error")]
SEEN += [Seen(f"{what}.{pattern.split()[0]}.{e}.{friction}.{spacing}",
              (CLOSE(spacing=spacing, pattern=pattern, e=e, friction=friction),), of_means(k), False)
         for e, friction in PAIRS for spacing in CLOSER for pattern in ("grid", "scattered 1")
         for k, what in enumerate(("mean", "sd"))]
SEEN += [Seen(f"{what}.hard", (HARD(balls=1000, e=0.25, tend=0.1),), of_table("1.4", what), False)
         for what in ("alone", "median_error", "largest_error")]
