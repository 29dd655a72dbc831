"""inputs/26_okada: blocks begin where the deck says, none overlaps, and they run down; its numbers."""
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import run_deck, script_of

CASE = Path(__file__).resolve().parents[2] / "inputs" / "26_okada"
DECK = (CASE / "in.okada").read_text()
D, ANGLE = 0.124, np.radians(35)


@pytest.fixture(scope="module")
def okada():
    return script_of(CASE / "okada.py")


def places(path):
    return np.loadtxt(path, skiprows=9, ndmin=2)[:, 3:6]


def along_and_normal(place):
    """Along the slope from the toe, and above it."""
    return (place[:, 0] * np.cos(ANGLE) + place[:, 2] * np.sin(ANGLE),
            place[:, 2] * np.cos(ANGLE) - place[:, 0] * np.sin(ANGLE))


@pytest.mark.parametrize("how", ("stacked", "loose"))
def test_blocks_begin_in_rows_above_the_ground(okada, tmp_path, how):
    for count, ((long, wide, high), _) in okada.NUMBERS.items():
        run_deck(DECK, tmp_path, vars={"long": long, "wide": wide, "high": high, "duration": 0.002, **okada.HOW[how]})
        start = places(tmp_path / "okada.start.dump")
        assert len(start) == count == long * wide * high
        apart = np.linalg.norm(start[:, None] - start[None], axis=2)[np.triu_indices(count, 1)]
        assert apart.min() > 0.98 * D
        along, above = along_and_normal(start)
        size = {"stacked": 1.02, "loose": 1.4}[how] * D
        assert 4 <= along.min() < 4 + 2 * D and along.max() < 4 + 2 * D + size * (long - 1)
        assert above.min() > D and above.max() < 2 * D + size * (high - 1)
        assert np.ptp(start[:, 1]) == pytest.approx(size * (wide - 1), abs=0.5 * D)


def test_blocks_run_down_and_rest(okada, tmp_path):
    """Round ones reach the floor; with a strong rolling resistance they stay where they are."""
    reached = {}
    for rolling in (0.05, 2.0):
        run_deck(DECK, tmp_path, vars={"long": 2, "high": 2, "rolling": rolling})
        start, rest = places(tmp_path / "okada.start.dump"), places(tmp_path / "okada.rest.dump")
        assert len(rest) == len(start) == 20
        reached[rolling] = (rest[:, 0] < 0).mean()
        ground = np.maximum(rest[:, 0], 0) * np.tan(ANGLE)
        assert (rest[:, 2] > ground + 0.3 * D).all()
    assert reached[0.05] > 0.9 and reached[2.0] < 0.3


def test_numbers_of_runs(okada):
    one = (np.array([4.0, 4.0]), np.array([1.0, -1.0]))
    mean, far, travel, stay = okada.numbers([one, one])
    assert mean == pytest.approx(okada.EDGE) and travel == 4 and stay == 0.5
    assert far == pytest.approx(okada.EDGE + 1)
    assert okada.row([one, one])[1::2] == ["0.000"] * 4             # no difference between the seeds
