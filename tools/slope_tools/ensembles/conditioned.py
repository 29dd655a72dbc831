"""Weights of runs such that the weighted runs end where known events ended on this path; how likely a value is exceeded
then: weighted curves, quantiles and bounds.

Data-consistent inversion (Butler, Jakeman and Wildey, SIAM Journal on Scientific Computing 40 (2018), A984-A1011): a
run weighs the density of the known events at its length over the density of the runs there; runs of one length keep
the parameters' distribution as given. Neither density is estimated on its own. The runs in the order of their lengths
divide the known events among themselves: each has a cell, from halfway (in known events) to the run before to halfway
to the run after, and what lies in a cell is the quotient of both densities over the number of runs. A single cell
scatters as the distance to the next run does; so a weight is the mean of the cells of a window of about the root of the
number of runs, reflected at both ends. A kernel density of log L was tried instead: it follows the known events less
well, and needs a width and a correction at the ends.

Points that do not follow the parameters' distribution have a ratio, of its density over theirs. A cell is divided among
the runs of its window in proportion to the ratio over its mean around each run: this makes up for the parameters of
runs of one length, and leaves the lengths as the cells have them. With equal ratios that is the mean again.

Known events shorter than the shortest run, and those longer than the longest one, are in no weight: they are reported.

The share of known events whose run exceeds v is an integral over their lengths, of which the weights make a sum over
the runs in the order of their lengths. What scatters in it is whether a run of a length exceeds v, not where the runs
lie: so the variance is that of successive differences, for neighbours in this order have nearly the same length
(Wolter, Introduction to Variance Estimation, 2007, chapter 8). The plain bootstrap, which draws the lengths anew, is
too narrow where the response jumps.

The points of a design are more even than independent ones. By how much this lowers the variance is found on emulators
of the length and of the quantity: many designs of the same kind against as many of independent points, each weighted
as the ensemble is. Where the emulator knows little, chance (its residuals) prevails, and nothing is gained.

Known events before the shortest run count as the runs of the shortest window; what they did is not known (on a road
near the source they may leave more), so that in an upper bound they exceed every value and in a lower one none. Those
beyond the longest exceed every value, in a lower bound none; in places the longest run stands for them, see
weigh_runs().
"""
import math
from dataclasses import dataclass
from typing import Callable, ClassVar, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy import linalg, special

from ..quantiles import within
from ..statistics import designs, hazard
from ..statistics.entries import KnownQuantile
from ..tables.ensemble_types import Gap

GAP = 0.05              # share of the known events in it from which on a gap is one
NEAR = 8                # distances on either side of a gap that say how large one is there
ONCE = 20               # a gap is one that chance makes in at most one of so many ensembles
SIMULATED = 100         # designs of either kind
LEVELS = 25             # values at which designs are compared
UNSEEN = 0.5            # pairs of neighbours that differ, beside those that are seen: a few, or none, say little
MOST_EMULATED = 400     # runs; with more of them the evenness of a design counts for nothing
NORMAL = float(special.ndtri((1 + hazard.CONFIDENCE) / 2))


class Weights(NamedTuple):
    """Of runs, in the order that they were given in.

    weights: sum up to reached; reached, short, far: shares of the known events within the range of the runs' lengths,
    before and beyond it, 1 together; effective: number of runs of equal weight that say as much (Kish), of
    weights / reached; distance: largest difference (Kolmogorov) of the distribution of the weighted runs from that of
    the known events, within the range; gaps: in it, by length; window: number of cells that a weight is the mean of;
    order: of the runs, by length; ratio: compute_weights'; below: share of the known events before each, in this order;
    before: places in it of the runs before the gaps.
    """
    weights: np.ndarray
    reached: float
    short: float
    far: float
    effective: float
    distance: float
    gaps: List[Gap]
    window: int
    order: np.ndarray
    ratio: np.ndarray
    below: np.ndarray
    before: List[int]


