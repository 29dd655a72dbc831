"""Where balls come to rest: cumulative distributions along and across the slope, over several runs."""
import math
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence

import numpy as np

from .. import disk
from ..drawing import figures, pictures
from ..errors import SlopeError
from ..findings import Finding
from ..survey import rasters
from . import dumps
from .travel_shares import PARTS, compute_reach_quantiles

DIRECTIONS = "along", "across"
SHARES = {"min": 0, "p1": 1, "p5": 5, "p10": 10, "p25": 25, "p50": 50, "p75": 75, "p90": 90, "p95": 95, "p99": 99,
          "max": 100}        # percentiles
MOVING = 0.1                 # m/s; a ball that is faster has not arrived
POINTS = 200                 # about as many positions in travel.csv per direction
FILES = ("travel.csv", "balls.csv", "travel.png", "travel.yaml")


class Wanted(NamedTuple):
    """Of which balls, in which directions."""
    axis: float = 0.0                                   # degrees from x towards y: along the slope
    origin: Sequence[float] = (0.0, 0.0)                # where both coordinates are 0, m
    along: Optional[Sequence[float]] = None             # limits, m; None: all balls
    across: Optional[Sequence[float]] = None
    types: Optional[Sequence[int]] = None               # atom types; None: all

    def limits(self, name: str) -> Optional[Sequence[float]]:
        """Of a direction."""
        return self.along if name == "along" else self.across


class Arrival(NamedTuple):
    """The balls of one run at rest."""
    name: str
    step: int
    id: np.ndarray
    place: np.ndarray               # x y z
    volume: Optional[np.ndarray]    # of the balls, m3; None: the dump has no diameter, all count the same
    at: dict                        # direction: coordinate, m
    moving: Optional[int]           # balls faster than MOVING, None without velocities
    start: Optional[np.ndarray]     # x y z of each ball at the start, None without
    top: Optional[np.ndarray]       # x y z of the highest ball at the start
    missing: int                    # balls of the start that are not there now
    lost: Optional[float]           # their volume, m3; None: the start has no diameter


def check_travel(paths: Sequence[str], starts: Optional[Sequence[str]], wanted: Wanted) -> None:
    """Raise SlopeError for what can be seen before any reading."""
    for name in DIRECTIONS:
        limits = wanted.limits(name)
        if limits and not limits[0] < limits[1]:
            raise SlopeError(f"--{name}", "LO must be < HI", f"{limits[0]:g} {limits[1]:g}")
    if starts and len(starts) not in (1, len(paths)):
        raise SlopeError("--start", f"must be one dump, or one for each of the {len(paths)} runs", len(starts))
    if len(set(paths)) < len(paths):
        raise SlopeError("DUMP", "must be another one for each run")


def of_dumps(paths: Sequence[str], starts: Optional[Sequence[str]], wanted: Wanted, folder,
             tell: Callable[[str], None] = lambda text: None) -> Dict[str, Any]:
    """Read the dumps of the final states (and of the start), write the folder; return what is in its travel.yaml.

    tell: what gets the warnings.
    """
    check_travel(paths, starts, wanted)
    each_start: List[Optional[str]] = list(starts) if starts else [None]
    each_start *= len(paths) // len(each_start)
    arrivals = [read_arrival(path, start, wanted) for path, start in
                rasters.progress(list(zip(paths, each_start)), "reading the dumps")]
    warnings: List[Dict[str, Any]] = []

    def warn(finding):
        warnings.append(finding.entry())
        tell(finding)

    for arrival in arrivals:
        if arrival.moving:
            warn(Finding("not arrived", {"file": arrival.name, "moving": arrival.moving, "balls": len(arrival.id),
                                         "speed": MOVING}))
        if arrival.missing:
            warn(Finding("missing", {"file": arrival.name, "missing": arrival.missing, "balls": arrival.missing +
                                     len(arrival.id)}))
    tables = {name: distribution(arrivals, name, wanted.limits(name), warn) for name in DIRECTIONS}
    summary: Dict[str, Any] = {
        "axis": {"along": wanted.axis, "across": wanted.axis + 90, "origin": wanted.origin}, "types": wanted.types,
        "balls": sum(len(one.id) for one in arrivals), "runs": len(arrivals),
        **{name: statistics([one.at[name] for one in arrivals]) for name in DIRECTIONS}}
    single = [each(one) for one in arrivals]
    if starts:
        summary["travel"] = statistics([measure_plan_length(one.place - one.start) for one in arrivals])
        summary["runout"] = {key: spread_over_runs([one["runout"][key] for one in single]) for key in
                             ("distance", "drop", "reach_angle")}
        summary["runout"]["quantiles"] = [
            {"share": share, **{key: spread_over_runs([one["runout"]["quantiles"][k][key] for one in single])
                                for key in ("distance", "reach_angle")}} for k, share in enumerate(PARTS)]
    summary["each_run"] = [known(one) for one in single]
    summary["warnings"] = warnings
    with disk.complete(folder, "travel.yaml") as new:
        write_travel_csv(new / "travel.csv", arrivals, tables)
        write_balls(new / "balls.csv", arrivals)
        draw_travel(new / "travel.png", arrivals, tables, wanted)
        summary["files"] = list(FILES)
        disk.write_yaml(new / "travel.yaml", summary, "slope travel: arrival positions; m, degrees")
    return summary


