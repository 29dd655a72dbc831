"""The maps over the runs of an ensemble that is weighted by known events: exceedance with bounds, and quantiles.

Known events beyond the longest run: see conditioned.whole(); in an upper bound they are everywhere.
"""
import math
from pathlib import Path
from typing import Any, Dict, List, Sequence, Tuple

import numpy as np

from ..case import run_folders
from ..quantiles import within
from ..statistics import hazard
from ..survey import rasters
from . import conditioned
from .conditioned import Masses
from .ensemble_maps import BOUND, KINDS, Kind, SIDES, Stack, Thresholds, emptied, once

BLOCK = 20_000          # cells at a time


@once
def write(folder: Path, prefixes: Sequence[Path], mass: Masses, several: float, failed: float, thresholds: Thresholds,
          place) -> List[Dict[str, Any]]:
    """Write all maps of the runs with masses (their PREFIXes) to a folder; a dict for each, as study.yaml has it.

    several, failed: see conditioned.estimate; place: CRS and offset of the runs (rasters.Place) or None.
    """
    emptied(folder)
    found = []
    for kind in rasters.progress(KINDS, "maps of known events"):
        grid = run_folders.load_raster(prefixes[0], kind.name, heights=False)
        if place:
            grid = grid._replace(crs=place.crs, offset=place.offset)
        stack = Stack(kind, prefixes, grid.z.shape, folder)
        found += of_kind(folder, kind, stack, grid, mass, several, failed, thresholds.of(kind))
    return found


def of_kind(folder: Path, kind: Kind, stack: Stack, grid, mass: Masses, several: float, failed: float,
            thresholds: Sequence[float]) -> List[Dict[str, Any]]:
    """The maps of one raster: .asc of each, all of them with bounds of the exceedance as bands of a GeoTIFF."""
    cells, full = math.prod(stack.shape), conditioned.whole(mass)
    levels = [0.0, *(threshold for threshold in thresholds if threshold > 0)]
    exceeded = {(level, side): np.zeros(cells) for level in levels for side in SIDES}
    kept = {share: np.full(cells, np.nan) for share in hazard.SHARES}
    for start in range(0, cells, BLOCK):
        part = slice(start, start + BLOCK)
        block = stack.values[:, part]
        for level in levels:
            exceeding = np.isfinite(block) if kind.early else block > level
            _, low, high = conditioned.estimate(exceeding, mass, several=several, failed=failed)
            exceeded[level, "value"][part] = full @ exceeding
            exceeded[level, "low"][part], exceeded[level, "high"][part] = low, np.minimum(high + mass.far, 1)
        for share, values in zip(hazard.SHARES, within(-block if kind.early else block, full, hazard.SHARES)):
            kept[share][part] = -values if kind.early else values
    bands: Dict[str, np.ndarray] = {}
    central: List[Tuple[Dict[str, Any], str, str, str]] = []
    for share, z in kept.items():
        text = quantile_text(kind, share)
        bands[text] = np.where(np.isfinite(z), z, np.nan).reshape(stack.shape)
        central.append(({"quantile": share}, f"q{100 * share:g}", f"{text}, {kind.unit}", text))
    for level in levels:
        text = f"share of known events with a {kind.what} > {level:g} {kind.unit}" if not kind.early else \
            "share of known events that arrive"
        bands.update({f"{text}{BOUND[side]}": exceeded[level, side].reshape(stack.shape) for side in SIDES})
        central.append(({"threshold": level}, "reached" if kind.early else f"above_{level:g}", text, text))
    rasters.write_geotiff(folder / f"{kind.name}.tif", bands, grid)
    found = []
    for about, name, what, text in central:
        if not np.isfinite(bands[text]).any():      # so many never arrive anywhere
            continue
        path = folder / f"{kind.name}_{name}.asc"
        rasters.write_asc_local(path, grid._replace(z=bands[text]), {"what": what})
        found.append({"file": f"{folder.name}/{path.name}", "raster": kind.name, "what": what, "unit": kind.unit,
                      **about, "bounds": f"{folder.name}/{kind.name}.tif" if "threshold" in about else None})
    return found


def quantile_text(kind: Kind, share: float) -> str:
    if kind.early:
        return f"{kind.what}: {100 * (1 - share):.3g} % of known events are earlier"
    return f"{kind.what} that {100 * share:.3g} % of known events stay within"
