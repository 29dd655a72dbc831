"""tools/slope study --repeat: which runs are made, the headline over them, what is called a trend, rest and travel."""
import statistics
from pathlib import Path

import pytest

from made_rows import changed, row
from messages import is_one
from tiny_collapse import edit, loaded, rows_of

from slope_tools import records
from slope_tools import schemas
from slope_tools.case import run_folders
from slope_tools.deposits import rest, travel_shares
from slope_tools.errors import SlopeError
from slope_tools.findings import Finding
from slope_tools.runs import repeats
from slope_tools.statistics import conservative_volume
from slope_tools.tables import combinations, quantities, study_file, study_table

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
COMMAND = "study case/in.tiny"
ROAD = "--road case/road.csv --local"


@pytest.fixture
def here(tiny_case):
    edit("case/in.tiny", "index 150", "index 150\nvariable  xoffset index 0.0\nvariable  seed index 0\n"
         "variable  unused index 1", "sc 1.0", "sc 1.0 origin ${xoffset} 0 0", "overlap 0.0",
         'overlap 0.0\nif "${seed} > 0" then "displace_atoms soil random 1e-6 1e-6 1e-6 ${seed} units box"')
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    return tiny_case


def test_repeats_are_made_for_each_combination_and_the_headline_is_theirs(slope):
    words = f"--set rolling=0,0.3 --set steps=700 --repeat xoffset=0.0,0.3 {ROAD} -o out"
    assert slope(words)[0] == 0
    # one more repeat: what is finished is kept
    status, out, err = slope(words + " --repeat seed=7")
    assert status == 0 and "4 of 6 runs are finished already" in out, err
    about, table = loaded()
    assert [row["run"] for row in table] == [f"rolling_{rolling}_steps_700{more}" for rolling in ("0", "0.3")
                                             for more in ("", "_xoffset_0.3", "_seed_7")]
    assert [(row["rolling"], row["xoffset"], row["seed"]) for row in table[3:]] == [
        ("0.3", "0.0", "0"), ("0.3", "0.3", "0"), ("0.3", "0.0", "7")]
    assert [row["repeat"] for row in about["runs"][:3]] == [{}, {"xoffset": "0.3"}, {"seed": "7"}]
    assert all(row["set"] == {"rolling": "0", "steps": "700"} for row in about["runs"][:3])
    assert about["study"]["repeat"] == {"xoffset": ["0.0", "0.3"], "seed": ["7"]}

    volumes = [[float(row["remove_m3"]) for row in table if row["rolling"] == rolling] for rolling in ("0", "0.3")]
    means = [statistics.fmean(several) for several in volumes]
    best, larger = study_file.load_study(Path("out/study.yaml")).conservative, means.index(max(means))
    assert min(means) > 1 and best.kind == "prediction"
    assert best.mean_m3 == pytest.approx(max(means)) and best.set["rolling"] == ("0", "0.3")[larger]
    assert max(means) <= 2 * min(means)     # the scatter is that of both, in proportion to the root of the mean
    deviation = (sum(max(means) / mean * statistics.variance(each) for mean, each in zip(means, volumes)) / 2) ** 0.5
    assert best.starts_m3 == [min(volumes[larger]), max(volumes[larger])]
    assert best.scatter_m3 == pytest.approx(deviation) and 2 <= best.degrees_of_freedom <= 4
    assert best.chance_m3 == pytest.approx(best.quantile * deviation * (4 / 3) ** 0.5)
    assert best.repeats == 3
    assert best.remove_m3 == max(volumes[larger])
    assert [row["run"] for row in table if float(row["remove_m3"]) == best.remove_m3] == [best.run]
    # the runs are cut short: the number is withheld
    assert best.volume_m3 is None and best.rounded["volume_m3"] is None
    assert [one.kind for one in best.withheld] == ["runs not at rest or failed"]
    assert "not usable as a number to design with:\n  6 of 6 runs failed or are not at rest" in out
    assert "conservative volume to remove" not in out

    assert [entry["combination"] for entry in about["combinations"]] == ["rolling_0_steps_700", "rolling_0.3_steps_700"]
    cells = rows_of("out/combinations.csv")
    for entry, line, several, mean in zip(about["combinations"], cells, volumes, means):
        assert entry["repeats"] == 3 and entry["remove_m3"]["mean"] == pytest.approx(mean)
        assert entry["remove_m3"]["scatter"] == pytest.approx(statistics.stdev(several))
        assert float(line["remove_m3_mean"]) == entry["remove_m3"]["mean"]
        assert float(line["remove_m3_scatter"]) == entry["remove_m3"]["scatter"]
    assert records.encode_record(best) == about["conservative"]


