"""tools/slope: one program, one table of subcommands.

A subcommand NAME is the module slope_tools.commands.NAME (of IN_TESTS: tests/other_codes/NAME.py) with

    DESCRIPTION, EPILOG     its help, before and after the options
    Request                 its options, the fields of a frozen class: see options.py
    run_NAME(request)       does the work; raises SlopeError on bad input

Only the module that is asked for is imported: a subcommand starts fast, and needs only its own libraries.
"""
import argparse
import importlib
import importlib.util
import os
import re
import sys
import traceback
import warnings
from pathlib import Path

from . import disk, findings, options, streams
from .errors import SlopeError, not_imported
from .provenance import version

COMMANDS = {
    "terrain": "convert survey rasters (GeoTIFF, ESRI ASCII, FG-GML) to the plain terrain.asc that decks read",
    "polygon": "convert polygons (GeoJSON, shapefile, CSV, WKT) to the .csv in local metres that decks read",
    "release": "define the body that is released, by a polygon and a depth or a volume, or by a scar",
    "site": "make a folder with terrain, body, deck and map from GIS files, ready for study",
    "quake": "convert strong-motion records of networks, or as CSV, to the ground motion that decks read",
    "volume": "compute the volume to remove from a road, in total and for each mesh cell",
    "export": "write the rasters of a run as GeoTIFFs in the survey's coordinates",
    "vtk": "write a run's snapshots, ground and deposit as files for ParaView",
    "score": "compare a run's deposit with a mapped one: overlap, run-out, volume",
    "study": "run a deck for many values of its variables: table, maps, conservative volume",
    "calibrate": "find the values of a deck's variables that reproduce an observed deposit, and their uncertainty",
    "sensitivity": "vary one variable of a deck at a time: its effect on the volumes, compared with chance",
    "mobility": "estimate from known events how likely a mass passes each point of its fall path",
    "stability": "find the slip surfaces with the least factor of safety below a terrain",
    "fragility": "estimate how likely the bodies of find_slip fail at a peak acceleration, and how often per year",
    "route": "find the slopes along a road, run each, and say which stretch is blocked, how likely and how often",
    "verify": "check every case against closed forms and published numbers, and write a report",
    "report": "write one self-contained HTML page on a study or a run: maps, section, tables, warnings",
    "travel": "show where balls come to rest: cumulative distributions along and across the slope",
}
# those of developers, modules of tests/other_codes
IN_TESTS = {
    "bench": "measure the speed: against other codes, with more ranks, balls and ground",
    "crosscheck": "run the same scenes in other codes: bounce, slide, roll, rolling resistance, a collapse",
}
# older names of options: another command has the name for something else
RENAMED = {
    "polygon": {"--crs": "--assign-crs"}, "release": {"--crs": "--assign-crs"}, "mobility": {"--crs": "--assign-crs"},
    "calibrate": {"--volume": "--road-volume"}, "sensitivity": {"--vary": "--try"},
    "report": {"--project": "--name"}, "bench": {"--repeat": "--runs"},
}
BY_KIND = {"study", "export", "report", "vtk"}     # see blocks/kinds.py
WITHOUT_PLACES = {"quake", "verify", *IN_TESTS}      # no file of theirs has a CRS
TESTS = Path(__file__).resolve().parents[2] / "tests"


class Parser(argparse.ArgumentParser):
    """An ArgumentParser whose errors are one line, which takes no abbreviations of options, as each new option would
    break scripts that use them, and to which -1e-3 is a number, no option."""

    def __init__(self, *args, **kwargs):
        kwargs.setdefault("allow_abbrev", False)
        super().__init__(*args, **kwargs)
        self._negative_number_matcher = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")

    def error(self, message):
        say("error", self.prog.rpartition(" ")[2], message)
        self.exit(2)


def say(level, command, text):
    """An error or a note on standard error, as a line of words or of JSON."""
    if findings.as_json:
        findings.say_json(level, command=command, text=str(text))
    else:
        print(f"slope{f' {command}' * (command != 'slope')}: {'note: ' * (level == 'note')}{text}", file=sys.stderr)


def say_of_library(command, message, kind):
    """What a library warns of, as a line; what it is going to drop concerns only those who write programs."""
    if not issubclass(kind, (DeprecationWarning, PendingDeprecationWarning)):
        findings.printer(command)(str(message))


def module_of(name, parser):
    """The module of a subcommand; ends the program where it is not installed."""
    if name in COMMANDS:
        return importlib.import_module(f"{__package__}.commands.{name}")
    if not (TESTS / "other_codes" / f"{name}.py").is_file():
        say("error", name, "must be called in a checkout of SLOPE, whose tests/other_codes it needs, not in an "
            f"installation, got {TESTS.parent}")
        parser.exit(2)
    sys.path.append(str(TESTS))
    return importlib.import_module(f"other_codes.{name}")


def add_command(commands, name, module, **kwargs):
    """The parser of a subcommand, added to argparse's commands."""
    parser = commands.add_parser(name, formatter_class=argparse.RawDescriptionHelpFormatter, epilog=module.EPILOG,
                                 description=module.DESCRIPTION, **kwargs)
    parser.add_argument("--describe", action=options.Describe)
    options.declare(parser, module.Request)
    parser.set_defaults(run=lambda namespace: run_command(name, module, options.request(module.Request, namespace)))
    return parser


