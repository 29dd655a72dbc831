"""Coordinate reference systems: are two the same, is a metre a metre."""
import math
import sys

import numpy as np
import rasterio
import rasterio.warp
from rasterio.crs import CRS
from rasterio.errors import CRSError

from ..errors import SlopeError
from .rasters import crs_name, epsg

STRETCH = 0.01         # relative error of lengths in a CRS from which on the user is warned


def box(bounds):
    return " ".join(f"{value:.10g}" for value in bounds)


def warn(text):
    print(f"slope terrain: warning: {text}", file=sys.stderr)


def same_crs(a, b):
    """Whether two CRS (or None) are one, however they are spelt."""
    return a == b or (a is not None and b is not None and epsg(a) is not None and epsg(a) == epsg(b))


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


def warn_of_stretch(raster):
    """Warn where a metre of the CRS is not a metre on the ground (Web Mercator at 37 N: 0.8 m), by more than 1 %."""
    x, y = raster.transform * (raster.z.shape[1] / 2, raster.z.shape[0] / 2)
    lon, lat = np.radians(transform(raster.crs, CRS.from_epsg(4326), x + np.array([0, 1, 0]), y + np.array([0, 0, 1])))
    a, e2 = 6378137.0, 0.00669438  # WGS 84: half axis (m), eccentricity squared
    n = a / math.sqrt(1 - e2 * math.sin(lat[0]) ** 2)  # radii of curvature, m: prime vertical, meridian
    m = n ** 3 * (1 - e2) / a ** 2
    for i in (1, 2):
        metre = math.hypot(n * math.cos(lat[0]) * (lon[i] - lon[0]), m * (lat[i] - lat[0]))
        if not abs(metre - 1) < STRETCH:
            return warn(f"a metre in {crs_name(raster.crs)} is {metre:.3f} m on the ground: choose a local CRS")


def transform(source, target, x, y):
    """Coordinate arrays x, y from one CRS to another; inf, or SlopeError, where there is no answer."""
    try:
        new_x, new_y = rasterio.warp.transform(source, target, x.ravel(), y.ravel())
    except Exception as error:  # GDAL's, of a class that rasterio keeps private
        raise not_covered(source, target) from error
    return np.reshape(new_x, x.shape), np.reshape(new_y, y.shape)


def not_covered(source, target):
    return SlopeError("--crs", f"must cover the input, which is in {crs_name(source)}", crs_name(target))
