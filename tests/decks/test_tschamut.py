"""inputs/27_tschamut without its runs: the data are those of its README, the terrain ends where they do."""
import re
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import Point

from deck_helpers import read_asc, script_of

CASE = Path(__file__).resolve().parents[2] / "inputs" / "27_tschamut"


@pytest.fixture(scope="module")
def case():
    return script_of(CASE / "tschamut.py")


def test_the_measured_row_is_that_of_the_readme(case):
    start, end = case.measured()
    _, number, *values = case.row("measured", np.hypot(*(end - start).T))[:-1]
    [told] = re.findall(r"^\| measured, (\d+) \|(.*)\|", re.sub("<!--.*?-->", "", (
        CASE / "README.md").read_text()), re.MULTILINE)
    assert number == int(told[0]) == 80 and values == [one.strip() for one in told[1].split("|")][:5]


def test_blocks_that_left_a_cut_terrain_went_farther_than_all_others(case):
    assert case.row("a", np.array([1.0, 2.0, 3.0, 4.0, np.inf]), [0, 0, 0, 0, 1])[2:] == [
        "1.2", "2.0", "3.0", "4.0", "beyond", 1]


@pytest.mark.parametrize("whole", [True, False])
def test_the_terrain_ends_120_m_from_the_releases(case, tmp_path, whole):
    case.prepare(tmp_path, whole)
    heights, header = read_asc(tmp_path / "terrain.asc")
    rows, columns = heights.shape
    x, y = np.meshgrid(header["xllcorner"] + (np.arange(columns) + 0.5) * header["cellsize"],
                       header["yllcorner"] + (np.arange(rows) + 0.5) * header["cellsize"])
    away = np.array([case.area().distance(Point(place)) for place in zip(x.flat, y.flat)]).reshape(x.shape)
    none = ~np.isfinite(heights)
    assert not none.any() if whole else (none == (away > 120)).all()
    before, _ = read_asc(CASE / "terrain.asc")
    assert heights[~none] == pytest.approx(before[~none], abs=1e-9)
    assert len(np.loadtxt(tmp_path / "release.csv", delimiter=",")) > 10
