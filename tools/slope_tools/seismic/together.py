"""The volume that several bodies leave together, of which each one's distribution is known, but not how they depend.

P(V > v) of the sum of volumes X_1 + ... + X_n for two kinds of dependence, rank_by_rank() and independent(), of which
now one and now the other is larger, and its bounds for any dependence, at_most() and at_least(): if a sum is above
v = v_1 + ... + v_n, a volume is above its part, so that P(V > v) <= P(X_1 > v_1) + ... + P(X_n > v_n), and likewise for
V <= v. The best parts give the bound, which two volumes can reach (Makarov, Theory of Probability and its Applications,
26, 803, 1982; Rueschendorf, Advances in Applied Probability, 14, 623, 1982). More than MOST partial sums are thinned
out, to the unfavourable side. Every function is pure; volumes are >= 0.
"""
from typing import NamedTuple, Sequence, Tuple

import numpy as np

MOST = 2048         # partial sums of several bodies


class Steps(NamedTuple):
    """A distribution of volumes: the largest first, and the share of the runs up to each of them, rising to 1."""
    volumes: np.ndarray
    shares: np.ndarray


def compute_share_above(steps: Steps, volumes: np.ndarray) -> np.ndarray:
    """P(V > v) of one body."""
    larger = len(steps.volumes) - np.searchsorted(steps.volumes[::-1], volumes, "right")
    return np.concatenate([[0.0], steps.shares])[larger]


def rank_by_rank(bodies: Sequence[Steps], volumes: np.ndarray) -> np.ndarray:
    """P(V > v) if the largest volume of one body comes with the largest of the others."""
    ends = np.unique(np.concatenate([one.shares for one in bodies]))
    total = np.zeros(len(ends))
    for one in bodies:      # up to a share its volume is that of the first one that reaches it
        total += one.volumes[np.searchsorted(one.shares, ends, "left")]
    return compute_share_above(Steps(total, ends), volumes)


def independent(bodies: Sequence[Steps], volumes: np.ndarray) -> np.ndarray:
    """P(V > v) if no body knows of the others."""
    sums, weights = np.zeros(1), np.ones(1)
    for one in bodies:
        sums, weights = rounded_up(sums, weights)
        # added up as by those who ask for the largest sum, which rounding then does not exceed
        sums = np.add.outer(sums, one.volumes).ravel()
        weights = np.outer(weights, np.diff(one.shares, prepend=0.0)).ravel()
    order = np.argsort(-sums, kind="stable")
    shares = np.concatenate([[0.0], np.cumsum(weights[order])])
    return np.minimum(shares[np.searchsorted(-sums[order], -volumes, "left")], 1.0)


def rounded_up(values: np.ndarray, weights: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """The same distribution with each value once; if these are more than MOST, with even steps, rounded up to them."""
    known, index = np.unique(values, return_inverse=True)
    if len(known) > MOST:
        even = np.linspace(known[0], known[-1], MOST)
        known, index = even, np.searchsorted(even, values)
    return known, np.bincount(index, weights, len(known))


def at_most(bodies: Sequence[Steps], volumes: np.ndarray) -> np.ndarray:
    """The largest P(V > v) that any dependence may give."""
    parts, chance = np.zeros(1), np.zeros(1)
    for one in bodies[:-1]:
        parts, chance = best(parts, chance, one.volumes, compute_share_above(one, one.volumes), -1)
    last = bodies[-1]
    return np.array([np.where(parts <= volume, compute_share_above(last, volume - parts) + chance, 1.0).min(initial=1.0)
                     for volume in volumes])


def at_least(bodies: Sequence[Steps], volumes: np.ndarray) -> np.ndarray:
    """The smallest P(V > v) that any dependence may give."""
    parts, chance = np.zeros(1), np.zeros(1)
    for one in bodies[:-1]:
        below = 1.0 - compute_share_above(one, np.nextafter(one.volumes, -1.0))
        parts, chance = best(parts, chance, one.volumes, below, 1)
    last = bodies[-1]
    return np.array([1.0 - (1.0 - compute_share_above(last, volume - parts) + chance).min(initial=1.0) for volume
                     in volumes])


def best(parts: np.ndarray, chance: np.ndarray, more: np.ndarray, with_chance: np.ndarray,
         side: int) -> Tuple[np.ndarray, np.ndarray]:
    """Sums of both parts and of their probabilities, but those for which another is as unlikely and as good.

    side: 1 if large parts are good, -1 if small ones are. Any of the sums gives a bound: MOST of them are kept.
    """
    sums, of_sums = np.add.outer(parts, more).ravel(), np.add.outer(chance, with_chance).ravel()
    order = np.lexsort((-side * sums, of_sums))
    good = side * sums[order]
    first = np.concatenate([[True], good[1:] > np.maximum.accumulate(good)[:-1]]) & (of_sums[order] < 1)
    kept = order[first]
    kept = kept[np.linspace(0, len(kept) - 1, min(len(kept), MOST)).astype(int)]
    return sums[kept], of_sums[kept]
