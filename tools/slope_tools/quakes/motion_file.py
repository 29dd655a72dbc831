"""The motion of the ground as decks read it, lines "t ax ay az" in s and m/s2: what `slope quake` writes."""
import re
from pathlib import Path
from typing import List

import numpy as np

from .. import heads
from ..errors import SlopeError
from ..findings import Finding
from .quake_records import MOST

NAMES = re.compile(r"\b(?:a(?:cc)?_?([xyz])|([xyz])|t|time)\b", re.IGNORECASE)
AXIS = re.compile(r"x axis towards ([-+.\deE]+) degrees")        # as slope quake writes it
ACROSS = 0.5            # of the peak: less along the direction of sliding is that of another component
EAST = 90.0             # compass bearing of a terrain's x axis
UNITS = re.compile(r"[(\[]([^)\]]*)[)\]]")


def read_motion(path) -> np.ndarray:
    """The rows t ax ay az of a motion as fix ground/motion takes them, (points, 4); two of one time are a jump.

    Raises SlopeError with file, line, rule, value.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise SlopeError(path, f"must be text, lines t ax ay az ({why})") from None
    rows: List[List[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        content, _, comment = line.partition("#")
        words = content.replace(",", " ").split()
        if not words:
            if not rows:
                check_head(comment, f"{path}: line {number}")
            continue
        row = [heads.parse_cell(word) for word in words]
        if len(row) != 4 or not np.isfinite(row).all():
            raise SlopeError(f"{path}: line {number}", "must be four numbers, t ax ay az in s and m/s2 (slope quake "
                             "makes it from a record)", line[:60])
        if rows and row[0] < rows[-1][0]:
            raise SlopeError(f"{path}: line {number}", f"times must not decrease, {rows[-1][0]:g} s is before it",
                             f"{row[0]:g}")
        rows.append(row)
    values = np.array(rows)
    if len(values) < 2 or not values[-1, 0] > values[0, 0]:
        raise SlopeError(path, "must have lines at two times at least")
    largest = np.abs(values[:, 1:]).max()
    if largest > MOST:
        raise SlopeError(path, f"must have accelerations in m/s2, at most {MOST:g}: are they in gal?", f"{largest:.6g}")
    if not peak(values) > 0:
        raise SlopeError(path, "must hold a motion, all horizontal accelerations are 0")
    return values


def check_head(comment: str, where: str) -> None:
    """Raise SlopeError if a comment names the columns, and they are in another order or other units; or if it says
    that the x axis is not that of terrains."""
    axis = AXIS.search(comment)
    if axis and heads.parse_cell(axis[1]) != EAST:
        raise SlopeError(where, f"must have the axes of a terrain, x towards the east (slope quake --azimuth {EAST:g}, "
                         "its default)", axis[0])
    names = [(one[1] or one[2] or "t").lower() for one in NAMES.finditer(comment)]
    if sorted(names) != ["t", "x", "y", "z"]:
        return
    units = [unit.strip().lower() for one in UNITS.findall(comment) for unit in one.split(",")]
    others = [unit for unit in units if unit not in heads.TIMES and heads.acceleration(unit) is not None]
    if names != ["t", "x", "y", "z"] or any(heads.acceleration(unit) != 1.0 for unit in others) or any(
            heads.TIMES.get(unit, 1.0) != 1.0 for unit in units):
        raise SlopeError(where, "columns must be t ax ay az in s and m/s2", comment.strip()[:60])


def share_along(values: np.ndarray, bearing: float) -> float:
    """The largest acceleration along a compass bearing (degrees), either way, over the peak of a motion's rows."""
    east, north = np.sin(np.radians(bearing)), np.cos(np.radians(bearing))
    return float(np.abs(values[:, 1] * east + values[:, 2] * north).max()) / peak(values)


def find_across(values: np.ndarray, bearing: float, file: object, body: str = "") -> List[Finding]:
    """That a motion, as one of a single component, hardly shakes what slides along a compass bearing (degrees)."""
    share = share_along(values, bearing)
    return [Finding("motion across", {"file": str(file), "body": body, "bearing": bearing, "percent": 100 * share})] * (
        share < ACROSS)


def peak(values: np.ndarray) -> float:
    """Largest horizontal acceleration of a motion's rows, of both components together, m/s2."""
    return float(np.hypot(values[:, 1], values[:, 2]).max())
