"""Fix ground/motion: free balls keep their absolute velocity, blocks slide as Newmark says, the guard sees the work."""

import re

import numpy as np
import pytest
from deck_helpers import (collapse_deck, doc_examples, dump_difference, flight_head, read_dump, run_deck, write_asc,
                          write_balls, write_collapse)

G = 9.81
PHI = 20.0
SHAKE = "fix shake soil ground/motion motion.txt"


def write_motion(folder, t, a):
    """t ax ay az; a: a column, or three."""
    a = np.asarray(a, float)
    a = np.column_stack([a, 0 * a, 0 * a]) if a.ndim == 1 else a
    rows = np.column_stack([t, a])
    (folder / "motion.txt").write_text("# t ax ay az\n" + "".join(
        " ".join(repr(float(x)) for x in row) + "\n" for row in rows))


def integrals(t, a, at):
    """Velocity and displacement at one time, of straight lines between the points."""
    t, a = np.asarray(t, float), np.asarray(a, float)
    v, d = np.zeros(a.shape[1]), np.zeros(a.shape[1])
    for k in range(len(t) - 1):
        h = min(t[k + 1], at) - t[k]
        if h <= 0:
            break
        end = a[k] + (a[k + 1] - a[k]) * h / (t[k + 1] - t[k])
        d = d + v * h + (2 * a[k] + end) * h * h / 6
        v = v + (a[k] + end) * h / 2
    if at > t[-1]:
        d = d + v * (at - t[-1])
    return v, d


def random_motion(folder, n=200, seconds=2.0, seed=3):
    rng = np.random.default_rng(seed)
    t = np.linspace(0, seconds, n + 1)
    a = 3.0 * rng.standard_normal((n + 1, 3))
    write_motion(folder, t, a)
    return t, a


# --- free balls ---


def fly(tmp_path, dt, steps, fixes="fix shake all ground/motion motion.txt", np_=1, more=""):
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)), -100, -100, 10)
    x = [[5.0 * k, -3.0 * k, 10 + k] for k in range(6)]
    v = [[1 + k, -2 * k, 0.5 * k] for k in range(6)]
    write_balls(tmp_path / "balls.data", x, 1.0, v, [(-1000, 1000)] * 3)
    log = run_deck(flight_head(dt=repr(dt)) + fixes + f"""
thermo_style custom step {" ".join(f"f_shake[{k}]" for k in range(1, 10))}
thermo_modify format float %.17g
{more}
dump all all custom {steps} end.dump id x y z vx vy vz
dump_modify all sort id format float %.17g
run {steps}
""", tmp_path, np=np_)
    last = [line.split() for line in log.splitlines() if re.match(rf" *{steps} ", line)][-1]
    return np.array(v), np.array(x), read_dump(tmp_path / "end.dump")[steps], np.array(last[1:], float)


# 7: less than one step between points of the record; 0.01 s between two of them
@pytest.mark.parametrize("dt, steps", [(0.001, 2500), (0.000731, 2000), (0.01, 190), (0.07, 30)])
def test_free_ball_keeps_its_absolute_velocity(tmp_path, dt, steps):
    t, a = random_motion(tmp_path)
    v, _, end, ground = fly(tmp_path, dt, steps)
    velocity, displacement = integrals(t, a, dt * steps)
    most = max(np.linalg.norm(integrals(t, a, at)[0]) for at in t)
    assert np.abs(end[:, 4:] + velocity - v).max() <= 1e-12 * most
    assert ground[3:6] == pytest.approx(velocity, abs=1e-12 * most)
    assert ground[6:] == pytest.approx(displacement, rel=1e-11)
    after = dt * steps > 2
    now = [0, 0, 0] if after else [np.interp(dt * steps, t, a[:, c]) for c in range(3)]
    assert ground[:3] == pytest.approx(now, abs=1e-9)


def test_path_of_a_free_ball(tmp_path):
    t, a = random_motion(tmp_path)
    v, x, end, _ = fly(tmp_path, 0.0005, 4000)
    assert end[:, 1:4] == pytest.approx(x + 2.0 * v - integrals(t, a, 2.0)[1], abs=2e-5)


def test_order_of_the_fixes_does_not_matter(tmp_path):
    random_motion(tmp_path)
    _, _, one, _ = fly(tmp_path, 0.003, 600)
    _, _, two, _ = fly(tmp_path, 0.003, 600,
                       "unfix move\nfix shake all ground/motion motion.txt\nfix move all nve/sphere")
    assert np.abs(one).max() > 1 and one == pytest.approx(two, abs=1e-11)


