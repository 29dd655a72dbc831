"""slope fragility: how likely the bodies of find_slip fail at a peak acceleration."""
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, List, Optional

import numpy as np

from .. import disk, findings
from ..digits import cents, rounded
from ..errors import SlopeError
from ..options import Overwrite, flag, option, positional, several, parse_whole_number

DESCRIPTION = "How likely the bodies of find_slip fail at a peak acceleration."
EPILOG = """\
SLIPS: PREFIX.slips.csv of find_slip or slope stability, with its other files beside it, or the folder with it. Or the
folder of a route.
DIST: a number, or as in `slope study --vary`: LO:HI, uniform:LO:HI, loguniform:LO:HI, triangular:LO:MODE:HI,
normal:MEAN:DEVIATION:LO:HI, lognormal:MEDIAN:DEVIATION_OF_LN:LO:HI, list:V1@WEIGHT,V2@WEIGHT,...
MOTION: lines "t ax ay az" (s, m/s2), which `slope quake` makes of a record.

examples:
  tools/slope fragility slips --cohesion lognormal:8e3:0.3:1e3:4e4 --friction normal:30:3:20:40 --peaks 100:1200:25 \\
      --record motion.txt --displacement 0.5 -o fragility
  tools/slope fragility slips --cohesion 5e3:15e3 --friction 25:35 --peaks 100:1200 --pseudo-static 0.65 \\
      --hazard hazard.csv -o fragility

Writes fragility.csv, fragility.yaml and fragility.png, and capacities.csv: from which peak on each sample fails. With
this folder `slope study SITE --sample N --fragility DIR` says how likely which volume reaches the road.
"""


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    slips: Path = positional("what find_slip wrote, or slope route", metavar="SLIPS")
    density: Optional[float] = option(
        "density of the bodies, kg/m3 (default: as in the search); must be given where they were polygons of a route",
        metavar="R")
    cohesion: str = option("Pa", metavar="DIST")
    friction: str = option("friction angle, degrees; tan:DIST: its tangent", metavar="DIST")
    water: Optional[str] = option(
        "pore pressure over the weight per area, from 0 to below 1 (default: the water of the search)", metavar="DIST")
    correlation: float = option("between cohesion and friction, -1 to 1 (default 0)", metavar="R", default=0.0)
    peaks: str = option("largest horizontal accelerations, gal; without STEP 45 of them", metavar="LO:HI[:STEP]")
    record: List[Path] = several(
        "a motion of the ground, which is scaled to each peak; several may be given", metavar="MOTION")
    vertical: bool = flag("with the vertical component of the records")
    displacement: Optional[float] = option("a body fails if it slides farther than this, m (default 0.1)", metavar="D")
    pseudo_static: Optional[float] = option(
        "instead of records: a body fails if F < 1 with k = FACTOR peak / g, which is cautious if FACTOR is 1 or more",
        metavar="FACTOR")
    hazard: Optional[Path] = option(
        "lines peak,exceedance (gal, per year): gives the annual frequency of failure", metavar="CURVE.csv")
    sample: int = option(
        "samples of the strength, 256 to 1048576 (default 4096)", metavar="N", type=parse_whole_number, default=4096)
    seed: int = option("seed of the samples (default 1)", metavar="S", type=parse_whole_number, default=1)
    output: Path = option("folder for the results", "-o", metavar="DIR")


