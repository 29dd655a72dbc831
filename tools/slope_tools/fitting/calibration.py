"""The runs of a calibration, batch by batch: a ledger keeps the proposed points, so that it can be continued."""
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Sequence

import numpy as np
import yaml

from .. import disk, schemas
from ..deposits import travel_shares
from ..errors import SlopeError
from ..runs import repeats
from ..schemas import OBJECT, TEXT, list_of, mapping
from ..statistics import backanalysis

LEDGER = "calibrate.ledger.yaml"
WHAT = "what `slope calibrate` wrote"


class Ledger:
    """The points that were decided on, in their order, with the values of the variables as text.

    about: what the calibration is of; a folder with another one is refused.
    """

    def __init__(self, folder: Path, summary: Mapping[str, Any], variables: Sequence):
        self.path, self.about, self.variables = folder / LEDGER, dict(summary), list(variables)
        self.points: List[Dict[str, str]] = []
        if self.path.is_file():
            before = schemas.load_checked(self.path, WHAT, mapping({"about": OBJECT, "points": list_of(OBJECT)}))
            if before["about"] != self.about:
                raise SlopeError(self.path, "must be of the same observation, variables and seed: give another -o")
            point = mapping({one.name: TEXT for one in self.variables})
            schemas.check_schema(before["points"], list_of(point), self.path, WHAT)
            self.points = before["points"]

    def point(self, place: np.ndarray) -> Dict[str, str]:
        """The values of a place in the unit cube."""
        return {one.name: one.value(float(u)) for one, u in zip(self.variables, place)}

    def ends_with(self, place: np.ndarray) -> bool:
        return self.points[-1] == self.point(place)

    def replace_last(self, place: np.ndarray) -> None:
        self.points.pop()
        self.add(place[None])

    def add(self, places: np.ndarray) -> None:
        """Decide on places in the unit cube; written before they are run."""
        self.points += map(self.point, places)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        disk.write_file(self.path, f"# {WHAT}\n" + yaml.safe_dump({"about": self.about, "points": self.points},
                                                                  sort_keys=False))

    def places(self, of: Sequence[int]) -> np.ndarray:
        """Where points of some numbers lie in the unit cube."""
        return np.array([[one.unit(self.points[i][one.name]) for one in self.variables] for i in of])


class Calibration:
    """Runs batch after batch, until there are `number`; the last of them is at the best values.

    evaluate(runs): makes runs and gives the outputs of each, None of one that failed. targets(): the Targets, known
    after the first runs. say: called with a line now and then.
    """

    def __init__(self, ledger: Ledger, output: Path, fixed: Mapping[str, str], chances: Sequence[Mapping[str, str]],
                 seed: int, number: int, batch: int):
        self.ledger, self.output, self.fixed, self.seed = ledger, output, dict(fixed), seed
        self.chances: List[Dict[str, str]] = [{}, *(dict(one) for one in chances)]
        self.number, self.batch = number, batch
        self.outputs: Dict[int, Any] = {}       # number of the run -> its outputs, None of one that failed
        self.runs: List[repeats.Repeat] = []
        if len(ledger.points) > number:
            raise SlopeError("--runs", f"must be at least what {ledger.path} has, {len(ledger.points)}", number)

    def begin(self) -> List[repeats.Repeat]:
        """Decide on the first points, if that was not done; the runs that are known of."""
        if not self.ledger.points:
            dimensions = len(self.ledger.variables)
            self.ledger.add(backanalysis.first(dimensions, self.seed)[:self.number - 1])
        return self._known()

    def _known(self) -> List[repeats.Repeat]:
        for i in range(len(self.runs), len(self.ledger.points)):
            self.runs.append(repeats.Repeat(self.output, {**self.fixed, **self.ledger.points[i]},
                                            self.chances[i % len(self.chances)]))
        return self.runs

    def replace(self, run: repeats.Repeat, other: repeats.Repeat) -> None:
        """Let another run stand for a point, such as a longer one."""
        self.runs[self.runs.index(run)] = other

    def do(self, evaluate: Callable, targets: Callable, say: Callable[[str], None]) -> backanalysis.Posterior:
        """Make all runs; returns what they show of the variables, without the last one, which uses the best values."""
        self.begin()
        while True:
            todo = [i for i in range(len(self._known())) if i not in self.outputs]
            for i, outputs in zip(todo, evaluate([self.runs[i] for i in todo])):
                self.outputs[i] = outputs
            decided, posterior = len(self.ledger.points), self.posterior(targets())
            if decided == self.number and self.ledger.ends_with(posterior.best):
                return posterior
            if decided == self.number:      # of other outputs, as of an older version whose runs were cut
                self.runs.pop()
                del self.outputs[decided - 1]
                self.ledger.replace_last(posterior.best)
                continue
            say(f"{decided} of {self.number} runs: " + "; ".join(
                f"{one.name} {backanalysis.format_variable_value(one, low)} to "
                f"{backanalysis.format_variable_value(one, high)}"
                for one, (low, high) in zip(self.ledger.variables, map(posterior.interval,
                                                                       range(len(self.ledger.variables))))))
            left = self.number - 1 - decided
            taken = self.ledger.places(range(decided))
            self.ledger.add(backanalysis.propose(posterior, taken, min(self.batch, left)) if left > 0
                            else posterior.best[None])

    def finished(self) -> List[int]:
        """Numbers of the runs that count: not those that failed, and not the one at the best values."""
        return [i for i in range(min(len(self.ledger.points), self.number - 1)) if self.outputs.get(i) is not None]

    def posterior(self, targets: Sequence[backanalysis.Target]) -> backanalysis.Posterior:
        """What the runs so far say."""
        of = self.finished()
        if len(of) <= len(self.ledger.variables) + 1:
            failed = [one for one in self.runs if one.error]
            raise SlopeError(self.output, f"{len(failed)} of {len(self.runs)} runs failed, too many to go on: "
                             f"{failed[0].name}: {failed[0].error}" if failed else
                             f"{len(self.runs) - len(of)} of {len(self.runs)} runs lost more than "
                             f"{100 * travel_shares.BEYOND:.0f} % of the volume over the edge, too many to go on: use "
                             "a larger terrain and box, or ranges of --vary in which the mass stays on it")
        return backanalysis.posterior(self.ledger.places(of), np.array([self.outputs[i] for i in of]), targets)
