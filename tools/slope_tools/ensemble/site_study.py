"""The standard study of a site: sizes of balls, rolling resistances and repeats, and the mapped deposit.

Order of the work: the error of the size (size_study), the study with it (study, results), the score of the run that the
answer rests on. Every part is resumed by the same call.
"""
import sys
from pathlib import Path
from typing import Dict, Iterable, List, NamedTuple, Optional

from .. import disk
from ..case import decks, site_choices, site_deck
from ..case.site_budget import three_digits
from ..case.site_choices import Choices
from ..case.site_layers import OBSERVED, ROAD
from ..errors import SlopeError
from . import repeats, results, size_study, study
from .quantities import NAMES
from .sensitivity import quantities
from .setup import Road, Setup
from .size_error import SizeErrors

SIZES, STUDY, SCORE = "sizes", "study", "score"         # folders in the site's
THRESHOLDS = (0.1, 0.5, 1.0)        # m, of the maps of exceedance


def words(numbers: Iterable[float]) -> List[str]:
    """Numbers as values of a deck's variable."""
    return [f"{value:.10g}" for value in numbers]


class Done(NamedTuple):
    """What was made."""
    study: Optional[Path]                   # its folder, None of a dry run
    failed: Optional[study.RunsFailed]      # that runs failed, to be raised once the report is there


def run(folder: Path, engine: Setup) -> Done:
    """Make or go on with all runs of a site, and all that comes out of them.

    engine: how the runs are made; its deck, output and road do not count. Raises SlopeError on bad input, and if no run
    of the study finished.
    """
    choices = site_choices.read(folder)
    deck = folder / site_deck.NAME
    if not deck.is_file():
        raise SlopeError(deck, f"must be there; `slope site {folder}` makes it anew")
    road = choices["road"]
    setup = engine._replace(deck=deck, output=folder / STUDY, road=None)
    if road["file"]:
        setup = setup._replace(road=Road(folder / ROAD, road["cut_angle"], road["mesh"]))
    several = choices["study"]
    repeated = {"xoffset": words(several["xoffset"])} if several["xoffset"] else {}
    errors = sizes(setup._replace(output=folder / SIZES), choices, repeated) if len(several["sizes"]) > 1 else None
    settings = {"rolling": words(several["rolling"])}
    todo = repeats.plan(setup.output, settings, repeated, decks.index_variables(deck))
    study.check_names(todo)
    questions = results.Questions(settings, repeated, THRESHOLDS, errors)
    failed = None
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
        scored(folder, setup)
    return Done(setup.output, failed)


def sizes(setup: Setup, choices: Choices, repeated: Dict[str, List[str]]) -> Optional[SizeErrors]:
    """The runs with balls of several sizes, and the error that they find; None if they find none, which is said."""
    variables = decks.index_variables(setup.deck)
    diameter = float(variables["d"])
    values = words(diameter if factor == 1 else three_digits(factor * diameter) for factor in choices["study"]["sizes"])
    rolling = words(choices["study"]["rolling"])
    of = quantities(None, setup.road is not None, True)
    try:
        size_study.run(setup, "d=" + ",".join(values), {"rolling": rolling[len(rolling) // 2]}, repeated, of,
                       {name: NAMES[name] for name in of})
        if setup.dry_run or not setup.road:
            return None
        errors = SizeErrors(setup.output / "converge.yaml", "remove_m3")
        errors.check({}, variables)
        return errors
    except SlopeError as error:
        print(f"slope study: warning: the error of the size of the balls is not known: {error}", file=sys.stderr)
        return None


def scored(folder: Path, setup: Setup) -> None:
    """Hold the run that the answer rests on against the mapped deposit."""
    from ..deposit import score_run
    about = disk.load_yaml(setup.output / "study.yaml", "what `slope study` wrote")
    best = about["conservative"] or about["largest"]["front_m"]
    row = next(row for row in about["runs"] if row["run"] == best["run"])
    outline = folder / f"{OBSERVED}.csv"
    print(f"{row['run']} against the mapped deposit:")
    print(score_run.make(str(setup.output / row["summary"]).removesuffix(".summary.yaml"),
                         outline if outline.is_file() else folder / f"{OBSERVED}.tif", folder / SCORE))
