"""What a raster is; the progress of long work with it, and whether it fits in memory."""
import os
import sys
from typing import NamedTuple, Optional, Tuple

import numpy as np
from affine import Affine
from rasterio.crs import CRS
from rich.console import Console
from rich.progress import track

from .. import streams
from ..digits import rounded
from ..errors import SlopeError

if not hasattr(Affine, "__matmul__"):       # affine 2, of Debian 12 and 13; affine 3 finds fault with *
    Affine.__matmul__ = Affine.__mul__

UNITS = {"m": 1.0, "ft": 0.3048, "us-ft": 1200 / 3937}      # m, of heights
BYTES_PER_CELL = 40        # peak memory of `slope terrain` per cell, measured 22 to 33 for 16 million cells


class Raster(NamedTuple):
    """Heights on a grid; CRS coordinates are transform @ (column, row) + offset."""
    z: np.ndarray
    transform: Affine
    crs: Optional[CRS]
    offset: Tuple[float, float] = (0.0, 0.0)


def progress(steps, what, total=None):
    """Iterate over steps behind a progress bar on stderr, which shows only on a terminal."""
    if not streams.is_terminal(sys.stderr):
        return steps
    return track(steps, what, total, console=Console(stderr=True), transient=True)


def check_memory(rows, columns, where, remedy=""):
    """Raise SlopeError if rows x columns cells do not fit in this machine's memory."""
    need = rows * columns * BYTES_PER_CELL / 1e9
    have = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    if need > have:
        raise SlopeError(where, f"must fit in the {rounded(have, 3)} GB of memory of this machine{remedy}",
                         f"{columns} x {rows} cells, which need {rounded(need, 3)} GB")
