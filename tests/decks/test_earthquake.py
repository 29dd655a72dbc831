"""inputs/21_earthquake with balls of 4 m: it stands, it is shaken, it loses its strength; and its record."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy
import pytest
import yaml

from deck_helpers import read_asc, run_deck

INPUTS = Path(__file__).resolve().parents[2] / "inputs"
CASE = INPUTS / "21_earthquake"
DECK = (CASE / "in.earthquake").read_text()


def shake(tmp_path, deck=DECK, **variables):
    """Run the deck; return its log, the deposit's summary, and the volume on the road (x 60 to 80 m), m3."""
    for name in ("terrain.asc", "motion.txt"):
        shutil.copy(CASE / name, tmp_path)
    log = run_deck(deck, tmp_path, vars={"d": 4, **variables})
    summary = yaml.safe_load((tmp_path / "earthquake.summary.yaml").read_text())
    thickness, header = read_asc(tmp_path / "earthquake.thickness.asc")
    x = header["xllcorner"] + header["cellsize"] * (numpy.arange(thickness.shape[1]) + 0.5)
    return log, summary, thickness[:, (x > 60) & (x < 80)].sum() * header["cellsize"] ** 2


def lost(log):
    """(time, travel of the centroid) at which strength is lost."""
    return [tuple(map(float, pair)) for pair in
            re.findall(r"^Strength is lost after (\S+) s, the centroid has moved (\S+) m", log, re.MULTILINE)]


@pytest.fixture(scope="module")
def strong(tmp_path_factory):
    return shake(tmp_path_factory.mktemp("strong"))


def test_it_stands_without_an_earthquake(tmp_path):
    log, summary, road = shake(tmp_path, peak=0)
    assert not lost(log) and "The body stands" in log and "WARNING" not in log
    assert summary["travel"]["centroid"] < 0.01         # from the end of stage 0
    assert road < 0.01 * summary["volume"]["released"]
    assert summary["at_rest"] and summary["stop"]["reason"] == "halted"
    assert 20 < summary["time"] < 25                    # when the record is over; stage 0 does not count


def test_300_gal_make_it_fail(strong):
    log, summary, road = strong
    (time, moved), = lost(log)
    assert 0 < time < 20 and 0.1 <= moved < 0.2
    assert road > 0.05 * summary["volume"]["released"]
    assert summary["travel"]["centroid"] > 10 and summary["at_rest"]
    assert abs(summary["volume"]["residual"]) <= 1e-9 * summary["volume"]["released"]
    assert "largest acceleration 3.0" in log            # m/s2, of the two horizontal axes; and a little of the third


def test_the_peak_scales_the_motion(tmp_path):
    log = shake(tmp_path, peak=600, duration=0.5)[0]
    found = float(re.search(r"largest acceleration (\S+);", log)[1])
    assert found == pytest.approx(2 * 3.03, rel=0.02)


def test_strength_that_is_not_lost_holds_the_body(tmp_path, strong):
    log, summary, road = shake(tmp_path, loss="never")
    assert not lost(log) and summary["at_rest"]
    assert 0.1 < summary["travel"]["centroid"] < 0.1 * strong[1]["travel"]["centroid"]
    assert road < 0.01 * summary["volume"]["released"]


def test_strength_lost_at_a_time(tmp_path):
    """Without a motion, too."""
    log, summary, road = shake(tmp_path, loss="time", loss_time=2, peak=0, shaking=2)
    (time, moved), = lost(log)
    assert time == pytest.approx(2, abs=0.2) and moved < 0.01
    assert road > 0.05 * summary["volume"]["released"] and summary["at_rest"]


def test_strength_lost_part_by_part(tmp_path):
    log, summary, _ = shake(tmp_path, loss="along")
    times, ways = zip(*lost(log))
    assert len(times) == 3 and list(times) == sorted(set(times))
    assert all(trigger <= way for trigger, way in zip((0.1, 0.2, 0.3), ways))
    assert "pair_coeff  1 2*4" in log and log.count("friction 0\n") == 3     # one type after the other
    assert summary["travel"]["centroid"] > 10


# --- its files ---

def test_the_terrain_and_the_road_are_those_of_the_embankment():
    for name in ("terrain.asc", "road.csv"):
        assert (CASE / name).is_symlink() and (CASE / name).samefile(INPUTS / "20_embankment" / name)


def make(folder, *options):
    shutil.copy(CASE / "make_record.py", folder)
    subprocess.run([sys.executable, "make_record.py", *options], cwd=folder, check=True)


def test_the_record_is_what_its_script_makes(tmp_path):
    make(tmp_path)
    made, kept = (numpy.loadtxt(folder / "motion.txt") for folder in (tmp_path, CASE))
    assert made == pytest.approx(kept, abs=2e-6)        # its last digit


def test_the_record_has_its_peak_and_ends_at_rest_where_it_began():
    t, a = numpy.split(numpy.loadtxt(CASE / "motion.txt"), [1], axis=1)
    t = t[:, 0]
    assert numpy.hypot(a[:, 0], a[:, 1]).max() == pytest.approx(3.0, abs=1e-5)
    steps = numpy.diff(t)[:, None]
    v = numpy.vstack([[0, 0, 0], numpy.cumsum((a[1:] + a[:-1]) / 2 * steps, axis=0)])
    way = numpy.sum(v[:-1] * steps + (2 * a[:-1] + a[1:]) * steps ** 2 / 6, axis=0)
    assert numpy.abs(v).max(axis=0).min() > 0.1 and numpy.abs(v[-1]).max() < 1e-5 and numpy.abs(way).max() < 1e-4


def test_one_direction_alone(tmp_path):
    make(tmp_path, "--axes", "x")
    a = numpy.loadtxt(tmp_path / "motion_x.txt")[:, 1:]
    assert numpy.abs(a[:, 0]).max() == pytest.approx(3.0, abs=1e-5) and not a[:, 1:].any()
