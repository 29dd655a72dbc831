"""Sets of known events: what fell, how deep and how far; and by them, how far a mass runs for its volume and fall; and
the same by a table of landslides of all sizes.

Sets: log10 L = a + b log10 V + c log10 H + d (1 if laterally confined), L and H in m, V in million m3, by least
squares. One more event lies at a t-distributed distance from it, whose scale counts the leverage:
s sqrt(1 + x' (X'X)^-1 x) (Draper and Smith, Applied Regression Analysis, 1998, section 5.1).

rock_avalanches.csv: 49 rock avalanches of Canada, published with A. Mitchell, S. McDougall, N. Nolde, M.-A. Brideau,
J. Whittall and J. Aaron, Rock avalanche runout prediction using stochastic analysis of a regional dataset, Landslides
17 (2020), 777-792, and its program PRE-RA. Its bias: avalanches that were mapped, none below 0.1 million m3.

Landslides: log10(H / L) = a + b log10 V, H and L in m, V in m3.

landslides.csv: 13 rows by type and path, of J. Corominas, The angle of reach as a mobility index for small and large
landslides, Canadian Geotechnical Journal 33 (1996), 260-271, Table 1. limit is what the lower 95 % limit lies below the
line, in log10.

The scatter s of a row is not given. Its limit is that of one side of a normal distribution if s = limit / 1.645; its R2
gives s = |b| sd sqrt(1 / R2 - 1) for log10 V with the standard deviation sd. Both agree for an sd of 5.5 only (all
translational slides), which no set of landslides has; with SPREAD the second one is a third of the first. Which one is
right is not known here, so both are taken, and at each distance the larger probability counts.
"""
import csv
import math
import re
from pathlib import Path
from typing import List, NamedTuple, Sequence, Tuple

import numpy as np
from scipy import special

from ..errors import SlopeError
from ..heads import parse_cell

OWN = Path(__file__).parent / "rock_avalanches.csv"
CONFINEMENTS = ("frontal", "lateral", "unconfined")
COLUMNS = ("fall_m", "length_m", "volume_Mm3")
LEAST = 12      # events of a relation: three for each of its four coefficients
ROWS = Path(__file__).parent / "landslides.csv"
SIDE = 1.645            # deviations, that 95 % of a normal distribution lie above
SPREAD = 2.0            # assumed standard deviation of log10 V in a row
DEFAULT = "translational_slides"
NOT_OF_ROADS = "they are of natural slopes, not of cuts and embankments of roads"


class Event(NamedTuple):
    """fall: crown to toe, vertical (m); length: crown to toe along the path in plan (m); volume: million m3."""
    name: str
    fall: float
    length: float
    volume: float
    confined: bool      # laterally


def read_events(path: Path = OWN) -> List[Event]:
    """The events of a CSV file with columns name, fall_m, length_m, volume_Mm3 and confinement; others are ignored.

    Raises SlopeError, which names the line, on a missing column, a number that is not finite and above 0, a word that
    is none of CONFINEMENTS, a name that comes twice, and an event that is shorter than its fall, or 50 times as long:
    its units are mixed up (ours are 1.6 to 8.3 times as long).
    """
    try:
        with open(path, encoding="utf-8-sig", newline="") as lines:
            reader = csv.DictReader(lines)
            missing = [name for name in ("name", *COLUMNS, "confinement") if name not in (reader.fieldnames or ())]
            if missing:
                raise SlopeError(path, "must have the columns name, fall_m, length_m, volume_Mm3 and confinement",
                                 "none named " + ", ".join(missing))
            names = [name for name in reader.fieldnames or () if name]
            if len(set(names)) < len(names):
                raise SlopeError(path, "must have each column once", ",".join(names)[:60])
            events: List[Event] = []
            for row in reader:
                if None in row:
                    raise SlopeError(f"{path}: line {reader.line_num}", f"must have {len(names)} cells (a decimal "
                                     "comma?)", len(names) + len(row[None]))
                events.append(event(row, f"{path}: line {reader.line_num}", {one.name for one in events}))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SlopeError(path, f"cannot be read as a set of events: {error}") from None
    return events


def select_events(path: Path, left_out: Sequence[str]) -> List[Event]:
    """The events of a set without those left out (names), all of which it must have."""
    every = read_events(path)
    names = {one.name for one in every}
    for name in left_out:
        if name not in names:
            raise SlopeError("--except", f"must be an event of {path}, such as {', '.join(sorted(names)[:3])}", name)
    return [one for one in every if one.name not in left_out]


