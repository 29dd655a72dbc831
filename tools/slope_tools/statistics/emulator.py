"""A Gaussian process that replaces the runs of an ensemble, its own error, and the variables that matter by it.

Points lie in the unit cube (designs). The process has a smooth part with a length for each variable, of a Matern 5/2
or a Gaussian kernel, whichever the runs make likelier, and the noise of chance. Its error is that of a
cross-validation: runs of points that the process has not seen. What a bad fit says is withheld.
"""
import functools
import math
import warnings
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import scipy
from scipy import linalg

from ..digits import format_measured_share
from . import dependent
from .entries import Analysis, Check, Influence

FOLDS = 8
GOOD, ROUGH = 0.8, 0.5      # share of the variance of unseen runs that is explained: good, rough from here, bad below
BASE = 2048                 # points of Saltelli's scheme, for each of its matrices
BASE_OF_FOLD = 1024         # of an emulator that stands for the error only
LEAST_POINTS = 8            # fewer say nothing of which variable matters
SMOOTHNESS = 2.5, math.inf      # of Matern's kernels; inf is the Gaussian one
LENGTHS = 0.05, 20.0        # of the kernel, in units of the cube
NOISE = 1e-8, 2.0           # share of the variance
SEED = 1
SIGN = "first", "first_error", "total", "total_error"      # of an Influence, what stands for it in files


class Emulator:
    """The process fitted to values (n) at points (n, d). noise: standard deviation of a run by chance."""

    def __init__(self, points: np.ndarray, values: np.ndarray, kernel=None, restarts: int = 1):
        from sklearn.exceptions import ConvergenceWarning       # half a second to import
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
        points, values = np.asarray(points, float), np.asarray(values, float)
        self.mean, self.scale = float(values.mean()), float(values.std()) or 1.0
        kernels = [kernel] if kernel else [
            ConstantKernel(1.0, (1e-2, 1e3)) * Matern(np.full(points.shape[1], 0.7), LENGTHS, smoothness)
            + WhiteKernel(0.1, NOISE) for smoothness in SMOOTHNESS]
        fitted = [GaussianProcessRegressor(one, n_restarts_optimizer=restarts, random_state=SEED) for one in kernels]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)     # a length at its bound: the variable is idle
            for one in fitted:
                one.fit(points, (values - self.mean) / self.scale)
        self.process = max(fitted, key=lambda process: process.log_marginal_likelihood_value_)

    @property
    def kernel(self):
        return self.process.kernel_

    @property
    def noise(self) -> float:
        return self.scale * math.sqrt(self.kernel.k2.noise_level)

    @property
    def freedom(self) -> float:
        """How many of the runs are left for the noise, after what the smooth part takes of them: more than 0."""
        inverse = linalg.solve_triangular(self.process.L_, np.eye(len(self.process.L_)), lower=True)
        return float(self.kernel.k2.noise_level * (inverse ** 2).sum())

    @property
    def chance(self) -> float:
        """The noise without the bias of the likelihood, which takes the smooth part for known."""
        return self.noise * math.sqrt(len(self.process.L_) / self.freedom)

    @property
    def noise_seen(self) -> bool:
        """Whether the values show any; few of them in many dimensions can all be taken for the smooth part."""
        return bool(self.kernel.k2.noise_level > 100 * NOISE[0])

    def at(self, points: np.ndarray) -> np.ndarray:
        """Mean of the process, without what predict() does for a deviation."""
        return self.mean + self.scale * (self.kernel(points, self.process.X_train_) @ self.process.alpha_)

    def unseen(self, values: np.ndarray):
        """Each of the values that it was fitted to, predicted from the others: mean, and deviation with chance.

        Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), equations 5.10 to 5.12.
        """
        inverse = linalg.cho_solve((self.process.L_, True), np.eye(len(self.process.L_)))
        variance = 1 / np.diag(inverse)
        return values - self.scale * variance * self.process.alpha_.ravel(), self.scale * np.sqrt(variance)

    def spread(self, points: np.ndarray):
        """Mean, and standard deviation of the smooth part: by how much the mean itself may be wrong."""
        mean, deviation = self.process.predict(points, return_std=True)
        variance = np.maximum(deviation ** 2 - self.kernel.k2.noise_level, 1e-12)
        return self.mean + self.scale * mean, self.scale * np.sqrt(variance)


def folds(point: np.ndarray) -> List[np.ndarray]:
    """Masks of the runs that are left out together: all of the same point, points dealt out in turn."""
    _, index = np.unique(point, return_inverse=True)
    number = min(FOLDS, index.max() + 1)
    order = np.random.default_rng(SEED).permutation(index.max() + 1)
    return [order[index] % number == k for k in range(number)]


class Validated(NamedTuple):
    """An emulator of all runs, those without each of the folds, and what these say of it."""
    whole: Emulator
    parts: List[Emulator]
    check: Check


def enough(points: int, variables: int) -> bool:
    """Whether so many different points are enough for an emulator."""
    return points >= max(LEAST_POINTS, 2 * variables + 2)


def validated(points: np.ndarray, values: np.ndarray, point: np.ndarray) -> Validated:
    """The emulator of values, which differ, of runs at points (n, d), cross-validated; point: see analyse.

    An ensemble and its known events ask for that of the same lengths: fitted once.
    """
    kinds = ((points, float), (values, float), (point, int))
    return _validated(np.shape(points), *(np.asarray(array, kind).tobytes() for array, kind in kinds))


