"""tools/slope: one program, one table of subcommands.

A subcommand NAME is the module slope_tools.commands.NAME with

    add_parser(commands, **kwargs)   calls commands.add_parser(NAME, **kwargs), adds its arguments, returns the parser
    run(args)                        does the work; raises SlopeError on bad input

Only the module that is asked for is imported: a subcommand starts fast, and needs only its own libraries.
"""
import argparse
import importlib
import os
import re
import sys
import traceback
from pathlib import Path

from .errors import SlopeError
from .provenance import version

COMMANDS = {
    "terrain": "survey rasters (GeoTIFF, ESRI ASCII) to the plain terrain.asc that decks read",
    "polygon": "polygons (GeoJSON, shapefile, CSV, WKT) to the .csv in local metres that decks read",
    "release": "the body that is released: slip surface below a polygon or from a scar, to a volume; lines of the deck",
    "site": "from the files of a GIS to a folder with terrain, body, deck and map, which study runs",
    "quake": "strong-motion records (K-NET, KiK-net, PEER AT2, CSV) to the motion of the ground that decks read",
    "volume": "what must be removed from a road, per mesh cell and in total, above a cut surface",
    "export": "every raster of a run as a GeoTIFF in the survey's coordinates, for a GIS",
    "score": "a run's deposit against a mapped one: overlap, run-out, volume",
    "study": "one deck over lists of its variables, several runs at a time: table, envelope, exceedance",
    "calibrate": "which values of a deck's variables give a deposit that was observed, and how well they are known",
    "sensitivity": "one variable of a deck at a time: what it does to the volumes, how far one run can be trusted",
    "mobility": "how likely a mass goes beyond each point of its fall path, by how far known events went",
    "stability": "slip surfaces with the least factor of safety below a terrain: map, bodies, table, warnings",
    "fragility": "how likely the bodies of find_slip fail at a peak acceleration, and how often per year",
    "bench": "how fast a collapse runs: against other codes, on larger terrains, on ranks, with more balls",
    "crosscheck": "the same scenes in other codes: bounce, slide, roll, rolling resistance, a collapse",
    "verify": "every case against closed forms and published numbers: a report to file",
    "report": "one self-contained HTML page on a study or a run: maps, section, tables, warnings",
    "travel": "where balls come to rest: cumulative distributions along and across the slope, over several runs",
}


class Parser(argparse.ArgumentParser):
    """An ArgumentParser whose errors are one line, and to which -1e-3 is a number, no option."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")

    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\n")


def main(argv=None):
    """Run one subcommand on argv (default: the command line); the status is 0, 1 (a bug), 2 (bad input) or 130."""
    argv = sys.argv[1:] if argv is None else argv
    parser = Parser(prog="slope", description="Tools of the SLOPE package: what goes into a deck and what comes out.",
                    epilog="`slope COMMAND --help` explains a command, with units and an example.")
    parser.add_argument("--version", action="version", version=f"SLOPE {version()}")
    parser.add_argument("--debug", action="store_true",
                        help="before COMMAND: where in the tools an error comes from, as a traceback")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    asked = next((word for word in argv if not word.startswith("-")), None)
    for name, summary in COMMANDS.items():
        if name == asked:
            module = importlib.import_module(f"{__package__}.commands.{name}")
            module.add_parser(commands, help=summary).set_defaults(run=module.run)
        else:
            commands.add_parser(name, help=summary)
    args = parser.parse_args(argv)
    try:
        args.run(args)
    except SlopeError as error:
        if args.debug:
            traceback.print_exc()
        print(f"slope {args.command}: {error}", file=sys.stderr)
        return 2
    except MemoryError as error:
        print(f"slope {args.command}: not enough memory: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"slope {args.command}: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:         # `slope ... | head`: nobody reads on
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except Exception as error:
        if args.debug:
            raise
        place = traceback.extract_tb(error.__traceback__)[-1]
        print(f"slope {args.command}: a bug in the tools: {type(error).__name__}: {' '.join(str(error).split())[:200]} "
              f"({Path(place.filename).name}, line {place.lineno}); slope --debug {args.command} shows where",
              file=sys.stderr)
        return 1
    return 0
