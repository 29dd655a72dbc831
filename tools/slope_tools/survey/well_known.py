"""Well-known text as others write it: SRID=n; in front, as PostGIS does, or a column of a table, as QGIS does."""
import re
from typing import Optional, Tuple

from rasterio.crs import CRS

from ..errors import SlopeError
from .crs import as_crs

KINDS = (r"(?:(?:MULTI|COMPOUND)?(?:POLYGON|LINESTRING|POINT|CURVE|SURFACE)|GEOMETRYCOLLECTION|LINEARRING|CURVEPOLYGON|"
         r"CIRCULARSTRING|TRIANGLE|TIN)\s*(?:Z|M|ZM)?\s*(?:\(|EMPTY)")
SRID = re.compile(rf"SRID\s*=\s*(\d+)\s*;\s*(?={KINDS})", re.IGNORECASE)
CELL = re.compile(rf"(?:{SRID.pattern})?{KINDS}[^\";\t\n]*", re.IGNORECASE)
COLUMNS = {"wkt", "wkt_geom", "geom", "geometry", "the_geom"}


def plain(path: object, text: str) -> Tuple[str, Optional[CRS]]:
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
