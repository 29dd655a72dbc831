"""Volume against an intensity: probabilities against closed forms, a study whose collapse grows with it, its report."""
import csv
import re
import shlex
from pathlib import Path

import pytest
import yaml

from made_rows import changed
from made_rows import row as made_row
from run_helpers import called
from tiny_collapse import LMP, edit, write_case

from slope_tools import cli, errors
from slope_tools.tables import combinations, intensity

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
STUDY = "case/in.tiny --set peak=0,300,900 --repeat xoffset=0.25 --road case/road.csv --local --jobs 1 -o out"


def slope(arguments, capsys):
    """Run `slope ARGUMENTS`; gives status, stdout, stderr."""
    return called(capsys, shlex.split(arguments))


def write_quake(folder):
    """The small collapse, pushed to the road by peak/100 m/s, from a lattice that can be moved."""
    edit(write_case(folder), "index 150", "index 600\nvariable  peak index 0\nvariable  xoffset index 0\n"
         "variable  push equal -v_peak/100", "lattice     sc 1.0", "lattice     sc 1.0 origin ${xoffset} 0 0",
         "neighbor    0.2 bin", "velocity    soil set ${push} 0 0\nneighbor    0.2 bin")


# --- probabilities ---

def test_probability_against_closed_forms():
    """Clopper and Pearson: of no success in n trials the upper end is 1 - 0.025^(1/n); 2 of 4 is symmetric."""
    share, low, high = intensity.probability(0, 3)
    assert share == low == 0 and high == pytest.approx(1 - 0.025 ** (1 / 3), rel=1e-12)
    share, low, high = intensity.probability(5, 5)
    assert share == high == 1 and low == pytest.approx(0.025 ** (1 / 5), rel=1e-12)
    share, low, high = intensity.probability(2, 4)
    assert share == 0.5 and low == pytest.approx(1 - high, rel=1e-12) and low == pytest.approx(0.0676, abs=1e-4)


@pytest.mark.parametrize("largest, expected", [(7000.0, [1000, 2000, 5000]), (5000.0, [500, 1000, 2000]),
                                               (5000.1, [1000, 2000, 5000]), (3.0, [1, 2]), (0.5, [])])
def test_round_volumes(largest, expected):
    assert intensity.round_volumes(largest) == expected


def row(peak, rolling, repeat, volume):
    return made_row(run=f"{peak} {rolling} {repeat}", set={"peak": peak, "rolling": rolling},
                    repeat={"xoffset": repeat} if repeat else {}, centroid_m=volume, front_m=float(repeat or 0),
                    remove_m3=volume, remove_on_road_m3=volume)


def test_points_count_the_runs_above_and_keep_other_variables_apart():
    rows = [row("300", "0", "", 40.0), row("300", "0", "0.5", 60.0), row("0", "0", "", 0.0), row("0", "0", "0.5", 0.0),
            row("300", "0.1", "", 10.0), row("300", "0.1", "0.5", 50.0)]
    about = intensity.entry("peak", combinations.grouped(rows), [0.0, 50.0])
    assert [line.set for line in about.lines] == [{"rolling": "0"}, {"rolling": "0.1"}]
    low, high = about.lines[0].points     # by the intensity, not in the order of the runs
    assert (low.at, high.at) == (0.0, 300.0) and (low.runs, high.runs) == (2, 2)
    assert [one.runs for one in low.exceed] == [0, 0] and [one.runs for one in high.exceed] == [2, 1]
    assert high.mean_m3 == 50.0 and high.scatter_m3 == pytest.approx(200 ** 0.5)
    assert (high.smallest_m3, high.largest_m3, high.share_of_released) == (40.0, 60.0, 0.05)
    # 50 m3 are not more than 50 m3
    assert [one.runs for one in about.lines[1].points[0].exceed] == [2, 0]


def test_a_scatter_of_failing_is_doubted():
    """Of 1000 m3 released, 10 m3 on the road are no failure."""
    rows = [row("0", "0", "", 0.0), row("0", "0", "0.5", 10.0), row("300", "0", "", 5.0), row("300", "0", "0.5", 60.0),
            row("600", "0", "", 40.0), row("600", "0", "0.5", 60.0)]
    one, = intensity.find_intensity_caveats(intensity.entry("peak", combinations.grouped(rows), []))
    assert one.numbers == {"variable": "peak", "values": "300"}
    assert not intensity.find_intensity_caveats(intensity.entry("peak", combinations.grouped(rows[:2] + rows[4:]), []))
    assert one.kind == "fails at times"
    # it came down in all runs, and to the road in one only
    rows = [changed(each, centroid_m=each.centroid_m + 100) for each in rows]
    one, = intensity.find_intensity_caveats(intensity.entry("peak", combinations.grouped(rows), []))
    assert (one.kind, one.numbers["values"]) == ("reaches at times", "300")


