"""Balls that come or change in a run, a step that changes, empty groups: what is wrong with them is told, once."""
import math
import re

import numpy
import pytest

from deck_helpers import run_deck, write_asc

STEP, STIFFNESS = 5e-4, 1e8
DECK = """
units        si
atom_style   sphere {varying}
atom_modify  map array
boundary     f f f
comm_modify  vel yes
region       box block -5 5 -5 5 -2 10
create_box   3 box
region       body block -2.1 1.9 -2.1 1.9 0.9 1.9
lattice      sc 1.0
{create}
group        soil type 1
pair_style   gran/restitution
pair_coeff   {types} stiffness 1e8 1e8 restitution 0.5 friction 30
neighbor     0.2 bin
neigh_modify every 1 delay 0 check yes
timestep     5e-4
region       ground block -5 5 -5 5 -2 0
fix          wall {group} wall/gran/balls 3 1.0 surface ground upper spacing 0.9
fix          weight all gravity 9.81 vector 0 0 -1
fix          move all nve/sphere
region       above block -3 3 -3 3 6 9
thermo_modify lost ignore
{run}
"""
SIZE = "\nset type 1 diameter 1.0 density 2500"
CREATE = "create_atoms 1 region body" + SIZE
# a ball of a molecule file: of its own size and mass, or of LAMMPS'
MOLECULES = {"small": "Diameters\n\n1 0.2\n\nMasses\n\n1 10.0\n", "plain": ""}


def balls(run, tmp_path, np=1, create=CREATE, types="* *", group="soil", varying="", expect_error=None):
    for name, text in MOLECULES.items():
        (tmp_path / f"{name}.mol").write_text("# a ball\n\n1 atoms\n\nCoords\n\n1 0 0 0\n\nTypes\n\n1 1\n\n" + text)
    return run_deck(DECK.format(create=create, types=types, group=group, varying=varying, run=run), tmp_path, np=np,
                    expect_error=expect_error)


def told(log, what):
    return [line for line in log.splitlines() if line.startswith("WARNING") and what in line]


def mass(diameter, density=2500.0):
    return density * math.pi * diameter ** 3 / 6


def says_ratio(line, lightest, step=STEP):
    return f" is {step / (0.25 * math.sqrt(lightest / STIFFNESS)):.3g} times the rule's" in line


POUR = "fix in soil pour 20 1 4321 vol 0.3 20 region above "
DEPOSIT = "fix in soil deposit 20 0 20 4321 region above near 1.1 "


@pytest.mark.parametrize("np", [1, 2])
@pytest.mark.parametrize("fix, lightest, narrow", [
    (POUR + "diam one 0.2 dens 2500 2500", mass(0.2), 0.2), (POUR + "diam one 1.0 dens 1 1", mass(1.0, 1.0), None),
    (POUR + "diam range 0.3 1.0 dens 2000 3000", mass(0.3, 2000), 0.3),
    (POUR + "diam poly 2 1.0 0.5 0.25 0.5 dens 2500 2500", mass(0.25), 0.25),
    (POUR + "diam one 1.0 dens 2500 2500", None, None), (POUR + "diam one 1.2 dens 2500 2500", None, None),
    (DEPOSIT.replace("deposit 20 0", "deposit 20 1"), mass(1.0, 1.0), None),
    ("molecule small small.mol\n" + DEPOSIT + "mol small", 10.0, 0.2),
    ("molecule plain plain.mol\n" + DEPOSIT + "mol plain", mass(1.0, 1.0), None)])
def test_balls_that_are_to_come(tmp_path, fix, lightest, narrow, np):
    """Known before the first step, from what the fix is told."""
    log = balls(fix + "\nrun 400", tmp_path, np=np)
    before = log[:log.index("\nStep ") if "\nStep " in log else log.index("   Step ")]
    steps = told(before, "tested to hold the restitution")
    assert len(steps) == (lightest is not None) and all(says_ratio(line, lightest) for line in steps)
    assert len(told(before, "may pass between these")) == (narrow is not None)
    assert all(f"balls of diameter {narrow} may" in line for line in told(before, "may pass between these"))
    for text in ("tested to hold the restitution", "may pass between these"):
        assert told(log, text) == told(before, text)


