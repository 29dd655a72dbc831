"""The body that is released: slope release."""
from pathlib import Path

from . import process, terrain
from .algorithm import Algorithm
from .options import Option, of
from .results import load
from .terrain import DEM, with_terrain

SHAPES = ("sphere", "ellipsoid", "plane", "slbl", "slab")
POLYGON = of("release", "polygon", "Polygon where the mass is released", kind="polygons")
SHAPE = (
    Option("SHAPE", "--shape", "choice", "Shape of the slip surface (default: sphere; plane with a dip)",
           choices=SHAPES),
    of("release", "depth", "Largest depth of the slip surface below the ground (m)"),
    of("release", "volume", "Volume of the body (m3)"),
    of("release", "curvature", "Curvature of the base level slbl (1/m)", least=-1000000.0, advanced=True),
    of("release", "dip", "Dip of the plane, below the horizontal (degrees)"),
    of("release", "direction", "Compass bearing to which the plane dips (degrees; default: fall line)"))
SCAR = (
    of("release", "scar", "Scar: a second elevation model (m), or depths (m), instead of a shape", kind="raster"),
    of("release", "scar_is", "What the scar raster holds (default: surface)"),
    of("release", "least", "Depths of the scar below this are none (m)", default=None, advanced=True))
POLYGON_CRS = of("release", "crs", "The polygon is in this CRS, whatever it says", kind="crs", key="POLYGON_CRS",
                 advanced=True)
LOCAL = of("release", "local", "The polygon is in the terrain's local metres, not in a CRS", advanced=True)


class Release(Algorithm):
    """slope release"""

    command = "release"
    title = "Body that is released"
    about = """
    The body that is released: a slip surface below a polygon, to a largest depth (m) or to a volume (m3), or
    the scar of a past event.

    Shapes: sphere through toe and shoulder of the polygon; ellipsoid, as wide as the polygon; plane by its dip
    and the bearing to which it dips (degrees); slbl, the sloping local base
    level, and slab, the ground lowered by the depth, which take several polygons and an attribute depth or thickness
    (m) of each.

    Layers: the depth of the body (m), and the ground without it (m, shaded relief). Also a picture with a
    section, the numbers (release.yaml), and the lines of the deck (release.deck.txt). The terrain is made first
    if the raster is not one of SLOPE."""
    options = (
        DEM, POLYGON, *SHAPE, *SCAR, POLYGON_CRS, LOCAL,
        of("release", "output", "Folder for the results", kind="new folder", own=True))
    outputs = (("raster", "DEPTH_LAYER", "Depth of the body (m)"),
               ("raster", "SLIP_LAYER", "Ground without the body (m)"),
               ("number", "RELEASED", "Volume of the body (m3)"), ("number", "LARGEST_DEPTH", "Largest depth (m)"),
               ("number", "MEAN_DEPTH", "Mean depth (m)"), ("number", "AREA", "Area (m2)"),
               ("file", "DECK_LINES", "Lines of the deck"), ("file", "PICTURE", "Map and section"))

    def work(self, asked, results):
        words = self.words(asked)
        with with_terrain(asked) as (folder, ground):
            process.run(["release", ground, *words, "-o", folder / "release"], asked.feedback)
        terrain.show(results, "SLIP_LAYER", folder / "release.slip.asc", "ground", "ground without the body")
        terrain.show(results, "DEPTH_LAYER", folder / "release.depth.asc", "depth", "depth of the body (m)")
        body = load(Path(folder) / "release.yaml")["body"]
        results.put(OUTPUT=str(folder), RELEASED=body["volume"], LARGEST_DEPTH=body["largest_depth"],
                    MEAN_DEPTH=body["mean_depth"], AREA=body["area"], DECK_LINES=str(folder / "release.deck.txt"),
                    PICTURE=str(folder / "release.png"))
