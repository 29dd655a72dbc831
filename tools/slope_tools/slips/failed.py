"""The body of a back-analysis: a sphere, the first body of find_slip, or the ground that a collapse left."""
import math
from pathlib import Path
from typing import NamedTuple, Optional

import numpy as np

from ..errors import SlopeError
from ..survey import rasters
from ..survey.rasters import Raster
from . import back, bodies, columns

LEAST = 0.05        # m; a thinner column is noise of the raster


class Failed(NamedTuple):
    columns: columns.Columns
    far: Optional[columns.Columns]      # of a raster: the same about a far axis
    direction: float                    # of sliding, degrees counterclockwise from +x
    centre: np.ndarray                  # of the sphere, or a point of the axis of moments
    radius: float                       # m; inf: the base is no hollow, and the axis is the far one


def numbers(text: str):
    """X,Y,Z,R as numbers; None if it is something else."""
    try:
        found = [float(word) for word in text.split(",")]
    except ValueError:
        return None
    return found if len(found) == 4 and all(map(math.isfinite, found)) and found[3] > 0 else None


def of_surface(raster: Raster, centre, radius: float, direction: Optional[float], density: float, table,
               shape: columns.Shape = columns.SPHERE, rock=None) -> Failed:
    base = columns.above(columns.base_of(raster, centre, radius, direction or 0.0, shape), rock)
    inside = columns.largest(raster, base)
    way = back.steepest(raster, base, inside, centre) if direction is None else direction
    return Failed(columns.of_surface(raster, centre, radius, way, density, inside, table, shape, rock), None, way,
                  np.asarray(centre, float), radius)


def of_base(raster: Raster, path: Path, direction: Optional[float], density: float, table) -> Failed:
    """Of a raster with the heights of the ground without the body, on the cells of the terrain."""
    base = rasters.read(path)
    if base.z.shape != raster.z.shape or not base.transform.almost_equals(raster.transform, 1e-6):
        raise SlopeError(path, "must be on the cells of the terrain")
    inside = columns.largest(raster, base.z + LEAST) & np.isfinite(np.gradient(base.z)).all(axis=0)
    points = back.points_of(raster, base.z, inside)
    centre, radius = back.sphere_of(points)
    way = back.steepest(raster, base.z, inside, centre) if direction is None else direction

    def about(axis):
        return columns.of_raster(raster, base.z, inside, axis, way, density, table)

    far = None if math.isinf(radius) else about(back.far_centre(points))
    return Failed(about(centre), far, way, centre, radius)


def read(text: str, raster: Raster, direction: Optional[float], density: float,
         table: Optional[np.ndarray] = None, rock: Optional[np.ndarray] = None) -> Failed:
    """The body that BODY names: X,Y,Z,R; the table of find_slip or a folder with it; a raster.

    direction: degrees counterclockwise from +x; None: where the weight has the largest moment about the centre. table,
    rock: heights of the water table, and of the bedrock that cuts a sphere; what find_slip wrote shows its own.
    """
    if numbers(text):
        *centre, radius = numbers(text)
        return of_surface(raster, centre, radius, direction, density, table, rock=rock)
    path = Path(text)
    if rock is not None:
        raise SlopeError("--bedrock", "must be given with X,Y,Z,R, as other bodies are as cut", text)
    if path.is_dir() or path.suffix == ".csv":
        row = bodies.rows_of(bodies.table_of(path))[0]
        _, rock = bodies.cells_of(raster, row, bodies.base_file(path, int(row["rank"])))
        return of_surface(raster, bodies.centre_of(row), row["radius"],
                          row["direction"] if direction is None else direction, density, table, bodies.shape_of(row),
                          rock)
    if not path.is_file():
        raise SlopeError("--failed", "must be X,Y,Z,R of a sphere (m), what find_slip wrote, or a raster of the ground "
                         "without the body", text)
    return of_base(raster, path, direction, density, table)
