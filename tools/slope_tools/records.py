"""Frozen dataclasses and named tuples to and from the plain values of a file: what a type says, in one place."""
import dataclasses
import functools
import typing
from types import NoneType
from typing import Any, Dict, Mapping, Tuple, Type, TypeVar, Union

from .findings import Finding, finding

T = TypeVar("T")


def plain(value: Any) -> Any:
    """What YAML and JSON have of a value: records as mappings, in the order of their fields."""
    if isinstance(value, Finding):
        return value.entry()
    if dataclasses.is_dataclass(value):
        return {one.name: plain(getattr(value, one.name)) for one in dataclasses.fields(value)}
    if hasattr(value, "_asdict"):
        return {name: plain(one) for name, one in value._asdict().items()}
    if isinstance(value, Mapping):
        return {name: plain(one) for name, one in value.items()}
    return [plain(one) for one in value] if isinstance(value, (list, tuple)) else value


def read(kind: Type[T], value: Any) -> T:
    """A value of a type from what plain() made of it; KeyError, TypeError or ValueError if it is none. Further keys of
    a mapping do not count; a field that is missing has its default."""
    return typing.cast(T, _read(kind, value))


def _read(kind: Any, value: Any) -> Any:
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin is Union:
        [inner] = [one for one in parts if one is not NoneType]       # Optional: the only one that there is
        return None if value is None else _read(inner, value)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {name: _read(parts[1], one) for name, one in value.items()}
    if isinstance(origin, type):
        of = parts[0] if parts else Any
        return tuple(_read(of, one) for one in value) if origin is tuple else [_read(of, one) for one in value]
    if kind is Finding:
        return finding(value)
    if types := _fields(kind):
        return kind(**{name: _read(of, value[name]) for name, of in types.items() if name in value})
    if kind is Any or isinstance(value, kind) or kind is float and isinstance(value, int):
        return value
    raise TypeError(f"must be of type {kind.__name__}, got {value!r}")


@functools.lru_cache(maxsize=None)
def _fields(kind: Any) -> Dict[str, Any]:
    """{field: its type} of a record; none of another type."""
    names: Tuple[str, ...] = tuple(one.name for one in dataclasses.fields(kind)) if dataclasses.is_dataclass(kind) \
        else getattr(kind, "_fields", ())
    types = typing.get_type_hints(kind) if names else {}
    return {name: types[name] for name in names}
