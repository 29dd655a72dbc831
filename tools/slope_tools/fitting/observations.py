"""What was observed of a collapse, as targets of a calibration, and the same numbers of a run.

A mapped deposit gives: the lack of overlap 1 - CSI, with CSI = both/(both + simulated only + mapped only) by area; the
distance from the highest released ball that 99 % of the mapped volume, or area, stay within; of a raster the volume in
each of ZONES bands of that distance, which hold equal shares of the mapped volume; of an outline its area, and the
distances of 50 and 90 % of it. Single numbers: the front, which is the length along the fall path, or the distance of
95 or 99 % of the volume; the area ever covered; the volume on the road.
"""
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from ..case import run_folders
from ..deposits import deposit, score
from ..errors import SlopeError
from ..quantiles import within
from ..statistics.backanalysis import Target
from ..survey import rasters, vectors
from ..tables.rows import Finished

ZONES = 6
BESIDE = 0.01           # of a mapped deposit, that may lie beside the terrain
SHARES = {True: (0.5, 0.9, 0.99), False: (0.99,)}      # of an outline, of a raster
KINDS = ("observed", "front", "area", "volume")     # what can be observed, as the options call it
# what is compared with a front: name, column of the table of `slope study`
FRONTS = {"length": ("length along the fall path", "length_m"),
          "95": ("95 % of the volume within", "distance_95_m"), "99": ("99 % of the volume within", "distance_99_m")}


@dataclass(frozen=True)
class Wanted:
    """The options: a mapped deposit, and single numbers (m, m2, m3).

    tolerance: by what share they may be wrong; own: of one of KINDS, where that is another share.
    """
    observed: Optional[Path]
    front: Optional[float]
    area: Optional[float]
    volume: Optional[float]
    tolerance: float
    threshold: float            # m; thinner is no deposit
    local: bool                 # the mapped deposit is in local metres
    own: Mapping[str, float] = field(default_factory=dict)
    front_is: str = "length"

    def share(self, kind: str) -> float:
        """The tolerance of a kind."""
        return self.own.get(kind, self.tolerance)

    def check(self, road: bool) -> None:
        """Raise SlopeError unless something is observed, and every number can be."""
        numbers = {"--front": self.front, "--area": self.area, "--road-volume": self.volume}
        if self.observed is None and all(value is None for value in numbers.values()):
            raise SlopeError("--observed, --front, --area, --road-volume", "must give at least one of them")
        for option, value in numbers.items():
            if value is not None and not value > 0:
                raise SlopeError(option, "must be > 0", f"{value:g}")
        if self.volume is not None and not road:
            raise SlopeError("--road-volume", "needs --road: it is the volume on it")
        if self.observed is not None and not vectors.is_there(self.observed):
            raise SlopeError("--observed", "must be an existing file", self.observed)
        for value in (self.tolerance, *self.own.values()):
            if not 0 <= value < 1:
                raise SlopeError("--tolerance", "must be a share, >= 0 and < 1", f"{value:g}")
        for kind in self.own:
            if getattr(self, kind) is None:
                raise SlopeError("--tolerance", f"must be of what is observed: needs --{kind}")
        if self.threshold < 0:
            raise SlopeError("--threshold", "must be >= 0", f"{self.threshold:g}")

    @property
    def about(self) -> Dict[str, Any]:
        """For the result, and to tell whether another call is of the same observation."""
        return {"observed": None if self.observed is None else self.observed.name, "front": self.front,
                "front_is": self.front_is if self.front is not None else None, "area": self.area,
                "volume": self.volume, "threshold": self.threshold,
                "tolerance": {"all": self.tolerance, **self.own} if self.own else self.tolerance}

    def check_place(self, terrain: Path, warn: Callable[[str], None]) -> None:
        """Raise SlopeError before the first run if the mapped deposit lies elsewhere, or in another CRS."""
        if self.observed is not None:
            ground = rasters.read_asc_local(terrain)
            mapped = score.read_observed(self.observed, ground, self.threshold, self.local, warn)
            beside = float(mapped.beside[:, 2].sum())
            there = float((mapped.share if mapped.thickness is None else mapped.thickness).sum())
            share = beside / (beside + there * float(ground.transform.a) ** 2)
            if share > BESIDE:      # where no run leaves anything: it would look as if the mass had stopped before
                raise SlopeError(self.observed, f"must lie on the terrain, but for {BESIDE:.0%}: where it goes on, no "
                                 "run shows a deposit; use a larger terrain", f"{share:.2g} beside it")


