"""How far a run's mass went along its fall path: deposits made by hand, with gaps and lobes, and their lengths."""
import math

import numpy as np
import pytest
import rasterio
from affine import Affine
from scipy.ndimage import map_coordinates
from shapely.geometry import LineString, Polygon, box

from run_helpers import write_asc, write_run
from test_mobility_path import STEEP

from slope_tools.deposits import deposit as deposits
from slope_tools.deposits.deposit import Deposit
from slope_tools.mobility import body, fall_path, offices, run_length
from slope_tools.report import run_part
from slope_tools.report.numbers import UNKNOWN, Numbers
from slope_tools.survey.rasters import Raster

CELL, ROWS, COLUMNS = 10.0, 60, 200
MASS = 1e5                      # m3, released
X, Y = np.meshgrid(CELL * (np.arange(COLUMNS) + 0.5), CELL * (ROWS - 0.5 - np.arange(ROWS)))
TOP = 105.0, 305.0


def deposit(*blocks):
    """Of blocks: x and y of the middles of the first and the last cell (m), volume (m3); the ground falls along x."""
    z = np.zeros((ROWS, COLUMNS))
    for x0, x1, y0, y1, volume in blocks:
        cells = (X >= x0) & (X <= x1) & (Y >= y0) & (Y <= y1)
        z[cells] = volume / cells.sum() / CELL ** 2
    top = 1000 - STEEP * TOP[0]
    return Deposit("run", Raster(z, Affine(CELL, 0, 0, 0, -CELL, ROWS * CELL), None), 1000 - STEEP * X,
                   {"volume": {"released": MASS}, "travel": {"top": [*TOP, top]}}, None)


def path(*corners):
    """A path along corners (m), from the first one; a point every 9 m."""
    line = LineString(corners)
    length = np.linspace(0, line.length, int(line.length / 9))
    x, y = np.array([line.interpolate(one).coords[0] for one in length]).T
    return fall_path.FallPath(x, y, length, STEEP * x, fall_path.TERRAIN, (*TOP, 1000.0))


STRAIGHT = TOP, (1995.0, 305.0)
BEND = TOP, (905.0, 305.0), (905.0, 5.0), (1995.0, 5.0)
BULK = (205.0, 605.0, 285.0, 325.0)     # ends 500 m from the top
TWELVE = {
    "one part": ([(*BULK, 9e4)], STRAIGHT, 500, 1),
    "a lobe of 1.2 % beyond a gap": ([(*BULK, 9e4), (805, 855, 305, 315, 1200)], STRAIGHT, 750, 2),
    "a lobe of 0.9 % is none": ([(*BULK, 9e4), (805, 855, 305, 315, 900)], STRAIGHT, 500, 1),
    "of 1 % of what was released, not of what lies here": ([(*BULK, 5e4), (805, 855, 305, 315, 900)], STRAIGHT, 500, 1),
    "just 1 %": ([(*BULK, 9e4), (805, 855, 305, 315, 1000.01)], STRAIGHT, 750, 2),
    "several gaps": ([(*BULK, 6e4), (755, 805, 305, 315, 2e3), (905, 955, 305, 315, 2e3)], STRAIGHT, 850, 3),
    "the farthest one is too small": (
        [(*BULK, 6e4), (755, 805, 305, 315, 2e3), (905, 955, 305, 315, 400)], STRAIGHT, 700, 2),
    "the larger part is not the farther one": ([(905, 955, 305, 315, 3e3), (*BULK, 6e4)], STRAIGHT, 850, 2),
    "cells that touch at a corner are one lobe": (
        [(*BULK, 9e4), (805, 805, 305, 305, 600), (815, 815, 315, 315, 600)], STRAIGHT, 710, 2),
    "thin ground is a gap": ([(*BULK, 9e4), (615, 795, 305, 305, 171), (805, 855, 305, 315, 1200)], STRAIGHT, 750, 2),
    "a bend": ([(205, 895, 305, 305, 9e4), (905, 905, 105, 155, 1200)], BEND, 1000, 2),
    "no lobe of 1 %: the largest": ([(205, 215, 305, 305, 500), (805, 805, 305, 305, 400)], STRAIGHT, 110, 1)}


