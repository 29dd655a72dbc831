"""The standard study of a site: sizes of balls, half the step, rolling resistances, repeats, the mapped deposit.

Order of the work: the error of the size (size_study), a run with half the step, the study with both (study, results),
the score of the run that the answer rests on. Every part is resumed by the same call.
"""
import shutil
from pathlib import Path
from shlex import quote
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Sequence

from .. import disk, schemas
from ..case import decks, run_folders
from ..errors import SlopeError
from ..runs import repeats
from ..schemas import OBJECT, TEXT, listed, mapping
from ..sites import ground, site_choices, site_deck, site_warnings
from ..sites.site_budget import three_digits
from ..sites.site_choices import Choices, OFFSETS, other_grounds
from ..sites.site_layers import OBSERVED, ROAD
from ..survey.roads import Asked
from ..tables import energy
from ..tables.quantities import NAMES
from ..tables.size_error import SizeErrors, WHAT
from ..tables.step_check import HALF, QUANTITY, Step
from ..tables.study_file import read_study
from ..warned import Warned, warned
from . import results, size_study, study
from .sensitivity import quantities
from .setup import Road, Setup

# folders in the site's
SIZES, STEP, STUDY, SCORE, ENSEMBLE = "sizes", "step", "study", "score", "ensemble"
SAID = listed({"anyOf": [OBJECT, TEXT], "description": "warnings"}, null=True)     # of older versions, too
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
    with disk.alone_in(folder):
        return run_alone(folder, choices, engine, method)


def check(folder: Path, choices: Choices) -> None:
    """Raise SlopeError unless all files of a site exist and match its choices."""
    found = site_choices.found(folder)
    for name in (site_deck.NAME, *(found.get("files") or ())):
        if not (folder / name).is_file():
            raise SlopeError(folder / name, f"must exist; `slope site {quote(str(folder))}` rebuilds it")
    if found.get("choices_sha256", "") not in ("", site_choices.fingerprint(choices, folder)):
        raise SlopeError(folder / site_choices.NAME, f"must not have been changed since {site_deck.NAME} was made from "
                         f"it: `slope site {quote(str(folder))}` rebuilds the deck (project, road and study may "
                         "change)")
    before = found.get("sources_sha256") or {}
    for name, digest in site_choices.sources(choices, folder).items():      # a folder may have gone without its sources
        if before.get(name, digest) != digest:
            raise SlopeError(folder / name, f"must not have changed since {site_deck.NAME} was made from it: "
                             f"`slope site {quote(str(folder))}` rebuilds the deck")


def run_alone(folder: Path, choices: Choices, engine: Setup, method: str) -> Done:
    """run() after its checks, with the folder locked."""
    deck = folder / site_deck.NAME
    road = choices["road"]
    setup = engine._replace(deck=deck, output=folder / STUDY, road=None)
    if road["file"]:
        setup = setup._replace(road=Road(folder / ROAD, road["cut_angle"], road["mesh"], asked=Asked.of(road)))
    several = choices["study"]
    repeated = {name: words(several[name]) for name in OFFSETS if several[name]}
    found = Sizes(None, (), None)
    if len(several["sizes"]) > 1:
        found = sizes(setup._replace(output=folder / SIZES), choices, repeated)
    settings, variables = {"rolling": words(several["rolling"])}, decks.index_variables(deck)
    step = half_step(setup._replace(output=folder / STEP), settings["rolling"]) if setup.road else None
    others = grounds(choices, variables)
    if others:
        settings["spacing"] = [variables["spacing"]]
    todo = repeats.plan(setup.output, settings, repeated, variables, others)
    study.check_names(todo)
    if others:
        settings["spacing"] = list(dict.fromkeys([*settings["spacing"], *(one["spacing"] for one in others)]))
    questions = results.Questions(settings, repeated, THRESHOLDS, found.errors, size_error_unusable=found.unusable,
                                  notes=(*warnings_of(folder), *found.warnings), site=folder, sizes=found.path,
                                  step=step, method=method)
    failed: Optional[Exception] = None
    try:
        study.perform(setup, {**settings, **repeated}, todo,
                      lambda todo, work: results.collect(setup, questions, todo, work))
    except study.RunsFailed as error:
        if all(one.error for one in todo):
            raise
        failed = error
    if setup.dry_run:
        return Done(None, failed)
    if choices["observed"]["file"]:
        shutil.rmtree(folder / SCORE, ignore_errors=True)       # of other runs
        try:
            scored(folder, setup)
        except Exception as error:      # whatever it is, the runs took hours: their report comes first
            failed = failed or error
    return Done(setup.output, failed)


