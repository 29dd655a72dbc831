"""Walls along lines: closed meshes that stand on the ground, as high above it everywhere."""
import math
from typing import List, Sequence, Tuple

import numpy as np
from shapely.geometry import LineString, Polygon

from ..errors import SlopeError
from ..geometry import extent
from ..survey import polygons
from ..survey.rasters import Raster
from ..survey.resampling import sample

WIDTH = 1.0             # m, unless it is given
SHARPEST = 150.0        # degrees, by which a wall may turn at a point
MOST_PARTS = 300        # of the side of a triangle
ACROSS = 5              # points across a wall at which the ground is looked at


def triangles(path: str, line: LineString, raster: Raster, height: float, width: float) -> np.ndarray:
    """The corners (n, 3, 3) of a wall along a line, local metres: a strip of this width (m) around it.

    Its top is height (m) above the highest ground across it, its foot as much below the lowest along all of it.
    SlopeError, which names the path, where it leaves the terrain or turns too sharply for its width.
    """
    points = np.asarray(line.coords)[:, :2]
    side = width / 2 * across(path, points)
    apart = np.hypot(*np.diff(points, axis=0).T)
    counts = [max(1, math.ceil(2 * one / raster.transform.a)) for one in apart]     # the top follows the ground
    left, right = filled(points + side, counts), filled(points - side, counts)
    folded = any((np.diff(edge, axis=0) * np.diff(points, axis=0)).sum(axis=1).min() <= 0
                 for edge in (points + side, points - side))
    if folded or not Polygon([*left, *right[::-1]]).is_valid:
        raise SlopeError(path, f"must not turn so sharply that a wall of {width:g} m meets itself: a smaller --width, "
                         "or a line of fewer points")
    xlo, ylo, xhi, yhi = extent(raster)
    corners = np.concatenate([left, right])
    low, high = corners.min(axis=0), corners.max(axis=0)
    lowest, highest = ground(raster, left, right)
    if not (xlo <= low[0] and ylo <= low[1] and high[0] <= xhi and high[1] <= yhi and np.isfinite(highest).all()):
        raise SlopeError(path, "must lie within the terrain, where its height is known, local x y "
                         f"{polygons.format_numbers((xlo, ylo, xhi, yhi))}", polygons.format_numbers((*low, *high)))
    foot = np.full(len(left), float(lowest.min()) - height)
    return strip(np.column_stack([left, foot]), np.column_stack([right, foot]),
                 np.column_stack([left, highest + height]), np.column_stack([right, highest + height]))


def filled(points: np.ndarray, counts: Sequence[int]) -> np.ndarray:
    """Points (x, y), with so many steps from each to the next."""
    steps = [one + (other - one) * np.arange(1, count + 1)[:, None] / count
             for one, other, count in zip(points[:-1], points[1:], counts)]
    return np.concatenate([points[:1], *steps])


def across(path: str, points: np.ndarray) -> np.ndarray:
    """Of each point, the way to the left edge of a strip around the line, in half widths: mitred where it bends."""
    along = np.diff(points, axis=0)
    along /= np.hypot(*along.T)[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    before, after = np.concatenate([normal[:1], normal]), np.concatenate([normal, normal[-1:]])
    cosine = (before * after).sum(axis=1)       # of the angle by which it turns
    if cosine.min() < math.cos(math.radians(SHARPEST)):
        raise SlopeError(path, f"must not turn by more than {SHARPEST:g} degrees at a point",
                         f"{math.degrees(math.acos(max(-1.0, float(cosine.min())))):.0f} degrees")
    return (before + after) / (1 + cosine)[:, None]


def ground(raster: Raster, left: np.ndarray, right: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest ground (m) across each point of a strip and half the way to its neighbours."""
    share, half = np.linspace(0, 1, ACROSS)[:, None, None], raster.transform.a / 2
    xlo, ylo, xhi, yhi = extent(raster)

    def heights(rows: np.ndarray) -> np.ndarray:
        """To the rim of the terrain, beyond the nodes of which the ground goes on as it is there."""
        x, y = rows[..., 0], rows[..., 1]
        return sample(raster, np.clip(x, xlo + half, xhi - half), np.clip(y, ylo + half, yhi - half))
    rows = left * (1 - share) + right * share
    z = [heights(rows)]
    between = heights((rows[:, :-1] + rows[:, 1:]) / 2)
    edge = between[:, :1]
    z += [np.concatenate([edge, between], axis=1), np.concatenate([between, between[:, -1:]], axis=1)]
    whole = np.concatenate(z)
    return whole.min(axis=0), whole.max(axis=0)


def heights_of(corners: np.ndarray, raster: Raster) -> Tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest point (m) of triangles (n, 3, 3) in each cell of a terrain; inf and -inf: none."""
    low, high = np.full(raster.z.shape, np.inf), np.full(raster.z.shape, -np.inf)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.clip(np.ceil(2 * sides / raster.transform.a), 1, MOST_PARTS).astype(int)
    for count in np.unique(parts):
        i, j = (one.ravel() for one in np.mgrid[:count + 1, :count + 1])
        shares = np.column_stack([i, j, count - i - j])[i + j <= count] / count
        x, y, z = np.einsum("sk,nkc->cns", shares, corners[parts == count]).reshape(3, -1)
        column, row = (np.clip(one, 0, most - 1).astype(int) for one, most in zip(~raster.transform @ (x, y),
                                                                                  raster.z.shape[::-1]))
        np.minimum.at(low, (row, column), z)
        np.maximum.at(high, (row, column), z)
    return low, high


def strip(*edges: np.ndarray) -> np.ndarray:
    """The closed mesh between four edges of as many points: foot and top, left and right; triangles turn outwards."""
    left, right, top_left, top_right = edges
    rings: List[np.ndarray] = []
    for a, b in ((right, left), (left, top_left), (top_left, top_right), (top_right, right)):
        rings += [np.stack([a[:-1], a[1:], b[1:]], axis=1), np.stack([a[:-1], b[1:], b[:-1]], axis=1)]
    for k, turn in ((0, 1), (-1, -1)):
        corners = [right[k], left[k], top_left[k], top_right[k]][::turn]
        rings.append(np.array([[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]))
    return np.concatenate(rings)[:, ::-1]


def stl(name: str, corners: np.ndarray) -> str:
    """Triangles as the text of an STL file."""
    lines = [f"solid {name}"]
    for one in corners:
        normal = np.cross(one[1] - one[0], one[2] - one[0])
        normal = normal / (np.linalg.norm(normal) or 1.0)
        lines += ["facet normal " + " ".join(f"{value:.6g}" for value in normal), " outer loop",
                  *("  vertex " + " ".join(f"{value:.4f}" for value in point) for point in one), " endloop", "endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""])
