"""The mass that falls: ground before and depth of the body on the same grid, from a release, a site, or arrays."""
from pathlib import Path
from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from scipy.ndimage import label

from ..deposits.deposit import Deposit
from ..errors import SlopeError
from ..findings import Finding
from ..releases import release, release_area
from ..sites import site_folder
from ..survey import rasters
from ..survey.rasters import Raster
from ..survey.resampling import sample


SIDE = 0.02     # of the volume; bodies that hold less beside the largest are not worth a word
SCAR = 0.01     # m; ground that lies so much lower than before is the slip surface


class Body(NamedTuple):
    """raster: the ground before; depth (m, 0 beside the body), of its shape; where: what messages name."""
    raster: Raster
    depth: np.ndarray
    where: str

    @property
    def cell(self) -> float:
        return float(self.raster.transform.a)

    @property
    def volume(self) -> float:
        """m3; exact, as the body lies between two bilinear surfaces."""
        return float(self.depth.sum()) * self.cell ** 2

    @property
    def base(self) -> np.ndarray:
        """The ground without the body, m."""
        return self.raster.z - self.depth

    @property
    def main(self) -> np.ndarray:
        """Depth (m) of the largest part, where several release areas, or a scar in parts, do not touch.

        What lies between two bodies is neither's fall line.
        """
        labels, volumes = self._label_parts()
        return np.where(labels == volumes.argmax(), self.depth, 0.0)

    @property
    def parts(self) -> List["Body"]:
        """The parts that do not touch, each alone, the largest first; without those that hold less than SIDE."""
        labels, volumes = self._label_parts()       # a scar may have thousands
        large = [k for k in np.argsort(-volumes, kind="stable").tolist() if volumes[k] >= SIDE * volumes.sum()]
        return [self._replace(depth=np.where(labels == k, self.depth, 0.0)) for k in large]

    def _label_parts(self) -> Tuple[np.ndarray, np.ndarray]:
        """Number of the part of each cell, 0 beside all, and the depths (m) of each part together."""
        labels, _ = label(self.depth > 0, np.ones((3, 3)))
        return labels, np.bincount(labels.ravel(), self.depth.ravel())

    def beside(self) -> List[Finding]:
        """That the fall path is that of one body of several."""
        main = float(self.main.sum()) * self.cell ** 2
        return [Finding("several bodies", {"volume": main, "all": self.volume})] * (
            main < (1 - SIDE) * self.volume)

    @property
    def crown(self) -> Tuple[float, float, float]:
        """x, y, z (m) of the highest ground in the body, of several in the largest."""
        row, column = np.unravel_index(np.argmax(np.where(self.main > 0, self.raster.z, -np.inf)), self.depth.shape)
        x, y = self.raster.transform @ (column + 0.5, row + 0.5)
        return float(x), float(y), float(self.raster.z[row, column])

    def fall_line(self) -> Tuple[np.ndarray, np.ndarray]:
        """Of the body: its centre of volume (x, y, m), and the unit vector down the plane that fits its ground best.

        Of several bodies those of the largest.
        """
        depth = self.main
        row, column = np.nonzero(depth)
        x, y = self.raster.transform @ np.array([column + 0.5, row + 0.5])
        weight = depth[row, column]
        top, left = row.min(), column.min()
        part = slice(top, row.max() + 1), slice(left, column.max() + 1)
        columns, _ = self.raster.transform @ (np.arange(left, column.max() + 1) + 0.5, 0.0)
        _, rows = self.raster.transform @ (0.0, np.arange(top, row.max() + 1) + 0.5)
        downhill, slope = release_area.fall(columns, rows, self.raster.z[part], depth[part] > 0)
        if slope < release_area.FLAT:
            raise SlopeError(self.where, f"the ground of the body must fall by at least {release_area.FLAT:g} degree, "
                             "for a fall path", f"{slope:.3g}, flat")
        return np.array([x @ weight, y @ weight]) / weight.sum(), downhill


def of_arrays(raster: Raster, depth: np.ndarray, where: str) -> Body:
    """raster: the ground before; depth: m, NaN or 0 beside the body; SlopeError without a body."""
    depth = np.where(np.isfinite(raster.z), np.maximum(np.nan_to_num(depth), 0.0), 0.0)
    if not depth.any():
        raise SlopeError(where, "must hold a body that is released")
    return Body(raster, depth, where)


def of_run(run: Deposit, terrain: Optional[Path]) -> Body:
    """The body of a run, on its grid; terrain: see find_ground_before()."""
    before, depth = find_ground_before(run.raster, run.base, terrain)
    return of_arrays(run.raster._replace(z=before), depth, "the run")


def find_ground_before(raster: Raster, base: np.ndarray, terrain: Optional[Path]) -> Tuple[np.ndarray, np.ndarray]:
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


def of_release(released: release.Body, where: str) -> Body:
    return of_arrays(released.raster, released.depth, where)


def read_mobility_body(folder: Path) -> Body:
    """The body of a folder that slope site made, whose site.yaml was read."""
    terrain, depth = folder / site_folder.TERRAIN, folder / f"{site_folder.BODY}.depth.asc"
    raster, found = rasters.read_asc_local(terrain), rasters.read_asc_local(depth, heights=False)
    if found.z.shape != raster.z.shape or not found.transform.almost_equals(raster.transform):
        raise SlopeError(depth, f"must have the grid of {terrain}: rebuild the folder with slope site")
    return of_arrays(raster, found.z, str(folder))
