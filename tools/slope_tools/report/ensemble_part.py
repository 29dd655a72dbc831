"""What a report shows of an ensemble, by its distributions and as known events weigh it: curves, tables, maps."""
import csv
from pathlib import Path
from typing import Any, Callable, List, Optional, Sequence

import numpy as np

from ..digits import percent
from ..drawing import figures, palettes
from ..ensembles import ensemble, known_events
from ..errors import SlopeError
from ..findings import texts
from ..heads import is_number
from ..plots import ensemble_charts, figure_maps
from ..statistics import entries
from ..tables import ensemble_types, quantities, study_types, usable
from .charts import AXIS
from .data import Data
from .numbers import CardPart, MainCard, Numbers
from .sections import Cell, Figures, Picture, Section, Table, Text

MOST_SCATTER = 4        # variables with a chart of the runs against them
ODDS = [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0]
IN_GAP = "In a gap: no run ends where these known events do."
EVENTS = "known events"
SHARES = ("50 %", "90 %", "95 %", "99 %")


def ensemble_card(data: Data, numbers: Numbers) -> Optional[MainCard]:
    """For the top of the appendix: of the known events where these weigh the runs, else of the runs; None of others."""
    about = data.study.ensemble if data.study else None
    if not about:
        return None
    mine = Ensemble(data, numbers, about).answer()
    known = KnownEvents(data, numbers, about).answer() if about.known_events else None
    return known if known and not (mine and mine.withheld) else mine


def sections(data: Data, numbers: Numbers, maps) -> List[Section]:
    """Of an ensemble; maps: a maps_part.Maps."""
    about = data.study.ensemble if data.study else None
    if not about:
        return []
    known = [KnownEvents(data, numbers, about).section(maps)] if about.known_events else []
    return [*known, Ensemble(data, numbers, about).section(maps)]