def test_what_a_repeat_does_not_change_counts_once(succeed):
    """A variable that the deck does not use: the runs are one, and chance is not known."""
    succeed(f"--set rolling=0,0.3 --repeat unused=2,3 --equally-good unused {ROAD} -o out")
    best = study_file.load_study(Path("out/study.yaml")).conservative
    assert best.kind == "largest of 2 runs; chance unknown" and best.repeats == 1
    same, = (one for one in best.doubts if one.kind == "no effect")
    assert same.runs[0] == "rolling_0_unused_2"


def test_a_value_that_changes_nothing_is_said(succeed):
    """As another ground under a mass that does not touch it; a rolling resistance that does is not named."""
    succeed(f"--set rolling=0,0.3 --set unused=1,2 {ROAD} -o out")
    found, = (one for one in loaded()[0]["conservative"]["doubts"] if one["kind"] == "no effect")
    assert found["text"].startswith("unused has no effect in 4 runs, to the last digit: they do not test it")
    assert set(found["runs"]) == {f"rolling_{one}_unused_{other}" for one in ("0", "0.3") for other in (1, 2)}


def test_a_failed_repeat_leaves_the_others(slope):
    deck = Path("case/in.tiny")
    deck.write_text(deck.read_text().replace("group       soil", 'if "${seed} == 2" then "nonsense"\ngroup       soil'))
    status, _, err = slope(f"--set rolling=0,0.3 --repeat seed=1,2,3 {ROAD} -o out")
    assert status == 2 and "2 of 8 runs failed: rolling_0_seed_2" in err
    about, _ = loaded()
    assert [entry["repeats"] for entry in about["combinations"]] == [3, 3]
    one, = (one for one in about["warnings"] if one["kind"] == "failed")
    assert len(one["runs"]) == 2 and one["numbers"]["of"] == 8
    # seeds alone were repeated, although the deck has a lattice to move
    assert {"repeated": "seed", "offsets": "xoffset"} in [one["numbers"] for one in about["conservative"]["doubts"]]


def test_without_a_road_there_are_means_and_no_headline(succeed):
    out, _ = succeed("--set rolling=0 --repeat xoffset=0.3 -o out")
    about, _ = loaded()
    assert about["conservative"] is None and about["combinations"][0]["centroid_m"]["scatter"] > 0
    assert "remove_m3" not in about["combinations"][0] and "mean and scatter" in out


@pytest.mark.parametrize("arguments, message", [
    ("--set rolling=0 --repeat friction=20,30", "--repeat: must name a variable that differs by chance alone, seed or "
     "...offset; if the values of friction are equally good, say --equally-good friction, got friction"),
    ("--set rolling=0 --repeat colour=1", "--repeat: must name an index variable of case/in.tiny"),
    ("--set rolling=0 --equally-good friction", "--equally-good: must name variables of --repeat, got friction"),
    ("--set seed=1,2 --repeat seed=3", "--repeat: must not name a variable of several values of --set, got seed"),
    ("--set rolling=0 --repeat seed=0 --repeat xoffset=0", "--repeat: must give a value that the first run does not "
     "have, got seed=0, xoffset=0"),
    ("--set seed=5 --repeat seed=5.0", "--repeat: must give a value that the first run does not have, got seed=5.0"),
    ("--set rolling=0:1:0.001 --repeat seed=1:10:1", "--set: must make at most 10000 runs, got 11011"),
])
def test_wrong_repeats_are_one_line(slope, arguments, message):
    status, out, err = slope(f"{arguments} -o out")
    assert (status, out) == (2, "") and is_one(err, f"slope study: {message}"), err
    assert not Path("out").exists()


