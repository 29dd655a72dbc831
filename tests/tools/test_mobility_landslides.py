"""Landslides of all sizes: the rows, both scatters, and that they and the set give way to each other without a jump."""
import math

import numpy as np
import pytest
from affine import Affine
from scipy import stats
from shapely.geometry import box

from run_helpers import TOP
from test_mobility_path import RADIUS, STEEP, disc, hillside, terrain

from slope_tools.digits import three
from slope_tools.errors import SlopeError
from slope_tools.mobility import body, events, fall_path, known, lucas, offices, results
from slope_tools.releases import release
from slope_tools.survey import rasters

EMBANKMENT = TOP / "inputs" / "20_embankment"
ROW = events.choose_landslide_row()


def test_the_rows():
    rows = events.read_landslides()
    assert len(rows) == 13 and sum(row.events for row in rows if row.path == "all") == 204
    assert {row.type for row in rows} == set(events.TYPES) and {row.path for row in rows} >= {"all", "channelized"}
    assert ROW[:7] == ("translational_slides", "all", 69, -0.159, -0.068, 0.435, 0.67)


@pytest.mark.parametrize("text, found", [
    ("rockfalls", ("rockfalls", "all")), ("debris flows:Channelised", ("debris_flows", "channelized")),
    ("trans:unob", ("translational_slides", "unobstructed")), ("earth", ("earthflows_and_mudslides", "all"))])
def test_a_name(text, found):
    assert events.choose_landslide_row(text)[:2] == found


@pytest.mark.parametrize("text", ["", "slides", "rock:", "rockfalls:channelized", "earth:obstructed", "rocks:all:x"])
def test_no_name(text):
    with pytest.raises(SlopeError, match="--known: must be"):
        events.choose_landslide_row(text)


@pytest.mark.parametrize("text, half, twentieth", [
    ("translational", 108, 295), ("translational:unobstructed", 119, 322)])
def test_the_embankment(text, half, twentieth):
    """49,000 m3 that fall 36 m, by hand."""
    row = events.choose_landslide_row(text)
    assert row.farthest(0.5, 0.049, 36) == pytest.approx(half, abs=0.5)
    assert row.farthest(0.95, 0.049, 36) == pytest.approx(twentieth, abs=0.5)
    for share in (0.01, 0.05, 0.3, 0.5, 0.8, 0.99):
        assert row.beyond("landslides", row.farthest(share, 0.01, 20), 0.01, 20) == pytest.approx(1 - share)


def test_both_scatters():
    """The one of the limit and the one of R2; the larger probability counts, on either side of the median."""
    assert ROW.deviations == pytest.approx((0.0954, 0.2644), abs=1e-4)
    assert all(row.deviations[0] < row.deviations[1] for row in events.read_landslides())
    assert events.choose_landslide_row("rockfalls:ob").deviations == pytest.approx(
        (0.0626, 0.0824), abs=1e-4)     # R2's is larger
    length, volume, fall = np.array([60.0, 300.0]), 0.049, 36.0
    for kind, deviation in (("landslides_narrow", 0.095446), ("landslides_wide", 0.264438)):
        scores = (np.log10(fall / length) + 0.159 + 0.068 * math.log10(49000)) / deviation
        assert ROW.beyond(kind, length, volume, fall) == pytest.approx(stats.norm.cdf(scores), abs=1e-5)
    narrow, wide = (ROW.beyond(kind, length, volume, fall) for kind in ROW.kinds[:2])
    near, far = ROW.beyond("landslides", length, volume, fall)
    assert near == narrow[0] > wide[0] and far == wide[1] > narrow[1]


# --- a second opinion ---

def test_friction_falls_with_the_volume():
    """11,000 m3: 25.9 degrees, 95 % between 19.8 and 33.3, as published."""
    shares = 0.5, 0.025, 0.975
    assert [math.degrees(math.atan(lucas.friction(11000, one))) for one in shares] == pytest.approx(
        [25.9, 19.8, 33.3], abs=0.06)
    assert lucas.friction(1e6) == pytest.approx(1e6 ** -0.0774) and lucas.friction(1e8) < lucas.friction(1e6)


