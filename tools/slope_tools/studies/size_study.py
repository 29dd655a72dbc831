"""slope sensitivity --converge: runs with balls of several sizes, the value for small balls and the error of each size.

Order of the work: plan sizes and repeats (repeats.py), run them as `slope study` does (study.py, jobs.py), fit
(convergence.py), write converge.yaml, converge.csv, converge_runs.csv and the chart (convergence_chart.py).
"""
from typing import Dict, List, Mapping, NamedTuple, Sequence

from rich.table import Table

from .. import disk, provenance
from ..case import decks
from ..case.settings import as_number, check_settings
from ..errors import SlopeError
from ..findings import Finding, entries
from ..runs import repeats
from ..statistics import convergence, headline
from ..tables import combinations, judged, study_table
from ..tables.quantities import ALL
from . import results, study
from .setup import Setup

OPTION = "--converge"


class Plan(NamedTuple):
    """The runs, those of each size in settings followed by their repeats; variable: what the size is called."""
    setup: Setup
    settings: Dict[str, List[str]]
    repeated: Mapping[str, Sequence[str]]
    variable: str
    todo: List[repeats.Repeat]


def run(setup: Setup, converge: str, base, repeated, of) -> None:
    """Do it; base: {name: value} of all runs, of: columns of the study's table."""
    planned = plan(setup, converge, base, repeated)
    study.perform(setup, {**planned.settings, **repeated}, planned.todo, lambda _, work: collect(planned, of, work))


def plan(setup: Setup, converge: str, base, repeated) -> Plan:
    """See run(); SlopeError on bad input."""
    [(variable, values)] = check_settings([converge], setup.deck, OPTION).items()
    for value in values:
        number = as_number(value)
        if not (isinstance(number, float) and 0 < number < float("inf")):
            raise SlopeError(OPTION, f"must give numbers > 0 for {variable}, which tends to 0", value)
    if len(values) < 2:
        raise SlopeError(OPTION, "must give two values at least, and three to see whether a line holds", converge)
    for other, option in ((base, "--set"), (repeated, "--repeat")):
        if variable in other:
            raise SlopeError(OPTION, f"must not name a variable of {option}", variable)
    settings = {**{name: [value] for name, value in base.items()}, variable: values}
    return Plan(setup, settings, repeated, variable,
                repeats.plan(setup.runs, settings, repeated, decks.index_variables(setup.deck)))


def collect(planned: Plan, of, work) -> None:
    """Fit and write what the finished runs tell."""
    setup, settings, repeated, variable, todo = planned
    names = {name: (ALL[name].name, ALL[name].unit) for name in of}
    rows, _ = results.rows_of(setup, todo, results.Maps(()))
    finished = [row for row in rows if row["status"] == "finished"]
    groups = combinations.grouped(rows)
    if len(groups) < 2:     # no line; perform() names the run that failed
        (setup.output / "converge.yaml").unlink(missing_ok=True)       # of runs before these
        return
    for name in of:
        for row in finished:
            if row[name] is None:
                raise SlopeError("--of", f"must be known of every run; {name} is not of {row['run']}")
    warnings = judged.of_runs(rows)
    same = [row["run"] for group in groups for row in group.same]
    if same:
        warnings.append(Finding("no effect", runs=same))
    fits = {}
    for name in of:
        fits[name] = convergence.fit([(float(group.set[variable]), list(group.of(name).volumes.values()))
                                      for group in groups])
    sentences = {name: convergence.words(fit, variable, names[name][0], names[name][1], writer(fit))
                 for name, fit in fits.items()}
    base = {**work.defaults, **{name: several[0] for name, several in settings.items() if name != variable}}
    base.pop(variable)
    about = {"study": {"deck": setup.deck.name, "variable": variable, "values": settings[variable], "base": base,
                       "repeat": repeated, "runs": len(rows), "finished": len(finished), "ranks": work.ranks,
                       "package": work.package, "collected": provenance.now(), "machine": provenance.machine(),
                       "road": setup.road.about() if setup.road else None},
             "quantities": {name: entry(fit, names[name], sentences[name]) for name, fit in fits.items()},
             "warnings": entries(warnings)}
    for one in warnings:
        setup.warn(one)
    setup.output.mkdir(exist_ok=True)
    disk.write(setup.output / "converge.csv", table(fits, variable))
    disk.write(setup.output / "converge_runs.csv", study_table.table(settings, repeated, rows, work.defaults))
    disk.write(setup.output / "converge.yaml", disk.yaml_text(
        f"slope sensitivity --converge: a line V0 + b {variable} through the values; volumes in m3 of ground (bulk), "
        "lengths in m", about))
    from ..tables import convergence_chart
    convergence_chart.draw(
        setup.output / "converge.png", variable, [(*names[name], fits[name], [
            (float(group.set[variable]), row[name]) for group in groups for row in group.rows]) for name in of],
        f"{setup.deck.name}: {len(finished)} runs, {len(groups)} values of {variable}")
    setup.tell(shown_of(fits, variable, names, setup.deck.name))
    setup.tell(", ".join(str(setup.output / f"converge.{kind}") for kind in ("yaml", "csv", "png"))
               + f", {setup.output / 'converge_runs.csv'}: all numbers, the chart, and the runs")
    setup.tell("\n".join(text for several in sentences.values() for text in several))


