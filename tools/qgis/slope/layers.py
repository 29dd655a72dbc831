"""Layers of QGIS as files that the tools read: the layer's own file where that says the same, else a temporary one."""
import shutil
from pathlib import Path

from osgeo import gdal
from qgis.core import (QgsProcessingException, QgsProcessingFeatureSourceDefinition, QgsProcessingUtils,
                       QgsRasterFileWriter, QgsRasterPipe)

from .results import TERRAIN_TAG

TEXT = (".csv", ".txt", ".wkt")             # polygons that QGIS takes for tables; the tools read them
ONE_LAYER = ["geojson", "json", "shp"]      # formats of which a file has one layer


def vector_file(asked, key):
    """The file of a vector layer: with its features, only the selected ones if the user says so, and its CRS."""
    value = asked.parameters[key]
    if isinstance(value, str) and Path(value).suffix.lower() in TEXT and Path(value).is_file():
        return value
    selected = isinstance(value, QgsProcessingFeatureSourceDefinition) and value.selectedFeaturesOnly
    if isinstance(value, QgsProcessingFeatureSourceDefinition):
        value, _ = value.source.valueAsString(asked.context.expressionContext(), "")
    layer = asked.algorithm.parameterAsVectorLayer({**asked.parameters, key: value}, key, asked.context)
    if layer is None or not layer.isValid():
        raise QgsProcessingException(f"{key}: must be a vector layer, got {asked.text(key)}")
    # a CRS that was set in QGIS is not in the file, and a filter is not either
    as_it_is = layer.crs() == layer.dataProvider().crs() and not layer.subsetString()
    formats = ONE_LAYER if as_it_is else []
    path = convert(asked, layer, selected, formats, key, "gpkg" if layer.crs().isValid() else "shp")
    return path if Path(path).is_file() else convert(asked, layer, selected, [], key, "gpkg")


def convert(asked, layer, selected, formats, key, preferred):
    """The layer's path if its format is one of formats, else that of a copy in the preferred one.

    A GeoPackage keeps all digits and any CRS; a layer without a CRS would get one in it, but not in a shapefile.
    """
    path = QgsProcessingUtils.convertToCompatibleFormat(layer, selected, key.lower(), formats, preferred, asked.context,
                                                        asked.feedback)
    return path if Path(path) == Path(layer.source().split("|")[0]) else kept(asked, path)


def kept(asked, path):
    """A temporary file; if the results refer to it later, a copy of it, with what belongs to it, in their folder."""
    if asked.keep is None:
        return path
    asked.keep.mkdir(parents=True, exist_ok=True)
    for part in Path(path).parent.glob(f"{Path(path).stem}.*"):
        shutil.copy(part, asked.keep)
    return str(asked.keep / Path(path).name)


def raster_layer(asked, key):
    layer = asked.algorithm.parameterAsRasterLayer(*asked.of(key))
    if layer is None or not layer.isValid():
        raise QgsProcessingException(f"{key}: must be a raster layer, got {asked.text(key)}")
    return layer


def raster_file(asked, key):
    """The file of a raster layer, with its values and its CRS."""
    layer = raster_layer(asked, key)
    if layer.providerType() == "gdal" and Path(layer.source()).is_file() and layer.crs() == layer.dataProvider().crs():
        return layer.source()
    path = QgsProcessingUtils.generateTempFilename(f"{key.lower()}.tif")
    pipe = QgsRasterPipe()
    writer = QgsRasterFileWriter(path)
    if not pipe.set(layer.dataProvider().clone()):
        raise QgsProcessingException(f"{key}: must be a raster whose values can be read, got {layer.name()}")
    error = writer.writeRaster(pipe, layer.width(), layer.height(), layer.extent(), layer.crs(),
                               asked.context.transformContext())
    if error != QgsRasterFileWriter.WriterError.NoError:      # with Qt 6 an enum, which is true whatever it is
        raise QgsProcessingException(f"{key}: cannot be written as a GeoTIFF (error {error}), got {layer.name()}")
    return kept(asked, path)


def slope_terrain(path):
    """The .asc with a sidecar that `slope terrain` wrote, if that is what a raster file is or shows; else None."""
    path = Path(path)
    dataset = gdal.Open(str(path))
    name = dataset.GetMetadataItem(TERRAIN_TAG) if dataset else None
    asc = path if path.suffix == ".asc" else path.with_name(name) if name else None
    return str(asc) if asc and asc.is_file() and asc.with_suffix(".yaml").is_file() else None
