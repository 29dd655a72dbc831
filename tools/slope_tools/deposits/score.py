"""Comparison of a run's deposit with a mapped one."""
import math
from typing import List, NamedTuple, Optional, Tuple

import numpy as np
from affine import Affine
from scipy import ndimage

from .. import disk, geometry
from ..errors import SlopeError
from ..geometry import extent
from ..quantiles import within
from ..survey import beside, polygons
from ..survey.crs import same_crs
from ..survey.rasters import HIGHEST, Raster, crs_name, is_raster
from .deposit import EIGHT, top
from .travel_shares import PARTS
from .volume_files import format_csv_number

THRESHOLD = 0.1   # m
MOST_CELLS = 1e6  # beside the grid
FULL = 1e-9       # a smaller share of a cell, or of the largest thickness, is rounding
CORNERS = (0, 0), (0, 1), (1, 0), (1, 1)    # of a cell, columns and rows


class Observed(NamedTuple):
    """The mapped deposit on the run's grid: share of each cell; thickness (m, mean of the cell) or None; beside: what
    lies outside of the grid, rows of local x, y and area (m2) or, of a raster, volume (m3) and thickness (m)."""
    share: np.ndarray
    thickness: Optional[np.ndarray]
    points: np.ndarray      # local x, y of the corners of its outline: its farthest point is one of them
    polygon: object         # shapely, local metres; None for a raster
    outside: float          # area outside of the run's grid, m2
    volume_outside: float   # m3
    beside: np.ndarray = np.zeros((0, 3))


# --- the mapped deposit ---

def read_observed(path, raster, threshold, local, warn=None):
    """The Observed of a file, on the grid of a run's thickness raster; warn: called with what was taken for granted."""
    if not is_raster(path):
        polygon = polygons.read_local(path, raster, local)
        return from_polygon(polygon, raster)
    mapped = beside.read_raster_beside(path, raster, False, local=beside.Local(local), warn=warn,
                                       remedy=" (--local if it is in the run's local metres)")
    return from_raster(path, mapped, raster, threshold)


def from_polygon(polygon, raster):
    grid = geometry.box_of(raster)
    inside = polygon if grid.covers(polygon) else geometry.as_multi(polygon.intersection(grid))
    share = geometry.shares_of_cells(inside, raster)
    share = np.clip(np.where(share > FULL, share, 0), 0, 1)
    points = np.concatenate([np.asarray(part.exterior.coords)[:, :2] for part in geometry.polygons_of(polygon)])
    return Observed(share, None, points, polygon, max(0, polygon.area - inside.area), 0.0,
                    spread_over_cells(geometry.as_multi(polygon.difference(grid)), raster.transform.a))


def spread_over_cells(polygon, cell):
    """x, y and area (m2) of what a polygon covers of cells beside the grid."""
    if polygon.is_empty:
        return np.zeros((0, 3))
    xlo, ylo, xhi, yhi = polygon.bounds
    side = max(cell, math.sqrt((xhi - xlo) * (yhi - ylo) / MOST_CELLS))
    transform = Affine(side, 0, xlo, 0, -side, yhi)
    cells = np.zeros((math.ceil((yhi - ylo) / side), math.ceil((xhi - xlo) / side)))
    share = geometry.shares_of_cells(polygon, Raster(cells, transform, None))
    row, column = np.nonzero(share > FULL)
    return np.column_stack([*(transform @ (column + 0.5, row + 0.5)), share[row, column] * side ** 2])


