"""Reading the elevation tiles of the Geospatial Information Authority of Japan (FG-GML DEM, .xml, or many in a .zip).

A tile is a grid in degrees. Its corners are the outer edges of its cells, rows run from the north-west corner to the
east, and the list of heights begins at startPoint; what is before it, and what the list lacks at its end, is NODATA.

The files come from outside: a DOCTYPE (and so any entity) is refused, members of a zip are only read in memory, and
sizes are limited before anything is unpacked.
"""
import codecs
import io
import math
import re
import warnings
import zipfile
from typing import List, NamedTuple
from xml.parsers import expat

import numpy as np
from affine import Affine
from rasterio.crs import CRS

from ..digits import rounded
from ..errors import SlopeError
from ..findings import Finding
from . import zips
from .grids import Raster, check_memory, progress
from .japan import DATUMS
from .marks import Scale
from .rasters import HIGHEST, NODATA

SCHEMA = "http://fgd.gsi.go.jp/spec/"
GML = "http://www.opengis.net/gml/3.2"
LARGEST_XML = 256_000_000      # bytes; a tile of 1125 x 750 has 18 million
LARGEST_ZIP = 4_000_000_000    # bytes, of all tiles in it, unpacked
DEFLATE = 1100                 # deflate packs at most 1032 to 1: more means members that overlap
CHUNK = 1 << 20                # bytes
LONGEST = 200                  # characters of a file's own words in a message
UNIT = 1 / 30 / 3600           # degrees; spacings are whole multiples of it: 1 (DEM1), 6 (DEM5), 12 (DEM10)
ON_UNIT = 0.01                 # of a cell: corners have nine decimals or fewer, and belong to a multiple of the spacing
MISSING = "\u30c7\u30fc\u30bf\u306a\u3057"  # "no data"


class Tile(NamedTuple):
    """One DEM: heights in degrees of its datum. name: the file, and the member of a zip."""
    name: str
    raster: Raster
    datum: str


class NotTiles(Exception):
    """Raised with what it is, by XML that is none of these tiles."""


def is_one(path):
    """Whether the file is a zip or XML, by its first bytes; GDAL's own XML rasters (VRT) are not meant."""
    try:
        with open(path, "rb") as source:
            head = source.read(1024)
    except OSError:
        return False
    if head.startswith(b"PK"):
        return True
    text = head.removeprefix(codecs.BOM_UTF8).lstrip()
    return text.startswith(b"<") and b"<VRTDataset" not in head


# --- files ---

def read_fggml_tiles(path):
    """All tiles of an .xml or .zip, a list of Tile; SlopeError if there are none or one is broken."""
    try:
        with open(path, "rb") as source:
            if source.read(2) == b"PK":
                return _read_zip(source, str(path))
            size = source.seek(0, io.SEEK_END)
            if size > LARGEST_XML:
                raise SlopeError(path, f"must have at most {LARGEST_XML / 1e6:g} MB", f"{size / 1e6:.0f} MB")
            source.seek(0)
            return _tiles(source, str(path))
    except NotTiles as error:
        raise SlopeError(path, "must be a raster or FG-GML elevation data (Dataset with a DEM)"
                         + zips.suggest_zip_remedy(str(path)), error) from None
    except OSError as error:
        raise SlopeError(path, f"cannot be read: {error.strerror or error}") from error