@pytest.mark.parametrize("name", TWELVE)
def test_twelve_runs(name):
    blocks, way, length, lobes = TWELVE[name]
    found = run_length.of_deposit(deposit(*blocks), path(*way))
    assert found.distance == pytest.approx(length, abs=0.6)        # cells may be half a metre beside the path
    assert found.lobes == lobes and found.on_path
    assert found.angle == pytest.approx(math.degrees(math.atan2(
        STEEP * (found.tip[0] - TOP[0]) - thickness_at(blocks, found.tip), found.distance)))


def thickness_at(blocks, place):
    one = deposit(*blocks)
    column, row = ~one.raster.transform @ place
    return one.raster.z[int(row), int(column)]


def test_what_0_5_and_2_percent_change():
    """The length by the least lobe; page and table take 1 %."""
    one = deposit((*BULK, 8e4), (705, 755, 305, 315, 2500), (805, 855, 305, 315, 1500), (905, 955, 305, 315, 700))
    lengths = [run_length.of_deposit(one, path(*STRAIGHT), least).distance for least in (0.005, 0.01, 0.02)]
    assert lengths == pytest.approx([850, 750, 650], abs=0.6) and run_length.LEAST == 0.01


def test_along_a_bend_and_straight():
    """Along the path where it bends; at least the straight line, where the mass goes on and the path turns aside."""
    one = deposit((205, 895, 305, 305, 9e4), (905, 905, 105, 155, 1200))
    found = run_length.of_deposit(one, path(*BEND))
    assert found.tip == (905.0, 105.0) and found.straight == pytest.approx(math.hypot(800, 200))
    across = run_length.of_deposit(deposit((205, 1305, 305, 305, 9e4)), path(*BEND[:3]))
    assert across.distance == pytest.approx(1200) == across.straight
    places = np.array([[505.0, 405.0], [905.0, 205.0], [1305.0, 0.0], [0.0, 305.0], [3000.0, 5.0]])
    assert run_length.measure_along_path(path(*BEND[:3]), np.array([[1305.0, 305.0]])) == pytest.approx([800], abs=0.5)
    assert run_length.measure_along_path(path(*BEND), places) == pytest.approx([400, 900, 1500, 0, 2190], abs=0.5)


def test_without_a_path_it_is_straight():
    found = run_length.of_deposit(deposit((*BULK, 9e4)), None)
    assert found.distance == pytest.approx(math.hypot(500, 20), abs=1e-3) and not found.on_path
    assert run_length.of_deposit(deposit((205, 305, 305, 305, 50.0)), None) is None       # nowhere thicker than 0.1 m


def test_of_a_run(here):
    """The path of its own body, from its terrain: a valley that bends; read once for all runs of a body."""
    rows, columns = 120, 120
    x, y = np.meshgrid(CELL * (np.arange(columns) + 0.5), CELL * (rows - 0.5 - np.arange(rows)))
    # down along x to 600, then along y: the valley floor is where the two meet
    ground = 1000 - 0.4 * np.minimum(x, 600) + 0.4 * np.maximum(x - 600, 0) - 0.1 * y * (x > 400)
    body = 10 * np.clip(1 - ((x - 200) ** 2 + (y - 200) ** 2) / 100 ** 2, 0, 1)
    thickness = np.zeros((rows, columns))
    thickness[(np.abs(x - 605) < 20) & (y > 700) & (y < 900)] = 5.0
    write_run(thickness, ground - body, CELL, travel={"top": [105.0, 205.0, 958.0]})
    write_asc("terrain.asc", ground, CELL)
    run_length._path.cache_clear()
    found = [run_length.measure_run_length(deposits.read_deposit("run", None, lambda text: None), here / "terrain.asc")
             for _ in range(2)]
    assert run_length._path.cache_info()[:2] == (1, 1)
    assert found[0].on_path and found[0].distance == found[1].distance
    assert found[0].distance > 1.12 * found[0].straight and found[0].others == (found[0].distance,) * 2
    assert not run_length.measure_run_length(deposits.read_deposit("run", None, lambda text: None), None).on_path


