"""Records of networks whose heads say all that is needed: a table of their formats, and one reader of all."""
import re
from typing import List, NamedTuple, Optional, Sequence

import numpy as np

from .. import heads
from ..errors import SlopeError
from .components import SLOWEST, Component, NoAcceleration, check_count, direction_of, numbers_of, values_of

TIME = "time"               # a column that is none of a direction
FLAGS = re.MULTILINE | re.IGNORECASE
LAST = r"^([^\n]*)\Z"       # the last line of a head


class Line(NamedTuple):
    """A line of a head: what it is like, for messages, and the expression whose groups are its values."""
    like: str
    pattern: str


class Form(NamedTuple):
    """Where a format has what. A file is one block, or one for each component, which begins as the file does.

    A head ends before the first line of nothing but numbers, or `more` lines later.
    """
    networks: str
    first: str                  # how the first line begins
    step: Line                  # s, or a rate in the group hz
    unit: Line                  # and a factor, in the group factor
    columns: Line               # one direction: values run on; several: a line has a value of each
    points: Optional[Line] = None
    place: Sequence[str] = ()   # of earthquake and station
    begin: str = ""
    what: str = ""              # says ACCELERATION, unless it is something else
    more: int = 0
    series: int = 1             # at most: acceleration, then velocity and displacement


FORMS = (
    Form("ESM, ITACA and AFAD (DYNA)", "EVENT_NAME:",
         step=Line("SAMPLING_INTERVAL_S: 0.005", r"^SAMPLING_INTERVAL_S: *(\S+)"),
         unit=Line("UNITS: cm/s^2", r"^UNITS: *(\S+)"),
         columns=Line("STREAM: HNE", r"^STREAM: *(?:\w\w(?=[A-Z]$))?(\S+)"),
         points=Line("NDATA: 19128", r"^NDATA: *(\d+)"),
         place=(r"^EVENT_ID:(.*)", r"^NETWORK:(.*)", r"^STATION_CODE:(.*)"),
         begin=r"^DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS:(.*)", what=r"^DATA_TYPE:(.*)"),
    Form("AFAD (older)", "STRONG GROUND MOTION RECORDS OF TURKIYE",
         step=Line("SAMPLING INTERVAL (sec) : 0.01", r"^SAMPLING INTERVAL \(sec\) *: *(\S+)"),
         unit=Line("RAW PGA VALUES (gal)", r"^RAW PGA VALUES \(([^)]*)\)"), columns=Line("N-S E-W U-D", LAST),
         points=Line("NUMBER OF DATA : 37671", r"^NUMBER OF DATA *: *(\d+)"),
         place=(r"^EARTHQUAKE DATE *:(.*)", r"^STATION ID *:(.*)"), begin=r"^RECORD TIME *:(.*)"),
    Form("CWA", "#Earthquake Information",
         step=Line("#SampleRate(Hz): 100", r"^#SampleRate\(Hz\): *(?P<hz>\S+)"),
         unit=Line("#AmplitudeUnit: gal", r"^#AmplitudeUnit: *(\S+)"),
         columns=Line("#DataSequence: Time U(+); N(+); E(+)", r"^#DataSequence:(.*)"),
         place=(r"^#Origin Time[^:]*:(.*)", r"^#StationCode:(.*)"), begin=r"^#StartTime[^:]*:(.*)"),
    Form("JMA", "SITE CODE",
         step=Line("SAMPLING RATE= 100Hz", r"^ *SAMPLING (?:RATE|FREQ) *= *(?P<hz>[\d.]+) *Hz"),
         unit=Line("UNIT = gal(cm/s/s)", r"^ *UNIT *= *([^\s(,]+)"), columns=Line("NS,EW,UD", LAST),
         place=(r"^ *SITE CODE *=([^,]*)",), begin=r"^ *INITIAL TIME *=([^,\n]*)"),
    Form("GeoNet (V1A, V2A)", r"(?:Unc|C)orrected accelerogram .*GNS Science",
         step=Line("at intervals of 0.005 s", r"^(?:Raw readings .*at intervals of|Instrument corrected data at) +"
                   r"(\S+) s"),
         unit=Line("Raw readings in units of 1.00 mm/s/s", r"^(?:Raw readings in units of +(?P<factor>\S+)|"
                   r"Acceleration: +peak +\S+) +(?P<unit>\S+)"),
         columns=Line("Component N28W", r"^Component +(\S+)"),
         points=Line("Number of points 8192", r"^Number of points +(\d+)"),
         place=(r"^Accelerogram +(\S+)", r"^Site +(\S+)"), begin=r"^(\d{4} .*) UT *$", more=10, series=3),
)


