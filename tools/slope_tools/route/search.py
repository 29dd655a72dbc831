"""The bodies along a corridor: searched window by window, or given as polygons; each with ground of its own.

A body has a folder slips/N: terrain.asc, the part of the terrain on which it runs; body.N.base.asc, the ground without
it; body.slips.csv and body.N.columns.csv, its row and its columns of find_slip; road.csv, the road there. `slope site
--slips` and `slope fragility` take it.
"""
import csv
import math
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from .. import disk, schemas
from ..case import slip_deck
from ..case.slip_deck import PREFIX, Strength
from ..digits import cents
from ..errors import SlopeError
from ..geometry import extent_of
from ..findings import Finding
from ..mobility import body as falling
from ..mobility import known
from ..releases import release, release_files
from ..runs import slip_run
from ..slips import bishop, bodies, failed
from ..survey import polygons, rasters, vectors
from ..survey.features import attribute, depth_of, size_of
from .choices import TABLE, WHAT, Choices
from .corridor import TERRAIN, Corridor, Window, cut_window, searches, write_line

WINDOWS, SLIPS = "windows", "slips"
DONE = "window.yaml"        # of a window that was searched
SHARED = 0.1                # of the smaller body's cells; bodies that share more are one
ADVICE = polygons.Advice(polygon_crs="save it from a GIS with one; a .prj file beside a shapefile",
                         terrain_crs="--assign-crs EPSG:n", wrong_crs="save it from a GIS with the right CRS")
BODY = schemas.mapping({
    "body": schemas.COUNT, "name": schemas.TEXT, "factor": schemas.MAYBE, "known_share": schemas.MAYBE,
    "why_not": schemas.TEXT,
    **schemas.number_keys("chainage_m", "x", "y", "volume_m3", "area_m2", "depth_m", "road_from_m")},
    no_factor=schemas.TEXT)
NO_BODY = "limits must leave a sphere"      # find_slip, where no body is within its limits


class Slip(NamedTuple):
    """A body: its ground's cells, the heights below it there (NaN beside it), and its row of find_slip, if any."""
    window: Window
    base: np.ndarray
    factor: Optional[float]     # None of a body that was given without strengths; infinite, NaN: factor_of_safety()
    row: Optional[Mapping[str, str]] = None
    columns: Path = Path()  # the file of find_slip that goes with the row
    name: str = ""          # of a body that was given

    @property
    def mask(self) -> np.ndarray:
        return np.isfinite(self.base)


def search_route_bodies(choices: Choices, corridor: Corridor, folder: Path, lmp: Path, ranks: int, tell,
                        warn) -> Dict[str, Any]:
    """The bodies of a route, in its folder: what bodies.yaml says. They are made once."""
    path = folder / TABLE
    if path.is_file():
        return table_of(folder)
    slips = given(choices, corridor, warn) if choices.bodies else searched(choices, corridor, folder, lmp, ranks, tell)
    if not slips:
        raise SlopeError(choices.road, f"must have a slope within {choices.corridor:g} m with a factor of safety below "
                         f"{choices.below:g} (--below), for these strengths")
    slips.sort(key=lambda slip: corridor.chainage(*middle(corridor, slip)))
    kept: List[Dict[str, Any]] = []
    left: List[Dict[str, Any]] = []
    for number, one in enumerate(slips, 1):
        about = settled(choices, corridor, folder / SLIPS / str(number), one, number)
        (left if about["why_not"] else kept).append(about)
        if about["why_not"]:
            tell(f"body {number} at {about['chainage_m']:.0f} m is left out: {about['why_not']}")
    if not kept:
        raise SlopeError(choices.road, "must be reached by a body, all are left out (--reach)", len(left))
    disk.write_yaml(path, {"bodies": kept, "left_out": left}, "slope route: m, m2, m3; chainage of the road")
    return {"bodies": kept, "left_out": left}


def table_of(folder: Path) -> Dict[str, Any]:
    """What bodies.yaml of a route says."""
    return schemas.load_checked(folder / TABLE, WHAT, schemas.mapping({"bodies": schemas.list_of(BODY, 1), "left_out":
                                                                       schemas.list_of(BODY)}))


def middle(corridor: Corridor, slip: Slip) -> Tuple[float, float]:
    row, column = np.nonzero(slip.mask)
    x, y = corridor.clip(slip.window).transform @ (column.mean() + 0.5, row.mean() + 0.5)
    return float(x), float(y)


def shared(slip: Slip, other: Slip) -> float:
    """Of the smaller one's cells, those that both have."""
    common = slip.window.common(other.window)
    if common.empty:
        return 0.0
    both = slip.mask[common.inside(slip.window)] & other.mask[common.inside(other.window)]
    return float(both.sum()) / min(slip.mask.sum(), other.mask.sum())


# --- searched ---