def test_scale_and_start(tmp_path):
    t, a = random_motion(tmp_path)
    v, _, end, ground = fly(tmp_path, 0.001, 1500, "fix shake all ground/motion motion.txt scale -0.5 start 0.3")
    velocity, displacement = integrals(t, -0.5 * a, 1.2)
    assert ground[3:] == pytest.approx([*velocity, *displacement], rel=1e-10)
    assert end[:, 4:] == pytest.approx(v - velocity, abs=1e-12)


def test_time_goes_on_whatever_the_deck_does(tmp_path):
    t, a = random_motion(tmp_path)
    v, _, end, _ = fly(tmp_path, 0.0005, 1000,
                       more="run 600\ntimestep 0.002\nrun 100\nreset_timestep 0\ntimestep 0.0005")
    assert end[:, 4:] == pytest.approx(v - integrals(t, a, 0.3 + 0.2 + 0.5)[0], abs=1e-11)


@pytest.mark.parametrize("pieces", ["run 500", "run 130\nrun 20\nrun 350", "run 130\nrun 370 every 37 NULL"])
def test_two_motions_add_up(tmp_path, pieces):
    """A main shock and an aftershock: a free ball loses nothing when a run goes on."""
    random_motion(tmp_path, seed=4)
    (tmp_path / "motion.txt").rename(tmp_path / "after.txt")
    t, a = random_motion(tmp_path)
    after = np.loadtxt(tmp_path / "after.txt")
    v = [[1.0, 2.0, 3.0], [-1.0, 0.5, 0.0]]
    write_asc(tmp_path / "ground.asc", np.zeros((4, 4)), -20, -20, 10)
    write_balls(tmp_path / "balls.data", [[0, 0, 0], [5, 5, 5]], 1.0, v, [(-20, 20)] * 3)
    run_deck(flight_head().replace("pair_style none", """comm_modify vel yes
pair_style gran/restitution
pair_coeff * * stiffness 1e7 1e7 restitution 0.5""") + f"""
fix shake all ground/motion motion.txt
fix again all ground/motion after.txt scale -0.5 start 0.1
{pieces}
write_dump all custom end.dump id x y z vx vy vz modify sort id format float %.17g
""", tmp_path)
    frame, = read_dump(tmp_path / "end.dump").values()
    ground = integrals(t, a, 0.5)[0] + integrals(after[:, 0], -0.5 * after[:, 1:], 0.4)[0]
    assert frame[:, 4:] == pytest.approx(v - ground, abs=1e-12)


def test_a_jump_counts_where_it_is(tmp_path):
    """Half a step is as good as any other place for a jump."""
    write_motion(tmp_path, [0.1037, 0.1037, 0.4041, 0.4041], [0, 5, 5, 0])
    v, _, end, _ = fly(tmp_path, 0.01, 60)
    assert end[:, 4] == pytest.approx(v[:, 0] - 5 * 0.3004, abs=1e-13)


def test_balls_that_nothing_integrates_stay(tmp_path):
    random_motion(tmp_path)
    for held in ("group held id 1 2\nfix freeze held freeze", "group held id 1 2\ngroup free subtract all held\n"
                 "unfix move\nfix move free nve/sphere"):
        v, _, end, _ = fly(tmp_path, 0.001, 100, "fix shake all ground/motion motion.txt\n" + held)
        assert end[:2, 4:] == pytest.approx(v[:2], abs=0)
        assert (np.abs(end[2:, 4:] - v[2:]) > 1e-3).any(axis=1).all()


def test_bodies_that_do_not_feel_it_are_told(tmp_path):
    random_motion(tmp_path)
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)), -100, -100, 10)
    write_balls(tmp_path / "balls.data", [[0, 0, 1], [0, 0, 2], [5, 5, 5]], 1.0, None, [(-9, 9)] * 3)
    log = run_deck(flight_head() + "unfix move\ngroup body id 1 2\ngroup soil id 3\nfix body body rigid single\n"
                   "fix move soil nve/sphere\nfix shake all ground/motion motion.txt\nrun 3", tmp_path)
    assert re.search("WARNING: Fix ground/motion shake: .*2 of 3 balls of the group are not", log)


# --- Newmark: a ball that cannot roll on a frozen one of 2 km slides as a block ---

