"""Fixtures of several tests of the tools."""
import pytest

import tiny_collapse


@pytest.fixture
def tiny_case(tmp_path, monkeypatch):
    """A folder to work in, with the tiny collapse in case/ and the program in the environment.

    The maps of slope volume, which take longest in a study, are empty; test_volume.py has one.
    """
    import run_helpers  # noqa: F401  (its path of the tools; here, as most tests need none of it)
    monkeypatch.setattr("slope_tools.deposits.volume_files.draw", lambda path, *_: path.touch())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", tiny_collapse.LMP)
    tiny_collapse.write_case(tmp_path / "case")
    return tmp_path
