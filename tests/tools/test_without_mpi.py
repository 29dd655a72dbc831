"""The calls of MPI also suit LAMMPS' stand-in for it (BUILD_MPI=OFF), whose functions take no const."""
import os
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime
from pathlib import Path

import pytest

pytestmark = pytest.mark.long
TOP = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("SLOPE_BUILD", TOP / "build"))
CALLING = sorted(path for path in (TOP / "src").glob("**/*.cpp") if re.search(r"\bMPI_[A-Z]\w+\(", path.read_text()))


@pytest.fixture(scope="module")
def compiler():
    """The words of a compiler that only looks at its file."""
    cache = dict(re.findall(r"^(\w+):\w+=(.*)$", (BUILD / "CMakeCache.txt").read_text(), re.M))
    source = Path(cache["LAMMPS_SOURCE_DIR"]) / "src"
    day = re.search(r'LAMMPS_VERSION "(.*)"', (source / "version.h").read_text()).group(1)
    version = datetime.strptime(day.replace(" ", ""), "%d%b%Y").strftime("%Y%m%d")
    rooms = [f"-I{path}" for path in sorted((TOP / "src").rglob("*")) if path.is_dir()]
    return [cache["CMAKE_CXX_COMPILER"], "-std=c++17", "-fsyntax-only", "-w", "-DLAMMPS_SMALLBIG",
            f"-DSLOPE_LAMMPS_VERSION={version}", f"-I{source}/STUBS", f"-I{source}", f"-I{source}/GRANULAR",
            f"-I{source}/RIGID", f"-I{TOP}/src", *rooms]


def test_every_call_compiles(compiler):
    def errors(path):
        run = subprocess.run([*compiler, path], capture_output=True, text=True)
        return f"{path.name}: {run.stderr}" if run.returncode else ""
    assert len(CALLING) > 20
    with ThreadPoolExecutor(2) as pool:
        assert not "".join(pool.map(errors, CALLING))
