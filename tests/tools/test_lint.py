"""Programs that read sources: layout and static analysis of the C++, style and types of the Python, pages as HTML."""
import os
import shutil
import subprocess
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("SLOPE_BUILD", TOP / "build"))


def run(*words):
    return subprocess.run(words, env={**os.environ, "JOBS": "1", "SLOPE_GARBAGE": "stays"}, text=True, check=False,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


@pytest.mark.parametrize("program", ["clang-format", "flake8", "mypy", "cppcheck"])
def test_sources_are_clean(program):
    done = run(TOP / "tests" / "lint.sh", program)
    if done.returncode == 77:
        pytest.skip(done.stdout.strip())
    assert done.returncode == 0, done.stdout


@pytest.mark.skipif(not shutil.which("sphinx-build"), reason="Sphinx is not installed")
def test_every_reference_resolves_and_every_formula_renders():
    done = run("sphinx-build", "-W", "--keep-going", "-q", "-E", "-d", BUILD / "tests" / "doctrees",
               TOP / "doc" / "src", BUILD / "tests" / "html")
    assert done.returncode == 0, done.stdout
