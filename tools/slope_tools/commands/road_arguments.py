"""Arguments on a road: how wide it is, what blocks it, the lane that is opened first, and the hours."""
from dataclasses import dataclass
from typing import Any, Dict, Optional

from ..errors import SlopeError
from ..options import option
from ..runs import again
from ..sites import site_choices, site_deck, site_roads
from ..sites.site_choices import Site
from ..survey import roads

OPTIONS = {name[2:].replace("-", "_"): field for field, name in roads.OPTIONS.items()}      # fields of a request
ROAD = "the road: polygons, or a line with --road-width: GeoJSON, shapefile, CSV or WKT"


@dataclass(frozen=True, kw_only=True)
class Width:
    """--road-width."""
    GROUP = "road"
    road_width: Optional[float] = option("the road is a line, of this width (m)", metavar="W")


@dataclass(frozen=True, kw_only=True)
class Clearing(Width):
    """All of OPTIONS; what is not given is None."""
    GROUP = "road"
    road_from: Optional[float] = option("chainage at the start of the road's axis, km (default 0)", metavar="KM")
    blocked: Optional[float] = option(
        f"the road is blocked where the deposit is thicker, m (default {roads.NOTHING.blocked:g})", metavar="T")
    lane: Optional[float] = option(
        "width of a lane, m: also the least volume that opens one through each blocked stretch", metavar="W")
    clearing: Optional[float] = option(
        "m3 of loosened ground that are cleared in an hour: also the hours, with --loosening", metavar="RATE")
    loosening: Optional[float] = option(
        "volume of loosened ground / volume of the ground in place, for --clearing", metavar="F")


def asked(args: Width) -> roads.Asked:
    """What these arguments ask for."""
    return roads.Asked(**{field: value for name, field in OPTIONS.items()
                          if (value := getattr(args, name, None)) is not None})


def list_road_options(asked: Site) -> Dict[str, Any]:
    """The options of the road that is asked of a site, as far as they are not by default; none without one."""
    road = asked.choices.road
    if not road.file:
        return {}
    given = {name: getattr(road.asked, field) for name, field in OPTIONS.items()
             if getattr(road.asked, field) != getattr(roads.NOTHING, field)}
    return {**given, "road": site_roads.file_of(asked), "road_name": asked.road, "cut_angle": road.cut_angle,
            "mesh": road.mesh}


def otherwise(args: Any) -> str:
    """What is to be typed where --set or --vary is given with a site, for a message: a study of its deck with its road,
    or an ensemble; "" of anything else."""
    if not args.set:
        return f"; otherwise: {again.command(args, sample=64)}" if args.vary else ""
    try:
        road = list_road_options(site_choices.load_site(args.deck))
    except SlopeError:
        return ""
    beside = args.output or args.deck.with_name(f"{args.deck.absolute().name}_set")
    return f"; otherwise: {again.command(args, deck=args.deck / site_deck.NAME, output=beside, paper=False, **road)}"
