"""The keys of a section of site.yaml, or of route.yaml, each declared once: a field of a frozen dataclass with default,
meaning and range, of which the JSON schema is made. What the section is for is the docstring of the class."""
import typing
from dataclasses import MISSING, field, fields
from types import NoneType
from typing import Any, Dict, Mapping, Union

from .. import disk

TYPES = {str: "string", float: "number", int: "integer", NoneType: "null"}
LIMITS = {"above": "exclusiveMinimum", "least": "minimum", "below": "exclusiveMaximum", "most": "maximum",
          "like": "pattern", "shortest": "minLength"}
OF_LISTS = {"fewest": "minItems", "most_items": "maxItems", "different": "uniqueItems"}
NEEDED = MISSING        # instead of a default: the key must be given


def key(default: Any, says: str = "", **rule: Any) -> Any:
    """A key; says: what it means; rule: LIMITS of a value, or of those in a list, OF_LISTS, or `of`: the choices."""
    given: Dict[str, Any] = {"default": default}
    if isinstance(default, (dict, list)):
        given = {"default_factory": default.copy}
    return field(**given, metadata={"default": default, "says": says, "rule": rule})


def section_schema(section: Any) -> Dict[str, Any]:
    """The JSON schema of a section. Keys stand in the order of their class; those that it has of another one, and does
    not declare anew, come first."""
    hints, own = typing.get_type_hints(section), list(vars(section)["__annotations__"])
    properties: Dict[str, Any] = {}
    for part in sorted(fields(section), key=lambda part: own.index(part.name) if part.name in own else -1):
        entry = value_schema(hints[part.name], part.metadata["rule"])
        if part.metadata["default"] is not NEEDED:
            entry["default"] = disk.make_plain(part.metadata["default"])
        if part.metadata["says"]:
            entry["description"] = part.metadata["says"]
        properties[part.name.rstrip("_")] = entry
    return {"type": "object", "additionalProperties": False, "description": section.__doc__,
            "required": [name for name, entry in properties.items() if "default" not in entry],
            "properties": properties}


def value_schema(hint: Any, rule: Mapping[str, Any]) -> Dict[str, Any]:
    """Of the values of a type."""
    if "of" in rule:
        return {"enum": list(rule["of"])}
    several = typing.get_args(hint) if typing.get_origin(hint) is Union else (hint,)
    limits = {name: rule[mine] for mine, name in LIMITS.items() if mine in rule}
    types, schema = [], {name: rule[mine] for mine, name in OF_LISTS.items() if mine in rule}
    for one in several:
        inner = typing.get_args(one)
        types.append(TYPES.get(one) or ("array" if typing.get_origin(one) in (tuple, list) else "object"))
        if types[-1] == "array":
            schema["items"] = {"type": TYPES[inner[0]], **limits}
        elif types[-1] == "object":
            schema["additionalProperties"] = {"type": TYPES[inner[1]]}
    own = {} if "array" in types else limits
    return {"type": types if len(types) > 1 else types[0], **schema, **own}
