"""The cut surface above a road, and what of a deposit lies above it. Index coordinates of the deposit's grid.

Surface of the cut: inside the road, the ground; outside, the height of the ground at the nearest point of the road's
edge, no higher than the road's surface leads there, plus tangent x distance. With h = cut - ground and the thickness t,
which is even in a cell, what is removed is

    clip(surface - max(ground, cut), 0, t) = max(0, t - max(0, h)) = max(0, t - h) - max(0, -h)

that is, all of it on the road and where the cut lies below the ground, and never more than there is.

Every cell near the cut is divided into k x k parts, each of which the mesh's lines divide further. h is linear in the
triangles of a part, where the two terms have exact integrals: plane ground and a straight edge give exact volumes
whatever k is; only round corners (the cut around a corner is a cone), the seams between two edges, and rough ground
depend on k. A part that the edge crosses is divided by it into its exact areas.
"""
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from affine import Affine
from rasterio.features import geometry_mask
from scipy.ndimage import distance_transform_edt, maximum_filter, minimum_filter
from scipy.spatial import cKDTree
from shapely.affinity import translate
from shapely.geometry import Point, box
from shapely.ops import triangulate, unary_union

from ..geometry import Lines, contains, coverage, edges, polygons_of
from ..survey.rasters import progress

STRIP = 500_000     # parts of cells at a time
BLOCK = 16          # cells along a side that are bounded together
STEP = 0.25         # cells; points of the road's edge are no farther from each other
NEAR = 4            # of these points: the nearest piece of the edge is one of theirs
ACROSS = 0.95       # of the way across a road, which is within it
DEPTHS = 1.5, 1.25, 1.0     # cells into a road, where its surface shows how high its edge lies; narrower ones have none
HALF_DIAGONAL = 0.5 ** 0.5  # of a cell
BESIDE = 1.5        # cells, of one without a height from one that has it
WHOLE = 1e-12       # relative; an area that differs less is the same


class Removed(NamedTuple):
    """Volumes in cells x m: of every cell of the grid, of every mesh cell; and of parts of the total."""
    cells: np.ndarray
    mesh_road: np.ndarray    # on the road
    mesh_beside: np.ndarray  # beside it
    steep: float             # of that beside it: where the cut lies below the ground
    unknown: float           # left, because the ground beneath is not known


class Ground:
    """The ground, bilinear between the centres of the cells, and linear on to the edges of the grid.

    A cell without a height, known: False, gets that of the nearest that has one: for its neighbours' sake, and for that
    of a road that leaves the terrain, whose cut rises from there.
    """

    def __init__(self, z):
        self.known = np.isfinite(z)
        self.z = z if self.known.all() else z[tuple(distance_transform_edt(~self.known, return_distances=False,
                                                                           return_indices=True))]

    def height(self, x, y):
        """At index coordinates x, y (arrays)."""
        (i, fx), (j, fy) = (self.weight(place, n) for place, n in ((x, self.z.shape[1]), (y, self.z.shape[0])))
        north = self.z[j, i] * (1 - fx) + self.z[j, i + 1] * fx
        south = self.z[j + 1, i] * (1 - fx) + self.z[j + 1, i + 1] * fx
        return north * (1 - fy) + south * fy

    @staticmethod
    def weight(place, n):
        first = np.clip(np.floor(place - 0.5).astype(int), 0, n - 2)
        return first, place - 0.5 - first

    def bounds(self):
        """Lowest and highest ground of each cell."""
        z = np.pad(self.z, 1, mode="reflect", reflect_type="odd")  # linear on to the edges
        return (of(z, 3)[1:-1, 1:-1] for of in (minimum_filter, maximum_filter))

    def share_unknown(self, road):
        """Of the edge of a road in index coordinates: how much of it, from 0 to 1, lies on cells without a height, but
        for those beside others: a grid may end half a cell beyond the terrain."""
        return self.far_from_known(*Edge(road, self, 0.0).place).mean()

    def far_from_known(self, x, y):
        """Whether points lie on cells without a height, but for those beside others."""
        j, i = (np.clip(at.astype(int), 0, n - 1) for at, n in zip((y, x), self.known.shape))
        return (distance_transform_edt(~self.known) > BESIDE)[j, i]


