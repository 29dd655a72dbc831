"""tools/slope sensitivity --converge: the fit against numbers by hand, its intervals, the command, the size error."""
import math
import shlex
import statistics
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from scipy import stats

from run_helpers import called
from tiny_collapse import edit, rows_of

from slope_tools.errors import SlopeError
from slope_tools.statistics import convergence
from slope_tools.studies import size_study
from slope_tools.tables import size_error
from slope_tools.tables.size_error import SizeErrors

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
SIZES = (4.0, 2.5, 1.25, 0.9)
ROAD = "--road case/road.csv --local"


def runs_of(random, curve, deviation, repeats=3, sizes=SIZES):
    return [(d, list(curve(d) + deviation(d) * random.standard_normal(repeats))) for d in sizes]


# --- the fit ---

def test_a_line_without_scatter_is_found():
    fit = convergence.fit([(d, [18000 - 500 * d] * 2) for d in SIZES])
    assert fit.small.value == pytest.approx(18000) and fit.slope.value == pytest.approx(-500)
    assert fit.small.standard_error == pytest.approx(0, abs=1e-6) and fit.supported and not fit.curve_is_clear
    assert [size.d for size in fit.sizes] == sorted(SIZES, reverse=True)
    for size in fit.sizes:
        assert size.error == pytest.approx(-500 * size.d / 18000)
        line = convergence.error_of_line(fit.small, fit.slope, fit.covariance, fit.quantile, size.d)
        assert line.share == pytest.approx(size.error)


def test_weights_standard_errors_and_lack_of_fit_by_hand():
    runs = [(4.0, [8.0, 12.0]), (1.0, [19.0, 21.0]), (2.0, [17.0])]
    # s is 2.83 at d 4 and 1.41 at d 1: by counting, 1.5, the ratio would be 8, with none 1: none is likelier
    fit = convergence.fit(runs)
    assert fit.exponent == convergence.EVEN
    x = np.array([4, 4, 2, 1, 1.0])
    y = np.array([8, 12, 17, 19, 21.0])
    found = stats.linregress(x, y)
    assert fit.small.value == pytest.approx(found.intercept) and fit.slope.value == pytest.approx(found.slope)
    assert fit.degrees_of_freedom == 3
    assert fit.small.standard_error == pytest.approx(found.intercept_stderr)
    assert fit.slope.standard_error == pytest.approx(found.stderr)
    low, high = fit.interval
    assert (high - low) / 2 == pytest.approx(3.182446 * found.intercept_stderr, rel=1e-6)
    # pure error: 8 + 2 with two degrees of freedom; the rest of the residuals with one
    residuals = ((y - found.intercept - found.slope * x) ** 2).sum()
    assert fit.lack[0] == pytest.approx((residuals - 10) / (10 / 2))
    assert fit.lack[1] == pytest.approx(stats.f.sf(fit.lack[0], 1, 2)) and fit.supported


def test_scatter_that_grows_with_the_size_is_weighted():
    runs = [(4.0, [800.0, 1200.0, 1000.0]), (1.0, [1500.0, 1525.0, 1475.0]), (2.0, [1300.0, 1370.0, 1230.0])]
    fit = convergence.fit(runs)
    assert fit.exponent == convergence.COUNTING
    d, means = np.array([4, 1, 2.0]), np.array([1000, 1500, 1300.0])
    slope, small = np.polyfit(d, means, 1, w=np.sqrt(3 / d ** 3))
    assert fit.small.value == pytest.approx(small) and fit.slope.value == pytest.approx(slope)


def test_what_differs_by_rounding_does_not_differ():
    """The released volume that is the body's, whatever the size: neither repeats nor sizes scatter."""
    fit = convergence.fit([(d, [48859.2179 + k * 7e-12 + d * 1e-11 for k in range(3)]) for d in SIZES])
    assert fit.small.value == pytest.approx(48859.2179) and fit.small.standard_error == 0
    assert fit.supported and fit.exponent == convergence.COUNTING and not fit.curve_is_clear
    assert all(abs(size.error) < 1e-9 for size in fit.sizes)


