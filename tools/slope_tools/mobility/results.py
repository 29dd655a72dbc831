"""A mass among known events in words, as a table and as files; all of them or none."""
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from .. import disk
from ..digits import metres, percent, format_volume
from ..errors import SlopeError
from ..findings import Finding, encode_findings
from ..provenance import version
from ..sites import site_choices
from ..survey import geopackage
from ..survey.geopackage import Layer
from . import body, lucas
from .body import Body
from .events import NOT_OF_ROADS
from .fall_path import TERRAIN, AtRoad
from .known import WORDS, Choice, Found, Mobility, Way, choice, compute_known_mobility

TABLE, SUMMARY, MAP, PROFILE = "mobility.csv", "mobility.yaml", "mobility_map.png", "mobility_profile.png"
LINES = "mobility.gpkg"
FILES = (TABLE, LINES, MAP, PROFILE, SUMMARY)
SHARES = (0.95, 0.9, 0.5, 0.1, 0.05)        # of known events, whose lengths are given


class Source(NamedTuple):
    """What a result was made of, for its summary."""
    terrain: str                        # or the folder of the site
    body: Body
    asked: Choice
    road: Optional[BaseGeometry]        # local m


def compute_path_columns(mobilities: Found, body: Body) -> Dict[str, np.ndarray]:
    """The path: length, height below the crown, elevation, place, probability of going beyond by each kind of events.

    NaN: the events do not cover the mass, or none of them had this fall.
    """
    path = mobilities.decides.path
    curves = {f"exceedance_{kind}": np.where(one.said & one.in_range, curve, np.nan)
              for one in mobilities.each for kind, curve in one.curves.items()}
    return {"length_m": path.length, "height_m": path.fall, "elevation_m": path.elevation(body), "x": path.x,
            "y": path.y, **curves}


def tabulate_path(mobilities: Found, body: Body) -> str:
    """The columns as CSV; an empty cell stands for NaN."""
    values = compute_path_columns(mobilities, body)
    return disk.csv_text(values, ([*(f"{value:.3f}" for value in row[:5]),
                                   *("" if np.isnan(value) else f"{value:.6g}" for value in row[5:])]
                                  for row in zip(*values.values())))


def write_lines(path: Path, mobilities: Found, body: Body) -> None:
    """The path for a GIS: a piece from each point to the next, with what the table has at its end."""
    values = compute_path_columns(mobilities, body)
    places = np.column_stack([values.pop("x"), values.pop("y")])
    features = [(LineString(places[k:k + 2]), {name: None if np.isnan(one[k + 1]) else float(one[k + 1])
                                               for name, one in values.items()}) for k in range(len(places) - 1)]
    geopackage.write_geopackage(path, {"path": Layer("LineString", dict.fromkeys(values, "float"), features)},
                                body.raster)


def second_opinion(mass: Body, mobilities: Found) -> str:
    """That of a law that knows nothing of the events."""
    said = lucas.opinion(mass, mobilities.decides.path)
    return (f"second opinion, {lucas.NAME}: the line from crown to tip falls by {said.angle:.1f} degrees "
            f"({said.steep:.1f} to {said.flat:.1f}, {100 * lucas.BAND:g} %), which is after "
            f"{ends(said.reach, said.toe)} ({ends(said.near, said.toe)} to {ends(said.far, said.toe)})")


def describe_site_mobility(folder: Path) -> Tuple[List[str], List[Finding]]:
    """Both, of the folder of a site; nothing where its mass has no fall path."""
    choices = site_choices.load_site(folder).choices
    try:
        mass = body.read_mobility_body(folder)
        found = compute_known_mobility(mass, choice(choices.known.set, (), choices.known.confined))
    except SlopeError:
        return [], []
    return [second_opinion(mass, found)], [*mass.beside(), *disagreement(mass, found)]


def ends(length: Optional[float], toe: float = -1.0) -> str:
    """Where a mass ends, whose body ends at the toe (m)."""
    if length is None or np.isinf(length):
        return "the end of the path"
    return metres(length) + " or less" * (length <= toe)


