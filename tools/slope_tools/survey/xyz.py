"""Heights of a grid as a list of its points: x y z in lines, in any order, with gaps, under a head or without one.

GDAL's reader knows no northing that comes first, wants the points in rows or columns, and takes words for 0.
"""
import itertools
import re
from typing import Iterator, List, NamedTuple, Optional, Tuple

import numpy as np
from affine import Affine

from ..errors import SlopeError
from . import text_points
from .grids import check_memory, progress
from .zips import MESHES, OF_POINTS, open_text

LONGEST = 1000          # letters of a line; binary files may have none
SNIFFED = 20            # lines that show whether it is such a list
LINES = 100_000         # read at a time
NOISE = 1e-6            # of a side, by which equal coordinates may differ
ON_GRID = 0.1           # of a step, by which rounded coordinates may be off their grid
FULL = 0.2              # of a grid's cells have a point, at least, or
BESIDE = 0.5            # of its points have the next one of their row or column, too
NUMBER = r"[-+]?(\d+([.,]\d+)?|[.,]\d+)(e[-+]?\d+)?"
DECIMAL_COMMAS = re.compile(rf"\s*{NUMBER}(\s+{NUMBER}){{2,}}\s*", re.IGNORECASE)
RULE = ("the head must name the columns: x, y, z; east, north, height; Rechtswert, Hochwert; lon, lat; in any order, "
        "with others beside them")


class Form(NamedTuple):
    """How the lines of such a list are to be read."""
    head: Optional[text_points.Head]        # None: x, y, z, perhaps behind a number
    skip: int               # lines before the first point
    delimiter: Optional[str]
    comma: bool             # of decimals
    columns: int


class Grid(NamedTuple):
    """Heights of a list, NaN where it has no point."""
    z: np.ndarray
    transform: Affine
    unit: Optional[str]     # of the heights, as the head says it
    degrees: bool           # the head says that the coordinates are


def form_of(path: str) -> Optional[Form]:
    """The Form of a file, None if it is no such list; SlopeError if it is one whose head names no coordinates."""
    if path.lower().endswith(MESHES):       # v x y z
        return None
    with open_text(path) as lines:
        first = [line for line in (lines.readline(LONGEST) for _ in range(SNIFFED)) if line]
    if any("\0" in line for line in first) or first and first[0].lstrip("\ufeff ").startswith("<"):      # XML: a VRT
        return None
    head: Optional[text_points.Head] = None
    worded: Optional[Tuple[int, bool,
                           str]] = None    # of a line of words: its number, whether it may be a head, its text
    for number, content in enumerate(map(str.strip, first)):
        words, delimiter, comma = split(content)
        numbers = [text_points.parse_coordinate(word.replace(",", ".")) is not None for word in words]
        if is_point(numbers, head):
            if worded is not None and not head:
                if not worded[1]:
                    return None
                raise SlopeError(f"{path}: line {worded[0]}", RULE, worded[2])
            if not head and not numbers[0]:     # names of the points
                head = text_points.Head(1, 2, len(words), None, 3)
            return Form(head, number, delimiter, comma, len(words))
        if not content:
            continue
        is_comment = content.startswith("#")
        if worded is not None and not is_comment:
            return None         # two lines of words
        names = text_points.SEPARATORS.split(content.lstrip("# ")) if is_comment or delimiter is None else words
        head = len(names) >= 3 and head_of(path, number + 1, names, content) or head
        worded = worded if is_comment else (number + 1, len(names) >= 3, content[:60])
    return None


def is_point(numbers: List[bool], head: Optional[text_points.Head]) -> bool:
    """Whether the words of a line, of which these are numbers, are a point under a head, or without one."""
    if head is None:
        return len(numbers) >= 3 and all(numbers[:3]) or len(numbers) >= 4 and all(numbers[1:4])
    wanted = [k for k in (head.x, head.y, head.z) if k is not None]
    return len(numbers) > max(wanted) and all(numbers[k] for k in wanted)


def head_of(path: str, number: int, names: List[str], content: str) -> Optional[text_points.Head]:
    """The Head of a line that names columns, None if it does not name all that are needed."""
    def wrong_unit():
        raise SlopeError(f"{path}: line {number}", "columns must be in m or degrees", content[:60])
    found = text_points.head_of(names, wrong_unit, others=True)
    return found if found and found.z is not None else None


def split(line: str) -> Tuple[List[str], Optional[str], bool]:
    """The words of a line, what is between them (None: blanks), and whether decimals may have commas."""
    for delimiter in (";", "\t"):
        if delimiter in line:
            return [word.strip() for word in line.split(delimiter)], delimiter, True
    if "," in line and not DECIMAL_COMMAS.fullmatch(line):
        return [word.strip() for word in line.split(",")], ",", False
    return line.split(), None, "," in line


