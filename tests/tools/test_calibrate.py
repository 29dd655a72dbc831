"""tools/slope calibrate: twin experiments on a stand-in and on small collapses, resuming, regions, words, bad input."""
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import rasterio
import yaml

import made_rows
import twins
from messages import is_one
from run_helpers import called, write_tif
from tiny_collapse import TOP, loaded, write_case

from slope_tools.digits import three
from slope_tools.errors import SlopeError
from slope_tools.fitting import calibration, fit, observations
from slope_tools.runs import repeats
from slope_tools.statistics import backanalysis, designs, distributions, emulator, tempering
from slope_tools.studies import mapped
from slope_tools.survey import rasters

TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
PROGRAM = [sys.executable, str(TOOLS / "slope")]


# --- what was observed ---

def wanted(**options):
    return observations.Observations(observations.Wanted(*(options.get(name) for name in observations.KINDS), 0.05, 0.1,
                                                         False, front_is=options.get("front_is", "length")))


@pytest.mark.parametrize("options, lost, told", [
    ({"front": 100.0}, 9.0, True), ({"front": 100.0}, 11.0, False), ({"area": 100.0}, 11.0, False),
    ({"volume": 100.0}, 11.0, True), ({"observed": Path("a.tif")}, 500.0, True)])
def test_a_run_whose_mass_left_tells_no_length(options, lost, told):
    assert wanted(**options).told_by(made_rows.row(lost_m3=lost)) is told


def test_the_front_is_the_length_along_the_fall_path():
    one = made_rows.row(length_m=12.5, distance_99_m=40.0)
    columns = {name: column for name, (_, column) in observations.FRONTS.items()}
    assert observations.front(Path("a.summary.yaml"), one, columns["length"]) == 12.5
    assert observations.front(Path("a.summary.yaml"), one, columns["99"]) == 40.0
    assert observations.front(Path("a.summary.yaml"), made_rows.row(length_m=None), columns["length"]) == 0.0
    with pytest.raises(SlopeError, match="a.summary.yaml: must have the distance of a share of the volume .*older"):
        observations.front(Path("a.summary.yaml"), one, columns["95"])


# --- the search, on functions ---

def test_a_twin_is_recovered_where_it_can_be():
    one = twins.Twin(1, 40, batch=9)
    assert (np.abs(one.error) <= twins.CLOSE).all(), one.error
    assert all(one.holds) and len(one.points) == 40
    assert not any("not identifiable" in text for text in one.words)
    # the later points lie where the hidden values are
    place = (one.hidden - twins.LOW) / twins.WIDTH
    first, last = (np.abs(part - place).mean() for part in (one.points[:14], one.points[-9:]))
    assert last < 0.6 * first


def test_what_cannot_be_told_apart_is_said_and_the_region_holds_the_truth():
    one = twins.Twin(3, 24, batch=10, outputs=(0,))
    assert all(one.holds)
    assert any("not identifiable" in text for text in one.words)


def test_two_variables_that_make_up_for_each_other_are_said_to():
    rng = np.random.default_rng(4)
    variables = [distributions.distribution(name, "0:1", "", "") for name in "ab"]
    points = backanalysis.first(2, 1)
    outputs = (points.sum(axis=1) + rng.normal(0, 0.01, len(points)))[:, None]
    found = backanalysis.posterior(points, outputs, [backanalysis.Target("sum", "", 1.0, 0.0)])
    assert found.correlation()[0, 1] < -0.9
    assert any(text.startswith("a and b cannot be identified separately: more a with less b")
               for text in backanalysis.judgement(found, variables))
    region = found.pair(0, 1)
    assert region.holds([0.3, 0.7]) and region.holds([0.7, 0.3]) and not region.holds([0.9, 0.9])
    assert region.density[region.inside].sum() == pytest.approx(0.9, abs=0.05)