def compute_weights(lengths, exceedance, ratio=None) -> Weights:
    """The weights of at least two runs; lengths: m; exceedance: share of known events that go beyond each of them.

    ratio: density of the parameters' distribution over that of the points, of each run; None: they are the same.
    The exceedance must not rise with the length. If no known event lies within the range of the runs, all weights are
    0, and so is effective.
    """
    lengths, beyond = np.asarray(lengths, float), np.asarray(exceedance, float)
    order = np.argsort(lengths, kind="stable")
    below = 1 - beyond[order]
    cells = np.diff(np.concatenate([below[:1], (below[1:] + below[:-1]) / 2, below[-1:]]))
    window = 2 * max(0, int(math.sqrt(len(lengths)) / 2 - 0.5)) + 1     # 7 of 60 runs, 9 of 100, 63 of 4000
    reached = float(below[-1] - below[0])
    rest = float(1 - below[-1])
    weights = np.zeros(len(lengths))
    given = np.ones(len(lengths)) if ratio is None else np.asarray(ratio, float)
    if reached <= 0:
        return Weights(weights, 0.0, float(below[0]), rest, 0.0, 0.0, [], window, order, given, below, [])
    counts = given[order] / averaged(given[order], window)
    smooth = counts * averaged(cells / averaged(counts, window), window)
    weights[order] = smooth
    upto, before = below[0] + np.cumsum(smooth), find_weight_gaps(below)
    distance = max(np.abs(upto - below).max(), np.abs(upto - smooth - below).max())
    return Weights(weights, reached, float(below[0]), rest, float(reached ** 2 / (smooth ** 2).sum()), float(distance),
                   [Gap(*map(float, (*lengths[order][i:i + 2], below[i + 1] - below[i]))) for i in before], window,
                   order, given, below, before)


def averaged(cells: np.ndarray, window: int) -> np.ndarray:
    """The mean of a window of cells around each; beyond an end they are reflected, which keeps their sum."""
    half = window // 2
    wide = np.concatenate([cells[:half][::-1], cells, cells[len(cells) - half:][::-1]])
    return np.convolve(wide, np.full(window, 1 / window), "valid")


def find_weight_gaps(below: np.ndarray) -> List[int]:
    """Behind which run none ends though known events do; below: share of known events up to each, ascending.

    The shares of the known events between runs drawn independently are distributed exponentially, about the mean that
    the density of the runs makes. So one of them over the mean of k others, those around it, exceeds x with the
    probability (1 + x / k)^-k; a gap is what the largest of all exceeds by chance but once in ONCE ensembles.
    """
    share = np.diff(below)
    gaps = []
    for i in np.flatnonzero(share >= GAP):
        near = np.delete(share[max(0, i - NEAR):i + NEAR + 1], min(i, NEAR))
        k = len(near)
        if not k or share[i] > near.mean() * k * ((len(share) * ONCE) ** (1 / k) - 1):
            gaps.append(int(i))
    return gaps


# --- curves and quantiles ---

@dataclass(frozen=True)
class Masses:
    """Of the runs of an ensemble, in their own order.

    share: of the known events that each run stands for, with those before the shortest run; far: of those beyond the
    longest; order: of the runs by length; effective: number of runs of equal weight; window: runs, see Weights;
    early: what of share stands for the events before the shortest run; either: share if those that end in gaps, where
    no run does, count as the run before, and as the one after; None without gaps.
    """
    share: np.ndarray
    far: float
    order: np.ndarray
    effective: float
    window: int
    early: np.ndarray
    either: Optional[Tuple[np.ndarray, np.ndarray]] = None


def masses(weights: Weights) -> Masses:
    first, early = weights.order[:weights.window], np.zeros(len(weights.order))
    early[first] = weights.short * weights.ratio[first] / weights.ratio[first].sum()
    share = weights.weights + early
    inside = share.sum()
    effective = float(inside ** 2 / (share ** 2).sum()) if inside > 0 else 0.0
    return Masses(share, weights.far, weights.order, effective, weights.window, early, either_side(share, weights))


