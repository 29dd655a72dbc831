"""Runs of one combination of choices that differ by chance: which variables may say so, and the runs to make."""
import itertools
import math
import re
from typing import Dict, Iterable, List, Mapping, Optional, Sequence

from ..case.settings import MOST_RUNS, normalise_value
from ..errors import SlopeError
from . import jobs

CHANCE = re.compile(r"seed|packing|\w*offset")      # names of variables without a preferred value
OFFSET = re.compile(r"packing|\w*offset")
FIRST = "base"                              # the repeat that has the deck's values

Settings = Mapping[str, Sequence[str]]
NONE: Dict[str, str] = {}


class Repeat(jobs.Run):
    """A run of a combination of choices, with one of the repeats' values, or with none: the combination's first run.

    batch: which one of those that an ensemble added (farther) it is of, from 1; 0: none.
    """
    batch = 0

    def __init__(self, output, combination: Dict[str, str], repeat: Optional[Dict[str, str]] = None):
        super().__init__(output, {**combination, **(repeat or {})})
        self.combination = combination
        self.repeat = repeat or {}

    @property
    def key(self) -> str:
        """Which repeat it is; the same in every combination."""
        return key_of(self.repeat)


def key_of(repeat: Mapping[str, str]) -> str:
    return " ".join(f"{name} {value}" for name, value in repeat.items()) or FIRST


def check_repeats(names: Sequence[str], equally_good: str) -> None:
    """Raise SlopeError unless the variables of --repeat are chance, by name or because --equally-good says so."""
    also = [name for name in equally_good.split(",") if name]
    for name in names:
        if not (CHANCE.fullmatch(name) or name in also):
            raise SlopeError("--repeat", "must name a variable that differs by chance alone, seed, packing or "
                             f"...offset; if the values of {name} are equally good, say --equally-good {name}", name)
    for name in also:
        if name not in names:
            raise SlopeError("--equally-good", "must name variables of --repeat", name)


def plan_repeats(output, settings: Settings, repeated: Settings, defaults: Mapping[str, str],
                 others: Sequence[Dict[str, str]] = ()) -> List[Repeat]:
    """The runs of the product of all settings, the last one varying fastest, each followed by its repeats.

    others: combinations beside the product, with the same names, of one run each.

    A combination's first run has the deck's values of what is repeated, or the single one of settings; each of the
    other values is a run of its own, one variable at a time. defaults: of the deck's index variables.
    """
    for name in repeated:
        if len(settings.get(name, ())) > 1:
            raise SlopeError("--repeat", "must not name a variable of several values of --set", name)
    chances = chances_of(repeated, {**defaults, **{name: several[0] for name, several in settings.items()}})
    total = math.prod(len(several) for several in settings.values()) * (1 + len(chances)) + len(others)
    if total > MOST_RUNS:
        raise SlopeError("--set", f"must make at most {MOST_RUNS} runs", total)
    varied = [name for name, several in settings.items() if len({*several, *(one[name] for one in others)}) > 1]
    product = (dict(zip(settings, chosen)) for chosen in itertools.product(*settings.values()))
    return with_repeats(output, product, chances, varied) + with_repeats(output, others, (), varied)


def chances_of(repeated: Settings, base: Mapping[str, str]) -> List[Dict[str, str]]:
    """What each further run of a combination changes: one value of --repeat that is not the first run's (base)."""
    chances = [{name: value} for name, several in repeated.items() for value in several
               if normalise_value(value) != normalise_value(base[name])]
    if repeated and not chances:
        raise SlopeError("--repeat", "must give a value that the first run does not have",
                         ", ".join(f"{name}={','.join(several)}" for name, several in repeated.items()))
    return chances


def with_repeats(output, combinations: Iterable[Dict[str, str]], chances: Sequence[Dict[str, str]],
                 varied: Sequence[str]) -> List[Repeat]:
    """The runs of combinations, each followed by its repeats; varied: names of what differs between them."""
    todo = []
    for combination in combinations:
        for repeat in [NONE, *chances]:
            one = Repeat(output, combination, repeat)
            parts = [f"{name} {one.chosen[name]}" for name in varied]
            one.varied = ", ".join(parts + [key_of(repeat)] * bool(repeat)) or one.name
            todo.append(one)
    return todo


def unmoved(names: Iterable[str], defaults: Mapping[str, str]) -> List[str]:
    """The variables of a deck that place its balls, if none of them is among names, so that all runs begin alike."""
    offsets = [name for name in defaults if OFFSET.fullmatch(name)]
    return [] if set(offsets) & set(names) else offsets
