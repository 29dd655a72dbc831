"""The options of a command, each stated once: the fields of its request, a frozen class, and the types of their values.

    @dataclass(frozen=True, kw_only=True)
    class Request(Overwrite):
        deck: Path = positional("LAMMPS input deck", metavar="DECK")
        road_width: Optional[float] = option("the road is a line, of this width (m)", metavar="W")    # --road-width

The annotation says how a word is read, and, without a default and Optional, that the option must be given. GROUP of a
class is the heading of its options in --help; a class's own options come before those of its bases. A field without a
help is no option.
"""
import argparse
import dataclasses
import inspect
import json
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple, Type, TypeVar, Union, get_args, get_origin
from typing import get_type_hints

from . import heads

MOST = 10 ** 9      # of anything counted; more exceeds any memory or time
R = TypeVar("R")


def option(what: str, *names: str, one_of: str = "", also: Mapping[str, str] = {}, default: Any = None,
           **words: Any) -> Any:
    """An option with a value; what: its help; names: where it is not called as the field; words: of add_argument().

    one_of: only one option with this word may be given; also: {option: value}, short for this one with the value.
    """
    about = {"names": names, "one_of": one_of, "also": also, "words": {**words, "help": what, "default": default}}
    if isinstance(default, list):
        return dataclasses.field(default_factory=lambda: list(default), metadata=about)
    return dataclasses.field(default=default, metadata=about)


def several(what: str, *names: str, **words: Any) -> Any:
    """An option that may be given several times; the values are a list."""
    return option(what, *names, action="append", default=[], **words)


def flag(what: str, *names: str, **words: Any) -> Any:
    """An option without a value."""
    return option(what, *names, action="store_true", default=False, **words)


def positional(what: str, **words: Any) -> Any:
    """A word without an option."""
    return option(what, "", **words)


def declare(parser: argparse.ArgumentParser, kind: Any) -> None:
    """Add the options of a request to a parser."""
    hints = get_type_hints(kind)
    groups: Dict[Tuple[str, str], Any] = {("", ""): parser}
    fields = {field.name: field for field in dataclasses.fields(kind) if field.metadata}
    for field, title in [(fields.pop(name), vars(base).get("GROUP", "")) for base in kind.__mro__
                         for name in inspect.get_annotations(base) if name in fields]:
        names, one_of, also, words = (field.metadata[key] for key in ("names", "one_of", "also", "words"))
        if (title, "") not in groups:
            groups[title, ""] = parser.add_argument_group(title)
        if (title, one_of) not in groups:
            groups[title, one_of] = groups[title, ""].add_mutually_exclusive_group()
        add = groups[title, one_of].add_argument
        optional, read = reader(hints[field.name])
        words = words if words.get("action") == "store_true" else {"type": read, **words}
        if names == ("",):
            add(field.name, **words)
            continue
        words.setdefault("action", Once)
        if words["default"] is None and not optional:
            words["required"] = True
        names = names or (f"--{field.name.replace('_', '-')}",)
        add(*names, dest=field.name, **words)
        for name, value in also.items():
            add(name, dest=field.name, action="store_const", const=value, help=f"{names[0]} {value}")


class Once(argparse.Action):
    """Store a value; an option that is given again is refused, as its first value would be lost."""

    def __call__(self, parser, namespace, values, option_string=None):
        given = vars(namespace).setdefault("given", set())
        if self.dest in given:
            parser.error(f"{option_string}: must be given once, got {getattr(namespace, self.dest)} and {values}")
        given.add(self.dest)
        setattr(namespace, self.dest, values)


class Describe(argparse.Action):
    """--describe: print the options of a command as JSON and end; for programs that call it."""

    def __init__(self, option_strings, dest, **words):
        super().__init__(option_strings, argparse.SUPPRESS, 0, help=argparse.SUPPRESS, **words)

    def __call__(self, parser, *_):
        about = {"command": parser.prog.split()[-1], "about": parser.description, "options": described(parser)}
        parser._print_message(json.dumps(about, indent=1, default=str) + "\n", sys.stdout)     # as --help and --version
        parser.exit()


