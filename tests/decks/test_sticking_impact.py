"""Sticking impacts: in.sticking_impact gives the law of continuous time, in whatever way the same impacts are run."""
import shutil
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import run_deck

from slope_tools.validation.verification import sticking_impact
from slope_tools.validation.verification.claims import Result

TOP = Path(__file__).resolve().parents[2]
CASE = TOP / "inputs" / "06_oblique_impact"
DECK = (CASE / "in.sticking_impact").read_text()
ROUGH = dict(laws=36, rolling=0.1, spin=-0.5)
CELL, WALL = 0.12, "wall.xyz"


def run(folder, deck=DECK, np=1, **values):
    """The Result of a run."""
    folder.mkdir(exist_ok=True)
    shutil.copy(CASE / "sticking_laws.in", folder)
    (folder / "log.lammps").write_text(run_deck(deck, folder, np=np, vars=values))
    return Result(folder)


def swapped(*swaps):
    deck = DECK
    for old, new in swaps:
        assert old in deck, old
        deck = deck.replace(old, new)
    return deck


@pytest.mark.parametrize("partner", sticking_impact.PARTNERS)
def test_continuous_law(tmp_path, partner):
    """Spinning and rolling; what does not is among the quick claims."""
    errors = sticking_impact.Errors(run(tmp_path, partner=partner, **ROUGH))
    assert errors.together == 0
    beta, beta_each, spin, spin_each, e = sticking_impact.ROLLING_BOUNDS
    for name, mean, each in (("beta", beta, beta_each), ("spin", spin, spin_each), ("partner_spin", spin, spin_each)):
        assert errors.mean[name].max() <= mean and errors.largest[name].max() <= each, name
    assert errors.largest["restitution"].max() <= e
    assert errors.gain.max() <= 0.002


def test_the_law_is_right_in_small_steps(tmp_path):
    """The control of the solution in continuous time: scheme plain at a hundredth, and not at the rule's step."""
    def error(name, **values):
        result = run(tmp_path / name, scheme="plain", partner="heavy", **values, **ROUGH)
        largest = sticking_impact.Errors(result).largest
        return max(largest[name].max() for name in ("beta", "spin", "partner_spin"))

    assert error("fine", part=0.01) < 0.005
    assert error("coarse") > 0.1


# --- the same impacts in other ways ---

# the partners in front, so that each is the other's partner in the lists
ROLES = [("group           partner id > 0", "group           ball id > 0"),
         ("group           ball subtract all partner", "group           partner subtract all ball")]
PIECES = [("run             ${steps}", "run 4\nrun 5\nrun 3\nrun $(v_steps-12)")]


def numbers(result):
    _, got = sticking_impact.observed(result)
    return np.stack([got[name] for name in ("beta", "spin", "partner_spin", "restitution")])


@pytest.mark.parametrize("partner", sticking_impact.PARTNERS)
@pytest.mark.parametrize("way", ["roles", "pieces", "ranks", "each a step later"])
def test_in_other_ways(tmp_path, partner, way):
    deck = {"roles": swapped(*ROLES), "pieces": swapped(*PIECES),
            "each a step later": swapped(("dt*(2+", "dt*(3+"))}.get(way, DECK)
    one = numbers(run(tmp_path / "one", partner=partner, **ROUGH))
    other = numbers(run(tmp_path / "other", deck, np=2 if way == "ranks" else 1, partner=partner, **ROUGH))
    off = np.abs(one - other)
    if way == "each a step later":      # rounded otherwise: what is about to slip may do so a step later
        assert off.max() < 0.02 and (off < 1e-5).mean() > 0.995
    else:
        assert off.max() < 1e-5
    assert np.ptp(one[0]) > 0.5


def test_balls_of_a_wall(tmp_path):
    """A fixed partner is a frozen ball or one of fix wall/gran/balls: the same to rounding."""
    places = [f"{CELL * i:.17g} {CELL * j:.17g} 0" for j in range(7) for i in range(20)]
    folder = tmp_path / "wall"
    folder.mkdir()
    (folder / WALL).write_text("\n".join(places) + "\n")
    deck = swapped(("create_box      ${laws} box", "create_box 2 box"),
                   ('"fix hold partner freeze"', f'"fix hold ball wall/gran/balls 2 $d file {WALL}" '
                    '"delete_atoms group partner compress no"'),
                   ("dump            all all", "dump all ball"))
    values = dict(friction=45, e=0.7, rolling=0.1, spin=-0.5)
    balls = run(folder, deck, **values).frames("sticking_impact.dump")
    frozen = run(tmp_path / "frozen", **values).frames("sticking_impact.dump")
    for name in ("vx", "vy", "vz", "omegax", "omegay", "omegaz"):
        size = np.abs(frozen[name]).max()
        assert np.abs(frozen[name][:, 140:] - balls[name]).max() < 1e-6 * size
        assert np.abs(balls[name][1] - balls[name][0]).max() > 1e-3 * size
