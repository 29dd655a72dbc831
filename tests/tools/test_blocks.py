"""Sites of single blocks: from a GeoTIFF and a polygon to the share that reaches a road; what is refused."""
import re
import shutil
import subprocess
from dataclasses import replace
from types import SimpleNamespace

import fiona
import numpy as np
import pytest
import rasterio
import yaml
from affine import Affine
from shapely.geometry import LineString, Polygon, box

from run_helpers import EAST, NORTH, called, write_tif
from test_site import write_layer
from tiny_collapse import LMP, rows_of

from slope_tools import digits
from slope_tools.blocks import ditch, edges, files, kinds, outcome, page, runs, study
from slope_tools.case import decks
from slope_tools.deposits import passed, road_sides
from slope_tools.deposits.gone import Gone, Ground
from slope_tools.plots import site_map
from slope_tools.sites import site_choices, site_deck
from slope_tools.sites.site_sections import OfBlocks, OfMass
from slope_tools.statistics import withheld
from slope_tools.studies.setup import Setup
from slope_tools.survey.rasters import Raster, read_asc_local

CELL, COLUMNS, ROWS = 1.0, 90, 50
TOE, ANGLE = 40.0, 40.0         # m, where the slope begins; degrees
RELEASE = [(75, 20), (80, 20), (80, 30), (75, 30)]
ROAD = [(28, 0), (33, 0), (33, 50), (28, 50)]
WORDS = ["--terrain", "dem.tif", "--release", "cliff.geojson", "--blocks", "60", "--size", "0.8:1.2"]


@pytest.fixture(scope="module")
def gis(tmp_path_factory):
    """A level ground and a slope of 40 degrees; release, road and line."""
    folder = tmp_path_factory.mktemp("gis")
    z = 50 + np.tan(np.radians(ANGLE)) * np.maximum(0, (np.arange(COLUMNS) + 0.5) * CELL - TOE)
    write_tif(folder / "dem.tif", np.broadcast_to(z, (ROWS, COLUMNS)), CELL)
    write_layer(folder / "cliff.geojson", RELEASE)
    write_layer(folder / "flat.geojson", [(10, 20), (20, 20), (20, 30), (10, 30)])
    write_layer(folder / "beyond.geojson", [(85, 20), (99, 20), (99, 30), (85, 30)])
    write_layer(folder / "road.geojson", ROAD)
    for name in ("fence", "calm", "road_edge_1"):
        write_layer(folder / f"{name}.geojson", [(42, 50), (42, 0)], kind=LineString)
    return folder


@pytest.fixture
def told(gis, monkeypatch, capsys):
    """`slope WORDS` there, in this process; gives status, stdout, stderr."""
    monkeypatch.chdir(gis)
    monkeypatch.setenv("LMP", LMP)
    monkeypatch.setattr(site_map, "draw_site_map", lambda path, *_: path.write_bytes(b""))
    return lambda *words: called(capsys, [str(word) for word in words])


@pytest.fixture(scope="module")
def made(gis):
    """A site with its study of 2 x 3 runs of ten blocks: {folder, choices, known}."""
    patch = pytest.MonkeyPatch()
    patch.chdir(gis)
    patch.setenv("LMP", LMP)
    from slope_tools import cli
    assert cli.main(["site", *WORDS, "--rolling", "0.1", "0.4", "--road", "road.geojson", "--line", "fence.geojson",
                     "-o", "tmp"]) == 0
    about = yaml.safe_load((gis / "tmp" / "site.yaml").read_text())
    about["blocks"]["grounds"] = 3
    (gis / "tmp" / "site.yaml").write_text(yaml.safe_dump(about))
    assert cli.main(["site", "tmp"]) == 0
    assert cli.main(["study", "tmp", "--jobs", "2"]) == 0
    patch.undo()
    found = site_choices.load_kind(gis / "tmp", OfBlocks)
    return SimpleNamespace(folder=gis / "tmp", site=found, known=study.read_block_runs(found))


# --- the folder ---

def test_blocks_start_in_the_polygon_above_the_ground(made):
    raster = read_asc_local(made.folder / "terrain.asc")
    for ground in (1, 2, 3):
        rows = np.loadtxt((made.folder / f"blocks.{ground}.data").read_text().split("sphere\n")[1].splitlines())
        assert len(rows) == 10 and ((rows[:, 2] >= 0.8) & (rows[:, 2] <= 1.2)).all()
        assert ((rows[:, 4:6] >= RELEASE[0]) & (rows[:, 4:6] <= RELEASE[2])).all()
        above = rows[:, 6] - np.interp(rows[:, 4], (np.arange(COLUMNS) + 0.5) * CELL, raster.z[0])
        touching = (rows[:, 2] + 0.8) / 2 / np.cos(np.radians(ANGLE))
        assert (above > touching).all() and (above < 1.05 * touching).all()
    assert not (made.folder / "blocks.4.data").exists()


