"""tools/slope score: areas, run-outs and volumes by hand, rasters on other grids, places, bad input."""
import math
import os
from pathlib import Path

import numpy as np
import pytest
import rasterio
import yaml
from affine import Affine
from shapely.affinity import rotate, translate
from shapely.geometry import MultiPolygon, Point, box

from run_helpers import (BULK, CRS_M, EAST, NORTH, centres, examples, warned, write_asc, write_geojson, write_run,
                         write_sidecar)
from tiny_collapse import rows_of

from slope_tools.deposits import score

COMMAND = "score"
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")


@pytest.fixture
def no_map(monkeypatch):
    """The map, which takes most of the time, is left out."""
    monkeypatch.setattr(score, "draw_score", lambda path, *_: path.touch())


@pytest.fixture
def scored(slope, no_map):
    """Run it on `run` with --local, which must succeed; gives score.yaml."""
    def run(observed, arguments=""):
        if not isinstance(observed, str):
            observed = write_geojson("observed.geojson", observed)
        status, _, err = slope(f"run --observed {observed} --local --overwrite -o out {arguments}")
        assert status == 0, err
        return yaml.safe_load(Path("out/score.yaml").read_text())
    return run


def square(thickness=2.0, west=40, east=80, south=30, north=60, cell=2.5, size=(40, 60)):
    """An even deposit in a box, on a grid of 150 m x 100 m."""
    x, y = centres(*size, cell)
    return np.where((x > west) & (x < east) & (y > south) & (y < north), thickness, 0.0)


def write_tif(path, z, transform, crs=CRS_M, nodata=-9999.0):
    with rasterio.open(path, "w", driver="GTiff", height=z.shape[0], width=z.shape[1], count=1, dtype="float64",
                       crs=crs, transform=transform, nodata=nodata) as out:
        out.write(np.where(np.isnan(z), nodata, z), 1)
    return path


def rows(path="out/score.csv"):
    return rows_of(path, float)


# --- areas ---

def areas(simulated, observed, both):
    return {"simulated": simulated, "observed": observed, "true_positive": both, "false_positive": simulated - both,
            "false_negative": observed - both, "jaccard": both / (simulated + observed - both),
            "hit_rate": both / observed, "precision": both / simulated}


@pytest.mark.parametrize("observed, both", [
    (box(40, 30, 80, 60), 1200), (box(41.3, 31.7, 79.1, 57.7), 37.8 * 26), (box(60, 45, 120, 90), 20 * 15),
    (box(90, 10, 120, 90), 0), (MultiPolygon([box(35, 40, 45, 50), box(70, 50, 90, 55)]), 5 * 10 + 10 * 5),
    (box(20, 20, 100, 80).difference(box(50, 40, 60, 50)), 1200 - 100), (rotate(box(50, 40, 60, 50), 30), 100),
])
def test_areas_of_polygons(scored, observed, both):
    write_run(square(), 0.0, 2.5)
    assert scored(observed)["area"] == pytest.approx(areas(1200, observed.area, both), rel=1e-8, abs=1e-8)
    table = rows()
    for key in ("true_positive", "false_positive", "false_negative"):
        assert sum(row[key] for row in table) == pytest.approx(areas(1200, observed.area, both)[key], abs=1e-6)


def test_only_what_is_thicker_than_the_threshold_counts(scored):
    thickness = square(2.0)
    thickness[square(1.0, 40, 60) > 0] = 0.1
    write_run(thickness, 0.0, 2.5)
    whole = box(40, 30, 80, 60)
    assert scored(whole)["area"]["jaccard"] == pytest.approx(0.5)
    assert scored(whole, "--threshold 0.09")["area"]["jaccard"] == 1
    about = scored(whole, "--threshold 2")
    assert about["area"]["jaccard"] == 0 and about["area"]["precision"] is None
    assert about["runout"]["difference"] is None and warned(about)["nowhere thicker"]["threshold"] == 2


def test_mapped_beyond_the_grid_is_not_met(scored):
    write_run(square(), 0.0, 2.5)
    about = scored(box(60, 30, 250, 60))
    assert about["area"] == pytest.approx(areas(1200, 190 * 30, 600))
    assert warned(about)["outside of grid"]["area"] == pytest.approx(3000)
    assert about["runout"]["observed"] > 150


# --- rasters ---

def test_a_run_against_itself(scored):
    random = np.random.default_rng(1)
    write_run(np.clip(random.normal(0, 1, (40, 60)), 0, None), 0.0, 2.5)
    about = scored("run.thickness.asc", "--mesh 7")
    assert about["area"]["jaccard"] == 1 and about["area"]["false_positive"] == about["area"]["false_negative"] == 0
    assert about["volume"]["error"] == about["volume"]["rms_error_of_mesh_cells"] == 0
    assert about["runout"]["difference"] == about["runout"]["along_fall_line"]["difference"] == 0


