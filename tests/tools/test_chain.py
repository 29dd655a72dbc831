"""From an earthquake to the volume on the road: sums over bodies, peaks and runs against direct simulations."""
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import made_rows

from slope_tools.seismic import chain, chain_files, fragility
from slope_tools.sites.site_found import SlipBody
from slope_tools.statistics import distributions
from slope_tools.tables import study_types

RATE = fragility.Hazard(np.array([50.0, 200.0, 800.0, 2000.0]), np.array([1e-2, 1e-3, 3e-5, 1e-6]))
VOLUMES = np.array([0.0, 50.0, 120.0, 200.0, 350.0, 450.0])
PEAKS = np.array([100.0, 300.0, 500.0, 1000.0])


def capacities(medians=(300.0, 420.0, 500.0), samples=256, records=3):
    """Lognormal, with a strength that the bodies share in part."""
    rng = np.random.default_rng(7)
    common, own = rng.normal(size=(fragility.REPLICATES * samples, 1, 1)), rng.normal(size=(1, records, 1))
    alone = rng.normal(size=(fragility.REPLICATES * samples, records, len(medians)))
    return np.array(medians) * np.exp(0.3 * common + 0.2 * own + 0.15 * alone)


def runs():
    """Volumes of the runs of three bodies, different numbers of them."""
    rng = np.random.default_rng(11)
    return [rng.gamma(2.0, 60.0, 12), np.where(rng.random(8) < 0.5, 0.0, rng.gamma(4.0, 50.0, 8)),
            rng.gamma(1.0, 90.0, 5)]


def bodies(volumes=None):
    return [chain.compute_left_volume(one, range(len(one)), 1000.0) for one in (runs() if volumes is None else volumes)]


def simulated(capacity, given, at_peaks, rng, volumes):
    """Shares above volumes on the road, one run for each peak: of a sample and a record at random.

    Of each set of bodies that fail, the larger share of runs with one rank in all bodies, and of runs at random.
    """
    sample, record = (rng.integers(size, size=len(at_peaks)) for size in capacity.shape[:2])
    fails = capacity[sample, record] < at_peaks[:, None]
    ordered = [np.sort(one)[::-1] for one in given]
    total = np.zeros(len(volumes))
    for one in np.unique(fails, axis=0):
        number = int((fails == one).all(axis=1).sum())
        shares = []
        for ranks in (np.tile(rng.random(number), (len(given), 1)), rng.random((len(given), number))):
            left = sum(fail * volume[(rank * len(volume)).astype(int)]
                       for fail, volume, rank in zip(one, ordered, ranks))
            shares.append((left[:, None] > volumes).sum(axis=0))
        total += np.max(shares, axis=0)
    return total / len(at_peaks)


def test_one_peak_is_a_direct_simulation():
    capacity, number = capacities(), 200000
    band = chain.family(capacity, PEAKS, bodies(), VOLUMES)
    rng = np.random.default_rng(1)
    for k, peak in enumerate(PEAKS):
        share = simulated(capacity, runs(), np.full(number, peak), rng, VOLUMES)
        assert band.value[k] == pytest.approx(share, abs=4 * np.sqrt(0.25 / number))
    assert 0 < band.value[0, 0] < 0.05 and band.value[-1, 0] > 0.9 and band.value[2, 2] > 0.3
    assert (band.low <= band.value).all() and (band.value <= band.high).all() and (band.high <= 1).all()


def test_the_sum_over_peaks_is_a_direct_simulation_of_years():
    """Earthquakes as often as the curve says, peaks by its inverse; those above its last point count as that one."""
    capacity, number = capacities(), 400000
    found = chain.frequency(capacity, RATE, PEAKS, bodies(), VOLUMES)
    rng = np.random.default_rng(2)
    first = RATE.rates[0]
    at = np.exp(np.interp(-np.log(rng.random(number) * first), -np.log(RATE.rates), np.log(RATE.peaks)))
    above = simulated(capacity, runs(), at, rng, VOLUMES)
    error = np.sqrt(above * (1 - above) / number)
    assert (error > 0).all() and (error < 0.25 * above).all()
    assert found.total.value == pytest.approx(first * above, abs=4 * first * error.max())
    assert (np.abs(found.total.value - first * above) < 4 * first * error).all()
    assert sum(part for *_, part in found.parts) == pytest.approx(found.total.value, rel=1e-9)
    inner = (at >= 300) & (at < 500)
    share = simulated(capacity, runs(), at[inner], rng, VOLUMES) * inner.mean()
    part = next(part for a, b, part in found.parts if (a, b) == (300.0, 500.0))
    assert part == pytest.approx(first * share, abs=4 * first * np.sqrt(share.max() / number))


