"""Programs that read sources: layout and static analysis of the C++, style and types of the Python, pages as HTML."""
import os
import subprocess
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[2]


def run(*words, top=TOP):
    return subprocess.run([top / "tests" / "lint.sh", *words], env={**os.environ, "JOBS": "1"}, text=True, check=False,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


@pytest.mark.parametrize("program", ["clang-format", "flake8", "mypy", "cppcheck", "sphinx-build"])
def test_sources_are_clean(program):
    done = run(program)
    if done.returncode == 77:
        pytest.skip(done.stdout.strip())
    assert done.returncode == 0, done.stdout


def test_what_was_clean_is_looked_at_again_once_it_differs(tmp_path):
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "lint.sh").write_bytes((TOP / "tests" / "lint.sh").read_bytes())
    (tmp_path / "tests" / "lint.sh").chmod(0o755)
    source = tmp_path / "some.py"
    for text, clean in (("1", True), ("b", False), ("b", False), ("1", True), ("1", True)):
        source.write_text(f"a = {text}\n", encoding="ascii")
        done = run("flake8", top=tmp_path)
        if done.returncode == 77:
            pytest.skip(done.stdout.strip())
        assert (done.returncode == 0) == clean and ("F821" in done.stdout) != clean, done.stdout
        assert (tmp_path / "build" / "lint" / "flake8").is_file() == clean
