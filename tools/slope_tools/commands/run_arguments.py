"""Arguments of the commands that run decks."""
import argparse
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Callable, List, Optional, Union

from rich.console import Console
from rich.table import Table

from .. import streams
from ..findings import printer
from ..options import Program, flag, parse_number, option, several, parse_whole_number
from ..statistics import designs
from ..studies.setup import Road, Setup
from ..tables import study_table
from . import road_arguments

DECK = "LAMMPS input deck with one fix deposit/grid; the plain files beside it are its data"


def parse_volumes(text):
    """argparse type: different volumes >= 0, rising."""
    found = [parse_number(part) for part in text.split(",")]
    if any(one < 0 for one in found) or len(set(found)) < len(found):
        raise argparse.ArgumentTypeError(f"must be different volumes >= 0, with commas between, got {text!r}")
    return sorted(found)


@dataclass(frozen=True, kw_only=True)
class Engine(Program):
    """How the runs are made."""
    GROUP = "runs"
    command: str = ""
    np: int = option("MPI ranks of each run (default 1)", default=1, metavar="N")
    jobs: Optional[int] = option("runs at a time (default: as many as the cores of this machine allow)", metavar="J")
    dry_run: bool = flag("only list the runs")
    anew: bool = flag(
        "make finished runs again that are of another program, deck or data than the present ones (default: refuse "
        "them)")
    launcher: Optional[str] = option(
        "what starts the ranks of a run instead of mpirun, such as 'srun --mpi=pmix' or 'mpiexec -n {np}'; without "
        "{np}, -n N is added", metavar="COMMAND")
    engine: str = option(
        "local (default): runs on this machine; slurm: job arrays of a Slurm cluster, whose nodes see the folder",
        choices=("local", "slurm"), default="local")
    slurm: str = option(
        "options of sbatch for --engine slurm, such as '--partition=long --time=2:00:00'", metavar="OPTIONS",
        default="")


@dataclass(frozen=True, kw_only=True)
class Runs(road_arguments.Clearing, Engine):
    """How the runs of a deck are made and what is measured. Defaults: see Road."""
    GROUP = "runs"
    deck: Path
    given: Optional["Runs"] = None  # the request as it was given
    site: Optional[Path] = None     # whose deck it is
    road_name: str = ""             # of one of its several roads
    quiet: bool = False             # says nothing but the progress of the runs
    output: Optional[Path] = option("the study's folder", "-o", metavar="DIR")
    road: Optional[Path] = option("also compute the volume to remove from " + road_arguments.ROAD,
                                  metavar="POLYGON|LINE")
    cut_angle: Optional[float] = option(
        "rise of the cut surface from the road's edges, degrees (default 30); see `slope volume`", metavar="DEG")
    mesh: Optional[float] = option("side of the mesh cells of that volume, m (default 10)", metavar="SIZE")
    local: bool = flag("the road is in local metres, not in a CRS")
    all_columns: bool = flag("show all columns of the tables on the screen, also those for which it has no room")


@dataclass(frozen=True, kw_only=True)
class Repeats:
    """--repeat and --equally-good, of the commands that make runs."""
    repeat: List[str] = several(
        "values of a variable whose value is arbitrary, called seed, packing or ...offset: one more run for each, "
        "which shows the scatter by chance; A:B:STEP stands for A, A + STEP, ... up to B", metavar="NAME=V1,V2,...")
    equally_good: str = option(
        "variables of another name whose values are equally good, so that --repeat takes them", metavar="NAME,...",
        default="")


@dataclass(frozen=True, kw_only=True)
class Sample:
    """An ensemble."""
    GROUP = "ensemble"
    sample: Optional[int] = option(
        "an ensemble: N points of the distributions of --vary, instead of a product of lists", metavar="N",
        type=parse_whole_number)
    vary: List[str] = several(
        "a variable of the ensemble: LO:HI or uniform:LO:HI, loguniform:LO:HI, triangular:LO:MODE:HI, "
        "normal:MEAN:DEVIATION:LO:HI, lognormal:MEDIAN:DEVIATION_OF_LN:LO:HI, list:V1@WEIGHT,V2@WEIGHT,...",
        metavar="NAME=DISTRIBUTION")
    fit: Optional[Path] = option(
        "an ensemble of the sets of values that slope calibrate found equally good, of which FIT is the folder; "
        "instead of --vary (default --sample 32)", "--from", metavar="FIT")
    design: Optional[str] = option(
        "sobol (default): more points can be added later; lhs: Latin hypercube, whose number of points is final",
        choices=designs.KINDS)
    seed: Optional[int] = option("seed of the design (default 1)", metavar="S", type=parse_whole_number)


@dataclass(frozen=True, kw_only=True)
class Intensity:
    """Of the trigger."""
    intensity: Optional[str] = option(
        "variable of --set that is the intensity of the trigger (default: the one called peak, pga or ...intensity); "
        "needs --road", metavar="NAME")
    more_than: Optional[List[float]] = option(
        "volumes on the road, m3, whose probability of exceedance is given at each intensity (default: three round "
        "ones)", metavar="V1,V2,...", type=parse_volumes)


def teller(all_columns: bool) -> Callable[[Union[str, Table]], None]:
    """A function that prints a line, or a table: with all its columns, or those for which the screen has room."""
    def tell(what):
        if isinstance(what, str):
            print(what, flush=True)
            return
        width = Console().width if streams.is_terminal(sys.stdout) else 180
        if all_columns:
            width = max(width, study_table.width_of(what))
        left_out = study_table.fit_width(what, width)
        if left_out:
            note = f"left out, in the files: {', '.join(left_out)}; --all-columns shows all"
            what.caption = "; ".join(filter(None, [what.caption, note]))
        Console(width=width).print(what)
    return tell


def setup_of(args: Runs) -> Setup:
    """What these arguments say."""
    given = {name: value for name in ("cut_angle", "mesh") if (value := getattr(args, name)) is not None}
    road = Road(args.road, **given, local=args.local, asked=road_arguments.asked(args),
                name=args.road_name) if args.road else None
    found = engine_of(args)._replace(deck=args.deck, output=args.output or args.deck, road=road, site=args.site,
                                     given=args.given)
    return found if args.quiet else found._replace(tell=teller(args.all_columns), warn=printer(args.command))


def engine_of(args: Engine) -> Setup:
    """How runs are made, of a deck and in a folder that are still to be said; says nothing."""
    return Setup(Path(), Path(), args.np, args.jobs, None, args.lmp, args.launcher, args.engine, args.slurm,
                 args.dry_run, args.anew)
