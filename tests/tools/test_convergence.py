"""Sizes of balls: tools/slope sensitivity --converge, and tools/slope study --levels."""
import math
import shlex
import statistics
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

import made_rows
from run_helpers import called
from tiny_collapse import edit, rows_of

from slope_tools.fitting import fit
from slope_tools.statistics import convergence
from slope_tools.studies import body_depth, outcome, size_study
from slope_tools.studies.setup import Setup

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
ROAD = "--road case/road.csv --local"


# --- the comparison ---

def compared(*sizes, balls=16.0):
    """Of (d, values); balls: over the thickness, of d 1."""
    return convergence.compare([(d, list(values)) for d, values in sizes], [balls / d for d, _ in sizes])


def test_halvings_and_their_chance_by_hand():
    found = compared((4.0, (8.0, 12.0)), (1.0, (19.0, 21.0)), (2.0, (17.0,)))
    assert [(size.d, size.runs, size.balls) for size in found.sizes] == [(4, 2, 4), (2, 1, 8), (1, 2, 16)]
    first, second = found.halvings
    assert (first.coarse.d, first.fine.d, first.difference) == (4, 2, 7)
    # s of both runs at d 4 alone: sqrt(8), one degree of freedom, t 12.706
    assert first.chance == pytest.approx(12.7062 * math.sqrt(8 * (1 / 2 + 1)), rel=1e-5) and first.within_chance
    assert second.chance == pytest.approx(12.7062 * math.sqrt(2 * (1 + 1 / 2)), rel=1e-5)


def test_sizes_that_are_no_halves_are_passed_over():
    found = compared((2.0, (1.0,)), (1.45, (1.0,)), (1.0, (1.0,)), (0.7, (1.0,)), (0.5, (1.0,)))
    assert [(one.coarse.d, one.fine.d) for one in found.halvings] == [(2, 1), (1, 0.5)]
    assert all(one.chance is None and not one.within_chance for one in found.halvings)


SAME, MORE = (10.0, 11.0, 10.5), (13.0, 14.0, 13.5)


@pytest.mark.parametrize("values, balls, resolved", [
    ((SAME, SAME, SAME), 32.0, True),           # 8, 16, 32 balls
    ((SAME, SAME, SAME), 31.0, False),          # from fewer than 8
    ((SAME, SAME), 32.0, False),                # one halving
    ((MORE, SAME, SAME, SAME), 64.0, True),     # the last two count
    ((SAME, SAME, SAME, MORE), 64.0, False),    # a plateau is no convergence
    (((1000.0, 1400.0), (1300.0, 1900.0), (2000.0, 2600.0)), 32.0, False),      # 1.9 times as much, chance explains it
    (((10.0,), (10.0,), (10.0,)), 32.0, False)])        # chance is not known
def test_resolved_takes_two_halvings_from_eight_balls(values, balls, resolved):
    found = compared(*((2.0 ** (len(values) - 1 - k), one) for k, one in enumerate(values)), balls=balls)
    assert found.resolved is resolved
    words = convergence.describe_convergence(found, "d", "to remove", "m3", "{:g}".format)
    assert words[-1].startswith("to remove: resolved" if resolved else "to remove: not resolved")


def test_nothing_is_said_of_the_slide_that_looked_converged():
    """Beyond 10 m at d 4 to 1: 17.3, 8.4, 6.7 %, and 9.9 at d 0.5, 16 balls thick (three runs each, s 0.4)."""
    runs = [(d, [mean - 0.4, mean, mean + 0.4]) for d, mean in ((4.0, 17.3), (2.0, 8.4), (1.0, 6.7), (0.5, 9.9))]
    assert not convergence.compare(runs[:3], [2.0, 4.0, 8.0]).resolved
    assert not convergence.compare(runs, [2.0, 4.0, 8.0, 16.0]).resolved


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


def test_sizes_that_did_not_finish_leave_no_older_comparison(tmp_path, monkeypatch):
    (tmp_path / "converge.yaml").write_text("of runs before")
    monkeypatch.setattr(size_study, "read_run_rows", lambda *_: [])
    plan = size_study.Plan(SimpleNamespace(output=tmp_path), {}, {}, "d", [])
    size_study.collect_sizes(plan, ["front_m"], None)
    assert not (tmp_path / "converge.yaml").exists()


