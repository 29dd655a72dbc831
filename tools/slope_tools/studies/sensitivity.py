"""What one variable of a deck does to a quantity, beside the scatter by chance."""
import math
import statistics
from typing import Any, Dict, List, Mapping, Optional

from rich.table import Table

from .. import disk, provenance
from ..case import decks
from ..case.settings import as_number
from ..deposits import travel_shares
from ..errors import SlopeError
from ..findings import Finding, entries
from ..runs import jobs
from ..statistics.headline import Scatter
from ..tables import judged, study_table
from ..tables.quantities import ALL, NEED_ROAD, On, keys, number
from . import results
from .setup import Setup

OF_ROAD = "remove_m3,remove_on_road_m3"
OF_TRAVEL = f"{travel_shares.DISTANCE},centroid_m"      # without a road


class Trial(jobs.Run):
    """A run that differs from the base run in one variable; kind: base, vary or repeat."""

    def __init__(self, output, chosen, kind: str, variable: Optional[str] = None):
        super().__init__(output, chosen)
        self.kind, self.variable = kind, variable
        if variable:
            self.varied = f"{variable} {chosen[variable]}"


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


def plan(setup: Setup, base: Mapping[str, str], kinds) -> List[Trial]:
    """The base run, and one for each value of each variable that is not the base's."""
    first = Trial(setup.runs, base, "base")
    defaults = {**decks.index_variables(setup.deck), **base}
    todo = [first]
    for kind, variables in kinds.items():
        for name, several in variables.items():
            for value in several:
                if as_number(value) == as_number(defaults[name]):
                    continue
                todo.append(Trial(setup.runs, {**base, name: value}, kind, name))
    if len(todo) == 1:
        raise SlopeError("--levels, --repeat", "must give a value that is not the base's")
    return todo


def collect(setup: Setup, base, of, todo, work):
    """Table, chart and sensitivity.yaml over all runs that finished."""
    defaults = {**work.defaults, **base}
    rows, warnings = [], []
    for one in todo:
        row = {"run": one.name, "kind": one.kind, "variable": one.variable,
               "value": one.chosen[one.variable] if one.variable else None}
        if one.error:
            warnings.append(Finding("failed", {"error": one.error}, (one.name,)))
            continue
        found = {**row, **results.result(one, setup.output)}
        if setup.road:
            found.update(results.on_road(one, setup, found))
        rows.append(found)
    if not rows or rows[0]["kind"] != "base":
        return      # nothing to hold the others against; which run failed is said at the end
    for name in of:
        for row in rows:
            if row[name] is None:
                raise SlopeError("--of", f"must be known of every run; {name} is not of {row['run']}")
    warnings += judged.not_at_rest(rows)
    scatter = {name: spread(rows, name) for name in of}
    about = {"study": {"deck": setup.deck.name, "base": defaults, "runs": len(todo), "finished": len(rows),
                       "ranks": work.ranks, "package": work.package, "collected": provenance.now(),
                       "machine": provenance.machine(),
                       "road": setup.road.about() if setup.road else None},
             "scatter": scatter, "trust": [trust(rows, name, scatter[name]) for name in of],
             "warnings": entries(warnings)}
    for one in warnings:
        setup.warn(one)
    disk.write(setup.output / "sensitivity.csv", table(rows, of, scatter, defaults))
    disk.write(setup.output / "sensitivity.yaml", disk.yaml_text(
        "slope sensitivity: volumes in m3 of ground (bulk), lengths in m, angles in degrees", about))
    from ..drawing import figures
    figures.tornado(setup.output / "sensitivity.png", panels(rows, of, scatter), bars(rows, defaults),
                    f"{setup.deck.name}: one variable at a time, {len(rows)} runs")
    setup.tell(shown_of(rows, of, scatter, defaults, setup.deck.name))
    setup.tell(f"{setup.output / 'sensitivity.csv'}, {setup.output / 'sensitivity.yaml'}, "
               f"{setup.output / 'sensitivity.png'}: all numbers, and the chart")
    setup.tell("\n".join(about["trust"]))


# --- numbers ---

def spread(rows, name):
    """Mean, standard deviation and range of the base run and its repeats; the deviation is None without repeats."""
    values = [row[name] for row in rows if row["kind"] != "vary"]
    return {"runs": len(values), "mean": statistics.fmean(values), "smallest": min(values), "largest": max(values),
            "standard_deviation": statistics.stdev(values) if len(values) > 1 else None}


