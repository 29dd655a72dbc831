"""How much of the slope below a body is steeper than an angle, such as the stop angle of the ground."""
import math
from typing import NamedTuple

import numpy as np

from . import fall_path
from .body import Body


class Below(NamedTuple):
    """The fall path from the body's toe on, in steps: height lost in each (m), and its angle (degrees)."""
    lost: np.ndarray
    degrees: np.ndarray

    def steeper(self, degrees: float) -> float:
        """Share of the height lost where the path is steeper; 0 where it loses none."""
        return float(self.lost[self.degrees > degrees].sum() / self.lost.sum()) if self.lost.any() else 0.0


def below(body: Body) -> Below:
    """Of a body: the path to the end of its terrain, its angles measured over the width of the mass, V^(1/3).

    Raises SlopeError for a body on level ground, which has no fall path.
    """
    rows, columns = body.raster.z.shape
    path = fall_path.trace(body, math.hypot(rows, columns) * body.cell)
    beyond = fall_path.from_toe(body, path)
    width = max(body.volume ** (1 / 3), body.cell)
    middle = 0.5 * (beyond.length[:-1] + beyond.length[1:])
    ends = [np.clip(middle + part * width, 0, path.length[-1]) for part in (-0.5, 0.5)]
    falls = [np.interp(end, path.length, path.fall) for end in ends]
    angle = np.degrees(np.arctan2(falls[1] - falls[0], ends[1] - ends[0]))
    return Below(np.maximum(np.diff(beyond.fall), 0.0), angle)
