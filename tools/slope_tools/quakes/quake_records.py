"""Strong-motion records: K-NET and KiK-net ASCII, PEER AT2, CSV, each as components in m/s2."""
import math
import re
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any, Optional

import numpy as np

from .. import heads
from ..errors import SlopeError

GAL, G = 0.01, 9.80665      # m/s2
UNITS = {"gal": GAL, "cm/s2": GAL, "cm/s/s": GAL, "g": G, "m/s2": 1.0, "m/s/s": 1.0}
UP = "up"
MOST = 50.0                 # m/s2; no ground has moved with more
SLOWEST = 1.0               # s, time step; records have 0.02 s or less
EVEN = 1e-3                 # of a time step, that steps of a CSV may differ, beside the rounding of its times
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")
KIK_NET = {"1": 0.0, "2": 90.0, "3": UP, "4": 0.0, "5": 90.0, "6": UP}    # 1 to 3: in the borehole
KNET = {"N-S": 0.0, "E-W": 90.0, "U-D": UP, **KIK_NET}
SENSORS = {**dict.fromkeys("123", "in the borehole"), **dict.fromkeys("456", "at the surface")}
COLUMNS = {"ew": 90.0, "e-w": 90.0, "e": 90.0, "east": 90.0, "ns": 0.0, "n-s": 0.0, "n": 0.0, "north": 0.0,
           "ud": UP, "u-d": UP, "u": UP, "up": UP, "vertical": UP}


@dataclass
class Component:
    """One direction of a record: where it is from, azimuth in degrees or UP, time step (s), values (m/s2)."""

    source: str
    direction: object
    dt: float
    values: np.ndarray
    begin: str = ""        # date and time as the file has them
    unit_in_head: bool = False      # as its format has it: --unit is not for it
    first_time: Optional[float] = None      # s, of a CSV
    sensor: str = ""       # of KiK-net, which has two
    of: str = ""           # earthquake and station, as the file has them

    @property
    def name(self):
        return UP if self.direction == UP else f"{self.direction:g} degrees"


def unit_of(text):
    """m/s2 of a unit as it is written, such as cm/sec**2; None of another."""
    plain = re.sub(r"\*\*|\^", "", text.lower().replace("\u00b2", "2").replace("sec", "s"))
    return UNITS.get(plain.rstrip(".,"))


def read(path, unit=None):
    """The components of one file; unit: of a CSV that names none. Raises SlopeError with file, line, rule, value."""
    try:
        text = Path(path).read_bytes().decode("utf-8-sig", "replace")
    except OSError as error:
        raise SlopeError(path, f"cannot be read: {error.strerror}") from None
    lines = text.splitlines()
    if not text.strip():
        raise SlopeError(path, "must hold a record, it is empty")
    if lines[0].startswith("Origin Time"):
        found = [knet(path, lines)]
    elif "PEER" in lines[0].upper() or Path(path).suffix.lower() == ".at2":
        found = [at2(path, lines)]
    else:
        found = table(path, lines, unit)
    for component in found:
        most = np.abs(component.values - component.values.mean()).max()
        if most > MOST:
            raise SlopeError(path, f"the largest acceleration must be at most {MOST:g} m/s2: the unit (--unit) or "
                             "scale factor is wrong", f"{most:.6g} m/s2 ({component.name})")
    return found


def values_of(path, lines, first, count):
    """All numbers from line `first` (from 0) on, of which there must be `count`; any number of them in a line."""
    values = []
    for number, line in enumerate(lines[first:], first + 1):
        words = NUMBER.findall(line)
        if NUMBER.sub("", line).strip():
            raise SlopeError(f"{path}, line {number}", "must hold numbers only", repr(line.strip()[:60]))
        values += [float(word.translate(str.maketrans("dD", "ee"))) for word in words]
    if len(values) != count:
        short = "it is cut short" if len(values) < count else "it has too many"
        raise SlopeError(path, f"must hold the {count} values that its head promises, {short}", len(values))
    return np.array(values)


# --- K-NET, KiK-net ---

