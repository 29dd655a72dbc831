"""Coordinate reference systems: names, are two the same, is a metre a metre, do the axes point east and north."""
import functools
import math
import os
import re
import warnings
from typing import Any, Optional

import numpy as np
import rasterio
import rasterio.warp
from rasterio.crs import CRS
from rasterio.errors import CRSError

from ..errors import SlopeError
from ..findings import Finding
from ..geometry import format_numbers

# without the database of PROJ coordinates come out hundreds of metres wrong in another CRS, without a word
KNOWN = 30169       # EPSG, one of the many that PROJ knows by its database only
NAMES = ("PROJ_DATA", "PROJ_LIB")       # the first that is set leads PROJ there
OTHER = "give one whose axes do, such as a UTM zone"
NORTH = 5.0            # degrees between grid north and north from which on the user is warned
STRETCH = 0.01         # relative error of lengths in a CRS from which on the user is warned


def require_database() -> None:
    """Raise SlopeError unless PROJ finds a database that fits it: variables may lead to another installation's."""
    try:
        with rasterio.Env():
            CRS.from_epsg(KNOWN)
    except CRSError as error:
        name = next((name for name in NAMES if os.environ.get(name)), None)
        where = f"{name}={os.environ[name]}" if name else "PROJ"
        remedy = f"unset {name}, or let it lead to one" if name else "install it (Debian: proj-data)"
        raise SlopeError(where, f"must have a database (proj.db) that fits this PROJ: {remedy}", error) from None


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


def as_crs(option: str, name: Any) -> CRS:
    """The CRS that an option names; SlopeError if there is none of that name."""
    try:
        with rasterio.Env():  # GDAL's own message is not for stderr
            return CRS.from_user_input(name)
    except CRSError:
        raise SlopeError(option, "must be a CRS such as EPSG:6677", name) from None


def same_crs(a, b):
    """Whether two CRS (or None) are one, however they are spelt."""
    if a is None or b is None:
        return a is b
    if a.is_projected and b.is_projected and not math.isclose(a.linear_units_factor[1], b.linear_units_factor[1]):
        return False        # rasterio compares what it takes for their EPSG numbers
    return a == b or (epsg(a) is not None and epsg(a) == epsg(b))


def require_metres(crs, where):
    """Raise SlopeError unless crs is in metres; None is taken to be (the caller has warned)."""
    if crs is None:
        return
    try:
        unit, factor = crs.linear_units_factor
    except CRSError:
        unit, factor = "degrees" if crs.is_geographic else "no plane unit", None
    if crs.is_geographic or factor != 1:
        raise SlopeError(where, "CRS must be in metres; give --crs EPSG:n of a projected one",
                         f"{crs_name(crs)} in {unit}")


def require_axes(crs, where):
    """Raise SlopeError if the axes of a CRS point elsewhere than to the east and the north.

    The ground would be turned or mirrored. Those of polar systems both point to the south, or both to the north. ESRI
    turns axes by a negative scale, which PROJ does not know.
    """
    if crs is None or not crs.is_projected:
        return
    text = crs.to_wkt()
    axes = [one for one in re.findall(r'AXIS\["[^"]*",(\w+)', text) if one not in ("UP", "DOWN")][-2:]
    if re.search(r'"scale_factor",-', text):
        axes = ["WEST", "SOUTH"]
    if {*axes} & {"WEST", "SOUTH"} and len({*axes}) == 2:
        raise SlopeError(where, f"the axes of its CRS must point east and north; {sister_remedy(crs)}",
                         f"{crs_name(crs)}, {' and '.join(axes).lower()}")


BESIDE = 3.0    # degrees: surveys go on with a CRS beyond the border of its area


def require_order(raster, where):
    """Raise SlopeError if a raster lies far outside of the area of its CRS, and would not with x and y exchanged."""
    if raster.crs is None or not raster.crs.is_projected:
        return
    area = area_of(epsg(raster.crs) or raster.crs.to_wkt())
    if area is None:
        return
    west, south, upper, wide = area.west, area.south, area.north, (area.east - area.west) % 360 or 360
    projection = projection_of(raster.crs.to_wkt())

    def is_within(x, y, more=0.0):
        east, north = projection(x, y, inverse=True)
        return south - more <= north <= upper + more and (east - west + more) % 360 <= wide + 2 * more

    x, y = raster.transform @ (raster.z.shape[1] / 2, raster.z.shape[0] / 2)
    if not is_within(x, y, BESIDE) and is_within(y, x):
        raise SlopeError(where, f"must lie in the area of {crs_name(raster.crs)} (with x and y exchanged it would); "
                         "points whose northing comes first need a head, such as north east height",
                         format_numbers((round(x, 1), round(y, 1))))


