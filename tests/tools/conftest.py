"""Fixtures of several tests of the tools."""
import shlex

import pytest

import tiny_collapse


@pytest.fixture
def here(tmp_path, monkeypatch):
    """The test's folder, in which it works."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def slope(here, request, capsys, monkeypatch):
    """slope(ARGUMENTS): run `slope COMMAND ARGUMENTS` in the test's folder, with COMMAND of its file, if it has one.

    Gives status, stdout, stderr.
    """
    from run_helpers import called
    monkeypatch.setenv("LMP", tiny_collapse.LMP)
    command = getattr(request.module, "COMMAND", "")
    return lambda arguments: called(capsys, shlex.split(f"{command} {arguments}"))


@pytest.fixture
def succeed(slope):
    """The same, which must succeed; gives stdout, stderr."""
    def run(*words):
        status, out, err = slope(*words)
        assert status == 0, err
        return out, err
    return run


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


@pytest.fixture
def blank_pictures(monkeypatch):
    """blank_pictures(): the maps and charts of a report are blank from now on, as drawing takes most of its time."""
    def blank():
        from slope_tools.plots import figure_charts, figure_maps
        for name in ("value_map", "terrain_map", "small_maps", "road_map"):
            monkeypatch.setattr(figure_maps, name, lambda *_, **__: "data:image/png;base64,AAAA")
        monkeypatch.setattr(figure_maps, "mesh_map", lambda *_, **__: ("data:image/png;base64,AAAA", False))
        for name in ("chart", "bars", "convergence"):
            monkeypatch.setattr(figure_charts, name, lambda *_, **__: "data:image/svg+xml;base64,AAAA")
        monkeypatch.setattr(figure_charts, "section", lambda *_: ("data:image/svg+xml;base64,AAAA", 1, None))
    return blank
