"""What one variable of a deck does to a quantity, beside the scatter by chance."""
import math
import statistics
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from rich.table import Table

from .. import disk, provenance
from ..case import decks
from ..case.settings import normalise_value
from ..deposits import travel_shares
from ..errors import SlopeError
from ..findings import Finding, encode_findings
from ..runs import repeats
from ..statistics.conservative_volume import Scatter
from ..tables import combinations, judged, study_table
from ..tables.quantities import ALL, NEED_ROAD, On, keys, format_quantity
from ..tables.rows import Finished, encode_row, finished_of
from .outcome import unseen
from .run_rows import read_run_rows
from .setup import Setup

OF_ROAD = "remove_m3,remove_on_road_m3"
OF_TRAVEL = f"{travel_shares.DISTANCE},centroid_m"      # without a road


class Trial(repeats.Repeat):
    """A run that differs from the base run in one variable; kind: base, vary or repeat."""

    def __init__(self, output, chosen, kind: str, variable: Optional[str] = None):
        super().__init__(output, chosen)
        self.kind, self.variable = kind, variable
        if variable:
            self.varied = f"{variable} {chosen[variable]}"


class Tried(NamedTuple):
    """What a Trial said; value: of its variable, None of the base run."""
    kind: str
    variable: Optional[str]
    value: Optional[str]
    row: Finished

    def of(self, name: str) -> float:
        """A quantity, which every run has."""
        return self.row.value(name)


def quantities(wanted: Optional[str], road: bool, converge: bool) -> List[str]:
    """The columns of --of, those of a road only if there is one."""
    asked = keys(On.ASKED)
    of = (wanted or (OF_ROAD if road or not converge else OF_TRAVEL)).split(",")
    for name in of:
        if name not in asked or of.count(name) > 1:
            raise SlopeError("--of", f"must be different ones of {', '.join(asked)}", wanted)
        if name in NEED_ROAD and not road:
            raise SlopeError("--road", f"must be given for {name} (--of takes others)")
    return of


def plan_trials(setup: Setup, base: Mapping[str, str], kinds) -> List[Trial]:
    """The base run, and one for each value of each variable that is not the base's."""
    first = Trial(setup.runs, base, "base")
    defaults = {**decks.index_variables(setup.deck), **base}
    todo = [first]
    for kind, variables in kinds.items():
        for name, several in variables.items():
            for value in several:
                if normalise_value(value) == normalise_value(defaults[name]):
                    continue
                todo.append(Trial(setup.runs, {**base, name: value}, kind, name))
    if len(todo) == 1:
        raise SlopeError("--try, --repeat", "must give a value that is not the base's")
    return todo


def collect_trials(setup: Setup, base, of, todo, work):
    """Table, chart and sensitivity.yaml over all runs that finished."""
    defaults = {**work.defaults, **base}
    rows = read_run_rows(setup, todo)
    tried = [Tried(trial.kind, trial.variable, trial.chosen[trial.variable] if trial.variable else None, row)
             for trial, row in zip(todo, rows) if isinstance(row, Finished)]
    if not tried or tried[0].kind != "base":
        return      # nothing to hold the others against; which run failed is said at the end
    for name in of:
        for trial in tried:
            if trial.row.value(name) is None:
                raise SlopeError("--of", f"must be known of every run; {name} is not of {trial.row.run}")
    repeated = {one.variable: () for one in todo if one.kind == "repeat" and one.variable}
    tried, same = leave_out_same(tried)
    warnings = [*judged.of_runs(rows), *unseen(repeated, defaults), *same]
    scatter = {name: measure_spread(tried, name) for name in of}
    summary = {"study": {"deck": setup.deck.name, "base": defaults, "runs": len(todo),
                         "finished": len(finished_of(rows)), "ranks": work.ranks, "package": work.package,
                         "collected": provenance.now(), "machine": provenance.machine(),
                         "road": setup.road.about() if setup.road else None},
               "scatter": scatter, "trust": [trust(tried, name, scatter[name]) for name in of],
               "warnings": encode_findings(warnings)}
    for found in warnings:
        setup.warn(found)
    disk.write_file(setup.output / "sensitivity.csv", tabulate_sensitivity(tried, of, scatter, defaults))
    disk.write_file(setup.output / "sensitivity.yaml", disk.yaml_text(
        "slope sensitivity: volumes in m3 of ground (bulk), lengths in m, angles in degrees", summary))
    from ..drawing import figures
    figures.tornado(setup.output / "sensitivity.png", panels(tried, of, scatter), bars(tried, defaults),
                    f"{setup.deck.name}: one variable at a time, {len(tried)} runs")
    setup.tell(shown_of(tried, of, scatter, defaults, setup.deck.name))
    setup.tell(f"{setup.output / 'sensitivity.csv'}, {setup.output / 'sensitivity.yaml'}, "
               f"{setup.output / 'sensitivity.png'}: all numbers, and the chart")
    setup.tell("\n".join(summary["trust"]))


# --- numbers ---

def leave_out_same(tried: Sequence[Tried]) -> Tuple[List[Tried], List[Finding]]:
    """Without repeats that have the numbers of another run, to the last digit, and so no chance; choices that have
    those of the base run stay, and both are told."""
    first = combinations.same_as([one.row for one in tried])
    same = [one for k, one in enumerate(tried) if first[k] != k and (one.kind == "repeat" or first[k] == 0)]
    findings = [Finding("no effect", {
        "which": one.variable, "on": f" at {one.value}", "then": "left out" if one.kind == "repeat" else
        "it is not tested"}, (one.row.run,)) for one in same]
    return [one for one in tried if one.kind != "repeat" or one not in same], findings


