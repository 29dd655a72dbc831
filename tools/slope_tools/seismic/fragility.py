"""How likely bodies fail at a peak acceleration, from samples of their strength: numbers only, no files.

The capacity of a body is the peak acceleration (gal) from which on it fails; each sample of the strength and each
record has one, 0 if it fails without an earthquake. The probability at a peak is the share of capacities below it.
Samples come as several scrambled Sobol sequences; between them is the scatter that bands are made of.
"""
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
import scipy
from scipy import special

from ..quakes import motion_file
from ..quakes.quake_records import GAL
from ..slips import bishop, newmark
from ..slips.bodies import Body
from ..slips.columns import GRAVITY
from ..statistics import designs
from ..statistics.distributions import Listed, Range
from ..statistics.hazard import CONFIDENCE, Band, share_bounds

REPLICATES = 16         # sequences
# of yield to largest acceleration: dense where the displacement changes its order of magnitude
RATIOS = np.concatenate([np.geomspace(1e-4, 0.1, 60, endpoint=False), np.linspace(0.1, 0.9, 100, endpoint=False),
                         1 - np.geomspace(0.1, 1e-4, 60)])
LARGE = 1.645           # 95 % of a normal distribution
# of a frequency, from which on it is a least one: what fails below the hazard curve's first peak, and what peaks above
# its last may add
BEFORE, BEYOND = 0.05, 0.1


class Soil(NamedTuple):
    """What is sampled: distributions, or numbers. cohesion Pa; friction in degrees, or its tangent; water as ratio."""
    cohesion: Union[Range, Listed, float]
    friction: Union[Range, Listed, float]
    water: Union[Range, Listed, float] = 0.0
    is_tangent: bool = False
    correlation: float = 0.0        # between the normal scores of cohesion and friction


class Slide(NamedTuple):
    """Failure: a block on the body's surface moves farther than this, m."""
    limit: float
    records: Sequence[np.ndarray]   # rows t ax ay az, s and m/s2
    vertical: bool = False


class PseudoStatic(NamedTuple):
    """Failure: F < 1 with the inertia of factor times the peak."""
    factor: float


class Fit(NamedTuple):
    """A lognormal distribution of the capacity; the standard errors are those of the sampling."""
    median: float           # gal
    beta: float             # of randomness and uncertainty together
    beta_r: float           # between records
    beta_u: float           # between strengths
    hclpf: float            # gal: at most 5 % with a confidence of 95 %
    median_error: float
    beta_error: float
    off: float              # largest difference from the probability
    at_hclpf: float         # probability of failure at the HCLPF, by the samples
    at_hclpf_fitted: float  # the same by the fit


def values_of(variable, u: np.ndarray) -> np.ndarray:
    if isinstance(variable, Range):
        return np.clip(variable.frozen.ppf(u), variable.low, variable.high)
    if isinstance(variable, Listed):
        return np.array([float(variable.value(one)) for one in u])
    return np.full(len(u), float(variable))


def strengths_of(soil: Soil, number: int, seed: int) -> bishop.Strengths:
    """Samples of the strength: number points of each of REPLICATES scrambled sequences, one after the other."""
    u = np.concatenate([designs.points(designs.SOBOL, 3, number, seed + k) for k in range(REPLICATES)])
    if soil.correlation:
        r = soil.correlation
        score = special.ndtri(np.clip(u[:, :2], 1e-15, 1 - 1e-15))
        u[:, 1] = special.ndtr(r * score[:, 0] + np.sqrt(1 - r * r) * score[:, 1])
    friction = values_of(soil.friction, u[:, 1])
    tangent = friction if soil.is_tangent else np.tan(np.radians(friction))
    return bishop.Strengths(values_of(soil.cohesion, u[:, 0]), tangent, values_of(soil.water, u[:, 2]))


def capacities(bodies: Sequence[Body], strengths: bishop.Strengths, failure: Union[Slide, PseudoStatic]) -> np.ndarray:
    """The capacities (samples, records, bodies) in gal; without records their number is 1."""
    rows = []
    for body in bodies:
        k = bishop.yield_coefficient(body.columns, strengths)
        if isinstance(failure, PseudoStatic):
            rows.append(np.maximum(k, 0.0)[:, None] * GRAVITY / GAL / failure.factor)
            continue
        lift = 0.0
        if failure.vertical:
            # k_y is linear in kv; the body is as heavy as it is in the middle of its samples
            lift = float(np.median(k - bishop.yield_coefficient(body.columns, strengths, 1.0)))
        rows.append(np.column_stack([slide_capacity(k, record, body.direction, failure.limit, lift)
                                     for record in failure.records]))
    return np.stack(rows, axis=2)