def test_intervals_of_a_gaussian():
    """One output that is its variable, with chance 0.05: mean, and 90 % within 1.645 standard deviations."""
    rng = np.random.default_rng(1)
    points = np.concatenate([backanalysis.first(1, 1), rng.random((190, 1))])
    outputs = points + rng.normal(0, 0.05, points.shape)
    found = backanalysis.posterior(points, outputs, [backanalysis.Target("x", "", 0.4, 0.0)])
    low, high = found.interval(0)
    assert found.best[0] == pytest.approx(0.4, abs=0.015) and found.noise[0] == pytest.approx(0.05, rel=0.15)
    assert high - low == pytest.approx(2 * 1.645 * 0.05, rel=0.2)
    wide = backanalysis.posterior(points, outputs, [backanalysis.Target("x", "", 0.4, 0.1)]).interval(0)
    assert wide[1] - wide[0] == pytest.approx(2 * 1.645 * np.hypot(0.05, 0.1), rel=0.2)


def test_a_thin_sheet_of_equally_good_values_is_found_whole():
    """Two conditions x0 = x1 and x2 = x3 leave each variable open: its 90 % interval is 0.9 wide, and so is the ridge.

    Of points spread over the cube a handful would be on the sheet, which look like a single solution.
    """
    points = np.concatenate([backanalysis.first(4, 1), np.random.default_rng(1).random((30, 4))])
    outputs = np.column_stack([points[:, 0] - points[:, 1], points[:, 2] - points[:, 3]])
    outputs += 0.001 * np.random.default_rng(2).normal(size=outputs.shape)
    found = backanalysis.posterior(points, outputs, [backanalysis.Target(name, "", 0.0, 0.0) for name in "ab"])
    widths = [np.subtract(*found.interval(i)[::-1]) for i in range(4)]
    assert widths == pytest.approx([0.9] * 4, abs=0.06) and found.misfit < 0.1
    ridge = found.pair(0, 1)
    assert [ridge.holds([u, u, 0, 0]) for u in (0.2, 0.5, 0.8)] == [True] * 3 and not ridge.holds([0.3, 0.7, 0, 0])
    variables = [distributions.distribution(name, "0:1", "", "") for name in "abcd"]
    words = backanalysis.judgement(found, variables)
    assert sum("not identifiable" in text for text in words) == 4
    assert [text.split(" cannot ")[0] for text in words[4:]] == ["a and b", "c and d"]
    assert len(backanalysis.propose(found, points, 4)) == 4


def test_best_values_lie_on_a_region_that_is_bent():
    """A circle of equally good values around the middle, which itself is none."""
    points = np.concatenate([backanalysis.first(2, 1), np.random.default_rng(1).random((60, 2))])
    outputs = np.hypot(*(points - 0.5).T)[:, None] ** 2 + 0.001 * np.random.default_rng(2).normal(size=(70, 1))
    found = backanalysis.posterior(points, outputs, [backanalysis.Target("a", "", 0.09, 0.0)])
    assert np.hypot(*(found.best - 0.5)) == pytest.approx(0.3, abs=0.02)
    assert np.abs(np.hypot(*(found.points - 0.5).T) @ found.weights) == pytest.approx(0.3, abs=0.01)


def test_points_are_drawn_from_a_likelihood():
    """A narrow Gaussian askew in the cube: mean and deviations of the points drawn; the least value of its exponent."""
    turn = np.array([[1, 1], [-1, 1]]) / np.sqrt(2)

    def log_likelihood(points):
        return -0.5 * ((((points - [0.3, 0.6]) @ turn) / [0.05, 0.0005]) ** 2).sum(axis=1)

    cloud = designs.points(designs.SOBOL, 2, 4096, 1)
    logs = log_likelihood(cloud)
    points, there = tempering.sample_likelihood(log_likelihood, cloud, logs, 1)
    assert there == pytest.approx(log_likelihood(points)) and len(np.unique(points, axis=0)) > 0.9 * len(points)
    assert points.mean(axis=0) == pytest.approx([0.3, 0.6], abs=0.004)
    assert (points @ turn).std(axis=0) == pytest.approx([0.05, 0.0005], rel=0.1)
    assert -logs.max() > 10 * tempering.minimise_function(lambda some: -log_likelihood(some), cloud, -logs, 1)


