"""Restart files of LAMMPS."""
import os
import struct
from pathlib import Path

MAGIC = b"LammpS RestartT\0"           # the first and the last bytes of a restart file


def restarts(folder):
    """(step, path) of the complete restart files of LAMMPS in a folder and below, the latest step first."""
    found = [(restart_step(path), path) for path in sorted(Path(folder).rglob("*")) if path.is_file()]
    return sorted(((step, path) for step, path in found if step is not None), reverse=True)


def restart_step(path):
    """The step of a restart file of LAMMPS; None for another file, and for one that was cut while it was written."""
    try:
        with open(path, "rb") as file:
            head = file.read(4096)
            if not head.startswith(MAGIC) or len(head) < 2 * len(MAGIC):
                return None
            file.seek(-len(MAGIC), os.SEEK_END)
            if file.read() != MAGIC:
                return None
        # byte order and format; then numbered entries (lmprestart.h): 0 and 4 are texts, 3 is the size of a step
        at, entry, size = len(MAGIC) + 8, None, 8
        while entry != 5:
            entry, value = struct.unpack_from("=ii", head, at)
            at += 8 + max(0, value) * (entry in (0, 4))
            size = value if entry == 3 else size
        return max(0, struct.unpack_from("=q" if size == 8 else "=i", head, at - 4)[0])
    except (OSError, struct.error):
        return None