def described(parser: argparse.ArgumentParser) -> Dict[str, Dict[str, Any]]:
    """{name of the field: what there is to know of the option} of a parser; option: "" of a word without one."""
    options: Dict[str, Dict[str, Any]] = {}
    for action in parser._actions:     # pylint: disable=protected-access
        if action.dest in options or action.help == argparse.SUPPRESS or isinstance(action, argparse._HelpAction):
            continue
        kind = "switch" if action.nargs == 0 else "choice" if action.choices else KINDS.get(action.type, "text")
        default = None if action.default is False or action.default == [] else action.default
        options[action.dest] = {
            "option": next((name for name in action.option_strings if name.startswith("--")),
                           "".join(action.option_strings)),
            "kind": kind, "default": default, "needed": action.required, "choices": list(action.choices or ()),
            "several": action.nargs not in (None, 0, "?") or isinstance(action, argparse._AppendAction),
            "metavar": action.metavar, "help": action.help and action.help.replace("%%", "%")}
    return options


def reader(hint: Any) -> Tuple[bool, Optional[Callable[[str], Any]]]:
    """Whether a value may be None, and how a word of it, or of a list of them, is read."""
    optional = get_origin(hint) is Union
    hint = get_args(hint)[0] if optional else hint
    while get_origin(hint) is list:
        hint = get_args(hint)[0]
    return optional, READ.get(hint)


def request(kind: Type[R], namespace: argparse.Namespace) -> R:
    """The request of what a parser found."""
    names = {field.name for field in dataclasses.fields(kind)}
    return kind(**{name: list(value) if isinstance(value, list) else value
                   for name, value in vars(namespace).items() if name in names})


def words_of(asked: Any) -> List[str]:
    """The words of a command line that give a request: what is as it is by default is left out."""
    words: List[str] = []
    for field in dataclasses.fields(asked):
        value, metadata = getattr(asked, field.name), field.metadata
        if not metadata or value == metadata["words"]["default"]:
            continue
        name = next(iter(metadata["names"]), f"--{field.name.replace('_', '-')}")
        if metadata["words"].get("action") == "store_true":
            words.append(name)
        elif metadata["words"].get("action") == "append":
            words += [word for one in value for word in (name, worded(one))]
        elif isinstance(value, list) and "nargs" in metadata["words"]:
            words += [name, *map(worded, value)]
        else:
            text = ",".join(map(worded, value)) if isinstance(value, list) else worded(value)
            if name == "":
                words.insert(0, text)
            else:
                words += [f"{name}={text}"] if text.startswith("-") else [name, text]
    return words


def worded(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def bare(asked: Any) -> bool:
    """Whether a command was given without any word, where none must be."""
    return asked == type(asked)()


def parse_number(text):
    """argparse type: a finite number."""
    if not heads.is_number(text):
        raise argparse.ArgumentTypeError(f"must be a finite number, got {text!r}")
    return float(text)


def parse_whole_number(text):
    """argparse type: a whole number, of either sign."""
    if not re.fullmatch(r"[-+]?0*[0-9]{1,18}", text):
        raise argparse.ArgumentTypeError(f"must be a whole number of at most 18 digits, got {text!r}")
    return int(text)


def count(text):
    """argparse type: a whole number from 1 to MOST."""
    if not re.fullmatch(r"0*[1-9][0-9]*", text):
        raise argparse.ArgumentTypeError(f"must be a whole number >= 1, got {text!r}")
    if len(text.lstrip("0")) > len(str(MOST)) or int(text) > MOST:
        raise argparse.ArgumentTypeError(f"must be a whole number <= {MOST}, got {text!r}")
    return int(text)


READ: Dict[Any, Callable[[str], Any]] = {float: parse_number, int: count, Path: Path}       # the others as they are
KINDS: Dict[Any, str] = {parse_number: "number", parse_whole_number: "whole", count: "count",
                         Path: "path"}     # of the others: text


@dataclass(frozen=True, kw_only=True)
class Overwrite:
    """For disk.check_standing()."""
    overwrite: bool = flag("replace files of the same names that are not the result of the same input (default: "
                           "refuse)")


@dataclass(frozen=True, kw_only=True)
class Program:
    """For programs.find_lmp()."""
    lmp: Optional[str] = option("the LAMMPS program (default: LMP of the environment, then build/lmp beside tools/)",
                                metavar="FILE")
