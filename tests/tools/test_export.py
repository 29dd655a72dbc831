"""tools/slope export: every raster of a run, with its values, place and CRS; and the base of a run that has one."""
import contextlib
import os
import shutil
import sqlite3
import subprocess
from pathlib import Path

import fiona
import numpy as np
import pytest
import rasterio
import yaml
from affine import Affine
from rasterio.crs import CRS
from shapely.geometry import Point

import made_study
from made_rows import row
from run_helpers import CRS_M, EAST, NORTH, called, examples, write_asc, write_run, write_sidecar
from tiny_collapse import LMP, read_asc, write_case

from slope_tools.case import run_folders
from slope_tools.deposits import deposit
from slope_tools.errors import SlopeError
from slope_tools.survey import geopackage, rasters

COMMAND = "export"
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")


def write_rasters(prefix="run", cell=2.5):
    """A run of 40 x 60 cells with all its rasters, each with other values; the values by kind."""
    random = np.random.default_rng(2)
    thickness = np.clip(random.normal(0, 1, (40, 60)), 0, None)
    base = 50 + random.normal(0, 5, (40, 60))
    base[3, 4] = np.nan
    write_run(thickness, base, cell, prefix)
    values = {"base": base, "surface": base + thickness, "thickness": thickness}
    for kind in ("max_thickness", "max_speed", "max_energy", "arrival", "last_motion"):
        values[kind] = random.gamma(2.0, 1e3 if kind == "max_energy" else 5.0, (40, 60))
    values["arrival"][:, :10] = np.nan
    for kind in set(values) - {"surface", "thickness"}:
        write_asc(f"{prefix}.{kind}.asc", values[kind], cell)
    return values


def test_every_raster_in_the_coordinates_of_the_survey(slope):
    write_sidecar(40, 60, 2.5)
    values = write_rasters()
    write_asc("run.900.thickness.asc", values["thickness"] / 2, 2.5)
    write_asc("run.other.thickness.asc", values["thickness"], 2.5)     # the prefix run.other
    write_asc("rerun.thickness.asc", values["thickness"], 2.5)
    status, out, err = slope("run -o gis")
    assert (status, err) == (0, "") and out.startswith("9 rasters, EPSG:6677, cells of 2.5 m\n")
    expected = {**{f"run.{kind}": of for kind, of in values.items()}, "run.900.thickness": values["thickness"] / 2}
    assert sorted(os.listdir("gis")) == sorted([f"{name}.tif" for name in expected] + ["export.yaml"])
    about = yaml.safe_load(Path("gis/export.yaml").read_text())
    assert about["crs"] == CRS_M and about["origin"] == {"east": EAST, "north": NORTH} and about["warnings"] == []
    told = {one["file"]: one for one in about["rasters"]}
    for name, of in expected.items():
        with rasterio.open(f"gis/{name}.tif") as tif:
            assert tif.crs == rasterio.crs.CRS.from_user_input(CRS_M)
            assert tuple(tif.bounds) == (EAST, NORTH, EAST + 150, NORTH + 100) and tif.res == (2.5, 2.5)
            found = tif.read(1, masked=True).filled(np.nan)
            assert np.array_equal(found, of, equal_nan=True), name
            one = told[f"{name}.tif"]
            assert tif.descriptions == (f"{one['quantity']} ({one['unit']})",)
        assert (one["min"], one["max"]) == (np.nanmin(of), np.nanmax(of))
        assert one["nodata_cells"] == np.isnan(of).sum()
        assert one.get("step") == (900 if "900" in name else None)
    assert [one["file"] for one in about["rasters"]][0] == "run.base.tif"
    assert told["run.max_energy.tif"]["unit"] == "J" and told["run.arrival.tif"]["unit"] == "s"


