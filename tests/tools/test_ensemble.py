"""tools/slope study --sample: distributions, designs, bounds, indices, and an ensemble of small collapses."""
import csv
import math
import re
from pathlib import Path

import numpy as np
import pytest
import rasterio
import yaml
from scipy import stats

import made_rows
import made_study
from messages import is_one
from tiny_collapse import loaded, read_asc, rows_of

from slope_tools import cli, digits
from slope_tools.case import deck_ranges
from slope_tools.ensembles import ensemble, known_events, sample
from slope_tools.report import ensemble_part
from slope_tools.statistics import designs, distributions, emulator, hazard
from slope_tools.statistics.entries import KnownQuantile
from slope_tools.studies import letter
from slope_tools.tables.study_file import load_study

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
COMMAND = "study case/in.tiny"
ROAD = "--road case/road.csv --local"


def variable(text):
    return distributions.distribution("x", text, "--vary", f"x={text}")


# --- distributions ---

@pytest.mark.parametrize("text, reference", [
    ("10:40", stats.uniform(10, 30)), ("uniform:-5:5", stats.uniform(-5, 10)),
    ("loguniform:1e-3:10", stats.loguniform(1e-3, 10)), ("triangular:0:1:4", stats.triang(0.25, 0, 4)),
    ("normal:30:4:25:40", stats.truncnorm(-1.25, 2.5, 30, 4)),
    ("lognormal:8:0.4:0.01:900", stats.lognorm(0.4, scale=8)),
    ("normal:30:0.02:0:90", stats.norm(30, 0.02)), ("1000:1000.01", stats.uniform(1000, 0.01)),
])
def test_values_follow_the_distribution_and_come_back(text, reference):
    one = variable(text)
    shares = np.linspace(0, 1, 101)
    values = [one.value(u) for u in shares]
    assert np.array(values, float)[1:-1] == pytest.approx(reference.ppf(shares)[1:-1], rel=1e-5,
                                                          abs=1e-6 * (one.high - one.low))
    assert (float(values[0]), float(values[-1])) == (one.low, one.high)
    assert len(set(values)) == 101 and all(one.low <= float(value) <= one.high for value in values)
    assert [one.unit(value) for value in values] == pytest.approx(shares, abs=1e-5)


def test_a_list_has_its_weights():
    one = variable("list:a.asc@1,b.asc@2,0.5@5")
    u = (np.arange(800) + 0.5) / 800
    values = [one.value(share) for share in u]
    assert [values.count(value) for value in one.values] == [100, 200, 500]
    assert [one.unit(value) for value in one.values] == [1 / 16, 2 / 8, 11 / 16]
    assert set(one.snap(u)) == {1 / 16, 2 / 8, 11 / 16}
    assert variable("list:1,2").edges == (0, 0.5, 1)


RANGED = """\
variable a index 0.5   # a share; 0 <= share < 1
variable b index 30    # degrees
variable c index 0.3   # where c is > 0, or 5
variable e index 0.5
variable f index 2
variable g index 2977
create_balls 1 ${f} ${g} fill body seed 1
pair_coeff 1 1 stiffness 1 1 restitution ${e} friction ${b}
fix deposit all deposit/grid 1 1 cell 1
"""


def test_a_deck_has_ranges(tmp_path):
    deck = tmp_path / "in.a"
    deck.write_text(RANGED)
    found = deck_ranges.ranges(deck)
    assert set(found) == {"a", "b", "e", "f", "g"}
    assert found["f"].text == found["g"].text == "> 0"
    assert [found["a"].holds(value) for value in (-0.1, 0, 0.5, 1)] == [False, True, True, False]
    assert [found["b"].holds(value) for value in (0, 89.9, 90)] == [True, True, False]
    assert found["e"].text == "> 0 and <= 1" and found["a"].text == ">= 0 and < 1"


# --- designs ---

