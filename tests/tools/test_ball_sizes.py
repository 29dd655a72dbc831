"""Values at the finest size of balls, with their errors: the models of what halving the balls does."""
import math
import os
import subprocess
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

import made_rows
from run_helpers import TOP
from slope_tools import cli
from slope_tools.deposits import deposit, volume
from slope_tools.ensembles import known_events
from slope_tools.mobility import run_length
from slope_tools.statistics import ball_sizes
from slope_tools.statistics.ball_sizes import Finest, fit_step, transfer
from slope_tools.statistics.entries import KnownQuantile
from slope_tools.studies import size_runs
from slope_tools.tables import sizes

MEASURED = Path(__file__).with_name("ball_sizes.csv")
MEASURED_TOO = MEASURED.with_name("ball_sizes_narrow.csv")


def none(number):
    """Places without parameters."""
    return np.empty((number, 0))


def test_a_factor_by_hand():
    """The mean of the logarithms; the deviation is that of the left-out ones."""
    changes = np.array([0.1, 0.2, 0.3, 0.4])
    coarse = np.array([400.0, 800, 100, 200])
    step = fit_step(coarse, coarse * np.exp(changes), none(4))
    left_out = [0.1 - 0.3, 0.2 - 0.8 / 3, 0.3 - 0.7 / 3, 0.4 - 0.2]
    assert step.ratio.constant == pytest.approx(0.25) and step.ratio.freedom == pytest.approx(3)
    assert step.ratio.deviation == pytest.approx(math.sqrt(sum(one ** 2 for one in left_out) / 4))
    found = transfer([step, step], 1000.0, ())
    assert found.value == pytest.approx(1000 * math.exp(0.5))
    assert found.deviation == pytest.approx(found.value * step.ratio.deviation * math.sqrt(2))
    assert found.freedom == pytest.approx(6)
    low, high = found.band
    assert low * high == pytest.approx(found.value ** 2) and high / found.value == pytest.approx(
        math.exp(1.943 * found.deviation / found.value), rel=1e-3)
    assert transfer([], 1000.0, ()).band == (1000.0, 1000.0)        # of a run with the finest balls


def test_few_balls_have_a_difference():
    """Below ten coarse balls; what is nothing stays nothing."""
    step = fit_step([0, 20, 40, 500, 600], [0, 10, 50, 500, 660], none(5), ball=10)
    assert step.least == 100 and step.small.number == 3 and step.ratio.number == 2
    assert transfer([step], 50.0, ()).value == pytest.approx(50.0)
    assert transfer([step], 50.0, ()).deviation == pytest.approx(step.small.deviation)
    nothing = fit_step([0, 0, 0, 0], [0, 0, 0, 0], none(4), ball=10)
    assert transfer([nothing], 0.0, ()) == Finest(0.0) and nothing.ratio is None
    # of too few small pairs a difference scatters as a ratio at its end
    few = fit_step([50, 200, 400, 800], [50, 220, 400, 860], none(4), ball=10)
    assert transfer([few], 0.0, ()).deviation == pytest.approx(100 * few.ratio.deviation)
    assert transfer([few], 0.0, ()).band[0] == 0
    # of what is no volume, nothing has a difference, too
    hours = fit_step([0, 0, 10, 20], [4, 6, 11, 22], none(4))
    assert transfer([hours], 0.0, ()).value == 5
    assert (ball_sizes.draws([[hours]] * 2, [0.0, 10.0], none(2), 50) > 0).all()


def test_a_single_pair_is_no_certainty():
    """All of its change may be error."""
    for coarse, fine in (([100, 0, 0], [130, 0, 0]), ([100], [130])):
        step = fit_step(coarse, fine, none(len(coarse)), ball=1)
        low, high = transfer([step], 500.0, ()).band
        assert low < 500 and high > 1000


def test_draws_leave_no_more_than_was_released():
    rows = [[made_rows.row(variables={"d": d}, remove_m3=remove, released_m3=2500.0, ball_m3=1.0)
             for remove in volumes] for d, volumes in (("2", (1000.0, 2000.0)), ("1", (1500.0, 2100.0)))]
    drawn = sizes.combine_sizes([*zip(*rows)]).draws(rows[0], "remove_m3", 200)
    assert drawn.max() == 2500 and drawn.min() < 1500


