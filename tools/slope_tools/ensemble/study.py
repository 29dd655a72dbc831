"""Planning, checking and making the runs of a study."""
import argparse
import contextlib
import functools
import re

from .. import disk
from ..case import decks, run_folders
from ..case.data_files import data_files
from ..errors import SlopeError
from ..options import number
from ..programs import find_lmp
from ..survey import rasters
from . import jobs, launcher, results, slurm

MOST_LETTERS = 200      # of a folder's name; file systems take 255


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
    from ..survey import polygons
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
    known = {**decks.index_variables(deck), **chosen}
    for words in decks.commands(deck):
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
        about = one.folder / run_folders.VARIABLES
        if not about.is_file():
            raise SlopeError(one.folder, f"must be a run folder of a study, with {run_folders.VARIABLES}: remove it, "
                             "or give another -o")
        if disk.load_yaml(about, "what `slope study` wrote").get("set") != one.chosen:
            raise SlopeError(about, f"must be of the run {one.name}: remove the folder, or give another -o")


def list_runs(todo):
    for one in todo:
        told = " ".join(f"{name} {value}" for name, value in one.chosen.items())
        print(f"{one.name}: {told}, {one.state()}")
    done = sum(one.marker.exists() for one in todo)
    print(f"{len(todo)} runs, {done} of them finished")
