"""What is said first of a calibration: that its best values miss the observation, and where no run stops."""
import math
from typing import List, Optional, Sequence

import numpy as np

from ..statistics.backanalysis import Posterior, Target
from ..tables.quantities import format_quantity

BEYOND = 2.0            # standard deviations of tolerance and chance together


def misses(posterior: Posterior, targets: Sequence[Target], predicted: Optional[np.ndarray]) -> List[str]:
    """The observed numbers that the run at the best values is far from; predicted: its outputs, None if it has none."""
    if predicted is None:
        return ["the run at the best values says nothing: it failed, or left the terrain"]
    lines = []
    for one, value, noise in zip(targets, predicted, posterior.noise):
        if one.value is not None and abs(value - one.value) > BEYOND * math.hypot(one.deviation, noise):
            lines.append("the run at the best values misses the observation by more than tolerance and chance "
                         f"explain: {one.name} {format_quantity(value)} instead of {format_quantity(one.value)} "
                         f"{one.unit}")
    return lines


def jumps(posterior: Posterior, targets: Sequence[Target]) -> List[str]:
    """The gaps of the observed numbers."""
    lines = []
    for target, several in zip(targets, posterior.gaps):
        for gap in several:
            text = (f"{target.name}: no run gives a value between {format_quantity(gap.low)} and "
                    f"{format_quantity(gap.high)} {target.unit}, "
                    "where the response jumps, as over a step of the ground")
            if target.value is not None and gap.holds(target.value):
                text += f"; the observed {format_quantity(target.value)} lies there, and no values reproduce it"
            lines.append(text)
    return lines