def run_fragility(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints medians, HCLPF and frequencies."""
    from ..seismic import fragility, fragility_files as files, hazard_file      # scipy, matplotlib
    from ..quakes import motion_file

    peaks = peaks_of(args.peaks)
    check_fragility_request(args)
    soil = soil_of(args)
    hazard = hazard_file.read_seismic_hazard(args.hazard) if args.hazard else None
    disk.check_folder(args.output, files.FILES, [args.slips], args.overwrite)
    limit = 0.1 if args.displacement is None else args.displacement
    records = {path: motion_file.read_motion(path) for path in args.record}
    failure: Any = fragility.PseudoStatic(args.pseudo_static) if args.pseudo_static is not None else \
        fragility.Slide(limit, [records[path] for path in args.record], args.vertical)
    bodies = bodies_of(args)
    strengths = fragility.strengths_of(soil, math.ceil(args.sample / fragility.REPLICATES), args.seed)
    capacity = fragility.capacities(bodies, strengths, failure)
    names = [body.name for body in bodies]
    columns = [capacity[:, :, k] for k in range(len(bodies))]
    if len(bodies) > 1:
        names.append(files.ANY)
        columns.append(capacity.min(axis=2))
    curves = [files.Curve(name, fragility.compute_fragility_curve(one, peaks), fragility.fit_lognormal(one, peaks),
                          fragility.frequency(one, hazard, peaks) if hazard else None,
                          float((one <= 0).all(axis=1).mean()), float(np.median(one)))
              for name, one in zip(names, columns)]
    warn, kept = findings.warner("fragility")
    for one in find_fragility_warnings(curves, peaks, bodies, args.pseudo_static, len(args.record), hazard):
        warn(one)
    for body in bodies:
        for path, rows in records.items():
            for one in motion_file.find_across(rows, (90.0 - body.direction) % 360.0, path, f" of body {body.name}"):
                warn(one)
    summary = {"bodies": [{"body": body.name, "volume_m3": body.columns.volume,
                           "base_sha256": disk.sha256(body.base)} for body in bodies],
               "peaks": args.peaks, "peaks_gal": peaks.tolist(),
               "hazard_curve": np.column_stack(hazard).tolist() if hazard else None, "slips": args.slips,
               "density": args.density, "cohesion": args.cohesion, "friction": args.friction,
               "water": args.water, "correlation": args.correlation, "samples": len(capacity), "seed": args.seed,
               "records": args.record, "vertical": args.vertical,
               "displacement": None if args.pseudo_static is not None else limit,
               "pseudo_static": args.pseudo_static, "hazard": args.hazard, "warnings": kept}
    files.write_fragility(args.output, peaks, curves, capacity, summary)
    print(describe_fragility(curves, args.output, files.FILES))


def bodies_of(args: Request) -> Any:
    """The bodies (slips.bodies.Body)."""
    from ..route import choices, search
    from ..slips import bodies

    if (args.slips / choices.NAME).is_file():
        slips = [search.read_route_body(args.slips, one["body"], args.density)
                 for one in search.table_of(args.slips)["bodies"]]
    else:
        slips = bodies.read_slip_bodies(args.slips, args.density)
    if args.water is None:
        return slips
    return [body._replace(columns=body.columns._replace(pressure=None)) for body in slips]


def check_fragility_request(args: Request) -> None:
    """The numbers, and what goes together."""
    if args.density is not None and not args.density > 0:
        raise SlopeError("--density", "must be > 0 kg/m3", f"{args.density:g}")
    if not -1 <= args.correlation <= 1:
        raise SlopeError("--correlation", "must be from -1 to 1", f"{args.correlation:g}")
    if not 256 <= args.sample <= 2 ** 20:
        raise SlopeError("--sample", "must be from 256 to 1048576", args.sample)
    if not 0 <= args.seed < 2 ** 31:
        raise SlopeError("--seed", "must be from 0 to 2147483647", args.seed)
    if args.pseudo_static is None:
        if not args.record:
            raise SlopeError("--record", "must give a motion of the ground, or --pseudo-static a factor instead")
        if args.displacement is not None and not args.displacement >= 0:
            raise SlopeError("--displacement", "must be >= 0 m", f"{args.displacement:g}")
    elif args.record or args.displacement is not None or args.vertical:
        raise SlopeError("--pseudo-static", "must be without --record, --displacement and --vertical, which are of "
                         "sliding blocks")
    elif not args.pseudo_static > 0:
        raise SlopeError("--pseudo-static", "must be > 0", f"{args.pseudo_static:g}")


def peaks_of(text):
    """The peaks of LO:HI[:STEP], gal."""
    rule = "must be LO:HI or LO:HI:STEP with 0 < LO < HI and 0 < STEP <= HI - LO, at most 1000 peaks (gal)"
    try:
        parts = [float(word) for word in text.split(":")]
    except ValueError:
        parts = []
    if len(parts) not in (2, 3) or not all(map(math.isfinite, parts)) or not 0 < parts[0] < parts[1]:
        raise SlopeError("--peaks", rule, text)
    step = parts[2] if len(parts) == 3 else (parts[1] - parts[0]) / 44
    if not 0 < step <= parts[1] - parts[0] or (parts[1] - parts[0]) / step > 1000:
        raise SlopeError("--peaks", rule, text)
    return parts[0] + step * np.arange(math.floor((parts[1] - parts[0]) / step + 1e-9) + 1)


def soil_of(args: Request):
    """What is sampled, checked."""
    from ..seismic.fragility import Soil

    tangent = args.friction.startswith("tan:")
    return Soil(parse_drawn_number("--cohesion", args.cohesion, 0.0, 1e8, "Pa"),
                parse_drawn_number("--friction", args.friction[4 * tangent:], 0.0, 10.0 if tangent else 89.0,
                                   "as a tangent" if tangent else "degrees"),
                parse_drawn_number("--water", args.water or "0", 0.0, 0.99, "as a ratio"), tangent, args.correlation)


def parse_drawn_number(option, text, low, high, unit):
    """A number, or a distribution of `slope study --vary`, with all values from low to high."""
    from ..statistics import distributions

    try:
        number: Any = float(text)
        values = [number]
    except ValueError:
        number = distributions.distribution(option[2:], text, option, text)
        try:
            values = [float(value) for value in number.limits]
        except ValueError:
            raise SlopeError(option, "must have numbers in its list", text) from None
    if not all(low <= value <= high for value in values):
        raise SlopeError(option, f"must be from {low:g} to {high:g} {unit}", text)
    return number


def find_fragility_warnings(curves, peaks, bodies, pseudo_static, records, hazard):
    """What a reader must know."""
    from ..slips.columns import FEWEST

    if pseudo_static is not None:
        judged = "cautious" if pseudo_static >= 1 else \
            "not cautious: a long motion may move it at a lower peak, use --record"
        yield findings.Finding("pseudo-static", {"factor": pseudo_static, "judged": judged})
    elif records == 1:
        yield findings.Finding("one record")
    for body in bodies:
        if body.cells < FEWEST:
            yield findings.Finding("columns", {"body": body.name, "value": body.cells, "limit": FEWEST})
    for curve in curves:
        standing = curve.at_rest * hazard.rates[0] / curve.frequency.total.value \
            if curve.frequency and curve.frequency.total.value > 0 else 0.0
        if curve.at_rest > 0.01 or standing > 0.05:
            makes = f", which makes {cents(standing)} of the frequency" if standing > 0.05 else ""
            yield findings.Finding("at rest", {"which": curve.title, "percent": 100 * curve.at_rest, "makes": makes})
        for k, outside, end, remedy in ((-1, peaks[-1] < curve.half < math.inf, "largest", "larger"),
                                        (0, 0 < curve.half < peaks[0], "smallest", "smaller")):
            if outside:
                yield findings.Finding("peaks", {
                    "which": curve.title, "peak": float(peaks[k]), "end": end, "remedy": remedy,
                    "percent": 100 * float(curve.band.value[k]), "half": curve.half})
        if curve.fit is None:
            yield findings.Finding("no fit", {"which": curve.title})
        elif curve.fit.off > 0.05:
            yield findings.Finding("fit is off", {"which": curve.title, "difference": float(curve.fit.off)})
        if curve.fit and curve.fit.at_hclpf > 1.5 * curve.fit.at_hclpf_fitted:
            yield findings.Finding("HCLPF", {"which": curve.title, "percent": 100 * float(curve.fit.at_hclpf),
                                             "fitted": 100 * float(curve.fit.at_hclpf_fitted)})
        if curve.frequency and curve.frequency.begins_late:
            yield findings.Finding("before the curve", {
                "which": curve.title, "percent": 100 * curve.frequency.before / float(curve.frequency.total.value),
                "least": curve.frequency.least})
        if curve.frequency and curve.frequency.ends_early:
            yield findings.Finding("beyond the curve", {"which": curve.title,
                                                        "per_year": float(curve.frequency.beyond)})


def describe_fragility(curves, folder, files):
    """What the user needs to know."""
    from ..seismic.fragility_files import ANY

    lines = []
    for curve in curves:
        line = curve.title
        if curve.fit:
            line += (f": median {curve.fit.median:.4g} gal (standard error {rounded(curve.fit.median_error, 2)}), "
                     f"beta_r {curve.fit.beta_r:.2f}, beta_u {curve.fit.beta_u:.2f}, HCLPF {curve.fit.hclpf:.4g} gal")
        if curve.frequency:
            total = curve.frequency.total
            least = "at least " * (curve.frequency.begins_late or curve.frequency.ends_early)
            line += (f"; fails {least}{float(total.value):.3g} times per year (90 %: {float(total.low):.3g} to "
                     f"{float(total.high):.3g})")
            if curve.name == ANY:
                most = sum(other.frequency.total.value for other in curves if other is not curve)
                line += f", {float(most):.3g} at most if each body may have a strength of its own"
        lines.append(line)
    return "\n".join([*lines, f"written to {folder}: {' '.join(files)}"])