def test_what_the_model_cannot_reach_is_said():
    points = backanalysis.first(2, 1)
    rng = np.random.default_rng(2)
    outputs = np.column_stack([points[:, 0], points[:, 1], points[:, 0] + 1]) + rng.normal(0, 0.01, (len(points), 3))
    targets = [backanalysis.Target(name, "", value, 0.0) for name, value in zip("xyz", (0.5, 0.5, 2.5))]
    found = backanalysis.posterior(points, outputs, targets)
    variables = [distributions.distribution(name, "0:1", "", "") for name in "ab"]
    assert found.misfit > 2
    assert any("no values of these variables reproduce the observation" in text
               for text in backanalysis.judgement(found, variables))


def test_a_gap_is_named_where_there_is_one_and_the_region_holds_the_truth():
    """Seed 0 lies near the step. No value between 1,750 and 2,300 m can occur."""
    one, plain = twins.Steep(0, 550.0), twins.Steep(0, 0.0)
    (low, high), = one.gaps
    assert one.near and one.holds and 1600 < low <= 1750 and 2300 <= high < 2450
    assert plain.holds and not plain.gaps
    line, = fit.jumps(one.found, one.targets)
    assert line.startswith(f"run-out: no run gives a value between {three(low)} and {three(high)} m, where the "
                           "response jumps")
    inside = [one.targets[0]._replace(value=2000.0), one.targets[1]]
    line, = fit.jumps(one.found, inside)
    assert line.endswith("; the observed 2,000 lies there, and no values reproduce it")


def test_a_run_is_predicted_from_the_others():
    """As by a process without it, of the same kernel."""
    points = designs.points(designs.SOBOL, 2, 16, 3)
    values = points @ [3.0, 1.0] + 0.1 * np.random.default_rng(3).normal(size=16)
    whole = emulator.Emulator(points, values)
    mean, deviation = whole.unseen(values)
    y = (values - whole.mean) / whole.scale
    for i in (0, 7, 15):
        kept = np.arange(16) != i
        covariance = whole.kernel(points)
        weights = np.linalg.solve(covariance[np.ix_(kept, kept)], covariance[kept, i])
        assert mean[i] == pytest.approx(whole.mean + whole.scale * weights @ y[kept], rel=1e-6)
        assert deviation[i] == pytest.approx(whole.scale * np.sqrt(covariance[i, i] - weights @ covariance[kept, i]),
                                             rel=1e-5)


def test_a_best_run_that_misses_is_said_first():
    one = twins.Steep(0, 550.0)
    value = one.targets[0].value
    assert fit.misses(one.found, one.targets, np.array([target.value for target in one.targets])) == []
    line, = fit.misses(one.found, one.targets, np.array([value + 500, one.targets[1].value]))
    assert line.endswith(f"explain: run-out {three(value + 500)} instead of {three(value)} m")
    assert "says nothing" in fit.misses(one.found, one.targets, None)[0]


def test_sets_stand_for_the_region():
    one = twins.Steep(3, 0.0)
    sets = backanalysis.sets(one.found, 64)
    assert sets.shape == (64, 2) and len(np.unique(sets, axis=0)) > 55
    mean = one.found.weights @ one.found.points
    deviation = np.sqrt(one.found.weights @ (one.found.points - mean) ** 2)
    assert (np.abs(sets.mean(axis=0) - mean) < 0.35 * deviation).all()
    assert sets.std(axis=0) == pytest.approx(deviation, rel=0.35)


def test_the_ledger_keeps_what_was_decided(tmp_path):
    variables = [distributions.distribution("a", "0:10", "", "")]
    ledger = calibration.Ledger(tmp_path, {"seed": 1}, variables)
    ledger.add(np.array([[0.25], [0.5]]))
    again = calibration.Ledger(tmp_path, {"seed": 1}, variables)
    assert again.points == [{"a": "2.5"}, {"a": "5"}] and again.places([1]) == 0.5
    with pytest.raises(calibration.SlopeError, match="must be of the same observation, variables and seed"):
        calibration.Ledger(tmp_path, {"seed": 2}, variables)


