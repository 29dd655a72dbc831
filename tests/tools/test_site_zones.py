"""Ground by zone: what slope site reads from polygons or classes, what is refused, the deck, the stop angle."""
import json
import re
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from affine import Affine
from rasterio.crs import CRS
from rasterio.warp import transform as warp
from shapely.geometry import Point, Polygon, box, mapping

from run_helpers import write_tif
from test_site import CELL, EAST, NORTH, RELEASE, ROAD, slope, write_dem, write_layer
from tiny_collapse import LMP

from slope_tools.case import decks
from slope_tools.errors import SlopeError
from slope_tools.report import maps_part
from slope_tools.route import runs
from slope_tools.route.choices import Choices
from slope_tools.sites import site_choices, site_warnings, site_zones
from slope_tools.sites.site_found import Zone
from slope_tools.sites.site_sections import OfMass
from slope_tools.studies import site_ground
from slope_tools.survey import polygons
from slope_tools.survey.rasters import Raster, read_asc_local, write_asc_local

TERRAIN = Raster(np.full((40, 60), 100.0), Affine(2, 0, 0, 0, -2, 80), CRS.from_epsg(6677), (EAST, NORTH))
SCREE, FOREST, STRIP = ([(0, 0), (40, 0), (40, 40), (0, 40)], [(30, 30), (70, 30), (70, 70), (30, 70)],
                        [(10, 50), (25, 50), (25, 78)])
THREE = [(SCREE, {"name": "scree", "friction": 35, "spacing": 0.6}),
         (FOREST, {"name": "森", "rolling": "0.15", "restitution": 0.2, "id": 4}), (STRIP, {"Spacing": 0.5})]


def write_zones(path, several, crs="EPSG:6677"):
    """Zones in local metres as GeoJSON in a CRS."""
    rows = []
    for points, about in several:
        points = np.array(points, float) + (EAST, NORTH)
        if crs != "EPSG:6677":
            points = np.transpose(warp("EPSG:6677", crs, *points.T))
        rows.append({"type": "Feature", "properties": about, "geometry": mapping(Polygon(points))})
    path.write_text(json.dumps({"type": "FeatureCollection", "features": rows, "crs": {
        "type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{crs.split(':')[1]}"}}}))
    return path


def read(path, table=None, warn=lambda _: None):
    return site_zones.read_site_zones(site_zones.Source(str(path), table and str(table), None, polygons.ADVICE),
                                      TERRAIN, warn)


def at(zones, x, y):
    return [zone.name for zone in zones if zone.geometry.contains(Point(x, y))]


def expected(x, y, several=THREE, names=("scree", "森", "zone 3")):
    """The last of the polygons that a place lies in."""
    found = [name for (points, _), name in zip(several, names) if Polygon(points).contains(Point(x, y))]
    return found[-1:]


# --- reading ---

@pytest.mark.parametrize("crs", ["EPSG:6677", "EPSG:4326"])
def test_the_values_at_a_thousand_places_are_those_of_the_polygon_there(tmp_path, crs):
    said = []
    zones = read(write_zones(tmp_path / "zones.geojson", THREE, crs), warn=said.append)
    assert [zone.values for zone in zones] == [{"friction": 35, "spacing": 0.6}, {"rolling": 0.15, "restitution": 0.2},
                                               {"spacing": 0.5}]
    assert [zone.word for zone in zones] == ["scree", "zone", "zone_3"]
    assert [one.kind for one in said] == ["zones overlap"]
    for x, y in np.random.default_rng(1).uniform((0, 0), (120, 80), (1000, 2)):
        assert at(zones, x, y) == expected(x, y)


