"""A terrain divided by a road: the part that a mass comes from, the road, and what lies beyond it.

Where a road ends inside the terrain its ends are prolonged straight to the edge, and pieces that follow each other are
joined across the gap. What has no two ends (a plant, a ring, a junction) is prolonged across the direction in which the
mass sees it; a ring around the mass is not.
"""
import itertools
import math
from typing import FrozenSet, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points, polygonize, unary_union
from shapely.prepared import prep

from .. import geometry
from ..survey.rasters import Raster

SAMPLES = 360           # of the outline of a piece of a road
RING = 0.5              # of its extent: a piece with a hole as long as this is a ring
LONG = 3.0              # times as long as wide at least: a strip, with two ends
FOLDED = 2.0            # of its width: the halves of a strip's outline are not farther apart on average
AHEAD = 0.5             # cosine: pieces in the direction of each other's ends follow each other
ON_EDGE = 1e-9          # of the terrain's width: places on its edge are rounded
SLIVER = 1e-9           # of the terrain's area: rounding
BEFORE, ON, PAST = "before", "on", "past"
BEHIND = -0.5           # cosine: what lies more than 120 degrees off its way is behind what left the terrain


class End(NamedTuple):
    """A place in a piece of a road, not far from its end, and the direction of the road there, outwards."""
    piece: int
    place: np.ndarray
    way: np.ndarray


class Barrier(NamedTuple):
    """A road, or pieces of one that follow each other, and the lines that join and prolong them."""
    road: BaseGeometry
    lines: Sequence[LineString]


