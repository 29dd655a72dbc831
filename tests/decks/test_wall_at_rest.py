"""The force at rest on mesh walls: a bin of balls, with the script that doc/src/structures.rst names."""

import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from deck_helpers import LMP

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from wall_at_rest import bin_of  # noqa: E402  # pylint: disable=wrong-import-position


@pytest.mark.parametrize("friction, rolling, share, expected", [
    (0, 0, 1, 1.0), (25, 0.05, 1, 0.73), (25, 0.05, 0.02, 0.51)])
def test_walls_and_floor_carry_the_weight(tmp_path, friction, rolling, share, expected):
    """Without friction the walls have the pressure of a fluid; with friction less, least where the weight grows."""
    args = SimpleNamespace(lmp=Path(LMP).resolve(), width=9, height=15, settle=20)
    found = bin_of(args, tmp_path, 7919, friction, rolling, True, share=share)
    assert found["carried"] == pytest.approx(1, abs=0.005)
    assert sum(found["K"]) / 4 == pytest.approx(expected, abs=0.1)
    assert min(found["contacts"]) >= 20
