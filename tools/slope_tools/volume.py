"""slope volume: what must be removed from a road, per mesh cell and in total, above a cut that rises from its edges.

Order of the work: read the run, the road and its axis; cut (cut.py); sum per mesh cell; write tables and maps.
"""
import argparse
import csv
import json
import math
from pathlib import Path

import numpy as np
import rasterio.warp
from shapely.affinity import rotate
from shapely.geometry import LineString, MultiLineString

from . import cut, deposit, maps, polygons, rasters
from .cli import number
from .deposit import Mesh
from .errors import SlopeError
from .lines import lines_of, read_local
from .rasters import crs_name, epsg

CUT_ANGLE = 30.0       # degrees
BLOCKED = 0.1          # m
SAMPLES = 4            # parts of a cell along a side
MOST_SAMPLES = 32
MOST_MESH = 4_000_000  # mesh cells
EXACT = 1e-13          # of the deposit's volume: volumes are rounded to this once, so that they add up in every output
STATIONS = 500         # cross sections of a curved road
STRAIGHT = 0.98        # share of the centre line of a straight road that lies in the road
LABELS = 150           # mesh cells on a map that get their volume written into them
WGS84 = "EPSG:4326"

EPILOG = """\
units: metres, m3, degrees. PREFIX is what fix deposit/grid was given as output.

example: meshes of 10 m, the road from a GIS, and the volume also as loosened ground (bulk factor 2.3):
  tools/slope volume embankment --road route4.geojson --cut-angle 30 --mesh 10 --bulk 2.3 -o removal

Writes volume.yaml, volume.csv, volume.geojson, volume_mesh.tif, volume.tif, axis.csv and volume.png.
"""


def add_parser(commands, **kwargs):
    """Add `volume` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "volume", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="Volume to remove from a road, per mesh cell and in total, above a cut surface that rises from "
                    "the road's edges.", **kwargs)
    parser.add_argument("prefix", metavar="PREFIX", help="output of fix deposit/grid: PREFIX.thickness.asc and so on")
    parser.add_argument("--road", metavar="POLYGON", required=True, type=Path,
                        help="the road: GeoJSON, shapefile, CSV or WKT")
    parser.add_argument("--cut-angle", metavar="DEG", type=number, default=CUT_ANGLE,
                        help=f"rise of the cut surface with distance from the road's edges, degrees (default "
                             f"{CUT_ANGLE:g})")
    parser.add_argument("--mesh", metavar="SIZE", type=number, required=True,
                        help="side of the mesh cells, m; their corners are at multiples of it in local x and y")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path,
                        help="folder for the results (default PREFIX.volume)")
    parser.add_argument("--terrain", metavar="TERRAIN.asc", type=Path,
                        help="the run's terrain, whose sidecar tells the CRS (default: terrain.asc beside PREFIX)")
    parser.add_argument("--local", action="store_true",
                        help="the road and the axis are in local metres, not in a CRS")
    parser.add_argument("--bulk", metavar="FACTOR", type=number,
                        help="tell the volumes for this bulk factor too (volume of ground / volume of the balls)")
    parser.add_argument("--axis", metavar="LINE", type=Path,
                        help="the road's axis: GeoJSON, shapefile, CSV or WKT (default: the road's middle)")
    parser.add_argument("--blocked", metavar="T", type=number, default=BLOCKED,
                        help=f"the road is blocked where the deposit on the axis is thicker, m (default {BLOCKED:g})")
    parser.add_argument("--samples", metavar="K", type=int, default=SAMPLES,
                        help=f"parts of a cell along a side for round corners and rough ground, even (default "
                             f"{SAMPLES}); planes are exact with any")
    parser.add_argument("--no-picture", action="store_true", help="without volume.png, which takes longest")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the totals."""
    check(args)
    warnings = []
    warn = deposit.warner("volume", warnings)
    run_ = deposit.read(args.prefix, args.terrain, warn)
    folder = args.output or Path(f"{args.prefix}.volume")
    deposit.check_folder(folder)
    mesh = make_mesh(args.mesh, run_.raster)
    road = in_grid(polygons.read_local(args.road, run_.raster, args.local), run_.raster, args.road, warn)
    if args.axis:
        axis, source = read_axis(args.axis, run_.raster, args.local), str(args.axis)
    else:
        axis, source = middle(road)
    try:
        result = evaluate(run_, road, args.cut_angle, mesh, args.samples)
    except cut.NoGround as error:
        x, y = run_.raster.transform * error.args[0]
        raise SlopeError(args.road, "ground at the edge of the road must have a height, it has none at",
                         f"{x:.3f} {y:.3f} (local metres)") from None
    profile = along(axis, run_, result.removed, args.blocked, args.axis or args.road)
    about = totals(args, run_, road, mesh, result, profile, source)
    if result.unknown > 0:
        warn(f"{result.unknown:.6g} m3 lie on cells without ground, beside the road: not counted as to be removed")
        about["volume"]["unknown"] = result.unknown
    about["warnings"] = warnings
    factor = args.bulk / run_.bulk if args.bulk else None
    with deposit.complete(folder) as new:
        write_csv(new / "volume.csv", run_, mesh, result, factor)
        write_geojson(new / "volume.geojson", run_, mesh, result, factor)
        rasters.write_geotiff(new / "volume.tif", {"thickness to remove (m)": np.where(
            np.isfinite(run_.base) | (run_.raster.z > 0), result.removed, np.nan)}, run_.raster)
        rasters.write_geotiff(new / "volume_mesh.tif", {"volume to remove (m3)": result.volume},
                              run_.raster._replace(transform=mesh.transform))
        write_profile(new / "axis.csv", run_, profile)
        if not args.no_picture:
            draw(new / "volume.png", run_, road, axis, mesh, result, about)
        about["files"] = sorted(path.name for path in new.iterdir()) + ["volume.yaml"]
        deposit.write_yaml(new / "volume.yaml", about, "slope volume: what must be removed; m, m2, m3, degrees")
    print(summary(about, folder))