@pytest.mark.drawn
def test_the_command_compares_what_its_runs_gave(slope, succeed):
    words = ("--converge d=1.4,0.7 --set field_d=0.9 --repeat xoffset=0.3,0.6 --of released_m3,centroid_m -o out "
             f"{ROAD}")
    out, _ = succeed(words)
    assert "centroid: not resolved" in out
    # a value added later: what is finished is kept
    status, out, err = slope(words.replace("0.7", "0.7,1"))
    assert status == 0 and "6 of 9 runs are finished already" in out, err
    about = yaml.safe_load(Path("out/converge.yaml").read_text())
    runs = rows_of("out/converge_runs.csv")
    assert [(run["d"], run["field_d"], run["xoffset"]) for run in runs] == [
        (d, "0.9", offset) for d in ("1.4", "0.7", "1") for offset in ("0.0", "0.3", "0.6")]
    assert about["study"]["variable"] == "d" and about["study"]["base"]["field_d"] == "0.9"
    assert "d" not in about["study"]["base"] and about["study"]["repeat"] == {"xoffset": ["0.3", "0.6"]}
    table = rows_of("out/converge.csv")
    for name in ("released_m3", "centroid_m"):
        values = {d: [float(run[name]) for run in runs if run["d"] == d] for d in ("1.4", "1", "0.7")}
        entry = about["quantities"][name]
        for size, (d, several) in zip(entry["sizes"], values.items()):
            assert (size["value"], size["runs"]) == (float(d), 3)
            assert size["mean"] == pytest.approx(statistics.fmean(several))
            assert size["scatter"] == pytest.approx(statistics.stdev(several))
            assert size["balls_thick"] * float(d) == pytest.approx(entry["sizes"][0]["balls_thick"] * 1.4, rel=0.5)
        [halving] = entry["halvings"]
        assert (halving["from"], halving["to"]) == (1.4, 0.7) and not entry["resolved"]
        rows = [row for row in table if row["quantity"] == name]
        assert [row["d"] for row in rows] == ["1.4", "1.0", "0.7"]
        assert float(rows[-1]["difference"]) == pytest.approx(halving["difference"])
        assert entry["words"][0] in out
    assert Path("out/converge.png").read_bytes()[:4] == b"\x89PNG"


def test_what_a_repeat_does_not_change_counts_once(succeed):
    deck = Path("case/in.tiny")
    deck.write_text(deck.read_text().replace("variable  xoffset", "variable  seed index 0\nvariable  xoffset"))
    _, err = succeed("--converge d=1.25,1 --set steps=100 --repeat seed=1,2 --of centroid_m -o out")
    assert "a repeated variable has no effect, to the last digit: left out (steps_100_d_1.25_seed_1; " in err
    sizes = yaml.safe_load(Path("out/converge.yaml").read_text())["quantities"]["centroid_m"]["sizes"]
    assert [size["runs"] for size in sizes] == [1, 1]


def test_a_failed_size_is_told_and_the_others_are_compared(slope):
    status, _, err = slope("--converge d=1.25,1,30 --set steps=100 --of centroid_m -o out")
    assert status == 2 and "1 of 3 runs failed: steps_100_d_30: " in err
    assert [row["d"] for row in rows_of("out/converge.csv")] == ["1.25", "1.0"]


@pytest.mark.parametrize("arguments, message", [
    ("--converge d=1", "--converge: must give two values at least"),
    ("--converge steps=1,0", "--converge: must give numbers > 0 for steps, got 0"),
    ("--converge terrain=a.asc,b.asc", "--converge: must give numbers > 0 for terrain"),
    ("--converge colour=1,2", "--converge: must name an index variable of case/in.tiny"),
    ("--converge d=1,2 --try friction=20", "--converge: must be given without --try"),
    ("--converge d=1,2 --set d=3", "--converge: must not name a variable of --set, got d"),
    ("--converge d=1,2 --repeat friction=20,30", "--repeat: must name a variable that differs by chance alone, seed, "
     "packing or ...offset; if the values of friction are equally good, say --equally-good friction, got friction"),
    ("--converge d=1,2 --of remove_m3 ", "--road: must be given for remove_m3"),
    ("--try friction=20", "--road: must be given for remove_m3"),
])
def test_wrong_input_is_one_line(slope, arguments, message):
    status, _, err = slope(f"{arguments} -o out")
    assert status == 2 and err.startswith("slope sensitivity: ") and err.count("\n") == 1
    assert message in err
    assert not Path("out").exists()


