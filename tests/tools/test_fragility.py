"""Fragility of bodies: closed forms of an infinite slope, displacements, hazard, the command."""
import csv
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy import stats
from scipy.integrate import trapezoid

import test_depends_on
from run_helpers import anew, called, write_asc
from test_newmark import noise
from test_slips import CASES, write_columns

from slope_tools.errors import SlopeError
from slope_tools.seismic import fragility, hazard_file
from slope_tools.slips import bishop, columns, newmark
from slope_tools.slips.bodies import Body
from slope_tools.slips.columns import Columns, GRAVITY
from slope_tools.statistics import distributions

BETA = np.radians(30.0)
PRESSURE = 40e3     # weight per area in plan, Pa


def infinite_slope():
    """One column, as large as the slope; its radius is 1e6 m."""
    one, radius = np.ones(1), 1e6
    slab = Columns(one, one / np.cos(BETA), PRESSURE * one, radius * np.sin(BETA) * one,
                   radius * np.cos(BETA) * one, radius * one, np.sin(BETA) * one, np.cos(BETA) * one)
    return Body("1", 180.0, slab, Path(), 100)


def drawn(text):
    return distributions.distribution("x", text, "--cohesion", text)


def normal_soil(correlation=0.0):
    return fragility.Soil(drawn("normal:9e3:1.5e3:1e3:17e3"), drawn("normal:0.6:0.06:0.2:1.0"), 0.0, True, correlation)


def chance(gal, correlation):
    """P(k_y < k) for normal c and tan phi: k_y < k is c a cos + tan W (1 - K sin) < W K cos, K = (k + tan) cos."""
    k = gal * 0.01 / GRAVITY
    pull = (k + np.tan(BETA)) * np.cos(BETA)
    of_c, of_t = 1.0, PRESSURE * (1 - pull * np.sin(BETA))
    mean = 9e3 * of_c + 0.6 * of_t - PRESSURE * pull * np.cos(BETA)
    variance = (1.5e3 * of_c) ** 2 + (0.06 * of_t) ** 2 + 2 * correlation * 1.5e3 * of_c * 0.06 * of_t
    return stats.norm.cdf(-mean / np.sqrt(variance))


@pytest.mark.parametrize("correlation", [0.0, -0.5, 0.7])
def test_normal_strengths_on_an_infinite_slope(correlation):
    peaks = np.arange(20.0, 600.0, 20.0)
    soil = fragility.strengths_of(normal_soil(correlation), 1024, 1)
    capacity = fragility.capacities([infinite_slope()], soil, fragility.PseudoStatic(1.0))[:, :, 0]
    found = fragility.compute_fragility_curve(capacity, peaks)
    expected = chance(peaks, correlation)
    assert expected.min() < 0.02 and expected.max() > 0.98
    assert found.value == pytest.approx(expected, abs=2e-3)
    assert ((found.low <= found.value) & (found.value <= found.high)).all()


def test_bands_hold_what_they_promise():
    """Of 200 bands of 90 %, 165 to 195 have the closed form in them (33 to 39 of 40)."""
    peaks = np.array([230.0])
    expected = chance(peaks, 0.0)[0]
    assert 0.2 < expected < 0.8
    inside = 0
    for seed in range(200):
        soil = fragility.strengths_of(normal_soil(), 64, 1000 * seed + 1)
        band = fragility.compute_fragility_curve(fragility.capacities([infinite_slope()], soil,
                                                                      fragility.PseudoStatic(1.0))[:, :, 0],
                                                 peaks)
        inside += band.low[0] <= expected <= band.high[0]
    assert 165 <= inside <= 195


def test_pseudo_static_factor_scales_the_peak_and_agrees_with_the_factor_of_safety():
    soil = fragility.strengths_of(normal_soil(), 8, 3)
    body = infinite_slope()
    half = fragility.capacities([body], soil, fragility.PseudoStatic(0.5))[:, 0, 0]
    assert half == pytest.approx(2 * fragility.capacities([body], soil, fragility.PseudoStatic(1.0))[:, 0, 0])
    k = 0.5 * 460 * 0.01 / GRAVITY
    fails = bishop.factor_of_safety(body.columns, soil, k) < 1
    assert 10 < fails.sum() < len(fails) - 10 and ((half < 460) == fails).all()