@pytest.mark.parametrize("cell, x0, y0", [(2.5, 0, 0), (1.0, 0, 0), (0.7, 3.3, 4.1), (6.0, -7, -5)])
def test_a_raster_on_another_grid(scored, cell, x0, y0):
    """Even thickness in whole mapped cells: areas and volumes are those of the box that they make."""
    write_run(square(), 0.0, 2.5)
    left, right, low, high = 12, 30, 6, 20  # columns and rows of the mapped deposit, from the south-west
    z = np.zeros((45, 60))
    z[45 - high:45 - low, left:right] = 3.0
    z[0, 0] = np.nan
    write_tif("mapped.tif", z, Affine(cell, 0, x0, 0, -cell, y0 + 45 * cell), None)
    mapped = box(x0 + left * cell, y0 + low * cell, x0 + right * cell, y0 + high * cell)
    inside = mapped.intersection(box(0, 0, 150, 100))
    about = scored("mapped.tif", "--mesh 10")
    both = mapped.intersection(box(40, 30, 80, 60)).area
    assert about["area"] == pytest.approx(areas(1200, mapped.area, both), rel=1e-8)
    volume = about["volume"]
    assert (volume["simulated"], volume["observed"]) == pytest.approx((2400, 3 * mapped.area), rel=1e-8)
    assert volume["error"] == pytest.approx(2400 - 3 * mapped.area, abs=1e-5)
    assert volume["relative_error"] == pytest.approx(2400 / (3 * mapped.area) - 1, abs=1e-8)
    table = rows()
    assert sum(row["observed_volume"] for row in table) == pytest.approx(3 * inside.area, rel=1e-8)
    for row in table:
        here_ = box(row["xlo"], row["ylo"], row["xlo"] + 10, row["ylo"] + 10)
        ours, theirs = 2 * here_.intersection(box(40, 30, 80, 60)).area, 3 * here_.intersection(mapped).area
        assert (row["simulated_volume"], row["observed_volume"]) == pytest.approx((ours, theirs), abs=1e-6)
        assert row["volume_error"] == pytest.approx(ours - theirs, abs=1e-6)
    errors = np.array([row["volume_error"] for row in table])
    assert volume["mesh_cells"] == len(table)
    assert volume["mean_absolute_error_of_mesh_cells"] == pytest.approx(np.abs(errors).mean())
    assert volume["rms_error_of_mesh_cells"] == pytest.approx(math.sqrt((errors ** 2).mean()))
    assert about["bulk_factor"] == BULK


def test_place_of_a_raster(slope, no_map):
    write_sidecar(40, 60, 2.5)
    write_run(square(), 0.0, 2.5)
    write_tif("mapped.tif", square(), Affine(2.5, 0, EAST, 0, -2.5, NORTH + 100))
    write_geojson("mapped.geojson", translate(box(40, 30, 80, 60), EAST, NORTH), crs=CRS_M)
    write_asc("local.asc", square(), 2.5)
    for observed in ("mapped.tif", "mapped.geojson", "local.asc --local"):
        status, out, err = slope(f"run --observed {observed} --overwrite")
        assert (status, err) == (0, "") and "Jaccard 1.000" in out and "run-out: " in out
    assert rows("run.score/score.csv")[0]["east"] == EAST + 40


def test_a_raster_without_a_crs_is_taken_to_be_in_that_of_the_terrain(slope, no_map):
    """As slope site does it; a terrain without one is not taken to be in that of the raster."""
    write_run(square(), 0.0, 2.5)
    place = Affine(2.5, 0, EAST, 0, -2.5, NORTH + 100)
    write_tif("mapped.tif", square(), place)
    status, _, err = slope("run --observed mapped.tif")
    assert status == 2 and "--terrain: must have a CRS" in err
    write_sidecar(40, 60, 2.5)
    write_tif("nocrs.tif", square(), place, None)
    status, out, err = slope("run --observed nocrs.tif --overwrite")
    assert status == 0 and "Jaccard 1.000" in out
    assert err.startswith("slope score: warning: nocrs.tif has no CRS: taken to be in that of the terrain")
    said, = yaml.safe_load(Path("run.score/score.yaml").read_text())["warnings"]
    assert (said["kind"], said["level"]) == ("CRS of terrain", "warning")
    assert said["numbers"]["file"] == "nocrs.tif" and err == f"slope score: warning: {said['text']}\n"
    write_asc("local.asc", square(), 2.5)       # in local metres, but --local was not said
    status, out, err = slope("run --observed local.asc --overwrite")
    assert (status, out) == (2, "") and "warning: local.asc has no CRS" in err and "--local" in err
    assert err.splitlines()[-1].startswith("slope score: local.asc: must overlap the grid of the run, 0 0 150 100")


