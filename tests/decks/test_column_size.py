"""inputs/15_axisymmetric: the line of run-out against the size of the balls, and columns of 8 and 12 d on it."""
import numpy as np
import pytest

from deck_helpers import LMP

from slope_tools.validation import verify
from slope_tools.validation.verification import axisymmetric as case


def test_a_line_is_found_again():
    """Exactly without scatter; with it the error of A is that of a straight line through the points."""
    radii = np.array([8, 8, 12, 12, 16.0])
    found = case.line_of(radii, 1.22 - 3.4 / radii)
    assert (found.limit, found.slope) == pytest.approx((1.22, -3.4)) and found.error == pytest.approx(0, abs=1e-9)
    assert found.at(32) == pytest.approx(1.22 - 3.4 / 32)
    random = np.random.default_rng(1)
    several = [case.line_of(radii, 1.22 - 3.4 / radii + random.normal(0, 0.03, 5)) for _ in range(500)]
    assert np.std([one.limit for one in several]) == pytest.approx(
        np.sqrt(np.mean([one.error ** 2 for one in several])), rel=0.1)


def balls(*rings):
    """So many balls in each ring of one diameter."""
    away = np.concatenate([np.full(number, ring + 0.5) for ring, number in enumerate(rings)])
    return {"x": [away * case.D], "y": [np.zeros(len(away))]}


def test_the_front_by_rings_and_between_them():
    """A layer of the third ring has 5 pi balls, of the fourth 7 pi."""
    few = balls(3, 9, 15, 2)
    layers = case.layers_of(few)
    assert layers == pytest.approx([3 / np.pi, 3 / np.pi, 3 / np.pi, 2 / (7 * np.pi)])
    assert case.front_of(few) == 3
    at = case.front_between(few)
    assert 2.5 < at < 3.5 and np.interp(at, [2.5, 3.5], layers[2:]) == pytest.approx(case.COVER)
    assert case.front_between(few, 0.5) < at < case.front_between(few, 0.1)
    assert 2.5 < case.front_between(balls(3, 9, 15)) < 3.5      # nothing beyond


@pytest.fixture(scope="module")
def runner(tmp_path_factory):
    return verify.Runner(tmp_path_factory.mktemp("columns"), LMP)


@pytest.mark.long
@pytest.mark.parametrize("material", ["sand", "glass"])
def test_columns_of_8_and_12_diameters_lie_on_the_published_line(runner, material):
    """Within 0.6 of a ring, as single fillings scatter; another friction does not."""
    deck, line = case.MATERIALS[material](a=0.5), case.LINES[material, 0.5]
    away = case.from_line(line)
    assert away(*(runner.result(deck(radius=radius)) for radius in (8, 12))) < 0.6
    assert away(runner.result(deck(radius=8, friction=5))) > 0.9
