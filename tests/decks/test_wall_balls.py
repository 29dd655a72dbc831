"""Fix wall/gran/balls: the same physics as frozen atoms, whatever the ranks, the order of the atoms, a restart."""

import math

import numpy as np
import pytest

from deck_helpers import doc_examples, run_deck

D, RHO = 0.1, 2500.0
MASS = RHO * math.pi * D ** 3 / 6
G = 9.81


def floor(origin=(0.0, 0.0, 0.0), diameter=D, spacing=0.5 * D, nx=36, ny=10):
    """A rough gutter along x: balls on a plan grid, their heights scattered by 4 % of the diameter."""
    heights = np.random.default_rng(7).uniform(-0.02, 0.02, (44, 12))[:nx, :ny] * diameter
    return [(origin[0] + (i - 0.5 * nx) * spacing, origin[1] + y, origin[2] + heights[i, j] + 0.8 * y * y)
            for i in range(1, nx) for j in range(ny) for y in [(j - 0.5 * ny + 0.5) * spacing]]


# One moving ball that falls on the floor, bounces and rolls along x
BALLS = [dict(x=-0.83, y=-0.03, z=0.17, d=D, v=(1.8, 0.1, -1.0))]
# several, of different size, that also meet each other
CROWD = [dict(x=-0.6 + 0.17 * (k % 4), y=-0.08 + 0.17 * (k // 4), z=0.2 + 0.02 * k, d=(0.1, 0.14, 0.07)[k % 3],
              v=(0.5 - 0.5 * (k % 3), 0.1, -1.0)) for k in range(8)]

COEFF = "stiffness 1e5 8e4 restitution 0.5 friction 30 rolling 0.05"
UNDAMPED = COEFF.replace("restitution 0.5", "damping 0 0")
SLOPE = "0.2 0 -1"  # direction of gravity

BOX = [(-1.2, 1.2), (-0.3, 0.3), (-0.6, 0.6)]

SETUP = """
units si
newton {newton}
processors {processors}
atom_style sphere
atom_modify map array {atom_modify}
boundary f f f
comm_modify vel yes
region box block {box}
create_box 2 box
neighbor {skin} bin
neigh_modify {neigh_modify}
"""

CONTACT = """
pair_style gran/restitution {style}
pair_coeff 1 1 {coeff}
pair_coeff 1 2 {coeff}
timestep {dt}
group moving type 1
{wall}
fix gravity moving gravity 9.81 vector {gravity}
fix move moving nve/sphere
dump trace moving custom {every} {trace} id x y z vx vy vz omegax omegay omegaz
dump_modify trace sort id format float %.17g
thermo 1000
{before}
"""


def make_deck(tmp_path, wall=True, balls=BALLS, positions=None, diameter=D, origin=(0.0, 0.0, 0.0), newton="on",
              processors="* * *", atom_modify="", skin=0.02, neigh_modify="delay 0", style="", coeff=COEFF, dt=4e-4,
              gravity=SLOPE, every=100, trace="trace.txt", before="", box=BOX):
    positions = [tuple(map(float, one)) for one in (floor(origin) if positions is None else positions)]
    box = " ".join(f"{low + o} {high + o}" for o, (low, high) in zip(origin, box))
    deck = SETUP.format(**locals())
    for k, ball in enumerate(balls, 1):
        x, y, z = (float(ball[axis] + o) for axis, o in zip("xyz", origin))
        deck += f"create_atoms 1 single {x!r} {y!r} {z!r}\nset atom {k} diameter {ball['d']} density {RHO}\n"
        deck += "velocity all set 0 0 0\n" * (k == 1)
        deck += f"group one id {k}\nvelocity one set {ball['v'][0]} {ball['v'][1]} {ball['v'][2]}\ngroup one delete\n"
    if wall:
        (tmp_path / "floor.xyz").write_text("".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in positions))
        ground = f"fix ground moving wall/gran/balls 2 {diameter} file floor.xyz"
    else:
        for x, y, z in positions:
            deck += f"create_atoms 2 single {x!r} {y!r} {z!r}\n"
        deck += f"set type 2 diameter {diameter} density {RHO}\n"
        ground = "group floor type 2\nfix ground floor freeze"
    return deck + CONTACT.format(**{**locals(), "wall": ground})


