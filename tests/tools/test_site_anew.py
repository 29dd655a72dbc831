"""slope site FOLDER over a folder that is there: what of it stays, what is found anew, what is refused, kills."""
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections import namedtuple
from pathlib import Path

import numpy as np
import pytest
import rasterio
import yaml
from shapely.geometry import LineString

from run_helpers import write_tif
from test_site import (BODY, EAST, NORTH, ROAD, TOOLS, gis, inside as in_process, make, make_mine,  # noqa: F401
                       refused, slope, told, work_in, write_files, write_layer)
from tiny_collapse import LMP, processes_in

from slope_tools import cli, disk
from slope_tools.animation import film
from slope_tools.case import decks
from slope_tools.deposits import score_run
from slope_tools.errors import SlopeError
from slope_tools.finding_words import WORDS
from slope_tools.findings import Finding
from slope_tools.mobility import body, known
from slope_tools.plots import site_map
from slope_tools.sites import site_budget, site_choices, site_deck, site_folder, site_trial, site_warnings
from slope_tools.sites.site_found import Body
from slope_tools.studies import site_study
from slope_tools.survey.resampling import sample


MAPPED = [(25, 25), (60, 25), (60, 55), (25, 55)]


@pytest.fixture
def inside(told):  # noqa: F811
    """Run `slope site ARGUMENTS` there; gives stdout and stderr."""
    def run(arguments, status=0):
        found, out, err = told(*shlex.split(arguments))
        assert found == status, out + err
        return namedtuple("Told", "out err")(out, err)
    return run


@pytest.fixture(scope="module")
def once(shared):
    """The standard files, and a site of them without a trial run, which each test gets a copy of."""
    def fill(folder):
        write_files(folder)
        with pytest.MonkeyPatch.context() as patch:
            work_in(folder, patch)
            make_mine()
    return shared("site", fill)


@pytest.fixture
def mine(inside, gis, once):  # noqa: F811
    shutil.copytree(once, gis, dirs_exist_ok=True)
    return gis / "mine"


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# --- what is the user's ---

def test_a_users_file_is_not_overwritten(inside, mine):
    """Neither an input of that name, nor any other file; it is said before anything is built."""
    write_layer(mine / "own.geojson", ROAD)
    (mine / "observed.csv").write_text("20,0\n36,0\n36,80\n")
    (mine / "behind.csv").write_text("36,50\n36,30\n")
    before = contents(mine)
    for words, file in (("--road mine/road.csv", "mine/road.csv"), ("--line mine/behind.csv", "mine/behind.csv"),
                        ("--observed mine/observed.csv", "mine/observed.csv"),
                        ("--observed mine/own.geojson", "mine/observed.csv")):
        out, err = inside(f"mine {words}", 2)
        assert err.startswith(f"slope site: {file}: must not ") and err.count("\n") == 1 and out == "", err
        assert contents(mine) == before
    inside("mine --road mine/own.geojson")      # the name is no matter
    assert (mine / "own.geojson").read_bytes() == before[Path("own.geojson")]


def test_names_of_the_files_are_known_before(inside, mine):
    """A line called observed is not the mapped deposit."""
    write_layer(mine.parent / "observed.geojson", [(36, 50), (36, 30)], kind=LineString)
    write_layer(mine.parent / "mapped.geojson", MAPPED)
    inside("mine --line observed.geojson --observed mapped.geojson")
    assert site_folder.list_site_files(site_choices.load_site(mine).choices) - {site_trial.REACHED} == set(
        site_choices.found(mine).files) == {path.name for path in mine.iterdir() if path.name != ".lock"}
    assert len((mine / "observed.csv").read_text().splitlines()) >= 5
    assert (mine / "observed_2.csv").read_text().splitlines()[1:] == ["36,50", "36,30"]


