"""The pages: for whom each is, the arguments of commands from their parsers, and how long all of them may become."""
import argparse
import re
import sys

import pytest

from run_helpers import TOP

DOC = TOP / "doc" / "src"
sys.path.insert(0, str(DOC))

import slope_options  # noqa: E402  (after the path is set)

from slope_tools import cli  # noqa: E402

GENERATED = ("verification", "wrong_inputs", "granular_suite")     # by slope verify, test_wrong_inputs.py, its script
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in sorted(DOC.glob("*.rst"))}
COMMANDS = [*cli.COMMANDS, *cli.IN_TESTS]
READERS = r"users|reviewers|developers|writers of decks|all"
MOST, USERS, README = 72_600, 6_000, 910        # words


def words(*names):
    return sum(len(PAGES[name].split()) for name in names)


@pytest.mark.parametrize("name", PAGES)
def test_the_first_line_says_for_whom_a_page_is(name):
    title = re.search(r"^(\S.*)\n=+\n\n(.*)", PAGES[name], re.MULTILINE)
    assert re.match(rf"\*For [^*]*\b({READERS})\b[^*]*\*", title[2]), title[2]


@pytest.mark.parametrize("command", COMMANDS)
def test_the_page_of_a_command_lists_what_its_parser_takes(command):
    assert f"\n.. options:: {command}\n" in PAGES[f"tool_{command}"]
    parser = slope_options.parser_of(command)
    rows = [row for _, _, group in slope_options.arguments(parser) for row in group]
    shown = {option for row in rows for option in re.findall(r"(?:^|, )(--?[a-z][a-z-]*)", row[0])}
    assert shown == {option for action in parser._actions if action.help != argparse.SUPPRESS
                     for option in action.option_strings} - {"-h", "--help"}
    assert all(meaning for _, meaning in rows) and not any("%(" in meaning for _, meaning in rows)


def test_values_are_shown_as_they_are_typed():
    rows = dict(row for _, _, group in slope_options.arguments(slope_options.parser_of("travel")) for row in group)
    assert {"DUMP ...", "--axis x|y|DEG", "--origin X Y", "--type N ...", "--overwrite"} <= set(rows)
    assert "(default travel)" in rows["-o DIR"]


def test_no_page_is_left_out_of_the_contents():
    listed = re.findall(r"^   (\w+)$", PAGES["index"], re.MULTILINE)
    assert sorted(listed) == sorted(set(PAGES) - {"index"})


@pytest.mark.parametrize("path", [path for path in (TOP / "README.md", *DOC.glob("*.rst"), *(TOP / "inputs").rglob("*"))
                                  if path.suffix in (".md", ".rst", ".yaml", ".py") or path.name.startswith("in.")],
                         ids=lambda path: str(path.relative_to(TOP)))
def test_nothing_is_ascribed_to_the_paper_that_it_does_not_state(path):
    """It has no released volume, no depth of the slip; the elevation data are free, and not shipped."""
    parts = re.split(r"\n\s*\n", path.read_text(encoding="utf-8"))
    for sentence in (one for part in parts for one in re.split(r"(?<=[.:;])\s", " ".join(part.split()))):
        assert not re.search(r"(data|terrain).*not public", sentence), sentence
        assert not (re.search(r"[Tt]aken from the paper|paper (states|gives|has)", sentence)
                    and re.search(r"49,000|48,858", sentence)), sentence


def test_the_pages_are_as_long_as_they_may_be():
    assert words(*(set(PAGES) - set(GENERATED))) <= MOST
    assert words("tutorial", "gis", "limits") <= USERS
    assert len((TOP / "README.md").read_text(encoding="utf-8").split()) <= README
