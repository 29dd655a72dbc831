"""Running the scenes of other codes, and reading what they left."""
import re
import time
from pathlib import Path

from slope_tools import processes
from slope_tools.case import last_words, logs
from slope_tools.deposits import dumps
from slope_tools.errors import SlopeError
from slope_tools.runs import launcher

DATA, DECK, LOG, SCREEN, FINAL, SERIES = "balls.data", "in.scene", "log.scene", "screen.txt", "final.txt", "series.txt"
COLUMNS = "x y z vx vy vz omegax omegay omegaz"
LOOP = r"^Loop time of (\S+) on \d+ procs for (\d+) steps"
POLL = 0.05         # s between two looks at a run


def launch(words, folder, ranks):
    """Start a program in a folder; what it says goes to SCREEN."""
    words = [*launcher.list_launcher_words(None, ranks, 0), *words]       # no slots: other runs may hold all cores
    try:
        with open(folder / SCREEN, "wb") as screen:
            return processes.start(words, folder, screen)
    except OSError as error:
        raise SlopeError(words[0], f"cannot be run: {error.strerror}") from error


def wait(running):
    """Wait for processes that launch() started; the largest resident memory of each, bytes. Leaves none behind.

    Looked up while they run: what wait4() tells includes this program's own, from before the exec.
    """
    peaks = [0] * len(running)
    try:
        while any(process.poll() is None for process in running):
            for i, process in enumerate(running):
                found = re.search(r"VmHWM:\s*(\d+) kB", read_text(f"/proc/{process.pid}/status"))
                peaks[i] = max(peaks[i], int(found[1]) * 1024 if found else 0)
            time.sleep(POLL)
    finally:
        processes.stop(running)
    return peaks


def run_together(code, folders, ranks=1):
    """Run scenes that are written in folders at the same time; their Results."""
    for folder in folders:
        for name in (LOG, FINAL, SERIES):
            (folder / name).unlink(missing_ok=True)
    peaks = wait([launch(code.command(), folder, ranks) for folder in folders])
    return [code.read(folder, peak) for folder, peak in zip(folders, peaks)]


def run(code, folder, ranks=1):
    """Run a scene that is written in a folder; its Result."""
    return run_together(code, [folder], ranks)[0]


def run_deck(lmp, folder, deck, ranks, options=()):
    """Run a deck that is in a folder; its steps and the seconds of its run loops."""
    wait([launch([str(lmp), "-in", deck, "-log", LOG, "-screen", "none", *options], folder, ranks)])
    text = read_text(folder / LOG)
    loops = re.findall(LOOP, text, re.MULTILINE)
    if not loops or "Total wall time" not in text:
        raise SlopeError(folder / LOG, "did not end well", failure(text, folder))
    return sum(int(steps) for _, steps in loops), sum(float(seconds) for seconds, _ in loops)


def read_dump(path):
    """States in a dump of id and COLUMNS, one array per snapshot, ordered by id."""
    return [values[:, 1:] for _, values in dumps.frames(path)]


def read_text(path):
    try:
        return Path(path).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def failure(log, folder):
    """Why a run failed, in one line."""
    error = re.search(r"^.*ERROR.*$", log, re.MULTILINE)
    return logs.message(error[0]) if error else last_words.Screen(folder / SCREEN).words() or "no word"
