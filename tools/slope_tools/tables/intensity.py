"""Volume on the road against the intensity of the trigger, and the probability that a volume is exceeded at each.

An intensity is a variable of the study such as the peak acceleration of an earthquake (gal). Its values are choices,
as all values of --set; what differs by chance at one of them are the repeats. Of n runs at an intensity, k with more
than a volume v: P(V > v) is k/n, with the interval of Clopper and Pearson (Biometrika 26, 1934, 404).
"""
import math
import re
from typing import Dict, List, Optional, Sequence, Tuple

from rich.table import Table

from .. import disk
from ..digits import chance
from ..case.settings import normalise_value
from ..errors import SlopeError
from ..findings import Finding
from ..runs.repeats import Settings
from ..statistics import hazard
from . import study_types
from .combinations import Group, stood

NAME = re.compile(r"peak|pga|\w*intensity")     # names of variables that are one without being named
QUANTITY = "remove_on_road_m3"
CONFIDENCE = 0.95       # of the interval of a probability
DEFAULTS = 3            # volumes, if none are given
FILE = "intensity.csv"
REACHES = 0.01          # of the released volume: less on the road, and the mass has not reached it


def check_intensity(named: Optional[str], settings: Settings, road: bool) -> Optional[str]:
    """The variable that is an intensity, or None; SlopeError if the one of --intensity cannot be."""
    if named is None:
        return find(settings) if road else None
    if named not in settings:
        raise SlopeError("--intensity", "must name a variable of --set", named)
    if not road:
        raise SlopeError("--intensity", "needs --road: what counts is the volume on it", named)
    if not are_axis_points(settings[named]) or len(settings[named]) < 2:
        raise SlopeError("--intensity", "must have several values, all of them numbers", ",".join(settings[named]))
    return named


def find(settings: Settings) -> Optional[str]:
    """The first variable of several numbers that is called like an intensity."""
    for name, several in settings.items():
        if NAME.fullmatch(name) and len(several) > 1 and are_axis_points(several):
            return name
    return None


def are_axis_points(several: Sequence[str]) -> bool:
    """Whether all are numbers that can be points of an axis; as_number takes nan and inf for numbers, too."""
    found = [normalise_value(one) for one in several]
    return all(isinstance(one, float) and math.isfinite(one) for one in found)


def round_volumes(largest: float) -> List[float]:
    """Three of 1, 2, 5, 10, ... m3, those next below a volume."""
    if largest <= 1:
        return []
    steps = [digit * 10.0 ** power for power in range(math.ceil(math.log10(largest)) + 1) for digit in (1, 2, 5)]
    return [step for step in steps if step < largest][-DEFAULTS:]


def probability(above: int, of: int) -> Tuple[float, float, float]:
    """k of n runs: k/n and its interval of Clopper and Pearson."""
    low, high = hazard.share_bounds(above, of, confidence=CONFIDENCE)
    return above / of, float(low), float(high)


def entry(name: str, groups: Sequence[Group], volumes: Sequence[float]) -> Optional[study_types.Intensity]:
    """What study.yaml says of the intensity: lines, one for each combination of the other variables, of points.

    None if no run has a volume on the road.
    """
    groups = [group for group in groups if all(row.road for row in group.rows)]
    if not groups:
        return None
    volumes = list(volumes) or round_volumes(max(row.at_road.remove_on_road_m3 for group in groups
                                                 for row in group.rows))
    lines: Dict[tuple, study_types.Line] = {}
    for group in groups:
        rest = {other: value for other, value in group.set.items() if other != name}
        line = lines.setdefault(tuple(rest.values()), study_types.Line(rest, []))
        line.points.append(point(float(group.set[name]), group, volumes))
    for line in lines.values():
        line.points.sort(key=lambda entry_: entry_.at)
    return study_types.Intensity(name, QUANTITY, volumes, CONFIDENCE, list(lines.values()))


def point(at: float, group: Group, volumes: Sequence[float]) -> study_types.Point:
    """Volumes of the runs of one intensity (m3), their mean and scatter, and how many exceed each of the volumes."""
    quantity = group.of(QUANTITY)
    of_runs = list(quantity.volumes.values())
    exceed: List[study_types.Exceeded] = []
    for volume in volumes:
        above = sum(value > volume for value in of_runs)
        share, low, high = probability(above, len(of_runs))
        exceed.append(study_types.Exceeded(volume, above, share, low, high))
    released = sum(row.released_m3 for row in group.rows) / len(group.rows)
    few = [row for row in group.rows if row.at_road.remove_on_road_m3 <= REACHES * released]
    return study_types.Point(at, len(of_runs), quantity.mean, quantity.scatter, min(of_runs), max(of_runs), released,
                             quantity.mean / released, len(few), stood(few, group.rows), exceed)


def find_intensity_caveats(intensity: study_types.Intensity) -> List[Finding]:
    """The caveat on a common scatter of all runs: chance decides whether the slope fails, or the mass reaches the road.
    """
    mixed = [one for line in intensity.lines for one in line.points if 0 < one.not_on_road < one.runs]
    caveats = []
    for kind, points in (("fails at times", [one for one in mixed if one.stood]),
                         ("reaches at times", [one for one in mixed if not one.stood])):
        at = sorted({f"{one.at:g}" for one in points}, key=float)
        if at:
            caveats.append(Finding(kind, {"variable": intensity.variable, "values": ", ".join(at)}))
    return caveats


def tabulate_intensity(intensity: study_types.Intensity) -> str:
    """The CSV: a row for each point."""
    columns = ("runs", "mean_m3", "scatter_m3", "smallest_m3", "largest_m3", "share_of_released")

    def numbers(entry_: study_types.Point) -> Tuple[Optional[float], ...]:
        return (entry_.runs, entry_.mean_m3, entry_.scatter_m3, entry_.smallest_m3, entry_.largest_m3,
                entry_.share_of_released)
    volumes = [f"{volume:g}" for volume in intensity.more_than_m3]
    return disk.csv_text(
        [*intensity.lines[0].set, intensity.variable, *columns,
         *(f"{what}_{volume}_m3" for volume in volumes for what in ("p_more_than", "low", "high"))],
        ([*line.set.values(), f"{one.at:g}", *numbers(one),
          *(value for each in one.exceed for value in (each.probability, each.low, each.high))]
         for line in intensity.lines for one in line.points))


def shown_of(intensity: study_types.Intensity) -> Table:
    """The table on the screen."""
    shown = Table(title=f"volume on the road (m3 of ground) against {intensity.variable}, and P(V > v), in brackets "
                  "the "
                        f"{100 * intensity.confidence:.0f} % interval of so few runs")
    for head in (*intensity.lines[0].set, intensity.variable, "runs", "mean", "smallest", "largest",
                 *(f"P(V > {volume:,.6g})" for volume in intensity.more_than_m3)):
        shown.add_column(head, justify="right")
    for line in intensity.lines:
        for one in line.points:
            shown.add_row(*line.set.values(), f"{one.at:g}", str(one.runs),
                          *(f"{value:,.0f}" for value in (one.mean_m3, one.smallest_m3, one.largest_m3)),
                          *(chance(each.probability, each.low, each.high) for each in one.exceed))
    return shown


def evaluate_intensity(named: Optional[str], more_than: Sequence[float], settings: Settings, road: bool,
                       groups: Sequence[Group]) -> Optional[study_types.Intensity]:
    """The entry of study.yaml, None without an intensity."""
    name = check_intensity(named, settings, road)
    return entry(name, groups, more_than) if name else None
