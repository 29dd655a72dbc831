"""The rows of runs: what each finished run says, and what it says of a road, read from its files and kept with it."""
import functools
import os
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .. import disk, kept, records
from ..case import logs, run_folders
from ..findings import Finding, encode_findings
from ..mobility import run_length
from ..releases import release_toe
from ..runs.repeats import Repeat
from ..survey import file_parts, rasters
from ..tables import judged, quantities, structures
from ..tables.rows import Failed, Finished, OnRoad, Row
from . import body_depth, site_ground
from .setup import Road, Setup

NAMELESS: Dict[str, Any] = {"run": "", "set": {}, "repeat": {}, "batch": 0}
OF_SUMMARY = ("moves", "not counted")      # kinds of warnings


def read_run_rows(setup: Setup, todo: Sequence[Repeat]) -> List[Row]:
    """A row for each run, finished or failed."""
    rows: List[Row] = []
    for run in rasters.progress(todo, "collecting the runs"):
        if run.error:
            rows.append(Failed(run.name, run.combination, run.repeat, run.batch, run.error, run.log.warnings))
            continue
        row = finished(run, setup.output)
        rows.append(with_road(run, setup.road, row) if setup.road else row)
    return rows


def prefix_of(run: Repeat) -> Path:
    return run_folders.prefix_of(run.folder / str(run_folders.ended(run.folder).get("summary")))


def finished(run: Repeat, output: Path) -> Finished:
    """The row of a finished run, for a table in a folder; its numbers are kept with the run."""
    run.log.update()

    def read() -> Finished:
        found = kept.value(run.folder / ".row.json", state_of(run), lambda: measure_run(
            run.folder, run_folders.ended(run.folder)["summary"], run.log))
        return records.read_record(Finished, {**NAMELESS, **found})
    row: Finished = kept.make_once((run.folder, disk.stamp_of(run.marker)), read)
    return replace(row, run=run.name, set=run.combination, repeat=run.repeat, batch=run.batch,
                   summary=os.path.relpath(run.folder / row.summary, output))


def state_of(run: Repeat) -> str:
    state: str = kept.make_once(("state", run.folder, disk.stamp_of(run.marker)), lambda: run_folders.state(run.folder))
    return state


def alone(folder: Path, summary: Path, log: logs.Log) -> Finished:
    """The row of a run that is none of a study: it has no name."""
    return records.read_record(Finished, {**NAMELESS, **disk.make_plain(measure_run(folder, summary.name, log))})


def measure_run(folder: Path, summary_name: str, log: logs.Log) -> Dict[str, Any]:
    """The fields of a Finished, but for what is asked of it; the summary as named in the run's folder."""
    from ..deposits import deposit, gone
    prefix, marker = run_folders.prefix_of(folder / summary_name), run_folders.ended(folder)
    begun = run_folders.begun(folder) if (folder / run_folders.VARIABLES).is_file() else {}
    summary = run_folders.load_summary(folder / summary_name)
    thickness = run_folders.load_raster(prefix, "thickness")
    volume = summary["volume"]
    stays = volume["released"] - volume["off_grid"] - volume["lost"]
    on_grid = float(np.nansum(thickness.z)) * thickness.transform.a ** 2
    base = run_folders.load_raster(prefix, "surface").z - thickness.z
    left = deposit.Deposit(str(prefix), thickness, base, summary, None)
    length = run_length.measure_run_length(left, terrain_of(folder, log))
    return {"variables": begun.get("variables") or {},
            "stop_angle_deg": site_ground.of_variables(begun.get("variables")), "ranks": begun.get("ranks"),
            "package": begun.get("package"),
            **of_length(length), "left": gone.list_gone_groups(left),
            "ball_m3": volume["released"] / summary["balls"]["released"],
            "mass_error": (on_grid - stays) / volume["released"],
            **quantities.of_summary(summary), **judged.list_ending_columns(summary, log),
            "change_rate": summary.get("change_rate"), "wall_s": marker.get("wall_seconds"), "summary": summary_name,
            "slope_version": summary["slope_version"], "lammps_version": summary["lammps_version"],
            "lmp_sha256": begun.get("lmp_sha256"), **structures.read_run_structures(folder, log.settings)}


def of_length(length: Optional[run_length.RunLength]) -> Dict[str, Any]:
    """The columns of a run's length, None where there is no deposit."""
    return {"length_m": length and length.distance,
            "length_is": length and (run_length.ON_PATH if length.on_path else run_length.STRAIGHT),
            "length_by_lobe_m": length and list(length.others), "length_deg": length and length.angle}


