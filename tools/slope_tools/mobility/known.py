"""Which known events a mass is compared with, and how likely it goes beyond each point of its fall path, as
they did: those of a set where it covers the mass, else landslides of all sizes, which have their angle of reach alone.

At a point at the length L the fall H is that of the ground there (as in PRE-RA of Mitchell et al. 2020): the
probability is that of a longer event with this H. It begins at the toe of the body, where H and L begin to be those of
a mass that has left its scar. Where the path is steep it may rise, though a mass that goes beyond a point was beyond
all before: the running minimum counts. Of a fall that none of the events had they say nothing: there the curve is that
of the last point before of which they do, 1 before the first one, and `said` is False.
"""
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
from shapely.geometry.base import BaseGeometry

from .. import digits
from ..errors import SlopeError
from . import body, events, fall_path
from .body import Body
from .events import LandslideKind, Relation
from .fall_path import AtRoad, FallPath

FAR = 0.999             # the path is followed to where so many events ended
HALF = 0.5
EQUAL = 0.01            # shares that differ by less
WORDS = {"confined": "laterally confined", "unconfined": "not laterally confined",
         "mixture": "confined or not, as often as known events",
         "landslides_narrow": "the smaller scatter", "landslides_wide": "the larger scatter",
         "landslides": "whichever scatter says more"}
CONFINED = {"yes": "confined", "no": "unconfined", "unknown": "mixture"}        # what is asked for, and its curve
Law = Union[Relation, LandslideKind]


class Lies(NamedTuple):
    """Share of known events of a volume and fall that go at least, and at most, as far as a length.

    beyond: the length is that of the path's end, or more: at_least is an upper limit.
    """
    at_least: float
    at_most: float
    beyond: bool


class Mobility(NamedTuple):
    """Of a body on its fall path.

    curves: {kind, of the law: probability that the mass goes beyond each point of the path}, 1 up to the body's toe;
    chosen: kind of the curve that counts; said: of which points the law's events had the fall; outside: why they say
    nothing of this mass, a line each; none of them: in range.
    """
    path: FallPath
    volume: float                   # million m3
    law: Law
    curves: Dict[str, np.ndarray]
    chosen: str
    said: np.ndarray
    outside: List[str]

    @property
    def width(self) -> float:
        """Of the mass, m."""
        return float((1e6 * self.volume) ** (1 / 3))

    @property
    def in_range(self) -> bool:
        """Whether the events cover the volume, and the fall at their median; else nothing may be conditioned on it."""
        return not self.outside

    def exceedance(self, length, kind: Optional[str] = None):
        """Probability of going beyond a length (m, a number or an array) of the path; beyond its end that of its end.

        kind: None for the curve that counts.
        """
        return np.interp(length, self.path.length, self.curves[kind or self.chosen])

    def end(self, longest: float) -> float:
        """Length (m) up to which the terrain shows the way: that of the path, or of the longest run where this one ends
        beside the path, farther from its beginning than the path's end (run_length)."""
        return max(float(self.path.length[-1]), longest)

    def beyond_path(self, kind: Optional[str] = None) -> float:
        """Share that goes beyond the end of the path."""
        return float(self.curves[kind or self.chosen][-1])

    def length_at(self, share: float, kind: Optional[str] = None) -> Optional[float]:
        """Length (m) that this share of known events goes beyond; None where that is beyond the path's end."""
        curve = self.curves[kind or self.chosen]
        if curve[-1] > share:
            return None
        k = int(np.argmax(curve <= share))
        if k == 0:
            return 0.0
        return float(np.interp(-share, -curve[k - 1:k + 1], self.path.length[k - 1:k + 1]))

    def where_lies(self, length: float, kind: Optional[str] = None) -> Lies:
        """Where a run that reaches a length (m, along the path) lies among known events."""
        share = float(self.exceedance(length, kind))
        return Lies(share, 1 - share, bool(length >= self.path.length[-1]))

    def shares(self, length: float) -> Tuple[float, float]:
        """The shares that go beyond a length (m) by a row's both scatters, the smaller first; of a set twice the same.

        So near to the body that the events say nothing, those at the next point of which they do.
        """
        if not self.says(length):
            after = np.flatnonzero(self.said & (self.path.length >= length))
            length = float(self.path.length[after[0]]) if len(after) else length
        kinds = self.law.both if isinstance(self.law, LandslideKind) else (self.chosen, self.chosen)
        low, high = sorted(float(self.exceedance(length, kind)) for kind in kinds)
        return low, high

    def at_most(self, share: float, kind: Optional[str] = None) -> Optional[float]:
        """The length (m) at which the events begin to say something, where fewer than a share go beyond that.

        None where they say how far this share goes: length_at() does. From the point before it the curve falls by what
        is not known; at_most() is the longest that the length can be.
        """
        curve = self.curves[kind or self.chosen]
        k = int(np.argmax(curve <= share))
        return float(self.path.length[k]) if curve[k] <= share and k > 0 and not self.said[k - 1] else None

    def says(self, length: float) -> bool:
        """Whether the events had the fall of the path at a length (m)."""
        at = min(int(np.searchsorted(self.path.length, length)), len(self.said) - 1)
        return self.in_range and bool(self.said[at])