def test_classes_of_a_raster_are_the_same_zones(tmp_path):
    rows, columns = np.meshgrid(np.arange(40), np.arange(60), indexing="ij")
    places = np.stack([columns * CELL + 1, 80 - rows * CELL - 1], axis=-1)
    classes = np.array([[7 if expected(*place, THREE[:2], "ab") == ["b"] else
                         3 if expected(*place, THREE[:2], "ab") else 0 for place in row] for row in places])
    write_tif(tmp_path / "classes.tif", classes.astype(np.int16), CELL, crs="EPSG:6677")
    (tmp_path / "table.csv").write_text("class,name,friction,rolling,spacing\n0,,,,\n3,scree,35,,0.6\n"
                                        "7,forest,,0.15,\n")
    zones = read(tmp_path / "classes.tif", tmp_path / "table.csv")
    assert [(zone.name, zone.values) for zone in zones] == [("scree", {"friction": 35, "spacing": 0.6}),
                                                            ("forest", {"rolling": 0.15})]
    assert [zone.geometry.area for zone in zones] == [1500, 1600]
    for x, y in np.random.default_rng(2).uniform((0, 0), (120, 80), (300, 2)):
        assert at(zones, x, y) == [{"b": "forest", "a": "scree"}[one] for one in expected(x, y, THREE[:2], "ab")]


def test_features_of_a_name_or_of_the_same_values_are_one_zone(tmp_path):
    far = [(x + 60, y) for x, y in STRIP]
    one, other = {"friction": 35}, {"name": "a", "friction": 35}
    several = [(SCREE, one), (STRIP, other), (far, {"friction": 35.0, "name": " "})]
    zones = read(write_zones(tmp_path / "z.geojson", several))
    assert [(zone.name, round(zone.geometry.area)) for zone in zones] == [("zone 1", 1810), ("a", 210)]


def test_parts_beyond_the_terrain_are_cut_off(tmp_path):
    beyond = [(1000, 0), (1100, 0), (1100, 50)]
    over = [(-50, -50), (60, -50), (60, 500), (-50, 500)]
    [zone] = read(write_zones(tmp_path / "z.geojson", [(over, {"friction": 35}), (beyond, {"friction": 20})]))
    assert zone.about(TERRAIN)["area_m2"] == 60 * 80 and zone.about(TERRAIN)["share"] == 0.5


def test_names_of_a_shapefile_have_ten_letters(tmp_path):
    [zone] = read(write_zones(tmp_path / "z.geojson", [(SCREE, {"restitutio": 0.3, "OBJECTID": 3})]))
    assert zone.values == {"restitution": 0.3}


@pytest.mark.parametrize("about, message", [
    ({}, "feature 0: must have a value of friction, rolling, restitution, spacing, at least one, got none"),
    ({"name": "a", "friction": None}, "must have a value of friction"),
    ({"fricton": 30}, "must have attributes named .*: friction\\?, got fricton"),
    ({"friction": 95}, "feature 0: friction: must be < 90, got 95"),
    ({"spacing": 0.99}, "spacing: must be <= 0.95, got 0.99"),
    ({"restitution": 1.2}, "restitution: must be <= 1, got 1.2"),
    ({"rolling": "rough"}, "rolling: must be a number, got rough"),
    ({"rolling": True}, "rolling: must be a number, got True")])
def test_refused_attributes(tmp_path, about, message):
    with pytest.raises(SlopeError, match=message):
        read(write_zones(tmp_path / "z.geojson", [(SCREE, about)]))


def test_refused_files(tmp_path):
    far = write_zones(tmp_path / "far.geojson", [([(x + 9000, y) for x, y in SCREE], {"friction": 35})])
    two = write_zones(tmp_path / "two.geojson", [(SCREE, {"name": "a", "friction": 35}),
                                                 (FOREST, {"name": "a", "friction": 30})])
    (tmp_path / "plain.csv").write_text("0,0\n10,0\n10,10\n")
    write_tif(tmp_path / "classes.tif", np.full((40, 60), 3, np.int16), CELL, crs="EPSG:6677")
    write_tif(tmp_path / "heights.tif", np.full((40, 60), 3.5), CELL, crs="EPSG:6677")
    (tmp_path / "table.csv").write_text("class,friction\n4,30\n")
    (tmp_path / "twice.csv").write_text("class,friction\n3,30\n3,31\n")
    (tmp_path / "headless.csv").write_text("3,30\n")
    classes, table_ = tmp_path / "classes.tif", tmp_path / "table.csv"
    for path, table, message in ((far, None, "must overlap the terrain, none of its zones does"),
                                 (two, None, "one set of values for each name.*got two for a"),
                                 (tmp_path / "plain.csv", None, "must have attributes"),
                                 (classes, None, "--ground-table: must be given with a raster"),
                                 (two, table_, "--ground-table: must be given with a raster"),
                                 (classes, table_, "a line for each class.*none for 3"),
                                 (classes, tmp_path / "twice.csv", "line 3: class: must be a number that"),
                                 (classes, tmp_path / "headless.csv", "must have the columns class"),
                                 (classes, tmp_path / "none.csv", "must be a table"),
                                 (tmp_path / "heights.tif", table_, "must hold classes, whole numbers, got")):
        with pytest.raises(SlopeError, match=message):
            read(path, table)


