"""slope study: one deck over the product of lists of its variables, several runs at a time; a table and maps over all.

Order of the work: check the deck and the settings, plan the runs (repeats.py), make their folders and run what is not
finished (jobs.py), collect (results.py), combine (combinations.py, headline.py).
"""
import argparse
from pathlib import Path

from ..case import decks
from ..case.settings import check_settings, one_value_each
from ..ensemble import intensity, repeats, results, sample
from ..ensemble.size_error import SizeErrors
from ..ensemble.study import check_names, check_thresholds, perform
from ..errors import SlopeError
from .run_arguments import add_deck, add_runs

EPILOG = """\
units: metres, seconds, m3 of ground (bulk); thresholds of --exceed in metres.

example: six runs, as many at a time as there are cores; the same command goes on after an interruption:
  tools/slope study inputs/20_embankment/in.embankment --set rolling=0:0.1:0.05 --set friction=25,30 -o out

with a conservative volume that counts the chance: every combination three times, from other offsets of the lattice:
  tools/slope study in.collapse --set rolling=0,0.1 --repeat xoffset=0.25,0.5 --road road.geojson -o out

an ensemble: 64 runs with values drawn from distributions, how likely a volume is exceeded, which variable matters:
  tools/slope study in.collapse --sample 64 --vary friction=20:40 --vary rolling=triangular:0:0:0.2 \\
      --road road.geojson -o out

Every run has a folder of its own in DIR, and is not repeated once it is finished. Over all runs: DIR/study.csv,
DIR/combinations.csv (mean and scatter), DIR/study.yaml, and the maps envelope_* (largest thickness) and exceedance_*
(share of the runs above a thickness).
"""


def add_parser(commands, **kwargs):
    """Add `study` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "study", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Run one deck over the product of lists of its variables.", **kwargs)
    add_deck(parser)
    parser.add_argument("--set", metavar="NAME=V1,V2,...", action="append", default=[],
                        help="values of an index variable of the deck; A:B:STEP stands for A, A + STEP, ... up to B")
    sample.add_arguments(parser)
    repeats.add_arguments(parser)
    parser.add_argument("--size-error", metavar="FILE", type=Path,
                        help="converge.yaml of `slope sensitivity --converge`: its error at the size of these balls "
                             "counts in the conservative volume")
    parser.add_argument("--exceed", default="0.1,0.5,1", metavar="T1,T2,...",
                        help="thicknesses of the maps of exceedance, m (default 0.1,0.5,1)")
    parser.add_argument("--exceed-speed", default="5", metavar="V1,V2,...",
                        help="speeds of the maps of exceedance of an ensemble, m/s (default 5)")
    parser.add_argument("--exceed-energy", default="100000", metavar="E1,E2,...",
                        help="energies of a ball for the same, J (default 100000)")
    parser.add_argument("--of", metavar="NAME",
                        help="quantity of the hazard curve of an ensemble, a column of study.csv (default: "
                             "remove_on_road_m3; without a road distance_99_m)")
    intensity.add_arguments(parser)
    add_runs(parser)
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input, and after all other runs when one failed."""
    settings = check_settings(args.set, args.deck)
    repeated = check_settings(args.repeat, args.deck, "--repeat")
    repeats.check(list(repeated), args.equally_good)
    thresholds = check_thresholds(args.exceed)
    defaults = decks.index_variables(args.deck)
    if args.sample is not None or args.vary:
        return run_ensemble(args, settings, repeated, thresholds, defaults)
    if not settings:
        raise SlopeError("--set", "must be given, or --sample with --vary")
    todo = repeats.plan(args.output, settings, repeated, defaults)
    check_names(todo)
    intensity.check(args.intensity, settings, bool(args.road))
    errors = None
    if args.size_error:
        if not args.road:
            raise SlopeError("--size-error", "needs --road: it is the error of the volume to remove", args.size_error)
        errors = SizeErrors(args.size_error, "remove_m3")
        errors.check(settings, defaults)
    return perform(args, {**settings, **repeated}, todo,
                   lambda todo, work: results.collect(args, settings, repeated, errors, todo, work, thresholds))


def run_ensemble(args, settings, repeated, thresholds, defaults):
    """The runs of --sample, and what they say together."""
    from ..ensemble import ensemble, ensemble_maps
    if args.sample is None:
        raise SlopeError("--sample", "must be given with --vary: how many runs")
    if args.size_error:
        raise SlopeError("--size-error", "must not be given with --sample: an ensemble has no conservative volume",
                         args.size_error)
    fixed = one_value_each(settings, "--set", "--vary")
    plan = sample.check(args.sample, args.design, args.seed, args.vary, args.deck, fixed, repeated)
    levels = ensemble_maps.Thresholds(thresholds, check_thresholds(args.exceed_speed, "--exceed-speed", "speeds"),
                                      check_thresholds(args.exceed_energy, "--exceed-energy", "energies"))
    of = ensemble.check_quantity(args.of, args.road is not None)
    todo = sample.plan(args.output, plan, fixed, repeated, defaults)
    check_names(todo)
    sample.check_growth(args.output, plan)
    several = sample.settings_of(todo)
    perform(args, {**several, **repeated}, todo,
            lambda todo, work: results.collect(args, several, repeated, None, todo, work, thresholds,
                                               ensemble.Order(plan, of, levels)),
            begin=lambda: sample.keep(args.output, plan))
