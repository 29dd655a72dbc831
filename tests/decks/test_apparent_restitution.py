"""inputs/05_apparent_restitution: ball by ball against the closed form of one frictionless impact (REFERENCE, 5)."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import run_deck

CASE = Path(__file__).resolve().parents[2] / "inputs" / "05_apparent_restitution"
STIFF = {"kn": 3.67e9, "dt": 1e-6, "tdump": 1e-4, "tend": 0.06, "g": 0.1}    # nearly a hard ball, nearly without weight

spec = importlib.util.spec_from_file_location("plot_apparent_restitution", CASE / "plot.py")
plot = importlib.util.module_from_spec(spec)
spec.loader.exec_module(plot)


def drop(folder, monkeypatch, spacing=1.4, **variables):
    """Let 300 balls fall at one spacing; returns plot.py's Drop."""
    monkeypatch.chdir(folder)
    run_deck((CASE / "in.apparent_restitution").read_text(), folder,
             vars={"balls": 300, "spacing": spacing, **variables})
    found, = plot.read("bounce")
    return found


def errors(found, e):
    """Vertical velocity after the first contact against the closed form, balls with one contact."""
    r = found.r[found.alone]
    return np.abs(found.first[found.alone] - (e * (1 - r ** 2) - r ** 2))


@pytest.mark.parametrize("e", [0.25, 0.445])
def test_one_frictionless_impact(tmp_path, monkeypatch, e):
    found = drop(tmp_path, monkeypatch, e=e)
    assert found.alone.sum() > 240
    b = np.degrees(np.arcsin(found.r[found.alone]))
    assert b.min() < 5 and b.max() > 50
    assert errors(found, e).max() < 0.025


def test_a_stiffer_ball_is_nearer_to_the_closed_form(tmp_path, monkeypatch):
    found = drop(tmp_path, monkeypatch, e=0.25, **STIFF)
    assert found.alone.sum() > 270
    assert errors(found, 0.25).max() < 0.002


@pytest.mark.parametrize("variables", [{"friction": 30}, {"e": 0.3}])
def test_the_check_sees_friction_and_another_restitution(tmp_path, monkeypatch, variables):
    found = drop(tmp_path, monkeypatch, **{"e": 0.25, **STIFF, **variables})
    assert errors(found, 0.25).max() > 0.04


def test_distribution(tmp_path, monkeypatch):
    """The rebound is below e for a ball that touches one other only, and the mean is far below e."""
    found = drop(tmp_path, monkeypatch, spacing=1.0)
    at_once = found.alone & (found.first > 0.02)
    assert found.rebound[at_once].max() < 0.25
    assert found.rebound[at_once] == pytest.approx(found.first[at_once], abs=1e-9)
    assert found.table()["mean"] == pytest.approx(0.170, abs=4 * 0.093 / np.sqrt(300))
    assert found.table()["sd"] == pytest.approx(0.093, abs=0.02)
    assert found.table()["no_rebound"] < 0.02


def test_the_floor_stops_what_falls_between(tmp_path, monkeypatch):
    found = drop(tmp_path, monkeypatch, spacing=3.0)
    on_floor = found.r > 1.02
    assert on_floor.mean() == pytest.approx(1 - np.pi / 9, abs=0.1)
    assert found.first[on_floor & (found.first > 0)] == pytest.approx(0.25, abs=0.005)
    assert (found.first[on_floor] > 0).mean() > 0.9


def test_places_follow_the_seed(tmp_path, monkeypatch):
    places = []
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        (tmp_path / name).mkdir()
        places.append(drop(tmp_path / name, monkeypatch, seed=seed, tend=0.005).r)
    assert (places[0] == places[1]).all() and not (places[0] == places[2]).any()
