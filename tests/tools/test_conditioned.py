"""tools/slope study --sample --mobility: bounds of weighted curves, weighted maps, an ensemble of small collapses."""
import csv
from pathlib import Path

import numpy as np
import pytest
import rasterio
import yaml
from scipy import stats

import known_twins as twins
import made_rows
import made_study
from messages import is_one
from tiny_collapse import read_asc, rows_of

from slope_tools import cli
from slope_tools.deposits import travel_shares
from slope_tools.ensembles import conditioned, known_events
from slope_tools.quantiles import within
from slope_tools.report import ensemble_part
from slope_tools.report.numbers import Numbers
from slope_tools.sites import site_warnings
from slope_tools.statistics.entries import KnownQuantile
from slope_tools.tables import named_run

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
COMMAND = "study case/in.tiny"
LONGER = 1.9
LARGE = "are known to run farther than laboratory friction suggests"
LEVELS = np.array([5e3, 2e4, 4e4, 7e4])     # m3


def mass_of(lengths):
    return conditioned.masses(conditioned.compute_weights(lengths, twins.exceedance(lengths)))


def shares(lengths, volumes):
    mass = mass_of(lengths)
    return mass.share @ conditioned.are_above_levels(volumes, LEVELS) + mass.far


# --- bounds ---

@pytest.mark.parametrize("jump, least", [(False, 33), (True, 31)])
def test_bands_hold_a_reference(jump, least):
    """Of independent runs; tests/statistics/conditioned.py has designs as well."""
    reference = shares(*twins.runs("sobol", 4000, 10, jump)[1:])
    found, bands = [], []
    for seed in range(400):
        lengths, volumes = twins.response(np.random.default_rng(seed).random((100, 3)), jump)
        found.append(shares(lengths, volumes))
        if seed >= 40:
            continue
        curve = conditioned.compute_known_curve(volumes, mass_of(lengths))
        bands.append([(one.low, one.high) for one in map(curve.at, LEVELS)])
    low, high = np.moveaxis(bands, 2, 0)
    held = ((low <= reference) & (reference <= high)).sum(axis=0)
    assert least <= held.mean() <= 39
    width = np.diff(np.quantile(found, [0.05, 0.95], axis=0), axis=0).sum()
    assert 0.8 < (high - low).mean(axis=0).sum() / width < 1.3


def test_a_design_is_as_even_as_what_it_samples():
    """The variance is a quarter where the length decides, and hardly less where chance does."""
    u, lengths, volumes = twins.runs("sobol", 64, 3)
    design = conditioned.Design("sobol", u, lengths, twins.exceedance)
    assert np.interp(4e4, *design.effect(volumes)) < 0.4
    chance = np.random.default_rng(3).random(64)
    assert np.interp(0.5, *design.effect(chance)) > 0.5


def test_an_estimate_by_hand():
    """Four runs, in the order of their lengths; two neighbours differ, and half a pair more is added."""
    mass = conditioned.Masses(np.array([0.1, 0.2, 0.3, 0.2]), 0.2, np.array([0, 1, 2, 3]), 3.0, 1, np.zeros(4))
    part, low, high = conditioned.estimate(np.array([[False], [False], [True], [True]]), mass)
    assert part == pytest.approx([0.5])
    pair = np.array([0.05, 0.13, 0.13]) / 4
    number = max(3.0, 0.625 * 0.375 / ((pair[1] + pair.mean() / 2) / 0.64))
    z = stats.norm.ppf(0.95)
    middle = (0.625 + z ** 2 / (2 * number)) / (1 + z ** 2 / number)
    half = z / (1 + z ** 2 / number) * (0.625 * 0.375 / number + z ** 2 / (4 * number ** 2)) ** 0.5
    assert (low, high) == (pytest.approx([0.8 * (middle - half)]), pytest.approx([0.8 * (middle + half)]))
    wide = conditioned.estimate(np.array([[False], [False], [True], [True]]), mass, failed=0.1)
    assert wide[1] == pytest.approx(0.9 * low) and wide[2] == pytest.approx(high + 0.1 * (1 - high))