class Ensemble:
    """Of a data.Data whose study is an ensemble, about; numbers writes and keeps them."""

    def __init__(self, data: Data, numbers: Numbers, ensemble_: ensemble_types.Ensemble):
        self.data, self.numbers, self.about = data, numbers, ensemble_
        self.of = self.about.of
        self.entry = self.about.quantities.get(self.of) if self.of else None

    def answer(self) -> Optional[MainCard]:
        """For the card on top: the quantiles of the quantity that counts."""
        entry = self.entry
        if not entry:
            return None
        if self.about.withheld:
            return MainCard(usable.UNUSABLE.capitalize(), None, entry.unit, withheld=self.about.withheld,
                            note=self.design())
        return card(entry, "the runs", self.about.confidence, self.number, self.design())

    def number(self, what, unit, value):
        return self.numbers(f"{self.entry.name if self.entry else ''}: {what}", unit, value)

    def design(self):
        design = self.about.design
        distributions = "; ".join(f"{name} {text}" for name, text in design.variables.items())
        if design.kind == ensemble_types.CALIBRATED:
            return (f"An ensemble of {design.points} sets of values that a calibration found equally good, within "
                    f"{distributions}.")
        return (f"An ensemble of {design.points} points ({design.kind}, seed {design.seed}), "
                f"{self.about.finished} runs: {distributions}. It is only as good as these distributions.")

    def section(self, maps) -> Section:
        return Section("ensemble", "How likely, and what matters", [
            Figures([self.curve()], "two-thirds"), Figures(self.indices(), "columns"), self.table(),
            Figures(self.scatter(), "columns"), Figures(draw_ensemble_maps(self.data, self.about.maps, maps),
                                                        "columns")])

    # --- charts ---

    def curve(self):
        """The hazard curve, from hazard.csv."""
        if not self.entry or not self.of:
            return None
        return hazard_curve(
            self.data.folder / ensemble.HAZARD, self.of, self.entry, f"Hazard curve: {self.entry.name}", "the runs",
            f"The hazard curve: share of the {self.about.finished} runs of the design in which the quantity is larger, "
            f"with its {100 * self.about.confidence:g} % bounds; dots: what 50, 90, 95 and 99 % of them stay within.")

    def indices(self) -> List[Picture]:
        """A chart for each quantity whose emulator says something, the one that counts first, three at most."""
        pictures: List[Picture] = []
        for name, entry in self.about.influence.items():
            variables = entry.variables
            if len(pictures) == 3 or any(one.total is None for one in variables.values()):
                continue
            what = self.about.quantities[name].name
            bars = [ensemble_charts.Bar(key, one.first or 0.0, one.first_error or 0.0, one.total or 0.0,
                                        one.total_error or 0.0) for key, one in variables.items()]
            title = f"What matters: {what}"
            pictures.append(Picture(ensemble_charts.influence(bars, title), title,
                                    f"Sobol indices for {what}, with the error of the total ones; {entry.text}."))
        return pictures

    def scatter(self):
        """The quantity that counts against each variable, those first on which it depends most."""
        if not self.entry or not self.of:
            return []
        variables = self.about.influence[self.of].variables
        names = sorted(variables, key=lambda name: -abs(variables[name].total or variables[name].rank))
        pictures = []
        for name in names[:MOST_SCATTER]:
            rows = self.data.finished
            if not all(is_number(row.set[name]) for row in rows):
                continue
            what = self.entry.name
            title = f"{what[0].upper()}{what[1:]} against {name}"
            uri = ensemble_charts.against([float(row.set[name]) for row in rows], [row.value(self.of) for row in rows],
                                          AXIS.get(name, name), f"{what} ({self.entry.unit})", title)
            pictures.append(Picture(uri, title, f"{title}: a dot for each run; rank correlation "
                                                f"{variables[name].rank:+.2f}."))
        return pictures

    def table(self):
        """Of the quantities: quantiles, and the variables' indices."""
        names, rows = list(self.about.design.variables), []
        for name, entry in self.about.quantities.items():
            influence = self.about.influence.get(name)
            cells = [quantities.format_quantity(one.value) for one in entry.quantiles]
            of_variables = []
            for key in names:
                one = influence and influence.variables[key]
                of_variables.append("" if not one else f"rank {one.rank:+.2f}" if one.total is None else
                                    indices_text(one))
            check = influence and influence.emulator
            explains = Cell(f"{100 * max(0, check.explained):.0f} %",
                            style="" if check.verdict == "good" else "doubt") if check else ""
            rows.append([Cell(entry.name, entry.unit), *cells, *of_variables, explains])
        return Table("The values that the given share of the runs stay within; for each variable its Sobol indices, "
                     "first order / total \N{PLUS-MINUS SIGN} the error of the total one, or its rank correlation "
                     "where the emulator is bad. Explained: the share of the variance of left-out runs that the "
                     "emulator predicts.",
                     ["quantity", *SHARES, *names, "explained"], rows)


