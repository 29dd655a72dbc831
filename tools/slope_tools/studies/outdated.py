"""Whether a study is of its site as it is now: a page or a file of the site shows no numbers of another body."""
from pathlib import Path
from shlex import quote
from typing import Optional

from .. import disk
from ..case import run_folders
from ..case.data_files import data_files
from ..errors import SlopeError
from ..runs import dependencies, jobs
from ..sites import site_deck, site_roads
from ..tables import named_run


def changed(site: Path, study: Path) -> Optional[str]:
    """The file of a site's folder that is another one than when the governing run of a study was made; else None.

    None, too, where nobody knows: without a deck, and of runs of an older version, which do not say what they read.
    """
    deck, folder = site / site_deck.NAME, run_folders.governing_run(study / named_run.STUDY, named_run.farthest)[1]
    about = run_folders.begun(folder)
    if not deck.is_file() or not about.get("inputs"):
        return None
    run = jobs.Run(folder.parent, dict(about.get("set") or {}))
    run.move(folder)
    files = data_files(deck, {name: [value] for name, value in run.chosen.items()})
    return dependencies.Dependencies(deck, {name: disk.sha256(path) for name, path in files.items()}).changed(run)


def check(folder: Path, study: Optional[Path]) -> None:
    """Raise SlopeError if a folder is that of a site or a road, and its study is of other data or of another deck."""
    site = None if study is None or study == folder else site_roads.home(study)
    if site is None or study is None:
        return
    if what := changed(site, study):
        raise SlopeError(folder, f"must be as it was studied: its governing run had another {what}; `slope study "
                         f"{quote(str(site))}` makes the study of now, {study} is the folder of the one before")
