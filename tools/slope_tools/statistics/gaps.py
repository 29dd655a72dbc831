"""Gaps in the response of a model: values that no run gives, because the response jumps.

A mass that gets over a step of a valley goes on to its foot; between the two no run stops. An emulator is smooth there,
and so predicts what no run gives. Each run is therefore predicted from the others: if so many of them should have ended
between two neighbouring results that chance leaves it empty in less than one of CHANCES data sets, it is a gap.
"""
from typing import List, NamedTuple

import numpy as np
from scipy import stats

from .emulator import Emulator

CHANCES = 1000


class Gap(NamedTuple):
    """No run gives a value between these."""
    low: float
    high: float

    def holds(self, value: float) -> bool:
        return self.low < value < self.high


def find_gaps(values: np.ndarray, emulator: Emulator) -> List[Gap]:
    """Of values (n) of the runs that an emulator was fitted to, from the lowest."""
    edges = np.unique(values)
    if len(edges) < 2:
        return []
    mean, deviation = emulator.unseen(values)
    below = stats.norm.cdf((edges[:, None] - mean) / deviation)     # (edges, runs)
    inside = np.clip(np.diff(below, axis=0), 0, 1 - 1e-12)
    empty = np.log1p(-inside).sum(axis=1)                           # logarithm of the probability that no run is in it
    found = (empty < -np.log(CHANCES * len(inside)))
    return [Gap(float(edges[i]), float(edges[i + 1])) for i in np.flatnonzero(found)]