# --- what offices ask for ---

def test_shares_of_the_volume_over_the_height_by_hand():
    """41 columns of cells of one thickness, 100 to 500 m from the crown; a body whose toe is 50 m below it."""
    found = offices.measure_office_distances(deposit((*BULK, 9e4)), path(*STRAIGHT))
    assert found == pytest.approx([300, 460, 500], abs=1)
    slope = offices.Slope(50.0, 120.0)
    assert slope.zone == 50 and slope._replace(height=20.0).zone == 40
    numbers = Numbers()
    table = run_part.over_height(slope, [300.0, 460.0, 500.0], numbers)
    assert [row[1:] for row in table.rows] == [["300", "6.00", "180", "3.60"], ["460", "9.20", "340", "6.80"],
                                               ["500", "10.0", "380", "7.60"]]
    assert {what: value for what, _, _, _, value in numbers.rows}["90 % of the volume: from the toe over height"] == 6.8


def test_height_and_toe_are_those_of_the_body_on_its_path():
    ground = 1000 - STEEP * X
    mass = body.of_arrays(Raster(ground, Affine(CELL, 0, 0, 0, -CELL, ROWS * CELL), None),
                          np.where((X < 200) & (X > 100) & (abs(Y - 305) < 30), 4.0, 0.0), "a")
    way = path(*STRAIGHT)
    found = offices.slope(mass, way)
    assert found.toe == pytest.approx(195 - 105, abs=10)
    assert found.height == pytest.approx(STEEP * (found.toe + 105), rel=0.05)


def test_pressures_at_the_edge_of_a_road():
    """The largest of the cells that its outline crosses, not of those inside: 3 m at 8 m/s, 1,800 kg/m3."""
    raster = deposit().raster
    thick, speed = (np.where(X < 510, *values) for values in ((3.0, 1.0), (8.0, 2.0)))
    thick[(X > 530) & (X < 570) & (Y > 150) & (Y < 450)] = 9.0      # inside
    edge = offices.at_edge(box(502, 100, 598, 500), raster, thick, speed)
    assert edge == (3.0, 8.0)
    numbers = Numbers()
    [row] = run_part.at_edge(edge, 1800.0, numbers).rows
    assert row == ["3.00", "8.00", "115", "53.0"]
    assert [value for *_, value in numbers.rows[2:]] == pytest.approx([1.8 * 64, 1.8 * 9.80665 * 3])
    assert run_part.at_edge(edge, None, Numbers()).rows[0][2:] == [UNKNOWN, UNKNOWN]


