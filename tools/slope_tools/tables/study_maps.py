"""The maps over all runs of a study: the largest thickness, and how many runs exceed a thickness."""
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np

from .. import kept
from ..case import run_folders
from ..survey import rasters
from .study_types import MapEntry

RASTERS = "thickness", "max_thickness"


class Source(NamedTuple):
    """A finished run, of these rasters (PREFIX); counted: whether it counts in the shares of the runs."""
    name: str
    prefix: Path
    counted: bool


class OverAll(NamedTuple):
    """The maps over all runs as study.yaml has them; problem: why there are none."""
    envelope: Optional[Dict[str, MapEntry]]
    exceedance: Optional[List[MapEntry]]
    problem: Optional[str]


def write_study_maps(runs: Sequence[Source], thresholds: Sequence[float], output: Path,
                     place: Optional[rasters.Place]) -> OverAll:
    """Write all rasters, remove those of an earlier call. They are not made again while runs and rasters are as they
    were.

    place: CRS and offset of the runs.
    """
    made_of = [[(run.name, run.counted, run_folders.stamps(run.prefix, RASTERS)) for run in runs], thresholds, place]

    def make() -> Dict[str, Any]:
        maps = Maps(thresholds)
        for run in rasters.progress(runs, "maps over all runs"):
            thickness, most = (run_folders.load_raster(run.prefix, name) for name in RASTERS)
            maps.add(run.name, thickness, most, run.counted)
        envelope, exceedance = maps.write(output, place)
        return OverAll(envelope, exceedance, maps.problem)._asdict()
    return OverAll(**kept.value(output / ".maps.json", made_of, make, lambda: sorted(maps_in(output))))


def maps_in(output: Path) -> List[Path]:
    return [*output.glob("envelope_*"), *output.glob("exceedance_*")]


def same_grid(raster, other):
    return raster.z.shape == other.z.shape and raster.transform.almost_equals(other.transform)


class Maps:
    """Over all runs, cell by cell: the largest thickness, and how many runs exceed a threshold."""

    def __init__(self, thresholds):
        self.thresholds = thresholds
        self.grid = self.problem = None
        self.count, self.first = 0, None

    def add(self, name, thickness, max_thickness, counted=True):
        """counted: whether the run counts in the shares of the runs."""
        if self.grid is None:
            self.grid, self.first = thickness, name
            shape = thickness.z.shape
            self.envelope = {"thickness": np.zeros(shape), "max_thickness": np.zeros(shape)}
            self.exceeding = [np.zeros(shape, int) for _ in self.thresholds]
        elif not self.problem and not same_grid(thickness, self.grid):
            self.problem = (f"no maps over all runs: the rasters of {name} have another grid than those of "
                            f"{self.first}")
        if self.problem:
            return
        for key, raster in zip(RASTERS, (thickness, max_thickness)):
            np.fmax(self.envelope[key], raster.z, out=self.envelope[key])
        if counted:
            for threshold, exceeding in zip(self.thresholds, self.exceeding):
                exceeding += thickness.z > threshold
            self.count += 1

    def write(self, output, place) -> Tuple[Optional[Dict[str, MapEntry]], Optional[List[MapEntry]]]:
        """Write all rasters, remove those of an earlier call; what study.yaml says of them: envelope, exceedance."""
        of_envelope, of_exceedance = None, None
        mine: Set[Path] = set()
        if self.grid is not None and not self.problem:
            grid, area = self.grid, self.grid.transform.a ** 2

            def write(name, z, what):
                raster = grid._replace(z=z)
                if place:
                    raster = raster._replace(crs=place.crs, offset=place.offset)
                path = output / f"{name}.asc"
                rasters.write_asc_local(path, raster, {"what": what})
                mine.update((path, path.with_suffix(".yaml")))
                if raster.crs is not None:
                    rasters.write_geotiff(path.with_suffix(".tif"), {what: z}, raster)
                    mine.add(path.with_suffix(".tif"))
                return {"file": path.name, "what": what}

            of_envelope = {
                key: {**write(f"envelope_{key}", z, what), "largest_m": float(z.max()),
                      "area_m2": float((z > 0).sum() * area)}
                for (key, z), what in zip(self.envelope.items(), (
                    "largest final thickness over all runs, m", "largest thickness over all runs and times, m"))}
            of_exceedance = [
                {"threshold_m": threshold,
                 **write(f"exceedance_{threshold:g}m", exceeding / self.count,
                         f"share of the runs with a final thickness > {threshold:g} m"),
                 "area_in_any_run_m2": float((exceeding > 0).sum() * area),
                 "area_in_every_run_m2": float((exceeding == self.count).sum() * area)}
                for threshold, exceeding in zip(self.thresholds, self.exceeding)]
        for path in maps_in(output):
            if path not in mine:
                path.unlink()
        return of_envelope, of_exceedance