def test_intervals_and_errors_cover_the_truth():
    """95 of 100 intervals hold the value for small balls, and the error of a size; the line is given up in 5."""
    random = np.random.default_rng(1)
    for power in (1.5, 0):
        held = kept = given_up = 0
        for _ in range(600):
            fit = convergence.fit(runs_of(random, lambda d: 17500 - 500 * d, lambda d: 150 * d ** power))
            low, high = fit.interval
            held += low < 17500 < high
            size = fit.sizes[1]
            kept += abs(size.error + 500 * 2.5 / 17500) < fit.quantile * size.standard_error
            given_up += not fit.supported
        assert 0.92 <= held / 600 <= 0.98 and 0.92 <= kept / 600 <= 0.985 and 0.02 <= given_up / 600 <= 0.09


def test_the_standard_error_of_an_error_is_that_of_all_means_together():
    """First-order propagation, with derivatives by shifting the runs of one size after the other."""
    runs = runs_of(np.random.default_rng(7), lambda d: 17500 - 500 * d, lambda d: 150 * d ** 1.5)
    fit = convergence.fit(runs)
    for k, size in enumerate(fit.sizes):
        variance = 0.0
        for i, (d, values) in enumerate(runs):
            moved = convergence.fit([*runs[:i], (d, [value + 1e-2 for value in values]), *runs[i + 1:]])
            derivative = (moved.sizes[k].error - size.error) / 1e-2
            variance += (derivative * fit.scatter * d ** fit.exponent) ** 2 / len(values)
        assert size.standard_error == pytest.approx(math.sqrt(variance), rel=1e-3)


def test_a_line_that_the_runs_do_not_support_is_said_so():
    random = np.random.default_rng(2)
    fit = convergence.fit(runs_of(random, lambda d: 17500 - 300 * d ** 2, lambda d: 40))
    assert fit.supported is False and fit.curve_is_clear
    assert fit.curved_small.value == pytest.approx(17500, abs=3 * fit.curved_small.standard_error)
    # the standard error is that of the residuals, with which the interval holds what the line misses
    assert fit.degrees_of_freedom == 2 and fit.interval[0] < 17500 < fit.interval[1]
    text = " ".join(convergence.words(fit, "d", "to remove", "m3", "{:,.0f}".format))
    assert "the line is not supported" in text and "a parabola fits clearly better" in text


@pytest.mark.parametrize("runs, quantile, supported", [
    ([(4.0, [10.0]), (2.0, [12.0])], None, None),                       # a line through two points
    ([(4.0, [10.0]), (2.0, [12.0]), (1.0, [12.5])], 12.7062, None),     # residuals stand for the scatter
    ([(4.0, [10.0, 11.0]), (2.0, [12.0, 12.5])], 4.30265, None),        # repeats do
])
def test_what_is_not_known_is_said_so(runs, quantile, supported):
    fit = convergence.fit(runs)
    assert fit.supported is supported and fit.quantile == (quantile and pytest.approx(quantile, rel=1e-5))
    assert (fit.interval is None) == (quantile is None)
    text = " ".join(convergence.words(fit, "d", "to remove", "m3", "{:,.2f}".format))
    assert ("standard error unknown" in text) == (quantile is None) and "it is unknown whether a line holds" in text


def test_without_a_value_above_0_there_are_no_shares():
    fit = convergence.fit([(4.0, [8.0, 9.0]), (2.5, [3.0, 2.0]), (1.0, [0.0, 0.4])])
    assert not fit.known and all(size.error is None for size in fit.sizes)
    assert "is not clearly above 0" in " ".join(convergence.words(fit, "d", "a", "m3", str))
    fit = convergence.fit([(4.0, [0.0, 0.0]), (2.5, [0.0, 0.0]), (1.0, [0.0, 0.0])])
    assert not fit.known and fit.small.value == 0 and fit.supported


# --- what the study takes from it ---

