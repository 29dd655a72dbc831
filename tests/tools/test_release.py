"""slope release: bodies against closed forms; what is printed, written and released by a run is one volume."""
import math
import os
import re
import shlex
import subprocess
from pathlib import Path

import fiona
import numpy as np
import pytest
import rasterio
import yaml
from affine import Affine
from matplotlib.figure import Figure
from rasterio.crs import CRS
from shapely.affinity import rotate
from shapely.geometry import Point, Polygon, box, mapping

from run_helpers import CRS_M, EAST, NORTH, TOOLS, TOP, warned, write_asc, write_geojson, write_tif, examples

from slope_tools.drawing import maps
from slope_tools.releases import release_area, release_bodies, release_chart, release_parts, release_slbl, release_solve
from slope_tools.survey import polygons, rasters

COMMAND = "release"
DATA = next((folder for folder in (top / "shared" / "data" for top in TOP.parents) if folder.is_dir()), TOP / "none")
FRANK, S1000 = DATA / "frank", DATA / "s1000"
NAMES = ["r.slip.asc", "r.slip.yaml", "r.depth.asc", "r.depth.yaml", "r.png", "r.yaml", "r.deck.txt"]


@pytest.fixture
def no_picture(monkeypatch):
    """An empty NAME.png: it takes nine tenths of the time, and one test looks at it."""
    monkeypatch.setattr(release_chart, "draw_release", lambda path, *rest: Path(path).write_bytes(b""))


@pytest.fixture
def body(slope, no_picture):
    """Run it to `r`, which must succeed; gives the body's numbers in r.yaml, and all of r.yaml."""
    def run(arguments):
        status, out, err = slope(f"{arguments} --overwrite -o r")
        assert status == 0, err
        about = yaml.safe_load(Path("r.yaml").read_text())
        printed = float(re.search(r"^volume (\S+) m3", out, re.MULTILINE)[1].replace(",", ""))
        assert printed == pytest.approx(about["body"]["volume"], rel=5e-5)
        return about["body"], about
    return run


@pytest.fixture
def refused(slope):
    """Run it; it must end with one line that has all parts, and leave no file."""
    def run(arguments, *parts):
        before = sorted(Path().rglob("*"))
        status, out, err = slope(f"{arguments} -o r" if " -o " not in arguments else arguments)
        assert status == 2 and out == "" and err.count("\n") == 1 and err.startswith("slope release: "), err
        for part in parts:
            assert part in err, err
        assert sorted(Path().rglob("*")) == before
    return run


def terrain(height, path="t.asc", size=(100, 120), cell=2.0, crs=CRS_M, offset=(EAST, NORTH)):
    """A terrain with the height(x, y), rows and columns, at local 0 0; gives x, y, z of its nodes, as written."""
    rows, columns = size
    x, y = np.meshgrid(cell * (np.arange(columns) + 0.5), cell * (rows - 0.5 - np.arange(rows)))
    z = np.round(height(x, y) + 0.0 * x, 3)
    raster = rasters.Raster(z, Affine(cell, 0, 0, 0, -cell, rows * cell), crs and CRS.from_string(crs), offset)
    rasters.write_asc_local(path, raster, {})
    return x, y, z


def polygon(geometry, path="p.csv"):
    """A polygon in the deck's format, local metres of the terrain t.asc."""
    polygons.write_polygon(path, geometry, rasters.read_place("t.asc"))
    return path


def ramp(degrees, direction=270.0, top=500.0):
    """Heights of a plane that falls by an angle towards a compass bearing."""
    fall, bearing = math.tan(math.radians(degrees)), math.radians(direction)
    return lambda x, y: top - fall * (x * math.sin(bearing) + y * math.cos(bearing))


# --- closed forms ---


def test_a_body_beside_nodata_has_numbers(body):
    """NODATA in a corner of the body's rectangle, far from its polygon: the same body as without."""
    whole = terrain(ramp(30))
    polygon(Polygon([(120, 60), (160, 100), (120, 140), (80, 100)]))
    wanted, _ = body("t.asc --polygon p.csv --depth 6")
    corner = (np.abs(whole[0] - 84) < 4) & (np.abs(whole[1] - 64) < 4)
    slope_of = ramp(30)
    terrain(lambda x, y: np.where(corner, np.nan, slope_of(x, y)))
    found, _ = body("t.asc --polygon p.csv --depth 6")
    assert found == pytest.approx(wanted, rel=1e-9) and found["volume"] > 1000
    assert "nan" not in Path("r.deck.txt").read_text()


@pytest.mark.parametrize("degrees, direction", [(30, 270), (40, 180), (25, 45), (33, 110)])
@pytest.mark.parametrize("stretch", [1, 0.6])
def test_a_sphere_on_a_plane_slope_is_a_cap(body, degrees, direction, stretch):
    terrain(ramp(degrees, direction), size=(240, 240), cell=1.0)
    wide = 130 if stretch == 1 else 60     # of the polygon; of the sphere's cap 100 m
    plan = 100 * math.cos(math.radians(degrees))
    polygon(rotate(box(120 - wide / 2, 120 - plan / 2, 120 + wide / 2, 120 + plan / 2), -direction, (120, 120)))
    shape = "sphere" if stretch == 1 else "ellipsoid"
    _, about = body(f"t.asc --polygon p.csv --shape {shape} --volume 30000")
    sagitta = about["sagitta_m"]
    radius = (100 ** 2 / 4 + sagitta ** 2) / (2 * sagitta)
    assert about["chord_m"] == pytest.approx(100, rel=1e-4)
    assert math.pi * sagitta ** 2 * (3 * radius - sagitta) / 3 * stretch == pytest.approx(30000, rel=3e-3)
    assert about["body"]["mean_slope"] == pytest.approx(degrees, abs=0.05)
    assert about["body"]["bearing"] == pytest.approx(direction, abs=0.1)
    distance = sphere_distance(about, degrees, direction, radius)
    if stretch == 1:
        assert np.abs(distance).max() < 2e-3
    else:
        assert np.abs(distance).max() > 1


def sphere_distance(about, degrees, direction, radius):
    """Of the nodes of the written slip surface in the body, from the sphere through toe, shoulder and sagitta."""
    slip, ground = rasters.read_asc_local("r.slip.asc"), rasters.read_asc_local("t.asc")
    row, column = np.nonzero(slip.z < ground.z)
    x, y = slip.transform @ (column + 0.5, row + 0.5)
    toe, shoulder = np.array(about["toe"]), np.array(about["shoulder"])
    tilt, bearing = math.radians(degrees), math.radians(direction)
    normal = np.array([math.sin(tilt) * math.sin(bearing), math.sin(tilt) * math.cos(bearing), math.cos(tilt)])
    centre = (toe + shoulder) / 2 + (radius - about["sagitta_m"]) * normal
    return np.linalg.norm(np.column_stack([x, y, slip.z[row, column]]) - centre, axis=1) - radius


@pytest.mark.parametrize("direction", [270, 180])
def test_a_plane_on_a_plane_slope_is_a_wedge(body, direction):
    terrain(ramp(35, direction), cell=2.0)
    polygon(box(40, 50, 120, 130))      # 40 x 40 nodes
    found, about = body("t.asc --polygon p.csv --dip 20")
    steps = (math.tan(math.radians(35)) - math.tan(math.radians(20))) * 2.0 * np.arange(40)
    assert found["volume"] == pytest.approx(40 * steps.sum() * 4, rel=1e-4)
    wedge = 80 * (math.tan(math.radians(35)) - math.tan(math.radians(20))) * 80 ** 2 / 2
    assert found["volume"] == pytest.approx(wedge, rel=0.04)     # the nodes end half a cell inside of the polygon
    assert found["largest_depth"] == pytest.approx(steps[-1], abs=1e-3)
    assert found["slip_slope"] < found["mean_slope"] == pytest.approx(35, abs=0.05)
    assert about["direction_degrees"] == pytest.approx(direction, abs=0.01)


def test_a_plane_in_its_own_direction(body):
    x, y, z = terrain(ramp(35, 270))
    polygon(box(40, 50, 120, 130))
    found, _ = body("t.asc --polygon p.csv --dip 30 --direction 300 --depth 9")
    slip = rasters.read_asc_local("r.slip.asc").z
    inside = slip < z
    fall = math.tan(math.radians(30))
    level = slip + fall * (x * math.sin(math.radians(300)) + y * math.cos(math.radians(300)))
    assert np.ptp(level[inside]) < 1.1e-4 and found["largest_depth"] == pytest.approx(9, abs=2e-4)
    assert inside.sum() == found["cells"]


