"""Strong-motion records: K-NET and KiK-net ASCII, PEER AT2, CSV, formats of networks, each as components in m/s2."""
import math
import re
from decimal import Decimal
from pathlib import Path
from typing import List, Optional, Sequence

import numpy as np

from .. import heads
from ..errors import SlopeError
from . import archives, networks
from .components import (DIRECTIONS, G, GAL, SLOWEST, UP, Component, NoAcceleration, check_count, direction_of,
                         numbers_of, values_of)

__all__ = ["Component", "G", "GAL", "MOST", "UP", "read_quake_record"]
MOST = 50.0                 # m/s2; no ground has moved with more
EVEN = 1e-3                 # of a time step, that steps of a CSV may differ, beside the rounding of its times
KIK_NET = {"1": 0.0, "2": 90.0, "3": UP, "4": 0.0, "5": 90.0, "6": UP}    # 1 to 3: in the borehole
KNET = {**{name: DIRECTIONS[name][0] for name in ("N-S", "E-W", "U-D")}, **KIK_NET}
SENSORS = {**dict.fromkeys("123", "in the borehole"), **dict.fromkeys("456", "at the surface")}
FORMATS = ", ".join(["K-NET", "KiK-net", "PEER AT2", *(form.networks for form in networks.FORMS)])
NAMED = "first line must name the columns, such as time,EW (gal),NS (gal)"


def read_quake_record(path, unit: Optional[str] = None) -> List[Component]:
    """The components of a file, or of the one record in an archive; unit: of a CSV that names none.

    ARCHIVE/PATTERN takes these of its files.  Raises SlopeError with file, line, rule, value.
    """
    files = archives.files(path)
    if len(files) == 1:
        (name, data), = files
        return read_text(name, text_of(data), unit)
    components: List[Component] = []
    for name, data in files:
        text = text_of(data)
        if text.strip() and (not Path(path).is_file() or is_record(name, text.splitlines())):
            try:
                components += read_text(name, text, unit)
            except NoAcceleration:
                pass
    records = {(one.of, one.sensor): one for one in reversed(components)}
    if len(records) != 1 or len(components) > 3:
        raise SlopeError(path, "an archive must hold the components of one record, or these must be named, such as "
                         f"{' '.join(list_record_files(components)) or 'ARCHIVE/FILE'}; {FORMATS} are read",
                         describe_components(components))
    return components


def list_record_files(components: Sequence[Component]) -> List[str]:
    """The files of the first record of an archive."""
    return [one.source for one in components if (one.of, one.sensor) == (components[0].of, components[0].sensor)][:3]


def describe_components(components: Sequence[Component]) -> str:
    records = dict.fromkeys(", ".join(filter(None, (one.of, one.sensor))) for one in components)
    return f"{len(components)} components" + (f" of {len(records)} records: {'; '.join(records)}" if components else "")


def text_of(data: bytes) -> str:
    return data.decode("utf-8-sig", "replace")


def is_record(name: str, lines: Sequence[str]) -> bool:
    """Whether a file is of a format that is known by its first line: not a CSV, of which archives have others."""
    return lines[0].startswith("Origin Time") or is_at2(name, lines) or networks.form_of(lines) is not None


def is_at2(name, lines: Sequence[str]) -> bool:
    return "PEER" in lines[0].upper() or Path(name).suffix.lower() == ".at2"


def read_text(path, text: str, unit: Optional[str]) -> List[Component]:
    """The components of the text of a file."""
    lines = text.splitlines()
    if not text.strip():
        raise SlopeError(path, "must hold a record, it is empty")
    form = networks.form_of(lines)
    if lines[0].startswith("Origin Time"):
        components = [knet(path, lines)]
    elif is_at2(path, lines):
        components = [at2(path, lines)]
    elif form:
        components = networks.read_network_record(path, lines, form)
    else:
        components = read_quake_table(path, lines, unit)
    for component in components:
        most = np.abs(component.values - component.values.mean()).max()
        if most > MOST:
            raise SlopeError(path, f"the largest acceleration must be at most {MOST:g} m/s2: the unit (--unit) or "
                             "scale factor is wrong", f"{most:.6g} m/s2 ({component.name})")
    return components


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
    counts = values_of(path, lines, 17)
    check_count(path, counts, round(rate * seconds))
    values = counts * (float(factor[1]) / float(factor[2]) * GAL)
    largest = re.fullmatch(r"(\d+(?:\.\d+)?)", head.get("max. acc. (gal)", ""))
    most = np.abs(values - values.mean()).max() / GAL
    if largest and abs(most - float(largest[1])) > 0.02 * most + 0.2:
        raise SlopeError(path, f"the largest acceleration must be the head's Max. Acc., {largest[1]} gal",
                         f"{most:.5g} gal")
    return Component(str(path), KNET[code], 1 / rate, values, head.get("record time", ""), True,
                     sensor=SENSORS.get(code, ""),
                     of=" at ".join(head[key] for key in ("origin time", "station code") if head.get(key)))


