"""Some random sequences of commands, other ones each day; tests/fuzz_runs.py runs more of them."""

import subprocess
import sys
from pathlib import Path

import pytest

from deck_helpers import ENVIRONMENT

SCRIPT = Path(__file__).resolve().parents[1] / "fuzz_runs.py"
sys.path.insert(0, str(SCRIPT.parent))

import fuzz_runs  # noqa: E402


@pytest.mark.long
def test_what_goes_on_is_what_a_restart_file_brings():
    run = subprocess.run([sys.executable, SCRIPT, "--day", "--count", "10"], env=ENVIRONMENT, capture_output=True,
                         text=True)
    assert run.returncode == 0, run.stdout + run.stderr


def test_a_run_that_hangs_is_one_failure(monkeypatch, capsys):
    """And the sequences after it are run."""
    def hangs(case, folder):
        raise subprocess.TimeoutExpired("lmp", 300)
    monkeypatch.setattr(fuzz_runs, "differences", hangs)
    monkeypatch.setattr(sys, "argv", ["fuzz_runs.py", "--count", "2"])
    assert fuzz_runs.main()
    told = capsys.readouterr().out
    assert told.count("not at its end after 300 s") == 4 and "2 sequences, 2 failed" in told
