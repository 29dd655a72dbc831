"""The files of a volume: tables, GeoJSON, a map."""
import json
from typing import Any, Dict, Tuple

import numpy as np
import rasterio.warp

from .. import disk
from ..geometry import as_multi
from ..survey import geopackage
from ..survey.geopackage import Layer
from ..survey.rasters import epsg

LABELS = 150           # mesh cells on a map that get their volume written into them
WGS84 = "EPSG:4326"
COLUMNS = ("from", "to", "largest_thickness_on_axis", "passable_width", "remove", "lane_offset", "remove_lane",
           "remove_lane_where_cut_below_ground", "hours", "hours_lane")


class Cells:
    """The mesh cells that are listed, from the north-west on, as columns of values; lanes: what lanes take, or None."""

    def __init__(self, run_, mesh, result, factor, lanes):
        row, column = result.listed.T
        x, y = np.round(mesh.corner(row, column), 9)        # 71 * 0.8 is 56.800000000000004
        east, north = run_.raster.offset
        self.digits = max(6, result.digits)
        self.columns = {"row": row + 1, "column": column + 1, "xlo": x, "ylo": y, "east": x + east, "north": y + north}
        self.columns.update({name: of_cells[row, column] for name, of_cells in (
            ("road_area", result.road_area), ("deposit", result.deposit), ("remove_on_road", result.road),
            ("remove_beside_road", result.beside), ("remove", result.volume))})
        if factor:
            self.columns["remove_at_other_bulk_factor"] = np.round(self.columns["remove"] * factor, result.digits)
        if lanes is not None:
            self.columns["remove_lane"] = lanes[row, column]

    def rows(self):
        """The values of one cell after the other."""
        return zip(*(values.tolist() for values in self.columns.values()))


def format_csv_number(value, digits=9):
    """A number in a CSV file; as many digits as it takes for a rounded one."""
    if isinstance(value, int):
        return value
    value = round(value, digits)
    short = repr(value)
    if "e" in short or "n" in short:
        return np.format_float_positional(value, trim="-")
    return short.removesuffix(".0")


def write_cells_csv(path, cells):
    disk.write_file(path, disk.csv_text(cells.columns, ([format_csv_number(value, cells.digits) for value in values]
                                                        for values in cells.rows())))      # at least one: the road's


def write_geojson(path, run_, mesh, cells):
    """Squares of the mesh. With an EPSG number: in that CRS, which the file names as GDAL and QGIS read and write it;

    in another CRS: in degrees of WGS 84, which is what GeoJSON means where it names none.
    """
    crs = run_.raster.crs
    known = crs is not None and epsg(crs)
    features = []
    for values in (dict(zip(cells.columns, row)) for row in cells.rows()):
        x, y = values["east"], values["north"]
        ring = [(x, y), (x + mesh.size, y), (x + mesh.size, y + mesh.size), (x, y + mesh.size), (x, y)]
        if crs is not None and not known:
            ring = list(zip(*rasterio.warp.transform(crs, WGS84, *zip(*ring))))
        features.append({"type": "Feature", "properties": values,
                         "geometry": {"type": "Polygon", "coordinates": [ring]}})
    collection: Dict[str, Any] = {"type": "FeatureCollection", "name": "volume"}
    if known:
        collection["crs"] = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{known}"}}
    with open(path, "w", encoding="ascii") as out:
        head = json.dumps(collection)[:-1]
        out.write(head + ', "features": [\n' + ",\n".join(map(json.dumps, features)) + "\n]}\n")


def write_profile(path, run_, profile):
    east, north = run_.raster.offset
    columns = {**profile, "east": profile["x"] + east, "north": profile["y"] + north}
    order = ("from", "to", "x", "y", "east", "north", "ground", "thickness", "removed", "blocked")
    disk.write_file(path, disk.csv_text(order, (map(format_csv_number, values)
                                                for values in zip(*(columns[key].tolist() for key in order)))))