def test_what_no_finer_run_has_is_unknown():
    """As the length where all finer runs leave the terrain; the finer runs keep what they have."""
    def one(d, length, lobes=None):
        return made_rows.row(variables={"d": str(d)}, remove_m3=100.0, distance_99_m=length, length_m=length,
                             length_by_lobe_m=lobes, ball_m3=1.0)

    coarse, fine = [one(2, 50.0, [60.0, 40.0]) for _ in range(4)], [one(1, None) for _ in range(2)]
    found = sizes.combine_sizes([*zip(coarse, fine), *([only] for only in coarse[2:])])
    got = [found.row(each) for each in (coarse[3], fine[0])]
    assert [each.distance_99_m for each in got] == [None, None] and [each.length_m for each in got] == [None, None]
    assert got[0].road.remove_m3 == 100 and found.steps["distance_99_m"][0].known is False


def test_no_more_is_removed_than_was_released():
    coarse, fine = ([made_rows.row(variables={"d": d}, remove_m3=remove, released_m3=1000.0, ball_m3=1.0,
                                   blocked_m=remove / 10, axis_m=104.0) for remove in volumes]
                    for d, volumes in (("2", (500.0, 600.0, 950.0)), ("1", (700.0, 840.0))))
    found = sizes.combine_sizes([*zip(coarse, fine), coarse[2:]])
    assert found.row(coarse[2]).road.blocked_m == 104       # nor is more of a road blocked than there is
    assert found.row(coarse[2]).road.remove_m3 == 1000 and found.row(coarse[0]).road.remove_m3 == pytest.approx(700)


def test_a_quantile_is_no_lower_than_errors_of_runs_make_it():
    """Independent errors of many runs raise a high quantile: the number lies between the ends of its own draws."""
    rng, number = np.random.default_rng(4), 100
    lengths = np.linspace(50.0, 150.0, number)

    def draw(_, key):
        volumes = 1000 * np.exp(0.1 * rng.standard_normal((50, number)))
        return np.tile(lengths, (50, 1)) if key == "length_m" else volumes

    runs = SimpleNamespace(rows=[], exceedance=lambda one: 1.0 - (np.asarray(one) - 40) / 120,
                           weights=SimpleNamespace(ratio=None))
    [found] = known_events.transferred([KnownQuantile(0.8, 1000.0, 950.0, None)], runs, draw)
    assert 1040 < found.value < 1200 and found.transfer[0] == 0 < found.transfer[1]
    [same] = known_events.transferred([KnownQuantile(0.8, 1100.0, 950.0, None)], runs, draw)
    assert same.value == pytest.approx(1100, abs=40)


def test_a_page_shows_a_run_of_the_finest_balls_where_one_is_about_as_large():
    rows = [made_rows.row(run=run, variables={"d": d}, remove_m3=remove, ball_m3=1.0)
            for run, d, remove in (("a", "2", 500.0), ("b", "1", 520.0), ("c", "1", 700.0), ("d", "2", 900.0))]
    shown = [sizes.nearest(rows, "remove_m3", value).run for value in (500.0, 690.0, 890.0)]
    assert shown == ["b", "c", "d"]


def test_parameters_count_where_they_predict_better():
    rng = np.random.default_rng(1)
    at = rng.random((16, 2))
    noise = 0.02 * rng.standard_normal(16)
    coarse = 1000 * np.exp(rng.standard_normal(16))
    with_slope = fit_step(coarse, coarse * np.exp(0.1 + 0.5 * at[:, 0] + noise), at)
    without = fit_step(coarse, coarse * np.exp(0.1 + noise), at)
    assert with_slope.ratio.slopes == pytest.approx([0.5, 0.0, 0.0], abs=0.1)
    assert np.abs(without.ratio.slopes).max() < 0.02 and without.ratio.constant == pytest.approx(0.1, abs=0.02)
    value = transfer([with_slope], 1000.0, (0.9, 0.5))
    assert value.value == pytest.approx(1000 * math.exp(0.55), rel=0.03) and value.deviation < 50
    # nothing is extrapolated: beyond the pairs it is that of the last of them, and what the slope says is an error
    beyond, last = (transfer([with_slope], 1000.0, (one, 0.5)) for one in (1.5, at[:, 0].max()))
    assert beyond.value == last.value
    assert beyond.deviation == pytest.approx(
        beyond.value * with_slope.ratio.slopes[0] * (1.5 - at[:, 0].max()), rel=0.1)
    # smaller values than those of all pairs have an error of as many m3
    small, least = (transfer([without], one, (0.5, 0.5)).deviation for one in (coarse.min() / 2, coarse.min()))
    assert small == pytest.approx(least, rel=0.01)