def test_the_best_values_are_those_of_the_outputs_that_count(tmp_path):
    """Of a folder that an older version made, whose runs told twice as much: the last run is decided on anew, once."""
    made = []

    def calibrated(factor):
        ledger = calibration.Ledger(tmp_path, {"seed": 1}, [distributions.distribution("a", "0:10", "", "")])
        plan = calibration.Calibration(ledger, tmp_path, {}, [], 1, 12, 4)
        plan.do(lambda todo: made.append(len(todo)) or [np.array([factor * float(one.combination["a"])])
                                                        for one in todo],
                lambda: [backanalysis.Target("length", "m", 6.0, 0.1)], lambda text: None)
        return float(ledger.points[-1]["a"])

    assert calibrated(2.0) == pytest.approx(3.0, abs=0.1)
    made.clear()
    assert calibrated(1.0) == pytest.approx(6.0, abs=0.1) and made == [12, 1]
    made.clear()
    assert calibrated(1.0) == pytest.approx(6.0, abs=0.1) and made == [12]


# --- small collapses ---

@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    deck = write_case(tmp_path / "case")
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    terrain = rasters.read_raster(Path("case/terrain.asc"))
    rasters.write_asc_local(Path("case/terrain.asc"), terrain._replace(
        crs=rasterio.crs.CRS.from_epsg(6677), offset=(-12000.0, 34000.0)), {})
    deck.write_text(deck.read_text().replace("index 150", "index 700\nvariable  xoffset index 0.0").replace(
        "sc 1.0", "sc 1.0 origin ${xoffset} 0 0"))
    return tmp_path


def truth(slope, values="--set friction=20 --set rolling=0.1"):
    """The mapped deposit: that of a run with hidden values and another lattice, as a GeoTIFF."""
    assert slope(f"study case/in.tiny {values} --set xoffset=0.4 --exceed 0.1 -o truth")[0] == 0
    Path("truth/envelope_thickness.tif").rename("mapped.tif")


WORDS = "--vary friction=5:40 --vary rolling=0:0.4"