def test_the_deck_has_no_list_of_blocks_with_each_other(made):
    log = (made.known.runs[0].folder / "log.lammps").read_text()
    assert "neigh_modify exclude type 1 1" in log and "Ave neighs/atom = 0" in log
    variables = decks.index_variables(made.folder / site_deck.NAME)
    assert variables["field_d"] == "${d}" and variables["d"] == "0.8" and variables["largest"] == "1.2"


def test_a_speed_is_down_the_fall_line(told, gis):
    assert told("site", *WORDS, "--speed", "5", "--line", "calm.geojson", "--rolling", "5", "-o", "fast")[0] == 0
    assert "large rolling" in (gis / "fast" / "warnings.yaml").read_text()
    down = site_choices.found(gis / "fast").down
    assert down == pytest.approx([-np.cos(np.radians(ANGLE)), 0, -np.sin(np.radians(ANGLE))], abs=1e-3)
    assert decks.index_variables(gis / "fast" / site_deck.NAME)["start"] == "5"
    deck = (gis / "fast" / site_deck.NAME).read_text()
    (gis / "fast" / "short").write_text(deck.split("variable    steps")[0] + "run 0\n")
    subprocess.run([LMP, "-in", "short", "-log", "none", "-screen", "none"], cwd=gis / "fast", check=True)
    [(heads, rows)] = runs.dumps.frames(gis / "fast" / "site.00000000.dump")
    speeds = rows[:, heads.index("vx"):heads.index("vx") + 3]
    assert speeds == pytest.approx(np.broadcast_to(5 * np.array(down), speeds.shape), abs=1e-4)


def test_a_mass_knows_nothing_of_it(told, gis):
    """Its site.yaml has no kind, and its commands refuse a site of blocks."""
    assert not {"kind", "blocks"} & OfMass.of({}).entries().keys()
    with pytest.raises(kinds.SlopeError, match="must be a site of a mass here, got one of blocks"):
        assert told("site", *WORDS, "-o", "other")[0] == 0
        site_choices.load_site(gis / "other")


@pytest.mark.parametrize("words, message", [
    (["--blocks", "1"], "--blocks: must be at least 30, one for each run"),
    (["--blocks", "1000000"], "--blocks: must be at most 100,000: more grounds (blocks.grounds of site.yaml) say more "
     "than more blocks, got 1,000,000"),
    (["--depth", "3"], "--depth: must not be given with a site of single blocks"),
    (["--known", "rockfalls"], "--known: must not be given with a site of single blocks"),
    (["--wall", "fence.geojson", "--height", "3"], "--wall: must not be given with a site of single blocks"),
    (["--release", "beyond.geojson"], "beyond.geojson: must have terrain in it, and 1.2 m beside it"),
    (["--release", "flat.geojson", "--speed", "2"], "--speed: needs a fall line"),
    (["--road", "cliff.geojson"], "--release: must be at least half a block, 0.6 m, away from the road"),
    (["--road", "road.geojson", "--line", "road_edge_1.geojson"], "--line: must not be called road_edge, as lines "
     "around the road are: rename the file, got road_edge_1"),
    (["--release", "flat.geojson", "--speed", "1e-3"], "at least 1 degree, got 0.0"),
    (["--size", "2:1"], "--size: must be D or D:D2"), (["--size", "0.1:2"], "--size: must be D or D:D2"),
    (["--size", "0"], "--size: first value: must be > 0, got 0"), (["--size", "x"], "--size: must be a finite number"),
    (["--speed", "-1"], "--speed: must be >= 0, got -1")])
def test_what_is_refused(told, gis, words, message):
    given = [*WORDS]
    for name, value in zip(words[::2], words[1::2]):
        if name in given:
            given[given.index(name) + 1] = value
        else:
            given += [name, value]
    status, _, err = told("site", *given, "-o", "wrong")
    lines = [line for line in err.splitlines() if "note: " not in line]
    assert status == 2 and len(lines) == 1 and message in lines[0]
    assert not (gis / "wrong" / site_deck.NAME).exists()
    for path in (gis / "wrong").glob("*") if (gis / "wrong").exists() else ():
        path.unlink()


@pytest.mark.parametrize("words", [["study", "tmp", "--paper"], ["study", "tmp", "--known", "rockfalls"],
                                   ["study", "tmp", "--set", "rolling=0"], ["export", "tmp", "--zones", "0.5"],
                                   ["report", "tmp", "--pdf"], ["site", "tmp", "--depth", "3"]])
