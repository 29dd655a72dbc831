"""tools/slope volume: prisms and wedges by hand, conservation, files that agree, places that are right, bad input."""
import json
import math
import os
import re
import subprocess
from pathlib import Path

import fiona
import numpy as np
import pytest
import rasterio
import rasterio.warp
import yaml
from matplotlib.path import Path as Outline
from shapely.affinity import rotate, translate
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box, shape
from shapely.ops import unary_union

import made_rows
import made_study
from run_helpers import (BULK, CRS_M, EAST, NORTH, TOP, centres, examples, warned, write_asc, write_geojson, write_run,
                         write_sidecar)
from tiny_collapse import rows_of

from slope_tools import geometry
from slope_tools.deposits import cut, deposit, volume, volume_files
from slope_tools.survey import rasters, roads

COMMAND = "volume"
LMP = os.environ.get("LMP", str(TOP / "build" / "lmp"))
TAN30 = math.tan(math.radians(30))
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")


@pytest.fixture
def no_map(monkeypatch):
    """The map, which takes most of the time, is left out."""
    monkeypatch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())


@pytest.fixture
def cleared(slope, no_map):
    """Run it on `run` with --local, which must succeed; gives volume.yaml."""
    def run(road, arguments="--mesh 10"):
        write_geojson("road.geojson", *(road if isinstance(road, list) else [road]))
        status, _, err = slope(f"run --road road.geojson --local -o out {arguments}")
        assert status == 0, err
        return yaml.safe_load(Path("out/volume.yaml").read_text())
    return run


def strip(rows=80, columns=100, cell=2.5, thickness=3.0, y=(80, 120), x=(0, 1e9)):
    """An even deposit between two y, right across the grid, and the centres of its cells."""
    east, north = centres(rows, columns, cell)
    return np.where((north > y[0]) & (north < y[1]) & (east > x[0]) & (east < x[1]), thickness, 0.0)


def wedge(thickness, length, rise):
    """By hand, per metre of road: what lies above a cut that rises from a deposit's foot, over a length beside it."""
    if rise <= 0:
        return thickness * length
    if length * rise >= thickness:
        return thickness ** 2 / (2 * rise)
    return thickness * length - rise * length ** 2 / 2


@pytest.mark.parametrize("apart", [8.0, 30.0])
def test_a_cut_through_two_carriageways(slope, no_map, apart):
    """That of the union of both: less than the sum of two cuts, which overlap; each has its stretches."""
    write_run(strip(), 7.0, 2.5)
    found = {}
    for name, several in (("one", [100]), ("other", [100 + apart]), ("both", [100, 100 + apart])):
        Path(f"{name}.csv").write_text(f"{roads.MARK}\n" + "\n".join(f"{x},5\n{x},195\n" for x in several))
        status, _, err = slope(f"run --road {name}.csv --road-width 6 --local -o {name} --mesh 10 --lane 3")
        assert status == 0, err
        found[name] = yaml.safe_load(Path(name, "volume.yaml").read_text())
    write_geojson("area.geojson", *(box(x - 3, 5, x + 3, 195) for x in (100, 100 + apart)))
    status, _, err = slope("run --road area.geojson --local -o area --mesh 10")
    assert status == 0, err
    one, other, both = (found[name]["volume"]["remove"] for name in ("one", "other", "both"))
    area = yaml.safe_load(Path("area", "volume.yaml").read_text())
    assert both == pytest.approx(area["volume"]["remove"], rel=1e-6) and max(one, other) < both
    assert both < one + other if apart < 20 else both == pytest.approx(one + other)
    assert found["both"]["axis"]["blocked_length"] == pytest.approx(80) == 2 * found["one"]["axis"]["blocked_length"]
    assert sum(row["remove"] for row in found["both"]["stretches"]) == pytest.approx(both, abs=0.01)


# --- by hand ---

def plain_deposit(thickness, base, cell):
    transform = rasters.Affine(cell, 0, 0, 0, -cell, thickness.shape[0] * cell)
    return deposit.Deposit("run", rasters.Raster(thickness, transform, None), base, {"bulk_factor": BULK}, None)


def evaluated(thickness, ground, road, mesh=10, angle=30, samples=4):
    """Volumes without the command: what is removed on the road, beside it, and where the cut is below the ground."""
    x, y = centres(*thickness.shape, 2.5)
    run = plain_deposit(thickness, ground(x, y) * np.ones_like(x), 2.5)
    result = volume.evaluate_removal(run, road, angle, geometry.make_mesh(mesh, run.raster), samples)
    return result.total(result.road), result.total(result.beside), result.steep


@pytest.mark.parametrize("samples", [2, 4, 6])
@pytest.mark.parametrize("west, east", [(90, 110), (91.3, 108.9), (100.01, 102.5), (98.75, 103.75)])
def test_prism_and_wedges_on_flat_ground(west, east, samples):
    for angle in (30, 1, 80):
        road, beside, _ = evaluated(strip(), lambda x, y: 7 + 0 * x, box(west, 0, east, 200), 7, angle, samples)
        tangent = math.tan(math.radians(angle))
        assert road == pytest.approx(3 * 40 * (east - west), rel=1e-9)
        assert beside == pytest.approx(40 * (wedge(3, west, tangent) + wedge(3, 250 - east, tangent)), rel=1e-9)


