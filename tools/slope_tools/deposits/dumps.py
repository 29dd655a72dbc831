"""LAMMPS text dumps, read by the names of their columns."""
import gzip
import os
import re
import zlib
from pathlib import Path
from typing import BinaryIO, List, NamedTuple, Tuple, cast

import numpy as np

from ..digits import rounded
from ..errors import SlopeError
from ..heads import parse_cell

CHUNK = 1 << 24         # bytes
MEMORY = 10             # bytes of memory per byte of the last snapshot, measured 9 for eight columns
BEGIN = b"ITEM: TIMESTEP"
PLACES = ("x", "xu"), ("y", "yu"), ("z", "zu")    # names of a column; xu is not wrapped at periodic sides


class Snapshot(NamedTuple):
    """The balls of one time step."""
    path: Path
    step: int
    of: dict        # name of a column that the file has: array

    @property
    def place(self):
        """x y z of each ball, m."""
        return np.column_stack([self.of[key] for key in "xyz"])


def last(path, wanted=()):
    """The last snapshot of a dump (.gz too): id, x, y, z, and those of `wanted` that it has."""
    path = Path(path)
    text, lines_before = last_text(path)
    head = re.match(r"ITEM: TIMESTEP\n\s*(\d{1,18})\s*\nITEM: NUMBER OF ATOMS\n\s*(\d{1,18})\s*\n"
                    r"(?:.*\n)*?ITEM: ATOMS (.*)\n", text)
    if head is None:
        raise SlopeError(path, "must be a LAMMPS text dump: ITEM: TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS, ATOMS")
    step, number, columns = int(head[1]), int(head[2]), head[3].split()
    if number == 0:
        raise SlopeError(path, f"must have balls at step {step}", "none")
    first = lines_before + text.count("\n", 0, head.end()) + 1
    rows = text[head.end():].splitlines()
    if len(rows) != number:
        raise SlopeError(path, f"must have {number} balls at step {step}, as its head says (is the run still writing?)",
                         len(rows))
    table = numbers_only(rows, len(columns))
    if table is None:
        rows = [line.split() for line in rows]
        for i, row in enumerate(rows):
            if len(row) != len(columns):
                raise SlopeError(f"{path}: line {first + i}", f"must have {len(columns)} columns", len(row))
    index = {"id": columns.index("id")} if "id" in columns else {}
    for names in PLACES:
        index.update((names[0], columns.index(name)) for name in names if name in columns)
    if len(index) < 4:
        raise SlopeError(path, "must have the columns id x y z (or xu yu zu)", " ".join(columns))
    index.update((name, columns.index(name)) for name in wanted if name in columns)
    of = {name: read_dump_numbers(rows, i, f"{path}: line", first, name) if table is None else table[:, i]
          for name, i in index.items()}
    ids, count = np.unique(of["id"], return_counts=True)
    if len(ids) < number:
        raise SlopeError(path, f"must have each ball once at step {step}", f"id {ids[count.argmax()]:g} "
                                                                           f"{count.max()} times")
    return Snapshot(path, step, of)


def frames(path) -> List[Tuple[List[str], np.ndarray]]:
    """All snapshots of a short dump that the tools asked for: names of the columns, a row per ball as in the file."""
    found = []
    for part in Path(path).read_text(encoding="ascii").split("ITEM: ATOMS ")[1:]:
        head, rows = part.split("ITEM:")[0].split("\n", 1)
        columns = head.split()
        found.append((columns, np.array(rows.split(), float).reshape(-1, len(columns))))
    return found


def last_text(path):
    """The text of a dump from the head of its last snapshot on, and the number of lines before it.

    No more than a snapshot is kept, so that a long dump, or a small .gz of a huge one, needs no more memory than that.
    """
    have = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    kept, lines = bytearray(), 0
    try:
        with cast(BinaryIO, gzip.open(path, "rb") if path.suffix == ".gz" else open(path, "rb")) as file:
            while chunk := file.read(CHUNK):
                unseen = max(len(kept) - len(BEGIN), 0)
                kept += chunk
                begin = kept.rfind(BEGIN, unseen)
                if begin > 0:
                    lines += kept.count(b"\n", 0, begin)
                    del kept[:begin]
                if MEMORY * len(kept) > have:
                    room, text, need = (rounded(size / 1e9, 3) for size in (have, len(kept), MEMORY * len(kept)))
                    raise SlopeError(path, f"must have a last snapshot that fits in the {room} GB of memory of this "
                                     "machine", f"more than {text} GB of text, which need {need} GB")
    except (OSError, EOFError, zlib.error) as error:
        raise SlopeError(path, f"must be a LAMMPS dump ({getattr(error, 'strerror', None) or error})") from error
    text = kept.decode("ascii", "replace")
    return text.replace("\r\n", "\n") if b"\r" in kept else text, lines


def numbers_only(rows, columns):
    """Lines as a table, three times as fast as word by word; None unless all of it is finite numbers."""
    try:
        table = np.loadtxt(rows, ndmin=2, comments=None)
    except ValueError:
        return None
    return table if table.shape == (len(rows), columns) and np.isfinite(table).all() else None


def read_dump_numbers(rows, column, where, first, name):
    """A column as finite numbers."""
    words = [row[column] for row in rows]
    try:
        values = np.array(words, float)
    except ValueError:
        values = np.array([parse_cell(word) for word in words])
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        raise SlopeError(f"{where} {first + wrong[0]}", f"{name} must be a finite number", words[wrong[0]])
    return values