def either_side(share: np.ndarray, weights: Weights) -> Optional[Tuple[np.ndarray, np.ndarray]]:
    """The shares with the events in the gaps on the run before, and on the one after; None without gaps."""
    if not weights.before:
        return None
    of, begins = share[weights.order], [0, *(i + 1 for i in weights.before)]
    ends = np.append(weights.below[weights.before], weights.below[-1])        # of the known events, before each gap
    starts = np.append(0.0, weights.below[begins[1:]])
    parts = np.split(of, begins[1:])
    inside = np.concatenate([part * (end - start) / part.sum() if part.sum() > 0 else part
                             for part, start, end in zip(parts, starts, ends)])
    both = []
    for after in (0, 1):
        one = np.empty_like(share)
        one[weights.order] = inside
        one[weights.order[np.array(weights.before) + after]] += starts[1:] - ends[:-1]
        both.append(one)
    return both[0], both[1]


def weigh_runs(mass: Masses) -> np.ndarray:
    """The share of all known events that each run stands for.

    Those beyond the longest run go at least as far as it does: it stands for them wherever a place is asked for, in
    maps, stretches and zones, so that no fewer of them reach its end than go beyond it. What they leave is not known:
    as numbers they exceed every value, see compute_known_curve().
    """
    share = mass.share.copy()
    share[mass.order[-1]] += mass.far
    return share


