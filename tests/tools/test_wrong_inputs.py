"""What a user of a GIS gets wrong: forty kinds, two of each; one line that helps, or the right result, never silence.

They are a page, too, which a test compares; `python3 tests/tools/test_wrong_inputs.py > doc/src/wrong_inputs.rst`
makes it.
"""
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Callable, NamedTuple

import fiona
import numpy as np
import pytest
import rasterio
import rasterio.warp
from affine import Affine
from rasterio.crs import CRS
from shapely.geometry import LineString, MultiLineString, Point, Polygon, box, mapping
from shapely.affinity import translate

from run_helpers import CRS_M, EAST, NORTH, TOP, called, write_run

from slope_tools import programs
from slope_tools.case import data_files
from slope_tools.errors import SlopeError
from slope_tools.plots import site_map
from slope_tools.releases import release_chart
from slope_tools.sites import site_trial
from slope_tools.survey import rasters

RIGHT, ASKED = "right: ", "asked: "     # before answers of commands that succeed
ROWS, COLUMNS, CELL = 30, 40, 5.0
RELEASE, ROAD = box(80, 40, 150, 110), box(20, 10, 40, 140)       # local m
LINE = LineString([(50, 20), (50, 130)])
pytestmark = pytest.mark.filterwarnings("ignore")


def ground():
    """Heights, m: level ground, a slope of 27 degrees, a plateau."""
    x = CELL * (np.arange(COLUMNS) + 0.5)
    return np.tile(520 + np.interp(x, [0, 60, 180, 200], [0, 0, 60, 62]), (ROWS, 1)) + 0.001 * np.arange(ROWS)[:, None]


def hillshade():
    """Of rough ground, as GDAL makes one."""
    return np.random.default_rng(1).integers(1, 256, (ROWS, COLUMNS)).astype(float)


def tif(path, z=None, crs=CRS_M, nodata=-9999.0, corner=(EAST, NORTH), units=None, cell=CELL, kind="float64"):
    bands = np.atleast_3d(ground() if z is None else z)
    with rasterio.open(path, "w", driver="GTiff", height=len(bands), width=bands.shape[1], count=bands.shape[2],
                       dtype=kind, crs=crs, nodata=nodata if kind == "float64" else None,
                       transform=Affine(cell, 0, corner[0], 0, -cell, corner[1] + len(bands) * cell)) as out:
        out.write(np.moveaxis(bands, 2, 0))
        if units:
            out.units = (units,)


def asc(path, z=None, crs=CRS_M):
    """A terrain as `slope terrain` writes it."""
    raster = rasters.Raster(ground() if z is None else z, Affine(CELL, 0, 0, 0, -CELL, ROWS * CELL),
                            crs and CRS.from_string(crs), (EAST, NORTH))
    rasters.write_asc_local(path, raster, {})


def kml(path, geometry):
    """A geometry in local metres as a file of Google Earth, with heights."""
    ring = translate(geometry, EAST, NORTH).exterior.coords
    points = zip(*rasterio.warp.transform(CRS_M, "EPSG:4326", *zip(*ring)))
    text(path, '<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><Polygon>'
         "<outerBoundaryIs><LinearRing><coordinates>" + " ".join(f"{x:.9f},{y:.9f},0" for x, y in points)
         + "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>")


