"""The ground before a collapse, and the body that it left, on the grid of a deposit."""
from pathlib import Path
from typing import Optional, Tuple

import numpy as np

from ..survey import rasters
from ..survey.resampling import sample

SCAR = 0.01             # m; ground that lies so much lower than before is the slip surface


def before(raster: rasters.Raster, base: np.ndarray, terrain: Optional[Path]) -> Tuple[np.ndarray, np.ndarray]:
    """Height of the ground before (m), and depth of the body below it (m, 0 beside it).

    raster: the deposit's grid; base: the ground without the body; terrain: the file of the ground before, None where it
    is not in reach: the ground is then the base, and there is no body.
    """
    rows, columns = base.shape
    heights = np.full(base.shape, np.nan)
    if terrain:
        x, y = raster.transform @ np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
        heights = sample(rasters.read_asc_local(terrain), x, y)
    heights = np.where(np.isfinite(heights), heights, base)
    with np.errstate(invalid="ignore"):
        return heights, np.where(heights - base > SCAR, heights - base, 0)