def test_options_of_a_mass_are_refused(made, told, words):
    status, _, err = told(*words)
    assert status == 2 and err.count("\n") == 1 and f"{words[2]}: must not be given with a site of single blocks" in err


def test_options_of_blocks_are_refused_for_a_mass(told):
    status, _, err = told("site", "--terrain", "dem.tif", "--release", "cliff.geojson", "--depth", "2", "--speed", "3",
                          "-o", "mass")
    assert status == 2 and "--speed: must be given with --blocks" in err


# --- results, against what the runs wrote ---

def test_blocks_are_counted_not_crossings(made):
    """Of each run by its files: ends, those that came onto the road and beyond it, the largest of each block."""
    for run in made.known.runs:
        [(_, end)] = runs.dumps.frames(run.folder / "end.dump")
        there = end[:, 0].astype(int) - 1
        assert np.array_equal(np.flatnonzero(~run.left), there) and run.end[there] == pytest.approx(end[:, 1:3])
        touched = edges.touched(Polygon(ROAD), 1.2, made.known.terrain.raster)
        west, _, east, _ = touched.bounds
        inward = [row for row in rows_of(run.folder / "site.road_edge_1.line.csv") if row["direction"] == "1"]
        assert {int(row["ball"]) - 1 for row in inward} == set(np.flatnonzero(run.reached))
        assert (run.reached >= (run.end[:, 0] < east)).all() and (run.passed >= (run.end[:, 0] < west)).all()
        assert not (run.passed & ~run.reached).any()
        for line in ("fence", "road_edge_1"):
            place = runs.AT_ROAD if line == "road_edge_1" else line
            of = rows_of(run.folder / f"site.{line}.line.csv")
            for k in range(len(run.left)):
                mine = [row for row in of if int(row["ball"]) == k + 1
                        and (line == "fence" or row["direction"] == "1")]
                if not mine:
                    assert np.isnan(run.at[place]["energy"][k])
                    continue
                assert run.at[place]["energy"][k] == max(float(row["energy"]) for row in mine)
                assert run.at[place]["height"][k] == pytest.approx(max(float(row["height"]) for row in mine)
                                                                   - float(mine[0]["diameter"]) / 2)


EVERY = "id x y z vx vy vz fx fy fz omegax omegay omegaz tqx tqy tqz radius mass"


def test_energies_at_a_line_are_those_of_dumps_of_every_step(made, tmp_path):
    """At the half step: the velocities of the step before, moved on by half a step of its forces and torques."""
    for path in made.known.runs[0].folder.glob("*.*"):
        if path.suffix in (".asc", ".csv", ".data", ".site"):
            shutil.copy(path, tmp_path)
    deck = (made.folder / site_deck.NAME).read_text().split("variable    steps")
    every = f"dump every all custom 1 every.dump {EVERY}\ndump_modify every sort id format float %20.16g\n"
    (tmp_path / "in.every").write_text(f"{deck[0]}{every}variable    steps{deck[1]}")
    subprocess.run([LMP, "-in", "in.every", "-log", "none", "-screen", "none", "-var", "rolling", "0.1", "-var",
                    "duration", "6", "-var", "start", "4"], cwd=tmp_path, check=True)
    found = runs.read_block_run("every", tmp_path, {"rolling": "0.1", "ground": "1"}, made.known.terrain)
    dt = yaml.safe_load((tmp_path / "site.summary.yaml").read_text())["dt"]
    most = np.full(len(found.diameter), np.nan)
    before = {}
    for part in (tmp_path / "every.dump").read_text().split("ITEM: ATOMS ")[1:]:
        now = {}
        for line in part.split("ITEM:")[0].splitlines()[1:]:
            ball, *numbers = map(float, line.split())
            at, v, f, spin, torque, (radius, mass) = np.split(np.array(numbers), [3, 6, 9, 12, 15])
            now[ball] = at[0]
            if ball in before and (before[ball][0] - 42) * (at[0] - 42) < 0:
                most[int(ball) - 1] = np.fmax(most[int(ball) - 1], before[ball][1])
            half, turn = v + dt / 2 * f / mass, spin + dt / 2 * torque / (0.4 * mass * radius ** 2)
            now[ball] = at[0], 0.5 * mass * (half @ half + 0.4 * radius ** 2 * turn @ turn)
        before = now
    assert np.isfinite(most).sum() >= 5
    assert found.at["fence"]["energy"] == pytest.approx(most, rel=1e-6, nan_ok=True)


