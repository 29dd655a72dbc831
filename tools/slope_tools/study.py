"""slope study: one deck over the product of lists of its variables, several runs at a time; a table and maps over all.

Order of the work: check the deck and the settings, plan the runs (repeats.py), make their folders and run what is not
finished (jobs.py), collect (results.py), combine (combinations.py, headline.py).
"""
import argparse
import contextlib
import functools
import os
import re
import shutil
from pathlib import Path

from . import intensity, jobs, launcher, rasters, repeats, results, runs, sample, slurm
from .cli import number
from .errors import SlopeError
from .settings import check_settings, one_value_each
from .size_error import SizeErrors

TOOLS = Path(__file__).resolve().parents[1]
# the program that belongs to these tools: of a checkout's build, or of an installation
BESIDE = (TOOLS.parent / "build" if (TOOLS.parent / "CMakeLists.txt").exists() else TOOLS.parents[2] / "bin") / "lmp"
MOST_LETTERS = 200      # of a folder's name; file systems take 255
# what runs, and the tools after them, leave in the deck's folder; a file that the deck reads is copied all the same
OUTPUTS = re.compile(r"^\.|^core|^log\.|\.(restart|dump|lammpstrj|vtp|vts|pvd)(\.gz)?$|\.(yaml|csv|tif)\.new$"
                     r"|\.summary\.yaml$|\.(png|jpe?g|svg|pdf|html|tif)$|~$", re.IGNORECASE)

EPILOG = """\
units: metres, seconds, m3 of ground (bulk); thresholds of --exceed in metres.

example: six runs, as many at a time as there are cores; the same command goes on after an interruption:
  tools/slope study inputs/20_embankment/in.embankment --set rolling=0:0.1:0.05 --set friction=25,30 -o out

with a conservative volume that counts the chance: every combination three times, from other offsets of the lattice:
  tools/slope study in.collapse --set rolling=0,0.1 --repeat xoffset=0.25,0.5 --road road.geojson -o out

an ensemble: 64 runs with values drawn from distributions, how likely a volume is exceeded, which variable matters:
  tools/slope study in.collapse --sample 64 --vary friction=20:40 --vary rolling=triangular:0:0:0.2 \\
      --road road.geojson -o out

Every run has a folder of its own in DIR, and is not repeated once it is finished. Over all runs: DIR/study.csv,
DIR/combinations.csv (mean and scatter), DIR/study.yaml, and the maps envelope_* (largest thickness) and exceedance_*
(share of the runs above a thickness).
"""


def count(text):
    """argparse type: a whole number from 1 on."""
    if not re.fullmatch(r"0*[1-9][0-9]{0,5}", text):
        raise argparse.ArgumentTypeError(f"must be a whole number >= 1, got {text!r}")
    return int(text)


