"""sink H of fix wall/gran/balls and create_balls: centres H below a surface; beyond the rim of a body they go on to the
ground, and balls outside of the body leave room for them."""

import math
import re

import numpy
import pytest
from matplotlib.path import Path
from scipy.interpolate import RegularGridInterpolator
from scipy.spatial import cKDTree

from deck_helpers import left_out, run_deck, write_asc

SLOPE = math.tan(math.radians(28))      # of the ground, up along x; it is level beyond the toe at x = 14
CENTRE, RADIUS = numpy.array([26.0, 20.0, 12.0]), 12.0

# a slip sphere in that ground, 6 m deep, and a pit with walls
DECK = """
units       si
atom_style  sphere
boundary    s s fs
comm_modify vel yes
region      ground terrain ground.asc depth 12 headroom 10
region      sphere sphere 26 20 12 12 units box
region      slip intersect 2 ground sphere
region      prism polygon release.csv
region      bed terrain bed.asc depth 12 side out
region      pit intersect 3 ground prism bed
region      both union 2 slip pit
create_box  3 ground
lattice     sc {d}
create_atoms 1 region {body}
group       soil type 1
set         group soil diameter {d} density 2500
pair_style  gran/restitution
pair_coeff  * * stiffness 1e7 1e7 restitution 0.4 friction 25
{fixes}
"""
SLIP = "fix slip soil wall/gran/balls 2 {d} surface slip lower spacing {half} sink {sink} write slip.xyz\n"
FIELD = ("fix field soil wall/gran/balls 3 {field} surface ground upper spacing {field} outside {outside} "
         "write field.xyz\n")
DELETE = "delete_balls soil overlap 0.0\n"


def ground(x):
    return numpy.maximum(0.0, (x - 14.0) * SLOPE)


def prepare(tmp_path):
    x = numpy.arange(100) * 0.5 + 0.25
    heights = numpy.tile(ground(x), (120, 1))
    write_asc(tmp_path / "ground.asc", heights, cell=0.5)
    write_asc(tmp_path / "bed.asc", heights - 3.0, cell=0.5)
    (tmp_path / "release.csv").write_text("30.3,42.2\n40,40.1\n41.2,48\n33,49.2\n")


def place(tmp_path, fixes=SLIP + FIELD + DELETE, body="slip", d=2.0, sink=None, field=None, outside="slip", np=1):
    """Log and fixed balls (of slip, of field) of a deck that sets up and does not run."""
    values = {"d": d, "half": d / 2, "sink": d if sink is None else sink, "field": field or d, "outside": outside}
    prepare(tmp_path)
    log = run_deck(DECK.format(fixes=fixes.format(**values), body=body, **values), tmp_path, np=np)
    return log, read(tmp_path / "slip.xyz"), read(tmp_path / "field.xyz")


def read(path):
    return numpy.loadtxt(path, ndmin=2) if path.exists() else None


def on_nodes(log, balls):
    """The balls on the plan grid, which come first."""
    return balls[:int(re.search(r"balls slip: \d+ fixed balls of diameter \S+ \((\d+) on the plan grid", log)[1])]


def columns(pitch=0.2):
    """Columns of the sphere's body: x, y, bottom, top."""
    x, y = (a.ravel() for a in numpy.meshgrid(numpy.arange(0, 50, pitch), numpy.arange(0, 40, pitch)))
    under = RADIUS**2 - (x - CENTRE[0]) ** 2 - (y - CENTRE[1]) ** 2
    bottom = CENTRE[2] - numpy.sqrt(numpy.maximum(under, 0.0))
    inside = (under > 0) & (bottom < ground(x))
    return x[inside], y[inside], bottom[inside], ground(x)[inside]


def closest(balls):
    """The smallest distance of a fixed centre to a point of the sphere's body."""
    x, y, bottom, top = columns()
    nearest = math.inf
    for ball in balls:
        dz = ball[2] - numpy.clip(ball[2], bottom, top)
        nearest = min(nearest, ((x - ball[0]) ** 2 + (y - ball[1]) ** 2 + dz**2).min())
    return math.sqrt(nearest)


