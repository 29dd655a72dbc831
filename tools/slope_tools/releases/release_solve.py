"""From a slip surface to a body: its depths, its numbers, and the free number that makes a depth or a volume."""
import heapq
import math
from typing import Callable, NamedTuple, Tuple

import numpy as np
import scipy
from scipy.ndimage import binary_dilation, binary_erosion, generate_binary_structure, maximum_filter

from ..digits import at_least, at_most
from ..errors import SlopeError
from .release_area import Area, fall
from .release_bodies import Shape

THINNEST = 1e-3     # m; what is thinner is not in the body
DECIMALS = 4        # of a written height of the slip surface, m
LOOKS = 41          # numbers that are tried of a shape whose body does not always grow with it
EXACT = 1e-12       # relative, of the free number
SHALLOW = "--shape slab, a layer of one depth, or "     # what is to be taken where a shape cannot be as shallow
MET = 1e-6          # relative: a depth or volume that differs by more is jumped over


class Measures(NamedTuple):
    """The numbers of a body; m, m2, m3, degrees."""
    volume: float
    largest_depth: float    # vertical
    mean_depth: float
    area: float             # in plan, of the cells in the body
    cells: int
    mean_slope: float       # of the ground over it
    slip_slope: float       # of the slip surface, mean
    bearing: float          # compass bearing of the fall line, downhill
    wall: float             # largest depth at the rim of the polygon: there the body ends in a wall
    highest: float          # of the ground over it
    lowest: float


def depths(area: Area, surface: np.ndarray) -> np.ndarray:
    """How far (m) a surface lies below the ground, 0 outside of the polygon and where it is not below."""
    with np.errstate(invalid="ignore"):
        return np.where(area.inside & (surface < area.z), area.z - surface, 0.0)


def compute_volume(depth: np.ndarray, cell: float) -> float:
    """Volume (m3) between two terrains whose nodes differ by depth (m; NaN: none), 0 on the outermost two.

    Exact, as a bilinear patch has the mean of its four corners.
    """
    return float(np.nansum(depth)) * cell ** 2


def solved(area: Area, shape: Shape, wanted: float, measure: Callable[[np.ndarray], float], called: str,
           unit: str) -> Tuple[float, np.ndarray]:
    """The free number of a shape at which measure(depths) is what is wanted, and the depths.

    called: what messages call what is wanted. Raises SlopeError if there is no such number.
    """
    def find(number):
        return depths(area, shape.surface(number))

    def miss(number):
        return measure(find(number)) - wanted

    tried = np.array([shape.least, shape.most]) if shape.steady else np.linspace(shape.least, shape.most, LOOKS)
    misses = np.array([miss(number) for number in tried])
    rises = np.flatnonzero((misses[:-1] <= 0) & (misses[1:] >= 0))
    if not len(rises) and misses.max() < 0:
        what = shape.limit if np.argmax(misses) == len(misses) - 1 else f"the largest {shape.name}"
        raise SlopeError(called, f"must be at most {at_most(misses.max() + wanted)} {unit}, that of {what} within the "
                         f"release polygon: take a larger polygon or another shape", f"{wanted:.10g}")
    if not len(rises):
        why = (f"that of the smallest {shape.name} within the release polygon: take "
               f"{SHALLOW}a smaller polygon")
        if "toe" in shape.about and "shoulder" in shape.about:
            why = ("as the ground in the release polygon bulges above the line from toe to shoulder, so that no "
                   f"smaller {shape.name} goes through both: take {SHALLOW}a smaller polygon")
        raise SlopeError(called, f"must be at least {at_least(misses.min() + wanted)} {unit}, {why}", f"{wanted:.10g}")
    low, high = tried[rises[-1]], tried[rises[-1] + 1]
    close = EXACT * max(abs(low), abs(high))
    number = float(scipy.optimize.brentq(miss, low, high, xtol=close, rtol=1e-14))
    depth = find(number)
    while abs(measure(depth) - wanted) > MET * wanted:
        below, above = find(max(low, number - close)), find(min(high, number + close))
        if measure(below) <= wanted <= measure(above):
            return number, part_way(below, above, wanted, measure)
        close *= 4
    return number, depth