@pytest.mark.parametrize("best", [None, "two"])
def test_a_run_by_its_folder_or_one_of_its_files(slope, here, best):
    """They are the rasters of the prefix; of a study those of its governing run, which is said."""
    for run in ("one", "two"):
        Path("mine/study", run).mkdir(parents=True)
        write_rasters(f"mine/study/{run}/site")
    made_study.write(Path("mine/study"), [     # the farthest ball is of the first one
        row(run=name, summary=f"{name}/site.summary.yaml", distance_99_m=distance, remove_m3=1.0)
        for name, distance in (("one", 50.0), ("two", 40.0 if best else 60.0))],
        conservative=best and made_study.conservative(1.0, run=best))
    for name, folder in (("mine/study/two/site.max_speed.asc", "mine/study/two/site.export"),
                         ("mine/study/two/site.summary.yaml", "mine/study/two/site.export"),
                         ("mine/study/two", "mine/study/two/export"), ("mine/study", "mine/study/export"),
                         ("mine", "mine/export")):
        status, out, err = slope(name)
        assert status == 0 and f"written to {folder}: site.base.tif" in out, err
        assert ("two, the governing run of mine/study: mine/study/two/site" in out) == (name in ("mine", "mine/study"))
        of_study = name in ("mine", "mine/study")
        about = yaml.safe_load(Path(folder, "export.yaml").read_text())["run"]
        assert (about["name"], about["study"]) == (("two", "mine/study") if of_study else (None, None))
        with rasterio.open(f"{folder}/site.base.tif") as tif:
            assert tif.tags()["run"] == ("two, the governing run of mine/study" if of_study else "mine/study/two/site")
        shutil.rmtree(folder)


def test_files_for_paraview_are_of_the_run_of_the_first_page(here, capsys, monkeypatch):
    """By dump2vtk, here a stand-in that keeps its words; snapshots after the run's end and of others are left out."""
    program = Path("stand-in")
    program.write_text("#!/bin/sh\necho $* > words\n[ ! -e refuse ] || { echo 'dump2vtk: cut short' >&2; exit 2; }\n")
    program.chmod(0o755)
    monkeypatch.setenv("DUMP2VTK", str(program))
    for run in ("one", "two"):
        Path("mine/study", run).mkdir(parents=True)
        write_rasters(f"mine/study/{run}/site")
        for name in ("site.0.dump", "site.5.dump", "site.9.dump", "other.1.dump", "other.2.dump", "other.3.dump"):
            Path("mine/study", run, name).touch()
        about = yaml.safe_load(Path("mine/study", run, "site.summary.yaml").read_text())
        keep = Path("mine/study", run, "site.summary.yaml").write_text
        keep(yaml.safe_dump({**about, "stop": {"reason": "halt", "step": 5, "time": 9.0}}))
    made_study.write(Path("mine/study"), [row(run=name, summary=f"{name}/site.summary.yaml", distance_99_m=distance)
                                          for name, distance in (("one", 50.0), ("two", 60.0))])
    for name, output in (("mine", "mine/vtk/site"), ("mine/study/two/site", "mine/study/two/vtk/site")):
        status, out, err = called(capsys, ["vtk", name])
        assert (status, err) == (0, "") and f"open {output}.pvd" in out
        assert Path("words").read_text().split() == [
            *(f"mine/study/two/site.{step}.dump" for step in (0, 5)), "--deposit", "mine/study/two/site", "-o", output]
    status, out, err = called(capsys, ["vtk", "mine", "--single", "-o", "new/mine"])
    assert status == 2 and "-o: must be in an existing folder, got new/mine" in err
    Path("refuse").touch()
    status, out, err = called(capsys, ["vtk", "mine", "--single", "-o", "mine/out"])
    assert (status, err) == (2, "slope vtk: dump2vtk: cut short\n")
    assert Path("words").read_text().endswith("-o mine/out --single\n")
    monkeypatch.setenv("DUMP2VTK", "nowhere")
    status, out, err = called(capsys, ["vtk", "mine"])
    assert status == 2 and "DUMP2VTK in the environment: must lead to dump2vtk, got" in err


def quantiles(value):
    return {"length_m": {"name": "length", "unit": "m",
                         "quantiles": [{"share": 0.9, "value": value, "low": None, "high": None}]}}


OWN = {name: {**one, "mean": 1.0, "standard_deviation": None, "smallest": 1.0, "largest": 1.0}
       for name, one in quantiles(210.0).items()}


@pytest.mark.parametrize("known, inside, run", [
    (None, ".", "two"),                             # at the 90 % quantile of the runs as they are
    ({"quantities": quantiles(290.0)}, "../study", "one"),      # of the weighted runs; those of the paper's study
    ({"quantities": quantiles(None)}, ".", "one"),  # known events go beyond all runs: the longest
    ({"quantities": {}}, ".", "two")])              # nothing is weighted