@pytest.mark.parametrize("dimensions, number", [(1, 5), (3, 60), (6, 128)])
def test_a_longer_design_contains_the_shorter_one(dimensions, number):
    short, long = (designs.points(designs.SOBOL, dimensions, n, 7) for n in (number, 2 * number))
    assert (long[:number] == short).all() and len(np.unique(long, axis=0)) == 2 * number
    assert (designs.points(designs.SOBOL, dimensions, number, 8) != short).all()


def test_a_design_is_even():
    """Each coordinate, in 32 classes; a latin hypercube by definition."""
    for kind in designs.KINDS:
        points = designs.points(kind, 4, 32, 3)
        assert (np.sort(np.floor(32 * points), axis=0) == np.arange(32)[:, None]).all()


# --- bounds ---

def test_bounds_are_those_of_clopper_and_pearson():
    """1 of 10: 0.0051 to 0.3942 with 90 % (their table); the ends."""
    low, high = hazard.share_bounds([0, 1, 10], 10)
    assert low == pytest.approx([0, 0.005116, 0.741134], abs=1e-6)
    assert high == pytest.approx([0.258866, 0.394163, 1], abs=1e-6)


def test_failed_runs_widen_the_bounds_and_move_no_estimate():
    values, point = np.arange(1, 41.0), range(40)
    without, with_ = (hazard.compute_hazard_curve(values, point, failed).at(30) for failed in (0, 4))
    assert without.value == with_.value == 0.25
    assert with_.low < without.low and with_.high > without.high
    assert with_.low == pytest.approx(hazard.share_bounds(10, 44)[0])
    assert with_.high == pytest.approx(hazard.share_bounds(14, 44)[1])


def test_quantiles_and_their_bounds_are_order_statistics():
    values = np.random.default_rng(2).permutation(np.arange(1, 101.0))
    found = hazard.compute_quantiles(values, range(100))
    assert [one.value for one in found] == [50, 90, 95, 99]
    # X_(l) and X_(u) with P(B(100, 0.9) < l) <= 5 % and P(B(100, 0.9) < u) >= 95 %
    low = max(k for k in range(1, 101) if stats.binom.cdf(k - 1, 100, 0.9) <= 0.05)
    high = min(k for k in range(1, 101) if stats.binom.cdf(k - 1, 100, 0.9) >= 0.95)
    assert (found[1].low, found[1].high) == (low, high)
    # 100 runs do not bound the 99 % quantile, three not even the median
    assert found[3].high is None and stats.binom.cdf(99, 100, 0.99) < 0.95
    assert hazard.compute_quantiles([1, 2, 3], range(3))[0] == (0.5, 2, None, None)


def test_runs_of_the_same_point_are_worth_less():
    values = np.repeat(np.arange(1, 21.0), 3)
    point = np.repeat(np.arange(20), 3)
    alone, together = hazard.compute_hazard_curve(values, range(60)).at(10), hazard.compute_hazard_curve(values,
                                                                                                         point).at(10)
    assert alone.value == together.value == 0.5
    assert (together.low, together.high) == pytest.approx(hazard.compute_hazard_curve(np.arange(1, 21.0),
                                                                                      range(20)).at(10)[1:])
    assert together.high - together.low > 1.5 * (alone.high - alone.low)
    # three that have nothing in common count as three
    free = np.random.default_rng(1).permutation(values)
    assert hazard.effect_of(free > 10, point) < 1.5


def noisy(u, rng):
    """A volume with a threshold, as a road has one, and chance."""
    return np.maximum(0, 4000 * u[:, 0] ** 2 + 3000 * u[:, 1] - 1500 * u[:, 2] + rng.normal(0, 300, len(u)) - 500)


