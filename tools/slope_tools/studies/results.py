"""What came out of the runs of a study: their numbers, the table, the maps over all runs, the conservative volume."""
import os
from pathlib import Path
from typing import Any, Dict, Mapping, NamedTuple, Optional, Sequence

import numpy as np

from .. import disk, provenance
from ..case import run_folders
from ..deposits import gone, travel_shares
from ..ensembles import ensemble, known_study
from ..findings import Finding, entries, finding
from ..releases import release_toe
from ..runs import repeats
from ..runs.repeats import Repeat
from ..seismic import chain_files
from ..statistics import headline
from ..survey import rasters, roads
from ..tables import (answered, combinations, elastic, fine_run, intensity, judged, quantities, road_runs, step_check,
                      structures, study_table, usable, withheld_words)
from ..tables.study_maps import Maps
from . import body_depth, mapped, site_ground
from .setup import Road, Setup

OF_SUMMARY = ("moves", "not counted")      # kinds of warnings
LIKE = 1.5              # times as many balls over the thickness: values found with fewer, or more, are of another model
SHOWN = 20              # runs of an ensemble whose table is printed


class Questions(NamedTuple):
    """What is asked of the runs of a study together."""
    settings: Mapping[str, Sequence[str]]           # of --set: choices
    repeated: Mapping[str, Sequence[str]]           # of --repeat: chance
    thresholds: Sequence[float]                     # m, of the maps of exceedance
    order: Any = None                               # the ensemble.Order that the runs were made for, None of lists
    intensity: Optional[str] = None                 # variable that is one; None: the one that is called so
    more_than: Sequence[float] = ()                 # m3, volumes exceeded at each intensity
    notes: Sequence[Any] = ()                       # warnings of what was before the study, which go into its results
    site: Optional[Path] = None                     # folder of the site whose study it is
    fine: Optional[Repeat] = None                   # the run with smaller balls; None: none was asked for
    step: Optional[step_check.Step] = None          # the run with half the time step
    most_elastic: Optional[elastic.Made] = None     # the runs with the largest restitution
    method: str = ""                                # of a site's study, in words
    chain: Optional[chain_files.Chain] = None       # of an ensemble: how likely its bodies fail in an earthquake
    known: Mapping[str, Any] = {}                   # of site.yaml: with which known events the runs are compared


