"""The line that a mass took, in plan: the path of its centroid, continued to the front; of several, the largest's.

Where the centroid was is known from the dumps of a run. Beyond the last one, and where there are no dumps, the line
goes through the middles of bands across the flow: cells at the same distance from the release, measured within the
cells that the mass touched, so that it follows a valley around its bends. It ends where next to nothing lies farther
on, or where the middles no longer follow each other, as among stray balls.
"""
import math
import re
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from scipy import ndimage, sparse
from scipy.sparse import csgraph
from shapely.geometry import LineString

from .. import quantiles
from ..errors import SlopeError
from . import dumps

MOST_CELLS = 90_000     # cells that distances are measured on; finer grids are thinned out
BANDS = 30
WITHIN = 0.99           # share of the mass within the distance to which the line goes
SHARPEST = 60           # degrees; bands that turn more do not follow each other
MOST_BYTES = 2e8        # of dumps that are read
MOST_DUMPS = 24


class FlowPath(NamedTuple):
    """Points of a line, rows of local x y, down the slope; dumped: whether the centroid is from dumps."""
    points: np.ndarray
    dumped: bool


def path(result, ground):
    """The FlowPath of a run's mass; None where it has none: it did not move, or touched next to nothing."""
    track = centroids(result, ground)
    bands = Bands(ground, result.thickness)
    if track is None:
        start = bands.start
        points = followed(start[None, :], bands.points) if start is not None else np.empty((0, 2))
    else:
        track = np.asarray(smooth(outward(track, bands)))
        x, y = track[-1]
        at = bands.distance(x, y)
        beyond = bands.points[bands.at > at + bands.width] if at is not None else np.empty((0, 2))
        points = followed(track, beyond)
    if len(points) < 2:
        return None
    line = LineString(smooth(points)).simplify(ground.cell / 2)
    if line.length < 3 * ground.cell:
        return None
    return FlowPath(np.asarray(line.coords)[:, :2], track is not None)


def outward(track, bands):
    """A track as far as it leads away from the release: a mass that ran up the other side of a valley comes back."""
    far = [bands.distance(*point) or 0.0 for point in track]
    return track[:int(np.argmax(far)) + 1] if max(far) > 0 else track


def followed(points, others):
    """Points, and as many of the others as go on in about the same direction."""
    places = list(points)
    for point in others:
        step = point - places[-1]
        if not np.hypot(*step) > 0:
            continue
        if len(places) > 1:
            # over some length: the last points of a centroid that comes to rest are close to each other
            back = next((one for one in places[-2::-1] if np.hypot(*(places[-1] - one)) >= np.hypot(*step) / 2),
                        places[0])
            way = places[-1] - back
            turn = math.atan2(way[0] * step[1] - way[1] * step[0], way @ step)
            if np.hypot(*way) > 0 and abs(turn) > math.radians(SHARPEST):
                break
        places.append(point)
    return np.array(places)


# --- bands across the flow ---

