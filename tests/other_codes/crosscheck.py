"""slope crosscheck: the same scenes in other codes, as in the paper's validation.

Order of the work: read a deck's final numbers (its run, with zero steps), write the scene for every code, run, compare.

A peer is held against its twin: pair gran/restitution with those keywords that make it as the peer is (scheme plain,
limit_damping yes). What remains is explained in Code.differs; what ours does differently by default shows in the table.
"""
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from slope_tools import disk
from slope_tools.errors import SlopeError
from slope_tools.options import Program, bare, flag, option
from slope_tools.programs import find_lmp
from slope_tools.runs import jobs
from . import peers
from .crosscheck_cases import PEERS, Work, bounce, collapse, rolling, slide_roll
from .crosscheck_laws import laws
from .crosscheck_report import report
from .crosscheck_table import table

DESCRIPTION = "The same scenes in other codes: bounce, slide, roll, rolling resistance, a collapse, the paper's table."
EPILOG = """\
units: metres, seconds, m3 of ground (bulk).

example: four minutes; with balls of 2.5 m instead of 4 m, a quarter of an hour; two codes:
  tools/slope crosscheck --quick
  tools/slope crosscheck -o crosscheck
  tools/slope crosscheck --quick --peers granular,liggghts -o two

Writes DIR/crosscheck.csv, DIR/crosscheck.yaml, DIR/crosscheck.png, and the input of every code in a folder of its own.
"""
CASES = {"bounce": bounce, "slide_roll": slide_roll, "rolling": rolling, "collapse": collapse, "table": table,
         "laws": laws}


@dataclass(frozen=True, kw_only=True)
class Request(Program):
    quick: bool = flag("a collapse of balls of 4 m instead of 2.5 m")
    only: Optional[str] = option(f"these cases: {', '.join(CASES)} (default all)", metavar="CASE,...")
    peers: Optional[str] = option(
        "these codes: " + ", ".join(code.name for code in PEERS) + " (default all)", metavar="CODE,...")
    output: Optional[Path] = option(
        "folder of the results (default crosscheck); without any word the command says what it would do", "-o",
        metavar="DIR")


def run_crosscheck(args: Request) -> None:
    """Do the command; raises SlopeError on bad input, and when codes disagree. Prints the comparison."""
    cases = peers.chosen("--only", args.only, CASES)
    names = peers.chosen("--peers", args.peers, [code.name for code in PEERS])
    if bare(args):
        print(f"would run {', '.join(cases)} in {', '.join(names)}, 15 minutes; nothing is run without a word:"
              "\n  slope crosscheck -o DIR        all of it\n"
              "  slope crosscheck --quick       coarser balls, four minutes\n"
              f"  slope crosscheck --only CASE   of {', '.join(CASES)}")
        return
    output = args.output or Path("crosscheck")
    if output.exists() and not output.is_dir():
        raise SlopeError("-o", "must be a folder", output)
    work = Work(output, find_lmp(args.lmp), names, args.quick)
    try:
        output.mkdir(parents=True, exist_ok=True)
        with disk.alone_in(output), jobs.signals_interrupt():
            for case in cases:
                CASES[case](work, case)
            report(work)
    except OSError as error:
        raise SlopeError(error.filename or output, f"cannot be used: {error.strerror}") from error
    failed = [check for check in work.checks if check.passed is False]
    if failed:
        first = failed[0]
        raise SlopeError(output, f"{len(failed)} of {sum(check.passed is not None for check in work.checks)} "
                         f"comparisons are outside of their tolerance: {first.case}, {first.quantity}, {first.code}")
