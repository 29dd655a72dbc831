"""A stand-in for an ensemble of a site: lengths and volumes on a road that follow from three variables; known events.

The length is that of the most and the least mobile mass of 1 million m3 on a fall of 1000 m, or so; with a jump no run
ends between 1750 and 2300 m. All functions are for arrays.
"""
import numpy as np

from slope_tools.mobility import events
from slope_tools.statistics import designs

JUMP = 1750.0, 2300.0       # m
ROAD = 1500.0               # m, where the road lies
RELATION = events.fit_relation(events.read_events())


def exceedance(length):
    """Share of known events beyond a length (m)."""
    return RELATION.exceedance(length, 1.0, np.full(np.shape(length), 1000.0))


def response(u, jump=False, chance=None):
    """Length (m) and volume on the road (m3) at points (n, 3) of the unit cube; chance: a generator of normal noise."""
    noise = chance.standard_normal(len(u)) if chance else np.zeros(len(u))
    logs = 3 + 0.5 * (1 - u[:, 0]) + 0.12 * (1 - u[:, 1]) + 0.06 * u[:, 2] * (1 - u[:, 0]) + 0.02 * noise
    if jump:
        logs = logs + np.where(logs > np.log10(JUMP[0]), np.log10(JUMP[1] / JUMP[0]), 0)
    length = 10 ** logs
    return length, 50 * np.clip(length - ROAD, 0, None) * (0.5 + u[:, 1]) * np.exp(0.1 * noise)


def runs(kind, number, seed, jump=False, chance=None):
    """Points, lengths and volumes of a design; kind: of designs."""
    u = designs.points(kind, 3, number, seed)
    return (u, *response(u, jump, chance))
