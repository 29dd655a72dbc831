"""Stretches of a road, passable width, the least lane and the hours: against integrals of the definitions, made here.

The integrals know the deposit as a function, not as cells: stretches and widths are found on a fine grid of chainage
and offset, volumes on one of x and y, with the nearest point of a lane's edge in closed form. Thickness is even in a
cell, so that each case states the cell that its accuracy takes.
"""
import csv
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import fiona
import numpy as np
import pytest
import yaml
from affine import Affine
from shapely.affinity import translate
from shapely.geometry import LineString, MultiLineString, Point, Polygon, box, shape

from run_helpers import (CRS_M, EAST, NORTH, centres, run_command, write_geojson, write_run,
                         write_sidecar)

import test_site
from tiny_collapse import LMP, write_case

from slope_tools.deposits import clearing, volume_files
from slope_tools.deposits.axis import Axis, Span, longest_gap, merged, parts_of_mask
from slope_tools.report import road_part
from slope_tools.report.numbers import Numbers
from slope_tools.statistics import rounding
from slope_tools.statistics.entries import Kind
from slope_tools.survey import rasters, roads
from slope_tools.survey.rasters import Raster
from slope_tools.tables import road_runs
from slope_tools.tables.study_file import load_study

TAN30 = math.tan(math.radians(30))
WIDTH, LANE = 8.0, 3.5          # m, of the road, of the lane
SIDE = 80.0                     # m, of the terrain
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")


# --- deposits, grounds and roads as functions ---

def within(y):
    return (y > 20) & (y < 60)


DEPOSITS = {"prism": lambda x, y: np.where(within(y), 3.0, 0),
            "half": lambda x, y: np.where(within(y) & (x < 42), 3.0, 0),
            "wedge": lambda x, y: np.where(within(y), np.clip(0.15 * (52 - x), 0, None), 0),
            "cone": lambda x, y: np.clip(5 - 0.25 * np.hypot(x - 33, y - 41), 0, None)}
GROUNDS = {"level": lambda x, y: 0 * x, "falling": lambda x, y: 100 - 0.2 * x + 0.05 * y,
           "rising": lambda x, y: 0.3 * x + 0.1 * y}


class Straight:
    """A road from a point, in a direction in degrees."""

    def __init__(self, x, y, angle, length):
        self.start, turn = np.array([x, y]), math.radians(angle)
        self.unit, self.length = np.array([math.cos(turn), math.sin(turn)]), length
        self.left = np.array([-self.unit[1], self.unit[0]])

    def axis(self):
        return Axis([self.start, self.start + self.length * self.unit])

    def to(self, x, y):
        return tuple((x - self.start[0]) * way[0] + (y - self.start[1]) * way[1] for way in (self.unit, self.left))

    def place(self, s, n):
        return tuple(self.start[k] + s * self.unit[k] + n * self.left[k] for k in (0, 1))

    def nearest(self, x, y, along, across):
        s, n = self.to(x, y)
        return self.place(np.clip(s, *along), np.clip(n, *across))


class Curved:
    """An arc of a circle to the left; its axis is a polyline with a point every metre."""

    def __init__(self, x, y, radius, first, turn):
        self.centre, self.radius, self.first = (x, y), radius, math.radians(first)
        self.length = radius * math.radians(turn)

    def axis(self):
        s = np.linspace(0, self.length, int(self.length) + 1)
        return Axis(np.column_stack(self.place(s, 0 * s)))

    def to(self, x, y):
        x, y = x - self.centre[0], y - self.centre[1]
        turn = np.mod(np.arctan2(y, x) - self.first + math.pi, 2 * math.pi) - math.pi
        return turn * self.radius, self.radius - np.hypot(x, y)

    def place(self, s, n):
        angle = self.first + s / self.radius
        return (self.centre[0] + (self.radius - n) * np.cos(angle), self.centre[1] + (self.radius - n) * np.sin(angle))

    def nearest(self, x, y, along, across):
        s, n = self.to(x, y)
        found = self.place(np.clip(s, *along), np.clip(n, *across))
        for end, beyond in zip(along, (s < along[0], s > along[1])):     # the straight ends of a lane
            (ax, ay), (bx, by) = (self.place(end, one) for one in across)
            share = np.clip(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2), 0, 1)
            found = tuple(np.where(beyond, a + share * (b - a), one) for a, b, one in
                          ((ax, bx, found[0]), (ay, by, found[1])))
        return found


ROADS = {"straight": Straight(40, 2, 90, 76), "oblique": Straight(25, 2, 70, 80),
         "curved": Curved(-40, 40, 80, -25, 50)}


# --- the definitions, by integrals ---

def own_volume(road, deposit, ground, along, across, step):
    """All in the lane; outside max(0, t - max(0, h)), h = z(nearest edge point) + tan(30) distance - z."""
    x, y = centres(round(SIDE / step), round(SIDE / step), step)
    thickness = deposit(x, y)
    qx, qy = road.nearest(x, y, along, across)
    distance = np.hypot(qx - x, qy - y)
    above = ground(qx, qy) + TAN30 * distance - ground(x, y)
    return np.where(distance == 0, thickness, np.maximum(0, thickness - np.maximum(0, above))).sum() * step ** 2


