"""The fall path: where a mass goes on the way down, its length in plan and its height below the crown.

Through the body it is the body's fall line, from the level of the crown to the centre of its volume; from there on it
is the steepest descent. A mass does not follow what is narrower than itself, so the ground without the body is first
averaged over the width of the mass, the cube root of its volume. Where the descent ends, in a pit or on a flat, the pit
is filled, and it goes on over the lowest pass, by the straightest way that is not above it; on a flat straight ahead.
It ends where the terrain does. Or it is a line that the user drew.
"""
import heapq
import math
from typing import Iterator, List, NamedTuple, Optional, Tuple

import numpy as np
from affine import Affine
from scipy.ndimage import distance_transform_edt, minimum_filter, uniform_filter
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from ..deposits.gone import FLATTEST
from ..errors import SlopeError
from ..geometry import polygons_of
from ..survey.rasters import Raster
from ..survey.resampling import sample
from .body import Body

AVERAGES = 3            # moving averages, one after another: about a Gaussian
LEVEL = 1e-3            # m; heights that differ by less are the same
LEAST = 1e-5            # a gradient below is none
SHORTEST = 8            # a step that does not descend is halved, down to this part of it
MOST_POINTS = 4000      # of a path
MANY = 2.0              # widths of the mass, that a path may go on beside a road before it meets it
RIM = 0.01              # of a body's largest depth
PARTS = 50              # of a step of the path, at the toe
TERRAIN, EVENTS, LINE = "where the terrain ends", "where hardly any known event arrives", "where the given line ends"


class FallPath(NamedTuple):
    """Points along the path, from the crown's level on; the first has length 0.

    fall: how far the ground (before the collapse) lies below the crown, 0 where it does not; end: TERRAIN, EVENTS or
    LINE; crown: x, y, z of the highest ground in the body, beside or on the path's beginning; drawn: by a user.
    """
    x: np.ndarray           # local m
    y: np.ndarray
    length: np.ndarray      # m, in plan
    fall: np.ndarray        # m
    end: str
    crown: Tuple[float, float, float]
    drawn: bool = False

    def elevation(self, body: Body) -> np.ndarray:
        """Of the ground before the collapse, m."""
        return sample(body.raster, self.x, self.y)


class AtRoad(NamedTuple):
    """The first point of a path on a road; of a path that does not meet it, or goes beside it before, not farther away
    than the mass is wide, the nearest one there; else its point nearest to the road.

    behind: a path is nearest to it where it begins, and no part of it lies ahead of that and clearly lower: the mass
    goes away from it, so that known events, whose lengths begin there, say nothing of it.
    """
    met: bool
    beside: float       # m from that point to the road, 0 where they meet
    length: float       # m, along the path
    passed: float       # m, where the path leaves the road after it; length where it does not meet it
    fall: float         # m below the crown
    x: float            # local m
    y: float
    behind: bool = False


def trace(body: Body, longest: float) -> FallPath:
    """The path of a body, at most about longest (m)."""
    return trace_from(body, Smooth(body), *body.fall_line(), longest)


def trace_from(body: Body, ground: "Smooth", centre: np.ndarray, downhill: np.ndarray, longest: float) -> FallPath:
    """The path through a centre of the body; ground: its pits are filled."""
    above = max(0.0, float((centre - body.crown[:2]) @ downhill))
    points, edge = descend(ground, centre, downhill, longest)
    line = LineString([centre - above * downhill, *points] if above > 0 else points)
    line = line.simplify(ground.step * ground.cell)       # the descent along a valley swings from side to side
    return path_along(body, line, TERRAIN if edge else EVENTS)


def trace_strips(body: Body, width: float, longest: float) -> Iterator[FallPath]:
    """The paths of strips of the body, from flank to flank, each about as wide (m) as the mass; none of one strip."""
    centre, downhill = body.fall_line()
    cells = np.nonzero(body.main)
    place = np.column_stack(body.raster.transform @ (np.array(cells[::-1]) + 0.5))
    across = (place - centre) @ (-downhill[1], downhill[0])
    strips = round(np.ptp(across) / width)
    if strips < 2:
        return
    mine = np.minimum((across - across.min()) / np.ptp(across) * strips, strips - 1).astype(int)
    ground = Smooth(body)
    for strip in np.unique(mine):
        own, ground.z = mine == strip, ground.unfilled.copy()
        middle = np.average(place[own], axis=0, weights=body.main[cells][own])
        yield trace_from(body, ground, middle, downhill, longest)


