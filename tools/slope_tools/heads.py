"""The head of a table: the names of its columns, and their units."""
import math
import re
from typing import NamedTuple, Optional

BRACKETS = re.compile(r"(.*?)[\s_]*[(\[\uff08]\s*(.*?)\s*[)\]\uff09]")
LENGTHS = {"m": 1.0, "metre": 1.0, "metres": 1.0, "meter": 1.0, "meters": 1.0}
TIMES = {"s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3,
         "millisecond": 1e-3, "milliseconds": 1e-3}     # s
GRAVITY = 9.80665       # m/s2, standard
ACCELERATIONS = {"m/s2": 1.0, "m/s/s": 1.0, "g": GRAVITY, **dict.fromkeys(("gal", "gals", "cm/s2", "cm/s/s"), 0.01),
                 **dict.fromkeys(("mm/s2", "mm/s/s"), 1e-3)}      # m/s2
DEGREES = ("deg", "degree", "degrees", "\u00b0")


class Column(NamedTuple):
    """The name of a column, in lower case, and its unit if one is in brackets or after the name."""
    name: str
    unit: Optional[str] = None


def column(word: str) -> Column:
    """Of a word such as "EW (gal)", 'x [m]', or easting_m."""
    plain = " ".join(word.strip().strip("\"'").lower().split())
    found = BRACKETS.fullmatch(plain)
    if found:
        return Column(found[1], found[2] or None)
    name, _, last = plain.replace("_", " ").rpartition(" ")
    if name and (last in (*LENGTHS, *TIMES, *DEGREES, "ft", "us-ft", "feet", "km") or acceleration(last)):
        return Column(name, last)
    return Column(plain)


def acceleration(text: str) -> Optional[float]:
    """m/s2 of a unit as it is written, such as cm/sec**2; None of another."""
    plain = re.sub(r"\*\*|\^", "", text.lower().replace("\u00b2", "2").replace("sec", "s"))
    return ACCELERATIONS.get(plain.rstrip(".,"))


def parse_cell(word: str) -> float:
    """The number of a cell, nan if it is none; Python would take 1_5 for 15."""
    try:
        return float(word) if "_" not in word else math.nan
    except ValueError:
        return math.nan


def is_number(word: str) -> bool:
    """Whether it is a finite one."""
    return math.isfinite(parse_cell(word))
