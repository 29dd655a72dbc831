"""A raster beside a terrain lies where its sidecar, its CRS or its coordinates say, whatever command takes it."""
from pathlib import Path

import numpy as np
import pytest
import rasterio
import yaml
from affine import Affine
from rasterio.crs import CRS
from rasterio.warp import Resampling, reproject

from run_helpers import CRS_M, EAST, NORTH, write_asc, write_tif

from slope_tools import cli
from slope_tools.commands import stability
from slope_tools.deposits import score
from slope_tools.errors import SlopeError
from slope_tools.findings import Finding
from slope_tools.releases import release_scar
from slope_tools.slips import failed
from slope_tools.survey import beside, rasters
from slope_tools.survey.rasters import Raster

CELL = 5.0
TERRAIN = Raster(200 - 0.5 * np.add.outer(np.zeros(20), CELL * np.arange(30)) + 0.02 * np.arange(20)[:, None],
                 Affine(CELL, 0, 0, 0, -CELL, 100), CRS.from_user_input(CRS_M), (EAST, NORTH))
BED = TERRAIN.z - 3.0
WIDE = np.pad(BED, ((0, 4), (6, 0)), "edge")    # farther west and south


@pytest.fixture
def bed(here):
    """The same surface as files of all kinds; ground.asc is the terrain."""
    rasters.write_asc_local("ground.asc", TERRAIN, {}, exact=True)
    rasters.write_asc_local("same.asc", TERRAIN._replace(z=BED), {}, exact=True)
    rasters.write_asc_local("wide.asc", TERRAIN._replace(
        z=WIDE, transform=Affine(CELL, 0, 0, 0, -CELL, 120), offset=(EAST - 30, NORTH - 20)), {}, exact=True)
    write_asc("survey.asc", BED, CELL, EAST, NORTH)
    write_asc("local.asc", BED, CELL)
    write_tif("bed.tif", BED, CELL)
    with rasterio.open("feet.tif", "w", driver="GTiff", height=20, width=30, count=1, dtype="float64", crs=CRS_M,
                       transform=Affine(CELL, 0, EAST, 0, -CELL, NORTH + 100)) as out:
        out.write(BED / 0.3048, 1)
        out.units = ("ft",)
    z = np.full((400, 400), np.nan)
    reproject(BED, z, src_transform=Affine(CELL, 0, EAST, 0, -CELL, NORTH + 100), src_crs=CRS_M, src_nodata=np.nan,
              dst_transform=degrees(), dst_crs="EPSG:6668", dst_nodata=np.nan, resampling=Resampling.bilinear)
    with rasterio.open("degrees.tif", "w", driver="GTiff", height=400, width=400, count=1, dtype="float64",
                       crs="EPSG:6668", transform=degrees(), nodata=np.nan) as out:
        out.write(z, 1)
    return here


def degrees():
    """A transform around the terrain."""
    x, y = rasterio.warp.transform(CRS_M, "EPSG:6668", [EAST], [NORTH])
    return Affine(1e-5, 0, x[0] - 0.001, 0, -1e-5, y[0] + 0.002)


FILES = ("same.asc", "wide.asc", "survey.asc", "local.asc", "bed.tif", "feet.tif", "degrees.tif")


@pytest.mark.parametrize("name", FILES)
def test_every_kind_of_file_gives_the_same_heights(bed, name):
    found = beside.heights_on(name, TERRAIN)
    inside = found[2:-2, 2:-2]
    assert inside == pytest.approx(BED[2:-2, 2:-2], abs=0.1 if name == "degrees.tif" else 1e-6)
    assert np.isfinite(found).all() or name == "degrees.tif"


def test_what_is_taken_for_granted_is_said(bed):
    said = []
    for name in FILES:
        beside.heights_on(name, TERRAIN, warn=said.append)
    assert [(one.kind, one.numbers["file"]) for one in said] == [("CRS of terrain", "survey.asc"),
                                                                 ("local raster", "local.asc")]
    near = TERRAIN._replace(offset=(20.0, 10.0))        # both readings put it on the terrain
    said.clear()
    assert beside.heights_on("local.asc", near, warn=said.append)[-1, 0] == pytest.approx(BED[17, 4])
    assert said == [Finding("survey raster", {"file": "local.asc"})]
    assert beside.heights_on("local.asc", near, local=True, warn=said.append) == pytest.approx(BED)
    assert len(said) == 1
    assert beside.heights_on("wide.asc", TERRAIN, local=True) == pytest.approx(BED)     # its sidecar counts


