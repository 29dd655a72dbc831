#!/usr/bin/python3
"""slope study SITE is killed at moments spread over its whole course, and two commands work on one site.

Two sites, of one road and of two, each with a few runs of few balls, are first studied undisturbed. Then the study is
killed (signal 9), each time in another copy: at a random time from the first run on (runs); at a random time of a study
whose runs are finished, with their rows to be read anew (rows) or kept (kept); or just before one of the files that it
renames or removes (files). After each kill no half-written file is there, and what said all before says it still; the
same command then makes, to every digit, what the undisturbed one made, but for dates and wall times. A run that was
killed starts anew: how one continues is in test_continue.py.

    LMP=build/lmp tests/site_kills.py --kills 40 --pairs 8 --seed 1
"""

import argparse
import csv
import json
import os
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from contextlib import closing
from pathlib import Path

import rasterio
import yaml

from faults import KILLED, TOOLS, check, without_wall      # which sets the path
from test_several_roads import NEAR
from test_site import RELEASE, ROAD, write_dem, write_layer     # noqa: E402
from tiny_collapse import LMP, processes_in, read_asc           # noqa: E402

MOMENTS = "runs", "rows", "kept", "files"       # of kills, in turn
PAIRS = ("study", "study"), ("study", "site"), ("site", "study"), ("study", "report"), ("study", "export")
COMMANDS = {"study": "study mine", "site": "site mine", "report": "report mine --no-film -o page.html --overwrite",
            "export": "export mine -o gis --overwrite"}
OF_THE_TIME = re.compile(r"^ *((collected|made|machine|jobs|package|seconds|wall_s|wall_seconds): .*|"
                         r"(started|finished): '\d{4}-.*)$", re.MULTILINE)
SMALL = {"rolling": "[0.05]", "spacing": "[]", "packing": "[2]", "fine": "no", "largest_restitution": "null",
         "points": "8"}       # of the study in site.yaml
# the command with blank pictures and no film, which take most of its time; it ends itself before the KILL_ATth name
# that it gives or takes away, and counts them in COUNTED
PROGRAM = f"""
import os, shutil, signal, sys
sys.path.insert(0, {str(TOOLS)!r})
calls, which = [0], shutil.which
def counted(function):
    def call(*args, **options):
        calls[0] += 1
        if calls[0] == int(os.environ.get("KILL_AT", 0)):
            os.kill(os.getpid(), signal.SIGKILL)
        return function(*args, **options)
    return call
for name in ("replace", "rename", "unlink"):
    setattr(os, name, counted(getattr(os, name)))
shutil.which = lambda name, *args, **options: None if name == "ffmpeg" else which(name, *args, **options)
from slope_tools import streams
streams.replace()
from slope_tools.drawing import pictures
from slope_tools.cli import program
pictures.encode_figure = lambda *args, **options: {b"blank"!r}
status = program()
if "COUNTED" in os.environ:
    open(os.environ["COUNTED"], "w").write(str(calls[0]))
sys.exit(status)
"""


