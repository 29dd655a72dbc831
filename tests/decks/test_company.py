"""Restitution where a ball touches several others, at the rule's step, whenever in a step it begins."""
import numpy as np
import pytest

from deck_helpers import run_deck

PHASES = 20
SPACE = 12.0    # between cases, in diameters
STEP = 0.25     # of the rule, diameter, mass and stiffness of one

HEAD = """
units lj
atom_style sphere
atom_modify map array
boundary f f f
comm_modify vel yes
{newton}
region box block -6 {length} -6 6 -6 6
create_box 3 box
"""
LAWS = """
pair_style gran/restitution scheme {scheme}
pair_coeff * * stiffness 1 1 restitution {e} friction {friction}
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
timestep {dt}
group held type 2
group free type 1 3
velocity free set 0 0 0
"""
SPEED = 0.004


def zeta(e):
    return -np.log(e) / np.hypot(np.pi, np.log(e))


def restitution(ratio):
    return np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)) if ratio < 1 else 0.0


def velocities(folder, cases, balls, e, *, friction=0, scheme="exact", part=1.0, steps=200, np_=1,
               newton="newton off"):
    """Velocities after an impact, (cases, balls, 3), per impact speed.

    balls(k) gives for case k the balls as (type, diameter, x, y, z, vx, vy, vz), of which type 2 is held.
    """
    text = [HEAD.format(length=cases * SPACE, newton=newton)]
    moving = []
    number = 0
    for k in range(cases):
        for type_, diameter, x, y, z, *v in balls(k):
            number += 1
            text.append(f"create_atoms {type_} single {x + k * SPACE:.17g} {y:.17g} {z:.17g}")
            text.append(f"set atom {number} diameter {diameter} mass {diameter**3:.17g}")
            if any(v):
                moving.append(f"set atom {number} vx {v[0]:.17g} vy {v[1]:.17g} vz {v[2]:.17g}")
    text.append(LAWS.format(scheme=scheme, e=e, friction=friction, dt=STEP * part))
    text += moving + ["fix held held freeze", "fix move free nve/sphere", f"run {round(steps / part)}",
                      "write_dump all custom out.dump id vx vy vz modify sort id format float %.17g"]
    run_deck("\n".join(text), folder, np=np_)
    table = np.loadtxt(folder / "out.dump", skiprows=9)
    return table[:, 1:].reshape(cases, number // cases, 3) / SPEED


def phase(k):
    """How far a ball is from its contact, in steps at impact speed."""
    return SPEED * STEP * (2 + (k + 0.5) / PHASES)


def on_ring(contacts, height):
    """A ball that falls on so many fixed ones, whose contacts have normals of this height."""
    def balls(k):
        far = np.sqrt(1 - height**2)
        ring = [(2, 1.0, far * np.cos(a), far * np.sin(a), -height, 0, 0, 0)
                for a in 2 * np.pi * np.arange(contacts) / contacts]
        return [(1, 1.0, 0, 0, phase(k) / height, 0, 0, -SPEED), *ring]
    return balls


@pytest.mark.parametrize("e", [0.05, 0.1, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("partner", [2, 3])
def test_lone_impact(tmp_path, e, partner):
    def balls(k):
        return [(1, 1.0, 0, 0, 1 + phase(k), 0, 0, -SPEED), (partner, 1.0, 0, 0, 0, 0, 0, 0)]

    v = velocities(tmp_path, PHASES, balls, e)[:, :, 2]
    got = v[:, 0] - v[:, 1]
    shorter = partner - 1       # two moving balls: k dt^2/m is twice as large, to which errors are proportional
    assert abs(got.mean() - e) <= 0.002 * shorter
    assert abs(got - e).max() <= 0.01 * shorter


# normal motion on several fixed balls is that of the same oscillator with the damping ratio times sqrt(n) nz
@pytest.mark.parametrize("contacts, height", [(2, 0.87), (3, 0.6), (4, 0.67), (6, 0.5), (6, 0.87)])
@pytest.mark.parametrize("e", [0.05, 0.1, 0.3, 0.5, 0.9])
def test_several_fixed_balls(tmp_path, contacts, height, e):
    got = velocities(tmp_path, PHASES, on_ring(contacts, height), e)[:, 0, 2]
    wanted = restitution(zeta(e) * np.sqrt(contacts) * height)
    assert abs(got.mean() - wanted) <= 0.02
    assert abs(got - wanted).max() <= 0.04


# at the longest step that is not warned of; 4 on a spacing of 0.5, 5 on 0.8, 6 on 0.4 and 0.87
@pytest.mark.parametrize("contacts, height", [(2, 0.87), (4, 0.935), (5, 0.73), (6, 0.917), (6, 0.49)])
@pytest.mark.parametrize("e", [0.05, 0.1, 0.3, 0.48, 0.7])
def test_several_fixed_balls_at_one_and_a_half_steps(tmp_path, contacts, height, e):
    got = velocities(tmp_path, PHASES, on_ring(contacts, height), e, part=1.5)[:, 0, 2]
    wanted = restitution(zeta(e) * np.sqrt(contacts) * height)
    assert abs(got.mean() - wanted) <= 0.03
    assert abs(got - wanted).max() <= 0.08


# contacts that begin together from nearly the same direction, on rings of spacing 0.35 and 0.2, and of four
@pytest.mark.parametrize("contacts, height, e, most", [
    (6, 0.937, 0.1, 0.02), (6, 0.937, 0.05, 0.02), (5, 0.955, 0.05, 0.02), (8, 0.92, 0.1, 0.02), (6, 0.98, 0.05, 0.15),
    (4, 0.969, 0.05, 0.3)])
def test_nearly_parallel_contacts_make_no_energy(tmp_path, contacts, height, e, most):
    """The law gives 0: the ball stays.  Six made 1.6 times the energy of the impact, eight more."""
    got = velocities(tmp_path, PHASES, on_ring(contacts, height), e)[:, 0, 2]
    assert -0.01 < got.min() and got.max() <= most


@pytest.mark.parametrize("neighbors", [8, 28])
@pytest.mark.parametrize("e", [0.1, 0.5])
def test_ball_in_company(tmp_path, neighbors, e):
    """A small ball hits a large one that touches held ones, which take nothing of this motion."""
    def balls(k):
        ring = [(2, 1.0, 3 * np.cos(a), 3 * np.sin(a), 0, 0, 0, 0)
                for a in 2 * np.pi * np.arange(neighbors) / neighbors]
        return [(1, 1.0, 0, 0, 3 + phase(k), 0, 0, -SPEED), (3, 5.0, 0, 0, 0, 0, 0, 0), *ring]

    v = velocities(tmp_path, PHASES, balls, e)
    got = v[:, 0, 2] - v[:, 1, 2]
    assert abs(got.mean() - e) <= 0.01 and abs(got - e).max() <= 0.04


def cradle(k):
    return [(1, 1.0, -phase(k), 0, 0, SPEED, 0, 0)] + [(1, 1.0, q, 0, 0, 0, 0, 0) for q in range(1, 5)]


@pytest.mark.parametrize("e", [0.05, 0.1, 0.3, 0.5, 0.9])
def test_cradle(tmp_path, e):
    fine, rule = tmp_path / "fine", tmp_path / "rule"
    fine.mkdir(), rule.mkdir()
    law = velocities(fine, 2, cradle, e, part=0.05, steps=400)[0, :, 0]
    got = velocities(rule, PHASES, cradle, e, steps=400)[:, :, 0]
    assert abs(got.sum(axis=1) - 1).max() <= 1e-12      # momentum
    energy = (got**2).sum(axis=1)
    assert abs(energy.mean() - (law**2).sum()) <= 0.01
    assert abs(got - law).max() <= 0.04


@pytest.mark.parametrize("np_, newton", [(3, "newton off"), (1, "newton on"), (3, "newton on")])
def test_ranks_and_newton(tmp_path, np_, newton):
    one, other = tmp_path / "one", tmp_path / "other"
    one.mkdir(), other.mkdir()
    first = velocities(one, PHASES, cradle, 0.3, friction=30, steps=400)
    second = velocities(other, PHASES, cradle, 0.3, friction=30, steps=400, np_=np_, newton=newton)
    assert abs(second - first).max() <= 1e-9


HEAP = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region box block -0.2 0.2 -0.2 0.2 -0.05 0.2
region base block -0.19 0.19 -0.19 0.19 -0.04 0
create_box 2 box
lattice sc 0.0115
region fill block -0.024 0.024 -0.024 0.024 0.0105 0.068 units box
create_atoms 1 region fill
set type 1 diameter 0.01 density 2500
displace_atoms all random 5e-4 5e-4 5e-4 1 units box
pair_style gran/restitution scheme exact
pair_coeff * * stiffness 2e4 2e4 restitution {e} friction 30 rolling 0.1
neighbor 0.002 bin
neigh_modify every 1 delay 0 check yes
timestep $({part}*0.25*sqrt(2500*PI*1e-6/6/2e4))
fix base all wall/gran/balls 2 0.01 surface base upper spacing 0.01
fix g all gravity 9.81 vector 0 0 -1
fix mv all nve/sphere
run $(round(6/dt))
compute far all displace/atom
compute most all reduce max c_far[4]
thermo_style custom step atoms c_most
run $(round(1/dt))
print "MOST $(c_most/0.005:%.3e) OF $(atoms)"
"""


@pytest.mark.parametrize("e, part", [(0.05, 1), (0.3, 1), (0.05, 1.5), (0.48, 1.5)])
def test_heap_comes_to_rest(tmp_path, e, part):
    log = run_deck(HEAP.format(e=e, part=part), tmp_path)
    most, balls = log.split("MOST ")[-1].split("\n")[0].split(" OF ")
    assert int(balls) > 100
    assert float(most) < 1e-5       # of a radius, in a second