def collect(setup: Setup, questions: Questions, todo, work) -> Optional[Dict[str, Any]]:
    """Table, maps and study.yaml over all runs that finished; what the latter says, None where no run of an ensemble
    finished."""
    settings, repeated, thresholds, order = questions[:4]
    output, deck = setup.output, setup.deck
    if order and all(run.error for run in todo):
        return None     # study.perform says so
    maps = Maps(thresholds)
    rows, thickness = rows_of(setup, todo, maps)
    warnings = [finding(one) for one in questions.notes]
    warned = {one.kind for one in warnings if not one.part}
    warnings += [one for one in judged.of_runs(rows) if one.kind not in warned]
    if maps.problem:
        warnings.append(finding(maps.problem))
    finished = [row for row in rows if row["status"] == "finished"]
    observed = mapped.compare(mapped.of_site(questions.site), output, rows, [terrain_of(run) for run in todo])
    groups = combinations.grouped(rows)
    names = combinations.averaged(groups)
    scatters = combinations.scatters(groups)
    first = next((run for run in todo if not run.error), None)
    written = maps.write(output, terrain_place(first) if first else None)
    keys = ["front_m", "thickness_m", "max_thickness_m", "max_speed_m_s"]
    keys += [key for key in (travel_shares.DISTANCE, "length_m") if key in names]
    among = known_of(questions)
    events = events_of(setup, first, finished[0], among) if setup.road and finished else None
    about = {
        "study": {"deck": deck.name, "known": among,
                  "set": settings, "repeat": repeated, "runs": len(rows), "finished": len(finished),
                  "method": questions.method, "ranks": work.ranks, "jobs": work.jobs, "package": work.package,
                  "governs": output.name, "collected": provenance.now(), "machine": provenance.machine()},
        "largest": {key: largest(finished, key) for key in keys if finished},
        "farthest": travel_shares.farthest(finished)["run"] if finished else None,
        "conservative": None, "size": None, "ensemble": None, "step": None,
        elastic.ENTRY: None,
        "scatter": {name: known and {"deviation": known.deviation, "degrees_of_freedom": known.degrees_of_freedom}
                    for name, known in scatters.items()},
        "combinations": combinations.entries(groups, names), **written, "observed": observed,
        "warnings": entries(warnings), "runs": rows}
    if setup.road and finished:
        about["study"]["road"] = write_road(output, setup.road, first, thickness)
    about["study"]["balls_thick"] = body_depth.in_balls(setup, finished)
    if questions.fine and finished:
        about["size"] = fine_run.evaluate(compared(setup, questions.fine, rows, None if order else groups))
    (output / elastic.FILE).unlink(missing_ok=True)
    if questions.most_elastic and finished:
        about[elastic.ENTRY] = elastic.evaluate(questions.most_elastic, rows, output)
    if order:
        about["ensemble"] = ensemble.evaluate(order, rows, output, first and terrain_place(first), maps.problem)
        case = case_of(setup, questions, finished[0])._replace(sampled=True)
        about["ensemble"]["withheld"] = usable.reasons_of_ensemble(rows, events, case) if setup.road else []
    elif setup.road and finished:
        best = about["conservative"] = combinations.conservative(
            settings, rows, groups, fine_run.read_effect(about["size"], quantities.REMOVE))
        best["doubts"] += entries(unseen(repeated, work.defaults))
        if questions.step:
            about["step"] = step_check.compare(questions.step, groups)
            best["doubts"] += about["step"].pop("doubts")
        usable.judge(best, rows, events, case_of(setup, questions, finished[0]))
    about["headline"] = (said := answered.of_study(about, events and events.road(finished))) and said.about()
    if setup.road and finished:
        known = (about["ensemble"] or {}).get("known_events") or {}
        about["stretches"] = stretches_of(output, finished, known.get("weights"))
    about["chain"] = chain_files.evaluate(
        questions.chain, rows, output, about["ensemble"]["withheld"], about["size"]) \
        if questions.chain and order and finished else None
    about["intensity"] = intensity.collect(
        output, questions.intensity, questions.more_than, settings, bool(setup.road), groups, setup.tell) \
        if finished and not order else None      # of values that are drawn, each has one run
    if not about["intensity"]:
        (output / intensity.FILE).unlink(missing_ok=True)       # of a study before this one in the folder
    else:
        about["conservative"]["doubts"] += entries(intensity.doubts(about["intensity"]))
    structures.collect(output, finished, setup.tell)
    if other := other_thickness(order and order.sample.balls_thick, about["study"]["balls_thick"]):
        warnings.append(other)
    about["warnings"] = entries(warnings)
    for one in warnings:
        setup.warn(one)
    disk.write(output / "study.csv", study_table.table(settings, repeated, rows, work.defaults))
    disk.write(output / "combinations.csv", combinations.table(groups, names, settings))
    write(output, about)
    if not order or len(rows) <= SHOWN:
        setup.tell(study_table.runs_shown(
            settings, rows, scatters,
            f"{deck.name}: {len(rows)} run{'s' * (len(rows) != 1)}, volumes in m3 of ground"))
    if any(scatters.values()) and not order:
        setup.tell(study_table.combinations_shown(settings, groups, scatters))
    if about.get("stretches"):
        setup.tell(f"{output / road_runs.FILE}: {len(about['stretches']['stretches'])} stretches of the road that runs "
                   "block")
    setup.tell(f"{output / 'study.yaml'}, {output / 'study.csv'}, {output / 'combinations.csv'}: all numbers")
    if about["conservative"]:
        setup.tell("\n".join(combinations.describe(about["conservative"])))
        if about["step"]:
            setup.tell(about["step"]["text"])
    if about["size"]:
        setup.tell(f"size of the balls: {about['size']['text']}")
    if questions.most_elastic and finished:
        setup.tell(about[elastic.ENTRY]["text"])
    if about["ensemble"]:
        setup.tell("\n".join(ensemble.describe(about["ensemble"])))
        setup.tell(f"{output / ensemble.HAZARD}, {output / ensemble.INFLUENCE}: all curves and indices; "
                   f"{output / ensemble.MAPS}: {len(about['ensemble']['maps'])} maps of quantiles and exceedance")
    if observed:
        setup.tell("\n".join(mapped.describe(observed, rows)))
    if about["chain"]:
        setup.tell("\n".join(chain_files.describe(about["chain"], output)))
    for entry in [*(written["envelope"] or {}).values(), *(written["exceedance"] or ())]:
        setup.tell(f"{output / entry['file']}: {entry['what']}")
    return about


