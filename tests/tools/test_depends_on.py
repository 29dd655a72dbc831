"""Every option, keyword, file and environment variable that a result depends on, and what guards it.

The lists below are compared with what the sources read: one that is new must be entered, with its guard. A run that is
made of one thing is then held against another one, by the digests alone; nothing is run.
"""
import argparse
import contextlib
import importlib
import os
import re
import sqlite3
from pathlib import Path

import pytest
import yaml

from tiny_collapse import TOP

from slope_tools.case import data_files, run_folders
from slope_tools.commands import site as site_command
from slope_tools.options import declare
from slope_tools.runs import dependencies, jobs
from slope_tools.sites import site_choices
from slope_tools.sites.site_sections import KINDS, OfMass, sections
from slope_tools.survey import file_parts

# --- options of the commands that make runs ---

# values of variables: the name of a run's folder
CHOSEN = {"set", "fine", "vary", "levels", "minutes", "tried", "sample", "fit", "paper", "design", "seed", "repeat",
          "converge", "runs", "fragility"}
FOLLOWED = {"deck", "lmp"}              # dependencies.py
PLACE = {"output", "overwrite", "help", "dry_run", "all_columns", "scenario"}       # where to, what is shown, or no run
ONE_RESULT = {"np", "jobs", "launcher", "engine", "slurm"}      # how it is run: the same but for rounding
# computed from the runs, each time that the command is given
ANEW = {"road", "road_width", "road_from", "blocked", "lane", "clearing", "loosening", "cut_angle", "mesh", "local",
        "intensity", "more_than", "of", "exceed", "exceed_speed", "exceed_energy", "equally_good",
        "observed", "front", "front_is", "area", "road_volume", "tolerance", "threshold", "known", "confined",
        "left_out"}
AGAIN = {"anew"}        # which runs are made, not how


def options(command):
    parser = argparse.ArgumentParser()
    declare(parser, importlib.import_module(f"slope_tools.commands.{command}").Request)
    return {action.dest for action in parser._actions}


@pytest.mark.parametrize("command", ["study", "calibrate", "sensitivity"])
def test_every_option_is_guarded(command):
    assert options(command) - (CHOSEN | FOLLOWED | PLACE | ONE_RESULT | ANEW | AGAIN) == set()


@pytest.mark.parametrize("one, other", [({"rolling": "0"}, {"rolling": "0.1"}), ({"rolling": "0"}, {"friction": "0"}),
                                        ({"a": "1"}, {"a": "1", "b": "1"})])
def test_other_values_have_another_folder(one, other):
    assert jobs.Run("out", one).folder != jobs.Run("out", other).folder


# --- a site: its options are choices in its site.yaml, which slope study holds against those of the deck ---

SET_CHOICES = {"slips", "body"}       # of several keys
TRIAL = {"lmp", "jobs", "verbose"}              # of this command alone; what the trial run finds is written as a choice
# keys that slope study and the report read from site.yaml
LATER = {("project", "name"), ("project", "client"), ("project", "author"), ("road", "cut_angle"), ("road", "mesh"),
         *(("road", key) for key in ("width", "from", "blocked", "lane", "clearing", "loosening")),
         ("study", "rolling"), ("study", "spacing"), ("study", "points"), ("known", "set"), ("known", "confined"),
         ("study", "packing"), ("study", "levels"), ("study", "largest_restitution")}
KEYS = [(section, key) for section, about in sections() for key in about["properties"]]
OF_BLOCKS = [(section, key) for section, about in sections("blocks") for key in about["properties"]]
NOT_FILES = {("terrain", "crs"), ("terrain", "assign_crs"), ("terrain", "z_unit"), ("release", "shape"),
             ("release", "scar_is"), ("release", "dip"), ("project", "name"), ("project", "client"),
             ("project", "author"),
             ("known", "set"), ("known", "confined")}


def test_every_option_of_a_site_is_a_choice():
    known = site_command.OPTIONS.keys() - {"assigned", "bodies", "roads"}
    assert options("site") - SET_CHOICES - TRIAL - PLACE - {"folder"} == known
    assert set(site_command.OPTIONS.values()) <= {*KEYS, *OF_BLOCKS}


