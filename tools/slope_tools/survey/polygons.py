"""Reading polygons (GeoJSON, shapefile, CSV, WKT) to the local metres of a terrain: the one place that does it.

The deck's own format, which `region polygon` reads and write_polygon() writes: rings of lines `x,y`, a blank line
between two rings, # starts a comment. A point is inside if it is inside an odd number of rings, so that holes are
rings, too.
"""
import logging
import re
from contextlib import suppress
from pathlib import Path
from typing import List, NamedTuple, Tuple

import numpy as np
import rasterio.warp
from shapely import wkt
from shapely.affinity import affine_transform
from shapely.errors import ShapelyError
from shapely.geometry import MultiPolygon, Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.ops import snap, unary_union
from shapely.validation import explain_validity

from .. import disk
from ..errors import SlopeError
from ..geometry import extent, format_numbers, polygons_of
from . import text_points, vectors
from .crs import require_degrees, same_crs
from .text_points import FARTHEST
from .rasters import crs_name

AT_180 = 1e-6      # degrees, from 180, at which a geometry is cut there
CUT = 1e-3         # m, between the halves of a cut geometry in another CRS
DIGITS = 6     # decimals of a written coordinate, m: beyond them is the noise of origins and projections
EXCHANGED = " (with x and y exchanged it would)"
NO_PLACE = (SlopeError, ShapelyError, ValueError)       # raised for points where a CRS has no coordinates
HEAD = "local metres:"       # in the first line of what write_polygon() wrote
PLACE = re.compile(rf"^# {HEAD} .+", re.MULTILINE)
WKT = re.compile(vectors.KINDS, re.IGNORECASE)


class Advice(NamedTuple):
    """What messages call the terrain, and what a user of the command can do."""
    terrain: str = "--terrain"
    terrain_crs: str = "slope terrain --crs gives it one; --local if all is in the terrain's local metres"
    polygon_crs: str = "a .prj file beside a shapefile; --local if it is in the terrain's local metres"
    wrong_crs: str = "--assign-crs EPSG:n of slope polygon overrides a CRS that is wrong or missing"


ADVICE = Advice()
OF_ASSIGN_CRS = Advice(polygon_crs=f"--assign-crs EPSG:n; {ADVICE.polygon_crs}",      # of commands with that option
                       wrong_crs="--assign-crs EPSG:n overrides a CRS that is wrong or missing")

for library in ("fiona", "shapely"):  # what they log is in the exceptions as well, or of no interest
    logging.getLogger(library).setLevel(logging.CRITICAL + 1)


def read_local(path, raster, local=False, crs=None, advice=ADVICE, warn=vectors.ignore):
    """Polygons of a file in the local metres of a terrain: a valid, not empty shapely Polygon or MultiPolygon.

    raster: the terrain, a Raster of rasters.read_asc_local() or a Place of rasters.read_place(). Format by content and
    suffix: the deck's format (.csv), text with WKT, else what fiona opens. Coordinates of a file with a CRS are
    reprojected to the terrain's; those of CSV and WKT are taken to be in the terrain's CRS, but of a file that
    write_polygon() wrote, which are local already. local=True: the file's coordinates are local, whatever CRS it names.
    crs: the CRS of the file, whatever it names; a layer of it: FILE|layername=NAME. Polygons that overlap or touch
    become one. warn is called with a line for each doubt. Raises SlopeError, which names file and place.
    """
    vectors.require_file(path)
    try:
        return _read_local(path, raster, local, crs, advice, warn)
    except ShapelyError as error:     # GEOS gives up on coordinates such as 1e-320 among others
        raise SlopeError(path, "must be polygons whose points differ by more than rounding") from error


def _read_local(path, raster, local, crs, advice, warn):
    text = read_text(path)
    if text is not None:
        text, named = vectors.plain_text(path, text)
        crs = crs or (None if local else named)
    if text is None:
        polygons, own = _read_layer(path, warn, None if local or crs else advice)
    elif WKT.match(re.sub("#.*", "", text).lstrip()):
        polygons, own = _read_wkt(path, text), raster.crs
    else:
        (polygons, unit), own = _read_rings(path, text), raster.crs
        local = local or is_local(path, text, raster)
        check_unit(path, unit, local, crs, advice)
    plain = not local and text is not None and crs is None      # numbers of which no file says what they are
    return _placed(path, polygons, raster, local, plain, crs or own, advice)


