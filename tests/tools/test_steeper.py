"""What share of the slope below a body is steeper than the stop angle of its ground, and who says so."""
import functools
import re
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
import made_rows
from test_mobility_path import disc, terrain
from test_site import gis, told  # noqa: F401
from test_site_anew import inside, mine, once  # noqa: F401

from slope_tools.errors import SlopeError
from slope_tools.mobility import body, steeper
from slope_tools.report import limits_part
from slope_tools.report.numbers import Numbers
from slope_tools.sites.stop_angle import stop_angle
from slope_tools.sites import site_choices
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


# --- who says so ---

def angles(spacing, *rolling):
    return ", ".join(f"{stop_angle(spacing, 30, one, 0.1).degrees:.1f}" for one in rolling)


def test_a_site_and_its_study_say_it_of_each_ground(inside, mine):  # noqa: F811
    """The site of its own; the study of the others at both ends of the rolling resistances; what is unknown is not."""
    own = (f"the ground, spacing 0.9: stop angle {angles(0.9, 0, 0.05, 0.1)} degrees at a rolling resistance of 0, "
           "0.05, 0.1")
    said = site_ground.describe_grounds(site_choices.load_site(mine))
    assert len(said) == 1 and said[0].startswith(own) and said[0] in inside("mine --balls 70").out
    both = site_ground.describe_grounds(site_choices.load_site(mine), others=True)
    assert both[0] == said[0] and [line.split(":")[0] for line in both] == [
        f"the ground, spacing {spacing}" for spacing in ("0.9", "0.5", "0.7")]
    assert f"stop angle {angles(0.7, 0, 0.1)} degrees at a rolling resistance of 0, 0.1; of" in both[2]
    share = steeper.below(body.read_mobility_body(mine)).steeper(stop_angle(0.5, 30, 0, 0.1).degrees)
    assert re.search(rf"of the slope below the body {100 * share:.0f}, \d+ % is steeper$", both[1])
    about = yaml.safe_load((mine / "site.yaml").read_text())
    about["study"]["rolling"] = [0, 0.9]
    (mine / "site.yaml").write_text(yaml.safe_dump(about))
    assert re.search("resistance of 0;", site_ground.describe_grounds(site_choices.load_site(mine))[0])
    inside("mine --friction 60")
    assert site_ground.describe_grounds(site_choices.load_site(mine), others=True) == []


def shown(below, **given):
    row = made_rows.row(**given)
    data = SimpleNamespace(result=SimpleNamespace(row=row), label=lambda _: "rolling 0",
                           compared=[row, made_rows.row(stop_angle_deg=28.2), made_rows.row()])
    return limits_part.resistance(data, below, Numbers())


def test_the_report_says_it_of_its_run():
    ground = SimpleNamespace(below=steeper.below(disc(terrain(broken), CENTRE)))
    [(what, text)] = shown(ground, stop_angle_deg=24.36)
    assert what == limits_part.RESISTANCE
    assert "below 24.4 degrees (stop angle, run rolling 0; in all runs 24.4 to 28.2)" in text
    assert f"{100 * ground.below.steeper(24.36):.0f} % is steeper" in text
    assert "in all runs" not in shown(ground, stop_angle_deg=28.2)[0][1]
    assert shown(ground, stop_angle_deg=None) == shown(ground) == []


def test_a_body_on_level_ground_has_a_stop_angle_alone():
    class Level:
        @functools.cached_property
        def below(self):
            return steeper.below(disc(terrain(lambda x, y: 0 * x), CENTRE))
    assert shown(Level(), stop_angle_deg=24.36)[0][1].endswith("24.4 to 28.2).")
