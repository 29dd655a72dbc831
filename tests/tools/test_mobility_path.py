"""The fall path against closed forms, the probabilities on it against the t distribution, and slope mobility."""
import math
import shutil
from pathlib import Path

import fiona
import numpy as np
import pytest
import yaml
from affine import Affine
from rasterio.crs import CRS
from scipy import stats
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon, box

from run_helpers import TOP, run_command, write_asc, write_geojson, examples
from tiny_collapse import rows_of

from slope_tools.errors import SlopeError
from slope_tools.mobility import body, charts, events, fall_path, known as known_events, results
from slope_tools.releases import release
from slope_tools.survey import rasters
from slope_tools.survey.rasters import Raster
from slope_tools.tables import how_far

ALL = events.read_events()
SET = events.fit_relation(ALL)
DATA = next((folder for folder in (top / "shared" / "data" for top in TOP.parents) if folder.is_dir()), TOP / "none")
FRANK = DATA / "frank"
STEEP = 0.5         # slope of the ground
RADIUS = 150.0      # m, of the body


def terrain(height, columns=240, rows=120, cell=10.0):
    """A Raster of height(x, y), m."""
    x, y = np.meshgrid(cell * (np.arange(columns) + 0.5), cell * (rows - 0.5 - np.arange(rows)))
    return Raster(height(x, y), Affine(cell, 0, 0, 0, -cell, rows * cell), None), x, y


def disc(ground, centre, depth=20.0):
    """A body whose depth falls from the centre of a disc to its rim; 0.7 million m3 for 20 m."""
    raster, x, y = ground
    away = ((x - centre[0]) ** 2 + (y - centre[1]) ** 2) / RADIUS ** 2
    return body.of_arrays(raster, depth * np.clip(1 - away, 0, 1), "disc")


def plane(bearing):
    """Ground that falls by STEEP towards an angle from x (degrees), and the unit vector down."""
    way = np.array([math.cos(math.radians(bearing)), math.sin(math.radians(bearing))])
    return terrain(lambda x, y: 3000 - STEEP * (x * way[0] + y * way[1])), way


def hillside():
    """800 m of STEEP, then gentle ground, long enough for known events."""
    return terrain(lambda x, y: 1000 - STEEP * np.minimum(x, 800) - 0.02 * np.maximum(x - 800, 0), 500, 60)


# --- the path ---

@pytest.mark.parametrize("bearing, centre", [(0, (300, 600)), (25, (300, 300)), (-50, (500, 1000))])
def test_a_plane(bearing, centre):
    """Straight down whatever the grid, and to the edge; length and fall from the crown's level."""
    ground, way = plane(bearing)
    mass = disc(ground, centre)
    path = fall_path.trace(mass, 1e5)
    above = (np.array(centre) - mass.crown[:2]) @ way
    assert above == pytest.approx(RADIUS, abs=15)
    expected = np.array(centre) + (path.length - above)[:, None] * way
    assert np.hypot(*(np.column_stack([path.x, path.y]) - expected).T).max() < 3
    assert path.fall[1:] == pytest.approx(STEEP * path.length[1:], abs=1.5)
    assert path.end == fall_path.TERRAIN
    low, high = np.array([5, 5]), np.array([2395, 1195])       # outermost nodes: beyond, no height is known
    room = [((high if step > 0 else low)[k] - centre[k]) / step for k, step in enumerate(way) if abs(step) > 1e-9]
    assert path.length[-1] == pytest.approx(above + min(room), abs=2)


def test_as_far_as_asked():
    ground, _ = plane(0)
    path = fall_path.trace(disc(ground, (300, 600)), 800)
    assert path.end == fall_path.EVENTS and 800 < path.length[-1] < 1000


def test_a_pit():
    """Deeper than the slope is steep: over its rim and on, straight, as if there were none."""
    def height(x, y):
        return 3000 - STEEP * x - 250 * np.exp(-((x - 1200) ** 2 + (y - 600) ** 2) / (2 * 120 ** 2))
    mass = disc(terrain(height), (300, 600))
    path = fall_path.trace(mass, 1e5)
    assert mass.raster.z[60, 110:140].argmin() not in (0, 29)       # a pit, and not only a bump
    assert path.end == fall_path.TERRAIN and path.x[-1] == pytest.approx(2395, abs=5)
    assert path.length[-1] == pytest.approx(2395 - mass.crown[0], rel=0.01)


