"""tools/slope sensitivity: one variable at a time; scatter, effects and the sentence against numbers by hand."""
import math
import shutil
import statistics
from pathlib import Path

import pytest
import yaml

import made_rows
from tiny_collapse import edit, rows_of

from slope_tools.studies import sensitivity
from slope_tools.tables import quantities

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
COMMAND = "sensitivity case/in.tiny"
T = 4.302652729911275       # t(0.975) of three runs
ROAD = "--road case/road.csv --local"


@pytest.fixture
def here(tiny_case):
    edit("case/in.tiny", "index 150", "index 900\nvariable  xoffset  index 0.0",
         "lattice     sc 1.0", "lattice     sc 1.0 origin ${xoffset} 0 0")
    return tiny_case


@pytest.mark.drawn
def test_one_variable_at_a_time_against_the_scatter_of_equivalent_runs(slope, succeed):
    words = f"--try friction=10,30,50 --try cell=0.5 --repeat xoffset=0.0,0.25,0.5 --set rolling=0.05 " \
        f"{ROAD} -o out"
    out, _ = succeed(words)
    # the values of the base run are not run again
    names = ["rolling_0.05", "rolling_0.05_friction_10", "rolling_0.05_friction_50", "rolling_0.05_cell_0.5",
             "rolling_0.05_xoffset_0.25", "rolling_0.05_xoffset_0.5"]
    found = rows_of("out/sensitivity.csv")
    assert [row["run"] for row in found] == names
    assert [row["kind"] for row in found] == ["base"] + 3 * ["vary"] + 2 * ["repeat"]
    assert found[1]["base_value"] == "30" and found[1]["value"] == "10"

    about = yaml.safe_load(Path("out/sensitivity.yaml").read_text())
    assert about["study"]["base"]["rolling"] == "0.05" and about["study"]["base"]["friction"] == "30"
    for i, name in enumerate(("remove_m3", "remove_on_road_m3")):
        runs = {row["run"]: yaml.safe_load(Path(f"out/{row['run']}/volume/volume.yaml").read_text())["volume"]
                for row in found}
        values = {run: volume[name.removesuffix("_m3")] for run, volume in runs.items()}
        equal = [values[run] for run in (names[0], names[4], names[5])]
        mean, deviation = statistics.fmean(equal), statistics.stdev(equal)
        scatter = about["scatter"][name]
        assert scatter == {"runs": 3, "mean": pytest.approx(mean), "smallest": min(equal), "largest": max(equal),
                           "standard_deviation": pytest.approx(deviation)}
        assert deviation > 0 and values[names[1]] != values[names[2]]
        for row in found:
            assert float(row[name]) == pytest.approx(values[row["run"]])
            assert float(row[f"effect_of_{name}"]) == pytest.approx(values[row["run"]] - mean)
            beyond = abs(values[row["run"]] - mean) > T * deviation * math.sqrt(4 / 3)
            assert row[f"clear_of_{name}"] == ("yes" if beyond else "no")
        most = max(names[1:4], key=lambda run: abs(values[run] - mean))
        text = about["trust"][i]
        assert text in out
        assert f"one run is accurate to +- {quantities.format_quantity(T * deviation)} m3" in text
        assert f"{most.split('_', 2)[2].replace('_', ' ')} changes it most" in text
    assert Path("out/sensitivity.png").read_bytes()[:4] == b"\x89PNG"

    # what is finished is kept, and a value may be added; the base is a row, too
    before = Path(f"out/{names[0]}/finished.yaml").read_bytes()
    status, out, err = slope(words.replace("--try cell=0.5", "--try cell=0.5 --try steps=100"))
    assert status == 0 and "6 of 7 runs are finished already" in out, err
    assert Path(f"out/{names[0]}/finished.yaml").read_bytes() == before
    status, out, err = slope(words + " --of front_m")
    assert status == 0 and out.count("started") == 0 and "effect_of_front_m" in rows_of("out/sensitivity.csv")[0], err


