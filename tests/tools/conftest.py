"""Fixtures of several tests of the tools."""
import base64
import os
import shlex
import sys
from pathlib import Path

import pytest
import yaml

import tiny_collapse

from slope_tools import written_yaml  # noqa: F401


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
    monkeypatch.setattr("slope_tools.deposits.volume_files.draw_removal", lambda path, *_: path.touch())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", tiny_collapse.LMP)
    tiny_collapse.write_case(tmp_path / "case")
    return tmp_path


# --- what takes time and is not looked at ---

# large files are read by libyaml, as the tools do; after written_yaml, which leaves deeply nested ones to Python
yaml.SafeLoader, yaml.SafeDumper = yaml.CSafeLoader, yaml.CSafeDumper


@pytest.fixture(scope="session", autouse=True)
def no_power_cut():
    """No file has to outlast one: files are not flushed to the disk, nor are runs looked at ten times a second only."""
    from slope_tools.runs import jobs
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda handle: None)
        patch.setattr(jobs, "POLL", 0.01)
        yield


@pytest.fixture(scope="session", autouse=True)
def one_gdal():
    """rasterio looks for GDAL's data whenever it opens a file: once is enough."""
    import rasterio.env
    gdal = rasterio.env.GDALEnv()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rasterio.env, "GDALEnv", lambda: gdal)
        yield


# --- runs ---

@pytest.fixture(scope="session", autouse=True)
def runs_once(tmp_path_factory):
    """Runs that several tests make are made once."""
    from run_cache import RunCache
    top = Path(os.environ.get("SLOPE_SHARED") or tmp_path_factory.mktemp("shared")) / "runs"
    top.mkdir(exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("slope_tools.processes.start", RunCache(top, tiny_collapse.LMP).cached)
        yield


# --- pictures ---

BLANK = {"png": base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAsTj2FAAAAABJRU5E"
                                 "rkJggg=="),
         "svg": b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"/>'}
rendered = False        # whether the test that runs looks at its pictures


def pytest_configure(config):
    config.addinivalue_line("markers", "drawn: the pictures of this test or file are rendered, as it looks at them")


def blank(module, name, made):
    """made(...) stands for module.name(...) of the tools, if that is imported, unless a test looks at its pictures."""
    module = sys.modules.get(f"slope_tools.{module}")
    real = module and getattr(module, name)
    if module and not hasattr(real, "real"):
        def save(*args, **options):
            return real(*args, **options) if rendered else made(*args, **options)
        save.real = real
        setattr(module, name, save)


def save_blank():
    """Figures are made up, and saved blank, films too: rendering takes most of the time of many commands.

    Not before something has imported matplotlib, which takes time, too: the first test that draws may be rendered.
    """
    blank("drawing.pictures", "save", lambda figure, path, **_: sys.modules["slope_tools.disk"].write_file(
        path, BLANK["png"]))
    blank("drawing.figures", "data_uri", lambda figure, kind="png": "data:image/{};base64,{}".format(
        {"png": "png", "svg": "svg+xml"}[kind], base64.b64encode(BLANK[kind]).decode("ascii")))
    blank("animation.film", "encode", lambda *_: b"film")


def save_blank_unless_drawn(node):
    global rendered
    save_blank()
    rendered = node.get_closest_marker("drawn") is not None


@pytest.fixture(scope="module", autouse=True)
def blank_in_fixtures(request):
    """What the fixtures of a module make, unless the module has the mark drawn."""
    save_blank_unless_drawn(request.node)


@pytest.fixture(autouse=True)
def blank_in_tests(request):
    save_blank_unless_drawn(request.node)


@pytest.fixture
def blank_pictures(monkeypatch):
    """blank_pictures(): the maps and charts of a report are blank from now on, as drawing takes most of its time."""
    from run_helpers import blank_figures
    return lambda: blank_figures(monkeypatch)
