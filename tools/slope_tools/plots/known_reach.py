"""How far known events of a mass's volume and fall go, as maps and section show it: marks across the fall path.

A mark lies where a share of the events goes farther, by the curve that counts (laterally confined or not). Where a mark
would lie beyond the terrain there is none.
"""
from typing import Iterator, List, NamedTuple, Tuple

import numpy as np
from shapely.geometry import LineString, Point

from ..mobility.known import WORDS, Mobility

SHARES = {0.5: "half", 0.1: "a tenth"}      # that go farther
WIDE = 0.04         # half of a mark's length, of the length of the path to the farthest mark
BESIDE = 0.1        # of a mark's distance along the path: a section that is no farther beside it shows it


class Mark(NamedTuple):
    """Where a share of the events goes farther: at a length (m) of the path; its middle and its ends, local m."""
    share: float
    length: float
    middle: np.ndarray      # x y
    ends: np.ndarray        # (2, 2)


class KnownReach(NamedTuple):
    """The path to the farthest mark, or all of it, rows of x y (local m), the marks, and of what curve."""
    path: np.ndarray
    marks: List[Mark]
    kind: str = ""


NOTHING = KnownReach(np.zeros((0, 2)), [])


def of_mobility(mobility: Mobility) -> KnownReach:
    """The KnownReach of a Mobility; NOTHING without marks."""
    lengths = [(share, length) for share in SHARES if (length := mobility.length_at(share)) is not None and length > 0]
    if not lengths:
        return NOTHING
    path = mobility.path
    far = max(length for *_, length in lengths)
    line = LineString(np.column_stack([path.x, path.y]))
    scale = line.length / path.length[-1]       # 1, but for rounding
    half = WIDE * far

    def at(length: float) -> np.ndarray:
        return np.asarray(line.interpolate(scale * length).coords[0])

    marks = []
    for share, length in lengths:
        way = at(length + half) - at(length - half)
        across = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9)
        marks.append(Mark(share, length, at(length), at(length) + half * np.outer((-1, 1), across)))
    before = np.column_stack([path.x, path.y])[path.length < far]
    return KnownReach(np.concatenate([before, [at(far)]]), marks, WORDS[mobility.chosen])


def on_line(reach: KnownReach, line: LineString) -> Iterator[Tuple[Mark, float]]:
    """Marks that are not far beside a line, and their distance along it (m)."""
    for mark in reach.marks:
        point = Point(mark.middle)
        if line.distance(point) <= BESIDE * mark.length and 0 < line.project(point) < line.length:
            yield mark, line.project(point)


def describe_known_reach(reach: KnownReach) -> str:
    """What the marks are, for a caption; "" without marks."""
    if not reach.marks:
        return ""
    parts = " and ".join(SHARES[one.share] for one in reach.marks)
    more = "" if len(reach.marks) == len(SHARES) else "; other marks would lie beyond the terrain"
    return f" Marks across the fall path: beyond them go {parts} of known events ({reach.kind}){more}."