@pytest.mark.parametrize("after", range(1, 9))
def test_killed_while_the_files_are_exchanged(tmp_path, monkeypatch, after):
    """Studies stay where they are; the next call makes the folder whole."""
    folder = tmp_path / "mine"
    (folder / "study").mkdir(parents=True)
    (folder / "study" / "study.yaml").write_text("hours\n")
    for name in ("in.site", "site.yaml", "terrain.asc", "road.csv", "notes.txt"):
        (folder / name).write_text("old\n")
    old = {"in.site", "site.yaml", "terrain.asc", "road.csv"}
    made = {"in.site", "site.yaml", "terrain.asc", "observed.csv"}

    def new():
        place = folder / ".mine.1.new"
        place.mkdir(exist_ok=True)
        for name in made:
            (place / name).write_text("new\n")
        return place

    left = after

    def dies(do):
        def one(*words, **more):
            nonlocal left
            left -= 1
            if not left:
                raise KeyboardInterrupt
            return do(*words, **more)
        return one
    first = new()
    with monkeypatch.context() as patch:
        for name in ("replace", "unlink", "rename", "rmdir"):
            patch.setattr(Path, name, dies(getattr(Path, name)))
        try:
            site_folder.exchange(first, folder, old)
        except KeyboardInterrupt:
            pass
    assert (folder / "study" / "study.yaml").read_text() == "hours\n"
    if (folder / "in.site").exists():       # then it is all the old or all the new site
        assert {path.read_text() for path in folder.glob("*.*") if path.is_file() and path.name != "notes.txt"} == {
            (folder / "in.site").read_text()}
    if (folder / "site.yaml").read_text() == "new\n":
        old = made
    site_folder.exchange(new(), folder, old)
    assert all((folder / name).read_text() == "new\n" for name in made)
    assert (folder / "notes.txt").read_text() == "old\n" and (folder / "study" / "study.yaml").exists()


# `slope site` that dies when its files are there
KILLED = """
import os, signal, sys
from slope_tools import cli
from slope_tools.sites import site
site.built = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
cli.main(["site", *sys.argv[1:]])
"""


@pytest.mark.parametrize("before", ["nothing", "an empty folder", "the site"])
def test_killed_while_the_files_are_made(inside, gis, before):  # noqa: F811
    """The next call removes what the killed one left, and leaves alone what belongs to a process that lives."""
    make = f"--terrain dem.tif --release release.geojson {shlex.join(BODY)} -o mine"
    if before == "an empty folder":
        (gis / "mine").mkdir()
    elif before == "the site":
        inside(make)
        make = "mine"
    killed = subprocess.Popen([sys.executable, "-c", KILLED, *shlex.split(make)], cwd=gis, stdin=subprocess.DEVNULL,
                              env={**os.environ, "PYTHONPATH": str(TOOLS)})
    assert killed.wait(60) == -signal.SIGKILL
    child = killed.pid
    left, = gis.rglob(f".mine.*{child}.new")
    other = left.with_name(left.name.replace(str(child), str(os.getppid())))
    if before != "an empty folder":     # with it the folder is in use
        other.mkdir()
    inside(make)
    assert (gis / "mine" / site_deck.NAME).is_file() and not left.exists()
    assert list(gis.rglob(".mine.*")) == ([other] if before != "an empty folder" else [])


def test_a_folder_without_its_deck_is_made_anew(inside, mine):
    (mine / site_deck.NAME).unlink()
    inside("mine")
    assert (mine / site_deck.NAME).is_file() and not list(mine.parent.rglob(".mine*"))


def test_exchange_takes_no_file_that_was_not_planned(tmp_path):
    for name in ("mine", "new"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "surprise").write_text(name)
    with pytest.raises(SlopeError, match="mine/surprise: must not exist"):
        site_folder.exchange(tmp_path / "new", tmp_path / "mine", set())
    assert (tmp_path / "mine" / "surprise").read_text() == "mine"


# --- what is found anew ---

def edit(mine, section, **values):
    """What a user writes into site.yaml."""
    path = mine / "site.yaml"
    about = yaml.safe_load(path.read_text())
    about[section].update(values)
    path.write_text(yaml.safe_dump(about))


