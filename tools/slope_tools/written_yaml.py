"""YAML without what it reads in another way than it is written: one loader, as fast as libyaml's, for all files.

YAML 1.1 takes 010 for 8 and 1:30 for 90, makes an object of a date, and of a key that is given twice the second counts.
yaml.safe_dump writes none of these.
"""
import re
from typing import Any, Dict

import yaml

INT, FLOAT, TIMESTAMP, MERGE = (f"tag:yaml.org,2002:{name}" for name in ("int", "float", "timestamp", "merge"))
DECIMAL = re.compile(r"[-+]?(0|[1-9][0-9]*)")
C_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


class Misleading(ValueError):
    """What a text holds that its writer may have meant otherwise."""

    def __init__(self, node, rule: str, got: str):
        super().__init__(rule)
        self.line, self.rule, self.got = node.start_mark.line + 1, rule, got


class _Checked(yaml.constructor.SafeConstructor):
    """A constructor with the checks."""

    def construct_mapping(self, node, deep=False):
        keys = [key for key, _ in node.value if key.tag != MERGE]
        whole = len(keys) == len(node.value)
        found = super().construct_mapping(node, deep)
        if not (whole and len(found) == len(keys)):
            self._check_twice(keys)
        return found

    def _check_twice(self, keys) -> None:
        lines: Dict[Any, int] = {}
        for key in keys:
            value = self.construct_object(key, deep=True)
            if value in lines:
                raise Misleading(key, f"must have each key once, {key.value} is in line {lines[value]}, too", key.value)
            lines[value] = key.start_mark.line + 1

    def construct_whole(self, node):
        found = self.construct_yaml_int(node)
        if not DECIMAL.fullmatch(node.value):
            raise not_decimal(node, found)
        return found

    def construct_real(self, node):
        found = self.construct_yaml_float(node)
        if ":" in node.value or "_" in node.value:
            raise not_decimal(node, found)
        return found

    def construct_date(self, node):
        raise Misleading(node, "must be a number, or a text in quotes, of which YAML makes no date", node.value)


def not_decimal(node, match) -> Misleading:
    return Misleading(node, f"must be a decimal number, or a text in quotes (YAML takes it for {match:.12g})",
                      node.value)


def _loader(base):
    made: Any = type("Loader", (_Checked, base), {})
    for tag, function in ((INT, _Checked.construct_whole), (FLOAT, _Checked.construct_real),
                          (TIMESTAMP, _Checked.construct_date)):
        made.add_constructor(tag, function)
    return made


FAST, DEEP = _loader(C_LOADER), _loader(yaml.SafeLoader)


def load_yaml(text: str) -> Any:
    """What a text of YAML holds; Misleading, or an error of yaml's.

    libyaml's recursion has no limit and would end the program: a text that may be nested thousands of levels deep is
    left to Python's loader, which raises RecursionError.
    """
    deep = text.count("[") + text.count("{") > 5000 or max(map(len, text.splitlines()), default=0) > 10000
    return yaml.load(text, Loader=DEEP if deep else FAST)
