"""Rows of runs with balls of several sizes as rows at the finest one: the place where they are transferred.

A point is a run with the coarsest balls and those that are otherwise the same with finer ones.  Its row is that of its
finest run; each quantity passes through the steps that are left (statistics/ball_sizes), so that all rows are of one
size, whatever was run.  What steps through are volumes, lengths, thicknesses, speeds and hours; angles with them.
"""
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..case.settings import normalise_value
from ..runs import repeats
from ..statistics import ball_sizes
from ..statistics.ball_sizes import Finest, Step
from . import quantities, study_types
from .quantities import On
from .road_runs import SUMS
from .rows import Finished, OnRoad, Row, finished_of

VARIABLE = "d"                  # of a deck: the diameter of the balls, m
VOLUMES = {"m3"}                # units of quantities of which ten balls count
NOT = {"released_m3", "on_grid_m3", "stop_time_s"}      # columns that the size does not change, or that tell of a run
PARTS = quantities.REMOVE, "before_road_m3", "on_road_m3", "beyond_road_m3"      # of what was released
SAME = 0.05             # of a value: another is it as far as a page with its maps is concerned
DRAWS = 200             # of the values of transferred runs, for the band of a number
FEWEST = 2              # pairs of two sizes; fewer tell nothing of the finer one
BANDS = quantities.REMOVE, "remove_on_road_m3", "beyond_road_m3", quantities.LENGTH     # that a row has
# of stretches and their sums: of which column they are a part
OF_SUMS = dict(zip(SUMS, (quantities.REMOVE, "remove_lane_m3", "clear_hours", "lane_hours")))
UNKNOWN = "; what finer ones would change is not known"
# of which finer runs held what their last step leaves (tests/size_family.py); they raised what lies beyond the road,
# and how far the centroid goes, by more
HELD = {quantities.REMOVE, "remove_on_road_m3", quantities.LENGTH}
Draw = Callable[[Sequence[Finished], str], np.ndarray]      # values (n, runs) of a column, as they may be
Point = Sequence[Optional[Finished]]    # its runs by size, the coarsest first; None: not run, or failed


class Places(NamedTuple):
    """The parameters on which a step may depend, and their ranges."""
    names: Sequence[str]
    low: np.ndarray
    width: np.ndarray

    def of(self, row: Finished) -> np.ndarray:
        values = np.array([normalise_value(row.variables[name]) for name in self.names], float)
        return (values - self.low) / self.width


@dataclass(frozen=True)
class Sizes:
    """diameters: m, the coarsest first; runs: of each; steps: of a column of the table, from one to the next."""
    diameters: Sequence[float]
    runs: Sequence[int]
    places: Places
    steps: Mapping[str, Sequence[Step]]

    def size_of(self, row: Finished) -> int:
        """Which of the sizes a run has."""
        d = float(row.variables[VARIABLE])
        return int(np.abs(np.log(np.asarray(self.diameters) / d)).argmin())

    def left(self, row: Finished, key: str) -> Sequence[Step]:
        """The steps from a run's size to the finest."""
        return self.steps.get(key, ())[self.size_of(row):]

    def values(self, row: Finished) -> Dict[str, Finest]:
        """The quantities of a run at the finest size; without those that it does not have, and those of which no pair
        tells, as lengths where finer balls leave the terrain."""
        k, place = self.size_of(row), self.places.of(row)
        return {key: ball_sizes.transfer(steps[k:], float(value), place) for key, steps in self.steps.items()
                if (value := row.value(key)) is not None and all(step.known for step in steps[k:])}

    def row(self, row: Row) -> Row:
        """The same at the finest size, with the bands of BANDS; one that failed as it is."""
        if not isinstance(row, Finished):
            return row
        values = self.values(row)
        new: Dict[str, Any] = {key: one.value for key, one in values.items()}
        new.update(dict.fromkeys(key for key in self.steps if key not in new and row.value(key) is not None))
        for key in PARTS:
            if new.get(key) is not None:
                new[key] = min(new[key], row.released_m3)
        if row.road and row.road.axis_m is not None and new.get("blocked_m") is not None:
            new["blocked_m"] = min(new["blocked_m"], row.road.axis_m)
        road = row.road and replace(row.road, **{key: value for key, value in new.items() if hasattr(row.road, key)})
        if road and row.road:
            road = replace(road, remove_on_road_m3=min(road.remove_on_road_m3, road.remove_m3),
                           remove_beside_road_m3=max(0.0, road.remove_m3 - road.remove_on_road_m3),
                           stretches=[scaled(one, row, new) for one in row.road.stretches],
                           clearing=scaled(row.road.clearing, row, new),
                           by_10_m=scaled_parts(row.road, road.remove_on_road_m3))
        if row.length_by_lobe_m and row.length_m and new.get(quantities.LENGTH) is not None:
            new["length_by_lobe_m"] = [one * new[quantities.LENGTH] / row.length_m for one in row.length_by_lobe_m]
        return replace(row, **{key: value for key, value in new.items() if hasattr(row, key)}, road=road,
                       bands={key: list(values[key].band) for key in BANDS if key in values})

    def draws(self, rows: Sequence[Finished], key: str, number: int) -> np.ndarray:
        """Values (number, n) of runs as they may be at the finest size; rows: as they were run."""
        found = ball_sizes.draws([self.left(row, key) for row in rows], [float(row.value(key)) for row in rows],
                                 [self.places.of(row) for row in rows], number)
        return np.minimum(found, [row.released_m3 for row in rows]) if key in PARTS else found


