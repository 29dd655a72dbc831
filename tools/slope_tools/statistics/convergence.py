"""Effect of the size of the balls on a quantity: a line through its values, the value for small balls, the errors.

V(d) = V0 + b d: the first term that a finite size can have. What a size d changes, at the slip surface, on the ground
and at the rim of the deposit, happens in a layer of a few d, and a layer's share of a body grows with d. The line is
fitted to the runs of several sizes with weights 1/s(d)2: coarse balls are few, and few balls scatter more. Units: d in
m, V and s in the quantity's (m3 of ground, m, degrees); any other variable in place of d has its own. All functions are
pure.
"""
import math
from dataclasses import dataclass, replace
from typing import List, Optional, Sequence, Tuple

import numpy as np
from scipy import stats

from .headline import CONFIDENCE, ROUNDING, SizeError

# exponents of s(d) = c d^p: by the number of balls in a volume, which goes as d^-3; and none
COUNTING, EVEN = 1.5, 0.0
SUPPORTED = 0.05        # the line is given up if chance makes such residuals in fewer than one of twenty cases


@dataclass(frozen=True)
class Size:
    """The runs of one size of balls; errors are shares of the value for small balls."""
    d: float
    runs: int
    mean: float
    scatter: Optional[float]            # standard deviation of a run; None of a single one
    fitted: float                       # on the line
    error: Optional[float]              # (mean - V0)/V0; None if V0 is not clearly above 0
    standard_error: Optional[float]     # of that


@dataclass(frozen=True)
class Estimate:
    """A number of a fit and its standard error, None if that is not known."""
    value: float
    standard_error: Optional[float]


@dataclass(frozen=True)
class Convergence:
    """The fit, over all sizes."""
    small: Estimate                     # V0
    slope: Estimate                     # b
    covariance: Optional[float]         # of the two
    degrees_of_freedom: int             # of the standard errors
    exponent: float                     # p of s(d) = c d^p
    scatter: Optional[float]            # c: s at d = 1, from repeats and, if it is supported, from the line
    lack: Optional[Tuple[float, float]]      # F of the means about the line against the repeats, and its probability
    curved: Optional[Estimate]          # coefficient of d2 in a parabola instead
    curved_small: Optional[Estimate]    # and its value for small balls
    curve_is_clear: Optional[bool]
    sizes: Tuple[Size, ...]             # the largest first

    @property
    def supported(self) -> Optional[bool]:
        """Whether the means lie about the line as chance has it; None where repeats or a third size are missing."""
        return None if self.lack is None else self.lack[1] >= SUPPORTED

    @property
    def quantile(self) -> Optional[float]:
        """t(0.975); None without degrees of freedom."""
        return float(stats.t.ppf(CONFIDENCE, self.degrees_of_freedom)) if self.degrees_of_freedom else None

    @property
    def interval(self) -> Optional[Tuple[float, float]]:
        """95 % interval of the value for small balls; None if it is not known."""
        if self.small.standard_error is None or self.quantile is None:
            return None
        half = self.quantile * self.small.standard_error
        return self.small.value - half, self.small.value + half

    @property
    def known(self) -> bool:
        """Whether the value for small balls is clearly above 0, so that errors can be shares of it."""
        low, _ = self.interval or (self.small.value, None)
        return low > 0

    def line_at(self, d: float) -> Tuple[float, Optional[float]]:
        """The line at a size, and its standard error there."""
        return line_at(self.small, self.slope, self.covariance, d)


def line_at(small: Estimate, slope: Estimate, covariance: Optional[float], d: float) -> Tuple[float, Optional[float]]:
    """V0 + b d and its standard error."""
    value = small.value + slope.value * d
    if small.standard_error is None or slope.standard_error is None or covariance is None:
        return value, None
    variance = small.standard_error ** 2 + (d * slope.standard_error) ** 2 + 2 * d * covariance
    return value, math.sqrt(max(0.0, variance))


