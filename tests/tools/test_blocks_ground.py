"""Where single blocks start on steep ground, roads of any shape, and zones of their ground."""
import re
import shutil
import subprocess
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from affine import Affine
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box

from run_helpers import called, write_tif
from test_blocks import CELL, COLUMNS, RELEASE, ROWS, TOE
from test_site import write_layer
from test_site_zones import write_zones
from tiny_collapse import LMP

from slope_tools.blocks import edges, page, runs, site as of_blocks, study
from slope_tools.case import decks
from slope_tools.plots import figure_maps, site_map
from slope_tools.sites import site_choices, site_deck, site_zones
from slope_tools.sites.site_sections import OfBlocks
from slope_tools.survey.rasters import Raster
from slope_tools.survey.resampling import sample
from slope_tools.tables.structures import table_of

# --- where they start ---

X, Y = np.meshgrid(np.arange(30) + 0.5, 29.5 - np.arange(30))
GROUNDS = {"cliff": 40.0 * (X > 15), "oblique": 40.0 * (X + 0.6 * Y > 24), "slope": 1.7 * X, "corner": 40.0 * (
    (X > 15) & (Y > 15)), "rough": np.random.default_rng(3).uniform(0, 2, X.shape)}


@pytest.mark.parametrize("name", GROUNDS)
@pytest.mark.parametrize("reach", [0.3, 0.8, 2.5])
def test_a_block_starts_above_all_ground_beside_it(name, reach):
    """Also beside the edge of a cliff; and on a slope not much farther from it than needed."""
    raster = Raster(GROUNDS[name], Affine(1, 0, 0, 0, -1, 30), None, (0, 0))
    chance = np.random.default_rng(1)
    points = chance.uniform(13, 17, (60, 2))
    places = np.stack(np.meshgrid(*[np.linspace(-1, 1, 81)] * 2), -1).reshape(-1, 2)
    places = reach * places[np.hypot(*places.T) < 1]
    height = of_blocks.lifted(raster, points, np.full(60, of_blocks.CLEAR * reach))
    for point, z in zip(points, height):
        x, y = (point + places).T
        ground = sample(raster, x, y)
        away = np.sqrt(((places / reach) ** 2).sum(axis=1) + ((z - ground) / reach) ** 2)
        assert away.min() > 0.99 and (z > ground).all()
        assert name != "slope" or away.min() < 1.05


# --- roads ---

TERRAIN = Raster(np.zeros((50, 90)), Affine(1, 0, 0, 0, -1, 50), None, (0, 0))
START = SimpleNamespace(raster=TERRAIN, sizes=(0.8, 1.2), polygon=Polygon(RELEASE))
ROADS = {"one": box(28, 0, 33, 50), "two": MultiPolygon([box(34, 0, 37, 50), box(24, 0, 27, 50)]),
         "touching": MultiPolygon([box(33, 0, 37, 25), box(33, 25, 37, 50)]),
         "ring": box(20, 2, 88, 48).difference(box(30, 8, 86, 42)), "beyond": box(33, -10, 37, 60),
         "close points": Polygon([(28, 0), (33, 0), (33, 20), (33.00002, 20.00001), (33, 20.00002), (33, 50),
                                  (28, 50)]),
         "island": box(20, 10, 60, 40).difference(box(30, 20, 50, 30))}


@pytest.mark.parametrize("size", [1.2, 0.002])
@pytest.mark.parametrize("name", ROADS)
def test_forward_is_onto_the_road_at_all_its_edges(tmp_path, name, size):
    """From whichever side a block comes: fix control/line has forward from the left of a line to its right."""
    layers = SimpleNamespace(road=ROADS[name], lines=[])
    start = SimpleNamespace(**{**vars(START), "sizes": (size, size)})
    lines = of_blocks.add_edges(OfBlocks.of({}), layers, start, tmp_path)
    touched = edges.touched(ROADS[name], size, TERRAIN)
    assert sum(LineString(line.points).length for line in lines) == pytest.approx(touched.boundary.length, abs=1e-3)
    for line in lines:
        assert np.array_equal(line.points, np.loadtxt(tmp_path / line.file, delimiter=","))
        assert np.array_equal(line.points[0], line.points[-1])
        for one, other in zip(line.points[:-1], line.points[1:]):
            assert not np.array_equal(one, other)
            way = (other - one) / np.hypot(*(other - one))
            right, middle = np.array([way[1], -way[0]]), (one + other) / 2
            assert touched.contains(Point(middle + 1e-3 * right))
            assert not touched.contains(Point(middle - 1e-3 * right))


# --- zones ---

ROUGH = [(TOE - 4, 0), (TOE + 14, 0), (TOE + 14, 50), (TOE - 4, 50)]
ROUGH_OF = {"name": "rough", "friction": 40, "rolling": 0.9, "spacing": 0.5, "restitution": 0.05}
SCREE_OF = {"name": "scree 2", "friction": 25}