def test_travel_is_along_and_across_the_fall_line(made):
    run = made.known.runs[0]
    way = run.end - run.start[:, :2]
    assert run.travel["along"] == pytest.approx(-way[:, 0], abs=1e-2)       # down is to the west
    assert run.travel["across"] == pytest.approx(-way[:, 1], abs=1e-2)
    assert run.travel["distance"] == pytest.approx(np.hypot(*way.T))


def test_more_reach_the_road_with_the_smaller_resistance(made):
    of = made.known.outcome
    assert [one.rolling for one in of.results] == ["0.1", "0.4"] and of.worst["reach"].rolling == "0.1"
    assert of.results[0].reach.seen > of.results[1].reach.seen
    assert of.another == withheld.exceeded_at_most(3)
    assert of.worst["road_energy_95"].rolling == of.worst["crossed_fence"].rolling == "0.1"


def test_a_ditch_at_the_foot_keeps_what_ends_on_the_slope_or_near_it(made):
    """The foot is at x = 40, the road begins at 33: by hand from blocks.csv, along the ways of the blocks."""
    of = made.known.outcome
    rows = rows_of(made.folder / "study" / files.RETAINED)
    assert [float(row["ditch_m"]) for row in rows if row["rolling"] == "0.1"] == list(of.widths)
    for run in made.known.runs:
        way = run.end - run.start[:, :2]
        by_hand = np.maximum(0, (TOE - run.end[:, 0]) / np.maximum(-way[:, 0], 1e-9) * np.hypot(*way.T))
        assert run.travel["beyond_foot"] == pytest.approx(by_hand, abs=CELL)
    assert of.to_road == pytest.approx(TOE - 33, abs=1.5)
    ended = [row for row in rows_of(made.folder / "study" / files.BLOCKS) if row["rolling"] == "0.1"]
    assert not any(int(row["moving"]) for row in ended)
    for row in rows[:len(of.widths):3]:
        kept = np.mean([not int(one["left"]) and float(one["beyond_foot_m"]) <= float(row["ditch_m"]) + 1e-6
                        for one in ended])
        assert float(row["retained_percent"]) == pytest.approx(100 * kept)      # none left over the summit
        assert float(row["low"]) <= float(row["retained_percent"]) <= float(row["high"])


def test_files(made):
    about = yaml.safe_load((made.folder / "study" / files.RESULTS).read_text())
    assert about["worst"]["reach"]["rolling"] == "0.1" and about["results"][0]["reach"]["blocks"] == 30
    rows = rows_of(made.folder / "study" / files.BLOCKS)
    assert len(rows) == 60
    reached = sum(int(row["reached_road"]) for row in rows if row["rolling"] == "0.1")
    assert reached == about["results"][0]["reach"]["seen"]
    with fiona.open(made.folder / "study" / files.GIS, layer="paths") as paths:
        assert len(paths) == 60 and paths.crs["init"] == "epsg:6677"
        first = next(iter(paths))
        start = made.known.runs[0].start[0]
        assert first["geometry"]["coordinates"][0] == pytest.approx(start + (EAST, NORTH, 0), abs=1e-3)
    with fiona.open(made.folder / "study" / files.GIS, layer="ends") as ends:
        assert [(one["properties"]["rolling"], one["properties"]["reached"]) for one in ends] == [
            (float(row["rolling"]), int(row["reached_road"])) for row in rows]
    for name in files.LARGEST:
        with rasterio.open(made.folder / "study" / f"{name}.tif") as found:
            most = max(np.nanmax(runs.rasters.read_raster(one.folder / f"site.{name}.asc", heights=False).z)
                       for one in made.known.runs)
            assert found.read(1).max() == pytest.approx(most)


def test_the_page_begins_with_the_share_that_reaches_the_road(made):
    text = (made.folder / page.NAME).read_text(encoding="utf-8")
    first = text[text.index("<strong>"):text.index("</strong>")]
    assert made.known.outcome.worst["reach"].value.text in first and "reach the road" in first
    assert text.index("<strong>") < text.index("at its near edge".capitalize()) < text.index("<table")
    assert 'id="scene"' in text and "Blocks in three dimensions" in text


def test_export_and_report_again(made, told):
    status, out, err = told("export", "tmp")
    assert status == 0 and "blocks.gpkg" in out, err
    assert {path.name for path in (made.folder / "export").iterdir()} == {*files.NAMES, "export.yaml"}
    status, out, err = told("report", "tmp", "-o", "again.html")
    assert status == 0 and "again.html" in out, err


