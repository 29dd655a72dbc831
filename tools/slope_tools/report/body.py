"""The body that a report is about, in a sentence: volume, depth, area, shape, density, coordinates."""
from typing import NamedTuple, Optional

from .. import digits
from ..releases import packing
from ..statistics import rounding
from ..survey.rasters import crs_name
from .data import Data

SHAPES = {"sphere": "a spherical slip surface", "ellipsoid": "an ellipsoidal slip surface",
          "plane": "a plane slip surface", "slbl": "a slip surface by the sloping local base level",
          "slab": "a slip surface at one depth below the ground"}
LEAST = 0.01        # m of depth that belong to the body


class Body(NamedTuple):
    """What is known of it; None: unknown. Volumes of ground."""
    volume: float               # m3, released; the largest of all runs
    area: Optional[float]       # m2, in plan
    depth: Optional[float]      # m, the largest, vertical
    slope: Optional[float]      # degrees, of the ground on it
    shape: str                  # of the slip surface, in words
    density: Optional[float]    # kg/m3, bulk
    crs: Optional[str]
    assigned: bool              # that CRS is not the file's own
    polygon: Optional[str]      # file of the release area, for the appendix


def of_data(data: Data, ground) -> Body:
    """The body of a data.Data on its ground.Ground: by the site's file where there is one, else by the rasters."""
    site = data.site
    entry = (site.get("found") or {}).get("body") or {}
    release = site.get("release") or {}
    mask = ground.slip_depth > LEAST
    area = entry.get("area") or (float(mask.sum()) * ground.cell ** 2 if mask.any() else None)
    depth = entry.get("largest_depth") or (float(ground.slip_depth.max()) if mask.any() else None)
    shape = SHAPES.get(release.get("shape") or "",
                       "a slip surface from a raster" if release.get("scar") else "a given slip surface")
    crs = ground.raster.crs
    ball, factor = data.result.log.density, data.result.summary["bulk_factor"]
    given = (site.get("model") or {}).get("density")     # a run has that of its own balls, a lattice cut off at the rim
    density = given / packing.BULK if given else ball and ball / factor
    terrain = site.get("terrain") or {}
    return Body(data.largest_release(), area, depth, entry.get("mean_slope"), shape, density,
                crs_name(crs) if crs is not None else None, bool(terrain.get("assign_crs") or terrain.get("crs")),
                release.get("polygon"))


def sentence(body: Body) -> str:
    """It, for a client."""
    volume = f"{format_whole(body.volume)} m³" if body.volume < digits.MILLION else digits.cubic(body.volume)
    words = [f"{volume} of ground would come down"]
    if body.depth and body.area:
        words.append(f", up to {digits.three(body.depth)} m deep and of {digits.three(body.area)} m² in plan")
    words.append(f", above {body.shape}")
    if body.slope is not None:
        words.append(f", on ground of {body.slope:.0f} degrees on average")
    text = "".join(words) + "."
    if body.density:
        text += f" Its bulk density is {format_whole(body.density)} kg/m³."
    if body.crs:
        return text + f" Coordinates: {body.crs}{' (assigned)' if body.assigned else ''}."
    return text + " Coordinates: local metres."


def format_whole(value: float) -> str:
    return rounding.format_rounded(value, 1.0)
