#!/usr/bin/python3
"""slope study, site, calibrate and report are killed, on a full disk, in a read-only folder, two in one folder.

Each command is first run undisturbed. Then it is killed (signal 9) at random times, and given again, until it may end:
what is marked as complete must be that of the undisturbed run at every time, runs that were finished stay so, and the
end is the same. Small disks are tmpfs, for which this needs root.

    LMP=build/lmp tests/faults.py --kills 50 --seed 1        # of each command
    LMP=build/lmp tests/faults.py --only study --kills 10
"""

import argparse
import csv
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
sys.path[:0] = [str(TOP / "tests" / "tools"), str(TOOLS)]
from test_continue import EDITS    # noqa: E402
from test_site import RELEASE, write_dem, write_layer    # noqa: E402
from tiny_collapse import DECK, LMP, processes_in, write_case    # noqa: E402

PAGE = 4096         # bytes
CLOSE = 1e-6        # of a number, for runs that were continued: beyond their rounding
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
MADE = re.compile(rb"\d{4}-\d\d-\d\d \d\d:\d\d UTC")     # of a report
GUARDS = re.compile(r"^guards:.*\n(?: .*\n)*", re.MULTILINE)     # of the last run command: less where a run was cut
TEXT = (".asc", ".csv", ".yaml", ".txt", ".md", ".site", ".tiny")
WALL = re.compile(r"^\s*wall_s(econds)?: .*$", re.MULTILINE)
OFF_EDGES = "lattice     sc 1.0\n", "lattice     sc 1.0 origin 0.1 0.13 0.0\n"    # where rounding would decide
KILLED = -signal.SIGKILL


class Case:
    """A command with its output, and what it gave twice undisturbed. marks: files that make their folder valid."""

    def __init__(self, name, words, output, marks, before=(), again=None):
        """again: a file, and the command to give instead where it is there."""
        self.name, self.words, self.output, self.marks, self.before = name, words, output, marks, before
        self.again = again
        self.truth = {}

    def prepare(self, folder):
        """The inputs, in an empty folder; commands before it."""
        if not os.path.ismount(folder):
            shutil.rmtree(folder, ignore_errors=True)
        made = folder.with_name("prepared")
        if self.before and made.exists():
            shutil.copytree(made, folder, dirs_exist_ok=True)
            return
        folder.mkdir(exist_ok=True)
        deck = DECK
        for old, new in (*EDITS, OFF_EDGES):
            deck = deck.replace(old, new)
        deck = deck.replace(' every 550 "shell ../../gate"', "")
        write_case(folder / "case").write_text(DECK if self.name == "calibrate" else deck)
        write_dem(folder / "dem.tif")
        write_layer(folder / "release.geojson", RELEASE, "EPSG:4326")
        for words in self.before:
            done = self.start(folder, words)
            check(done.wait() == 0, f"{words}: {done.stdout.read()}")
        if self.before:
            shutil.copytree(folder, made)

    def start(self, folder, words=None):
        if not words and self.again and (folder / self.again[0]).exists():
            words = self.again[1]
        return subprocess.Popen([sys.executable, str(TOOLS / "slope"), *(words or self.words).split()], cwd=folder,
                                env={**os.environ, "LMP": os.path.abspath(LMP)}, stdin=subprocess.DEVNULL, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)

    def run(self, folder):
        """To its end; gives status and what it said."""
        process = self.start(folder)
        said, _ = process.communicate()
        return process.returncode, said

    def learn(self, folder):
        """Run it twice undisturbed; keep what is the same both times. Gives seconds of a run."""
        found = []
        for _ in range(2):
            self.prepare(folder)
            began = time.monotonic()
            status, said = self.run(folder)
            took = time.monotonic() - began
            check(status == 0, said)
            found.append({path.relative_to(folder): contents(path) for path in results(folder / self.output)})
        self.truth = {path: what for path, what in found[0].items() if alike(what, found[1].get(path))}
        self.names = set(found[0])
        check(any(path.name in self.marks for path in self.names), f"no {self.marks} among {sorted(self.names)}")
        return took

    def complete(self, folder, marks=None):
        """The files that a marker declares complete now, which must be right."""
        whole = set()
        marks = self.marks if marks is None else marks
        for mark in sorted(path for path in self.names if path.name in marks and (folder / path).exists()):
            whole |= {path for path in self.names if path.parent == mark.parent and path.name != "screen.txt"}
        for path in sorted(whole):
            check((folder / path).exists(), f"{path} is missing beside its marker")
            if path in self.truth and not alike(self.truth[path], now := contents(folder / path)):
                raise AssertionError(f"{path} is not that of the undisturbed run{difference(self.truth[path], now)}")
        return whole

    def end(self, folder, same=True):
        """Run it to its end: all is there, and the same."""
        status, said = self.run(folder)
        check(status == 0 and "Traceback" not in said, f"after the fault, status {status}: {said}")
        if same:
            check(self.complete(folder) and all((folder / path).exists() for path in self.names), "not all came back")


