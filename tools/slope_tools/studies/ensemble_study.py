"""The runs of an ensemble: those of its design, those that are added towards longer ones, some with finer balls; and
what all of them say."""
import functools
from dataclasses import replace
from typing import Dict, List, Mapping, Optional, Sequence

import numpy as np

from .. import kept
from ..case import run_folders
from ..ensembles import farther, known_events, sample
from ..ensembles.ensemble import Order
from ..runs import jobs, repeats
from ..tables import study_types
from ..tables.rows import Finished, Row, finished_of
from . import results, run_rows, size_runs, study
from .setup import Setup
from .site_study import Beside


def run_ensemble(setup: Setup, questions: results.Questions, fixed: Mapping[str, str], defaults: Mapping[str, str],
                 sizes: Optional[str], beside: Optional[Beside]) -> Optional[study_types.Study]:
    """Make or continue them; what study.yaml says, None of a dry run.

    questions: with an order, without settings; fixed: values of all runs; defaults: of the deck's variables; sizes: of
    --levels, of a deck that is none of a site; beside: of a site.
    """
    assert questions.order
    plan, repeated = questions.order.sample, questions.repeated
    todo = sample.plan_sample(setup.runs, plan, fixed, repeated, defaults)
    wanted, of_deck = beside.wanted if beside else None, None
    if setup.site is None:
        wanted = of_deck = size_runs.of_deck(sizes, setup.deck, len(todo), [*fixed, *plan.names, *repeated])
    todo = size_runs.at_first(setup, todo, of_deck)
    sample.check_growth(setup.output, plan)
    order = questions.order
    if order.condition:
        order = replace(order, added=farther.read_added_runs(setup.output, plan))

    def collect(todo: List[repeats.Repeat], work: jobs.Work) -> Optional[study_types.Study]:
        made = order
        if order.condition:
            made = replace(order, added=make_farther_runs(
                setup, order, fixed, repeats.chances_of(repeated, {**defaults, **fixed}), todo, work, of_deck))
        others = beside.planned.todo if beside and beside.planned else []
        at = size_runs.settle(setup, work, [one for one in (*others, *todo) if not one.error], wanted,
                              functools.partial(pick, setup, made, others))
        if beside:
            beside.at = at
        return results.collect_results(setup, questions._replace(
            order=made, settings=sample.settings_of(todo), sizes=at,
            notes=() if beside and beside.planned else at.warnings), todo, work)

    several = sample.settings_of(todo)
    return study.perform(setup, {**sample.all_values(several, plan), **repeated,
                                 **(of_deck.settings if of_deck else {})},
                         todo, collect, begin=lambda: sample.write_sample(setup.output, plan))


# --- towards longer runs ---

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
            first = [*first, *(known_events.find_runs_of_quantiles(runs) if mine[0].road else [])]
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