def measure_spread(tried: Sequence[Tried], name):
    """Mean, standard deviation and range of the base run and its repeats; the deviation is None where nothing tells
    it: without repeats, or where all are equal, as where nothing reaches the road."""
    values = [one.of(name) for one in tried if one.kind != "vary"]
    return {"runs": len(values), "mean": statistics.fmean(values), "smallest": min(values), "largest": max(values),
            "standard_deviation": statistics.stdev(values) if min(values) < max(values) else None}


def effect(trial: Tried, name, summary):
    """Difference of a run from the mean of the equivalent ones."""
    return trial.of(name) - summary["mean"]


def scatter_of(summary):
    """The scatter of the equivalent runs, with t for their number."""
    return Scatter(summary["standard_deviation"], summary["runs"] - 1)


def is_clear(trial: Tried, name, summary):
    """Whether a run differs from the mean by more than such a run does by chance; None without repeats."""
    if summary["standard_deviation"] is None:
        return None
    # the mean has a scatter of its own
    return abs(effect(trial, name, summary)) > scatter_of(summary).chance(summary["runs"])


def trust(tried: Sequence[Tried], name, summary):
    """In plain words: how much a number of one run is worth."""
    what, unit = ALL[name].name, ALL[name].unit
    mean, deviation = summary["mean"], summary["standard_deviation"]
    if deviation is None:
        runs = f"each of {summary['runs']} equivalent runs" if summary["runs"] > 1 else "the base run"
        text = f"{what}: {format_quantity(mean)} {unit} in {runs}; how it scatters is unknown"
    else:
        deviation_of_run = scatter_of(summary).quantile * deviation
        text = (f"{what}: {summary['runs']} equivalent runs give {format_quantity(summary['smallest'])} to "
                f"{format_quantity(summary['largest'])} {unit}, mean {format_quantity(mean)}, standard deviation "
                f"{format_quantity(deviation)}"
                f"{share(deviation, mean)}: one run is accurate to +- {format_quantity(deviation_of_run)} {unit}"
                f"{share(deviation_of_run, mean)}, and two runs are different only if they differ by more "
                f"than {format_quantity(math.sqrt(2) * deviation_of_run)} {unit}")
    varied = [one for one in tried if one.kind == "vary"]
    if varied:
        most = max(varied, key=lambda trial: abs(effect(trial, name, summary)))
        by = effect(most, name, summary)
        text += (f". Of the choices, {most.variable} {most.value} changes it most, by {format_quantity(by, '+')} {unit}"
                 f"{share(by, mean, '+')}")
        if deviation is not None:
            clear = sum(is_clear(one, name, summary) for one in varied)
            text += f"; {clear} of {len(varied)} changes are larger than chance"
    return text


def share(value, mean, sign=""):
    return f" ({100 * value / mean:{sign}.1f} %)" if mean else ""


# --- output ---

def tabulate_sensitivity(tried: Sequence[Tried], of, scatter, defaults):
    """The CSV over all runs."""
    columns = study_table.list_study_columns([one.row for one in tried])

    def line(trial: Tried):
        cells = {**encode_row(trial.row), "moving": answer(trial.row.moving), "at_rest": answer(trial.row.at_rest)}
        mine = [cell for name in of for cell in (effect(trial, name, scatter[name]),
                                                 answer(is_clear(trial, name, scatter[name])))]
        return [trial.row.run, trial.kind, trial.variable, trial.value, defaults.get(trial.variable), *mine,
                *(cells.get(key) for key in columns)]

    return disk.csv_text(["run", "kind", "variable", "value", "base_value",
                          *(f"{what}_of_{name}" for name in of for what in ("effect", "clear")), *columns],
                         map(line, tried))


def answer(value):
    return {True: "yes", False: "no", None: None}[value]


def bars(tried: Sequence[Tried], defaults):
    """{variable: (kind, base value)} in the order of the command."""
    return {one.variable: (one.kind, defaults[one.variable]) for one in tried if one.variable}


def panels(tried: Sequence[Tried], of, scatter):
    """For the chart: (title, unit, scatter, {variable: [(value of the variable, what came out), ...]})."""
    panels_ = []
    for name in of:
        values: Dict[str, List[Any]] = {}
        for one in tried:
            if one.variable:
                values.setdefault(one.variable, []).append((one.value, one.of(name)))
        panels_.append((ALL[name].name, ALL[name].unit, scatter[name], values))
    return panels_


def shown_of(tried: Sequence[Tried], of, scatter, defaults, deck) -> Table:
    shown = Table(title=f"{deck}: one variable at a time; * more than chance")
    for head in ("variable", "base", "value", "released m3"):
        shown.add_column(head, justify="right")
    for name in of:
        shown.add_column(f"{ALL[name].name} {ALL[name].unit}", justify="right")
        shown.add_column("against the mean", justify="right")
    for trial in tried:
        cells = [trial.variable or "base", defaults.get(trial.variable, ""), trial.value or "",
                 format_quantity(trial.row.released_m3)]
        for name in of:
            by = effect(trial, name, scatter[name])
            star = "*" if trial.kind == "vary" and is_clear(trial, name, scatter[name]) else " "
            cells += [format_quantity(trial.of(name)),
                      f"{format_quantity(by, '+')}{share(by, scatter[name]['mean'], '+')}{star}"]
        shown.add_row(*cells, style="dim" if trial.kind == "repeat" else None)
    return shown