def draw_removal(path, run_, road, parts, mesh, result, summary, cleared):
    from matplotlib.patches import Rectangle

    from ..drawing import maps, pictures
    raster = run_.raster
    full = np.argwhere(result.deposit > 0)
    deposited: Tuple = ()
    if len(full):
        (top, left), (bottom, right) = full.min(axis=0), full.max(axis=0)
        deposited = *mesh.corner(bottom, left), *np.add(mesh.corner(top, right), mesh.size)
    shown = maps.window(raster, road.bounds, deposited)
    volume = summary["volume"]
    with pictures.settings():
        figure, axes = maps.relief(raster, run_.base, shown,
                                   f"{summary['prefix']}: {volume['remove']:,.0f} m3 to remove above a cut of "
                                   f"{summary['cut_angle']:g} degrees, {volume['remove_on_road']:,.0f} m3 of it on the "
                                   "road")
        maps.values_on(axes, raster, result.removed, shown, "thickness to remove (m)")
        thickness, where = maps.part(raster, raster.z, shown)
        if (thickness > 0).any() and min(thickness.shape) >= 2:
            axes.contour((thickness > 0).astype(float), [0.5], colors="black", linewidths=0.6, linestyles="dotted",
                         extent=where, origin="upper")
            axes.plot([], [], color="black", linewidth=0.8, linestyle="dotted", label="deposit")
        maps.outline(axes, road, color="tab:blue", linewidth=1.4, label="road")
        for number_, axis in enumerate(parts):
            axes.plot(*axis.points.T, color="tab:blue", linewidth=0.8, linestyle="dashdot",
                      label=None if number_ else "axis")
        for number_, one in enumerate(cleared.stretches):
            axes.plot(*np.asarray(one.axis.line(one.along).coords).T, color="tab:red", linewidth=2.4, alpha=0.8,
                      label=None if number_ else "blocked stretch")
        for number_, lane in enumerate(cleared.lanes):
            clearing = summary["clearing"]
            maps.outline(axes, lane, color="tab:green", linewidth=1.2, label=None if number_ else
                         f"lane of {clearing['lane']:g} m, {clearing['remove_lane']:,.0f} m3 to remove")
        listed = np.argwhere(result.volume > 0)
        if 0 < len(listed) <= LABELS:
            digits = 0 if result.volume.max() >= 10 else 2
            for row, column in listed:
                x, y = mesh.corner(row, column)
                axes.add_patch(Rectangle((x, y), mesh.size, mesh.size, fill=False, linewidth=0.4))
                axes.text(x + mesh.size / 2, y + mesh.size / 2, f"{result.volume[row, column]:.{digits}f}",
                          fontsize=5, ha="center", va="center", clip_on=True)
            axes.plot([], [], color="black", linewidth=0.4, label=f"mesh of {mesh.size:g} m, m3 to remove")
        axes.legend(loc="upper right", fontsize=8)
        maps.save(figure, path)


# --- the blocked stretches of the road ---

def list_stretch_columns(run_, cleared):
    """A dict for each stretch: its number, its numbers, and its ends on the axis in the CRS."""
    for number, (stretch, entry) in enumerate(zip(cleared.stretches, cleared.entries), 1):
        ends = np.asarray(stretch.axis.line(stretch.along).coords)[[0, -1], :2] + run_.raster.offset
        yield {"stretch": number, **{key: float(entry[key]) for key in COLUMNS if key in entry},
               **dict(zip(("east_from", "north_from", "east_to", "north_to"), map(float, ends.ravel())))}


def write_stretches_csv(path, run_, cleared):
    """A line for each stretch; a head alone where the road is not blocked."""
    found = list(list_stretch_columns(run_, cleared))
    head = found[0] if found else ["stretch", *COLUMNS]
    disk.write_file(path, disk.csv_text(head, ([format_csv_number(value) for value in one.values()] for one in found)))


def write_stretches_geopackage(path, run_, cleared):
    """Layers in the CRS of the terrain: stretches, parts of the axis, and lanes, areas."""
    found = list(list_stretch_columns(run_, cleared))
    properties = {key: "int" if key == "stretch" else "float" for key in (found[0] if found else ("stretch", *COLUMNS))}
    layers = {"stretches": Layer("LineString", properties,
                                 zip((one.axis.line(one.along) for one in cleared.stretches), found))}
    if cleared.mesh is not None:
        layers["lanes"] = Layer("MultiPolygon", properties, zip(map(as_multi, cleared.lanes), found))
    geopackage.write_geopackage(path, layers, run_.raster)