def write(output: Path, about: Mapping[str, Any]) -> None:
    """study.yaml."""
    disk.write(output / "study.yaml", disk.yaml_text(answered.TITLE, about))


def compared(setup: Setup, fine: Repeat, rows: Sequence[Mapping[str, Any]],
             groups: Optional[Sequence[combinations.Group]]) -> fine_run.Fine:
    """The fine run beside the rows with the same values; groups: of a study with repeats, None of an ensemble."""
    if fine.error:
        return fine_run.Fine(None, (), 0.0, lambda key: None, f"{fine.name}: {fine.error}")
    [row], _ = rows_of(setup, [fine], Maps(()))
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


def other_thickness(found: Optional[float], here: Optional[float]) -> Optional[Finding]:
    """That calibrated values were found with so many balls over the thickness of the body, and are used with others."""
    if found is None or here is None or max(found, here) <= LIKE * min(found, here):
        return None
    return Finding("other thickness", {"found": found, "here": here})


def known_of(questions: Questions) -> Mapping[str, Any]:
    """With which known events the runs are compared: the ensemble's, or those of site.yaml; for known.of_about()."""
    condition = questions.order and questions.order.condition
    return condition.asked.about() if condition else questions.known


def events_of(setup: Setup, run, row, among: Mapping[str, Any]) -> Optional[usable.Events]:
    """What known events did of the mass of a run, of its row."""
    summary = run_folders.summary_of(setup.output, row)
    raster = placed(run_folders.load_raster(run_folders.prefix_of(summary), "thickness"), run)
    road = setup.road.read(raster).polygon if setup.road else None
    return usable.known_events(run_folders.prefix_of(summary), terrain_of(run), road, among)


def case_of(setup: Setup, questions: Questions, row) -> withheld_words.Case:
    asked = " --paper" if questions.method == known_study.ASKED else ""
    return withheld_words.Case(setup.deck, questions.site, row["variables"], round(row["released_m3"] / row["ball_m3"]),
                               asked=asked)


def unseen(repeated, defaults):
    """The caveat that the scatter is incomplete: only seeds were repeated, though the deck can place its balls anew."""
    offsets = repeats.only_seeds(repeated, defaults)
    return [Finding("not repeated", {"repeated": ", ".join(repeated), "offsets": ", ".join(offsets)})] \
        if offsets else []


def rows_of(setup: Setup, todo, maps):
    """A row for each run, finished or failed, and the final thickness of the last one that finished."""
    rows, thickness = [], None
    for run in rasters.progress(todo, "collecting the runs"):
        row = {"run": run.name, "status": "failed" if run.error else "finished", "set": run.combination,
               "repeat": run.repeat, "batch": run.batch}
        if run.error:
            rows.append({**row, "error": run.error, "log_warnings": run.log.warnings})
            continue
        row, thickness = result(run, row, maps, setup.output)
        if setup.road:
            row.update(on_road(run, setup, row, thickness))
        rows.append(row)
    return rows, thickness