def test_a_covered_zone_is_told(tmp_path):
    said = []
    over = [(0, 0), (90, 0), (90, 80), (0, 80)]
    zones = read(write_zones(tmp_path / "z.geojson", [(STRIP, {"name": "a", "friction": 35}),
                                                      (over, {"name": "b", "friction": 30})]), warn=said.append)
    assert [zone.name for zone in zones] == ["b"]
    assert [one.kind for one in said] == ["zones overlap", "zone covered"]


def test_a_resistance_that_looks_like_an_angle_is_warned_of_by_its_zone(tmp_path):
    zones = read(write_zones(tmp_path / "z.geojson", [(SCREE, {"name": "a", "friction": 0.6, "rolling": 12})]))
    assert [str(one).partition(":")[0] for one in site_warnings.of_zones(zones)] == [
        "friction of zone a 0.6", "rolling of zone a 12"]


# --- what changes with the site's values ---

MODEL = OfMass.of({"model": {"friction": 30, "field_restitution": 0.1, "spacing": 0.9}}).model
RUN = {"friction": "30", "rolling": "0", "field_e": "0.1", "spacing": "0.9"}


@pytest.mark.parametrize("changed, now", [
    ({}, {"friction": 35, "rolling": 0, "field_e": 0.3, "spacing": 0.6}),
    ({"friction": "15"}, {"friction": 17.5}), ({"friction": "80"}, {"friction": 89}),
    ({"friction_a": "20"}, {"friction": 20}), ({"friction_a": "20", "friction": "15"}, {"friction": 10}),
    ({"field_e": "0.05"}, {"field_e": 0.15}), ({"field_e": "0.5"}, {"field_e": 0.9}),
    ({"field_e": "0.9", "field_e_a": "0.95"}, {"field_e": 0.95}),
    ({"spacing": "0.45"}, {"spacing": 0.3}), ({"spacing": "0.2"}, {"spacing": 0.2}),
    ({"spacing": "0.3", "spacing_a": "0.95"}, {"spacing": 0.95 / 3}),
    ({"spacing": "0.95", "spacing_a": "0.95"}, {"spacing": 0.95}),
    ({"spacing": "0.3", "spacing_a": "0.15"}, {"spacing": 0.15}),
    ({"rolling": "0.1"}, {"rolling": 0.1})])
def test_values_change_by_the_factor_of_the_sites(changed, now):
    values = {"friction": 35.0, "restitution": 0.3, "spacing": 0.6}
    found = site_zones.now(Zone("a", "a", values, 0.1), MODEL, {**RUN, **changed})
    assert {name: found[name] for name in now} == pytest.approx(now)
    rolls = Zone("a", "a", {**values, "rolling": 0.15}, 0.1)
    own = site_zones.now(rolls, MODEL, {**RUN, "rolling": "0.1"})
    assert own["rolling"] == 0.15       # a factor of 0 has no meaning
    assert site_zones.now(rolls, MODEL, {**RUN, "rolling_a": "0.2"})["rolling"] == 0.2


# --- the site ---

