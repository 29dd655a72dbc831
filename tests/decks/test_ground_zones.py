"""Zones of the fixed balls' ground: a type, and perhaps a spacing, of their own; inside and outside together."""

import numpy
import pytest
from deck_helpers import dump_difference, read_dump, run_deck, write_asc
from scipy.spatial import cKDTree
from shapely.geometry import Point, Polygon
from shapely.prepared import prep
from test_ground_tiles import heights

ZONES = {"fan": [(20, 10), (90, 15), (70, 70), (30, 60)], "scar": [(60, 40), (120, 30), (130, 90), (75, 100)],
         "strip": [(5, 80), (60, 85), (60, 86), (5, 81)]}
TYPES = {"": 2, "fan": 3, "scar": 4, "strip": 5}
POLYGONS = "".join(f"region {name} polygon {name}.csv\n" for name in ZONES)
ALL = " ".join(f"zone {name} {TYPES[name]}" for name in ZONES)
SPACED = "zone fan 3 0.6 zone scar 4 zone strip 5 0.45"
SURFACE = "surface ground upper spacing 0.9 outside pit pattern scattered 5"

DECK = """
units si
atom_style sphere
atom_modify map array
boundary {boundary}
comm_modify vel yes
processors {processors}
region ground terrain ground.asc depth 30 headroom 60
region pit block 30.2 41.3 20.1 33.7 -30 60 units box
create_box 5 ground
""" + POLYGONS + """
{balls}
neighbor 0.4 bin
neigh_modify every 1 delay 0 check yes binsize 5
pair_style gran/restitution
{coeffs}
timestep 1e-3
fix wall all wall/gran/balls 2 1.0 {ground} smallest 1
{balance}
fix move all nve/sphere
fix weight all gravity {gravity} vector 0 0 -1
dump path all custom 100 {out}.dump id x y z vx vy vz omegax omegay omegaz fx fy fz
dump_modify path sort id format float %.17g
thermo 1000
"""
ROLLING = """create_atoms 1 single 26 20 14
create_atoms 1 single 58 40 14
create_atoms 1 single 31 82.5 15
set group all diameter 1.0 density 2500
velocity all set 8 3 -2
"""
SAME = "pair_coeff * * stiffness 2e6 2e6 restitution 0.5 friction 30 rolling 0.05\n"
DIFFERENT = SAME + ("pair_coeff 1 3 stiffness 2e6 2e6 restitution 0.2 friction 10 rolling 0\n"
                    "pair_coeff 1 4 stiffness 2e6 2e6 restitution 0.8 friction 50 rolling 0.2\n")


def deck(ground=SURFACE, out="out", balls=ROLLING, coeffs=SAME, boundary="f f f", processors="* * *", balance="",
         gravity=9.81):
    return DECK.format(**locals())


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("zones")
    write_asc(folder / "ground.asc", heights(), 0.0, 0.0, 2.0)
    for name, points in ZONES.items():
        (folder / f"{name}.csv").write_text("".join(f"{x},{y}\n" for x, y in points))
    return folder


def places(site, ground, name="balls"):
    run_deck(deck(f"{ground} write {name}.xyz") + "run 0\n", site)
    return numpy.loadtxt(site / f"{name}.xyz")


def contains(polygon, x, y):
    inside = prep(polygon)
    return numpy.array([inside.contains(Point(place)) for place in zip(x, y)])


def zone_of(x, y):
    """The last of the polygons that a place lies in; "": none."""
    found = numpy.full(len(x), "", dtype=object)
    for name, points in ZONES.items():
        found[contains(Polygon(points), x, y)] = name
    return found


def test_zones_of_the_same_spacing_change_no_place(site):
    places(site, SURFACE, "without")
    places(site, f"{SURFACE} {ALL}", "with")
    assert (site / "with.xyz").read_text().split("\n", 1)[1] == (site / "without.xyz").read_text().split("\n", 1)[1]


def test_coefficients_are_those_of_the_polygon_there(site):
    """A small ball pressed into each of 1,000 fixed ones: its force is the stiffness of the zone times the overlap."""
    fixed = places(site, f"{SURFACE} {SPACED}")
    there = zone_of(*fixed[:, :2].T)
    stiffness, overlap = {2: 1e5, 3: 2e5, 4: 3e5, 5: 4e5}, 1e-3
    touched = cKDTree(fixed).query(fixed + [0, 0, 0.55 - overlap], 2)[0]
    alone = touched[:, 1] > 0.56        # touches no other one
    chosen = numpy.concatenate([numpy.flatnonzero((there == name) & alone)[:400] for name in TYPES])
    balls = "".join(f"create_atoms 1 single {x:.15g} {y:.15g} {z + 0.55 - overlap:.15g}\n"
                    for x, y, z in fixed[chosen]) + "set group all diameter 0.1 density 2500\n"
    coeffs = SAME + "".join(f"pair_coeff 1 {kind} stiffness {kn} {kn} restitution 0.5 friction 30\n"
                            for kind, kn in stiffness.items())
    run_deck(deck(f"{SURFACE} {SPACED}", "pressed", balls, coeffs, gravity=0) + "run 0\n", site)
    force = read_dump(site / "pressed.dump")[0][:, -1]
    expected = numpy.array([stiffness[TYPES[name]] for name in there[chosen]]) * overlap
    assert len(force) >= 1000
    assert all((there[chosen] == name).sum() > 50 for name in TYPES)
    assert numpy.abs(force / expected - 1).max() < 1e-4     # the law is a little softer


