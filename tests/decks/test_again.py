"""A deck run again after `clear`, and after a restart, in one process: the same numbers, and no memory is lost.

tests/sanitize.sh runs the first of these under LeakSanitizer and valgrind, too, which see every lost byte.
"""

import os
import re
from statistics import median

import numpy
import pytest
from deck_helpers import ENVIRONMENT, run_deck, write_asc

# 200 balls on level ground, every style of the package
DEFINE = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region ground terrain ground.asc depth 2 headroom 6
region road polygon road.csv
region soil block 4 14 4 8 1 6 units box
create_box 3 ground
lattice sc 1.0
create_atoms 1 region soil
group soil type 1
set group soil diameter 0.9 density 2000
{contacts}
create_balls 3 1.0 2000 surface ground upper spacing 1.0 inside road
group frozen type 3
fix freeze frozen freeze
"""
CONTACTS = """
pair_style gran/restitution
pair_coeff 1 1 stiffness 1e6 1e6 restitution 0.5 friction 30 rolling 0.1
pair_coeff 1 2*3 stiffness 1e6 1e6 restitution 0.5 friction 30
fix wall {group} wall/gran/balls 2 1.0 surface ground upper spacing 1.0 outside road
neigh_modify every 1 delay 0 check yes
timestep 1e-3
"""
RUN = """
fix freeze frozen freeze
fix move soil nve/sphere
fix weight soil gravity 9.81 vector 0.2 0 -1
fix deposit soil deposit/grid 10 50 cell 0.25 terrain ground output out
thermo_style custom step atoms ke
run 50
"""
REGIONS = "\n".join(line for line in DEFINE.splitlines() if line.startswith("region"))
START = DEFINE.format(contacts=CONTACTS.format(group="soil") + "delete_balls soil overlap 0.0")
GO_ON = ("read_restart at.restart\n" + REGIONS + "\ncomm_modify vel yes\n" + CONTACTS.format(group="soil"))


@pytest.fixture
def site(tmp_path):
    write_asc(tmp_path / "ground.asc", numpy.zeros((64, 64)), cell=0.25)
    (tmp_path / "road.csv").write_text("12,0\n16,0\n16,16\n12,16\n")
    return tmp_path


def energies(log):
    """Lines of thermodynamic output: step, atoms, kinetic energy."""
    return re.findall(r"^ *(\d+) +(\d+) +([-+.0-9e]+) *$", log, re.MULTILINE)


@pytest.mark.parametrize("np_", [1, 2])
def test_a_deck_again_gives_the_same_numbers(site, np_):
    log = run_deck(START + RUN + "write_restart at.restart\nclear\n" + START + RUN + "clear\n" + GO_ON + RUN, site,
                   np=np_, timeout=1200)     # s, for valgrind
    first, again, after = numpy.split(numpy.array(energies(log)), [2, 4])
    assert (first == again).all() and first[1, 0] == "50" and float(first[1, 2]) > 0
    assert (after[0] == first[1]).all() and after[1, 0] == "100"


@pytest.mark.parametrize("step", [180, 300])
def test_a_run_of_no_steps_changes_nothing(site, step):
    """Balls slide alone when it comes: at set-up their forces are estimates; those of the step before must be kept."""
    start = (START.replace("friction 30", "friction 10").replace("lattice sc 1.0", "lattice sc 1.6")
             + "velocity soil set 3 0 -2\n")
    for out, runs in (("whole", "run 400"), ("cut", f"run {step}\nrun 0\nrun {400 - step}")):
        run_deck(f"{start}{RUN.replace('run 50', runs)}\nwrite_dump all custom {out} id x y z vx vy vz omegax omegay "
                 "omegaz modify sort id format float %.17g\n", site)
    assert (site / "whole").read_text() == (site / "cut").read_text()


@pytest.mark.parametrize("np_", [1, 3])
def test_a_step_number_that_recurs_brings_no_old_forces(site, np_):
    """The second run ends at the step at which the first one has ended: the third goes on from its own forces."""
    start = START.replace("lattice sc 1.0", "lattice sc 1.6") + "velocity soil set 3 0 -2\n"
    found = []
    for out, runs in (("whole", "run 250"), ("cut", "run 200\nrun 50")):
        run_deck(start + RUN.replace("run 50", f"run 200\nreset_timestep 0\n{runs}") +
                 f"\nwrite_dump all custom {out} id x y z vx vy vz modify sort id format float %.17g\n", site, np=np_)
        found.append(numpy.loadtxt(site / out, skiprows=9)[:, 1:])
    assert abs(found[0] - found[1]).max() < 1e-9


@pytest.mark.skipif("ASAN_OPTIONS" in os.environ, reason="a sanitizer keeps what is freed")
def test_no_memory_is_lost(site, monkeypatch):
    """What 50 runs with clear add to the process. A lost raster would be 32 kB each time."""
    # glibc gives back what is freed, so that the size of the process is what is in use
    for name, value in {"MALLOC_MMAP_THRESHOLD_": "16384", "MALLOC_TRIM_THRESHOLD_": "0",
                        "MALLOC_TOP_PAD_": "0"}.items():
        monkeypatch.setitem(ENVIRONMENT, name, value)
    deck = "variable again loop 60\nlabel again\n" + START + RUN.replace("run 50", "run 2")
    deck += 'clear\nshell "grep VmRSS /proc/$PPID/status >> memory.txt"\nnext again\njump SELF again\n'
    run_deck(deck, site)
    memory = [int(line.split()[1]) for line in (site / "memory.txt").read_text().splitlines()]
    assert len(memory) == 60
    # the median of ten: where the heap ends varies by up to 60 kB from clear to clear
    assert median(memory[-10:]) - median(memory[10:20]) < 100, f"kB after each clear: {memory}"


# --- balls that others than fix nve/sphere move: a force that is on them may change nothing ---

# between a frozen ball and one that something else moves, a third
PRESSED = """
units si
atom_style sphere
atom_modify map array
boundary f f f
newton {newton}
comm_modify vel yes
{begin}
pair_style gran/restitution
pair_coeff * * stiffness 1e8 1e8 restitution 0.1 friction 30 rolling 0.1
timestep 9e-4
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
fix hold held freeze
fix move soil nve/sphere
fix weight all gravity 9.81 vector 0 0 -1
{guide}
{first}
run 60 upto
"""
BEGIN = """
region box block -5 5 -5 5 -5 10
create_box 3 box
create_atoms 2 single 0 0 0
create_atoms 1 single 0 0 1.0
create_atoms 3 single 0.2 0 1.975
set type * diameter 1.0 density 2500
group held type 2
group soil type 1
group plate type 3
velocity all set 0 0 0
velocity plate set 0 0 -0.5
set type 3 omega 0 3 0
"""
AGAIN = "read_restart at.restart\ncomm_modify vel yes\n"
GUIDES = {
    "linear": "fix guide plate move linear 0.1 0 -0.5", "one component": "fix guide plate move linear NULL NULL -0.5",
    "wiggle": "fix guide plate move wiggle 0.01 0 -0.03 0.1",
    "rotate": "fix guide plate move rotate 0 -3 1.975 0 1 0 3",
    "variable": "variable z equal -0.1*step*dt\nvariable v equal -0.1\n"
                "fix guide plate move variable NULL NULL v_z NULL NULL v_v",
    "noforce": "fix guide plate nve/noforce",
    "nothing": ""}


def last(site, **settings):
    dump = ("\nwrite_dump all custom end.dump id x y z vx vy vz omegax omegay omegaz"
            " modify sort id format float %.17g\n")
    run_deck(PRESSED.format(**{"newton": "on", "begin": BEGIN, "first": "", **settings}) + dump, site)
    return (site / "end.dump").read_text()


@pytest.mark.parametrize("newton", ["on", "off"])
@pytest.mark.parametrize("guide", GUIDES)
def test_pieces_of_a_run_with_balls_that_are_guided(tmp_path, guide, newton):
    settings = {"newton": newton, "guide": GUIDES[guide]}
    whole = last(tmp_path, **settings)
    assert float(whole.splitlines()[-1].split()[3]) != 1.975 or guide == "nothing"
    for until in (10, 20, 30, 37):
        assert last(tmp_path, **settings, first=f"run {until}") == whole
    assert last(tmp_path, **settings, first="run 20\nrun 5\nwrite_restart at.restart") == whole
    if guide != "variable":    # whose variable holds the place from the first step on
        assert last(tmp_path, **settings, begin=AGAIN, first="run 5") == whole


def test_velocities_that_are_changed_between_runs_count(tmp_path):
    """Two balls in a hard-damped impact are stopped between runs: what is left is the force of the spring."""
    log = run_deck("""
units si
atom_style sphere
atom_modify map array
boundary f f f
comm_modify vel yes
region box block -1 3 -1 1 -1 1 units box
create_box 1 box
create_atoms 1 single 0 0 0 units box
create_atoms 1 single 0.99 0 0 units box
set group all diameter 1.0 density 2000
velocity all set 0.5 0 0
group second id 2
velocity second set -0.5 0 0
pair_style gran/restitution
pair_coeff 1 1 stiffness 1e7 1e7 restitution 0.1
timestep 1e-5
fix move all nve/sphere
variable f equal -fx[1]
variable spring equal 1e7*(1-x[2]+x[1])
thermo_style custom step v_f v_spring
run 200
velocity all set 0 0 0
run 1
""", tmp_path)
    rows = re.findall(r"^ *(\d+) +([-+.0-9e]+) +([-+.0-9e]+) *$", log, re.MULTILINE)
    moving, stopped = numpy.array(rows, dtype=float)[1:3]
    assert moving[0] == stopped[0] == 200
    assert moving[1] > 1.2 * moving[2]
    assert stopped[1] == pytest.approx(stopped[2], rel=0.05)
