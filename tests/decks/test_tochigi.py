"""inputs/10_tochigi: where 177 rocks come to rest. The paper's curves are not known: bounds are those of physics."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml

from deck_helpers import run_deck

CASE = Path(__file__).resolve().parents[2] / "inputs" / "10_tochigi"
TOOL = CASE.parents[1] / "tools" / "slope"
DECK = (CASE / "in.tochigi").read_text()
QUICK = {"seed": 1, "kn": 1.19e7, "settle": 1.5}     # a longer time step
RUN, RISE, PIT = 1.68, 1.4604, 0.0424                # m: the slope; height of a rock on four balls of the floor


def rocks(path):
    """id, place of a dump."""
    rows = np.loadtxt(path, skiprows=9)
    return rows[:, 0], rows[:, 3:6]


def let_out(folder, deck=DECK, **variables):
    run_deck(deck, folder, vars={**QUICK, **variables})
    return rocks(folder / "tochigi.1.start.dump"), rocks(folder / "tochigi.1.rest.dump")


def arrived(place):
    """Share of the rocks below the toe."""
    return (place[:, 0] < 0.05).mean()


def is_symmetric(y):
    """The middle of the rocks is that of the slope, and as many are on the left as on the right."""
    chance = 4 / np.sqrt(len(y))
    return abs(y.mean()) < chance * y.std() and abs((y > 0).mean() - 0.5) < chance / 2


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tochigi")
    return folder, *let_out(folder)


def test_all_rocks_are_there(run):
    _, (start, at_start), (rest, at_rest) = run
    assert len(start) == 177 and set(rest) == set(start) == set(range(1, 178))
    # in the box, on the slope
    low = RUN - 0.5 * np.cos(np.radians(41))
    assert (at_start[:, 0] > low + 0.029).all() and (at_start[:, 0] < RUN - 0.029).all()
    assert (np.abs(at_start[:, 1]) < 0.4 - 0.029).all()
    assert (at_start[:, 2] > at_start[:, 0] * RISE / RUN).all()
    # on the floor or the slope, not in it
    ground = np.where(np.abs(at_rest[:, 1]) < 0.9, np.clip(at_rest[:, 0] * RISE / RUN, 0, RISE), 0)
    assert (at_rest[:, 2] > ground + 0.03).all()


def test_rocks_leave_the_box_and_stop_on_the_floor(run):
    _, (_, at_start), (_, at_rest) = run
    assert (at_start[:, 0].min() - at_rest[:, 0] > 0.5).all()
    assert arrived(at_rest) > 0.95
    assert -1.0 < np.median(at_rest[:, 0]) < -0.2
    assert at_rest[:, 0].min() > -5.5
    # the energy of the fall is lost on the way: not one gets as far as a block with a friction of 0.2 slides
    assert at_rest[:, 0].min() > RUN - RISE / 0.2
    assert np.median(at_rest[:, 2]) == pytest.approx(PIT, abs=0.002)


def test_left_and_right_are_the_same(run):
    _, _, (_, at_rest) = run
    assert is_symmetric(at_rest[:, 1])
    assert not is_symmetric(at_rest[:, 1] + 0.35)
    assert 0.2 < at_rest[:, 1].std() < 1.0 and np.abs(at_rest[:, 1]).max() < 4


@pytest.mark.long
def test_the_door_holds_the_rocks(tmp_path):
    """Without the door being taken away nothing arrives."""
    assert "\nunfix           door\n" in DECK
    deck = DECK.replace("\nunfix           door\n", "\n")
    (_, at_start), (_, at_rest) = let_out(tmp_path, deck, duration=0.5)
    assert arrived(at_rest) == 0
    assert np.abs(at_rest - at_start).max() < 0.05


@pytest.mark.long
def test_the_release_surface_is_what_lets_them_go(tmp_path):
    """A box with a rough floor, and rocks that do not roll: most stay."""
    line = "pair_coeff      1 2 stiffness ${kn} ${kn} restitution ${restitution} friction 0\n"
    assert line in DECK
    deck = DECK.replace(line, line.replace("friction 0", "friction 60 rolling 2"))
    _, (_, at_rest) = let_out(tmp_path, deck, rolling=2, friction=60, duration=1.5)
    assert arrived(at_rest) < 0.5


def test_travel_reads_the_dumps(run, monkeypatch):
    """The command of the README, on one seed: its median is that of the rocks."""
    folder, _, (_, at_rest) = run
    monkeypatch.chdir(folder)
    subprocess.run([TOOL, "travel", "tochigi.1.rest.dump", "--start", "tochigi.1.start.dump", "--axis", "x",
                    "--along", "-5", "3", "--across", "-4", "4"], check=True)
    about = yaml.safe_load(Path("travel/travel.yaml").read_text())
    assert about["along"]["all"]["p50"] == pytest.approx(np.median(at_rest[:, 0]), abs=1e-4)
    assert about["warnings"] == [] and about["each_run"][0]["missing"] == 0
