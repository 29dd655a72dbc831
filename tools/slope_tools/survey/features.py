"""What the features of a file say beside their geometry: names, and the depths of release areas."""
import math
from contextlib import suppress
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from shapely.geometry import GeometryCollection
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from ..errors import SlopeError
from ..geometry import polygons_of
from . import polygons, vectors

DEPTHS = ("depth", "thickness")     # attributes, of which the first counts
TOUCH = 1e-6        # m2, that a feature has in a polygon which is made of it
NAMED = 3           # features that a polygon is named by
LISTED = 12         # features that a message names


class Polygon(NamedTuple):
    """One polygon of a file: of a feature, or of several that overlap or touch."""
    name: str
    geometry: BaseGeometry          # in local metres
    depth: Optional[float] = None   # m, an attribute of the feature
    attribute: str = ""             # its name


def attribute(attributes: Mapping[str, Any], name: str) -> Any:
    """An attribute of a feature, whose name may be in other case; None where it is missing or empty."""
    return next((value for key, value in attributes.items() if key.lower() == name and value not in (None, "")), None)


def name_feature(attributes: Mapping[str, Any], number: int) -> str:
    """What messages call a feature: its attribute `name`, else its number in the file, from 1."""
    name = attribute(attributes, "name")
    return f"feature {number}" if name is None else str(name)


def size_of(where: str, name: str, value: Any, unit: str) -> float:
    """An attribute as a number > 0, which may be stored as text; SlopeError, which names `where`, if it is none."""
    try:
        size = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError):
        size = math.nan
    if not 0 < size < math.inf:
        raise SlopeError(where, f"attribute {name} must be a number of {unit} > 0, with a decimal point and without a "
                         "unit", value)
    return size


def depth_of(path: str, number: int, attributes: Mapping[str, Any]) -> Tuple[Optional[float], str]:
    """Depth (m) of a feature by its attributes, and which of DEPTHS says so; None without one."""
    for name in DEPTHS:
        if (value := attribute(attributes, name)) is not None:
            return size_of(f"{path}: feature {number}", name, value, "m"), name
    return None, ""


def list_depths(several: Sequence[Polygon]) -> str:
    """Names and depths of some polygons, for a message."""
    return ", ".join(f"{one.name} {one.depth:g} m" for one in several[:LISTED]) + ", ..." * (len(several) > LISTED)


def own_depths(path: str) -> List[Polygon]:
    """The features of a file that say how deep they are, without their geometry; an attribute that is no depth does not
    count, nor does a file that others will find fault with.
    """
    own = []
    with suppress(SlopeError):
        found = None if polygons.read_text(path) is not None else vectors.read_vector_layer(path, "Polygon")
        for number, about in zip(found.numbers, found.attributes) if found else ():
            with suppress(SlopeError):
                own.append(Polygon(name_feature(about, number), GeometryCollection(), *depth_of(path, number, about)))
    return [one for one in own if one.depth]


def depths(path: str) -> Dict[str, Optional[float]]:
    """{name: depth (m) or None} of the features of a file; none of a text, which has no attributes."""
    if polygons.read_text(path) is not None:
        return {}
    found = vectors.read_vector_layer(path, "Polygon")
    return {name_feature(about, number) + f" (feature {number})" * (attribute(about, "name") is not None): depth_of(
        vectors.source(path).path, number, about)[0] for number, about in zip(found.numbers, found.attributes)}


def read_polygon_features(path: str, geometry: BaseGeometry, raster, local=False, crs=None, sized=True,
                          advice=polygons.ADVICE) -> List[Polygon]:
    """The polygons of a file whose geometry polygons.read_local() gave; its other arguments.

    Features that overlap or touch are one polygon, unless their depths differ: then the ground that several have is of
    the deepest. sized: whether attributes say how deep they are.
    """
    if polygons.read_text(path) is not None:
        return distinct([Polygon("", one) for one in polygons_of(geometry)], raster)
    where, found = vectors.source(path).path, vectors.read_vector_layer(path, "Polygon")
    own = None if local else crs or found.known_crs(path, advice.wrong_crs)
    each = []
    for number, (at, shape), about in zip(found.numbers, found.features, found.attributes):
        depth = depth_of(where, number, about) if sized else (None, "")
        if not shape.is_empty:
            each.append(Polygon(name_feature(about, number), polygons.of_feature(
                at, shape, raster, own, advice, anywhere=True, local=local), *depth))
    groups: Dict[Tuple[Optional[float], str], List[Polygon]] = {}
    for one in each:
        groups.setdefault(one[2:], []).append(one)
    made = [Polygon(" and ".join(names_in(part, several)), part, *size) for size, several in groups.items()
            for part in polygons_of(geometry if len(groups) == 1 else unary_union([one.geometry for one in several]))]
    return distinct(made, raster)


def names_in(part: BaseGeometry, several: List[Polygon]) -> List[str]:
    names = list(dict.fromkeys(one.name for one in several if one.geometry.intersection(part).area > TOUCH))
    return [*names[:NAMED], "others"] if len(names) > NAMED else names


def distinct(several: List[Polygon], raster) -> List[Polygon]:
    """The same, with the place of those that no name tells apart."""
    names = [one.name for one in several]
    return [one if one.name and names.count(one.name) == 1 else
            one._replace(name=f"{one.name or 'the polygon'} {locate_feature(one.geometry, raster)}") for one in several]


def locate_feature(geometry: BaseGeometry, raster) -> str:
    """Where a geometry in local metres lies, in coordinates of the survey."""
    x, y = geometry.representative_point().coords[0]
    return f"at east {x + raster.offset[0]:.1f} north {y + raster.offset[1]:.1f}"
