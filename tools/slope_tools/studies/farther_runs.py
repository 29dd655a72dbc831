"""Making the runs that an ensemble adds towards longer ones (farther), batch by batch."""
from typing import Dict, List, Mapping, Sequence

from ..case import run_folders
from ..ensembles import farther, known_events
from ..ensembles.ensemble import Order
from ..runs import jobs, repeats
from ..tables.rows import Row, finished_of
from . import run_rows
from .setup import Setup


def make(setup: Setup, order: Order, fixed: Mapping[str, str], chances: Sequence[Dict[str, str]],
         todo: List[repeats.Repeat], work: jobs.Work, beside: Sequence[repeats.Repeat] = ()) -> None:
    """Add runs to todo, which were made, until they reach far enough or Added.propose has no more.

    fixed, chances: of all runs, see sample.plan; beside: runs that are made with the first ones added.
    """
    added, rows = order.added, rows_of(setup, todo)
    assert added and order.condition
    for k in range(len(added.batches)):
        rows += batch(setup, order, fixed, chances, todo, work, k, beside)
    while True:
        finished = finished_of(rows)
        if not finished:
            return
        summary = run_folders.summary_of(setup.output, finished[0].summary)
        found = known_events.mobility_of(order.condition, summary.parent, summary)
        runs = known_events.Runs(order.sample, added.batches, rows, found)
        if found.outside or len(runs.rows) < 2:
            return
        end = farther.End(found.end(float(runs.lengths.max())), found.beyond_path())
        new = added.propose(runs.places, runs.lengths, runs.beyond, end)
        if new is None:
            return
        setup.tell(added.line(new, runs.lengths, runs.beyond))
        added.keep()
        rows += batch(setup, order, fixed, chances, todo, work, len(added.batches) - 1, beside)


def batch(setup: Setup, order: Order, fixed: Mapping[str, str], chances: Sequence[Dict[str, str]],
          todo: List[repeats.Repeat], work: jobs.Work, k: int,
          beside: Sequence[repeats.Repeat] = ()) -> List[Row]:
    """Make the runs of a batch and add them to todo; their rows."""
    assert order.added
    more = repeats.with_repeats(setup.runs, [{**fixed, **one} for one in order.added.batches[k].points], chances,
                                order.sample.names)
    for one in more:
        one.batch = k + 1
    work.store.admit(more)
    work.do([*beside, *more])
    todo += more
    return rows_of(setup, more)


def rows_of(setup: Setup, todo: Sequence[repeats.Repeat]) -> List[Row]:
    """The runs' rows of study.csv, without the road."""
    return run_rows.rows_of(setup._replace(road=None), todo)
