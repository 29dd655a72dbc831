"""The conservative volume: one that the next run stays below, from runs that differ by choice and by chance.

The runs of a study are combinations of choices (rolling resistance, friction), each repeated with values of no
preference (a seed, the position of the lattice). The model of the scatter: run i of combination k gives
V = M_k + L_i + e, a mean of the combination, a part L_i that the runs i of all combinations have in common because they
start from the same lattice (it may be 0), and a part of each run's own; both are normal. Their variance grows with the
mean, as that of counts does: between scatter that is equal and scatter that is a share of the volume, of which nobody
knows beforehand. Combinations whose means differ by more than a factor NEAR tell nothing of each other. All volumes are
in m3 of ground (bulk); every function is pure.
"""
import functools
import math
from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence, Tuple

import scipy
from scipy import special

from . import rounding

CONFIDENCE = 0.975      # of the next single run: it is below the volume in 39 of 40 studies
DIFFERENT = 0.95        # a difference is clear if chance gives it in fewer than one of twenty studies
NEAR = 2.0              # ratio of the means of combinations whose scatter is taken together, at most
ROUNDING = 1e-9         # of a volume: smaller differences are rounding


@dataclass(frozen=True)
class Combination:
    """The runs of one combination of choices: {which repeat: volume in m3}; the key is the same in all combinations."""
    name: str
    volumes: Dict[str, float]

    @property
    def runs(self) -> int:
        return len(self.volumes)

    @property
    def mean(self) -> float:
        return math.fsum(self.volumes.values()) / self.runs

    @property
    def squares(self) -> float:
        """Sum of the squares of the deviations from the mean, m6."""
        mean = self.mean
        deviations = [volume - mean for volume in self.volumes.values()]
        return math.fsum(one ** 2 for one in deviations if abs(one) > ROUNDING * abs(mean))

    @property
    def scatter(self) -> Optional[float]:
        """Standard deviation (m3) of its own runs; None of a single one."""
        return math.sqrt(self.squares / (self.runs - 1)) if self.runs > 1 else None


@dataclass(frozen=True)
class Scatter:
    """Standard deviation (m3) of a run by chance, and its degrees of freedom."""
    deviation: float
    degrees_of_freedom: float

    @property
    def quantile(self) -> float:
        """t(0.975) of these degrees of freedom."""
        return float(special.stdtrit(self.degrees_of_freedom, CONFIDENCE))

    def chance(self, runs: int) -> float:
        """How far (m3) the next run may lie above the mean of so many: t s sqrt(1 + 1/n), a prediction limit.

        Hahn and Meeker, Statistical Intervals, 1991, section 4.7.
        """
        return self.quantile * self.deviation * math.sqrt(1 + 1 / runs)


@dataclass(frozen=True)
class ConservativeVolume:
    """volume = mean + chance (m3); chance is None without repeats."""
    volume: float
    mean: float
    chance: Optional[float]
    combination: str
    repeats: int                    # runs of that combination
    runs: int                       # of all
    scatter: Optional[Scatter]

    @property
    def kind(self) -> str:
        """How the volume is to be called."""
        if self.chance is not None:
            return "prediction"
        return f"largest of {self.runs} run{'s' * (self.runs > 1)}; chance unknown"

    @property
    def place(self) -> float:
        """The power of ten (m3) that the volume is rounded to: what is known of it, but three digits at least."""
        digits = rounding.place_of_digits(self.volume)
        if self.scatter is None or not self.scatter.deviation > 0:
            return digits
        return min(rounding.choose_rounding(self.scatter.deviation), digits)

    def rounded(self) -> Dict[str, Optional[float]]:
        """volume, mean and chance, each rounded up to what is known, so that the rounded parts add up."""
        parts = {name: None if value is None else rounding.up(value, self.place)
                 for name, value in (("mean", self.mean), ("chance", self.chance))}
        total = math.fsum(part for part in parts.values() if part is not None)
        return {"volume": rounding.nearest(total, self.place), **parts}


@dataclass(frozen=True)
class Difference:
    """Between the largest and the smallest mean (m3) of several combinations, and the range expected by chance."""
    largest: str
    smallest: str
    by: float
    chance: Optional[float]         # None: not known

    @property
    def clear(self) -> Optional[bool]:
        return None if self.chance is None else self.by > self.chance


# --- scatter ---

def pooled(combinations: Sequence[Combination]) -> Optional[Scatter]:
    """The scatter of a run over all combinations; None if none of them has two runs.

    s2 is the sum of squares within the combinations over their degrees of freedom, sum (n_k - 1). As runs with the same
    repeat may have a part in common, s2 may be known less well than that: see shared().
    """
    free = sum(one.runs - 1 for one in combinations)
    if free == 0:
        return None
    deviation = math.sqrt(math.fsum(one.squares for one in combinations) / free)
    return Scatter(deviation, free * shared(combinations))


def like(combinations: Sequence[Combination], combination: Combination) -> List[Combination]:
    """Those whose scatter says something of that of one, itself among them, their deviations as they would be there.

    Variances grow with the mean: deviations count by the square root of the ratio of the means. Where a single run has
    no near ones with repeats, all count that are not 0, by the ratio itself.
    """
    def scaled(other: Combination, power: float) -> Combination:
        if other.mean == combination.mean:
            return other
        scale = (combination.mean / other.mean) ** power
        return Combination(other.name, {key: scale * value for key, value in other.volumes.items()})

    near = [other for other in combinations if other is combination or combination.mean <= NEAR * other.mean <=
            NEAR ** 2 * combination.mean]
    if combination.runs > 1 or any(other.runs > 1 for other in near):
        return [scaled(other, 0.5) for other in near]
    return [scaled(other, 1.0) for other in combinations if other is combination or other.mean > 0 and
            combination.mean > 0]


