"""tools/slope site and slope study FOLDER: from a GeoTIFF and two layers of a GIS to a report; what is refused."""
import csv
import json
import os
import re
import shlex
import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml
from rasterio.warp import transform as warp
from shapely.geometry import LineString, Polygon, mapping

from run_helpers import called, inside, slope, write_tif
from tiny_collapse import LMP, rows_of, TOP

from slope_tools import cli, digits, programs
from slope_tools.case import decks
from slope_tools.commands import study as study_command
from slope_tools.deposits import volume_files
from slope_tools.ensembles import farther
from slope_tools.releases import release_chart
from slope_tools.runs import jobs
from slope_tools.sites import site_budget, site_choices, site_deck, site_trial, site_warnings
from slope_tools.sites.site_sections import OfMass, sections
from slope_tools.sites.site import find_deck_numbers as site_numbers
from slope_tools.errors import SlopeError
from slope_tools.plots import site_map
from slope_tools.studies import letter, size_runs, study
from slope_tools.tables import headline, named_run, study_file
from slope_tools.tables.study_file import load_study

TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
DATA = Path(os.environ.get("SLOPE_DATA", TOP.parent.parent / "shared" / "data"))
EAST, NORTH, CELL, COLUMNS, ROWS = -12000.0, 34000.0, 2.0, 60, 40      # of the survey, m, zone IX of Japan
RELEASE = [(52, 20), (86, 20), (90, 40), (86, 60), (52, 60), (48, 40)]  # local m
ROAD = [(20, 0), (36, 0), (36, 80), (20, 80)]
BALLS = 126         # one of them that leaves the terrain is less than the 1 % which withhold a number


def height(x):
    """Of the ground, m: level, a face of 31 degrees, a plateau."""
    return np.interp(x, [0, 40, 100, 120], [0.0, 0.0, 36.0, 37.0])


def write_dem(path, crs="EPSG:6677", z=None):
    if z is None:
        z = np.broadcast_to(100 + height((np.arange(COLUMNS) + 0.5) * CELL), (ROWS, COLUMNS))
    write_tif(path, z, CELL, crs=crs)


def write_layer(path, points, crs="EPSG:6677", kind=Polygon):
    """Points in local metres as GeoJSON in a CRS; None: a shapefile's part of none is made by the caller."""
    points = np.array(points, float) + (EAST, NORTH)
    if crs != "EPSG:6677":
        points = np.transpose(warp("EPSG:6677", crs, *points.T))
    about = {"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {},
                                                        "geometry": mapping(kind(points))}]}
    if crs != "EPSG:4326":
        about["crs"] = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{crs.split(':')[1]}"}}
    path.write_text(json.dumps(about))


def write_wall(path, x=38.0, low=(30, 50)):
    """A wall of two triangles, binary STL, in local metres."""
    a, b = (x, low[0], 98), (x, low[1], 98)
    c, d = (x, low[1], 104), (x, low[0], 104)
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *one, *two, *three, 0)
                       for one, two, three in ((a, b, c), (a, c, d)))
    path.write_bytes(b"\0" * 80 + struct.pack("<I", 2) + records)


def work_in(folder, patch):
    """In the folder of the GIS files, without a LAMMPS program, and without the pictures, which take longest."""
    patch.chdir(folder)
    patch.delenv("LMP", raising=False)
    patch.setattr(programs, "BESIDE", folder / "nowhere")
    for module, name in ((release_chart, "draw_release"), (site_map, "draw_site_map")):
        patch.setattr(module, name, lambda path, *_: Path(path).write_bytes(b""))


@pytest.fixture
def told(gis, monkeypatch, capsys):
    """`slope site WORDS` there, in this process; gives status, stdout, stderr."""
    work_in(gis, monkeypatch)
    return lambda *words: called(capsys, ["site", *map(str, words)])


def make(folder, *words, run=slope):
    """A site in folder/mine from the standard files; more words may follow."""
    return run(folder, "site", "--terrain", "dem.tif", "--release", "release.geojson", *words, "-o", "mine")


def make_mine():
    """The site mine with a body and a road, from the standard files in the working folder, in this process."""
    assert cli.main(["site", "--terrain", "dem.tif", "--release", "release.geojson", *BODY, "--road", "road.geojson",
                     "-o", "mine"]) == 0


def write_files(folder):
    """dem.tif, release.geojson (in degrees), road.geojson."""
    write_dem(folder / "dem.tif")
    write_layer(folder / "release.geojson", RELEASE, "EPSG:4326")
    write_layer(folder / "road.geojson", ROAD)


@pytest.fixture
def gis(tmp_path):
    """The folder with these files."""
    write_files(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """The two commands of a new user, of the sweep alone; gives the folder and what both printed."""
    folder = tmp_path_factory.mktemp("site")
    write_files(folder)
    first = make(folder, "--shape", "ellipsoid", "--depth", "5", "--road", "road.geojson", "--balls", BALLS,
                 "--author", "A. N. Engineer")
    assert first.returncode == 0, first.stderr
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LMP", str(Path(LMP).absolute()))
        patch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())      # of each run: they take longest
        second = inside(folder, "study", "mine", "--paper", "--levels", "1")
    assert second.returncode == 0, second.stderr
    return folder, first.stdout, second.stdout


# --- two commands ---

def test_two_commands_lead_from_gis_files_to_a_report(done):
    folder, first, second = done
    mine = folder / "mine"
    for name in ("terrain.asc", "release.slip.asc", "release.csv", "road.csv", "in.site", "site.yaml", "map.png",
                 "release.png", "report.html"):
        assert (mine / name).stat().st_size > 0, name
    study = yaml.safe_load((mine / "study" / "study.yaml").read_text())
    assert study["study"]["body"] == ".."
    assert study["study"]["finished"] == 13 and study["study"]["set"] == {"rolling": ["0", "0.05", "0.1"],
                                                                          "spacing": ["0.9", "0.5", "0.7"]}
    best = study["conservative"]
    assert best["kind"] == "prediction" and best["mean_m3"] > 0
    assert study["size"] is None and [one["code"] for one in study["headline"]["reasons"]] == ["size of balls"]
    assert study["headline"]["volume_m3"] == best["rounded"]["volume_m3"]
    assert study["step"]["volume_m3"] > 0 and study["step"]["text"] in second
    assert study["step"]["step"] == 0.75        # half of the deck's own
    # of the mass that a lattice of so few balls makes of the body
    assert all(row["stiffness_number"] == pytest.approx(site_budget.STIFFNESS_NUMBER, rel=0.15)
               for row in study["runs"])
    spent = study["step"]["energy"]
    assert spent["gravity"] > spent["sliding"] > 0
    assert abs(spent["residual"]) < 1e-3 * spent["gravity"] and abs(spent["begin_end"]) < 0.02 * spent["gravity"]
    assert spent["text"] in (mine / "report.html").read_text()
    assert best["withheld"] == [] and best["volume_m3"] > 0 and study["headline"]["kind"] == "open"
    assert "report.html" in second and "conservative" in second
    assert (mine / "report.mp4").exists() == bool(shutil.which("ffmpeg"))
    assert not list(folder.glob(".mine*"))
    assert str(folder) not in (mine / "release.yaml").read_text() + (mine / "site.yaml").read_text()
    about = site_choices.load_site(mine).choices
    assert about.project.author == "A. N. Engineer" and about.balls.number == BALLS
    assert f"{round(site_choices.found(mine).balls)}" in first.replace(",", "")


