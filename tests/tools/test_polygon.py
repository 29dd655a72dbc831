"""tools/slope polygon: polygons of every format to the deck's rings, against shapely and hand-made numbers."""
import json
import os
import re
import shlex
import time
import zipfile
from pathlib import Path

import fiona
import numpy as np
import pytest
import rasterio.warp
from affine import Affine
from rasterio.crs import CRS
from shapely.affinity import translate
from shapely.geometry import MultiLineString, MultiPolygon, Point, Polygon, box, mapping
from shapely.ops import unary_union

from messages import is_one
from run_helpers import called, examples

from slope_tools import cli
from slope_tools.survey import lines, polygons, rasters

TOP = Path(__file__).resolve().parents[2]
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
CRS_M = "EPSG:6677"
EAST, NORTH = -12000.0, 34000.0    # local 0 0 of the terrain, which is 100 m x 80 m
ROAD = Polygon([(10, 10), (60, 12.5), (62.25, 30), (12, 27)], [[(20, 15), (20, 20), (25, 20), (25, 15)]])
LINE = "# local metres: east = x + -12000.0, north = y + 34000.0, CRS EPSG:6677\n"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    terrain()
    return tmp_path


@pytest.fixture
def slope(here, capsys):
    """Run `slope polygon ARGUMENTS --terrain t.asc`; gives status, stdout, stderr."""
    def run(arguments, terrain="t.asc"):
        return called(capsys, ["polygon", *shlex.split(arguments), "--terrain", terrain])
    return run


@pytest.fixture
def written(slope):
    """Run it with -o out.csv, which must succeed; gives the rings of the file, (number, 2) each, and stdout."""
    def run(arguments):
        status, out, err = slope(f"{arguments} -o out.csv")
        assert (status, err) == (0, ""), err
        return rings("out.csv"), out
    return run


def terrain(path="t.asc", crs=CRS_M, offset=(EAST, NORTH)):
    raster = rasters.Raster(np.full((16, 20), 5.0), Affine(5, 0, 0, 0, -5, 80), crs and CRS.from_string(crs), offset)
    rasters.write_asc_local(path, raster, {})


def rings(path):
    """The rings of a file in the deck's format, read by the letter of the format."""
    blocks = [[]]
    for line in Path(path).read_text().splitlines():
        if not line:
            blocks.append([])
        elif not line.startswith("#"):
            blocks[-1].append([float(word) for word in line.split(",")])
    return [np.array(block) for block in blocks]


def inside(found, x, y):
    """Even-odd rule over all rings, for point arrays."""
    odd = np.zeros(x.shape, bool)
    for ring in found:
        for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0)):
            if ay != by:
                odd ^= ((ay > y) != (by > y)) & (x < ax + (bx - ax) * (y - ay) / (by - ay))
    return odd


def moved(geometry, crs=CRS_M, local=False):
    """Local metres to coordinates of a CRS, as a plain geometry."""
    def points(ring):
        x, y = np.array(ring.coords).T
        if local:
            return list(zip(x.tolist(), y.tolist()))
        return list(zip(*rasterio.warp.transform(CRS_M, crs, (x + EAST).tolist(), (y + NORTH).tolist())))
    parts = [Polygon(points(part.exterior), [points(hole) for hole in part.interiors])
             for part in polygons.polygons_of(geometry)]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)


def geojson(path, *geometries, crs=None):
    features = [{"type": "Feature", "properties": {}, "geometry": g and mapping(g)} for g in geometries]
    text = {"type": "FeatureCollection", "features": features}
    if crs:
        text["crs"] = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:{crs.replace(':', '::')}"}}
    Path(path).write_text(json.dumps(text))


def shapefile(path, *geometries, crs=None):
    schema = {"geometry": "Polygon", "properties": {"n": "int"}}
    with fiona.open(path, "w", driver="ESRI Shapefile", schema=schema, crs=crs) as out:
        for n, geometry in enumerate(geometries):
            out.write({"geometry": mapping(geometry), "properties": {"n": n}})


def assert_is(found, geometry, tolerance=1e-5):
    """That the rings are the geometry: the same area, and no point of an edge off it."""
    other = polygons.read_local("out.csv", rasters.read_place("t.asc"))
    assert other.symmetric_difference(geometry).area < tolerance * geometry.length
    assert sum(map(len, found)) == sum(map(len, polygons.rings_of(geometry)))
    rng = np.random.default_rng(1)
    xlo, ylo, xhi, yhi = geometry.bounds
    x, y = rng.uniform(xlo, xhi, 500), rng.uniform(ylo, yhi, 500)
    assert (inside(found, x, y) == [geometry.contains(Point(p)) for p in zip(x, y)]).all()