def given(body: Body, line: LineString, where) -> FallPath:
    """The path along a line (local m), from its end nearer to the crown as far as the terrain goes.

    Raises SlopeError, which names where, for a line that does not begin on the terrain.
    """
    crown = body.crown
    if math.dist(line.coords[-1][:2], crown[:2]) < math.dist(line.coords[0][:2], crown[:2]):
        line = LineString(line.coords[::-1])
    path = path_along(body, line, LINE)._replace(drawn=True)
    beyond = np.flatnonzero(~np.isfinite(sample(body.raster, path.x, path.y)))
    if not len(beyond):
        return path
    if beyond[0] < 2:
        raise SlopeError(where, "must begin on the terrain, at its end nearer to the crown")
    x, y, length, fall = (values[:beyond[0]] for values in (path.x, path.y, path.length, path.fall))
    return FallPath(x, y, length, fall, TERRAIN, crown, True)


def path_along(body: Body, line: LineString, end: str) -> FallPath:
    """The path along a line (local m), in even steps of about a cell."""
    crown = body.crown
    count = min(MOST_POINTS, max(2, math.ceil(line.length / body.cell) + 1))
    length = np.linspace(0.0, line.length, count)
    x, y = np.array([line.interpolate(at).coords[0][:2] for at in length]).T
    fall = np.maximum(crown[2] - sample(body.raster, x, y), 0.0)
    return FallPath(x, y, length, np.nan_to_num(fall), end, crown)


def from_toe(body: Body, path: FallPath) -> FallPath:
    """A path from the body's toe on, its last place on the body, between two points; all of it where none is.

    A body's rim has no depth: rounding would decide.
    """
    def last_on(x: np.ndarray, y: np.ndarray) -> int:
        within = np.flatnonzero(sample(body.raster._replace(z=body.depth), x, y) > RIM * body.depth.max())
        return int(within[-1]) if len(within) else 0

    k = last_on(path.x, path.y)
    at = np.linspace(k, min(k + 1, len(path.length) - 1), PARTS + 1)
    x, y, length = (np.interp(at, np.arange(len(path.length)), values) for values in (path.x, path.y, path.length))
    toe = last_on(x, y)
    fall = max(path.crown[2] - float(sample(body.raster, x[toe], y[toe])), 0.0)
    x, y, length, falls = (np.append(first, rest[k + 1:]) for first, rest in zip(
        (x[toe], y[toe], length[toe], fall), (path.x, path.y, path.length, path.fall)))
    return path._replace(x=x, y=y, length=length, fall=falls)


