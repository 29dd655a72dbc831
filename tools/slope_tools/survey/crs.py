"""Coordinate reference systems: are two the same, is a metre a metre."""
import math
from typing import Any

import numpy as np
import rasterio
import rasterio.warp
from rasterio.crs import CRS
from rasterio.errors import CRSError

from ..errors import SlopeError
from ..findings import Finding
from ..geometry import numbers
from .rasters import crs_name, epsg

STRETCH = 0.01         # relative error of lengths in a CRS from which on the user is warned


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


def warn_of_stretch(raster, warn):
    """Warn where a metre of the CRS is not a metre on the ground (Web Mercator at 37 N: 0.8 m), by more than 1 %."""
    from pyproj import Proj
    x, y = raster.transform * (raster.z.shape[1] / 2, raster.z.shape[0] / 2)
    projection = Proj(raster.crs.to_wkt())
    factors = projection.get_factors(*projection(x, y, inverse=True))
    for scale in (factors.parallel_scale, factors.meridional_scale):
        if not abs(1 / scale - 1) < STRETCH:
            return warn(Finding("stretched", {"crs": crs_name(raster.crs), "metres": 1 / scale}))


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
        raise SlopeError(where, f"coordinates in {crs_name(crs)} must be longitude and latitude; {remedy}",
                         numbers(bounds))
