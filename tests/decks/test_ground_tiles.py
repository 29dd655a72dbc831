"""The ground on demand: each rank makes the fixed balls near its own ones, tile by tile. Held against the same balls
from a file, which every rank holds: over ranks, balance, a shrink-wrapped box, a ball that comes down far away,
restarts."""

import re

import numpy
import pytest

from deck_helpers import dump_difference, read_dump, run_deck, write_asc

# a slope of waves, 160 x 120 m, with a pit; three balls fall on it, the last one flies 90 m; one rests

DECK = """
units si
atom_style sphere
atom_modify map array
boundary {boundary}
comm_modify vel yes
processors {processors}
region ground terrain ground.asc depth 30 headroom 60
region pit block 30.2 41.3 20.1 33.7 -30 60 units box
create_box 2 ground
create_atoms 1 single 20 20 14
create_atoms 1 single 36 40 14
create_atoms 1 single 31 52.5 15
set group all diameter 1.0 density 2500
group one id 1
group two id 2
group far id 3
velocity one set 3 4 -2
velocity two set -2 -4 0
velocity far set 27 12 12
neighbor 0.4 bin
neigh_modify every 1 delay 0 check yes binsize 10
pair_style gran/restitution
pair_coeff * * stiffness 2e6 2e6 restitution 0.5 friction 30 rolling 0.05
timestep 1e-3
fix wall all wall/gran/balls 2 1.0 {ground}
{balance}
fix move all nve/sphere
fix weight all gravity 9.81 vector 0 0 -1
dump path all custom 100 {out}.dump id x y z vx vy vz omegax omegay omegaz
dump_modify path sort id format float %.17g
thermo 1000
"""
SURFACE = "surface ground upper spacing 1.0 outside pit"


def deck(out="out", ground=SURFACE, boundary="f f f", processors="* * *", balance=""):
    return DECK.format(out=out, ground=ground, boundary=boundary, processors=processors, balance=balance)


