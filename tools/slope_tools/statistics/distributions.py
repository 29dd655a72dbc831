"""The meaning of --vary in an ensemble: variables of a deck, and the distributions of their values."""
import dataclasses
import decimal
import math
import re
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
import scipy

from ..case import deck_ranges, settings
from ..errors import SlopeError

FORMS = {"uniform": "LO:HI", "loguniform": "LO:HI", "triangular": "LO:MODE:HI", "normal": "MEAN:DEVIATION:LO:HI",
         "lognormal": "MEDIAN:DEVIATION_OF_LN:LO:HI",
         "list": "V1@WEIGHT,V2@WEIGHT,..."}
MUST = "must be NAME=LO:HI or NAME=KIND:..., of " + ", ".join(f"{kind}:{form}" for kind, form in FORMS.items())
DIGITS = 6              # of a value, and of its place between the bounds
LEAST_SHARE = 1e-6      # of a normal distribution that must lie between its bounds
WIDE = 6.0              # deviations of a normal distribution in which nearly all of it lies


@dataclass(frozen=True)
class Range:
    """A variable between two bounds; frozen is its distribution (scipy)."""
    name: str
    text: str               # what stood behind NAME=
    low: float
    high: float
    frozen: Any
    width: float            # in which nearly all values lie, at most high - low
    wide: Optional[Tuple[float, float]] = None      # see widened()

    @property
    def decimals(self) -> int:
        """To which decimal values are written: DIGITS of the width."""
        return max(0, DIGITS - 1 - math.floor(math.log10(self.width)))

    def value(self, u: float) -> str:
        """The value (text, for the deck) at which a share u of the distribution lies below."""
        low, high = self.wide or (self.low, self.high)
        x = float(self.frozen.ppf(u)) if 0 <= u <= 1 else self.low + u * (self.high - self.low)
        x = min(max(x, low), high)
        text = f"{x:.{self.decimals}f}"
        if x != 0 and abs(x) < 10.0 ** (DIGITS - self.decimals):     # near 0 a loguniform value has few digits left
            text = f"{x:.{DIGITS}g}"
        if not low <= float(text) <= high:        # rounded out of the range
            text = repr(x)
        return settings.format_decimal(decimal.Decimal(text))

    def unit(self, text: str) -> float:
        """The share of the distribution below a value: the inverse of value(), outside of the bounds, too."""
        value = float(text)
        if self.wide and not self.low <= value <= self.high:
            return (value - self.low) / (self.high - self.low)
        return float(self.frozen.cdf(value))

    def widened(self, low: float, high: float) -> "Range":
        """With wider bounds for runs that are added; of a uniform distribution, whose density goes on as it is there:
        places below 0 and above 1."""
        return dataclasses.replace(self, wide=(low, high))

    @property
    def places(self) -> Tuple[float, float]:
        """The lowest and the highest that runs can have."""
        if not self.wide:
            return 0.0, 1.0
        low, high = ((one - self.low) / (self.high - self.low) for one in self.wide)
        return min(low, 0.0), max(high, 1.0)

    def snap(self, u: np.ndarray) -> np.ndarray:
        """The places that runs can have; of a range, all."""
        return u

    @property
    def limits(self) -> Tuple[str, ...]:
        """Values between which, or at which, all of them are."""
        return repr(self.low), repr(self.high)


@dataclass(frozen=True)
class Exponential:
    """The distribution of exp(x), given the one of x."""
    log: Any

    def ppf(self, share):
        return np.exp(self.log.ppf(share))

    def cdf(self, value):
        with np.errstate(divide="ignore"):
            return self.log.cdf(np.log(value))


@dataclass(frozen=True)
class Listed:
    """A variable that has one of several values, each with a share; edges are the shares summed up, from 0 to 1."""
    name: str
    text: str
    values: Tuple[str, ...]
    edges: Tuple[float, ...]

    @property
    def places(self) -> Tuple[float, float]:
        return 0.0, 1.0

    def _index(self, u) -> np.ndarray:
        return np.clip(np.searchsorted(self.edges, u, "right") - 1, 0, len(self.values) - 1)

    def value(self, u: float) -> str:
        return self.values[int(self._index(u))]

    def unit(self, text: str) -> float:
        """The middle of the value's share."""
        i = self.values.index(text)
        return (self.edges[i] + self.edges[i + 1]) / 2

    def snap(self, u: np.ndarray) -> np.ndarray:
        """The middles of the values' shares, which is where runs are."""
        edges = np.array(self.edges)
        return ((edges[:-1] + edges[1:]) / 2)[self._index(u)]

    @property
    def limits(self) -> Tuple[str, ...]:
        return self.values


