"""The runs of a study: read and evaluated (outcome), and shown in files and on the console, side by side.

Files and console are prints of the Outcome: study.yaml, tables and maps over all runs; tables and numbers in words.
"""
import os
from dataclasses import replace
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence

from .. import disk, provenance
from ..case import run_folders
from ..deposits.road_axis import axes_of
from ..ensembles import ensemble, known_study
from ..runs import jobs
from ..runs.repeats import Repeat
from ..seismic import chain_files
from ..survey import geopackage, roads
from ..survey.rasters import Place
from ..tables import (combinations, elastic, headline, intensity, road_runs, structures, study_file, study_maps,
                      study_table, study_types)
from . import letter, mapped, size_runs
from .outcome import Outcome, Questions, evaluate_study, read_study
from .run_rows import placed, prefix_of, terrain_place
from .setup import Road, Setup

SHOWN = 20              # runs of an ensemble whose table is printed


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
    study = write_study_files(outcome, about, setup.output, place)
    bodies_along = setup.output / f"{road_runs.BODIES}.gpkg"
    if study.stretches and study.stretches.bodies and setup.road and first:
        write_bodies(bodies_along, setup.road, first, study.stretches.bodies)
    else:
        bodies_along.unlink(missing_ok=True)        # of a study before this one
    tell_results(outcome, study, setup.output, setup.tell, setup.warn)
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


# --- files ---

def write_study_files(outcome: Outcome, study: study_types.Study, output: Path,
                      place: Optional[Place]) -> study_types.Study:
    """All of them; what study.yaml says: about, with the maps of an ensemble. place: CRS and offset of maps, None
    without."""
    asked, read = outcome.questions, outcome.read
    if outcome.ensemble:
        assert asked.order
        study = replace(study, ensemble=ensemble.write_ensemble(outcome.ensemble, asked.order.levels, output, place,
                                                                read.problem))
    if stretches := study.stretches:
        head, *lines = road_runs.rows(stretches)
        disk.write_file(output / road_runs.FILE, disk.csv_text(head, lines))
        write_or_remove(output / f"{road_runs.BODIES}.csv",
                        road_runs.table_of_bodies(stretches.bodies) if stretches.bodies else None)
    if outcome.chain:
        (output / chain_files.PER_YEAR).unlink(missing_ok=True)      # of a study before this one in the folder
        for name, text in outcome.chain.tables.items():
            disk.write_file(output / name, text)
    write_or_remove(output / intensity.FILE, intensity.tabulate_intensity(study.intensity) if study.intensity else None)
    write_or_remove(output / elastic.FILE, read.elastic and elastic.tabulate_elastic(read.elastic))
    for what, name in structures.FILES.items():
        write_or_remove(output / name, structures.tabulate_structures(read.finished, what))
    disk.write_file(output / "study.csv", study_table.tabulate_study(asked.settings, asked.repeated, read.rows,
                                                                     read.defaults))
    disk.write_file(output / "combinations.csv", combinations.tabulate_combinations(outcome.groups, outcome.names,
                                                                                    asked.settings))
    if asked.alone:
        write_abouts({output: study})
    return study


def write_or_remove(path: Path, text: Optional[str]) -> None:
    """A file, or none of a study before this one in the folder."""
    if text:
        disk.write_file(path, text)
    else:
        path.unlink(missing_ok=True)


def write_abouts(abouts: Mapping[Path, study_types.Study]) -> None:
    """study.yaml in one folder, or in those of both studies of a site, one right after the other."""
    with disk.write_beside(*(output / study_file.STUDY for output in abouts)) as new:
        for path, about in zip(new, abouts.values()):
            path.write_text(disk.yaml_text(study_file.TITLE, study_file.encode_study(about)), encoding="utf-8")


# --- console ---

def tell_results(outcome: Outcome, study: study_types.Study, output: Path, say: Callable[[Any], Any],
                 warn: Callable[[Any], Any]) -> None:
    """study: what study.yaml says; say: what gets lines and tables; warn: what gets findings."""
    asked, rows, finished = outcome.questions, outcome.read.rows, outcome.read.finished
    if study.intensity:
        say(intensity.shown_of(study.intensity))
        say(f"{output / intensity.FILE}: volume on the road against {study.intensity.variable}, and how likely "
            "more is")
    for table in structures.list_structure_tables(finished):
        say(table)
    files = [str(output / name) for what, name in structures.FILES.items() if any(row.value(what) for row in finished)]
    if files:
        say(f"{', '.join(files)}: of each run")
    for one in study.warnings:
        warn(one)
    if not asked.order or len(rows) <= SHOWN:
        say(study_table.runs_shown(asked.settings, rows, outcome.scatters,
                                   f"{study.study.deck}: {len(rows)} run{'s' * (len(rows) != 1)}, volumes in m3 "
                                   "of ground"))
    if any(outcome.scatters.values()) and not asked.order:
        say(study_table.combinations_shown(asked.settings, outcome.groups, outcome.scatters))
    if stretches := study.stretches:
        say(f"{output / road_runs.FILE}: {len(stretches.stretches)} stretches of the road that runs block")
    say(f"{output / 'study.yaml'}, {output / 'study.csv'}, {output / 'combinations.csv'}: all numbers")
    tell_numbers(study, output, say)
    if study.observed:
        say("\n".join(mapped.describe_mapped(study.observed, rows)))
    if study.chain:
        say("\n".join(chain_files.describe_chain(study.chain, output)))
    if finished and asked.method not in known_study.OF_BOTH:
        say("\n".join(tell_letter(study)))
    for entry in [*(study.envelope or {}).values(), *(study.exceedance or ())]:
        say(f"{output / entry['file']}: {entry['what']}")


def tell_letter(study: study_types.Study) -> List[str]:
    """What the first page begins with; a line each."""
    return [*letter.list_letter_lines(letter.make_letter(study)), *([str(study.next_step)] if study.next_step else [])]


def tell_numbers(study: study_types.Study, output: Path, say: Callable[[Any], Any]) -> None:
    """The conservative volume, the effects of step and size, the ensemble."""
    if study.conservative:
        say("\n".join(combinations.describe_combinations(study.conservative)))
        if study.step:
            say(study.step.text)
    if study.largest_restitution:
        say(study.largest_restitution.text)
    if study.ensemble:
        say("\n".join(ensemble.describe_ensemble(study.ensemble)))
        say(f"{output / ensemble.HAZARD}, {output / ensemble.INFLUENCE}: all curves and indices; "
            f"{output / ensemble.MAPS}: {len(study.ensemble.maps)} maps of quantiles and exceedance")