def test_what_is_clear_depends_on_the_number_of_equivalent_runs():
    """t(0.975) sqrt(1 + 1/n): 4.97 of three runs, 2.37 of ten."""
    for count, most in ((3, 4.303 * math.sqrt(4 / 3)), (10, 2.2622 * math.sqrt(1.1))):
        about = {"runs": count, "mean": 100.0, "standard_deviation": 2.0}
        for value, clear in ((100 - 2 * most * 1.001, True), (100 + 2 * most * 0.999, False)):
            tried = sensitivity.Tried("vary", "rolling", "0.1", made_rows.row(front_m=value))
            assert sensitivity.is_clear(tried, "front_m", about) is clear


def test_a_repeat_without_effect_is_none_and_what_runs_warn_of_is_told(here, succeed):
    """A seed that the deck does not use made every change clear; of what the grid cuts off nothing was said."""
    edit("case/in.tiny", "index 900", "index 900\nvariable  seed  index 0",
         "terrain base", "terrain base extent 12 40 0 24")
    succeed(f"--try rolling=0.2 --set steps=300 --repeat seed=1 {ROAD} -o out")
    assert [(row["kind"], row["clear_of_remove_m3"]) for row in rows_of("out/sensitivity.csv")] == [
        ("base", ""), ("vary", "")]
    about = yaml.safe_load(Path("out/sensitivity.yaml").read_text())
    assert about["scatter"]["remove_m3"]["standard_deviation"] is None
    told = {one["kind"]: one.get("runs") for one in about["warnings"]}
    assert told["no effect"] == ["steps_300_seed_1"] and {"not repeated", "in motion", "cut off"} <= told.keys()


def test_runs_that_are_equal_by_chance_alone_tell_no_scatter():
    """As where nothing reaches the road: one run is not accurate to +- 0."""
    tried = [sensitivity.Tried(kind, "seed", "1", made_rows.row(front_m=value, length_m=5.0))
             for kind, value in (("base", 1.0), ("repeat", 2.0), ("vary", 1.0), ("repeat", 1.0))]
    kept, found = sensitivity.leave_out_same(tried)
    assert kept == tried[:3] and [one.numbers["on"] for one in found] == [" at 1"] * 2
    assert sensitivity.measure_spread(kept, "length_m")["standard_deviation"] is None
    assert sensitivity.measure_spread(kept, "front_m")["standard_deviation"] == pytest.approx(math.sqrt(0.5))


def test_a_failed_run_is_told_and_the_others_are_collected(slope):
    shutil.copy("case/terrain.asc", "case/same.asc")
    status, _, err = slope(f"--try terrain=same.asc,none.asc --set steps=100 {ROAD} -o out")
    assert status == 2 and "steps_100_terrain_none.asc: ERROR: Region terrain" in err
    assert [row["value"] for row in rows_of("out/sensitivity.csv")] == ["", "same.asc"]


@pytest.mark.parametrize("arguments, message", [
    ("--try colour=1", "--try: must name an index variable of case/in.tiny"),
    ("--try friction=20 --repeat friction=30", "--repeat: must not name a variable of --try, got friction"),
    ("--set friction=20,25", "--set: must give one value"),
    ("--try friction=30", "--try, --repeat: must give a value that is not the base's"),
    ("--try friction=20 --of colour", "--of: must be different ones of remove_m3, "),
])
def test_wrong_input_is_one_line(slope, arguments, message):
    status, _, err = slope(f"{arguments} {ROAD} -o out")
    assert status == 2 and err.startswith("slope sensitivity: ") and err.count("\n") == 1
    assert message in err
    assert not Path("out").exists()


def test_the_road_is_required(slope):
    status, _, err = slope("--try friction=20 -o out")
    assert status == 2 and "--road" in err and err.count("\n") == 1
