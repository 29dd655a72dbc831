"""The standard study of a site: sizes of balls, half the step, rolling resistances, repeats, the mapped deposit.

Order of the work: plan all runs, make them (study), the error of the size (size_study), what half the step changes, the
study with both (results), the score of the run that the answer rests on. The same call resumes it.
"""
import shutil
from pathlib import Path
from shlex import quote
from typing import Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from .. import schemas
from ..case import decks, run_folders
from ..errors import SlopeError
from ..findings import Finding, finding
from ..runs import repeats
from ..schemas import FINDINGS, mapping
from ..sites import ground, site_choices, site_deck, site_warnings
from ..sites.site_budget import three_digits
from ..sites.site_choices import Choices, OFFSETS, PACKING, other_grounds
from ..sites.site_layers import OBSERVED, ROAD
from ..survey.roads import Asked
from ..tables import energy
from ..tables.size_error import SizeErrors, WHAT
from ..tables.step_check import QUANTITY, Step, half_of
from ..tables.study_file import read_study
from . import mapped, results, size_study, study
from .sensitivity import quantities
from .setup import Road, Setup

# folders in the site's
SIZES, STUDY, SCORE, ENSEMBLE = "sizes", "study", "score", "ensemble"
LEDGER = "ledger"       # a deck's variable
THRESHOLDS = (0.1, 0.5, 1.0)        # m, of the maps of exceedance


def words(numbers: Iterable[float]) -> List[str]:
    """Numbers as values of a deck's variable."""
    return [f"{value:.10g}" for value in numbers]


class Done(NamedTuple):
    """What was made."""
    study: Optional[Path]                   # its folder, None of a dry run
    failed: Optional[Exception]             # what failed beside it, to be raised once the report is there


