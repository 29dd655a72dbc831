"""Of all tests in Python: the tools are on the path of modules, and the mark long is known."""
import os
import sys
from pathlib import Path

sys.path.insert(0, os.environ.get("SLOPE_TOOLS", str(Path(__file__).resolve().parents[1] / "tools")))


def pytest_configure(config):
    config.addinivalue_line("markers", "long: not part of the short run of tests/run.sh; an entry of ctest of its own")
