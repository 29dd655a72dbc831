"""slope site FOLDER --scenario: a whole site beside another, with its balls and at least as stiff; the page of all."""
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from affine import Affine
from shapely.geometry import LineString

import made_rows
import made_study
from test_site import gis, make_mine, told, work_in, write_dem, write_files, write_layer  # noqa: F401
from test_site_anew import edit, inside  # noqa: F401
from test_site_lists import measure
from tiny_collapse import LMP

from slope_tools import cli
from slope_tools.case import decks
from slope_tools.commands import study as study_command
from slope_tools.ensembles import known_study
from slope_tools.scenarios import compare, method, page
from slope_tools.sites import site_choices, site_scenarios, site_trial
from slope_tools.statistics.entries import Kind, Source
from slope_tools.studies.road_numbers import Made
from slope_tools.survey.rasters import Raster
from slope_tools.tables import study_file, study_types

KEPT = ("d", "cell", "duration", "film", "density", "spacing", "friction")
FILES = ("release.depth.asc", "release.slip.asc", "release.csv", "terrain.asc", "road.csv")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The standard files, and the site mine."""
    folder = tmp_path_factory.mktemp("whole")
    write_files(folder)
    with pytest.MonkeyPatch.context() as patch:
        work_in(folder, patch)
        patch.setattr(site_trial, "measure", measure)
        patch.setenv("LMP", LMP)
        make_mine()
        edit(folder / "mine", "study", packing=[2, 5], rolling=[0.02, 0.08])
    return folder


@pytest.fixture
def here(whole, tmp_path, monkeypatch):
    """A copy of it; trial runs are as fast as the list speeds says, which is given."""
    folder = tmp_path / "here"
    shutil.copytree(whole, folder)
    work_in(folder, monkeypatch)
    monkeypatch.setenv("LMP", LMP)
    speeds = [14.0]
    monkeypatch.setattr(site_trial, "measure", lambda *words: measure(*words)._replace(speed=speeds[0]))
    return speeds


def deck_of(folder):
    """The variables of the deck, and its text without the title."""
    text = (Path(folder) / "in.site").read_text()
    return decks.index_variables(Path(folder) / "in.site"), text.split("\n", 1)[1]


@pytest.mark.parametrize("faster", [1, 2])
def test_a_scenario_is_a_whole_site_with_the_balls_of_its_own(here, capsys, faster):
    """Diameter, cells, time limit and packings; the larger of both speeds and thicknesses, which make the stiffness."""
    here[0] *= faster
    before = (Path("mine") / "site.yaml").read_bytes(), sorted(path.name for path in Path("mine").iterdir())
    assert cli.main(["site", "mine", "--scenario", "half", "--volume", "800"]) == 0
    assert "written to mine/scenarios/half" in capsys.readouterr().out
    mine, half = deck_of("mine")[0], deck_of("mine/scenarios/half")[0]
    assert {name: half[name] for name in KEPT} == {name: mine[name] for name in KEPT}
    assert float(half["speed"]) == pytest.approx(faster * float(mine["speed"]), rel=0.05)
    assert float(half["thick"]) == float(mine["thick"]) > 0
    choices = site_choices.load_site(Path("mine/scenarios/half")).choices
    assert choices.study.packing == (2, 5) and choices.study.rolling == (0.02, 0.08)
    assert site_choices.found(Path("mine/scenarios/half")).body.volume == pytest.approx(800, rel=0.02)
    assert choices.project.name == "mine, half"
    assert before == ((Path("mine") / "site.yaml").read_bytes(), sorted(
        path.name for path in Path("mine").iterdir() if path.name != "scenarios"))
    # a thicker one
    assert cli.main(["site", "mine", "--scenario", "deep", "--depth", "9"]) == 0
    thick = float(deck_of("mine/scenarios/deep")[0]["thick"])
    assert thick == pytest.approx(9, rel=0.02) and thick > float(mine["thick"])


@pytest.mark.parametrize("words", [
    ["--volume", "800"], ["--depth", "9"], ["--friction", "25"],
    ["--terrain", "after.tif", "--release", "east.geojson"],
    ["--wall", "line.geojson", "--height", "4"], ["--road", "east.geojson", "--cut-angle", "45"]])
def test_it_equals_a_site_made_by_hand_with_the_same_values(here, capsys, words):
    """To the digit: the deck but for its title, and all that it reads."""
    write_dem(Path("after.tif"), z=None)
    write_layer(Path("east.geojson"), [(56, 20), (86, 20), (90, 40), (86, 60), (56, 60), (52, 40)])
    write_layer(Path("line.geojson"), [(44, 30), (44, 50)], kind=LineString)
    assert cli.main(["site", "mine", "--scenario", "other", *words]) == 0
    other = Path("mine/scenarios/other")
    given = {"--terrain": "dem.tif", "--release": "release.geojson", "--road": "road.geojson"}
    given.update({name: value for name, value in zip(words[::2], words[1::2]) if name in given})
    more = [word for name, value in zip(words[::2], words[1::2]) if name not in given for word in (name, value)]
    mine = site_choices.load_site(Path("mine")).choices
    size = [] if {"--volume", "--depth"} & {*words} else ["--depth", f"{mine.release.depth:g}"]
    assert cli.main(["site", *[word for pair in given.items() for word in pair], "--shape", mine.release.shape,
                     *size, *more, "--diameter", repr(mine.balls.diameter), "-o", "hand"]) == 0
    model = site_choices.load_site(other).choices.model
    edit(Path("hand"), "model", **{key: getattr(model, key) for key in (
        "cell", "duration", "film", "least_speed", "least_thick")})
    edit(Path("hand"), "study", packing=[2, 5], rolling=[0.02, 0.08])
    assert cli.main(["site", "hand"]) == 0
    edit(Path("hand"), "model", speed=None)
    assert cli.main(["site", "hand"]) == 0
    assert deck_of("hand") == deck_of(other)
    for name in FILES:
        assert (Path("hand") / name).read_bytes() == (other / name).read_bytes(), name
    one, two = (yaml.safe_load((Path(folder) / "site.yaml").read_text()) for folder in ("hand", other))
    for about in (one, two):
        del about["project"], about["found"]
    for section, key in site_choices.FILES:
        del one[section][key], two[section][key]
    assert one == two


def test_the_study_of_a_scenario_begins_as_that_of_any_site(here, capsys):
    assert cli.main(["site", "mine", "--scenario", "half", "--volume", "800"]) == 0
    capsys.readouterr()
    assert cli.main(["study", "mine/scenarios/half", "--paper", "--dry-run"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"\b0 of \d+ runs are there", out) and not (Path("mine") / "runs").exists()
    # a scenario is changed as any site, and stays as stiff as its site
    here[0] = 1.0
    assert cli.main(["site", "mine/scenarios/half", "--volume", "700"]) == 0
    mine, half = deck_of("mine")[0], deck_of("mine/scenarios/half")[0]
    assert half["speed"] == mine["speed"] and half["thick"] == mine["thick"] and half["d"] == mine["d"]


@pytest.mark.parametrize("words, line", [
    ("mine --scenario a/b --volume 800", "--scenario: must be a folder's name: letters, digits, _ - and ., of which "
     "the first is a letter, a digit or _, got 'a/b'"),
    ("mine --scenario .. --volume 800", "--scenario: must be a folder's name"),
    ("mine --scenario= --volume 800", "--scenario: must be a folder's name"),
    ("mine --scenario there --volume 800", "--scenario: must be a new name; `slope site mine/scenarios/there` changes "
     "the scenario that is there, got there"),
    ("mine/scenarios/there --scenario b --volume 800", "--scenario: must be given with the site itself, "),
    ("mine --scenario b --balls 300",
     "--balls: must not be given with --scenario, whose balls are those of its site, got 300"),
    ("mine --scenario b --volume -3", "--volume: must be > 0"),
    ("bare --scenario b", "--scenario: must be of a site that is made: `slope site bare` makes it"),
    ("nowhere --scenario b", "nowhere: must be a folder with site.yaml"),
    ("--scenario b --terrain dem.tif --release release.geojson -o new",
     "--scenario: must be given with the folder of a site, got b")])
def test_what_is_no_scenario_is_one_line(here, capsys, words, line):
    (Path("mine/scenarios/there")).mkdir(parents=True)
    (Path("mine/scenarios/there/site.yaml")).write_bytes(Path("mine/site.yaml").read_bytes())
    Path("bare").mkdir()
    shutil.copy("mine/site.yaml", "bare")
    before = sorted(Path(".").rglob("*"))
    assert cli.main(["site", *words.split()]) == 2
    out, err = capsys.readouterr()
    assert err.startswith(f"slope site: {line}") and err.count("\n") == 1, err
    assert sorted(Path(".").rglob("*")) == before


def test_a_scenario_that_cannot_be_made_may_be_mended(here, capsys):
    """Its site.yaml is kept; the same command again, or slope site on its folder; nothing is left of a wrong option."""
    assert cli.main(["site", "mine", "--scenario", "huge", "--volume", "1e9"]) == 2
    assert [path.name for path in Path("mine/scenarios/huge").iterdir()] == ["site.yaml"]
    assert cli.main(["site", "mine", "--scenario", "huge", "--volume", "800"]) == 0
    assert site_scenarios.list_scenarios(Path("mine")) == [Path("mine/scenarios/huge")]
    assert site_scenarios.site_of(Path("mine/scenarios/huge")) == Path("mine").resolve()
    assert site_scenarios.site_of(Path("mine")) is None


# --- side by side ---

def test_what_differs_is_said(here, capsys):
    """Of what is asked for the keys that differ; of the model balls, stiffness and ground, and only what differs."""
    assert cli.main(["site", "mine", "--scenario", "half", "--volume", "800"]) == 0
    here[0] *= 2
    assert cli.main(["site", "mine", "--scenario", "smooth", "--friction", "25", "--spacing", "0.6"]) == 0
    write_dem(Path("after.tif"), z=np.full((40, 60), 90.0) + np.arange(60) * 0.6)
    assert cli.main(["site", "mine", "--scenario", "cut", "--terrain", "after.tif"]) == 0
    assert cli.main(["site", "mine", "--scenario", "huge", "--volume", "1e9"]) == 2
    mine, cut, half, huge, smooth = compare.read_scenarios(Path("mine"))
    assert [one.name for one in (mine, cut, half, huge, smooth)] == ["mine", "cut", "half", "huge", "smooth"]
    asked = {one.name: compare.choices_that_differ(mine.site, one.site) for one in (cut, half, smooth)}
    assert asked == {"cut": ["files after.tif"], "half": ["volume 800"], "smooth": ["spacing 0.6", "friction 25"]}
    found = {one.name: list(compare.differences(mine, one)) for one in (cut, half, huge, smooth)}
    assert found["half"] == found["huge"] == [] and "another terrain" in found["cut"]
    assert "friction of 25 degrees instead of 30" in found["smooth"] and any(
        text.startswith("the stiffness is for a speed of") for text in found["smooth"])
    assert any(text.startswith("stop angles") for text in found["smooth"]) and "another terrain" not in found["smooth"]
    edit(Path("mine"), "road", file=None)
    assert cli.main(["site", "mine", "--diameter", "2"]) == 0
    mine, *others = compare.read_scenarios(Path("mine"))
    assert "balls of 1.98 m instead of 2" in list(compare.differences(mine, others[1]))
    assert list(page.models([mine, *others]))[2] == "huge: not made yet."


@pytest.mark.parametrize("headline, shown", [
    (None, "-"), ({"kind": "withheld", "volume_m3": None}, "not usable"),
    ({"kind": "number", "volume_m3": 20120.0}, "20,100"),
    ({"kind": "floor", "volume_m3": 20120.0}, "at least 20,100"), ({"kind": "floor", "volume_m3": 0.0}, "more than 0"),
    ({"kind": "open", "volume_m3": 20120.0}, "20,100 (no bound)"), ({"kind": "nothing", "volume_m3": 0.0}, "0")])
def test_the_number_of_a_scenario(headline, shown):
    assert page.to_remove(headline and made_study.headline(**headline)) == shown


def study_of(number, source, said=3000.0, **entries):
    """Of a site's sweep, or of its ensemble; said: the number of its first page, of either."""
    rows = [made_rows.row(run=f"{source} {k}", remove_m3=number, length_m=10.0 * k + number / 100, stretches=[])
            for k in range(2)]
    most = {name: {"value": number / 10, "run": rows[0].run} for name in ("distance_99_m", "front_m")}
    header = {"runs": 2, "finished": 2, "method": known_study.WEIGHTED, "governs": "ensemble",
              "road": {"cut_angle": 30, "mesh": 10, "local": "road.csv"}}
    return made_study.study(header, runs=rows, largest=most, headline=made_study.headline(volume_m3=said), **entries)


