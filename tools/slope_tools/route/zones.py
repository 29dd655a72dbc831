"""Zones: where something is exceeded with at least a probability, per year or of the runs, as polygons.

Of a cell the bounds of the probability (the runs', 90 %) decide: both at least P, and the cell is in the zone; one on
either side, and the runs cannot tell. Cells that no run reaches are in neither, which does not say that the probability
is less there: summarise_zones() has what so few runs leave possible. Polygons follow the cells; each corner is cut at
half a cell, which moves the edge by less than that.
"""
import math
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from rasterio.features import shapes
from shapely.geometry import Point, Polygon, shape

from ..case import run_folders
from ..deposits import deposit
from ..errors import SlopeError
from ..findings import Finding, encode_findings
from ..survey.geopackage import Layer
from ..survey.rasters import Raster, crs_name
from ..tables import ensemble_types, judged, named_run, study_file
from ..tables.rows import Failed, Finished, finished_of
from . import choices, corridor, reached, results, search
from .reached import Source
from .yearly import Yearly

QUANTITIES = {"thickness": ("max_thickness", "m"), "speed": ("max_speed", "m/s"), "energy": ("max_energy", "J")}
AT_LEAST, UNSURE = "at least", "runs cannot tell"
ASKED = {"quantity": "str", "exceeds": "float", "unit": "str", "probability": "float", "return_period": "float"}
PROPERTIES = {**ASKED, "class": "str", "cells": "int", "area_m2": "float"}
LAYER, PROCESS = "zones", "governing_process"
OF_PROCESS = {"process": "str", "body": "int", "known_events": "str", **ASKED, "area_m2": "float"}
GRAVE = {"lost much": "percent", "in motion": "share"}      # findings, and by which number one is graver
PROCESS_OF_MASS = "collapse of a slope"     # the only one that is modelled
COLOURS = ("215,48,39", "252,141,89", "254,224,139", "217,239,139", "145,191,219")      # of the probabilities


class Ground(NamedTuple):
    """Where the zones are; like: {body: the known events with which it is compared}; doubts: mass that left the terrain
    of its runs, or was in motion at their end, and what that did then; balls: m3, of the runs, where that is known."""
    raster: Raster
    sources: Sequence[Source]
    yearly: Optional[Yearly]
    like: Mapping[int, str]
    doubts: Sequence[Finding] = ()
    balls: Sequence[float] = ()

    def of_energy(self, several: Sequence["Limit"]) -> List[Finding]:
        """That the energy of a ball is none of a block, and of a mass no intensity."""
        size = " to ".join(dict.fromkeys(f"{one:.2g}" for one in (min(self.balls), max(self.balls)))) \
            if self.balls else ""
        return [Finding("energy of balls", {"size": f", of {size} m3 here" * bool(size)})] * (
            several[0].quantity == "energy")


class Limit(NamedTuple):
    """What is exceeded."""
    quantity: str
    value: float


def probabilities(text: str) -> List[float]:
    """Those of --zones, each less than the one before."""
    rule = "must be probabilities > 0 and < 1 that fall, such as 1/100,1/1000,1/5000 or 0.5,0.1"
    try:
        numbers = [float(over) / float(under if mark else 1)
                   for over, mark, under in (one.partition("/") for one in text.split(","))]
    except (ValueError, ZeroDivisionError):
        numbers = []
    if not numbers or not all(0 < one < 1 for one in numbers) or any(b >= a for a, b in zip(numbers[:-1], numbers[1:])):
        raise SlopeError("--zones", rule, text)
    return numbers


def limits(thicker: float, intensity: Optional[str]) -> List[Limit]:
    """Those of --thicker and --intensity."""
    if thicker < 0:
        raise SlopeError("--thicker", "must be >= 0 m", f"{thicker:g}")
    if intensity is None:
        return [Limit("thickness", thicker)]
    quantity, _, values = intensity.partition(":")
    try:
        numbers = [float(one) for one in values.split(",")]
    except ValueError:
        numbers = []
    if quantity not in QUANTITIES or not numbers or not all(math.isfinite(one) and one >= 0 for one in numbers) or any(
            b <= a for a, b in zip(numbers[:-1], numbers[1:])):
        raise SlopeError("--intensity", "must be thickness, speed or energy with limits >= 0 that rise, such as "
                         "thickness:0.5,2 (m, m/s, J)", intensity)
    return [Limit(quantity, one) for one in numbers]