def check(holds, what):
    if not holds:
        raise AssertionError(what)


def results(output):
    """The files of a result; what begins with a dot is none yet, and logs and times are of no result."""
    paths = [output] if output.is_file() else output.rglob("*")
    return [path for path in paths if path.is_file() and not any(part.startswith(".") for part in path.parts[-4:])
            and not re.search(r"^log\.|restart$", path.name)]


def contents(path):
    """Numbers and the text between them, or the bytes of another kind of file."""
    if path.suffix not in TEXT:
        return MADE.sub(b"", path.read_bytes())
    text = WALL.sub("", GUARDS.sub("", path.read_text(errors="replace")))
    if path.suffix == ".csv":
        text = without_wall(text)
    return NUMBER.split(text), [float(one) for one in NUMBER.findall(text)]


def without_wall(text):
    """A table without its column of wall times."""
    head, *rows = list(csv.reader(text.splitlines()))
    kept = [k for k, name in enumerate(head) if name != "wall_s"]
    return "\n".join(",".join(row[k] for k in kept if k < len(row)) for row in [head, *rows])


def alike(one, other):
    if isinstance(one, bytes) or other is None or isinstance(other, bytes):
        return one == other
    return one[0] == other[0] and all(abs(a - b) <= CLOSE * max(1.0, abs(a)) for a, b in zip(one[1], other[1]))


def difference(one, other):
    """The first number or text that differs."""
    if isinstance(one, bytes):
        return ""
    texts = [(a, b, "") for a, b in zip(one[0], other[0]) if a != b]
    numbers = [(a, b, f" after {text[-40:]!r}") for a, b, text in zip(one[1], other[1], one[0])
               if abs(a - b) > CLOSE * max(1.0, abs(a))]
    return ": {!r}, now {!r}{}".format(*(texts + numbers)[0]) if texts + numbers else ""


def kills(case, folder, number, rng):
    """Kill it so often; after one to five times it may end."""
    longest = case.learn(folder)
    left, ended, rest = number, 0, 0
    while left > 0:
        case.prepare(folder)
        whole = set()
        for _ in range(min(left, rng.randint(1, 5))):
            process = case.start(folder)
            time.sleep(rng.uniform(0.0, longest))
            if rng.random() < 0.5:
                process.kill()          # what it started gets to know by itself
            else:
                os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            left, ended = left - 1, ended + (process.returncode != KILLED)
            now = case.complete(folder)
            check(whole <= now, f"lost: {sorted(map(str, whole - now))[:3]}")
            whole = now if case.name in ("study", "calibrate") else set()
        case.end(folder)
        rest += sum(path.name.startswith(".") and path.name != ".lock" for path in folder.rglob("*"))
    check(not processes_in(folder), "processes are left")
    return f"{number} kills, {ended} of them too late, {rest} hidden files left"


