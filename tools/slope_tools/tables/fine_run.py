"""The effect of the size of the balls on the numbers of a study: its fine run against the runs with the same values."""
from dataclasses import replace
from typing import Callable, Dict, NamedTuple, Optional, Sequence

from ..digits import rounded, to_three
from ..runs.repeats import key_of
from ..statistics.conservative_volume import Combination, Scatter
from ..statistics.size_effect import RESOLVED, Effect, effect
from . import quantities, study_types
from .quantities import On
from .rows import Finished

VARIABLE = "d"                  # of a deck: the diameter of the balls, m
VOLUMES = {"m3"}                # units of quantities of which ten balls count


class Fine(NamedTuple):
    """A fine run and the coarse ones that are otherwise the same; row: None where it failed, why says so."""
    row: Optional[Finished]
    coarse: Sequence[Finished]
    depth: Optional[float]      # m, mean thickness of the body; None: not known
    scatter: Callable[[str], Optional[Scatter]]     # of a coarse run in a column of the study's table; None: not known
    why: str = ""


def evaluate(fine: Fine) -> study_types.Size:
    """The entry of study.yaml; its effects are {column: of_effect()}, its text a sentence without its full stop."""
    if fine.row is None or not fine.coarse:
        why = fine.why or "no run with the same values finished"
        return study_types.Size(None, {}, True, None, f"not known: {why}")
    ball = max(row.ball_m3 for row in fine.coarse)
    d, coarse_d = (float(row.variables[VARIABLE]) for row in (fine.row, fine.coarse[0]))
    effects: Dict[str, Effect] = {}
    for key in quantities.known(On.MEAN, [fine.row, *fine.coarse]):
        volumes = Combination(key, {key_of(row.repeat): float(row.value(key)) for row in fine.coarse})
        effects[key] = effect(volumes, float(fine.row.value(key)), fine.scatter(key),
                              ball if quantities.ALL[key].unit in VOLUMES else None)
    balls = fine.depth and fine.depth / d
    found = study_types.Compared(
        fine.row.run, {key: of_effect(one) for key, one in effects.items()}, balls is None or balls < RESOLVED, balls,
        "", d, coarse_d, fine.depth and fine.depth / coarse_d, [row.run for row in fine.coarse])
    return replace(found, text=words(found))


def of_effect(one: Effect) -> study_types.Effect:
    """As study.yaml has it."""
    return study_types.Effect(one.coarse, one.runs, one.fine, one.chance, one.ratio, one.difference, one.clear)


def read_effect(about: Optional[study_types.Size], key: str) -> Optional[Effect]:
    """That of a column in an entry of study.yaml; None where it is not known."""
    one = about.effects.get(key) if about else None
    return None if one is None else Effect(one.coarse, one.runs, one.fine, one.chance, one.ratio)


# --- words ---

def words(found: study_types.Compared) -> str:
    """What the fine run says of the volume to remove, else of the length; and what is left open."""
    key = next((one for one in (quantities.REMOVE, quantities.LENGTH, quantities.DISTANCE) if one in found.effects),
               None)
    thick, coarse = ("" if balls is None else f" ({balls:.2g}{more})" for balls, more in
                     ((found.balls_thick, " of them thick"), (found.coarse_balls_thick, "")))
    sizes = f"balls of {found.d:.3g} m{thick} instead of {found.coarse_d:.3g} m{coarse}"
    if key is None:
        return f"{sizes}: nothing to compare"
    one, what = found.effects[key], quantities.ALL[key]
    change = f"{rounded(to_three(one.fine))} instead of {rounded(to_three(one.coarse))} {what.unit}"
    if one.clear is None or one.chance is None:
        chance = "chance is not known"
    else:
        more = "more than" if one.clear else "no more than"
        chance = f"{more} chance explains, {rounded(to_three(one.chance))} {what.unit}"
    more = f". Balls that are smaller still may bring more: {RESOLVED:g} of them over the thickness would show it"
    return f"{sizes}: {what.name} {change}; {chance}{more * found.open}"