@pytest.mark.parametrize("columns, rows", [(59, 29), (39, 39), (19, 79)])
def test_the_base_level_of_a_ramp_is_poissons(body, columns, rows):
    """Depth u below a ramp: -(u_xx + u_yy) = curvature, 0 on the rim of a rectangle: the volume is torsion's series."""
    terrain(ramp(30, 90), cell=2.0)
    polygon(box(20, 20, 20 + 2 * columns, 20 + 2 * rows))
    found, about = body("t.asc --polygon p.csv --curvature 0.01")
    a, b = sorted((2.0 * (columns + 1), 2.0 * (rows + 1)))
    odd = np.arange(1, 60, 2)
    series = (np.tanh(odd * math.pi * b / (2 * a)) / odd ** 5).sum()
    wanted = 0.01 * a ** 3 * b / 12 * (1 - 192 * a / (math.pi ** 5 * b) * series)
    assert found["volume"] == pytest.approx(wanted, rel=4e-3)
    assert about["tolerance_m"] == pytest.approx(0.01)
    if b > 3.5 * a:
        assert found["largest_depth"] == pytest.approx(0.01 * a ** 2 / 8, rel=0.02)     # K L^2 / 8


@pytest.mark.parametrize("curvature", [0.01, 0.0, -0.02])
def test_the_base_level_is_what_the_method_comes_to(curvature):
    rng = np.random.default_rng(3)
    x, y = np.meshgrid(np.arange(24.0), np.arange(20.0))
    z = 0.8 * x + 2 * np.sin(x / 2) * np.cos(y / 3) + rng.normal(0, 0.3, x.shape)
    inside = np.zeros(z.shape, bool)
    inside[3:17, 2:20] = True
    inside[8:10, 9:12] = False      # a hole
    level, step = release_slbl.base_level(z, inside, 2.0, curvature), z.copy()
    for _ in range(5000):           # Jaboyedoff's iteration
        mean = (np.roll(step, 1, 0) + np.roll(step, -1, 0) + np.roll(step, 1, 1) + np.roll(step, -1, 1)) / 4
        step = np.where(inside, np.minimum(step, mean - curvature * 2.0 ** 2 / 4), z)
    assert level == pytest.approx(step, abs=1e-9)
    assert (level == z)[~inside].all() and (level <= z).all()
    assert 5 < (level < z - 1e-9).sum() < inside.sum()      # some nodes stay at the ground


def test_the_sphere_of_the_embankment():
    """inputs/20: toe x 84, shoulder x 156, depth 18; its body, region slip, has 48,858 m3."""
    raster = rasters.read_asc_local(TOP / "inputs" / "20_embankment" / "terrain.asc")
    whole = box(60, 10, 200, 150)
    found = release_area.area_of(raster, release_area.nodes_inside(raster, whole), "p", "t")
    line = release_area.FallLine(np.array([84.0, 80, 0]), np.array([156.0, 80, 36]))
    depth = release_solve.depths(found, release_bodies.cap(found, line, 18.0))
    assert release_solve.compute_volume(depth, found.cell) == pytest.approx(48858, rel=0.005)
    face = box(84, 30, 156, 130)
    inside = release_area.nodes_inside(raster, face)
    line = release_area.fall_line(release_area.area_of(raster, inside, "p", "t"), face, "p")
    assert line.toe == pytest.approx([84, 80, 0], abs=0.3) and line.shoulder == pytest.approx([156, 80, 36], abs=0.3)


# --- the sphere that dips least ---

@pytest.fixture
def plane(here):
    terrain(ramp(30), cell=1.0, size=(160, 160))
    polygon(box(30, 20, 110, 140))


def test_the_sphere_that_dips_least_is_level_at_the_toe(plane, body):
    """On a plane face: the angle at the toe is 0 where the sagitta is half the chord times tan(slope/2)."""
    found, about = body("t.asc --polygon p.csv --dip least")
    chord = 80 / math.cos(math.radians(30))
    assert about["shape"] == "sphere" and about["dip"] == "least"
    assert about["sagitta_m"] == pytest.approx(chord / 2 * math.tan(math.radians(15)), rel=1e-3)
    assert about["dip_m"] == about["below_foundation_m3"] == 0
    deeper, about = body(f"t.asc --polygon p.csv --depth {1.1 * found['largest_depth']}")
    run, fall = (about["shoulder"][0] - about["toe"][0]), about["shoulder"][2] - about["toe"][2]
    s = about["sagitta_m"]
    radius = (chord ** 2 / 4 + s ** 2) / (2 * s)
    assert about["toe"][2] + fall / 2 + (radius - s) * run / chord - radius < about["toe"][2] - 0.1     # it dips


@pytest.mark.parametrize("level", [0.0, -2.0, -6.0])
def test_a_foundation_is_a_level_or_a_raster_of_it(plane, body, level):
    toe = body("t.asc --polygon p.csv --dip least")[1]["toe"][2] + level
    found, about = body(f"t.asc --polygon p.csv --dip least --foundation {toe}")
    terrain(lambda x, y: toe, "old.asc", cell=1.0, size=(160, 160))
    same, other = body("t.asc --polygon p.csv --dip least --foundation old.asc")
    assert same == pytest.approx(found, rel=1e-3, abs=1e-6)
    assert about["foundation"] != other["foundation"] == "old.asc"
    s, chord = about["sagitta_m"], about["chord_m"]
    radius = (chord ** 2 / 4 + s ** 2) / (2 * s)
    lowest = (about["toe"][2] + about["shoulder"][2]) / 2 + (radius - s) * math.cos(math.radians(30)) - radius
    assert lowest == pytest.approx(toe, abs=1e-3) and about["dip_m"] < 1e-3


def test_a_foundation_above_the_toe_is_dipped_into_as_little_as_at_the_toe(plane, body):
    """All spheres through the toe lie below it there: none that goes no lower is worse."""
    found, about = body("t.asc --polygon p.csv --dip least")
    same, other = body(f"t.asc --polygon p.csv --dip least --foundation {about['toe'][2] + 2}")
    assert same == pytest.approx(found, rel=1e-6) and 1 < other["dip_m"] < 2 and other["below_foundation_m3"] > 0
    terrain(ramp(30, 225), cell=1.0, size=(160, 160))       # along a diagonal
    polygon(rotate(box(50, 40, 110, 120), 45, (80, 80)))
    _, turned = body("t.asc --polygon p.csv --dip least")
    assert turned["sagitta_m"] == pytest.approx(turned["chord_m"] / 2 * math.tan(math.radians(15)), rel=2e-3)


def test_an_old_slope_below_the_face_holds_the_sphere_up(plane, body):
    """A fill of 3 m at most on a parallel slope: the sphere touches that, and goes no deeper in its section."""
    terrain(ramp(30, top=500 - 3 * math.sqrt(4 / 3)), "old.asc", cell=1.0, size=(160, 160))
    _, about = body("t.asc --polygon p.csv --dip least --foundation old.asc")
    assert about["sagitta_m"] == pytest.approx(3.0, abs=2e-3) and about["dip_m"] < 2e-3
    step = ramp(30, top=497)
    terrain(lambda x, y: step(x, y) + 2 * (abs(x - 70) < 1.5), "high.asc", cell=1.0, size=(160, 160))
    _, higher = body("t.asc --polygon p.csv --dip least --foundation high.asc")
    assert higher["sagitta_m"] < 1.0 and higher["dip_m"] < 2e-3


def test_the_body_of_the_papers_rule_is_that_of_the_deck(body):
    """inputs/20: a sphere of 90 m that is level at the toe, 24,628 m3."""
    case = TOP / "inputs" / "20_embankment"
    found, about = body(f"{case}/terrain.asc --polygon {case}/face.csv --local --shape sphere --dip least")
    assert found["volume"] == pytest.approx(24628, rel=0.01) and about["sagitta_m"] == pytest.approx(9.50, abs=0.08)
    assert about["dip_m"] == 0 and not warned(about)


