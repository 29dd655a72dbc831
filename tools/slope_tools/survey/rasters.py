"""Reading rasters, writing the plain .asc with its sidecar, and GeoTIFFs: the one place in Python that does it.

Heights are metres above the vertical datum of the survey, NaN where there is none (NODATA). Arrays have the shape
(rows, columns), rows from north to south; a value belongs to the centre of its cell. A transform takes (column, row),
counted from the outer corner of the first cell, to (x, y).
"""
import math
import re
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Dict, NamedTuple, Optional, Tuple, Union

import numpy as np
import rasterio
import yaml
from affine import Affine
from rasterio.crs import CRS
from rasterio.enums import MaskFlags
from rasterio.errors import CRSError, NotGeoreferencedWarning, RasterioError
from rasterio.windows import Window

from .. import disk, schemas
from ..errors import SlopeError
from ..schemas import COUNT, TEXT, mapping, number_keys
from . import plausible, text_grids, xyz, zips
from .crs import crs_name, epsg, require_axes
from .grids import UNITS, Raster, check_memory, progress
from .marks import Scale, cells_of, format_mark

WHAT_SIDECAR = "a sidecar that `slope terrain` wrote"
ORIGIN, EXTENT = ("east", "north"), ("xlo", "ylo", "xhi", "yhi")
SIDECAR = mapping({"crs": mapping({"wkt": TEXT}, null=True), "origin": mapping(number_keys(*ORIGIN)),
                   "size": mapping({"rows": COUNT, "columns": COUNT}), "extent": mapping(number_keys(*EXTENT))})
NODATA = -9999             # in written files
HIGHEST = 9000.0           # m; beyond +-HIGHEST a value is a NODATA mark that the file does not declare (-9999, -32768)
TAGS = {"m": "m", "metre": "m", "meter": "m", "metres": "m", "meters": "m", "ft": "ft", "foot": "ft", "feet": "ft",
        "international foot": "ft", "us survey foot": "us-ft", "us survey feet": "us-ft", "ftus": "us-ft",
        "us-ft": "us-ft", "foot_us": "us-ft"}      # how files spell them, in lower case
NO_UNIT = {"", "unspecified", "unknown", "undefined", "none"}       # how files spell that they do not say one
CACHE = 64              # MB, of GDAL, of parts of large files


class File(NamedTuple):
    """A raster file, or a part of it, with its values as they are stored."""
    stored: np.ndarray
    none: np.ndarray            # mask of those that the file says are none
    transform: Affine
    crs: Optional[CRS]
    scale: float = 1.0
    shift: float = 0.0
    unit: Optional[str] = None          # of UNITS, where the file says one
    first: Tuple[int, int] = (0, 0)     # row and column of the file where the part begins
    is_picture: bool = False            # values of 8 bits as they are, as a hillshade has


def read_raster(path, heights=True, unit=None, marks=None, ask=True):
    """Read a single-band raster (GeoTIFF, ESRI ASCII grid, list of points on a grid, or another format of GDAL), also
    in a .zip that holds one, into a Raster.

    The CRS is None where the file has none; it may be in degrees, the heights may not: they become metres, from what
    the file says, or from the unit (of UNITS) that is given. heights=False: other values than heights, such as the
    energies of fix deposit/grid; their size is not checked. marks: of the values, in the file's own unit, that stand
    for none, too; what the file has of them is noted there. ask: end where heights in feet lie over a plan that is not.
    Raises SlopeError on anything that is not such a raster.
    """
    return in_metres(path, opened(path, heights, unit), heights, unit, marks, ask=ask)


def in_metres(path, file, heights=True, unit=None, marks=None, assigned=None, ask=True):
    """The Raster of a File, see read_raster() and opened()."""
    own = unit or file.unit or "m"
    scale = Scale(file.scale, file.shift, UNITS[own])
    if marks:
        marks.take(file.stored, file.none)
    z = scale.in_unit(file.stored)
    z[file.none] = np.nan
    if heights:
        check_heights(path, z, file, own, unit is None, marks)
        if marks:
            marks.note(file.stored, file.none, scale)
    raster = Raster(scale.metres(z), file.transform, file.crs)
    if heights and ask and unit is None and own != "m":
        plausible.ask(path, raster._replace(z=z), assigned or file.crs, own)
    return raster


