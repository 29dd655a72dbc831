"""The runs of a study by combinations of choices: mean and scatter of each, and the conservative volume over all."""
import itertools
from dataclasses import dataclass, field
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from .. import disk
from ..case.settings import normalise_value
from ..findings import Finding, texts
from ..runs import jobs
from ..runs.repeats import Settings, key_of
from ..statistics import conservative_volume, hazard, rounding
from ..statistics.conservative_volume import Combination, Scatter
from . import quantities, sizes, study_types, usable
from .rows import Finished, Row, finished_of

GROUND = ("pattern", "spacing", "angle")        # variables of decks that make another ground
# runs that are the same in all of these are one run: two of chance never are
SAME = ("released_m3", "centroid_m", "front_m", "max_speed_m_s", "remove_m3")


@dataclass
class Group:
    """The finished runs of one combination; same: those left out because another one has the same numbers."""
    name: str
    set: Mapping[str, str]
    rows: List[Finished] = field(default_factory=list)
    same: List[Finished] = field(default_factory=list)

    def of(self, column: str) -> Combination:
        return Combination(self.name, {key_of(row.repeat): row.value(column) for row in self.rows})


def same_as(rows: Sequence[Finished]) -> List[int]:
    """Of each finished run the place of the first one that has the same numbers, its own where there is none."""
    first: Dict[tuple, int] = {}
    numbers = (tuple(row.value(name) for name in SAME) for row in rows)
    return [first.setdefault(mine, k) if any(one is not None for one in mine) else k for k, mine in enumerate(numbers)]


def grouped(rows: Sequence[Row]) -> List[Group]:
    """The finished runs by their combinations, in the order of the rows."""
    groups: Dict[tuple, Group] = {}
    for row in finished_of(rows):
        group = groups.setdefault(tuple(row.set.values()), Group(jobs.name_run(row.set), row.set))
        group.rows.append(row)
    for group in groups.values():
        mine = group.rows
        first = same_as(mine)
        group.rows = [row for k, row in enumerate(mine) if first[k] == k]
        group.same = [row for k, row in enumerate(mine) if first[k] != k]
    return list(groups.values())


def averaged(groups: Sequence[Group]) -> List[str]:
    """Columns that a combination has a mean of: those that every run has a number in."""
    return quantities.known(quantities.On.MEAN, (row for group in groups for row in group.rows))


def scatters(groups: Sequence[Group]) -> Dict[str, Optional[Scatter]]:
    """The scatter of one run in each column, pooled over the combinations."""
    return {name: conservative_volume.pooled([group.of(name) for group in groups]) for name in averaged(groups)}


def list_combination_entries(groups: Sequence[Group], names: Sequence[str]) -> List[Dict[str, Any]]:
    """What study.yaml says of each combination: of each column mean, scatter (None of one run), smallest, largest."""
    entries = []
    for group in groups:
        entry: Dict[str, Any] = {"combination": group.name, "set": dict(group.set),
                                 "runs": [row.run for row in group.rows], "repeats": len(group.rows),
                                 quantities.STOP: group.rows[0].stop_angle_deg}
        for name in names:
            one = group.of(name)
            entry[name] = {"mean": one.mean, "scatter": one.scatter, "smallest": min(one.volumes.values()),
                           "largest": max(one.volumes.values())}
        entries.append(entry)
    return entries


def tabulate_combinations(groups: Sequence[Group], names: Sequence[str], settings: Mapping[str, Sequence[str]]) -> str:
    """The CSV over all combinations."""
    return disk.csv_text(
        ["combination", *settings, "repeats", *(f"{name}_{what}" for name in names for what in ("mean", "scatter"))],
        ([group.name, *group.set.values(), len(group.rows),
          *(cell for one in map(group.of, names) for cell in (one.mean, one.scatter))] for group in groups))


def label(chosen: Mapping[str, str], settings: Mapping[str, Sequence[str]]) -> str:
    """A combination in words: the values that vary."""
    return ", ".join(f"{name} {value}" for name, value in chosen.items() if len(settings[name]) > 1)


# --- the conservative volume ---

def straight(settings: Settings, groups: Sequence[Group],
             chosen: Mapping[str, str]) -> Iterator[Tuple[str, List[Group]]]:
    """For each variable with several values: the groups that differ from a combination in this variable only."""
    for name, several in settings.items():
        if len(several) > 1:
            rest = {other: value for other, value in chosen.items() if other != name}
            yield name, [group for group in groups
                         if all(group.set[other] == value for other, value in rest.items())]