def effect(row, name, about):
    """Difference of a run from the mean of the equivalent ones."""
    return row[name] - about["mean"]


def scatter_of(about):
    """The scatter of the equivalent runs, with t for their number."""
    return Scatter(about["standard_deviation"], about["runs"] - 1)


def is_clear(row, name, about):
    """Whether a run differs from the mean by more than such a run does by chance; None without repeats."""
    if about["standard_deviation"] is None:
        return None
    # the mean has a scatter of its own
    return abs(effect(row, name, about)) > scatter_of(about).chance(about["runs"])


def trust(rows, name, about):
    """In plain words: how much a number of one run is worth."""
    what, unit = ALL[name].name, ALL[name].unit
    mean, deviation = about["mean"], about["standard_deviation"]
    if deviation is None:
        text = f"{what}: {number(mean)} {unit} in the base run; without --repeat its scatter is unknown"
    else:
        one = scatter_of(about).quantile * deviation
        text = (f"{what}: {about['runs']} equivalent runs give {number(about['smallest'])} to "
                f"{number(about['largest'])} {unit}, mean {number(mean)}, standard deviation {number(deviation)}"
                f"{share(deviation, mean)}: one run is accurate to +- {number(one)} {unit}"
                f"{share(one, mean)}, and two runs are different only if they differ by more "
                f"than {number(math.sqrt(2) * one)} {unit}")
    varied = [row for row in rows if row["kind"] == "vary"]
    if varied:
        most = max(varied, key=lambda row: abs(effect(row, name, about)))
        by = effect(most, name, about)
        text += (f". Of the choices, {most['variable']} {most['value']} changes it most, by {number(by, '+')} {unit}"
                 f"{share(by, mean, '+')}")
        if deviation is not None:
            clear = sum(is_clear(row, name, about) for row in varied)
            text += f"; {clear} of {len(varied)} changes are larger than chance"
    return text


def share(value, mean, sign=""):
    return f" ({100 * value / mean:{sign}.1f} %)" if mean else ""


# --- output ---

def table(rows, of, scatter, defaults):
    """The CSV over all runs."""
    columns = study_table.columns_of(rows)

    def line(row):
        cells = {**row, "moving": answer(row["moving"]), "at_rest": answer(row["at_rest"])}
        mine = [cell for name in of for cell in (effect(row, name, scatter[name]),
                                                 answer(is_clear(row, name, scatter[name])))]
        return [row["run"], row["kind"], row["variable"], row["value"], defaults.get(row["variable"]), *mine,
                *(cells.get(key) for key in columns)]

    return disk.csv_text(["run", "kind", "variable", "value", "base_value",
                          *(f"{what}_of_{name}" for name in of for what in ("effect", "clear")), *columns],
                         map(line, rows))


def answer(value):
    return {True: "yes", False: "no", None: None}[value]


def bars(rows, defaults):
    """{variable: (kind, base value)} in the order of the command."""
    return {row["variable"]: (row["kind"], defaults[row["variable"]]) for row in rows if row["variable"]}


def panels(rows, of, scatter):
    """For the chart: (title, unit, scatter, {variable: [(value of the variable, what came out), ...]})."""
    found = []
    for name in of:
        values: Dict[str, List[Any]] = {}
        for row in rows:
            if row["variable"]:
                values.setdefault(row["variable"], []).append((row["value"], row[name]))
        found.append((ALL[name].name, ALL[name].unit, scatter[name], values))
    return found


def shown_of(rows, of, scatter, defaults, deck) -> Table:
    shown = Table(title=f"{deck}: one variable at a time; * more than chance")
    for head in ("variable", "base", "value", "released m3"):
        shown.add_column(head, justify="right")
    for name in of:
        shown.add_column(f"{ALL[name].name} {ALL[name].unit}", justify="right")
        shown.add_column("against the mean", justify="right")
    for row in rows:
        cells = [row["variable"] or "base", defaults.get(row["variable"], ""), row["value"] or "",
                 number(row["released_m3"])]
        for name in of:
            by = effect(row, name, scatter[name])
            star = "*" if row["kind"] == "vary" and is_clear(row, name, scatter[name]) else " "
            cells += [number(row[name]), f"{number(by, '+')}{share(by, scatter[name]['mean'], '+')}{star}"]
        shown.add_row(*cells, style="dim" if row["kind"] == "repeat" else None)
    return shown