def test_the_first_run_may_have_a_value_of_set():
    todo = repeats.plan_repeats("out", {"seed": ["5"], "rolling": ["0", "1"]}, {"seed": ["5", "6"]}, {"seed": "0"})
    assert [one.name for one in todo] == [f"seed_{seed}_rolling_{rolling}" for rolling in "01" for seed in "56"]
    assert [one.key for one in todo] == ["base", "seed 6"] * 2
    assert [one.combination["rolling"] for one in todo] == ["0", "0", "1", "1"]


def test_combinations_beside_the_product_are_one_run_each():
    others = [{"rolling": "0", "spacing": "0.5"}]
    todo = repeats.plan_repeats("out", {"rolling": ["0", "1"], "spacing": ["0.9"]}, {"seed": ["6"]}, {"seed": "0"},
                                others)
    assert [one.name for one in todo] == ["rolling_0_spacing_0.9", "rolling_0_spacing_0.9_seed_6",
                                          "rolling_1_spacing_0.9", "rolling_1_spacing_0.9_seed_6",
                                          "rolling_0_spacing_0.5"]
    assert todo[-1].varied == "rolling 0, spacing 0.5" and todo[0].varied == "rolling 0, spacing 0.9"
    with pytest.raises(SlopeError, match="at most 10000 runs, got 10001"):
        repeats.plan_repeats("out", {"rolling": [str(k) for k in range(10000)], "spacing": ["0.9"]}, {}, {}, others)


# --- the conservative volume ---

def rows(*several, names=("rolling",), rest=True):
    """Rows of finished runs: (values of the variables, volumes of the repeats)."""
    found = []
    for chosen, volumes in several:
        for i, volume in enumerate(volumes):
            found.append(row(run=f"{'_'.join(chosen)}_{i}", set=dict(zip(names, chosen)), at_rest=rest,
                             repeat={"seed": str(i)} if i else {}, remove_m3=volume, centroid_m=5 + volume / 7))
    return found


def conservative(settings, several):
    return combinations.conservative(settings, several, combinations.grouped(several))


SMALL = (("0",), (100.0, 110, 90)), (("1",), (104.0, 114, 94))
LARGE = (("0",), (10.0, 12, 11)), (("1",), (90.0, 92, 91))


def test_a_difference_below_chance_is_no_trend_and_no_doubt():
    best = conservative({"rolling": ["0", "1"]}, rows(*SMALL))
    [entry] = best.differences
    assert (entry.largest_at, entry.smallest_at, entry.clear) == ("1", "0", False) and entry.by_m3 == 4
    assert best.doubts == []
    assert any("no more than expected by chance" in line for line in combinations.describe_combinations(best))


def test_a_difference_larger_than_chance_at_the_end_of_a_range_is_a_doubt():
    best = conservative({"rolling": ["0", "1"]}, rows(*LARGE))
    assert best.differences[0].clear is True
    assert best.doubts == [Finding("end of range", {"variable": "rolling", "low": 0.0, "high": 1.0})]
    # a value of 0, which cannot be less, is no end; neither is one in the middle, or a name
    assert conservative({"rolling": ["0", "1"]}, rows((("0",), (90.0, 92)), (("1",), (10.0, 12)))).doubts == []
    middle = rows((("1",), (10.0, 12)), (("2",), (90.0, 92)), (("3",), (10.1, 12)))
    assert conservative({"rolling": ["1", "2", "3"]}, middle).doubts == []
    assert conservative({"rolling": ["a", "b"]}, rows((("a",), (10.0, 12)), (("b",), (90.0, 92)))).doubts == []