def ground(settings: Settings, group: Group) -> Optional[str]:
    """Which of the grounds that were tried is that of a combination; None where there was one."""
    names = [name for name in GROUND if len(settings.get(name, ())) > 1]
    if not names:
        return None
    text = "the ground that governs: " + ", ".join(f"{name} {group.set[name]}" for name in names)
    degrees = group.rows[0].stop_angle_deg
    if degrees is not None:
        text += f", stop angle {degrees:.1f} degrees"
    return f"{text} (tried: " + "; ".join(f"{name} {', '.join(settings[name])}" for name in names) + ")"


FEW = 0.05      # of the largest volume of runs that differ by chance alone: less is another outcome
STANDS = 0.1    # of the largest travel of the centroid among them: less, and the slope did not fail


def conservative(settings: Settings, rows: Sequence[Row], groups: Sequence[Group],
                 draw: Optional[sizes.Draw] = None) -> study_types.Conservative:
    """The entry of the conservative volume in study.yaml: its parts, what it is based on, its caveats (doubts).

    draw: of runs that are transferred to the finest balls.
    """
    parts = [group.of("remove_m3") for group in groups]
    best = conservative_volume.predict(parts)
    governing = next(group for group in groups if group.name == best.combination)
    largest = max(governing.rows, key=lambda row: row.at_road.remove_m3)
    volumes = [row.at_road.remove_m3 for row in governing.rows]
    differences: List[study_types.Difference] = []
    for name, line in straight(settings, groups, governing.set):
        if len(line) < 2:
            continue
        found = conservative_volume.difference([group.of("remove_m3") for group in line], best.scatter)
        value = {group.name: group.set[name] for group in line}
        differences.append(study_types.Difference(name, value[found.largest], value[found.smallest], found.by,
                                                  found.chance, found.clear))
    scatter = best.scatter
    return study_types.Conservative(
        volume_m3=best.volume, mean_m3=best.mean, chance_m3=best.chance,
        rounded={f"{name}_m3": value for name, value in best.rounded().items()}, place_m3=best.place,
        kind=best.kind, combination=best.combination, set=dict(governing.set), label=label(governing.set, settings),
        ground=ground(settings, governing), repeats=best.repeats, runs=best.runs, combinations=len(groups),
        scatter_m3=scatter.deviation if scatter else None,
        degrees_of_freedom=scatter.degrees_of_freedom if scatter else None,
        quantile=scatter.quantile if scatter else None,
        starts_m3=[min(volumes), max(volumes)] if len(volumes) > 1 else None,   # of the same combination
        run=largest.run, remove_m3=largest.at_road.remove_m3,                   # the one whose maps represent it
        differences=differences, doubts=find_combination_caveats(settings, rows, groups, best, differences),
        withheld=[], zero=None,     # see outcome.judge_conservative
        transfer_m3=transfer(best.mean, governing, draw) if draw else None)


def transfer(mean: float, group: Group, draw: sizes.Draw) -> List[float]:
    """How far (m3) the mean of a combination may lie below and above, as its runs are transferred."""
    low, high = np.quantile(draw(group.rows, quantities.REMOVE).mean(axis=1), hazard.TAILS)
    return [max(0.0, mean - float(low)), max(0.0, float(high) - mean)]


def find_combination_caveats(settings: Settings, rows: Sequence[Row], groups: Sequence[Group],
                             best: conservative_volume.ConservativeVolume,
                             differences: Sequence[study_types.Difference]) -> List[Finding]:
    """Reasons why the volume may be larger than the conservative one."""
    caveats = []
    finished = finished_of(rows)
    if len(rows) == 1:
        caveats.append(Finding("single run"))
    elif best.chance is None:
        caveats.append(Finding("no chance"))
    chosen = next(group.set for group in groups if group.name == best.combination)
    for entry in differences:
        name = entry.variable
        numbers = [normalise_value(value) for value in settings[name]]
        value = normalise_value(chosen[name])
        if entry.clear is not False and value == normalise_value(entry.largest_at) and value != 0 \
                and all(isinstance(one, float) for one in numbers) and value in (min(numbers), max(numbers)):
            caveats.append(Finding("end of range", {"variable": name, "low": min(numbers), "high": max(numbers)}))
    caveats += no_effect(groups)
    released = max(row.released_m3 for row in finished)
    if best.volume > released:
        caveats.append(Finding("more than released", {"released": rounding.nearest(released, best.place)}))
    for group in groups:
        most = max(row.at_road.remove_m3 for row in group.rows)
        few = [row for row in group.rows if row.at_road.remove_m3 < FEW * most]
        if few:
            caveats.append(outcome(group, few))
    above = max(finished, key=lambda row: row.at_road.remove_m3)
    if above.at_road.remove_m3 > best.volume:
        caveats.append(Finding("more in a run", {"run": above.run, "volume": rounding.nearest(above.at_road.remove_m3,
                                                                                              best.place)}))
    parts = [group.of("remove_m3") for group in groups]
    odd = conservative_volume.odd_one(parts, best.combination)
    if odd:
        mine, others = (rounding.nearest(one, rounding.choose_rounding(odd[1] or odd[0])) for one in odd)
        caveats.append(Finding("scatters more", {"mine": mine, "others": others}))
    return caveats


