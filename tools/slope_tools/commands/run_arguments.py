"""Arguments of the commands that run decks."""
import argparse
import sys
from pathlib import Path
from typing import Optional

from rich.console import Console

from ..case.settings import check_settings
from ..ensembles import known_events
from ..errors import SlopeError
from ..findings import printer
from ..options import count, number, whole
from ..sites import site_choices
from ..statistics import designs
from ..studies.setup import Road, Setup
from ..tables import intensity
from . import known_arguments, road_arguments


def add_deck(parser, site=False):
    parser.add_argument("deck", metavar="DECK|SITE" if site else "DECK", type=Path,
                        help="LAMMPS input deck with one fix deposit/grid; the plain files beside it are its data"
                             + "; or a folder made by `slope site`: its standard study is run" * site)


def add_runs(parser, road=False, output=True):
    """Arguments of how the runs are made and what is measured; road: it must be given. Defaults: see Road."""
    parser.add_argument("-o", dest="output", metavar="DIR", required=output, type=Path, help="the study's folder")
    parser.add_argument("--np", type=count, default=1, metavar="N", help="MPI ranks of each run (default 1)")
    parser.add_argument("--jobs", type=count, metavar="J",
                        help="runs at a time (default: as many as the cores of this machine allow)")
    parser.add_argument("--road", metavar="POLYGON|LINE", type=Path, required=road,
                        help="also compute the volume to remove from " + road_arguments.ROAD)
    road_arguments.add_clearing(parser)
    parser.add_argument("--cut-angle", metavar="DEG", type=number,
                        help="rise of the cut surface from the road's edges, degrees (default 30); see `slope volume`")
    parser.add_argument("--mesh", metavar="SIZE", type=number,
                        help="side of the mesh cells of that volume, m (default 10)")
    parser.add_argument("--local", action="store_true", help="the road is in local metres, not in a CRS")
    parser.add_argument("--lmp", metavar="FILE", help="the LAMMPS program (default: LMP of the environment, then "
                        "build/lmp beside tools/)")
    parser.add_argument("--dry-run", action="store_true", help="only list the runs")
    parser.add_argument("--anew", action="store_true",
                        help="make finished runs again that are of another program, deck or data than the present ones "
                             "(default: refuse them)")
    parser.add_argument("--launcher", metavar="COMMAND",
                        help="what starts the ranks of a run instead of mpirun, such as 'srun --mpi=pmix' or 'mpiexec "
                             "-n {np}'; without {np}, -n N is added")
    parser.add_argument("--engine", choices=("local", "slurm"), default="local",
                        help="local (default): runs on this machine; slurm: job arrays of a Slurm cluster, whose nodes "
                             "see DIR")
    parser.add_argument("--slurm", metavar="OPTIONS", default="",
                        help="options of sbatch for --engine slurm, such as '--partition=long --time=2:00:00'")


def add_repeats(parser):
    """--repeat and --equally-good, of the commands that make runs."""
    parser.add_argument("--repeat", metavar="NAME=V1,V2,...", action="append", default=[],
                        help="values of a variable whose value is arbitrary, called seed or ...offset: one more run "
                             "for each, which shows the scatter by chance; A:B:STEP stands for A, A + STEP, ... up to "
                             "B")
    parser.add_argument("--equally-good", metavar="NAME,...", default="",
                        help="variables of another name whose values are equally good, so that --repeat takes them")


def add_sample(parser) -> None:
    """--sample, --vary, --design and --seed."""
    parser.add_argument("--sample", metavar="N", type=whole,
                        help="an ensemble: N points of the distributions of --vary, instead of a product of lists")
    parser.add_argument("--vary", metavar="NAME=DISTRIBUTION", action="append", default=[],
                        help="a variable of the ensemble: LO:HI or uniform:LO:HI, loguniform:LO:HI, "
                             "triangular:LO:MODE:HI, normal:MEAN:DEVIATION:LO:HI, "
                             "lognormal:MEDIAN:DEVIATION_OF_LN:LO:HI, list:V1@WEIGHT,V2@WEIGHT,...")
    parser.add_argument("--from", metavar="FIT", dest="fit", type=Path,
                        help="an ensemble of the sets of values that slope calibrate found equally good, of which FIT "
                             "is the folder; instead of --vary (default --sample 32)")
    parser.add_argument("--design", choices=designs.KINDS,
                        help="sobol (default): more points can be added later; lhs: Latin hypercube, "
                             "whose number of points is final")
    parser.add_argument("--seed", metavar="S", type=whole, help="seed of the design (default 1)")


def condition_of(args) -> Optional[known_events.Condition]:
    """What --known and its company ask for; SlopeError if some are there without it."""
    if args.known is not None:
        site = args.deck.parent if (args.deck.parent / site_choices.NAME).is_file() else None
        return known_events.check(known_arguments.choice_of(args, site), args.known, args.deck)
    for option, given in (("--except", args.left_out), ("--confined or --unconfined", args.confined is not None)):
        if given:
            raise SlopeError(option, "must be given with --known")
    return None


def add_intensity(parser):
    parser.add_argument("--intensity", metavar="NAME",
                        help="variable of --set that is the intensity of the trigger (default: the one called peak, "
                             "pga or ...intensity); needs --road")
    parser.add_argument("--more-than", metavar="V1,V2,...", type=volumes,
                        help="volumes on the road, m3, whose probability of exceedance is given at each intensity "
                             "(default: three round ones)")


# options of one kind of study: whether they go with --sample, and their default
OF_A_KIND = {"intensity": (False, None), "more_than": (False, ()), "of": (True, None), "known": (True, None),
             "exceed_speed": (True, "5"),
             "exceed_energy": (True, "100000"), "design": (True, designs.SOBOL), "seed": (True, 1)}


def settle_kind(args, sample):
    """Give the options of a study, with --sample or without it, their defaults; SlopeError on one of the other kind."""
    for name, (with_sample, default) in OF_A_KIND.items():
        value = getattr(args, name)
        if value is None:
            setattr(args, name, default)
        elif with_sample != sample:
            raise SlopeError(f"--{name.replace('_', '-')}", "must be given with --sample only" if with_sample else
                             "must not be given with --sample",
                             ",".join(f"{one:g}" for one in value) if isinstance(value, list) else value)
    if args.more_than and not intensity.check(args.intensity, check_settings(args.set, args.deck), bool(args.road)):
        raise SlopeError("--more-than", "needs an intensity (--intensity, or a variable of several values called peak, "
                         "pga or ...intensity) and --road", ",".join(f"{one:g}" for one in args.more_than))


def volumes(text):
    """argparse type: different volumes >= 0, rising."""
    found = [number(part) for part in text.split(",")]
    if any(one < 0 for one in found) or len(set(found)) < len(found):
        raise argparse.ArgumentTypeError(f"must be different volumes >= 0, with commas between, got {text!r}")
    return sorted(found)


def tell(what):
    """Print a line, or a table of rich."""
    if isinstance(what, str):
        print(what, flush=True)
    else:
        (Console() if sys.stdout.isatty() else Console(width=180)).print(what)


def setup_of(args) -> Setup:
    """What these arguments say."""
    given = {name: value for name in ("cut_angle", "mesh") if (value := getattr(args, name)) is not None}
    road = Road(args.road, **given, local=args.local, asked=road_arguments.asked(args)) if args.road else None
    return Setup(args.deck, args.output, args.np, args.jobs, road, args.lmp, args.launcher, args.engine, args.slurm,
                 args.dry_run, args.anew, getattr(args, "site", None), tell, printer(args.command))