def own_stretch(road, deposit, blocked, step=0.01):
    """From, to and passable width of the only stretch."""
    s, n = np.arange(step / 2, road.length, step), np.arange((step - WIDTH) / 2, WIDTH / 2, step)
    thick = deposit(*road.place(s[:, None], n)) > blocked
    rows = np.flatnonzero(thick.any(axis=1))
    free = np.flatnonzero(np.concatenate([[True], thick.any(axis=0), [True]]))
    assert len(rows) == rows[-1] - rows[0] + 1
    return s[rows[0]] - step / 2, s[rows[-1]] + step / 2, (np.diff(free).max() - 1) * step


def gridded(function, cell, west=0.0, south=0.0, size=SIDE):
    number = round(size / cell)
    x, y = centres(number, number, cell, west, south)
    return Raster(function(x, y), Affine(cell, 0, west, 0, -cell, south + size), None)


def evaluated(road, deposit, ground, cell, lane=LANE, blocked=0.1):
    """The only stretch, its lane's place and the Cutter."""
    raster = gridded(deposit, cell)
    [one] = clearing.find_lane_stretches(raster, [road.axis()], WIDTH, blocked)
    cutter = clearing.Cutter(raster, gridded(ground, cell).z, 30, 4)
    return one, cutter.least(one, lane), cutter


@pytest.mark.parametrize("way, ground, deposit", [
    ("straight", "level", "prism"), ("straight", "falling", "half"), ("oblique", "falling", "cone"),
    ("oblique", "rising", "prism"), ("curved", "level", "cone"), ("curved", "rising", "wedge")])
def test_stretch_and_least_lane_are_the_integrals(way, ground, deposit):
    """Cells of 0.5 m, for the prism of 1 m: the volume to 0.1 %, on curved roads to 0.5 %; no place takes less."""
    road, thickness, height = ROADS[way], DEPOSITS[deposit], GROUNDS[ground]
    one, place, _ = evaluated(road, thickness, height, 1.0 if deposit == "prism" else 0.5)
    most = 0.005 if way == "curved" else 0.001
    if deposit != "cone":       # whose ends are between cells: see below
        low, high, passable = own_stretch(road, thickness, 0.1)
        assert (one.along.high - one.along.low) == pytest.approx(high - low, rel=most)
        assert one.along == pytest.approx((low, high), abs=0.03)
        assert one.passable == pytest.approx(passable, abs=0.011)
    across = place.offset - LANE / 2, place.offset + LANE / 2
    assert place.volume == pytest.approx(own_volume(road, thickness, height, one.along, across, 0.1), rel=most)
    least = min(own_volume(road, thickness, height, one.along, (n - LANE / 2, n + LANE / 2), 0.5)
                for n in np.linspace(LANE - WIDTH, WIDTH - LANE, 7) / 2)
    assert place.volume < least * (1 + 3 * most)


@pytest.mark.parametrize("way, cell", [("straight", 0.01), ("oblique", 0.005), ("curved", 0.01)])
def test_stretch_and_passable_width_beside_a_cone(way, cell):
    """A cone of 0.4 beside the road, 0.1 m thick on a circle of 4.75 m about the offset 5: to 0.1 or 0.5 %.

    The cells are as small as its round contour takes.
    """
    road = ROADS[way]
    x, y = road.place(30.0, 5.0)

    def cone(px, py):
        return np.clip(2 - 0.4 * np.hypot(px - x, py - y), 0, None)

    [one] = clearing.find_lane_stretches(gridded(cone, cell, round(float(x)) - 5.0, round(float(y)) - 5.0, 10.0),
                                         [road.axis()], WIDTH, 0.1)
    half = math.sqrt(4.75 ** 2 - 1)     # where the road's edge cuts the circle
    if way == "curved":
        half = 80 * math.acos((75 ** 2 + 76 ** 2 - 4.75 ** 2) / (2 * 75 * 76))
    most = 0.005 if way == "curved" else 0.001
    assert one.passable == pytest.approx(4.25, rel=most)
    assert one.along == pytest.approx((30 - half, 30 + half), abs=most * half)


@pytest.mark.parametrize("area", [box(1, 1, 5, 7), box(-3, -3, 5, 5), Polygon([(1, 1), (11, 2), (6, 7.5)])])
def test_the_part_of_a_mask_that_is_all_true_is_the_area_in_it(area):
    [part] = parts_of_mask(np.ones((4, 6), bool), Affine(2, 0, 0, 0, -2, 8), area)
    assert part.symmetric_difference(area.intersection(box(0, 0, 12, 8))).area < 1e-4