def slide_capacity(k: np.ndarray, record: np.ndarray, direction: float, limit: float, lift: float = 0.0) -> np.ndarray:
    """The peak (gal) to which a record must be scaled for a displacement of the limit, for each yield coefficient.

    With a scale s and the yield acceleration y the displacement is s d(y / s), where d is that of the record as it is.
    """
    t, a = record[:, 0], record[:, 1:]
    peak = motion_file.peak(record)
    largest = float(np.abs(newmark.project_acceleration(a, direction)).max() + abs(lift) * np.abs(a[:, 2]).max())
    if not largest > 1e-9 * peak:
        return np.where(k > 0, np.inf, 0.0)
    way = newmark.both_ways(t, a, direction, RATIOS * largest, lift)
    y = np.maximum(k, 0.0) * GRAVITY
    with np.errstate(divide="ignore"):
        if limit > 0:
            # the ratio at which way / ratio is limit * largest / y; it falls with the ratio
            some = way > 0
            wanted = np.log(limit * largest) - np.log(y)
            ratio = np.exp(np.interp(-wanted, -np.log(way[some] / RATIOS[some]), np.log(RATIOS[some])))
            weak = wanted > np.log(way[0] / RATIOS[0])      # the strength does not matter: the limit alone
            scale = np.where(weak, limit / way[0], y / (ratio * largest))
        else:
            scale = y / (largest * RATIOS[np.flatnonzero(way > 0)[-1]])
    return np.where(k > 0, scale, 0.0) * peak / GAL


def replicates(capacity: np.ndarray) -> np.ndarray:
    """(replicates, samples of each, ...) of (samples, ...)."""
    return capacity.reshape(REPLICATES, -1, *capacity.shape[1:])


def banded(means: np.ndarray) -> Band:
    """Mean and its bounds from one value per replicate, (replicates, ...)."""
    value = means.mean(axis=0)
    half = special.stdtrit(REPLICATES - 1, (1 + CONFIDENCE) / 2) * means.std(axis=0, ddof=1) / np.sqrt(REPLICATES)
    return Band(value, np.maximum(value - half, 0.0), value + half)


def shares_below(capacity: np.ndarray, peaks: np.ndarray) -> np.ndarray:
    """(replicates, peaks): the share of the capacities (samples, records) below each peak."""
    ordered = np.sort(replicates(capacity).reshape(REPLICATES, -1), axis=1)
    return np.array([np.searchsorted(one, peaks, "left") for one in ordered]) / ordered.shape[1]


def compute_fragility_curve(capacity: np.ndarray, peaks: np.ndarray) -> Band:
    """P(failure | peak) of capacities (samples, records), with bands of the sampling."""
    band = banded(shares_below(capacity, peaks))
    n = len(capacity)
    none, most = float(share_bounds(0, n)[1]), float(share_bounds(n, n)[0])
    return Band(band.value, np.where(band.value >= 1, most, np.minimum(band.low, 1.0)),
                np.where(band.value <= 0, none, np.minimum(band.high, 1.0)))


def lognormal(peaks: np.ndarray, share: np.ndarray) -> Optional[Tuple[float, float]]:
    """Median and beta that are nearest to the probabilities; None if fewer than three of them are between 0 and 1."""
    inner = (share > 0) & (share < 1)
    if inner.sum() < 3:
        return None
    line = np.polyfit(np.log(peaks[inner]), special.ndtri(share[inner]), 1)
    if not line[0] > 0:
        return None
    found = scipy.optimize.least_squares(
        lambda p: special.ndtr((np.log(peaks) - p[0]) * np.exp(p[1])) - share, [-line[1] / line[0], np.log(line[0])])
    return float(np.exp(found.x[0])), float(np.exp(-found.x[1]))


