"""Arguments of the commands that take a body: which one, below a polygon or from a scar."""
from ..options import number
from ..releases import release, release_scar
from ..survey import vectors


def add_body(parser) -> None:
    """All that says which body is released, but for the terrain."""
    parser.add_argument("--polygon", metavar="P", help="the release area; with --scar, only the part of "
                        "the scar inside it is used")
    parser.add_argument("--layer", metavar="NAME", help="of the layers of P this one (default: the only one, or the "
                        "only one of polygons)")
    parser.add_argument("--shape", choices=release.SHAPES, help="of the slip surface (default: "
                        "sphere; plane with --dip, slbl with --curvature)")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--depth", metavar="D", type=number, help="largest depth below the ground, vertical, m")
    size.add_argument("--volume", metavar="V", type=number, help="volume of the body, m3")
    size.add_argument("--curvature", metavar="K", type=number,
                      help="of slbl: sum of the slip surface's second derivatives, 1/m; 8 D / L^2 for a depth D on a "
                           "length L")
    parser.add_argument("--dip", metavar="A", type=number, help="of the plane, degrees below the horizontal")
    parser.add_argument("--direction", metavar="B", type=number,
                        help="compass bearing to which the plane dips, degrees (default: the fall line's)")
    parser.add_argument("--scar", metavar="RASTER", help="the body is what this raster says, see --scar-is")
    parser.add_argument("--scar-is", choices=release_scar.KINDS,
                        help="surface: heights after the event (default, if they follow the terrain's); depth: of the "
                             "slip surface, positive down; change: after minus before, of which the loss counts; "
                             "height: of the mass on top of the terrain, which is the ground without it")
    parser.add_argument("--least", metavar="D", type=number, default=0.0,
                        help="depths of a scar below this count as none, m (default 0): the noise of two surveys")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--assign-crs", dest="crs", metavar="EPSG:n",
                       help="the coordinates of P are in this CRS, whatever P says")
    place.add_argument("--local", action="store_true", help="the coordinates of P are the terrain's local metres")


def wanted(args) -> release.Wanted:
    """What these arguments, and the terrain, ask for."""
    polygon = args.polygon and vectors.named(args.polygon, args.layer)
    return release.Wanted(args.terrain, polygon, args.shape, args.depth, args.volume, args.curvature, args.dip,
                          args.direction, args.scar, args.scar_is, args.least, args.crs, local=args.local)
