"""The motion of the ground as decks read it, lines "t ax ay az" in s and m/s2: what `slope quake` writes."""
from pathlib import Path

import numpy as np

from ..errors import SlopeError


def read(path) -> np.ndarray:
    """The rows t ax ay az of a motion, (points, 4); SlopeError with file, line, rule, value."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise SlopeError(path, f"must be text, lines t ax ay az ({why})") from None
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            row = []
        if len(row) != 4 or not np.isfinite(row).all():
            raise SlopeError(f"{path}: line {number}", "must be four numbers, t ax ay az in s and m/s2 (slope quake "
                             "makes it from a record)", line[:60])
        rows.append(row)
    values = np.array(rows)
    if len(values) < 2 or not (np.diff(values[:, 0]) > 0).all():
        raise SlopeError(path, "must have two lines at least, with times that grow")
    if not peak(values) > 0:
        raise SlopeError(path, "must hold a motion, all horizontal accelerations are 0")
    return values


def peak(values: np.ndarray) -> float:
    """Largest horizontal acceleration of a motion's rows, of both components together, m/s2."""
    return float(np.hypot(values[:, 1], values[:, 2]).max())
