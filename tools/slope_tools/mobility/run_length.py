"""How far a run's mass went, as the length of a known event is measured: along the fall path, to its deposit's tip.

The tip is the farthest cell of any lobe: cells that are thicker than a threshold and touch each other, at sides or at
corners, and that hold at least a share of the released volume together. Gaps between lobes do not count, nor do stray
balls. A cell lies as far along the path as the point of the path nearest to it, and at least as far as the straight
line from the path's beginning, the shortest way to it: a mass may cross a valley where steepest descent follows the
river.
"""
import functools
import math
from pathlib import Path
from typing import NamedTuple, Optional, Tuple

import numpy as np
from affine import Affine
from scipy import ndimage
from scipy.spatial import cKDTree

from ..deposits.deposit import EIGHT, Deposit, top
from ..errors import SlopeError
from ..survey.rasters import Raster
from . import body, fall_path
from .fall_path import FallPath

THRESHOLD = 0.1         # m; cells of a lobe are thicker
LEAST = 0.01            # of the released volume, in a lobe
OTHERS = 0.005, 0.02    # what else it might be: the change is shown
OF_99 = 0.933           # 99 % of a volume stay within this part of the straight length: Acheron's deposit and its runs
STRAIGHT, ON_PATH = "straight", "along the fall path"       # what a length is
DECIMALS = 3            # of a distance, m: cells as far as each other tie, whatever rounding makes of them
KEPT = 4                # paths: runs of a study have one body, or a few


class RunLength(NamedTuple):
    """Of a deposit's lobes.

    distance: m; straight: m, as the crow flies; tip: local x, y of the cell that is the farthest; angle: degrees below
    the horizontal, of the fall from the highest released ball to the tip's surface over the distance, None where no
    height is known; lobes: how many count; share: of the released volume in them; mask: their cells, rows from the
    north; on_path: whether there is a fall path; without one the distance is the straight one; others: distance by each
    of OTHERS, of measure_run_length() only.
    """
    distance: float
    straight: float
    tip: Tuple[float, float]
    angle: Optional[float]
    lobes: int
    share: float
    mask: np.ndarray
    on_path: bool
    others: Tuple[float, ...] = ()


def of_deposit(deposit: Deposit, path: Optional[FallPath], least: float = LEAST,
               threshold: float = THRESHOLD) -> Optional[RunLength]:
    """The RunLength of a deposit; None where it is nowhere thicker than threshold (m).

    least: share of the released volume that a lobe must have; if none has it, the largest one counts.
    """
    mask, number = lobes(deposit, least, threshold)
    if not number:
        return None
    highest = top(deposit)
    rows, columns = np.nonzero(mask)
    places = np.column_stack(deposit.raster.transform @ np.array([columns + 0.5, rows + 0.5]))
    distances, straight = lengths_of(places, path, deposit)
    far = int(np.argmax(distances))
    distance = round(float(distances[far]), DECIMALS)
    drop = highest.z - float((deposit.base + deposit.raster.z)[rows[far], columns[far]])
    angle = math.degrees(math.atan2(drop, distance)) if math.isfinite(drop) else None
    held = float(deposit.raster.z[mask].sum()) * deposit.cell ** 2
    return RunLength(distance, float(straight.max()), (float(places[far, 0]), float(places[far, 1])), angle, number,
                     held / released(deposit), mask, path is not None)


def lengths_of(places: np.ndarray, path: Optional[FallPath], deposit: Deposit) -> Tuple[np.ndarray, np.ndarray]:
    """How far places (n, 2) lie from where a mass began, m: along the path, and as the crow flies."""
    highest = top(deposit)
    begin = (path.x[0], path.y[0]) if path else (highest.x, highest.y)
    straight = np.hypot(*(places - begin).T)
    return (np.maximum(measure_along_path(path, places), straight) if path else straight), straight


def released(deposit: Deposit) -> float:
    """m3."""
    return float(deposit.summary["volume"]["released"])


def lobes(deposit: Deposit, least: float = LEAST, threshold: float = THRESHOLD) -> Tuple[np.ndarray, int]:
    """Mask of the cells in lobes, and the number of these."""
    thickness = deposit.raster.z
    labels, parts = ndimage.label(thickness > threshold, EIGHT)
    if not parts:
        return labels > 0, 0
    volume = ndimage.sum_labels(thickness, labels, np.arange(1, parts + 1)) * deposit.cell ** 2
    large = np.flatnonzero(volume >= min(least * released(deposit), volume.max()))
    return np.isin(labels, 1 + large), len(large)


def measure_along_path(path: FallPath, places: np.ndarray) -> np.ndarray:
    """Length (m) of a path up to its point nearest to each place (n, 2)."""
    points = np.column_stack([path.x, path.y])
    nearest = cKDTree(points).query(places)[1]
    lengths, closest = np.zeros(len(places)), np.full(len(places), np.inf)
    for first in (np.maximum(nearest - 1, 0), np.minimum(nearest, len(points) - 2)):
        way = points[first + 1] - points[first]
        part = np.clip(((places - points[first]) * way).sum(axis=1) / np.maximum((way ** 2).sum(axis=1), 1e-30), 0, 1)
        away = np.hypot(*(points[first] + part[:, None] * way - places).T)
        length = path.length[first] + part * (path.length[first + 1] - path.length[first])
        lengths, closest = np.where(away < closest, length, lengths), np.minimum(away, closest)
    return lengths


def measure_run_length(deposit: Deposit, terrain: Optional[Path]) -> Optional[RunLength]:
    """The RunLength of a run; terrain: the ground before, None where it is not in reach: there is no fall path then."""
    path = path_of(deposit, terrain)
    found = of_deposit(deposit, path)
    others = [of_deposit(deposit, path, least) for least in OTHERS]
    return found and found._replace(others=tuple(one.distance for one in others if one))


def path_of(deposit: Deposit, terrain: Optional[Path]) -> Optional[FallPath]:
    """The fall path of a run's body to the end of its terrain; None without a body, or on level ground."""
    if not (terrain and terrain.is_file()):
        return None
    before, depth = body.find_ground_before(deposit.raster, deposit.base, terrain)
    return _path(before.tobytes(), depth.tobytes(), depth.shape, tuple(deposit.raster.transform))


@functools.lru_cache(maxsize=KEPT)
def _path(before: bytes, depth: bytes, shape: Tuple[int, int], transform: Tuple[float, ...]) -> Optional[FallPath]:
    """Of arrays of floats, which cannot be kept by their values as they are."""
    raster = Raster(np.frombuffer(before).reshape(shape), Affine(*transform[:6]), None)
    try:
        mass = body.of_arrays(raster, np.frombuffer(depth).reshape(shape), "the run")
        return fall_path.trace(mass, math.hypot(*shape) * mass.cell)
    except SlopeError:
        return None