@pytest.mark.parametrize("paper", [True, False])
def test_a_site_is_the_run_of_the_first_page(slope, here, known, inside, run, paper):
    """Of the study that governs, by its own rule, whatever else lies there; the files name it."""
    write_sidecar(40, 60, 2.5)
    said, of = made_study.headline(source="ensemble"), {"governs": "ensemble"}
    for name in ("one", "two"):
        Path("mine/ensemble", inside, name).mkdir(parents=True)
        write_rasters(f"mine/ensemble/{inside}/{name}/site")
        shutil.copy("terrain.asc", f"mine/ensemble/{inside}/{name}")
        shutil.copy("terrain.yaml", f"mine/ensemble/{inside}/{name}")
    write_rasters("mine/byhand")
    rows = [row(run=name, length_m=length, summary=f"{inside}/{name}/site.summary.yaml")
            for name, length in (("one", 300.0), ("two", 200.0))]
    made_study.write(Path("mine/ensemble"), [*rows, row(run="three", status="failed")], of, headline=said,
                     ensemble=made_study.ensemble(known, of="length_m", quantities=OWN))
    if paper:
        Path("mine/study").mkdir(exist_ok=True)
        made_study.write(Path("mine/study"), [row(run="other", remove_m3=1.0)], of, headline=said,
                         conservative=made_study.conservative(1.0, run="other"))
    status, out, err = slope("mine")
    assert (status, err) == (0, "") and f"{run}, the governing run of mine/ensemble: " in out
    about = yaml.safe_load(Path("mine/export/export.yaml").read_text())
    assert (about["run"]["name"], about["run"]["study"]) == (run, "mine/ensemble")
    with rasterio.open("mine/export/site.thickness.tif") as tif:
        assert tif.tags()["run"] == f"{run}, the governing run of mine/ensemble"


def test_without_a_terrain_in_local_metres(slope):
    write_rasters()
    status, out, err = slope("run")
    assert status == 0 and "local metres, no CRS" in out
    assert err.count("\n") == 1 and "no --terrain and no terrain.asc: no CRS" in err
    with rasterio.open("run.export/run.base.tif") as tif:
        assert tif.crs is None and tuple(tif.bounds) == (0, 0, 150, 100)


@pytest.mark.parametrize("crs, number", [(None, -1), ("EPSG:6677", 6677)])
def test_a_geopackage_without_a_crs_is_in_metres(tmp_path, crs, number):
    """Not in degrees, for which GDAL takes it, and QGIS with it."""
    raster = rasters.Raster(np.ones((2, 2)), Affine(1, 0, 0, 0, -1, 2), crs and CRS.from_string(crs))
    geopackage.write_geopackage(tmp_path / "a.gpkg", {"a": geopackage.Layer("Point", {}, [(Point(1, 2), {})])}, raster)
    with contextlib.closing(sqlite3.connect(tmp_path / "a.gpkg")) as base:
        for table in ("gpkg_contents", "gpkg_geometry_columns"):
            assert base.execute(f"SELECT srs_id FROM {table}").fetchone() == (number,)
    with fiona.open(tmp_path / "a.gpkg") as data:
        assert [one["geometry"]["coordinates"] for one in data] == [(1 + raster.offset[0], 2 + raster.offset[1])]


def test_an_older_run_has_no_base(slope):
    write_sidecar(40, 60, 2.5)
    write_rasters()
    os.remove("run.base.asc")
    status, out, err = slope("run")
    assert status == 0 and out.startswith("7 rasters") and "no run.base.asc, as of a run by an older version" in err
    assert not Path("run.export/run.base.tif").exists()


