"""slope volume: what must be removed from a road, per mesh cell and in total, above a cut that rises from its edges.

Order of the work: read the run, the road and its axis; cut (cut.py); sum per mesh cell; write tables and maps.
"""
import argparse
import math
from pathlib import Path

import numpy as np

from .. import disk, errors
from ..deposit import cut, deposit, volume_files
from ..deposit.road_axis import along, eastward, middle, stretches
from ..deposit.volume import SAMPLES, evaluate, in_grid, make_mesh
from ..deposit.volume_files import write_csv, write_geojson, write_profile
from ..errors import SlopeError
from ..options import number
from ..survey import polygons, rasters
from ..survey.lines import read_local
from ..survey.rasters import crs_name

CUT_ANGLE = 30.0       # degrees
BLOCKED = 0.1          # m
MOST_SAMPLES = 32
EPILOG = """\
units: metres, m3, degrees. PREFIX is what fix deposit/grid was given as output.

example: meshes of 10 m, the road from a GIS, and the volume also as loosened ground (bulk factor 2.3):
  tools/slope volume embankment --road route4.geojson --cut-angle 30 --mesh 10 --bulk 2.3 -o removal

Writes volume.yaml, volume.csv, volume.geojson, volume_mesh.tif, volume.tif, axis.csv and volume.png.
"""


def add_parser(commands, **kwargs):
    """Add `volume` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "volume", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Volume to remove from a road, per mesh cell and in total, above a cut surface that rises from "
                    "the road's edges.", **kwargs)
    parser.add_argument("prefix", metavar="PREFIX", help="output of fix deposit/grid: PREFIX.thickness.asc and so on")
    parser.add_argument("--road", metavar="POLYGON", required=True, type=Path,
                        help="the road: GeoJSON, shapefile, CSV or WKT")
    parser.add_argument("--cut-angle", metavar="DEG", type=number, default=CUT_ANGLE,
                        help=f"rise of the cut surface with distance from the road's edges, degrees (default "
                             f"{CUT_ANGLE:g})")
    parser.add_argument("--mesh", metavar="SIZE", type=number, required=True,
                        help="side of the mesh cells, m; their corners are at multiples of it in local x and y")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path,
                        help="folder for the results (default PREFIX.volume)")
    parser.add_argument("--terrain", metavar="TERRAIN.asc", type=Path,
                        help="the run's terrain, whose sidecar tells the CRS (default: terrain.asc beside PREFIX)")
    parser.add_argument("--local", action="store_true",
                        help="the road and the axis are in local metres, not in a CRS")
    parser.add_argument("--bulk", metavar="FACTOR", type=number,
                        help="tell the volumes for this bulk factor too (volume of ground / volume of the balls)")
    parser.add_argument("--axis", metavar="LINE", type=Path,
                        help="the road's axis: GeoJSON, shapefile, CSV or WKT (default: the road's middle)")
    parser.add_argument("--blocked", metavar="T", type=number, default=BLOCKED,
                        help=f"the road is blocked where the deposit on the axis is thicker, m (default {BLOCKED:g})")
    parser.add_argument("--samples", metavar="K", type=int, default=SAMPLES,
                        help=f"parts of a cell along a side for round corners and rough ground, even (default "
                             f"{SAMPLES}); planes are exact with any")
    parser.add_argument("--no-picture", action="store_true", help="without volume.png, which takes longest")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the totals."""
    check(args)
    warnings = []
    warn = errors.warner("volume", warnings)
    run_ = deposit.read(args.prefix, args.terrain, warn)
    folder = args.output or Path(f"{args.prefix}.volume")
    disk.check_folder(folder)
    mesh = make_mesh(args.mesh, run_.raster)
    road = in_grid(polygons.read_local(args.road, run_.raster, args.local), run_.raster, args.road, warn)
    if args.axis:
        axis, source = read_axis(args.axis, run_.raster, args.local), str(args.axis)
    else:
        axis, source = middle(road)
    try:
        result = evaluate(run_, road, args.cut_angle, mesh, args.samples)
    except cut.NoGround as error:
        x, y = run_.raster.transform * error.args[0]
        raise SlopeError(args.road, "ground at the edge of the road must have a height, it has none at",
                         f"{x:.3f} {y:.3f} (local metres)") from None
    profile = along(axis, run_, result.removed, args.blocked, args.axis or args.road)
    about = totals(args, run_, road, mesh, result, profile, source)
    if result.unknown > 0:
        warn(f"{result.unknown:.6g} m3 lie on cells without ground, beside the road: not counted as to be removed")
        about["volume"]["unknown"] = result.unknown
    about["warnings"] = warnings
    factor = args.bulk / run_.bulk if args.bulk else None
    with disk.complete(folder) as new:
        write_csv(new / "volume.csv", run_, mesh, result, factor)
        write_geojson(new / "volume.geojson", run_, mesh, result, factor)
        rasters.write_geotiff(new / "volume.tif", {"thickness to remove (m)": np.where(
            np.isfinite(run_.base) | (run_.raster.z > 0), result.removed, np.nan)}, run_.raster)
        rasters.write_geotiff(new / "volume_mesh.tif", {"volume to remove (m3)": result.volume},
                              run_.raster._replace(transform=mesh.transform))
        write_profile(new / "axis.csv", run_, profile)
        if not args.no_picture:
            volume_files.draw(new / "volume.png", run_, road, axis, mesh, result, about)
        about["files"] = sorted(path.name for path in new.iterdir()) + ["volume.yaml"]
        disk.write_yaml(new / "volume.yaml", about, "slope volume: what must be removed; m, m2, m3, degrees")
    print(summary(about, folder))


