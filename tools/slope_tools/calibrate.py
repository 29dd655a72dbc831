"""slope calibrate: which values of a deck's variables give what was observed, and how well they are known.

Order of the work: check what was observed (observations.py), make runs batch after batch where they say most
(calibration.py, backanalysis.py), run them as `slope study` does (study.py, jobs.py), write what they say together.
"""
import argparse
import csv
import io
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence

import numpy as np
import yaml

from . import (backanalysis, calibration, deposit, distributions, jobs, observations, repeats, results, runs, score,
               sensitivity, study)
from .cli import number
from .errors import SlopeError
from .settings import check_settings, one_value_each

TOLERANCE = 0.05
TABLE, ABOUT, CHART, MAP = "calibrate.csv", "calibrate.yaml", "calibrate.png", "predicted.png"

EPILOG = """\
units: metres, m2, m3 of ground (bulk).

example: friction, rolling resistance and roughness from a mapped deposit, by 60 runs:
  tools/slope calibrate in.collapse --observed deposit.geojson --vary friction=15:40 --vary rolling=0:0.2 \\
      --vary spacing=0.5:1.3 --repeat xoffset=0.25,0.5,0.75 --runs 60 -o fit

from numbers alone, such as those of a report:
  tools/slope calibrate in.collapse --front 2000 --area 850000 --vary friction=10:35 --vary rolling=0:0.2 \\
      --runs 40 -o fit

The same command goes on after an interruption; more --runs add to those there are. Writes DIR/calibrate.csv,
DIR/calibrate.yaml, the regions over pairs of variables DIR/calibrate.png, and, with --observed, predicted against
mapped DIR/predicted.png.
"""


