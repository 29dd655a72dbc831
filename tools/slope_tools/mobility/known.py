"""Whether known events cover a mass, and how far they went: for those who have its ground and its body on a grid."""
from typing import NamedTuple, Optional

import numpy as np

from ..errors import SlopeError
from ..survey.rasters import Raster
from . import body, events, exceedance, relation
from .exceedance import Mobility


class Known(NamedTuple):
    """mobility: of a mass, None and why (a sentence without its full stop) where no set covers it."""
    mobility: Optional[Mobility]
    why: str


def of_mass(raster: Raster, before: np.ndarray, depth: np.ndarray, volume: float) -> Known:
    """A mass of a volume (m3) among the events of our own set.

    raster: the grid; before: the ground with the body, m; depth: of the body, m, 0 beside it.
    """
    known = events.read()
    low, high = relation.of_events(known).volumes
    volume /= 1e6
    if not low <= volume <= high:
        return Known(None, f"No set of known events covers a volume of {volume:.3g} million m3; ours are of {low:g} to "
                           f"{high:g}. How far it runs rests on the parameters alone")
    try:
        found = exceedance.of_body(body.of_arrays(raster._replace(z=before), depth, "the run"), known)
    except SlopeError as error:
        return Known(None, f"The runs cannot be compared with known events: {error}")
    if not found.in_range:
        return Known(None, "; ".join(f"{line[0].upper()}{line[1:]}" for line in found.outside)
                     + ". How far the mass runs rests on the parameters alone")
    return Known(found, "")
