"""The runs of a study as job arrays of Slurm, instead of processes of this machine.

Each array is a file with one run a line; its tasks leave the status of their program in the run's folder. What leaves
the queue without a status, because it was cancelled or its node went down, is submitted again, and continues from its
last restart file where the deck can do that.
"""
import contextlib
import os
import re
import shlex
import shutil
import subprocess
import time
from pathlib import Path
from typing import Dict, List, Optional, Tuple

from .. import disk, processes
from ..errors import SlopeError
from . import jobs

PROGRAMS = "sbatch", "squeue", "scancel"
FOLDER = ".slurm"           # in the study's: scripts of the arrays
KNOWN = "arrays"            # file there: the arrays that were submitted
STATUS = "slurm_status"     # in a run's folder: how its program ended
LOOK = 2.0                  # s between two looks at the queue
PATIENCE = 6.0              # s that a task may be out of the queue without a status: folders of other nodes lag behind
TRIES = 5                   # times that a run is submitted
SILENCE = 600.0             # s that the queue may fail to answer: slurmctld is busy, or is restarted
OWN = "--array", "--parsable", "--test-only", "--wait", "--wrap"     # options of sbatch that the study sets
SHORT = re.compile(r"-[HIOQVhksv]*[aW]")      # short ones of --array and --wait, also after others without a value
NUMBER = re.compile(r"(?:Submitted batch job )?(\d+)(?:;.*| on cluster .*)?")
TASK = re.compile(r"(\d+_\d+) (\w+)")
LIMIT = re.compile("array|limit", re.IGNORECASE)        # sbatch: MaxArraySize, or the jobs that may be submitted
SCRIPT = """\
#!/bin/bash
line=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" {runs})
[[ $line ]] || exit
eval "$line"
ended=$?
if ((ended != 143)); then   # by SIGTERM: cancelled, and the program may end before this script does
  echo $ended > {status}.new && mv {status}.new {status}
fi
"""


def check_slurm(options: str) -> None:
    """Raise SlopeError unless Slurm's programs are installed and answer."""
    for name in PROGRAMS:
        if not shutil.which(name):
            raise SlopeError("--engine slurm", f"needs {name} of Slurm, which is not on the PATH")
    try:
        words = shlex.split(options)
    except ValueError as error:
        raise SlopeError("--slurm", f"must be options of sbatch ({error})", options) from None
    for word in words:
        name = word.partition("=")[0]       # sbatch takes abbreviations, too
        if SHORT.match(word) or len(name) > len("--a") and any(one.startswith(name) for one in OWN):
            raise SlopeError("--slurm", f"must not have {', '.join(OWN)}, which the study sets; --jobs is how many "
                             "runs there are at a time", word)
    call("squeue", "-h", "-o", "%A")


def call(*words: str) -> str:
    """What a program of Slurm says; SlopeError if it fails."""
    try:
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    except OSError as error:
        raise SlopeError("--engine slurm", f"{words[0]} cannot be run: {error.strerror}") from error
    if done.returncode:
        last = (done.stderr or done.stdout).strip().splitlines() or ["no word of it"]
        raise SlopeError("--engine slurm", f"{words[0]} failed: {last[-1]}")
    return done.stdout


class Limit(SlopeError):
    """sbatch refused an array because of its size, or of what is submitted already."""


def number_in(answer: str) -> str:
    """The number of the job in what sbatch says, also where a banner is around it; SlopeError if there is not one."""
    found = [match.group(1) for line in answer.splitlines() if (match := NUMBER.fullmatch(line.strip()))]
    last = NUMBER.fullmatch((answer.strip().splitlines() or [""])[-1].strip())
    if last or len(set(found)) == 1:
        return last.group(1) if last else found[0]
    raise SlopeError("--engine slurm", "sbatch must answer with the number of the job, which may be running now "
                     "(squeue shows it)", repr(answer))


def quoted(word: str) -> str:
    """A word for bash, on one line."""
    if word.isprintable():
        return shlex.quote(word)
    return "$'" + "".join(f"\\x{byte:02x}" for byte in os.fsencode(word)) + "'"


class Task:
    """A task of an array, with the interface of subprocess.Popen. queue: the answers of squeue on all tasks."""

    def __init__(self, name: str, status: Path, queue: "Queue"):
        self.name, self.status, self.queue = name, status, queue
        self.returncode: Optional[int] = None
        self.lost = False           # it left the queue without a status
        self.missing: Optional[float] = None

    @property
    def running(self) -> bool:
        return self.queue.states().get(self.name) == "RUNNING"

    def poll(self) -> Optional[int]:
        if self.returncode is None:
            try:
                self.returncode = int(self.status.read_text(encoding="ascii"))
            except (OSError, ValueError):
                self._check_queue()
        return self.returncode

    def _check_queue(self) -> None:
        if self.name in self.queue.states() or self.queue.silent is not None:
            self.missing = None
            return
        now = time.monotonic()
        self.missing = self.missing or now
        if now - self.missing > PATIENCE:
            self.returncode, self.lost = -9, True


class Queue:
    """The states of our tasks, asked for now and then: {array_task: state}.

    silent: since when the queue has not answered, None if it did; the states are then those that were heard last.
    """

    def __init__(self):
        self.asked, self.known, self.arrays = -1e9, {}, []
        self.silent: Optional[float] = None

    def states(self) -> Dict[str, str]:
        """As last heard; SlopeError once the queue has not answered for long."""
        if time.monotonic() - self.asked > LOOK:
            try:
                lines = call("squeue", "-h", "-r", "-o", "%F_%K %T").splitlines()
            except SlopeError:
                now = time.monotonic()
                self.silent = now if self.silent is None else self.silent
                if now - self.silent > SILENCE:
                    raise
            else:
                self.silent = None
                self.known = {match.group(1): match.group(2) for line in lines if (match := TASK.match(line.strip()))
                              and match.group(2) not in ("COMPLETED", "CANCELLED", "FAILED", "NODE_FAIL", "TIMEOUT")}
            self.asked = time.monotonic()
        return self.known


