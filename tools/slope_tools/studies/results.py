"""The runs of a study: read, evaluated (outcome), and shown in files and on the console, side by side."""
import os
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Mapping, Optional, Sequence

from .. import kept, provenance, records
from ..case import run_folders
from ..deposits.road_axis import axes_of
from ..ensembles import ensemble, known_events
from ..errors import SlopeError
from ..mobility import known
from ..mobility.known import Mobility
from ..runs import jobs
from ..runs.repeats import Repeat
from ..survey import geopackage, roads
from ..tables import elastic, headline, how_far, road_runs, study_maps, study_types, usable
from ..tables.rows import Row, finished_of
from . import body_depth, console, files, mapped, size_runs
from .outcome import Questions, Read, evaluate_study
from .run_rows import placed, prefix_of, read_run_rows, terrain_of, terrain_place
from .setup import Road, Setup


def collect_results(setup: Setup, questions: Questions, todo: Sequence[Repeat],
                    work: jobs.Work) -> Optional[study_types.Study]:
    """Read the runs, evaluate them, write and tell what they say; what study.yaml says, None where no run of an
    ensemble finished."""
    if questions.order and all(run.error for run in todo):
        return None     # study.perform says so
    at = questions.sizes or size_runs.AtFinest(size_runs.Made(todo, {}), None)
    todo = at.runs(todo)
    raw, done = read_run_rows(setup, todo), [run for run in todo if not run.error]
    rows = at.rows(raw)
    first = done[0] if done else None
    place = terrain_place(first) if first else None
    maps = study_maps.write_study_maps([study_maps.Source(run.name, prefix_of(run), not run.batch) for run in done],
                                       questions.thresholds, setup.output, place)
    inputs = read_results(setup, questions, todo, rows, maps.problem, work.defaults)._replace(draw=at.draw(raw))
    header = study_types.Header(
        deck=setup.deck.name, known=questions.among, set=list_settings(questions.settings),
        repeat=list_settings(questions.repeated),
        runs=len(inputs.rows), finished=len(inputs.finished), method=questions.method, ranks=work.ranks, jobs=work.jobs,
        package=work.package, governs=setup.output.name, balls_thick=inputs.balls_thick, collected=provenance.now(),
        machine=provenance.machine(),
        body=os.path.relpath(setup.body.resolve(), setup.output.resolve()) if setup.body else None,
        road=write_study_road(setup.output, setup.road, first) if setup.road and first else None)
    outcome = evaluate_study(questions, inputs, header)
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


def read_results(setup: Setup, questions: Questions, todo: Sequence[Repeat], rows: Sequence[Row],
                 problem: Optional[str], defaults: Mapping[str, str]) -> Read:
    """What an Outcome is evaluated from; problem: why there are no maps over all runs."""
    rows, observed = mapped.compare(mapped.find_mapped_deposit(questions.site), setup.output, rows,
                                    [terrain_of(run.folder, run.log) for run in todo])
    first, finished = next((run for run in todo if not run.error), None), finished_of(rows)
    row = finished[0] if finished else None
    events = mobility = None
    among = known.Known(None, "")
    if first and row:
        prefix = run_folders.prefix_of(run_folders.summary_of(setup.output, row.summary))
        try:
            among = how_far.known_of(prefix, terrain_of(first.folder, first.log), questions.among, setup.body)
        except SlopeError as error:     # a terrain that only LAMMPS finds, a raster that was changed
            if setup.road:
                raise
            among = known.Known(None, str(error))
        if setup.road:
            raster = placed(run_folders.load_raster(prefix, "thickness"), first)
            events = how_far.compute_events_at_road(among.found, setup.road.read(raster).polygon)
    if row and questions.order and questions.order.condition:
        summary = run_folders.summary_of(setup.output, row.summary)
        mobility = known_events.mobility_of(questions.order.condition, summary.parent, summary)
    emulated = emulated_of(setup, questions.order, rows, mobility) if questions.order else None
    most = elastic.read_elastic_runs(questions.most_elastic, rows,
                                     setup.output) if row and questions.most_elastic else None
    size = size_runs.summarise_finer_runs(setup, questions.sizes) if row and questions.sizes else None
    return Read(rows, setup.road is not None, among, events, mobility, emulated, observed, size, None, most, problem,
                usable.Case(setup.deck, questions.site, row.variables, round(row.released_m3 / row.ball_m3),
                            given=setup.given) if row else None,
                body_depth.in_balls(setup, finished), defaults)


def emulated_of(setup: Setup, order: ensemble.Order, rows: Sequence[Row],
                mobility: Optional[Mobility]) -> ensemble.Emulated:
    """What emulators say of the runs of an ensemble, kept with the study."""
    made_of = [order.sample.about, order.of, order.added and order.added.batches, rows,
               mobility and [mobility.outside, mobility.path.length, mobility.curves[mobility.chosen]]]
    return records.read_record(ensemble.Emulated, kept.value(
        setup.output / ".emulated.json", made_of, lambda: records.encode_record(
            ensemble.emulate(order, rows, mobility))))


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