def test_bands_of_the_hazard_curve_cover_a_reference():
    """90 % bands at the 50, 75 and 90 % of 400 runs: 32 to 40 of 40 repetitions of an ensemble of 64 cover them."""
    rng = np.random.default_rng(11)
    reference = noisy(rng.random((400, 3)), rng)
    levels = np.quantile(reference, [0.5, 0.75, 0.9], method="inverted_cdf")
    shares = [(reference > level).mean() for level in levels]
    covered = np.zeros(3, int)
    for seed in range(40):
        curve = hazard.compute_hazard_curve(noisy(designs.points(designs.SOBOL, 3, 64, seed), rng), range(64))
        bands = [curve.at(level) for level in levels]
        covered += [band.low <= share <= band.high for band, share in zip(bands, shares)]
    assert (covered >= 32).all(), covered


# --- which variables matter ---

def sobol_g(u, a=(0, 1, 4.5, 9)):
    """Sobol's g function."""
    return np.prod((np.abs(4 * u - 2) + a) / (1 + np.array(a)), axis=1)


def sobol_g_indices(a=(0, 1, 4.5, 9)):
    alone = 1 / (3 * (1 + np.array(a)) ** 2)
    whole = np.prod(1 + alone) - 1
    return alone / whole, alone * np.prod(1 + alone) / (1 + alone) / whole


def ishigami(u, a=7.0, b=0.1):
    x = math.pi * (2 * u - 1)
    return np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0])


def ishigami_indices(a=7.0, b=0.1):
    one, two = (1 + b * math.pi ** 4 / 5) ** 2 / 2, a ** 2 / 8
    three = b ** 2 * math.pi ** 8 * (1 / 18 - 1 / 50)
    return np.array([one, two, 0]) / (one + two + three), np.array([one + three, two, three]) / (one + two + three)


@pytest.mark.long
def test_indices_of_a_known_function():
    points = designs.points(designs.SOBOL, 3, 256, 1)
    found = emulator.analyse("abc", points, ishigami(points), range(256))
    assert found.emulator.verdict == "good"
    first, total = ishigami_indices()
    assert [one.first for one in found.variables.values()] == pytest.approx(first, abs=0.03)
    assert [one.total for one in found.variables.values()] == pytest.approx(total, abs=0.03)
    for one, exact in zip(found.variables.values(), total):
        assert abs(one.total - exact) < 3 * one.total_error + 0.005 and one.total_error < 0.06


@pytest.mark.parametrize("number, seed, noise", [(64, 3, 0), (64, 11, 0), (64, 11, 0.2), (128, 11, 0.2)])
def test_indices_of_variables_that_the_emulator_drops_have_an_error(number, seed, noise):
    """Few runs of a function with kinks: all fits leave out the same weak variable, and so differ in nothing."""
    points = designs.points(designs.SOBOL, 4, number, seed)
    values = sobol_g(points)
    values = values + noise * values.std() * np.random.default_rng(seed).normal(size=number)
    found = emulator.analyse("abcd", points, values, range(number))
    assert found.emulator.verdict == "good"
    first, total = sobol_g_indices()
    for one, alone, whole in zip(found.variables.values(), first, total):
        assert abs(one.first - alone) < 2 * one.first_error and abs(one.total - whole) < 2 * one.total_error
        assert one.total_error < 0.2


def test_the_noise_of_chance_is_seen_and_idle_variables_too():
    rng = np.random.default_rng(5)
    points = designs.points(designs.SOBOL, 3, 64, 1)
    values = 100 * points[:, 0] + 30 * points[:, 1] + rng.normal(0, 5, 64)
    found = emulator.analyse("abc", points, values, range(64))
    assert found.emulator.verdict == "good" and found.emulator.noise == pytest.approx(5, rel=0.4)
    exact = 100 ** 2 / (100 ** 2 + 30 ** 2)
    assert [one.first for one in found.variables.values()] == pytest.approx([exact, 1 - exact, 0], abs=0.05)
    assert [one.rank_clear for one in found.variables.values()] == [True, True, False]