class Work(jobs.Work):
    """Runs the deck in the run folders, by arrays; options: of sbatch; throttle: tasks at a time, or None."""

    def __init__(self, *args, options: str = "", throttle: Optional[int] = None):
        super().__init__(*args)
        self.options, self.throttle, self.queue = shlex.split(options), throttle, Queue()
        self.folder = self.store.folder / FOLDER
        self.tries: Dict[Path, int] = {}
        self.ready: Dict[Path, Tuple[str, str]] = {}       # of runs that wait for a place: line for the user, command
        self.size: Optional[int] = None     # of an array, where sbatch refused a larger one
        self.most: Optional[int] = None     # tasks that may be submitted, where it refused one more
        self.running = 0        # tasks, when they were last looked at
        self.folder.mkdir(exist_ok=True)
        known = self.folder / KNOWN
        if known.is_file():         # of a study that was killed: nobody waits for them any more
            self._cancel(known.read_text(encoding="ascii").split())
            known.unlink()

    def at_a_time(self):
        """As many as the cluster lets run, which is not known before the first of them do."""
        return max(1, self.running)

    def share_of(self, number):
        """All tasks of an array have as many ranks."""
        return 1

    def _begin(self, waiting):
        """Submit all that waits as one array, or as several where sbatch refuses one of that size."""
        while waiting and (room := self._room(len(waiting))) > 0:
            todo = waiting[:room]
            for run in todo:
                if run.folder not in self.ready:
                    self.ready[run.folder] = self._prepare_task(run)
            try:
                array = self._submit([self.ready[run.folder][1] for run in todo])
            except Limit:
                if len(todo) > 1:
                    self.size = (len(todo) + 1) // 2
                elif self.active:
                    self.most = len(self.active)
                else:
                    raise
                continue
            del waiting[:len(todo)]
            for i, run in enumerate(todo):
                self.tries[run.folder] = self.tries.get(run.folder, 0) + 1
                task = Task(f"{array}_{i}", run.folder / STATUS, self.queue)
                self.active.append(jobs.Active(run, task, time.monotonic()))
                yield run, f"{self.ready.pop(run.folder)[0]}, task {i} of Slurm's array {array}"

    def _room(self, number: int) -> int:
        """How many of so many tasks may be submitted now as one array; each array has a throttle of its own."""
        active = len(self.active)
        room = min(number, self.size or number, number if self.most is None else self.most - active)
        if self.size and self.throttle and active:
            return min(room, self.throttle - active) if self.size < self.throttle else 0
        return room

    def _prepare_task(self, run) -> Tuple[str, str]:
        """Prepare the folder of a run; a line for the user, and the command of its task."""
        state = self.of(run)._prepare(run)
        (run.folder / STATUS).unlink(missing_ok=True)
        screen = run.folder / jobs.SCREEN
        screen.touch()
        run.output_before = screen.stat().st_size
        words = " ".join(map(quoted, self.of(run)._line(run)))
        return state, f"cd {quoted(str(run.folder.absolute()))} || exit; {words} >> {jobs.SCREEN} 2>&1 < /dev/null\n"

    def _submit(self, lines: List[str]) -> str:
        """Submit an array of commands; its number."""
        place = self.folder / f"{len(list(self.folder.glob('*.runs'))) + 1}.runs"
        disk.write_file(place, "".join(lines))
        script = place.with_suffix(".sh")
        disk.write_file(script, SCRIPT.format(runs=quoted(str(place.absolute())), status=STATUS))
        array = f"0-{len(lines) - 1}" + (f"%{self.throttle}" if self.throttle else "")
        try:
            answer = call("sbatch", "--parsable", f"--array={array}", f"--ntasks={self.ranks}", "--output=/dev/null",
                          "--job-name=slope", *self.options, str(script.absolute()))
        except SlopeError as error:
            if LIMIT.search(str(error)):
                raise Limit("--engine slurm", str(error).partition(": ")[2]) from None
            raise
        number = number_in(answer)
        self.queue.arrays.append(number)
        self.queue.asked = -1e9
        disk.write_file(self.folder / KNOWN, "\n".join(self.queue.arrays) + "\n")
        return number

    def _again(self, active):
        if active.process.lost and self.tries[active.run.folder] < TRIES:
            return True
        return super()._again(active)

    def _shown(self):
        running = [active for active in self.active if active.process.running]
        self.running = len(running)
        for active in self.active:
            if not active.process.running and active.run.log.thermo == 0:
                active.began = time.monotonic()     # it waits: its wall time has not begun
        return running

    def _stop(self):
        self._cancel(self.queue.arrays)
        self.active.clear()

    @staticmethod
    def _cancel(arrays: List[str]) -> None:
        """Cancel arrays, and wait until they are gone. Raises nothing: it must not hide why they are cancelled."""
        for number in arrays:
            with contextlib.suppress(SlopeError):
                call("scancel", number)
        end = time.monotonic() + 10 * processes.PATIENCE
        while arrays and time.monotonic() < end:
            with contextlib.suppress(SlopeError):
                if not set(call("squeue", "-h", "-r", "-o", "%F").split()) & set(arrays):
                    return
            time.sleep(0.5)
