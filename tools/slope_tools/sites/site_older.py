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
    path, most = folder / site_choices.NAME, widest()
    if "model" in choices.older:
        if choices.model.spacing > most and not spacing_given:
            raise SlopeError(f"{path}: model.spacing", f"must be <= {most:g}: the ground of an older version was a "
                             "plan grid, now it is scattered balls; give --spacing 0.9, the default, or keep the "
                             "folder as it is: its study still runs", f"{choices.model.spacing:g}")
        tell(f"{path}: {' and '.join(RETIRED)} of an older version no longer count: the ground is scattered balls as "
             "large as those of the soil")
    if "study" in choices.older:
        tell(f"{path}: {', '.join(OFFSETS)} of an older version no longer count: the balls begin in a disordered "
             "packing, not on a cubic lattice")
    return choices.of(site_choices.of_now(choices.entries())) if choices.older else choices
