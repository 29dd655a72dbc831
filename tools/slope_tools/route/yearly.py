"""How often per year at least one of several bodies does something, of which each does it with a share of its runs.

The bodies of an earthquake fail together or not, and how they depend is not known: two cases are worked out, and the
larger one counts. Independent: each body has a strength of its own, so that at a peak acceleration a

    P(a) = 1 - (1 - f_1(a) p_1) (1 - f_2(a) p_2) ...

with the fragilities f and the shares p. Dependent: all have the strength of one sample, and of the bodies that have
failed at a the largest share counts. Neither is a bound: whatever the dependence, P(a) is at least the largest one of
f_1 p_1, f_2 p_2 ..., and at most their sum, or 1 (Boole, Frechet). The frequency is the integral of P over the hazard
curve, with what is below its first peak not counted, and what is above its last one counted as the last: as
seismic/chain.py does.
"""
from typing import NamedTuple, Sequence

import numpy as np

from ..errors import SlopeError
from ..seismic.fragility_files import Fragility

STEPS = 2001        # peaks between the first and the last one of the hazard curve


class Rate(NamedTuple):
    """Per year; least and most: for any dependence."""
    independent: float
    dependent: float
    least: float
    most: float

    @property
    def counts(self) -> float:
        return max(self.independent, self.dependent)


class Yearly:
    """The fragilities of bodies with a hazard curve."""

    def __init__(self, fragility: Fragility):
        if fragility.rate is None:
            raise SlopeError("--fragility", "must be of slope fragility with --hazard, for frequencies per year",
                             fragility.folder)
        self.names, self.rate, self.warnings = fragility.bodies, fragility.rate, fragility.warnings
        first, last = float(self.rate.peaks[0]), float(self.rate.peaks[-1])
        peaks = np.geomspace(first, last, STEPS)
        each = fragility.capacity.reshape(-1, len(self.names))
        self.fails = np.array([np.searchsorted(np.sort(one), peaks, "left") for one in each.T]).T / len(each)
        rates = self.rate.at(peaks)
        ends = np.concatenate([(rates[:-1] - rates[1:]) / 2, [0.0]])
        self.weights = ends + np.concatenate([[0.0], ends[:-1]])        # trapezoids
        self.weights[-1] += rates[-1]
        self.capacity = each
        self.fail_rate = self.rate.exceeds(each)        # of each sample

    def of(self, bodies: Sequence[int], shares: Sequence[float]) -> Rate:
        """bodies: their numbers; shares: of their runs."""
        index = [self.names.index(str(one)) for one in bodies]
        p = np.asarray(shares, float)
        each = self.fails[:, index] * p
        independent, least, most = (float(self.weights @ at) for at in (
            1 - np.prod(1 - each, axis=1), each.max(axis=1), np.minimum(each.sum(axis=1), 1)))
        order = np.argsort(self.capacity[:, index], axis=1)
        rates = np.take_along_axis(self.fail_rate[:, index], order, axis=1)
        largest = np.maximum.accumulate(p[order], axis=1)
        until = np.concatenate([rates[:, 1:], np.zeros((len(rates), 1))], axis=1)
        dependent = float((largest * (rates - until)).sum(axis=1).mean())
        both = independent, dependent       # of the samples one by one, the others of steps of the curve
        return Rate(*both, min(least, *both), max(most, *both))