def test_the_closed_form_of_a_half_road():
    """3 m of deposit on the western 6 m of 8 m: 2 m pass; the lane leaves these in the east, and cuts 1.5 m of it."""
    one, place, _ = evaluated(ROADS["straight"], DEPOSITS["half"], GROUNDS["level"], 2.0)
    assert one.along == pytest.approx((18, 58), abs=1e-9) and one.passable == pytest.approx(2, abs=1e-9)
    assert place.offset == pytest.approx(-2.25)         # to the right of a road to the north
    assert place.volume == pytest.approx(40 * (3 * 1.5 + 9 / (2 * TAN30)), rel=1e-9)


@pytest.mark.parametrize("way, deposit", [("straight", "cone"), ("oblique", "prism"), ("curved", "wedge")])
def test_wider_lanes_never_take_less_on_a_level_section(way, deposit):
    volumes = [evaluated(ROADS[way], DEPOSITS[deposit], GROUNDS["level"], 2.0, lane)[1].volume
               for lane in (1, 3, 6, 7.9, 8)]
    assert all(0 < low < high for low, high in zip(volumes, volumes[1:]))


# --- ranges and axes ---

def test_ranges():
    spans = [Span(3, 4), Span(0, 1), Span(1, 2), Span(3.5, 5)]
    assert merged(spans) == [(0, 2), (3, 5)] and merged(spans, 1) == [(0, 5)]
    assert longest_gap(spans, Span(-1, 8)) == 3 and longest_gap(spans, Span(0, 2)) == 0
    assert longest_gap([], Span(-1, 8)) == 9


def test_an_axis_with_bends_is_divided_without_gaps_and_overlaps():
    axis = Axis([(0, 0), (10, 0), (10, 0), (20, 5), (30, 0), (30, 20)], 100)
    whole = LineString(axis.points).buffer(2, 45, cap_style=2)
    assert axis.s[-1] == pytest.approx(130 + 20 * math.sqrt(1.25))
    assert sum(piece.area.area for piece in axis.pieces(2)) == pytest.approx(whole.area, rel=1e-4)
    for across in ((-2, 2), (0.5, 2), (-2, -0.5), (-2, 0.5)):
        cuts = [100, 105, 109.8, 110, 110.1, 121.2, 133, axis.s[-1]]
        parts = [axis.band(Span(*ends), Span(*across)) for ends in zip(cuts, cuts[1:])]
        every = axis.band(Span(0, 1e9), Span(*across))
        assert every.geom_type == "MultiPolygon" and len(every.geoms) == 1
        arcs = axis.band(Span(110, 110), Span(*across)).area        # in the parts before it and behind it
        assert sum(part.area for part in parts) == pytest.approx(every.area + arcs, rel=1e-5)
    s, n = axis.locate([5, 16, 40, 0, 31], [3, 13, 10, -2, -1])
    assert s == pytest.approx([105, 110 + 5 * math.sqrt(5), 110 + 10 * math.sqrt(5) + 10, 100, 110 + 10 * math.sqrt(5)])
    assert n == pytest.approx([3, 4 * math.sqrt(5), -10, -2, -math.sqrt(2)])


# --- the command ---

@pytest.fixture
def slope(here, capsys, monkeypatch):
    """Run `slope volume ARGUMENTS`, without its map; gives status, stdout, stderr."""
    monkeypatch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())
    return lambda arguments: run_command("volume", arguments, capsys)


@pytest.fixture
def cleared(slope):
    """Run it on `run` with --local, which must succeed; gives volume.yaml."""
    def run(road, arguments="", output="out"):
        write_geojson("road.geojson", road)
        status, _, err = slope(f"run --road road.geojson --local --mesh 7 -o {output} {arguments}")
        assert status == 0, err
        return yaml.safe_load(Path(output, "volume.yaml").read_text())
    return run


PATCHES = (10, 20, 30, 2.0), (24, 30, 38, 3.0), (50, 70, 20, 1.5)     # m: y from, y to, x from, thickness


def patches(some=PATCHES, cell=2.0):
    """Three patches of deposit on a road to the north, of which two are so near that their cuts meet."""
    x, y = centres(40, 40, cell)
    return sum(np.where((y > low) & (y < high) & (x > west) & (x < 60), t, 0.0) for low, high, west, t in some)


def test_a_lane_as_wide_as_the_road_takes_what_volume_takes(cleared):
    """Of one stretch, 0 m blocking: the deposit does not pass the stretch's ends beside the road."""
    x, y = centres(40, 40, 2.0)
    write_run(DEPOSITS["wedge"](x, y), 0.3 * x + 0.1 * y, 2.0)
    road = LineString([(40, 2), (40, 78)])
    about = cleared(road, "--road-width 8 --blocked 0 --lane 8")
    [one] = about["stretches"]
    assert one["remove_lane"] == pytest.approx(about["volume"]["remove"], rel=1e-9) == about["clearing"]["remove"]
    assert one["lane_offset"] == 0 and one["from"] == 18 and one["to"] == 58


