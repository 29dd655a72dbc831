"""What a report shows of an ensemble that is weighted by known events: share that is reached, numbers, curve, maps."""
from typing import Any, Dict, List, Mapping, Optional

from ..ensembles import known_events
from ..findings import texts
from ..mobility.results import percent
from ..plots import ensemble_charts
from ..tables import quantities
from .ensemble_part import Ensemble, band, indices_text, read_curve


class KnownEvents:
    """Of a data.Data whose ensemble was made with --known; numbers writes and keeps them, picture the template's."""

    def __init__(self, data, numbers, picture):
        self.data, self.numbers, self.picture = data, numbers, picture
        whole = data.study["ensemble"]
        self.about: Mapping[str, Any] = whole["known_events"]
        self.of, self.confidence = whole["of"], whole["confidence"]
        self.entry = (self.about.get("quantities") or {}).get(self.of)

    def content(self) -> Dict[str, Any]:
        """What the template takes."""
        lines = [f"{text[0].upper()}{text[1:]}." for text in texts(self.about["doubts"])]
        if self.about["reached"] is None:
            return {"lines": lines, "answer": None, "curve": None, "rows": [], "variables": [], "maps": []}
        text = known_events.summary(self.about)
        return {"lines": [f"{text[0].upper()}{text[1:]}.", *lines], "answer": self.answer(), "curve": self.curve(),
                "rows": self.rows(), "variables": self.variables(), "maps": self.maps()}

    def number(self, what: str, unit: str, value: Optional[float]) -> str:
        return "unknown" if value is None else self.numbers(f"known events: {what}", unit, value)

    def answer(self):
        """For the card on top, instead of that of the runs as their distributions have them."""
        if not self.entry:
            return None
        what, unit = self.entry["name"], self.entry["unit"]
        parts = []
        for one in self.entry["quantiles"]:
            share = f"{100 * one['share']:g} % of known events stay within"
            bounds = [None if one[side] is None else self.number(f"{share}, {side}", unit, one[side])
                      for side in ("low", "high")]
            note = band(bounds, unit, self.confidence)
            parts.append({"number": self.number(share, unit, one["value"]), "what": share, "note": note,
                          "unit": "" if one["value"] is None else unit})
        shown = next((part for part, one in zip(parts, self.entry["quantiles"]) if one["share"] == 0.9), parts[-1])
        return {"title": f"{what[0].upper()}{what[1:]}: 90 % of known events stay within", "number": shown["number"],
                "unit": shown["unit"], "parts": parts, "band": shown["note"],
                "note": f"The runs reach {percent(self.about['reached'])} of the known events of this volume and "
                        f"height, and weighted by them say as much as {self.about['effective']:.0f} runs."}

    def curve(self):
        """The weighted hazard curve."""
        points = read_curve(self.data.folder / known_events.HAZARD, self.of) if self.entry else None
        if points is None or not self.entry:
            return None
        named = [ensemble_charts.Quantile(*(one[key] for key in ("share", "value", "low", "high")))
                 for one in self.entry["quantiles"] if one["value"] is not None]
        title = f"Hazard curve by known events: {self.entry['name']}"
        uri = ensemble_charts.hazard_curve(points[0], points[1], points[2], points[3], named,
                                           f"{self.entry['name']} ({self.entry['unit']})", title, "known events")
        return self.picture(uri, title, "The weighted hazard curve: share of known events in which the quantity is "
                            f"larger, with its {100 * self.confidence:g} % bounds. What the runs do not reach is not "
                            "shared out: known events beyond the longest run exceed every value.")

    def rows(self) -> List[Dict[str, Any]]:
        """Quantiles of all quantities."""
        return [{"what": entry["name"], "unit": entry["unit"],
                 "cells": ["?" if one["value"] is None else quantities.number(one["value"])
                           for one in entry["quantiles"]]} for entry in self.about["quantities"].values()]

    def variables(self) -> List[Dict[str, Any]]:
        """Which parameters the weighted runs have, and how the quantity that counts depends on them."""
        found = []
        indices = (self.about.get("influence") or {}).get(self.of, {}).get("variables", {})    # none in older files
        for name, entry in self.about["variables"].items():
            rank, one = entry["rank"].get(self.of), indices.get(name)
            found.append({"name": name, "cells": [str(value) for value in entry["quantiles"]],
                          "rank": "-" if rank is None else f"{rank:+.2f}",
                          "indices": indices_text(one) if one and one["total"] is not None else "-"})
        return found

    def maps(self):
        """(entry, values) of the maps on the page."""
        shown = ((entry, self.data.read_map(entry["file"])) for entry in self.about["maps"] if Ensemble.shown(entry))
        return [(entry, values) for entry, values in shown if (values > 0).any()]
