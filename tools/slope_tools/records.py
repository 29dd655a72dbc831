"""Records (frozen dataclasses, named tuples) to and from plain values of files: a type is its schema."""
import dataclasses
import functools
import typing
from enum import Enum
from types import NoneType
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Type, TypeVar, Union

from . import disk
from .findings import Finding, finding
from .schemas import TYPES, nth

T = TypeVar("T")
SIMPLE = {str, float, int, bool, NoneType}
WORDS = {str: "string", float: "number", int: "integer", bool: "boolean", Mapping: "object", list: "array"}


class NoRecord(ValueError):
    """A value that is none of its type: where in it, and the rule."""


class Fields(NamedTuple):
    """Of a record: types of its fields, and those without a default."""
    types: Dict[str, Any]
    needed: List[str]


def encode_record(value: Any) -> Any:
    """What YAML and JSON have of a value: records as mappings, in the order of their fields, without those of
    a dataclass that are None where that is the default."""
    if type(value) in SIMPLE:       # most are
        return value
    if isinstance(value, Finding):
        return value.entry()
    if isinstance(value, Enum):
        return value.value
    if dataclasses.is_dataclass(value):
        parts = ((getattr(value, one.name), one) for one in dataclasses.fields(value))
        return {one.name: encode_record(part) for part, one in parts if part is not None or one.default is not None}
    if hasattr(value, "_asdict"):
        return {name: encode_record(one) for name, one in value._asdict().items()}
    if isinstance(value, Mapping):
        return {name: encode_record(one) for name, one in value.items()}
    return [encode_record(one) for one in value] if isinstance(value, (list, tuple)) else disk.make_plain(value)


def read_record(kind: Type[T], value: Any) -> T:
    """A value of a type from what encode_record() made of it; NoRecord if it is none. Further keys do not count; a
    field that is missing has its default."""
    return typing.cast(T, _read(kind, value))


def _read(kind: Any, value: Any) -> Any:
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin is Union:
        if value is None and NoneType in parts:
            return None
        several = [one for one in parts if one is not NoneType]
        return _read(next((one for one in reversed(several) if _knows(one, value)), several[0]), value)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        check_record_value(value, Mapping)
        return {name: _inside(name, parts[1], one) for name, one in value.items()}
    if isinstance(origin, type):
        check_record_value(value, list)
        found = [_inside(nth(k), parts[0], one) for k, one in enumerate(value)]
        return tuple(found) if origin is tuple else found
    if kind is Finding:
        check_record_value(value, Mapping)
        return finding(value)
    if of := _fields(kind):
        check_record_value(value, Mapping)
        if lacks := [name for name in of.needed if name not in value]:
            raise NoRecord(f"must have {' and '.join(lacks)}")
        parts_ = {name: _inside(name, one, value[name]) for name, one in of.types.items() if name in value}
        return kind(**parts_)
    if isinstance(kind, type) and issubclass(kind, Enum):
        if value not in (several := [one.value for one in kind]):
            raise NoRecord(f"must be one of {', '.join(several)}, got {repr(value)[:60]}")
        return kind(value)
    if kind is not Any:
        check_record_value(value, kind)
    return value


def _inside(place: str, kind: Any, value: Any) -> Any:
    """The same of a part of a value."""
    try:
        return _read(kind, value)
    except NoRecord as error:
        raise NoRecord(f"{place}: {error}") from None


def _knows(kind: Any, value: Any) -> bool:
    """Whether all keys of a value are of a record: of several the last such one is meant, the others have more."""
    of = _fields(kind)
    return of is not None and isinstance(value, Mapping) and value.keys() <= of.types.keys()


def check_record_value(value: Any, kind: Any) -> None:
    """Raise NoRecord unless a value is what YAML and JSON have for a type."""
    if kind is float:
        right = disk.is_finite_number(value)
    elif kind is list:
        right = isinstance(value, (list, tuple))
    else:
        right = isinstance(value, kind) and (kind is not int or not isinstance(value, bool))
    if not right:
        raise NoRecord(f"must be {TYPES[WORDS[kind]]}, got {repr(value)[:60]}")


@functools.lru_cache(maxsize=None)
def _fields(kind: Any) -> Optional[Fields]:
    """None of a type that is no record."""
    if dataclasses.is_dataclass(kind):
        defaults = {one.name: one.default for one in dataclasses.fields(kind)}
        needed = [name for name, default in defaults.items() if default is dataclasses.MISSING]
    elif hasattr(kind, "_field_defaults"):
        needed = [name for name in kind._fields if name not in kind._field_defaults]
    else:
        return None
    return Fields(typing.get_type_hints(kind), needed)