@pytest.mark.parametrize("sx, sy", [(0.2, 0), (0.5, 0), (-0.3, 0), (0.7, 0), (0.3, 0.4), (-0.9, 0.2)])
@pytest.mark.parametrize("turn", [0, 13, -31])
def test_prism_and_wedges_on_a_plane(sx, sy, turn):
    """A road that crosses the strip at an angle, on ground that rises along x and y."""
    road = rotate(box(116.2, -400, 131.9, 600), turn, origin=(125, 100)).intersection(box(0, 0, 250, 200))
    got = evaluated(strip(), lambda x, y: 100 + sx * x + sy * y, road, 9)
    outward = np.array([math.cos(math.radians(turn)), math.sin(math.radians(turn))])  # of the eastern edge
    along = 40 / math.cos(math.radians(turn))  # length of an edge in the strip
    beside, steep = 0.0, 0.0
    for way, half in ((1, 131.9 - 125), (-1, 125 - 116.2)):
        rise = TAN30 - way * outward @ (sx, sy)
        if rise > 0:
            beside += along * wedge(3, 1e9, rise)
        else:  # all of it, to the edge of the grid
            steep += 3 * 40 * (125 - half * along / 40)
    assert got == pytest.approx((3 * 15.7 * along, beside + steep, steep), rel=1e-9, abs=1e-9)


def test_the_command_gives_the_prism_and_the_wedges(cleared):
    write_run(strip(), 7.0, 2.5)
    about = cleared(box(91.3, 0, 108.9, 200), "--mesh 7 --cut-angle 40")
    hand = 40 * 3 * 17.6, 40 * 2 * wedge(3, 90, math.tan(math.radians(40)))
    assert about["volume"]["deposit"] == pytest.approx(3 * 40 * 250, rel=1e-9)
    assert about["volume"]["remove_on_road"] == pytest.approx(hand[0], rel=1e-9)
    assert about["volume"]["remove_beside_road"] == pytest.approx(hand[1], rel=1e-9)
    assert about["volume"]["remove"] == pytest.approx(sum(hand), rel=1e-9)
    assert about["volume"]["remove_where_cut_below_ground"] == 0
    assert about["road_area"] == pytest.approx(200 * 17.6, rel=1e-9)
    assert about["cut_angle"] == 40 and about["mesh"]["size"] == 7


def test_what_a_flat_cut_takes_from_a_steep_hillside_is_printed(slope, no_map):
    """Ground that rises across the road by 45 degrees: above it, all of the deposit is to be removed at 30 degrees."""
    write_run(strip(), 100 + centres(80, 100, 2.5)[0], 2.5)
    write_geojson("road.geojson", box(91.3, 0, 108.9, 200))
    for angle, said in ((30, True), (60, False)):
        status, out, _ = slope(f"run --road road.geojson --mesh 10 --local --no-picture --cut-angle {angle} -o removal")
        below = yaml.safe_load(Path("removal/volume.yaml").read_text())["volume"]["remove_where_cut_below_ground"]
        assert status == 0 and (below > 0) == said
        assert (f"{below:.1f} m3 of that" in out and "is the cut angle right?" in out) == said


def test_round_corners_converge(cleared):
    """A deposit all over the grid: beside the corners of the road the cut is a cone."""
    write_run(np.full((80, 80), 3.0), 0.0, 2.5)
    reach = 3 / TAN30
    hand = 20 * 60 * 3 + 2 * (20 + 60) * reach * 3 / 2 + math.pi * reach ** 2 * 3 / 3
    errors = [abs(cleared(rotate(box(90, 70, 110, 130), 27), f"--mesh 10 --samples {k}")["volume"]["remove"] / hand - 1)
              for k in (2, 4, 8)]
    assert errors[0] < 5e-4 and errors[1] < 1.5e-4 and errors[2] < 4e-5


def test_a_wedge_of_deposit_is_as_good_as_its_raster(cleared):
    """Thickness 0.2 x beside the road: even in its cells, so that the volume is exact to the square of the cell."""
    for cell, most in ((2.5, 2e-2), (0.5, 1e-3)):
        x, _ = centres(int(40 / cell), int(100 / cell), cell)
        write_run(np.where(x > 20, 0.2 * (x - 20), 0.0), 0.0, cell)
        got = cleared(box(0, 0, 20, 40))["volume"]["remove"]
        # 0.2 (x - 20) never rises above 0.577 (x - 20), but the first cell is even
        assert got == pytest.approx(40 * wedge(0.2 * cell / 2, cell, TAN30), rel=1e-8)
        got = cleared(box(0, 0, 20, 40), "--mesh 10 --cut-angle 5")["volume"]["remove"]
        hand = 40 * (0.2 - math.tan(math.radians(5))) * 80 ** 2 / 2
        assert got == pytest.approx(hand, rel=most)


def test_a_deposit_below_the_cut_stays(cleared):
    write_run(strip(x=(150, 1e9), thickness=20.0), 0.0, 2.5)
    about = cleared(box(80, 0, 115, 200))
    assert about["volume"]["remove"] == 0 and about["volume"]["stays"] == about["volume"]["deposit"] > 0
    assert about["axis"]["blocked_length"] == 0 and about["mesh"]["cells_to_clear"] == 0
    write_run(np.zeros((80, 80)), 0.0, 2.5)
    about = cleared(box(80, 0, 115, 200))
    assert about["volume"]["remove"] == about["volume"]["deposit"] == 0


def test_islands_and_several_roads(cleared):
    """A hole in the road is not road: the cut rises in it, too."""
    write_run(strip(), 0.0, 2.5)
    island = box(90, 0, 140, 200).difference(box(110, 50, 120, 150))
    hole = 40 * 2 * wedge(3, 5, TAN30)  # its middle, 5 m from both sides, is below the cut's height
    hand = 40 * (3 * 40 + 2 * wedge(3, 90, TAN30)) + hole
    assert cleared(island)["volume"]["remove"] == pytest.approx(hand, rel=1e-9)
    two = [box(50, 0, 60, 200), box(150, 0, 170, 200)]
    assert cleared(two)["volume"]["remove"] == pytest.approx(40 * (3 * 30 + 4 * wedge(3, 40, TAN30)), rel=1e-9)