def sweep_of(number, said=3000.0):
    return study_of(number, "paper", said, conservative=made_study.conservative(number, run="paper 0"))


BOTH = {"study": sweep_of(1000.0), "ensemble": study_of(3000.0, "ensemble", ensemble=made_study.ensemble({}))}


def of_roads(tmp_path, **roads):
    return method.Studied(roads or {"": BOTH}, tmp_path / "ensemble")


def test_numbers_side_by_side_are_of_the_studies_that_all_have(tmp_path):
    both, sweep = of_roads(tmp_path), of_roads(tmp_path, **{"": {"study": BOTH["study"]}})
    folders = {"mine": Path("mine"), "half": Path("mine/scenarios/half")}
    assert method.common([both, None, both]) == ["study", "ensemble"]
    assert method.difference({"mine": both, "half": both}, folders) == ""
    assert method.headline_of(BOTH, ["study", "ensemble"]).volume_m3 == 3000
    names = method.common([both, sweep])
    said = method.difference({"mine": both, "half": sweep, "cut": None}, folders)
    assert names == ["study"] and "half" in said and "slope study mine/scenarios/half" in said and "mine," not in said
    # that of the sweep alone is what it says itself: of one size, no bound
    found = method.headline_of(BOTH, names)
    assert (found.source, found.kind, found.volume_m3) == (Source.SWEEP, Kind.OPEN, 1000)
    assert (method.find_farthest_reach(BOTH, names), method.find_farthest_reach(BOTH, ["study", "ensemble"])) == (100,
                                                                                                                  300)
    assert len(method.list_finished_rows(BOTH, names)) == 2 and len(method.list_finished_rows(BOTH,
                                                                                              ["study",
                                                                                               "ensemble"])) == 4
    known = of_roads(tmp_path, **{"": {"ensemble": BOTH["ensemble"]}})
    said = method.difference({"mine": known, "half": sweep}, folders)
    assert method.common([known, sweep]) == [] and "mine: runs that are weighted" in said and "half: a sweep" in said


