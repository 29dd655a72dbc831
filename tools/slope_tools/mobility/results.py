"""The Mobility of a body in words, as a table and as files; all of them or none."""
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from shapely.geometry.base import BaseGeometry

from .. import disk
from ..digits import rounded
from ..provenance import version
from .body import Body
from .exceedance import WORDS, Mobility
from .fall_path import TERRAIN
from .road import AtRoad

TABLE, SUMMARY, MAP, PROFILE = "mobility.csv", "mobility.yaml", "mobility_map.png", "mobility_profile.png"
FILES = (TABLE, MAP, PROFILE, SUMMARY)
SHARES = (0.95, 0.9, 0.5, 0.1, 0.05)        # of known events, whose lengths are given
NAMES = {True: "confined", False: "unconfined"}


class Source(NamedTuple):
    """What a Mobility was made of, for its summary."""
    terrain: str                        # or the folder of the site
    body: Body
    events: str                         # file of the set
    number: int                         # of its events that count
    left_out: Sequence[str]             # names
    road: Optional[BaseGeometry]        # local m


def table(mobility: Mobility) -> str:
    """The path as CSV: length, height below the crown, place, probability of going beyond; see Mobility.severe."""
    path, severe = mobility.path, mobility.severe
    columns = {"length_m": path.length, "height_m": path.fall, "x": path.x, "y": path.y,
               "exceedance": mobility.curves[severe]}
    columns.update({f"exceedance_{NAMES[kind]}": curve for kind, curve in mobility.curves.items() if kind != severe})
    return disk.csv_text(columns, ([*(f"{value:.3f}" for value in row[:4]), *(f"{value:.6g}" for value in row[4:])]
                                   for row in zip(*columns.values())))


def doubts(mobility: Mobility) -> List[str]:
    """What must be said of it: out of range, or a path that ends too early; a line each."""
    lines = [f"{text}; nothing may be conditioned on these probabilities" for text in mobility.outside]
    median = [kind for kind in mobility.curves if mobility.length_at(0.5, kind) is None]
    if median and mobility.path.end == TERRAIN:
        share = percent(max(mobility.beyond_path(kind) for kind in median))
        lines.append(f"the path leaves the terrain after {rounded(mobility.path.length[-1], 4)} m, where {share} of "
                     "known events go on: take a larger terrain")
    return lines


def about(mobility: Mobility, source: Source, road: Optional[AtRoad]) -> Dict[str, Any]:
    """What SUMMARY holds."""
    path, found = mobility.path, mobility.relation
    each = {NAMES[kind]: {"lengths_m": {str(share): mobility.length_at(share, kind) for share in SHARES},
                          "beyond_path": mobility.beyond_path(kind)} for kind in mobility.curves}
    return {
        "slope_version": version(), "terrain": source.terrain, "volume_m3": source.body.volume,
        "crown": dict(zip("xyz", path.crown)), "in_range": mobility.in_range, "warnings": doubts(mobility),
        "path": {"length_m": path.length[-1], "height_m": path.fall[-1],
                 "ends": path.end},
        "exceedance_is": NAMES[mobility.severe], **each,
        "road": road and {"on_path": road.met, "beside_path_m": road.beside, "length_m": road.length,
                          "height_m": road.fall, "x": road.x, "y": road.y,
                          "exceedance": float(mobility.exceedance(road.length)),
                          **{f"exceedance_{NAMES[kind]}": float(mobility.exceedance(road.length, kind))
                             for kind in mobility.curves if kind != mobility.severe}},
        "set": {"file": source.events, "events": source.number, "left_out": list(source.left_out),
                "volumes_Mm3": found.volumes, "falls_m": found.falls},
        "relation": {**dict(zip(("constant", "log_volume", "log_fall", "confined"), found.coefficients)),
                     "deviation": found.deviation, "degrees_of_freedom": found.free, "r2": found.r2},
        "files": list(FILES)}


def words(mobility: Mobility, source: Source, road: Optional[AtRoad]) -> List[str]:
    """What the user reads."""
    path = mobility.path
    x, y, z = path.crown
    lines = [f"{rounded(mobility.volume)} million m3, crown at {x:.1f} {y:.1f}, {z:.1f} m high; {source.number} events "
             f"of {Path(source.events).name}",
             f"fall path of {rounded(path.length[-1], 4)} m, down to {rounded(path.fall[-1], 4)} m below the crown, "
             + path.end]
    for kind in mobility.curves:
        lengths = [f"{percent(share)} beyond {rounded(length, 4)} m" for share in SHARES
                   if (length := mobility.length_at(share, kind)) is not None]
        lines.append(f"{WORDS[kind]}: {', '.join(lengths) or 'nearly all beyond the path'}; beyond the "
                     f"{'terrain' if path.end == TERRAIN else 'path'}: {percent(mobility.beyond_path(kind))}")
    if road:
        shares = ", ".join(f"{percent(float(mobility.exceedance(road.length, kind)))} ({WORDS[kind]})"
                           for kind in mobility.curves)
        where = "the road, first met" if road.met else \
            f"the path does not meet the road, and is nearest to it, {rounded(road.beside, 4)} m beside,"
        at = f"{rounded(road.length, 4)} m, {rounded(road.fall, 4)} m below the crown"
        lines.append(f"{where} after {at}: {shares} go beyond")
    return lines


def percent(share: float) -> str:
    """A share as a user reads it: two digits, never a certain 0 or 100 %."""
    value = 100 * share
    if value < 0.1:
        return "less than 0.1 %"
    if value > 99.9:
        return "more than 99.9 %"
    return f"{value:.2g} %" if value < 10 else f"{value:.0f} %" if value < 99 else f"{value:.1f} %"


def write(folder: Path, mobility: Mobility, source: Source, road: Optional[AtRoad]) -> None:
    """All files into a folder."""
    from . import charts        # matplotlib: only once all is there
    with disk.complete(folder, SUMMARY) as new:
        (new / TABLE).write_text(table(mobility), encoding="ascii")
        charts.draw_map(new / MAP, mobility, source.body, source.road)
        charts.draw_profile(new / PROFILE, mobility, source.body, road)
        disk.write_yaml(new / SUMMARY, about(mobility, source, road), "slope mobility: m, local x y, volumes in m3; "
                        "exceedance: share of known events that go farther")
