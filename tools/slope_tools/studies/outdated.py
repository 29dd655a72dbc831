"""Whether a study is of its site as it is now: a page or a file of the site shows no numbers of another body."""
import os
from pathlib import Path
from shlex import quote
from typing import Optional

from .. import disk
from ..case import run_folders
from ..case.data_files import data_files
from ..errors import SlopeError
from ..runs import dependencies, jobs
from ..sites import site_choices, site_deck, site_roads
from ..tables import named_run, study_file


def changed(site: Path, study: Path) -> Optional[str]:
    """The file of a site's folder that is another one than when the governing run of a study was made; else None.

    None, too, where nobody knows: without a deck, and of runs of an older version, which do not say what they read.
    """
    deck, folder = site / site_deck.NAME, named_run.governing_run(study)[1]
    about = run_folders.begun(folder)
    if not deck.is_file() or not about.get("inputs"):
        return None
    run = jobs.Run(folder.parent, dict(about.get("set") or {}))
    run.move(folder)
    files = data_files(deck, {name: [value] for name, value in run.chosen.items()})
    return dependencies.Dependencies(deck, {name: disk.sha256(path) for name, path in files.items()}).changed(run)


def road_changed(folder: Path, study: Path) -> Optional[str]:
    """That the road of a study, or how it is cleared, is another one than the site's; else None."""
    site, made = site_choices.load_site(folder), study_file.load_study(study / study_file.STUDY)
    road, had, above = site.choices.road, made.study.road, Path(os.path.abspath(study)).parent
    known = [str(number["road"]) for number in made.roads] if above.parent.name != site_roads.FOLDER else [above.name]
    several = site_roads.names(site)
    if not set(known) <= set(several) or above.parent.name != site_roads.FOLDER and set(known) != set(several):
        return "choice of roads"
    if bool(road.file) != bool(had):
        return "road"
    if not had:
        return None
    mine = folder / site_roads.file_name(had.get("name") or "")
    if not (mine.is_file() and mine.read_bytes() == (study / str(had["local"])).read_bytes()):
        return "road"
    now = {"cut_angle": road.cut_angle, "mesh": road.mesh, **road.asked.about()}
    return next((f"{key} of the road" for key, value in now.items() if had.get(key, value) != value), None)


def check_study_current(folder: Path, study: Optional[Path]) -> None:
    """Raise SlopeError if a folder is that of a site or a road, and its study is of other data or of another deck."""
    site = None if study is None or study == folder else site_roads.home(study)
    if site is None or study is None:
        return
    if what := changed(site, study) or road_changed(site, study):
        raise SlopeError(folder, f"must be as it was studied: its study had another {what}; `slope study "
                         f"{quote(str(site))}` makes the study of now, {study} is the folder of the one before")