def from_raster(path, mapped, raster, threshold):
    """A mapped raster of thickness on the run's grid: what each of its cells holds goes to the cells it shares."""
    t = mapped.transform
    if t.b or t.d or t.a <= 0 or t.e >= 0:
        raise SlopeError(path, "must be a raster with rows from west to east and columns from north to south")
    if raster.crs is None and mapped.crs is not None:
        raise SlopeError("--terrain", "must have a CRS, so that both can be brought together (--local if the mapped "
                         "deposit is in the run's local metres)", "none")
    if not same_crs(mapped.crs, raster.crs):
        raise SlopeError(path, f"must be in the CRS of the run, {crs_name(raster.crs)} (gdalwarp -t_srs reprojects)",
                         crs_name(mapped.crs))
    thickness = np.nan_to_num(mapped.z, nan=0.0)
    wrong = np.argwhere((thickness < 0) | (thickness > HIGHEST))
    if len(wrong):
        row, column = wrong[0]
        raise SlopeError(f"{path}: row {row + 1} column {column + 1}", f"must be a thickness >= 0 and <= {HIGHEST:g} m",
                         f"{thickness[row, column]:g}")
    there = beside.in_local(mapped, raster)
    to_index = ~raster.transform @ there
    shape = raster.z.shape
    x = to_index.c + to_index.a * np.arange(thickness.shape[1] + 1)
    y = to_index.f + to_index.e * np.arange(thickness.shape[0] + 1)
    if x[0] >= shape[1] or x[-1] <= 0 or y[0] >= shape[0] or y[-1] <= 0:
        raise SlopeError(path, f"must overlap the grid of the run, {geometry.format_numbers(extent(raster))} (local "
                         "metres)", geometry.format_numbers(extent(Raster(thickness, there, None))))
    thick = thickness > threshold
    share = np.clip(average_cells(thick.astype(float), x, y, shape), 0, 1)
    share[share < FULL] = 0
    area = abs(there.a * there.e)
    cell = raster.transform.a ** 2
    mean = average_cells(thickness, x, y, shape)
    mean[mean < FULL * mean.max(initial=0)] = 0
    points = corners(there, thick)
    outside = thick.sum() * area - share.sum() * cell
    volume_outside = thickness.sum() * area - mean.sum() * cell
    row, column = np.nonzero(thickness)
    beside_ = np.column_stack([*(there @ (column + 0.5, row + 0.5)), thickness[row, column] * area,
                               thickness[row, column]])
    xlo, ylo, xhi, yhi = extent(raster)
    beside_ = beside_[(beside_[:, 0] < xlo) | (beside_[:, 0] > xhi) | (beside_[:, 1] < ylo) | (beside_[:, 1] > yhi)]
    outside, volume_outside = (value if value > 1e-9 * total * area else 0.0 for value, total in
                               ((outside, thick.sum()), (volume_outside, thickness.sum())))
    return Observed(share, mean, points, None, outside, volume_outside, beside_)


def average_cells(values, x, y, shape):
    """Values, even in the cells between lines x and y (index coordinates, ascending), as means of the unit cells."""
    for axis, lines, n in ((0, y, shape[0]), (1, x, shape[1])):
        values = np.moveaxis(values, axis, 0)
        # sum up to each line; between lines it grows evenly
        total = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values * np.diff(lines)[:, None], axis=0)])
        at = np.clip(np.arange(n + 1.0), lines[0], lines[-1])
        first = np.clip(np.searchsorted(lines, at, "right") - 1, 0, len(lines) - 2)
        part = ((at - lines[first]) / np.diff(lines)[first])[:, None]
        values = np.moveaxis(np.diff(total[first] * (1 - part) + total[first + 1] * part, axis=0), 0, axis)
    return np.maximum(values, 0)


def corners(transform, mask):
    """Local x, y of the corners of the cells of a mask that have a neighbour outside of it."""
    padded = np.pad(mask, 1)
    inner = padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:]
    row, column = np.nonzero(mask & ~inner)
    return np.concatenate([np.transpose(transform @ (column + i, row + j)) for i in (0, 1) for j in (0, 1)])


# --- scores ---

def overlap(simulated, observed, cell):
    """Areas (m2) and their ratios; a ratio without a denominator is None."""
    area = cell ** 2
    met = float(observed.share[simulated].sum()) * area
    total = float(observed.share.sum()) * area + observed.outside
    run_ = float(simulated.sum()) * area
    union = run_ + total - met

    def ratio(part, whole):
        return round(part / whole, 9) if whole > 0 else None

    return {"simulated": round(run_, 9), "observed": round(total, 9), "true_positive": round(met, 9),
            "false_positive": round(run_ - met, 9), "false_negative": round(total - met, 9),
            "jaccard": ratio(met, union), "hit_rate": ratio(met, total), "precision": ratio(met, run_)}


def compare_runout(run_, simulated, observed):
    """Distances in plan of the farthest points of both from the highest released point, and along the fall line (m)."""
    x, y, _, source = top(run_)
    points = corners(run_.raster.transform, simulated)
    runout = {"from": [round(x, 9), round(y, 9)], "from_source": source}
    if not len(points) or not len(observed.points):
        return {**runout, "simulated": None, "observed": None, "difference": None}
    centre = centroid(observed, run_.raster)
    way = np.subtract(centre, (x, y))
    length = math.hypot(*way)
    for name, distance in (
            ("", lambda at: np.hypot(*(at - (x, y)).T).max()),
            ("along_fall_line", lambda at: float(((at - (x, y)) @ (way / length)).max()) if length > 0 else None)):
        values = [distance(points), distance(observed.points)]
        if None in values:
            continue
        ours, theirs = (round(float(value), 9) for value in values)
        numbers = {"simulated": ours, "observed": theirs, "difference": round(ours - theirs, 9)}
        if name:
            # clockwise from north, as a compass has it
            runout[name] = {"azimuth": round(math.degrees(math.atan2(*way)) % 360, 9), **numbers}
        else:
            runout.update(numbers)
    runout["quantiles_of"] = "area" if observed.thickness is None else "volume"
    runout["quantiles"] = compare_quantiles(run_, simulated, observed, (x, y))
    return runout


