"""The axis of a road, and the deposit along it."""
import functools
import math
from typing import List

import numpy as np
from shapely import wkb
from shapely.affinity import rotate
from shapely.geometry import LineString, MultiLineString, MultiPolygon, Point
from shapely.ops import substring

from .. import geometry
from ..errors import SlopeError
from ..findings import Finding
from ..survey import vectors
from ..survey.lines import lines_of
from ..survey.roads import SLACK
from .axis import SAME, Axis, Span, merged

EACH = 10.0            # m of chainage, whose volumes on the road are told apart
STATIONS = 500, 5000   # cross sections of a curved road, at least and at most;
APART = 2.0            # m between two of them
STRAIGHT = 0.98        # share of the centre line of a straight road that lies in the road
FOLLOWED = 0.9         # of a road's part in a grid: so much of it the axis of the whole road must follow


def middle(road):
    """The road's middle, and how it was found: the centre line of its smallest rectangle, where that lies in the road,

    else the middles of its cross sections, square to the long side of that rectangle. Where there is no road, as at a
    tunnel between two polygons, there is no axis, but chainage (number_axes). A study has one road.
    """
    return _middle(road.wkb)


@functools.lru_cache(maxsize=8)
def _middle(of):
    road = wkb.loads(of)
    corners = np.array(road.minimum_rotated_rectangle.exterior.coords)[:4]
    sides = np.hypot(*(corners - np.roll(corners, -1, axis=0)).T)
    if sides[0] > sides[1]:
        corners = np.roll(corners, -1, axis=0)  # the first side is a short one
    ends = (corners[:2].mean(axis=0), corners[2:].mean(axis=0))
    angle = math.degrees(math.atan2(*(ends[1] - ends[0])[::-1]))
    level = rotate(road, -angle, origin=(0, 0))
    several = polygons_along(level)
    if len(several) > 1:
        found = [_middle(rotate(one, angle, origin=(0, 0)).wkb) for one in several]
        return eastward(MultiLineString([line for lines, _ in found for line in lines.geoms])), \
            " and ".join(dict.fromkeys(source for _, source in found))
    inside = lines_of(LineString(ends).intersection(road))
    if inside.length >= STRAIGHT * max(sides):
        return eastward(inside), "centre line of the road's smallest rectangle"
    west, south, east, north = level.bounds
    tiny = 1e-9 * (east - west)
    points = []
    for x in np.linspace(west + tiny, east - tiny, int(np.clip((east - west) / APART, *STATIONS))):
        chords = lines_of(LineString([(x, south - 1), (x, north + 1)]).intersection(level)).geoms
        if chords:
            points.append(max(chords, key=lambda chord: chord.length).interpolate(0.5, normalized=True).coords[0])
    return eastward(rotate(lines_of(LineString(points)), angle, origin=(0, 0))), "middles of the road's cross sections"


def polygons_along(level):
    """The polygons of a road whose long side is level, those together between which there is no gap along it."""
    each = [(Span(one.bounds[0], one.bounds[2]), one) for one in geometry.polygons_of(level)]
    return [MultiPolygon([one for span, one in each if part.low <= span.low <= part.high])
            for part in merged([span for span, _ in each], SAME)]


def axes_of(lines, polygon, asked, raster, warn=vectors.ignore):
    """The axis of a road in a grid, a list of Axis, and how it was found; lines: none of a road of polygons.

    Chainage is that of the whole road, also of what lies beyond the grid. asked: roads.Asked.
    """
    if lines:
        return in_grid(number_axes(lines, asked.start), raster), "the road's line" if len(lines) == 1 else \
            "the lines of its carriageways, one after the other"
    axis, source = middle(polygon)
    axes, inside = in_grid(number_axes(axis.geoms, asked.start), raster), part_in_grid(polygon, raster)
    if inside is not polygon:
        part, source_of_part = middle(inside)
        if length_in(inside, axes) < FOLLOWED * part.intersection(inside).length:
            warn(Finding("chainage from the edge", {}))
            return number_axes(part.geoms, asked.start), f"{source_of_part}, of its part in the grid"
    return axes, source


def part_in_grid(polygon, raster):
    """The part of polygons (local metres) that lies in a grid; the same object where all of them do."""
    grid = geometry.box_of(raster)
    return polygon if grid.covers(polygon) else geometry.as_multi(polygon.intersection(grid))


def length_in(polygon, axes):
    """m of axes in polygons."""
    return sum(axis.whole.intersection(polygon).length for axis in axes)


def width_of(axes, polygon):
    """The mean width (m) of polygons along their axes."""
    return polygon.area / (length_in(polygon, axes) or sum(axis.whole.length for axis in axes))


def eastward(lines):
    """The lines, each and all of them from west to east (from south to north if they run more that way)."""
    west, south, east, north = lines.bounds
    way = np.array([1.0, 0.0]) if east - west >= north - south else np.array([0.0, 1.0])
    turned = [np.asarray(line.coords)[:, :2] for line in lines.geoms]
    turned = [line if way @ (line[-1] - line[0]) >= 0 else line[::-1] for line in turned]
    return MultiLineString(sorted(turned, key=lambda line: tuple(way @ line.T)[0]))