def test_stretches_add_up_with_mesh_and_total(cleared):
    x, y = centres(40, 40, 2.0)
    write_run(patches(), 0.1 * x, 2.0)
    about = cleared(LineString([(42, 1), (40, 79)]), "--road-width 8 --road-from 3 --lane 3 --clearing 60 "
                    "--loosening 1.3")
    stretches, total = about["stretches"], about["clearing"]
    assert [(round(one["from"]), round(one["to"])) for one in stretches] == [(3009, 3019), (3023, 3029), (3049, 3069)]
    assert math.fsum(one["remove"] for one in stretches) == pytest.approx(total["remove"], rel=1e-9)
    assert total["remove"] == pytest.approx(about["volume"]["remove"], rel=1e-9)
    own = math.fsum(one["remove_lane"] for one in stretches)
    assert own - total["remove_lane_twice"] == pytest.approx(total["remove_lane"], rel=1e-9)
    # of each 10 m what lies on it, within a cell; all of it is what lies on the road
    by_part = dict(about["by_10_m"])
    assert math.fsum(by_part.values()) == pytest.approx(about["volume"]["remove_on_road"], rel=1e-6)
    assert list(by_part) == [3000, 3010, 3020, 3040, 3050, 3060] and all(one % 10 == 0 for one in by_part)
    assert by_part[3050] == pytest.approx(8 * 10 * 1.5, rel=0.03)
    assert total["remove_lane_twice"] > 1       # the cuts of the first two meet
    with open("out/volume.csv", newline="", encoding="ascii") as lines:
        mesh = [float(row["remove_lane"]) for row in csv.DictReader(lines)]
    assert math.fsum(mesh) == pytest.approx(total["remove_lane"], rel=1e-9)
    for one in (*stretches, total):
        assert one["hours"] == pytest.approx(one["remove"] * 1.3 / 60, rel=1e-6)
        assert one["hours_lane"] == pytest.approx(one["remove_lane"] * 1.3 / 60, rel=1e-6)
    assert total["blocked_length"] == pytest.approx(sum(one["to"] - one["from"] for one in stretches), abs=1e-5)
    write_run(patches(PATCHES[2:]), 0.1 * x, 2.0)       # the third patch lies apart
    alone = cleared(LineString([(42, 1), (40, 79)]), "--road-width 8", "alone")
    assert stretches[2]["remove"] == pytest.approx(alone["volume"]["remove"], rel=1e-9)


def test_the_union_of_lanes_along_rising_ground():
    """Between two lanes both cuts count, the nearer and the lower one: the larger of both removals, by an integral."""
    def deposit(x, y):
        return np.where(within(y) & ((y < 32) | (y > 38)), 3.0, np.where(within(y) & (np.abs(x - 40) > 4), 3.0, 0.0))

    def ground(x, y):
        return 0.4 * y + 0 * x

    road, raster = ROADS["straight"], gridded(deposit, 1.0)
    found = clearing.find_lane_stretches(raster, [road.axis()], WIDTH, 0.1)
    cutter = clearing.Cutter(raster, gridded(ground, 1.0).z, 30, 4)
    got = cutter.removed([cutter.area(one, 0.0, LANE) for one in found]).cells.sum()
    step = 0.1
    x, y = centres(round(SIDE / step), round(SIDE / step), step)
    each = []
    for one in found:
        qx, qy = road.nearest(x, y, one.along, (-LANE / 2, LANE / 2))
        distance = np.hypot(qx - x, qy - y)
        above = np.where(distance == 0, 0, ground(qx, qy) + TAN30 * distance - ground(x, y))
        each.append(np.maximum(0, deposit(x, y) - np.maximum(0, above)))
    assert len(found) == 2 and got == pytest.approx(np.maximum(*each).sum() * step ** 2, rel=1e-3)
    assert got < 0.97 * sum(one.sum() for one in each) * step ** 2


def test_the_union_of_lanes_is_that_of_their_cuts(cleared):
    """On level ground the lower cut is that of the nearer lane: the same as of one road of two parts."""
    write_run(patches(), 0.0, 2.0)
    road = LineString([(42, 0), (42, 80)])
    about = cleared(road, "--road-width 4 --lane 4")
    parts = [box(40, round(one["from"]), 44, round(one["to"])) for one in about["stretches"]]
    write_geojson("parts.geojson", *parts)
    from slope_tools.deposits import volume
    both = volume.compute_removal("run", volume.Wanted(Path("parts.geojson"), 7, local=True)).about
    assert about["clearing"]["remove_lane"] == pytest.approx(both["volume"]["remove"], rel=1e-9)


@pytest.mark.parametrize("ends", [((42, 1), (40, 79)), ((3, 15), (77, 19))])
def test_a_polygon_made_by_buffering_the_line_gives_its_numbers(cleared, ends):
    x, _ = centres(40, 40, 2.0)
    write_run(patches(), 0.1 * x, 2.0)
    line = LineString(ends)
    options = "--lane 3 --clearing 60 --loosening 1.3"
    about = [cleared(line, f"--road-width 8 {options}"), cleared(line.buffer(4, cap_style=2), options, "other")]
    assert about[0]["stretches"]
    for one, other in zip(about[0]["stretches"], about[1]["stretches"], strict=True):
        for key in one:
            assert one[key] == pytest.approx(other[key], rel=1e-6, abs=1e-5), key
    for key in about[0]["volume"]:
        assert about[0]["volume"][key] == pytest.approx(about[1]["volume"][key], rel=1e-6)


