"""What the runs of an ensemble say together: quantiles and hazard curves, which variables matter, maps over all runs.

Order of the work: which variables each quantity depends on (emulator.py), which takes long and is kept with the study;
its numbers (hazard.py), maps (ensemble_maps.py); what study.yaml says of them, hazard.csv and influence.csv.
"""
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np

from .. import disk
from ..case import run_folders
from ..deposits import travel_shares
from ..errors import SlopeError
from ..findings import Finding, texts
from ..mobility.known import Mobility
from ..statistics import emulator, hazard
from ..statistics.entries import Analysis, Check, Influence, KnownQuantile
from ..survey.rasters import Place
from ..tables import combinations, ensemble_types, quantities, usable
from ..tables.quantities import On
from ..tables.rows import Finished, Row, finished_of
from . import ensemble_maps, farther, known_events
from .sample import Sample

MAPS = "ensemble"           # folder of the maps
HAZARD, INFLUENCE = "hazard.csv", "influence.csv"
ON_ROAD = "remove_on_road_m3"
FEW = 0.2       # share of failed runs from which on an ensemble is doubted


@dataclass(frozen=True)
class Order:
    """What is asked of an ensemble: its plan, the quantity of the hazard curve, thresholds of the maps.

    condition: the known events that its runs are weighted by; added: the runs beside the plan that these ask for.
    """
    sample: Sample
    of: str
    levels: ensemble_maps.Thresholds
    condition: Optional[known_events.Condition] = None
    added: Optional[farther.Added] = None


def check_quantity(of: Optional[str], road: bool) -> str:
    """The column of --of, or its default; SlopeError if there is none of that name."""
    if of is None:
        return ON_ROAD if road else travel_shares.DISTANCE
    asked = quantities.keys(On.ASKED)
    if of not in asked:
        raise SlopeError("--of", f"must be one of {', '.join(asked)}", of)
    if of in quantities.NEED_ROAD and not road:
        raise SlopeError("--road", f"must be given for {of}")
    return of


class Evaluated(NamedTuple):
    """about: what study.yaml says of an ensemble; curves: of its quantities; finished: rows of the planned runs that
    did, of so many points, as failed did not; known: weighted by known events."""
    about: ensemble_types.Ensemble
    curves: Mapping[str, hazard.Curve]
    finished: Sequence[Finished]
    points: int
    failed: int
    known: Optional[known_events.Evaluated]


@dataclass(frozen=True)
class Emulated:
    """What emulators of the runs say; of an order with a condition, what they say of its known events."""
    influence: Dict[str, Analysis]
    known_events: Optional[known_events.Emulated]


def main_of(order: Order, finished: Sequence[Finished]) -> List[str]:
    """The quantities whose dependence on the variables counts."""
    known = quantities.known(On.ASKED, finished)
    return [name for name in dict.fromkeys((order.of, *quantities.keys(On.INFLUENCE))) if name in known]


def emulate(order: Order, rows: Sequence[Row], mobility: Optional[Mobility]) -> Emulated:
    """For evaluate_ensemble(), which does without where all runs failed."""
    finished = finished_of(known_events.select_planned_rows(rows))
    if not finished:
        return Emulated({}, None)
    point, places, main = number_design_points(order.sample, finished), order.sample.places(finished), main_of(order,
                                                                                                               finished)
    influence = {
        name: emulator.analyse(order.sample.names, places, column(finished, name), point, order.sample.snap)
        for name in main}
    if not order.condition:
        return Emulated(influence, None)
    assert order.added and mobility
    return Emulated(influence, known_events.emulate(order.sample, order.added, rows, mobility, main))


def evaluate_ensemble(order: Order, rows: Sequence[Row], emulated: Emulated,
                      known: Optional[known_events.Evaluated] = None) -> Optional[Evaluated]:
    """What an ensemble says, None where all runs failed.

    rows: of study.csv; emulated: of emulate(); known: of known_events.evaluate_known_events().
    """
    finished = finished_of(known_events.select_planned_rows(rows))
    if not finished:
        return None
    failed = len(known_events.select_planned_rows(rows)) - len(finished)
    point = number_design_points(order.sample, finished)
    of_quantity = quantities.name_asked(finished)
    curves = {name: hazard.compute_hazard_curve(column(finished, name), point, failed) for name in of_quantity}
    ensemble = ensemble_types.Ensemble(
        design=order.sample.about, runs=len(finished) + failed, finished=len(finished), failed=failed,
        points=len(set(point)), confidence=hazard.CONFIDENCE, of=order.of if order.of in curves else None,
        quantities={name: summarise_quantity(what, unit, column(finished, name), point, failed)
                    for name, (what, unit) in of_quantity.items()},
        influence=emulated.influence, doubts=[], maps=[], known_events=known.about if known else None, withheld=[])
    return Evaluated(replace(ensemble, doubts=[*no_effect(finished), *find_ensemble_caveats(ensemble)]), curves,
                     finished, len(set(point)), failed, known)


def write_ensemble(evaluated: Evaluated, levels: ensemble_maps.Thresholds, output: Path, place: Optional[Place],
                   grids: Optional[str]) -> ensemble_types.Ensemble:
    """Tables and maps; what study.yaml says of the ensemble and of its known events, with the entries of the maps.

    place: CRS and offset of the maps; grids: why there can be none.
    """
    disk.write_file(output / HAZARD, hazard.tabulate_hazard(evaluated.curves))
    disk.write_file(output / INFLUENCE, influence_table(evaluated.about.influence))
    prefixes = [run_folders.prefix_of(run_folders.summary_of(output, row.summary)) for row in evaluated.finished]
    alike = ensemble_maps.Alike(evaluated.failed, max(1.0, len(prefixes) / evaluated.points))
    maps = [] if grids else ensemble_maps.write_ensemble_maps(output / MAPS, prefixes, alike, levels, place)
    known = known_events.write_known_events(evaluated.known, levels, output, place, grids) if evaluated.known else None
    return replace(evaluated.about, maps=maps, known_events=known)