def layer(path, *geometries, crs=CRS_M, local=False, driver="GeoJSON", name=None, kind=None):
    """Geometries in local metres, or None, as a layer of a GIS in the CRS of the survey; crs None: it names none."""
    moved = [one and (one if local else translate(one, EAST, NORTH)) for one in geometries]
    if driver == "GeoJSON":
        about = {"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {}, "geometry": one and mapping(one)} for one in moved]}
        if crs:
            about["crs"] = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:{crs.replace(':', '::')}"}}
        Path(path).write_text(json.dumps(about))
        return
    more = {"layer": name} if name else {}
    with fiona.open(path, "w", driver=driver, crs=crs, schema={"geometry": kind or "Polygon", "properties": {}},
                    **more) as out:
        out.writerecords([{"geometry": mapping(one), "properties": {}} for one in moved])


def layers(path="g.gpkg"):
    for name in ("north", "south"):
        layer(path, RELEASE, driver="GPKG", name=name)


def spoilt(z, where, value):
    z = z.copy()
    z[where] = value
    return z


def text(path, content, encoding="utf-8"):
    Path(path).write_bytes(content.encode(encoding))


def cut(path, size):
    Path(path).write_bytes(Path(path).read_bytes()[:size])


def nothing():
    """The files are all right, the command is not."""


class Case(NamedTuple):
    """A wrong input."""
    kind: str
    what: str           # is wrong
    make: Callable      # in a folder that has dem.tif, t.asc, release.geojson, road.geojson
    words: list         # of the command
    answer: str         # on standard error with status 2; after RIGHT on standard output, after ASKED in a warning


TERRAIN = ["terrain", "dem.tif", "-o", "new.asc"]
POLYGON = ["polygon", "p.geojson", "-o", "new.csv", "--terrain", "t.asc"]
OF_CSV, OF_SHP = (["polygon", name, *POLYGON[2:]] for name in ("p.csv", "p.shp"))
BODY = ["--shape", "slbl", "--depth", "5"]
RELEASED = ["release", "t.asc", "--polygon", "release.geojson", *BODY, "-o", "new"]
SITE = ["site", "--terrain", "dem.tif", "--release", "release.geojson", *BODY, "--balls", "200", "-o", "new"]
HOLE = (slice(12, 14), slice(20, 23))       # cells inside the release area
RINGS = "\n".join(f"{x + EAST},{y + NORTH}" for x, y in RELEASE.exterior.coords[:-1])

CASES = [
    # --- CRS ---
    Case("CRS in degrees", "elevation model in degrees, no --crs",
         lambda: tif("dem.tif", crs="EPSG:6668", corner=(139.8, 36.3), cell=5e-5), TERRAIN,
         "dem.tif: CRS must be in metres; give --crs EPSG:n of a projected one, got EPSG:6668 in degrees"),
    Case("CRS in degrees", "metres with the tag of longitude and latitude", lambda: tif("dem.tif", crs="EPSG:4326"),
         TERRAIN,
         "dem.tif: coordinates in EPSG:4326 must be longitude and latitude; --assign-crs EPSG:n overrides a CRS "
         "that is wrong"),
    Case("no CRS", "elevation model without a CRS", lambda: tif("dem.tif", crs=None), TERRAIN,
         "asked: dem.tif has no CRS: coordinates are taken as metres; --crs declares one"),
    Case("no CRS", "terrain without a CRS below a polygon with one", lambda: asc("t.asc", crs=None), RELEASED,
         "t.asc: must have a CRS, so that polygon and terrain can be brought together (slope terrain --crs gives it "
         "one"),
    Case("polygon without CRS", "metres in a GeoJSON that names no CRS", lambda: layer("p.geojson", ROAD, crs=None),
         POLYGON, "p.geojson: coordinates in EPSG:4326 must be longitude and latitude; --assign-crs EPSG:n overrides"),
    Case("polygon without CRS", "shapefile without .prj",
         lambda: layer("p.shp", ROAD, crs=None, driver="ESRI Shapefile"), OF_SHP,
         "p.shp: must have a CRS, so that polygon and terrain can be brought together (--assign-crs EPSG:n; a .prj "
         "file"),
    Case("wrong zone", "polygon tagged with the neighbouring zone", lambda: layer("p.geojson", ROAD, crs="EPSG:6676"),
         POLYGON, "p.geojson: must overlap the terrain, local x y 0 0 200 150"),
    Case("wrong zone", "wrong CRS of one file of a site", nothing,
         [*SITE, "--road", "road.geojson", "--assign-crs", "road.geojson=EPSG:6676"],
         "road.geojson: must overlap the terrain, local x y 0 0 200 150"),
    Case("option of a CRS", "--crs 66777", nothing, [*TERRAIN, "--crs", "66777"],
         "--crs: must be a CRS such as EPSG:6677, got 66777"),
    Case("option of a CRS", "--assign-crs of a file that the site does not have", nothing,
         [*SITE, "--assign-crs", "rode.geojson=EPSG:6677"],
         "--assign-crs: FILE=EPSG:n must name a file of the site that has coordinates, dem.tif, release.geojson, "
         "got rode.geojson"),
    Case("stretched CRS", "elevation model in Web Mercator",
         lambda: tif("dem.tif", crs="EPSG:3857", corner=(1.56e7, 4.3e6)), TERRAIN,
         "asked: a metre in EPSG:3857 is 0.809 m on the ground: choose a local CRS"),
    Case("stretched CRS", "--crs EPSG:3857", nothing, [*TERRAIN, "--crs", "EPSG:3857"], "asked: choose a local CRS"),
    # --- unit ---
    Case("CRS in feet", "California 3, heights without a unit", lambda: tif("dem.tif", crs="EPSG:2225"),
         [*TERRAIN, "--crs", CRS_M],
         "dem.tif: must say the unit of its heights, as its CRS, EPSG:2225, is in US survey foot: give --z-unit "
         "us-ft, ft or m"),
    Case("CRS in feet", "the same with --z-unit, without --crs", lambda: tif("dem.tif", crs="EPSG:2225"),
         [*TERRAIN, "--z-unit", "us-ft"],
         "dem.tif: CRS must be in metres; give --crs EPSG:n of a projected one, got EPSG:2225"),
    Case("heights in feet", "a file that says so", lambda: tif("dem.tif", ground() / 0.3048, units="ft"), TERRAIN,
         "dem.tif: heights in feet over a plan in metres must be confirmed, as many such tags are wrong: --z-unit m "
         "if"),
    Case("heights in feet", "a file that does not", lambda: tif("dem.tif", 8 * ground()), TERRAIN,
         "asked: the ground falls by 51 degrees on average: are the heights in feet? Then --z-unit ft, which makes "
         "it 21"),
    Case("heights in another unit", "centimetres", lambda: tif("dem.tif", 100 * ground()), TERRAIN,
         "dem.tif: row 1 column 1: must be a height in metres between -9000 and 9000"),
    Case("heights in another unit", "fathoms, by the file's word", lambda: tif("dem.tif", units="fathom"), TERRAIN,
         "dem.tif: heights must be in metres or feet; --z-unit m, ft or us-ft overrides a wrong tag, got fathom"),
    Case("cliff", "a body on ground in feet", lambda: asc("t.asc", 520 + 4 * (ground() - 520)), RELEASED,
         "asked: the ground of the body falls by 63 degrees on average: a cliff, or heights in feet (31 degrees)?"),
    Case("cliff", "an elevation model whose heights are exaggerated", lambda: tif("dem.tif", 10 * (ground() - 500)),
         TERRAIN, "asked: are the heights in feet? Then --z-unit ft"),
    Case("unit of the cells", "kilometres", lambda: tif("dem.tif", ground()[:, 14:34], cell=0.005), TERRAIN,
         "asked: the ground falls by 90 degrees on average, 90 if it is in feet: are these heights, and the cells in "
         "metres?"),
    Case("unit of the cells", "a CRS in kilometres", lambda: tif("dem.tif", crs="+proj=utm +zone=54 +units=km"),
         TERRAIN, "dem.tif: CRS must be in metres; give --crs EPSG:n of a projected one, got"),
    # --- heights ---
    Case("pits", "cells of 0 m in an elevation model", lambda: tif("dem.tif", spoilt(ground(), HOLE, 0)), TERRAIN,
         "asked: 6 cells of 0 m lie at least 538.8 m below all cells beside them"),
    Case("pits", "cells of 0 m in the release area", lambda: asc("t.asc", spoilt(ground(), HOLE, 0)), RELEASED,
         "release.geojson: the ground in it must have no pits: 6 cells of 0 m lie 538.8 m or more below all cells "
         "beside them; --nodata 0 makes them NODATA, with --fill 6 they are filled"),
    Case("undeclared NODATA", "-32768", lambda: tif("dem.tif", spoilt(ground(), HOLE, -32768)), TERRAIN,
         "dem.tif: row 13 column 21: must be a height in metres between -9000 and 9000, or the NODATA value that "
         "the file declares; --nodata -32768 if it means none"),
    Case("undeclared NODATA", "-32768, with --nodata and --fill",
         lambda: tif("dem.tif", spoilt(ground(), HOLE, -32768)), [*TERRAIN, "--nodata", "-32768", "--fill", "6"],
         "right: filled 1 NODATA holes of at most 6 cells, 6 cells"),
    Case("NODATA in the body", "a hole", lambda: asc("t.asc", spoilt(ground(), HOLE, np.nan)), RELEASED,
         "release.geojson: must stay at least 2 cells away from NODATA and from the edge of t.asc; --fill 6 of "
         "slope terrain and site fills this hole, got NODATA at east"),
    Case("NODATA in the body", "the end of the survey", lambda: asc("t.asc", spoilt(ground(), np.s_[:, 28:], np.nan)),
         RELEASED,
         "release.geojson: must stay at least 2 cells away from NODATA and from the edge of t.asc; it goes on to "
         "the edge"),
    Case("no heights", "all NODATA", lambda: tif("dem.tif", np.full((9, 9), -9999.0)), TERRAIN,
         "dem.tif: must have a height, all cells are NODATA"),
    Case("no heights", "level ground below the release area", lambda: asc("t.asc", np.full((ROWS, COLUMNS), 500.0)),
         RELEASED, "release.geojson: the ground in it must fall by at least 1 degree, got 0, flat"),
    # --- order ---
    Case("order of the box", "--bounds E S W N", nothing, [*TERRAIN, "--bounds", "5", "0", "1", "9"],
         "--bounds: W S E N must have W < E and S < N, got 5 0 1 9"),
    Case("order of the box", "--bounds in local metres", nothing, [*TERRAIN, "--bounds", "0", "0", "99", "99"],
         "--bounds: must overlap the input"),
    Case("order of coordinates", "north,east in a CSV",
         lambda: text("p.csv", "\n".join(",".join(line.split(",")[::-1]) for line in RINGS.splitlines())), OF_CSV,
         "p.csv: must overlap the terrain (with x and y exchanged it would), local x y 0 0 200 150"),
    Case("order of coordinates", "latitude, longitude in a GeoJSON",
         lambda: layer("p.geojson", box(36.3, 139.8, 36.31, 139.81), crs=None, local=True), POLYGON,
         "p.geojson: coordinates in EPSG:4326 must be longitude and latitude"),
    Case("release area and road swapped", "on a level road", nothing,
         [*SITE[:4], "road.geojson", *SITE[5:], "--road", "release.geojson"],
         "--release, --road: must not be swapped, the mass falls from the release area onto the road, got --release "
         "road.geojson: 520 m on average, a slope of 0 degrees; --road release.geojson: 5"),
    Case("release area and road swapped", "on a road with a slope", lambda: layer("road.geojson", box(20, 40, 78, 110)),
         [*SITE[:4], "road.geojson", *SITE[5:], "--road", "release.geojson"],
         "asked: --release and --road may be swapped, the road lies above the release area"),
    Case("surveys of a scar", "before and after exchanged", lambda: asc("after.asc", ground() + 3),
         ["release", "t.asc", "--scar", "after.asc", "-o", "new"],
         "after.asc: must be lower than the terrain (are the surveys before and after exchanged?) somewhere"),
    Case("surveys of a scar", "over different datums",
         lambda: asc("after.asc", spoilt(ground(), HOLE, ground()[HOLE] - 5) - 0.6),
         ["release", "t.asc", "--scar", "after.asc", "--polygon", "release.geojson", "-o", "new"],
         "asked: beside the body after.asc lies 0.6 m below the terrain (median), which counts in the depths: "
         "vertical datums are not compared"),
    Case("depths for heights", "depths without --scar-is", lambda: tif("depth.tif", spoilt(0 * ground(), HOLE, 5.0)),
         ["release", "t.asc", "--scar", "depth.tif", "-o", "new"],
         "depth.tif: must be heights that follow the terrain's, 520 to 581.779 m: did you mean depths? Then "
         "--scar-is depth"),
    Case("depths for heights", "a change as --scar-is depth",
         lambda: tif("depth.tif", spoilt(0 * ground(), HOLE, -5.0)),
         ["release", "t.asc", "--scar", "depth.tif", "--scar-is", "depth", "-o", "new"],
         "depth.tif: must hold depths >= 0, positive down; if it is the change of the surface, give --scar-is "
         "change, got -5"),
    # --- geometry ---
    Case("no polygon", "a line", lambda: layer("p.geojson", LINE), POLYGON,
         "p.geojson: feature 0: must be a polygon, got LineString"),
    Case("no polygon", "a point", lambda: layer("p.geojson", Point(3, 3)), POLYGON,
         "p.geojson: feature 0: must be a polygon, got Point"),
    Case("no line", "a polygon as --line", nothing, [*SITE, "--line", "road.geojson"],
         "road.geojson: must hold a line: draw one, as the outline of an area has no forward and back, got only "
         "Polygon"),
    Case("no line", "two lines that do not meet",
         lambda: layer("l.geojson", MultiLineString([[(50, 20), (50, 40)], [(50, 60), (50, 90)]])),
         [*SITE, "--line", "l.geojson"], "l.geojson: must hold one line, got 2, which are not joined end to end"),
    Case("crossing outline", "a bow tie", lambda: layer("p.geojson", Polygon([(20, 10), (40, 90), (40, 10), (20, 90)])),
         POLYGON, "p.geojson: feature 0: must be polygons that do not cross or touch themselves"),
    Case("crossing outline", "a ring of two points", lambda: text("p.csv", "1,1\n2,2\n"), OF_CSV,
         "p.csv: line 1: a ring must have at least 3 points, got 2"),
    Case("no geometry", "a feature without a geometry among others", lambda: layer("p.geojson", ROAD, None), POLYGON,
         "asked: p.geojson: feature 1 has no geometry (1 of 2 have none): left out"),
    Case("no geometry", "features without any", lambda: layer("p.geojson", None), POLYGON,
         "p.geojson: must hold polygons, none of its features has a geometry, got 1"),
    Case("beside the terrain", "a polygon elsewhere", lambda: layer("p.geojson", translate(ROAD, 5000)), POLYGON,
         "p.geojson: must overlap the terrain, local x y 0 0 200 150"),
    Case("beside the terrain", "a polygon that reaches beyond it", lambda: layer("p.geojson", box(-20, 10, 40, 90)),
         POLYGON, "asked: p.geojson: 33 % of the area lies outside of t.asc"),
    Case("release area", "smaller than nine cells", lambda: layer("release.geojson", box(90, 50, 99, 59)), RELEASED,
         "release.geojson: must hold at least 9 centres of the cells of t.asc, which are 5 m wide"),
    Case("release area", "at the edge of the terrain", lambda: layer("release.geojson", box(80, 40, 199, 90)), RELEASED,
         "release.geojson: must stay at least 2 cells away from NODATA and from the edge of t.asc, got its edge at "
         "east"),
    Case("several polygons", "two for a sphere",
         lambda: layer("release.geojson", box(80, 40, 110, 70), box(80, 80, 110, 110)),
         ["sphere" if word == "slbl" else word for word in RELEASED],
         "release.geojson: must be one polygon for --shape sphere; slbl and slab take several, got 2"),
    Case("several polygons", "two that overlap", lambda: layer("p.geojson", ROAD, box(30, 10, 50, 140)), POLYGON,
         "right: new.csv: 1 polygon, 1 ring (0 holes)"),
    Case("lost release area", "smaller than a cell, beside another one",
         lambda: layer("release.geojson", box(80, 40, 110, 70), box(81, 81, 81.5, 81.5)), RELEASED,
         "asked: release.geojson: feature 2 gets no body, no centre of a cell"),
    Case("lost release area", "beside the terrain, another one in it",
         lambda: layer("release.geojson", box(80, 40, 110, 70), box(500, 500, 530, 530)), RELEASED,
         "asked: release.geojson: feature 2 gets no body, no centre of a cell"),
    # --- files ---
    Case("missing file", "an elevation model", nothing, ["terrain", "dam.tif", "-o", "new.asc"],
         "dam.tif: must be an existing file"),
    Case("missing file", "a road", nothing, [*SITE, "--road", "rode.geojson"],
         "rode.geojson: must be an existing file"),
    Case("parts of a shapefile", "without .shx",
         lambda: (layer("p.shp", ROAD, driver="ESRI Shapefile"), Path("p.shx").unlink()), OF_SHP,
         "p.shp: must have its other files beside it, p.shx is missing: copy all of the shapefile (.shp, .shx, "
         ".dbf, .prj)"),
    Case("parts of a shapefile", "without .dbf",
         lambda: (layer("p.shp", ROAD, driver="ESRI Shapefile"), Path("p.dbf").unlink()), OF_SHP,
         "right: new.csv: 1 polygon"),
    Case("layers of a file", "several that fit", layers, ["polygon", "g.gpkg", *POLYGON[2:]],
         "g.gpkg: must name one of its layers, g.gpkg|layername=NAME (or --layer, where there is that option): "
         "north, south, got 2 layers"),
    Case("layers of a file", "one that is not there", layers, [*RELEASED[:3], "g.gpkg|layername=west", *RELEASED[4:]],
         "g.gpkg: must have the named layer, one of north, south, got west"),
    Case("truncated file", "GeoTIFF", lambda: cut("dem.tif", 3000), TERRAIN,
         "dem.tif: must be a raster that GDAL can read"),
    Case("truncated file", "ASCII grid", lambda: cut("t.asc", 3000), ["terrain", "t.asc", "-o", "new.asc"],
         "t.asc: values: must be 30 rows of 40, 1200 values, got"),
    Case("picture", "three bands", lambda: tif("dem.tif", np.dstack([ground()] * 3)), TERRAIN,
         "dem.tif: must have one band, the heights; gdal_translate -b N takes one of"),
    Case("picture", "an image without a place",
         lambda: rasterio.open("dem.png", "w", driver="PNG", width=9, height=9, count=1, dtype="uint8").close(),
         ["terrain", "dem.png", "-o", "new.asc"],
         "dem.png: must be georeferenced: place and size of the cells are missing"),
    Case("hillshade", "a GeoTIFF of 8 bits", lambda: tif("dem.tif", hillshade(), kind="uint8"), TERRAIN,
         "dem.tif: must be heights, not a picture such as a hillshade; if they are heights, gdal_translate -ot "
         "Float32 stores them as such, got values of 8 bits"),
    Case("hillshade", "converted to an ASCII grid", lambda: asc("t.asc", hillshade()),
         ["terrain", "t.asc", "-o", "new.asc"],
         "asked: all heights are whole numbers from 1 to 255, as the values of a picture: is it a hillshade?"),
    Case("ASCII grid", "decimal commas",
         lambda: text("dem.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 5\n1,5 2,5\n"),
         ["terrain", "dem.asc", "-o", "new.asc"], "dem.asc: line 6: must hold numbers with a decimal point, got '1,5'"),
    Case("ASCII grid", "no corner in the header",
         lambda: text("dem.asc", "ncols 2\nnrows 1\nxllcorner 0\ncellsize 5\n1 2\n"),
         ["terrain", "dem.asc", "-o", "new.asc"],
         "dem.asc: header: must have xllcorner and yllcorner, or xllcenter and"),
    Case("files of a globe", "a KML of the area", lambda: kml("p.kml", ROAD), ["polygon", "p.kml", *POLYGON[2:]],
         "right: 1 polygon, "),
    Case("files of a globe", "a KML of another area", lambda: kml("p.kml", translate(ROAD, 9000)),
         ["polygon", "p.kml", *POLYGON[2:]], "p.kml: must overlap the terrain, local x y "),
    Case("another kind of file", "a raster as --structure", nothing, [*SITE, "--structure", "dem.tif"],
         "dem.tif: must be an STL file of triangles, text or binary"),
    Case("another kind of file", "a strong-motion record as --motion",
         lambda: text("quake.txt", "Origin Time 2011/03/11\n"), [*SITE, "--motion", "quake.txt"],
         "quake.txt: line 1: must be four numbers, t ax ay az in s and m/s2 (slope quake makes it from a record), "
         "got Origin Time"),
    Case("empty file", "polygons", lambda: text("p.geojson", ""), POLYGON,
         "p.geojson: must be polygons that GDAL can read"),
    Case("empty file", "rings", lambda: text("p.csv", ""), OF_CSV, "p.csv: must hold a polygon, it is empty"),
    Case("no run to export", "a raster that is none of a run's", nothing, ["export", "t.asc"],
         "t.asc: must be output of fix deposit/grid: its prefix, one of its files, or the folder of a run, a study "
         "or a site"),
    Case("no run to export", "one raster of a run", lambda: write_run(np.ones((9, 9)), 0.0, 5.0),
         ["export", "run.surface.asc"], "right: written to run.export: run.surface.tif run.thickness.tif"),
    # --- options ---
    Case("options that exclude each other", "--depth and --volume", nothing, [*RELEASED, "--volume", "9"],
         "argument --volume: not allowed with argument --depth"),
    Case("options that exclude each other", "--scar and --shape", nothing, [*RELEASED, "--scar", "t.asc"],
         "--shape: must not be given with --scar, whose depths are not changed"),
    Case("sizes", "a negative depth", nothing,
         ["release", "t.asc", "--polygon", "release.geojson", "--depth", "-5", "-o", "new"],
         "--depth: must be > 0, got -5"),
    Case("sizes", "more volume than there is", nothing,
         ["release", "t.asc", "--polygon", "release.geojson", "--shape", "slbl", "--volume", "1e9", "-o", "new"],
         "--volume: must be at most "),
    Case("another unit of friction", "a coefficient for --friction", nothing, [*SITE, "--friction", "0.5"],
         "asked: --friction 0.5: is it in degrees? A coefficient of 0.5 is 26.6 degrees"),
    Case("another unit of friction", "percent for --rolling", nothing, [*SITE, "--rolling", "5"],
         "asked: --rolling 5: is it a coefficient?"),
    Case("numbers", "--cell 0", nothing, [*TERRAIN, "--cell", "0"], "--cell: must be > 0, got 0"),
    Case("numbers", "a decimal comma", nothing, [*TERRAIN, "--cell", "2,5"],
         "argument --cell: must be a finite number, got '2,5'"),
    Case("output", "into a folder that is not there", nothing, ["terrain", "dem.tif", "-o", "no/new.asc"],
         "-o: must be in an existing folder, got no/new.asc"),
    Case("output", "onto the input", nothing, ["terrain", "t.asc", "-o", "t.asc"],
         "-o: must not be an input, got t.asc"),
    # --- encoding ---
    Case("encoding", "a CSV in Latin-1", lambda: text("p.csv", "# Stra\u00dfe\n" + RINGS, "latin-1"), OF_CSV,
         "p.csv: must be text in UTF-8"),
    Case("encoding", "a CSV with byte-order mark and Windows line ends",
         lambda: text("p.csv", "\ufeff" + RINGS.replace("\n", "\r\n")), OF_CSV,
         "right: new.csv: 1 polygon, 1 ring (0 holes), 4 vertices"),
    Case("separators", "semicolons", lambda: text("p.csv", RINGS.replace(",", ";")), OF_CSV,
         "p.csv: line 1: must be two numbers, x,y, got -11850.0;34040.0"),
    Case("separators", "decimal commas", lambda: text("p.csv", RINGS.replace(",", ";").replace(".", ",")), OF_CSV,
         "p.csv: line 1: must be two numbers, x,y, got -11850,0;34040,0"),
    Case("names", "spaces and umlauts in the name of a folder", nothing, [*SITE[:-1], "Damm Fluchth\u00f6rn"],
         "right: then: tools/slope study 'Damm Fluchth\u00f6rn'"),
    Case("names", "spaces and umlauts in that of a file", lambda: shutil.move("dem.tif", "H\u00f6hen 2021.tif"),
         ["terrain", "H\u00f6hen 2021.tif", "-o", "Gel\u00e4nde neu.asc"],
         "asked: Gel\u00e4nde neu.asc: LAMMPS cannot read \u00e4 in the name of a file: rename it before it goes into "
         "a deck"),
]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A folder with inputs that are all right."""
    folder = tmp_path_factory.mktemp("right")
    back = os.getcwd()
    os.chdir(folder)
    tif("dem.tif")
    asc("t.asc")
    layer("release.geojson", RELEASE)
    layer("road.geojson", ROAD)
    os.chdir(back)
    return folder


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.kind}: {case.what}")
def test_a_wrong_input(case, files, tmp_path, monkeypatch, capsys):
    shutil.copytree(files, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("LMP", raising=False)
    monkeypatch.setattr(programs, "BESIDE", tmp_path / "nowhere")
    monkeypatch.setattr(release_chart, "draw_release", lambda path, *rest: Path(path).write_bytes(b""))
    monkeypatch.setattr(site_map, "draw_site_map", lambda path, *rest: Path(path).write_bytes(b""))
    case.make()
    before = set(os.listdir())
    status, out, err = called(capsys, case.words)
    lines = [line for line in err.splitlines() if "warning: " not in line and "note: " not in line]
    assert "Traceback" not in err and "a bug" not in err
    if case.answer.startswith((RIGHT, ASKED)):
        assert (status, lines) == (0, []), err
        assert case.answer[len(RIGHT):] in (out if case.answer.startswith(RIGHT) else err), out + err
        return
    assert (status, len(lines)) == (2, 1), err
    assert lines[0].startswith(f"slope {case.words[0]}: {case.answer}"), lines[0]
    left = set(os.listdir()) - before
    assert left <= {"new"} and os.listdir("new") == ["site.yaml"] if left else True


@pytest.mark.parametrize("value, kind, units, rule", [
    (-3276.8, "float32", None, "dem.tif: the ground must have no pits of a NODATA value: 6 cells of -3276.8 m lie"),
    (-999, "float32", "ft", "dem.tif: the ground must have no pits of a NODATA value: 6 cells of -304.495 m (-999 in"),
    (-9999, "float32", "ft", "dem.tif: row 13 column 21: must be a height in ft between -9000 and 29527")])
def test_a_site_with_pits_ends_before_the_trial_run(files, tmp_path, monkeypatch, capsys, value, kind, units, rule):
    shutil.copytree(files, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(site_trial, "trial_diameter", lambda *_: pytest.fail("a trial run"))
    tif("dem.tif", spoilt(ground() / (0.3048 if units else 1), HOLE, value), units=units, kind=kind)
    status, _, err = called(capsys, SITE + ["--z-unit", units] * bool(units))
    assert status == 2 and err.startswith(f"slope site: {rule}") and f"--nodata {value:g} " in err


# --- names ---

CP932 = "\udc93\udcb9"      # two bytes that are not UTF-8, as an unpacked zip has them


@pytest.mark.parametrize("words, where", [
    (["terrain", f"{CP932}.tif", "-o", "new.asc"], r"\x93\xb9.tif"),
    (["terrain", "dem.tif", "-o", f"{CP932}.asc"], r"\x93\xb9.asc"),
    (["terrain", "dem.tif", "-o", "link/new.asc"], "link/new.asc"),     # to a folder of such a name
    (["quake", f"{CP932}.AT2", "-o", "new.txt"], r"\x93\xb9.AT2"),
    (["polygon", f"{CP932}.geojson", "-o", "new.csv", "--terrain", "t.asc"], r"\x93\xb9.geojson"),
    ([*SITE[:2], f"{CP932}.tif", *SITE[3:]], r"\x93\xb9.tif"), ([*SITE[:-1], f"f{CP932}/new"], r"f\x93\xb9/new"),
    (["study", "in.deck", "--set", "a=1", "-o", f"f{CP932}/new"], r"f\x93\xb9/new"),
    (["export", "t", "-o", f"e{CP932}"], r"e\x93\xb9"), (["report", "t", "-o", f"e{CP932}.html"], r"e\x93\xb9.html")])
def test_a_name_that_is_not_utf8(files, tmp_path, monkeypatch, capsys, words, where):
    shutil.copytree(files, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    os.mkdir(f"f{CP932}")
    os.symlink(f"f{CP932}", "link")
    shutil.copy("dem.tif", f"{CP932}.tif")
    before = set(os.listdir())
    status, out, err = called(capsys, words)
    assert (status, out) == (2, "")
    assert err.startswith(f"slope {words[0]}: {where}: must have a name in UTF-8: rename it")
    assert set(os.listdir()) == before and not os.listdir(f"f{CP932}")


def test_a_current_folder_whose_name_is_not_utf8(files, tmp_path, monkeypatch, capsys):
    (tmp_path / CP932).mkdir()
    monkeypatch.chdir(tmp_path / CP932)
    for words in (SITE, ["study", "in.deck", "--set", "a=1"]):
        status, _, err = called(capsys, words)
        assert status == 2 and f"slope {words[0]}: the current folder: must have a name in UTF-8" in err
        assert err.endswith("\\x93\\xb9\n") and not os.listdir()


def test_data_whose_names_are_not_utf8_stay_where_they_are(tmp_path):
    deck = tmp_path / "in.deck"
    (tmp_path / f"{CP932}.csv").touch()
    deck.write_bytes(b'print "\x93\xb9"\nregion a polygon road.csv\n')
    assert list(data_files.data_files(deck, {})) == ["in.deck"]
    deck.write_bytes(b"region a polygon \x93\xb9.csv\n")
    with pytest.raises(SlopeError, match=r"in.deck: must name files in UTF-8: rename it, got .x93.xb9.csv"):
        data_files.data_files(deck, {})


@pytest.mark.parametrize("variables", [{"LC_ALL": "POSIX", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
                                       {"PYTHONIOENCODING": "ascii"}])
def test_names_in_utf8_under_another_locale(files, tmp_path, variables):
    shutil.copytree(files, tmp_path, dirs_exist_ok=True)
    name = "\u9053"
    shutil.move(tmp_path / "dem.tif", tmp_path / f"{name}.tif")
    done = subprocess.run([TOP / "tools" / "slope", "terrain", f"{name}.tif", "-o", f"{name}.asc"], cwd=tmp_path,
                          env={**os.environ, **variables}, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert f"{name}.tif" in (tmp_path / f"{name}.yaml").read_text(encoding="utf-8").encode().decode("unicode_escape")


# --- the page ---

HEAD = """\
.. Made by python3 tests/tools/test_wrong_inputs.py > doc/src/wrong_inputs.rst; do not edit.

Wrong inputs of a GIS
=====================

*For users.*  What users of a GIS get wrong, two of each kind, and what :doc:`slope terrain <tool_terrain>`,
:doc:`polygon <tool_polygon>`, :doc:`release <tool_release>`, :doc:`site <tool_site>` and :doc:`export <tool_export>`
answer: an error, one line with status 2 that begins so, or the right result, with what is said of it.  Nothing is
wrong in silence, and nothing is a traceback.  Of a new site that could not be made, *site.yaml* is kept; else an error
leaves no file.

.. list-table::
   :header-rows: 1
   :widths: 16 26 58

   * - Kind
     - Input
     - Answer
"""


def page():
    """doc/src/wrong_inputs.rst."""
    lines, last = [], None
    for case in CASES:
        accepted = case.answer.startswith((RIGHT, ASKED))
        shown = (case.answer if accepted else f"error: {case.answer}").replace("\u00f6", "oe").replace("\u00e4", "ae")
        lines += [f"   * - {case.kind if case.kind != last else ''}".rstrip(), f"     - {case.what}",
                  f"     - {shown[:len(RIGHT)]}``{shown[len(RIGHT):].strip()}``"]
        last = case.kind
    return HEAD + "\n".join(lines) + "\n"


def test_two_of_each_of_forty_kinds():
    kinds = [case.kind for case in CASES]
    assert len(set(kinds)) >= 40 and all(kinds.count(kind) == 2 for kind in kinds)
    assert len({(case.kind, case.what) for case in CASES}) == len(CASES)


def test_the_page_is_what_the_cases_say():
    assert (TOP / "doc" / "src" / "wrong_inputs.rst").read_text(encoding="ascii") == page(), "make it again, see HEAD"


if __name__ == "__main__":
    print(page(), end="")
