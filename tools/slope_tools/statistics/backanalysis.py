"""Which values of a model's variables give what was observed: a sequential search with Gaussian processes.

The model is anything that gives numbers at points of the unit cube: runs of a deck (fit.py), a Python function.
Each number is emulated with the noise of chance (emulator.py). What is observed is one outcome of chance, too, and
known to a tolerance; so a point c is as likely as

    (1 + chi2(c)/f)^(-(f + m)/2) / sqrt(det S(c)),   chi2 = r S^-1 r,   r = observed - emulated (m numbers),
    S = N + diag(t^2 + s(c)^2)

with N the covariance of chance, f its degrees of freedom (runs less what the smooth parts take of them; Student's
distribution, because N is known from few runs), t the tolerances and s the emulators' own error. All points of the cube
are equally likely before. If the smallest chi2 is larger than chance makes in one of twenty cases, the 95 % quantile of
its degrees of freedom, chi2 is divided by the ratio of both: the model is off by more than chance and tolerance. Every
function is pure, and random only by the seed.
"""
import math
from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import scipy
from scipy import ndimage, special

from . import designs, tempering
from .emulator import Emulator

CLOUD = 4096            # points that stand for the cube
ENOUGH = 300.0          # of them that must count, or others are drawn where the likelihood is
LEAST_FREEDOM = 4.0     # degrees, of the noise of chance
LIKELY = 0.1            # of the largest likelihood: less, and the mean is no best value
MARGIN = 0.02           # of the drawn points' extent, around them
SHARE = 0.9             # of the region that is as good as the best
BINS = 24               # of a map over a pair, along a side of the box
APART = 0.2             # least distance of points of a batch, in widths of the box
LEAST_NOISE = 1e-3      # of the deviation of an output over all runs
SEED = 1
# a variable whose interval is wider than these shares of its range is not, or only roughly, known
UNKNOWN, ROUGH = 0.6, 0.3
TIED = 0.75             # rank correlation from which on two variables make up for each other
CHANCES = 1000          # data sets, in fewer than one of which chance makes a gap


class Gap(NamedTuple):
    """No run gives a value between these."""
    low: float
    high: float

    def holds(self, value: float) -> bool:
        return self.low < value < self.high


def find_gaps(values: np.ndarray, emulator: Emulator) -> List[Gap]:
    """Gaps in the response of a model: values that no run gives, because the response jumps; from the lowest.

    A mass that gets over a step of a valley goes on to its foot; between the two no run stops. An emulator is smooth
    there, and so predicts what no run gives. Each run is therefore predicted from the others: if so many of them should
    have ended between two neighbouring results that chance leaves it empty in less than one of CHANCES data sets, it is
    a gap. values (n): of the runs that the emulator was fitted to.
    """
    edges = np.unique(values)
    if len(edges) < 2:
        return []
    mean, deviation = emulator.unseen(values)
    below = special.ndtr((edges[:, None] - mean) / deviation)     # (edges, runs)
    inside = np.clip(np.diff(below, axis=0), 0, 1 - 1e-12)
    empty = np.log1p(-inside).sum(axis=1)                           # logarithm of the probability that no run is in it
    found = (empty < -np.log(CHANCES * len(inside)))
    return [Gap(float(edges[i]), float(edges[i + 1])) for i in np.flatnonzero(found)]


class Target(NamedTuple):
    """What was observed of an output.

    value None: it is to be as small as the model can make it, such as a lack of overlap; deviation: standard deviation
    by which the observation may be wrong.
    """
    name: str
    unit: str
    value: Optional[float]
    deviation: float


@dataclass(frozen=True)
class Pair:
    """The region over two variables (numbers i, j): densities in bins from low to high, and those that belong to it."""
    i: int
    j: int
    low: Tuple[float, float]
    high: Tuple[float, float]
    density: np.ndarray         # (bins of i, bins of j), their sum is 1
    inside: np.ndarray          # bool

    def holds(self, point: Sequence[float]) -> bool:
        """Whether a point of the cube lies in the region."""
        at = []
        for k, axis in enumerate((self.i, self.j)):
            place = (point[axis] - self.low[k]) / (self.high[k] - self.low[k])
            if not 0 <= place <= 1:
                return False
            at.append(min(int(place * BINS), BINS - 1))
        return bool(self.inside[at[0], at[1]])