def add_parser(commands, **kwargs):
    """Add `calibrate` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "calibrate", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Which values of a deck's variables give a deposit that was observed, and how well they are "
                    "known.", **kwargs)
    study.add_deck(parser)
    parser.add_argument("--observed", metavar="POLYGON|RASTER", type=Path,
                        help="the mapped deposit: its outline, or its thickness in metres, as for `slope score`")
    parser.add_argument("--front", metavar="L", type=number,
                        help="distance in plan from the highest released ball that 99 %% of the volume stays within, m")
    parser.add_argument("--area", metavar="A", type=number,
                        help="area that the mass ever covered, thicker than --threshold, m2")
    parser.add_argument("--volume", metavar="V", type=number, help="volume on the road of --road, m3")
    parser.add_argument("--tolerance", metavar="SHARE", type=number, default=TOLERANCE,
                        help="standard deviation of what was observed, as a share of it "
                             f"(default {TOLERANCE:g}); chance comes on top")
    parser.add_argument("--threshold", metavar="T", type=number, default=score.THRESHOLD,
                        help=f"a deposit is where it is thicker than this, m (default {score.THRESHOLD:g})")
    parser.add_argument("--vary", metavar="NAME=LO:HI", action="append", default=[], required=True,
                        help="a variable of the deck that is looked for, and its range; all values in it are equally "
                             "likely before (loguniform:LO:HI and the others of `slope study` too)")
    parser.add_argument("--runs", metavar="N", type=study.count, required=True, help="how many runs, all in all")
    parser.add_argument("--set", metavar="NAME=VALUE", action="append", default=[],
                        help="value of another index variable in all runs (default: the deck's)")
    parser.add_argument("--seed", metavar="S", type=int, default=1, help="of the first points (default 1)")
    repeats.add_arguments(parser)
    study.add_runs(parser)
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input, and where too few runs finished."""
    wanted = observations.Wanted(args.observed, args.front, args.area, args.volume, args.tolerance, args.threshold,
                                 args.local)
    variables = distributions.parse(args.vary, args.deck, ranges_only=True)
    fixed = one_value_each(check_settings(args.set, args.deck), "--set", "--vary")
    repeated = check_settings(args.repeat, args.deck, "--repeat")
    repeats.check(list(repeated), args.equally_good)
    for one in variables:
        for option, names in (("--set", fixed), ("--repeat", repeated)):
            if one.name in names:
                raise SlopeError("--vary", f"must not name a variable of {option}", one.name)
    least = 2 * len(variables) + 3
    if args.runs < least:
        raise SlopeError("--runs", f"must be at least {least} for {len(variables)} parameters", args.runs)
    if not 0 <= args.seed < 2 ** 32:
        raise SlopeError("--seed", "must be from 0 to 4294967295", args.seed)
    wanted.check(args.road is not None)
    terrain = study.terrain_of(args.deck, fixed)
    if terrain:
        wanted.check_place(terrain)
    settings = {name: [value] for name, value in fixed.items()}
    files = study.data_files(args.deck, {**settings, **repeated})
    if args.road:
        study.check_road(args, settings)
    study.check_folder(args, [])
    about = {**wanted.about, "deck": args.deck.name, "set": fixed, "repeat": repeated,
             "variables": {one.name: one.told for one in variables}, "seed": args.seed}
    ledger = calibration.Ledger(args.output, about, variables)
    chances = repeats.chances_of(repeated, {**runs.index_variables(args.deck), **fixed})
    batch = args.jobs or max(1, jobs.cores() // args.np)
    work_plan = calibration.Calibration(ledger, args.output, fixed, chances, args.seed, args.runs, batch)
    if args.dry_run:
        first = backanalysis.first(len(variables), args.seed)[:args.runs - 1]
        print(f"{args.runs} runs: {len(ledger.points) or len(first)} decided on; the others follow from what they give")
        return
    with study.prepared(args, files, batch) as work:
        Fit(args, wanted, work_plan, work).do()


class Fit:
    """A calibration under way: makes its runs, measures them, and writes what came out."""

    def __init__(self, args, wanted: observations.Wanted, plan: calibration.Calibration, work: jobs.Work):
        self.args, self.wanted, self.plan, self.work = args, wanted, plan, work
        self.observed = observations.Observations(wanted)
        self.rows: Dict[str, Mapping[str, Any]] = {}

    @property
    def variables(self):
        return self.plan.ledger.variables

    def do(self) -> None:
        found = self.plan.do(self.evaluate, lambda: self.observed.targets, lambda line: print(line, flush=True))
        self.write(found)

    def evaluate(self, todo: Sequence[repeats.Repeat]) -> List[Optional[np.ndarray]]:
        """Run what is not finished, and measure all."""
        study.check_names(todo)
        study.check_folder(self.args, todo)
        for one in todo:
            jobs.check_finished(one, self.args.deck, self.work.digests)
        self.work.do(todo)
        rows, _ = results.rows_of(self.args, todo, results.Maps(()), pictures=False)
        found: List[Optional[np.ndarray]] = []
        for one, row in zip(todo, rows):
            self.rows[one.name] = row
            found.append(None if one.error else self.observed.measure(self.summary(row), self.terrain(one), row))
        return found

    def summary(self, row: Mapping[str, Any]) -> Path:
        return self.args.output / row["summary"]

    @staticmethod
    def terrain(one: repeats.Repeat) -> Optional[Path]:
        path = one.log.terrain and one.folder / one.log.terrain
        return path if path and path.is_file() else None

    # --- results ---

    def write(self, found: backanalysis.Posterior) -> None:
        """Table, YAML, chart, and the map of the run at the best values."""
        output, plan, targets = self.args.output, self.plan, self.observed.targets
        best = plan.runs[plan.number - 1]
        predicted = plan.outputs[plan.number - 1]
        words = backanalysis.judgement(found, self.variables)
        failed = [one.name for one in plan.runs if one.error]
        doubts = [f"{len(failed)} of {len(plan.runs)} runs failed and say nothing: {', '.join(failed[:3])}"] \
            if failed else []
        if len(targets) < len(self.variables):
            doubts.append(f"{len(targets)} observed numbers cannot tell {len(self.variables)} variables")
        moving = sum(not row["at_rest"] for row in self.rows.values() if row["status"] == "finished")
        if moving:
            doubts.append(f"{moving} deposits are not at rest")
        about = {
            "calibration": {**plan.ledger.about, "runs": plan.number, "failed": len(failed), "package":
                            self.work.package, "collected": runs.now(), "machine": runs.machine()},
            "best": {"set": plan.ledger.points[plan.number - 1], "run": best.name,
                     "score": None if predicted is None else float(backanalysis.misfits(
                         predicted[None], found, targets)[0])},
            "variables": {one.name: self.known(found, i) for i, one in enumerate(self.variables)},
            "correlation": [[round(float(value), 3) for value in row] for row in found.correlation()],
            "misfit": found.misfit, "words": words, "doubts": doubts,
            "targets": [{"name": one.name, "unit": one.unit, "observed": one.value, "attainable": float(goal),
                         "tolerance": one.deviation, "chance": float(noise),
                         "predicted": None if predicted is None else float(predicted[i])}
                        for i, (one, goal, noise) in enumerate(zip(targets, found.goals, found.noise))],
            "pairs": self.pairs(found)}
        runs.write(output / TABLE, self.table(found))
        runs.write(output / ABOUT, "# slope calibrate: lengths in m, areas in m2, volumes in m3 of ground (bulk)\n"
                   + yaml.safe_dump(about, sort_keys=False))
        from . import calibrate_charts
        calibrate_charts.draw(output / CHART, found, self.variables, plan.ledger.places(plan.finished()),
                              f"{self.args.deck.name}: {len(plan.finished())} runs")
        names = [TABLE, ABOUT, CHART]
        if self.wanted.observed is not None and predicted is not None:
            self.draw_map(output / MAP, best)
            names.append(MAP)
        print("\n".join([*words, *self.told(about["targets"]), *(f"doubt: {text}" for text in doubts)]))
        print(f"best values: run {best.name}; written to {output}: {' '.join(names)}")

    def known(self, found: backanalysis.Posterior, i: int) -> Dict[str, Any]:
        """What is known of a variable."""
        one = self.variables[i]
        low, high = found.interval(i)
        return {"best": float(self.plan.ledger.points[self.plan.number - 1][one.name]), "low": float(one.value(low)),
                "high": float(one.value(high)), "share_of_range": high - low,
                "identifiable": "no" if high - low > backanalysis.UNKNOWN else
                "roughly" if high - low > backanalysis.ROUGH else "yes"}

    def pairs(self, found: backanalysis.Posterior) -> List[Dict[str, Any]]:
        """The regions over pairs of variables: rows of bins, x for those that belong to it."""
        pairs = []
        for j in range(len(self.variables)):
            for i in range(j):
                pair = found.pair(i, j)
                sides = {self.variables[k].name: [float(self.variables[k].value(pair.low[n])),
                                                  float(self.variables[k].value(pair.high[n]))]
                         for n, k in enumerate((i, j))}
                pairs.append({"box": sides, "rows_of": self.variables[j].name,
                              "region": ["".join(".x"[int(one)] for one in row) for row in pair.inside.T]})
        return pairs

    def table(self, found: backanalysis.Posterior) -> str:
        """The CSV over all runs: values, outputs, score."""
        targets, plan = self.observed.targets, self.plan
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        names = [one.name for one in self.variables]
        writer.writerow(["run", *names, "repeat", "score", *(f"{one.name} ({one.unit})" for one in targets), "status"])
        for i, one in enumerate(plan.runs):
            outputs = plan.outputs[i]
            cells = [""] * (1 + len(targets)) if outputs is None else [
                f"{backanalysis.misfits(outputs[None], found, targets)[0]:.6g}", *(f"{value:.9g}" for value in outputs)]
            writer.writerow([one.name, *(plan.ledger.points[i][name] for name in names), one.key, *cells,
                             "failed" if one.error else "finished"])
        return text.getvalue()

    def draw_map(self, path: Path, best: repeats.Repeat) -> None:
        """Predicted against mapped."""
        run_ = deposit.read(runs.prefix_of(self.summary(self.rows[best.name])), self.terrain(best), lambda text: None)
        mapped, simulated = self.observed.mapped, run_.raster.z > self.wanted.threshold
        about = {"prefix": best.name, "threshold": self.wanted.threshold,
                 "area": score.overlap(simulated, mapped, run_.cell), "runout": score.runout(run_, simulated, mapped)}
        score.draw(path, run_, simulated, mapped, about)

    @staticmethod
    def told(targets: Sequence[Mapping[str, Any]]) -> List[str]:
        """Predicted against observed, a line each."""
        number_ = sensitivity.number
        lines = []
        for one in targets:
            goal = f"{number_(one['attainable'])} at the least" if one["observed"] is None else number_(one["observed"])
            predicted = "unknown, the run failed" if one["predicted"] is None else number_(one["predicted"])
            lines.append(f"{one['name']}: predicted {predicted}, observed {goal} ({one['unit']}; chance "
                         f"{number_(one['chance'])})")
        return lines
