"""Types of options on the command line: what they take, and the one line for what they do not."""
import argparse
import re
import shlex
from pathlib import Path

import pytest

import run_helpers  # noqa: F401  (finds slope_tools)

from slope_tools import cli, options


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
    assert options.whole(text) == value


@pytest.mark.parametrize("text", ["1e3", "x", "2.0", "1_000", " 1", "", "9" * 19])
def test_not_whole(text):
    with pytest.raises(argparse.ArgumentTypeError, match=re.escape(f"must be a whole number of at most 18 digits, got "
                                                                   f"{text!r}")):
        options.whole(text)


@pytest.mark.parametrize("words", [
    "terrain dem.tif -o terrain.asc --fill 1e3", "calibrate in.x --vary a=0:1 --runs 9 -o out --seed 1e3",
    "study in.x --sample 1e3 -o out", "study in.x --seed 1e3 -o out", "travel a.dump --type 1e3",
    "volume run --road r.csv --mesh 5 --samples 1e3"])
def test_no_option_has_the_words_of_argparse(words, capsys):
    with pytest.raises(SystemExit) as ended:
        cli.main(words.split())
    err = capsys.readouterr().err
    assert ended.value.code == 2 and err.count("\n") == 1 and "must be a whole number" in err and "'1e3'" in err


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
    ("sensitivity", "in.x --vary a=0,1", "in.x --levels a=0,1"),
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
    for path in [*args.terrain, args.release, args.road]:
        assert (top / str(path)).is_file()