@pytest.mark.parametrize("pairs, few, scatter, finer, slope", [
    (12, 4, 0.05, 0.03, 0.0), (12, 4, 0.05, 0.03, 0.2), (20, 6, 0.10, 0.08, 0.1), (8, 3, 0.10, 0.05, 0.0)])
def test_bands_hold_what_was_not_run(pairs, few, scatter, finer, slope):
    """Of many made-up studies nine tenths of the values, and not nearly all: they are no wider than they need be."""
    rng, inside, others = np.random.default_rng(2), [], 10
    for _ in range(150):
        at = rng.random((pairs + others, 2))
        coarse, noise = 10000 * np.exp(0.5 * rng.standard_normal(len(at))), rng.standard_normal((2, len(at)))
        half = coarse * np.exp(-0.05 + slope * at[:, 0] + scatter * noise[0])
        quarter = half * np.exp(0.03 + slope / 2 * at[:, 0] + finer * noise[1])
        first = fit_step(coarse[:pairs], half[:pairs], at[:pairs], ball=80)
        last = fit_step(half[:few], quarter[:few], at[:few], ball=10, before=first)
        for k in range(pairs, len(at)):
            low, high = transfer([first, last], coarse[k], at[k]).band
            inside.append(low <= quarter[k] <= high)
    assert 0.85 < np.mean(inside) < 0.97


def test_an_error_in_m3_is_none_of_the_largest():
    """As small as it is of the largest values; a further step with few pairs goes on with it, and draws have it."""
    rng = np.random.default_rng(2)
    coarse = np.geomspace(1000.0, 16000.0, 12)
    step = fit_step(coarse, coarse + 400 * rng.standard_normal(12), none(12), ball=1)
    small, large = (transfer([step], value, ()) for value in (1500.0, 15000.0))
    assert step.ratio.power == 1 and small.deviation == pytest.approx(large.deviation, rel=0.2) and \
        200 < large.deviation < 700
    further = fit_step(coarse[-2:], coarse[-2:] * 1.01, none(2), ball=1, before=step)
    assert further.ratio.power == 1 and 0.7 < transfer([further], 1500.0, ()).deviation / small.deviation < 1.3
    drawn = ball_sizes.draws([[step]] * 2, [1500.0, 15000.0], none(2), 4000)
    assert np.quantile(drawn[:, 1], (0.05, 0.95)) == pytest.approx(large.band, rel=0.04)
    shares = fit_step(coarse, coarse * np.exp(0.1 * rng.standard_normal(12)), none(12), ball=1)
    assert shares.ratio.power == 0


def test_draws_are_as_the_bands():
    rng = np.random.default_rng(3)
    coarse = np.array([1000.0, 2000, 3000, 4000, 5000, 6000, 7000, 8000])
    step = fit_step(coarse, coarse * np.exp(0.1 * rng.standard_normal(8)), none(8), ball=10)
    found = ball_sizes.draws([[step, step], [step], [], [step]], [900.0, 900.0, 900.0, 0.0], none(4), 2000)
    for column, steps in zip(found.T[:2], ([step, step], [step])):
        one = transfer(steps, 900.0, ())
        assert np.quantile(column, (0.05, 0.95)) == pytest.approx(one.band, rel=0.06)
    assert (found[:, 2] == 900).all() and (found[:, 3] >= 0).all()
    again = ball_sizes.draws([[step, step], [step], [], [step]], [900.0, 900.0, 900.0, 0.0], none(4), 2000)
    assert (again == found).all()