@pytest.mark.parametrize("limit, lift", [(0.02, 0.0), (0.3, 0.0), (0.05, 0.4)])
def test_a_record_scaled_to_the_capacity_gives_the_displacement(limit, lift):
    t, x = noise()
    record = np.column_stack([t, x, 0.5 * np.roll(x, 40), 0.6 * np.roll(x, 7)])
    k = np.array([-0.1, 1e-6, 0.02, 0.1, 0.4])
    capacity = fragility.slide_capacity(k, record, 30.0, limit, lift)
    assert capacity[0] == 0 and (np.diff(capacity) > 0).all()
    for one, gal in list(zip(k, capacity))[1:]:
        scale = gal * 0.01 / np.hypot(record[:, 1], record[:, 2]).max()
        way = newmark.both_ways(t, scale * record[:, 1:], 30.0, [one * GRAVITY], lift)[0]
        assert way == pytest.approx(limit, rel=5e-3)


def test_lognormal_capacities_come_back():
    """Median 400 gal, beta_u 0.3 between strengths and beta_r 0.2 between records."""
    rng = np.random.default_rng(5)
    strength = np.exp(0.3 * rng.normal(size=(fragility.REPLICATES * 512, 1)))
    record = np.exp(0.2 * stats.norm.ppf((np.arange(21) + 0.5) / 21))
    found = fragility.fit_lognormal(400 * strength * record, np.arange(50.0, 1500.0, 25.0))
    assert (found.median, found.beta_u) == pytest.approx((400, 0.3), rel=0.02)
    assert found.beta_r == pytest.approx(0.2, rel=0.05)
    assert found.hclpf == pytest.approx(400 * np.exp(-1.645 * 0.5), rel=0.03)
    assert found.off < 0.01 and found.median_error < 5
    assert found.at_hclpf == pytest.approx(found.at_hclpf_fitted, rel=0.2)
    weak = fragility.fit_lognormal(np.where(strength < 0.75, 100.0, 400 * strength * record),
                                   np.arange(50.0, 1500.0, 25.0))
    assert weak.at_hclpf > 1.5 * weak.at_hclpf_fitted
    assert fragility.fit_lognormal(400 * strength * record, np.array([5.0, 10.0, 15.0])) is None


def test_annual_frequency_is_the_integral():
    """Rate (a / 100)^-2 / 100, capacity lognormal: closed form exp(beta^2 2) times the rate of the median."""
    hazard = fragility.Hazard(np.array([1.0, 1e6]), np.array([100.0, 1e-10]))
    u = (np.arange(fragility.REPLICATES * 4096) + 0.5) / (fragility.REPLICATES * 4096)
    capacity = np.random.default_rng(1).permutation(np.exp(np.log(400) + 0.4 * stats.norm.ppf(u)))[:, None]
    found = fragility.frequency(capacity, hazard, np.array([200.0, 400.0, 800.0]))
    assert found.total.value == pytest.approx(0.01 / 16 * np.exp(2 * 0.4 ** 2), rel=1e-3)
    assert sum(part for *_, part in found.parts) == pytest.approx(found.total.value, rel=1e-9)
    inner = next(part for a, b, part in found.parts if (a, b) == (200.0, 400.0))
    grid = np.linspace(200, 400, 20001)
    p = stats.norm.cdf(np.log(grid / 400) / 0.4)
    assert inner == pytest.approx(trapezoid(p * 2 * 100 / grid ** 3, grid), rel=2e-3)


# --- the command ---

SOIL = "--density 2039 --cohesion 3e3:9e3 --friction 22:32"


@pytest.mark.parametrize("text", [
    "50,1e-2\n200,1e-3\n", "peak,exceedance\n50,1e-2\n200,1e-3\n", "rate,peak\n1e-2,50\n1e-3,200\n",
    "pga (g),annual rate\n0.05098581,1e-2\n0.2039432,1e-3\n", "PGA [m/s2];frequency (1/yr)\n0.5;1e-2\n2;1e-3\n",
    "# rate, pga_g\n1e-2,0.05098581\n1e-3,0.2039432\n", "pga (cm/s2),return period (years)\n50,100\n200,1000\n",
    "peak_gal,annual probability of exceedance\n50,0.00995016625\n200,0.000999500167\n"])
