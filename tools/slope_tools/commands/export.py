"""slope export: every raster of a run as a GeoTIFF in the coordinates of the survey, for a GIS."""
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from .. import disk, findings
from ..case import run_folders
from ..deposits import deposit
from ..deposits.export import file_of, layers, write
from ..options import Overwrite, option, positional
from ..survey import rasters
from ..survey.rasters import crs_name

DESCRIPTION = "Every raster of a run as a GeoTIFF in the coordinates of the survey."
EPILOG = """\
units: metres, m/s, J, s. PREFIX is what fix deposit/grid was given as output.

examples: the rasters of a run, for QGIS; of a site, its governing run; of a run in another folder than its terrain:
  tools/slope export embankment
  tools/slope export mine
  tools/slope export study/rolling_0.05/embankment --terrain terrain.asc -o gis

Writes PREFIX.thickness.tif and so on, and export.yaml.
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


def run(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    warn, warnings = findings.warner("export")
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
        warn(findings.Finding("no base", {"file": f"{named.prefix}.base.asc"}))
    with disk.complete(folder, "export.yaml") as new:
        for layer in rasters.progress(found, "writing GeoTIFFs"):
            about["rasters"].append(write(new, layer, place))
        about["warnings"] = warnings
        disk.write_yaml(new / "export.yaml", about, "slope export: rasters of a run as GeoTIFFs; m, m/s, J, s")
    if named.note:
        print(f"{named.note}: {named.prefix}")
    print(f"{len(found)} rasters, {about['crs'] or 'local metres, no CRS'}, cells of {run_.cell:g} m\n"
          f"written to {folder}: {' '.join(one['file'] for one in about['rasters'])} export.yaml")
