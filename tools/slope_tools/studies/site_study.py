"""The standard study of a site: rolling resistances, repeats, half the step, finer balls, the mapped deposit.

Order of the work: plan all runs, make them (study), then those with finer balls (size_runs), the study of all at the
finest size (results), the score of the run that the answer rests on. The same call resumes it.
"""
import contextlib
import re
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path
from shlex import quote
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence

from .. import disk, schemas
from ..case import decks, run_folders
from ..case.settings import middle as middle_of
from ..deposits import road_axis
from ..errors import SlopeError
from ..findings import Finding, finding
from ..runs import jobs, repeats
from ..schemas import FINDINGS
from ..sites import site_budget, site_choices, site_deck, site_folder, site_roads, site_warnings
from ..sites.site_choices import Folder, Site
from ..sites.site_layers import OBSERVED
from ..sites.site_sections import PACKING, Choices, OfMass
from ..survey import rasters, roads
from ..tables import elastic, named_run, sizes, study_types
from ..tables.rows import Failed, finished_of
from ..tables.sizes import VARIABLE
from ..tables.step_check import SUFFIX, Step, half_of, read_energies
from . import mapped, results, size_runs, study
from .run_rows import read_run_rows
from .setup import Road, Setup

# folders in the site's
STUDY, SCORE, ENSEMBLE = "study", "score", "ensemble"
LEDGER = "ledger"       # a deck's variable
THRESHOLDS = (0.1, 0.5, 1.0)        # m, of the maps of exceedance


def format_deck_values(numbers: Iterable[float]) -> List[str]:
    """Numbers as values of a deck's variable."""
    return [f"{value:.10g}" for value in numbers]


class Asked(NamedTuple):
    """Of the options of the command: sizes of balls, and the time of the study; None: as site.yaml says."""
    levels: Optional[int] = None
    minutes: Optional[float] = None


def parse_asked(levels: Optional[str], minutes: Optional[float]) -> Asked:
    """Of the words of options; SlopeError if they are none."""
    if levels is not None and not re.fullmatch(f"[1-{site_budget.MOST_SIZES}]", levels):
        raise SlopeError(size_runs.OPTION, f"must be 1 to {site_budget.MOST_SIZES} for a site, how many sizes of balls",
                         levels)
    if minutes is not None and minutes <= 0:
        raise SlopeError("--minutes", "must be > 0", f"{minutes:g}")
    return Asked(int(levels) if levels else None, minutes)


class Done(NamedTuple):
    """What was made."""
    study: Optional[Path]                   # its folder, None of a dry run
    about: Optional[study_types.Study]
    failed: Optional[Exception]             # what failed beside it, to be raised once the report is there


class Planned(NamedTuple):
    """The runs of the sweep."""
    choices: OfMass
    setup: Setup
    variables: Dict[str, str]               # of the deck
    settings: Dict[str, List[str]]
    repeated: Dict[str, List[str]]
    middle: str                             # rolling resistance of half the step
    todo: List[repeats.Repeat]
    half: List[repeats.Repeat]
    elastics: List[repeats.Repeat]          # with the largest restitution

    @property
    def runs(self) -> List[repeats.Repeat]:
        return [*self.todo, *self.half, *self.elastics]


@dataclass
class Beside:
    """Of an ensemble of a site: its runs with finer balls, and the sweep beside it, whose runs share them."""
    planned: Optional[Planned]
    wanted: size_runs.Wanted
    at: Optional[size_runs.AtFinest] = None     # once the ensemble has made them

    @property
    def found(self) -> size_runs.AtFinest:
        assert self.at
        return self.at


