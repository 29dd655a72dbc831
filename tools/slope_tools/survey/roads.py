"""Reading a road to the local metres of a terrain: polygons, or a line with a width; the one place that does it.

A file of a line keeps its direction: chainage runs along it. A CSV is rings without a width (polygons.py), with one the
points of a line.
"""
import re
from itertools import combinations
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from shapely.errors import ShapelyError
from shapely.geometry import LineString, Point, box
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points, unary_union

from .. import disk
from ..digits import rounded
from ..errors import SlopeError
from ..findings import Finding
from ..geometry import extent, format_numbers
from . import features, lines, network, polygons, vectors

ARCS = 45       # pieces of a quarter of a circle, outside of bends
GAP = 5.0       # m between two roads that nearly meet
SHOWN = 3       # places where roads meet, that are printed
SLACK = 1e-5    # m, beyond the terrain; written coordinates are rounded


class Road(NamedTuple):
    """A road in local metres."""
    polygon: BaseGeometry
    lines: Sequence[LineString] = ()    # none of a road that was given as polygons; several: carriageways, together

    @property
    def line(self) -> Optional[LineString]:
        """The first of them."""
        return self.lines[0] if self.lines else None


class Asked(NamedTuple):
    """What is asked of a road beside its file and the cut."""
    width: Optional[float] = None       # m, of a road that is a line; None: it is polygons
    start: float = 0.0                  # chainage of its start, km
    blocked: float = 0.1                # m; the road is blocked where the deposit is thicker
    lane: Optional[float] = None        # m, width of the lane that is to be opened first
    clearing: Optional[float] = None    # m3 of loosened ground that are cleared in an hour
    loosening: Optional[float] = None   # volume of loosened ground over that of the ground

    @classmethod
    def of(cls, entries: Mapping[str, Any]) -> "Asked":
        """That of site.yaml or study.yaml; what is missing, as in older ones, has its default."""
        return cls(**{field: entries[key] for field, key in KEYS.items() if entries.get(key) is not None})

    def about(self) -> Dict[str, Any]:
        """What of() reads."""
        return {key: getattr(self, field) for field, key in KEYS.items()}

    @property
    def hours(self) -> Optional[float]:
        """For one m3 of ground."""
        return self.loosening / self.clearing if self.loosening and self.clearing else None


NOTHING = Asked()
KEYS = {"width": "width", "start": "from", "blocked": "blocked", "lane": "lane", "clearing": "clearing",
        "loosening": "loosening"}       # in site.yaml and study.yaml
OPTIONS = {"width": "--road-width", "start": "--road-from", "blocked": "--blocked", "lane": "--lane",
           "clearing": "--clearing", "loosening": "--loosening"}
SHORTEST = 1.0          # m, of a line
WIDEST = 1000.0         # m: wider is no road, but a number in millimetres or a slip of the pen
WITHOUT_LINE = "leave out --road-width, which is that of a line"
WITHOUT_WIDTH = "is a line, whose width must be given: --road-width"
MARK = "# the line of a road, whose width is given apart"


def check_road(asked: Asked) -> None:
    """Raise SlopeError, which names the option, unless the values make sense together."""
    for field in ("width", "lane", "clearing"):
        value = getattr(asked, field)
        if value is not None and not value > 0:
            raise SlopeError(OPTIONS[field], "must be > 0", f"{value:g}")
    if asked.blocked < 0:
        raise SlopeError("--blocked", "must be >= 0", f"{asked.blocked:g}")
    if asked.loosening is not None and asked.loosening < 1:
        raise SlopeError("--loosening", "must be >= 1, volume of loosened ground over that of the ground",
                         f"{asked.loosening:g}")
    for given, other in (("clearing", "loosening"), ("loosening", "clearing")):
        if getattr(asked, given) is not None and getattr(asked, other) is None:
            raise SlopeError(OPTIONS[given], f"must be given with {OPTIONS[other]}", f"{getattr(asked, given):g}")
    if asked.width is not None:
        if asked.width > WIDEST:
            raise SlopeError(OPTIONS["width"], f"must be at most {WIDEST:g} m", f"{asked.width:g}")
        check_lane(asked.lane, asked.width)


