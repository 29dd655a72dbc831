"""What a report shows of a study: the table of its runs, means, differences, charts, and the maps over all runs."""
from ..tables import elastic, quantities
from ..tables.quantities import LENGTH, REMOVE, On
from ..tables.rows import Failed, Finished
from .charts import TERMS, Charts, differences
from .data import Data
from .numbers import Numbers
from .sections import Cell, Figures, Listing, Section, Table, Text

MOST_ROWS, ENDS = 40, 12    # of the study's table, and of each end of a longer one
VOLUMES = "; volumes in m3 of ground; distances in plan from the highest released ball."


def make_study_section(data: Data, numbers: Numbers, reference, maps):
    """Of a data.Data; None of a run alone."""
    if not data.study:
        return None
    study, charts, run = Runs(data, numbers), Charts(data, reference), data.result
    table, means, different = study.table(), study.means(), differences(data, numbers)
    drawn, over_all, first = charts.all(), maps.over_all(), int(charts.has_removal())
    return Section("study", "Study", [
        table,
        Text(f"The same in all runs: {same}.", "soft") if (same := study.same()) else None,
        Text(f"Variables: {terms}.", "soft") if (terms := study.terms()) else None,
        means,
        Listing(different) if different else None,
        study.most_elastic(),
        Figures(drawn[:first], "two-thirds") if first and drawn else None,
        Figures(drawn[first:], "columns"),
        Figures([maps.removal(numbers.quantity(REMOVE, run.row.value(REMOVE), data.label(run)) if run.row.road
                              else "")], "tall"),
        Figures([over_all["runs"]]), Figures([over_all["envelope"], *over_all["exceedance"]], "columns")])


