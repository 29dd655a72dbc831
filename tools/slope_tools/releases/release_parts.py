"""Bodies below several polygons: a base level, or a layer, in each of them, to the same depth or to one of its own."""
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from rasterio.features import rasterize
from scipy.ndimage import label, minimum_filter

from ..digits import rounded
from ..errors import SlopeError
from ..findings import Finding
from ..survey.features import LISTED, Polygon, list_depths
from ..survey.rasters import Raster
from . import release_area, release_solve
from .release_area import Area
from .release_bodies import slbl_shape

LITTLE = 0.75   # share of a polygon; a body that takes less of it is a doubtful one
TINY = 0.02     # of the volume in a polygon; a smaller part of a body is none
PRINTED = 3     # parts of a body whose volumes are printed
SAME = 0.005    # of a volume; that of the features' own depths differs by less
IN_PIT = 0.5    # of a body; where more lies below its own lowest ground, the most of it cannot slide out


class Size(NamedTuple):
    """What is asked of the bodies, one of them; called: what messages call it, a function of the word."""
    depth: Optional[float]          # m, of those that have none of their own
    volume: Optional[float]         # m3, of all together
    curvature: Optional[float]      # 1/m
    called: Any


class Made(NamedTuple):
    """What became of a polygon."""
    name: str
    cells: int                      # in the polygon
    taken: int                      # of these, in the body
    volume: float                   # m3
    largest: float                  # m of depth
    mean: float                     # m, of where it is
    asked: Optional[float]          # m of depth; None: a volume, or a curvature, is asked for
    attribute: str                  # of the feature, that asks for it; "": the option does
    curvature: Optional[float]      # 1/m, of a base level

    @property
    def share(self) -> float:
        return self.taken / self.cells if self.cells else 0.0

    def about(self, cell: float) -> Dict[str, Any]:
        """For NAME.yaml."""
        found = {"name": self.name, "polygon_m2": self.cells * cell ** 2, "area_m2": self.taken * cell ** 2,
                 "volume_m3": self.volume, "largest_depth_m": self.largest, "depth_m": self.asked,
                 "depth_from": self.attribute or None, "curvature_per_m": self.curvature}
        return {key: value for key, value in found.items() if value is not None}


def numbered(raster: Raster, several: List[Polygon]) -> np.ndarray:
    """Of each node of a terrain the number of its polygon, from 1, 0 outside of all; of several the deepest has it."""
    if not several:
        return np.zeros(raster.z.shape, "int32")
    order = sorted(range(len(several)), key=lambda k: several[k].depth or 0.0)
    return rasterize([(several[k].geometry, k + 1) for k in order], raster.z.shape, transform=raster.transform,
                     dtype="int32")


def within(numbers: np.ndarray, area: Area) -> np.ndarray:
    """The part of an array on a terrain that is an area's."""
    row, column = area.corner
    return numbers[row:row + area.z.shape[0], column:column + area.z.shape[1]]


def depths(area: Area, numbers: np.ndarray, several: List[Polygon], shape: str, size: Size, where: str):
    """Depth (m) on the nodes of an area, and the Made of each polygon; numbers: see numbered(), of the area's nodes.

    A volume is shared by area, and by the depths that the features say they have.
    """
    own, others = ([one for one in several if bool(one.depth) == has] for has in (True, False))
    if size.volume is not None and own and others:
        raise SlopeError(where, f"each feature, or none, must have an attribute {own[0].attribute}, by which --volume "
                         "is shared: give it to all, or drop it", f"none of {others[0].name}")
    deep, made = np.zeros(area.z.shape), []
    total = sum((part.depth or 1.0) * int((numbers == number).sum()) for number, part in enumerate(several, 1))
    for number, made_part in enumerate(several, 1):
        inside = numbers == number
        cells = int(inside.sum())
        asked = None if size.volume is not None or size.curvature is not None else made_part.depth or size.depth
        attribute = made_part.attribute if asked is not None and made_part.depth else ""
        if not cells:
            made.append(Made(made_part.name, 0, 0, 0.0, 0.0, 0.0, asked, attribute, None))
            continue
        part, place = release_area.part_of(area, inside)
        alone = len(several) == 1
        if cells >= release_area.FEWEST:
            release_area.require_slope(part, where if alone else f"{where}: {made_part.name}")
        volume = size.volume and size.volume * cells * (made_part.depth or 1.0) / total
        called = f"{where}: {made_part.name}: {attribute}" if attribute else \
            size.called("volume" if volume else "depth" if asked else "curvature") + (
                "" if alone else f" in {made_part.name}")
        curvature = None
        if shape == "slbl":
            curvature, depth = base_level(part, asked, volume, size.curvature, called)
        else:
            even = asked if asked is not None else (volume or 0.0) / (cells * area.cell ** 2)
            depth = np.where(part.inside, even, 0.0)
        deep[place] += depth
        taken = depth >= release_solve.THINNEST
        made.append(Made(made_part.name, cells, int(taken.sum()), release_solve.compute_volume(depth, area.cell),
                         float(depth.max()),
                         float(depth[taken].mean()) if taken.any() else 0.0, asked, attribute, curvature))
    return deep, made


def base_level(part: Area, depth: Optional[float], volume: Optional[float], curvature: Optional[float],
               called: str) -> Tuple[float, np.ndarray]:
    """The curvature (1/m) of the base level of a polygon, and its depths, to one of depth, volume or curvature."""
    shape = slbl_shape(part)
    if depth is not None:
        return release_solve.to_depth(part, shape, depth, called)
    if volume is not None:
        return release_solve.to_volume(part, shape, volume, called)
    free = shape.most if curvature is None else curvature
    if not shape.least <= free <= shape.most:
        raise SlopeError(called, f"must be >= {shape.least:.3g} and <= {shape.most:.3g} /m for "
                         f"{shape.about['length_m']:.4g} m of slope in the release polygon", f"{free:g}")
    return free, release_solve.depths(part, shape.surface(free))