def lmp_run(here, slope_, columns, layers):
    """The deposit of balls of 1 m, placed one by one: a box of columns x 8 x layers, on a plane that rises along x."""
    rows, width = 16, 40
    x, _ = centres(rows, width, 1.0)
    write_asc("terrain.asc", slope_ * x, 1.0)
    balls = [(i + 0.5, j + 0.5, slope_ * (i + 0.5) + k + 0.5) for i in columns for j in range(4, 12)
             for k in range(layers)]
    deck = ["units si", "atom_style sphere", "boundary f f f", "region ground terrain terrain.asc depth 5 headroom 20",
            "create_box 1 ground", "pair_style none", "comm_modify cutoff 3.0",
            *(f"create_atoms 1 single {x} {y} {z} units box" for x, y, z in balls),
            "set group all diameter 1.0 density 2000.0", "timestep 0.001", "fix move all nve/sphere",
            "fix deposit all deposit/grid 1 0 cell 1.0 terrain ground output run", "run 0"]
    Path("in.balls").write_text("\n".join(deck) + "\n")
    done = subprocess.run([LMP, "-in", "in.balls", "-log", "none"], capture_output=True, text=True,
                          stdin=subprocess.DEVNULL, timeout=120)
    assert done.returncode == 0, done.stdout[-2000:]
    return len(balls)


@pytest.mark.parametrize("slope_", [0.0, 0.25])
def test_balls_placed_by_hand(here, cleared, slope_):
    """Through LAMMPS: two layers of balls of 1 m stand for a box 20 x 8 x 2 m; the road lies askew to the cells."""
    count = lmp_run(here, slope_, range(6, 26), 2)
    about = cleared(box(8.3, 0, 14.1, 16), "--mesh 3")
    # in the west the box ends 2.3 m from the road, before the cut is out of it
    hand = 8 * (2 * 5.8 + wedge(2, 2.3, TAN30 + slope_) + wedge(2, 11.9, TAN30 - slope_))
    assert about["volume"]["deposit"] == pytest.approx(count, rel=1e-9) == 320
    assert about["volume"]["remove"] == pytest.approx(hand, rel=1e-8)
    assert about["volume"]["remove_on_road"] == pytest.approx(8 * 2 * 5.8, rel=1e-8)
    assert about["axis"]["blocked_length"] == pytest.approx(8)
    assert about["axis"]["largest_thickness"] == pytest.approx(2)


# --- what must hold of any deposit ---

def rough(seed, rows=60, columns=70, cell=2.0):
    """A rough slope, a ragged deposit on it and a wavy road: Deposit, road."""
    random = np.random.default_rng(seed)
    x, y = centres(rows, columns, cell)
    base = 0.5 * x + 3 * np.sin(x / 9) * np.cos(y / 7) + random.normal(0, 0.2, x.shape)
    thickness = np.clip(4 * np.sin(x / 23 + 0.5) * np.cos(y / 31 - 1) + random.normal(0, 0.5, x.shape), 0, None)
    s = np.linspace(10, 110, 200)
    middle_ = 60 + 8 * np.sin(s / 15)
    return thickness, base, Polygon([*zip(middle_ - 5, s), *zip((middle_ + 5)[::-1], s[::-1])])


@pytest.mark.parametrize("seed, mesh", [(1, 10), (2, 3.7), (3, 1.9), (4, 300)])
def test_mass_is_conserved_and_every_file_has_the_same_numbers(cleared, seed, mesh):
    thickness, base, road = rough(seed)
    write_run(thickness, base, 2.0)
    about = cleared(road, f"--mesh {mesh} --bulk 2.5")
    total = about["volume"]
    with rasterio.open("out/volume.tif") as file:
        removed = file.read(1)
    assert (removed >= 0).all() and (removed <= thickness).all()
    assert removed.max() == pytest.approx(about["largest_removed_thickness"], abs=1e-6)
    assert 0 < total["remove"] < total["deposit"] == pytest.approx(thickness.sum() * 4, rel=1e-9)
    assert removed.sum() * 4 == pytest.approx(total["remove"], rel=1e-9)
    assert total["remove"] + total["stays"] == pytest.approx(total["deposit"], rel=1e-12)
    assert total["remove_on_road"] + total["remove_beside_road"] == pytest.approx(total["remove"], rel=1e-12)
    table = rows_of("out/volume.csv", float)
    for key in ("deposit", "remove", "remove_on_road", "remove_beside_road"):
        assert math.fsum(row[key] for row in table) == pytest.approx(total[key], abs=1e-11)
    assert math.fsum(row["road_area"] for row in table) == pytest.approx(road.area, rel=1e-9)
    assert all(0 <= row["remove_on_road"] <= row["remove"] <= row["deposit"] for row in table)
    assert all(row["xlo"] / mesh == pytest.approx(round(row["xlo"] / mesh), abs=1e-6) for row in table)
    with open("out/volume.geojson", encoding="ascii") as file:
        features = json.load(file)["features"]
    assert [feature["properties"] for feature in features] == table
    for feature in features:
        where = feature["properties"]
        x, y = where["xlo"], where["ylo"]
        assert shape(feature["geometry"]).equals(box(x, y, x + mesh, y + mesh))
    with rasterio.open("out/volume_mesh.tif") as file:
        by_mesh, to_place = file.read(1), file.transform
    for row in table:
        assert by_mesh[int(row["row"]) - 1, int(row["column"]) - 1] == row["remove"]
        assert to_place @ (row["column"] - 1, row["row"]) == pytest.approx((row["xlo"], row["ylo"]), abs=1e-9)
    assert math.fsum(by_mesh.ravel()) == pytest.approx(total["remove"], rel=1e-12)
    assert about["volume_at_other_bulk_factor"]["remove"] == pytest.approx(total["remove"] * 2.5 / BULK, rel=1e-9)
    assert table[-1]["remove_at_other_bulk_factor"] == pytest.approx(table[-1]["remove"] * 2.5 / BULK, rel=1e-6)