def check_lane(lane: Optional[float], width: float) -> None:
    """Raise SlopeError if a lane is wider than the road; both in m."""
    if lane is not None and lane > width * (1 + 1e-6):
        raise SlopeError("--lane", f"must be at most as wide as the road, {width:.6g} m", f"{lane:g}")


def read_local(path, raster, asked: Asked = NOTHING, local=False, crs=None, advice=None,
               warn=vectors.ignore, instead=WITHOUT_LINE) -> Road:
    """The road of a file in the local metres of a terrain; arguments as of polygons.read_local(), which see.

    Raises SlopeError, which names the file, and for a line the chainage; instead: its remedy for a file of polygons.
    """
    vectors.require_file(path)
    if asked.width is None:
        try:
            if MARK not in (polygons.read_text(path) or ""):
                return Road(polygons.read_local(path, raster, local, crs, advice or polygons.ADVICE, warn))
        except SlopeError:
            if not is_line(path):
                raise
        raise SlopeError(path, WITHOUT_WIDTH)
    drawn = drawn_in(path, raster, local, crs, advice, warn, instead)
    if MARK in (polygons.read_text(path) or ""):
        return together(path, [one.line for one in drawn], raster, asked)
    found = network.roads_of(drawn)
    if len(found) != 1:
        met = network.meetings(found)
        raise SlopeError(path, "must hold one line, for --road-width" + "; save it alone" * bool(met), f"{len(found)} "
                         "that " + (f"meet {features.locate_feature(met[0][2], raster)}" if met else "do not meet"))
    return together(path, [found[0].line], raster, asked)


def read_each(path, raster, asked: Asked = NOTHING, crs=None, advice=None, warn=vectors.ignore) -> Dict[str, Road]:
    """The roads of a file by their names: polygons together are one; of lines see network.

    A road has the name of its file, or layer; one of several the names of its lines, or a number. Carriageways that
    run side by side are also a road together. Arguments and errors as of read_local().
    """
    where = vectors.source(path)
    own = where.layer or Path(where.path).stem
    if asked.width is None or MARK in (polygons.read_text(path) or ""):
        return {own: read_local(path, raster, asked, False, crs, advice, warn)}
    roads = network.roads_of(drawn_in(path, raster, False, crs, advice, warn))
    if len(roads) == 1:
        return {own: together(path, [roads[0].line], raster, asked)}
    names: List[str] = []
    made: Dict[str, Road] = {}
    for number, one in enumerate(roads, 1):
        names.append(free(", ".join(one.names) or f"{own}_{number}", made))
        made[names[-1]] = together(path, [one.line], raster, asked)
    for group in network.side_by_side(roads, asked.width):
        name = ", ".join(dict.fromkeys(name for k in group for name in roads[k].names[:1])) or own
        made[free(f"{name} {'both' if len(group) == 2 else 'all'} carriageways", made)] = together(
            path, [roads[k].line for k in group], raster, asked)
    return made


def meetings(several: Mapping[str, Tuple[str, Road]], raster) -> List[Finding]:
    """The roads of {name: (file, road)} that meet, or nearly do, and have no number together; the closest first.

    Ends that were drawn by eye, and pieces in files of their own, leave gaps.
    """
    pairs = [one.polygon.buffer(SLACK) for _, one in several.values() if len(one.lines) > 1]
    boxes = {name: box(*road.polygon.bounds).buffer(GAP) for name, (_, road) in several.items()}
    near = []
    for (name, (file, first)), (beside, (other_file, other)) in combinations(several.items(), 2):
        if not boxes[name].intersects(other.polygon):
            continue
        if max(len(first.lines), len(other.lines)) > 1 or first.polygon.distance(other.polygon) > GAP or any(
                both.contains(first.polygon) and both.contains(other.polygon) for both in pairs):
            continue
        ways = [road.line or road.polygon for road in (first, other)]
        near.append((round(ways[0].distance(ways[1]), 3),
                     f"{name} and {beside} {features.locate_feature(nearest_points(*ways)[0], raster)}",
                     (file, other_file), (name, beside)))
    if not near:
        return []
    near.sort(key=lambda entry: entry[0])
    return [Finding("roads meet", {
        "file": ", ".join(dict.fromkeys(file for one in near for file in one[2])),
        "roads": ", ".join(dict.fromkeys(name for one in near for name in one[3])),
        "places": "; ".join(one[1] for one in near[:SHOWN]) + f"; and {len(near) - SHOWN} more" * (
            len(near) > SHOWN)})]