def test_nothing_passes_where_a_road_of_polygons_ends(cleared):
    """It is 8 m wide, and 5 m where a deposit lies on its eastern part, beside which 1.5 m are left; a lane lies on it.
    """
    x, y = centres(160, 160, 0.5)
    write_run(np.where((x > 40.5) & (abs(y - 50) < 5), 1.0, 0.0), 0.0, 0.5)
    for notch, free in ((box(30, 40, 39, 60), 1.5), (box(30, 60, 39, 80), 40.5 - 40 + 7.25 / 2)):
        road = box(36, 0, 44, 80).difference(notch)
        [one] = cleared(road, "--lane 3", f"out{free}")["stretches"]
        assert one["passable_width"] == pytest.approx(free, abs=1e-5)
        if free < 3:
            assert one["lane_offset"] == pytest.approx(1 - 3 / 2, abs=0.01) and one["remove_lane"] > 1.5 * 10 * 1.0


def test_the_files_of_stretches(cleared):
    write_sidecar(40, 40, 2.0)
    write_run(patches(), 0.0, 2.0)
    about = cleared(LineString([(42, 79), (40, 1)]), "--road-width 8 --lane 3.5 --clearing 60 --loosening 1.3")
    with open("out/stretches.csv", newline="", encoding="ascii") as lines:
        rows = list(csv.DictReader(lines))
    assert [int(row["stretch"]) for row in rows] == [1, 2, 3]
    line = LineString([(42, 79), (40, 1)])
    for row, one in zip(rows, about["stretches"], strict=True):
        assert {key: float(row[key]) for key in one} == pytest.approx(one)
        assert (float(row["east_from"]) - EAST, float(row["north_from"]) - NORTH) == pytest.approx(
            line.interpolate(one["from"]).coords[0], abs=1e-6)
    assert fiona.listlayers("out/stretches.gpkg") == ["stretches", "lanes"]
    with fiona.open("out/stretches.gpkg", layer="lanes") as layer:
        assert layer.crs["init"] == "epsg:6677"
        for feature, one in zip(layer, about["stretches"], strict=True):
            assert feature["properties"]["remove_lane"] == pytest.approx(one["remove_lane"])
            lane = translate(shape(feature["geometry"]), -EAST, -NORTH)
            assert lane.area == pytest.approx(3.5 * (one["to"] - one["from"]), rel=1e-6)
            assert lane.centroid.distance(line) == pytest.approx(abs(one["lane_offset"]), abs=1e-6)
    with fiona.open("out/stretches.gpkg", layer="stretches") as layer:
        assert [shape(feature["geometry"]).length for feature in layer] == pytest.approx(
            [one["to"] - one["from"] for one in about["stretches"]])


def test_a_road_that_is_not_blocked_has_no_stretch(cleared):
    write_run(np.where(centres(40, 40, 2.0)[0] > 70, 3.0, 0.0), 0.0, 2.0)
    about = cleared(LineString([(20, 0), (20, 80)]), "--road-width 8 --lane 3.5 --clearing 60 --loosening 1.3")
    assert about["stretches"] == [] and about["clearing"]["remove_lane"] == about["clearing"]["hours_lane"] == 0
    assert Path("out/stretches.csv").read_text().startswith("stretch,from,to") and Path("out/stretches.gpkg").is_file()


CURVE = LineString([(10, 40), (30, 44), (45, 60), (60, 60)])


@pytest.mark.parametrize("name, text", [
    ("line.csv", "".join(f"{x + EAST!r},{y + NORTH!r}\n" for x, y in CURVE.coords)),
    ("line.wkt", f"LINESTRING ({', '.join(f'{x + EAST!r} {y + NORTH!r}' for x, y in CURVE.coords)})")])
def test_a_line_of_any_format_is_the_same_road(slope, name, text):
    write_sidecar(40, 40, 2.0)
    write_run(patches(), 0.0, 2.0)
    write_geojson("line.geojson", translate(CURVE, EAST, NORTH), crs=CRS_M)
    Path(name).write_text(text)
    found = []
    for road in ("line.geojson", name):
        assert slope(f"run --road {road} --road-width 6 --mesh 10 -o out --overwrite")[0] == 0
        found.append(yaml.safe_load(Path("out/volume.yaml").read_text()))
    assert found[0]["stretches"] == found[1]["stretches"] != []
    assert found[0]["volume"] == found[1]["volume"]


