"""When the conservative volume is withheld: each rule alone, none, and several; the words; what left before a road."""
import argparse
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from affine import Affine
from shapely.geometry import box

from slope_tools import cli
from slope_tools.deposits import left
from slope_tools.statistics import withheld
from slope_tools.statistics.withheld import Facts, Kind
from slope_tools.survey.rasters import Raster
from slope_tools.tables import combinations, usable, withheld_words
from slope_tools.tables.usable import Events
from slope_tools.tables.withheld_words import Case

GOOD = Facts(volume=5000.0, on_road=3000.0, ball=10.0, runs=20, failed=0, moving=0, left=0.0, length=900.0,
             median=800.0)
SITE = Case(Path("site/in.site"), Path("my site"), {"friction": "30", "rolling": "0.1", "d": "2"}, 1000)
DECK = Case(Path("in.slope"), None, {"d": "2", "duration": "60"}, 1000)


@pytest.mark.parametrize("changed, kinds", [
    ({}, []),
    ({"on_road": 99.0}, [Kind.BALLS]),                                  # 9.9 balls
    ({"on_road": 100.0}, []),
    ({"length": 799.0}, [Kind.MOBILITY]),
    ({"length": 100.0, "median": None}, []),                            # no set covers the mass
    ({"left": 0.011}, [Kind.LEFT]),
    ({"left": 0.01}, []),
    ({"failed": 1, "moving": 2}, [Kind.RUNS]),                          # 15 %
    ({"moving": 2}, []),                                                # 10 %
    ({"size": "it is -20 %"}, [Kind.SIZE]),
    ({"volume": 0.0, "on_road": 0.0, "size": "it is -20 %"}, []),       # nothing to count balls of
    ({"volume": 0.0, "on_road": 0.0, "length": 1.0, "left": 0.5, "failed": 20},
     [Kind.MOBILITY, Kind.LEFT, Kind.RUNS])])
def test_twelve_cases(changed, kinds):
    assert [one.kind for one in withheld.reasons(GOOD._replace(**changed))] == kinds


ANEW = "tools/slope site 'my site'{} && tools/slope study 'my site' --anew"


@pytest.mark.parametrize("changed, case, text, remedy", [
    ({"on_road": 50.0}, SITE, "on the road lies the volume of 5 balls, fewer than 10", ANEW.format(" --balls 2200")),
    ({"on_road": 50.0}, DECK, "5 balls", "the same command with --set d=1.54"),
    ({"length": 700.0}, SITE, "no run reaches 800 m, as half of known events of this volume and height do; the longest "
     "one ends at 700 m", "tools/slope study 'my site' --sample 64 --known rock_avalanches"),
    ({"length": 700.0}, DECK, "no run reaches", "tools/slope calibrate in.slope, with a past event"),
    ({"length": None}, DECK, "no run reaches 800 m, as half of known events of this volume and height do; there is no "
     "deposit", "tools/slope calibrate in.slope, with a past event"),
    ({"length": 700.0}, DECK._replace(variables={"friction": "30"}), "no run reaches", "tools/slope study in.slope "
     "--sample 64 --known rock_avalanches --vary friction=10:30 --road ROAD -o DIR"),
    ({"left": 0.3}, SITE, "30 % of the released volume left the terrain before or beside the road, more than 1 %",
     "a larger elevation model (terrain.files, terrain.bounds) in 'my site'/site.yaml, then: " + ANEW.format("")),
    ({"on_road": 10.0}, SITE._replace(asked=" --paper"), "the volume of 1 ball, fewer than 10",
     ANEW.format(" --balls 11000").replace("--anew", "--paper --anew")),
    ({"left": 0.3}, SITE._replace(sampled=True), "30 %", "a larger elevation model (terrain.files, terrain.bounds) in "
     "'my site'/site.yaml, then: tools/slope site 'my site'; the same command with --anew"),
    ({"moving": 5}, DECK, "5 of 20 runs failed or are not at rest at the end, more than 10 %",
     "the same command with more time, --set duration=120"),
    ({"failed": 5}, DECK, "5 of 20 runs", "the same command again, once the cause of the failures is removed"),
    ({"size": "it is -20 %"}, SITE, "the size error is not trusted: it is -20 %", ANEW.format(" --balls 8800"))])
def test_the_reason_and_the_command_that_mends_it(changed, case, text, remedy):
    [entry] = withheld_words.with_remedies(withheld.reasons(GOOD._replace(**changed)), case)
    assert text in entry["text"] and entry["remedy"] == remedy


@pytest.mark.parametrize("case", [SITE, SITE._replace(asked=" --paper"), SITE._replace(sampled=True), DECK,
                                  DECK._replace(variables={"friction": "30", "rolling": "0"})])