def test_the_head_of_a_hazard_counts(tmp_path, text):
    (tmp_path / "h.csv").write_text(text)
    found = hazard_file.read_seismic_hazard(tmp_path / "h.csv")
    assert np.array(found) == pytest.approx(np.array([[50, 200], [1e-2, 1e-3]]), rel=1e-6)


@pytest.mark.parametrize("text, rule", [
    ("exceedance,peak\n1e-4,800\n1e-3,400\n1e-2,100\n", "row 3: must have a larger peak than the row before"),
    ("1e-4,800\n1e-3,400\n1e-2,100\n", "must have peaks in gal, the largest of at least 30, or a head with their unit"),
    ("0.05,1e-2\n0.8,1e-3\n", "must have peaks in gal, the largest of at least 30"),
    ("pgv (cm/s),rate\n50,1e-2\n200,1e-3\n", "row 1: columns must be a peak, in gal, g or m/s2"),
    ("pga (%g),rate\n50,1e-2\n200,1e-3\n", "head: columns must be a peak, in gal, g or m/s2"),
    ("pga,probability in 50 years\n50,1e-2\n200,1e-3\n", "row 1: columns must be a peak"),
    ("id,pga,rate\n1,50,1e-2\n2,200,1e-3\n", "row 1: columns must be a peak"),
    ("50,1e-2x\n200,1e-3\n400,1e-4\n", "row 1: must be a peak (gal) and how often it is exceeded per year"),
    ("peak;exceedance\n50;0,01\n200;0,001\n", "row 2: must be a peak (gal) and how often")])
def test_a_hazard_in_another_order_or_unit(tmp_path, text, rule):
    (tmp_path / "h.csv").write_text(text)
    with pytest.raises(SlopeError, match=re.escape(f"h.csv: {rule}")):
        hazard_file.read_seismic_hazard(tmp_path / "h.csv")


def write_slips():
    """What find_slip leaves on the embankment of 10 m: two spheres, of which the second lies deeper."""
    ground, centre, radius = CASES[0][:3]
    write_asc("terrain.asc", ground.z, 0.5)
    Path("slips").mkdir()
    rows = []
    for rank, r in ((1, radius), (2, radius + 1.0)):
        base = columns.base_of(ground, centre, r)
        inside = columns.find_largest_part(ground, base)
        volume = columns.of_sphere(ground, centre, r, 180.0, 2000.0).volume
        write_asc(f"slips/out.{rank}.base.asc", np.where(inside, base, np.nan), 0.5)
        area = write_columns(f"slips/out.{rank}.columns.csv", ground, centre, r, 2000.0)
        rows.append(f"{rank},{centre[0]},{centre[1]},{centre[2]},{r},180,1.1,0.1,{volume},{area},3\n")
    head = "rank,x,y,z,radius,direction,factor,yield,volume,area,depth\n"
    Path("slips/out.slips.csv").write_text(head + "".join(rows))
    t, x = noise()
    Path("motion.txt").write_text("".join(f"{a} {b} 0 {0.3 * b}\n" for a, b in zip(t, x)))
    Path("other.txt").write_text("".join(f"{a} {b} 0 0\n" for a, b in zip(t, noise(seed=9)[1])))
    Path("hazard.csv").write_text("peak,exceedance\n50,1e-2\n200,1e-3\n800,3e-5\n2000,1e-6\n")


@pytest.fixture
def slips(here):
    write_slips()
    return here


def ran(capsys, words):
    return called(capsys, ["fragility", *words.split()])


def table(path="out/fragility.csv"):
    found = {}
    for row in csv.DictReader(open(path)):
        values = [float(row[name]) for name in ("peak_gal", "probability", "low", "high")]
        found.setdefault(row["body"], []).append(values)
    return {name: np.array(rows).T for name, rows in found.items()}


