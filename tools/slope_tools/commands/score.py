"""slope score: a run's deposit against a mapped one.

Mapped is a polygon, or a raster of thickness. Areas are exact: a simulated deposit is made of whole cells, and the
polygon is cut by them; a mapped raster on another grid is spread over the run's cells by the areas that they share.
"""
from pathlib import Path

from ..deposits import score_run
from ..deposits.score import THRESHOLD
from ..options import add_overwrite, number

DESCRIPTION = "Compare a run's deposit with a mapped one: overlap, run-out, volume."
EPILOG = """\
units: metres, m2, m3, degrees. PREFIX is what fix deposit/grid was given as output.

example: the mapped outline of the deposit; a thickness raster from two surveys, errors per mesh cell of 20 m:
  tools/slope score embankment --observed mapped.geojson -o score
  tools/slope score embankment --observed thickness.tif --mesh 20 -o score

Writes score.yaml, score.csv (one row per cell of the run or of the mesh) and score.png.
"""


def add_arguments(parser):
    parser.add_argument("prefix", metavar="PREFIX", help="output of fix deposit/grid: PREFIX.thickness.asc and so on")
    parser.add_argument("--observed", metavar="POLYGON|RASTER", required=True, type=Path,
                        help="the mapped deposit: its outline (GeoJSON, shapefile, CSV, WKT), or its thickness in "
                             "metres (GeoTIFF, ESRI ASCII grid; NODATA is no deposit)")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path,
                        help="folder for the results (default PREFIX.score)")
    parser.add_argument("--threshold", metavar="T", type=number, default=THRESHOLD,
                        help=f"thickness above which a cell counts as deposit, m (default {THRESHOLD:g})")
    parser.add_argument("--mesh", metavar="SIZE", type=number,
                        help="side of the mesh cells of score.csv, m; their corners are at multiples of it in local x "
                             "and y (default: the cells of the run)")
    parser.add_argument("--terrain", metavar="TERRAIN.asc", type=Path,
                        help="the run's terrain, whose sidecar holds the CRS (default: terrain.asc beside PREFIX)")
    parser.add_argument("--local", action="store_true", help="the mapped deposit is in local metres, not in a CRS")
    add_overwrite(parser)


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the scores."""
    print(score_run.make(args.prefix, args.observed, args.output or Path(f"{args.prefix}.score"), args.threshold,
                         args.mesh, args.terrain, args.local, args.overwrite))
