"""The terrain that decks read, from an elevation model: slope terrain; and the same for other algorithms."""
from contextlib import contextmanager
from pathlib import Path

from qgis.core import QgsProcessingException

from . import layers, process, styles
from .algorithm import Algorithm
from .options import Option, of
from .results import TERRAIN_TAG, NewFolder, load, survey_tif

FILES = ("terrain.asc", "terrain.yaml")
DEM = Option("DEM", "", "raster", "Elevation model or terrain (heights in m)", needed=True, own=True)
GROUND = (
    of("terrain", "crs", "CRS of the terrain, in metres (default: the model's)", kind="crs"),
    of("terrain", "assign_crs", "The elevation model is in this CRS, whatever it says", kind="crs", key="ASSIGNED_CRS",
       advanced=True),
    of("terrain", "cell", "Cell size (m; default: the model's)"),
    of("terrain", "bounds", "Crop to this box", kind="extent", own=True),
    of("terrain", "fill", "Fill holes of at most so many cells", default=None))


def bounds(asked, model):
    """--bounds W S E N in the CRS of the terrain: CRS, else ASSIGNED_CRS, else that of the raster layer model."""
    if not asked.parameters.get("BOUNDS"):
        return []
    given = [asked.algorithm.parameterAsCrs(*asked.of(key)) for key in ("CRS", "ASSIGNED_CRS")]
    crs = next((one for one in given if one.isValid()),
               asked.algorithm.parameterAsRasterLayer(*asked.of(model)).crs())
    box = asked.algorithm.parameterAsExtent(*asked.of("BOUNDS"), crs)
    if box.isEmpty():
        raise QgsProcessingException(f"BOUNDS: must be a box, got {asked.text('BOUNDS')}")
    return ["--bounds", *map(repr, (box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum()))]


def show(results, key, asc, kind, name):
    """An .asc in local metres as a layer at its place in the survey."""
    results.layer(key, survey_tif(asc, load(Path(asc).with_suffix(".yaml")), **{TERRAIN_TAG: Path(asc).name}
                                  if kind == styles.GROUND else {}), kind, name)


@contextmanager
def with_terrain(asked):
    """The folder OUTPUT and the terrain that the raster DEM is, or one made of it there: its CRS, its cells."""
    source = layers.raster_file(asked, DEM.key)
    ground = layers.slope_terrain(source)
    with NewFolder(asked.output("OUTPUT"), () if ground else FILES) as folder:
        if not ground:
            ground = str(folder / FILES[0])
            process.run(["terrain", source, "-o", ground], asked.feedback)
        yield folder, ground


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
        of("terrain", "output", "The terrain", kind="new file", filter="ESRI ASCII grid (*.asc)"))
    outputs = (("raster", "LAYER", "Terrain at the survey's coordinates (m)"),)

    def words(self, asked):
        return [*super().words(asked), *bounds(asked, "DEM")]

    def collect(self, asked, results):
        asc = asked.output("OUTPUT")
        show(results, "LAYER", asc, styles.GROUND, "terrain")
        results.put(OUTPUT=asc)