# --- run-out ---

def test_run_out(scored):
    """From the highest cell that the mass was in: a fall line due west, and one askew."""
    x, _ = centres(40, 60, 2.5)
    write_run(square(), 0.3 * x, 2.5)
    highest = np.zeros((40, 60))
    highest[20, 50] = 1.0  # centre at 126.25 48.75
    write_asc("run.max_thickness.asc", np.maximum(highest, square()), 2.5)
    out = scored(box(30, 40, 70, 57.5))["runout"]
    assert out["from"] == [126.25, 48.75] and out["from_source"] == "highest cell that the mass was in"
    far = math.hypot(126.25 - 40, 48.75 - 30)
    assert out["simulated"] == pytest.approx(far) and out["observed"] == pytest.approx(math.hypot(96.25, 8.75))
    assert out["difference"] == pytest.approx(far - math.hypot(96.25, 8.75))
    assert out["along_fall_line"] == {"azimuth": 270, "simulated": 86.25, "observed": 96.25, "difference": -10}
    out = scored(box(86.25, 0, 106.25, 37.5))["runout"]
    assert out["along_fall_line"]["azimuth"] == pytest.approx(180 + 45)
    assert out["along_fall_line"]["simulated"] == pytest.approx((86.25 + 18.75) / math.sqrt(2))


def test_where_the_top_is_known_from(scored):
    write_run(square(), 0.0, 2.5, travel={"front": 5.0, "top": [100.0, 40.0, 12.0]})
    out = scored(box(40, 30, 80, 60))["runout"]
    assert out["from"] == [100, 40] and out["from_source"].startswith("summary")
    x, _ = centres(40, 60, 2.5)
    write_run(square(), 0.1 * x, 2.5)
    out = scored(box(40, 30, 80, 60))["runout"]
    assert out["from"][0] == 78.75 and out["from_source"] == "highest cell of the deposit"


def test_the_connected_deposit_and_a_stray_ball(scored):
    """The bar goes 40 m from the top, a ball in a cell of its own 130 m; the mapped deposit 45 m."""
    thickness = np.zeros((40, 60))
    thickness[20, 4:16] = 1.0
    thickness[20, 50] = 0.5
    quantiles = [{"share": 0.99, "distance": 39.0, "reach_angle": 22.5}]
    write_run(thickness, 5.0, 2.5, travel={"top": [0.0, 48.75, 26.0], "quantiles": quantiles})
    out = scored(box(10, 47.5, 45, 50))["runout"]
    assert out["simulated"] == pytest.approx(math.hypot(127.5, 1.25)) and out["difference"] > 80
    part = out["connected"]
    assert (part["parts"], part["area"], part["volume"]) == (2, 75, 75)
    assert part["share_of_volume"] == pytest.approx(12 / 12.5)
    assert part["distance"] == pytest.approx(math.hypot(40, 1.25))
    assert part["reach_angle"] == pytest.approx(math.degrees(math.atan2(20, part["distance"])))
    assert part["observed"] == pytest.approx(math.hypot(45, 1.25))
    assert part["difference"] == pytest.approx(part["distance"] - part["observed"])
    assert out["balls"] == quantiles
    assert scored(box(10, 47.5, 45, 50), "--threshold 2")["runout"]["connected"] is None


def test_shares_within(scored):
    """By area against an outline; by volume against a thickness, where the thin far half hardly counts."""
    thickness = np.zeros((40, 60))
    thickness[20, :10], thickness[20, 10:20] = 9.0, 1.0
    write_run(thickness, 5.0, 2.5, travel={"top": [0.0, 48.75, 26.0]})
    out = scored(box(0, 47.5, 25, 50))["runout"]
    assert out["quantiles_of"] == "area" and out["balls"] is None
    middle = 1.25 + 2.5 * np.arange(20)      # centres of the cells of the bar
    assert [one["simulated"] for one in out["quantiles"]] == pytest.approx(middle[[9, 17, 18, 19]])
    assert [one["observed"] for one in out["quantiles"]] == pytest.approx(middle[[4, 8, 9, 9]])
    write_asc("mapped.asc", thickness[:, ::-1].copy(), 2.5)
    out = scored("mapped.asc")["runout"]
    assert out["quantiles_of"] == "volume"
    assert [one["simulated"] for one in out["quantiles"]] == pytest.approx(middle[[5, 9, 14, 18]])
    for one in out["quantiles"]:
        assert one["difference"] == pytest.approx(one["simulated"] - one["observed"])
    assert out["quantiles"][0]["observed"] > 100


