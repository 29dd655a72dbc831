"""Heights of grids in text.

GDAL gives shape and place of such a grid and its CRS (.prj). Of the values it takes words for 0, fills up a short last
row with 0 and ignores what comes after the last. Here each of these is an error with its line.
"""
import math
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from .. import heads
from ..errors import SlopeError
from .grids import progress
from .zips import open_text

ESRI_NODATA = -9999     # ESRI's default
HEADER = {"ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "dx", "dy", "nodata_value"}
# keys that say the same
AGAIN = {"xllcorner": {"xllcenter"}, "xllcenter": {"xllcorner"}, "yllcorner": {"yllcenter"}, "yllcenter": {"yllcorner"},
         "cellsize": {"dx", "dy"}, "dx": {"cellsize"}, "dy": {"cellsize"}}
NULL = "*"              # GRASS' mark of no value
# the last line of the head of others, in lower case, and how many of these there are; those without have no head
HEADS = {"GSAG": ("dsaa", 1), "ISG": ("end_of_head", 1), "ZMap": ("@", 2), "GXF": ("#grid", 1)}

# keys of heads that have the value first, as a grid that GDAL reads has them
TURNED = {"ncols": "ncols", "mx": "ncols", "nrows": "nrows", "my": "nrows", "xllcorner": "xllcorner",
          "yllcorner": "yllcorner", "xllcenter": "xllcenter", "yllcenter": "yllcenter", "xlower": "xllcenter",
          "ylower": "yllcenter", "cellsize": "cellsize", "dx": "dx", "dy": "dy", "nodata_value": "NODATA_value"}


class Head(NamedTuple):
    """Of a grid whose values are read here."""
    lines: int                      # that it has
    nodata: Optional[float]
    factor: float = 1.0             # of the values
    null: str = ""                  # a word that stands for no value


def heights(path: str, driver: str, rows: int, columns: int, top: int = 0,
            bottom: int = -1) -> Optional[Tuple[np.ndarray, Optional[float]]]:
    """Heights of an ESRI or GRASS grid of that shape, NaN where there is none, and its mark of NODATA.

    top, bottom: of the rows from one to before another one.

    None of another format, whose words are looked for.
    """
    if driver in HEADS:
        check_numbers(path, driver)
    if driver not in ("AAIGrid", "GRASSASCIIGrid"):
        return None
    with open_text(path) as lines:
        head = (esri_head if driver == "AAIGrid" else grass_head)(path, lines)
        lines.seek(0)
        first, last = top * columns, (rows if bottom < 0 else bottom) * columns
        z = np.empty(last - first)
        count, line_count, odd_line = 0, 0, None
        for number, line in enumerate(progress(lines, f"reading {path}", total=rows), 1):
            words = line.split()
            if number <= head.lines or not words:
                continue
            values = read_line_numbers(path, number, words, head.null)
            if len(values) != columns and odd_line is None:
                odd_line = f"line {number}, which has {len(values)}"
            begin, end = max(count, first), min(count + len(values), last)
            if begin < end:
                z[begin - first:end - first] = values[begin - count:end - count]
            count += len(values)
            line_count += 1
    # Rows may be wrapped, as ESRI allows; but as many lines as rows, of different lengths, are broken rows.
    if count != rows * columns or (odd_line and line_count == rows):
        where = f"first at {odd_line}" if odd_line else f"in {line_count} rows"
        raise SlopeError(f"{path}: values", f"must be {rows} rows of {columns}, {rows * columns} values",
                         f"{count}, {where}")
    return z.reshape(-1, columns) * head.factor, head.nodata


def read_line_numbers(path: str, line: int, words: List[str], null: str = "") -> List[float]:
    """The numbers of a line, NaN for a mark of none; SlopeError where it holds something else."""
    try:
        if "_" in " ".join(words):     # Python's float takes 1_5 for 15
            raise ValueError(f"no number: {next(word for word in words if '_' in word)!r}")
        return [math.nan if word == null else float(word) for word in words] if null else [*map(float, words)]
    except ValueError as error:
        raise SlopeError(f"{path}: line {line}", "must hold numbers with a decimal point",
                         str(error).rsplit(":", 1)[1].strip()) from None


def esri_head(path: str, lines: Any) -> Head:
    """The head of an ESRI ASCII grid.

    GDAL takes words for 0 here too, and puts a grid with xllcorner and yllcenter, or without one of them, at 0 0.
    """
    header: Dict[str, float] = {}
    number = 0
    for line in lines:
        words = line.split()
        if words and words[0].lower() not in HEADER:
            break
        number += 1
        if not words:
            continue
        try:
            key, word = words
            value = float(word.replace("_", "?"))       # Python takes 1_5 for 15
        except ValueError:
            raise SlopeError(f"{path}: line {number}", "must be a name and a number", line) from None
        if key.lower() in header:
            raise SlopeError(f"{path}: line {number}", f"header key {key} is given twice")
        if other := AGAIN.get(key.lower(), set()) & header.keys():
            raise SlopeError(f"{path}: line {number}", f"{min(other)} and {key} are both given")
        header[key.lower()] = value
    if not ({"xllcorner", "yllcorner"} <= header.keys() or {"xllcenter", "yllcenter"} <= header.keys()):
        raise SlopeError(f"{path}: header", "must have xllcorner and yllcorner, or xllcenter and yllcenter")
    for key in ("cellsize", "dx", "dy"):
        if not 0 < header.get(key, 1) < math.inf:
            raise SlopeError(f"{path}: header: {key}", "must be > 0", f"{header[key]:g}")
    return Head(number, header.get("nodata_value", ESRI_NODATA))


def grass_head(path: str, lines: Any) -> Head:
    """The head of a GRASS grid, as r.out.ascii writes it: `key: value` in its lines."""
    head = {"null": None, "multiplier": 1.0}
    number = 0
    for line in lines:
        key, colon, value = line.partition(":")
        if not colon and line.strip():
            break
        number += 1
        if key.strip().lower() in head:
            head[key.strip().lower()] = None if value.strip() == NULL else read_line_numbers(path, number,
                                                                                             value.split())[0]
    return Head(number, head["null"], head["multiplier"] or 1.0, NULL)


def check_numbers(path: str, driver: str) -> None:
    """Raise SlopeError if the values of a grid that GDAL reads are not all numbers."""
    end, times = HEADS[driver]
    width, packed = 0, False
    with open_text(path) as lines:
        for number, line in enumerate(lines, 1):
            if times:
                if driver == "ZMap" and times == 1 and not width:       # fields of a width, which may touch
                    width = int(read_line_numbers(path, number, [line.split(",")[0].strip()])[0])
                packed = packed or driver == "GXF" and line.lower().startswith("#gtype")
                times -= line.strip().lower().startswith(end)
            elif packed or line.startswith("#"):
                break
            else:
                words = [line[k:k + width] for k in range(0, len(line), width)] if width else line.split()
                read_line_numbers(path, number, [word.strip() for word in words if word.strip()])


def suggest_grid_remedy(path: str) -> str:
    """What can be done about a grid whose head has each value before its key, as GeoClaw and D-Claw write it, for a
    message; "" of any other."""
    try:
        with open(path, encoding="ascii") as lines:
            head = [line.split()[:2] for _, line in zip(range(6), lines)]
    except (OSError, UnicodeDecodeError):
        return ""
    turned = [f"{TURNED[words[1].lower()]} {words[0]}" for words in head
              if len(words) == 2 and words[1].lower() in TURNED and heads.is_number(words[0])]
    return f"; its head has the values before the keys, as GeoClaw: write {', '.join(turned)}, a line each" * (
        len(turned) >= 4)
