"""The runs of a study: their folders, their processes, and how far they are."""
import contextlib
import os
import re
import shutil
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional

import yaml
from .. import disk, processes, provenance
from ..case import decks, last_words, logs, restarts, run_folders
from ..errors import SlopeError
from . import dependencies, launcher, store
from .job_display import Display

POLL = 0.1              # s between two looks at the runs
SCREEN = "screen.txt"
KILLED = {base for code in (signal.SIGKILL, signal.SIGTERM) for base in (-code, 128 + code)}     # lmp, or mpirun of it
CONTINUES = "read_restart ${restart}"      # what a deck that can be continued has in it
SAFE = re.compile(r"[^A-Za-z0-9.+-]+")


def cores():
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))


def busy():
    """Processes of this machine that want a core now, without this one."""
    with open("/proc/loadavg", encoding="ascii") as file:
        return int(file.read().split()[3].partition("/")[0]) - 1


def slots():
    """What mpirun takes as its number of slots: in a job of Slurm its tasks on this node, else physical cores."""
    tasks = re.match(r"\d+", os.environ.get("SLURM_TASKS_PER_NODE", ""))
    if tasks:
        return int(tasks[0])
    siblings = {path.read_text(encoding="ascii") for path in
                Path("/sys/devices/system/cpu").glob("cpu[0-9]*/topology/thread_siblings_list")}
    return min(len(siblings) or 1, cores())


def name_run(chosen: Mapping[str, str]) -> str:
    """The name that a run has by its values."""
    return "_".join(f"{name}_{SAFE.sub('-', value)}" for name, value in chosen.items()) or "base"


class Run:
    """One run: its values, its folder, and what became of it."""

    def __init__(self, output, chosen):
        self.chosen: Dict[str, str] = chosen
        self.move(Path(output) / name_run(chosen))
        self.varied = self.name     # for a narrow terminal: the values that differ
        self.error = None
        self.changed: Optional[str] = None      # of a finished run that is to be made again: what is another
        self.restart = None         # step and path of the restart file from which it continues
        self.refused = set()        # restart files that LAMMPS could not read
        self.unlaunched: Optional[str] = None       # what was said when it failed before LAMMPS began
        self.share = 1              # times as many ranks as the others
        self.output_before = 0              # bytes of screen output of its earlier parts

    def move(self, folder: Path):
        """Be the run in a folder."""
        self.folder, self.name, self.log = folder, folder.name, logs.Log(folder / logs.LOG)

    @property
    def marker(self):
        return self.folder / run_folders.MARKER

    @property
    def finished(self):
        return self.changed is None and self.marker.exists()

    def state(self):
        if self.finished:
            return "finished"
        return "made again" if self.changed else "unfinished" if self.folder.exists() else "new"

    def fail(self, status):
        """Keep why it failed."""
        how = f"ended with status {status}" if status >= 0 else f"ended by {signal.Signals(-status).name}"
        if status == 0:
            how = "lmp ended with status 0, but left no complete run"
        words = last_words.reason(self.log.update(), self.screen())
        where = self.folder / logs.LOG
        self.error = f"{words or 'no word in its log'} ({how}; see {where if where.exists() else self.folder / SCREEN})"

    def screen(self):
        """What it said since it was started."""
        return last_words.Screen(self.folder / SCREEN, self.output_before)


# --- folders ---

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
        yield {name: disk.sha256(folder / name) for name in files}
    finally:
        shutil.rmtree(folder, ignore_errors=True)


# --- processes ---

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


@dataclass
class Active:
    """An active run; process: a subprocess.Popen, or an object with its interface."""
    run: Run
    process: Any
    began: float            # time.monotonic()