def test_a_run_of_the_deck(slope, here):
    """What fix deposit/grid writes is what is exported; the base is the ground with the scar."""
    write_case(here)
    subprocess.run([LMP, "-in", "in.tiny", "-var", "steps", "50"], check=True, stdout=subprocess.DEVNULL)
    status, out, _ = slope("tiny")
    assert status == 0 and out.startswith(f"{len(run_folders.RASTERS)} rasters")
    listed = yaml.safe_load(Path("tiny.summary.yaml").read_text())["files"]
    rasters = {name.replace(".asc", ".tif") for name in listed if name.endswith(".asc")}
    assert rasters | {"export.yaml"} == set(os.listdir("tiny.export"))
    for name in (one for one in listed if one.endswith(".asc")):
        with rasterio.open(f"tiny.export/{name.replace('.asc', '.tif')}") as tif:
            assert np.array_equal(tif.read(1, masked=True).filled(np.nan), read_asc(name), equal_nan=True), name
    terrain, base = read_asc("terrain.asc"), read_asc("tiny.base.asc")
    assert base.shape == terrain.shape and (terrain - base).max() > 2 and (base - terrain).max() < 1e-6


@pytest.mark.parametrize("arguments, message", [
    ("none", "none.thickness.asc: must be an existing file"),
    (".", ".: must hold one run, or name one of them by its prefix, got broken, finer, run"),
    ("empty", "empty: must be output of fix deposit/grid: its prefix, one of its files, or the folder of a run, a "
     "study or a site: it holds neither"),
    ("terrain.asc", "terrain.asc: must be output of fix deposit/grid: its prefix, one of its files"),
    ("run -o run.base.asc", "-o: must be a folder, got run.base.asc"),
    ("run --terrain none.asc", "none.asc: must be an existing file"),
    ("finer", "finer.max_speed.asc: must have the grid of the run's thickness"),
    ("broken", "broken.arrival.asc: line 7: must hold numbers with a decimal point, got 'never'"),
])
def test_bad_input_is_one_line(slope, here, arguments, message):
    write_sidecar(40, 60, 2.5)
    Path("empty").mkdir()
    for prefix in ("run", "finer", "broken"):
        write_rasters(prefix)
    write_asc("finer.max_speed.asc", np.zeros((80, 120)), 1.25)
    lines = Path("broken.arrival.asc").read_text().splitlines()
    Path("broken.arrival.asc").write_text("\n".join([*lines[:6], lines[6] + " never", *lines[7:]]) + "\n")
    before = sorted(here.rglob("*"))
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1 and err.startswith("slope export: ") and message in err
    assert sorted(here.rglob("*")) == before


# --- the base, of all commands that read a run ---

def test_the_base_of_a_run(here):
    values = write_rasters()
    found = deposit.read_deposit("run", None, lambda text: None)
    assert np.array_equal(found.base, values["base"], equal_nan=True)
    os.remove("run.base.asc")
    found = deposit.read_deposit("run", None, lambda text: None)
    assert found.base == pytest.approx(values["base"], nan_ok=True, abs=1e-9)


@pytest.mark.parametrize("change, message", [
    (lambda base: base + 1e-4, "run.base.asc: row 1 column 1: must be run.surface.asc less the thickness, "),
    (lambda base: np.where(np.isnan(base), 50, base), "run.base.asc: row 4 column 5: must be run.surface.asc less "),
    (lambda base: base[1:], "run.base.asc: must have the grid of run.thickness.asc"),
])
def test_a_base_of_another_run(here, change, message):
    values = write_rasters()
    write_asc("run.base.asc", change(values["base"]), 2.5)
    with pytest.raises(SlopeError) as error:
        deposit.read_deposit("run", None, lambda text: None)
    assert message in str(error.value)


# --- the page ---

EXAMPLES = examples("export")


@pytest.mark.parametrize("command", [one for one in EXAMPLES if "--zones" not in one])      # these: test_route.py
def test_every_example_of_the_page_and_the_help_runs(slope, here, command):
    write_sidecar(40, 60, 2.5)
    write_rasters("embankment")
    for folder in ("study/rolling_0.05", "mine/study/rolling_0"):
        Path(folder).mkdir(parents=True)
        write_rasters(f"{folder}/embankment")
        shutil.copy("terrain.asc", folder)
        shutil.copy("terrain.yaml", folder)
    made_study.write(Path("mine/study"), [row(run="rolling_0", summary="rolling_0/embankment.summary.yaml")])
    status, out, err = slope(command)
    assert (status, err) == (0, "") and ("--help" in command or "8 rasters, EPSG:6677" in out)
