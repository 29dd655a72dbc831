"""The stretches of a road that the runs of a study block: how likely each is, and what it takes, over the runs.

A stretch of a study is a largest range of chainages each of which a run blocks. A run that does not block it takes
nothing there. Quantiles are of the runs, by their weights: the value that 5, 50 or 95 % of them stay within.
"""
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Sequence, Tuple

import numpy as np
from shapely.geometry import MultiLineString

from .. import disk
from ..deposits.axis import SAME, Axis, Span, merged
from ..deposits.road_axis import EACH
from ..quantiles import within
from ..survey.geopackage import Layer
from . import study_types

SHARES = (0.05, 0.5, 0.95)
SUMS = ("remove", "remove_lane", "hours", "hours_lane")     # of the stretches of a run
FILE = "stretches.csv"
BODIES = "bodies_along"                                     # .csv, and a layer
OF_BODIES = {"from_m": "float", "to_m": "float", "body": "str", "mean_m3": "float", "bodies": "str"}


class Run(NamedTuple):
    """What a run says of a road, as volume.yaml has it."""
    weight: float
    stretches: Sequence[Mapping[str, Any]]
    totals: Mapping[str, Any]


def evaluate_road_runs(runs: Sequence[Run]) -> study_types.Stretches:
    """What study.yaml has of the road; there must be a run."""
    weights = np.array([run.weight for run in runs])
    weights = weights / weights.sum()
    blocked = [np.array([(one["from"], one["to"]) for one in run.stretches]).reshape(-1, 2) for run in runs]
    spans = merged([Span(*one) for ends in blocked for one in ends.tolist()], SAME)
    totals = compute_road_quantiles([{"length": run.totals["blocked_length"],
                                      **{name: run.totals[name] for name in SUMS if name in run.totals}} for run
                                     in runs], weights)
    return study_types.Stretches(len(runs), float(weights @ [len(ends) > 0 for ends in blocked]), totals,
                                 [stretch(span, runs, weights) for span in spans],
                                 compute_blocked_shares(blocked, weights))


def stretch(span: Span, runs: Sequence[Run], weights: np.ndarray) -> Dict[str, Any]:
    """Of a range of chainages (m): the share of the runs that block any of it, and the quantiles of what it takes."""
    inside = [[one for one in run.stretches if span.low - SAME <= one["from"] <= span.high + SAME] for run in runs]
    numbers = [{"length": sum(one["to"] - one["from"] for one in several),
                "passable_width": min((one["passable_width"] for one in several), default=run.totals["road_width"]),
                **{name: sum(one[name] for one in several) for name in SUMS if name in run.totals}}
               for run, several in zip(runs, inside)]
    return {"from": span.low, "to": span.high, "share": float(weights @ [bool(several) for several in inside]),
            **compute_road_quantiles(numbers, weights)}


def compute_road_quantiles(numbers: Sequence[Mapping[str, float]], weights: np.ndarray) -> Dict[str, List[float]]:
    """Of each number of the runs, in the order of SHARES."""
    return {name: within([one[name] for one in numbers], weights, SHARES).tolist() for name in numbers[0]}


def compute_blocked_shares(blocked: Sequence[np.ndarray], weights: np.ndarray) -> List[List[float]]:
    """From, to (m) and the share of the runs that block the road there, where any does; of neighbours it differs."""
    ends = np.unique(np.concatenate([one.ravel() for one in blocked]))
    pieces: List[List[float]] = []
    for low, high in zip(ends[:-1], ends[1:]):
        middle = (low + high) / 2
        share = float(weights @ [((one[:, 0] < middle) & (middle < one[:, 1])).any() for one in blocked])
        if pieces and pieces[-1][1] == low and abs(pieces[-1][2] - share) < 1e-12:
            pieces[-1][1] = float(high)
        elif share > 0:
            pieces.append([float(low), float(high), share])
    return pieces


def by_body(bodies: Mapping[Any, Sequence[Tuple[float, Sequence[Sequence[float]]]]]) -> List[Dict[str, Any]]:
    """OF_BODIES of each 10 m of the road: the body whose runs leave most on it, on the mean, given that it fails.

    bodies: of each the weights of its runs and what each leaves, as rows.OnRoad has it.
    """
    means: Dict[float, Dict[Any, float]] = {}
    for body, several in bodies.items():
        whole = sum(weight for weight, _ in several)
        for weight, parts in several:
            for start, volume in parts:
                here = means.setdefault(start, {})
                here[body] = here.get(body, 0.0) + volume * weight / whole
    return [{"from_m": start, "to_m": start + EACH, "body": str(max(here, key=lambda body: here[body])),
             "mean_m3": max(here.values()), "bodies": " ".join(f"{body}:{mean:.4g}" for body, mean in here.items())}
            for start, here in sorted(means.items())]


def table_of_bodies(entries: Sequence[Mapping[str, Any]]) -> str:
    """As CSV."""
    return disk.csv_text(OF_BODIES, ([one[name] for name in OF_BODIES] for one in entries))


def layer_of_bodies(entries: Sequence[Mapping[str, Any]], axes: Sequence[Axis]) -> Layer:
    """For a GIS."""
    def lines(row: Mapping[str, Any]) -> MultiLineString:
        spans = [(axis, Span(max(row["from_m"], axis.s[0]), min(row["to_m"], axis.s[-1]))) for axis in axes]
        return MultiLineString([axis.line(span) for axis, span in spans if span.high - span.low > SAME])
    return Layer("MultiLineString", OF_BODIES, ((lines(one), one) for one in entries))


def rows(stretches: study_types.Stretches) -> Iterator[List[Any]]:
    """Names, then a line for each stretch of evaluate_road_runs(); of the last one, all of them, the range is empty."""
    names = [name for name in ("length", "passable_width", *SUMS) if name in stretches.totals or
             name == "passable_width" and stretches.stretches]
    yield ["stretch", "from", "to", "share", *(f"{name}_{100 * share:g}" for name in names for share in SHARES)]
    for number, one in enumerate(stretches.stretches, 1):
        yield [number, one["from"], one["to"], one["share"], *(value for name in names for value in one[name])]
    nothing = [None] * len(SHARES)
    yield ["all", None, None, stretches.share_blocked,
           *(value for name in names for value in stretches.totals.get(name, nothing))]
