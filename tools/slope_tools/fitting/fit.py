"""Fitting the variables of a deck to an observed deposit."""
import math
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence

import numpy as np

from .. import disk, provenance
from ..case import run_folders
from ..case.settings import normalise_value
from ..deposits import deposit, score
from ..deposits.rest import CUT
from ..findings import Finding, encode_findings
from ..runs import jobs, repeats
from ..statistics import backanalysis
from ..statistics.backanalysis import Posterior, Target
from ..studies import body_depth, mapped, run_rows
from ..studies.setup import Setup
from ..tables import judged, quantities
from ..tables.quantities import format_quantity
from ..tables.rows import Finished, Row, finished_of
from . import calibration, observations

# variables of the package's decks that are of the law of contact, of the ground or of the slip surface
MODEL = "friction", "slip", "rolling", "restitution", "e", "field_e", "spacing", "pattern", "angle"
SETS = 64               # sets of values that stand for the region
DURATION = "duration"   # variable of a deck, its time limit
LONGER = 8              # times as much, where a run is not at rest then: rest ends it
TABLE, ABOUT, CHART, MAP = "calibrate.csv", "calibrate.yaml", "calibrate.png", "predicted.png"
BEYOND = 2.0            # standard deviations of tolerance and chance together


def in_words(number: int) -> str:
    """A small number as a sentence has it."""
    return ("no", "one", "two", "three", "four", "five", "six")[number] if number < 7 else str(number)


