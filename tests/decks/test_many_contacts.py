"""A ball with hundreds of contacts moves to another rank: what it brings is more than LAMMPS has room for unasked.

Expected: the energy is that of one rank. Without the room the heap is overwritten, and the program aborts, or not.
"""

import math

import pytest
from deck_helpers import run_deck

CONTACTS = 320          # with balls, and as many with the fixed balls of a wall
SHELL = 2 * CONTACTS
RADIUS = 4.0

NEW = """
boundary f f f
read_data balls.data
pair_style gran/restitution
pair_coeff * * stiffness 1e7 5e6 restitution 0.5 friction 30 rolling 0.05
"""
DECK = """
units si
atom_style sphere
atom_modify map array
newton {newton}
processors {grid}
{begin}
comm_modify vel yes
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
{wall}
fix move all nve/sphere
timestep 1e-4
thermo_style custom step atoms ke
thermo 10
{run}
"""


def write_shell(folder):
    """balls.data and places.txt: a ball, and around it others, every second one fixed, nearly evenly spread.

    None touches another of them. Returns their diameter."""
    turn = math.pi * (3 - 5 ** 0.5)
    up = [1 - (2 * k + 1) / SHELL for k in range(SHELL)]
    points = [(math.sqrt(1 - z * z) * math.cos(turn * k), math.sqrt(1 - z * z) * math.sin(turn * k), z)
              for k, z in enumerate(up)]
    apart = min(math.dist(points[k], other) for k in range(SHELL) for other in points[:k])
    diameter = 0.999 * apart * RADIUS / (1 - 0.4995 * apart)
    reach = RADIUS + 0.5 * diameter - 0.0005
    places = [" ".join(f"{middle + reach * c:.12g}" for middle, c in zip((0.3, 0.1, 0.0), p)) for p in points]
    lines = ["balls", "", f"{CONTACTS + 1} atoms", "2 atom types", ""]
    lines += [*(f"-8 8 {axis}lo {axis}hi" for axis in "xyz"), "", "Atoms # sphere", ""]
    lines += [f"1 1 {2 * RADIUS} 2500 0.3 0.1 0.0"]
    lines += [f"{k + 2} 1 {diameter:.12g} 2500 {place}" for k, place in enumerate(places[::2])]
    (folder / "balls.data").write_text("\n".join(lines) + "\n")
    (folder / "places.txt").write_text("\n".join(places[1::2]) + "\n")
    return f"{diameter:.12g}"


def energies(log):
    rows = [line.split() for line in log.splitlines()]
    return {int(row[0]): float(row[2]) for row in rows
            if len(row) > 2 and row[0].isdigit() and row[1] == str(CONTACTS + 1)}


@pytest.fixture(scope="module", params=(("on", False), ("off", False), ("on", True)),
                ids=("newton on", "newton off", "wall"))
def cut(request, tmp_path_factory):
    """A deck, its folder with restart files of step 20, and the energies of one rank."""
    folder = tmp_path_factory.mktemp("shell")
    newton, wall = request.param
    diameter = write_shell(folder)
    deck = {"newton": newton, "grid": "* 1 1",
            "wall": f"fix wall all wall/gran/balls 2 {diameter} file places.txt" if wall else ""}
    log = run_deck(DECK.format(begin=NEW, **deck, run="compute touch all contact/atom\n"
                               "compute most all reduce max c_touch\nthermo_style custom step atoms ke c_most\nrun 20\n"
                               "write_restart whole.restart\nwrite_restart part.%.restart\n"
                               "thermo_style custom step atoms ke\nrun 20"), folder)
    assert [row.split()[3:] for row in log.splitlines() if row.split()[:2] == ["20", str(CONTACTS + 1)]][0] == [
        str(CONTACTS)]
    found = energies(log)
    assert found[40] > 2 * found[20] > 0
    return deck, folder, found


@pytest.mark.parametrize("file", ("whole.restart", "part.%.restart"))
@pytest.mark.parametrize("balance", ("", "balance 0.9 x 0.55"))      # ball 1 is at 0.52
def test_after_a_restart(cut, file, balance):
    deck, folder, expected = cut
    text = DECK.format(begin=f"read_restart {file}", **deck, run=f"{balance}\nrun 20")
    found = energies(run_deck(text, folder, np=2))
    assert {step: found[step] for step in (20, 30, 40)} == pytest.approx({s: expected[s] for s in (20, 30, 40)})


def test_across_two_borders_at_once(cut):
    """From the corner of one rank of four to that of the opposite one, and what touches it comes along."""
    deck, folder, _ = cut
    if deck["wall"]:
        pytest.skip("a wall stays where it is")
    run = ("displace_atoms all move -0.29 -0.09 0 units box\nvelocity all set -10 -10 0\n"
           "thermo_style custom step atoms ke\nrun 200")
    found = [energies(run_deck(DECK.format(**{**deck, "grid": grid, "begin": NEW, "run": run}), folder, np=ranks))
             for ranks, grid in ((1, "* * *"), (4, "2 2 1"))]
    assert found[1] == pytest.approx(found[0]) and max(found[0]) == 200
