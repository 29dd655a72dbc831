"""Reading rasters, writing the plain .asc with its sidecar, and GeoTIFFs: the one place in Python that does it.

Heights are metres above the vertical datum of the survey, NaN where there is none (NODATA). Arrays have the shape
(rows, columns), rows from north to south; a value belongs to the centre of its cell. A transform takes (column, row),
counted from the outer corner of the first cell, to (x, y).
"""
import math
import os
import sys
import warnings
from pathlib import Path
from typing import Dict, NamedTuple, Optional, Tuple, Union

import numpy as np
import rasterio
import yaml
from affine import Affine
from rasterio.crs import CRS
from rasterio.enums import MaskFlags
from rasterio.errors import CRSError, NotGeoreferencedWarning, RasterioError
from rich.console import Console
from rich.progress import track

from .. import disk, schemas, streams
from ..errors import SlopeError
from ..schemas import COUNT, TEXT, mapping, numbers
from .marks import Scale, cells_of, text

WHAT_SIDECAR = "a sidecar that `slope terrain` wrote"
ORIGIN, EXTENT = ("east", "north"), ("xlo", "ylo", "xhi", "yhi")
SIDECAR = mapping({"crs": mapping({"wkt": TEXT}, null=True), "origin": mapping(numbers(*ORIGIN)),
                   "size": mapping({"rows": COUNT, "columns": COUNT}), "extent": mapping(numbers(*EXTENT))})