def test_files_for_paraview_are_of_the_run_with_the_farthest_block(made, told, monkeypatch, tmp_path):
    (tmp_path / "stand-in").write_text(f"#!/bin/sh\necho $* > {tmp_path}/words\n")
    (tmp_path / "stand-in").chmod(0o755)
    monkeypatch.setenv("DUMP2VTK", str(tmp_path / "stand-in"))
    status, out, err = told("vtk", "tmp")
    assert status == 0 and "tmp/vtk/site.pvd" in out, err
    name = runs.find_farthest_run(made.known.runs).name
    words = (tmp_path / "words").read_text().split()
    assert words[0].endswith(f"{made.folder.name}/runs/{name}/site.00000000.dump")
    assert words[words.index("--deposit") + 1].endswith(f"/{name}/site")


@pytest.mark.parametrize("words", [["report", "tmp", "-o", "again.html"], ["export", "tmp"], ["study", "tmp"]])
def test_runs_of_other_choices_are_no_answer(made, told, words):
    """Of a site whose site.yaml was changed since, until it is rebuilt."""
    path = made.folder / "site.yaml"
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub(r"density: .*", "density: 2000", text, count=1), encoding="utf-8")
    try:
        status, _, err = told(*words)
    finally:
        path.write_text(text, encoding="utf-8")
    assert status == 2 and "site.yaml: must not have been changed since" in err, err


def test_edges_and_runs_follow_the_road_of_the_folder(made, told, gis):
    """A site whose road.csv was moved by 2 m, then has a second polygon, which the deck does not count at."""
    folder = gis / "edited"
    shutil.copytree(made.folder, folder)
    road, edge, said = folder / "road.csv", folder / "road_edge_1.csv", []
    before, text = edge.read_text(), road.read_text()
    road.write_text(re.sub(r"^28\b", "26", re.sub(r"^33\b", "31", text, flags=re.MULTILINE), flags=re.MULTILINE))
    for command in ("report", "export"):
        status, _, err = told(command, "edited", "-o", f"moved.{'html' * (command == 'report')}")
        assert status == 2 and err.count("\n") == 1 and "edited/road.csv: must be the road" in err, err
    site_folder = site_choices.load_kind(folder, OfBlocks)
    planned, setup = study.plan_block_runs(site_folder), Setup(folder / site_deck.NAME, folder, tell=said.append)
    assert study.follow_road(site_folder, planned, setup._replace(dry_run=True)).anew and edge.read_text() == before
    assert study.follow_road(site_folder, planned, setup).anew and len(said) == 2 and " 6 " in said[1]
    low, high = np.loadtxt(edge, delimiter=",")[:, 0].min(), np.loadtxt(edge, delimiter=",")[:, 0].max()
    assert (low, high) == pytest.approx((26 - 0.6, 31 + 0.6))
    status, out, err = told("study", "edited", "--dry-run")
    assert status == 0 and out.count(", made again\n") == 6, err
    assert not study.follow_road(made.site, study.plan_block_runs(made.site), setup).anew
    road.write_text(f"{text}\n10.0,10.0\n12.0,10.0\n12.0,12.0\n")
    status, _, err = told("study", "edited")
    assert status == 2 and err.count("\n") == 1 and "edited/road.csv: must have 1 edges" in err and "got 2" in err, err


def test_another_file_of_the_road_needs_another_deck(made, told):
    """Sections that blocks do not have are not named."""
    path = made.folder / "site.yaml"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("file: ../road.geojson", "file: ../cliff.geojson"), encoding="utf-8")
    try:
        status, _, err = told("study", "tmp")
    finally:
        path.write_text(text, encoding="utf-8")
    assert status == 2 and err.count("\n") == 1 and "site.yaml: must not have been changed since" in err
    assert "known" not in err and "but for the files" in err


# --- shares and their bounds ---

def a_run(ground, reached, left=None, rolling="0.1", ahead=True):
    """Blocks of which those in `reached` come to the road; ahead: it may be, of those that left the terrain."""
    n = len(reached)
    zeros = np.zeros(n)
    reached, left = np.array(reached, bool), np.zeros(n, bool) if left is None else np.array(left, bool)
    at = {runs.AT_ROAD: {name: np.where(reached, 1.0, np.nan) for name in runs.QUANTITIES}}
    travel = {name: np.arange(n) + ground for name in ("distance", "along", "across", "beyond_foot")}
    return runs.Run("a", None, rolling, ground, zeros, np.zeros((n, 3)), np.zeros((n, 2)), left, zeros.astype(bool),
                    reached, reached, left & (not ahead), {runs.AT_ROAD: left & ahead}, at, travel,
                    np.full(n, 4.0), 0.1)