BLOCK = """
units        si
atom_style   sphere
atom_modify  map array
boundary     f f f
comm_modify  vel yes
region       box block -1200 1200 -1200 1200 -2200 10
create_box   2 box
create_atoms 1 single 0 0 0.0099990
create_atoms 2 single 0 0 -1000
set          type 1 diameter 0.02 density 2500
set          type 2 diameter 2000 density 2500
variable     mass equal 2500*PI*0.02^3/6
group        soil type 1
group        held type 2
pair_style   gran/restitution
pair_coeff   * * stiffness 1e5 1e5 restitution 0.1 friction {phi} rolling 100
timestep     $(0.25*sqrt(v_mass/1e5))
neighbor     0.01 bin
neigh_modify every 1 delay 0 check yes
velocity     all set 0 0 0
fix          weight soil gravity {g} vector {gx} 0 {gz}
fix          hold held freeze
fix          move soil nve/sphere
fix          settle soil viscous 1.0
run          4000
unfix        settle
velocity     soil set 0 0 0
fix          shake soil ground/motion motion.txt
variable     place equal x[1]
variable     from equal $(v_place)
thermo_style custom step time v_place ke
thermo       200
run          $(round({seconds}/dt))
print        "moved $(v_place-v_from:%.10g)"
"""


def slide(tmp_path, t, a, seconds, tilt=0.0):
    """Displacement of the block against the ground (m); tilt: degrees, down towards -x."""
    write_motion(tmp_path, t, a)
    tilt = np.radians(tilt)
    log = run_deck(BLOCK.format(phi=PHI, g=G, gx=-np.sin(tilt), gz=-np.cos(tilt), seconds=seconds), tmp_path)
    assert "the energy of the balls" not in log
    return float(re.search(r"^moved (\S+)", log, re.M)[1])


def yield_acceleration(tilt):
    """Of the ground, along the slope, that makes the block slide down."""
    tilt = np.radians(tilt)
    return G * (np.cos(tilt) * np.tan(np.radians(PHI)) - np.sin(tilt))


@pytest.mark.parametrize("tilt", [0, 10])
def test_newmark_rectangle(tmp_path, tilt):
    ay, seconds = yield_acceleration(tilt), 0.15
    a = 2.2 * ay
    found = slide(tmp_path, [0, 0, seconds, seconds], [0, a, a, 0], 0.8, tilt)
    speed = a * seconds
    assert -found == pytest.approx(speed ** 2 / (2 * ay) - speed ** 2 / (2 * a), rel=0.01)


@pytest.mark.parametrize("tilt", [0, 10])
@pytest.mark.parametrize("share", [0.99, 1.01])
def test_yield_acceleration(tmp_path, share, tilt):
    """One per cent below it the block stands, one above it slides."""
    a = share * yield_acceleration(tilt)
    found = -slide(tmp_path, [0, 0.5, 1.5], [0, a, a], 1.5, tilt)
    if share < 1:
        assert abs(found) < 1e-5
    else:
        assert found == pytest.approx(0.5 * (share - 1) / share * a, rel=0.3)


def test_vertical_motion_changes_the_weight(tmp_path):
    """The ground rises at 0.5 g: friction holds half as much again."""
    a = 1.4 * yield_acceleration(0)
    motion = np.array([[0, 0, 0], [0, 0, 0.5 * G], [a, 0, 0.5 * G], [a, 0, 0.5 * G]])
    assert abs(slide(tmp_path, [0, 0.2, 0.7, 1.0], motion, 1.0)) < 1e-5
    motion[:, 2] *= -1
    found = -slide(tmp_path, [0, 0.2, 0.7, 1.0], motion, 1.0)
    assert found > 0.3


# --- a collapse: restarts, ranks, suffix, guard ---


def collapse(tmp_path, run, np_=1, before="", out="out", **settings):
    write_collapse(tmp_path, 200, mixed=True)
    random_motion(tmp_path, 300, 3.0)
    text = collapse_deck(run, every=50, out=out, sort="sort 0 0", **settings)
    text = before + text.replace("fix deposit", SHAKE + "\nfix deposit", 1)
    return run_deck(text, tmp_path, np=np_)


@pytest.mark.parametrize("scheme, ranks, other", [("exact", 1, 2), ("plain", 2, 4)])
def test_restart(tmp_path, scheme, ranks, other):
    collapse(tmp_path, "restart 400 cut.*.restart\nrun 1000", ranks, scheme=scheme)
    collapse(tmp_path, "restart 400 later.*.restart\nrun 600", ranks, scheme=scheme,
             begin="read_restart cut.400.restart", out="again")
    collapse(tmp_path, "run 600", other, scheme=scheme, begin="read_restart cut.400.restart", out="other")
    frames = [read_dump(tmp_path / f"{name}.dump") for name in ("out", "again", "other")]
    for step in range(450, 1001, 50):
        assert (frames[0][step] == frames[1][step]).all(), step
        assert max(dump_difference(frames[0][step], frames[2][step])) < 1e-7, step