def ground_of(name: str, warn) -> Ground:
    """Of a route, of a study or a site, or of one run."""
    folder = Path(name)
    if (folder / choices.NAME).is_file():
        asked = choices.read_route_choices(folder)
        table = search.table_of(folder)
        bodies = [results.read_body(folder, about) for about in table["bodies"]]
        doubts = [one._replace(part=f"body {body.number}", runs=()) for body in bodies
                  for one in find_zone_doubts(body.finished)]
        return Ground(corridor.read_corridor(asked, folder).raster, [body.source for body in bodies],
                      results.yearly_of(asked, folder, table["bodies"]),
                      {about["body"]: about["known_law"] for about in table["bodies"]},
                      [results.gravest(same, number) for kind, number in GRAVE.items()
                       if (same := [one for one in doubts if one.kind == kind])],
                      [row.ball_m3 for body in bodies for row in body.finished])
    study = study_file.study_in(folder, weighted=True)
    if study is None:
        run = deposit.read_deposit(named_run.read_named_run(name).prefix, None, warn)
        return Ground(run.raster, [Source(1, [Path(run.prefix)], np.ones(1), 0, run.raster.offset)], None, {})
    study_ = study_file.load_study(study / study_file.STUDY)
    weighted = ensemble_types.weighted(study_.ensemble)
    known = weighted.weights if weighted else None
    rows = [row for row in finished_of(study_.runs) if (row.run in known if known else not row.batch)]
    if not rows:
        raise SlopeError(study, "must have finished runs that are counted alike, or have weights")
    prefixes = [run_folders.prefix_of(run_folders.summary_of(study, row.summary)) for row in rows]
    weights = np.array([known[row.run] if known else 1.0 for row in rows])
    run = deposit.read_deposit(str(prefixes[0]), None, warn)
    failed = sum(isinstance(row, Failed) and bool(known or not row.batch) for row in study_.runs)
    effect = 1.0 if known else len(rows) / len({str(row.set) for row in rows})
    return Ground(run.raster, [Source(1, prefixes, weights / weights.sum(), failed, run.raster.offset, effect)], None,
                  {1: weighted.set} if weighted else {}, find_zone_doubts(rows), [row.ball_m3 for row in rows])


def find_zone_doubts(rows: Sequence[Finished]) -> List[Finding]:
    """Of runs whose mass went, or goes on, where no map shows it."""
    return [one for one in (*judged.lost(rows), *judged.not_at_rest(rows)) if one.kind in GRAVE]


def check_zones(ground: Ground, wanted: Sequence[float], name: object, text: str = "") -> None:
    """Raise SlopeError if the hazard curve does not reach a probability, or the runs without one do not tell shares.

    text: that of --zones; 1/100 reads like a return period, which needs a hazard.
    """
    if ground.yearly is None:
        periods = [one for one in text.split(",") if "/" in one]
        if periods:
            raise SlopeError("--zones", f"must be shares of the runs, such as 0.5,0.1, as {name} has no hazard, with "
                             "which they are per year (slope fragility --hazard, then slope route --fragility)",
                             periods[0])
        least = min(one.bounds(one.weights.min())[0] for one in ground.sources)
        if wanted[1:] and wanted[-2] < least:
            raise SlopeError("--zones", f"must have at most one share below {least:.2g}, as the runs of {name} do not "
                             "tell these apart: make more of them", f"{wanted[-2]:g} and {wanted[-1]:g}")
        return
    most, least = (1 - math.exp(-float(ground.yearly.rate.rates[end])) for end in (0, -1))
    for one in wanted:
        if not least <= one <= most:
            raise SlopeError("--zones", f"must be within the hazard curve of {name}, {least:.3g} to {most:.3g} per "
                             "year", f"{one:g}")


class Zones(NamedTuple):
    """Of one limit: classes, of each probability an array of the cells: 1 in the zone, 2 the runs cannot tell, 0; body:
    which one governs in each, 0 where none comes."""
    limit: Limit
    classes: List[np.ndarray]
    body: np.ndarray


def make_zones(ground: Ground, limit: Limit, wanted: Sequence[float]) -> Zones:
    hits = reached.combine_reached(ground.sources, ground.raster, QUANTITIES[limit.quantity][0], limit.value)
    found = [reached.of_set(one, ground.sources, ground.yearly) for one in hits.sets]
    low, high = np.array([probable(one) if one else (0.0, 0.0) for one in found]).T
    bodies = np.array([one.body if one else 0 for one in found], np.int32)
    return Zones(limit, [np.where(low >= one, 1, np.where(high >= one, 2, 0)).astype(np.uint8)[hits.codes]
                         for one in wanted], bodies[hits.codes])


def probable(combined: reached.Combined) -> Tuple[float, float]:
    if combined.per_year is None:
        return combined.low, combined.high
    return 1 - math.exp(-combined.per_year["low"]), 1 - math.exp(-combined.per_year["high"])


def smoothed(area: Polygon, cell: float) -> Polygon:
    """A polygon along cells whose corners are cut at half a cell: each takes or adds an eighth of a cell."""
    def ring(points) -> np.ndarray:
        corners = np.asarray(points)[:-1]
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        ends = [corners + (other - corners) / np.hypot(*(other - corners).T)[:, None] * cell / 2
                for other in (before, after)]
        return np.stack(ends, axis=1).reshape(-1, 2)
    return Polygon(ring(area.exterior.coords), [ring(inner.coords) for inner in area.interiors])


