"""Numbers from elsewhere that stand beside those of a study: published ones, or what was measured at the site."""
from typing import Dict, List, NamedTuple, Optional, Tuple

from .. import disk
from ..errors import SlopeError

WHAT = "a file of reference values (see the page on `slope report`)"
NAME = 80       # letters of a name


class Quantity(NamedTuple):
    """What is known of one column of the study's table."""
    variable: Optional[str]                             # what the series are against
    series: Dict[str, List[Tuple[float, float]]]        # name: (value of the variable, quantity), ascending
    levels: Dict[str, float]                            # name: quantity, whatever the variable


class Reference(NamedTuple):
    """A file of reference values."""
    title: str
    remark: str
    quantities: Dict[str, Quantity]


def read(path, available):
    """The Reference in a file; available: {column: what it is} of the study, with numbers in all runs.

    SlopeError names file, entry and rule; among others where the file has no quantities, or one that the study lacks.
    """
    about = disk.load_yaml(path, WHAT)
    if not (isinstance(about.get("title"), str) and about["title"].strip()):
        raise SlopeError(path, "must have a title, a line that says whose numbers these are", repr(about.get("title")))
    remark = about.get("remark", "")
    if not isinstance(remark, str):
        raise SlopeError(f"{path}: remark", "must be text", repr(remark)[:NAME])
    unknown = about.keys() - {"title", "remark", "quantities"}
    if unknown:
        raise SlopeError(path, "must have title, remark and quantities, nothing else",
                         ", ".join(sorted(map(str, unknown))))
    entries = about.get("quantities")
    if not (isinstance(entries, dict) and entries):
        raise SlopeError(path, "must have quantities, such as quantities: {remove_m3: {levels: {measured: 1200}}}",
                         repr(entries)[:NAME])
    found = {}
    for name, entry in entries.items():
        if name not in available:
            raise SlopeError(f"{path}: quantities", "must be columns that all runs have, " + ", ".join(available),
                             name)
        found[name] = quantity(f"{path}: quantities: {name}", entry)
    return Reference(" ".join(about["title"].split()), " ".join(remark.split()), found)


def quantity(where, entry):
    """One entry of a file."""
    if not isinstance(entry, dict) or not entry.keys() & {"series", "levels"} \
            or entry.keys() - {"variable", "series", "levels"}:
        raise SlopeError(where, "must have levels: {NAME: VALUE}, or variable and series: {NAME: {X: VALUE}}, or both",
                         repr(entry)[:NAME])
    levels, series = entry.get("levels") or {}, entry.get("series") or {}
    if not (isinstance(levels, dict) and all(disk.is_number(value) for value in levels.values())):
        raise SlopeError(f"{where}: levels", "must be NAME: finite number", repr(levels)[:NAME])
    if not isinstance(series, dict):
        raise SlopeError(f"{where}: series", "must be NAME: {X: VALUE}", repr(series)[:NAME])
    variable = entry.get("variable")
    if series and not isinstance(variable, str):
        raise SlopeError(where, "must name the variable of its series", repr(variable))
    lines = {}
    for name, points in series.items():
        if not (isinstance(points, dict) and points
                and all(disk.is_number(x) and disk.is_number(y) for x, y in points.items())):
            raise SlopeError(f"{where}: series: {name}", "must be X: VALUE, finite numbers", repr(points)[:NAME])
        lines[str(name)[:NAME]] = sorted((float(x), float(y)) for x, y in points.items())
    return Quantity(variable, lines, {str(name)[:NAME]: float(value) for name, value in levels.items()})
