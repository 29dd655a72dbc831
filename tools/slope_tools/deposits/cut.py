"""The cut surface above a road, and what of a deposit lies above it. Index coordinates of the deposit's grid.

Surface of the cut: inside the road, the ground; outside, the height of the ground at the nearest point of the road's
edge plus tangent x distance. With h = cut - ground and the thickness t, which is even in a cell, what is removed is

    clip(surface - max(ground, cut), 0, t) = max(0, t - max(0, h)) = max(0, t - h) - max(0, -h)

that is, all of it on the road and where the cut lies below the ground, and never more than there is.

Every cell near the cut is divided into k x k parts, each of which the mesh's lines divide further. h is linear in the
triangles of a part, where the two terms have exact integrals: plane ground and a straight edge give exact volumes
whatever k is; only round corners (the cut around a corner is a cone), the seams between two edges, and rough ground
depend on k. A part that the edge crosses is divided by it into its exact areas.
"""
from typing import NamedTuple

import numpy as np
from shapely.affinity import translate
from shapely.geometry import Point, box
from shapely.ops import triangulate

from ..geometry import Lines, coverage, edges, polygons_of
from ..survey.rasters import progress

LEAF = 16           # cells along a side of a block that is not divided further
LEAF_FEW = 64       # the same where few edges are near
FEW = 24            # edges
TICK = 1000         # cells that the progress bar moves on at a time
CHUNK = 1_000_000   # point-edge pairs at a time
HALF_DIAGONAL = 0.5 ** 0.5  # of a cell
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

    A cell without a height is NaN in known; for its neighbours' sake it gets the mean of those that have one.
    """

    def __init__(self, z):
        self.known = np.isfinite(z)
        self.z = z if self.known.all() else rim_filled(z, self.known)

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

    def bounds(self, rows, columns):
        """Lowest and highest ground of the cells in those ranges (slices, which all lie in the grid)."""
        z = np.pad(self.z, 1, mode="reflect", reflect_type="odd")  # linear on to the edges
        z = z[rows.start:rows.stop + 2, columns.start:columns.stop + 2]
        low, high = z, z
        for _ in range(2):  # along the columns, then along the rows
            low = np.minimum(np.minimum(low[:-2], low[1:-1]), low[2:]).T
            high = np.maximum(np.maximum(high[:-2], high[1:-1]), high[2:]).T
        return low, high


def rim_filled(z, known):
    padded = np.pad(np.where(known, z, 0), 1)
    counted = np.pad(known.astype(float), 1)
    rows, columns = z.shape
    total, count = np.zeros(z.shape), np.zeros(z.shape)
    for j in range(3):
        for i in range(3):
            total += padded[j:j + rows, i:i + columns]
            count += counted[j:j + rows, i:i + columns]
    with np.errstate(invalid="ignore"):
        return np.where(known, z, total / count)


class Edge:
    """The road's edge: its straight pieces, and the height of the ground along them."""

    def __init__(self, road, ground, tangent):
        self.start, self.end = edges(road)
        self.along = self.end - self.start
        self.length2 = (self.along ** 2).sum(axis=1)
        self.ground, self.tangent = ground, tangent
        # lowest and highest ground along each piece, from points at most half a cell apart
        count = np.ceil(2 * np.sqrt(self.length2)).astype(int) + 1
        first = np.cumsum(count) - count
        edge = np.repeat(np.arange(len(count)), count)
        share = (np.arange(len(edge)) - first[edge]) / (count - 1)[edge]
        points = self.start[edge] + share[:, None] * self.along[edge]
        z = ground.height(*points.T)
        if not np.isfinite(z).all():
            raise NoGround(points[np.isnan(z)][0])
        between = np.abs(np.diff(z, append=z[-1]))
        between[first + count - 1] = 0
        slack = np.maximum.reduceat(between, first)
        self.low, self.high = np.minimum.reduceat(z, first) - slack, np.maximum.reduceat(z, first) + slack

    def squares(self, x, y, which):
        """Squared distance of points x, y to the pieces `which`, and the places on them (shares): (points, pieces)."""
        sx, sy, ax, ay, length2 = (values[which] for values in (*self.start.T, *self.along.T, self.length2))
        tx, ty = x[:, None] - sx, y[:, None] - sy
        share = tx * (ax / length2) + ty * (ay / length2)
        np.clip(share, 0, 1, out=share)
        tx -= share * ax
        ty -= share * ay
        tx *= tx
        ty *= ty
        tx += ty
        return tx, share

    def distance(self, x, y, which):
        """Distance of one point to each of the pieces `which`."""
        return np.sqrt(self.squares(np.array([x]), np.array([y]), which)[0][0])

    def nearest(self, x, y, which):
        """Distance of points x, y (2-d arrays) to the nearest of the pieces `which`."""
        return np.sqrt(self.squares(x.ravel(), y.ravel(), which)[0].min(axis=1)).reshape(x.shape)

    def candidates(self, which, left, top, right, bottom):
        """Those of the pieces `which` that may be the nearest to a point in the box: none is left out wrongly.

        Let r be the point of the edge nearest to the box's middle. Of a point p of the box, a point q of the edge is
        farther than r where f = |q - r|^2 - 2 (p - r)(q - r) > 0. f is linear in p: least at a corner; along a piece of
        length s it is at most s^2 / 4 less than at the piece's ends.
        """
        middle = np.array([[(left + right) / 2], [(top + bottom) / 2]])
        square, share = self.squares(middle[0], middle[1], which)
        first = square[0].argmin()
        r = self.start[which[first]] + share[0, first] * self.along[which[first]]
        corners = np.array([(x, y) for x in (left, right) for y in (top, bottom)]) - r
        least = np.minimum(*((q ** 2).sum(axis=1) - 2 * (corners @ q.T).max(axis=0)
                             for q in (self.start[which] - r, self.end[which] - r)))
        return which[least <= self.length2[which] / 4 + WHOLE]

    def cut(self, x, y, which):
        """Height of the cut at points x, y (1-d arrays), to which the nearest of the pieces `which` is the nearest."""
        z = np.empty(len(x))
        step = max(1, CHUNK // len(which))
        for first in range(0, len(x), step):
            some = slice(first, first + step)
            square, share = self.squares(x[some], y[some], which)
            nearest = square.argmin(axis=1)
            points = np.arange(len(nearest)), nearest
            foot = self.start[which[nearest]] + share[points][:, None] * self.along[which[nearest]]
            z[some] = self.ground.height(*foot.T) + self.tangent * np.sqrt(square[points])
        return z


class NoGround(Exception):
    """Raised with a point (index coordinates) of the road's edge where the ground is not known."""


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
    edge = Edge(road, ground, tangent)
    z = edge.cut(x, y, np.arange(len(edge.start)))
    return np.where([road.contains(Point(place)) for place in zip(x, y)], np.nan, z)


def removed(thickness, ground, road, tangent, mesh, k):
    """What must be removed, a Removed. road: polygon in the grid; tangent: rise of the cut (m) per cell of distance.

    The grid is divided into blocks, and these again; a block where nothing, or all of it, lies above the cut is done,
    by bounds that hold for every point in it. Each block knows the pieces of the edge that may be nearest to it.
    """
    work = _Work(thickness, ground, road, tangent, mesh, k)
    rows, columns = (np.flatnonzero((thickness > 0).any(axis=axis)) for axis in (1, 0))
    if len(rows):
        work.go(rows[0], rows[-1] + 1, columns[0], columns[-1] + 1, road)
    return Removed(work.cells, work.mesh_road, work.mesh_beside, float(work.steep), float(work.unknown))


class _Work:
    def __init__(self, thickness, ground, road, tangent, mesh, k):
        self.t, self.ground, self.tangent = thickness, ground, tangent
        self.edge = Edge(road, ground, tangent)
        n = thickness.shape
        self.fine = Lines(n[0], k, mesh.y), Lines(n[1], k, mesh.x)
        self.coarse = Lines(n[0], 1, mesh.y), Lines(n[1], 1, mesh.x)
        self.cells = np.zeros(n)
        self.mesh_road, self.mesh_beside = np.zeros(mesh.shape), np.zeros(mesh.shape)
        self.steep = self.unknown = 0.0

    def go(self, top, bottom, left, right, road):
        window = slice(top, bottom), slice(left, right)
        t = self.t[window]
        low, high = self.ground.bounds(*window)
        known = self.ground.known[window] & np.isfinite(low)
        with np.errstate(invalid="ignore"):
            # bounds of the ground and of the surface, where there is a deposit
            self.low = np.where(t > 0, np.where(known, low, -np.inf), np.inf)
            self.high = np.where(t > 0, np.where(known, high + t, np.inf), -np.inf)
        self.corner = top, left
        blocks = [(top, bottom, left, right, road, np.arange(len(self.edge.length2)))]
        total = (bottom - top) * (right - left) // TICK
        for _ in progress(self.walk(blocks), "cutting", total):
            pass

    def walk(self, blocks):
        """Do all blocks; yields once per TICK cells done, for the progress bar."""
        done = 0
        while blocks:
            top, bottom, left, right, *_ = block = blocks.pop()
            parts = self.block(*block)
            blocks += parts
            if not parts:
                done += (bottom - top) * (right - left)
                yield from range(done // TICK)
                done %= TICK

    def block(self, top, bottom, left, right, road, near):
        """Do a block, or give the blocks that it must be divided into."""
        at = slice(top - self.corner[0], bottom - self.corner[0]), slice(left - self.corner[1], right - self.corner[1])
        high = self.high[at].max()
        if high == -np.inf:
            return []
        if road is not None:
            road = road.intersection(box(left, top, right, bottom))
            cells = (bottom - top) * (right - left)
            area = sum(part.area for part in polygons_of(road))
            if area >= cells * (1 - WHOLE):
                self.take_all(top, bottom, left, right, self.mesh_road)
                return []
            if area <= cells * WHOLE:
                road = None
        distance = self.edge.distance((left + right) / 2, (top + bottom) / 2, near)
        reach = np.hypot(bottom - top, right - left) / 2
        nearest = distance.min()
        near = near[distance <= nearest + 2 * reach + WHOLE]
        near = self.edge.candidates(near, left, top, right, bottom)
        if road is None:
            low = self.low[at].min()
            if self.edge.low[near].min() + self.tangent * max(0, nearest - reach) >= high:
                return []
            if self.edge.high[near].max() + self.tangent * (nearest + reach) <= low:
                self.steep += self.take_all(top, bottom, left, right, self.mesh_beside)
                return []
        side = LEAF_FEW if len(near) <= FEW else LEAF
        if max(bottom - top, right - left) <= side:
            self.leaf(top, bottom, left, right, road, near)
            return []
        rows = [top, (top + bottom) // 2, bottom] if bottom - top > 1 else [top, bottom]
        columns = [left, (left + right) // 2, right] if right - left > 1 else [left, right]
        return [(a, b, c, d, road, near) for a, b in zip(rows, rows[1:]) for c, d in zip(columns, columns[1:])]

    def place(self, lines, top, bottom, left, right):
        """Of a block, on fine or coarse lines: lines (y, x), cell and mesh cell of each part (rows, columns)."""
        found = []
        for axis, first, last in ((lines[0], top, bottom), (lines[1], left, right)):
            a, b = axis.first[first], axis.first[last]
            found.append((axis.at[a:b + 1], np.repeat(np.arange(first, last), np.diff(axis.first[first:last + 1])),
                          axis.mesh[a:b]))
        return found

    def add(self, total, volume, rows, columns):
        """Add the volumes of parts to the cells, of the grid or the mesh, that they are in: rows, columns."""
        for axis, index in ((0, rows), (1, columns)):
            volume = np.add.reduceat(volume, np.flatnonzero(np.diff(index, prepend=-1)), axis)
        total[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1] += volume

    def take_all(self, top, bottom, left, right, mesh):
        (y, row, mesh_row), (x, column, mesh_column) = self.place(self.coarse, top, bottom, left, right)
        volume = self.t[np.ix_(row, column)] * (np.diff(y)[:, None] * np.diff(x))
        self.cells[top:bottom, left:right] = self.t[top:bottom, left:right]
        self.add(mesh, volume, mesh_row, mesh_column)
        return volume.sum()

    def leaf(self, top, bottom, left, right, road, near):
        (y, row, mesh_row), (x, column, mesh_column) = self.place(self.fine, top, bottom, left, right)
        fine = np.ix_(row - top, column - left)
        area = np.diff(y)[:, None] * np.diff(x)
        on_road = np.zeros(area.shape)
        if road is not None:
            # moments about the block's corner: those of slivers are differences of larger numbers
            u, v = x - left, y - top
            on_road, in_x, in_y = coverage(translate(road, -left, -top), u, v)
            on_road[on_road < area * WHOLE] = 0
            on_road = np.where(on_road > area * (1 - WHOLE), area, on_road)

        # cells of which all, or nothing, lies above the cut need no more than their distance from the edge
        t = self.t[top:bottom, left:right]
        at = slice(top - self.corner[0], bottom - self.corner[0]), slice(left - self.corner[1], right - self.corner[1])
        middle_x, middle_y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
        distance = self.edge.nearest(middle_x, middle_y, near)
        below = self.edge.high[near].max() + self.tangent * (distance + HALF_DIAGONAL) <= self.low[at]
        above = self.edge.low[near].min() + self.tangent * (distance - HALF_DIAGONAL) >= self.high[at]
        open_ = (~(below | above) & (t > 0))[fine] & (on_road < area)
        t, below = t[fine], below[fine]
        mean = np.where(below, t, 0)

        if open_.any():
            corners = np.zeros((len(y), len(x)), bool)
            for part in (corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]):
                part |= open_
            h = np.full(corners.shape, np.nan)
            j, i = np.nonzero(corners)
            h[corners] = self.above_ground(x[i], y[j], near)
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
                centre = self.above_ground(cx + left, cy + top, near)
                mean[mixed] = np.clip(t[mixed] - centre, 0, t[mixed])
                below[mixed] = centre < 0
                # not so where the cut leaves the deposit, above or below, next to the edge
                low, high = np.min(four, axis=0)[mixed[open_]], np.max(four, axis=0)[mixed[open_]]
                bent = (low < 0) | (high > t[mixed])
                parts = [box(x[a], y[b], x[a + 1], y[b + 1]).difference(road) for a, b in zip(i[bent], j[bent])]
                mean[j[bent], i[bent]] = self.mean_in(parts, t[j[bent], i[bent]], near)

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

    def mean_in(self, parts, t, near):
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
        h = self.above_ground(every[:, 0], every[:, 1], near).reshape(-1, 3).T
        volume = (positive_mean(*(t[number] - h)) - positive_mean(*-h)) * area
        total, area = (np.bincount(number, values, len(parts)) for values in (volume, area))
        return np.clip(np.divide(total, area, out=np.zeros(len(parts)), where=area > 0), 0, t)

    def above_ground(self, x, y, near):
        """Height of the cut above the ground at points in index coordinates x, y (1-d arrays)."""
        return self.edge.cut(x, y, near) - self.ground.height(x, y)
