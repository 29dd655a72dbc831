"""Momentum, angular momentum and energy in collisions

inputs/08_collisions: two balls, a chain of ten, a gas of 64.
"""
import numpy as np

from .claims import AtMost, Between, Claim, Control, Near, Run, Seen
from .restitution import restitution as restitution_of

CASE = "08_collisions"
PAIR, CHAIN, GAS = (Run(f"08_collisions/in.{name}") for name in ("pair", "chain", "gas"))
SMOOTH = PAIR(friction=0, rolling=0, spin=0)
SOIL = SMOOTH(offset=0, d2=1.25, rho2=3411.4)       # two balls of the paper's Table 5
NEWTON = "Newton's laws"
HELD = ("fix             move all nve/sphere", "fix             move one nve/sphere")


def vectors(balls, *names):
    """Frames by balls by three."""
    return np.stack([balls[name] for name in names], axis=2)


def read_ball_pair(result):
    """mass, place, velocity, spin, radius of the two balls, frame by frame."""
    balls = result.frames("pair.dump")
    return (balls["mass"], vectors(balls, "x", "y", "z"), vectors(balls, "vx", "vy", "vz"),
            vectors(balls, "omegax", "omegay", "omegaz"), balls["radius"])


def momentum(result):
    """Its change over the impulse."""
    mass, _, v, _, _ = read_ball_pair(result)
    each = mass[:, :, None] * v
    return np.linalg.norm(each.sum(1)[-1] - each.sum(1)[0]) / np.linalg.norm(each[-1, 0] - each[0, 0])


def angular_momentum(result):
    """Its change over impulse times sum of the radii."""
    mass, x, v, w, radius = read_ball_pair(result)
    each = mass[:, :, None] * v
    total = (np.cross(x, each) + 0.4 * (mass * radius ** 2)[:, :, None] * w).sum(1)
    impulse = np.linalg.norm(each[-1, 0] - each[0, 0])
    return np.linalg.norm(total[-1] - total[0]) / (impulse * radius[0].sum())


def overlap_share(result):
    """Of the largest overlap in the sum of the radii."""
    _, x, _, _, radius = read_ball_pair(result)
    return 1 - np.linalg.norm(x[:, 1] - x[:, 0], axis=1).min() / radius[0].sum()


def angular_momentum_over_overlap(result):
    return angular_momentum(result) / overlap_share(result)


def impulse(result):
    """Of the normal, over m_1 m_2/(m_1+m_2) times the speed of approach: 1 + e."""
    mass, x, v, _, radius = read_ball_pair(result)
    m1, m2 = mass[0]
    touching = np.argmax(np.linalg.norm(x[:, 1] - x[:, 0], axis=1) < radius[0].sum())
    normal = x[touching, 0] - x[touching, 1]
    approach = (v[0, 1] - v[0, 0]) @ normal / np.linalg.norm(normal)
    return np.linalg.norm(m1 * (v[-1, 0] - v[0, 0])) / (m1 * m2 / (m1 + m2)) / approach


def restitution(result):
    """Of two balls that meet head on."""
    _, _, v, _, _ = read_ball_pair(result)
    return -(v[-1, 0, 0] - v[-1, 1, 0]) / (v[0, 0, 0] - v[0, 1, 0])


def last_of_chain(result):
    return result.frames("chain.dump")["vx"][-1, -1]


def momentum_of_chain(result):
    return abs(result.frames("chain.dump")["vx"][-1].sum() - 1.0)


def energies(result):
    """J, when all balls fly: none touch, and none gets the last push of a contact that ended within the step."""
    curve = result.curve("gas.csv")
    free = curve[curve["force"] == 0]
    return free["motion"] + free["spin"]


def drift(result):
    """Largest change of the energy over the energy."""
    energy = energies(result)
    return np.abs(energy / energy[0] - 1).max()


def growth(result):
    """Largest gain of energy between two moments without contacts, over the energy at the start."""
    energy = energies(result)
    return max(np.diff(energy).max() / energy[0], 0.0)


def measure_energy_left(result):
    """Share of the energy that is left."""
    energy = energies(result)
    return energy[-1] / energy[0]