# --- what is written ---

def test_the_file_to_the_letter(slope, here):
    road = Polygon([(1, 2), (11, 2), (11, 7.5), (1, 7.5)], [[(2, 3), (2, 4), (3, 4)]])
    geojson("road.geojson", moved(road), crs=CRS_M)
    assert slope("road.geojson -o road.csv") == (
        0, "road.csv: 1 polygon, 2 rings (1 hole), 7 vertices, x 1.000 to 11.000, y 2.000 to 7.500, area 54.500 m2\n"
        "region road polygon road.csv\n", "")
    assert (here / "road.csv").read_text() == (
        LINE + "1.0,2.0\n11.0,2.0\n11.0,7.5\n1.0,7.5\n\n2.0,3.0\n2.0,4.0\n3.0,4.0\n")
    assert not [name for name in os.listdir() if ".new" in name]


WGS = "EPSG:4326"
TEXT_CSV = "\n\n".join("\n".join(f"{x + EAST!r},{y + NORTH!r}" for x, y in ring.coords[:-1])
                       for ring in (ROAD.exterior, *ROAD.interiors))


@pytest.mark.parametrize("name, make, options", [
    ("a.geojson", lambda path: geojson(path, moved(ROAD), crs=CRS_M), ""),
    ("a.geojson", lambda path: geojson(path, moved(ROAD, WGS)), ""),
    ("a.geojson", lambda path: geojson(path, moved(ROAD)), "--assign-crs EPSG:6677"),
    ("a.geojson", lambda path: geojson(path, moved(ROAD), crs="EPSG:6676"), "--assign-crs EPSG:6677"),
    ("a.geojson", lambda path: geojson(path, ROAD), "--local"),
    ("a.shp", lambda path: shapefile(path, moved(ROAD), crs=CRS_M), ""),
    ("a.shp", lambda path: shapefile(path, moved(ROAD, "EPSG:6676"), crs="EPSG:6676"), ""),
    ("a.shp", lambda path: shapefile(path, moved(ROAD, "EPSG:6668"), crs="EPSG:6668"), ""),
    ("a.shp", lambda path: shapefile(path, moved(ROAD)), "--assign-crs EPSG:6677"),
    ("a.csv", lambda path: Path(path).write_text(TEXT_CSV), ""),
    ("a.csv", lambda path: Path(path).write_bytes(f"\ufeffeast,north\n{TEXT_CSV}".replace("\n", "\r\n").encode()), ""),
    ("a.csv", lambda path: Path(path).write_text("\n\n".join("\n".join(f"{x},{y}  # point" for x, y in ring.coords)
                                                             for ring in (ROAD.exterior, *ROAD.interiors))), "--local"),
    ("a.wkt", lambda path: Path(path).write_text(moved(ROAD).wkt), ""),
    ("a.txt", lambda path: Path(path).write_text("# road\n" + moved(ROAD).wkt.replace("), (", "),\n(")), ""),
    ("a.wkt", lambda path: Path(path).write_text("GEOMETRYCOLLECTION(" + moved(ROAD, WGS).wkt + ")"),
     f"--assign-crs {WGS}"),
    ("a.wkt", lambda path: Path(path).write_text("SRID=6677;" + moved(ROAD).wkt), ""),
    ("a.wkt", lambda path: Path(path).write_text("srid = 4326; " + moved(ROAD, WGS).wkt), ""),
    ("a.wkt", lambda path: Path(path).write_text("SRID=0;" + moved(ROAD).wkt), ""),
    ("a.wkt", lambda path: Path(path).write_text("SRID=4326;" + ROAD.wkt), "--local"),
    ("a.csv", lambda path: Path(path).write_text(f'WKT,name\n"{moved(ROAD).wkt}",road\n'), ""),
    ("a.csv", lambda path: Path(path).write_text(f'id;wkt_geom;name\r\n1;{moved(ROAD).wkt};"a; b"\r\n'), ""),
    ("a.csv", lambda path: Path(path).write_text(f'"geom"\n"SRID=4326;{moved(ROAD, WGS).wkt}"\n'), ""),
], ids=lambda value: value if isinstance(value, str) else "")
def test_every_format(written, name, make, options):
    make(name)
    found, out = written(f"{name} {options}")
    assert_is(found, ROAD)
    assert f"area {ROAD.area:.3f} m2" in out or f"area {ROAD.area - 0.001:.3f} m2" in out