class Runs:
    """The tables of the runs of a data.Data; numbers writes and keeps their numbers."""

    def __init__(self, data: Data, numbers: Numbers):
        self.data, self.numbers = data, numbers
        self.varied = [key for key, several in data.settings.items() if len(several) > 1]

    def table(self):
        """For each run its variables, its numbers or why it failed, and whether it is at rest."""
        data, best, columns = self.data, self.data.of_study.conservative, self.columns()
        names = self.varied or list(data.settings)
        rows, marks = [], []
        for row in self.in_table():
            cells = [data.number(row.run), *(row.set[key] for key in names)]
            if data.repeats:
                cells.append(", ".join(f"{name} {value}" for name, value in row.repeat.items()) or "base")
            mark = ["bad"]
            if isinstance(row, Finished):
                name = data.label_of(row)
                cells += [self.numbers.quantity(one.key, row.value(one.key), name, "-") for one in columns]
                cells.append(Cell(row.end_short, style="" if row.at_rest else "doubt"))
                mark = ["bad"] * row.moving + ["best"] * (best is not None and row.set == best.set)
            else:
                cells.append(Cell(f"failed: {row.error}", style="left", span=len(columns) + 1))
            rows.append(cells)
            marks.append(" ".join(mark))
        heads = ["run", *names, *(["repeat"] if data.repeats else []), *map(self.head, columns), "end"]
        return Table(" ".join(filter(None, [self.which_rows() + VOLUMES, self.beyond()])), heads, rows, (), marks)

    def columns(self):
        """Quantities of the study's table, without those that have no value."""
        data = self.data
        same = len({round(row.released_m3, 3) for row in data.finished}) == 1
        return [one for one in quantities.shown_on("page")
                if any(row.value(one.key) is not None for row in data.finished)
                and not (same and one.key == "released_m3")]

    def head(self, quantity):
        """Head of a quantity in a table: name and unit."""
        return Cell(quantities.name_quantity(quantity.key, self.data.finished) if quantity.key == LENGTH
                    else quantity.heading, quantity.unit)

    def beyond(self):
        """The note on the volume beyond the road; "" without a road."""
        if self.data.road is None:
            return ""
        if any(row.value("beyond_road_m3") is not None for row in self.data.finished):
            return ("Beyond it: all of the mass on the far side of the road, whose ends are prolonged to the edge of "
                    "the terrain, and what left the terrain there. What is cut there is counted in \"to remove\" too: "
                    "the two overlap and cannot be added.")
        return "How much lies beyond the road is unknown: the runs are of an older version."

    def same(self):
        """The variables that all runs have the same value of, where others differ."""
        return ", ".join(f"{name} {values[0]}" for name, values in self.data.settings.items()
                         if name not in self.varied)

    def terms(self):
        """What the usual variables mean, of those that the study has."""
        named = [*self.data.settings, *self.data.repeats]
        return "; ".join(f"{name}: {TERMS[name]}" for name in dict.fromkeys(named) if name in TERMS)

    def in_table(self):
        """The runs of the table: of a long one those with the least and the most of what counts, and failed ones."""
        rows = self.data.rows
        if len(rows) <= MOST_ROWS:
            return rows
        key = self.counts().key
        known = sorted((row for row in self.data.finished if row.value(key) is not None),
                       key=lambda row: row.value(key))
        return [*known[:ENDS], *known[-ENDS:], *[row for row in rows if isinstance(row, Failed)][:ENDS]]

    def counts(self):
        """The column by which the runs of a long table are chosen."""
        columns = {one.key: one for one in self.columns()}
        return next(columns[key] for key in (REMOVE, quantities.DISTANCE, "front_m") if key in columns)

    def which_rows(self):
        """What the table says of its runs."""
        if len(self.data.rows) <= MOST_ROWS:
            return "All runs"
        return (f"Of {len(self.data.rows)} runs those with the least and the most in the column "
                f"\"{self.counts().heading}\", in its order; study.csv has all")

    def means(self):
        """The table over combinations; None without repeats."""
        study, best = self.data.of_study, self.data.of_study.conservative
        if not (self.data.repeats and study.combinations):
            return None
        averaged = [quantities.ALL[key] for key in quantities.keys(On.PAGE_MEAN)
                    if all(key in entry for entry in study.combinations)]
        rows = [[*(entry["set"][key] for key in self.varied), entry["repeats"],
                 *(self.numbers.mean(one.name, one.unit, entry[one.key]["mean"], entry[one.key]["scatter"],
                                     str(entry["combination"])) for one in averaged)]
                for entry in study.combinations]
        marks = ["best" if best and entry["combination"] == best.combination else ""
                 for entry in study.combinations]
        return Table("Means of the repeats \N{PLUS-MINUS SIGN} the standard deviation of a run.",
                     [*self.varied, "runs", *map(self.head, averaged)], rows, (), marks)

    def most_elastic(self):
        """The table of reach and area with the largest restitution; None without such runs."""
        elastic_ = self.data.of_study.largest_restitution
        if not elastic_ or not elastic_.quantities:
            return None
        rows = []
        for key, quantity in elastic_.quantities.items():
            name, unit = elastic.name_elastic_quantity(key, elastic_)
            usual, study = quantity.usual, quantity.study
            rows.append([Cell(name, unit), *(self.numbers(f"{end}: {name}, restitution {elastic_.restitution:g}", unit,
                                                          value)
                                             for end, value in (("mean", quantity.mean), ("low", quantity.low),
                                                                ("high", quantity.high))),
                         self.numbers(f"mean: {name}", unit, usual.mean if usual else None),
                         self.numbers(f"largest: {name}", unit, study.high if study else None)])
        return Table(f"Reach and area with the most elastic rock: soil, slip surface and ground with a restitution of "
                     f"{elastic_.restitution:g}, rolling resistance {elastic_.rolling}; {len(elastic_.runs)} runs, "
                     "which are none of those that the volume is of.",
                     ["", "mean", "least", "most", "mean of the same runs with the usual restitution",
                      "most of all other runs"], rows)