def test_numbers_of_balls_of_other_sizes_do_not_compare(here, tmp_path):
    """One study has balls of half the diameter, too: the page said that what is asked for alone differs."""
    mine = compare.read_scenarios(Path("mine"))[0]
    d = float(mine.variables["d"])
    size = study_types.Size([study_types.SizeRuns(one, 10, None, 2) for one in (d, d / 2)], [], {}, "")
    finer = {"": {name: replace(about, size=size) for name, about in BOTH.items()}}
    coarse, fine = (mine._replace(name=name, studied=of_roads(tmp_path, **roads))
                    for name, roads in (("coarse", {}), ("fine", finer)))
    assert compare.different_sizes([coarse, coarse._replace(name="half"), mine]) == ""
    assert compare.different_sizes([fine, fine._replace(name="half"), mine]) == ""
    said = compare.different_sizes([coarse, fine])
    assert f"coarse {d:.3g} m, fine {d / 2:.3g} m" in said and said.count("--levels 2") == 1


def test_every_road_has_a_column(here, tmp_path):
    mine = compare.read_scenarios(Path("mine"))[0]
    one = mine._replace(studied=of_roads(tmp_path, upper=BOTH, lower=BOTH))
    half = {road: {"study": sweep_of(number, number)} for road, number in (("upper", 500.0), ("lower", 10.0))}
    other = mine._replace(name="half", studied=of_roads(tmp_path, **half))
    table = page.tabulate_scenarios([one, other, mine._replace(name="new")])
    assert [head.text for head in table.heads[5:7]] == ["to remove from upper", "to remove from lower"]
    assert [row[5:] for row in table.rows] == [["1,000 (no bound)", "1,000 (no bound)", "2 of 2"],
                                               ["500", "10.0", "2 of 2"],
                                               ["-", "-", "not studied as it is"]]


