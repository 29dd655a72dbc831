"""slope export: every raster of a run as a GeoTIFF in the coordinates of the survey, for a GIS."""
import argparse
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from . import deposit, rasters
from .errors import SlopeError
from .rasters import crs_name

KINDS = {    # what fix deposit/grid writes: quantity, unit
    "base": ("ground without the body", "m"),
    "surface": ("ground and deposit", "m"),
    "thickness": ("thickness of the deposit", "m"),
    "max_thickness": ("largest thickness so far", "m"),
    "max_speed": ("largest speed of a ball so far", "m/s"),
    "max_energy": ("largest kinetic energy of a ball so far", "J"),
    "arrival": ("time when the first ball came", "s"),
    "last_motion": ("time when a ball last moved", "s"),
}
NAME = re.compile(r"(?:(\d+)\.)?(%s)\.asc" % "|".join(KINDS))    # after PREFIX and a point

EPILOG = """\
units: metres, m/s, J, s. PREFIX is what fix deposit/grid was given as output.

example: the rasters of a run, for QGIS; of a run in another folder than its terrain:
  tools/slope export embankment
  tools/slope export study/runs/001/embankment --terrain terrain.asc -o gis

Writes PREFIX.thickness.tif and so on, and export.yaml.
"""


class Layer(NamedTuple):
    """A raster of a run."""
    path: Path
    kind: str           # key of KINDS
    step: int           # of a numbered copy (series yes of the fix), -1: none


def add_parser(commands, **kwargs):
    """Add `export` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "export", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Every raster of a run as a GeoTIFF in the coordinates of the survey.", **kwargs)
    parser.add_argument("prefix", metavar="PREFIX", help="output of fix deposit/grid: PREFIX.thickness.asc and so on")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path,
                        help="folder for the results (default PREFIX.export)")
    parser.add_argument("--terrain", metavar="TERRAIN.asc", type=Path,
                        help="the run's terrain, whose sidecar tells the CRS (default: terrain.asc beside PREFIX)")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    warnings = []
    warn = deposit.warner("export", warnings)
    run_ = deposit.read(args.prefix, args.terrain, warn)
    folder = args.output or Path(f"{args.prefix}.export")
    deposit.check_folder(folder)
    place = run_.raster
    found = layers(args.prefix)
    about = {"prefix": run_.prefix, "terrain": run_.terrain, "crs": None if place.crs is None else crs_name(place.crs),
             "origin": {"east": place.offset[0], "north": place.offset[1]}, "cell": run_.cell,
             "run": {"slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"]}, "rasters": []}
    if not any(layer.kind == "base" for layer in found):
        warn(f"no {args.prefix}.base.asc, as of a run by an older version: no ground without the body")
    with deposit.complete(folder) as new:
        for layer in rasters.progress(found, "writing GeoTIFFs"):
            about["rasters"].append(write(new, layer, place))
        about["warnings"] = warnings
        deposit.write_yaml(new / "export.yaml", about, "slope export: rasters of a run as GeoTIFFs; m, m/s, J, s")
    print(f"{len(found)} rasters, {about['crs'] or 'local metres, no CRS'}, cells of {run_.cell:g} m\n"
          f"written to {folder}: {' '.join(one['file'] for one in about['rasters'])} export.yaml")


def layers(prefix):
    """The rasters of a prefix, in the order of KINDS, numbered copies last."""
    prefix = Path(prefix)
    found = []
    for path in prefix.parent.glob("*.asc"):
        match = NAME.fullmatch(path.name[len(prefix.name) + 1:]) if path.name.startswith(f"{prefix.name}.") else None
        if match:
            found.append(Layer(path, match[2], -1 if match[1] is None else int(match[1])))
    return sorted(found, key=lambda layer: (layer.step, list(KINDS).index(layer.kind)))


def write(folder, layer, place):
    """Write a layer as a GeoTIFF on the grid of place (a Raster with CRS and offset); what export.yaml tells of it."""
    raster = rasters.read(layer.path, heights=False)
    if raster.z.shape != place.z.shape or raster.transform != place.transform:
        raise SlopeError(layer.path, "must have the grid of the run's thickness: is it of another run?")
    quantity, unit = KINDS[layer.kind]
    name = f"{layer.path.stem}.tif"
    rasters.write_geotiff(folder / name, {f"{quantity} ({unit})": raster.z}, place)
    there = raster.z[np.isfinite(raster.z)]
    about = {"file": name, "quantity": quantity, "unit": unit}
    if layer.step >= 0:
        about["step"] = layer.step
    return {**about, "nodata_cells": int(raster.z.size - there.size), "min": there.min() if there.size else None,
            "max": there.max() if there.size else None}