def test_every_number_is_the_worst_over_all_rolling_resistances_and_says_which_one_has_it():
    """One block more reaches the road with 0.2; more pass it and one goes farther with 0.1; the hardest is of 0.3,
    whose median is not the largest."""
    def some(rolling, reached, passed, farther, energies):
        one = a_run(0, [1] * reached + [0] * (10 - reached), rolling=rolling)
        at = {**one.at[runs.AT_ROAD], "energy": np.where(one.reached, np.resize(energies, 10), np.nan)}
        return replace(one, name=rolling, passed=np.arange(10) < passed, at={runs.AT_ROAD: at},
                       travel={**one.travel, "distance": one.travel["distance"] + farther})
    every = [replace(one, ground=ground) for ground in range(3) for one in (
        some("0.1", 4, 4, np.eye(10)[9] * 50, [5e3]), some("0.2", 5, 2, 0, [7e3]),
        some("0.3", 3, 1, 3, [9e3] + [1e3] * 9))]
    of = outcome.evaluate_blocks(every)
    whose = {name: one.rolling for name, one in of.worst.items()}
    assert {name: whose[name] for name in ("reach", "past", "distance_50", "distance_largest", "road_energy_50",
                                           "road_energy_largest")} == {
        "reach": "0.2", "past": "0.1", "distance_50": "0.3", "distance_largest": "0.1", "road_energy_50": "0.2",
        "road_energy_largest": "0.3"}
    assert (of.worst["past"].value.share, of.worst["distance_largest"].value) == (0.4, 59)
    assert of.about()["worst"]["past"]["value"]["share"] == 0.4
    assert runs.find_farthest_run(every).rolling == "0.1"
    first, at_edge, far, _ = page.sentences(SimpleNamespace(outcome=of))
    for text, numbers in ((first, [("50 %", "0.2"), ("40 %", "0.1")]), (at_edge, [("9.00 kJ", "0.3")]),
                          (far, [("7.00 m", "0.3"), ("59.0 m", "0.1")])):
        for number, rolling in numbers:
            assert re.search(rf"{number}[^(]*(\(\d[^)]*\)[^(]*)?\(rolling resistance {rolling}\)", text), text


def test_a_bound_of_blocks_that_left_is_said_though_fewer_were_seen_to_reach():
    """With 0.1 fewer reach the road, but half of the blocks left the terrain before it."""
    of = outcome.evaluate_blocks([one for ground in range(10) for one in (
        a_run(ground, [1, 1, 1, 0, 0, 0, 0, 0], rolling="0.2"),
        a_run(ground, [1, 1, 0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1, 1, 1, 1], rolling="0.1"))])
    assert of.worst["reach"].rolling == "0.2" and of.at_least
    bound = [text for text in page.sentences(SimpleNamespace(outcome=of)) if "0.1" in text]
    high = next(one.reach.high for one in of.results if one.rolling == "0.1")
    assert len([text for text in bound if digits.percent(high) in text]) == 1 and high > of.worst["reach"].value.high


def test_the_path_of_the_farthest_block_is_among_those_that_are_shown(made, monkeypatch):
    """Its third block, of the last run, with the larger rolling resistance: of fewer paths than runs, and of more."""
    *others, last = made.known.runs
    last = replace(last, travel={"distance": 1e3 * (np.arange(10) == 2)})
    for shown, number in ((4, 4), (12, 12)):
        monkeypatch.setattr(files, "SHOWN", shown)
        found = [(run.rolling, run.ground, block) for run, block, _ in files.paths([*others, last])]
        assert len(found) == number and ("0.4", 3, 3) in found and {rolling for rolling, *_ in found} == {"0.1", "0.4"}


def test_neither_none_nor_all_that_reach_are_certain():
    of = outcome.evaluate_blocks([a_run(ground, [0] * 100) for ground in range(10)])
    reach = of.results[0].reach
    assert reach.seen == 0 and reach.high == pytest.approx(withheld.exceeded_at_most(10))
    assert reach.text == f"at most {digits.percent(reach.high)}" == "at most 26 %"
    text = next(page.sentences(SimpleNamespace(outcome=of)))
    assert text.startswith("none of the blocks") and "1,000 blocks" in text
    assert "chance leaves at most 26 % possible" in text
    every = outcome.evaluate_blocks([a_run(ground, [1] * 100) for ground in range(10)])
    assert every.results[0].reach.text == "at least 74 %"