# --- several sizes of a study ---

def test_a_study_of_a_deck_at_several_sizes(slope, succeed):
    """All points with the first diameter, some with the others; results are of the last one."""
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    words = f"--set rolling=0,0.15,0.3 --set steps=700 {ROAD} -o out"
    succeed(words, "study")
    before = yaml.safe_load(Path("out/study.yaml").read_text())
    assert before["size"] is None and "bands" not in before["runs"][0]
    succeed(f"{words} --levels d=1.0,0.6,0.4", "study")
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    size = about["size"]
    assert [(one["d"], one["runs"]) for one in size["sizes"]] == [(1.0, 3), (0.6, 3), (0.4, 3)]
    assert size["sizes"][2]["balls_thick"] == pytest.approx(2.5 * size["sizes"][0]["balls_thick"])
    assert [row["variables"]["d"] for row in about["runs"]] == ["0.4"] * 3
    assert [row["set"] for row in about["runs"]] == [row["set"] for row in before["runs"]]
    raw = {row["run"]: row for row in rows_of("out/levels.csv")}
    assert len(raw) == 9 and {row["d"] for row in raw.values()} == {"1.0", "0.6", "0.4"}
    for row in about["runs"]:       # which ran with the finest balls
        assert row["remove_m3"] == pytest.approx(float(raw[row["run"]]["remove_m3"])) and row["bands"]["remove_m3"] == [
            row["remove_m3"]] * 2
    # runs are kept when sizes change, those of one size among them
    out, _ = succeed(f"{words} --levels d=1.0,0.6", "study")
    assert "to make" not in out or "0 of these runs to make" in out
    assert len(yaml.safe_load(Path("out/study.yaml").read_text())["size"]["sizes"]) == 2
    succeed(words, "study")
    assert not Path("out/levels.csv").exists()


@pytest.mark.parametrize("words, line", [
    ("--levels d=1,0.9", "--levels: must give diameters > 0, each at most 1/1.5 of the one before"),
    ("--levels 3", "--levels: must give diameters for a deck, such as d=5,2.5,1.25, got 3"),
    ("--levels rolling=3,1", "--levels: must name d, the variable of the deck that is the diameter of the balls"),
    ("--levels d=2,1 --set d=1", "--levels: must not name a variable that --set, --vary or --repeat names, got d"),
    ("--fine 2", "--fine: must not be given any more: --levels says")])
def test_sizes_that_are_none(slope, words, line):
    status, _, err = slope(f"--set rolling=0 {ROAD} -o out {words}", "study")
    assert status == 2 and err.startswith(f"slope study: {line}") and err.count("\n") == 1
    assert not Path("out").exists()


# --- the thickness in balls ---

def test_the_thickness_of_a_site_is_that_of_the_command(here):
    """Not that of the cells with balls, which the thin rim lacks; of a body of several that of this one."""
    Path("mine").mkdir()
    found = {"body": {"volume": 900.0, "mean_depth": 3.0}, "bodies": {}}
    Path("mine/site.yaml").write_text(yaml.safe_dump({"slope_site": 1, "found": found}))
    setup = Setup(Path("mine/in.site"), Path("mine/study"))
    rows = [made_rows.row(variables={"d": "2", "body": "1"}), made_rows.row(variables={"d": "1", "body": "2"})]
    assert body_depth.mean(setup, rows[0]) == 3.0 and body_depth.in_balls(setup, rows) == 1.5
    found["bodies"] = {rank: {"volume_m3": 900.0, "mean_depth_m": depth} for rank, depth in ((1, 4.0), (2, 5.0))}
    Path("mine/site.yaml").write_text(yaml.safe_dump({"slope_site": 1, "found": found}))
    assert [body_depth.mean(setup, row) for row in rows] == [4.0, 5.0]
    assert body_depth.in_balls(setup, [made_rows.row(variables={"q": "2"})]) is None
    assert body_depth.in_balls(setup, []) is None


