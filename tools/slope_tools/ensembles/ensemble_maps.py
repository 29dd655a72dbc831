"""The maps over the runs of an ensemble: quantiles and exceedance of each raster of fix deposit/grid, with bounds."""
import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Dict, List, NamedTuple, Sequence, Union

import numpy as np

from .. import kept
from ..case import run_folders
from ..statistics import hazard
from ..survey import rasters
from . import conditioned

IN_MEMORY = 5e8         # bytes of a raster of all runs; more go to a file
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


@dataclass(frozen=True)
class Alike:
    """Runs that count alike. failed: further runs that gave none; effect: how many are worth one independent run."""
    failed: int
    effect: float
    whose: ClassVar[str] = "the runs"
    at_a_time: ClassVar[int] = 200_000      # cells

    def within(self, block: np.ndarray) -> np.ndarray:
        """What hazard.SHARES stay within in each column of values (runs, cells), and perhaps bounds, NaN where there is
        none: an array (shares, SIDES, cells)."""
        ordered, nothing = np.sort(block, axis=0).astype(float), np.full(block.shape[1], np.nan)
        places = (hazard.places(share, len(block), self.failed, self.effect) for share in hazard.SHARES)
        return np.array([[nothing if at is None else ordered[at] for at in (one.value, one.low, one.high)]
                         for one in places])

    def above(self, exceeding: np.ndarray) -> Sequence[np.ndarray]:
        """The share of the runs for which truths (runs, cells) hold, by column: SIDES."""
        number = exceeding.sum(axis=0)
        return number / len(exceeding), *hazard.share_bounds(number, len(exceeding), self.failed, self.effect)


Counts = Union[Alike, conditioned.Standing]


def write_ensemble_maps(folder: Path, prefixes: Sequence[Path], counts: Counts, thresholds: Thresholds,
                        place) -> List[Dict[str, Any]]:
    """Write all maps of finished runs (their PREFIXes) to a folder; a dict for each, as study.yaml has it. Not again
    while all that they are made of, and the maps, are as they were.

    place: CRS and offset of the runs (rasters.Place) or None.
    """
    def make() -> List[Dict[str, Any]]:
        folder.mkdir(exist_ok=True)
        for old in maps_in(folder):
            old.unlink()
        entries = []
        for kind in rasters.progress(KINDS, f"maps of {counts.whose}"):
            grid = run_folders.load_raster(prefixes[0], kind.name, heights=False)
            if place:
                grid = grid._replace(crs=place.crs, offset=place.offset)
            stack = Stack(kind, prefixes, grid.z.shape, folder)
            entries += of_kind(folder, kind, stack, grid, counts, thresholds.of(kind))
        return entries

    runs = [(prefix.parent.name, run_folders.stamps(prefix, [kind.name for kind in KINDS])) for prefix in prefixes]
    return kept.value(folder / ".maps.json", [runs, counts, thresholds, place], make, lambda: sorted(maps_in(folder)))


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


def of_kind(folder: Path, kind: Kind, stack: Stack, grid, counts: Counts,
            thresholds: Sequence[float]) -> List[Dict[str, Any]]:
    """The maps of one raster: central ones as .asc, all of them with their bounds as bands of a GeoTIFF."""
    levels = [0.0, *(threshold for threshold in thresholds if threshold > 0)]
    harmless_first = -1 if kind.early else 1
    within, above = [], []
    for start in range(0, stack.values.shape[1], counts.at_a_time):
        block = stack.values[:, start:start + counts.at_a_time]
        within.append(harmless_first * counts.within(harmless_first * block))
        above.append([counts.above(np.isfinite(block) if kind.early else block > level) for level in levels])
    file = f"{folder.name}/{kind.name}.tif"
    bands, central = {}, []
    for share, several in zip(hazard.SHARES, np.concatenate(within, axis=-1)):
        text, bounded = quantile_text(kind, share, counts.whose), len(several) > 1
        for side, z in zip(SIDES, several):
            bands[text + (BOUND_EARLY if kind.early else BOUND)[side]] = np.where(np.isfinite(z), z, np.nan)
        entry: Dict[str, Any] = {"quantile": share}
        if bounded:
            entry["bounded"] = not np.isnan(several[-1]).all()
        central.append((entry, f"q{100 * share:g}", text, f"{text}, {kind.unit}", file if bounded else None))
    for level, several in zip(levels, np.concatenate(above, axis=-1)):
        text = f"share of {counts.whose} " + ("that arrive" if kind.early else
                                              f"with a {kind.what} > {level:g} {kind.unit}")
        bands.update({text + BOUND[side]: z for side, z in zip(SIDES, several)})
        central.append(({"threshold": level}, "reached" if kind.early else f"above_{level:g}", text, text, file))
    bands = {text: z.reshape(stack.shape) for text, z in bands.items()}
    rasters.write_geotiff(folder / f"{kind.name}.tif", bands, grid)
    maps = []
    for entry, name, text, what, bounds in central:
        if not np.isfinite(bands[text]).any():      # so many never arrive anywhere
            continue
        path = folder / f"{kind.name}_{name}.asc"
        rasters.write_asc_local(path, grid._replace(z=bands[text]), {"what": what})
        maps.append({"file": f"{folder.name}/{path.name}", "raster": kind.name, "what": what, "unit": kind.unit,
                     **entry, "bounds": bounds})
    return maps


def quantile_text(kind: Kind, share: float, whose: str) -> str:
    if kind.early:
        return f"{kind.what}: {100 * (1 - share):.3g} % of {whose} are earlier"
    return f"{kind.what} that {100 * share:.3g} % of {whose} stay within"
