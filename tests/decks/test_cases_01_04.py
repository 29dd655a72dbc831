"""The decks inputs/01 to 04 against the paper's tables and closed forms (REFERENCE: Tables 1 to 3, Figures 5 to 9)."""

import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import run_deck

INPUTS = Path(__file__).resolve().parents[2] / "inputs"
G, D = 9.81, 0.06  # m/s2, m: the decks' defaults


def run_case(folder, tmp_path, change=lambda deck: deck, **variables):
    """Run an input folder's deck in tmp_path; return its log."""
    source = INPUTS / folder
    for file in source.glob("*.xyz"):
        shutil.copy(file, tmp_path)
    deck = next(source.glob("in.*")).read_text()
    changed = change(deck)
    return run_deck(changed, tmp_path, vars=variables)


def swap(old, new):
    """A change to a deck's text that must find what it replaces."""
    def change(deck):
        assert old in deck
        return deck.replace(old, new)
    return change


def number(name, line):
    """The number after a name in a line that a deck printed."""
    return float(re.search(rf"\b{name} (\S+)", line).group(1).rstrip(":"))


def printed(log, start):
    """The lines that a deck printed with this start, without LAMMPS' echo of the command."""
    return [line for line in log.splitlines() if line.startswith(start)]


def curve(tmp_path, name):
    return np.genfromtxt(tmp_path / name, delimiter=",", names=True)


