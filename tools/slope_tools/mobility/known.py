"""Which known events a mass is compared with, and how far they went: those of a set where it covers the mass, else
landslides of all sizes, which have their angle of reach alone."""
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np

from ..errors import SlopeError
from ..survey.rasters import Raster
from . import body, events, exceedance, landslides, relation
from .body import Body
from .exceedance import CONFINED, Mobility
from .fall_path import FallPath
from .landslides import LandslideKind
from .relation import Relation


class Choice(NamedTuple):
    """file: set of events; known: those of it that count, none where a row was asked for; left_out: names; confined: a
    key of exceedance.CONFINED; given: the name that was asked for, None: our own set."""
    file: Path
    known: Sequence[events.Event]
    left_out: Sequence[str]
    row: LandslideKind
    confined: str
    given: Optional[str] = None

    @property
    def relation(self) -> Relation:
        return relation.of_events(self.known, self.file)

    def name(self, mobility: Mobility) -> str:
        """Of the events of one of both."""
        return f"{self.row.type}:{self.row.path}" if isinstance(mobility.law, LandslideKind) else self.file.name

    def number(self, mobility: Mobility) -> int:
        """Of these events."""
        return self.row.events if isinstance(mobility.law, LandslideKind) else len(self.known)

    def about(self) -> Dict[str, Any]:
        """What is kept of it, for of_about()."""
        return {"set": self.given, "left_out": list(self.left_out), "confined": self.confined}


class Found(NamedTuple):
    """A mass among both; by_set: None where no set was asked for."""
    by_set: Optional[Mobility]
    by_row: Mobility

    @property
    def decides(self) -> Mobility:
        """The set where it covers the mass, else the landslides."""
        return self.by_set if self.by_set and self.by_set.in_range else self.by_row

    @property
    def strict(self) -> Optional[Mobility]:
        """What the runs of a study must reach: a set that covers the mass, or a row that was asked for; None: neither.

        Landslides that stand for a set that does not cover the mass are shown, and withhold nothing.
        """
        return self.by_row if self.by_set is None else self.by_set if self.by_set.in_range else None

    @property
    def each(self) -> List[Mobility]:
        return [one for one in self if one]


class Known(NamedTuple):
    """found: of a mass, None and why (a sentence without its full stop) where it has no fall path."""
    found: Optional[Found]
    why: str


def choice(name: Optional[str] = None, left_out: Sequence[str] = (), confined: str = "unknown") -> Choice:
    """What --known, --except and --confined ask for; name: of our own set, a file of one, or a row; None: our own.

    Raises SlopeError for another name, and for a set that gives no relation.
    """
    path = events.OWN if name in (None, events.OWN.stem) else Path(str(name))
    if path != events.OWN and not path.suffix and not path.is_file():
        row = landslides.choose_landslide_row(str(name))
        if left_out:
            raise SlopeError("--except", "must be an event of a set, of which --known names none", left_out[0])
        return Choice(path, [], [], row, confined, name)
    found = Choice(path, events.select_events(path, left_out), left_out, landslides.choose_landslide_row(), confined,
                   name)
    found.relation      # SlopeError
    return found


def compute_known_mobility(mass: Body, asked: Choice, path: Optional[FallPath] = None) -> Found:
    """Both Mobilities of a body, on one fall path; path: another than the steepest descent."""
    law = asked.relation if asked.known else None
    path = path or exceedance.path_of(mass, [law, asked.row] if law else [asked.row])
    return Found(law and exceedance.compute_mobility(mass, law, CONFINED[asked.confined], path),
                 exceedance.compute_mobility(mass, asked.row, path=path))


def of_about(kept_choice: Mapping[str, Any]) -> Choice:
    """The Choice of what was kept of one; SlopeError where its file is gone."""
    return choice(kept_choice.get("set"), kept_choice.get("left_out") or (), kept_choice.get("confined", "unknown"))


def of_mass(raster: Raster, before: np.ndarray, depth: np.ndarray, kept_choice: Mapping[str, Any],
            site: Optional[Path] = None) -> Known:
    """A mass among the known events of what was kept of a Choice.

    raster: the grid; before: the ground with the body, m; depth: of the body, m, 0 beside it; site: whose body it is,
    which is finer than what a run's grid has of it, and the same for all.
    """
    try:
        mass = body.read_mobility_body(site) if site else body.of_arrays(raster._replace(z=before), depth, "the run")
        return Known(compute_known_mobility(mass, of_about(kept_choice)), "")
    except SlopeError as error:
        return Known(None, f"The runs cannot be compared with known events: {error}")
