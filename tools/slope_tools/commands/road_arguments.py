"""Arguments on a road: how wide it is, what blocks it, the lane that is opened first, and the hours."""
from dataclasses import dataclass
from typing import Optional

from ..options import option
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
