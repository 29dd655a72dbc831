"""slope study: one deck over the product of lists of its variables, several runs at a time; a table and maps over all.

Order of the work: check the deck and the settings, make the run folders, run what is not finished, collect.
"""
import argparse
import contextlib
import csv
import datetime
import decimal
import fcntl
import hashlib
import io
import itertools
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Dict, NamedTuple

import numpy as np
import yaml
from rich.console import Console
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table

from . import rasters, runs
from .cli import number
from .errors import SlopeError

TOOLS = Path(__file__).resolve().parents[1]
MOST_RUNS = 10_000
MOST_LETTERS = 200      # of a folder's name; file systems take 255
POLL = 0.1              # s between two looks at the runs
TELL = 30.0             # s between two lines about a run, where there is no terminal
PATIENCE = 10.0         # s that a run gets to end after SIGTERM
BALANCE = 1e-9          # of the released volume
SCREEN = "screen.txt"
# what runs, and the tools after them, leave in the deck's folder; a file that the deck names is copied all the same
OUTPUTS = re.compile(r"^\.|^core|^log\.|\.(restart|dump|lammpstrj|vtp|vts|pvd)(\.gz)?$|\.(yaml|csv|tif)\.new$"
                     r"|\.summary\.yaml$|\.(png|jpe?g|svg|pdf|html|tif)$|~$", re.IGNORECASE)
SAFE = re.compile(r"[^A-Za-z0-9.+-]+")

EPILOG = """\
units: metres, seconds, m3 of ground (bulk); thresholds of --exceed in metres.

example: nine runs, two at a time on one core each; the same command goes on after an interruption:
  tools/slope study inputs/20_embankment/in.embankment --set d=2.5 --set rolling=0:0.1:0.05 --set friction=25,30,35 -o out

Every run has a folder of its own in DIR, and is not repeated once it is finished. Over all runs: DIR/study.csv,
DIR/study.yaml, and the maps envelope_* (largest thickness) and exceedance_* (share of the runs that exceed a thickness).
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
    parser.add_argument("deck", metavar="DECK", type=Path,
                        help="LAMMPS input deck with one fix deposit/grid; the plain files beside it are its data")
    parser.add_argument("--set", metavar="NAME=V1,V2,...", action="append", default=[], required=True,
                        help="values of an index variable of the deck; A:B:STEP stands for A, A + STEP, ... up to B")
    parser.add_argument("-o", dest="output", metavar="DIR", required=True, type=Path, help="the study's folder")
    parser.add_argument("--np", type=count, default=1, metavar="N", help="MPI ranks of each run (default 1)")
    parser.add_argument("--jobs", type=count, metavar="J",
                        help="runs at a time (default: as many as the cores of this machine allow)")
    parser.add_argument("--exceed", default="0.1,0.5,1", metavar="T1,T2,...",
                        help="thicknesses of the maps of exceedance, m (default 0.1,0.5,1)")
    parser.add_argument("--road", metavar="POLYGON", type=Path,
                        help="tell the volume to remove from this road too: GeoJSON, shapefile, CSV or WKT")
    parser.add_argument("--cut-angle", metavar="DEG", type=number, default=30.0,
                        help="rise of the cut surface from the road's edges, degrees (default 30); see `slope volume`")
    parser.add_argument("--mesh", metavar="SIZE", type=number, default=10.0,
                        help="side of the mesh cells of that volume, m (default 10)")
    parser.add_argument("--local", action="store_true", help="the road is in local metres, not in a CRS")
    parser.add_argument("--lmp", metavar="FILE", help="the LAMMPS program (default: LMP of the environment, then "
                        "build/lmp beside tools/)")
    parser.add_argument("--dry-run", action="store_true", help="only list the runs")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input, and after all other runs when one failed."""
    settings = check_settings(args.set, args.deck)
    thresholds = check_thresholds(args.exceed)
    files = data_files(args.deck, settings)
    if args.road:
        check_road(args, settings)
    todo = plan(args.output, settings)
    check_folder(args, todo)
    if args.dry_run:
        return list_runs(todo)
    lmp = find_lmp(args.lmp)
    jobs = args.jobs or max(1, cores() // args.np)
    if args.np > 1 and not shutil.which("mpirun"):
        raise SlopeError("--np", "needs mpirun, which is not on the PATH, unless it is 1", args.np)
    if min(jobs, len(todo)) * args.np > cores():
        warn(f"{min(jobs, len(todo))} runs of {args.np} ranks at a time on {cores()} cores: they slow each other down")

    args.output.mkdir(parents=True, exist_ok=True)
    with alone_in(args.output), signals_interrupt(), copied(files, args.output / ".inputs") as digests:
        for one in todo:
            check_finished(one, args.deck, digests)
        work = Work(args.deck, digests, args.output / ".inputs", lmp, args.np, jobs)
        work.do(todo)
        collect(args, settings, todo, work, thresholds)
    failed = [one for one in todo if one.error]
    if failed:
        more = f" and {len(failed) - 1} more" if len(failed) > 1 else ""
        raise SlopeError(f"{args.output}", f"{len(failed)} of {len(todo)} runs failed: {failed[0].name}{more}: "
                         f"{failed[0].error}")


def warn(text):
    print(f"slope study: warning: {text}", file=sys.stderr)


def cores():
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))


