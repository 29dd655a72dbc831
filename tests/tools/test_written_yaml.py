"""YAML that people write: what it reads in another way than it is written is refused in one line."""
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from run_helpers import write_sidecar

from slope_tools import cli, disk, written_yaml
from slope_tools.errors import SlopeError
from slope_tools.report import reference
from slope_tools.schemas import NUMBER, check_schema, mapping
from slope_tools.survey import rasters


@pytest.mark.parametrize("text, line, got, rule", [
    ("b: 1\na: 010", 2, "010", "must be a decimal number, or a text in quotes (YAML takes it for 8)"),
    ("a: -010", 1, "-010", "for -8)"), ("a: [1, 00]", 1, "00", "for 0)"), ("010: a", 1, "010", "for 8)"),
    ("a: 0x1F", 1, "0x1F", "for 31)"), ("a: 0b11", 1, "0b11", "for 3)"), ("a: 1_000", 1, "1_000", "for 1000)"),
    ("a: 1_0.5", 1, "1_0.5", "for 10.5)"), ("a: 1:30", 1, "1:30", "for 90)"), ("a: 1:30.5", 1, "1:30.5", "for 90.5)"),
    ("a: 2026-11-27", 1, "2026-11-27", "date"), ("a: 2026-11-27T10:00:00Z", 1, "2026-11-27T10:00:00Z", "date"),
    ("a: 1\nb: 2\na: 3", 3, "a", "must have each key once, a is in line 1, too"),
    ("b:\n  a: 1\n  'a': 1", 3, "a", "once"), ("{a: 1, a: 1}", 1, "a", "once"),
    ("yes: 1\ntrue: 2", 2, "true", "once"),
    ("- {1: a, 1.0: b}", 1, "1.0", "once"), ("x: &m {a: 1}\ny:\n  <<: *m\n  b: 1\n  b: 2", 5, "b", "once"),
])
def test_what_misleads_is_refused(tmp_path, text, line, got, rule):
    path = tmp_path / "a.yaml"
    for more in ("", f"\n# {6000 * '['}"):      # by libyaml; by Python's loader
        path.write_text(text + more)
        with pytest.raises(SlopeError) as error:
            disk.parse_yaml(path, "a file")
        found = str(error.value)
        assert found.startswith(f"{path}: line {line}: ") and found.endswith(f", got {got}") and rule in found


def test_what_means_what_it_says_is_read():
    about = {"a": True, "b": False, "c": [0, 5, -7], "d": [1500.0, 0.5, 10.5], "e": "010", "f": "2026-11-27", "g": None,
             "h": "EPSG:6677", "i": "NO2"}
    assert written_yaml.load_yaml("a: yes\nb: off\nc: [0, +5, -7]\nd: [1.5e+3, .5, 010.5]\ne: '010'\nf: '2026-11-27'\n"
                                  "g: ~\nh: EPSG:6677\ni: NO2\n") == about
    assert written_yaml.load_yaml("x: &m {a: 1, b: 1}\ny:\n  <<: *m\n  a: 2")["y"] == {"a": 2, "b": 1}


def test_what_the_tools_write_is_read():
    names = ["010", "0x1F", "1:30", "2026-11-27", "1_000", "1e3", "yes", "=", "08", "<<", "null", "12e45"]
    about = {"names": names, **{name: k for k, name in enumerate(names)}, "numbers": [1e-9, 1e22, 0.1, -3, 10 ** 20]}
    assert written_yaml.load_yaml(disk.yaml_text("of names that look like numbers", about)) == about


def test_it_is_read_by_libyaml():
    assert written_yaml.FAST.__mro__[2] is yaml.CSafeLoader


@pytest.mark.parametrize("text, meant", [("1.2e1", "12.0"), ("08", "8.0"), ("'12'", "12.0"), ("1e-9", "1.0e-09")])
def test_a_text_that_is_meant_as_a_number(text, meant):
    with pytest.raises(SlopeError, match=rf"a: must be a finite number \(as {meant}; YAML takes it for "
                       "a text\\), got '"):
        check_schema(written_yaml.load_yaml(f"a: {text}"), mapping({"a": NUMBER}), "x.yaml", "a file")


def test_each_file_that_people_write(here, capsys):
    """Sidecar, reference values, site.yaml, route.yaml."""
    write_sidecar(2, 3, 10)
    sidecar = Path("terrain.yaml")
    text = sidecar.read_text()
    for changed in (text + "origin: {east: 0, north: 0}\n", text.replace("rows: 2", "rows: 02")):
        sidecar.write_text(changed)
        with pytest.raises(SlopeError, match="terrain.yaml: line [0-9]+: must"):
            rasters.read_place("terrain.asc")
    Path("r.yaml").write_text("title: T\nquantities:\n  a:\n    levels: {b: 010}\n")
    with pytest.raises(SlopeError, match="r.yaml: line 4: .*got 010"):
        reference.read_reference("r.yaml", {"a": "it"})
    for name, words in (("site.yaml", ["site", "mine"]), ("route.yaml", ["route", "mine"])):
        Path("mine").mkdir(exist_ok=True)
        Path("mine", name).write_text(f"slope_{name[:-5]}: 1\nslope_{name[:-5]}: 1\n")
        assert cli.main(words) == 2
        err = capsys.readouterr().err
        assert err.count("\n") == 1 and f"mine/{name}: line 2: must have each key once" in err
        Path("mine", name).unlink()


def test_without_libyaml():
    """The checks are those of Python's loader, too."""
    code = ("import yaml; del yaml.CSafeLoader; from slope_tools import written_yaml as w; "
            "print(w.FAST.__mro__[2], w.load_yaml('a: 1'))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                          env={"PYTHONPATH": str(Path(cli.__file__).parents[1])})
    assert "SafeLoader" in done.stdout and "{'a': 1}" in done.stdout