def test_of_a_run_that_was_cut_short_how_far_is_a_least(here, tmp_path):
    mine = compare.read_scenarios(Path("mine"))[0]
    for about, least in (({}, ""), ({"at_rest": False}, "at least "), ({"lost_m3": 500.0}, "at least ")):
        study = sweep_of(1000.0)
        one = mine._replace(studied=of_roads(tmp_path, **{"": {"study": replace(study, runs=[
            study.runs[0], replace(study.runs[1], **about)])}}))
        _, far, length, *_ = page.list_scenario_numbers(one, ["study"], [""])
        assert [text[:-len(text.split()[-1])] for text in (far, length)] == [least, least]
        assert float(far.split()[-1]) > 0 and float(length.split()[-1]) > 0


def test_studies_are_read_of_each_road(here, monkeypatch):
    """Both where one command made them, else the one that governs."""
    site = compare.read_scenarios(Path("mine"))[0].site
    monkeypatch.setattr(method.outdated, "changed", lambda *_: None)
    for folder in ("mine", "mine/roads/a", "mine/roads/b"):
        for name, about in BOTH.items():
            place = Path(folder, name)
            place.mkdir(parents=True)
            (place / "study.yaml").write_text(yaml.safe_dump(study_file.encode_study(about)))
    assert method.read_method(site).names == ["study",
                                              "ensemble"] and method.read_method(site).governs.name == "ensemble"
    several = replace(site, found=replace(site.found, roads=("a", "b")))
    assert list(method.read_method(several).roads) == ["a", "b"]
    path = Path("mine/roads/b/study/study.yaml")
    about = yaml.safe_load(path.read_text())
    about["study"].update(method=known_study.ASKED, governs="study")
    path.write_text(yaml.safe_dump(about))
    shutil.rmtree("mine/roads/b/ensemble")
    assert method.read_method(several).names == ["study"]
    monkeypatch.setattr(method.outdated, "changed", lambda *_: "deck")
    assert method.read_method(several) is None