def test_without_joint_failures_it_is_the_sum_over_the_bodies():
    """Two bodies of which one at most fails: each one's probability times the share of its runs."""
    capacity = capacities((300.0, 300.0))
    first = np.arange(len(capacity)) % 2 == 0
    capacity[first, :, 0], capacity[~first, :, 1] = np.inf, np.inf
    given = runs()[:2]
    fails = np.array([(capacity < peak).mean(axis=(0, 1)) for peak in PEAKS])
    share = np.array([(one[:, None] > VOLUMES).mean(axis=0) for one in given])
    assert chain.family(capacity, PEAKS, bodies(given), VOLUMES).value == pytest.approx(fails @ share)


def test_bodies_that_fail_together_add_their_volumes():
    """Runs of 100, 300 and 50 to 80 m3: 0.875 of all pairs above 155, 0.75 rank by rank; above 371 0.125 and 0.25."""
    always = np.full((fragility.REPLICATES, 1, 2), 10.0)
    two = bodies([[100.0, 300.0], [50.0, 60.0, 70.0, 80.0]])
    found = chain.family(always, np.array([20.0]), two, np.array([0.0, 149.0, 155.0, 365.0, 371.0, 379.0, 380.0]))
    assert found.value[0] == pytest.approx([1, 1, 0.875, 0.5, 0.25, 0.25, 0])


def test_a_body_that_never_fails_changes_nothing():
    capacity = capacities((300.0, 420.0))
    more = np.concatenate([capacity, np.full((*capacity.shape[:2], 1), np.inf)], axis=2)
    with_it, without = (chain.family(one, PEAKS, bodies(), VOLUMES) for one in (more, capacity))
    assert all(np.array_equal(a, b) for a, b in zip(with_it, without))
    with_it, without = (chain.frequency(one, RATE, PEAKS, bodies(), VOLUMES) for one in (more, capacity))
    assert with_it.total.value == pytest.approx(without.total.value, rel=1e-12)
    assert chain.weights(more, PEAKS)[2] == 0 and chain.weights(more, PEAKS, RATE)[2] == 0
    assert chain.weights(np.full((16, 1, 3), np.inf), PEAKS, RATE).tolist() == [0, 0, 0]


def test_weights_are_the_frequencies_of_failure():
    capacity = capacities()
    each = [float(fragility.frequency(capacity[:, :, k], RATE, PEAKS).total.value) for k in range(3)]
    assert chain.weights(capacity, PEAKS, RATE) == pytest.approx(np.array(each) / sum(each), rel=1e-9)
    assert chain.weights(capacity, PEAKS).sum() == pytest.approx(1)


def test_what_no_peak_of_the_curve_reaches_does_not_fail():
    """Half of the samples fail above the curve's last peak: the other half alone counts, and beyond says so, for what
    the body leaves in its runs; of a body that no peak of the curve reaches there are none."""
    capacity = np.full((fragility.REPLICATES * 4, 1, 1), 300.0)
    capacity[::2] = 3000.0
    found = chain.frequency(capacity, RATE, PEAKS, bodies([[100.0, 200.0]]), np.array([0.0, 150.0, 250.0]))
    assert found.total.value == pytest.approx(float(RATE.at(300.0)) * np.array([0.5, 0.25, 0.0]))
    assert found.beyond == pytest.approx(1e-6 * np.array([0.5, 0.25, 0.0]))
    for other, beyond in ((3000.0, [0.5, 0.75, 1.0]), (np.inf, [0.5, 0.25, 0.0])):
        never = np.concatenate([capacity, np.full(capacity.shape, other)], axis=2)
        both = [*bodies([[100.0, 200.0]]), chain.compute_left_volume([0.0], [0], 0.0)]
        found = chain.frequency(never, RATE, PEAKS, both, np.array([0.0, 150.0, 250.0]))
        assert found.beyond == pytest.approx(1e-6 * np.array(beyond))


def test_a_body_that_fails_above_the_hazard_curve_counts_at_such_peaks():
    """One fails at 300 gal, one of 5,000 m3 at 3,000, where the curve ends at 2,000: all of it is on the road there."""
    capacity = np.full((fragility.REPLICATES * 4, 1, 2), 300.0)
    capacity[..., 1] = 3000.0

    class Given:
        bodies, bases, folder, peaks, rate = ("1", "2"), ("a", "b"), "fragility", np.array([1000.0, 4000.0]), RATE

    Given.capacity = capacity
    site = {"1": SlipBody(100.0, None, "a"), "2": SlipBody(5000.0, None, "b")}
    asked = chain_files.check_chain(Given, site, "site", [])
    assert asked.weights == pytest.approx({"1": 1.0, "2": 1e-6})
    _, [varied] = chain_files.options(asked)
    assert distributions.distribution("body", varied.partition("=")[2], "--vary", varied).value(0.999) == "1"
    left = chain_files.list_left_volumes(asked, [made_rows.row(set={"body": "1"}, remove_on_road_m3=50.0)], None)
    found = chain.family(capacity, Given.peaks, left, np.array([0.0, 1000.0]))
    assert found.value.tolist() == [[1, 0], [1, 1]]
    assert chain.weights(capacity[..., 1:], Given.peaks, RATE).tolist() == [1.0]


