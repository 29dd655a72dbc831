"""slope verify: runs the cases, holds them against closed forms and published numbers, and writes the report on that.

Order of the work: collect the claims and their runs, run these (a run that several claims need once), evaluate, write.
"""
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from .. import disk
from ..errors import SlopeError
from ..options import Program, flag, option
from ..programs import find_lmp
from ..runs import jobs
from ..validation import verification
from ..validation.verify import NAME, Runner, compared, judge, line, made, write

DESCRIPTION = "Run the cases of inputs/, compare them with closed forms and published numbers, write a report."
EPILOG = """\
units: SI; each claim states its own.

example: what takes seconds; all of it; one case:
  tools/slope verify --quick
  tools/slope verify -o verification
  tools/slope verify --only 11_column_collapse --jobs 1

Writes DIR/verification.csv, .yaml, .rst and .html; every run stays in DIR/runs, and is made anew only if its deck, its
data or the program has changed. The exit status is 0 when every claim
holds and every control fails, as it must, else 2.
"""


@dataclass(frozen=True, kw_only=True)
class Request(Program):
    quick: bool = flag("only runs that take seconds")
    only: Optional[str] = option("these folders of inputs/, such as 01_restitution (default all)", metavar="CASE,...")
    jobs: Optional[int] = option("runs at a time (default: the cores of the machine)", metavar="J")
    crosscheck: Optional[Path] = option(
        "crosscheck.yaml of `slope crosscheck`: its comparisons with other codes go into the report", metavar="FILE")
    output: Path = option(
        f"folder of the report and of the runs (default {NAME})", "-o", metavar="DIR", default=Path(NAME))


def run(args: Request) -> None:
    """Do the command; raises SlopeError on bad input and when a claim does not hold. Prints the claims."""
    claims = chosen(args.quick, args.only)
    if args.output.exists() and not args.output.is_dir():
        raise SlopeError("-o", "must be a folder", args.output)
    peers = compared(args.crosscheck) if args.crosscheck else None
    lmp = find_lmp(args.lmp)
    began = time.monotonic()
    try:
        args.output.mkdir(parents=True, exist_ok=True)
        with disk.alone_in(args.output), jobs.signals_interrupt():
            runner = Runner(args.output / "runs", lmp)
            wanted = [one for claim in claims for one in (*claim.runs, *claim.control.runs)]
            runner.do(wanted, args.jobs or jobs.cores())
            outcomes = [judge(claim, runner) for claim in claims]
            words = ["tools/slope verify"] + ["--quick"] * args.quick + [f"--only {args.only}"] * bool(args.only)
            about = made(" ".join(words), lmp, runner, outcomes, time.monotonic() - began)
            write(args.output, outcomes, about, peers)
    except OSError as error:
        raise SlopeError(error.filename or args.output, f"cannot be used: {error.strerror}") from error
    for outcome in outcomes:
        print(line(outcome))
    wrong = [outcome for outcome in outcomes if not outcome.right]
    if wrong:
        raise SlopeError(args.output / f"{NAME}.html", f"{len(wrong)} of {len(outcomes)} claims do not hold or have a "
                         f"control that does not fail: {', '.join(outcome.claim.name for outcome in wrong[:5])}"
                         + (", ..." if len(wrong) > 5 else ""))
    print(f"all {len(outcomes)} claims hold, and all controls fail: {args.output / NAME}.html")


def chosen(quick: bool, only: Optional[str]):
    """The claims that are asked for."""
    claims = [claim for claim in verification.all_claims() if claim.quick or not quick]
    if only:
        known = [case.CASE for case in verification.cases()]
        for name in only.split(","):
            if name not in known:
                raise SlopeError("--only", f"must be of {', '.join(known)}", name)
        claims = [claim for claim in claims if claim.case in only.split(",")]
    if not claims:
        raise SlopeError("--only", "has no claims that are quick", only)
    return claims