def free(name: str, taken: Mapping[str, Any]) -> str:
    """A name, with a number if it is taken."""
    return next(one for one in (name, *(f"{name}_{k}" for k in range(2, len(taken) + 3))) if one not in taken)


def drawn_in(path, raster, local, crs, advice, warn, instead=WITHOUT_LINE) -> List[network.Drawn]:
    """The lines of a file as they are drawn, in local metres."""
    return lines.read_drawn(path, raster, local, "road", advice, crs, warn, instead)


def together(path, several: Sequence[LineString], raster, asked: Asked) -> Road:
    """The road of lines, each of them on the terrain: all that lies within half the width of one."""
    assert asked.width is not None
    for line in several:
        check_line(path, line, getattr(raster, "extent", None) or extent(raster), asked.start)
    return Road(unary_union([line.buffer(asked.width / 2, ARCS, cap_style=2) for line in several])
                if len(several) > 1 else several[0].buffer(asked.width / 2, ARCS, cap_style=2),
                tuple(several))


def is_line(path) -> bool:
    """Whether a file holds lines and no polygon, or is a CSV of too few points for one."""
    try:
        text = polygons.read_text(path)
        text = None if text is None else vectors.plain_text(path, text)[0]
        geometry = unary_union([one for _, one in vectors.read_vector_layer(path,
                                                                            "Line").features]) if text is None else \
            lines.text_geometry(path, text)[0]
        if text is not None and not polygons.WKT.match(re.sub("#.*", "", text).lstrip()):
            return sum(len(one.coords) for one in geometry.geoms) == 2
    except (SlopeError, ShapelyError):
        return False
    kinds = lines.kinds(geometry)
    return "Line" in kinds and "Polygon" not in kinds


def check_line(path, line: LineString, within, start: float) -> None:
    """Raise SlopeError if a line crosses itself, or leaves the terrain (local xlo, ylo, xhi, yhi); start: km.

    So it does where it is as good as a point, as degrees are that are taken for metres.
    """
    if line.length < SHORTEST:
        raise SlopeError(path, f"must be a line of {SHORTEST:g} m at least; are its coordinates in degrees? Then name "
                         "their CRS, such as EPSG:4326",
                         f"{rounded(line.length, 2)} m at {format_numbers(line.coords[0])}")

    def chainage(length):
        return f"{1000 * start + length:.1f} m"
    if not line.is_simple:
        noded = unary_union(line)
        crossed = min((Point(one.coords[-1]) for one in getattr(noded, "geoms", [noded])), key=line.project)
        raise SlopeError(path, "must be a line that does not cross itself; it does at the chainage "
                         f"{chainage(line.project(crossed))}", format_numbers(crossed.coords[0]))
    outside = line.difference(box(*within).buffer(SLACK))
    if not outside.is_empty:
        first = min((Point(one.coords[0]) for one in getattr(outside, "geoms", [outside])), key=line.project)
        raise SlopeError(path, f"must lie in the terrain, local x y {polygons.decimetres(within)}: give the part in "
                         f"it, or a larger terrain; it leaves it at the chainage {chainage(line.project(first))}",
                         polygons.decimetres(first.coords[0]))


def write_road(path: Path, road: Road, raster) -> BaseGeometry:
    """Write a road in the local metres of a terrain, for read_local() with the same width; its polygon as written."""
    if road.line is None:
        return polygons.write_polygon(path, road.polygon, raster)
    texts = []
    for line in road.lines:
        points = np.round(np.asarray(line.coords)[:, :2], polygons.DIGITS) + 0.0
        texts.append("".join(f"{x!r},{y!r}\n" for x, y in points.tolist()))
    disk.write_file(path, f"{polygons.place_line(raster)}\n{MARK}\n" + "\n".join(texts))
    return road.polygon