def test_what_finer_balls_would_change():
    """Order 1 leaves as much again as the last halving changed; the observed order where both changes are clear."""
    coarse = np.array([1000.0, 1100, 1200, 1300])
    noise = np.array([1, -1, 1, -1])

    def steps(first, last, scatter):
        half = coarse * np.exp(first + scatter * noise)
        one = fit_step(coarse, half, none(4))
        return [one, fit_step(half, half * np.exp(last + scatter * noise), none(4), before=one)]

    clear = ball_sizes.estimate_remaining_step(steps(0.2, 0.1, 1e-4))
    assert clear.observed and clear.order == pytest.approx(1.0, abs=0.01) and clear.low == 0
    assert clear.best == pytest.approx(math.expm1(1.25 * 0.1), rel=0.01)
    assert clear.grown == pytest.approx(math.expm1(0.1))
    assert ball_sizes.estimate_remaining_step(steps(0.24, 0.08, 1e-4)).best == pytest.approx(math.expm1(1.25 * 0.08 /
                                                                                                        2), rel=0.02)
    unclear = ball_sizes.estimate_remaining_step(steps(-0.02, 0.01, 0.02))
    assert not unclear.observed and unclear.order == 1 and unclear.low < 0 < unclear.best < unclear.high
    assert ball_sizes.estimate_remaining_step(steps(-0.2, 0.1, 1e-4)).observed is False        # not of one sign
    # changes that do not shrink leave no less than those that shrink slowly
    slow = ball_sizes.estimate_remaining_step(steps(0.1, 0.07, 1e-4))
    for first in (0.1, 0.07, 0.02):
        assert ball_sizes.estimate_remaining_step(steps(first, 0.0708, 1e-4)).high > slow.high
    assert ball_sizes.estimate_remaining_step(steps(0.1, 0.1, 1e-4)[:1]) is None
    assert ball_sizes.estimate_remaining_step([fit_step([0, 0], [0, 0], none(2), ball=1)] * 2) is None
    # finer runs brought more beyond the road than their steps tell
    assert [bool(sizes.effect(key, steps(0.2, 0.1, 1e-4)).left) for key in (
        "remove_m3", "length_m", "beyond_road_m3", "centroid_m")] == [True, True, False, False]


def test_the_largest_values_decide_what_finer_balls_leave():
    """A last halving that raises the largest by 40 % and the others by less is none that raises all by 20 %."""
    coarse = np.geomspace(1000.0, 8000.0, 8)
    half = coarse * 1.4
    grows = np.linspace(0.0, math.log(1.4), 8)
    before = fit_step(coarse, half, none(8))
    found = ball_sizes.estimate_remaining_step([before, fit_step(half, half * np.exp(grows), none(8), before=before)])
    assert found.grown == pytest.approx(0.4, abs=0.05) and found.high > found.best == pytest.approx(
        math.expm1(1.25 * grows.mean()), rel=0.02)
    steady = ball_sizes.estimate_remaining_step([before, fit_step(half, half * 1.2, none(8), before=before)])
    assert steady.grown == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize("error", ["share", "m3"])
def test_a_site_of_another_scale_has_the_same_bands(error):
    """Volumes and balls 1,000 times as large, and pairs in another order: the same, 1,000 times as large."""
    rng = np.random.default_rng(6)
    coarse, at = np.geomspace(300.0, 9000.0, 12), rng.random((12, 2))
    noise = rng.standard_normal(12)
    fine = coarse * np.exp(0.05 * noise) if error == "share" else np.maximum(0, coarse + 150 * noise)
    for other in (np.arange(12), rng.permutation(12)):
        one = fit_step(coarse, fine, at, ball=10.0)
        large = fit_step(1e3 * coarse[other], 1e3 * fine[other], at[other], ball=1e4)
        for value in (20.0, 250.0, 900.0, 12000.0):
            assert transfer([large], 1e3 * value, (0.2, 1.4)).band == pytest.approx(
                [1e3 * end for end in transfer([one], value, (0.2, 1.4)).band])


