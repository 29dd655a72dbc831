"""slope release: the body that is released, below a polygon or from a scar, as rasters and lines of a deck."""
import argparse
import sys
from pathlib import Path

from ..case import release_files
from ..errors import SlopeError
from ..options import number
from ..provenance import version
from ..survey import polygons, release_scar, release_solve
from ..survey.rasters import crs_name
from ..survey.release import from_scar, from_shape, read_terrain

SHAPES = ("sphere", "ellipsoid", "plane", "slbl")
COARSE = 50     # cells; a body of fewer is drawn with a coarse brush
EPILOG = """\
P: polygons as slope polygon takes them (GeoJSON, shapefile, CSV, WKT)
shapes: sphere (default) through the ends of the fall line in the polygon; ellipsoid, the same, but as wide as the
  polygon; plane (default with --dip), through the toe unless a depth or volume is given; slbl, the sloping local base
  level. --depth or --volume finds their free number.
Writes NAME.slip.asc (the ground without the body) and NAME.depth.asc with sidecars, NAME.png (map, section), NAME.yaml
(choices, numbers) and NAME.deck.txt (lines of the deck).

examples:
  tools/slope release terrain.asc --polygon release.geojson --depth 12 -o release
  tools/slope release terrain.asc --polygon release.shp --shape slbl --volume 50000 -o release
  tools/slope release terrain.asc --polygon release.csv --dip 35 --direction 110 -o release
  tools/slope release before.asc --scar after.asc --polygon release.csv --least 0.5 -o release
"""


def add_parser(commands, **kwargs):
    """Add `release` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "release", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="The body that is released: a slip surface below a polygon, or a scar, to a depth or volume.",
        **kwargs)
    parser.add_argument("terrain", metavar="TERRAIN.asc", help="the ground before, as slope terrain wrote it")
    parser.add_argument("-o", dest="output", metavar="NAME", required=True, type=Path,
                        help="first part of the names of all files")
    parser.add_argument("--polygon", metavar="P", help="where it is released; with --scar, what of the scar counts")
    parser.add_argument("--shape", choices=SHAPES, help="of the slip surface")
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
    parser.add_argument("--scar-is", choices=release_scar.KINDS, default="surface",
                        help="surface: heights after the event (default); depth: of the slip surface, positive down; "
                             "change: after minus before, of which the loss counts")
    parser.add_argument("--least", metavar="D", type=number, default=0.0,
                        help="depths of a scar below this count as none, m (default 0): the noise of two surveys")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--crs", metavar="EPSG:n", help="the coordinates of P are in this CRS, whatever P says")
    place.add_argument("--local", action="store_true", help="the coordinates of P are the terrain's local metres")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the body's numbers before it writes any file."""
    check(args)
    raster = read_terrain(args.terrain)
    geometry = None
    if args.polygon:
        crs = polygons.as_crs("--crs", args.crs) if args.crs else None
        geometry = polygons.read_local(args.polygon, raster, local=args.local, crs=crs, terrain=args.terrain)
    if args.scar:
        area, surface, choices = from_scar(args, raster, geometry)
    else:
        area, surface, choices = from_shape(args, raster, geometry)
    where = args.polygon or args.scar
    slip = release_solve.slip_surface(area, release_solve.depths(area, surface), where)
    found = release_solve.measures(area, slip)
    print(text(choices, found, area.cell), flush=True)
    doubts = warnings(choices, found, area.cell)
    for line in doubts:
        print(f"slope release: warning: {line}", file=sys.stderr)
    about = {"slope_version": version(), "terrain": args.terrain, "polygon": args.polygon, **choices,
             "body": found._asdict(), "cell": area.cell, "crs": crs_name(raster.crs),
             "origin": {"east": float(raster.offset[0]), "north": float(raster.offset[1])},
             "warnings": doubts}
    release_files.write(args.output, args.terrain, raster, area, slip, about, geometry,
                        f"{args.output.name}: {found.volume:,.0f} m\u00b3, up to {found.largest_depth:.3g} m deep")
    print(f"wrote {', '.join(path.name for path in release_files.paths(args.output))}")


