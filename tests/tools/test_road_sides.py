"""What lies before a road, on it and beyond it: roads of all shapes, balls that left, dumps, a table that is none."""
import math

import numpy as np
import pytest
from affine import Affine
from shapely.geometry import LineString, MultiPolygon, Point, box
from shapely.ops import unary_union

from slope_tools import geometry
from slope_tools.deposits import gone, passed, road_sides
from slope_tools.deposits.gone import Gone, Ground
from slope_tools.errors import SlopeError
from slope_tools.survey.rasters import Raster

ROWS, COLUMNS, CELL = 60, 80, 10.0      # 800 m to the east, 600 to the north
RASTER = Raster(np.zeros((ROWS, COLUMNS)), Affine(CELL, 0, 0, 0, -CELL, ROWS * CELL), None)
RELEASED = np.zeros((ROWS, COLUMNS), bool)
RELEASED[25:35, 8:14] = True            # x 80 to 140, y 250 to 350


def strip(*points, width=12.0):
    return LineString(points).buffer(width / 2, cap_style=2)


def ring(x, y, radius):
    return Point(x, y).buffer(radius).difference(Point(x, y).buffer(radius - 12))


BENT = (420, 150), (400, 300), (430, 480)
AROUND = (60, 420), (300, 430), (330, 300), (300, 180), (60, 190)

# road, and places before it, on it, beyond it across the road, beyond it past an end or through a gap, and of those
# before or beyond, where another road lies ahead
ROADS = {
    "divides": (box(400, 0, 412, 600), [(399, 5), (5, 595)], [(405, 300)], [(414, 5), (795, 595)], []),
    "ends inside": (strip(*BENT), [(395, 140), (300, 590)], [(403, 300)], [(500, 300), (780, 400)],
                    [(460, 20), (460, 590), (600, 20)]),
    "has a gap": (MultiPolygon([box(400, 0, 412, 220), box(408, 300, 420, 600)]), [(395, 260), (300, 10)],
                  [(410, 310)], [(700, 100), (700, 500)], [(430, 260), (790, 250)]),
    "has a gap and ends inside": (
        unary_union([strip((380, 120), (400, 250)), strip((405, 330), (390, 500))]), [(350, 50), (370, 290)],
        [(390, 190)], [(600, 180)], [(790, 290), (500, 20)]),
    "a ring below": (ring(450, 300, 120), [(300, 300), (440, 590)], [(450, 414)], [(450, 300), (600, 300)],
                     [(460, 590), (790, 20)]),
    "a ring around": (ring(150, 300, 140), [(50, 300), (240, 300)], [(150, 434)], [(5, 5), (795, 595), (300, 300)], []),
    "two roads": (MultiPolygon([box(300, 50, 312, 520), box(550, 0, 562, 450)]), [(290, 10), (100, 500)],
                  [(306, 300), (555, 10)], [(400, 300), (700, 200), (700, 590)], [(320, 10), (320, 590)]),
    "at the edge": (box(788, 0, 800, 600), [(780, 300)], [(800, 300), (795, 0)], [], []),
    "a part of the edge": (box(780, 200, 800, 350), [(770, 100), (700, 590)], [(800, 300)], [],
                           [(799, 20), (799, 590)]),
    "a plant": (box(500, 280, 560, 340), [(480, 310), (400, 10)], [(530, 300)], [(600, 315)], [(700, 20), (700, 580)]),
    "around the mass": (strip(*AROUND), [(5, 300), (310, 300)], [(200, 425)], [(500, 300)], [(10, 450), (10, 150)]),
    "with a roundabout": (
        unary_union([strip((400, 100), (400, 300)), strip((400, 340), (400, 520)), ring(400, 320, 26)]),
        [(370, 320), (390, 20)], [(400, 200)], [(450, 320), (400, 320)], [(420, 590)]),
    "crossing": (unary_union([strip((300, 50), (600, 550)), strip((300, 550), (600, 50))]), [(300, 300), (100, 20)],
                 [(450, 300)], [(700, 300), (450, 500), (790, 590)], [(320, 590)])}


