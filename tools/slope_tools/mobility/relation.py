"""How far a mass runs for its volume and fall: a least-squares relation of known events, with its scatter.

log10 L = a + b log10 V + c log10 H + d (1 if laterally confined), L and H in m, V in million m3. One more event lies at
a t-distributed distance from it, whose scale counts the leverage: s sqrt(1 + x' (X'X)^-1 x) (Draper and Smith, Applied
Regression Analysis, 1998, section 5.1).
"""
import math
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np
from scipy import stats

from ..errors import SlopeError
from .events import Event

LEAST = 12      # events: three for each of the four coefficients


class Relation(NamedTuple):
    """coefficients: a, b, c, d; deviation: residual standard deviation (log10); r2: share of the variance explained.

    inverse: (X'X)^-1; free: degrees of freedom; volumes (million m3) and falls (m): range of the events; lateral: share
    of them that are laterally confined.
    """
    coefficients: np.ndarray
    deviation: float
    r2: float
    inverse: np.ndarray
    free: int
    volumes: Tuple[float, float]
    falls: Tuple[float, float]
    lateral: float

    @property
    def kinds(self) -> Tuple[str, ...]:
        """Of curves; the last one counts unless another is asked for."""
        return "confined", "unconfined", "mixture"

    @property
    def name(self) -> str:
        return f"{self.free + len(self.coefficients)} events"

    def beyond(self, kind: str, length, volume: float, fall) -> np.ndarray:
        """Share of events of a kind that run farther; the mixture has as many confined ones as the set."""
        share = {"confined": 1.0, "unconfined": 0.0, "mixture": self.lateral}[kind]
        return share * self.exceedance(length, volume, fall, True) \
            + (1 - share) * self.exceedance(length, volume, fall, False)

    def farthest(self, share: float, volume: float, fall: float) -> float:
        """Length (m) that this share of the events of any kind stays within."""
        return max(self.quantile(share, volume, fall, confined) for confined in (True, False))

    def _centre_and_scale(self, volume: float, fall, confined: bool):
        """Of log10 L of one more event; volume in million m3, fall in m (a number or an array)."""
        logs = np.log10(np.asarray(fall, dtype=float))
        x = np.stack([np.ones_like(logs), np.full_like(logs, math.log10(volume)), logs,
                      np.full_like(logs, float(confined))], axis=-1)
        leverage = np.einsum("...i,ij,...j->...", x, self.inverse, x)
        return x @ self.coefficients, self.deviation * np.sqrt(1 + leverage)

    def quantile(self, share: float, volume: float, fall: float, confined: bool = False) -> float:
        """Length (m) that one more event stays within with this probability."""
        centre, scale = self._centre_and_scale(volume, fall, confined)
        return float(10 ** (centre + stats.t.ppf(share, self.free) * scale))

    def exceedance(self, length, volume: float, fall, confined: bool = False) -> np.ndarray:
        """Probability that one more event with this fall (m) runs farther than length (m); arrays or numbers, > 0."""
        centre, scale = self._centre_and_scale(volume, fall, confined)
        return stats.t.sf((np.log10(length) - centre) / scale, self.free)


def of_events(events: Sequence[Event], where="the set of events") -> Relation:
    """The relation of a set; raises SlopeError for fewer than LEAST events, or for events that do not determine it.

    A set without confined events, or with confined ones only, does not determine d.
    """
    if len(events) < LEAST:
        raise SlopeError(where, f"must have at least {LEAST} events for a relation with scatter", len(events))
    x = np.array([[1, math.log10(one.volume), math.log10(one.fall), one.confined] for one in events], dtype=float)
    y = np.log10([one.length for one in events])
    if np.linalg.matrix_rank(x) < x.shape[1]:
        raise SlopeError(where, "must have events of several volumes and falls, some laterally confined, some not")
    found = np.linalg.lstsq(x, y, rcond=None)[0]
    rest = y - x @ found
    free = len(y) - x.shape[1]
    volumes, falls = ([getattr(one, name) for one in events] for name in ("volume", "fall"))
    return Relation(found, math.sqrt(rest @ rest / free), 1 - rest @ rest / ((y - y.mean()) ** 2).sum(),
                    np.linalg.inv(x.T @ x), free, (min(volumes), max(volumes)), (min(falls), max(falls)),
                    float(np.mean([one.confined for one in events])))


def left_out(events: Sequence[Event]) -> List[float]:
    """Of each event, the probability of a longer one by the relation of all the others."""
    return [float(of_events([*events[:i], *events[i + 1:]]).exceedance(one.length, one.volume, one.fall, one.confined))
            for i, one in enumerate(events)]
