"""The runs of an ensemble: those of its design, those that are added towards longer ones, some with finer balls; and
what all of them say."""
import functools
from dataclasses import replace
from typing import Mapping, Optional

from ..ensembles import farther, sample
from ..runs import repeats
from ..tables import study_types
from . import farther_runs, results, size_runs, study
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

    def collect(todo, work):
        made = order
        if order.condition:
            made = replace(order, added=farther_runs.make_farther_runs(
                setup, order, fixed, repeats.chances_of(repeated, {**defaults, **fixed}), todo, work, of_deck))
        others = beside.planned.todo if beside and beside.planned else []
        at = size_runs.settle(setup, work, [one for one in (*others, *todo) if not one.error], wanted,
                              functools.partial(farther_runs.pick, setup, made, others))
        if beside:
            beside.at = at
        return results.collect_results(setup, questions._replace(
            order=made, settings=sample.settings_of(todo), sizes=at,
            notes=() if beside and beside.planned else at.warnings), todo, work)

    several = sample.settings_of(todo)
    return study.perform(setup, {**sample.all_values(several, plan), **repeated,
                                 **(of_deck.settings if of_deck else {})},
                         todo, collect, begin=lambda: sample.write_sample(setup.output, plan))
