"""The runs of a site of blocks evaluated, by block: shares and quantiles with bounds, for each rolling resistance.

Blocks of one run share its ground: bounds (90 %) count how many of them are worth one independent block, by the
differences between the grounds. What a block that left the terrain with the road ahead, or still moves, would have done
is not known: in a lower bound it does not do it, in an upper one it does.
"""
import math
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, List, Optional, Sequence

import numpy as np

from .. import digits, records
from ..findings import Finding
from ..statistics import hazard, withheld
from ..statistics.entries import Quantile
from .runs import AT_ROAD, QUANTITIES, Run

SHARES = 0.5, 0.95      # of the quantiles
STILL = 2.0             # diameters: a block that goes less far stays where it begins
DEEP = 0.2              # radii: contacts that overlap by more were too soft for the speed
DITCH = "beyond_foot"   # of what is travelled: by this a ditch keeps a block
WIDTHS = 40             # of ditches, at most


@dataclass(frozen=True)
class Share:
    """Of blocks that were seen to do something; open: how many of the others may have done it unseen."""
    share: float
    low: float
    high: float
    seen: int
    blocks: int
    open: int

    @property
    def text(self) -> str:
        if self.open and not self.seen:
            return f"up to {digits.percent(self.high)}"
        least = "at least " * (self.open > 0 and self.seen < self.blocks)
        return least + digits.chance(self.share, self.low, self.high)


@dataclass(frozen=True)
class Quantity:
    """Of the blocks that have it."""
    blocks: int
    quantiles: Sequence[Quantile]
    largest: float

    @property
    def most(self) -> float:
        return self.quantiles[-1].value


@dataclass(frozen=True)
class Result:
    """The runs with one rolling resistance; reach, past: of the road, None without one; crossed: lines."""
    rolling: str
    blocks: int
    grounds: int
    left: int
    away: int           # of these, with no road ahead
    moving: int
    still: int          # that stay where they begin
    reach: Optional[Share]
    past: Optional[Share]
    crossed: Dict[str, Share]
    travel: Dict[str, Quantity]
    at: Dict[str, Dict[str, Optional[Quantity]]]        # of the lines and the road
    retained: Sequence[Share]                           # by ditches of Outcome.widths

    def width(self, share: float, widths: Sequence[float], side: str = "share") -> Optional[float]:
        """m, of the narrowest ditch that keeps a share, or a bound of which (side low or high) does; None: none."""
        return next((width for width, one in zip(widths, self.retained) if getattr(one, side) >= share), None)

    @property
    def at_least(self) -> str:
        """What stands before every statement on reach."""
        return "at least " * (self.left + self.moving > 0)


@dataclass(frozen=True)
class Worst:
    """A number of the result that has the largest: no result has all of them."""
    value: Any              # a Share, or m, m/s, J
    rolling: str


@dataclass(frozen=True)
class Outcome:
    """All results, and the worst of each number: find_worst()."""
    results: List[Result]
    worst: Dict[str, Worst]
    another: float          # probability, at most, that one more ground brings something larger than all of these
    overlap: float          # the deepest contact, in radii
    widths: Sequence[float]     # m, of ditches at the slope's foot
    to_road: Optional[float]    # m, from there to the road, the median of the blocks whose way leads to it

    @property
    def at_least(self) -> str:
        """What stands before the largest of all distances."""
        return max(one.at_least for one in self.results)

    def doubts(self) -> List[Finding]:
        """What is to be known of the runs."""
        blocks, left, away, moving, still = (sum(getattr(one, of) for one in self.results)
                                             for of in ("blocks", "left", "away", "moving", "still"))
        without = f", {away:,} of them where no road is ahead, which count as not reaching it" * (away > 0)
        found = [(left, Finding("blocks left", {"left": left, "blocks": blocks, "away": away, "without": without})),
                 (moving, Finding("blocks moving", {"moving": moving, "blocks": blocks})),
                 (still, Finding("blocks still", {"still": still, "blocks": blocks, "limit": STILL})),
                 (self.overlap > DEEP, Finding("blocks too fast", {"percent": 100 * self.overlap}))]
        return [one for holds, one in found if holds]

    def about(self) -> Dict[str, Any]:
        """For a file, without what has a table of its own."""
        about = records.encode_record(self)
        for one in (about, *about["results"]):
            one.pop("widths", None), one.pop("retained", None)
        return about


def evaluate_blocks(runs: Sequence[Run]) -> Outcome:
    """Of finished runs."""
    widths = widths_to(max(float(one.travel[DITCH].max()) for one in runs))
    ditch = np.concatenate([one.ditch for one in runs])
    results = [result_of([one for one in runs if one.rolling == rolling], widths)
               for rolling in dict.fromkeys(one.rolling for one in runs)]
    return Outcome(results, find_worst(results), withheld.exceeded_at_most(min(one.grounds for one in results)),
                   max(one.overlap for one in runs), widths,
                   None if np.isnan(ditch).all() else float(np.nanmedian(ditch)))