class Site:
    """A site, in its folder before the study (fresh) and after an undisturbed one (done)."""

    def __init__(self, top, roads):
        self.fresh, self.done = top / "fresh", top / "done"
        self.fresh.mkdir(parents=True)
        write_dem(self.fresh / "dem.tif")
        write_layer(self.fresh / "release.geojson", RELEASE, "EPSG:4326")
        for name, points in (("road", ROAD), ("near", NEAR)):
            write_layer(self.fresh / f"{name}.geojson", points)
        named = [word for name in ("road", "near")[:roads] for word in ("--road", f"{name}.geojson")]
        self.run(self.fresh, "site --terrain dem.tif --release release.geojson --shape ellipsoid --depth 5 --balls 60 "
                 f"{' '.join(named)} -o mine")
        path = self.fresh / "mine" / "site.yaml"
        before, study, after = re.split(r"(^study:.*?)(?=^\w)", path.read_text(encoding="utf-8"), maxsplit=1,
                                        flags=re.MULTILINE | re.DOTALL)
        for name, value in SMALL.items():
            study, changed = re.subn(rf"^  {name}: [^#]*?( *#.*)?$", rf"  {name}: {value}\1", study, flags=re.MULTILINE)
            check(changed == 1, f"no {name} in site.yaml")
        path.write_text(before + study + after, encoding="utf-8")
        self.run(self.fresh, "site mine")       # its file as the command leaves it
        shutil.copytree(self.fresh, self.done)
        began = time.monotonic()
        self.run(self.done, "study mine")
        self.first = time.monotonic() - began
        began = time.monotonic()
        self.run(anew := self.copy("rows", top / "anew"), "study mine", COUNTED=str(top / "counted"))
        self.again = time.monotonic() - began
        self.names = int((top / "counted").read_text())
        self.truth = results(self.done)
        same(self.truth, results(anew))
        shutil.rmtree(anew)

    def copy(self, moment, folder):
        """The site before what is killed at a moment."""
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.fresh if moment == "runs" else self.done, folder)
        if moment != "runs":
            for path in [*folder.rglob("*.html"), *(folder.rglob("*row.json") if moment != "kept" else ())]:
                path.unlink()
        return folder

    def start(self, folder, words, **more):
        return subprocess.Popen([sys.executable, "-c", PROGRAM, *words.split()], cwd=folder, stdin=subprocess.DEVNULL,
                                env={**os.environ, "LMP": os.path.abspath(LMP), **more}, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)

    def run(self, folder, words, **more):
        process = self.start(folder, words, **more)
        said, _ = process.communicate()
        check(process.returncode == 0 and "Traceback" not in said, f"{words}: status {process.returncode}: {said}")
        return said

    def end(self, folder):
        """The same command to its end: all is there, and the same."""
        self.run(folder, "study mine")
        same(self.truth, results(folder))


# --- what is compared ---

def results(folder):
    """{name: content} of what a study leaves, without what is of the time; pages, with wall times in them, as None."""
    found = {}
    for path in sorted((folder / "mine").rglob("*")):
        if path.is_file() and not path.name.startswith(".") and not re.search(r"^log|^screen|restart$", path.name):
            found[path.relative_to(folder)] = content(path)
    return found


def content(path):
    # variables.yaml says on how many ranks, and by what, a run was made, a kept row of which files it is
    if path.suffix in (".html", ".mp4", ".png", ".gpkg") or path.name in ("variables.yaml", "row.json"):
        return None
    if path.suffix not in (".csv", ".yaml", ".asc", ".geojson", ".site"):
        return path.read_bytes()
    text = path.read_text(encoding="utf-8")
    return without_wall(text) if path.suffix == ".csv" else OF_THE_TIME.sub("", text)


def same(truth, found):
    check(truth.keys() == found.keys(), f"other files: {sorted(map(str, truth.keys() ^ found.keys()))[:5]}")
    for path, one in truth.items():
        if one != found[path]:
            pairs = zip(str(one).splitlines(), str(found[path]).splitlines())
            raise AssertionError(f"{path} differs: {next((pair for pair in pairs if pair[0] != pair[1]), '')}")


def whole(folder):
    """Raise AssertionError if a file is half written; LAMMPS' may be, in a run that is not marked as finished."""
    for path in sorted(folder.rglob("*")):
        begun = path.parent.parent.name == "runs" and not (path.parent / "finished.yaml").exists()
        if path.is_file() and (not path.name.startswith(".") or path.name == ".row.json") and not begun:
            try:
                read(path)
            except Exception as error:
                raise AssertionError(f"{path.relative_to(folder)} is half written: {error}") from error


def read(path):
    """Read a file to its end."""
    if path.suffix == ".yaml":
        check(yaml.load(path.read_bytes(), Loader=yaml.CSafeLoader) is not None, "empty")
    elif path.name.endswith("row.json"):      # of kept.py: a seal, and the value below it
        json.loads(path.read_text(encoding="utf-8").partition("\n")[2])
    elif path.suffix in (".json", ".geojson"):
        json.loads(path.read_text(encoding="utf-8"))
    elif path.suffix == ".csv":
        text = path.read_text(encoding="utf-8")
        lines = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
        check(text.endswith("\n") and len({len(line) for line in lines}) == 1, "a line is short")
    elif path.suffix == ".tif":
        with rasterio.open(path) as raster:
            raster.read()
    elif path.suffix == ".asc":
        read_asc(path)
    elif path.suffix == ".gpkg":
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as base:
            check(base.execute("pragma integrity_check").fetchone() == ("ok",), "no whole base")
    elif path.suffix == ".html":
        check(path.read_text(encoding="utf-8").rstrip().endswith("</html>"), "no end")