def test_an_outline_lies_where_it_is_on_the_ground():
    """Of a scenario whose local metres begin elsewhere; closed at the edge of its raster."""
    raster = Raster(np.array([[0.0, 0.5], [0.0, 0.05]]), Affine(2, 0, 10, 0, -2, 8), None)
    found = page.outline(raster, np.array([10.0, -10.0]))
    assert found.box == (10 + 3 + 10, 7 - 10, 10 + 3 + 10, 7 - 10)      # centre of the one cell that is so thick
    assert found.thickness.shape == (4, 4) and found.thickness[0].max() == 0
    assert page.outline(raster._replace(z=0.1 * raster.z), np.zeros(2)) is None


def test_a_study_draws_the_page_anew(here, monkeypatch, capsys):
    """Of the site or of a scenario; a file of the user's stays, and the study with it."""
    path = Path("mine/scenarios.html")
    monkeypatch.setattr(study_command, "run_site_of", lambda *_: Made([{}], None))
    assert cli.main(["study", "mine"]) == 0 and not path.exists()       # no scenario
    assert cli.main(["site", "mine", "--scenario", "half", "--volume", "600"]) == 0
    for folder in ("mine", "mine/scenarios/half"):
        assert cli.main(["study", folder]) == 0
        assert "mine/scenarios.html: the site and its 1 scenarios" in capsys.readouterr().out
        path.unlink()
    path.write_text("of the user\n")
    assert cli.main(["study", "mine"]) == 0 and path.read_text() == "of the user\n"
    assert "scenarios.html is not made: -o: mine/scenarios.html must be the result of" in capsys.readouterr().out
