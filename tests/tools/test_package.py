"""The package from a script: the example of the page, and what --debug and a bug look like."""
import importlib.util
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
import yaml

import tiny_collapse
from run_helpers import TOOLS, TOP

import slope_tools
from slope_tools import cli, options as options_of
from slope_tools.commands import calls, polygon, study
from slope_tools.errors import SlopeError

EXAMPLE = TOP / "doc" / "src" / "examples" / "clear_the_road.py"
PAGE = TOP / "doc" / "src" / "python_package.rst"


def test_the_example_of_the_page(tmp_path, monkeypatch):
    """It says what `slope study` said at the study's own angle, more for a flatter cut, and draws the map."""
    monkeypatch.chdir(tmp_path)
    tiny_collapse.write_case("case")
    assert cli.main(["study", "case/in.tiny", "--set", "rolling=0,0.1", "--set", "steps=900", "--road",
                     "case/road.csv", "--local", "-o", "out"]) == 0
    done = subprocess.run([sys.executable, str(EXAMPLE), "out", "case/road.csv", "map.png"], text=True,
                          capture_output=True, env=os.environ)
    assert done.returncode == 0, done.stderr
    runs = yaml.safe_load((tmp_path / "out" / "study.yaml").read_text())["runs"]
    for row in runs:
        told = [float(value) for value in re.findall(rf"{row['run']}: cut of .* degrees, (\S+) m3", done.stdout)]
        assert len(told) == 3 and told[0] >= told[1] >= told[2] > 0
        assert told[1] == pytest.approx(row["remove_m3"], abs=0.051)
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")


def test_the_example_tells_bad_input_in_one_line(tmp_path):
    done = subprocess.run([sys.executable, str(EXAMPLE), "nowhere", "road.csv", "map.png"], text=True,
                          capture_output=True, cwd=tmp_path, env=os.environ)
    assert done.returncode == 1 and re.fullmatch(r"clear_the_road.py: nowhere/study.yaml: .*\n", done.stderr)


@pytest.fixture(scope="module")
def session(tmp_path_factory):
    """The pieces of the page, as one session in a folder with the cases; without pandas up to its use."""
    folder = tmp_path_factory.mktemp("session")
    (folder / "inputs").symlink_to(TOP / "inputs")
    pieces = re.findall(r"\.\. code-block:: python\n\n((?:   .*\n|\n)+)", PAGE.read_text(encoding="ascii"))
    assert len(pieces) == 4
    if not importlib.util.find_spec("pandas"):
        pieces[1] = pieces[1].partition("   table =")[0]
    script = "".join(textwrap.dedent(one) for one in pieces)
    done = subprocess.run([sys.executable, "-c", script], text=True, capture_output=True, cwd=folder,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join([str(TOOLS), *sys.path])}, check=False)
    assert done.returncode == 0, done.stderr
    return folder, done.stdout.splitlines()


def test_the_session_of_the_page(session):
    folder, told = session
    rows = yaml.safe_load((folder / "out" / "study.yaml").read_text())["runs"]
    assert [row["set"]["rolling"] for row in rows] == ["0", "0.1"]
    best = max(rows, key=lambda row: row["remove_m3"])
    assert f"{best['run']} {best['set']['rolling']} {round(best['remove_m3'])}" in told
    [line] = [line for line in told if line.endswith(" m thick")]
    assert float(line.split()[0]) == pytest.approx(best["on_grid_m3"], rel=1e-3)
    assert float(line.split()[-3]) == pytest.approx(best["thickness_m"], abs=0.1)
    assert told[-1] == "--set: friction must stay within the deck's range, >= 0 and < 90, got friction=95"
    assert len(list((folder / "ensemble").glob("*/finished.yaml"))) == 4 and not (folder / "none").exists()


def test_the_frame_is_the_table(session):
    pytest.importorskip("pandas")
    folder, told = session
    frame = slope_tools.Study.read(folder / "ensemble").frame()
    rows = tiny_collapse.rows_of(folder / "ensemble" / "study.csv")
    assert list(frame.index) == [row["run"] for row in rows] and len(rows) == 4
    assert list(frame["front_m"]) == [float(row["front_m"]) for row in rows]
    assert f"{frame['front_m'].mean():.6f}" in next(line for line in told if line.startswith("mean"))