def are_above_levels(values: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Whether each run (rows) has more than each level (columns)."""
    return values[:, None] > levels


def estimate(exceeding: np.ndarray, mass: Masses, factor=1.0, several: float = 1.0, failed: float = 0.0):
    """Share of the known events within reach whose run exceeds, and its bounds: three arrays, of the columns.

    exceeding: of each run (rows), in the runs' own order; factor: of the variance, of the design (Design.effect);
    several: runs of a point; failed: share of the runs that have no length, which could have been anything.
    """
    inside = float(mass.share.sum())
    part = mass.share @ exceeding
    if inside <= 0:
        return part, np.zeros_like(part), np.full_like(part, inside + failed)
    ordered, share = exceeding[mass.order], mass.share[mass.order]
    pair = (share[1:] ** 2 + share[:-1] ** 2) / 4         # variance of a pair of which one run exceeds
    differ = ordered[1:] != ordered[:-1]
    found = (differ.T @ pair + UNSEEN * pair.mean()) * several * factor / inside ** 2
    low, high = bounds(np.clip(part / inside, 0, 1), found, mass.effective / several)
    early = mass.early @ exceeding
    low, high = np.maximum(inside * low - early, 0.0), inside * high + mass.early.sum() - early
    return part, low * (1 - failed), high + failed * (1 - high)


@dataclass(frozen=True)
class Standing:
    """Runs that count as the known events that they stand for, in maps (as ensemble_maps.Alike); several, failed: see
    estimate(). Those beyond the longest run: see weigh_runs(); in an upper bound they are everywhere."""
    mass: Masses
    several: float
    failed: float
    whose: ClassVar[str] = "known events"
    at_a_time: ClassVar[int] = 20_000

    def within(self, block: np.ndarray) -> np.ndarray:
        return within(block, weigh_runs(self.mass), hazard.SHARES)[:, None]

    def above(self, exceeding: np.ndarray) -> Sequence[np.ndarray]:
        _, low, high = estimate(exceeding, self.mass, several=self.several, failed=self.failed)
        return weigh_runs(self.mass) @ exceeding, low, np.minimum(high + self.mass.far, 1)


def compute_known_curve(values: hazard.Values, mass: Masses, effect: Optional[Sequence[hazard.Values]] = None,
                        several: float = 1.0, failed: float = 0.0) -> hazard.Curve:
    """The share of known events above each value of the runs, with bounds; it begins as hazard.compute_hazard_curve
    does.

    effect: of the design (Design.effect), on the variance; several, failed: see estimate().
    """
    given = np.asarray(values, float)
    at = hazard.levels_of(given)
    factor = np.interp(at, effect[0], effect[1]) if effect else 1.0
    part, low, high = estimate(are_above_levels(given, at), mass, factor, several, failed)
    high = np.maximum.accumulate((high + mass.far)[::-1])[::-1]
    return hazard.Curve(at, part + mass.far, np.minimum.accumulate(low), np.minimum(high, 1.0))


def bounds(share: np.ndarray, shares: np.ndarray, runs: float):
    """Wilson's bounds of shares with variances; none is less sure than of so many independent runs."""
    number = np.maximum(share * (1 - share) / shares, runs)
    square = NORMAL ** 2
    middle = (share + square / (2 * number)) / (1 + square / number)
    half = NORMAL / (1 + square / number) * np.sqrt(share * (1 - share) / number + square / (4 * number ** 2))
    return np.clip(middle - half, 0, share), np.clip(middle + half, share, 1)


def compute_known_quantiles(curve: hazard.Curve, shares: Sequence[float] = hazard.SHARES,
                            values: Optional[hazard.Values] = None,
                            mass: Optional[Masses] = None) -> List[KnownQuantile]:
    """Values that shares of the known events stay within; None where events beyond the longest run decide.

    values, mass: of the runs of the curve, whose levels are the values; they tell whether events decide that end where
    no run does.
    """
    # a curve may begin just below its runs
    levels = np.maximum(curve.values, min(curve.values[1], 0.0))
    sides = curve.share, curve.low, curve.high
    several = []
    for share in shares:
        value, low, high = (first_within(levels, one, 1 - share) for one in sides)
        several.append(KnownQuantile(share, value, low, high))
    if mass is None or mass.either is None:
        return several
    given = np.asarray(values, float)
    return [in_gap(one, *(within(given, side, one.share, mass.far) for side in mass.either)) for one in several]


def in_gap(quantile: KnownQuantile, before: float, after: float) -> KnownQuantile:
    """A quantile, given its values with the events in gaps on either side; infinite beyond the runs."""
    if quantile.value is None or not np.isfinite([before, after]).all() or before == after:
        return quantile
    low, high = sorted((before, after))
    return quantile._replace(value=high, gap=(low, high), low=None if quantile.low is None else min(quantile.low, low),
                             high=None if quantile.high is None else max(quantile.high, high))


def first_within(values: np.ndarray, share: np.ndarray, left: float) -> Optional[float]:
    at = np.flatnonzero(share <= left + 1e-12)
    return float(values[at[0]]) if len(at) else None


# --- the design ---

class Design:
    """By how much the evenness of a design lowers the variance.

    kind: of designs; places: points of the runs (n, d) in the unit cube, one run of each; lengths: of the runs (m);
    exceedance: share of the known events beyond lengths; snap: see emulator.analyse.
    """

    def __init__(self, kind: str, places: np.ndarray, lengths: np.ndarray, exceedance: Callable, snap=lambda u: u):
        from ..statistics.emulator import Emulator
        self.process, self.places = Emulator, places
        number, dimensions = places.shape
        rng = np.random.default_rng(1)
        self.points = [snap(designs.points(kind, dimensions, number, seed)) for seed in range(SIMULATED)]
        self.points += [snap(rng.random((number, dimensions))) for _ in range(SIMULATED)]
        self.chance = rng.integers(0, number, (len(self.points), number))
        simulated = 10 ** self.simulate(np.log10(lengths))
        self.masses = [masses(compute_weights(one, exceedance(one))) for one in simulated]

    def simulate(self, values: np.ndarray) -> np.ndarray:
        """Values of the runs of each simulated ensemble: the emulator's, with residuals of runs that it left out."""
        fitted = self.process(self.places, values)
        inverse = linalg.cho_solve((fitted.process.L_, True), np.eye(len(values)))
        left_out = fitted.scale * fitted.process.alpha_.ravel() / np.diag(inverse)
        found = fitted.at(np.concatenate(self.points)).reshape(self.chance.shape) + left_out[self.chance]
        return np.clip(found, values.min(), values.max())

    def effect(self, values: hazard.Values) -> Tuple[np.ndarray, np.ndarray]:
        """Levels of a quantity, and the factor of the variance at each of them, at most 1."""
        given = np.asarray(values, float)
        levels = np.unique(np.quantile(given, (np.arange(LEVELS) + 0.5) / LEVELS, method="inverted_cdf"))
        shares = np.array([mass.share @ are_above_levels(one, levels) + mass.far
                           for one, mass in zip(self.simulate(given), self.masses)])
        even, independent = (part.var(axis=0, ddof=1) for part in (shares[:SIMULATED], shares[SIMULATED:]))
        ratio = np.divide(even, independent, out=np.ones_like(even), where=independent > 0)
        return levels, np.minimum(ratio, 1.0)