class Choice(NamedTuple):
    """file: set of events; known: those of it that count, none where a row was asked for; left_out: names; confined: a
    key of CONFINED; given: the name that was asked for, None: our own set."""
    file: Path
    known: Sequence[events.Event]
    left_out: Sequence[str]
    row: LandslideKind
    confined: str
    given: Optional[str] = None

    @property
    def relation(self) -> Relation:
        return events.fit_relation(self.known, self.file)

    def name(self, mobility: Mobility) -> str:
        """Of the events of one of both."""
        return f"{self.row.type}:{self.row.path}" if isinstance(mobility.law, LandslideKind) else self.file.name

    def number(self, mobility: Mobility) -> int:
        """Of these events."""
        return self.row.events if isinstance(mobility.law, LandslideKind) else len(self.known)

    def about(self) -> Dict[str, Any]:
        """What is kept of it, for of_about()."""
        return {"set": self.given, "left_out": list(self.left_out), "confined": self.confined}


class Found(NamedTuple):
    """A mass among both; by_set: None where no set was asked for."""
    by_set: Optional[Mobility]
    by_row: Mobility

    @property
    def decides(self) -> Mobility:
        """The set where it covers the mass, else the landslides."""
        return self.by_set if self.by_set and self.by_set.in_range else self.by_row

    @property
    def strict(self) -> Optional[Mobility]:
        """What the runs of a study must reach: a set that covers the mass, or a row that was asked for; None: neither.

        Landslides that stand for a set that does not cover the mass are shown, and withhold nothing.
        """
        return self.by_row if self.by_set is None else self.by_set if self.by_set.in_range else None

    @property
    def each(self) -> List[Mobility]:
        return [one for one in self if one]


class Known(NamedTuple):
    """found: of a mass, None and why (a sentence without its full stop) where it has no fall path."""
    found: Optional[Found]
    why: str
    mass: Optional[Body] = None


def choice(name: Optional[str] = None, left_out: Sequence[str] = (), confined: str = "unknown") -> Choice:
    """What --known, --except and --confined ask for; name: of our own set, a file of one, or a row; None: our own.

    Raises SlopeError for another name, and for a set that gives no relation.
    """
    path = events.OWN if name in (None, events.OWN.stem) else Path(str(name))
    if path != events.OWN and not path.suffix and not path.is_file():
        row = events.choose_landslide_row(str(name))
        if left_out:
            raise SlopeError("--except", "must be an event of a set, of which --known names none", left_out[0])
        return Choice(path, [], [], row, confined, name)
    found = Choice(path, events.select_events(path, left_out), left_out, events.choose_landslide_row(), confined, name)
    found.relation      # SlopeError
    return found


def compute_known_mobility(mass: Body, asked: Choice, path: Optional[FallPath] = None) -> Found:
    """Both Mobilities of a body, on one fall path; path: another than the steepest descent."""
    law = asked.relation if asked.known else None
    path = path or path_of(mass, [law, asked.row] if law else [asked.row])
    return Found(law and compute_mobility(mass, law, CONFINED[asked.confined], path),
                 compute_mobility(mass, asked.row, path=path))


def of_about(kept_choice: Mapping[str, Any]) -> Choice:
    """The Choice of what was kept of one; SlopeError where its file is gone."""
    return choice(kept_choice.get("set"), kept_choice.get("left_out") or (), kept_choice.get("confined", "unknown"))


def among_events(site: Optional[Path], read: Callable[[], Body], kept_choice: Mapping[str, Any]) -> Known:
    """A mass among the known events of what was kept of a Choice: of a site, whose body is finer than what a run's grid
    has of it, and the same for all runs; without one (None) as it is read."""
    try:
        mass = body.read_mobility_body(site) if site else read()
        return Known(compute_known_mobility(mass, of_about(kept_choice)), "", mass)
    except SlopeError as error:
        return Known(None, f"The runs cannot be compared with known events: {error}")


# --- the curves of a body ---