def test_what_the_sphere_that_dips_least_does_not_go_with(plane, refused):
    least = "t.asc --polygon p.csv --dip least"
    for words, *parts in (("--depth 5", "--depth: must not be given with --dip least", "got 5"),
                          ("--volume 500", "--volume: must not", "got 500"),
                          ("--shape slbl", "--dip: must be degrees for --shape slbl", "got least"),
                          ("--direction 90", "--direction: must not", "got 90"),
                          ("--foundation 600", "--foundation: must be lower than the shoulder", "got 600"),
                          ("--foundation none.asc", "none.asc: must be")):
        refused(f"{least} {words}", *parts)
    refused("t.asc --polygon p.csv --depth 5 --foundation 3", "--foundation: must be given with --dip least only",
            "got 3")
    refused("t.asc --polygon p.csv --dip most", "--dip: must be a finite number, got 'most'")
    old = np.full((160, 160), 400.0)
    old[:, 60:80] = np.nan
    write_asc("old.asc", old, 1.0, EAST, NORTH)
    refused(f"{least} --foundation old.asc", "old.asc: must have heights from the toe to the shoulder", "none at")


# --- a target ---


def hill(x, y):
    """A bumpy slope that falls to the west, with a valley."""
    return 100 + 0.6 * x + 3 * np.sin(x / 17) * np.cos(y / 23) + 0.0008 * (y - 100) ** 2


@pytest.fixture
def bumpy(here):
    terrain(hill)
    polygon(Polygon([(60, 50), (180, 60), (170, 140), (70, 150)]))


@pytest.mark.parametrize("shape", ["--shape sphere", "--shape ellipsoid", "--dip 22", "--shape slbl"])
def test_a_volume_or_a_depth_is_met(bumpy, body, shape):
    found, about = body(f"t.asc --polygon p.csv {shape} --volume 60000")
    assert found["volume"] == pytest.approx(60000, rel=1e-5)
    assert found["mean_depth"] * found["area"] == pytest.approx(60000, rel=1e-5)
    assert about["given"]["volume_m3"] == 60000
    again, _ = body(f"t.asc --polygon p.csv {shape} --depth {found['largest_depth']}")
    assert again["volume"] == pytest.approx(60000, rel=1e-3)
    deep, _ = body(f"t.asc --polygon p.csv {shape} --volume 80000")
    assert deep["largest_depth"] > found["largest_depth"]


def test_a_sphere_bulges_where_the_ground_does(slope, body):
    terrain(lambda x, y: 200 - 0.004 * (x - 240) ** 2 - 0.003 * (y - 100) ** 2)
    polygon(box(40, 60, 200, 140))
    found, about = body("t.asc --polygon p.csv --volume 40000")
    assert found["volume"] == pytest.approx(40000, rel=1e-5) and about["sagitta_m"] < 0
    assert "above its chord" in slope("t.asc --polygon p.csv --volume 40000 -o r")[1]
    assert warned(about)["bulges"] == {"shape": "sphere"}
    done = subprocess.run([TOOLS / "slope", "release", *"t.asc --polygon p.csv --volume 40000 -o s".split()],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True,
                          env={**os.environ, "PYTHONUNBUFFERED": ""})
    assert done.stdout.index("volume ") < done.stdout.index("warning: ")     # in one file, in the order of a terminal


def test_a_depth_that_no_sphere_on_bulging_ground_has(refused):
    terrain(lambda x, y: ramp(30)(x, y) + 60 * np.exp(-((x - 120) ** 2 + (y - 100) ** 2) / 100))
    polygon(box(100, 80, 140, 120))
    refused("t.asc --polygon p.csv --depth 1", "--depth: must be at least ", "bulges above the line from toe to "
            "shoulder", "--shape slab", "got 1")


@pytest.mark.parametrize("shape", ["sphere", "ellipsoid"])
def test_a_wall_through_one_cell_does_not_jump_over_the_target(body, shape):
    """In a valley a sphere is cut at its equator, and takes up nodes of 20 m at once: 60 m3, over 1 %."""
    terrain(lambda x, y: 0.5 * np.abs(x - 120) + 0.35 * y, size=(118, 141), cell=1.7)
    polygon(rotate(Polygon([(90, 60), (150, 65), (155, 130), (85, 140)]), 20))
    for wanted in (5000, 5015, 5030):
        found, _ = body(f"t.asc --polygon p.csv --shape {shape} --volume {wanted}")
        assert found["volume"] == pytest.approx(wanted, rel=1e-4)
    found, _ = body(f"t.asc --polygon p.csv --shape {shape} --depth 28")
    assert found["largest_depth"] == pytest.approx(28, abs=2e-4)


def test_a_plane_that_does_not_come_out_downhill_is_warned_of(body):
    terrain(ramp(30))
    polygon(box(80, 60, 140, 120))
    for dip, direction, told in ((25, 270, False), (40, 270, True), (20, 90, True), (25, 330, True),
                                 (15, 330, False)):
        found, about = body(f"t.asc --polygon p.csv --dip {dip} --direction {direction} --depth 3")
        assert ("no way out" in warned(about)) == told, (dip, direction)


def test_a_body_in_parts_is_warned_of(body):
    terrain(lambda x, y: 0.5 * x + 12 * np.sin(y / 30), size=(150, 160))
    polygon(Point(150, 150).buffer(60))
    _, about = body("t.asc --polygon p.csv --volume 20000")
    parts = warned(about)["parts"]
    volumes = [float(text.replace(",", "")) for text in parts["volumes"].split(" and ")]
    assert parts["parts"] == len(volumes) == 2 and sum(volumes) == pytest.approx(20000, rel=0.02)
    _, about = body("t.asc --polygon p.csv --volume 90000")
    assert "parts" not in warned(about)


def test_a_base_level_below_a_part_of_the_polygon_is_warned_of(body):
    terrain(lambda x, y: 200 - 0.004 * (x - 240) ** 2 - 0.003 * (y - 100) ** 2)
    polygon(box(40, 60, 200, 140))
    found, about = body("t.asc --polygon p.csv --shape slbl --depth 1")
    assert about["curvature_per_m"] < 0
    (kind, numbers), = warned(about).items()
    assert kind == "little" and "bulges" in numbers["form"] and numbers["depth"] == pytest.approx(found["mean_depth"])
    assert numbers["percent"] == pytest.approx(100 * found["cells"] / (80 * 40))     # cells of 2 m
    _, about = body("t.asc --polygon p.csv --shape slbl --depth 20")
    assert about["curvature_per_m"] > 0 and "little" not in warned(about)


GULLY = (lambda x, y: 20 + 0.6 * x - 15 * np.maximum(0, 1 - ((y - 40) / 30) ** 2))
OPEN, DEEP = box(60, 120, 160, 190), box(80, 25, 140, 55)     # on the open slope, and in the gully


def areas(*features, path="p.geojson"):
    """Polygons (local metres) with attributes, as a GIS has them."""
    schema = {"geometry": "Polygon", "properties": {key: "str" if key.lower() == "name" else "float" for _, about in
                                                    features for key in about}}
    with fiona.open(path, "w", "GPKG" if path.endswith("gpkg") else "GeoJSON", schema, CRS_M) as out:
        for shape, about in features:
            out.write({"geometry": mapping(Polygon([(x + EAST, y + NORTH) for x, y in shape.exterior.coords])),
                       "properties": {**dict.fromkeys(schema["properties"]), **about}})


def test_each_polygon_has_a_base_level_of_its_own(body, refused):
    """One curvature for both left the gully without a body: its ground is more concave."""
    terrain(GULLY)
    areas((OPEN, {"NAME": "open"}), (DEEP, {"NAME": "deep"}))
    found, about = body("t.asc --polygon p.geojson --shape slbl --depth 6")
    both = {one["name"]: one for one in about["polygons"]}
    for name, shape in (("open", OPEN), ("deep", DEEP)):
        polygon(shape)
        alone, mine = body("t.asc --polygon p.csv --shape slbl --depth 6")
        assert both[name]["volume_m3"] == pytest.approx(alone["volume"], rel=1e-5)
        assert both[name]["curvature_per_m"] == mine["curvature_per_m"] and both[name]["area_m2"] == alone["area"]
        assert both[name]["largest_depth_m"] == pytest.approx(6)
    assert found["volume"] == pytest.approx(sum(one["volume_m3"] for one in both.values()), rel=1e-5)
    assert warned(about) == {}
    found, about = body("t.asc --polygon p.geojson --shape slbl --volume 30000")
    shares = [one["volume_m3"] / one["polygon_m2"] for one in about["polygons"]]
    assert shares[0] == pytest.approx(shares[1]) and found["volume"] == pytest.approx(30000, rel=1e-5)
    refused("t.asc --polygon p.geojson --shape slbl --depth 600", "--depth in deep: must be at most", "got 600")
    polygon(OPEN.union(DEEP))
    _, about = body("t.asc --polygon p.csv --shape slbl --curvature 0.008")      # of all: the gully gets nothing
    assert "no body" in warned(about)
    assert warned(about)["no body"]["polygon"].startswith(f"p.csv: the polygon at east {EAST + 110:.1f}")