@pytest.mark.parametrize("closed", [1, 0])
def test_a_closed_line_of_a_drawing_is_an_area(slope, closed):
    points = list(moved(ROAD).exterior.coords)[:-1]
    lines = ["0", "SECTION", "2", "ENTITIES", "0", "LWPOLYLINE", "8", "0", "90", str(len(points)), "70", str(closed),
             *(word for x, y in points for word in ("10", repr(x), "20", repr(y))), "0", "ENDSEC", "0", "EOF", ""]
    Path("a.dxf").write_text("\n".join(lines))
    status, _, err = slope("a.dxf --assign-crs EPSG:6677 -o out.csv")
    if closed:
        assert (status, err) == (0, "")
        assert_is(rings("out.csv"), Polygon(ROAD.exterior))
    else:
        assert status == 2 and "a.dxf: feature 0: must be a polygon, got LineString" in err


def test_texts_of_several_systems_are_refused(slope):
    Path("a.wkt").write_text(f"SRID=6677;{moved(ROAD).wkt}\nSRID=6676;{moved(ROAD).wkt}\n")
    status, _, err = slope("a.wkt -o out.csv")
    assert status == 2 and err.count("\n") == 1 and "a.wkt: must be in one CRS, got SRID=6676 and SRID=6677" in err


def test_layers_of_a_file(slope):
    """The only layer of polygons is taken; of several one must be named, as QGIS does or as an option."""
    layers = [("axis", "LineString", moved(ROAD).exterior), ("road", "Polygon", moved(ROAD))]
    for name, kind, geometry in layers:
        with fiona.open("a.gpkg", "w", driver="GPKG", layer=name, crs=CRS_M,
                        schema={"geometry": kind, "properties": {}}) as out:
            out.write({"geometry": {**mapping(geometry), "type": kind}, "properties": {}})
    assert slope("a.gpkg -o out.csv")[0] == 0
    with fiona.open("a.gpkg", "w", driver="GPKG", layer="other road", crs=CRS_M,
                    schema={"geometry": "Polygon", "properties": {}}) as out:
        out.write({"geometry": mapping(moved(ROAD)), "properties": {}})
    for arguments in ("'a.gpkg|layername=other road' -o out.csv", "a.gpkg --layer road -o out.csv",
                      "'a.gpkg|layername=road|geometrytype=Polygon' -o out.csv"):
        assert slope(arguments)[0] == 0
        assert_is(rings("out.csv"), ROAD)
    for arguments, rule in (
            ("a.gpkg --layer rood", "a.gpkg: must have the named layer, one of axis, road, other road, got rood"),
            ("'a.gpkg|layername=road' --layer road", "--layer: must not be given with a.gpkg|layername=road, which "
             "names a layer, got road"),
            ("a.gpkg --layer axis", "a.gpkg: feature 1: must be a polygon, got LineString")):
        assert slope(f"{arguments} -o none.csv")[2] == f"slope polygon: {rule}\n"


def layer(path, name, kind, *geometries):
    with fiona.open(path, "w", "GPKG", {"geometry": kind, "properties": {}}, layer=name, crs_wkt=moved.crs) as out:
        out.writerecords({"type": "Feature", "geometry": geometry and mapping(geometry), "properties": {}}
                         for geometry in geometries)


moved.crs = CRS.from_string(CRS_M).to_wkt()
OF_QGIS = ("layer_styles", "None", None)


@pytest.mark.parametrize("others, fits", [
    ([OF_QGIS], True), ([OF_QGIS, ("qgis_projects", "None", None)], True),
    ([("line", "LineString", MultiLineString([[(0, 0), (1, 1)]]).geoms[0])], True),
    ([OF_QGIS, ("points", "Unknown", Point(EAST, NORTH))], True), ([("later", "Polygon")], True),
    ([OF_QGIS, ("more", "Polygon", moved(ROAD))], False), ([("more", "Unknown", moved(ROAD))], False)])
@pytest.mark.parametrize("kind", ["Unknown", "Polygon", "MultiPolygon"])
def test_tables_without_geometry_are_no_layers(written, slope, others, fits, kind):
    """Of the rest, the one whose features are polygons; in some of them the type is not declared."""
    layer("a.gpkg", "scar", kind, MultiPolygon([moved(ROAD)]) if kind == "MultiPolygon" else moved(ROAD))
    for name, of, *geometries in others:
        layer("a.gpkg", name, of, *geometries)
    if fits:
        assert_is(written("a.gpkg")[0], ROAD)
    else:
        assert slope("a.gpkg -o new.csv")[2].endswith(": scar, more, got 2 layers\n")


