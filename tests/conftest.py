"""Of all tests in Python: the tools are on the path of modules, cases are made once, the longest files begin first."""
import csv
import fcntl
import gc
import os
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

import pytest

from times import read_seconds

TESTS = Path(__file__).resolve().parent
LONGEST = 200       # letters of a test's name that are kept

sys.path.insert(0, os.environ.get("SLOPE_TOOLS", str(TESTS.parent / "tools")))
if "PYTEST_XDIST_WORKER" in os.environ:       # Open MPI's session folders: runs that start at once would share one
    os.environ["TMPDIR"] = str(Path(tempfile.gettempdir()) / os.environ["PYTEST_XDIST_WORKER"])
    os.makedirs(os.environ["TMPDIR"], exist_ok=True)
    tempfile.tempdir = None
gc.set_threshold(50_000, 10, 10)        # looking for garbage took a third of the tests' collection


def pytest_configure(config):
    config.addinivalue_line("markers", "long: not part of the short run of tests/run.sh")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """The longest files first, as workers take whole files: one that came last would keep one processor."""
    seconds = read_seconds()
    items.sort(key=lambda item: -seconds.get(relative(item.path), 1.0))      # keeps the order within a file


def pytest_collection_finish():
    """What is there now stays, and need not be looked through."""
    gc.collect()
    gc.freeze()


def relative(path):
    return Path(path).relative_to(TESTS).as_posix() if TESTS in Path(path).parents else str(path)


def processor_seconds():
    """Of this process and of those that it started and waited for."""
    now = os.times()
    return now.user + now.system + now.children_user + now.children_system


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item):
    """A row of the file SLOPE_TIMES, if that is given: file, test, wall and processor seconds, fixtures included."""
    wall, processor = time.perf_counter(), processor_seconds()
    yield
    if os.environ.get("SLOPE_TIMES"):
        with open(os.environ["SLOPE_TIMES"], "a", encoding="utf-8", newline="") as file:        # one write a row
            csv.writer(file).writerow([relative(item.path), item.name[:LONGEST], f"{time.perf_counter() - wall:.3f}",
                                       f"{processor_seconds() - processor:.3f}"])


@pytest.fixture
def tmp_path(request, tmp_path_factory):
    """As pytest's own, which for each of thousands of tests looks through the folders of all that went before."""
    name = re.sub(r"\W", "_", request.node.name)[:30]
    return Path(tempfile.mkdtemp(prefix=name, dir=tmp_path_factory.getbasetemp()))


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """shared(name, make): a folder that make(folder) fills, once for all tests of a run of tests/run.sh, which gives

    the place as SLOPE_SHARED; by hand once for each call of pytest. Tests work on copies, or only read.
    """
    top = Path(os.environ.get("SLOPE_SHARED") or tmp_path_factory.mktemp("shared"))

    def get(name, make):
        folder, made = top / name, top / f"{name}.made"
        with open(top / f"{name}.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not made.exists():
                shutil.rmtree(folder, ignore_errors=True)      # of one that failed
                folder.mkdir()
                make(folder)
                made.touch()
        return folder
    return get