def test_the_lowest_way_out():
    """A dam across, with a gap on one side: the path goes through the gap, not over the dam."""
    def height(x, y):
        dam = 200 * np.exp(-((x - 1500) / 60) ** 2)
        return 3000 - STEEP * np.minimum(x, 1400) + np.where(y > 300, dam, 0)
    path = fall_path.trace(disc(terrain(height), (300, 600)), 1e5)
    assert np.interp(1500, path.x, path.y) < 300


def test_a_pit_in_a_pit():
    """Over the inner sill and the outer rim, not to and fro between both bottoms."""
    places, heights = (0, 1000, 1300, 1500, 1800, 2400), (3000, 2300, 2400, 2350, 2450, 2000)
    ground = terrain(lambda x, y: np.interp(x, places, heights) + 0.5 * np.abs(y - 600))
    path = fall_path.trace(disc(ground, (300, 600)), 1e5)
    assert path.end == fall_path.TERRAIN and path.x[-1] == pytest.approx(2395, abs=1)
    assert path.length[-1] == pytest.approx(2395 - path.x[0], rel=0.01)


def test_the_scar_leads():
    """The mass slides on its slip surface, which falls to one side here, the ground straight on."""
    ground, x, y = plane(0)[0]
    way_out = ground.z[60, 40] + 0.3 * ((405 - x) + (y - 495)) / math.sqrt(2)
    depth = np.where((x - 300) ** 2 + (y - 600) ** 2 < RADIUS ** 2, ground.z - way_out, 0)
    path = fall_path.trace(body.of_arrays(ground, depth, "disc"), 1e5)
    assert path.y[-1] < path.y[0] - 40


def test_a_flat():
    """Straight on, not to the nearest edge."""
    path = fall_path.trace(disc(terrain(lambda x, y: 3000 - STEEP * np.minimum(x, 1000)), (300, 700)), 1e5)
    assert path.x[-1] > 2380 and np.abs(path.y - 700).max() < 15
    assert path.length[-1] == pytest.approx(2395 - 155, rel=0.01)


def test_the_ground_ends():
    raster, x, y = plane(0)[0]
    raster.z[x > 1500] = np.nan
    path = fall_path.trace(disc((raster, x, y), (300, 600)), 1e5)
    assert path.end == fall_path.TERRAIN and path.x[-1] == pytest.approx(1495, abs=1)
    assert path.fall[-2:] == pytest.approx(STEEP * path.length[-2:], abs=1.5)


@pytest.mark.parametrize("factor", [1, 2])
def test_a_gully_narrower_than_the_mass(factor):
    """Is not followed, and the length does not depend on the cells: 10 and 5 m."""
    def height(x, y):
        return 3000 - STEEP * x - 6 * np.cos((y - 600 - 25 * np.sin(x / 40)) / 8) * (x > 600)
    ground = terrain(height, 240 * factor, 120 * factor, 10 / factor)
    path = fall_path.trace(disc(ground, (300, 600)), 1e5)
    assert path.length[-1] == pytest.approx(2395 - 155, rel=0.01)


def test_a_line_of_ones_own():
    ground, _ = plane(0)
    mass = disc(ground, (300, 600))
    path = fall_path.given(mass, LineString([(1500, 1100), (150, 600)]), "line")
    assert (path.x[0], path.end) == (150, fall_path.LINE) and path.length[-1] == pytest.approx(math.hypot(1350, 500))
    assert path.fall[-1] == pytest.approx(STEEP * (1500 - mass.crown[0]), abs=1)
    beyond = fall_path.given(mass, LineString([(150, 600), (5000, 600)]), "line")
    assert beyond.end == fall_path.TERRAIN and beyond.x[-1] == pytest.approx(2390, abs=10)
    with pytest.raises(SlopeError, match="line: must begin on the terrain"):
        fall_path.given(mass, LineString([(-100, 600), (-2000, 600)]), "line")


def test_level_ground_has_no_path():
    with pytest.raises(SlopeError, match="at least 1 degree.* flat"):
        fall_path.trace(disc(terrain(lambda x, y: 100 - 0.001 * x), (300, 600)), 1e5)


# --- the probabilities ---

