"""The axis of a road as coordinates: chainage along it, offset from it, and the plan area of a range of both.

The *foot* of a point is the point of the axis nearest to it. Its chainage s (m) is the length of the axis from its
start to the foot, plus the chainage of the start; its offset n (m) is the distance from the foot, positive on the left
of the axis' direction. Outside of a bend all points between the two perpendiculars have the vertex as their foot.
Inside, where the foot jumps at the line that halves the angle, what touches that line counts as reaching the vertex.
"""
import math
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np
from affine import Affine
from rasterio.features import shapes
from shapely.geometry import LineString, Point, Polygon, box, shape
from shapely.geometry.base import BaseGeometry
from shapely.ops import substring, unary_union

from ..geometry import as_multi, polygons_of

STEP = math.radians(2)      # of the arcs outside of bends
SAME = 1e-6                 # m; chainages that are closer are the same
CHUNK = 4_000_000           # distances at a time


class Span(NamedTuple):
    """A range of chainages or of offsets, m."""
    low: float
    high: float


class Piece(NamedTuple):
    """The points within a reach of the axis whose feet are on one segment of it, on one side, or on a vertex."""
    area: Polygon
    at: int                         # of the segment, or of the vertex
    side: int                       # 1: left, -1: right
    inside: Tuple[float, float]     # tangents of the angles by which it narrows at the ends of its segment
    bend: bool                      # of a vertex


