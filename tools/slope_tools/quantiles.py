"""Quantiles by weight, by one rule: the smallest of the values that a share of the weight lies at or below."""
import math

import numpy as np


def within(values, weights, share, lost=0.0):
    """Of values (n, or n and columns, each of its own) with weights (n), for a share or a list of shares.

    lost: weight of what lies beyond all values; infinite where the share does, too. NaN without weight. A number, or an
    array: shares, columns.
    """
    values, shares = np.asarray(values), np.reshape(share, -1)
    order = np.argsort(values, axis=0, kind="stable")
    upto = np.cumsum(np.asarray(weights, float)[order], axis=0)
    quantiles = np.full((len(shares), *values.shape[1:]), math.nan)
    if len(upto) and np.max(upto[-1]) > 0:
        ordered = np.take_along_axis(values, order, axis=0)
        for k, wanted in enumerate(np.multiply.outer(shares, upto[-1] + lost)):     # whatever the rounding
            at = (upto < np.minimum(wanted, upto[-1]) * (1 - 1e-12)).sum(axis=0, keepdims=True)
            one = np.take_along_axis(ordered, at, axis=0)[0]
            quantiles[k] = np.where(wanted > upto[-1] * (1 + 1e-9), math.inf, one)
    quantiles = quantiles.reshape(np.shape(share) + values.shape[1:])
    return quantiles if quantiles.shape else float(quantiles)
