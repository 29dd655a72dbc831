"""Zones of a site's ground, with a friction, rolling resistance, restitution or spacing of their own.

In: polygons of a GIS with these as attributes, or a raster of classes with a table of them. Out: a Zone for each name,
or, where features have none, for each set of values; they do not overlap. What a zone does not give is the site's.
"""
import csv
import difflib
import re
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np
from rasterio import features
from rasterio.crs import CRS
from shapely.errors import ShapelyError
from shapely.geometry import MultiPolygon, box, shape
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from .. import schemas
from ..digits import cents
from ..errors import SlopeError
from ..findings import Finding
from ..geometry import box_of, extent, polygons_of
from ..survey import beside, geopackage, polygons, vectors
from ..survey.rasters import Raster, is_raster
from . import site_inputs
from .site_found import Zone as Known
from .site_sections import Model, schema, widest

# what a zone may have: the key of site.yaml's model, or of study where it is a list, and what the deck calls it
VALUES = {"friction": "friction", "rolling": "rolling", "restitution": "field_e", "spacing": "spacing"}
# of a value that changes with the site's, as far as its own one lies within them: those of the runs of a study
LIMITS = {"friction": (0.0, 89.0), "restitution": (0.001, 0.9), "spacing": (0.2, widest())}
SHORT = {"restitutio": "restitution"}       # a shapefile's names have ten letters
NAME, CLASS = "name", "class"
LIKE = 0.75             # of a name that is meant to be one of these
FILE = "ground.{}.csv"  # of a zone, in the site's folder
ALL = "ground.gpkg"     # all of them, for a GIS
MOST = 200              # zones: each has a type of balls


class Zone(NamedTuple):
    """A zone, or the part of one that a feature is."""
    name: str
    word: str               # the end of the names of its variables in the deck
    values: Dict[str, float]        # of VALUES: its own ones
    geometry: BaseGeometry  # local metres

    @property
    def file(self) -> str:
        return FILE.format(self.word)

    def about(self, raster: Raster) -> Dict[str, Any]:
        """What site.yaml says of it."""
        ground = box_of(raster)
        area = self.geometry.intersection(ground).area
        return {"name": self.name, "variables": self.word, **self.values, "area_m2": round(area, 1),
                "share": round(area / ground.area, 6)}


class Source(NamedTuple):
    """Where zones come from."""
    path: str
    table: Optional[str]        # of the classes of a raster
    crs: Optional[CRS]          # assigned to it
    advice: polygons.Advice


def read_site_zones(source: Source, raster: Raster, warn) -> List[Zone]:
    """The zones on a terrain. Where features overlap the later one counts.

    Raises SlopeError, which names file and feature, where attributes are missing, unknown or out of range.
    """
    has_classes = is_raster(vectors.source(source.path).path)
    if has_classes != bool(source.table):
        raise SlopeError("--ground-table", "must be given with a raster of classes, and with nothing else",
                         source.table or "none")
    parts = list(of_raster(source, raster, warn) if has_classes else of_features(source, raster, warn))
    if not parts:
        raise SlopeError(source.path, "must overlap the terrain, none of its zones does")
    zones = together(source.path, parts, warn)
    if len(zones) > MOST:
        raise SlopeError(source.path, f"must have at most {MOST} zones of different names or values", len(zones))
    taken: Set[str] = set()
    return [zone._replace(word=site_inputs.unused(re.sub(r"\W+", "_", zone.name, flags=re.ASCII).strip("_")
                                                  or "zone", taken)) for zone in zones]


def touch(source: Source, raster: Raster) -> bool:
    """Whether any zone lies on a terrain."""
    reader = of_raster if source.table else of_features
    return any(True for _ in reader(source, raster, vectors.ignore))


# --- files ---

def of_features(source: Source, raster: Raster, warn) -> Iterator[Zone]:
    """The features of a file of a GIS that lie on the terrain."""
    if polygons.read_text(source.path) is not None:
        raise SlopeError(source.path, f"must have attributes, {', '.join(VALUES)}: GeoJSON, shapefile, GeoPackage")
    found = vectors.read_vector_layer(source.path, "Polygon", warn)
    crs = source.crs or found.known_crs(source.path, source.advice.wrong_crs)
    for (where, geometry), about in zip(found.features, found.attributes):
        given = meant(source.path, about)
        yield from on_terrain(where, geometry, crs, given, source, raster)