def test_a_road_that_is_written_is_read_as_the_same_line(here):
    write_sidecar(40, 40, 2.0)
    place = gridded(GROUNDS["level"], 2.0)._replace(offset=(EAST, NORTH))
    asked = roads.Asked(6.0)
    road = roads.Road(CURVE.buffer(3, cap_style=2), [CURVE])
    roads.write_road(Path("road.csv"), road, place)
    assert roads.read_local("road.csv", place, asked).line.equals_exact(CURVE, 1e-6)
    with pytest.raises(roads.SlopeError, match="road.csv: is a line, whose width must be given: --road-width"):
        roads.read_local("road.csv", place)
    Path("degrees.wkt").write_text("LINESTRING (36.14 39.66, 36.141 39.66)")
    with pytest.raises(roads.SlopeError, match="degrees.wkt: must be a line of 1 m at least; .*degrees.*, got 0"):
        roads.read_local("degrees.wkt", place, asked, local=True)


UP, REST = [(40, 0), (40, 80)], [(40, 30), (40, 80)]


@pytest.mark.parametrize("drawn, axis", [
    ([UP, UP], UP), ([UP, UP, UP], UP), ([UP, UP[::-1]], UP), ([UP[::-1], UP], UP[::-1]),     # two features, or copies
    ([[*UP, UP[0]]], UP), ([[*UP, (40, 30)]], UP), ([[(40, 0), (30, 40), (40, 80), (30, 40), (40, 0)]],
                                                    [(40, 0), (30, 40), (40, 80)]),       # there and back
    ([UP, REST], UP), ([UP[::-1], REST], UP[::-1]), ([[(40, 0), (40, 50)], REST], UP)])   # in a part
@pytest.mark.parametrize("suffix", ["geojson", "csv", "wkt"])
def test_a_line_that_is_drawn_twice_is_one_axis(here, drawn, axis, suffix):
    place = gridded(GROUNDS["level"], 2.0)
    if suffix == "geojson":
        write_geojson("road.geojson", *map(LineString, drawn))
    elif suffix == "csv":
        (here / "road.csv").write_text("\n".join("".join(f"{x},{y}\n" for x, y in line) for line in drawn))
    else:
        (here / "road.wkt").write_text(MultiLineString(drawn).wkt)
    said = []
    found = roads.read_local(f"road.{suffix}", place, roads.Asked(8.0), local=True, warn=said.append)
    wanted = LineString(axis)
    assert found.line.length == pytest.approx(wanted.length) and found.line.hausdorff_distance(wanted) < 1e-9
    assert (found.line.coords[0], found.line.coords[-1]) == (wanted.coords[0], wanted.coords[-1])
    [one] = said
    drawn_length = sum(LineString(line).length for line in drawn)
    assert one.kind == "drawn twice" and f"road.{suffix}" in str(one)
    assert one.numbers["percent"] == pytest.approx(100 * (1 - wanted.length / drawn_length))


def test_what_is_no_line_is_named(here):
    write_geojson("road.geojson", LineString(UP), Point(3, 3), box(1, 1, 2, 2))
    said = []
    found = roads.read_local("road.geojson", gridded(GROUNDS["level"], 2.0), roads.Asked(8.0), local=True,
                             warn=said.append)
    assert found.line.length == 80 and [one.kind for one in said] == ["no line"]
    assert "Point and Polygon" in str(said[0])


# --- over the runs of a study ---

def run_of(weight, *stretches):
    """A run: stretches of (from, to, volume of a lane)."""
    several = [{"from": low, "to": high, "passable_width": 1.0, "remove": 2 * volume, "remove_lane": volume}
               for low, high, volume in stretches]
    totals = {name: sum(one[name] for one in several) for name in ("remove", "remove_lane")}
    length = sum(high - low for low, high, _ in stretches)
    return road_runs.Run(weight, several, {"road_width": 8.0, "blocked_length": length, **totals})


def test_stretches_of_a_study_are_unions_with_shares_and_quantiles():
    runs = [run_of(1, (0, 10, 100.0), (30, 40, 50.0)), run_of(1, (5, 20, 300.0)), run_of(1), run_of(1, (6, 8, 10.0))]
    about = road_runs.evaluate_road_runs(runs)
    first, second = about.stretches
    assert (first["from"], first["to"], first["share"]) == (0, 20, 0.75)
    assert (second["from"], second["to"], second["share"]) == (30, 40, 0.25)
    assert first["remove_lane"] == [0, 10, 300] and first["passable_width"] == [1, 1, 8]
    assert about.totals["remove_lane"] == [0, 10, 300] and about.share_blocked == 0.75
    assert about.shares == [[0, 5, 0.25], [5, 6, 0.5], [6, 8, 0.75], [8, 10, 0.5], [10, 20, 0.25], [30, 40, 0.25]]
    heavy = road_runs.evaluate_road_runs([runs[0]._replace(weight=9), *runs[1:]])
    assert heavy.stretches[1]["share"] == pytest.approx(0.75) and heavy.totals["remove_lane"][1] == 150
    head, *lines = road_runs.rows(about)
    assert [len(line) for line in lines] == [len(head)] * 3
    nothing = road_runs.evaluate_road_runs([run_of(1), run_of(1)])
    assert nothing.stretches == nothing.shares == [] and nothing.share_blocked == 0


