"""The plan of an ensemble: how many runs, where they lie in the distributions of --vary, what may be added later."""
import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .. import disk, records, schemas
from ..case.settings import MOST_RUNS
from ..errors import SlopeError
from ..findings import Finding
from ..runs import repeats
from ..schemas import OBJECT
from ..statistics import designs, distributions
from ..tables import ensemble_types
from ..tables.rows import Run

FILE = "design.yaml"
WHAT = "what `slope study --sample` wrote"


@dataclass(frozen=True)
class Sample:
    """number points of a design of a seed, over variables (distributions.Range or Listed)."""
    number: int
    kind: str
    seed: int
    variables: Tuple[Any, ...]
    balls_thick: Optional[float] = None     # over the thickness of the body, where its values were found; None: unknown
    beside: Mapping[str, str] = field(default_factory=dict)     # values of other variables, where they were found
    doubts: Tuple[Finding, ...] = ()        # about the values, from where they were found

    @property
    def names(self) -> List[str]:
        return [one.name for one in self.variables]

    @property
    def about(self) -> ensemble_types.Design:
        """What design.yaml and study.yaml say of it."""
        wide = {one.name: list(one.wide) for one in self.variables if getattr(one, "wide", None)}
        return ensemble_types.Design(self.kind, self.seed, self.number, {one.name: one.text for one in self.variables},
                                     wide or None)

    def widened(self, bounds: Mapping[str, Tuple[float, float]]) -> "Sample":
        """The same, whose variables of these names may have added runs between wider bounds."""
        return dataclasses.replace(self, variables=tuple(
            one.widened(*bounds[one.name]) if one.name in bounds else one for one in self.variables))

    @property
    def box(self) -> np.ndarray:
        """Where runs may lie: low and high of each variable, 0 and 1 but for wider bounds."""
        return np.array([one.places for one in self.variables])

    def combinations(self) -> List[Dict[str, str]]:
        """The values of each point."""
        points = designs.points(self.kind, len(self.variables), self.number, self.seed)
        return [{one.name: one.value(u) for one, u in zip(self.variables, point)} for point in points]

    def places(self, rows: Sequence[Run]) -> np.ndarray:
        """The points of rows of the study's table in the unit cube."""
        return np.array([[one.unit(row.set[one.name]) for one in self.variables] for row in rows])

    def snap(self, u: np.ndarray) -> np.ndarray:
        return designs.snapped(self.variables, u)


def check_sample(number: int, kind: str, seed: int, vary: Sequence[str], deck: Path, fixed: Mapping[str, str],
                 repeated: Mapping[str, Sequence[str]], asked: str = "--sample") -> Sample:
    """The Sample of the options; SlopeError if they do not go together. asked: where the number stands."""
    if not vary:
        raise SlopeError("--vary", "must give the variables of the ensemble that --sample asks for")
    variables = distributions.parse(vary, deck)
    if not 0 <= seed < 2 ** 32:
        raise SlopeError("--seed", "must be from 0 to 4294967295", seed)
    for one in variables:
        for option, names in (("--set", fixed), ("--repeat", repeated)):
            if one.name in names:
                raise SlopeError("--vary", f"must not name a variable of {option}", one.name)
    check_number(number, len(variables), asked)
    return Sample(number, kind, seed, tuple(variables))


def check_number(number: int, parameters: int, asked: str = "--sample") -> None:
    """SlopeError unless a number of runs will do for so many parameters."""
    if number <= parameters:
        raise SlopeError(asked, f"must be more runs than there are parameters, {parameters}", number)
    if number > MOST_RUNS:
        raise SlopeError(asked, f"must make at most {MOST_RUNS} runs", number)


def plan_sample(output: Path, sample: Sample, fixed: Mapping[str, str], repeated: Mapping[str, Sequence[str]],
                defaults: Mapping[str, str]) -> List[repeats.Repeat]:
    """The runs: each point, followed by its repeats."""
    chances = repeats.chances_of(repeated, {**defaults, **fixed})
    if sample.number * (1 + len(chances)) > MOST_RUNS:
        raise SlopeError("--sample", f"must make at most {MOST_RUNS} runs with the repeats of each",
                         sample.number * (1 + len(chances)))
    combinations = [{**fixed, **one} for one in sample.combinations()]
    if len({tuple(one.values()) for one in combinations}) < len(combinations):
        if any(isinstance(one, distributions.Range) for one in sample.variables):
            raise SlopeError("--sample", "must make points that differ in the six digits of a value: two are the same, "
                             "give fewer or another --seed", sample.number)
        raise SlopeError("--vary", "must have a range among its variables, or points would be twice: lists alone are "
                         "what --set is for", ", ".join(sample.names))
    return repeats.with_repeats(output, combinations, chances, sample.names)


def settings_of(todo: Sequence[repeats.Repeat]) -> Dict[str, List[str]]:
    """{name: its values} over the runs, as a study of lists has them."""
    return {name: list(dict.fromkeys(one.combination[name] for one in todo)) for name in todo[0].combination}


def all_values(settings: Mapping[str, List[str]], sample: Sample) -> Dict[str, List[str]]:
    """settings_of the runs, with the values of lists that none of them has: a run that is added may have them."""
    lists = {one.name: one.values for one in sample.variables if isinstance(one, distributions.Listed)}
    return {name: list(dict.fromkeys([*several, *lists.get(name, ())])) for name, several in settings.items()}


def check_growth(folder: Path, sample: Sample) -> None:
    """Raise SlopeError if the folder has a Latin hypercube, or is to have one, that this is not."""
    path = folder / FILE
    if not path.is_file():
        return
    before = schemas.load_checked(path, WHAT, OBJECT)
    if designs.LHS in (before.get("kind"), sample.kind) and before != records.encode_record(sample.about):
        raise SlopeError("--design", f"lhs cannot grow or change: {folder} has {before.get('points')} points of "
                         f"{before.get('kind')} with seed {before.get('seed')}; give another -o, or take sobol",
                         f"{sample.number} of {sample.kind} with seed {sample.seed}")


def write_sample(folder: Path, sample: Sample) -> None:
    """Write design.yaml, before the first run."""
    disk.write_file(folder / FILE, disk.yaml_text(WHAT, records.encode_record(sample.about)))
