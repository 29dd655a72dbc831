"""Sobol indices of variables that depend on each other by weights, and those of runs weighted by known events."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

import known_twins as twins
from made_rows import row

from slope_tools.ensembles import known_events
from slope_tools.ensembles.sample import Sample
from slope_tools.statistics import dependent, distributions
from slope_tools.statistics.entries import Analysis

VARIABLES = tuple(distributions.Range(name, "0:1", 0.0, 1.0, stats.uniform(), 1.0) for name in "abc")


def test_independent_variables_have_the_usual_indices():
    """Ishigami's function with a = 7, b = 0.1."""
    def ishigami(u):
        x = np.pi * (2 * u - 1)
        return np.sin(x[:, 0]) * (1 + 0.1 * x[:, 2] ** 4) + 7 * np.sin(x[:, 1]) ** 2
    first, total = dependent.indices(ishigami, lambda u: np.ones(len(u)), 3, base=2048)
    assert first == pytest.approx([0.3139, 0.4424, 0], abs=0.01)
    assert total == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.01)


def test_dependent_variables_in_closed_form():
    """x + y, both in the same half: var(E(. | x)) = 1/12 + 1/16 + 1/8, var(. | y) = 1/48, variance 1/6 + 1/8."""
    first, total = dependent.indices(lambda u: u.sum(axis=1),
                                     lambda u: ((u[:, 0] < 0.5) == (u[:, 1] < 0.5)) * 1.0, 2)
    assert first == pytest.approx([13 / 14] * 2, abs=0.005) and total == pytest.approx([1 / 14] * 2, abs=0.005)


def test_no_weight_at_all():
    with pytest.raises(ValueError, match="no place has a weight"):
        dependent.indices(lambda u: u[:, 0], lambda u: np.zeros(len(u)), 2)


def speed(u, chance=None):
    """A quantity that does not follow from the length alone."""
    noise = 0.05 * chance.standard_normal(len(u)) if chance else 0
    return u[:, 0] + 0.5 * u[:, 1] + 0.5 * u[:, 1] * u[:, 2] + noise


def runs_of(number, seed, chance=None):
    """known_events.Runs of a stand-in, with its speeds."""
    u, lengths, _ = twins.runs("sobol", number, seed, chance=chance)
    rows = [row(length_m=length, max_speed_m_s=value, set=dict(zip("abc", map(repr, place))))
            for place, length, value in zip(u.tolist(), lengths, speed(u, chance))]
    found = SimpleNamespace(exceedance=twins.exceedance)
    return known_events.Runs(Sample(number, "sobol", seed, VARIABLES), [], rows, found)


def test_weighted_runs_have_the_indices_of_their_response():
    """64 runs, with chance, against the response itself and the weights of 4,096 runs."""
    many = runs_of(4096, 1)
    order = many.mass.order
    by_length = np.log(many.lengths[order]), many.mass.share[order]
    exact = dependent.indices(speed, lambda u: np.interp(np.log(twins.response(u)[0]), *by_length), 3)
    found = known_events.evaluate_influence(runs_of(64, 3, np.random.default_rng(3)), "max_speed_m_s")
    variables = found.variables
    plain = dependent.indices(speed, lambda u: np.ones(len(u)), 3)
    assert plain[0][0] - exact[0][0] > 0.15 and exact[1][1] - plain[1][1] > 0.1   # weights matter
    for k, name in enumerate("abc"):
        one = variables[name]
        assert one.first == pytest.approx(exact[0][k], abs=0.08)
        assert one.total == pytest.approx(exact[1][k], abs=0.08)


def test_few_runs_have_none():
    found = known_events.evaluate_influence(runs_of(6, 3), "max_speed_m_s")
    assert found == Analysis("no indices: the runs are too few for an emulator of their lengths", None, {})