@pytest.mark.parametrize("end, keep", [(".shp", 300), (".shp", 110), (".shx", 110), (".dbf", 100)])
def test_a_shapefile_that_is_cut_short_is_refused(slope, here, end, keep):
    """An interrupted copy, also of one of its other files: GDAL leaves out what it cannot read."""
    shapefile("a.shp", *(translate(moved(ROAD), 40 * k) for k in range(4)), crs=CRS_M)
    assert slope("a.shp -o new.csv")[0] == 0
    zipped("whole.zip", "a")
    assert slope("whole.zip -o new.csv --overwrite")[0] == 0
    whole = Path(f"a{end}").read_bytes()
    Path(f"a{end}").write_bytes(whole[:keep])
    zipped("cut.zip", "a")
    for name in ("a.shp", "cut.zip"):
        status, _, err = slope(f"{name} -o other.csv")
        assert status == 2 and f"a{end}: must have the {len(whole) - (end == '.dbf')} bytes that its head says" in err
        assert err.endswith(f"got {keep}\n") and not (here / "other.csv").exists()


def test_three_dimensions_are_two(written):
    Path("a.wkt").write_text("POLYGON Z ((10 10 5, 20 10 5, 20 20 7, 10 10 5))")
    assert_is(written("a.wkt --local")[0], Polygon([(10, 10), (20, 10), (20, 20)]))


def test_several_polygons_with_holes_and_islands(written):
    island = Polygon([(21, 16), (21, 17), (22, 17)])
    far = box(70, 40, 80, 50).difference(box(72, 42, 74, 44)).difference(box(75, 45, 77, 47))
    whole = MultiPolygon([ROAD, island, far])
    for make in (lambda: geojson("a.geojson", moved(whole), crs=CRS_M),
                 lambda: geojson("a.geojson", *map(moved, (ROAD, island, far)), crs=CRS_M)):
        make()
        found, out = written("a.geojson")
        assert_is(found, whole)
        assert out.startswith("out.csv: 3 polygons, 6 rings (3 holes)")


def test_rings_of_text_count_by_the_even_odd_rule(written):
    """In any order: a field, a hole in it, an island in that with a hole of its own, a hole that touches the edge."""
    boxes = [box(10, 10, 50, 50), box(20, 20, 40, 40), box(25, 25, 35, 35), box(28, 28, 32, 32), box(10, 12, 15, 18)]
    island = boxes[2].difference(boxes[3])
    whole = boxes[0].difference(boxes[1]).difference(boxes[4]).union(island)
    for order in ((0, 1, 2, 3, 4), (3, 1, 4, 0, 2), (4, 3, 2, 1, 0)):
        Path("a.csv").write_text("\n\n".join("\n".join(f"{x},{y}" for x, y in boxes[k].exterior.coords) for k in order))
        assert_is(written("a.csv --local")[0], whole)


def test_what_overlaps_or_touches_becomes_one(written):
    """By the even-odd rule of the deck the overlap would be a hole, and a shared edge would part nothing."""
    geojson("a.geojson", *map(moved, (box(10, 10, 30, 20), box(20, 10, 40, 30), box(40, 10, 50, 30))), crs=CRS_M)
    found, _ = written("a.geojson")
    assert len(found) == 1 and inside(found, np.array([25.0]), np.array([15.0])).all()
    area = polygons.read_local("out.csv", rasters.read_place("t.asc")).area
    assert area == pytest.approx(20 * 10 + 20 * 20 - 10 * 10 + 10 * 20)


def test_a_written_file_is_an_input_again(written, slope):
    Path("a.wkt").write_text(moved(ROAD).wkt)
    written("a.wkt")
    first = Path("out.csv").read_bytes()
    Path("out.csv").rename("b.csv")
    written("b.csv")
    assert Path("out.csv").read_bytes() == first
    terrain("other.asc", offset=(EAST, NORTH + 10))
    status, _, err = slope("b.csv -o c.csv", terrain="other.asc")
    assert status == 2 and err == (
        "slope polygon: b.csv: must be for this terrain (local metres: east = x + -12000.0, north = y + 34010.0, CRS "
        "EPSG:6677), got local metres: east = x + -12000.0, north = y + 34000.0, CRS EPSG:6677\n")
    # a run that does not know where it is
    nowhere = rasters.Raster(np.full((16, 20), 5.0), Affine(5, 0, 0, 0, -5, 80), None, (0.0, 0.0))
    here_ = polygons.read_local("b.csv", rasters.read_place("t.asc"))
    assert polygons.read_local("b.csv", nowhere).equals_exact(here_, 0)


def test_a_zero_has_no_sign(here):
    polygons.write_polygon("a.csv", Polygon([(-1e-9, 1), (5, 1), (5, 4)]), rasters.read_place("t.asc"))
    assert Path("a.csv").read_text().endswith("\n0.0,1.0\n5.0,1.0\n5.0,4.0\n")