def compute_mobility(body: Body, law: Law, chosen: Optional[str] = None, path: Optional[FallPath] = None,
                     volume: Optional[float] = None) -> Mobility:
    """The Mobility of a body; chosen: kind of the curve that counts, None: the law's last one; path: another one;
    volume: million m3, of the mass that the body is a part of.

    Raises SlopeError for a body on level ground.
    """
    path = path or path_of(body, [law])
    volume, toe = volume or body.volume / 1e6, fall_path.from_toe(body, path).length[0]
    low, high = law.falls
    covered = (path.fall >= low) & (path.fall <= high) & (path.fall > 0) & (path.length > 0) & (path.length >= toe)
    curves = {}
    for kind in law.kinds:
        share = np.ones(len(path.length))
        share[covered] = law.beyond(kind, path.length[covered], volume, path.fall[covered])
        curves[kind] = np.minimum.accumulate(share)
    mobility = Mobility(path, volume, law, curves, chosen or law.kinds[-1], covered, [])
    return mobility._replace(outside=outside(mobility))


def path_of(body: Body, laws: Sequence[Law]) -> FallPath:
    """The fall path as far as hardly any of the laws' events went."""
    return fall_path.trace(body, farthest(body, laws, body.volume / 1e6))


def farthest(body: Body, laws: Sequence[Law], volume: float) -> float:
    """How far (m) a path is followed."""
    relief = body.crown[2] - float(np.nanmin(body.raster.z))
    return max(law.farthest(FAR, volume, relief) for law in laws)


# --- at a road ---

class Way(NamedTuple):
    """How a mass comes to a road: where, and what the events say along the path that leads there; own: which is that of
    the mass, not of a strip of it or of another body."""
    at: AtRoad
    mobilities: Found
    own: bool

    @property
    def share(self) -> float:
        """Of the events that count, which come along it: by the mean of both scatters."""
        return sum(self.mobilities.decides.shares(self.at.length)) / 2


def way_to_road(mass: Body, mobilities: Found, road: BaseGeometry) -> Way:
    """The Way by which most known events come to a road (polygons in local metres), among those that come as near as
    the mass is wide, of nearly equal ones the shortest; if none does, that which comes nearest. A user's path is the
    only one.
    """
    width = mobilities.decides.width

    def way(path: FallPath, events_: Found, own: bool) -> Way:
        return Way(fall_path.at_road(path, road, mass.raster, width), events_, own)
    several = [way(mobilities.decides.path, mobilities, True)]
    if not mobilities.decides.path.drawn:
        several += [way(path, along(mobilities, part, path), False) for part, path in trace_others(mass, mobilities)]
    ahead = [each for each in several if not each.at.behind] or several[:1]
    near = [each for each in ahead if each.at.beside <= width]
    if not near:
        return min(ahead, key=lambda each: each.at.beside)
    most = max(each.share for each in near)
    return min((each for each in near if each.share > most - EQUAL), key=lambda each: round(each.at.length))


def trace_others(mass: Body, mobilities: Found) -> Iterator[Tuple[Body, FallPath]]:
    """Parts of a mass and their paths, beside that of the largest: of its strips, of other bodies and of their strips.
    """
    laws, width = [one.law for one in mobilities.each], mobilities.decides.width
    for number, part in enumerate(mass.parts):
        longest = farthest(part, laws, mobilities.decides.volume)
        try:
            if number:
                yield part, fall_path.trace(part, longest)
            for path in fall_path.trace_strips(part, width, longest):
                yield part, path
        except SlopeError:      # on level ground
            continue


def along(mobilities: Found, part: Body, path: FallPath) -> Found:
    """The same events, of the volume of the whole mass, along the path of a part; whether they cover the mass stays."""
    by_set, by_row = (one and compute_mobility(part, one.law, one.chosen, path, one.volume)._replace(
        outside=one.outside) for one in mobilities)
    assert by_row
    return Found(by_set, by_row)


def outside(mobility: Mobility) -> List[str]:
    """Lines on volume and fall outside of the events' range: the fall where half of them end, or the path does."""
    law, path, covered = mobility.law, mobility.path, np.flatnonzero(mobility.said)
    lines = []
    low, high = law.volumes
    if not low <= mobility.volume <= high:
        lines.append("the set of known events does not cover this volume, "
                     f"{digits.format_volume(1e6 * mobility.volume)}: it has {low:g} to {high:g} million m3")
    low, high = law.falls
    median = mobility.length_at(HALF)
    fall = float(np.interp(path.length[-1] if median is None else median, path.length, path.fall))
    if len(covered) and mobility.curves[mobility.chosen][covered[0]] <= HALF:     # before any fall of the set
        fall = min(fall, float(path.fall[max(covered[0] - 1, 0)]))
    if not (len(covered) and low <= fall <= high):
        lines.append(f"the set of known events does not cover this height, {fall:.4g} m where half of them end (or "
                     f"the path does): they fell {low:g} to {high:g} m")
    return lines