# --- the balls ---

def read_arrival(path, start, wanted: Wanted) -> Arrival:
    """The Arrival of a run."""
    rest = select_balls(dumps.last(path, ("type", "vx", "vy", "vz", "diameter", "radius")), wanted.types)
    place = rest.place
    turn = math.radians(wanted.axis)
    way = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    way[np.abs(way) < 1e-15] = 0                     # along y is along y
    along, across = way @ (place[:, :2] - wanted.origin).T
    moving = None
    if all(key in rest.of for key in ("vx", "vy", "vz")):
        moving = int((np.hypot(np.hypot(rest.of["vx"], rest.of["vy"]), rest.of["vz"]) > MOVING).sum())
    before, top, missing, lost = None, None, 0, None
    if start:
        first = select_balls(dumps.last(start, ("type", "diameter", "radius")), wanted.types)
        ids, order = first.of["id"], np.argsort(first.of["id"])
        same = order[np.minimum(np.searchsorted(ids, rest.of["id"], sorter=order), len(ids) - 1)]
        other = rest.of["id"][ids[same] != rest.of["id"]]
        if len(other):
            raise SlopeError(start, f"must have the balls of {path}", f"none with id {other[0]:g}")
        before, top, missing = first.place[same], first.place[first.of["z"].argmax()], len(ids) - len(same)
        volume = volume_of(first)
        lost = None if volume is None else float(volume[~np.isin(ids, rest.of["id"])].sum())
    return Arrival(str(path), rest.step, rest.of["id"].astype(int), place, volume_of(rest),
                   {"along": along, "across": across}, moving, before, top, missing, lost)


def volume_of(snapshot):
    """Volume of each ball, m3; None where the dump has neither diameter nor radius."""
    if "diameter" in snapshot.of:
        return math.pi / 6 * snapshot.of["diameter"] ** 3
    return math.pi / 6 * (2 * snapshot.of["radius"]) ** 3 if "radius" in snapshot.of else None


def select_balls(snapshot, types):
    """The balls of some types, None: all."""
    if not types:
        return snapshot
    if "type" not in snapshot.of:
        raise SlopeError(snapshot.path, "must have the column type, for --type")
    keep = np.isin(snapshot.of["type"], types)
    if not keep.any():
        raise SlopeError(snapshot.path, f"must have balls of type {' '.join(map(str, types))} (--type)",
                         "type " + " ".join(f"{value:g}" for value in np.unique(snapshot.of["type"])))
    return snapshot._replace(of={name: values[keep] for name, values in snapshot.of.items()})


# --- numbers ---

def distribution(arrivals, name, limits, warn):
    """Positions (m), the share of the balls at or below them in each run (runs, positions), and of all balls."""
    balls = np.concatenate([one.at[name] for one in arrivals])
    lo, hi = limits or (balls.min(), balls.max())
    outside = ((balls < lo) | (balls > hi)).sum()
    if outside:
        warn(Finding("beyond limits", {"option": f"--{name}", "low": float(lo), "high": float(hi),
                                       "outside": int(outside), "balls": len(balls)}))
    step = choose_axis_step(hi - lo)
    first = math.floor(lo / step + 1e-9) if limits else math.ceil(lo / step - 1e-9) - 1    # where the share is still 0
    at = (step * np.arange(first, math.ceil(hi / step - 1e-9) + 1)).round(12)
    shares = np.array([np.searchsorted(np.sort(one.at[name]), at, "right") / len(one.id) for one in arrivals])
    return at, shares, np.searchsorted(np.sort(balls), at, "right") / len(balls)


def choose_axis_step(length):
    """The smallest of 1, 2, 5 x 10^n with at most POINTS steps in a length (m)."""
    least = max(length, 1e-3) / POINTS
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= least * (1 - 1e-9))


def percentiles(values):
    return {**{key: round(float(np.percentile(values, share)), 9) for key, share in SHARES.items()},
            "mean": round(float(values.mean()), 9), "sd": round(float(values.std()), 9)}


def spread_over_runs(values):
    """A number of each run, over the runs; what is infinite is unknown."""
    return {"lowest": finite(min(values)), "median": finite(np.median(values)), "highest": finite(max(values))}


def finite(value):
    """A number as travel.yaml has it; None if it is infinite."""
    return round(float(value), 9) if math.isfinite(value) else None


def statistics(runs):
    """Percentiles of the balls of all runs, and how each differs from run to run."""
    single = [percentiles(values) for values in runs]
    return {"all": percentiles(np.concatenate(runs)),
            "over_runs": {key: spread_over_runs([one[key] for one in single]) for key in single[0]}}