def plan_site_study(site: Site, engine: Setup) -> Planned:
    """All runs of the sweep of a site, but for those with finer balls."""
    folder, choices = site.folder, site.choices
    deck, road, several = folder / site_deck.NAME, choices.road, choices.study
    setup = engine._replace(deck=deck, output=site_roads.results(site) / STUDY, site=folder, road=None)
    if road.file:
        setup = setup._replace(road=Road(site_roads.file_of(site), road.cut_angle, road.mesh, asked=road.asked,
                                         name=site.road))
    settings, variables = {"rolling": format_deck_values(several.rolling)}, decks.index_variables(deck)
    repeated = {PACKING: format_deck_values(several.packing)} if several.packing else {}
    middle = middle_of(settings["rolling"])
    others = grounds(choices)
    if others:
        settings["spacing"] = [variables["spacing"]]
    todo = repeats.plan_repeats(setup.runs, settings, repeated, variables, others)
    if others:
        settings["spacing"] = list(dict.fromkeys([*settings["spacing"], *(one["spacing"] for one in others)]))
    half = repeats.plan_repeats(setup.runs, {"rolling": [middle], "step": [half_of(variables)], LEDGER: ["1"]}, {},
                                variables) if setup.road else []
    elastics = elastic_runs(setup, several.largest_restitution, settings["rolling"], repeated, variables)
    return Planned(choices, setup, variables, settings, repeated, middle, todo, half, elastics)


def wanted(site: Site, planned: Planned, asked: Asked, points=0, alone=False) -> size_runs.Wanted:
    """The runs with finer balls; points: of the ensemble beside, or, alone, of one without a sweep."""
    site_found, levels = site.found, asked.levels or planned.choices.study.levels
    plan_ = site_budget.plan_budget(planned.choices)._replace(points=points)
    if alone:
        plan_ = plan_._replace(sweep=0, elastic=0, half_step=False)
    time = None
    if site_found.body and site_found.trial:
        time = site_budget.time_of(float(planned.variables[VARIABLE]), site_found.body.volume, site_found.trial,
                                   soil_of(site, planned), plan_, jobs_of(planned.setup), minutes_of(site, asked))
    numbers = site_budget.finer(plan_.sweep + plan_.points, time, levels)
    return size_runs.halved(planned.variables[VARIABLE], numbers, time, more=levels is None)


def minutes_of(site: Site, asked: Asked) -> Optional[float]:
    """That a study may take; None: not given."""
    return asked.minutes or site.choices.balls.minutes


def points_of(site: Site, engine: Setup, asked: Asked = Asked()) -> int:
    """Of the ensemble of a site: those of site.yaml, or as many of them as time allows."""
    planned, found = plan_site_study(site, engine), site.found
    volume, trial = (found.body.volume, found.trial) if found.body else (0.0, None)
    return site_budget.fit_points(float(planned.variables[VARIABLE]), volume, trial, soil_of(site, planned),
                                  site_budget.plan_budget(site.choices), jobs_of(planned.setup),
                                  minutes_of(site, asked)).points


def soil_of(site: Site, planned: Planned) -> site_budget.Soil:
    """What the step of a site's deck depends on."""
    density, thick, speed = (float(planned.variables[name]) for name in ("density", "thick", "speed"))
    spacing = site.choices.model.spacing
    return site_budget.Soil(density, thick, speed, min(
        [spacing, *(zone.values.get("spacing", spacing) for zone in site.found.zones)]))


