"""Effect of the size of the balls on a quantity: its means, and whether halving the size changes more than chance.

Nothing is fitted below the finest size: values may fall to a least one and grow again with finer balls, so
that a line through coarse sizes points the wrong way. Units: d in m, values in the quantity's (m3 of ground,
m, degrees); any other variable in place of d has its own. All functions are pure.
"""
import math
from dataclasses import dataclass
from typing import List, Optional, Sequence, Tuple

from .conservative_volume import Combination, Scatter, pooled

HALVED = 1.9            # ratio of two sizes from which on one is half of the other, or less
AGREEING = 2            # halvings in a row that change no more than chance resolve a quantity
BALLS = 8.0             # of thickness, that the first of them must have
TELLS = 0.25            # of the mean: where chance explains more, runs do not show that nothing changes


@dataclass(frozen=True)
class Size:
    """The runs of one size of balls."""
    d: float
    runs: int
    mean: float
    scatter: Optional[float]            # standard deviation of a run; None of a single one
    balls: Optional[float] = None       # over the thickness of the body, on average; None: the variable is no diameter


@dataclass(frozen=True)
class Halving:
    """From a size to the first that is half as large or less; chance: of the difference of both, None: not known."""
    coarse: Size
    fine: Size
    chance: Optional[float]

    @property
    def difference(self) -> float:
        return self.fine.mean - self.coarse.mean

    @property
    def within_chance(self) -> bool:
        """False where chance is not known."""
        return self.chance is not None and abs(self.difference) <= self.chance

    @property
    def tells(self) -> bool:
        """Whether chance is little enough to show a change."""
        return self.chance is not None and self.chance <= TELLS * abs(self.fine.mean)


@dataclass(frozen=True)
class Convergence:
    """Of one quantity; sizes: the largest first."""
    sizes: Tuple[Size, ...]
    halvings: Tuple[Halving, ...]

    @property
    def resolved(self) -> bool:
        """Whether AGREEING halvings in a row, the first from BALLS of thickness or more, change no more than chance,

        which is little, and no finer one does.
        """
        good = [one.within_chance and one.tells and one.coarse.balls is not None and one.coarse.balls >= BALLS
                for one in self.halvings]
        return len(good) >= AGREEING and all(good[-AGREEING:])


def compare(runs: Sequence[Tuple[float, Sequence[float]]], balls: Sequence[Optional[float]]) -> Convergence:
    """Of (size > 0, values of its runs), of at least two sizes, and the thickness in balls of each.

    Chance: t s sqrt(1/n + 1/m), the 95 % interval of the difference of two means, with the scatter s of both pooled;
    where one was run once, that of the other.
    """
    order = sorted(zip(runs, balls), key=lambda pair: -pair[0][0])
    combinations = [Combination(f"{d:g}", {str(k): value for k, value in enumerate(values)})
                    for (d, values), _ in order]
    sizes = [Size(d, one.runs, one.mean, one.scatter, thick)
             for ((d, _), thick), one in zip(order, combinations)]
    halvings, k = [], 0
    while (other := next((m for m in range(k + 1, len(sizes)) if sizes[k].d >= HALVED * sizes[m].d), None)) is not None:
        halvings.append(Halving(sizes[k], sizes[other], chance(pooled([combinations[k], combinations[other]]),
                                                               sizes[k].runs, sizes[other].runs)))
        k = other
    return Convergence(tuple(sizes), tuple(halvings))


def chance(scatter: Optional[Scatter], *runs: int) -> Optional[float]:
    """Of the difference of two means of so many runs each."""
    return None if scatter is None else scatter.quantile * scatter.deviation * math.sqrt(sum(1 / n for n in runs))


# --- in words ---

def describe_convergence(result: Convergence, name: str, what: str, unit: str, number) -> List[str]:
    """Plain sentences on a quantity; name: the variable's, number: writes a value of the quantity as text."""
    sentences = []
    for halving in result.halvings:
        text = (f"{what}: {number(halving.coarse.mean)} {unit} at {name} {halving.coarse.d:g}, "
                f"{number(halving.fine.mean)} at " f"{halving.fine.d:g}")
        if halving.chance is None:
            sentences.append(f"{text}; chance is not known: repeats at one of them tell it")
        else:
            sentences.append(f"{text}, {'no more' if halving.within_chance else 'more'} than chance explains "
                             f"({number(halving.chance)})")
    if result.resolved:
        return [*sentences, f"{what}: resolved: {AGREEING} halvings change no more than chance"]
    return [*sentences, f"{what}: not resolved: this takes {AGREEING} halvings in a row that change no more than "
            f"chance, up to {100 * TELLS:g} % of the mean (more repeats), from {BALLS:g} balls of thickness on"]