def on_a_sphere(time, phi=30.0, spin=False, mu=0.0, mu_r=0.0):
    """Path of a ball from rest on a fixed one, by Runge-Kutta on d psi'' = f (g sin psi - mu N/m).

    N/m = g cos psi - d psi'^2; sliding: f = 1, mu the friction; rolling: f = 5/7, mu the rolling
    resistance. Returns the path d (psi - phi), psi in degrees, and F/N at the end, all at time.
    """
    factor, brake = (5 / 7, mu_r) if spin else (1.0, mu)

    def rate(state):
        psi, w = state
        normal = G * math.cos(psi) - D * w * w
        return np.array([w, factor * (G * math.sin(psi) - brake * normal) / D])

    state = np.array([math.radians(phi), 0.0])
    steps = 2000
    h = time / steps
    for _ in range(steps):
        a = rate(state)
        b = rate(state + h / 2 * a)
        c = rate(state + h / 2 * b)
        d = rate(state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
    psi, w = state
    force = G * math.sin(psi) - D * rate(state)[1]
    return D * (psi - math.radians(phi)), math.degrees(psi), force / (G * math.cos(psi) - D * w * w)


# --- 01_restitution ---


@pytest.mark.parametrize("variables, observed", [
    ({"e": 0.25}, 0.249), ({"cn": 1.45e4}, 0.249), ({"e": 0.445}, 0.445), ({"cn": 8.96e3}, 0.445)])
@pytest.mark.parametrize("scheme, g", [("exact", 9.81), ("plain", 9.81), ("plain", 9.80665)])  # plain: two phases
def test_table_2(tmp_path, variables, observed, scheme, g):
    log = run_case("01_restitution", tmp_path, tend=0.45, scheme=scheme, g=g, **variables)
    line, = printed(log, "restitution:")
    assert number("observed", line) == pytest.approx(observed, abs=0.003)
    assert math.sqrt(number("h2", line) / 0.741) == pytest.approx(observed, abs=0.003)


def test_table_2_would_see_a_wrong_mass(tmp_path):
    """A dashpot with half the mass under the root, right between two moving balls, fails on a fixed one."""
    log = run_case("01_restitution", tmp_path, tend=0.45, cn=1.45e4 / math.sqrt(2))
    assert number("observed", printed(log, "restitution:")[0]) > 0.249 + 0.1


def test_curve_of_figure_5(tmp_path):
    run_case("01_restitution", tmp_path)
    bounce = curve(tmp_path, "restitution.csv")
    assert bounce["time"][-1] == pytest.approx(1.0) and len(bounce) == 1001
    falling = bounce["time"] < 0.38
    fall = 0.741 - 0.5 * G * bounce["time"][falling] ** 2
    assert np.allclose(bounce["height"][falling], fall, atol=1e-5)
    after = bounce["time"] > 0.39
    assert bounce["height"][after].max() == pytest.approx(0.046, abs=0.001)
    assert bounce["height"].min() > -0.0013 and bounce["height"].min() < -0.0005


# --- 02_timestep ---


@pytest.mark.parametrize("scheme, tolerances", [
    ("plain", (0.002, 0.004, 0.025, 0.04)), ("exact", (0.0012, 0.0012, 0.0012, 0.0015))])
def test_time_step(tmp_path, scheme, tolerances):
    log = run_case("02_timestep", tmp_path, tend=0.7, scheme=scheme)
    lines = printed(log, "timestep:")
    assert [number("dt", line) for line in lines] == [5e-7, 5e-6, 5e-5, 1.2e-4, 5e-4]
    low = [number("from", line) for line in lines]
    high = [number("to", line) for line in lines]

    # the shorter the step, the less it matters when in a step the contact begins

    for k, tolerance in enumerate(tolerances):
        assert 0.445 - tolerance < low[k] <= high[k] < 0.445 + tolerance, lines[k]
    assert high[4] > 0.445 * 1.5, lines[4]
    if scheme == "plain":
        assert number("observed", lines[4]) > 0.445 * 1.1, lines[4]

    # and the warning: not in the log before the last run

    before, last = log.split("dt 1.2e-4 over rule")
    assert "WARNING: Pair gran/restitution: time step" not in before
    warning = next(line for line in last.splitlines() if line.startswith("WARNING"))
    assert "time step 0.0005 s is 4.09 times the largest" in warning and "0.0001223 s" in warning

    extreme = curve(tmp_path, "timestep.5.0e-4.csv")
    bounce = extreme["time"] > 0.39
    right = curve(tmp_path, "timestep.5.0e-6.csv")
    assert right["height"][right["time"] > 0.39].max() == pytest.approx(0.147, abs=0.002)
    assert extreme["height"][bounce].max() > (1.2 if scheme == "plain" else 1.05) * 0.147
    assert extreme["highest"][bounce].max() > 2.2 * 0.147


# --- 03_slide_roll ---


@pytest.mark.parametrize("theta, theory", [(0, "slide_theory"), (10, "roll_theory")])
def test_slide_and_roll(tmp_path, theta, theory):
    run_case("03_slide_roll", tmp_path, theta=theta)
    path = curve(tmp_path, "slide_roll.csv")
    later = path["time"] >= 0.001
    assert later.sum() == 96
    assert np.allclose(path["path"][later], path[theory][later], rtol=0.01)
    other = "slide_theory" if theory == "roll_theory" else "roll_theory"
    assert not np.any(np.isclose(path["path"][later], path[other][later], rtol=0.1))
    if theta == 0:
        assert np.all(path["rotation"] == 0.0)
        assert np.allclose(path["sliding"], path["path"])
    else:
        assert np.allclose(0.5 * D * path["rotation"][later], path["path"][later], rtol=0.01)
        assert np.abs(path["sliding"]).max() < 1e-4 * path["path"][-1]


@pytest.mark.parametrize("theta, spin", [(0, False), (60, True)])
def test_a_sphere_on_a_sphere(tmp_path, theta, spin):
    """For longer than 0.02 s the slope of the contact grows: the equation of motion, not its first term."""
    run_case("03_slide_roll", tmp_path, theta=theta, tend=0.08)
    path = curve(tmp_path, "slide_roll.csv")
    for time in (0.04, 0.06, 0.08):
        row = np.argmin(np.abs(path["time"] - time))
        theory, _, _ = on_a_sphere(time, spin=spin)
        assert path["path"][row] == pytest.approx(theory, rel=2e-3)
    assert theory / path["roll_theory" if spin else "slide_theory"][row] > 1.05


def test_threshold_of_rolling(tmp_path):
    """3.5 tan(theta) = tan(30 deg) at theta 9.37 deg; sliding below it gains speed by the closed form."""
    slip = {}
    for theta in (9.0, 9.2, 9.5, 9.7):
        log = run_case("03_slide_roll", tmp_path, theta=theta, tend=0.01)
        table = log.split("v_roll_theory \n")[1].splitlines()[:11]
        slip[theta] = {float(row.split()[1]): float(row.split()[5]) for row in table}
    for theta in (9.0, 9.2):
        gain = G * (math.sin(math.pi / 6) - 3.5 * math.tan(math.radians(theta)) * math.cos(math.pi / 6))
        assert (slip[theta][0.005] - slip[theta][0.002]) / 0.003 == pytest.approx(gain, rel=0.1)
    for theta in (9.5, 9.7):
        assert abs(slip[theta][0.005]) < 1e-6 and abs(slip[theta][0.01]) < 1e-6
    assert slip[9.2][0.01] > 500 * abs(slip[9.5][0.01])


def test_not_the_threshold_of_a_disc(tmp_path):
    """3 tan(theta) = tan(30 deg), as the paper prints it, would be 10.89 deg: 9.7 deg rolls all the same."""
    log = run_case("03_slide_roll", tmp_path, theta=9.7, tend=0.01)
    line, = printed(log, "slide_roll:")
    assert 3 * math.tan(math.radians(9.7)) < math.tan(math.pi / 6)
    assert number("of roll theory", line) == pytest.approx(1.0, abs=0.01)


# --- 04_rolling_resistance ---


@pytest.mark.parametrize("friction, rolling, verdict", [
    (31, 0.58, "stays still"), (29, 0.58, "slides without rotating"), (31, 0.56, "rotates without sliding")])
def test_table_3(tmp_path, friction, rolling, verdict):
    log = run_case("04_rolling_resistance", tmp_path, friction=friction, rolling=rolling)
    line, = printed(log, "rolling_resistance:")
    assert f": {verdict}: " in line
    rotation, sliding = number("rotation", line), number("sliding", line)
    mu = math.tan(math.radians(friction))
    if verdict == "stays still":
        assert abs(rotation) < 1e-4 and abs(sliding) < 1e-6 and abs(number("path", line)) < 3e-6
    elif verdict == "slides without rotating":
        theory, _, _ = on_a_sphere(0.2, mu=mu)
        assert sliding == pytest.approx(theory, rel=0.03) and abs(rotation) < 1e-5
    else:
        theory, slope, needed = on_a_sphere(0.2, spin=True, mu_r=rolling)
        assert needed < mu and slope < 34.9  # the friction still holds it
        assert rotation == pytest.approx(theory / (0.5 * D), rel=0.03) and abs(sliding) < 1e-6


@pytest.mark.parametrize("friction, rolling", [(29, 0.58), (31, 0.56)])
def test_table_3_without_the_first_jerk(tmp_path, friction, rolling):
    """With dashpots far above critical the load comes on softly and the closed forms hold within 1 %."""
    log = run_case("04_rolling_resistance", tmp_path, friction=friction, rolling=rolling, zeta=8, dt=2e-7)
    theory, _, _ = on_a_sphere(0.2, spin=friction == 31, mu=math.tan(math.radians(friction)), mu_r=rolling)
    assert number("path", printed(log, "rolling_resistance:")[0]) == pytest.approx(theory, rel=0.01)


def test_case_3_slides_in_the_end(tmp_path):
    """Beyond 0.232 s the contact is so steep that 31 degrees of friction no longer hold the rolling ball."""
    mu = math.tan(math.radians(31))
    assert on_a_sphere(0.231, spin=True, mu_r=0.56)[2] < mu < on_a_sphere(0.233, spin=True, mu_r=0.56)[2]
    run_case("04_rolling_resistance", tmp_path, rolling=0.56, tend=0.26)
    path = curve(tmp_path, "rolling_resistance.csv")
    start = path["time"][np.argmax(path["sliding"] > 1e-6)]
    assert 0.225 < start < 0.24


def test_table_3_needs_the_whole_radius(tmp_path):
    """With half the torque arm, as sds and epsd2 have it, the ball of case 1 rolls off."""
    log = run_case("04_rolling_resistance", tmp_path, rolling=0.58,
                   change=swap("gran/restitution\n", "gran/restitution rolling_radius reduced\n"))
    assert "rotates" in printed(log, "rolling_resistance:")[0]


def test_table_3_needs_the_rolling_spring(tmp_path):
    """A resistance without a spring cannot stand still."""
    log = run_case("04_rolling_resistance", tmp_path, rolling=0.58,
                   change=swap("rolling_spring $k $c", "rolling_spring 0 $(v_c/100)"))
    assert "rotates" in printed(log, "rolling_resistance:")[0]
