"""slope verify: runs the cases, holds them against closed forms and published numbers, and writes the report on that.

Order of the work: collect the claims and their runs, run these (a run that several claims need once), evaluate, write.
"""
import argparse
import csv
import io
import os
import platform
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple, Union

import numpy as np
import yaml
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from . import jobs, last_words, runs, verification
from .errors import SlopeError
from .study import count, find_lmp
from .verification.claims import Result
from .verification.errata import errata

NAME = "verification"       # of the files
FINISHED = "finished"       # in the folder of a run that ended well: checksums of the program and of the run
COLUMNS = ("case", "claim", "name", "source", "unit", "expected", "tolerance", "got", "passed", "control",
           "control_got", "control_fails", "remark", "commands")

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


def add_parser(commands, **kwargs):
    """Add `verify` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "verify", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Run the cases of inputs/, hold them against closed forms and published numbers, write a report.",
        **kwargs)
    parser.add_argument("--quick", action="store_true", help="only what takes seconds")
    parser.add_argument("--only", metavar="CASE,...",
                        help="these folders of inputs/, such as 01_restitution (default all)")
    parser.add_argument("--jobs", type=count, metavar="J", help="runs at a time (default: the cores of the machine)")
    parser.add_argument("--lmp", metavar="FILE", help="the LAMMPS program (default: LMP of the environment, then "
                        "build/lmp beside tools/)")
    parser.add_argument("--crosscheck", metavar="FILE", type=Path,
                        help="crosscheck.yaml of `slope crosscheck`: its comparisons with other codes go into the "
                        "report")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path, default=Path(NAME),
                        help=f"folder of the report and of the runs (default {NAME})")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input and when a claim does not hold. Prints the claims."""
    claims = chosen(args)
    if args.output.exists() and not args.output.is_dir():
        raise SlopeError("-o", "must be a folder", args.output)
    peers = compared(args.crosscheck) if args.crosscheck else None
    lmp = find_lmp(args.lmp)
    began = time.monotonic()
    try:
        args.output.mkdir(parents=True, exist_ok=True)
        with jobs.alone_in(args.output), jobs.signals_interrupt():
            runner = Runner(args.output / "runs", lmp)
            wanted = [one for claim in claims for one in (*claim.runs, *claim.control.runs)]
            runner.do(wanted, args.jobs or jobs.cores())
            outcomes = [judge(claim, runner) for claim in claims]
            about = provenance(args, lmp, runner, outcomes, time.monotonic() - began)
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


def chosen(args):
    """The claims that are asked for."""
    claims = [claim for claim in verification.all_claims() if claim.quick or not args.quick]
    if args.only:
        known = [case.CASE for case in verification.cases()]
        for name in args.only.split(","):
            if name not in known:
                raise SlopeError("--only", f"must be of {', '.join(known)}", name)
        claims = [claim for claim in claims if claim.case in args.only.split(",")]
    if not claims:
        raise SlopeError("--only", "has no claims that are quick", args.only)
    return claims


# --- runs ---

class Runner:
    """Runs decks, each once, in a folder of its own. What an earlier runner finished there with the same program,
    deck and data is kept."""

    def __init__(self, folder, lmp):
        self.folder, self.lmp = Path(folder), lmp
        self.results = {}
        self.kept = 0
        self.program = jobs.sha256(lmp)

    def result(self, one):
        """The Result of a run; it is run now if it was not before."""
        if one not in self.results:
            self.do([one], 1)
        return self.results[one]

    def do(self, wanted, most):
        """Run what has not been run, some at a time. On an interruption, end the runs under way."""
        for one in dict.fromkeys(wanted):
            if one not in self.results and self.is_finished(one):
                self.results[one] = Result(self.folder / one.name)
                self.kept += 1
        waiting = [one for one in dict.fromkeys(wanted) if one not in self.results]
        active = {}
        with Bar(len(waiting)) as bar:
            try:
                while waiting or active:
                    while waiting and len(active) < most:
                        one = waiting.pop(0)
                        active[one] = self.start(one)
                        bar.say(one.name)
                    time.sleep(0.02)
                    for one, process in list(active.items()):
                        if process.poll() is not None:
                            del active[one]
                            self.results[one] = self.ended(one, process.returncode)
                            bar.step()
            finally:
                for process in active.values():
                    process.terminate()
                    process.wait()

    def start(self, one):
        folder = self.folder / one.name
        shutil.rmtree(folder, ignore_errors=True)
        one.write(folder)
        guard = ["setpriv", "--pdeathsig", "TERM"] if shutil.which("setpriv") else []   # does not outlive us
        with open(folder / jobs.SCREEN, "wb") as screen:
            return subprocess.Popen([*guard, str(self.lmp), "-in", one.source.name, "-log", runs.LOG, *one.options],
                                    cwd=folder, env={**os.environ, "OMP_NUM_THREADS": "1"}, stdin=subprocess.DEVNULL,
                                    stdout=screen, stderr=subprocess.STDOUT, start_new_session=True)

    def ended(self, one, status):
        folder = self.folder / one.name
        if status:
            words = last_words.reason(runs.Log(folder / runs.LOG).update(), last_words.Screen(folder / jobs.SCREEN))
            raise SlopeError(folder / runs.LOG, f"must end well: {words or 'no word'}", f"status {status}")
        (folder / FINISHED).write_text(self.identity(one))
        return Result(folder)

    def identity(self, one):
        return f"{self.program} {one.identity}\n"

    def is_finished(self, one):
        try:
            return (self.folder / one.name / FINISHED).read_text() == self.identity(one)
        except OSError:
            return False