class Observations:
    """The targets, once the first run has shown its grid; and what each run has of them."""

    def __init__(self, wanted: Wanted):
        self.wanted = wanted
        self.targets: List[Target] = []
        self.mapped: Optional[score.Observed] = None
        self.shape: Tuple[int, ...] = ()        # of the grid of the first run
        self.edges = np.empty(0)                # of the bands of distance, m

    @property
    def volume(self) -> Optional[float]:
        """Of the mapped deposit, m3; None of an outline, or where nothing is mapped."""
        if self.mapped is None or self.mapped.thickness is None:
            return None
        return float(self.mapped.thickness.sum()) * float(self.transform.a) ** 2 + self.mapped.volume_outside

    def told_by(self, row: Finished) -> bool:
        """Whether a run (a row of the table of `slope study`) says how far the mass goes, if that was asked.

        A length or an area that the edge of the terrain cuts off is none.
        """
        asked = self.wanted.front is not None or self.wanted.area is not None
        return not (asked and row.left_box)

    def measure(self, summary: Path, terrain: Optional[Path], row: Finished) -> np.ndarray:
        """The outputs of a run, in the order of the targets; row: of the table of `slope study`."""
        run_ = deposit.read_deposit(run_folders.prefix_of(summary), terrain, lambda text: None)
        if not self.targets:
            self._set_targets(run_)
        elif self.shape != run_.raster.z.shape or not self.transform.almost_equals(run_.raster.transform):
            raise SlopeError(summary, "must have the grid of the other runs: cells cannot be varied here")
        outputs = self._of_map(run_, self.mapped) if self.mapped is not None else []
        if self.wanted.front is not None:
            outputs.append(front(summary, row, FRONTS[self.wanted.front_is][1]))
        if self.wanted.area is not None:
            covered = run_folders.load_raster(run_.prefix, "max_thickness").z > self.wanted.threshold
            outputs.append(float(covered.sum()) * run_.cell ** 2)
        if self.wanted.volume is not None:
            outputs.append(row.at_road.remove_on_road_m3)
        return np.array(outputs, float)

    def _set_targets(self, run_: deposit.Deposit) -> None:
        wanted = self.wanted
        targets: List[Target] = []
        self.shape, self.transform = run_.raster.z.shape, run_.raster.transform

        def relative(name, unit, value, whole=None, kind="observed"):
            scale = value if whole is None else whole
            targets.append(Target(name, unit, float(value), float(wanted.share(kind) * scale)))

        if wanted.observed is not None:
            mapped = self.mapped = score.read_observed(wanted.observed, run_.raster, wanted.threshold, wanted.local)
            if not mapped.share.any():
                raise SlopeError(wanted.observed, f"must be somewhere thicker than {wanted.threshold:g} m on the grid")
            targets.append(Target("lack of overlap", "1 - CSI", None, wanted.share("observed")))
            distance = self.distance = compute_cell_distances(run_)
            outline = mapped.thickness is None
            weight: np.ndarray = mapped.share if mapped.thickness is None else mapped.thickness
            of = distance[weight > 0], weight[weight > 0]
            for share in SHARES[outline]:
                relative(f"{100 * share:g} % of the {'area' if outline else 'volume'} within", "m",
                         within(*of, share))
            if outline:
                relative("area", "m2", float(weight.sum()) * run_.cell ** 2 + mapped.outside)
            else:
                self.edges = np.array([within(*of, k / ZONES) for k in range(1, ZONES)])
                total = float(weight.sum()) * run_.cell ** 2
                for k, volume in enumerate(self._zones(weight, run_.cell)):
                    relative(f"volume in zone {k + 1}", "m3", volume, total)
        for name, unit, kind in ((FRONTS[wanted.front_is][0], "m", "front"), ("area covered", "m2", "area"),
                                 ("volume on the road", "m3", "volume")):
            if getattr(wanted, kind) is not None:
                relative(name, unit, getattr(wanted, kind), kind=kind)
        self.targets = targets

    def _of_map(self, run_: deposit.Deposit, mapped: score.Observed) -> List[float]:
        simulated = run_.raster.z > self.wanted.threshold
        overlap = score.overlap(simulated, mapped, run_.cell)
        outline = mapped.thickness is None
        weight = simulated.astype(float) if outline else run_.raster.z
        outputs = [1 - (overlap["jaccard"] or 0.0)]
        there = weight > 0
        for share in SHARES[outline]:
            outputs.append(within(self.distance[there], weight[there], share) if there.any() else 0.0)
        if outline:
            return [*outputs, overlap["simulated"]]
        return [*outputs, *self._zones(weight, run_.cell)]

    def _zones(self, thickness: np.ndarray, cell: float) -> np.ndarray:
        """Volume (m3) in each band of distance."""
        band = np.searchsorted(self.edges, self.distance)
        return np.bincount(band.ravel(), thickness.ravel(), ZONES) * cell ** 2


def front(summary: Path, row: Finished, column: str) -> float:
    """The front (m) of a run of which it is known; 0 where nothing is left of the deposit."""
    length = row.value(column)
    if length is None and column == FRONTS["length"][1]:
        return 0.0
    if length is None:
        raise SlopeError(summary, "must have the distance of a share of the volume (travel: quantiles), which runs of "
                         "older versions lack")
    return length


def compute_cell_distances(run_: deposit.Deposit) -> np.ndarray:
    """Plan distance of each cell's centre from the highest released ball, m."""
    x, y = deposit.top(run_)[:2]
    rows, columns = np.indices(run_.raster.z.shape)
    east, north = run_.raster.transform @ (columns + 0.5, rows + 0.5)
    return np.hypot(east - x, north - y)