@pytest.mark.parametrize("outline", [True, False])
def test_what_lies_beside_the_grid_counts_in_the_shares(slope, scored, outline):
    """Of a map of 200 m, of which the grid has 150; and of a run that lost 2 % and 6 % of its mass."""
    bar = square(west=0, east=200, south=47.5, north=50, size=(40, 80))
    write_asc("mapped.asc", bar, 2.5)
    for lost, far in ((0.0, 118.75), (0.02, None), (0.06, None)):
        there = float(square(west=0, east=120, south=47.5, north=50).sum()) * 2.5 ** 2
        write_run(square(west=0, east=120, south=47.5, north=50), 0.0, 2.5, travel={"top": [0.0, 48.75, 26.0]},
                  volume={"released": there / (1 - lost), "on_grid": there, "off_grid": lost * there / (1 - lost),
                          "lost": 0.0, "residual": 0.0})
        *_, most = several = scored(box(0, 47.5, 200, 50) if outline else "mapped.asc")["runout"]["quantiles"]
        assert [one["observed"] for one in several] == pytest.approx([0.5 * 200, 0.9 * 200, 0.95 * 200, 0.99 * 200],
                                                                     abs=2.5)
        assert most["simulated"] == far and (most["difference"] is None) == (far is None)
        assert (several[2]["simulated"] is None) == (lost > 0.05)
    assert "simulated beyond the grid, mapped within 19" in slope(
        "run --observed mapped.asc --local --overwrite -o out")[1]


# --- files, bad input ---

@pytest.mark.drawn
def test_files_and_warnings(slope):
    write_run(square(), 0.0, 2.5, moving=True)
    write_geojson("observed.geojson", Point(60, 45).buffer(20))
    status, out, err = slope("run --observed observed.geojson --local")
    assert status == 0 and sorted(os.listdir("run.score")) == ["score.csv", "score.png", "score.yaml"]
    assert err.count("slope score: warning: ") == err.count("\n") == 2 and "still moving at 12.5 s" in err
    assert len(yaml.safe_load(Path("run.score/score.yaml").read_text())["warnings"]) == 2


@pytest.mark.parametrize("arguments, message", [
    ("run --observed mapped.tif --threshold -1", "--threshold: must be >= 0, got -1"),
    ("run --observed mapped.tif --mesh 0", "--mesh: must be > 0, got 0"),
    ("none --observed mapped.tif", "none.thickness.asc: must be an existing file"),
    ("run --observed none.tif", "none.tif: must be an existing file"),
    ("run --observed away.tif", "away.tif: must overlap the grid of the run, 0 0 150 100 (local metres), got 500 0"),
    ("run --observed zone8.tif", "zone8.tif: must be in the CRS of the run, EPSG:6677"),
    ("run --observed negative.tif", "negative.tif: row 1 column 1: must be a thickness >= 0 and <= 9000 m, got -1"),
    ("run --observed turned.tif", "turned.tif: must be a raster with rows from west to east"),
    ("run --observed mapped.tif -o mapped.tif", "-o: must be a folder, got mapped.tif"),
])
def test_bad_input_is_one_line(slope, no_map, here, arguments, message):
    write_sidecar(40, 60, 2.5)
    write_run(square(), 0.0, 2.5)
    place = Affine(2.5, 0, EAST, 0, -2.5, NORTH + 100)
    write_tif("mapped.tif", square(), place)
    write_tif("away.tif", square(), Affine.translation(500, 0) @ place)
    write_tif("zone8.tif", square(), place, "EPSG:6676")
    write_tif("negative.tif", square() - np.eye(40, 60), place)
    write_tif("turned.tif", square(), place @ Affine.rotation(10))
    before = sorted(here.rglob("*"))
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1 and err.startswith("slope score: ") and message in err
    assert sorted(here.rglob("*")) == before


# --- the page ---

@pytest.mark.parametrize("command", examples("score"))
def test_every_example_of_the_page_and_the_help_runs(slope, no_map, command):
    write_sidecar(40, 60, 2.5)
    write_sidecar(40, 60, 2.5, "dem.asc")
    write_run(square(), 0.0, 2.5, "embankment")
    write_geojson("mapped.geojson", translate(box(40, 30, 80, 60), EAST, NORTH), crs=CRS_M)
    write_tif("thickness.tif", square(), Affine(2.5, 0, EAST, 0, -2.5, NORTH + 100))
    Path("mapped.csv").write_text("40,30\n80,30\n80,60\n40,60\n")
    status, out, err = slope(command)
    assert (status, err) == (0, "")
    assert "--help" in command or "Jaccard 1.000" in out