def check(args):
    """Check what can be checked before any reading; the shape that is not named is set."""
    release_files.check(args.output, [path for path in (args.terrain, args.polygon, args.scar) if path])
    for name in ("depth", "volume"):
        value = getattr(args, name)
        if value is not None and not value > 0:
            raise SlopeError(f"--{name}", "must be > 0", f"{value:g}")
    if args.least < 0:
        raise SlopeError("--least", "must be >= 0", f"{args.least:g}")
    if args.scar:
        for name in ("shape", "depth", "volume", "curvature", "dip", "direction"):
            if getattr(args, name) is not None:
                raise SlopeError(f"--{name}", "must not be given with --scar, whose depths are what they are")
        return
    if not args.polygon:
        raise SlopeError("--polygon", "must be given, unless --scar says where the body is")
    if args.shape is None:
        args.shape = ("plane" if args.dip is not None or args.direction is not None else
                      "slbl" if args.curvature is not None else "sphere")
    check_shape(args)


def check_shape(args):
    """What goes with which shape."""
    if args.shape == "plane":
        if args.dip is None:
            raise SlopeError("--dip", "must be given for a plane, degrees below the horizontal")
        if not 0 < args.dip < 90:
            raise SlopeError("--dip", "must be > 0 and < 90 degrees", f"{args.dip:g}")
        if args.direction is not None and not 0 <= args.direction <= 360:
            raise SlopeError("--direction", "must be a compass bearing, 0 to 360 degrees", f"{args.direction:g}")
    elif args.dip is not None or args.direction is not None:
        raise SlopeError("--dip" if args.dip is not None else "--direction", "must be given for a plane only",
                         f"--shape {args.shape}")
    if args.curvature is not None and args.shape != "slbl":
        raise SlopeError("--curvature", "must be given for slbl only", f"--shape {args.shape}")
    if args.shape != "plane" and args.depth is None and args.volume is None and args.curvature is None:
        raise SlopeError("--depth", f"or --volume must be given for --shape {args.shape}"
                         + (", or --curvature" * (args.shape == "slbl")))


def text(choices, found, cell):
    """What the user needs to know of the body before anything is written."""
    shape = choices["shape"]
    if shape == "scar":
        what = f"scar of {choices['scar']} ({choices['scar_is']})"
    elif shape == "plane":
        what = (f"plane that dips {choices['dip_degrees']:.4g} degrees towards {choices['direction_degrees']:.4g}, "
                f"{choices['drop_m']:.4g} m below the highest one")
    elif shape == "slbl":
        what = (f"sloping local base level, curvature {choices['curvature_per_m']:.4g} /m (tolerance "
                f"{choices['tolerance_m']:.4g} m for cells of {cell:g} m)")
    else:
        toe, shoulder = (" ".join(f"{value:.1f}" for value in choices[end]) for end in ("toe", "shoulder"))
        wide = f", {choices['width_m']:.4g} m wide" if shape == "ellipsoid" else ""
        sagitta = choices["sagitta_m"]
        what = (f"{shape} through toe {toe} and shoulder {shoulder}, {abs(sagitta):.4g} m "
                f"{'below' if sagitta > 0 else 'above'} its chord of {choices['chord_m']:.4g} m{wide}")
    return (f"{what}\n"
            f"volume {found.volume:.10g} m3, largest depth {found.largest_depth:.4g} m, mean depth "
            f"{found.mean_depth:.4g} m, area {found.area:.10g} m2 ({found.cells} cells of {cell:g} m)\n"
            f"mean slope {found.mean_slope:.1f} degrees, of the slip surface {found.slip_slope:.1f}, towards "
            f"{found.bearing:.0f} degrees from north; ground at {found.lowest:.1f} to {found.highest:.1f} m")


def warnings(choices, found, cell):
    """What makes the body doubtful."""
    lines = []
    if choices.get("sagitta_m", 1) < 0:
        lines.append(f"the ground bulges above the line from toe to shoulder, and so does the {choices['shape']}: a "
                     "smaller polygon, or --shape slbl?")
    if found.cells < COARSE:
        lines.append(f"the body covers {found.cells} cells of {cell:g} m: take a finer terrain")
    if found.wall > 0.5 * found.largest_depth:
        lines.append(f"the body is {found.wall:.3g} m deep at the rim of its area, where it ends in a wall: "
                     + ("a wider polygon, or --shape ellipsoid?" if choices["shape"] == "sphere" else
                        "is the polygon large enough?"))
    return lines
