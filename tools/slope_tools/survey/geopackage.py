"""A GeoPackage of layers in the CRS of a terrain."""
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


def write(path: Path, layers: Dict[str, Layer], raster: Raster) -> None:
    """Write layers, from the local metres of a raster to its CRS."""
    crs = raster.crs.to_wkt() if raster.crs is not None else None
    with fiona.Env(OGR_CURRENT_DATE=NO_DATE), MemoryFile(ext=".gpkg") as memory:    # on disk it would be half-written
        for name, layer in layers.items():
            with fiona.open(memory.name, "w", "GPKG", {"geometry": layer.kind, "properties": dict(layer.properties)},
                            layer=name, crs_wkt=crs) as out:
                out.writerecords({"type": "Feature", "properties": values,
                                  "geometry": mapping(translate(one, *raster.offset))}
                                 for one, values in layer.features)
        disk.write(path, bytes(memory.getbuffer()))
