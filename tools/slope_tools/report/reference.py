"""Numbers from elsewhere that stand beside those of a study: published ones, or what was measured at the site."""
from typing import Dict, List, NamedTuple, Optional, Tuple

from .. import schemas
from ..errors import SlopeError
from ..schemas import NUMBER, TEXT, mapping, dict_of
from ..tables import quantities
from .data import Data
from .numbers import Numbers
from .sections import Cell, Section, Table, Text

WHAT = "a file of reference values (see the page on `slope report`)"
NAME = 80       # letters of a name
LEVELS = dict_of(NUMBER)                                                          # {name: value}
SERIES = dict_of({**dict_of(NUMBER, 1), "propertyNames": NUMBER})                   # {name: {x: value}}
QUANTITY = {**mapping({}, variable=TEXT, levels=LEVELS, series=SERIES), "additionalProperties": False,
            "anyOf": [{"required": ["levels"]}, {"required": ["variable", "series"]}],
            "description": "levels: {NAME: VALUE}, or variable and series: {NAME: {X: VALUE}}, or both"}
SCHEMA = {**mapping({"title": {**TEXT, "minLength": 1}, "quantities": dict_of(QUANTITY, 1)}, remark=TEXT),
          "additionalProperties": False}


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


def read_reference(path, available):
    """The Reference in a file; available: columns of the study with numbers in all runs.

    SlopeError names file, entry and rule; among others where the file has no quantities, or one that the study lacks.
    """
    content = schemas.load_checked(path, WHAT, SCHEMA)
    unknown = content["quantities"].keys() - set(available)
    if unknown:
        raise SlopeError(f"{path}: quantities", "must be columns that all runs have, " + ", ".join(available),
                         ", ".join(sorted(map(str, unknown))))
    return Reference(" ".join(content["title"].split()), " ".join(content.get("remark", "").split()),
                     {name: quantity(entry) for name, entry in content["quantities"].items()})


def quantity(entry):
    """The Quantity of an entry of a file."""
    return Quantity(entry.get("variable"),
                    {str(name)[:NAME]: sorted((float(x), float(y)) for x, y in points.items())
                     for name, points in entry.get("series", {}).items()},
                    {str(name)[:NAME]: float(value) for name, value in entry.get("levels", {}).items()})


def make_reference_section(reference, data: Data, numbers: Numbers):
    """A table for each quantity, with the range of the runs' own beside it; None without a reference."""
    if reference is None:
        return None
    return Section("reference", "Numbers from elsewhere", [
        Text(f"{reference.title}.{' ' * bool(reference.remark)}{reference.remark}", "soft"),
        *(tabulate_reference(key, one, data, numbers) for key, one in reference.quantities.items())])


def tabulate_reference(key, quantity_, data: Data, numbers: Numbers):
    """Of a Quantity: its series and levels."""
    what, unit = quantities.ALL[key].name, quantities.ALL[key].unit
    xs = sorted({x for points in quantity_.series.values() for x, _ in points})
    rows = [[name, *(f"{dict(points)[x]:,.6g}" if x in dict(points) else "-" for x in xs)]
            for name, points in quantity_.series.items()]
    rows += [[name, Cell(f"{value:,.6g}", span=len(xs) or 1)] for name, value in quantity_.levels.items()]
    low, high = (numbers(what, unit, pick(row.value(key) for row in data.compared)) for pick in (min, max))
    return Table(f"{what} ({unit}){f' against {quantity_.variable}' if quantity_.variable else ''}; of "
                 f"{'these runs' if data.study else 'this run'}: {low if low == high else f'{low} to {high}'}",
                 [quantity_.variable, *(f"{x:g}" for x in xs)] if xs else [], rows, style="keep")