def measure_plan_length(difference):
    """Length of vectors in plan."""
    return np.hypot(difference[..., 0], difference[..., 1])


def measure_runout(arrival):
    """From the highest ball at the start to the farthest one now: distance in plan (m), drop (m), angle (degrees).

    And quantiles: what shares of the volume (of the balls, where a dump has no diameter) stay within, infinite where
    the farthest of those are missing.
    """
    distance = measure_plan_length(arrival.place - arrival.top)
    far = distance.argmax()
    drop = arrival.top[2] - arrival.place[far, 2]
    by_volume = arrival.volume is not None and (arrival.lost is not None or not arrival.missing)
    weights = (arrival.volume, arrival.lost or 0.0) if by_volume else (np.ones(len(distance)), float(arrival.missing))
    shares = [{"share": share, "distance": within, "reach_angle": angle}
              for share, within, angle in compute_reach_quantiles(arrival.place, arrival.top, *weights)]
    return {"distance": round(float(distance[far]), 9), "drop": round(float(drop), 9),
            "reach_angle": round(math.degrees(math.atan2(drop, distance[far])), 9), "ball": int(arrival.id[far]),
            "quantiles_of": "volume" if by_volume else "balls", "quantiles": shares}


def each(arrival):
    """What travel.yaml tells of one run."""
    about = {"dump": arrival.name, "step": arrival.step, "balls": len(arrival.id), "moving": arrival.moving,
             **{name: percentiles(values) for name, values in arrival.at.items()}}
    if arrival.start is not None:
        about.update(missing=arrival.missing, travel=percentiles(measure_plan_length(arrival.place - arrival.start)),
                     runout=measure_runout(arrival))
    return about


def known(numbers):
    """What each() gave, with None for what is infinite."""
    if "runout" not in numbers:
        return numbers
    shares = [{"share": of["share"], "distance": finite(of["distance"]), "reach_angle": finite(of["reach_angle"])}
              for of in numbers["runout"]["quantiles"]]
    return {**numbers, "runout": {**numbers["runout"], "quantiles": shares}}


# --- output ---

def write_travel_csv(path, arrivals, tables):
    disk.write_file(path, disk.csv_text(
        ["direction", "position", "lowest", "median", "highest", "all", *(one.name for one in arrivals)],
        ([name, *(f"{value:.9g}" for value in row)] for name, (at, shares, together) in tables.items()
         for row in np.column_stack([at, shares.min(axis=0), np.median(shares, axis=0), shares.max(axis=0), together,
                                     shares.T]))))


def write_balls(path, arrivals):
    """Where each ball is, and how far, how deep and at which angle it came from its start."""
    moved = arrivals[0].start is not None
    rows: List[List[Any]] = []
    for arrival in arrivals:
        columns = [arrival.at["along"], arrival.at["across"], arrival.place[:, 2]]
        if moved:
            distance, drop = measure_plan_length(arrival.place - arrival.start), arrival.start[:, 2] - arrival.place[:,
                                                                                                                     2]
            columns += [distance, drop, np.degrees(np.arctan2(drop, distance))]
        rows += [[arrival.name, ball, *(f"{value:.9g}" for value in row)] for ball, row in
                 sorted(zip(arrival.id.tolist(), np.column_stack(columns)))]
    disk.write_file(path, disk.csv_text(["run", "id", "along", "across", "z",
                                         *(("travel", "drop", "angle") if moved else ())], rows))


def draw_travel(path, arrivals, tables, wanted: Wanted) -> None:
    """The distributions, as the paper's Figure 3; a line for the median of the runs, a band from lowest to highest."""
    several = len(arrivals) > 1
    with pictures.settings(figures.STYLE):
        figure, panels = pictures.subplots(1, 2, figsize=(figures.FULL, 2.9), sharey=True)
        for axes, (name, (at, shares, _)), colour in zip(panels, tables.items(), figures.COLOURS):
            if several:
                axes.fill_between(at, shares.min(axis=0), shares.max(axis=0), step="post", color=colour, alpha=0.25,
                                  lw=0, label=f"lowest to highest of {len(arrivals)} runs")
            axes.step(at, np.median(shares, axis=0), where="post", color=colour, lw=1.4,
                      label="median of the runs" if several else f"{len(arrivals[0].id)} balls")
            turn = (wanted.axis + (90 if name == "across" else 0)) % 360
            towards = {0.0: "x", 90.0: "y", 180.0: "-x", 270.0: "-y"}.get(turn, f"{turn:g} degrees from x to y")
            axes.set(xlim=wanted.limits(name) or (at[0], at[-1]), ylim=(0, 1),
                     xlabel=f"{name} the slope, towards {towards} (m)")
            axes.grid(color="#dddddd", lw=0.5)
            axes.legend(loc="upper left")
        panels[0].set_ylabel("cumulative share of the balls")
        pictures.save(figure, path, dpi=figures.DPI)
