"""How thick the body of a run is on average: the one measure by which balls over the thickness are counted."""
import math
from typing import Optional, Sequence

import numpy as np

from ..case import run_folders
from ..case.settings import normalise_value
from ..sites import site_choices, site_deck
from ..sites.site_bodies import VARIABLE
from ..tables.rows import Finished
from ..tables.sizes import VARIABLE as DIAMETER
from .setup import Setup


def mean(setup: Setup, row: Finished) -> Optional[float]:
    """Mean thickness (m) of the body of a run, its volume over its area in plan; None where no raster shows it.

    That of a site as `slope site` found it, of another deck what the rasters of the run show; of several runs the one
    with the smallest balls shows it best.
    """
    site = setup.site or setup.deck.parent
    if setup.deck.name == site_deck.NAME and (site / site_choices.NAME).is_file():
        found = site_choices.found(site)
        mine = found.bodies.get(str(row.variables.get(VARIABLE)))
        known = mine and mine.mean_depth_m if found.bodies else found.body and found.body.mean_depth
        if known:       # sites of older versions have none of several bodies
            return float(known)
    return by_rasters(setup, row)


def in_balls(setup: Setup, finished: Sequence[Finished]) -> Optional[float]:
    """Balls over it, the fewest of some runs; None where no variable of the deck is their diameter."""
    sizes = [normalise_value(row.variables.get(DIAMETER, "")) for row in finished]
    if not finished or not all(isinstance(d, float) and d > 0 for d in sizes):
        return None
    depth = mean(setup, finished[sizes.index(min(sizes))])
    return depth and depth / max(sizes)


def by_rasters(setup: Setup, row: Finished) -> Optional[float]:
    """Of the cells that balls begin in, whose middles lie half a ball within the rim."""
    from scipy.ndimage import binary_dilation
    arrival = run_folders.load_raster(run_folders.prefix_of(run_folders.summary_of(setup.output, row.summary)),
                                      "arrival")
    body = body_of(arrival.z == 0, arrival, row.ball_m3)
    rim = round(row.ball_m3 ** (1 / 3) / arrival.transform.a / 2)
    cells = (binary_dilation(np.pad(body, rim), iterations=rim) if rim else body).sum()
    return row.released_m3 / (float(cells) * arrival.transform.a ** 2) if cells else None


def body_of(released, raster, ball_m3):
    """Mask of the cells of the body: those that middles of its balls are in (released), and what lies between them.

    raster: whose cells they are; ball_m3: of ground, for which each ball stands.
    """
    from scipy.ndimage import binary_closing
    near = math.ceil(ball_m3 ** (1 / 3) / raster.transform.a)
    rows, columns = released.shape
    return binary_closing(np.pad(released, near), iterations=near)[near:near + rows, near:near + columns]
