"""Making the runs that an ensemble adds towards longer ones (farther), batch by batch."""
import functools
from typing import Dict, List, Mapping, Optional, Sequence

import numpy as np

from .. import kept
from ..case import run_folders
from ..ensembles import farther, known_events
from ..ensembles.ensemble import Order
from ..runs import jobs, repeats
from ..tables.rows import Finished, Row, finished_of
from . import run_rows, size_runs
from .setup import Setup


def make_farther_runs(setup: Setup, order: Order, fixed: Mapping[str, str], chances: Sequence[Dict[str, str]],
                      todo: List[repeats.Repeat], work: jobs.Work,
                      wanted: Optional[size_runs.Wanted] = None) -> farther.Added:
    """Add runs to todo, which were made, until they reach far enough or farther.next_runs has no more; all that were
    added, and why no more.

    fixed, chances: of all runs, see sample.plan_sample; wanted: their coarsest balls.
    """
    added, rows = order.added, read_farther_rows(setup, todo)
    assert added and order.condition
    for k, one in enumerate(added.batches, 1):
        rows += batch(setup, order, fixed, chances, todo, work, one, k, wanted)
    while finished := finished_of(rows):
        summary = run_folders.summary_of(setup.output, finished[0].summary)
        found = known_events.mobility_of(order.condition, summary.parent, summary)
        runs = known_events.Runs(order.sample, added.batches, rows, found)
        if not known_events.weighs(found, runs):
            break
        end = farther.End(found.end(float(runs.lengths.max())), found.beyond_path())
        more = farther.next_runs(added, runs.places, runs.lengths, runs.beyond, end,
                                 functools.partial(longer, setup, order, runs))
        if len(more.batches) == len(added.batches):
            return more
        added = more
        setup.tell(added.line(added.batches[-1], runs.lengths, runs.beyond))
        farther.write_added_runs(setup.output, added)
        rows += batch(setup, order, fixed, chances, todo, work, added.batches[-1], len(added.batches), wanted)
    return added


def pick(setup: Setup, order: Order, others: Sequence[repeats.Repeat], rows: Sequence[Finished]) -> size_runs.Pick:
    """The points with finer balls of an ensemble, and of a study beside it (others), by their rows."""
    names = {one.name for one in others}
    beside, mine = ([row for row in rows if (row.run in names) == of] for of in (True, False))
    first = size_runs.pick_largest(beside).first
    if order.condition and order.added and any(row.length_m is not None for row in mine):
        summary = run_folders.summary_of(setup.output, mine[0].summary)
        found = known_events.mobility_of(order.condition, summary.parent, summary)
        runs = known_events.Runs(order.sample, order.added.batches, mine, found)
        if known_events.weighs(found, runs):
            first = [*first, *(known_events.resting(runs) if mine[0].road else [])]
            return size_runs.Pick(first, np.asarray(found.exceedance(size_runs.lengths_of(rows)), float))
    return size_runs.pick_largest(rows)._replace(first=[*first, *size_runs.pick_largest(mine).first])


def longer(setup: Setup, order: Order, runs: known_events.Runs) -> farther.Longer:
    """farther.longer(), kept with the study."""
    return farther.Longer(**kept.value(
        setup.output / ".longer.json", [runs.places, runs.lengths, order.sample.about],
        lambda: farther.longer(runs.places, runs.lengths, order.sample)._asdict()))


def batch(setup: Setup, order: Order, fixed: Mapping[str, str], chances: Sequence[Dict[str, str]],
          todo: List[repeats.Repeat], work: jobs.Work, which: farther.Batch, k: int,
          wanted: Optional[size_runs.Wanted] = None) -> List[Row]:
    """Make the runs of the k-th batch and add them to todo; their rows."""
    more = repeats.with_repeats(setup.runs, [{**fixed, **one} for one in which.points], chances, order.sample.names)
    for one in more:
        one.batch = k
    more = size_runs.at_first(setup, more, wanted)
    work.store.admit(more)
    work.do(more)
    todo += more
    return read_farther_rows(setup, more)


def read_farther_rows(setup: Setup, todo: Sequence[repeats.Repeat]) -> List[Row]:
    """The runs' rows of study.csv, without the road."""
    return run_rows.read_run_rows(setup._replace(road=None), todo)