def check(args):
    """Check what can be checked before any reading."""
    if not 0 < args.cut_angle < 90:
        raise SlopeError("--cut-angle", "must be > 0 and < 90 degrees", f"{args.cut_angle:g}")
    if args.mesh <= 0:
        raise SlopeError("--mesh", "must be > 0", f"{args.mesh:g}")
    if args.bulk is not None and args.bulk <= 0:
        raise SlopeError("--bulk", "must be > 0", f"{args.bulk:g}")
    if args.blocked < 0:
        raise SlopeError("--blocked", "must be >= 0", f"{args.blocked:g}")
    if not (2 <= args.samples <= MOST_SAMPLES and args.samples % 2 == 0):
        raise SlopeError("--samples", f"must be even, 2 to {MOST_SAMPLES}", args.samples)


def make_mesh(size, raster):
    """The Mesh of that size over the raster; SlopeError if it would have too many cells."""
    xlo, ylo, xhi, yhi = deposit.extent(raster)
    count = ((xhi - xlo) / size + 1) * ((yhi - ylo) / size + 1)
    if count > MOST_MESH:
        raise SlopeError("--mesh", f"must give at most {MOST_MESH} mesh cells, the grid would need {count:.3g}",
                         f"{size:g}")
    return Mesh(size, raster)


def in_grid(polygon, raster, path, warn):
    """The part of a polygon (local metres) that lies in the grid; SlopeError if none does."""
    grid = deposit.box_of(raster)
    inside = polygon if grid.covers(polygon) else deposit.as_multi(polygon.intersection(grid))
    if inside.area <= 0:
        raise SlopeError(path, f"must lie in the grid of the run, {deposit.box(deposit.extent(raster))} (local metres)",
                         deposit.box(polygon.bounds))
    outside = 1 - inside.area / polygon.area
    if outside > 1e-9:
        warn(f"{path}: {100 * outside:.3g} % of the polygon lies outside of the grid of the run: cut off")
    return inside


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
            deposit.coverage(deposit.to_index(road, run_.raster), mesh.x, mesh.y)[0], 0) * area)
        self.steep, self.unknown = self.rounded(removed.steep * area), self.rounded(removed.unknown * area)
        self.listed = np.argwhere((self.deposit > 0) | (self.road_area > 0))

    def rounded(self, values):
        return np.round(values, self.digits)

    def total(self, values):
        return round(math.fsum(values.ravel()), self.digits)


