"""tools/setup.sh where apt-get refuses or fails: by an apt-get of our own on PATH; see doc/src/build.rst."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]
SUITE = re.search(r"^VERSION_CODENAME=(\w+)", Path("/etc/os-release").read_text(), re.MULTILINE)[1]

# state in files beside it: what is installed; what cannot be had, with apt's words; what fails while it is installed
APT_GET = """#!{python} -IS
import sys
from pathlib import Path
state = Path({state!r})
lines = {{name: state.joinpath(name).read_text().splitlines() for name in ("installed", "refused", "failing")}}
refused = dict(line.split(": ", 1) for line in lines["refused"])
words = sys.argv[1:]
with state.joinpath("calls").open("a") as calls:
    print(*words, file=calls)
if "update" in words:
    sys.exit("update" in lines["failing"] and "E: no network")
if "indextargets" in words:
    print(f"Debian {{state / 'own.list'}}:1")
    sys.exit(0)
if "source" in words and "--print-uris" in words:
    print(state.joinpath("uris").read_text())
    sys.exit(0)
if "source" in words:
    print("E: Failed to fetch lammps_1.dsc  404  Not Found", file=sys.stderr)
    sys.exit("E: Failed to fetch some archives.")
names = words[words.index("install") + 1:]
bad = [name for name in names if name in refused]
if bad:
    print(refused[bad[0]])
    sys.exit(100)
if "-s" in words:
    sys.exit(0)
if "--assume-no" in words:
    print("Need to get 1,234 kB/56.7 MB of archives.")
    print("After this operation, 89.1 MB of additional disk space will be used.")
    sys.exit(1)
bad = [name for name in names if name in lines["failing"]]
state.joinpath("installed").write_text("".join(name + "\\n" for name in lines["installed"] + names if name not in bad))
sys.exit(100 if bad else 0)
"""
DPKG_QUERY = """#!{python} -IS
import sys
from pathlib import Path
state = Path({state!r})
installed = state.joinpath("installed").read_text().split()
if "Conflicts" in sys.argv[3]:
    print(state.joinpath("conflicts").read_text())
for name in sys.argv[4:]:
    if name in installed:
        print("installed", name)