class Sides(NamedTuple):
    """Areas in local metres: before, road and past are all of the terrain.

    ahead: what of before and past has another road beyond it; straight: what of past the middle of the mass sees across
    the road itself, not beyond an end or through a gap; barriers: the roads.
    """
    before: BaseGeometry
    road: BaseGeometry
    past: BaseGeometry
    ahead: BaseGeometry
    straight: BaseGeometry
    barriers: Sequence[Barrier]

    def of_places(self, places: np.ndarray) -> np.ndarray:
        """BEFORE, ON or PAST of places (n, 2)."""
        west, south, east, north = unary_union([self.before, self.road, self.past]).bounds
        slack = ON_EDGE * (east - west)
        places = np.clip(places, (west + slack, south + slack), (east - slack, north - slack))
        road, past = prep(self.road), prep(self.past)
        return np.array([ON if road.intersects(one) else PAST if past.intersects(one) else BEFORE
                         for one in map(Point, places)], object)

    def ahead_of(self, start: np.ndarray, places: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Of what began in start and left the terrain in places (n, 2), beside the roads: whether one is ahead of it.

        part: of_places(). A road, with the lines that prolong it, is ahead unless it was passed or is behind.
        """
        whole, another = unary_union([self.before, self.road, self.past]).envelope, prep(self.ahead)
        roads = unary_union([one for barrier in self.barriers for one in (barrier.road, *barrier.lines)])
        found = (part == PAST) & np.array([another.intersects(Point(place)) for place in places], bool)
        mine = part == BEFORE
        found[mine] = not_behind(start[mine], places[mine], roads.intersection(whole))
        return found


def not_behind(start: np.ndarray, places: np.ndarray, line: BaseGeometry) -> np.ndarray:
    """Of what began in start and left the terrain in places (n, 2): whether a line is not behind it."""
    found = np.zeros(len(places), bool)
    for k, (begin, place) in enumerate(zip(start, places)):
        way, there = place - begin, nearest_points(line, Point(place))[0].coords[0] - place
        found[k] = way @ there >= BEHIND * np.hypot(*way) * np.hypot(*there)
    return found


def divide(road: BaseGeometry, line: Optional[LineString], raster: Raster, released: np.ndarray) -> Sides:
    """road: polygons in local metres, in the grid of a raster; line: its axis, of a road that is one; released: mask of
    the cells that the mass comes from.
    """
    whole = geometry.box_of(raster)
    rows, columns = np.nonzero(released)
    middle = np.array(raster.transform @ (columns.mean() + 0.5, rows.mean() + 0.5))
    far = 2 * (whole.length + np.hypot(*(np.array(whole.centroid.coords[0]) - middle)))
    pieces = geometry.polygons_of(unary_union(geometry.polygons_of(road)))
    if line is not None and not line.is_ring and len(pieces) == 1:
        ends = ends_along(0, np.asarray(line.coords)[:, :2], width_of(pieces[0]))
    else:
        ends = [end for number, piece in enumerate(pieces) for end in ends_of(number, piece, middle)]
    barriers = barriers_of(pieces, ends, far)
    beyond = [passed(whole, one, raster, released) for one in barriers]
    open_ = whole.difference(road)
    past = geometry.as_multi(unary_union(beyond).intersection(open_))
    return Sides(geometry.as_multi(open_.difference(past)), road, past, ahead_of(open_, beyond, SLIVER * whole.area),
                 geometry.as_multi(seen_across(pieces, middle, far).intersection(past)), barriers)


# --- ends ---

def ends_of(number: int, piece: Polygon, middle: np.ndarray) -> List[End]:
    """Of a polygon; middle: of the mass."""
    width, ring = width_of(piece), [hole for hole in piece.interiors if extent_of(hole) > RING * extent_of(piece)]
    if any(Polygon(hole).contains(Point(middle)) for hole in ring):
        return []
    if not ring and piece.exterior.length / 2 - width > LONG * width:
        line, apart = folded(piece)
        if apart < FOLDED * width:
            return ends_along(number, line, width)
    sight = np.array(piece.centroid.coords[0]) - middle
    across = np.array([-sight[1], sight[0]]) / max(np.hypot(*sight), 1e-30)
    outline = np.asarray(piece.exterior.coords)[:, :2]
    return [End(number, outline[np.argmax(outline @ way)], way) for way in (across, -across)]


def extent_of(outline) -> float:
    west, south, east, north = outline.bounds
    return float(np.hypot(east - west, north - south))


def width_of(piece: Polygon) -> float:
    """m, of a rectangle with the area and the outline of a piece; of one that has none, a square's."""
    half, area = piece.exterior.length / 2, piece.area
    return (half - math.sqrt(half ** 2 - 4 * area)) / 2 if half ** 2 > 4 * area else math.sqrt(area)


def folded(piece: Polygon) -> Tuple[np.ndarray, float]:
    """The middle line of a strip, from end to end: its outline is folded where its two halves lie closest together;
    how far they are apart, m.
    """
    outline = np.asarray(piece.exterior.coords)[:, :2]
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(outline, axis=0).T))])
    points = np.column_stack([np.interp(np.linspace(0, at[-1], SAMPLES, endpoint=False), at, one) for one in outline.T])
    steps = np.arange(1, SAMPLES // 2)
    apart = [np.hypot(*(points[(k + steps) % SAMPLES] - points[(k - steps) % SAMPLES]).T).sum()
             for k in range(SAMPLES // 2)]
    fold = int(np.argmin(apart))
    return (points[(fold + steps) % SAMPLES] + points[(fold - steps) % SAMPLES]) / 2, apart[fold] / len(steps)


def ends_along(number: int, line: np.ndarray, width: float) -> List[End]:
    """Both ends of a line: from a width inside on, in the direction of the two widths before."""
    ends = []
    for points in (line, line[::-1]):
        one = LineString(points)
        inside = min(width, one.length / 4)
        place, before = (np.array(one.interpolate(at).coords[0]) for at in (inside, min(3 * width, one.length / 2)))
        way = place - before
        ends.append(End(number, place, way / max(np.hypot(*way), 1e-30)))
    return ends


# --- roads of pieces ---

def barriers_of(pieces: Sequence[Polygon], ends: Sequence[End], far: float) -> List[Barrier]:
    """Pieces that follow each other are one; all other ends are prolonged. far: m, beyond the edge from anywhere."""
    group = list(range(len(pieces)))
    lines: List[Tuple[int, LineString]] = []
    free = list(ends)
    pairs = sorted(itertools.combinations(ends, 2), key=lambda pair: np.hypot(*(pair[0].place - pair[1].place)))
    for last, other in pairs:
        both_free = sum(end is last or end is other for end in free) == 2
        if group[last.piece] == group[other.piece] or not both_free or not follow(last, other):
            continue
        free = [end for end in free if end is not last and end is not other]
        lines.append((last.piece, LineString([last.place, other.place])))
        old = group[other.piece]
        group = [group[last.piece] if number == old else number for number in group]
    lines += [(end.piece, LineString([end.place, end.place + far * end.way])) for end in free]
    return [Barrier(unary_union([piece for piece, mine in zip(pieces, group) if mine == number]),
                    [line for piece, line in lines if group[piece] == number]) for number in sorted(set(group))]


def follow(end: End, other: End) -> bool:
    """Whether each lies in the direction of the other."""
    way = other.place - end.place
    length = np.hypot(*way)
    return bool(length > 0 and end.way @ way > AHEAD * length and other.way @ -way > AHEAD * length)


# --- areas ---

def passed(whole: Polygon, barrier: Barrier, raster: Raster, released: np.ndarray) -> BaseGeometry:
    """What a road cuts off from the mass."""
    lines = [whole.exterior, barrier.road.boundary, *(line.intersection(whole) for line in barrier.lines)]
    inside = prep(barrier.road)
    faces = [face for face in polygonize(unary_union(lines))
             if whole.contains(face.representative_point()) and not inside.contains(face.representative_point())]
    mass = [float((geometry.shares_of_cells(face, raster) * released).sum()) for face in faces]
    start = int(np.argmax(mass)) if faces and max(mass) > 0 else None     # None: all of it is on the road
    return unary_union([face for number, face in enumerate(faces) if number != start])


def ahead_of(open_: BaseGeometry, beyond: Sequence[BaseGeometry], sliver: float) -> BaseGeometry:
    """Of the terrain beside the roads, the parts from which another part lies beyond one road more."""
    parts: List[Tuple[BaseGeometry, FrozenSet[int]]] = [(open_, frozenset())]
    for number, area in enumerate(beyond):
        cut = [one for piece, crossed in parts for one in ((piece.difference(area), crossed),
                                                           (piece.intersection(area), crossed | {number}))]
        parts = [(piece, crossed) for piece, crossed in cut if piece.area > sliver]
    return geometry.as_multi(unary_union([piece for piece, crossed in parts
                                          if any(crossed < other for _, other in parts)]))


def seen_across(pieces: Sequence[Polygon], middle: np.ndarray, far: float) -> BaseGeometry:
    """What lies behind a road, seen from a place; everything, from a place on it."""
    if any(piece.contains(Point(middle)) for piece in pieces):
        return Point(middle).buffer(far)
    shadows = []
    for piece in pieces:
        outline = np.asarray(piece.exterior.simplify(width_of(piece) / 10).coords)[:, :2]
        sight = outline - middle
        away = middle + far * sight / np.maximum(np.hypot(*sight.T), 1e-30)[:, None]
        shadows += [Polygon(corners) for corners in zip(outline[:-1], outline[1:], away[1:], away[:-1])]
    return unary_union([shadow.buffer(0) for shadow in shadows])
