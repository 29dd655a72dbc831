"""slope verify: runs the cases, holds them against closed forms and published numbers, and writes the report on that.

Order of the work: collect the claims and their runs, run these (a run that several claims need once), evaluate, write.
"""
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from .. import disk
from ..errors import SlopeError
from ..options import Program, bare, flag, option
from ..programs import find_lmp
from ..runs import jobs
from ..validation import verification
from ..validation.verify import NAME, NUMBERS, Runner, compared, judge, line, made, value, write_verification

DESCRIPTION = "Run the cases of inputs/, compare them with closed forms and published numbers, write a report."
EPILOG = """\
units: SI; each claim states its own.

example: what takes seconds; all of it; one case:
  tools/slope verify --quick
  tools/slope verify -o verification
  tools/slope verify --only 11_column_collapse --jobs 1

Writes DIR/verification.csv, .yaml, .rst and .html, and DIR/numbers/CASE.yaml, what the README of each case shows; every
run stays in DIR/runs, and is made anew only if its deck, its data or the program has changed. The exit status is 0 when
every claim holds and every control fails, as it must, else 2.
"""


@dataclass(frozen=True, kw_only=True)
class Request(Program):
    quick: bool = flag("only runs that take seconds")
    only: Optional[str] = option("these folders of inputs/, such as 01_restitution (default all)", metavar="CASE,...")
    jobs: Optional[int] = option("runs at a time (default: the cores of the machine)", metavar="J")
    crosscheck: Optional[Path] = option(
        "crosscheck.yaml of `slope crosscheck`: its comparisons with other codes go into the report", metavar="FILE")
    output: Optional[Path] = option(
        f"folder of the report and of the runs (default {NAME}); without any word the command says what it would do",
        "-o", metavar="DIR")


def run_verify(args: Request) -> None:
    """Do the command; raises SlopeError on bad input and when a claim does not hold. Prints the claims."""
    claims, others = choose_claims(args.quick, args.only)
    if bare(args):
        print(plan_verification(claims))
        return
    output = args.output or Path(NAME)
    if output.exists() and not output.is_dir():
        raise SlopeError("-o", "must be a folder", output)
    peers = compared(args.crosscheck) if args.crosscheck else None
    lmp = find_lmp(args.lmp)
    began = time.monotonic()
    try:
        output.mkdir(parents=True, exist_ok=True)
        with disk.alone_in(output), jobs.signals_interrupt():
            runner = Runner(output / "runs", lmp)
            runner.do(runs_of(claims) + [run for one in others for run in one.runs], args.jobs or jobs.cores())
            outcomes = [judge(claim, runner) for claim in claims]
            seen = [(one, value(one, one.runs, runner)) for one in others]
            words = ["tools/slope verify"] + ["--quick"] * args.quick + [f"--only {args.only}"] * bool(args.only)
            about = made(" ".join(words), lmp, runner, outcomes, time.monotonic() - began)
            write_verification(output, outcomes, about, peers, seen)
    except OSError as error:
        raise SlopeError(error.filename or output, f"cannot be used: {error.strerror}") from error
    for outcome in outcomes:
        print(line(outcome))
    wrong = [outcome for outcome in outcomes if not outcome.right]
    if wrong:
        raise SlopeError(output / f"{NAME}.html", f"{len(wrong)} of {len(outcomes)} claims do not hold or have a "
                         f"control that does not fail: {', '.join(outcome.claim.name for outcome in wrong[:5])}"
                         + (", ..." if len(wrong) > 5 else ""))
    print(f"all {len(outcomes)} claims hold, and all controls fail: {output / NAME}.html" if outcomes else
          f"no claims; {len(seen)} numbers: {output / NUMBERS}")


def runs_of(claims):
    """The runs that claims and their controls need."""
    return [one for claim in claims for one in (*claim.runs, *claim.control.runs)]


def plan_verification(claims) -> str:
    """What the command would do."""
    def many(some):
        return (f"{len(some)} claims on {len({claim.case for claim in some})} cases by {len(set(runs_of(some)))} runs")

    return (f"would check {many(claims)}, which takes about two hours on one core; nothing is run without a word:\n"
            f"  slope verify -o DIR        all of it\n"
            f"  slope verify --quick       {many([claim for claim in claims if claim.quick])}, two minutes\n"
            f"  slope verify --only CASE   of {', '.join(dict.fromkeys(claim.case for claim in claims))}")


def choose_claims(quick: bool, only: Optional[str]):
    """The claims that are asked for, and the other numbers of their cases."""
    claims, others = ([one for one in several if one.quick or not quick]
                      for several in (verification.all_claims(), verification.all_seen()))
    if only:
        known = [case.CASE for case in verification.cases()]
        for name in only.split(","):
            if name not in known:
                raise SlopeError("--only", f"must be of {', '.join(known)}", name)
        claims, others = ([one for one in several if one.case in only.split(",")] for several in (claims, others))
    if not claims and not others:
        raise SlopeError("--only", "has no claims that are quick", only)
    return claims, others