def read_xyz_grid(path: str, form: Form) -> Grid:
    """The grid of a list; SlopeError if its points are on none."""
    head = form.head or text_points.Head(0, 1, form.columns, None, 2)
    assert head.z is not None
    wanted = [head.x, head.y, head.z]
    points = read_xyz_columns(path, form, wanted if form.head or form.columns < 4 else [0, 1, 2, 3])
    cells = on_grid(points[:, :3])
    if cells is None and points.shape[1] == 4:      # a number first
        cells = on_grid(points[:, 1:])
    if cells is None:
        raise SlopeError(path, f"must be heights in rows and columns, at equal distances; {OF_POINTS}",
                         f"{len(points):,} points on no grid")
    column, row, transform, z = cells
    rows, columns = int(row.max()) + 1, int(column.max()) + 1
    check_memory(rows, columns, path)
    grid = np.full((rows, columns), np.nan)
    grid[row, column] = z
    twice = np.flatnonzero(np.abs(grid[row, column] - z) > 0)
    if twice.size:
        x, y = transform @ (column[twice[0]] + 0.5, row[twice[0]] + 0.5)
        raise SlopeError(path, f"must have one height at {x:.10g} {y:.10g}", f"{z[twice[0]]:g} and "
                         f"{grid[row, column][twice[0]]:g}")
    return Grid(grid, transform, head.z_unit, head.unit == "degrees")


def read_xyz_columns(path: str, form: Form, columns: List[int]) -> np.ndarray:
    """These columns of all points, an array (points, columns)."""
    blocks = [np.empty((0, len(columns)))]
    with open_text(path) as lines:
        for _ in range(form.skip):
            next(lines)
        for number, chunk in enumerate(progress(chunks(lines), f"reading {path}")):
            text = [line.replace(",", ".") for line in chunk] if form.comma else chunk
            try:
                blocks.append(np.loadtxt(text, delimiter=form.delimiter, usecols=columns, ndmin=2, comments="#"))
            except (ValueError, IndexError):
                raise wrong_line(path, text, form, columns, form.skip + 1 + number * LINES) from None
            check_memory(1, sum(map(len, blocks)), path)
    points = np.concatenate(blocks)
    if not np.isfinite(points[:, :2]).all():
        raise SlopeError(path, "must have finite coordinates")
    return points


def chunks(lines: Iterator[str]) -> Iterator[List[str]]:
    return iter(lambda: list(itertools.islice(lines, LINES)), [])


def wrong_line(path: str, lines: List[str], form: Form, columns: List[int], first: int) -> SlopeError:
    """The SlopeError on the first of these lines that has a wrong number."""
    for number, line in enumerate(lines, first):
        words = line.partition("#")[0].strip()
        if not words:
            continue
        fields = [word.strip() for word in words.split(form.delimiter)]
        if len(fields) <= max(columns) or any(text_points.parse_coordinate(fields[k]) is None for k in columns):
            return SlopeError(f"{path}: line {number}", "must hold numbers, x, y and z, where the first line has them",
                              words[:60])
    return SlopeError(path, "must hold numbers, x, y and z, in its lines")


def on_grid(points: np.ndarray) -> Optional[Tuple[np.ndarray, np.ndarray, Affine, np.ndarray]]:
    """Column and row of each point (x, y, z), the transform of the grid, and z; None if the points are on no grid."""
    sides = [steps(values) for values in points.T[:2]]
    if len(points) < 4 or None in sides:
        return None
    (west, dx, columns), (south, dy, rows) = sides      # type: ignore[misc]
    if abs(dx - dy) * max(columns, rows) < ON_GRID * dx:        # the same but for rounding: the longer side knows best
        dx = dy = dx if columns > rows else dy
    column, row = (points[:, 0] - west) / dx, rows - 1 - (points[:, 1] - south) / dy
    near = np.round(column), np.round(row)
    if max(np.abs(column - near[0]).max(), np.abs(row - near[1]).max()) > ON_GRID:
        return None
    column, row = (one.astype(np.int64) for one in near)
    there = [np.unique(row * (columns + 1) + column), np.unique(column * (rows + 1) + row)]
    is_full = len(there[0]) >= FULL * columns * rows
    if not is_full and max((np.diff(one) == 1).mean() for one in there) < BESIDE * (1 - 1 / min(columns, rows)):
        return None     # irregular points are on the grid of their last digit
    return column, row, Affine(dx, 0, west - dx / 2, 0, -dy, south + (rows - 0.5) * dy), points[:, 2]


def steps(values: np.ndarray) -> Optional[Tuple[float, float, int]]:
    """First value, step and number of values at equal distances, some of which may be missing."""
    distinct = np.unique(values)
    if len(distinct) < 2 or not np.isfinite(distinct).all():
        return None
    gaps = np.diff(distinct)
    span = distinct[-1] - distinct[0]
    least = gaps[gaps > span * NOISE].min()
    short = gaps[np.abs(gaps - least) < 0.5 * least]
    number = round(span / short.mean())
    return float(distinct[0]), float(span / number), number + 1
