"""Some random sequences of commands, other ones each day; tests/fuzz_runs.py runs more of them."""

import subprocess
import sys
from pathlib import Path

from deck_helpers import ENVIRONMENT

SCRIPT = Path(__file__).resolve().parents[1] / "fuzz_runs.py"


def test_what_goes_on_is_what_a_restart_file_brings():
    run = subprocess.run([sys.executable, SCRIPT, "--day", "--count", "10"], env=ENVIRONMENT, capture_output=True,
                         text=True)
    assert run.returncode == 0, run.stdout + run.stderr