# --- bad input ---

@pytest.mark.parametrize("arguments, message", [
    ("--road line.geojson", "line.geojson: is a line, whose width must be given: --road-width"),
    ("--road line.geojson --road-width 0", "--road-width: must be > 0, got 0"),
    ("--road line.geojson --road-width 7500", "--road-width: must be at most 1000 m, got 7500"),
    ("--road line.geojson --road-width 4 --lane 4.5", "--lane: must be at most as wide as the road, 4 m, got 4.5"),
    ("--road polygon.geojson --lane 9", "--lane: must be at most as wide as the road, 8 m, got 9"),
    ("--road line.geojson --road-width 4 --lane 0", "--lane: must be > 0, got 0"),
    ("--road line.geojson --road-width 4 --clearing 60", "--clearing: must be given with --loosening, got 60"),
    ("--road line.geojson --road-width 4 --loosening 1.3", "--loosening: must be given with --clearing, got 1.3"),
    ("--road line.geojson --road-width 4 --clearing 60 --loosening 0.9", "--loosening: must be >= 1"),
    ("--road far.geojson --road-width 4 --road-from 2", "far.geojson: must lie in the terrain, local x y 0 0 80 80: "
     "give the part in it, or a larger terrain; it leaves it at the chainage 2070.0 m, got 40 80"),
    ("--road crossing.geojson --road-width 4", "crossing.geojson: must be a line that does not cross itself; it does "
     "at the chainage 20.0 m, got 30 10"),
    ("--road lines.geojson --road-width 4", "lines.geojson: must hold one line, for --road-width, got 2 that do not"),
    ("--road polygon.geojson --road-width 4", "polygon.geojson: must hold a line: leave out --road-width"),
    ("--road line.geojson --road-width 4 --axis line.geojson", "--axis: must not be given with --road-width"),
])
def test_bad_input_is_one_line(slope, here, arguments, message):
    write_run(patches(), 0.0, 2.0)
    write_geojson("line.geojson", LineString([(40, 0), (40, 80)]))
    write_geojson("far.geojson", LineString([(40, 10), (40, 90)]))
    write_geojson("crossing.geojson", LineString([(10, 10), (50, 10), (50, 30), (30, 30), (30, 5)]))
    write_geojson("lines.geojson", LineString([(40, 0), (40, 30)]), LineString([(42, 40), (40, 80)]))
    write_geojson("polygon.geojson", box(36, 0, 44, 80))
    before = sorted(here.rglob("*"))
    status, out, err = slope(f"run --local --mesh 10 -o out {arguments}")
    lines = [line for line in err.splitlines() if "warning" not in line]
    assert (status, out) == (2, "") and len(lines) == 1 and "Traceback" not in err
    assert lines[0].startswith("slope volume: ") and message in lines[0]
    assert sorted(here.rglob("*")) == before


# --- site, study, report, mobility: through LAMMPS ---