def test_a_ground_that_is_sunk_moves_along_its_normal(tmp_path):
    fixes = "fix floor soil wall/gran/balls 2 1.0 surface ground upper spacing 1.0 sink 0.8 write slip.xyz\n"
    log, floor, _ = place(tmp_path, fixes)
    assert "sunk by 0.8)" in log
    slope = floor[(floor[:, 0] > 16) & (floor[:, 0] < 47)]
    assert len(slope) > 1000
    assert slope[:, 2] == pytest.approx(ground(slope[:, 0]) - 0.8 * math.sqrt(1 + SLOPE**2), abs=1e-6)
    level = floor[floor[:, 0] < 12]
    assert level[:, 2] == pytest.approx(-0.8, abs=1e-9)
    # at the toe, below a hollow, a ball that touches the ground at x = 14 only would be 0.8 away from it
    toe = floor[numpy.abs(floor[:, 0] - 14) < 0.01]
    assert toe[:, 2] == pytest.approx(-0.8, abs=0.05)


@pytest.mark.parametrize("d", [3.0, 2.0, 1.3])
def test_nothing_is_left_out_of_a_body_on_sunk_balls(tmp_path, d):
    log, slip, field = place(tmp_path, d=d)
    assert left_out(log) == 0
    assert f"sunk by {d:g} and continued up to region ground)" in log
    assert f"plan nodes not outside region slip sunk by {d:g})" in log
    assert closest(field) > 0.99 * d
    assert closest(slip) > 0.9 * d      # extra balls lie on the chords between the others, where it is steep
    slip = on_nodes(log, slip)
    assert closest(slip) == pytest.approx(d, rel=0.02)

    # below the body the centres lie on the sphere that is d larger; beyond its rim they reach the ground
    far = numpy.linalg.norm(slip - CENTRE, axis=1)
    assert (far > RADIUS + 0.98 * d).all()
    toward = CENTRE + (slip - CENTRE) * (RADIUS / far)[:, None]       # where a ball of radius d touches
    below = toward[:, 2] < ground(toward[:, 0]) - 0.5 * d
    assert below.sum() > 50
    assert far[below] == pytest.approx(RADIUS + d, abs=0.02 * d)
    assert (slip[:, 2] < ground(slip[:, 0]) + 1e-6).all()
    assert (ground(slip[:, 0]) - slip[:, 2]).min() < 0.25 * d


# --- one surface: the ground without the body ---

ONE = ("region base terrain base.asc depth 12 headroom 10\nregion strip polygon strip.csv\n"
       "fix slip soil wall/gran/balls 2 {field} surface base upper spacing {half} sink {sunk} inside both &\n"
       "pattern scattered 7 write slip.xyz\n"
       "fix field soil wall/gran/balls 3 {field} surface base upper spacing {apart} sink {sunk} outside both &\n"
       "pattern scattered 7 zone strip 3 {close} write field.xyz\n")
# as sites once were: the slip surface sunk, the field not
STEP = ("fix slip soil wall/gran/balls 2 {d} surface both lower spacing {half} sink {d} pattern scattered 7 &\n"
        "write slip.xyz\n"
        "fix field soil wall/gran/balls 3 {field} surface ground upper spacing {apart} pattern scattered 7 &\n"
        "outside both write field.xyz\n")
PIT = numpy.array([(30.3, 42.2), (40, 40.1), (41.2, 48), (33, 49.2)])     # release.csv, 3 m deep