def error_of_line(small: Estimate, slope: Estimate, covariance: Optional[float], quantile: Optional[float],
                  d: float) -> SizeError:
    """Of the line at a size that was not run: b d/V0, its standard error by first-order propagation."""
    share = slope.value * d / small.value
    if small.standard_error is None or slope.standard_error is None or covariance is None or quantile is None:
        return SizeError(share)
    variance = ((d * slope.standard_error) ** 2 + (share * small.standard_error) ** 2
                - 2 * d * share * covariance) / small.value ** 2
    return SizeError(share, quantile * math.sqrt(max(0.0, variance)))


# --- the fit ---

def exponent_of(runs: Sequence[Tuple[float, Sequence[float]]]) -> float:
    """p of s(d) = c d^p: that of counting or none, which of the two makes the repeats' scatter likelier (normal).

    Where repeats do not say, that of counting.
    """
    known = [(d, len(values) - 1, float(np.var(values, ddof=1))) for d, values in runs if len(values) > 1]
    if len(known) < 2 or not all(variance > 0 for _, _, variance in known):
        return COUNTING

    def likelihood(p):
        free = sum(count for _, count, _ in known)
        unit = sum(count * variance / d ** (2 * p) for d, count, variance in known) / free
        return -sum(count * math.log(unit * d ** (2 * p)) for d, count, _ in known)     # the rest is the same for all p
    return max((COUNTING, EVEN), key=likelihood)


def least_squares(d: np.ndarray, means: np.ndarray, weights: np.ndarray, order: int):
    """Coefficients of a polynomial, their covariance for a unit variance, the influence of each mean, the residuals."""
    unit = d.max()          # of d, so that the matrix is well conditioned
    powers = np.vander(d / unit, order + 1, increasing=True)
    covariance = np.linalg.inv(powers.T @ (weights[:, None] * powers))
    influence = covariance @ (powers.T * weights)
    found = influence @ means
    scale = unit ** -np.arange(order + 1.0)
    return found * scale, covariance * np.outer(scale, scale), influence * scale[:, None], means - powers @ found


def fit(runs: Sequence[Tuple[float, Sequence[float]]]) -> Convergence:
    """The line through the runs: (size > 0, values of its runs) of at least two different sizes.

    Weighted least squares of the means. Standard errors: from repeats and residuals together if the line is supported,
    else from the residuals alone, which are larger (F test of the lack of fit; Draper and Smith, Applied Regression
    Analysis, 1998, section 2.1).
    """
    runs = [(size, without_rounding(values)) for size, values in sorted(runs, key=lambda one: -one[0])]
    d = np.array([size for size, _ in runs], float)
    counts = np.array([len(values) for _, values in runs], float)
    means = np.array([math.fsum(values) / len(values) for _, values in runs])
    p = exponent_of(runs)
    spread = d ** (2 * p)
    weights = counts / spread
    found, unit, influence, residuals = least_squares(d, means, weights, 1)
    repeats = math.fsum((value - mean) ** 2 / one
                        for (_, values), mean, one in zip(runs, means, spread) for value in values)
    about = float(np.sum(weights * residuals ** 2))
    if about < ROUNDING ** 2 * float(np.sum(weights * means ** 2)):
        about = 0.0
    free, of_line = int(counts.sum()) - len(runs), len(runs) - 2
    lack = None
    if free and of_line:
        ratio = about / of_line / (repeats / free) if repeats else (math.inf if about else 0.0)
        lack = ratio, float(stats.f.sf(ratio, of_line, free))
    if lack is None or lack[1] >= SUPPORTED:
        total = free + of_line
        variance = (repeats + about) / total if total else None
    else:
        total, variance = of_line, about / of_line
    deviations: List[Optional[float]] = [None, None]
    if variance is not None:
        deviations = [float(one) for one in np.sqrt(variance * np.diag(unit))]
    small = Estimate(float(found[0]), deviations[0])
    curved = parabola(d, means, weights, repeats, free)
    result = Convergence(
        small, Estimate(float(found[1]), deviations[1]), None if variance is None else float(variance * unit[0, 1]),
        total, p, None if variance is None else math.sqrt(variance), lack,
        curved[0], curved[1], curved[2], ())
    columns = (one.tolist() for one in (means, means - residuals, spread / counts, influence[0]))
    sizes = [size_of(result, run, mean, fitted, unit_, one, variance)
             for run, mean, fitted, unit_, one in zip(runs, *columns)]
    return replace(result, sizes=tuple(sizes))