def test_without_pandas_one_line_says_so(session, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(SlopeError, match=r"^pandas: must be installed for a frame \(Debian: python3-pandas\)"):
        slope_tools.Study.read(str(session[0] / "out")).frame()


def test_a_study_that_is_not_there(tmp_path):
    with pytest.raises(slope_tools.SlopeError, match="study.yaml: must be what `slope study` wrote"):
        slope_tools.Study.read(tmp_path)


def test_public_names():
    header = (TOP / "src" / "slope_version.h").read_text()
    assert f'"{slope_tools.__version__}"' in header and slope_tools.SlopeError is SlopeError
    assert all(getattr(slope_tools, name) for name in slope_tools.__all__)
    with pytest.raises(AttributeError):
        slope_tools.nonsense


@pytest.mark.parametrize("options, words", [
    ({"set": {"rolling": [0, 0.1], "d": "4"}}, ["--set=rolling=0,0.1", "--set=d=4"]),
    ({"set": ["rolling=0:0.1:0.05"], "repeat": "seed=1,2"}, ["--set=rolling=0:0.1:0.05", "--repeat=seed=1,2"]),
    ({"output": Path("my out"), "road_width": 5.0, "exceed": [0.1, 1]},
     ["-omy out", "--road-width=5.0", "--exceed=0.1,1"]),
    ({"local": True, "dry_run": False, "anew": None, "unconfined": True, "from_": "fit"},
     ["--local", "--unconfined", "--from=fit"]),
    ({"confined": True, "known": "rock_avalanches"}, ["--confined", "--known=rock_avalanches"]),
    ({"sample": 16, "vary": {"friction": "20:40"}}, ["--sample=16", "--vary=friction=20:40"]),
    ({"repeat": ["seed=1", "xoffset=0.5"]}, ["--repeat=seed=1", "--repeat=xoffset=0.5"])])
def test_arguments_are_the_options(options, words):
    parser = calls.Parser(prog="study", add_help=False)
    options_of.declare(parser, study.Request)
    assert calls.list_option_words(parser, options) == words


@pytest.mark.parametrize("options, message", [
    ({"colour": 1}, r"^slope_tools.study: must have arguments that are options of `slope study`: .*, got colour"),
    ({"jobs": 0, "output": "out"}, r"^slope_tools.study: argument --jobs: must be a whole number >= 1, got '0'"),
    ({"sample": [1, 2]}, r"^slope_tools.study: argument --sample: must be a whole number"),
    ({"output": "out", "set": {"rolling": [0, 0]}}, r"^--set: must have every value once"),
    ({"output": "out", "set": {"rolling": True}}, r"^--set: rolling must be a number, >= 0, got rolling=True"),
    ({"set": {"rolling": 0}}, r"^-o: must be given")])
def test_wrong_arguments_are_one_line(options, message, tmp_path):
    deck = tiny_collapse.write_case(tmp_path / "case")
    with pytest.raises(SlopeError, match=message):
        slope_tools.study(deck, **options)


def test_the_calls_of_the_page_are_there():
    rooms = "mobility|survey|case|releases|deposits|tables|report|drawing"
    calls = re.findall(rf"``((?:{rooms})\.[\w.]+)", PAGE.read_text(encoding="ascii"))
    assert len(calls) >= 10
    for call in calls:
        if call == "drawing.maps":
            continue
        module, _, name = call.rpartition(".")
        assert callable(getattr(importlib.import_module(f"slope_tools.{module}"), name)), call


@pytest.mark.parametrize("debug", [False, True])
def test_bad_input_is_a_line_and_debug_shows_where(debug, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["--debug"] * debug + ["polygon", "none.geojson", "--terrain", "none.asc", "-o", "out.csv"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert lines[-1].startswith("slope polygon: ")
    assert (len(lines) == 1) != debug and ("Traceback" in lines[0]) == debug


def test_a_bug_is_told_as_one_and_debug_raises_it(monkeypatch, capsys):
    def broken(*_):
        raise KeyError("depth")
    monkeypatch.setattr(study, "check_settings", broken)
    words = ["study", "deck", "--set", "a=1", "-o", "out"]
    assert cli.main(words) == 1
    error = capsys.readouterr().err
    assert re.fullmatch(r"slope study: a bug in the tools: KeyError: 'depth' \(test_package.py, line \d+\); .*\n",
                        error)
    with pytest.raises(KeyError):
        cli.main(["--debug", *words])


def test_polygon_raises_for_a_script(tmp_path):
    """A room raises SlopeError with the line, and prints nothing."""
    with pytest.raises(SlopeError, match="none.csv"):
        polygon.polygons.read_local(tmp_path / "none.csv", None)