def by_hand(path, volume, confined):
    """Exceedance at each point by the set's least squares and scipy's t, without the code that is tested."""
    if confined == "mixture":
        return (16 * by_hand(path, volume, True) + 33 * by_hand(path, volume, False)) / 49
    x = np.array([[1, math.log10(e.volume), math.log10(e.fall), e.confined] for e in ALL], float)
    y = np.log10([e.length for e in ALL])
    fit, squares, _, _ = np.linalg.lstsq(x, y, rcond=None)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.column_stack([np.ones(len(path.x)), np.full(len(path.x), math.log10(volume)), np.log10(path.fall),
                              np.full(len(path.x), confined)])
        scale = np.sqrt(squares[0] / 45 * (1 + (at @ np.linalg.inv(x.T @ x) * at).sum(axis=1)))
        return 1 - stats.t(45).cdf((np.log10(path.length) - at @ fit) / scale)


@pytest.fixture(scope="module")
def known():
    return known_events.compute_mobility(disc(hillside(), (300, 300)), SET)


@pytest.mark.parametrize("kind, confined", [("confined", True), ("unconfined", False), ("mixture", "mixture")])
def test_exceedance(known, kind, confined):
    far = known.path.fall >= 220        # the set's least
    assert (known.said == far).all()
    curve = known.curves[kind]
    assert curve[far] == pytest.approx(by_hand(known.path, known.volume, confined)[far], abs=1e-9)
    assert (curve[~far] == 1).all() and (np.diff(curve) <= 0).all()


def test_what_counts(known):
    assert known.chosen == "mixture" and (known.curves["confined"] >= known.curves["unconfined"]).all()
    least, mixture, most = (known.exceedance(1800, kind) for kind in ("unconfined", None, "confined"))
    assert most > mixture + 0.05 > least + 0.1
    for answer, kind in known_events.CONFINED.items():
        found = known_events.compute_known_mobility(disc(hillside(), (300, 300)), known_events.choice(confined=answer))
        assert found.decides is found.by_set and found.decides.chosen == kind
        assert found.decides.exceedance(1800) == pytest.approx(known.exceedance(1800, kind), abs=1e-3)


def test_it_never_rises():
    """Before a cliff the probability is less than by the height below the cliff."""
    mass = disc(terrain(lambda x, y: 3000 - STEEP * np.minimum(x, 700) - 900 / (1 + np.exp((1900 - x) / 15))),
                (200, 600))
    found = known_events.compute_mobility(mass, SET, "unconfined")
    raw = by_hand(found.path, found.volume, False)
    far = found.path.fall >= 220
    assert np.diff(raw[far]).max() > 0.1
    assert found.curves["unconfined"][far] == pytest.approx(np.minimum.accumulate(raw[far]), abs=1e-9)
    assert found.beyond_path() == pytest.approx(raw[far].min()) and raw[far].min() < raw[-1] - 0.1


def test_where_a_run_lies(known):
    median = known.length_at(0.5, "unconfined")
    assert known.exceedance(median, "unconfined") == pytest.approx(0.5, abs=1e-9)
    lies = known.where_lies(median, "unconfined")
    assert lies == pytest.approx((0.5, 0.5, False))
    assert known.where_lies(median, "confined").at_most < 0.5 and known.where_lies(1e5).beyond
    assert known.where_lies(0).at_least == 1
    assert known.length_at(1e-6, "confined") is None and known.in_range


@pytest.mark.parametrize("depth, slope, words", [(1.0, STEEP, ["volume, 3"]), (20.0, 0.05, ["height, "])])
def test_out_of_range(depth, slope, words):
    mass = disc(terrain(lambda x, y: 3000 - slope * x), (300, 600), depth)
    found = known_events.compute_mobility(mass, SET)
    assert not found.in_range and len(found.outside) == len(words)
    assert all(f"does not cover this {word}" in line for word, line in zip(words, found.outside))


def two_bodies(other):
    """A disc on the western flank of a valley that falls to the south, and a smaller one at another place."""
    ground = terrain(lambda x, y: 2000 + STEEP * np.abs(x - 1200) + 0.02 * y)
    first, second = (disc(ground, place, depth) for place, depth in (((400, 600), 20.0), (other, 15.0)))
    return first, body.of_arrays(ground[0], first.depth + second.depth, "two")


