"""Features of the files of a GIS: which layer, which CRS, what geometry; the one place that asks fiona.

A file may be named as QGIS does, FILE|layername=NAME. Without a layer it is the only one, or the only one of the wanted
geometry.
"""
import contextlib
import io
import json
import re
import zipfile
from pathlib import Path
from typing import Any, Callable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import fiona
from rasterio.crs import CRS
from shapely.errors import ShapelyError
from shapely.geometry import Polygon, shape

from ..errors import SlopeError
from ..findings import Finding
from . import zips
from .crs import as_crs

# well-known text as others write it: SRID=n; in front, as PostGIS does, or a column of a table, as QGIS does
KINDS = (r"(?:(?:MULTI|COMPOUND)?(?:POLYGON|LINESTRING|POINT|CURVE|SURFACE)|GEOMETRYCOLLECTION|LINEARRING|CURVEPOLYGON|"
         r"CIRCULARSTRING|TRIANGLE|TIN)\s*(?:Z|M|ZM)?\s*(?:\(|EMPTY)")
SRID = re.compile(rf"SRID\s*=\s*(\d+)\s*;\s*(?={KINDS})", re.IGNORECASE)
CELL = re.compile(rf"(?:{SRID.pattern})?{KINDS}[^\";\t\n]*", re.IGNORECASE)
COLUMNS = {"wkt", "wkt_geom", "geom", "geometry", "the_geom"}
BETWEEN = " \t\r\n;,"      # stands between well-known texts
MARK = "layername="         # QGIS: FILE|layername=NAME|geometrytype=...
MAGIC = bytes([0, 0, 0x27, 0x0a])       # begins a shapefile
ANY = "any"                 # type of the geometries of a layer that may have several
LONGITUDE_LATITUDE = 4326   # EPSG
fiona.drvsupport.supported_drivers.update(KML="r", LIBKML="r")      # GDAL reads them, fiona leaves them out


class Source(NamedTuple):
    """A file, and its layer if one is named."""
    path: str
    layer: Optional[str]


class Found(NamedTuple):
    """What a file holds."""
    features: List[Tuple[str, Any]]     # where (file and feature, for messages), geometry of shapely
    crs: Optional[CRS]
    empty: int                          # features without a geometry, which are not among them
    unknown: Optional[str] = None       # what the file names as its CRS, if that is none that PROJ knows
    attributes: Sequence[Mapping[str, Any]] = ()        # of each of the features
    numbers: Sequence[int] = ()         # of each of the features: which one of the file it is, from 1

    def known_crs(self, where: object, remedy: str) -> Optional[CRS]:
        """The CRS; SlopeError if it is unknown. remedy: what can be done."""
        if self.unknown is not None:
            raise SlopeError(source(where).path, f"must name a CRS that PROJ knows, such as EPSG:6677; {remedy}",
                             self.unknown)
        return self.crs


def ignore(_: object) -> None:
    """A function for warnings of which nobody wants to hear."""


def source(name: object) -> Source:
    """File and layer of FILE or FILE|layername=NAME."""
    path, *more = str(name).split("|")
    if not more or Path(str(name)).exists():
        return Source(str(name), None)
    return Source(path, next((word[len(MARK):] for word in more if word.startswith(MARK)), None))


def name_layer(name: object, layer: Optional[str], option: str = "--layer") -> str:
    """FILE|layername=NAME of a file and of the layer that an option names; SlopeError if both name one."""
    if layer is None:
        return str(name)
    if source(name).layer is not None:
        raise SlopeError(option, f"must not be given with {name}, which names a layer", layer)
    return f"{name}|{MARK}{layer}"


def is_there(name: object) -> bool:
    """Whether the file of FILE or FILE|layername=NAME is there."""
    return Path(source(name).path).is_file()


def require_file(name: object) -> Source:
    """The Source of a name; SlopeError unless its file is there."""
    found = source(name)
    if not is_there(name):
        raise SlopeError(found.path, "must be an existing file")
    return found


