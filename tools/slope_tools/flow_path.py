"""The line that the mass took, in plan: the path of its centroid, continued to the head of the scar and to the front.

The dumps of a run tell where the centroid was. Before and beyond, and where there are no dumps, the line goes through
the middles of bands across the flow: cells at the same distance from the highest released ones, measured within the
cells that the mass touched, so that it follows a valley around its bends.
"""
import re
from typing import List, NamedTuple, Optional

import numpy as np
from scipy import ndimage, sparse
from scipy.sparse import csgraph
from shapely.geometry import LineString

from . import dumps
from .errors import SlopeError

MOST_CELLS = 90_000     # cells that distances are measured on; finer grids are thinned out
HIGHEST = 5             # percent of the released cells that are the head
BANDS = 30
MOST_BYTES = 2e8        # of dumps that are read
MOST_DUMPS = 24


class Path(NamedTuple):
    """Points of a line, rows of local x y, from the head of the scar on; dumped: whether dumps told the centroid."""
    points: np.ndarray
    dumped: bool


def path(result, ground):
    """The Path of a run's mass; None where it has none: it did not move, or touched next to nothing."""
    bands = through_bands(ground)
    if bands is None:
        return None
    points, at, distance = bands
    track = centroids(result)
    if track is not None:
        ends = [distance(*track[k]) for k in (0, -1)]
        room = (at[-1] - at[0]) / BANDS
        if None not in ends and ends[0] < ends[1]:
            points = np.concatenate([points[at < ends[0] - room], track, points[at > ends[1] + room]])
        else:
            track = None
    line = LineString(smooth(points)).simplify(ground.cell / 2)
    if line.length < 3 * ground.cell:
        return None
    return Path(np.asarray(line.coords)[:, :2], track is not None)


# --- bands across the flow ---

def through_bands(ground):
    """Middles of the bands, their distances from the head, and the distance at a point (None where nothing was)."""
    step = max(1, int(np.ceil(np.sqrt(ground.touched.size / MOST_CELLS))))
    touched, before, weight, release = (thinned(values, step) for values in (
        ground.touched, ground.before, ground.max_thickness, ground.release))
    x, y = ground.x[::step, ::step], ground.y[::step, ::step]
    start = release & touched & np.isfinite(before)
    if not start.any():
        start = touched & np.isfinite(before)
    if not start.any():
        return None
    head = start & (before >= np.percentile(before[start], 100 - HIGHEST))
    distance = distances(touched, head, ground.cell * step)
    reached = np.isfinite(distance)
    longest = distance[reached].max()
    if longest < 4 * ground.cell * step:
        return None
    bands = min(BANDS, int(longest / (2 * ground.cell * step)))
    of = np.minimum((distance[reached] / longest * bands).astype(int), bands - 1)
    band = np.full(distance.shape, -1)
    band[reached] = of
    weight = np.where(reached, np.maximum(weight, 1e-6), 0)
    points, at = [], []
    for k in range(bands):
        mask = largest_part(band == k, weight)
        if mask.any():
            total = weight[mask].sum()
            points.append(((x[mask] * weight[mask]).sum() / total, (y[mask] * weight[mask]).sum() / total))
            at.append((distance[mask] * weight[mask]).sum() / total)

    def distance_at(px, py):
        column, row = ~ground.raster.transform * (px, py)
        row, column = int(row // step), int(column // step)
        if not (0 <= row < distance.shape[0] and 0 <= column < distance.shape[1]):
            return None
        return float(distance[row, column]) if np.isfinite(distance[row, column]) else None
    return np.array(points), np.array(at), distance_at


def thinned(values, step):
    """Every step-th cell; of a mask, the blocks that hold any."""
    if step == 1 or values.dtype != bool:
        return values[::step, ::step]
    rows, columns = (-(-n // step) for n in values.shape)
    padded = np.zeros((rows * step, columns * step), bool)
    padded[:values.shape[0], :values.shape[1]] = values
    return padded.reshape(rows, step, columns, step).any(axis=(1, 3))


def distances(within, start, cell):
    """Distance (m) of each cell from the nearest start, over neighbours (8) within a mask; inf where none leads to."""
    number = np.full(within.shape, -1)
    number[within] = np.arange(np.count_nonzero(within))
    one, other, length = [], [], []
    rows, columns = within.shape
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a = number[:rows - down, max(0, -right):columns - max(0, right)]
        b = number[down:, max(0, right):columns + min(0, right)]
        both = (a >= 0) & (b >= 0)
        one.append(a[both])
        other.append(b[both])
        length.append(np.full(np.count_nonzero(both), np.hypot(down, right) * cell))
    count = np.count_nonzero(within)
    graph = sparse.csr_matrix((np.concatenate(length), (np.concatenate(one), np.concatenate(other))), (count, count))
    found = np.full(within.shape, np.inf)
    found[within] = csgraph.dijkstra(graph, directed=False, indices=number[start], min_only=True)
    return found


def largest_part(mask, weight):
    """The part of a mask that hangs together and weighs most."""
    labels, count = ndimage.label(mask, np.ones((3, 3), int))
    if count < 2:
        return mask
    return labels == 1 + int(np.argmax(ndimage.sum_labels(weight, labels, np.arange(1, count + 1))))


def smooth(points):
    """Points, each but the ends the mean of itself and its neighbours."""
    if len(points) < 3:
        return points
    inner = (points[:-2] + 2 * points[1:-1] + points[2:]) / 4
    return np.concatenate([points[:1], inner, points[-1:]])


# --- dumps ---

def centroids(result) -> Optional[np.ndarray]:
    """Where the centroid was, in plan, in the order of time; None without several dumps of the mass."""
    found = snapshots(result.folder, result.summary["stop"]["step"])
    step = max(1, -(-len(found) // MOST_DUMPS))
    found = found[::-1][::step][::-1]       # the last one among them
    if len(found) < 3 or sum(path.stat().st_size for path in found) > MOST_BYTES:
        return None
    places: List[np.ndarray] = []
    for path in found:
        try:
            shot = dumps.last(path, ("diameter", "radius"))
        except SlopeError:      # of another kind, or not complete
            return None
        if len(shot.of["id"]) > result.summary["balls"]["released"]:
            return None         # more than the mass, fixed balls among them
        size = shot.of.get("diameter", shot.of.get("radius"))
        weight = size ** 3 if size is not None and (size > 0).all() else np.ones(len(shot.of["id"]))
        places.append(weight @ shot.place[:, :2] / weight.sum())
    return np.array(places)


def snapshots(folder, last):
    """Text dumps of a run whose names differ in the step only, in the order of the steps, up to the last."""
    series = {}
    for path in folder.glob("*.dump*"):
        match = re.fullmatch(r"(.*?)(\d+)(\.dump(?:\.gz)?)", path.name)
        if match and int(match[2]) <= last:
            series.setdefault((match[1], match[3]), []).append((int(match[2]), path))
    longest = max(series.values(), key=len, default=[])
    return [path for _, path in sorted(longest)]
