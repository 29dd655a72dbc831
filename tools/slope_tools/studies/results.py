"""The runs of a study: read, evaluated (outcome), and shown in files and on the console, side by side."""
import functools
import os
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import Any, Dict, List, Mapping, Optional, Sequence

import numpy as np

from .. import disk, kept, provenance
from ..case import run_folders
from ..deposits import gone
from ..ensembles import ensemble, known_events, known_study
from ..findings import Finding, entries
from ..mobility.exceedance import Mobility
from ..releases import release_toe
from ..runs.repeats import Repeat
from ..sites import site_choices
from ..statistics import headline
from ..survey import rasters, roads
from ..tables import (combinations, elastic, fine_run, judged, next_step, quantities, structures, study_maps, usable,
                      withheld_words)
from . import body_depth, console, files, mapped, site_ground
from .outcome import Questions, Read, evaluate
from .setup import Road, Setup

OF_SUMMARY = ("moves", "not counted")      # kinds of warnings


def collect(setup: Setup, questions: Questions, todo, work) -> Optional[Dict[str, Any]]:
    """Read the runs, evaluate them, write and tell what they say; what study.yaml says, None where no run of an
    ensemble finished."""
    if questions.order and all(run.error for run in todo):
        return None     # study.perform says so
    rows, finished = rows_of(setup, todo), [run for run in todo if not run.error]
    first = finished[0] if finished else None
    place = terrain_place(first) if first else None
    maps = study_maps.write([study_maps.Source(run.name, prefix_of(run), not run.batch) for run in finished],
                            questions.thresholds, setup.output, place)
    found = read(setup, questions, todo, rows, maps.pop("problem"), work.defaults)
    outcome = evaluate(questions, found)
    header = {"deck": setup.deck.name, "known": questions.among, "set": questions.settings,
              "repeat": questions.repeated, "runs": len(found.rows), "finished": len(found.finished),
              "method": questions.method, "ranks": work.ranks, "jobs": work.jobs, "package": work.package,
              "governs": setup.output.name, "balls_thick": found.balls_thick, "collected": provenance.now(),
              "machine": provenance.machine()}
    if setup.road and first:
        header["road"] = write_road(setup.output, setup.road, first)
    step = next_step.of_studies([next_step.Made({"study": header, **outcome.about}, setup.output)],
                                outcome.about["headline"])
    outcome = replace(outcome, about={**outcome.about, next_step.ENTRY: step and step._asdict()})
    about = files.write(outcome, header, maps, setup.output, place)
    console.tell(outcome, about, setup.output, setup.tell, setup.warn)
    return about


def read(setup: Setup, questions: Questions, todo, rows: List[Dict[str, Any]], problem: Optional[str],
         defaults: Mapping[str, str]) -> Read:
    """What an Outcome is evaluated from; problem: why there are no maps over all runs."""
    observed = mapped.compare(mapped.of_site(questions.site), setup.output, rows, [terrain_of(run) for run in todo])
    first = next((run for run in todo if not run.error), None)
    row = next((row for row in rows if row["status"] == "finished"), None)
    events = mobility = fine = None
    if row and setup.road:
        events = events_of(setup, first, row, questions.among)
    if row and questions.order and questions.order.condition:
        summary = run_folders.summary_of(setup.output, row)
        mobility = known_events.mobility_of(questions.order.condition, summary.parent, summary)
    emulated = emulated_of(setup, questions.order, rows, mobility) if questions.order else {}
    if row and questions.fine:
        fine = compared(setup, questions.fine, rows, None if questions.order else combinations.grouped(rows))
    most = elastic.read(questions.most_elastic, rows, setup.output) if row and questions.most_elastic else None
    return Read(rows, setup.road is not None, events, mobility, emulated, observed, fine, most, problem,
                case_of(setup, questions, row) if row else None,
                body_depth.in_balls(setup, [one for one in rows if one["status"] == "finished"]), defaults)


def emulated_of(setup: Setup, order: ensemble.Order, rows: Sequence[Mapping[str, Any]],
                mobility: Optional[Mobility]) -> Dict[str, Any]:
    """What emulators say of the runs of an ensemble, kept with the study."""
    made_of = [order.sample.about, order.of, order.added and order.added.batches, rows,
               mobility and [mobility.outside, mobility.path.length, mobility.curves[mobility.chosen]]]
    return kept.value(setup.output / ".emulated.json", made_of, lambda: ensemble.emulate(order, rows, mobility))


