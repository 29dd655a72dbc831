"""slope route: the bodies along a corridor, runs of all of them, and how likely which stretch is blocked."""
import contextlib
from dataclasses import dataclass, fields
from pathlib import Path
from shlex import quote
from typing import Any, List, Optional

from .. import disk
from ..errors import SlopeError
from ..findings import printer
from ..options import count, parse_number, option, positional, parse_whole_number
from ..programs import find_lmp
from ..releases.release import SHAPES
from ..runs import jobs
from . import road_arguments
from .release_arguments import Heights
from .run_arguments import Engine, engine_of

DESCRIPTION = "The slopes along a road: which bodies may fail, which stretches they block, how likely and how often."
EPILOG = """\
units: m, m3, Pa, degrees, kg/m3; minutes of all runs on this machine.

examples: search the corridor of 200 m to both sides, run each body four times, and write mine/route.html; the same
command continues after an interruption:
  tools/slope route mine --terrain dem.tif --road axis.geojson --road-width 8 --corridor 200 \\
      --cohesion 9e3 --friction 30 --density 1900 --volume 500 20000

how often per year each stretch is blocked: the fragility of its bodies, then the route again, without a new run:
  tools/slope fragility mine --density 1900 --cohesion lognormal:9e3:0.3:5e3:2e4 --friction 25:35 --peaks 50:1500:50 \\
      --pseudo-static 0.65 --hazard hazard.csv -o fragility
  tools/slope route mine --fragility fragility
  tools/slope export mine --zones 1/100,1/1000,1/5000

bodies that are known, polygons with an attribute depth (m) or volume (m3):
  tools/slope route known --terrain dem.tif --road axis.geojson --road-width 8 --corridor 200 --bodies slides.gpkg \\
      --cohesion 9e3 --friction 30 --density 1900

Writes FOLDER/route.html, results.yaml, stretches.csv, bodies.csv, pieces.csv, bodies_along.csv,
governing.tif and route.gpkg.
FOLDER/bodies/N is a site of its own: `slope study FOLDER/bodies/N`, `slope report FOLDER/bodies/N`.
"""


@dataclass(frozen=True, kw_only=True)
class Request(Heights, road_arguments.Clearing, Engine):
    """What is not given is that of route.yaml, where there is one."""
    folder: Path = positional("the route's folder, new or one to go on with", metavar="FOLDER")
    terrain: Optional[List[str]] = option("elevation model, as slope terrain takes it", metavar="DEM", nargs="+")
    crs: Optional[str] = option("wanted CRS of the terrain", metavar="EPSG:n")
    assign_crs: Optional[str] = option("the elevation model is in this CRS, whatever it says", metavar="EPSG:n")
    cell: Optional[float] = option("wanted cell size, m", metavar="S")
    fill: Optional[int] = option("fill NODATA holes of at most N cells", metavar="N")
    road: Optional[str] = option("the road's axis, a line: GeoJSON, shapefile, CSV or WKT", metavar="LINE")
    corridor: Optional[float] = option("bodies are searched up to this far on each side of the road, m", metavar="M")
    cohesion: Optional[float] = option("of the ground, Pa; this and the next not needed with --bodies", metavar="C")
    friction: Optional[float] = option("friction angle, degrees", metavar="PHI")
    density: Optional[float] = option("of the ground, kg/m3", metavar="R")
    water: Optional[float] = option("pore pressure over the weight per area (default: dry)", metavar="RU")
    volume: Optional[List[float]] = option(
        "limits of a body's volume, m3", metavar=("LO", "HI"), nargs=2, type=parse_number)
    depth: Optional[List[float]] = option(
        "limits of its greatest depth, m", metavar=("LO", "HI"), nargs=2, type=parse_number)
    keep: Optional[int] = option("bodies of a window of the search (default 3)", metavar="N", type=count)
    below: Optional[float] = option("bodies with a factor of safety below F may fail (default 1.5)", metavar="F")
    bodies: Optional[str] = option("no search: polygons with an attribute depth or thickness (m), or volume (m3)",
                                   metavar="POLYGONS")
    shape: Optional[str] = option("of the slip surfaces of --bodies, as of slope release (default sphere)",
                                  choices=[one for one in SHAPES if one != "plane"])
    ground: Optional[str] = option("zones of the ground, as slope site takes them", metavar="P|RASTER")
    ground_table: Optional[str] = option("of the classes of such a raster", metavar="CSV")
    reach: Optional[float] = option(
        "bodies of which a smaller share of known events go as far as the road are left out (default 0.01)",
        metavar="P")
    confined: Optional[str] = option(
        "whether valley sides confine the masses (default unknown)", choices=("yes", "no", "unknown"))
    sample: Optional[int] = option("runs of each body, of which more may be added later (default 4)", metavar="N",
                                   type=parse_whole_number)
    vary: Optional[List[str]] = option(
        "what differs between the runs, as of slope study (default rolling=0:0.1 and packing=1:1000000)",
        metavar="NAME=DISTRIBUTION", action="append")
    balls: Optional[int] = option("of each body (default 4000)", metavar="N", one_of="size")
    minutes: Optional[float] = option(
        "choose the size of the balls so that all runs take about so long on this machine", metavar="T", one_of="size")
    cut_angle: Optional[float] = option("rise of the cut from the road's edges, degrees (default 30)", metavar="DEG")
    mesh: Optional[float] = option("side of the mesh cells of the volume to remove, m (default 10)", metavar="SIZE")
    fragility: Optional[str] = option(
        "what `slope fragility FOLDER` wrote, with --hazard: also how often per year; may be given later",
        metavar="DIR")
    name: Optional[str] = option("of the route, for the report", metavar="NAME")
    client: Optional[str] = option("recipient of the report", metavar="CLIENT")
    author: Optional[str] = option("the person responsible", metavar="AUTHOR")