def transfer_rows(sizes: Optional[Sizes], rows: Sequence[Row]) -> List[Row]:
    """At the finest size; sizes: None of one size."""
    return [sizes.row(row) for row in rows] if sizes else list(rows)


def draw_rows(sizes: Optional[Sizes], raw: Sequence[Row]) -> Optional[Draw]:
    """A function of transfer_rows() of these, as they were run, and a column: DRAWS values of each as they may be."""
    if sizes is None:
        return None
    draws, by_name = sizes.draws, {row.run: row for row in finished_of(raw)}
    return lambda rows, key: draws([by_name[row.run] for row in rows], key, DRAWS)


def nearest(rows: Sequence[Finished], key: str, value: float) -> Finished:
    """The run whose quantity is nearest to a value; rather one with the finest balls, whose is the SAME."""
    def off(row: Finished) -> float:
        return abs(row.value(key) - value)

    best = min(rows, key=off)
    d = {row.run: float(row.variables[VARIABLE]) for row in rows if VARIABLE in row.variables}
    fine = [row for row in rows if d and d.get(row.run) == min(d.values()) and off(row) <= SAME * abs(value)]
    return min(fine, key=off, default=best)


def scaled(part: Mapping[str, Any], row: Finished, new: Mapping[str, Any]) -> Dict[str, Any]:
    """A stretch, or the sums of a road, in proportion to the columns whose part it is."""
    factors = {name: new[key] / old for name, key in OF_SUMS.items() if key in new and (old := row.value(key))}
    return {name: value * factors[name] if name in factors else value for name, value in part.items()}


def scaled_parts(road: OnRoad, on_road: float) -> List[List[float]]:
    """Volumes on the road by chainage, in proportion to all of it (m3)."""
    factor = on_road / road.remove_on_road_m3 if road.remove_on_road_m3 else 0.0
    return [[start, factor * volume] for start, volume in road.by_10_m]


# --- of the runs ---

def combine_sizes(points: Sequence[Point]) -> Optional[Sizes]:
    """What points tell of sizes; None where there is one size only."""
    levels = max(map(len, points), default=0)
    points = [[*one, *[None] * (levels - len(one))] for one in points]
    used = 1
    while used < levels and sum(find_size_pair(one, used - 1) is not None for one in points) >= FEWEST:
        used += 1
    first = [one[0] for one in points if one[0]]
    if used < 2:
        return None
    diameters = [next(float(row.variables[VARIABLE]) for one in points if (row := one[k])) for k in range(used)]
    places = places_of(first)
    steps: Dict[str, List[Step]] = {key: [] for key in list_step_columns(first)}
    for key, known_steps in steps.items():
        volume = quantities.ALL[key].unit in VOLUMES
        for k in range(used - 1):
            pairs = [both for one in points if (both := find_size_pair(one, k))
                     and all(row.value(key) is not None for row in both)]
            ball = max(both[0].ball_m3 for both in pairs) if volume and pairs else 0.0
            known_steps.append(ball_sizes.fit_step(
                [float(both[0].value(key)) for both in pairs], [float(both[1].value(key)) for both in pairs],
                [places.of(both[0]) for both in pairs], diameters[k] / diameters[k + 1], ball,
                known_steps[-1] if known_steps else None))
    return Sizes(diameters, [sum(one[k] is not None for one in points) for k in range(used)], places, steps)


