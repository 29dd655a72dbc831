"""Why a run ended: what LAMMPS itself said, and whether it was the restart file; of outputs as they were recorded.

spoiled/VERSION.PLACE.RANKS.log and .screen: LAMMPS that reads a restart file of which 200 bytes are spoiled, in the
header, among the balls, at the end (Open MPI 4.1.4; names of machines and folders replaced, traces shortened).
"""
from pathlib import Path

import pytest

from slope_tools.case import last_words, logs

SPOILED = Path(__file__).parent / "spoiled"
MEMORY = "C++ memory allocation failed: std::bad_alloc"
LAST = "fix style: wall/gran/balls, fix ID: slip"
# crashed, and what was said best
RECORDED = {
    "29Sep2021.header.1": (True, "what():  std::bad_alloc"), "29Sep2021.header.2": (True, "what():  std::bad_alloc"),
    "29Sep2021.atoms.1": (True, ""), "29Sep2021.atoms.2": (True, LAST),
    "29Sep2021.end.1": (False, "ERROR: Did not assign all restart atoms correctly"),
    "4Jul2026.header.1": (False, MEMORY), "4Jul2026.header.2": (False, MEMORY),
    "4Jul2026.atoms.1": (True, "LAMMPS (4 Jul 2026)"), "4Jul2026.atoms.2": (True, LAST),
    "4Jul2026.end.1": (False, "ERROR: Did not assign all restart atoms correctly"),
}


def read(log, screen, begin=0):
    return logs.Log(log).update(), last_words.Screen(screen, begin)


def write(folder, log, screen):
    for name, text in (("log.lammps", log), ("screen.txt", screen)):
        (folder / name).write_text(text)
    return folder / "log.lammps", folder / "screen.txt"


def test_every_recorded_output_is_tested():
    assert {path.stem for path in SPOILED.iterdir()} == set(RECORDED)


@pytest.mark.parametrize("name", RECORDED)
def test_a_spoiled_restart_file(name):
    crashed, said = RECORDED[name]
    log, screen = read(SPOILED / f"{name}.log", SPOILED / f"{name}.screen")
    assert last_words.spoiled_restart(log, screen, crashed)
    words = last_words.reason(log, screen)
    if name == "29Sep2021.atoms.1":     # nothing but the trace of Open MPI
        assert words.endswith("*** Process received signal ***")
    else:
        assert words == said


# --- what is no fault of the restart file ---

START = "LAMMPS (4 Jul 2026)\n"
READ = (START + 'read_restart ${restart}\nread_restart tiny.1.restart\nReading restart file ...\n  350 atoms\n'
        '  read_restart CPU = 0.003 seconds\n')
STEP = "   Step          Atoms\n      500           350\n      510           350\n"
WRONG = "ERROR: Unrecognized fix style 'x' (src/modify.cpp:910)\n"
TRACE = "[node:12] *** Process received signal ***\n[node:12] Signal: Segmentation fault (11)\n"


@pytest.mark.parametrize("log, screen, crashed, spoiled", [
    (READ, READ, True, True),                   # crashed before the first step
    (READ + STEP, READ + STEP + TRACE, True, False),        # in the run
    (READ + STEP, READ + STEP + MEMORY, False, False),
    (READ + WRONG, READ + WRONG, False, False),             # in the deck, after it was read
    (READ, READ + WRONG.replace("ERROR", "ERROR on proc 1"), False, False),
    (READ, READ, False, False),                 # ended quietly
    ("", "lmp: error while loading shared libraries: libmpi.so.40: cannot open shared object file\n", False, False),
])
def test_whose_fault(tmp_path, log, screen, crashed, spoiled):
    assert last_words.spoiled_restart(*read(*write(tmp_path, log, screen)), crashed) == spoiled


# --- LAMMPS among others ---

BOX = "-" * 74 + "\n"
ABORT = (BOX + "MPI_ABORT was invoked on rank 1 in communicator MPI_COMM_WORLD\nwith errorcode 1.\n\n"
         "NOTE: invoking MPI_ABORT causes Open MPI to kill all MPI processes.\n"
         "You may or may not see output from other processes, depending on\nexactly when Open MPI kills them.\n" + BOX)
SLOTS = BOX + "There are not enough slots available in the system to satisfy the 64\nslots that were requested\n" + BOX
MPICH = ("application called MPI_Abort(MPI_COMM_WORLD, 1) - process 0\n" + "=" * 83 + "\n"
         "=   BAD TERMINATION OF ONE OF YOUR APPLICATION PROCESSES\n=   EXIT CODE: 9\n" + "=" * 83 + "\n"
         "YOUR APPLICATION TERMINATED WITH THE EXIT STRING: "
         "Killed (signal 9)\nThis typically refers to a problem with your application.\n"
         "Please see the FAQ page for debugging suggestions\n")


@pytest.mark.parametrize("screen, said", [
    (START + ABORT + "Created 9 atoms\nERROR on proc 1: Bad grid of processors (src/procmap.cpp:48)\n" + ABORT,
     "ERROR on proc 1: Bad grid of processors"),
    (START + BOX + "ERROR on proc 1: within (src/x.cpp:1)\n" + BOX, "ERROR on proc 1: within"),
    (START + "Created 9 atoms\n" + ABORT, "Created 9 atoms"),
    (START + "Created 9 atoms\n" + MPICH, "Created 9 atoms"),
    (START + "Created 9 atoms\nsrun: error: node: task 0: Killed\n", "Created 9 atoms"),
    (SLOTS, "There are not enough slots available in the system to satisfy the 64"),
    (MPICH, "application called MPI_Abort(MPI_COMM_WORLD, 1) - process 0"),
    ("terminate called after throwing an instance of 'std::length_error'\n  what():  too long\n" + TRACE,
     "what():  too long"),
    ("terminate called without an active exception\n" + TRACE, "terminate called without an active exception"),
    ("-" * 63 + "\nPair  | 0.1\n", "Pair  | 0.1"),          # of LAMMPS' own tables
    ("", ""),
])
def test_words(tmp_path, screen, said):
    assert last_words.reason(*read(*write(tmp_path, "", screen))) == said


def test_the_log_comes_first_and_older_parts_do_not_count(tmp_path):
    log, screen = write(tmp_path, START + WRONG, START + "ERROR: older\n" + START + "ERROR: newer\n")
    assert last_words.reason(*read(log, screen)) == WRONG.split(" (")[0]
    log.write_text(START)
    begin = len(START + "ERROR: older\n")
    assert last_words.reason(*read(log, screen, begin)) == "ERROR: newer"
    assert last_words.reason(*read(log, tmp_path / "none")) == ""
