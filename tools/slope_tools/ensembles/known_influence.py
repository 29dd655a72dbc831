"""Which variables a quantity depends on in the runs that are weighted by known events: Sobol indices on emulators.

The weight of a place in the unit cube is that of the runs of its length, which an emulator of log10 L gives: share of
the known events over the density of the distributions. So the variables depend on each other (statistics.dependent).
"""
import numpy as np

from ..digits import percent
from ..statistics import dependent, emulator
from ..statistics.entries import Analysis


def evaluate_influence(runs, quantity: str) -> Analysis:
    """What study.yaml says of it; runs: a known_events.Runs, quantity: the column that counts."""
    values = runs.column(quantity)
    _, point = np.unique(np.array(runs.point), axis=0, return_inverse=True)
    names = runs.sample.names
    weighting, text = None, "the runs are too few for an emulator of their lengths"
    if emulator.enough(int(point.max()) + 1, len(names)) and np.ptp(runs.lengths) > 0:
        length = emulator.validated(runs.places, np.log10(runs.lengths), point)
        text = f"the emulator of the length explains {percent(length.check.explained)} of the variance of unseen runs"
        if length.check.verdict != "bad":
            weighting = dependent.Weighting(weight(runs, length.whole), [weight(runs, one) for one in length.parts],
                                            length.check.unseen)
    if weighting is None:
        return Analysis(f"no indices: {text}", None, {})
    return emulator.analyse(names, runs.places, values, point, runs.sample.snap, weighting)


def weight(runs, length: emulator.Emulator):
    """The weight of places (n, d): that of the runs of this length, without what their batch makes of it."""
    order = runs.mass.order
    lengths = np.log10(runs.lengths)[order]
    each = (runs.mass.share / runs.weights.ratio)[order]
    return lambda places: np.interp(length.at(places), lengths, each)