def test_the_line_from_the_crown_comes_out_where_a_slope_and_a_flat_have_it():
    """100 m down at 45 degrees, then a flat: H / mu; steeper than the slope at the toe; beyond the path nowhere."""
    length = np.linspace(0, 400, 401)
    path = fall_path.FallPath(length, 0 * length, length, np.minimum(length, 100.0), fall_path.TERRAIN, (0, 0, 100))
    path = path._replace(length=length[20:], fall=path.fall[20:])
    assert lucas.reach(path, 0.4) == pytest.approx(250) and lucas.reach(path, 0.33) == pytest.approx(100 / 0.33)
    assert lucas.reach(path, 1.1) == 20 and lucas.reach(path, 0.2) is None


@pytest.mark.parametrize("moved, farther", [(0.0, None), (-1.2, "the events"), (1.2, "that law's masses")])
def test_where_the_two_have_nothing_in_common_a_warning_says_so(moved, farther):
    """Of a row whose line lies where it does, and far above and below it, with a small scatter."""
    mass = gentle()
    row = ROW._replace(a=ROW.a + moved, limit=0.1, r2=0.97)
    found = known.Found(None, known.compute_mobility(mass, row))
    said = lucas.opinion(mass, found.decides.path)
    assert said.steep > said.angle > said.flat and said.toe > 0
    assert [(one.kind, one.numbers["farther"]) for one in results.disagreement(mass, found)] == (
        [("second opinion", farther)] if farther else [])
    assert f"{said.angle:.1f} degrees" in results.second_opinion(mass, found)


# --- on a path ---

def gentle(depth=1.0):
    """A hill of 90 m above a flat, and a small body, of 0.04 million m3 for 1 m, on it."""
    ground = terrain(lambda x, y: 1000 - STEEP * np.clip(x - 240, 0, 180) - 0.001 * x, 300, 60)
    return disc(ground, (260, 300), depth)


def test_it_begins_at_the_toe_and_never_rises():
    mass = gentle()
    found = known.compute_known_mobility(mass, known.choice())
    assert found.decides is found.by_row and found.by_set is not None and not found.by_set.in_range
    one, path = found.by_row, found.by_row.path
    beyond = fall_path.from_toe(mass, path)
    toe = int(np.searchsorted(path.length, beyond.length[0]))
    assert path.length[toe - 1] < beyond.length[0] < path.length[toe] and (beyond.length[1:] == path.length[toe:]).all()
    assert beyond.x[0] == pytest.approx(260 + RADIUS, abs=15) and path.fall[toe - 1] < beyond.fall[0] < path.fall[toe]
    assert beyond.length[0] == lucas.opinion(mass, path).toe == offices.slope(mass, path).toe       # one for all
    for kind, curve in one.curves.items():
        assert (curve[:toe] == 1).all() and (np.diff(curve) <= 0).all()
        raw = ROW.beyond(kind, path.length[toe:], one.volume, path.fall[toe:])
        assert curve[toe:] == pytest.approx(np.minimum.accumulate(raw))
    crest = ROW.beyond("landslides_wide", path.length[1:toe], one.volume, np.maximum(path.fall[1:toe], 0.1))
    assert crest.min() < 0.5 * one.curves["landslides_wide"][toe]       # what a running minimum from there would keep
    assert not one.said[:toe].any() and one.said[toe:].all()