def test_what_does_not_fit_is_one_line(bed):
    far = TERRAIN._replace(offset=(EAST + 5000, NORTH))
    with pytest.raises(SlopeError, match=r"wide.asc: must overlap the terrain, local x y 0 0 150 100, got -5030 -20 .*"
                       rf"\(origin {EAST - 30:g} {NORTH - 20:g}, the terrain's {EAST + 5000:g} {NORTH:g}\)"):
        beside.heights_on("wide.asc", far)
    with pytest.raises(SlopeError, match="bed.tif: is in EPSG:6677, and the terrain must have a CRS, too"):
        beside.heights_on("bed.tif", TERRAIN._replace(crs=None))


@pytest.mark.parametrize("unit, shown", [("ft", "ft"), ("US survey foot", "us-ft")])
def test_a_false_tag_of_feet_is_refused_by_all_that_take_heights(bed, unit, shown):
    with rasterio.open("feet.tif", "r+") as out:
        out.write(BED, 1)
        out.units = (unit,)
    for taken in (lambda: beside.heights_on("feet.tif", TERRAIN),
                  lambda: release_scar.read_scar("feet.tif", None, TERRAIN, 0),
                  lambda: release_scar.read_scar("feet.tif", "surface", TERRAIN, 0),
                  lambda: failed.of_base(TERRAIN, Path("feet.tif"), None, 2000, None)):
        with pytest.raises(SlopeError, match=f"feet.tif: heights in {shown} must be confirmed.*--z-unit m, ft or us-ft"
                                             " .*, got 11[0-9] m off"):
            taken()
    for taken in (lambda: score.read_observed("feet.tif", TERRAIN, 0.1, False),     # a thickness has nothing beside it
                  lambda: release_scar.read_scar("feet.tif", "depth", TERRAIN, 0)):
        with pytest.raises(SlopeError, match=f"feet.tif: must be in metres, got {unit}"):
            taken()


def test_heights_in_feet_are_a_scar_in_metres(bed, monkeypatch):
    assert release_scar.read_scar("feet.tif", None, TERRAIN, 0).depth == pytest.approx(TERRAIN.z - BED)
    assert failed.of_base(TERRAIN, Path("feet.tif"), None, 2000, None).cells
    opened, names = rasters.opened, []
    monkeypatch.setattr(rasters, "opened", lambda path, *more: names.append(path) or opened(path, *more))
    beside.heights_on("feet.tif", TERRAIN)
    assert names == ["feet.tif"]        # also for the unit


@pytest.mark.parametrize("name", ["wide.asc", "survey.asc", "bed.tif"])
def test_the_rasters_of_a_search_are_handed_over_on_the_cells_of_the_terrain(bed, name):
    for option, kind in (("water_table", "water table"), ("bedrock", "bedrock")):
        asked = stability.Request(terrain=Path("ground.asc"), density=2000, output=Path("o"), **{option: Path(name)})
        [given] = stability.rasters_of(asked, TERRAIN, None)
        assert given.kind == kind and given.z == pytest.approx(BED)
    asked = stability.Request(terrain=Path("ground.asc"), density=2000, output=Path("o"),
                              layer=[[name, "1", "2", "3"], ["same.asc", "1", "2", "3"]])
    assert [one.name for one in stability.rasters_of(asked, TERRAIN, None)] == ["layer.1.asc", "layer.2.asc"]


def test_a_back_analysis_takes_them_too(bed, capsys):
    """Water table, and a ground without the body, from a survey that reaches farther."""
    for table in ("same.asc", "wide.asc", "bed.tif"):
        words = "stability ground.asc --failed 70,50,190,50 --density 2000 --direction 90"
        assert cli.main([*words.split(), "--water-table", table, "-o", table[:4]]) == 0, capsys.readouterr().err
    centres = [yaml.safe_load(Path(name, "back.yaml").read_text())["cohesion_without_friction"]
               for name in ("same", "wide", "bed.")]
    assert centres == pytest.approx([centres[0]] * 3)
