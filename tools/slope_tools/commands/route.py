"""slope route: the bodies along a corridor, runs of all of them, and how likely which stretch is blocked."""
from pathlib import Path
from shlex import quote

from .. import disk
from ..errors import SlopeError
from ..options import count, number, whole
from ..programs import find_lmp
from ..runs import jobs
from ..warned import printer
from . import road_arguments
from .run_arguments import add_engine, engine_of

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

Writes FOLDER/route.html, results.yaml, stretches.csv, bodies.csv, pieces.csv, governing.tif and route.gpkg.
FOLDER/bodies/N is a site of its own: `slope study FOLDER/bodies/N`, `slope report FOLDER/bodies/N`.
"""
# options that are kept in route.yaml, by what they are
TEXTS = {"road": "the road's axis, a line: GeoJSON, shapefile, CSV or WKT", "crs": "wanted CRS of the terrain, EPSG:n",
         "assign_crs": "the elevation model is in this CRS, whatever it says",
         "bodies": "no search: polygons with an attribute depth (m) or volume (m3)",
         "fragility": "what `slope fragility FOLDER` wrote, with --hazard: also how often per year",
         "name": "of the route, for the report",
         "client": "recipient of the report", "author": "the person responsible"}
NUMBERS = {"corridor": "bodies are searched up to this far on each side of the road, m",
           "cohesion": "Pa", "friction": "friction angle, degrees", "density": "kg/m3",
           "water": "pore pressure over the weight per area (default: dry)", "cell": "wanted cell size, m",
           "cut_angle": "rise of the cut from the road's edges (default 30)",
           "mesh": "side of mesh cells, m (default 10)",
           "below": "bodies with a factor of safety below this may fail (default 1.5)",
           "reach": "bodies of which a smaller share of known events go as far as the road are left out (default 0.01)",
           "minutes": "choose the size of the balls so that all runs take about so long on this machine"}
COUNTS = {"keep": "bodies of a window of the search (default 3)", "balls": "of each body (default 4000)",
          "fill": "fill NODATA holes of at most so many cells"}
PAIRS = {"volume": "limits of a body's volume, m3", "depth": "limits of its greatest depth, m"}


def add_arguments(parser):
    parser.add_argument("folder", metavar="FOLDER", type=Path, help="the route's folder, new or one to go on with")
    parser.add_argument("--terrain", metavar="DEM", nargs="+", help="elevation model, as slope terrain takes it")
    for texts, kind in ((TEXTS, None), (NUMBERS, number), (COUNTS, count)):
        for name, text in texts.items():
            parser.add_argument(f"--{name.replace('_', '-')}", metavar=name.upper(), type=kind, help=text)
    for name, text in PAIRS.items():
        parser.add_argument(f"--{name}", metavar=("LO", "HI"), nargs=2, type=number, help=text)
    road_arguments.add_clearing(parser)
    parser.add_argument("--confined", choices=("yes", "no", "unknown"), help="whether valley sides confine the masses")
    parser.add_argument("--sample", metavar="N", type=whole, help="runs of each body (default 4)")
    parser.add_argument("--vary", metavar="NAME=DISTRIBUTION", action="append", help="a variable of the runs, as of "
                        "slope study (default rolling=0:0.1 and xoffset=0:0.99)")
    add_engine(parser)


def run(args):
    """Do the command; raises SlopeError on bad input, and after all other runs when one failed."""
    from ..plots import site_map
    from ..route import choices as route_choices, corridor, page, results, runs, search
    from ..sites import site

    given = {name: value for name in route_choices.Choices._fields if (value := getattr(args, name, None)) is not None}
    folder, engine = args.folder, engine_of(args)
    choices = route_choices.settle(folder, given)
    warn = printer("route")

    def tell(line):
        print(line, flush=True)

    def quiet(_):
        """Of what is in the folder of each body."""
    try:
        with disk.alone_in(folder, "route"), jobs.signals_interrupt():
            ground = corridor.make(choices, folder, quiet, warn)
            lmp = find_lmp(args.lmp)
            table = search.make(choices, ground, folder, lmp, args.np, tell, warn)
            if not table["bodies"]:
                raise SlopeError(choices.road, "must be reached by a body, all are left out (--reach)", len(
                    table["left_out"]))
            results.yearly_of(choices, folder, table["bodies"])      # SlopeError now, not after the runs
            machine = site.Machine(lmp, args.jobs or jobs.cores(), lambda volume: choices.sample)
            several = []
            for about in table["bodies"]:
                new = not runs.folder_of(folder, about["body"]).exists()
                place = runs.make_site(choices, folder, about, len(table["bodies"]), machine, quiet, quiet,
                                       site_map.draw)
                if new:
                    tell(f"body {about['body']} at {about['chainage_m']:.0f} m: {about['volume_m3']:,.0f} m3, "
                         f"factor of safety {about['factor']:.3f}")
                several.append(runs.asked_of(choices, place, engine))
            if args.dry_run:
                return tell("\n".join(runs.listed(several)))
            failed = runs.make(several, tell)
            found = results.make(choices, ground, folder, table)
            page.write(choices, ground, folder, found, warn)
    except OSError as error:
        raise SlopeError(error.filename or folder, f"cannot be used: {error.strerror}") from error
    tell("\n".join(page.sentences(found)))
    tell(f"written to {folder}: route.html {' '.join(results.FILES)}; next: tools/slope export {quote(str(folder))} "
         "--zones P1,P2,...")
    if failed:
        raise SlopeError(folder, f"runs of {len(failed)} bodies failed: {failed[0]}")
    return None