def compared(setup: Setup, fine: Repeat, rows: Sequence[Mapping[str, Any]],
             groups: Optional[Sequence[combinations.Group]]) -> fine_run.Fine:
    """The fine run beside the rows with the same values; groups: of a study with repeats, None of an ensemble."""
    if fine.error:
        return fine_run.Fine(None, (), 0.0, lambda key: None, f"{fine.name}: {fine.error}")
    [row] = rows_of(setup, [fine])
    coarse = [one for one in rows if one["status"] == "finished"
              and all(row["variables"][name] == one["variables"][name]
                      for name in one["set"] if name != fine_run.VARIABLE)]
    same = next((group for group in groups or () if coarse and group.set == coarse[0]["set"]), None)
    coarse = same.rows if same else [one for one in coarse if not one["repeat"]]

    def scatter(key: str) -> Optional[headline.Scatter]:
        if same is None:
            return None
        mine = same.of(key)
        parts = [mine, *(group.of(key) for group in groups or () if group is not same
                         and all(row.get(key) is not None for row in group.rows))]
        return headline.scatter_of(parts, mine) if mine.mean > 0 else headline.pooled(parts)

    return fine_run.Fine(row, coarse, body_depth.mean(setup, row), scatter)


def events_of(setup: Setup, run, row, among: Mapping[str, Any]) -> Optional[usable.Events]:
    """What known events did of the mass of a run, of its row."""
    summary = run_folders.summary_of(setup.output, row)
    raster = placed(run_folders.load_raster(run_folders.prefix_of(summary), "thickness"), run)
    road = setup.road.read(raster).polygon if setup.road else None
    return usable.known_events(run_folders.prefix_of(summary), terrain_of(run), road, among)


def case_of(setup: Setup, questions: Questions, row) -> withheld_words.Case:
    paper = " --paper" if questions.method == known_study.ASKED else ""
    command = f"tools/slope study {quote(str(questions.site))}{paper}" if questions.site and questions.method else ""
    return withheld_words.Case(setup.deck, questions.site, row["variables"], round(row["released_m3"] / row["ball_m3"]),
                               command=command)


def rows_of(setup: Setup, todo) -> List[Dict[str, Any]]:
    """A row for each run, finished or failed."""
    rows = []
    for run in rasters.progress(todo, "collecting the runs"):
        row = {"run": run.name, "status": "failed" if run.error else "finished", "set": run.combination,
               "repeat": run.repeat, "batch": run.batch}
        if run.error:
            rows.append({**row, "error": run.error, "log_warnings": run.log.warnings})
            continue
        row.update(result(run, setup.output))
        if setup.road:
            row.update(on_road(run, setup, row))
        rows.append(row)
    return rows


def prefix_of(run) -> Path:
    return run_folders.prefix_of(run.folder / str(run_folders.ended(run.folder).get("summary")))


def result(run, output) -> Dict[str, Any]:
    """What a row has of a finished run, for a table in a folder; kept with the run."""
    run.log.update()
    found = kept.value(run.folder / ".row.json", run_folders.state(run.folder), lambda: measured(run))
    return {**found, "summary": os.path.relpath(run.folder / found["summary"], output)}


def measured(run) -> Dict[str, Any]:
    """The same; the summary as named in the run's folder."""
    from ..deposits import deposit
    from ..mobility import run_length
    marker, about, prefix = run_folders.ended(run.folder), run_folders.begun(run.folder), prefix_of(run)
    summary = run_folders.load_summary(run.folder / str(marker.get("summary")))
    thickness = run_folders.load_raster(prefix, "thickness")
    volume = summary["volume"]
    stays = volume["released"] - volume["off_grid"] - volume["lost"]
    on_grid = float(np.nansum(thickness.z)) * thickness.transform.a ** 2
    base = run_folders.load_raster(prefix, "surface").z - thickness.z
    left = deposit.Deposit(str(prefix), thickness, base, summary, None)
    length = run_length.of_run(left, terrain_of(run))
    return {"variables": about.get("variables"), quantities.STOP: site_ground.of_variables(about.get("variables")),
            "ranks": about.get("ranks"), "package": about.get("package"),
            **quantities.of_length(length), "left": gone.entries(left),
            "ball_m3": volume["released"] / summary["balls"]["released"],
            "mass_error": (on_grid - stays) / volume["released"],
            **judged.columns(summary, run.log), "change_rate": summary.get("change_rate"),
            "wall_s": marker.get("wall_seconds"), "summary": marker.get("summary"),
            "slope_version": summary["slope_version"], "lammps_version": summary["lammps_version"],
            "lmp_sha256": about.get("lmp_sha256"), **structures.of_run(run.folder, run.log.settings)}


