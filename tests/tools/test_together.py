"""Sums of volumes that depend on each other in any way: bounds against the extreme couplings, by linear programs."""
import itertools

import numpy as np
import pytest
from scipy import optimize


from slope_tools.seismic import chain, together
from slope_tools.seismic.together import Steps

VOLUMES = np.arange(0.0, 16.0)


def drawn(rng, most=5):
    """A distribution of a few whole volumes, 0 among them at times."""
    size = rng.integers(1, most)
    values = rng.choice(6, size, replace=False).astype(float)
    return Steps(np.sort(values)[::-1], np.concatenate([np.cumsum(rng.dirichlet(np.ones(size)))[:-1], [1.0]]))


def weights(one):
    return np.diff(one.shares, prepend=0.0)


def extremes(bodies, volume):
    """The smallest and the largest P(sum > volume) over all joint distributions of bodies: two linear programs."""
    joint = list(itertools.product(*(range(len(one.volumes)) for one in bodies)))
    exceeds = np.array([sum(one.volumes[i] for one, i in zip(bodies, at)) > volume for at in joint], float)
    rows = np.array([[at[k] == i for at in joint] for k, one in enumerate(bodies)
                     for i in range(len(one.volumes))], float)
    given = np.concatenate([weights(one) for one in bodies])
    least, largest = (optimize.linprog(sign * exceeds, A_eq=rows, b_eq=given, method="highs") for sign in (1, -1))
    assert least.status == 0 and largest.status == 0
    return least.fun, -largest.fun


def test_two_volumes_reach_the_bounds():
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(60):
        bodies = [drawn(rng), drawn(rng)]
        low, high = together.at_least(bodies, VOLUMES), together.at_most(bodies, VOLUMES)
        for k, volume in enumerate(VOLUMES[:11]):
            assert (low[k], high[k]) == pytest.approx(extremes(bodies, volume), abs=1e-9), (bodies, volume)
            seen.add((0 < low[k] < 1, 0 < high[k] < 1, low[k] < high[k]))
    assert (True, True, True) in seen and (True, True, False) in seen


@pytest.mark.parametrize("number", [3, 4])
def test_no_dependence_of_several_volumes_is_beyond_the_bounds(number):
    rng = np.random.default_rng(number)
    reached, cases = 0, 0
    for _ in range(12):
        bodies = [drawn(rng, 4) for _ in range(number)]
        low, high = together.at_least(bodies, VOLUMES), together.at_most(bodies, VOLUMES)
        for k, volume in enumerate(VOLUMES):
            least, largest = extremes(bodies, volume)
            assert low[k] <= least + 1e-9 and largest <= high[k] + 1e-9, (bodies, volume)
            cases += 2
            reached += int(low[k] > least - 1e-9) + int(high[k] < largest + 1e-9)
    assert reached > 0.95 * cases       # they are near


def test_both_sums_are_what_they_say():
    """All pairs and triples of values, and the same quantile of each."""
    rng = np.random.default_rng(5)
    for number in (1, 2, 3):
        bodies = [drawn(rng) for _ in range(number)]
        chance = np.zeros(len(VOLUMES))
        for at in itertools.product(*(range(len(one.volumes)) for one in bodies)):
            total = sum(one.volumes[i] for one, i in zip(bodies, at))
            chance += np.prod([weights(one)[i] for one, i in zip(bodies, at)]) * (total > VOLUMES)
        assert together.independent(bodies, VOLUMES) == pytest.approx(chance, abs=1e-12)
        ranks = (np.arange(20000) + 0.5) / 20000
        total = sum(one.volumes[np.searchsorted(one.shares, ranks)] for one in bodies)
        chance = (total[:, None] > VOLUMES).mean(axis=0)
        assert together.rank_by_rank(bodies, VOLUMES) == pytest.approx(chance, abs=2e-4)


def test_the_largest_sum_is_not_exceeded():
    """Not by a rounding either: v - a may be less than b though v is a + b."""
    rng = np.random.default_rng(9)
    for number in (2, 3):
        for _ in range(200):
            bodies = [Steps(np.sort(rng.gamma(2.0, 60.0, 4))[::-1], (np.arange(4) + 1) / 4) for _ in range(number)]
            largest = np.array([sum(one.volumes[0] for one in bodies)])
            for of in (together.independent, together.rank_by_rank):
                assert of(bodies, largest)[0] == 0 < of(bodies, largest * (1 - 1e-12))[0]


def test_many_runs_are_thinned_out_to_the_unfavourable_side(monkeypatch):
    rng = np.random.default_rng(6)
    bodies = [Steps(np.sort(rng.gamma(2.0, 60.0, n))[::-1], (np.arange(n) + 1) / n) for n in (37, 41, 43)]
    volumes = np.linspace(0.0, 1200.0, 60)
    monkeypatch.setattr(together, "MOST", 10 ** 6)
    exact = [of(bodies, volumes) for of in (together.independent, together.at_most, together.at_least)]
    monkeypatch.setattr(together, "MOST", 30)
    rough = [of(bodies, volumes) for of in (together.independent, together.at_most, together.at_least)]
    for near, far, side in zip(exact, rough, (1, 1, -1)):
        assert (side * (far - near) >= -1e-12).all() and 0 < np.abs(far - near).max() < 0.06


def test_one_run_in_five_reaches_the_road():
    """n bodies: 1 - 0.8^n of independent ones; n times 0.2 if they never do together, 0.2 if they always do."""
    of = chain.compute_left_volume([0.0] * 80 + [800.0] * 20, range(100), 5000.0)
    for number in (2, 3):
        bodies = [of] * number
        found = chain.Sums(bodies, np.array([500.0])).of(2 ** number - 1)
        assert found.value[0] == pytest.approx(1 - 0.8 ** number)
        assert together.at_most([of.value] * number, [500.0]) == pytest.approx(0.2 * number)
        assert together.at_least([of.value] * number, [500.0]) == pytest.approx(0.2)
        assert found.high[0] > 0.2 * number and 0.1 < found.low[0] < 0.2


def test_large_sums_are_likelier_rank_by_rank():
    """Half of the runs leave 1000 m3: more than 1500 m3 by two bodies with 0.5 rank by rank, with 0.25 independent."""
    of = chain.compute_left_volume([0.0] * 32 + [1000.0] * 32, range(64), 5000.0)
    found = chain.Sums([of, of], np.array([500.0, 1500.0])).of(3)
    assert found.value == pytest.approx([0.75, 0.5])
    assert together.at_least([of.value] * 2, [500.0, 1500.0]) == pytest.approx([0.5, 0.0])
    assert together.at_most([of.value] * 2, [500.0, 1500.0]) == pytest.approx([1.0, 0.5])


def test_the_value_lies_between_its_bounds():
    rng = np.random.default_rng(8)
    volumes = np.linspace(0.0, 2500.0, 80)
    for number in (1, 2, 3, 4):
        bodies = [chain.compute_left_volume(np.round(rng.gamma(1.0, 90.0, rng.integers(3, 90)), rng.integers(-2, 3)),
                                            range(200), 1000.0) for _ in range(number)]
        band = chain.Sums(bodies, volumes).of(2 ** number - 1)
        assert (band.low <= band.value).all() and (band.value <= band.high).all() and (band.high <= 1).all()
        assert all((np.diff(side) <= 0).all() for side in band) and band.low.max() > 0