class KnownEvents:
    """Of a data.Data whose ensemble was made with --known; numbers writes and keeps them."""

    def __init__(self, data: Data, numbers: Numbers, whole: ensemble_types.Ensemble):
        self.data, self.numbers = data, numbers
        self.known, self.about = whole.known_events, ensemble_types.weighted(whole)
        self.of, self.confidence = whole.of, whole.confidence
        self.entry = self.about.quantities.get(self.of) if self.about and self.of else None

    def section(self, maps) -> Section:
        weighted = self.about
        lines = [*([known_events.summarise_weights(weighted)] if weighted else []),
                 *texts(self.known.doubts if self.known else ())]
        blocks: List[Any] = [Text(f"{text[0].upper()}{text[1:]}.") for text in lines]
        if weighted:
            curve = self.curve()
            blocks += [*([Figures([curve], "two-thirds")] if curve else []), *self.tables()]
        return Section("known-events", "Weighted by known events", [
            *blocks, Figures(draw_ensemble_maps(self.data, weighted.maps, maps) if weighted else [], "columns")])

    def number(self, what: str, unit: str, value: Optional[float]) -> str:
        return "unknown" if value is None else self.numbers(f"known events: {what}", unit, value)

    def answer(self) -> Optional[MainCard]:
        """For the card on top, instead of that of the runs as their distributions have them."""
        if not self.entry or not self.about:
            return None
        return card(self.entry, EVENTS, self.confidence, self.number,
                    f"The runs reach {percent(self.about.reached or 0.0)} of the known events of this volume and "
                    f"height, and weighted by them say as much as {self.about.effective:.0f} runs.")

    def curve(self):
        """The weighted hazard curve."""
        if not self.entry or not self.of:
            return None
        return hazard_curve(
            self.data.folder / known_events.HAZARD, self.of, self.entry,
            f"Hazard curve by known events: {self.entry.name}", EVENTS, "The weighted hazard curve: share of known "
            f"events in which the quantity is larger, with its {100 * self.confidence:g} % bounds. What the runs do "
            "not reach is not shared out: known events beyond the longest run exceed every value. A line: no run ends "
            "where these known events do.")

    def tables(self) -> List[Table]:
        """Quantiles of all quantities; which parameters the weighted runs have, and how the first depends on them."""
        if not self.about:
            return []
        quantiles: List[Any] = [[Cell(entry.name, entry.unit), *map(cell_of, entry.quantiles)]
                                for entry in self.about.quantities.values()]
        analysis = self.about.influence.get(self.of) if self.of else None
        indices = analysis.variables if analysis else {}
        rows: List[Any] = []
        for name, entry in self.about.variables.items():
            rank, one = entry.rank.get(self.of) if self.of else None, indices.get(name)
            rows.append([name, *map(str, entry.quantiles), "-" if rank is None else f"{rank:+.2f}",
                         indices_text(one) if one and one.total is not None else "-"])
        return [] if not quantiles else [
            Table("The values that the given share of known events stay within. \"?\": they go beyond the runs; two "
                  f"values: {IN_GAP[0].lower()}{IN_GAP[1:-1]}.",
                  ["quantity", *SHARES], quantiles),
            Table("The parameters of the weighted runs: the values that 5, 50 and 95 % of the weight stay within; the "
                  "weighted rank correlation of the quantity on top, and its Sobol indices, first order / total "
                  "\N{PLUS-MINUS SIGN} the error of the total one. Weighted, the parameters depend on each other: what "
                  "two of them share is in the first index of both and in the total one of neither.",
                  ["parameter", "5 %", "50 %", "95 %", "rank", "indices"], rows)]


def cell_of(quantile: entries.KnownQuantile) -> str:
    """A quantile in a table."""
    if quantile.value is None:
        return "?"
    return " to ".join(map(quantities.format_quantity, quantile.gap or [quantile.value]))


# --- of both ---

def card(entry: Any, whose: str, confidence: float, number: Callable[[str, str, Any], str], note: str) -> MainCard:
    """The card of the quantiles of a quantity; whose share stays within; number: writes and keeps one."""
    parts, unit = [], entry.unit
    for quantile in entry.quantiles:
        share = quantities.share_within(f"{100 * quantile.share:g} % of {whose}", unit)
        bounds = [None if side is None else number(f"{share}, {name}", unit, side)
                  for name, side in (("low", quantile.low), ("high", quantile.high))]
        gap = getattr(quantile, "gap", None)
        value = number(share, unit, quantile.value) if not gap else " to ".join(number(
            f"{share}, {end} of the gap where no run ends", unit, side) for end, side in zip(("start", "end"), gap))
        parts.append(CardPart(value, share, f"{IN_GAP} " * bool(gap) + band(bounds, unit, confidence),
                              unit="" if quantile.value is None else unit))
    shown = next((part for part, one in zip(parts, entry.quantiles) if one.share == 0.9), parts[-1])
    most = quantities.share_within(f"90 % of {whose}", unit)
    return MainCard(f"{entry.name[0].upper()}{entry.name[1:]}: {most}", shown.number, shown.unit or "", parts,
                    band=shown.note, note=note)


