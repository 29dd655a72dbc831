"""The database of PROJ, without which coordinates come out hundreds of metres wrong in another CRS, without a word."""
import os

import rasterio
from rasterio.crs import CRS
from rasterio.errors import CRSError

from ..errors import SlopeError

KNOWN = 30169       # EPSG, one of the many that PROJ knows by its database only
NAMES = ("PROJ_DATA", "PROJ_LIB")       # the first that is set leads PROJ there


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