"""
PACKAGES = """# a comment
needed       # why
film-dev     without: no films are made   # a comment
old-name     {suite}=new-name nosuch=other-name
gone         {suite}=-   without: nothing
lint         without: the sources are not looked at
"""


@pytest.fixture
def machine(tmp_path):
    """machine(...): run a copy of set-up on a machine with this state; its lines, its errors and its status."""
    tools, programs, state = (tmp_path / name for name in ("tools", "bin", "state"))
    for folder in (tools, programs, state, tmp_path / "lammps" / "cmake"):
        folder.mkdir(parents=True)
    (tmp_path / "lammps" / "cmake" / "CMakeLists.txt").touch()
    for name in ("setup.sh", "upstream_source.sh"):
        shutil.copy(TOP / "tools" / name, tools)
    (tools / "packages.txt").write_text(PACKAGES.format(suite=SUITE))
    for name, text in (("apt-get", APT_GET), ("dpkg-query", DPKG_QUERY), ("sudo", '#!/bin/sh\nexec env "$@"\n')):
        (programs / name).write_text(text.format(python=sys.executable, state=str(state)) if "{" in text else text)
        (programs / name).chmod(0o755)

    def run(installed=(), refused=(), failing=(), conflicts="", source=tmp_path / "lammps"):
        for name, lines in (("installed", installed), ("refused", refused), ("failing", failing), ("calls", ())):
            (state / name).write_text("".join(line + "\n" for line in lines))
        (state / "conflicts").write_text(conflicts)
        environment = {**os.environ, "PATH": f"{programs}:/usr/bin:/bin", "LAMMPS_SOURCE_DIR": str(source)}
        done = subprocess.run([tools / "setup.sh"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              check=False, env=environment)
        return done.stdout.splitlines(), done.stderr.splitlines(), done.returncode
    run.state = state
    return run


def really_installed(machine):
    """What the calls of apt-get that are no simulation were for."""
    calls = [line for line in (machine.state / "calls").read_text().splitlines()
             if "install" in line.split() and "-s" not in line.split() and "--assume-no" not in line]
    return [line.split("install ", 1)[1].split() for line in calls]


def test_what_is_missing_is_installed_in_the_names_of_this_release(machine):
    said, errors, status = machine(installed=["lint"])
    assert (errors, status) == ([], 0)
    assert really_installed(machine) == [["needed", "film-dev", "new-name"]]
    assert "packages that are missing: 3;" in said[0] and "disk" in said[0]
    assert said[1] == "setup: installing needed film-dev new-name (56.7 MB to download, 89.1 MB on disk)"


def test_nothing_is_asked_of_apt_when_nothing_is_missing(machine):
    said, errors, status = machine(installed=["needed", "film-dev", "new-name", "lint"])
    assert (errors, status) == ([], 0) and said[0] == "setup: no package is missing"
    assert not (machine.state / "calls").read_text()


def test_no_package_is_ever_removed(machine):
    machine()
    for line in (machine.state / "calls").read_text().splitlines():
        assert "update" in line or "--assume-no" in line or "--no-remove" in line, line


@pytest.mark.parametrize("words, conflicts, why", [
    ("Remv python3-paraview [5.11.0]", "", "it would remove python3-paraview"),
    (" viewer : Conflicts: python3-film but 9.1 is to be installed",      # as apt says it of ParaView
     "", "viewer, which is installed, excludes python3-film"),
    (" film-dev : Depends: python3-film (= 9.1) but it is not going to be installed",
     "installed viewer: other, python3-film, ", "viewer, which is installed, excludes python3-film"),
    (" film-dev : Depends: python3-film (= 9.1) but it is not going to be installed",
     "config-files viewer: python3-film, ", "python3-film, which it needs, cannot be installed"),
    ("E: Unable to locate package film-dev", "", "Unable to locate package film-dev"),
])
def test_one_that_cannot_be_had_is_left_out_with_its_reason(machine, words, conflicts, why):
    said, errors, status = machine(refused=[f"film-dev: {words}"], conflicts=conflicts)
    assert (errors, status) == ([], 0)
    assert said[1] == f"setup: film-dev is left out, {why}: no films are made"
    assert really_installed(machine) == [["needed", "new-name", "lint"]]
    assert len(said) == 4                        # and what is missing, what is installed, where LAMMPS is


def test_left_out_alone_nothing_is_installed(machine):
    said, errors, status = machine(installed=["needed", "new-name", "lint"], refused=["film-dev: E: no such package"])
    assert (errors, status) == ([], 0) and really_installed(machine) == []
    assert said[1] == "setup: film-dev is left out, no such package: no films are made"


def test_without_one_that_all_need_nothing_is_installed(machine):
    said, errors, status = machine(refused=["new-name: E: Package 'new-name' has no installation candidate"])
    assert status == 1 and really_installed(machine) == []
    assert errors == ["setup: error: apt-get cannot install new-name: Package 'new-name' has no installation candidate"]


def test_failure_while_one_is_installed_that_all_need(machine):
    said, errors, status = machine(failing=["needed"])
    assert status == 1 and len(errors) == 1
    assert errors[0].startswith("setup: error: apt-get could not install: needed (status 100; 3 of 4 are installed). "
                                "Run it again")


def test_failure_while_one_is_installed_that_set_up_does_without(machine):
    said, errors, status = machine(failing=["film-dev"])
    assert (errors, status) == ([], 0)
    assert "setup: film-dev could not be installed (apt-get ended with status 100): no films are made" in said


def lammps_archive(folder, within, checksum=None):
    """An archive of a LAMMPS source tree, and the line of apt-get source --print-uris for it."""
    archive = folder / "lammps_1.orig.tar.xz"
    with tarfile.open(archive, "w:xz") as tar:
        for name in ("cmake/CMakeLists.txt", "src/version.h", "examples/melt/in.melt"):
            tar.addfile(tarfile.TarInfo(f"{within}{name}"))
    checksum = checksum or hashlib.sha256(archive.read_bytes()).hexdigest()
    return f"'file://{archive}' {archive.name} {archive.stat().st_size} SHA256:{checksum}\n"


@pytest.mark.parametrize("within", ["", "lammps-1/"])
def test_mirror_without_a_file_of_the_source_package(machine, tmp_path, within):
    (machine.state / "own.list").write_text("deb file:///nowhere suite main\n")
    (machine.state / "uris").write_text(lammps_archive(tmp_path, within))
    said, errors, status = machine(installed=["needed", "film-dev", "new-name", "lint"], source="")
    assert (errors, status) == ([], 0)
    assert any("404  Not Found" in line and "upstream archive alone" in line for line in said)
    source = tmp_path / ".lammps" / "source"
    assert said[-1] == f"setup: LAMMPS source: {source}"
    assert (source / "cmake" / "CMakeLists.txt").exists() and (source / "src" / "version.h").exists()
    assert not list(source.glob("examples/*")) and [entry.name for entry in source.parent.iterdir()] == ["source"]


@pytest.mark.parametrize("uris, why", [("", "no upstream archive of lammps"), ("0" * 64, "Hash Sum mismatch")])
def test_no_source_of_lammps(machine, tmp_path, uris, why):
    (machine.state / "own.list").write_text("deb file:///nowhere suite main\n")
    (machine.state / "uris").write_text(uris and lammps_archive(tmp_path, "", uris))
    _, errors, status = machine(installed=["needed", "film-dev", "new-name", "lint"], source="")
    assert (status, len(errors)) == (1, 1) and "404  Not Found; the upstream" in errors[0] and why in errors[0]
    assert not list((tmp_path / ".lammps").iterdir())


@pytest.mark.parametrize("log, why", [("x\nE: one\nE: two\n", "one"), ("tar: a\ntar: Exiting\n\n", "tar: Exiting"),
                                      ("", "without a message")])
def test_the_reason_of_a_failure(tmp_path, log, why):
    (tmp_path / "log").write_text(log)
    done = subprocess.run(["bash", "-c", '. "$0/tools/upstream_source.sh"; reason "$1"', TOP, tmp_path / "log"],
                          capture_output=True, text=True)
    assert (done.stdout, done.stderr) == (f"{why}\n", "")


def test_no_root_and_no_sudo(machine, tmp_path):
    if os.geteuid() == 0:
        pytest.skip("for a user; this is root")
    (tmp_path / "bin" / "sudo").unlink()
    if shutil.which("sudo"):
        pytest.skip("sudo is installed")
    _, errors, status = machine()
    assert status == 1
    assert errors == ["setup: error: not root and no sudo, cannot install: needed film-dev new-name lint"]


def test_the_list_of_packages():
    """Each is named once, and says what is lost in words of its own if set-up does without it."""
    lines = [line.split("#")[0].split() for line in (TOP / "tools" / "packages.txt").read_text().splitlines()]
    lines = [line for line in lines if line]
    assert len({line[0] for line in lines}) == len(lines) > 20
    for name, *rest in lines:
        assert re.fullmatch(r"[a-z0-9][a-z0-9+.-]+", name)
        names = rest[:rest.index("without:")] if "without:" in rest else rest
        assert all(re.fullmatch(r"[a-z]+=(-|[a-z0-9][a-z0-9+.-]+)", word) for word in names), name
        assert "without:" not in rest or len(rest) - len(names) > 2, name
    needed = {line[0] for line in lines if "without:" not in line}
    assert {"cmake", "libopenmpi-dev", "python3-numpy"} <= needed and "libvtk9-dev" not in needed


def test_a_path_with_blanks_is_refused_before_anything_is_downloaded(tmp_path):
    tools = tmp_path / "two words" / "tools"
    tools.mkdir(parents=True)
    shutil.copy(TOP / "tools" / "build.sh", tools)      # without setup.sh, which it must not come to
    done = subprocess.run([tools / "build.sh"], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(r"build: the path of the checkout must have no blanks.* got .*two words\n", done.stderr)
