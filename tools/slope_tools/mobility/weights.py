"""Weights of runs such that the weighted runs end where known events ended on this path.

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
"""
import math
from typing import List, NamedTuple

import numpy as np

GAP = 0.05          # share of the known events in it from which on a gap is one
NEAR = 8            # distances on either side of a gap that say how large one is there
ONCE = 20           # a gap is one that chance makes in at most one of so many ensembles


class Gap(NamedTuple):
    """Two lengths (m) between which no run ends, and the share of known events that do."""
    low_m: float
    high_m: float
    share: float


class Weights(NamedTuple):
    """Of runs, in the order that they were given in.

    weights: sum up to reached; reached, short, far: shares of the known events within the range of the runs' lengths,
    before and beyond it, 1 together; effective: number of runs of equal weight that say as much (Kish), of
    weights / reached; distance: largest difference (Kolmogorov) of the distribution of the weighted runs from that of
    the known events, within the range; gaps: in it, by length; window: number of cells that a weight is the mean of;
    order: of the runs, by length; ratio: of_lengths'; below: share of the known events before each, in this order;
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


def of_lengths(lengths, exceedance, ratio=None) -> Weights:
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