def of_raster(source: Source, raster: Raster, warn) -> Iterator[Zone]:
    """The classes of a raster that have a line in the table, where they lie on the terrain."""
    assert source.table is not None
    rows = read_table(source.table)
    raster_of_zones = beside.read_raster_beside(source.path, raster, False, source.crs, warn=warn)
    known = np.isfinite(raster_of_zones.z)
    wrong = raster_of_zones.z[known & (raster_of_zones.z != np.round(raster_of_zones.z))]
    if wrong.size:
        raise SlopeError(source.path, "must hold classes, whole numbers", f"{wrong[0]:g}")
    missing = sorted(set(np.unique(raster_of_zones.z[known])) - set(rows))
    if missing:
        raise SlopeError(source.table, f"must have a line for each class of {source.path}, values may be left out",
                         f"none for {missing[0]:g}")
    for number, given in rows.items():
        cells = features.shapes(np.ones(raster_of_zones.z.shape, np.uint8), raster_of_zones.z == number,
                                transform=raster_of_zones.transform)
        parts = [part for one, _ in cells for part in polygons_of(shape(one))]
        if parts and given.keys() & VALUES.keys():
            moved = polygons.map_points(unary_union(parts), lambda points: points + raster_of_zones.offset)
            yield from on_terrain(f"{source.path}: class {number:g}", moved, raster_of_zones.crs, given, source, raster)


def read_table(path: str) -> Dict[float, Dict[str, Any]]:
    """{class: attributes} of a table with a column for each."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as lines:
            table = csv.DictReader(lines)
            rows = [dict(row) for row in table]
            heads = table.fieldnames or []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        why = getattr(error, "strerror", None) or error
        raise SlopeError(path, f"must be a table in CSV, in UTF-8: {why}") from None
    if CLASS not in heads:
        raise SlopeError(path, f"must have the columns {CLASS} and {', '.join(VALUES)}", " ".join(heads) or "none")
    classes: Dict[float, Dict[str, Any]] = {}
    for line, row in enumerate(rows, 2):
        number = convert_zone_number(f"{path}: line {line}: {CLASS}", row.pop(CLASS))
        if number is None or number in classes:
            raise SlopeError(f"{path}: line {line}: {CLASS}", "must be a number that no other line has", number)
        classes[number] = {NAME: f"{number:g}", **meant(path, row)}
    return classes


def meant(path: str, attributes: Mapping[str, Any]) -> Dict[str, Any]:
    """The attributes that count, by their names here; those that are null left out."""
    given = {}
    for attribute, value in attributes.items():
        name = str(attribute).strip().lower()
        name = SHORT.get(name, name)
        if name in (*VALUES, NAME):
            if value is not None and str(value).strip():
                given[name] = value
        elif like := difflib.get_close_matches(name, VALUES, 1, LIKE):
            raise SlopeError(path, f"must have attributes named {', '.join((*VALUES, NAME))}: {like[0]}?", attribute)
    return given


def convert_zone_number(where: str, value: Any) -> Optional[float]:
    """A number, also in a text; None of nothing."""
    if value is None or not str(value).strip():
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if not np.isfinite(number) or isinstance(value, bool):
        raise SlopeError(where, "must be a number", value)
    return number


def on_terrain(where: str, geometry, crs, given: Mapping[str, Any], source: Source, raster: Raster) -> Iterator[Zone]:
    """A feature as a zone, with its values checked; none where it lies beside the terrain."""
    values = {}
    for name in VALUES:
        number = convert_zone_number(f"{where}: {name}", given.get(name))
        if number is None:
            continue
        if wrong := schemas.first_error(number, range_of(name)):
            raise SlopeError(f"{where}: {name}", wrong[1])
        values[name] = number
    if not values:
        raise SlopeError(where, f"must have a value of {', '.join(VALUES)}, at least one", "none")
    local = polygons.of_feature(where, geometry, raster, crs, source.advice, anywhere=True)
    ground = box(*extent(raster)).buffer(raster.transform.a, join_style=2)
    part = unary_union(polygons_of(local.intersection(ground)))
    if part.intersection(box_of(raster)).area > 0:
        yield Zone(str(given.get(NAME, "")).strip(), "", values, part)


def range_of(name: str) -> Dict[str, Any]:
    """The schema of a value."""
    about = schema()["properties"]
    if name == "rolling":
        return about["study"]["properties"]["rolling"]["items"]
    return about["model"]["properties"]["field_restitution" if name == "restitution" else name]


# --- one zone of all features with a name, or with the same values ---

def together(path: str, parts: List[Zone], warn) -> List[Zone]:
    """Zones that do not overlap, in the order of their first features."""
    zones: Dict[Tuple, Zone] = {}
    twice = 0.0
    try:
        for part in parts:
            key = (part.name,) if part.name else ("", *sorted(part.values.items()))
            if key in zones and zones[key].values != part.values:
                raise SlopeError(path, f"must have one set of values for each {NAME}, which is a zone: other names?",
                                 f"two for {part.name}")
            for other, zone in zones.items():
                if other != key and zone.geometry.intersects(part.geometry):
                    left = unary_union(polygons_of(zone.geometry.difference(part.geometry)))
                    twice += zone.geometry.area - left.area
                    zones[other] = zone._replace(geometry=left)
            known = zones.get(key)
            geometry = unary_union([known.geometry, part.geometry]) if known else part.geometry
            zones[key] = part._replace(geometry=unary_union(polygons_of(geometry)))
    except ShapelyError as error:
        raise SlopeError(path, "must be polygons whose points differ by more than rounding") from error
    if twice > 1.0:
        warn(Finding("zones overlap", {"file": path, "area": twice}))
    left_over = [zone for zone in zones.values() if zone.geometry.area > 0]
    for name in (zone.name or "a zone" for zone in zones.values() if not zone.geometry.area > 0):
        warn(Finding("zone covered", {"file": path, "zone": name}))
    return [zone if zone.name else zone._replace(name=f"zone {k}") for k, zone in enumerate(left_over, 1)]


def write_site_zones(zones: List[Zone], raster: Raster, folder: Path) -> None:
    """A file for each zone, for the deck, and one of all for a GIS."""
    for zone in zones:
        polygons.write_polygon(folder / zone.file, zone.geometry, raster)
    kinds = {"name": "str", "variables": "str", **dict.fromkeys((*VALUES, "area_m2", "share"), "float")}
    rows = [(MultiPolygon(polygons_of(zone.geometry)), {**dict.fromkeys(kinds), **zone.about(raster)})
            for zone in zones]
    geopackage.write_geopackage(folder / ALL, {"ground": geopackage.Layer("MultiPolygon", kinds, rows)}, raster)


def outlines(folder: Path, zones: Sequence[Known], raster: Raster) -> Dict[str, BaseGeometry]:
    """{name: polygon}, as write_site_zones() left them in a site's folder."""
    files = {zone.name: folder / FILE.format(zone.variables) for zone in zones}
    return {name: polygons.read_local(path, raster, True) for name, path in files.items() if path.is_file()}


