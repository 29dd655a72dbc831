"""Where the runs of a report lie among known events, by how far their deposits reach, and against a mapped deposit.

The lengths of both are along the fall path, from crown to tip (mobility.run_length).
"""
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

from ..digits import percent
from ..mobility.known import WORDS, Mobility
from ..mobility.events import NOT_OF_ROADS, LandslideKind
from ..studies.mapped import mass, of_rows
from ..tables.quantities import BEYOND_MAPPED as BEYOND, LENGTH, OVERLAP
from ..tables.rows import Finished, Mapped
from .data import Data
from .numbers import Numbers
from .sections import Cell, Section, Table, Text

WHAT = "Known events"


class Lies(NamedTuple):
    """Where runs lie; mobility: None, and why, where they cannot be compared."""
    lengths: List[float]                # m, of the runs that left a deposit
    mobility: Optional[Mobility]
    why: str


def list_mobility_limits(data: Data, ground, numbers: Numbers) -> List[Tuple[str, str]]:
    """The row of the table of limits."""
    found = where_lie(data, ground)
    if found.mobility is None:
        return [(WHAT, found.why)]
    return [(WHAT, sentence(found, numbers, data.label(data.result)))]


# --- the table of limits ---

def where_lie(data: Data, ground) -> Lies:
    """The runs of a data.Data on its ground.Ground among the events that decide."""
    lengths, among = lengths_of(data), ground.known
    if among.found is None:
        return Lies(lengths, None, f"{among.why}.")
    if not lengths:
        return Lies(lengths, None, "No run has a deposit, whose length could be compared with known events.")
    return Lies(lengths, among.found.decides, "")


def lengths_of(data: Data) -> List[float]:
    """Of each finished run that left a deposit."""
    if data.study:
        return sorted(row.length_m for row in data.finished if row.length_m is not None)
    one = data.length
    return [one.distance] if one else []


def sentence(counted: Lies, numbers: Numbers, label: str) -> str:
    """How far the runs reach, and how many known events end there or before."""
    assert counted.mobility is not None
    ends = list(dict.fromkeys((counted.lengths[0], counted.lengths[-1])))
    reach = " to ".join(numbers.quantity(LENGTH, length, label) for length in ends)
    law, shares = counted.mobility.law, []
    others = law.both if isinstance(law, LandslideKind) else ("confined", "unconfined")
    for kind in (counted.mobility.chosen, *others):
        lies = [counted.mobility.where_lies(length, kind) for length in ends]
        for one in lies:
            numbers.rows.append((f"known events that reach at most as far, {WORDS[kind]}", "%", label,
                                 percent(one.at_most).split()[-2], 100 * one.at_most))
        shares.append("at least " * lies[-1].beyond
                      + " to ".join(dict.fromkeys(percent(one.at_most) for one in lies)))
    who = "The deposit reaches" if len(ends) == 1 else "The deposits of the runs reach"
    chosen = WORDS[counted.mobility.chosen]
    if isinstance(law, LandslideKind):
        return (f"{who} {reach} m: as far as {shares[0]} of landslides of this volume and height do ({law.name}; "
                f"{chosen}; {shares[1]} by the smaller, {shares[2]} by the larger); the others go farther; "
                f"{NOT_OF_ROADS}." + beyond_the_terrain(counted, others, numbers, label))
    return (f"{who} {reach} m: as far as {shares[0]} of rock avalanches of this volume and height do "
            f"({chosen}; {shares[1]} of those on a laterally confined path, "
            f"{shares[2]} of the others); the others go farther."
            + beyond_the_terrain(counted, others[::-1], numbers, label))


def beyond_the_terrain(counted: Lies, kinds: Sequence[str], numbers: Numbers, label: str) -> str:
    """What the edge of the terrain hides, if half of the events of either of two kinds go beyond; else nothing."""
    mobility = counted.mobility
    assert mobility is not None
    shares = [mobility.beyond_path(kind) for kind in kinds]
    if max(shares) <= 0.5:      # with hardly any left, the path ends within the terrain
        return ""
    length = numbers("way within the terrain", "m", mobility.end(counted.lengths[-1]), label)
    return (f" The terrain shows the first {length} m of the way, where {percent(shares[0])} ({percent(shares[1])}) of "
            "them go on: no run shows what lies there.")