def knet(path, lines):
    """A component of NIED's ASCII format: 17 lines of head, counts, and a factor from counts to gal."""
    head = {}
    for line in lines[:17]:
        head[line[:18].strip().rstrip(".").lower()] = line[18:].strip()

    def entry(key, pattern, rule):
        match = re.fullmatch(pattern, head.get(key, ""))
        if not match:
            raise SlopeError(path, f"the head must have {rule}", repr(head.get(key, "")) if key in head else "none")
        return match

    rate = float(entry("sampling freq(hz)", r"(\d+(?:\.\d+)?) *(?:Hz)?", "a line Sampling Freq(Hz) such as 100Hz")[1])
    seconds = float(entry("duration time(s)", r"(\d+(?:\.\d+)?)", "a line Duration Time(s) such as 300")[1])
    factor = entry("scale factor", r"(\d+(?:\.\d+)?) *\(gal\) */ *(\d+(?:\.\d+)?)",
                   "a line Scale Factor such as 3920(gal)/6182761")
    code = head.get("dir", "")
    if code not in KNET:
        raise SlopeError(path, "the head must have a line Dir. with N-S, E-W, U-D or 1 to 6", repr(code))
    if not (rate > 0 and seconds > 0 and float(factor[2]) > 0):
        raise SlopeError(path, "sampling frequency, duration and scale factor must be > 0",
                         f"{rate:g}, {seconds:g}, {factor[0]}")
    counts = values_of(path, lines, 17, round(rate * seconds))
    values = counts * (float(factor[1]) / float(factor[2]) * GAL)
    largest = re.fullmatch(r"(\d+(?:\.\d+)?)", head.get("max. acc. (gal)", ""))
    most = np.abs(values - values.mean()).max() / GAL
    if largest and abs(most - float(largest[1])) > 0.02 * most + 0.2:
        raise SlopeError(path, f"the largest acceleration must be the head's Max. Acc., {largest[1]} gal",
                         f"{most:.5g} gal")
    return Component(str(path), KNET[code], 1 / rate, values, head.get("record time", ""), True,
                     sensor=SENSORS.get(code, ""), of=" at ".join(
                         head[key] for key in ("origin time", "station code") if key in head))


# --- PEER ---

def at2(path, lines):
    """A component of PEER's AT2: four lines of head, direction at the end of the second, unit in the third."""
    if len(lines) < 5:
        raise SlopeError(path, "must have four lines of head and values (cut short)", f"{len(lines)} lines")
    unit = re.search(r"UNITS? +OF +(\S+)", lines[2].upper())
    factor = unit_of(unit[1]) if unit else None
    if factor is None:
        raise SlopeError(f"{path}, line 3", "must end in UNITS OF G (or GAL, CM/S2, M/S2)", repr(lines[2].strip()))
    if re.search("VELOCITY|DISPLACEMENT", lines[2].upper()):
        raise SlopeError(f"{path}, line 3", "must be of an acceleration", repr(lines[2].strip()))
    size = (re.search(r"NPTS *= *(\d+)(?: *, *| +)DT *= *([\d.eE+-]+)", lines[3].upper()) or
            re.match(r" *(\d+) +([\d.eE+-]+) +NPTS", lines[3].upper()))
    after = re.findall("[A-Z]+", lines[3].upper()[size.end():]) if size else []
    unit_of_time = [word for word in after[:2] if word != "DT"][:1]
    in_seconds = {*unit_of_time} <= {"S", "SEC", "SECS", "SECONDS"}
    if not size or not in_seconds or not 0 < heads.number(size[2]) <= SLOWEST:
        raise SlopeError(f"{path}, line 4", "must be NPTS= n, DT= s SEC", repr(lines[3].strip()))
    word = re.split(r"[,\s]+", lines[1].strip().upper())[-1]
    if word in ("UP", "DWN", "DOWN", "VER", "VERT", "V", "UD"):
        direction: Any = UP
        sign = -1.0 if word in ("DWN", "DOWN") else 1.0
    elif re.fullmatch(r"\d{1,3}", word) and int(word) <= 360:
        direction, sign = float(int(word) % 360), 1.0
    elif word in ("N", "NS", "N-S", "E", "EW", "E-W"):
        direction, sign = (0.0 if word[0] == "N" else 90.0), 1.0
    else:
        raise SlopeError(f"{path}, line 2", "must end in the direction, an azimuth or UP", repr(lines[1].strip()))
    values = values_of(path, lines, 4, int(size[1])) * (sign * factor)
    of = " ".join(lines[1].upper().split()).removesuffix(word).rstrip(", ")
    return Component(str(path), direction, heads.number(size[2]), values, unit_in_head=True, of=of)