def result(run, row, maps, output):
    """The row of a finished run for a table in a folder, and its final thickness; adds its rasters to the maps."""
    from ..deposits import deposit
    from ..mobility import run_length
    marker = run_folders.ended(run.folder)
    path = run.folder / str(marker.get("summary"))
    about = run_folders.begun(run.folder)
    summary = run_folders.load_summary(path)
    prefix = run_folders.prefix_of(path)
    thickness = run_folders.load_raster(prefix, "thickness")
    maps.add(run.name, thickness, run_folders.load_raster(prefix, "max_thickness"), not row.get("batch"))
    run.log.update()
    volume = summary["volume"]
    stays = volume["released"] - volume["off_grid"] - volume["lost"]
    on_grid = float(np.nansum(thickness.z)) * thickness.transform.a ** 2
    base = run_folders.load_raster(prefix, "surface").z - thickness.z
    left = deposit.Deposit(str(prefix), thickness, base, summary, None)
    length = run_length.of_run(left, terrain_of(run))
    row = {**row, "variables": about.get("variables"),
           quantities.STOP: site_ground.of_variables(about.get("variables")), "ranks": about.get("ranks"),
           "package": about.get("package"),
           **quantities.of_length(length), "left": gone.entries(left),
           "ball_m3": volume["released"] / summary["balls"]["released"],
           "mass_error": (on_grid - stays) / volume["released"],
           **judged.columns(summary, run.log), "change_rate": summary.get("change_rate"),
           "wall_s": marker.get("wall_seconds"), "summary": os.path.relpath(path, output),
           "slope_version": summary["slope_version"], "lammps_version": summary["lammps_version"],
           "lmp_sha256": about.get("lmp_sha256"), **structures.of_run(run.folder, run.log.settings)}
    return row, thickness


def on_road(run, setup: Setup, row, thickness) -> Dict[str, Any]:
    """What `slope volume` says of a run, which goes to the folder volume of the run, without the picture; and what lies
    beyond."""
    from ..deposits import volume
    road, summary = setup.road, run_folders.summary_of(setup.output, row)
    assert road
    prefix = run_folders.prefix_of(summary)
    terrain = terrain_of(run)
    wanted = volume.Wanted(road.file, road.mesh, road.cut_angle, road.local, asked=road.asked)
    found = volume.of_run(str(prefix), wanted, terrain)
    volume.write(found, run.folder / "volume", picture=False)
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


def write_road(output, road: Road, run, thickness) -> Dict[str, Any]:
    """Keep the road, in local metres, with the study; what study.yaml says of it."""
    raster = placed(thickness, run)
    roads.write(output / "road.csv", road.read(raster), raster)
    return {**road.about(), "local": "road.csv"}


def stretches_of(output, rows, known) -> Dict[str, Any]:
    """What study.yaml says of the stretches that finished runs block; known: weights by known events, or None."""
    weights = known or {row["run"]: 1.0 for row in rows if not row.get("batch")}
    about = road_runs.evaluate([road_runs.Run(weights[row["run"]], row["stretches"], row["clearing"])
                                for row in rows if row["run"] in weights])
    head, *lines = road_runs.rows(about)
    disk.write(output / road_runs.FILE, disk.csv_text(head, lines))
    return {**about, "of_known_events": bool(known)}


def terrain_place(run):
    """CRS and offset of the runs' local metres, from the sidecar of their terrain; None without one."""
    return run.log.terrain and rasters.read_sidecar(run.folder / run.log.terrain)


def terrain_of(run):
    """The terrain file of a run, None without one."""
    return run.folder / run.log.terrain if run.log.terrain else None


def largest(rows, key):
    """The largest value of a column and the first run that has it."""
    best = max(rows, key=lambda row: row[key])
    return {"value": best[key], "run": best["run"]}