def _read_zip(source, where, room=None):
    """Tiles of the .xml in a zip, and of the zips in it: a download of several areas is a zip of zips.

    room: bytes that may still be unpacked, in a list; None for the outer zip.
    """
    outer = room is None
    room = room or [LARGEST_ZIP]
    size = source.seek(0, io.SEEK_END)
    try:
        archive = zipfile.ZipFile(source)
    except zips.FAULTS as error:
        raise SlopeError(where, f"must be a whole zip file ({str(error)[:LONGEST]})") from error
    wanted = (".xml", ".zip") if outer else (".xml",)
    members = [member for member in archive.infolist() if member.filename.lower().endswith(wanted)
               and not zips.is_of_macos(member.filename)]
    total = sum(member.file_size for member in members)
    room[0] -= total
    if room[0] < 0 or total > DEFLATE * size:
        raise SlopeError(where, f"must have at most {LARGEST_ZIP / 1e6:g} MB unpacked, and {DEFLATE} times its size",
                         f"{total / 1e6:.0f} MB in {rounded(size / 1e6, 3)} MB")
    tiles = []
    for member in progress(members, f"reading {where}"):
        kind = member.filename[-4:].lower()
        name = f"{where}: {''.join(c if c.isprintable() else '?' for c in member.filename[:LONGEST])}"
        if member.file_size > LARGEST_XML:
            raise SlopeError(name, f"must have at most {LARGEST_XML / 1e6:g} MB unpacked",
                             f"{member.file_size / 1e6:.0f} MB")
        if member.flag_bits & 1:
            raise SlopeError(name, "must not be encrypted")
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):   # lzma asks for memory as it likes
            raise SlopeError(name, "must be packed by deflate, or not at all",
                             f"method {member.compress_type}")
        try:
            with archive.open(member) as inner:
                if kind == ".xml":
                    tiles += _tiles(inner, name)
                else:
                    tiles += _read_zip(io.BytesIO(inner.read()), name, room)
        except NotTiles:
            continue  # metadata, or roads and buildings
        except zips.FAULTS as error:
            raise SlopeError(name, f"is damaged ({str(error)[:LONGEST]})") from error
    if outer and not tiles:
        inside = [member.filename for member in archive.infolist() if not zips.is_of_macos(member.filename)]
        other = next((way for name in inside if (way := zips.suggest_zip_remedy(name))), "")
        raise SlopeError(where, f"must hold a raster, or FG-GML elevation tiles (.xml), it has none{other}",
                         f"{len(archive.infolist())} files")
    return tiles


def _tiles(stream, where):
    """The tiles in one XML; NotTiles if it is something else."""
    parser = _Parser(where)
    parser.feed(stream)
    if not parser.dems:
        raise NotTiles("a Dataset without a DEM")
    return [_tile(dem, where) for dem in parser.dems]


# --- XML ---

class _Parser:
    """Collects of each DEM the texts of the elements in WANTED, with their lines, and the attributes in ATTRIBUTES."""

    WANTED = {"lowerCorner", "upperCorner", "low", "high", "tupleList", "startPoint"}
    ATTRIBUTES = {"Envelope": "srsName", "sequenceRule": "order"}

    def __init__(self, where):
        self.where = where
        self.dems, self.root, self.text = [], None, None

    def feed(self, stream):
        head = stream.read(CHUNK)
        decoder = self.decoder(head)
        # after a decoder it is UTF-8, whatever the declaration says
        self.expat = expat.ParserCreate("utf-8" if decoder else None, namespace_separator=" ")
        self.expat.buffer_text = True
        self.expat.buffer_size = CHUNK
        self.expat.StartElementHandler = self.start
        self.expat.EndElementHandler = self.end
        self.expat.CharacterDataHandler = self.characters
        self.expat.StartDoctypeDeclHandler = self.doctype
        count = 0
        try:
            while head:
                count += len(head)
                if count > LARGEST_XML:
                    raise SlopeError(self.where, f"must have at most {LARGEST_XML / 1e6:g} MB")
                self.expat.Parse(decoder.decode(head).encode() if decoder else head)
                head = stream.read(CHUNK)
            self.expat.Parse(b"", True)
        except expat.ExpatError as error:
            line = f"{self.where}: line {error.lineno}"
            what = expat.ErrorString(error.code)
            if self.root is not None and what in (expat.errors.XML_ERROR_NO_ELEMENTS,
                                                  expat.errors.XML_ERROR_UNCLOSED_TOKEN,
                                                  expat.errors.XML_ERROR_PARTIAL_CHAR):
                raise SlopeError(line, "is cut short: the XML ends in the middle") from error
            raise SlopeError(line, f"must be XML ({what})") from error
        except UnicodeDecodeError as error:
            raise SlopeError(f"{self.where}: line {self.expat.CurrentLineNumber} or after",
                             f"must be in the encoding that it declares ({error.reason})") from error

    def decoder(self, head):
        """What makes text of the file's bytes if expat cannot (Shift_JIS), else None."""
        declared = re.match(rb"""(?:\xef\xbb\xbf)?\s*<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)""", head)
        encoding = declared.group(1).decode() if declared else "UTF-8"
        name = encoding.lower().replace("-", "_")
        if name in ("shift_jis", "sjis", "x_sjis", "windows_31j", "cp932", "ms932"):
            return codecs.getincrementaldecoder("cp932")()
        if name not in ("utf_8", "utf8", "us_ascii", "ascii"):
            raise SlopeError(f"{self.where}: line 1", "encoding must be UTF-8 or Shift_JIS", encoding)
        return None

    def doctype(self, name, *_):
        raise SlopeError(f"{self.where}: line {self.expat.CurrentLineNumber}", "must have no DOCTYPE", name)

    def start(self, tag, attributes):
        space, _, name = tag.rpartition(" ")
        if self.root is None:
            self.root = name
            if not (space.startswith(SCHEMA) and name == "Dataset"):
                raise NotTiles(f"XML with the root {name}")
        if name == "DEM" and space.startswith(SCHEMA):
            self.dems.append({"line": self.expat.CurrentLineNumber})
        self.text = [] if self.dems and space == GML and name in self.WANTED else None
        self.line = self.expat.CurrentLineNumber
        if self.dems and space == GML and name in self.ATTRIBUTES:
            value = attributes.get(self.ATTRIBUTES[name])
            if value is not None:
                self.dems[-1][self.ATTRIBUTES[name]] = self.line, value

    def characters(self, text):
        if self.text is not None:
            self.text.append(text)

    def end(self, tag):
        if self.text is not None:
            self.dems[-1][tag.rpartition(" ")[2]] = self.line, "".join(self.text)
        self.text = None


