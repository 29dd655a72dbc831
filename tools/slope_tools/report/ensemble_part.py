"""What a report shows of an ensemble: how likely the volume is exceeded, which variables matter, maps over all runs."""
import csv
from typing import Any, Dict, List, Mapping, Optional, Sequence

import numpy as np

from ..drawing import figures, palettes
from ..ensembles import ensemble
from ..errors import SlopeError
from ..plots import ensemble_charts, figure_maps
from ..statistics import emulator
from ..tables import quantities, withheld_words
from .charts import AXIS
from .data import is_number

MOST_SCATTER = 4        # variables with a chart of the runs against them
ODDS = [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0]


class Ensemble:
    """Of a data.Data whose study is an ensemble; numbers writes and keeps them, picture makes the template's."""

    def __init__(self, data, numbers, picture):
        self.data, self.numbers, self.picture = data, numbers, picture
        self.about: Mapping[str, Any] = data.study["ensemble"]
        self.of = self.about["of"]
        self.entry = self.about["quantities"].get(self.of) if self.of else None

    def answer(self):
        """For the card on top: the quantiles of the quantity that counts."""
        if not self.entry:
            return None
        what, unit = self.entry["name"], self.entry["unit"]
        if self.about.get("withheld"):
            return {"title": withheld_words.UNUSABLE.capitalize(), "withheld": self.about["withheld"], "number": None,
                    "unit": unit, "parts": [], "note": self.design()}
        parts = []
        for one in self.entry["quantiles"]:
            bounds = [None if one[side] is None else self.number(f"{100 * one['share']:g} % {side}", unit, one[side])
                      for side in ("low", "high")]
            note = band(bounds, unit, self.about["confidence"])
            share = f"{100 * one['share']:g} % of the runs stay within"
            parts.append({"number": self.number(share, unit, one["value"]), "what": share,
                          "note": note})
        shown = next((part for part, one in zip(parts, self.entry["quantiles"]) if one["share"] == 0.9), parts[-1])
        return {"title": f"{what[0].upper()}{what[1:]}: 90 % of the runs stay within", "number": shown["number"],
                "unit": unit, "parts": parts, "note": self.design(), "withheld": [], "band": shown["note"]}

    def number(self, what, unit, value):
        return self.numbers(f"{self.entry['name']}: {what}", unit, value)

    def design(self):
        design = self.about["design"]
        distributions = "; ".join(f"{name} {text}" for name, text in design["variables"].items())
        if design["kind"] == "calibrated":
            return (f"An ensemble of {design['points']} sets of values that a calibration found equally good, within "
                    f"{distributions}.")
        return (f"An ensemble of {design['points']} points ({design['kind']}, seed {design['seed']}), "
                f"{self.about['finished']} runs: {distributions}. It is only as good as these distributions.")

    def content(self):
        """What the template takes."""
        return {"answer": self.answer(), "curve": self.curve(), "indices": self.indices(), "scatter": self.scatter(),
                "table": self.table(), "names": list(self.about["design"]["variables"]), "maps": self.maps()}

    # --- charts ---

    def curve(self):
        """The hazard curve, from hazard.csv."""
        if not self.entry:
            return None
        points = read_curve(self.data.folder / ensemble.HAZARD, self.of)
        if points is None:
            return None
        quantiles = [ensemble_charts.Quantile(*(one[key] for key in ("share", "value", "low", "high")))
                     for one in self.entry["quantiles"]]
        title = f"Hazard curve: {self.entry['name']}"
        return self.picture(
            ensemble_charts.hazard_curve(points[0], points[1], points[2], points[3], quantiles,
                                         f"{self.entry['name']} ({self.entry['unit']})", title),
            title, f"The hazard curve: share of the runs in which the quantity is larger, with its "
            f"{100 * self.about['confidence']:g} % bounds; dots: what 50, 90, 95 and 99 % of the runs stay within.")

    def indices(self) -> List[Dict[str, str]]:
        """A chart for each quantity whose emulator says something, the one that counts first, three at most."""
        found: List[Dict[str, str]] = []
        for name, entry in self.about["influence"].items():
            variables = entry["variables"]
            if len(found) == 3 or any(one["total"] is None for one in variables.values()):
                continue
            what = self.about["quantities"][name]["name"]
            bars = [ensemble_charts.Bar(key, *(one[part] for part in emulator.SIGN)) for key, one in variables.items()]
            text = entry["text"] if "text" in entry else entry["told"]      # the latter in older files
            title = f"What matters: {what}"
            found.append(self.picture(ensemble_charts.influence(bars, title), title,
                                      f"Sobol indices for {what}, with the error of the total ones; {text}."))
        return found

    def scatter(self):
        """The quantity that counts against each variable, those first on which it depends most."""
        if not self.entry:
            return []
        variables = self.about["influence"][self.of]["variables"]
        names = sorted(variables, key=lambda name: -abs(variables[name]["total"] or variables[name]["rank"]))
        found = []
        for name in names[:MOST_SCATTER]:
            rows = self.data.finished
            if not all(is_number(row["set"][name]) for row in rows):
                continue
            what = self.entry["name"]
            title = f"{what[0].upper()}{what[1:]} against {name}"
            uri = ensemble_charts.against([float(row["set"][name]) for row in rows], [row[self.of] for row in rows],
                                          AXIS.get(name, name), f"{what} ({self.entry['unit']})", title)
            found.append(self.picture(uri, title, f"{title}: a dot for each run; rank correlation "
                                                  f"{variables[name]['rank']:+.2f}."))
        return found

    def table(self):
        """Rows of quantities: quantiles, and the variables' indices."""
        rows = []
        for name, entry in self.about["quantities"].items():
            found = self.about["influence"].get(name)
            cells = [quantities.number(one["value"]) for one in entry["quantiles"]]
            of_variables = []
            for key in self.about["design"]["variables"]:
                one = found and found["variables"][key]
                of_variables.append("" if not one else f"rank {one['rank']:+.2f}" if one["total"] is None else
                                    indices_text(one))
            check = found and found["emulator"]
            rows.append({"what": entry["name"], "unit": entry["unit"], "cells": cells, "variables": of_variables,
                         "explains": "" if not check else f"{100 * max(0, check['explained']):.0f} %",
                         "doubt": bool(check) and check["verdict"] != "good"})
        return rows

    # --- maps ---

    def maps(self):
        """How likely the mass is there, and what 90 % of the runs stay within."""
        found = []
        for entry in self.about["maps"]:
            if self.shown(entry):
                values = self.data.read_map(entry["file"])
                if (values > 0).any():
                    found.append((entry, values))
        return found

    @staticmethod
    def shown(entry):
        """Which of the maps are on the page; the others are files."""
        if "threshold" in entry:
            return entry["raster"] in ("thickness", "max_speed", "arrival") and (
                entry["threshold"] > 0 or entry["raster"] == "arrival")
        return entry["quantile"] == 0.9 and entry["raster"] != "thickness"


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


def draw(entries, maps):
    """The pictures of (entry, values), by a maps_part.Maps."""
    pictures = []
    layers = maps.layers._replace(section=None)
    for entry, values in entries:
        what = entry["what"]
        title = f"{what[0].upper()}{what[1:]}"
        if "threshold" in entry:
            uri = figure_maps.value_map(layers, values, title, share_of(what), ODDS, palettes.SHARE, mask=values > 0)
        else:
            bounds = figures.even_to_most(values[values > 0])
            colours = palettes.BY_RASTER[entry["raster"]]
            uri = figure_maps.value_map(layers, values, title, f"({entry['unit']})", bounds, colours, mask=values > 0)
        bands = f" Its bounds are bands of {entry['bounds']}." if entry["bounds"] else ""
        pictures.append(maps.picture(uri, title, f"{title}.{bands}"))
    return pictures


def indices_text(one: Mapping[str, Any]) -> str:
    """First and total Sobol index of a variable that has them, with the error of the latter."""
    return f"{one['first']:.2f} / {one['total']:.2f} \N{PLUS-MINUS SIGN} {one['total_error']:.2f}"