def test_another_body_gets_balls_of_its_own(inside, mine):
    first = site_choices.load_site(mine).choices
    inside("mine --volume 500")
    second = site_choices.load_site(mine).choices
    assert second.balls.number == first.balls.number and second.release.depth is None
    assert second.balls.diameter < first.balls.diameter / 1.5
    assert site_choices.found(mine).balls == pytest.approx(site_budget.MANY, rel=0.02)      # as it is thin
    for key in ("speed", "duration"):       # a trial run of the other body may have been slower
        edit(mine, "model", **{key: 99.0})
        about = yaml.safe_load((mine / "site.yaml").read_text())
        about["found"]["derived"][f"model.{key}"] = 99.0
        (mine / "site.yaml").write_text(yaml.safe_dump(about))
    inside("mine --client somebody")
    assert site_choices.load_site(mine).choices.model.speed == site_choices.load_site(mine).choices.model.duration == 99
    inside("mine --depth 4")
    model = site_choices.load_site(mine).choices.model
    assert (model.speed, model.duration) == (47, 600)


def test_what_the_user_chose_stays(inside, mine):
    diameter = site_choices.load_site(mine).choices.balls.diameter
    inside(f"mine --diameter {diameter}")       # the same, but chosen now
    edit(mine, "model", speed=60.0, cell=3.0)
    inside("mine")
    inside("mine --volume 500")
    choices = site_choices.load_site(mine).choices
    assert choices.balls.diameter == diameter and choices.balls.number is None
    assert choices.model.speed == 60 and choices.model.cell == 3


def test_a_shape_that_nobody_named_is_none(inside, gis):  # noqa: F811
    inside("--terrain dem.tif --release release.geojson --volume 400 -o mine")
    for words, shape in (("", "sphere"), ("--dip 30", "plane"), ("--dip 28", "plane")):
        if words:
            inside(f"mine {words}")
        assert site_choices.load_site(gis / "mine").choices.release.shape is None
        assert yaml.safe_load((gis / "mine" / "release.yaml").read_text())["shape"] == shape
    inside("--terrain dem.tif --release release.geojson --volume 400 -o other")
    inside("other --curvature 0.002")
    assert yaml.safe_load((gis / "other" / "release.yaml").read_text())["shape"] == "slbl"


def test_the_sphere_that_dips_least_follows_its_foundation(inside, mine, gis):  # noqa: F811
    """Its depth is given up for it, and it for a depth; a raster counts by what is in it."""
    with rasterio.open(gis / "dem.tif") as dem:
        z, profile = dem.read(1), dem.profile
    for words, depth, dip, foundation in (
            ("--dip least", None, "least", None), ("--foundation -5", None, "least", -5.0),
            ("--foundation old.tif", None, "least", "old.tif"), ("--depth 3", 3.0, None, None)):
        with rasterio.open("old.tif", "w", **profile) as out:
            out.write(z - 2, 1)
        inside(f"mine {words}")
        one = site_choices.load_site(mine).choices.release
        assert (one.depth, one.volume, one.dip) == (depth, None, dip)
        assert (Path(one.foundation).name if isinstance(one.foundation, str) else one.foundation) == foundation
        about = yaml.safe_load((mine / "release.yaml").read_text())
        assert about["shape"] == "sphere" and ("dip_m" in about) == bool(dip)
    edit(mine, "release", depth=None, dip="least", foundation="../old.tif")
    inside("mine")
    assert "old.tif" in str(site_choices.load_site(mine).sources())
    edit(mine, "release", dip="most")
    with pytest.raises(SlopeError, match="release.dip"):
        site_choices.load_site(mine)


# --- warnings ---

def kept(mine):
    return [entry["text"] for entry in yaml.safe_load((mine / site_warnings.NAME).read_text())]


@pytest.mark.parametrize("mean, largest, words", [
    (0.4, 2.0, "0.4 balls thick on average, below 3"), (1.5, 5.2, "1.5 balls thick on average, below 3"),
    (2.9, 12.0, "2.9 balls thick on average, below 3"), (3.1, 9.9, "9.9 balls thick at most, below 10")])