def jobs_of(setup: Setup) -> int:
    """Runs at a time."""
    return setup.jobs or max(1, jobs.cores() // setup.ranks)


def make_site_runs(planned: Planned) -> None:
    """Make or continue the runs of a site with the coarsest balls; what failed is known by them."""
    with contextlib.suppress(study.RunsFailed):     # collect_site_results() says so
        study.perform(planned.setup, {**planned.settings, **planned.repeated}, planned.runs, lambda *_: None,
                      first=planned.half)


def run_site_study(site: Site, engine: Setup, method: str, asked: Asked,
                   roads: Sequence[Mapping[str, Any]] = ()) -> Done:
    """Make or continue the sweep of a site, and its results.

    engine: how the runs are made; its deck, output and road do not count; method: of the study, in words; roads: of
    Questions. Raises SlopeError on bad input, and if no run of the study finished.
    """
    planned = plan_site_study(site, engine)

    def finer(work: jobs.Work) -> size_runs.AtFinest:
        return size_runs.settle(planned.setup, work, [one for one in planned.todo if not one.error],
                                wanted(site, planned, asked))

    return collect_site_results(site, planned, method, finer, roads)


def collect_site_results(site: Site, planned: Planned, method: str, finer: Callable[[jobs.Work], size_runs.AtFinest],
                         roads: Sequence[Mapping[str, Any]] = (), alone: bool = True, made: bool = False) -> Done:
    """The results of the runs of a site, which are made first, unless make_site_runs() did it (made); finer: makes
    those with finer balls and says what these tell; the others as of run_site_study() and Questions."""
    folder, setup, todo, half = site.folder, planned.setup, planned.todo, planned.half

    def results_of(_, work):
        at = finer(work)
        questions = results.Questions(
            planned.settings, planned.repeated, THRESHOLDS, notes=[*site_warnings.thickness_at(
                site.found.body, at.finest or float(planned.variables[VARIABLE]), notes_of(site, roads)), *at.warnings],
            site=folder, sizes=at, most_elastic=elastic_of(setup, planned.elastics, at),
            step=judge_step_run(setup, half[0], planned.middle, planned.variables, at) if half else None, method=method,
            known=asdict(planned.choices.known), roads=roads, alone=alone)
        return results.collect_results(setup, questions, todo, work)

    failed: Optional[Exception] = None
    try:
        # the longest first: a long run that starts last leaves the other cores idle
        study_ = study.perform(setup, {**planned.settings, **planned.repeated}, planned.runs, results_of,
                               first=half, made=made)
    except study.RunsFailed as error:
        study_ = error.found
        failed = study.failure(setup.output, todo)      # what is said of the others is with their results
        if failed and all(one.error for one in todo):
            raise failed from None
    if setup.dry_run:
        return Done(None, None, failed)
    if planned.choices.observed.file and not site.road:
        shutil.rmtree(folder / SCORE, ignore_errors=True)       # of other runs
        try:
            scored(folder, setup, study_)
        except Exception as error:      # whatever it is, the runs took hours: their report comes first
            failed = failed or error
    return Done(setup.output, study_, failed)


def check_site(site: Folder[Choices]) -> None:
    """Raise SlopeError unless all files of a site exist and match its choices."""
    folder, site_found = site.folder, site.found
    for name in (site_deck.NAME, *site_found.files):
        if not (folder / name).is_file():
            raise SlopeError(folder / name, f"must exist; `slope site {quote(str(folder))}` rebuilds it")
    if site_found.choices_sha256 not in ("", site.fingerprint()):
        raise SlopeError(folder / site_choices.NAME, f"must not have been changed since {site_deck.NAME} was made from "
                         f"it: `slope site {quote(str(folder))}` rebuilds the deck ("
                         + ", ".join(name for name in site_choices.READ_LATER if hasattr(site.choices, name))
                         + " may change, but for the files that they name)")
    for name, digest in site.sources().items():      # a folder may have gone without its sources
        if site_found.sources_sha256.get(name, digest) != digest:
            raise SlopeError(folder / name, f"must not have changed since {site_deck.NAME} was made from it: "
                             f"`slope site {quote(str(folder))}` rebuilds the deck")
    mapped.check_mapped_deposit(folder)
    if isinstance(site.choices, OfMass) and site.choices.road.file:
        for name in site_found.roads or [""]:
            check_site_lane(site.choices.road.asked, folder / site_roads.file_name(name))


def check_site_lane(asked: roads.Asked, road: Path) -> None:
    """Raise SlopeError, before any run, if a lane is wider than a road of polygons; of a line slope site says it."""
    if asked.lane is not None and asked.width is None:
        raster = rasters.read_asc_local(road.with_name(site_folder.TERRAIN))
        polygon = roads.read_local(road, raster, asked).polygon
        axes, _ = road_axis.axes_of((), polygon, asked, raster)
        roads.check_lane(asked.lane, road_axis.width_of(axes, road_axis.part_in_grid(polygon, raster)))


def digests(site: Site) -> Dict[str, str]:
    """{file: digest} of the deck and its data."""
    return {name: disk.sha256(site.folder / name) for name in (site_deck.NAME, *site.found.files)
            if name != site_choices.NAME and (site.folder / name).is_file()}


def read_site_warnings(folder: Path) -> List[Finding]:
    """The warnings of `slope site`, which the results repeat."""
    path = folder / site_warnings.NAME
    said = schemas.load_checked(path, "what `slope site` wrote", FINDINGS) if path.is_file() else None
    return [finding(one) for one in said or ()]


def notes_of(site: Site, roads: Sequence[Mapping[str, Any]]) -> List[Finding]:
    """The same without those of other roads; roads: of Questions."""
    mine = roads[0]["road"] if roads else site.road
    others = set(site_roads.names(site)) - {mine}
    return [one for one in read_site_warnings(site.folder) if one.numbers.get("file") not in others
            and mine in one.numbers.get("roads", mine).split(", ")]


def grounds(choices: OfMass) -> List[Dict[str, str]]:
    """The runs on other grounds."""
    return [{"rolling": rolling, "spacing": spacing} for spacing, rolling
            in map(format_deck_values, choices.other_grounds)]


def judge_step_run(setup: Setup, run_: repeats.Repeat, rolling: str, variables: Dict[str, str],
                   at: size_runs.AtFinest) -> Step:
    """What that run tells, at the finest size as the others."""
    [row] = sizes.transfer_rows(at.sizes, read_run_rows(setup, [run_]))
    if isinstance(row, Failed):
        return Step(rolling, None, f"{run_.name}: {row.error}", step=float(run_.chosen["step"]))
    prefix = run_folders.prefix_of(run_folders.summary_of(setup.output, row.summary))
    return Step(rolling, row.at_road.remove_m3, energy=read_energies(Path(f"{prefix}.{SUFFIX}"))
                if LEDGER in variables else None, spacing=variables.get("spacing"),
                step=float(run_.chosen["step"]))


def elastic_runs(setup: Setup, largest: Optional[float], rolling: List[str], repeated: Dict[str, List[str]],
                 variables: Dict[str, str]) -> List[repeats.Repeat]:
    """The runs with the largest restitution, or what the deck has if that is larger, at the least rolling resistance;
    none where none are asked for, or the deck has no such variables."""
    if largest is None or not variables.keys() >= {*elastic.VARIABLES}:
        return []
    most = [f"{max(largest, *(float(variables[name]) for name in elastic.VARIABLES)):.10g}"]
    settings = {"rolling": [min(rolling, key=float)], **dict.fromkeys(elastic.VARIABLES, most)}
    return repeats.plan_repeats(setup.runs, settings, repeated, variables)


def elastic_of(setup: Setup, runs: List[repeats.Repeat], at: size_runs.AtFinest) -> Optional[elastic.Made]:
    """What these runs tell at the finest size, whatever the road; None: there are none."""
    if not runs:
        return None
    rows = sizes.transfer_rows(at.sizes, read_run_rows(setup._replace(road=None), runs))
    return elastic.Made(float(runs[0].chosen[elastic.VARIABLES[0]]), runs[0].chosen["rolling"], rows)


def scored(folder: Path, setup: Setup, study_: study_types.Study) -> None:
    """Compare the governing run with the mapped deposit; study_: what study.yaml says."""
    from ..deposits import score_run
    name = named_run.governing(study_)
    summary = next(run_folders.summary_of(setup.output, row.summary) for row in finished_of(study_.runs)
                   if row.run == name)
    outline = folder / f"{OBSERVED}.csv"
    setup.tell(f"{name} against the mapped deposit:")
    setup.tell(score_run.make_score(str(run_folders.prefix_of(summary)),
                                    outline if outline.is_file() else folder / f"{OBSERVED}.tif", folder / SCORE))
