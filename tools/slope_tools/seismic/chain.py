"""From an earthquake to the volume on the road: how likely bodies fail, and what runs of each leave there.

Of each sample of the strength and each record it is known from which peak acceleration on each body fails (fragility).
The bodies that fail together at a peak are a set. Of each body there are runs, whose volumes have a distribution; of a
set the volumes are added, once rank by rank and once as independent ones, and the larger probability counts: how they
depend is not known, as the runs release one body each. P(V > v | peak) is the mean over the samples, the annual
frequency its integral over the hazard curve; the set is constant between two capacities, so that this integral is a
sum. Bounds: those of the runs (hazard.compute_hazard_curve), all bodies at their upper or lower one together, for any
dependence (together.py), and the scatter between the sequences of samples. Every function is pure.
"""
from typing import Dict, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..statistics import hazard
from . import fragility, together
from .fragility import Band, Frequency, Hazard
from .together import Steps

LEAST = 1e-6            # weight of a body, of which there is hardly a run then


class Left(NamedTuple):
    """What a body leaves on the road: as its runs say, and the distributions of the bounds."""
    value: Steps
    low: Steps
    high: Steps


def steps(values: np.ndarray, exceeded: np.ndarray, most: float) -> Steps:
    """The distribution with P(V > value) = exceeded at rising values; beyond the last of them volumes are `most`."""
    return Steps(np.concatenate([[most], values[::-1]]), np.concatenate([exceeded[::-1], [1.0]]))


def compute_left_volume(values: Sequence[float], point: Sequence[int], most: float, failed: int = 0) -> Left:
    """What the runs of a body leave on the road; most: its whole volume, which counts where no run says less.

    point: of each run, see hazard.compute_hazard_curve; failed: further runs that gave none.
    """
    if not len(values):
        all_of_it, nothing = Steps(np.array([most]), np.ones(1)), Steps(np.zeros(1), np.ones(1))
        return Left(all_of_it, nothing, all_of_it)
    found = hazard.compute_hazard_curve(values, point, failed)
    at, most = np.maximum(found.values, 0.0), max(most, float(np.max(values)))
    low = np.minimum.accumulate(found.low)
    high = np.maximum.accumulate(found.high[::-1])[::-1]
    return Left(*(steps(at, one, most) for one in (found.share, low, high)))


class Sums:
    """P(V > v) at volumes >= 0 of the sets of bodies that fail together, each worked out once; see together.py."""

    def __init__(self, bodies: Sequence[Left], volumes: np.ndarray):
        self.bodies, self.volumes = bodies, volumes
        self.known = {0: Band(*np.zeros((3, len(volumes))))}

    def of(self, number: int) -> Band:
        """Of the set whose bits are the bodies, with bounds for those of the runs and for any dependence."""
        if number not in self.known:
            value, low, high = ([getattr(one, side) for k, one in enumerate(self.bodies) if number >> k & 1]
                                for side in Left._fields)
            self.known[number] = Band(np.maximum(together.rank_by_rank(value, self.volumes),
                                                 together.independent(value, self.volumes)),
                                      together.at_least(low, self.volumes), together.at_most(high, self.volumes))
        return self.known[number]


def over_sets(weights: Dict[int, np.ndarray], sums: Sums) -> Band:
    """The mean over sets with a weight for each sequence of samples, {set: weights}."""
    sets = sorted(weights)
    share = np.stack([weights[number] for number in sets], axis=1)
    each = Band(*(np.array(side) for side in zip(*(sums.of(number) for number in sets))))
    low, high = (fragility.banded(share @ side) for side in (each.low, each.high))
    return Band(share.mean(axis=0) @ each.value, np.minimum.accumulate(low.low),
                np.maximum.accumulate(high.high[::-1])[::-1])


def summed(sets: np.ndarray, weights: np.ndarray) -> Dict[int, np.ndarray]:
    """{set: its mean weight in each sequence} of arrays whose first axis are the samples."""
    number = len(sets) // fragility.REPLICATES * int(np.prod(sets.shape[1:2]))      # samples and records of a sequence
    sets, weights = (fragility.replicates(one).reshape(fragility.REPLICATES, -1) for one in (sets, weights))
    known, index = np.unique(sets, return_inverse=True)
    index = index.reshape(sets.shape)
    each = np.array([np.bincount(row, weight, len(known)) for row, weight in zip(index, weights)]) / number
    return {int(one): each[:, k] for k, one in enumerate(known)}