def of_feature(where, geometry, raster, crs, advice=ADVICE, anywhere=False, local=False):
    """What read_local() gives, of one geometry of a vectors.Found; where: its file and feature, for messages.

    anywhere: it may lie beside the terrain; local: it is in the terrain's local metres.
    """
    try:
        parts = _parts(where, geometry)
        if not parts:
            raise SlopeError(where, "must hold a polygon, it is empty")
        return _placed(where, parts, raster, local, False, crs, advice, anywhere)
    except ShapelyError as error:
        raise SlopeError(where, "must be polygons whose points differ by more than rounding") from error


def _placed(path, polygons, raster, local, plain, crs, advice, anywhere=False):
    """Polygons as one geometry in the local metres of a terrain, which it overlaps, unless it may be anywhere."""
    geometry = polygons[0] if len(polygons) == 1 else unary_union(polygons)
    as_it_stands = geometry.envelope
    if not local:
        geometry = _to_local(path, geometry, crs, raster, plain, advice)
    geometry = _checked(path, geometry)
    bounds = getattr(raster, "extent", None) or extent(raster)
    if not anywhere and geometry.intersection(box(*bounds)).area == 0:
        hint = " (with --local it would)" if plain and as_it_stands.intersection(box(*bounds)).area > 0 else ""
        if fits_exchanged(as_it_stands, lambda turned: turned if local else _to_local(path, turned, crs, raster, plain,
                                                                                      advice), bounds):
            hint = EXCHANGED
        read_as = "" if local or plain else (f", read as {crs_name(crs)}: is that right? The terrain is in "
                                             f"{crs_name(raster.crs)}; {advice.wrong_crs}")
        raise SlopeError(path, f"must overlap the terrain{hint}, local x y {decimetres(bounds)}",
                         decimetres(geometry.bounds) + read_as)
    return geometry


def fits_exchanged(geometry, to_local, bounds):
    """Whether a geometry, which to_local brings to a terrain's local metres, lies on it with x and y exchanged."""
    with suppress(*NO_PLACE):
        return to_local(affine_transform(geometry, [0, 1, 1, 0, 0, 0])).intersects(box(*bounds))
    return False


def decimetres(values):
    """Coordinates or bounds (m) in a message that says where something lies."""
    return format_numbers(round(float(value), 1) + 0.0 for value in values)


def read_text(path):
    """The text of a .csv, .txt, .wkt file; None for any other."""
    file = Path(vectors.source(path).path)
    if file.suffix.lower() not in (".csv", ".txt", ".wkt"):
        return None
    try:
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise SlopeError(path, f"must be text in UTF-8 ({error.reason} at byte {error.start})") from None
    except OSError as error:
        raise SlopeError(path, f"cannot be read: {error.strerror}") from None


# --- formats ---

def _read_layer(path, warn, advice):
    """Polygons of a file of a GIS, and its CRS or None; advice: None where the CRS does not matter."""
    found = vectors.read_vector_layer(path, "Polygon", warn)
    polygons = [part for where, geometry in found.features for part in _parts(where, geometry)]
    if not polygons:
        raise SlopeError(path, "must hold a polygon, it is empty")
    return polygons, found.known_crs(path, advice.wrong_crs) if advice else None


def _read_wkt(path, text):
    """Polygons of a text with one or several WKT, each of which may go over several lines."""
    polygons = []
    for first, statement in vectors.statements(text):
        where = f"{path}: line {first}"
        try:
            geometry = wkt.loads(statement)
        except (ShapelyError, ValueError, TypeError) as error:
            raise SlopeError(where, "must be WKT such as POLYGON ((x y, x y, x y, x y))", statement[:40]) from error
        polygons += _parts(where, geometry)
    if not polygons:
        raise SlopeError(path, "must hold a polygon, it is empty")
    return polygons


