"""slope calibrate: which values of a deck's variables give what was observed, and how well they are known.

Order of the work: check what was observed (observations.py), make runs batch after batch where they say most
(calibration.py, backanalysis.py), run them as `slope study` does (study.py, jobs.py), write what they say together.
"""
import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional, Tuple

from .. import findings
from ..case import data_files, decks
from ..case.settings import check_settings, one_value_each
from ..deposits.score import THRESHOLD
from ..errors import SlopeError
from ..fitting import calibration, observations
from ..fitting.fit import Fit
from ..options import parse_number, option, positional, several, parse_whole_number
from ..runs import jobs, repeats
from ..statistics import backanalysis, distributions
from ..studies import study
from . import run_arguments

TOLERANCE = 0.05
DESCRIPTION = "Which values of a deck's variables give a deposit that was observed, and how well they are known."
EPILOG = """\
units: metres, m2, m3 of ground (bulk).

example: friction, rolling resistance and roughness from a mapped deposit, by 60 runs:
  tools/slope calibrate in.collapse --observed deposit.geojson --vary friction=15:40 --vary rolling=0:0.2 \\
      --vary spacing=0.5:1.3 --repeat xoffset=0.25,0.5,0.75 --runs 60 -o fit

from numbers alone, such as those of a report:
  tools/slope calibrate in.collapse --front 2000 --area 850000 --vary friction=10:35 --vary rolling=0:0.2 \\
      --runs 40 -o fit

The same command continues after an interruption; a larger --runs adds to the existing runs. Writes DIR/calibrate.csv,
DIR/calibrate.yaml, the regions over pairs of variables DIR/calibrate.png, and, with --observed, predicted against
mapped DIR/predicted.png.
"""


def tolerance(text):
    """argparse type: (name of an observation, "" for all, share)."""
    name, equals, share = text.rpartition("=")
    if equals and name not in observations.KINDS:
        raise argparse.ArgumentTypeError(f"must name one of {', '.join(observations.KINDS)}, got {name!r}")
    return name, parse_number(share)


@dataclass(frozen=True, kw_only=True)
class Request(run_arguments.Repeats, run_arguments.Runs):
    deck: Path = positional(run_arguments.DECK, metavar="DECK")
    output: Path = option("the study's folder", "-o", metavar="DIR")
    observed: Optional[Path] = option(
        "the mapped deposit: its outline, or its thickness in metres, as for `slope score`", metavar="POLYGON|RASTER")
    front: Optional[float] = option(
        "how far the mass went, from crown to tip along its fall path in plan, m", metavar="L")
    front_is: str = option(
        "what of a run is compared with it: its length along the fall path (default), which single balls do not move, "
        "or the distance that 95 or 99 %% of the volume stay within", choices=observations.FRONTS, default="length")
    area: Optional[float] = option("total area that was covered at any time by more than --threshold, m2", metavar="A")
    road_volume: Optional[float] = option("volume on the road of --road, m3", metavar="V")
    tolerance: List[Tuple[str, float]] = several(
        "standard deviation of what was observed, as a share of it "
        f"(default {TOLERANCE:g}); chance comes on top. NAME=SHARE: of one observation, observed, "
        "front, area or volume; may be repeated", metavar="[NAME=]SHARE", type=tolerance)
    threshold: float = option(
        f"thickness above which a cell counts as deposit, m (default {THRESHOLD:g})", metavar="T", default=THRESHOLD)
    vary: List[str] = several(
        "variable of the deck to be calibrated, and its range; all values in it are equally likely before "
        "(loguniform:LO:HI and the others of `slope study` too)", metavar="NAME=LO:HI", required=True)
    runs: int = option("total number of runs", metavar="N")
    set: List[str] = several("value of another index variable in all runs (default: the deck's)", metavar="NAME=VALUE")
    seed: int = option("seed of the first points (default 1)", metavar="S", type=parse_whole_number, default=1)


def run_calibrate(args: Request) -> None:
    """Do the command; raises SlopeError on bad input, and where too few runs finished."""
    shares = dict(args.tolerance)
    wanted = observations.Wanted(args.observed, args.front, args.area, args.road_volume, shares.pop("", TOLERANCE),
                                 args.threshold, args.local, shares, args.front_is)
    variables = distributions.parse(args.vary, args.deck, ranges_only=True)
    fixed = one_value_each(check_settings(args.set, args.deck), "--set", "--vary")
    repeated = check_settings(args.repeat, args.deck, "--repeat")
    repeats.check_repeats(list(repeated), args.equally_good)
    for variable in variables:
        for given, names in (("--set", fixed), ("--repeat", repeated)):
            if variable.name in names:
                raise SlopeError("--vary", f"must not name a variable of {given}", variable.name)
    least = 2 * len(variables) + 3
    if args.runs < least:
        raise SlopeError("--runs", f"must be at least {least} for {len(variables)} parameters", args.runs)
    if not 0 <= args.seed < 2 ** 32:
        raise SlopeError("--seed", "must be from 0 to 4294967295", args.seed)
    wanted.check(args.road is not None)
    terrain = study.terrain_of(args.deck, fixed)
    if terrain:
        wanted.check_place(terrain, findings.printer("calibrate"))
    settings = {name: [value] for name, value in fixed.items()}
    files = data_files.data_files(args.deck, {**settings, **repeated})
    setup = run_arguments.setup_of(args)
    if setup.road:
        study.check_deck_road(setup.road, setup.deck, settings)
    study.check_output(setup)
    about = {**wanted.about, "deck": args.deck.name, "set": fixed, "repeat": repeated,
             "variables": {one.name: one.text for one in variables}, "seed": args.seed}
    ledger = calibration.Ledger(args.output, about, variables)
    chances = repeats.chances_of(repeated, {**decks.index_variables(args.deck), **fixed})
    batch = args.jobs or max(1, jobs.cores() // args.np)
    work_plan = calibration.Calibration(ledger, args.output, fixed, chances, args.seed, args.runs, batch)
    if args.dry_run:
        first = backanalysis.first(len(variables), args.seed)[:args.runs - 1]
        print(f"{args.runs} runs: {len(ledger.points) or len(first)} decided on; the others follow from what they give")
        return
    with study.prepared(setup, files, batch) as work:
        Fit(setup, wanted, work_plan, work).do()
