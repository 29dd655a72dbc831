"""What smaller balls change: one run with fine balls against the coarse runs that are otherwise the same.

The fine run has the scatter of the coarse ones at most: it differs from the mean of n of them by less than
t s sqrt(1 + 1/n) in 95 % of cases (Hahn and Meeker, Statistical Intervals, 1991, section 4.7). Where it brings more, a
number is raised by the difference; where it brings less, nothing is taken off. All functions are pure.
"""
from typing import NamedTuple, Optional

from .conservative_volume import Combination, Scatter

COUNTED = 10.0          # balls: from so many on a volume has a ratio; of fewer the difference counts
RESOLVED = 16.0         # balls of thickness from which on smaller ones change nothing that was seen (doc, sensitivity)


class Effect(NamedTuple):
    """Of one quantity, in its own unit."""
    coarse: float               # mean of the coarse runs
    runs: int                   # how many
    fine: float
    chance: Optional[float]     # what the fine run may lie above the mean by chance; None: no run was repeated
    ratio: bool                 # whether the effect is a factor, or a difference

    @property
    def difference(self) -> float:
        return self.fine - self.coarse

    @property
    def clear(self) -> Optional[bool]:
        """Whether it brings more than chance explains; None: chance is not known."""
        return None if self.chance is None else self.difference > self.chance

    def added(self, value: float) -> float:
        """What is added to a value (>= 0) of the quantity: nothing where the fine run brings less, or chance explains

        it; where chance is not known all that it brings more.
        """
        if self.difference <= 0 or self.clear is False:
            return 0.0
        return value * (self.fine / self.coarse - 1) if self.ratio else self.difference


def effect(coarse: Combination, fine: float, scatter: Optional[Scatter], ball: Optional[float]) -> Effect:
    """Of a fine run (>= 0) against the coarse runs with its values; ball: the larger ball's volume, None of lengths."""
    least = 0.0 if ball is None else COUNTED * ball
    mean = coarse.mean
    return Effect(mean, coarse.runs, fine, scatter.chance(coarse.runs) if scatter else None,
                  mean > 0 and min(mean, fine) >= least)
