"""slope score: a run's deposit against a mapped one.

Mapped is a polygon, or a raster of thickness. Areas are exact: a simulated deposit is made of whole cells, and the
polygon is cut by them; a mapped raster on another grid is spread over the run's cells by the areas that they share.
"""
import argparse
from pathlib import Path

from .. import disk, errors
from ..deposit import deposit, score
from ..deposit.score import (balls, connected_runout, mesh_table, overlap, read_observed, runout, volumes,
                             write_csv)
from ..deposit.volume import make_mesh
from ..errors import SlopeError
from ..options import number
from ..survey.rasters import crs_name

THRESHOLD = 0.1   # m
EPILOG = """\
units: metres, m2, m3, degrees. PREFIX is what fix deposit/grid was given as output.

example: the mapped outline of the deposit; a thickness raster from two surveys, errors per mesh cell of 20 m:
  tools/slope score embankment --observed mapped.geojson -o score
  tools/slope score embankment --observed thickness.tif --mesh 20 -o score

Writes score.yaml, score.csv (one row per cell of the run or of the mesh) and score.png.
"""


def add_parser(commands, **kwargs):
    """Add `score` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "score", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="A run's deposit against a mapped one: overlap, run-out, volume.", **kwargs)
    parser.add_argument("prefix", metavar="PREFIX", help="output of fix deposit/grid: PREFIX.thickness.asc and so on")
    parser.add_argument("--observed", metavar="POLYGON|RASTER", required=True, type=Path,
                        help="the mapped deposit: its outline (GeoJSON, shapefile, CSV, WKT), or its thickness in "
                             "metres (GeoTIFF, ESRI ASCII grid; NODATA is no deposit)")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path,
                        help="folder for the results (default PREFIX.score)")
    parser.add_argument("--threshold", metavar="T", type=number, default=THRESHOLD,
                        help=f"a deposit is where it is thicker than this, m (default {THRESHOLD:g})")
    parser.add_argument("--mesh", metavar="SIZE", type=number,
                        help="side of the mesh cells of score.csv, m; their corners are at multiples of it in local x "
                             "and y (default: the cells of the run)")
    parser.add_argument("--terrain", metavar="TERRAIN.asc", type=Path,
                        help="the run's terrain, whose sidecar tells the CRS (default: terrain.asc beside PREFIX)")
    parser.add_argument("--local", action="store_true", help="the mapped deposit is in local metres, not in a CRS")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the scores."""
    if args.threshold < 0:
        raise SlopeError("--threshold", "must be >= 0", f"{args.threshold:g}")
    if args.mesh is not None and args.mesh <= 0:
        raise SlopeError("--mesh", "must be > 0", f"{args.mesh:g}")
    warnings = []
    warn = errors.warner("score", warnings)
    run_ = deposit.read(args.prefix, args.terrain, warn)
    folder = args.output or Path(f"{args.prefix}.score")
    disk.check_folder(folder)
    mesh = make_mesh(args.mesh or run_.cell, run_.raster)
    observed = read_observed(args.observed, run_.raster, args.threshold, args.local)
    if observed.outside > 0:
        warn(f"{args.observed}: {observed.outside:.6g} m2 of it lie outside of the grid of the run: counted as not met")
    simulated = run_.raster.z > args.threshold
    if not simulated.any():
        warn(f"{run_.prefix}.thickness.asc is nowhere thicker than {args.threshold:g} m")
    about = {"prefix": run_.prefix, "observed": args.observed, "terrain": run_.terrain,
             "crs": None if run_.raster.crs is None else crs_name(run_.raster.crs),
             "run": {"slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"],
                     "moving": run_.summary["moving"]},
             "threshold": args.threshold, "cell": run_.cell, "mesh": mesh.size,
             "area": overlap(simulated, observed, run_.cell),
             "runout": {**runout(run_, simulated, observed), "balls": balls(run_),
                        "connected": connected_runout(run_, args.threshold, observed)}}
    table = mesh_table(run_, simulated, observed, mesh)
    if observed.thickness is not None:
        about["bulk_factor"] = run_.bulk
        about["volume"] = volumes(run_, observed, table)
    about["warnings"] = warnings
    with disk.complete(folder) as new:
        write_csv(new / "score.csv", run_, mesh, table)
        score.draw(new / "score.png", run_, simulated, observed, about)
        about["files"] = ["score.csv", "score.png", "score.yaml"]
        disk.write_yaml(new / "score.yaml", about, "slope score: simulated against mapped; m, m2, m3, degrees")
    print(summary(about, folder))


def summary(about, folder):
    """What the user needs to know."""
    area, out = about["area"], about["runout"]
    jaccard = "none" if area["jaccard"] is None else f"{area['jaccard']:.3f}"
    lines = [f"thicker than {about['threshold']:g} m: {area['true_positive']:.1f} m2 in both, "
             f"{area['false_positive']:.1f} m2 simulated only, {area['false_negative']:.1f} m2 mapped only; "
             f"Jaccard {jaccard}"]
    if out["difference"] is not None:
        lines.append(f"run-out: {out['simulated']:.1f} m simulated, {out['observed']:.1f} m mapped: "
                     f"{out['difference']:+.1f} m")
    if out["connected"] is not None and "difference" in out["connected"]:
        part = out["connected"]
        lines.append(f"connected deposit, {100 * part['share_of_volume']:.1f} % of the volume: "
                     f"{part['distance']:.1f} m, {part['difference']:+.1f} m")
    if out.get("quantiles"):
        most = out["quantiles"][-1]
        lines.append(f"{100 * most['share']:g} % of the {out['quantiles_of']}: within {most['simulated']:.1f} m "
                     f"simulated, {most['observed']:.1f} m mapped: {most['difference']:+.1f} m")
    if "volume" in about:
        volume = about["volume"]
        lines.append(f"volume: {volume['simulated']:.1f} m3 simulated (bulk factor {about['bulk_factor']:.6g}), "
                     f"{volume['observed']:.1f} m3 mapped: {volume['error']:+.1f} m3")
    lines.append(f"written to {folder}: {' '.join(about['files'])}")
    return "\n".join(lines)
