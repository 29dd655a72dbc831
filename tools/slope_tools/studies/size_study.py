"""slope sensitivity --converge: runs with balls of several sizes, and whether halving them changes more than chance.

Order of the work: plan sizes and repeats (repeats.py), run them as `slope study` does (study.py, jobs.py), compare
(convergence.py), write converge.yaml, converge.csv, converge_runs.csv and the chart.
"""
from typing import Dict, List, Mapping, NamedTuple, Sequence

from rich.table import Table

from .. import disk, provenance
from ..case import decks
from ..case.settings import normalise_value, check_settings
from ..errors import SlopeError
from ..findings import encode_findings
from ..runs import repeats
from ..statistics import convergence, rounding
from ..tables import combinations, judged, sizes, study_table
from ..tables.quantities import ALL
from ..tables.rows import finished_of
from . import body_depth, study
from .run_rows import read_run_rows
from .setup import Setup

OPTION = "--converge"


class Plan(NamedTuple):
    """The runs, those of each size in settings followed by their repeats; variable: what the size is called."""
    setup: Setup
    settings: Dict[str, List[str]]
    repeated: Mapping[str, Sequence[str]]
    variable: str
    todo: List[repeats.Repeat]


def run_size_study(setup: Setup, converge: str, base, repeated, of) -> None:
    """Do it; base: {name: value} of all runs, of: columns of the study's table."""
    planned = plan_size_study(setup, converge, base, repeated)
    study.perform(setup, {**planned.settings, **repeated}, planned.todo, lambda _,
                  work: collect_sizes(planned, of, work))


def plan_size_study(setup: Setup, converge: str, base, repeated) -> Plan:
    """See run_size_study(); SlopeError on bad input."""
    [(variable, values)] = check_settings([converge], setup.deck, OPTION).items()
    for value in values:
        number = normalise_value(value)
        if not (isinstance(number, float) and 0 < number < float("inf")):
            raise SlopeError(OPTION, f"must give numbers > 0 for {variable}", value)
    if len(values) < 2:
        raise SlopeError(OPTION, "must give two values at least, and three, each half of the one before, to see what "
                         "is resolved", converge)
    for other, option in ((base, "--set"), (repeated, "--repeat")):
        if variable in other:
            raise SlopeError(OPTION, f"must not name a variable of {option}", variable)
    settings = {**{name: [value] for name, value in base.items()}, variable: values}
    return Plan(setup, settings, repeated, variable,
                repeats.plan_repeats(setup.runs, settings, repeated, decks.index_variables(setup.deck)))


def collect_sizes(planned: Plan, of, work) -> None:
    """Compare and write what the finished runs tell."""
    setup, settings, repeated, variable, todo = planned
    names = {name: (ALL[name].name, ALL[name].unit) for name in of}
    rows = read_run_rows(setup, todo)
    finished = finished_of(rows)
    groups = combinations.grouped(rows)
    if len(groups) < 2:     # nothing to compare; perform() names the run that failed
        (setup.output / "converge.yaml").unlink(missing_ok=True)       # of runs before these
        return
    for name in of:
        for row in finished:
            if row.value(name) is None:
                raise SlopeError("--of", f"must be known of every run; {name} is not of {row.run}")
    warnings = [*judged.of_runs(rows), *combinations.no_effect(groups)]
    finest = min(groups, key=lambda group: float(group.set[variable])).rows[0]
    depth = body_depth.mean(setup, finest) if variable == sizes.VARIABLE else None
    balls = [depth and depth / float(group.set[variable]) for group in groups]
    convergences = {name: convergence.compare([(float(group.set[variable]), list(group.of(name).volumes.values()))
                                               for group in groups], balls) for name in of}
    sentences = {name: convergence.describe_convergence(one, variable, *names[name], writer(one)) for name, one
                 in convergences.items()}
    base = {**work.defaults, **{name: several[0] for name, several in settings.items() if name != variable}}
    base.pop(variable)
    summary = {"study": {"deck": setup.deck.name, "variable": variable, "values": settings[variable], "base": base,
                         "repeat": repeated, "runs": len(rows), "finished": len(finished), "ranks": work.ranks,
                         "package": work.package, "collected": provenance.now(), "machine": provenance.machine(),
                         "road": setup.road.about() if setup.road else None},
               "quantities": {name: entry(one, names[name], sentences[name]) for name, one in convergences.items()},
               "warnings": encode_findings(warnings)}
    for one in warnings:
        setup.warn(one)
    setup.output.mkdir(exist_ok=True)
    disk.write_file(setup.output / "converge.csv", tabulate_sizes(convergences, variable))
    disk.write_file(setup.output / "converge_runs.csv", study_table.tabulate_study(settings, repeated, rows,
                                                                                   work.defaults))
    disk.write_file(setup.output / "converge.yaml", disk.yaml_text(
        f"slope sensitivity --converge: values of {variable}; volumes in m3 of ground (bulk), lengths in m", summary))
    draw_convergence(
        setup.output / "converge.png", variable, [(*names[name], convergences[name], [
            (float(group.set[variable]), row.value(name)) for group in groups for row in group.rows]) for name in of],
        f"{setup.deck.name}: {len(finished)} runs, {len(groups)} values of {variable}")
    setup.tell(shown_of(convergences, variable, names, setup.deck.name))
    setup.tell(", ".join(str(setup.output / f"converge.{kind}") for kind in ("yaml", "csv", "png"))
               + f", {setup.output / 'converge_runs.csv'}: all numbers, the chart, and the runs")
    setup.tell("\n".join(text for several in sentences.values() for text in several))


