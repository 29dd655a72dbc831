"""How volumes and lengths grow from bodies of few balls to bodies of many: a family of cases, run at several sizes.

size_family.csv beside this module is what tests/size.sh wrote: of each case the mean number of balls over the thickness
of the body, and what came of it, relative to the finest balls. The page on sensitivity has the cases.
"""
import csv
import functools
import math
import statistics
from pathlib import Path
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

TABLE = Path(__file__).with_name("size_family.csv")
REMOVE, BEYOND, LENGTH = "remove", "beyond", "length"       # its columns
# which of them says how a column of the study's table grows
COLUMN = {"remove_m3": REMOVE, "remove_on_road_m3": REMOVE, "beyond_road_m3": BEYOND, "length_m": LENGTH,
          "distance_99_m": LENGTH, "front_m": LENGTH, "centroid_m": LENGTH}


class Growth(NamedTuple):
    """The factors by which the cases grew from a thickness to their finest balls."""
    low: float
    middle: float           # median
    high: float
    cases: int
    balls: float            # thickness (balls) of the finest, the least of them


@functools.lru_cache
def cases() -> Mapping[str, Sequence[Mapping[str, float]]]:
    """{case: rows of the table, from few balls to many}."""
    found: Dict[str, List[Dict[str, float]]] = {}
    with open(TABLE, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            found.setdefault(row.pop("case"), []).append({key: float(value) for key, value in row.items() if value})
    return {name: sorted(rows, key=lambda row: row["balls"]) for name, rows in found.items()}


def growth(balls: float, quantity: str,
           known: Optional[Mapping[str, Sequence[Mapping[str, float]]]] = None) -> Optional[Growth]:
    """From bodies of so many balls of thickness (> 0); quantity: REMOVE, BEYOND or LENGTH; None without cases.

    Between the sizes of a case its values are interpolated by the logarithms of both; below its coarsest one that
    counts, and from 16 balls on nothing grows that was seen.
    """
    factors, finest = [], []
    for rows in (known or cases()).values():
        line = [(row["balls"], row[quantity]) for row in rows if row.get(quantity, 0) > 0]
        if len(line) > 1:
            factors.append(line[-1][1] / value_at(balls, line))
            finest.append(line[-1][0])
    if not factors:
        return None
    return Growth(min(factors), statistics.median(factors), max(factors), len(factors), min(finest))


def value_at(balls: float, line: Sequence[Tuple[float, float]]) -> float:
    """Of (thickness, value), rising in thickness, at one."""
    if balls <= line[0][0]:
        return line[0][1]
    for (low, first), (high, second) in zip(line, line[1:]):
        if balls <= high:
            part = math.log(balls / low) / math.log(high / low)
            return math.exp((1 - part) * math.log(first) + part * math.log(second))
    return line[-1][1]