def write_converge(path, runs, quantity="remove_m3", **study):
    """A converge.yaml of these runs."""
    fit = convergence.fit(runs)
    about = {"study": {"deck": "in.tiny", "variable": "d", "base": {"rolling": "0"}, "road": None,
                       "finished": len(runs), **study},
             "quantities": {quantity: size_study.entry(fit, ("to remove", "m3"), [])}}
    Path(path).write_text(yaml.safe_dump(about))
    return fit


def test_size_errors_are_those_of_the_fit(tmp_path):
    random = np.random.default_rng(3)
    runs = runs_of(random, lambda d: 17500 - 500 * d, lambda d: 100 * d ** 1.5)
    fit = write_converge(tmp_path / "converge.yaml", runs)
    errors = SizeErrors(tmp_path / "converge.yaml", "remove_m3")
    for size in fit.sizes:
        found = errors.at(f"{size.d:g}0" if "." in f"{size.d:g}" else f"{size.d:g}")
        assert found.share == pytest.approx(size.error)
        assert found.half == pytest.approx(fit.quantile * size.standard_error)
    # on the line where nothing was run: its share and interval, by sampling the line
    found = errors.at("1.8")
    assert found.share == pytest.approx(fit.slope.value * 1.8 / fit.small.value)
    line = random.multivariate_normal(
        [fit.small.value, fit.slope.value], [[fit.small.standard_error ** 2, fit.covariance],
                                             [fit.covariance, fit.slope.standard_error ** 2]], 100000)
    assert found.half == pytest.approx(fit.quantile * (1.8 * line[:, 1] / line[:, 0]).std(), rel=0.02)
    for value in ("5", "0", "-1", "x"):
        with pytest.raises(SlopeError, match="must know the error of all values of d; .* from 0 to 4"):
            errors.at(value)


def test_what_speaks_against_a_size_error(tmp_path):
    write_converge(tmp_path / "c.yaml", [(4.0, [10.0, 11.0]), (1.0, [13.0, 13.5])], base={
        "rolling": "0", "field_d": "1.25", "out": "a", "xoffset": "0.5"}, road={"cut_angle": 30.0, "mesh": 10.0})
    errors = SizeErrors(tmp_path / "c.yaml", "remove_m3")
    same = {"rolling": "0", "field_d": "1.250", "out": "b", "xoffset": "0"}
    road = {"cut_angle": 30.0, "mesh": 10.0}
    assert errors.doubts("in.tiny", same, ["xoffset"], road) == []
    assert [one.numbers for one in errors.doubts(
        "in.other", {**same, "rolling": "0.1", "field_d": "0.9"}, ["rolling", "xoffset"],
        {"cut_angle": 35.0, "mesh": 10.0})] == [
            {"deck": "in.tiny"}, {"other": "field_d 1.25 instead of 0.9, cut angle 30 instead of 35"}]


@pytest.mark.parametrize("runs, field, d, words", [
    ([(4.0, [88.0, 89.0]), (2.0, [94.0, 95.0]), (1.0, [97.0, 97.5])], "1.25", "1.0", []),
    ([(4.0, [88.0, 89.0]), (2.0, [94.0, 95.0]), (1.0, [97.0, 97.5])], "1.0", "1.0", ["smaller than the field's, 1 m"]),
    ([(4.0, [40.0, 41.0]), (2.0, [70.0, 71.0]), (1.0, [85.0, 86.0])], "1.25", "2.0", ["it is -30 %"]),
    ([(4.0, [0.0, 0.0]), (2.0, [45.0, 50.0]), (1.0, [75.0, 76.0])], "1.25", "1.0", [
        "nothing to remove, at d 4", "it is -"])])
def test_a_size_error_of_balls_that_are_too_large_is_not_trusted(tmp_path, runs, field, d, words):
    base = {"rolling": "0", "field_d": field}
    write_converge(tmp_path / "c.yaml", runs, base=base)
    found = SizeErrors(tmp_path / "c.yaml", "remove_m3").distrust([d])
    found = [text for text in found if "do not support" not in text]
    assert len(found) == len(words) and all(word in text for word, text in zip(words, found)), found


