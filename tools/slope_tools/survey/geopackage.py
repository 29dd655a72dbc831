"""A GeoPackage of layers in the CRS of a terrain."""
import contextlib
import sqlite3
from pathlib import Path
from typing import Any, Dict, Iterable, Mapping, NamedTuple, Tuple

import fiona
from fiona.io import MemoryFile
from shapely.affinity import translate
from shapely.geometry import mapping
from shapely.geometry.base import BaseGeometry

from .. import disk
from .rasters import Raster

NO_DATE = "2000-01-01T00:00:00.000Z"    # in place of that of writing: the same numbers are the same bytes


class Layer(NamedTuple):
    """kind: of the geometries; properties: {name: int, float or str}; features: geometries (local m) and values."""
    kind: str
    properties: Mapping[str, str]
    features: Iterable[Tuple[BaseGeometry, Mapping[str, Any]]]


# where QGIS has the styles of a GeoPackage's layers
STYLES = "layer_styles"
OF_STYLE = {"f_table_catalog": "str", "f_table_schema": "str", "f_table_name": "str", "f_geometry_column": "str",
            "styleName": "str", "styleQML": "str", "styleSLD": "str", "useAsDefault": "bool", "description": "str",
            "owner": "str", "ui": "str", "update_time": "datetime"}


def write_geopackage(path: Path, layers: Dict[str, Layer], raster: Raster, styles: Mapping[str, str] = {}) -> None:
    """Write layers, from the local metres of a raster to its CRS; styles: of QGIS (QML), {layer: text}."""
    crs = raster.crs.to_wkt() if raster.crs is not None else None
    with fiona.Env(OGR_CURRENT_DATE=NO_DATE), MemoryFile(ext=".gpkg") as memory:    # on disk it would be half-written
        for name, layer in layers.items():
            with fiona.open(memory.name, "w", "GPKG", {"geometry": layer.kind, "properties": dict(layer.properties)},
                            layer=name, crs_wkt=crs) as out:
                out.writerecords({"type": "Feature", "properties": values,
                                  "geometry": mapping(translate(one, *raster.offset))}
                                 for one, values in layer.features)
        if styles:
            with fiona.open(memory.name, "w", "GPKG", {"geometry": "None", "properties": OF_STYLE},
                            layer=STYLES) as out:
                out.writerecords({"type": "Feature", "geometry": None, "properties": {
                    **dict.fromkeys(OF_STYLE, ""), "f_table_name": name, "f_geometry_column": "geom", "styleName": name,
                    "styleQML": text, "useAsDefault": True, "update_time": NO_DATE}} for name, text in styles.items())
        data = bytes(memory.getbuffer())
    disk.write_file(path, data if crs else cartesian(data))


def cartesian(data: bytes) -> bytes:
    """A GeoPackage whose layers have no CRS with coordinates in metres.

    To GDAL they are degrees (srs_id 0) or, from 3.9 on, anything (99999).
    """
    with contextlib.closing(sqlite3.connect(":memory:")) as base:
        base.deserialize(data)
        for table in ("gpkg_contents", "gpkg_geometry_columns"):
            base.execute(f"UPDATE {table} SET srs_id = -1 WHERE srs_id IN (0, 99999)")
        base.commit()
        return base.serialize()