@pytest.mark.parametrize("shape", ["slbl", "slab"])
def test_features_with_depths_of_their_own(body, refused, shape):
    """Six, as AvaFrame has them: text or number, in whatever case; the option is for those without."""
    terrain(GULLY)
    each = [box(20 + 36 * k, 100, 44 + 36 * k, 130) for k in range(5)]
    areas(*((one, {"Name": f"r{k}", "Thickness": 2.0 + k} if k < 4 else {"Name": "r4"}) for k, one in enumerate(each)),
          (box(100, 160, 100.5, 160.5), {"Name": "tiny", "Thickness": 1.0}), path="p.gpkg")
    _, about = body(f"t.asc --polygon p.gpkg --shape {shape} --depth 1.5")
    found = {one["name"]: one for one in about["polygons"]}
    assert [found[f"r{k}"]["largest_depth_m"] for k in range(5)] == pytest.approx([2, 3, 4, 5, 1.5])
    assert [found[f"r{k}"].get("depth_from") for k in range(5)] == ["Thickness".lower()] * 4 + [None]
    assert warned(about)["no body"]["polygon"] == "p.gpkg: tiny" and warned(about)["own depth"]["depth"] == 1.5
    if shape == "slab":
        assert found["r3"]["volume_m3"] == pytest.approx(5 * each[3].area)
    refused(f"t.asc --polygon p.gpkg --shape {shape}", "--depth: must be given", "thickness", "got none of r4")
    areas((OPEN, {"depth": 3.0}), (OPEN.intersection(box(100, 0, 200, 300)), {"depth": 5.0}))
    found, about = body(f"t.asc --polygon p.geojson --shape {shape}")       # of ground that both have: the deepest
    assert [one["largest_depth_m"] for one in about["polygons"]] == pytest.approx([3, 5])
    assert sum(one["polygon_m2"] for one in about["polygons"]) == pytest.approx(OPEN.area)
    areas((OPEN, {}))
    refused(f"t.asc --polygon p.geojson --shape {shape}", "got none of feature 1\n")
    areas((OPEN, {"depth": -1.0}))
    refused(f"t.asc --polygon p.geojson --shape {shape}", "p.geojson: feature 1: attribute depth must be", "> 0", "-1")


@pytest.mark.parametrize("face, count", [(80.0, 0), (100.0, 1)])
def test_a_bench_beside_an_open_face_is_no_pit(face, count):
    """10 m of level ground at 100 m, which ends at a vertical face, or goes on."""
    z = np.full((12, 12), 100.0)
    z[:, 8:] = face
    depth = np.zeros(z.shape)
    depth[3:9, 2:8] = 10.0
    assert len(release_parts.in_pits(depth, z, (depth > 0).astype(int), ["a"])) == count


@pytest.mark.parametrize("shape", ["slbl", "slab"])
def test_a_volume_is_shared_by_the_depths_of_the_features(body, refused, shape):
    """By area and depth: their mean depths stay in proportion. An attribute that does not count is named."""
    terrain(ramp(30))
    both = [(box(20, 40, 60, 80), {"name": "thin", "THICKNESS": 2.0}), (box(90, 40, 170, 120),
                                                                        {"name": "thick", "THICKNESS": 3.0})]
    areas(*both)
    found, about = body(f"t.asc --polygon p.geojson --shape {shape} --volume 12000")
    thin, thick = (one["volume_m3"] / one["polygon_m2"] for one in about["polygons"])
    assert thick / thin == pytest.approx(3 / 2, rel=1e-4) and found["volume"] == pytest.approx(12000, rel=1e-4)
    assert warned(about)["shared"]["factor"] == pytest.approx(12000 / (2 * 1600 + 3 * 6400), rel=1e-3)
    assert "thin 2 m, thick 3 m" in warned(about)["shared"]["depths"]
    _, about = body(f"t.asc --polygon p.geojson --shape {shape} --volume {2 * 1600 + 3 * 6400}")
    assert "shared" not in warned(about)
    _, about = body("t.asc --polygon p.geojson --shape slbl --curvature 0.01")
    assert warned(about)["unused depth"]["attribute"] == "thickness"
    areas(both[0])
    for shape_of_one in ("sphere --depth 4", "ellipsoid --volume 9000", "plane --dip 20"):
        assert "unused depth" in warned(body(f"t.asc --polygon p.geojson --shape {shape_of_one}")[1]), shape_of_one
    assert "unused depth" not in warned(body("t.asc --polygon p.geojson --depth 2")[1])
    refused("t.asc --polygon p.geojson", "--depth: must be given for --shape sphere", "--shape slab", "thickness")
    areas(both[0], (both[1][0], {"name": "thick"}))
    refused(f"t.asc --polygon p.geojson --shape {shape} --volume 12000", "p.geojson", "attribute thickness", "--volume",
            "got none of thick")


def test_a_body_in_a_pit_is_warned_of(body):
    """500 m deep on an area 60 m wide: whatever asks for it, the most of it lies below the ground at its toe."""
    x, y, _ = terrain(ramp(30))
    where = box(80, 70, 140, 130)
    polygon(where)
    inside = (abs(x - 110) < 30) & (abs(y - 100) < 30)
    write_tif("deep.tif", np.where(inside, 500.0, 0.0), 2)
    fall = 60 * math.tan(math.radians(30))
    for asked in ("--polygon p.csv --shape slab --depth 500", "--polygon p.csv --shape slab --volume 1.8e6",
                  "--polygon p.csv --shape slbl --depth 70"):
        found, about = body(f"t.asc {asked}")
        pit = warned(about)["in a pit"]
        assert pit["depth"] == pytest.approx(found["largest_depth"]) and pit["fall"] == pytest.approx(fall, rel=0.05)
        assert 50 < pit["percent"] < 100
    for asked in ("", "--polygon p.csv"):
        assert warned(body(f"t.asc {asked} --scar deep.tif --scar-is depth")[1])["hollow"]["depth"] > 480
    areas((where, {"name": "cm", "thickness": 150.0}), (box(30, 70, 70, 130), {"name": "m", "thickness": 1.5}))
    _, about = body("t.asc --polygon p.geojson --shape slab")
    assert [one["part"] for one in about["warnings"] if one["kind"] == "in a pit"] == ["cm"]
    for asked in ("--shape slab --depth 20", "--shape sphere --depth 20", "--shape slbl --depth 20", "--dip 15"):
        assert "in a pit" not in warned(body(f"t.asc --polygon p.csv {asked}")[1]), asked


def test_a_slab_is_the_ground_lowered(body, refused):
    """On ribs no curved surface is as shallow, and each names the slab."""
    _, _, z = terrain(lambda x, y: 0.7 * x + 18 * np.exp(-((x - 155) / 25) ** 2) * (
        np.exp(-((y - 80) / 10) ** 2) + np.exp(-((y - 120) / 12) ** 2)), size=(50, 60), cell=4.0)
    polygon(box(110, 50, 200, 150))
    for shape in ("slbl", "sphere", "ellipsoid"):
        refused(f"t.asc --polygon p.csv --shape {shape} --depth 1.5", "--depth: must be at least", "--shape slab")
    found, about = body("t.asc --polygon p.csv --shape slab --depth 1.5")
    assert found["volume"] == pytest.approx(1.5 * 88 * 100, rel=0.05) and found["mean_depth"] == pytest.approx(1.5)
    assert warned(about) == {}
    slip = rasters.read_asc_local("r.slip.asc").z
    assert set(np.round(z - slip, 3).ravel()) == {0.0, 1.5}
    found, _ = body("t.asc --polygon p.csv --shape slab --volume 4000")
    assert found["largest_depth"] == pytest.approx(4000 / found["area"], abs=1e-4)


