"""How likely a value is exceeded: quantiles, shares and curves of an ensemble's runs, with binomial bounds.

The runs of an ensemble are points drawn from the distributions of its variables, perhaps several runs of each point.
Bounds are those of Clopper and Pearson for a share k of n; where a point has several runs, n is the number of
independent runs that they are worth (Korn and Graubard, Survey Methodology, 24, 193, 1998). Failed runs could have
given anything: in a lower bound they do not exceed a value, in an upper one they do. Every function is pure.
"""
import functools
import math
from dataclasses import dataclass
from typing import Any, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from scipy import special

from .. import disk
from .entries import Quantile

Values = Union[Sequence[float], np.ndarray]
CONFIDENCE = 0.9                # of bounds, two-sided: 5 % beyond either
TAILS = (1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2
SHARES = 0.5, 0.9, 0.95, 0.99   # of the quantiles


class Band(NamedTuple):
    """An estimate and its bounds, numbers or arrays of one shape; None: so many runs do not bound it."""
    value: Any
    low: Any
    high: Any


@dataclass(frozen=True)
class Curve:
    """P(V > value), with bounds, at ascending values; between two of them it is the one of the lower."""
    values: np.ndarray
    share: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def at(self, value: float) -> Band:
        """The share that exceeds a value, which may lie anywhere from the lowest of the curve on."""
        i = int(np.searchsorted(self.values, value, "right")) - 1
        i = max(i, 0)
        return Band(float(self.share[i]), float(self.low[i]), float(self.high[i]))


def share_bounds(k, n: int, failed: int = 0, effect: Union[float, np.ndarray] = 1.0,
                 confidence: float = CONFIDENCE) -> Tuple[np.ndarray, np.ndarray]:
    """Bounds (Clopper and Pearson) of the share of which k of n finished runs are seen; k may be an array, and effect
    one for each.

    effect: how many of the runs are worth one independent run, >= 1.
    """
    k = np.asarray(k, float)
    tail = (1 - confidence) / 2
    total = (n + failed) / effect
    few, many = k / effect, (k + failed) / effect
    with np.errstate(invalid="ignore"):
        low = np.where(k > 0, special.betaincinv(np.maximum(few, 1e-9), total - few + 1, tail), 0.0)
        high = np.where(k < n, special.betaincinv(many + 1, np.maximum(total - many, 1e-9), 1 - tail), 1.0)
    return low, high


@dataclass(frozen=True)
class Places:
    """Where quantiles and their bounds are among n sorted values, from 0; None: so many runs do not bound it."""
    value: int
    low: Optional[int]
    high: Optional[int]


@functools.lru_cache(maxsize=4096)
def places(share: float, n: int, failed: int = 0, effect: float = 1.0) -> Places:
    """The Places of the quantile of a share of n sorted values."""
    above = np.arange(n - 1, -1, -1)        # how many lie above each of them
    low, high = share_bounds(above, n, failed, effect)
    left = 1 - share
    rounding = 1e-12
    first = int(np.argmax(above <= n * left + n * rounding))
    sure_below = share_bounds(n, n, failed, effect)[0] > left     # whether all of them may be said to lie below
    at_low = np.flatnonzero(low <= left)
    at_high = np.flatnonzero(high <= left)
    return Places(first, int(at_low[0]) if sure_below and len(at_low) else None,
                  int(at_high[0]) if len(at_high) else None)


def effect_of(exceeding: np.ndarray, point: np.ndarray) -> float:
    """How many runs are worth one independent run, for the share of those that exceed a value; point: of each run.

    The variance of the share as it is between the points, over that of as many independent runs; from 1 to the runs of
    a point.
    """
    n = len(exceeding)
    _, index, sizes = np.unique(point, return_inverse=True, return_counts=True)
    several = n / len(sizes)
    if several <= 1 or len(sizes) < 2:
        return max(1.0, several)
    share = float(np.mean(exceeding))
    if not 0 < share < 1:
        return several
    sums = np.bincount(index, exceeding - share)
    between = len(sizes) / (len(sizes) - 1) * float((sums ** 2).sum()) / n ** 2
    return min(max(1.0, between / (share * (1 - share) / n)), several)


def compute_quantiles(values: Values, point: Sequence[int], failed: int = 0,
                      shares: Sequence[float] = SHARES) -> List[Quantile]:
    """Quantiles of finished runs; point: which point of the design each run is of; failed: runs that gave none."""
    given = np.asarray(values, float)
    ordered = np.sort(given)
    quantiles = []
    for share in shares:
        value = ordered[places(share, len(ordered), failed).value]
        at = places(share, len(ordered), failed, effect_of(given > value, np.asarray(point)))
        quantiles.append(Quantile(share, float(value), *(None if i is None else float(ordered[i])
                                                         for i in (at.low, at.high))))
    return quantiles


def compute_hazard_curve(values: Values, point: Sequence[int], failed: int = 0) -> Curve:
    """The share of the runs above each of their values, and above what lies below all of them: levels_of()."""
    given, of = np.asarray(values, float), np.asarray(point)
    n = len(given)
    at = levels_of(given)
    above = n - np.searchsorted(np.sort(given), at, "right")
    effects = [effect_of(given > value, of) for value in at] if len(np.unique(of)) < n else 1.0
    return Curve(at, above / n, *share_bounds(above, n, failed, np.asarray(effects)))


def levels_of(given: np.ndarray) -> np.ndarray:
    """The values of a curve: all, after 0, or, where one is not above 0, after what is below them all."""
    start = 0.0 if given.min() > 0 else np.nextafter(given.min(), -math.inf)
    return np.unique(np.concatenate([[start], given]))


def tabulate_hazard(curves: Mapping[str, Curve]) -> str:
    """The CSV of hazard curves of quantities: the share above each value, with bounds."""
    rows = []
    for name, one in curves.items():
        # what levels_of() put just below a value stands for all below it, and is no value
        first = int(len(one.values) > 1 and np.nextafter(one.values[0], math.inf) == one.values[1])
        rows += [[name, *(f"{value:.9g}" for value in row)]
                 for row in list(zip(one.values, one.share, one.low, one.high))[first:]]
    return disk.csv_text(["quantity", "value", "exceeded", "low", "high"], rows)
