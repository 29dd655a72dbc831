"""Reading lines (GeoJSON, shapefile, WKT, CSV) to the local metres of a run: the axis of a road, a section."""
import fiona
import numpy as np
from fiona.errors import FionaError
from rasterio.crs import CRS
from rasterio.errors import CRSError
from shapely import wkt
from shapely.errors import ShapelyError
from shapely.geometry import GeometryCollection, LineString, MultiLineString, shape
from shapely.ops import linemerge

from ..errors import SlopeError
from . import polygons
from .crs import same_crs, transform
from .rasters import crs_name


def lines_of(geometry):
    """The lines in a geometry as a MultiLineString, joined where they touch."""
    if geometry.geom_type in ("LineString", "LinearRing"):
        return MultiLineString([geometry] if not geometry.is_empty else [])
    lines = [line for part in getattr(geometry, "geoms", ()) for line in lines_of(part).geoms]
    if len(lines) > 1:
        merged = linemerge(lines)
        lines = list(getattr(merged, "geoms", [merged]))
    return MultiLineString(lines)


def read_local(path, raster, local, what="line", advice=None):
    """The lines in a file, a MultiLineString in the local metres of a run, drawn in the file's direction.

    A CSV (x,y in its lines) or WKT is in the CRS of the run's terrain; local: coordinates of any file are local metres
    already. what: what the line is, for messages; advice: a polygons.Advice for those on a missing CRS. Raises
    SlopeError, which names the file.
    """
    if not path.is_file():
        raise SlopeError(path, "must be an existing file")
    text_ = polygons.read_text(path)
    crs = raster.crs
    try:
        if text_ is None:
            with fiona.Env(), fiona.open(path) as source:
                crs = CRS.from_wkt(source.crs_wkt) if source.crs_wkt else None
                lines = lines_of(GeometryCollection([shape(feature["geometry"]) for feature in source
                                                     if feature["geometry"]]))
        elif polygons.WKT.match(text_.lstrip()):
            lines = lines_of(wkt.loads(text_))
        else:
            content = [line.split("#")[0].strip() for line in text_.splitlines()]
            lines = lines_of(LineString([tuple(map(float, line.split(","))) for line in content if line]))
    except (FionaError, ShapelyError, OSError, ValueError, TypeError, AttributeError, CRSError) as error:
        raise SlopeError(path, "must be a line: GeoJSON, shapefile, WKT, or CSV with x,y in its lines "
                         f"({error})") from error
    if lines.is_empty or not all(np.isfinite(line.coords).all() for line in lines.geoms) or lines.length == 0:
        raise SlopeError(path, "must hold a line of a length > 0")
    points = [np.asarray(line.coords)[:, :2] for line in lines.geoms]
    if local:
        return MultiLineString(points)
    if text_ is None and (crs is None or raster.crs is None):
        where, remedy = "--terrain", f"--local if the {what} is in the run's local metres"
        if advice:
            where, remedy = advice.terrain, advice.polygon_crs if crs is None else advice.terrain_crs
        raise SlopeError(path if crs is None else where, f"must have a CRS, so that {what} and deposit can be brought "
                         f"together ({remedy})", "none")
    if not same_crs(crs, raster.crs):
        points = [np.transpose(transform(crs, raster.crs, *line.T)) for line in points]
        if not all(np.isfinite(line).all() for line in points):
            raise SlopeError(path, f"must lie where {crs_name(raster.crs)}, the CRS of the terrain, covers it")
    return MultiLineString([line - raster.offset for line in points])
