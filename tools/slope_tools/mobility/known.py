"""Which known events a mass is compared with, and how far they went: those of a set where it covers the mass, else
landslides of all sizes, which have their angle of reach alone."""
from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence

import numpy as np

from ..errors import SlopeError
from ..survey.rasters import Raster
from . import body, events, exceedance, landslides, relation
from .body import Body
from .exceedance import CONFINED, Mobility
from .fall_path import FallPath
from .landslides import Row
from .relation import Relation


class Choice(NamedTuple):
    """file: set of events; known: those of it that count, none where a row was asked for; left_out: names; confined: a
    key of exceedance.CONFINED."""
    file: Path
    known: Sequence[events.Event]
    left_out: Sequence[str]
    row: Row
    confined: str

    @property
    def relation(self) -> Relation:
        return relation.of_events(self.known, self.file)

    @property
    def name(self) -> str:
        return self.file.name if self.known else f"{self.row.type}:{self.row.path}"

    @property
    def number(self) -> int:
        """Of events."""
        return len(self.known) or self.row.events


class Found(NamedTuple):
    """A mass among both; by_set: None where no set was asked for."""
    by_set: Optional[Mobility]
    by_row: Mobility

    @property
    def decides(self) -> Mobility:
        """The set where it covers the mass, else the landslides."""
        return self.by_set if self.by_set and self.by_set.in_range else self.by_row

    @property
    def each(self) -> List[Mobility]:
        return [one for one in self if one]


class Known(NamedTuple):
    """mobility: of a mass in a set, None and why (a sentence without its full stop) where it does not cover it."""
    mobility: Optional[Mobility]
    why: str


def choice(name: Optional[str] = None, left_out: Sequence[str] = (), confined: str = "unknown") -> Choice:
    """What --known, --except and --confined ask for; name: of our own set, a file of one, or a row; None: our own.

    Raises SlopeError for another name, and for a set that gives no relation.
    """
    path = events.OWN if name in (None, events.OWN.stem) else Path(str(name))
    if path != events.OWN and not path.suffix and not path.is_file():
        row = landslides.named(str(name))
        if left_out:
            raise SlopeError("--except", "must be an event of a set, of which --known names none", left_out[0])
        return Choice(path, [], [], row, confined)
    found = Choice(path, events.chosen(path, left_out), left_out, landslides.named(), confined)
    found.relation      # SlopeError
    return found


def of_body(mass: Body, asked: Choice, path: Optional[FallPath] = None) -> Found:
    """Both Mobilities of a body, on one fall path; path: another than the steepest descent."""
    law = asked.relation if asked.known else None
    path = path or exceedance.path_of(mass, [law, asked.row] if law else [asked.row])
    return Found(law and exceedance.of_body(mass, law, CONFINED[asked.confined], path),
                 exceedance.of_body(mass, asked.row, path=path))


def one_of_body(mass: Body, asked: Choice) -> Mobility:
    """The Mobility of a body among what was asked for alone."""
    if not asked.known:
        return exceedance.of_body(mass, asked.row)
    return exceedance.of_body(mass, asked.relation, CONFINED[asked.confined])


def of_mass(raster: Raster, before: np.ndarray, depth: np.ndarray, volume: float, confined: str = "unknown") -> Known:
    """A mass of a volume (m3) among the events of our own set.

    raster: the grid; before: the ground with the body, m; depth: of the body, m, 0 beside it.
    """
    asked = choice(confined=confined)
    low, high = asked.relation.volumes
    volume /= 1e6
    if not low <= volume <= high:
        return Known(None, f"No set of known events covers a volume of {volume:.3g} million m3; ours are of {low:g} to "
                           f"{high:g}. How far it runs rests on the parameters alone")
    try:
        found = one_of_body(body.of_arrays(raster._replace(z=before), depth, "the run"), asked)
    except SlopeError as error:
        return Known(None, f"The runs cannot be compared with known events: {error}")
    if not found.in_range:
        return Known(None, "; ".join(f"{line[0].upper()}{line[1:]}" for line in found.outside)
                     + ". How far the mass runs rests on the parameters alone")
    return Known(found, "")