class Axis:
    """A polyline in local metres; points: rows of x y, in its direction; start: the chainage of the first one, m."""

    def __init__(self, points, start: float = 0.0):
        points = np.asarray(points, float)[:, :2]
        self.points = points[np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])]
        along = np.diff(self.points, axis=0)
        self.lengths = np.hypot(*along.T)
        self.unit = along / self.lengths[:, None]
        self.left = self.unit[:, ::-1] * [-1, 1]
        self.s = start + np.concatenate([[0.0], np.cumsum(self.lengths)])
        # at all vertices: tangent of half of the bend, > 0 to the left
        sine, cosine = ((self.unit[:-1] * other[1:]).sum(axis=1) for other in (-self.left, self.unit))
        self.half = np.concatenate([[0.0], sine / np.maximum(1 + cosine, 1e-12), [0.0]])

    def locate(self, x, y):
        """Chainage and offset (m) of points x, y (1-d arrays)."""
        place = np.column_stack([x, y])
        s, n = np.empty(len(place)), np.empty(len(place))
        step = max(1, CHUNK // len(self.lengths))
        for some in (slice(first, first + step) for first in range(0, len(place), step)):
            gap = place[some, None] - self.points[:-1]
            share = np.clip((gap * self.unit).sum(axis=2), 0, self.lengths)
            distance = np.linalg.norm(gap - share[:, :, None] * self.unit, axis=2)
            foot = np.arange(len(gap)), distance.argmin(axis=1)
            s[some] = share[foot] + self.s[foot[1]]
            n[some] = np.where((gap * self.left).sum(axis=2)[foot] < 0, -1, 1) * distance[foot]
        return s, n

    @property
    def whole(self) -> LineString:
        return LineString(self.points)

    def line(self, along: Span) -> LineString:
        """The part of the axis between two chainages."""
        return substring(self.whole, *(np.clip(along, self.s[0], self.s[-1]) - self.s[0]))

    def pieces(self, reach: float) -> List[Piece]:
        """All points within a reach (m) of the axis; the pieces do not overlap but where legs are that near."""
        return [*(Piece(self.beside(k, side, 0, reach), k, side, self.inside(k, side), False)
                  for k in range(len(self.lengths)) for side in (1, -1)),
                *(Piece(self.sector(k, 0, reach), k, -1 if self.half[k] > 0 else 1, (0.0, 0.0), True)
                  for k in np.flatnonzero(np.abs(self.half) > 1e-9))]

    def inside(self, k: int, side: int) -> Tuple[float, float]:
        """The tangents of the angles by which what has its foot on segment k narrows on a side."""
        return max(0.0, side * self.half[k]), max(0.0, side * self.half[k + 1])

    def beside(self, k: int, side: int, near: float, far: float) -> Polygon:
        """The points on a side of segment k that have their feet on it, between two distances."""
        length, (first, last) = self.lengths[k], self.inside(k, side)
        far = min(far, length / max(first + last, 1e-12))
        return self.polygon(k, side, [(first * near, near), (length - last * near, near), (length - last * far, far),
                                      (first * far, far)]) if far > near else Polygon()

    def polygon(self, k: int, side: int, corners) -> Polygon:
        """Of points along segment k and beside it, m."""
        along, beside = np.transpose(corners)[:, :, None]
        return Polygon(self.points[k] + along * self.unit[k] + side * beside * self.left[k])

    def sector(self, k: int, near: float, far: float) -> Polygon:
        """The points outside of the bend at vertex k, between two distances."""
        side = -1 if self.half[k] > 0 else 1
        start, turn = math.atan2(*(side * self.left[k - 1])[::-1]), 2 * math.atan(self.half[k])
        angles = start + np.linspace(0, turn, max(2, math.ceil(abs(turn) / STEP) + 1))
        arc = np.column_stack([np.cos(angles), np.sin(angles)])
        return Polygon(self.points[k] + np.concatenate([far * arc, near * arc[::-1]])) if far > near else Polygon()

    def spans(self, piece: Piece, part: Polygon) -> Tuple[Span, Span]:
        """The chainages and the offsets of a connected part of a piece."""
        points = np.asarray(part.exterior.coords)[:, :2] - self.points[piece.at]
        if piece.bend:
            n = np.array([part.distance(Point(self.points[piece.at])), np.hypot(*points.T).max()])
            s = np.zeros(2)
        else:
            s, n = points @ self.unit[piece.at], np.abs(points @ self.left[piece.at])
            low, high = piece.inside[0] * n, self.lengths[piece.at] - piece.inside[1] * n
            s = np.where(s <= low + SAME, 0, np.where(s >= high - SAME, self.lengths[piece.at], s))
        s, n = s + self.s[piece.at], piece.side * n
        return Span(float(s.min()), float(s.max())), Span(float(n.min()), float(n.max()))

    def band(self, along: Span, across: Span) -> BaseGeometry:
        """The points whose feet lie between two chainages, within the axis, and whose offsets lie between two.

        Its ends are perpendicular to the axis; it may be empty, or of several polygons.
        """
        parts = []
        for side in (1, -1):
            near, far = sorted(max(0.0, side * n) for n in across)
            for k, length in enumerate(self.lengths):
                low, high = np.clip(along, self.s[k], self.s[k + 1]) - self.s[k]
                if high > low:
                    parts.append(self.beside(k, side, near, far))
                    if high - low < length:
                        strip = self.polygon(k, side, [(low, near), (high, near), (high, far), (low, far)])
                        parts[-1] = parts[-1].intersection(strip)
                if side * self.half[k] < 0 and along.low - SAME <= self.s[k] <= along.high + SAME:
                    parts.append(self.sector(k, near, far))
        return as_multi(opened(unary_union(parts), SAME))       # without the hairlines between them


# --- ranges, and the parts of a mask ---

def merged(spans: Sequence[Span], gap: float = 0.0) -> List[Span]:
    """The union of ranges, ascending; those that are no farther apart than a gap become one."""
    union: List[Span] = []
    for one in sorted(spans):
        if union and one.low <= union[-1].high + gap:
            union[-1] = Span(union[-1].low, max(union[-1].high, one.high))
        else:
            union.append(one)
    return union


def longest_gap(spans: Sequence[Span], within: Span) -> float:
    """The length of the longest range within another that none of the ranges covers."""
    covered = merged([Span(-math.inf, within.low), *spans, Span(within.high, math.inf)])
    return max((after.low - before.high for before, after in zip(covered, covered[1:])), default=0.0)


def parts_of_mask(mask, transform, area: BaseGeometry) -> List[Polygon]:
    """The connected parts of the true cells of a mask (rows from the north) in an area, cut at its edge."""
    xlo, ylo, xhi, yhi = area.bounds
    (left, top), (right, bottom) = ~transform @ (xlo, yhi), ~transform @ (xhi, ylo)
    top, left = (max(0, math.floor(one)) for one in (top, left))
    window = mask[top:max(0, math.ceil(bottom)), left:max(0, math.ceil(right))].astype(np.uint8)
    if not window.any():
        return []
    place = transform @ Affine.translation(left, top)
    if window.all():        # as most are on a road that a deposit covers: half as long
        found = [box(*(place @ (0, len(window))), *(place @ (len(window[0]), 0)))]
    else:
        found = [shape(one) for one, _ in shapes(window, window.astype(bool), connectivity=4, transform=place)]
    # cells that end where the area does would, by rounding, be hairlines in it, which join what is apart
    return [part for one in found for part in polygons_of(opened(one.intersection(area), -SAME))]


def opened(area: BaseGeometry, by: float) -> BaseGeometry:
    """An area without what is narrower than twice a length (m); a length > 0 closes gaps instead."""
    return area.buffer(by, join_style=2).buffer(-by, join_style=2)
