"""slope COMMAND --describe, and the QGIS plugin's copy of it; what QGIS 4 needs, without QGIS."""
import ast
import configparser
import enum
import importlib
import json
import os
import re
import subprocess
import sys
import types
import zipfile
from pathlib import Path
from unittest import mock

import pytest

from run_helpers import TOOLS

from slope_tools import cli

PLUGIN = TOOLS / "qgis" / "slope"
COPY = json.loads((PLUGIN / "commands.json").read_text(encoding="utf-8"))


def told(words, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(words.split())
    assert ended.value.code == 0
    return json.loads(capsys.readouterr().out)


def test_a_command_describes_its_options(capsys):
    found = told("volume --describe", capsys)
    assert found["command"] == "volume" and "road" in found["about"]
    options = found["options"]
    assert options["cut_angle"] == {
        "option": "--cut-angle", "kind": "number", "default": 30.0, "needed": False, "choices": [], "several": False,
        "metavar": "DEG", "help": "rise of the cut surface with distance from the road's edges, degrees (default 30)"}
    assert options["prefix"]["option"] == "" and options["prefix"]["needed"]
    assert options["road"]["kind"] == "path" and options["road"]["needed"] and options["output"]["option"] == "-o"
    assert options["local"]["kind"] == "switch" and options["samples"]["kind"] == "whole"
    more = told("calibrate deck --describe", capsys)["options"]
    assert more["front_is"]["choices"] == ["length", "95", "99"] and more["front_is"]["default"] == "length"
    assert more["tolerance"]["several"] and more["tolerance"]["default"] is None and more["runs"]["kind"] == "count"
    assert told("release --describe", capsys)["options"]["least"]["default"] == 0.0


@pytest.mark.parametrize("command", sorted(COPY))
def test_the_plugin_has_what_the_command_says(command, capsys):
    """Else: tools/qgis/describe.py > tools/qgis/slope/commands.json"""
    options = told(f"{command} --describe", capsys)["options"]
    assert COPY[command] == {name: {key: one[key] for key in COPY[command][name]} for name, one in options.items()}


def test_the_copy_is_what_the_script_writes_and_the_zip_holds(tmp_path):
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    subprocess.run([TOOLS / "qgis" / "package.sh", tmp_path / "slope.zip"], check=True, stdout=subprocess.DEVNULL,
                   env=environment)
    with zipfile.ZipFile(tmp_path / "slope.zip") as packed:
        text = packed.read("slope/commands.json").decode("utf-8")
        assert "slope/options.py" in packed.namelist()
    assert text == (PLUGIN / "commands.json").read_text(encoding="utf-8")
    assert set(json.loads(text)) == {path.stem for path in PLUGIN.glob("*.py")
                                     if f'\n    command = "{path.stem}"' in path.read_text(encoding="utf-8")}


def test_what_the_plugin_asks_for_is_there():
    asked = [(command, name) for path in PLUGIN.glob("*.py")
             for command, name in re.findall(r'\bof\("(\w+)", "(\w+)"', path.read_text(encoding="utf-8"))]
    assert len(asked) > 100 and all(name in COPY[command] for command, name in asked)
    for path in PLUGIN.glob("*.py"):
        for flag in re.findall(r'Option\("\w+", "(--[\w-]+)"', path.read_text(encoding="utf-8")):
            assert any(one["option"] == flag for one in COPY[path.stem].values()), (path.stem, flag)


def test_nothing_is_started_to_load_it():
    """The table of options imports no process, and reads one file."""
    text = (PLUGIN / "options.py").read_text(encoding="utf-8")
    assert "subprocess" not in text and "process" not in re.findall(r"^from \. import (.*)$", text, re.MULTILINE)


# --- QGIS 4: Qt 6, whose enums are Python's ---

def test_qgis_4_offers_the_plugin():
    about = configparser.ConfigParser()
    about.read(PLUGIN / "metadata.txt", encoding="utf-8")
    assert about["general"]["qgisMinimumVersion"] == "3.22" and about["general"]["qgisMaximumVersion"] == "4.99"


def unscoped(text):
    """Members of enums that a source names by their class alone: Class.Member instead of Class.Enum.Member."""
    tree = ast.parse(text)
    names = {name.asname or name.name for one in ast.walk(tree) if isinstance(one, ast.ImportFrom)
             and (one.module or "").startswith("qgis") for name in one.names}
    inner = {id(one.value) for one in ast.walk(tree) if isinstance(one, ast.Attribute)}
    inner |= {id(one.func) for one in ast.walk(tree) if isinstance(one, ast.Call)}
    return [f"{one.value.id}.{one.attr}" for one in ast.walk(tree)
            if isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name) and one.value.id in names
            and one.attr[0].isupper() and id(one) not in inner]


@pytest.mark.parametrize("path", [*sorted(PLUGIN.glob("*.py")), Path(__file__).parent / "qgis_inside.py"],
                         ids=lambda path: path.stem)
def test_enums_are_scoped_and_qt_is_that_of_qgis(path):
    text = path.read_text(encoding="utf-8")
    assert not unscoped(text) and "PyQt" not in text.replace("qgis.PyQt", "")


def test_the_look_for_enums_sees_one():
    line = "from qgis.core import QgsA, QgsB\n{}\n"
    assert unscoped(line.format("f(QgsA.Double | QgsB.Flag)")) == ["QgsA.Double", "QgsB.Flag"]
    assert not unscoped(line.format("f(QgsA.Type.Double, QgsB.Inner(3), QgsA.instance, g.Other)"))


@pytest.mark.parametrize("result", ["NoError", "WriteError"])
def test_a_raster_that_was_written_is_no_error(result, monkeypatch):
    """A member of Python's enum is true, also the one whose value is 0."""
    package, results, core = types.ModuleType("slope"), types.ModuleType("slope.results"), mock.MagicMock()
    package.__path__, results.TERRAIN_TAG = [str(PLUGIN)], "TAG"
    core.QgsProcessingException = ValueError
    core.QgsRasterFileWriter.WriterError = enum.Enum("WriterError", {"NoError": 0, "WriteError": 6})
    core.QgsRasterFileWriter.return_value.writeRaster.return_value = core.QgsRasterFileWriter.WriterError[result]
    core.QgsProcessingUtils.generateTempFilename.return_value = "copy.tif"
    for name, module in {"slope": package, "slope.results": results, "qgis": mock.MagicMock(), "qgis.core": core,
                         "osgeo": mock.MagicMock()}.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, "slope.layers", raising=False)
    asked = mock.MagicMock(keep=None)
    try:
        found = importlib.import_module("slope.layers").raster_file(asked, "DEM")
    except ValueError as error:
        found = str(error)
    sys.modules.pop("slope.layers", None)
    assert found == "copy.tif" if result == "NoError" else "DEM" in found and "WriteError" in found


@pytest.mark.parametrize("line, completed", [("slope vol", {"volume"}), ("slope volume --cut", {"--cut-angle"}),
                                             ("slope calibrate deck --front-is ", {"length", "95", "99"})])
def test_a_shell_completes_commands_options_and_choices(line, completed):
    pytest.importorskip("argcomplete")
    done = subprocess.run(["bash", "-c", '"$0" 8>&1 9>/dev/null', TOOLS / "slope"], text=True, capture_output=True,
                          env={**os.environ, "_ARGCOMPLETE": "1", "_ARGCOMPLETE_IFS": "\n", "COMP_LINE": line,
                               "COMP_POINT": str(len(line))}, check=False)
    assert {word.strip() for word in done.stdout.split("\n")} - {""} == completed