def test_an_emulator_that_explains_nothing_gives_no_indices():
    points = designs.points(designs.SOBOL, 2, 40, 1)
    found = emulator.analyse("ab", points, np.random.default_rng(3).normal(0, 1, 40), range(40))
    assert found.emulator.verdict == "bad" and "no indices" in found.text
    assert all(one.first is None and one.total is None for one in found.variables.values())
    few = emulator.analyse("ab", points[:5], points[:5, 0], range(5))
    assert few.emulator is None and "5 points are too few for an emulator of 2 variables" in few.text
    assert "same in all runs" in emulator.analyse("ab", points, np.ones(40), range(40)).text


def test_repeats_do_not_make_a_rank_clear():
    """An idle variable beside one that matters, three runs of each point: clear in about one of twenty."""
    rng = np.random.default_rng(8)
    point = np.repeat(np.arange(20), 3)
    clear = 0
    for _ in range(200):
        places = rng.random((20, 2))
        clear += emulator.rank(places[point, 0], places[point, 1] + 0.05 * rng.random(60), point)[1]
    assert clear <= 22
    assert emulator.rank(places[point, 0], places[point, 0] + 0.05 * rng.random(60), point)[1]
    assert emulator.rank(places[point, 0], np.tile([0.0, 1.0, 2.0], 20), point)[1] is False     # all means are equal


def test_runs_of_a_point_are_left_out_together():
    point = np.repeat(np.arange(11), 3)
    masks = emulator.folds(point)
    assert sum(mask.astype(int) for mask in masks).tolist() == [1] * 33
    assert all(len(set(mask[point == one])) == 1 for mask in masks for one in range(11))


# --- an ensemble of small collapses ---

@pytest.fixture
def here(tiny_case):
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    return tiny_case


def curves():
    with open("out/hazard.csv", encoding="ascii") as lines:
        found = {}
        for row in csv.DictReader(lines):
            found.setdefault(row["quantity"], []).append([float(row[key]) for key in ("value", "exceeded", "low",
                                                                                      "high")])
    return {name: np.array(several).T for name, several in found.items()}


WORDS = f"--vary friction=10:40 --vary rolling=triangular:0:0:0.4 --set steps=900 --exceed 0.1,0.5 {ROAD} -o out"