@pytest.mark.drawn
@pytest.mark.long
def test_a_calibration_of_small_collapses_goes_on_after_a_kill(slope, succeed, here):
    truth(slope)
    words = f"calibrate case/in.tiny --observed mapped.tif {WORDS} --repeat xoffset=0.2 --runs 16 --jobs 2 -o out"
    process = subprocess.Popen([*PROGRAM, *shlex.split(words)], stdout=subprocess.DEVNULL, env={**os.environ})
    end = time.monotonic() + 120
    while len(list(Path("out").glob("*/finished.yaml"))) < 3:
        assert time.monotonic() < end and process.poll() is None
        time.sleep(0.1)
    process.send_signal(signal.SIGKILL)
    process.wait(20)
    decided = yaml.safe_load(Path("out/calibrate.ledger.yaml").read_text())["points"]
    out, _ = succeed(words)
    assert "runs are finished already" in out and "10 of 16 runs: friction " in out
    about, table = loaded("calibrate")
    assert len(table) == 16 and [{name: row[name] for name in ("friction", "rolling")} for row in table][:10] == decided
    assert [row["repeat"] for row in table[:4]] == ["base", "xoffset 0.2"] * 2
    names = [entry["name"] for entry in about["targets"]]
    assert names == ["lack of overlap", "99 % of the volume within", *(f"volume in zone {k}" for k in range(1, 7))]
    # the outputs are those of the runs: overlap and volumes by hand
    with rasterio.open("mapped.tif") as tif:
        mapped = np.maximum(tif.read(1), 0)
    from tiny_collapse import read_asc
    for row in (table[0], table[-1]):
        mine = read_asc(f"out/{row['run']}/tiny.thickness.asc")
        both, either = ((mine > 0.1) & (mapped > 0.1)).sum(), ((mine > 0.1) | (mapped > 0.1)).sum()
        assert float(row["lack of overlap (1 - CSI)"]) == pytest.approx(1 - both / either)
        assert sum(float(row[f"volume in zone {k} (m3)"]) for k in range(1, 7)) == pytest.approx(mine.sum())
    # zones are bands of distance that hold equal shares of what is mapped
    assert [entry["observed"] for entry in about["targets"][2:]] == pytest.approx([mapped.sum() / 6] * 6, rel=0.15)
    # the last run is at the best values, and near the truth in what it gives
    assert about["best"]["run"] == table[-1]["run"] and about["best"]["set"]["friction"] == table[-1]["friction"]
    first = sorted(float(row["score"]) for row in table[:10])
    assert float(table[-1]["score"]) == pytest.approx(about["best"]["score"], rel=1e-5)
    assert about["best"]["score"] < first[5]
    for name in ("friction", "rolling"):
        entry = about["variables"][name]
        assert entry["low"] <= entry["high"] and entry["identifiable"] in ("yes", "roughly", "no")
        said = float(re.search(rf"^{name}: ([0-9.]+),", out, re.M)[1])
        assert said == pytest.approx(float(about["best"]["set"][name]), abs=0.04 if name == "friction" else 4e-4)
        values = [float(one[name]) for one in about["sets"]]
        assert len(values) == 64 and sum(entry["low"] <= value <= entry["high"] for value in values) > 48
    assert about["pairs"][0]["rows_of"] == "rolling" and "x" in "".join(about["pairs"][0]["region"])
    for name in ("calibrate.png", "predicted.png"):
        assert Path("out", name).read_bytes().startswith(b"\x89PNG")
    an_ensemble_of_the_region(slope, about["sets"])
    # more runs are added; what was finished is kept
    before = {path: path.stat().st_mtime_ns for path in Path("out").glob("*/finished.yaml")}
    status, out, err = slope(words.replace("--runs 16", "--runs 18"))
    assert status == 0 and len(loaded("calibrate")[1]) == 18, err
    assert all(path.stat().st_mtime_ns == stamp for path, stamp in before.items())
    status, _, err = slope(words)
    assert status == 2 and "--runs: must be at least what out/calibrate.ledger.yaml has, 18, got 16" in err
    status, _, err = slope(words.replace("friction=5", "friction=6"))
    assert status == 2 and "calibrate.ledger.yaml: must be of the same observation, variables and seed" in err


def an_ensemble_of_the_region(slope, sets):
    """study --from: its runs are sets of the calibration."""
    status, _, err = slope("study case/in.tiny --from out --sample 5 --exceed 0.1 -o more")
    assert status == 0, err
    found = yaml.safe_load(Path("more/study.yaml").read_text())
    different = list({tuple(one.values()): one for one in sets}.values())
    assert [run["set"] for run in found["runs"]] == different[:5]
    assert found["ensemble"]["design"]["kind"] == "calibrated"
    for words, message in (
            ("--from case", "--from: must be a folder with calibrate.yaml, which slope calibrate writes, got case"),
            ("--from out --vary friction=5:20", "--vary: must not be given with --from"),
            ("--from out --sample 2", "--sample: must be from 3 to "),
            ("--from out --sample 65", "--sample: must be from 3 to "),
            ("--from out --seed 3", "--seed: must not be given with --from"),
            ("--from out --mobility rock_avalanches", "--known: must not be given with --from"),
            ("--from out --set friction=20", "--from: must not have a variable of --set, got friction"),
            ("--from spoiled", "spoiled/calibrate.yaml: must be what `slope calibrate` wrote, with its sets")):
        if "spoiled" in words:
            Path("spoiled").mkdir()
            Path("spoiled/calibrate.yaml").write_text("calibration: {variables: {friction: '5:40'}}\n")
        status, _, err = slope(f"study case/in.tiny {words} -o bad")
        assert status == 2 and is_one(err, f"slope study: {message}"), err
        assert not Path("bad").exists()


