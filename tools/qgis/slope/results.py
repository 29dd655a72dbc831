"""What an algorithm gives back: layers with styles, numbers, files."""
from pathlib import Path

import yaml
from osgeo import gdal
from qgis.core import (QgsProcessingContext, QgsProcessingException, QgsProcessingLayerPostProcessorInterface,
                       QgsRasterLayer, QgsVectorLayer)

from . import styles

TERRAIN_TAG = "SLOPE_TERRAIN"       # in a GeoTIFF: the .asc beside it that it shows
gdal.UseExceptions()


class Styler(QgsProcessingLayerPostProcessorInterface):
    """Gives a layer the style that lies beside its file once it is in the project."""

    kept = []       # QGIS does not hold the Python half of them

    def __init__(self, style):
        super().__init__()
        self.style = style
        self.kept.append(self)

    def postProcessLayer(self, layer, context, feedback):
        layer.loadNamedStyle(self.style)
        layer.triggerRepaint()


class Results:
    """Collects what processAlgorithm() returns; layers are opened in the project if the user wants so."""

    def __init__(self, asked, load):
        self.asked, self.load, self.values = asked, load, {}

    def layer(self, key, path, kind, name):
        """A raster or vector file as a layer of a kind of styles.py; key None: no output of its own."""
        path = str(path)
        raster = Path(path).suffix in (".tif", ".asc")
        layer = QgsRasterLayer(path, name) if raster else QgsVectorLayer(path, name)
        if not layer.isValid():
            raise QgsProcessingException(f"{path}: must be a layer that QGIS can read")
        styles.apply(layer, kind)
        style = str(Path(path).with_suffix(".qml"))
        _, ok = layer.saveNamedStyle(style)
        if not ok:
            raise QgsProcessingException(f"{style}: cannot be written")
        if key:
            self.values[key] = path
        context = self.asked.context
        if self.load and context.project():
            context.addLayerToLoadOnCompletion(path, QgsProcessingContext.LayerDetails(name, context.project(),
                                                                                       key or ""))
            context.layerToLoadOnCompletionDetails(path).setPostProcessor(Styler(style))

    def put(self, **values):
        """Numbers, and paths of files."""
        self.values.update({key: value for key, value in values.items() if value is not None})


def load(path):
    """The content of a YAML file that a tool wrote."""
    with open(path, encoding="utf-8") as text:
        return yaml.safe_load(text)


def survey_tif(asc, about, **metadata):
    """A GeoTIFF beside an .asc in local metres: the same values at the survey's coordinates, by its sidecar's content.

    about: with crs (wkt, or None) and origin (east, north).
    """
    tif = Path(asc).with_suffix(".tif")
    new = tif.with_suffix(".new.tif")
    source = gdal.OpenEx(str(asc), open_options=["DATATYPE=Float64"])
    west, cell, _, north, _, _ = source.GetGeoTransform()
    east, up = about["origin"]["east"], about["origin"]["north"]
    bounds = [west + east, north + up, west + east + cell * source.RasterXSize, north + up - cell * source.RasterYSize]
    gdal.Translate(str(new), source, outputBounds=bounds, outputSRS=about["crs"] and about["crs"]["wkt"],
                   creationOptions=["COMPRESS=DEFLATE"], metadataOptions=[f"{a}={b}" for a, b in metadata.items()])
    new.replace(tif)
    return tif


def geopackage(geojson, path, crs):
    """The features of a GeoJSON file as a GeoPackage, in the coordinates that they have. crs: None for local metres.

    A GeoJSON without a CRS is taken for degrees.
    """
    Path(path).unlink(missing_ok=True)
    assigned = ["-a_srs", "NONE"] if crs is None else []
    gdal.VectorTranslate(str(path), str(geojson), options=["-f", "GPKG", "-nln", Path(path).stem, *assigned])
    return path


class NewFolder:
    """A folder for results; if the work fails, it goes again, and those of the files names that were not there."""

    def __init__(self, path, names):
        self.path, self.names, self.made = Path(path), names, []

    def __enter__(self):
        self.made = [one for one in (self.path, *self.path.parents) if not one.exists()]
        self.names = [name for name in self.names if not (self.path / name).exists()]
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise QgsProcessingException(f"OUTPUT: cannot be made: {error.strerror}, got {self.path}") from error
        return self.path

    def __exit__(self, kind, *_):
        if kind is None:
            return
        for name in self.names:
            (self.path / name).unlink(missing_ok=True)
        for folder in self.made:
            if not any(folder.iterdir()):
                folder.rmdir()
