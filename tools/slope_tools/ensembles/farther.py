"""Runs that an ensemble adds where known events go beyond its longest run: where they lie, and how they count.

A design covers the parameters evenly, so that few of its runs are mobile. Batches of points are added, each even in a
box of the unit cube in which an emulator of the length expects longer runs than the longest so far. So the density of
all points is known: n0 points of the design, of density 1, and m points of each box, of density 1 over its volume. A
point counts by the density of the design over that of the mixture (the balance heuristic: Veach and Guibas,
SIGGRAPH 1995); among runs of one length the parameters then have the distribution that was given.
"""
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

import numpy as np
import yaml

from .. import disk, schemas
from ..digits import rounded
from ..mobility.results import percent
from ..schemas import NUMBER, OBJECT, TEXT, listed, mapping, named
from ..statistics import backanalysis, designs, distributions, emulator
from .sample import Sample

FILE = "added.yaml"
WHAT = "what `slope study --known` wrote"
SCHEMA = mapping({"variables": OBJECT, "batches": listed(mapping({
    "box": listed(listed(NUMBER, 2), 1), "points": listed(named(TEXT, 1), 1)}))})
REACHED = 0.95          # share of the known events that the runs should reach
PART = 8                # a batch is this part of the design
LEAST = 4               # points of a batch
MOST = 0.5              # points that may be added, over those of the design
CLOUD = 4096            # points at which the emulator is looked at
FITTED = 100            # runs that it is fitted to, of the longest; about as many of the others
FEW, MANY = 32, 205     # of them, whose box is taken: at least, and at most
STEP = 0.05             # the sides of a box are multiples of it
ROUNDING = 1e-5         # of a value that is written with six digits, in the cube


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
    density = np.full(len(places), float(count[0]))
    for number, one in zip(count[1:], batches):
        density += number * one.holds(places) / one.volume
    return len(places) / density


class Added:
    """The batches of an ensemble in a folder; a file keeps them, so that the study can be continued.

    stopped: why no more are added, though the runs do not reach far enough; empty where they do.
    """

    def __init__(self, folder: Path, sample: Sample):
        self.path, self.sample = folder / FILE, sample
        self.batches: List[Batch] = []
        self.stopped = ""
        if self.path.is_file():
            before = schemas.load(self.path, f"{WHAT} (remove it)", SCHEMA)
            if before["variables"] == sample.about["variables"]:
                self.batches = [Batch(one["box"], one["points"]) for one in before["batches"]]

    @property
    def number(self) -> int:
        """Points that were added."""
        return sum(len(one.points) for one in self.batches)

    def keep(self) -> None:
        """Write the batches, before they are run."""
        disk.write(self.path, f"# {WHAT}: sides of the boxes as shares of the distributions\n" + yaml.safe_dump(
            {"variables": self.sample.about["variables"], "batches": [one._asdict() for one in self.batches]},
            sort_keys=False))

    def propose(self, places: np.ndarray, lengths: np.ndarray, beyond: np.ndarray, path_m: float) -> Optional[Batch]:
        """The next batch, if known events go farther than the runs and parameters can; None where no more is added.

        places, lengths (m): of all runs so far; beyond: share of the known events that go beyond each; path_m: length
        of the fall path.
        """
        far, short = float(np.min(beyond)), 1 - float(np.max(beyond))
        self.stopped = ""
        if far + short <= 1 - REACHED or far <= (1 - REACHED) / 2:
            return None
        left = int(MOST * self.sample.number) - self.number
        box = None
        if max(lengths) >= path_m:
            self.stopped = "the fall path, or the terrain, ends there: take a larger terrain"
        elif not emulator.enough(len(lengths), places.shape[1]):
            self.stopped = "the runs are too few to tell which parameters go farther: take more points"
        elif left <= 0:
            self.stopped = f"{self.number} runs were added; a larger --sample allows more"
        else:
            box = box_of(places, lengths, self.sample)
            if box is None:
                self.stopped = "no values within --vary are expected to: give wider ranges"
        if box is None:
            return None
        number = min(left, max(LEAST, self.sample.number // PART))
        low, high = np.array(box).T
        drawn = designs.points(designs.SOBOL, len(box), number, self.sample.seed + 1 + len(self.batches))
        batch = Batch(box, [{one.name: one.value(u) for one, u in zip(self.sample.variables, point)}
                            for point in low + (high - low) * drawn])
        self.batches.append(batch)
        return batch

    def text(self, batch: Batch) -> str:
        """Where a batch lies, in words."""
        parts = [f"{one.name} {backanalysis.shown(one, low)} to {backanalysis.shown(one, high)}"
                 for one, (low, high) in zip(self.sample.variables, batch.box) if high - low < 1]
        return ", ".join(parts) or "all of their ranges"

    def line(self, batch: Batch, lengths: np.ndarray, beyond: np.ndarray) -> str:
        """What is done, for the console."""
        return (f"no run goes beyond {rounded(float(max(lengths)), 4)} m; {percent(float(min(beyond)))} of known "
                f"events do; {len(batch.points)} more points towards {self.text(batch)}")

    def about(self) -> Dict[str, Any]:
        """What study.yaml says of it."""
        return {"points": self.number, "stopped": self.stopped,
                "batches": [{"points": len(one.points), "ranges": self.text(one)} for one in self.batches]}


def box_of(places: np.ndarray, lengths: np.ndarray, sample: Sample) -> Optional[List[List[float]]]:
    """The box around where runs are expected to be the longest, and longer than all so far; None: nowhere.

    Expected is the emulator's mean and a deviation: its own, as it knows little in corners without runs, with chance,
    as the longest run may owe its length to it.
    """
    order = np.argsort(-lengths, kind="stable")
    # the fit takes the cube of their number: the longest, and an even choice of the others
    taken = np.concatenate([order[:FITTED], order[FITTED::max(1, len(order) // FITTED)]])
    fitted = emulator.Emulator(places[taken], np.log10(lengths[taken]))
    cloud = sample.snap(designs.points(designs.SOBOL, places.shape[1], CLOUD, emulator.SEED))
    mean, deviation = fitted.spread(cloud)
    expected = mean + np.hypot(deviation, fitted.noise)
    number = int((expected > np.log10(max(lengths))).sum())
    if number == 0:
        return None
    best = cloud[np.argsort(-expected, kind="stable")[:min(max(number, FEW), MANY)]]
    low = np.floor(best.min(axis=0) / STEP) * STEP
    high = np.ceil(best.max(axis=0) / STEP) * STEP
    return [[0.0, 1.0] if isinstance(one, distributions.Listed) else [round(float(a), 6), round(float(b), 6)]
            for one, a, b in zip(sample.variables, low, high)]
