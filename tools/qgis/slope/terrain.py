"""The terrain that decks read, from an elevation model: slope terrain; and the same for other algorithms."""
from pathlib import Path

from qgis.core import QgsProcessingException

from . import process, styles
from .algorithm import Algorithm
from .options import Option
from .results import TERRAIN_TAG, load, survey_tif


GROUND = (
    Option("CRS", "--crs", "crs", "CRS of the terrain, in metres (default: the model's)"),
    Option("CELL", "--cell", "number", "Cell size (m; default: the model's)"),
    Option("BOUNDS", "--bounds", "extent", "Crop to this box", own=True),
    Option("FILL", "--fill", "whole", "Fill holes of at most so many cells"))


def bounds(asked, model):
    """--bounds W S E N in the CRS of the terrain: that of the parameter CRS, else of the raster layer model."""
    if not asked.parameters.get("BOUNDS"):
        return []
    crs = asked.algorithm.parameterAsCrs(*asked.of("CRS"))
    if not crs.isValid():
        crs = asked.algorithm.parameterAsRasterLayer(*asked.of(model)).crs()
    box = asked.algorithm.parameterAsExtent(*asked.of("BOUNDS"), crs)
    if box.isEmpty():
        raise QgsProcessingException(f"BOUNDS: must be a box, got {asked.text('BOUNDS')}")
    return ["--bounds", *map(repr, (box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum()))]


def show(results, key, asc, kind, name):
    """An .asc in local metres as a layer at its place in the survey."""
    results.layer(key, survey_tif(asc, load(Path(asc).with_suffix(".yaml")), **{TERRAIN_TAG: Path(asc).name}
                                  if kind == styles.GROUND else {}), kind, name)


def make(source, asc, feedback):
    """Make a terrain of an elevation model as it is: its CRS, its cells."""
    process.run(["terrain", source, "-o", asc], feedback)


class Terrain(Algorithm):
    """slope terrain"""

    command = "terrain"
    title = "Terrain from an elevation model"
    about = """
    An elevation model (heights in m) as the plain terrain.asc that decks read: local metres, with a sidecar
    terrain.yaml that says where it lies.

    A model in degrees, or in a CRS that is not in metres, needs a CRS in metres. The cell size is in metres;
    larger cells get the mean of several points. Holes of at most so many cells are filled from their rims.

    The layer is a GeoTIFF beside it with the same heights at the survey's coordinates; the other algorithms
    take either."""
    options = (
        Option("DEM", "", "raster", "Elevation model (heights in m)", needed=True),
        *GROUND,
        Option("OUTPUT", "-o", "new file", "The terrain", filter="ESRI ASCII grid (*.asc)"))
    outputs = (("raster", "LAYER", "Terrain at the survey's coordinates (m)"),)

    def words(self, asked):
        return [*super().words(asked), *bounds(asked, "DEM")]

    def collect(self, asked, results):
        asc = asked.output("OUTPUT")
        show(results, "LAYER", asc, styles.GROUND, "terrain")
        results.put(OUTPUT=asc)
