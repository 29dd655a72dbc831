"""The maps over all runs of an ensemble: quantiles and exceedance of each raster of fix deposit/grid, with bounds."""
import functools
import math
import tempfile
from pathlib import Path
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence

import numpy as np

from .. import kept
from ..case import run_folders
from ..statistics import hazard
from ..survey import rasters

IN_MEMORY = 5e8         # bytes of a raster of all runs; more go to a file
BLOCK = 200_000         # cells that are sorted at a time


SIDES = ("value", "low", "high")        # fields of hazard.Places
BOUND = {"value": "", "low": ", lower bound", "high": ", upper bound"}
BOUND_EARLY = {"value": "", "low": ", later bound", "high": ", earlier bound"}


class Kind(NamedTuple):
    """A raster of fix deposit/grid. early: small values are the grave ones, and a cell may have none (NaN)."""
    name: str
    what: str
    unit: str
    early: bool = False


KINDS = (Kind("thickness", "final thickness", "m"), Kind("max_thickness", "largest thickness", "m"),
         Kind("max_speed", "largest speed", "m/s"), Kind("max_energy", "largest energy of a ball", "J"),
         Kind("arrival", "first arrival", "s", True))


class Thresholds(NamedTuple):
    """Values whose exceedance is mapped: of both thicknesses (m), of the speed (m/s), of the energy (J)."""
    thickness: Sequence[float]
    speed: Sequence[float]
    energy: Sequence[float]

    def of(self, kind: Kind) -> Sequence[float]:
        return {"max_speed": self.speed, "max_energy": self.energy, "arrival": ()}.get(kind.name, self.thickness)


def once(make: Callable[..., List[Dict[str, Any]]]) -> Callable[..., List[Dict[str, Any]]]:
    """make(folder, prefixes, ...) writes maps of runs to a folder: not again while all that they are made of, and the
    maps, are as they were."""
    @functools.wraps(make)
    def write(folder: Path, prefixes: Sequence[Path], *asked: Any) -> List[Dict[str, Any]]:
        runs = [(prefix.parent.name, run_folders.stamps(prefix, [kind.name for kind in KINDS])) for prefix in prefixes]
        return kept.value(folder / ".maps.json", [runs, asked], lambda: make(folder, prefixes, *asked),
                          lambda: sorted(maps_in(folder)))
    return write


@once
def write(folder: Path, prefixes: Sequence[Path], points: int, failed: int, thresholds: Thresholds,
          place) -> List[Dict]:
    """Write all maps of finished runs (their PREFIXes) to a folder; a dict for each, as study.yaml has it.

    points: of the design that they are of; place: CRS and offset of the runs (rasters.Place) or None.
    """
    emptied(folder)
    effect = max(1.0, len(prefixes) / points)
    found = []
    for kind in rasters.progress(KINDS, "maps over all runs"):
        grid = run_folders.load_raster(prefixes[0], kind.name, heights=False)
        if place:
            grid = grid._replace(crs=place.crs, offset=place.offset)
        stack = Stack(kind, prefixes, grid.z.shape, folder)
        found += of_kind(folder, kind, stack, grid, failed, effect, thresholds.of(kind))
    return found


def emptied(folder: Path) -> None:
    """Make the folder of maps, without those of a study before."""
    folder.mkdir(exist_ok=True)
    for old in maps_in(folder):
        old.unlink()


def maps_in(folder: Path) -> List[Path]:
    return [one for one in folder.iterdir() if one.suffix in (".asc", ".yaml", ".tif")]


class Stack:
    """One raster of all runs, block by block; never (inf) where a run has no value of an early kind."""

    def __init__(self, kind: Kind, prefixes: Sequence[Path], shape, folder: Path):
        self.kind, self.shape, self.runs = kind, shape, len(prefixes)
        cells = math.prod(shape)
        self.file = None
        if 4 * cells * self.runs > IN_MEMORY:
            self.file = tempfile.TemporaryFile(dir=folder)     # goes with the Stack
            self.values: np.ndarray = np.memmap(self.file, np.float32, "w+", shape=(self.runs, cells))
        else:
            self.values = np.empty((self.runs, cells), np.float32)
        for i, prefix in enumerate(prefixes):
            z = run_folders.load_raster(prefix, kind.name, heights=False).z
            self.values[i] = np.where(np.isfinite(z), z, math.inf if kind.early else 0.0).ravel()

    def sorted_blocks(self):
        """(slice of the cells, their values of all runs, the harmless ones first)."""
        for start in range(0, self.values.shape[1], BLOCK):
            part = slice(start, start + BLOCK)
            block = np.sort(self.values[:, part], axis=0)
            yield part, block[::-1] if self.kind.early else block


def of_kind(folder: Path, kind: Kind, stack: Stack, grid, failed: int, effect: float,
            thresholds: Sequence[float]) -> List[Dict[str, Any]]:
    """The maps of one raster: central ones as .asc, all of them with their bounds as bands of a GeoTIFF."""
    n, cells = stack.runs, math.prod(stack.shape)
    at = {share: hazard.places(share, n, failed, effect) for share in hazard.SHARES}
    levels = [0.0, *(threshold for threshold in thresholds if threshold > 0)]
    of_quantiles = {(share, side): np.full(cells, np.nan) for share in hazard.SHARES for side in SIDES}
    above = {level: np.zeros(cells) for level in levels}
    for part, block in stack.sorted_blocks():
        for share, places in at.items():
            for side in SIDES:
                i: Optional[int] = getattr(places, side)
                if i is not None:
                    of_quantiles[share, side][part] = block[i]
        for level in levels:
            above[level][part] = (np.isfinite(block) if kind.early else block > level).sum(axis=0)
    bands, central = {}, []
    for share in hazard.SHARES:
        text = quantile_text(kind, share)
        for side in SIDES:
            z = of_quantiles[share, side].reshape(stack.shape)
            bands[f"{text}{(BOUND_EARLY if kind.early else BOUND)[side]}"] = np.where(np.isfinite(z), z, np.nan)
        central.append(({"quantile": share, "bounded": at[share].high is not None}, f"q{100 * share:g}", text))
    for level in levels:
        text = f"share of the runs with a {kind.what} > {level:g} {kind.unit}" if not kind.early else \
            "share of the runs that arrive"
        low, high = hazard.share_bounds(above[level], n, failed, effect)
        for side, z in (("value", above[level] / n), ("low", low), ("high", high)):
            bands[f"{text}{BOUND[side]}"] = z.reshape(stack.shape)
        central.append(({"threshold": level}, f"above_{level:g}" if not kind.early else "reached", text))
    rasters.write_geotiff(folder / f"{kind.name}.tif", bands, grid)
    found = []
    for about, name, text in central:
        z = bands[text]
        path = folder / f"{kind.name}_{name}.asc"
        entry: Dict[str, Any] = {
            "file": f"{folder.name}/{path.name}", "raster": kind.name,
            "what": f"{text}, {kind.unit}" if "quantile" in about else text, "unit": kind.unit, **about,
            "bounds": f"{folder.name}/{kind.name}.tif"}
        if not np.isfinite(z).any():        # so many runs never arrive anywhere
            continue
        rasters.write_asc_local(path, grid._replace(z=z), {"what": entry["what"]})
        found.append(entry)
    return found


def quantile_text(kind: Kind, share: float) -> str:
    if kind.early:
        return f"{kind.what}: {100 * (1 - share):.3g} % of the runs are earlier"
    return f"{kind.what} that {100 * share:.3g} % of the runs stay within"