def searched(choices: Choices, corridor: Corridor, folder: Path, lmp: Path, ranks: int, tell) -> List[Slip]:
    """The bodies of all windows with a factor of safety below the limit, the least first; none shares its ground."""
    slips: List[Slip] = []
    windows = list(searches(corridor))
    for k, (window, ground) in enumerate(windows, 1):
        place = folder / WINDOWS / str(k)
        if not (place / DONE).is_file():
            search(choices, corridor, window, ground, place, lmp, ranks)
            tell(f"window {k} of {len(windows)} is searched")
        slips += [one for one in of_window(place, window)
                  if one.factor is not None and one.factor < choices.below]
    slips.sort(key=lambda slip: slip.factor or 0.0)
    several: List[Slip] = []
    for one in slips:
        if all(shared(one, other) <= SHARED for other in several):
            several.append(one)
    return several


def search(choices: Choices, corridor: Corridor, window: Window, ground, place: Path, lmp: Path, ranks: int) -> None:
    """Search a window; its folder is whole, or not there."""
    assert choices.cohesion is not None and choices.friction is not None  # choices.check_route_choices() has seen to it
    raster = corridor.clip(window)
    place.parent.mkdir(parents=True, exist_ok=True)
    with disk.complete(place, DONE) as new:
        rasters.write_asc_local(new / TERRAIN, raster, {}, exact=True)
        asked = slip_deck.Asked(new / TERRAIN, Strength(choices.cohesion, choices.friction, choices.density), (),
                                choices.water, within=True, volume=limits(choices.volume), depth=limits(choices.depth),
                                keep=choices.keep)
        number, warnings = 0, []
        try:
            warnings = slip_run.run_slip_search(asked, ground, raster, new, lmp, ranks, lambda line: None).warnings
            number = len(bodies.read_body_rows(new / f"{PREFIX}{bodies.END}"))
            slip_run.settle(asked._replace(terrain=place / TERRAIN), raster, new, number, place)
        except SlopeError as error:
            if NO_BODY not in str(error):
                raise
        disk.write_yaml(new / DONE, {"bodies": number, "warnings": warnings}, "slope route: a window of the search")


def limits(given_: Optional[List[float]]) -> Optional[Tuple[float, float]]:
    return (given_[0], given_[1]) if given_ else None


def of_window(place: Path, window: Window) -> List[Slip]:
    """The bodies of a window that was searched."""
    table = place / f"{PREFIX}{bodies.END}"
    if not schemas.load_checked(place / DONE, WHAT, schemas.mapping({"bodies": {"type": "integer"}}))["bodies"]:
        return []
    with open(table, newline="", encoding="utf-8") as source:
        rows = list(csv.DictReader(source))
    return [Slip(window, rasters.read_raster(place / f"{PREFIX}.{row['rank']}.base.asc").z, float(row["factor"]), row,
                 bodies.columns_file(table, int(row["rank"]))) for row in rows]


# --- given ---

def given(choices: Choices, corridor: Corridor, warn) -> List[Slip]:
    """The bodies of polygons with an attribute depth, thickness or volume; SlopeError if two share their ground."""
    slips: List[Slip] = []
    for name, geometry, crs, size in features(choices.bodies, warn):
        where = f"{choices.bodies}: {name}"
        local = polygons.of_feature(where, geometry, corridor.raster, crs, ADVICE)
        room = corridor.reach
        xlo, ylo, xhi, yhi = local.bounds
        window = corridor.window(xlo - room, ylo - room, xhi + room, yhi + room)
        ground = corridor.clip(window)
        body = release.body_of(release.Wanted("the terrain", where, choices.shape, read=(ground, local), **size))
        for one in body.warnings:
            warn(one._replace(part=name))
        slip = release_files.ground_without(ground, body.area, body.slip)
        try:
            with TemporaryDirectory() as folder:
                factor = bishop_factor(choices, ground, Path(folder, "base.asc"), slip)
        except SlopeError as error:
            raise SlopeError(where, f"must have a factor of safety: {error}") from error
        new = Slip(window, np.where(ground.z - slip > 0, slip, np.nan), factor, name=name)
        for other in slips:
            if shared(new, other) > SHARED:
                raise SlopeError(choices.bodies, f"must hold bodies that share at most {SHARED:g} of their cells",
                                 f"{other.name} and {name} share {shared(new, other):.2g}")
        slips.append(new)
    return slips


def features(path: Optional[str], warn):
    """Name, geometry, CRS and size of the polygons of a file; warn is called for those that have no geometry."""
    layer = vectors.read_vector_layer(path, "Polygon")
    several = len(layer.features) + layer.empty
    if layer.empty:
        first = min(set(range(1, several + 1)) - set(layer.numbers))
        warn(Finding("no geometry", {"feature": f"{path}: feature {first}", "without": layer.empty,
                                     "features": several}))
    crs = layer.known_crs(path, ADVICE.wrong_crs)
    for number, (_, geometry), about in zip(layer.numbers, layer.features, layer.attributes):
        where = f"{path}: feature {number}"
        depth, _ = depth_of(str(path), number, about)
        volume = attribute(about, "volume")
        if (depth is None) == (volume is None):
            raise SlopeError(where, "must have one attribute, depth or thickness (m), or volume (m3), > 0",
                             None if depth is None else f"{depth:g} m and {volume}")
        size = {"depth": depth} if volume is None else {"volume": size_of(where, "volume", volume, "m3")}
        yield f"feature {number}", geometry, crs, size


