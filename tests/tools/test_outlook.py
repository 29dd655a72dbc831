"""What `slope site` says before the study: where the terrain ends, what is too coarse, the disk."""
import re

import numpy as np
import pytest
from shapely.geometry import LineString

from run_helpers import called, write_tif
from test_site import BODY, CELL, COLUMNS, EAST, ROWS, gis, height, told, write_layer  # noqa: F401
from test_site_anew import inside, mine, once  # noqa: F401

from slope_tools.commands import site as site_command
from slope_tools.sites import site_choices, site_warnings
from slope_tools.studies import outlook

STANDARD = " ".join(["--release release.geojson", *BODY, "--road road.geojson"])


@pytest.fixture(autouse=True)
def nothing_drawn(monkeypatch):
    monkeypatch.setattr(site_command.site_map, "draw_site_map", lambda path, *_: path.write_bytes(b""))


def test_where_the_terrain_ends_and_what_is_to_be_added(inside, gis):  # noqa: F811
    """With as much level ground as it asks for, hardly any event goes beyond the terrain."""
    out = inside(f"--terrain dem.tif {STANDARD} -o first").out
    share, length, metres = re.search(
        r"(\d+) % of known events go beyond the terrain, which the fall path leaves after ([\d.]+) m: add about "
        r"([\d.]+) m of terrain in the west", out).groups()
    assert "at best a floor" not in out     # it ends behind the road
    assert float(share) > 20 and 85 < float(length) < 95 and f"fall path of {length} m" in out
    assert re.search(r"^69 known events, translational_slides:all: .*50 % beyond [\d.]+ m.*; beyond the terrain: "
                     rf"{share} %$", out, re.MULTILINE)
    assert re.search(r"^the road, first met after [\d.]+ m: \d+ % go beyond its near edge, \d+ % beyond its far edge$",
                     out, re.MULTILINE)
    more = int(np.ceil(float(metres) / CELL)) + 2
    z = np.broadcast_to(100 + np.concatenate([np.zeros(more), height((np.arange(COLUMNS) + 0.5) * CELL)]),
                        (ROWS, COLUMNS + more))
    write_tif(gis / "larger.tif", z, CELL, xlo=EAST - more * CELL, crs="EPSG:6677")
    out = inside(f"--terrain larger.tif {STANDARD} -o second").out
    assert "go beyond the terrain" not in out
    assert "at best a floor" not in out


def test_lengths_have_the_digits_of_slope_mobility(mine, capsys):  # noqa: F811
    """One fact, one number: the fall path, and where it meets the road."""
    status, out, err = called(capsys, ["mobility", str(mine), "-o", str(mine / "known")])
    assert status == 0, err
    for pattern in (r"fall path of .*", r"the road, first met after [\d.]+ m"):
        here, there = (re.search(pattern, text)[0] for text in ("\n".join(outlook.describe_outlook(mine)), out))
        assert here == there


def test_a_terrain_that_ends_on_a_road_makes_a_floor(mine, monkeypatch):  # noqa: F811
    met = outlook.known.fall_path.at_road
    for add, said in ((0.0, False), (60.0, True)):
        monkeypatch.setattr(outlook.known.fall_path, "at_road", lambda *given: (
            one := met(*given))._replace(passed=one.passed + add))
        found = outlook.describe_outlook(mine)
        assert any("at best a floor" in line and "beyond the terrain" in line for line in found) is said
        assert any("go beyond the terrain" in line for line in found)


def test_a_site_with_too_few_sizes_of_balls_has_no_bound(mine):  # noqa: F811
    path = mine / "site.yaml"
    for levels, said in ((2, True), (3, False)):
        path.write_text(re.sub(r"  levels: \w+", f"  levels: {levels}", path.read_text()))
        found = outlook.describe_outlook(mine)
        assert any("balls of 2 sizes are run, 3 show" in line and "neither" in line for line in found) is said