# --- a mapped deposit: how the runs agree with it, whatever the method of the study ---

def find_mobility_shape(data: Data) -> Any:
    """What the maps draw of it: its polygon, or the mask of its cells; None without one."""
    if data.mapped is None:
        return None
    return data.mapped.share >= 0.5 if data.mapped.polygon is None else data.mapped.polygon


def mapped_runs(data: Data) -> List[Tuple[Finished, Mapped]]:
    """The runs that are compared, and how they compare."""
    return of_rows(data.finished) if data.mapped is not None else []


def mapped_sentence(data: Data, numbers: Numbers) -> str:
    """For the first page; "" without a mapped deposit."""
    runs = mapped_runs(data)
    if not runs:
        return ""
    observed = data.of_study.observed
    assert observed
    best, mine = next((row, one) for row, one in runs if row.run == observed.best)
    share = numbers.quantity(OVERLAP, mine.overlap, data.label_of(best))
    which = f"The best of {len(runs)} runs" if len(runs) > 1 else "The run"
    text = f"{which} shares {share} of the area that it or the mapped deposit covers (1: the same area)"
    if mine.beyond_mapped_m is not None:
        by = numbers.quantity(BEYOND, abs(mine.beyond_mapped_m), data.label_of(best))
        text += f", and ends {by} m {'beyond' if mine.beyond_mapped_m > 0 else 'short of'} its tip"
    lacks = mass(observed.volume_m3, observed.released_m3)
    return f"{text}." + (f" {lacks.text[0].upper()}{lacks.text[1:]}." if lacks else "")


def mapped(data: Data, numbers: Numbers) -> Optional[Section]:
    """The section with a table of the mapped deposit, the shown run, the best one and all; None without any."""
    runs = mapped_runs(data)
    if not runs:
        return None
    observed = data.of_study.observed
    assert observed
    volume, length = observed.volume_m3, observed.length_m
    by_name = {row.run: row for row, _ in runs}
    heads: List[Any] = ["", Cell("overlap (Jaccard)", ""), Cell("length", "m"), Cell("difference", "m")]
    columns = [(OVERLAP, "1"), ("length_m", "m"), (BEYOND, "m")]
    if volume is not None:
        heads += [Cell("volume of the deposit", "m3"), Cell("difference", "m3")]
    mine = ["mapped", "1", numbers("length of the mapped deposit", "m", length), "-"]
    if volume is not None:
        mine += [numbers("volume of the mapped deposit", "m3", volume), "-"]
    rows = [mine]

    def row(what, several, label):
        texts = [what]
        for key, unit in columns:
            values = [value for one in several if (value := one.value(key)) is not None]
            texts.append(range_of(numbers, key.replace("_", " "), unit, values, label) if values else "-")
        if volume is not None:
            kept = [one.on_grid_m3 for one in several]
            texts.append(range_of(numbers, "volume of the deposit", "m3", kept, label))
            texts.append(range_of(numbers, "volume less that of the mapped deposit", "m3",
                                  [value - volume for value in kept], label))
        return texts

    shown = [("on the maps", data.result.name), ("best overlap", observed.best)]
    for what, name in shown if shown[0][1] != shown[1][1] else [("on the maps, best overlap", shown[0][1])]:
        if name in by_name:
            label = data.label_of(by_name[name])
            rows.append(row(f"run {data.number(name)}, {what}", [by_name[name]], label))
    if len(runs) > 1:
        rows.append(row(f"all {len(runs)} runs", [one for one, _ in runs], ""))
    lacks = mass(volume, observed.released_m3)
    return Section("mapped", "Against the mapped deposit", [
        Text(f"{lacks.text[0].upper()}{lacks.text[1:]}.") if lacks else None,
        Table("Overlap: the area that both cover over that which either covers, thicker than "
              f"{observed.threshold_m:g} m. Lengths are those of the table of runs; of an outline that to its "
              "farthest point. Negative differences: the run ends short, or holds less.", heads, rows)])


def range_of(numbers, what, unit, values, label) -> str:
    low, high = (numbers(what, unit, value, label) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"