def bishop_factor(choices: Choices, raster, path: Path, without: np.ndarray) -> Optional[float]:
    """Of a body that was given, about the sphere that fits its base; None without strengths.

    without: the ground without it, for a file.
    """
    if choices.cohesion is None or choices.friction is None:
        return None
    rasters.write_asc_local(path, raster._replace(z=without), {}, exact=True)
    body = failed.of_base(raster, path, None, choices.density, None)
    strengths = bishop.Strengths(choices.cohesion, np.tan(np.radians(choices.friction)), choices.water or 0.0)
    return float(bishop.factor_of_safety(body.columns, strengths)[0])


# --- its ground, and whether it reaches the road ---

def settled(choices: Choices, corridor: Corridor, place: Path, slip: Slip, number: int) -> Dict[str, Any]:
    """Write the folder of a body; what bodies.yaml says of it."""
    window, line, start = cut_window(corridor, *extent_of(corridor.clip(slip.window).transform, slip.mask))
    raster, base = corridor.clip(window), np.full(corridor.clip(window).z.shape, np.nan)
    common = slip.window.common(window)
    base[common.inside(window)] = slip.base[common.inside(slip.window)]
    place.mkdir(parents=True, exist_ok=True)
    rasters.write_asc_local(place / TERRAIN, raster, {}, exact=True)
    whole = base if slip.row else np.where(np.isfinite(base), base, raster.z)    # of a given one, the ground without it
    rasters.write_asc_local(place / f"{PREFIX}.{number}.base.asc", raster._replace(z=whole), {"body": number},
                            exact=True)
    write_line(place / "road.csv", line, raster)
    if slip.row:
        table = place / f"{PREFIX}{bodies.END}"
        disk.write_file(table, disk.csv_text(slip.row, [{**slip.row, "rank": str(number)}.values()]))
        disk.write_file(bodies.name_body_file(table, number, bodies.COLUMNS), slip.columns.read_bytes())
    depth = np.nan_to_num(raster.z - base)
    x, y = middle(corridor, slip)
    return {"body": number, "name": slip.name or f"body {number}", "chainage_m": round(corridor.chainage(x, y), 2),
            "x": round(x, 2), "y": round(y, 2), **make_factor_entry(slip.factor),
            "volume_m3": float(depth.sum()) * corridor.cell ** 2,
            "area_m2": int(slip.mask.sum()) * corridor.cell ** 2, "depth_m": float(depth.max()),
            "road_from_m": round(start, 4),
            **reaches(choices, falling.of_arrays(raster, depth, f"body {number}"), corridor.road)}


def make_factor_entry(factor: Optional[float]) -> Dict[str, Any]:
    """The factor as tables have it, and why there is none; "" if there is one, or no strengths were given."""
    if factor is None or math.isfinite(factor):
        return {"factor": factor, "no_factor": ""}
    return {"factor": None, "no_factor": "unknown: no balance of moments was found" if math.isnan(factor) else
            "none: nothing drives it"}


def reaches(choices: Choices, mass: falling.Body, lane) -> Dict[str, Any]:
    """The share of known events that reach the road, and why a body is left out, "" if it is not."""
    try:
        found = known.compute_known_mobility(mass, known.choice(confined=choices.confined))
    except SlopeError as error:     # without a fall path nothing says that it does not reach the road
        return {"known_share": None, "known_law": str(error), "why_not": ""}
    met, events, _ = known.way_to_road(mass, found, lane)
    share, mobility = float(events.decides.exceedance(met.length)), found.decides
    why = ""
    if met.beside > mobility.width:
        why = f"its fall path stays {met.beside:.0f} m away from the road"
    elif share < choices.reach:
        why = (f"{cents(share)} of known events of its volume and height go as far as the road, {met.length:.0f} "
               f"m, {met.fall:.0f} m down (--reach {choices.reach:g})")
    return {"known_share": share, "known_law": mobility.law.name, "why_not": why}


def read_route_body(folder: Path, number: int, density: Optional[float]) -> bodies.Body:
    """A body as `slope fragility` takes it."""
    place = folder / SLIPS / str(number)
    if (place / f"{PREFIX}{bodies.END}").is_file():
        return bodies.read_slip_bodies(place, density)[0]
    if density is None:
        raise SlopeError("--density", "must be given (kg/m3), as the bodies of this route were polygons")
    path = place / f"{PREFIX}.{number}.base.asc"
    found = failed.of_base(rasters.read_asc_local(place / TERRAIN), path, None, density, None)
    return bodies.Body(str(number), found.direction, found.columns, path, found.cells)
