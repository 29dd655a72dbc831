"""inputs/20_embankment/open_geometry.py: bodies of other faces and depths, what it counts as the paper's numbers."""
import math
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import LMP, script_of

CASE = Path(__file__).resolve().parents[2] / "inputs" / "20_embankment"


@pytest.fixture(scope="module")
def script():
    return script_of(CASE / "open_geometry.py")


def test_enough_bodies_and_the_usual_one_among_them(script):
    assert len(script.bodies()) >= 60 and (36.0, 2.0, 18.0) in script.bodies()
    heights = np.loadtxt(CASE / "terrain.asc", skiprows=6)
    assert script.make_terrain.heights() == pytest.approx(heights, abs=6e-4)


def test_a_body_of_another_face(script, tmp_path):
    """39 m at 1 : 2, depth 18 m: 56,813 m3, whatever the balls; what is there is not made again."""
    folder = script.run((39.0, 2.0, 18.0), 0.1, 8.0, tmp_path, LMP)
    released, within, beyond, volumes, bulk = script.numbers(folder)
    assert released == pytest.approx(56813, rel=2e-3) and 50 < within < 150 and 0 <= beyond < 0.1 * released
    assert 1.7 < bulk < 2.1 and 0 < volumes[35.0][0] < volumes[30.0][0] < volumes[25.0][0] < released
    assert volumes[25.0][1] == pytest.approx(volumes[35.0][1])      # the road itself knows no cut
    log = folder / "log.lammps"
    log.write_text("kept")
    assert script.run((39.0, 2.0, 18.0), 0.1, 8.0, tmp_path, "none") == folder and log.read_text() == "kept"


def made(removed, beyond=0.0, bulk=6 / math.pi):
    return [(50e3, 90.0, beyond, {cut: (one, 5e3) for cut in (25.0, 30.0, 35.0)}, bulk) for one in removed]


@pytest.mark.parametrize("removed, gives, falls", [
    ((24048, 26009, 22340), "J", False), ((22114, 18262, 14490), "I", True), ((24000, 26000, 25000), "", False),
    ((1.09 * 22114, 18262, 14490), "I", True), ((1.11 * 22114, 18262, 14490), "", True)])
def test_what_gives_the_table(script, removed, gives, falls):
    for row in script.rows_of((36.0, 2.0, 18.0), made(removed)):
        assert (row["gives"], row["falls_with_rolling"], row["hardly_beyond"]) == (gives, falls, True)
    farther, *_ = script.rows_of((36.0, 2.0, 18.0), made(removed, beyond=600.0))
    assert not farther["hardly_beyond"]


def test_the_bulk_factor_scales_all_volumes(script):
    rows = list(script.rows_of((36.0, 2.0, 18.0), made((20e3, 19e3, 18e3), 100.0, bulk=2.0)))
    assert {(row["cut_deg"], row["bulk"]) for row in rows} == {
        (cut, bulk) for cut in (25.0, 30.0, 35.0) for bulk in ("body", "ball")}
    for row in rows:
        factor = 1.0 if row["bulk"] == "body" else 3 / math.pi
        assert row["released_m3"] == pytest.approx(factor * 50e3) and row["in_place_m3"] == 50e3
        assert row["remove_0_m3"] == pytest.approx(factor * 20e3)
        assert row["beyond_0.1_m3"] == pytest.approx(factor * 100)
