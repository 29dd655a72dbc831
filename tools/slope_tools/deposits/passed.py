"""What of a mass lies before a road, on it and beyond it, or left the terrain there."""
import math
from pathlib import Path
from typing import Any, Dict, NamedTuple, Optional

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry
from shapely.prepared import prep

from .. import geometry
from . import gone
from .deposit import Deposit
from .gone import Gone, Ground
from .road_sides import BEFORE, ON, PAST, Sides, divide

AROUND = "past its end"      # beyond the road, but not across it
AWAY = "away from it"        # before the road, which is behind
CLOSE = "close to it"        # beyond the road, where what lies may have to be removed
COUNT = BEFORE, ON, CLOSE    # what left there might lie on the road, or keep there what does
PARTS = BEFORE, ON, PAST
SWAPPED = {BEFORE: PAST, PAST: BEFORE}
HIGHEST = 1e5                # m, no ground is as high: a road whose height nobody knows counts as so far below
ROUNDING = 1e-9              # of the mass, of a cell: less is what areas and sums round off


class Left(NamedTuple):
    """Of balls that left: BEFORE, ON or PAST; whether a road was ahead, under or close before it; whether it was close
    beyond; whether it went past an end; m to the road."""
    part: np.ndarray
    ahead: np.ndarray
    close: np.ndarray
    around: np.ndarray
    distance: np.ndarray


def evaluate_passed(run: Deposit, road: BaseGeometry, line: Optional[LineString],
                    cut_angle: float = 90.0) -> Dict[str, Any]:
    """What volume.yaml says; None where the run does not tell where its mass began.

    road: polygons in local metres, in the grid of the run; line: its axis, of a road that is one; cut_angle: degrees,
    of what is removed beside it.
    """
    ground = Ground.of(run)
    if ground is None:
        return {"divided": None, "left": None}
    return of_mass(ground, divide(road, line, ground.raster, ground.released),
                   gone.read_balls_gone(Path(run.prefix), ground), math.tan(math.radians(cut_angle)))


def of_mass(ground: Ground, sides: Sides, left: Optional[Gone], rise: float = math.inf) -> Dict[str, Any]:
    """What volume.yaml says, m3: `divided`, whose before, on, past and unknown are what was released, and `left`.

    A ball that left counts with all of its volume where it left; so does what is beyond an edge of those that did not.
    left: None where it is not known which balls did; it is unknown then where they are; rise: of the cut from the edges
    of the road, m per m.
    """
    mass, edge = (per_part(values, ground, sides) for values in (
        np.where(ground.known, ground.raster.z, 0.0), np.where(rim(ground.known), ground.raster.z, 0.0)))
    around = on_cells(np.where(ground.known, ground.raster.z, 0.0), sides.past.difference(sides.straight), ground)
    unknown = ground.gone
    numbers: Optional[Dict[str, Any]] = None
    if left is not None:
        balls = sort_by_side(left, sides, ground, rise)
        numbers = of_balls(left, balls, ground)
        around += numbers["past_end"]
        over = ground.gone - numbers["volume"]      # halves of balls at the edge, above ground or not
        total = sum(edge.values())
        for name in PARTS:
            mass[name] += numbers[name] + over * (edge[name] / total if total > 0 else float(name == BEFORE))
        unknown = 0.0
    divided = {**mass, "past_end": min(around, mass[PAST]), "unknown": unknown}
    least = ROUNDING * sum(mass.values())
    return {"divided": {name: value if abs(value) > least else 0.0 for name, value in divided.items()}, "left": numbers}


def per_part(values: np.ndarray, ground: Ground, sides: Sides) -> Dict[str, float]:
    """m3 of a thickness in each part."""
    return {name: on_cells(values, area, ground) for name, area in zip(PARTS, (sides.before, sides.road, sides.past))}


def on_cells(values: np.ndarray, area: BaseGeometry, ground: Ground) -> float:
    return float((geometry.shares_of_cells(area, ground.raster) * values).sum() * ground.cell ** 2)


def rim(known: np.ndarray) -> np.ndarray:
    """Cells with ground beside the edge, or beside one without."""
    return known & ~ndimage.binary_erosion(known, np.ones((3, 3)))


def reach_of_heap(left: Gone, past: np.ndarray, ground: Ground, road: BaseGeometry, rise: float) -> np.ndarray:
    """m from the road, for each ball: had all that left beyond it (past) been stopped where this one left, it would lie
    on the road.

    As a cone as steep as the cut on the ground there, which counts as far as it is higher than the road beside it; or,
    since what leaves flows, as a deposit as thick as that on the road.
    """
    if not past.any():
        return np.zeros(len(past))
    covered = geometry.shares_of_cells(road, ground.raster) > ROUNDING
    thick = float(np.nan_to_num(ground.raster.z)[covered].max(initial=0.0))
    nearest = ndimage.distance_transform_edt(~ground.known, return_distances=False, return_indices=True)
    cells = np.floor(~ground.raster.transform @ left.place.T).astype(int)[::-1]
    at = np.clip(cells.T, 0, np.array(ground.base.shape) - 1)
    beside = np.argwhere(covered & ground.known)
    height = ground.base[tuple(beside[cKDTree(beside).query(at)[1]].T)] if len(beside) else -HIGHEST
    drop = height - ground.base[tuple(nearest[:, at[:, 0], at[:, 1]])]
    cone = (3 * float(left.volume[past].sum()) / (math.pi * rise)) ** (1 / 3)
    return np.maximum(cone - drop / rise, thick / rise)


def sort_by_side(left: Gone, sides: Sides, ground: Ground, rise: float) -> Left:
    """rise: of the cut, m per m."""
    part = sides.of_places(left.place)
    # of a body that begins beyond the road, of several: it comes from there
    across = sides.of_places(left.start) == PAST
    part = np.array([SWAPPED.get(one, one) if other else one for one, other in zip(part, across)], object)
    road, before = prep(sides.road), sides.before
    points = [Point(place) for place in left.place]
    ahead = sides.ahead_of(left.start, left.place, part) & ~(across & (part == PAST))
    # of a frame of dumps: it may have left before the road
    near = np.array([one != BEFORE and within > 0 and before.distance(point) <= within
                     for one, within, point in zip(part, left.within, points)], bool)
    around = np.array([one == PAST and not road.intersects(LineString([start, place]))
                       for one, start, place in zip(part, left.start, left.place)], bool)
    distance = np.array([sides.road.distance(point) for point in points])
    close = (part == PAST) & (distance < reach_of_heap(left, part == PAST, ground, sides.road, rise))
    return Left(part, ahead | near | close | (part == ON), close, around, distance)


def of_balls(left: Gone, balls: Left, ground: Ground) -> Dict[str, Any]:
    def volume(mask) -> float:
        return float(left.volume[mask].sum())
    where = np.where(balls.around, AROUND, np.where((balls.part == BEFORE) & ~balls.ahead, AWAY, balls.part))
    where = np.where(balls.close, CLOSE, where)
    return {"source": left.source, "volume": volume(slice(None)), "balls": len(left.volume),
            **{name: volume(balls.part == name) for name in PARTS}, "past_end": volume(balls.around),
            "road_ahead": volume(balls.ahead), "within": float(left.within.max(initial=0.0)),
            "sides": gone.groups(left, ground, where, balls.distance)}
