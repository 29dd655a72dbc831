"""The blocked stretches of a road as files: a table, and lines and lanes for a GIS."""
import numpy as np

from .. import disk
from ..geometry import as_multi
from ..survey import geopackage
from ..survey.geopackage import Layer
from .volume_files import format_csv_number

COLUMNS = ("from", "to", "largest_thickness_on_axis", "passable_width", "remove", "lane_offset", "remove_lane",
           "remove_lane_where_cut_below_ground", "hours", "hours_lane")


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
