"""The connected deposit: the part of a thickness raster that hangs together, without stray balls and far patches.

How far a mass went is not how far its farthest ball rolled. Here it is how far the largest part of the deposit reaches
that is thicker than a threshold and whose cells touch each other, at sides or at corners.
"""
import math
from pathlib import Path
from typing import NamedTuple, Optional

import numpy as np
from scipy import ndimage

from ..survey import rasters

THRESHOLD = 0.1                 # m
EIGHT = np.ones((3, 3), int)    # neighbours of a cell, for ndimage.label
CORNERS = (0, 0), (0, 1), (1, 0), (1, 1)    # of a cell, columns and rows


class Top(NamedTuple):
    """The highest released point, local metres; z is NaN where the ground below it is not known."""
    x: float
    y: float
    z: float
    source: str                 # where it is known from, for people


class Connected(NamedTuple):
    """The largest connected part of a deposit; see `connected`."""
    threshold: float            # m, it is thicker than this
    parts: int                  # connected parts that the deposit has
    volume: float               # m3, bulk
    share: float                # of the volume on the grid, 0 to 1
    area: float                 # m2
    distance: float             # m, in plan, from the highest released ball to its farthest point
    farthest: tuple             # local x, y of that point, m
    reach_angle: Optional[float]    # degrees below the horizontal; None where no height is known
    mask: np.ndarray            # its cells, bool, rows from the north


def connected(deposit, threshold=THRESHOLD):
    """The largest 8-connected part of a deposit.Deposit that is thicker than threshold (m): a Connected.

    Largest is the one of the largest volume. None where the deposit is nowhere thicker than threshold.

    distance (m, in plan): from the highest released ball (see `top`) to the farthest corner of the part's cells.
    reach_angle (degrees): the angle below the horizontal at which the surface of that cell is seen from that ball;
    None where the cell has no ground, or the height of the top is not known.
    """
    thickness, cell = deposit.raster.z, deposit.cell
    labels, parts = ndimage.label(thickness > threshold, EIGHT)
    if parts == 0:
        return None
    volume = ndimage.sum_labels(thickness, labels, np.arange(1, parts + 1))
    mask = labels == 1 + int(np.argmax(volume))
    highest = top(deposit)
    rows, columns = np.nonzero(mask)
    x, y = np.moveaxis(np.array([deposit.raster.transform @ (columns + i, rows + j) for i, j in CORNERS]), 1, 0)
    distances = np.hypot(x - highest.x, y - highest.y)     # of each corner of each cell
    corner, far = np.unravel_index(distances.argmax(), distances.shape)
    distance = float(distances[corner, far])
    drop = highest.z - float((deposit.base + thickness)[rows[far], columns[far]])
    angle = math.degrees(math.atan2(drop, distance)) if math.isfinite(drop) else None
    total = float(volume.max()) * cell ** 2
    return Connected(float(threshold), int(parts), total, total / deposit.volume, len(rows) * cell ** 2, distance,
                     (float(x[corner, far]), float(y[corner, far])), angle, mask)


def top(deposit):
    """The Top of a deposit.Deposit: where its highest ball was released, from its summary.

    A summary of an older run does not tell it. Then it is the centre of the highest cell that the mass was ever in, or,
    without PREFIX.max_thickness.asc, of the deposit, which is lower on the slope.
    """
    top = (deposit.summary.get("travel") or {}).get("top")
    if isinstance(top, list) and len(top) == 3 and all(isinstance(v, (int, float)) for v in top):
        return Top(float(top[0]), float(top[1]), float(top[2]), "summary: highest released ball")
    name = f"{deposit.prefix}.max_thickness.asc"
    source, thickness = "highest cell of the deposit", deposit.raster.z
    if Path(name).is_file():
        largest = rasters.read_raster(name, heights=False)
        if largest.z.shape == thickness.shape and largest.transform == deposit.raster.transform:
            source, thickness = "highest cell that the mass was in", largest.z
    surface = np.where((thickness > 0) & np.isfinite(deposit.base), deposit.base + thickness, -np.inf)
    row, column = np.unravel_index(surface.argmax(), surface.shape)
    x, y = deposit.raster.transform @ (column + 0.5, row + 0.5)
    z = float(surface[row, column])
    return Top(float(x), float(y), z if math.isfinite(z) else math.nan, source)