class Bands:
    """Bands of the cells that the mass touched, by their distance from the release.

    points: their middles, weighted with the largest thickness, as far as the deposit lies; at: their distances (m);
    width (m); start: the middle of the release, None without one.
    """

    def __init__(self, ground, deposit):
        self.step = step = max(1, int(np.ceil(np.sqrt(ground.touched.size / MOST_CELLS))))
        self.inverse = ~ground.raster.transform
        others = ground.source & ground.beside
        touched, release = (thinned(mask & ~others, step) for mask in (ground.touched, ground.release))
        weight, mass, deep = (np.nan_to_num(values[::step, ::step]) for values in (
            ground.max_thickness, deposit, ground.slip_depth))
        self.x, self.y = ground.x[::step, ::step], ground.y[::step, ::step]
        release &= touched
        self.points, self.at, self.width, self.start = np.empty((0, 2)), np.empty(0), 0.0, None
        self.distances = np.full(touched.shape, np.inf)
        if not release.any():
            return
        self.start = self.middle(release, np.maximum(deep, 1e-3))
        self.distances = compute_path_distances(touched, release, ground.cell * step)
        reached = np.isfinite(self.distances)
        beyond = reached & (self.distances > 0) & (weight > 0)
        if not (beyond.any() and mass[reached].sum() > 0):
            return
        longest = quantiles.within(self.distances[reached], mass[reached], WITHIN)
        bands = min(BANDS, int(longest / (2 * ground.cell * step)))
        if bands < 2:
            return
        self.width = longest / bands
        points, at = [], []
        for k in range(bands):
            mask = largest_part(beyond & (self.distances > k * self.width)
                                & (self.distances <= (k + 1) * self.width), weight)
            if mask.any():
                points.append(self.middle(mask, weight))
                at.append((k + 0.5) * self.width)
        self.points, self.at = np.reshape(points, (-1, 2)), np.array(at)

    def middle(self, mask, weight):
        total = weight[mask].sum()
        return np.array([(self.x[mask] * weight[mask]).sum(), (self.y[mask] * weight[mask]).sum()]) / total

    def distance(self, x, y):
        """Distance (m) from the release at a point; None where the mass never was."""
        column, row = (int(value // self.step) for value in self.inverse @ (x, y))
        rows, columns = self.distances.shape
        inside = 0 <= row < rows and 0 <= column < columns
        return float(self.distances[row, column]) if inside and np.isfinite(self.distances[row, column]) else None


def thinned(values, step):
    """Every step-th cell; of a mask, the blocks that hold any."""
    if step == 1 or values.dtype != bool:
        return values[::step, ::step]
    rows, columns = (-(-n // step) for n in values.shape)
    padded = np.zeros((rows * step, columns * step), bool)
    padded[:values.shape[0], :values.shape[1]] = values
    return padded.reshape(rows, step, columns, step).any(axis=(1, 3))


def compute_path_distances(within, start, cell):
    """Distance (m) of each cell from the nearest start, over neighbours (8) within a mask; inf where none leads to."""
    number = np.full(within.shape, -1)
    number[within] = np.arange(np.count_nonzero(within))
    starts, other, length = [], [], []
    rows, columns = within.shape
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a = number[:rows - down, max(0, -right):columns - max(0, right)]
        b = number[down:, max(0, right):columns + min(0, right)]
        both = (a >= 0) & (b >= 0)
        starts.append(a[both])
        other.append(b[both])
        length.append(np.full(np.count_nonzero(both), np.hypot(down, right) * cell))
    count = np.count_nonzero(within)
    graph = sparse.csr_matrix((np.concatenate(length), (np.concatenate(starts), np.concatenate(other))), (count, count))
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

def centroids(result, ground) -> Optional[np.ndarray]:
    """Where the centroid was, in plan, in the order of time; None without several dumps of the mass.

    Of several bodies that of the largest: of the balls that were there in the first dump.
    """
    shots = snapshots(result.folder, result.summary["stop"]["step"])
    step = max(1, -(-len(shots) // MOST_DUMPS))
    several = bool((ground.source & ground.beside).any())
    shots = shots[:several] + shots[several:][::-1][::step][::-1]       # the last one among them
    if len(shots) < 3 or sum(path.stat().st_size for path in shots) > MOST_BYTES:
        return None
    places: List[np.ndarray] = []
    others = np.empty(0, int)
    for path in shots:
        try:
            shot = dumps.last(path, ("diameter", "radius"))
        except SlopeError:      # of another kind, or not complete
            return None
        if len(shot.of["id"]) > result.summary["balls"]["released"]:
            return None         # more than the mass, fixed balls among them
        size = shot.of.get("diameter", shot.of.get("radius"))
        weight = size ** 3 if size is not None and (size > 0).all() else np.ones(len(shot.of["id"]))
        if several:
            if not places:
                others = shot.of["id"][np.nan_to_num(ground.along(ground.beside * 1.0, *shot.place[:, :2].T)) > 0.5]
            weight = weight * ~np.isin(shot.of["id"], others)
        if not weight.any():
            return None
        places.append(weight @ shot.place[:, :2] / weight.sum())
    return np.array(places)


def snapshots(folder: Path, last: int, begin: str = "") -> List[Path]:
    """Text dumps of a run whose names, with this beginning, differ in the step only: in the order of the steps, up to
    the last.
    """
    series: Dict[Tuple[str, str], List[Tuple[int, Path]]] = {}
    for path in folder.glob("*.dump*"):
        match = re.fullmatch(r"(.*?)(\d+)(\.dump(?:\.gz)?)", path.name)
        if match and int(match[2]) <= last and path.name.startswith(begin):
            series.setdefault((match[1], match[3]), []).append((int(match[2]), path))
    longest: List[Tuple[int, Path]] = max(series.values(), key=len, default=[])
    return [path for _, path in sorted(longest)]