def heights(wave=3.0):
    i, j = numpy.meshgrid(numpy.arange(81), numpy.arange(61))
    return 4.0 + 0.04 * i + wave * numpy.sin(0.35 * i) * numpy.cos(0.3 * j)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The run with the balls of a file, which a rank looked for in all of the ground."""
    folder = tmp_path_factory.mktemp("site")
    write_asc(folder / "ground.asc", heights(), 0.0, 0.0, 2.0)
    log = run_deck(deck(ground=SURFACE + " write all.xyz") + "run 0\n", folder)
    total, extra = map(int, re.search(r"wall: (\d+) fixed balls .*, (\d+) extra", log).groups())
    assert total == len(numpy.loadtxt(folder / "all.xyz")) and extra > 100
    run_deck(deck(out="file", ground="file all.xyz") + "run 6000\n", folder)
    return folder


def test_the_run_is_worth_comparing(site):
    frames = read_dump(site / "file.dump")
    path = numpy.array([frames[step][:, 1:4] for step in sorted(frames)])
    assert path[-1, 2, 0] - path[0, 2, 0] > 60.0                      # far from what was made first
    assert abs(numpy.diff(path[:, :, 2], axis=0)).max() > 0.5         # they fall
    assert (path[-1, :, 2] < 14).all() and (path[-1, :, 2] > -1).all()    # and were caught
    assert numpy.abs(frames[6000][:, 7:]).max() > 0.1                 # and turn


@pytest.mark.parametrize("np, settings", [
    (1, {}), (1, dict(boundary="s s fs")), (2, dict(processors="2 1 1")),
    (2, dict(boundary="s s fs", processors="1 2 1")),
    (2, dict(boundary="s s fs", processors="2 1 1", balance="fix even all balance 200 1.0 shift x 5 1.05")),
    (4, dict(processors="4 1 1"))], ids=["one", "shrink-wrapped", "two", "two shrink-wrapped", "balanced", "four"])
def test_the_balls_of_the_file_are_there_wherever_a_ball_comes(site, np, settings):
    """On one rank to the last bit but for the digits of the file; three balls on four ranks: some have none."""
    out = "-".join([str(np), *settings.values()]).replace(" ", "").replace("*", "")[:40].replace("/", "")
    run_deck(deck(out=out, **settings) + "run 6000\n", site, np=np)
    expected, found = (read_dump(site / f"{name}.dump") for name in ("file", out))
    for step in (1000, 3000, 6000):
        assert max(dump_difference(expected[step], found[step])) < 1e-6


def test_large_ground_is_counted_when_asked(tmp_path):
    write_asc(tmp_path / "ground.asc", heights(), 0.0, 0.0, 2.0)
    fine = SURFACE.replace("spacing 1.0", "spacing 0.3")
    count = "run 0\nprint \"balls $(f_wall)\"\n"
    log = run_deck(deck(ground=fine) + count, tmp_path, np=2)
    assert re.search(r"wall: fixed balls of diameter 1 \(on a plan grid of \d+ nodes every 0.3, made where balls come "
                     r"near, outside region pit\)", log)
    counted = int(re.search(r"^balls (\d+)$", log, re.MULTILINE)[1])
    log = run_deck(deck(ground=fine + " write all.xyz") + count, tmp_path)
    assert f"wall: {counted} fixed balls of diameter" in log and counted > 140_000
    assert len(numpy.loadtxt(tmp_path / "all.xyz")) == counted


# --- restart ---

AGAIN = """
read_restart mid.restart
region ground terrain ground.asc depth 30 headroom 60
region pit block 30.2 41.3 20.1 {pit} -30 60 units box
neighbor 0.4 bin
neigh_modify every 1 delay 0 check yes binsize 10
comm_modify vel yes
timestep 1e-3
fix wall all wall/gran/balls 2 1.0 {ground}
fix move all nve/sphere
fix weight all gravity 9.81 vector 0 0 -1
dump path all custom 100 {out}.dump id x y z vx vy vz omegax omegay omegaz
dump_modify path sort id format float %.17g
run 1000
"""


@pytest.mark.parametrize("np, again", [(1, 2), (2, 1)])
def test_restart_on_other_ranks(site, np, again):
    run_deck(deck(out="whole") + "run 5000\nwrite_restart mid.restart\nrun 1000\n", site, np=np)
    run_deck(AGAIN.format(out="again", ground=SURFACE, pit=33.7), site, np=again)
    whole, found = read_dump(site / "whole.dump")[6000], read_dump(site / "again.dump")[6000]
    assert max(dump_difference(whole, found)) < 1e-8


def test_restart_refuses_another_ground(tmp_path):
    write_asc(tmp_path / "ground.asc", heights(), 0.0, 0.0, 2.0)
    large = "surface ground upper spacing 0.3 outside pit"
    for ground, spacing in (SURFACE, "1.0"), (large, "0.3"):
        write_asc(tmp_path / "ground.asc", heights(), 0.0, 0.0, 2.0)
        run_deck(deck(ground=ground) + "run 10\nwrite_restart mid.restart\n", tmp_path)
        other = "Fix wall/gran/balls wall: the restart file was written with other fixed balls ("
        run_deck(AGAIN.format(out="a", ground=ground, pit=33.7), tmp_path, np=2)
        run_deck(AGAIN.format(out="a", ground=ground, pit=63.7), tmp_path, expect_error=other)
        run_deck(AGAIN.format(out="a", ground=ground + " origin 0.1 0", pit=33.7), tmp_path, expect_error=other)
        run_deck(AGAIN.format(out="a", ground=ground.replace(spacing, "0.95"), pit=33.7), tmp_path, expect_error=other)
        run_deck(AGAIN.format(out="a", ground=ground, pit=33.7).replace("balls 2 1.0", "balls 2 1.01"), tmp_path,
                 expect_error=other)
        write_asc(tmp_path / "ground.asc", heights(2.9), 0.0, 0.0, 2.0)
        run_deck(AGAIN.format(out="a", ground=ground, pit=33.7), tmp_path, np=2, expect_error=other)


def test_a_raster_beyond_the_free_memory_ends_all_ranks(tmp_path):
    with open(tmp_path / "large.asc", "w") as out:
        out.write("ncols 20000\nnrows 20000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n")
        out.flush()
        out.truncate(10 ** 13)
    run_deck("region ground terrain large.asc\n", tmp_path, np=2,
             expect_error="Region terrain: large.asc: its text would need 1e+04 GB of memory, ")