def number_design_points(sample: Sample, finished: Sequence[Finished]) -> List[int]:
    """Which point of the design each run is of; points whose runs are the same, to the last digit, are one."""
    known: Dict[tuple, int] = {}
    first = combinations.same_as(finished)
    return [known.setdefault(tuple(finished[k].set[name] for name in sample.names), len(known)) for k in first]


def column(finished: Sequence[Finished], name: str) -> np.ndarray:
    return np.array([float(row.value(name)) for row in finished])


# --- numbers ---

def summarise_quantity(name: str, unit: str, values: np.ndarray, point: Sequence[int],
                       failed: int) -> ensemble_types.OfRuns:
    """Of a quantity: mean, deviation, range and quantiles."""
    quantiles = [one if several(point) else one._replace(low=None, high=None)
                 for one in hazard.compute_quantiles(values, point, failed)]
    deviation = float(values.std(ddof=1)) if len(values) > 1 else None
    return ensemble_types.OfRuns(name, unit, float(values.mean()), deviation, float(values.min()), float(values.max()),
                                 quantiles)


def several(point: Sequence[int]) -> bool:
    """Whether the runs are more than one, so that they have bounds; one run alone has that of its distribution."""
    return len(point) == 1 or len(set(point)) > 1


def no_effect(finished: Sequence[Finished]) -> List[Finding]:
    """The caveat that runs are the same as others, though their values differ."""
    first = combinations.same_as(finished)
    same = [k for k in range(len(finished)) if first.count(first[k]) > 1]
    if not same:
        return []
    number = len({first[k] for k in same})
    then = "they are one run, which has no bounds" if len(set(first)) == 1 else f"the bounds count them as {number}"
    return [Finding("no effect", {"which": "what was varied", "on": f" on {len(same)} of {len(finished)} runs",
                                  "then": then}, [finished[k].run for k in same])]


def find_ensemble_caveats(ensemble: ensemble_types.Ensemble) -> List[Finding]:
    """The caveats on the numbers."""
    caveats = []
    if ensemble.failed:
        wide = ensemble.failed / ensemble.runs > FEW
        caveats.append(Finding("failed points", {"failed": ensemble.failed, "runs": ensemble.runs,
                                                 "wide": ", so they are wide" * wide}))
    of = ensemble.of
    if of:
        quantity, influence = ensemble.quantities[of].name, ensemble.influence[of]
        open_ = [entry.share for entry in ensemble.quantities[of].quantiles if entry.high is None]
        if open_:
            caveats.append(Finding("unbounded", {"finished": ensemble.finished, "quantity": quantity,
                                                 "shares": ", ".join(f"{100 * share:g} %" for share in open_)}))
        if influence.emulator and influence.emulator.verdict != "good":
            caveats.append(Finding("emulator", {"quantity": quantity, "verdict": influence.text}))
    return caveats


# --- tables ---

def influence_table(influence: Mapping[str, Analysis]) -> str:
    """The CSV of ranks and indices; a cell is empty where the emulator says nothing."""
    def line(name: str, variable: str, influence: Influence, check: Optional[Check]) -> Sequence[Any]:
        return (name, variable, influence.rank, "yes" if influence.rank_clear else "no", influence.first,
                influence.first_error,
                influence.total, influence.total_error, *((check.explained, check.error) if check else (None, None)))

    return disk.csv_text(
        ["quantity", "variable", "rank", "rank_clear", *emulator.SIGN, "emulator_explains", "emulator_error"],
        (line(name, variable, one, entry.emulator)
         for name, entry in influence.items() for variable, one in entry.variables.items()))


# --- words ---

def describe_ensemble(ensemble: ensemble_types.Ensemble) -> List[str]:
    """The ensemble in a few lines: the quantiles of the main quantity, what it depends on, the caveats."""
    lines = [f"ensemble: {ensemble.finished} runs of {ensemble.points} points; bounds hold with "
             f"{100 * ensemble.confidence:g} %"]
    of = ensemble.of
    lines += usable.describe_withheld(ensemble.withheld) if ensemble.withheld else []
    if of:
        entry = ensemble.quantities[of]
        if not ensemble.withheld:
            lines.append(f"{entry.name}: " + "; ".join(
                known_events.quantile_text(KnownQuantile(*one), entry.unit, "the runs") for one in entry.quantiles))
        lines.append(f"{entry.name} depends on " + dependence_text(ensemble.influence[of]))
    lines += [f"caveat: {text}" for text in texts(ensemble.doubts)]
    return lines + known_events.describe_known_events(ensemble)


def dependence_text(entry: Analysis) -> str:
    """The variables, the one that matters most first."""
    variables = entry.variables
    if all(one.total is None for one in variables.values()):
        order = sorted(variables, key=lambda name: -abs(variables[name].rank))
        return ", ".join(f"{name} (rank {variables[name].rank:+.2f})" for name in order) + f"; {entry.text}"
    order = sorted(variables, key=lambda name: -(variables[name].total or 0.0))
    return ", ".join(f"{name} ({variables[name].first:.2f} alone, {variables[name].total:.2f} with others, +- "
                     f"{variables[name].total_error:.2f})" for name in order) + f"; {entry.text}"