class Smooth:
    """The ground without the body, averaged over the width of the mass, at nodes that are close enough for that.

    cell: m between the nodes; places are their (column, row), whole numbers at the nodes.
    """

    def __init__(self, body: Body):
        z, known = body.base, np.isfinite(body.raster.z)
        if not known.all():
            z = z[tuple(distance_transform_edt(~known, return_distances=False, return_indices=True))]
        # so many averages over w cells have the deviation of a Gaussian of w / 2
        window = 1 + 2 * round((body.volume ** (1 / 3) / body.cell / 2 - 1) / 2)
        if window > 1:
            room = AVERAGES * (window // 2)
            z = np.pad(z, room, mode="reflect", reflect_type="odd")      # keeps a plane, up to its edge
            for _ in range(AVERAGES):
                z = uniform_filter(z, window)
            z = z[room:-room, room:-room]
        every = max(1, min(window // 4, min(z.shape) // 4))
        first = [(count - 1) % every // 2 for count in z.shape]
        thin = tuple(slice(start, None, every) for start in first)
        self.unfilled, self.known = z[thin], minimum_filter(known, every)[thin]
        self.z = self.unfilled.copy()
        # of each patch between four nodes
        self.patches = self.known[:-1, :-1] & self.known[:-1, 1:] & self.known[1:, :-1] & self.known[1:, 1:]
        self.transform = (body.raster.transform @ Affine.translation(first[1] + 0.5, first[0] + 0.5)
                          @ Affine.scale(every))
        self.cell = body.cell * every
        self.step = max(1.0, window / every / 2) / 2        # in cells
        self.memory = max(10.0, window / every)             # the path's direction is that of its last part so long

    def place(self, point) -> np.ndarray:
        """Of a point (x, y)."""
        return np.array(~self.transform @ tuple(point))

    def point(self, place) -> Tuple[float, float]:
        return self.transform @ (float(place[0]), float(place[1]))

    def patch(self, place) -> Tuple[int, int]:
        """Row and column of the first node of the patch that a place lies in."""
        rows, columns = self.patches.shape
        return min(max(int(place[1]), 0), rows - 1), min(max(int(place[0]), 0), columns - 1)

    def height(self, place) -> float:
        """Bilinear between the nodes."""
        row, column = self.patch(place)
        return bilinear(self.z[row:row + 2, column:column + 2], place[0] - column, place[1] - row)

    def gradient(self, place) -> np.ndarray:
        """Metres per cell to the east and south, central differences at the nodes, bilinear between them."""
        row, column = self.patch(place)
        top, left = max(row - 1, 0), max(column - 1, 0)
        near = np.gradient(self.z[top:row + 3, left:column + 3])[::-1]
        inner = slice(row - top, row - top + 2), slice(column - left, column - left + 2)
        return np.array([bilinear(one[inner], place[0] - column, place[1] - row) for one in near])

    def inside(self, place) -> bool:
        """Whether the ground is known there."""
        rows, columns = self.z.shape
        return bool(0 <= place[0] <= columns - 1 and 0 <= place[1] <= rows - 1 and self.patches[self.patch(place)])

    def border(self, row: int, column: int) -> bool:
        """Whether a node is one of the last ones."""
        rows, columns = self.z.shape
        if row in (0, rows - 1) or column in (0, columns - 1):
            return True
        return not self.known[row - 1:row + 2, column - 1:column + 2].all()


def bilinear(corners: np.ndarray, east: float, south: float) -> float:
    (a, b), (c, d) = corners
    return float((a * (1 - east) + b * east) * (1 - south) + (c * (1 - east) + d * east) * south)


def descend(ground: Smooth, start, heading, longest: float) -> Tuple[List[Tuple[float, float]], bool]:
    """Points (x, y) of the steepest descent, and whether it ends where the terrain does; heading: unit vector."""
    place, left, edge = ground.place(start), longest / ground.cell, False
    places = [place]
    while left > 0 and not edge:
        step = downwards(ground, place)
        if step is None:
            others, edge = over_the_pass(ground, place, direction(ground, places, heading), left)
        elif ground.inside(place + step):
            others = [place + step]
        else:
            others, edge = [last_inside(ground, place, step)], True
        for one in others:
            left -= float(np.hypot(*(one - place)))
            place = one
        places += others
    return [ground.point(one) for one in places], edge


def direction(ground: Smooth, places: List[np.ndarray], heading) -> np.ndarray:
    """Of the last part of the path, a unit vector (columns, rows); heading: x, y, where it has just begun."""
    for one in reversed(places):
        way = places[-1] - one
        size = float(np.hypot(*way))
        if size >= ground.memory:
            return way / size
    return np.array([heading[0], -heading[1]])


def downwards(ground: Smooth, place):
    """A step (columns, rows) down the gradient, maybe beyond the terrain; None where none descends."""
    gradient = ground.gradient(place)
    size = float(np.hypot(*gradient))
    if size < LEAST * ground.cell:
        return None
    here, step = ground.height(place), -ground.step * gradient / size
    for _ in range(int(math.log2(SHORTEST)) + 1):
        if not ground.inside(place + step) or ground.height(place + step) < here:
            return step
        step = step / 2
    return None


def last_inside(ground: Smooth, place, step) -> np.ndarray:
    """The last place along a step that leaves the terrain at which the ground is known."""
    low, high = 0.0, 1.0
    for _ in range(20):
        middle = (low + high) / 2
        low, high = (middle, high) if ground.inside(place + middle * step) else (low, middle)
    return place + low * step


def over_the_pass(ground: Smooth, place, way, longest: float) -> Tuple[List[np.ndarray], bool]:
    """Places on the way out of a pit or off a flat; the last one is lower, or on the terrain's border (then True).

    The nodes are flooded in the order of their heights, at the same height those straight ahead first, until the water
    runs over. What is flooded is filled.
    """
    column, row = (round(float(value)) for value in place)
    before = {(row, column): (row, column)}
    level = round(ground.height(place) / LEVEL)
    queue: List[Tuple[int, float, int, int]] = [(level, 0.0, row, column)]
    flooded: List[Tuple[int, int]] = []
    edge = False
    while queue:
        water, _, row, column = heapq.heappop(queue)
        level = max(level, water)
        edge = ground.border(row, column)
        far = math.hypot(column - place[0], row - place[1]) > longest
        flooded.append((row, column))
        if edge or far or ground.z[row, column] < (level - 1) * LEVEL:
            break
        for new in ((row + down, column + right) for down in (-1, 0, 1) for right in (-1, 0, 1)):
            if new not in before:
                before[new] = (row, column)
                ahead = np.array([new[1], new[0]]) - place
                queue_height = max(level, round(ground.z[new] / LEVEL))
                heapq.heappush(queue, (queue_height, round(math.hypot(*ahead) - float(ahead @ way), 6), *new))
    chain = flooded[-1:]
    for node in flooded[:-1]:
        ground.z[node] = max(ground.z[node], level * LEVEL)
    while before[chain[-1]] != chain[-1]:
        chain.append(before[chain[-1]])
    nodes = [np.array([column, row], dtype=float) for row, column in chain[::-1]]
    return straightened(ground, [place, *nodes], (level + 1) * LEVEL)[1:], edge


def straightened(ground: Smooth, places: List[np.ndarray], level: float) -> List[np.ndarray]:
    """The same way, cutting corners where the ground is known and not above the level (m)."""
    kept_places, k = [places[0]], 0
    while k < len(places) - 1:
        other = len(places) - 1
        while other > k + 1 and not below(ground, places[k], places[other], level):
            other = k + (other - k) // 2
        k = other
        kept_places.append(places[k])
    return kept_places


def below(ground: Smooth, start, other, level: float) -> bool:
    """Whether the ground is known and not above a level (m) along a straight line, at the nodes nearest to it."""
    count = 2 + int(2 * np.hypot(*(other - start)))
    columns, rows = np.round(start + np.linspace(0, 1, count)[:, None] * (other - start)).astype(int).T
    return bool((ground.known[rows, columns] & (ground.z[rows, columns] <= level)).all())


# --- a road on it ---

def at_road(path: FallPath, road: BaseGeometry, ground: Raster, width: float) -> AtRoad:
    """road: polygons in local metres; ground: before the collapse; width: of the mass, m."""
    met = first_met(path, road)
    away = np.array([road.distance(Point(place)) for place in zip(path.x, path.y)])
    within = np.flatnonzero((away <= width) & (path.length >= width))
    start = path.length[within[0]] if len(within) else np.inf
    if met and met.length <= start + MANY * width:
        return met
    if len(within):     # where a valley leads along the road, it may be met far down, or nowhere
        beside = (path.length >= start) & (path.length <= start + MANY * width)
        k = int(np.argmin(np.where(beside, away, np.inf)))
        return point_on(path, float(path.length[k]), False, float(away[k]))
    line = LineString(np.column_stack([path.x, path.y]))
    here, there = nearest_points(line, road)
    at = point_on(path, line.project(here), False, here.distance(there))
    return at._replace(behind=at.length <= width and is_behind(path, road, ground))


def first_met(path: FallPath, road: BaseGeometry) -> Optional[AtRoad]:
    """The first point of a path on a road, None without one."""
    line = LineString(np.column_stack([path.x, path.y]))
    for k, (one, other) in enumerate(zip(line.coords[:-1], line.coords[1:])):
        # piece by piece: a path that crosses itself has no other order
        piece = LineString([one, other])
        crossed = piece.intersection(road)
        if not crossed.is_empty:
            length = path.length[k] + piece.project(nearest_points(crossed, Point(one))[0])
            return point_on(path, length, True, 0.0, far_edge(path, line, k, road))
    return None


def is_behind(path: FallPath, road: BaseGeometry, ground: Raster) -> bool:
    """Whether nothing of a road lies ahead of a path's beginning and so low that a mass may get there."""
    rings = [polygon.exterior for polygon in polygons_of(road)]
    x, y = np.array([ring.interpolate(at).coords[0] for ring in rings
                     for at in np.arange(0.0, ring.length, ground.transform.a)]).T
    fall = path.crown[2] - sample(ground, x, y)
    x, y = x - path.x[0], y - path.y[0]
    ahead = x * (path.x[1] - path.x[0]) + y * (path.y[1] - path.y[0]) > 0
    return bool((fall <= FLATTEST * np.hypot(x, y))[ahead].all())       # not where the ground is not known


def far_edge(path: FallPath, line: LineString, k: int, road: BaseGeometry) -> float:
    """Length (m) at which a path leaves the road that it meets in its piece k."""
    length = path.length[k]
    for one, other, start in zip(line.coords[k:-1], line.coords[k + 1:], path.length[k:]):
        piece = LineString([one, other])
        crossed = piece.intersection(road)
        if not crossed.is_empty:
            length = start + piece.project(nearest_points(crossed, Point(other))[0])
        if not road.intersects(Point(other)):
            break
    return float(length)


def point_on(path: FallPath, length: float, met: bool, beside: float, passed: Optional[float] = None) -> AtRoad:
    fall, x, y = (float(np.interp(length, path.length, values)) for values in (path.fall, path.x, path.y))
    return AtRoad(met, float(beside), float(length), float(length if passed is None else passed), fall, x, y)
