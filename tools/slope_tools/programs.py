"""Which LAMMPS program runs which code: --lmp of commands that compare several."""
import os
import shutil
from pathlib import Path

from .errors import SlopeError

TOOLS = Path(__file__).resolve().parents[1]
# the program that belongs to these tools: of a checkout's build, or of an installation
BESIDE = (TOOLS.parent / "build" if (TOOLS.parent / "CMakeLists.txt").exists() else TOOLS.parents[2] / "bin") / "lmp"


def lmp_of_each(options, names):
    """The program that --lmp FILE names (default: find_lmp's), and {code: program} of --lmp CODE=FILE; absolute
    paths. names: the codes that may have a program of their own.
    """
    everybody, own = None, {}
    for option in options or ():
        code, equals, file = option.partition("=")
        if not equals:
            if everybody is not None:
                raise SlopeError("--lmp", "must name one program for all, others as CODE=FILE", option)
            everybody = option
        elif code not in names:
            raise SlopeError("--lmp", f"must be FILE, or CODE=FILE with CODE of {', '.join(names)}", option)
        else:
            own[code] = find_lmp(file)
    return find_lmp(everybody), own


def find_lmp(option):
    """Absolute path of the LAMMPS program."""
    for where, path in (("--lmp", option), ("LMP in the environment", os.environ.get("LMP")),
                        ("--lmp is not given, LMP is not set", BESIDE)):
        if path:
            path = Path(shutil.which(path) or path).absolute()
            if not (path.is_file() and os.access(path, os.X_OK)):
                raise SlopeError(where, "must lead to the LAMMPS program", path)
            return path
