"""A restart file is not continued with another ground, mesh, line, motion or raster: what each keyword guards."""
import re
from pathlib import Path

import numpy
import pytest
from deck_helpers import run_deck, write_asc
from mesh_helpers import box, stl_bytes

DECK = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
{begin}
region ground terrain ground.asc depth 2 headroom 6
region road polygon road.csv
pair_style gran/restitution
pair_coeff * * stiffness 1e6 1e6 restitution 0.5 friction 30
group soil type 1
fix balls soil wall/gran/balls 2 1.0 surface ground upper spacing 1.0 origin 0 0 angle 0 sink 0.2 outside road
fix loose soil wall/gran/balls 2 1.0 surface ground upper spacing 0.9 sink 0.3 pattern scattered 3
region cap sphere 8 8 3 4
region body intersect 2 ground cap
fix slip soil wall/gran/balls 2 1.0 surface body lower spacing 0.5 sink 0.5
fix places soil wall/gran/balls 2 1.0 file places.txt
fix house soil wall/gran/mesh 3 house.stl scale 1 move 0 0 0
fix floor soil wall/gran/mesh 3 terrain floor.asc
fix move soil nve/sphere
fix weight soil gravity 9.81 vector 0 0 -1
fix quake soil ground/motion motion.txt scale 1 start 0
fix dep soil deposit/grid 10 0 cell 1 terrain ground output out bulk 1.5 extent 0 16 0 16
fix line soil control/line line.csv deposit dep output out lower 0
timestep 1e-3
"""
NEW = """region all block 0 16 0 16 -2 6
create_box 3 all
region soil block 6 7.5 6 7.5 2 4
lattice sc 1.0
create_atoms 1 region soil
set group all diameter 0.9 density 2000"""
CHANGES = [("2 1.0 surface", "2 0.9 surface", "balls"), ("spacing 1.0", "spacing 0.9", "balls"),
           ("origin 0 0", "origin 0.3 0", "balls"), ("sink 0.2", "sink 0.1", "balls"),
           ("angle 0", "angle 10", "balls"),
           ("pattern scattered 3", "pattern scattered 4", "loose: seed 3 there, 4 here"),
           ("pattern scattered 3", "pattern grid", "loose"), ("outside road", "inside road", "balls"),
           ("outside road", "", "balls"), ("sink 0.5", "sink 0.4", "slip"),
           ("file places.txt", "file other.txt", "places"), ("scale 1 move", "scale 1.1 move", "house"),
           ("move 0 0 0", "move 0 0 0.1", "house"), ("house.stl", "other.stl", "house"),
           ("terrain floor.asc", "terrain higher.asc", "floor"), ("terrain ground.asc", "terrain higher.asc", "balls"),
           ("scale 1 start", "scale 1.1 start", "quake"), ("start 0", "start 0.1", "quake"),
           ("motion.txt", "other_motion.txt", "quake"), ("cell 1 ", "cell 2 ", "dep"), ("bulk 1.5", "bulk 1.6", "dep"),
           ("extent 0 16", "extent 0 15", "dep"), ("line.csv", "other.csv", "line"),
           ("line.csv", "backwards.csv", "line"), ("lower 0", "lower 0.1", "line")]   # backwards: forward is back
# words of these parsers that a restart file does not guard, as decks may change them, or that another one stands for
PARSERS = ("ground/placement_arguments", "meshes/surface_options", "deposit/deposit_options",
           "motion/fix_ground_motion", "deposit/fix_control_line")
OUTPUTS = {"output", "write", "series", "point", "motion", "window", "deposit", "rest"}
LIKE = {"inside": "outside", "upper": "surface", "sunk": "sink", "rim": "sink", "smallest": "file",
        "grid": "pattern", "zone": "outside"}       # zone: test_ground_zones


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("guards")
    for name, z in (("ground", 0.0), ("floor", -0.1), ("higher", 0.1)):
        write_asc(folder / f"{name}.asc", numpy.full((16, 16), z), cell=1.0)
    for name, x in (("road", 12), ("line", 10), ("other", 11)):
        ring = f"{x},0\n16,0\n16,16\n{x},16\n"
        (folder / f"{name}.csv").write_text(ring if name == "road" else f"{x},0\n{x},16\n")
    (folder / "backwards.csv").write_text("10,16\n10,0\n")
    for name, x in (("places", 1.0), ("other", 1.2)):
        (folder / f"{name}.txt").write_text(f"{x} 1 0\n3 1 0\n")
    for name, x in (("motion", 0.5), ("other_motion", 0.6)):
        (folder / f"{name}.txt").write_text(f"0 0 0 0\n1 {x} 0 0\n2 0 0 0\n")
    for name, size in (("house", 1.0), ("other", 1.2)):
        (folder / f"{name}.stl").write_bytes(stl_bytes(box((12, 12, 1), (12 + size, 13, 2))))
    run_deck(DECK.format(begin=NEW) + "run 20\nwrite_restart at.restart\n", folder)
    return folder


def test_the_same_goes_on(site):
    run_deck(DECK.format(begin="read_restart at.restart") + "run 10\n", site)


@pytest.mark.parametrize("old, new, fix", CHANGES)
def test_another_one_is_refused(site, old, new, fix):
    deck = DECK.format(begin="read_restart at.restart")
    assert old in deck
    with pytest.raises(AssertionError) as failed:
        run_deck(deck.replace(old, new) + "run 0\n", site)
    error = [line for line in str(failed.value).splitlines() if line.startswith("ERROR")]
    name, _, what = fix.partition(": ")
    assert len(error) == 1 and f" {name}" in error[0] and "restart file" in error[0], str(failed.value)[-500:]
    assert what in error[0]


def test_every_word_is_guarded():
    found = set()
    for name in PARSERS:
        text = (Path(__file__).resolve().parents[2] / "src" / f"{name}.cpp").read_text()
        found |= set(re.findall(r'(?:strcmp\(\w+\[[^]]*\], |\b(?:is|of_stl)\(|\bkeyword == )"([a-z_]+)"', text))
    guarded = {word for old, _, _ in CHANGES for word in old.split()}
    assert found - guarded - OUTPUTS - {*LIKE} == set() and {*LIKE.values()} <= guarded


# --- what LAMMPS drops from a restart file before a fix comes ---


BALANCE = "balance 1.0 shift x 10 1.01"


@pytest.mark.parametrize("fix, command", [
    *((fix, BALANCE) for fix in ("balls", "places", "house", "quake", "dep", "line")),
    ("balls", "run 0"), ("balls", "write_restart other.restart")])
def test_a_fix_that_comes_too_late(site, fix, command):
    """The contacts of walls, the sums of others: the fix would begin anew, without a word."""
    deck = DECK.format(begin="read_restart at.restart\ncomm_modify vel yes")
    line = next(line for line in deck.splitlines() if line.startswith(f"fix {fix} "))
    early = deck.replace(line, "").replace("fix line soil", "# fix line soil" if fix == "dep" else "fix line soil")
    run_deck(f"{early}\n{command}\n{line}\nrun 10\n", site, expect_error=f"Fix {fix} {line.split()[3]} must be defined "
             f"before the first command after read_restart")


def test_a_fix_of_lammps_that_comes_too_late(site):
    wall = "fix stock soil wall/gran hooke/history 1e6 NULL 50 NULL 0.5 0 zplane -1 NULL\n"
    run_deck(DECK.format(begin=NEW) + wall + "run 1\nwrite_restart stock.restart\n", site)
    deck = DECK.format(begin="read_restart stock.restart")
    run_deck(deck + wall + "run 1\n", site)
    run_deck(deck + "run 1\n" + wall + "run 1\n", site, expect_error="Fix stock wall/gran must be defined before")


@pytest.mark.parametrize("ranks", (1, 3))
def test_with_another_id_or_before_it_goes_on(site, ranks):
    deck = DECK.format(begin="read_restart at.restart\ncomm_modify vel yes")
    line = next(line for line in deck.splitlines() if line.startswith("fix places "))
    early = deck.replace(line, "")
    run_deck(f"{early}{BALANCE}\n{line.replace('places', 'others', 1)}\nrun 10\n", site, np=ranks)
    run_deck(f"{deck}{BALANCE}\nunfix places\n{line}\nrun 10\n", site, np=ranks)
