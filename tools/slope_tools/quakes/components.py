"""The components of a record, and what its formats share: units, directions, numbers."""
import re
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ..errors import SlopeError
from ..heads import ACCELERATIONS

GAL, G = ACCELERATIONS["gal"], ACCELERATIONS["g"]       # m/s2
UP = "up"
SLOWEST = 1.0               # s, time step; records have 0.02 s or less
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
DIRECTIONS: Dict[str, Tuple[Any, float]] = {
    **dict.fromkeys(("UP", "UD", "U-D", "U", "VER", "VERT", "VERTICAL", "V", "Z"), (UP, 1.0)),
    **dict.fromkeys(("DWN", "DOWN"), (UP, -1.0)), **dict.fromkeys(("NS", "N-S", "N", "NORTH"), (0.0, 1.0)),
    **dict.fromkeys(("EW", "E-W", "E", "EAST"), (90.0, 1.0))}


@dataclass
class Component:
    """One direction of a record: where it is from, azimuth in degrees or UP, time step (s), values (m/s2)."""

    source: str
    direction: object
    dt: float
    values: np.ndarray
    begin: str = ""        # date and time as the file has them
    unit_in_head: bool = False      # as its format has it: --unit is not for it
    first_time: Optional[float] = None      # s, of a CSV
    sensor: str = ""       # of KiK-net, which has two
    of: str = ""           # earthquake and station as the file has them; "": it does not say

    @property
    def name(self):
        return UP if self.direction == UP else f"{self.direction:g} degrees"


class NoAcceleration(SlopeError):
    """A file of velocities, displacements or spectra, which archives have beside the accelerations."""


def direction_of(word: str) -> Optional[Tuple[Any, float]]:
    """Azimuth or UP, and the sign, of a word such as 230, E-W, N28W or UP; None of another."""
    word = word.upper()
    quadrant = re.fullmatch(r"([NS])(\d{1,2})([EW])", word)
    if quadrant and int(quadrant[2]) <= 90:
        turned = int(quadrant[2]) * (1 if quadrant[3] == "E" else -1)
        return float((turned if quadrant[1] == "N" else 180 - turned) % 360), 1.0
    if re.fullmatch(r"\d{1,3}", word) and int(word) <= 360:
        return float(int(word) % 360), 1.0
    return DIRECTIONS.get(word)


def numbers_of(line: str) -> Optional[List[float]]:
    """The numbers of a line, between which there may be nothing; None if it holds something else."""
    if NUMBER.sub("", line).strip():
        return None
    return [float(word.translate(str.maketrans("dD", "ee"))) for word in NUMBER.findall(line)]


def values_of(path, lines: Sequence[str], first: int, columns: int = 0) -> np.ndarray:
    """All numbers from line `first` (from 0) on; columns: how many a line must have, 0: any."""
    values: List[float] = []
    for number, line in enumerate(lines[first:], first + 1):
        row = numbers_of(line)
        if row is None or columns and len(row) not in (0, columns):
            raise SlopeError(f"{path}, line {number}", f"must hold {columns} numbers" if columns else
                             "must hold numbers only", repr(line.strip()[:60]))
        values += row
    return np.array(values)


def check_count(path, values: np.ndarray, count: int) -> None:
    """Raise SlopeError unless there are as many values as the head says."""
    if len(values) != count:
        short = "it is cut short" if len(values) < count else "it has too many"
        raise SlopeError(path, f"must hold the {count} values that its head promises, {short}", len(values))