def event(row, where, names) -> Event:
    """One row; names: of the events before it."""
    if not row["name"] or row["name"] in names:
        raise SlopeError(where, "name must be given, and once only", repr(row["name"]))
    fall, length, volume = (positive(row[name], f"{where}: {name}") for name in COLUMNS)
    if row["confinement"] not in CONFINEMENTS:
        raise SlopeError(where, "confinement must be one of " + ", ".join(CONFINEMENTS), repr(row["confinement"]))
    if not 1 <= length / fall <= 50:
        raise SlopeError(where, "length_m must be 1 to 50 times fall_m; check that both are in metres",
                         f"{length:g} and {fall:g}")
    return Event(row["name"], fall, length, volume, row["confinement"] == "lateral")


def positive(text, where) -> float:
    value = parse_cell(text or "")
    if not (math.isfinite(value) and value > 0):
        raise SlopeError(where, "must be a number above 0", repr(text))
    return value


# --- their relation ---

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
        return float(10 ** (centre + special.stdtrit(self.free, share) * scale))

    def exceedance(self, length, volume: float, fall, confined: bool = False) -> np.ndarray:
        """Probability that one more event with this fall (m) runs farther than length (m); arrays or numbers, > 0."""
        centre, scale = self._centre_and_scale(volume, fall, confined)
        return special.stdtr(self.free, (centre - np.log10(length)) / scale)


def fit_relation(events: Sequence[Event], where="the set of events") -> Relation:
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


# --- landslides of all sizes ---

class LandslideKind(NamedTuple):
    """A row of the table: for which landslides it is, how many there are, its line and what is known of its scatter."""
    type: str
    path: str
    events: int
    a: float
    b: float
    limit: float
    r2: float

    @property
    def kinds(self) -> Tuple[str, ...]:
        """Of curves; the last one counts."""
        return "landslides_narrow", "landslides_wide", "landslides"

    @property
    def both(self) -> Tuple[str, str]:
        """Of curves, those of both scatters."""
        return self.kinds[0], self.kinds[1]

    @property
    def volumes(self) -> Tuple[float, float]:
        """All: the table does not give the range of a row."""
        return 0.0, math.inf

    @property
    def falls(self) -> Tuple[float, float]:
        return self.volumes

    @property
    def name(self) -> str:
        return f"{self.events} {self.type.replace('_', ' ')}, {self.path} paths" if self.path == "all" else \
            f"{self.events} {self.type.replace('_', ' ')} on {self.path} paths"

    @property
    def deviations(self) -> Tuple[float, float]:
        """The smaller and the larger s, log10."""
        low, high = sorted((self.limit / SIDE, abs(self.b) * SPREAD * math.sqrt(1 / self.r2 - 1)))
        return low, high

    def median(self, volume: float) -> float:
        """log10 H/L that half of the landslides of a volume (million m3) are below."""
        return self.a + self.b * math.log10(1e6 * volume)

    def farthest(self, share: float, volume: float, fall: float) -> float:
        """Length (m) that this share of the landslides stay within, as exceedance() says it."""
        score = float(special.ndtri(share))
        return fall / 10 ** (self.median(volume) - score * self.deviations[int(score > 0)])

    def beyond(self, kind: str, length, volume: float, fall) -> np.ndarray:
        """Share of the landslides of a volume (million m3) and fall (m) that run farther than a length (m); arrays."""
        above = np.log10(np.asarray(fall, float) / length) - self.median(volume)
        narrow, wide = (special.ndtr(above / one) for one in self.deviations)
        return {"landslides": np.maximum(narrow, wide), "landslides_narrow": narrow, "landslides_wide": wide}[kind]


TYPES = "rockfalls", DEFAULT, "debris_flows", "earthflows_and_mudslides"


def read_landslides() -> List[LandslideKind]:
    """All rows."""
    with open(ROWS, encoding="ascii", newline="") as lines:
        return [LandslideKind(one["type"], one["path"], int(one["events"]),
                              *(float(one[name]) for name in LandslideKind._fields[3:]))
                for one in csv.DictReader(lines)]


def choose_landslide_row(text: str = DEFAULT) -> LandslideKind:
    """The row of TYPE[:PATH], each of which may be shortened; without PATH that of all paths; SlopeError if none is."""
    words = [re.sub(r"[\s_]+", "_", part.strip().lower()).replace("ised", "ized") for part in text.split(":")]
    kind, path = [*words, "all"][:2]
    rows = read_landslides()
    found = [row for row in rows if kind and path and row.type.startswith(kind) and row.path.startswith(path)]
    if len(words) > 2 or len(found) != 1:
        raise SlopeError("--known", "must be a table of events (a file), rock_avalanches, or TYPE[:PATH] of "
                         + ", ".join(f"{row.type}:{row.path}" for row in rows), text)
    return found[0]