def test_a_motion_across_the_direction_of_sliding_is_named(slips, capsys):
    """Of one component, or of a record whose other one is missing: such a body is not shaken, and never fails."""
    rows = np.loadtxt("motion.txt")
    np.savetxt("across.txt", np.column_stack([rows[:, 0], 0 * rows[:, 1], rows[:, 1:3]])[:, [0, 1, 2, 3]])
    words = f"slips {SOIL} --peaks 50:1500:50 --sample 512 --record"
    assert "direction of sliding" not in ran(capsys, f"{words} motion.txt -o out")[2]
    status, _, err = ran(capsys, f"{words} motion.txt --record across.txt -o across")
    assert status == 0 and err.count("across.txt: along the direction of sliding of body") == 2, err
    assert "1, 270 degrees, its largest acceleration is 0 % of its peak: it hardly shakes the body" in err


@pytest.mark.drawn
def test_two_bodies_two_records_and_a_hazard(slips, capsys):
    status, out, err = ran(capsys, f"slips {SOIL} --peaks 50:1500:50 --record motion.txt "
                           "--record other.txt --displacement 0.05 --sample 512 --hazard hazard.csv -o out")
    assert status == 0, err
    curves = table()
    assert set(curves) == {"1", "2", "any"} and len(curves["any"][0]) == 30
    for peak, p, low, high in zip(*curves["1"]):
        assert low <= p <= high
    assert (np.diff(curves["any"][1]) >= 0).all() and curves["any"][1][-1] > 0.9
    assert (curves["any"][1] >= np.maximum(curves["1"][1], curves["2"][1]) - 1e-9).all()
    about = yaml.safe_load(Path("out/fragility.yaml").read_text())
    names = {"sample": "samples", "record": "records"}
    assert {names.get(one, one) for one in test_depends_on.SAID["fragility"]} <= about.keys()
    assert about["peaks"] == "50:1500:50"
    last = about["curves"][-1]
    assert last["lognormal"]["beta_r"] > 0.01 and last["lognormal"]["hclpf_gal"] < last["lognormal"]["median_gal"]
    frequency = last["annual_frequency"]
    assert sum(one["frequency"] for one in frequency["contributions"]) == pytest.approx(frequency["value"], rel=1e-6)
    assert 1e-6 < frequency["value"] < 1e-2 and "any body" in out and "per year" in out
    most = sum(one["annual_frequency"]["value"] for one in about["curves"][:2])
    assert f", {most:.3g} at most if each body" in out and most > 1.1 * frequency["value"]
    assert Path("out/fragility.png").stat().st_size > 10000


def test_pseudo_static_is_said_to_be_cautious_and_is(slips, capsys):
    status, _, err = ran(capsys, f"slips/out.slips.csv {SOIL} --peaks 50:1500:50 --pseudo-static 1 "
                         "--sample 512 -o out")
    assert status == 0 and "which is cautious\n" in err
    status, _, err = ran(capsys, f"slips {SOIL} --peaks 50:1500:50 --record motion.txt --sample 512 "
                         "-o slide")
    assert status == 0 and "one record" in err
    assert (table()["1"][1] >= table("slide/fragility.csv")["1"][1]).all()


def test_pseudo_static_with_less_than_the_peak_is_not_cautious(slips, capsys):
    """Of a motion that comes near its peak again and again more strengths fail than at 0.65 times the peak."""
    t = np.arange(0.0, 20.0, 0.005)
    x = 2.0 * np.sin(2 * np.pi * t) * np.minimum(1.0, t)
    np.savetxt("waves.txt", np.column_stack([t, x, 0 * x, 0 * x]))
    status, _, err = ran(capsys, f"slips {SOIL} --peaks 50:1500:50 --pseudo-static 0.65 --sample 512 -o out")
    assert status == 0 and "with 0.65 times the peak counts as failed, which is not cautious" in err
    assert ran(capsys, f"slips {SOIL} --peaks 50:1500:50 --record waves.txt --sample 512 -o slide")[0] == 0
    less, more = table()["1"][1], table("slide/fragility.csv")["1"][1]
    assert (less <= more).all() and (less < more - 0.1).any()


@pytest.mark.parametrize("first, told", [(50, False), (300, True)])
def test_a_hazard_curve_that_begins_late_gives_a_lower_bound(slips, capsys, first, told):
    """A rate of (peak / 100 gal)^-2 / 100; from 300 gal on most strengths fail below the curve."""
    Path("late.csv").write_text("peak,exceedance\n" + "".join(
        f"{peak},{0.01 * (peak / 100) ** -2}\n" for peak in (first, 3000)))
    status, out, err = ran(capsys, f"slips {SOIL} --peaks 50:1500:50 --pseudo-static 1 --sample 512 --hazard late.csv "
                           "-o out")
    rows = list(csv.reader(open("out/capacities.csv")))
    below = [float(value) for row in rows[1:] for value in row[-1:] if 0 < float(value) < first]
    assert status == 0 and ("fails at least" in out) == ("first peak" in err) == told == bool(len(below) > 30)
    assert not told or re.search(f"a curve from {min(below):.3g} gal on", err)