def writer(convergence_: convergence.Convergence):
    """A function that writes a value rounded to what is known, by the largest scatter of a run."""
    scatter = max((size.scatter or 0.0 for size in convergence_.sizes), default=0.0)
    step = rounding.choose_rounding(scatter) if scatter else rounding.place_of_digits(convergence_.sizes[0].mean)
    return lambda value: rounding.format_rounded(value, step)


def entry(convergence_: convergence.Convergence, name, sentences):
    """What converge.yaml says of a quantity."""
    return {
        "name": name[0], "unit": name[1], "resolved": convergence_.resolved,
        "sizes": [{"value": size.d, "runs": size.runs, "mean": size.mean, "scatter": size.scatter,
                   "balls_thick": size.balls} for size in convergence_.sizes],
        "halvings": [{"from": one.coarse.d, "to": one.fine.d, "difference": one.difference, "chance": one.chance}
                     for one in convergence_.halvings],
        "words": sentences}


def tabulate_sizes(convergences, variable):
    """The CSV: a row per quantity and size, with the difference from the size that was halved."""
    rows = []
    for name, one in convergences.items():
        halved = {each.fine.d: each for each in one.halvings}
        for size in one.sizes:
            each = halved.get(size.d)
            rows.append([name, size.d, size.balls, size.runs, size.mean, size.scatter, each and each.coarse.d,
                         each and each.difference, each and each.chance])
    return disk.csv_text(["quantity", variable, "balls_thick", "runs", "mean", "scatter", "halved_from", "difference",
                          "chance"], rows)


def shown_of(convergences, variable, names, deck) -> Table:
    shown = Table(title=f"{deck}: means at several values of {variable}; s: standard deviation of a run")
    for head in (variable, "balls thick", "runs", *(" ".join(names[name]) for name in convergences)):
        shown.add_column(head, justify="right")
    for k, size in enumerate(next(iter(convergences.values())).sizes):
        cells = [f"{size.d:g}", "-" if size.balls is None else f"{size.balls:.1f}", str(size.runs)]
        for one in convergences.values():
            mine, write = one.sizes[k], writer(one)
            cells.append(write(mine.mean) + (f" s {write(mine.scatter)}" if mine.scatter is not None else ""))
        shown.add_row(*cells)
    return shown


def draw_convergence(path, variable, panels, title):
    """The chart (PNG): every run and the means, over the thickness in balls; panels: list of (name, unit, Convergence,
    [(size, value of a run), ...])."""
    from matplotlib.ticker import StrMethodFormatter    # nothing else here needs it

    from ..drawing import pictures
    from ..drawing.figures import COLOURS, FULL, GRAY, STYLE
    with pictures.settings(STYLE):
        width = FULL if len(panels) > 1 else 0.6 * FULL
        figure, axes = pictures.subplots(1, len(panels), figsize=(width, 2.9), squeeze=False)
        for axis, (name, unit, fit, points) in zip(axes[0], panels):
            thick = {size.d: size.balls for size in fit.sizes if size.balls is not None}
            at = (lambda d: thick[d]) if thick else (lambda d: d)
            axis.plot([at(size) for size, _ in points], [value for _, value in points], "o", color=GRAY, ms=3,
                      mfc="none", mew=0.7, label="runs")
            axis.errorbar([at(size.d) for size in fit.sizes], [size.mean for size in fit.sizes],
                          [size.scatter or 0.0 for size in fit.sizes], fmt="-D", color=COLOURS[1], ms=3.5, lw=0.9,
                          capsize=2.5, label="means, and the scatter of a run")
            axis.set_title(f"{name} ({unit})", loc="left")
            axis.set_xlabel("balls over the thickness of the body" if thick else variable)
            axis.set_xlim(left=0)
            axis.yaxis.set_major_formatter(StrMethodFormatter("{x:,.6g}"))
            axis.grid(color="#dddddd", lw=0.5)
            axis.set_axisbelow(True)
            axis.spines[["top", "right"]].set_visible(False)
            axis.legend(loc="best")
        figure.suptitle(title, fontsize=7.5, x=0.01, ha="left")
        pictures.save(figure, path)
