"""The runs of a route: a site for each body, all runs of all bodies in one queue, and what each body's say.

The folder of a body is a site as `slope site` makes it, with its own runs: `slope study bodies/N --sample ...` takes
them over, and a route those.
"""
import contextlib
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Sequence

from .. import disk, geometry, kept
from ..case import decks
from ..case.data_files import data_files
from ..case.slip_deck import PREFIX
from ..ensembles import ensemble, ensemble_maps, sample
from ..errors import SlopeError
from ..releases.packing import BULK
from ..runs import jobs
from ..sites import site, site_budget, site_choices, site_deck, site_zones
from ..sites.site_choices import LONGEST_TEXT
from ..sites.site_roads import ROAD
from ..sites.site_sections import VERSION, Ground, Key, OfMass
from ..slips import bodies
from ..statistics import designs
from ..studies import results, site_study, study
from ..studies.setup import Road, Setup
from ..survey import polygons, rasters
from ..tables.rows import finished_of
from ..tables.study_file import load_study
from .choices import Choices
from .corridor import TERRAIN
from .search import SLIPS

SITES = "bodies"
STUDY = site_study.ENSEMBLE
EVALUATED = ".evaluated"      # which tools made the results of a body


class Asked(NamedTuple):
    """What a body's study is made of."""
    setup: Setup
    questions: results.Questions
    plan: sample.Sample
    todo: List[Any]


def folder_of(folder: Path, number: int) -> Path:
    return folder / SITES / str(number)


def make_body_site(choices: Choices, folder: Path, body: Mapping[str, Any], number: int, machine: site.Machine, tell,
                   warn, draw) -> Path:
    """The site of a body, unless it is there; number: of bodies, which share the minutes."""
    place, slips = folder_of(folder, body["body"]), folder / SLIPS / str(body["body"])
    geometry.make_mesh(choices.mesh, rasters.read_asc_local(slips / TERRAIN))
    if not (place / site_choices.NAME).is_file() or site.site_folder.was_not_made(place):
        place.parent.mkdir(exist_ok=True)
        site.make_site(choices_of(choices, slips, body, number), place, machine, tell, warn, draw)
    made = site_choices.load_site(place)
    site_study.check_site(made)
    now = made.choices.changed(later(choices, body))
    if now != made.choices:
        disk.write_file(place / site_choices.NAME, site_choices.make_site_file(now, made.content.get("found") or {},
                                                                               place))
    return place


def later(choices: Choices, body: Mapping[str, Any]) -> Dict[Key, Any]:
    """Those choices of a body's site that may change when it is made."""
    asked = choices.asked._replace(start=body["road_from_m"] / 1000).about()
    return {("road", "cut_angle"): choices.cut_angle, ("road", "mesh"): choices.mesh,
            **{("road", key): value for key, value in asked.items()},
            ("project", "name"): f"{choices.name + ', ' if choices.name else ''}{body['name']}"[:LONGEST_TEXT],
            ("project", "client"): choices.client, ("project", "author"): choices.author}


def choices_of(choices: Choices, slips: Path, body: Mapping[str, Any], number: int) -> OfMass:
    """The choices of a body's site."""
    base = str(slips / f"{PREFIX}.{body['body']}.base.asc")
    choices_of_site = OfMass.of({
        "terrain": {"files": [str(slips / TERRAIN)]},
        "release": {"scar": base, "scar_is": "surface",
                    "bodies": [base] if (slips / f"{PREFIX}{bodies.END}").is_file() else []},
        "road": {"file": str(slips / "road.csv")}, "balls": {"number": choices.balls},
        "model": {"density": round(choices.density * BULK, 1)}, "known": {"confined": choices.confined}})
    choices_of_site = choices_of_site.changed(later(choices, body))
    zones = site_zones.Source(choices.ground, choices.ground_table, None, polygons.ADVICE) if choices.ground else None
    if zones and site_zones.touch(zones, rasters.read_asc_local(slips / TERRAIN)):
        choices_of_site = replace(choices_of_site, ground=Ground(zones.path, zones.table))
    if choices.minutes:     # a site's are those of its own study, which has more runs
        minutes = choices.minutes / number * site_budget.plan_budget(choices_of_site).runs / choices.sample
        choices_of_site = replace(choices_of_site, balls=replace(choices_of_site.balls, minutes=minutes))
    site_choices.check_site_file({"slope_site": VERSION, **choices_of_site.entries()}, str(slips))
    return choices_of_site


