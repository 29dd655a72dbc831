"""Where the runs of a report lie among known events, by how far their deposits reach.

The lengths of both are along the fall path, from crown to tip (mobility.run_length).
"""
from typing import List, NamedTuple, Optional, Sequence, Tuple

from ..mobility import exceedance
from ..mobility.landslides import NOT_OF_ROADS, Row
from ..mobility.results import percent

WHAT = "Known events"


class Lies(NamedTuple):
    """Where runs lie; mobility: None, and why, where they cannot be compared."""
    lengths: List[float]                # m, of the runs that left a deposit
    mobility: Optional[exceedance.Mobility]
    why: str


def content(data, ground, numbers) -> List[Tuple[str, str]]:
    """The row of the table of limits."""
    found = where_lie(data, ground)
    if found.mobility is None:
        return [(WHAT, found.why)]
    return [(WHAT, sentence(found, numbers, data.label(data.result)))]


def where_lie(data, ground) -> Lies:
    """The runs of a data.Data on its ground.Ground among the events that decide."""
    lengths, among = lengths_of(data), ground.known
    if among.found is None:
        return Lies(lengths, None, f"{among.why}.")
    if not lengths:
        return Lies(lengths, None, "No run has a deposit, whose length could be compared with known events.")
    return Lies(lengths, among.found.decides, "")


def lengths_of(data) -> List[float]:
    """Of each finished run that left a deposit."""
    if data.study:
        return sorted(row["length_m"] for row in data.finished if row.get("length_m") is not None)
    one = data.length()
    return [one.distance] if one else []


def sentence(found: Lies, numbers, label: str) -> str:
    """How far the runs reach, and how many known events end there or before."""
    assert found.mobility is not None
    ends = list(dict.fromkeys((found.lengths[0], found.lengths[-1])))
    reach = " to ".join(numbers("length along the fall path", "m", length, label) for length in ends)
    law, shares = found.mobility.law, []
    others = law.both if isinstance(law, Row) else ("confined", "unconfined")
    for kind in (found.mobility.chosen, *others):
        lies = [found.mobility.where_lies(length, kind) for length in ends]
        for one in lies:
            numbers.rows.append((f"known events that reach at most as far, {exceedance.WORDS[kind]}", "%", label,
                                 percent(one.at_most).split()[-2], 100 * one.at_most))
        shares.append("at least " * lies[-1].beyond
                      + " to ".join(dict.fromkeys(percent(one.at_most) for one in lies)))
    who = "The deposit reaches" if len(ends) == 1 else "The deposits of the runs reach"
    chosen = exceedance.WORDS[found.mobility.chosen]
    if isinstance(law, Row):
        return (f"{who} {reach} m: as far as {shares[0]} of landslides of this volume and height do ({law.name}; "
                f"{chosen}; {shares[1]} by the smaller, {shares[2]} by the larger); the others go farther; "
                f"{NOT_OF_ROADS}." + beyond_the_terrain(found.mobility, others, numbers, label))
    return (f"{who} {reach} m: as far as {shares[0]} of rock avalanches of this volume and height do "
            f"({chosen}; {shares[1]} of those on a laterally confined path, "
            f"{shares[2]} of the others); the others go farther."
            + beyond_the_terrain(found.mobility, others[::-1], numbers, label))


def beyond_the_terrain(mobility: exceedance.Mobility, kinds: Sequence[str], numbers, label: str) -> str:
    """What the edge of the terrain hides, if half of the events of either of two kinds go beyond; else nothing."""
    shares = [mobility.beyond_path(kind) for kind in kinds]
    if max(shares) <= 0.5:      # with hardly any left, the path ends within the terrain
        return ""
    length = numbers("fall path within the terrain", "m", mobility.path.length[-1], label)
    return (f" The fall path leaves the terrain after {length} m, where {percent(shares[0])} ({percent(shares[1])}) of "
            "them go on: no run shows what lies there.")