# --- what is to be run ---

def check_settings(options, deck):
    """{name: [values]} of the --set options, in their order; every name must be an index variable of the deck."""
    found = runs.variables(deck)
    known = {name for name, (style, _) in found.items() if style == "index"}
    fixes = [words for words in runs.commands(deck) if words[0] == "fix" and words[3:4] == ["deposit/grid"]]
    if len(fixes) != 1:
        raise SlopeError(deck, "must have one fix deposit/grid, which gives the deposit", len(fixes))
    settings = {}
    for option in options:
        name, equals, text = option.partition("=")
        if not (equals and name):
            raise SlopeError("--set", "must be NAME=V1,V2,... or NAME=A:B:STEP", option)
        if name not in known:
            style = f"{name} of style {found[name][0]}" if name in found else name
            raise SlopeError("--set", f"must name an index variable of {deck} ({', '.join(sorted(known)) or 'none'})",
                             style)
        if name in settings:
            raise SlopeError("--set", "must name a variable once", f"{name} twice")
        settings[name] = values(option, text)
    total = 1
    for several in settings.values():
        total *= len(several)
    if total > MOST_RUNS:
        raise SlopeError("--set", f"must make at most {MOST_RUNS} runs", total)
    return settings


def values(option, text):
    """The values that the right side of a --set option stands for, as text."""
    found = []
    for part in text.split(","):
        ends = part.split(":")
        if not part.strip():
            raise SlopeError("--set", "must have no empty value", option)
        try:
            numbers = [decimal.Decimal(end) for end in ends] if len(ends) == 3 else None
        except decimal.InvalidOperation:
            numbers = None
        if numbers is None:
            found.append(part)
            continue
        start, stop, step = numbers
        if not all(end.is_finite() for end in numbers) or step == 0 or (stop - start) / step < 0:
            raise SlopeError("--set", "A:B:STEP must have a STEP that leads from A to B", option)
        if (stop - start) / step >= MOST_RUNS:
            raise SlopeError("--set", f"must make at most {MOST_RUNS} runs", option)
        found += [plain(start + i * step) for i in range(int((stop - start) / step) + 1)]
    keys = [as_number(value) for value in found]
    for i, key in enumerate(keys):
        if key in keys[:i]:
            raise SlopeError("--set", "must have every value once", f"{option} with {found[i]} twice")
    return found


def plain(value):
    """A decimal as text, without trailing zeros and, if it is short, without an exponent."""
    value = value.normalize() + 0
    return f"{value:f}" if -12 < value.adjusted() < 12 else str(value)


def as_number(text):
    """A value as a float where it is one, so that 0.1 and 0.10 are one value; else the text."""
    try:
        return float(text)
    except ValueError:
        return text


def check_thresholds(text):
    """The thicknesses of --exceed, m."""
    found = []
    for part in text.split(","):
        try:
            value = number(part)
        except argparse.ArgumentTypeError:
            value = -1.0
        if value < 0 or value in found:
            raise SlopeError("--exceed", "must be different thicknesses >= 0, with commas between", text)
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
    known = {**runs.index_variables(args.deck), **{name: several[0] for name, several in settings.items()}}
    for words in runs.commands(args.deck):
        if words[0] == "region" and words[2:3] == ["terrain"] and len(words) > 3:
            path = args.deck.parent / re.sub(r"\$\{(\w+)\}", lambda match: known.get(match[1], match[0]), words[3])
            if path.is_file():
                polygons.read_local(args.road, rasters.read_place(path), args.local)
            return


