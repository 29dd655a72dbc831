"""Reading lines (GeoJSON, shapefile, WKT, CSV) to the local metres of a run: the axis of a road, a section."""
import re

import numpy as np
from shapely import wkt
from shapely.errors import ShapelyError
from shapely.geometry import GeometryCollection, LineString, MultiLineString, box
from shapely.ops import linemerge, unary_union

from ..errors import SlopeError
from ..findings import Finding
from ..geometry import extent
from . import polygons, text_points, vectors
from .crs import require_degrees, same_crs, transform
from .network import Drawn
from .rasters import crs_name


SAME = 1e-9     # of a length, by which lines that are the same may differ


def lines_of(geometry):
    """The lines in a geometry as a MultiLineString, joined where they touch."""
    lines = parts_of(geometry)
    return joined(lines) if len(lines) > 1 else MultiLineString(lines)


def parts_of(geometry):
    """The lines in a geometry, a list of LineStrings."""
    if geometry.geom_type in ("LineString", "LinearRing"):
        return [] if geometry.is_empty else [LineString(geometry.coords)]
    return [line for part in getattr(geometry, "geoms", ()) for line in parts_of(part)]


def joined(lines):
    merged = linemerge(lines)
    return MultiLineString(list(getattr(merged, "geoms", [merged])))


def remove_doubled_lines(lines):
    """Lines with what is drawn more than once, or there and back, drawn once; which share of the length that is.

    Each with the number of the first of the lines there, whose direction it has.
    """
    whole = unary_union(lines)
    share = 1 - whole.length / sum(line.length for line in lines)
    if share <= SAME:
        return [(line, number) for number, line in enumerate(lines)], 0.0
    return [directed(line, lines) for line in parts_of(whole)], share


def directed(line, lines):
    """A line in the direction in which the first of the lines that it is part of passes there, and which that is."""
    begin, end = (LineString(line.coords[:2]).interpolate(share, normalized=True) for share in (1 / 3, 2 / 3))
    number = next((k for k, one in enumerate(lines) if one.distance(begin) <= SAME * one.length), 0)
    first = lines[number]
    return (line if first.project(begin) < first.project(end) else LineString(line.coords[::-1])), number


def read_local(path, raster, local, what="line", advice=None, crs=None, warn=vectors.ignore,
               instead="draw one, as the outline of an area has no forward and back"):
    """The lines in a file, a MultiLineString in the local metres of a run, drawn in the file's direction.

    A CSV (x,y in its lines) or WKT is in the CRS of the run's terrain; local: coordinates of any file are local metres
    already; crs: the CRS of the file, whatever it names. what: what the line is, for messages; advice: a
    polygons.Advice for those on a missing CRS; warn is called with a line for each doubt. Raises SlopeError, which
    names the file; instead: its remedy for a file of polygons.
    """
    return lines_of(MultiLineString([one.line for one in read_drawn(path, raster, local, what, advice, crs, warn,
                                                                    instead)]))