class Work:
    """Runs the deck in the run folders, some at a time."""

    def __init__(self, deck, digests, inputs, lmp, ranks, jobs, start: Optional[str] = None, older=(), anew=False):
        """start: the launcher.list_launcher_words of --launcher, None of mpirun; older, anew: see store.Store."""
        self.deck, self.digests, self.inputs = deck, digests, inputs
        self.lmp, self.ranks, self.jobs, self.start = lmp, ranks, jobs, start
        self.package = provenance.package_version()
        self.depends = dependencies.Dependencies(inputs / deck.name, digests, lmp, deck)
        self.store = store.Store(inputs.parent, self.depends, older, anew)
        self.defaults = self.store.defaults
        self.continues = any(CONTINUES in word for words in decks.commands(inputs / deck.name)
                             for word in (*words, " ".join(words)))
        self.halts = any(words[0] == "fix" and words[3:4] == ["halt"] for words in decks.commands(inputs / deck.name))
        self.active: List[Active] = []
        self.parts: Dict[Path, "Work"] = {}     # of several decks in one queue: {folder of runs: what makes these}

    def of(self, run) -> "Work":
        return self.parts.get(run.folder.parent, self)

    def do(self, todo, share=False):
        """Run what is not finished. On an interruption, end the runs under way and leave their folders unfinished.

        Runs of one folder are one: it is made as the first of them. share: cores among fewer runs than at a time.
        """
        once = store.select_distinct_runs(todo)
        waiting = [run for run in once if not run.finished]
        for run in waiting:
            run.share = self.share_of(len(waiting)) if share else 1
        with Display(once, waiting, self.at_a_time, self.halts) as display:
            try:
                while waiting or self.active:
                    for run, said in self._begin(waiting):
                        display.started(run, said)
                    time.sleep(POLL)
                    for active in list(self.active):
                        active.run.log.update()
                        if active.process.poll() is not None:
                            self.active.remove(active)
                            if self._again(active):
                                waiting.insert(0, active.run)
                                continue
                            self.of(active.run)._ended(active)
                            display.ended(active)
                    display.update(self._shown(), len(waiting))
            except BaseException:
                self._stop()
                raise
        made = {run.folder: run for run in once}
        for run in todo:
            run.error, run.log = made[run.folder].error, made[run.folder].log

    def at_a_time(self):
        """How many runs may be active at a time."""
        return self.jobs

    def share_of(self, number):
        """How many times the ranks of a run each of so many can have: ranks that wait for a core hold up the others."""
        idle = min(self.jobs, (cores() - busy()) // self.ranks)
        return max(1, idle // number) if launcher.able(self.start) else 1

    def ranks_of(self, run):
        """MPI ranks of a run."""
        return run.share * self.ranks

    def _begin(self, waiting):
        """Start what may run now, taking it from waiting; (run, line for the user) of each."""
        while waiting and len(self.active) < self.jobs:
            run = waiting.pop(0)
            yield run, self._start(run)

    def _again(self, active):
        """Whether a run that ended is to be started once more."""
        return (self._refused(active.run, active.process.returncode)
                or self._unlaunched(active.run, active.process.returncode)
                or self._unshared(active.run, active.process.returncode))

    def _shown(self):
        """The runs that the display shows as under way."""
        return self.active

    def command(self, run):
        """Arguments of lmp."""
        words = ["-in", self.deck.name, "-log", logs.LOG]
        for name, value in run.chosen.items():
            words += ["-var", name, value]
        if run.restart:
            words += ["-var", "restart", str(run.restart[1].relative_to(run.folder))]
        return words

    def _start(self, run):
        """Start a run, from its last restart file if there is one; returns a line for the user."""
        try:
            state = self.of(run)._prepare(run)
            with open(run.folder / SCREEN, "ab" if run.restart else "wb") as screen:
                run.output_before = screen.tell()
                words = self.of(run)._line(run)
                process = processes.start(words, run.folder, screen, alone=words[0] == str(self.of(run).lmp))
        except OSError as error:
            raise SlopeError(run.folder, f"cannot be run: {error.strerror} ({error.filename})") from error
        self.active.append(Active(run, process, time.monotonic()))
        return state

    def _prepare(self, run):
        """Make the folder of a run, or prepare it for a continuation; returns a line for the user."""
        state = "started"
        if run.folder.exists():
            run.restart, why = self._last_restart(run)
            state = f"starts again: {why}"
        if run.restart:
            step, path = run.restart
            state = f"continues at step {step}, from {path}"
            self._reopen_folder(run)
        else:
            self._make_folder(run)
        if run.unlaunched:
            state += f"; its launch failed once: {run.unlaunched}"
        return state

    def _line(self, run):
        """The whole command of a run."""
        by = launcher.list_launcher_words(self.start, self.ranks_of(run), slots())
        return [*by, str(self.lmp), *self.command(run)]

    def _last_restart(self, run):
        """Step and path of the restart file from which an unfinished run can continue, or None; and why it cannot."""
        if not self.continues:
            return None, f"{self.deck.name} has no {CONTINUES}"
        changed = self.depends.changed(run) or self.depends.copies_changed(run)
        if changed:
            return None, f"it was started with another {changed}"
        for step, path in restarts.restarts(run.folder):
            # from a restart file at or after its halt a run would continue, as LAMMPS does not know that it halted
            if (path not in run.refused and str(path.relative_to(run.folder)) not in self.digests
                    and (run.log.halted is None or step < run.log.halted)):
                return (step, path), None
        return None, "it left no complete restart file"

    def _reopen_folder(self, run):
        """Prepare the folder of an interrupted run for its continuation."""
        before, (step, path) = run_folders.begun(run.folder), run.restart
        about = {**before, "ranks": self.ranks_of(run), "continued": [*before.get("continued", ()), {
            "step": step, "restart": str(path.relative_to(run.folder)), "ranks": self.ranks_of(run),
            "started": provenance.now()}]}
        disk.write_file(run.folder / run_folders.VARIABLES, yaml.safe_dump(about, sort_keys=False))
        if run.log.path.exists():
            logs.part(run.log.path)
        run.log = logs.Log(run.log.path)

    @staticmethod
    def _refused(run, status):
        """Whether LAMMPS could not read the restart file although it looked complete: then it is not used again."""
        if status == 0 or status in KILLED or not run.restart:
            return False
        if not last_words.spoiled_restart(run.log.update(), run.screen(), crashed=status < 0 or status > 128):
            return False
        run.refused.add(run.restart[1])
        return True

    @staticmethod
    def _unlaunched(run, status):
        """Whether MPI failed before LAMMPS began: once, the run is started again."""
        if status == 0 or status in KILLED or run.unlaunched or run.log.path.exists():
            return False
        run.unlaunched = run.screen().launcher
        return run.unlaunched is not None

    def _unshared(self, run, status):
        """Whether a run with a share of the cores failed, as that of a program without MPI does: it is made anew
        without."""
        if run.share == 1 or status in KILLED:
            return False
        if status == 0 and [run_folders.load_summary(one)["ranks"] for one in run_folders.summaries(run.folder)] == [
                self.ranks_of(run)]:
            return False
        shutil.rmtree(run.folder)
        run.share = 1
        return True

    def _make_folder(self, run):
        """Make the folder with all input of the run, in place of that of an unfinished run."""
        new = run.folder.with_name(f".{run.name}.new")
        old = run.folder.with_name(f".{run.name}.old")
        for rest in (new, old):
            shutil.rmtree(rest, ignore_errors=True)
        shutil.copytree(self.inputs, new)
        run.log = logs.Log(run.log.path)        # what was read so far belongs to the old run
        state = self.depends.now(run)
        about = {"deck": self.deck.name, "set": run.chosen, "variables": {**self.defaults, **run.chosen},
                 "command": " ".join([self.lmp.name, *self.command(run)]), "ranks": self.ranks_of(run),
                 "package": self.package, "lmp_sha256": state.program["LAMMPS program"],
                 "started": provenance.now(), "program": state.program, "environment": state.environment,
                 "inputs": {**state.files, **self.digests}}
        disk.write_file(new / run_folders.VARIABLES, yaml.safe_dump(about, sort_keys=False))
        if run.folder.exists():
            run.folder.rename(old)
        new.rename(run.folder)
        shutil.rmtree(old, ignore_errors=True)

    def _ended(self, active):
        """Mark the run as finished, or keep why it is not."""
        run, status = active.run, active.process.returncode
        summaries = run_folders.summaries(run.folder)
        if status != 0 or len(summaries) != 1:
            return run.fail(status)
        try:
            summary = run_folders.load_summary(summaries[0])
            if summary["ranks"] != self.ranks_of(run):
                raise SlopeError(self.lmp, f"must be built with MPI to run on {self.ranks_of(run)} ranks",
                                 summary["ranks"])
        except SlopeError as error:
            run.error = str(error)
            return None
        run.log.update()
        state = self.depends.now(run)
        begun = run_folders.begun(run.folder)
        about = {"finished": provenance.now(), "wall_seconds": round(time.monotonic() - active.began, 1),
                 "summary": summaries[0].name, "machine": provenance.machine(),
                 "environment": {**state.environment, **begun["environment"]},
                 "inputs": {name: begun["inputs"].get(name, digest) for name, digest in state.files.items()}}
        disk.flush_all(run.folder)      # what it says is there, is
        disk.write_file(run.marker, yaml.safe_dump(about, sort_keys=False))
        run.changed = None
        return None

    def _stop(self):
        """End the runs under way, each by its own process id."""
        processes.stop(active.process for active in self.active)
        self.active.clear()