def sides_of(road, line=None):
    return road_sides.divide(geometry.as_multi(road), line, RASTER, RELEASED)


@pytest.mark.parametrize("name", ROADS)
def test_the_terrain_is_divided(name):
    road, before, on, across, around = ROADS[name]
    sides = sides_of(road)
    for places, part in ((before, "before"), (on, "on"), ([*across, *around], "past")):
        if places:
            assert sides.of_places(np.array(places, float)).tolist() == [part] * len(places), places
    assert sides.before.area + sides.road.area + sides.past.area == pytest.approx(800 * 600, rel=1e-12)
    assert [sides.straight.intersects(Point(place)) for place in [*across, *around]] == \
        [True] * len(across) + [False] * len(around)


def test_of_several_roads_the_last_one_counts():
    """What left between two roads has another one ahead; on the other side of a ridge it has not."""
    ahead = sides_of(ROADS["two roads"][0]).ahead
    assert [ahead.intersects(Point(x, 300)) for x in (100, 400, 700)] == [True, True, False]
    ahead = sides_of(MultiPolygon([box(40, 100, 52, 520), box(550, 0, 562, 450)])).ahead
    assert [ahead.intersects(Point(x, 300)) for x in (10, 100, 700)] == [False, True, False]


def test_a_line_is_prolonged_in_its_own_direction():
    line = LineString(BENT)
    sides = sides_of(line.buffer(6, cap_style=2), line)
    (barrier,) = sides.barriers
    ends = sorted(np.degrees(np.arctan2(*np.subtract(*np.array(one.coords)[::-1])[::-1])) for one in barrier.lines)
    assert ends == pytest.approx([-math.degrees(math.atan2(150, 20)), math.degrees(math.atan2(180, 30))], abs=1)
    closed = LineString([(300, 200), (500, 200), (500, 400), (300, 400), (300, 200)])
    assert sides_of(closed.buffer(6), closed).of_places(np.array([[400, 300], [790, 300.0], [290, 590]])).tolist() == [
        "past", "past", "before"]


def test_a_road_on_all_of_the_mass_has_nothing_before_it():
    assert sides_of(box(60, 200, 200, 400)).before.area == 0


# --- the mass ---

def ground_of(thickness, known=None, lost=0.0, speed=20.0):
    volume = float(thickness.sum()) * CELL ** 2
    known = np.ones(thickness.shape, bool) if known is None else known
    summary = {"volume": {"released": volume + lost, "off_grid": lost, "lost": 0.0}, "travel": {"reach_angle": 20.0}}
    return Ground(RASTER._replace(z=thickness), np.where(known, 0.0, np.nan), RELEASED,
                  np.full(thickness.shape, speed), summary)


def balls(*rows, volume=2.0, within=0.0):
    """Of place x, y and start x, y."""
    table = np.array(rows, float).reshape(-1, 4)
    return Gone(np.full(len(table), volume), table[:, :2], table[:, 2:], np.full(len(table), within), "table")


@pytest.mark.parametrize("name", ROADS)
def test_before_on_and_past_are_what_was_released(name):
    rng = np.random.default_rng(2)
    thickness = rng.exponential(0.3, (ROWS, COLUMNS)) * (rng.random((ROWS, COLUMNS)) < 0.4)
    known = np.ones((ROWS, COLUMNS), bool)
    known[:4, :30] = known[40:45, 60:62] = False
    left = balls(*((x, y, 100 + x / 20, 300) for x, y in rng.random((40, 2)) * [800, 600]))
    about = passed.of_mass(ground_of(thickness, known, lost=75.0), sides_of(ROADS[name][0]), left)
    released = thickness.sum() * CELL ** 2 + 75
    divided = about["divided"]
    assert sum(divided[key] for key in ("before", "on", "past")) == pytest.approx(released, rel=1e-9)
    assert about["left"]["before"] + about["left"]["on"] + about["left"]["past"] == pytest.approx(80.0, rel=1e-12)
    assert 0 <= divided["past_end"] <= divided["past"] and divided["unknown"] == 0
    unknown = passed.of_mass(ground_of(thickness, known, lost=75.0), sides_of(ROADS[name][0]), None)
    assert unknown["left"] is None
    assert sum(unknown["divided"][key] for key in ("before", "on", "past", "unknown")) == pytest.approx(released,
                                                                                                        rel=1e-9)


