"""cmake --install: what is installed works without the checkout; see doc/src/build.rst."""

import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

TOP = Path(__file__).resolve().parents[2]
BUILD = os.environ.get("SLOPE_BUILD", str(TOP / "build"))

pytestmark = [
    pytest.mark.skipif(not Path(BUILD, "CMakeCache.txt").exists(), reason=f"no build in {BUILD}"),
    pytest.mark.skipif("SLOPE_PLUGIN" in os.environ, reason="a plugin is tested where it was built"),
]


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """An installation, moved after it was made: nothing in it may lead to where it was or came from."""
    folder = tmp_path_factory.mktemp("install")
    subprocess.run(["cmake", "--install", BUILD, "--prefix", str(folder / "first")], check=True, stdout=subprocess.PIPE)
    return (folder / "first").rename(folder / "moved")


@pytest.fixture
def call(prefix, tmp_path):
    """call(PROGRAM, WORDS...): run a program of the installation in a folder of its own; return what it printed."""
    outside = {key: value for key, value in os.environ.items()
               if key not in ("LMP", "SLOPE_TOOLS", "DUMP2VTK", "LIBLAMMPS")}

    def run(program, *words):
        done = subprocess.run([str(prefix / "bin" / program), *words], cwd=tmp_path, env=outside, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        assert done.returncode == 0, done.stdout[-2000:]
        return done.stdout
    return run


def test_everything_is_there(prefix):
    """Decks, their data, tools, pages and the licence, as in the checkout."""
    share = prefix / "share" / "slope"
    names = ["inputs/20_embankment/in.embankment", "doc/src/theory.rst", "tools/slope", "LICENSE"]
    if shutil.which("git"):                       # not on a machine that has nothing but what set-up installs
        tracked = subprocess.run(["git", "-C", str(TOP), "ls-files", "inputs", "doc", "tools/slope_tools",
                                  "tools/slope", "tools/qgis", "README.md", "LICENSE"], text=True,
                                 capture_output=True)
        names = tracked.stdout.split() or names
    assert not [name for name in names if not (share / name).is_file()]
    assert not list(prefix.rglob("__pycache__")) and not list(share.rglob("log.*"))


def test_no_way_back_to_the_checkout(prefix):
    """In no text file and no symbolic link. (Programs keep names of source files for their messages.)"""
    for path in prefix.rglob("*"):
        if path.is_symlink():
            assert prefix in path.resolve().parents, f"{path} leads to {path.resolve()}"
        elif (path.is_file() and path.suffix in (".py", ".rst", ".md", ".csv", "")
              and path.parent.name not in ("bin", "lib")):
            assert str(TOP) not in path.read_text(errors="replace"), path


def test_lmp_and_a_deck(call, prefix, tmp_path):
    shutil.copytree(prefix / "share" / "slope" / "inputs" / "01_restitution", tmp_path, dirs_exist_ok=True)
    out = call("lmp", "-in", "in.restitution")
    assert float(re.search(r"observed ([\d.]+)", out)[1]) == pytest.approx(0.249, abs=0.003)


def test_slope(call):
    version = re.search(r'SLOPE_VERSION "(.*)"', (TOP / "src" / "slope_version.h").read_text())[1]
    assert call("slope", "--version") == f"SLOPE {version}\n"
    assert "study" in call("slope", "--help")


def test_study_finds_the_installed_lmp(call, prefix, tmp_path):
    """And makes its runs with it: balls of 8 m on the embankment, a second."""
    case = prefix / "share" / "slope" / "inputs" / "20_embankment"
    call("slope", "study", str(case / "in.embankment"), "--set", "d=8", "--set", "rule=ours", "--set",
         "duration=1", "-o", "out")
    assert list((tmp_path / "out").rglob("finished.yaml"))
    about, = (tmp_path / "out").rglob("variables.yaml")
    lmp = hashlib.sha256((prefix / "bin" / "lmp").read_bytes()).hexdigest()
    assert yaml.safe_load(about.read_text())["lmp_sha256"] == lmp


def test_dump2vtk(call, prefix):
    if not Path(BUILD, "dump2vtk").exists():
        pytest.skip("dump2vtk was not built: no VTK")
    assert "--terrain" in call("dump2vtk", "--help")


def test_python_module(prefix, tmp_path):
    """With PYTHONPATH alone it finds the library beside it."""
    module = prefix / "share" / "slope" / "python"
    if not module.exists():
        pytest.skip("no liblammps.so: build with -D BUILD_SHARED_LIBS=ON")
    program = ("from lammps import lammps; "
               "print(lammps(cmdargs=['-screen', 'none', '-log', 'none']).has_style('region', 'terrain'))")
    environment = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
    done = subprocess.run(["/usr/bin/python3", "-c", program], cwd=tmp_path, text=True, stdout=subprocess.PIPE,
                          env={**environment, "PYTHONPATH": str(module)})
    assert done.stdout == "True\n"
