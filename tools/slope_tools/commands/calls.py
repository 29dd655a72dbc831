"""Commands as functions: study("in.deck", set={"rolling": [0, 0.1]}, output="out") is `slope study in.deck ...`."""
import argparse
import importlib
from typing import Any, Iterable, List, Mapping

from ..errors import SlopeError
from ..options import declare, request
from ..tables.study_file import Study


class Parser(argparse.ArgumentParser):
    """Raises what the command line would print."""

    def error(self, message):
        raise SlopeError(f"slope_tools.{self.prog}", message)


def call(command: str, deck: Any, **options: Any) -> Any:
    """Do a command; options: those of the command line by their long names (set, road_width, anew, ..., output for -o).

    A value is a number, a text, a path, a list, True for an option without a value, or {name: values} for one that is
    given as NAME=VALUES; what is None or False is not given. Raises SlopeError on bad input. Prints what the command
    does. Gives the Study that `slope study` left.
    """
    module = importlib.import_module(f".{command}", __package__)
    parser = Parser(prog=command, allow_abbrev=False, add_help=False)
    declare(parser, module.Request)
    found = parser.parse_args([*list_option_words(parser, options), "--", str(deck)],
                              argparse.Namespace(command=command))
    asked = request(module.Request, found)
    importlib.import_module("..survey.crs", __package__).require_database()
    getattr(module, f"run_{command}")(asked)
    if command != "study" or asked.dry_run:
        return None
    return Study.read(asked.output or deck)


def list_option_words(parser: argparse.ArgumentParser, options: Mapping[str, Any]) -> List[str]:
    """The options of a command line."""
    known = {name[2:].replace("-", "_"): (name, action) for action in parser._actions
             for name in action.option_strings if name.startswith("--")}
    known["output"] = "-o", parser._option_string_actions["-o"]
    words: List[str] = []
    for name, value in options.items():
        if name.rstrip("_") not in known:       # from_, of which Python makes something else
            raise SlopeError(f"slope_tools.{parser.prog}", "must have arguments that are options of `slope "
                             f"{parser.prog}`: {', '.join(sorted(known))}", name)
        option, action = known[name.rstrip("_")]
        equals = "=" if option.startswith("--") else ""
        if value is True and action.nargs in (0, "?"):
            words.append(option)
        elif isinstance(value, Mapping):
            words += [f"{option}={key}={format_option_value(one)}" for key, one in value.items()]
        elif value is not None and value is not False:
            several = value if isinstance(action, argparse._AppendAction) and is_list_option(value) else [value]
            words += [f"{option}{equals}{format_option_value(one)}" for one in several]
    return words


def is_list_option(value: Any) -> bool:
    return isinstance(value, Iterable) and not isinstance(value, str)


def format_option_value(value: Any) -> str:
    """A value as on the command line: several with commas between."""
    return ",".join(map(str, value)) if is_list_option(value) else str(value)