class Edge:
    """The edge of a road, or of a lane on one (surface): its straight pieces, points on them, and the height of the
    ground there."""

    def __init__(self, road, ground, tangent, surface=None):
        self.start, end = edges(road)
        self.along = end - self.start
        self.length2 = (self.along ** 2).sum(axis=1)
        self.ground, self.tangent = ground, tangent
        self.steps = np.ceil(np.sqrt(self.length2) / STEP).astype(int)
        self.first = np.cumsum(self.steps + 1) - self.steps - 1
        self.piece = np.repeat(np.arange(len(self.steps)), self.steps + 1)
        share = (np.arange(len(self.piece)) - self.first[self.piece]) / self.steps[self.piece]
        points = self.start[self.piece] + share[:, None] * self.along[self.piece]
        self.place = points.T
        self.points = cKDTree(points)
        self.most = self.highest(~ground.far_from_known(*self.place)) if not ground.known.all() else None
        z = ground.height(*self.place)
        self.drop = self.rounded(surface or road, z)
        self.z = self.lowered(z - self.drop, np.arange(len(points)))
        self.slack = max(np.abs(np.diff(of)).max() for of in (z, self.z))

    def highest(self, known):
        """What the edge's points are no higher than: where the ground is not known, than the nearest one where it is,
        as the nearest ground may be the top of a wall."""
        most = np.full(len(known), np.inf)
        if known.any() and not known.all():
            nearest = cKDTree(self.place.T[known]).query(self.place.T[~known])[1]
            most[~known] = self.ground.height(*self.place[:, known])[nearest]
        return most

    def rounded(self, road, z):
        """How much higher the ground z at the edge's points is than the road's surface leads to there: a cell that
        holds the foot of a wall or of a cutting has a height between both.

        The surface is a line through two points inwards; of a cutting on both sides, whose other edge is rounded, too,
        it is no lower than the first of them. A plane is its own line, and what a third point shows to be a hollow all
        across the road is none of the edge's.
        """
        inwards = np.stack([-self.along[:, 1], self.along[:, 0]], axis=1) / np.sqrt(self.length2)[:, None]
        inwards, points = inwards[self.piece], self.place.T
        drop, left = np.zeros(len(z)), np.ones(len(z), bool)
        for depth in DEPTHS:
            some = np.flatnonzero(left)
            some = some[contains(road, *(points[some] + ACROSS * 2 * depth * inwards[some]).T)]
            wide = contains(road, *(points[some] + ACROSS * 3 * depth * inwards[some]).T)
            first, second, third = (self.ground.height(*(points[some] + k * depth * inwards[some]).T)
                                    for k in (1, 2, 3))
            hollow = np.where(wide, np.maximum(0.0, first - 2 * second + third), 0.0)
            drop[some] = np.maximum(0.0, z[some] - np.maximum(2 * first - second, first) - hollow)
            left[some] = False
        _, same = np.unique(points.round(9), axis=0, return_inverse=True)    # two pieces share a corner
        shared = np.zeros(same.max() + 1)
        np.maximum.at(shared, same, drop)
        return shared[same]

    def lowered(self, z, points):
        return z if self.most is None else np.minimum(z, self.most[points])

    def bounds(self, shape):
        """Lowest and highest ground of what of the edge may be the nearest to a point of each cell; block by block."""
        column, row = np.meshgrid(*(np.arange(0, n, BLOCK) for n in shape[::-1]))
        middles = np.stack([column, row], axis=-1) + BLOCK / 2
        reach = self.points.query(middles)[0] + 2 * BLOCK * HALF_DIAGONAL + STEP
        near = self.points.query_ball_point(middles, reach)
        for of, way in ((np.min, -1), (np.max, 1)):
            z = np.vectorize(lambda some: of(self.z[some]) + way * self.slack, [float])(near)
            yield z.repeat(BLOCK, 0).repeat(BLOCK, 1)[:shape[0], :shape[1]]

    def cut(self, x, y):
        """Height of the cut at points x, y (1-d arrays)."""
        place = np.column_stack([x, y])
        near = self.points.query(place, min(NEAR, len(self.piece)))[1]
        piece = self.piece[near]     # of each point, several
        start, along = self.start[piece], self.along[piece]
        share = np.clip(((place[:, None] - start) * along).sum(axis=2) / self.length2[piece], 0, 1)
        foot = start + share[:, :, None] * along
        square = ((place[:, None] - foot) ** 2).sum(axis=2)
        nearest = np.arange(len(place)), square.argmin(axis=1)
        at = share[nearest] * self.steps[piece[nearest]]        # of the points of its piece
        before = np.minimum(at.astype(int), self.steps[piece[nearest]] - 1)
        point, part = self.first[piece[nearest]] + before, at - before
        drop = (1 - part) * self.drop[point] + part * self.drop[point + 1]
        return (self.lowered(self.ground.height(*foot[nearest].T) - drop, near[:, 0])
                + self.tangent * np.sqrt(square[nearest]))


