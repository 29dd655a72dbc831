"""The command of a study once more, with other options: what a reader types next."""
from dataclasses import replace
from shlex import join
from typing import Any, Dict, List, Mapping, Sequence

from .. import options
from ..case.settings import middle, parse_setting_values


def command(asked: Any, **changes: Any) -> str:
    """asked: the request of a study, which keeps its own name as `command`; changes: fields of it."""
    words = options.words_of(replace(asked, **{"dry_run": False, "anew": False, **changes}))
    return join(["tools/slope", asked.command or "study", *words])


def with_value(asked: Any, name: str, value: str) -> Dict[str, Any]:
    """Changes: a variable has this value alone."""
    fields = {option: without(getattr(asked, option), {name: ""}) for option in ("set", "vary", "repeat")}
    return {**fields, "set": [*fields["set"], f"{name}={value}"]}


def as_ensemble(asked: Any, ranges: Mapping[str, str], **changes: Any) -> Dict[str, Any]:
    """Changes: an ensemble over ranges, in a folder beside; other variables have the value in their middle."""
    several = {words.partition("=")[0]: parse_setting_values(words, words.partition("=")[2]) for words
               in without(asked.set, ranges)}
    beside = asked.output and asked.output.with_name(f"{asked.output.name}_ensemble")
    return {"set": [f"{name}={middle(one)}" for name, one in several.items()], "repeat": without(asked.repeat, ranges),
            "vary": [f"{name}={text}" for name, text in ranges.items()], "output": beside, "intensity": None,
            "more_than": None, **changes}


def without(words: Sequence[str], names: Mapping[str, str]) -> List[str]:
    """Those of the words NAME=... that name another variable."""
    return [one for one in words if one.partition("=")[0] not in names]
