"""tests/machines.sh, as far as it goes without a chroot: its table of releases, mirrors and wrong arguments."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]
MACHINES = TOP / "tests" / "machines.sh"
TABLE = TOP / "tests" / "machines" / "releases.txt"


@pytest.fixture
def call(tmp_path):
    """call(WORDS..., sources=LINES): on a machine whose apt knows these sources."""
    def run(*words, sources="Debian bookworm http://mirror.invalid/debian/\n"):
        (tmp_path / "sources").write_text(sources)
        apt_get = tmp_path / "apt-get"
        apt_get.write_text(f'#!/bin/sh\ncase $* in indextargets*) cat "{tmp_path}/sources" ;; *) exit 9 ;; esac\n')
        apt_get.chmod(0o755)
        return subprocess.run([MACHINES, *map(str, words)], env={**os.environ, "PATH": f"{tmp_path}:/usr/bin:/bin"},
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    return run


def releases():
    lines = [line.split() for line in TABLE.read_text().splitlines() if not line.startswith("#")]
    return {line[0]: line[1:] for line in lines if line}


def test_the_table():
    """Each release has all its columns; what is not tried says so."""
    table = releases()
    assert list(table) == ["debian-12", "debian-13", "debian-sid", "ubuntu-22.04", "ubuntu-24.04"]
    for release, (distribution, suite, components, keyring, tried) in table.items():
        assert distribution.lower() == release.split("-")[0] and re.fullmatch("[a-z]+", suite)
        assert components.split(",")[0] == "main" and re.fullmatch(r"[\w-]+/[\w-]+", keyring)
        assert tried == ("yes" if distribution == "Debian" else "untried")


def test_releases_have_a_mirror_if_apt_knows_one_of_their_distribution(call):
    done = call("--list")
    assert done.returncode == 0, done.stderr
    rows = {line.split()[0]: line.split(None, 3)[1:] for line in done.stdout.splitlines()}
    assert rows == {"debian-12": ["bookworm", "yes", "has a mirror"], "debian-13": ["trixie", "yes", "has a mirror"],
                    "debian-sid": ["sid", "yes", "has a mirror"],
                    "ubuntu-22.04": ["jammy", "untried", "no mirror"],
                    "ubuntu-24.04": ["noble", "untried", "no mirror"]}
    # security updates alone are no mirror; one that is named is
    done = call("--list", sources="Debian bookworm-security http://mirror.invalid/security/\n")
    assert done.stdout.count("no mirror") == 5
    assert call("--mirror", "http://mirror.invalid/ubuntu", "--list").stdout.count("has a mirror") == 5


@pytest.mark.parametrize("words, message", [
    (["--release", "debian-11"],
     "--release must be one of debian-12 debian-13 debian-sid ubuntu-22.04 ubuntu-24.04, got debian-11"),
    (["--way", "bear"], "--way must be one of bare user paraview yade deb tar, got bear"),
    (["--tests"], "--tests: value is missing"),
    (["--quick"], "unknown option --quick, see --help"),
    (["/"], "TREE / is no git checkout with a commit"),
])
def test_wrong_arguments(call, words, message):
    if words == ["/"] and not shutil.which("git"):
        pytest.skip("git is not installed")
    done = call(*words)
    assert done.returncode == 2 and done.stderr == f"machines: {message}\n" and not done.stdout


def test_help_names_every_way(call):
    done = call("--help")
    assert done.returncode == 0
    assert all(re.search(rf"\b{way}\b", done.stdout) for way in ("bare", "user", "paraview", "yade", "deb", "tar"))
