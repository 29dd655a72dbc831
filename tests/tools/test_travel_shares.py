"""What shares of a mass stay within: distance and reach angle by volume, by hand and against brute force."""
import math

import numpy as np
import pytest

from slope_tools.deposits.travel_shares import compute_reach_quantiles
from slope_tools.quantiles import within


def test_within_by_hand():
    values, weights = [3.0, 1.0, 2.0, 9.0], [1, 1, 1, 1]
    assert [within(values, weights, share) for share in (0.01, 0.25, 0.26, 0.5, 0.75, 0.76, 1)] == [
        1, 1, 2, 2, 3, 9, 9]
    assert within([5.0, 1.0, 3.0], [0.2, 0.5, 0.3], (0.05, 0.5, 0.6, 0.95)).tolist() == [1, 1, 3, 5]
    assert within(values, [0, 5, 0, 0], 0.99) == 1 and within(values, weights, [0.5, 0.9], 4).tolist() == [9, math.inf]
    assert math.isnan(within([], [], 0.5)) and math.isnan(within(values, [0] * 4, 0.5))


@pytest.mark.parametrize("weight", np.linspace(0.001, 0.1, 34))
def test_nine_of_ten_equal_weights_are_nine_tenths(weight):
    """However the sums are rounded."""
    assert within(np.arange(10.0), np.full(10, weight), 0.9) == 8


def test_quantiles_are_those_of_the_volume():
    """1 of 100 balls holds 2 % of the volume and lies farthest: 98 % stay within the others' distance."""
    places = np.array([[float(k), 0, 0] for k in range(1, 100)] + [[500.0, 0, 0]])
    volumes = np.array([0.98 / 99] * 99 + [0.02])
    found = {one.share: one for one in compute_reach_quantiles(places, (0, 0, 0), volumes)}
    assert found[0.99].distance == 500 and found[0.95].distance == 96
    assert {one.share: one.distance for one in compute_reach_quantiles(places, (0, 0, 0), np.ones(100))}[0.99] == 99


def test_the_angle_has_quantiles_of_its_own():
    """The ball that is seen flattest is not the farthest one."""
    random = np.random.default_rng(4)
    places = np.column_stack([random.uniform(10, 100, 500), random.uniform(-50, 50, 500), random.uniform(0, 60, 500)])
    top = (0.0, 0.0, 70.0)
    volumes = random.uniform(1, 5, 500)
    distance = np.hypot(places[:, 0], places[:, 1])
    angle = np.degrees(np.arctan2(70 - places[:, 2], distance))
    for share, far, flat in compute_reach_quantiles(places, top, volumes):
        assert volumes[distance <= far].sum() >= share * volumes.sum() > volumes[distance < far].sum()
        assert volumes[angle >= flat].sum() >= share * volumes.sum() > volumes[angle > flat].sum()
    assert angle[distance.argmax()] != pytest.approx(compute_reach_quantiles(places, top, volumes)[-1].reach_angle)


def test_a_ball_at_the_top_went_nowhere():
    found = compute_reach_quantiles([[5, 5, 9], [5, 5, 9]], (5, 5, 9), [1, 1])
    assert all((one.distance, one.reach_angle) == (0, 90) for one in found)