def base(x, y):
    """Height of the ground without two bodies: the sphere's, whose rim has all directions, and a pit with walls."""
    low = CENTRE[2] - numpy.sqrt(numpy.maximum(RADIUS ** 2 - (x - CENTRE[0]) ** 2 - (y - CENTRE[1]) ** 2, 0))
    z = numpy.where(numpy.hypot(x - CENTRE[0], y - CENTRE[1]) < RADIUS, numpy.minimum(low, ground(x)), ground(x))
    in_pit = Path(PIT).contains_points(numpy.column_stack([x.ravel(), y.ravel()])).reshape(x.shape)
    return numpy.where(in_pit, z - 3, z)


def seam(tmp_path, d, field_d, fixes=ONE):
    """Of the balls: the nearest that one is to the surface, over the distance of contact: of all, at the sphere's rim.
    Of the sunk surface: how far a point is from a ball at most, over the spacing: near the rims, and everywhere."""
    cell, contact, apart = 0.25, (d + field_d) / 2, 0.7 * field_d
    x, y = numpy.meshgrid((numpy.arange(200) + 0.5) * cell, (numpy.arange(240) + 0.5) * cell)
    prepare(tmp_path)
    write_asc(tmp_path / "base.asc", base(x, y), cell=cell)
    (tmp_path / "strip.csv").write_text("0,15\n50,22\n50,28\n0,21\n")      # meets the sphere's rim on both sides
    values = {"d": d, "field": field_d, "sunk": contact, "apart": apart, "close": 0.8 * apart, "half": d / 2}
    run_deck(DECK.format(fixes=fixes.format(**values), body="both", **values), tmp_path)
    balls = numpy.concatenate([read(tmp_path / "slip.xyz"), read(tmp_path / "field.xyz")])
    surface = RegularGridInterpolator((y[:, 0], x[0]), base(x, y))
    u, v = numpy.meshgrid(numpy.arange(1, 49, 0.15), numpy.arange(1, 59, 0.15))
    points = numpy.column_stack([u.ravel(), v.ravel(), surface((v, u)).ravel()])
    top = cKDTree(points)
    # places of centres that touch it: along its normal, where nothing else is nearer
    gy, gx = numpy.gradient(points[:, 2].reshape(u.shape), 0.15)
    normal = numpy.column_stack([-gx.ravel(), -gy.ravel(), numpy.ones(gx.size)])
    sunk = points - contact * normal / numpy.linalg.norm(normal, axis=1)[:, None]
    sunk = sunk[top.query(sunk)[0] > 0.98 * contact]
    within = (sunk[:, :2] > (4, 4)).all(axis=1) & (sunk[:, :2] < (46, 56)).all(axis=1)
    sunk = sunk[within]
    gap = cKDTree(balls).query(sunk)[0] / apart
    depth = ground(sunk[:, 0]) - base(sunk[:, 0], sunk[:, 1])
    lies = cKDTree(points[(ground(points[:, 0]) - points[:, 2] > 0.05), :2]).query(sunk[:, :2])[0]
    near = (lies < contact) & (depth < contact)
    middle = balls[(balls[:, :2] > (4, 4)).all(axis=1) & (balls[:, :2] < (46, 56)).all(axis=1)]
    assert near.sum() > 1000
    lip = top.query(middle)[0] / contact
    at_rim = (middle[:, 1] < 36) & (abs(ground(middle[:, 0]) - middle[:, 2] - contact) < contact)
    return lip.min(), lip[at_rim].min(), gap[near].max(), gap.max()


@pytest.mark.parametrize("d, field_d", [(2.0, 2.0), (2.0, 1.4), (1.5, 2.4)])
def test_slip_balls_and_field_balls_meet_without_a_step(tmp_path, d, field_d):
    """Rims in all directions, walls, two bodies, a zone across the rim, other field balls: no lip, no gap."""
    nearest, at_rim, gap_at_rims, gap = seam(tmp_path, d, field_d)
    assert at_rim > 0.95 and nearest > 0.85     # at the foot of a corner of walls columns see half a pitch
    assert gap_at_rims <= gap < 1.05            # 0.795 + sqrt(2)/6 on level ground


def test_a_field_that_is_not_sunk_has_a_step(tmp_path):
    assert seam(tmp_path, 2.0, 2.0, STEP)[1] < 0.1


