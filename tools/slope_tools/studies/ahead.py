"""What is ahead of the study of a site: which of its runs are there, how many are to be made, how long they take."""
from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence

from .. import disk
from ..case.data_files import data_files
from ..ensembles import farther, known_study, sample
from ..runs import dependencies, repeats, store
from ..sites import site_budget, site_choices
from ..sites.site_choices import Site
from ..statistics import designs
from ..tables.sizes import VARIABLE
from . import site_study, size_runs, study
from .setup import Setup

SEED = 1        # of the design, as of `slope study --seed`


class Ahead(NamedTuple):
    """Runs that are there and are to be made."""
    there: int
    new: int
    seconds: Optional[float]    # of those to be made; None: unknown
    more: int                   # runs that may be added

    @property
    def text(self) -> str:
        """In words."""
        total = self.there + self.new
        said = f"{self.there} of {total} runs are there"
        if self.new:
            said += f", {self.new} to make"
            if self.seconds is not None:
                said += f", {site_budget.duration_text(self.seconds)}"
        return said + (f"; up to {self.more} more where known events go farther" if self.more else "")


def look_ahead(site: Site, engine: Setup, points: int, asked: site_study.Asked = site_study.Asked()) -> Ahead:
    """Of the study that site.yaml describes; points: of the ensemble, 0: the sweep alone.

    SlopeError on bad input, and if a run is there with other data and engine.anew does not ask for it again.
    """
    planned = site_study.plan_site_study(site, engine)
    setup, runs = planned.setup, known_runs(planned)
    runs.admit(planned.runs)
    once = store.select_distinct_runs(planned.runs)
    wanted = [one for one in once if not one.finished]
    there, more = len(once) - len(wanted), 0
    design: List[repeats.Repeat] = []
    points_at = [*planned.todo]
    if points:
        todo, more = plan_weighted_points(planned, points)
        runs.admit(todo)
        once = store.select_distinct_runs(todo)
        design = [one for one in once if not one.finished]
        there += len(once) - len(design)
        points_at += todo
    finer = site_study.wanted(site, planned, asked, points)
    made = [sum(size_runs.SizeRun(setup.runs, one, value).made(runs) for one in points_at)
            for value in finer.values[1:]]
    numbers = [max(0, number - done) for number, done in zip(finer.points, made)]
    there += sum(min(number, done) for number, done in zip(finer.points, made))
    new = len(wanted) + len(design) + sum(numbers)
    half = sum(one in planned.half for one in wanted)
    known = new and setup.engine == "local"
    return Ahead(there, new, seconds(site, planned, len(wanted) - half, half > 0, len(design), numbers)
                 if known else None, more)


def known_runs(planned: site_study.Planned) -> store.Store:
    """Which runs of a site's study are there."""
    setup = planned.setup
    files = data_files(setup.deck, {**planned.settings, **planned.repeated})
    depends = dependencies.Dependencies(setup.deck, {name: disk.sha256(path) for name, path in files.items()},
                                        study.program_of(setup))
    return store.Store(setup.runs, depends, setup.older, setup.anew)


def choose_points(site: Site, engine: Setup, asked: site_study.Asked = site_study.Asked()) -> int:
    """Of the ensemble of a site: as many of those of site.yaml as time allows, and as are there already."""
    fit, points = site_study.points_of(site, engine, asked), site.choices.study.points
    if fit < points:
        planned = site_study.plan_site_study(site, engine)
        todo, _ = plan_weighted_points(planned, points)
        known_runs(planned).admit(todo)
        while points > fit and not all(one.finished for one in todo[:points]):
            points //= 2        # the first half of a sequence is a design of its own
    return points


def plan_weighted_points(planned: site_study.Planned, points: int):
    """The runs of the ensemble that is weighted by known events, with those that were added; how many more may be."""
    vary = [*known_study.VARY, site_choices.CHANCE]
    fixed = site_choices.not_varied(planned.choices, {words.partition("=")[0] for words in vary})
    asked = f"{(planned.setup.site or Path()) / site_choices.NAME}: study.points"
    plan = sample.check_sample(points, designs.SOBOL, SEED, vary, planned.setup.deck, fixed, {}, asked)
    plan = plan.widened(known_study.WIDE)
    todo = sample.plan_sample(planned.setup.runs, plan, fixed, {}, planned.variables)
    added = farther.read_added_runs(planned.setup.output.parent / site_study.ENSEMBLE, plan)
    for batch in added.batches:
        todo += repeats.with_repeats(planned.setup.runs, [{**fixed, **one} for one in batch.points], (), plan.names)
    return todo, int(farther.MOST * points) - added.number


def seconds(site: Site, planned: site_study.Planned, sweep: int, half: bool, points: int,
            numbers: Sequence[int]) -> Optional[float]:
    """What runs take on this machine; sweep, half, points: as of site_budget.Plan; numbers: with finer balls."""
    found = site.found
    if found.trial is None or found.body is None:
        return None
    wanted = site_budget.plan_budget(planned.choices)._replace(sweep=sweep, elastic=0, half_step=half, points=points)
    return site_budget.study_seconds(float(planned.variables[VARIABLE]), found.body.volume, found.trial,
                                     site_study.soil_of(site, planned), wanted, site_study.jobs_of(planned.setup),
                                     numbers)[0]