def read_vector_layer(name: object, kind: str, warn: Callable[[Finding], Any] = ignore) -> Found:
    """The features of a file, of the layer that it names or the one with geometries of a kind ("Polygon", "Line").

    Raises SlopeError, which names the file.
    """
    where = require_file(name)
    check_shapefile(Path(where.path))
    member = zips.layer_in(where.path, where.layer)
    opened = zips.gdal_name(f"{where.path}/{member}") if member else where.path
    what = {"Polygon": "polygons", "Line": "lines"}[kind]
    try:
        # fiona prints what it cannot decode of GDAL's messages
        with contextlib.redirect_stderr(io.StringIO()), fiona.Env():
            layers = fiona.listlayers(opened)
            if where.layer is not None and where.layer not in layers:
                raise SlopeError(where.path, f"must have the named layer, one of {zips.some(layers)}", where.layer)
            layer = where.layer if where.layer is not None else only_layer(opened, layers, kind, where.path)
            with fiona.open(opened, layer=layer) as data:
                is_drawing = data.driver == "DXF"
                raw = [(f"{where.path}: feature {feature['id']}", feature["geometry"], dict(feature["properties"]))
                       for feature in data]
                crs = CRS.from_wkt(data.crs_wkt) if data.crs_wkt else None
                unknown = unknown_crs(where.path, member, crs) if data.driver == "GeoJSON" else None
    except SlopeError:
        raise
    except Exception as error:  # GDAL's too, of classes that fiona keeps private
        raise SlopeError(where.path, f"must be {what} that GDAL can read: GeoJSON, shapefile, or another format of it "
                         f"({str(error).replace(opened, where.path)})") from error
    features = [(place, shaped(place, geometry, kind)) for place, geometry, _ in raw if geometry is not None]
    if is_drawing and kind == "Polygon":
        features = [(place, closed(geometry)) for place, geometry in features]
    if raw and not features:
        raise SlopeError(where.path, f"must hold {what}, none of its features has a geometry", len(raw))
    empty = len(raw) - len(features)
    if empty:
        first = next(place for place, geometry, _ in raw if geometry is None)
        warn(Finding("no geometry", {"feature": first, "without": empty, "features": len(raw)}))
    kept = [(about, number) for number, (_, geometry, about) in enumerate(raw, 1) if geometry is not None]
    return Found(features, crs, empty, unknown, [about for about, _ in kept], [number for _, number in kept])


def unknown_crs(path: str, member: Optional[str], taken: Optional[CRS]) -> Optional[str]:
    """The CRS that a GeoJSON, or one in a .zip, names, if it is not the one that GDAL has taken; else None.

    GDAL takes what it does not know for longitude and latitude.
    """
    if member:
        with zips.check_archive(path), zipfile.ZipFile(path) as archive:
            content = archive.read(member)
    else:
        content = Path(path).read_bytes()
    if b'"crs"' not in content:
        return None
    try:
        named_crs = json.loads(content).get("crs")
    except (ValueError, AttributeError, RecursionError):    # of GDAL's dialect, without a crs that it would have taken
        return None
    other = taken is not None and taken.to_epsg() != LONGITUDE_LATITUDE and "CRS84" not in taken.to_wkt()
    if named_crs is None or other:
        return None
    properties = named_crs.get("properties") if isinstance(named_crs, dict) else None
    name = str((properties or {}).get("name") or (properties or {}).get("code") or named_crs)
    return None if re.search(rf"CRS84$|\b{LONGITUDE_LATITUDE}$|^WGS ?(19)?84$", name.strip(), re.IGNORECASE) else name


def shaped(where: str, geometry: Any, kind: str):
    """The geometry of a feature."""
    try:
        return shape(geometry)
    except (ShapelyError, ValueError, TypeError, AttributeError, NotImplementedError) as error:
        raise SlopeError(where, f"must be a {kind.lower()} ({error})") from error


def closed(geometry: Any):
    """A closed line, as which drawings have areas, as a polygon; another geometry as it is."""
    is_ring = geometry.geom_type == "LineString" and len(geometry.coords) > 3 and geometry.is_ring
    return Polygon(geometry.coords) if is_ring else geometry