def bits(fails: np.ndarray) -> np.ndarray:
    """The sets of bodies (last axis) that fail, as numbers."""
    return fails @ (1 << np.arange(fails.shape[-1], dtype=np.int64))


def family(capacity: np.ndarray, peaks: np.ndarray, bodies: Sequence[Left], volumes: np.ndarray) -> Band:
    """P(V > v | peak) of capacities (samples, records, bodies) in gal: arrays (peaks, volumes)."""
    curves, sums = [], Sums(bodies, volumes)
    none = float(hazard.share_bounds(0, len(capacity))[1])
    for peak in peaks:
        sets = bits(capacity < peak)
        band = over_sets(summed(sets, np.ones(sets.shape)), sums)
        high = band.high if sets.any() else np.maximum(band.high, none)
        curves.append(Band(band.value, band.low, np.minimum(high, 1.0)))
    return Band(*(np.array(side) for side in zip(*curves)))


def of_failures(capacity: np.ndarray, rate: Hazard, low: float, high: float) -> Tuple[np.ndarray, np.ndarray]:
    """The sets that fail between two peaks, and how often per year: arrays (samples, records, places).

    At the curve's last peak counts what is above it, too. Each place is a body in the order of failure, with those
    that have failed before it, until the next one does.
    """
    order = np.argsort(capacity, axis=-1)
    ordered = np.take_along_axis(capacity, order, axis=-1)
    failed = np.cumsum(np.int64(1) << order, axis=-1)
    counted = rate.exceeds(ordered, low, high)
    return failed, counted - np.concatenate([counted[..., 1:], np.zeros_like(counted[..., :1])], axis=-1)


def frequency(capacity: np.ndarray, rate: Hazard, peaks: np.ndarray, bodies: Sequence[Left],
              volumes: np.ndarray) -> Frequency:
    """The annual frequency of volumes > v for capacities (samples, records, bodies); peaks: between which it is parted.

    Peaks below the curve's first are not counted; those above its last count as the last: with larger ones all bodies
    may fail, and what one leaves that never did so far is not known.
    """
    first, last = float(rate.peaks[0]), float(rate.peaks[-1])
    sums = Sums(bodies, volumes)

    def between(low: float, high: float) -> Band:
        return over_sets(summed(*of_failures(capacity, rate, low, high)), sums)

    ends = [first, *(float(one) for one in peaks if first < one < last), last, np.inf]
    parts = [(a, b, between(a, b).value) for a, b in zip(ends[:-1], ends[1:])]
    at_last = bits(capacity < last)
    share = over_sets(summed(at_last, np.ones(at_last.shape)), sums).value
    untold = ((capacity >= last).all(axis=(0, 1)) & np.isfinite(capacity).any(axis=(0, 1))).any()
    most = np.ones(len(volumes)) if untold else sums.of((1 << len(bodies)) - 1).value
    return Frequency(between(first, np.inf), parts, np.maximum(most - share, 0.0) * float(rate.rates[-1]))


def weights(capacity: np.ndarray, peaks: np.ndarray, rate: Optional[Hazard] = None) -> np.ndarray:
    """How likely each body fails, given that one does: with a hazard per year, else at peaks that are equally likely.

    Bodies that fail together count each; the sum is 1. All are 0 if none ever fails. One that fails at the peaks, but
    at none of the hazard curve, has LEAST: the curves against the peak have it, too.
    """
    each = at_peaks = np.array([(capacity < peak).mean(axis=(0, 1)) for peak in peaks]).mean(axis=0)
    if rate is not None and (yearly := rate.exceeds(capacity).mean(axis=(0, 1))).any():
        each = yearly
    share = each / each.sum() if each.any() else each
    return np.maximum(share, np.where(each + at_peaks > 0, LEAST, 0.0))
