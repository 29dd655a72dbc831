"""slope export: every raster of a run as a GeoTIFF in the coordinates of the survey, for a GIS; or zones."""
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Optional

from .. import disk, findings
from ..deposits import deposit
from ..deposits.export import file_of, layers, write_layer
from ..errors import SlopeError
from ..options import Overwrite, option, positional
from ..studies import outdated
from ..survey import rasters
from ..survey.rasters import crs_name
from ..tables import named_run, study_file

DESCRIPTION = "Every raster of a run as a GeoTIFF in the coordinates of the survey."
EPILOG = """\
units: metres, m/s, J, s. PREFIX is what fix deposit/grid was given as output.

examples: the rasters of a run, for QGIS; of a site, its governing run; of a run in another folder than its terrain:
  tools/slope export embankment
  tools/slope export mine
  tools/slope export study/rolling_0.05/embankment --terrain terrain.asc -o gis

zones of a study or a route: polygons in which a mass thicker than 0.5 m has at least these probabilities, shares of the
runs, or per year where a route has a hazard (1/100,1/1000,1/5000); classes of intensity against them:
  tools/slope export mine --zones 0.9,0.5,0.1 --thicker 0.5
  tools/slope export route --zones 0.5,0.1 --intensity speed:1,5 -o zones

Writes PREFIX.thickness.tif and so on, and export.yaml; with --zones zones.gpkg, with a style for QGIS, and zones.yaml.
"""


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    prefix: str = positional(
        "output of fix deposit/grid: PREFIX.thickness.asc and so on; or one of these files; or the folder of a run, "
        "or of a study or site, which stands for its governing run", metavar="PREFIX")
    output: Optional[Path] = option(
        "folder for the results (default PREFIX.export; of a folder, FOLDER/export)", "-o", metavar="DIR")
    terrain: Optional[Path] = option(
        "the run's terrain, whose sidecar holds the CRS (default: terrain.asc beside PREFIX)", metavar="TERRAIN.asc")
    zones: Optional[str] = option("instead: polygons inside which something is exceeded with at least these "
                                  "probabilities, which fall", metavar="P1,P2,...")
    thicker: Optional[float] = option("of --zones: a thickness above T, m (default 0.1)", metavar="T")
    intensity: Optional[str] = option("of --zones, instead of --thicker: thickness (m), speed (m/s) or energy (J) "
                                      "above each of these limits, which rise", metavar="QUANTITY:L1,L2,...")


def run_export(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    if args.zones is not None:
        run_zones(args, args.zones)
        return
    for name in ("thicker", "intensity"):
        if getattr(args, name) is not None:
            raise SlopeError(f"--{name}", "must be given with --zones", getattr(args, name))
    run_rasters(args)


def run_zones(args: Request, zones_: str) -> None:
    """--zones."""
    from ..route import zones
    from ..survey import geopackage

    if args.terrain is not None:
        raise SlopeError("--terrain", "must be given without --zones", args.terrain)
    if args.thicker is not None and args.intensity is not None:
        raise SlopeError("--thicker", "must be given without --intensity", f"{args.thicker:g}")
    wanted = zones.probabilities(zones_)
    limits = zones.limits(0.1 if args.thicker is None else args.thicker, args.intensity)
    own = Path(args.prefix, "zones") if Path(args.prefix).is_dir() else Path(f"{args.prefix}.zones")
    folder = args.output or own
    disk.check_folder(folder)
    if (study := study_file.study_in(Path(args.prefix), weighted=True)):
        outdated.check_study_current(Path(args.prefix), study)
    warn = findings.printer("export")
    ground = zones.ground_of(args.prefix, warn)
    ground = ground._replace(doubts=[*ground.doubts, *ground.of_energy(limits)])
    zones.check_zones(ground, wanted, args.prefix, zones_)
    asked = zones.asked(ground, zones_, limits)
    disk.check_folder(folder, ["zones.gpkg", "zones.yaml"], [args.prefix, asked], args.overwrite)
    several = [zones.make_zones(ground, limit, wanted) for limit in limits]
    summary: Dict[str, Any] = {"of": args.prefix, "asked": asked, **zones.summarise_zones(ground, several, wanted)}
    with disk.complete(folder, "zones.yaml") as new:
        geopackage.write_geopackage(new / "zones.gpkg", zones.layers(ground, several, wanted), ground.raster,
                                    {zones.LAYER: zones.style(several, wanted, summary["per_year"])})
        disk.write_yaml(new / "zones.yaml", summary, "slope export --zones: m2; probabilities per year, or of the runs")
    for doubt in ground.doubts:
        warn(doubt)
    for one in summary["zones"]:
        print(f"{one['quantity']} > {one['exceeds']:g}, {'per year' if summary['per_year'] else 'of the runs'} at "
              "least "
              f"{one['probability']:.4g}: {one['at_least_m2']:,.0f} m2, and {one['cannot_tell_m2']:,.0f} m2 of which "
              f"{summary['runs']} runs cannot tell")
    if summary["unreached_at_most"] >= wanted[-1]:
        print(f"where no run comes it may be up to {summary['unreached_at_most']:.2g}: beside the zones "
              f"{summary['runs']} " "runs do not show less than they ask for")
    if study:
        print(f"of the runs of {study}")
    print(f"written to {folder}: zones.gpkg zones.yaml")


def run_rasters(args: Request) -> None:
    """The rasters of a run."""
    warn, warnings = findings.warner("export")
    named = named_run.read_named_run(args.prefix)
    outdated.check_study_current(Path(args.prefix), named.study)
    run_ = deposit.read_deposit(named.prefix, args.terrain, warn)
    folder = args.output or (named.folder / "export" if named.folder else Path(f"{named.prefix}.export"))
    which = named.study and f"{named.run}, the governing run of {named.study}"
    place = run_.raster
    written = layers(named.prefix)
    disk.check_folder(folder, [*(file_of(layer) for layer in written), "export.yaml"], [named.prefix], args.overwrite)
    summary = {"prefix": run_.prefix, "terrain": run_.terrain, "crs": None if place.crs is None
               else crs_name(place.crs),
               "origin": {"east": place.offset[0], "north": place.offset[1]}, "cell": run_.cell,
               "run": {"name": named.run, "study": named.study and str(named.study),
                       "slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"]}, "rasters": []}
    if not any(layer.kind == "base" for layer in written):
        warn(findings.Finding("no base", {"file": f"{named.prefix}.base.asc"}))
    with disk.complete(folder, "export.yaml") as new:
        for layer in rasters.progress(written, "writing GeoTIFFs"):
            summary["rasters"].append(write_layer(new, layer, place, {"run": which or named.prefix}))
        summary["warnings"] = warnings
        disk.write_yaml(new / "export.yaml", summary, "slope export: rasters of a run as GeoTIFFs; m, m/s, J, s")
    if which:
        print(f"{which}: {named.prefix}")
    print(f"{len(written)} rasters, {summary['crs'] or 'local metres, no CRS'}, cells of {run_.cell:g} m\n"
          f"written to {folder}: {' '.join(one['file'] for one in summary['rasters'])} export.yaml")