def test_every_file_of_a_site_is_known():
    def is_text(about):
        kinds = about.get("items", about).get("type", [])
        return "string" in kinds or any(isinstance(one, str) for one in about.get("enum", []))
    texts = {(section, key) for section, about in sections()
             for key, entry in about["properties"].items() if is_text(entry)}
    assert texts - NOT_FILES == set(site_choices.FILES)


@pytest.mark.parametrize("kind, section, key", [*(("", *one) for one in KEYS),
                                                *(("blocks", *one) for one in OF_BLOCKS)])
def test_a_choice_of_a_site_counts(tmp_path, kind, section, key):
    choices = KINDS[kind].of({"terrain": {"files": [str(tmp_path / "dem.asc")]}})
    before = site_choices.unread(choices, tmp_path).fingerprint()
    several = isinstance(choices.value(section, key), tuple)
    choices = choices.changed({(section, key): [str(tmp_path / "other")] if several else str(tmp_path / "other")})
    assert (site_choices.unread(choices, tmp_path).fingerprint() == before) == ((section, key) in LATER)


@pytest.mark.parametrize("section, key", site_choices.FILES)
@pytest.mark.parametrize("end", ["", ".prj", ".shx", ".dbf", ".cpg", ".tfw", ".hdr", ".yaml", ".x.aux.xml", ".gfs",
                                 ".x.msk", ".x-wal", ".x-journal", ".PRJ"])
def test_a_file_of_a_site_counts_by_what_is_in_it(tmp_path, section, key, end):
    source = tmp_path / "source.x"
    changed = source.with_suffix(end) if end else source
    source.write_text("1")
    several = isinstance(OfMass.of({}).value(section, key), tuple)
    choices = OfMass.of({}).changed({(section, key): [str(source)] if several else str(source)})
    changed.write_text("1")
    before = site_choices.unread(choices, tmp_path).sources()
    changed.write_text("2")
    assert len(before) == 1 and site_choices.unread(choices, tmp_path).sources() != before


@pytest.mark.parametrize("member", ["part/dem.tif", "a.shp", "*.csv"])
def test_a_member_counts_by_its_archive(tmp_path, member):
    (tmp_path / "site").mkdir()
    choices = OfMass.of({"terrain": {"files": [f"{tmp_path}/site/../dem.zip/{member}"]}})
    found = []
    for content in "12":
        (tmp_path / "dem.zip").write_text(content)
        found.append(site_choices.unread(choices, tmp_path / "site").sources())
    assert list(found[0]) == list(found[1]) == ["../dem.zip"] and found[0] != found[1]


VIRTUAL = "<VRTDataset><X><SourceFilename shared='0' relativeToVRT=\"1\">{}</SourceFilename></X></VRTDataset>"
DRAWN = "<OGRVRTDataSource><OGRVRTLayer name='x'><SrcDataSource>{}</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>"


@pytest.mark.parametrize("text, source, end, counts", [
    (VIRTUAL, "tiles/a &amp; b.tif", "", True), (VIRTUAL, "/vsizip/tiles/a.zip/b.tif", "", True),
    (DRAWN, "tiles/a.shp", ".dbf", True), (VIRTUAL, "tiles/a.tif", ".tif.aux.xml", True),
    (VIRTUAL, "tiles/a.tif", ".tif.ovr", False)])
def test_the_sources_of_a_virtual_file_count(here, text, source, end, counts):
    """Those of a virtual file of virtual files, too; overviews change no value."""
    (here / "tiles").mkdir()
    name = source.replace("&amp;", "&").replace("/vsizip/", "").replace("/b.tif", "")
    (here / name).write_text("1")
    changed = (here / name).with_suffix(end) if end else here / name
    (here / "inner.vrt").write_text(text.format(source))
    (here / "outer.vrt").write_text(VIRTUAL.format("inner.vrt"))
    before = file_parts.digest_content("outer.vrt")
    changed.write_text("2")
    assert (file_parts.digest_content("outer.vrt") != before) == counts


