"""The sloping local base level (SLBL) of Jaboyedoff et al.: a slip surface from the relief alone.

M. Jaboyedoff et al., Testing a failure surface prediction and deposit reconstruction method for a landslide cluster
that occurred during Typhoon Talas (Japan), Earth Surf. Dynam. 7, 439-458, 2019, doi:10.5194/esurf-7-439-2019.
"""
from typing import Optional

import numpy as np
from scipy.sparse import coo_matrix, identity
from scipy.sparse.linalg import splu

MOST = 200      # steps; a dozen is usual


def base_level(z: np.ndarray, inside: np.ndarray, cell: float, curvature: float) -> np.ndarray:
    """Heights (m) of the base level of the ground z on the nodes of a mask; the ground itself on all others.

    The method lowers each node inside, again and again, to the mean of its four neighbours less a tolerance C, where
    that is lower than it is:  z <- min(z, mean(z of the neighbours) - C). What this comes to is computed here: the one
    surface that is nowhere above the ground, and where it is below it, z = mean - C. C = curvature x cell^2 / 4, so
    that curvature (1/m), the sum of the second derivatives along x and y, means the same on every raster: a long body
    of the length L is curvature x L^2 / 8 deep. 0 is a membrane below the ground; < 0, a surface that bulges.

    The mask must not touch the edge of the arrays. Policy iteration on sparse linear systems: which nodes stay at the
    ground is decided anew until nothing changes.
    """
    row, column = np.nonzero(inside)
    number = np.full(z.shape, -1)
    number[row, column] = np.arange(len(row))
    near_row, near_column = row[:, None] + [-1, 1, 0, 0], column[:, None] + [0, 0, -1, 1]
    near = number[near_row, near_column]
    known = near < 0
    own, other = np.nonzero(~known)[0], near[~known]
    mean = coo_matrix((np.full(len(own), 0.25), (own, other)), (len(row), len(row))).tocsr()
    fixed = np.where(known, z[near_row, near_column], 0.0).sum(axis=1) / 4 - curvature * cell ** 2 / 4
    matrix = identity(len(row), format="csr") - mean

    ground = z[row, column]
    heights = ground.copy()
    before: Optional[np.ndarray] = None
    for _ in range(MOST):       # from the surface that knows no ground above it
        lower = np.full(len(row), True) if before is None else mean @ heights + fixed < ground
        if before is not None and (lower == before).all():
            break
        before = free = lower
        heights = ground.copy()
        if free.any():
            right = fixed[free] - (matrix[free][:, ~free] @ ground[~free])
            heights[free] = splu(matrix[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A",
                                 options={"SymmetricMode": True}).solve(right)
    level = z.copy()
    level[row, column] = np.minimum(heights, ground)
    return level