def features(ground: Ground, zones: Zones, wanted: Sequence[float]) -> Iterator[Tuple[Polygon, Dict[str, Any]]]:
    """The polygons of a limit with the values of PROPERTIES, rare ones first."""
    cell = float(ground.raster.transform.a)
    for probability, classes in reversed(list(zip(wanted, zones.classes))):
        for part, kind in shapes(classes, classes > 0, connectivity=4, transform=ground.raster.transform):
            area = shape(part)
            yield smoothed(area, cell), {
                **list_asked_values(ground, zones.limit, probability), "class": AT_LEAST if kind == 1 else UNSURE,
                "cells": round(area.area / cell ** 2), "area_m2": area.area}


def list_asked_values(ground: Ground, limit: Limit, probability: float) -> Dict[str, Any]:
    """The values of ASKED."""
    return {"quantity": limit.quantity, "exceeds": limit.value, "unit": QUANTITIES[limit.quantity][1],
            "probability": probability, "return_period": 1 / probability if ground.yearly else None}


def points(ground: Ground, zones: Zones, wanted: Sequence[float]) -> Iterator[Tuple[Point, Dict[str, Any]]]:
    """A point, with the values of OF_PROCESS, in each part of a zone in which one body governs."""
    for probability, classes in reversed(list(zip(wanted, zones.classes))):
        governs = np.where(classes == 1, zones.body, 0)
        for part, body in shapes(governs, governs > 0, connectivity=4, transform=ground.raster.transform):
            area = shape(part)
            yield area.representative_point(), {
                "process": PROCESS_OF_MASS, "body": int(body), "known_events": ground.like.get(int(body), ""),
                **list_asked_values(ground, zones.limit, probability), "area_m2": area.area}


def layers(ground: Ground, several: Sequence[Zones], wanted: Sequence[float]) -> Dict[str, Layer]:
    return {LAYER: Layer("Polygon", PROPERTIES, (one for zones in several for one in features(ground, zones, wanted))),
            PROCESS: Layer("Point", OF_PROCESS, (one for zones in several for one in points(ground, zones, wanted)))}


def asked(ground: Ground, text: str, several: Sequence[Limit]) -> str:
    """What is asked for, in words: of two questions it is not the same."""
    return (f"{text} {'per year' if ground.yearly else 'of the runs'}, {several[0].quantity} > "
            + ", ".join(f"{one.value:g}" for one in several))


def summarise_zones(ground: Ground, several: Sequence[Zones], wanted: Sequence[float]) -> Dict[str, Any]:
    """What zones.yaml says."""
    area = float(ground.raster.transform.a) ** 2
    least = reached.combined(ground.sources, [0.0] * len(ground.sources), ground.yearly)
    return {"per_year": ground.yearly is not None, "crs": ground.raster.crs and crs_name(ground.raster.crs),
            "runs": sum(len(one.prefixes) for one in ground.sources), "unreached_at_most": probable(least)[1],
            "doubts": encode_findings(ground.doubts), "zones": [
                {"quantity": zones.limit.quantity, "exceeds": zones.limit.value, "probability": probability,
                 "at_least_m2": float((classes == 1).sum()) * area,
                 "cannot_tell_m2": float((classes == 2).sum()) * area}
                for zones in several for probability, classes in zip(wanted, zones.classes)]}


def style(several: Sequence[Zones], wanted: Sequence[float], yearly: bool) -> str:
    """A style of QGIS: a rule for each limit, probability and class."""
    rules: List[str] = []
    symbols: List[str] = []
    for zones in several:
        for k, probability in enumerate(wanted):
            for kind, alpha in ((AT_LEAST, 170), (UNSURE, 40)):
                number = len(rules)
                unit = QUANTITIES[zones.limit.quantity][1]
                words = f"{zones.limit.quantity} &gt; {zones.limit.value:g} {unit}: " + (
                    f"1/{1 / probability:.6g} a year" if yearly else f"{100 * probability:g} % of the runs")
                rules.append(
                    f'<rule key="{number}" symbol="{number}" label="{words}, {kind}" filter="&quot;exceeds&quot; = '
                    f'{zones.limit.value!r} AND &quot;probability&quot; = {probability!r} AND &quot;class&quot; = '
                    f'\'{kind}\'"/>')
                symbols.append(
                    f'<symbol type="fill" name="{number}" alpha="1"><layer class="SimpleFill">'
                    f'<prop k="color" v="{COLOURS[k % len(COLOURS)]},{alpha}"/><prop k="outline_color" '
                    f'v="60,60,60,255"/><prop k="outline_style" v="{"solid" if kind == AT_LEAST else "dot"}"/>'
                    '<prop k="outline_width" v="0.2"/></layer></symbol>')
    return ("<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n<qgis version=\"3.22\"><renderer-v2 "
            f"type=\"RuleRenderer\"><rules key=\"all\">{''.join(rules)}</rules><symbols>{''.join(symbols)}</symbols>"
            "</renderer-v2></qgis>\n")
