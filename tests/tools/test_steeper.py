"""What share of the slope below a body is steeper than the stop angle of its ground, and who says so."""
import numpy as np
import pytest
from test_mobility_path import disc, terrain

from slope_tools.errors import SlopeError
from slope_tools.mobility import steeper
from slope_tools.sites.stop_angle import stop_angle
from slope_tools.studies import site_ground

TAN = {20: np.tan(np.radians(20)), 35: np.tan(np.radians(35))}
BREAK, END, CENTRE = 1000.0, 1600.0, (300.0, 600.0)     # m: 35 degrees, then 20, then level


def broken(x, y):
    return np.where(x < BREAK, (BREAK - x) * TAN[35], 0.0) + np.clip(END - np.maximum(x, BREAK), 0, None) * TAN[20]


def test_share_of_the_height_below_the_toe():
    """The disc's toe is at 450 m: 550 m of 35 degrees and 600 of 20, but for a mass of 89 m in width at the breaks."""
    below = steeper.below(disc(terrain(broken), CENTRE))
    steep, gentle = 550 * TAN[35], 600 * TAN[20]
    assert below.lost.sum() == pytest.approx(steep + gentle, rel=0.03)
    assert below.steeper(25) == pytest.approx(steep / (steep + gentle), abs=0.05)
    assert below.steeper(15) > 0.95 and below.steeper(40) == 0


def test_a_body_on_level_ground_has_no_slope_below():
    with pytest.raises(SlopeError, match="must fall by at least"):
        steeper.below(disc(terrain(lambda x, y: 0 * x), CENTRE))


SITE = {"d": "2.5", "field_d": "${d}", "spacing": "0.9", "friction": "30", "rolling": "0.05", "field_e": "0.3",
        "ground_seed": "1"}


@pytest.mark.parametrize("change, known", [
    ({}, True), ({"field_d": "2.5"}, True), ({"field_d": "1.25"}, False), ({"spacing": "0.2"}, False),
    ({"friction": "soil"}, False)])
def test_of_a_run(change, known):
    found = site_ground.of_variables({**SITE, **change})
    assert (found is not None) == known
    assert not known or 20 < found < 30


def test_a_grid_and_no_ground_at_all():
    grid = {name: value for name, value in SITE.items() if name != "ground_seed"}
    assert site_ground.of_variables({**grid, "spacing": "0.8"}) == stop_angle(0.8, 30, 0.05, pattern="grid").degrees
    assert site_ground.of_variables({**grid, "spacing": "0.95", "pattern": "scattered 3"}) is not None
    assert site_ground.of_variables({}) is None and site_ground.of_variables(None) is None