@pytest.fixture(scope="module")
def zoned(tmp_path_factory):
    """A site with two zones and a road of two polygons, its study of two runs."""
    folder = tmp_path_factory.mktemp("zoned")
    z = 50 + np.tan(np.radians(40)) * np.maximum(0, (np.arange(COLUMNS) + 0.5) * CELL - TOE)
    write_tif(folder / "dem.tif", np.broadcast_to(z, (ROWS, COLUMNS)), CELL)
    write_layer(folder / "cliff.geojson", RELEASE)
    write_layer(folder / "road.geojson", [[(x, 0), (x + 3, 0), (x + 3, 50), (x, 50)] for x in (30, 20)],
                kind=lambda parts: MultiPolygon([Polygon(part) for part in parts]))
    write_zones(folder / "zones.geojson", [(ROUGH, ROUGH_OF), ([(60, 0), (90, 0), (90, 50), (60, 50)], SCREE_OF)])
    patch = pytest.MonkeyPatch()
    patch.chdir(folder)
    patch.setenv("LMP", LMP)
    patch.setattr(site_map, "draw_site_map", lambda path, *_: path.write_bytes(b""))
    from slope_tools import cli
    words = ["--terrain", "dem.tif", "--release", "cliff.geojson", "--road", "road.geojson", "--ground",
             "zones.geojson", "--blocks", "80", "--size", "0.8:1.2", "--rolling", "0.05"]
    assert cli.main(["site", *words, "-o", "mine"]) == 0
    about = yaml.safe_load((folder / "mine" / "site.yaml").read_text())
    about["blocks"]["grounds"] = 2
    (folder / "mine" / "site.yaml").write_text(yaml.safe_dump(about))
    assert cli.main(["site", "mine"]) == 0 and cli.main(["study", "mine", "--jobs", "2"]) == 0
    patch.undo()
    found = site_choices.load_kind(folder / "mine", OfBlocks)
    return SimpleNamespace(folder=folder / "mine", site=found, known=study.read_block_runs(found))


def test_the_deck_has_the_coefficients_of_the_zones(zoned):
    variables = {**decks.index_variables(zoned.folder / site_deck.NAME), "rolling": "0.05"}
    log = (zoned.known.runs[0].folder / "log.lammps").read_text()
    for number, zone in enumerate(zoned.site.found.zones, of_blocks.FIELD + 1):
        now = site_zones.now(zone, zoned.site.choices.model, variables)
        coeff = re.findall(rf"^pair_coeff  1 {number} .*restitution (\S+) friction (\S+) rolling (\S+)$", log, re.M)[-1]
        assert [float(one) for one in coeff] == pytest.approx([now["field_e"], now["friction"], now["rolling"]])
    assert [zone.name for zone in zoned.site.found.zones] == ["rough", "scree 2"]
    assert "zone zone_rough 4 0.4 " in log and re.search(r"zone zone_scree_2 5$", log, re.M)


def test_blocks_stop_in_a_rough_zone(zoned, tmp_path):
    """Most of those that roll through it where it has the coefficients of the ground beside it."""
    own = zoned.known.runs[0]
    for path in own.folder.glob("*.*"):
        if path.suffix in (".asc", ".csv", ".data", ".site"):
            shutil.copy(path, tmp_path)
    same = {"rolling": "0.05", "rolling_rough": "0.05", "friction_rough": "30", "spacing_rough": "0.9",
            "field_e_rough": "0.1"}
    words = [word for name, value in same.items() for word in ("-var", name, value)]
    subprocess.run([LMP, "-in", site_deck.NAME, "-log", "none", "-screen", "none", *words], cwd=tmp_path, check=True)
    other = runs.read_block_run("same", tmp_path, {"rolling": "0.05", "ground": "1"}, zoned.known.terrain)
    stopped, rolled = (one.end[:, 0] > TOE - 4 for one in (own, other))
    assert stopped.mean() > 0.8 and rolled.mean() < 0.3
    assert other.reached.mean() > own.reached.mean() + 0.4


def test_the_page_says_what_the_ground_is_where(zoned, monkeypatch):
    [ground] = [one for one in page.tables(zoned.known) if one.id == "ground"]
    [table] = ground.blocks
    assert [list(row) for row in table.rows] == [
        ["rough", "20", "40", "0.9", "0.05", "0.5"], ["scree 2", "33.3", "25", "0.05", "0.1", "0.9"],
        ["outside of all zones", "46.7", "30", "0.05", "0.1", "0.9"]]
    seen = []
    monkeypatch.setattr(figure_maps, "value_map", lambda layers, *_: seen.append(layers) or "")
    page.write_block_page(zoned.known, zoned.folder / "again.html")
    for layers in seen:
        assert layers.zones["rough"].equals_exact(Polygon(ROUGH), 1e-3) or layers.zones["rough"].equals(Polygon(ROUGH))
        assert list(layers.zones) == ["rough", "scree 2"] and layers.release.sum() == 50
    assert "0.1 outside of the zones" in (zoned.folder / "again.html").read_text(encoding="utf-8")
    assert "zones" not in page.how(replace(zoned.site, found=replace(zoned.site.found, zones=())))


def test_both_polygons_of_a_road_count(zoned):
    """By block; the road is passed where the first of its polygons is."""
    run = zoned.known.runs[1]
    several = [table_of(path, runs.CROSSING) for path in run.folder.glob(f"{runs.PREFIX}.{edges.EDGE}_*.line.csv")]
    assert len(several) == 2
    assert set(np.concatenate([one["ball"] for one in several]) - 1) == set(np.flatnonzero(run.reached))
    assert (run.reached >= (run.end[:, 0] < 33)).all() and (run.passed >= (run.end[:, 0] < 29)).all()


def test_a_wrong_zone_is_one_line(zoned, capsys, monkeypatch):
    monkeypatch.chdir(zoned.folder.parent)
    write_zones(zoned.folder.parent / "wrong.geojson", [(ROUGH, {"friction": 95})])
    words = ["--terrain", "dem.tif", "--release", "cliff.geojson", "--blocks", "80", "--size", "0.8"]
    status, _, err = called(capsys, ["site", *words, "--ground", "wrong.geojson", "-o", "wrong"])
    assert status == 2 and err.count("\n") == 1 and "feature 0: friction: must be < 90, got 95" in err
    assert not (zoned.folder.parent / "wrong" / site_deck.NAME).exists()