def test_a_second_body_comes_from_beyond_the_road():
    """What left of it before it came there had the road ahead, as what left of the larger one had on its side."""
    released = RELEASED.copy()
    released[28:32, 70:74] = True       # x 700 to 740, y 280 to 320
    sides = road_sides.divide(geometry.as_multi(box(400, 0, 412, 600)), None, RASTER, released)
    starts = {"larger": (100, 300), "smaller": (720, 300)}
    for name, place, part, ahead in (
            ("larger", (300, 0), "before", True), ("larger", (500, 0), "past", False),
            ("smaller", (600, 0), "before", True), ("smaller", (300, 0), "past", False),
            ("smaller", (800, 300), "before", False), ("larger", (406, 0), "on", True),
            ("smaller", (406, 0), "on", True)):
        about = passed.of_mass(ground_of(np.zeros((ROWS, COLUMNS)), lost=2.0), sides, balls((*place, *starts[name])))
        told = about["left"]
        assert [told[one] for one in passed.PARTS] == [2.0 * (one == part) for one in passed.PARTS], (name, place)
        assert told["road_ahead"] == 2.0 * ahead, (name, place)


def test_the_numbers_of_a_road_that_ends_inside():
    """Ten cells before it, one on it, two across it, three near its foot, seen past its end; balls left everywhere."""
    thickness = np.zeros((ROWS, COLUMNS))
    thickness[30, 10:20] = 1.0
    thickness[30, 60:62] = 2.0
    thickness[59, 70:73] = 0.5
    thickness[58, 40] = 1.0
    road = box(400, 0, 410, 100)        # prolonged to the north
    left = balls((200, 600, 100, 300), (405, 0, 100, 300), (800, 5, 350, 5), (800, 500, 100, 300), volume=7.0)
    about = passed.of_mass(ground_of(thickness, lost=28.0), sides_of(road), left)
    assert about["divided"] == pytest.approx({"before": 1007.0, "on": 107.0, "past": 564.0, "past_end": 557.0,
                                              "unknown": 0.0})
    one = about["left"]
    assert [one[key] for key in ("volume", "balls", "before", "on", "past", "past_end", "road_ahead")] == pytest.approx(
        [28.0, 4, 7.0, 7.0, 14.0, 7.0, 14.0])
    entries = {(each["side"], each["where"]): each for each in one["sides"]}
    assert set(entries) == {("north", "before"), ("south", "on"), ("east", "past"), ("east", "past its end")}
    assert entries["north", "before"]["distance"] == pytest.approx(math.hypot(200, 500))
    assert entries["east", "past"]["distance"] == 390
    far = 20 ** 2 / (2 * 9.80665 * math.tan(math.radians(20)))
    assert {each["add"] for each in one["sides"]} == {10 * math.ceil(far / 10)}


@pytest.mark.parametrize("lost, thick, volume, lower, where", [
    (405, 0.0, 7.0, 0.0, "on"),
    # as thick as on the road, 1 m at 30 degrees is cut 1.7 m beyond it
    (411, 1.0, 1.0, 0.0, "close to it"), (412, 1.0, 1.0, 0.0, "past"), (411, 1.0, 1.0, 9.0, "close to it"),
    # heaped where it left, 1,000 m3 are a cone of 11.8 m radius, 6.8 m high
    (421, 0.0, 1000.0, 0.0, "close to it"), (422, 0.0, 1000.0, 0.0, "past"), (411, 0.0, 1000.0, 7.0, "past"),
    (440, 0.0, 1.0, np.nan, "close to it"),     # a road without ground
    (414, 0.0, 1000.0, 4.0, "close to it"), (415, 0.0, 1000.0, 4.0, "past"), (440, 0.0, 1000.0, -11.0, "close to it")])
