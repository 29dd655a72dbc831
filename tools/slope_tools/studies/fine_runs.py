"""The fine run of a study, whose balls are smaller: at the values in the middle, or those of a run of median length.

What it says of the size of the balls: tables/fine_run.
"""
import statistics
from typing import Any, Dict, List, Mapping, Optional, Sequence

from ..case import run_folders
from ..case.settings import as_number
from ..errors import SlopeError
from ..runs import repeats
from ..runs.repeats import Repeat
from ..statistics import headline
from ..tables.combinations import Group
from ..tables.fine_run import VARIABLE, Fine
from ..tables.study_maps import Maps
from . import results
from .setup import Setup

OPTION = "--fine"
NONE = ("no", False, None)      # no fine run


def smaller(runs, combination: Mapping[str, str], factor: int, diameter: str) -> List[Repeat]:
    """A run with these values of the deck's variables and balls so many times smaller than of this diameter (m)."""
    size = as_number(diameter)
    if not (isinstance(size, float) and size > 0):
        raise SlopeError(OPTION, f"must be of a deck whose variable {VARIABLE} is the diameter of the balls", diameter)
    return repeats.with_repeats(runs, [{**combination, VARIABLE: f"{size / factor:.10g}"}], (), (VARIABLE,))


def in_the_middle(setup: Setup, factor: Any, settings: Mapping[str, Sequence[str]],
                  defaults: Mapping[str, str]) -> List[Repeat]:
    """At the middle of the values of each variable, or none; defaults: of the deck's index variables."""
    if factor in NONE:
        return []
    middle = {name: several[len(several) // 2] for name, several in settings.items()}
    known = {**defaults, **middle}
    if VARIABLE not in known:
        raise SlopeError(OPTION, f"must be of a deck whose variable {VARIABLE} is the diameter of the balls",
                         setup.deck)
    return smaller(setup.runs, middle, int(factor), known[VARIABLE])


def of_median_length(setup: Setup, factor: Any, todo: Sequence[Repeat], defaults: Mapping[str, str]) -> List[Repeat]:
    """At the values of the run whose length is nearest to the median of those that finished, or none."""
    if factor in NONE:
        return []
    first = [one for one in todo if not one.batch and not one.repeat and not one.error]
    rows, _ = results.rows_of(setup._replace(road=None), first, Maps(()), pictures=False)
    lengths = {row["run"]: row["length_m"] for row in rows if row.get("length_m") is not None}
    if not lengths:
        return []
    median = statistics.median(lengths.values())
    nearest = min((one for one in first if one.name in lengths), key=lambda one: abs(lengths[one.name] - median))
    known = {**defaults, **nearest.combination}
    return smaller(setup.runs, nearest.combination, int(factor), known.get(VARIABLE, "none"))


def compared(setup: Setup, fine: Repeat, rows: Sequence[Mapping[str, Any]], groups: Optional[Sequence[Group]]) -> Fine:
    """The fine run beside the rows with the same values; groups: of a study with repeats, None of an ensemble."""
    if fine.error:
        return Fine(None, (), 0.0, lambda key: None, f"{fine.name}: {fine.error}")
    [row], _ = results.rows_of(setup, [fine], Maps(()), pictures=False)
    coarse = [one for one in rows if one["status"] == "finished"
              and all(row["variables"][name] == one["variables"][name] for name in one["set"] if name != VARIABLE)]
    same = next((group for group in groups or () if coarse and group.set == coarse[0]["set"]), None)
    coarse = same.rows if same else [one for one in coarse if not one["repeat"]]

    def scatter(key: str) -> Optional[headline.Scatter]:
        if same is None:
            return None
        parts = [group.of(key) for group in groups or ()]
        mine = parts[(groups or ()).index(same)]
        return headline.scatter_of(parts, mine) if mine.mean > 0 else headline.pooled(parts)

    return Fine(row, coarse, depth_of(setup, coarse[0]) if coarse else 0.0, scatter)


def depth_of(setup: Setup, row: Mapping[str, Any]) -> float:
    """Mean thickness (m) of the body that a run released: its volume over its area in plan."""
    arrival = run_folders.load_raster(run_folders.prefix_of(run_folders.summary_of(setup.output, row)), "arrival")
    area = results.body_of(arrival.z == 0, arrival, row["ball_m3"]).sum() * arrival.transform.a ** 2
    return row["released_m3"] / float(area)


def factor_of(asked: Optional[str], choices: Optional[Dict[str, Any]] = None) -> Any:
    """How many times smaller its balls are: what the option asks for, else what site.yaml says, else no."""
    if asked is not None:
        return asked if asked == "no" else int(asked)
    return choices["study"]["fine"] if choices else "no"