def evaluate(run_, road, angle, mesh, samples=SAMPLES):
    """The Result for a Deposit, a road (polygon in local metres, in the grid) and a cut at an angle (degrees)."""
    tangent = math.tan(math.radians(angle)) * run_.cell
    removed = cut.removed(run_.raster.z, cut.Ground(run_.base), deposit.to_index(road, run_.raster), tangent, mesh,
                          samples)
    return Result(run_, road, mesh, removed)


# --- the road's axis ---

def middle(road):
    """The road's middle, and how it was found: the centre line of its smallest rectangle, where that lies in the road,

    else the middles of the road's cross sections, square to the long side of that rectangle.
    """
    corners = np.array(road.minimum_rotated_rectangle.exterior.coords)[:4]
    sides = np.hypot(*(corners - np.roll(corners, -1, axis=0)).T)
    if sides[0] > sides[1]:
        corners = np.roll(corners, -1, axis=0)  # the first side is a short one
    ends = (corners[:2].mean(axis=0), corners[2:].mean(axis=0))
    inside = lines_of(LineString(ends).intersection(road))
    if inside.length >= STRAIGHT * max(sides):
        return eastward(inside), "centre line of the road's smallest rectangle"
    angle = math.degrees(math.atan2(*(ends[1] - ends[0])[::-1]))
    level = rotate(road, -angle, origin=(0, 0))
    west, south, east, north = level.bounds
    tiny = 1e-9 * (east - west)
    points = []
    for x in np.linspace(west + tiny, east - tiny, STATIONS):
        chords = lines_of(LineString([(x, south - 1), (x, north + 1)]).intersection(level)).geoms
        if chords:
            points.append(max(chords, key=lambda chord: chord.length).interpolate(0.5, normalized=True).coords[0])
    return eastward(rotate(lines_of(LineString(points)), angle, origin=(0, 0))), "middles of the road's cross sections"


def eastward(lines):
    """The lines, each and all of them from west to east (from south to north if they run more that way)."""
    west, south, east, north = lines.bounds
    way = np.array([1.0, 0.0]) if east - west >= north - south else np.array([0.0, 1.0])
    turned = [np.asarray(line.coords)[:, :2] for line in lines.geoms]
    turned = [line if way @ (line[-1] - line[0]) >= 0 else line[::-1] for line in turned]
    return MultiLineString(sorted(turned, key=lambda line: tuple(way @ line.T)[0]))


def along(axis, run_, removed, blocked, path):
    """Profile along the axis, a dict of arrays: one entry per cell that it crosses. Lengths are exact."""
    shape = run_.raster.z.shape
    inside = lines_of(axis.intersection(deposit.box_of(run_.raster)))
    if inside.is_empty:
        raise SlopeError(path, "axis of the road must lie in the grid of the run", deposit.box(axis.bounds))
    parts = [np.asarray(line.coords)[:, :2] for line in deposit.to_index(eastward(inside), run_.raster).geoms]
    start, end = np.concatenate([part[:-1] for part in parts]), np.concatenate([part[1:] for part in parts])
    _, a, b = deposit.pieces(np.arange(shape[1] + 1.0), np.arange(shape[0] + 1.0), start, end)
    length = np.hypot(*(b - a).T)
    a, b, length = a[length > 0], b[length > 0], length[length > 0]
    centre = (a + b) / 2
    # an axis on the line between two cells: the thicker one counts
    beside = 1e-6 * ((b - a) / length[:, None])[:, ::-1] * [1, -1]
    sides = [np.clip((centre + way * beside).astype(int), 0, np.array(shape[::-1]) - 1) for way in (1, -1)]
    thickness = [run_.raster.z[side[:, 1], side[:, 0]] for side in sides]
    column, row = np.where((thickness[0] >= thickness[1])[:, None], *sides).T
    length = length * run_.cell
    to = np.cumsum(length)
    x, y = run_.raster.transform * tuple(centre.T)
    thickness = run_.raster.z[row, column]
    return {"from": to - length, "to": to, "x": x, "y": y, "ground": run_.base[row, column], "thickness": thickness,
            "removed": removed[row, column], "blocked": (thickness > blocked).astype(int)}