class Run:
    """One run: its values, its folder, and what became of it."""

    def __init__(self, output, chosen):
        self.chosen: Dict[str, str] = chosen
        self.name = "_".join(f"{name}_{SAFE.sub('-', value)}" for name, value in chosen.items())
        self.folder = Path(output) / self.name
        self.varied = self.name     # for a narrow terminal: the values that differ
        self.error = None
        self.log = runs.Log(self.folder / runs.LOG)

    @property
    def marker(self):
        return self.folder / runs.MARKER

    def state(self):
        if self.marker.exists():
            return "finished"
        return "unfinished" if self.folder.exists() else "new"

    def fail(self, status):
        """Keep why it failed: the ERROR line of its log, else what was last heard of it."""
        how = f"ended with status {status}" if status >= 0 else f"ended by {signal.Signals(-status).name}"
        if status == 0:
            how = "lmp ended with status 0, but left no complete run"
        error = self.log.update().error
        screen = self.folder / SCREEN
        if error is None and screen.exists():       # a rank other than 0 tells its errors there only
            error = runs.Log(screen).update().error or runs.last_words(screen)
        self.error = f"{error or 'no word in its log'} ({how}; see {self.folder / runs.LOG})"


def plan(output, settings):
    """The runs of the product of all settings, the last one varying fastest."""
    todo = [Run(output, dict(zip(settings, chosen))) for chosen in itertools.product(*settings.values())]
    names = {}
    for one in todo:
        if len(one.name) > MOST_LETTERS:
            raise SlopeError("--set", f"must make folder names of at most {MOST_LETTERS} letters", one.name)
        if one.name in names:
            raise SlopeError("--set", f"must not give two runs the folder {one.name}",
                             f"{list(names[one.name].values())} and {list(one.chosen.values())}")
        names[one.name] = one.chosen
        one.varied = ", ".join(f"{name} {one.chosen[name]}" for name, several in settings.items()
                               if len(several) > 1) or one.name
    return todo


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
    words = {word for command in runs.commands(deck) for word in command}
    words.update(value for several in settings.values() for value in several)
    left = set()
    for summary in runs.summaries(folder):
        left.update(map(str, runs.load_yaml(summary, "a summary of fix deposit/grid").get("files") or ()))
    found = {}
    for path in sorted(folder.iterdir()):
        output = OUTPUTS.search(path.name) or path.name in left
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
                        ("--lmp is not given, LMP is not set", TOOLS.parent / "build" / "lmp")):
        if path:
            path = Path(shutil.which(path) or path).absolute()
            if not (path.is_file() and os.access(path, os.X_OK)):
                raise SlopeError(where, "must lead to the LAMMPS program", path)
            return path


def sha256(path):
    """Of a file, in hexadecimal."""
    digest = hashlib.sha256()
    with open(path, "rb") as data:
        for block in iter(lambda: data.read(1 << 20), b""):
            digest.update(block)
    return digest.hexdigest()


@contextlib.contextmanager
def copied(files, folder):
    """Copy the deck and its data: what is edited while the study runs does not reach its later runs.

    Gives {name: digest}.
    """
    shutil.rmtree(folder, ignore_errors=True)
    try:
        for name, source in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, folder / name)
        yield {name: sha256(folder / name) for name in files}
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def check_finished(one, deck, digests):
    """Raise SlopeError if a finished run was made from files that are not the present ones."""
    if not one.marker.exists():
        return
    for name, digest in (runs.load_yaml(one.marker, "what `slope study` wrote").get("inputs") or {}).items():
        if digests.get(name, digest) != digest:
            raise SlopeError(one.folder, f"was run with another {name} than that of {deck.parent}: remove the folder "
                             "to run it again, or give another -o")


# --- running ---

@contextlib.contextmanager
def alone_in(folder):
    """No other study works in the folder meanwhile; the lock goes when the process does."""
    with open(folder / ".lock", "w", encoding="ascii") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise SlopeError(folder, "must not be in use by another study") from None
        yield


@contextlib.contextmanager
def signals_interrupt():
    """What a batch system or a closed terminal sends ends the study as Ctrl-C does."""
    def interrupt(*_):
        raise KeyboardInterrupt
    before = {name: signal.signal(name, interrupt) for name in (signal.SIGTERM, signal.SIGHUP)
              if signal.getsignal(name) != signal.SIG_IGN}      # nohup ignores SIGHUP
    try:
        yield
    finally:
        for name, handler in before.items():
            signal.signal(name, handler)


