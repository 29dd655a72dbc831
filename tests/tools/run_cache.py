"""Runs of LAMMPS that several tests make are made once in a run of the tests, and copied for the others.

A run is known by its words, PATH, and all files of its folder; the place is of one run of the tests, so of one program.
Only one that a study starts in the test's own process, and that ends well, is kept.
"""
import fcntl
import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path

from slope_tools import processes
from slope_tools.case import run_folders

ELSEWHERE = re.compile(r"(?:^|[\s\"'])(?:/|\.\./)", re.M)      # a path that leads out of the folder
OWN = {run_folders.VARIABLES, "screen.txt"}                    # of this run alone: when it was begun, what it says


def digest_of(words, folder):
    """Of the words and of what lies in the folder; None where the run may read other files."""
    total = hashlib.sha256(repr((words, os.environ["PATH"])).encode())      # PATH: a test may have an mpirun of its own
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        name, content = path.relative_to(folder).as_posix(), path.read_bytes()
        if name in OWN:
            continue
        if name == words[words.index("-in") + 1] and ELSEWHERE.search(content.decode("utf-8", "replace")):
            return None
        total.update(f"{name} {len(content)} ".encode() + content)
    return total.hexdigest()


class Kept(subprocess.Popen):
    """A run whose files are kept as soon as it has ended well."""
    keep = None

    def poll(self):
        status = super().poll()
        if status == 0 and self.keep:
            keep, self.keep = self.keep, None
            keep()
        return status


class RunCache:
    def __init__(self, top, program):
        self.top, self.program, self.start = Path(top), str(program), processes.start

    def cached(self, words, folder, screen, **how):
        """As processes.start."""
        words, folder = [str(word) for word in words], Path(folder)
        study = self.program in words and (folder / run_folders.VARIABLES).is_file()      # a run of one
        inside = not any(word.startswith("/") for word in words if word != self.program)
        digest = digest_of(words, folder) if study and inside else None
        if digest is None:
            return self.start(words, folder, screen, **how)
        place = self.top / digest
        if place.is_dir():
            shutil.copytree(place, folder, dirs_exist_ok=True)
            return subprocess.Popen(["true"], stdin=subprocess.DEVNULL)
        before = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}
        process = self.start(words, folder, screen, **how)
        process.__class__ = Kept

        def keep():
            part = self.top / f"{digest}.{os.getpid()}"
            for path in folder.rglob("*"):
                if path.is_file() and path.name not in OWN and before.get(path) != path.stat().st_mtime_ns:
                    to = part / path.relative_to(folder)
                    to.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(path, to)
            with open(self.top / "lock", "w", encoding="ascii") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                if not place.exists():
                    part.rename(place)
            shutil.rmtree(part, ignore_errors=True)
        process.keep = keep
        return process
