"""Options of the command line: the fields of a request; what types take, and the one line for what they do not."""
import argparse
import dataclasses
import importlib
import re
import shlex
from pathlib import Path
from typing import List, Optional

import pytest


from run_helpers import called

from slope_tools import cli, options


@pytest.mark.parametrize("command", ["report", "study", "terrain"])
def test_help_has_units_and_an_example(command, capsys):
    status, out, _ = called(capsys, [command, "--help"])
    assert status == 0 and "units: metres" in out and f"\n  tools/slope {command} " in out


def test_annotations_that_are_made_when_they_are_asked_for(monkeypatch):
    """From Python 3.14 on a class's dictionary has none."""
    monkeypatch.setattr(options, "vars", lambda one: {name: vars(one)[name] for name in vars(one)
                                                      if name != "__annotations__"}, raising=False)
    parser = argparse.ArgumentParser()
    options.declare(parser, importlib.import_module("slope_tools.commands.terrain").Request)
    assert parser.parse_args(["dem.tif", "-o", "t.asc", "--cell", "2"]).cell == 2


@pytest.mark.parametrize("text, value", [("1", 1), ("007", 7), ("1000000", 1000000), ("1000000000", 10 ** 9)])
def test_count(text, value):
    assert options.count(text) == value


@pytest.mark.parametrize("text, rule", [("0", ">= 1"), ("-3", ">= 1"), ("1.5", ">= 1"), ("1e3", ">= 1"), ("", ">= 1"),
                                        ("1000000001", "<= 1000000000"), ("9" * 5000, "<= 1000000000")])
def test_no_count(text, rule):
    with pytest.raises(argparse.ArgumentTypeError, match=re.escape(f"must be a whole number {rule}, got {text!r}")):
        options.count(text)


@pytest.mark.parametrize("text, value", [("0", 0), ("-12", -12), ("+4", 4), ("4294967295", 2 ** 32 - 1)])
def test_whole(text, value):
    assert options.parse_whole_number(text) == value


@pytest.mark.parametrize("text", ["1e3", "x", "2.0", "1_000", " 1", "", "9" * 19])
def test_not_whole(text):
    with pytest.raises(argparse.ArgumentTypeError, match=re.escape(f"must be a whole number of at most 18 digits, got "
                                                                   f"{text!r}")):
        options.parse_whole_number(text)


@pytest.mark.parametrize("words", [
    "terrain dem.tif -o terrain.asc --fill 1e3", "calibrate in.x --vary a=0:1 --runs 9 -o out --seed 1e3",
    "study in.x --sample 1e3 -o out", "study in.x --seed 1e3 -o out", "travel a.dump --type 1e3",
    "volume run --road r.csv --mesh 5 --samples 1e3"])
