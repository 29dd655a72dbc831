"""What speaks against the bodies of a search: typed, and in words."""
import math
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from rasterio.features import geometry_mask
from scipy import ndimage

from ..survey.rasters import Raster
from .columns import FEWEST

NEAR = 0.01         # of a limit
EDGE = 2            # cells from the edge of the terrain
LEAST_WIDTH = 0.25      # across / along, of the search: SlipSearch::WIDEST
FLAT = 5.0          # radii of such a length of the body are nearly a plane
SMALLEST = 100.0    # cells^3, least volume of find_slip without a limit


class Doubt(NamedTuple):
    body: int           # its rank
    kind: str           # a key of WORDS
    value: float = math.nan
    limit: float = math.nan


WORDS = {
    "columns": "has {value:.0f} cells of the terrain, fewer than {limit:g}: its numbers are rough",
    "terrain": "is within {limit:g} cells of the edge of the terrain or of cells without a height: a larger terrain "
               "may have a lower factor",
    "within": "is at the edge of --within: beyond it the factor may be lower",
    "volume low": "has the least volume that is allowed, {limit:.6g} m3: a smaller body may have a lower factor",
    "volume high": "has the largest volume that is allowed, {limit:.6g} m3: a larger body may have a lower factor",
    "depth low": "has the least depth that is allowed, {limit:.6g} m: a shallower body may have a lower factor",
    "depth high": "has the largest depth that is allowed, {limit:.6g} m: a deeper body may have a lower factor",
    "flat": "is nearly a plane, radius {value:.4g} m for a length of {limit:.4g} m: at the edge of a search of spheres",
    "wide": "is {value:.3g} times as wide as a sphere, which is a limit of the search: another width may have a lower "
            "factor",
    "fails": "has a factor of {value:.3f}, below 1: with these numbers it does not stand",
}


def words(doubt: Doubt) -> str:
    """A line for the user."""
    return f"body {doubt.body} {WORDS[doubt.kind].format(value=doubt.value, limit=doubt.limit)}"


def length(raster: Raster, inside: np.ndarray, direction: float) -> float:
    """Of a body (mask of cells) along its direction of sliding (degrees counterclockwise from +x), m."""
    row, column = np.nonzero(inside)
    x, y = raster.transform * (column + 0.5, row + 0.5)
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


def near_limits(row: Dict[str, float], name: str, limits: Tuple[float, float]) -> Iterator[Doubt]:
    """Of one body, whose volume or depth is at a limit."""
    low, high = limits
    if low > 0 and row[name] <= (1 + NEAR) * low:
        yield Doubt(int(row["rank"]), f"{name} low", row[name], low)
    if row[name] >= (1 - NEAR) * high:
        yield Doubt(int(row["rank"]), f"{name} high", row[name], high)


def of_body(raster: Raster, row: Dict[str, float], inside: np.ndarray, volume: Optional[Tuple[float, float]],
            depth: Optional[Tuple[float, float]], allowed: Optional[np.ndarray]) -> List[Doubt]:
    """Of one body: row of the table, mask of its cells; limits that were given, cells of the polygon within."""
    rank = int(row["rank"])
    found = []
    if inside.sum() < FEWEST:
        found.append(Doubt(rank, "columns", float(inside.sum()), FEWEST))
    if at_edge(raster, inside):
        found.append(Doubt(rank, "terrain", limit=EDGE))
    if allowed is not None and (ndimage.binary_dilation(inside) & ~allowed).any():
        found.append(Doubt(rank, "within"))
    found += near_limits(row, "volume", volume or (SMALLEST * raster.transform.a ** 3, math.inf))
    found += near_limits(row, "depth", depth or (0.0, math.inf))
    long = length(raster, inside, row["direction"])
    if row["radius"] > FLAT * long:
        found.append(Doubt(rank, "flat", row["radius"], long))
    if not LEAST_WIDTH * 1.01 < row["across"] < 0.99 / LEAST_WIDTH:
        found.append(Doubt(rank, "wide", row["across"]))
    if row["factor"] < 1:
        found.append(Doubt(rank, "fails", row["factor"], 1.0))
    return found


def of_all(raster: Raster, rows: Sequence[Dict[str, float]], masks: Sequence[np.ndarray],
           volume: Optional[Tuple[float, float]], depth: Optional[Tuple[float, float]],
           allowed: Optional[np.ndarray]) -> List[Doubt]:
    """of_body() of all bodies."""
    return [one for row, inside in zip(rows, masks) for one in of_body(raster, row, inside, volume, depth, allowed)]