def test_raster_and_place_are_the_same(here):
    Path("a.wkt").write_text(moved(ROAD).wkt)
    found = [polygons.read_local("a.wkt", read("t.asc")) for read in (rasters.read_asc_local, rasters.read_place)]
    assert found[0].equals_exact(found[1], 0)


def test_a_terrain_without_crs(written, slope):
    """Text has no CRS to disagree with; for other files it is an error."""
    terrain(crs=None)
    Path("a.csv").write_text(TEXT_CSV)
    assert_is(written("a.csv")[0], ROAD)
    geojson("a.geojson", moved(ROAD), crs=CRS_M)
    status, _, err = slope("a.geojson -o b.csv")
    assert status == 2 and err.startswith("slope polygon: --terrain: must have a CRS") and err.count("\n") == 1
    geojson("a.geojson", ROAD)
    assert_is(written("a.geojson --local")[0], ROAD)


def test_ten_thousand_vertices(written):
    angle = np.linspace(0, 2 * np.pi, 10000, endpoint=False)
    radius = 30 + 5 * np.random.default_rng(2).random(len(angle))
    star = Polygon(np.transpose([50 + radius * np.cos(angle), 40 + radius * np.sin(angle)]))
    geojson("a.geojson", moved(star, "EPSG:6668"), crs="EPSG:6668")
    start = time.monotonic()
    found, out = written("a.geojson")
    print(f"10000 vertices in {time.monotonic() - start:.2f} s")
    assert len(found) == 1 and len(found[0]) == 10000 and ", 10000 vertices," in out
    assert np.abs(found[0] - polygons.rings_of(star)[0]).max() < 1e-4


# --- the page ---

def zipped(path, *several, change=lambda name: name):
    """A zip of all files of some shapefiles, as Finder packs them."""
    with zipfile.ZipFile(path, "w") as out:
        for one in several:
            for part in sorted(Path().glob(f"{one}.*")):
                out.write(part, change(part.name))
                out.writestr(f"__MACOSX/._{part.name}", b"\0\5\x16\7")


def test_a_zipped_shapefile(written, slope, here):
    shapefile("a.shp", moved(ROAD), crs=CRS_M)
    shapefile("b.shp", box(70, 40, 80, 50), crs="EPSG:4326")
    road, _ = written("a.shp")
    for name, change in (("flat.zip", str), ("below.ZIP", lambda name: f"sub/{name.upper()}"),
                         ("odd {}.zip", lambda name: f"\u9053 {{/{name}")):
        zipped(name, "a", change=change)
        found, _ = written(f"'{name}' --overwrite")
        assert all(np.array_equal(one, other) for one, other in zip(road, found)) and len(found) == 2, name
    zipped("two.zip", "a", "b")
    assert np.array_equal(written("two.zip --layer a --overwrite")[0][0], road[0])
    assert "two.zip: must hold one layer, or one must be named (--layer, FILE|layername=NAME): a, b, got 2" in (
        slope("two.zip -o out.csv --overwrite")[2])
    for suffix, rule in ((".shx", "must have all files of the shapefile, a.shx is missing"),
                         (".prj", "must have a CRS, so that polygon and terrain can be brought together")):
        Path(f"a{suffix}").rename("kept")
        zipped("part.zip", "a")
        Path("kept").rename(f"a{suffix}")
        assert f"part.zip: {rule}" in slope("part.zip -o new.csv")[2]
    Path("cut.zip").write_bytes(Path("two.zip").read_bytes()[:900])
    with zipfile.ZipFile("none.zip", "w") as out:
        out.writestr("a.txt", "1")
    for name in ("cut.zip", "none.zip"):
        status, _, err = slope(f"{name} -o new.csv")
        assert status == 2 and f"{name}: must be polygons that GDAL can read" in err and "vsizip" not in err