@pytest.mark.parametrize("seed, rise", [(1, 0.0), (2, 0.1), (3, 1.5), (4, -1.5)])
def test_strips_and_bounds_change_nothing(monkeypatch, seed, rise):
    """Strips of a few rows against a single one, ten times as many pieces of the edge near, and no bounds."""
    thickness, base, road = rough(seed)
    base += rise * centres(*base.shape, 2.0)[0]
    run = plain_deposit(thickness, base, 2.0)
    mesh = geometry.make_mesh(7, run.raster)
    results = []
    for strip_, near, diagonal in ((1000, cut.NEAR, cut.HALF_DIAGONAL), (10 ** 9, 40, 10 ** 9)):
        for name, value in (("STRIP", strip_), ("NEAR", near), ("HALF_DIAGONAL", diagonal)):
            monkeypatch.setattr(cut, name, value)
        results.append(volume.evaluate_removal(run, road, 30, mesh, 2))
    pruned, plain = results
    assert np.abs(pruned.removed - plain.removed).max() < 1e-12
    for key in ("deposit", "road", "beside", "road_area", "steep"):
        assert np.abs(getattr(pruned, key) - getattr(plain, key)).max() < 1e-9
    assert plain.steep > 0.3 * plain.total(plain.beside) or abs(rise) < 1  # whole cells are taken on steep ground


@pytest.mark.parametrize("sides", [(-1, 1), (1,)])
@pytest.mark.parametrize("slope_", [1.0, 2.0, 11.4])
def test_cells_that_hold_the_foot_of_a_cutting_do_not_raise_its_cut(slope_, sides):
    """6 m high beside a road of 8 m that falls to one side, in cells of 2.5 m: what lies there, by the profile."""
    def ground(x):
        return 0.03 * x + sum(np.clip((side * x - 4) * slope_, 0, 6) for side in sides)

    far = np.linspace(4, 60, 200001)
    true = sum(np.trapz(np.clip(ground(side * far) + 1.5 - ground(side * 4.0) - (far - 4) * TAN30, 0, 1.5), far)
               for side in (-1, 1))
    found = []
    for shift in np.arange(0, 2.5, 0.25):
        z = np.tile(ground(2.5 * (np.arange(60) + 0.5) - 75 + shift), (8, 1))
        road = box(*(28.4 - shift / 2.5, 0), *(31.6 - shift / 2.5, 8))
        got = cut.removed(np.full(z.shape, 1.5), cut.Ground(z), [road], TAN30 * 2.5, cut.one_cell(z), 4, silent=True)
        found.append(got.mesh_beside.sum() * 2.5 ** 2 / 20 / true)
    assert 0.97 < min(found) and max(found) < 1.03, found


def test_a_lane_beside_a_cutting_has_the_edge_of_its_road():
    """A lane of 4 m, less than two cells of 2.5 m, that touches the foot of a cutting: as in cells of 0.25 m."""
    def taken(cell, shift, on_road):
        x = cell * (np.arange(round(150 / cell)) + 0.5) - 75 + shift
        z = np.tile(np.clip((x - 4) * 11.4, 0, 6), (4, 1))
        lane, road = (box((low - shift + 75) / cell, 0, (4 - shift + 75) / cell, 4) for low in (0, -4))
        got = cut.removed(np.full(z.shape, 1.5), cut.Ground(z), [lane], TAN30 * cell, cut.one_cell(z), 4, silent=True,
                          surface=road if on_road else None)
        return got.cells.sum() * cell / 4

    true = taken(0.25, 0.0, True)
    found, alone = ([taken(2.5, shift, on_road) / true for shift in np.arange(0, 2.5, 0.5)]
                    for on_road in (True, False))
    assert 0.95 < min(found) and max(found) < 1.05 and min(alone) < 0.85, (found, alone)


def test_against_a_sum_over_points(monkeypatch):
    """The definition, point by point: surface - max(ground, cut), in metres, and all edges looked at; but for what the
    road's surface says of its edge."""
    monkeypatch.setattr(cut, "DEPTHS", ())
    thickness, base, road = rough(5, 30, 30)
    road = translate(road, -30, -20).intersection(box(0, 0, 60, 60))
    run = plain_deposit(thickness, base, 2.0)
    got = volume.evaluate_removal(run, road, 30, geometry.make_mesh(10, run.raster), 8)

    def height(x, y):
        return cut.Ground(base).height(*(~run.raster.transform @ (x, y)))

    step = 0.25
    x, y = (values.ravel() for values in centres(240, 240, step))
    t = thickness[((60 - y) / 2).astype(int), (x / 2).astype(int)]
    nearest, rise = np.full(x.size, np.inf), np.zeros(x.size)
    corners = np.array(road.exterior.coords)
    for (ax, ay), (bx, by) in zip(corners, corners[1:]):
        share = np.clip(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2), 0, 1)
        foot = ax + share * (bx - ax), ay + share * (by - ay)
        distance = np.hypot(x - foot[0], y - foot[1])
        nearer = distance < nearest
        nearest[nearer], rise[nearer] = distance[nearer], (height(*foot) + TAN30 * distance)[nearer]
    ground, inside = height(x, y), Outline(corners).contains_points(np.c_[x, y])
    removed = np.clip(ground + t - np.maximum(ground, np.where(inside, ground, rise)), 0, t)
    assert got.total(got.volume) == pytest.approx(removed.sum() * step ** 2, rel=1e-3)
    assert got.total(got.road) == pytest.approx(removed[inside].sum() * step ** 2, rel=5e-3)


