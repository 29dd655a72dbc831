"""The stop angle of a ground of fixed balls: its resistance, which spacing, friction and rolling resistance share.

It is midway between the greatest whole degree at which a sheet three balls thick, started at sqrt(g d), comes to rest
within 40 s in a periodic strip, and the next (balls of 1 m; with others the time is 125 sqrt(d / g)). Measured by
tests/stop_angles.py: stop_angles.csv. What it predicts, and what not: doc/src/choosing_parameters.rst.
"""
import csv
from functools import lru_cache
from pathlib import Path
from typing import Dict, NamedTuple, Optional, Tuple

import numpy as np

from ..errors import SlopeError

TABLE = Path(__file__).with_name("stop_angles.csv")
# columns, and about what changes the angle by two degrees: distances between grounds are in these
AXES = {"spacing": ("spacing_d", 0.1), "friction": ("friction_deg", 4.0), "rolling": ("rolling", 0.02),
        "restitution": ("restitution", 0.2)}
PATTERNS = ("scattered", "grid")
LAYERS = 3.0        # of the sheet; the table has others, too
ROUNDING = 1e-9     # of a value at the end of a range


class StopAngle(NamedTuple):
    """degrees: None outside of the table, where outside says which value must be in which range; error: of the
    interpolation, degrees, root mean square; ranges: least and greatest value of each parameter in the table."""
    degrees: Optional[float]
    error: float
    ranges: Dict[str, Tuple[float, float]]
    outside: str


class Grounds(NamedTuple):
    """Measured grounds, a row each: the parameters and a column for the pattern, over their scales; degrees."""
    places: np.ndarray
    degrees: np.ndarray

    def without(self, k: int) -> "Grounds":
        """All but one."""
        return Grounds(np.delete(self.places, k, axis=0), np.delete(self.degrees, k))

    def at(self, place: np.ndarray) -> float:
        """Degrees: a plane through all of them, and what is left of each, which fades with the distance."""
        from scipy.interpolate import RBFInterpolator    # takes half a second, which most commands do not need
        return float(RBFInterpolator(self.places, self.degrees, kernel="linear", degree=1)(place[None])[0])


@lru_cache(maxsize=None)
def list_measured_grounds() -> Grounds:
    """The grounds of the table, with a sheet of three layers."""
    with open(TABLE, encoding="utf-8", newline="") as lines:
        rows = [row for row in csv.DictReader(lines) if float(row["layers"]) == LAYERS]
    places = [[*(float(row[column]) / scale for column, scale in AXES.values()), PATTERNS.index(row["pattern"])]
              for row in rows]
    return Grounds(np.array(places), np.array([float(row["stop_angle_deg"]) for row in rows]))


def ranges_of(pattern: str) -> Dict[str, Tuple[float, float]]:
    """Least and greatest value of each parameter: of the spacing, that of the pattern's grounds.

    What else the other pattern was measured with counts too: the difference between the two changes little with it.
    """
    places = list_measured_grounds().places
    own = places[places[:, -1] == PATTERNS.index(pattern)]
    found = {}
    for k, (name, (_, scale)) in enumerate(AXES.items()):
        column = scale * (own if name == "spacing" else places)[:, k]
        found[name] = float(column.min().round(9)), float(column.max().round(9))
    return found


@lru_cache(maxsize=None)
def left_out() -> Tuple[float, ...]:
    """Each ground that is not the last one on an axis: interpolated from the others, less measured, degrees."""
    every, errors = list_measured_grounds(), []
    for k, (place, degrees) in enumerate(zip(*every)):
        rest = every.without(k)
        if (place >= rest.places.min(axis=0)).all() and (place <= rest.places.max(axis=0)).all():
            errors.append(rest.at(place) - degrees)
    return tuple(errors)


def stop_angle(spacing: float, friction: float, rolling: float, restitution: float = 0.3,
               pattern: str = "scattered") -> StopAngle:
    """The stop angle of a ground of fixed balls as large as the soil's.

    spacing: in diameters; friction: of soil and ground, degrees; rolling: resistance of both; restitution: on the
    ground (within the soil 0.48); pattern: scattered or grid.
    """
    if pattern not in PATTERNS:
        raise SlopeError("pattern", f"must be {' or '.join(PATTERNS)}", pattern)
    ranges = ranges_of(pattern)
    values = dict(zip(AXES, (spacing, friction, rolling, restitution)))
    outside = "; ".join(f"{name} must be {low:g} to {high:g}, got {values[name]:g}"
                        for name, (low, high) in ranges.items()
                        if not low - ROUNDING <= values[name] <= high + ROUNDING)
    error = float(np.sqrt(np.mean(np.square(left_out()))))
    place = np.array([*(values[name] / scale for name, (_, scale) in AXES.items()), PATTERNS.index(pattern)])
    return StopAngle(None if outside else list_measured_grounds().at(place), error, ranges, outside)