def test_a_hazard_curve_that_ends_early_gives_a_lower_bound(slips, capsys):
    """Rates of the same line: up to 250 gal hardly a strength fails, and the last peak is exceeded far more often."""
    for last, told in ((250, True), (3000, False)):
        Path("early.csv").write_text("peak,exceedance\n" + "".join(
            f"{peak},{0.01 * (peak / 100) ** -2}\n" for peak in (50, last)))
        status, out, err = ran(capsys, f"slips {SOIL} --peaks 50:1500:50 --pseudo-static 1 --sample 512 --hazard "
                               "early.csv -o out --overwrite")
        assert status == 0 and ("fails at least" in out) == ("above the hazard curve's last" in err) == told, out + err


def test_strengths_with_which_the_slope_would_not_stand_are_named(slips, capsys):
    """Few, but each earthquake of the curve finds them failed."""
    few = SOIL.replace("3e3:9e3", "list:0@0.02,9e3@0.98")
    status, _, err = ran(capsys, f"slips {few} --peaks 50:1500:50 --pseudo-static 1 --sample 512 --hazard hazard.csv "
                         "-o out")
    given = yaml.safe_load(Path("out/fragility.yaml").read_text())["curves"][-1]
    assert status == 0 and "any body: " in err and "% of the strengths fail without an earthquake, which makes" in err
    share = given["fails_without_earthquake"] * 0.01 / given["annual_frequency"]["value"]
    assert f"which makes {100 * share:.2g} % of the frequency" in err and share > 0.05


@pytest.mark.parametrize("peaks, said", [("50:1500:50", None), ("20:60:10", "at 60 gal, the largest of --peaks"),
                                         ("1200:1500:100", "at 1200 gal, the smallest of --peaks")])
def test_peaks_that_do_not_show_the_half_are_named_with_a_remedy(slips, capsys, peaks, said):
    status, _, err = ran(capsys, f"slips {SOIL} --peaks {peaks} --pseudo-static 1 --sample 512 -o out")
    assert status == 0 and (f"any body: {said}" in err if said else "of --peaks" not in err)
    if said:
        half = float(re.search(r"any body: at .* of the strengths at (\d+) gal: give (larger|smaller) peaks", err)[1])
        with open("out/capacities.csv", encoding="ascii") as source:
            capacity = np.loadtxt(source, delimiter=",", skiprows=1)[:, 2:].min(axis=1)
        assert half == pytest.approx(np.median(capacity), abs=0.51) and 60 < half < 1200


def test_the_share_below_a_peak_is_a_direct_simulation(slips, capsys):
    """Every sample's own displacement at one peak, instead of its capacity."""
    words = (f"slips {SOIL} --water 0:0.2 --peaks 200:400:200 --record motion.txt --sample 256 "
             "--displacement 0.02")
    assert ran(capsys, words + " -o out")[0] == 0
    soil = fragility.Soil(drawn("3e3:9e3"), drawn("22:32"), drawn("0:0.2"))
    ground, centre, radius = CASES[0][:3]
    body = columns.of_sphere(ground, centre, radius, 180.0, 2039.0)
    k = bishop.yield_coefficient(body, fragility.strengths_of(soil, 16, 1))
    t, x = noise()
    scaled = np.column_stack([x, 0 * x, 0 * x]) * 2.0 / np.abs(x).max()
    way = newmark.both_ways(t, scaled, 180.0, np.maximum(k, 0) * GRAVITY)
    assert table()["1"][1][0] == pytest.approx(np.mean((way > 0.02) | (k <= 0)), abs=1 / 256 + 1e-9)
    assert 0.1 < table()["1"][1][0] < 0.99


