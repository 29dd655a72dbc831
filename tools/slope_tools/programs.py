"""Which LAMMPS program runs the decks, and which program writes files for ParaView."""
import os
import shutil
from pathlib import Path

from .errors import SlopeError

TOOLS = Path(__file__).resolve().parents[1]
# the program that belongs to these tools: of a checkout's build, or of an installation
BESIDE = (TOOLS.parent / "build" if (TOOLS.parent / "CMakeLists.txt").exists() else TOOLS.parents[2] / "bin") / "lmp"


def find_lmp(option):
    """Absolute path of the LAMMPS program."""
    return first("the LAMMPS program", (("--lmp", option), ("LMP in the environment", os.environ.get("LMP")),
                                        ("--lmp is not given, LMP is not set", BESIDE)))


def lmp_if_any(option):
    """The same; None where there is none and none was named."""
    try:
        return find_lmp(option)
    except SlopeError:
        if option or os.environ.get("LMP"):
            raise
        return None


def find_dump2vtk():
    """Absolute path of dump2vtk, which the build makes if it finds the VTK library."""
    return first("dump2vtk", (("DUMP2VTK in the environment", os.environ.get("DUMP2VTK")),
                              ("DUMP2VTK is not set", BESIDE.with_name("dump2vtk"))))


def first(what, places):
    """The first of (where, path) that is given; SlopeError, which names what, if that is no program."""
    where, path = next((where, path) for where, path in places if path)
    path = Path(shutil.which(path) or path).absolute()
    if not (path.is_file() and os.access(path, os.X_OK)):
        raise SlopeError(where, f"must lead to {what}", path)
    return path