def test_what_leaves_on_the_road_or_close_to_it_might_have_stayed_there(lost, thick, volume, lower, where):
    thickness, rise = np.zeros((ROWS, COLUMNS)), math.tan(math.radians(30))
    thickness[30, 40] = thick
    ground = ground_of(thickness, lost=volume)
    ground.base[:, 41:] = -np.nan_to_num(lower)     # beyond the road
    ground.base[:, 40] += 0 * lower
    about = passed.of_mass(ground, sides_of(box(400, 0, 410, 600)),
                           balls((lost, 600, 100, 300), volume=volume), rise)["left"]
    assert about["road_ahead"] == (0.0 if where == "past" else volume)
    assert [one["where"] for one in about["sides"]] == [where]


@pytest.mark.parametrize("north, where", [(400, "close to it"), (200, "past")])
def test_the_road_beside_a_heap_counts_and_not_its_lowest_end(north, where):
    """It falls by 10 % to the north; the ground beyond it is level, and 1,000 m3 are 6.8 m high."""
    ground = ground_of(np.zeros((ROWS, COLUMNS)), lost=1000.0)
    ground.base[:, :41] = (40 - 0.1 * RASTER.transform.a * (ROWS - np.arange(ROWS)))[:, None]
    left = balls((414, north, 100, 300), volume=1000.0)
    about = passed.of_mass(ground, sides_of(box(400, 0, 410, 600)), left, math.tan(math.radians(30)))["left"]
    assert [one["where"] for one in about["sides"]] == [where]


def test_what_areas_and_sums_round_off_is_no_mass():
    """Where nothing lies, exactly nothing does; what is there counts, however little."""
    thickness, random = np.zeros((ROWS, COLUMNS)), np.random.default_rng(1)
    thickness[20:40, 60:70] = 1.234567
    for _ in range(10):
        x, slant = random.uniform(300, 400), random.uniform(-150, 150)
        sides = sides_of(strip((x - slant, -10), (x + slant, 610)).intersection(box(0, 0, 800, 600)))
        left = balls((x, 300, 100, 300), volume=1e-3)
        divided = passed.of_mass(ground_of(thickness, lost=1e-3), sides, left)["divided"]
        assert divided == {"before": 0.0, "on": pytest.approx(1e-3, rel=1e-6), "past": pytest.approx(24691.34),
                           "past_end": 0.0, "unknown": 0.0}


def test_a_ball_between_two_looks_may_have_left_before_the_road():
    """Of dumps: one that is seen 30 m beyond a road counts as before it if a frame is 50 m."""
    ground, sides = ground_of(np.zeros((ROWS, COLUMNS)), lost=2.0), sides_of(ROADS["divides"][0])
    for within, ahead in ((0.0, 0.0), (20.0, 0.0), (50.0, 2.0)):
        assert passed.of_mass(ground, sides, balls((442, 600, 100, 300), within=within))["left"]["road_ahead"] == ahead


@pytest.mark.parametrize("within", [0.0, 50.0])
def test_what_leaves_over_the_summit_has_no_road_ahead(within):
    """The road lies east of the mass: what left in the west, and in the north-west, does not come to it."""
    ground, sides = ground_of(np.zeros((ROWS, COLUMNS)), lost=8.0), sides_of(ROADS["divides"][0])
    left = balls((0, 300, 100, 300), (0, 380, 100, 300), (100, 600, 100, 300), (50, 600, 100, 300), within=within)
    about = passed.of_mass(ground, sides, left)["left"]
    assert about["before"] == 8.0 and about["road_ahead"] == 4.0
    assert {(one["side"], one["where"]): one["volume"] for one in about["sides"]} == {
        ("west", "away from it"): 4.0, ("north", "before"): 4.0}


def test_sides_of_a_terrain_that_is_no_rectangle():
    known = np.ones((ROWS, COLUMNS), bool)
    known[:, 75:] = known[10:14, 30:34] = known[55:, :40] = False       # a hole at x 300 to 340, y 460 to 500
    left = balls((750, 300, 100, 300), (310, 460, 100, 300), (100, 50, 100, 300), (100, 600, 100, 300))
    assert gone.sides(left, ground_of(np.zeros((ROWS, COLUMNS)), known)).tolist() == [
        "east", "a hole", "south", "north"]
    one = gone.groups(left, ground_of(np.zeros((ROWS, COLUMNS)), known))
    assert {each["side"]: each["add"] is None for each in one} == {"east": False, "a hole": True, "south": False,
                                                                   "north": False}