def test_a_thin_body_is_warned_of_by_its_mean_thickness(mean, largest, words):
    line, = site_warnings.of_thickness(mean, largest)
    assert words in str(line) and "more balls (--balls, --minutes)" in str(line)


def test_the_heaviest_warnings_are_shown_once_for_all_objects():
    """By weight, three at most, no notes; of two roads with the numbers of the first."""
    narrow = [Finding("narrow road", {"file": name, "width": wide, "balls": 0.5, "d": 8.0, "cells": 2.0, "cell": 2.0,
                                      "remedy": "x"}) for name, wide in (("north", 4.0), ("south", 5.0))]
    others = [Finding("thin", {"balls": 2.0, "limit": 3.0}), Finding("first look", {"balls": 5.0, "limit": 10.0}),
              Finding("no CRS", {"file": "a.tif", "coordinates": "b"}),
              Finding("in feet", {"degrees": 80, "in_feet": 50})]
    found = site_warnings.heaviest([*narrow, *others])
    assert [one.kind for one in found] == ["in feet", "narrow road", "thin"]
    assert found[1].numbers["file"] == "north, south" and found[1].numbers["width"] == 4.0
    assert str(found[1]).startswith("north, south: ") and str(narrow[0]).startswith("north: ")
    assert len(site_warnings.heaviest([*narrow, *others, Finding("few cells", {"cells": 3, "cell": 5.0})])) == 3
    assert set(site_warnings.HEAVIEST) <= set(WORDS) and len(set(site_warnings.HEAVIEST)) == len(site_warnings.HEAVIEST)


def test_the_map_has_the_fall_path(inside, mine, monkeypatch):
    """From the body down, as slope mobility has it; where no events cover the body, too, and none without a body."""
    seen = []
    monkeypatch.setattr(site_map, "draw_site_map", lambda path, shown, _: seen.append(shown) or path.write_bytes(b""))
    inside("mine --known rock_avalanches")
    path = site_map.reach_of(seen[0]).path
    asked = known.of_about({"set": "rock_avalanches", "confined": "unknown"})
    found = known.compute_known_mobility(body.read_mobility_body(mine), asked).decides.path
    assert path == pytest.approx(np.column_stack([found.x, found.y])) and len(path) > 3
    z = sample(seen[0].raster, *path.T)
    assert z[0] > z[-1] + 5
    assert not len(site_map.reach_of(seen[0]._replace(depth=0 * seen[0].depth)).path)


def test_a_study_says_how_thick_the_body_is_in_the_balls_that_it_ran():
    """Not in those that were planned, with which there was no such finding, or another."""
    others = [Finding("first look", {"balls": 8.0, "limit": 10.0}), Finding("few across")]
    body = Body(1000.0, 8.0, 12.0)
    assert site_warnings.thickness_at(body, 1.0, others) == others[1:]
    one, other = site_warnings.thickness_at(body, 4.0, others)
    assert (one.kind, one.numbers["balls"], other) == ("thin", 2.0, others[1])
    assert site_warnings.thickness_at(Body(1000.0), 4.0, others) == others
    assert site_warnings.of_volume(9.9e5) == []
    line = str(*site_warnings.of_volume(3.6e7))
    assert "36 million m3" in line and "farther" in line and "slope calibrate" in line
    assert site_warnings.of_thickness(3.1, 10.0) == []


def test_the_ground_is_scattered_balls_as_large_as_those_of_the_soil(inside, mine):
    assert "spacing 0.8" in inside("mine --balls 60 --spacing 0.8").out
    deck = decks.index_variables(mine / site_deck.NAME)
    assert (deck["field_d"], deck["spacing"], deck["ground_seed"]) == ("${d}", "0.8", "1")
    for name in ("slip", "field"):
        words, = [words for words in decks.commands(mine / site_deck.NAME) if words[:2] == ["fix", name]]
        assert words[words.index("pattern"):] == ["pattern", "scattered", "${which}"]