CHANGED = re.compile("<ScaleRatio>(?!1<)|<ScaleOffset>(?!0<)|<PixelFunctionType>|<LUT>")     # by a VRT: its values


def opened(path, heights=True, unit=None, part=None, assigned=None):
    """The File of a path, see read_raster().

    part: which of its cells, (top, bottom, left, right), of a Raster without heights; points are read as a whole.
    assigned: the CRS of its coordinates, whatever it says.
    """
    name = only(path)
    form = xyz.form_of(name)
    if form:
        grid = xyz.read_xyz_grid(name, form)
        if grid.degrees and not (assigned is not None and assigned.is_geographic):
            raise SlopeError(path, "columns in degrees must have a CRS in degrees; --assign-crs EPSG:n gives one",
                             crs_name(assigned))
        return File(grid.z, np.isnan(grid.z), grid.transform, None, unit=unit_of(path, grid.unit, None, heights, unit))
    try:
        # Env: GDAL's own messages are not for stderr
        with warnings.catch_warnings(), rasterio.Env(GDAL_CACHEMAX=CACHE):
            warnings.simplefilter("ignore", NotGeoreferencedWarning)  # an error of our own, below
            with rasterio.open(zips.gdal_name(name)) as source:
                tag = unit_tag(path, source) if heights and not unit else source.units[0]
                return _read(path, name, source, unit_of(path, tag, source.crs, heights, unit), part)
    except (RasterioError, OSError) as error:  # RasterioIOError is an OSError only
        raise unreadable(path, name, error) from error


def unit_tag(path, source, seen=()):
    """The unit that an open raster names; of a VRT, which does not repeat it, the one of its files, "" where it changes
    their values. SlopeError where these have several."""
    if source.driver != "VRT" or source.units[0] or CHANGED.search(source.tags(ns="xml:VRT").get("xml:VRT", "")):
        return source.units[0] or ""
    tags: Dict[str, Tuple[str, str]] = {}
    for name in [name for name in source.files if name not in (*seen, source.name)]:
        with suppress(RasterioError, OSError), rasterio.open(name) as part:
            if tag := unit_tag(path, part, (*seen, source.name)):
                tags.setdefault(TAGS.get(tag.strip().lower(), tag), (tag, name))
    if len(tags) > 1:
        raise SlopeError(path, "its files must have heights in one unit; --z-unit m, ft or us-ft declares one for all",
                         ", ".join(f"{tag} in {Path(name).name}" for tag, name in tags.values()))
    return next((tag for tag, _ in tags.values()), "")


def unreadable(path, name, error):
    """The SlopeError on what GDAL cannot read, with what can be done."""
    reason = str(error).replace(zips.gdal_name(name), name)
    way = zips.suggest_zip_remedy(name) or text_grids.suggest_grid_remedy(name)
    return SlopeError(path, f"must be a raster that GDAL can read ({reason}){way}")


def is_raster(path):
    """Whether a file is a raster and no layer of shapes, by its name, or what a .zip holds."""
    name = str(path).lower().removesuffix(".gz")
    return name.endswith((*zips.RASTERS, ".vrt")) or bool(zips.rasters_in(path, alone=True))


def only(path):
    """The name of the one raster in a .zip; of any other file, its own."""
    if not Path(zips.split(str(path))[0]).is_file():
        raise SlopeError(path, "must be an existing file")
    found = zips.rasters_in(path) if Path(path).is_file() else []
    if len(found) > 1:
        raise SlopeError(path, "must hold one raster; unpack it, it holds "
                         + zips.some([name[len(str(path)) + 1:] for name in found]), f"{len(found)} rasters")
    return found[0] if found else str(path)


