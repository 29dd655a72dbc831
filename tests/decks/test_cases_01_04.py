"""The decks inputs/01 to 04: their curves, warnings and other schemes.

What they claim of the paper's tables and closed forms is in slope_tools.validation.verification;
test_verification.py runs it.
"""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import run_deck

from slope_tools.validation.verification.claims import find_number
from slope_tools.validation.verification.slide_roll import G, on_a_sphere

TOP = Path(__file__).resolve().parents[2]
INPUTS = TOP / "inputs"


def run_case(folder, tmp_path, **variables):
    """Run an input folder's deck in tmp_path; return its log."""
    source = INPUTS / folder
    for file in source.glob("*.xyz"):
        shutil.copy(file, tmp_path)
    return run_deck(next(source.glob("in.*")).read_text(), tmp_path, vars=variables)


def printed(log, start):
    """The lines that a deck printed with this start, without LAMMPS' echo of the command."""
    return [line for line in log.splitlines() if line.startswith(start)]


def curve(tmp_path, name):
    return np.genfromtxt(tmp_path / name, delimiter=",", names=True)


# --- 01_restitution ---


@pytest.mark.parametrize("variables, observed", [
    ({"e": 0.25}, 0.249), ({"cn": 1.45e4}, 0.249), ({"e": 0.445}, 0.445), ({"cn": 8.96e3}, 0.445)])
@pytest.mark.parametrize("g", [9.81, 9.80665])  # two phases of the step in which the contact begins
def test_table_2_with_scheme_plain(tmp_path, variables, observed, g):
    log = run_case("01_restitution", tmp_path, tend=0.45, scheme="plain", g=g, **variables)
    line, = printed(log, "restitution:")
    assert find_number("observed", line) == pytest.approx(observed, abs=0.003)
    assert math.sqrt(find_number("h2", line) / 0.741) == pytest.approx(observed, abs=0.003)


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
    ("plain", (0.002, 0.004, 0.025, 0.04)), ("exact", (0.0012, 0.0012, 0.002, 0.01))])
def test_time_step(tmp_path, scheme, tolerances):
    log = run_case("02_timestep", tmp_path, tend=0.7, scheme=scheme)
    lines = printed(log, "timestep:")
    assert [find_number("dt", line) for line in lines] == [5e-7, 5e-6, 5e-5, 1.2e-4, 5e-4]
    low = [find_number("from", line) for line in lines]
    high = [find_number("to", line) for line in lines]

    # the shorter the step, the less it matters when in a step the contact begins

    for k, tolerance in enumerate(tolerances):
        assert 0.445 - tolerance < low[k] <= high[k] < 0.445 + tolerance, lines[k]
    assert scheme == "exact" or high[4] > 0.445 * 1.5, lines[4]
    if scheme == "plain":
        assert find_number("observed", lines[4]) > 0.445 * 1.1, lines[4]

    # and the warning: not in the log before the last run

    before, last = log.split("dt 1.2e-4 over rule")
    assert "WARNING: Pair gran/restitution: time step" not in before
    warning = next(line for line in last.splitlines() if line.startswith("WARNING"))
    assert "time step 0.0005 s is 4.09 times the " in warning and "0.0001223 s" in warning

    extreme = curve(tmp_path, "timestep.5.0e-4.csv")
    bounce = extreme["time"] > 0.39
    right = curve(tmp_path, "timestep.5.0e-6.csv")
    assert right["height"][right["time"] > 0.39].max() == pytest.approx(0.147, abs=0.002)
    assert scheme == "exact" or extreme["height"][bounce].max() > 1.2 * 0.147
    assert scheme == "exact" or extreme["highest"][bounce].max() > 2.2 * 0.147


# --- 03_slide_roll ---


@pytest.mark.parametrize("theta, theory", [(0, "slide_theory"), (10, "roll_theory")])
def test_slide_and_roll(tmp_path, theta, theory):
    """The curve is on the line of theory that the deck draws beside it."""
    run_case("03_slide_roll", tmp_path, theta=theta)
    path = curve(tmp_path, "slide_roll.csv")
    later = path["time"] >= 0.001
    assert later.sum() == 96
    assert np.allclose(path["path"][later], path[theory][later], rtol=0.01)


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


# --- 04_rolling_resistance ---


def test_case_3_slides_in_the_end(tmp_path):
    """Beyond 0.232 s the contact is so steep that 31 degrees of friction no longer hold the rolling ball."""
    mu = math.tan(math.radians(31))
    assert on_a_sphere(0.231, spin=True, mu_r=0.56)[2] < mu < on_a_sphere(0.233, spin=True, mu_r=0.56)[2]
    run_case("04_rolling_resistance", tmp_path, rolling=0.56, tend=0.26)
    path = curve(tmp_path, "rolling_resistance.csv")
    start = path["time"][np.argmax(path["sliding"] > 1e-6)]
    assert 0.225 < start < 0.24