def test_what_lies_beyond_exceeds_every_value():
    lengths = np.linspace(1000, 1800, 40)
    mass = mass_of(lengths)
    curve = conditioned.compute_known_curve(lengths - 1000, mass)
    assert curve.share[-1] == pytest.approx(mass.far) and 0.3 < mass.far < 0.85
    assert curve.share[0] == pytest.approx(1)
    assert (np.diff(curve.share) <= 1e-12).all() and (curve.low <= curve.share).all() and curve.low[-1] == 0
    assert (curve.high >= curve.share - 1e-12).all()
    few, most = conditioned.compute_known_quantiles(curve, (0.1, 0.9))
    assert 0 <= few.low <= few.value <= 800
    assert (most.value, most.high) == (None, None)


@pytest.mark.parametrize("shortest", [450, 550, 600, 650])
def test_events_before_the_shortest_run_may_leave_more_on_a_road(shortest):
    """A road at 500 m that the runs pass and 2 to 22 % of events may not: the bounds hold what these leave there."""
    law = stats.lognorm(0.115 * np.log(10), scale=800)
    lengths, events = np.linspace(shortest, 1500, 64), law.ppf((np.arange(4000) + 0.5) / 4000)
    mass = conditioned.masses(conditioned.compute_weights(lengths, law.sf(lengths)))
    assert mass.early.sum() == pytest.approx(law.cdf(shortest))
    left, lost = (10000 * np.exp(-((length - 500) / 150) ** 2) for length in (lengths, events))
    curve = conditioned.compute_known_curve(left, mass)
    for volume in (2000, 5000, 7500):
        band, truth = curve.at(volume), (lost > volume).mean()
        assert band.low <= truth <= band.high and band.low <= band.value <= band.high, (volume, truth, band)
        assert band.high - band.low >= mass.early.sum() and band.high < 0.55


LAW = stats.lognorm(0.3, scale=1300)
GAPPED = np.concatenate([np.linspace(700, 1200, 40), np.linspace(1500, 2600, 24)])      # 39 to 68 % end in the gap


@pytest.mark.parametrize("share", [0.1, 0.3, 0.385, 0.4, 0.5, 0.65, 0.7, 0.9])
@pytest.mark.parametrize("values", [GAPPED, 5e3 + 2 * GAPPED, 2e4 - 3 * GAPPED, np.full(64, 7.0)])
def test_a_quantile_in_a_gap_is_no_number(share, values):
    """Of the length it holds the known one; others have it where they depend on what ends in the gap."""
    found = conditioned.compute_weights(GAPPED, LAW.sf(GAPPED))
    (low, high, _), = found.gaps
    assert (low, high) == (1200, 1500)
    mass = conditioned.masses(found)
    assert [one.sum() for one in mass.either] == pytest.approx([mass.share.sum()] * 2)
    one, = conditioned.compute_known_quantiles(conditioned.compute_known_curve(values, mass), [share], values, mass)
    falling = values[0] > values[-1]
    inside = LAW.cdf(1200) < (1 - share - mass.far if falling else share) < LAW.cdf(1500)
    assert (one.gap is not None) == (bool(inside) and np.ptp(values) > 0)
    if one.gap:
        ends = sorted(np.interp([1200, 1500], GAPPED, values))
        assert one.gap == pytest.approx(ends) and one.value == ends[1] and one.low <= ends[0]
        assert one.high is None or one.high >= ends[1]
        if values is GAPPED:
            assert one.gap[0] < LAW.ppf(share) < one.gap[1]


def test_without_a_gap_there_is_no_either():
    lengths = LAW.ppf(np.linspace(0.01, 0.99, 64))
    mass = conditioned.masses(conditioned.compute_weights(lengths, LAW.sf(lengths)))
    assert mass.either is None
    one, = conditioned.compute_known_quantiles(conditioned.compute_known_curve(lengths, mass), (0.5,), lengths, mass)
    assert one.gap is None


@pytest.mark.parametrize("gap", [(1888.0, 2950.0), None])
def test_words_of_a_quantile_in_a_gap(gap):
    """Console, card, table and numbers have both ends, and no single value."""
    one = KnownQuantile(0.5, 2950.0, 1500.0, 3100.0, gap)
    line = known_events.quantile_text(one, "m", "known events")
    assert ("between 1,890 and 2,950 m" in line) == bool(gap) and ("stay within" in line) != bool(gap)
    assert ensemble_part.cell_of(one) == ("1,890 to 2,950" if gap else "2,950")
    about = made_study.ensemble({"quantities": {"length_m": {"name": "length", "unit": "m", "quantiles": [one]}}},
                                of="length_m")
    numbers = Numbers()
    part = ensemble_part.KnownEvents(None, numbers, about)
    shown, = part.answer().parts
    assert shown.number == ("1,890 to 2,950" if gap else "2,950")
    assert ("no run ends" in shown.note) == bool(gap) and "Between 1,500 m" in shown.note
    assert sum("gap" in row[0] for row in numbers.rows) == (2 if gap else 0)
    assert part.tables()[0].rows[0][1] == ("1,890 to 2,950" if gap else "2,950")