def test_a_pair_that_becomes_nothing_drags_no_other():
    coarse = np.array([100.0, 400, 1000, 2000, 4000])
    step = fit_step(coarse, [0.0, 404, 1010, 2020, 4040], none(5), ball=1)
    assert transfer([step], 1500.0, ()).value == pytest.approx(1515)
    assert transfer([step], 90.0, ()).band[0] == 0
    mixed = fit_step([*coarse, 5, 8], [0.0, 404, 1010, 2020, 4040, 5, 8], none(7), ball=1)
    assert transfer([mixed], 7.0, ()).value == pytest.approx(7) and transfer([mixed], 7.0, ()).band[1] > 50
    assert fit_step([1.0, 5, 6], [0.0, 5, 6], none(3)).least > 1         # a length has none either


def test_long_runs_have_finer_balls_but_not_the_finest():
    """Of two finer sizes: the finest are quick, and have the size before, which slow ones have, too; what takes ages
    has none."""
    times = np.array([1.0, 1.2, 0.9, 1.1, 1.4, 3.0, 3.5, 9.0])
    where = np.column_stack([np.arange(8.0), times])
    first = np.arange(8) == 5           # a number rests on it
    half, quarter = size_runs.orders_of(times, first, where, [6, 3])
    assert quarter[0] == 5 and set(quarter) == {0, 1, 2, 3, 4, 5} and half[:3] == quarter[:3]
    assert 6 in half[:6] and 7 not in half
    assert size_runs.orders_of(times, first, where, [4])[0][0] == 5          # of one finer size
    assert size_runs.orders_of(np.ones(1), np.ones(1, bool), np.zeros((1, 1)), [1, 1]) == [[0], [0]]


@pytest.mark.parametrize("finest, left", [(5, 3), (4, 2), (3, 2), (2, 2), (1, 1), (0, 0)])
def test_points_that_rest_too_late_leave_no_size_untold(finest, left):
    """Where fewer may have the finest balls than were wanted, two are made at first, and all of the size before."""
    planned = [(0, each) for each in range(5)] + [(1, each) for each in range(finest)]
    assert size_runs.without_late(planned, 1) == planned[:5 + left]


@pytest.mark.parametrize("chased", [True, False])
def test_a_study_that_is_made_again_makes_no_finer_runs(monkeypatch, chased):
    """Numbers that rest on another run each time ask for four more than were wanted; others for as many as wanted."""
    points = [SimpleNamespace(name=f"p{k}", folder=Path(f"p{k}")) for k in range(12)]
    wanted, there, made_now = size_runs.Wanted(["4", "2", "1"], [5, 4]), {}, []

    def first_runs(*_):
        for point, asked in zip(points, ([1, 1], [1, 1], [1, 0], [1, 0], [1, 0])):
            known = there.get(point.folder, [None, None])
            there[point.folder] = [run or (point if want else None) for run, want in zip(known, asked)]
        return size_runs.Made(points, there, points)

    def add(_, made, __, point, k):
        made_now.append((point.name, k))
        made.finer.setdefault(point.folder, [None, None])[k] = point
        return point

    for name, fake in (("make_finer_runs", first_runs), ("add", add), ("read_run_rows", lambda _, runs: [
            made_rows.row(run=one.name) for one in runs]), ("at_finest", lambda *_: SimpleNamespace(
                sizes=SimpleNamespace(row=lambda row: row), runs=lambda several: several))):
        monkeypatch.setattr(size_runs, name, fake)
    work = SimpleNamespace(store=SimpleNamespace(admit=lambda _: None), do=lambda *_, **__: None)
    setup = SimpleNamespace(tell=lambda _: None)

    def pick(_):
        finest = [one.name for one in points if there.get(one.folder, [0, None])[1]]
        return SimpleNamespace(first=[f"p{len(finest)}"] if chased else ["p0"])

    size_runs.settle(setup, work, points, wanted, pick)
    assert sum(run[1] is not None for run in there.values()) == (4 + size_runs.MORE if chased else 4)
    assert made_now and all(both[0] for both in there.values())
    made_now.clear()
    size_runs.settle(setup, work, points, wanted, pick)
    assert not made_now


