"""What is ahead of the study of a site: which of its runs are there, how many are to be made, how long they take."""
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from .. import disk
from ..case.data_files import data_files
from ..ensembles import farther, known_study, sample
from ..runs import dependencies, jobs, repeats, store
from ..sites import site_budget, site_choices
from ..sites.site_budget import Soil
from ..sites.site_choices import Site
from ..statistics import designs
from . import fine_runs, site_study, study
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


def of_site(site: Site, engine: Setup, points: int, asked: Optional[str] = None) -> Ahead:
    """Of the study that site.yaml describes; points: of the ensemble, 0: the paper's study alone; asked: of --fine.

    SlopeError on bad input, and if a run is there with other data and engine.anew does not ask for it again.
    """
    planned = site_study.plan(site, engine, asked)
    setup = planned.setup
    files = data_files(setup.deck, {**planned.settings, **planned.repeated})
    depends = dependencies.Dependencies(setup.deck, {name: disk.sha256(path) for name, path in files.items()},
                                        study.program_of(setup))
    runs = store.Store(setup.runs, depends, setup.older, setup.anew)
    runs.admit(planned.runs)
    once = store.once(planned.runs)
    wanted = [one for one in once if not one.finished]
    there, more, fine = len(once) - len(wanted), 0, 0
    design: List[repeats.Repeat] = []
    factor = fine_runs.factor_of(asked, planned.choices.study.finer)
    if points:
        todo, more = points_of(planned, points)
        runs.admit(todo)
        once = store.once(todo)
        design = [one for one in once if not one.finished]
        there += len(once) - len(design)
        if factor > 1:
            fine = int(bool(design) or not any(fine_of(setup, runs, factor, todo, planned.variables)))
            there += 1 - fine
    new = len(wanted) + len(design) + fine
    half, fines = (sum(one in several for one in wanted) for several in (planned.half, planned.fine))
    parts = [(1.0, len(wanted) - half - fines)]
    if fines + fine:
        parts.append((1 / factor, fines + fine))
    known = new and setup.engine == "local"
    return Ahead(there, new, seconds(site, planned, parts, half > 0, len(design)) if known else None, more)


def points_of(planned: site_study.Planned, points: int):
    """The runs of the ensemble that is weighted by known events, with those that were added; how many more may be."""
    chance = site_choices.chance(planned.variables)
    vary = [*known_study.VARY, chance]
    fixed = site_choices.not_varied(planned.choices, {words.partition("=")[0] for words in vary})
    asked = f"{(planned.setup.site or Path()) / site_choices.NAME}: study.points"
    plan = sample.check(points, designs.SOBOL, SEED, vary, planned.setup.deck, fixed, {}, asked)
    plan = plan.widened(known_study.WIDE)
    todo = sample.plan(planned.setup.runs, plan, fixed, {}, planned.variables)
    added = farther.read(planned.setup.output.parent / site_study.ENSEMBLE, plan)
    for batch in added.batches:
        todo += repeats.with_repeats(planned.setup.runs, [{**fixed, **one} for one in batch.points], (), plan.names)
    return todo, int(farther.MOST * points) - added.number


def fine_of(setup: Setup, runs: store.Store, factor: int, todo: Sequence[repeats.Repeat], variables: Dict[str, str]):
    """Whether there is a fine run at the values of each run of the ensemble."""
    for one in todo:
        found = fine_runs.smaller(setup.runs, one.combination, factor, variables[fine_runs.VARIABLE])
        runs.admit(found)
        yield found[0].finished


def seconds(site: Site, planned: site_study.Planned, parts: List[Tuple[float, int]], half: bool,
            points: int) -> Optional[float]:
    """What runs take on this machine; parts, half, points: as of site_budget.Plan."""
    found = site.found
    if found.trial is None or found.body is None:
        return None
    d, density, thick, speed = (float(planned.variables[name]) for name in ("d", "density", "thick", "speed"))
    setup, spacing = planned.setup, site.choices.model.spacing
    closest = min([spacing, *(zone.values.get("spacing", spacing) for zone in found.zones)])
    wanted = site_budget.plan(planned.choices)._replace(parts=parts, half_step=half, points=points)
    soil = Soil(density, thick, speed, closest)
    return site_budget.study_seconds(d, found.body.volume, found.trial, soil, wanted,
                                     setup.jobs or max(1, jobs.cores() // setup.ranks))[0]