@pytest.mark.parametrize("words, rule", [
    ("--peaks 500:100 --pseudo-static 1", "--peaks: must be LO:HI or LO:HI:STEP"),
    ("--peaks 50:1500:7000 --pseudo-static 1", "--peaks: must be LO:HI or LO:HI:STEP"),
    ("--peaks 100:500", "--record: must give a motion"),
    ("--peaks 100:500 --record motion.txt --pseudo-static 1", "--pseudo-static: must be without --record"),
    ("--peaks 100:500 --pseudo-static 1 --friction 20:95", "--friction: must be from 0 to 89 degrees"),
    ("--peaks 100:500 --pseudo-static 1 --cohesion lognormal:0:1:1:2", "lognormal must have MEDIAN > 0"),
    ("--peaks 100:500 --pseudo-static 1 --correlation 2", "--correlation: must be from -1 to 1, got 2"),
    ("--peaks 100:500 --pseudo-static 1 --hazard rises.csv", "rises.csv: row 3: must be exceeded less often"),
    ("--peaks 100:500 --pseudo-static 1 --density 0", "--density: must be > 0 kg/m3, got 0"),
    ("--peaks 100:500 --pseudo-static 1 --sample 10", "--sample: must be from 256"),
])
def test_bad_input_is_one_line(slips, capsys, words, rule):
    Path("rises.csv").write_text("peak,exceedance\n100,1e-2\n200,2e-2\n")
    status, _, err = ran(capsys, f"slips {anew(SOIL, words)} -o out")
    assert status == 2 and err.count("\n") == 1 and rule in err
    assert not Path("out").exists()


def test_density_and_water_are_those_of_the_search_unless_they_are_given(slips, capsys):
    """With 2000 kg/m3, and below a water table."""
    words = "--cohesion 3e3:9e3 --friction 22:32 --peaks 100:500 --pseudo-static 1 --sample 256"
    runs = {"dry": "", "said": "--density 2000 --water 0", "heavy": "--density 2300", "wet": "", "drained": "--water 0"}
    found = {}
    for name, more in runs.items():
        if name == "wet":
            for rank, radius in ((1, CASES[0][2]), (2, CASES[0][2] + 1.0)):
                write_columns(f"slips/out.{rank}.columns.csv", *CASES[0][:2], radius, 2000.0, 29.0)
        assert ran(capsys, f"slips {words} {more} -o {name}")[0] == 0
        with open(f"{name}/capacities.csv", encoding="ascii") as source:
            found[name] = np.loadtxt(source, delimiter=",", skiprows=1)[:, 2]
    assert found["said"] == pytest.approx(found["dry"], rel=1e-6)
    assert found["drained"] == pytest.approx(found["dry"], rel=1e-6)
    assert (found["heavy"] < found["dry"]).all() and (found["wet"] < found["dry"]).all()
    ground, centre, radius = CASES[0][:3]
    body = columns.of_sphere(ground, centre, radius, 180.0, 2000.0, np.full(ground.z.shape, 29.0))
    soil = fragility.Soil(drawn("3e3:9e3"), drawn("22:32"))
    k = bishop.yield_coefficient(body, fragility.strengths_of(soil, 16, 1))
    assert found["wet"] == pytest.approx(np.maximum(k, 0) * GRAVITY * 100, rel=1e-5)


@pytest.mark.parametrize("change, rule", [
    (lambda path: path.unlink(), "must be an existing file, which find_slip writes since"),
    (lambda path: path.write_text("x,y\n1,2\n"), "must be what find_slip wrote"),
    (lambda path: path.write_text(path.read_text() + "1,2,nan,1,0,0,1,1,0\n"), "must be what find_slip wrote"),
    (lambda path: path.write_text(path.read_text().rsplit("\n", 3)[0] + "\n"), "must be of the body of out.slips.csv"),
    (lambda path: path.write_bytes(Path("slips/out.2.columns.csv").read_bytes()), "must be of the body of out.slips")])
def test_columns_of_an_earlier_version_or_of_another_body(slips, capsys, change, rule):
    change(Path("slips/out.1.columns.csv"))
    status, _, err = ran(capsys, f"slips {SOIL} --peaks 100:500 --pseudo-static 1 -o out")
    assert status == 2 and err.count("\n") == 1 and f"slips/out.1.columns.csv: {rule}" in err
    assert not Path("out").exists()
