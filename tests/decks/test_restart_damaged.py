"""Contacts in a restart file whose numbers cannot be: one line, and no rank goes on."""

import struct

import numpy
import pytest
from deck_helpers import run_deck, write_asc
from mesh_helpers import mesh_deck, plane, write_case

KEYS, HISTORY, OF_BALL = 3, 7, 13
BALLS = [(0.3, 0.2, 0.49), (0.3, 0.2, 1.48)]     # one on the mesh, one on top of it

# the fix, numbers of its one contact after their length, and what is said of them
PLACES = {"mesh": (2 + KEYS + HISTORY, "Fix wall/gran/mesh wall"),
          "pair": (3 + HISTORY + OF_BALL, "Pair gran/restitution")}


def deck(text, **settings):
    return mesh_deck(text, coeff="restitution 0.5", exclude=False, **settings)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A folder with cut.restart, and where the records of the mesh and of the pair begin in it."""
    folder = tmp_path_factory.mktemp("whole")
    write_case(folder, plane(1), BALLS, (0, 0, 0))
    run_deck(deck("run 1\nwrite_restart cut.restart"), folder)
    data = (folder / "cut.restart").read_bytes()
    found = {}
    for name, (length, _) in PLACES.items():
        record = struct.pack("<dd", length, 1)
        found[name] = data.find(record)
        assert found[name] > 0, name
    return data, found


def again(folder, data, np_=1, **options):
    write_case(folder, plane(1), BALLS, (0, 0, 0))
    (folder / "cut.restart").write_bytes(data)
    return run_deck(deck("run 1", begin="read_restart cut.restart"), folder, np=np_, **options)


def test_the_whole_file_is_read(tmp_path, whole):
    log = again(tmp_path, whole[0])
    assert "ERROR" not in log


@pytest.mark.parametrize("at, value, np_", [
    (0, 1e300, 1), (0, 1e300, 2), (0, -7.0, 1), (0, float("nan"), 1), (0, 0.0, 1), (0, 3.5, 1), (1, 1e9, 1),
    (1, -1.0, 1), (1, float("nan"), 1), (1, 2.0, 2), (1, 0.5, 1)])
@pytest.mark.parametrize("name", PLACES)
def test_a_damaged_file_ends_the_run(tmp_path, whole, name, at, value, np_):
    data, places = whole
    begin = places[name] + 8 * at
    again(tmp_path, data[:begin] + struct.pack("<d", value) + data[begin + 8:], np_,
          expect_error=f"{PLACES[name][1]}: the contacts of ball ")


# --- how much of a fix there is ---

COUNTED = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
{begin}
region ground terrain ground.asc depth 2 headroom 6
neighbor 0.2 bin
pair_style gran/restitution
pair_coeff * * stiffness 1e6 1e6 restitution 0.5 friction 30
fix field all wall/gran/balls 2 1.0 surface ground upper spacing 1.0
fix floor all wall/gran/mesh 2 terrain lower.asc output loads 5
fix move all nve/sphere
timestep 1e-3
fix dep all deposit/grid 10 0 cell 1 terrain ground output out bulk 1.5
fix line all control/line line.csv output out
run 20
"""
MEMBERS = {"mesh": b"recorded", "cells": b"cells", "crossings": b"crossings"}
CALLERS = {"mesh": "Fix wall/gran/mesh floor", "cells": "Fix deposit/grid dep", "crossings": "Fix control/line line"}


@pytest.fixture(scope="module")
def counted(tmp_path_factory):
    """A folder with cut.restart, and where the numbers of records are in it, each there twice."""
    folder = tmp_path_factory.mktemp("counted")
    write_asc(folder / "ground.asc", numpy.zeros((16, 16)))
    write_asc(folder / "lower.asc", numpy.full((16, 16), -0.4))
    (folder / "line.csv").write_text("6.4,0\n6.4,16\n")
    begin = ("region all block 0 16 0 16 -2 6\ncreate_box 2 all\nlattice sc 1.0\nregion soil block 6 8 6 8 0.9 1.1\n"
             "create_atoms 1 region soil\nset group all diameter 0.9 density 2000\nvelocity all set 30 0 0")
    run_deck(COUNTED.format(begin=begin) + "write_restart cut.restart\n", folder)
    data = (folder / "cut.restart").read_bytes()
    found = {}
    for name, member in MEMBERS.items():
        label = member.ljust(24, b"\0")
        assert data.count(label) == 1
        found[name] = data.index(label) + 24
        number, again = struct.unpack_from("<dd", data, found[name])
        assert 1 <= number < 1e6 and again == -1 - number
    return folder, data, found


@pytest.mark.parametrize("value", (1e300, -7.0, float("nan"), 1e6, 0.5, 0.0))
@pytest.mark.parametrize("name", CALLERS)
@pytest.mark.parametrize("word", (0, 1))
def test_a_number_of_records_that_is_damaged(counted, name, word, value):
    folder, data, places = counted
    begin = places[name] + 8 * word
    (folder / "cut.restart").write_bytes(data)
    deck = COUNTED.format(begin="read_restart cut.restart")
    if (word, value) == (0, 0.0):
        run_deck(deck, folder)
    (folder / "cut.restart").write_bytes(data[:begin] + struct.pack("<d", value) + data[begin + 8:])
    run_deck(deck, folder, expect_error=f"{CALLERS[name]}: the restart file must have a whole number of values in "
             f"{MEMBERS[name].decode()}, from 0 to ")


def test_marks_of_a_ground_that_are_damaged(counted):
    """The number of marks of the fixed balls: not read beyond the end, another ground."""
    folder, data, _ = counted
    begin = data.find(b"marks_of_the_balls") + 24     # the number, twice
    marks, = struct.unpack_from("<d", data, begin)
    assert 200 < marks < 300
    for value in (1e300, 1e8, -1.0, float("nan"), marks + 1):
        (folder / "cut.restart").write_bytes(data[:begin] + struct.pack("<d", value) + data[begin + 8:])
        run_deck(COUNTED.format(begin="read_restart cut.restart"), folder,
                 expect_error="Fix wall/gran/balls field: the restart file must have a whole number of values in mark")


def test_a_damaged_path_of_a_ball_ends_the_run(counted):
    """What fix deposit/grid has for a ball: 6 numbers, their length first."""
    folder, data, _ = counted
    record = struct.pack("<3d", 6.0, 6.0, 6.0)      # of the ball that started at 6 6
    assert data.count(record) == 1
    at = data.index(record)
    for value, np_ in ((7.0, 1), (0.0, 1), (1e300, 2), (float("nan"), 1), (5.5, 2)):
        (folder / "cut.restart").write_bytes(data[:at] + struct.pack("<d", value) + data[at + 8:])
        run_deck(COUNTED.format(begin="read_restart cut.restart"), folder, np=np_,
                 expect_error="Fix deposit/grid dep: the path of ball ")