def add_parser(commands, **kwargs):
    """Add `study` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "study", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Run one deck over the product of lists of its variables.", **kwargs)
    add_deck(parser)
    parser.add_argument("--set", metavar="NAME=V1,V2,...", action="append", default=[],
                        help="values of an index variable of the deck; A:B:STEP stands for A, A + STEP, ... up to B")
    sample.add_arguments(parser)
    repeats.add_arguments(parser)
    parser.add_argument("--size-error", metavar="FILE", type=Path,
                        help="converge.yaml of `slope sensitivity --converge`: its error at the size of these balls "
                             "counts in the conservative volume")
    parser.add_argument("--exceed", default="0.1,0.5,1", metavar="T1,T2,...",
                        help="thicknesses of the maps of exceedance, m (default 0.1,0.5,1)")
    parser.add_argument("--exceed-speed", default="5", metavar="V1,V2,...",
                        help="speeds of the maps of exceedance of an ensemble, m/s (default 5)")
    parser.add_argument("--exceed-energy", default="100000", metavar="E1,E2,...",
                        help="energies of a ball for the same, J (default 100000)")
    parser.add_argument("--of", metavar="NAME",
                        help="quantity of the hazard curve of an ensemble, a column of study.csv (default: "
                             "remove_on_road_m3; without a road distance_99_m)")
    intensity.add_arguments(parser)
    add_runs(parser)
    return parser


def add_deck(parser):
    parser.add_argument("deck", metavar="DECK", type=Path,
                        help="LAMMPS input deck with one fix deposit/grid; the plain files beside it are its data")


def add_runs(parser, road=False):
    """Arguments of how the runs are made and what is measured; road: it must be given."""
    parser.add_argument("-o", dest="output", metavar="DIR", required=True, type=Path, help="the study's folder")
    parser.add_argument("--np", type=count, default=1, metavar="N", help="MPI ranks of each run (default 1)")
    parser.add_argument("--jobs", type=count, metavar="J",
                        help="runs at a time (default: as many as the cores of this machine allow)")
    parser.add_argument("--road", metavar="POLYGON", type=Path, required=road,
                        help="tell the volume to remove from this road too: GeoJSON, shapefile, CSV or WKT")
    parser.add_argument("--cut-angle", metavar="DEG", type=number, default=30.0,
                        help="rise of the cut surface from the road's edges, degrees (default 30); see `slope volume`")
    parser.add_argument("--mesh", metavar="SIZE", type=number, default=10.0,
                        help="side of the mesh cells of that volume, m (default 10)")
    parser.add_argument("--local", action="store_true", help="the road is in local metres, not in a CRS")
    parser.add_argument("--lmp", metavar="FILE", help="the LAMMPS program (default: LMP of the environment, then "
                        "build/lmp beside tools/)")
    parser.add_argument("--dry-run", action="store_true", help="only list the runs")
    parser.add_argument("--launcher", metavar="COMMAND",
                        help="what starts the ranks of a run instead of mpirun, such as 'srun --mpi=pmix' or 'mpiexec "
                             "-n {np}'; without {np}, -n N is added")
    parser.add_argument("--engine", choices=("local", "slurm"), default="local",
                        help="local (default): runs on this machine; slurm: job arrays of a Slurm cluster, whose nodes "
                             "see DIR")
    parser.add_argument("--slurm", metavar="OPTIONS", default="",
                        help="options of sbatch for --engine slurm, such as '--partition=long --time=2:00:00'")


def run(args):
    """Do the command; raises SlopeError on bad input, and after all other runs when one failed."""
    settings = check_settings(args.set, args.deck)
    repeated = check_settings(args.repeat, args.deck, "--repeat")
    repeats.check(list(repeated), args.equally_good)
    thresholds = check_thresholds(args.exceed)
    defaults = runs.index_variables(args.deck)
    if args.sample is not None or args.vary:
        return run_ensemble(args, settings, repeated, thresholds, defaults)
    if not settings:
        raise SlopeError("--set", "must be given, or --sample with --vary")
    todo = repeats.plan(args.output, settings, repeated, defaults)
    check_names(todo)
    intensity.check(args.intensity, settings, bool(args.road))
    errors = None
    if args.size_error:
        if not args.road:
            raise SlopeError("--size-error", "needs --road: it is the error of the volume to remove", args.size_error)
        errors = SizeErrors(args.size_error, "remove_m3")
        errors.check(settings, defaults)
    return perform(args, {**settings, **repeated}, todo,
                   lambda todo, work: results.collect(args, settings, repeated, errors, todo, work, thresholds))


def run_ensemble(args, settings, repeated, thresholds, defaults):
    """The runs of --sample, and what they say together."""
    from . import ensemble, ensemble_maps
    if args.sample is None:
        raise SlopeError("--sample", "must be given with --vary: how many runs")
    if args.size_error:
        raise SlopeError("--size-error", "must not be given with --sample: an ensemble has no conservative volume",
                         args.size_error)
    fixed = one_value_each(settings, "--set", "--vary")
    plan = sample.check(args.sample, args.design, args.seed, args.vary, args.deck, fixed, repeated)
    levels = ensemble_maps.Thresholds(thresholds, check_thresholds(args.exceed_speed, "--exceed-speed", "speeds"),
                                      check_thresholds(args.exceed_energy, "--exceed-energy", "energies"))
    of = ensemble.check_quantity(args.of, args.road is not None)
    todo = sample.plan(args.output, plan, fixed, repeated, defaults)
    check_names(todo)
    sample.check_growth(args.output, plan)
    several = sample.settings_of(todo)
    perform(args, {**several, **repeated}, todo,
            lambda todo, work: results.collect(args, several, repeated, None, todo, work, thresholds,
                                               ensemble.Order(plan, of, levels)),
            begin=lambda: sample.keep(args.output, plan))


def perform(args, settings, todo, collect, begin=None):
    """Run what is not finished of todo, then collect(todo, work); SlopeError after that if a run failed.

    begin: called once the folder is there, before the first run.
    """
    files = data_files(args.deck, settings)
    if args.road:
        check_road(args, settings)
    check_folder(args, todo)
    if args.dry_run:
        return list_runs(todo)
    with prepared(args, files, len(todo)) as work:
        for one in todo:
            jobs.check_finished(one, args.deck, work.digests)
        if begin:
            begin()
        work.do(todo)
        collect(todo, work)
    raise_failed(args.output, todo)


@contextlib.contextmanager
def prepared(args, files, number):
    """The jobs.Work of so many runs, while the output folder is ours; files: of data_files()."""
    lmp = find_lmp(args.lmp)
    cores = jobs.cores()
    most = args.jobs or max(1, cores // args.np)
    make = jobs.Work
    launcher.check(args.launcher, args.np)
    if args.engine == "slurm":
        slurm.check(args.slurm)
        make = functools.partial(slurm.Work, options=args.slurm, throttle=args.jobs)
    elif args.slurm:
        raise SlopeError("--slurm", "must be given with --engine slurm", args.slurm)
    elif min(most, number) * args.np > cores:
        results.warn(f"{min(most, number)} runs of {args.np} ranks at a time on {cores} cores: they slow each other "
                     "down")
    try:
        args.output.mkdir(parents=True, exist_ok=True)
        inputs = args.output / ".inputs"
        with jobs.alone_in(args.output), jobs.signals_interrupt(), jobs.copied(files, inputs) as digests:
            yield make(args.deck, digests, inputs, lmp, args.np, most, args.launcher)
    except OSError as error:
        place = error.filename2 or error.filename or args.output        # of a copy, the second is where it goes
        raise SlopeError(place, f"cannot be used: {error.strerror}") from error


def raise_failed(output, todo):
    """SlopeError if runs failed, with the first of them."""
    failed = [one for one in todo if one.error]
    if failed:
        more = f" and {len(failed) - 1} more" if len(failed) > 1 else ""
        raise SlopeError(output, f"{len(failed)} of {len(todo)} runs failed: {failed[0].name}{more}: "
                         f"{failed[0].error}")


# --- what is to be run ---

def check_thresholds(text, option="--exceed", what="thicknesses"):
    """The thicknesses of --exceed, m, or what an option like it holds."""
    found = []
    for part in text.split(","):
        try:
            value = number(part)
        except argparse.ArgumentTypeError:
            value = -1.0
        if value < 0 or value in found:
            raise SlopeError(option, f"must be different {what} >= 0, with commas between", text)
        found.append(value)
    return found


def check_road(args, settings):
    """Raise SlopeError now if the road cannot be used after the runs, as far as the deck names its terrain."""
    from . import polygons
    if not args.road.is_file():
        raise SlopeError("--road", "must be an existing file", args.road)
    if not 0 < args.cut_angle < 90:
        raise SlopeError("--cut-angle", "must be > 0 and < 90 degrees", f"{args.cut_angle:g}")
    if args.mesh <= 0:
        raise SlopeError("--mesh", "must be > 0", f"{args.mesh:g}")
    path = terrain_of(args.deck, {name: several[0] for name, several in settings.items()})
    if path:
        polygons.read_local(args.road, rasters.read_place(path), args.local)


def terrain_of(deck, chosen):
    """The terrain file that a deck names, with the values chosen of its variables; None if it is not in reach."""
    known = {**runs.index_variables(deck), **chosen}
    for words in runs.commands(deck):
        if words[0] == "region" and words[2:3] == ["terrain"] and len(words) > 3:
            path = deck.parent / re.sub(r"\$\{(\w+)\}", lambda match: known.get(match[1], match[0]), words[3])
            return path if path.is_file() else None
    return None


def check_names(todo):
    """Raise SlopeError unless each run has a folder of its own."""
    names = {}
    for one in todo:
        if len(one.name) > MOST_LETTERS:
            raise SlopeError("--set", f"must make folder names of at most {MOST_LETTERS} letters", one.name)
        if one.name in names:
            raise SlopeError("--set", f"must not give two runs the folder {one.name}",
                             f"{list(names[one.name].values())} and {list(one.chosen.values())}")
        names[one.name] = one.chosen


def check_folder(args, todo):
    """Raise SlopeError unless the output is a folder, or can become one, whose run folders are this study's."""
    if args.output.exists() and not args.output.is_dir():
        raise SlopeError("-o", "must be a folder", args.output)
    if args.output.exists() and args.output.samefile(args.deck.parent):
        raise SlopeError("-o", "must not be the folder of the deck", args.output)
    for one in todo:
        if not one.folder.exists():
            continue
        about = one.folder / runs.VARIABLES
        if not about.is_file():
            raise SlopeError(one.folder, f"must be a run folder of a study, with {runs.VARIABLES}: remove it, or give "
                             "another -o")
        if runs.load_yaml(about, "what `slope study` wrote").get("set") != one.chosen:
            raise SlopeError(about, f"must be of the run {one.name}: remove the folder, or give another -o")


