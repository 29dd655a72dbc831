"""The force at rest on mesh walls: a bin of balls, with the script that doc/src/structures.rst names."""

import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from deck_helpers import LMP

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from wall_at_rest import bin_of  # noqa: E402  # pylint: disable=wrong-import-position


@pytest.mark.parametrize("friction, rolling, share, expected, scatter", [
    (0, 0, 1, 0.92, 0.17), (25, 0.05, 1, 0.73, 0.1),
    pytest.param(25, 0.05, 0.02, 0.51, 0.1, marks=pytest.mark.long)])
def test_walls_and_floor_carry_the_weight(tmp_path, friction, rolling, share, expected, scatter):
    """Without friction nearly a fluid's pressure (12 runs: 0.84 to 1.05); with it less, least where the weight grows.
    """
    args = SimpleNamespace(lmp=Path(LMP).resolve(), width=9, height=15, settle=20)
    found = bin_of(args, tmp_path, 7919, friction, rolling, True, share=share)
    assert found["carried"] == pytest.approx(1, abs=0.005)
    assert sum(found["K"]) / 4 == pytest.approx(expected, abs=scatter)
    assert min(found["contacts"]) >= 20