def hazard_curve(path: Path, of: str, entry: Any, title: str, whose: str, text: str) -> Optional[Picture]:
    """The curve of a quantity in a file of hazard.tabulate_hazard(); None where it has none."""
    points = read_curve(path, of)
    named = [entries.KnownQuantile(*one) for one in entry.quantiles if one.value is not None]
    return None if points is None else Picture(
        ensemble_charts.hazard_curve(points, named, f"{entry.name} ({entry.unit})", title, whose), title, text)


def band(bounds: Sequence[Optional[str]], unit: str, confidence: float) -> str:
    """The lower and the upper bound (None: unknown), each with its unit."""
    low, high = bounds
    sure = f"with {100 * confidence:g} % confidence."
    if low is None and high is None:
        return "No bounds: the runs are too few for them."
    if high is None:
        return f"At least {low} {unit} {sure}"
    return f"Between {low} {unit} and {high} {unit} {sure}" if low is not None else f"At most {high} {unit} {sure}"


def share_of(what: str) -> str:
    """The label of a map of shares: of runs, or of known events."""
    return "share of known events" if "known events" in what else "share of the runs"


def read_curve(path, quantity: str):
    """Value, share, low and high (rows) of a quantity, of a file of curves; None where the curve is one point."""
    try:
        with open(path, newline="", encoding="ascii") as lines:
            points = np.array([[float(row[key]) for key in ("value", "exceeded", "low", "high")]
                               for row in csv.DictReader(lines) if row["quantity"] == quantity]).T
        return points if points.shape[1] >= 2 else None
    except (OSError, ValueError, KeyError, TypeError, IndexError) as error:
        raise SlopeError(path, f"must be what `slope study --sample` wrote ({error!r})") from error


def is_map_on_page(entry) -> bool:
    """Which of the maps are on the page; the others are files."""
    if "threshold" in entry:
        return entry["raster"] in ("thickness", "max_speed", "arrival") and (
            entry["threshold"] > 0 or entry["raster"] == "arrival")
    return entry["quantile"] == 0.9 and entry["raster"] != "thickness"


def exceeded(data: Data) -> Optional[figure_maps.Exceeded]:
    """In which share of an ensemble the deposit is thicker than its least threshold; of known events, where these weigh
    it. None of other studies, and of runs too few for the smallest share."""
    about = data.study.ensemble if data.study else None
    known = ensemble_types.weighted(about)
    maps = known.maps if known else about.maps if about else []
    shown_maps = [one for one in maps if one["raster"] == "thickness" and one.get("threshold")]
    if not shown_maps or len(data.finished) < 1 / min(figure_maps.OUTLINES):
        return None
    least = min(shown_maps, key=lambda entry: entry["threshold"])
    whom = "known events" if known else "runs"
    return figure_maps.Exceeded(data.read_map(least["file"]), whom, least["threshold"],
                                *((known.far, known.short) if known else ()))


def draw_ensemble_maps(data: Data, several: Sequence[study_types.MapEntry], maps) -> List[Picture]:
    """How likely the mass is there, and what 90 % of the runs stay within, where that is anything."""
    pictures = []
    layers = maps.layers._replace(section=None)
    for entry in filter(is_map_on_page, several):
        values = data.read_map(entry["file"])
        if not (values > 0).any():
            continue
        what = entry["what"]
        title = f"{what[0].upper()}{what[1:]}"
        if "threshold" in entry:
            uri = figure_maps.value_map(layers, values, title, share_of(what), ODDS, palettes.SHARE, mask=values > 0)
        else:
            bounds = figures.even_to_most(values[values > 0])
            colours = palettes.BY_RASTER[entry["raster"]]
            uri = figure_maps.value_map(layers, values, title, f"({entry['unit']})", bounds, colours, mask=values > 0)
        bands = f" Its bounds are bands of {entry['bounds']}." if entry["bounds"] else ""
        pictures.append(Picture(uri, title, f"{title}.{bands}"))
    return pictures


def indices_text(influence: entries.Influence) -> str:
    """First and total Sobol index of a variable that has them, with the error of the latter."""
    return f"{influence.first:.2f} / {influence.total:.2f} \N{PLUS-MINUS SIGN} {influence.total_error:.2f}"
