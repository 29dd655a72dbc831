"""Every reader of files on broken ones: a second of each fuzzer of tests/fuzz, and all that they ever found."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).resolve().parents[1] / "fuzz"
BUILD = Path(os.environ.get("SLOPE_BUILD", FUZZ.parents[1] / "build"))
sys.path.insert(0, str(FUZZ))

import fuzz_readers  # noqa: E402  (after the path is set)


@pytest.mark.long
@pytest.mark.parametrize("target", fuzz_readers.TARGETS)
def test_a_second_of_mutations(target, tmp_path):
    count, findings = fuzz_readers.fuzz(target, seconds=20, seed=0, keep=tmp_path, most=100)
    assert not findings, findings
    assert count > 10      # of the slowest in 20 s


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")     # of fiona, kept off the terminal
@pytest.mark.parametrize("case", [f"{path.parent.name}/{path.name}" for path in FUZZ.glob("found/*/*")
                                  if path.is_dir()])
def test_what_was_found_in_python(case):
    wrong, _ = fuzz_readers.check(fuzz_readers.TARGETS[case.split("/")[0]][3], FUZZ / "found" / case)
    assert wrong is None, wrong


@pytest.mark.parametrize("target", ["elevation_grid", "polygon", "dump_reader"])
def test_the_readers_in_cpp(target):
    """The targets of libFuzzer, linked with a plain loop over files: what fuzzing begins with, and what it found."""
    program = BUILD / "tests" / f"fuzz_{target}"
    if not program.exists():
        pytest.skip(f"{program.name} is not built: zlib is missing")
    files = sorted([*FUZZ.glob(f"seeds/{target}/*"), *FUZZ.glob(f"found/{target}/*")])
    done = subprocess.run([program, *files], stderr=subprocess.PIPE, text=True, check=False)
    assert len(files) >= 3 and done.returncode == 0, done.stderr[-1000:]
