"""Scenarios of a site: whole sites in its folder with another release, another ground, or other things on it.

A scenario has the balls, cells, time limit and packings of its site, and is at least as stiff, so that its numbers are
of the same model; its runs are its own. Once made it is a site like any other.
"""
import re
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import Iterator, List, Optional

from ..case import decks
from ..errors import SlopeError
from . import site_choices, site_deck, site_folder
from .site_choices import Site
from .site_sections import Balls, OfMass

FOLDER = "scenarios"        # in that of the site
NAMES = re.compile(r"\w[\w.-]*")


def choose_scenario_folder(site: Path, name: str) -> Path:
    """The folder of a new scenario; SlopeError if the name is none, or is there, or the site is a scenario itself."""
    if not NAMES.fullmatch(name):
        raise SlopeError("--scenario", "must be a folder's name: letters, digits, _ - and ., of which the first is a "
                         "letter, a digit or _", repr(name))
    if of := site_of(site):
        raise SlopeError("--scenario", f"must be given with the site itself, {of}, of which this is a scenario", site)
    folder = site / FOLDER / name
    if not (site_folder.is_free(folder) if folder.is_dir() else not folder.exists()):
        raise SlopeError("--scenario", f"must be a new name; `slope site {quote(str(folder))}` changes the scenario "
                         "that is there", name)
    return folder


def site_of(folder: Path) -> Optional[Path]:
    """The site of which a folder is a scenario, by its place; None of others."""
    above = folder.resolve().parents
    return above[1] if above[0].name == FOLDER and (above[1] / site_choices.NAME).is_file() else None


def list_scenarios(site: Path) -> List[Path]:
    """The folders of its scenarios, those too that could not be made."""
    return sorted(path.parent for path in (site / FOLDER).glob(f"*/{site_choices.NAME}"))


@contextmanager
def room(folder: Path) -> Iterator[None]:
    """While a scenario is made: the folder of all of them, which goes if nothing came into it."""
    folder.parent.mkdir(exist_ok=True)
    try:
        yield
    finally:
        with suppress(OSError):     # there are others
            folder.parent.rmdir()


def choices(site: Site, name: str) -> OfMass:
    """Those of a scenario of a site, before what differs in it; SlopeError if the site is not there as a whole."""
    deck = site.folder / site_deck.NAME
    if not deck.is_file():
        raise SlopeError("--scenario", "must be of a site that is made: "
                         f"`slope site {quote(str(site.folder))}` makes it", site.folder)
    found = site.choices
    own = {name: value for name, value in site.found.derived.items() if name == "motion.peak_friction"}
    name = f"{found.project.name or site.folder.absolute().name}, {name}"
    return site_choices.forgotten(replace(
        found, project=replace(found.project, name=name), balls=Balls(found.balls.diameter, None, None, None),
        model=replace(found.model, least_speed=found.model.speed, speed=None,
                      least_thick=float(decks.index_variables(deck)["thick"]))), own)