# --- PEER ---

def at2(path, lines):
    """A component of PEER's AT2: four lines of head, direction at the end of the second, unit in the third."""
    if len(lines) < 5:
        raise SlopeError(path, "must have four lines of head and values (cut short)", f"{len(lines)} lines")
    if re.search("VELOCITY|DISPLACEMENT", lines[2].upper()):
        raise NoAcceleration(f"{path}, line 3", "must be of an acceleration", repr(lines[2].strip()))
    unit = re.search(r"UNITS? +OF +(\S+)", lines[2].upper())
    factor = heads.acceleration(unit[1]) if unit else None
    if factor is None:
        raise SlopeError(f"{path}, line 3", "must end in UNITS OF G (or GAL, CM/S2, M/S2)", repr(lines[2].strip()))
    size = (re.search(r"NPTS *= *(\d+)(?: *, *| +)DT *= *([\d.eE+-]+)", lines[3].upper()) or
            re.match(r" *(\d+) +([\d.eE+-]+) +NPTS", lines[3].upper()))
    after = re.findall("[A-Z]+", lines[3].upper()[size.end():]) if size else []
    unit_of_time = [word for word in after[:2] if word != "DT"][:1]
    in_seconds = {*unit_of_time} <= {"S", "SEC", "SECS", "SECONDS"}
    if not size or not in_seconds or not 0 < heads.parse_cell(size[2]) <= SLOWEST:
        raise SlopeError(f"{path}, line 4", "must be NPTS= n, DT= s SEC", repr(lines[3].strip()))
    place, word = re.fullmatch(r"(.*?)[,\s]*([^,\s]*)", lines[1].strip()).groups()    # type: ignore
    direction = direction_of(word)
    if direction is None:
        raise SlopeError(f"{path}, line 2", "must end in the direction, an azimuth or UP (where it is the code of a "
                         "sensor, write the azimuth from the station's metadata in its place)", repr(lines[1].strip()))
    values = values_of(path, lines, 4)
    check_count(path, values, int(size[1]))
    return Component(str(path), direction[0], heads.parse_cell(size[2]), values * (direction[1] * factor),
                     unit_in_head=True, of=" ".join(place.upper().split()))


# --- CSV ---

def read_quake_table(path, lines, unit):
    """Components of a table: a head that names time and directions, then a line per time, evenly spaced."""
    rows = [(k, line.replace('"', "")) for k, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    if not rows:
        raise SlopeError(path, "must hold a record, it has comments only")
    place, head = rows[0]
    mark = next((mark for mark in ";,\t" if mark in head), None)
    names = [name.strip().lower() for name in (head.split(mark) if mark else head.split())]
    columns = dict(enumerate(map(heads.column, names)))
    if columns[0][0] not in ("t", "time") and not numbers_of(" ".join(names)):
        raise SlopeError(path, f"must be a record that is read ({FORMATS}), or a CSV whose {NAMED} (page tool_quake)",
                         escape_head(head))
    if columns[0][0] not in ("t", "time") or len(columns) < 2:
        raise SlopeError(f"{path}, line {place}", f"the {NAMED}", escape_head(head))
    for k in list(columns)[1:]:
        name, own = columns[k]
        if name.upper() not in DIRECTIONS:
            raise SlopeError(f"{path}, line {place}", "columns must be time and EW, NS or UD", repr(name))
        if heads.acceleration(own or unit or "") is None:
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
    found = []
    for k in list(columns)[1:]:
        direction, sign = DIRECTIONS[columns[k].name.upper()]
        scale = sign * (heads.acceleration(columns[k].unit or unit or "") or 0.0)
        found.append(Component(str(path), direction, dt, scale * values[:, k], first_time=factor * float(values[0, 0])))
    return found


def escape_head(head: str) -> str:
    """The first line of a file, as far as it is text."""
    return repr(head.strip()[:60]) if head.isprintable() and "\ufffd" not in head[:60] else "a file that is no text"


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
    row = [heads.parse_cell(word) for word in words]
    if len(row) != count or not all(map(math.isfinite, row)):
        raise SlopeError(f"{path}, line {place}", f"must be {count} numbers", repr(line.strip()[:60]))
    return row
