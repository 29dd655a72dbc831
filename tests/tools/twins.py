"""Twin experiments for calibrations: a cheap stand-in for a collapse, with chance, whose values are looked for."""
from pathlib import Path

import numpy as np

from slope_tools.statistics import backanalysis, distributions

TOP = Path(__file__).resolve().parents[2]
VARIABLES = [distributions.distribution(name, text, "--vary", text) for name, text in
             (("friction", "15:40"), ("rolling", "0:0.2"), ("spacing", "0.5:1.5"))]
CLOSE = np.array([2.0, 0.02, 0.1])      # degrees, -, diameters
LOW = np.array([one.low for one in VARIABLES])
WIDTH = np.array([one.high - one.low for one in VARIABLES])
CHANCE = np.array([0.8, 0.25, 0.08, 0.008])     # of the four outputs
NAMES = ("run-out", "width", "thickness at the toe", "share that stays near")


def expected(values):
    """Run-out (m), width (m), thickness (m), share that stays near, without chance: three of four would do to find the
    values. values: (3,) or (n, 3); shape (4,) or (n, 4)."""
    friction, rolling, spacing = np.transpose(values)
    slide = np.tan(np.radians(friction))
    return np.transpose([60 / (0.25 + 0.6 * slide + 1.5 * rolling) * (1.25 - 0.25 * spacing),
                         20 * (1 + 0.5 * (40 - friction) / 25 - 1.2 * rolling),
                         3 + 6 * rolling + 2 * slide + 0.8 * spacing,
                         0.5 + 0.4 * (spacing - 1) - 0.5 * rolling])


def collapse(values, rng, outputs=range(4)):
    """One run: the numbers expected, and chance."""
    return (expected(values) + rng.normal(size=4) * CHANCE)[list(outputs)]


def observation(seed, outputs=range(4)):
    """Hidden values, what was observed of them, and the generator for the runs."""
    rng = np.random.default_rng(100 + seed)
    hidden = LOW + WIDTH * (0.2 + 0.6 * rng.random(3))
    return hidden, collapse(hidden, rng, outputs), rng


class Twin:
    """A calibration of the stand-in by so many runs, a batch at a time; hidden: the true values."""

    def __init__(self, seed, runs=60, batch=4, outputs=range(4)):
        self.hidden, observed, rng = observation(seed, outputs)
        targets = [backanalysis.Target(NAMES[k], "", float(value), 0.0) for k, value in zip(outputs, observed)]
        points = backanalysis.first(3, seed)
        found = np.array([collapse(LOW + WIDTH * point, rng, outputs) for point in points])
        while len(points) < runs:
            guess = backanalysis.posterior(points, found, targets)
            more = backanalysis.propose(guess, points, min(batch, runs - len(points)))
            points = np.vstack([points, more])
            found = np.vstack([found, [collapse(LOW + WIDTH * point, rng, outputs) for point in more]])
        self.points, self.found = points, backanalysis.posterior(points, found, targets)

    @property
    def error(self):
        """Best less hidden values."""
        return LOW + WIDTH * self.found.best - self.hidden

    @property
    def holds(self):
        """Whether each region over a pair holds the hidden values."""
        place = (self.hidden - LOW) / WIDTH
        return [self.found.pair(i, j).holds(place) for i, j in ((0, 1), (0, 2), (1, 2))]

    @property
    def words(self):
        return backanalysis.judgement(self.found, VARIABLES)


class Steep:
    """A calibration of a stand-in whose run-out jumps by `fall` metres where the mass gets over a step at EDGE.

    Two variables, friction and rolling; observed are run-out and width of a run at hidden values.
    """
    EDGE = 1750.0
    CHANCE = np.array([40.0, 8.0])

    def __init__(self, seed, fall, runs=40, batch=9):
        rng = np.random.default_rng(500 + seed)
        self.fall = fall
        hidden = 0.1 + 0.8 * rng.random(2)
        observed = self.run(hidden, rng)
        targets = [backanalysis.Target(name, "m", float(value), 0.02 * float(value))
                   for name, value in zip(("run-out", "width"), observed)]
        points = backanalysis.first(2, seed)
        found = np.array([self.run(point, rng) for point in points])
        while len(points) < runs:
            guess = backanalysis.posterior(points, found, targets)
            more = backanalysis.propose(guess, points, min(batch, runs - len(points)))
            points = np.vstack([points, more])
            found = np.vstack([found, [self.run(point, rng) for point in more]])
        self.points, self.outputs, self.targets = points, found, targets
        self.found = backanalysis.posterior(points, found, targets)
        self.holds = self.found.pair(0, 1).holds(hidden)
        self.near = bool(abs(observed[0] - self.EDGE - (fall if observed[0] > self.EDGE else 0)) < 150)
        self.gaps = self.found.gaps[0]

    def run(self, place, rng):
        """Run-out and width (m) of a run at a place in the unit cube, with chance."""
        friction, rolling = 15 + 25 * place[0], 0.2 * place[1]
        reach = 900 / (0.15 + 0.5 * np.tan(np.radians(friction)) + 0.8 * rolling) + self.CHANCE[0] * rng.normal()
        width = 300 * (1 + 0.5 * (40 - friction) / 25 - 2.5 * rolling) + self.CHANCE[1] * rng.normal()
        return np.array([reach + self.fall * (reach > self.EDGE), width])