def own_depths(made: List[Made], depth: Optional[float], where: str) -> List[Finding]:
    """That features have a depth of their own, where another one was asked for."""
    own = [one for one in made if one.attribute and one.asked != depth]
    if depth is None or not own:
        return []
    return [Finding("own depth", {"file": where, "attribute": own[0].attribute, "depth": depth,
                                  "depths": list_depths([Polygon(one.name, None, one.asked) for one in own]),
                                  "which": "the others" if len(own) < len(made) else "none of them"})]


def shared(several: List[Polygon], made: List[Made], volume: Optional[float], cell: float,
           where: str) -> List[Finding]:
    """That a volume is shared in proportion to the depths that features say they have."""
    if volume is None or not (own := [one for one in several if one.depth]):
        return []
    whole = sum((one.depth or 0.0) * part.cells * cell ** 2 for one, part in zip(several, made))
    return [Finding("shared", {"file": where, "attribute": own[0].attribute, "depths": list_depths(own),
                               "volume": volume, "factor": volume / whole})] * (abs(volume / whole - 1) > SAME)


def empty(depth: np.ndarray, numbers: np.ndarray, names: List[str], where: str) -> List[Finding]:
    """The polygons of a scar in which none of it lies."""
    return [Finding("no body", {"polygon": f"{where}: {name}", "why": "the raster has no depth in it"})
            for number, name in enumerate(names, 1) if not (depth[numbers == number] > 0).any()]


def warnings(made: List[Made], shape: str, where: str) -> List[Finding]:
    """The polygons in which nothing, or little, is released."""
    doubts, several = [], len(made) > 1
    for made_part in made:
        curvature = made_part.curvature or 0.0
        if not made_part.taken:
            doubts.append(Finding("no body", {"polygon": f"{where}: {made_part.name}", "why": (
                "no slip surface of this curvature lies below its ground" if made_part.cells else
                "no centre of a cell of the terrain is its own: it is small, beside the terrain or in a deeper one")}))
        elif shape == "slbl" and (curvature < 0 or made_part.share < LITTLE):
            doubts.append(Finding("little", {"form": f"bulges (curvature {curvature:.3g} /m) and " * (curvature < 0),
                                             "percent": 100 * made_part.share, "depth": made_part.mean,
                                             "name": made_part.name},
                                  part=made_part.name if several else ""))
    return doubts


def in_pits(depth: np.ndarray, z: np.ndarray, numbers: np.ndarray, names: List[str]) -> List[Finding]:
    """Of each polygon, that the most of its body, of a depth (m) on nodes of a height z (m), lies in a pit.

    What lies below the lowest ground of a body has no way out, but over its rim.
    """
    words = []
    for number, name in enumerate(names, 1):
        body = np.where(numbers == number, depth, 0.0)
        parts, count = label(body > 0, np.ones((3, 3)))
        part, deep = parts[body > 0], body[body > 0]
        lowest = np.full(count + 1, np.inf)
        beside = minimum_filter(np.where(np.isnan(z), np.inf, z), 3)       # an open face is a way out
        np.minimum.at(lowest, part, beside[body > 0])
        below = np.clip(lowest[part] - z[body > 0] + deep, 0.0, None)
        if len(deep) and below.sum() > IN_PIT * deep.sum():
            words.append(Finding("in a pit", {
                "percent": 100 * float(below.sum() / deep.sum()), "depth": float(deep.max()),
                "fall": float(np.ptp(z[parts == part[deep.argmax()]]))}, part=name if len(names) > 1 else ""))
    return words


def in_parts(depth: np.ndarray, cell: float, numbers: np.ndarray, names: List[str]) -> List[Finding]:
    """A warning of each polygon in which the body, of a depth (m) on nodes, is in parts; tiny ones do not count.

    numbers: of each node its polygon, from 1.
    """
    words = []
    for number, name in enumerate(names, 1):
        body = np.where(numbers == number, depth, 0.0)
        parts, count = label(body > 0, np.ones((3, 3)))
        volumes = np.sort(np.bincount(parts.ravel(), body.ravel(), count + 1)[1:])[::-1] * cell ** 2
        large = volumes[volumes > TINY * volumes.sum()]
        if len(large) < 2:
            continue
        shown, rest = large[:PRINTED], volumes[len(large[:PRINTED]):]
        words.append(Finding("parts", {
            "parts": len(large), "volumes": " and ".join(map(rounded, shown)),
            "rest": f", and {rounded(rest.sum())} m3 in {len(rest)} smaller ones" * bool(len(rest))},
            part=name if len(names) > 1 else ""))
    return words


def describe_parts(made: List[Made], cell: float) -> str:
    """What is released in each of several polygons, a line each."""
    shown = sorted(made, key=lambda part: part.taken)[:LISTED] if len(made) > LISTED else made
    lines = [f"{one.name}: volume {rounded(one.volume)} m3, up to {one.largest:.4g} m deep"
             + f" (its {one.attribute})" * bool(one.attribute) + f", on {rounded(one.taken * cell ** 2)} of "
             f"{rounded(one.cells * cell ** 2)} m2" for one in shown]
    return "\n".join([*lines, *[f"and {len(made) - LISTED} more polygons"] * (len(made) > LISTED)])