@pytest.mark.parametrize("np", [1, 2])
def test_balls_that_shrink(tmp_path, np):
    """To a fifth; every 200 steps they are looked at. The step is too long below 0.514 of the diameter."""
    shrink = "variable d equal ramp(1.0,0.2)\nfix shrink soil adapt 10 atom diameter v_d\nrun 1000\n"
    log = balls("run 100\n" + shrink, tmp_path, np=np, varying="1")
    line, = told(log, "tested to hold the restitution")
    assert any(says_ratio(line, mass(1.0 - 0.8 * at / 1000)) for at in range(600, 820, 10))
    assert len(told(log, "may pass between these")) == 1
    log = balls("run 100\n" + shrink.replace("0.2", "0.9"), tmp_path, np=np, varying="1")
    assert not told(log, "times the rule's")


@pytest.mark.parametrize("most, told_of", [("1.8e-3", True), ("8e-4", False)])
def test_a_step_that_grows(tmp_path, most, told_of):
    log = balls(f"fix grow soil dt/reset 10 1e-6 {most} 0.01 units box\nrun 300", tmp_path)
    lines = told(log, "tested to hold the restitution")
    assert len(lines) == told_of and all(says_ratio(line, mass(1.0), 1.8e-3) for line in lines)


def test_masses_of_balls_that_come(tmp_path):
    log = balls(POUR + "diam one 1.0 dens 1 1\nrun 400", tmp_path)
    assert len(told(log, "are tested up to a ratio of 1000, got 2500")) == 1


def test_each_run_tells_again(tmp_path):
    log = balls(POUR + "diam one 0.2 dens 2500 2500\nrun 1\nrun 1", tmp_path)
    assert len(told(log, "tested to hold the restitution")) == 2


# --- a group has the balls that are there when it is defined ---

LATER = "group early type 1\n" + CREATE
EMPTY = "the group should have balls, got none of the 16 that have coefficients with type 3"


@pytest.mark.parametrize("np", [1, 2])
def test_a_wall_on_a_group_that_is_empty(tmp_path, np):
    log = balls("run 10\nrun 10", tmp_path, np=np, create=LATER, group="early")
    assert len(told(log, "Fix wall/gran/balls wall: " + EMPTY)) == 1


def write_files(folder):
    write_asc(folder / "flat.asc", numpy.zeros((10, 10)), -5.0, -5.0)
    (folder / "quake.txt").write_text("0 0 0 0\n1 1 0 0\n")
    (folder / "line.csv").write_text("-3 0\n3 0\n")


FLOOR = "unfix wall\nfix floor early wall/gran/mesh 3 terrain flat.asc\n"
LINE = ("region land terrain flat.asc depth 2 headroom 10\n"
        "fix all all deposit/grid 10 0 cell 1 terrain land output out\n"
        "fix line early control/line line.csv output line")


@pytest.mark.parametrize("fix, name", [
    (FLOOR, "Fix wall/gran/mesh floor: " + EMPTY),
    ("fix shake early ground/motion quake.txt", "Fix ground/motion shake: the group should have balls, got none of 16"),
    (LINE, "Fix control/line line: the group should have balls, got none of 16")])
def test_other_fixes_on_a_group_that_is_empty(tmp_path, fix, name):
    write_files(tmp_path)
    log = balls(fix + "\nrun 10", tmp_path, create=LATER)
    assert len(told(log, name)) == 1
    assert not told(balls(fix.replace("early", "soil") + "\nrun 10", tmp_path), "the group should have balls")


