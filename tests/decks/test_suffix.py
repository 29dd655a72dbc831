"""Fix nve/sphere/slope and fix gravity/slope: stock LAMMPS' results, to the bit."""

import os
import re

import numpy
import pytest
from deck_helpers import collapse_deck, run_deck, write_collapse

STEPS = 300


def collapse(tmp_path, name, text, np=1):
    """All numbers of the dump, and the energies of the log."""
    folder = tmp_path / name
    folder.mkdir()
    write_collapse(folder, balls=401, mixed=True)      # not a multiple of four
    log = run_deck(text, folder, np=np)
    rows = [[float(word) for word in line.split()] for line in (folder / "out.dump").read_text().splitlines()
            if len(line.split()) == 16 and not line.startswith("ITEM")]
    energies = [float(words[2]) for words in (line.split() for line in log.splitlines())
                if len(words) == 3 and words[0].isdigit() and words[0] == words[1].split(".")[0]]
    return numpy.array(rows), energies, log


def deck(begin, commands="", move="fix move soil nve/sphere", weight="fix weight soil gravity 9.80665 vector 0 0 -1",
         **settings):
    """The collapse; the first balls may be held, others weightless, so that fours are of several groups."""
    text = collapse_deck(f"fix_modify weight energy yes\nthermo_style custom step step f_weight\n{commands}\n"
                         f"run {STEPS}", every=50, **settings)
    assert "fix move soil nve/sphere\n" in text
    text = text.replace("fix move soil nve/sphere\n", move + "\n")
    text = text.replace("fix weight soil gravity 9.80665 vector 0 0 -1\n", weight + "\n")
    return begin + "\n" + text


CASES = {
    "all": {},
    "two ranks": dict(np=2),
    "another group": dict(move="group part id 1:200 207 211:230\nfix move part nve/sphere"),
    "some weightless": dict(weight="group heavy id 1:90 95:390\nfix weight heavy gravity 9.80665 vector 0.3 -0.1 -1"),
    "gravity by variable": dict(weight="variable g equal 9.8*(1+0.1*sin(step))\n"
                                       "fix weight soil gravity v_g vector 0 0 -1"),
    "gravity turned off": dict(commands="fix_modify weight energy no\nunfix weight\n"
                                        "fix weight soil gravity 0 vector 0 0 -1"),
    "first group": dict(sort="first soil"),
}


@pytest.mark.parametrize("case", CASES)
def test_same_as_stock(case, tmp_path):
    settings = dict(CASES[case])
    np = settings.pop("np", 1)
    stock, stock_energy, _ = collapse(tmp_path, "stock", deck("", **settings), np)
    ours, our_energy, log = collapse(tmp_path, "ours", deck("suffix slope", **settings), np)
    assert len(stock) == 401 * (STEPS // 50 + 1) and numpy.abs(stock[-401:, 1:]).max() > 0
    if "SLOPE_PLUGIN" in os.environ:    # compiled with options of its own: sums may round differently
        assert numpy.allclose(ours, stock, rtol=1e-6, atol=1e-6)
        assert numpy.allclose(our_energy, stock_energy, rtol=1e-9)
    else:
        assert numpy.array_equal(ours, stock)
        assert our_energy == stock_energy
    assert len(set(stock_energy)) == (1 if case == "gravity turned off" else 2)


def test_suffix_chooses_the_variants(tmp_path):
    write_collapse(tmp_path, balls=50)
    log = run_deck(deck("suffix slope", "info out log fixes"), tmp_path)
    for style in ("nve/sphere/slope", "gravity/slope"):
        assert re.search(rf"style = {style},", log), style