@pytest.mark.parametrize("number", [1, 2, 5])
def test_a_few_that_reach_bound_no_less_than_none(number):
    """A few blocks of one of ten grounds: another ground may bring as many as after none."""
    few = [a_run(ground, [1] * number * (ground == 1) + [0] * (100 - number * (ground == 1))) for ground in range(10)]
    reach = outcome.evaluate_blocks(few).results[0].reach
    assert reach.seen == number and reach.high >= withheld.exceeded_at_most(10) > 0.2


def test_blocks_of_a_ground_count_together():
    """Half of the grounds let all pass: that is not 500 of 1,000 independent blocks."""
    together = outcome.evaluate_blocks([a_run(ground, [ground % 2] * 100) for ground in range(10)]).results[0].reach
    apart = outcome.evaluate_blocks([a_run(ground, [0, 1] * 50) for ground in range(10)]).results[0].reach
    assert together.share == apart.share == 0.5
    assert together.high - together.low > 0.4 and apart.high - apart.low < 0.06


def test_blocks_that_left_make_it_at_least():
    of = outcome.evaluate_blocks([a_run(ground, [1, 0, 0, 0], [0, 1, 0, 0]) for ground in range(10)])
    reach = of.results[0].reach
    assert reach.share == 0.25 and reach.open == 10 and reach.high > 0.5 > reach.low
    assert reach.text.startswith("at least 25 %") and of.at_least == "at least "
    assert [one.kind for one in of.doubts()] == ["blocks left"]
    away = outcome.evaluate_blocks([a_run(ground, [1, 0, 0, 0], [0, 1, 0, 0], ahead=False) for ground in range(10)])
    one = away.results[0]
    assert one.reach.open == one.past.open == 0 and one.reach.high < 0.5 and one.away == 10
    assert away.at_least == "at least " and away.doubts()[0].numbers["away"] == 10       # how far they go
    none = outcome.evaluate_blocks([a_run(ground, [0, 0, 0, 0], [1, 0, 0, 0]) for ground in range(10)]).results[0].reach
    assert none.text.startswith("up to ") and none.high > 0.25


def test_what_left_is_not_retained_unless_no_road_was_ahead():
    """Four blocks that end 0 to 3 m beyond the foot, the second of which left the terrain."""
    for ahead, shares in ((True, [1 / 4, 1 / 4, 2 / 4, 3 / 4]), (False, [2 / 4, 2 / 4, 3 / 4, 1])):
        of = outcome.evaluate_blocks([a_run(0, [0] * 4, [0, 1, 0, 0], ahead=ahead)])
        one = of.results[0]
        by_width = dict(zip(of.widths, one.retained))
        assert [by_width[width].share for width in range(4)] == shares
        assert one.width(0.5, of.widths) == (2 if ahead else 0) and one.width(1, of.widths) == (None if ahead else 3)
        assert by_width[0].open == int(ahead) and of.to_road == 4
    assert outcome.widths_to(0.0) == [0.0] and outcome.widths_to(41) == [2.0 * k for k in range(22)]


def test_the_ditch_is_as_wide_as_the_worst_of_all_rolling_resistances():
    """Blocks end 0 to 3 m beyond the foot with 0.2, 2 to 5 m with 0.1; of a third some left before a road."""
    several = [a_run(0, [0] * 4, rolling="0.2"), a_run(2, [0] * 4, rolling="0.1")]
    rows = page.widths(SimpleNamespace(outcome=outcome.evaluate_blocks(several))).rows
    assert [row[1] for row in rows] == ["1 m (0 m to ?)", "3 m (0 m to ?)", "3 m (0 m to ?)"]
    assert [row[-1] for row in rows] == ["3 m (1 m to ?)", "5 m (3 m to ?)", "5 m (3 m to ?)"]
    several.append(a_run(0, [0] * 4, [1] * 4, rolling="0.3"))
    rows = page.widths(SimpleNamespace(outcome=outcome.evaluate_blocks(several))).rows
    assert [text.split(" (")[0] for row in rows[-2:] for text in row[1:]] == ["> 5 m"] * 10


def test_a_ditch_is_wider_by_its_bound():
    """Grounds with blocks that end 0 to 99 m beyond the foot, each farther by up to 27: of 40, 90 % are bounded, of
    ten nothing is, as none of so few may be the worst: as for what reaches the road."""
    for grounds in (10, 40):
        of = outcome.evaluate_blocks([a_run(27 / grounds * ground, [0] * 100) for ground in range(grounds)])
        one, = of.results
        at, low, high = (one.width(0.9, of.widths, side) for side in ("share", "high", "low"))
        beyond = np.concatenate([np.arange(100) + 27 / grounds * ground for ground in range(grounds)])
        assert np.mean(beyond <= at) >= 0.9 > np.mean(beyond <= at - 5) and low <= at
        assert high is None if grounds == 10 else high > at
        lows = [share.low for share in one.retained]
        assert np.diff(lows).min() > -1e-9 and lows[-1] == pytest.approx(1 - one.reach.high)    # none reaches the road
        assert page.widths(SimpleNamespace(outcome=of)).rows[0][3] == (
            f"{at:g} m ({low:g} m to {'?' if high is None else f'{high:g} m'})")


