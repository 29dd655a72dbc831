"""A site's choices of an older version as those of this one, which is said."""
from pathlib import Path
from typing import Any, Callable

from ..errors import SlopeError
from . import site_choices
from .site_sections import OFFSETS, RETIRED, C, widest


def renewed(choices: C, folder: Path, spacing_given: bool, tell: Callable[[str], Any]) -> C:
    """The choices of a folder with the ground and the packing of this version.

    spacing_given: whether another spacing of the ground's balls replaces theirs. Raises SlopeError where theirs is too
    wide for scattered balls.
    """
    return with_packing(with_ground(choices, folder, spacing_given, tell), folder, tell)


def with_packing(choices: C, folder: Path, tell: Callable[[str], Any]) -> C:
    if not choices.older.get("study"):
        return choices
    tell(f"{folder / site_choices.NAME}: {', '.join(OFFSETS)} of an older version no longer count: the balls begin in "
         "a disordered packing, not on a cubic lattice")
    return choices.of(site_choices.without_lattice(choices.entries()))


def with_ground(choices: C, folder: Path, spacing_given: bool, tell: Callable[[str], Any]) -> C:
    if not choices.older.get("model"):
        return choices
    spacing, most = choices.model.spacing, widest()
    if spacing > most and not spacing_given:
        raise SlopeError(f"{folder / site_choices.NAME}: model.spacing", f"must be <= {most:g}: the ground of an older "
                         "version was a plan grid, now it is scattered balls; give --spacing 0.9, the default, or keep "
                         "the folder as it is: its study still runs", f"{spacing:g}")
    tell(f"{folder / site_choices.NAME}: {' and '.join(RETIRED)} of an older version no longer count: the ground is "
         "scattered balls as large as those of the soil")
    return choices.of(site_choices.without_old_ground(choices.entries()))