class Fit:
    """A calibration under way: makes its runs, measures them, and writes what came out."""

    def __init__(self, setup: Setup, wanted: observations.Wanted, plan: calibration.Calibration, work: jobs.Work):
        self.setup, self.wanted, self.plan, self.work = setup, wanted, plan, work
        self.observed = observations.Observations(wanted)
        self.rows: Dict[str, Row] = {}

    @property
    def variables(self):
        return self.plan.ledger.variables

    def do(self) -> None:
        found = self.plan.do(self.evaluate, lambda: self.observed.targets, self.setup.tell)
        self.write(found)

    def evaluate(self, todo: Sequence[repeats.Repeat]) -> List[Optional[np.ndarray]]:
        """Run what is not finished, longer where a deposit is not at rest, and measure all."""
        rows = self.made(todo)
        todo = list(todo)
        longer = {i: self.longer(todo[i]) for i, row in enumerate(rows) if self.was_cut(todo[i], row)}
        if longer:
            times = ", ".join(sorted({one.chosen[DURATION] for one in longer.values()}))
            self.setup.tell(f"{len(longer)} run{'s' * (len(longer) > 1)} not at rest at the end of the duration: again "
                            f"until rest, for {times} s at most")
            for (i, run), row in zip(longer.items(), self.made(list(longer.values()))):
                if isinstance(row, Finished):         # else the shorter one stays
                    self.plan.replace(todo[i], run)
                    todo[i], rows[i] = run, row
        found: List[Optional[np.ndarray]] = []
        for run, row in zip(todo, rows):
            self.rows[run.name] = row
            found.append(self.observed.measure(self.summary(row), self.terrain(run), row)
                         if isinstance(row, Finished) and self.observed.told_by(row) else None)
        return found

    def made(self, todo: Sequence[repeats.Repeat]) -> List[Row]:
        """The rows of runs, which are made where they are not finished."""
        self.work.store.admit(todo)
        self.work.do(todo)
        return run_rows.read_run_rows(self.setup, todo)

    def was_cut(self, run: repeats.Repeat, row: Row) -> bool:
        """Whether a run that counts was stopped at its duration before it was at rest, and that may be another one."""
        named = {variable.name for variable in self.variables} | self.plan.fixed.keys()
        return (isinstance(row, Finished) and not row.at_rest and row.stop_reason == CUT and self.observed.told_by(row)
                and DURATION in self.work.defaults and DURATION not in named
                and isinstance(normalise_value(run.chosen.get(DURATION, self.work.defaults[DURATION])), float))

    def longer(self, run: repeats.Repeat) -> repeats.Repeat:
        """The same run with LONGER times its duration."""
        seconds = float(run.chosen.get(DURATION, self.work.defaults[DURATION]))
        return repeats.Repeat(self.setup.output, {**run.combination, DURATION: f"{LONGER * seconds:.10g}"}, run.repeat)

    @property
    def finished(self) -> List[Finished]:
        return finished_of(self.rows.values())

    def summary(self, row: Finished) -> Path:
        return run_folders.summary_of(self.setup.output, row.summary)

    @staticmethod
    def terrain(run: repeats.Repeat) -> Optional[Path]:
        path = run.log.terrain and run.folder / run.log.terrain
        return path if path and path.is_file() else None

    # --- results ---

    def write(self, posterior: backanalysis.Posterior) -> None:
        """Table, YAML, chart, and the map of the run at the best values."""
        output, plan, targets = self.setup.output, self.plan, self.observed.targets
        best = plan.runs[plan.number - 1]
        predicted = plan.outputs[plan.number - 1]
        words = [*misses(posterior, targets, predicted), *jumps(posterior, targets),
                 *backanalysis.judgement(posterior, self.variables)]
        doubts = self.doubts(posterior)
        failed = [one.name for one in plan.runs if one.error]
        thick = body_depth.in_balls(self.setup, self.finished)
        summary: Dict[str, Any] = {
            "calibration": {**plan.ledger.about, "runs": plan.number, "failed": len(failed), "balls_thick": thick,
                            "model": self.model(), "package": self.work.package, "collected": provenance.now(),
                            "machine": provenance.machine()},
            "best": {"set": plan.ledger.points[plan.number - 1], "run": best.name,
                     "score": None if predicted is None else float(backanalysis.misfits(
                         predicted[None], posterior, targets)[0])},
            "variables": {one.name: self.known(posterior, i) for i, one in enumerate(self.variables)},
            "correlation": [[round(float(value), 3) for value in row] for row in posterior.correlation()],
            "misfit": posterior.misfit, "words": words, "doubts": encode_findings(doubts),
            "targets": [{"name": one.name, "unit": one.unit, "observed": one.value, "attainable": float(goal),
                         "tolerance": one.deviation, "chance": float(noise),
                         "predicted": None if predicted is None else float(predicted[i])}
                        for i, (one, goal, noise) in enumerate(zip(targets, posterior.goals, posterior.noise))],
            "sets": [{one.name: one.value(float(u)) for one, u in zip(self.variables, place)}
                     for place in backanalysis.sets(posterior, SETS)],
            "pairs": self.pairs(posterior)}
        with disk.complete(output, ABOUT) as new:
            disk.write_file(new / TABLE, self.table(posterior))
            disk.write_file(new / ABOUT, disk.yaml_text(
                "slope calibrate: lengths in m, areas in m2, volumes in m3 of ground (bulk)", summary))
            from . import calibrate_charts
            calibrate_charts.draw_posterior(new / CHART, posterior, self.variables, plan.ledger.places(plan.finished()),
                                            f"{self.setup.deck.name}: {len(plan.finished())} runs")
            names = [TABLE, ABOUT, CHART]
            if self.wanted.observed is not None and predicted is not None:
                self.draw_map(new / MAP, best)
                names.append(MAP)
        self.setup.tell("\n".join([*words, *self.comparison(summary["targets"]),
                                   *(f"caveat: {text}" for text in doubts)]))
        self.setup.tell(f"best values: run {best.name}; written to {output}: {' '.join(names)}")

    def doubts(self, posterior: backanalysis.Posterior) -> List[Finding]:
        """The caveats on the result."""
        plan, targets = self.plan, self.observed.targets
        failed, gone, runs = [one.name for one in plan.runs if one.error], self.gone(), len(plan.runs)
        several = []
        if failed:
            several.append(Finding("failed fits", {"failed": len(failed), "runs": runs,
                                                   "which": ", ".join(failed[:3])}))
        if gone:
            several.append(Finding("lost fits", {"lost": len(gone), "runs": runs,
                                                 "volume": max(row.lost_m3 for row in gone)}))
        if len(targets) < len(self.variables):
            known, asked = len(targets), len(self.variables)
            several.append(Finding("underdetermined", {
                "known": f"{in_words(known)} observed number{'s' * (known > 1)}", "asked": in_words(asked)}))
        blind = [target.name for target, one in zip(targets, posterior.emulators) if not one.noise_seen]
        if blind:
            several.append(Finding("no scatter", {"which": ", ".join(blind)}))
        offsets = repeats.unmoved([*(name for one in plan.chances for name in one),
                                   *(one.name for one in self.variables)], self.work.defaults)
        if offsets:
            several.append(Finding("one lattice", {"offsets": ", ".join(offsets)}))
        lacks = self.mass()
        if lacks:
            several.append(lacks)
        return several + judged.not_at_rest(self.finished)

    def mass(self) -> Optional[Finding]:
        """That the mapped thickness cannot be of the mass that is released; None where it can, or nothing is known."""
        released = [row.released_m3 for row in self.finished]
        volume = self.observed.volume
        return mapped.mass(volume, sum(released) / len(released)) if released else None

    def gone(self) -> List[Finished]:
        """The runs that lost so much that they are left out."""
        return [row for row in self.finished if not self.observed.told_by(row)]

    def model(self) -> Dict[str, str]:
        """What else of the law of contact and of the ground the values were found with."""
        values = self.finished[0].variables
        return {name: values[name] for name in MODEL
                if name in values and name not in {one.name for one in self.variables}}

    def known(self, posterior: backanalysis.Posterior, i: int) -> Dict[str, Any]:
        """What is known of a variable."""
        one = self.variables[i]
        low, high = posterior.interval(i)
        return {"best": float(self.plan.ledger.points[self.plan.number - 1][one.name]), "low": float(one.value(low)),
                "high": float(one.value(high)), "share_of_range": high - low,
                "identifiable": "no" if high - low > backanalysis.UNKNOWN else
                "roughly" if high - low > backanalysis.ROUGH else "yes"}

    def pairs(self, posterior: backanalysis.Posterior) -> List[Dict[str, Any]]:
        """The regions over pairs of variables: rows of bins, x for those that belong to it."""
        pairs = []
        for j in range(len(self.variables)):
            for i in range(j):
                pair = posterior.pair(i, j)
                sides = {self.variables[k].name: [float(self.variables[k].value(pair.low[n])),
                                                  float(self.variables[k].value(pair.high[n]))]
                         for n, k in enumerate((i, j))}
                pairs.append({"box": sides, "rows_of": self.variables[j].name,
                              "region": ["".join(".x"[int(one)] for one in row) for row in pair.inside.T]})
        return pairs

    def table(self, posterior: backanalysis.Posterior) -> str:
        """The CSV over all runs: values, outputs, score."""
        targets, plan = self.observed.targets, self.plan
        names = [one.name for one in self.variables]
        rows = []
        for i, run in enumerate(plan.runs):
            outputs = plan.outputs[i]
            cells = [""] * (1 + len(targets)) if outputs is None else [
                f"{backanalysis.misfits(outputs[None], posterior, targets)[0]:.6g}",
                *(f"{value:.9g}" for value in outputs)]
            rows.append([run.name, *(plan.ledger.points[i][name] for name in names), run.key, *cells,
                         "failed" if run.error else "finished" if outputs is not None else "left the terrain"])
        return disk.csv_text(["run", *names, "repeat", "score", *(f"{one.name} ({one.unit})" for one in targets),
                              "status"], rows)

    def draw_map(self, path: Path, best: repeats.Repeat) -> None:
        """Predicted against mapped."""
        [row] = [one for one in self.finished if one.run == best.name]
        prefix = run_folders.prefix_of(self.summary(row))
        run_ = deposit.read_deposit(prefix, self.terrain(best), lambda text: None)
        mapped, simulated = self.observed.mapped, run_.raster.z > self.wanted.threshold
        about = {"prefix": best.name, "threshold": self.wanted.threshold,
                 "area": score.overlap(simulated, mapped, run_.cell),
                 "runout": score.compare_runout(run_, simulated, mapped)}
        score.draw_score(path, run_, simulated, mapped, about)

    @staticmethod
    def comparison(targets: Sequence[Mapping[str, Any]]) -> List[str]:
        """Predicted against observed, a line each."""
        number_ = quantities.format_quantity
        lines = []
        for one in targets:
            goal = f"{number_(one['attainable'])} at the least" if one["observed"] is None else number_(one["observed"])
            predicted = "unknown, the run failed or left the terrain" if one["predicted"] is None else \
                number_(one["predicted"])
            lines.append(f"{one['name']}: predicted {predicted}, observed {goal} ({one['unit']}; s of a run "
                         f"by chance {number_(one['chance'])})")
        return lines


