"""The standard study of a site: sizes of balls, rolling resistances and repeats, and the mapped deposit.

Order of the work: the error of the size (size_study), the study with it (study, results), the score of the run that the
answer rests on. Every part is resumed by the same call.
"""
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, Optional

from .. import disk
from ..case import decks, site_choices, site_deck
from ..case.site_budget import three_digits
from ..case.site_choices import Choices
from ..case.site_layers import OBSERVED, ROAD
from ..errors import SlopeError
from . import repeats, results, size_study, study
from .sensitivity import NAMES, OF_ROAD, OF_TRAVEL
from .size_error import SizeErrors

SIZES, STUDY, SCORE = "sizes", "study", "score"         # folders in the site's
THRESHOLDS = [0.1, 0.5, 1.0]        # m, of the maps of exceedance


@dataclass
class Engine:
    """How runs are made; see `slope study --help`."""
    np: int = 1
    jobs: Optional[int] = None
    lmp: Optional[str] = None
    dry_run: bool = False
    launcher: Optional[str] = None
    engine: str = "local"
    slurm: str = ""


@dataclass
class Order(Engine):
    """What the parts of a study need to know beside that."""
    deck: Path = Path()
    output: Path = Path()
    road: Optional[Path] = None
    cut_angle: float = 30.0
    mesh: float = 10.0
    local: bool = False
    converge: Optional[str] = None
    vary: List[str] = field(default_factory=list)
    intensity: Optional[str] = None
    more_than: Optional[str] = None


def words(numbers) -> List[str]:
    """Numbers as values of a deck's variable."""
    return [f"{value:.10g}" for value in numbers]


def order(folder: Path, choices: Choices, engine: Engine, output: str) -> Order:
    """The Order for a part of the study, whose runs go to a folder in the site's."""
    road = folder / ROAD if choices["road"]["file"] else None
    return Order(**vars(engine), deck=folder / site_deck.NAME, output=folder / output, road=road,
                 cut_angle=choices["road"]["cut_angle"], mesh=choices["road"]["mesh"])


def is_site(folder: Path) -> bool:
    return (folder / site_choices.NAME).is_file()


def run(folder: Path, engine: Engine) -> Optional[Path]:
    """Make or go on with all runs of a site, and all that comes out of them; the study's folder, None of a dry run.

    Raises SlopeError on bad input, and after all other runs when one of the study failed.
    """
    choices = site_choices.read(folder)
    deck = folder / site_deck.NAME
    if not deck.is_file():
        raise SlopeError(deck, f"must be there; `slope site {folder}` makes it anew")
    several = choices["study"]
    repeated = {"xoffset": words(several["xoffset"])} if several["xoffset"] else {}
    errors = sizes(folder, choices, engine, repeated) if len(several["sizes"]) > 1 else None
    settings = {"rolling": words(several["rolling"])}
    one = order(folder, choices, engine, STUDY)
    todo = repeats.plan(one.output, settings, repeated, decks.index_variables(deck))
    study.check_names(todo)
    study.perform(one, {**settings, **repeated}, todo,
                  lambda todo, work: results.collect(one, settings, repeated, errors, todo, work, THRESHOLDS))
    if engine.dry_run:
        return None
    if choices["observed"]["file"]:
        scored(folder, one)
    return one.output


def sizes(folder: Path, choices: Choices, engine: Engine, repeated: Dict[str, List[str]]) -> Optional[SizeErrors]:
    """The runs with balls of several sizes, and the error that they find; None if they find none, which is said."""
    one = order(folder, choices, engine, SIZES)
    diameter = choices["balls"]["diameter"] or float(decks.index_variables(one.deck)["d"])
    factors, rolling = choices["study"]["sizes"], choices["study"]["rolling"]
    one.converge = "d=" + ",".join(words(diameter if factor == 1 else three_digits(factor * diameter)
                                         for factor in factors))
    of = (OF_ROAD if one.road else OF_TRAVEL).split(",")
    base = {"rolling": words(rolling)[len(rolling) // 2]}
    try:
        size_study.run(one, base, repeated, of, {name: NAMES[name] for name in of})
        if engine.dry_run or not one.road:
            return None
        errors = SizeErrors(one.output / "converge.yaml", "remove_m3")
        errors.check({}, decks.index_variables(one.deck))
        return errors
    except SlopeError as error:
        print(f"slope study: warning: the error of the size of the balls is not known: {error}", file=sys.stderr)
        return None


def scored(folder: Path, one: Order) -> None:
    """Hold the run that the answer rests on against the mapped deposit."""
    from ..deposit import score_run
    about = disk.load_yaml(one.output / "study.yaml", "what `slope study` wrote")
    best = about["conservative"] or about["largest"]["front_m"]
    row = next(row for row in about["runs"] if row["run"] == best["run"])
    prefix = str(one.output / row["summary"]).removesuffix(".summary.yaml")
    outline = folder / f"{OBSERVED}.csv"
    print(f"against the mapped deposit, {row['run']}:")
    print(score_run.make(prefix, outline if outline.is_file() else folder / f"{OBSERVED}.tif", folder / SCORE))
