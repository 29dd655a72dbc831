"""slope release: the body that is released, below a polygon or from a scar, as rasters and lines of a deck."""
import os
from dataclasses import dataclass
from pathlib import Path

from .. import disk, findings
from ..case import decks
from ..releases import release, release_files
from ..survey import vectors
from ..options import Overwrite, option, positional
from .release_arguments import Body, wanted

DESCRIPTION = "The body that is released: a slip surface below a polygon, or a scar, to a depth or volume."
EPILOG = """\
P: polygons as slope polygon takes them (GeoJSON, shapefile, FILE|layername=NAME, CSV, WKT)
shapes: sphere (default) through the ends of the fall line in the polygon; ellipsoid, the same, but as wide as the
  polygon; plane (default with a --dip in degrees), through the toe unless a depth or volume is given; slbl, the sloping
  local base level. --depth or --volume finds their free number, --dip least that of the sphere. slab: the ground
  lowered by the depth. slbl and slab take several polygons, and their attribute depth or thickness (m).
Writes NAME.slip.asc (the ground without the body) and NAME.depth.asc with sidecars, NAME.png (map, section), NAME.yaml
(choices, numbers) and NAME.deck.txt (lines of the deck); with --scar-is height also NAME.ground.asc, the ground before.

examples:
  tools/slope release terrain.asc --polygon release.geojson --depth 12 -o release
  tools/slope release terrain.asc --polygon release.shp --shape slbl --volume 50000 -o release
  tools/slope release terrain.asc --polygon release.shp --shape slab --depth 1.5 -o release
  tools/slope release terrain.asc --polygon release.csv --dip 35 --direction 110 -o release
  tools/slope release terrain.asc --polygon release.csv --dip least --foundation old_ground.asc -o release
  tools/slope release before.asc --scar after.asc --polygon release.csv --least 0.5 -o release
"""


@dataclass(frozen=True, kw_only=True)
class Request(Body, Overwrite):
    terrain: str = positional("the ground before the collapse, as slope terrain wrote it", metavar="TERRAIN.asc")
    output: Path = option("first part of the names of all files", "-o", metavar="NAME")


def run_release(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints the body's numbers before it writes any file."""
    asked = wanted(args)
    sources = [path for path in (args.terrain, asked.polygon, args.scar, args.foundation) if isinstance(path, str)]
    release_files.check_release_files(args.output, [vectors.source(path).path for path in sources])
    raised = args.scar_is == "height"
    made = release_files.paths(args.output, raised)
    disk.check_standing(args.output.with_name(args.output.name + ".yaml"), made, sources, args.overwrite)
    body = release.body_of(asked)
    print(release.describe_body(body), flush=True)
    tell = findings.printer("release")
    for line in body.warnings:
        tell(line)
    for path in (os.path.relpath(args.terrain, args.output.parent), args.output.name):
        decks.warn_of_name(path, tell)
    release_files.write_body(args.output, asked, body, raised)
    print(f"wrote {', '.join(path.name for path in made)}")
