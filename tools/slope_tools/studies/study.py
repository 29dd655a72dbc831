"""Planning, checking and making the runs of a study."""
import argparse
import contextlib
import functools
from pathlib import Path
from typing import Callable, Iterator, NamedTuple, Optional, Sequence, Set

from .. import disk, kept
from ..case import decks
from ..case.data_files import data_files
from ..deposits import volume
from ..ensembles import known_events
from ..errors import SlopeError
from ..findings import Finding
from ..mobility import known
from ..options import parse_number
from ..programs import find_lmp
from ..runs import dependencies, jobs, launcher, slurm, store
from ..statistics import designs
from ..survey import rasters
from ..tables import intensity, study_types
from .setup import Road, Setup


def perform(setup: Setup, settings, todo, collect, begin=None, first=(), made=False):
    """Run what is not finished of todo; gives what collect(todo, work) then finds, None of a dry run.

    RunsFailed, with the same, if a run failed.

    begin: called once the folder is there, before the first run; first: runs of todo that are made before the others;
    made: they were made by this command, and are to be collected.
    """
    files = data_files(setup.deck, settings)
    if setup.road:
        check_deck_road(setup.road, setup.deck, settings)
    check_output(setup)
    if setup.dry_run:
        digests = {name: disk.sha256(source) for name, source in files.items()}
        depends = dependencies.Dependencies(setup.deck, digests, program_of(setup))
        store.Store(setup.runs, depends, setup.older, setup.anew).admit(todo)
        setup.tell("\n".join(list_runs(store.select_distinct_runs(todo))))
        return None
    with prepared(setup, files, len(todo)) as work:
        work.store.admit(todo)
        if begin:
            begin()
        once = store.select_distinct_runs(todo)     # of runs that share a folder the first in todo is made
        if not made:
            work.do([*(run for run in first if run in once), *todo])
        found = collect(todo, work)
    error = failure(setup.output, todo)
    if error:
        error.found = found
        raise error
    return found


def program_of(setup: Setup) -> Optional[Path]:
    """The LAMMPS program; None where none is given or built, which does not matter as long as nothing is run."""
    try:
        return find_lmp(setup.lmp)
    except SlopeError:
        if setup.lmp:
            raise
        return None


_ours: Set[Path] = set()      # folders that this command works in


@contextlib.contextmanager
def alone(folder: Path, only_read: bool = False) -> Iterator[None]:
    """No other command works in a folder meanwhile, unless this one only reads; within it, a study has it already."""
    place = folder.resolve()
    with contextlib.ExitStack() as stack:
        try:
            if not only_read and place not in _ours:
                stack.enter_context(disk.alone_in(folder))
                _ours.add(place)
                stack.callback(_ours.discard, place)
                stack.enter_context(kept.remembered(place))
        except OSError as error:
            raise SlopeError(folder, f"cannot be used: {error.strerror}") from error
        yield