def test_on_the_surface_itself_many_are(tmp_path):
    log, slip, _ = place(tmp_path, sink=0)
    assert left_out(log) > 0.15
    assert "sunk" not in log
    first = slip
    log, slip, _ = place(tmp_path, (SLIP + FIELD + DELETE).replace(" sink {sink}", ""))
    assert left_out(log) > 0.15 and numpy.array_equal(first, slip)


@pytest.mark.parametrize("field", [0.7, 3.0])
def test_field_balls_of_another_size_leave_room_too(tmp_path, field):
    log, _, balls = place(tmp_path, field=field)
    assert left_out(log) < 0.03      # larger ones reach a few balls on the rim
    assert closest(balls) > 0.99 * 2.0
    assert ("tight for balls of diameter 2" in log) == (field > 2.0)


def test_no_lip_stands_before_the_toe(tmp_path):
    """A ball that slides on along the slip sphere, out of the body and over its rim, meets no ball of the field."""
    _, _, field = place(tmp_path)
    _, _, lip = place(tmp_path, outside="slip sunk 0")
    angles = numpy.radians(numpy.arange(-60, 61, 2))
    out = numpy.radians(numpy.arange(0, 80, 0.5))           # below the horizon of the sphere's centre
    a, b = (values.ravel() for values in numpy.meshgrid(angles, out))
    away = [-numpy.cos(a) * numpy.cos(b), numpy.sin(a) * numpy.cos(b), -numpy.sin(b)]
    path = CENTRE + RADIUS * numpy.column_stack(away)
    nearest = [min(numpy.linalg.norm(path - ball, axis=1).min() for ball in balls) for balls in (field, lip)]
    assert nearest[0] > 0.99 * 2.0
    assert nearest[1] < 0.5 * 2.0


# --- bodies of other kinds ---

def test_a_pit_with_walls(tmp_path):
    fixes = SLIP.replace("surface slip", "surface pit") + FIELD + DELETE
    for d in (1.5, 1.0):
        log, bottom, field = place(tmp_path, fixes, body="pit", d=d, outside="pit")
        assert left_out(log) < 0.01
        inside = bottom[(bottom[:, 0] > 34) & (bottom[:, 0] < 38) & (bottom[:, 1] > 43) & (bottom[:, 1] < 46)]
        assert inside[:, 2] == pytest.approx(ground(inside[:, 0]) - 3.0 - d * math.sqrt(1 + SLOPE**2), abs=1e-3)
        # the walls are balls of the field, d outside of the polygon, from the ground to the bottom
        wall = field[field[:, 2] < ground(field[:, 0]) - 0.5 * d]
        assert len(wall) > 20
        assert (wall[:, 2] > ground(wall[:, 0]) - 3.0 - 1.5 * d).all()


def test_outside_may_name_more_than_the_body(tmp_path):
    """Two bodies and their union; a prism without a bottom around a body."""
    pit = SLIP.replace("fix slip", "fix bottom").replace("surface slip", "surface pit").replace("slip.xyz", "pit.xyz")
    log, _, field = place(tmp_path, SLIP + pit + FIELD + DELETE, body="both", outside="both")
    assert left_out(log) < 0.01
    assert "plan nodes not outside region both sunk by 2, sunk by 2)" in log
    assert closest(field) > 0.99 * 2.0
    around = "region around block 4 48 2 38 INF INF units box\n"
    log, _, field = place(tmp_path, around + SLIP + FIELD + DELETE, outside="around")
    assert "not outside region around sunk by 2)" in log
    log, _, field = place(tmp_path, around.replace("4 48", "48 49") + SLIP + FIELD, outside="around")
    assert "not outside region around)" in log        # not the body's