def test_coverage_is_shapelys():
    random = np.random.default_rng(3)
    x, y = np.sort(random.uniform(0, 10, 9)), np.sort(random.uniform(0, 8, 7))
    x[0], x[-1], y[0], y[-1] = 0, 10, 0, 8
    shapes = [box(x[2], y[1], x[5], y[4]), box(1, 1, 9, 7).difference(Point(5, 4).buffer(2)),
              rotate(box(3, 3, 7, 4), 30), MultiPolygon([box(0, 0, 2, 2), box(7, 5, 10, 8)]),
              Polygon([(0.5, 0.5), (9, 1), (1, 2), (9.5, 7.9), (0.2, 7)])]
    for polygon in shapes:
        area, in_x, in_y = geometry.coverage(polygon, x, y)
        for j in range(len(y) - 1):
            for i in range(len(x) - 1):
                part = polygon.intersection(box(x[i], y[j], x[i + 1], y[j + 1]))
                assert area[j, i] == pytest.approx(part.area, abs=1e-12)
                if part.area > 1e-9:
                    assert (in_x[j, i] / area[j, i], in_y[j, i] / area[j, i]) == pytest.approx(part.centroid.coords[0])


def test_integral_over_triangles():
    """max(0, f) of a linear f, against many points."""
    random = np.random.default_rng(4)
    u, v, w = random.normal(0, 1, (3, 40))
    a, b = random.uniform(0, 1, (2, 200_000))
    a, b = np.where(a + b > 1, 1 - a, a), np.where(a + b > 1, 1 - b, b)
    points = np.maximum(0, u[:, None] + a * (v - u)[:, None] + b * (w - u)[:, None]).mean(axis=1)
    assert np.abs(cut.positive_mean(u, v, w) - points).max() < 5e-3
    for corners, mean in (((0, 0, 3), 1), ((-1, -1, 0), 0), ((-1, 0, 1), 1 / 6), ((2, 2, 2), 2), ((0, 0, 0), 0)):
        assert cut.positive_mean(*(np.array([corner]) for corner in corners))[0] == pytest.approx(mean)


def test_more_angle_less_volume_and_a_wider_road_more(cleared):
    thickness, base, road = rough(6, 40, 47, 3.0)
    write_run(thickness, base, 3.0)
    volumes = [cleared(road, f"--mesh 10 --cut-angle {angle}")["volume"]["remove"] for angle in (30, 50, 80)]
    assert volumes == sorted(volumes, reverse=True)
    assert volumes[-1] > cleared(road)["volume"]["remove_on_road"]
    assert cleared(road.buffer(1))["volume"]["remove"] > volumes[0]


def test_ground_that_is_not_known(cleared, slope):
    thickness = strip()
    base = np.zeros(thickness.shape)
    base[40:44, 60:64] = np.nan  # 10 m x 10 m beside the road, under the deposit
    write_run(thickness, base, 2.5)
    about = cleared(box(120, 0, 149, 200))      # whose cut reaches 5.2 m: what lies farther off stays
    assert about["volume"]["unknown"] == pytest.approx(7.5 * 10 * 3)
    assert warned(about)["no ground"]["volume"] == pytest.approx(7.5 * 10 * 3)
    with rasterio.open("out/volume.tif") as file:
        assert file.nodata == -9999 and (file.read(1, masked=True).filled(0) >= 0).all()
    # a road over half of it, and one that leaves the terrain: on the road all is counted, the cut rises from beside it
    for road, hole in ((box(120, 0, 155, 200), 5.0), (box(120, 0, 170, 200), 0.0)):
        write_run(thickness, np.zeros(base.shape), 2.5)
        whole = cleared(road)["volume"]
        write_run(thickness, base, 2.5)
        about = cleared(road)
        assert about["volume"]["remove_on_road"] == pytest.approx(whole["remove_on_road"])
        lost = 10 * wedge(3.0, hole, np.tan(np.radians(30)))    # m3 of the cut that lie on the hole beside it
        assert about["volume"]["remove"] == pytest.approx(whole["remove"] - lost)
        assert ("edge without ground" in warned(about)) == (hole > 0)
    assert warned(cleared(box(120, 0, 155, 200)))["edge without ground"]["percent"] == pytest.approx(1.06, abs=0.15)
    base[:, 60:] = np.nan
    write_run(thickness, base, 2.5)
    beyond = cleared(box(120, 0, 200, 200))
    assert beyond["volume"]["remove_on_road"] == pytest.approx(3 * 40 * 80)
    assert beyond["volume"]["remove_beside_road"] == pytest.approx(40 * wedge(3.0, 30.0, np.tan(np.radians(30))))
    # the nearest ground of an edge without any is the top of a wall: it is no higher than the edge beside it
    x, y = centres(80, 100, 2.5)
    wall, on_it = np.where(x > 160, 8.0, 0.0), np.where(x > 160, 3.0, 0.0)
    write_run(on_it, wall, 2.5)
    whole = cleared(box(130, 20, 150, 180))["volume"]["remove"]
    write_run(on_it, np.where((x > 130) & (x < 160) & (y > 60), np.nan, wall), 2.5)
    assert whole <= cleared(box(130, 20, 150, 180))["volume"]["remove"] < 1.05 * whole     # a third of it by the wall
    write_run(thickness, base, 2.5)
    write_geojson("road.geojson", box(180, 0, 200, 200))
    status, _, err = slope("run --road road.geojson --local --mesh 10")
    assert status == 2 and "road.geojson: the road's edge must lie on ground that has a height" in err


# --- the axis ---

