"""Arguments of the commands that take a body: which one, below a polygon or from a scar, on which heights."""
import argparse
from dataclasses import dataclass
from typing import List, Optional, Union

from ..options import flag, parse_number, option
from ..releases import release, release_dip, release_scar
from ..survey import vectors
from ..survey.rasters import UNITS


def degrees_or_least(text: str) -> Union[float, str]:
    """argparse type of --dip."""
    return text if text == release_dip.LEAST else parse_number(text)


def level_or_file(text: str) -> Union[float, str]:
    """argparse type of --foundation."""
    try:
        return parse_number(text)
    except argparse.ArgumentTypeError:
        return text


@dataclass(frozen=True, kw_only=True)
class Heights:
    """How commands that make a terrain of their own take its heights; what is not given is None."""
    GROUP = "heights of the elevation model"
    z_unit: Optional[str] = option("of the heights of the elevation model, whatever it says", choices=UNITS)
    nodata: Optional[List[float]] = option(
        "a value of the elevation model, in its own unit, that stands for no height, beside the one that it declares; "
        "may be given several times", metavar="V", action="append")
    differ: Optional[float] = option(
        "accept a median difference of two elevation models of up to M m where both have heights (default 5)",
        metavar="M")


@dataclass(frozen=True, kw_only=True)
class Body:
    """All that says which body is released, but for the terrain."""
    GROUP = "body"
    terrain: str
    polygon: Optional[str] = option(
        "the release area; with --scar, only the part of the scar inside it is used", metavar="P")
    layer: Optional[str] = option(
        "of the layers of P this one (default: the only one, or the only one of polygons)", metavar="NAME")
    shape: Optional[str] = option(
        "of the slip surface (default: sphere; plane with --dip, slbl with --curvature)", choices=release.SHAPES)
    depth: Optional[float] = option(
        "largest depth below the ground, vertical, m; of slbl and slab in each polygon that has no attribute depth or "
        "thickness", metavar="D", one_of="size")
    volume: Optional[float] = option(
        "volume of the body, m3; of slbl and slab shared by area, and by an attribute depth or thickness",
        metavar="V", one_of="size")
    curvature: Optional[float] = option(
        "of slbl: sum of the slip surface's second derivatives, 1/m; 8 D / L^2 for a depth D on a length L",
        metavar="K", one_of="size")
    dip: Union[float, str, None] = option(
        "of the plane, degrees below the horizontal; least: the sphere that dips least below the foundation and "
        "contains the most of what is above it", metavar="A|least", type=degrees_or_least)
    foundation: Union[float, str, None] = option(
        "of --dip least: its level, m, or a raster of its heights (default: the level of the toe)",
        metavar="LEVEL|RASTER", type=level_or_file)
    direction: Optional[float] = option(
        "compass bearing to which the plane dips, degrees (default: the fall line's)", metavar="B")
    scar: Optional[str] = option("the body is what this raster says, see --scar-is", metavar="RASTER")
    scar_is: Optional[str] = option(
        "surface: heights after the event (default, if they follow the terrain's); depth: of the slip surface, "
        "positive down; change: after minus before, of which the loss counts; height: of the mass on top of the "
        "terrain, which is the ground without it", choices=release_scar.KINDS)
    least: float = option(
        "depths of a scar below this count as none, m (default 0): the noise of two surveys", metavar="D", default=0.0)
    crs: Optional[str] = option(
        "the coordinates of P are in this CRS, whatever P says", "--assign-crs", metavar="EPSG:n", one_of="place")
    local: bool = flag("the coordinates of P are the terrain's local metres", one_of="place")


def wanted(args: Body) -> release.Wanted:
    """What these arguments, and the terrain, ask for."""
    polygon = args.polygon and vectors.name_layer(args.polygon, args.layer)
    return release.Wanted(args.terrain, polygon, args.shape, args.depth, args.volume, args.curvature, args.dip,
                          args.direction, args.scar, args.scar_is, args.least, args.crs, local=args.local,
                          foundation=args.foundation)