@pytest.fixture(scope="module")
def gis(tmp_path_factory):
    folder = tmp_path_factory.mktemp("zones")
    write_dem(folder / "dem.tif")
    write_layer(folder / "release.geojson", RELEASE)
    write_layer(folder / "road.geojson", ROAD)
    write_zones(folder / "zones.geojson", THREE)
    write_zones(folder / "all.geojson", [([(-50, -50), (500, -50), (500, 400), (-50, 400)], {"friction": 30})])
    return folder


def make(folder, name, *words):
    found = slope(folder, "site", "--terrain", "dem.tif", "--release", "release.geojson", "--depth", 4, "--road",
                  "road.geojson", "--balls", 150, *words, "-o", name)
    assert found.returncode == 0, found.stderr
    return found.stdout


@pytest.fixture(scope="module")
def mine(gis):
    return make(gis, "mine", "--ground", "zones.geojson")


def lmp(folder, *words):
    run = subprocess.run([LMP, "-in", "in.site", "-log", "log.test", *words], cwd=folder, text=True,
                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600)
    assert run.returncode == 0, run.stdout[-2000:]
    return (folder / "log.test").read_text()


def test_a_site_with_zones(gis, mine):
    assert "ground.scree.csv: zone scree, 15.6 % of the terrain, 1,500 m2: friction 35, spacing 0.6" in mine
    assert re.search(r"zone scree: stop angle 15.\d, 18.\d, 21.\d degrees at a rolling .* 0, 0.05, 0.1", mine)
    assert re.search(r"zone 森: stop angle 30.\d degrees at a rolling resistance of 0.15$", mine, re.M)
    site = site_choices.load_site(gis / "mine")
    found = site.found
    assert [zone.name for zone in found.zones] == ["scree", "森", "zone 3"]
    assert {"ground.gpkg", "ground.scree.csv", "ground.zone.csv", "ground.zone_3.csv"} <= set(found.files)
    variables = decks.index_variables(gis / "mine" / "in.site")
    own = [variables[name] for name in ("friction_scree", "rolling_zone", "spacing_zone_3")]
    assert own == ["35", "0.15", "0.5"]
    angles = site_ground.of_zone(found.zones[0], site.choices.model, variables)
    assert angles == pytest.approx(site_ground.of_variables({**variables, "friction": 35, "spacing": 0.6}))


def test_the_maps_of_a_report_have_the_zones(gis, mine):
    """Of a study in the site's folder; none where the files of the zones are gone."""
    data = SimpleNamespace(site=site_choices.load_site(gis / "mine").content, folder=gis / "mine" / "study")
    raster = read_asc_local(gis / "mine" / "terrain.asc")
    found = maps_part.zones_of(data, raster)
    assert list(found) == ["scree", "森", "zone 3"]
    assert found["scree"].area == 1500 and found["森"].equals(Polygon(FOREST))
    data.folder = tmp = gis / "moved"
    tmp.mkdir()
    (tmp / "site.yaml").write_bytes((gis / "mine" / "site.yaml").read_bytes())
    assert maps_part.zones_of(data, raster) == {}


@pytest.mark.parametrize("changed", [{}, {"friction": "15", "spacing": "0.5", "field_e": "0.6"},
                                     {"friction_scree": "20", "friction": "88", "spacing": "0.2"}])
def test_the_deck_has_the_values_of_a_run(gis, mine, changed):
    """What the deck's formulas give is what site_zones.now() says, which the report shows."""
    folder = gis / "mine"
    words = [word for name, value in changed.items() for word in ("-var", name, value)]
    log = lmp(folder, *words, "-var", "duration", "0.001")
    site = site_choices.load_site(folder)
    variables, model = decks.index_variables(folder / "in.site"), site.choices.model
    d = float(variables["d"])

    # 1.5 times the rule's step; on ground closer than 0.4 d, of a zone, too, the rule's
    kn, dt = (float(re.findall(pattern, log, re.M)[-1])
              for pattern in (r"^Stiffness: kn (\S+)", r"^timestep +([0-9]\S*)"))
    rule = 0.25 * (float(variables["density"]) * np.pi / 6 * d ** 3 / kn) ** 0.5
    assert dt == pytest.approx((1.0 if "spacing" in changed else 1.5) * rule, rel=1e-3)
    for number, zone in enumerate(site.found.zones, 4):
        now = site_zones.now(zone, model, {**variables, **changed})
        coeff = re.findall(rf"^pair_coeff  1 {number} .*restitution (\S+) friction (\S+) rolling (\S+)$", log, re.M)[-1]
        assert [float(one) for one in coeff] == pytest.approx([now["field_e"], now["friction"], now["rolling"]])
        if "spacing" in zone.values:
            [apart] = re.findall(rf"zone zone_{zone.variables} {number} (\S+)", log)[-1:]
            assert float(apart) == pytest.approx(now["spacing"] * d)


