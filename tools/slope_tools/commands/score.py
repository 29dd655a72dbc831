"""slope score: a run's deposit against a mapped one.

Mapped is a polygon, or a raster of thickness. Areas are exact: a simulated deposit is made of whole cells, and the
polygon is cut by them; a mapped raster on another grid is spread over the run's cells by the areas that they share.
"""
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from ..deposits import score_run
from ..deposits.score import THRESHOLD
from ..options import Overwrite, flag, option, positional

DESCRIPTION = "Compare a run's deposit with a mapped one: overlap, run-out, volume."
EPILOG = """\
units: metres, m2, m3, degrees. PREFIX is what fix deposit/grid was given as output.

example: the mapped outline of the deposit; a thickness raster from two surveys, errors per mesh cell of 20 m:
  tools/slope score embankment --observed mapped.geojson -o score
  tools/slope score embankment --observed thickness.tif --mesh 20 -o score

Writes score.yaml, score.csv (one row per cell of the run or of the mesh) and score.png.
"""


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    prefix: str = positional("output of fix deposit/grid: PREFIX.thickness.asc and so on", metavar="PREFIX")
    observed: Path = option(
        "the mapped deposit: its outline (GeoJSON, shapefile, CSV, WKT), or its thickness in metres (GeoTIFF, ESRI "
        "ASCII grid; NODATA is no deposit)", metavar="POLYGON|RASTER")
    output: Optional[Path] = option("folder for the results (default PREFIX.score)", "-o", metavar="DIR")
    threshold: float = option(
        f"thickness above which a cell counts as deposit, m (default {THRESHOLD:g})", metavar="T", default=THRESHOLD)
    mesh: Optional[float] = option(
        "side of the mesh cells of score.csv, m; their corners are at multiples of it in local x and y (default: the "
        "cells of the run)", metavar="SIZE")
    terrain: Optional[Path] = option(
        "the run's terrain, whose sidecar holds the CRS (default: terrain.asc beside PREFIX)", metavar="TERRAIN.asc")
    local: bool = flag("the mapped deposit is in local metres, not in a CRS")


def run_score(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints the scores."""
    print(score_run.make_score(args.prefix, args.observed, args.output or Path(f"{args.prefix}.score"), args.threshold,
                               args.mesh, args.terrain, args.local, args.overwrite))
