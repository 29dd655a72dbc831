"""create_balls: the balls of a surface, or of a packing, as atoms, the same ones on any number of ranks."""

import math
from pathlib import Path

import numpy
import pytest
from scipy.spatial import cKDTree

from deck_helpers import run_deck

DIAMETER = 0.5
DENSITY = 2000.0

DECK = """
units           si
atom_style      {style}
atom_modify     map array
boundary        {boundary}
comm_modify     vel yes
{decomposition}
region          box block {box} units box
create_box      2 box
region          ball sphere 0 0 6 5 units box
create_balls    2 0.5 2000 surface ball lower spacing 0.5 {more}
dump            all all custom 1 {dump} id type x y z vx vy vz radius mass
dump_modify     all sort id format float %.17g
run             0
"""


def deck(style="sphere", boundary="f f f", box="-6 6 -6 6 0 12", decomposition="", more="",
         dump="balls.dump"):
    return DECK.format(**locals())


def atoms(path):
    """Rows of a dump: id type x y z vx vy vz radius mass."""
    lines = path.read_text().splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    return [[float(word) for word in line.split()] for line in lines[start + 1:]]


def positions(path):
    return sorted((x, y, z) for _, _, x, y, z, *_ in atoms(path))


def same(a, b):
    """Are the points the same but for round-off, in whatever order?"""
    in_order = [sorted(points, key=lambda p: [round(c + 3e-7, 5) for c in p]) for points in (a, b)]
    return len(a) == len(b) and all(p == pytest.approx(q, abs=1e-9) for p, q in zip(*in_order))


def nodes(radius, spacing, x0=0.0, y0=0.0):
    """Nodes of a plan grid within a circle around 0,0; on the circle itself the sphere has no thickness."""
    reach = int(radius / spacing) + 2
    grid = [(x0 + i * spacing, y0 + j * spacing)
            for i in range(-reach, reach + 1) for j in range(-reach, reach + 1)]
    return [p for p in grid if math.hypot(*p) < radius - 1e-9]


@pytest.fixture(scope="module")
def one_rank(tmp_path_factory):
    path = tmp_path_factory.mktemp("one")
    log = run_deck(deck(), path)
    return log, path / "balls.dump"


def test_balls_are_on_the_lower_half_of_the_sphere(one_rank):
    log, dump = one_rank
    rows = atoms(dump)
    assert f"Create_balls: {len(rows)} fixed balls of diameter 0.5" in log
    assert [row[0] for row in rows] == list(range(1, len(rows) + 1))
    for _, kind, x, y, z, vx, vy, vz, radius, mass in rows:
        assert kind == 2
        assert z < 6.1
        assert 4.85 < math.dist((x, y, z), (0, 0, 6)) < 5 + 1e-6      # extra ones may lie on chords
        assert (vx, vy, vz) == (0, 0, 0)
        assert radius == DIAMETER / 2
        assert mass == pytest.approx(DENSITY * math.pi / 6 * DIAMETER ** 3, rel=1e-12)

    # one on each node of the plan grid, first, row by row

    base = sorted(nodes(5, 0.5), key=lambda p: (p[1], p[0]))
    assert f"({len(base)} on the plan grid every 0.5, {len(rows) - len(base)} extra" in log
    for (x, y), row in zip(base, rows):
        assert row[2:4] == pytest.approx([x, y], abs=1e-9)
        assert row[4] == pytest.approx(6 - math.sqrt(25 - x * x - y * y), abs=1e-6)


@pytest.mark.parametrize("ranks, decomposition", [
    (2, ""),
    (4, ""),
    (4, "comm_style tiled\nprocessors 1 * 2"),
])
def test_same_balls_on_any_number_of_ranks(tmp_path, one_rank, ranks, decomposition):
    run_deck(deck(decomposition=decomposition), tmp_path, np=ranks)
    dump = tmp_path / "balls.dump"
    assert positions(dump) == positions(one_rank[1])
    assert [row[0] for row in atoms(dump)] == list(range(1, len(atoms(dump)) + 1))


