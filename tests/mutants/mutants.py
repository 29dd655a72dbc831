#!/usr/bin/python3
"""Faults put into the code on purpose: each must be found by the tests that it can touch, of the short run.

They stand in the *.yaml beside this file, by name: a file, a text that is in it once, what the text becomes, and tests,
the fastest first: `tests/decks/test_ids.py -k contacts` for pytest, `test_contact_law 'ContactLaw.*'` for a program of
tests/unit with its filter. Faults with `all: true` may be found by tests of --all alone; there are five at most.

    tests/mutants.sh                            # all, one after the other; status 1 if one is not found
    tests/mutants.sh contacts age_not_kept      # those of a file, or of a name
    tests/mutants.sh --check                    # only: does each text stand where it should, once?
    tests/mutants.sh --tree ../before           # on the code and tests of another checkout

The checkout is not touched: faults come into a copy of it, with a copy of its build, in which what a fault changes is
compiled and, after it, replaced again. A test counts only if it passes without the fault.
"""
import argparse
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

HERE = Path(__file__).resolve().parent
MOST_LONG = 5       # faults that only --all finds
PATIENCE = 600      # s that a test may take
LEFT_OUT = {".git", ".lammps", "build", "__pycache__"}
TEXT = 20_000_000   # bytes; what is larger in a build has no paths that count


class Unusable(Exception):
    """A fault or a test of which nothing can be said."""


class Fault:
    """A fault and the tests that it can touch; see the head of this file."""

    def __init__(self, part, name, about):
        self.part, self.name, self.long = part, name, about.get("all", False)
        self.file, self.old, self.new = about["file"], about["old"].rstrip("\n"), about["new"].rstrip("\n")
        self.tests = [about["found_by"]] if isinstance(about["found_by"], str) else about["found_by"]
        self.compiled = self.file.startswith("src/")

    def text(self, top):
        """The file with the fault."""
        path = top / self.file
        whole = path.read_text(encoding="utf-8") if path.is_file() else ""
        if whole.count(self.old) != 1 or self.old == self.new:
            raise Unusable(f"{self.file} must have its text once, got it {whole.count(self.old)} times: {self.old!r}")
        return whole.replace(self.old, self.new)


def read(wanted):
    """The faults of these names or files, all without any."""
    every = [Fault(path.stem, name, about) for path in sorted(HERE.glob("*.yaml"))
             for name, about in yaml.safe_load(path.read_text(encoding="utf-8")).items()]
    unknown = set(wanted) - {word for one in every for word in (one.name, one.part)}
    if unknown:
        sys.exit(f"mutants: must be names of faults, or of files of them, got {' '.join(sorted(unknown))}: see --list")
    return [one for one in every if not wanted or {one.name, one.part} & set(wanted)]


def program(test):
    """What must be built for a test."""
    return "lmp" if test.startswith("tests/") else shlex.split(test)[0]


def mirror(source, target, moved=lambda data: data, left_out=()):
    """Make a folder the copy of another; files of the same time are. moved: changes what is in texts."""
    keep = set()
    for folder, inner, names in os.walk(source):
        inner[:] = [name for name in inner if name not in left_out]
        here = target / os.path.relpath(folder, source)
        here.mkdir(parents=True, exist_ok=True)
        keep.update(here / name for name in (*inner, *names))
        for name in (*names, *(one for one in inner if os.path.islink(os.path.join(folder, one)))):
            old, new = Path(folder, name), here / name
            if new.is_symlink() or new.exists() and new.stat().st_mtime_ns == old.stat().st_mtime_ns:
                continue
            if old.is_symlink():
                new.symlink_to(os.fsdecode(moved(os.fsencode(os.readlink(old)))))
                continue
            shutil.copy2(old, new)
            data = new.read_bytes() if old.stat().st_size < TEXT else b"\0"
            if b"\0" not in data and moved(data) != data:
                new.write_bytes(moved(data))
                shutil.copystat(old, new)
    for folder, inner, names in os.walk(target, topdown=False):
        for name in (*names, *inner):
            path = Path(folder, name)
            if path not in keep and not set(path.relative_to(target).parts) & set(left_out):
                shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