def test_an_edit_in_the_log_of_a_database_counts_once(here):
    """It is in road.gpkg-wal while QGIS is open, and goes to the file when that closes."""
    def edit(word):
        with contextlib.closing(sqlite3.connect("road.gpkg")) as other:
            other.execute(word)
            other.commit()
            return file_parts.digest_content("road.gpkg")
    edit("PRAGMA journal_mode=WAL")
    with contextlib.closing(sqlite3.connect("road.gpkg")) as one:
        one.execute("SELECT count(*) FROM sqlite_master").fetchall()
        before = edit("CREATE TABLE road (x)")
        after = edit("INSERT INTO road VALUES (1)")
        assert (here / "road.gpkg-wal").stat().st_size > 0 and before != after
    assert not (here / "road.gpkg-wal").exists() and file_parts.digest_content("road.gpkg") == after


# --- results that are computed each time: their yaml says of what ---

SAID = {"fragility": {"slips", "density", "cohesion", "friction", "water", "correlation", "peaks", "record",
                      "vertical", "displacement", "pseudo_static", "hazard", "sample", "seed"},
        "stability": {"terrain", "cohesion", "friction", "density", "layer", "water", "water_table", "bedrock",
                      "seismic", "volume", "depth", "within", "local", "direction", "method", "shape",
                      "keep", "failed"}}


@pytest.mark.parametrize("command", SAID)
def test_every_option_is_said(command):
    """What the yaml has is tested with each command."""
    assert options(command) - PLACE - ONE_RESULT - FOLLOWED == SAID[command]


# --- environment variables ---

PROGRAM = {"LMP", "DUMP2VTK", "LAMMPS_PLUGIN_PATH", "LD_LIBRARY_PATH"}      # by what they lead to
# of one result, but for rounding; a shell completes words; is set, not read; how ranks are started
SAME = {"SLOPE_KERNEL", "OMP_NUM_THREADS", "COMP_LINE", "MATPLOTLIBRC", "SLURM_TASKS_PER_NODE"}


def test_every_environment_variable_is_guarded():
    text = "\n".join(path.read_text() for folder in ("src", "tools/slope_tools")
                     for path in (TOP / folder).rglob("*") if path.suffix in (".cpp", ".h", ".py"))
    named = {"PLUGINS": dependencies.PLUGINS, "LIBRARIES": dependencies.LIBRARIES, **dict(
        re.findall(r'const char \*const (?:\w+::)*(ENVIRONMENT) = "(\w+)"', text))}
    words = re.findall(r"(?:getenv\(|environ\.get\(|environ\[)([\w:\"]+)", text)
    found = {named.get(word.split(":")[-1], word.strip('"')) for word in words}
    # those that a deck names are asked for by it
    assert found - {"name"} - PROGRAM - SAME == set()


# --- words of decks: any other word is another deck, files also count by what is in them ---

FILES = {
    "region/terrain": ["region ground terrain {}"],
    "region/polygon": ["region road polygon {}"],
    "fix/wall/gran/balls": ["fix wall all wall/gran/balls 2 1.0 file {}",
                            "fix wall all wall/gran/balls 2 1.0 file {} write places.txt"],
    "fix/wall/gran/mesh": ["fix house all wall/gran/mesh 3 {}", "fix house all wall/gran/mesh 3 {} output o 10",
                           "fix house all wall/gran/mesh 3 terrain {}"],
    "fix/ground/motion": ["fix quake all ground/motion {} scale 1"],
    "fix/control/line": ["fix line all control/line {} deposit dep output o"],
    "command/create_balls": ["create_balls 3 1.0 2000 file {}"],
    "command/find_slip": ["find_slip ground strength 1e4 30 2000 layer {} 1e3 20 1800 output o",
                          "find_slip ground strength 1e4 30 2000 water table {} output o",
                          "find_slip ground strength 1e4 30 2000 bedrock {} output o",
                          "find_slip ground strength 1e4 30 2000 surface raster {} output o"],
    "LAMMPS": ["read_data {}", "read_restart {}", "include {}", "molecule m {}", "python f file {}",
               "variable x file {}", "variable x atomfile {}", "jump {}", "read_dump {} 0 x y z", "plugin load {}",
               "shell cp {} other.txt", 'if "$(is_file({}))" then "run 1"', "region r mesh {}"]}
