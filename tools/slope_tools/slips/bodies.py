"""The bodies that `find_slip` kept: PREFIX.slips.csv, PREFIX.N.base.asc and PREFIX.N.columns.csv."""
import csv
import math
import re
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..errors import SlopeError
from ..heads import parse_cell
from ..survey import rasters
from . import columns

END = ".slips.csv"
BASE, COLUMNS = ".base.asc", ".columns.csv"
NUMBERS = ("x", "y", "z", "radius", "direction", "volume", "area")
SAME_AREA = 1e-6        # rounding of the sum of the columns


class Body(NamedTuple):
    name: str               # its rank, 1 is the one with the least factor of safety
    direction: float        # of sliding, degrees counterclockwise from +x
    columns: columns.Columns
    base: Path              # the file of its surface
    cells: int              # of the terrain


def table_of(path: Path) -> Path:
    """PREFIX.slips.csv of that name, or the one in a folder."""
    if path.is_file():
        return path
    found = sorted(path.glob("*" + END)) if path.is_dir() else []
    if len(found) != 1:
        raise SlopeError(path, f"must be PREFIX{END} of find_slip, or a folder with one", f"{len(found)} files")
    return found[0]


def read_body_rows(path: Path, names: Sequence[str] = NUMBERS, unknown: Sequence[str] = ()) -> List[Dict[str, float]]:
    """The rows of the table, with the rank, these columns and columns.Shape's; those of `unknown` may have NaN.

    A table without columns.Shape's is of spheres.
    """
    try:
        with open(path, newline="", encoding="utf-8") as source:
            rows = list(csv.DictReader(source))
    except (OSError, UnicodeDecodeError) as error:
        raise SlopeError(path, f"cannot be read ({error})") from None
    if not rows:
        raise SlopeError(path, "must hold a surface, it has none")
    bodies = []
    for place, row in enumerate(rows, 2):
        numbers = {}
        for name in ("rank", *names, *unknown):
            numbers[name] = parse_cell(row.get(name) or "")
            if name not in unknown and not math.isfinite(numbers[name]):
                raise SlopeError(f"{path}: line {place}", f"must have a number in the column {name}", row.get(name))
        for name, default in columns.SPHERE._asdict().items():
            try:
                numbers[name] = float(row.get(name, default))
            except ValueError:
                raise SlopeError(f"{path}: line {place}", f"must have a number in the column {name}",
                                 row[name]) from None
        bodies.append(numbers)
    return bodies


def shape_of(row: Dict[str, float]) -> columns.Shape:
    return columns.Shape(*(row[name] for name in columns.Shape._fields))


def mask_of(path: Path) -> np.ndarray:
    """The cells of a body: those with a value in PREFIX.N.base.asc."""
    return np.isfinite(rasters.read_raster(path).z)


def base_file(path: Path, rank: int) -> Path:
    """PREFIX.N.base.asc of a body in a table, or in a folder with one."""
    source = table_of(path)
    known = [int(row["rank"]) for row in read_body_rows(source)]
    if rank not in known:
        raise SlopeError("--body", f"must be one of {source}, {', '.join(map(str, known))}", rank)
    found = name_body_file(source, rank, BASE)
    if not found.is_file():
        raise SlopeError(found, "must be an existing file, beside the table")
    return found


def rank_of(base: Path) -> int:
    """Of the name of PREFIX.N.base.asc: N."""
    found = re.search(r"\.([0-9]+)\.base\.asc$", base.name)
    if found is None:
        raise SlopeError(base, "must be named PREFIX.N.base.asc, as find_slip names it")
    return int(found[1])


def base_files(path: Path) -> List[Path]:
    """PREFIX.N.base.asc of all bodies in a table, or in a folder with one."""
    return [base_file(path, int(row["rank"])) for row in read_body_rows(table_of(path))]


def name_body_file(table: Path, rank: int, end: str) -> Path:
    """A file of a body, beside the table."""
    prefix = table.name[:-len(END)] if table.name.endswith(END) else table.stem
    return table.with_name(f"{prefix}.{rank}{end}")


def columns_file(table: Path, rank: int) -> Path:
    """PREFIX.N.columns.csv of a body in a table."""
    found = name_body_file(table, rank, COLUMNS)
    if not found.is_file():
        raise SlopeError(found, "must be an existing file, which find_slip writes since 27 November 2026: search again")
    return found


def read_slip_bodies(path: Path, density: Optional[float] = None) -> List[Body]:
    """The bodies of a table, or of a folder with one; density as in read_body_columns()."""
    source = table_of(path)
    found = []
    for row in read_body_rows(source):
        file = base_file(source, int(row["rank"]))
        found.append(Body(f"{row['rank']:g}", row["direction"], read_body_columns(source, row, density), file,
                          int(mask_of(file).sum())))
    return found


def read_body_columns(table: Path, row: Dict[str, float], density: Optional[float] = None,
                      direction: Optional[float] = None, level: Optional[Callable] = None) -> columns.Columns:
    """The columns with which find_slip computed the body of a row; without the options as find_slip had it.

    density: kg/m3, of the body as a whole; direction: of sliding; level: of the water, see columns.read_slip_columns().
    """
    file = columns_file(table, int(row["rank"]))
    found = columns.read_slip_columns(file, row["direction"] if direction is None else direction, level)
    if not abs(found.area.sum() / row["area"] - 1) <= SAME_AREA:
        raise SlopeError(file, f"must be of the body of {table.name}, which has {row['area']:.8g} m2 in plan",
                         f"{found.area.sum():.8g} m2")
    scale = 1.0 if density is None else density * columns.GRAVITY * row["volume"] / found.weight.sum()
    return found._replace(volume=row["volume"], weight=scale * found.weight)


def centre_of(row: Dict[str, float]) -> Tuple[float, float, float]:
    return row["x"], row["y"], row["z"]