def without_rounding(values: Sequence[float]) -> Sequence[float]:
    """Values that differ by rounding only are one value, so that their scatter is 0."""
    mean = math.fsum(values) / len(values)
    return [mean] * len(values) if np.ptp(values) <= ROUNDING * abs(mean) else values


def size_of(result: Convergence, run, mean: float, fitted: float, unit: float, influence: float,
            variance: Optional[float]) -> Size:
    """The entry of a size; the error's standard error counts that V0 is made of this mean, too."""
    d, values = run
    scatter = float(np.std(values, ddof=1)) if len(values) > 1 else None
    if not result.known:
        return Size(d, len(values), mean, scatter, fitted, None, None)
    small, ratio, deviation = result.small.value, mean / result.small.value, None
    if variance is not None and result.small.standard_error is not None:
        of_mean = variance * unit
        deviation = math.sqrt(max(0.0, of_mean + (ratio * result.small.standard_error) ** 2
                                  - 2 * ratio * influence * of_mean)) / small
    return Size(d, len(values), mean, scatter, fitted, ratio - 1, deviation)


def parabola(d, means, weights, repeats: float, free: int):
    """Coefficient of d2 and value for small balls of a parabola, and whether the first is clearly not 0.

    None, None, None where nothing is left to judge it by.
    """
    if len(d) < 3 or free + len(d) - 3 == 0:
        return None, None, None
    found, unit, _, residuals = least_squares(d, means, weights, 2)
    total = free + len(d) - 3
    variance = (repeats + float(np.sum(weights * residuals ** 2))) / total
    deviations = np.sqrt(variance * np.diag(unit))
    clear = abs(found[2]) > max(stats.t.ppf(CONFIDENCE, total) * deviations[2],
                                ROUNDING * np.abs(means).max() / d.max() ** 2)
    small, _, curve = (Estimate(float(value), float(deviation)) for value, deviation in zip(found, deviations))
    return curve, small, bool(clear)


# --- in words ---

def words(result: Convergence, name: str, what: str, unit: str, number) -> List[str]:
    """Plain sentences on a fit; name: the variable's, number: writes a value of the quantity as text."""
    small, interval = result.small, result.interval
    text = f"{what}: {number(small.value)} {unit} for small {name}"
    if interval is not None:
        text += (f", 95 % interval {number(interval[0])} to {number(interval[1])} (standard error "
                 f"{number(small.standard_error)})")
    else:
        text += ", standard error unknown: a line through two sizes with one run each always fits"
    found = [text]
    if result.known:
        found.append(f"{what}: error and its standard error at " + ", ".join(
            f"{name} {size.d:g} {100 * (size.error or 0.0):+.1f}"
            + (f" +- {100 * size.standard_error:.1f}" if size.standard_error is not None else "") + " %"
            for size in result.sizes))
    else:
        found.append(f"{what}: the value for small {name} is not clearly above 0, so errors cannot be shares of it")
    if result.supported is False and result.lack:
        found.append(f"{what}: the line is not supported: the means of the sizes lie {math.sqrt(result.lack[0]):.2g} "
                     f"times as far from it as the scatter of the repeats explains (probability {result.lack[1]:.2g}"
                     "); standard errors are from these residuals")
    elif result.supported is None:
        found.append(f"{what}: it is unknown whether a line holds: this needs three sizes, and repeats")
    if result.curve_is_clear and result.curved_small:
        found.append(f"{what}: a parabola fits clearly better, and gives {number(result.curved_small.value)} {unit} "
                     f"for small {name}")
    return found
