"""slope polygon: polygons of a GIS to the rings in local metres that `region polygon` reads."""
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from shapely.geometry import box

from ..case.decks import quoted, warn_of_name
from ..disk import check_file, check_standing
from ..findings import Finding, printer
from ..options import Overwrite, flag, option, positional
from ..survey import polygons, rasters, vectors
from ..survey.crs import as_crs

SLOW = 5.0     # s; a run that took longer says so
DESCRIPTION = "Polygons (GeoJSON, shapefile, CSV, WKT) to the .csv in local metres that decks read."
EPILOG = """\
IN: GeoJSON, shapefile, or another format of GDAL, one layer of it (FILE|layername=NAME, or --layer); or text
  (.csv, .txt, .wkt) with
  rings of lines x,y (metres), a blank line between two rings, # comments, one line of names at most; a point is inside
  if it is inside an odd number of rings, so that a ring inside of another one is a hole
  WKT such as POLYGON ((x y, x y, x y, x y))
coordinates: of a file with a CRS, in that one (GeoJSON that names none: longitude, latitude), reprojected to the
  terrain's; of text (CSV, WKT), in the terrain's CRS (east, north), but of a file that this command wrote, local;
  --assign-crs and --local override this. OUT.csv is in the terrain's local metres.

example:
  tools/slope polygon road.geojson -o road.csv --terrain terrain.asc
"""


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    input: str = positional("polygons, also several and with holes; what overlaps becomes one", metavar="IN")
    output: Path = option("rings for region polygon", "-o", metavar="OUT.csv")
    terrain: str = option(
        "terrain that `slope terrain` wrote; its sidecar TERRAIN.yaml has CRS and origin", metavar="TERRAIN.asc")
    layer: Optional[str] = option(
        "of the layers of IN this one (default: the only one, or the only one of polygons)", metavar="NAME")
    crs: Optional[str] = option(
        "the coordinates of IN are in this CRS, whatever IN says", "--assign-crs", metavar="EPSG:n", one_of="place")
    local: bool = flag("the coordinates of IN are the terrain's local metres, whatever IN says", one_of="place")


def run_polygon(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what was written and the line for the deck."""
    start = time.monotonic()
    check_file(args.output, ".csv", [vectors.source(args.input).path], "the input")
    check_standing(args.output, [args.output], [polygons.HEAD], args.overwrite, "slope polygon")
    crs = as_crs("--assign-crs", args.crs) if args.crs else None
    place = rasters.read_place(args.terrain)
    warn = printer("polygon")
    geometry = polygons.read_local(vectors.name_layer(args.input, args.layer), place, local=args.local, crs=crs,
                                   advice=polygons.OF_ASSIGN_CRS, warn=warn)
    beyond = 1 - geometry.intersection(box(*place.extent)).area / geometry.area
    if beyond > 1e-9:
        warn(Finding("outside", {"file": args.input, "percent": 100 * beyond, "terrain": args.terrain}))
    warn_of_name(args.output, warn)
    geometry = polygons.write_polygon(args.output, geometry, place)
    print(describe_polygons(args.output, geometry))
    if time.monotonic() - start > SLOW:
        print(f"took {time.monotonic() - start:.0f} s")


def describe_polygons(path, geometry):
    """What the user needs to know of the written polygons, and the line for the deck."""
    rings = polygons.rings_of(geometry)
    parts = polygons.polygons_of(geometry)
    xlo, ylo, xhi, yhi = geometry.bounds
    return (f"{path}: {count(len(parts), 'polygon')}, {count(len(rings), 'ring')} "
            f"({count(len(rings) - len(parts), 'hole')}), {sum(map(len, rings))} vertices, "
            f"x {xlo:.3f} to {xhi:.3f}, y {ylo:.3f} to {yhi:.3f}, area {geometry.area:.3f} m2\n"
            f"region {path.stem if path.stem.isidentifier() else 'road'} polygon {quoted(str(path))}")


def count(number, what):
    return f"{number} {what}{'s' * (number != 1)}"
