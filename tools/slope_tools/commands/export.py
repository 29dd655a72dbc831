"""slope export: every raster of a run as a GeoTIFF in the coordinates of the survey, for a GIS; or zones."""
from pathlib import Path
from typing import List

from .. import disk, warned
from ..case import run_folders
from ..deposits import deposit
from ..deposits.export import file_of, layers, write
from ..errors import SlopeError
from ..options import add_overwrite, number
from ..survey import rasters
from ..survey.rasters import crs_name

DESCRIPTION = "Every raster of a run as a GeoTIFF in the coordinates of the survey."
EPILOG = """\
units: metres, m/s, J, s. PREFIX is what fix deposit/grid was given as output.

examples: the rasters of a run, for QGIS; of a site, its governing run; of a run in another folder than its terrain:
  tools/slope export embankment
  tools/slope export mine
  tools/slope export study/rolling_0.05/embankment --terrain terrain.asc -o gis

zones of a study or a route: polygons in which a mass thicker than 0.5 m has at least these probabilities, per year
where a route has a hazard, else as shares of the runs; classes of intensity against return periods:
  tools/slope export mine --zones 0.9,0.5,0.1 --thicker 0.5
  tools/slope export route --zones 1/100,1/1000,1/5000 --intensity speed:1,5 -o zones

Writes PREFIX.thickness.tif and so on, and export.yaml; with --zones zones.gpkg, with a style for QGIS, and zones.yaml.
"""


def add_arguments(parser):
    parser.add_argument("prefix", metavar="PREFIX",
                        help="output of fix deposit/grid: PREFIX.thickness.asc and so on; or one of these files; or "
                             "the folder of a run, or of a study or site, which stands for its governing run")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path,
                        help="folder for the results (default PREFIX.export; of a folder, FOLDER/export)")
    parser.add_argument("--terrain", metavar="TERRAIN.asc", type=Path,
                        help="the run's terrain, whose sidecar holds the CRS (default: terrain.asc beside PREFIX)")
    parser.add_argument("--zones", metavar="P1,P2,...", help="instead: polygons inside which something is exceeded "
                        "with at least these probabilities, which fall")
    parser.add_argument("--thicker", metavar="T", type=number, help="of --zones: a thickness above T, m (default 0.1)")
    parser.add_argument("--intensity", metavar="QUANTITY:L1,L2,...", help="of --zones, instead of --thicker: thickness "
                        "(m), speed (m/s) or energy (J) above each of these limits, which rise")
    add_overwrite(parser)


def run(args):
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    if args.zones is not None:
        return run_zones(args)
    for option in ("thicker", "intensity"):
        if getattr(args, option) is not None:
            raise SlopeError(f"--{option}", "must be given with --zones", getattr(args, option))
    return run_rasters(args)


def run_zones(args):
    """--zones."""
    from ..route import zones
    from ..survey import geopackage

    if args.terrain is not None:
        raise SlopeError("--terrain", "must be given without --zones", args.terrain)
    if args.thicker is not None and args.intensity is not None:
        raise SlopeError("--thicker", "must be given without --intensity", f"{args.thicker:g}")
    wanted = zones.probabilities(args.zones)
    limits = zones.limits(0.1 if args.thicker is None else args.thicker, args.intensity)
    folder = args.output or (Path(args.prefix, "zones") if Path(args.prefix).is_dir() else Path(f"{args.prefix}.zones"))
    disk.check_folder(folder, ["zones.gpkg", "zones.yaml"], [args.prefix], args.overwrite)
    ground = zones.ground_of(args.prefix, warned.printer("export"))
    zones.check(ground, wanted, args.prefix)
    several = [zones.of(ground, limit, wanted) for limit in limits]
    about = {"of": args.prefix, **zones.about(ground, several, wanted)}
    with disk.complete(folder, "zones.yaml") as new:
        geopackage.write(new / "zones.gpkg", {zones.LAYER: zones.layer(ground, several, wanted)}, ground.raster,
                         {zones.LAYER: zones.style(several, wanted, about["per_year"])})
        disk.write_yaml(new / "zones.yaml", about, "slope export --zones: m2; probabilities per year, or of the runs")
    for one in about["zones"]:
        print(f"{one['quantity']} > {one['exceeds']:g}, {'per year' if about['per_year'] else 'of the runs'} at least "
              f"{one['probability']:.4g}: {one['at_least_m2']:,.0f} m2, and {one['cannot_tell_m2']:,.0f} m2 of which "
              f"{about['runs']} runs cannot tell")
    print(f"written to {folder}: zones.gpkg zones.yaml")


def run_rasters(args):
    """The rasters of a run."""
    warnings: List[str] = []
    warn = warned.warner("export", warnings)
    named = run_folders.named_run(args.prefix)
    run_ = deposit.read(named.prefix, args.terrain, warn)
    folder = args.output or (named.folder / "export" if named.folder else Path(f"{named.prefix}.export"))
    place = run_.raster
    found = layers(named.prefix)
    disk.check_folder(folder, [*(file_of(layer) for layer in found), "export.yaml"], [named.prefix], args.overwrite)
    about = {"prefix": run_.prefix, "terrain": run_.terrain, "crs": None if place.crs is None else crs_name(place.crs),
             "origin": {"east": place.offset[0], "north": place.offset[1]}, "cell": run_.cell,
             "run": {"slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"]}, "rasters": []}
    if not any(layer.kind == "base" for layer in found):
        warn(warned.Warned("no base", {"file": f"{named.prefix}.base.asc"}))
    with disk.complete(folder, "export.yaml") as new:
        for layer in rasters.progress(found, "writing GeoTIFFs"):
            about["rasters"].append(write(new, layer, place))
        about["warnings"] = warnings
        disk.write_yaml(new / "export.yaml", about, "slope export: rasters of a run as GeoTIFFs; m, m/s, J, s")
    if named.note:
        print(f"{named.note}: {named.prefix}")
    print(f"{len(found)} rasters, {about['crs'] or 'local metres, no CRS'}, cells of {run_.cell:g} m\n"
          f"written to {folder}: {' '.join(one['file'] for one in about['rasters'])} export.yaml")
