"""Sphinx: `.. options:: COMMAND` lists the arguments of a command of tools/slope, with the texts of its --help.

So help and page cannot differ, and what an argument means is written once, in tools/slope_tools/commands.
"""
import argparse
import sys
from pathlib import Path

TOOLS = Path(__file__).resolve().parents[2] / "tools"
sys.path.insert(0, str(TOOLS))

from slope_tools import cli  # noqa: E402  (after the path is set)


def parser_of(command):
    """The argparse parser of a command."""
    commands = argparse.ArgumentParser(prog="slope").add_subparsers()
    return cli.add_command(commands, command, cli.module_of(command, None))


def shown(action):
    """An argument as it is typed: `--axis x|y|DEG`, `DUMP ...`."""
    values = action.metavar or (action.choices and "|".join(action.choices)) or action.dest.upper()
    values = " ".join(values) if isinstance(values, tuple) else str(values)
    if not action.option_strings:
        return values + " ..." * (action.nargs in ("+", "*"))
    if action.nargs == 0:
        return ", ".join(action.option_strings)
    more = " ..." * (action.nargs in ("+", "*"))
    return ", ".join(f"{option} {values}{more}" for option in action.option_strings)


def arguments(parser):
    """[(title, description, [(argument as typed, its help)])] of the groups of a parser, without --help."""
    found = []
    for group in parser._action_groups:
        rows = [(shown(action), (action.help or "") % {**vars(action), "prog": parser.prog})
                for action in group._group_actions if action.dest != "help" and action.help != argparse.SUPPRESS]
        if rows:
            title = "" if group.title in ("positional arguments", "options", "optional arguments") else group.title
            found.append((title, group.description or "", rows))
    return found


def setup(app):
    """Called by Sphinx."""
    from docutils import nodes
    from sphinx.util.docutils import SphinxDirective

    def text(words):
        """A paragraph in which `...` is literal."""
        parts = words.split("`")
        return nodes.paragraph("", "", *(nodes.literal(part, part) if k % 2 else nodes.Text(part)
                                         for k, part in enumerate(parts) if part))

    class Options(SphinxDirective):
        """The list."""

        required_arguments = 1

        def run(self):
            for path in [*(TOOLS / "slope_tools" / "commands").glob("*.py"), TOOLS / "slope_tools" / "options.py"]:
                self.env.note_dependency(str(path))
            result = []
            for title, description, rows in arguments(parser_of(self.arguments[0])):
                if title:
                    result.append(nodes.paragraph("", "", nodes.strong(title, title)))
                if description:
                    result.append(text(description))
                items = [nodes.definition_list_item("", nodes.term("", "", nodes.literal(words, words)),
                                                    nodes.definition("", text(meaning))) for words, meaning in rows]
                result.append(nodes.definition_list("", *items, classes=["options"]))
            return result

    app.add_directive("options", Options)
    return {"parallel_read_safe": True}
