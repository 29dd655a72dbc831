"""The runs of a site's study against its mapped deposit, whatever the method: overlap, run-out, volume of each.

The length of the mapped deposit is that of a run, along the fall path to its farthest lobe, by the cells that it
covers; what of an outline lies beside the run's grid counts by its corners, of a raster by its cells.
"""
import os
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple

import numpy as np

from ..case import run_folders
from ..deposits import deposit, score
from ..findings import Finding
from ..geometry import extent
from ..mobility import run_length
from ..sites.site_folder import TERRAIN
from ..sites.site_layers import OBSERVED
from ..survey import rasters
from ..tables import study_types
from ..tables.rows import Failed, Finished, Mapped, Row, finished_of

HALF = 0.5              # of a cell, which an outline covers
BESIDE = 0.01           # of the volume of a raster on the grid: less beside it counts as stray
SAME_MASS = 0.1         # of the released volume: a mapped deposit that holds so much less or more is not the same mass


def find_mapped_deposit(site: Optional[Path]) -> Optional[Path]:
    """The mapped deposit of a site's folder: its outline, or its thickness; None without one."""
    files = [site / f"{OBSERVED}{suffix}" for suffix in (".csv", ".tif")] if site else []
    return next((one for one in files if one.is_file()), None)


def check_mapped_deposit(site: Path) -> None:
    """Raise SlopeError unless the mapped deposit of a site, if it has one, can be compared with its runs."""
    path = find_mapped_deposit(site)
    if path:
        score.read_observed(path, rasters.read_asc_local(site / TERRAIN), score.THRESHOLD, False)


def compare(path: Optional[Path], output: Path, rows: Sequence[Row],
            terrains: Sequence[Optional[Path]]) -> Tuple[List[Row], Optional[study_types.Observed]]:
    """The rows with what finished runs have of a mapped deposit, and what study.yaml says of it; None without one.

    output: the study's folder; terrains: of the runs of the rows.
    """
    if path is None:
        return list(rows), None
    files: Dict[str, Any] = {}
    rows_compared: List[Row] = []
    for row, terrain in zip(rows, terrains):
        if isinstance(row, Failed):
            rows_compared.append(row)
            continue
        prefix = run_folders.prefix_of(run_folders.summary_of(output, row.summary))
        run_ = deposit.read_deposit(prefix, terrain, lambda text: None)
        observed = score.read_observed(path, run_.raster, score.THRESHOLD, False)
        length = length_of(run_, terrain, observed)
        area = score.overlap(run_.raster.z > score.THRESHOLD, observed, run_.cell)
        beyond = None if length is None or row.length_m is None else row.length_m - length
        rows_compared.append(row if area["jaccard"] is None else replace(row, mapped=Mapped(area["jaccard"], beyond)))
        volume = None if observed.thickness is None else \
            float(observed.thickness.sum()) * run_.cell ** 2 + observed.volume_outside
        files = files or {"file": os.path.relpath(path.resolve(), output.resolve()), "threshold_m": score.THRESHOLD,
                          "length_m": length, "area_m2": area["observed"], "volume_m3": volume,
                          "released_m3": row.released_m3}
    compared = of_rows(rows_compared)
    if not compared or not files:
        return rows_compared, None
    return rows_compared, study_types.Observed(**files, best=max(compared, key=lambda pair: pair[1].overlap)[0].run)


def of_rows(rows: Iterable[Row]) -> List[Tuple[Finished, Mapped]]:
    """The runs that are compared with a mapped deposit, and how they do."""
    return [(row, row.mapped) for row in finished_of(rows) if row.mapped]


def length_of(run_: deposit.Deposit, terrain: Optional[Path], observed: score.Observed) -> Optional[float]:
    """Length (m) of a mapped deposit along the fall path of a run's body; straight where it has none."""
    path = run_length.path_of(run_, terrain)
    if observed.thickness is not None:
        there = run_length.of_deposit(run_._replace(raster=run_.raster._replace(z=observed.thickness)), path)
        lengths = [there.distance] if there else []
        if observed.volume_outside > BESIDE * float(observed.thickness.sum()) * run_.cell ** 2:
            places = observed.beside[observed.beside[:, 3] > score.THRESHOLD, :2]
            lengths += run_length.lengths_of(places, path, run_)[0].tolist()
        return max(lengths, default=None)
    rows, columns = np.nonzero(observed.share >= HALF)
    points = np.column_stack(run_.raster.transform @ np.array([columns + 0.5, rows + 0.5]))
    xlo, ylo, xhi, yhi = extent(run_.raster)
    x, y = np.asarray(observed.points).reshape(-1, 2).T
    beside = (x < xlo) | (x > xhi) | (y < ylo) | (y > yhi) | (not len(points))
    points = np.concatenate([points, np.column_stack([x, y])[beside]])
    return float(run_length.lengths_of(points, path, run_)[0].max()) if len(points) else None


def describe_mapped(observed: study_types.Observed, rows: Sequence[Row]) -> List[str]:
    """The comparison on the console, a line each."""
    found = of_rows(rows)
    best, mine = next((row, one) for row, one in found if row.run == observed.best)
    low, high = min(one.overlap for _, one in found), mine.overlap
    text = f"mapped deposit: overlap (Jaccard) {low:.2f} to {high:.2f}" if len(found) > 1 else \
        f"mapped deposit: overlap (Jaccard) {high:.2f}"
    if mine.beyond_mapped_m is not None:
        text += f", best of {best.run}, {mine.beyond_mapped_m:+,.0f} m in run-out ({observed.length_m:,.0f} m mapped)"
    lacks = mass(observed.volume_m3, observed.released_m3)
    return [text, *([lacks.text] if lacks else [])]


def mass(volume: Optional[float], released: float) -> Optional[Finding]:
    """That a mapped volume (m3) cannot be that of the released mass; None where it can, or is not known."""
    if volume is None or abs(volume - released) <= SAME_MASS * released:
        return None
    share = 100 * (volume - released) / released
    return Finding("other mass", {"percent": abs(share), "which": "more" if share > 0 else "less", "mapped": volume,
                                  "released": released})