def test_blocked_length_and_profile(cleared):
    thickness = strip(y=(80, 120))
    x, y = centres(80, 100, 2.5)
    thickness[(y > 150) & (y < 160)] = 0.1          # not more than the threshold
    thickness[(y > 170) & (y < 175)] = 0.3
    thickness[(y > 95) & (y < 97.5) & (x > 98) & (x < 100)] = 5.0
    write_run(thickness, 12.0, 2.5)
    axis = cleared(box(91.5, 3, 106.5, 197))["axis"]
    assert axis["length"] == pytest.approx(194) and axis["source"].startswith("centre line")
    assert axis["blocked_length"] == pytest.approx(45)
    assert np.allclose(axis["blocked_stretches"], [[77, 117], [167, 172]])
    assert axis["largest_thickness"] == 5 and axis["largest_thickness_at"] == [99, 96.25]
    profile = rows_of("out/axis.csv", float)
    assert [row["from"] for row in profile[1:]] == [row["to"] for row in profile[:-1]]
    assert sum((row["to"] - row["from"]) * row["blocked"] for row in profile) == pytest.approx(45)
    assert all(row["x"] == 99 and row["ground"] == pytest.approx(12) for row in profile)
    assert profile[40]["removed"] == profile[40]["thickness"] > 0
    assert cleared(box(91.5, 3, 106.5, 197), "--mesh 10 --blocked 0.05")["axis"]["blocked_length"] == pytest.approx(55)
    # a centre line between two columns of cells: the thicker one counts
    assert cleared(box(90, 0, 110, 200))["axis"]["largest_thickness"] == 5


def test_axis_of_a_curved_road(cleared):
    write_run(np.full((80, 80), 1.0), 0.0, 2.5)
    arc = LineString([(100 + 80 * math.cos(a), 10 + 80 * math.sin(a)) for a in np.linspace(0.2, math.pi - 0.2, 60)])
    axis = cleared(arc.buffer(4, cap_style=2))["axis"]
    assert axis["source"].startswith("middles") and axis["length"] == pytest.approx(arc.length, rel=0.03)
    assert axis["blocked_length"] == axis["length"]
    Path("axis.csv").write_text("# a surveyed axis\n" + "\n".join(f"{x},{y}" for x, y in arc.coords))
    for line in ("axis.csv", write_geojson("axis.geojson", arc)):
        axis = cleared(arc.buffer(4, cap_style=2), f"--mesh 10 --axis {line}")["axis"]
        assert axis["source"] == line and axis["length"] == pytest.approx(arc.length, abs=1e-6)
    Path("axis.wkt").write_text(arc.wkt)
    assert cleared(arc.buffer(4), "--mesh 10 --axis axis.wkt")["axis"]["length"] == pytest.approx(arc.length, rel=1e-6)


# --- place ---

def to_degrees(polygon):
    lon, lat = rasterio.warp.transform(CRS_M, "EPSG:4326", *zip(*polygon.exterior.coords))
    return Polygon(zip(lon, lat))


def test_every_output_is_in_the_crs_of_the_terrain(slope, no_map):
    write_sidecar(80, 100, 2.5)
    write_run(strip(), 0.0, 2.5)
    road = translate(box(90, 0, 110, 200), EAST, NORTH)
    write_geojson("metres.geojson", road, crs=CRS_M)
    write_geojson("degrees.geojson", to_degrees(road))
    hand = 40 * (3 * 20 + 2 * wedge(3, 90, TAN30))
    for name, error in (("metres", 1e-9), ("degrees", 1e-6)):
        status, out, err = slope(f"run --road {name}.geojson --mesh 10 -o {name}")
        assert (status, err) == (0, "") and "to remove: 3" in out
        about = yaml.safe_load(Path(f"{name}/volume.yaml").read_text())
        assert about["volume"]["remove"] == pytest.approx(hand, rel=error)
        assert about["crs"] == CRS_M and about["origin"] == {"east": EAST, "north": NORTH} and about["warnings"] == []
    for name, cell, size in (("volume", 2.5, (100, 80)), ("volume_mesh", 10, (25, 20))):
        with rasterio.open(f"metres/{name}.tif") as file:
            assert file.crs.to_epsg() == 6677 and file.nodata == -9999 and (file.width, file.height) == size
            assert (file.transform @ (0, file.height)) == (EAST, NORTH) and file.res == (cell, cell)
        told = json.loads(subprocess.run(["gdalinfo", "-json", f"metres/{name}.tif"], capture_output=True, text=True,
                                         check=True).stdout)
        assert told["geoTransform"] == [EAST, cell, 0, NORTH + 200, 0, -cell]
        assert told["bands"][0]["noDataValue"] == -9999
        assert 'ID["EPSG",6677]' in told["coordinateSystem"]["wkt"]
    with fiona.open("metres/volume.geojson") as file:
        assert file.crs_wkt and rasters.CRS.from_wkt(file.crs_wkt).to_epsg() == 6677
        squares = [(shape(feature["geometry"]), feature["properties"]) for feature in file]
    assert unary_union([square for square, _ in squares]).bounds == (EAST, NORTH, EAST + 250, NORTH + 200)
    assert all(square.bounds[:2] == (where["east"], where["north"]) for square, where in squares)
    assert math.fsum(where["remove"] for _, where in squares) == pytest.approx(hand, rel=1e-9)
    row = rows_of("metres/axis.csv", float)[0]
    assert (row["east"] - row["x"], row["north"] - row["y"]) == (EAST, NORTH)


def test_a_crs_without_a_number_gives_degrees(slope, no_map):
    write_sidecar(80, 100, 2.5, crs="+proj=tmerc +lat_0=36 +lon_0=139.5 +k=0.9999 +ellps=GRS80 +units=m")
    write_run(strip(), 0.0, 2.5)
    write_geojson("road.geojson", box(90, 0, 110, 200))
    status, _, err = slope("run --road road.geojson --mesh 10 --local")
    assert (status, err) == (0, "")
    about = json.loads(Path("run.volume/volume.geojson").read_text())
    assert "crs" not in about
    (west, south), = [feature["geometry"]["coordinates"][0][0] for feature in about["features"][:1]]
    assert west == pytest.approx(139.5 + (EAST + 90) / 111320 / math.cos(math.radians(36.3)), abs=1e-3)
    assert south == pytest.approx(36 + NORTH / 110950, abs=5e-3)