@contextlib.contextmanager
def prepared(setup: Setup, files, number):
    """The jobs.Work of so many runs, while the output folder is ours; files: of data_files()."""
    lmp = find_lmp(setup.lmp)
    cores = jobs.cores()
    most = setup.jobs or max(1, cores // setup.ranks)
    make: Callable[..., jobs.Work] = jobs.Work
    launcher.check_launcher(setup.launcher, setup.ranks)
    if setup.engine == "slurm":
        slurm.check_slurm(setup.slurm)
        make = functools.partial(slurm.Work, options=setup.slurm, throttle=setup.jobs)
    elif setup.slurm:
        raise SlopeError("--slurm", "must be given with --engine slurm", setup.slurm)
    elif min(most, number) * setup.ranks > cores:
        setup.warn(Finding("ranks", {"runs": min(most, number), "ranks": setup.ranks, "cores": cores}))
    try:
        setup.home.mkdir(parents=True, exist_ok=True)
        inputs = setup.runs / ".inputs"
        with alone(setup.home), jobs.signals_interrupt(), jobs.copied(files, inputs) as digests:
            setup.output.mkdir(parents=True, exist_ok=True)
            yield make(setup.deck, digests, inputs, lmp, setup.ranks, most, setup.launcher, setup.older, setup.anew)
    except OSError as error:
        place = error.filename2 or error.filename or setup.output        # of a copy, the second is where it goes
        raise SlopeError(place, f"cannot be used: {error.strerror}") from error


class RunsFailed(SlopeError):
    """Runs failed; all others were made and collected: found, what these say."""
    found: Optional[study_types.Study] = None


def failure(output, todo) -> Optional[RunsFailed]:
    """What is to be raised if runs failed, with the first of them."""
    failed = [one for one in todo if one.error]
    more = f" and {len(failed) - 1} more" if len(failed) > 1 else ""
    return RunsFailed(output, f"{len(failed)} of {len(todo)} runs failed: {failed[0].name}{more}: "
                      f"{failed[0].error}") if failed else None


# --- what is asked for ---

class OfAKind(NamedTuple):
    """What goes with one kind of study only; None: not given."""
    intensity: Optional[str] = None                 # these two not with an ensemble
    more_than: Optional[Sequence[float]] = None     # m3
    of: Optional[str] = None                        # these with an ensemble only
    known: Optional[str] = None
    exceed_speed: Optional[str] = None              # m/s, J
    exceed_energy: Optional[str] = None
    design: Optional[str] = None
    seed: Optional[int] = None

    def settled(self, sample: bool) -> "OfAKind":
        """With the defaults, of an ensemble or not; SlopeError on what the other kind has."""
        for name, value in self._asdict().items():
            with_sample = name not in ("intensity", "more_than")
            if value is not None and with_sample != sample:
                raise SlopeError(f"--{name.replace('_', '-')}", "must be given with --sample only" if with_sample else
                                 "must not be given with --sample",
                                 value if isinstance(value, (str, int)) else ",".join(f"{one:g}" for one in value))
        defaults = OfAKind(None, (), None, None, "5", "100000", designs.SOBOL, 1)
        return self._replace(**{name: default for name, default in defaults._asdict().items()
                                if getattr(self, name) is None})


def check_more_than(volumes: Sequence[float], variable: Optional[str], settings, road: bool) -> None:
    """Raise SlopeError if volumes are given that no intensity has; variable: of --intensity."""
    if volumes and not intensity.check_intensity(variable, settings, road):
        raise SlopeError("--more-than", "needs an intensity (--intensity, or a variable of several values called peak, "
                         "pga or ...intensity) and --road", ",".join(f"{one:g}" for one in volumes))


def condition_of(choice: Optional[known.Choice], named: Optional[str], site: Optional[Path], left_out: Sequence[str],
                 confined: Optional[str]) -> Optional[known_events.Condition]:
    """The condition that known events make, None without a choice of them; SlopeError if these say more of none."""
    if choice:
        return known_events.check_condition(choice, named, site)
    for name, given in (("--except", left_out), ("--confined or --unconfined", confined is not None)):
        if given:
            raise SlopeError(name, "must be given with --known")
    return None


# --- what is to be run ---

def check_thresholds(text, option="--exceed", what="thicknesses"):
    """The thicknesses of --exceed, m, or what an option like it holds."""
    thresholds = []
    for part in text.split(","):
        try:
            value = parse_number(part)
        except argparse.ArgumentTypeError:
            value = -1.0
        if value < 0 or value in thresholds:
            raise SlopeError(option, f"must be different {what} >= 0, with commas between", text)
        thresholds.append(value)
    return thresholds


def check_deck_road(road: Road, deck: Path, settings) -> None:
    """Raise SlopeError now if the road cannot be used after the runs, as far as the deck names its terrain."""
    from ..survey import vectors
    volume.check_wanted_volume(volume.Wanted(road.file, road.mesh, road.cut_angle, asked=road.asked))
    if not vectors.is_there(road.file):
        raise SlopeError("--road", "must be an existing file", road.file)
    path = terrain_of(deck, {name: several[0] for name, several in settings.items()})
    if path:
        road.read(rasters.read_place(path))


def terrain_of(deck, chosen):
    """The terrain file that a deck names, with the values chosen of its variables; None if it is not in reach."""
    known = {**decks.index_variables(deck), **chosen}
    for words in decks.commands(deck):
        if words[0] == "region" and words[2:3] == ["terrain"] and len(words) > 3:
            path = deck.parent / decks.filled(words[3], known)
            return path if path.is_file() else None
    return None


def check_output(setup: Setup) -> None:
    """Raise SlopeError unless the output is a folder, or can become one."""
    if setup.output.exists() and not setup.output.is_dir():
        raise SlopeError("-o", "must be a folder", setup.output)
    if setup.output.exists() and setup.output.samefile(setup.deck.parent):
        raise SlopeError("-o", "must not be the folder of the deck", setup.output)


def list_runs(todo):
    """A line for each run, and one for all."""
    for one in todo:
        values = " ".join(f"{name} {value}" for name, value in one.chosen.items())
        yield f"{one.name}: {values}, {one.state()}"
    done = sum(one.finished for one in todo)
    yield f"{len(todo)} run{'s' * (len(todo) != 1)}, {done} of them finished"
