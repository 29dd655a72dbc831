"""A site's folder from layers: slope site."""
import shutil
from pathlib import Path

from . import process, styles, terrain
from .algorithm import Algorithm
from .options import of
from .release import SCAR, SHAPE
from .results import load
from .volume import CLEARING, CUT_ANGLE, MESH


class Site(Algorithm):
    """slope site"""

    command = "site"
    title = "Site from layers"
    about = """
    The folder of a site, from an elevation model (heights in m), the release polygon and the road: terrain, body,
    deck, map, and site.yaml, which holds every choice. A trial run with coarse balls finds the run time. The
    algorithm Study takes site.yaml and makes the standard study: rolling resistances, repeats, sizes of balls.

    The body is a slip surface below the polygon, to a largest depth (m) or to a volume (m3), or a scar; see the
    algorithm for the body. The balls are as many as wanted, or as the study may take minutes on this machine, or
    memory (GB), or of a diameter (m). One of these is given.

    Layers that are no files of their own, or whose CRS was set in QGIS, are kept in a folder beside that of the
    site, FOLDER.layers, to which site.yaml refers."""
    options = (
        of("site", "terrain", "Elevation model (heights in m)", kind="raster", key="DEM", needed=True),
        of("site", "release", "Polygon where the mass is released", kind="polygons"),
        *SHAPE,
        of("site", "road", "Road: the volume to remove from it", kind="road"),
        *CLEARING, CUT_ANGLE, MESH,
        of("site", "ground", "Zones of the ground: friction, rolling, restitution, spacing", kind="polygons"),
        of("site", "ground", "Zones of the ground, classes", kind="raster", key="GROUND_CLASSES", advanced=True),
        of("site", "ground_table", "Table of these classes (CSV)", kind="file", filter="CSV (*.csv)", advanced=True),
        of("site", "structure", "Wall or building (STL, m)", kind="file", filter="STL (*.stl)"),
        of("site", "line", "Control line: what crosses it is counted", kind="line"),
        of("site", "motion", "Motion of the ground, as slope quake wrote it (s, m/s2)", kind="file"),
        of("site", "observed", "Mapped deposit, outline", kind="polygons"),
        of("site", "observed", "Mapped deposit, thickness (m)", kind="raster", key="OBSERVED_THICKNESS", advanced=True),
        *terrain.GROUND, *SCAR,
        of("site", "balls", "Balls in the body (default: 400)"),
        of("site", "minutes", "Minutes that the study may take"),
        of("site", "memory", "Memory that the study may take (GB)", advanced=True),
        of("site", "diameter", "Diameter of the balls (m)", advanced=True),
        of("site", "name", "Name of the site, for the report"),
        of("site", "client", "Client, for the report"),
        of("site", "author", "Author, for the report"),
        of("site", "output", "New folder of the site", kind="new folder"))
    outputs = (("raster", "DEPTH_LAYER", "Depth of the body (m)"), ("raster", "TERRAIN_LAYER", "Terrain (m)"),
               ("vector", "ZONES", "Zones of the ground"),
               ("number", "RELEASED", "Volume of the body (m3)"), ("number", "NUMBER_OF_BALLS", "Balls in the body"),
               ("number", "STUDY_MINUTES", "Estimated time of the study (minutes)"),
               ("file", "SITE", "Choices of the site (site.yaml), for the algorithm Study"), ("file", "PICTURE", "Map"))

    def work(self, asked, results):
        keep = Path(f"{asked.output('OUTPUT')}.layers")
        asked.keep, there = keep, keep.exists()
        try:
            process.run([self.command, *self.words(asked), *terrain.bounds(asked, "DEM")], asked.feedback)
        except Exception:
            if keep.exists() and not there:     # the failed call's own copies
                shutil.rmtree(keep)
            raise
        self.collect(asked, results)

    def collect(self, asked, results):
        folder = Path(asked.output("OUTPUT"))
        terrain.show(results, "TERRAIN_LAYER", folder / "terrain.asc", "ground", "terrain")
        terrain.show(results, "DEPTH_LAYER", folder / "release.depth.asc", "depth", "depth of the body (m)")
        found = load(folder / "site.yaml")["found"]
        if found.get("zones"):
            results.layer("ZONES", folder / "ground.gpkg", styles.ZONES, "zones of the ground")
        seconds = found["study"]["seconds"]
        results.put(OUTPUT=str(folder), RELEASED=found["body"]["volume"], NUMBER_OF_BALLS=found["balls"],
                    STUDY_MINUTES=None if seconds is None else seconds / 60, SITE=str(folder / "site.yaml"),
                    PICTURE=str(folder / "map.png"))