def stretches(profile):
    """Blocked stretches of a profile: list of (from, to)."""
    step = np.diff(np.concatenate([[0], profile["blocked"], [0]]))
    return [(profile["from"][a], profile["to"][b - 1])
            for a, b in zip(np.flatnonzero(step == 1), np.flatnonzero(step == -1))]


def read_axis(path, raster, local):
    """The line in a file, in local metres, from west to east; see lines.read_local."""
    return eastward(read_local(path, raster, local, "axis"))


# --- output ---

def totals(args, run_, road, mesh, result, profile, source):
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
    blocked = stretches(profile)
    about = {
        "prefix": run_.prefix, "road": args.road, "cut_angle": args.cut_angle,
        "terrain": run_.terrain, "crs": None if place.crs is None else crs_name(place.crs),
        "origin": {"east": place.offset[0], "north": place.offset[1]},
        "run": {"slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"],
                "moving": run_.summary["moving"]},
        "grid": {"cell": run_.cell, "samples": args.samples},
        "mesh": {"size": mesh.size, "cells": len(result.listed), "cells_to_clear": int((result.volume > 0).sum())},
        "bulk_factor": run_.bulk,
        "volume": volume,
    }
    if args.bulk:
        about["other_bulk_factor"] = args.bulk
        about["volume_at_other_bulk_factor"] = {key: round(value * args.bulk / run_.bulk, result.digits)
                                                for key, value in volume.items()}
    about["road_area"] = result.total(result.road_area)
    about["largest_removed_thickness"] = round(float(result.removed.max()), 6)
    about["axis"] = {
        "source": source,
        "length": round(profile["to"][-1], 6),
        "blocked_above": args.blocked,
        "blocked_length": round(math.fsum(to - start for start, to in blocked), 6),
        "blocked_stretches": [[round(start, 6), round(to, 6)] for start, to in blocked],
        "largest_thickness": round(profile["thickness"][thickest], 6),
        "largest_thickness_at": [round(profile[key][thickest], 3) for key in ("x", "y")],
    }
    return about


def rows(run_, mesh, result, factor):
    """One dict per listed mesh cell, from the north-west on."""
    east, north = run_.raster.offset
    for row, column in result.listed:
        x, y = (round(corner, 9) for corner in mesh.corner(row, column))  # 71 * 0.8 is 56.800000000000004
        values = {"row": row + 1, "column": column + 1, "xlo": x, "ylo": y, "east": x + east, "north": y + north,
                  "road_area": result.road_area[row, column], "deposit": result.deposit[row, column],
                  "remove_on_road": result.road[row, column], "remove_beside_road": result.beside[row, column],
                  "remove": result.volume[row, column]}
        if factor:
            values["remove_at_other_bulk_factor"] = round(values["remove"] * factor, result.digits)
        yield {key: value.item() if isinstance(value, np.generic) else value for key, value in values.items()}


def text(value, digits=9):
    """A number in a CSV file; as many digits as it takes for a rounded one."""
    return value if isinstance(value, int) else np.format_float_positional(round(value, digits), trim="-")