def with_rest(zones: Sequence[Known]) -> List[Known]:
    """And the ground outside of them."""
    return [*zones, Known("outside of all zones", "", {}, 1 - sum(zone.share for zone in zones))]


# --- what the values are in a run ---

def find_site_value(name: str, model: Model) -> float:
    """The site's value, with which that of a zone changes; 0: it does not, as a rolling resistance, which may be 0."""
    return {"friction": model.friction, "restitution": model.field_restitution, "spacing": model.spacing}.get(name, 0.0)


def now(zone: Known, model: Model, variables: Mapping[str, Any]) -> Dict[str, float]:
    """{variable of the ground: its value in a zone} in a run with these variables."""
    zones_now = {}
    for name, variable in VALUES.items():
        value = float(variables[variable])
        if name in zone.values:
            own = float(variables.get(f"{variable}_{zone.variables}", zone.values[name]))
            of = find_site_value(name, model)
            low, high = LIMITS.get(name, (0.0, 0.0))
            value = min(max(own * (value / of), min(own, low)), max(own, high)) if of else own
        zones_now[variable] = value
    return zones_now


def of_choices(source: Source, raster: Raster, folder: Path, tell, warn) -> List[Zone]:
    """Read the zones of a site, say what they are, and write them into its folder."""
    zones = read_site_zones(source, raster, warn)
    write_site_zones(zones, raster, folder)
    for zone in zones:
        about = zone.about(raster)
        tell(f"{zone.file}: zone {zone.name}, {cents(about['share'], 3)} of the terrain, {about['area_m2']:,.0f} m2: "
             + ", ".join(f"{name} {value:g}" for name, value in zone.values.items()))
    return zones
