"""What half the time step changes: one run with it, against the mean of the runs that are otherwise the same; and where
the energy of that run went, the last line of what fix ave/time writes of fix energy/ledger."""
import re
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..digits import format_measured_share, rounded, si, to_three
from ..errors import SlopeError
from ..findings import Finding
from ..statistics import conservative_volume
from . import study_types
from .combinations import Group
from .quantities import REMOVE

SUFFIX = "energy"       # of the file, after the run's prefix
# columns after the step, J; one line each second (doc/src/fix_energy_ledger.rst)
ITEMS = ("kinetic", "gravity", "other_forces", "stored", "normal_dashpots", "sliding", "rolling", "begin_end",
         "residual", "ground_motion", "left")
TAKEN = {"sliding": "sliding", "rolling": "rolling resistance", "normal_dashpots": "impacts (normal dashpots)",
         "begin_end": "the finite step at the start and end of contacts"}


class Step(NamedTuple):
    """The run with half the step; where there is none, why."""
    rolling: str                # its rolling resistance
    volume: Optional[float]     # m3 to remove
    why: str = ""
    energy: Optional[Dict[str, Any]] = None     # of read_energies()
    spacing: Optional[str] = None       # of its ground
    step: Optional[float] = None        # of the rule's: half of the deck's


def half_of(variables: Mapping[str, str]) -> str:
    """Half the step of a deck with these variables, as a value of its `step`."""
    step = variables.get("step", "1")
    try:
        return f"{float(step) / 2:.10g}"
    except ValueError:
        raise SlopeError("step of the deck", "must be a number", step) from None


def compare(step: Step, groups: Sequence[Group]) -> Tuple[study_types.HalfStep, List[Finding]]:
    """The entry of study.yaml, whose text is one sentence, and its doubt of the volume.

    within_chance: None where the scatter of a run is unknown. Chance: a single run differs from the mean of n by less
    than t s sqrt(1 + 1/n) in 95 % of cases (Hahn and Meeker, Statistical Intervals, 1991, section 4.7).
    """
    def entry(text: str, mean: Optional[float] = None, chance: Optional[float] = None,
              within: Optional[bool] = None) -> study_types.HalfStep:
        return study_types.HalfStep(step.step, step.rolling, step.volume, mean, chance, within, step.energy, text)

    same = next((group for group in groups if group.set.get("rolling") == step.rolling
                 and group.set.get("spacing", step.spacing) == step.spacing), None)
    if step.volume is None or same is None:
        return entry(f"half the time step: not tried: {step.why or 'no run with the same values finished'}"), []
    parts = [group.of(REMOVE) for group in groups]
    volumes = parts[groups.index(same)]
    difference = step.volume - volumes.mean
    text = f"half the time step, rolling {step.rolling}: "
    if not step.volume and not volumes.mean:
        return entry(f"{text}nothing to remove, as with the whole step", volumes.mean, 0.0, True), []
    by = f", {100 * difference / volumes.mean:+.1f} %" if volumes.mean > 0 else ""
    text += f"{format_step_volume(step.volume)} m3 instead of {format_step_volume(volumes.mean)} to remove{by}"
    scatter = conservative_volume.scatter_of(parts, volumes) if volumes.mean > 0 else conservative_volume.pooled(parts)
    if scatter is None:
        return entry(f"{text}; chance unknown", volumes.mean), []
    chance = scatter.chance(volumes.runs)
    within = abs(difference) <= chance
    numbers = {"rolling": step.rolling, "volume": format_step_volume(step.volume),
               "mean": format_step_volume(volumes.mean), "by": by,
               "more": "no more" if within else "more", "chance": format_step_volume(chance)}
    found = Finding("half step", numbers)
    return entry(found.text, volumes.mean, chance, within), [] if within else [found]


def format_step_volume(volume: float) -> str:
    return rounded(to_three(volume))


# --- where its energy went ---

def read_energies(path: Path) -> Optional[Dict[str, Any]]:
    """Energies in J at the last full second of a run, with a sentence; None where the run was continued.

    A ledger is not in restart files, so that of a continued run lacks what came before. Raises SlopeError if the file
    cannot be read.
    """
    try:
        table = np.loadtxt(path, ndmin=2)
        joules = dict(zip(items_of(path, table.shape[1] - 1), table[-1, 1:].tolist(), strict=True))
        if not np.isfinite(table).all():
            raise ValueError("a number that is not finite")
    except (OSError, IndexError, ValueError) as error:
        raise SlopeError(path, f"must be what the run wrote of its energy ({error})") from error
    if table[0, 0] != 0:
        return None
    return {**joules, "text": describe_energy(joules)}


def items_of(path: Path, count: int) -> Sequence[str]:
    """ITEMS in the order of the columns that the head of fix ave/time names, TimeStep f_ID[1] ...; or ValueError."""
    with open(path, encoding="utf-8", errors="replace") as lines:
        heads = [line[1:].split()[1:] for line in lines if line.startswith("#") and "TimeStep" in line]
    head: List[str] = heads[0] if heads else []
    found = [re.fullmatch(r"f_(\w+)\[(\d+)\]", name) for name in head]
    places = [int(one[2]) if one else 0 for one in found]
    if not all(found) or len({one[1] for one in found if one}) > 1 or len(set(places)) < len(places) or (
            places and not 1 <= min(places) <= max(places) <= len(ITEMS)):
        raise ValueError(f"columns {' '.join(head)[:60]!r} instead of those of fix energy/ledger")
    if len(places) == count == len(ITEMS):
        return [ITEMS[place - 1] for place in places]
    if places != list(range(1, len(places) + 1)):
        raise ValueError(f"{count} columns under {len(places)} names")
    return ITEMS


def describe_energy(joules: Dict[str, float]) -> str:
    taken = sum(joules[name] for name in TAKEN)
    if not taken > 0:
        return "nothing has moved"
    gained = joules["gravity"] + joules["ground_motion"]
    shares = ", ".join(f"{format_measured_share(joules[name] / taken)} by {what}" for name, what in TAKEN.items())
    left = f"; {si(joules['left'], 'J')} left with balls" if joules["left"] > 0 else ""
    return (f"of {si(gained, 'J')} that weight and ground motion put in, {si(taken, 'J')} was taken: {shares}{left}; "
            f"not accounted for: {format_measured_share(abs(joules['residual']) / taken)}")
