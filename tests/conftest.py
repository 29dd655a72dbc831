"""Of all tests in Python: the tools are on the path of modules, the mark long is known, and cases are made once."""
import fcntl
import os
import shutil
import sys
from pathlib import Path

import pytest

sys.path.insert(0, os.environ.get("SLOPE_TOOLS", str(Path(__file__).resolve().parents[1] / "tools")))


def pytest_configure(config):
    config.addinivalue_line("markers", "long: not part of the short run of tests/run.sh; an entry of ctest of its own")


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