def test_boxes_that_are_tiled_tilted_or_wrapped_hold_the_same_balls(tmp_path, one_rank):
    # an uneven tiling by balance, then a second command into boxes that hold atoms already

    run_deck(deck() + """
comm_style      tiled
balance         1.0 rcb
create_balls    1 0.5 2000 surface ball lower spacing 0.5
dump            first all custom 1 both.dump id type x y z vx vy vz radius mass
dump_modify     first sort id format float %.17g
run             0
""", tmp_path, np=4)
    both = atoms(tmp_path / "both.dump")
    assert sorted(tuple(row[2:5]) for row in both if row[1] == 1) == positions(one_rank[1])
    assert [row[0] for row in both] == list(range(1, len(both) + 1))

    # a periodic box takes in what lies beyond it

    run_deck(deck(boundary="p p f", box="-2 10 -6 6 0 12", dump="periodic.dump"), tmp_path, np=2)
    wrapped = [(x - 12 if x > 6 else x, y, z) for x, y, z in positions(tmp_path / "periodic.dump")]
    assert same(wrapped, positions(one_rank[1]))

    tilted = deck(dump="tilted.dump").replace("block -6 6 -6 6 0 12", "prism -9 6 -6 6 0 12 3 0 0")
    run_deck(tilted, tmp_path, np=2)
    assert same(positions(tmp_path / "tilted.dump"), positions(one_rank[1]))


def test_fixes_and_the_atom_map_know_the_new_atoms(tmp_path):
    # displace/atom gets told of each, or its displacement from the origin would count; z[700] asks the atom map

    log = run_deck("""
units           si
atom_style      sphere
atom_modify     map hash
region          box block -6 6 -6 6 0 12 units box
create_box      1 box
region          ball sphere 0 0 6 5 units box
compute         moved all displace/atom
create_balls    1 0.5 2000 surface ball lower spacing 0.5
create_balls    1 0.5 2000 surface ball upper spacing 0.5
group           one id 700
compute         s one reduce sum c_moved[4]
thermo_style    custom step c_s
run             0
variable        z equal z[700]
print           "z $z moved $(c_s)"
""", tmp_path, np=2)
    z, moved = next(line for line in log.splitlines() if line.startswith("z ")).split()[1::2]
    assert float(z) > 6      # of the second lot
    assert float(moved) == 0      # as for atoms of create_atoms


def test_positions_from_a_file(tmp_path):
    text = "# three balls\n1 2 3\n\n-1.5 0 2e-1  # the last but one\n0 0 4\n"
    (tmp_path / "balls.txt").write_text(text)
    run_deck(deck().replace("surface ball lower spacing 0.5", "file balls.txt"), tmp_path, np=2)
    assert positions(tmp_path / "balls.dump") == [(-1.5, 0, 0.2), (0, 0, 4), (1, 2, 3)]


def test_examples_of_the_page_run(tmp_path):
    page = Path(__file__).resolve().parents[2] / "doc" / "src" / "create_balls.rst"
    examples = page.read_text().split("Examples")[1].split("Description")[0]
    commands = [line.strip() for line in examples.splitlines() if "create_balls" in line]
    assert len(commands) >= 3
    (tmp_path / "ground.txt").write_text("20.5 20.5 10\n30 0 10\n")
    log = run_deck("""
units           si
atom_style      sphere
boundary        f f f
region          box block -1 41 -1 41 -1 20 units box
create_box      3 box
region          ground block 0 40 0 40 0 10 units box
region          ball sphere 20 20 15 10 units box
region          soil intersect 2 ground ball units box
""" + "\n".join(commands), tmp_path, np=2)
    assert log.count("Create_balls: ") == len(commands)