def test_at_most_where_the_curve_begins_below_a_share():
    """From 1 before the toe it falls by what nobody knows: no length between two points, but the one it begins at."""
    found = known.compute_known_mobility(gentle(), known.choice())
    one = found.by_row
    toe = float(one.path.length[np.flatnonzero(one.said)[0]])
    for kind, curve in one.curves.items():
        for share in results.SHARES:
            at, length = one.at_most(share, kind), one.length_at(share, kind)
            if share > curve[one.said][0]:
                assert at == toe and one.path.length[np.flatnonzero(one.said)[0] - 1] < length < toe
            else:
                assert at is None and (length is None or length >= toe)
    told = results.of_events(one)["landslides_wide"]
    assert one.curves["landslides_wide"][one.said][0] < 0.9
    assert told["lengths_m"]["0.95"] is None and told["at_most_m"]["0.95"] == toe
    assert told["lengths_m"]["0.1"] == one.length_at(0.1, "landslides_wide") and told["at_most_m"]["0.1"] is None
    text = results.lengths(one, "landslides_wide")
    assert text.startswith(f"95 % beyond {three(toe)} m or less, 90 % beyond {three(toe)} m or less, ")
    assert f"10 % beyond {three(one.length_at(0.1, 'landslides_wide'))} m" in text


def test_both_scatters_at_an_edge():
    """Of a row the smaller and the larger; of a set twice what counts; before the toe what holds there."""
    one = known.compute_known_mobility(gentle(), known.choice()).by_row
    length = one.length_at(0.2)
    assert one.shares(length) == tuple(sorted(float(one.exceedance(length, kind)) for kind in one.law.both))
    assert one.shares(length)[0] < one.shares(length)[1] == pytest.approx(one.exceedance(length))
    first = float(one.path.length[np.flatnonzero(one.said)[0]])
    assert one.shares(0.5 * first) == one.shares(first) and one.shares(first)[1] < 1
    large = known.compute_known_mobility(disc(hillside(), (300, 300)), known.choice())
    near, (narrow, wide) = large.by_row.length_at(0.8), large.by_row.law.both
    assert large.by_row.exceedance(near, narrow) > large.by_row.exceedance(near, wide)      # nearer than the median
    assert large.by_row.shares(near)[0] == large.by_row.exceedance(near, wide) < large.by_row.shares(near)[1]
    by_set = large.by_set
    share = float(by_set.exceedance(1500.0))
    assert by_set.shares(1500.0) == (share, share) and 0 < share < 1


def test_what_withholds_a_number():
    """A set that covers the mass, or a row that was asked for; not the landslides that stand for the set."""
    small, large = gentle(), disc(hillside(), (300, 300))
    assert known.compute_known_mobility(small, known.choice()).strict is None
    assert known.compute_known_mobility(small, known.choice("rockfalls")).strict.law.type == "rockfalls"
    assert known.compute_known_mobility(large, known.choice()).strict.law.kinds[-1] == "mixture"
    asked = known.choice("rockfalls", confined="no")
    assert known.of_about(asked.about()) == asked and known.of_about({}) == known.choice()


def test_a_set_says_nothing_of_falls_that_none_of_its_events_had():
    """On a hill of 210 m: no point has a fall of the set. On one of 240 m: not before it."""
    for height, covered in ((210, False), (260, True)):
        ground = terrain(lambda x, y: 1000 - STEEP * np.clip(x, 0, 2 * height), 300, 60)
        found = known.compute_known_mobility(disc(ground, (200, 300)), known.choice())
        one = found.by_set
        assert one.in_range == covered == (found.decides is one)
        assert (one.path.fall[one.said] >= 220).all() and one.said.any() == covered
        if covered:
            assert (one.curves["mixture"][:np.flatnonzero(one.said)[0]] == 1).all()
        else:
            assert "220 to 1720" in one.outside[-1] and not one.says(one.path.length[-1])


def test_half_of_them_end_before_any_fall_of_the_set():
    """A path that falls far, but slowly: where the set begins, hardly any event arrives."""
    ground = terrain(lambda x, y: 1000 - 0.06 * x, 500, 60)
    found = known.compute_known_mobility(disc(ground, (300, 300)), known.choice())
    assert found.by_set.said.any() and not found.by_set.in_range and "cover this height" in found.by_set.outside[0]


def test_a_row_that_is_asked_for():
    found = known.compute_known_mobility(gentle(20.0), known.choice("debris flows:channelized"))
    assert found.by_set is None and found.decides.law is not ROW and found.decides.law.path == "channelized"


