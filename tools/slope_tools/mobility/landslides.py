"""How far landslides of all sizes ran for their volume and fall: log10(H / L) = a + b log10 V, H and L in m, V in m3.

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
from typing import List, NamedTuple, Tuple

import numpy as np
from scipy import special

from ..errors import SlopeError

OWN = Path(__file__).parent / "landslides.csv"
SIDE = 1.645            # deviations, that 95 % of a normal distribution lie above
SPREAD = 2.0            # assumed standard deviation of log10 V in a row
DEFAULT = "translational_slides"
NOT_OF_ROADS = "they are of natural slopes, not of cuts and embankments of roads"


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
    with open(OWN, encoding="ascii", newline="") as lines:
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
