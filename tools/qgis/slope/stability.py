"""The slip surfaces with the least factor of safety below a terrain: slope stability."""
from pathlib import Path

from . import process
from .algorithm import Algorithm
from .options import of
from .release import LOCAL
from .results import load, survey_tif
from .terrain import DEM, with_terrain


class Stability(Algorithm):
    """slope stability"""

    command = "stability"
    title = "Slip surfaces"
    about = """
    The slip surfaces with the least factor of safety below a terrain, in three dimensions, by Bishop's method or
    another.

    Ground: cohesion (Pa), friction (degrees), density (kg/m3), water, horizontal acceleration of an earthquake in parts
    of the weight. Limits of volume (m3), depth (m) and place make the search shorter.

    Layer: the least factor of safety of the surfaces through each cell. The algorithm Site takes the folder by the
    option --slips, the algorithm Fragility as its SLIPS. Tables: volume (m3), area (m2), depth (m), bearing of each
    body."""
    options = (
        DEM,
        of("stability", "cohesion", "Cohesion (Pa)", needed=True),
        of("stability", "friction", "Friction angle (degrees)", needed=True),
        of("stability", "density", "Density of the ground (kg/m3)"),
        of("stability", "water", "Pore pressure over the weight per area (-; default: dry)"),
        of("stability", "water_table", "Heights of the water table (m), instead", kind="raster", advanced=True),
        of("stability", "bedrock", "Heights of the bedrock, which no body cuts (m)", kind="raster", advanced=True),
        of("stability", "seismic", "Inertia in parts of the weight: horizontal, and vertical (-)", kind="numbers"),
        of("stability", "volume", "Volume of a body: from, to (m3)", kind="numbers"),
        of("stability", "depth", "Greatest depth of a body below the ground: from, to (m)", kind="numbers"),
        of("stability", "within", "Polygon in which the bodies lie", kind="polygons"),
        of("stability", "direction", "Compass bearing of sliding (degrees; default: fall line)", advanced=True),
        of("stability", "method", "Method (default: bishop)", advanced=True),
        of("stability", "keep", "Bodies that differ (default: 3)"), LOCAL,
        of("stability", "output", "Folder for the results", kind="new folder", own=True))
    outputs = (("raster", "FACTOR_LAYER", "Least factor of safety (-)"),
               ("number", "FACTOR", "Least factor of all (-)"),
               ("number", "VOLUME_OF_BODY", "Volume of its body (m3)"), ("file", "TABLE", "Table of the bodies"),
               ("file", "PICTURE", "Map and sections"))

    def work(self, asked, results):
        words = self.words(asked)
        with with_terrain(asked) as (folder, ground):
            process.run([self.command, ground, *words, "-o", folder], asked.feedback)
        about = load(Path(ground).with_suffix(".yaml"))
        results.layer("FACTOR_LAYER", survey_tif(folder / "body.factor.asc", about), "factor", "least factor of safety")
        first = load(folder / "stability.yaml")["bodies"][0]
        results.put(OUTPUT=str(folder), FACTOR=first["factor"], VOLUME_OF_BODY=first["volume"],
                    TABLE=str(folder / "stability.csv"), PICTURE=str(folder / "stability.png"))