def check_heights(path, z, file, unit, may_be_feet, marks):
    """Raise SlopeError if heights (in a unit of UNITS) cannot be those of a ground.

    None is higher than HIGHEST m, and none lower than -HIGHEST in its own unit: -9999 ft is a mark, 9999 ft a mountain.
    file: their File; may_be_feet: the unit was not given; marks: None where there is no --nodata.
    """
    top = HIGHEST / UNITS[unit]
    with np.errstate(invalid="ignore"):
        wrong = np.argwhere((z > top) | (z < -HIGHEST))
    if not len(wrong):
        return
    row, column = wrong[0]
    value, stored = z[row, column], file.stored[row, column]
    shown = format_mark(stored)
    row, column = row + file.first[0], column + file.first[1]
    remedy = f"{marks.options(shown)} if it means none" if marks else f"gdal_translate -a_nodata {shown} declares it"
    name = "metres" if unit == "m" else unit
    feet = "; --z-unit ft (slope terrain, site, route) if these are feet" if (
        may_be_feet and HIGHEST < value < HIGHEST / UNITS["ft"]) else ""
    scaled = "" if float(stored) == value else f", which stands for {value:g} {unit}"
    raise SlopeError(f"{path}: row {row + 1} column {column + 1}", f"must be a height in {name} between -9000 and "
                     f"{math.floor(top)}, or the NODATA value that the file declares; {remedy}{feet}",
                     f"{shown}{scaled}")


def unit_of(path, tag, crs, heights=True, given=None):
    """The unit (of UNITS) that a raster says its heights have by a tag, None if it does not say, or one is given.

    SlopeError where it is another one, or cannot be metres as a matter of course: the CRS is in feet, too.
    """
    tag = (tag or "").strip()
    unit = TAGS.get(tag.lower())
    if given:
        return unit
    if tag.lower() not in NO_UNIT and (unit is None or not heights and unit != "m"):
        raise SlopeError(path, "heights must be in metres or feet; --z-unit m, ft or us-ft overrides a wrong tag"
                         if heights else "must be in metres", tag)
    if unit is None and heights and crs is not None and crs.is_projected:
        name, factor = crs.linear_units_factor
        if any(abs(factor / UNITS[foot] - 1) < 1e-7 for foot in ("ft", "us-ft")):
            raise SlopeError(path, f"must say the unit of its heights, as its CRS, {crs_name(crs)}, is in {name}"
                             ": give --z-unit us-ft, ft or m (slope terrain, site, route)", "none")
    return unit


def _read(path, name, source, unit, part):
    """The File of an open raster, or of a part of it."""
    if source.count != 1:
        bands = ", ".join(f"{band} {label}".rstrip() for band, label in enumerate((one or "" for one in
                          source.descriptions), 1))
        raise SlopeError(path, f"must have one band, the heights; gdal_translate -b N takes one of {bands}",
                         f"{source.count} bands")
    if source.dtypes[0].startswith("complex"):
        raise SlopeError(path, "must hold real numbers", source.dtypes[0])
    rows, columns = source.shape
    top, bottom, left, right = 0, rows, 0, columns
    if part and not source.transform.is_degenerate:
        top, bottom, left, right = part(Raster(np.broadcast_to(np.nan, source.shape), source.transform, source.crs))
    check_memory(bottom - top, right - left, path, "" if part else "; --bounds of slope terrain and site reads a part")
    declared = source.nodata if MaskFlags.nodata in source.mask_flag_enums[0] else None
    text_values = text_grids.heights(name, source.driver, rows, columns, top, bottom)
    if source.transform.is_identity or source.transform.is_degenerate:
        raise SlopeError(path, "must be georeferenced: place and size of the cells are missing")
    if text_values:
        stored, declared = text_values[0][:, left:right], text_values[1]
        none = np.zeros(stored.shape, bool)
    elif bottom == top or left == right:
        stored, none = np.empty((0, 0), source.dtypes[0]), np.zeros((0, 0), bool)
    else:
        values = source.read(1, masked=True, window=Window(left, top, right - left, bottom - top))
        stored, none = values.data, np.ma.getmaskarray(values)
    none |= ~np.isfinite(stored)
    if declared is not None:
        none |= cells_of(stored, declared)    # GDAL's mask misses marks with few digits
    is_picture = source.dtypes[0] in ("uint8", "int8") and (source.scales[0], source.offsets[0]) == (1, 0)
    return File(stored, none, source.transform @ Affine.translation(left, top), source.crs, source.scales[0],
                source.offsets[0], unit, (top, left), is_picture)


def read_asc_local(path, heights=True):
    """Read an .asc that write_asc_local wrote, and its sidecar, into a Raster: (z, transform, crs, offset).

    The transform gives local x, y; adding the offset (east, north) gives coordinates in crs. A raster without a
    sidecar is read as by read_raster(); the others as there. Raises SlopeError if either file is broken or they
    do not belong together.
    """
    raster = placed(path, read_raster(path, heights))
    if heights:
        require_axes(raster.crs, path)
    return raster