def make_route_study(choices: Choices, place: Path, engine: Setup) -> Asked:
    """The study of a body's site, as `slope study SITE --sample N --seed BODY --vary ...` makes it."""
    deck, known = place / site_deck.NAME, site_choices.load_site(place).choices
    given = known.road
    road = Road(place / ROAD, given.cut_angle, given.mesh, asked=given.asked)
    setup = engine._replace(deck=deck, output=place / STUDY, site=place, road=road)
    fixed = site_choices.not_varied(known, {words.partition("=")[0] for words in choices.vary})
    plan = sample.check_sample(choices.sample, designs.SOBOL, int(place.name), choices.vary, deck, fixed, {})
    todo = sample.plan_sample(setup.runs, plan, fixed, {}, decks.index_variables(deck))
    thresholds = list(site_study.THRESHOLDS)
    order = ensemble.Order(plan, ensemble.check_quantity(None, True),
                           ensemble_maps.Thresholds(thresholds, [5.0], [1e5]))
    questions = results.Questions(sample.settings_of(todo), {}, thresholds, order, site=place,
                                  known=asdict(known.known))
    return Asked(setup, questions, plan, todo)


def make_route_runs(several: Sequence[Asked], tell) -> List[str]:
    """Make all runs that are not finished, in one queue, and collect those of each body; returns why runs failed."""
    with contextlib.ExitStack() as stack:
        works: Dict[Path, jobs.Work] = {}
        for asked in several:
            files = data_files(asked.setup.deck, sample.all_values(sample.settings_of(asked.todo), asked.plan))
            work = stack.enter_context(study.prepared(asked.setup, files, len(asked.todo)))
            works[asked.setup.runs] = work
            work.store.admit(asked.todo)
            sample.write_sample(asked.setup.output, asked.plan)
        todo = [run for one in several for run in one.todo]
        new = {run.folder for run in todo if not run.finished}
        first = next(iter(works.values()))
        first.parts = works
        first.do(todo)
        for k, asked in enumerate(several, 1):
            if not is_collected(asked, new):
                results.collect_results(asked.setup, asked.questions, asked.todo, works[asked.setup.runs])
                disk.write_file(asked.setup.output / EVALUATED, kept.tools())
                tell(f"body {asked.setup.home.name}, {k} of {len(several)}: its runs are evaluated")
    return [f"body {one.setup.home.name}: {failure}" for one in several
            if (failure := study.failure(one.setup.output, one.todo))]


def is_collected(asked: Asked, new) -> bool:
    """Whether the results in a body's folder are of these runs, none of which was made since, of this road, and
    made by these tools."""
    if any(run.folder in new or run.error for run in asked.todo):
        return False
    by = asked.setup.output / EVALUATED
    if not by.is_file() or by.read_text(encoding="ascii") != kept.tools():
        return False
    try:
        written = load_study(asked.setup.output / "study.yaml")
    except SlopeError:
        return False
    road = written.study.road or {}
    assert asked.setup.road
    if any(road.get(key) != value for key, value in asked.setup.road.about().items()):
        return False
    return [row.run for row in finished_of(written.runs)] == [run.name for run in asked.todo]


def list_route_runs(several: Sequence[Asked]):
    """Lines of a dry run."""
    for one in several:
        for line in study.list_runs(one.todo):
            yield f"body {one.setup.home.name}: {line}"