def disagreement(mass: Body, mobilities: Found) -> List[Finding]:
    """Where the second opinion and the events that count have nothing in common."""
    opinion = lucas.opinion(mass, mobilities.decides.path)
    if (known := lucas.differ(opinion, mobilities.decides)) is None:
        return []
    return [Finding("second opinion", {
        "name": lucas.NAME, "near": ends(opinion.near, opinion.toe), "far": ends(opinion.far, opinion.toe),
        "events": mobilities.decides.law.name, "known_near": ends(known.near), "known_far": ends(known.far),
        "farther": "the events" if known.near > lucas.or_infinite(opinion.far) else "that law's masses"})]


def find_mobility_caveats(mass: Body, mobilities: Found) -> List[Finding]:
    """What must be said: several bodies, out of range, or a path that ends too early."""
    counts = mobilities.decides
    several = [*mass.beside()] if not counts.path.drawn else []
    several += [Finding("outside of set", {"text": text}) for text in (mobilities.by_set.outside if mobilities.by_set
                                                                       else [])]
    if counts.length_at(0.5) is None and counts.path.end == TERRAIN:
        several.append(Finding("path ends", {"length": metres(counts.path.length[-1]),
                                             "share": percent(counts.beyond_path())}))
    return several


def of_events(mobility: Mobility) -> Dict[str, Any]:
    """Lengths by the curves of a set or a row; None where it does not cover the mass."""
    return {kind: {"lengths_m": {str(share): None if mobility.at_most(share, kind) else mobility.length_at(share, kind)
                                 for share in SHARES},
                   "at_most_m": {str(share): mobility.at_most(share, kind) for share in SHARES},
                   "beyond_path": mobility.beyond_path(kind)} if mobility.in_range else None for kind
            in mobility.curves}


def at_road(mobilities: Found, road: AtRoad) -> Dict[str, Any]:
    """What is said of the road's near edge, and of its far one, by each kind of events; None: nothing.

    at_least: where those that count say nothing, as the road lies so near to the body.
    """
    counts = mobilities.decides
    told: Dict[str, Any] = {"at_least": None if road.behind or counts.says(road.length) else
                            at_least(counts, road.length)}
    for name, length in (("exceedance", road.length), ("passed", road.passed)):
        told.update({f"{name}_{kind}": float(one.exceedance(length, kind))
                     if one.says(length) and not road.behind else None
                     for one in mobilities.each for kind in one.curves})
        told[name] = told[f"{name}_{counts.chosen}"]
    return told


def at_least(mobility: Mobility, length: float) -> Optional[float]:
    """The share that goes beyond the next point of the path of which the events say something, None without any."""
    after = np.flatnonzero(mobility.said & (mobility.path.length >= length))
    return float(mobility.curves[mobility.chosen][after[0]]) if mobility.in_range and len(after) else None


def summarise_mobility(mobilities: Found, source: Source, way: Optional[Way]) -> Dict[str, Any]:
    """What SUMMARY holds."""
    counts, by_set, row = mobilities.decides, mobilities.by_set, source.asked.row
    path, road = counts.path, way and way.at
    whole: Dict[str, Any] = {
        "slope_version": version(), "terrain": source.terrain, "volume_m3": source.body.volume,
        "crown": dict(zip("xyz", path.crown)), "in_range": bool(by_set and by_set.in_range),
        "warnings": encode_findings(find_mobility_caveats(source.body, mobilities)),
        "path": {"length_m": path.length[-1], "height_m": path.fall[-1], "ends": path.end},
        "exceedance_is": counts.chosen, "confined_path": source.asked.confined}
    for one in mobilities.each:
        whole.update(of_events(one))
    whole["road"] = way and road and {
        "on_path": road.met, "own_path": way.own, "behind": road.behind, "beside_path_m": road.beside,
        "length_m": road.length, "passed_m": road.passed, "height_m": road.fall, "x": road.x, "y": road.y,
        **at_road(way.mobilities, road)}
    whole["landslides"] = {"row": f"{row.type}:{row.path}", "events": row.events, "a": row.a, "b": row.b,
                           "deviations": list(row.deviations), "note": NOT_OF_ROADS,
                           **(whole["landslides"] or {})}
    if by_set:
        law = source.asked.relation
        whole["set"] = {"file": str(source.asked.file), "events": len(source.asked.known),
                        "left_out": list(source.asked.left_out), "volumes_Mm3": law.volumes, "falls_m": law.falls,
                        "confined": law.lateral}
        whole["relation"] = {**dict(zip(("constant", "log_volume", "log_fall", "confined"), law.coefficients)),
                             "deviation": law.deviation, "degrees_of_freedom": law.free, "r2": law.r2}
    return {**whole, "second_opinion": {"law": lucas.NAME, "share": lucas.BAND,
                                        **lucas.opinion(source.body, path)._asdict()}, "files": list(FILES)}


