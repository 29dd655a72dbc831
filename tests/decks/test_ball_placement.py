"""Where fixed balls go: the arguments that fix wall/gran/balls and create_balls share."""

import math
import re
from concurrent.futures import ThreadPoolExecutor

import pytest
from deck_helpers import run_deck, write_asc

# a sphere around 0,0,6 (radius 5) and prisms; the fix reports and writes when it is defined

DECK = """
units           si
atom_style      sphere
boundary        f f f
comm_modify     vel yes
region          box block -10 10 -10 10 -2 12 units box
create_box      2 box
region          ball sphere 0 0 6 5 units box
region          slab block -8 8 -8 8 0 6 units box
region          trench block -3 2.6 -2.2 3.3 2 6 units box
region          column cylinder z 0 0 3 INF INF units box
region          nowhere block 20 21 20 21 0 1 units box
region          plane plane 0 0 0 0 0 1 units box
region          none intersect 2 nowhere ball units box
region          small intersect 2 ball slab units box
region          open block -8 8 -8 8 0 6 open 6 units box
region          bottomless block -8 8 -8 8 INF 6 units box
fix             w all wall/gran/balls 2 0.5 {placement}
"""


def placed(placement, tmp_path, np=1, name="balls.txt"):
    """Log and positions of the balls."""
    log = run_deck(DECK.format(placement=f"{placement} write {name}"), tmp_path, np=np)
    return log, balls(tmp_path / name)