def positive_mean(u, v, w):
    """Mean over triangles of max(0, f), f being linear with the values u, v, w (arrays) at the corners."""
    a, c = np.minimum(np.minimum(u, v), w), np.maximum(np.maximum(u, v), w)
    total = u + v + w
    b = total - a - c
    with np.errstate(invalid="ignore", divide="ignore"):
        tip = c ** 3 / (3 * (c - a) * (c - b))                # only c is above 0
        rest = total / 3 - a ** 3 / (3 * (a - b) * (a - c))   # only a is below
    return np.where(a >= 0, total / 3, np.where(c <= 0, 0, np.where(b <= 0, tip, rest)))


def linear_mean(a, b, c, d, t):
    """Mean of what is removed in squares with h = a, b, c, d at the corners, in turn, and the thickness t (arrays).

    Mean over both ways to divide a square into two triangles.
    """
    h = (a + b + c + d) / 4
    mean = np.clip(t - h, 0, t)
    low, high = np.minimum(np.minimum(a, b), np.minimum(c, d)), np.maximum(np.maximum(a, b), np.maximum(c, d))
    bent = ((low < 0) & (high > 0)) | ((low < t) & (high > t))
    if bent.any():
        a, b, c, d, t = (values[bent] for values in (a, b, c, d, t))
        total = 0
        for corners in ((a, b, c), (a, c, d), (a, b, d), (b, c, d)):
            total = total + (positive_mean(*(t - corner for corner in corners))
                             - positive_mean(*(-corner for corner in corners)))
        mean[bent] = np.clip(total / 4, 0, t)
    return mean


def heights(road, ground, tangent, x, y):
    """Height of the cut (m) at points x, y in index coordinates, NaN in the road; other arguments as of removed()."""
    z = Edge(road, ground, tangent).cut(x, y)
    return np.where([road.contains(Point(place)) for place in zip(x, y)], np.nan, z)


def one_cell(thickness):
    """A mesh of one cell, the grid."""
    rows, columns = thickness.shape
    return SimpleNamespace(x=np.array([0.0, columns]), y=np.array([0.0, rows]), shape=(1, 1))