def writer(fit):
    """A function that writes a value rounded to what is known, by the standard error of the value for small balls."""
    error = fit.small.standard_error
    step = headline.place(error) if error else headline.place_of_digits(fit.small.value)
    return lambda value: headline.text(value, step)


def percent(share):
    return None if share is None else 100 * share


def entry(fit, name, sentences):
    """What converge.yaml says of a quantity."""
    def estimate(one):
        return one and {"value": one.value, "standard_error": one.standard_error}

    low, high = fit.interval or (None, None)
    return {
        "name": name[0], "unit": name[1],
        "small_balls": {**estimate(fit.small), "low": low, "high": high, "degrees_of_freedom": fit.degrees_of_freedom},
        "slope": estimate(fit.slope), "covariance": fit.covariance, "quantile": fit.quantile,
        "scatter": {"at_1": fit.scatter, "exponent": fit.exponent},
        "lack_of_fit": fit.lack and {"ratio": fit.lack[0], "probability": fit.lack[1]}, "supported": fit.supported,
        "parabola": fit.curved and {"small_balls": estimate(fit.curved_small), "clear": fit.curve_is_clear},
        "errors_known": fit.known,
        "sizes": [{"value": size.d, "runs": size.runs, "mean": size.mean, "scatter": size.scatter,
                   "fitted": size.fitted, "error_percent": percent(size.error),
                   "standard_error_percent": percent(size.standard_error)}
                  for size in fit.sizes],
        "words": sentences}


def table(fits, variable):
    """The CSV: a row per quantity and size; the last of a quantity is that of small balls, at 0."""
    rows = []
    for name, fit in fits.items():
        for size in fit.sizes:
            rows.append([name, size.d, size.runs, size.mean, size.scatter, size.fitted, fit.line_at(size.d)[1],
                         percent(size.error), percent(size.standard_error)])
        rows.append([name, 0, None, None, None, fit.small.value, fit.small.standard_error, 0 if fit.known else None,
                     None])
    return disk.csv_text(["quantity", variable, "runs", "mean", "scatter", "fitted", "standard_error",
                          "error_percent", "standard_error_percent"], rows)


def shown_of(fits, variable, names, deck) -> Table:
    shown = Table(title=f"{deck}: a line in {variable}; errors against its value at 0, with standard errors")
    heads = [head for name in fits for head in (" ".join(names[name]), "error")]
    for head in (variable, "runs", *heads):
        shown.add_column(head, justify="right")
    for k, size in enumerate(next(iter(fits.values())).sizes):
        cells = [f"{size.d:g}", str(size.runs)]
        for fit in fits.values():
            one, write = fit.sizes[k], writer(fit)
            cells.append(write(one.mean) + (f" s {write(one.scatter)}" if one.scatter is not None else ""))
            cells.append("-" if one.error is None else f"{100 * one.error:+.1f} %" + (
                f" +- {100 * one.standard_error:.1f}" if one.standard_error is not None else ""))
        shown.add_row(*cells)
    cells = ["0", ""]
    for fit in fits.values():
        write, error = writer(fit), fit.small.standard_error
        cells += [write(fit.small.value) + (f" +- {write(error)}" if error is not None else ""), ""]
    shown.add_section()
    shown.add_row(*cells)
    return shown