@functools.lru_cache(maxsize=32)
def _validated(shape: Tuple[int, ...], of_points: bytes, of_values: bytes, of_point: bytes) -> Validated:
    """validated() of arrays as bytes, by which they are told apart."""
    points = np.frombuffer(of_points, float).reshape(shape)
    values, point = np.frombuffer(of_values, float), np.frombuffer(of_point, int)
    whole = Emulator(points, values)
    parts, predicted = [], np.empty(len(values))
    for out in folds(point):
        part = Emulator(points[~out], values[~out], whole.kernel, restarts=0)
        predicted[out] = part.at(points[out])
        parts.append(part)
    error = float(np.sqrt(np.mean((predicted - values) ** 2)))
    explained = 1 - error ** 2 / float(values.var())
    verdict = "good" if explained >= GOOD else "rough" if explained >= ROUGH else "bad"
    return Validated(whole, parts, Check(verdict, explained, error, whole.noise, float(values.std(ddof=1))))


def analyse(names: Sequence[str], points: np.ndarray, values: np.ndarray, point: Sequence[int],
            snap=lambda u: u, weighting: Optional[dependent.Weighting] = None) -> Analysis:
    """Influence of each variable on values of runs at points (n, d); point: which point of the design each run is of.

    snap: moves places in the cube to where runs can be, for variables of a list; weighting: of the places, for the
    indices; None: all weigh the same.
    """
    points, of = np.asarray(points, float), np.asarray(point)
    values = np.asarray(values, float)
    different = len(np.unique(of))
    ranks = [rank(points[:, i], values, of) for i in range(len(names))]

    def without(text: str, check: Optional[Check] = None) -> Analysis:
        return Analysis(text, check, {name: Influence(*one, None, None, None, None)
                                      for name, one in zip(names, ranks)})

    if np.ptp(values) <= 1e-9 * max(1e-300, float(np.abs(values).max())):
        return without("it is the same in all runs")
    if not enough(different, len(names)):
        return without(f"{different} points are too few for an emulator of {len(names)} variables")
    whole, parts, check = validated(points, values, of)
    if check.verdict == "bad":
        return without("no indices: of runs that it has not seen the emulator explains "
                       f"{format_measured_share(max(check.explained, 0.0))} of the variance", check)
    if weighting is None:
        first, total = indices(whole, len(names), snap)
        many = np.array([indices(part, len(names), snap, BASE_OF_FOLD) for part in parts])
    else:
        first, total = dependent.indices(whole.at, weighting.whole, len(names), snap)
        many = np.array([dependent.indices(part.at, weight, len(names), snap)
                         for part, weight in zip(parts, weighting.parts)])
    jackknife = (len(parts) - 1) / len(parts) * ((many - many.mean(axis=0)) ** 2).sum(axis=0)
    errors = np.sqrt(jackknife + check.unseen ** 2 + (weighting.unseen ** 2 if weighting else 0))
    text = (f"the emulator explains {format_measured_share(max(check.explained, 0.0))} of the variance of runs that it "
            "has not seen")
    if check.verdict == "rough":
        text += ": take the indices as rough"
    return Analysis(text, check, {name: Influence(*ranks[i], float(first[i]), float(errors[0][i]), float(total[i]),
                                                  float(errors[1][i])) for i, name in enumerate(names)})


def rank(places: np.ndarray, values: np.ndarray, point: np.ndarray) -> Tuple[float, bool]:
    """Rank correlation (Spearman), and whether it is larger than chance: that of the means of each point's runs."""
    if np.ptp(places) == 0 or np.ptp(values) == 0:
        return 0.0, False
    _, index, sizes = np.unique(point, return_inverse=True, return_counts=True)
    of_points = [np.bincount(index, several) / sizes for several in (places, values)]
    clear = all(np.ptp(several) > 0 for several in of_points) and scipy.stats.spearmanr(*of_points)[1] < 0.05
    return float(scipy.stats.spearmanr(places, values)[0]), bool(clear)


def indices(emulator: Emulator, dimensions: int, snap=lambda u: u, base: int = BASE):
    """First-order and total Sobol indices of the emulator's mean, for evenly distributed points: two arrays.

    Saltelli et al., Computer Physics Communications, 181, 259 (2010), with the estimators of Jansen.
    """
    both = scipy.stats.qmc.Sobol(2 * dimensions, scramble=True, seed=SEED).random(base)
    a, b = snap(both[:, :dimensions]), snap(both[:, dimensions:])
    of_a, of_b = emulator.at(a), emulator.at(b)
    variance = float(np.concatenate([of_a, of_b]).var())
    first, total = np.empty(dimensions), np.empty(dimensions)
    for i in range(dimensions):
        mixed = a.copy()
        mixed[:, i] = b[:, i]
        of_mixed = emulator.at(mixed)
        first[i] = 1 - float(np.mean((of_b - of_mixed) ** 2)) / (2 * variance) if variance > 0 else 0.0
        total[i] = float(np.mean((of_a - of_mixed) ** 2)) / (2 * variance) if variance > 0 else 0.0
    return np.clip(first, 0, 1), np.clip(total, 0, None)