@pytest.mark.parametrize("other", [(2000, 600), (700, 200), (1000, 1000)])
def test_of_several_bodies_the_largest_has_the_path(other):
    """What lies between two bodies is neither's; both flanks of a valley together are level."""
    alone, both = two_bodies(other)
    one, path = (fall_path.trace(mass, 1e5) for mass in (alone, both))
    assert both.crown == alone.crown
    assert path.x[0] == pytest.approx(one.x[0]) and path.y[0] == pytest.approx(one.y[0])
    assert np.abs(path.y[path.x < 1000] - 600).max() < 60
    assert alone.beside() == []
    found, = both.beside()
    assert found.numbers["volume"] == pytest.approx(alone.volume) and found.numbers["all"] > 1.7 * alone.volume


def test_a_road(known):
    lane = box(1000, 0, 1020, 1190)
    ground = hillside()[0], known.width
    first = fall_path.at_road(known.path, lane, *ground)
    assert first.met and first.x == pytest.approx(1000) and first.length == pytest.approx(1000 - 155, abs=3)
    beside = fall_path.at_road(known.path, box(1000, 400, 1020, 590), *ground)
    assert not beside.met and beside.beside == pytest.approx(100, abs=3) and beside.x == pytest.approx(1010, abs=11)
    assert not beside.behind


def test_a_road_along_the_path():
    """The road beside the stream counts where the mass comes to it, not where it crosses the stream, or is nearest."""
    mass = disc(hillside(), (300, 300))
    ground = mass.raster
    found = known_events.compute_known_mobility(mass, known_events.choice()).decides
    width = mass.volume ** (1 / 3)
    for turn in (0, 7, 170):        # stays beside, comes nearer, crosses
        lane = LineString([(600, 370), (3000, 370), (3100, 370 - turn), (4000, 370 - turn)]).buffer(6)
        at = fall_path.at_road(found.path, lane, ground, width)
        assert not at.met and at.beside == pytest.approx(64, abs=1) and at.length < 600 - 155 + 2 * width + 10, turn
    straight = fall_path.at_road(found.path, LineString([(600, 370), (600, 300), (700, 200)]).buffer(6), ground, width)
    assert straight.met and straight.length == pytest.approx(600 - 6 - 155, abs=5)


@pytest.mark.parametrize("turn", [0, 90, 217])
@pytest.mark.parametrize("beside", [80, 150])
def test_a_valley_that_leads_back_comes_to_a_road(beside, turn):
    """Within the mass's width of 100 m, and farther away, whichever way the site lies."""
    line = LineString([(0, 0), (500, 0), (700, 300), (500, 600), (-900, 600)])
    lane = box(-400, 600 + beside, -390, 620 + beside)
    line, lane = (affinity.rotate(one, turn, origin=(0, 0)) for one in (line, lane))
    points = np.array([line.interpolate(at).coords[0] for at in np.arange(0, line.length, 10)])
    length = 10.0 * np.arange(len(points))
    path = fall_path.FallPath(*points.T, length, 0.3 * length, "", np.array([0, 0, 1000.0]))
    level = Raster(np.full((400, 400), 900.0), Affine(10, 0, -2000, 0, -10, 2000), None)
    at = fall_path.at_road(path, lane, level, 100.0)
    assert not at.met and not at.behind and at.beside == pytest.approx(beside, abs=5) and at.length > 1900
    assert fall_path.at_road(path, affinity.rotate(box(-60, -20, -40, 20), turn, origin=(0, 0)), level, 100.0).behind


@pytest.mark.parametrize("lane, behind", [
    (box(60, 10, 80, 590), True), (box(60, 500, 160, 590), True),       # beside the crown, on its level, too
    (Polygon([(40, 20), (60, 20), (160, 590), (140, 590)]), True),      # a rim askew
    (box(60, 500, 400, 590), False)])                                   # and down the slope beside the body