@pytest.mark.parametrize("section, key", [("model", "field_diameter"), ("study", "xoffset"), ("study", "fine")])
def test_a_key_of_an_older_version_is_refused_with_what_to_do(inside, mine, section, key):
    before = contents(mine)
    edit(mine, section, **{key: 2})
    was = contents(mine)
    err = inside("mine", 2).err
    assert err.count("\n") == 1 and re.search(f"mine/site.yaml: {section}: .*no {key}.*the site anew", err)
    assert contents(mine) == was != before


def test_a_set_of_known_events_is_checked_before_it_is_kept(inside, mine):
    before = contents(mine)
    err = inside("mine --known foo", 2).err
    assert err.count("\n") == 1 and re.search("slope site: --known: must be .*, got foo$", err)
    assert contents(mine) == before


# --- soil and ground ---

def test_options_of_soil_and_ground_reach_the_deck(inside, mine):
    out = inside("mine --friction 25 --rolling 0 0.07 --slip-friction 5 --spacing 0.5 --density 1600 "
                 "--field-restitution 0.3").out
    choices = site_choices.load_site(mine).choices
    assert choices.study.rolling == (0, 0.07)
    assert "friction 25 degrees, on the slip surface 5; rolling resistance 0, 0.07" in out
    assert "bulk density 1,600 kg/m3" in out
    deck = decks.index_variables(mine / site_deck.NAME)
    wanted = {"friction": 25, "slip": 5, "spacing": 0.5, "field_e": 0.3, "density": 1600 / 0.60}
    assert {name: float(deck[name]) for name in wanted} == pytest.approx(wanted, rel=1e-4)


def test_a_site_made_with_older_values_of_a_mobile_mass_is_read(inside, mine):
    """Its site.yaml holds them; the option that gave them is no more."""
    edit(mine, "model", friction=6, spacing=0.33, field_restitution=0.16)
    edit(mine, "study", rolling=[0.05, 0.14])
    inside("mine --balls 70")
    assert decks.index_variables(mine / site_deck.NAME)["spacing"] == "0.33"
    with pytest.raises(SystemExit):
        cli.main(["site", "mine", "--mobile"])


@pytest.mark.parametrize("words, line", [
    ("--density 1.8", "--density: must be at least 100 kg/m3, of the ground with its voids, got 1.8"),
    ("--friction 95", "--friction: must be < 90, got 95"),
    ("--rolling 0 0", "--rolling: must"), ("--rolling 0.1 -0.1", "--rolling: second value: must be >= 0, got -0.1"),
    ("--spacing 0.96", "--spacing: must be <= 0.95, got 0.96"), ("--spacing 0", "--spacing: must be > 0, got 0"),
    ("--field-restitution 1.2", "--field-restitution: must be <= 1, got 1.2")])
def test_refused_values_of_soil_and_ground(inside, mine, words, line):
    before = contents(mine)
    assert inside(f"mine {words}", 2).err.startswith(f"slope site: {line}")
    assert contents(mine) == before


# --- warnings of all kinds ---

def test_all_warnings_are_kept_in_the_folder(inside, mine):
    """Those of layers and balls; anew with the other files."""
    write_layer(mine.parent / "road.geojson", [(20, -40), (36, -40), (36, 80), (20, 80)])
    err = inside("mine --balls 60 --road road.geojson --verbose").err
    lines = kept(mine)
    assert err.splitlines() == [f"slope site: warning: {line}" for line in lines]
    out, err = inside("mine")       # the three that weigh most
    assert err.splitlines() == [f"slope site: warning: {lines[k]}" for k in (0, 1, 3)]
    assert f"all 4 warnings and notes: --verbose, or mine/{site_warnings.NAME}" in out
    assert [next(word for word in ("above", "outside", "LAMMPS", "thick") if word in line)
            for line in lines] == ["above", "outside", "LAMMPS", "thick"]
    inside("mine --bounds -12000 33000 -11890 35000")
    assert "--bounds reaches beyond the input" in kept(mine)[0]
    inside("mine --balls 100000")
    assert not any("thick on average" in line for line in kept(mine)) and len(kept(mine)) == 4
    assert site_warnings.NAME in site_choices.found(mine).files


# --- the program ---