def trajectory(tmp_path, name="trace.txt"):
    """Frames x ball x (x y z vx vy vz omega) of a dump sorted by ID."""
    frames, rows = [], None
    for line in (tmp_path / name).read_text().splitlines():
        if line.startswith("ITEM: ATOMS"):
            rows = []
            frames.append(rows)
        elif line.startswith("ITEM"):
            rows = None
        elif rows is not None:
            rows.append([float(word) for word in line.split()[1:]])
    return np.array(frames)


def run(tmp_path, steps=2000, np=1, **settings):
    log = run_deck(make_deck(tmp_path, **settings) + f"run {steps}\n", tmp_path, np=np)
    assert "Dangerous builds = 0" in log or "check no" in settings.get("neigh_modify", "")
    return trajectory(tmp_path)


def difference(a, b):
    """Largest difference of positions, velocities and spins, each relative to its own size."""
    assert a.shape == b.shape
    parts = [(a[..., k:k + 3], b[..., k:k + 3]) for k in (0, 3, 6)]
    largest = max(np.abs(p - q).max() / np.abs(p).max() for p, q in parts)
    print(f"difference {largest:.3g}")  # pytest -rP shows it
    return largest


def in_contact(path, dt, gravity=SLOPE):
    """Per step of a dump of every step: is the ball's acceleration other than that of gravity?"""
    g = np.array([float(word) for word in gravity.split()])
    acceleration = np.diff(path[:, 3:6], axis=0) / dt
    return np.linalg.norm(acceleration - G * g / np.linalg.norm(g), axis=1) > 1.0