def compare_quantiles(run_, simulated, observed, place):
    """Distances (m) of cell centres from a place that shares of both deposits stay within.

    Shares of the volume where both have a thickness; of the area where the mapped deposit is an outline. What left the
    run's grid went farther, and counts as if it lay as thick as the rest; None: a share lies there.
    """
    ours, theirs = (simulated, observed.share) if observed.thickness is None else (run_.raster.z, observed.thickness)
    rows, columns = np.indices(ours.shape)
    x, y = run_.raster.transform @ (columns + 0.5, rows + 0.5)
    distance = np.hypot(x - place[0], y - place[1])
    volume = run_.summary["volume"]
    lost = float(ours.sum()) * max(0.0, volume["released"] - volume["on_grid"]) / max(volume["on_grid"], FULL)
    mapped = (np.append(distance[theirs > 0], np.hypot(*(observed.beside[:, :2] - place).T)),
              np.append(theirs[theirs > 0], observed.beside[:, 2] / run_.cell ** 2))
    quantiles = []
    for share in PARTS:
        near, far = within(distance[ours > 0], ours[ours > 0], share, lost), within(*mapped, share)
        near, far, less = (round(value, 9) if math.isfinite(value) else None for value in (near, far, near - far))
        quantiles.append({"share": share, "simulated": near, "observed": far, "difference": less})
    return quantiles


class Connected(NamedTuple):
    """The largest connected part of a deposit; see `connected`."""
    parts: int                  # connected parts that the deposit has
    volume: float               # m3, bulk
    share: float                # of the volume on the grid, 0 to 1
    area: float                 # m2
    distance: float             # m, in plan, from the highest released ball to its farthest point
    farthest: tuple             # local x, y of that point, m
    reach_angle: Optional[float]    # degrees below the horizontal; None where no height is known
    mask: np.ndarray            # its cells, bool, rows from the north


def connected(deposit, threshold):
    """The largest 8-connected part of a Deposit that is thicker than threshold (m): a Connected.

    Largest is the one of the largest volume. None where the deposit is nowhere thicker than threshold.

    distance (m, in plan): from the highest released ball (see deposit.top) to the farthest corner of the part's cells.
    reach_angle (degrees): the angle below the horizontal at which the surface of that cell is seen from that ball;
    None where the cell has no ground, or the height of the top is not known.
    """
    thickness, cell = deposit.raster.z, deposit.cell
    labels, parts = ndimage.label(thickness > threshold, EIGHT)
    if parts == 0:
        return None
    volume = ndimage.sum_labels(thickness, labels, np.arange(1, parts + 1))
    mask = labels == 1 + int(np.argmax(volume))
    highest = top(deposit)
    rows, columns = np.nonzero(mask)
    x, y = np.moveaxis(np.array([deposit.raster.transform @ (columns + i, rows + j) for i, j in CORNERS]), 1, 0)
    distances = np.hypot(x - highest.x, y - highest.y)     # of each corner of each cell
    corner, far = np.unravel_index(distances.argmax(), distances.shape)
    distance = float(distances[corner, far])
    drop = highest.z - float((deposit.base + thickness)[rows[far], columns[far]])
    angle = math.degrees(math.atan2(drop, distance)) if math.isfinite(drop) else None
    total = float(volume.max()) * cell ** 2
    return Connected(int(parts), total, total / deposit.volume, len(rows) * cell ** 2, distance,
                     (float(x[corner, far]), float(y[corner, far])), angle, mask)


def connected_runout(run_, threshold, observed):
    """Of the largest connected part of the simulated deposit; its distance against the farthest mapped point (m)."""
    part = connected(run_, threshold)
    if part is None:
        return None
    numbers = {"parts": part.parts, "area": round(part.area, 9), "volume": round(part.volume, 9),
               "share_of_volume": round(part.share, 9), "distance": round(part.distance, 9),
               "reach_angle": None if part.reach_angle is None else round(part.reach_angle, 9)}
    if len(observed.points):
        x, y = top(run_)[:2]
        far = round(float(np.hypot(*(observed.points - (x, y)).T).max()), 9)
        numbers.update(observed=far, difference=round(numbers["distance"] - far, 9))
    return numbers


def balls(run_):
    """Distance (m) and reach angle (degrees) that shares of the balls' volume stay within; None of an older run."""
    quantiles = (run_.summary.get("travel") or {}).get("quantiles")
    return quantiles if isinstance(quantiles, list) else None


