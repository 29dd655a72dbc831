"""Arguments on a road: how wide it is, what blocks it, the lane that is opened first, and the hours."""
from ..options import number
from ..survey import roads

OPTIONS = {option[2:].replace("-", "_"): field for field, option in roads.OPTIONS.items()}      # as argparse has them
ROAD = "the road: polygons, or a line with --road-width: GeoJSON, shapefile, CSV or WKT"


def add_width(parser) -> None:
    """--road-width."""
    parser.add_argument("--road-width", metavar="W", type=number, help="the road is a line, of this width (m)")


def add_clearing(parser) -> None:
    """All of OPTIONS; what is not given is None."""
    add_width(parser)
    parser.add_argument("--road-from", metavar="KM", type=number,
                        help="chainage at the start of the road's axis, km (default 0)")
    parser.add_argument("--blocked", metavar="T", type=number, help="the road is blocked where the deposit is thicker, "
                        f"m (default {roads.NOTHING.blocked:g})")
    parser.add_argument("--lane", metavar="W", type=number, help="width of a lane, m: also the least volume that opens "
                        "one through each blocked stretch")
    parser.add_argument("--clearing", metavar="RATE", type=number, help="m3 of loosened ground that are cleared in an "
                        "hour: also the hours, with --loosening")
    parser.add_argument("--loosening", metavar="F", type=number,
                        help="volume of loosened ground / volume of the ground in place, for --clearing")


def given(args):
    """{field of roads.Asked: value} of those that were given."""
    return {field: value for option, field in OPTIONS.items() if (value := getattr(args, option, None)) is not None}


def asked(args) -> roads.Asked:
    """What these arguments ask for."""
    return roads.Asked(**given(args))
