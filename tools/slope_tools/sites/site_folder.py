"""The files of a site's folder: which ones slope site makes, and how new ones take the place of old ones."""
from pathlib import Path
from typing import List, Optional, Set

from .. import disk
from ..errors import SlopeError
from ..releases import release_files
from ..survey import vectors
from ..survey.rasters import is_raster
from . import site_bodies, site_choices, site_deck, site_inputs, site_trial, site_warnings, site_zones
from .site_layers import OBSERVED
from .site_roads import ROAD, file_name, list_road_files, name_road
from .site_sections import Choices

MAP = "map.png"
TERRAIN = "terrain.asc"
BODY = "release"        # first part of the names of the body's files
BODY_DECK = f"{BODY}.deck.txt"      # is not kept: its lines are in the deck


def list_site_files(choices: Choices) -> Set[str]:
    """Names of the files that will be made, with a trial run."""
    names = {MAP, TERRAIN, Path(TERRAIN).with_suffix(".yaml").name, f"{BODY}.csv", site_deck.NAME, site_choices.NAME,
             site_warnings.NAME, site_trial.REACHED,
             *(path.name for path in release_files.paths(Path(BODY)))} - {BODY_DECK}
    names |= site_bodies.list_body_files(choices, BODY)
    for observed in choices.files("observed", "file"):
        names.add(OBSERVED + (".tif" if is_raster(observed) else ".csv"))
    if several := list_road_files(choices):
        taken_: Set[str] = set()
        names |= {ROAD, *(file_name(name_road(site_inputs.stem(file), taken_)) for file in several
                          if len(several) > 1)}
    if choices.files("motion", "file"):
        names.add(site_inputs.MOTION)
    if choices.ground.file:
        names.add(site_zones.ALL)
    taken = set(site_inputs.TAKEN)
    for section, key, suffix in (("structures", "files", ".stl"), ("structures", "walls", ".stl"),
                                 ("lines", "files", ".csv")):
        names |= {site_inputs.unused(site_inputs.stem(file), taken) + suffix
                  for file in choices.files(section, key)}
    return names


def was_not_made(folder: Path) -> bool:
    """Whether all that a folder has is the site.yaml of a site that could not be made."""
    names = [path.name for path in folder.iterdir()] if folder.is_dir() else []
    return names == [site_choices.NAME] and site_choices.found(folder).failed is not None


def is_free(folder: Path) -> bool:
    """Whether a folder holds nothing but such a site.yaml, or is not there."""
    return not folder.exists() or not any(folder.iterdir()) or was_not_made(folder)


def keep_choices(choices: Choices, folder: Path, error: SlopeError) -> None:
    """Write the choices of a site that could not be made into its folder, to be changed."""
    folder.mkdir(exist_ok=True)
    about = {"failed": str(error), "files": [site_choices.NAME]}
    disk.write_file(folder / site_choices.NAME, site_choices.make_site_file(choices, about, folder.absolute()))


def check_site_folder(choices: Choices, folder: Path, old: Set[str]) -> None:
    """Raise SlopeError if rebuilding a folder would replace a file of the user's; old: names that slope site made."""
    names = list_site_files(choices)
    for source in (Path(vectors.source(name).path) for name in site_choices.source_files(choices)):
        if source.name in names | old and source.parent.resolve() == folder.resolve():
            raise SlopeError(source, f"must not have the name of a file that slope site makes in {folder}: rename it, "
                             "or move it elsewhere")
    check_free(names, folder, old)


def check_free(names: Set[str], folder: Path, old: Set[str]) -> None:
    """Raise SlopeError if one of the names is that of a file which slope site did not make."""
    for path in (folder / name for name in sorted(names)):
        if path.is_dir() or (path.exists() and path.name not in old):
            raise SlopeError(path, "must not exist, slope site makes a file of that name: rename or move it")


def exchange(new: Path, folder: Path, old: Set[str]) -> None:
    """Move new files into a folder, instead of those with old names; all else there, such as studies, stays.

    The deck goes first and comes last: where this was killed, there is none, and slope site makes the folder anew.
    """
    disk.flush_all(new)
    if not folder.is_dir():
        new.rename(folder)
        disk.flush(folder.parent)
        return
    made = {path.name for path in new.iterdir()}
    check_free(made, folder, old)
    (folder / site_deck.NAME).unlink(missing_ok=True)
    disk.flush(folder)
    order: List[str] = [site_choices.NAME, *sorted(made - {site_choices.NAME, site_deck.NAME}), site_deck.NAME]
    (new / order[0]).replace(folder / order[0])     # now it is known which files are slope site's
    for path in sorted(folder.iterdir()):
        if path.name in old - made and path.is_file():
            path.unlink()
    for name in order[1:-1]:
        (new / name).replace(folder / name)
    disk.flush(folder)
    (new / order[-1]).replace(folder / order[-1])
    disk.flush(folder)
    new.rmdir()


def only_one(site: Optional[Path]) -> Optional[Path]:
    """A site's folder, if all of its runs have one body; None for several, and for a folder that is no site's."""
    if site is None or not all((site / name).is_file() for name in (site_choices.NAME, f"{BODY}.depth.asc")):
        return None
    return None if site_choices.found(site).bodies else site
