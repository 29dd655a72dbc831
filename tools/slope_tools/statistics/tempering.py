"""Points where a likelihood over the unit cube is, drawn by tempering, and the least value of a function.

Where little of the cube is likely, such as a thin and bent sheet of it, points spread over the cube hardly hit it. So
they are drawn from the likelihood to a power, which rises from 0 to 1 (sequential Monte Carlo): after each rise points
are drawn anew by their weights and then moved by Metropolis steps along differences of other points, which have the
shape of what is likely (ter Braak, Statistics and Computing, 16, 239, 2006). Random only by the seed.
"""
import math
from typing import Callable, Tuple

import numpy as np
import scipy

Function = Callable[[np.ndarray], np.ndarray]   # of points (n, d): values (n)
DRAWN = 2048            # points
HALF = 0.5              # of the points count after a rise
MOVED = 3.0             # steps that a point takes after a rise, on average
MOST_MOVES = 12         # tries for them
STEPS = 1.0, 0.3, 0.1   # of the best step in a Gaussian: shorter ones where it is bent
POPULATION = 32         # points from which a smaller value is looked for
ROUNDS = 60             # of that


def weights_of(logs: np.ndarray) -> np.ndarray:
    """Weights (their sum is 1) of logarithms of likelihoods."""
    weights = np.exp(logs - logs.max())
    return weights / weights.sum()


def effective(weights: np.ndarray) -> float:
    """How many points of the same weight they are worth."""
    return float(1 / (weights ** 2).sum())


def rise(logs: np.ndarray, power: float) -> float:
    """The next power: so that HALF of the points, which stand for the present one, still count; at most 1."""
    enough = HALF * len(logs)
    if effective(weights_of((1 - power) * logs)) >= enough:
        return 1.0
    low, high = 0.0, 1 - power
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if effective(weights_of(middle * logs)) >= enough else (low, middle)
    return power + max(low, 1e-9)


def sample_likelihood(log_likelihood: Function, points: np.ndarray, logs: np.ndarray, seed: int) -> Tuple[np.ndarray,
                                                                                                          np.ndarray]:
    """DRAWN points of the likelihood and its logarithms there; points: spread evenly over the cube, with theirs."""
    rng = np.random.default_rng(seed)
    power = 0.0
    while power < 1:
        following = rise(logs, power)
        weights = weights_of((following - power) * logs)
        places = (np.arange(DRAWN) + rng.random()) / DRAWN
        chosen = np.minimum(np.searchsorted(np.cumsum(weights), places), len(weights) - 1)
        points, logs, power = points[chosen], logs[chosen], following
        points, logs = moved(log_likelihood, points, logs, power, rng)
    return points, logs


def moved(log_likelihood: Function, points: np.ndarray, logs: np.ndarray, power: float,
          rng: np.random.Generator) -> Tuple[np.ndarray, np.ndarray]:
    """The points after Metropolis steps, until each has taken MOVED on average."""
    number, dimensions = points.shape
    taken = 0.0
    for turn in range(MOST_MOVES):
        one, other = (rng.permutation(number) for _ in range(2))
        step = STEPS[turn % len(STEPS)] * 2.38 / math.sqrt(2 * dimensions)
        tried = points + step * (points[one] - points[other]) + 1e-6 * rng.normal(size=points.shape)
        inside = np.flatnonzero(((tried >= 0) & (tried <= 1)).all(axis=1))
        new = log_likelihood(tried[inside])
        accepted = np.log(rng.random(len(inside))) < power * (new - logs[inside])
        points, logs = points.copy(), logs.copy()
        points[inside[accepted]], logs[inside[accepted]] = tried[inside[accepted]], new[accepted]
        taken += accepted.sum() / number
        if taken >= MOVED:
            break
    return points, logs


def minimise_function(function: Function, points: np.ndarray, values: np.ndarray, seed: int) -> float:
    """The least value of a function in the unit cube, looked for from the least of its values at points (SciPy)."""
    near = points[np.argsort(values)[:POPULATION]]
    found = scipy.optimize.differential_evolution(lambda some: function(some.T), [(0, 1)] * points.shape[1], init=near,
                                                  seed=seed, maxiter=ROUNDS, polish=False, updating="deferred",
                                                  vectorized=True)
    return float(min(found.fun, values.min()))
