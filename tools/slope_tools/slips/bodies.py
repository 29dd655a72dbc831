"""The bodies that `find_slip` kept: PREFIX.slips.csv and PREFIX.N.base.asc."""
import csv
import math
import re
from pathlib import Path
from typing import Dict, List, NamedTuple, Sequence, Tuple

import numpy as np

from ..errors import SlopeError
from ..survey import rasters
from . import columns

END = ".slips.csv"
NUMBERS = ("x", "y", "z", "radius", "direction", "volume")
SAME_BASE = 0.05        # m; a base that is more below the surface is none
ON_ROCK = 1e-3          # m; where a base is more above the surface it is the bedrock
SAME_VOLUME = 0.05      # a larger difference means another terrain


class Body(NamedTuple):
    name: str               # its rank, 1 is the one with the least factor of safety
    direction: float        # of sliding, degrees counterclockwise from +x
    columns: columns.Columns
    base: Path = Path()     # the file of its surface


def table_of(path: Path) -> Path:
    """PREFIX.slips.csv of that name, or the one in a folder."""
    if path.is_file():
        return path
    found = sorted(path.glob("*" + END)) if path.is_dir() else []
    if len(found) != 1:
        raise SlopeError(path, f"must be PREFIX{END} of find_slip, or a folder with one", f"{len(found)} files")
    return found[0]


def rows_of(path: Path, names: Sequence[str] = NUMBERS, unknown: Sequence[str] = ()) -> List[Dict[str, float]]:
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
    found = []
    for place, row in enumerate(rows, 2):
        one = {}
        for name in ("rank", *names, *unknown):
            try:
                one[name] = float(row.get(name) or "")
            except ValueError:
                one[name] = math.nan
            if name not in unknown and not math.isfinite(one[name]):
                raise SlopeError(f"{path}: line {place}", f"must have a number in the column {name}", row.get(name))
        for name, default in columns.SPHERE._asdict().items():
            try:
                one[name] = float(row.get(name, default))
            except ValueError:
                raise SlopeError(f"{path}: line {place}", f"must have a number in the column {name}",
                                 row[name]) from None
        found.append(one)
    return found


def shape_of(row: Dict[str, float]) -> columns.Shape:
    return columns.Shape(*(row[name] for name in columns.Shape._fields))


def mask_of(path: Path) -> np.ndarray:
    """The cells of a body: those with a value in PREFIX.N.base.asc."""
    return np.isfinite(rasters.read(path).z)


def base_file(path: Path, rank: int) -> Path:
    """PREFIX.N.base.asc of a body in a table, or in a folder with one."""
    source = table_of(path)
    known = [int(row["rank"]) for row in rows_of(source)]
    if rank not in known:
        raise SlopeError("--body", f"must be one of {source}, {', '.join(map(str, known))}", rank)
    found = source.with_name(f"{prefix_of(source)}.{rank}.base.asc")
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
    return [base_file(path, int(row["rank"])) for row in rows_of(table_of(path))]


def prefix_of(table: Path) -> str:
    return table.name[:-len(END)] if table.name.endswith(END) else table.stem


def read(path: Path, terrain: Path, density: float) -> List[Body]:
    """The bodies of a table on their terrain; density kg/m3.

    Columns have the exact base of the surface within the raster of the body, or the raster where that is higher, on
    bedrock. SlopeError for another terrain or base.
    """
    source = table_of(path)
    ground = rasters.read_asc_local(terrain)
    found = []
    for row in rows_of(source):
        rank = f"{row['rank']:g}"
        file = source.with_name(f"{prefix_of(source)}.{rank}.base.asc")
        inside, rock = cells_of(ground, row, file)
        body = columns.of_surface(ground, centre_of(row), row["radius"], row["direction"], density, inside,
                                  shape=shape_of(row), rock=rock)
        if not abs(body.volume / row["volume"] - 1) <= SAME_VOLUME:
            raise SlopeError(terrain, f"must be the terrain of {source.name}, on which body {rank} has "
                             f"{row['volume']:.5g} m3", f"{body.volume:.5g} m3")
        found.append(Body(rank, row["direction"], body, file))
    return found


def centre_of(row: Dict[str, float]) -> Tuple[float, float, float]:
    return row["x"], row["y"], row["z"]


def cells_of(ground: rasters.Raster, row: Dict[str, float], file: Path):
    """The mask of a body in PREFIX.N.base.asc, and the heights of the bedrock that cuts it, NaN elsewhere."""
    base = rasters.read(file)
    if base.z.shape != ground.z.shape or not base.transform.almost_equals(ground.transform, 1e-6):
        raise SlopeError(file, "must be on the cells of the terrain")
    inside = columns.largest(ground, base.z)
    over = base.z - columns.base_of(ground, centre_of(row), row["radius"], row["direction"], shape_of(row))
    if not np.nanmin(over[inside]) >= -SAME_BASE:
        raise SlopeError(file, f"must not be below the surface of body {row['rank']:g} by more than {SAME_BASE:g} m",
                         f"{-np.nanmin(over[inside]):.3g} m")
    return inside, np.where(over > ON_ROCK, base.z, np.nan)