class Bar:
    """How far the runs are: a bar on a terminal, else nothing for single runs and a line each for many."""

    def __init__(self, total):
        self.live = sys.stderr.isatty() and total > 1
        self.told = total > 1 and not self.live
        self.bar = Progress(TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
                            console=Console(stderr=True), transient=True)
        self.task = self.bar.add_task("", total=total)

    def __enter__(self):
        if self.live:
            self.bar.start()
        return self

    def __exit__(self, *_):
        if self.live:
            self.bar.stop()

    def say(self, what):
        self.bar.update(self.task, description=what)
        if self.told:
            print(f"slope verify: {what}", file=sys.stderr, flush=True)

    def step(self):
        self.bar.update(self.task, advance=1)


# --- judgement ---

class Outcome(NamedTuple):
    """What came of a claim."""
    claim: object
    got: Union[float, str]
    passed: bool
    control_got: Union[float, str]
    control_fails: bool

    @property
    def right(self):
        return self.passed and self.control_fails


def value(claim, wanted, runner):
    """What a claim's runs, or its control's, give."""
    got = claim.got(*(runner.result(one) for one in wanted))
    return got if isinstance(got, str) else float(got)


def judge(claim, runner):
    """Hold a claim against its bound, and its control too, which must fail; NaN shows nothing."""
    got, broken = value(claim, claim.runs, runner), value(claim, claim.control.runs, runner)
    return Outcome(claim, got, bool(claim.bound.holds(got)), broken, broken == broken and not claim.bound.holds(broken))


def text(got):
    """A number or a word, for people."""
    return got if isinstance(got, str) else f"{got:.5g}"


def line(outcome):
    claim = outcome.claim
    expected, tolerance = claim.bound.texts()
    verdict = "pass" if outcome.right else "FAIL"
    control = "" if outcome.control_fails else f"; its control does not fail: {text(outcome.control_got)}"
    return f"{verdict} {claim.case} {claim.name}: {text(outcome.got)}, expected {expected} ({tolerance}){control}"


# --- the report ---

def provenance(args, lmp, runner, outcomes, seconds):
    """Everything that the report says of how it was made."""
    log = runs.Log(next(iter(runner.results.values())).folder / runs.LOG).update()
    words = ["tools/slope verify"] + ["--quick"] * args.quick + [f"--only {args.only}"] * bool(args.only)
    machine = runs.machine()
    return {"date": runs.now(), "command": " ".join(words), "package": runs.package_version(), "lammps": log.lammps,
            "lmp_sha256": jobs.sha256(lmp), "python": platform.python_version(), "numpy": np.__version__,
            "processor": machine["processor"], "cores": machine["cores"], "system": platform.system(),
            "runs": len(runner.results), "kept": runner.kept, "seconds": round(seconds, 1), "claims": len(outcomes),
            "passed": sum(outcome.passed for outcome in outcomes),
            "controls_that_fail": sum(outcome.control_fails for outcome in outcomes)}


def row(outcome):
    claim = outcome.claim
    expected, tolerance = claim.bound.texts()
    return dict(zip(COLUMNS, (
        claim.case, claim.text, claim.name, claim.source, claim.unit, expected, tolerance, outcome.got, outcome.passed,
        claim.control.broken, outcome.control_got, outcome.control_fails, claim.remark,
        [one.command for one in claim.runs])))


def compared(path):
    """What `slope crosscheck` wrote, for the report."""
    what = "what `slope crosscheck` wrote"
    found = runs.load_yaml(path, what)
    try:
        about = found["crosscheck"]
        rows = [{**one, "value": text(one["value"]), "expected": text(one["expected"]),
                 "tolerance": "for information" if one["tolerance"] is None else text(one["tolerance"])}
                for one in found["checks"]]
        return {"rows": rows, "differs": found["differs"], "versions": about["versions"], "package": about["package"],
                "date": about["finished"], "compared": about["compared"], "failed": about["failed"]}
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise SlopeError(path, f"must be {what}", repr(error)) from error


def write(output, outcomes, about, peers=None):
    """The report in its four forms."""
    rows = [row(outcome) for outcome in outcomes]
    table = io.StringIO()
    out = csv.DictWriter(table, COLUMNS, lineterminator="\n")
    out.writeheader()
    out.writerows({**one, "commands": "; ".join(one["commands"])} for one in rows)

    def of_module(case):        # several modules may be about one folder
        names = {claim.name for claim in case.CLAIMS}
        return [one for one in rows if one["name"] in names]

    cases = [{"folder": case.CASE, "title": case.__doc__.splitlines()[0],
              "intro": " ".join(case.__doc__.split("\n", 1)[1].split()),
              "rows": [{**one, "got": text(one["got"]), "control_got": text(one["control_got"])}
                       for one in of_module(case)],
              "commands": list(dict.fromkeys(command for one in of_module(case) for command in one["commands"]))}
             for case in verification.cases()]
    content = {"about": about, "peers": peers, "cases": [case for case in cases if case["rows"]],
               "errata": [{**one._asdict(), "rows": [other for case in cases for other in case["rows"]
                                                     if other["name"] in one.claims]} for one in errata()]}
    whole = yaml.safe_dump({**about, "results": rows}, sort_keys=False)
    for name, data in ((".csv", table.getvalue()), (".yaml", whole),
                       (".rst", render("verify.rst.j2", content)), (".html", render("verify.html.j2", content))):
        runs.write(output / f"{NAME}{name}", data)


def render(template, content):
    """A page, from the template beside this file."""
    import jinja2
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent),
                                     autoescape=template.endswith(".html.j2"), trim_blocks=True, lstrip_blocks=True,
                                     undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    return environment.get_template(template).render(content)
