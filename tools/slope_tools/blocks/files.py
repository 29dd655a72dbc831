"""What a study of blocks writes: every block and every result as tables, and files for a GIS."""
from pathlib import Path
from typing import Dict, Iterator, List, Tuple

import numpy as np
from shapely.geometry import LineString, Point

from .. import disk, provenance
from ..case import run_folders
from ..deposits import dumps
from ..deposits.flow_path import snapshots
from ..findings import encode_findings
from ..survey import geopackage, rasters
from ..survey.rasters import Raster
from .runs import PREFIX, QUANTITIES, Run, find_farthest_run
from .site import SHOWN

LARGEST = {"max_speed": "m/s", "max_energy": "J"}       # rasters, over all runs
RESULTS, BLOCKS, RETAINED, GIS = "blocks.yaml", "blocks.csv", "retained.csv", "blocks.gpkg"
NAMES = [*(f"{name}.tif" for name in LARGEST), GIS]


def write_block_files(folder: Path, known) -> None:
    """All of it; known: study.Known."""
    with disk.complete(folder, RESULTS) as new:
        columns, rows = tabulate_blocks(known.runs)
        disk.write_file(new / BLOCKS, disk.csv_text(columns, rows))
        disk.write_file(new / RETAINED, disk.csv_text(("rolling", "ditch_m", "retained_percent", "low", "high"), (
            [one.rolling, width, *(100 * value for value in (share.share, share.low, share.high))]
            for one in known.outcome.results for width, share in zip(known.outcome.widths, one.retained))))
        write_gis(new, known)
        disk.write_yaml(new / RESULTS, {"slope_version": provenance.version(), "made": provenance.now(),
                                        **known.outcome.about(), "warnings": encode_findings(known.doubts)},
                        "slope study of single blocks: by block; m, m/s, J; bounds of 90 %")


def tabulate_blocks(runs: List[Run]) -> Tuple[List[str], List[list]]:
    """A row for each block."""
    columns = ["rolling", "ground", "block", "diameter_m", *(f"start_{axis}" for axis in "xyz"), "end_x", "end_y",
               *(f"{name}_m" for name in runs[0].travel), "left", "moving", "reached_road", "passed_road",
               *(f"{place}_{name}" for place in runs[0].at for name in QUANTITIES)]
    rows = []
    for one in runs:
        lines = [values for of in one.at.values() for values in of.values()]
        numbers = np.column_stack([one.diameter, one.start, one.end, *one.travel.values(), one.left, one.moving,
                                   one.reached, one.passed, *lines])
        rows += [[one.rolling, one.ground, k, *("" if np.isnan(value) else f"{value:.7g}" for value in row)]
                 for k, row in enumerate(numbers.tolist(), 1)]
    return columns, rows


def combine_largest(runs: List[Run], name: str, place: Raster) -> Raster:
    """A raster's largest values over runs, as they are, in the place of a terrain."""
    several = [run_folders.load_raster(one.folder / PREFIX, name, heights=False) for one in runs]
    most = np.fmax.reduce([one.z for one in several])
    return several[0]._replace(z=most, crs=place.crs, offset=place.offset)


def paths(runs: List[Run]) -> Iterator[Tuple[Run, int, np.ndarray]]:
    """(run, block, x y z at each snapshot) of up to SHOWN blocks, as many of each run; the farthest block is among
    them if snapshots have it."""
    each, farthest = max(1, SHOWN // len(runs)), find_farthest_run(runs)
    most = int(farthest.travel["distance"].argmax()) + 1
    some = {farthest.name, *(one.name for one in runs[::-(-len(runs) // (SHOWN - 1))])}
    for run in (one for one in runs if one.name in some):
        blocks = np.arange(1, min(each, len(run.start)) + 1)
        if run is farthest and each < most <= SHOWN:
            blocks[-1] = most
        series: Dict[int, List[np.ndarray]] = {block: [run.start[block - 1]] for block in blocks.tolist()}
        for path in snapshots(run.folder, 10 ** 12):
            for columns, rows in dumps.frames(path):
                for row in rows[np.isin(rows[:, 0], blocks)]:
                    series[int(row[0])].append(row[columns.index("x"):columns.index("z") + 1])
        yield from ((run, block, np.array(places)) for block, places in series.items())


def write_gis(folder: Path, known) -> None:
    """Of all runs: the largest speed and energy, paths of some blocks, and where all end."""
    raster = known.terrain.raster
    for name, unit in LARGEST.items():
        over_all = combine_largest(known.runs, name, raster)
        rasters.write_geotiff(folder / f"{name}.tif", {f"largest over all runs ({unit})": over_all.z}, over_all)
    about = {"rolling": "float", "ground": "int", "block": "int"}
    ends = {**about, "diameter_m": "float", "distance_m": "float", "left": "int", "reached": "int", "passed": "int"}
    geopackage.write_geopackage(folder / GIS, {
        "paths": geopackage.Layer("3D LineString", about, (
            (LineString(places), {"rolling": float(one.rolling), "ground": one.ground, "block": block})
            for one, block, places in paths(known.runs) if len(places) > 1)),
        "ends": geopackage.Layer("Point", ends, (
            (Point(place), {"rolling": float(one.rolling), "ground": one.ground, "block": k + 1,
                            "diameter_m": one.diameter[k], "distance_m": one.travel["distance"][k],
                            **{name: int(getattr(one, name)[k]) for name in ("left", "reached", "passed")}})
            for one in known.runs for k, place in enumerate(one.end)))}, raster)