def test_an_ensemble_grows_and_its_tables_are_those_of_the_runs(slope, succeed, blank_pictures):
    succeed(f"--sample 6 {WORDS}")
    first = loaded()[1]
    status, out, err = slope(f"--sample 12 {WORDS} --exceed-speed 2")
    assert status == 0 and "6 of 12 runs are finished already" in out, err
    assert "; 5 to go, all by " in out and "ensemble: 12 runs of 12 points" in out
    about, table = loaded()
    assert [row["run"] for row in table[:6]] == [row["run"] for row in first]
    assert about["conservative"] is None
    found = about["ensemble"]
    assert found["design"] == {"kind": "sobol", "seed": 1, "points": 12,
                               "variables": {"friction": "uniform:10:40", "rolling": "triangular:0:0:0.4"}}
    assert yaml.safe_load(Path("out/design.yaml").read_text()) == found["design"]
    points = designs.points("sobol", 2, 12, 1)
    assert [float(row["friction"]) for row in table] == pytest.approx(10 + 30 * points[:, 0], abs=1e-4)
    triangle = stats.triang(0, 0, 0.4).ppf(points[:, 1])
    assert [float(row["rolling"]) for row in table] == pytest.approx(triangle, abs=1e-5)

    # quantiles and curve, by counting
    volumes = np.array([float(row["remove_on_road_m3"]) for row in table])
    entry = found["quantities"]["remove_on_road_m3"]
    assert entry["mean"] == pytest.approx(volumes.mean()) and np.ptp(volumes) > 1
    assert [one["value"] for one in entry["quantiles"]] == pytest.approx(np.sort(volumes)[[5, 10, 11, 11]])
    value, exceeded, low, high = curves()["remove_on_road_m3"]
    assert value[0] == 0 and exceeded == pytest.approx([(volumes > one + 1e-6).mean() for one in value])
    assert (low <= exceeded).all() and (exceeded <= high).all() and exceeded[-1] == 0 and high[-1] > 0.2

    # maps, by counting
    names = [row["run"] for row in table]
    for raster, levels in (("thickness", (0, 0.1, 0.5)), ("max_thickness", (0, 0.1, 0.5)), ("max_speed", (0, 2))):
        stack = np.array([read_asc(f"out/{name}/tiny.{raster}.asc") for name in names])
        for level in levels:
            there = read_asc(f"out/ensemble/{raster}_above_{level:g}.asc")
            assert there == pytest.approx((stack > level).mean(axis=0), abs=6e-4) and there.max() > 0
        ordered = np.sort(stack, axis=0)
        assert read_asc(f"out/ensemble/{raster}_q50.asc") == pytest.approx(ordered[5], abs=6e-4)
        assert read_asc(f"out/ensemble/{raster}_q90.asc") == pytest.approx(ordered[10], abs=6e-4)
        with rasterio.open(f"out/ensemble/{raster}.tif") as tif:
            assert tif.count == 3 * (4 + len(levels))
            bands = {name: tif.read(i + 1) for i, name in enumerate(tif.descriptions)}
        what = next(name for name in bands if "> 0.1 m" in name or "> 2 m/s" in name)
        plain = what.split(",")[0]
        assert (bands[f"{plain}, lower bound"] <= bands[plain]).all()
        assert (bands[f"{plain}, upper bound"] >= bands[plain]).all()
    arrival = np.array([read_asc(f"out/{name}/tiny.arrival.asc") for name in names])
    reached = read_asc("out/ensemble/arrival_reached.asc")
    assert reached == pytest.approx(np.isfinite(arrival).mean(axis=0), abs=6e-4)
    early = np.sort(np.where(np.isfinite(arrival), arrival, np.inf), axis=0)[::-1][10]
    assert np.nan_to_num(read_asc("out/ensemble/arrival_q90.asc"), nan=-1) == pytest.approx(
        np.where(np.isfinite(early), early, -1), abs=6e-4)
    assert {Path("out", entry["file"]) for entry in found["maps"]} == set(Path("out/ensemble").glob("*.asc"))

    # ranks and indices
    one = found["influence"]["remove_on_road_m3"]
    assert one["variables"]["rolling"]["rank"] == pytest.approx(stats.spearmanr(
        [float(row["rolling"]) for row in table], volumes)[0])
    cells = rows_of("out/influence.csv")
    assert {row["variable"] for row in cells} == {"friction", "rolling"}
    for row in cells:
        entry = found["influence"][row["quantity"]]["variables"][row["variable"]]
        assert [row[key] for key in ("first", "total")] == ["" if entry[key] is None else str(entry[key])
                                                            for key in ("first", "total")]

    assert cli.main(["report", "out"]) == 0
    page = Path("out/report.html").read_text()
    for text in ("How likely", "hazard curve", "90 % of the runs stay within", "friction", "ensemble of 12 points"):
        assert text in page, text
    # the runs are cut short: no quantile is in the answer
    name = found["quantities"][found["of"]]["name"]
    stays = f"<b>{name[0].upper()}{name[1:]}: 90 % of the runs stay within</b>"
    assert [one["kind"] for one in found["withheld"]] == ["runs not at rest or failed"]
    assert "<b>Not usable as a number to design with:</b>" in page and stays not in page
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    about["ensemble"]["withheld"], about["reach"]["cut"] = [], 0
    Path("out/study.yaml").write_text(yaml.safe_dump(about))
    blank_pictures()
    assert cli.main(["report", "out"]) == 0 and stays in (page := Path("out/report.html").read_text())
    assert ": 90 % of the 12 runs with drawn settings stay within " in page[:page.index('id="appendix"')]
    told = letter.write_letter(letter.make_letter(load_study(Path("out/study.yaml"))))
    # what lies on the road is less than what must be cleared
    within = [digits.three(found["quantities"][key]["quantiles"][1]["value"]) for key in (found["of"], "remove_m3")]
    assert within[0] != within[1] and [re.search(f"{what}: 90 % of the 12 runs with drawn settings stay within (.*?) "
                                                 "m3, with 90 % confidence at least [0-9.,]+ m3", told.clear)[1]
                                       for what in ("Volume on the road", "Volume to remove from the road")] == within
    assert told.basis.startswith("That is what lies on it") and found["of"] == "remove_on_road_m3"
    about["ensemble"]["design"]["kind"] = "calibrated"
    Path("out/study.yaml").write_text(yaml.safe_dump(about))
    told = letter.write_letter(letter.make_letter(load_study(Path("out/study.yaml"))))
    assert "12 runs with calibrated settings" in told.clear and "12 runs with calibrated settings" in told.far