def balls(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return [tuple(float(word) for word in line.split()) for line in lines]


def counts(log):
    """Number of balls, on the plan grid, extra."""
    match = re.search(r"w: (\d+) fixed balls .*\((\d+) on the plan grid every \S+, (\d+) extra", log)
    return tuple(int(n) for n in match.groups())


def test_upper_and_lower_boundary(tmp_path):
    log, upper = placed("surface ball upper spacing 0.5", tmp_path)
    log, lower = placed("surface ball lower spacing 0.5", tmp_path)
    total, base, extra = counts(log)
    assert len(lower) == len(upper) == total == base + extra
    assert extra > 0     # the sphere is steep at its rim
    for (x, y, z), (xl, yl, zl) in zip(upper[:base], lower[:base]):
        assert (x, y) == (xl, yl)
        assert z == pytest.approx(6 + math.sqrt(25 - x * x - y * y), abs=1e-6)
        assert zl == pytest.approx(6 - math.sqrt(25 - x * x - y * y), abs=1e-6)


def test_level_ground_is_the_plan_grid(tmp_path):
    log, slab = placed("surface slab upper spacing 0.5", tmp_path)
    assert counts(log) == (33 * 33, 33 * 33, 0)
    assert slab == [(-8 + 0.5 * i, -8 + 0.5 * j, 6) for j in range(33) for i in range(33)]
    log, slab = placed("surface slab upper spacing 0.5 origin 0.2 0.1", tmp_path)
    assert slab[0] == pytest.approx((-7.8, -7.9, 6))


def test_terrain(tmp_path):
    # 30 degrees down along x, without data in one corner

    rows = [["%.9f" % (-math.tan(math.pi / 6) * (i + 0.5)) for i in range(12)] for j in range(10)]
    rows[0][0] = rows[0][1] = "-9999"
    (tmp_path / "hill.asc").write_text(
        "ncols 12\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n" +
        "".join(" ".join(row) + "\n" for row in rows))
    text = DECK.format(placement="surface hill upper spacing 0.5 write balls.txt").replace(
        "fix  ", "region hill terrain hill.asc\nfix  ")
    log = run_deck(text, tmp_path)
    total, base, extra = counts(log)
    assert "plan nodes without surface" in log
    for x, y, z in balls(tmp_path / "balls.txt")[:base]:
        if 0.5 <= x <= 11.5:      # between the middles of the outermost cells
            assert z == pytest.approx(-math.tan(math.pi / 6) * x, abs=1e-8)
    assert extra < 20             # at the rim of the corner only

    # the general search finds the same surface as the short cut to the grid

    run_deck(text.replace("surface hill", "surface both").replace(
        "fix  ", "region both intersect 2 hill hill\nfix  ").replace("balls.txt", "search.txt"), tmp_path)
    for a, b in zip(balls(tmp_path / "balls.txt")[:base], balls(tmp_path / "search.txt")):
        assert a == pytest.approx(b, abs=1e-9)


def test_filters_split_the_nodes(tmp_path):
    log_in, inside = placed("surface slab upper spacing 0.5 inside column", tmp_path)
    log_out, outside = placed("surface slab upper spacing 0.5 outside column", tmp_path)
    nodes = [(-8 + 0.5 * i, -8 + 0.5 * j) for j in range(33) for i in range(33)]
    near = [p for p in nodes if math.hypot(*p) <= 3]
    assert counts(log_in)[1] == len(near)
    assert counts(log_out)[1] == len(nodes) - len(near)
    assert f"{len(nodes) - len(near)} plan nodes not inside region column" in log_in
    assert f"{len(near)} plan nodes not outside region column" in log_out
    assert [p[:2] for p in inside[:len(near)]] == near
    assert all(math.hypot(x, y) < 3.01 for x, y, _ in inside)
    assert all(math.hypot(x, y) > 2.99 for x, y, _ in outside)
    assert all(z == 6 for _, _, z in inside + outside)      # a prism without a bottom leaves no scar


def test_scarp_of_a_trench_is_closed(tmp_path):
    # the trench has vertical walls from z = 2 to the ground at z = 6

    log, field = placed("surface slab upper spacing 0.5 outside trench", tmp_path)
    log, floor = placed("surface trench lower spacing 0.5", tmp_path)
    solid = field + floor
    assert {z for _, _, z in floor} == {2}

    worst = 0
    for k in range(71):
        for m in range(51):
            x, y, z = -3 + k * 0.08, -2.2 + k * 5.5 / 70, 2 + m * 0.08
            for wall in ((x, -2.2, z), (x, 3.3, z), (-3, y, z), (2.6, y, z)):
                close = (ball for ball in solid
                         if abs(ball[0] - wall[0]) < 0.5 and abs(ball[1] - wall[1]) < 0.5)
                worst = max(worst, min(math.dist(ball, wall) for ball in close))
    assert worst < 0.5    # one diameter: a ball there touches


def test_written_file_is_read_back(tmp_path):
    log, first = placed("surface ball lower spacing 0.25", tmp_path, name="first.txt")
    header = (tmp_path / "first.txt").read_text().splitlines()[:2]
    assert header == [f"# Fix wall/gran/balls w: {len(first)} fixed balls of diameter 0.5, units si",
                      "# x y z"]
    log, second = placed("file first.txt", tmp_path, name="second.txt")
    assert f"w: {len(first)} fixed balls of diameter 0.5 (from file first.txt)" in log
    assert second == first
    log, inner = placed("file first.txt inside column", tmp_path, name="inner.txt")
    assert inner == [p for p in first if math.hypot(p[0], p[1]) <= 3]
    assert not list(tmp_path.glob("*.tmp"))


def test_same_balls_on_any_number_of_ranks(tmp_path):
    placement = "surface ball lower spacing 0.5 outside trench"
    for np in (1, 2, 4):
        run_deck(DECK.format(placement=f"{placement} write {np}.txt"), tmp_path, np=np)
    assert balls(tmp_path / "1.txt")
    assert balls(tmp_path / "1.txt") == balls(tmp_path / "2.txt") == balls(tmp_path / "4.txt")


@pytest.mark.parametrize("spacing, warning", [
    (0.60, None),
    (0.67, "spacing 0.67 lets a ball of diameter 0.5 through on steep ground: spacing must be < 0.6496"),
    (0.71, "spacing 0.71 lets a ball of diameter 0.5 through even on level ground: spacing must be < 0.7071"),
])
def test_wide_spacing_is_warned_of(tmp_path, spacing, warning):
    log, _ = placed(f"surface slab upper spacing {spacing}", tmp_path)
    assert ("lets a ball" in log) == bool(warning)
    assert warning is None or f"WARNING: Fix wall/gran/balls w {warning}" in log


BAD = [    # what test_wrong_input.py does not have
    ("surface ball upper spacing 0.4 pattern", "w pattern must be followed by grid|scattered, got 0 of 1 values"),
    ("surface ball upper spacing 0.4 pattern hexagonal", "w pattern must be grid or scattered, got hexagonal"),
    ("surface ball upper spacing 0.4 pattern scattered 0", "w pattern scattered SEED must be > 0, got 0"),
    ("surface ball upper spacing 0.4 pattern scattered 1.5",
     "w pattern scattered SEED must be a whole number, got 1.5"),
    ("surface ball upper spacing 0.4 pattern scattered angle 10",
     "w angle must be 0 with pattern scattered, which has no direction, got 10"),
    ("surface ball upper spacing 0.4 angle 400", "w angle must be within +-360 (degrees), got 400"),
    ("surface ball upper spacing 0.4 angle north", "w angle must be a finite number, got north"),
    ("surface ball upper spacing 0.48 pattern scattered",
     "w spacing must be <= 0.475 with pattern scattered, got 0.48"),
    ("surface ball upper spacing 0.38 pattern scattered smallest 0.25",
     "w spacing must be <= 0.35625 with pattern scattered, got 0.38"),
    ("surface ball upper spacing 1 outside plane", "w region plane must have a bounding box, style plane"),
    ("surface open upper spacing 1", "w region open must have no open faces, got some"),
    ("surface bottomless lower spacing 1", "w region bottomless must have a lower boundary, got INF"),
    ("surface none upper spacing 1", "w: the surface of region none holds no balls"),
    ("surface ball upper spacing 1 inside nowhere", "w: the surface of region ball holds no balls"),
]


def test_bad_input_ends_with_one_line(tmp_path):
    def check(k):
        placement, message = BAD[k]
        path = tmp_path / str(k)
        path.mkdir()
        before = set(path.iterdir())
        run_deck(DECK.format(placement=placement), path, expect_error=message)
        assert {left.name for left in set(path.iterdir()) - before} <= {"in.deck", "log.deck"}

    with ThreadPoolExecutor(4) as pool:      # a run of LAMMPS sleeps half a second in MPI_Init
        list(pool.map(check, range(len(BAD))))


def test_error_on_rank_0_ends_all_ranks(tmp_path):
    (tmp_path / "two.txt").write_text("1 2 3\n1 2\n")
    run_deck(DECK.format(placement="file two.txt"), tmp_path, np=2, timeout=60,
             expect_error="two.txt, line 2: must be 3 numbers, x y z, got 1 2")
    (tmp_path / "huge.txt").write_text("0 0 1e999\n")
    run_deck(DECK.format(placement="file huge.txt"), tmp_path, np=2, timeout=60,
             expect_error="huge.txt, line 1: must be 3 numbers, x y z, got 0 0 1e999")


# --- columns as intervals ---

SHAPES = {    # more of LAMMPS': unit/lammps/test_region_columns.cpp
    "beside a plane": "region half plane 0 0 5 0.3 0.2 -1 side out units box\nregion shape intersect 2 ball half",
    "union": "region shape union 3 ball trench slab",
    "terrain": "region hill terrain hill.asc depth 3 headroom 3\nregion shape intersect 2 hill ball",
    "beside a terrain": "region hill terrain hill.asc depth 3 side out\nregion shape intersect 2 hill slab",
    "polygon": "region plan polygon plan.csv\nregion shape intersect 2 plan ball",
}


@pytest.mark.parametrize("shape", SHAPES)
def test_columns_of_known_styles_are_those_of_a_search(tmp_path, shape):
    """With a cone in it, a style without intervals, the same region is searched in steps of 0.125 d."""
    write_asc(tmp_path / "hill.asc", [[3 + 0.1 * (i - 5) ** 2 - 0.05 * i * j for i in range(11)] for j in range(11)],
              -8.0, -8.0, 1.5)
    (tmp_path / "plan.csv").write_text("-3.1,-4.2\n4.3,-3.7\n0.4,4.1\n")
    deck = DECK[:DECK.index("fix ")] + SHAPES[shape]
    deck += "\nregion cone cone z 0 0 90 90 -50 50 units box\nregion marched intersect 2 cone shape\n"
    for side in "upper", "lower":
        for region in "shape", "marched":
            deck += f"fix w all wall/gran/balls 2 0.5 surface {region} {side} spacing 0.47 write {region}.{side}\n"
            deck += "unfix w\n"
    base = [int(n) for n in re.findall(r"(\d+) on the plan grid", run_deck(deck, tmp_path))]
    assert len(base) == 4
    for side in "upper", "lower":
        placed = [balls(tmp_path / f"{region}.{side}")[:base.pop(0)] for region in ("shape", "marched")]
        exact, marched = ({(round(x, 6), round(y, 6)): z for x, y, z in nodes} for nodes in placed)
        assert len(marched) > 50 and marched.keys() <= exact.keys() and len(marched) > 0.95 * len(exact)
        far = [place for place in marched if abs(exact[place] - marched[place]) > 1e-6 * 0.5]
        assert len(far) < 0.01 * len(exact)     # there the search passed over a thin part


def test_thin_part_is_found(tmp_path):
    """A body of two hundredths of a diameter between two terrains."""
    for name, height in ("upper", 4.0), ("lower", 3.99):
        write_asc(tmp_path / f"{name}.asc", [[height] * 8] * 8, -8.0, -8.0, 2.0)
    regions = ("region top terrain upper.asc depth 3\nregion bottom terrain lower.asc depth 3 side out\n"
               "region same terrain upper.asc depth 3 side out\n"
               "region sheet intersect 2 top bottom\nregion nothing intersect 2 top same\nfix             w all")
    deck = DECK.replace("fix             w all", regions)
    log = run_deck(deck.format(placement="surface top upper spacing 1 inside sheet write sheet.txt"), tmp_path)
    assert counts(log)[1] == 17 * 17 and {z for _, _, z in balls(tmp_path / "sheet.txt")} == {4.0}
    run_deck(deck.format(placement="surface top upper spacing 1 inside nothing"), tmp_path,
             expect_error="w: the surface of region top holds no balls")


# --- few balls on a large surface ---

FAR = """
units si
atom_style sphere
boundary f f f
region box block 0 100000 0 100000 -10 10
create_box 2 box
region ground block 0 100000 0 100000 -5 0
"""


def test_the_only_ball_is_found_wherever_it_is(tmp_path):
    """On nodes at the ends and edges of tiles of 32 nodes, 200 x 200 of them: each filter leaves one."""
    places = [(i, j) for i in (0, 31, 32, 33, 100, 191, 192, 200) for j in (0, 32, 200)]
    lines = ["units si", "atom_style sphere", "boundary f f f", "region box block -9 209 -9 209 -9 9",
             "create_box 2 box", "region ground block 0 200 0 200 -5 0"]
    for n, (i, j) in enumerate(places):
        lines += [f"region r{n} block {i - 0.4} {i + 0.4} {j - 0.3} {j + 0.3} INF INF",
                  f"fix w{n} all wall/gran/balls 2 1.0 surface ground upper spacing 1 inside r{n}"]
    log = run_deck("\n".join(lines) + "\n", tmp_path)
    assert log.count(": 1 fixed balls of diameter 1 (1 on the plan grid") == len(places)


@pytest.mark.parametrize("x, found", [(50001, True), (50001.5, False)])
def test_one_node_of_a_billion(tmp_path, x, found):
    """A region of 100 km: only nodes near the filter are asked, all of them would take minutes."""
    wall = (f"region few sphere {x} 50001 0 0.4\n"
            "fix w all wall/gran/balls 2 0.05 surface ground upper spacing 3 inside few\n")
    error = None if found else "Fix wall/gran/balls w: the surface of region ground holds no balls"
    log = run_deck(FAR + wall, tmp_path, timeout=20, expect_error=error)
    assert found == ("on a plan grid of 1111155556 nodes every 3" in log)
