"""What must be removed from a road, per mesh cell, above a cut surface."""
import math

import numpy as np

from .. import geometry
from ..errors import SlopeError
from ..geometry import Mesh
from . import cut

SAMPLES = 4            # parts of a cell along a side
MOST_MESH = 4_000_000  # mesh cells
EXACT = 1e-13          # of the deposit's volume: volumes are rounded to this once, so that they add up in every output


def make_mesh(size, raster):
    """The Mesh of that size over the raster; SlopeError if it would have too many cells."""
    xlo, ylo, xhi, yhi = geometry.extent(raster)
    count = ((xhi - xlo) / size + 1) * ((yhi - ylo) / size + 1)
    if count > MOST_MESH:
        raise SlopeError("--mesh", f"must give at most {MOST_MESH} mesh cells, the grid would need {count:.3g}",
                         f"{size:g}")
    return Mesh(size, raster)


def in_grid(polygon, raster, path, warn):
    """The part of a polygon (local metres) that lies in the grid; SlopeError if none does."""
    grid = geometry.box_of(raster)
    inside = polygon if grid.covers(polygon) else geometry.as_multi(polygon.intersection(grid))
    if inside.area <= 0:
        raise SlopeError(path, f"must lie in the grid of the run, {geometry.box(geometry.extent(raster))} (local "
                         "metres)", geometry.box(polygon.bounds))
    outside = 1 - inside.area / polygon.area
    if outside > 1e-9:
        warn(f"{path}: {100 * outside:.3g} % of the polygon lies outside of the grid of the run: cut off")
    return inside


# --- volumes ---

class Result:
    """Removed thickness per cell (m); volumes (m3) and areas (m2) per mesh cell, rounded."""

    def __init__(self, run_, road, mesh, removed):
        area = run_.cell ** 2
        self.digits = -math.floor(math.log10(EXACT * run_.volume)) if run_.volume > 0 else 6
        self.removed = np.minimum(removed.cells, run_.raster.z)
        self.deposit = self.rounded(mesh.sums(run_.raster.z) * area)
        self.road = np.minimum(self.rounded(removed.mesh_road * area), self.deposit)
        self.beside = np.minimum(self.rounded(removed.mesh_beside * area), self.rounded(self.deposit - self.road))
        self.volume = self.rounded(self.road + self.beside)
        self.road_area = self.rounded(np.maximum(
            geometry.coverage(geometry.to_index(road, run_.raster), mesh.x, mesh.y)[0], 0) * area)
        self.steep, self.unknown = self.rounded(removed.steep * area), self.rounded(removed.unknown * area)
        self.listed = np.argwhere((self.deposit > 0) | (self.road_area > 0))

    def rounded(self, values):
        return np.round(values, self.digits)

    def total(self, values):
        return round(math.fsum(values.ravel()), self.digits)


def evaluate(run_, road, angle, mesh, samples=SAMPLES):
    """The Result for a Deposit, a road (polygon in local metres, in the grid) and a cut at an angle (degrees)."""
    tangent = math.tan(math.radians(angle)) * run_.cell
    removed = cut.removed(run_.raster.z, cut.Ground(run_.base), geometry.to_index(road, run_.raster), tangent, mesh,
                          samples)
    return Result(run_, road, mesh, removed)
