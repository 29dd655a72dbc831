"""Runs tools/slope as a process: what it says, how far it is, how it is stopped. The one place that does it."""
import os
import queue
import re
import shlex
import shutil
import signal
import subprocess
import threading
import time
from pathlib import Path

from processing.core.ProcessingConfig import ProcessingConfig
from qgis.core import QgsProcessingException

PROGRAM, LAMMPS = "SLOPE_PROGRAM", "SLOPE_LMP"      # settings
BESIDE = Path(__file__).resolve().parents[2] / "slope"      # of a checkout or an installation, also through a link
POLL = 0.2              # s between two looks at the Cancel button
PATIENCE = 30.0         # s which a command has to end its runs
RUN = re.compile(r"\[(\d+)/(\d+)\] .*?: (?:(finished|failed)|(started)|step (\d+) of (\d+))")
BEFORE = re.compile(r"(\d+) of (\d+) runs are finished already")


def program():
    """The path of tools/slope."""
    setting = ProcessingConfig.getSetting(PROGRAM)
    tools = os.environ.get("SLOPE_TOOLS")
    for path in (setting, tools and Path(tools) / "slope", BESIDE, shutil.which("slope")):
        if path and Path(path).is_file():
            return str(path)
        if path and path == setting:
            break
    raise QgsProcessingException("SLOPE: program tools/slope: must be an existing file; see Settings > Options > "
                                 f"Processing > Providers > SLOPE, got {setting or 'none'}")


def environment():
    """That of QGIS, but for what is meant for the Python inside of QGIS."""
    found = {name: value for name, value in os.environ.items() if name not in ("PYTHONHOME", "PYTHONPATH")}
    lammps = ProcessingConfig.getSetting(LAMMPS)
    return {**found, "PYTHONUNBUFFERED": "1", **({"LMP": lammps} if lammps else {})}


class Progress:
    """How far a command is, in percent, from what `slope study` prints of its runs; a site's has several parts."""

    def __init__(self):
        self.shares, self.before = {}, 0

    def update(self, line):
        """Percent after this line; None if it says nothing of it."""
        before, run = BEFORE.match(line), RUN.match(line)
        if before:
            self.shares, self.before = {}, int(before[1])
            return 100 * self.before / int(before[2])
        if not run:
            return None
        number, total, ended, started, step, last = run.groups()
        if started and self.shares.get(number) == 1.0:      # a run of the next part
            self.shares, self.before = {}, 0
        self.shares[number] = 1.0 if ended else 0.0 if started else int(step) / max(1, int(last))
        return min(100.0, 100 * (self.before + sum(self.shares.values())) / int(total))


def listen(process):
    """A queue of (whether it is of standard error, line) of a process; (None, None) at the end of each of both."""
    lines = queue.Queue()

    def read(stream, is_error):
        for line in stream:
            lines.put((is_error, line.rstrip("\n")))
        lines.put((None, None))

    for stream, is_error in ((process.stdout, False), (process.stderr, True)):
        threading.Thread(target=read, args=(stream, is_error), daemon=True).start()
    return lines


def run(words, feedback):
    """Run `slope WORDS`; raises QgsProcessingException with the tool's own line if it fails or is cancelled.

    A command that is cancelled gets what Ctrl-C sends: it ends its runs and leaves no half-written file.
    """
    line = [program(), *map(str, words)]
    feedback.pushCommandInfo(shlex.join(line))
    try:
        process = subprocess.Popen(line, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, encoding="utf-8", errors="replace", start_new_session=True)
    except OSError as error:
        raise QgsProcessingException(f"SLOPE: {line[0]}: cannot be run: {error.strerror}") from error
    with process:
        last = follow(process, feedback)
    if feedback.isCanceled():
        raise QgsProcessingException(f"slope {words[0]}: stopped")
    if process.returncode != 0:
        raise QgsProcessingException(last or f"slope {words[0]}: ended with status {process.returncode}")


def follow(process, feedback):
    """Hand on what a process says until it ends; gives its last line on standard error if that is why it failed."""
    lines, progress = listen(process), Progress()
    left, last, asked = 2, "", None
    while left:
        if asked is None and feedback.isCanceled():
            asked = time.monotonic()
            process.send_signal(signal.SIGINT)
        if asked is not None and time.monotonic() > asked + PATIENCE:
            os.killpg(process.pid, signal.SIGKILL)      # its own session, see Popen above
        try:
            is_error, line = lines.get(timeout=POLL)
        except queue.Empty:
            continue
        if is_error is None:
            left -= 1
        elif is_error:
            tell(last, feedback)
            last = line
        else:
            feedback.pushInfo(line)
            percent = progress.update(line)
            if percent is not None:
                feedback.setProgress(percent)
    if process.wait() == 0 or feedback.isCanceled():
        tell(last, feedback)
    return last


def tell(line, feedback):
    """Hand on a line of standard error."""
    if line:
        (feedback.pushWarning if ": warning: " in line else feedback.pushInfo)(line)
