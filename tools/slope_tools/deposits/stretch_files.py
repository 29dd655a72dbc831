"""The blocked stretches of a road as files: a table, and lines and lanes for a GIS."""
import fiona
import numpy as np
from fiona.io import MemoryFile
from shapely.affinity import translate
from shapely.geometry import mapping

from .. import disk
from ..geometry import as_multi
from .volume_files import text

NO_DATE = "2000-01-01T00:00:00.000Z"    # in place of that of writing: the same numbers are the same bytes
COLUMNS = ("from", "to", "largest_thickness_on_axis", "passable_width", "remove", "lane_offset", "remove_lane",
           "remove_lane_where_cut_below_ground", "hours", "hours_lane")


def columns_of(run_, cleared):
    """A dict for each stretch: its number, its numbers, and its ends on the axis in the CRS."""
    for number, (stretch, entry) in enumerate(zip(cleared.stretches, cleared.entries), 1):
        ends = np.asarray(stretch.axis.line(stretch.along).coords)[[0, -1], :2] + run_.raster.offset
        yield {"stretch": number, **{key: float(entry[key]) for key in COLUMNS if key in entry},
               **dict(zip(("east_from", "north_from", "east_to", "north_to"), map(float, ends.ravel())))}


def write_csv(path, run_, cleared):
    """A line for each stretch; a head alone where the road is not blocked."""
    found = list(columns_of(run_, cleared))
    head = found[0] if found else ["stretch", *COLUMNS]
    disk.write(path, disk.csv_text(head, ([text(value) for value in one.values()] for one in found)))


def write_geopackage(path, run_, cleared):
    """Layers in the CRS of the terrain: stretches, parts of the axis, and lanes, areas."""
    found = list(columns_of(run_, cleared))
    layers = {"stretches": ("LineString", [one.axis.line(one.along) for one in cleared.stretches])}
    if cleared.mesh is not None:
        layers["lanes"] = "MultiPolygon", [as_multi(one) for one in cleared.lanes]
    crs = run_.raster.crs
    with fiona.Env(OGR_CURRENT_DATE=NO_DATE), MemoryFile(ext=".gpkg") as memory:    # on disk it would be half-written
        for name, (kind, shapes) in layers.items():
            names = found[0] if found else ("stretch", *COLUMNS)
            properties = {key: "int" if key == "stretch" else "float" for key in names}
            with fiona.open(memory.name, "w", "GPKG", {"geometry": kind, "properties": properties}, layer=name,
                            crs_wkt=crs.to_wkt() if crs is not None else None) as out:
                out.writerecords({"type": "Feature", "properties": values,
                                  "geometry": mapping(translate(one, *run_.raster.offset))}
                                 for values, one in zip(found, shapes))
        disk.write(path, bytes(memory.getbuffer()))