@pytest.mark.parametrize("side, x, y", [("west", 0.5, 40.0), ("east", 119.5, 40.0), ("south", 60.0, 0.5),
                                        ("north", 60.0, 79.5), ("south and the west", 1.0, 1.0)])
def test_the_side_at_which_a_path_leaves(mine, side, x, y):  # noqa: F811
    mass = outlook.body.read_mobility_body(mine)
    ends = np.array([60.0, x]), np.array([40.0, y])
    path = outlook.FallPath(*ends, np.zeros(2), np.zeros(2), outlook.TERRAIN, (0.0, 0.0, 0.0))
    assert outlook.side_of(path, mass.raster) == side
    z = mass.raster.z.copy()
    z[18:22, 20:30] = np.nan        # 40 to 60 m in x, 36 to 44 in y: a lake
    there = np.isfinite(z)
    assert not outlook.gone.is_in_hole(x, y, there, mass.raster) and outlook.gone.is_in_hole(63, 40, there, mass.raster)


@pytest.mark.parametrize("words, balls, cells", [
    ("--road-width 1", "0.51", "0.5"), ("--road-width 3 --diameter 1", "3", "1.5"),
    ("--road-width 4 --diameter 1", "", "")])
def test_a_road_narrower_than_a_ball_or_two_cells(inside, gis, words, balls, cells):  # noqa: F811
    write_layer(gis / "axis.geojson", [(28, 0), (28, 80)], kind=LineString)
    err = inside(f"--terrain dem.tif {STANDARD} --road axis.geojson {words} -o line".replace(
        "--road road.geojson ", "")).err
    said = re.search(r"the road is about (\S+) m wide, (\S+) balls of \S+ m and (\S+) cells of 2 m: narrower", err)
    assert (said is None) == (not balls), err
    if said:
        assert said[3] == cells and said[2].startswith(balls)


def test_a_narrow_polygon_is_a_narrow_road():
    strip = LineString([(0, 0), (50, 10), (100, 0)]).buffer(3, cap_style=2)
    found, = site_warnings.check_road_resolution(strip, None, 7.9, 2.0)
    assert found.numbers["width"] == pytest.approx(6, rel=0.07) and "--diameter 5." in found.numbers["remedy"]
    assert site_warnings.check_road_resolution(strip, None, 5.0, 2.5) == [] == site_warnings.check_road_resolution(None,
                                                                                                                   None,
                                                                                                                   5.0,
                                                                                                                   2.5)


def test_a_coarse_elevation_model(inside, gis):  # noqa: F811
    """Of cells that are as coarse as it, or that were made smaller."""
    z = np.broadcast_to(100 + height((np.arange(12) + 0.5) * 10), (8, 12))
    write_tif(gis / "coarse.tif", z, 10.0, crs="EPSG:6677")
    for words in ("", "--cell 2"):
        err = inside(f"--terrain coarse.tif {STANDARD} {words} --verbose -o coarse{len(words)}").err
        assert re.search(r"the body is about (3|4)(\.\d)? cells of 10 m across, below 10: its surface and volume", err)
    assert "cells of" not in inside(f"--terrain dem.tif {STANDARD} -o fine").err


def test_the_disk_of_a_study_grows_with_balls_and_runs(mine):  # noqa: F811
    choices, found = site_choices.load_site(mine).choices, site_choices.found(mine)
    whole = outlook.disk_of_study(mine, choices, found, [8, 4])
    choices = choices.changed({("study", "points"): 0})
    paper, without = (outlook.disk_of_study(mine, choices, found, numbers) for numbers in ([8, 4], []))
    assert whole > 1.1 * paper > 1.2 * without
    choices = choices.changed({("balls", "diameter"): choices.balls.diameter / 2})
    assert 3 < (outlook.disk_of_study(mine, choices, found, []) - outlook.PAGES) / (without - outlook.PAGES) < 8
