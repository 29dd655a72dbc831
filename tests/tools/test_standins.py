"""Twenty stand-ins with known volumes on a road: how many lie in the 90 % band of an ensemble that known events weigh.

A stand-in is a mass of a volume and a fall; it ends where one known event of these, drawn by the relation of the 49,
did. Its deposit is a wedge that thins out towards its tip, by an exponent and on a width that nobody knows; on a road
of 10 m lies what the wedge has there. The ensemble has the same law with an exponent of its own, and draws what nobody
knows; how far its runs go has nothing to do with the events. Stated before anything was run: 15 to 20 of 20 within the
band of 5 to 95 %, and its upper end at most 4 times its middle (median of the stand-ins half of whose runs reach it).
"""

import numpy as np


from slope_tools.ensembles import conditioned
from slope_tools.mobility import events
from slope_tools.statistics import designs

RELATION = events.fit_relation(events.read_events())
NUMBER, RUNS, ROAD = 20, 64, 10.0
INSIDE, FACTOR = (15, 20), 4.0
BAND = 0.05, 0.5, 0.95


def on_road(volume, length, at, exponent, spread):
    """m3 on the road at a distance (m) of a mass (m3) that ends at a length (m); spread: its width over the mean."""
    width = 3 * volume ** (1 / 3) * spread
    thickest = volume * (exponent + 1) / (width * length)       # at the source
    return ROAD * width * thickest * np.clip(1 - at / length, 0, None) ** exponent


def stand_in(rng, mean_exponent):
    """The true volume on its road, and the band of its ensemble; mean_exponent: of the ensemble's deposits."""
    volume, fall = 10 ** rng.uniform(-0.5, 2), rng.uniform(300, 1500)       # million m3, m
    true, at = (RELATION.quantile(share, volume, fall) for share in (rng.uniform(), rng.uniform(0.02, 0.6)))
    truth = on_road(1e6 * volume, true, at, rng.uniform(0.6, 1.4), rng.uniform(0.7, 1.3))
    u = designs.points(designs.SOBOL, 3, RUNS, int(rng.integers(1000)))
    lengths = RELATION.quantile(0.5, volume, fall) * 10 ** (-0.5 + u[:, 0] + 0.02 * rng.standard_normal(RUNS))
    found = on_road(1e6 * volume, lengths, at, mean_exponent - 0.4 + 0.8 * u[:, 1], 0.7 + 0.6 * u[:, 2])
    weighted = conditioned.compute_weights(lengths, RELATION.exceedance(lengths, volume, np.full(RUNS, fall)))
    assert weighted.far < 0.05
    curve = conditioned.compute_known_curve(found, conditioned.masses(weighted))
    return truth, [one.value for one in conditioned.compute_known_quantiles(curve, BAND)]


def inside(seed, mean_exponent=1.0, wrong=1.0):
    """How many of the stand-ins lie within their band, and the median of upper end over middle; wrong: a factor."""
    rng = np.random.default_rng(seed)
    found = [stand_in(rng, mean_exponent) for _ in range(NUMBER)]
    held = sum(low <= wrong * truth <= high for truth, (low, _, high) in found)
    return held, float(np.median([high / middle for _, (_, middle, high) in found if middle > 0]))


def test_most_lie_within_the_band_and_it_is_narrow_enough():
    held, factor = inside(1)
    assert INSIDE[0] <= held <= INSIDE[1] and factor <= FACTOR, (held, factor)


def test_deposits_that_are_flatter_or_steeper_than_the_stand_ins():
    for exponent in (0.8, 1.2):
        assert inside(2, exponent)[0] >= INSIDE[0]


def test_volumes_that_are_wrong_are_found_out():
    """A control: of truths ten times as large hardly those lie within the band that are 0."""
    assert inside(1, wrong=10.0)[0] < INSIDE[0]