def test_numbers_alone_with_a_failing_run(succeed, here):
    deck = Path("case/in.tiny")
    deck.write_text(deck.read_text().replace("group       soil", 'if "${friction} > 37" then "nonsense"\n'
                                             "group       soil"))
    out, _ = succeed(f"calibrate case/in.tiny --front 14 --area 180 --road-volume 40 --road case/road.csv "
                     f"--local {WORDS} --tolerance area=0.2 --runs 12 --set steps=300 -o out")
    about, table = loaded("calibrate")
    assert [entry["tolerance"] for entry in about["targets"]] == pytest.approx([0.05 * 14, 0.2 * 180, 0.05 * 40])
    failed = [row for row in table if row["status"] == "failed"]
    assert failed and all(float(row["friction"]) > 37 and row["score"] == "" for row in failed)
    assert f"caveat: {len(failed)} of 12 runs failed and are left out" in out
    assert sum("xoffset" in one["text"] for one in about["doubts"]) == 1        # the deck has it, and nothing moves it
    assert [entry["name"] for entry in about["targets"]] == ["length along the fall path", "area covered",
                                                             "volume on the road"]
    assert not Path("out/predicted.png").exists()


def test_chance_that_few_runs_cannot_show_is_doubted():
    """A smooth function without chance, and the same with: the emulator tells which."""
    points = designs.points(designs.SOBOL, 3, 24, 1)
    smooth = points @ [1.0, 2.0, 0.5] + points[:, 0] ** 2
    noisy = smooth + 0.2 * np.random.default_rng(1).normal(size=len(smooth))
    assert not emulator.Emulator(points, smooth).noise_seen
    assert emulator.Emulator(points, noisy).noise_seen


def test_chance_is_not_underestimated_by_few_runs():
    """14 runs of three variables: the likeliest noise is 0.8 of the true one, as it takes the smooth part for known."""
    found = []
    for seed in range(20):
        points = designs.points(designs.SOBOL, 3, 14, seed)
        smooth = 100 * (1 - 0.6 * points[:, 0]) * (1 - 0.3 * points[:, 1])
        noise = 0.1 * smooth.std()
        one = emulator.Emulator(points, smooth + noise * np.random.default_rng(seed).normal(size=14))
        found.append((one.noise / noise, one.chance / noise))
        assert 0 < one.freedom <= 14
    likeliest, chance = np.median(found, axis=0)
    assert likeliest < 0.9 < chance < 1.4, (likeliest, chance)


def test_outlines(succeed, here):
    """An outline has its own targets; that of the run itself is met by it."""
    Path("outline.csv").write_text("14,6\n26,6\n26,18\n14,18\n")
    succeed(f"calibrate case/in.tiny --observed outline.csv --local {WORDS} --runs 8 --set steps=200 "
            "-o out")
    about, _ = loaded("calibrate")
    assert [entry["name"] for entry in about["targets"]] == [
        "lack of overlap", "50 % of the area within", "90 % of the area within", "99 % of the area within", "area"]
    assert about["targets"][-1]["observed"] == pytest.approx(144)


def test_a_raster_without_a_crs_is_taken_to_be_in_that_of_the_terrain(slope, here):
    write_tif("mapped.tif", np.ones((24, 40)), 1.0, crs=None)
    status, _, err = slope(f"calibrate case/in.tiny --observed mapped.tif {WORDS} --runs 20 -o out --dry-run")
    assert status == 0 and err.count("\n") == 1
    assert err.startswith("slope calibrate: warning: mapped.tif has no CRS: taken to be in that of the terrain")


def test_a_mapped_deposit_that_goes_on_beside_the_terrain_is_refused(slope, here):
    """All runs would seem to go as far as it: its far end is not on their grid."""
    Path("outline.csv").write_text("-6,6\n26,6\n26,18\n-6,18\n")
    status, _, err = slope(f"calibrate case/in.tiny --observed outline.csv --local {WORDS} --runs 8 -o out --dry-run")
    assert status == 2 and "outline.csv: must lie on the terrain, but for 1%" in err and "got 0.19 beside it" in err


def test_all_runs_failed_is_one_line(slope, here):
    Path("case/in.tiny").write_text("nonsense\n" + Path("case/in.tiny").read_text())
    status, _, err = slope(f"calibrate case/in.tiny --front 14 {WORDS} --runs 7 -o out")
    assert status == 2 and err.count("\n") == 1
    assert err.startswith("slope calibrate: out: 6 of 6 runs failed, too many to go on: friction_"), err


