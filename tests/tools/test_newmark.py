"""Displacement of a sliding block: closed forms, and an integration by scipy."""
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq


from slope_tools.slips import newmark

YIELDS = np.array([0.3, 1.0, 1.9, 2.9])
PULSE = 3.0


def noise(points=300, dt=0.02, seed=4):
    """A record: filtered noise under an envelope, (times, accelerations in m/s2)."""
    t = dt * np.arange(points)
    rough = np.convolve(np.random.default_rng(seed).normal(size=points), np.hanning(9), "same")
    return t, rough * np.sin(np.pi * t / t[-1]) * 3.0


@pytest.mark.parametrize("edge", [1e-9, 0.0])
def test_rectangle(edge):
    """A pulse a of a length T: a (a - y) T^2 / (2 y)."""
    t = np.array([0.0, edge, 0.8, 0.8 + edge, 60.0])
    found = newmark.displacement(t, np.array([0.0, PULSE, PULSE, 0.0, 0.0]), YIELDS)
    assert found == pytest.approx(PULSE * (PULSE - YIELDS) * 0.8 ** 2 / (2 * YIELDS), rel=1e-3)
    assert newmark.displacement(t, np.array([0.0, PULSE, PULSE, 0.0, 0.0]), [PULSE, 5.0]) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("y", YIELDS)
def test_half_sine(y):
    """A pulse a sin(pi t / T): integrals of the excess until the speed is 0, by quadrature."""
    length = 1.2
    t = np.append(np.linspace(0, length, 2001), [length + 1e-9, 60.0])
    ground = np.where(t <= length, PULSE * np.sin(np.pi * t / length), 0.0)
    w = np.pi / length
    start = np.arcsin(y / PULSE) / w

    def speed(now):
        return PULSE / w * (np.cos(w * start) - np.cos(w * min(now, length))) - y * (now - start)
    stop = start + (PULSE / w * (np.cos(w * start) + 1)) / y     # if it slides beyond the pulse
    if stop < length:
        stop = brentq(speed, length / 2, length)
    expected = quad(speed, start, stop, points=[length] if stop > length else None, epsabs=1e-12)[0]
    assert newmark.displacement(t, ground, [y])[0] == pytest.approx(expected, rel=1e-3)


def slid(t, ground, y):
    """The displacement by an integration with events, piece by piece."""
    def excess(now):
        return np.interp(now, t, ground) - y

    def stops(now, state):
        return state[0]
    stops.terminal, stops.direction = True, -1
    now, way = 0.0, 0.0
    fine = np.linspace(0, t[-1], 60001)
    while True:
        later = fine[(fine > now) & (excess(fine) > 0)]
        if not len(later):
            return way
        run = solve_ivp(lambda at, state: (excess(at), state[0]), (later[0], t[-1]), (0.0, 0.0), events=stops,
                        max_step=2e-3, rtol=1e-9, atol=1e-12)
        way += run.y[1, -1]
        now = run.t[-1]
        if now >= t[-1] - 1e-9:
            return way


@pytest.mark.parametrize("y", [0.5, 2.0])
def test_a_record_against_another_integration(y):
    t, ground = noise()
    assert newmark.displacement(t, ground, [y])[0] == pytest.approx(slid(t, ground, y), rel=1e-3)


def test_steps_do_not_matter():
    """Points put between those of the record change nothing: the integral is exact."""
    t, ground = noise()
    fine = np.sort(np.concatenate([t, np.random.default_rng(2).uniform(0, t[-1], 2000)]))
    y = np.linspace(0.1, 6, 40)
    assert newmark.displacement(fine, np.interp(fine, t, ground), y) == pytest.approx(
        newmark.displacement(t, ground, y), rel=1e-9, abs=1e-12)


def test_both_ways_directions_and_vertical():
    t, x = noise()
    record = np.column_stack([x, 0 * x, 0.5 * x])
    y = np.array([1.0])
    east = newmark.both_ways(t, record, 0.0, y)
    assert east == pytest.approx(np.maximum(newmark.displacement(t, x, y), newmark.displacement(t, -x, y)))
    assert newmark.both_ways(t, record, 180.0, y) == pytest.approx(east)
    assert newmark.both_ways(t, record, 90.0, y) == pytest.approx(0, abs=1e-12)
    assert newmark.both_ways(t, record, 60.0, y) == pytest.approx(
        np.maximum(newmark.displacement(t, x / 2, y), newmark.displacement(t, -x / 2, y)))
    # ground that goes up makes the body heavier
    heavier = np.maximum(newmark.displacement(t, -x - 0.1 * x, y), newmark.displacement(t, x - 0.1 * x, y))
    assert newmark.both_ways(t, record, 0.0, y, vertical=0.2) == pytest.approx(heavier)