def contacts(path, dt):
    """First and last step of each contact."""
    touch = np.concatenate([[False], in_contact(path, dt), [False]])
    return list(zip(np.where(touch[1:] & ~touch[:-1])[0], np.where(~touch[1:] & touch[:-1])[0]))


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """One rank, wall balls, default settings: one ball, and the crowd.

    The box for the runs on ranks: the borders of two and of four ranks in x, and of two in y, lie where
    the ball is in the middle of a contact."""
    path = run(tmp_path_factory.mktemp("one"), every=1)
    crowd = run(tmp_path_factory.mktemp("crowd"), balls=CROWD)
    middle = [path[(begin + end) // 2, 0, :2] for begin, end in contacts(path[:, 0], 4e-4) if end - begin > 15]
    border = min((x for x, y in middle), key=abs)
    other = max(x for x, y in middle if x < border - 0.48)
    side = min((y for x, y in middle), key=abs)
    reach = 2 * (border - other)
    box = [(border - reach, border + reach), (side - 0.3, side + 0.3), BOX[2]]
    return {"one": path[::100], "every": path[:, 0], "crowd": crowd, "box": box, "borders": (border, other, side)}


def test_the_ball_bounces_and_rolls_and_touches_at_the_borders(reference):
    """The trajectory that the tests below compare is worth comparing."""
    path = reference["every"]
    assert len(contacts(path, 4e-4)) > 8
    assert path[-1, 0] - path[0, 0] > 0.8
    assert path[-1, 7] > 20.0  # rolls along +x: turns about +y
    touch = in_contact(path, 4e-4)
    for axis, border in zip((0, 0, 1), reference["borders"]):
        crossing = np.argmax(path[:, axis] > border)
        assert touch[crossing - 3:crossing + 3].all()


# --- frozen atoms ---


@pytest.mark.parametrize("case", [
    dict(), dict(style="rolling_radius reduced limit_damping yes mass ball"),
    dict(coeff="stiffness 1e5 1e5 damping 60 40 friction 35 rolling 0.2 rolling_spring 3e4 5"),
    dict(balls=[{**BALLS[0], "d": 0.16, "z": 0.2}]), dict(balls=[{**BALLS[0], "d": 0.06, "z": 0.15}])],
    ids=["default", "other style", "other coefficients", "larger ball", "smaller ball"])
def test_wall_balls_are_frozen_atoms(tmp_path, case):
    wall = run(tmp_path, **case)
    for newton in ("on", "off"):
        assert difference(wall, run(tmp_path, wall=False, newton=newton, **case)) < 1e-9
    assert np.abs(wall[-1, 0, :3] - wall[0, 0, :3]).max() > 0.3


def test_the_comparison_sees_a_small_change(tmp_path, reference):
    positions = floor()
    positions = [(x, y, z + 1e-6) for x, y, z in positions]
    assert difference(reference["one"], run(tmp_path, positions=positions)) > 1e-6
    assert difference(reference["one"], run(tmp_path, coeff=COEFF.replace("rolling 0.05", "rolling 0.05005"))) > 1e-6


# --- ranks, order, lists ---


@pytest.mark.parametrize("newton, ranks, processors", [
    ("on", 2, "2 1 1"), ("on", 2, "1 2 1"), ("on", 4, "4 1 1"), ("on", 4, "2 2 1"), ("on", 4, "2 1 2"),
    ("off", 1, "* * *"), ("off", 4, "2 2 1")])
def test_ranks(tmp_path, reference, newton, ranks, processors):
    settings = dict(np=ranks, processors=processors, newton=newton, box=reference["box"])
    assert difference(reference["one"], run(tmp_path, **settings)) < 1e-9
    assert difference(reference["crowd"], run(tmp_path, balls=CROWD, **settings)) < 1e-9


def test_frozen_atoms_on_ranks(tmp_path, reference):
    four = run(tmp_path, wall=False, np=4, processors="4 1 1", box=reference["box"])
    assert difference(reference["one"], four) < 1e-9


@pytest.mark.parametrize("settings", [
    dict(neigh_modify="every 1 delay 0 check no"), dict(atom_modify="sort 1 0.3"), dict(atom_modify="sort 0 0"),
    dict(atom_modify="sort 1 0.3", neigh_modify="every 1 delay 0 check no"), dict(skin=0.2), dict(skin=0.003)],
    ids=["rebuilt every step", "sorted", "never sorted", "sorted every step", "large skin", "small skin"])
def test_sorting_and_lists(tmp_path, reference, settings):
    assert difference(reference["one"], run(tmp_path, **settings)) < 1e-9
    assert difference(reference["crowd"], run(tmp_path, balls=CROWD, **settings)) < 1e-9


def test_lists_rebuilt_every_step_on_ranks(tmp_path, reference):
    """The ball changes its rank in the middle of a contact."""
    settings = dict(np=4, atom_modify="sort 1 0.3", neigh_modify="every 1 delay 0 check no", box=reference["box"])
    assert difference(reference["one"], run(tmp_path, processors="2 2 1", **settings)) < 1e-9
    assert difference(reference["crowd"], run(tmp_path, balls=CROWD, processors="4 1 1", **settings)) < 1e-9


def test_runs_in_pieces(tmp_path, reference):
    """35 runs instead of one, without a restart: contacts and half-step velocities are not forgotten."""
    for balls in (BALLS, CROWD):
        whole = run(tmp_path, balls=balls, steps=1400)
        log = run_deck(make_deck(tmp_path, balls=balls) + "run 40\n" * 35, tmp_path)
        assert log.count("Loop time") == 35
        assert difference(whole, trajectory(tmp_path)) < 1e-9


def test_shifted_origin(tmp_path, reference):
    """Coordinates of 2e4 m leave 4e-12 m of resolution, 1e-8 of the overlaps; friction and bounces enlarge it."""
    origin = np.array([-20000.0, 13000.0, 1500.0])
    shifted = run(tmp_path, origin=tuple(origin))
    shifted[..., :3] -= origin
    assert difference(reference["one"], shifted) < 1e-4


def test_sparse_and_large_floor_balls(tmp_path):
    """Other sizes of the search cells: fixed balls far apart, and larger than the moving one."""
    far = [(x, y, -0.3) for x in (-0.8, 0.0, 0.8) for y in (-0.2, 0.2)] + floor(nx=4, ny=2)
    settings = dict(positions=far, balls=[dict(x=0.01, y=0.02, z=0.2, d=D, v=(0.5, 0.1, 0.0))], steps=800)
    assert difference(run(tmp_path, **settings), run(tmp_path, wall=False, **settings)) < 1e-9
    large = floor(diameter=0.3, spacing=0.2, nx=8, ny=3)
    settings = dict(positions=large, diameter=0.3, balls=[{**BALLS[0], "z": 0.35}])
    assert difference(run(tmp_path, **settings), run(tmp_path, wall=False, **settings)) < 1e-9


# --- restart ---


def held(tmp_path, **settings):
    """Two fixed balls in a row along y carry a ball that could roll over them along x, but for its contact springs.
    Three times, none on the first rank of four."""
    places = (-0.3, 0.0, 0.3)
    rail = [(x, y, 0.0) for x in places for y in (-0.05, 0.05)]
    ball = [dict(x=x, y=0.0, z=math.sqrt(D * D - 0.05 ** 2) - 1e-5, d=D, v=(0, 0, 0)) for x in places]
    options = dict(positions=rail, balls=ball, gravity="0.05 0 -1", every=50,
                   coeff="stiffness 1e5 1e5 restitution 0.1 friction 40 rolling 0.4")
    return make_deck(tmp_path, **{**options, **settings})


RESTART = """
read_restart mid.restart
neighbor 0.02 bin
neigh_modify delay 0
comm_modify vel yes
timestep 4e-4
fix {id} moving wall/gran/balls 2 0.1 file floor.xyz
fix gravity moving gravity 9.81 vector {gravity}
fix move moving nve/sphere
dump trace moving custom {every} again.txt id x y z vx vy vz omegax omegay omegaz
dump_modify trace sort id format float %.17g
run {steps}
"""


@pytest.mark.parametrize("ranks", [(1, 1), (4, 1), (1, 4), pytest.param((4, 4), marks=pytest.mark.long)])
def test_restart_of_a_ball_held_by_its_springs(tmp_path, ranks):
    """Without the springs' history the ball would roll off."""
    for style in ("scheme plain", ""):
        run_deck(held(tmp_path, style=style, processors="4 1 1" if ranks[0] == 4 else "* * *")
                 + "restart 2000 cut.*.restart\nrun 3000\n", tmp_path, np=ranks[0])
        whole = trajectory(tmp_path)[-21:]
        assert np.abs(whole[-1, :, 0] - (-0.3, 0.0, 0.3)).max() < 1e-4  # held

        restart = RESTART.replace("mid.", "cut.2000.")
        run_deck(restart.format(id="ground", gravity="0.05 0 -1", every=50, steps=1000), tmp_path, np=ranks[1])
        again = trajectory(tmp_path, "again.txt")
        assert np.abs(again[..., :3] - whole[..., :3]).max() < 1e-12 * D

        # the same under another name: the contacts of the restart file find no owner

        run_deck(restart.format(id="other", gravity="0.05 0 -1", every=50, steps=1000), tmp_path, np=ranks[1])
        forgot = trajectory(tmp_path, "again.txt")
        assert np.abs(forgot[..., :3] - whole[..., :3]).max() > 1e-5 * D


def cut_and_go_on(tmp_path, steps=150, dt=4e-4, forget=None, **settings):
    """Cut a run in the middle of a contact; the frames of the uncut run from there, and of the restarted one."""
    deck = make_deck(tmp_path, dt=dt, every=1, **settings)
    run_deck(deck + f"run {round(0.6 / dt)}\n", tmp_path)
    path = trajectory(tmp_path)
    half = round(0.004 / dt)
    cut = next(begin for begin, end in contacts(path[:, 0], dt)[1:] if end - begin > 2 * half) + half
    assert cut + steps * 4e-4 / dt < len(path)

    run_deck(deck.replace("custom 1 trace", f"custom {round(4e-4 / dt)} trace")
             + f"restart {cut} cut.*.restart\nrun {cut}\n", tmp_path)
    ground = "fix ground moving wall/gran/balls 2 0.1 file floor.xyz"
    again = RESTART.replace("fix {id} moving wall/gran/balls 2 0.1 file floor.xyz",
                            ground if settings.get("wall", True) else "fix ground floor freeze")
    again = again.replace("mid.", f"cut.{cut}.").replace("timestep 4e-4", f"timestep {dt}")
    if forget:
        again = again.replace("fix ground", "fix other")
    steps = round(steps * 4e-4 / dt)
    log = run_deck(again.format(gravity=SLOPE, every=1, steps=steps), tmp_path, expect_error=forget)
    assert "CONTACT_HISTORY" in log    # the internal fix of the pair style takes its part of the file
    return path[cut:cut + steps + 1], trajectory(tmp_path, "again.txt")


@pytest.mark.parametrize("coeff", [UNDAMPED, COEFF], ids=["undamped", "damped"])
@pytest.mark.parametrize("settings", [dict(), dict(balls=CROWD), dict(wall=False), dict(balls=CROWD, wall=False)],
                         ids=["ball", "crowd", "ball on atoms", "crowd on atoms"])
def test_restart_during_a_contact(tmp_path, settings, coeff):
    """The continued run is the uncut one, to rounding."""
    assert difference(*cut_and_go_on(tmp_path, coeff=coeff, **settings)) < 1e-10


def test_restart_that_forgets_a_contact(tmp_path):
    """An impact overlaps by more than 5 % of the radius: as a new contact it would stop the run."""
    cut_and_go_on(tmp_path, coeff=UNDAMPED, forget="Fix wall/gran/balls other: 1 pairs overlap at the start")


def test_restart_after_clear(tmp_path):
    """The contacts come back too when the restart file is read by the same process."""
    again = RESTART.replace("mid.", "cut.1100.").replace("fix {id} moving wall/gran/balls 2 0.1 file floor.xyz",
                                                         "fix ground floor freeze")
    deck = make_deck(tmp_path, balls=CROWD, wall=False, coeff=UNDAMPED)
    run_deck(deck + "restart 1100 cut.*.restart\nrun 1500\nclear\n"
             + again.format(gravity=SLOPE, every=100, steps=400), tmp_path)
    assert difference(trajectory(tmp_path)[11:], trajectory(tmp_path, "again.txt")) < 1e-9


def test_restart_with_balls_of_another_build(tmp_path):
    """Balls lie on the edges of the fix's cells: a last bit sorts them otherwise, and springs must find their balls."""
    rail = [(x, y, 0.0) for x in (-0.3, 0.0, 0.3) for y in (-0.05, 0.05)]
    rail += [(0.05 * i, 0.05 * j, -0.5) for i in range(-10, 11) for j in range(-5, 6)]    # cells of one diameter
    run_deck(held(tmp_path, positions=rail) + "restart 1000 cut.*.restart\nrun 2000\n", tmp_path)
    whole = trajectory(tmp_path)[-21:]
    again = RESTART.replace("mid.", "cut.1000.").format(id="ground", gravity="0.05 0 -1", every=50, steps=1000)
    random = np.random.default_rng(3)
    for _ in range(3):
        np.savetxt(tmp_path / "floor.xyz", rail + random.uniform(-1e-14, 1e-14, np.shape(rail)), fmt="%.17g")
        run_deck(again, tmp_path)
        assert np.abs(trajectory(tmp_path, "again.txt")[..., :3] - whole[..., :3]).max() < 1e-9 * D


def test_restart_with_the_balls_in_another_order(tmp_path):
    run_deck(held(tmp_path) + "run 100\nwrite_restart mid.restart\n", tmp_path)
    again = RESTART.format(id="ground", gravity="0 0 -1", every=50, steps=100)
    rail = np.loadtxt(tmp_path / "floor.xyz")
    other = "Fix wall/gran/balls ground: the restart file was written with other fixed balls "
    for order in [1, 0, 2, 3, 4, 5], [0, 1, 2, 3, 5, 4]:
        np.savetxt(tmp_path / "floor.xyz", rail[order], fmt="%.17g")
        run_deck(again, tmp_path, expect_error=other + "(other places, or another order, of 6)")
    np.savetxt(tmp_path / "floor.xyz", rail + 0.001 * D, fmt="%.17g")
    run_deck(again, tmp_path, expect_error=other + "(other places")
    np.savetxt(tmp_path / "floor.xyz", rail, fmt="%.17g")
    run_deck(again.replace("balls 2 0.1", "balls 2 0.11"), tmp_path,
             expect_error=other + "(diameter 0.1 there, 0.11 here)")
    run_deck(again, tmp_path)


def test_a_fix_before_it_deletes_balls(tmp_path):
    """Evaporate deletes when lists are made anew, and the last ball takes the place of one that is gone: each of the
    others keeps its springs, as if the wall fix were first."""
    def run_with(first):
        deck = held(tmp_path, neigh_modify="delay 0 every 10 check no", atom_modify="sort 0 0")
        for x in (-0.9, -0.7, 0.8):     # to be deleted, in no contact
            deck = deck.replace("create_atoms 1 single", f"create_atoms 1 single {x} 0.2 0.4\ncreate_atoms 1 single", 1)
        deck = deck.replace("set atom ", "set atom 1*6 diameter 0.1 density 2500\nset atom ")
        gone = "region high block INF INF INF INF 0.3 INF units box\nfix gone all evaporate 100 3 high 4711\n"
        wall = next(line for line in deck.splitlines() if line.startswith("fix ground"))
        deck = deck.replace(wall, gone + wall if first else wall + "\n" + gone)
        deck = deck.replace("fix gravity", "group held id 4:6\nfix gravity").replace("fix move moving", "fix move held")
        deck = deck.replace("fix gravity moving", "fix gravity held").replace("dump trace moving", "dump trace held")
        run_deck(deck + "run 1000\n", tmp_path)
        return trajectory(tmp_path)[-1]

    expected, found = run_with(False), run_with(True)
    assert expected.shape == (3, 9)
    assert np.abs(found - expected).max() < 1e-12


# --- overlaps at the start ---


def test_initial_overlap_with_a_fixed_ball(tmp_path):
    for share, stops in ((0.049, False), (0.06, True)):
        ball = [dict(x=0.0, y=0.0, z=D - share * D / 2, d=D, v=(0, 0, 0))]
        deck = make_deck(tmp_path, balls=ball, positions=[(0.0, 0.0, 0.0), (0.3, 0.0, 0.0)])
        run_deck(deck + "run 1\n", tmp_path, expect_error=(
            "Fix wall/gran/balls ground: 1 pairs overlap at the start by more than 5 % of the radius, worst 6 % "
            "between ball 1 and the fixed ball at 0 0 0, at 0 0 0.097") if stops else None)


@pytest.mark.parametrize("ranks", [1, 2])
def test_initial_overlap_of_two_balls(tmp_path, ranks):
    balls = [dict(x=x, y=0.0, z=0.3, d=d, v=(0, 0, 0)) for x, d in
             ((-0.5, D), (-0.5 + 0.97 * D, D), (0.5, D), (0.5 + 0.06, 0.06))]
    # the second pair: centres 0.06 apart, radii 0.05 + 0.03; the smaller radius counts
    deck = make_deck(tmp_path, balls=balls, processors="2 1 1" if ranks == 2 else "* * *")
    run_deck(deck + "run 1\n", tmp_path, np=ranks, expect_error=(
        "Pair gran/restitution: 2 pairs overlap at the start by more than 5 % of the radius, "
        "worst 66.67 % between ball"))
    balls[3]["x"] = 0.5 + 0.08 - 0.04 * 0.03
    balls[1]["x"] = -0.5 + 0.98 * D
    deck = make_deck(tmp_path, balls=balls, processors="2 1 1" if ranks == 2 else "* * *")
    run_deck(deck + "run 1\n", tmp_path, np=ranks)


def test_delete_balls(tmp_path):
    """Overlaps of 3, 8 and 20 % of the radius: the limit decides, the volume is that of the removed balls."""
    balls = [dict(x=0.3 * k, y=0.0, z=D - share * D / 2, d=D, v=(0, 0, 0)) for k, share in enumerate((0.03, 0.08, 0.2))]
    balls.append(dict(x=-0.5, y=0.0, z=0.3, d=0.2, v=(0, 0, 0)))
    settings = dict(balls=balls, positions=[(0.3 * k, 0.0, 0.0) for k in range(3)])
    volume = math.pi * D ** 3 / 6
    for fraction, removed in ((0.05, 2), (0.1, 1), (0.0, 3), (0.5, 0)):
        log = run_deck(make_deck(tmp_path, **settings, before=f"delete_balls moving overlap {fraction}") +
                       "print \"left $(atoms)\"\n", tmp_path)
        line = next(line for line in log.splitlines() if line.startswith("Delete_balls:"))
        assert line == (f"Delete_balls: {removed} balls of group moving removed that overlapped fixed balls by more "
                        f"than {fraction:g} of their radius: {removed * volume:.6g} m3 of balls; "
                        f"{4 - removed} balls left")
        assert f"left {4 - removed}" in log.splitlines()
        share = removed * D ** 3 / (3 * D ** 3 + 0.2 ** 3)
        assert (f"Delete_balls: {100 * share:.0f} % of the volume of group moving is removed" in log) == (share > 0.2)
    # a sixth of the volume: no warning
    several = [dict(x=-1.1 + 0.15 * k, y=0.25, z=0.5, d=D, v=(0, 0, 0)) for k in range(5)]
    log = run_deck(make_deck(tmp_path, **{**settings, "balls": several + [{**balls[2], "y": 0.0}]},
                             before="delete_balls moving overlap 0.05"), tmp_path)
    assert "Delete_balls: 1 balls" in log and "WARNING: Delete_balls" not in log
    run_deck(make_deck(tmp_path, **settings, before="delete_balls moving overlap 0.05") + "run 1\n", tmp_path, np=2)


# --- output ---


@pytest.mark.parametrize("ranks", [1, 4])
def test_force_on_the_ground_is_the_weight(tmp_path, ranks):
    """Balls at rest in the hollows of a regular floor: force = their weight, along gravity."""
    positions = [(0.1 * i, 0.1 * j, 0.0) for i in range(-8, 9) for j in range(-3, 4)]
    balls = [dict(x=x, y=y, z=math.sqrt(D * D - 2 * 0.05 ** 2), d=D, v=(0, 0, 0)) for x in (-0.65, -0.25, 0.25, 0.65)
             for y in (-0.15, 0.15)]
    deck = make_deck(tmp_path, balls=balls, positions=positions, processors="4 1 1" if ranks == 4 else "* * *",
                     gravity="0 0 -1", coeff="stiffness 1e5 1e5 restitution 0.01 friction 30 rolling 0.1", dt=5e-5)
    log = run_deck(deck + "run 3000\n"
                   "print \"ground $(f_ground[1]:%.9e) $(f_ground[2]:%.9e) $(f_ground[3]:%.9e) $(f_ground)\"\n",
                   tmp_path, np=ranks)
    words = next(line for line in log.splitlines() if line.startswith("ground")).split()[1:]
    weight = 8 * MASS * G
    assert float(words[2]) == pytest.approx(-weight, rel=1e-7)
    assert abs(float(words[0])) < 1e-7 * weight and abs(float(words[1])) < 1e-7 * weight
    assert float(words[3]) == len(positions)


def test_examples_of_the_pages(tmp_path):
    (tmp_path / "floor.xyz").write_text("0 0 0\n")
    deck = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region ground block -10 10 -10 10 -5 0
region slip sphere 0 0 2 4
region scree block -10 0 -10 10 -20 20
region forest block 0 10 0 10 -20 20
region box block -12 12 -12 12 -12 12
create_box 5 box
region soil block -3 3 -3 3 -1 5
lattice sc 1.25
create_atoms 1 region soil
set type 1 diameter 1.25 density 2500
group soil type 1
pair_style gran/restitution
pair_coeff * * stiffness 1e7 1e7 restitution 0.5
"""
    log = run_deck(deck + doc_examples("fix_wall_gran_balls") + "\n" + doc_examples("delete_balls")
                   + "\ntimestep 1e-4\nrun 1\n", tmp_path)
    removed = [int(line.split()[1]) for line in log.splitlines() if line.startswith("Delete_balls:")]
    assert len(removed) == 2 and removed[0] > 0
    assert (tmp_path / "field.xyz").read_text().count("\n") > 100
