"""What speaks against the bodies of a search."""
import math
from typing import Dict, Iterator, List, Optional, Tuple

import numpy as np
from rasterio.features import geometry_mask
from scipy import ndimage

from ..findings import Finding
from ..survey.rasters import Raster
from .columns import FEWEST

NEAR = 0.01         # of a limit
EDGE = 2            # cells from the edge of the terrain
LEAST_WIDTH = 0.25      # across / along, of the search: SlipSearch::WIDEST
FLAT = 5.0          # radii of such a length of the body are nearly a plane
SMALLEST = 100.0    # cells^3, least volume of find_slip without a limit


def length(raster: Raster, inside: np.ndarray, direction: float) -> float:
    """Of a body (mask of cells) along its direction of sliding (degrees counterclockwise from +x), m."""
    row, column = np.nonzero(inside)
    x, y = raster.transform @ (column + 0.5, row + 0.5)
    along = x * math.cos(math.radians(direction)) + y * math.sin(math.radians(direction))
    return float(np.ptp(along)) + raster.transform.a


def at_edge(raster: Raster, inside: np.ndarray) -> bool:
    """Whether a body is near the edge of the terrain, or cells without a height."""
    near = ndimage.binary_dilation(inside, iterations=EDGE)
    rim = near[0].any() or near[-1].any() or near[:, 0].any() or near[:, -1].any()
    return bool(rim or (near & ~np.isfinite(raster.z)).any())


def cells_in(raster: Raster, polygon) -> np.ndarray:
    """Mask of the cells whose middle is in a polygon (local metres)."""
    return geometry_mask([polygon], raster.z.shape, raster.transform, invert=True)


def near_limits(row: Dict[str, float], name: str, limits: Tuple[float, float]) -> Iterator[Finding]:
    """Of one body, whose volume or depth is at a limit."""
    low, high = limits
    if low > 0 and row[name] <= (1 + NEAR) * low:
        yield Finding(f"{name} low", {"body": int(row["rank"]), "limit": low})
    if row[name] >= (1 - NEAR) * high:
        yield Finding(f"{name} high", {"body": int(row["rank"]), "limit": high})


def find_body_doubts(raster: Raster, row: Dict[str, float], inside: np.ndarray, volume: Optional[Tuple[float, float]],
                     depth: Optional[Tuple[float, float]], allowed: Optional[np.ndarray]) -> List[Finding]:
    """Of one body: row of the table, mask of its cells; limits that were given, cells of the polygon within."""
    doubts = []

    def doubt(kind, **numbers):
        doubts.append(Finding(kind, {"body": int(row["rank"]), **numbers}))

    if inside.sum() < FEWEST:
        doubt("columns", value=int(inside.sum()), limit=FEWEST)
    if at_edge(raster, inside):
        doubt("terrain", limit=EDGE)
    if allowed is not None and (ndimage.binary_dilation(inside) & ~allowed).any():
        doubt("within")
    doubts += near_limits(row, "volume", volume or (SMALLEST * raster.transform.a ** 3, math.inf))
    doubts += near_limits(row, "depth", depth or (0.0, math.inf))
    long = length(raster, inside, row["direction"])
    if row["radius"] > FLAT * long:
        doubt("flat", value=row["radius"], limit=long)
    if not LEAST_WIDTH * 1.01 < row["across"] < 0.99 / LEAST_WIDTH:
        doubt("wide", value=row["across"])
    if row["factor"] < 1:
        doubt("fails", value=row["factor"])
    return doubts
