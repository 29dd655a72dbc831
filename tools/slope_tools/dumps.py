"""LAMMPS text dumps, read by the names of their columns."""
import gzip
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .errors import SlopeError

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
    try:
        with (gzip.open if path.suffix == ".gz" else open)(path, "rb") as file:
            text = file.read().decode("ascii", "replace")
    except (OSError, EOFError) as error:
        raise SlopeError(path, f"must be a LAMMPS dump ({getattr(error, 'strerror', None) or error})") from error
    begin = text.rfind("ITEM: TIMESTEP")
    head = re.match(r"ITEM: TIMESTEP\n\s*(\d+)\s*\nITEM: NUMBER OF ATOMS\n\s*(\d+)\s*\n(?:.*\n)*?ITEM: ATOMS (.*)\n",
                    text[begin:]) if begin >= 0 else None
    if head is None:
        raise SlopeError(path, "must be a LAMMPS text dump: ITEM: TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS, ATOMS")
    step, number, columns = int(head[1]), int(head[2]), head[3].split()
    if number == 0:
        raise SlopeError(path, f"must have balls at step {step}", "none")
    first = text.count("\n", 0, begin + head.end()) + 1
    rows = [line.split() for line in text[begin + head.end():].splitlines()]
    if len(rows) != number:
        raise SlopeError(path, f"must have {number} balls at step {step}, as its head says (is the run still writing?)",
                         len(rows))
    for i, row in enumerate(rows):
        if len(row) != len(columns):
            raise SlopeError(f"{path}: line {first + i}", f"must have {len(columns)} columns", len(row))
    index = {"id": columns.index("id")} if "id" in columns else {}
    for names in PLACES:
        index.update((names[0], columns.index(name)) for name in names if name in columns)
    if len(index) < 4:
        raise SlopeError(path, "must have the columns id x y z (or xu yu zu)", " ".join(columns))
    index.update((name, columns.index(name)) for name in wanted if name in columns)
    of = {name: numbers(rows, i, f"{path}: line", first, name) for name, i in index.items()}
    ids, count = np.unique(of["id"], return_counts=True)
    if len(ids) < number:
        raise SlopeError(path, f"must have each ball once at step {step}", f"id {ids[count.argmax()]:g} "
                                                                           f"{count.max()} times")
    return Snapshot(path, step, of)


def numbers(rows, column, where, first, name):
    """A column as finite numbers."""
    words = [row[column] for row in rows]
    try:
        values = np.array(words, float)
    except ValueError:
        values = np.array([as_number(word) for word in words])
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        raise SlopeError(f"{where} {first + wrong[0]}", f"{name} must be a finite number", words[wrong[0]])
    return values


def as_number(word):
    try:
        return float(word)
    except ValueError:
        return np.nan