def warnings_of(folder: Path) -> List[Warned]:
    """The warnings of `slope site`, which the results repeat; none for a site of an older version."""
    path = folder / site_warnings.NAME
    said = schemas.load(path, "what `slope site` wrote", SAID) if path.is_file() else None
    return [warned(one) for one in said or ()]


def grounds(choices: Choices, variables: Dict[str, str]) -> List[Dict[str, str]]:
    """The runs on other grounds; none for a deck of an older version, whose ground is a plan grid."""
    return [{"rolling": rolling, "spacing": spacing} for spacing, rolling in map(words, other_grounds(choices))] \
        if ground.SEED in variables else []


class Sizes(NamedTuple):
    """What the runs with balls of several sizes found."""
    errors: Optional[SizeErrors]
    warnings: Sequence[Warned]      # of these runs
    unusable: Optional[str]         # why there are no errors although they were to be measured
    path: Optional[Path] = None     # converge.yaml, with the means of all sizes


def sizes(setup: Setup, choices: Choices, repeated: Dict[str, List[str]]) -> Sizes:
    """The runs with balls of several sizes, and the error that they find."""
    variables = decks.index_variables(setup.deck)
    diameter = float(variables["d"])
    values = words(diameter if factor == 1 else three_digits(factor * diameter) for factor in choices["study"]["sizes"])
    rolling = words(choices["study"]["rolling"])
    of = quantities(None, setup.road is not None, True)
    try:
        size_study.run(setup, "d=" + ",".join(values), {"rolling": rolling[len(rolling) // 2]}, repeated, of,
                       {name: NAMES[name] for name in of})
    except study.RunsFailed as error:
        setup.warn(warned(str(error))._replace(part="sizes of balls"))
    except SlopeError as error:
        return unusable(setup, str(error))
    path = setup.output / "converge.yaml"
    if setup.dry_run or not setup.road:
        return Sizes(None, (), None)
    if not path.is_file():
        return unusable(setup, "too few of its runs finished")
    said = [warned(one)._replace(part="sizes of balls")
            for one in schemas.load(path, WHAT, mapping({}, warnings=SAID)).get("warnings") or ()]
    try:
        errors = SizeErrors(path, "remove_m3")
        errors.check({}, variables)
    except SlopeError as error:
        why = "its runs do not tell what small balls give"
        return unusable(setup, str(error), why)._replace(warnings=said, path=path)
    return Sizes(errors, said, None, path)


def half_step(setup: Setup, rolling: List[str]) -> Optional[Step]:
    """One run with half the time step, at the rolling resistance in the middle; None of a dry run.

    It keeps account of its energy, too, unless the deck is of a version that cannot.
    """
    middle = rolling[len(rolling) // 2]
    settings = {"rolling": [middle], "step": [HALF]}
    variables = decks.index_variables(setup.deck)
    if "ledger" in variables:
        settings["ledger"] = ["1"]
    todo = repeats.plan(setup.output, settings, {}, variables)
    volumes: List[float] = []
    spent: List[Optional[Dict[str, Any]]] = []

    def collect(todo, _):
        rows, _ = results.rows_of(setup, todo, results.Maps(()), pictures=False)
        for row in rows:
            if row["status"] == "finished":
                volumes.append(row[QUANTITY])
                if "ledger" in settings:
                    prefix = str(setup.output / row["summary"]).removesuffix(".summary.yaml")
                    spent.append(energy.read(Path(f"{prefix}.{energy.SUFFIX}")))

    try:
        study.perform(setup, settings, todo, collect)
    except SlopeError as error:
        return Step(middle, None, str(error))
    return Step(middle, volumes[0], energy=spent[0] if spent else None,
                spacing=variables.get("spacing")) if volumes else None


def unusable(setup: Setup, why: str, shortly: str = "") -> Sizes:
    setup.warn(Warned("size error", {"why": why}))
    return Sizes(None, (), shortly or why)


def scored(folder: Path, setup: Setup) -> None:
    """Compare the governing run with the mapped deposit."""
    from ..deposits import score_run
    path = setup.output / "study.yaml"
    name = run_folders.governing_run(path)
    row = next(row for row in read_study(path)["runs"] if row["run"] == name)
    outline = folder / f"{OBSERVED}.csv"
    setup.tell(f"{row['run']} against the mapped deposit:")
    setup.tell(score_run.make(str(setup.output / row["summary"]).removesuffix(".summary.yaml"),
                              outline if outline.is_file() else folder / f"{OBSERVED}.tif", folder / SCORE))
