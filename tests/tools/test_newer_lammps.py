"""The sources compile against a LAMMPS whose lists are private, as those after 4Jul2026 announce, and whose other
members that are not public have new names. Its headers are those of 4Jul2026: the build's, or Debian sid's, fetched."""
import os
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime
from pathlib import Path

import pytest

pytestmark = pytest.mark.long
TOP = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("SLOPE_BUILD", TOP / "build"))
SOURCES = sorted(path for path in (TOP / "src").glob("**/*.cpp")
                 if path.parent.name != "plugin" and not path.read_text().startswith("// No LAMMPS"))
OLDEST = 20260704    # with all the interfaces that take the place of the lists
PRIVATE = {"modify.h": ["nfix", "fix", "fmask", "ncompute", "compute", "find_fix", "find_compute"],
           "group.h": ["bitmask"]}


def version_of(tree):
    """The date of a LAMMPS source tree as a number."""
    day = re.search(r'LAMMPS_VERSION "(.*)"', (tree / "src/version.h").read_text()).group(1)
    return int(datetime.strptime(day.replace(" ", ""), "%d%b%Y").strftime("%Y%m%d"))


def make_private(text, name):
    """A header in which the declaration of a member is private."""
    declaration = rf"^(  [\w: ]+ \**{name}(?:,[^;(]*|\([^)]*\))?;)"
    found, n = re.subn(declaration, r" private:\n\1\n public:", text, flags=re.M)
    assert n == 1, name
    return found


@pytest.fixture(scope="module")
def tree():
    """A source tree that is new enough."""
    cache = dict(re.findall(r"^(\w+):\w+=(.*)$", (BUILD / "CMakeCache.txt").read_text(), re.M))
    built = Path(cache["LAMMPS_SOURCE_DIR"])
    if version_of(built) >= OLDEST:
        return built
    fetched = BUILD / "matrix/source/sid"
    ended = subprocess.run(["bash", "-c", '. "$0/tools/upstream_source.sh"; debian_source sid "$1"', TOP, fetched],
                           capture_output=True, text=True)
    if ended.returncode:
        pytest.skip(f"no LAMMPS of {OLDEST} or later: {ended.stderr.strip()}")
    return fetched


@pytest.fixture(scope="module")
def headers(tree, tmp_path_factory):
    """Folders of a copy of its headers with private lists."""
    copy = tmp_path_factory.mktemp("headers")
    for room in ("", "STUBS", "GRANULAR", "RIGID"):
        (copy / room).mkdir(exist_ok=True)
        for path in (tree / "src" / room).glob("*.h"):
            shutil.copy(path, copy / room)
    for name, members in PRIVATE.items():
        text = (copy / name).read_text()
        for member in members:
            text = make_private(text, member)
        (copy / name).write_text(text)
    return copy


def errors(tree, headers, paths):
    """What a compiler that only looks at the files says."""
    rooms = [f"-I{path}" for path in sorted((TOP / "src").rglob("*")) if path.is_dir()]
    lammps = [f"-I{headers / room}" for room in ("STUBS", "", "GRANULAR", "RIGID")]
    # the tree's own folder last: libraries below it
    command = ["c++", "-std=c++17", "-fsyntax-only", "-w", "-DLAMMPS_SMALLBIG",
               f"-DSLOPE_LAMMPS_VERSION={version_of(tree)}", *lammps, f"-I{tree}/src", f"-I{TOP}/src", *rooms]

    def look(path):
        run = subprocess.run([*command, path], capture_output=True, text=True)
        return f"{path.name}: {run.stderr}" if run.returncode else ""
    with ThreadPoolExecutor(2) as pool:
        return "".join(pool.map(look, paths))


def test_all_compiles_with_private_lists(tree, headers):
    assert len(SOURCES) > 40
    assert not errors(tree, headers, SOURCES)


def test_other_hidden_members_cost_a_feature_and_not_the_build(tree, headers):
    knows = TOP / "src/lammps/lammps_compat.cpp"
    revealed = re.findall(r"^SLOPE_REVEAL\((\w+), .*, (\w+)\)", knows.read_text(), re.M)
    names = set(re.findall(r'^#include "(\w+\.h)"', knows.read_text(), re.M))
    assert len(revealed) > 30
    for name in names:
        for path in headers.glob(f"**/{name}"):
            text = path.read_text()
            for owner, member in revealed:
                if f"class {owner} " in text:
                    text = re.sub(rf"\b{member}\b", f"{member}_of_{OLDEST}", text)
            path.write_text(text)
    assert not errors(tree, headers, [knows])
