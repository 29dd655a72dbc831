"""inputs/25_authume on a stand-in for its data: a bench between two slopes; and on the data, where it is at hand."""
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import ALONE, ENVIRONMENT, LMP, read_asc, script_of

CASE = Path(__file__).resolve().parents[2] / "inputs" / "25_authume"
FALL = [(-4.0, 30.0), (20.0, 14.0), (32.0, 14.0), (60.0, 0.0)]      # x, height: a slope, a bench, another slope


def face(corners):
    return "facet normal 0 1 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*at) for at in corners) + \
        "endloop\nendfacet\n"


def strip(x0, x1, z0=0.0, z1=40.0):
    """A part of the stand-in as an ASCII STL; y is up."""
    (_, y0), (_, y1) = FALL[x0], FALL[x1]
    a, b = FALL[x0][0], FALL[x1][0]
    return "solid Mesh\n" + face([(a, y0, z0), (b, y1, z0), (b, y1, z1)]) + \
        face([(a, y0, z0), (b, y1, z1), (a, y0, z1)]) + "endsolid Mesh\n"


@pytest.fixture(scope="module")
def stand_in(tmp_path_factory):
    data = tmp_path_factory.mktemp("data") / "authume"
    data.mkdir()
    for k, name in enumerate(("Blue", "Red", "Gray")):
        (data / f"DTM_{name}_zone.stl").write_text(strip(k, k + 1))
    for profile, z in ((1, 14.0), (2, 26.0)):
        (data / f"positions_P{profile}.xyz").write_text(
            "".join(f"{x} 31.0 {z + dz}\n" for x, dz in ((2, 2), (2, -2), (-2, -2), (-2, 2))))
    (data / "Endpoints_P1.txt").write_text("".join(f"{x} 14.0 15.0 {mass} 1 1 1\n" for x, mass in
                                                   zip((20, 22, 24, 26), (200, 700, 700, 1500))))
    return data.parent


@pytest.fixture(scope="module")
def authume(stand_in):
    """The case's script as a module, on the stand-in."""
    before = dict(os.environ)
    os.environ.update({**ENVIRONMENT, **ALONE, "SLOPE_DATA": str(stand_in), "LMP": LMP})
    try:
        yield script_of(CASE / "authume.py")
    finally:
        os.environ.clear()
        os.environ.update(before)


@pytest.fixture(scope="module")
def prepared(authume, tmp_path_factory):
    folder = tmp_path_factory.mktemp("authume")
    authume.prepare(folder)
    return folder


def test_the_terrain_is_that_of_the_surfaces(prepared):
    heights, header = read_asc(prepared / "terrain.asc")
    x = header["xllcorner"] + header["cellsize"] * (np.arange(heights.shape[1]) + 0.5)
    assert np.isfinite(heights).all() and heights.shape == (80, 128)
    assert heights == pytest.approx(np.tile(np.interp(x, *zip(*FALL)), (80, 1)), abs=2e-3)


def test_zones_are_those_of_the_surfaces(prepared):
    for name, (x0, x1) in {"vegetated": (-4, 20), "red": (20, 32)}.items():
        ring = np.loadtxt(prepared / f"{name}.csv", delimiter=",")
        assert ring.min(axis=0) == pytest.approx([x0, 0], abs=0.05)
        assert ring.max(axis=0) == pytest.approx([x1, 40], abs=0.05)


def test_holes_are_filled_and_the_outline_kept(authume):
    values = np.full((6, 6), np.nan)
    values[1:5, 1:5] = 3.0
    values[2, 2] = np.nan
    found = authume.filled(values)
    assert (found[1:5, 1:5] == 3.0).all() and np.isnan(found[0]).all() and np.isnan(found[:, 5]).all()


def test_distance_of_two_distributions(authume):
    assert authume.distance(np.array([1.0, 2, 3, 4]), np.array([1.0, 2, 3, 4])) == 0
    assert authume.distance(np.array([1.0, 2, 3, 4]), np.array([3.0, 4, 5, 6])) == 0.5
    # what left the terrain is farther than all others
    assert authume.distance(np.array([1.0, 2, np.inf, np.inf]), np.array([1.0, 2, 3, 4])) == 0.5
    along, across = authume.quantiles([np.array([[1.0, 5], [2, 6], [np.inf, np.inf]])])
    assert along[-1] == np.inf and across[-1] == 6


def test_blocks_stop_where_rolling_resistance_has_them_stop(authume, prepared):
    """Strong resistance: on the bench; none, on a smooth ground: beyond all. And zones: the bench alone holds them."""
    held = authume.run(prepared, "held", seed=1, blocks=30, rolling=0.3)
    gone = authume.run(prepared, "gone", seed=1, blocks=30, rolling=0.0, spacing=0.4, e=0.4)
    assert np.isfinite(held).all() and np.median(held[:, 0]) < 30
    assert np.isinf(gone[:, 0]).mean() > 0.5
    rough = authume.run(prepared, "bench", seed=1, blocks=30, rolling=0.0, spacing=0.4, e=0.4, zones="yes",
                        red_rolling=2.0, red_e=0.01)
    assert ((rough[:, 0] > 15) & (rough[:, 0] < 40)).mean() > np.isfinite(gone[:, 0]).mean() + 0.2


def test_each_zone_has_its_own_coefficients(authume, prepared):
    authume.run(prepared, "zones", zones="yes", e=0.1, vegetated_e=0.2, red_e=0.3, rolling=0.1, vegetated_rolling=0.2,
                red_rolling=0.3, duration=0.01)
    log = (prepared / "zones" / "log.authume").read_text()
    for kind, value in ((2, 0.1), (3, 0.2), (4, 0.3)):
        *_, fixed, friction, rolling, _ = re.search(rf"^ +1 +{kind} +(.*)$", log, re.MULTILINE)[1].split()
        angle = np.degrees(np.arctan(value))
        assert (float(fixed), float(friction)) == (value, 30) and float(rolling) == pytest.approx(angle, rel=1e-3)


def test_profiles_sizes_and_heights_are_those_asked_for(authume, prepared):
    sizes = np.array([0.7, 0.8, 0.9])
    authume.run(prepared, "sizes", profile=2, sizes=sizes, lower=0.4, field_d=0.8, spacing=0.8, duration=0.01)
    start = np.loadtxt(prepared / "sizes" / "authume.start.dump", skiprows=9)
    assert start[:, 2] == pytest.approx(sizes, abs=1e-4)
    assert (np.abs(start[:, 4] - 26) <= 2).all() and (np.abs(start[:, 5] - 30.6) <= 0.3).all()


def test_without_the_data_it_says_so_in_a_line(tmp_path):
    told = subprocess.run([sys.executable, CASE / "authume.py", "fit", "-o", tmp_path / "new"], capture_output=True,
                          text=True, env={**ENVIRONMENT, "SLOPE_DATA": str(tmp_path)}, check=False)
    assert told.returncode == 0 and not told.stderr and told.stdout.count("\n") == 1
    assert "skipped" in told.stdout and "must be an existing file" in told.stdout and "SLOPE_DATA" in told.stdout
    assert not (tmp_path / "new").exists()


def test_the_rule_is_that_of_the_case(authume):
    """Fixed before the runs: eleven values, five seeds."""
    assert authume.ROLLING == pytest.approx(np.arange(0.10, 0.205, 0.01)) and len(authume.SEEDS) == 5
    deck = (CASE / "in.authume").read_text()
    for name, value in dict(d="0.80", e="0.1", friction="30", spacing="0.9", density="2600", blocks="200").items():
        assert f"\nvariable {name} index {value} " in re.sub(" +", " ", deck)
