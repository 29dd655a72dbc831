"""inputs/20_embankment/paper_table.py: means and ranges of a study, by two bulk factors; and the longer terrain."""
import math
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import LMP, script_of

CASE = Path(__file__).resolve().parents[2] / "inputs" / "20_embankment"


@pytest.fixture(scope="module")
def script():
    return script_of(CASE / "paper_table.py")


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The same balls of 8 m on the slip surface, by both bulk factors."""
    folders = {}
    for name, bulk in (("body", "region slip"), ("ball", f"{6 / math.pi:.15g}")):
        folders[name] = tmp_path_factory.mktemp(name)
        for file in ("in.embankment", "terrain.asc"):
            shutil.copy(CASE / file, folders[name])
        subprocess.run([LMP, "-in", "in.embankment", "-screen", "none", "-var", "d", "8", "-var", "sink", "0", "-var",
                        "rule", "ours", "-var", "bulk", bulk], cwd=folders[name], check=True, stdin=subprocess.DEVNULL)
    return folders


def test_another_bulk_factor_is_that_of_the_deck(script, runs):
    """From one run: what the deck gives by the other factor, which is no multiple of its volumes."""
    expected = script.volumes(runs["ball"] / "embankment")
    found = script.volumes(runs["body"] / "embankment", script.CUBE_BULK)
    usual = script.volumes(runs["body"] / "embankment")
    assert found == pytest.approx(expected, rel=1e-3) and usual["released"] == pytest.approx(48858, rel=1e-3)
    factor = found["released"] / usual["released"]
    assert factor < 0.8 and abs(found["to remove"] / factor / usual["to remove"] - 1) > 0.02
    again = script.volumes(runs["body"] / "embankment", float(script.volume.deposit.read_deposit(
        runs["body"] / "embankment", None, lambda said: None).bulk))
    assert again == pytest.approx(usual, rel=1e-3)      # the deck's own rasters from the same balls


def test_mean_and_range(script):
    assert script.text([15268.9, 14698.6, 15208.4]) == "15,059 (14,699 to 15,269)"
    assert script.text([48858.3, 48858.4]) == "48,858"


def test_the_longer_terrain_has_the_same_heights(script):
    short, long = (np.loadtxt(CASE / f"{name}.asc", skiprows=6) for name in ("terrain", "terrain_long"))
    assert np.array_equal(long[32:-32, -short.shape[1]:], short)
    assert long.shape == (short.shape[0] + 64, short.shape[1] + 160)
    head = dict(line.split() for line in (CASE / "terrain_long.asc").read_text().splitlines()[:6])
    assert (head["xllcorner"], head["yllcorner"], head["cellsize"]) == ("-400", "-80", "2.5")
    made = script.make_terrain
    assert made.heights(west=made.FAR, more=made.ASIDE) == pytest.approx(long, abs=6e-4)
    roads = [np.loadtxt(CASE / f"{name}.csv", delimiter=",") for name in ("road", "road_long")]
    assert (roads[1] - roads[0]).tolist() == [[0, -80], [0, -80], [0, 80], [0, 80]]     # from edge to edge


def volumes(*remove):
    return [{"released": 50.0, "to remove": one, "on the road": 5.0, "beyond": one / 10} for one in remove]


def test_the_change_over_the_lattices_and_its_chance(script):
    """Of pairs: what all lattices share drops out. One lattice, or no difference at all, has no chance."""
    found = {"0.10": volumes(89, 100, 109), "0": volumes(100, 110, 120.0)}
    change, chance = script.trend(found, "to remove")
    assert change == pytest.approx(-32 / 3) and chance == pytest.approx(0.000976, rel=1e-2)
    assert script.trend({"0": volumes(1.0), "0.1": volumes(2.0)}, "to remove") is None
    assert script.trend(found, "on the road") is None
    assert script.largest(found) == 110


def test_the_numbers_that_pages_get(script):
    kept = script.numbers(script.Table((2.45, 2.7), {"0": volumes(14225, 28450.0), "0.10": volumes(9, 11.0)}), "a.body")
    assert kept["a.body.ball"] == "2.45 to 2.7" and kept["a.body.ratio"] == 1.5
    assert kept["a.body.remove.0.1"] == 10 and kept["a.body.remove.0.all"] == "21,338 (14,225 to 28,450)"
    assert kept["a.body.beyond.0"] == pytest.approx(2133.8, abs=0.06) and "a.body.road.change" not in kept