def test_the_deck_has_at_a_thousand_places_the_coefficients_of_the_polygon_there(gis, mine):
    """By the files that its regions read, the order of its zones, and the coefficients of their types."""
    folder = gis / "mine"
    log = lmp(folder, "-var", "duration", "0.001", "-var", "rolling", "0.05")
    d = float(re.search(r"^variable +d +index +(\S+)", log, re.M)[1])
    field = re.findall(r"^fix +field .*", log, re.M)[-1]
    zones = [(box(-1e3, -1e3, 1e3, 1e3), "3", re.search(r" spacing (\S+)", field)[1])]
    for name, kind, apart in re.findall(r"zone (\S+) (\d+)(?: +(\d\S*))?", field):
        [path] = re.findall(rf"^region +{name} polygon (\S+)$", log, re.M)
        zones.append((polygons.read_local(folder / path, TERRAIN, True), kind, apart or zones[0][2]))
    pairs = {kind: re.findall(rf"^pair_coeff  1 {kind} .*restitution (\S+) friction (\S+) rolling (\S+)$", log,
                              re.M)[-1] for _, kind, _ in zones}
    asked = [(points, {name.lower(): value for name, value in about.items()}) for points, about in THREE]
    for x, y in np.random.default_rng(4).uniform((0, 0), (120, 80), (1000, 2)):
        kind, apart = [one[1:] for one in zones if one[0].contains(Point(x, y))][-1]
        about = {**RUN, "restitution": RUN["field_e"], "rolling": 0.05}
        about.update(([own for points, own in asked if Polygon(points).contains(Point(x, y))] or [{}])[-1])
        assert [*map(float, pairs[kind]), float(apart) / d] == pytest.approx(
            [float(about[name]) for name in ("restitution", "friction", "rolling", "spacing")])


def test_one_zone_of_all_with_the_sites_values_is_the_site(gis):
    make(gis, "none")
    make(gis, "all", "--ground", "all.geojson")
    for name in ("none", "all"):
        lmp(gis / name)
    one, other = ((gis / name / "site.thickness.asc").read_bytes() for name in ("none", "all"))
    assert one == other
    summaries = [yaml.safe_load((gis / name / "site.summary.yaml").read_text()) for name in ("none", "all")]
    assert summaries[0]["travel"] == summaries[1]["travel"]


def test_a_deck_without_zones_has_no_word_of_them(gis):
    assert "zone" not in (gis / "none" / "in.site").read_text()


def test_a_changed_file_of_zones_is_noticed(gis, tmp_path):
    """As every other source of a site."""
    assert "../zones.geojson" in site_choices.load_site(gis / "mine").sources()


def test_the_sites_of_a_route_have_the_zones_that_lie_on_them(tmp_path):
    write_asc_local(tmp_path / runs.TERRAIN, TERRAIN, {})
    write_zones(tmp_path / "here.geojson", THREE)
    write_zones(tmp_path / "far.geojson", [([(x + 9000, y) for x, y in SCREE], {"friction": 35})])
    about = {"body": 1, "name": "a body", "road_from_m": 0.0}
    for name, there in (("here.geojson", True), ("far.geojson", False)):
        path = str(tmp_path / name)
        choices = Choices([], "", 5.0, 100.0, None, None, 1800.0, ground=path)
        found = runs.choices_of(choices, tmp_path, about, 1).ground
        assert (found.file, found.table) == (path if there else None, None)