def list_runs(todo):
    for one in todo:
        told = " ".join(f"{name} {value}" for name, value in one.chosen.items())
        print(f"{one.name}: {told}, {one.state()}")
    done = sum(one.marker.exists() for one in todo)
    print(f"{len(todo)} runs, {done} of them finished")


def data_files(deck, settings):
    """{path in the run folder: source} of the deck and the data beside it.

    The plain files of the deck's folder, without what runs leave there, and files in folders below that a word of the
    deck or a value names.
    """
    folder = deck.parent
    words, written = runs.named_files(deck)
    words.update(value for several in settings.values() for value in several)
    left = set()
    for summary in runs.summaries(folder):
        left.update(map(str, runs.load_yaml(summary, "a summary of fix deposit/grid").get("files") or ()))
    found = {}
    for path in sorted(folder.iterdir()):
        output = OUTPUTS.search(path.name) or path.name in left or path.name in written
        if path.is_file() and (path.name in words or not output):
            found[path.name] = path
    found[deck.name] = deck
    for word in sorted(words):
        if "/" not in word or word.startswith("/") or "$" in word or not (folder / word).is_file():
            continue
        inside = os.path.normpath(word)
        if inside.startswith(".."):
            raise SlopeError(deck, "must find its data in its own folder (a symbolic link will do) or by an absolute "
                             "path", word)
        found[inside] = folder / word
    return found


def find_lmp(option):
    """Absolute path of the LAMMPS program."""
    for where, path in (("--lmp", option), ("LMP in the environment", os.environ.get("LMP")),
                        ("--lmp is not given, LMP is not set", BESIDE)):
        if path:
            path = Path(shutil.which(path) or path).absolute()
            if not (path.is_file() and os.access(path, os.X_OK)):
                raise SlopeError(where, "must lead to the LAMMPS program", path)
            return path