def test_both_studies_give_one_number(done, tmp_path, monkeypatch, capsys):
    """The sweep's runs are taken over; an ensemble of a few runs beside them; the larger number, in both study.yaml."""
    mine = shutil.copytree(done[0], tmp_path, dirs_exist_ok=True) / "mine"
    pages = []
    (mine / "site.yaml").write_text((mine / "site.yaml").read_text().replace("points: 64", "points: 8"))
    monkeypatch.setattr(farther, "MOST", 0.0)       # runs that are added are tested elsewhere
    monkeypatch.setattr(study_command, "write_site_report", lambda study, page, *_, film=True, quiet=False:
                        pages.append((study.name, page.name, film)))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", LMP)
    assert cli.main(["study", "mine", "--levels", "1"]) == 0
    out = capsys.readouterr().out
    assert "17 of 17 runs are finished already" in out and "for a letter:" in out
    paper, both = (yaml.safe_load((mine / name / "study.yaml").read_text()) for name in ("study", "ensemble"))
    about = both["ensemble"]["known_events"]
    assert about["set"] == "translational_slides:all" and about["events"] == 69 and about["runs"] == 8
    assert paper["study"]["known"] == {"set": None, "confined": "unknown"} and both["study"]["known"] == {
        "set": None, "left_out": [], "confined": "unknown"}
    found = both["headline"]
    assert found == paper["headline"] and found["paper"]["volume_m3"] == (
        paper["conservative"]["volume_m3"] and paper["conservative"]["rounded"]["volume_m3"])
    low, high = found["road"]["reached"]
    assert 0 < low <= high <= 1 and found["road"]["passed"][1] <= high
    assert found["road"]["near_m"] < found["road"]["far_m"]
    assert found["road"]["longest_m"] == max(row["length_m"] for row in (*paper["runs"], *both["runs"]))
    [quantile] = [one for one in about["to_remove"] if one["share"] == 0.95]
    assert found["ensemble"]["volume_m3"] == quantile["value"] and both["size"] is None
    covered = [one["value"] for one in about["to_remove"] if one["value"] is not None][-1:]     # of the largest share
    volumes = [one for one in (found["paper"]["volume_m3"], *covered) if one is not None]
    assert found["kind"] == "open" and found["volume_m3"] == max(volumes) and found["low_m3"] is None
    assert paper["reach"] == both["reach"] and paper["reach"]["source"] == "paper" and paper["reach"]["runs"] == 13
    assert study_file.find_governing_study(mine / "study", mine / "ensemble").name == (
        "study" if found["source"] == "paper" else "ensemble")
    step, = (line.removeprefix("next step: ") for line in out.splitlines() if line.startswith("next step: "))
    assert paper["next_step"] == both["next_step"] and step.startswith(both["next_step"]["text"]) and step.endswith(
        both["next_step"]["command"])
    governing = study_file.find_governing_study(mine / "study", mine / "ensemble")
    words = letter.list_letter_lines(letter.make_letter(load_study(governing / "study.yaml")))
    assert [line for line in out.splitlines() if line in words] == words
    governs, other = ("study", "ensemble") if found["source"] == "paper" else ("ensemble", "study")
    assert pages == [(other, {"study": "paper.html", "ensemble": "ensemble.html"}[other], False),
                     (governs, "report.html", True)]
    # what a second study finds is that of both, or nothing: killed between them, the site says what it said
    before = [(mine / name / "study.yaml").read_bytes() for name in ("study", "ensemble")]
    (mine / "site.yaml").write_text((mine / "site.yaml").read_text().replace("[0, 0.05, 0.1]", "[0, 0.1]"))
    for where, name in ((study_command, "run_deck"), (headline, "make_headline")):
        with monkeypatch.context() as patch:
            patch.setattr(where, name, fails)
            assert cli.main(["study", "mine", "--levels", "1"]) == 2
        assert before == [(mine / name / "study.yaml").read_bytes() for name in ("study", "ensemble")]
    # a first study, too: the sweep's number alone is never the site's
    for name in ("study", "ensemble"):
        (mine / name / "study.yaml").unlink()
    for how, says in ((fails, "x: must fail"), (no_run_finishes, "mine: must have an ensemble for its number")):
        with monkeypatch.context() as patch:
            patch.setattr(study_command, "run_deck", how)
            assert cli.main(["study", "mine", "--levels", "1"]) == 2
        assert says in capsys.readouterr().err
        for command in (["report", "mine"], ["export", "mine", "-o", "gis"], ["export", "mine", "--zones", "0.5"]):
            assert cli.main(command) == 2
            assert "must hold the study of this site" in capsys.readouterr().err
        assert not list(mine.glob("*/study.yaml"))


def no_run_finishes(*_, **__):
    raise study.RunsFailed("ensemble", "8 of 8 runs failed")


def fails(*_, **__):
    raise SlopeError("x", "must fail")


def test_the_report_of_a_sites_folder(done, tmp_path, blank_pictures):
    blank_pictures()
    made = inside(done[0], "report", "mine", "--no-film", "-o", tmp_path / "again.html")
    assert made.returncode == 0 and (tmp_path / "again.html").stat().st_size > 0, made.stderr
    bare = tmp_path / "bare"
    bare.mkdir()
    shutil.copy(done[0] / "mine" / "site.yaml", bare)
    found = inside(tmp_path, "report", "bare")
    assert found.returncode == 2 and found.stderr.startswith("slope report: bare: must hold the study of this site")
    assert "slope study bare" in found.stderr and [path.name for path in bare.iterdir()] == ["site.yaml"]


def test_the_page_of_a_site_and_its_scenarios(done, tmp_path, blank_pictures):
    """Beside its report: what each releases and says, and the outlines; a file of the user's of that name stays."""
    blank_pictures()
    mine = shutil.copytree(done[0], tmp_path, dirs_exist_ok=True) / "mine"
    assert not (mine / "scenarios.html").exists()
    made = inside(tmp_path, "site", "mine", "--scenario", "small", "--volume", "800")
    assert made.returncode == 0, made.stderr
    made = inside(tmp_path, "report", "mine", "--no-film")
    assert made.returncode == 0 and "mine/scenarios.html: the site and its 1 scenarios" in made.stdout, made.stderr
    page = (mine / "scenarios.html").read_text(encoding="utf-8")
    volume = digits.rounded(site_choices.found(mine).body.volume, 4)
    for words in ("not studied as it is", "volume 800", ">small<", f">{volume}<", "<li>small: ", "data:image/png",
                  "Outlines of the deposits"):
        assert words in page, words
    made = inside(tmp_path, "site", "mine", "--scenario", "steep", "--cut-angle", "45")
    assert made.returncode == 0, made.stderr
    for name in ("small", "steep"):         # runs of the site are as those of a scenario of the same body
        for part in ("study", "runs"):
            shutil.copytree(mine / part, mine / "scenarios" / name / part)
    assert inside(tmp_path, "report", "mine", "--no-film").returncode == 0
    page = (mine / "scenarios.html").read_text(encoding="utf-8")
    assert page.count("not studied as it is") == 1
    assert re.search(r">small<(?:(?!</tr>).)*not studied as it is", page, re.DOTALL)
    (mine / "scenarios.html").write_text("of the user\n")
    found = inside(tmp_path, "report", "mine", "--no-film")
    assert found.returncode == 2 and "scenarios.html must be" in found.stderr.splitlines()[-1]


