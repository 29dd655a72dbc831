"""Which LAMMPS program runs the decks."""
import os
import shutil
from pathlib import Path

from .errors import SlopeError

TOOLS = Path(__file__).resolve().parents[1]
# the program that belongs to these tools: of a checkout's build, or of an installation
BESIDE = (TOOLS.parent / "build" if (TOOLS.parent / "CMakeLists.txt").exists() else TOOLS.parents[2] / "bin") / "lmp"


def find_lmp(option):
    """Absolute path of the LAMMPS program."""
    for where, path in (("--lmp", option), ("LMP in the environment", os.environ.get("LMP")),
                        ("--lmp is not given, LMP is not set", BESIDE)):
        if path:
            path = Path(shutil.which(path) or path).absolute()
            if not (path.is_file() and os.access(path, os.X_OK)):
                raise SlopeError(where, "must lead to the LAMMPS program", path)
            return path
