"""slope mobility: how likely a mass goes beyond each point of its fall path, by how far known events went."""
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from .. import disk
from ..errors import SlopeError
from ..findings import printer
from ..mobility import body, fall_path, known, results
from ..options import Overwrite, option, positional
from ..releases import release
from ..sites import site_choices, site_roads
from ..sites.site_roads import ROAD
from ..studies import outlook
from ..survey import lines, roads
from ..survey.crs import as_crs
from . import known_arguments, road_arguments
from .release_arguments import Body, wanted

DESCRIPTION = ("The probability that a mass goes beyond each point of its fall path, by known events of its volume "
               "and height. No run is needed.")
EPILOG = """\
EVENTS.csv: columns name, fall_m, length_m (crown to toe, in plan along the path), volume_Mm3 (million m3) and
confinement (frontal, lateral or unconfined); at least 12 events.
Writes DIR/mobility.csv (length_m, height_m, elevation_m, x, y and exceedance_... along the fall path), mobility.gpkg
(the path for a GIS), mobility_map.png, mobility_profile.png and mobility.yaml.

examples:
  tools/slope mobility terrain.asc --polygon release.geojson --depth 40 --road road.geojson -o known
  tools/slope mobility before.asc --scar after.asc --confined no --except "Frank Slide" -o frank
  tools/slope mobility mine --confined -o mine/mobility
"""


@dataclass(frozen=True, kw_only=True)
class Request(Body, known_arguments.Known, road_arguments.Width, Overwrite):
    terrain: str = positional(
        "the ground before the collapse, as slope terrain wrote it; or the folder of a site",
        metavar="TERRAIN.asc|SITE")
    output: Path = option("folder of the results", "-o", metavar="DIR")
    known: Optional[str] = known_arguments.known_option("known events: EVENTS.csv", "--known", "--set")
    road: Optional[str] = option(
        "how likely the mass reaches " + road_arguments.ROAD
        + " (default with SITE: its road)", metavar="POLYGON|LINE")
    path: Optional[Path] = option("a line from the crown down, instead of the steepest descent", metavar="LINE")


def run_mobility(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what was found and written."""
    disk.check_folder(args.output, results.FILES, [args.terrain], args.overwrite)
    site = site_choices.load_site(Path(args.terrain)) if Path(args.terrain).is_dir() else None
    asked = known_arguments.choice_of(args.known, args.left_out, args.confined,       # before the terrain is read
                                      site)
    tell = printer("mobility")
    mass = read_site_body(args) if site else of_release(args, tell)
    lane = road_of(args, site, mass)
    path = fall_path.given(mass, line_of(args.path, args.local, mass), args.path) if args.path else None
    mobilities = known.compute_known_mobility(mass, asked, path)
    met = lane and known.way_to_road(mass, mobilities, lane)
    source = results.Source(args.terrain, mass, asked, lane)
    results.write_mobility(args.output, mobilities, source, met)
    print("\n".join(results.describe_mobility(mobilities, source, met)))
    if site and not args.road:
        for name in site_roads.names(site):
            other = roads.read_local(site.folder / site_roads.file_name(name), mass.raster, site.choices.road.asked,
                                     local=True).polygon
            print(outlook.road_text(known.way_to_road(mass, mobilities, other), name))
    for line in (*results.find_mobility_caveats(mass, mobilities), *results.disagreement(mass, mobilities)):
        tell(line)
    print(f"wrote {', '.join(str(args.output / name) for name in results.FILES)}")


def read_site_body(args: Request) -> body.Body:
    """The body of a site's folder."""
    asked = wanted(args)
    if asked != release.Wanted(args.terrain, local=args.local):
        raise SlopeError(args.terrain, "is the folder of a site, whose body is given: no options of slope release")
    return body.read_mobility_body(Path(args.terrain))


def of_release(args: Request, tell) -> body.Body:
    """The body that the options ask for."""
    asked = wanted(args)
    found = release.body_of(asked)
    for line in found.warnings:
        tell(line)
    return body.of_release(found, asked.where)


def road_of(args: Request, site: Optional[site_choices.Site], mass: body.Body):
    """The road in local metres; None without one."""
    asked = road_arguments.asked(args)
    roads.check_road(asked)
    if args.road:
        crs = args.crs and as_crs("--assign-crs", args.crs)
        return roads.read_local(args.road, mass.raster, asked, args.local, crs).polygon
    if asked.width is not None:
        raise SlopeError("--road-width", "must be given with --road", f"{asked.width:g}")
    own = Path(args.terrain, ROAD)
    if not (site and own.is_file()):
        return None
    return roads.read_local(own, mass.raster, site.choices.road.asked, local=True).polygon


def line_of(path: Path, local: bool, mass: body.Body):
    """The line of --path."""
    found = lines.read_local(path, mass.raster, local, "path").geoms
    if len(found) != 1:
        raise SlopeError(path, "must hold one line, for --path", f"{len(found)} lines")
    return found[0]
