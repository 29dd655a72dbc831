"""inputs/05_apparent_restitution: the rebounds as a set; those of single balls are quick claims."""

from pathlib import Path

import numpy as np
import pytest

from deck_helpers import run_deck, script_of

CASE = Path(__file__).resolve().parents[2] / "inputs" / "05_apparent_restitution"
plot = script_of(CASE / "plot.py")


def drop(folder, monkeypatch, spacing=1.4, **variables):
    """Let 300 balls fall at one spacing; returns plot.py's Drop."""
    monkeypatch.chdir(folder)
    run_deck((CASE / "in.apparent_restitution").read_text(), folder,
             vars={"balls": 300, "spacing": spacing, **variables})
    found, = plot.read("bounce")
    return found


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