def test_without_a_terrain_there_is_a_warning(slope, here):
    write_run(strip(), 0.0, 2.5)
    write_geojson("road.geojson", box(90, 0, 110, 200))
    status, _, err = slope("run --road road.geojson --mesh 10 --local")
    assert status == 0 and err == ("slope volume: warning: no --terrain and no terrain.asc: no CRS, coordinates are "
                                   "the local metres of the run\n")
    assert sorted(os.listdir("run.volume")) == sorted(volume.FILES)
    (here / "elsewhere").mkdir()
    write_sidecar(80, 100, 2.5, "elsewhere/dem.asc")
    write_geojson("road.geojson", translate(box(90, 0, 110, 200), EAST, NORTH), crs=CRS_M)
    status, _, err = slope("run --road road.geojson --mesh 10 --terrain elsewhere/dem.asc")
    assert (status, err) == (0, "")


def test_the_folder_may_be_this_one_or_another_with_files(cleared, succeed, here):
    write_run(strip(), 0.0, 2.5)
    cleared(box(90, 0, 110, 200))
    (here / "out" / "mine.txt").touch()
    for folder in (".", "out", "out/../new"):
        succeed(f"run --road road.geojson --mesh 10 --local -o {folder}")
    assert len(os.listdir("new")) == 9 and len(os.listdir("out")) == 10 and (here / "volume.yaml").exists()
    assert not list(here.rglob(".*"))


def test_the_last_cells_of_the_run_may_reach_beyond_the_terrain(slope, no_map):
    """Cells of 3 m on a terrain of 250 m x 200 m, from the south-west on; not one cell more."""
    write_sidecar(80, 100, 2.5)
    write_geojson("road.geojson", translate(box(90, 10, 110, 190), EAST, NORTH), crs=CRS_M)
    for rows, columns, status in ((67, 84, 0), (68, 84, 2), (67, 85, 2)):
        write_run(np.ones((rows, columns)), 0.0, 3.0)
        assert slope("run --road road.geojson --mesh 10")[0] == status
    write_run(np.ones((66, 83)), 0.0, 3.0, xlo=-1.0)
    assert "terrain.asc: must be the terrain of the run" in slope("run --road road.geojson --mesh 10")[2]


def test_part_of_the_road_outside_is_cut_off_with_a_warning(cleared):
    write_run(strip(), 0.0, 2.5)
    about = cleared(box(90, -200, 110, 200), "--mesh 10 --road-from 2")
    assert [(one["from"], one["to"]) for one in about["stretches"]] == [(2280, 2320)]
    assert about["axis"]["length"] == 200 and about["clearing"]["road_width"] == 20
    assert about["road_area"] == pytest.approx(20 * 200)
    assert warned(about)["cut off"]["percent"] == pytest.approx(50)
    assert about["volume"]["remove"] == pytest.approx(40 * (3 * 20 + 2 * wedge(3, 90, TAN30)), rel=1e-9)


@pytest.mark.parametrize("angle, asked", [("0.577", True), ("2.9", True), ("3", False)])
def test_a_cut_angle_that_looks_like_a_tangent_is_asked_about(slope, angle, asked):
    write_run(strip(), 7.0, 2.5)
    write_geojson("road.geojson", box(91.3, 0, 108.9, 200))
    status, _, err = slope(f"run --road road.geojson --mesh 10 --local --no-picture --cut-angle {angle} -o removal")
    assert status == 0 and (f"--cut-angle {angle}: is it in degrees? A coefficient of {angle} is" in err) == asked


# --- bad input ---

@pytest.mark.parametrize("arguments, message", [
    ("run --road road.geojson --mesh 10 --cut-angle 0", "--cut-angle: must be > 0 and < 90 degrees, got 0"),
    ("run --road road.geojson --mesh 10 --cut-angle 90", "--cut-angle: must be > 0 and < 90 degrees, got 90"),
    ("run --road road.geojson --mesh 0", "--mesh: must be > 0, got 0"),
    ("run --road road.geojson --mesh 0.01", "--mesh: must give at most 4000000 mesh cells"),
    ("run --road road.geojson --mesh 10 --bulk 0.5", "--bulk: must be 1 to 10, as of fix deposit/grid, got 0.5"),
    ("run --road road.geojson --mesh 10 --blocked -1", "--blocked: must be >= 0, got -1"),
    ("run --road road.geojson --mesh 10 --samples 3", "--samples: must be even, 2 to 32, got 3"),
    ("none --road road.geojson --mesh 10", "none.thickness.asc: must be an existing file; none must be the output of"),
    ("run --road road.geojson --mesh 10 --terrain none.asc", "none.asc: must be an existing file"),
    ("run --road road.geojson --mesh 10 --terrain other.asc", "other.asc: must be the terrain of the run, whose grid"),
    ("run --road road.geojson --mesh 10 --terrain moved.asc", "moved.asc: must lie where the run's terrain.asc does"),
    ("run --road road.geojson --mesh 10 --axis run.summary.yaml", "run.summary.yaml: must be lines that GDAL can read"),
    ("run --road road.geojson --mesh 10 --axis away.csv", "away.csv: axis of the road must lie in the grid"),
    ("run --road road.geojson --mesh 10 --axis bad.csv", "bad.csv: must be a line"),
    ("run --road road.geojson --mesh 10 -o road.geojson", "-o: must be a folder, got road.geojson"),
])
def test_bad_input_is_one_line(slope, no_map, here, arguments, message):
    write_sidecar(80, 100, 2.5)
    write_sidecar(10, 10, 2.5, "other.asc")
    write_sidecar(80, 100, 2.5, "moved.asc")
    about = Path("moved.yaml").read_text()
    Path("moved.yaml").write_text(about.replace(f"{EAST}", f"{EAST + 500}"))
    assert Path("moved.yaml").read_text() != about
    write_run(strip(), 0.0, 2.5)
    write_geojson("road.geojson", translate(box(90, 0, 110, 200), EAST, NORTH), crs=CRS_M)
    (here / "away.csv").write_text("0,0\n5,5\n")
    (here / "bad.csv").write_text("0,0\nfive,5\n")
    before = sorted(here.rglob("*"))
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1 and "Traceback" not in err
    assert err.startswith("slope volume: ") and message in err
    assert sorted(here.rglob("*")) == before


