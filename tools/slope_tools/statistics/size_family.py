"""By how much the numbers of a family of slides grew with smaller balls: size_family.csv, of tests/size.sh.

A row is the mean of the runs of a slide with balls of one size: balls over its mean thickness, volume to remove and
beyond the road (m3), length (m). Between its sizes a slide's numbers are interpolated in the logarithm of the balls.
"""
import functools
import statistics
from pathlib import Path
from typing import Any, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np

FILE = Path(__file__).with_name("size_family.csv")
FEWEST = 5      # slides; fewer are no family, and their factors no bound
QUANTITIES = {"remove_m3": "remove", "beyond_road_m3": "beyond", "length_m": "length"}     # columns of a study


class Growth(NamedTuple):
    """Factors from so many balls of thickness to the finest of each slide."""
    median: float
    low: float
    high: float
    slides: int         # how many tell
    finest: float       # balls over the thickness, the most of any of them

    def covered(self, value: float) -> float:
        """What the value would be by the largest factor; no less than it is."""
        return value * max(self.high, 1.0)


Slides = Mapping[str, np.ndarray]


@functools.lru_cache(maxsize=1)
def family() -> Slides:
    """That of the file."""
    return read(FILE.read_text(encoding="ascii").splitlines())


def read(lines: Sequence[str]) -> Slides:
    """{slide: a structured array, the fewest balls first} of the lines of such a file."""
    rows: Any = np.atleast_1d(np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="ascii"))
    names = dict.fromkeys(rows["case"].tolist())
    return {name: np.sort(rows[rows["case"] == name], order="balls") for name in names}


def growth(balls: float, quantity: str = "remove_m3", slides: Optional[Slides] = None) -> Optional[Growth]:
    """From so many balls of thickness on, of a column of a study; None where no slide has smaller balls than that.

    A slide whose largest balls are more over its thickness counts from there; one that brings nothing there tells no
    factor. slides: those of family(), unless others are given.
    """
    factors: List[float] = []
    finest: List[float] = []
    for rows in (family() if slides is None else slides).values():
        values = rows[QUANTITIES[quantity]]
        if not balls < rows["balls"][-1]:
            continue
        begin = float(np.interp(np.log(balls), np.log(rows["balls"]), values))
        if begin > 0:
            factors.append(float(values[-1]) / begin)
            finest.append(float(rows["balls"][-1]))
    if not factors:
        return None
    return Growth(statistics.median(factors), min(factors), max(factors), len(factors), max(finest))


def told(balls: float, slides: Optional[Slides] = None, quantity: str = "remove_m3") -> Optional[Growth]:
    """The growth of a quantity; None where fewer than FEWEST slides tell it, which no floor may lean on."""
    found = growth(balls, quantity, slides)
    return found if found and found.slides >= FEWEST else None