def test_a_road_behind_the_crown(lane, behind):
    """The mass goes away from it: no known event says that it is reached."""
    mass = disc(hillside(), (300, 300))
    among = known_events.Known(known_events.compute_known_mobility(mass, known_events.choice()), "", mass)
    counts = among.found.decides
    at = fall_path.at_road(counts.path, lane, mass.raster, counts.width)
    events = how_far.compute_events_at_road(among, lane)
    assert at.behind == behind and (events.behind, max(events.reached) > 0.5) == ((at.beside, False) if behind else
                                                                                  (0.0, True))
    told = results.at_road(among.found, at)
    assert (told["at_least"] is None and told["exceedance_landslides"] is None) == behind


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("bearing", [0, 90, 217])
def test_a_flank_of_a_wide_body_comes_to_a_road_before_its_middle(bearing, side):
    """A road that runs down across the slope, 100 m below one flank and 500 m below the middle."""
    (ground, x, y), down = plane(bearing)
    across, middle = side * np.array([-down[1], down[0]]), np.array([1200.0, 600.0])
    left, below = ((np.stack([x, y], axis=-1) - middle) @ way for way in (across, down))
    mass = body.of_arrays(ground, 3.0 * ((abs(left) < 400) & (abs(below) < 50)), "wide")
    found = known_events.compute_known_mobility(mass, known_events.choice())
    counts, among = found.decides, known_events.Known(found, "", mass)
    ends = ([middle + 400 * at * across + (150 + 400 * (1 - at)) * down for at in (1.1, -1.1)])
    lane = LineString(ends).buffer(8)
    alone = fall_path.at_road(counts.path, lane, ground, counts.width)
    assert alone.met and alone.length == pytest.approx(600, abs=20)
    events = how_far.compute_events_at_road(among, lane)
    strip = counts.width / 2        # half of it lies between the flank and the middle of its strip
    assert 200 - 20 < events.near < 200 + strip + 20
    assert events.reached == pytest.approx(counts.shares(events.near), abs=0.01)
    assert min(events.reached) > max(counts.shares(alone.length)) + 0.03
    for end in (550, 1e5):          # on the terrain, and beyond
        drawn = fall_path.given(mass, LineString([middle - 50 * down, middle + end * down]), "line")
        by_line = known_events.compute_known_mobility(mass, known_events.choice(), drawn)
        way = known_events.way_to_road(mass, by_line, lane)
        assert way.own and way.at.length == pytest.approx(600, abs=20)


def to_road(mass, lane):
    """The Way of a body to a road, the shares along it, and those at its length along the path of the mass."""
    found = known_events.compute_known_mobility(mass, known_events.choice())
    way = known_events.way_to_road(mass, found, lane)
    return way, way.mobilities.decides.shares(way.at.length), found.decides.shares(way.at.length)


def test_the_share_at_a_road_is_of_the_path_that_leads_there():
    """Below one half of the body the ground falls 0.75, below the other, where its path goes down, 0.25."""
    ground, x, y = terrain(lambda x, y: 1000 - (0.25 + 0.5 / (1 + np.exp(-(y - 800) / 30))) * np.maximum(x - 350, 0)
                           - 0.4 * np.minimum(x, 350))
    mass = body.of_arrays(ground, 3.0 * ((abs(x - 300) < 50) & (abs(y - 600) < 400)), "both")
    for lane in (LineString([(700, 900), (700, 1200)]), LineString([(700, 0), (700, 1200)])):
        way, shares, along = to_road(mass, lane.buffer(8))
        assert way.at.met and not way.own and max(along) < 0.5 and min(shares) > 0.7


