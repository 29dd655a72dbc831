"""From runs with balls of several sizes to values at the finest one, each with its error.

Between two sizes a quantity changes by a factor, the same for all points or one that depends on the value itself, as
sluggish masses gain and mobile ones lose, or on a few parameters; below ten balls' volume, where a factor means
nothing, by a difference.  Both are found from pairs: points that were run with both sizes.  What is left of a pair that
the others predict is the error of a value that was not run: the model's and that of chance, of both runs.  A value
passes through one Step after another to the finest size.

What balls that are finer still would change follows from the last step (grid convergence: Roache, Journal of Fluids
Engineering, 116, 405 (1994); ASME V&V 20-2009, section 2).  All functions are pure.
"""
import functools
import math
from dataclasses import dataclass
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy import special

COUNTED = 10.0          # balls: a volume of fewer has no ratio
CONFIDENCE = 0.9        # of a band: 5 % beyond either end
RIDGES = 1.0, 3.0, 10.0, 30.0       # in units of the parameters' own variance and one pair
BETTER = 0.9            # of the constant's squares of left-out pairs, which a model with parameters must stay below
EVEN = 0.5              # of these with an error that is a share of the value, for one that is the same for all values
FEWEST = 5              # pairs more than parameters that such a model needs
FEW = 3                 # pairs of few balls, whose scatter is known no better than that of ratios
PRIOR = 3.0             # pairs' worth says the step before of the scatter of this one: coarser balls scatter no less
SAFETY = 1.25           # of the extrapolation, where three sizes tell the order (ASME V&V 20)
ORDERS = 0.5, 2.0       # between which an observed order counts
ORDER = 1.0             # else


@functools.lru_cache(maxsize=4096)
def quantile_of_t(freedom: float) -> float:
    """Beyond which (1 - CONFIDENCE) / 2 of Student's t lies."""
    return float(special.stdtrit(freedom, (1 + CONFIDENCE) / 2))


class Finest(NamedTuple):
    """A value at the finest size: of a run with such balls, whose deviation is 0, or transferred from a coarser one.

    deviation: of a run with the finest balls from it; freedom: its degrees of freedom.
    """
    value: float
    deviation: float = 0.0
    freedom: float = math.inf

    @property
    def band(self) -> Tuple[float, float]:
        """Between which a run lies with CONFIDENCE: in the logarithm, unless it may be nothing."""
        half = quantile_of_t(self.freedom) * self.deviation
        if half <= 0:
            return self.value, self.value
        if self.value > 2 * half:
            return self.value * math.exp(-half / self.value), self.value * math.exp(half / self.value)
        return max(0.0, self.value - half), self.value + half


class Model(NamedTuple):
    """Of a change by its pairs: constant + slopes . (at - centre); number: of pairs.

    unit: covariance of constant and slopes over the variance of a pair; deviation: of a pair that was left out;
    freedom: of it; power: 0, it is that of all values, 1, that at the value whose logarithm is typical, and half of it
    at twice the value, where all are so many m3 off, between the logarithms ends; low, high: of the places of the
    pairs, beyond which nothing is extrapolated.
    """
    number: int
    constant: float
    slopes: np.ndarray
    unit: np.ndarray
    centre: np.ndarray
    low: np.ndarray
    high: np.ndarray
    deviation: float
    freedom: float
    typical: float = 0.0
    power: int = 0
    ends: Tuple[float, float] = (0.0, 0.0)

    def relative(self, values: Any) -> np.ndarray:
        """The deviation at values (> 0) over that at the typical one; below all pairs it is as many m3."""
        own = np.log(values)
        return np.exp(self.power * (self.typical - clip_values(own, *self.ends)) + np.maximum(0.0, self.ends[0] - own))

    def beyond(self, at: Any) -> np.ndarray:
        """The error that places (..., p) have as they lie beyond all pairs: what the slopes would change there."""
        places = np.asarray(at, float)
        return np.abs((places - clip_values(places, self.low, self.high)) @ self.slopes)

    def change(self, at: Any, drawn: Optional[np.ndarray] = None) -> np.ndarray:
        """At places (..., p); drawn: other coefficients, of draw()."""
        inside = clip_values(np.asarray(at, float), self.low, self.high) - self.centre
        constant, slopes = (self.constant, self.slopes) if drawn is None else (drawn[0], drawn[1:])
        return np.asarray(constant + inside @ slopes)

    def draw(self, rng: np.random.Generator) -> Tuple[np.ndarray, float]:
        """Coefficients as they may be as well, and the deviation of a run from them."""
        # left-out pairs have the error of the mean of the others, too
        deviation = self.deviation * (math.sqrt(1 - self.unit[0, 0]) or 1.0)
        if math.isfinite(self.freedom):
            deviation *= math.sqrt(self.freedom / rng.chisquare(self.freedom))
        drawn = np.concatenate([[self.constant], self.slopes])
        drawn[0] += deviation * math.sqrt(self.unit[0, 0]) * rng.standard_normal()
        if self.slopes.any():
            drawn[1:] = rng.multivariate_normal(drawn[1:], deviation ** 2 * self.unit[1:, 1:], method="eigh")
        return drawn, deviation

    @property
    def of_largest(self) -> float:
        """The change of the largest value of a pair, where it depends on the value (with_own); else that on average."""
        return self.constant + float(((self.high - self.centre) * self.slopes)[-1:].sum())

    @property
    def error(self) -> float:
        """Standard error of the constant."""
        return self.deviation * math.sqrt(self.unit[0, 0])


