"""What must be removed from a road, per mesh cell, above a cut surface.

Order of the work: read the run, the road and its axis; cut (cut.py); sum per mesh cell; write tables and maps.
"""
import math
from pathlib import Path
from typing import Any, Callable, Dict, List, NamedTuple, Optional

import numpy as np

from .. import disk, geometry
from ..errors import SlopeError
from ..findings import Finding, encode_findings, keeper
from ..geometry import Mesh
from ..sites.site_warnings import of_angles
from ..survey import rasters, roads
from ..survey.lines import read_local
from ..survey.rasters import crs_name
from . import clearing, cut, deposit, passed, volume_files
from .axis import Axis
from .road_axis import (axes_of, axes_of_lines, by_chainage, find_profile_stretches, part_in_grid, profile_road,
                        width_of)

BULK = 1.0, 10.0       # volume of a body over that of its balls, as fix deposit/grid takes it
CUT_ANGLE = 30.0       # degrees
MOST_SAMPLES = 32
SAMPLES = 4            # parts of a cell along a side
MUCH_BELOW = 0.1       # of the volume to remove: so much where the cut is below the ground is worth a warning
EXACT = 1e-13          # of the deposit's volume: volumes are rounded to this once, so that they add up in every output
FILES = ("volume.csv", "volume.geojson", "volume.tif", "volume_mesh.tif", "axis.csv", "stretches.csv", "stretches.gpkg",
         "volume.png", "volume.yaml")


class Wanted(NamedTuple):
    """What is asked of a deposit: from which road how much must be removed."""
    road: Path                          # polygon, or line with a width: GeoJSON, shapefile, CSV or WKT
    mesh: float                         # m, side of the mesh cells
    cut_angle: float = CUT_ANGLE        # degrees, rise of the cut surface from the road's edges
    local: bool = False                 # road and axis are in local metres
    axis: Optional[Path] = None         # of the road; None: its middle
    bulk: Optional[float] = None        # another bulk factor, for which the volumes are given too
    asked: roads.Asked = roads.NOTHING  # width of a line, lane, hours
    samples: int = SAMPLES              # parts of a cell along a side


class Removal(NamedTuple):
    """What must be removed from a road, and all that write_removal() needs."""
    run: deposit.Deposit
    road: Any                           # polygon in local metres, the part of it in the grid
    axes: List[Axis]                    # in the grid
    mesh: Mesh
    result: "Result"
    profile: Dict[str, np.ndarray]      # along the axis
    clearing: clearing.Clearing         # stretches, lanes, hours
    factor: Optional[float]             # by which the volumes change at the other bulk factor
    about: Dict[str, Any]               # content of volume.yaml
    warnings: List[Finding]


def compute_removal(prefix, wanted: Wanted, terrain=None, tell: Callable[[Any], None] = lambda text: None) -> Removal:
    """The volume to remove of the run whose fix deposit/grid wrote PREFIX: of PREFIX.thickness.asc above the ground of
    PREFIX.base.asc; tell: what gets the warnings.

    terrain: the run's, whose sidecar has the CRS (default: terrain.asc beside PREFIX). Raises SlopeError on bad input.
    """
    check_wanted_volume(wanted)
    warn, warnings = keeper(tell)
    for one in of_angles({"--cut-angle": wanted.cut_angle}):
        warn(one)
    run = deposit.read_deposit(prefix, terrain, warn)
    mesh = geometry.make_mesh(wanted.mesh, run.raster)
    asked = wanted.asked
    given = roads.read_local(wanted.road, run.raster, asked, wanted.local, warn=warn)
    road = in_grid(given.polygon, run.raster, wanted.road, warn)
    if not np.isfinite(run.base).all():
        require_ground(road, run, wanted.road, warn)
    if wanted.axis:
        axes, source = axes_of_lines(read_local(wanted.axis, run.raster, wanted.local, "axis"), asked, run.raster,
                                     wanted.axis), str(wanted.axis)
    else:
        axes, source = axes_of(given.lines, given.polygon, asked, run.raster, warn)
    width = asked.width or width_of(axes, road)
    roads.check_lane(asked.lane, width)
    result = evaluate_removal(run, road, wanted.cut_angle, mesh, wanted.samples)
    profile = profile_road(axes, run, result.removed, asked, road if wanted.axis else None)
    cleared = clearing.evaluate_clearing(run, result, profile, axes, width, road, given.line is not None, asked,
                                         mesh, wanted.cut_angle, wanted.samples)
    summary = totals(wanted, run, mesh, result, profile, source)
    summary.update(clearing=cleared.totals, stretches=cleared.entries, by_10_m=by_chainage(run, road, axes),
                   **passed.evaluate_passed(run, road, given.line, wanted.cut_angle))
    if result.unknown > 0:
        warn(Finding("no ground", {"volume": float(result.unknown)}))
        summary["volume"]["unknown"] = result.unknown
    summary["warnings"] = encode_findings(warnings)
    return Removal(run, road, axes, mesh, result, profile, cleared, wanted.bulk / run.bulk if wanted.bulk else None,
                   disk.make_plain(summary), warnings)