def test_runs_that_reach_no_event_say_nothing():
    mass = conditioned.masses(conditioned.compute_weights([2000, 2000], [0.4, 0.4]))
    curve = conditioned.compute_known_curve([1.0, 2.0], mass)
    assert (curve.low[-1], curve.high[0]) == (0, 1)


def test_ranks_and_quantiles_are_weighted():
    rng = np.random.default_rng(5)
    x, y = rng.random(50), rng.integers(0, 9, 50)
    assert known_events.rank(x, y, np.ones(50)) == pytest.approx(stats.spearmanr(x, y)[0])
    twice = np.repeat(np.arange(50), rng.integers(1, 4, 50))
    share = np.bincount(twice)
    assert known_events.rank(x, y, share) == pytest.approx(stats.spearmanr(x[twice], y[twice])[0])
    assert known_events.rank(x, np.ones(50), share) is None
    assert within(x, share, (0.2, 0.5)) == pytest.approx(
        np.quantile(x[twice], (0.2, 0.5), method="inverted_cdf"))
    block = rng.random((50, 7))
    for one, wanted in zip(within(block, share, (0.1, 0.9)), (0.1, 0.9)):
        assert one == pytest.approx(np.quantile(block[twice], wanted, axis=0, method="inverted_cdf"))


# --- an ensemble ---

def write_set(path):
    """Known events as small as the test's collapse: so many times as long as they fell, with a scatter."""
    rng = np.random.default_rng(1)
    rows = [f"event {i},{fall:.4g},{LONGER * fall * 10 ** (0.08 * rng.standard_normal()):.4g},{volume:.4g},"
            f"{'lateral' if i % 3 == 0 else 'unconfined'}"
            for i, (fall, volume) in enumerate(zip(rng.uniform(3, 20, 24), 10 ** rng.uniform(-4.5, -3, 24)))]
    Path(path).write_text("name,fall_m,length_m,volume_Mm3,confinement\n" + "\n".join(rows) + "\n")


@pytest.fixture
def here(tiny_case):
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    write_set("small.csv")
    return tiny_case