# --- the embankment, 0.1 to 10 times as large ---

WEST = 600      # cells of gentle fields are added, so that the path is long enough


def embankment(factor):
    raster = rasters.read_asc_local(EMBANKMENT / "terrain.asc")
    files = (str(EMBANKMENT / name) for name in ("terrain.asc", "release.csv"))
    mass = body.of_release(release.body_of(release.Wanted(*files, "slbl", 6.0, local=True)), "slbl")
    fields = np.repeat([-4 + 0.1 * (np.arange(-WEST, 0) + 0.5)], len(raster.z), axis=0)
    wide = raster._replace(z=factor * np.hstack([fields, raster.z]),
                           transform=Affine(2.5 * factor, 0, -2.5 * WEST * factor, 0, -2.5 * factor, 160 * factor))
    return body.of_arrays(wide, factor * np.hstack([np.zeros_like(fields), mass.depth]), "slbl")


def numbers(one, factor):
    """Lengths (m over the factor) that half and a twentieth go beyond."""
    return [one.length_at(share) / factor for share in (0.5, 0.05)]


def test_the_family_of_the_embankment():
    """Never more farther down; the set takes over once, by less than the narrower band of 90 %."""
    which = {}
    for factor in np.geomspace(0.1, 10, 9):
        found = known.compute_known_mobility(embankment(factor), known.choice())
        which[factor] = found.decides.chosen
        assert all((np.diff(curve) <= 0).all() for one in found.each for curve in one.curves.values())
        lane = fall_path.at_road(found.decides.path, box(60 * factor, 0, 80 * factor, 160 * factor),
                                 embankment(factor).raster, found.decides.width)
        assert lane.met and lane.passed - lane.length == pytest.approx(20 * factor, rel=0.01)
    assert [*which.values()] == ["landslides"] * 7 + ["mixture"] * 2
    low, high = max(f for f, kind in which.items() if kind == "landslides"), min(
        f for f, kind in which.items() if kind == "mixture")
    for _ in range(6):      # where it takes over
        middle = math.sqrt(low * high)
        covered = known.compute_known_mobility(embankment(middle), known.choice()).by_set.in_range
        low, high = (low, middle) if covered else (middle, high)
    before, after = (known.compute_known_mobility(embankment(f), known.choice()).decides for f in (low, high))
    assert {before.chosen, after.chosen} == {"landslides", "mixture"} and high < 1.02 * low
    bands = [math.log10(one.length_at(0.05) / one.length_at(0.95)) for one in (before, after)]
    jumps = [abs(math.log10(b / a)) for a, b in zip(numbers(before, low), numbers(after, high))]
    assert max(jumps) < min(bands), (jumps, bands)


def test_the_volume_where_the_set_begins():
    """0.1 million m3 on a hill that is high enough."""
    found = []
    for depth in (2.82, 2.84):
        mass = disc(hillside(), (300, 300), depth)
        found.append(known.compute_known_mobility(mass, known.choice()).decides)
    before, after = found
    assert (before.chosen, after.chosen) == ("landslides", "mixture")
    bands = [math.log10(one.length_at(0.05) / one.length_at(0.95)) for one in found]
    jumps = [abs(math.log10(after.length_at(share) / before.length_at(share))) for share in (0.5, 0.05)]
    assert max(jumps) < min(bands), (jumps, bands)


def test_at_the_road_that_lies_too_high():
    """A fall that no event of the set had: at least what they say farther down."""
    mass = disc(hillside(), (300, 300))
    found = known.compute_known_mobility(mass, known.choice())
    at = fall_path.at_road(found.decides.path, box(500, 0, 520, 600), mass.raster, found.decides.width)
    told = results.at_road(found, at)
    assert at.fall < 220 and told["exceedance"] is None and told["at_least"] == pytest.approx(
        found.decides.exceedance(found.decides.path.length[np.flatnonzero(found.decides.said)[0]]))
    assert told["exceedance_landslides"] == known.compute_mobility(mass, ROW,
                                                                   path=found.by_row.path).exceedance(at.length)