def sister_remedy(crs) -> str:
    """What can be done about a CRS (of rasterio) with such axes."""
    name = sister(crs)
    return f"its sister is {name}: --crs {name}, or --assign-crs {name} where the tag is wrong" if name else OTHER


def sister(crs) -> Optional[str]:
    """The system of EPSG or ESRI with the same projection whose axes point east and north, None if there is none."""
    from pyproj import CRS
    from pyproj.aoi import AreaOfInterest
    from pyproj.database import query_crs_info
    from pyproj.enums import PJType
    wanted = CRS.from_wkt(crs.to_wkt())
    authority = wanted.to_authority()
    area = CRS.from_authority(*authority).area_of_use if authority else None
    around = AreaOfInterest(area.west, area.south, area.east, area.north) if area else None
    for source in ("EPSG", "ESRI"):
        for one in query_crs_info(source, PJType.PROJECTED_CRS, around, contains=True):
            if area and one.area_of_use and one.area_of_use.east - one.area_of_use.west > 3 * (area.east - area.west):
                continue        # of the world or a continent; there are many
            found = CRS.from_authority(one.auth_name, one.code)
            if {axis.direction for axis in found.axis_info} == {"east", "north"} and is_same_crs(found, wanted):
                return f"{one.auth_name}:{one.code}"
    return None


def is_same_crs(system, wanted) -> bool:
    """Whether two systems (of pyproj) have one datum and one projection, but for their axes."""
    if system.geodetic_crs.datum.name != wanted.geodetic_crs.datum.name:
        return False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")     # that words of PROJ say less than others, which are equal here
        one, other = ({key: abs(value) if key == "k" else value for key, value in crs.to_dict().items()
                       if key != "axis"} for crs in (system, wanted))
        turned = system.to_dict().get("k", 1) < 0
    return bool(one) and one == other and not turned


def warn_of_stretch(raster, warn):
    """Warn where a metre of the CRS is not a metre on the ground (Web Mercator at 37 N: 0.8 m), by more than 1 %."""
    factors = factors_of(raster)
    for scale in (factors.parallel_scale, factors.meridional_scale):
        if not abs(1 / scale - 1) < STRETCH:
            return warn(Finding("stretched", {"crs": crs_name(raster.crs), "metres": 1 / scale}))


def warn_of_north(raster, warn):
    """Warn where the north of the grid is far off north, as in polar systems: bearings are from grid north."""
    angle = factors_of(raster).meridian_convergence
    if abs(angle) > NORTH:
        warn(Finding("grid north", {"crs": crs_name(raster.crs), "degrees": abs(angle),
                                    "side": "east" if angle > 0 else "west"}))


@functools.lru_cache
def projection_of(wkt):
    """Of PROJ, which takes milliseconds to read what a CRS is."""
    from pyproj import Proj
    return Proj(wkt)


@functools.lru_cache
def area_of(crs) -> Any:
    """Where a CRS (EPSG number, or WKT) is used, of pyproj; None where it is not known."""
    from pyproj import CRS
    return CRS.from_user_input(crs).area_of_use


def factors_of(raster):
    """Of the projection, at the middle of a raster."""
    x, y = raster.transform @ (raster.z.shape[1] / 2, raster.z.shape[0] / 2)
    projection = projection_of(raster.crs.to_wkt())
    east, north = projection(x, y, inverse=True)
    first = projection.crs.prime_meridian   # PROJ counts to the place from Greenwich, whatever the first meridian is
    return projection.get_factors(east - math.degrees(first.longitude * first.unit_conversion_factor), north)


def transform(source, target, x, y):
    """Coordinate arrays x, y from one CRS to another; inf, or SlopeError, where there is no answer."""
    try:
        new_x, new_y = rasterio.warp.transform(source, target, x.ravel(), y.ravel())
    except Exception as error:  # GDAL's, of a class that rasterio keeps private
        raise not_covered(source, target) from error
    return np.reshape(new_x, x.shape), np.reshape(new_y, y.shape)


def not_covered(source, target):
    return SlopeError("--crs", f"must cover the input, whose coordinates are in {crs_name(source)} "
                      "(--assign-crs EPSG:n overrides a wrong tag)", crs_name(target))


def require_degrees(crs, bounds, where, remedy="--assign-crs EPSG:n overrides a CRS that is wrong or missing"):
    """Raise SlopeError unless coordinates (west, south, east, north) can be those of a CRS in degrees."""
    if crs is None or not crs.is_geographic:
        return
    west, south, east, north = bounds
    if max(-west, east) > 360 or max(-south, north) > 90:
        hint = " (with x and y exchanged they would be)" if max(-west, east) <= 90 and max(-south, north) <= 360 else ""
        raise SlopeError(where, f"coordinates in {crs_name(crs)} must be longitude and latitude{hint}; {remedy}",
                         format_numbers(bounds))