def no_effect(groups: Sequence[Group]) -> List[Finding]:
    """The caveat that runs are left out, as others have the same numbers."""
    same = [row.run for group in groups for row in group.same]
    found = [Finding("no effect", {"which": "a repeated variable", "on": "", "then": "left out"}, same)] if same else []
    return [*found, *values_without_effect(groups)]


def values_without_effect(groups: Sequence[Group]) -> List[Finding]:
    """The caveat that two values of a variable, all else being equal, have the same numbers, and do not test it: as
    the ground's spacing where the mass comes to rest on the slip surface's own balls.
    """
    values: Dict[str, Dict[str, None]] = {}
    for one, other in itertools.combinations([group for group in groups if group.rows], 2):
        names = [name for name in one.set if one.set[name] != other.set.get(name)]
        if len(names) == 1 and same_as([one.rows[0], other.rows[0]])[1] == 0:
            values.setdefault(names[0], {}).update(dict.fromkeys((one.rows[0].run, other.rows[0].run)))
    return [Finding("no effect", {"which": name, "on": f" in {len(runs)} runs", "then": "they do not test it"},
                    tuple(runs)) for name, runs in values.items()]


def outcome(group: Group, few: Sequence[Finished]) -> Finding:
    """That some runs bring hardly anything, though they differ from others by chance alone: by how far the mass went,

    because the slope stood, or because the mass came down and hardly reached the road.
    """
    count = stood(few, group.rows)
    return Finding("hardly reaches" if count == 0 else "two outcomes", {
        "few": len(few), "runs": len(group.rows), "combination": group.name, "percent": 100 * FEW, "stood": count,
        "why": f"the slope stood in {count} of them"})


def stood(few: Sequence[Finished], rows: Sequence[Finished]) -> int:
    """In how many of a few of some rows the slope stood, by the travel of the centroid."""
    most = max(row.centroid_m for row in rows)
    return sum(row.centroid_m < STANDS * most for row in few)


def starts(best: study_types.Conservative) -> List[str]:
    """What only another start of the balls gives: the range over the repeats of the governing combination, a line."""
    if not best.starts_m3:       # one run
        return []
    low, high = (rounding.format_rounded(value, best.place_m3) for value in best.starts_m3)
    number = f"{low} to {high}" if low != high else high
    return [f"another start of the balls gives {number} m3 on the same site ({best.repeats} runs)"]


def describe_combinations(best: study_types.Conservative) -> List[str]:
    """The conservative volume and its parts, rounded to what is known, differences and caveats; a line each.

    In its place why it is withheld, if it is.
    """
    def number(value: Any) -> str:
        return rounding.format_rounded(value, best.place_m3)

    if best.withheld:
        return [*usable.describe_withheld(best.withheld), *(f"caveat: {text}" for text in texts(best.doubts))]
    parts = {name: best.rounded[f"{name}_m3"] for name in ("volume", "mean", "chance")}
    if parts["chance"] is None:
        text = f"{best.kind}: {number(parts['volume'])} m3 to remove; run {best.run}"
    else:
        text = (f"conservative volume to remove: {number(parts['volume'])} m3 = {number(parts['mean'])}, mean of "
                f"{best.repeats} runs ({best.label or best.combination}) + {number(parts['chance'])}, chance "
                f"(s {number(best.scatter_m3)}, {best.degrees_of_freedom:.3g} degrees of freedom)")
    lines = [text, *starts(best), *([best.zero.text] if best.zero else []),
             *([best.ground] if best.ground else [])]
    for entry in best.differences:
        if entry.clear is not None and entry.chance_m3 is not None:
            word = "more than" if entry.clear else "no more than"
            by, chance = (rounding.format_rounded(value, rounding.place_of_digits(entry.chance_m3))
                          for value in (entry.by_m3, entry.chance_m3))
            lines.append(f"{entry.variable}: {by} m3 between {entry.smallest_at} and {entry.largest_at}, "
                         f"{word} expected by chance, {chance} m3")
    return lines + [f"it may be exceeded: {text}" for text in texts(best.doubts)]
