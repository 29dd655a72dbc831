"""Weights of runs by known events: on stand-ins whose lengths follow from three variables, smoothly or with a jump."""

import numpy as np
import pytest


import known_twins as twins
from slope_tools.ensembles import conditioned
from slope_tools.statistics import designs

RUNS = 100


def weighted(lengths):
    return conditioned.compute_weights(lengths, twins.exceedance(lengths))


@pytest.mark.parametrize("kind", designs.KINDS)
def test_smooth_response(kind):
    named = 0
    for seed in range(20):
        found = weighted(twins.runs(kind, RUNS, seed)[1])
        assert found.distance < 0.08
        assert found.effective >= 50
        assert found.weights.sum() == pytest.approx(found.reached)
        named += len(found.gaps)
    assert named <= 3       # by chance, one of twenty


@pytest.mark.parametrize("kind", designs.KINDS)
def test_jump(kind):
    named = 0
    for seed in range(20):
        lengths = twins.runs(kind, RUNS, seed, jump=True)[1]
        found = weighted(lengths)
        low, high = lengths[lengths < twins.JUMP[0] + 1].max(), lengths[lengths > twins.JUMP[1] - 1].min()
        share = float(twins.exceedance(low) - twins.exceedance(high))
        assert share > 0.3
        assert max(found.gaps, key=lambda gap: gap.share) == pytest.approx((low, high, share))
        named += len(found.gaps) - 1
        assert found.distance < share / 2 + 0.08
    assert named <= 3


def test_independent_runs_have_few_gaps_by_chance():
    named = sum(bool(weighted(twins.response(np.random.default_rng(seed).random((RUNS, 3)))[0]).gaps)
                for seed in range(100))
    assert named <= 12


def test_what_no_run_reaches_is_not_shared_out():
    lengths = twins.runs("sobol", RUNS, 1)[1]
    short = lengths[lengths < 2000]
    found = weighted(short)
    assert found.far == pytest.approx(float(twins.exceedance(short.max())))
    assert found.short == pytest.approx(1 - float(twins.exceedance(short.min())))
    assert found.reached + found.short + found.far == pytest.approx(1)
    assert found.far > 0.5
    assert found.weights.sum() == pytest.approx(found.reached)


def test_weights_are_the_quotient_of_densities():
    """Of runs at even shares of one normal distribution, with known events of another."""
    from scipy import stats
    runs, events = stats.norm(5, 1.5), stats.norm(5.5, 1)
    x = runs.ppf((np.arange(2000) + 0.5) / 2000)
    found = conditioned.compute_weights(x[::-1], events.sf(x[::-1]))
    exact = events.pdf(x) / runs.pdf(x) / 2000
    inside = (x > 2.5) & (x < 8)
    assert found.weights[::-1][inside] == pytest.approx(exact[inside], rel=0.06)


def test_runs_of_one_length():
    found = conditioned.compute_weights([1000, 2000, 2000, 2000, 3000], [1, 0.5, 0.5, 0.5, 0])
    assert found.weights.sum() == pytest.approx(1)
    found = conditioned.compute_weights([2000, 2000], [0.4, 0.4])
    assert (found.reached, found.short, found.far, found.effective) == (0, pytest.approx(0.6), pytest.approx(0.4), 0)
    assert (found.weights == 0).all()


def test_few_runs_share_what_lies_between_two_of_them():
    found = conditioned.compute_weights([3000, 1000, 2000], [0.1, 0.8, 0.5])
    assert found.window == 1
    assert found.weights == pytest.approx([0.2, 0.15, 0.35])
    assert found.effective == pytest.approx(0.7 ** 2 / (0.2 ** 2 + 0.15 ** 2 + 0.35 ** 2))
    assert found.distance == pytest.approx(0.2)