class Step(NamedTuple):
    """From a size to the next finer one; finer: how many times; least: of the coarse value that has a ratio.

    ratio: of the logarithm of the factor, small: of the difference below least; None: no pair tells.
    """
    finer: float
    least: float
    ratio: Optional[Model]
    small: Optional[Model]

    @property
    def known(self) -> bool:
        """Whether a pair tells of it."""
        return bool(self.ratio or self.small)

    def apply(self, finest: Finest, at: Any) -> Finest:
        """A value with the next finer balls."""
        if finest.value >= self.least and finest.value > 0 and self.ratio:
            place = with_own(at, finest.value)
            factor = math.exp(float(self.ratio.change(place)))
            value = finest.value * factor
            return joined(value, (finest.deviation * factor, finest.freedom), (value * math.hypot(
                self.ratio.deviation * float(self.ratio.relative(finest.value)), float(self.ratio.beyond(place))),
                self.ratio.freedom))
        mine, freedom = self.of_small()
        change = self.small.constant if self.small else 0.0
        return joined(max(0.0, finest.value + change), (finest.deviation, finest.freedom), (mine, freedom))

    def of_small(self) -> Tuple[float, float]:
        """Deviation and degrees of freedom below least; of few pairs at least that of a ratio at it."""
        deviation, freedom = (self.small.deviation, self.small.freedom) if self.small else (0.0, math.inf)
        if self.ratio and (not self.small or self.small.number < FEW):
            return max(deviation, self.least * self.ratio.deviation), self.ratio.freedom
        return deviation, freedom

    def draws(self, rng: np.random.Generator, values: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Values as they may be with the next finer balls: of one draw of the model, with what each run has alone."""
        changed, noise = values.astype(float), rng.standard_normal(len(values))
        big = (values >= self.least) & (values > 0)
        if self.ratio and big.any():
            drawn, deviation = self.ratio.draw(rng)
            place = with_own(at[big], values[big])
            mine = np.hypot(deviation * self.ratio.relative(values[big]), self.ratio.beyond(place))
            changed[big] = values[big] * np.exp(self.ratio.change(place, drawn) + mine * noise[big])
        else:
            big = np.zeros(len(values), bool)
        change = self.small.constant if self.small else 0.0
        changed[~big] = np.maximum(0.0, values[~big] + change + self.of_small()[0] * noise[~big])
        return changed


def joined(value: float, *parts: Tuple[float, float]) -> Finest:
    """A value with independent (deviation, freedom), by Satterthwaite's approximation."""
    squares = [deviation ** 2 for deviation, _ in parts]
    total = sum(squares)
    if total <= 0:
        return Finest(value)
    lost = sum((square / total) ** 2 / freedom for square, (_, freedom) in zip(squares, parts))
    return Finest(value, math.sqrt(total), 1 / lost if lost > 0 else math.inf)


# --- the models ---

def fit_step(coarse: Sequence[float], fine: Sequence[float], at: Any, finer: float = 2.0,
             ball: float = 0.0, before: Optional[Step] = None) -> Step:
    """The Step that pairs tell: values (>= 0) with either balls, and their parameters (n, p), of similar ranges.

    ball: volume of a coarse ball, 0 of lengths; before: the step from the size before, which tells of the scatter, too.
    """
    first, other, places = np.asarray(coarse, float), np.asarray(fine, float), np.asarray(at, float)
    places = places.reshape(len(first), -1 if len(first) else 0)
    least = COUNTED * ball
    gone = (first >= least) & (first > 0) & (other <= (ball / COUNTED if ball > 0 else 1e-3 * first))
    if gone.any():      # what becomes nothing has no factor, nor have values up to it
        least = float(np.nextafter(first[gone].max(), np.inf))
    big = (first >= least) & (first > 0)
    logs = np.log(np.maximum(other[big], ball / COUNTED if ball > 0 else 1e-3 * first[big]) / first[big])
    few = (other - first)[~big & ~gone] if (~big & ~gone).any() else (other - first)[gone]
    small = model(few, np.empty((len(few), 0)), None)
    if small and gone.any():        # it says how far others may fall, not how far they do
        squares = (other - first)[gone] ** 2
        small = small._replace(deviation=math.sqrt((len(few) * small.deviation ** 2 + squares.sum()) /
                                                   (len(few) + len(squares))))
    return Step(finer, least, model(logs, with_own(places[big], first[big]), before.ratio if before else None), small)


def clip_values(values: Any, low: Any, high: Any) -> np.ndarray:
    """np.clip(), which takes ten times as long for a few numbers."""
    return np.minimum(np.maximum(values, low), high)


def with_own(at: Any, values: Any) -> np.ndarray:
    """Places (..., p) with the logarithm of values (> 0) as the last of their parameters."""
    own, places = np.log(np.asarray(values, float))[..., None], np.asarray(at, float)
    return np.concatenate([places.reshape(*own.shape[:-1], places.shape[-1]), own], axis=-1)


def model(changes: np.ndarray, at: np.ndarray, before: Optional[Model]) -> Optional[Model]:
    """Of changes (n) at places (n, p) of with_own(): the constant, or a ridge on the value itself or on the others, by
    the left-out pairs; None without a pair."""
    number, parameters = at.shape
    if not number:
        return None
    own = at[:, -1] if parameters else np.zeros(number)
    best = of_power(changes, at, before.power if before and parameters else 0)
    if parameters and number >= FEWEST and (other := of_power(changes, at, 1 - best.power)).squares < \
            EVEN * best.squares:
        best = other
    ends = before.ends if before and best.power else ()
    squares = best.squares
    if number == 1:     # no other predicts it: all of its change is error
        squares = float(changes[0]) ** 2
    freedom = number - best.taken
    variance = squares / max(number + 1 - best.taken, 1.0)      # chosen by these squares, a ridge has less of them
    if before is not None:
        prior, deviation = min(PRIOR, before.freedom), before.deviation * float(before.relative(np.exp(own.mean())))
        variance = (max(freedom, 0.0) * variance + prior * deviation ** 2) / (max(freedom, 0.0) + prior)
        freedom = max(freedom, 0.0) + prior
    return Model(number, best.constant, best.slopes, best.unit, best.centre, at.min(axis=0), at.max(axis=0),
                 math.sqrt(variance), max(freedom, 1.0), float(own.mean()), best.power,
                 (min([own.min(), *ends[:1]]), max([own.max(), *ends[1:]])))


def of_power(changes: np.ndarray, at: np.ndarray, power: int) -> "Ridge":
    """The best of the models whose error has this power (Model)."""
    number, parameters = at.shape
    own = at[:, -1] if parameters else np.zeros(number)
    weights = np.exp(2 * power * (own - own.mean()))    # of a geometric mean of 1: squares can be compared
    best, few = ridge(changes, at, math.inf, weights, power), BETTER
    for used in ([parameters - 1], range(parameters - 1)) if parameters else ():
        mask = np.isin(np.arange(parameters), used) & (np.ptp(at, axis=0) > 0)
        if not mask.any() or number < FEWEST + mask.sum():
            continue
        other = min((ridge(changes, np.where(mask, at, at.mean(axis=0)), penalty, weights, power)
                     for penalty in RIDGES), key=lambda candidate: candidate.squares)
        if other.squares < few * best.squares:
            best, few = other, 1.0
    return best


class Ridge(NamedTuple):
    """taken: parameters in effect; squares: of the left-out residuals, weighted; power: of Model."""
    constant: float
    slopes: np.ndarray
    unit: np.ndarray
    centre: np.ndarray
    taken: float
    squares: float
    power: int


def ridge(changes: np.ndarray, at: np.ndarray, penalty: float, weights: np.ndarray, power: int = 0) -> Ridge:
    """The constant is not shrunk; an infinite penalty leaves it alone."""
    parameters, whole = at.shape[1], weights.sum()
    centre, constant = weights @ at / whole, float(weights @ changes / whole)
    centred = at - centre
    unit = np.zeros((parameters + 1, parameters + 1))
    unit[0, 0] = 1 / whole
    slopes, hat = np.zeros(parameters), weights / whole
    if math.isfinite(penalty):
        scale = np.where(centred.std(axis=0) > 0, centred.std(axis=0), 1.0)
        inverse = np.linalg.inv((weights[:, None] * centred).T @ centred + penalty * np.diag(scale ** 2))
        slopes = inverse @ centred.T @ (weights * changes)
        hat = hat + weights * np.einsum("ij,jk,ik->i", centred, inverse, centred)
        unit[1:, 1:] = inverse
    residuals = changes - constant - centred @ slopes
    left_out = residuals / np.maximum(1 - hat, 1e-9)
    return Ridge(constant, slopes, unit, centre, float(hat.sum()), float(weights @ left_out ** 2), power)


def transfer(steps: Sequence[Step], value: float, at: Any) -> Finest:
    """A value of a run through the steps that are left from its size to the finest."""
    one = Finest(value)
    for step in steps:
        one = step.apply(one, at)
    return one


def draws(steps: Sequence[Sequence[Step]], values: Sequence[float], at: Any, number: int,
          seed: int = 1) -> np.ndarray:
    """Values (number, n) as they may be at the finest size; steps: left of each value, the last ones of one list."""
    rng, places = np.random.default_rng(seed), np.asarray(at, float).reshape(len(values), -1)
    whole = max(steps, key=len, default=())
    found = np.tile(np.asarray(values, float), (number, 1))
    for one in found:
        for k, step in enumerate(whole):
            mine = np.array([len(left) >= len(whole) - k for left in steps])
            one[mine] = step.draws(rng, one[mine], places[mine])
    return found


# --- balls that are finer still ---

@dataclass(frozen=True)
class Left:
    """What finer balls would change, as shares of a value: from low (<= 0) to high (>= 0), best between them.

    grown: by how much the last step raised it, on average or the largest value, a share; order: of convergence,
    observed: whether two steps agree on it.
    """
    low: float
    best: float
    high: float
    grown: float
    order: float
    observed: bool


def estimate_remaining_step(steps: Sequence[Step]) -> Optional[Left]:
    """By the last of at least two steps; None where they do not tell it, as where all values are few balls.

    With the order p and the factor r of the sizes a change g leaves SAFETY g / (r^p - 1), with its standard error.
    """
    if len(steps) < 2:
        return None
    before, last = steps[-2].ratio, steps[-1].ratio
    if last is None:
        return None
    order = observed_order(before, last, steps[-1].finer) if before else None
    share = SAFETY / (steps[-1].finer ** (order or ORDER) - 1)
    half = quantile_of_t(last.freedom) * last.error
    least, most = sorted([last.constant, last.of_largest])
    best, low, high = (math.expm1(share * change) for change in (last.constant, least - half, most + half))
    return Left(min(low, 0.0), best, max(high, 0.0), math.expm1(most), order or ORDER, order is not None)


def observed_order(before: Model, last: Model, finer: float) -> Optional[float]:
    """By the changes of two steps of the same factor, where both are clear and of one sign; None where they are not.

    Changes that hardly shrink, or grow, leave as much as the least order does.
    """
    clear = [abs(one.constant) > 2 * one.error for one in (before, last)]
    if not all(clear) or before.constant * last.constant <= 0:
        return None
    order = math.log(before.constant / last.constant) / math.log(finer)
    return max(order, ORDERS[0]) if order <= ORDERS[1] else None


def order_spread_points(places: np.ndarray, first: Sequence[int], number: int) -> List[int]:
    """An order of points (n, d) that spreads out: first ones, then always the one that is farthest from all before."""
    count = len(places)
    scale = np.ptp(places, axis=0)
    scaled = places / np.where(scale > 0, scale, 1.0)
    chosen = list(dict.fromkeys(first))[:number]
    if not chosen and count:
        chosen = [int(((scaled - scaled.mean(axis=0)) ** 2).sum(axis=1).argmin())]
    apart = np.min([((scaled - scaled[k]) ** 2).sum(axis=1) for k in chosen], axis=0) if chosen else np.zeros(count)
    while len(chosen) < min(number, count):
        apart[chosen] = -1.0
        chosen.append(int(apart.argmax()))
        apart = np.minimum(apart, ((scaled - scaled[chosen[-1]]) ** 2).sum(axis=1))
    return chosen