# --- the faults ---

def kill(site, folder, moment, rng, number):
    """Kill it so often, then let it end; gives whether each was in time."""
    site.copy(moment, folder)
    found = [kill_once(site, folder, moment, rng) for _ in range(number)]
    site.end(folder)
    return found


def kill_once(site, folder, moment, rng):
    if moment == "files":
        process = site.start(folder, "study mine", KILL_AT=str(rng.randint(1, site.names)))
    else:
        process = site.start(folder, "study mine")
        time.sleep(rng.uniform(0.0, site.first if moment == "runs" else site.again))
        if rng.random() < 0.5:
            process.kill()          # what it started gets to know by itself
        else:
            os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    end = time.monotonic() + 20
    while processes_in(folder):
        check(time.monotonic() < end, "processes are left")
        time.sleep(0.05)
    whole(folder)
    for path in () if moment == "runs" else folder.rglob("study.yaml"):
        name = path.relative_to(folder)
        check(content(path) == site.truth[name], f"{name} says something else")
    for path in folder.rglob("*.restart"):      # what was begun starts anew: see above
        if not (path.parent / "finished.yaml").exists():
            path.unlink()
    return process.returncode == KILLED


def two(site, folder, words, rng):
    """Two commands, one a while after the other; gives whether one was refused."""
    site.copy("kept" if "report" in words or "export" in words else "rows", folder)
    processes = [site.start(folder, COMMANDS[words[0]])]
    time.sleep(rng.uniform(0.0, site.again if words[0] == "study" else 2.0))
    processes.append(site.start(folder, COMMANDS[words[1]]))
    refused = 0
    for process, word in zip(processes, words):
        said, _ = process.communicate()
        check(process.returncode in (0, 2) and "Traceback" not in said, f"{words}: {word}: {said}")
        if process.returncode:
            check(said.count("\n") == 1 and "must not be in use by another" in said, f"{words}: {word}: {said}")
            refused += 1
    if "report" in words:
        mine, page = ((folder / name).read_text() for name in ("mine/report.numbers.csv", "page.numbers.csv"))
        check(mine == page, "report has other numbers than the study")
    whole(folder)
    if "site" in words:
        # the copy has no pages, and a study that was refused makes none
        lacks = [str(path) for path in site.truth if len(path.parts) == 2 and not (folder / path).is_file()
                 and not path.name.startswith(("report", "paper", "ensemble"))]
        check(not lacks, f"the site lacks {', '.join(lacks)}; refused: {refused}")
    site.end(folder)
    return refused


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=40, help="in all")
    parser.add_argument("--in-a-row", type=int, default=1, help="kills before the study may end")
    parser.add_argument("--roads", type=int, choices=(1, 2), action="append", help="of the site (default: both)")
    parser.add_argument("--pairs", type=int, default=10, help="of two commands at once, in all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--moment", choices=MOMENTS, action="append")
    args = parser.parse_args()
    rng, failed = random.Random(args.seed), 0
    with tempfile.TemporaryDirectory() as top:
        sites = []
        for roads in args.roads or (1, 2):
            sites.append(Site(Path(top).resolve() / str(roads), roads))
            print(f"{roads} roads: {sites[-1].first:.0f} s, with finished runs {sites[-1].again:.0f} s, "
                  f"{sites[-1].names} names", flush=True)
        moments = args.moment or MOMENTS
        tasks = [(kill, moments[k % len(moments)], sites[k // len(moments) % len(sites)], args.in_a_row)
                 for k in range(-(-args.kills // args.in_a_row))]
        tasks += [(two, PAIRS[k % len(PAIRS)], sites[k // len(PAIRS) % len(sites)]) for k in range(args.pairs)]
        for fault, what, site, *number in tasks:
            folder = site.done.parent / "work"
            try:
                found = fault(site, folder, what, rng, *number)
            except AssertionError as error:
                failed += 1
                found = f"FAILED: {error}"
            print(f"{fault.__name__} {what}, site of {folder.parent.name}: {found}", flush=True)
    print(f"{len(tasks)} faults, {failed} failed")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