@pytest.mark.parametrize("settings, found", [({"peak": ["0", "300"]}, "peak"), ({"peak": ["300"]}, None),
                                             ({"rolling": ["0", "1"], "pga": ["1", "2"]}, "pga"),
                                             ({"rolling": ["0", "1"]}, None), ({"peaks": ["0", "1"]}, None),
                                             ({"shake_intensity": ["1", "2"]}, "shake_intensity"),
                                             ({"peak": ["a", "b"]}, None), ({"peak": ["0", "nan"]}, None),
                                             ({"peak": ["0", "inf"], "pga": ["1", "2"]}, "pga")])
def test_which_variable_is_an_intensity(settings, found):
    assert intensity.check_intensity(None, settings, True) == found


@pytest.mark.parametrize("named, settings, road, words", [
    ("pea", {"peak": ["0", "1"]}, True, ("--intensity", "--set", "pea")),
    ("peak", {"peak": ["0", "1"]}, False, ("--intensity", "--road", "peak")),
    ("peak", {"peak": ["0", "low"]}, True, ("--intensity", "numbers", "0,low")),
    ("peak", {"peak": ["0", "nan"]}, True, ("--intensity", "numbers", "0,nan")),
    ("peak", {"peak": ["0"]}, True, ("--intensity", "several", "0"))])
def test_wrong_intensity(named, settings, road, words):
    with pytest.raises(errors.SlopeError) as error:
        intensity.check_intensity(named, settings, road)
    assert all(word in str(error.value) for word in words) and "\n" not in str(error.value)


@pytest.mark.parametrize("text", ["1,1", "-1", "many", ""])
def test_wrong_volumes_end_the_command(tmp_path, monkeypatch, capsys, text):
    monkeypatch.chdir(tmp_path)
    write_quake(tmp_path / "case")
    status, _, err = slope(f"study {STUDY} --more-than={text}", capsys)
    assert status == 2 and "--more-than" in err and not (tmp_path / "out").exists()


# --- a study and its report ---

@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """A study over three intensities, two runs each, and what it printed."""
    folder = tmp_path_factory.mktemp("intensity")
    write_quake(folder / "case")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("LMP", LMP)
        assert cli.main(shlex.split(f"study {STUDY} --more-than 1,20")) == 0
    return folder


def test_study_tells_the_volume_against_the_intensity(studied):
    rows = list(csv.DictReader((studied / "out" / "study.csv").open()))
    table = list(csv.DictReader((studied / "out" / "intensity.csv").open()))
    assert [one["peak"] for one in table] == ["0", "300", "900"] and len(rows) == 6
    for one in table:
        mine = [float(run["remove_on_road_m3"]) for run in rows if run["peak"] == one["peak"]]
        assert one["runs"] == "2" and float(one["mean_m3"]) == pytest.approx(sum(mine) / 2, rel=1e-12)
        assert float(one["largest_m3"]) == max(mine)
        for volume in ("1", "20"):
            above = sum(value > float(volume) for value in mine)
            assert float(one[f"p_more_than_{volume}_m3"]) == above / 2
    assert float(table[0]["mean_m3"]) < float(table[1]["mean_m3"]) < float(table[2]["mean_m3"])
    about = yaml.safe_load((studied / "out" / "study.yaml").read_text())["intensity"]
    assert about["variable"] == "peak" and about["more_than_m3"] == [1.0, 20.0]
    assert [one["mean_m3"] for one in about["lines"][0]["points"]] == [float(one["mean_m3"]) for one in table]


def test_report_has_the_table_and_the_charts(studied, monkeypatch, capsys):
    monkeypatch.chdir(studied)
    status, _, err = slope("report out", capsys)
    assert status == 0, err
    page = (studied / "out" / "report.html").read_text()
    section = re.search(r'<section id="intensity".*?</section>', page, re.DOTALL)[0]
    assert section.count("<figure") == 2 and section.count("<tr>") == 4
    assert "P(V &gt; 20)" in section and "<td>900</td>" in section
    shown = (studied / "out" / "report.numbers.csv").read_text()
    assert shown.count('"on the road, mean"') == 3


def test_no_intensity_without_its_name(studied, monkeypatch, capsys, blank_pictures):
    """A study of another variable has neither table nor section, and leaves none of an earlier study."""
    monkeypatch.chdir(studied)
    Path("other").mkdir()
    Path("other/intensity.csv").write_text("old\n")
    monkeypatch.setenv("LMP", LMP)
    status, _, err = slope("study case/in.tiny --set rolling=0,0.1 --set steps=50 --road case/road.csv --local "
                           "-o other", capsys)
    assert status == 0, err
    assert yaml.safe_load(Path("other/study.yaml").read_text())["intensity"] is None
    assert not Path("other/intensity.csv").exists()
    blank_pictures()
    assert slope("report other", capsys)[0] == 0
    assert 'id="intensity"' not in Path("other/report.html").read_text()
