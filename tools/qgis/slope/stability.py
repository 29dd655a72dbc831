"""The slip surfaces with the least factor of safety below a terrain: slope stability."""
from pathlib import Path

from . import process
from .algorithm import Algorithm
from .options import Option
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
        Option("COHESION", "--cohesion", "number", "Cohesion (Pa)", needed=True),
        Option("FRICTION", "--friction", "number", "Friction angle (degrees)", needed=True),
        Option("DENSITY", "--density", "number", "Density of the ground (kg/m3)", needed=True),
        Option("WATER", "--water", "number", "Pore pressure over the weight per area (-; default: dry)"),
        Option("WATER_TABLE", "--water-table", "raster", "Heights of the water table (m), instead", advanced=True),
        Option("BEDROCK", "--bedrock", "raster", "Heights of the bedrock, which no body cuts (m)", advanced=True),
        Option("SEISMIC", "--seismic", "numbers", "Inertia in parts of the weight: horizontal, and vertical (-)"),
        Option("VOLUME", "--volume", "numbers", "Volume of a body: from, to (m3)"),
        Option("DEPTH", "--depth", "numbers", "Greatest depth of a body below the ground: from, to (m)"),
        Option("WITHIN", "--within", "polygons", "Polygon in which the bodies lie"),
        Option("DIRECTION", "--direction", "number", "Compass bearing of sliding (degrees; default: fall line)",
               advanced=True),
        Option("METHOD", "--method", "choice", "Method (default: bishop)", choices=("bishop", "ordinary", "spencer"),
               advanced=True),
        Option("KEEP", "--keep", "whole", "Bodies that differ (default: 3)", least=1), LOCAL,
        Option("OUTPUT", "-o", "new folder", "Folder for the results", own=True))
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
