"""How far a mass goes, by its runs and by known events together: both count half (a linear pool; Stone, Annals of
Mathematical Statistics, 32, 1339 (1961)), so that its quantiles lie between theirs. Lengths are along the fall path."""
import math
from dataclasses import dataclass
from typing import Optional, Sequence, Tuple

import numpy as np

from .exceedance import Mobility
from .run_length import ON_PATH

TAIL = 0.05             # of the pool, which ends before near_m and goes beyond far_m
BAND = 0.1              # of each of both, whose bands may lie apart


@dataclass(frozen=True)
class Reach:
    """What half of the pool, and TAIL at either end, stay within; None: they go beyond the terrain (end_m).

    runs: how many, of which study (entries.Source; None: a run alone); along: run_length.ON_PATH or STRAIGHT; events:
    whether known events count; why: not; farther: who goes farther, where the bands lie apart; least_m: nearer the
    events tell nothing.
    """
    near_m: Optional[float]
    middle_m: Optional[float]
    far_m: Optional[float]
    end_m: Optional[float]
    least_m: float
    runs: int
    source: Optional[str]
    along: str
    events: bool
    why: str
    farther: Optional[str]


def pool(lengths: Sequence[float], known: Optional[Mobility], source: Optional[str] = None, along: str = ON_PATH,
         why: str = "") -> Optional[Reach]:
    """lengths: of runs (m), infinite where a run left the terrain; the others as of Reach. None without a run."""
    if not lengths:
        return None
    if known is not None and not known.in_range:
        why = "; ".join(known.outside)
        known = None
    near, middle, far = (quantile(lengths, known, share) for share in (TAIL, 0.5, 1 - TAIL))
    finite = [one for one in lengths if np.isfinite(one)]
    longest = max(finite, default=0.0)
    return Reach(near, middle, far, known.end(longest) if known else None, said_from(known), len(lengths),
                 source, along, known is not None, why, farther(lengths, known) if known else None)


def quantile(lengths: Sequence[float], known: Optional[Mobility], share: float) -> Optional[float]:
    """The length (m) that a share of the pool stays within; None where that goes beyond the terrain."""
    runs = np.sort(np.asarray(lengths, float))
    at = np.unique(np.append(known.path.length, runs[np.isfinite(runs)])) if known else runs[np.isfinite(runs)]
    before, after = np.searchsorted(runs, at) / len(runs), np.searchsorted(runs, at, "right") / len(runs)
    if known:
        ended = 1 - np.interp(at, known.path.length, known.curves[known.chosen])
        before, after = (before + ended) / 2, (after + ended) / 2
    found = np.flatnonzero(after >= share - 1e-12)
    if not len(found):
        return None
    k = int(found[0])
    if k and known and before[k] > share:      # between two points, where no run ends
        return float(np.interp(share, [after[k - 1], before[k]], at[k - 1:k + 1]))
    return float(at[k])


def said_from(known: Optional[Mobility]) -> float:
    """The length (m) at which the events begin to say something, where some of them end before; else 0."""
    if known is None or not known.said.any():
        return 0.0
    first = int(np.argmax(known.said))
    return float(known.path.length[first]) if known.curves[known.chosen][first] < 1 else 0.0


def farther(lengths: Sequence[float], known: Mobility) -> Optional[str]:
    """Who goes farther, where the middle of each lies outside of what nine tenths of the other go beyond, and a tenth;
    None: neither."""
    several = np.sort(np.asarray(lengths, float))
    middle = float(np.median(several))
    near, half, far = (bounds(known, share) for share in (1 - BAND, 0.5, BAND))
    if half[0] > several[-1] and near[0] > middle:
        return "known events"
    return "the runs" if half[1] < several[0] and far[1] < middle else None


def bounds(known: Mobility, share: float) -> Tuple[float, float]:
    """Between which lengths (m) that lies which a share of known events goes beyond; twice the same where it is known.
    """
    most, length = known.at_most(share), known.length_at(share)
    if most is not None:
        return 0.0, most
    return (float(known.path.length[-1]), math.inf) if length is None else (length, length)