def check(args):
    """Check what can be checked before any reading."""
    if not 0 < args.cut_angle < 90:
        raise SlopeError("--cut-angle", "must be > 0 and < 90 degrees", f"{args.cut_angle:g}")
    if args.mesh <= 0:
        raise SlopeError("--mesh", "must be > 0", f"{args.mesh:g}")
    if args.bulk is not None and args.bulk <= 0:
        raise SlopeError("--bulk", "must be > 0", f"{args.bulk:g}")
    if args.blocked < 0:
        raise SlopeError("--blocked", "must be >= 0", f"{args.blocked:g}")
    if not (2 <= args.samples <= MOST_SAMPLES and args.samples % 2 == 0):
        raise SlopeError("--samples", f"must be even, 2 to {MOST_SAMPLES}", args.samples)


def read_axis(path, raster, local):
    """The line in a file, in local metres, from west to east; see lines.read_local."""
    return eastward(read_local(path, raster, local, "axis"))


def totals(args, run_, road, mesh, result, profile, source):
    """The content of volume.yaml."""
    place = run_.raster
    volume = {
        "deposit": result.total(result.deposit),
        "remove": result.total(result.volume),
        "remove_on_road": result.total(result.road),
        "remove_beside_road": result.total(result.beside),
        "remove_where_cut_below_ground": result.steep,
    }
    volume["stays"] = round(volume["deposit"] - volume["remove"], result.digits)
    thickest = int(np.argmax(profile["thickness"]))
    blocked = stretches(profile)
    about = {
        "prefix": run_.prefix, "road": args.road, "cut_angle": args.cut_angle,
        "terrain": run_.terrain, "crs": None if place.crs is None else crs_name(place.crs),
        "origin": {"east": place.offset[0], "north": place.offset[1]},
        "run": {"slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"],
                "moving": run_.summary["moving"]},
        "grid": {"cell": run_.cell, "samples": args.samples},
        "mesh": {"size": mesh.size, "cells": len(result.listed), "cells_to_clear": int((result.volume > 0).sum())},
        "bulk_factor": run_.bulk,
        "volume": volume,
    }
    if args.bulk:
        about["other_bulk_factor"] = args.bulk
        about["volume_at_other_bulk_factor"] = {key: round(value * args.bulk / run_.bulk, result.digits)
                                                for key, value in volume.items()}
    about["road_area"] = result.total(result.road_area)
    about["largest_removed_thickness"] = round(float(result.removed.max()), 6)
    about["axis"] = {
        "source": source,
        "length": round(profile["to"][-1], 6),
        "blocked_above": args.blocked,
        "blocked_length": round(math.fsum(to - start for start, to in blocked), 6),
        "blocked_stretches": [[round(start, 6), round(to, 6)] for start, to in blocked],
        "largest_thickness": round(profile["thickness"][thickest], 6),
        "largest_thickness_at": [round(profile[key][thickest], 3) for key in ("x", "y")],
    }
    return about


def summary(about, folder):
    """What the user needs to know."""
    volume, axis = about["volume"], about["axis"]
    lines = [f"to remove: {volume['remove']:.1f} m3 of {volume['deposit']:.1f} m3: {volume['remove_on_road']:.1f} m3 "
             f"on the road, {volume['remove_beside_road']:.1f} m3 beside it above a cut of "
             f"{about['cut_angle']:g} degrees",
             f"bulk factor {about['bulk_factor']:.6g}, the run's"]
    if "other_bulk_factor" in about:
        lines[-1] += (f"; at {about['other_bulk_factor']:.6g}: {about['volume_at_other_bulk_factor']['remove']:.1f} m3 "
                      "to remove")
    lines.append(f"axis: blocked over {axis['blocked_length']:.1f} of {axis['length']:.1f} m, where thicker than "
                 f"{axis['blocked_above']:g} m; up to {axis['largest_thickness']:.2f} m")
    lines.append(f"mesh of {about['mesh']['size']:g} m: {about['mesh']['cells_to_clear']} cells to clear")
    lines.append(f"written to {folder}: {' '.join(about['files'])}")
    return "\n".join(lines)
