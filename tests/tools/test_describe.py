"""slope COMMAND --describe, and the QGIS plugin's copy of it."""
import json
import os
import re
import subprocess
import zipfile

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
