"""The fine run of a study, whose balls are smaller: at the values in the middle, or those of a run of median length.

What it says of the size of the balls: tables/fine_run.
"""
import statistics
from typing import List, Mapping, Optional, Sequence

from ..case.settings import as_number, middle
from ..errors import SlopeError
from ..runs import repeats
from ..runs.repeats import Repeat
from ..tables.fine_run import VARIABLE
from ..tables.rows import finished_of
from .run_rows import rows_of
from .setup import Setup

OPTION = "--fine"


def smaller(runs, combination: Mapping[str, str], factor: int, diameter: str) -> List[Repeat]:
    """A run with these values of the deck's variables and balls so many times smaller than of this diameter (m)."""
    size = as_number(diameter)
    if not (isinstance(size, float) and size > 0):
        raise SlopeError(OPTION, f"must be of a deck whose variable {VARIABLE} is the diameter of the balls", diameter)
    return repeats.with_repeats(runs, [{**combination, VARIABLE: f"{size / factor:.10g}"}], (), (VARIABLE,))


def in_the_middle(setup: Setup, factor: int, settings: Mapping[str, Sequence[str]],
                  defaults: Mapping[str, str]) -> List[Repeat]:
    """At the middle of the values of each variable, or none; defaults: of the deck's index variables."""
    if factor == 1:
        return []
    values = {name: middle(several) for name, several in settings.items()}
    known = {**defaults, **values}
    if VARIABLE not in known:
        raise SlopeError(OPTION, f"must be of a deck whose variable {VARIABLE} is the diameter of the balls",
                         setup.deck)
    return smaller(setup.runs, values, factor, known[VARIABLE])


def of_median_length(setup: Setup, factor: int, todo: Sequence[Repeat], defaults: Mapping[str, str]) -> List[Repeat]:
    """At the values of the run whose length is nearest to the median of those that finished, or none."""
    if factor == 1:
        return []
    first = [one for one in todo if not one.batch and not one.repeat and not one.error]
    rows = finished_of(rows_of(setup._replace(road=None), first))
    lengths = {row.run: row.length_m for row in rows if row.length_m is not None}
    if not lengths:
        return []
    median = statistics.median(lengths.values())
    nearest = min((one for one in first if one.name in lengths), key=lambda one: abs(lengths[one.name] - median))
    known = {**defaults, **nearest.combination}
    return smaller(setup.runs, nearest.combination, factor, known.get(VARIABLE, "none"))


def factor_of(asked: Optional[str], of_site: int = 1) -> int:
    """How many times smaller its balls are: what the option asks for, else what site.yaml says; 1: there is none."""
    return of_site if asked is None else 1 if asked == "no" else int(asked)
