"""What must be removed from a road, per mesh cell: slope volume."""
from pathlib import Path

from . import styles
from .algorithm import Algorithm
from .export import RUN, TERRAIN, prefix_of
from .options import Option
from .results import geopackage, load

ROAD = Option("ROAD", "--road", "road", "Road (polygons, or a line with a width)", needed=True)
ROAD_WIDTH = Option("ROAD_WIDTH", "--road-width", "number", "Width of a road that is a line (m)")
CLEARING = (
    ROAD_WIDTH,
    Option("ROAD_FROM", "--road-from", "number", "Chainage of the road's start (km)", advanced=True),
    Option("BLOCKED", "--blocked", "number", "The road is blocked where the deposit is thicker than (m)", 0.1),
    Option("LANE", "--lane", "number", "Width of a lane that is opened first (m)"),
    Option("CLEARING", "--clearing", "number", "Loosened ground cleared in an hour (m3)"),
    Option("LOOSENING", "--loosening", "number", "Volume of loosened ground over that of the ground (-)", least=1.0))
CUT_ANGLE = Option("CUT_ANGLE", "--cut-angle", "number", "Rise of the cut surface from the road's edges (degrees)",
                   30.0)
MESH = Option("MESH", "--mesh", "number", "Side of the mesh cells (m)", 10.0)


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
        Option("AXIS", "--axis", "line", "Axis of the road (default: its middle)"),
        Option("BULK", "--bulk", "number", "Volumes also for this bulk factor (-)", advanced=True),
        TERRAIN,
        Option("LOCAL", "--local", "switch", "Road and axis are in the local metres of the run, not in a CRS",
               advanced=True),
        Option("OUTPUT", "-o", "new folder", "Folder for the results"))
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