def test_a_lost_polygon_does_not_hide_a_body_in_parts(body):
    """Parts are counted in each polygon; those that are too small to count are told, so that all add up."""
    terrain(lambda x, y: 0.5 * x + 12 * np.sin(y / 15))
    areas((box(60, 20, 120, 180), {"name": "ribs"}), (box(180, 90, 180.5, 90.5), {"name": "lost"}))
    found, about = body("t.asc --polygon p.geojson --shape slbl --curvature 0")
    parts = warned(about)["parts"]
    assert next(one["part"] for one in about["warnings"] if one["kind"] == "parts") == "ribs"
    volumes = [float(text.replace(",", "")) for text in parts["volumes"].split(" and ")]
    rest = re.search(r"and (\S+) m3 in \d+ smaller", parts["rest"])
    assert sum(volumes) + (float(rest[1].replace(",", "")) if rest else 0) == pytest.approx(found["volume"], rel=1e-4)
    assert parts["parts"] >= len(volumes) >= 2 and warned(about)["no body"]["polygon"] == "p.geojson: lost"


def test_a_polygon_of_a_scar_without_any_is_named(body):
    terrain(hill)
    terrain(lambda x, y: 6.0 * (np.hypot(x - 120, y - 100) < 20), "depth.asc")
    areas((box(90, 70, 150, 130), {"name": "with"}), (box(20, 20, 40, 40), {"name": "without"}))
    _, about = body("t.asc --polygon p.geojson --scar depth.asc --scar-is depth")
    assert warned(about)["no body"]["polygon"] == "p.geojson: without"


def test_the_picture_has_all_polygons_and_the_bearing_is_the_bodys(slope, monkeypatch, here):
    shown, draw_map = [], release_chart.draw_map
    monkeypatch.setattr(release_chart, "draw_map", lambda *of: (shown.append(of[4]), draw_map(*of)))
    terrain(lambda x, y: np.where(y > 100, 0.6 * x + 60, 0.6 * x + 0.6 * y))
    areas((box(60, 20, 120, 80), {"name": "lost"}), (box(60, 120, 160, 190), {"name": "body"}))
    terrain(lambda x, y: 3.0 * (y > 130) * (y < 180) * (x > 80) * (x < 140), "depth.asc")
    status, out, err = slope("t.asc --polygon p.geojson --scar depth.asc --scar-is depth -o r")
    assert status == 0, err
    xlo, ylo, xhi, yhi = shown[0]
    assert xlo < 60 and ylo < 20 and xhi > 160 and yhi > 190
    assert "towards 270 degrees" in out


def test_that_one_body_lies_above_another_is_no_fall(body):
    terrain(lambda x, y: ramp(31)(x, y) + 30.0 * (y > 100))
    areas((box(40, 20, 70, 80), {"name": "lower"}), (box(90, 120, 160, 180), {"name": "upper"}))
    _, about = body("t.asc --polygon p.geojson --shape slab --depth 3")
    assert about["body"]["bearing"] == pytest.approx(270, abs=0.1)


def test_a_target_out_of_reach(refused):
    terrain(ramp(30))
    polygon(box(60, 60, 140, 140))
    refused("t.asc --polygon p.csv --volume 1e8", "--volume: must be at most", "half sphere", "got 100000000")
    refused("t.asc --polygon p.csv --dip 20 --volume 1e8", "--volume: must be at most", "plane through the toe")
    refused("t.asc --polygon p.csv --dip 20 --depth 90", "--depth: must be at most", "got 90")
    refused("t.asc --polygon p.csv --shape slbl --volume 1e9", "--volume: must be at most", "a curvature of")
    refused("t.asc --polygon p.csv --dip 30 --volume 1e4", "--volume: must be at most")
    refused("t.asc --polygon p.csv --dip 35 --volume 1e9", "--volume: must be at most")


# --- the files ---


def bilinear_volume(slip, ground, parts=8):
    """Between two files with cells of 2 m, by points in every patch; both read by the letter of the format."""
    a, b = (np.array([line.split() for line in Path(path).read_text().splitlines()[6:]], float)
            for path in (ground, slip))     # NODATA is -9999 in both
    depth = a - b
    u = (np.arange(parts) + 0.5) / parts
    total = 0.0
    for fx in u:
        for fy in u:
            total += ((1 - fx) * (1 - fy) * depth[:-1, :-1] + fx * (1 - fy) * depth[:-1, 1:]
                      + (1 - fx) * fy * depth[1:, :-1] + fx * fy * depth[1:, 1:]).sum()
    return total / parts ** 2 * 4.0


def test_a_steep_head_on_coarse_cells_is_no_wall():
    """A cap that runs out within its last cells, 3 of 5 m deep there; the same that a line cuts off is one."""
    x, y = np.meshgrid(np.arange(-20, 21, 2.0), np.arange(-20, 21, 2.0))
    depth = np.maximum(5 - 0.05 * (x ** 2 + y ** 2) ** 0.88, 0)
    steep = np.where(x < -6.5, 0, np.maximum(depth, np.where(x < -5.5, 3, 0) * (depth > 0)))
    inside = depth > 0
    assert depth[inside].min() < 2 and release_solve.wall(depth, inside) == 0
    assert release_solve.wall(steep, steep > 0) > 2.5
    sphere = np.maximum(np.sqrt(np.maximum(14.5 ** 2 - x ** 2 - y ** 2, 0)) - 9.5, 0)      # dips by 45 degrees and more
    assert sphere[sphere > 0].min() > 0 and release_solve.wall(sphere, sphere > 0) == 0
    cut = np.where(np.abs(y) < 5, sphere, 0)
    assert release_solve.wall(cut, cut > 0) == cut[np.abs(y) == 4].max() > 3


@pytest.mark.drawn
def test_the_files(slope, here):
    _, _, z = terrain(hill)
    digits = z + np.random.default_rng(1).uniform(-1e-6, 1e-6, z.shape)     # more than a millimetre has
    digits[0, 0] = digits[3, 5] = np.nan
    write_asc("t.asc", digits, 2.0)
    polygon(Polygon([(60, 50), (180, 60), (170, 140), (70, 150)]))
    status, out, err = slope("t.asc --polygon p.csv --depth 9 -o r")
    above, wall = err.splitlines()
    assert status == 0 and "lies above the ground on 696 m2 of the polygon" in above
    assert "m deep at the rim of its area, where it ends in a wall" in wall
    assert sorted(path.name for path in here.iterdir()) == sorted([*NAMES, "t.asc", "t.yaml", "p.csv"])
    about = yaml.safe_load(Path("r.yaml").read_text())
    volume = about["body"]["volume"]
    assert float(re.search(r"volume (\S+) m3", out)[1].replace(",", "")) == pytest.approx(volume, rel=5e-5)
    assert bilinear_volume("r.slip.asc", "t.asc") == pytest.approx(volume, rel=1e-9)
    slip, place = rasters.read_asc_local("r.slip.asc"), rasters.read_sidecar("t.asc")
    assert slip.crs == place.crs and slip.offset == place.offset == (EAST, NORTH)
    raster = rasters.read_asc_local("t.asc")
    away = ~release_area.nodes_inside(raster, polygons.read_local("p.csv", raster))
    assert np.array_equal(slip.z[away], raster.z[away], equal_nan=True)     # to the last digit
    assert (slip.z[~away] <= raster.z[~away]).all()
    depth = rasters.read_asc_local("r.depth.asc").z
    assert np.nansum(depth) * 4 == pytest.approx(volume, rel=1e-9) and np.nanmin(depth) > 0
    assert about["body"]["largest_depth"] == pytest.approx(np.nanmax(depth)) == pytest.approx(9, abs=1e-4)
    assert about["body"]["area"] == np.isfinite(depth).sum() * 4 and about["shape"] == "sphere"
    with rasterio.open("r.png") as picture:
        shown = picture.read()
    assert min(shown.shape[1:]) > 500 and len(np.unique(shown.reshape(shown.shape[0], -1), axis=1).T) > 500
    for name, value in (("largest depth", "largest_depth"), ("mean depth", "mean_depth")):
        assert f"{name} {about['body'][value]:.4g} m" in out
    assert f"mean slope {about['body']['mean_slope']:.1f} degrees" in out


def test_numbers_come_before_files(slope, monkeypatch, here):
    def full(path, *rest):
        raise OSError(28, "No space left on device")
    terrain(hill)
    polygon(box(80, 20, 140, 180))
    before = sorted(here.iterdir())
    monkeypatch.setattr(release_chart, "draw_release", full)
    status, out, err = slope("t.asc --polygon p.csv --depth 5 -o r")
    assert status == 2 and "volume" in out and "wrote" not in out
    above, full_disk = err.splitlines()
    assert "lies above the ground" in above
    assert full_disk == "slope release: r: cannot be written: No space left on device"
    assert sorted(here.iterdir()) == before


