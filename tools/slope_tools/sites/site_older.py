"""A site's choices of an older version as those of this one, which is said."""
from pathlib import Path
from typing import Any, Callable

from ..errors import SlopeError
from . import site_choices
from .site_choices import Choices


def renewed(choices: Choices, folder: Path, spacing_given: bool, tell: Callable[[str], Any]) -> Choices:
    """The choices of a folder with the ground and the packing of this version.

    spacing_given: whether another spacing of the ground's balls replaces theirs. Raises SlopeError where theirs is too
    wide for scattered balls.
    """
    return with_packing(with_ground(choices, folder, spacing_given, tell), folder, tell)


def with_packing(choices: Choices, folder: Path, tell: Callable[[str], Any]) -> Choices:
    if site_choices.has_lattice(choices):
        tell(f"{folder / site_choices.NAME}: {', '.join(site_choices.OFFSETS)} of an older version no longer count: "
             "the balls begin in a disordered packing, not on a cubic lattice")
    return site_choices.without_lattice(choices)


def with_ground(choices: Choices, folder: Path, spacing_given: bool, tell: Callable[[str], Any]) -> Choices:
    if not site_choices.has_old_ground(choices):
        return choices
    spacing, most = choices["model"]["spacing"], site_choices.widest()
    if spacing > most and not spacing_given:
        raise SlopeError(f"{folder / site_choices.NAME}: model.spacing", f"must be <= {most:g}: the ground of an older "
                         "version was a plan grid, now it is scattered balls; give --spacing 0.9, the default, or keep "
                         "the folder as it is: its study still runs", f"{spacing:g}")
    tell(f"{folder / site_choices.NAME}: {' and '.join(site_choices.RETIRED)} of an older version no longer count: "
         "the ground is scattered balls as large as those of the soil")
    return site_choices.without_old_ground(choices)