def describe_mobility(mobilities: Found, source: Source, way: Optional[Way]) -> List[str]:
    """What the user reads."""
    counts, path = mobilities.decides, mobilities.decides.path
    x, y, z = path.crown
    lines = [f"{format_volume(1e6 * counts.volume)}, crown at {x:.1f} {y:.1f}, elevation {z:.1f} m",
             f"fall path of {metres(path.length[-1])}, down to {metres(path.fall[-1])} below the crown, "
             + path.end]
    for mobility in mobilities.each:
        name = f"{len(source.asked.known)} events of {source.asked.file.name}" if mobility is mobilities.by_set else \
            f"{source.asked.row.name} (Corominas 1996; {NOT_OF_ROADS})"
        if not mobility.in_range:
            lines.append(f"{name}: nothing, they do not cover this mass")
            continue
        lines.append(f"{name}: {'these count' if mobility is counts else 'beside them'}, {WORDS[mobility.chosen]}")
        lines += [f"  {WORDS[kind]}: {lengths(mobility, kind)}" for kind in mobility.curves]
    if way:
        road = way.at
        where = "the road, first met" if road.met else \
            f"the road, which the path passes {metres(road.beside)} beside,"
        lines.append(f"{where} after {metres(road.length)}, {metres(road.fall)} below the crown{describe_way(way)}: "
                     f"{describe_road_reach(way)}")
    return [*lines, second_opinion(source.body, mobilities)]


def lengths(mobility: Mobility, kind: str) -> str:
    """How far shares of the events go, of a curve."""
    parts = []
    for share in SHARES:
        length, most = mobility.length_at(share, kind), mobility.at_most(share, kind)
        if most is not None:
            parts.append(f"{percent(share)} beyond {metres(most)} or less")
        elif length is not None:
            parts.append(f"{percent(share)} beyond {metres(length)}")
    return (f"{', '.join(parts) or 'nearly all beyond the path'}; beyond the "
            f"{'terrain' if mobility.path.end == TERRAIN else 'path'}: {percent(mobility.beyond_path(kind))}")


def describe_way(way: Way) -> str:
    """Which path comes to the road, where that is not the mass's own."""
    return "" if way.own or way.at.behind else " along the path of another part of the mass"


def describe_road_reach(way: Way) -> str:
    """What the events that count say of the road."""
    road, counts = way.at, way.mobilities.decides
    if road.behind:
        return "nothing, it lies behind the crown or as high"
    if not counts.says(road.length):
        least = at_least(counts, road.length)
        return "nothing, no known event had such a fall" if least is None else \
            f"the events say nothing so near to the body; at least {percent(least)} reach it"
    text = f"{percent(float(counts.exceedance(road.length)))} go beyond " + (
        "its near edge" if road.met else "that point of the path")
    return text + f", {percent(float(counts.exceedance(road.passed)))} beyond its far edge" * (
        road.passed > road.length and counts.says(road.passed))


def write_mobility(folder: Path, mobilities: Found, source: Source, road: Optional[Way]) -> None:
    """All files into a folder."""
    from . import charts        # matplotlib: only once all is there
    with disk.complete(folder, SUMMARY) as new:
        (new / TABLE).write_text(tabulate_path(mobilities, source.body), encoding="ascii")
        write_lines(new / LINES, mobilities, source.body)
        charts.draw_map(new / MAP, mobilities.decides, source.body, source.road, road)
        charts.draw_profile(new / PROFILE, mobilities, source.body, road)
        disk.write_yaml(new / SUMMARY, summarise_mobility(mobilities, source, road), "slope mobility: m, local x y, "
                        "volumes " "in m3; " "exceedance: share of known events that go farther")