# --- scars ---


def test_scars_give_the_body_back(bumpy, body):
    found, _ = body("t.asc --polygon p.csv --depth 9")
    for name in ("r.slip.asc", "r.slip.yaml", "r.depth.asc", "r.depth.yaml"):
        Path(name).rename(f"a{name}")
    depth = rasters.read_asc_local("ar.depth.asc")
    rasters.write_asc_local("change.asc", depth._replace(z=1.0 * (np.isnan(depth.z)) - np.nan_to_num(depth.z)), {},
                            exact=True)
    for scar in ("ar.slip.asc", "ar.depth.asc --scar-is depth", "change.asc --scar-is change"):
        again, about = body(f"t.asc --scar {scar}")
        assert again == pytest.approx({**found, "wall": again["wall"], "bearing": again["bearing"]}, rel=1e-6)
        assert about["shape"] == "scar"
    half, _ = body("t.asc --scar ar.slip.asc --polygon p.csv --least 4")
    kept = np.nansum(np.where(depth.z >= 4, depth.z, 0)) * 4
    assert half["volume"] == pytest.approx(kept, rel=1e-6) and half["volume"] < found["volume"]
    polygon(box(60, 40, 110, 160), "west.csv")
    west, _ = body("t.asc --scar ar.slip.asc --polygon west.csv")
    assert 0.1 * found["volume"] < west["volume"] < 0.9 * found["volume"]


def test_depths_that_are_taken_for_heights(body, refused):
    """Without --scar-is a raster must follow the terrain; with it, it is what it says."""
    terrain(hill)
    terrain(lambda x, y: 9 * np.clip(1 - np.hypot(x - 120, y - 100) / 40, 0, None), "depth.asc")
    terrain(lambda x, y: -9 * np.clip(1 - np.hypot(x - 120, y - 100) / 40, 0, None), "change.asc")
    refused("t.asc --scar depth.asc", "depth.asc: must be heights that follow the terrain's, ",
            "did you mean depths? Then --scar-is depth; --scar-is surface if they are heights, got 0 to 8.")
    refused("t.asc --scar change.asc", "did you mean the change of the surface? Then --scar-is change")
    found, about = body("t.asc --scar depth.asc --scar-is depth")
    assert found["volume"] == pytest.approx(9 * math.pi * 40 ** 2 / 3, rel=0.01) and about["scar_is"] == "depth"


def test_a_mass_on_top_of_the_terrain(body, slope, no_picture, refused):
    """--scar-is height: the terrain is the slip surface, and terrain and mass are the ground before."""
    mass = lambda x, y: 9 * np.clip(1 - np.hypot(x - 120, y - 100) / 40, 0, None)      # noqa: E731
    _, _, under = terrain(ramp(30))
    terrain(mass, "mass.asc")
    found, about = body("t.asc --scar mass.asc --scar-is height")
    assert found["volume"] == pytest.approx(9 * math.pi * 40 ** 2 / 3, rel=0.01) and about["terrain"] == "r.ground.asc"
    slip, before, top = (rasters.read_asc_local(name) for name in ("r.slip.asc", "r.ground.asc", "mass.asc"))
    assert slip.z == pytest.approx(under, abs=1e-3) and before.z == pytest.approx(under + top.z, abs=2e-3)
    assert (before.crs, before.offset) == (slip.crs, (EAST, NORTH))
    assert "region ground terrain r.ground.asc" in " ".join(Path("r.deck.txt").read_text().split())
    terrain(lambda x, y: mass(x, y) - 1, "below.asc")
    refused("t.asc --scar below.asc --scar-is height -o other", "below.asc: must hold heights above the terrain >= 0",
            "got -1")
    assert slope("t.asc --scar mass.asc --scar-is height --overwrite -o r")[1].endswith("r.ground.asc, r.ground.yaml\n")


def test_a_closed_hollow_in_a_slip_surface(slope, no_picture):
    """A thick mass on a gentle slope, taken as depths: a hollow, as deep as the mass but for the fall across a cell."""
    terrain(ramp(2))
    terrain(lambda x, y: 10 * (np.hypot(x - 120, y - 100) < 31), "deep.asc")
    status, _, err = slope("t.asc --scar deep.asc --scar-is depth -o low")
    lowest = 10 - 2 * math.tan(math.radians(2))
    line = next(line for line in err.splitlines() if "closed hollow" in line)
    assert status == 0 and "--scar-is height" in line
    assert float(re.search(r"hollow, (\S+) m deep", line)[1]) == pytest.approx(lowest, abs=0.03)
    status, _, err = slope("t.asc --scar deep.asc --scar-is height -o high")
    assert status == 0 and "hollow" not in err
    terrain(lambda x, y: 10 * np.clip(1 - np.hypot(x - 120, y - 100) / 40, 0, None), "cone.asc")
    terrain(ramp(30))
    assert "hollow" not in slope("t.asc --scar cone.asc --scar-is depth -o other")[2]


@pytest.mark.parametrize("middle, top, told", [(80, 500, True), (65, 500, True), (100, 500, False), (110, 30, False)])
def test_a_slip_surface_that_comes_out_beyond_the_toe_is_warned_of(body, middle, top, told):
    """The toe is at x = 60, the body 60 m long; a level crest, of which it may have a part, is no toe."""
    terrain(lambda x, y: np.minimum(np.maximum(x - 60, 0) * 0.6, top))
    x, y, depth = terrain(lambda x, y: 4 * np.clip(1 - ((x - middle) / 30) ** 2 - ((y - 100) / 20) ** 2, 0, None),
                          "cap.asc")
    _, about = body("t.asc --scar cap.asc --scar-is depth")
    assert ("beyond toe" in warned(about)) == told
    if told:
        level = (depth > 0) & (x < 60)
        said = warned(about)["beyond toe"]
        # without the row of nodes beside the toe, where the slope is that of both
        assert 0.6 * 4 * level.sum() < said["area"] <= 4 * level.sum()
        assert 0.6 * depth[level].max() < said["depth"] <= depth[level].max() + 1e-3


@pytest.mark.parametrize("words", ["--shape ellipsoid --depth 9", "--scar after.asc"])
@pytest.mark.parametrize("gully", [0, 12])
def test_a_slip_surface_above_the_ground_is_warned_of(body, words, gully):
    """Where a gully through the polygon is deeper than the body; what is lower than the body is no matter."""
    def plain(x, y):
        return 0.6 * x - 9 * np.clip(1 - np.hypot(x - 120, y - 100) / 40, 0, None)

    def ground(x, y):
        return 0.6 * x - gully * (abs(y - 122) < 5)
    terrain(ground)
    terrain(plain, "after.asc")
    polygon(Point(120, 100).buffer(40))
    _, about = body(f"t.asc --polygon p.csv {words}")
    assert ("above ground" in warned(about)) == (gully > 0)
    if gully:
        said = warned(about)["above ground"]
        assert 0.1 * 10 * 70 < said["area"] < 14 * 70 and 0.3 * gully < said["height"] <= gully


@pytest.mark.parametrize("shift", [-0.6, 0.0, 0.6])
def test_two_surveys_over_different_datums(succeed, no_picture, shift):
    """That the datums are not compared is said; what the two differ by beside the body is, too."""
    terrain(hill)
    terrain(lambda x, y: hill(x, y) - shift - 9 * np.clip(1 - np.hypot(x - 120, y - 100) / 40, 0, None), "after.asc")
    polygon(Point(120, 100).buffer(42))
    out, err = succeed("t.asc --scar after.asc --polygon p.csv -o r")
    assert f"vertical datums are not compared, beside the body the two surveys differ by {abs(shift):.2g} m" in out
    assert (f"after.asc lies 0.6 m {'below' if shift > 0 else 'above'} the terrain" in err) == bool(shift)