@dataclass(frozen=True)
class Posterior:
    """What the runs say of the variables: points of the cube and their weights (their sum is 1)."""
    points: np.ndarray
    weights: np.ndarray
    logs: np.ndarray            # logarithms of the points' likelihoods
    best: np.ndarray            # the mean, or the likeliest point where the mean is unlikely, as of a bent region
    box: Tuple[np.ndarray, np.ndarray]
    emulators: List[Emulator]
    goals: np.ndarray           # the targets' values, the best attainable of those without one
    noise: np.ndarray           # standard deviation of each output by chance
    gaps: List[List[Gap]]       # of each output
    misfit: float               # smallest chi2 over what chance makes of it; above 1 the model does not get there

    def interval(self, i: int, share: float = SHARE) -> Tuple[float, float]:
        """The shortest interval of a variable that holds a share of the weight."""
        order = np.argsort(self.points[:, i])
        places, below = self.points[order, i], np.cumsum(self.weights[order])
        start = np.searchsorted(below, below + share - 1e-12)
        ends = np.minimum(start, len(places) - 1)
        widths = np.where(start < len(places), places[ends] - places, math.inf)
        first = int(widths.argmin())
        return float(places[first]), float(places[ends[first]])

    def correlation(self) -> np.ndarray:
        """Rank correlations of the variables within the region."""
        ranks = np.argsort(np.argsort(self.points, axis=0), axis=0).astype(float)
        middle = ranks - self.weights @ ranks
        covariance = (middle * self.weights[:, None]).T @ middle
        deviation = np.sqrt(np.diag(covariance))
        return covariance / np.outer(deviation, deviation)

    def pair(self, i: int, j: int) -> Pair:
        """The region of SHARE over two variables."""
        low, high = self.box
        edges = [np.linspace(low[k], high[k], BINS + 1) for k in (i, j)]
        density = np.histogram2d(self.points[:, i], self.points[:, j], edges, weights=self.weights)[0]
        density = smooth(density / density.sum())
        order = np.argsort(density, axis=None)[::-1]
        total = np.cumsum(density.ravel()[order])
        inside = np.zeros(density.size, bool)
        inside[order[:int(np.searchsorted(total, SHARE)) + 1]] = True
        return Pair(i, j, (float(low[i]), float(low[j])), (float(high[i]), float(high[j])), density,
                    inside.reshape(density.shape))


def smooth(density: np.ndarray) -> np.ndarray:
    """Spread over neighbours, so that a region has no holes by chance; the sum stays."""
    return ndimage.gaussian_filter(density, 0.8, mode="nearest")


def first(dimensions: int, seed: int) -> np.ndarray:
    """The points before anything is known."""
    return designs.points(designs.SOBOL, dimensions, max(10, 4 * dimensions + 2), seed)


def posterior(points: np.ndarray, outputs: np.ndarray, targets: Sequence[Target]) -> Posterior:
    """What runs at points (n, d) with outputs (n, m) say, held against targets (m)."""
    points, outputs = np.asarray(points, float), np.asarray(outputs, float)
    dimensions = points.shape[1]
    emulators = [Emulator(points, column) for column in outputs.T]
    deviation = outputs.std(axis=0)
    noise = np.maximum([one.chance for one in emulators], np.maximum(LEAST_NOISE * deviation, 1e-12))
    chance = correlation_of(outputs - np.column_stack([one.at(points) for one in emulators]))
    covariance = chance * np.outer(noise, noise)
    tolerance = np.array([one.deviation for one in targets]) ** 2
    goals = np.array([best_of(emulator) if one.value is None else one.value
                      for one, emulator in zip(targets, emulators)])
    most = float(special.chdtri(max(1, len(targets) - dimensions), 0.05))

    def measured(cloud):
        return distance(cloud, emulators, goals, covariance, tolerance)

    cloud = scipy.stats.qmc.Sobol(dimensions, scramble=True, seed=SEED).random(CLOUD)
    chi2, logdet = measured(cloud)
    misfit = tempering.minimise_function(lambda some: measured(some)[0], cloud, chi2, SEED) / most

    freedom = max(LEAST_FREEDOM, min(one.freedom for one in emulators))

    def log_likelihood(chi2, logdet):
        tail = (freedom + len(goals)) * np.log1p(chi2 / max(1.0, misfit) / freedom)
        return -0.5 * (tail + logdet)

    logs = log_likelihood(chi2, logdet)
    weights = tempering.weights_of(logs)
    box = np.zeros(dimensions), np.ones(dimensions)
    if tempering.effective(weights) < ENOUGH:
        cloud, logs = tempering.sample_likelihood(lambda some: log_likelihood(*measured(some)), cloud, logs, SEED)
        weights = np.full(len(cloud), 1 / len(cloud))
        low, high = cloud.min(axis=0), cloud.max(axis=0)
        room = MARGIN * (high - low) + 1e-6
        box = np.maximum(0, low - room), np.minimum(1, high + room)
    mean = weights @ cloud
    likely = log_likelihood(*measured(mean[None]))[0] > logs.max() + math.log(LIKELY)
    jumps = [find_gaps(column, one) for column, one in zip(outputs.T, emulators)]
    return Posterior(cloud, weights, logs, mean if likely else cloud[int(logs.argmax())], box, emulators, goals, noise,
                     jumps, misfit)


def correlation_of(residuals: np.ndarray) -> np.ndarray:
    """Correlation of what chance does to the outputs, drawn towards none where the runs are few."""
    n, outputs = residuals.shape
    deviation = residuals.std(axis=0)
    known = np.where(deviation > 0, deviation, 1.0)
    found = (residuals - residuals.mean(axis=0)).T @ (residuals - residuals.mean(axis=0)) / n / np.outer(known, known)
    np.fill_diagonal(found, 1.0)
    few = outputs / (n + outputs)
    return (1 - few) * found + few * np.eye(outputs)