@pytest.mark.parametrize("means, field, falls", [
    ((30, 20, 10), "${d}", True), ((30, 10, 20), "${d}", False), ((30, 20, 0), "${d}", False),
    ((30, 20, 10), "1.5", True), ((30, 20, 10), "1.0", False), ((30, 20, 10), "x", False)])
def test_a_volume_that_falls_with_the_balls(tmp_path, means, field, falls):
    """Down to balls below the size of the field's, or where the field's are as large as they."""
    write_converge(tmp_path / "c.yaml", [(d, [mean, mean + 1.0] if mean else [0.0, 0.0])
                                         for d, mean in zip((4.0, 2.0, 1.0), means)], base={"field_d": field})
    assert size_error.falls(tmp_path / "c.yaml", "remove_m3") is falls


# --- the command ---

@pytest.fixture
def slope(tiny_case, capsys):
    """Run `slope COMMAND case/in.tiny ARGUMENTS` in the test's folder; gives status, stdout, stderr."""
    edit("case/in.tiny", "index 150", "index 300\nvariable  d index 1.0\nvariable  field_d index 1.0\n"
         "variable  xoffset index 0.0", "sc 1.0", "sc ${d} origin ${xoffset} 0 0", "diameter 1.0", "diameter ${d}",
         "balls 2 1.0", "balls 2 ${d}", "balls 3 1.0", "balls 3 ${field_d}", "timestep    0.002", "timestep    0.001")

    def run(arguments, command="sensitivity"):
        return called(capsys, [command, "case/in.tiny", *shlex.split(arguments)])
    return run


def test_sizes_that_did_not_finish_leave_no_older_fit(tmp_path, monkeypatch):
    write_converge(tmp_path / "converge.yaml", [(2.0, [79.0]), (1.0, [89.0])])
    monkeypatch.setattr(size_study.results, "rows_of", lambda *_: ([], None))
    plan = size_study.Plan(SimpleNamespace(output=tmp_path), {}, {}, "d", [])
    size_study.collect(plan, ["front_m"], None)
    assert not (tmp_path / "converge.yaml").exists()


@pytest.mark.drawn
def test_the_command_fits_what_its_runs_gave(slope, succeed):
    words = ("--converge d=1.25,0.7 --set field_d=0.9 --repeat xoffset=0.3,0.6 --of released_m3,centroid_m -o out "
             f"{ROAD}")
    out, _ = succeed(words)
    assert "it is unknown whether a line holds" in out
    # a value added later: what is finished is kept
    status, out, err = slope(words.replace("0.7", "0.7,1"))
    assert status == 0 and "6 of 9 runs are finished already" in out, err
    about = yaml.safe_load(Path("out/converge.yaml").read_text())
    runs = rows_of("out/converge_runs.csv")
    assert [(run["d"], run["field_d"], run["xoffset"]) for run in runs] == [
        (d, "0.9", offset) for d in ("1.25", "0.7", "1") for offset in ("0.0", "0.3", "0.6")]
    assert about["study"]["variable"] == "d" and about["study"]["base"]["field_d"] == "0.9"
    assert "d" not in about["study"]["base"] and about["study"]["repeat"] == {"xoffset": ["0.3", "0.6"]}
    table = rows_of("out/converge.csv")
    for name, key in (("released_m3", "released"), ("centroid_m", None)):
        values = {d: [float(run[name]) for run in runs if run["d"] == d] for d in ("1.25", "1", "0.7")}
        if key:
            told = yaml.safe_load(Path("out/field_d_0.9_d_1_xoffset_0.3/tiny.summary.yaml").read_text())
            assert values["1"][1] == told["volume"][key]
        entry = about["quantities"][name]
        fit = convergence.fit([(float(d), several) for d, several in values.items()])
        assert entry["small_balls"]["value"] == pytest.approx(fit.small.value)
        assert entry["small_balls"]["low"] == pytest.approx(fit.interval[0]) and entry["supported"] == fit.supported
        for size, (d, several) in zip(entry["sizes"], values.items()):
            assert (size["value"], size["runs"]) == (float(d), 3)
            assert size["mean"] == pytest.approx(statistics.fmean(several))
            assert size["scatter"] == pytest.approx(statistics.stdev(several))
        rows = [row for row in table if row["quantity"] == name]
        assert [row["d"] for row in rows] == ["1.25", "1.0", "0.7", "0"]
        assert float(rows[-1]["fitted"]) == entry["small_balls"]["value"]
        if fit.known:
            assert float(rows[0]["error_percent"]) == pytest.approx(100 * fit.sizes[0].error)
        else:
            assert rows[0]["error_percent"] == "" and name != "released_m3"
        assert entry["words"][0] in out
    assert Path("out/converge.png").read_bytes()[:4] == b"\x89PNG"
    # finer balls fill the body better
    assert about["quantities"]["released_m3"]["slope"]["value"] < 0
    assert about["quantities"]["released_m3"]["small_balls"]["value"] > max(
        float(run["released_m3"]) for run in runs)


