"""What came out of a study: the table, the maps over all runs, and the conservative volume."""
import argparse
import contextlib
import csv
import io
import sys

import numpy as np
import yaml
from rich.console import Console
from rich.table import Table

from . import rasters, runs
from .errors import SlopeError

BALANCE = 1e-9          # of the released volume


def warn(text):
    print(f"slope study: warning: {text}", file=sys.stderr)


def as_number(text):
    """A value as a float where it is one, so that 0.1 and 0.10 are one value; else the text."""
    try:
        return float(text)
    except ValueError:
        return text


def collect(args, settings, todo, work, thresholds):
    """Table, maps and study.yaml over all runs that finished."""
    output, deck = args.output, args.deck
    maps = Maps(thresholds)
    warnings, rows = [], []
    for one in rasters.progress(todo, "collecting the runs"):
        row = {"run": one.name, "status": "failed" if one.error else "finished", "set": one.chosen}
        if one.error:
            rows.append({**row, "error": one.error, "log_warnings": one.log.warnings})
            continue
        row, thickness = result(one, row, maps)
        if args.road:
            row.update(on_road(one, args, output / row["summary"], thickness))
        rows.append(row)
    for row in rows:
        if row["status"] == "failed":
            warnings.append(f"{row['run']}: failed: {row['error']}")
            continue
        if row["moving"]:
            warnings.append(f"{row['run']}: the deposit still moves at the end, {row['stop_time_s']:.1f} s: its "
                            f"numbers are not those of a deposit at rest ({100 * row['moving_share']:.0f} % of the "
                            f"volume moves)")
        left = row["off_grid_m3"] + row["lost_m3"]
        if left > 1e-6 * row["released_m3"]:
            warnings.append(f"{row['run']}: {left:.6g} m3 left the grid or the box")
        if not abs(row["mass_error"]) <= BALANCE:
            warnings.append(f"{row['run']}: the volume in the thickness raster differs from released - off the grid - "
                            f"lost by {row['mass_error']:.1e} of the released volume")
    finished = [row for row in rows if row["status"] == "finished"]
    of_road = {}
    for row in finished:
        for text in row.get("road_warnings", ()):
            of_road.setdefault(text, []).append(row["run"])
    for text, names in of_road.items():
        warnings.append(text if len(names) == len(finished) else f"{', '.join(names)}: {text}")
    for what in ("slope_version", "lammps_version", "lmp_sha256"):
        if len({row[what] for row in finished}) > 1:
            warnings.append(f"the runs are of different programs: {what} "
                            + ", ".join(sorted({str(row[what]) for row in finished})))
    if maps.problem:
        warnings.append(maps.problem)
    first = next((one for one in todo if not one.error), None)
    written = maps.write(output, terrain_place(first) if first else None)
    about = {
        "study": {"deck": deck.name, "set": settings, "runs": len(rows), "finished": len(finished),
                  "ranks": work.ranks, "jobs": work.jobs, "package": work.package, "collected": runs.now(),
                  "machine": runs.machine()},
        "largest": {key: largest(finished, key) for key in ("front_m", "thickness_m", "max_thickness_m",
                                                            "max_speed_m_s") if finished},
        "conservative": None, **written, "warnings": warnings, "runs": rows}
    if args.road and finished:
        about["study"]["road"] = write_road(args, first, thickness)
        about["conservative"] = conservative(settings, rows, finished)
    for text in warnings:
        warn(text)
    runs.write(output / "study.csv", table(settings, rows))
    runs.write(output / "study.yaml", "# slope study: volumes in m3 of ground (bulk), lengths in m, times in s\n"
               + yaml.safe_dump(about, sort_keys=False))
    print_table(settings, rows, f"{deck.name}: {len(rows)} runs, volumes in m3 of ground")
    print(f"{output / 'study.yaml'}, {output / 'study.csv'}: all numbers")
    if about["conservative"]:
        print(told(about["conservative"]))
    for entry in [*(written["envelope"] or {}).values(), *(written["exceedance"] or ())]:
        print(f"{output / entry['file']}: {entry['what']}")