# --- tiles ---

def _tile(dem, where):
    """The Tile of what a _Parser collected of a DEM."""
    def get(name):
        if name not in dem:
            raise SlopeError(f"{where}: line {dem['line']}", f"DEM must have {name}, it is missing")
        return dem[name]

    def pair(name, kind, what):
        line, text = get(name)
        try:
            a, b = map(kind, text.split())
            if not (math.isfinite(a) and math.isfinite(b)):
                raise ValueError
        except ValueError:
            raise SlopeError(f"{where}: line {line}", f"{name} must be two {what}", text.strip()[:60]) from None
        return a, b

    line, srs = get("srsName")
    if srs.lower() not in DATUMS:
        raise SlopeError(f"{where}: line {line}", f"srsName must be one of {', '.join(DATUMS)}", srs[:60])
    datum, degrees, _ = DATUMS[srs.lower()]
    south, west = pair("lowerCorner", float, "numbers, latitude and longitude")
    north, east = pair("upperCorner", float, "numbers, latitude and longitude")
    if not (-90 <= south < north <= 90 and -360 <= west < east <= 360):
        raise SlopeError(f"{where}: line {dem['lowerCorner'][0]}", "corners must be latitude and longitude, the lower "
                         "one in the south-west", f"{south:.10g} {west:.10g} and {north:.10g} {east:.10g}")
    if pair("low", int, "whole numbers") != (0, 0):
        raise SlopeError(f"{where}: line {dem['low'][0]}", "low must be 0 0", dem["low"][1].strip()[:60])
    columns, rows = (last + 1 for last in pair("high", int, "whole numbers, x and y"))
    if not (0 < columns <= 100_000 and 0 < rows <= 100_000):
        raise SlopeError(f"{where}: line {dem['high'][0]}", "high must be 0 to 99999", dem["high"][1].strip()[:60])
    if dem.get("order", (0, "+x-y"))[1] != "+x-y":
        raise SlopeError(f"{where}: line {dem['order'][0]}", "order must be +x-y", dem["order"][1][:60])
    check_memory(rows, columns, where)
    x, y = pair("startPoint", int, "whole numbers, x and y") if "startPoint" in dem else (0, 0)  # GML: the first cell
    if not (0 <= x < columns and 0 <= y < rows):
        raise SlopeError(f"{where}: line {dem['startPoint'][0]}", f"startPoint must be in the grid, 0 0 to "
                         f"{columns - 1} {rows - 1}", f"{x} {y}")

    line, text = get("tupleList")
    heights = _heights(where, line, text)
    start, room = y * columns + x, rows * columns - (y * columns + x)
    if len(heights) > room:
        raise SlopeError(f"{where}: line {line}", f"tupleList must have at most {room} tuples ({columns} x {rows} "
                         f"cells, startPoint {x} {y})", len(heights))
    z = np.full(rows * columns, np.nan)
    z[start:start + len(heights)] = heights
    dx, west = _on_grid((east - west) / columns, west)
    dy, north = _on_grid((north - south) / rows, north)
    transform = Affine(dx, 0, west, 0, -dy, north)
    return Tile(where, Raster(z.reshape(rows, columns), transform, CRS.from_epsg(degrees)), datum)