NO_FILES = {"pair/gran/restitution", "fix/energy/ledger", "fix/deposit/grid", "fix/gravity/slope",
            "fix/nve/sphere/slope", "command/delete_balls", "fix/CONTACT_HISTORY"}
# words that the parsers compare with: what follows is a file, or not
NAMES_FILE = {"file", "terrain", "layer", "table", "raster", "bedrock"}
NAMES_NONE = {
    "angle", "bulk", "cell", "damping", "deposit", "depth", "direction", "extent", "fill", "friction", "grid",
    "headroom", "inside", "keep", "limit_damping", "lower", "mass", "method", "motion", "move", "open", "origin",
    "output", "outside", "overlap", "pattern", "point", "rest", "restitution", "rim", "rolling", "rolling_radius",
    "rolling_spring", "rotate", "scale", "scattered", "scheme", "seed", "seismic", "series", "shape", "side", "sink",
    "smallest", "spacing", "start", "stiffness", "strength", "sunk", "surface", "units", "upper", "volume", "water",
    "window", "within", "write", "zone"}
WORD = re.compile(r'(?:strcmp\(\w+\[[^]]*\], |\b(?:is|of_stl)\(|given\(|\b(?:keyword|word|key|name) == )"([a-z_]+)"')


def sources():
    return [path for path in (TOP / "src").rglob("*") if path.suffix in (".cpp", ".h")
            and not path.read_text().startswith("// No LAMMPS")]


def test_every_style_and_word_is_guarded():
    text = "\n".join(path.read_text() for path in sources())
    styles = {f"{kind.lower()}/{name}" for kind, name in re.findall(r"^(\w+)Style\(([\w/]+),", text, re.MULTILINE)}
    assert styles - {"LAMMPS"} == ({*FILES} - {"LAMMPS"}) | NO_FILES
    assert set(WORD.findall(text)) - NAMES_FILE - NAMES_NONE == set()


def depends(folder):
    deck = folder / "case" / "in.x"
    files = data_files.data_files(deck, {})
    return dependencies.Dependencies(deck, {name: dependencies.disk.sha256(path) for name, path in files.items()})


def made(folder):
    """A run of the case as it is now."""
    run = jobs.Run(folder / "out", {})
    run.folder.mkdir(parents=True)
    now = depends(folder).now(run)
    (run.folder / run_folders.VARIABLES).write_text(yaml.safe_dump(
        {"environment": now.environment, "inputs": now.files}))
    return run


@pytest.mark.parametrize("line", [line for lines in FILES.values() for line in lines])
@pytest.mark.parametrize("where", ["beside", "below", "elsewhere", "sidecar", "variable"])
def test_a_file_counts_by_what_is_in_it(tmp_path, line, where):
    (tmp_path / "case" / "data").mkdir(parents=True)
    (tmp_path / "data").mkdir()
    place = {"below": tmp_path / "case" / "data", "elsewhere": tmp_path / "data"}.get(where, tmp_path / "case")
    changed = path = place / "input.asc"
    path.write_text("1")
    word = {"below": "data/input.asc", "elsewhere": str(path), "variable": "${one}.asc"}.get(where, path.name)
    text = "variable one string input\n" * (where == "variable") + line.format(word)
    (tmp_path / "case" / "in.x").write_text(text + "\nrun 1\n")
    if where == "sidecar":
        changed = path.with_suffix(".yaml")
        changed.write_text("1")
    run = made(tmp_path)
    assert depends(tmp_path).changed(run) is None
    before = os.stat(changed).st_mtime_ns
    changed.write_text("2")
    os.utime(changed, ns=(before, before))      # and not by its date
    assert Path(depends(tmp_path).changed(run)).name == changed.name


@pytest.mark.parametrize("word", sorted(NAMES_FILE | NAMES_NONE))
def test_a_word_counts(tmp_path, word):
    (tmp_path / "case").mkdir()
    deck = tmp_path / "case" / "in.x"
    deck.write_text(f"fix one all some/style {word} 1\n")
    run = made(tmp_path)
    (run.folder / deck.name).write_text(deck.read_text())
    assert depends(tmp_path).changed(run) is None
    deck.write_text(f"fix one all some/style {word} 2\n")
    assert depends(tmp_path).changed(run) == "in.x"
