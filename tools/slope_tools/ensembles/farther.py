"""Runs that an ensemble adds where known events go beyond its longest run: where they lie, and how they count.

A design covers the parameters evenly, so that few of its runs are mobile. Batches of points are added, each even in a
box of the unit cube in which an emulator of the length expects longer runs than the longest so far. So the density of
all points is known: n0 points of the design, of density 1, and m points of each box, of density 1 over its volume. A
point counts by the density of the design over that of the mixture (the balance heuristic: Veach and Guibas,
SIGGRAPH 1995); among runs of one length the parameters then have the distribution that was given.

Boxes may go beyond the bounds of uniform distributions, up to wider ones (distributions.Range.widened). The density
that was given goes on there as it is within: all of the wide box is equally likely, and the design has points in a part
of it.
"""
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence

import numpy as np
import yaml

from .. import disk, schemas
from ..digits import metres, percent
from ..schemas import NUMBER, OBJECT, TEXT, list_of, mapping, dict_of
from ..statistics import backanalysis, designs, distributions, emulator
from ..statistics.entries import Code, Reason
from ..tables import ensemble_types
from .sample import Sample

FILE = "added.yaml"
WHAT = "what `slope study --known` wrote"
SCHEMA = mapping({"variables": OBJECT, "batches": list_of(mapping({
    "box": list_of(list_of(NUMBER, 2), 1), "points": list_of(dict_of(TEXT, 1), 1)}))})
REACHED = 0.95          # share of the known events that the runs should reach
NEAR_END = 0.025        # share of them between the longest run and the end of the path: no run can go much farther
PART = 8                # a batch is this part of the design
LEAST = 4               # points of a batch
MOST = 1.0              # points that may be added, over those of the design
CLOUD = 4096            # points at which the emulator is looked at
FITTED = 100            # runs that it is fitted to, of the longest; about as many of the others
FEW, MANY = 32, 205     # of them, whose box is taken: at least, and at most
NARROW = 0.5            # of a range: a box that is wider does not depend on it
STEP = 0.05             # the sides of a box are multiples of it
ROUNDING = 1e-5         # of a value that is written with six digits, in the cube


class End(NamedTuple):
    """Of the fall path: its length (m), and the share of the known events that go beyond it."""
    length: float
    share: float


class Batch(NamedTuple):
    """Points (values for the deck) that are even in a box, (low, high) of each variable in the unit cube."""
    box: List[List[float]]
    points: List[Dict[str, str]]

    @property
    def volume(self) -> float:
        return float(np.prod([high - low for low, high in self.box]))

    def holds(self, places: np.ndarray) -> np.ndarray:
        low, high = np.array(self.box).T
        return ((places >= low - ROUNDING) & (places <= high + ROUNDING)).all(axis=1)


def ratio(places: np.ndarray, batch: Sequence[int], batches: Sequence[Batch]) -> np.ndarray:
    """Density of the design over that of all points, at each of them; batch: which one it is of, from 1; 0: none."""
    count = np.bincount(np.asarray(batch, int), minlength=len(batches) + 1)
    density = count[0] * Batch([[0.0, 1.0]] * places.shape[1], []).holds(places).astype(float)
    for number, one in zip(count[1:], batches):
        density += number * one.holds(places) / one.volume
    return len(places) / density


@dataclass(frozen=True)
class Added:
    """The batches of an ensemble, beside the points of its design (sample).

    stopped: why no more are added, though the runs do not reach far enough; None where they do.
    """
    sample: Sample
    batches: Sequence[Batch] = ()
    stopped: Optional[Reason] = None

    @property
    def number(self) -> int:
        """Points that were added."""
        return sum(len(one.points) for one in self.batches)

    def text(self, batch: Batch) -> str:
        """Where a batch lies, in words."""
        parts = [f"{one.name} {backanalysis.format_variable_value(one, low)} to "
                 f"{backanalysis.format_variable_value(one, high)}"
                 for one, (low, high) in zip(self.sample.variables, batch.box)
                 if low > one.places[0] + ROUNDING or high < one.places[1] - ROUNDING]
        return ", ".join(parts) or "all of their ranges"

    def ends(self, box: List[List[float]]) -> Dict[str, str]:
        """The variables at an end of whose ranges a box lies, and that end; not one that hardly matters for it."""
        found = {}
        for one, (low, high) in zip(self.sample.variables, box):
            least, most = low <= one.places[0] + ROUNDING, high >= one.places[1] - ROUNDING
            if least != most and high - low <= NARROW * (one.places[1] - one.places[0]):
                found[one.name] = backanalysis.format_variable_value(one, low if least else high)
        return found

    def line(self, batch: Batch, lengths: np.ndarray, beyond: np.ndarray) -> str:
        """What is done, for the console."""
        return (f"no run goes beyond {metres(float(max(lengths)))}; {percent(float(min(beyond)))} of known "
                f"events do; {len(batch.points)} more points towards {self.text(batch)}")

    def about(self) -> ensemble_types.Added:
        """What study.yaml says of it."""
        return ensemble_types.Added(self.number, self.stopped,
                                    [{"points": len(one.points), "ranges": self.text(one)} for one in self.batches])