def test_a_scar_on_another_grid_and_in_another_crs(body):
    dent = (lambda x, y: 12 * np.clip(1 - ((x - 120) / 40) ** 2 - ((y - 100) / 30) ** 2, 0, None))
    terrain(ramp(30))
    terrain(lambda x, y: ramp(30)(x, y) - dent(x, y), "fine.asc", (266, 320), 0.75)
    found, _ = body("t.asc --scar fine.asc --least 0.01")
    assert found["volume"] == pytest.approx(math.pi / 2 * 12 * 40 * 30, rel=3e-3)
    assert found["largest_depth"] == pytest.approx(12 * (1 - 1 / 40 ** 2 - 1 / 30 ** 2), abs=0.01)
    raster = rasters.read_asc_local("fine.asc")
    raster = raster._replace(z=dent(*np.meshgrid(0.75 * (np.arange(320) + 0.5), 0.75 * (265.5 - np.arange(266)))))
    with rasterio.open("far.tif", "w", driver="GTiff", height=266, width=320, count=1, dtype="float64", crs=CRS_M,
                       transform=Affine.translation(EAST, NORTH) @ raster.transform) as out:
        out.write(raster.z, 1)
    subprocess.run(["gdalwarp", "-q", "-t_srs", "EPSG:6668", "-r", "bilinear", "-tr", "8e-6", "8e-6", "-dstnodata",
                    "-9999", "far.tif", "degrees.tif"], check=True)
    other, _ = body("t.asc --scar degrees.tif --scar-is depth --least 0.01")
    assert other["volume"] == pytest.approx(found["volume"], rel=5e-3)


def test_two_surveys_that_agree_but_for_the_millimetre_of_the_terrain(body):
    """Heights with more digits than a terrain has: beside the scar the two differ by rounding, which is no body."""
    def ground(x, y):
        return ramp(30)(x, y) + 1e-3 * np.sin(x * y)
    x, y, _ = terrain(ground)
    dent = np.where(np.hypot(x - 120, y - 100) < 30, 4.0, 0.0)
    write_tif("after.tif", ground(x, y) - dent, 2)
    found, _ = body("t.asc --scar after.tif")
    assert found["volume"] == pytest.approx(dent.sum() * 4, rel=1e-4) and found["cells"] == (dent > 0).sum()


@pytest.mark.parametrize("kind, sign", [("depth", 1), ("change", -1)])
@pytest.mark.parametrize("cropped", [False, True])
def test_nodata_beside_a_scar_of_coarse_cells_costs_no_volume(body, kind, sign, cropped):
    """Depths in cells five times as wide as the terrain's, NODATA beside them or no cells at all: their sum is kept."""
    terrain(ramp(30))
    depth = np.full((20, 24), np.nan)
    depth[6:14, 8:17] = sign * np.random.default_rng(4).uniform(1, 9, (8, 9))
    if cropped:
        write_tif("scar.tif", depth[6:14, 8:17], 10, EAST + 80, NORTH + 60)
    else:
        write_tif("scar.tif", depth, 10)
    found, _ = body(f"t.asc --scar scar.tif --scar-is {kind}")
    assert found["volume"] == pytest.approx(abs(np.nansum(depth)) * 100, rel=1e-4)


@pytest.mark.parametrize("kind", ["depth", "change", "surface"])
@pytest.mark.parametrize("marked", [0.0, np.nan])
def test_a_scar_without_a_value_inside_is_warned_of(body, kind, marked):
    """A gap of 5 x 5 nodes in a bowl, not deep, near its rim; what marks the ground beside a scar is none."""
    x, y, z = terrain(ramp(30))
    depth = np.maximum(0, 9 * (1 - ((x - 120) / 50) ** 2 - ((y - 100) / 50) ** 2))
    known = np.where(depth > 0, depth, marked)
    gap = (abs(x - 163) < 5) & (abs(y - 101) < 5)
    polygon(box(60, 40, 180, 160))
    for missing in (gap, gap & False):
        values = {"depth": known, "change": -known, "surface": z - depth}[kind]
        write_tif("gap.tif", np.where(missing, np.nan, values), 2)
        for asked in ("", "--polygon p.csv"):
            _, about = body(f"t.asc --scar gap.tif --scar-is {kind} {asked}")
            area = 4 * missing.sum()
            assert warned(about).get("unknown inside") == ({"area": area, "file": "gap.tif"} if area else None)
            assert "rim" not in warned(about)
    assert gap.sum() == 25


def test_a_scar_that_is_none(refused):
    terrain(ramp(30))
    terrain(lambda x, y: np.where(np.hypot(x - 120, y - 100) < 30, -3.0, 0.0), "change.asc")
    refused("t.asc --scar change.asc --scar-is change --least 4", "somewhere, by --least 4 m")
    terrain(ramp(30), "away.asc", offset=(EAST + 5000, NORTH))
    refused("t.asc --scar away.asc", "away.asc: must overlap the terrain")
    refused("t.asc --scar none.asc", "none.asc: must be an existing file")
    refused("t.asc --scar change.asc --volume 100", "--volume: must not be given with --scar")
    terrain(ramp(30, top=499), "lower.asc")
    refused("t.asc --scar lower.asc", "lower.asc: must stay at least 2 cells away from NODATA and from the edge of "
            "t.asc", "--least D")
    write_tif("empty.tif", np.full((100, 120), np.nan), 2, crs=None)
    for kind in ("surface", "depth", "change"):
        refused(f"t.asc --scar empty.tif --scar-is {kind}", "empty.tif: must hold a value, all cells are NODATA")
    polygon(box(10, 10, 40, 40))
    refused("t.asc --scar change.asc --scar-is change --polygon p.csv", "p.csv: must hold some of the scar")


# --- layers ---


def test_layers_of_a_gis_are_the_same_body(body):
    terrain(hill)
    shape = Polygon([(60, 50), (180, 60), (170, 140), (70, 150)])
    polygon(shape)
    found, _ = body("t.asc --polygon p.csv --shape slbl --volume 50000")
    in_crs = Polygon([(x + EAST, y + NORTH) for x, y in shape.exterior.coords])
    write_geojson("p.geojson", in_crs, crs=CRS_M)
    lon, lat = rasterio.warp.transform(CRS_M, "EPSG:4326", *np.transpose(in_crs.exterior.coords).tolist())
    write_geojson("degrees.geojson", Polygon(zip(lon, lat)))
    with fiona.open("p.shp", "w", driver="ESRI Shapefile", schema={"geometry": "Polygon", "properties": {}},
                    crs=CRS_M) as out:
        out.write({"geometry": mapping(in_crs), "properties": {}})
    for layer in ("p.geojson", "degrees.geojson", "p.shp"):
        again, about = body(f"t.asc --polygon {layer} --shape slbl --volume 50000")
        assert again == pytest.approx(found, rel=1e-6) and about["polygon"] == layer


def test_bad_input(refused):
    terrain(lambda x, y: 5 + 0.001 * x)
    polygon(box(60, 60, 160, 140))
    refused("t.asc --polygon p.csv --depth 5", "p.csv: the ground in it must fall by at least 1 degree")
    terrain(hill)
    refused("t.asc --polygon p.csv", "--depth: must be given for --shape sphere, or --volume")
    refused("t.asc --depth 5", "--polygon: must be given, unless --scar")
    refused("t.asc --polygon p.csv --shape plane --depth 5", "--dip: must be given for a plane")
    refused("t.asc --polygon p.csv --dip 95", "--dip: must be > 0 and < 90 degrees, got 95")
    refused("t.asc --polygon p.csv --dip 30 --direction 400", "--direction: must be a compass bearing", "got 400")
    refused("t.asc --polygon p.csv --shape slbl --dip 30 --depth 2", "--dip: must be given for a plane only")
    refused("t.asc --polygon p.csv --shape sphere --curvature 0.1", "--curvature: must be given for slbl only")
    refused("t.asc --polygon p.csv --shape slbl --curvature 1e9", "--curvature: must be >= -", "got 1e+09")
    refused("t.asc --polygon p.csv --scar t.asc --least -1", "--least: must be >= 0, got -1")
    refused("t.asc --polygon p.csv --depth 5 --least 1", "--least: must be given with --scar only, got 1")
    refused("t.asc --polygon p.csv --depth 5 --scar-is depth", "--scar-is: must be given with --scar only, got depth")
    refused("t.asc --polygon p.csv --depth 5 -o nowhere/r", "-o: must be in an existing folder, got nowhere/r")
    refused("none.asc --polygon p.csv --depth 5", "none.asc: must be an existing file")
    (Path() / "t.tif").write_bytes(Path("t.asc").read_bytes())
    refused("t.tif --polygon p.csv --depth 5 --local", "t.tif: must be an .asc with square cells")
    write_asc("r.slip.asc", np.ones((40, 40)), 2.0)
    refused("r.slip.asc --polygon p.csv --depth 5 --local", "-o: must be another name: r.slip.asc belongs to an input")
    refused("t.asc --polygon p.csv --depth 5 -o t", "-o: must be another name: t.yaml belongs to an input")