def read_drawn(path, raster, local, what="line", advice=None, crs=None, warn=vectors.ignore, instead=""):
    """The same lines as they are drawn, a list of Drawn with the attributes of their features."""
    vectors.require_file(path)
    text_ = polygons.read_text(path)
    own = raster.crs
    if text_ is not None:
        text_, named = vectors.plain_text(path, text_)
        crs = crs or (None if local else named)
    if text_ is None:
        found = vectors.read_vector_layer(path, "Line", warn)
        own = None if local or crs else found.known_crs(path, (advice or polygons.ADVICE).wrong_crs)
        geometry, abouts = GeometryCollection([one for _, one in found.features]), found.attributes
    else:
        geometry, unit = text_geometry(path, text_)
        polygons.check_unit(path, unit, local, crs, advice or polygons.ADVICE)
        geometry = GeometryCollection(list(getattr(geometry, "geoms", [geometry])))
        abouts = [{}] * len(geometry.geoms)
    each = [(line, about) for one, about in zip(geometry.geoms, abouts) for line in parts_of(one)]
    parts = [line for line, _ in each]
    lines = MultiLineString(parts)
    if lines.is_empty and (others := kinds(geometry)):
        raise SlopeError(path, f"must hold a line: {instead if 'Polygon' in others else 'draw one'}",
                         f"only {others}")
    if lines.is_empty or not all(np.isfinite(line.coords).all() for line in lines.geoms) or lines.length == 0:
        raise SlopeError(path, "must hold a line of a length > 0")
    others = [one for one in getattr(geometry, "geoms", []) if not parts_of(one)]
    if left_out := kinds(GeometryCollection(others)):
        warn(Finding("no line", {"file": path, "kinds": left_out}))
    pieces, twice = remove_doubled_lines(parts)
    if twice:
        warn(Finding("drawn twice", {"file": path, "percent": 100 * twice}))
    attributes = [each[number][1] for _, number in pieces]
    lines = MultiLineString([line for line, _ in pieces])
    local = local or text_ is not None and polygons.is_local(path, text_, raster)
    plain = text_ is not None and crs is None
    crs = crs or own
    if not (local or plain or crs is None):
        require_degrees(crs, lines.bounds, path, (advice or polygons.ADVICE).wrong_crs)
    check_order(path, lines, raster, local, None if plain else crs)
    points = [np.asarray(line.coords)[:, :2] for line in lines.geoms]
    if local:
        return [Drawn(*one) for one in zip(map(LineString, points), attributes)]
    if not plain and (crs is None or raster.crs is None):
        where, remedy = "--terrain", f"--local if the {what} is in the run's local metres"
        if advice:
            where, remedy = advice.terrain, advice.polygon_crs if crs is None else advice.terrain_crs
        raise SlopeError(path if crs is None else where, f"must have a CRS, so that {what} and deposit can be brought "
                         f"together ({remedy})", "none")
    if not same_crs(crs, raster.crs):
        points = [np.transpose(transform(crs, raster.crs, *line.T)) for line in points]
        if not all(np.isfinite(line).all() for line in points):
            raise SlopeError(path, f"must lie where {crs_name(raster.crs)}, the CRS of the terrain, covers it")
        if polygons.is_cut(lines, crs):
            points = [np.asarray(line.coords) for line in polygons.snapped(map(LineString, points))]
    return [Drawn(*one) for one in zip((LineString(line - raster.offset) for line in points), attributes)]


def check_order(path, lines, raster, local, crs):
    """Raise SlopeError if lines miss the terrain, and would not with x and y exchanged; crs: None of the terrain's."""
    bounds = getattr(raster, "extent", None) or extent(raster)

    def placed(given):
        points = [np.asarray(line.coords)[:, :2] for line in given.geoms]
        if not (local or crs is None or same_crs(crs, raster.crs)):
            points = [np.transpose(transform(crs, raster.crs, *line.T)) for line in points]
        return MultiLineString([line - (0.0 if local else raster.offset) for line in points])

    try:
        there = placed(lines)
    except polygons.NO_PLACE:
        return
    if not there.intersects(box(*bounds)) and polygons.fits_exchanged(lines, placed, bounds):
        raise SlopeError(path, f"must overlap the terrain{polygons.EXCHANGED}, local x y {polygons.decimetres(bounds)}",
                         polygons.decimetres(there.bounds))


def text_geometry(path, text):
    """The geometry of a text, WKT or x,y in its lines with a blank line between two lines, and the unit of its head."""
    def fail(place, rule, got):
        raise SlopeError(path, f"must be a line: GeoJSON, shapefile, WKT, or CSV with x,y in its lines (line {place} "
                         f"{rule})", got)
    try:
        if polygons.WKT.match(re.sub("#.*", "", text).lstrip()):
            each = [wkt.loads(one) for _, one in vectors.statements(text)]
            return each[0] if len(each) == 1 else GeometryCollection(each), None
        found = text_points.read_text_points(text, fail)
        return MultiLineString([[point for _, point in block] for block in found.blocks]), found.head.unit
    except (ShapelyError, ValueError, TypeError, AttributeError) as error:
        raise SlopeError(path, "must be a line: GeoJSON, shapefile, WKT, or CSV with x,y in its lines "
                         f"({error})") from error


def kinds(geometry):
    """The types of the geometries in a geometry, as words."""
    parts = getattr(geometry, "geoms", [geometry])
    return " and ".join(sorted({part.geom_type for part in parts if not part.is_empty}))
