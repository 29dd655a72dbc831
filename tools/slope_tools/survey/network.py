"""The roads of a layer of lines: which of the ways that meet are one road, and which roads run side by side.

Ways of a map end where others join. At a junction those go on in each other that were drawn as one, then those of one
name or ref, then the straightest. Of two ways that part and come together again, as around an island or a roundabout,
one is the road's.
"""
import math
from itertools import combinations
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from shapely.geometry import LineString, Point
from shapely.ops import polygonize, substring

from .features import attribute

SAME = 0.01         # m; ends that are closer to each other, or to a line, meet
GAP = 2.0           # m; free ends that are no farther from each other are one, where they go on in each other
LOOK = 10.0         # m of a way, in which it leaves a junction
STRAIGHT = 61.0     # degrees; ways that turn more do not go on in each other, unless nothing else is there
TURN = 135.0        # the same of ways of one name
ALIKE = 30.0        # degrees; of two ways around an island the shorter, unless the other turns so much less
ROUND = 0.85        # of a circle's area for its length: a loop is a roundabout, if it is no longer than
LARGE = 500.0       # m
PARALLEL = 30.0     # degrees between two carriageways, in the middle of all places
APART = 60.0        # m between carriageways of one name, at most; of such without one
WIDTHS = 2.5        # widths of the road
BESIDE = 0.5        # of the shorter one, that lies so
ARC, BENT = 100.0, 0.8      # m; shorter lines whose ends are nearer to each other than this share of them are arcs
STATIONS = 50       # at which two roads are compared
DRAWN, NAMED, ANY = 1, 2, 3     # why two ways are one road; 0: around an island


class Drawn(NamedTuple):
    """A line of a file, in local metres."""
    line: LineString
    about: Mapping[str, Any] = {}

    def words(self) -> Set[str]:
        """Its name and ref, by which it is known to be the same road as another."""
        return {str(value) for key in ("name", "ref") if (value := attribute(self.about, key)) is not None}

    @property
    def name(self) -> str:
        return str(attribute(self.about, "name") or attribute(self.about, "ref") or "")


class Way(NamedTuple):
    """A piece between two junctions."""
    line: LineString
    ends: Tuple[int, int]       # nodes
    drawn: int                  # which of the lines it is part of

    def leaves(self, end: int) -> np.ndarray:
        """Unit vector in which it leaves its first or last node."""
        length = min(LOOK, self.line.length)
        one, other = (np.array(self.line.interpolate(s if end == 0 else self.line.length - s).coords[0][:2])
                      for s in (0.0, length))
        return (other - one) / max(float(np.hypot(*(other - one))), 1e-12)


End = Tuple[int, int]           # a way and its first (0) or last (1) end


class One(NamedTuple):
    """A road: lines that are one, in the direction in which most of it was drawn."""
    line: LineString
    names: Tuple[str, ...]      # the longest part's first; none: it has none
    words: frozenset            # of Drawn.words()


def roads_of(drawn: Sequence[Drawn]) -> List[One]:
    """The roads that lines make, in the order of the file."""
    ways = split(drawn)
    nodes = at_nodes(ways)
    partner: Dict[End, End] = {}
    for island in islands(ways, nodes):
        pass_island(island, ways, drawn, partner)
    for node in nodes.values():
        pair_up(node, ways, drawn, partner)
    return [road for chain in chains(ways, partner) for road in as_roads(chain, ways, drawn)]


# --- pieces ---

def split(drawn: Sequence[Drawn]) -> List[Way]:
    """The lines cut where ends of others, or of themselves, lie on them; ends that meet are one node."""
    points = np.array([one.line.coords[k][:2] for one in drawn for k in (0, -1)])
    near = np.concatenate([cKDTree(points).query_pairs(SAME, output_type="ndarray"), gaps(drawn, points)])
    _, label = connected_components(coo_matrix((np.ones(len(near)), near.T), (len(points),) * 2), directed=False)
    first = np.unique(label, return_index=True)[1]      # of the points of each node
    ways = []
    for number, piece in enumerate(drawn):
        places = {0.0: int(label[2 * number]), piece.line.length: int(label[2 * number + 1])}
        low, high = np.reshape(piece.line.bounds, (2, 2))
        for k in np.flatnonzero(((points >= low - SAME) & (points <= high + SAME)).all(axis=1)):
            end = Point(points[k])
            along = piece.line.project(end)
            if piece.line.distance(end) <= SAME and not any(abs(s - along) <= SAME for s in places):
                places[along] = int(label[k])
        cuts = sorted(places)
        for low, high in zip(cuts[:-1], cuts[1:]):
            line = np.array(substring(piece.line, low, high).coords)[:, :2]
            line[[0, -1]] = points[[first[places[low]], first[places[high]]]]
            ways.append(Way(LineString(line), (places[low], places[high]), number))
    return ways