def test_a_polygon_beside_nodata(refused):
    """Its place is said; other bad places are in test_wrong_inputs.py."""
    def height(x, y):
        z = np.where(x < 150, 0.6 * x, 90.0)
        z[np.hypot(x - 47, y - 97) < 1] = np.nan
        return z
    terrain(height)
    polygon(box(20, 60, 80, 140))
    refused("t.asc --polygon p.csv --depth 5", "p.csv: must stay at least 2 cells away from NODATA and from the edge",
            f"got NODATA at east {EAST + 47:.1f} north ")


# --- LAMMPS ---

CONTACT = """
variable     kn equal 1.96e9*v_d/1.25
pair_style   gran/restitution
pair_coeff   1 1 stiffness ${kn} ${kn} restitution 0.48 friction 30 rolling 0.05
pair_coeff   1 2 stiffness ${kn} ${kn} restitution 0.48 friction 0
pair_coeff   1 3 stiffness ${kn} ${kn} restitution 0.1 friction 30 rolling 0.05
neighbor     $(0.2*v_d) bin
neigh_modify every 1 delay 0 check yes
timestep     $(0.25*sqrt(2977*PI/6*v_d^3/v_kn))
"""


def released(name, d, steps=0):
    """The summary of a run of NAME's deck with a contact model and gravity; hardly a ball is taken out at the start."""
    lmp = os.environ.get("LMP")
    if not lmp or not Path(lmp).is_file():
        pytest.skip("LMP names no lmp")
    head, tail = Path(f"{name}.deck.txt").read_text().split("# --- contact model")
    deck = ("units si\natom_style sphere\nboundary s s fs\ncomm_modify vel yes\n" + head + CONTACT
            + tail.split("\n", 1)[1] + "fix move soil nve/sphere\nfix weight soil gravity 9.80665 vector 0 0 -1\n"
            f"thermo_modify lost ignore\nrun {steps}\n")
    Path("in.deck").write_text(deck)
    done = subprocess.run([lmp, "-in", "in.deck", "-var", "d", str(d), "-log", "none"], capture_output=True, text=True,
                          timeout=600, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    summary = yaml.safe_load(Path(f"{name}.summary.yaml").read_text())
    removed = int(re.search(r"Delete_balls: (\d+) balls", done.stdout)[1])
    print(name, d, summary["balls"], removed)
    assert removed <= 0.02 * summary["balls"]["released"]       # at corners of walls
    return summary


@pytest.mark.parametrize("shape", ["--shape sphere", "--shape ellipsoid", "--shape slbl", "--dip 24"])
def test_a_run_releases_what_is_printed(bumpy, body, shape):
    found, _ = body(f"t.asc --polygon p.csv {shape} --volume 60000")
    for d in (5, 2.5):
        summary = released("r", d)
        assert summary["volume"]["released"] == pytest.approx(found["volume"], rel=0.002)
        assert summary["release"]["bulk_factor"] == pytest.approx(1 / 0.60, rel=0.05)
    base = rasters.read_raster("r.base.asc").z     # on a grid of the terrain's cells: the slip surface's own nodes
    assert base == pytest.approx(rasters.read_raster("r.slip.asc").z, abs=1e-6)


def test_the_balls_slide(bumpy, body):
    body("t.asc --polygon p.csv --shape slbl --volume 60000")
    summary = released("r", 5, steps=2000)
    assert summary["motion"]["median_speed"] > 0.3 * 9.8 * 0.5 * summary["time"]
    assert summary["balls"]["lost"] == 0 and summary["guards"]["deep_contacts"] == 0


def test_a_million_cubic_metres_at_frank(body):
    if not FRANK.is_dir():
        pytest.skip("shared/data/frank is not there")
    after = rasters.read_raster(FRANK / "Frankslide_topography.asc")
    pile = rasters.read_raster(FRANK / "Frankslide_pile.asc", heights=False)
    rasters.write_asc_local("before.asc", after._replace(z=after.z + pile.z), {})
    scar, _ = body(f"before.asc --scar {FRANK / 'Frankslide_topography.asc'}")
    assert scar["volume"] == pytest.approx(pile.z.sum() * 400, rel=1e-6) == pytest.approx(36.0e6, rel=1e-3)
    Path("p.csv").write_text("650,1350\n950,1400\n930,1650\n640,1600\n")
    for shape in ("sphere", "ellipsoid", "slbl", "plane --dip 36"):
        found, _ = body(f"before.asc --polygon p.csv --shape {shape} --volume 1e6")
        assert found["volume"] == pytest.approx(1e6, rel=1e-5)
    for d in (10, 5):
        assert released("r", d)["volume"]["released"] == pytest.approx(1e6, rel=0.002)


def test_the_depths_of_s1000(body):
    if not S1000.is_dir():
        pytest.skip("shared/data/s1000 is not there")
    shallow = f"{shlex.quote(str(S1000 / 'pre_runout_DEM.asc'))} --scar {S1000 / 'landslide_depth.asc'}"
    found, about = body(f"{shallow} --scar-is change")
    assert found["volume"] == pytest.approx(22481, abs=1) and found["largest_depth"] == pytest.approx(15.7, abs=0.05)
    assert found["cells"] == warned(about)["few cells"]["cells"] == 30


# --- the page ---


def test_the_output_on_the_page(slope, no_picture):
    page = (TOP / "doc" / "src" / "tool_release.rst").read_text(encoding="ascii")
    terrain(hill, "terrain.asc")
    terrain(hill)
    polygon(Polygon([(60, 50), (180, 60), (170, 140), (70, 150)]), "release.csv")
    for _ in range(2):      # a second time over the files of the first
        status, out, _ = slope("terrain.asc --polygon release.csv --volume 60000 -o release")
        assert status == 0 and all(f"   {line}\n" in page for line in out.splitlines()[:3])
    regions = [line for line in Path("release.deck.txt").read_text().splitlines() if line.startswith("region ")]
    assert len(regions) == 5 and all(f"   {line}\n" in page for line in regions)
    assert f"   {slope('terrain.asc --polygon release.csv --volume 1e9 -o release')[2]}" in page


@pytest.mark.parametrize("command", examples("release"))
def test_every_example_of_the_page_and_the_help_runs(slope, no_picture, command):
    terrain(hill, "terrain.asc")
    terrain(hill, "t.asc")
    terrain(hill, "before.asc")
    terrain(lambda x, y: hill(x, y) - 8, "old_ground.asc")
    terrain(lambda x, y: hill(x, y) - 6 * (np.hypot(x - 120, y - 100) < 40), "after.asc")
    terrain(lambda x, y: -6.0 * (np.hypot(x - 120, y - 100) < 40), "change.asc")
    terrain(lambda x, y: 6.0 * (np.hypot(x - 120, y - 100) < 40), "depth.asc")
    shape = Polygon([(60, 50), (180, 60), (170, 140), (70, 150)])
    in_crs = Polygon([(x + EAST, y + NORTH) for x, y in shape.exterior.coords])
    polygon(shape, "release.csv")
    write_geojson("release.geojson", in_crs, crs=CRS_M)
    with fiona.open("release.shp", "w", driver="ESRI Shapefile", schema={"geometry": "Polygon", "properties": {}},
                    crs=CRS_M) as out:
        out.write({"geometry": mapping(in_crs), "properties": {}})
    status, out, err = slope(command)
    if "--help" in command:
        assert "tools/slope release terrain.asc" in out
    else:
        assert status == 0 and "volume" in out and "wrote" in out, err


def test_contours_below_the_sea_are_solid_and_their_labels_stand_upwards(here):
    """A ridge that runs from south to north: its contours come down as they go up, and matplotlib dashes those < 0."""
    x, y = np.meshgrid(np.arange(60.0), np.arange(60.0))
    axes = Figure().add_subplot()
    axes.imshow(x, extent=(0, 60, 0, 60))
    maps.contours(axes, -5 * np.abs(x - 30 + 3 * np.sin(y / 9)), (0, 60, 0, 60), 10.0)
    turned = [text.get_rotation() for text in axes.texts]
    turned = [angle - 360 if angle > 180 else angle for angle in turned]
    assert len(turned) > 4 and any(angle > 90 for angle in turned)
    assert all(-maps.STANDING <= angle < 180 - maps.STANDING for angle in turned)
    dashes = [style for lines in axes.collections for style in lines.get_linestyles()]
    assert dashes and all(pattern is None for _, pattern in dashes)
