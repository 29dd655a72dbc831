"""slope release: the body that is released, below a polygon or from a scar, as rasters and lines of a deck."""
import argparse
import os
from pathlib import Path

from .. import errors
from ..case import decks, release_files
from ..options import number
from ..survey import release, release_scar, vectors
from ..survey.release import SHAPES

EPILOG = """\
P: polygons as slope polygon takes them (GeoJSON, shapefile, FILE|layername=NAME, CSV, WKT)
shapes: sphere (default) through the ends of the fall line in the polygon; ellipsoid, the same, but as wide as the
  polygon; plane (default with --dip), through the toe unless a depth or volume is given; slbl, the sloping local base
  level. --depth or --volume finds their free number.
Writes NAME.slip.asc (the ground without the body) and NAME.depth.asc with sidecars, NAME.png (map, section), NAME.yaml
(choices, numbers) and NAME.deck.txt (lines of the deck).

examples:
  tools/slope release terrain.asc --polygon release.geojson --depth 12 -o release
  tools/slope release terrain.asc --polygon release.shp --shape slbl --volume 50000 -o release
  tools/slope release terrain.asc --polygon release.csv --dip 35 --direction 110 -o release
  tools/slope release before.asc --scar after.asc --polygon release.csv --least 0.5 -o release
"""


def add_parser(commands, **kwargs):
    """Add `release` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "release", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="The body that is released: a slip surface below a polygon, or a scar, to a depth or volume.",
        **kwargs)
    parser.add_argument("terrain", metavar="TERRAIN.asc",
                        help="the ground before the collapse, as slope terrain wrote it")
    parser.add_argument("-o", dest="output", metavar="NAME", required=True, type=Path,
                        help="first part of the names of all files")
    parser.add_argument("--polygon", metavar="P", help="the release area; with --scar, only the part of "
                        "the scar inside it is used")
    parser.add_argument("--layer", metavar="NAME", help="of the layers of P this one (default: the only one, or the "
                        "only one of polygons)")
    parser.add_argument("--shape", choices=SHAPES, help="of the slip surface")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--depth", metavar="D", type=number, help="largest depth below the ground, vertical, m")
    size.add_argument("--volume", metavar="V", type=number, help="volume of the body, m3")
    size.add_argument("--curvature", metavar="K", type=number,
                      help="of slbl: sum of the slip surface's second derivatives, 1/m; 8 D / L^2 for a depth D on a "
                           "length L")
    parser.add_argument("--dip", metavar="A", type=number, help="of the plane, degrees below the horizontal")
    parser.add_argument("--direction", metavar="B", type=number,
                        help="compass bearing to which the plane dips, degrees (default: the fall line's)")
    parser.add_argument("--scar", metavar="RASTER", help="the body is what this raster says, see --scar-is")
    parser.add_argument("--scar-is", choices=release_scar.KINDS,
                        help="surface: heights after the event (default, if they follow the terrain's); depth: of the "
                             "slip surface, positive down; change: after minus before, of which the loss counts")
    parser.add_argument("--least", metavar="D", type=number, default=0.0,
                        help="depths of a scar below this count as none, m (default 0): the noise of two surveys")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--assign-crs", "--crs", dest="crs", metavar="EPSG:n",
                       help="the coordinates of P are in this CRS, whatever P says")
    place.add_argument("--local", action="store_true", help="the coordinates of P are the terrain's local metres")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the body's numbers before it writes any file."""
    polygon = args.polygon and vectors.named(args.polygon, args.layer)
    release_files.check(args.output, [vectors.source(path).path for path in (args.terrain, polygon, args.scar) if path])
    wanted = release.Wanted(args.terrain, polygon, args.shape, args.depth, args.volume, args.curvature, args.dip,
                            args.direction, args.scar, args.scar_is, args.least, args.crs, args.local)
    body = release.body_of(wanted)
    print(release.text(body), flush=True)
    tell = errors.printer("release")
    for line in body.warnings:
        tell(line)
    for path in (os.path.relpath(args.terrain, args.output.parent), args.output.name):
        decks.warn_of_name(path, tell)
    release_files.write_body(args.output, wanted, body)
    print(f"wrote {', '.join(path.name for path in release_files.paths(args.output))}")
