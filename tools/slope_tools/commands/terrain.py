"""slope terrain: survey rasters to the plain terrain.asc that `region terrain` reads, with a sidecar."""
import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional

from ..case.decks import quoted, warn_of_name
from ..disk import check_file, check_standing
from ..errors import SlopeError
from ..findings import printer
from ..options import Overwrite, parse_number, option, positional, several, parse_whole_number
from ..survey import local_terrain, rasters

DESCRIPTION = "Survey rasters (GeoTIFF, ASCII grids, XYZ, FG-GML) to the plain terrain.asc that decks read."
EPILOG = """\
units: metres for heights, --cell, and coordinates; N of --fill is a number of cells of the input.

FG-GML of Japan's Geospatial Information Authority (DEM1A, DEM5A to 5C, DEM10A, 10B) is taken as it is downloaded. Its
--crs is the zone of the plane rectangular system at the site if none is given, and its --cell 1, 5 or 10 m. Tiles of
several resolutions need a --cell: finer ones count where they have heights.

examples: two tiles in degrees, to zone IX of the Japanese plane rectangular system, cells of 2 m; a download of FG-GML:
  tools/slope terrain north.tif south.tif -o terrain.asc --crs EPSG:6677 --cell 2 --fill 20
  tools/slope terrain FG-GML-5439-23-DEM5A.zip -o terrain.asc

Writes terrain.asc and terrain.yaml (CRS, origin, sources, what was done).
"""


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    inputs: List[str] = positional(
        "raster of heights, points on a grid (x y z in lines), FG-GML (.xml), or a .zip of them; several are merged, "
        "which needs one CRS, and one grid or a --cell", metavar="IN", nargs="+")
    output: Path = option("the terrain; OUT.yaml beside it is its sidecar", "-o", metavar="OUT.asc")
    crs: Optional[str] = option(
        "wanted CRS, in metres: an input in another CRS is reprojected to it (bilinear); the coordinates of an input "
        "that names no CRS are taken to be in this one", metavar="EPSG:n")
    assign_crs: Optional[str] = option(
        "the coordinates of the inputs are in this CRS, whatever their tags say (not of FG-GML); --crs may then "
        "reproject them", metavar="EPSG:n")
    z_unit: Optional[str] = option(
        "of the heights, whatever the tags of the inputs say: m, ft (0.3048 m) or us-ft (1200/3937 m); default: m; "
        "must be given where a tag says feet over a plan in metres or degrees", choices=rasters.UNITS)
    nodata: List[float] = several(
        "a value of the inputs, in their own unit, that stands for no height, beside the one that they declare; may "
        "be given several times", metavar="V")
    differ: Optional[float] = option(
        "accept a median difference of two inputs of up to M m where both have heights (default 5), as of surveys "
        "before and after a landslide, or step where they meet", metavar="M")
    bounds: Optional[List[float]] = option(
        "crop to this box, in the output's CRS, m; of an input that is larger, no more is read", nargs=4,
        metavar=("W", "S", "E", "N"))
    cell: Optional[float] = option(
        "wanted cell size, m (bilinear; larger cells get the mean of several points)", metavar="S")
    origin: List[str] = option(
        "what becomes 0 0: auto (default), the lower left corner rounded down to whole metres; or E N, in the "
        "output's CRS, m", nargs="+", default=["auto"], metavar=("auto|E", "N"))
    fill: int = option(
        "fill NODATA holes of at most N cells (default 0: none); holes at the edge stay", type=parse_whole_number,
        default=0, metavar="N")


def run_terrain(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what was done, a summary and the line for the deck."""
    wanted = check_terrain_request(args)
    warn = printer("terrain")
    about = local_terrain.make_local_terrain(args.inputs, args.output, wanted, print, warn)
    warn_of_name(args.output, warn)
    print(f"{local_terrain.describe_terrain(args.output, about)}\nregion ground terrain {quoted(str(args.output))}")


def check_terrain_request(args: Request) -> local_terrain.Wanted:
    """Check what can be checked before any reading; return what is wanted."""
    check_file(args.output, ".asc", args.inputs)
    check_standing(args.output.with_suffix(".yaml"), [args.output], args.inputs, args.overwrite)
    origin = None
    if args.origin != ["auto"]:
        try:
            east, north = map(parse_number, args.origin)
        except (argparse.ArgumentTypeError, ValueError):
            raise SlopeError("--origin", "must be auto or two numbers, E N", " ".join(args.origin)) from None
        origin = east, north
    wanted = local_terrain.Wanted(args.crs, origin, args.cell, args.bounds, args.fill, args.assign_crs,
                                  z_unit=args.z_unit, nodata=args.nodata, differ=args.differ)
    local_terrain.checked_crs(wanted)
    return wanted
