"""slope bench: how fast a collapse runs, against the codes that are installed, and how that scales.

Order of the work: make the scene (a collapse, run until the mass is dense and moves), run each part of the benchmark in
alternation, evaluate (medians of the ratios of neighbouring runs), write.
"""
import argparse
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional

from slope_tools import disk
from slope_tools.errors import SlopeError
from slope_tools.options import bare, count, flag, option
from slope_tools.programs import find_lmp
from slope_tools.runs import jobs
from . import peers
from .bench_runs import Plan
from .bench_scenes import BALLS

PARTS = {"peers": "against the other codes, one core",
         "terrain": "terrain ten times larger, the same moving mass",
         "ranks": "MPI ranks against one",
         "throughput": "two single-rank runs side by side against one",
         "weak": "many copies of the scene: 1e6 moving balls"}
DESCRIPTION = "How fast a collapse runs: against other codes, on larger terrains, on ranks, with more balls."
EPILOG = """\
units: metres, seconds, bytes; time per ball and step in ns.

example: a first look in two minutes; all of it on a machine with nothing else to do; one part, four ranks too:
  tools/slope bench --quick
  tools/slope bench -o bench
  tools/slope bench --only ranks --np 2,4 -o ranks

Writes DIR/bench.csv (every run), DIR/bench.yaml, DIR/bench.png, and the input of every code in a folder of its own.
"""


@dataclass(frozen=True, kw_only=True)
class Request:
    quick: bool = flag("a small scene, few steps and repeats, without 1e6 balls and runs to rest; two minutes")
    balls: Optional[int] = option(f"moving balls, about, 100 at least (default {BALLS}; --quick 8000)", metavar="N")
    field_factor: float = option(
        "area of the terrain, times that of the scene (default 1: about 28,000 fixed balls)", default=1.0, metavar="F")
    steps: Optional[int] = option("timed steps of a run (default 1000; --quick 300)", metavar="N")
    runs: Optional[int] = option("runs of each kind (default 5; --quick 3)", metavar="N")
    np: str = option("ranks of the parts ranks and weak, besides one (default 2)", default="2", metavar="N1,N2,...")
    only: Optional[str] = option(f"these parts: {', '.join(PARTS)} (default all)", metavar="PART,...")
    peers: Optional[str] = option(
        "these codes: " + ", ".join(code.name for code in peers.ALL[1:])
        + " (default all; build: the one of --lmp build=FILE)", metavar="CODE,...")
    lmp: Optional[List[str]] = option(
        "the LAMMPS program (default: LMP of the environment, then build/lmp beside tools/); with CODE= that of one "
        "code: granular, hooke, or build for another build of ours", metavar="[CODE=]FILE", action="append")
    output: Optional[Path] = option(
        "folder of the results (default bench); without any word the command says what it would do", "-o",
        metavar="DIR")


def run_bench(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints the tables."""
    if args.field_factor < 1:
        raise SlopeError("--field-factor", "must be >= 1", f"{args.field_factor:g}")
    parts = peers.chosen("--only", args.only, PARTS)
    lmp, programs = lmp_of_each(args.lmp, [code.name for code in peers.ALL[1:] if code.is_lammps])
    names = peers.chosen("--peers", args.peers, [code.name for code in peers.ALL[1:]
                                                 if code is not peers.Build or code.name in programs])
    ranks = [rank for rank in whole_numbers("--np", args.np) if rank > 1]
    if ranks and {"ranks", "weak"} & set(parts) and not shutil.which("mpirun"):
        raise SlopeError("--np", "needs mpirun, which is not on the PATH", args.np)
    check_timed(parts, ranks, args)
    if bare(args):
        print(f"would time {BALLS:,} balls against {', '.join(names)}, three quarters of an hour; nothing is run "
              "without a word:\n  slope bench -o DIR        all of it\n"
              "  slope bench --quick       a small scene, two minutes\n"
              "  slope bench --only PART   " + "; ".join(f"{part}: {what}" for part, what in PARTS.items()))
        return
    balls = args.balls or (8000 if args.quick else BALLS)
    if balls < 100:
        raise SlopeError("--balls", "must be >= 100", balls)
    output = args.output or Path("bench")
    if output.exists() and not output.is_dir():
        raise SlopeError("-o", "must be a folder", output)
    plan = Plan(output, lmp, programs, args.steps or (300 if args.quick else 1000),
                args.runs or (3 if args.quick else 5), balls, args.field_factor, args.quick)
    try:
        output.mkdir(parents=True, exist_ok=True)
        with disk.alone_in(output), jobs.signals_interrupt(), plan:
            plan.do(parts, names, ranks)
    except OSError as error:
        raise SlopeError(error.filename or output, f"cannot be used: {error.strerror}") from error


def check_timed(parts, ranks, args: Request) -> None:
    """Raise SlopeError if no part has a run to time."""
    without = {}
    if args.quick:
        without["weak"] = "weak has none with --quick"
    if not ranks:
        without["ranks"] = f"ranks has none with --np {args.np}"
    if all(part in without for part in parts):
        raise SlopeError("--only", f"must name a part with runs to time: {', '.join(without[part] for part in parts)}",
                         args.only)


def whole_numbers(option, text):
    try:
        return [count(word) for word in text.split(",")]
    except argparse.ArgumentTypeError as error:
        raise SlopeError(option, str(error)) from error


def lmp_of_each(options, names):
    """The program that --lmp FILE names (default: find_lmp's), and {code: program} of --lmp CODE=FILE; absolute
    paths. names: the codes that may have a program of their own.
    """
    everybody, own = None, {}
    for word in options or ():
        code, equals, file = word.partition("=")
        if not equals:
            if everybody is not None:
                raise SlopeError("--lmp", "must name one program for all, others as CODE=FILE", word)
            everybody = word
        elif code not in names:
            raise SlopeError("--lmp", f"must be FILE, or CODE=FILE with CODE of {', '.join(names)}", word)
        else:
            own[code] = find_lmp(file)
    return find_lmp(everybody), own
