"""Pair gran/restitution: what it promises of restitution, dashpots, friction, rolling, its table, its errors."""

import math
import re

import numpy as np
import pytest

from deck_helpers import doc_examples, run_deck
from mesh_helpers import stl_text

# Two balls on the x axis, no gravity. kind of the second: ball (moving), frozen (an atom of fix freeze), wall,
# mesh (a plane)
PAIR = """
units si
newton {newton}
atom_style sphere
atom_modify map array
boundary f f f
comm_modify vel yes
region box block -{box} {box} -{box} {box} -{box} {box}
create_box 3 box
neighbor 0.01 bin
neigh_modify delay 0
create_atoms 1 single {x1} {y1} 0
set atom 1 diameter {d1} density {rho1}
{second}
pair_style gran/restitution {style}
{coeff}
{wall}
timestep {dt}
fix move moving nve/sphere
velocity all set 0 0 0
velocity moving set {v1[0]} {v1[1]} 0
{extra}
fix print all print 1 "$(step) $(x[1]) $(y[1]) $(vx[1]) $(vy[1]) $(c_spin1)" file one.txt screen no
fix print2 all print 1 "$(step) {two}" file two.txt screen no
thermo {steps}
run {steps}
"""


def collide(tmp_path, kind="ball", coeff="restitution 0.5", style="", k=1e6, kt=None, d1=0.1, d2=0.1,
            rho1=2500.0, rho2=2500.0, v1=(1.0, 0.0), v2=(-1.0, 0.0), y1=0.0, dt=2e-6, steps=2500,
            newton="on", extra="", gap=1e-5, box=1, expect_error=None, np=1):
    """Let two balls collide; return log and, per step, x y vx vy wz of the first and of the second."""
    half = 0.5 * (d1 + d2)
    x1 = -math.sqrt((half + gap) ** 2 - y1 ** 2)
    second, wall, two = "", "", "0 0 0 0 0"
    if kind in ("ball", "frozen"):
        second = (f"create_atoms 2 single 0 0 0\nset atom 2 diameter {d2} density {rho2}\n"
                  "group second id 2\n")
        two = "$(x[2]) $(y[2]) $(vx[2]) $(vy[2]) $(c_spin2)"
    if kind == "ball":
        second += "group moving union all"
        extra = f"velocity second set {v2[0]} {v2[1]} 0\n" + extra
    elif kind == "frozen":
        second += "group moving subtract all second"
        extra = "fix freeze second freeze\n" + extra
    else:
        second = "group moving union all"
        (tmp_path / "wall.xyz").write_text("0 0 0\n")
        wall = f"fix wall moving wall/gran/balls 3 {d2} file wall.xyz"
    if kind == "mesh":  # through the first ball's point of contact with the second one
        corners = [(-0.5 * d2, y, z) for y, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        (tmp_path / "wall.stl").write_text(stl_text([corners[:3], (corners[0], *corners[2:])]))
        wall = "fix wall moving wall/gran/mesh 3 wall.stl"
    if "pair_coeff" not in coeff:
        coeff = f"pair_coeff * * stiffness {k} {kt or k} {coeff}"
    # c_w[1] is the first ball's in some LAMMPS only
    spins = "group first id 1\ncompute w all property/atom omegaz\ncompute spin1 first reduce sum c_w\n"
    if "group second" in second:
        spins += "compute spin2 second reduce sum c_w\n"
    extra = spins + extra
    deck = PAIR.format(**{**locals(), "second": second})
    log = run_deck(deck, tmp_path, np=np, expect_error=expect_error)
    if expect_error:
        return log
    one, other = (numbers(tmp_path / name) for name in ("one.txt", "two.txt"))
    return log, one, other


def numbers(file):
    return np.loadtxt(file, comments="#")[:, 1:]


def ball_mass(d, rho):
    return rho * math.pi * d ** 3 / 6


def speed_ratio(one, two):
    return -(one[-1, 2] - two[-1, 2]) / (one[0, 2] - two[0, 2])


def table(log):
    """The start-up table: {(i, j): [kn, kt, cn, zeta, e_moving, e_fixed, friction, rolling, contact/dt]}."""
    text = log.split("contact coefficients")[1].split("e fixed:")[0]
    rows = [line.split() for line in text.splitlines()[2:] if line.strip()]
    return {(int(row[0]), int(row[1])): [None if word == "-" else float(word) for word in row[2:]]
            for row in rows}


# --- restitution ---


@pytest.mark.parametrize("e", [0.1, 0.48, 1.0])
@pytest.mark.parametrize("case", [
    dict(), dict(rho2=10000.0), dict(d2=0.1 * 4 ** (1 / 3)), dict(kind="frozen"), dict(kind="wall"),
    dict(kind="frozen", d2=0.2), dict(kind="wall", d2=0.2)],
    ids=["equal", "4:1 by density", "4:1 by size", "frozen", "wall", "frozen, unequal", "wall, unequal"])
def test_mass_pair_gives_the_target(tmp_path, e, case):
    """Oblique impact test 3 of Chung & Ooi at normal incidence: e out is e in, for every kind of pair."""
    log, one, two = collide(tmp_path, coeff=f"restitution {e}", **case)
    assert speed_ratio(one, two) == pytest.approx(e, abs=0.005)
    i, j = (1, 3) if case.get("kind") == "wall" else (1, 2)
    assert table(log)[i, j][5 if "kind" in case else 4] == pytest.approx(e, abs=1e-4)


PRINTED = [  # ball mass from diameter and density; kn; e; printed dashpot
    (0.185, 8.78 / (math.pi * 0.185 ** 3 / 6), 3.67e7, 0.25, 1.45e4),
    (0.185, 8.78 / (math.pi * 0.185 ** 3 / 6), 3.67e7, 0.445, 8.96e3),
    (1.25, 3411.4, 1.96e9, 0.48, 1.19e6),
    (1.25, 3411.4, 1.96e9, 0.10, 3.09e6)]


@pytest.mark.parametrize("d, rho, k, e, printed", PRINTED)
def test_mass_ball_gives_the_printed_dashpots(tmp_path, d, rho, k, e, printed):
    """Tables 1 and 4: c from the mass of one ball, whether the partner moves or not."""
    def dashpots(style):
        log, _, _ = collide(tmp_path, style=style, coeff=f"restitution {e}", k=k, d1=d, d2=d, rho1=rho,
                            rho2=rho, dt=1e-6, steps=1, box=4)
        wall, _, _ = collide(tmp_path, "wall", style=style, coeff=f"restitution {e}", k=k, d1=d, d2=d,
                             rho1=rho, dt=1e-6, steps=1, box=4)
        return table(log)[1, 2][2], table(wall)[1, 3][2]

    three_digits = [float(f"{c:.3g}") for c in dashpots("mass ball")]
    assert three_digits == [printed, printed]
    moving, fixed = dashpots("mass pair")
    assert float(f"{fixed:.3g}") == printed
    assert moving == pytest.approx(fixed / math.sqrt(2), rel=1e-3)


def test_limit_damping(tmp_path):
    """A force that never pulls ends where it is zero (Schwager & Poeschel 2007): e above the formula's."""
    zeta = -math.log(0.3) / math.hypot(math.pi, math.log(0.3))
    root = math.sqrt(1 - zeta ** 2)
    limited = math.exp(-zeta / root * (math.pi - math.atan2(2 * zeta * root, 1 - 2 * zeta ** 2)))
    assert limited > 0.3 + 0.05
    for kind in ("ball", "wall"):
        for style, e in (("", 0.3), ("limit_damping no", 0.3), ("limit_damping yes", limited)):
            _, one, two = collide(tmp_path, kind, coeff="restitution 0.3", style=style)
            assert speed_ratio(one, two) == pytest.approx(e, abs=0.005), (kind, style)
            pulls = np.diff(one[:, 2]).max() > 1e-9
            assert pulls == (style != "limit_damping yes"), (kind, style)


# --- rolling ---


def pressed(tmp_path, kind, spin, friction=0, steps=2500, coeff="", style="", d2=0.1, k=1e6, dt=2e-6):
    """A ball pressed against a fixed one by 50 N and spinning about z: its wz per step."""
    force = 50.0
    _, one, _ = collide(
        tmp_path, kind, v1=(0, 0), d2=d2, k=k, gap=-force / k, dt=dt, steps=steps, style=style,
        coeff=f"restitution 0.3 friction {friction} {coeff}",
        extra=f"set atom 1 omega 0 0 {spin}\nfix press moving addforce {force} 0 0")
    return one[:, 4]


INERTIA = 0.1 * ball_mass(0.1, 2500) * 0.1 ** 2


@pytest.mark.parametrize("kind", ["wall", "frozen"])
@pytest.mark.parametrize("style, d2, arm", [
    ("", 0.1, 0.05), ("rolling_radius ball", 0.1, 0.05), ("rolling_radius reduced", 0.1, 0.025),
    ("", 0.3, 0.075), ("rolling_radius reduced", 0.3, 0.0375)])
def test_rolling_limit(tmp_path, kind, style, d2, arm):
    """Spin-down of a pressed ball: dw/dt = -mu_r * arm * Fn / I, arm 2 Ri Rj/(Ri+Rj) or half of it."""
    w = pressed(tmp_path, kind, spin=50.0, coeff="rolling 0.3", style=style, d2=d2)
    rate = (w[2000] - w[500]) / (1500 * 2e-6)
    assert rate == pytest.approx(-0.3 * arm * 50.0 / INERTIA, rel=0.001)


@pytest.mark.parametrize("kind", ["wall", "frozen"])
@pytest.mark.parametrize("style, arm", [("", 0.05), ("rolling_radius reduced", 0.025)])
def test_rolling_spring(tmp_path, kind, style, arm):
    """Below the limit the spin swings on the rolling spring: w^2 = kr arm^2 / I. The arm counts twice."""
    w = pressed(tmp_path, kind, spin=0.01, coeff="rolling 0.9 rolling_spring 4e5 0", style=style, steps=8000)
    theory = 0.01 * np.cos(math.sqrt(4e5 * arm ** 2 / INERTIA) * 2e-6 * np.arange(8001))
    assert np.abs(w - theory).max() < 0.02 * 0.01
    assert w.min() < -0.0095  # more than half a period


def test_rolling_spring_defaults_to_the_tangential_one(tmp_path):
    e, kt = 0.3, 1e6
    zeta = -math.log(e) / math.hypot(math.pi, math.log(e))
    ct = 2 * zeta * math.sqrt(kt * ball_mass(0.1, 2500))
    default = pressed(tmp_path, "wall", 0.01, coeff="rolling 0.9")
    same = pressed(tmp_path, "wall", 0.01, coeff=f"rolling 0.9 rolling_spring {kt} {ct}")
    other = pressed(tmp_path, "wall", 0.01, coeff=f"rolling 0.9 rolling_spring {0.5 * kt} {ct}")
    assert np.allclose(default, same, rtol=0, atol=1e-12)
    assert np.abs(default - other).max() > 1e-4


@pytest.mark.parametrize("kind", ["ball", "frozen", "wall", "mesh"])
@pytest.mark.parametrize("scheme", ["exact", "plain"])
def test_rolling_limit_of_a_dashpot_alone(tmp_path, kind, scheme):
    """Without a rolling spring an impact takes mu_r * arm * impulse / I of the spin, however strong the dashpot."""
    for dt, cr in ((4e-6, 200), (1e-4, 1e6)):
        _, one, _ = collide(tmp_path, kind, style=f"scheme {scheme}", v2=(0, 0), dt=dt, steps=int(5e-3 / dt),
                            coeff=f"restitution 1 rolling 0.02 rolling_spring 0 {cr}", extra="set atom 1 omega 0 0 50")
        impulse = ball_mass(0.1, 2500) * (one[0, 2] - one[-1, 2])
        assert impulse == pytest.approx((1 if kind == "ball" else 2) * ball_mass(0.1, 2500), rel=1e-3)  # it is over
        assert one[0, 4] - one[-1, 4] == pytest.approx(0.02 * 0.05 * impulse / INERTIA, rel=2e-3)


@pytest.mark.parametrize("kind", ["wall", "frozen"])
def test_static_overlap(tmp_path, kind):
    """Pressed and at rest: F/kn from where balls touch (theory.rst), with either scheme."""
    for scheme in ("plain", "exact"):
        _, one, _ = collide(tmp_path, kind, v1=(0, 0), gap=-50e-6, dt=1e-4, steps=2000, style=f"scheme {scheme}",
                            coeff="restitution 0.3", extra="fix press moving addforce 50 0 0")
        assert 0.1 + one[-1, 0] == pytest.approx(50e-6 + 2e-7 * 0.05, rel=1e-6)


# --- time step ---


@pytest.mark.parametrize("kind", ["ball", "wall"])
def test_time_step_warning(tmp_path, kind):
    rule = 0.25 * math.sqrt(ball_mass(0.1, 2500) / 1e6)
    for dt, warned in ((1.49 * rule, False), (1.51 * rule, True)):
        log, _, _ = collide(tmp_path, kind, d2=0.2, dt=dt, steps=1)  # the lighter ball counts
        assert ("WARNING: Pair gran/restitution: time step" in log) == warned
    assert f"is 1.51 times the rule's, 0.25 sqrt(m_min/kn) = {rule:.4g} s (types 1 1): up to 1.5 times was tested to " \
        "hold the restitution, of several contacts at once too" in log


def test_dashpots_count_in_the_rule_of_the_plain_scheme(tmp_path):
    """Scheme exact follows any dashpot; with plain those of several contacts add up."""
    m = ball_mass(0.1, 2500)
    cn = 2 * 0.59 * math.sqrt(1e6 * m)  # e 0.1
    dt = 0.9 * 0.25 * math.sqrt(m / 1e6)
    assert 0.15 * m / cn < dt
    for style, warned in (("scheme plain", True), ("", False)):
        log, _, _ = collide(tmp_path, "wall", coeff=f"damping {cn} {cn}", style=style, dt=dt, steps=1)
        assert (f"come to rest, 0.15 m_min/cn = {0.15 * m / cn:.4g} s" in log) \
            == warned
    log, _, _ = collide(tmp_path, "wall", coeff=f"damping {cn / 10} 0", style="scheme plain", dt=dt, steps=1)
    assert "WARNING" not in log


def test_stiff_pair_that_cannot_touch_does_not_count(tmp_path):
    dt = 0.99 * 0.25 * math.sqrt(ball_mass(0.1, 2500) / 1e6)
    coeff = "pair_coeff * * stiffness 1e6 1e6 restitution 0.5\npair_coeff {} stiffness 1e9 1e9 restitution 0.5"
    for pair, warned in (("1 2", False), ("1 3", True)):  # of type 2 there is no ball, 3 is the wall
        log, _, _ = collide(tmp_path, "wall", coeff=coeff.format(pair), dt=dt, steps=1)
        assert ("WARNING: Pair gran/restitution: time step" in log) == warned


def test_late_neighbor_lists_are_warned_of(tmp_path):
    for extra, warned in (("neigh_modify delay 10", True), ("neigh_modify every 2 delay 0 check no", True),
                          ("neigh_modify delay 0 every 1 check yes", False)):
        log, _, _ = collide(tmp_path, steps=1, extra=extra)
        assert ("contacts may be found late and rebound too fast" in log) == warned


def test_deep_overlaps_are_reported_once_with_a_count(tmp_path):
    every = "neigh_modify every 1 delay 0 check no"
    deep, _, _ = collide(tmp_path, k=2e4, steps=6000, extra=every)
    sane, _, _ = collide(tmp_path, k=1e6, steps=3000, extra=every)
    line, = (line for line in deep.splitlines() if "contacts were seen deeper than 10 % of the smaller radius" in line)
    count, most = re.search(r"(\d+) contacts were seen .* the deepest (\S+) % \(ball [12], step \d+\)", line).groups()
    m = ball_mass(0.1, 2500) / 2
    zeta = -math.log(0.5) / math.hypot(math.pi, math.log(0.5))
    largest = 2 * math.sqrt(m / 2e4) * math.exp(-zeta / math.sqrt(1 - zeta ** 2) * math.acos(zeta))
    assert float(most) == pytest.approx(100 * largest / 0.05, rel=0.02) and int(count) > 100
    assert "were seen deeper" not in sane


# --- start-up table and restart ---


COEFFS = """pair_coeff 1 1 stiffness 1e6 8e5 restitution 0.48 friction 30 rolling 0.1
pair_coeff 1 2 stiffness 2e6 2e6 damping 500 400 friction 20
pair_coeff 2 2 stiffness 3e6 3e6 restitution 1 rolling_spring 1e5 10
pair_coeff 1 3 stiffness 1e6 1e6 restitution 0.1 friction 35
"""


def test_start_up_table(tmp_path):
    log, _, _ = collide(tmp_path, "ball", coeff=COEFFS, steps=1, rho2=5000.0)
    rows = table(log)
    assert sorted(rows) == [(1, 1), (1, 2), (2, 2)]  # no ball, frozen or wall of type 3
    m1, m2 = ball_mass(0.1, 2500), ball_mass(0.1, 5000)
    zeta = -math.log(0.48) / math.hypot(math.pi, math.log(0.48))
    assert rows[1, 1] == pytest.approx([1e6, 8e5, 2 * zeta * math.sqrt(1e6 * m1 / 2), zeta, 0.48, 0.48, 30,
                                        math.degrees(math.atan(0.1)),
                                        math.pi / math.sqrt(2e6 / m1 * (1 - zeta ** 2)) / 2e-6],
                                       rel=1e-3)
    pair = m1 * m2 / (m1 + m2)
    assert rows[1, 2][2:5] == pytest.approx([500, 250 / math.sqrt(2e6 * pair), math.exp(
        -math.pi * (z := 250 / math.sqrt(2e6 * pair)) / math.sqrt(1 - z * z))], rel=1e-3)
    assert rows[2, 2][3:6] == [0.0, 1.0, 1.0]

    # once, not at every run; again when a coefficient changes

    extra = "run 0\nrun 0\npair_coeff 1 1 stiffness 1e6 1e6 restitution 0.4\nrun 0"
    log, _, _ = collide(tmp_path, "ball", coeff=COEFFS, steps=1, extra=extra)
    assert log.count("contact coefficients (") == 2

    log, _, _ = collide(tmp_path, "wall", coeff=COEFFS, steps=1)
    assert table(log)[1, 3][4:6] == pytest.approx([None, 0.1], abs=1e-4)


def test_coefficients_survive_a_restart(tmp_path):
    style = "mass ball limit_damping yes rolling_radius reduced"
    first, _, _ = collide(tmp_path, coeff=COEFFS, style=style, steps=100,
                          extra="run 100\nwrite_restart mid.restart")
    read = "read_restart mid.restart\nneigh_modify delay 0\ncomm_modify vel yes\n"
    log = run_deck(read + "fix move all nve/sphere\nrun 100\n"
                   "print \"velocities $(vx[1]:%.17g) $(vx[2]:%.17g)\"\n", tmp_path)
    assert table(log) == table(first)
    end = [float(word) for word in re.findall(r"^velocities (\S+) (\S+)", log, re.M)[0]]
    one, two = numbers(tmp_path / "one.txt"), numbers(tmp_path / "two.txt")
    assert end == pytest.approx([one[-1, 2], two[-1, 2]], rel=1e-5)  # fix print writes six digits

    # the settings too: limit_damping yes is part of what came back

    other, _, _ = collide(tmp_path, coeff=COEFFS, style="mass pair", steps=1)
    assert table(other) != table(first)


def test_examples_of_the_page(tmp_path):
    log = run_deck("units si\natom_style sphere\ncomm_modify vel yes\nregion box block 0 9 0 9 0 9\ncreate_box 3 box\n"
                   "create_atoms 1 single 2 2 2\ncreate_atoms 1 single 5 5 5\nset type 1 diameter 1.25 density 3411.4\n"
                   + doc_examples("pair_gran_restitution") + "\ntimestep 1e-4\nrun 0\n", tmp_path)
    assert table(log)[1, 1][2:6] == pytest.approx([1.19e6, 0.3217, 0.3439, 0.48], rel=1e-3)  # mass ball is the last


# --- bad input; the rest is in test_wrong_input.py ---


def test_unset_pair_coeff_of_balls_to_come(tmp_path):
    """Balls that fix deposit will add count from the start."""
    collide(tmp_path, coeff="pair_coeff 1*2 1*2 stiffness 1e6 1e6 restitution 0.5",
            extra="region above block -0.5 0.5 -0.5 0.5 0.5 0.9\n"
                  "fix rain all deposit 5 3 100 12345 region above",
            expect_error="pair_coeff 1 3 is not set")


RESTING = """
units si
atom_style sphere
atom_modify map array
boundary f f f
comm_modify vel yes
region box block -4 4 -4 4 -4 4
create_box 2 box
create_atoms 2 single 0 0 0
create_atoms 1 single $(0.9999*sin(25*PI/180)) 0 $(0.9999*cos(25*PI/180))
set group all diameter 1.0 density 2650
group held type 2
group ball type 1
pair_style gran/restitution scheme {scheme}
pair_coeff * * stiffness 2e7 2e7 restitution 0.5 friction 35 rolling 2
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
variable weight equal 9.81*2650*PI/6
timestep $(0.25*sqrt(v_weight/9.81/2e7))
fix held held freeze
fix weight ball gravity 9.81 vector 0 0 -1
fix move ball nve/sphere
compute force all pair/local p4
run 20000
dump force all local 1 force.txt c_force
run 0
print "WEIGHT $(v_weight*x[2]/sqrt(x[2]^2+z[2]^2):%.6f)"
"""


@pytest.mark.parametrize("scheme", ["exact", "plain"])
def test_force_of_pair_local_is_the_one_that_acts(tmp_path, scheme):
    """A ball at rest on a steep contact: friction carries its weight along it."""
    log = run_deck(RESTING.format(scheme=scheme), tmp_path)
    force = float((tmp_path / "force.txt").read_text().split()[-1])
    assert force == pytest.approx(float(log.split("WEIGHT ")[-1].split()[0]), rel=1e-3)