def quiet(_: Any) -> None:
    """For what is in the folder of each body."""


def tell(line: str) -> None:
    print(line, flush=True)


def run_route(args: Request) -> None:
    """Do the command; raises SlopeError on bad input, and after all other runs when one failed."""
    from ..plots import site_map
    from ..route import choices as route_choices, corridor, page, results, runs, search
    from ..sites import site

    given = {field.name: value for field in fields(route_choices.Choices)
             if (value := getattr(args, field.name)) is not None}
    folder, warn = args.folder, printer("route")
    try:
        with contextlib.ExitStack() as stack:
            with route_choices.undone_if_refused(folder, given) as choices:
                stack.enter_context(disk.alone_in(folder, "route"))
                stack.enter_context(jobs.signals_interrupt())
                ground = corridor.make_corridor(choices, folder, quiet, warn)
                lmp = find_lmp(args.lmp)
                table = search.search_route_bodies(choices, ground, folder, lmp, args.np, tell, warn)
                results.yearly_of(choices, folder, table["bodies"])      # now, not after the runs
                machine = site.Machine(lmp, args.jobs or jobs.cores())
                several = []
                for body in table["bodies"]:
                    new = not runs.folder_of(folder, body["body"]).exists()
                    place = runs.make_body_site(choices, folder, body, len(table["bodies"]), machine, quiet, quiet,
                                                site_map.draw_site_map)
                    if new:
                        factor = page.format_factor(body)
                        tell(f"body {body['body']} at {body['chainage_m']:.0f} m: {body['volume_m3']:,.0f} m3"
                             + f", factor of safety {factor}" * (factor != "-"))
                    several.append(runs.make_route_study(choices, place, engine_of(args)))
            if args.dry_run:
                tell("\n".join(runs.list_route_runs(several)))
                return
            failed = runs.make_route_runs(several, tell)
            if any(all(run.error for run in one.todo) for one in several):      # nothing is known of that body
                raise SlopeError(folder, f"runs of {len(failed)} bodies failed: {failed[0]}")
            found = results.make_route_results(choices, ground, folder, table)
            page.write_route_page(choices, ground, folder, found, warn)
    except OSError as error:
        raise SlopeError(error.filename or folder, f"cannot be used: {error.strerror}") from error
    tell("\n".join(page.sentences(found)))
    tell(f"written to {folder}: {page.PAGE} {' '.join(results.FILES)}; next: tools/slope export {quote(str(folder))} "
         "--zones P1,P2,...")
    if failed:
        raise SlopeError(folder, f"runs of {len(failed)} bodies failed: {failed[0]}")