def test_differences_are_those_of_the_governing_line():
    several = rows((("0", "20"), (10.0, 11)), (("1", "20"), (50.0, 51)), (("0", "30"), (70.0, 71)),
                   (("1", "30"), (90.0, 91)), names=("rolling", "friction"))
    best = conservative({"rolling": ["0", "1"], "friction": ["20", "30"]}, several)
    assert [(entry.variable, entry.by_m3) for entry in best.differences] == [("rolling", 20), ("friction", 40)]
    assert best.label == "rolling 1, friction 30"


def test_which_ground_governs():
    """One run each on other grounds: the largest over both, with the chance of a single run."""
    settings = {"rolling": ["0", "1"], "spacing": ["0.9", "0.5"]}
    several = [changed(one, stop_angle_deg=15.5 if one.set["spacing"] == "0.5" else 24.5) for one in rows(
        (("0", "0.9"), (70.0, 71, 72)), (("1", "0.9"), (80.0, 82, 81)), (("0", "0.5"), (95.0,)),
        (("1", "0.5"), (40.0,)), names=("rolling", "spacing"))]
    best = conservative(settings, several)
    assert best.ground == "the ground that governs: spacing 0.5, stop angle 15.5 degrees (tried: spacing 0.9, 0.5)"
    assert best.ground in combinations.describe_combinations(best)
    assert (best.mean_m3, best.repeats, best.label) == (95, 1, "rolling 0, spacing 0.5")
    assert best.chance_m3 == pytest.approx(best.quantile * best.scatter_m3 * 2 ** 0.5)
    assert [(entry.variable, entry.by_m3) for entry in best.differences] == [("rolling", 55), ("spacing", 24)]
    entry = combinations.list_combination_entries(combinations.grouped(several), ["remove_m3"])[0]
    assert entry["stop_angle_deg"] == 24.5
    several[6] = changed(several[6], remove_m3=60.0)
    best = conservative(settings, several)
    assert best.ground.startswith("the ground that governs: spacing 0.9, stop angle 24.5")
    several = [changed(one, stop_angle_deg=None) for one in several]
    assert conservative(settings, several).ground == "the ground that governs: spacing 0.9 (tried: spacing 0.9, 0.5)"
    assert conservative({"rolling": ["0", "1"]}, rows(*SMALL)).ground is None


def test_other_doubts():
    alone = rows((("0",), (5.0,)))
    assert conservative({"rolling": ["0"]}, alone).doubts == [Finding("single run")]
    above = rows((("0",), [100.0] * 7 + [101.0] * 7 + [120.0]), (("1",), [100.0 + i / 100 for i in range(30)]))
    above = [changed(one, front_m=i) for i, one in enumerate(above)]        # no two are the same run
    assert Finding("more in a run", {"run": "0_14", "volume": 120.0}) in conservative(
        {"rolling": ["0", "1"]}, above).doubts
    loud = rows((("1",), (90.0, 120, 150)), (("0",), (100.0, 101, 102)))
    assert Finding("scatters more", {"mine": 30.0, "others": 1.1}) in conservative(
        {"rolling": ["1", "0"]}, loud).doubts


def test_more_than_is_released_is_doubted():
    several = rows((("0",), (700.0, 900, 800)), (("1",), (710.0, 890, 805)))
    found = conservative({"rolling": ["0", "1"]}, several)
    assert found.volume_m3 > 1000
    assert Finding("more than released", {"released": 1000.0}) in found.doubts
    several = [changed(one, released_m3=2000.0) for one in several]
    assert conservative({"rolling": ["0", "1"]}, several).doubts == []


def two_outcomes(found):
    """Of these doubts: how many of how many runs have hardly any, and in how many of them the slope stood."""
    return [tuple(one.numbers[name] for name in ("few", "runs", "stood")) for one in found.doubts
            if one.kind in ("two outcomes", "hardly reaches")]


def test_runs_of_another_outcome_are_doubted():
    """One of three stands: its 0 m3 are no chance of a volume."""
    found = conservative({"rolling": ["0", "1"]}, rows((("0",), (500.0, 0, 520)), (("1",), (400.0, 420, 410))))
    assert two_outcomes(found) == [(1, 3, 1)]
    several = rows((("0",), (500.0, 0, 520)), (("1",), (400.0, 420, 410)))
    several[1] = changed(several[1], centroid_m=40.0)
    assert two_outcomes(conservative({"rolling": ["0", "1"]}, several)) == [(1, 3, 0)]
    none = conservative({"rolling": ["0", "1"]}, rows((("0",), (0.0, 0, 0)), (("1",), (400.0, 420, 410))))
    assert not two_outcomes(none)