# --- the table, and dumps ---

@pytest.mark.parametrize("text, message", [
    ("", "must be the table of balls that fix deposit/grid writes"),
    ("ball,volume\n", "line 1: must be ball,volume,time,x,y,from_x,from_y, got ball,volume"),
    ("{head}\n1,2,3,4,5,6\n", "line 2: must be 7 numbers, the volume > 0, got 1,2,3,4,5,6"),
    ("{head}\n1,2,3,4,5,6,7\n2,0,3,4,5,6,7\n", "line 3: must be 7 numbers"),
    ("{head}\n1,2,3,nan,5,6,7\n", "line 2: must be 7 numbers"),
    ("{head}\n1,x,3,4,5,6,7\n", "line 2: must be 7 numbers")])
def test_a_table_that_is_none(tmp_path, text, message):
    path = tmp_path / "site.left.csv"
    path.write_text(text.format(head=gone.HEAD))
    with pytest.raises(SlopeError) as error:
        gone.of_file(path)
    assert message in str(error.value)


def write_dump(folder, step, rows):
    lines = [f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(rows)}\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
             "ITEM: ATOMS id diameter x y z vx vy vz\n"]
    lines += [f"{number} {size} {x} {y} 0 {vx} {vy} 0\n" for number, size, x, y, vx, vy in rows]
    (folder / f"site.{step:08d}.dump").write_text("".join(lines))


def test_what_left_by_dumps(tmp_path):
    """Beyond the edge and still there, gone between two frames, returned, in a hole."""
    known = np.ones((ROWS, COLUMNS), bool)
    known[10:14, 30:34] = False
    ground = ground_of(np.zeros((ROWS, COLUMNS)), known, lost=40.0)
    ground.summary.update(dt=0.01, balls={"released": 5}, stop={"step": 200})
    ground.summary["volume"]["released"] = 16.0
    begin = [(1, 1, 790, 300), (2, 2, 795, 200), (3, 1, 795, 100), (4, 1, 290, 480), (5, 1, 300, 300)]
    write_dump(tmp_path, 0, [(*one, 20, 0) for one in begin])
    write_dump(tmp_path, 100, [(1, 1, 810, 320, 20, 0), (3, 1, 805, 100, 20, 0), (4, 1, 310, 480, 20, 0),
                               (5, 1, 310, 300, 0, 0)])
    write_dump(tmp_path, 200, [(1, 1, 830, 340, 20, 0), (3, 1, 790, 100, 0, 0), (4, 1, 330, 480, 20, 0),
                               (5, 1, 310, 300, 0, 0)])
    found = gone.read_balls_gone(tmp_path / "site", ground)
    assert found.source == "dumps" and found.volume == pytest.approx(16 * np.array([1, 8, 1]) / 12)
    assert found.place == pytest.approx(np.array([[800, 310], [800, 200], [300, 480]]), abs=1e-6)
    assert found.start == pytest.approx(np.array([[790, 300], [795, 200], [290, 480]]))
    assert found.within == pytest.approx([math.hypot(20, 20), 20, 20])
    for released in (4, 6):     # fixed balls are among them, or some of the mass alone
        ground.summary["balls"]["released"] = released
        assert gone.read_balls_gone(tmp_path / "site", ground) is None


def test_not_known_what_left(tmp_path):
    ground = ground_of(np.ones((ROWS, COLUMNS)), lost=40.0)
    assert gone.read_balls_gone(tmp_path / "site", ground) is None
    ground = ground_of(np.ones((ROWS, COLUMNS)))
    assert gone.read_balls_gone(tmp_path / "site", ground).source == "nothing left"
    ground.summary["files"] = ["site.thickness.asc", "site.left.csv"]
    with pytest.raises(SlopeError) as error:
        gone.read_balls_gone(tmp_path / "site", ground)
    assert "site.left.csv: must be the table" in str(error.value)