def only_layer(opened: str, layers: List[str], kind: str, path: str) -> str:
    """The layer of a file, the one with geometries of a kind if it has several; SlopeError if that is not clear.

    Tables without geometry, such as QGIS' layer_styles, do not count.
    """
    if len(layers) == 1:
        return layers[0]
    types = {}
    for layer in layers:
        with fiona.open(opened, layer=layer) as data:
            types[layer] = type_of(data)
    mapped = [layer for layer in layers if types[layer] != "None"]
    fit = [layer for layer in mapped if kind in types[layer] or types[layer] == ANY]
    if len(mapped) == 1:
        return mapped[0]
    if len(fit) > 1:
        filled = [layer for layer in fit if holds(opened, layer, kind)]
        fit = filled or fit
    if len(fit) != 1:
        raise SlopeError(path, f"must name one of its layers, {path}|{MARK}NAME (or --layer, where there is that "
                         f"option): {zips.some(fit or mapped or layers)}", f"{len(mapped or layers)} layers")
    return fit[0]


def type_of(data: Any) -> str:
    """The type of the geometries of an open layer, ANY if it may have several; "None" if it has none."""
    try:
        name = str(data.schema["geometry"])
    except KeyError:        # one that fiona does not name, such as MULTISURFACE
        return ANY
    return ANY if "Unknown" in name or "Collection" in name or name.startswith("3D Geometry") else name


def holds(opened: str, layer: str, kind: str) -> bool:
    """Whether a layer has a feature with a geometry of a kind."""
    with fiona.open(opened, layer=layer) as data:
        return any(feature["geometry"] is not None and kind in str(feature["geometry"]["type"]) for feature in data)


def check_shapefile(path: Path) -> None:
    """Raise SlopeError if a shapefile lacks the index that GDAL needs, or one of its files is cut short: features would
    be lost.
    """
    if path.suffix.lower() != ".shp":
        return
    with open(path, "rb") as data:
        if data.read(4) != MAGIC:
            return
    beside = [part for suffix in (".shx", ".SHX", ".dbf", ".DBF") if (part := path.with_suffix(suffix)).is_file()]
    if not any(one.suffix.lower() == ".shx" for one in beside):
        raise SlopeError(path, f"must have its other files beside it, {path.with_suffix('.shx').name} is missing: copy "
                         "all of the shapefile (.shp, .shx, .dbf, .prj), or save it as GeoJSON")
    for part in (path, *beside):
        with open(part, "rb") as file:
            zips.check_length(str(part), part.stat().st_size, file.read(32))


def statements(text: str) -> List[Tuple[int, str]]:
    """The well-known texts in a text, one after the other, each with the number of the line in which it begins.

    What is none, between or after them, is one as well. GEOS reads the first of several and says nothing.
    """
    text = re.sub("#.*", "", text)
    ends, depth = [], 0
    for mark in re.finditer(r"[()]|\bEMPTY\b", text, re.IGNORECASE):
        depth += {"(": 1, ")": -1}.get(mark.group(), 0)
        if depth == 0:
            ends.append(mark.end())
    parts, line, low = [], 1, 0
    for high in (*ends, len(text)):
        part = text[low:high]
        begins = part.lstrip(BETWEEN)
        if begins:
            parts.append((line + part[:len(part) - len(begins)].count("\n"), begins.rstrip(BETWEEN)))
        line, low = line + part.count("\n"), high
    return parts


def plain_text(path: object, text: str) -> Tuple[str, Optional[CRS]]:
    """A text without what is around its well-known text, and the CRS that this names; another text as it is.

    Raises SlopeError where several are named.
    """
    head, _, body = text.lstrip().partition("\n")
    if COLUMNS & {word.strip(' "\r').lower() for word in re.split("[,;\t]", head)}:
        text = "\n".join(match.group() for match in CELL.finditer(body))
    numbers = sorted({int(number) for number in SRID.findall(text)})
    if len(numbers) > 1:
        raise SlopeError(path, "must be in one CRS", " and ".join(f"SRID={number}" for number in numbers))
    named = as_crs(f"{path}: SRID", f"EPSG:{numbers[0]}") if numbers and numbers[0] else None
    return SRID.sub("", text) if numbers else text, named