def by_hand(road, density):
    """The table for offices from the written rasters alone, on ground whose fall line is straight."""
    rasters = {}
    for name in ("terrain", "run.surface", "run.thickness", "run.max_thickness", "run.max_speed"):
        with rasterio.open(f"{name}.asc") as source:
            rasters[name], at = source.read(1).astype(float), source.transform
    ground, _, thickness, largest, speed = rasters.values()
    rows, columns = np.indices(ground.shape)
    x, y = at @ (columns + 0.5, rows + 0.5)
    depth = np.maximum(ground - (rasters["run.surface"] - thickness), 0)
    body_ = depth > 0.01
    crown = np.argmax(np.where(body_, ground, 0))
    plane = np.column_stack([x[body_], y[body_], np.ones(body_.sum())])
    down = -np.linalg.lstsq(plane, ground[body_], rcond=None)[0][:2]
    down /= np.hypot(*down)
    centre = np.array([np.average(one[body_], weights=depth[body_]) for one in (x, y)])
    begin = centre - ((centre - [x.flat[crown], y.flat[crown]]) @ down) * down
    along = np.arange(0, 1500, 0.1)
    places = np.array(~at @ (begin[:, None] + along * down[:, None])) - 0.5
    toe = along[map_coordinates(depth, places[::-1], order=1) > 0.01 * depth.max()].max()
    height = ground.flat[crown] - map_coordinates(ground, places[::-1, along == toe], order=1)[0]
    far = np.hypot(x - begin[0], y - begin[1])[thickness > 0]
    order = np.argsort(far)
    held = np.cumsum(thickness[thickness > 0][order])
    found = {"height of the slope": height, "2 H": 2 * height, "2 H, at most 50 m": min(2 * height, 50)}
    for share in (50, 90, 99):
        reach = far[order][np.searchsorted(held, share / 100 * held[-1])]
        for name, value in (("reach", reach), ("from the toe", reach - toe)):
            found[f"{share} % of the volume: {name}"] = value
            found[f"{share} % of the volume: {name} over height"] = value / height
    edge = np.array([[road.exterior.intersects(box(*at @ (column, row + 1), *at @ (column + 1, row)))
                      for column in range(ground.shape[1])] for row in range(ground.shape[0])])
    deep, fast = largest[edge].max(), speed[edge].max()
    return {**found, "depth at the road's edge": deep, "speed at the road's edge": fast,
            "pressure of movement, rho v^2": density * fast ** 2 / 1e3,
            "pressure of the deposit, rho g h": density * 9.80665 * deep / 1e3}


def test_the_table_for_offices_is_found_by_hand_from_the_rasters(here):
    """Within 1 %, on a slope that falls obliquely to the grid; the toe lies between two points of the path."""
    x, y = np.meshgrid(CELL * (np.arange(100) + 0.5), CELL * (ROWS - 0.5 - np.arange(ROWS)))
    ground = 600 - 0.5 * x - 0.15 * y
    away = (x - 200) * 0.958 + (y - 250) * 0.287, (y - 250) * 0.958 - (x - 200) * 0.287
    depth = 12 * np.clip(1 - (away[0] / 80) ** 2 - (away[1] / 60) ** 2, 0, None)
    thickness = 5 * np.exp(-((away[0] - 350) / 120) ** 2 - (away[1] / 50) ** 2)
    thickness[thickness < 0.02] = 0
    write_asc("terrain.asc", ground, CELL)
    write_run(thickness, ground - depth, CELL, travel={"top": [125.0, 225.0, 520.0]})
    write_asc("run.max_thickness.asc", thickness * (1 + x / 2000), CELL)
    write_asc("run.max_speed.asc", np.where(thickness > 0, 20 - 0.02 * x, 0), CELL)
    road = Polygon([(480, 5), (520, 5), (560, 595), (520, 595)])
    run = deposits.read_deposit("run", None, lambda text: None)
    before, slip = body.find_ground_before(run.raster, run.base, here / "terrain.asc")
    mass, way = body.of_arrays(run.raster._replace(z=before), slip, "a"), run_length.path_of(run, here / "terrain.asc")
    numbers = Numbers()
    run_part.over_height(offices.slope(mass, way), offices.measure_office_distances(run, way), numbers)
    most = [rasters_of(f"run.max_{name}.asc") for name in ("thickness", "speed")]
    run_part.at_edge(offices.at_edge(road, run.raster, *most), 1786.0, numbers)
    ours, hand = {what: value for what, *_, value in numbers.rows}, by_hand(road, 1786.0)
    assert ours.keys() == hand.keys()
    assert {name: ours[name] / value for name, value in hand.items()} == pytest.approx(dict.fromkeys(hand, 1), rel=0.01)


def rasters_of(path):
    with rasterio.open(path) as source:
        return source.read(1)
