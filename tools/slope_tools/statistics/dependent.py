"""Sobol indices of variables that depend on each other, because places in their cube have different weights.

The definitions stay those of independent variables (Kucherenko, Tarantola and Annoni, Computer Physics Communications,
183, 937 (2012)): the first index is Var(E(Y | x_i)) / Var(Y), the total one E(Var(Y | all but x_i)) / Var(Y). But they
no longer add up: what a variable shares with another one by dependence is in the first index of both and in the total
one of neither, so that a first index can be larger than the total one.
"""
from typing import Callable, List, NamedTuple

import numpy as np
import scipy

LEVELS = 32         # values of a variable for each place of the others
SEED = 1


class Weighting(NamedTuple):
    """Weights (n) of places (n, d) in the unit cube, none negative: the best, and those without each fold.

    unseen: share of the variance of what makes the weights that is not known.
    """
    whole: Callable[[np.ndarray], np.ndarray]
    parts: List[Callable[[np.ndarray], np.ndarray]]
    unseen: float


def indices(at: Callable, weight: Callable, dimensions: int, snap=lambda u: u, base: int = 512):
    """First and total indices of a function of places (n, d), which is evenly distributed but for weight: two arrays.

    base: places of the other variables; ValueError if none has a weight.
    """
    places = scipy.stats.qmc.Sobol(dimensions, scramble=True, seed=SEED).random(base)
    first, total = np.zeros(dimensions), np.zeros(dimensions)
    for i in range(dimensions):
        grid = np.repeat(places[:, None, :], LEVELS, axis=1)
        grid[:, :, i] = (np.arange(LEVELS) + 0.5) / LEVELS
        grid = snap(grid.reshape(-1, dimensions))
        values, w = (np.reshape(of(grid), (base, LEVELS)) for of in (at, weight))
        if not w.sum() > 0:
            raise ValueError("no place has a weight")
        w = w / w.sum()
        mean = (w * values).sum()
        variance = (w * (values - mean) ** 2).sum()
        if variance > 0:
            of_levels, _ = moments(values, w, 0)
            first[i] = (w.sum(axis=0) * (of_levels - mean) ** 2).sum() / variance
            total[i] = moments(values, w, 1)[1].sum() / variance
    return first, total


def moments(values: np.ndarray, w: np.ndarray, axis: int):
    """Weighted means along an axis, and weighted sums of squares about them; a line without weight counts nothing."""
    weight = w.sum(axis=axis, keepdims=True)
    mean = (w * values).sum(axis=axis, keepdims=True) / np.where(weight > 0, weight, 1)
    return mean.squeeze(axis), (w * (values - mean) ** 2).sum(axis=axis)
