"""Contacts in a restart file whose numbers cannot be: one line, and no rank goes on."""

import struct

import pytest
from deck_helpers import run_deck
from mesh_helpers import mesh_deck, plane, write_case

KEYS, HISTORY, FORCE = 3, 7, 9
BALLS = [(0.3, 0.2, 0.49), (0.3, 0.2, 1.48)]     # one on the mesh, one on top of it

# the fix, numbers of its one contact after their length, and what is said of them
PLACES = {"mesh": (2 + KEYS + HISTORY, "Fix wall/gran/mesh wall"),
          "pair": (3 + HISTORY + FORCE, "Pair gran/restitution")}


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
