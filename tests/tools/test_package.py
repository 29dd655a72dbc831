"""The package from a script: the example of the page, and what --debug and a bug look like."""
import importlib
import os
import re
import subprocess
import sys

import pytest
import yaml

import tiny_collapse
from run_helpers import TOOLS, TOP

sys.path.insert(0, str(TOOLS))

from slope_tools import cli  # noqa: E402  (after the path is set)
from slope_tools.commands import polygon, study  # noqa: E402
from slope_tools.errors import SlopeError  # noqa: E402

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


def test_the_calls_of_the_page_are_there():
    rooms = "mobility|survey|case|releases|deposits|tables|report|drawing"
    calls = re.findall(rf"``((?:{rooms})\.[\w.]+)", PAGE.read_text(encoding="ascii"))
    assert len(calls) > 12
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