def test_points_of_finer_balls_are_spread_and_nested():
    places = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1], [0.5, 0.5], [0.1, 0]])
    assert ball_sizes.order_spread_points(places, [0], 3) == ball_sizes.order_spread_points(places, [0], 5)[:3]
    assert ball_sizes.order_spread_points(places, [0], 2) == [0, 3] and 5 not in ball_sizes.order_spread_points(places,
                                                                                                                [0], 5)
    assert ball_sizes.order_spread_points(places, [], 1) == [4] and len(ball_sizes.order_spread_points(places, [],
                                                                                                       9)) == 6


def test_measured_pairs():
    """Of the points of two sites with 25,600 balls each from the others and its own run with 400."""
    inside, off, half = [], defaultdict(list), defaultdict(list)
    for table, released in ((MEASURED, 33885), (MEASURED_TOO, 1224)):
        rows = np.genfromtxt(table, delimiter=",", names=True, dtype=None, encoding="ascii", skip_header=1)
        at = {row["point"]: ((row["friction"] - 5) / 25, row["rolling"] / 0.15, (row["spacing"] - 0.3) / 0.65)
              for row in rows}
        for quantity in ("remove", "on_road", "beyond", "length"):
            values = {(row["point"], int(row["balls"])): float(row[quantity]) for row in rows}
            ball = 0.0 if quantity == "length" else released / 400
            for point in at:
                others, steps = [one for one in at if one != point], []
                for coarse, fine in ((400, 3200), (3200, 25600)):
                    both = [[values[other, size] for other in others] for size in (coarse, fine)]
                    steps.append(fit_step(*both, [at[other] for other in others], ball=ball * 400 / coarse,
                                          before=steps[-1] if steps else None))
                one, truth = transfer(steps, values[point, 400], at[point]), values[point, 25600]
                low, high = one.band
                inside.append(low <= truth <= high)
                off[quantity].append(abs(one.value / truth - 1))
                half[quantity].append(math.log(high / low) / 2)
    median, half = ({name: np.median(values) for name, values in of.items()} for of in (off, half))
    assert np.mean(inside) >= 0.85
    assert max(median["remove"], median["length"]) < 0.05 and median["beyond"] < 0.12
    assert half["remove"] < 0.1 and half["length"] < 0.1 and half["beyond"] < 0.3


@pytest.mark.long
def test_coarse_balls_say_what_fine_ones_do(tmp_path):
    """The ten points anew with 3,200 balls, means of three packings, against 25,600: medians of the differences."""
    case, site = TOP / "inputs" / "20_embankment", tmp_path / "mine"
    words = ["site", "--terrain", case / "terrain_long.asc", "--release", case / "release.csv", "--shape", "slbl",
             "--depth", 12, "--road", case / "road.csv", "--balls", 400, "-o", site]
    assert cli.main([str(word) for word in words]) == 0
    d = yaml.safe_load((site / "site.yaml").read_text())["balls"]["diameter"] / 2
    off = {"remove": [], "beyond": [], "length": []}
    for row in np.genfromtxt(MEASURED, delimiter=",", names=True, dtype=None, encoding="ascii", skip_header=1):
        if row["balls"] == 25600:
            values = [of_run(site, row, d, packing) for packing in (1, 2, 3)]
            for name, of_name in off.items():
                of_name.append(abs(np.mean([value[name] for value in values]) / row[name] - 1))
    median = {name: np.median(of_name) for name, of_name in off.items()}
    assert median["remove"] < 0.03 and median["beyond"] < 0.10 and median["length"] < 0.03, median


def of_run(site, row, d, packing):
    """Volumes (m3) and length (m) of a run of the site's deck."""
    sets = {name: row[name] for name in ("friction", "rolling", "spacing", "field_e")}
    words = [str(word) for name, value in {**sets, "d": d, "packing": packing, "out": "run"}.items()
             for word in ("-var", name, value)]
    subprocess.run([os.environ["LMP"], "-in", "in.site", "-screen", "none", *words], cwd=site, check=True)
    about = volume.compute_removal(str(site / "run"), volume.Wanted(site / "road.csv", 10.0, local=True),
                                   site / "terrain.asc").about
    left = deposit.read_deposit(str(site / "run"), site / "terrain.asc", lambda _: None)
    for path in site.glob("run.*"):
        path.unlink()
    return {"remove": about["volume"]["remove"], "beyond": about["divided"]["past"],
            "length": run_length.measure_run_length(left, site / "terrain.asc").distance}