def test_balls_outside_the_box_are_counted_and_located(tmp_path):
    # z = 6 - sqrt(25 - x^2 - y^2) < 2 for all within 3 of the middle

    outside = [p for p in nodes(3, 0.5) if math.hypot(*p) < 3 - 1e-9]
    x, y = min(outside, key=lambda p: (p[1], p[0]))
    z = 6 - math.sqrt(25 - x * x - y * y)
    message = f"got {len(outside)} of "
    run_deck(deck(box="-6 6 -6 6 2 12"), tmp_path, np=2, expect_error=message)
    log = (tmp_path / "log.deck").read_text()
    assert f"the first at {x:g} {y:g} {z:.5f}" in log


# --- fill: a disordered packing ---

FILL = """
units           si
newton          {newton}
atom_style      sphere
boundary        {boundary}
comm_modify     vel yes
{decomposition}
region          box {box} units box
create_box      2 box
region          ball sphere 0 0 6 5 units box
region          inner block -5.5 5.5 -5.5 5.5 0.5 11.5 units box
region          left block -5 0 -5 5 1 11 units box
region          right block 0 5 -5 5 1 11 units box
region          upper plane 0 0 6 0 0.3 1
{create}
dump            all all custom 1 balls.dump id type x y z vx vy vz radius mass
dump_modify     all sort id format float %.17g
run             0
"""


def fill(tmp_path, create="create_balls 2 0.5 2977 fill ball seed 3", newton="on", boundary="f f f",
         decomposition="", box="block -6 6 -6 6 0 12", **options):
    """The log of a deck that fills, and the centres, sorted."""
    log = run_deck(FILL.format(**locals()), tmp_path, **options)
    return log, numpy.array(positions(tmp_path / "balls.dump"))


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    return fill(tmp_path_factory.mktemp("packed"))


def pair_correlation(x, inner, density, d, far=5.0, wide=0.05):
    """In bins of wide diameters from 1.2 to far diameters around the balls of inner."""
    edges = numpy.arange(1.2, far + wide / 2, wide) * d
    pairs = cKDTree(inner).count_neighbors(cKDTree(x), edges)
    return numpy.diff(pairs) / (len(inner) * density * 4 / 3 * math.pi * numpy.diff(edges ** 3))


def test_a_packing_fills_a_sphere_without_contact(packed):
    log, x = packed
    assert f"Create_balls: {len(x)} balls of diameter 0.5 fill region ball, packing 3" in log
    assert (numpy.linalg.norm(x - [0, 0, 6], axis=1) <= 5).all()
    assert len(x) * 0.5 ** 3 / 6 / (4 / 3 * 5 ** 3) == pytest.approx(0.60, abs=0.01)
    nearest = cKDTree(x).query(x, 2)[0][:, 1]
    assert 0.5001 < nearest.min() and numpy.median(nearest) < 0.51


def test_each_ball_has_mass_radius_type_and_rests(tmp_path, packed):
    fill(tmp_path)
    for _, kind, _, _, _, vx, vy, vz, radius, mass in atoms(tmp_path / "balls.dump"):
        assert (kind, vx, vy, vz, radius) == (2, 0, 0, 0, 0.25)
        assert mass == pytest.approx(2977 * math.pi / 6 * 0.5 ** 3, rel=1e-12)


@pytest.mark.parametrize("create, is_lattice", [
    ("create_balls 2 0.5 2977 fill inner", False),
    ("lattice sc 0.5\ncreate_atoms 2 region inner\nset type 2 diameter 0.5", True)])
def test_pair_correlation_of_a_packing_and_of_the_cubic_lattice(tmp_path, create, is_lattice):
    _, x = fill(tmp_path, create)
    inner = x[(abs(x - [0, 0, 6]) < 3).all(axis=1)]
    largest = pair_correlation(x, inner, len(x) / 11 ** 3, 0.5).max()
    assert (largest > 4) if is_lattice else (largest < 2)