@pytest.mark.parametrize("name, change, message", [
    ("run.summary.yaml", lambda text: "balls: [", "run.summary.yaml: must be a summary that fix deposit/grid wrote"),
    ("run.summary.yaml", lambda text: text.replace("bulk_factor", "factor"), "must be a summary that fix deposit/grid"),
    ("run.summary.yaml", lambda text: re.sub("on_grid: .*", "on_grid: 29999.0", text),
     "run.thickness.asc: must hold the volume of run.summary.yaml, 29999 m3: are they of one run?, got 30000"),
    ("run.thickness.asc", lambda text: text[:2000], "run.thickness.asc: values: must be 80 rows of 100"),
    ("run.thickness.asc", lambda text: text.replace("3.0", "-3.0", 1), "must be a thickness >= 0, got -3"),
    ("run.surface.asc", lambda text: text.replace("cellsize 2.5", "cellsize 2.6"),
     "run.surface.asc: must have the grid of run.thickness.asc"),
    ("terrain.yaml", lambda text: "crs: 5", "terrain.yaml: must be a sidecar that `slope terrain` wrote"),
])
def test_broken_files_of_a_run(slope, no_map, name, change, message):
    write_sidecar(80, 100, 2.5)
    write_run(strip(), 0.0, 2.5)
    write_geojson("road.geojson", box(90, 0, 110, 200))
    Path(name).write_text(change(Path(name).read_text()))
    status, out, err = slope("run --road road.geojson --mesh 10 --local")
    assert (status, out) == (2, "") and err.count("\n") == 1 and message in err
    assert not Path("run.volume").exists()


def test_a_run_that_still_moved_or_lost_mass_is_warned_of(cleared, slope):
    write_run(strip(), 0.0, 2.5, moving=True, volume={"released": 30100.0, "on_grid": 30000.0, "off_grid": 60.0,
                                                      "lost": 40.0})
    about = cleared(box(90, 0, 110, 200))
    assert warned(about)["moves"]["seconds"] == 12.5 and warned(about)["not counted"]["volume"] == pytest.approx(100)
    assert slope("run --road road.geojson --local --mesh 10")[2].count("slope volume: warning: ") == 3


def write_site(road):
    """The folder of a site with a study of two runs; the second one governs, and has twice the thickness."""
    for run, thickness in (("one", 3.0), ("two", 6.0)):
        Path("mine/study", run).mkdir(parents=True)
        write_sidecar(80, 100, 2.5, f"mine/study/{run}/terrain.asc")
        write_run(strip(thickness=thickness), 0.0, 2.5, f"mine/study/{run}/site")
    made_study.write(Path("mine/study"), [made_rows.row(run=name, summary=f"{name}/site.summary.yaml", remove_m3=1.0)
                                          for name in ("one", "two")],
                     conservative=made_study.conservative(1.0, run="two"))
    Path("mine/road.csv").write_text("".join(f"{x},{y}\n" for x, y in road.exterior.coords[:-1]))


def test_a_folder_stands_for_the_run_that_export_takes(slope, no_map):
    write_site(box(90, 0, 110, 200))
    removed = {}
    for name, folder in (("mine", "mine/volume"), ("mine/study", "mine/study/volume"),
                         ("mine/study/one", "mine/study/one/volume"),
                         ("mine/study/two/site.thickness.asc", "mine/study/two/site.volume")):
        status, out, err = slope(f"{name} --road mine/road.csv --local --mesh 10")
        assert status == 0 and f"written to {folder}: " in out, err
        assert ("two, the governing run of mine/study: mine/study/two/site" in out) == (name in ("mine", "mine/study"))
        removed[name] = yaml.safe_load(Path(folder, "volume.yaml").read_text())["volume"]["remove"]
    assert removed["mine"] == removed["mine/study"] == removed["mine/study/two/site.thickness.asc"]
    assert removed["mine"] > 1.5 * removed["mine/study/one"] > 0
    status, _, err = slope("mine/study/three --road mine/road.csv --local --mesh 10")
    assert status == 2 and err.count("\n") == 1


# --- the page ---

@pytest.mark.parametrize("command", examples("volume"))
def test_every_example_of_the_page_and_the_help_runs(slope, no_map, command):
    write_sidecar(80, 100, 2.5)
    write_sidecar(80, 100, 2.5, "dem.asc")
    write_run(strip(), 0.0, 2.5, "embankment")
    road = box(90, 0, 110, 200)
    write_geojson("route4.geojson", translate(road, EAST, NORTH), crs=CRS_M)
    Path("road.csv").write_text("".join(f"{x},{y}\n" for x, y in road.exterior.coords[:-1]))
    for name in ("centre", "axis"):
        write_geojson(f"{name}.geojson", translate(LineString([(100, 0), (100, 200)]), EAST, NORTH), crs=CRS_M)
    write_site(road)
    status, out, err = slope(command)
    assert (status, err) == (0, "")
    assert "--help" in command or "to remove: " in out
