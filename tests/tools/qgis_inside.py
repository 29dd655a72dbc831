"""What the tests of the plugin do inside of QGIS: `python3 qgis_inside.py FUNCTION ARGUMENT ...` prints JSON."""
import json
import os
import sys
from pathlib import Path

from qgis.core import (QgsApplication, QgsCoordinateReferenceSystem, QgsFeature, QgsGeometry, QgsMapRendererParallelJob,
                       QgsMapSettings, QgsProcessingContext, QgsProcessingException,
                       QgsProcessingFeatureSourceDefinition, QgsProcessingFeedback, QgsProject, QgsRasterLayer,
                       QgsRectangle, QgsVectorLayer)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor

TOOLS = Path(os.environ["SLOPE_TOOLS"])


def start():
    """QGIS without windows, with Processing and the plugin; what is returned must be kept."""
    application = QgsApplication([], False)
    application.initQgis()
    sys.path += [f"{QgsApplication.pkgDataPath()}/python/plugins", str(TOOLS / "qgis")]
    from processing.core.Processing import Processing
    Processing.initialize()
    import slope
    plugin = slope.classFactory(None)
    plugin.initProcessing()
    return application, plugin


class Feedback(QgsProcessingFeedback):
    """Keeps what is said; cancels itself after a line that holds a word."""

    def __init__(self, cancel_at=None):
        super().__init__(False)
        self.lines, self.percents, self.cancel_at = [], [], cancel_at
        self.progressChanged.connect(self.percents.append)

    def pushInfo(self, info):
        self.lines.append(info)
        if self.cancel_at and self.cancel_at in info:
            self.cancel()

    pushCommandInfo = pushConsoleInfo = pushWarning = pushInfo


def run(name, **parameters):
    """The results of an algorithm, or the error."""
    import processing
    try:
        return processing.run(f"slope:{name}", parameters, feedback=Feedback())
    except QgsProcessingException as error:
        return {"error": str(error)}


def algorithms():
    """Help and texts of the parameters and outputs of every algorithm."""
    provider = QgsApplication.processingRegistry().providerById("slope")
    return {one.id(): {"help": one.shortHelpString(),
                       "parameters": {p.name(): p.description() for p in one.parameterDefinitions()},
                       "outputs": {o.name(): o.description() for o in one.outputDefinitions()}}
            for one in provider.algorithms()}


def open_layer(path):
    """As the project does it: with the style that lies beside the file."""
    kind = QgsRasterLayer if Path(path).suffix in (".tif", ".asc") else QgsVectorLayer
    layer = kind(path, Path(path).stem)
    assert layer.isValid(), path
    return layer


def style(layer):
    """Renderer, upper bounds of classes, their labels and whether the first one is clear."""
    renderer = layer.renderer()
    about = {"crs": layer.crs().authid(), "renderer": type(renderer).__name__, "extent": layer.extent().toString(3)}
    if hasattr(renderer, "ranges"):
        about.update(column=renderer.classAttribute(), labels=[one.label() for one in renderer.ranges()],
                     bounds=[one.upperValue() for one in renderer.ranges()], named=layer.labelsEnabled())
    elif hasattr(renderer, "shader"):
        items = renderer.shader().rasterShaderFunction().colorRampItemList()
        about.update(labels=[one.label for one in items], bounds=[str(one.value) for one in items],
                     clear=[one.color.alpha() == 0 for one in items])
    return about


def look(picture, *paths):
    """Render the layers, the first one at the bottom; their styles, and the number of colours of the picture."""
    layers = [open_layer(path) for path in paths]
    settings = QgsMapSettings()
    settings.setLayers(layers[::-1])
    settings.setOutputSize(QSize(800, 500))
    settings.setBackgroundColor(QColor("white"))
    settings.setDestinationCrs(layers[0].crs())
    extent = QgsRectangle(layers[0].extent())
    settings.setExtent(extent)
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    assert not job.errors(), job.errors()
    image = job.renderedImage()
    image.save(picture)
    found = {image.pixel(x, y) for x in range(0, 800, 4) for y in range(0, 500, 4)}
    return {"styles": {path: style(layer) for path, layer in zip(paths, layers)}, "colours": len(found)}


def memory_layer(crs, *boxes):
    """A polygon layer in memory, boxes as WEST,SOUTH,EAST,NORTH."""
    layer = QgsVectorLayer(f"Polygon?crs={crs}" if crs else "Polygon", "drawn", "memory")
    if not crs:
        layer.setCrs(QgsCoordinateReferenceSystem())
    for box in boxes:
        feature = QgsFeature()
        feature.setGeometry(QgsGeometry.fromRect(QgsRectangle(*map(float, box.split(",")))))
        layer.dataProvider().addFeature(feature)
    QgsProject.instance().addMapLayer(layer)
    return layer


