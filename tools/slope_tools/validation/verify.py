"""Runs that check claims, and their report."""
import platform
import shutil
import sys
import time
from pathlib import Path
from typing import Any, Dict, NamedTuple, Union

import numpy as np
import yaml
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from .. import disk, findings, processes, provenance, schemas, streams
from ..case import last_words, logs
from ..errors import SlopeError
from ..runs import jobs
from ..schemas import ANY, OBJECT, list_of, mapping, number_keys
from . import verification
from .verification.claims import INPUTS, Result
from .verification.errata import errata

NAME = "verification"       # of the files
NUMBERS = "numbers"         # folder of them, and name of a case's file
FINISHED = "finished"       # in the folder of a run that ended well: checksums of the program and of the run
COLUMNS = ("case", "claim", "name", "source", "unit", "expected", "tolerance", "got", "passed", "control",
           "control_got", "control_fails", "remark", "commands")
TABLE = INPUTS / "20_embankment" / "reference.yaml"
# crosscheck.yaml
PEERS = mapping({
    "crosscheck": mapping({"versions": OBJECT, "package": ANY, "finished": ANY, **number_keys("compared", "failed")}),
    "checks": list_of(mapping(dict.fromkeys(("case", "quantity", "code", "against", "value", "expected", "tolerance",
                                             "passed"), ANY))), "differs": OBJECT})


# --- runs ---

class Runner:
    """Runs decks, each once, in a folder of its own. What an earlier runner finished there with the same program,
    deck and data is kept."""

    def __init__(self, folder, lmp):
        self.folder, self.lmp = Path(folder), lmp
        self.results = {}
        self.kept = 0
        self.program = disk.sha256(lmp)

    def result(self, run):
        """The Result of a run; it is run now if it was not before."""
        if run not in self.results:
            self.do([run], 1)
        return self.results[run]

    def do(self, wanted, most):
        """Run what has not been run, some at a time. On an interruption, end the runs under way."""
        for run in dict.fromkeys(wanted):
            if run not in self.results and self.is_finished(run):
                self.results[run] = Result(self.folder / run.name)
                self.kept += 1
        waiting = [run for run in dict.fromkeys(wanted) if run not in self.results]
        active: Dict[Any, Any] = {}
        with Bar(len(waiting)) as bar:
            try:
                while waiting or active:
                    while waiting and len(active) < most:
                        run = waiting.pop(0)
                        active[run] = self.start(run)
                        bar.say(run.name)
                    time.sleep(0.02)
                    for run, process in list(active.items()):
                        if process.poll() is not None:
                            del active[run]
                            self.results[run] = self.ended(run, process.returncode)
                            bar.step()
            finally:
                processes.stop(active.values())

    def start(self, run):
        folder = self.folder / run.name
        shutil.rmtree(folder, ignore_errors=True)
        run.write(folder)
        words = [str(self.lmp), "-in", run.source.name, "-log", logs.LOG, *run.options]
        with open(folder / jobs.SCREEN, "wb") as screen:
            return processes.start(words, folder, screen, alone=True)

    def ended(self, run, status):
        folder = self.folder / run.name
        if status:
            words = last_words.reason(logs.Log(folder / logs.LOG).update(), last_words.Screen(folder / jobs.SCREEN))
            raise SlopeError(folder / logs.LOG, f"must end without an error: {words or 'no message'}",
                             f"status {status}")
        (folder / FINISHED).write_text(self.identity(run))
        return Result(folder)

    def identity(self, run):
        return f"{self.program} {run.identity}\n"

    def is_finished(self, run):
        try:
            return (self.folder / run.name / FINISHED).read_text() == self.identity(run)
        except OSError:
            return False


class Bar:
    """How far the runs are: a bar on a terminal, else nothing for single runs and a line each for many."""

    def __init__(self, total):
        self.live = streams.is_terminal(sys.stderr) and total > 1
        self.as_lines = total > 1 and not self.live
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
        if self.as_lines and findings.as_json:
            findings.say_json("progress", share=self.bar.tasks[0].percentage / 100, text=what)
        elif self.as_lines:
            print(f"slope verify: {what}", file=sys.stderr, flush=True)

    def step(self):
        self.bar.update(self.task, advance=1)


