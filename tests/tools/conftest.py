"""Fixtures of several tests of the tools."""
import pytest

import tiny_collapse


@pytest.fixture
def tiny_case(tmp_path, monkeypatch):
    """A folder to work in, with the tiny collapse in case/ and the program in the environment."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", tiny_collapse.LMP)
    tiny_collapse.write_case(tmp_path / "case")
    return tmp_path