def test_a_peak_at_which_no_sample_fails_is_bounded():
    capacity = np.full((fragility.REPLICATES * 4, 1, 1), 300.0)
    found = chain.family(capacity, np.array([100.0]), bodies([[100.0]]), np.array([0.0, 50.0]))
    assert found.value.max() == 0 and found.high[0] == pytest.approx([1 - 0.05 ** (1 / 64)] * 2)


def test_more_is_never_more_likely():
    volumes = np.linspace(0, 1500, 200)
    found = chain.family(capacities(), PEAKS, bodies(), volumes)
    yearly = chain.frequency(capacities(), RATE, PEAKS, bodies(), volumes).total
    for one in (*found, *(side[None] for side in yearly)):
        assert (np.diff(one, axis=1) <= 0).all()
    assert (np.diff(found.value, axis=0) >= 0).all()        # nor with a smaller peak


def test_without_runs_the_whole_body_is_on_the_road():
    always = np.full((fragility.REPLICATES, 1, 1), 10.0)
    found = chain.family(always, np.array([20.0]), [chain.compute_left_volume([], [], 800.0)],
                         np.array([0.0, 799.0, 800.0]))
    assert found.value[0].tolist() == [1, 1, 0] and found.high[0].tolist() == [1, 1, 0] and (found.low == 0).all()


def test_bounds_of_runs_and_of_runs_that_failed():
    """Of 4 runs none above 100: by Clopper and Pearson 1 - 0.05^(1/4) may be, as much as the body has."""
    always = np.full((fragility.REPLICATES, 1, 1), 10.0)
    body = chain.compute_left_volume([70.0, 80.0, 90.0, 100.0], range(4), 800.0)
    found = chain.family(always, np.array([20.0]), [body], np.array([100.0, 799.0, 800.0]))
    assert found.value[0, 0] == 0 and found.high[0] == pytest.approx([1 - 0.05 ** 0.25, 1 - 0.05 ** 0.25, 0])
    one_failed = chain.compute_left_volume([70.0, 80.0, 90.0, 100.0], range(4), 800.0, failed=1)
    more = chain.family(always, np.array([20.0]), [one_failed], np.array([100.0]))
    assert more.high[0, 0] == pytest.approx(stats.beta.ppf(0.95, 2, 4))


def test_bands_hold_what_they_promise():
    """Of 100 studies with 24 runs of a body, their bands of 90 % hold the truth 86 times at least (one body)."""
    rng, inside = np.random.default_rng(3), 0
    capacity = capacities((350.0,))
    truth = (capacity < 400).mean() * np.exp(-1.0)
    for _ in range(100):
        drawn = rng.exponential(100.0, 24)
        band = chain.family(capacity, np.array([400.0]), bodies([drawn]), np.array([100.0]))
        inside += band.low[0, 0] <= truth <= band.high[0, 0]
    assert inside >= 86


@pytest.mark.parametrize("number", [2, 3])
def test_upper_bounds_hold_for_the_worst_dependence(number):
    """Of 100 studies with 24 runs of each body, bounds of 90 % hold P(V > v) of independent bodies 95 times, and the
    upper one that of the worst dependence: of exponential volumes the best parts of v are equal, quantiles of 0.8.
    """
    rng, held = np.random.default_rng(4), np.zeros(2, int)
    quantile = -100 * np.log(0.2)
    level = np.array([number * quantile])
    worst = 0.2 * number
    apart = stats.gamma.sf(level[0], number, scale=100.0)
    always = np.full((fragility.REPLICATES, 1, number), 10.0)
    for _ in range(100):
        drawn = [rng.exponential(100.0, 24) for _ in range(number)]
        band = chain.family(always, np.array([20.0]), [chain.compute_left_volume(one, range(24), 1e5) for one in drawn],
                            level)
        held += [band.high[0, 0] >= worst, band.low[0, 0] <= apart <= band.high[0, 0]]
    assert (held >= 95).all()


def test_a_frequency_that_the_curve_cuts_is_a_least_one():
    """Where the letter and the console have it, not only among the caveats."""
    one = study_types.PerYear(50.0, 2e-3, 1e-3, 3e-3, 1e-4, [])
    assert chain_files.describe_yearly(one, "90 %", False) == "0.002 per year (90 %: 0.001 to 0.003)"
    assert chain_files.describe_yearly(one, "90 %", True).startswith("at least 0.002 per year")
    assert chain_files.describe_yearly(replace(one, more_at_most=3e-4), "90 %", False).startswith("at least 0.002 ")
    never = replace(one, value=0.0, low=0.0, high=1e-5)
    assert chain_files.describe_yearly(never, "90 %", False) == "at most 0.00011 per year (90 %)"
    assert chain_files.describe_yearly(never, "90 %", True).endswith(
        "(90 %, but for peaks below the hazard curve's first)")
