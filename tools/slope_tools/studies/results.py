"""The runs of a study: read and evaluated (outcome), and shown in files and on the console, side by side."""
import os
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Mapping, Optional, Sequence

from .. import provenance
from ..case import run_folders
from ..deposits.road_axis import axes_of
from ..runs import jobs
from ..runs.repeats import Repeat
from ..survey import geopackage, roads
from ..tables import headline, road_runs, study_maps, study_types
from . import console, files, size_runs
from .outcome import Questions, evaluate_study, read_study
from .run_rows import placed, prefix_of, terrain_place
from .setup import Road, Setup


def collect_results(setup: Setup, questions: Questions, todo: Sequence[Repeat],
                    work: jobs.Work) -> Optional[study_types.Study]:
    """Read the runs, evaluate them, write and tell what they say; what study.yaml says, None where no run of an
    ensemble finished."""
    if questions.order and all(run.error for run in todo):
        return None     # study.perform says so
    at = questions.sizes or size_runs.AtFinest(size_runs.Made(todo, {}), None)
    todo = at.runs(todo)
    inputs, done = read_study(setup, questions, at, todo, work.defaults), [run for run in todo if not run.error]
    first = done[0] if done else None
    place = terrain_place(first) if first else None
    maps = study_maps.write_study_maps([study_maps.Source(run.name, prefix_of(run), not run.batch) for run in done],
                                       questions.thresholds, setup.output, place)
    header = study_types.Header(
        deck=setup.deck.name, known=questions.among, set=list_settings(questions.settings),
        repeat=list_settings(questions.repeated),
        runs=len(inputs.rows), finished=len(inputs.finished), method=questions.method, ranks=work.ranks, jobs=work.jobs,
        package=work.package, governs=setup.output.name, balls_thick=inputs.balls_thick, collected=provenance.now(),
        machine=provenance.machine(),
        body=os.path.relpath(setup.body.resolve(), setup.output.resolve()) if setup.body else None,
        road=write_study_road(setup.output, setup.road, first) if setup.road and first else None)
    outcome = evaluate_study(questions, inputs._replace(problem=maps.problem), header)
    about = replace(outcome.about, envelope=maps.envelope, exceedance=maps.exceedance)
    if questions.alone:
        about = headline.conclude({setup.output: about}, setup.given)[setup.output]
    size_runs.write_levels(setup, at, questions.settings, questions.repeated, work.defaults)
    study = files.write_study_files(outcome, about, setup.output, place)
    bodies_along = setup.output / f"{road_runs.BODIES}.gpkg"
    if study.stretches and study.stretches.bodies and setup.road and first:
        write_bodies(bodies_along, setup.road, first, study.stretches.bodies)
    else:
        bodies_along.unlink(missing_ok=True)        # of a study before this one
    console.tell(outcome, study, setup.output, setup.tell, setup.warn)
    return study


def list_settings(several: Mapping[str, Sequence[str]]) -> study_types.Settings:
    """Values as study.yaml has them."""
    return {name: list(values) for name, values in several.items()}


def write_bodies(path: Path, road: Road, run: Repeat, entries: Sequence[Mapping[str, Any]]) -> None:
    """Which body brings most to which part of the road, for a GIS."""
    raster = placed(run_folders.load_raster(prefix_of(run), "thickness"), run)
    given = road.read(raster)
    axes, _ = axes_of(given.lines, given.polygon, road.asked, raster)
    geopackage.write_geopackage(path, {
        road_runs.BODIES: road_runs.layer_of_bodies(entries, axes)}, raster)


def write_study_road(output: Path, road: Road, run: Repeat) -> Dict[str, Any]:
    """Keep the road, in local metres, with the study; what study.yaml says of it."""
    raster = placed(run_folders.load_raster(prefix_of(run), "thickness"), run)
    roads.write_road(output / "road.csv", road.read(raster), raster)
    return {**road.about(), "local": "road.csv"}