@pytest.mark.parametrize("ranks, decomposition, newton", [
    (1, "", "off"), (2, "", "on"), (4, "", "on"), (4, "", "off"), (4, "comm_style tiled\nprocessors 1 * 2", "on")])
def test_the_same_packing_on_any_number_of_ranks(tmp_path, packed, ranks, decomposition, newton):
    _, x = fill(tmp_path, decomposition=decomposition, newton=newton, np=ranks)
    assert numpy.array_equal(x, packed[1])


def test_seeds_are_packings_of_their_own(tmp_path, packed):
    several = {seed: fill(tmp_path, f"create_balls 2 0.5 2977 fill ball seed {seed}")[1] for seed in (1, 2)}
    _, default = fill(tmp_path, "create_balls 2 0.5 2977 fill ball")
    assert numpy.array_equal(default, several[1])
    for one, other in ((several[1], several[2]), (several[2], packed[1])):
        assert (cKDTree(one).query(other)[0] < 0.02).sum() < 10


def test_regions_that_meet_have_parts_of_one_packing(tmp_path):
    _, x = fill(tmp_path, "create_balls 1 0.5 2977 fill left seed 2\ncreate_balls 2 0.5 2977 fill right seed 2")
    assert {row[1] for row in atoms(tmp_path / "balls.dump")} == {1, 2}
    assert cKDTree(x).query(x, 2)[0][:, 1].min() > 0.5001
    assert len(x) * math.pi / 6 * 0.5 ** 3 / 1000 == pytest.approx(0.60, abs=0.005)


@pytest.mark.parametrize("box, boundary", [
    ("block -6 6 -6 6 0 12", "p p p"), ("block -6 6 -6 6 0 12", "p f f"), ("prism -6 6 -6 6 0 12 3 -2 1", "p p p"),
    ("prism -6 6 -6 6 0 12 3 0 0", "f p f")])
def test_no_ball_touches_one_beyond_a_periodic_face(tmp_path, box, boundary):
    create = "create_balls 2 0.5 2977 fill box seed 4"
    _, x = fill(tmp_path, create, box=box, boundary=boundary, np=2)
    tilt = [float(word) for word in box.split()[7:]] or [0, 0, 0]
    sides = numpy.array([[12, 0, 0], [tilt[0], 12, 0], [tilt[1], tilt[2], 12]])
    steps = [range(-1, 2) if kind == "p" else (0,) for kind in boundary.split()]
    images = numpy.array([[i, j, k] for i in steps[0] for j in steps[1] for k in steps[2]]) @ sides
    everywhere = (x + images[:, None]).reshape(-1, 3)
    assert cKDTree(everywhere).query(x, 2)[0][:, 1].min() > 0.5
    filled = 0.60 * (11.5 / 12) ** boundary.count("p")
    assert len(x) * math.pi / 6 * 0.5 ** 3 / 12 ** 3 == pytest.approx(filled, abs=0.01)
    lone = fill(tmp_path, create, box=box, boundary=boundary)[1]
    assert numpy.array_equal(x, lone)


def test_only_what_is_in_the_box_is_filled(tmp_path):
    _, x = fill(tmp_path, "create_balls 2 0.5 2977 fill upper", np=2)
    assert ((x >= [-6, -6, 0]) & (x < [6, 6, 12])).all()
    assert (0.3 * x[:, 1] + x[:, 2] > 6).all()
    assert len(x) * math.pi / 6 * 0.5 ** 3 / (12 * 12 * 6) == pytest.approx(0.60, abs=0.01)


def test_a_region_that_moves_is_not_filled(tmp_path):
    create = ("variable up equal 0.1*step\nregion lift block -5 5 -5 5 1 11 units box move NULL NULL v_up\n"
              "create_balls 2 0.5 2977 fill lift")
    run_deck(FILL.format(create=create, newton="on", boundary="f f f", decomposition="", box="block -6 6 -6 6 0 12"),
             tmp_path, expect_error="Create_balls fill region lift must not move, got one that moves or varies")
