"""Runs tools/slope as a process: what it says, how far it is, how it is stopped. The one place that does it."""
import json
import os
import queue
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


def said(line):
    """What a line of standard error says: the object of `slope --progress json`, or {"text": line} of anything else."""
    try:
        found = json.loads(line)
    except ValueError:
        found = None
    return found if isinstance(found, dict) and "level" in found else {"level": "", "text": line}


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
    line = [program(), "--progress", "json", *map(str, words)]
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
    lines = listen(process)
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
        elif not is_error:
            feedback.pushInfo(line)
        else:
            one = said(line)
            if one["level"] == "progress":
                feedback.setProgress(100 * one["share"])
            elif one["level"] in ("warning", "note"):
                feedback.pushWarning(f"{one['command']}: {one['text']}")
            else:
                if last:
                    feedback.pushInfo(last)
                last = f"slope {one['command']}: {one['text']}" if one["level"] == "error" else one["text"]
    if last and (process.wait() == 0 or feedback.isCanceled()):
        feedback.pushInfo(last)
    return last