def test_a_site_has_one_number_of_three_sizes_of_balls(tmp_path, monkeypatch, capsys):
    """Points of both studies share the runs with finer balls; the same number when it is repeated."""
    write_files(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", LMP)
    monkeypatch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())
    monkeypatch.setattr(study_command, "write_site_report", lambda *_, **__: None)
    monkeypatch.setattr(jobs, "busy", lambda: 99)        # no run has two ranks: other tests run beside this one
    monkeypatch.setattr(farther, "MOST", 0.0)
    monkeypatch.setattr(site_budget, "LEAST", (4, 2))
    monkeypatch.setattr(site_budget, "ENOUGH", (4, 2))
    monkeypatch.setattr(site_budget, "PAIRS", (4, 2))
    assert cli.main(["site", "--terrain", "dem.tif", "--release", "release.geojson", *BODY, "--road", "road.geojson",
                     "--balls", "12", "--rolling", "0", "0.1", "-o", "mine"]) == 0
    mine = tmp_path / "mine"
    text = (mine / "site.yaml").read_text()
    for key, value in (("spacing", "[]"), ("packing", "[2]"), ("largest_restitution", "null"), ("points", "8"),
                       ("levels", "3")):
        before, _, after = text.partition("\nstudy:")
        text = before + "\nstudy:" + re.sub(rf"(?m)^  {key}: [^#]*#", f"  {key}: {value}    #", after, count=1)
    (mine / "site.yaml").write_text(text)
    assert cli.main(["study", "mine"]) == 0, capsys.readouterr().err
    out = capsys.readouterr().out
    abouts = {name: yaml.safe_load((mine / name / "study.yaml").read_text()) for name in ("study", "ensemble")}
    made = [path.name for path in runs_in(mine / "runs")]
    finer = sum("_d_" in name for name in made)
    assert len(made) == 4 + 1 + 8 + finer and 4 + 2 < finer <= 4 + 2 + 2 * size_runs.MORE    # on which numbers rest
    assert abouts["study"]["size"]["effects"] == abouts["ensemble"]["size"]["effects"]
    coarse, half, quarter = (one["runs"] for one in abouts["study"]["size"]["sizes"])
    assert coarse == 12 and half >= quarter > 2 and half + quarter == finer     # each of the finest is a pair
    points = [row for about in abouts.values() for row in about["runs"]]
    assert len(points) == 12 and sum("_d_" in row["run"] for row in points) >= 4
    raw = {row["run"]: float(row["length_m"]) for name in abouts for row in rows_of(mine / name / "levels.csv")}
    finest = min(float(row["variables"]["d"]) for row in points)
    for row in points:
        low, high = row["bands"]["length_m"]
        assert low <= row["length_m"] <= high
        if float(row["variables"]["d"]) == finest:
            assert row["length_m"] == pytest.approx(raw[row["run"]]) and low == high
    for name, about in abouts.items():      # what page 1 shows is a run of the finest balls
        shown = named_run.governing(load_study(mine / name / "study.yaml"))
        assert [float(row["variables"]["d"]) for row in about["runs"] if row["run"] == shown] == [finest]
    number = abouts["study"]["headline"]
    assert number == abouts["ensemble"]["headline"] and "finer balls: 4 points" in out
    if number["kind"] == "number":
        assert number["low_m3"] < number["volume_m3"] < number["high_m3"] and len(number["band"]) >= 3
    before = {path: path.stat().st_mtime_ns for path in mine.rglob("finished.yaml")}
    assert cli.main(["study", "mine"]) == 0
    assert before == {path: path.stat().st_mtime_ns for path in mine.rglob("finished.yaml")}
    assert yaml.safe_load((mine / "study" / "study.yaml").read_text())["headline"] == number
    # in less time, too: finer runs that are there count
    (mine / "site.yaml").write_text(re.sub(r"(?m)^  levels: 3 ", "  levels: null ", (mine / "site.yaml").read_text()))
    assert cli.main(["study", "mine", "--minutes", "0.001"]) == 0
    assert before == {path: path.stat().st_mtime_ns for path in mine.rglob("finished.yaml")}
    assert yaml.safe_load((mine / "study" / "study.yaml").read_text())["headline"] == number


def test_the_longest_runs_begin_first(done):
    """Half the step; those of the study's own keep their names."""
    begun = [line.split()[1].rstrip(":") for line in done[2].splitlines() if line.endswith(": started")]
    assert len(begun) == 17 and begun[0].startswith("rolling_0.05_step_0.75")
    assert not any("_d_" in name for name in begun)


def test_the_largest_restitution_is_none_of_the_volume(done):
    """Three runs with it, in the table and on the page; the combinations and the volume are of the others."""
    mine = done[0] / "mine"
    about = yaml.safe_load((mine / "study" / "study.yaml").read_text())
    found = about["largest_restitution"]
    assert (found["restitution"], found["rolling"], len(found["runs"]), found["failed"]) == (0.9, "0", 3, [])
    for name in found["runs"]:
        chosen = yaml.safe_load((mine / "runs" / name / "variables.yaml").read_text())["variables"]
        assert (chosen["restitution"], chosen["field_e"], chosen["rolling"]) == ("0.9", "0.9", "0")
    assert not {*found["runs"]} & {row["run"] for row in about["runs"]} and len(about["runs"]) == 13
    assert all("restitution" not in one["set"] for one in about["combinations"])
    for key in ("front_m", "area_m2"):
        reach = found["quantities"][key]
        assert reach["low"] <= reach["mean"] <= reach["high"] and reach["mean"] != reach["usual"]["mean"]
    page = (mine / "report.html").read_text()
    assert digits.typeset(found["text"])[1:] in page
    assert "Reach and area with the most elastic rock" in page
    assert len((mine / "study" / "largest_restitution.csv").read_text().splitlines()) == 1 + 3 + 13


def test_the_study_is_resumed(done, monkeypatch):
    monkeypatch.setattr(study_command, "write_site_report", lambda *_, **__: None)
    monkeypatch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())
    folder, _, _ = done
    before = {path: path.stat().st_mtime_ns for path in (folder / "mine").rglob("finished.yaml")}
    again = inside(folder, "study", "mine", "--paper", "--levels", "1")
    assert again.returncode == 0, again.stderr
    assert len(before) == 17 and "started" not in again.stdout and "17 of 17 runs are finished already" in again.stdout
    assert before == {path: path.stat().st_mtime_ns for path in before}


def runs_in(folder):
    return [path for path in folder.iterdir() if not path.name.startswith(".")]


def test_no_run_is_made_twice(done):
    values = [yaml.safe_load((path / "variables.yaml").read_text())["variables"]
              for path in runs_in(done[0] / "mine" / "runs")]
    assert len({tuple(sorted(one.items())) for one in values}) == len(values) == 17


def test_runs_of_an_older_version_are_taken_over(done, tmp_path, monkeypatch):
    """They were in the folders of the parts, and are left there."""
    monkeypatch.setattr(study_command, "write_site_report", lambda *_, **__: None)
    monkeypatch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())
    mine = shutil.copytree(done[0], tmp_path, dirs_exist_ok=True) / "mine"
    before = {name: (mine / name).read_text() for name in ("study/combinations.csv",)}
    (mine / "step").mkdir()
    for path in runs_in(mine / "runs"):
        part = "step" if "_step_" in path.name else "study"
        path.rename(mine / part / path.name)
    again = inside(tmp_path, "study", "mine", "--paper", "--levels", "1")
    assert again.returncode == 0 and "17 of 17 runs are finished already" in again.stdout, again.stderr
    assert not runs_in(mine / "runs")
    assert before == {name: (mine / name).read_text() for name in before}
    rows = yaml.safe_load((mine / "study" / "study.yaml").read_text())["runs"]
    assert {row["summary"] for row in rows} == {f"{row['run']}/site.summary.yaml" for row in rows}