def centroid(observed, raster):
    if observed.polygon is not None:
        return observed.polygon.centroid.coords[0]
    rows, columns = observed.share.shape
    weight = observed.share.sum()
    return raster.transform @ ((observed.share.sum(axis=0) @ (np.arange(columns) + 0.5)) / weight,
                               (observed.share.sum(axis=1) @ (np.arange(rows) + 0.5)) / weight)


def mesh_table(run_, simulated, observed, mesh):
    """Arrays (mesh rows, mesh columns) by name: areas (m2) and, for a mapped raster, volumes (m3)."""
    area = run_.cell ** 2
    met = np.where(simulated, observed.share, 0)
    table = {"true_positive": met, "false_positive": simulated - met, "false_negative": observed.share - met,
             "simulated_volume": run_.raster.z}
    if observed.thickness is not None:
        table["observed_volume"] = observed.thickness
    table = {name: mesh.sums(values) * area for name, values in table.items()}
    if observed.thickness is not None:
        table["volume_error"] = table["simulated_volume"] - table["observed_volume"]
    return table


def compare_volumes(observed, table):
    """Volumes (m3) and their errors; per mesh cell: mean of the absolute errors over those with a deposit, and RMS."""
    ours = math.fsum(table["simulated_volume"].ravel())
    theirs = math.fsum(table["observed_volume"].ravel()) + observed.volume_outside
    error = table["volume_error"][(table["simulated_volume"] > 0) | (table["observed_volume"] > 0)]
    numbers = {"simulated": round(ours, 9), "observed": round(theirs, 9), "error": round(ours - theirs, 9),
               "relative_error": round((ours - theirs) / theirs, 9) if theirs > 0 else None,
               "mesh_cells": len(error)}
    if len(error):
        numbers["mean_absolute_error_of_mesh_cells"] = round(float(np.abs(error).mean()), 9)
        numbers["rms_error_of_mesh_cells"] = round(float(np.sqrt((error ** 2).mean())), 9)
        numbers["share_in_wrong_mesh_cells"] = round(float(np.abs(error).sum()) / (ours + theirs), 9)
    return numbers


# --- output ---

def write_score_csv(path, run_, mesh, table):
    """One row per mesh cell with a deposit, simulated or mapped."""
    east, north = run_.raster.offset
    listed = np.argwhere(np.any([np.abs(values) > 0 for values in table.values()], axis=0))

    def line(row, column):
        x, y = mesh.corner(row, column)
        return [row + 1, column + 1, *map(format_csv_number, map(float, (x, y, x + east, y + north))),
                *(format_csv_number(float(values[row, column])) for values in table.values())]

    disk.write_file(path, disk.csv_text(["row", "column", "xlo", "ylo", "east", "north", *table],
                                        (line(row, column) for row, column in listed.tolist())))


def draw_score(path, run_, simulated, observed, summary):
    from ..drawing import maps, pictures        # matplotlib, which a study that draws nothing does not need

    raster = run_.raster
    kind = np.where(simulated, np.where(observed.share >= 0.5, 1, 2), np.where(observed.share >= 0.5, 3, 0))
    bounds: List[Tuple] = [geometry.extent_of(raster.transform, kind > 0)] if kind.any() else []
    if observed.polygon is not None:
        bounds.append(geometry.as_multi(observed.polygon.intersection(geometry.box_of(raster))).bounds)
    bounds.append((*summary["runout"]["from"], *summary["runout"]["from"]))
    shown = maps.window(raster, *bounds)
    area = summary["area"]
    jaccard = "none" if area["jaccard"] is None else f"{area['jaccard']:.3f}"
    with pictures.settings():
        figure, axes = maps.relief(raster, run_.base, shown, f"{summary['prefix']}: Jaccard {jaccard}, thicker than "
                                                             f"{summary['threshold']:g} m")
        classes = {1: ("tab:green", "both"), 2: ("tab:orange", "simulated only"), 3: ("tab:blue", "mapped only")}
        values, where = maps.part(raster, kind, shown)
        colours = maps.ListedColormap([colour for colour, _ in classes.values()])
        axes.imshow(np.ma.masked_equal(values, 0), cmap=colours, vmin=0.5, vmax=3.5, alpha=0.65, extent=where,
                    interpolation="nearest")
        for colour, name in classes.values():
            axes.plot([], [], "s", color=colour, alpha=0.65, label=name)
        if observed.polygon is not None:
            maps.outline(axes, observed.polygon, color="black", linewidth=1.0, label="mapped outline")
        axes.plot(*summary["runout"]["from"], "k^", markersize=6,
                  label=summary["runout"]["from_source"].split(": ")[-1])
        axes.legend(loc="upper right", fontsize=8)
        maps.save(figure, path)