def memory(prefix, crs, road, far):
    """Volumes with roads that are no plain files: in memory, a selection, without a CRS, one of two layers."""
    both = memory_layer(crs, road, far)
    both.selectByIds([next(both.getFeatures()).id()])
    found = {"one": run("volume", RUN=prefix, MESH=5, ROAD=memory_layer(crs, road), OUTPUT="one"),
             "both": run("volume", RUN=prefix, MESH=5, ROAD=both, OUTPUT="both"),
             "selected": run("volume", RUN=prefix, MESH=5, OUTPUT="selected",
                             ROAD=QgsProcessingFeatureSourceDefinition(both.id(), True)),
             "none": run("volume", RUN=prefix, MESH=5, ROAD=memory_layer("", road), OUTPUT="none"),
             "text": run("volume", RUN=prefix, MESH=5, ROAD="road.csv", LOCAL=True, OUTPUT="text")}
    untagged = QgsVectorLayer("untagged.shp", "untagged")
    untagged.setCrs(QgsCoordinateReferenceSystem())
    found["untagged"] = run("volume", RUN=prefix, MESH=5, ROAD=untagged, OUTPUT="untagged")
    untagged.setCrs(QgsCoordinateReferenceSystem(crs))
    found["tagged"] = run("volume", RUN=prefix, MESH=5, ROAD=untagged, OUTPUT="tagged")
    filtered = QgsVectorLayer("both.shp", "filtered")
    filtered.setSubsetString("id = 1")
    found["filtered"] = run("volume", RUN=prefix, MESH=5, ROAD=filtered, OUTPUT="filtered")
    roads = QgsVectorLayer("several.gpkg|layername=road", "road")
    found["layer"] = run("volume", RUN=prefix, MESH=5, ROAD=roads, OUTPUT="layer")
    return found


def rasters(dem, untagged, polygon, crs):
    """Bodies from an elevation model whose CRS is only known to QGIS."""
    layer = QgsRasterLayer(untagged, "dem")
    layer.setCrs(QgsCoordinateReferenceSystem())
    found = {"file": run("release", DEM=dem, POLYGON=polygon, DEPTH=3, OUTPUT="file"),
             "none": run("release", DEM=layer, POLYGON=polygon, DEPTH=3, OUTPUT="none")}
    layer.setCrs(QgsCoordinateReferenceSystem(crs))
    found["tagged"] = run("release", DEM=layer, POLYGON=polygon, DEPTH=3, OUTPUT="tagged")
    return found


def volume(prefix, road, width):
    """The results of slope:volume of a road that is a line."""
    return run("volume", RUN=prefix, ROAD=road, ROAD_WIDTH=float(width), LANE=3, MESH=5, OUTPUT="line")


def project(prefix, road):
    """Layers that come into the project, with their styles."""
    import processing
    from processing.gui.Postprocessing import handleAlgorithmResults
    for load in (False, True):
        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        parameters = {"RUN": prefix, "ROAD": road, "MESH": 5, "OUTPUT": "loaded", "LOAD": load}
        processing.run("slope:volume", parameters, context=context, feedback=Feedback())
        algorithm = QgsApplication.processingRegistry().algorithmById("slope:volume")
        assert handleAlgorithmResults(algorithm, context, Feedback(), parameters=parameters)
        if not load:
            assert not QgsProject.instance().mapLayers()
    return {layer.name(): style(layer) for layer in QgsProject.instance().mapLayers().values()}


def said(*lines):
    """What is made of lines of standard error."""
    from slope import process
    return [process.said(line) for line in lines]


def study(deck, word, *settings):
    """A study that is cancelled when a line holds the word, and is then run to its end; what was said in both."""
    import processing
    found = []
    for cancel_at in (word, None):
        feedback = Feedback(cancel_at)
        parameters = {"DECK": deck, "SET": "\n".join(settings), "JOBS": 1, "OUTPUT": "study"}
        try:
            results = processing.run("slope:study", parameters, feedback=feedback)
        except QgsProcessingException as error:
            results = {"error": str(error)}
        found.append({"results": results, "lines": feedback.lines, "percents": feedback.percents,
                      "folders": sorted(path.name for path in Path("study").iterdir() if path.is_dir())})
    return found


if __name__ == "__main__":
    kept = start()
    print("JSON " + json.dumps(globals()[sys.argv[1]](*sys.argv[2:])), flush=True)
    os._exit(0)     # QGIS and Python do not agree on who ends first
