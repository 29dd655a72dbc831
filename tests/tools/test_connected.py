"""The connected deposit on thickness rasters made by hand."""
import math

import numpy as np
import pytest
from run_helpers import write_run

from slope_tools.deposits import deposit, score

CELL = 2.0


@pytest.fixture
def found(here):
    """A function: what is found in a raster (rows from the north) over ground at height 5; top at 0 0 35."""
    def make(thickness, threshold=0.1, top=(0.0, 0.0, 35.0), base=5.0):
        write_run(thickness, base, CELL, travel={"top": list(top)} if top else {})
        return score.connected(deposit.read_deposit("run", None, lambda text: None), threshold)
    return make


def grid(*cells):
    """A raster of 20 x 30 cells that is 1 m thick in some (row from the south, column)."""
    z = np.zeros((20, 30))
    for row, column in cells:
        z[19 - row, column] = 1.0
    return z


def test_a_bar_and_a_stray_ball(found):
    """The bar reaches 24 m, a ball in a cell of its own 56 m: the bar counts."""
    bar = [(0, column) for column in range(2, 12)]
    one = found(grid(*bar, (3, 27)))
    assert (one.parts, one.volume, one.area) == (2, 40.0, 40.0)
    assert one.share == pytest.approx(40 / 44)
    assert one.distance == pytest.approx(math.hypot(24, 2)) and one.farthest == (24.0, 2.0)
    assert one.reach_angle == pytest.approx(math.degrees(math.atan2(35 - 6, math.hypot(24, 2))))
    assert one.mask.sum() == 10 and one.mask[19, 2:12].all()
    assert found(grid(*bar)).distance == one.distance


def test_cells_that_touch_at_corners_are_one_part(found):
    assert found(grid((0, 0), (1, 1), (2, 2))).parts == 1
    one = found(grid((0, 0), (1, 1), (3, 3)))
    assert (one.parts, one.area) == (2, 8.0)


def test_the_largest_is_the_one_of_the_largest_volume(found):
    """Ten cells of 0.2 m are less than one of 3 m."""
    thickness = 0.2 * grid(*[(10, column) for column in range(10, 20)]) + 3.0 * grid((2, 2))
    one = found(thickness)
    assert (one.volume, one.area, one.farthest) == (12.0, 4.0, (6.0, 6.0))
    assert found(0.1 * thickness, threshold=0.25).area == 4.0


def test_the_threshold_is_not_in_the_deposit(found):
    assert found(0.1 * grid((2, 2)), threshold=0.1) is None
    assert found(0.1 * grid((2, 2)), threshold=0.0999).volume == pytest.approx(0.4)


def test_distance_in_every_direction(found):
    """The corner farthest from the top, wherever the top is."""
    for top, corner in (((0, 0), (22, 14)), ((50, 30), (20, 12)), ((50, 0), (20, 14)), ((0, 30), (22, 12))):
        one = found(grid((6, 10)), top=(*map(float, top), 9.0))
        assert one.farthest == corner and one.distance == pytest.approx(math.dist(top, corner))
        assert one.reach_angle == pytest.approx(math.degrees(math.atan2(3, one.distance)))


def test_without_heights_there_is_no_angle(found):
    ground = np.full((20, 30), 5.0)
    ground[:, 11:] = np.nan
    one = found(grid((0, 10), (0, 11)), base=ground)
    assert one.reach_angle is None and one.farthest == (24.0, 2.0)
    assert found(grid((0, 10), (0, 9)), base=ground).reach_angle is not None


def test_an_old_summary_has_no_top(found):
    """Then the highest cell that held mass is where distances are counted from."""
    x = np.broadcast_to(np.arange(30.0), (20, 30))
    one = found(grid(*[(5, column) for column in range(3, 9)]), top=None, base=x)
    assert one.distance == pytest.approx(math.hypot(17 - 6, 1))
    assert one.reach_angle == pytest.approx(math.degrees(math.atan2(8 - 3, one.distance)))
