"""cpack: what is in the .deb and the .tar.gz, and that they run where they are unpacked; see doc/src/build.rst.

They are installed, with what they need from the release, by tests/machines.sh."""

import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

TOP = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("SLOPE_BUILD", TOP / "build"))
VERSION = re.search(r'SLOPE_VERSION "(.*)"', (TOP / "src" / "slope_version.h").read_text())[1]

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not (BUILD / "CPackConfig.cmake").exists(), reason=f"no build with packages in {BUILD}"),
    pytest.mark.skipif(not shutil.which("dpkg-shlibdeps"), reason="dpkg-dev is not installed"),
    pytest.mark.skipif("SLOPE_PLUGIN" in os.environ, reason="a plugin is no package of its own"),
]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder with both packages, and beside them what is in them."""
    folder = tmp_path_factory.mktemp("cpack")
    done = subprocess.run(["cpack", "--config", str(BUILD / "CPackConfig.cmake"), "-B", str(folder)], cwd=folder,
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    deb, = folder.glob("slope-*.deb")
    tar, = folder.glob("slope-*.tar.gz")
    subprocess.run(["dpkg-deb", "-x", str(deb), str(folder / "deb")], check=True)
    (folder / "tar").mkdir()
    subprocess.run(["tar", "-xf", str(tar), "-C", str(folder / "tar")], check=True)
    return folder


def field(folder, name):
    deb, = folder.glob("slope-*.deb")
    return subprocess.check_output(["dpkg-deb", "-f", str(deb), name], text=True).strip()


def outside():
    """The environment without what leads to the checkout's programs."""
    return {key: value for key, value in os.environ.items()
            if key not in ("LMP", "SLOPE_TOOLS", "DUMP2VTK", "LIBLAMMPS")}


def test_names_tell_version_and_release(made):
    lines = Path("/etc/os-release").read_text().splitlines()
    release = dict(line.split("=", 1) for line in lines if "=" in line)
    name = "-".join(release[key].strip('"') for key in ("ID", "VERSION_ID") if key in release)
    assert sorted(path.suffix for path in made.glob(f"slope-{VERSION}-{name}-*")) == [".deb", ".gz"]
    assert field(made, "Version") == f"{VERSION}-1~{name.replace('-', '')}"


def test_files_in_the_way_of_no_other_package(made):
    """All in /opt/slope, but links of names that Debian's lammps does not have, and of the licence for Debian."""
    root = made / "deb"
    elsewhere = sorted(str(path.relative_to(root)) for path in root.rglob("*")
                       if not path.is_dir() and root / "opt" / "slope" not in path.parents)
    programs = ["slope", "slope-lmp"] + ["dump2vtk"] * (BUILD / "dump2vtk").exists()
    assert elsewhere == sorted([f"usr/bin/{name}" for name in programs] + ["usr/share/doc/slope/copyright"])
    for name in elsewhere:
        assert (root / name).is_symlink() and (root / name).resolve().is_file(), name


def test_what_it_depends_on(made):
    """What its programs are linked with, and the Python modules of tools/packages.txt; the tarball says the same."""
    depends = {word.split()[0] for word in field(made, "Depends").split(", ")}
    text = (TOP / "tools" / "packages.txt").read_text().split("\n# tools\n")[1].split("\n\n")[0]
    modules = {line.split()[0] for line in text.splitlines()
               if line.startswith("python3") and " without: " not in line}
    assert {"python3-numpy", "python3-yaml"} <= modules <= depends
    assert {"libc6", "libstdc++6", "openmpi-bin"} <= depends
    assert any(name.startswith("libvtk9") for name in depends) == (BUILD / "dump2vtk").exists()
    needs, = made.glob("tar/slope-*/share/slope/needs.txt")
    assert set(needs.read_text().split()) == depends


@pytest.mark.parametrize("kind", ["deb", "tar"])
def test_a_study_where_it_was_unpacked(made, kind, tmp_path):
    """Through the links of the .deb, and of the .tar.gz with the lmp beside slope: balls of 8 m, a second."""
    at = made / "deb" / "opt" / "slope" if kind == "deb" else next(made.glob("tar/slope-*"))
    slope = made / "deb" / "usr" / "bin" / "slope" if kind == "deb" else at / "bin" / "slope"
    case = at / "share" / "slope" / "inputs" / "20_embankment" / "in.embankment"
    words = [slope, "study", case, "--set", "d=8", "--set", "rule=ours", "--set", "duration=1", "-o", "out"]
    done = subprocess.run(words, cwd=tmp_path, env=outside(), text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    about, = (tmp_path / "out").rglob("variables.yaml")
    lmp = hashlib.sha256((at / "bin" / "lmp").read_bytes()).hexdigest()
    assert yaml.safe_load(about.read_text())["lmp_sha256"] == lmp
    assert list((tmp_path / "out").rglob("finished.yaml"))


def test_nothing_is_left_when_it_is_removed(made):
    """prerm takes away what Python wrote beside the sources, and nothing else."""
    deb, = made.glob("slope-*.deb")
    script = subprocess.check_output(["dpkg-deb", "-I", str(deb), "prerm"], text=True)
    root = made / "deb"
    (root / "opt" / "slope" / "share" / "slope" / "tools" / "slope_tools" / "__pycache__").mkdir(exist_ok=True)
    before = {path for path in root.rglob("*") if "__pycache__" not in path.parts}
    script = script.replace("/opt/slope", str(root / "opt" / "slope"))
    subprocess.run(["sh", "-c", script, "prerm", "remove"], check=True)
    assert set(root.rglob("*")) == before