def find_size_pair(point: Point, k: int) -> Optional[Tuple[Finished, Finished]]:
    """The runs of a point with the k-th size and the next finer one; None where one of them is not there."""
    both = point[k:k + 2]
    return (both[0], both[1]) if len(both) == 2 and both[0] and both[1] else None


def list_step_columns(rows: Sequence[Finished]) -> List[str]:
    """Those that a step changes, of which a run has a number."""
    return [key for key in quantities.keys(On.ASKED) if key not in NOT
            and any(row.value(key) is not None for row in rows)] + ["on_road_m3"] * any(row.road for row in rows)


def places_of(rows: Sequence[Finished]) -> Places:
    """Of the variables that are numbers and differ between runs, but for the size and what is chance."""
    names, values = [], []
    for name in rows[0].variables:
        several = [normalise_value(row.variables.get(name, "")) for row in rows]
        if name != VARIABLE and not repeats.CHANCE.fullmatch(name) and len(set(several)) > 1 \
                and all(isinstance(one, float) for one in several):
            names.append(name)
            values.append(several)
    whole = np.array(values, float).reshape(len(names), len(rows))
    return Places(names, whole.min(axis=1), np.ptp(whole, axis=1))


# --- for study.yaml, and in words ---

def summarise_sizes(sizes: Sizes, depth: Optional[float], balls: Sequence[float]) -> study_types.Size:
    """The entry of study.yaml; depth: mean thickness of the body (m), balls: in it, of each size."""
    levels = [study_types.SizeRuns(d, round(number), depth and depth / d, runs)
              for d, number, runs in zip(sizes.diameters, balls, sizes.runs)]
    effects = {key: effect(key, steps) for key, steps in sizes.steps.items()}
    one = study_types.Size(levels, list(sizes.places.names), effects, "")
    return replace(one, text=describe_size(one))


def effect(key: str, steps: Sequence[Step]) -> study_types.SizeEffect:
    """What study.yaml says of the steps of a quantity; what is left, of those HELD."""
    return study_types.SizeEffect(
        [study_types.SizeStep(step.finer, step.ratio.number if step.ratio else 0,
                              step.ratio and float(np.exp(step.ratio.constant)),
                              step.ratio and step.ratio.deviation, bool(step.ratio and step.ratio.slopes.any()))
         for step in steps],
        ball_sizes.estimate_remaining_step(steps) if key in HELD else None)


def describe_size(size: study_types.Size) -> str:
    """How many balls were computed, and what finer ones would change, a sentence without its full stop."""
    key = next((key for key in (quantities.REMOVE, quantities.LENGTH) if key in size.effects), None)
    words = f"computed with {size.sizes[0].balls:,} balls"
    if len(size.sizes) > 1:
        words += f", some runs with up to {size.sizes[-1].balls:,}, after which the others are corrected"
    still = size.effects[key].left if key else None
    if not key or not still:
        return words + UNKNOWN
    what = "the volume" if key == quantities.REMOVE else f"the {quantities.ALL[key].name}"
    return f"{words}; finer ones would change {what} by {percents(still.low, still.high)}"


def alone(balls: float) -> str:
    """The same of one size."""
    return f"computed with {balls:,.0f} balls{UNKNOWN}"


def percents(low: float, high: float) -> str:
    """-3 to +1 %, both of two digits at most."""
    ends = [f"{100 * value:+.{0 if abs(value) >= 0.0095 else 1}f}" for value in (low, high)]
    ends = ["0" if float(end) == 0 else end for end in ends]
    return f"{ends[0]} to {ends[1]} %"