# --- CSV ---

def table(path, lines, unit):
    """Components of a table: a head that names time and directions, then a line per time, evenly spaced."""
    rows = [(k, line.replace('"', "")) for k, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    if not rows:
        raise SlopeError(path, "must hold a record, it has comments only")
    place, head = rows[0]
    mark = next((mark for mark in ";,\t" if mark in head), None)
    names = [name.strip().lower() for name in (head.split(mark) if mark else head.split())]
    columns = dict(enumerate(map(heads.column, names)))
    if columns[0][0] not in ("t", "time") or len(columns) < 2:
        raise SlopeError(f"{path}, line {place}",
                         "the first line must name the columns, such as time,EW (gal),NS (gal)",
                         repr(head.strip()[:60]))
    for k in list(columns)[1:]:
        name, own = columns[k]
        if name not in COLUMNS:
            raise SlopeError(f"{path}, line {place}", "columns must be time and EW, NS or UD", repr(name))
        if unit_of(own or unit or "") is None:
            raise SlopeError(f"{path}, line {place}",
                             f"column {name} needs a unit, gal, g or m/s2, in brackets or by --unit",
                             repr(own) if own else "none")
    factor = heads.TIMES.get(columns[0].unit or "s")
    if factor is None:
        raise SlopeError(f"{path}, line {place}", "time must be in s or ms", repr(columns[0].unit))
    values = np.array([row_of(path, place, line, mark, len(columns)) for place, line in rows[1:]])
    if len(values) < 2:
        raise SlopeError(path, "must hold at least two lines of values", len(values))
    dt = factor * time_step(path, rows[1:], values[:, 0], mark)
    if dt > SLOWEST:
        raise SlopeError(path, f"times must be in s, with a step of at most {SLOWEST:g} s: are they in ms? Then the "
                         "head must say time (ms)", f"{dt:g} s")
    return [Component(str(path), COLUMNS[columns[k][0]], dt, values[:, k] * unit_of(columns[k][1] or unit),
                      first_time=factor * float(values[0, 0])) for k in list(columns)[1:]]


def time_step(path, rows, times, mark):
    """The time step of a table, whose times are evenly spaced but for their rounding."""
    steps = np.diff(times)
    dt = float(np.median(steps))
    for k in np.flatnonzero(steps <= 0):
        raise SlopeError(f"{path}, line {rows[k + 1][0]}", "times must rise", f"{times[k + 1]:g} after {times[k]:g}")
    last_digit = min(float(Decimal(1).scaleb(int(Decimal(line.split(mark)[0].strip()).as_tuple().exponent)))
                     for _, line in rows)
    rounding = min(last_digit, 0.5 * dt) + EVEN * dt
    for k in np.flatnonzero(np.abs(steps - dt) > rounding):
        raise SlopeError(f"{path}, line {rows[k + 1][0]}",
                         f"times must be evenly spaced, {dt:g} s here: the record has a gap",
                         f"a step of {steps[k]:g} s")
    dt = float((times[-1] - times[0]) / len(steps))
    off = np.abs(times - times[0] - dt * np.arange(len(times)))
    if off.max() > rounding:
        worst = int(off.argmax())
        raise SlopeError(f"{path}, line {rows[worst][0]}", f"times must be evenly spaced, {dt:g} s here",
                         f"{times[worst]:g}, {off[worst]:g} s beside")
    return dt


def row_of(path, place, line, mark, count):
    """The numbers of a line of a table."""
    line = line.split("#")[0]
    words = [word.strip() for word in (line.split(mark) if mark else line.split())]
    row = [heads.number(word) for word in words]
    if len(row) != count or not all(map(math.isfinite, row)):
        raise SlopeError(f"{path}, line {place}", f"must be {count} numbers", repr(line.strip()[:60]))
    return row