def test_without_a_ground_it_ends_a_sink_beyond_the_rim(tmp_path):
    fixes = "fix slip soil wall/gran/balls 2 1.0 surface sphere lower spacing 0.5 sink 1.5 write slip.xyz\n"
    log, ball, _ = place(tmp_path, fixes)
    assert "sunk by 1.5)" in log
    far = numpy.linalg.norm(ball - CENTRE, axis=1)
    assert far == pytest.approx(RADIUS + 1.5, abs=0.15)
    assert far[:len(on_nodes(log, ball))] == pytest.approx(RADIUS + 1.5, abs=0.045)
    assert numpy.hypot(ball[:, 0] - CENTRE[0], ball[:, 1] - CENTRE[1]).max() > RADIUS + 1.4


# --- the same balls in every way ---

def test_create_balls_makes_the_same(tmp_path):
    _, slip, field = place(tmp_path, d=2.0)
    atoms = """
create_balls 2 2 2500 surface slip lower spacing 1 sink 2
create_balls 3 2 2500 surface ground upper spacing 2 outside slip sunk 2
group fixed type 2 3
write_dump fixed custom atoms.dump type x y z modify format float %.15g
"""
    # the plan ends before the box does
    _, _, _ = place(tmp_path, atoms.replace("spacing 2 ", "spacing 2 origin 1 1 "), d=2.0)
    rows = [line.split() for line in (tmp_path / "atoms.dump").read_text().splitlines()]
    made = numpy.array([row for row in rows if len(row) == 4 and row[0] in "23"], float)
    assert sorted(map(tuple, made[made[:, 0] == 2][:, 1:].round(9))) == sorted(map(tuple, slip.round(9)))
    _, _, shifted = place(tmp_path, SLIP + FIELD.replace(" outside", " origin 1 1 outside"), d=2.0)
    assert sorted(map(tuple, made[made[:, 0] == 3][:, 1:].round(9))) == sorted(map(tuple, shifted.round(9)))
    assert len(field) > 100


def test_same_balls_on_any_number_of_ranks_and_after_a_run(tmp_path):
    found = []
    run = "neighbor 0.3 bin\ntimestep 1e-4\nfix move soil nve/sphere\nrun 1\n"
    for name, fixes, np in (("1", SLIP + FIELD, 1), ("2", SLIP + FIELD, 2), ("run", SLIP + DELETE + run + FIELD, 1)):
        folder = tmp_path / name
        folder.mkdir()
        found.append(place(folder, fixes, np=np)[1:])
    for slip, field in found[1:]:
        assert numpy.array_equal(slip, found[0][0]) and numpy.array_equal(field, found[0][1])


def test_the_balls_below_come_first(tmp_path):
    prepare(tmp_path)
    values = {"d": 2.0, "half": 1.0, "sink": 2.0, "field": 2.0, "outside": "slip"}
    fixes = FIELD + SLIP
    run_deck(DECK.format(fixes=fixes.format(**values), body="slip", **values), tmp_path,
             expect_error="Fix wall/gran/balls slip sink must come before fix field, which is outside region slip")
    assert not (tmp_path / "slip.xyz").exists()


# --- balls that are smaller than the fixed ones ---

def test_smaller_balls_that_come_later_are_warned_of(tmp_path):
    run = "neighbor 0.3 bin\ntimestep 1e-4\nfix move soil nve/sphere\nrun 0\n"
    shrink = "set group soil diameter 1.0\n"
    log, _, _ = place(tmp_path, FIELD + DELETE + shrink + run, d=2.0)
    assert ("WARNING: Fix wall/gran/balls field: balls of diameter 1 may pass between these, placed for 2 and "
            "larger, on steep ground: define the fix after the balls, or with smallest 1") in log
    log, _, _ = place(tmp_path, FIELD.replace(" outside", " smallest 1.0 outside") + DELETE + shrink + run, d=2.0)
    assert "may pass" not in log and "tight for balls of diameter 1)" in log
    log, _, _ = place(tmp_path, shrink + FIELD + DELETE + run, d=2.0)
    assert "may pass" not in log and "tight for balls of diameter 1)" in log
