"""A region that is deleted and defined again is another ground: the run ends, wherever memory puts the new one."""
import numpy
import pytest

from deck_helpers import run_deck, write_asc

DECK = """
units        si
atom_style   sphere
boundary     f f f
comm_modify  vel yes
region       box block -20 20 -20 20 -50 10
create_box   3 box
create_atoms 1 single -5 0 3.0
set          type * diameter 1.0 density 2500
pair_style   gran/restitution
pair_coeff   * * stiffness 1e8 1e8 restitution 0.1 friction 30
timestep     5e-4
neighbor     0.3 bin
neigh_modify every 1 delay 0 check yes
region       other block -12 12 -12 12 -60 20
region       {first}
{whole}
fix          wall all wall/gran/balls 3 1.0 surface {used} upper spacing 0.5
fix          weight all gravity 9.81 vector 0 0 -1
fix          move all nve/sphere
{between}
{unwhole}
region       part delete
region       {second}
{whole}
{then}
"""
# the region, and others with as many words that differ in one number
REGIONS = {
    "block": ("part block -10 0 -5 5 -50 0", ["part block 0 10 -5 5 -50 0", "part block -10 0 -5 5.5 -50 0"]),
    "sphere": ("part sphere -5 0 -25 25", ["part sphere 5 0 -25 25", "part sphere -5 0.1 -25 25"]),
    "cylinder": ("part cylinder z -5 0 8 -50 0", ["part cylinder z -4.9 0 8 -50 0", "part cylinder z -5 0 8.1 -50 0"]),
    "prism": ("part prism -10 0 -5 5 -50 0 1 0 0",
              ["part prism -10 0 -5 5 -50 0 -1 0 0", "part prism -10 0 -5 5 -50 0 1 0 0.5"]),
    "cone": ("part cone z -5 0 8 4 -50 0", ["part cone z -5 0 8 5 -50 0", "part cone z -5 0.1 8 4 -50 0"]),
    "terrain": ("part terrain a.asc depth 30", ["part terrain b.asc depth 30", "part terrain a.asc depth 30"]),
    "polygon": ("part polygon a.csv", ["part polygon b.csv", "part polygon a.csv"]),
}
CASES = [(kind, other) for kind, (_, others) in REGIONS.items() for other in others]


def deck(tmp_path, kind, second, then="run 10", between="", whole=False):
    heights = numpy.zeros((20, 20))
    write_asc(tmp_path / "a.asc", heights, -10.0, -10.0)
    heights[7, 5] = 1.0
    write_asc(tmp_path / "b.asc", heights, -10.0, -10.0)
    (tmp_path / "a.csv").write_text("-10,-5\n0,-5\n0,5\n-10,5\n")
    (tmp_path / "b.csv").write_text("-10,-5\n0,-5\n0,5\n-9,1\n-10,5\n")
    whole = whole or kind == "polygon"
    return DECK.format(first=REGIONS[kind][0], second=second, used="whole" if whole else "part", then=then,
                       between=between, unwhole="region whole delete" if whole else "",
                       whole="region whole intersect 2 other part" if whole else "")


@pytest.mark.parametrize("kind, second", CASES)
def test_another_region(tmp_path, kind, second):
    run_deck(deck(tmp_path, kind, second), tmp_path, expect_error="must not change after these balls are defined")


@pytest.mark.parametrize("kind, second", [case for case in CASES if case[0] not in ("terrain", "polygon")])
def test_a_part_of_another_one(tmp_path, kind, second):
    run_deck(deck(tmp_path, kind, second, whole=True), tmp_path,
             expect_error="must not change after these balls are defined")


@pytest.mark.parametrize("between, then", [("", "write_restart at.restart"), ("run 1", "run 10"),
                                           ("write_restart at.restart", "write_restart at.restart"),
                                           ("run 1", "variable n equal f_wall\nprint $n\nrun 1")])
def test_whenever_it_is_looked_for(tmp_path, between, then):
    kind = "block"
    run_deck(deck(tmp_path, kind, CASES[0][1], then, between), tmp_path,
             expect_error="must not change after these balls are defined")


@pytest.mark.parametrize("kind", REGIONS)
def test_the_same_ground_goes_on(tmp_path, kind):
    """What is not replaced is not found changed, run after run."""
    text = deck(tmp_path, kind, "part block 0 1 0 1 0 1", "run 1\nwrite_restart at.restart\nrun 1")
    lines = text.splitlines()
    cut = next(k for k, line in enumerate(lines) if line.endswith(" delete"))
    run_deck("\n".join(lines[:cut]) + "\nrun 1\nwrite_restart at.restart\nrun 1\n", tmp_path)