def test_the_deck_by_hand_gives_the_numbers_of_the_study(done, tmp_path):
    folder, _, _ = done
    hand = tmp_path / "hand"
    hand.mkdir()
    for name in ("in.site", "terrain.asc", "terrain.yaml", "release.slip.asc", "road.csv"):
        shutil.copy(folder / "mine" / name, hand)
    subprocess.run([LMP, "-in", "in.site", "-var", "rolling", "0.05", "-var", "packing", "2"], cwd=hand, check=True,
                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    volume = slope(hand, "volume", "site", "--road", "road.csv", "--cut-angle", "30", "--mesh", "10", "-o", "removal")
    assert volume.returncode == 0, volume.stderr
    by_hand = yaml.safe_load((hand / "removal" / "volume.yaml").read_text())["volume"]
    run = folder / "mine" / "runs" / "rolling_0.05_spacing_0.9_packing_2" / "volume" / "volume.yaml"
    assert by_hand == yaml.safe_load(run.read_text())["volume"] and by_hand["remove"] > 0
    other = folder / "mine" / "runs" / "rolling_0.05_spacing_0.9" / "volume" / "volume.yaml"
    assert by_hand != yaml.safe_load(other.read_text())["volume"]


def test_what_is_released_is_the_body(done):
    folder, first, _ = done
    told = float(re.search(r"^volume (\S+) m3", first, re.MULTILINE)[1].replace(",", ""))
    study = yaml.safe_load((folder / "mine" / "study" / "study.yaml").read_text())
    for row in study["runs"]:
        assert row["released_m3"] == pytest.approx(told, rel=2e-3)
        # those that are lost left over the terrain's edge: none falls between slip balls and field balls
        lines = (folder / "mine" / "study" / row["summary"]).with_name("site.left.csv").read_text().splitlines()
        left = list(csv.DictReader(lines))
        assert row["lost_m3"] == pytest.approx(sum(float(one["volume"]) for one in left))
        assert all(min(abs(float(one[k]) - edge) for k, edge in zip("xxyy", (0, 120, 0, 80))) < 1e-6 for one in left)


def made_of(folder, names):
    """The files, but for the time that a run was measured to take."""
    return {name: re.sub(rb"about .* on one core", b"", (folder / name).read_bytes()) for name in names}


def test_the_folder_is_made_anew_from_its_file(done, tmp_path):
    shutil.copytree(done[0], tmp_path / "copy")
    folder = tmp_path / "copy"
    mine = folder / "mine"
    keep = ("in.site", "terrain.asc", "release.slip.asc", "road.csv")
    before = made_of(mine, keep)
    (mine / "map.png").unlink()
    (mine / "notes.txt").write_text("mine")
    again = inside(folder, "site", "mine")
    assert again.returncode == 0, again.stderr
    assert before == made_of(mine, keep)
    assert (mine / "map.png").exists() and (mine / "notes.txt").read_text() == "mine"
    assert (mine / "study" / "study.yaml").exists() and not list(folder.glob(".mine*"))

    # another choice in the file, and one on the command line
    path = mine / "site.yaml"
    path.write_text(re.sub(r"friction: 30\b", "friction: 25", path.read_text(), count=1))
    again = inside(folder, "site", "mine", "--balls", "300")
    assert again.returncode == 0, again.stderr
    variables = decks.index_variables(mine / "in.site")
    assert variables["friction"] == "25"
    volume = site_choices.found(mine).body.volume
    assert 0.6 * 6 / np.pi * volume / float(variables["d"]) ** 3 == pytest.approx(300, rel=0.02)

    # runs of other values stay, and are not mixed with those of these
    listed = inside(folder, "study", "mine", "--paper", "--levels", "1", "--dry-run")
    assert listed.returncode == 0 and "\n0 of 17 runs are there, 17 to make" in listed.stdout, listed.stderr
    assert listed.stdout.endswith("17 runs, 0 of them finished\n")

    # a deck that was changed by hand is not lost
    deck = mine / "in.site"
    deck.write_text(deck.read_text() + "# mine\n")
    again = inside(folder, "site", "mine")
    assert again.returncode == 2 and re.match(r"slope site: mine/in\.site: must .*changed by hand", again.stderr)
    assert deck.read_text().endswith("# mine\n")


# --- what lies on the terrain ---

@pytest.mark.long
def test_structures_lines_and_a_mapped_deposit(gis):
    write_wall(gis / "wall.stl")
    write_layer(gis / "behind.geojson", [(36, 50), (36, 30)], kind=LineString)
    write_layer(gis / "mapped.geojson", [(25, 25), (60, 25), (60, 55), (25, 55)])
    site = make(gis, "--shape", "ellipsoid", "--depth", "5", "--balls", "60", "--structure", "wall.stl", "--line",
                "behind.geojson", "--observed", "mapped.geojson")
    assert site.returncode == 0, site.stderr
    mine = gis / "mine"
    assert (mine / "behind.csv").read_text().splitlines()[1:] == ["36,50", "36,30"]
    path = mine / "site.yaml"
    text = re.sub(r"rolling: \[.*?\]", "rolling: [0.05]", path.read_text())
    text = re.sub(r"(sizes|spacing): \[.*?\]", r"\1: []", text)
    path.write_text(re.sub(r"([xy])offset: \[.*?\]", r"\1offset: []", text))
    study = slope(gis, "study", "mine", "--paper", "--levels", "1")
    assert study.returncode == 0, study.stderr
    run = mine / "runs" / "rolling_0.05"
    assert "wall" in (mine / "study" / "structures.csv").read_text()
    assert (run / "site.wall.csv").exists() and (run / "site.behind.line.yaml").exists()
    score = yaml.safe_load((mine / "score" / "score.yaml").read_text())
    assert 0 < score["area"]["jaccard"] < 1
    # the same on the page, and of all runs
    about = yaml.safe_load((mine / "study" / "study.yaml").read_text())
    assert about["observed"]["file"] == "../observed.csv"
    overlaps = {one["run"]: one["overlap"] for one in about["runs"]}
    assert overlaps["rolling_0.05"] == pytest.approx(score["area"]["jaccard"])
    assert about["observed"]["best"] == max(overlaps, key=overlaps.get) and len(overlaps) > 1
    assert about["observed"]["area_m2"] == pytest.approx(35 * 30)
    assert "mapped deposit: overlap (Jaccard) " in study.stdout
    assert 'id="mapped"' in (mine / "report.html").read_text(encoding="utf-8")


def test_an_earthquake_sets_the_body_off(gis):
    t = np.arange(0, 4, 0.02)
    rows = "".join(f"{a:.2f} {4 * np.sin(9 * a):.6f} 0 0\n" for a in t)
    (gis / "motion.txt").write_text("# t ax ay az\n" + rows)
    site = make(gis, "--shape", "ellipsoid", "--depth", "5", "--balls", "80", "--motion", "motion.txt")
    assert site.returncode == 0, site.stderr
    deck = (gis / "mine" / "in.site").read_text()
    assert "ground/motion ${motion} scale ${scale}" in deck and "fix         drag" in deck
    variables = decks.index_variables(gis / "mine" / "in.site")
    assert float(variables["peak_friction"]) >= 33 and variables["shaking"] == "3.98"
    found = site_choices.found(gis / "mine").trial
    assert found.rest > 0 and found.balls > 40


@pytest.mark.parametrize("angle, across", [(0, False), (45, False), (75, True), (90, True)])
def test_a_motion_across_the_slope_is_named(told, angle, across):
    """Which falls to the west: of a record with the other component alone."""
    t, way = np.arange(0, 4, 0.02), np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    rows = np.column_stack([t, 4 * np.sin(9 * t)[:, None] * way, 0 * t])
    np.savetxt("motion.txt", rows)
    status, _, err = told("--terrain", "dem.tif", "--release", "release.geojson", *BODY, "--motion", "motion.txt",
                          "-o", "mine")
    assert status == 0 and ("motion.txt: along the direction of sliding, 270 degrees" in err) == across, err


def test_layers_in_other_systems_lie_where_they_belong(done):
    """The release polygon is in degrees, the road in metres: both at the local metres that they were drawn in."""
    mine = done[0] / "mine"
    for name, wanted in (("release.csv", RELEASE), ("road.csv", ROAD)):
        rows = [line for line in (mine / name).read_text().splitlines() if line and not line.startswith("#")]
        points = np.array([[float(value) for value in row.split(",")] for row in rows])
        far = [np.hypot(*(points - one).T).min() for one in wanted]
        assert max(far) < 0.01


@pytest.mark.long
def test_a_volume_of_frank_by_polygon(tmp_path):
    """A body of 1e6 m3 below a polygon on frank's ground: released within 0.2 %, whatever the balls."""
    frank = DATA / "frank" / "Frankslide_topography.asc"
    if not frank.is_file():
        pytest.skip(f"no {frank}: see the README of the data")
    (tmp_path / "release.csv").write_text("900,900\n1300,900\n1300,1300\n900,1300\n")
    site = slope(tmp_path, "site", "--terrain", frank, "--release", "release.csv", "--shape", "slbl", "--volume", "1e6",
                 "--balls", "400", "-o", "mine")
    assert site.returncode == 0, site.stderr
    assert site_choices.found(tmp_path / "mine").body.volume == pytest.approx(1e6, rel=1e-3)
    for d in ("20", "14"):
        subprocess.run([LMP, "-in", "in.site", "-var", "d", d, "-var", "duration", "0.1", "-var", "out", f"d{d}"],
                       cwd=tmp_path / "mine", check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        summary = yaml.safe_load((tmp_path / "mine" / f"d{d}.summary.yaml").read_text())
        assert summary["volume"]["released"] == pytest.approx(1e6, rel=2e-3)


# --- the budget ---

SOIL = site_budget.Soil(2000.0, 5.0, 47.0, 0.9)


def budget(depth=50.0, cost=1e-7, **balls):
    choices = OfMass.of({"terrain": {"files": ["dem.tif"]}, "balls": balls, "model": {"duration": 60.0}})
    trial = site_budget.Trial(800, 3.5, 15.0, True, 13.0, cost, 0.5, 2.0, 0.0)
    return site_budget.size(choices, 35000.0, depth, SOIL, trial, 2, 6144)


def test_the_size_of_the_balls_comes_from_the_budget():
    assert budget(number=2567).diameter == 2.5      # 0.60 of the body is balls
    assert budget(diameter=2.5, number=7).balls == round(0.6 * 35000 / (np.pi / 6 * 2.5 ** 3)) == 2567
    assert budget().balls == pytest.approx(site_budget.DEFAULT, rel=0.02)
    # 1.3 of them over the thickness, at least, unless they are too many
    assert budget(depth=3.9).diameter == 3.0 and budget(depth=0.1).balls == pytest.approx(2000, rel=0.02)
    # time decides how many points run with finer balls
    some, more = budget(minutes=10), budget(minutes=100)
    assert some.balls == more.balls == budget().balls and some.text == budget().text
    assert some.seconds <= 600 < more.seconds <= 6000 and some.most > some.seconds
    assert some.text.count("of the diameter") <= more.text.count("of the diameter")
    small = budget(memory=1.0)
    assert small.gigabytes <= 1.0 and small.balls == pytest.approx((1 - 2 * 0.06) / 2 / 64 / 800e-9, rel=0.03)


def test_the_run_time_in_the_deck_is_that_of_one_run():
    """Set-up, steps and balls: 15 s in steps of 1.5 quarters of sqrt(m/k), of 1 on close ground; more balls
    than stay in the cache save nothing of a step's own time."""
    choices = OfMass.of({"terrain": {"files": ["dem.tif"]}})
    trial = site_budget.Trial(800, 3.5, 15.0, True, 13.0, 1e-7, 0.5, 2.0, 0.0, step=3e-5)
    size = budget(number=2240)
    each = size.balls * (3e-5 / site_budget.CACHED + 1e-7)
    step = 1.5 * 0.25 * 0.05 * size.diameter / 60.0     # at 60 m/s a contact overlaps by a twentieth of the diameter
    found = site_numbers(choices, SOIL._replace(speed=60.0), trial, size)
    assert found.run_seconds == pytest.approx(0.5 + 15 / step * each)
    found = site_numbers(choices, SOIL._replace(speed=60.0, spacing=0.35), trial, size)
    assert found.run_seconds == pytest.approx(0.5 + 1.5 * 15 / step * each)


@pytest.mark.parametrize("d, thick, number", [(1.0, 7.0, 2e4), (0.5, 3.0, 2e4), (1.0, 14.0, 4e4), (0.5, 14.0, 8e4)])
def test_a_slow_mass_has_the_stiffness_that_its_weight_needs(d, thick, number):
    """K times density of the ground, gravity, thickness and diameter; K grows in bodies thicker than 7 balls."""
    mass = 2000 * np.pi / 6 * d ** 3
    kn = number * 2000 * 0.6 * 9.80665 * thick * d
    for speed in (1.0, 10.0):
        soil = site_budget.Soil(2000.0, thick, speed, 0.9)
        assert site_budget.time_step(d, soil) == pytest.approx(1.5 * 0.25 * (mass / kn) ** 0.5)
        assert site_budget.time_step(d, soil._replace(spacing=0.39)) == pytest.approx(0.25 * (mass / kn) ** 0.5)
    assert site_budget.time_step(d, soil._replace(speed=300.0)) < site_budget.time_step(d, soil)


@pytest.mark.parametrize("factor", [10.0, 0.1])
@pytest.mark.parametrize("speed", [3.0, 90.0])
def test_scaled_lengths_have_a_scaled_step(factor, speed):
    """Froude: times and speeds go with the root of the lengths, by weight and by speed."""
    soil = site_budget.Soil(3000.0, 12.0, speed, 0.9)
    other = site_budget.Soil(3000.0, 12.0 * factor, speed * factor ** 0.5, 0.9)
    assert site_budget.time_step(1.5 * factor, other) == pytest.approx(factor ** 0.5 * site_budget.time_step(1.5, soil))


def test_no_speed_is_below_that_of_the_trial_run():
    """Where nothing moves, too, it is larger than 0, as site.yaml wants it; a fast trial counts with a fifth more."""
    trial = site_budget.Trial(800, 3.5, 15.0, True, 0.0, 1e-7, 0.5, 2.0, 0.0)
    assert site_budget.stiff_to(trial) == site_budget.SLOW > 0
    assert site_budget.stiff_to(trial._replace(speed=13.0)) == 16.0


def test_the_finest_points_are_as_many_as_time_allows():
    """By how long the coarse runs of these points took; as many sizes as were planned."""
    trial = site_budget.Trial(800, 3.5, 15.0, True, 13.0, 1e-7, 0.5, 2.0, 0.0)
    wanted = site_budget.Plan(20, 0, False, 0, "")
    time = site_budget.time_of(3.5, 3e4, trial, SOIL, wanted, 2, 40.0)
    planned = size_runs.halved("3.5", site_budget.finer(20, time, 3), time)
    as_planned, longer, endless = (planned.fitted([[rest * time.rest(k)] * 20 for k in (1, 2)]).points
                                   for rest in (1, 2, 99))
    assert as_planned == planned.points and longer[1] < as_planned[1] and endless[1] == site_budget.LEAST[1]
    assert sum(number * time.one(k, 2 * time.rest(k)) for k, number in enumerate(longer, 1)) <= time.whole


@pytest.mark.parametrize("cost, minutes, sizes", [(2e-7, None, 2), (2e-7, 10.0, 1), (5e-7, None, 1)])
def test_a_number_has_the_sizes_that_it_needs_if_they_fit_in_an_hour(cost, minutes, sizes):
    """Where no time is given."""
    trial = site_budget.Trial(800, 3.5, 15.0, True, 13.0, cost, 0.5, 2.0, 0.0)
    time = site_budget.time_of(3.5, 3e4, trial, SOIL, site_budget.Plan(20, 0, False, 0, ""), 2, minutes)
    assert len(site_budget.finer(20, time, None)) == sizes
    took = sum(number * time.one(k, time.rest(k)) for k, number in enumerate(site_budget.within(
        20, lambda _: 1.0, 0.0, 3), 1)) / 2
    assert took > 600 and (took < 3600) == (cost < 5e-7)


def test_a_study_that_takes_long_has_fewer_points_and_larger_balls():
    """Half or a quarter of the points where all would take half of the time; a thin body has balls of more than a
    thousand for no more than that."""
    def runs(size):
        return int(re.search(r"(\d+) runs weighted", size.text).group(1))

    plenty, short, shorter = (budget(depth=0.1, minutes=minutes) for minutes in (200, 12, 1))
    assert [runs(size) for size in (plenty, short, shorter)] == [64, 32, 16]
    assert plenty.balls == short.balls == pytest.approx(2000, rel=0.02)
    assert shorter.balls == pytest.approx(400, rel=0.02)
    assert short.seconds < 12 * 60


def test_a_third_trial_tells_how_late_the_ensemble_rests_and_what_its_step_costs():
    """It has the stiffness of the study: what it takes over what the two others say is what all runs take over that."""
    both = site_budget.Trial(800, 3.5, 15.0, True, 13.0, 1e-7, 0.5, 2.0, 0.0, middle=15.0, step=3e-5)
    third = both._replace(balls=300, rest=90.0, seconds=both.run(3.5, 300, SOIL, 90.0) / 2 + 0.25)
    found = site_trial.corrected(both, third, SOIL)
    assert (found.step, found.cost) == (pytest.approx(1.5e-5), pytest.approx(5e-8))
    assert found.typical == 15.0 < found.finer(2) < found.finer(1) == found.finer(0) < found.of_ensemble == 90.0
    assert found.run(3.5, 300, SOIL, 90.0) == pytest.approx(third.seconds)


def test_a_second_trial_tells_how_long_most_runs_take():
    """At the rolling resistance in the middle; limits and stiffness are by the longest and the fastest."""
    def trial(d, rest, speed=13.0):
        return site_budget.Trial(800, d, rest, True, speed, 1e-7, 0.5, 2.0, 0.0)

    coarse, fine = trial(3.6, 45.0, 21.0), trial(2.4, 26.0)
    both = site_trial.joined(coarse, fine)
    assert (coarse.typical, both.typical, both.rest, both.speed) == (45.0, 26.0, 45.0, 21.0)
    assert site_budget.duration(both) == site_budget.duration(coarse) == 360.0
    assert site_budget.duration(fine._replace(rest=5.0)) == 120.0

    choices = OfMass.of({"terrain": {"files": ["dem.tif"]}, "balls": {"minutes": 1.0}})
    wanted = site_budget.plan_budget(choices)
    took = [site_budget.study_seconds(2.0, 3e4, one, SOIL, wanted, 2, ()) for one in (fine, both)]
    assert took[0] == took[1]


def test_the_second_trial_has_other_balls():
    """Finer for a budget of time, otherwise coarser; none where it would have hardly any."""
    trial = site_budget.Trial(800, 3.6, 45.0, True, 21.0, 1e-7, 0.5, 2.0, 0.0)
    balls = OfMass.of({"balls": {"minutes": 1.0}}).balls
    fine, coarse = pytest.approx(3.6 / 3 ** (1 / 3), rel=2e-3), pytest.approx(3.6 * 3 ** (1 / 3), rel=2e-3)
    assert site_trial.other_diameter(balls, trial) == fine
    assert site_trial.other_diameter(balls, trial._replace(seconds=3.0)) == coarse       # 13 s, more than a fifth
    balls = OfMass.of({"balls": {"minutes": 1.0, "number": 3000}}).balls
    assert site_trial.other_diameter(balls, trial) == coarse
    assert site_trial.other_diameter(balls, trial._replace(balls=299)) is None


@pytest.mark.parametrize("order", [1, -1])
def test_two_trials_tell_what_a_step_costs_and_what_a_ball(order):
    """A step of 30 us and 50 ns for each ball in it: a run with 1,000 balls takes 80 us a step, one with 12,000, which
    are ten times as many as stay in the cache, 900."""
    first, second = (site_budget.Trial(n, 3.6, 45.0, True, 21.0, 30e-6 / n + 50e-9, 0.5, 2.0, 0.0)
                     for n in (800, 266)[::order])
    both = site_trial.joined(first, second)
    assert (both.balls, both.step, both.cost) == (800, pytest.approx(30e-6), pytest.approx(50e-9))
    steps = 45.0 / site_budget.time_step(1.0, SOIL)
    assert both.run(1.0, 1000, SOIL, 45.0) == pytest.approx(0.5 + steps * 80e-6)
    assert both.run(1.0, 12000, SOIL, 45.0) == pytest.approx(0.5 + steps * 900e-6)
    same = site_trial.joined(first, second._replace(cost=first.cost / 2 if order > 0 else first.cost * 2))
    assert same.step >= 0 and same.cost > 0         # noise: nothing is below 0


def test_bins_of_a_small_body_in_a_large_box_are_wide():
    """A thousand for each ball at most, but no wider than five diameters; else those of the list's reach."""
    room, volume = 1300.0 * 1100.0 * 600.0, 50000.0
    side = float(site_deck.bins(room, volume))
    assert 1.2 < side < 5 and room / (side * 2.0) ** 3 == pytest.approx(1000 * volume / 2.0 ** 3, rel=0.01)
    assert site_deck.bins(1000 * room, volume) == "5"
    assert site_deck.bins(1000 * volume * 1.2 ** 3 * 0.99, volume) == ""


@pytest.mark.parametrize("balls, option", [({"memory": 0.01}, "--memory"),
                                           ({"diameter": 1000.0}, "--diameter")])
def test_a_budget_that_cannot_be_kept(balls, option):
    with pytest.raises(SlopeError, match=f"^{option}: must "):
        budget(**balls)


@pytest.mark.parametrize("edge", [36, 55])
def test_a_road_on_the_body_is_warned_of(told, gis, edge):
    write_layer(gis / "wide.geojson", [(20, 0), (edge, 0), (edge, 80), (20, 80)])
    status, _, err = told("--terrain", "dem.tif", "--release", "release.geojson", *BODY, "--road", "wide.geojson",
                          "--balls", 100, "-o", "mine")
    found = [line for line in err.splitlines() if "comes out under the road" in line]
    assert status == 0 and len(found) == (edge > 48), err
    for line in found:
        depth, area = re.search(r"up to (\S+) m below ([\d,]+) m2", line).groups()
        assert 0.5 < float(depth) < 5 and 150 < float(area.replace(",", "")) < 7 * 44
    assert ("under road" in (gis / "mine" / "warnings.yaml").read_text()) == bool(found)


def test_the_time_step_is_the_decks(done):
    """The estimate's time step against that of a run."""
    folder = done[0] / "mine"
    variables = decks.index_variables(folder / "in.site")
    summary = yaml.safe_load((folder / "runs" / "rolling_0_spacing_0.9" / "site.summary.yaml").read_text())
    d, *soil = (float(variables[name]) for name in ("d", "density", "thick", "speed", "spacing"))
    wanted = site_budget.time_step(d, site_budget.Soil(*soil))
    assert summary["dt"] == pytest.approx(wanted, rel=1e-6)
    assert summary["motion"]["rest_share"] == site_deck.REST == float(variables["rest"])


@pytest.mark.parametrize("per_step, skin", [(1e-5, 0.2), (0.0016, 0.2), (0.0036, 0.3), (0.0100, 0.5), (0.0144, 0.6),
                                            (1, 0.6)])
def test_the_skin_of_neighbor_lists_follows_speed_and_step(tmp_path, per_step, skin):
    """By the diameters that the fastest ball moves in a step, as the deck reckons; bins hold what the list reaches."""
    template = (Path(site_deck.__file__).parent / site_deck.TEMPLATE).read_text().replace("{{ bins }}", "1.25")
    rule = re.findall(r"^variable +(?:thicker|skin|reach|wide|bin) .*", template, re.MULTILINE)
    d, speed = 2.5, 40.0
    (tmp_path / "in.skin").write_text("\n".join([
        f"variable d index {d}", f"variable speed index {speed}",
        f"variable dt equal {per_step * d / speed:.17g}", *rule,
        'print "$(v_skin:%.10g) $(v_bin:%.10g)" file skin.txt']) + "\n")
    subprocess.run([LMP, "-in", "in.skin", "-log", "none"], cwd=tmp_path, check=True, stdin=subprocess.DEVNULL,
                   stdout=subprocess.DEVNULL)
    found = [float(word) for word in (tmp_path / "skin.txt").read_text().split()]
    assert found == pytest.approx([skin * d, max(1.25, 1 + skin) * d], rel=1e-6)


# --- bad input: one line that names file, item, rule and value; no folder ---

def refused(done, start):
    """Whether it ended with status 2 and one line that begins so."""
    assert done.returncode == 2, done.stdout + done.stderr
    last = done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr
    assert re.match(f"slope (site|study): {start}", last), last
    return last


BODY = ("--shape", "ellipsoid", "--depth", "5")


@pytest.mark.parametrize("words, start", [
    ((), "--depth: must be given .*--volume"),
    ((*BODY, "--name", "x" * 201), "--name: must be one line of at most 200 letters"),
    ((*BODY, "--author", "a\nb"), "--author: must be one line"),
    (("--shape", "ellipsoid", "--volume", "1e9"), "--volume: must be at most .*got 1000000000"),
    ((*BODY, "--cut-angle", "95"), "--cut-angle: must be < 90, got 95"),
    ((*BODY, "--minutes", "0"), "--minutes: must be > 0, got 0"),
    ((*BODY, "--diameter", "500"), "--diameter: must make 1 to .* balls .*smaller ones, got 0 of 500 m"),
])
def test_refused(gis, words, start):
    done = make(gis, *words, run=inside)
    refused(done, start)
    kept = gis / "mine" / "site.yaml"
    assert not list(gis.glob(".mine*")) and not kept.exists() == (kept.name not in done.stdout)
    assert list(gis.glob("mine/*")) == [kept] * kept.exists()


def test_angles_that_look_like_coefficients_are_asked_about():
    """That of the cut only where there is a road."""
    def asked_about(file, cut_angle):
        choices = OfMass.of({"model": {"friction": 0.5, "slip_friction": 0},
                             "road": {"file": file, "cut_angle": cut_angle}})
        return {one.numbers["option"]: str(one) for one in site_warnings.of_resistance(choices)}
    assert list(asked_about(None, 0.6)) == ["--friction"]
    said = asked_about("road.csv", 0.6)
    assert list(said) == ["--friction", "--cut-angle"] and "A coefficient of 0.6 is 31 degrees" in said["--cut-angle"]
    assert list(asked_about("road.csv", 3)) == ["--friction"]


def test_refused_files(gis):
    def nowhere():
        write_dem(gis / "dem.tif", crs=None)

    def wall():
        write_wall(gis / "wall.stl", x=1e6)

    for spoil, words, start in (
            (wall, ("--structure", "wall.stl"), "wall.stl: must lie within the terrain"),
            (nowhere, (), r"dem.tif: must have a CRS.*\(--crs EPSG:n gives it one\), got none")):
        spoil()
        refused(make(gis, *BODY, *words, run=inside), start)
        assert list(gis.glob("mine/*")) == [gis / "mine" / "site.yaml"] and not list(gis.glob(".mine*"))


def test_a_layer_in_a_wrong_crs(gis):
    """What can be done is named, of slope site's own options; the CRS that was read is, too."""
    write_layer(gis / "release.geojson", RELEASE, "EPSG:6676")
    text = (gis / "release.geojson").read_text()
    (gis / "release.geojson").write_text(text.replace("EPSG::6676", "EPSG::6677"))
    refused(make(gis, *BODY, run=inside), r"release.geojson: must overlap the terrain, local x y 0 0 120 80, got "
            r"[-\d.]+ [-\d.]+ [-\d.]+ [-\d.]+, read as EPSG:6677: is that right\? The terrain is in EPSG:6677; "
            "--assign-crs release.geojson=EPSG:n, or save")
    about = json.loads(text)
    del about["crs"]
    (gis / "release.geojson").write_text(json.dumps(about))
    line = refused(make(gis, *BODY, run=inside),
                   "release.geojson: coordinates in EPSG:4326 must be longitude and latitude")
    assert "--assign-crs release.geojson=EPSG:n, or save it with its CRS" in line


def test_a_layer_without_crs(gis):
    fiona = pytest.importorskip("fiona")
    points = (np.array(ROAD, float) + (EAST, NORTH)).tolist()
    with fiona.open(gis / "road.shp", "w", "ESRI Shapefile", {"geometry": "Polygon", "properties": {}}) as out:
        out.write({"geometry": {"type": "Polygon", "coordinates": [points + points[:1]]}, "properties": {}})
    line = refused(make(gis, *BODY, "--road", "road.shp", run=inside), "road.shp: must have a CRS.*none")
    assert "--assign-crs road.shp=EPSG:n, or save it with its CRS" in line and "--local" not in line
    assert os.listdir(gis / "mine") == ["site.yaml"]


def test_a_site_that_could_not_be_made_keeps_its_choices(gis, told):
    """site.yaml is left to be changed; the command may be repeated, or the folder made from the changed file."""
    given = ("--terrain", "dem.tif", "--release", "release.geojson", "--shape", "ellipsoid", "--balls", "100", "-o",
             "Damm Fluchth\u00f6rn")
    mine = gis / given[-1]
    status, out, err = told("--depth", "500", *given)
    assert status == 2 and "--depth: must be at most" in err
    assert "site.yaml was kept: change it, then: tools/slope site 'Damm Fluchth\u00f6rn'; or repeat the command" in out
    assert site_choices.load_site(mine).choices.release.depth == 500
    assert "must be at most" in site_choices.found(mine).failed
    (mine / "site.yaml").write_text((mine / "site.yaml").read_text().replace("depth: 500", "depth: 5"))
    status, out, err = told(mine.name)
    assert status == 0 and "then: tools/slope study 'Damm Fluchth\u00f6rn'" in out, err
    assert site_choices.found(mine).failed is None
    status, out, err = told("--depth", "4", *given)
    assert status == 2 and "`slope site 'Damm Fluchth\u00f6rn'` rebuilds this one" in err
    shutil.rmtree(mine)
    assert told("--depth", "500", *given)[0] == 2
    assert told("--depth", "5", *given)[0] == 0


def test_files_in_a_crs_that_they_do_not_name(gis, told):
    """--assign-crs FILE=EPSG:n, for the elevation model, a polygon, a line, a raster; kept in site.yaml."""
    write_layer(gis / "line.geojson", [(38, 10), (38, 70)], kind=LineString)
    for name in ("release.geojson", "road.geojson", "line.geojson"):
        about = json.loads((gis / name).read_text())
        about["crs"] = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::6676"}}
        (gis / name).write_text(json.dumps(about))
    write_layer(gis / "release.geojson", RELEASE)
    write_dem(gis / "dem.tif", crs="EPSG:6676")
    words = ("--terrain", "dem.tif", "--release", "release.geojson", "--road", "road.geojson", "--line", "line.geojson",
             *BODY, "--balls", "100", "--assign-crs", "EPSG:6677")
    status, _, err = told(*words, "-o", "mine")
    assert status == 2 and "road.geojson: must overlap the terrain" in err
    given = ("--assign-crs", "road.geojson=EPSG:6677", "--assign-crs", "./line.geojson=EPSG:6677")
    status, out, err = told(*words, *given, "-o", "mine")
    assert status == 0 and "road.csv: 1 polygon, 1,280 m2" in out, err
    assert site_choices.load_site(gis / "mine").choices.crs.assigned == {
        "road.geojson": "EPSG:6677", "line.geojson": "EPSG:6677"}
    status, out, err = told("mine")
    assert status == 0 and "road.csv: 1 polygon, 1,280 m2" in out, err
    for word, rule in (("rood.geojson=EPSG:6677", "FILE=EPSG:n must name a file of the site that has coordinates, "
                        "dem.tif, release.geojson, road.geojson, line.geojson, got rood.geojson"),
                       ("road.geojson=6677x", "must be a CRS such as EPSG:6677, got 6677x")):
        status, _, err = told("mine", "--assign-crs", word)
        assert status == 2 and err.count("\n") == 1 and rule in err


@pytest.mark.parametrize("words, slope_, start", [
    ("ERROR: the body does not stand before it is shaken, it moves at 1 m/s", 75, "--motion: the body must "
     "stand.*stands at no --peak-friction: leave out --motion.*loss of its strength alone, got 75 degrees$"),
    ("ERROR: Lost atoms: original 380 current 379", 45, "--peak-friction: must hold the body.*got 52$"),
    ("ERROR: Unknown command", 75, "")])
def test_what_can_be_done_for_a_body_that_does_not_stand(words, slope_, start):
    error = SlopeError("trial run", f"must end without an error: {words}")
    if not start:
        return site_warnings.require_standing(error, 52, slope_)
    with pytest.raises(SlopeError, match=start):
        site_warnings.require_standing(error, 52, slope_)


def test_a_file_of_another_version(done, tmp_path):
    good = (done[0] / "mine" / "site.yaml").read_text()
    for old, new, rule in (("slope_site: 1", "slope_site: 2", " slope_site: must be 1.*got 2"),
                           ("slope_site: 1", "slope: 1", " must be .*slope_site"),
                           ("mesh: 10", "mash: 10", " road: must have no mash"),
                           ("spacing: 0.9", "spacing: -1", r" model\.spacing: must be > 0, got -1"),
                           ("rolling: [0", "rolling: 0.05 #", r" study\.rolling: must be a list in brackets, such as "
                            r"\[0\.05\], got 0\.05"),
                           ("rolling: [0, ", "rolling: [0, x, ",
                            " study.rolling: second value: must be a finite number"),
                           (good, "a: [", " must be")):
        mine = tmp_path / "mine"
        mine.mkdir(exist_ok=True)
        for name in ("in.site", "site.yaml"):
            shutil.copy(done[0] / "mine" / name, mine)
        assert old in good
        (mine / "site.yaml").write_text(good.replace(old, new))
        for command in ("site", "study"):
            refused(inside(tmp_path, command, "mine"), f"mine/site.yaml:{rule}")


def test_folders_that_are_no_sites(gis, done):
    refused(inside(gis, "study", "nope"), "nope: must be a deck or the folder of a site")
    refused(inside(gis, "study", "."), r"\.: must be a folder with site.yaml")
    refused(inside(gis, "site", "."), r"\.: must be a folder with site.yaml")
    refused(inside(gis, "site", "-o", "mine"), "--terrain: must be given")
    refused(inside(gis, "site", "--terrain", "dem.tif", *BODY, "-o", "mine"), "--release: must be given")
    refused(inside(done[0], "site", "--terrain", "dem.tif", "--release", "release.geojson", *BODY, "-o", "mine"),
            "-o: must be a new folder; `slope site mine`")
    line = refused(inside(done[0], "study", "mine", "--set", "rolling=0,0.1"),
                   "--set: must not be given with the folder of a site")
    way = shlex.split(line.partition("otherwise: tools/slope ")[2].partition(", got")[0])
    listed = inside(done[0], *way, "--dry-run")
    assert listed.returncode == 0 and "2 runs" in listed.stdout and "--road" in way, listed.stderr
    refused(inside(done[0], "study", "mine/in.site", "--set", "rolling=0"), "-o: must be given")


def test_an_ensemble_of_a_site(done):
    """Its deck with the distributions of mobile masses; known events that do not cover it are refused at once."""
    listed = inside(done[0], "study", "mine", "--sample", "6", "--dry-run")
    assert listed.returncode == 0 and "6 runs, 0 of them finished" in listed.stdout, listed.stderr
    assert all(listed.stdout.count(f"{name} 0.") >= 5 for name in ("rolling", "spacing"))
    assert len(set(re.findall(r"packing (\d{4,6})\b", listed.stdout))) >= 5
    refused(inside(done[0], "study", "mine", "--sample", "6", "--mobility", "rock_avalanches"),
            "--known: must be a set that covers the mass: the set of known events does not cover this volume")
    refused(inside(done[0], "study", "mine", "--sample", "6", "--mesh", "10"),
            "--mesh: must not be given with the folder of a site")
    assert not (done[0] / "mine" / "ensemble").exists()


def test_a_site_has_its_own_choices(tmp_path):
    """What site.yaml says is refused as an option, its default too: nothing is ignored without a word."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "site.yaml").touch()
    for option, *values in (("--set", "rolling=0"), ("--repeat", "packing=2"), ("--vary", "rolling=0:1"),
                            ("--known", "rock_avalanches"), ("--except", "x"),
                            ("--equally-good", "d"),
                            ("--intensity", "peak"), ("--more-than", "10"), ("--exceed", "0.1,0.5,1"),
                            ("--exceed-speed", "5"), ("--exceed-energy", "100000"), ("--design", "sobol"),
                            ("--seed", "0"), ("--of", "front_m"), ("--road", "road.geojson"), ("--cut-angle", "30"),
                            ("--mesh", "10"), ("--local",), ("-o", "out")):
        line = refused(inside(tmp_path, "study", "mine", option, *values),
                       f"{option}: must not be given with the folder of a site: mine/site.yaml")
        assert line.endswith(f", got {values[0]}" if values else "is run")


def test_without_lammps_the_folder_is_made_and_that_is_said(gis, told):
    status, _, err = told("--terrain", "dem.tif", "--release", "release.geojson", *BODY, "--balls", 100, "-o", "mine")
    assert status == 0 and "no LAMMPS program" in err and (gis / "mine" / "in.site").exists()


# --- the page ---

def test_the_page_names_every_key():
    page = (TOP / "doc" / "src" / "tool_site.rst").read_text(encoding="ascii")
    for section, about in sections():
        assert f"*{section}*" in page, section
        for key in about["properties"]:
            assert re.search(rf"\*{key}\*|\*--{key.replace('_', '-')}\*", page), (section, key)
