"""Where the runs of an ensemble lie: points in the unit cube, from a seed."""
import warnings
from typing import Sequence

import numpy as np
import scipy

SOBOL, LHS = "sobol", "lhs"
KINDS = (SOBOL, LHS)


def points(kind: str, dimensions: int, number: int, seed: int) -> np.ndarray:
    """Points (number, dimensions), each coordinate from 0 to 1, of a seed.

    sobol: the scrambled Sobol sequence, of which a longer one begins with a shorter one of the same seed; even in all
    directions for numbers that are powers of two. lhs: Latin hypercube, even in each coordinate; no number of points
    is a part of another.
    """
    if kind == LHS:
        return scipy.stats.qmc.LatinHypercube(dimensions, seed=seed).random(number)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)        # other numbers than powers of two
        return scipy.stats.qmc.Sobol(dimensions, scramble=True, seed=seed).random(number)


def snapped(variables: Sequence, u: np.ndarray) -> np.ndarray:
    """Points with each coordinate where its variable (distributions) can be."""
    return np.column_stack([one.snap(u[:, i]) for i, one in enumerate(variables)])
