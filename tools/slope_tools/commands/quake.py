"""slope quake: strong-motion records to the acceleration of the ground that fix ground/motion reads."""
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional

from ..case.decks import quoted
from ..disk import check_file, check_standing
from ..errors import SlopeError
from ..options import Overwrite, option, positional
from ..quakes import quake_motion as motions, quake_records as records
from ..quakes.quake import Processing, processed, write_quake

DESCRIPTION = "Strong-motion records to the acceleration of the ground that fix ground/motion reads."
EPILOG = """\
RECORD: one file for each component, or one with all of them; ARCHIVE (.zip, .tar.gz) or ARCHIVE/PATTERN
  K-NET, KiK-net, PEER AT2, ESM, ITACA, AFAD, CWA, JMA, GeoNet: direction, unit and length are in the head
  CSV: a first line such as "time,EW (gal),NS (gal),UD (gal)"; units gal, g, m/s2; times (s) evenly spaced
OUT.txt has lines "t ax ay az" (s, m/s2) along the deck's axes: x towards --azimuth, y 90 degrees to the left, z up.

examples:
  tools/slope quake FKS005.EW FKS005.NS FKS005.UD -o motion.txt
  tools/slope quake FKS005.EW FKS005.NS FKS005.UD --peak 300 --band 0.1 20 --azimuth 135 -o motion.txt
"""


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    records: List[str] = positional("files with the components of one record", metavar="RECORD", nargs="+")
    output: Path = option(
        "the motion; OUT.yaml, OUT.spectrum.csv and OUT.png are written beside it", "-o", metavar="OUT.txt")
    peak: Optional[float] = option(
        "scale to this largest horizontal acceleration, of both components together", metavar="GAL", one_of="size")
    scale: Optional[float] = option("scale by this factor", metavar="F", one_of="size")
    azimuth: float = option(
        "compass bearing of the deck's x axis (default 90: x is east, y is north)", metavar="DEG", default=90.0)
    window: Optional[List[float]] = option("this part of the record only (s)", metavar=("BEGIN", "END"), nargs=2)
    band: Optional[List[float]] = option(
        f"band-pass (Hz): Butterworth of order {motions.ORDER}, forwards and backwards", metavar=("LOW", "HIGH"),
        nargs=2)
    baseline: str = option(
        "rest: the ground ends at rest where it began (default); mean: subtract the mean; none",
        choices=("rest", "mean", "none"), default="rest")
    unit: Optional[str] = option("unit of a CSV that names none", choices=("gal", "g", "m/s2"))


def run_quake(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what the motion is like and the line for the deck."""
    check_quake_request(args)
    components = [component for path in args.records for component in records.read_quake_record(path, args.unit)]
    if args.unit and all(component.unit_in_head for component in components):
        raise SlopeError("--unit", "must be given for a CSV that names no unit: files of networks have theirs in "
                         "their heads", args.unit)
    wanted = Processing(args.azimuth, args.baseline, args.window, args.band, args.peak, args.scale)
    motion, steps = processed(components, wanted)
    about = {"records": [c.source for c in components], "processing": steps, **motions.measures(motion)}
    write_quake(args.output, motion, about)
    print(describe_motion(args.output, about))


def check_quake_request(args: Request) -> None:
    """The numbers, what would be overwritten, and where nothing can be written, before there is any work."""
    check_file(args.output, ".txt", args.records, "a record")
    check_standing(args.output.with_suffix(".yaml"), [args.output], args.records, args.overwrite)
    for name in ("peak", "scale"):
        value = getattr(args, name)
        if value is not None and not (value > 0 if name == "peak" else value != 0):
            raise SlopeError(f"--{name}", "must be > 0" if name == "peak" else "must not be 0", f"{value:g}")
    if not 0 <= args.azimuth <= 360:
        raise SlopeError("--azimuth", "must be a compass bearing, 0 to 360 degrees", f"{args.azimuth:g}")


def describe_motion(path, summary):
    """What the user needs to know of the motion, and the line for the deck."""
    lines = [f"{path}: {summary['points']} points every {summary['dt']:g} s, {summary['length']:g} s; "
             f"{'; '.join(summary['processing'])}",
             f"largest horizontal acceleration {summary['peak_gal']:.5g} gal, Arias intensity "
             f"{summary['arias_horizontal']:.4g} m/s, D5-95 {summary['duration_5_95_horizontal']:.4g} s"
             if summary["peak_gal"] > 0 else "no horizontal component: the ground moves up and down only",
             "axis  acc. gal  vel. m/s  disp. m   end vel.  end disp.  Arias m/s  D5-95 s"]
    for axis, a in summary["axes"].items():
        lines.append(f"{axis:<5} {a['acceleration_gal']:<9.4g} {a['velocity']:<9.4g} {a['displacement']:<9.4g} "
                     f"{a['end_velocity']:<9.2g} {a['end_displacement']:<10.2g} {a['arias']:<10.4g} "
                     f"{a['duration_5_95']:.4g}")
    return "\n".join([*lines, f"fix shake soil ground/motion {quoted(str(path))}"])