def run_command(name, module, request):
    """Do a subcommand, by the kind of the site that it may be given."""
    if name in BY_KIND:
        importlib.import_module(f"{__package__}.blocks.kinds").run_by_kind(name, module, request, print)
    else:
        getattr(module, f"run_{name}")(request)


def with_new_names(command, argv):
    """The words with the present names of options; a note on standard error for each older one."""
    names = RENAMED.get(command, {})
    words = []
    for word in argv:
        old, equals, value = word.partition("=")
        if old in names:
            say("note", command, f"{old} is {names[old]} now")
        words.append(names.get(old, old) + equals + value)
    return words


def check_names(words):
    """Raise SlopeError if a file, or the current folder, has a name that is not UTF-8: libraries and YAML need it."""
    places = {"the current folder": os.getcwd(), "LMP": os.environ.get("LMP", "")}
    places.update((word, os.path.realpath(word.replace("\0", ""))) for word in words)
    for word, place in places.items():
        if not (disk.is_utf8(word) and disk.is_utf8(place)):
            raise SlopeError(word if disk.is_utf8(word) else disk.escape_name(word), "must have a name in UTF-8: "
                             "rename it " "(names of an unpacked zip may be in another encoding)",
                             disk.escape_name(place) if disk.is_utf8(word) else None)


def forget_matplotlibrc():
    """Leave out a user's settings of matplotlib, of which wrong ones stop or clutter its import.

    drawing.pictures has those that count; a script that uses the package keeps its own.
    """
    os.environ.pop("MPLBACKEND", None)
    os.environ["MATPLOTLIBRC"] = os.devnull
    if os.path.isfile("matplotlibrc"):      # in the current folder it goes first
        here = os.open(".", os.O_RDONLY)
        try:
            os.chdir("/")
            importlib.import_module("matplotlib")
        finally:
            os.fchdir(here)
            os.close(here)


def main(argv=None):
    """Run one subcommand on argv (default: the command line); the status is 0, 1 (a bug), 2 (bad input) or 130."""
    argv = sys.argv[1:] if argv is None else argv
    parser = Parser(prog="slope", description="Tools of the SLOPE package: what goes into a deck and what comes out.",
                    epilog="`slope COMMAND --help` explains a command, with units and an example.")
    parser.add_argument("--version", action="version", version=f"SLOPE {version()}")
    parser.add_argument("--debug", action="store_true",
                        help="before COMMAND: where in the tools an error comes from, as a traceback")
    parser.add_argument("--progress", choices=("words", "json"), default="words",
                        help="before COMMAND: json: progress, warnings and errors as JSON, an object a line on "
                             "standard error, for programs that call this one (default words)")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    every = {**COMMANDS, **IN_TESTS}
    completes = "_ARGCOMPLETE" in os.environ and importlib.util.find_spec("argcomplete")     # a shell asks: Tab
    words = os.environ["COMP_LINE"].split() if completes else argv
    asked = next((word for word in words if word in every), None)
    before = argv[:argv.index(asked)] if asked in argv else argv
    findings.as_json = "--progress=json" in before or ("--progress", "json") in zip(before, before[1:])
    # named first: parsers of the others would be half of what a call takes
    for name in [asked] if asked is not None and argv[:1] == [asked] else every:
        if name == asked:
            try:
                module = module_of(name, parser)
            except ImportError as error:
                say("error", name, not_imported(error))
                return 2
            add_command(commands, name, module, help=every[name])
        else:
            commands.add_parser(name, help=every[name])
    if completes:
        importlib.import_module("argcomplete").autocomplete(parser)     # ends here
    args = parser.parse_args(with_new_names(asked, argv))
    shown = warnings.showwarning
    try:
        check_names(argv)
        forget_matplotlibrc()
        if asked not in WITHOUT_PLACES:
            importlib.import_module(f"{__package__}.survey.crs").require_database()
        warnings.showwarning = lambda message, kind, *_, **__: say_of_library(args.command, message, kind)
        args.run(args)
    except SlopeError as error:
        if args.debug:
            traceback.print_exc()
        say("error", asked, error)
        return 2
    except ImportError as error:
        say("error", asked, not_imported(error))
        return 2
    except MemoryError as error:
        say("error", asked, f"not enough memory: {error}")
        return 2
    except KeyboardInterrupt:
        say("error", asked, "interrupted")
        return 130
    except Exception as error:
        if args.debug:
            raise
        place = traceback.extract_tb(error.__traceback__)[-1]
        say("error", asked, f"a bug in the tools: {type(error).__name__}: {' '.join(str(error).split())[:200]} "
            f"({Path(place.filename).name}, line {place.lineno}); slope --debug {asked} shows where")
        return 1
    finally:
        warnings.showwarning = shown
    return 0


def program():
    """main() on the streams of streams.replace(): the status is 141 where a reader went away, as of `slope ... | head`,
    and 2 where what was to be said could not be written for another reason, such as a full disk."""
    try:
        status = main()
    except SystemExit as ended:     # argparse's: --help, or words that are wrong
        status = ended.code
    failed = streams.failure()
    if status or failed is None:
        return status
    name, error = failed
    if isinstance(error, BrokenPipeError):
        return 141
    say("error", next((word for word in sys.argv[1:] if word in {**COMMANDS, **IN_TESTS}), "slope"),
        f"{name}: {error.strerror}")
    return 2
