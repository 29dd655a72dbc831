"""Sets of known events: what fell, how deep and how far.

rock_avalanches.csv: 49 rock avalanches of Canada, published with A. Mitchell, S. McDougall, N. Nolde, M.-A. Brideau,
J. Whittall and J. Aaron, Rock avalanche runout prediction using stochastic analysis of a regional dataset, Landslides
17 (2020), 777-792, and its program PRE-RA. Its bias: avalanches that were mapped, none below 0.1 million m3.
"""
import csv
import math
from pathlib import Path
from typing import List, NamedTuple, Sequence

from ..errors import SlopeError

OWN = Path(__file__).parent / "rock_avalanches.csv"
CONFINEMENTS = ("frontal", "lateral", "unconfined")
COLUMNS = ("fall_m", "length_m", "volume_Mm3")


class Event(NamedTuple):
    """fall: crown to toe, vertical (m); length: crown to toe along the path in plan (m); volume: million m3."""
    name: str
    fall: float
    length: float
    volume: float
    confined: bool      # laterally


def read_events(path: Path = OWN) -> List[Event]:
    """The events of a CSV file with columns name, fall_m, length_m, volume_Mm3 and confinement; others are ignored.

    Raises SlopeError, which names the line, on a missing column, a number that is not finite and above 0, a word that
    is none of CONFINEMENTS, a name that comes twice, and an event that is shorter than its fall, or 50 times as long:
    its units are mixed up (ours are 1.6 to 8.3 times as long).
    """
    try:
        with open(path, encoding="utf-8-sig", newline="") as lines:
            reader = csv.DictReader(lines)
            missing = [name for name in ("name", *COLUMNS, "confinement") if name not in (reader.fieldnames or ())]
            if missing:
                raise SlopeError(path, "must have the columns name, fall_m, length_m, volume_Mm3 and confinement",
                                 "none named " + ", ".join(missing))
            names = [name for name in reader.fieldnames or () if name]
            if len(set(names)) < len(names):
                raise SlopeError(path, "must have each column once", ",".join(names)[:60])
            events: List[Event] = []
            for row in reader:
                if None in row:
                    raise SlopeError(f"{path}: line {reader.line_num}", f"must have {len(names)} cells (a decimal "
                                     "comma?)", len(names) + len(row[None]))
                events.append(event(row, f"{path}: line {reader.line_num}", {one.name for one in events}))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SlopeError(path, f"cannot be read as a set of events: {error}") from None
    return events


def select_events(path: Path, left_out: Sequence[str]) -> List[Event]:
    """The events of a set without those left out (names), all of which it must have."""
    every = read_events(path)
    names = {one.name for one in every}
    for name in left_out:
        if name not in names:
            raise SlopeError("--except", f"must be an event of {path}, such as {', '.join(sorted(names)[:3])}", name)
    return [one for one in every if one.name not in left_out]


def event(row, where, names) -> Event:
    """One row; names: of the events before it."""
    if not row["name"] or row["name"] in names:
        raise SlopeError(where, "name must be given, and once only", repr(row["name"]))
    fall, length, volume = (positive(row[name], f"{where}: {name}") for name in COLUMNS)
    if row["confinement"] not in CONFINEMENTS:
        raise SlopeError(where, "confinement must be one of " + ", ".join(CONFINEMENTS), repr(row["confinement"]))
    if not 1 <= length / fall <= 50:
        raise SlopeError(where, "length_m must be 1 to 50 times fall_m; check that both are in metres",
                         f"{length:g} and {fall:g}")
    return Event(row["name"], fall, length, volume, row["confinement"] == "lateral")


def positive(text, where) -> float:
    try:
        value = float(text) if "_" not in text else math.nan     # Python takes 1_5 for 15
    except (TypeError, ValueError):
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise SlopeError(where, "must be a number above 0", repr(text))
    return value