def write_csv(path, run_, mesh, result, factor):
    with open(path, "w", encoding="ascii", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        for number_, values in enumerate(rows(run_, mesh, result, factor)):  # at least one: the road's
            if number_ == 0:
                writer.writerow(values)
            writer.writerow(text(value, max(6, result.digits)) for value in values.values())


def write_geojson(path, run_, mesh, result, factor):
    """Squares of the mesh. With an EPSG number: in that CRS, which the file names as GDAL and QGIS read and write it;

    in another CRS: in degrees of WGS 84, which is what GeoJSON means where it names none.
    """
    crs = run_.raster.crs
    known = crs is not None and epsg(crs)
    features = []
    for values in rows(run_, mesh, result, factor):
        x, y = values["east"], values["north"]
        ring = [(x, y), (x + mesh.size, y), (x + mesh.size, y + mesh.size), (x, y + mesh.size), (x, y)]
        if crs is not None and not known:
            ring = list(zip(*rasterio.warp.transform(crs, WGS84, *zip(*ring))))
        features.append({"type": "Feature", "properties": values,
                         "geometry": {"type": "Polygon", "coordinates": [ring]}})
    collection = {"type": "FeatureCollection", "name": "volume"}
    if known:
        collection["crs"] = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{known}"}}
    with open(path, "w", encoding="ascii") as out:
        head = json.dumps(collection)[:-1]
        out.write(head + ', "features": [\n' + ",\n".join(map(json.dumps, features)) + "\n]}\n")


def write_profile(path, run_, profile):
    east, north = run_.raster.offset
    columns = {**profile, "east": profile["x"] + east, "north": profile["y"] + north}
    order = ("from", "to", "x", "y", "east", "north", "ground", "thickness", "removed", "blocked")
    with open(path, "w", encoding="ascii", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(order)
        for values in zip(*(columns[key].tolist() for key in order)):
            writer.writerow(map(text, values))


def draw(path, run_, road, axis, mesh, result, about):
    raster = run_.raster
    full = np.argwhere(result.deposit > 0)
    deposited = ()
    if len(full):
        (top, left), (bottom, right) = full.min(axis=0), full.max(axis=0)
        deposited = *mesh.corner(bottom, left), *np.add(mesh.corner(top, right), mesh.size)
    shown = maps.window(raster, road.bounds, deposited)
    volume = about["volume"]
    figure, axes = maps.relief(raster, run_.base, shown,
                               f"{about['prefix']}: {volume['remove']:,.0f} m3 to remove above a cut of "
                               f"{about['cut_angle']:g} degrees, {volume['remove_on_road']:,.0f} m3 of it on the road")
    maps.values_on(axes, raster, result.removed, shown, "thickness to remove (m)")
    thickness, where = maps.part(raster, raster.z, shown)
    if (thickness > 0).any() and min(thickness.shape) >= 2:
        axes.contour((thickness > 0).astype(float), [0.5], colors="black", linewidths=0.6, linestyles="dotted",
                     extent=where, origin="upper")
        axes.plot([], [], color="black", linewidth=0.8, linestyle="dotted", label="deposit")
    maps.outline(axes, road, color="tab:blue", linewidth=1.4, label="road")
    for number_, line in enumerate(axis.geoms):
        axes.plot(*np.asarray(line.coords).T, color="tab:blue", linewidth=0.8, linestyle="dashdot",
                  label=None if number_ else "axis")
    cleared = np.argwhere(result.volume > 0)
    if 0 < len(cleared) <= LABELS:
        digits = 0 if result.volume.max() >= 10 else 2
        for row, column in cleared:
            x, y = mesh.corner(row, column)
            axes.add_patch(maps.plt.Rectangle((x, y), mesh.size, mesh.size, fill=False, linewidth=0.4))
            axes.text(x + mesh.size / 2, y + mesh.size / 2, f"{result.volume[row, column]:.{digits}f}",
                      fontsize=5, ha="center", va="center", clip_on=True)
        axes.plot([], [], color="black", linewidth=0.4, label=f"mesh of {mesh.size:g} m, m3 to remove")
    axes.legend(loc="upper right", fontsize=8)
    maps.save(figure, path)


def summary(about, folder):
    """What the user needs to know."""
    volume, axis = about["volume"], about["axis"]
    lines = [f"to remove: {volume['remove']:.1f} m3 of {volume['deposit']:.1f} m3: {volume['remove_on_road']:.1f} m3 "
             f"on the road, {volume['remove_beside_road']:.1f} m3 beside it above a cut of "
             f"{about['cut_angle']:g} degrees",
             f"bulk factor {about['bulk_factor']:.6g}, the run's"]
    if "other_bulk_factor" in about:
        lines[-1] += (f"; at {about['other_bulk_factor']:.6g}: {about['volume_at_other_bulk_factor']['remove']:.1f} m3 "
                      "to remove")
    lines.append(f"axis: blocked over {axis['blocked_length']:.1f} of {axis['length']:.1f} m, where thicker than "
                 f"{axis['blocked_above']:g} m; up to {axis['largest_thickness']:.2f} m")
    lines.append(f"mesh of {about['mesh']['size']:g} m: {about['mesh']['cells_to_clear']} cells to clear")
    lines.append(f"written to {folder}: {' '.join(about['files'])}")
    return "\n".join(lines)
