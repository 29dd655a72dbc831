"""The tables over all runs of a study, and over its combinations: as a CSV and on the screen."""
from typing import Dict, List, Optional, Sequence

from rich.table import Table

from .. import disk
from ..mobility.run_length import STRAIGHT
from ..statistics import rounding
from . import combinations, quantities
from .quantities import KNOWN, OF_ROAD, OF_RUN, On, shown_on, written
from .rows import Failed, Finished, Row, finished_of, encode_row

COLUMNS, ROAD_COLUMNS, IF_KNOWN = ([one.key for one in several if On.HIDDEN not in one.on]
                                   for several in (OF_RUN, OF_ROAD, quantities.IF_KNOWN))
ANSWER: Dict[Optional[bool], str] = {True: "yes", False: "no"}
# heads of the columns that a narrow screen lacks first; then it lacks the last ones
LESS = [one.on_screen for one in sorted(shown_on("screen"), key=lambda quantity: quantity.keeps)]


def list_study_columns(finished: Sequence[Finished]) -> List[str]:
    """Those of every run, and with a road of that."""
    return [*COLUMNS, *(ROAD_COLUMNS if any(row.road for row in finished) else ())]


def tabulate_study(settings, repeated, rows: Sequence[Row], defaults):
    """The CSV over all runs."""
    finished = finished_of(rows)
    columns = [*list_study_columns(finished), *(key for key in IF_KNOWN
                                                if any(row.value(key) is not None for row in finished)),
               "status", "error"]
    if any(row.length_is == STRAIGHT for row in finished):
        columns.insert(columns.index("length_deg") + 1, "length_is")
    more = [name for name in repeated if name not in settings]

    def line(row: Row):
        cells = encode_row(row)
        cells.update({name: ANSWER.get(cells.get(name)) for name in ("moving", "at_rest")})
        own = row.variables if isinstance(row, Finished) else {}
        chosen = {**defaults, **own, **row.set, **row.repeat}
        return [row.run, *(chosen[name] for name in (*settings, *more)), *(cells.get(key) for key in columns)]

    return disk.csv_text(["run", *settings, *more, *columns], map(line, rows))


def round_volume(value, scatter):
    """A volume rounded to what is known: by its scatter, else to three digits; if repeats agree, to whole m3."""
    if scatter is not None and scatter.deviation > 0:
        return rounding.format_rounded(value, rounding.choose_rounding(scatter.deviation))
    place = rounding.place_of_digits(value, "m3")
    return rounding.format_rounded(value, min(1.0, place) if scatter else place)


def varied(settings):
    """Names of several values, and a caption that tells the others."""
    same = {name: several[0] for name, several in settings.items() if len(several) == 1}
    caption = "in all runs " + ", ".join(f"{name} {value}" for name, value in same.items()) if same else None
    return [name for name in settings if name not in same], caption


def width_of(shown: Table) -> int:
    """Characters that a table needs so that no cell is cut; its heads may be broken between words."""
    return 1 + sum(3 + measure_least_width(column) for column in shown.columns)


def measure_least_width(column) -> int:
    return max(map(len, (*str(column.header).split(), *column.cells)), default=0)


def fit_width(shown: Table, width: int) -> List[str]:
    """Take columns out of a table until it fits a width; their heads."""
    left_out = []
    while width_of(shown) > width and len(shown.columns) > 1:
        heads = [str(column.header) for column in shown.columns]
        head = next((head for head in LESS if head in heads), heads[-1])
        del shown.columns[heads.index(head)]
        left_out.append(head)
    room = width - width_of(shown)
    for k, column in enumerate(shown.columns):
        more = min(max(room, 0), max(len(str(column.header)) - measure_least_width(column), 0))
        column.width, column._index, room = measure_least_width(column) + more, k, room - more
    return left_out


def runs_shown(settings, rows: Sequence[Row], scatters, title) -> Table:
    """A line for each run."""
    names, caption = varied(settings)
    shown = Table(title=title, caption=caption)
    finished = finished_of(rows)
    columns = [one for one in shown_on("screen") if any(row.value(one.key) is not None for row in finished)]
    repeated = any(row.repeat for row in rows)
    for head in (*names, *(["repeat"] * repeated)):
        shown.add_column(head, justify="right", no_wrap=True)
    for column in columns:
        shown.add_column(column.on_screen, justify="right")
    for row in rows:
        cells = [row.set[name] for name in names] + [combinations.key_of(row.repeat)] * repeated
        if isinstance(row, Failed):
            cells += ["failed"]
        else:
            cells += ["-" if row.value(one.key) is None else round_volume(row.value(one.key), scatters.get(one.key))
                      if one.screen == KNOWN else written(one.screen, row.value(one.key)) for one in columns]
        shown.add_row(*cells)
    return shown


def combinations_shown(settings, groups, scatters) -> Table:
    """Mean and scatter of each combination, rounded to what is known of one run."""
    names, _ = varied(settings)
    shown = Table(title="mean and scatter (standard deviation of a run) of the repeats; below: over all combinations")
    for head in (*names, "runs", *(quantities.ALL[key].on_screen for key in scatters)):
        shown.add_column(head, justify="right")

    def cell(value, deviation, scatter):
        text = round_volume(value, scatter)
        return text if deviation is None else f"{text} s {round_volume(deviation, scatter)}"

    for group in groups:
        several = {key: group.of(key) for key in scatters}
        shown.add_row(*(group.set[name] for name in names), str(len(group.rows)),
                      *(cell(one.mean, one.scatter, scatters[key]) for key, one in several.items()))
    shown.add_section()
    shown.add_row(*[""] * len(names), "all",
                  *(f"s {round_volume(one.deviation, one)}" if one else "" for one in scatters.values()))
    return shown
