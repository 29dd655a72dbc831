"""How far masses of this volume and height went: slope mobility."""
from . import process
from .algorithm import Algorithm
from .options import of
from .release import LOCAL, POLYGON, POLYGON_CRS, SCAR, SHAPE
from .results import load
from .terrain import DEM, with_terrain
from .volume import ROAD_WIDTH


class Mobility(Algorithm):
    """slope mobility"""

    command = "mobility"
    title = "Mobility of known events"
    about = """
    The probability that a mass goes beyond each point of its fall path, by known events of its volume (m3) and fall
    height (m): rock avalanches where their set covers the mass, else landslides of all sizes. No run is needed.

    The body is that of the algorithm for the body: a shape below a polygon, or a scar. Known events: 49 rock avalanches
    of Canada, unless a table of others is given. The path is that of the steepest descent, or a line from the crown
    down.

    mobility.csv and mobility.gpkg have the path (m) with the probability at each point; also a map, a profile and
    mobility.yaml."""
    options = (
        DEM, POLYGON, *SHAPE, *SCAR,
        of("mobility", "road", "Road: how likely the mass reaches it", kind="road"), ROAD_WIDTH,
        of("mobility", "path", "Path from the crown down (default: steepest descent)", kind="line"),
        of("mobility", "confined", "Path confined by valley sides (default: unknown)"),
        of("mobility", "known", "Known events (default: 49 rock avalanches)", kind="file", key="SET",
           filter="Table (*.csv)", advanced=True),
        POLYGON_CRS, LOCAL, of("mobility", "output", "Folder for the results", kind="new folder", own=True))
    outputs = (("number", "AT_ROAD", "Probability of going beyond the road (-)"),
               ("number", "VOLUME_OF_BODY", "Volume of the body (m3)"),
               ("file", "TABLE", "Path with probabilities, CSV"),
               ("file", "PATH_LINE", "Path with probabilities, GeoPackage"), ("file", "PICTURE", "Map"),
               ("file", "PROFILE", "Profile"))

    def work(self, asked, results):
        words = self.words(asked)
        with with_terrain(asked) as (folder, ground):
            process.run([self.command, ground, *words, "-o", folder], asked.feedback)
        about = load(folder / "mobility.yaml")
        results.put(OUTPUT=str(folder), AT_ROAD=(about["road"] or {}).get("exceedance"),
                    VOLUME_OF_BODY=about["volume_m3"], TABLE=str(folder / "mobility.csv"),
                    PATH_LINE=str(folder / "mobility.gpkg"),
                    PICTURE=str(folder / "mobility_map.png"), PROFILE=str(folder / "mobility_profile.png"))