def placed(path, raster):
    """A raster that was read from a file, at the place that the sidecar says, if there is one."""
    place = read_sidecar(path)
    if place is None:
        return raster
    if place.size != raster.z.shape or not np.allclose(raster.transform @ (0, 0), place.extent[::3], rtol=0, atol=1e-3):
        raise SlopeError(Path(path).with_suffix(".yaml"), f"must be the sidecar of {path}: size and extent differ")
    return raster._replace(crs=place.crs, offset=place.offset)


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
    content = schemas.load_checked(sidecar, WHAT_SIDECAR, SIDECAR)
    try:
        with rasterio.Env():  # GDAL's own messages are not for stderr
            crs = content["crs"] and CRS.from_wkt(content["crs"]["wkt"])
    except CRSError as error:
        raise SlopeError(sidecar, f"must be {WHAT_SIDECAR} ({error})") from error
    east, north = (float(content["origin"][side]) for side in ORIGIN)
    xlo, ylo, xhi, yhi = (float(content["extent"][side]) for side in EXTENT)
    return Place(crs, (east, north), (content["size"]["rows"], content["size"]["columns"]), (xlo, ylo, xhi, yhi))


def read_place(path):
    """The Place of a terrain: of its sidecar, else of the raster's own header; heights are not read."""
    name = only(path)
    place = read_sidecar(path)
    if place is not None:
        return place
    form = xyz.form_of(name)
    if form:
        grid = xyz.read_xyz_grid(name, form)
        rows, columns = grid.z.shape
        (xlo, ylo), (xhi, yhi) = grid.transform @ (0, rows), grid.transform @ (columns, 0)
        return Place(None, (0.0, 0.0), (rows, columns), (xlo, ylo, xhi, yhi))
    try:
        with warnings.catch_warnings(), rasterio.Env():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(zips.gdal_name(name)) as source:
                return Place(source.crs, (0.0, 0.0), source.shape,
                             (source.bounds.left, source.bounds.bottom, source.bounds.right, source.bounds.top))
    except (RasterioError, OSError) as error:
        raise unreadable(path, name, error) from error


def write_asc_local(path, raster, content, exact=False):
    """Write raster (square cells, north up, at least one height) to path and the sidecar beside it; return the sidecar.

    content: dict of more entries for the sidecar. exact: heights with all of their digits, not to the millimetre, so
    that they are equal to those of another file. Both files are complete or not touched: they are written beside their
    names and then renamed. Raises SlopeError where the folder or the disk refuses.
    """
    path = Path(path)
    rows, columns = raster.z.shape
    cell = float(raster.transform.a)
    xlo, yhi = map(float, raster.transform @ (0, 0))
    xhi, ylo = map(float, raster.transform @ (columns, rows))
    sidecar = {
        "crs": raster.crs and {"epsg": epsg(raster.crs), "wkt": raster.crs.to_wkt()},
        "origin": {"east": float(raster.offset[0]), "north": float(raster.offset[1])},
        "cell": cell,
        "size": {"columns": columns, "rows": rows},
        "extent": {"xlo": xlo, "xhi": xhi, "ylo": ylo, "yhi": yhi},
        "height": {"min": float(np.nanmin(raster.z)), "max": float(np.nanmax(raster.z))},
        "nodata_cells": int(np.isnan(raster.z).sum()),
        **content,
    }
    with disk.write_beside(path.with_suffix(".yaml"), path) as (new_yaml, new_asc):
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
        with disk.write_beside(path) as (new,), warnings.catch_warnings(), rasterio.Env():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with rasterio.open(new, "w", driver="GTiff", height=rows, width=columns, count=len(bands), dtype="float64",
                               crs=raster.crs, transform=Affine.translation(*raster.offset) @ raster.transform,
                               nodata=NODATA, compress="deflate") as out:
                out.update_tags(**(tags or {}))
                for band, (name, values) in enumerate(bands.items(), 1):
                    out.write(np.where(np.isnan(values), NODATA, values), band)
                    out.set_band_description(band, name)
    except RasterioError as error:      # of those that are no OSError
        raise SlopeError(path, f"cannot be written: {error}") from error
