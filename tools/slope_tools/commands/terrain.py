"""slope terrain: survey rasters to the plain terrain.asc that `region terrain` reads, with a sidecar.

Order of the work: read, merge, fill holes, crop or resample, move to the local origin, write.
"""
import argparse
import math
from pathlib import Path

import numpy as np
import rasterio
import rasterio.warp
from affine import Affine
from rasterio.crs import CRS
from rasterio.errors import CRSError

from ..errors import SlopeError
from ..options import number
from ..survey import fggml, rasters
from ..survey.crs import box, require_metres, warn_of_stretch
from ..survey.holes import fill, small_holes
from ..survey.rasters import Raster
from ..survey.resampling import regrid
from ..survey.terrain import declare, merge, read_fggml

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


def add_parser(commands, **kwargs):
    """Add `terrain` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "terrain", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Survey rasters (GeoTIFF, ESRI ASCII grid, FG-GML) to the plain terrain.asc that decks read.",
        **kwargs)
    parser.add_argument("inputs", metavar="IN", nargs="+",
                        help="raster of heights in metres, or FG-GML (.xml, or .zip of them); several are merged, "
                             "which needs one CRS and one grid")
    parser.add_argument("-o", dest="output", metavar="OUT.asc", required=True, type=Path,
                        help="the terrain; OUT.yaml beside it is its sidecar")
    parser.add_argument("--crs", metavar="EPSG:n",
                        help="wanted CRS, in metres: an input in another CRS is reprojected to it (bilinear); an input "
                             "without a CRS cannot be, and is taken to be in this one")
    parser.add_argument("--bounds", nargs=4, type=number, metavar=("W", "S", "E", "N"),
                        help="crop to this box, in the output's CRS, m")
    parser.add_argument("--cell", type=number, metavar="S",
                        help="wanted cell size, m (bilinear; larger cells get the mean of several points)")
    parser.add_argument("--origin", nargs="+", default=["auto"], metavar=("auto|E", "N"),
                        help="what becomes 0 0: auto (default), the lower left corner rounded down to whole metres; "
                             "or E N, in the output's CRS, m")
    parser.add_argument("--fill", type=int, default=0, metavar="N",
                        help="fill NODATA holes of at most N cells (default 0: none); holes at the edge stay")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints what was done, a summary and the line for the deck."""
    crs, origin = check(args)
    steps = []  # what was done, for stdout and the sidecar

    def tell(step):
        steps.append(step)
        print(step)

    cell = args.cell
    if any(map(fggml.is_one, args.inputs)):
        raster, crs, cell = read_fggml(args.inputs, crs, cell, tell)
    else:
        raster = merge([declare(path, crs, tell) for path in args.inputs], args.inputs, tell)
        crs = crs or raster.crs
    require_metres(crs, args.inputs[0])
    if not np.isfinite(raster.z).any():
        raise SlopeError(", ".join(args.inputs), "must have a height, all cells are NODATA")
    filled = 0
    if args.fill:
        holes, count = small_holes(np.isnan(raster.z), args.fill)
        filled = int(holes.sum())
        raster = raster._replace(z=fill(raster.z, holes))
        tell(f"filled {count} NODATA holes of at most {args.fill} cells, {filled} cells")
    raster = regrid(raster, crs, cell, args.bounds, tell)
    if crs is not None:
        warn_of_stretch(raster)

    z = np.round(raster.z, 3) + 0.0  # as they are written; + 0.0 because of -0.0
    if origin is None:
        origin = tuple(math.floor(corner + 1e-6) for corner in raster.transform * (0, len(z)))  # 1e-6: rounding noise
    local = Raster(z, Affine.translation(-origin[0], -origin[1]) * raster.transform, crs, origin)
    about = rasters.write_asc_local(args.output, local,
                                    {"filled_cells": filled, "sources": args.inputs, "steps": steps})
    print(summary(args.output, about))


def check(args):
    """Check what can be checked before any reading; return the wanted CRS and origin, each None if not given."""
    if args.output.suffix != ".asc" or args.output.is_dir():
        raise SlopeError("-o", "must be a file that ends in .asc", args.output)
    if not args.output.parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", args.output)
    for path in args.inputs:
        if args.output.exists() and Path(path).exists() and args.output.samefile(path):
            raise SlopeError("-o", "must not be an input", args.output)
    if args.cell is not None and args.cell <= 0:
        raise SlopeError("--cell", "must be > 0", f"{args.cell:g}")
    if args.fill < 0:
        raise SlopeError("--fill", "must be >= 0", args.fill)
    if args.bounds and not (args.bounds[0] < args.bounds[2] and args.bounds[1] < args.bounds[3]):
        raise SlopeError("--bounds", "W S E N must have W < E and S < N", box(args.bounds))
    crs = origin = None
    if args.crs:
        try:
            with rasterio.Env():  # GDAL's own message is not for stderr
                crs = CRS.from_user_input(args.crs)
        except CRSError:
            raise SlopeError("--crs", "must be a CRS such as EPSG:6677", args.crs) from None
        require_metres(crs, "--crs")
    if args.origin != ["auto"]:
        try:
            origin = tuple(map(number, args.origin))
        except argparse.ArgumentTypeError:
            origin = ()
        if len(origin) != 2:
            raise SlopeError("--origin", "must be auto or two numbers, E N", " ".join(args.origin))
    return crs, origin


def summary(path, about):
    """What the user needs to know of the written terrain, and the line for the deck."""
    size, extent, height, origin = (about[key] for key in ("size", "extent", "height", "origin"))
    quoted = f'"{path}"' if " " in str(path) else path
    return (f"{path}: {size['columns']} x {size['rows']} cells of {about['cell']:.6g} m, "
            f"x {extent['xlo']:.3f} to {extent['xhi']:.3f}, y {extent['ylo']:.3f} to {extent['yhi']:.3f}, "
            f"z {height['min']:.3f} to {height['max']:.3f} m, {about['nodata_cells']} NODATA cells, "
            f"0 0 at {origin['east']:.10g} {origin['north']:.10g}\n"
            f"region ground terrain {quoted}")
