"""A body from a raster: a second survey of the surface, depths, the change between two, or what lies on the terrain."""
from typing import NamedTuple, Optional, Tuple

import numpy as np
from affine import Affine
from rasterio.crs import CRS
from scipy import ndimage

from ..errors import SlopeError
from ..survey import beside
from ..survey.rasters import Raster
from .release_solve import THINNEST

KINDS = ("surface", "depth", "change", "height")
ALIKE = 0.7     # of the terrain's scatter: that of the differences to a second survey of it is smaller
FEW = 50        # nodes on which two surveys must have heights, to be compared beside the scar


class Scar(NamedTuple):
    """What a raster says of a body."""
    depth: np.ndarray           # m, >= 0, on the nodes of the terrain, 0 where there is none
    kind: str                   # of KINDS
    ground: Raster              # before the collapse: the terrain, with the mass on it where that is its height
    above: Optional[np.ndarray]     # m, of heights: the terrain's less the raster's, NaN where either has none
    unknown: np.ndarray         # mask of the nodes where the raster has no value


def read_scar(path: str, kind: Optional[str], raster: Raster, least: float, crs: Optional[CRS] = None) -> Scar:
    """The scar of a raster on the nodes of a terrain.

    kind: "surface", heights after the event; "depth", of the slip surface below the terrain, positive down; "change",
    after minus before, of which what is negative counts; "height", of the mass on top of the terrain, which is the slip
    surface; None: heights, if they follow the terrain's. crs: of the raster, whatever it says. Depths below `least` (m)
    are 0. The scar's grid may be another one: bilinear between its cell centres, and reprojected. A raster without a
    CRS is taken to be in the terrain's. Depths below a millimetre, to which a terrain's heights are rounded, are none.
    Raises SlopeError on a raster that is none, lies elsewhere, or holds no depth.
    """
    values, unknown = on_nodes(path, raster, kind in (None, "surface"), crs)
    if kind is None:
        check_heights(path, values, raster)
        kind = "surface"
    if kind in ("depth", "height"):
        wrong = np.nanmin(values)
        if wrong < 0:
            rule = "depths >= 0, positive down" if kind == "depth" else "heights above the terrain >= 0"
            raise SlopeError(path, f"must hold {rule}; if it is the change of the surface, give --scar-is change",
                             f"{wrong:.6g}")
    depth = raster.z - values if kind == "surface" else -values if kind == "change" else values
    with np.errstate(invalid="ignore"):
        depth = np.where(depth >= max(least, THINNEST), depth, 0.0)      # NaN too
    depth = np.maximum(depth, 0.0)
    if not depth.any():
        must = {"surface": "be lower than the terrain (are the surveys before and after exchanged?)",
                "depth": "hold a depth > 0", "change": "hold a change < 0", "height": "hold a height > 0"}
        raise SlopeError(path, f"must {must[kind]} somewhere" + (f", by --least {least:g} m" if least else ""))
    return Scar(depth, kind, raster._replace(z=raster.z + depth) if kind == "height" else raster,
                raster.z - values if kind == "surface" else None, unknown)


def check_heights(path: str, values: np.ndarray, raster: Raster) -> None:
    """Raise SlopeError if values (m) on the nodes of a terrain do not follow its heights: they may be depths."""
    both = np.isfinite(values) & np.isfinite(raster.z)
    z, scar = raster.z[both], values[both]
    if len(z) < FEW or np.std(z - scar) <= ALIKE * np.std(z):
        return
    meant = "depths? Then --scar-is depth" if scar.min() >= 0 else "the change of the surface? Then --scar-is change"
    raise SlopeError(path, f"must be heights that follow the terrain's, {z.min():.6g} to {z.max():.6g} m: did you mean "
                     f"{meant}; --scar-is surface if they are heights", f"{scar.min():.6g} to {scar.max():.6g}")


def off_beside(scar: Scar, inside: Optional[np.ndarray]) -> Optional[float]:
    """How far (m, median) the terrain lies above a second survey of it beside the body.

    inside: mask of the nodes in the polygon of the body. None where that is not known: no two surveys, or no nodes
    beside the body.
    """
    if scar.above is None:
        return None
    known = np.isfinite(scar.above)
    if inside is not None:
        known &= ~inside
    elif known.any() and np.mean(scar.depth[known] > 0.5) > 0.5:
        return None         # a survey of the scar alone
    return float(np.median(scar.above[known])) if known.sum() >= FEW else None


def is_unknown_inside(scar: Scar, inside: Optional[np.ndarray]) -> np.ndarray:
    """Mask of the nodes without a value that a body encloses; of heights all in its polygon (inside), if it has one."""
    body = scar.depth > 0
    return scar.unknown & (ndimage.binary_fill_holes(body) & ~body if inside is None or scar.above is None else inside)


def on_nodes(path: str, raster: Raster, heights: bool, crs: Optional[CRS] = None) -> Tuple[np.ndarray, np.ndarray]:
    """Values of a raster file at the nodes of a terrain, bilinear, exact at its own centres; and where it has none.

    Heights are NaN where the raster has none. Depths and changes are 0 there, also between a cell that has one and a
    cell beyond the raster: what they sum up to does not depend on how the file marks the ground beside the scar.
    """
    scar = beside.read_raster_beside(path, raster, heights, crs)
    unknown = np.isnan(beside.on_cells(path, scar, raster))
    if not heights:
        scar = scar._replace(z=np.pad(np.nan_to_num(scar.z), 1), transform=scar.transform @ Affine.translation(-1, -1))
    return beside.on_cells(path, scar, raster), unknown