def test_an_ensemble_is_weighted(slope, succeed, capsys, monkeypatch):
    words = ("--sample 8 --vary friction=2:40 --vary rolling=0:0.3 --set steps=900 --mobility small.csv --unconfined "
             "--except 'event 3' --road case/road.csv --local --exceed 0.1 -o out")
    out, _ = succeed(words)
    assert "known events: the runs reach from " in out and "23 events of small.csv" in out
    found = yaml.safe_load(Path("out/study.yaml").read_text())["ensemble"]["known_events"]
    assert found["left_out"] == ["event 3"] and found["path"] == "not laterally confined" and not found["outside"]
    assert found["reached"] + found["short"] + found["far"] == pytest.approx(1) and found["reached"] > 0.05
    rows = rows_of("out/weights.csv")
    weight, length, beyond, ratio = (np.array([float(row[key]) for row in rows])
                                     for key in ("weight", "length_m", "beyond", "ratio"))
    assert weight.sum() == pytest.approx(found["reached"], abs=1e-4)
    again = conditioned.compute_weights(length, beyond, ratio)
    assert again.weights == pytest.approx(weight, abs=1e-4)

    # the runs do not reach far enough: half as many are added, which count in nothing but what is weighted
    line = next(line for line in out.splitlines() if "more points towards" in line)
    assert line.startswith("no run goes beyond ") and "% of known events do; 4 more points towards " in line
    added = found["added"]["points"]
    assert added in (4, 8) and len(rows) == found["runs"] == 8 + added and (ratio[8:] < 1).all()
    whole = yaml.safe_load(Path("out/study.yaml").read_text())["ensemble"]
    assert (whole["runs"], whole["points"], whole["design"]["points"]) == (8, 8, 8)
    columns, last = travel_shares.read_share_columns, list(csv.DictReader(open("out/study.csv", encoding="ascii")))[-1]
    monkeypatch.setattr(travel_shares, "read_share_columns", lambda summary: {
        **columns(summary),     # the last per cent of an added run left
        **({"distance_99_m": None} if summary["travel"]["front"] == pytest.approx(float(last["front_m"])) else {})})
    for path in Path("out").glob("*/.row.json"):        # what they say was kept
        path.unlink()
    status, second, err = slope(words)
    assert status == 0 and "more points towards" not in second and "0 to go" not in second, err
    again_found = yaml.safe_load(Path("out/study.yaml").read_text())["ensemble"]["known_events"]
    assert set(found["quantities"]) - set(again_found["quantities"]) == {"distance_99_m"}

    # curve and map, by hand
    mass = conditioned.masses(again)
    table = list(csv.DictReader(open("out/study.csv", encoding="ascii")))
    assert [row["run"] for row in table] == [row["run"] for row in rows]
    volumes = np.array([float(row["remove_on_road_m3"]) for row in table])
    curve = [row for row in csv.DictReader(open("out/hazard_known_events.csv", encoding="ascii"))
             if row["quantity"] == "remove_on_road_m3"]
    for row in curve:
        share = mass.share[volumes > float(row["value"]) * (1 + 1e-6)].sum() + mass.far
        assert float(row["exceeded"]) == pytest.approx(share, abs=2e-4)
        assert float(row["low"]) - 1e-9 <= share <= float(row["high"]) + 1e-4
    stack = np.array([read_asc(f"out/{row['run']}/tiny.thickness.asc") for row in rows])
    share = mass.share + 0
    share[mass.order[-1]] += mass.far       # one rule for maps, stretches and zones
    assert list(again_found["weights"].values()) == pytest.approx(share, abs=1e-6)
    there = read_asc("out/known_events/thickness_above_0.1.asc")
    assert there == pytest.approx(np.tensordot(share, stack > 0.1, 1), abs=1e-3) and there.max() > 0.5
    with rasterio.open("out/known_events/thickness.tif") as tif:
        bands = {name: tif.read(i + 1) for i, name in enumerate(tif.descriptions)}
    plain = "share of known events with a final thickness > 0.1 m"
    assert (bands[f"{plain}, lower bound"] <= bands[plain] + 1e-6).all()
    assert (bands[f"{plain}, upper bound"] >= bands[plain] - 1e-6).all()
    monkeypatch.setattr(site_warnings, "LARGE", 0.0)
    assert cli.main(["report", "out"]) == 0
    page = Path("out/report.html").read_text()
    capsys.readouterr()
    assert "Weighted by known events" in page and "90 % of known events stay within" in page
    assert LARGE not in page

    # a set that does not cover the mass: said, and nothing is weighted
    status, out, err = slope(words.replace("small.csv", "rock_avalanches").replace("'event 3'", "'Frank Slide'"))
    assert status == 0 and "the set of known events does not cover this volume" in out
    found = yaml.safe_load(Path("out/study.yaml").read_text())["ensemble"]["known_events"]
    assert found["reached"] is None and "quantities" not in found and not Path("out/weights.csv").exists()
    assert cli.main(["report", "out"]) == 0 and LARGE in Path("out/report.html").read_text()


@pytest.mark.parametrize("arguments, message", [
    ("--sample 8 --vary friction=1:2 --mobility none.csv", "none.csv: cannot be read as a set of events"),
    ("--sample 8 --vary friction=1:2 --mobility small.csv --except x", "--except: must be an event of small.csv"),
    ("--sample 8 --vary friction=1:2 --except x", "--except: must be given with --known"),
    ("--sample 8 --vary friction=1:2 --confined", "--confined or --unconfined: must be given with --known"),
    ("--sample 8 --vary friction=1:2 --mobility three.csv", "three.csv: must have at least 12 events"),
])
def test_wrong_conditions_are_one_line(slope, arguments, message):
    Path("three.csv").write_text("".join(Path("small.csv").read_text().splitlines(True)[:4]))
    status, out, err = slope(f"{arguments} -o out")
    assert (status, out) == (2, "") and is_one(err, f"slope study: {message}"), err
    assert not Path("out").exists()


# --- words ---