def result(one, row, maps):
    """The row of a finished run, and its final thickness; adds its rasters to the maps."""
    marker = runs.load_yaml(one.marker, "what `slope study` wrote")
    path = one.folder / str(marker.get("summary"))
    about = runs.load_yaml(one.folder / runs.VARIABLES, "what `slope study` wrote")
    summary = runs.load_summary(path)
    prefix = runs.prefix_of(path)
    thickness = runs.load_raster(prefix, "thickness")
    maps.add(one.name, thickness, runs.load_raster(prefix, "max_thickness"))
    one.log.update()
    volume, travel = summary["volume"], summary["travel"]
    stays = volume["released"] - volume["off_grid"] - volume["lost"]
    on_grid = float(np.nansum(thickness.z)) * thickness.transform.a ** 2
    row = {**row, "variables": about.get("variables"), "ranks": about.get("ranks"), "package": about.get("package"),
            "released_m3": volume["released"],
            "on_grid_m3": volume["on_grid"], "off_grid_m3": volume["off_grid"], "lost_m3": volume["lost"],
            "residual_m3": volume["residual"], "mass_error": (on_grid - stays) / volume["released"],
            "front_m": travel["front"], "reach_angle_deg": travel["reach_angle"], "centroid_m": travel["centroid"],
            "thickness_m": summary["largest"]["thickness"], "max_thickness_m": summary["largest"]["max_thickness"],
            "max_speed_m_s": summary["largest"]["max_speed"], "stop_time_s": summary["stop"]["time"],
            "stop_reason": summary["stop"]["reason"], "moving": summary["moving"],
            "moving_share": summary["motion"]["moving_share"], "change_rate": summary.get("change_rate"),
            "wall_s": marker.get("wall_seconds"), "summary": f"{one.name}/{path.name}",
            "slope_version": summary["slope_version"], "lammps_version": summary["lammps_version"],
            "lmp_sha256": about.get("lmp_sha256"), "log_warnings": one.log.warnings}
    return row, thickness


def on_road(one, args, summary, thickness):
    """What `slope volume` says of a run, all of which goes to the folder volume of the run; and what lies beyond."""
    from . import polygons, volume
    parser = argparse.ArgumentParser()
    volume.add_parser(parser.add_subparsers())
    words = ["volume", str(runs.prefix_of(summary)), "--road", str(args.road), "--cut-angle", str(args.cut_angle),
             "--mesh", str(args.mesh), "-o", str(one.folder / "volume")]
    if one.log.terrain:
        words += ["--terrain", str(one.folder / one.log.terrain)]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        volume.run(parser.parse_args(words + ["--local"] * args.local))
    about = runs.load_yaml(one.folder / "volume" / "volume.yaml", "what `slope volume` wrote")
    return {"remove_m3": about["volume"]["remove"], "remove_on_road_m3": about["volume"]["remove_on_road"],
            "remove_beside_road_m3": about["volume"]["remove_beside_road"],
            "beyond_road_m3": beyond(thickness, runs.load_raster(runs.prefix_of(summary), "arrival").z == 0,
                                     polygons.read_local(args.road, placed(thickness, one), args.local)),
            "blocked_m": about["axis"]["blocked_length"], "axis_thickness_m": about["axis"]["largest_thickness"],
            # what it says of the summary is in the table
            "road_warnings": [text.replace(f"{one.folder}/", "") for text in about["warnings"]
                              if not text.startswith(f"{summary}:")]}


def beyond(thickness, released, road):
    """Volume (m3) on those parts of the grid that the road (local metres) cuts off from the released mass (a mask).

    None if the road does not divide the grid.
    """
    from shapely.geometry import box
    from . import deposit
    rows, columns = thickness.z.shape
    lines = np.arange(columns + 1.0), np.arange(rows + 1.0)
    parts = deposit.polygons_of(box(0, 0, columns, rows).difference(deposit.to_index(road, thickness)))
    shares = [deposit.coverage(part, *lines)[0] for part in parts]
    shares = [share for share in shares if share.sum() > 1e-6]
    if len(shares) < 2:
        return None
    shares.sort(key=lambda share: (share * released).sum())     # the last one is where the mass comes from
    return float(sum((share * thickness.z).sum() for share in shares[:-1]) * thickness.transform.a ** 2)


def placed(raster, one):
    """The raster with the CRS and the offset of the run's terrain."""
    place = terrain_place(one)
    return raster._replace(crs=place.crs, offset=place.offset) if place else raster


def write_road(args, one, thickness):
    """Keep the road, in local metres, with the study; what study.yaml says of it."""
    from . import polygons
    raster = placed(thickness, one)
    polygons.write(args.output / "road.csv", polygons.read_local(args.road, raster, args.local), raster)
    return {"file": args.road.name, "local": "road.csv", "cut_angle": args.cut_angle, "mesh": args.mesh}