def test_calibrated_values_belong_to_the_thickness_in_balls(succeed):
    """calibrate keeps it, and a study with another one says so in a line."""
    words = "--vary friction=20:40 --front 25 --runs 5 --set steps=200"
    succeed(f"{words} --jobs 2 -o fit", "calibrate")
    about = yaml.safe_load(Path("fit/calibrate.yaml").read_text())
    mine = about["calibration"]["balls_thick"]
    assert mine > 1
    for factor, warned in ((1.0, False), (1.6, True), (1 / 1.6, True)):
        about["calibration"]["balls_thick"] = factor * mine
        Path("fit/calibrate.yaml").write_text(yaml.safe_dump(about))
        succeed("--from fit --sample 2 --set steps=200 --exceed 0.1 --jobs 2 -o out", "study")
        found = yaml.safe_load(Path("out/study.yaml").read_text())
        assert found["study"]["balls_thick"] == pytest.approx(mine, rel=0.05)
        assert [one["kind"] for one in found["warnings"]].count("other thickness") == warned


@pytest.mark.parametrize("asked, others", [
    ("--set rolling=0.10", {"--set rolling=0.1": None, "--set rolling=0.3": ("rolling 0.10", "rolling 0.3"),
                            "": ("rolling 0.10", "rolling 0.0")}),
    ("", {"": None, "--set rolling=0.3": ("rolling 0.0", "rolling 0.3")})])
def test_calibrated_values_belong_to_what_was_set_beside_them(succeed, asked, others):
    """Or what the deck had; not to the size of the balls, nor to chance or how long a run takes."""
    succeed(f"--vary friction=20:40 --front 25 --runs 5 --set steps=200 {asked} --jobs 2 -o fit", "calibrate")
    for given, said in others.items():
        succeed(f"--from fit --sample 2 --set steps=200 {given} --exceed 0.1 --jobs 2 -o out", "study")
        found = yaml.safe_load(Path("out/study.yaml").read_text())["warnings"]
        assert [(one["numbers"]["found"], one["numbers"]["here"]) for one in found
                if one["kind"] == "other settings"] == ([said] if said else [])
    beside = {"d": "1", "duration": "60", "step": "2", "packing": "3", "not in the deck": "5", "friction": "30"}
    here = {"d": "2", "duration": "90", "step": "1", "packing": "1", "friction": "30.0"}
    assert outcome.other_settings(beside, here) is None


def test_a_forecast_says_that_the_observation_was_missed(succeed):
    """And what else was doubtful of the calibration; with a front that no run comes near."""
    words = "--vary friction=20:40 --runs 5 --set steps=200 --jobs 2"
    front = 2500.0
    for missed in (True, False):
        succeed(f"{words} --front {front} -o fit{front}", "calibrate")
        about = yaml.safe_load(Path(f"fit{front}/calibrate.yaml").read_text())
        assert (about["misfit"] > 1) == missed
        succeed(f"--from fit{front} --sample 2 --set steps=200 --exceed 0.1 --jobs 2 -o out{front}", "study")
        found = [one for one in yaml.safe_load(Path(f"out{front}/study.yaml").read_text())["warnings"]
                 if one.get("part") == "calibration"]
        assert [one["kind"] for one in found] == ["observation missed"] * missed + [
            one["kind"] for one in about["doubts"]]
        lengths = [float(row["length along the fall path (m)"]) for row in rows_of(f"fit{front}/calibrate.csv")]
        front = statistics.median(lengths)
        assert not missed or f"the closest are {about['misfit'] ** 0.5:.1f} times as far" in found[0]["text"]


def test_calibrated_values_belong_to_the_friction_of_the_slip_surface():
    """As calibrate keeps it, of a deck that has it; with more a forecast goes less far."""
    row = made_rows.row(variables={"friction": "30", "slip": "0", "d": "2"})
    kept = fit.Fit.model(SimpleNamespace(finished=[row], variables=[SimpleNamespace(name="friction")]))
    doubt = outcome.other_settings(kept, {**row.variables, "slip": "20"})
    assert doubt and doubt.numbers == {"found": "slip 0", "here": "slip 20"}