# --- judgement ---

class Outcome(NamedTuple):
    """The result of a claim and of its control."""
    claim: object
    got: Union[float, str]
    passed: bool
    control_got: Union[float, str]
    control_fails: bool
    package: str = ""       # that made it, and when
    date: str = ""

    @property
    def right(self):
        return self.passed and self.control_fails


def value(claim, wanted, runner):
    """What a claim's runs, or its control's, give."""
    got = claim.got(*(runner.result(run) for run in wanted))
    return got if isinstance(got, str) else float(got)


def judge(claim, runner):
    """Hold a claim against its bound, and its control too, which must fail; NaN shows nothing."""
    return judged(claim, value(claim, claim.runs, runner), value(claim, claim.control.runs, runner),
                  provenance.package_version() or "not a git checkout", provenance.now()[:10])


def judged(claim, got, broken, package="", date=""):
    """The Outcome of numbers that are there."""
    return Outcome(claim, got, bool(claim.bound.holds(got)), broken,
                   broken == broken and not claim.bound.holds(broken), package, date)


def format_claim_value(got):
    """A number or a word, for people."""
    return got if isinstance(got, str) else f"{got:.5g}"


def line(outcome):
    claim = outcome.claim
    expected, tolerance = claim.bound.texts()
    verdict = "pass" if outcome.right else "FAIL"
    control = "" if outcome.control_fails else f"; its control does not fail: {format_claim_value(outcome.control_got)}"
    return (f"{verdict} {claim.case} {claim.name}: {format_claim_value(outcome.got)}, expected {expected} "
            f"({tolerance}){control}")


# --- the report ---

def made(words: str, lmp, runner, outcomes, seconds) -> Dict[str, Any]:
    """How the report was made: versions, machine, counts."""
    log = logs.Log(next(iter(runner.results.values())).folder / logs.LOG).update()
    machine = provenance.machine()
    return {"date": provenance.now(), "command": words, "package": provenance.package_version(),
            "lammps": log.lammps, "lmp_sha256": disk.sha256(lmp),
            "python": platform.python_version(), "numpy": np.__version__,
            "processor": machine["processor"], "cores": machine["cores"], "system": platform.system(),
            "runs": len(runner.results), "kept": runner.kept, "seconds": round(seconds, 1), **counted(outcomes)}


def counted(outcomes) -> Dict[str, int]:
    """How many claims hold, and how many controls fail."""
    return {"claims": len(outcomes), "passed": sum(outcome.passed for outcome in outcomes),
            "controls_that_fail": sum(outcome.control_fails for outcome in outcomes)}


def row(outcome):
    claim = outcome.claim
    expected, tolerance = claim.bound.texts()
    return dict(zip(COLUMNS, (
        claim.case, claim.text, claim.name, claim.source, claim.unit, expected, tolerance, outcome.got, outcome.passed,
        claim.control.broken, outcome.control_got, outcome.control_fails, claim.remark,
        [run.command for run in claim.runs])))


def compared(path):
    """What `slope crosscheck` wrote, for the report."""
    found = schemas.load_checked(path, "what `slope crosscheck` wrote", PEERS)
    about = found["crosscheck"]
    rows = [{**check, "value": format_claim_value(check["value"]), "expected": format_claim_value(check["expected"]),
             "tolerance": "for information" if check["tolerance"] is None else format_claim_value(check["tolerance"])}
            for check in found["checks"]]
    return {"rows": rows, "differs": found["differs"], "date": about["finished"],
            **{key: about[key] for key in ("versions", "package", "compared", "failed")}}


def second_table() -> Dict[str, Any]:
    """The paper's second Table 5 beside what inputs/20 gives, of its file of reference values: heads and rows."""
    about = yaml.safe_load(TABLE.read_text(encoding="utf-8"))
    one = about["quantities"]["remove_m3"]
    heads = sorted({x for series in one["series"].values() for x in series})
    rows = [[name, *(f"{series[x]:,.0f}" for x in heads)] for name, series in one["series"].items()]
    rows += [[name, f"{value:,.0f}", *[""] * (len(heads) - 1)] for name, value in one["levels"].items()]
    return {"heads": ["", *(f"{x:.2f}" for x in heads)], "rows": rows, "remark": " ".join(about["remark"].split())}