def best_of(emulator: Emulator) -> float:
    """The least that a model comes to by its emulator."""
    dimensions = emulator.process.X_train_.shape[1]
    return float(emulator.at(scipy.stats.qmc.Sobol(dimensions, scramble=True, seed=SEED).random(1024)).min())


def distance(cloud, emulators, goals, covariance, tolerance):
    """chi2 and the logarithm of the determinant of S, at each point of a cloud."""
    found = [one.spread(cloud) for one in emulators]
    r = np.column_stack([mean for mean, _ in found]) - goals
    error = np.column_stack([deviation for _, deviation in found]) ** 2
    whole = covariance[None] + np.einsum("ij,jk->ijk", error + tolerance, np.eye(len(goals)))
    factor = np.linalg.cholesky(whole)
    solved = np.linalg.solve(factor, r[..., None])[..., 0]
    return (solved ** 2).sum(axis=1), 2 * np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1)


def propose(posterior_: Posterior, taken: np.ndarray, number: int) -> np.ndarray:
    """The points where runs say most: likely ones at which the emulators are least sure, apart from each other."""
    likely = np.exp(0.5 * (posterior_.logs - posterior_.logs.max()))
    unsure = sum((one.spread(posterior_.points)[1] / noise) ** 2 for one, noise
                 in zip(posterior_.emulators, posterior_.noise))
    value = likely * np.sqrt(unsure + 1e-12)
    low, high = posterior_.box
    scaled = (posterior_.points - low) / (high - low)
    chosen: List[np.ndarray] = []
    for _ in range(number):
        i = int(value.argmax())
        chosen.append(posterior_.points[i])
        far = 1 - np.exp(-0.5 * (((scaled - scaled[i]) / APART) ** 2).sum(axis=1))
        value = value * far
    points = np.array(chosen)
    # a run at the place of another one would be that run again
    near = np.abs(points[:, None] - np.asarray(taken)[None]).max(axis=2).min(axis=1) < 1e-5
    points[near] = np.clip(points[near] + 1e-3, 0, 1)
    return points


def sets(posterior_: Posterior, number: int) -> np.ndarray:
    """Points (number, d) of the region that stand for it, in no order: each is as likely as the others."""
    rng = np.random.default_rng(SEED)
    order = np.argsort(posterior_.points[:, 0])
    below = np.cumsum(posterior_.weights[order])
    at = np.searchsorted(below, (np.arange(number) + rng.random(number)) / number * below[-1])
    return posterior_.points[rng.permutation(order[np.minimum(at, len(order) - 1)])]


def misfits(outputs: np.ndarray, posterior_: Posterior, targets: Sequence[Target]) -> np.ndarray:
    """The score of runs, root mean square of (output - observed)/sqrt(tolerance2 + chance2): about 1 is the best."""
    scale = np.sqrt(np.array([one.deviation for one in targets]) ** 2 + posterior_.noise ** 2)
    return np.sqrt((((np.asarray(outputs) - posterior_.goals) / scale) ** 2).mean(axis=1))


# --- words ---

def judgement(posterior_: Posterior, variables: Sequence) -> List[str]:
    """In sentences: how well each variable (distributions.Range) is known, and which compensate each other."""
    lines, loose = [], []
    for i, variable in enumerate(variables):
        low, high = posterior_.interval(i)
        width = high - low
        best, least, most = (format_variable_value(variable, u) for u in (float(posterior_.best[i]), low, high))
        text = f"{variable.name}: {best}, {least} to {most} ({100 * SHARE:g} %)"
        if width > UNKNOWN:
            loose.append(variable.name)
            text += f": not identifiable, the observation allows {100 * width:.0f} % of its range"
        elif width > ROUGH:
            loose.append(variable.name)
            text += f": roughly known, {100 * width:.0f} % of its range"
        lines.append(text)
    correlation = posterior_.correlation()
    for i, variable in enumerate(variables):
        for j in range(i + 1, len(variables)):
            other = variables[j].name
            if abs(correlation[i, j]) >= TIED and {variable.name, other} & set(loose):
                more = "less" if correlation[i, j] < 0 else "more"
                lines.append(f"{variable.name} and {other} cannot be identified separately: more {variable.name} with "
                             f"{more} {other} gives the same result")
    if posterior_.misfit > 1:
        lines.append("no values of these variables reproduce the observation: the closest are "
                     f"{math.sqrt(posterior_.misfit):.1f} times as far from it as chance and tolerance explain")
    return lines


def format_variable_value(variable, u: float) -> str:
    """A value to a thousandth of the width of its distribution."""
    digits = max(0, 3 - math.floor(math.log10(variable.width)) - 1)
    return f"{float(variable.value(u)):.{digits}f}"