class Copy:
    """A copy of a checkout and of its build, in a folder."""

    def __init__(self, tree, build, top):
        self.top, self.build, self.whole, self.built = top / "tree", top / "tree" / "build", top / "whole", set()
        self.passed = {}
        mirror(tree, self.top, left_out=LEFT_OUT)
        cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
        built, home = (re.search(rf"^CMAKE_{name}:INTERNAL=(.*)", cache, re.MULTILINE)[1]
                       for name in ("CACHEFILE_DIR", "HOME_DIRECTORY"))
        new = {os.fsencode(home): os.fsencode(self.top), os.fsencode(built): os.fsencode(self.build)}
        place = re.compile(b"(" + b"|".join(map(re.escape, (os.fsencode(built), os.fsencode(home)))) + rb")(?![\w.-])")
        mirror(build, self.build, lambda data: place.sub(lambda match: new[match[1]], data))
        if Path(home, ".lammps").exists():
            (self.top / ".lammps").symlink_to(Path(home, ".lammps").resolve())

    def make(self, target):
        """Build a program."""
        done = subprocess.run(["cmake", "--build", self.build, "-j", os.environ.get("JOBS", "1"), "--target", target],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            raise Unusable(f"{target} must compile: {(done.stderr or done.stdout).strip()[-400:]}")

    def run(self, test, long):
        """Whether a test passes, and what it said last; Unusable if there is none of that name, or it does not end."""
        words = shlex.split(test)
        pytest = words[0].startswith("tests/")
        if pytest:
            words = ["/usr/bin/python3", "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider",
                     *([] if long else ["-m", "not long"]), *words]
        else:
            words = [self.build / "tests" / words[0], *(f"--gtest_filter={one}" for one in words[1:])]
        with tempfile.TemporaryDirectory(prefix="mutant") as room:
            try:
                done = subprocess.run(words, cwd=self.top, env=self.environment(room), stdin=subprocess.DEVNULL,
                                      capture_output=True, text=True, timeout=PATIENCE, check=False)
            except subprocess.TimeoutExpired:
                if test in self.passed:         # without the fault it does end
                    return False, "no end"
                raise Unusable(f"{test} must end in {PATIENCE} s") from None
        said = (done.stdout + done.stderr).strip()[-400:]
        if pytest and done.returncode not in (0, 1) or "0 tests from 0" in done.stdout:
            raise Unusable(f"{test} must run tests: {said}")
        return done.returncode == 0, said

    def environment(self, room):
        """As tests/CMakeLists.txt has it, with what tests share in a folder of the test alone."""
        mpi = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_pml": "ob1",
               "OMPI_MCA_btl": "^tcp,openib,ofi,uct,usnic", "OMPI_MCA_mpi_yield_when_idle": "1",
               "OMPI_MCA_ess_singleton_isolated": "1", "HWLOC_COMPONENTS": "-linux:pci,-pci",
               "HWLOC_PLUGINS_PATH": "none"}
        rest = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME", "JOBS")}
        return {**rest, **mpi, "SLOPE_TOOLS": str(self.top / "tools"), "SLOPE_BUILD": str(self.build),
                "DUMP2VTK": str(self.build / "dump2vtk"), "LMP": str(self.build / "lmp"), "OMP_NUM_THREADS": "1",
                "LMP_SUFFIXES": str(self.build / "tests" / "lmp_suffixes"), "TMPDIR": room, "SLOPE_SHARED": room}

    def without(self, test, long):
        """Raise Unusable unless a test passes without a fault."""
        if test not in self.passed:
            self.passed[test] = self.run(test, long)
        passed, said = self.passed[test]
        if not passed:
            raise Unusable(f"{test} must pass without the fault: {said}")

    def finder(self, fault):
        """The first test that finds a fault; None if none does."""
        path = self.top / fault.file
        whole, about = path.read_bytes(), path.stat()
        for test in fault.tests:
            self.without(test, fault.long)
            path.write_text(fault.text(self.top), encoding="utf-8")
            try:
                if fault.compiled:
                    self.make(program(test))
                if not self.run(test, fault.long)[0]:
                    return test
            finally:
                path.write_bytes(whole)
                os.utime(path, ns=(about.st_atime_ns, about.st_mtime_ns))
                if fault.compiled:
                    mirror(self.whole, self.build)
        return None


def seconds():
    """Of the processor, by all that was started."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def look(tree, build, faults):
    """Put each fault into a copy; the number of those that were not found."""
    missed = 0
    with tempfile.TemporaryDirectory(prefix="mutants") as folder:
        copy = Copy(tree, build, Path(folder))
        programs = sorted({program(test) for one in faults if one.compiled for test in one.tests})
        for name in programs:
            copy.make(name)
        if programs:
            mirror(copy.build, copy.whole)
        for number, fault in enumerate(faults, 1):
            began, used = time.monotonic(), seconds()
            try:
                found = copy.finder(fault)
                text = f"found by {found}" if found else f"NOT FOUND by {'; '.join(fault.tests)}"
            except Unusable as error:
                found, text = None, f"NOT TESTED: {error}"
            missed += not found
            print(f"{number}/{len(faults)} {fault.part}/{fault.name}: {text} ({time.monotonic() - began:.0f} s, "
                  f"{seconds() - used:.0f} s of the processor)", flush=True)
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="of faults, or of files of them (default: all)")
    parser.add_argument("--tree", type=Path, default=HERE.parents[1], metavar="FOLDER", help="checkout (default: this)")
    parser.add_argument("--build", type=Path, metavar="FOLDER", help="its build (default: build in the checkout)")
    parser.add_argument("--list", action="store_true", help="print names, files and tests, and end")
    parser.add_argument("--check", action="store_true", help="see whether each text stands in its file once, and end")
    asked = parser.parse_args()
    faults, tree = read(asked.names), asked.tree.resolve()
    build = (asked.build or tree / "build").resolve()
    if asked.list:
        for one in faults:
            print(f"{one.part}/{one.name}: {one.file}: {'; '.join(one.tests)}{' (--all)' * one.long}")
        return 0
    wrong = 0
    for one in faults:
        try:
            one.text(tree)
        except Unusable as error:
            wrong += 1
            print(f"mutants: {one.name}: {error}", file=sys.stderr)
    long = [one.name for one in faults if one.long]
    if len(long) > MOST_LONG:
        wrong += 1
        print(f"mutants: at most {MOST_LONG} faults may need --all, got {', '.join(long)}", file=sys.stderr)
    if asked.check or wrong:
        return int(wrong > 0)
    if not (build / "CMakeCache.txt").is_file():
        sys.exit(f"mutants: --build must be a build of the checkout, got {build}: tools/build.sh makes one")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))     # which removes the copies
    began = time.monotonic()
    missed = look(tree, build, faults)
    print(f"{len(faults) - missed} of {len(faults)} faults found in {time.monotonic() - began:.0f} s, "
          f"{seconds():.0f} s of the processor{'; only by --all: ' * bool(long)}{', '.join(long)}")
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
