"""What must be removed from a road, per mesh cell: slope volume."""
from pathlib import Path

from . import styles
from .algorithm import Algorithm
from .export import RUN, TERRAIN, prefix_of
from .options import of
from .results import geopackage, load

ROAD = of("volume", "road", "Road (polygons, or a line with a width)", kind="road")
ROAD_WIDTH = of("volume", "road_width", "Width of a road that is a line (m)")
CLEARING = (
    ROAD_WIDTH,
    of("volume", "road_from", "Chainage of the road's start (km)", advanced=True),
    of("volume", "blocked", "The road is blocked where the deposit is thicker than (m)", default=0.1),
    of("volume", "lane", "Width of a lane that is opened first (m)"),
    of("volume", "clearing", "Loosened ground cleared in an hour (m3)"),
    of("volume", "loosening", "Volume of loosened ground over that of the ground (-)", least=1))
CUT_ANGLE = of("volume", "cut_angle", "Rise of the cut surface from the road's edges (degrees)")
MESH = of("volume", "mesh", "Side of the mesh cells (m)", default=10.0, needed=False)


class Volume(Algorithm):
    """slope volume"""

    command = "volume"
    title = "Volume to remove from a road"
    about = """
    What must be removed from a road: the deposit of a run on the road, and beside it above a cut surface that
    rises from the road's edges; in total and per mesh cell (m3).

    Layers: the mesh cells with the volume in them (m3); the thickness to remove (m) on the run's own cells; the
    stretches of the road that are blocked, with what a lane takes (m3) and the hours, where these are asked for.
    Also volume.yaml with all numbers, volume.csv, the profile along the road's axis (m), and a picture.

    The bulk factor is the volume of ground over that of the balls (-); the run's own is used unless another is
    wanted beside it."""
    options = (
        RUN, ROAD, *CLEARING, CUT_ANGLE, MESH,
        of("volume", "axis", "Axis of the road (default: its middle)", kind="line"),
        of("volume", "bulk", "Volumes also for this bulk factor (-)", advanced=True),
        TERRAIN,
        of("volume", "local", "Road and axis are in the local metres of the run, not in a CRS", advanced=True),
        of("volume", "output", "Folder for the results", kind="new folder"))
    outputs = (("vector", "CELLS", "Mesh cells, volume to remove (m3)"),
               ("raster", "THICKNESS", "Thickness to remove (m)"), ("vector", "STRETCHES", "Blocked stretches"),
               ("number", "REMOVE", "To remove (m3)"), ("number", "REMOVE_ON_ROAD", "On the road (m3)"),
               ("number", "REMOVE_BESIDE_ROAD", "Beside the road, above the cut (m3)"),
               ("number", "BLOCKED_LENGTH", "Blocked length of the axis (m)"))

    def words(self, asked):
        return [prefix_of(asked), *super().words(asked)]

    def collect(self, asked, results):
        folder = Path(asked.output("OUTPUT"))
        about = load(folder / "volume.yaml")
        results.layer("THICKNESS", folder / "volume.tif", "removal", "thickness to remove (m)")
        # another first name than that of volume.tif, which has volume.qml
        cells = geopackage(folder / "volume.geojson", folder / "volume_cells.gpkg", about["crs"])
        results.layer("CELLS", cells, styles.MESH, "to remove per mesh cell (m3)")
        results.layer("STRETCHES", folder / "stretches.gpkg", styles.STRETCHES, "blocked stretches of the road")
        volume = about["volume"]
        results.put(OUTPUT=str(folder), REMOVE=volume["remove"], REMOVE_ON_ROAD=volume["remove_on_road"],
                    REMOVE_BESIDE_ROAD=volume["remove_beside_road"], BLOCKED_LENGTH=about["axis"]["blocked_length"])