@pytest.mark.parametrize("run, settings", [
    ("run 10", {"create": "group early type 1"}),
    ("run 10", {"create": "group early type 1\ncreate_atoms 2 region body\nset type 2 diameter 1 density 2500",
                "types": "1 1*3"}),
    (POUR.replace("soil", "early") + "diam one 1.0 dens 2500 2500\nrun 10", {"create": LATER}),
    ("group early type 1\nrun 10", {"create": LATER}),
    ("fix hold soil freeze\nrun 10", {"create": LATER}), ("run 0", {"create": CREATE + "\ngroup early type 1"})],
    ids=["before the balls", "others", "pour", "defined again", "frozen", "full"])
def test_groups_that_are_rightly_empty_or_not(tmp_path, run, settings):
    balls_there = {"types": "* *", **settings}
    log = balls("pair_coeff 2 2 stiffness 1e8 1e8 restitution 0.5 friction 30\n" + run, tmp_path, group="early",
                **balls_there)
    assert not told(log, "the group should have balls")


@pytest.mark.parametrize("fix", ["wall/gran/balls 3 1.0 surface ground upper spacing 0.9", "ground/motion quake.txt",
                                 "wall/gran/mesh 3 terrain flat.asc",
                                 "deposit/grid 10 0 cell 1 terrain land output out"])
def test_a_group_that_changes_is_refused(tmp_path, fix):
    write_files(tmp_path)
    run = (f"region land terrain flat.asc depth 2 headroom 10\nvariable low atom z<1.2\n"
           f"group low dynamic soil every 10 var low\nfix one low {fix}\nrun 10")
    balls(run, tmp_path, expect_error="does not allow use with a dynamic group")


# --- lists of neighbors that are not made again ---

@pytest.mark.parametrize("once", ["yes", "no"])
def test_lists_that_are_made_once(tmp_path, once):
    """A ball falls 2 m: nothing that it touches then was near when the list was made."""
    log = balls(f"neigh_modify once {once}\nrun 10", tmp_path, create="create_atoms 1 single 0 0 3" + SIZE)
    assert len(told(log, "neigh_modify once should be no, got yes")) == (once == "yes")


@pytest.mark.parametrize("group, without", [("soil", 0), ("few", 1), ("none", 1)])
def test_lists_without_some_balls(tmp_path, group, without):
    """Of balls that neigh_modify include leaves out lists are never made again."""
    run = (f"group few id 2\ngroup none empty\natom_modify first {group}\nneigh_modify include {group}\nrun 0")
    log = balls(run, tmp_path, create="create_atoms 1 single 0 0 3" + SIZE)
    lines = told(log, "neigh_modify include must name a group of all balls that move")
    assert len(lines) == (without > 0)
    assert all(f"got {group}, without {without} of them" in line for line in lines)


def test_two_sub_styles(tmp_path):
    hybrid = ("pair_style hybrid gran/restitution scheme exact gran/restitution scheme plain\n"
              "pair_coeff * * gran/restitution 1 stiffness 1e8 1e8 restitution 0.1 friction 30\n"
              "pair_coeff 2 2 gran/restitution 2 stiffness 1e8 1e8 restitution 0.5 friction 30\n")
    for wall in ("", "unfix wall\n"):
        balls(wall + hybrid + "run 10", tmp_path,
              expect_error="needs one pair_style gran/restitution, got 2 in pair_style hybrid")


def test_a_ball_that_touches_in_its_first_step(tmp_path):
    """Its dashpots act on the velocity that it comes with: no force has changed that yet."""
    log = balls("molecule small small.mol\nregion spot block -1e-4 1e-4 -1e-4 1e-4 1.59998 1.59999\n"
                "fix in soil deposit 1 0 10 4321 region spot mol small vz -1 -1\n"
                "thermo_style custom step atoms ke\nthermo 1\nrun 12", tmp_path)
    energies = [float(row[1]) for row in re.findall(r"^ +\d+ +(17) +(\S+) *$", log, re.MULTILINE)]
    assert 1.0 < energies[0] < 0.5 * 10.0 * 1.0 ** 2