ENDINGS = {".tif", ".tiff", ".asc", ".vrt", ".img", ".bil"}       # of files that are rasters and not layers of shapes
NODATA = -9999             # in written files
HIGHEST = 9000.0           # m; beyond +-HIGHEST a value is a NODATA mark that the file does not declare (-9999, -32768)
BYTES_PER_CELL = 40        # peak memory of `slope terrain` per cell, measured 22 to 33 for 16 million cells
HEADER = {"ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "dx", "dy", "nodata_value"}
# keys that say the same
AGAIN = {"xllcorner": {"xllcenter"}, "xllcenter": {"xllcorner"}, "yllcorner": {"yllcenter"}, "yllcenter": {"yllcorner"},
         "cellsize": {"dx", "dy"}, "dx": {"cellsize"}, "dy": {"cellsize"}}
UNITS = {"m": 1.0, "ft": 0.3048, "us-ft": 1200 / 3937}      # m, of heights
TAGS = {"m": "m", "metre": "m", "meter": "m", "metres": "m", "meters": "m", "ft": "ft", "foot": "ft", "feet": "ft",
        "international foot": "ft", "us survey foot": "us-ft", "us survey feet": "us-ft", "ftus": "us-ft",
        "us-ft": "us-ft", "foot_us": "us-ft"}      # how files spell them, in lower case
NO_UNIT = {"", "unspecified", "unknown", "undefined", "none"}       # how files spell that they do not say one
DEGREE = 111_195.0      # m along a meridian


class Raster(NamedTuple):
    """Heights on a grid; CRS coordinates are transform * (column, row) + offset."""
    z: np.ndarray
    transform: Affine
    crs: Optional[CRS]
    offset: Tuple[float, float] = (0.0, 0.0)


def progress(steps, what, total=None):
    """Iterate over steps behind a progress bar on stderr, which shows only on a terminal."""
    if not streams.is_terminal(sys.stderr):
        return steps
    return track(steps, what, total, console=Console(stderr=True), transient=True)


def check_memory(rows, columns, where):
    """Raise SlopeError if rows x columns cells do not fit in this machine's memory."""
    need = rows * columns * BYTES_PER_CELL / 1e9
    have = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    if need > have:
        raise SlopeError(where, f"must fit in the {have:.3g} GB of memory of this machine",
                         f"{columns} x {rows} cells, which need {need:.3g} GB")


def epsg(crs):
    """EPSG number of a CRS, None if not known.

    The confidence of 50 covers ESRI's spelling in .prj files, where the axes of many systems (all of Japan's plane
    ones) are in another order than EPSG's, which does not matter here: rasters are always east, north. It covers a
    system in another unit of length too, which matters.
    """
    number = crs.to_epsg(confidence_threshold=50)
    if number and crs.is_projected and not math.isclose(crs.linear_units_factor[1],
                                                        CRS.from_epsg(number).linear_units_factor[1], rel_tol=1e-9):
        return None
    return number


def crs_name(crs):
    """EPSG:n if known, else the name that the WKT carries; `none` without a CRS."""
    if crs is None:
        return "none"
    return f"EPSG:{epsg(crs)}" if epsg(crs) else crs.to_wkt().split('"')[1]


def read(path, heights=True, unit=None, marks=None):
    """Read a single-band raster (GeoTIFF, ESRI ASCII grid, or another format of GDAL) into a Raster.

    The CRS is None where the file has none; it may be in degrees, the heights may not: they become metres, from what
    the file says, or from the unit (of UNITS) that is given. heights=False: other values than heights, such as the
    energies of fix deposit/grid; their size is not checked. marks: of the values, in the file's own unit, that stand
    for none, too; what the file has of them is noted there. Raises SlopeError on anything that is not such a raster.
    """
    if not Path(path).is_file():
        raise SlopeError(path, "must be an existing file")
    try:
        with warnings.catch_warnings(), rasterio.Env():  # Env: GDAL's own messages are not for stderr
            warnings.simplefilter("ignore", NotGeoreferencedWarning)  # an error of our own, below
            with rasterio.open(path) as source:
                stored, none = _read(path, source)
                own = unit or unit_of(path, source, heights) or "m"
                scale = Scale(source.scales[0], source.offsets[0], UNITS[own])
                transform, crs = source.transform, source.crs
    except (RasterioError, OSError) as error:  # RasterioIOError is an OSError only
        raise SlopeError(path, f"must be a raster that GDAL can read ({error})") from error
    if marks:
        marks.take(stored, none)
    z = scale.in_unit(stored)
    z[none] = np.nan
    if heights:
        check_heights(path, z, stored, own, unit is None, marks)
        if marks:
            marks.note(stored, none, scale)
    return Raster(scale.metres(z), transform, crs)


def check_heights(path, z, stored, unit, may_be_feet, marks):
    """Raise SlopeError if heights (in a unit of UNITS) cannot be those of a ground.

    None is higher than HIGHEST m, and none lower than -HIGHEST in its own unit: -9999 ft is a mark, 9999 ft a mountain.
    stored: what the file has for them; may_be_feet: the unit was not given; marks: None where there is no --nodata.
    """
    top = HIGHEST / UNITS[unit]
    with np.errstate(invalid="ignore"):
        wrong = np.argwhere((z > top) | (z < -HIGHEST))
    if not len(wrong):
        return
    row, column = wrong[0]
    value, shown = z[row, column], text(stored[row, column])
    remedy = f"{marks.options(shown)} if it means none" if marks else f"gdal_translate -a_nodata {shown} declares it"
    name = "metres" if unit == "m" else unit
    feet = "; --z-unit ft (slope terrain, slope site) if these are feet" if (
        may_be_feet and HIGHEST < value < HIGHEST / UNITS["ft"]) else ""
    scaled = "" if float(stored[row, column]) == value else f", which stands for {value:g} {unit}"
    raise SlopeError(f"{path}: row {row + 1} column {column + 1}", f"must be a height in {name} between -9000 and "
                     f"{math.floor(top)}, or the NODATA value that the file declares; {remedy}{feet}",
                     f"{shown}{scaled}")


def unit_of(path, source, heights=True):
    """The unit (of UNITS) that an open raster says its heights have, None if it does not say.

    SlopeError where it is another one, or cannot be metres as a matter of course: the CRS is in feet, too.
    """
    tag = (source.units[0] or "").strip()
    unit = TAGS.get(tag.lower())
    if tag.lower() not in NO_UNIT and (unit is None or not heights and unit != "m"):
        raise SlopeError(path, "heights must be in metres or feet; --z-unit m, ft or us-ft overrides a wrong tag"
                         if heights else "must be in metres", tag)
    if unit is None and heights and source.crs is not None and source.crs.is_projected:
        name, factor = source.crs.linear_units_factor
        if any(abs(factor / UNITS[foot] - 1) < 1e-7 for foot in ("ft", "us-ft")):
            raise SlopeError(path, f"must say the unit of its heights, as its CRS, {crs_name(source.crs)}, is in {name}"
                             ": give --z-unit us-ft, ft or m (slope terrain, slope site)", "none")
    return unit


def height_unit(path):
    """The unit that a raster file says its heights have, None if it does not say."""
    with warnings.catch_warnings(), rasterio.Env():
        warnings.simplefilter("ignore", NotGeoreferencedWarning)
        with rasterio.open(path) as source:
            return TAGS.get((source.units[0] or "").lower())


def is_picture(path):
    """Whether a raster file has 8-bit values as they are, as a hillshade has."""
    with warnings.catch_warnings(), rasterio.Env():
        warnings.simplefilter("ignore", NotGeoreferencedWarning)
        with rasterio.open(path) as source:
            return source.dtypes[0] in ("uint8", "int8") and source.scales[0] == 1 and source.offsets[0] == 0


def _read(path, source):
    """The values as they are stored, and the mask of those that the file says are none."""
    if source.count != 1:
        raise SlopeError(path, "must have one band, the heights", f"{source.count} bands")
    if source.dtypes[0].startswith("complex"):
        raise SlopeError(path, "must hold real numbers", source.dtypes[0])
    rows, columns = source.shape
    check_memory(rows, columns, path)
    if source.driver == "AAIGrid":
        stored, declared = _read_ascii_heights(path, rows, columns)
        none = np.zeros(stored.shape, bool)
    else:
        read = source.read(1, masked=True)
        stored, none = read.data, np.ma.getmaskarray(read)
        declared = source.nodata if MaskFlags.nodata in source.mask_flag_enums[0] else None
    if source.transform.is_identity or source.transform.is_degenerate:
        raise SlopeError(path, "must be georeferenced: place and size of the cells are missing")
    none |= ~np.isfinite(stored)
    if declared is not None:
        none |= cells_of(stored, declared)    # GDAL's mask misses marks with few digits
    return stored, none


def _read_ascii_heights(path, rows, columns):
    """Heights of an ESRI ASCII grid of that shape, and its mark of NODATA.

    GDAL gives shape and place of the grid and its CRS (.prj), but not the values: it takes words for 0, fills up a
    short last row with 0 and ignores values after the last. Here each of these is an error with its line.
    """
    with open(path, encoding="ascii", errors="replace") as lines:
        header, header_lines = _check_ascii_header(path, lines)
        lines.seek(0)
        z = np.empty(rows * columns)
        count, line_count, odd_line = 0, 0, None
        for number, line in enumerate(progress(lines, f"reading {path}", total=rows), 1):
            words = line.split()
            if number <= header_lines or not words:
                continue
            try:
                if "_" in line:     # Python's float takes 1_5 for 15
                    raise ValueError(f"no number: {next(word for word in words if '_' in word)!r}")
                values = [float(word) for word in words]
            except ValueError as error:
                raise SlopeError(f"{path}: line {number}", "must hold numbers with a decimal point",
                                 str(error).rsplit(":", 1)[1].strip()) from None
            if len(values) != columns and odd_line is None:
                odd_line = f"line {number}, which has {len(values)}"
            room = z[count:count + len(values)]
            room[:] = values[:len(room)]
            count += len(values)
            line_count += 1
    # Rows may be wrapped, as ESRI allows; but as many lines as rows, of different lengths, are broken rows.
    if count != z.size or (odd_line and line_count == rows):
        where = f"first at {odd_line}" if odd_line else f"in {line_count} rows"
        raise SlopeError(f"{path}: values", f"must be {rows} rows of {columns}, {z.size} values", f"{count}, {where}")
    return z.reshape(rows, columns), header.get("nodata_value", NODATA)     # ESRI's default


def _check_ascii_header(path, lines):
    """Read the header of an ESRI ASCII grid from its lines; return it as a dict and its number of lines.

    GDAL takes words for 0 here too, and puts a grid with xllcorner and yllcenter, or without one of them, at 0 0.
    """
    header: Dict[str, float] = {}
    number = 0
    for line in lines:
        words = line.split()
        if words and words[0].lower() not in HEADER:
            break
        number += 1
        if not words:
            continue
        try:
            key, word = words
            value = float(word.replace("_", "?"))       # Python takes 1_5 for 15
        except ValueError:
            raise SlopeError(f"{path}: line {number}", "must be a name and a number", line) from None
        if key.lower() in header:
            raise SlopeError(f"{path}: line {number}", f"header key {key} is given twice")
        if other := AGAIN.get(key.lower(), set()) & header.keys():
            raise SlopeError(f"{path}: line {number}", f"{min(other)} and {key} are both given")
        header[key.lower()] = value
    if not ({"xllcorner", "yllcorner"} <= header.keys() or {"xllcenter", "yllcenter"} <= header.keys()):
        raise SlopeError(f"{path}: header", "must have xllcorner and yllcorner, or xllcenter and yllcenter")
    for key in ("cellsize", "dx", "dy"):
        if not 0 < header.get(key, 1) < math.inf:
            raise SlopeError(f"{path}: header: {key}", "must be > 0", f"{header[key]:g}")
    return header, number


def read_asc_local(path, heights=True, unit=None, marks=None):
    """Read an .asc that write_asc_local wrote, and its sidecar, into a Raster: (z, transform, crs, offset).

    The transform gives local x, y; adding the offset (east, north) gives coordinates in crs. A raster without a
    sidecar is read as by read(); heights, unit and marks as there. Raises SlopeError if either file is broken or they
    do not belong together.
    """
    raster = read(path, heights, unit, marks)
    place = read_sidecar(path)
    if place is None:
        return raster
    if place.size != raster.z.shape or not np.allclose(raster.transform * (0, 0), place.extent[::3], rtol=0, atol=1e-3):
        raise SlopeError(Path(path).with_suffix(".yaml"), f"must be the sidecar of {path}: size and extent differ")
    return raster._replace(crs=place.crs, offset=place.offset)


def surveyed_cell(path) -> float:
    """The size (m) of the cells of a raster as it was surveyed, about; 0 where it has none, such as FG-GML."""
    try:
        with warnings.catch_warnings(), rasterio.Env():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as source:
                _, side = source.res
                if source.crs is None:
                    return side
                return side * (DEGREE if source.crs.is_geographic else source.crs.linear_units_factor[1])
    except (RasterioError, OSError):
        return 0.0


class Place(NamedTuple):
    """Where a terrain lies."""
    crs: Optional[CRS]
    offset: Tuple[float, float]                # east, north of local 0 0
    size: Tuple[int, int]                      # rows, columns
    extent: Tuple[float, float, float, float]  # local xlo, ylo, xhi, yhi


def read_sidecar(path: Union[str, Path]) -> Optional[Place]:
    """The Place of an .asc that write_asc_local wrote, None if it has no sidecar; the .asc itself is not read."""
    sidecar = Path(path).with_suffix(".yaml")
    if Path(path).suffix != ".asc" or not sidecar.exists():
        return None
    about = schemas.load(sidecar, WHAT_SIDECAR, SIDECAR)
    try:
        with rasterio.Env():  # GDAL's own messages are not for stderr
            crs = about["crs"] and CRS.from_wkt(about["crs"]["wkt"])
    except CRSError as error:
        raise SlopeError(sidecar, f"must be {WHAT_SIDECAR} ({error})") from error
    east, north = (float(about["origin"][side]) for side in ORIGIN)
    xlo, ylo, xhi, yhi = (float(about["extent"][side]) for side in EXTENT)
    return Place(crs, (east, north), (about["size"]["rows"], about["size"]["columns"]), (xlo, ylo, xhi, yhi))


def read_place(path):
    """The Place of a terrain: of its sidecar, else of the raster's own header; heights are not read."""
    if not Path(path).is_file():
        raise SlopeError(path, "must be an existing file")
    place = read_sidecar(path)
    if place is not None:
        return place
    try:
        with warnings.catch_warnings(), rasterio.Env():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(path) as source:
                return Place(source.crs, (0.0, 0.0), source.shape,
                             (source.bounds.left, source.bounds.bottom, source.bounds.right, source.bounds.top))
    except (RasterioError, OSError) as error:
        raise SlopeError(path, f"must be a raster that GDAL can read ({error})") from error


def write_asc_local(path, raster, about, exact=False):
    """Write raster (square cells, north up, at least one height) to path and the sidecar beside it; return the sidecar.

    about: dict of more entries for the sidecar. exact: heights with all of their digits, not to the millimetre, so that
    they are equal to those of another file. Both files are complete or not touched: they are written beside their names
    and then renamed. Raises SlopeError where the folder or the disk refuses.
    """
    path = Path(path)
    rows, columns = raster.z.shape
    cell = float(raster.transform.a)
    xlo, yhi = map(float, raster.transform * (0, 0))
    xhi, ylo = map(float, raster.transform * (columns, rows))
    sidecar = {
        "crs": raster.crs and {"epsg": epsg(raster.crs), "wkt": raster.crs.to_wkt()},
        "origin": {"east": float(raster.offset[0]), "north": float(raster.offset[1])},
        "cell": cell,
        "size": {"columns": columns, "rows": rows},
        "extent": {"xlo": xlo, "xhi": xhi, "ylo": ylo, "yhi": yhi},
        "height": {"min": float(np.nanmin(raster.z)), "max": float(np.nanmax(raster.z))},
        "nodata_cells": int(np.isnan(raster.z).sum()),
        **about,
    }
    with disk.beside(path.with_suffix(".yaml"), path) as (new_yaml, new_asc):
        with open(new_asc, "w", encoding="ascii") as out:
            digits = 15 if exact else 12
            form = "{!r}".format if exact else "{:.3f}".format
            out.write(f"ncols {columns}\nnrows {rows}\nxllcorner {xlo:.{digits}g}\nyllcorner {ylo:.{digits}g}\n"
                      f"cellsize {cell:.{digits}g}\nNODATA_value {NODATA}\n")
            for row in progress(raster.z, f"writing {path}"):
                out.write(" ".join([form(height) for height in row.tolist()]).replace("nan", str(NODATA)) + "\n")
        with open(new_yaml, "w", encoding="utf-8") as out:
            out.write(f"# About {path.name}. Metres; east = x + origin east, north = y + origin north.\n")
            yaml.safe_dump(sidecar, out, sort_keys=False)
    return sidecar


def write_geotiff(path, bands, raster, tags=None):
    """Write bands, a dict of name -> values (NaN: NODATA), on the grid of raster (its z is not used) to a GeoTIFF.

    tags: {name: text}, metadata of the file.

    It lies at the CRS coordinates, transform plus offset; without a CRS at the local ones. Doubles, so that sums over
    the cells are those of the array. The file is complete or not touched. Raises SlopeError where it cannot be written.
    """
    rows, columns = next(iter(bands.values())).shape
    try:
        with disk.beside(path) as (new,), warnings.catch_warnings(), rasterio.Env():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(new, "w", driver="GTiff", height=rows, width=columns, count=len(bands), dtype="float64",
                               crs=raster.crs, transform=Affine.translation(*raster.offset) * raster.transform,
                               nodata=NODATA, compress="deflate") as out:
                out.update_tags(**(tags or {}))
                for band, (name, values) in enumerate(bands.items(), 1):
                    out.write(np.where(np.isnan(values), NODATA, values), band)
                    out.set_band_description(band, name)
    except RasterioError as error:      # of those that are no OSError
        raise SlopeError(path, f"cannot be written: {error}") from error