def read_study(path):
    """study.yaml as a dict, with all that its readers take from it; SlopeError if something is missing."""
    what = "what `slope study` wrote"
    study = runs.load_yaml(path, what)
    try:
        rows, about, best = study["runs"], study["study"], study["conservative"]
        if not all(isinstance(several, list) for several in about["set"].values()):
            raise ValueError("set")
        if not any(row["status"] == "finished" for row in rows):
            raise SlopeError(path, "must have a finished run", f"{len(rows)} that failed")
        for row in rows:
            if not (isinstance(row["run"], str) and row["set"].keys() == about["set"].keys()):
                raise ValueError("runs")
            if row["status"] == "finished":
                check_row(f"{path}: run {row['run']}", row, best)
        names = [row["run"] for row in rows if row["status"] == "finished"]
        if not all(one is None or one["run"] in names for one in (best, study["largest"]["front_m"])):
            raise ValueError("conservative, largest")
        if best and not (runs.is_number(best["remove_m3"]) and about.get("road")):
            raise ValueError("conservative")
        if about.get("road") and not all(runs.is_number(about["road"][key]) for key in ("cut_angle", "mesh")):
            raise ValueError("road")
        for entry in study.get("exceedance") or ():
            if not all(runs.is_number(entry[key]) for key in EXCEEDANCE):
                raise ValueError("exceedance")
        if study.get("envelope"):
            study["envelope"]["max_thickness"]["file"]
        str(about["deck"]), int(about["runs"]), int(about["finished"])
    except (KeyError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise SlopeError(path, f"must be {what} ({error!r})") from error
    return study


def check_row(where, row, road):
    """SlopeError if the row of a finished run lacks a column, or has no number there."""
    for key in (*COLUMNS, "moving_share", *(ROAD_COLUMNS if road else ())):
        if key not in row:
            raise SlopeError(where, f"must have {key}: it is of another version; `slope study` with the same "
                             "arguments writes it anew, and keeps the runs")
        if key in ("moving", "stop_reason") or (key in ("wall_s", "beyond_road_m3") and row[key] is None):
            continue
        if not runs.is_number(row[key]):
            raise SlopeError(where, f"{key} must be a finite number", repr(row[key])[:60])
    if not isinstance(row["moving"], bool):
        raise SlopeError(where, "moving must be true or false", repr(row["moving"])[:60])
    if not isinstance(row["summary"], str):
        raise SlopeError(where, "summary must be the name of a file", repr(row["summary"])[:60])


def conservative(settings, rows, finished):
    """The largest volume to remove, which run gave it, and what speaks against taking it as the largest."""
    best = max(finished, key=lambda row: row["remove_m3"])
    doubts = []
    if len(rows) == 1:
        doubts.append("nothing was varied, it is of one run")
    if len(finished) < len(rows):
        doubts.append(f"{len(rows) - len(finished)} of {len(rows)} runs failed")
    moving = sum(row["moving"] for row in finished)
    if moving:
        doubts.append(f"{moving} of {len(finished)} deposits still move")
    for name, several in settings.items():
        numbers = [as_number(value) for value in several]
        value = as_number(best["set"][name])
        if len(several) > 1 and all(isinstance(one, float) for one in numbers) and value != 0 \
                and value in (min(numbers), max(numbers)):
            doubts.append(f"it lies at the end of the range of {name}, {min(numbers):g} to {max(numbers):g}")
    return {"remove_m3": best["remove_m3"], "run": best["run"], "doubts": doubts}


def told(best):
    return (f"conservative volume to remove: {best['remove_m3']:,.0f} m3, run {best['run']}"
            + "".join(f"; {doubt}" for doubt in best["doubts"]))


def terrain_place(one):
    """CRS and offset of the runs' local metres, from the sidecar of their terrain; None without one."""
    return one.log.terrain and rasters.read_sidecar(one.folder / one.log.terrain)


def largest(rows, key):
    """The largest value of a column and the first run that has it."""
    best = max(rows, key=lambda row: row[key])
    return {"value": best[key], "run": best["run"]}


def same_grid(one, other):
    return one.z.shape == other.z.shape and one.transform.almost_equals(other.transform)


class Maps:
    """Over all runs, cell by cell: the largest thickness, and how many runs exceed a threshold."""

    def __init__(self, thresholds):
        self.thresholds = thresholds
        self.grid = self.problem = None
        self.count, self.first = 0, None

    def add(self, name, thickness, max_thickness):
        if self.grid is None:
            self.grid, self.first = thickness, name
            shape = thickness.z.shape
            self.envelope = {"thickness": np.zeros(shape), "max_thickness": np.zeros(shape)}
            self.exceeding = [np.zeros(shape, int) for _ in self.thresholds]
        elif not self.problem and not same_grid(thickness, self.grid):
            self.problem = (f"no maps over all runs: the rasters of {name} have another grid than those of "
                            f"{self.first}")
        if self.problem:
            return
        for key, raster in (("thickness", thickness), ("max_thickness", max_thickness)):
            np.fmax(self.envelope[key], raster.z, out=self.envelope[key])
        for threshold, exceeding in zip(self.thresholds, self.exceeding):
            exceeding += thickness.z > threshold
        self.count += 1

    def write(self, output, place):
        """Write all rasters, remove those of an earlier call; what study.yaml says of them."""
        written = {"envelope": None, "exceedance": None}
        kept = set()
        if self.grid is not None and not self.problem:
            area = self.grid.transform.a ** 2

            def write(name, z, what):
                raster = self.grid._replace(z=z)
                if place:
                    raster = raster._replace(crs=place.crs, offset=place.offset)
                path = output / f"{name}.asc"
                rasters.write_asc_local(path, raster, {"what": what})
                kept.update((path, path.with_suffix(".yaml")))
                if raster.crs is not None:
                    rasters.write_geotiff(path.with_suffix(".tif"), {what: z}, raster)
                    kept.add(path.with_suffix(".tif"))
                return {"file": path.name, "what": what}

            written["envelope"] = {
                key: {**write(f"envelope_{key}", z, what), "largest_m": float(z.max()),
                      "area_m2": float((z > 0).sum() * area)}
                for (key, z), what in zip(self.envelope.items(), (
                    "largest final thickness over all runs, m", "largest thickness over all runs and times, m"))}
            written["exceedance"] = [
                {"threshold_m": threshold,
                 **write(f"exceedance_{threshold:g}m", exceeding / self.count,
                         f"share of the runs with a final thickness > {threshold:g} m"),
                 "area_in_any_run_m2": float((exceeding > 0).sum() * area),
                 "area_in_every_run_m2": float((exceeding == self.count).sum() * area)}
                for threshold, exceeding in zip(self.thresholds, self.exceeding)]
        for path in [*output.glob("envelope_*"), *output.glob("exceedance_*")]:
            if path not in kept:
                path.unlink()
        return written


COLUMNS = ("released_m3", "on_grid_m3", "off_grid_m3", "lost_m3", "residual_m3", "front_m", "reach_angle_deg",
           "centroid_m", "thickness_m", "max_thickness_m", "max_speed_m_s", "stop_time_s", "stop_reason", "moving",
           "wall_s")
ROAD_COLUMNS = ("remove_m3", "remove_on_road_m3", "remove_beside_road_m3", "beyond_road_m3", "blocked_m",
                "axis_thickness_m")


def table(settings, rows):
    """The CSV over all runs."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    columns = [*COLUMNS, *(ROAD_COLUMNS if any("remove_m3" in row for row in rows) else ()), "status", "error"]
    writer.writerow(["run", *settings, *columns])
    for row in rows:
        cells = {**row, "moving": {True: "yes", False: "no"}.get(row.get("moving"))}
        writer.writerow([row["run"], *row["set"].values(), *(cells.get(key) for key in columns)])
    return text.getvalue()


EXCEEDANCE = ("threshold_m", "area_in_any_run_m2", "area_in_every_run_m2")

SHOWN = {"released_m3": ("released", "{:,.0f}"), "on_grid_m3": ("on grid", "{:,.0f}"), "lost_m3": ("lost", "{:,.0f}"),
         "residual_m3": ("residual", "{:.0e}"), "front_m": ("front m", "{:.1f}"),
         "reach_angle_deg": ("reach deg", "{:.1f}"), "centroid_m": ("centroid m", "{:.1f}"),
         "stop_time_s": ("stop s", "{:.1f}"), "stop_reason": ("reason", "{}"), "moving": ("moving", "{}"),
         "wall_s": ("wall s", "{:.0f}")}
SHOWN_ROAD = {"remove_m3": ("to remove", "{:,.0f}"), "remove_on_road_m3": ("on the road", "{:,.0f}"),
              "beyond_road_m3": ("beyond it", "{:,.0f}"), "blocked_m": ("blocked m", "{:.0f}")}


def print_table(settings, rows, title):
    shown = Table(title=title)
    columns = {**SHOWN, **(SHOWN_ROAD if any("remove_m3" in row for row in rows) else {})}
    same = {name: several[0] for name, several in settings.items() if len(several) == 1}
    if same:
        shown.caption = "in all runs " + ", ".join(f"{name} {value}" for name, value in same.items())
    varied = [name for name in settings if name not in same]
    for head in (*varied, *(head for head, _ in columns.values())):
        shown.add_column(head, justify="right")
    for row in rows:
        cells = [row["set"][name] for name in varied]
        if row["status"] == "failed":
            cells += ["failed"]
        else:
            cells += ["-" if row[key] is None else
                      form.format({True: "YES", False: "no"}[row[key]] if key == "moving" else row[key])
                      for key, (_, form) in columns.items()]
        shown.add_row(*cells)
    console = Console() if sys.stdout.isatty() else Console(width=160)
    console.print(shown)
