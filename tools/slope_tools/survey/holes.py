"""Holes of NODATA in a raster, and filling small ones. scipy is loaded only where there is something to fill."""
from typing import Tuple

import numpy as np


def small_holes(empty: np.ndarray, most: int) -> Tuple[np.ndarray, int]:
    """Mask and number of the holes in a boolean array: groups of at most `most` True cells, none of them at the edge.

    Cells that touch, corners included, are one group.
    """
    from scipy import ndimage
    groups, number = ndimage.label(empty, np.ones((3, 3)))
    hole = np.bincount(groups.ravel(), minlength=number + 1) <= most
    hole[0] = False         # no group
    for side in (groups[0], groups[-1], groups[:, 0], groups[:, -1]):
        hole[side] = False
    return hole[groups], int(hole.sum())


def fill(z: np.ndarray, holes: np.ndarray) -> np.ndarray:
    """Heights with the holes (a mask, none of it at the edge) filled: each cell is the mean of its four neighbours.

    That is the membrane on the rim; it fills a hole in a plane exactly. GDAL's fillnodata leaves a step: on a slope of
    0.76 and cells of 5 m, 1.4 m at a single cell. All holes are one sparse linear system.
    """
    row, column = np.nonzero(holes)
    if not len(row):
        return z
    from scipy import sparse
    from scipy.sparse.linalg import spsolve
    near_row, near_column = row[:, None] + [-1, 1, 0, 0], column[:, None] + [0, 0, -1, 1]
    number = np.full(z.shape, -1)       # of an unknown; -1 for a known height
    number[row, column] = np.arange(len(row))
    near = number[near_row, near_column]
    rim = np.where(near < 0, z[near_row, near_column], 0).sum(axis=1)
    cell, side = np.nonzero(near >= 0)
    matrix = sparse.diags(np.full(len(row), 4.0)) - sparse.coo_matrix(
        (np.ones(len(cell)), (cell, near[cell, side])), shape=(len(row), len(row)))
    middle = np.nanmean(z)      # heights against it, so that digits of a high mountain are not lost
    filled = z.copy()
    filled[row, column] = middle + spsolve(matrix.tocsc(), rim - middle * (near < 0).sum(axis=1))
    return filled