def small_disk(case, folder, rng):
    """The disk is full at several sizes; with more room the command goes on."""
    case.prepare(folder)
    inputs = pages(folder)
    case.run(folder)
    size = pages(folder) - inputs
    shutil.rmtree(folder)
    folder.mkdir()
    failed = 0
    for share in (0.02, 0.2, 0.5, 0.8):
        mount(folder, f"size={int(inputs + share * size) + 16 * PAGE}")
        try:
            case.prepare(folder)
            status, said = case.run(folder)
            check(status in (0, 2) and "Traceback" not in said, f"status {status}: {said}")
            # runs that failed are left out of a table, which says so
            case.complete(folder, case.marks[:1] if status and len(case.marks) > 1 else None)
            failed += status != 0
            mount(folder, "remount,size=1g")
            # a calibration goes on from the points that it chose when runs had failed
            case.end(folder, same=case.name != "calibrate")
        finally:
            subprocess.run(["umount", str(folder)], check=True)
    check(failed, "no disk was full")
    return f"4 sizes, {failed} of them too small"


def pages(folder):
    """Bytes that a folder takes on a tmpfs."""
    return sum(-(-path.stat().st_size // PAGE) * PAGE for path in folder.rglob("*") if path.is_file())


def read_only(case, folder):
    """Where nothing can be written nothing changes, and one line says why."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    mount(folder, "size=1g")
    try:
        case.prepare(folder)
        check(case.run(folder)[0] == 0, "not even once")
        before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        mount(folder, "remount,ro")
        status, said = case.run(folder)
        check(status == 2 and "Traceback" not in said and "ead-only" in said, f"status {status}: {said}")
        check(before == {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}, "files changed")
    finally:
        subprocess.run(["umount", str(folder)], check=True)
    return said.strip().splitlines()[-1]


def mount(folder, options):
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)], check=True)


def two(case, folder, rng):
    """Two at a time in one folder, five times: one is refused or waits; the results are those of one."""
    refused = 0
    for _ in range(5):
        case.prepare(folder)
        first = case.start(folder)
        time.sleep(rng.uniform(0.0, 1.5))
        both = [process.communicate()[0] for process in (case.start(folder), first)]
        check(not any("Traceback" in said for said in both), both)
        refused += any("in use by another" in said for said in both)
        case.end(folder)
    return f"5 pairs, one refused in {refused}"


STUDY = "study case/in.tiny --set rolling=0,0.1 --set steps=400 --jobs 2 -o out"
CASES = [
    Case("study", STUDY, "out", ("finished.yaml", "study.yaml")),
    Case("site", "site --terrain dem.tif --release release.geojson --shape ellipsoid --depth 5 --balls 150 -o mine",
         "mine", ("in.site",), again=("mine/site.yaml", "site mine")),
    Case("calibrate", "calibrate case/in.tiny --front 14 --vary friction=20:40 --vary rolling=0:0.2 --runs 7 "
         "--set steps=100 --jobs 2 -o out", "out", ("finished.yaml", "calibrate.yaml")),
    Case("report", "report out --no-film -o report.html", "report.html", ("report.html",), [STUDY])]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=50, help="of each command")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=[case.name for case in CASES], action="append")
    args = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as top:
        folder = Path(top).resolve() / "work"
        for case in CASES:
            if args.only and case.name not in args.only:
                continue
            rng = random.Random(f"{case.name} {args.seed}")
            faults = [("killed", lambda: kills(case, folder, args.kills, rng)), ("two", lambda: two(case, folder, rng))]
            if os.geteuid() == 0:
                faults += [("disk full", lambda: small_disk(case, folder, rng)),
                           ("read-only", lambda: read_only(case, folder))]
            for name, fault in faults:
                try:
                    print(f"{case.name}, {name}: {fault()}", flush=True)
                except AssertionError as error:
                    failed += 1
                    print(f"{case.name}, {name}: FAILED: {error}", flush=True)
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