def _keeps(name, text, run, got, most, broken, wrong, remark=""):
    return Claim(name, text, "", NEWTON, (run,), got, AtMost(most), Control(broken, (wrong,)), remark=remark)


DAMPED = GAS(e=0.48, friction=30, rolling=0.1)
CLAIMS = [
    _keeps("momentum", "Unequal balls, oblique, spinning, with friction and rolling resistance: change of the "
           "momentum over the impulse", PAIR, momentum, 1e-12, "one of the balls is held", PAIR(HELD)),
    _keeps("angular_momentum", "The same without friction: change of the angular momentum over impulse times sum of "
           "the radii", SMOOTH(spin=1), angular_momentum, 1e-12, "with friction", PAIR),
    Claim("angular_momentum_friction", "With friction the forces act at the ends of the radii, which overlap: change "
          "of the angular momentum, in shares of the largest overlap", "", "friction is less than the impulse", (PAIR,),
          angular_momentum_over_overlap, Between(0.0, 1.0),
          Control("one of the balls is held", (PAIR(HELD),)),
          remark="Angular momentum is not conserved exactly, as in all codes whose torque arm is the whole radius."),
    Claim("pair_impulse", "Unequal balls, oblique, smooth: impulse over m_1 m_2/(m_1+m_2) times the speed of approach, "
          "1+e", "", NEWTON, (SMOOTH,), impulse, Near(1.48, 0.003),
          Control("one of the balls is held", (SMOOTH(HELD),))),
    Claim("table_4_moving", "Two moving soil balls with Table 4's 1.19e6 N s/m: restitution", "",
          "closed form: sqrt(2) times the damping ratio", (SOIL(damping="1.19e6"),), restitution,
          Near(restitution_of(2 ** 0.5 * 1.19e6 / (2 * (1.96e9 * 3488.68) ** 0.5)), 0.002),
          Control("8.41e5 N s/m", (SOIL(damping="8.41e5"),)),
          remark="The paper states 0.48 for soil on soil: that holds for a ball on a fixed ball only."),
    Claim("true_0.48", "Two moving soil balls with 8.41e5 N s/m: restitution", "", "closed form, reduced mass",
          (SOIL(damping="8.41e5"),), restitution, Near(0.48, 0.002),
          Control("Table 4's 1.19e6 N s/m", (SOIL(damping="1.19e6"),))),
    Claim("chain", "Ten balls in a row with gaps, e 0.9, at the rule's time step: speed of the last one, ((1+e)/2)^9",
          "m/s", NEWTON, (CHAIN,), last_of_chain, Near(0.95 ** 9, 0.003),
          Control("no gaps: several contacts at once", (CHAIN(space=0),))),
    _keeps("chain_momentum", "The same: change of the momentum over that of ball 1", CHAIN, momentum_of_chain, 1e-9,
           "ball 1 is pushed on", CHAIN(("fix             move all nve/sphere",
                                         "fix             move all nve/sphere\nfix push first addforce 1 0 0"))),
    _keeps("energy_undamped", "Undamped gas, 1e5 steps of a tenth of the rule: largest change of the energy", GAS,
           drift, 1e-5, "scheme plain", GAS(scheme="plain"),
           remark="Impacts of two balls keep it to 1e-9; where a third ball comes in, a contact begins or ends as "
                  "velocity Verlet has it, which costs or gives up to 3e-6 each time (three seeds)."),
    _keeps("energy_damped", "Damped gas, e 0.48, friction 30, mu_r 0.1: largest gain of energy", DAMPED, growth, 1e-9,
           "undamped, scheme plain, steps of the rule", GAS(scheme="plain", part=1)),
    _keeps("energy_damped_rule", "The same at steps of the rule: largest gain of energy", DAMPED(part=1, steps=20000),
           growth, 1e-9, "undamped, scheme plain", GAS(scheme="plain", part=1, steps=20000)),
]
SEEN = [Seen("left", (DAMPED,), measure_energy_left, chance=0.1), Seen("left_rule", (DAMPED(part=1, steps=20000),),
                                                                       measure_energy_left, chance=0.1)]