def test_no_option_has_the_words_of_argparse(words, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(words.split())
    err = capsys.readouterr().err
    assert ended.value.code == 2 and err.count("\n") == 1 and "must be a whole number" in err and "'1e3'" in err


@pytest.mark.parametrize("words, said", [
    ("verify --only 05 --only 06", "slope verify: --only: must be given once, got 05 and 06"),
    ("site mine --balls 800 --balls 900", "slope site: --balls: must be given once, got 800 and 900"),
    ("volume run --road a.csv --road b.csv --mesh 5", "slope volume: --road: must be given once, got a.csv and b.csv")])
def test_no_value_is_lost_to_a_second_one(words, said, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(words.split())
    assert ended.value.code == 2 and capsys.readouterr().err == f"{said}\n"


@pytest.mark.parametrize("words, short", [("volume run --road r.csv --mesh 5 --cut 30", "--cut 30"),
                                          ("study in.x --set d=1 -o out --dry", "--dry"),
                                          ("site mine --vol 5", "--vol 5")])
def test_abbreviations_are_no_options(words, short, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(words.split())
    err = capsys.readouterr().err
    assert ended.value.code == 2 and err.count("\n") == 1 and "unrecognized" in err and short in err


@pytest.mark.parametrize("command, words, now", [
    ("polygon", "a.csv --crs EPSG:6677", "a.csv --assign-crs EPSG:6677"),
    ("release", "t.asc --crs=EPSG:6677", "t.asc --assign-crs=EPSG:6677"),
    ("calibrate", "in.x --vary a=0:1 --volume 5", "in.x --vary a=0:1 --road-volume 5"),
    ("sensitivity", "in.x --vary a=0,1", "in.x --try a=0,1"),
    ("report", "out --project A", "out --name A"), ("bench", "--repeat 3", "--runs 3")])
def test_older_names_of_options_are_taken_with_a_note(command, words, now, capsys):
    assert cli.with_new_names(command, words.split()) == now.split()
    old, new = (set(text.replace("=E", " E").split()) for text in (words, now))
    assert capsys.readouterr().err == f"slope {command}: note: {', '.join(old - new)} is {', '.join(new - old)} now\n"
    assert cli.with_new_names("study", words.split()) == words.split()
    module = cli.module_of(command, None)
    help_ = cli.add_command(argparse.ArgumentParser().add_subparsers(), command, module).format_help()
    assert (new - old).pop() in help_ and not re.search(rf"{(old - new).pop()}\b", help_)


def test_the_two_commands_of_the_readme_are_of_files_that_are_here():
    top = Path(__file__).parents[2]
    lines = (top / "README.md").read_text().replace("$e", "inputs/20_embankment").splitlines()
    site, = [shlex.split(line)[1:] for line in lines if line.startswith("    tools/slope site ")]
    assert f"    tools/slope study {site[site.index('-o') + 1]}" in lines
    parser = cli.Parser()
    commands = parser.add_subparsers()
    cli.add_command(commands, "site", cli.module_of("site", parser))
    args = parser.parse_args(site)
    for path in [*args.terrain, args.release, *args.road]:
        assert (top / str(path)).is_file()


# --- a request ---

@dataclasses.dataclass(frozen=True, kw_only=True)
class Place:
    GROUP = "place"
    file: Optional[Path] = options.option("a file", metavar="F", one_of="place")
    local: bool = options.flag("local metres", one_of="place")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Asked(Place, options.Overwrite):
    deck: Path = options.positional("the deck", metavar="DECK")
    cut_angle: float = options.option("an angle", default=30.0)
    mesh: float = options.option("a size")
    shown: Optional[int] = options.option("a run", "--run")
    ends: Optional[List[float]] = options.option("both ends", nargs=2)
    set: List[str] = options.several("values")
    sure: Optional[str] = options.option("is it", choices=["yes", "no"], also={"--unsure": "no"})
    site: str = "none"


def asked(words, **more):
    parser = argparse.ArgumentParser(exit_on_error=False)
    options.declare(parser, Asked)
    return options.request(Asked, parser.parse_args(words.split(), argparse.Namespace(**more)))


def test_fields_are_options():
    assert asked("in.x --mesh 5") == Asked(deck=Path("in.x"), mesh=5.0)
    one = asked("in.x --mesh 5 --cut-angle 1e1 --run 3 --ends 0 -1 --set a=1 --set b=2 --unsure --local --overwrite",
                site="mine", nonsense=1)
    assert dataclasses.asdict(one) == {
        "deck": Path("in.x"), "cut_angle": 10.0, "mesh": 5.0, "shown": 3, "ends": [0.0, -1.0], "set": ["a=1", "b=2"],
        "sure": "no", "site": "mine", "file": None, "local": True, "overwrite": True}


def test_a_request_is_not_written_to():
    one = asked("in.x --mesh 5")
    with pytest.raises(dataclasses.FrozenInstanceError):
        one.mesh = 6.0
    one.set.append("a=1")
    assert asked("in.x --mesh 5").set == [] and dataclasses.replace(one, mesh=6.0).mesh == 6.0


@pytest.mark.parametrize("words, rule", [
    ("in.x", "required: --mesh"), ("in.x --mesh 1_5", "finite number"), ("in.x --mesh 5 --run 0", "whole number >= 1"),
    ("in.x --mesh 5 --local --file f", "not allowed with"), ("in.x --mesh 5 --site mine", "unrecognized"),
    ("in.x --mesh 5 --sure perhaps", "invalid choice")])
def test_what_a_field_does_not_take(words, rule, capsys):
    with pytest.raises((SystemExit, argparse.ArgumentError)) as ended:
        asked(words)
    assert rule in capsys.readouterr().err + str(ended.value)


def test_options_are_in_groups_their_own_first():
    parser = argparse.ArgumentParser()
    options.declare(parser, Asked)
    told = parser.format_help().partition("\noptions:\n")[2]
    assert told.index("--cut-angle") < told.index("--overwrite") < told.index("\nplace:\n") < told.index("--file F")