def test_a_study_of_a_line_is_that_of_the_polygon_and_is_reported(here, capsys, monkeypatch):
    """Two runs of a tiny collapse: volumes are the same; stretches, lane and hours are on the page, with bands."""
    write_case(here / "case")
    (here / "line.csv").write_text("15,0\n15,24\n")
    (here / "polygon.csv").write_text("13,0\n17,0\n17,24\n13,24\n")
    monkeypatch.setenv("LMP", LMP)
    monkeypatch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())
    options = "--lane 1.5 --clearing 20 --loosening 1.25 --blocked 0.05"
    abouts = []
    for name, width in (("line", "--road-width 4"), ("polygon", "")):
        words = f"case/in.tiny --set steps=900 --set rolling=0,0.3 --jobs 1 --mesh 4 -o {name} --road {name}.csv"
        assert run_command("study", f"{words} {width} {options}", capsys)[0] == 0
        abouts.append(yaml.safe_load(Path(name, "study.yaml").read_text()))
    line, polygon = abouts
    assert line["study"]["road"]["width"] == 4 and polygon["study"]["road"]["width"] is None
    for one, other in zip(line["runs"], polygon["runs"], strict=True):
        assert one["remove_lane_m3"] > 0 and one["clear_hours"] == pytest.approx(one["remove_m3"] / 16, rel=1e-6)
        for key in ("remove_m3", "remove_on_road_m3", "beyond_road_m3", "blocked_m", "remove_lane_m3", "lane_hours"):
            assert one[key] == pytest.approx(other[key], rel=1e-6), key
    found = line["stretches"]
    hours = sorted(run["lane_hours"] for run in line["runs"])
    assert found["totals"]["hours_lane"] == [hours[0], hours[0], hours[1]] and hours[0] < hours[1]
    assert max(one["share"] for one in found["stretches"]) == 1
    with open("line/stretches.csv", newline="", encoding="ascii") as lines:
        rows = list(csv.DictReader(lines))
    assert len(rows) == len(found["stretches"]) + 1 and float(rows[-1]["hours_lane_95"]) == hours[1]
    with open("line/study.csv", newline="", encoding="ascii") as lines:
        table = list(csv.DictReader(lines))
    assert [float(row["lane_hours"]) for row in table] == [one["lane_hours"] for one in line["runs"]]

    assert run_command("report", "line", capsys)[0] == 0
    page = Path("line/report.html").read_text(encoding="utf-8")
    assert 'id="road"' in page and "Where the road is blocked" in page
    low, high = (rounding.format_rounded(value, rounding.place_of_digits(value)) for value in hours)
    assert f"{low} ({low} to {high})" in page       # of the table
    study, numbers = load_study(Path("line/study.yaml")), Numbers()
    data = SimpleNamespace(study=study)
    whole, lane = ([rounding.format_rounded(one, rounding.place_of_digits(one)) for one in found["totals"][key][::2]]
                   for key in ("hours", "remove_lane"))
    within = "(what 5 and 95 % of the runs stay within)"
    assert road_part.on_first_page(data, numbers, False) == [
        f"A lane of 1.5 m is open after {low} to {high} hours, the whole road after {' to '.join(whole)} hours of one "
        f"loader of 20 m3/h {within}."]
    for kind, text in ((Kind.NUMBER, "640 m3"), (Kind.FLOOR, "at least 640 m3"), (Kind.OPEN, "640 m3 (no bound)")):
        number = SimpleNamespace(kind=kind, volume_m3=640.0)
        [cleared] = road_part.on_first_page(SimpleNamespace(study=replace(study, headline=number)), numbers, False)
        assert cleared.endswith(f"loader of 20 m3/h {within}; {text} take 40.0 hours.")
    for asked, wanted in (({"lane": None},
                           f"The road is clear after {' to '.join(whole)} hours of one loader of 20 m3/h {within}."),
                          ({"clearing": None},
                           f"A lane of 1.5 m is open when {' to '.join(lane)} m3 are removed {within}.")):
        keys = {"lane": ("remove_lane", "hours_lane"), "clearing": ("hours", "hours_lane")}[[*asked][0]]
        less = replace(study, study=replace(study.study, road={**study.study.road, **asked}), stretches=replace(
            study.stretches, totals={key: value for key, value in found["totals"].items() if key not in keys}))
        assert road_part.on_first_page(SimpleNamespace(study=less), numbers, False) == [wanted]
    assert road_part.on_first_page(data, numbers, True) == [] and "A lane of 1.5 m" not in page     # not at rest
    reproduced = run_command("report", "line --reproduce", capsys)[1]
    assert "--road-width 4" in reproduced and "--lane 1.5 --clearing 20 --loosening 1.25" in reproduced


@pytest.mark.long
def test_a_site_with_a_line_and_the_mobility_of_it(tmp_path):
    test_site.write_files(tmp_path)
    test_site.write_layer(tmp_path / "axis.geojson", [(28, 0), (28, 80)], kind=LineString)
    road = ("--road-width", "16", "--road-from", "7", "--clearing", "60", "--loosening", "1.3", "--lane")
    body = ("--shape", "ellipsoid", "--depth", "5", "--balls", "300")
    done = test_site.make(tmp_path, *body, "--road", "axis.geojson", *road, "3")
    assert done.returncode == 0, done.stderr
    choices = yaml.safe_load((tmp_path / "mine" / "site.yaml").read_text())["road"]
    assert choices == {**choices, "width": 16, "from": 7, "lane": 3, "clearing": 60, "loosening": 1.3}
    place = rasters.read_place(tmp_path / "mine" / "terrain.asc")
    asked = roads.Asked.of(choices)
    assert asked == roads.Asked(16, 7, 0.1, 3, 60, 1.3)
    read = roads.read_local(tmp_path / "mine" / "road.csv", place, asked)
    drawn = translate(Polygon(test_site.ROAD), *np.subtract((test_site.EAST, test_site.NORTH), place.offset))
    assert read.polygon.symmetric_difference(drawn).area < 1e-3
    (tmp_path / "mine").rename(tmp_path / "site")
    wide = test_site.make(tmp_path, *body, "--road", "axis.geojson", *road, "17")
    assert wide.returncode == 2 and "slope site: --lane: must be at most as wide as the road" in wide.stderr
    without = test_site.make(tmp_path, *body, "--road", "axis.geojson")
    assert without.returncode == 2 and "axis.geojson: is a line, whose width must be given: --road-w" in without.stderr

    found = []
    for words in (["site", "-o", "a"], ["site", "-o", "b", "--road", "road.geojson"],
                  ["site", "-o", "c", "--road", "axis.geojson", *road[:2]]):
        done = test_site.slope(tmp_path, "mobility", *words)
        assert done.returncode == 0, done.stderr
        found.append(yaml.safe_load((tmp_path / words[2] / "mobility.yaml").read_text())["road"])
    assert found[0] is not None and found[0] == found[2]
    assert {key: pytest.approx(value) for key, value in found[0].items()} == found[1]
