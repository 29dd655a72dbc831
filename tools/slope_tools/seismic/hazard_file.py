"""The curve of a hazard, as users have it: a peak acceleration and how often it is exceeded."""
import csv
import math
import re
from pathlib import Path
from typing import Callable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..errors import SlopeError
from ..heads import Column, acceleration, column, parse_cell
from ..quakes.quake_records import GAL
from .fragility import Hazard

PEAKS = {"peak", "pga", "peak acceleration", "peak ground acceleration", "acceleration", "acc", "a"}
PER_YEAR = {None, "per year", "/year", "/yr", "/y", "/a", "1/year", "1/yr", "1/y", "1/a", "yr-1", "a-1"}
YEARS = {None, "year", "years", "yr", "yrs", "y", "a"}
RATE = re.compile(r"(mean )?(annual |yearly )?(rate|frequency|exceedances?)( rate| frequency)?( of exceedance)?"
                  r"( per year)?|per year|lambda|exceeded per year")
CHANCE = re.compile(r"(annual|yearly) (exceedance )?probability( of exceedance)?|aep")
PERIOD = re.compile(r"(return|recurrence) (period|interval)|t|tr")
LEAST = 30.0        # gal; a curve that ends below says nothing of failures: its peaks are in another unit
RULE = ("columns must be a peak, in gal, g or m/s2, and how often it is exceeded: per year, an annual probability, or "
        "a return period in years")


class Head(NamedTuple):
    """Which columns a file has, and what makes gal and a number per year of them."""
    peak: int = 0
    gal: float = 1.0
    rate: Callable[[float], float] = float


def read_seismic_hazard(path: Path) -> Hazard:
    """Lines "peak,exceedance" (gal, per year), perhaps under a head that says more; SlopeError if it does not fall."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as source:
            lines = source.read().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise SlopeError(path, f"cannot be read ({error})") from None
    head: Optional[Head] = None
    rows: List[List[float]] = []
    place = 0
    for line in lines:
        row = cells(line.lstrip().lstrip("#"))
        if not line.strip() or line.lstrip().startswith("#"):
            if place == 0 and line.strip():
                head = head_of(path, row) or head       # of a comment
            continue
        place += 1
        if place == 1 and all(math.isnan(parse_cell(word)) for word in row):
            head = head_of(path, row)
            if head is None:
                raise SlopeError(f"{path}: row 1", RULE, line.strip()[:60])
            continue
        rows.append(point_of(path, place, row, head or Head(), rows))
    if len(rows) < 2:
        raise SlopeError(path, "must have two rows at least, a peak (gal) and how often it is exceeded per year")
    peaks, rates = np.array(rows).T
    if peaks[-1] < LEAST:
        raise SlopeError(path, f"must have peaks in gal, the largest of at least {LEAST:g}, or a head with their unit, "
                         "such as pga (g),annual rate", f"{peaks[-1]:g}")
    return Hazard(peaks, rates)


def cells(line: str) -> List[str]:
    """The cells of a line of a table."""
    mark = next((mark for mark in ";\t" if mark in line), ",")
    return [word.strip() for word in next(csv.reader([line], delimiter=mark), [])]


def point_of(path: Path, place: int, row: Sequence[str], head: Head, before: Sequence[Sequence[float]]) -> List[float]:
    """Peak (gal) and exceedances per year of a row."""
    values = [parse_cell(word) for word in row]
    if len(values) != 2 or not all(math.isfinite(one) and one > 0 for one in values):
        raise SlopeError(f"{path}: row {place}", "must be a peak (gal) and how often it is exceeded per year, both > 0",
                         ",".join(row)[:60])
    peak, rate = head.gal * values[head.peak], head.rate(values[1 - head.peak])
    if not (math.isfinite(rate) and rate > 0):
        raise SlopeError(f"{path}: row {place}", "an annual probability must be > 0 and < 1", row[1 - head.peak])
    if before and not peak > before[-1][0]:
        raise SlopeError(f"{path}: row {place}", "must have a larger peak than the row before, "
                         f"{before[-1][0]:g} gal", f"{peak:g} gal")
    if before and not rate < before[-1][1]:
        raise SlopeError(f"{path}: row {place}", "must be exceeded less often than the row before, "
                         f"{before[-1][1]:g} per year", f"{rate:g} per year at {peak:g} gal")
    return [peak, rate]


def head_of(path: Path, row: Sequence[str]) -> Optional[Head]:
    """The Head with these names, None if they are no head; SlopeError if their units are others."""
    columns = [column(word) for word in row]
    peak = [k for k, one in enumerate(columns) if one.name.replace("_", " ") in PEAKS]
    if len(columns) != 2 or len(peak) != 1:
        return None
    rate = rate_of(columns[1 - peak[0]])
    if rate is None:
        return None
    unit = columns[peak[0]].unit
    gal = 1.0 if unit is None else (acceleration(unit) or math.nan) / GAL
    of_rate, units = rate
    if math.isnan(gal) or columns[1 - peak[0]].unit not in units:
        raise SlopeError(f"{path}: head", RULE, ",".join(row)[:60])
    return Head(peak[0], gal, of_rate)


def rate_of(column_: Column) -> Optional[Tuple[Callable[[float], float], set]]:
    """What makes a number per year of the values of a column, and the units that it may have; None of another."""
    name = column_.name.replace("_", " ")
    if RATE.fullmatch(name):
        return float, PER_YEAR
    if CHANCE.fullmatch(name):
        return lambda p: -math.log1p(-p) if p < 1 else math.nan, PER_YEAR
    if PERIOD.fullmatch(name):
        return lambda years: 1 / years, YEARS
    return None