@pytest.mark.parametrize("arguments, message", [
    (f"{WORDS} --runs 20", "--observed, --front, --area, --road-volume: must give at least one of them"),
    (f"{WORDS} --runs 6 --front 10", "--runs: must be at least 7 for 2 parameters, got 6"),
    ("--vary friction=5:95 --runs 20 --front 10", "--vary: friction must stay within the deck's range, >= 0 and < 90"),
    ("--vary friction=list:5,10 --runs 20 --front 10", "--vary: must be a range here, NAME=LO:HI"),
    (f"{WORDS} --runs 20 --front -3", "--front: must be > 0, got -3"),
    (f"{WORDS} --runs 20 --road-volume 40", "--road-volume: needs --road"),
    (f"{WORDS} --runs 20 --front 9 --tolerance 2", "--tolerance: must be a share"),
    (f"{WORDS} --runs 20 --front 9 --tolerance front=1", "--tolerance: must be a share, >= 0 and < 1, got 1"),
    (f"{WORDS} --runs 20 --front 9 --tolerance area=0.1", "--tolerance: must be of what is observed: needs --area"),
    (f"{WORDS} --runs 20 --front 9 --tolerance far=0.1",
     "argument --tolerance: must name one of observed, front, area, volume, got 'far'"),
    (f"{WORDS} --runs 20 --front 9 --set friction=3", "--vary: must not name a variable of --set, got friction"),
    (f"{WORDS} --runs 20 --front 9 --repeat cell=2", "--repeat: must name a variable that differs by chance alone"),
    (f"{WORDS} --runs 20 --observed far.tif", "far.tif: must overlap the grid of the run"),
    (f"{WORDS} --runs 20 --observed other.tif", "other.tif: must be in the CRS of the run, EPSG:6677"),
    (f"{WORDS} --runs 20 --observed away.csv --local", "away.csv: must overlap the terrain"),
])
def test_wrong_calibrations_are_one_line(slope, here, arguments, message):
    write_tif("far.tif", np.ones((24, 40)), 1.0, xlo=500000.0)
    write_tif("other.tif", np.ones((24, 40)), 1.0, crs="EPSG:6678")
    Path("away.csv").write_text("900,900\n950,900\n950,950\n")
    status, out, err = slope(f"calibrate case/in.tiny {arguments} -o out")
    assert (status, out) == (2, "") and is_one(err, f"slope calibrate: {message}"), err
    assert not Path("out").exists()


# --- the pages ---

def examples(page, command):
    """Command lines of a page's examples, without the program; continued lines are joined."""
    text = (TOP / "doc" / "src" / page).read_text(encoding="ascii").replace("\\\n", " ")
    return [line.split("tools/slope ")[1] for line in text.splitlines()
            if line.startswith(f"   tools/slope {command} ") and "DECK" not in line]


@pytest.mark.parametrize("line", [
    *examples("tool_calibrate.rst", "calibrate"), *examples("choosing_parameters.rst", "calibrate")])
def test_every_example_of_the_pages_is_understood(line, here, capsys):
    """Up to what it would run; decks and data of the examples that are no case of the repository are made up."""
    deck = Path("case/in.tiny").read_text().replace("variable  rolling", "variable  spacing index 1\nvariable  field_e "
                                                    "index 0.1\nvariable  rolling")
    Path("case/in.collapse").write_text(deck)
    os.symlink(TOP / "inputs", "inputs")
    for name in ("deposit.geojson", "outline.geojson"):
        Path(name).write_text('{"type": "Polygon", "coordinates": [[[14, 6], [26, 6], [26, 18], [14, 6]]]}')
    Path("road.csv").write_text((TOP / "inputs" / "20_embankment" / "road.csv").read_text())
    words = shlex.split(line.replace("in.collapse", "case/in.collapse"))
    if "--help" not in words:
        words += ["--dry-run", *(["--local"] if "--local" not in words else [])]
    status, _, err = called(capsys, words)
    assert status == 0, err


# --- runs that are not at rest, and a mass that is not the same ---