# --- of a folder, in which they are kept, so that the study can be continued ---

def read_added_runs(folder: Path, sample: Sample) -> Added:
    """Those of a sample, none of another one; SlopeError if the file is none."""
    if not (folder / FILE).is_file():
        return Added(sample)
    before = schemas.load_checked(folder / FILE, f"{WHAT} (remove it)", SCHEMA)
    same = before["variables"] == sample.about.variables
    return Added(sample, [Batch(one["box"], one["points"]) for one in before["batches"]] if same else [])


def write_added_runs(folder: Path, added: Added) -> None:
    """Write the batches, before they are run."""
    disk.write_file(folder / FILE, f"# {WHAT}: sides of the boxes as shares of the distributions\n" + yaml.safe_dump(
        {"variables": added.sample.about.variables, "batches": [one._asdict() for one in added.batches]},
        sort_keys=False))


# --- which runs come next ---

class Longer(NamedTuple):
    """A box around the places where runs are expected to be longer than all so far.

    more: whether any place is expected to be longer than all runs but one, as that one may be far longer by chance.
    """
    box: List[List[float]]
    more: bool


def next_runs(added: Added, places: np.ndarray, lengths: np.ndarray, beyond: np.ndarray, end: End,
              expect: Callable[[], Longer]) -> Added:
    """The same with one more batch, if known events go farther than the runs and parameters can; else with the reason.

    places, lengths (m): of all runs so far; beyond: share of the known events that go beyond each; end: of the fall
    path; expect: gives longer() of these places and lengths, which takes long.
    """
    def stopped(code: Code, **numbers: Any) -> Added:
        return replace(added, stopped=Reason(code, numbers))

    sample, far = added.sample, float(np.min(beyond))
    left = int(MOST * sample.number) - added.number
    if far < 1 - REACHED:
        return replace(added, stopped=None)
    if max(lengths) >= end.length or far - end.share < NEAR_END:
        return stopped(Code.TERRAIN, share=end.share, path_m=end.length)
    if not emulator.enough(len(lengths), places.shape[1]):
        return stopped(Code.FEW)
    if left <= 0:
        return stopped(Code.RUNS, points=added.number)
    box, more = expect()
    if not more:
        return stopped(Code.RANGE, ends=added.ends(box))
    number = min(left, max(LEAST, sample.number // PART))
    low, high = np.array(box).T
    drawn = designs.points(designs.SOBOL, len(box), number, sample.seed + 1 + len(added.batches))
    batch = Batch(box, [{one.name: one.value(u) for one, u in zip(sample.variables, point)}
                        for point in low + (high - low) * drawn])
    return Added(sample, [*added.batches, batch])


def longer(places: np.ndarray, lengths: np.ndarray, sample: Sample) -> Longer:
    """Of CLOUD places; expected is the emulator's mean and a deviation: its own, as it knows little in corners without
    runs, with chance, as the longest run may owe its length to it."""
    order = np.argsort(-lengths, kind="stable")
    # the fit takes the cube of their number: the longest, and an even choice of the others
    taken = np.concatenate([order[:FITTED], order[FITTED::max(1, len(order) // FITTED)]])
    fitted = emulator.Emulator(places[taken], np.log10(lengths[taken]))
    least, most = sample.box.T
    cloud = sample.snap(least + (most - least) * designs.points(designs.SOBOL, len(least), CLOUD, emulator.SEED))
    mean, deviation = fitted.spread(cloud)
    expected = mean + np.hypot(deviation, fitted.noise)
    longest, second = np.log10(lengths[order[:2]])
    number = int((expected > longest).sum())
    best = cloud[np.argsort(-expected, kind="stable")[:min(max(number, FEW), MANY)]]
    low = np.maximum(np.floor(best.min(axis=0) / STEP) * STEP, least)
    high = np.minimum(np.ceil(best.max(axis=0) / STEP) * STEP, most)
    return Longer([[0.0, 1.0] if isinstance(one, distributions.Listed) else [round(float(a), 6), round(float(b), 6)]
                   for one, a, b in zip(sample.variables, low, high)], bool(expected.max() > second))