def removed(thickness, ground, roads, tangent, mesh, k, silent=False, surface=None):
    """What must be removed, a Removed: the union of the cuts of all roads.

    roads: polygons in the grid; tangent: rise of the cut (m) per cell of distance; silent: no progress is shown;
    surface: the road whose lanes the roads are, as polygons; None: they are whole ones.
    """
    if not roads:
        return Removed(np.zeros(thickness.shape), np.zeros(mesh.shape), np.zeros(mesh.shape), 0.0, 0.0)
    work = _Work(thickness, ground, roads, tangent, mesh, k, surface)
    at = work.near()
    rows = np.flatnonzero(at.any(axis=1))
    step = max(1, STRIP // (k * k * at.shape[1]))
    strips = range(rows[0], rows[-1] + 1, step) if len(rows) else ()
    for top in strips if silent else progress(strips, "cutting"):
        columns = np.flatnonzero(at[top:top + step].any(axis=0))
        if len(columns):
            work.do(top, min(top + step, rows[-1] + 1), columns[0], columns[-1] + 1)
    return Removed(work.cells, work.mesh_road, work.mesh_beside, float(work.steep), float(work.unknown))


class _Work:
    def __init__(self, thickness, ground, roads, tangent, mesh, k, surface):
        self.t, self.ground, self.tangent = thickness, ground, tangent
        self.road = roads[0] if len(roads) == 1 else unary_union(roads)
        self.edges = [Edge(road, ground, tangent, surface) for road in roads]
        self.all, self.bent = self.kinds(*ground.bounds())
        self.lines = [Lines(n, k, lines) for n, lines in zip(thickness.shape, (mesh.y, mesh.x))]
        self.cells = np.zeros(thickness.shape)
        self.mesh_road, self.mesh_beside = np.zeros(mesh.shape), np.zeros(mesh.shape)
        self.steep = self.unknown = 0.0

    def parts(self, axis, first, last):
        """The lines along an axis (0: y) from cell first to last; cell, and mesh cell, of each part between them."""
        lines = self.lines[axis]
        some = slice(lines.first[first], lines.first[last])
        return (lines.at[some.start:some.stop + 1],
                np.repeat(np.arange(first, last), np.diff(lines.first[first:last + 1])), lines.mesh[some])

    @staticmethod
    def add(total, volume, rows, columns):
        """Add the volumes of parts to the cells, of the grid or the mesh, that they are in: rows, columns."""
        for axis, index in ((0, rows), (1, columns)):
            volume = np.add.reduceat(volume, np.flatnonzero(np.diff(index, prepend=-1)), axis)
        total[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1] += volume

    def kinds(self, low, high):
        """Cells of which all lies above the cut, and those of which neither all nor nothing does: two masks."""
        t, known = self.t, self.t > 0
        row, column = np.nonzero(known)
        all_, none = np.zeros(t.shape, bool), known.copy()
        for edge in self.edges:
            edge_low, edge_high = edge.bounds(t.shape)
            far = np.zeros(t.shape)
            far[known] = edge.points.query(np.column_stack([column, row]) + 0.5)[0]
            all_ |= known & (edge_high + self.tangent * (far + HALF_DIAGONAL) <= low)
            none &= edge_low + self.tangent * (far - HALF_DIAGONAL - STEP) >= high + t
        return all_, known & ~(all_ | none)

    def above_ground(self, x, y):
        """Height of the lowest cut above the ground at points x, y (1-d arrays)."""
        return np.min([edge.cut(x, y) for edge in self.edges], axis=0) - self.ground.height(x, y)

    def near(self):
        """Cells that may lose something: a mask."""
        on_road = geometry_mask([self.road], self.t.shape, Affine.identity(), all_touched=True, invert=True)
        return self.all | self.bent | (on_road & (self.t > 0))

    def do(self, top, bottom, left, right):
        """Rows top to bottom of the cells from left to right."""
        (y, row, mesh_row), (x, column, mesh_column) = self.parts(0, top, bottom), self.parts(1, left, right)
        fine = np.ix_(row - top, column - left)
        area = np.diff(y)[:, None] * np.diff(x)
        # moments about the corner: those of slivers are differences of larger numbers
        u, v = x - left, y - top
        road = self.road.intersection(box(left, top, right, bottom))
        on_road, in_x, in_y = coverage(translate(road, -left, -top), u, v)
        on_road[on_road < area * WHOLE] = 0
        on_road = np.where(on_road > area * (1 - WHOLE), area, on_road)

        # cells of which all, or nothing, lies above the cut need no more than their distance from the edge
        window = slice(top, bottom), slice(left, right)
        t, below, open_ = (values[window][fine] for values in (self.t, self.all, self.bent))
        open_ &= on_road < area
        mean = np.where(below, t, 0)

        if open_.any():
            corners = np.zeros((len(y), len(x)), bool)
            for part in (corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]):
                part |= open_
            h = np.full(corners.shape, np.nan)
            j, i = np.nonzero(corners)
            h[corners] = self.above_ground(x[i], y[j])
            four = [part[open_] for part in (h[:-1, :-1], h[:-1, 1:], h[1:, 1:], h[1:, :-1])]
            mean[open_] = linear_mean(four[0], four[1], four[2], four[3], t[open_])
            below[open_] = sum(four) < 0
            mixed = open_ & (on_road > 0)
            if mixed.any():
                # where h is linear beside the edge, its mean is its value at the centre of what is beside
                j, i = np.nonzero(mixed)
                rest = (area - on_road)[mixed]
                cx = np.clip((np.diff(u ** 2) / 2 * np.diff(v)[:, None] - in_x)[mixed] / rest, u[i], u[i + 1])
                cy = np.clip((np.diff(v ** 2)[:, None] / 2 * np.diff(u) - in_y)[mixed] / rest, v[j], v[j + 1])
                centre = self.above_ground(cx + left, cy + top)
                mean[mixed] = np.clip(t[mixed] - centre, 0, t[mixed])
                below[mixed] = centre < 0
                # not so where the cut leaves the deposit, above or below, next to the edge
                low, high = np.min(four, axis=0)[mixed[open_]], np.max(four, axis=0)[mixed[open_]]
                bent = (low < 0) | (high > t[mixed])
                parts = [box(x[a], y[b], x[a + 1], y[b + 1]).difference(road) for a, b in zip(i[bent], j[bent])]
                mean[j[bent], i[bent]] = self.mean_in(parts, t[j[bent], i[bent]])

        beside = (area - on_road) * mean
        bad = np.isnan(beside) | ~self.ground.known[np.ix_(row, column)]
        if bad.any():
            self.unknown += ((area - on_road) * t)[bad].sum()
            beside[bad] = 0
        self.steep += beside[below].sum()
        on_road = on_road * t
        self.add(self.cells, on_road + beside, row, column)
        self.add(self.mesh_road, on_road, mesh_row, mesh_column)
        self.add(self.mesh_beside, beside, mesh_row, mesh_column)

    def mean_in(self, parts, t):
        """Mean of what is removed in polygons beside the road, in each of which the thickness is even, t."""
        triangles = [(number, triangle.exterior.coords[:3]) for number, part in enumerate(parts)
                     for polygon in polygons_of(part) for triangle in triangulate(polygon)
                     if polygon.contains(triangle.centroid)]
        if not triangles:
            return np.zeros(len(parts))
        number, corners = (np.array(values) for values in zip(*triangles))
        (ax, ay), (bx, by), (cx, cy) = corners.transpose(1, 2, 0)
        area = np.abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
        every = corners.reshape(-1, 2)
        h = self.above_ground(every[:, 0], every[:, 1]).reshape(-1, 3).T
        volume = (positive_mean(*(t[number] - h)) - positive_mean(*-h)) * area
        total, area = (np.bincount(number, values, len(parts)) for values in (volume, area))
        return np.clip(np.divide(total, area, out=np.zeros(len(parts)), where=area > 0), 0, t)