def _parts(where, geometry):
    """The polygons of a geometry of a file, in two dimensions; SlopeError if it is no good."""
    if geometry.is_empty:
        return []
    if geometry.geom_type == "GeometryCollection":
        return [part for inner in geometry.geoms for part in _parts(where, inner)]
    if geometry.geom_type not in ("Polygon", "MultiPolygon"):
        raise SlopeError(where, "must be a polygon", geometry.geom_type)
    geometry = map_points(geometry, lambda points: points)
    for part in polygons_of(geometry):
        for ring in (part.exterior, *part.interiors):
            if not (np.abs(ring.coords) <= FARTHEST).all():    # NaN, too
                raise SlopeError(where, f"coordinates must be finite numbers within +-{FARTHEST:g}")
    return polygons_of(_checked(where, geometry))


def _checked(where, geometry):
    if geometry.is_empty or geometry.convex_hull.area == 0:
        raise SlopeError(where, "must have an area > 0")
    if not geometry.is_valid:
        raise crossing(where, geometry)
    return geometry


def crossing(where, geometry):
    """The SlopeError on a geometry that is not valid: what is wrong, and at which point."""
    reason = explain_validity(geometry).replace("[", " at ").replace("]", "")
    return SlopeError(where, "must be polygons that do not cross or touch themselves", reason)


def _read_rings(path, text):
    """The polygons that the rings of a text in the deck's format make by the even-odd rule; the unit of its head."""
    rings: List[Tuple[int, Polygon]] = []       # the line it starts at, its polygon
    points = text_points.read_text_points(text, fail_in(path))
    for block in points.blocks:
        first, ring = block[0][0], [point for _, point in block]
        where = f"{path}: line {first}"
        if len(set(ring)) < 3:
            raise SlopeError(where, "a ring must have at least 3 points", len(set(ring)))
        rings.append((first, _checked(where, Polygon(ring))))
    if not rings:
        raise SlopeError(path, "must hold a polygon, it is empty")
    return _even_odd(path, rings), points.head.unit


def fail_in(path):
    """A function that raises the SlopeError on a line of a file."""
    def fail(place, rule, got):
        raise SlopeError(f"{path}: line {place}", rule, got)
    return fail


def check_unit(path, unit, local, crs, advice):
    """Raise SlopeError if the unit that the head of a text names is not that of its coordinates.

    crs: assigned to them; None: they are in metres, of the terrain's CRS.
    """
    degrees = not local and crs is not None and crs.is_geographic
    if unit == "degrees" and not degrees:
        raise SlopeError(path, "must have columns in m, local" if local else
                         f"columns in degrees must have a CRS in degrees; {advice.wrong_crs}",
                         "degrees" if local else crs_name(crs))
    if unit == "m" and degrees:
        raise SlopeError(path, "columns in m must have a CRS in m", crs_name(crs))


def _even_odd(path, rings):
    """Polygons of the rings (line, polygon): one inside of another is a hole, one inside of the hole an island."""
    rings.sort(key=lambda ring: -ring[1].area)  # what contains a ring comes before it
    bounds = np.array([polygon.bounds for _, polygon in rings])
    depth: List[int] = []
    holes: List[List[int]] = [[] for _ in rings]
    for i, (line, polygon) in enumerate(rings):
        low, high = bounds[:i, :2] < bounds[i, 2:], bounds[:i, 2:] > bounds[i, :2]
        around = []
        for j in np.flatnonzero((low & high).all(axis=1)):
            if rings[j][1].contains(polygon):
                around.append(j)
            elif rings[j][1].overlaps(polygon):
                x, y = rings[j][1].intersection(polygon).representative_point().coords[0]
                raise SlopeError(f"{path}: line {line}", f"a ring must not cross another one, line {rings[j][0]}",
                                 f"an overlap at {format_numbers((x, y))}")
        depth.append(len(around))
        if depth[i] % 2:
            holes[max(around, key=lambda j: depth[j])].append(polygon)
    shells = [(polygon, holes[i]) for i, (_, polygon) in enumerate(rings) if depth[i] % 2 == 0]
    return [part for polygon, inner in shells for part in polygons_of(_with_holes(polygon, inner))]


def _with_holes(polygon, holes):
    """A polygon without its holes, which may touch it and each other."""
    whole = Polygon(polygon.exterior, [hole.exterior for hole in holes])
    return whole if whole.is_valid else polygon.difference(unary_union(holes))


