"""What half the time step changes: one run with it, against the mean of the runs that are otherwise the same."""
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..digits import rounded, to_three
from ..errors import SlopeError
from ..findings import Finding
from ..statistics import conservative_volume
from . import study_types
from .combinations import Group
from .quantities import REMOVE


class Step(NamedTuple):
    """The run with half the step; where there is none, why."""
    rolling: str                # its rolling resistance
    volume: Optional[float]     # m3 to remove
    why: str = ""
    energy: Optional[Dict[str, Any]] = None     # of energy.read_energies()
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