def find_worst(results: Sequence[Result]) -> Dict[str, Worst]:
    """Over all results, of what they have: reach, past and crossed_LINE, a Share each; NUMBER_50, NUMBER_95 and
    NUMBER_largest of the travelled distance, and of what blocks have at lines and at the road."""
    worst: Dict[str, Worst] = {}

    def keep(name: str, value: Any, of: Result, size: Callable[[Any], Any] = lambda value: value) -> None:
        if value is not None and (name not in worst or size(value) > size(worst[name].value)):
            worst[name] = Worst(value, of.rolling)
    for result in results:
        for name, share in (("reach", result.reach), ("past", result.past),
                            *((f"crossed_{line}", share) for line, share in result.crossed.items())):
            keep(name, share, result, lambda share: (share.share, share.high))
        for name, quantity in (("distance", result.travel["distance"]), *(
                (f"{place}_{name}", quantity) for place, of in result.at.items() for name, quantity in of.items())):
            if quantity:
                for quantile in quantity.quantiles:
                    keep(f"{name}_{100 * quantile.share:g}", quantile.value, result)
                keep(f"{name}_largest", quantity.largest, result)
    return worst


def widths_to(most: float) -> List[float]:
    """Round widths (m), at most WIDTHS steps up to the first one that is not below the most."""
    step = next(one for power in range(-1, 6) for one in (10.0 ** power, 2 * 10.0 ** power, 5 * 10.0 ** power)
                if WIDTHS * one >= most)
    return [round(k * step, 6) for k in range(math.ceil(most / step - 1e-9) + 1)]


def result_of(runs: Sequence[Run], widths: Sequence[float]) -> Result:
    def joined(get) -> np.ndarray:
        return np.concatenate([get(one) for one in runs])
    ground = np.repeat([one.ground for one in runs], [len(one.left) for one in runs])
    left, moving = joined(lambda run: run.left), joined(lambda run: run.moving)

    def share(seen: np.ndarray, may: np.ndarray) -> Share:
        unknown, number = int((may & ~seen).sum()), int(seen.sum())
        low, high = hazard.share_bounds(number, len(seen) - unknown, unknown, hazard.effect_of(seen, ground))
        # a few say little of how alike blocks of a ground are: chance leaves no less than if none had been seen
        none = np.zeros(len(seen), bool)
        least = hazard.share_bounds(0, len(seen), 0, hazard.effect_of(none, ground))[1]
        return Share(number / len(seen), float(low), max(float(high), float(least)), number, len(seen), unknown)

    def quantity(values: np.ndarray) -> Optional[Quantity]:
        there = np.isfinite(values)
        return Quantity(int(there.sum()), hazard.compute_quantiles(values[there], ground[there], shares=SHARES),
                        float(values[there].max())) if there.any() else None

    at = {place: {name: joined(lambda run: run.at[place][name]) for name in QUANTITIES} for place in runs[0].at}
    ahead = {place: joined(lambda run: run.ahead[place]) | moving for place in at}
    crossed = {place: share(np.isfinite(values["energy"]), ahead[place]) for place, values in at.items()}
    reach, past = crossed.pop(AT_ROAD, None), None
    if reach:       # what passes has reached it
        past = share(joined(lambda run: run.passed), ahead[AT_ROAD])
        reach, past = replace(reach, low=max(reach.low, past.low)), replace(past, high=min(reach.high, past.high))
    travel = {name: quantity(joined(lambda run: run.travel[name])) for name in runs[0].travel}
    still = joined(lambda run: run.travel["distance"] < STILL * run.diameter) & ~left
    away = int((left & ~ahead[AT_ROAD]).sum()) if reach else 0
    behind, beyond = joined(lambda run: run.behind), joined(lambda run: run.travel[DITCH])
    open_ = (left | moving) & ~behind

    def keeps(kept: np.ndarray) -> Share:
        """Of a ditch: what it does not keep has its bounds, those of none seen too, which a wider one has as well."""
        one = share(kept, open_)
        return replace(one, low=min(one.low, 1 - share(~kept & ~open_, open_).high))
    retained = [keeps(behind | ~open_ & (beyond <= width + 1e-9)) for width in widths]
    return Result(runs[0].rolling, len(ground), len(runs), int(left.sum()), away, int(moving.sum()),
                  int(still.sum()), reach, past, crossed,
                  {name: one for name, one in travel.items() if one},
                  {place: {name: quantity(values) for name, values in of.items()} for place, of in at.items()},
                  retained)