def test_the_letter_of_an_angle_has_both_ends():
    """Runs with the least angle go farthest, which no share that most stay within says."""
    quantiles = [{"share": 0.9, "value": 30.0, "low": 29.0, "high": 31.0}]
    about = made_study.ensemble(finished=40, of="reach_angle_deg", quantities={"reach_angle_deg": {
        "name": "reach angle", "unit": "degrees", "smallest": 17.25, "largest": 31.0, "quantiles": quantiles}})
    assert letter.describe_drawn(about, letter.format_console_number) == (
        "Reach angle: 17.2 to 31.0 degrees in the 40 runs with drawn settings; the less, the farther the mass goes.")
    entry = about.quantities[about.of]
    assert known_events.quantile_text(KnownQuantile(*entry.quantiles[0]), entry.unit, "the runs") == (
        "90 % of the runs have at most 30 degrees (29 to 31)")
    shown = ensemble_part.card(entry, "the runs", 0.9, lambda _, __, value: f"{value:g}", "")
    assert shown.title == "Reach angle: 90 % of the runs have at most" and shown.parts[0].what == shown.title[13:]


def test_repeats_of_points_and_a_list(succeed):
    deck = Path("case/in.tiny")
    deck.write_text(deck.read_text().replace("index 150", "index 150\nvariable  seed index 0").replace(
        "overlap 0.0", 'overlap 0.0\nif "${seed} > 0" then "displace_atoms soil random 1e-6 1e-6 1e-6 ${seed} units '
        'box"'))
    succeed("--sample 4 --vary friction=20:40 --vary rolling=list:0,0.3@2 --repeat seed=1 "
            "--set steps=300 -o out")
    about, table = loaded()
    assert [row["seed"] for row in table] == ["0", "1"] * 4 and {row["rolling"] for row in table} == {"0", "0.3"}
    assert about["ensemble"]["points"] == 4 and about["ensemble"]["of"] == "distance_99_m"
    assert about["ensemble"]["finished"] == 8


def test_a_failed_run_is_kept_out_and_counted(slope):
    deck = Path("case/in.tiny")
    deck.write_text(deck.read_text().replace("group       soil", 'if "${friction} > 34" then "nonsense"\n'
                                             "group       soil"))
    status, out, err = slope(f"--sample 8 --vary friction=10:40 --set steps=300 {ROAD} -o out")
    about, table = loaded()
    failed = [row["status"] for row in table].count("failed")
    assert status == 2 and failed == sum(float(row["friction"]) > 34 for row in table) > 0
    assert f"slope study: out: {failed} of 8 runs failed: steps_300_friction_" in err.splitlines()[-1]
    found = about["ensemble"]
    assert (found["finished"], found["failed"]) == (8 - failed, failed)
    assert f"caveat: {failed} of 8 runs failed: the estimates exclude them" in out
    volumes = sorted(float(row["remove_on_road_m3"]) for row in table if row["status"] == "finished")
    _, exceeded, _, high = curves()["remove_on_road_m3"]
    assert exceeded[-1] == 0 and high[-1] == pytest.approx(hazard.share_bounds(failed, 8)[1])
    assert found["quantities"]["remove_on_road_m3"]["largest"] == pytest.approx(volumes[-1])


