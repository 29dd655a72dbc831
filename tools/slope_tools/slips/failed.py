"""The body of a back-analysis: a sphere, the first body of find_slip, or the ground that a collapse left."""
import math
from pathlib import Path
from typing import NamedTuple, Optional

import numpy as np

from ..errors import SlopeError
from ..survey import beside
from ..survey.rasters import Raster
from ..survey.resampling import sample
from . import back, bodies, columns

LEAST = 0.05        # m; a thinner column is noise of the raster


class Failed(NamedTuple):
    columns: columns.Columns
    cells: int                          # of the terrain
    far: Optional[columns.Columns]      # of a raster: the same about a far axis
    direction: float                    # of sliding, degrees counterclockwise from +x
    centre: np.ndarray                  # of the sphere, or a point of the axis of moments
    radius: float                       # m; inf: the base is no hollow, and the axis is the far one
    alone: int = 0                      # cells of a raster whose dip is in part that of others, see columns.slopes()


def parse_sphere(text: str):
    """X,Y,Z,R as numbers; None if it is something else."""
    try:
        found = [float(word) for word in text.split(",")]
    except ValueError:
        return None
    return found if len(found) == 4 and all(map(math.isfinite, found)) and found[3] > 0 else None


def of_sphere(raster: Raster, centre, radius: float, direction: Optional[float], density: float, table,
              rock=None) -> Failed:
    base = columns.limit_by_rock(columns.base_of(raster, centre, radius), rock)
    inside = columns.find_largest_part(raster, base)
    way = back.steepest(raster, base, inside, centre) if direction is None else direction
    return Failed(columns.of_sphere(raster, centre, radius, way, density, table, rock), int(inside.sum()), None, way,
                  np.asarray(centre, float), radius)


def of_search(path: Path, raster: Raster, direction: Optional[float], density: float, table) -> Failed:
    """The first body of find_slip, with the water that it had, or below a table on the terrain's cells."""
    source = bodies.table_of(path)
    row = bodies.read_body_rows(source)[0]
    x, y, z = centre = bodies.centre_of(row)

    def level(dx, dy):
        return sample(raster._replace(z=table), x + dx, y + dy) - z

    found = bodies.read_body_columns(source, row, density, direction, None if table is None else level)
    return Failed(found, int(bodies.mask_of(bodies.base_file(source, int(row["rank"]))).sum()), None,
                  row["direction"] if direction is None else direction, np.asarray(centre), row["radius"])


def of_base(raster: Raster, path: Path, direction: Optional[float], density: float, table) -> Failed:
    """Of a raster with the heights of the ground without the body, on the cells of the terrain."""
    found = beside.read_raster_beside(path, raster, local=beside.Local(guessed=True))
    if not beside.has_cells(found, raster):
        raise SlopeError(path, "must be on the cells of the terrain")
    base = beside.on_cells(path, found, raster)
    inside = columns.find_largest_part(raster, base + LEAST)
    points = back.list_base_points(raster, base, inside)
    centre, radius = back.sphere_of(points)
    way = back.steepest(raster, base, inside, centre) if direction is None else direction

    def about(axis):
        return columns.of_raster(raster, base, inside, axis, way, density, table)

    far = None if math.isinf(radius) else about(back.far_centre(points))
    return Failed(about(centre), int(inside.sum()), far, way, centre, radius,
                  columns.count_alone(inside))


def read_failed_body(text: str, raster: Raster, direction: Optional[float], density: float,
                     table: Optional[np.ndarray] = None, rock: Optional[np.ndarray] = None) -> Failed:
    """The body that BODY names: X,Y,Z,R; the table of find_slip or a folder with it; a raster.

    direction: degrees counterclockwise from +x; None: where the weight has the largest moment about the centre. table,
    rock: heights of the water table, and of the bedrock that cuts a sphere; what find_slip wrote has its own.
    """
    if parse_sphere(text):
        *centre, radius = parse_sphere(text)
        return of_sphere(raster, centre, radius, direction, density, table, rock)
    path = Path(text)
    if rock is not None:
        raise SlopeError("--bedrock", "must be given with X,Y,Z,R, as other bodies are as cut", text)
    if path.is_dir() or path.suffix == ".csv":
        return of_search(path, raster, direction, density, table)
    if not path.is_file():
        raise SlopeError("--failed", "must be X,Y,Z,R of a sphere (m), what find_slip wrote, or a raster of the ground "
                         "without the body", text)
    return of_base(raster, path, direction, density, table)