def write_removal(removal: Removal, folder: Path, picture: bool = True) -> None:
    """Tables, rasters, GeoJSON, map and volume.yaml, all of them or none; removal.about gets their names."""
    run, mesh, result, summary = removal.run, removal.mesh, removal.result, removal.about
    cells = volume_files.Cells(run, mesh, result, removal.factor, removal.clearing.mesh)
    with disk.complete(folder, "volume.yaml") as new:
        volume_files.write_cells_csv(new / "volume.csv", cells)
        volume_files.write_geojson(new / "volume.geojson", run, mesh, cells)
        rasters.write_geotiff(new / "volume.tif", {"thickness to remove (m)": np.where(
            np.isfinite(run.base) | (run.raster.z > 0), result.removed, np.nan)}, run.raster)
        rasters.write_geotiff(new / "volume_mesh.tif", {"volume to remove (m3)": result.volume},
                              run.raster._replace(transform=mesh.transform))
        volume_files.write_profile(new / "axis.csv", run, removal.profile)
        volume_files.write_stretches_csv(new / "stretches.csv", run, removal.clearing)
        volume_files.write_stretches_geopackage(new / "stretches.gpkg", run, removal.clearing)
        if picture:
            volume_files.draw_removal(new / "volume.png", run, removal.road, removal.axes, mesh, result, summary,
                                      removal.clearing)
        summary["files"] = sorted(path.name for path in new.iterdir()) + ["volume.yaml"]
        disk.write_yaml(new / "volume.yaml", summary, "slope volume: what must be removed; m, m2, m3, degrees")
    if not picture:
        (folder / "volume.png").unlink(missing_ok=True)     # of another result


def check_wanted_volume(wanted: Wanted) -> None:
    """Check what can be checked before any reading."""
    if not 0 < wanted.cut_angle < 90:
        raise SlopeError("--cut-angle", "must be > 0 and < 90 degrees", f"{wanted.cut_angle:g}")
    if wanted.mesh <= 0:
        raise SlopeError("--mesh", "must be > 0", f"{wanted.mesh:g}")
    if wanted.bulk is not None and not BULK[0] <= wanted.bulk <= BULK[1]:
        raise SlopeError("--bulk", "must be {:g} to {:g}, as of fix deposit/grid".format(*BULK), f"{wanted.bulk:g}")
    roads.check_road(wanted.asked)
    if wanted.axis is not None and wanted.asked.width is not None:
        raise SlopeError("--axis", "must not be given with --road-width: the axis of such a road is its line",
                         wanted.axis)
    if not (2 <= wanted.samples <= MOST_SAMPLES and wanted.samples % 2 == 0):
        raise SlopeError("--samples", f"must be even, 2 to {MOST_SAMPLES}", wanted.samples)


def in_grid(polygon, raster, path, warn):
    """The part of a polygon (local metres) that lies in the grid; SlopeError if none does."""
    inside = part_in_grid(polygon, raster)
    if inside.area <= 0:
        raise SlopeError(path, f"must lie in the grid of the run, {geometry.format_numbers(geometry.extent(raster))} "
                         "(local " "metres)", geometry.format_numbers(polygon.bounds))
    outside = 1 - inside.area / polygon.area
    if outside > 1e-9:
        warn(Finding("cut off", {"file": str(path), "percent": 100 * outside}))
    return inside