def test_what_is_not_reached_is_said():
    rows = [made_rows.row(off_grid_m3=lost, lost_m3=0.0, released_m3=100.0) for lost in (0.0, 5.0)]
    runs = type("Runs", (), {"rows": rows, "failed": 1})
    about = made_study.weighted(reached=0.4, far=0.5, short=0.1, longest_m=1700.4, shortest_m=900, effective=11.6,
                                gaps=[{"low_m": 1200, "high_m": 1500, "share": 0.2}])
    lines = list(map(str, known_events.find_known_caveats(about, runs)))
    for line, text in zip(lines, ("no run goes beyond 1,700 m; 50 % of known events do", "before 900 m; 10 %",
                                  "between 1,200 and 1,500 m no run ends; 20 % of known events do", "as 12 runs",
                                  "1 of 3 runs have no length", "1 of 2 runs lost more than 1 %")):
        assert text in line
    assert len(lines) == 6
    assert known_events.find_known_caveats(made_study.weighted(reached=0.96, far=0.02, short=0.02, effective=60),
                                           type("Runs", (), {"rows": rows[:1], "failed": 0})) == []


def test_a_report_shows_no_number_where_events_go_beyond_the_runs():
    quantiles = [{"share": 0.5, "value": 1000.0, "low": 0.0, "high": None},
                 {"share": 0.9, "value": None, "low": 900.0, "high": None}]
    known = {"reached": 0.5, "effective": 12.0, "doubts": ["why"], "quantities": {
        "front_m": {"name": "farthest ball", "unit": "m", "quantiles": quantiles}}}
    answer = ensemble_part.KnownEvents(None, Numbers(), made_study.ensemble(known, of="front_m")).answer()
    assert (answer.number, answer.unit) == ("unknown", "")
    known = {"reached": None, "doubts": ["the set of known events does not cover this volume"]}
    part = ensemble_part.KnownEvents(None, Numbers(), made_study.ensemble(known, of="front_m"))
    text, maps = part.section(None).blocks
    assert text.text == "The set of known events does not cover this volume." and not maps.pictures
    assert part.answer() is None
    assert "50 % of the known events" in answer.note
    assert answer.parts[0].note.startswith("At least 0 m with 90 %")


@pytest.mark.parametrize("number, shown", [
    ({"source": "ensemble", "share": 0.95, "volume_m3": 930.0}, "c"),       # raised by the effect of size
    ({"source": "ensemble", "share": 0.7, "volume_m3": 410.0}, "b"),        # a floor
    ({"source": "ensemble", "share": 0.95, "volume_m3": 0.0}, "d"), ({"source": "paper", "volume_m3": 5e3}, "a"),
    (None, "a")])
def test_the_run_shown_is_that_of_the_headline(number, shown):
    """Of an ensemble whose quantile it is; where nothing is to be removed the longest; else as without a headline."""
    runs = [made_rows.row(run=name, remove_m3=volume, remove_on_road_m3=on, length_m=length)
            for name, volume, on, length in (("a", 100.0, 9.0, 10.0), ("b", 400.0, 3.0, 40.0), ("c", 900.0, 1.0, 20.0),
                                             ("d", 9e3, 0.0, 90.0))]
    runs.append(made_rows.row(run="e", status="failed"))
    known = {"to_remove": [{"share": 0.95, "value": 900.0}, {"share": 0.7, "value": 400.0}],
             "quantities": {"remove_on_road_m3": {"quantiles": [{"share": 0.9, "value": 9.0}]}}}
    about = made_study.study(runs=runs, headline=number and made_study.headline(**number), ensemble=made_study.ensemble(
        known, of="remove_on_road_m3", quantities={"remove_on_road_m3": {}}))
    assert named_run.governing(about) == shown


@pytest.mark.parametrize("value, shown", [(2100.0, "b"), (None, "c"), ("absent", "c")])
def test_the_run_shown_has_the_quantity(value, shown):
    """Nearest to what 90 % of known events stay within, or the largest; a run that lost it over the edge has none."""
    quantities = {} if value == "absent" else {"distance_99_m": {"quantiles": [{"share": 0.9, "value": value}]}}
    runs = [made_rows.row(run=name, distance_99_m=one) for name, one in zip("abcd", (1500.0, 2000.0, 2500.0, None))]
    about = made_study.study(runs=runs, ensemble=made_study.ensemble(
        {"quantities": {"length_m": {}, **quantities}}, of="distance_99_m", quantities={"distance_99_m": {}}))
    assert named_run.governing(about) == shown