@pytest.mark.parametrize("value, scatter, expected", [
    (14757.3, None, "14,800"),                              # a run alone: three digits
    (14757.3, conservative_volume.Scatter(351.0, 4), "14,760"), (0.0, conservative_volume.Scatter(0.0, 4), "0"),
    (48859.2179, conservative_volume.Scatter(0.0, 4), "48,859"),       # repeats agree
    (1.25, conservative_volume.Scatter(0.0, 4), "1.25"),
])
def test_volumes_are_shown_to_what_is_known(value, scatter, expected):
    assert study_table.round_volume(value, scatter) == expected


# --- rest and travel ---

def summary(reason="halted", moving=False, **motion):
    return {"stop": {"reason": reason, "step": 5, "time": 9.0}, "moving": moving,
            "motion": {**{"moving_share": 0.02, "threshold": 0.1}, **motion}, "travel": {}}


def fast(share, volume=940.0, speed=30.0):
    return {"fast_share": share, "fast_volume": volume, "fast_speed": speed}


@pytest.mark.parametrize("about, at_rest, text", [
    (summary(**fast(0.0)), True, "at rest"),
    (summary(**fast(0.0099)), True, "at rest"),
    (summary(**fast(0.01)), False, "ended by its rest criterion; 1 % of the volume (940 m3) is faster than 0.1 m/s, up "
     "to 30 m/s"),
    (summary(rest_share=0.03, **fast(0.0299)), True, "at rest"),
    (summary(rest_share=0.03, **fast(0.03)), False, "ended by its rest criterion; 3 % of the volume"),
    (summary(rest_share=0.001, **fast(0.002)), False, "ended by its rest criterion; 0.2 % of the volume"),
    (summary("run completed", **fast(0.0)), False, "stopped at its duration; 0 % of the volume (940 m3)"),
    (summary("run completed", **fast(0.042)), False, "stopped at its duration; 4.2 % of the volume (940 m3) is faster"),
    (summary("running", **fast(0.3)), False, "was written in the run (running); 30 % of the volume"),
    # older summaries have no more than the share that is faster than a threshold of the deck's
    (summary(moving_share=0.009), True, "at rest"),
    (summary(), False, "ended by its rest criterion; 2 % of the volume is faster than 0.1 m/s"),
    (summary(moving_share=0.0, threshold=0.5), False, "ended by its rest criterion; 0 % of the volume is faster than "
     "0.5 m/s"),
    (summary("time limit", **fast(0.0)), False, "cut by a limit of computing time; 0 %"),
    (summary("run completed"), False, "stopped at its duration; 2 % of the volume is faster than 0.1 m/s"),
    (summary(moving=True), False, "ended by its rest criterion; 2 % of the volume is faster than 0.1 m/s"),
])
def test_at_rest_is_what_ended_by_its_criterion_and_does_not_move(about, at_rest, text):
    found = rest.state(about)
    assert found.at_rest is at_rest and found.text.startswith(text)


def test_a_run_that_is_cut_is_not_at_rest_and_the_study_says_so(slope):
    """After two steps nothing is fast yet: the end at the duration counts alone."""
    status, _, err = slope(f"--set rolling=0,0.3 --set steps=2 {ROAD} -o out")
    assert status == 0
    about, table = loaded()
    assert [(row["at_rest"], row["moving"]) for row in table] == [("no", "no")] * 2
    assert table[0]["end"].startswith("stopped at its duration; 0 % of the volume")
    assert "not at rest at the end, 2 of them stopped at their duration: stopped at its duration; " in err
    assert [len(one["runs"]) for one in about["warnings"] if one["kind"] == "moving"] == [2]