def test_parts_of_a_mass_are_the_large_ones_the_largest_first():
    ground, x, y = terrain(lambda x, y: 1000 - 0.5 * x)
    crumbs = 0.1 * ((x // 10 % 2 == 0) & (y // 10 % 2 == 0) & (x > 1000))     # thousands of cells that do not touch
    large, small = (3.0 * ((abs(x - 300) < half) & (abs(y - at) < half)) for at, half in ((300, 100), (700, 60)))
    first, *others = body.of_arrays(ground, crumbs + small + large, "parts").parts
    assert (first.depth == large).all() and [(one.depth == small).all() for one in others] == [True]


def test_a_body_of_one_row_of_cells_has_no_strips(recwarn):
    ground, x, y = terrain(lambda x, y: 1000 - 0.5 * x)
    mass = body.of_arrays(ground, 3.0 * ((abs(x - 300) < 100) & (abs(y - 605) < 5)), "row")
    assert to_road(mass, box(700, 0, 720, 1190))[0].own and not recwarn.list


def test_a_strip_goes_on_where_the_path_has_left_the_terrain():
    """The middle falls off a terrain that has a hole below it, the flank comes to a road beyond."""
    ground, x, y = terrain(lambda x, y: 1000 - 0.5 * x)
    ground.z[(x > 500) & (abs(y - 600) < 150)] = np.nan
    mass = body.of_arrays(ground, 3.0 * ((abs(x - 300) < 50) & (abs(y - 600) < 400)), "wide")
    way, shares, _ = to_road(mass, LineString([(1000, 900), (1000, 1200)]).buffer(8))
    assert way.at.met and way.at.length == pytest.approx(742, abs=20)
    assert min(shares) > 0.75


@pytest.mark.parametrize("near, wide", [(300, 60), (1000, 60), (1000, 15)])
def test_the_smaller_of_two_bodies_comes_to_a_road(near, wide):
    """The fall path of the larger stays away from it; of either the road counts that to which most events come."""
    ground, x, y = terrain(lambda x, y: 1000 - 0.5 * x)
    large, small = (3.0 * ((abs(x - at) < 50) & (abs(y - middle) < half))
                    for at, middle, half in ((300, 250, 100), (700, near, wide)))
    mass = body.of_arrays(ground, large + small, "two")
    lane = LineString([(900, near - 100), (900, near + 100)]).buffer(8)
    way, shares, along = to_road(mass, lane)
    assert not way.own and way.at.met and way.at.length == pytest.approx(242, abs=20)
    alone = to_road(body.of_arrays(ground, small, "small"), lane)
    assert min(shares) >= min(alone[1]) > 0.6       # of the volume of both
    events = how_far.compute_events_at_road(known_events.Known(
        known_events.compute_known_mobility(mass, known_events.choice()), "", mass), lane)
    assert (events.near, events.reached) == (way.at.length, shares)


def test_the_strips_of_a_body_across_a_valley_come_to_its_stream():
    """They do not go on side by side, where a road lies beside the stream and above it."""
    ground, x, y = terrain(lambda x, y: 1000 - 0.2 * x + 0.4 * abs(y - 600))
    mass = body.of_arrays(ground, 3.0 * ((abs(x - 300) < 50) & (abs(y - 600) < 200)), "across")
    paths = list(fall_path.trace_strips(mass, 50.0, 2000.0))
    assert len(paths) == 8 and np.ptp([path.y[0] for path in paths]) > 300
    assert max(abs(np.interp(1200, path.x, path.y) - 600) for path in paths) < 10
    assert to_road(mass, box(1200, 740, 1300, 750))[0].at.beside > 130


@pytest.mark.skipif(not FRANK.is_dir(), reason="the rasters of inputs/30_frank are not here")
def test_the_frank_slide():
    """By all events but itself, what was observed is inside of 10 to 90 %, along the river and across the valley."""
    after, pile = (rasters.read_raster(FRANK / f"Frankslide_{name}.asc") for name in ("topography", "pile"))
    mass = body.of_arrays(after._replace(z=after.z + pile.z), pile.z, "Frank")
    others = [one for one in ALL if one.name != "Frank Slide"]
    across = fall_path.given(mass, LineString([(413, 1264), (3960, 3633)]), "line")
    for path in (None, across):
        found = known_events.compute_mobility(mass, events.fit_relation(others), "unconfined", path)
        assert found.in_range and found.volume == pytest.approx(36.0, abs=0.1)
        assert 0.1 < found.exceedance(3080) < 0.9
    assert found.length_at(0.5) == pytest.approx(3080, rel=0.05)


# --- the command ---

@pytest.fixture
def place(here, capsys, monkeypatch):
    """terrain.asc, a plane; P, a disc on it; gives a call of slope mobility that draws no pictures."""
    for name in ("draw_map", "draw_profile"):
        monkeypatch.setattr(charts, name, lambda path, *rest: Path(path).write_bytes(b""))
    write_asc("terrain.asc", hillside()[0].z, 10.0)
    write_geojson("p.geojson", Point(300, 300).buffer(RADIUS))
    Path("road.wkt").write_text("POLYGON ((1500 0, 1520 0, 1520 590, 1500 590, 1500 0))")
    return lambda words: run_command("mobility", words, capsys)


BODY = "terrain.asc --polygon p.geojson --local --depth 20"
KINDS = ["confined", "unconfined", "mixture", "landslides_narrow", "landslides_wide", "landslides"]
COLUMNS = ["length_m", "height_m", "elevation_m", "x", "y", *(f"exceedance_{kind}" for kind in KINDS)]


def rows(folder="out"):
    found = rows_of(Path(folder, "mobility.csv"))
    return list(found[0]), {key: np.array([float(row[key] or "nan") for row in found]) for key in found[0]}


def summary(folder="out"):
    return yaml.safe_load(Path(folder, "mobility.yaml").read_text(encoding="utf-8"))


def test_command(place):
    status, out, err = place(f"{BODY} --road road.wkt -o out")
    assert (status, err) == (0, "")
    heads, both = rows()
    assert heads == COLUMNS
    about = summary()
    assert about["in_range"] and about["exceedance_is"] == "mixture" and about["set"]["events"] == 49
    at = about["road"]
    assert at["on_path"] and at["x"] == pytest.approx(1500) and at["passed_m"] - at["length_m"] == pytest.approx(20)
    for kind in KINDS:
        for name, length in (("exceedance", "length_m"), ("passed", "passed_m")):
            share = np.interp(at[length], both["length_m"], both[f"exceedance_{kind}"])
            assert at[f"{name}_{kind}"] == pytest.approx(share, abs=1e-4)
        assert about[kind]["beyond_path"] == pytest.approx(both[f"exceedance_{kind}"][-1], rel=1e-5)
    assert at["exceedance"] == at["exceedance_mixture"] > at["passed"] == at["passed_mixture"]
    crown = about["crown"]
    assert both["elevation_m"] == pytest.approx(crown["z"] - both["height_m"], abs=2e-3) and "elevation" in out
    assert {path.name for path in Path("out").iterdir()} == set(about["files"])
    for words, kind in (("--unconfined", "unconfined"), ("--confined", "confined"), ("--confined no", "unconfined"),
                        ("--confined unknown", "mixture"), ("--confined yes", "confined")):
        place(f"{BODY} {words} --road road.wkt --overwrite -o other")
        other = summary("other")
        assert other["exceedance_is"] == kind and other["road"]["exceedance"] == at[f"exceedance_{kind}"]


def test_the_path_for_a_gis(tmp_path):
    """A piece to each point of the table, in the CRS of the terrain."""
    mass = disc(hillside(), (300, 300))
    there = mass._replace(raster=mass.raster._replace(crs=CRS.from_epsg(6677), offset=(1000.0, -2000.0)))
    found = known_events.compute_known_mobility(there, known_events.choice())
    results.write_lines(tmp_path / "path.gpkg", found, there)
    path, shares = found.decides.path, found.decides.curves["mixture"]
    with fiona.open(tmp_path / "path.gpkg", layer="path") as layer:
        pieces = list(layer)
        assert CRS.from_wkt(layer.crs_wkt) == there.raster.crs
    assert len(pieces) == len(path.x) - 1
    for k in (0, len(pieces) // 2, len(pieces) - 1):
        end = pieces[k]["geometry"]["coordinates"][1]
        assert end == pytest.approx((path.x[k + 1] + 1000, path.y[k + 1] - 2000))
        share = pieces[k]["properties"]["exceedance_mixture"]
        assert share == (pytest.approx(shares[k + 1]) if found.decides.said[k + 1] else None)


def test_except(place):
    status, _, err = place(f"{BODY} --unconfined --except 'Frank Slide' --except 'Todagin Creek' -o out")
    assert (status, err) == (0, "")
    about = summary()
    assert about["set"]["events"] == 47 and about["set"]["left_out"] == ["Frank Slide", "Todagin Creek"]
    assert about["relation"]["degrees_of_freedom"] == 43


def test_out_of_range_is_said(place):
    status, _, err = place("terrain.asc --polygon p.geojson --local --depth 0.5 -o out")
    about = summary()
    assert status == 0 and about["in_range"] is False and err.count("\n") == len(about["warnings"]) == 1
    assert "the set of known events does not cover this volume" in err and "0.1 to 498" in err
    assert about["mixture"] is None and about["exceedance_is"] == "landslides"
    _, both = rows()
    assert all(np.isnan(both[f"exceedance_{kind}"]).all() for kind in KINDS[:3])
    assert np.isfinite(both["exceedance_landslides"][-1]) and np.isnan(both["exceedance_landslides"][0])


def test_a_terrain_that_is_too_small(place):
    write_asc("terrain.asc", hillside()[0].z[:, :100], 10.0)
    status, _, err = place(f"{BODY} --confined -o out")
    assert status == 0 and "leaves the terrain after 84" in err and "larger terrain" in err
    assert summary()["confined"]["lengths_m"]["0.5"] is None and summary()["confined"]["beyond_path"] > 0.5


def of_site(folder="site"):
    """A folder as slope site makes it, as far as it counts here."""
    Path(folder).mkdir()
    shutil.copy("terrain.asc", folder)
    mass = body.of_release(release.body_of(release.Wanted("terrain.asc", "p.geojson", depth=20, local=True)), "p")
    write_asc(f"{folder}/release.depth.asc", np.where(mass.depth > 0, mass.depth, np.nan), 10.0)
    Path(folder, "site.yaml").write_text("slope_site: 1\nterrain: {files: [dem.tif]}\nrelease: {polygon: p.geojson}\n")
    Path(folder, "road.csv").write_text("1500,0\n1520,0\n1520,590\n1500,590\n")
    return folder


def test_a_site(place):
    """The folder's terrain, body and road; the same as from the terrain."""
    place(f"{BODY} --road road.wkt -o out")
    status, _, err = place(f"{of_site()} -o site/known")
    assert (status, err) == (0, "")
    for key, values in rows()[1].items():
        assert rows("site/known")[1][key] == pytest.approx(values, abs=1e-3, nan_ok=True)
    assert summary("site/known")["road"] == pytest.approx(summary()["road"], abs=1e-4)
    status, _, err = place("site --depth 3 -o other")
    assert status == 2 and "site: is the folder of a site" in err and err.count("\n") == 1


HEAD = "name,fall_m,length_m,volume_Mm3,confinement\n"


@pytest.mark.parametrize("text, more, words", [
    (HEAD + "".join(f"{name},900,2000,1,lateral\n" for name in "ABC"), "", ("at least 12", "got 3")),
    (None, "--except Nowhere", ("--except", "Nowhere")),
    (None, "--path road.wkt", ("road.wkt",)),
    (None, "--road none.wkt", ("none.wkt", "existing")),
    (None, "--confined --unconfined", ("--confined",)),
    (None, "--confined perhaps", ("--confined", "perhaps", "unknown")),
    (None, "--known landslips", ("--known", "TYPE[:PATH]", "landslips")),
    (None, "--known rockfalls:deflected:all", ("--known", "rockfalls:deflected:all")),
    (None, "--known rockfalls --except X", ("--except", "X")),
])
def test_bad_input_is_one_line(place, text, more, words):
    if text:
        Path("set.csv").write_text(text, encoding="utf-8")
        more += " --set set.csv"
    status, _, err = place(f"{BODY} {more} -o out")
    assert status == 2 and err.count("\n") == 1 and all(word in err for word in words), err
    assert not Path("out").exists()


@pytest.mark.parametrize("command", examples("mobility"))
def test_every_example_of_the_page_and_the_help_runs(place, command):
    write_geojson("release.geojson", Point(300, 300).buffer(RADIUS))
    write_geojson("road.geojson", box(1500, 0, 1520, 590))
    shutil.copy("terrain.asc", "before.asc")
    shutil.copytree(of_site(), "mine")
    write_asc("after.asc", hillside()[0].z - disc(hillside(), (300, 300)).depth, 10.0)
    local = " --local" * ("geojson" in command)       # the files of these tests have no CRS
    status, out, err = place(command + local)
    assert (status, err) == (0, "") and ("--help" in command or "crown at" in out)


@pytest.mark.drawn
def test_pictures(known, tmp_path):
    """Drawn from what is there: with a road, and of a mass that no set covers."""
    mass = disc(hillside(), (300, 300))
    lane = box(1000, 0, 1020, 1190)
    charts.draw_map(tmp_path / "map.png", known, mass, lane, known_events.Way(None, known_events.Found(None, known),
                                                                              False))
    found = known_events.compute_known_mobility(mass, known_events.choice(), known.path)
    out = found._replace(by_set=found.by_set._replace(outside=["x"]))
    at = fall_path.at_road(known.path, lane, mass.raster, known.width)
    charts.draw_profile(tmp_path / "profile.png", out, mass, known_events.Way(at, found, False))
    assert all((tmp_path / name).read_bytes()[:4] == b"\x89PNG" for name in ("map.png", "profile.png"))
