"""The axis of a road, and the deposit along it."""
import functools
import math

import numpy as np
from shapely import wkb
from shapely.affinity import rotate
from shapely.geometry import LineString, MultiLineString, MultiPolygon, Point

from .. import geometry
from ..errors import SlopeError
from ..survey.lines import lines_of
from .axis import SAME, Axis, Span, merged

EACH = 10.0            # m of chainage, whose volumes on the road are told apart
STATIONS = 500         # cross sections of a curved road
STRAIGHT = 0.98        # share of the centre line of a straight road that lies in the road


def middle(road):
    """The road's middle, and how it was found: the centre line of its smallest rectangle, where that lies in the road,

    else the middles of its cross sections, square to the long side of that rectangle. Where there is no road, as at a
    tunnel between two polygons, there is no axis: what lies on either side has its own. A study has one road.
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
    for x in np.linspace(west + tiny, east - tiny, STATIONS):
        chords = lines_of(LineString([(x, south - 1), (x, north + 1)]).intersection(level)).geoms
        if chords:
            points.append(max(chords, key=lambda chord: chord.length).interpolate(0.5, normalized=True).coords[0])
    return eastward(rotate(lines_of(LineString(points)), angle, origin=(0, 0))), "middles of the road's cross sections"


def polygons_along(level):
    """The polygons of a road whose long side is level, those together between which there is no gap along it."""
    each = [(Span(one.bounds[0], one.bounds[2]), one) for one in geometry.polygons_of(level)]
    return [MultiPolygon([one for span, one in each if part.low <= span.low <= part.high])
            for part in merged([span for span, _ in each], SAME)]


def axis_of(lines, polygon, asked):
    """The lines of a road's axis, how it was found, and the road's width (m); lines: none of a road of polygons."""
    source = "the road's line" if len(lines) == 1 else "the lines of its carriageways, one after the other"
    axis, source = (MultiLineString(list(lines)), source) if lines else middle(polygon)
    return axis, source, asked.width or width_of(axis, polygon)


def width_of(axis, polygon):
    """The mean width (m) of polygons along an axis."""
    return polygon.area / (axis.intersection(polygon).length or axis.length)


def eastward(lines):
    """The lines, each and all of them from west to east (from south to north if they run more that way)."""
    west, south, east, north = lines.bounds
    way = np.array([1.0, 0.0]) if east - west >= north - south else np.array([0.0, 1.0])
    turned = [np.asarray(line.coords)[:, :2] for line in lines.geoms]
    turned = [line if way @ (line[-1] - line[0]) >= 0 else line[::-1] for line in turned]
    return MultiLineString(sorted(turned, key=lambda line: tuple(way @ line.T)[0]))


def in_grid_of(axis, raster, path):
    """The lines of an axis that lie in the grid; SlopeError, which names its file, if none does."""
    inside = lines_of(axis.intersection(geometry.box_of(raster)))
    if inside.is_empty:
        raise SlopeError(path, "axis of the road must lie in the grid of the run", geometry.format_numbers(axis.bounds))
    return eastward(inside)


def axes_of(axis, asked):
    """The lines of an axis, each an Axis; chainage runs on from one to the next. asked: roads.Asked."""
    found, start = [], 1000 * asked.start
    for line in axis.geoms:
        found.append(Axis(line.coords, start))
        start += line.length
    return found


def by_chainage(run_, road, axes):
    """[from (m), m3 on the road] of each EACH m of chainage on which a deposit lies: cells by their middles.

    road: polygons in the grid; axes: of axes_of().
    """
    raster = run_.raster
    lines = (np.arange(number + 1.0) for number in raster.z.shape[::-1])
    volume = geometry.coverage(geometry.to_index(road, raster), *lines)[0] * raster.z * run_.cell ** 2
    row, column = np.nonzero(volume > 0)
    if not len(row):
        return []
    s, n = np.array([axis.locate(*(raster.transform @ (column + 0.5, row + 0.5))) for axis in axes]).swapaxes(0, 1)
    s = np.minimum(s, [[axis.s[-1] - SAME] for axis in axes])
    part = np.floor(s[np.abs(n).argmin(axis=0), np.arange(len(row))] / EACH).astype(int)
    found, inverse = np.unique(part, return_inverse=True)
    return [[EACH * at, held] for at, held in zip(found.tolist(), np.bincount(inverse, volume[row, column]).tolist())]


def profile_road(axis, run_, removed, asked, road=None):
    """Profile along the axis, a dict of arrays: one entry per cell that it crosses. Lengths are exact.

    asked: roads.Asked, whose start is the chainage of the axis' first point; road: polygons, beside which nothing is
    blocked; None: the axis is nowhere beside it.
    """
    shape = run_.raster.z.shape
    parts = [np.asarray(line.coords)[:, :2] for line in geometry.to_index(axis, run_.raster).geoms]
    start, end = np.concatenate([part[:-1] for part in parts]), np.concatenate([part[1:] for part in parts])
    _, a, b = geometry.pieces(np.arange(shape[1] + 1.0), np.arange(shape[0] + 1.0), start, end)
    length = np.hypot(*(b - a).T)
    a, b, length = a[length > 0], b[length > 0], length[length > 0]
    centre = (a + b) / 2
    # an axis on the line between two cells: the thicker one counts
    beside = 1e-6 * ((b - a) / length[:, None])[:, ::-1] * [1, -1]
    sides = [np.clip((centre + way * beside).astype(int), 0, np.array(shape[::-1]) - 1) for way in (1, -1)]
    thickness = [run_.raster.z[side[:, 1], side[:, 0]] for side in sides]
    column, row = np.where((thickness[0] >= thickness[1])[:, None], sides[0], sides[1]).T
    length = length * run_.cell
    to = 1000 * asked.start + np.cumsum(length)
    x, y = run_.raster.transform @ tuple(centre.T)
    thickness = run_.raster.z[row, column]
    on_road = True if road is None or not road.intersects(axis) else np.array([
        road.intersects(Point(place)) for place in zip(x, y)])
    return {"from": to - length, "to": to, "x": x, "y": y, "ground": run_.base[row, column], "thickness": thickness,
            "removed": removed[row, column], "blocked": ((thickness > asked.blocked) & on_road).astype(int)}


def find_profile_stretches(profile):
    """Blocked stretches of a profile: list of (from, to)."""
    step = np.diff(np.concatenate([[0], profile["blocked"], [0]]))
    return [(profile["from"][a], profile["to"][b - 1])
            for a, b in zip(np.flatnonzero(step == 1), np.flatnonzero(step == -1))]
