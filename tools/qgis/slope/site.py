"""A site's folder from layers: slope site."""
from .algorithm import Algorithm
from .options import Option
from .release import SHAPE


class Site(Algorithm):
    """slope site"""

    command = "site"
    title = "Site from layers"
    about = """
    The folder of a site, from an elevation model (heights in m), the release polygon and the road: terrain,
    body, deck, and site.yaml, which holds every choice. The algorithm Study then runs the site's standard
    study."""
    options = (
        Option("TERRAIN", "--terrain", "raster", "Elevation model (heights in m)", needed=True),
        Option("RELEASE", "--release", "polygons", "Polygon where the mass is released", needed=True),
        *SHAPE,
        Option("ROAD", "--road", "polygons", "Road (polygons)"),
        Option("STRUCTURE", "--structure", "file", "Structure on which forces are measured (STL, m)",
               filter="STL (*.stl)"),
        Option("MOTION", "--motion", "file", "Motion of the ground, as slope quake wrote it (s, m/s2)"),
        Option("OUTPUT", "-o", "new folder", "Folder of the site"))

    def collect(self, asked, results):
        results.put(OUTPUT=asked.output("OUTPUT"))