def is_local(path, text, raster):
    """Whether a text was written by write_polygon(); SlopeError if it was for a terrain at another place.

    A run without a terrain that tells its place (no CRS, origin 0 0) is in the local metres of whatever terrain.
    """
    place = PLACE.search(text)
    if not place:
        return False
    unknown = raster.crs is None and tuple(raster.offset) == (0, 0)
    if place.group(0) != place_line(raster) and not unknown:
        raise SlopeError(path, f"must be for this terrain ({place_line(raster)[2:]})", place.group(0)[2:])
    return True


def place_line(raster):
    east, north = (repr(float(value)) for value in raster.offset)
    return f"# {HEAD} east = x + {east}, north = y + {north}, CRS {crs_name(raster.crs)}"


# --- coordinates ---

def _to_local(path, geometry, crs, raster, plain, advice):
    """A geometry in a CRS to the local metres of the terrain. plain: text, which is in the terrain's CRS."""
    if not plain:
        for where, missing, remedy in ((path, crs, advice.polygon_crs),
                                       (advice.terrain, raster.crs, advice.terrain_crs)):
            if missing is None:
                raise SlopeError(where, "must have a CRS, so that polygon and terrain can be brought together "
                                 f"({remedy})", "none")
        require_degrees(crs, geometry.bounds, path, advice.wrong_crs)
    if not (plain or same_crs(crs, raster.crs)):
        moved = _reproject(path, geometry, crs, raster.crs)
        geometry = unary_union(snapped(polygons_of(moved))) if is_cut(geometry, crs) else moved
    return map_points(geometry, lambda points: points - raster.offset)


def is_cut(geometry, crs):
    """Whether a geometry has parts on both sides of 180 degrees, cut there as RFC 7946 demands."""
    west, _, east, _ = geometry.bounds
    return crs.is_geographic and abs(west + 180) < AT_180 and abs(east - 180) < AT_180


def snapped(parts):
    """Geometries (m) whose points that are within CUT of those of the ones before are the same points."""
    done: List[BaseGeometry] = []
    for part in parts:
        for other in done:
            part = snap(part, other, CUT)
        done = [snap(other, part, CUT) for other in done] + [part]
    return done


def _reproject(path, geometry, crs, target):
    def points_in_target(points):
        try:
            points = np.transpose(rasterio.warp.transform(crs, target, *points.T))
        except Exception:  # GDAL's, of a class that rasterio keeps private
            points = np.array([[np.nan, np.nan]])
        if not np.isfinite(points).all():
            raise SlopeError(path, f"must lie where {crs_name(target)}, the CRS of the terrain, covers it",
                             f"{format_numbers(geometry.bounds)} in {crs_name(crs)}")
        return points
    return map_points(geometry, points_in_target)


def map_points(geometry, function):
    """A (Multi)Polygon with the points that the function gives for all of its points at once, an array (number, 2)."""
    parts = polygons_of(geometry)
    rings = [np.asarray(ring.coords)[:, :2] for part in parts for ring in (part.exterior, *part.interiors)]
    points = function(np.concatenate(rings))
    moved = iter(np.split(points, np.cumsum([len(ring) for ring in rings])[:-1]))
    new = [Polygon(next(moved), [next(moved) for _ in part.interiors]) for part in parts]
    return new[0] if len(new) == 1 else MultiPolygon(new)


# --- the deck's format ---

def rings_of(geometry):
    """The rings of the polygons, arrays (number, 2) without the repeated first point; holes follow their shell."""
    return [np.asarray(ring.coords)[:-1, :2] for part in polygons_of(geometry)
            for ring in (part.exterior, *part.interiors)]


def write_polygon(path, geometry, raster):
    """Write a valid geometry in the local metres of a terrain to path, for region polygon; return it as it is written.

    The file is complete or not touched.
    """
    rounded = map_points(geometry, lambda points: np.round(points, DIGITS) + 0.0)  # + 0.0 because of -0.0
    if rounded.is_valid and rounded.area > 0:
        geometry = rounded
    rings = "\n".join("".join(f"{x!r},{y!r}\n" for x, y in ring.tolist()) for ring in rings_of(geometry))
    disk.write_file(path, f"{place_line(raster)}\n{rings}")
    return geometry
