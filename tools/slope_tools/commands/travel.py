"""slope travel: where balls come to rest, along and across the slope, over several runs."""
import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional

from .. import disk, findings
from ..deposits import travel
from ..options import Overwrite, parse_number, option, positional, parse_whole_number

DESCRIPTION = "Where balls come to rest: cumulative distributions along and across the slope."
EPILOG = """\
units: metres, degrees. A dump is text as LAMMPS' dump custom writes it, with the columns id x y z in any place; its
last snapshot counts. Name DUMPs before other options.

example: ten runs with other seeds, on an axis from -5 to 3 m along and -4 to 4 m across the slope:
  tools/slope travel rest.*.dump --axis x --along -5 3 --across -4 4 -o travel
run-out and reach angle, from where the balls were at the start; downhill is 30 degrees from x to y:
  tools/slope travel rest.1.dump rest.2.dump --start start.1.dump start.2.dump --axis 30

Writes travel.yaml (percentiles), travel.csv (distributions), balls.csv (one row per ball) and travel.png.
"""


def axis(text):
    """argparse type: degrees from x towards y."""
    try:
        return {"x": 0.0, "y": 90.0}[text] if text in ("x", "y") else parse_number(text)
    except argparse.ArgumentTypeError:
        raise argparse.ArgumentTypeError(f"must be x, y or degrees, got {text!r}") from None


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    dumps: List[str] = positional("dump of the final state, one for each run", metavar="DUMP", nargs="+")
    axis: float = option(
        "direction along the slope, in plan: x, y, or degrees from x towards y; across is 90 degrees more (default x)",
        metavar="x|y|DEG", type=axis, default=0.0)
    origin: List[float] = option(
        "where both coordinates are 0, m (default 0 0)", metavar=("X", "Y"), nargs=2, default=[0.0, 0.0])
    along: Optional[List[float]] = option(
        "limits of the axis along the slope, m (default: all balls)", metavar=("LO", "HI"), nargs=2)
    across: Optional[List[float]] = option(
        "limits of the axis across the slope, m (default: all balls)", metavar=("LO", "HI"), nargs=2)
    type: Optional[List[int]] = option(
        "only balls of these atom types (default: all)", metavar="N", nargs="+", type=parse_whole_number)
    start: Optional[List[str]] = option(
        "dump of the start, one for all runs or one for each: adds travelled distances, run-out and reach angle, and "
        "the number of balls that are missing at the end", metavar="DUMP", nargs="+")
    output: Path = option("folder for the results (default travel)", "-o", metavar="DIR", default=Path("travel"))


def run_travel(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints the percentiles."""
    wanted = travel.Wanted(args.axis, args.origin, args.along, args.across, args.type)
    travel.check_travel(args.dumps, args.start, wanted)
    disk.check_folder(args.output, travel.FILES, args.dumps, args.overwrite)
    about = travel.of_dumps(args.dumps, args.start, wanted, args.output, findings.printer("travel"))
    print(describe_travel(about, args.output))


def missing(summary):
    """How many balls are missing, in the run that lacks most."""
    of, balls = max((one["missing"], one["missing"] + one["balls"]) for one in summary["each_run"])
    return f"{of} of {balls} balls of the start are missing"


def describe_travel(summary, folder):
    """What the user needs to know."""
    lines = [f"{summary['balls']} balls of {summary['runs']} run{'s' if summary['runs'] > 1 else ''}"]
    for name in ("along", "across", "travel"):
        if name in summary:
            of = summary[name]["all"]
            between = summary[name]["over_runs"]["p50"]
            band = f" ({between['lowest']:.3f} to {between['highest']:.3f} in the runs)" if summary["runs"] > 1 else ""
            lines.append(f"{name}: median {of['p50']:.3f} m{band}, 5 to 95 % {of['p5']:.3f} to {of['p95']:.3f} m, "
                         f"all {of['min']:.3f} to {of['max']:.3f} m")
    if "runout" in summary:
        most = summary["runout"]["quantiles"][-1]
        of_runs = " (the farthest and the flattest of the runs)" if summary["runs"] > 1 else ""
        lines.append(f"run-out: {100 * most['share']:g} % within {most['distance']['highest']:.3f} m, reach angle "
                     f"{most['reach_angle']['lowest']:.1f} degrees{of_runs}" if most["distance"]["highest"] is not None
                     else f"run-out: {100 * most['share']:g} % within an unknown distance: {missing(summary)}")
        far, flat = summary["runout"]["distance"]["highest"], summary["runout"]["reach_angle"]["lowest"]
        lines.append(f"farthest ball: {far:.3f} m, reach angle {flat:.1f} degrees")
    lines.append(f"written to {folder}: {' '.join(summary['files'])}")
    return "\n".join(lines)