def gaps(drawn: Sequence[Drawn], points: np.ndarray) -> np.ndarray:
    """Pairs of ends, drawn by eye, that go on in each other but for a gap; points: both ends of each line."""
    tree, pairs = cKDTree(points), []
    alone = tree.query_ball_point(points, SAME, return_length=True) == 1    # first, as nearly all ends meet others
    for k, j in sorted(tree.query_pairs(GAP)):
        if not (alone[k] and alone[j] and k // 2 != j // 2):
            continue
        one, other = (Way(drawn[end // 2].line, (0, 0), 0).leaves(end % 2) for end in (k, j))
        if turn(one, other) <= STRAIGHT and all(
                line.line.distance(Point(points[end])) > SAME for end in (k, j) for number, line in enumerate(drawn)
                if number != end // 2):
            pairs.append((k, j))
    return np.reshape(np.array(pairs, int), (-1, 2))


def at_nodes(ways: Sequence[Way]) -> Dict[int, List[End]]:
    """{node: the ends of ways there}."""
    found: Dict[int, List[End]] = {}
    for number, way in enumerate(ways):
        for end in (0, 1):
            found.setdefault(way.ends[end], []).append((number, end))
    return found


# --- junctions ---

def turn(direction: np.ndarray, other: np.ndarray) -> float:
    """Degrees by which a road turns that comes from one direction and leaves in another; both lead away."""
    return math.degrees(math.acos(max(-1.0, min(1.0, -float(direction @ other)))))


def kind(way: Way, other: Way, drawn: Sequence[Drawn]) -> int:
    """Why two ways that meet may be one road."""
    if way.drawn == other.drawn:
        return DRAWN
    return NAMED if drawn[way.drawn].words() & drawn[other.drawn].words() else ANY


def pair_up(ends: Sequence[End], ways: Sequence[Way], drawn: Sequence[Drawn], partner: Dict[End, End]) -> None:
    """Which ends at a node go on in each other; partner gets them, and has those that do already."""
    free = [end for end in ends if end not in partner]
    leaves = {end: ways[end[0]].leaves(end[1]) for end in free}
    found = sorted((kind(ways[one[0]], ways[other[0]], drawn), round(turn(leaves[one], leaves[other])),
                    sorted(np.round((leaves[one], leaves[other]), 6).tolist()), one, other)
                   for one, other in combinations(free, 2))
    for why, degrees, _, one, other in found:
        limit = {DRAWN: 180.0, NAMED: TURN}.get(why, STRAIGHT) if len(ends) > 2 else 180.0
        if degrees <= limit and one not in partner and other not in partner:
            partner[one], partner[other] = other, one


class Island(NamedTuple):
    """A loop of ways, in their order, each with the node at which it begins; outside: the ends that come to it."""
    ways: List[int]
    nodes: List[int]
    outside: Dict[int, List[End]]       # by node


def half_way(line: LineString) -> Point:
    return line.interpolate(0.5, normalized=True)


def islands(ways: Sequence[Way], nodes: Mapping[int, Sequence[End]]) -> Iterable[Island]:
    """Loops that a road passes: between two junctions, or of the size and shape of a roundabout."""
    by_ends: Dict[Tuple[int, ...], List[int]] = {}
    for number, way in enumerate(ways):
        by_ends.setdefault(tuple(sorted(way.ends)), []).append(number)
    for face in sorted(polygonize([way.line for way in ways]), key=lambda face: face.area):
        rim = face.exterior
        within = [number for number, way in enumerate(ways) if rim.distance(half_way(way.line)) <= SAME
                  and rim.buffer(SAME).contains(way.line)]
        order = in_order(within, ways)
        if order is None:
            continue
        numbers, starts = order
        outside = {node: [end for end in nodes[node] if end[0] not in within] for node in starts}
        outside = {node: ends for node, ends in outside.items() if ends}
        compact = rim.length <= LARGE and 4 * math.pi * face.area >= ROUND * rim.length ** 2
        if len(outside) == 2 or len(outside) > 2 and compact:
            yield Island(numbers, starts, outside)


def in_order(within: Sequence[int], ways: Sequence[Way]) -> Optional[Tuple[List[int], List[int]]]:
    """The ways of a loop one after the other, and the node at which each begins; None if they are no loop."""
    if not within:
        return None
    left, numbers = list(within[1:]), [within[0]]
    first, at = ways[within[0]].ends
    starts = [first]
    while left:
        step = next((number for number in left if at in ways[number].ends), None)
        if step is None:
            return None
        left.remove(step)
        starts.append(at)
        numbers.append(step)
        one, other = ways[step].ends
        at = other if at == one else one
    return (numbers, starts) if at == first else None


def pass_island(island: Island, ways: List[Way], drawn: Sequence[Drawn], partner: Dict[End, End]) -> None:
    """Join the roads that come to an island by one side of it; partner gets their ends."""
    if any((number, end) in partner for number in island.ways for end in (0, 1)):
        return          # a side of a larger one, that is passed already
    came = [(node, end) for node, ends in island.outside.items() for end in ends if end not in partner]
    if len(island.outside) == 2 and len(came) == 2:
        join(island, ways, drawn, partner, came[0], came[1])
        return
    if len(island.outside) == 2:
        return          # a block of streets
    middle = np.mean([half_way(ways[number].line).coords[0][:2] for number in island.ways], axis=0)
    out = {}
    for node, end in came:
        way = ways[end[0]]
        away = np.array(way.line.coords[0 if end[1] == 0 else -1][:2]) - middle
        out[end] = away / max(float(np.hypot(*away)), 1e-12)
    found = sorted((kind(ways[one[1][0]], ways[other[1][0]], drawn), round(turn(out[one[1]], out[other[1]])),
                    one, other) for one, other in combinations(came, 2))
    for why, degrees, one, other in found:
        if one[1] not in partner and other[1] not in partner and degrees <= (TURN if why < ANY else STRAIGHT):
            join(island, ways, drawn, partner, one, other)


def join(island: Island, ways: List[Way], drawn: Sequence[Drawn], partner: Dict[End, End], left: Tuple[int, End],
         other: Tuple[int, End]) -> None:
    """Join two ends at nodes of an island by the better side; a side that is taken by another road, once more."""
    (start, first), (stop, last) = left, other
    at, count = island.nodes.index(start), len(island.ways)
    to = island.nodes.index(stop)
    ahead = [island.ways[(at + k) % count] for k in range((to - at) % count)]
    back = [island.ways[(at - 1 - k) % count] for k in range((at - to) % count)]

    def rank(side: List[int]):
        ends = oriented(side, start, ways)
        turns = turn(ways[first[0]].leaves(first[1]), ways[ends[0][0]].leaves(ends[0][1])) + turn(
            ways[last[0]].leaves(last[1]), ways[ends[-1][0]].leaves(1 - ends[-1][1]))
        why = kind(ways[first[0]], ways[side[0]], drawn) + kind(ways[last[0]], ways[side[-1]], drawn)
        return max(why, 2 * NAMED), round(turns / ALIKE), sum(ways[k].line.length for k in side), side
    side = min((ahead, back), key=rank)
    ends = oriented(side, start, ways)
    if any(end in partner or (end[0], 1 - end[1]) in partner for end in ends):
        copies = []
        for number, end in ends:
            ways.append(ways[number])
            copies.append((len(ways) - 1, end))
        ends = copies
    before = first
    for number, end in ends:
        partner[before], partner[(number, end)] = (number, end), before
        before = (number, 1 - end)
    partner[before], partner[last] = last, before


def oriented(side: Sequence[int], start: int, ways: Sequence[Way]) -> List[End]:
    """Ways one after the other from a node: the end of each at which it is come to."""
    found, at = [], start
    for number in side:
        end = 0 if ways[number].ends[0] == at else 1
        found.append((number, end))
        at = ways[number].ends[1 - end]
    return found


# --- roads ---

def chains(ways: Sequence[Way], partner: Mapping[End, End]) -> Iterable[List[End]]:
    """Ways that go on in each other, one after the other: each with the end at which it is come to."""
    done: Set[int] = set()
    for number in range(len(ways)):
        if number in done:
            continue
        end: End = (number, 0)
        seen = {number}
        while end in partner and partner[end][0] not in seen:       # back to where it begins
            before = partner[end]
            seen.add(before[0])
            end = (before[0], 1 - before[1])
        chain, seen = [], set()
        while end[0] not in seen:
            seen.add(end[0])
            chain.append(end)
            out = (end[0], 1 - end[1])
            if out not in partner:
                break
            end = partner[out]
        done |= seen
        yield chain


def as_roads(chain: Sequence[End], ways: Sequence[Way], drawn: Sequence[Drawn]) -> List[One]:
    """The road of a chain; two, parted where they are least likely to be one, where it would cross itself."""
    parts = [np.asarray(ways[number].line.coords)[::1 if end == 0 else -1] for number, end in chain]
    line = LineString(np.concatenate([parts[0], *(part[1:] for part in parts[1:])]))
    with_it = sum(ways[number].line.length * (1 if end == 0 else -1) for number, end in chain)
    if with_it < 0 or with_it == 0 and chain[0][1] == 1:
        line = LineString(line.coords[::-1])
    if len(chain) > 1 and not line.is_simple and len({ways[number].drawn for number, _ in chain}) > 1:
        joints = [(kind(ways[one[0]], ways[other[0]], drawn),
                   turn(ways[one[0]].leaves(1 - one[1]), ways[other[0]].leaves(other[1]))) for one, other in
                  zip(chain[:-1], chain[1:])]
        at = 1 + joints.index(max(joints))
        return [*as_roads(chain[:at], ways, drawn), *as_roads(chain[at:], ways, drawn)]
    lengths: Dict[str, float] = {}
    for number, _ in chain:
        name = drawn[ways[number].drawn].name
        lengths[name] = lengths.get(name, 0.0) + ways[number].line.length
    names = sorted((name for name in lengths if name), key=lambda name: -lengths[name])
    return [One(line, tuple(names), frozenset().union(*(drawn[ways[number].drawn].words() for number, _ in chain)))]


def meetings(roads: Sequence[One]) -> List[Tuple[int, int, Point]]:
    """Which roads meet or cross all the same, and where first."""
    found = []
    for (k, one), (j, other) in combinations(enumerate(roads), 2):
        if one.line.distance(other.line) <= SAME:
            common = one.line.buffer(SAME).intersection(other.line)
            found.append((k, j, Point(getattr(common, "geoms", [common])[0].coords[0])))
    return found


def side_by_side(roads: Sequence[One], width: float) -> List[List[int]]:
    """Which roads are the carriageways of one: of one name, or without any and next to each other."""
    pairs = [(k, j) for (k, one), (j, other) in combinations(enumerate(roads), 2)
             if (one.words & other.words or not one.words | other.words)
             and is_beside(one.line, other.line, APART if one.words else WIDTHS * width)]
    if not pairs:
        return []
    rows, columns = np.transpose(pairs)
    number, label = connected_components(coo_matrix((np.ones(len(pairs)), (rows, columns)), (len(roads),) * 2),
                                         directed=False)
    groups = [np.flatnonzero(label == one).tolist() for one in range(number)]
    return [group for group in groups if len(group) > 1]


def is_beside(line: LineString, other: LineString, apart: float) -> bool:
    """Whether the shorter of two lines runs along the other for half of its length or more, no farther than that."""
    short, long = sorted((line, other), key=lambda line: line.length)
    chord = math.dist(short.coords[0][:2], short.coords[-1][:2])
    if short.length < ARC and chord < BENT * short.length:
        return False        # the other side of a roundabout
    step, near, angles = short.length / STATIONS, 0, []
    for s in (np.arange(STATIONS) + 0.5) * step:
        here = short.interpolate(s)
        at = long.project(here)
        if long.distance(here) > apart or not 0 < at < long.length:
            continue        # beyond its end is not beside it
        near += 1
        mine, its = (np.subtract(line.interpolate(place + step / 2).coords[0][:2],
                                 line.interpolate(max(0.0, place - step / 2)).coords[0][:2])
                     for line, place in ((short, s), (long, at)))
        size = float(np.hypot(*mine) * np.hypot(*its))
        angles.append(math.degrees(math.acos(min(1.0, abs(float(mine @ its)) / size))) if size else 90.0)
    return near >= BESIDE * STATIONS and float(np.median(angles)) <= PARALLEL