def test_what_a_repeat_does_not_change_counts_once(succeed):
    deck = Path("case/in.tiny")
    deck.write_text(deck.read_text().replace("variable  xoffset", "variable  seed index 0\nvariable  xoffset"))
    _, err = succeed("--converge d=1.25,1 --set steps=100 --repeat seed=1,2 --of centroid_m -o out")
    assert "a repeated variable has no effect, to the last digit: left out (steps_100_d_1.25_seed_1; " in err
    sizes = yaml.safe_load(Path("out/converge.yaml").read_text())["quantities"]["centroid_m"]["sizes"]
    assert [size["runs"] for size in sizes] == [1, 1]


def test_a_failed_size_is_told_and_the_others_are_fitted(slope):
    status, _, err = slope("--converge d=1.25,1,30 --set steps=100 --of centroid_m -o out")
    assert status == 2 and "1 of 3 runs failed: steps_100_d_30: " in err
    assert [row["d"] for row in rows_of("out/converge.csv")] == ["1.25", "1.0", "0"]


@pytest.mark.parametrize("arguments, message", [
    ("--converge d=1", "--converge: must give two values at least, and three to see whether a line holds, got d=1"),
    ("--converge d=1,0", "--converge: d must stay within the deck's range, > 0, got d=1,0"),
    ("--converge steps=1,0", "--converge: must give numbers > 0 for steps, which tends to 0, got 0"),
    ("--converge terrain=a.asc,b.asc", "--converge: must give numbers > 0 for terrain"),
    ("--converge colour=1,2", "--converge: must name an index variable of case/in.tiny"),
    ("--converge d=1,2 --levels friction=20", "--converge: must be given without --levels"),
    ("--converge d=1,2 --set d=3", "--converge: must not name a variable of --set, got d"),
    ("--converge d=1,2 --repeat xoffset=0", "--repeat: must give a value that the first run does not have, got "
     "xoffset=0"),
    ("--converge d=1,2 --repeat friction=20,30", "--repeat: must name a variable that differs by chance alone, seed or "
     "...offset; if the values of friction are equally good, say --equally-good friction, got friction"),
    ("--converge d=1,2 --equally-good rolling", "--equally-good: must name variables of --repeat, got rolling"),
    ("--converge d=1,2 --of remove_m3 ", "--road: must be given for remove_m3"),
    ("--levels friction=20", "--road: must be given for remove_m3"),
])
def test_wrong_input_is_one_line(slope, arguments, message):
    status, _, err = slope(f"{arguments} -o out")
    assert status == 2 and err.startswith("slope sensitivity: ") and err.count("\n") == 1
    assert message in err
    assert not Path("out").exists()