# --- what is said first of a calibration ---

def misses(posterior: Posterior, targets: Sequence[Target], predicted: Optional[np.ndarray]) -> List[str]:
    """The observed numbers that the run at the best values is far from; predicted: its outputs, None if it has none."""
    if predicted is None:
        return ["the run at the best values says nothing: it failed, or left the terrain"]
    lines = []
    for one, value, noise in zip(targets, predicted, posterior.noise):
        if one.value is not None and abs(value - one.value) > BEYOND * math.hypot(one.deviation, noise):
            lines.append("the run at the best values misses the observation by more than tolerance and chance "
                         f"explain: {one.name} {format_quantity(value)} instead of {format_quantity(one.value)} "
                         f"{one.unit}")
    return lines


def jumps(posterior: Posterior, targets: Sequence[Target]) -> List[str]:
    """The gaps of the observed numbers."""
    lines = []
    for target, several in zip(targets, posterior.gaps):
        for gap in several:
            text = (f"{target.name}: no run gives a value between {format_quantity(gap.low)} and "
                    f"{format_quantity(gap.high)} {target.unit}, "
                    "where the response jumps, as over a step of the ground")
            if target.value is not None and gap.holds(target.value):
                text += f"; the observed {format_quantity(target.value)} lies there, and no values reproduce it"
            lines.append(text)
    return lines
