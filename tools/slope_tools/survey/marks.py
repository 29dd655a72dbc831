"""Values that stand for no height, in the type and the unit of the file that has them.

A mark is compared before any conversion: in metres and in double precision -3276.8 of a float32 raster, or -9999 of one
in feet, is another number.
"""
from typing import Dict, List, NamedTuple, Sequence, Set, Union

import numpy as np

# with which programs fill what they do not know, and which may be heights; others are beyond all heights
KNOWN = (0.0, -99.0, -999.0, -3276.8, -9999.0, -32767.0, -32768.0, 9999.0, 32767.0, 65535.0)
HUGE = 1e30             # beyond any height in any unit; marks of this size are often written with few digits
FEW_DIGITS = 1e-3       # relative


class Scale(NamedTuple):
    """Heights (m) are (stored * factor + offset) * unit."""
    factor: float = 1.0
    offset: float = 0.0
    unit: float = 1.0

    def in_unit(self, stored: np.ndarray) -> np.ndarray:
        """Heights in the unit of the file, in an array of their own."""
        heights = stored.astype(float)
        return heights if (self.factor, self.offset) == (1, 0) else heights * self.factor + self.offset

    def metres(self, heights: np.ndarray) -> np.ndarray:
        """Heights in the unit of the file to metres."""
        return heights if self.unit == 1 else heights * self.unit


def cells_of(stored: np.ndarray, value: float) -> np.ndarray:
    """Mask of the cells that hold a mark, which may have been written with the digits of another type.

    In turn: cells that are equal to it in their own type; in single precision; for huge marks, to three digits.
    """
    kind = stored.dtype.type
    if stored.dtype.kind in "iu":
        limits = np.iinfo(kind)
        fits = float(value).is_integer() and limits.min <= value <= limits.max
        return stored == kind(int(value)) if fits else np.zeros(stored.shape, bool)
    with np.errstate(over="ignore", invalid="ignore"):
        at = stored == kind(value)
        if not at.any() and stored.dtype.itemsize > 4:
            at = (stored.astype(np.float32) == np.float32(value)) & np.isfinite(stored)
        if not at.any() and abs(value) > HUGE:
            at = np.isclose(stored, value, rtol=FEW_DIGITS, atol=0)
    return at


def format_mark(value: Union[np.generic, float]) -> str:
    """A value with the digits that tell it from all others of its type, as --nodata takes it."""
    found = str(value)
    return found[:-2] if found.endswith(".0") else found


class Marks:
    """What the rasters of a terrain have of marks, collected while they are read."""

    def __init__(self, given: Sequence[float] = ()):
        self.given = given      # values of --nodata
        self.found: Set[float] = set()          # those that a cell had
        self.known: Dict[float, str] = {}       # of KNOWN, as heights in m: as the file has them
        self.extremes: Dict[float, str] = {}    # of the lowest and the highest value of each file

    def take(self, stored: np.ndarray, none: np.ndarray) -> None:
        """Add the cells of what is given to a mask."""
        for value in self.given:
            at = cells_of(stored, value)
            if at.any():
                self.found.add(value)
                none |= at

    def note(self, stored: np.ndarray, none: np.ndarray, scale: Scale) -> None:
        """Of stored heights, which may be marks; none: mask of those that are known to be none."""
        kind = stored.dtype.type
        limits = np.iinfo(kind) if stored.dtype.kind in "iu" else None
        heights = stored[~none]
        for found, values in (
                (self.known, [kind(one) for one in KNOWN
                              if limits is None or one.is_integer() and limits.min <= one <= limits.max]),
                (self.extremes, [heights.min(), heights.max()] if heights.size else [])):
            metres = scale.metres(scale.in_unit(np.array(values, stored.dtype)))
            found.update((height, format_mark(value)) for height, value in zip(metres.tolist(), values))

    @property
    def not_found(self) -> List[float]:
        """What is given and no cell had."""
        return [value for value in self.given if value not in self.found]

    def options(self, value: str) -> str:
        """--nodata with what is given and another value."""
        return " ".join(f"--nodata {one}" for one in (*map(format_mark, self.given), value))


def in_metres(z: np.ndarray) -> Marks:
    """The Marks of heights that are as they are stored."""
    found = Marks()
    found.note(z, np.isnan(z), Scale())
    return found