def scatter_of(combinations: Sequence[Combination], combination: Combination) -> Optional[Scatter]:
    """The scatter of a run of a combination, from all that are like it; None if none of them has two runs.

    The dispersion of quasi-likelihood with a variance in proportion to the mean, by Pearson's statistic (McCullagh and
    Nelder, Generalized Linear Models, 1989, section 9.2).
    """
    return pooled(like(combinations, combination))


def shared(combinations: Sequence[Combination]) -> float:
    """The share of the degrees of freedom that is left where repeats have a part in common: 1/K to 1 of K combinations.

    Satterthwaite's approximation (Biometrics Bulletin 2, 1946, 110), of s2 = MB/K + MR (K - 1)/K with the mean squares
    between the repeats (n - 1) and of the rest, (n - 1)(K - 1). Repeats that a combination lacks are left out of it;
    with fewer than two in common nothing is known, and the smallest number of any combination counts.
    """
    several = [one for one in combinations if one.runs > 1]
    free = sum(one.runs - 1 for one in several)
    if len(several) < 2:
        return 1.0
    keys = [key for key in several[0].volumes if all(key in one.volumes for one in several)]
    count, repeats = len(several), len(keys)
    if repeats < 2:
        return min(one.runs - 1 for one in several) / free
    table = [[one.volumes[key] for key in keys] for one in several]
    rows = [math.fsum(row) / repeats for row in table]
    columns = [math.fsum(column) / count for column in zip(*table)]
    mean = math.fsum(rows) / count
    within = math.fsum((value - rows[k]) ** 2 for k, row in enumerate(table) for value in row)
    between = min(within, count * math.fsum((column - mean) ** 2 for column in columns))
    if within <= (ROUNDING * mean) ** 2:
        return 1.0
    one = between / (repeats - 1) / count
    rest = (within - between) / (repeats - 1) / count
    effective = (one + rest) ** 2 / (one ** 2 + rest ** 2 / (count - 1))        # over (repeats - 1)
    return effective / count


def odd_one(combinations: Sequence[Combination], name: str) -> Optional[Tuple[float, float]]:
    """s (m3) of a combination and that of others like it, if its own is larger than chance explains.

    A common scatter is then too small for it. F test, one of twenty.
    """
    mine = next(one for one in combinations if one.name == name)
    rest = [one for one in like(combinations, mine) if one.name != name]
    free = sum(one.runs - 1 for one in rest)
    if mine.scatter is None or free == 0:
        return None
    others = math.sqrt(math.fsum(one.squares for one in rest) / free)
    most = others * math.sqrt(float(special.fdtri(mine.runs - 1, free, DIFFERENT)))
    return (mine.scatter, others) if mine.scatter > most else None


# --- the volume ---

def predict(combinations: Sequence[Combination]) -> ConservativeVolume:
    """The volume that the next run stays below, and its parts.

    The combination with the largest sum of mean and chance governs; with equal numbers of runs that is the one with the
    largest mean. If several means are about the same, the largest is high by chance, so the volume is conservative
    (see the page on `slope study`).
    """
    candidates: List[ConservativeVolume] = []
    for one in combinations:
        scatter = scatter_of(combinations, one)
        chance = scatter.chance(one.runs) if scatter else None
        candidates.append(ConservativeVolume(one.mean + (chance or 0.0), one.mean, chance, one.name, one.runs,
                                             sum(other.runs for other in combinations), scatter))
    return max(candidates, key=lambda each: each.volume)


def difference(line: Sequence[Combination], scatter: Optional[Scatter]) -> Difference:
    """Of the largest and the smallest mean of a line of combinations, against the range of as many means by chance.

    The studentized range (Tukey and Kramer; Hochberg and Tamhane, Multiple Comparison Procedures, 1987, section 3.3).
    """
    top, low, unit = ends(line)
    chance = None
    if scatter is not None:
        chance = range_quantile(len(line), scatter.degrees_of_freedom) * scatter.deviation * unit
    return Difference(top.name, low.name, top.mean - low.mean, chance)


@functools.lru_cache(maxsize=None)
def range_quantile(means: int, degrees_of_freedom: float) -> float:
    """What the studentized range of so many means exceeds by chance in 5 of 100 cases: 0.2 s, the same for many."""
    return float(scipy.stats.studentized_range.ppf(DIFFERENT, means, degrees_of_freedom))


def is_clear(line: Sequence[Combination], scatter: Scatter) -> bool:
    """Whether difference() is clear, without computing its chance: many times as fast."""
    top, low, unit = ends(line)
    by = top.mean - low.mean
    if by == 0 or scatter.deviation == 0:
        return by > 0
    return float(scipy.stats.studentized_range.cdf(by / (scatter.deviation * unit), len(line),
                                                   scatter.degrees_of_freedom)) > DIFFERENT


def ends(line: Sequence[Combination]) -> Tuple[Combination, Combination, float]:
    """The combinations of the largest and the smallest mean, and the unit of their range in standard deviations."""
    top, low = max(line, key=lambda combination: combination.mean), min(line, key=lambda combination: combination.mean)
    return top, low, math.sqrt((1 / top.runs + 1 / low.runs) / 2)