def on_road(run, setup: Setup, row) -> Dict[str, Any]:
    """What `slope volume` says of a run, which goes to the folder volume of the run, without the picture, and is kept
    there; and what lies beyond."""
    road = setup.road
    assert road
    made_of = {"run": run_folders.state(run.folder), "road": road._replace(file=Path(road.file.name))._asdict(),
               "file": site_choices.content(str(road.file))}
    folder = run.folder / quantities.volume_folder(road.name)
    return kept.value(folder / "row.json", made_of, functools.partial(measured_on, road, run, row),
                      lambda: [folder / name for name in ("volume.yaml", "volume.tif", "volume_mesh.tif")])


def measured_on(road: Road, run, row) -> Dict[str, Any]:
    """The same, measured."""
    from ..deposits import volume
    prefix = prefix_of(run)
    terrain, thickness = terrain_of(run), run_folders.load_raster(prefix, "thickness")
    wanted = volume.Wanted(road.file, road.mesh, road.cut_angle, road.local, asked=road.asked)
    found = volume.of_run(str(prefix), wanted, terrain)
    volume.write(found, run.folder / quantities.volume_folder(road.name), picture=False)
    about = disk.plain(found.about)       # numpy has no place in study.yaml
    released = run_folders.load_raster(prefix, "arrival").z == 0
    polygon, total = road.read(placed(thickness, run)).polygon, about["clearing"]
    taken = release_toe.on_body(body_depth.body_of(released, thickness, row["ball_m3"]), thickness, polygon,
                                release_toe.rim(row["ball_m3"], thickness.transform.a))
    if taken:
        found.warnings.append(taken.finding(road.file.name))
    return {"road_on_body_m2": taken.area if taken else 0.0, "remove_m3": about["volume"]["remove"],
            "remove_on_road_m3": about["volume"]["remove_on_road"],
            "remove_beside_road_m3": about["volume"]["remove_beside_road"],
            **quantities.of_division(about["divided"], about["left"]),
            "blocked_m": total["blocked_length"], "axis_thickness_m": about["axis"]["largest_thickness"],
            "remove_lane_m3": total.get("remove_lane"), "lane_hours": total.get("hours_lane"),
            "clear_hours": total.get("hours"), "stretches": about["stretches"], "clearing": total,
            # what it says of the summary is in the table
            "road_warnings": entries(in_folder(one, run.folder) for one in found.warnings
                                     if one.kind not in OF_SUMMARY)}


def in_folder(one: Finding, folder: Path) -> Finding:
    """The same, whose files are named as from a run's folder: one warning for all runs."""
    return one._replace(numbers={name: value.replace(f"{folder}/", "") if isinstance(value, str) else value
                                 for name, value in one.numbers.items()})


def placed(raster, run):
    """The raster with the CRS and the offset of the run's terrain."""
    place = terrain_place(run)
    return raster._replace(crs=place.crs, offset=place.offset) if place else raster


def write_road(output, road: Road, run) -> Dict[str, Any]:
    """Keep the road, in local metres, with the study; what study.yaml says of it."""
    raster = placed(run_folders.load_raster(prefix_of(run), "thickness"), run)
    roads.write(output / "road.csv", road.read(raster), raster)
    return {**road.about(), "local": "road.csv"}


def terrain_place(run):
    """CRS and offset of the runs' local metres, from the sidecar of their terrain; None without one."""
    return run.log.terrain and rasters.read_sidecar(run.folder / run.log.terrain)


def terrain_of(run):
    """The terrain file of a run, None without one."""
    return run.folder / run.log.terrain if run.log.terrain else None