@pytest.mark.parametrize("crs", [
    {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::99999"}},
    {"type": "EPSG", "properties": {"code": 99999}},
    {"type": "name", "properties": {"name": "JGD2011 / zone IX"}}, {"type": "link", "properties": {"href": "http://a"}},
    "EPSG:6677", {}])
def test_a_geojson_that_names_an_unknown_crs(slope, written, crs):
    """Metres in the file, or degrees: it was taken as longitude and latitude without a word."""
    geojson("road.geojson", moved(ROAD), crs=CRS_M)
    right, _ = written("road.geojson")
    about = json.loads(Path("road.geojson").read_text())
    Path("road.geojson").write_text(json.dumps({**about, "crs": crs}))
    status, _, err = slope("road.geojson -o new.csv")
    assert status == 2 and err.startswith("slope polygon: road.geojson: must name a CRS that PROJ knows, such as "
                                          "EPSG:6677; --assign-crs EPSG:n overrides")
    found, _ = written("road.geojson --assign-crs EPSG:6677 --overwrite")
    assert np.array_equal(found[0], right[0])
    with zipfile.ZipFile("road.zip", "w") as out:
        out.write("road.geojson")
    assert "road.zip: must name a CRS that PROJ knows" in slope("road.zip -o new.csv")[2]


@pytest.mark.parametrize("name", ["urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:EPSG::4326", "EPSG:4326", "WGS 84",
                                  None])
def test_a_geojson_that_names_longitude_and_latitude(written, name):
    geojson("road.geojson", moved(ROAD, "EPSG:4326"))
    about = json.loads(Path("road.geojson").read_text())
    about["features"][0]["properties"]["crs"] = "of the survey"
    crs = name and {"type": "name", "properties": {"name": name}}
    Path("road.geojson").write_text(json.dumps({**about, "crs": crs}))
    assert_is(written("road.geojson")[0], ROAD)


@pytest.mark.parametrize("crs", ["EPSG:3832", "EPSG:2193", "EPSG:3460", "EPSG:32701"])
def test_a_polygon_that_is_cut_at_180_degrees_is_one(slope, crs):
    """As RFC 7946 demands; a road that is no rectangle, and a line."""
    far = Polygon([(10, 10), (90, 14), (91, 40), (12, 38)])
    (x,), (y,) = rasterio.warp.transform("EPSG:4326", crs, [180.0], [-44.0 if crs == "EPSG:2193" else -17.0])
    offset = (round(x) - 50.0, round(y) - 30.0)
    terrain("far.asc", crs, offset)
    lon, lat = map(np.array, rasterio.warp.transform(crs, "EPSG:4326", *(np.array(far.exterior.coords) + offset).T))
    whole = Polygon(np.column_stack([lon % 360, lat]))
    west, east_ = (whole.intersection(box(*limits)) for limits in ((0, -90, 180, 90), (180, -90, 360, 90)))
    halves = MultiPolygon([west, translate(east_, -360)])
    Path("cut.geojson").write_text(json.dumps(mapping(halves)))
    status, out, err = slope("cut.geojson -o cut.csv", "far.asc")
    assert (status, err) == (0, "") and "1 polygon, 1 ring (0 holes)" in out
    assert Polygon(rings("cut.csv")[0]).symmetric_difference(far).area < 0.02       # edges are straight in both systems
    line = MultiLineString([[(179.9999, lat[0]), (180, lat[0])], [(-180, lat[0]), (-179.9999, lat[0])]])
    Path("line.geojson").write_text(json.dumps(mapping(line)))
    found = lines.read_local("line.geojson", rasters.read_place("far.asc"), False)
    assert len(found.geoms) == 1 and found.length > 10


@pytest.mark.parametrize("command", examples("polygon"))
def test_every_example_of_the_page_and_the_help_runs(here, capsys, command):
    terrain("terrain.asc")
    geojson("road.geojson", moved(ROAD, WGS))
    shapefile("release.shp", moved(ROAD, "EPSG:6676"), crs="EPSG:6676")
    Path("road.wkt").write_text(moved(ROAD, "EPSG:6668").wkt)
    Path("sketch.csv").write_text(SQUARE)
    if "--help" in command:
        with pytest.raises(SystemExit):
            cli.main(["polygon", "--help"])
        assert "tools/slope polygon road.geojson" in capsys.readouterr().out
    else:
        assert cli.main(["polygon", *shlex.split(command)]) == 0
        out, err = capsys.readouterr()
        assert err == "" and re.search(r"\nregion \w+ polygon \w+.csv\n$", out)


# --- heads of text ---

def points_of(names, values, mark=","):
    return "\n".join([mark.join(names), *(mark.join(map(repr, map(float, row))) for row in values)]) + "\n"


@pytest.mark.parametrize("names, order, options", [
    ("x,y", (0, 1), ""), ('"X","Y"', (0, 1), ""), ("y,x", (1, 0), ""), ("north,east", (1, 0), ""),
    ("N (m),E (m)", (1, 0), ""),
    ("Easting,Northing", (0, 1), ""), ("POINT_X,POINT_Y", (0, 1), ""), ("y_m,x_m", (1, 0), ""),
    ("x,y,z", (0, 1, 0), ""), ("Hochwert,Rechtswert", (1, 0), ""), ("N,E,H\u00f6he", (1, 0, 1), ""),
    ("z,y,x", (0, 1, 0), ""), ("lat,lon", (1, 0), "--assign-crs EPSG:4326"),
    ("lon,lat", (0, 1), "--assign-crs EPSG:4326"),
    ("Longitude (deg),Latitude (deg),alt", (0, 1, 0), "--assign-crs EPSG:6668")])
def test_the_head_of_a_text_says_which_column_is_which(written, names, order, options):
    road = Polygon(ROAD.exterior)
    ring = np.array(moved(road, "EPSG:4326" if options else CRS_M).exterior.coords)[:-1]
    if names == "z,y,x":
        ring = np.column_stack([0 * ring[:, 0], ring[:, ::-1]])
        order = (0, 1, 2)
    Path("a.csv").write_text(points_of(names.split(","), ring[:, order]))
    assert_is(written(f"a.csv {options}")[0], road)
    line, unit = lines.text_geometry("a.csv", Path("a.csv").read_text())
    x, y = (2, 1) if names == "z,y,x" else (0, 1)
    assert np.array_equal(line.geoms[0].coords, ring[:, [x, y]]) and unit in (None, "m", "degrees")


@pytest.mark.parametrize("head, options, message", [
    ("E (ft),N (ft)", "", "a.csv: line 1: columns must be x,y or east,north (m), or lon,lat (degrees), in either"),
    ("# x (ft), y (ft)", "", "a.csv: line 1: columns must be x,y"),
    ("x_km,y_km", "", "a.csv: line 1: columns must be x,y"),
    ("# y,x", "", "a.csv: line 1: a comment that names columns must name x before y, got y,x"),
    ("# lat lon", "", "a.csv: line 1: a comment that names columns must name x before y, got lat lon"),
    ("id,x", "", "a.csv: line 1: columns must be x,y"), ("x,x", "", "a.csv: line 1: columns must be x,y"),
    ("north,south", "", "a.csv: line 1: columns must be x,y"),
    ("x,y,z", "", "a.csv: line 2: must be three numbers, x,y and z"),
    ("X\u5ea7\u6a19,Y\u5ea7\u6a19", "", "a.csv: line 1: columns must be x,y"),
    ("lon,lat", "", "a.csv: columns in degrees must have a CRS in degrees; --assign-crs EPSG:n overrides"),
    ("lon,lat", "--assign-crs EPSG:6677", "a.csv: columns in degrees must have a CRS in degrees"),
    ("lat,lon", "--local", "a.csv: must have columns in m, local, got degrees"),
    ("x (m),y (m)", "--assign-crs EPSG:4326", "a.csv: columns in m must have a CRS in m, got EPSG:4326")])
def test_a_head_of_text_that_is_another(slope, head, options, message):
    Path("a.csv").write_text(f"{head}\n{SQUARE}", encoding="utf-8")
    status, _, err = slope(f"a.csv {options} -o out.csv")
    assert status == 2 and is_one(err, f"slope polygon: {message}"), err
    if not options and "degrees must" not in message:
        with pytest.raises(polygons.SlopeError, match="a.csv: must be a line: .* CSV with x,y in its lines .line "):
            lines.text_geometry("a.csv", Path("a.csv").read_text(encoding="utf-8"))


def test_a_text_of_two_lines_is_two():
    found, _ = lines.text_geometry("a.csv", "\n# one\n0,0\n9,0\n# and\n9,5\n\n20,0\n20,9\n\n")
    assert [len(line.coords) for line in found.geoms] == [3, 2]
    for text in ("1,10,20\n2,20,30\n", "1_0,2\n3,4\n", "1,2\n", "1;2\n3;4\n"):
        with pytest.raises(polygons.SlopeError, match="must be a line"):
            lines.text_geometry("a.csv", text)


@pytest.mark.parametrize("between", ["\n", " ", ";\n", "\r\n# the next one\r\n", "\n\nLINESTRING EMPTY\n"])
def test_all_of_several_well_known_texts_are_read(written, between):
    """Not only the first one, which is all that GEOS reads."""
    several = ["LINESTRING (0 0, 9 0)", "LINESTRING\n(9 0,\n9 5)", "MULTILINESTRING ((1 1, 2 2), (3 3, 4 4))"]
    found, _ = lines.text_geometry("a.wkt", between.join(several))
    assert [line.coords[0] for line in lines.parts_of(found)] == [(0, 0), (9, 0), (1, 1), (3, 3)]
    squares = [box(10, 10, 20, 20), box(30, 10, 40, 20)]
    Path("a.wkt").write_text(between.replace("LINESTRING", "POLYGON").join(one.wkt for one in squares))
    assert_is(written("a.wkt --local")[0], unary_union(squares))
    with pytest.raises(polygons.SlopeError, match="must be a line"):
        lines.text_geometry("a.wkt", several[0] + " and more")


# --- bad input: what test_wrong_inputs.py does not have ---

def of(text):
    return lambda path: Path(path).write_text(text)


BOW = Polygon([(10, 10), (20, 20), (20, 10), (10, 20)])
SQUARE = "10,10\n20,10\n20,20\n10,20\n"


@pytest.mark.parametrize("name, make, options, message", [
    ("a.csv", lambda path: None, "", "a.csv: must be an existing file"),
    ("a.csv", of("1,2,3\n"), "", "a.csv: line 1: must be two numbers, x,y, got 1,2,3"),
    ("a.csv", of("1,nan\n"), "", "a.csv: line 1: must be two finite numbers within +-1e+12, x,y, got 1,nan"),
    ("a.csv", of(SQUARE + "\n1,2\n3,4\n1,2\n"), "--local", "a.csv: line 6: a ring must have at least 3 points, got 2"),
    ("a.csv", of("1,1\n2,2\n4,4\n"), "--local", "a.csv: line 1: must have an area > 0"),
    ("a.csv", of(SQUARE + "\n30,30\n40,40\n40,30\n30,40\n"), "--local",
     "a.csv: line 6: must be polygons that do not cross or touch themselves, got Self-intersection at 35 35"),
    ("a.csv", of(SQUARE + "\n15,15\n25,15\n25,25\n15,25\n"), "--local",
     "a.csv: line 6: a ring must not cross another one, line 1, got an overlap at 17.5 17.5"),
    ("a.csv", of(SQUARE + "\n" + SQUARE), "--local", "a.csv: must have an area > 0"),
    ("a.csv", of(SQUARE), "",
     "a.csv: must overlap the terrain (with --local it would), local x y 0 0 100 80, got 12010 "
     "-33990 12020 -33980"),
    ("a.csv", of(SQUARE.replace("0,", "000,")), "", "a.csv: must overlap the terrain, local x y 0 0 100 80, got "),
    # degrees, by chance within the terrain's metres
    ("a.geojson", lambda path: geojson(path, box(39.0, 36.0, 39.1, 36.1)), "",
     "a.geojson: must overlap the terrain, local"),
    ("a.wkt", of("POLYGON ((1 1, 2 2"), "", "a.wkt: line 1: must be WKT such as POLYGON"),
    ("a.wkt", of("# road\nPOLYGON ((1 1, 2 1, 2 2, 1 1))\nPOLYGON ((1 1, x))"), "", "a.wkt: line 3: must be WKT"),
    ("a.wkt", of("LINESTRING (1 1, 2 2)"), "", "a.wkt: line 1: must be a polygon, got LineString"),
    ("a.wkt", of("POLYGON EMPTY"), "", "a.wkt: must hold a polygon, it is empty"),
    ("a.wkt", of(BOW.wkt), "--local",
     "a.wkt: line 1: must be polygons that do not cross or touch themselves, got Self-intersection at 15 15"),
    ("a.geojson", lambda path: geojson(path), "", "a.geojson: must hold a polygon, it is empty"),
    ("a.geojson", lambda path: geojson(path, moved(ROAD), moved(BOW), crs=CRS_M), "", "a.geojson: feature 1: must be "
     "polygons that do not cross or touch themselves, got Self-intersection at -11985 34015"),
    ("a.shp", of("no shapes"), "", "a.shp: must be polygons that GDAL can read"),
])
def test_bad_input_is_one_line_and_nothing_is_written(slope, here, name, make, options, message):
    (here / "out.csv").write_text("from before\n")
    make(name)
    status, out, err = slope(f"{name} {options} --overwrite -o out.csv")
    assert status == 2 and out == "", (out, err)
    assert is_one(err, f"slope polygon: {message}"), err
    assert (here / "out.csv").read_text() == "from before\n"
    assert not [name for name in os.listdir() if ".new" in name]


@pytest.mark.parametrize("arguments, terrain, message", [
    ("a.wkt -o out.txt", "t.asc", "-o: must be a file that ends in .csv, got out.txt"),
    ("a.wkt -o none/out.csv", "t.asc", "-o: must be in an existing folder, got none/out.csv"),
    ("b.csv -o b.csv", "t.asc", "-o: must not be the input, got b.csv"),
    ("a.wkt -o out.csv", "none.asc", "none.asc: must be an existing file"),
    ("a.wkt -o out.csv", "a.wkt", "a.wkt: must be a raster that GDAL can read"),
    ("a.wkt -o out.csv --local --assign-crs EPSG:6677", "t.asc", "argument --assign-crs: not allowed with argument "
     "--local"),
])
def test_bad_arguments(slope, here, arguments, terrain, message):
    (here / "a.wkt").write_text(moved(ROAD).wkt)
    (here / "b.csv").write_text(SQUARE)
    status, _, err = slope(arguments, terrain)
    assert status == 2 and is_one(err, f"slope polygon: {message}"), err
