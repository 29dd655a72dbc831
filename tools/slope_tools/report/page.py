"""All that a report shows, read, computed and drawn, as the template takes it."""
import datetime
import re
from typing import Any, Dict, List

from .. import provenance
from ..animation import film, frames, view
from ..case import decks
from ..plots.ground import Ground
from ..plots.section import Section
from ..survey.rasters import crs_name
from ..tables import quantities
from ..tables.quantities import LENGTH, REMOVE, On
from . import (body, chain_part, client_part, convergence_part, heading, intensity_part, limits_part, mobility_part,
               road_part)
from .charts import Charts, TERMS, differences
from .data import Data, find_deck
from .heading import Asked
from .maps_part import Maps
from .numbers import Numbers, answer, balance, cards, travel_rows
from .reference import read as read_reference
from .structures_part import Structures
from .warnings import findings, listed

# a variable of a deck and the comment on it, which has its unit
MEANING = re.compile(r"^\s*variable\s+(\w+)\s+index\s.*?#\s*(.*?)\s*$", re.MULTILINE)
MOST_ROWS, ENDS = 40, 12    # of the study's table, and of each end of a longer one


class Page:
    """A page: data, ground, section, findings, warnings (level, text), and the number of pictures."""

    def __init__(self, asked: Asked):
        self.data = Data(asked.folder, asked.shown)
        self.ground = Ground(self.data)
        self.section = Section(self.data, self.ground, asked.section, asked.local)
        self.reference = read_reference(asked.reference, quantities.known(On.ASKED, self.data.compared)) \
            if asked.reference else None
        path, missing = convergence_part.find(asked.converge, self.data)
        self.sizes = path and convergence_part.Sizes(path)
        self.findings = [*findings(self.data, self.ground), *([missing] if missing else [])]
        self.warnings = listed(self.findings, self.data.names())
        self.numbers = Numbers()
        self.heading = heading.heading(asked.folder, {name: getattr(asked, name) for name in heading.FIELDS})
        self.frames, self.no_frames = frames.read(self.data.result)
        self.film_file, self.film = asked.film, film.Film(None, "")
        self.pictures = 0

    def picture(self, uri, alt, caption):
        self.pictures += 1
        return {"uri": uri, "alt": alt, "caption": caption}

    def content(self):
        """What the template takes."""
        data, numbers = self.data, self.numbers
        one, study = data.result, data.study
        maps = Maps(data, self.ground, self.section, self.picture)
        charts = Charts(data, self.reference, self.picture)
        if self.film_file:
            self.film = film.film(data, self.ground, self.section, maps.layers, self.frames, self.film_file.name)
        removal = numbers.quantity(REMOVE, one.row[REMOVE], data.label(one)) if REMOVE in one.row else ""
        found = {
            "made": utc(provenance.now()), "study": study, "single": not study, "one": one, "summary": one.summary,
            "label": data.label(one), "settings": data.settings, "repeats": data.repeats,
            "varied": [key for key, several in data.settings.items() if len(several) > 1],
            "warnings": self.warnings, "answer": answer(data, numbers),
            "cards": cards(data, numbers), "travel": travel_rows(data, numbers),
            "balance": balance(data, numbers), "rows": self.rows(), "columns": list(map(self.head, self.columns())),
            "which_rows": self.which_rows(),
            "means": self.means(), "differences": differences(data, numbers),
            "maps": maps.of_run(), "section": self.picture(*self.section.picture()), "charts": charts.all(),
            "intensity": intensity_part.content(data, numbers, self.picture),
            "chain": chain_part.content(data, numbers, self.picture),
            "hit": Structures(data, numbers, self.picture, self.ground).content(),
            "road": road_part.content(data, numbers, maps), "mapped": mobility_part.mapped(data, numbers),
            "road_chart": charts.has_removal(), "removal": maps.removal(removal), "over_all": maps.over_all(),
            "beyond": self.beyond(),
            "reference": self.reference and self.reference_tables(),
            "sizes": self.sizes and {"charts": self.sizes.pictures(self.picture), "rows": self.sizes.rows(numbers),
                                     "variable": self.sizes.variable, "deck": self.sizes.deck},
            "mass_error": (one.deposit.volume - one.summary["volume"]["released"] + one.summary["volume"]["off_grid"]
                           + one.summary["volume"]["lost"]) / one.summary["volume"]["released"],
            "view": view.content(data, self.ground, self.section, self.frames, self.no_frames, self.film.text),
            "heading": self.heading, "terms": self.terms(),
            "limits": [*mobility_part.content(data, self.ground, numbers),
                       *limits_part.content(data, self.ground, numbers)],
            "place": self.place(), "ensemble": None, "known": None, "body": body.of_data(data, self.ground)}
        if study and study.get("ensemble"):
            from . import ensemble_part
            mine = found["ensemble"] = ensemble_part.Ensemble(data, numbers, self.picture).content()
            mine["maps"] = ensemble_part.draw(mine["maps"], maps)
            if study["ensemble"].get("known_events"):
                from . import known_part
                known = found["known"] = known_part.KnownEvents(data, numbers, self.picture).content()
                known["maps"] = ensemble_part.draw(known["maps"], maps)
                if known["answer"] and not (mine["answer"] or {}).get("withheld"):
                    mine["answer"] = {**known["answer"], "withheld": []}
        answers = found["answer"], found["ensemble"] and found["ensemble"]["answer"]
        found["client"] = client_part.content(data, self.ground, numbers, answers, self.findings,
                                              len(self.warnings))
        return {**found, **self.what_was_run(), **self.provenance()}

    # --- tables ---

    def columns(self):
        """Quantities of the study's table, without those that have no value."""
        data = self.data
        same = len({round(row["released_m3"], 3) for row in data.finished}) == 1
        return [one for one in quantities.shown_on("page") if any(row.get(one.key) is not None for row in data.finished)
                and not (same and one.key == "released_m3")]

    def head(self, one):
        """Head of a quantity in a table: name and unit."""
        return quantities.name_of(one.key, self.data.finished) if one.key == LENGTH else one.heading, one.unit

    def beyond(self):
        """The note below the table on the volume beyond the road; "" without a road."""
        if self.data.road is None:
            return ""
        if any(row.get("beyond_road_m3") is not None for row in self.data.finished):
            return ("Beyond it: all of the deposit on the far side of the road. What is cut there is counted in \"to "
                    "remove\" too: the two overlap and cannot be added.")
        return ("How much lies beyond the road is unknown, because the road does not divide the grid; a control line "
                "(slope site --line) counts what passes it.")

    def terms(self):
        """What the usual variables mean, of those that the study has."""
        named = [*self.data.settings, *self.data.repeats]
        return "; ".join(f"{name}: {TERMS[name]}" for name in dict.fromkeys(named) if name in TERMS)

    def rows(self):
        """The study's table: for each run its variables, its cells or why it failed, and whether it is at rest."""
        data, best = self.data, (self.data.study or {}).get("conservative") or {}
        varied = [key for key, several in data.settings.items() if len(several) > 1] or list(data.settings)
        found = []
        for row in self.in_table():
            repeat = ", ".join(f"{name} {value}" for name, value in (row.get("repeat") or {}).items()) or "base"
            entry = {"set": [row["set"][key] for key in varied], "repeat": repeat, "run": row["run"],
                     "number": data.number(row["run"]),
                     "best": bool(best) and row["status"] == "finished" and row["set"] == best.get("set"),
                     "bad": row["status"] != "finished" or row["moving"], "error": row.get("error")}
            if row["status"] == "finished":
                name = data.label_of(row)
                entry["cells"] = [self.numbers.quantity(one.key, row.get(one.key), name, "-")
                                  for one in self.columns()]
                entry["end"], entry["at_rest"] = row.get("end_short", row["end"]), row["at_rest"]
            found.append(entry)
        return found

    def in_table(self):
        """The runs of the table: of a long one those with the least and the most of what counts, and failed ones."""
        rows = self.data.rows
        if len(rows) <= MOST_ROWS:
            return rows
        key = self.counts().key
        known = sorted((row for row in self.data.finished if row.get(key) is not None), key=lambda row: row[key])
        return [*known[:ENDS], *known[-ENDS:], *[row for row in rows if row["status"] != "finished"][:ENDS]]

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
        """Heads and rows of the table over combinations; None without repeats."""
        study = self.data.study
        if not (study and self.data.repeats and study.get("combinations")):
            return None
        averaged = [quantities.ALL[key] for key in quantities.keys(On.PAGE_MEAN)
                    if all(key in entry for entry in study["combinations"])]
        varied = [key for key, several in self.data.settings.items() if len(several) > 1]
        rows = []
        for entry in study["combinations"]:
            cells = []
            for one in averaged:
                cells.append(self.numbers.mean(one.name, one.unit, entry[one.key]["mean"],
                                               entry[one.key]["scatter"], str(entry["combination"])))
            best = study["conservative"] and entry["combination"] == study["conservative"]["combination"]
            rows.append({"set": [entry["set"][key] for key in varied], "runs": entry["repeats"], "cells": cells,
                         "best": best})
        return {"heads": list(map(self.head, averaged)), "rows": rows}

    def reference_tables(self):
        """Numbers from elsewhere: a table for each quantity, with the runs' own range beside them."""
        tables: List[Dict[str, Any]] = []
        if self.reference is None:
            return None
        own = self.data.compared
        for key, quantity in self.reference.quantities.items():
            what, unit = quantities.ALL[key].name, quantities.ALL[key].unit
            xs = sorted({x for points in quantity.series.values() for x, _ in points})
            series = [(name, [f"{dict(points)[x]:,.6g}" if x in dict(points) else "-" for x in xs])
                      for name, points in quantity.series.items()]
            low, high = (self.numbers(what, unit, pick(row[key] for row in own)) for pick in (min, max))
            tables.append({"what": f"{what} ({unit})", "variable": quantity.variable, "xs": [f"{x:g}" for x in xs],
                           "series": series, "own": low if low == high else f"{low} to {high}",
                           "levels": [(name, f"{value:,.6g}") for name, value in quantity.levels.items()]})
        return {"title": self.reference.title, "remark": self.reference.remark, "tables": tables}

    # --- what was run ---

    def what_was_run(self):
        """Name, title, purpose, deck, variables, and what the log says of the model."""
        data, one = self.data, self.data.result
        deck = find_deck(one)
        text = deck.read_text(encoding="utf-8", errors="replace") if deck else ""
        # the first line of a deck is its purpose; the others are for those who run it
        first = text.split("\n", 1)[0]
        name = self.heading["project"] or data.folder.absolute().name
        deck_name = data.study["study"]["deck"] if data.study else deck.name if deck else one.prefix.name
        variables = data.study and one.row.get("variables") or one.about.get("variables") or deck_variables(deck)
        digests = (one.marker.get("inputs") or {}) if deck else {}
        runs = f"study of {len(data.rows)} run{'s' * (len(data.rows) != 1)}" if data.study else "one run"
        purpose = first.lstrip("# ").removesuffix("; made by slope site, yours to change") if first[:1] == "#" else ""
        return {"name": name, "title": f"Slope collapse: {name}", "what": f"Slope collapse, {runs}",
                "deck_name": deck_name, "purpose": purpose,
                "deck": text, "variables": with_meanings(variables or {}, text),
                "settings_lines": one.log.settings, "notes": one.log.notes,
                "table": "\n".join(one.log.table),
                "sources": [{"name": file, "sha256": digest} for file, digest in digests.items()]}

    def provenance(self):
        one = self.data.result
        return {"machine": one.marker.get("machine"), "here": provenance.machine(), "package": one.about.get("package"),
                "packages": sorted({str(row.get("package")) for row in self.data.finished}),
                "command": one.about.get("command"), "wall": one.marker.get("wall_seconds"),
                "started": utc(one.about.get("started")), "ended": utc(one.marker.get("finished")),
                "lmp_sha256": one.about.get("lmp_sha256")}

    def place(self):
        """CRS and offset of the local metres; None without a CRS."""
        raster = self.ground.raster
        if raster.crs is None:
            return None
        return {"crs": crs_name(raster.crs), "east": raster.offset[0], "north": raster.offset[1]}


def utc(text):
    """An ISO time in UTC, to the minute; any other value is returned as it is."""
    try:
        return datetime.datetime.fromisoformat(text).astimezone(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    except (TypeError, ValueError):
        return text


def with_meanings(variables, deck):
    """(name, value, meaning) of variables; the meaning is the deck's comment on them, or a usual one."""
    comments = dict(MEANING.findall(deck))
    return [(name, value, comments.get(name.split(" ")[0]) or TERMS.get(name.split(" ")[0], ""))
            for name, value in variables.items()]


def deck_variables(deck):
    """Index variables of a deck that ran by hand: its defaults, marked as such."""
    return {f"{name} (deck's default)": value for name, value in decks.index_variables(deck).items()} if deck else {}
