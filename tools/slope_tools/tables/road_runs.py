"""The stretches of a road that the runs of a study block: how likely each is, and what it takes, over the runs.

A stretch of a study is a largest range of chainages each of which a run blocks. A run that does not block it takes
nothing there. Quantiles are of the runs, by their weights: the value that 5, 50 or 95 % of them stay within.
"""
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Sequence

import numpy as np

from ..deposits.axis import SAME, Span, merged
from ..statistics.hazard import weighted
from . import study_types

SHARES = (0.05, 0.5, 0.95)
SUMS = ("remove", "remove_lane", "hours", "hours_lane")     # of the stretches of a run
FILE = "stretches.csv"


class Run(NamedTuple):
    """What a run says of a road, as volume.yaml has it."""
    weight: float
    stretches: Sequence[Mapping[str, Any]]
    totals: Mapping[str, Any]


def evaluate(runs: Sequence[Run]) -> study_types.Stretches:
    """What study.yaml has of the road; there must be a run."""
    weights = np.array([run.weight for run in runs])
    weights = weights / weights.sum()
    blocked = [np.array([(one["from"], one["to"]) for one in run.stretches]).reshape(-1, 2) for run in runs]
    spans = merged([Span(*one) for ends in blocked for one in ends.tolist()], SAME)
    totals = quantiles([{"length": run.totals["blocked_length"],
                         **{name: run.totals[name] for name in SUMS if name in run.totals}} for run in runs], weights)
    return study_types.Stretches(len(runs), float(weights @ [len(ends) > 0 for ends in blocked]), totals,
                                 [stretch(span, runs, weights) for span in spans], shares(blocked, weights))


def stretch(span: Span, runs: Sequence[Run], weights: np.ndarray) -> Dict[str, Any]:
    """Of a range of chainages (m): the share of the runs that block any of it, and the quantiles of what it takes."""
    inside = [[one for one in run.stretches if span.low - SAME <= one["from"] <= span.high + SAME] for run in runs]
    numbers = [{"length": sum(one["to"] - one["from"] for one in several),
                "passable_width": min((one["passable_width"] for one in several), default=run.totals["road_width"]),
                **{name: sum(one[name] for one in several) for name in SUMS if name in run.totals}}
               for run, several in zip(runs, inside)]
    return {"from": span.low, "to": span.high, "share": float(weights @ [bool(several) for several in inside]),
            **quantiles(numbers, weights)}


def quantiles(numbers: Sequence[Mapping[str, float]], weights: np.ndarray) -> Dict[str, List[float]]:
    """Of each number of the runs, in the order of SHARES."""
    return {name: weighted(np.array([one[name] for one in numbers]), weights, SHARES) for name in numbers[0]}


def shares(blocked: Sequence[np.ndarray], weights: np.ndarray) -> List[List[float]]:
    """From, to (m) and the share of the runs that block the road there, where any does; of neighbours it differs."""
    ends = np.unique(np.concatenate([one.ravel() for one in blocked]))
    found: List[List[float]] = []
    for low, high in zip(ends[:-1], ends[1:]):
        middle = (low + high) / 2
        share = float(weights @ [((one[:, 0] < middle) & (middle < one[:, 1])).any() for one in blocked])
        if found and found[-1][1] == low and abs(found[-1][2] - share) < 1e-12:
            found[-1][1] = float(high)
        elif share > 0:
            found.append([float(low), float(high), share])
    return found


def rows(about: study_types.Stretches) -> Iterator[List[Any]]:
    """Names, then a line for each stretch of evaluate(); of the last one, all of them, the range is empty."""
    names = [name for name in ("length", "passable_width", *SUMS) if name in about.totals or
             name == "passable_width" and about.stretches]
    yield ["stretch", "from", "to", "share", *(f"{name}_{100 * share:g}" for name in names for share in SHARES)]
    for number, one in enumerate(about.stretches, 1):
        yield [number, one["from"], one["to"], one["share"], *(value for name in names for value in one[name])]
    nothing = [None] * len(SHARES)
    yield ["all", None, None, about.share_blocked,
           *(value for name in names for value in about.totals.get(name, nothing))]
