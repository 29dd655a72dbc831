"""slope travel: where balls come to rest, as cumulative distributions along and across the slope, over several runs."""
import argparse
from pathlib import Path

from .. import disk, errors
from ..deposit import reach, travel
from ..deposit.travel import MOVING, distribution, each, plan, read, spread, statistics, write_balls, write_csv
from ..errors import SlopeError
from ..options import number
from ..survey import rasters

DIRECTIONS = "along", "across"
EPILOG = """\
units: metres, degrees. A dump is text as LAMMPS' dump custom writes it, with the columns id x y z in any place; its
last snapshot counts. Name DUMPs before other options.

example: ten runs with other seeds, on an axis from -5 to 3 m along and -4 to 4 m across the slope:
  tools/slope travel rest.*.dump --axis x --along -5 3 --across -4 4 -o travel
run-out and reach angle, from where the balls were at the start; downhill is 30 degrees from x to y:
  tools/slope travel rest.1.dump rest.2.dump --start start.1.dump start.2.dump --axis 30

Writes travel.yaml (percentiles), travel.csv (distributions), balls.csv (one row per ball) and travel.png.
"""


def add_parser(commands, **kwargs):
    """Add `travel` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "travel", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Where balls come to rest: cumulative distributions along and across the slope.", **kwargs)
    parser.add_argument("dumps", metavar="DUMP", nargs="+", help="dump of the final state, one for each run")
    parser.add_argument("--axis", metavar="x|y|DEG", type=axis, default=0.0,
                        help="direction along the slope, in plan: x, y, or degrees from x towards y; across is 90 "
                             "degrees more (default x)")
    parser.add_argument("--origin", metavar=("X", "Y"), nargs=2, type=number, default=[0.0, 0.0],
                        help="where both coordinates are 0, m (default 0 0)")
    parser.add_argument("--along", metavar=("LO", "HI"), nargs=2, type=number,
                        help="limits of the axis along the slope, m (default: all balls)")
    parser.add_argument("--across", metavar=("LO", "HI"), nargs=2, type=number,
                        help="limits of the axis across the slope, m (default: all balls)")
    parser.add_argument("--type", metavar="N", nargs="+", type=int,
                        help="only balls of these atom types (default: all)")
    parser.add_argument("--start", metavar="DUMP", nargs="+",
                        help="dump of the start, one for all runs or one for each: adds travelled distances, run-out "
                             "and reach angle, and tells how many balls are missing at the end")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path, default=Path("travel"),
                        help="folder for the results (default travel)")
    return parser


def axis(text):
    """argparse type: degrees from x towards y."""
    try:
        return {"x": 0.0, "y": 90.0}[text] if text in ("x", "y") else number(text)
    except argparse.ArgumentTypeError:
        raise argparse.ArgumentTypeError(f"must be x, y or degrees, got {text!r}") from None


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the percentiles."""
    for name in DIRECTIONS:
        limits = getattr(args, name)
        if limits and not limits[0] < limits[1]:
            raise SlopeError(f"--{name}", "LO must be < HI", f"{limits[0]:g} {limits[1]:g}")
    if args.start and len(args.start) not in (1, len(args.dumps)):
        raise SlopeError("--start", f"must be one dump, or one for each of the {len(args.dumps)} runs", len(args.start))
    if len(set(args.dumps)) < len(args.dumps):
        raise SlopeError("DUMP", "must be another one for each run")
    disk.check_folder(args.output)
    starts = args.start or [None]
    starts *= len(args.dumps) // len(starts)
    arrivals = [read(path, start, args) for path, start in
                rasters.progress(list(zip(args.dumps, starts)), "reading the dumps")]
    warnings = []
    warn = errors.warner("travel", warnings)
    for one in arrivals:
        if one.moving:
            warn(f"{one.name}: {one.moving} of {len(one.id)} balls are faster than {MOVING:g} m/s: they have not "
                 f"arrived")
        if one.missing:
            warn(f"{one.name}: {one.missing} of {one.missing + len(one.id)} balls of the start are not there: left out")
    tables = {name: distribution(arrivals, name, getattr(args, name), warn) for name in DIRECTIONS}
    about = {"axis": {"along": args.axis, "across": args.axis + 90, "origin": args.origin}, "types": args.type,
             "balls": sum(len(one.id) for one in arrivals), "runs": len(arrivals),
             **{name: statistics([one.at[name] for one in arrivals]) for name in DIRECTIONS}}
    single = [each(one) for one in arrivals]
    if args.start:
        about["travel"] = statistics([plan(one.place - one.start) for one in arrivals])
        about["runout"] = {key: spread([one["runout"][key] for one in single]) for key in
                           ("distance", "drop", "reach_angle")}
        about["runout"]["quantiles"] = [
            {"share": share, **{key: spread([one["runout"]["quantiles"][k][key] for one in single])
                                for key in ("distance", "reach_angle")}} for k, share in enumerate(reach.SHARES)]
    about["each_run"] = single
    about["warnings"] = warnings
    with disk.complete(args.output) as new:
        write_csv(new / "travel.csv", arrivals, tables)
        write_balls(new / "balls.csv", arrivals)
        travel.draw(new / "travel.png", arrivals, tables, args)
        about["files"] = ["travel.csv", "balls.csv", "travel.png", "travel.yaml"]
        disk.write_yaml(new / "travel.yaml", about, "slope travel: arrival positions; m, degrees")
    print(summary(about, args.output))


def summary(about, folder):
    """What the user needs to know."""
    lines = [f"{about['balls']} balls of {about['runs']} run{'s' if about['runs'] > 1 else ''}"]
    for name in ("along", "across", "travel"):
        if name in about:
            of = about[name]["all"]
            between = about[name]["over_runs"]["p50"]
            band = f" ({between['lowest']:.3f} to {between['highest']:.3f} in the runs)" if about["runs"] > 1 else ""
            lines.append(f"{name}: median {of['p50']:.3f} m{band}, 5 to 95 % {of['p5']:.3f} to {of['p95']:.3f} m, "
                         f"all {of['min']:.3f} to {of['max']:.3f} m")
    if "runout" in about:
        most = about["runout"]["quantiles"][-1]
        of_runs = " (the farthest and the flattest of the runs)" if about["runs"] > 1 else ""
        lines.append(f"run-out: {100 * most['share']:g} % within {most['distance']['highest']:.3f} m, reach angle "
                     f"{most['reach_angle']['lowest']:.1f} degrees{of_runs}")
        far, flat = about["runout"]["distance"]["highest"], about["runout"]["reach_angle"]["lowest"]
        lines.append(f"farthest ball: {far:.3f} m, reach angle {flat:.1f} degrees")
    lines.append(f"written to {folder}: {' '.join(about['files'])}")
    return "\n".join(lines)
