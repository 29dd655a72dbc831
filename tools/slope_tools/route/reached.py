"""Who hits what: which bodies reach each cell of a ground, with which share of their runs.

Cells that the same bodies reach with the same shares have one code, the index of a set: sets are far fewer than cells.
"""
import functools
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..case import run_folders
from ..errors import SlopeError
from ..geometry import extent_of
from ..statistics import hazard
from ..survey.rasters import Raster
from .yearly import Yearly

DIGITS = 9          # of a share


class Source(NamedTuple):
    """The runs of a body."""
    body: int
    prefixes: Sequence[Path]
    weights: np.ndarray             # of the runs, their sum is 1
    failed: int                     # runs that gave nothing
    offset: Tuple[float, float]     # east, north of the runs' local 0 0
    effect: float = 1.0             # how many runs are worth one: those of a point

    @property
    def worth(self) -> float:
        """How many independent runs of one weight these are worth."""
        return float(1 / (self.weights ** 2).sum()) / self.effect

    def bounds(self, share: float) -> Tuple[float, float]:
        """Of a share of the runs."""
        return bounds(round(float(share), DIGITS), round(self.worth, DIGITS), self.failed / self.effect)


@functools.lru_cache(maxsize=None)
def bounds(share: float, number: float, failed: float) -> Tuple[float, float]:
    low, high = hazard.share_bounds(share * number, number, failed)      # type: ignore[arg-type]
    return float(low), float(high)


class Combined(NamedTuple):
    """What several bodies do: the share that counts with its bounds, given failure, of which body, and per year."""
    share: float
    body: int
    low: float
    high: float
    per_year: Optional[Dict[str, float]]


def combined(sources: Sequence[Source], shares_: Sequence[float], yearly: Optional[Yearly]) -> Combined:
    """Of shares of the runs of bodies: the largest one, given that its body fails; with a hazard also how often."""
    numbers = [one.body for one in sources]
    low, high = ([one.bounds(share)[side] for one, share in zip(sources, shares_)] for side in (0, 1))
    if yearly is None:
        best = int(np.argmax(shares_))
        return Combined(shares_[best], numbers[best], max(low), max(high), None)
    best = int(np.argmax([yearly.of([number], [share]).counts for number, share in zip(numbers, shares_)]))
    found = yearly.of(numbers, shares_)
    return Combined(shares_[best], numbers[best], low[best], high[best], {
        "independent": found.independent, "dependent": found.dependent, "counts": found.counts,
        "low": yearly.of(numbers, low).least, "high": yearly.of(numbers, high).most})


def of_set(members: Sequence[Tuple[int, float]], sources: Sequence[Source],
           yearly: Optional[Yearly]) -> Optional[Combined]:
    """What the bodies and shares of a set of Reached do together; None of no body."""
    by_number = {source.body: source for source in sources}
    return combined([by_number[number] for number, _ in members], [share for _, share in members],
                    yearly) if members else None


class Reached(NamedTuple):
    """codes: of each cell, an index of sets; sets: ((body, share), ...), the first one of no body."""
    codes: np.ndarray
    sets: List[Tuple[Tuple[int, float], ...]]


def combine_reached(sources: Sequence[Source], ground: Raster, kind: str, limit: float) -> Reached:
    """Which bodies exceed a limit of a raster of fix deposit/grid (its kind) in the cells of a ground."""
    codes = np.zeros(ground.z.shape, np.int32)
    sets: List[Tuple[Tuple[int, float], ...]] = [()]
    for source in sources:
        where, share = compute_reached_shares(source, ground, kind, limit)
        if not len(share):
            continue
        known, index = np.unique(share, return_inverse=True)
        pairs, inverse = np.unique(codes[where].astype(np.int64) * len(known) + index, return_inverse=True)
        first = len(sets)
        sets += [(*sets[pair // len(known)], (source.body, float(known[pair % len(known)]))) for pair in pairs.tolist()]
        codes[where] = first + inverse
    return Reached(codes, sets)


def compute_reached_shares(source: Source, ground: Raster, kind: str, limit: float):
    """Rows and columns of the cells of a ground that runs reach, and the share of the runs that do."""
    total: Optional[np.ndarray] = None
    for prefix, weight in zip(source.prefixes, source.weights):
        raster = run_folders.load_raster(prefix, kind, heights=False)
        if total is None:
            total, transform = np.zeros(raster.z.shape), raster.transform
        if raster.z.shape != total.shape or raster.transform != transform:
            raise SlopeError(f"{prefix}.{kind}.asc", f"must have the grid of {source.prefixes[0]}, as its cells are "
                             "counted with those")
        total += weight * (np.nan_to_num(raster.z) > limit)
    shares = np.zeros((0, 0)) if total is None else total
    if not shares.any():
        return np.nonzero(shares), np.zeros(0)
    # the cells of the ground in the box of those, each of which has the value of the run's cell that its middle is in
    move = np.array(source.offset) - ground.offset
    xlo, ylo, xhi, yhi = extent_of(transform, shares) + np.tile(move, 2)
    (left, top), (right, bottom) = ~ground.transform @ (xlo, yhi), ~ground.transform @ (xhi, ylo)
    rows, columns = ground.z.shape
    rows_, columns_ = np.mgrid[max(0, int(top)):min(rows, int(np.ceil(bottom))),
                               max(0, int(left)):min(columns, int(np.ceil(right)))]
    x, y = ground.transform @ (columns_ + 0.5, rows_ + 0.5)
    at_column, at_row = ~transform @ (x - move[0], y - move[1])
    at_row, at_column = np.floor(at_row).astype(int), np.floor(at_column).astype(int)
    there = (at_row >= 0) & (at_row < shares.shape[0]) & (at_column >= 0) & (at_column < shares.shape[1])
    share = np.zeros(rows_.shape)
    share[there] = np.round(shares[at_row[there], at_column[there]], DIGITS)
    hit = share > 0
    return (rows_[hit], columns_[hit]), share[hit]