def package_version():
    """What `git describe` calls the package, None where it is no git checkout."""
    try:
        done = subprocess.run(["git", "-C", TOOLS, "describe", "--always", "--tags", "--dirty"], text=True, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    except OSError:
        return None
    return done.stdout.strip() or None


class Active(NamedTuple):
    """A run under way."""
    run: Run
    process: subprocess.Popen
    began: float            # time.monotonic()


class Work:
    """Runs the deck in the run folders, some at a time."""

    def __init__(self, deck, digests, inputs, lmp, ranks, jobs):
        self.deck, self.digests, self.inputs = deck, digests, inputs
        self.lmp, self.ranks, self.jobs = lmp, ranks, jobs
        self.package = package_version()
        self.lmp_digest = sha256(lmp)
        self.defaults = runs.index_variables(inputs / deck.name)
        self.active = []

    def do(self, todo):
        """Run what is not finished. On an interruption, end the runs under way and leave their folders unfinished."""
        waiting = [one for one in todo if not one.marker.exists()]
        with Display(todo, waiting, self.jobs) as display:
            try:
                while waiting or self.active:
                    while waiting and len(self.active) < self.jobs:
                        one = waiting.pop(0)
                        self._start(one)
                        display.started(one)
                    time.sleep(POLL)
                    for active in list(self.active):
                        active.run.log.update()
                        if active.process.poll() is not None:
                            self.active.remove(active)
                            self._ended(active)
                            display.ended(active)
                    display.update(self.active, len(waiting))
            except BaseException:
                self._stop()
                raise

    def command(self, chosen):
        """Arguments of lmp."""
        words = ["-in", self.deck.name, "-log", runs.LOG]
        for name, value in chosen.items():
            words += ["-var", name, value]
        return words

    def _start(self, one):
        try:
            self._make_folder(one)
            environment = {**os.environ, "OMP_NUM_THREADS": "1"}
            before = []
            if shutil.which("setpriv"):     # a run does not outlive a study that was killed
                before += ["setpriv", "--pdeathsig", "TERM"]
            if self.ranks > 1:
                before += ["mpirun", "-np", str(self.ranks), "--bind-to", "none"]
                if self.ranks > physical_cores():
                    before += ["--oversubscribe"]
                if os.geteuid() == 0:
                    environment.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
            with open(one.folder / SCREEN, "wb") as screen:
                # a session of its own: Ctrl-C reaches the study, which then ends the run
                process = subprocess.Popen([*before, self.lmp, *self.command(one.chosen)], cwd=one.folder,
                                           env=environment, stdin=subprocess.DEVNULL, stdout=screen,
                                           stderr=subprocess.STDOUT, start_new_session=True)
        except OSError as error:
            raise SlopeError(one.folder, f"cannot be run: {error.strerror} ({error.filename})") from error
        self.active.append(Active(one, process, time.monotonic()))

    def _make_folder(self, one):
        """The folder with all that goes into the run, instead of one of an unfinished run."""
        new = one.folder.with_name(f".{one.name}.new")
        old = one.folder.with_name(f".{one.name}.old")
        for rest in (new, old):
            shutil.rmtree(rest, ignore_errors=True)
        shutil.copytree(self.inputs, new)
        about = {"deck": self.deck.name, "set": one.chosen, "variables": {**self.defaults, **one.chosen},
                 "command": " ".join([self.lmp.name, *self.command(one.chosen)]), "ranks": self.ranks,
                 "package": self.package, "lmp_sha256": self.lmp_digest, "started": runs.now()}
        runs.write(new / runs.VARIABLES, yaml.safe_dump(about, sort_keys=False))
        if one.folder.exists():
            one.folder.rename(old)
        new.rename(one.folder)
        shutil.rmtree(old, ignore_errors=True)

    def _ended(self, active):
        """Mark the run as finished, or keep why it is not."""
        one, status = active.run, active.process.returncode
        summaries = runs.summaries(one.folder)
        if status != 0 or len(summaries) != 1:
            return one.fail(status)
        try:
            summary = runs.load_summary(summaries[0])
            if summary["ranks"] != self.ranks:
                raise SlopeError(self.lmp, f"must be built with MPI to run on {self.ranks} ranks", summary["ranks"])
        except SlopeError as error:
            one.error = str(error)
            return None
        one.log.update()
        # what the run used, and did not overwrite
        inputs = {name: digest for name, digest in self.digests.items()
                  if (name == self.deck.name or name in one.log.names) and sha256(one.folder / name) == digest}
        about = {"finished": runs.now(), "wall_seconds": round(time.monotonic() - active.began, 1),
                 "summary": summaries[0].name, "machine": runs.machine(),
                 "inputs": inputs}
        runs.write(one.marker, yaml.safe_dump(about, sort_keys=False))
        return None

    def _stop(self):
        """End the runs under way, each by its own process id."""
        for active in self.active:
            active.process.terminate()
        deadline = time.monotonic() + PATIENCE
        for active in self.active:
            try:
                active.process.wait(max(0.1, deadline - time.monotonic()))
            except subprocess.TimeoutExpired:
                active.process.kill()
                active.process.wait()
        self.active.clear()


def physical_cores():
    """What mpirun takes as its number of slots."""
    siblings = {path.read_text(encoding="ascii") for path in
                Path("/sys/devices/system/cpu").glob("cpu[0-9]*/topology/thread_siblings_list")}
    return min(len(siblings) or 1, cores())


# --- progress ---

class Display:
    """Shows how far the runs are: a table that renews itself on a terminal, else a line now and then."""

    def __init__(self, todo, waiting, jobs):
        self.total, self.waiting, self.jobs = len(todo), len(waiting), jobs
        self.numbers = {one.name: i for i, one in enumerate(todo, 1)}
        self.ended_runs = self.failed = 0
        self.walls = []
        self.told = {}      # name -> when the last line about it was printed
        self.live = None
        if sys.stderr.isatty():
            # without auto_refresh there is no thread, and the study may fork
            self.live = Live(console=Console(stderr=True), auto_refresh=False, transient=True)
        self.done_before = self.total - self.waiting

    def __enter__(self):
        if self.done_before:
            self.say(f"{self.done_before} of {self.total} runs are finished already")
        if self.live:
            self.live.start()
        return self

    def __exit__(self, kind, *_):
        if self.live:
            self.live.stop()
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            done = self.done_before + self.ended_runs - self.failed
            self.say(f"stopped with {done} of {self.total} runs finished; the same command goes on")

    def say(self, line):
        if self.live:
            self.live.console.print(line, markup=False, highlight=False)
        else:
            print(line, flush=True)

    def label(self, one):
        return f"[{self.numbers[one.name]}/{self.total}] {one.name}"

    def started(self, one):
        self.told[one.name] = time.monotonic()
        if not self.live:
            self.say(f"{self.label(one)}: started")

    def ended(self, active):
        one, wall = active.run, time.monotonic() - active.began
        self.ended_runs += 1
        self.walls.append(wall)
        if one.error:
            self.failed += 1
            self.say(f"{self.label(one)}: failed: {one.error}")
        else:
            at = f" at {one.log.time:.1f} s" if one.log.time is not None else ""
            self.say(f"{self.label(one)}: finished{at}, wall time {duration(wall)}")

    def update(self, active, waiting):
        if self.live:
            return self.live.update(self._table(active, waiting), refresh=True)
        for job in active:
            if time.monotonic() - self.told[job.run.name] > TELL:
                self.told[job.run.name] = time.monotonic()
                _, text, end = self._progress(job)
                self.say(f"{self.label(job.run)}: {text}" + (f", ends by {end}" if end else ""))
        return None

    @staticmethod
    def _progress(job):
        """Share done (None if not known), what to say of it, and when it will have ended at the latest."""
        log = job.run.log
        if log.thermo == 0:
            return None, "setting up", ""
        text = f"step {log.step}" + (f" of {log.last}" if log.last else "")
        if log.time is not None:
            text += f", {log.time:.2f} s"
        if not log.last or log.last <= log.first:
            return None, text, ""
        share = (log.step - log.first) / (log.last - log.first)
        spent = time.monotonic() - job.began
        return share, text, clock(spent * (1 - share) / share) if share > 0 else ""

    def _table(self, active, waiting):
        table = Table(box=None, padding=(0, 2, 0, 0))
        table.add_column("run", no_wrap=True)
        table.add_column("", no_wrap=True)
        for head in ("step", "ends by"):
            table.add_column(head, no_wrap=True, min_width=8)
        for job in active:
            share, text, end = self._progress(job)
            table.add_row(f"[{self.numbers[job.run.name]}/{self.total}] {job.run.varied}", ProgressBar(100, 100 * (share or 0), width=12), text, end)
        ends = ""
        if self.walls and waiting:
            ends = clock(sum(self.walls) / len(self.walls) * (waiting + len(active) / 2) / self.jobs)
        table.add_row(f"{self.done_before + self.ended_runs - self.failed} of {self.total} finished"
                      + (f", {self.failed} failed" if self.failed else ""), "", f"{waiting} waiting", ends,
                      style="dim")
        return table


def duration(seconds):
    """Such as 1:02:03, or 4.5 s."""
    return f"{seconds:.1f} s" if seconds < 60 else str(datetime.timedelta(seconds=round(seconds)))


def clock(seconds):
    """The time of day in so many seconds, with the date if that is not today."""
    today = datetime.datetime.now()
    then = today + datetime.timedelta(seconds=seconds)
    return then.strftime("%H:%M:%S" if then.date() == today.date() else "%Y-%m-%d %H:%M")


# --- what came out ---

def collect(args, settings, todo, work, thresholds):
    """Table, maps and study.yaml over all runs that finished."""
    output, deck = args.output, args.deck
    maps = Maps(thresholds)
    warnings, rows = [], []
    for one in rasters.progress(todo, "collecting the runs"):
        row = {"run": one.name, "status": "failed" if one.error else "finished", "set": one.chosen}
        if one.error:
            rows.append({**row, "error": one.error, "log_warnings": one.log.warnings})
            continue
        row = result(one, row, maps)
        if args.road:
            row.update(on_road(one, args, output / row["summary"]))
        rows.append(row)
    for row in rows:
        if row["status"] == "failed":
            warnings.append(f"{row['run']}: failed: {row['error']}")
            continue
        if row["moving"]:
            warnings.append(f"{row['run']}: the deposit still moves at the end, {row['stop_time_s']:.1f} s: its "
                            f"numbers are not those of a deposit at rest ({100 * row['moving_share']:.0f} % of the "
                            f"volume moves)")
        left = row["off_grid_m3"] + row["lost_m3"]
        if left > 1e-6 * row["released_m3"]:
            warnings.append(f"{row['run']}: {left:.6g} m3 left the grid or the box")
        if not abs(row["mass_error"]) <= BALANCE:
            warnings.append(f"{row['run']}: the volume in the thickness raster differs from released - off the grid - "
                            f"lost by {row['mass_error']:.1e} of the released volume")
    finished = [row for row in rows if row["status"] == "finished"]
    of_road = {}
    for row in finished:
        for text in row.get("road_warnings", ()):
            of_road.setdefault(text, []).append(row["run"])
    for text, names in of_road.items():
        warnings.append(text if len(names) == len(finished) else f"{', '.join(names)}: {text}")
    for what in ("slope_version", "lammps_version", "lmp_sha256"):
        if len({row[what] for row in finished}) > 1:
            warnings.append(f"the runs are of different programs: {what} "
                            + ", ".join(sorted({str(row[what]) for row in finished})))
    if maps.problem:
        warnings.append(maps.problem)
    place = terrain_place(next(one for one in todo if not one.error)) if finished else None
    written = maps.write(output, place)
    about = {
        "study": {"deck": deck.name, "set": settings, "runs": len(rows), "finished": len(finished),
                  "ranks": work.ranks, "jobs": work.jobs, "package": work.package, "collected": runs.now(),
                  "machine": runs.machine()},
        "largest": {key: largest(finished, key) for key in ("front_m", "thickness_m", "max_thickness_m",
                                                            "max_speed_m_s") if finished},
        "conservative": None, **written, "warnings": warnings, "runs": rows}
    if args.road and finished:
        about["study"]["road"] = write_road(args, finished[0], place)
        about["conservative"] = conservative(settings, rows, finished)
    for text in warnings:
        warn(text)
    runs.write(output / "study.csv", table(settings, rows))
    runs.write(output / "study.yaml", "# slope study: volumes in m3 of ground (bulk), lengths in m, times in s\n"
               + yaml.safe_dump(about, sort_keys=False))
    print_table(settings, rows, f"{deck.name}: {len(rows)} runs, volumes in m3 of ground")
    print(f"{output / 'study.yaml'}, {output / 'study.csv'}: all numbers")
    if about["conservative"]:
        print(told(about["conservative"]))
    for entry in [*(written["envelope"] or {}).values(), *(written["exceedance"] or ())]:
        print(f"{output / entry['file']}: {entry['what']}")


def result(one, row, maps):
    """The row of a finished run; adds its rasters to the maps."""
    marker = runs.load_yaml(one.marker, "what `slope study` wrote")
    path = one.folder / str(marker.get("summary"))
    about = runs.load_yaml(one.folder / runs.VARIABLES, "what `slope study` wrote")
    summary = runs.load_summary(path)
    prefix = runs.prefix_of(path)
    thickness = runs.load_raster(prefix, "thickness")
    maps.add(one.name, thickness, runs.load_raster(prefix, "max_thickness"))
    one.log.update()
    volume, travel = summary["volume"], summary["travel"]
    stays = volume["released"] - volume["off_grid"] - volume["lost"]
    on_grid = float(np.nansum(thickness.z)) * thickness.transform.a ** 2
    return {**row, "variables": about.get("variables"), "ranks": about.get("ranks"), "package": about.get("package"), "released_m3": volume["released"],
            "on_grid_m3": volume["on_grid"], "off_grid_m3": volume["off_grid"], "lost_m3": volume["lost"],
            "residual_m3": volume["residual"], "mass_error": (on_grid - stays) / volume["released"],
            "front_m": travel["front"], "reach_angle_deg": travel["reach_angle"], "centroid_m": travel["centroid"],
            "thickness_m": summary["largest"]["thickness"], "max_thickness_m": summary["largest"]["max_thickness"],
            "max_speed_m_s": summary["largest"]["max_speed"], "stop_time_s": summary["stop"]["time"],
            "stop_reason": summary["stop"]["reason"], "moving": summary["moving"],
            "moving_share": summary["motion"]["moving_share"], "change_rate": summary.get("change_rate"),
            "wall_s": marker.get("wall_seconds"), "summary": f"{one.name}/{path.name}",
            "slope_version": summary["slope_version"], "lammps_version": summary["lammps_version"],
            "lmp_sha256": about.get("lmp_sha256"), "log_warnings": one.log.warnings}


def on_road(one, args, summary):
    """What `slope volume` says of a run; all it writes goes to the folder volume of the run."""
    from . import volume
    parser = argparse.ArgumentParser()
    volume.add_parser(parser.add_subparsers())
    words = ["volume", str(runs.prefix_of(summary)), "--road", str(args.road), "--cut-angle", str(args.cut_angle),
             "--mesh", str(args.mesh), "-o", str(one.folder / "volume")]
    if one.log.terrain:
        words += ["--terrain", str(one.folder / one.log.terrain)]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        volume.run(parser.parse_args(words + ["--local"] * args.local))
    about = runs.load_yaml(one.folder / "volume" / "volume.yaml", "what `slope volume` wrote")
    return {"remove_m3": about["volume"]["remove"], "remove_on_road_m3": about["volume"]["remove_on_road"],
            "remove_beside_road_m3": about["volume"]["remove_beside_road"],
            "blocked_m": about["axis"]["blocked_length"], "axis_thickness_m": about["axis"]["largest_thickness"],
            # what it says of the summary is in the table
            "road_warnings": [text.replace(f"{one.folder}/", "") for text in about["warnings"]
                              if not text.startswith(f"{summary}:")]}


def write_road(args, row, place):
    """Keep the road, in local metres, with the study; what study.yaml says of it."""
    from . import polygons
    raster = runs.load_raster(runs.prefix_of(args.output / row["summary"]), "thickness")
    if place:
        raster = raster._replace(crs=place.crs, offset=place.offset)
    polygons.write(args.output / "road.csv", polygons.read_local(args.road, raster, args.local), raster)
    return {"file": args.road.name, "local": "road.csv", "cut_angle": args.cut_angle, "mesh": args.mesh}


def conservative(settings, rows, finished):
    """The largest volume to remove, which run gave it, and what speaks against taking it as the largest."""
    best = max(finished, key=lambda row: row["remove_m3"])
    doubts = []
    if len(finished) < len(rows):
        doubts.append(f"{len(rows) - len(finished)} of {len(rows)} runs failed")
    moving = sum(row["moving"] for row in finished)
    if moving:
        doubts.append(f"{moving} of {len(finished)} deposits still move")
    for name, several in settings.items():
        numbers = [as_number(value) for value in several]
        value = as_number(best["set"][name])
        if len(several) > 1 and all(isinstance(one, float) for one in numbers) and value != 0 \
                and value in (min(numbers), max(numbers)):
            doubts.append(f"it lies at the end of the range of {name}, {min(numbers):g} to {max(numbers):g}")
    return {"remove_m3": best["remove_m3"], "run": best["run"], "doubts": doubts}


def told(best):
    return (f"conservative volume to remove: {best['remove_m3']:,.0f} m3, run {best['run']}"
            + "".join(f"; {doubt}" for doubt in best["doubts"]))


def terrain_place(one):
    """CRS and offset of the runs' local metres, from the sidecar of their terrain; None without one."""
    return one.log.terrain and rasters.read_sidecar(one.folder / one.log.terrain)


def largest(rows, key):
    """The largest value of a column and the first run that has it."""
    best = max(rows, key=lambda row: row[key])
    return {"value": best[key], "run": best["run"]}


def same_grid(one, other):
    return one.z.shape == other.z.shape and one.transform.almost_equals(other.transform)


class Maps:
    """Over all runs, cell by cell: the largest thickness, and how many runs exceed a threshold."""

    def __init__(self, thresholds):
        self.thresholds = thresholds
        self.grid = self.problem = None
        self.count, self.first = 0, None

    def add(self, name, thickness, max_thickness):
        if self.grid is None:
            self.grid, self.first = thickness, name
            shape = thickness.z.shape
            self.envelope = {"thickness": np.zeros(shape), "max_thickness": np.zeros(shape)}
            self.exceeding = [np.zeros(shape, int) for _ in self.thresholds]
        elif not self.problem and not same_grid(thickness, self.grid):
            self.problem = (f"no maps over all runs: the rasters of {name} have another grid than those of "
                            f"{self.first}")
        if self.problem:
            return
        for key, raster in (("thickness", thickness), ("max_thickness", max_thickness)):
            np.fmax(self.envelope[key], raster.z, out=self.envelope[key])
        for threshold, exceeding in zip(self.thresholds, self.exceeding):
            exceeding += thickness.z > threshold
        self.count += 1

    def write(self, output, place):
        """Write all rasters, remove those of an earlier call; what study.yaml says of them."""
        written = {"envelope": None, "exceedance": None}
        kept = set()
        if self.grid is not None and not self.problem:
            area = self.grid.transform.a ** 2

            def write(name, z, what):
                raster = self.grid._replace(z=z)
                if place:
                    raster = raster._replace(crs=place.crs, offset=place.offset)
                path = output / f"{name}.asc"
                rasters.write_asc_local(path, raster, {"what": what})
                kept.update((path, path.with_suffix(".yaml")))
                if raster.crs is not None:
                    rasters.write_geotiff(path.with_suffix(".tif"), {what: z}, raster)
                    kept.add(path.with_suffix(".tif"))
                return {"file": path.name, "what": what}

            written["envelope"] = {
                key: {**write(f"envelope_{key}", z, what), "largest_m": float(z.max()),
                      "area_m2": float((z > 0).sum() * area)}
                for (key, z), what in zip(self.envelope.items(), (
                    "largest final thickness over all runs, m", "largest thickness over all runs and times, m"))}
            written["exceedance"] = [
                {"threshold_m": threshold,
                 **write(f"exceedance_{threshold:g}m", exceeding / self.count,
                         f"share of the runs with a final thickness > {threshold:g} m"),
                 "area_in_any_run_m2": float((exceeding > 0).sum() * area),
                 "area_in_every_run_m2": float((exceeding == self.count).sum() * area)}
                for threshold, exceeding in zip(self.thresholds, self.exceeding)]
        for path in [*output.glob("envelope_*"), *output.glob("exceedance_*")]:
            if path not in kept:
                path.unlink()
        return written


COLUMNS = ("released_m3", "on_grid_m3", "off_grid_m3", "lost_m3", "residual_m3", "front_m", "reach_angle_deg",
           "centroid_m", "thickness_m", "max_thickness_m", "max_speed_m_s", "stop_time_s", "stop_reason", "moving",
           "wall_s")
ROAD_COLUMNS = ("remove_m3", "remove_on_road_m3", "remove_beside_road_m3", "blocked_m", "axis_thickness_m")


def table(settings, rows):
    """The CSV over all runs."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    columns = [*COLUMNS, *(ROAD_COLUMNS if any("remove_m3" in row for row in rows) else ()), "status", "error"]
    writer.writerow(["run", *settings, *columns])
    for row in rows:
        cells = {**row, "moving": {True: "yes", False: "no"}.get(row.get("moving"))}
        writer.writerow([row["run"], *row["set"].values(), *(cells.get(key) for key in columns)])
    return text.getvalue()


SHOWN = {"released_m3": ("released", "{:,.0f}"), "on_grid_m3": ("on grid", "{:,.0f}"), "lost_m3": ("lost", "{:,.0f}"),
         "residual_m3": ("residual", "{:.0e}"), "front_m": ("front m", "{:.1f}"),
         "reach_angle_deg": ("reach deg", "{:.1f}"), "centroid_m": ("centroid m", "{:.1f}"),
         "stop_time_s": ("stop s", "{:.1f}"), "stop_reason": ("reason", "{}"), "moving": ("moving", "{}"),
         "wall_s": ("wall s", "{:.0f}")}
SHOWN_ROAD = {"remove_m3": ("to remove", "{:,.0f}"), "remove_on_road_m3": ("on the road", "{:,.0f}"),
              "blocked_m": ("blocked m", "{:.0f}")}


def print_table(settings, rows, title):
    shown = Table(title=title)
    columns = {**SHOWN, **(SHOWN_ROAD if any("remove_m3" in row for row in rows) else {})}
    same = {name: several[0] for name, several in settings.items() if len(several) == 1}
    if same:
        shown.caption = "in all runs " + ", ".join(f"{name} {value}" for name, value in same.items())
    varied = [name for name in settings if name not in same]
    for head in (*varied, *(head for head, _ in columns.values())):
        shown.add_column(head, justify="right")
    for row in rows:
        cells = [row["set"][name] for name in varied]
        if row["status"] == "failed":
            cells += ["failed"]
        else:
            cells += [form.format({True: "YES", False: "no"}.get(row[key], row[key]) if key == "moving" else row[key])
                      for key, (_, form) in columns.items()]
        shown.add_row(*cells)
    console = Console() if sys.stdout.isatty() else Console(width=160)
    console.print(shown)