def test_all_runs_failed_is_one_line(slope):
    Path("case/in.tiny").write_text("nonsense\n" + Path("case/in.tiny").read_text())
    status, _, err = slope("--sample 3 --vary friction=10:40 -o out")
    assert status == 2 and err.count("\n") == 1
    assert err.startswith("slope study: out: 3 of 3 runs failed: friction_") and "Unknown command: nonsense" in err
    assert not Path("out/study.yaml").exists()


def test_a_latin_hypercube_does_not_grow(slope):
    words = "--vary friction=10:40 --design lhs --set steps=20 -o out"
    assert slope(f"--sample 4 {words}")[0] == 0
    assert slope(f"--sample 4 {words}")[0] == 0
    status, _, err = slope(f"--sample 8 {words}")
    assert status == 2 and err.startswith("slope study: --design: lhs cannot grow or change: out has 4 points of lhs "
                                          "with seed 1") and err.count("\n") == 1
    assert slope(f"--sample 4 {words} --seed 2")[0] == 2


@pytest.mark.parametrize("arguments, message", [
    ("--sample 4", "--vary: must give the variables of the ensemble that --sample asks for"),
    ("--vary friction=10:40", "--sample: must be given with --vary: how many runs"),
    ("--sample 8 --vary friction=40:10", "--vary: friction must have its lower bound first, LO < HI, got "
     "friction=40:10"),
    ("--sample 8 --vary friction=30:95", "--vary: friction must stay within the deck's range, >= 0 and < 90, got "
     "friction=30:95"),
    ("--sample 8 --vary friction=list:20,90", "--vary: friction must stay within the deck's range"),
    ("--sample 2 --vary friction=10:40 --vary rolling=0:0.1", "--sample: must be more runs than there are parameters, "
     "2, got 2"),
    ("--sample 0 --vary friction=10:40", "--sample: must be more runs than there are parameters"),
    ("--sample 8 --vary colour=1:2", "--vary: must name an index variable of case/in.tiny"),
    ("--sample 8 --vary friction", "--vary: must be NAME=LO:HI or NAME=KIND:..., of uniform:LO:HI"),
    ("--sample 8 --vary friction=-1e308:1e308", "--vary: friction must have bounds whose difference is a number, got "),
    ("--sample 10000 --vary rolling=triangular:0:0:0.2",
     "--sample: must make points that differ in the six digits of a value"),
    ("--sample 8 --vary friction=1:2:3", "--vary: must be NAME=LO:HI or NAME=KIND:..., of uniform:LO:HI"),
    ("--sample 8 --vary friction=loguniform:0:3", "--vary: loguniform must have LO > 0"),
    ("--sample 8 --vary friction=triangular:0:5:3", "--vary: triangular must have LO <= MODE <= HI"),
    ("--sample 8 --vary friction=normal:30:0:20:40", "--vary: normal must have DEVIATION > 0"),
    ("--sample 8 --vary friction=normal:0:1:20:40", "--vary: normal must have a part of it between LO and HI"),
    ("--sample 8 --vary friction=list:20@0,30", "--vary: must be NAME=list:V1@WEIGHT,V2@WEIGHT,... with weights > 0"),
    ("--sample 8 --vary friction=list:20", "--vary: friction must have several values"),
    ("--sample 8 --vary friction=list:20,a", "--vary: friction must be a number, >= 0 and < 90, got friction=list:"),
    ("--sample 8 --vary rolling=0:1 --vary out=list:a,b", "--vary: must not vary out, which only names the files"),
    ("--sample 8 --vary friction=list:20,30", "--vary: must have a range among its variables"),
    ("--sample 8 --vary friction=1:2 --vary friction=2:3", "--vary: must name a variable once, got friction twice"),
    ("--sample 8 --vary friction=1:2 --set friction=3", "--vary: must not name a variable of --set, got friction"),
    ("--sample 8 --vary friction=1:2 --set rolling=0,1", "--set: must give one value"),
    ("--sample 8 --vary friction=1:2 --of remove_m3", "--road: must be given for remove_m3"),
    ("--sample 8 --vary friction=1:2 --of colour", "--of: must be one of remove_m3"),
    ("--sample 8 --vary friction=1:2 --seed -1", "--seed: must be from 0"),
    ("--sample 20000 --vary friction=1:2", "--sample: must make at most 10000 runs, got 20000"),
    ("--sample 8 --vary friction=1:2 --exceed-speed x", "--exceed-speed: must be different speeds >= 0"),
    ("", "--set: must be given, or --sample with --vary"),
    ("--sample 8 --vary friction=1:2 --intensity friction", "--intensity: must not be given with --sample, got "
     "friction"),
    ("--sample 8 --vary friction=1:2 --more-than 5,10", "--more-than: must not be given with --sample, got 5,10"),
    ("--set friction=20 --of front_m", "--of: must be given with --sample only, got front_m"),
    ("--set friction=20 --seed 0", "--seed: must be given with --sample only, got 0"),
])
def test_wrong_ensembles_are_one_line(slope, arguments, message):
    status, out, err = slope(f"{arguments} -o out")
    assert (status, out) == (2, "") and is_one(err, f"slope study: {message}"), err
    assert not Path("out").exists()