def test_one_zone_of_all_is_the_ground_without(site):
    """To the last bit: with the same spacing, and with another one the balls of a ground of that spacing."""
    (site / "all.csv").write_text("-9,-9\n500,-9\n500,500\n-9,500\n")
    whole = POLYGONS + "region all polygon all.csv\n"
    for name, ground in (("one", SURFACE), ("two", f"{SURFACE} zone all 3")):
        run_deck(deck(ground, name).replace(POLYGONS, whole) + "run 2000\n", site)
    assert (site / "one.dump").read_bytes() == (site / "two.dump").read_bytes()
    for name, ground in (("one", SURFACE.replace("0.9", "0.6")), ("two", f"{SURFACE} zone all 3 0.6")):
        run_deck(deck(f"{ground} write {name}.xyz").replace(POLYGONS, whole) + "run 0\n", site)
    one, two = (numpy.loadtxt(site / f"{name}.xyz") for name in ("one", "two"))
    assert len(one) == len(two) > 40_000
    assert numpy.array_equal(*(balls[numpy.lexsort(balls.T)] for balls in (one, two)))


@pytest.mark.parametrize("ground", [f"{SURFACE} {ALL}", f"{SURFACE} {SPACED}"], ids=["same", "spaced"])
@pytest.mark.parametrize("np, settings", [
    (1, dict(boundary="s s fs")), (2, dict(boundary="s s fs", processors="2 1 1",
                                           balance="fix even all balance 200 1.0 shift x 5 1.05")),
    (4, dict(processors="4 1 1"))], ids=["one", "balanced", "four"])
def test_any_number_of_ranks(site, ground, np, settings):
    reference = site / f"{len(ground)}.dump"
    if not reference.exists():
        run_deck(deck(ground, reference.stem, coeffs=DIFFERENT) + "run 3000\n", site)
    run_deck(deck(ground, "ranks", coeffs=DIFFERENT, **settings) + "run 3000\n", site, np=np)
    whole, found = read_dump(reference), read_dump(site / "ranks.dump")
    for step in (1000, 3000):
        assert max(dump_difference(whole[step], found[step])) < 1e-6


AGAIN = """
read_restart mid.restart
region ground terrain ground.asc depth 30 headroom 60
region pit block 30.2 41.3 20.1 33.7 -30 60 units box
{polygons}
neighbor 0.4 bin
neigh_modify every 1 delay 0 check yes
comm_modify vel yes
timestep 1e-3
fix wall all wall/gran/balls 2 1.0 {ground} smallest 1
fix move all nve/sphere
fix weight all gravity 9.81 vector 0 0 -1
dump path all custom 100 again.dump id x y z vx vy vz omegax omegay omegaz fx fy fz
dump_modify path sort id format float %.17g
run 3000 upto
"""


def test_restart_on_other_ranks(site):
    ground = f"{SURFACE} {SPACED}"
    run_deck(deck(ground, "whole", coeffs=DIFFERENT) + "run 1500\nwrite_restart mid.restart\nrun 1500\n", site)
    again = AGAIN.format(polygons=POLYGONS, ground=ground)
    run_deck(again, site, np=2)
    whole, found = read_dump(site / "whole.dump")[3000], read_dump(site / "again.dump")[3000]
    assert max(dump_difference(whole, found)) < 1e-8
    run_deck(again.replace("zone fan 3 0.6", "zone fan 3 0.7"), site, expect_error="other zones")
    (site / "moved.csv").write_text("".join(f"{x + 9},{y}\n" for x, y in ZONES["fan"]))
    run_deck(again.replace("polygon fan.csv", "polygon moved.csv"), site, expect_error="other zones")


def test_inside_and_outside_together(site):
    found = places(site, f"{SURFACE} inside fan")
    whole = places(site, SURFACE, "without")
    in_fan = contains(Polygon(ZONES["fan"]), *found[:, :2].T)
    assert in_fan.mean() > 0.995      # the others are on its edge
    pit = (30.3 < found[:, 0]) & (found[:, 0] < 41.2) & (20.2 < found[:, 1]) & (found[:, 1] < 33.6)
    assert not pit.any()
    assert len(found) == pytest.approx(contains(Polygon(ZONES["fan"]), *whole[:, :2].T).sum(), rel=0.05)


@pytest.mark.parametrize("ground, message", [
    (f"{SURFACE} zone fan 9", "zone fan type must be 1 to 5 .*, got 9"),
    (f"{SURFACE} zone fan 3 0.99", "zone fan spacing must be <= 0.95 .*, got 0.99"),
    (f"{SURFACE} zone fan 3 1e999", "zone fan spacing must be a finite number, got 1e999"),
    (f"{SURFACE} zone fan 3 -1", "zone fan spacing must be > 0, got -1"),
    (f"{SURFACE} zone fan", "zone fan type must be a whole number, got smallest"),
    (f"{SURFACE} zone none 3", "region none does not exist"),
    ("surface ground upper spacing 0.9 zone fan 3 0.6", "zone fan spacing needs pattern scattered, got a plan grid"),
    (f"{SURFACE} outside fan", "can be outside one region, got fan as well")])
def test_refused(site, ground, message):
    run_deck(deck(ground) + "run 0\n", site, expect_error=message)


def test_a_zone_needs_coefficients(site):
    run_deck(deck(f"{SURFACE} zone fan 3", coeffs="pair_coeff 1 1*2 stiffness 2e6 2e6 restitution 0.5\n") + "run 0\n",
             site, expect_error="pair_coeff 1 3 is not set")