def form_of(lines: Sequence[str]) -> Optional[Form]:
    """The format of a file, by its first line."""
    return next((form for form in FORMS if starts(form, lines[0])), None)


def starts(form: Form, line: str) -> bool:
    return re.match(form.first, line.strip(), re.IGNORECASE) is not None


def read_network_record(path, lines: Sequence[str], form: Form) -> List[Component]:
    """The components of a file of one of the formats; SlopeError with file, line, rule, value."""
    begins = [k for k, line in enumerate(lines) if starts(form, line)]
    blocks = zip(begins, [*begins[1:], len(lines)])
    return [component for begin, end in blocks for component in block(path, lines[:end], begin, form)]


def block(path, lines: Sequence[str], begin: int, form: Form) -> List[Component]:
    """Those of one block, from a line on."""
    first = next((k for k in range(begin, len(lines)) if numbers_of(lines[k].replace(",", " "))), len(lines))
    head = "\n".join(line.rstrip() for line in lines[begin:first]).rstrip()
    place = path if begin == 0 else f"{path}, line {begin + 1}"

    def part(line: Line) -> "re.Match[str]":
        found = re.search(line.pattern, head, FLAGS)
        if not found:
            raise SlopeError(place, f"the head must have a line with {line.like}, as records of {form.networks}",
                             "none")
        return found

    def said(pattern: str) -> str:
        found = re.search(pattern, head, FLAGS) if pattern else None
        return " ".join(found[1].split()) if found else ""

    unit, step, what = part(form.unit), part(form.step), said(form.what)
    plain, named = unit[unit.lastgroup or 1], unit.groupdict()
    factor = (heads.acceleration(plain) or 0.0) * heads.parse_cell(named.get("factor") or "1")
    if not factor > 0 or what.upper() not in ("", "ACCELERATION"):
        raise NoAcceleration(place, "must be of an acceleration", ", ".join(filter(None, (plain, what))))
    dt = heads.parse_cell(step[1])
    dt = 1 / dt if "hz" in step.groupdict() and dt else dt
    if not 0 < dt <= SLOWEST:
        raise SlopeError(place, f"the time step must be > 0 and <= {SLOWEST:g} s, as of {form.step.like}",
                         step[0].strip())
    columns = parse_component_columns(place, part(form.columns)[1])
    rows = values_of(path, [line.replace(",", " ") for line in lines], first + form.more,
                     len(columns) if len(columns) > 1 else 0).reshape(-1, len(columns))
    if form.points:
        count = int(part(form.points)[1])
        check_count(place, rows[:, 0], form.series * count if len(rows) > count and form.series > 1 else count)
        rows = rows[:count]
    if len(rows) < 2:
        raise SlopeError(place, "must hold at least two values of each component", len(rows))
    of = " at ".join(filter(None, map(said, form.place)))
    numbers = []
    for column, values in zip(columns, rows.T):
        if column is None:
            check_times(path, values, dt)
        else:
            numbers.append(Component(str(path), column[0], dt, column[1] * factor * values, said(form.begin), True,
                                     of=of))
    return numbers


def parse_component_columns(place, text: str):
    """Direction and sign of each column; None of one of times."""
    columns: List[Optional[tuple]] = []
    for name, sign in re.findall(r"([\w-]+)(?:\(([+-])\))?", text):
        direction = direction_of(name)
        if direction is None and name.lower() != TIME:
            raise SlopeError(place, "the head must name the directions of the components, N, E or up, an azimuth, or "
                             "a bearing such as N28W", repr(name))
        columns.append(direction and (direction[0], -direction[1] if sign == "-" else direction[1]))
    if not any(columns):
        raise SlopeError(place, "the head must name the directions of the components", repr(text))
    return columns


def check_times(path, times: np.ndarray, dt: float) -> None:
    """Raise SlopeError if a column of times has other steps than the head."""
    off = np.abs(times - times[0] - dt * np.arange(len(times)))
    if not off.max() < 0.5 * dt:
        raise SlopeError(path, f"times must be evenly spaced, by the {dt:g} s of the head",
                         f"{times[int(off.argmax())]:g} s")