def run(folder: Path, engine: Setup, method: str) -> Done:
    """Make or continue all runs of a site, and their results.

    engine: how the runs are made; its deck, output and road do not count; method: of the study, in words. Raises
    SlopeError on bad input, and if no run of the study finished.
    """
    choices = site_choices.read(folder)
    check(folder, choices)
    deck, road, several = folder / site_deck.NAME, choices["road"], choices["study"]
    setup = engine._replace(deck=deck, output=folder / STUDY, site=folder, road=None)
    if road["file"]:
        setup = setup._replace(road=Road(folder / ROAD, road["cut_angle"], road["mesh"], asked=Asked.of(road)))
    settings, variables = {"rolling": words(several["rolling"])}, decks.index_variables(deck)
    repeated = {name: words(several[name]) for name in (PACKING, *OFFSETS) if name in variables and several.get(name)}
    middle = settings["rolling"][len(several["rolling"]) // 2]
    others = grounds(choices, variables)
    if others:
        settings["spacing"] = [variables["spacing"]]
    todo = repeats.plan(setup.runs, settings, repeated, variables, others)
    if others:
        settings["spacing"] = list(dict.fromkeys([*settings["spacing"], *(one["spacing"] for one in others)]))
    planned, why = size_runs(setup._replace(output=folder / SIZES), several["sizes"], middle, repeated, variables)
    half = half_steps(setup, middle, variables) if setup.road else []

    def collect(_, work):
        found = sizes(planned, variables, work) if planned else unusable(setup, why) if why else NOT_ASKED
        questions = results.Questions(settings, repeated, THRESHOLDS, found.errors, size_error_unusable=found.unusable,
                                      notes=(*warnings_of(folder), *found.warnings), site=folder, sizes=found.path,
                                      step=step_of(setup, half[0], middle, variables) if half else None, method=method)
        results.collect(setup, questions, todo, work)

    failed: Optional[Exception] = None
    of_sizes = planned.todo if planned else ()
    try:
        # the longest first: a long run that starts last leaves the other cores idle
        first = [*half, *sorted(of_sizes, key=lambda one: float(one.chosen["d"]))]
        study.perform(setup, {**settings, **repeated}, [*todo, *of_sizes, *half], collect, first=first)
    except study.RunsFailed:
        failed = study.failure(setup.output, todo)      # what is said of the others is with their results
        if failed and all(one.error for one in todo):
            raise failed from None
    if setup.dry_run:
        return Done(None, failed)
    if choices["observed"]["file"]:
        shutil.rmtree(folder / SCORE, ignore_errors=True)       # of other runs
        try:
            scored(folder, setup)
        except Exception as error:      # whatever it is, the runs took hours: their report comes first
            failed = failed or error
    return Done(setup.output, failed)


def check(folder: Path, choices: Choices) -> None:
    """Raise SlopeError unless all files of a site exist and match its choices."""
    found = site_choices.found(folder)
    for name in (site_deck.NAME, *(found.get("files") or ())):
        if not (folder / name).is_file():
            raise SlopeError(folder / name, f"must exist; `slope site {quote(str(folder))}` rebuilds it")
    if found.get("choices_sha256", "") not in ("", site_choices.fingerprint(choices, folder)):
        raise SlopeError(folder / site_choices.NAME, f"must not have been changed since {site_deck.NAME} was made from "
                         f"it: `slope site {quote(str(folder))}` rebuilds the deck (project, road, study and "
                         "known may change)")
    before = found.get("sources_sha256") or {}
    for name, digest in site_choices.sources(choices, folder).items():      # a folder may have gone without its sources
        if before.get(name, digest) != digest:
            raise SlopeError(folder / name, f"must not have changed since {site_deck.NAME} was made from it: "
                             f"`slope site {quote(str(folder))}` rebuilds the deck")
    mapped.check(folder)


def warnings_of(folder: Path) -> List[Finding]:
    """The warnings of `slope site`, which the results repeat; none for a site of an older version."""
    path = folder / site_warnings.NAME
    said = schemas.load(path, "what `slope site` wrote", FINDINGS) if path.is_file() else None
    return [finding(one) for one in said or ()]


def grounds(choices: Choices, variables: Dict[str, str]) -> List[Dict[str, str]]:
    """The runs on other grounds; none for a deck of an older version, whose ground is a plan grid."""
    return [{"rolling": rolling, "spacing": spacing} for spacing, rolling in map(words, other_grounds(choices))] \
        if ground.SEED in variables else []


class Sizes(NamedTuple):
    """What the runs with balls of several sizes found."""
    errors: Optional[SizeErrors]
    warnings: Sequence[Finding]      # of these runs
    unusable: Optional[str]         # why there are no errors although they were to be measured
    path: Optional[Path] = None     # converge.yaml, with the means of all sizes


NOT_ASKED = Sizes(None, (), None)


def size_runs(setup: Setup, factors: Sequence[float], rolling: str, repeated: Dict[str, List[str]],
              variables: Dict[str, str]) -> Tuple[Optional[size_study.Plan], str]:
    """The runs with balls of several sizes, or why there are none although they were asked for."""
    if len(factors) < 2:
        return None, ""
    diameter = float(variables["d"])
    values = words(diameter if factor == 1 else three_digits(factor * diameter) for factor in factors)
    try:
        return size_study.plan(setup, "d=" + ",".join(values), {"rolling": rolling}, repeated), ""
    except SlopeError as error:
        return None, str(error)


def sizes(planned: size_study.Plan, variables: Dict[str, str], work) -> Sizes:
    """The error that these runs find."""
    setup = planned.setup
    failed = study.failure(setup.output, planned.todo)
    if failed:
        setup.warn(finding(str(failed))._replace(part="sizes of balls"))
    try:
        size_study.collect(planned, quantities(None, setup.road is not None, True), work)
    except SlopeError as error:
        return unusable(setup, str(error))
    path = setup.output / "converge.yaml"
    if not setup.road:
        return NOT_ASKED
    if not path.is_file():
        return unusable(setup, "too few of its runs finished")
    said = [finding(one)._replace(part="sizes of balls")
            for one in schemas.load(path, WHAT, mapping({}, warnings=FINDINGS)).get("warnings") or ()]
    try:
        errors = SizeErrors(path, "remove_m3")
        errors.check({}, variables)
    except SlopeError as error:
        why = "its runs do not tell what small balls give"
        return unusable(setup, str(error), why)._replace(warnings=said, path=path)
    return Sizes(errors, said, None, path)


def half_steps(setup: Setup, rolling: str, variables: Dict[str, str]) -> List[repeats.Repeat]:
    """One run with half the time step, which keeps account of its energy, too, unless the deck is of a version that
    cannot."""
    settings = {"rolling": [rolling], "step": [half_of(variables)], **({LEDGER: ["1"]} if LEDGER in variables else {})}
    return repeats.plan(setup.runs, settings, {}, variables)


def step_of(setup: Setup, run_: repeats.Repeat, rolling: str, variables: Dict[str, str]) -> Step:
    """What that run tells."""
    [row], _ = results.rows_of(setup, [run_], results.Maps(()), pictures=False)
    if run_.error:
        return Step(rolling, None, f"{run_.name}: {run_.error}", step=float(run_.chosen["step"]))
    prefix = run_folders.prefix_of(run_folders.summary_of(setup.output, row))
    return Step(rolling, row[QUANTITY], energy=energy.read(Path(f"{prefix}.{energy.SUFFIX}"))
                if LEDGER in variables else None, spacing=variables.get("spacing"),
                step=float(run_.chosen["step"]))


def unusable(setup: Setup, why: str, shortly: str = "") -> Sizes:
    setup.warn(Finding("size error unknown", {"why": why}))
    return Sizes(None, (), shortly or why)


def scored(folder: Path, setup: Setup) -> None:
    """Compare the governing run with the mapped deposit."""
    from ..deposits import score_run
    path = setup.output / "study.yaml"
    read_study(path)        # SlopeError unless it is one
    name, place = run_folders.governing_run(path)
    [summary] = run_folders.summaries(place)
    outline = folder / f"{OBSERVED}.csv"
    setup.tell(f"{name} against the mapped deposit:")
    setup.tell(score_run.make(str(run_folders.prefix_of(summary)),
                              outline if outline.is_file() else folder / f"{OBSERVED}.tif", folder / SCORE))