def parse(options: Sequence[str], deck, option: str = "--vary", ranges_only: bool = False) -> List[Any]:
    """The variables (Range or Listed) of the options NAME=DISTRIBUTION, in their order.

    Every NAME must be an index variable of the deck, and no value may leave the range that the deck has for it
    (deck_ranges). ranges_only: no list will do.
    """
    for words in options:
        if "=" not in words:
            raise SlopeError(option, MUST, words)
    names = settings.check_names([words.partition("=")[0] for words in options], deck, option, options)
    checks = deck_ranges.Checks(deck)
    distributions = []
    for name, words in zip(names, options):
        parsed = distribution(name, words.partition("=")[2], option, words)
        if ranges_only and isinstance(parsed, Listed):
            raise SlopeError(option, "must be a range here, NAME=LO:HI", words)
        checks.vary(option, name, words)
        for value in parsed.limits:
            checks.value(option, name, value, words)
        distributions.append(parsed)
    return distributions


def distribution(name: str, text: str, option: str, words: str):
    """One variable; words: the whole option, for messages."""
    kind, colon, rest = text.partition(":")
    if kind not in FORMS:
        kind, rest = "uniform", text
    if kind == "list":
        return parse_listed(name, rest, option, words)
    try:
        numbers = [float(part) for part in rest.split(":")]
    except ValueError:
        numbers = []
    if len(numbers) != len(FORMS[kind].split(":")) or not all(map(math.isfinite, numbers)):
        raise SlopeError(option, MUST, words)
    low, high = numbers[2:] if kind.endswith("normal") else (numbers[0], numbers[-1])
    if not math.isfinite(high - low):
        raise SlopeError(option, f"{name} must have bounds whose difference is a number", words)
    if not low < high:
        raise SlopeError(option, f"{name} must have its lower bound first, LO < HI", words)
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        raise SlopeError(option, f"{name} must have bounds that differ by more than rounding", words)
    drawn = frozen(kind, numbers, option, words)
    width = high - low
    if kind == "normal":
        width = min(width, WIDE * numbers[1])
    if kind == "lognormal":
        width = min(width, float(np.ptp(drawn.ppf([1e-3, 1 - 1e-3]))))
    return Range(name, f"{kind}:{rest}", low, high, drawn, width)


def frozen(kind: str, numbers: Sequence[float], option: str, words: str):
    """The distribution of scipy."""
    low, high = numbers[0], numbers[-1]
    if kind == "uniform":
        return scipy.stats.uniform(low, high - low)
    if kind == "loguniform":
        if not low > 0:
            raise SlopeError(option, "loguniform must have LO > 0", words)
        return scipy.stats.loguniform(low, high)
    if kind == "triangular":
        if not low <= numbers[1] <= high:
            raise SlopeError(option, "triangular must have LO <= MODE <= HI", words)
        return scipy.stats.triang((numbers[1] - low) / (high - low), low, high - low)
    mean, deviation, low, high = numbers
    if not deviation > 0:
        raise SlopeError(option, f"{kind} must have DEVIATION > 0", words)
    if kind == "lognormal":
        if not (mean > 0 and low > 0):
            raise SlopeError(option, "lognormal must have MEDIAN > 0 and LO > 0", words)
        mean, low, high = map(math.log, (mean, low, high))
    between = scipy.stats.norm(mean, deviation)
    if between.cdf(high) - between.cdf(low) < LEAST_SHARE:
        raise SlopeError(option, f"{kind} must have a part of it between LO and HI", words)
    drawn = scipy.stats.truncnorm((low - mean) / deviation, (high - mean) / deviation, mean, deviation)
    return Exponential(drawn) if kind == "lognormal" else drawn


def parse_listed(name: str, rest: str, option: str, words: str) -> Listed:
    """A list V1@WEIGHT,V2@WEIGHT,...; without weights all values weigh the same."""
    entries: Dict[str, float] = {}
    for part in rest.split(","):
        value, at, weight = part.rpartition("@") if "@" in part else (part, "", "1")
        if not (value.strip() and re.fullmatch(r"[0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?", weight) and float(weight) > 0):
            raise SlopeError(option, f"must be NAME=list:{FORMS['list']} with weights > 0", words)
        if settings.normalise_value(value) in map(settings.normalise_value, entries):
            raise SlopeError(option, "must have every value once", words)
        entries[value] = float(weight)
    if len(entries) < 2:
        raise SlopeError(option, f"{name} must have several values (--set takes one)", words)
    weights = np.array(list(entries.values()))
    edges = np.concatenate([[0.0], np.cumsum(weights) / weights.sum()])
    return Listed(name, f"list:{rest}", tuple(entries), tuple(float(edge) for edge in edges))