def test_the_size_error_counts_in_the_conservative_volume(slope, succeed):
    write_converge("converge.yaml", [(2.0, [79.0, 80.0, 81.0]), (1.0, [89.0, 90.0, 91.0]), (0.5, [95.0, 95.2, 94.8])])
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    words = f"--set rolling=0,0.3 --set steps=700 --repeat xoffset=0.3,0.6 {ROAD} -o out --size-error converge.yaml"
    succeed(words, "study")
    best = yaml.safe_load(Path("out/study.yaml").read_text())["conservative"]
    found = SizeErrors(Path("converge.yaml"), "remove_m3").at("1.0")
    assert found.share == pytest.approx(-0.1, abs=0.01)
    assert best["size"]["error_percent"] == pytest.approx(100 * found.share) and best["size"]["value"] == "1.0"
    assert best["size"]["file"] == "../converge.yaml"       # from study.yaml, wherever the command is given
    assert best["mean_m3"] > 1 and best["chance_m3"] > 0.1
    lacking = best["mean_m3"] * (1 / (1 + found.share) - 1)
    half = best["mean_m3"] * found.half / (1 + found.share) ** 2
    assert best["size_m3"] == pytest.approx(lacking + math.hypot(best["chance_m3"], half) - best["chance_m3"])
    assert [one["kind"] for one in best["withheld"]] == ["runs not at rest or failed"]

    # an error that is not trusted does not count, and the number is withheld for it
    write_converge("converge.yaml", [(2.0, [60.0, 61.0, 62.0]), (1.0, [79.0, 80.0, 81.0]), (0.5, [90.0, 90.2, 89.8])])
    status, out, err = slope(words, "study")
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    assert status == 0 and about["conservative"]["size_m3"] is None, err
    assert about["conservative"]["withheld"][1]["kind"] == "size error"
    assert "it is -20 %, and beyond 15 %" in about["size_error_unusable"]
    assert "the size error is not trusted: it is -20 %" in out


@pytest.mark.parametrize("text, arguments, message", [
    ("a: 1", ROAD, "converge.yaml: must be a converge.yaml of `slope sensitivity --converge`"),
    (None, ROAD, "converge.yaml: must be a converge.yaml of `slope sensitivity --converge` (No such file"),
    ("quantity", ROAD, "converge.yaml: must have remove_m3, which `slope sensitivity --converge` finds with --road"),
    ("variable", ROAD, "--size-error: must be of a variable of the deck; converge.yaml is of, got size"),
    ("good", ROAD + " --set d=1,3", "--size-error: must know the error of all values of d; converge.yaml does from 0 "
     "to 2, got 3"),
    ("good", "", "--size-error: needs --road"),
    ("zero", ROAD, "converge.yaml: must have a value of remove_m3 for small d that is clearly above 0, "
     "so that errors are shares of it, got "),
    ("far", ROAD, "converge.yaml: must have an error of more than -100 % at d 1, got -100 %"),
    ("nan", ROAD, "converge.yaml: must be a converge.yaml of `slope sensitivity --converge`"),
])
def test_a_wrong_size_error_is_one_line(slope, text, arguments, message):
    good = [(2.0, [60.0, 61.0, 62.0]), (1.0, [79.0, 80.0, 81.0])]
    if text in ("good", "nan"):
        write_converge("converge.yaml", good)
    elif text == "quantity":
        write_converge("converge.yaml", good, "front_m")
    elif text == "variable":
        write_converge("converge.yaml", good, variable="size")
    elif text == "zero":
        write_converge("converge.yaml", [(2.0, [6.0, 5.0]), (1.0, [3.0, 2.5])])
    elif text == "far":
        write_converge("converge.yaml", [(1.0, [0.0, 0.0]), (0.5, [4.0, 4.1])])
    elif text:
        Path("converge.yaml").write_text(text)
    if text == "nan":
        known = Path("converge.yaml").read_text()
        Path("converge.yaml").write_text(known.replace("covariance: ", "covariance: .nan #"))
    status, _, err = slope(f"--set rolling=0 {arguments} -o out --size-error converge.yaml", "study")
    assert status == 2 and err.startswith("slope study: ") and err.count("\n") == 1
    assert message in err
    assert not Path("out").exists()