def test_an_end_from_outside_ends_the_trial_run(gis):  # noqa: F811
    (gis / "slow").write_text("#!/bin/bash\ntrap 'exit 1' TERM\nwhile :; do sleep 0.1; done\n")
    (gis / "slow").chmod(0o755)
    words = ["site", "--terrain", "dem.tif", "--release", "release.geojson", *BODY, "-o", "mine", "--lmp", "./slow"]
    process = subprocess.Popen([sys.executable, str(TOOLS / "slope"), *words], cwd=gis, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True, env=dict(os.environ))
    end = time.monotonic() + 120
    while not list(gis.glob(".mine*/trial/screen.txt")):
        assert time.monotonic() < end and process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGTERM)
    err = process.communicate(timeout=120)[1]
    assert process.returncode == 130 and err.endswith("slope site: interrupted\n"), err
    assert not list(gis.glob("*mine*")) + list(gis.glob(".mine*"))
    end = time.monotonic() + 10         # what was told to end does so in its own time, on a busy machine
    while processes_in(gis):
        assert time.monotonic() < end
        time.sleep(0.1)


# --- a study of which a run fails ---

@pytest.mark.long
def test_a_failed_run_leaves_score_and_report_of_the_others(inside, mine, monkeypatch, capsys):
    monkeypatch.setattr(film, "encode", lambda *_: b"")
    write_layer(mine.parent / "mapped.geojson", MAPPED)
    inside("mine --observed mapped.geojson --balls 60")
    edit(mine, "study", rolling=[0.05, 0.1], spacing=[], packing=[])
    Path("some").write_text(f"""#!/bin/sh\ncase "$*" in *"rolling 0.1"*) exit 1;; esac\nexec {LMP} "$@"\n""")
    Path("none").write_text("#!/bin/sh\nexit 1\n")
    for name in ("some", "none"):
        Path(name).chmod(0o755)
    study = ["study", "mine", "--paper", "--levels", "1", "--lmp"]
    assert cli.main([*study, "./none"]) == 2
    assert not (mine / "report.html").exists() and "2 of 2 runs failed" in capsys.readouterr().err
    assert cli.main([*study, "./some"]) == 2
    out, err = capsys.readouterr()
    assert err.splitlines()[-1].startswith("slope study: mine/study: 1 of 2 runs failed: rolling_0.1: ")
    assert "report.html" in out and (mine / "report.html").is_file() and (mine / "score" / "score.yaml").is_file()


# --- the study of what is there ---

def test_a_changed_site_is_not_run_with_the_old_deck(inside, mine, gis):  # noqa: F811
    """What the deck was made of; rolling, cut angle and the report's fields are read when they are needed."""
    text = (mine / "site.yaml").read_text()
    for old, new in (("  rolling: [0, 0.05, 0.1]", "  rolling: [0, 0.2]"), ("  cut_angle: 30", "  cut_angle: 40"),
                     ("  client: null", "  client: Me")):
        assert old in text
        text = text.replace(old, new)
    (mine / "site.yaml").write_text(text)
    assert cli.main(["study", "mine", "--dry-run"]) == 0
    for old, new in (("  friction: 30", "  friction: 20"), ("  depth: ", "  depth: 1"),
                     ("file: ../road.geojson", "file: ../other.geojson")):
        assert old in text
        (mine / "site.yaml").write_text(text.replace(old, new, 1))
        refused(in_process(gis, "study", "mine", "--dry-run"), "mine/site.yaml: must not have been changed since "
                "in.site was made from it: `slope site mine` rebuilds the deck")
    (mine / "site.yaml").write_text(text.replace("  friction: 30", "  friction: 20"))
    inside("mine")
    assert cli.main(["study", "mine", "--dry-run"]) == 0


@pytest.mark.parametrize("name", ["in.site", "terrain.asc", "release.slip.asc", "road.csv"])
def test_a_site_without_one_of_its_files(mine, gis, name):  # noqa: F811
    (mine / name).unlink()
    refused(in_process(gis, "study", "mine", "--dry-run"), f"mine/{name}: must exist; `slope site mine` rebuilds it")
    assert not (mine / "study").exists()