def test_the_largest_bound_is_said_of_grounds_that_differ_more():
    """Half of the blocks of each ground reach the road with 0.2; with 0.1 all of four grounds of ten."""
    of = outcome.evaluate_blocks([one for ground in range(10) for one in (
        a_run(ground, [0, 1] * 10, rolling="0.2"), a_run(ground, [ground < 4] * 20, rolling="0.1"))])
    high = max(one.reach.high for one in of.results)
    assert of.worst["reach"].rolling == "0.2" and of.worst["reach"].value.high < 0.6 < high
    assert f"up to {digits.percent(high)} may reach it (rolling resistance 0.1)" in " ".join(
        page.sentences(SimpleNamespace(outcome=of)))


def test_the_foot_is_above_the_road_and_below_benches():
    """A bench on the way, and a steep slope below the road; blocks that end on the bench, beyond the foot, below."""
    x = np.arange(100) + 0.5
    steep = (x < 20) | (x > 24) & (x < 40) | (x > 60)
    raster = Raster(np.tile(100 - np.cumsum(np.where(steep, 0.8, 0.05)), (9, 1)), Affine(1, 0, 0, 0, -1, 9), None)
    end = np.array([[23.0, 4.0], [46.0, 4.0], [90.0, 4.0], [2.0, 4.0]])
    start = np.tile([2.0, 4.0], (4, 1))
    found = ditch.feet(raster, start, end, np.array([1.0, 0.0]), box(50, 0, 58, 9))
    assert found.beyond == pytest.approx([0, 6, 50, 0], abs=1) and found.road == pytest.approx([10] * 4, abs=1)
    found = ditch.feet(raster, start[:2], end[:2], np.array([1.0, 0.0]), None)
    assert found.beyond == pytest.approx([0, 6], abs=1) and np.isnan(found.road).all()


def test_blocks_that_stay_where_they_begin_are_counted():
    """Two of the four blocks of ground 0 and one of ground 1 go less than two diameters."""
    grounds = [replace(a_run(ground, [0] * 4, [0] * 4), diameter=np.ones(4)) for ground in range(3)]
    of = outcome.evaluate_blocks(grounds)
    assert [(one.kind, one.numbers["still"], one.numbers["blocks"]) for one in of.doubts()] == [("blocks still", 3, 12)]


def test_a_road_is_ahead_of_a_block_that_leaves_unless_it_is_behind_or_was_passed():
    """North of a road from west to east: over the back of the hill, towards both sides, beyond the road and on it."""
    raster = Raster(np.zeros((40, 40)), Affine(1, 0, 0, 0, -1, 40), None, np.zeros(2))
    released = np.zeros((40, 40), bool)
    released[10, 20] = True
    sides = road_sides.divide(Polygon([(5, 10), (35, 10), (35, 12), (5, 12)]), None, raster, released)
    ends = {(20, 40): False, (30, 40): False, (40, 31): True, (0, 20): True, (20, 0): False, (40, 11): True}
    start, end = np.full((len(ends), 2), (20.0, 30.0)), np.array(list(ends), float)
    assert sides.ahead_of(start, end, sides.of_places(end)).tolist() == list(ends.values())
    left = Gone(np.ones(len(ends)), end, start, np.zeros(len(ends)), "table")
    ground = Ground(raster, raster.z, released, raster.z, {})
    of_mass = passed.sort_by_side(left, sides, ground, np.inf)
    assert of_mass.ahead.tolist() == list(ends.values())


def test_beyond_the_road():
    """By where a block ends, or where it left the road at any time."""
    before, road, past = (Polygon([(a, 0), (b, 0), (b, 9), (a, 9)]) for a, b in ((6, 9), (3, 6), (0, 3)))
    sides = road_sides.Sides(before, road, past, past, past, ())
    crossed = {"x": np.array([6.0, 3.0, 6.0]), "y": np.array([5.0, 5.0, 5.0]), "ball": np.array([1.0, 2.0, 3.0]),
               "direction": np.array([1.0, -1.0, -1.0])}
    ends = np.array([[2.0, 5.0], [4.0, 5.0], [7.0, 5.0]])
    assert runs.beyond_road(crossed, ends, sides).tolist() == [True, True, False]
