"""slope sensitivity: one variable of a deck at a time; what it does to the volumes, how far one run can be trusted.

Order of the work: plan the base run and those that differ from it by one variable, run them as `slope study` does
(study.py, jobs.py), hold each against the mean of the equivalent runs. With --converge: size_study.py.
"""
import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional

from ..case.settings import check_settings, one_value_each
from ..errors import SlopeError
from ..options import option, positional, several
from ..runs import repeats
from ..studies import study
from ..studies.sensitivity import OF_ROAD, OF_TRAVEL, collect_trials, plan_trials, quantities
from ..tables.quantities import On, keys
from . import run_arguments

DESCRIPTION = "One variable of a deck at a time: what it does to the volumes, and how far one run can be trusted."
EPILOG = """\
units: metres, seconds, m3 of ground (bulk).

example: what the size of the balls and the time step do, against the scatter over offsets of the lattice:
  tools/slope sensitivity inputs/20_embankment/in.embankment --road inputs/20_embankment/road.csv --local \\
      --set d=2.5 --try d=1.25 --try step=0.5 --repeat xoffset=0.25,0.5,0.75 -o out

the effect of the size of the balls, with constant field balls: whether halving them changes more than chance:
  tools/slope sensitivity inputs/20_embankment/in.embankment --road inputs/20_embankment/road.csv --local \\
      --converge d=4,2.5,1.25 --set field_d=1.25 --repeat xoffset=0.25,0.5 -o sizes

Runs are kept and reused as those of `slope study`. Writes DIR/sensitivity.csv, DIR/sensitivity.yaml and the tornado
chart DIR/sensitivity.png; with --converge DIR/converge.csv, DIR/converge_runs.csv, DIR/converge.yaml, DIR/converge.png.
"""


@dataclass(frozen=True, kw_only=True)
class Request(run_arguments.Repeats, run_arguments.Runs):
    deck: Path = positional(run_arguments.DECK, metavar="DECK")
    output: Path = option("the study's folder", "-o", metavar="DIR")
    tried: List[str] = several(
        "values of an index variable of the deck that are a choice, each in a run of its own; A:B:STEP stands for A, "
        "A + STEP, ... up to B", "--try", metavar="NAME=V1,V2,...")
    levels: List[str] = several(argparse.SUPPRESS)
    converge: Optional[str] = option(
        "sizes of the balls, or another variable that should tend to 0, each half of the one before: whether halving "
        "it changes more than chance; with --repeat at each size, without --try", metavar="NAME=V1,V2,...")
    set: List[str] = several("value of an index variable in the base run (default: the deck's)", metavar="NAME=VALUE")
    of: Optional[str] = option(
        f"quantities to examine (default {OF_ROAD}; {OF_TRAVEL} of --converge without a road), of "
        f"{', '.join(keys(On.ASKED))}", metavar="NAME,...")


def run_sensitivity(args: Request) -> None:
    """Do the command; raises SlopeError on bad input, and after all other runs when one failed."""
    if args.levels:
        raise SlopeError("--levels", "must not be given here: it is --try now (sizes of balls have --levels of slope "
                         "study)", args.levels[0])
    base = one_value_each(check_settings(args.set, args.deck), "--set", "--try, --repeat and --converge")
    repeated = check_settings(args.repeat, args.deck, "--repeat")
    kinds = {"vary": check_settings(args.tried, args.deck, "--try"), "repeat": repeated}
    for name in kinds["vary"].keys() & repeated.keys():
        raise SlopeError("--repeat", "must not name a variable of --try", name)
    repeats.check_repeats(list(repeated), args.equally_good)
    of = quantities(args.of, args.road is not None, args.converge is not None)
    setup = run_arguments.setup_of(args)
    if args.converge:
        if args.tried:
            raise SlopeError("--converge", "must be given without --try: one kind of study at a time", args.tried[0])
        from ..studies import size_study
        return size_study.run_size_study(setup, args.converge, base, repeated, of)
    todo = plan_trials(setup, base, kinds)
    settings = {name: list(dict.fromkeys(one.chosen[name] for one in todo if name in one.chosen))
                for name in (*base, *kinds["vary"], *kinds["repeat"])}
    study.perform(setup, settings, todo, lambda todo, work: collect_trials(setup, base, of, todo, work))