def _on_grid(spacing, edge):
    """Spacing and a corner with all their digits: the file has those of the corners, rounded.

    Spacings are multiples of 1/30 second of arc, and corners multiples of the spacing; else they stay as they are.
    """
    exact = round(spacing / UNIT) * UNIT
    if exact == 0 or abs(exact - spacing) > 1e-4 * spacing:
        return spacing, edge
    count = edge / exact
    return exact, (round(count) * exact if abs(count - round(count)) < ON_UNIT else edge)


TO_NUMBERS = bytes.maketrans(b",", b" ")
NOT_ASCII = bytes(range(128, 256))


def _heights(where, line, text):
    """The heights in a list of tuples "kind,height" that starts in that line, NaN for NODATA."""
    data = text.encode()
    heights = None
    if _are_pairs(data) and text.count(MISSING) == text.count(f"{MISSING},{NODATA}"):
        # the kinds are Japanese: without all that is not ASCII, numbers remain
        numbers = data.translate(TO_NUMBERS, NOT_ASCII)
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # numpy's way to say that something is not a number
            try:
                heights = np.fromstring(numbers, sep=" ")
            except (DeprecationWarning, ValueError):
                pass
    if heights is None or len(heights) != data.count(b",") or not np.isfinite(heights).all():
        heights = np.array(list(_slow_heights(where, line, text)), dtype=float)
    heights[heights == NODATA] = np.nan
    wrong = np.flatnonzero(~(np.abs(heights) <= HIGHEST) & ~np.isnan(heights))
    if len(wrong):
        raise SlopeError(f"{where}: tuple {wrong[0] + 1} of the list in line {line}",
                         "must be a height in metres between -9000 and 9000, or -9999", f"{heights[wrong[0]]:g}")
    return heights


def _are_pairs(data):
    """Whether bytes are words with one comma in the middle of each, and at least one of them."""
    codes = np.frombuffer(b"\n" + data + b"\n", np.uint8)
    space = codes <= 32
    start, comma = np.flatnonzero(space[:-1] & ~space[1:]) + 1, np.flatnonzero(codes == 44)
    return (len(start) == len(comma) > 0 and (start < comma).all() and (comma[:-1] < start[1:]).all()
            and not space[comma + 1].any())


def _slow_heights(where, line, text):
    """The same, tuple by tuple: it finds what is wrong."""
    for number, content in enumerate(text.split("\n"), line):
        for word in content.split():
            try:
                kind, height = word.split(",")
                value = float(height)
                if not kind or not math.isfinite(value):
                    raise ValueError
            except ValueError:
                raise SlopeError(f"{where}: line {number}", "must be tuples kind,height", word[:60]) from None
            yield NODATA if kind == MISSING else value


# --- all tiles of a terrain ---

def without(tile, marks):
    """A tile without the heights that a Marks is given."""
    z = tile.raster.z
    none = np.isnan(z)
    marks.take(z, none)
    marks.note(z, none, Scale())
    return tile._replace(raster=tile.raster._replace(z=np.where(none, np.nan, z)))


def spacing(tile):
    """Seconds of arc, along the longitude and the latitude."""
    return 3600 * tile.raster.transform.a, -3600 * tile.raster.transform.e


def by_resolution(tiles):
    """Lists of tiles of one spacing each, the finest first; in each they keep their order."""
    groups: List[List[Tile]] = []
    for tile in tiles:
        for group in groups:
            if np.allclose(spacing(tile), spacing(group[0]), rtol=1e-4, atol=0):
                group.append(tile)
                break
        else:
            groups.append([tile])
    return sorted(groups, key=lambda group: spacing(group[0]))


def one_datum(tiles, warn):
    """The tiles with one CRS, that of the first; a warning if they are of several datums."""
    datums = list(dict.fromkeys(tile.datum for tile in tiles))
    if len(datums) == 1:
        return tiles
    first = {datum: next(tile.name for tile in tiles if tile.datum == datum) for datum in datums}
    warn(Finding("datums", {"datums": " and ".join(f"{datum} ({first[datum]})" for datum in datums),
                            "what": "heights and places" if "JGD2000" in datums else "heights"}))
    crs = tiles[0].raster.crs
    return [tile._replace(raster=tile.raster._replace(crs=crs)) for tile in tiles]
