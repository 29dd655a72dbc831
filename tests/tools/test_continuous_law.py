"""The contact law in continuous time, against closed forms and against a second solution by other means."""
import math

import numpy as np
import pytest


from slope_tools.validation.verification.continuous_law import Case, impacts, one_impact

NO_SLIP = 89.999
PARTNERS = [(math.inf, 1.0), (1.0, 1.0), (8.0, 2.0), (0.125, 0.5)]


@pytest.mark.parametrize("mass, radius", PARTNERS)
@pytest.mark.parametrize("ratio", [2 / 7, 0.5, 1.0])
def test_elastic_without_slip(mass, radius, ratio):
    """The contact point is an oscillator of 2/7 of the mass for half a period of the normal one."""
    beta = math.cos(math.pi * math.sqrt(3.5 * ratio))
    got = impacts(Case(30, NO_SLIP, 1, ratio, mass, radius))
    assert got.beta == pytest.approx(beta, abs=1e-4)
    # its change is 7/2 of that of the centres, 5/2 times the impulse is spin
    assert got.spin + got.partner_spin == pytest.approx(5 / 7 * (1 - beta), abs=1e-4)


@pytest.mark.parametrize("mass, radius", PARTNERS)
@pytest.mark.parametrize("e", [0.1, 0.5, 0.9])
def test_damped_without_slip(mass, radius, e):
    """kt = 2/7 kn: an oscillator of the normal one's frequency (here 1) and sqrt(7/2) of its damping ratio.

    It ends where the normal dashpot begins to pull: then there is no friction."""
    zeta = -math.log(e) / math.hypot(math.pi, math.log(e))
    damped = math.sqrt(1 - zeta ** 2)
    last = math.atan2(2 * zeta * damped, 2 * zeta ** 2 - 1) / damped
    assert last < math.pi / damped
    zeta *= math.sqrt(3.5)
    damped = np.sqrt(complex(1 - zeta ** 2))
    rate = np.exp(-zeta * last) * (np.cos(damped * last) - zeta * np.sin(damped * last) / damped)
    got = impacts(Case(1, NO_SLIP, e, 2 / 7, mass, radius))
    assert got.beta == pytest.approx(rate.real, abs=1e-3)


@pytest.mark.parametrize("mass, radius", PARTNERS)
@pytest.mark.parametrize("angle, friction", [(45, 5), (75, 15), (85, 55)])
def test_sliding(mass, radius, angle, friction):
    """Slides throughout, elastic: the impulse is 2 mu that of the normal (Chung and Ooi 2011, test 4)."""
    mu, tangent = math.tan(math.radians(friction)), math.tan(math.radians(angle))
    assert tangent > 7 * mu * 1.1
    got = impacts(Case(angle, friction, 1, 2 / 7, mass, radius))
    assert got.beta == pytest.approx(1 - 7 * mu / tangent, abs=1e-4)
    share = 1.0 if math.isinf(mass) else mass / (1 + mass)
    assert got.spin == pytest.approx(5 * mu / tangent * share, abs=1e-4)


def test_sliding_with_a_dashpot_that_pulls():
    """Friction follows the normal force only while that presses: the impulse is more than 1 + e."""
    e, mu, tangent = 0.3, math.tan(math.radians(5)), math.tan(math.radians(75))
    zeta = -math.log(e) / math.hypot(math.pi, math.log(e))
    damped = math.sqrt(1 - zeta ** 2)
    t = np.linspace(0, math.pi / damped, 200001)
    d = np.exp(-zeta * t) * np.sin(damped * t) / damped
    rate = np.exp(-zeta * t) * (np.cos(damped * t) - zeta * np.sin(damped * t) / damped)
    impulse = np.maximum(d + 2 * zeta * rate, 0).sum() * t[1]
    assert impulse > 1.01 * (1 + e)
    assert impacts(Case(75, 5, e)).beta == pytest.approx(1 - 3.5 * mu * impulse / tangent, abs=1e-4)


@pytest.mark.parametrize("mass, radius", PARTNERS)
def test_energy_and_restitution(mass, radius):
    got = impacts(Case(30, 0, np.array([1, 0.5]), 1.0, mass, radius, 0.7))
    assert got.restitution == pytest.approx([1, 0.5])
    assert got.beta == pytest.approx(1) and got.energy[0] == pytest.approx(1)
    share = 1.0 if math.isinf(mass) else mass / (1 + mass)
    lost = 0.75 * math.cos(math.radians(30)) ** 2 * share / (1 + 0.4 * 0.7 ** 2)
    assert got.energy[1] == pytest.approx(1 - lost)
    # without slip and loss
    whole = impacts(Case(30, NO_SLIP, 1, 2 / 7, mass, radius, -0.5))
    assert whole.energy == pytest.approx(1, abs=1e-4) and whole.beta == pytest.approx(-1, abs=1e-4)


@pytest.mark.parametrize("mass, radius", PARTNERS)
def test_rolling_resistance_is_a_torque(mass, radius):
    """Without friction it changes the spins alone, by opposite angular momenta, and stops what rolls."""
    case = Case(30, 0, 1, 0.3, mass, radius, 0.2, 1e4)
    got = impacts(case)
    before = math.sin(math.radians(30)) - 0.2
    spin, partner_spin = before * got.spin, before * got.partner_spin       # R w / v
    assert got.beta * before == pytest.approx(before + 0.2 - spin - partner_spin, abs=1e-9)
    given, taken = 0.2 - spin, 0.0 if math.isinf(mass) else mass * radius * partner_spin
    assert abs(given) > 0.01
    if not math.isinf(mass):
        assert given == pytest.approx(taken, abs=1e-9)
    # an oscillator as the one of friction: (w_i - w_j) R_r swings with its own share of the mass
    share = 2.5 * (1 + (0 if math.isinf(mass) else 1 / mass / radius ** 2)) * (2 * radius / (1 + radius)) ** 2
    share *= 1 if math.isinf(mass) else mass / (1 + mass)
    assert spin - partner_spin / radius == pytest.approx(0.2 * math.cos(math.pi * math.sqrt(0.3 * share)), abs=1e-4)


def test_smaller_steps_change_little():
    case = Case(np.array([5, 30, 60, 85])[:, None], np.array([5, 30, 80]), 0.1, 1.0, 8.0, 2.0, 0.0, 0.1)
    for coarse, fine in zip(impacts(case), impacts(case, 5000)):
        assert coarse == pytest.approx(fine, abs=1e-4)


def random_cases(count, seed):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        mass, radius = PARTNERS[rng.integers(len(PARTNERS))]
        yield Case(rng.uniform(3, 87), rng.choice([5, 15, 30, 45, 60, 80]), rng.choice([0.1, 0.3, 0.5, 0.7, 0.9, 1.0]),
                   rng.choice([2 / 7, 0.5, 1.0]), mass, radius, rng.choice([0, -0.5, 1.5]), rng.choice([0, 0.05, 0.3]))


def test_two_solutions_agree():
    """Small steps with forces that are cut, and pieces of sticking and sliding between events."""
    for case in random_cases(25, 3):
        for steps, pieces in zip(impacts(case), one_impact(case)):
            assert float(steps) == pytest.approx(float(pieces), abs=2e-4), case