def axes_of_lines(lines, asked, raster, path):
    """The lines of an axis in a grid, each an Axis; SlopeError, which names its file, if none lies there."""
    axes = in_grid(number_axes(eastward(lines).geoms, asked.start), raster)
    if not axes:
        raise SlopeError(path, "axis of the road must lie in the grid of the run",
                         geometry.format_numbers(lines.bounds))
    return axes


def number_axes(lines, start):
    """Lines of an axis, each an Axis; chainage runs on from one to the next, from a start (km).

    Where the next begins ahead of the end, as beyond a tunnel, the distance between them counts, too; so it does not
    of a carriageway that begins beside another.
    """
    axes: List[Axis] = []
    at = 1000 * start
    for line in lines:
        new = Axis(line.coords, at)
        if axes:
            last, gap = axes[-1], new.points[0] - axes[-1].points[-1]
            if last.unit[-1] @ gap > 0 and new.unit[0] @ gap > 0:
                new = Axis(line.coords, at + math.hypot(*gap))
        axes.append(new)
        at = new.s[-1]
    return axes


def in_grid(axes, raster):
    """The parts of axes that lie in a grid, each with its chainage."""
    grid, parts = geometry.box_of(raster), []
    for axis in axes:
        if grid.buffer(SLACK, join_style=2).covers(axis.whole):
            parts.append(axis)
            continue
        crossed = geometry.coordinates(axis.whole.intersection(grid.exterior))
        ends = [axis.whole.project(Point(one)) for one in crossed]
        ends = np.unique([0.0, *ends, axis.whole.length])
        inside = [Span(low, high) for low, high in zip(ends, ends[1:])
                  if high - low > SAME and grid.covers(axis.whole.interpolate((low + high) / 2))]
        parts += [Axis(substring(axis.whole, *one).coords, axis.s[0] + one.low) for one in merged(inside, SAME)]
    return parts


def by_chainage(run_, road, axes):
    """[from (m), m3 on the road] of each EACH m of chainage on which a deposit lies: cells by their middles.

    road: polygons in the grid; axes: of axes_of().
    """
    raster = run_.raster
    volume = geometry.shares_of_cells(road, raster) * raster.z * run_.cell ** 2
    row, column = np.nonzero(volume > 0)
    if not len(row):
        return []
    s, n = np.array([axis.locate(*(raster.transform @ (column + 0.5, row + 0.5))) for axis in axes]).swapaxes(0, 1)
    s = np.minimum(s, [[axis.s[-1] - SAME] for axis in axes])
    part = np.floor(s[np.abs(n).argmin(axis=0), np.arange(len(row))] / EACH).astype(int)
    found, inverse = np.unique(part, return_inverse=True)
    return [[EACH * at, held] for at, held in zip(found.tolist(), np.bincount(inverse, volume[row, column]).tolist())]


def profile_road(axes, run_, removed, asked, road=None):
    """Profile along the axis, a dict of arrays: one entry per cell that it crosses. Lengths are exact.

    axes: of axes_of(); asked: roads.Asked; road: polygons, beside which nothing is blocked; None: the axis is nowhere
    beside it.
    """
    shape = run_.raster.z.shape
    parts = [np.asarray(geometry.to_index(axis.whole, run_.raster).coords)[:, :2] for axis in axes]
    start, end = np.concatenate([part[:-1] for part in parts]), np.concatenate([part[1:] for part in parts])
    edge, a, b = geometry.pieces(np.arange(shape[1] + 1.0), np.arange(shape[0] + 1.0), start, end)
    length = np.hypot(*(b - a).T)
    edge, a, b, length = edge[length > 0], a[length > 0], b[length > 0], length[length > 0]
    centre = (a + b) / 2
    # an axis on the line between two cells: the thicker one counts
    beside = 1e-6 * ((b - a) / length[:, None])[:, ::-1] * [1, -1]
    sides = [np.clip((centre + way * beside).astype(int), 0, np.array(shape[::-1]) - 1) for way in (1, -1)]
    thickness = [run_.raster.z[side[:, 1], side[:, 0]] for side in sides]
    column, row = np.where((thickness[0] >= thickness[1])[:, None], sides[0], sides[1]).T
    length = length * run_.cell
    to = np.cumsum(length)
    of = np.repeat(np.arange(len(axes)), [len(axis.lengths) for axis in axes])[edge]
    first = np.searchsorted(of, np.arange(len(axes)))
    to += (np.array([axis.s[0] for axis in axes]) - (to - length)[first])[of]
    x, y = run_.raster.transform @ tuple(centre.T)
    thickness = run_.raster.z[row, column]
    on_road = True if road is None or not any(road.intersects(axis.whole) for axis in axes) else np.array([
        road.intersects(Point(place)) for place in zip(x, y)])
    return {"from": to - length, "to": to, "x": x, "y": y, "ground": run_.base[row, column], "thickness": thickness,
            "removed": removed[row, column], "blocked": ((thickness > asked.blocked) & on_road).astype(int)}


def find_profile_stretches(profile):
    """Blocked stretches of a profile: list of (from, to); none goes on beyond a gap of the axis."""
    return [tuple(span) for span in merged([Span(start, to) for start, to, blocked in zip(
        profile["from"], profile["to"], profile["blocked"]) if blocked], SAME)]