def test_ranks_agree(tmp_path):
    collapse(tmp_path, "run 400")
    collapse(tmp_path, "run 400", 4, out="four")
    one, two = (read_dump(tmp_path / f"{name}.dump")[400] for name in ("out", "four"))
    assert max(dump_difference(one, two)) < 1e-7


def test_suffix_slope(tmp_path):
    collapse(tmp_path, "run 300")
    collapse(tmp_path, "run 300", before="suffix slope\n", out="fast")
    one, two = (read_dump(tmp_path / f"{name}.dump")[300] for name in ("out", "fast"))
    assert max(dump_difference(one, two)) < 1e-9


# --- energy guard: the work of the motion is known to it ---

TREMBLE = """
fix settle soil viscous 20
run 4000
unfix settle
fix shake soil ground/motion motion.txt
{more}
run {steps}
"""


def guard(tmp_path, more="", steps=4000, amplitude=3.0, e="restitution 0.4"):
    """Balls at rest on a floor of fixed balls are shaken; energy growth that the guard saw, and whether it warned."""
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)))
    t = np.linspace(0, 6, 601)
    write_motion(tmp_path, t, amplitude * np.sin(10 * t))
    x = [[5 + 1.02 * i, 5 + 1.02 * j, 1.0 + 1.02 * k] for i in range(4) for j in range(4) for k in range(3)]
    write_balls(tmp_path / "balls.data", x, 1.0, None, [(0, 20), (0, 20), (-3, 20)])
    text = collapse_deck(TREMBLE.format(more=more, steps=steps)).replace("3 stiffness", "2 stiffness", 1)
    text = text.replace("3 1.0 surface", "2 1.0 surface").replace("type 1 2", "type 1")
    text = text.replace("restitution 0.4", e)
    data = (tmp_path / "balls.data").read_text().replace("1 atom types", "2 atom types")
    (tmp_path / "balls.data").write_text(data)
    log = run_deck(text, tmp_path)
    summary = (tmp_path / "out.summary.yaml").read_text()
    return float(re.search(r"energy_growth: (\S+)", summary)[1]), "the energy of the balls" in log


def test_guard_knows_the_work(tmp_path):
    growth, warned = guard(tmp_path)
    assert not warned and growth < 0.01


def test_guard_still_warns(tmp_path):
    """Contacts that are found late give back what nobody put in, motion or not."""
    growth, warned = guard(tmp_path, "neighbor 0.0 bin\nneigh_modify every 20 delay 20 check no\ntimestep 0.004\n"
                           "velocity soil set 0 0 9 sum yes units box", 3000, e="restitution 1.0")
    assert warned and growth > 0.1


# --- wrong input ---


@pytest.mark.parametrize("peak, told", [(49.0, False), (51.0, True)])
def test_gal_is_doubted(tmp_path, peak, told):
    write_motion(tmp_path, [0, 1, 2], [0, peak, 0])
    write_asc(tmp_path / "ground.asc", np.zeros((5, 5)))
    write_balls(tmp_path / "balls.data", [[0, 0, 1]], 1.0, None, [(-9, 9)] * 3)
    log = run_deck(flight_head() + "fix shake all ground/motion motion.txt\nrun 1", tmp_path)
    assert bool(re.search("Fix ground/motion shake: .*at most 50 m/s2.*, got 51 from motion.txt", log)) == told


def test_doc_examples(tmp_path):
    write_asc(tmp_path / "ground.asc", np.zeros((5, 5)))
    write_balls(tmp_path / "balls.data", [[0, 0, 1]], 1.0, None, [(-9, 9)] * 3)
    write_motion(tmp_path, [0, 1, 2], [0, 1, 0])
    run_deck(flight_head() + "group soil type 1\n" + doc_examples("fix_ground_motion") + "run 5", tmp_path)


def test_respa_is_refused(tmp_path):
    random_motion(tmp_path)
    write_balls(tmp_path / "balls.data", [[0, 0, 1]], 1.0, None, [(-9, 9)] * 3)
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)), -100, -100, 10)
    run_deck(flight_head() + "fix shake all ground/motion motion.txt\nrun_style respa 2 2\nrun 1", tmp_path,
             expect_error="Fix ground/motion needs run_style verlet, got respa")