@pytest.mark.parametrize("step, at_rest, end", [
    (2, "yes", "at rest"), (50, "no", "ended by its rest criterion; 99.4 %")])
def test_a_run_that_its_deck_halts_is_at_rest_unless_it_moves(slope, step, at_rest, end):
    deck = Path("case/in.tiny")
    halt = f"variable s equal step\nfix rest soil halt 2 v_s >= {step} error continue\n"
    deck.write_text(deck.read_text().replace("run         ", f"{halt}run         "))
    assert slope("--set rolling=0 -o out")[0] == 0
    [row] = loaded()[1]
    assert (row["stop_reason"], row["at_rest"]) == ("halted", at_rest) and row["end"].startswith(end)
    assert float(row["stop_time_s"]) == pytest.approx(0.002 * step)


def test_shares_of_travel_come_from_the_summary():
    about = summary()
    assert travel_shares.read_share_columns(about) == dict.fromkeys(travel_shares.COLUMNS)
    about["travel"]["quantiles"] = [{"share": share, "distance": 100 * share, "reach_angle": 30 - share}
                                    for share in (0.5, 0.9, 0.95, 0.99, 0.999)]
    found = travel_shares.read_share_columns(about)
    assert [found[f"distance_{share}_m"] for share in (50, 90, 95, 99)] == pytest.approx([50, 90, 95, 99])
    assert found["reach_99_deg"] == pytest.approx(29.01)


TRAVEL = {"front": 1.0, "front_at_release": 1.0, "centroid": 1.0, "reach_angle": 30.0}


@pytest.mark.parametrize("section, value, rule", [
    ("travel", {**TRAVEL, "quantiles": 5}, "quantiles: must be a list in brackets or null, such as .5., got 5"),
    ("travel", {**TRAVEL, "quantiles": [5]}, "quantiles: first value: must be a section with keys, got 5"),
    ("travel", {**TRAVEL, "quantiles": [{"share": 0.5}]}, "must have distance and reach_angle"),
    ("travel", {**TRAVEL, "quantiles": [{"share": 0.5, "distance": float("nan"), "reach_angle": 1}]},
     "quantiles: first value: distance: must be a finite number or null, got nan"),
    ("motion", {"moving_share": 0.0, "threshold": 0.1, "fast_share": 0.1}, "must be valid: 'fast_volume' is a dep"),
    ("motion", {"moving_share": 0.0, "threshold": 0.1, **fast(0.0), "rest_share": "x"},
     "rest_share: must be a finite number, got"),
    ("motion", {"moving_share": 0.0, "threshold": 0.1, **fast(None)}, "fast_share: must be a finite number, got"),
    ("moving", 1, "must be true or false, got 1"), ("dt", 0, "must be > 0, got 0"),
    ("volume", {"released": 1.0}, "must have on_grid and off_grid and lost and residual")])
def test_wrong_values_of_a_summary_are_one_line(section, value, rule):
    with pytest.raises(SlopeError, match=f"a.yaml: must be a summary that fix deposit/grid wrote: .*{rule}"):
        schemas.check_schema(value, run_folders.SUMMARY["properties"][section], "a.yaml", run_folders.WHAT)


@pytest.mark.parametrize("kinds, name, column", [
    (("straight", "straight"), "straight length", True),
    (("along the fall path",) * 2, "length along the fall path", False),
    (("straight", "along the fall path"), "length (straight in some runs)", True),
    ((None, None), "length along the fall path", False)])
def test_a_length_without_a_fall_path_is_called_straight(kinds, name, column):
    several = [changed(one, length_is=kind, length_m=30.0) for one, kind in zip(rows((("0",), (5.0, 6.0))), kinds)]
    assert quantities.name_quantity("length_m", several) == name
    assert quantities.name_quantity("front_m", several) == "farthest ball"
    head = study_table.tabulate_study({"rolling": ["0"]}, {"seed": []}, several,
                                      {"seed": "0"}).splitlines()[0].split(",")
    assert ("length_is" in head) == column and (not column or head[head.index("length_deg") + 1] == "length_is")