def test_what_an_ensemble_says_in_words():
    quantiles = [{"share": 0.9, "value": 120.0, "low": 100.0, "high": None}]
    about = made_study.ensemble(
        finished=5, points=5, of="front_m", doubts=["why"],
        quantities={"front_m": {"name": "farthest ball", "unit": "m", "quantiles": quantiles}},
        influence={"front_m": {"text": "so", "variables": {
            "a": {"rank": 0.1, "first": 0.1, "first_error": 0.0, "total": 0.2, "total_error": 0.05},
            "b": {"rank": -0.7, "first": 0.7, "first_error": 0.0, "total": 0.9, "total_error": 0.01}}}})
    assert ensemble.describe_ensemble(about) == [
        "ensemble: 5 runs of 5 points; bounds hold with 90 %",
        "farthest ball: 90 % of the runs stay within 120 m (100 to ?)",
        "farthest ball depends on b (0.70 alone, 0.90 with others, +- 0.01), a (0.10 alone, 0.20 with others, +- "
        "0.05); so",
        "caveat: why"]


def test_a_report_says_what_the_emulator_is_worth():
    entry = {"text": "as it is", "variables": {"a": dict.fromkeys(ensemble.emulator.SIGN, 0.5)}}
    about = made_study.ensemble(quantities={"front_m": {"name": "farthest ball"}}, influence={"front_m": entry})
    part = ensemble_part.Ensemble(None, None, about)
    assert [one.caption for one in part.indices()] == [
        "Sobol indices for farthest ball, with the error of the total ones; as it is."]


def test_points_of_the_design_are_found_in_the_rows():
    plan = sample.Sample(3, "sobol", 1, (variable("0:10"),))
    rows = [made_rows.row(set={"steps": "9", "x": value}, front_m=front)
            for value, front in (("5", 1.0), ("5", 2.0), ("2.5", 3.0), ("5", 4.0))]
    assert ensemble.number_design_points(plan, rows) == [0, 0, 1, 0]
    assert plan.places(rows).tolist() == [[0.5], [0.5], [0.25], [0.5]]