def test_one_command_at_a_time_works_in_a_site(inside, mine, gis):  # noqa: F811
    before = contents(mine)
    with disk.alone_in(mine):
        refused(in_process(gis, "study", "mine", "--lmp", LMP),
                "mine: must not be in use by another study: wait for it, or end it")
        _, err = inside("mine --client Me", 2)
        assert "mine: must not be in use by another study" in err
    assert contents(mine) == {**before, Path(".lock"): b""}


def test_warnings_of_a_site_are_those_of_its_study(tmp_path):
    assert site_study.read_site_warnings(tmp_path) == []
    (tmp_path / "warnings.yaml").write_text("# slope site\n- {kind: other, text: too thin}\n")
    assert list(map(str, site_study.read_site_warnings(tmp_path))) == ["too thin"]


# --- sources that change after the folder was made ---

def told_by_study(capsys):
    assert cli.main(["study", "mine", "--dry-run"]) == 2
    return capsys.readouterr().err


def test_a_source_that_was_edited(inside, mine, gis, capsys):  # noqa: F811
    assert cli.main(["study", "mine", "--dry-run"]) == 0
    with rasterio.open(gis / "dem.tif", "r+") as dem:
        dem.write(dem.read() + 1)
    assert told_by_study(capsys).startswith("slope study: mine/../dem.tif: must not have changed since in.site was ")
    inside("mine")
    assert cli.main(["study", "mine", "--dry-run"]) == 0
    (gis / "dem.prj").write_text("another CRS")
    assert "dem.tif: must not have changed" in told_by_study(capsys)


# --- a mapped deposit that lies elsewhere, and a score that fails ---

@pytest.mark.parametrize("east, fits", [(20, True), (119, True), (121, False), (900000, False)])
def test_a_mapped_raster_must_lie_on_the_terrain(inside, mine, gis, east, fits):  # noqa: F811
    """Which ends at 120 m."""
    write_tif(gis / "mapped.tif", np.ones((20, 20)), 2.0, EAST + east, NORTH + 20)
    before = contents(mine)
    out, err = inside("mine --observed mapped.tif", 0 if fits else 2)
    assert ("observed.tif: thickness" in out) == fits
    if not fits:
        assert err.splitlines()[-1].startswith("slope site: mapped.tif: must have thickness on the terrain, got ")
        assert {**before, Path(".lock"): b""} == contents(mine)


def test_the_report_is_written_though_the_score_fails(gis, monkeypatch):  # noqa: F811
    monkeypatch.setattr(film, "encode", lambda *_: b"")
    write_layer(gis / "mapped.geojson", MAPPED)
    made = make(gis, "--shape", "ellipsoid", "--depth", "5", "--balls", "60", "--observed", "mapped.geojson",
                run=in_process)
    assert made.returncode == 0, made.stderr
    path = gis / "mine" / "site.yaml"
    about = yaml.safe_load(path.read_text())
    about["study"].update(rolling=[0.05], packing=[])
    path.write_text(yaml.safe_dump(about))
    (gis / "mine" / "score").mkdir()
    (gis / "mine" / "score" / "score.yaml").write_text("of other runs\n")
    outline = (gis / "mine" / "observed.csv").read_text()
    (gis / "mine" / "observed.csv").write_text("no outline\n")
    study = in_process(gis, "study", "mine", "--paper", "--levels", "1")
    assert study.returncode == 2 and study.stderr.splitlines()[-1].startswith("slope study: mine/observed.csv: "), study
    assert not (gis / "mine" / "runs").exists()     # said before anything is run
    (gis / "mine" / "observed.csv").write_text(outline)

    def fails(*_):
        raise SlopeError("mapped", "must fit")

    monkeypatch.setattr(score_run, "make_score", fails)
    study = in_process(gis, "study", "mine", "--paper", "--levels", "1")
    assert study.returncode == 2 and study.stderr.splitlines()[-1].startswith("slope study: mapped: "), study
    assert (gis / "mine" / "report.html").exists() and not (gis / "mine" / "score").exists()