def require_ground(road, run_, path, warn):
    """Warn of a road, local metres, whose edge lies in part on cells without a height; SlopeError if all of it does."""
    share = cut.Ground(run_.base).share_unknown(geometry.to_index(road, run_.raster))
    if share == 1:
        raise SlopeError(path, "the road's edge must lie on ground that has a height, at least in part",
                         geometry.format_numbers(road.bounds))
    if share > 0:
        warn(Finding("edge without ground", {"file": str(path), "percent": 100 * share}))


# --- volumes ---

class Result:
    """Removed thickness per cell (m); volumes (m3) and areas (m2) per mesh cell, rounded."""

    def __init__(self, run_, road, mesh, removed):
        area = run_.cell ** 2
        self.digits = -math.floor(math.log10(EXACT * run_.volume)) if run_.volume > 0 else 6
        self.removed = np.minimum(removed.cells, run_.raster.z)
        self.deposit = self.rounded(mesh.sums(run_.raster.z) * area)
        self.road = np.minimum(self.rounded(removed.mesh_road * area), self.deposit)
        self.beside = np.minimum(self.rounded(removed.mesh_beside * area), self.rounded(self.deposit - self.road))
        self.volume = self.rounded(self.road + self.beside)
        self.road_area = self.rounded(np.maximum(
            geometry.coverage(geometry.to_index(road, run_.raster), mesh.x, mesh.y)[0], 0) * area)
        self.steep, self.unknown = self.rounded(removed.steep * area), self.rounded(removed.unknown * area)
        self.listed = np.argwhere((self.deposit > 0) | (self.road_area > 0))

    def rounded(self, values):
        return np.round(values, self.digits)

    def total(self, values):
        return round(math.fsum(values.ravel()), self.digits)


def evaluate_removal(run_, road, angle, mesh, samples=SAMPLES):
    """The Result for a Deposit, a road (polygon in local metres, in the grid) and a cut at an angle (degrees)."""
    tangent = math.tan(math.radians(angle)) * run_.cell
    removed = cut.removed(run_.raster.z, cut.Ground(run_.base), [geometry.to_index(road, run_.raster)], tangent, mesh,
                          samples)
    return Result(run_, road, mesh, removed)


def totals(wanted: Wanted, run_, mesh, result, profile, source) -> Dict[str, Any]:
    """The content of volume.yaml."""
    place = run_.raster
    volume = {
        "deposit": result.total(result.deposit),
        "remove": result.total(result.volume),
        "remove_on_road": result.total(result.road),
        "remove_beside_road": result.total(result.beside),
        "remove_where_cut_below_ground": result.steep,
    }
    volume["stays"] = round(volume["deposit"] - volume["remove"], result.digits)
    thickest = int(np.argmax(profile["thickness"]))
    blocked = find_profile_stretches(profile)
    numbers = {
        "prefix": run_.prefix, "road": wanted.road, "cut_angle": wanted.cut_angle,
        "terrain": run_.terrain, "crs": None if place.crs is None else crs_name(place.crs),
        "origin": {"east": place.offset[0], "north": place.offset[1]},
        "run": {"slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"],
                "moving": run_.summary["moving"]},
        "grid": {"cell": run_.cell, "samples": wanted.samples},
        "mesh": {"size": mesh.size, "cells": len(result.listed), "cells_to_clear": int((result.volume > 0).sum())},
        "bulk_factor": run_.bulk,
        "volume": volume,
    }
    if wanted.bulk:
        numbers["other_bulk_factor"] = wanted.bulk
        numbers["volume_at_other_bulk_factor"] = {key: round(value * wanted.bulk / run_.bulk, result.digits)
                                                  for key, value in volume.items()}
    numbers["road_area"] = result.total(result.road_area)
    numbers["largest_removed_thickness"] = round(float(result.removed.max()), 6)
    numbers["axis"] = {
        "source": source,
        "length": round(math.fsum(profile["to"] - profile["from"]), 6),
        "blocked_above": wanted.asked.blocked,
        "blocked_length": round(math.fsum(to - start for start, to in blocked), 6),
        "blocked_stretches": [[round(start, 6), round(to, 6)] for start, to in blocked],
        "largest_thickness": round(profile["thickness"][thickest], 6),
        "largest_thickness_at": [round(profile[key][thickest], 3) for key in ("x", "y")],
    }
    return numbers