@pytest.mark.parametrize("changed", [{"on_road": 50.0}, {"length": 700.0}, {"left": 0.3}, {"moving": 5}, {"size": "x"}])
def test_the_commands_are_ones_that_the_tools_take(case, changed):
    [entry] = withheld_words.with_remedies(withheld.reasons(GOOD._replace(**changed)), case)
    typed = re.findall(r"tools/slope (?:'[^']*'|[^&;,])*", entry["remedy"])
    assert typed or case.site is None or case.sampled
    for words in map(shlex.split, typed):
        parser = argparse.ArgumentParser()
        cli.add_command(parser.add_subparsers(), words[1], cli.module_of(words[1], parser))
        try:
            parser.parse_args(words[1:])
        except SystemExit:
            # the user has to add the observation and the ranges
            assert words == ["tools/slope", "calibrate", "in.slope"]


# --- of the rows of a study ---

def rows(*volumes, **more):
    return [{"status": "finished", "run": f"seed_{k}", "set": {"rolling": "0"}, "repeat": {"seed": str(k)},
             "remove_m3": volume, "remove_on_road_m3": volume / 2, "ball_m3": 1.0, "released_m3": 1000.0,
             "left_before_road_m3": 0.0, "at_rest": True, "length_m": 500.0, "label": "", **more}
            for k, volume in enumerate(volumes)]


def events(median, reached):
    """Known events, of which a share reaches the near edge of the road."""
    return Events(median, 300.0, 310.0, (reached / 2, reached), (0.0, reached / 2))


def judged(several, events=None, size=""):
    best = combinations.conservative({"rolling": ["0"]}, several, combinations.grouped(several))
    usable.judge(best, several, events, SITE, size)
    return best


def test_a_number_that_may_stand():
    best = judged(rows(90.0, 100, 110), events(400.0, 0.6))
    assert best["withheld"] == [] and best["volume_m3"] > 110 and best["zero"] is None
    assert combinations.describe(best)[0].startswith("conservative volume to remove: ")


def test_a_number_that_is_withheld_is_nowhere():
    best = judged(rows(90.0, 100, 110), events(600.0, 0.6))
    assert best["volume_m3"] is None and best["rounded"]["volume_m3"] is None
    lines = combinations.describe(best)
    assert lines[0] == "not usable as a conservative volume:" and "no run reaches 600 m" in lines[1]
    assert not any("m3" in line for line in lines)


def test_zero_has_a_probability():
    best = judged(rows(0.0, 0, 0), events(400.0, 0.25))
    assert best["volume_m3"] == 0 and best["zero"]["exceeded_at_most"] == pytest.approx(1 - 0.05 ** (1 / 3))
    assert combinations.describe(best)[1] == (
        "nothing is to be removed in any of 3 runs: in another one something is with a probability of at most 63 % "
        "(95 % confidence); 25 % of known events of this volume and height go as far as the road")


# --- what left the terrain before it reached the road ---

def test_what_left_before_or_beside_a_road():
    """Mass in the west, a road in the middle that ends short of the northern edge."""
    z = np.zeros((10, 20))
    raster = Raster(z, Affine(1, 0, 0, 0, -1, 10), None)
    released = np.zeros(z.shape, bool)
    released[4:6, 1:3] = True
    road = box(9, -1, 11, 8)
    z[5, 19] = 3.0                              # behind the road
    assert left.before_road(100.0, raster, released, road) == 0
    z[0, 5] = 1.0                               # at the side, before it
    assert left.before_road(100.0, raster, released, road) == pytest.approx(25.0)
    z[9, 10] = 4.0                              # on the road itself
    assert left.before_road(100.0, raster, released, road) == pytest.approx(500.0 / 8)
    assert left.before_road(0.0, raster, released, road) == 0
    assert left.before_road(7.0, raster._replace(z=0 * z), released, road) == 7     # nobody knows where


def test_a_valley_that_turns_behind_the_road():
    """The mass goes east, passes a road across the valley, and leaves in the north: no straight line tells that."""
    z = np.zeros((40, 60))
    raster = Raster(z, Affine(1, 0, 0, 0, -1, 40), None)
    released = np.zeros(z.shape, bool)
    released[28:32, 2:6] = True
    z[26:34, 2:50] = 1.0
    z[0:34, 42:50] = 1.0
    road = box(34, 4, 36, 16)
    assert left.before_road(100.0, raster, released, road) == 0
    # without a way through: the straight line
    z[20:24, 42:50] = 0
    z[10:16, 42:50] = 0
    assert left.before_road(100.0, raster, released, road) == 100
    assert left.before_road(100.0, raster, released, box(0, 0, 20, 20)) == 100      # a road below all of the mass
    # a second way round the road, and shorter
    z[0:34, 42:50] = 1.0
    z[0:28, 8:16] = z[0:8, 8:50] = 1.0
    assert left.before_road(100.0, raster, released, road) == pytest.approx(100.0, rel=0.2)