def of_division(divided: Optional[Mapping[str, Any]], left: Optional[Mapping[str, Any]]) -> Dict[str, Any]:
    """Those of the mass on both sides of a road, by `divided` and `left` of volume.yaml; None is not known."""
    def of(key: str) -> Any:
        return divided and divided[key]
    return {"before_road_m3": of("before"), "on_road_m3": of("on"), "beyond_road_m3": of("past"),
            "past_end_m3": of("past_end"), "unknown_m3": of("unknown"), "left": left and left["sides"],
            "left_before_road_m3": left and left["road_ahead"]}


def with_road(run: Repeat, road: Road, row: Finished) -> Finished:
    """With what `slope volume` says of it, which goes to the folder volume of the run, without the picture, and is kept
    there; and with what lies beyond."""
    def read() -> Tuple[OnRoad, Any]:
        content = kept.make_once(("road", road.file), lambda: file_parts.digest_content(str(road.file)))
        made_of = {"run": state_of(run), "road": road._replace(file=Path(road.file.name))._asdict(), "file": content}
        folder = run.folder / quantities.volume_folder(road.name)
        found = kept.value(folder / "row.json", made_of, functools.partial(measured_on, road, run, row),
                           lambda: [folder / name for name in ("volume.yaml", "volume.tif", "volume_mesh.tif")])
        return records.read_record(OnRoad, found), found["left"]
    on_road, left = kept.make_once((run.folder, disk.stamp_of(run.marker), road), read)
    return replace(row, road=on_road, left=left)


def measured_on(road: Road, run: Repeat, row: Finished) -> Dict[str, Any]:
    """The fields of an OnRoad; left: what left the terrain, by the sides of the road."""
    from ..deposits import volume
    prefix = prefix_of(run)
    terrain, thickness = terrain_of(run.folder, run.log), run_folders.load_raster(prefix, "thickness")
    wanted = volume.Wanted(road.file, road.mesh, road.cut_angle, road.local, asked=road.asked)
    removal = volume.compute_removal(str(prefix), wanted, terrain)
    volume.write_removal(removal, run.folder / quantities.volume_folder(road.name), picture=False)
    numbers = disk.make_plain(removal.about)       # numpy has no place in study.yaml
    released = run_folders.load_raster(prefix, "arrival").z == 0
    polygon, total = road.read(placed(thickness, run)).polygon, numbers["clearing"]
    taken = release_toe.on_body(body_depth.body_of(released, thickness, row.ball_m3), thickness, polygon,
                                release_toe.rim(row.ball_m3, thickness.transform.a))
    if taken:
        removal.warnings.append(taken.finding(road.file.name))
    return {"road_on_body_m2": taken.area if taken else 0.0, "remove_m3": numbers["volume"]["remove"],
            "remove_on_road_m3": numbers["volume"]["remove_on_road"],
            "remove_beside_road_m3": numbers["volume"]["remove_beside_road"],
            **of_division(numbers["divided"], numbers["left"]),
            "blocked_m": total["blocked_length"], "axis_thickness_m": numbers["axis"]["largest_thickness"],
            "remove_lane_m3": total.get("remove_lane"), "lane_hours": total.get("hours_lane"),
            "clear_hours": total.get("hours"), "stretches": numbers["stretches"], "clearing": total,
            "axis_m": numbers["axis"]["length"], "by_10_m": numbers["by_10_m"],
            # what it says of the summary is in the table
            "road_warnings": encode_findings(in_folder(one, run.folder) for one in removal.warnings
                                             if one.kind not in OF_SUMMARY)}


def in_folder(finding: Finding, folder: Path) -> Finding:
    """The same, whose files are named as from a run's folder: one warning for all runs."""
    return finding._replace(numbers={name: value.replace(f"{folder}/", "") if isinstance(value, str) else value
                                     for name, value in finding.numbers.items()})


def placed(raster: rasters.Raster, run: Repeat) -> rasters.Raster:
    """The raster with the CRS and the offset of the run's terrain."""
    place = terrain_place(run)
    return raster._replace(crs=place.crs, offset=place.offset) if place else raster


def terrain_place(run: Repeat) -> Optional[rasters.Place]:
    """CRS and offset of the runs' local metres, from the sidecar of their terrain; None without one."""
    return rasters.read_sidecar(run.folder / run.log.terrain) if run.log.terrain else None


def terrain_of(folder: Path, log: logs.Log) -> Optional[Path]:
    """The terrain file of a run, None without one."""
    return folder / log.terrain if log.terrain else None