def part_way(below: np.ndarray, above: np.ndarray, wanted: float, measure: Callable[[np.ndarray], float]) -> np.ndarray:
    """Depths between two at which the measure is what is wanted.

    A surface that ends in a wall, such as a sphere at its equator, takes up the next node with all of its depth, and
    jumps over the target. That node is then taken in part: the wall runs through its cell.
    """
    share = scipy.optimize.brentq(lambda share: measure(below + share * (above - below)) - wanted, 0.0, 1.0)
    return below + share * (above - below)


def to_depth(area: Area, shape: Shape, depth: float, called="--depth") -> Tuple[float, np.ndarray]:
    """The free number of a shape whose largest depth (m, vertical) is given, and the depths."""
    return solved(area, shape, depth, lambda depth: float(depth.max()), called, "m")


def to_volume(area: Area, shape: Shape, wanted: float, called="--volume") -> Tuple[float, np.ndarray]:
    """The free number of a shape whose volume (m3) is given, and the depths."""
    return solved(area, shape, wanted, lambda depth: compute_volume(depth, area.cell), called, "m3")


def slip_surface(area: Area, depth: np.ndarray, where: str) -> np.ndarray:
    """The ground without the body (m): rounded where the body is, the ground's own value everywhere else."""
    slip = np.where(depth >= THINNEST, np.minimum(np.round(area.z - depth, DECIMALS), area.z), area.z)
    if not (slip < area.z).any():
        raise SlopeError(where, f"must hold a body, no slip surface lies {THINNEST:g} m or more below the ground in it")
    return slip


def measures(area: Area, slip: np.ndarray) -> Measures:
    """The numbers of the body between the ground and a slip surface."""
    depth = np.where(np.isnan(area.z), 0.0, area.z - slip)      # NODATA beside the body
    body = depth > 0
    east, _ = fall(area.x, area.y, area.z, body)
    return Measures(compute_volume(depth, area.cell), float(depth.max()), float(depth[body].mean()),
                    float(body.sum()) * area.cell ** 2, int(body.sum()), slope_of(area.z, area.cell, body),
                    slope_of(slip, area.cell, body), math.degrees(math.atan2(east[0], east[1])) % 360,
                    wall(depth, area.inside), float(area.z[body].max()), float(area.z[body].min()))


def hollow(area: Area, slip: np.ndarray) -> float:
    """The largest depth (m) of a closed hollow in the slip surface of a body: below the lowest way out of it.

    The body is flooded from its rim, the lowest cells first.
    """
    z = np.where(np.isnan(slip), -np.inf, slip)     # NODATA is a way out
    body = np.nan_to_num(area.z - slip) > 0
    rim = edge(z.shape) | ~body & binary_dilation(body, np.ones((3, 3)))
    level = np.where(body & ~rim, np.nan, z)
    queue = [(float(z[place]), place) for place in zip(*np.nonzero(rim))]
    heapq.heapify(queue)
    while queue:
        height, (row, column) = heapq.heappop(queue)
        for near in ((row + down, column + right) for down in (-1, 0, 1) for right in (-1, 0, 1)):
            if 0 <= near[0] < z.shape[0] and 0 <= near[1] < z.shape[1] and np.isnan(level[near]):
                level[near] = max(height, z[near])
                heapq.heappush(queue, (float(level[near]), near))
    return float((level[body] - z[body]).max(initial=0.0))


def edge(shape: Tuple[int, ...]) -> np.ndarray:
    """Mask of the outermost nodes."""
    found = np.ones(shape, bool)
    found[1:-1, 1:-1] = False
    return found


def wall(depth: np.ndarray, inside: np.ndarray) -> float:
    """The largest depth (m) with which a body ends at the rim of a mask, instead of running out; 0: it runs out.

    A body that runs out within the cell beyond the rim falls there by no less than from the next cell inside to the
    rim; half as steeply is still taken for that.
    """
    rim = inside & ~binary_erosion(inside)
    within = np.where(inside, depth, 0.0)
    next_inside = maximum_filter(within, footprint=generate_binary_structure(2, 1), mode="constant")
    return float(depth[rim & (depth > 2 * (next_inside - within))].max(initial=0))


def slope_of(z: np.ndarray, cell: float, where: np.ndarray) -> float:
    """Mean slope (degrees) of heights on the nodes of a mask, from central differences."""
    south, east = np.gradient(z, cell)
    return float(np.degrees(np.arctan(np.hypot(south, east)))[where].mean())