def fit_lognormal(capacity: np.ndarray, peaks: np.ndarray) -> Optional[Fit]:
    """The lognormal Fit to the curve of capacities (samples, records); None if the peaks do not show one.

    beta^2 is shared as the variances of the logarithms of positive capacities are: within a strength, between records,
    and between strengths.
    """
    each = shares_below(capacity, peaks)
    share = each.mean(axis=0)
    best = lognormal(peaks, share)
    if best is None:
        return None
    singles = [one for one in (lognormal(peaks, row) for row in each) if one is not None]
    errors = np.std(singles, axis=0, ddof=1) / np.sqrt(len(singles)) if len(singles) > 1 else np.full(2, np.nan)
    logs = np.log(capacity[np.isfinite(capacity).all(axis=1) & (capacity > 0).all(axis=1)])
    within = float(logs.var(axis=1, ddof=1).mean()) if logs.shape[1] > 1 and len(logs) else 0.0
    between = max(float(logs.mean(axis=1).var()) - within / logs.shape[1], 0.0) if len(logs) else 1.0
    median, beta = best
    beta_r = beta * np.sqrt(within / (within + between)) if within + between > 0 else 0.0
    beta_u = np.sqrt(max(beta ** 2 - beta_r ** 2, 0.0))
    off = np.abs(special.ndtr(np.log(peaks / median) / beta) - share).max()
    hclpf = median * np.exp(-LARGE * (beta_r + beta_u))
    return Fit(median, beta, float(beta_r), float(beta_u), float(hclpf), float(errors[0]), float(errors[1]), float(off),
               float((capacity < hclpf).mean()), float(special.ndtr(np.log(hclpf / median) / beta)))


class Hazard(NamedTuple):
    """How often per year a peak acceleration is exceeded; a straight line of logarithms between the points."""
    peaks: np.ndarray       # gal, they rise
    rates: np.ndarray       # per year, they fall

    def at(self, peak: Any) -> np.ndarray:
        """The rate at a peak; that of the first or of the last point outside of them."""
        with np.errstate(divide="ignore"):
            return np.exp(np.interp(np.log(peak), np.log(self.peaks), np.log(self.rates)))

    def exceeds(self, capacity: np.ndarray, low: float = 0.0, high: float = np.inf) -> np.ndarray:
        """How often a peak between two exceeds each capacity: those below the first point never, those above the last
        one as it."""
        first, last = self.peaks[0], self.peaks[-1]
        with np.errstate(invalid="ignore"):
            found = np.where(capacity < last, self.at(np.clip(capacity, max(low, first), last)), 0.0)
        return np.maximum(found - (0.0 if high > last else float(self.at(high))), 0.0)


class Frequency(NamedTuple):
    """How often a body fails, or volumes are exceeded, per year."""
    total: Band
    parts: List[Tuple[float, float, Any]]       # from and to which peak (gal), and how much of it comes from there
    beyond: Any         # that the total can be larger by: peaks above the curve's last count as the last
    before: float = 0.0     # of the total, what fails below the curve's first peak, and counts as failing at it
    least: float = 0.0      # the smallest of these capacities, gal

    @property
    def begins_late(self) -> bool:
        """Whether the hazard curve does, for a body."""
        return bool(self.before > BEFORE * self.total.value)

    @property
    def ends_early(self) -> bool:
        return bool(self.beyond > BEYOND * self.total.value)


def frequency(capacity: np.ndarray, hazard: Hazard, peaks: np.ndarray) -> Frequency:
    """The annual frequency of failure for capacities (samples, records): the mean rate at which they are exceeded.

    Peaks below the curve's first are not counted; those above its last count as the last.
    """
    first, last = hazard.peaks[0], hazard.peaks[-1]
    total = banded(replicates(hazard.exceeds(capacity)).reshape(REPLICATES, -1).mean(axis=1))
    ends = np.unique(np.concatenate([[first], peaks[(peaks > first) & (peaks < last)], [last, np.inf]]))
    parts = [(float(a), float(b), float(hazard.exceeds(capacity, a, b).mean())) for a, b in zip(ends[:-1], ends[1:])]
    before = capacity[(capacity > 0) & (capacity < first)]
    return Frequency(total, parts, float((1 - (capacity < last).mean()) * hazard.rates[-1]),
                     before.size / capacity.size * float(hazard.rates[0]), float(before.min(initial=first)))