def fit_of(tmp_path, monkeypatch, rest_after, duration="10", fixed=(), fails=()):
    """A Fit whose runs are at rest from a duration (s) on, and what it tells; fails: durations of runs that fail."""
    told = []

    def rows_of(setup, todo):
        rows = []
        for one in todo:
            seconds = float(one.chosen.get("duration", duration))
            one.error = "no" if seconds in fails else None
            rows.append(made_rows.row(run=one.name, status="failed") if one.error else made_rows.row(
                run=one.name, at_rest=seconds >= rest_after, stop_time_s=seconds,
                stop_reason="halted" if seconds >= rest_after else "run completed"))
        return rows

    monkeypatch.setattr(fit.run_rows, "read_run_rows", rows_of)
    monkeypatch.setattr(fit.Fit, "summary", lambda self, row: None)
    monkeypatch.setattr(fit.Fit, "terrain", staticmethod(lambda one: None))
    work = SimpleNamespace(store=SimpleNamespace(admit=lambda todo: None), do=lambda todo: None,
                           defaults={"duration": duration})
    ledger = calibration.Ledger(tmp_path, {}, [])
    plan = calibration.Calibration(ledger, tmp_path, dict(fixed), [], 1, 8, 2)
    found = fit.Fit(SimpleNamespace(output=tmp_path, tell=told.append), SimpleNamespace(), plan, work)
    found.observed = SimpleNamespace(told_by=lambda row: True, measure=lambda summary, terrain, row: row.stop_time_s,
                                     volume=None)
    plan.runs = [repeats.Repeat(tmp_path, {**dict(fixed), "friction": "20"}),
                 repeats.Repeat(tmp_path, {**dict(fixed), "friction": "30"}, {"xoffset": "0.5"})]
    return found, told


def test_a_run_that_is_not_at_rest_gets_more_time(tmp_path, monkeypatch):
    found, told = fit_of(tmp_path, monkeypatch, rest_after=35.0)
    assert found.evaluate(list(found.plan.runs)) == [80.0, 80.0]
    assert [one.chosen["duration"] for one in found.plan.runs] == ["80", "80"]
    assert found.plan.runs[1].repeat == {"xoffset": "0.5"} and len(found.rows) == 2
    assert told == ["2 runs not at rest at the end of the duration: again until rest, for 80 s at most"]


@pytest.mark.parametrize("more, seconds", [
    ({"rest_after": 1e9}, 80.0),                                # once, and no more
    ({"rest_after": 5.0}, 10.0), ({"rest_after": 35.0, "fixed": {"duration": "10"}.items()}, 10.0),
    ({"rest_after": 35.0, "fails": (80.0,)}, 10.0)])
def test_how_much_more_time(tmp_path, monkeypatch, more, seconds):
    found, _ = fit_of(tmp_path, monkeypatch, **more)
    assert found.evaluate(list(found.plan.runs)) == [seconds] * 2


@pytest.mark.parametrize("duration, told, more", [("10", True, True), ("${T}", True, False), ("10", False, False)])
def test_more_time_needs_a_duration_of_numbers_and_a_run_that_counts(tmp_path, monkeypatch, duration, told, more):
    found, _ = fit_of(tmp_path, monkeypatch, rest_after=35.0)
    found.work.defaults["duration"], found.observed.told_by = duration, lambda row: told
    cut = made_rows.row(at_rest=False, stop_reason="run completed")
    assert found.was_cut(repeats.Repeat(tmp_path, {}), cut) is more


def test_a_mapped_deposit_of_another_mass_is_named(tmp_path, monkeypatch):
    found, _ = fit_of(tmp_path, monkeypatch, rest_after=5.0)
    found.evaluate(list(found.plan.runs))
    assert found.mass() is None
    found.observed.volume = 740.0
    assert found.mass().text.startswith("the mapped deposit holds 26 % less than is released, 740 m3 of 1,000")
    assert mapped.mass(1290.0, 1000.0).numbers["which"] == "more"
    assert mapped.mass(905.0, 1000.0) is mapped.mass(None, 1000.0) is None