def write_verification(output, outcomes, environment, peers=None, seen=()):
    """The report in its four forms, and the numbers of each case.

    seen: (Seen, number or word).
    """
    rows = [row(outcome) for outcome in outcomes]
    table = disk.csv_text(COLUMNS, ({**entry, "commands": "; ".join(entry["commands"])}.values() for entry in rows))
    content = make_verification_content(outcomes, peers)
    whole = yaml.safe_dump({**environment, "results": rows}, sort_keys=False)
    (output / NUMBERS).mkdir(exist_ok=True)
    for case, kept in kept_numbers(outcomes, seen).items():
        disk.write_file(output / NUMBERS / f"{case}.yaml", yaml.safe_dump(kept, sort_keys=False))
    for name, data in ((".csv", table), (".yaml", whole), (".rst", render("verify.rst.j2", content)),
                       (".html", render("verify.html.j2", {**content, "about": environment}))):
        disk.write_file(output / f"{NAME}{name}", data)


def kept_numbers(outcomes, seen) -> Dict[str, Dict[str, Any]]:
    """{case: what inputs/CASE/numbers.yaml holds}: what its claims, and other numbers of its README, gave."""
    numbers: Dict[str, Dict[str, Any]] = {}
    for one in outcomes:
        numbers.setdefault(one.claim.case, {"claims": {}, "seen": {}})["claims"][one.claim.name] = {
            "got": digits_of(one.got), "control": digits_of(one.control_got), "package": one.package, "date": one.date}
    for one, got in seen:
        numbers.setdefault(one.case, {"claims": {}, "seen": {}})["seen"][one.name] = digits_of(got)
    return numbers


def digits_of(got):
    """As it is kept."""
    return got if isinstance(got, str) else float(f"{got:.8g}")


def kept_outcomes(inputs=INPUTS):
    """The Outcomes of all claims whose numbers are kept in inputs/."""
    outcomes = []
    for claim in verification.all_claims():
        path = Path(inputs) / claim.case / f"{NUMBERS}.yaml"
        one = yaml.safe_load(path.read_text(encoding="utf-8"))["claims"].get(claim.name) if path.is_file() else None
        if one:
            outcomes.append(judged(claim, one["got"], one["control"], one["package"], one["date"]))
    return outcomes


def make_verification_content(outcomes, peers=None) -> Dict[str, Any]:
    """What the page shows of outcomes."""
    rows = [{**row(one), "package": one.package, "date": one.date} for one in outcomes]

    def of_module(case):        # several modules may be about one folder
        names = {claim.name for claim in case.CLAIMS}
        return [entry for entry in rows if entry["name"] in names]

    cases = [{"folder": case.CASE, "title": case.__doc__.splitlines()[0],
              "intro": " ".join(case.__doc__.split("\n", 1)[1].split()),
              "made": ", ".join(dict.fromkeys(f"{entry['package']} of {entry['date']}" for entry in of_module(case))),
              "rows": [{**entry, "got": format_claim_value(entry["got"]),
                        "control_got": format_claim_value(entry["control_got"])}
                       for entry in of_module(case)],
              "commands": list(dict.fromkeys(command for entry in of_module(case) for command in entry["commands"]))}
             for case in verification.cases()]
    return {"about": counted(outcomes), "peers": peers, "table": second_table(),
            "cases": [case for case in cases if case["rows"]],
            "errata": [{**erratum._asdict(), "rows": [entry for case in cases for entry in case["rows"]
                                                      if entry["name"] in erratum.claims]}
                       for erratum in errata()]}


def page(outcomes) -> str:
    """doc/src/verification.rst of outcomes."""
    return render("verify.rst.j2", make_verification_content(outcomes))


def render(template, content):
    """A page, from the template beside this file."""
    import jinja2
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent),
                                     autoescape=template.endswith(".html.j2"), trim_blocks=True, lstrip_blocks=True,
                                     undefined=jinja2.StrictUndefined, keep_trailing_newline=True)
    environment.filters["as_csv"] = as_csv
    return environment.get_template(template).render(content)


def as_csv(values):
    """A line of a table, every value in quotes."""
    return ",".join('"' + str(one).replace('"', '""') + '"' for one in values)
