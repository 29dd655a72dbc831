"""What elevation models come as: lists of points in any order, zips, tiles of another phase, windows of large files.

The ground is a plane with a hill, so that a cell at another place has another height.
"""
import gzip
import itertools
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
import rasterio
import rasterio.shutil
import yaml
from affine import Affine
from pyproj import Proj
from rasterio.crs import CRS
from rasterio.windows import Window

from messages import is_one

from slope_tools.errors import SlopeError
from slope_tools.sites import site
from slope_tools.sites.site_sections import OfMass
from slope_tools.survey import crs, rasters, terrain, vectors, xyz, zips
from slope_tools.survey.vectors import ignore

COMMAND = "terrain"
EAST, NORTH = 460000.0, 101000.0        # of the first centre in the south-west
COLUMNS, ROWS = 11, 8
CRS_M = "EPSG:6677"
TOOLS = Path(os.environ.get("SLOPE_TOOLS", Path(__file__).resolve().parents[2] / "tools"))


def ground(east, north):
    x, y = east - EAST, north - NORTH
    return 300 + 0.31 * x - 0.17 * y + 3 * np.exp(-((x - 3) ** 2 + (y - 5) ** 2) / 6)


def points(step=1.0, columns=COLUMNS, rows=ROWS, east=EAST, north=NORTH):
    """Rows x, y, z from north to south, as GDAL likes them."""
    x, y = np.meshgrid(east + step * np.arange(columns), north + step * np.arange(rows)[::-1])
    return np.column_stack([x.ravel(), y.ravel(), ground(x, y).ravel()])


def write(path, values, columns=(0, 1, 2), between=",", head="", form="{:.3f}", decimal="."):
    lines = [between.join(form.format(value).replace(".", decimal) for value in row) for row in values[:, columns]]
    Path(path).write_text("\n".join([*head.splitlines(), *lines]) + "\n", encoding="utf-8")


def tif(path, step=1.0, columns=COLUMNS, rows=ROWS, east=EAST, north=NORTH, z=None, unit=None, crs_=CRS_M, **more):
    """A GeoTIFF with these centres."""
    if z is None:
        z = points(step, columns, rows, east, north)[:, 2].reshape(rows, columns)
    transform = Affine(step, 0, east - step / 2, 0, -step, north + (rows - 0.5) * step)
    with rasterio.open(path, "w", driver="GTiff", height=len(z), width=z.shape[1], count=1, dtype="float64", crs=crs_,
                       transform=transform, nodata=-9999.0, **more) as out:
        out.write(z, 1)
        if unit:
            out.units = (unit,)


@pytest.fixture
def made(slope, here):
    """Run it, which must succeed: heights, east and north of their cells, stdout, stderr."""
    def run(arguments):
        status, out, err = slope(f"{arguments} --overwrite -o out.asc")
        assert status == 0, err
        z, transform, _, offset = rasters.read_asc_local("out.asc")
        x, y = transform @ np.meshgrid(np.arange(z.shape[1]) + 0.5, np.arange(len(z)) + 0.5)
        return z, x + offset[0], y + offset[1], out, err
    return run


def in_place(found, missing=0, tolerance=0.0011):
    """Whether all heights are at their places, to the cell."""
    z, east, north = found[:3]
    known = np.isfinite(z)
    assert np.count_nonzero(~known) == missing
    assert np.abs(z - ground(east, north))[known].max() <= tolerance
    return True


def refused(slope, arguments, message):
    status, _, err = slope(f"{arguments} -o out.asc")
    lines = "".join(line for line in err.splitlines(True) if "warning:" not in line)
    assert status == 2 and is_one(lines, f"slope terrain: {message}"), err
    assert not os.path.exists("out.asc")
    return err


# --- lists of points ---

def by_columns(values):
    return values[np.lexsort([values[:, 1], values[:, 0]])]


def there_and_back(values):
    rows = values.reshape(ROWS, COLUMNS, 3)
    return np.concatenate([row[::-1] if k % 2 else row for k, row in enumerate(rows)])


ORDERS = {"rows": lambda values: values, "columns": by_columns, "there and back": there_and_back,
          "rows from the south": lambda values: values[::-1],
          "shuffled": lambda values: np.random.default_rng(3).permutation(values)}
HEADS = [("x,y,z", (0, 1, 2)), ("Northing,Easting,Elevation", (1, 0, 2)),
         ("Hochwert;Rechtswert;H\u00f6he", (1, 0, 2)),
         ("P,N,E,Z", (0, 1, 0, 2)), ("N E Z", (1, 0, 2)), ("z\tnorth\teast", (2, 1, 0)),
         ("east north height", (0, 1, 2)),
         ("X [m]  Y [m]  Z [m]", (0, 1, 2)), ("Nr;Rechtswert;Hochwert;DGM;Klasse", (2, 0, 1, 2, 0)),
         ("# y x z", (1, 0, 2)), ("POINT_Y,POINT_X,alti", (1, 0, 2)), ("", (0, 1, 2))]


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("gaps", [0, 9, 60])
def test_points_of_a_grid_may_come_in_any_order(made, order, gaps):
    values = ORDERS[order](points())
    values = np.delete(values, np.random.default_rng(5).choice(len(values), gaps, replace=False), axis=0)
    write("a.xyz", values, between=" ")
    assert in_place(made("a.xyz"), gaps)


@pytest.mark.parametrize("head, columns", HEADS)
@pytest.mark.parametrize("order", ["rows", "columns"])
def test_a_head_may_name_the_columns_in_any_order(made, head, columns, order):
    between = next((one for one in ";\t," if one in head), " ")
    write("a.csv", ORDERS[order](points()), columns, between, head)
    assert in_place(made("a.csv"))


@pytest.mark.parametrize("head, columns", [("lon,lat,height", (0, 1, 2)), ("Latitude,Longitude,elev", (1, 0, 2))])
def test_points_in_degrees(made, head, columns):
    lon, lat = np.meshgrid(139.8 + 1e-4 * np.arange(30), 36 + 1e-4 * np.arange(20))
    write("a.csv", np.column_stack([lon.ravel(), lat.ravel(), 300 + 1e4 * (lon - 139.8).ravel()]), columns, head=head,
          form="{:.7f}")
    z, east, north, *_ = made("a.csv --assign-crs EPSG:6668 --crs EPSG:6677")
    there = crs.transform(CRS.from_string(CRS_M), CRS.from_string("EPSG:6668"), east, north)[0]
    assert np.nanmax(np.abs(z - (300 + 1e4 * (there - 139.8)))) < 0.0011 and np.isfinite(z).mean() > 0.9


@pytest.mark.parametrize("between, decimal", [(" ", "."), (";", ","), ("\t", ","), (" ", ","), (", ", "."), (";", ".")])
def test_what_stands_between_numbers(made, between, decimal):
    write("a.txt", by_columns(points()), between=between, decimal=decimal)
    assert in_place(made("a.txt"))


def test_a_number_or_a_name_may_come_first(made):
    values = ORDERS["shuffled"](points())
    write("a.csv", np.column_stack([np.arange(len(values)), values]), (0, 1, 2, 3))
    assert in_place(made("a.csv"))
    lines = Path("a.csv").read_text().splitlines()
    Path("a.csv").write_text("\n".join(f"P{line}" for line in lines))
    assert in_place(made("a.csv"))


def test_steps_that_are_rounded_are_one(made):
    """0.3333 m, written in cm: cells are square, and none is resampled."""
    values = points(step=0.3333)
    write("a.xyz", values, between=" ", form="{:.2f}")
    z, _, _, out, _ = made("a.xyz")
    assert "resampled" not in out and z.ravel() == pytest.approx(values[:, 2], abs=0.006)


def test_irregular_points_are_no_grid(slope, here):
    places = np.random.default_rng(2).uniform(0, 40, (300, 2)).round(2)
    write("a.xyz", np.column_stack([places + [EAST, NORTH], 300 + places[:, 0]]), between=" ")
    assert "gdal_grid" in refused(slope, "a.xyz", "a.xyz: must be heights in rows and columns, at equal distances, "
                                  "got 300 points on no grid")


@pytest.mark.parametrize("head, change, message", [
    ("a b c d", lambda line: line + " 1", "a.xyz: line 1: the head must name the columns"),
    ("", lambda line: line.replace(" 300.", " *300."), "a.xyz: line 3: must hold numbers"),
    ("", lambda line: line.replace(" 101004.000 ", " 101004.000 - "), "a.xyz: line 34: must hold numbers"),
    ("lon lat z", str, "a.xyz: columns in degrees must have a CRS in degrees; --assign-crs")])
def test_a_wrong_list_of_points(slope, here, head, change, message):
    write("a.xyz", points(), between=" ", head=head)
    lines = Path("a.xyz").read_text().splitlines()
    Path("a.xyz").write_text("\n".join([*lines[:bool(head)], *map(change, lines[bool(head):])]))
    assert slope("a.xyz -o out.asc")[2].startswith(f"slope terrain: {message}")


def test_two_heights_at_one_place(slope, here, made):
    values = points()
    write("a.xyz", np.concatenate([values, values[5:6]]), between=" ")
    assert in_place(made("a.xyz"))
    os.remove("out.asc")
    values[5:6, 2] += 1
    write("a.xyz", np.concatenate([points(), values[5:6]]), between=" ")
    refused(slope, "a.xyz", f"a.xyz: must have one height at {EAST + 5:.10g} {NORTH + 7:.10g}, got ")


# --- words in grids of text ---

GRASS = "north: 30\nsouth: 0\neast: 40\nwest: 0\nrows: 3\ncols: 4\n{}1 2 3 *\n5 6 7 8\n9 10 11 12\n"
ZMAP = ("! made up\n@A, GRID, 3\n10, -9999, , 3, 1\n3, 4, 0.0, 40.0, 0.0, 30.0\n0.0, 0.0, 0.0\n@\n" + "".join(
    "".join(f"{10 * k + j:10.3f}" for j in range(3)) + "\n" for k in range(4)))
ISG = (f"begin_of_head {48 * '='}\nmodel name : made up\nlat min = 40.0\nlat max = 43.0\nlon min = 120.0\n"
       "lon max = 124.0\ndelta lat = 1.0\ndelta lon = 1.0\nnrows = 3\nncols = 4\nnodata = -9999.0\n"
       f"ISG format = 1.0\nend_of_head {50 * '='}\n1 2 3 4\n5 6 7 8\n9 10 11 12\n")
SURFER = "DSAA\n4 3\n5 35\n5 25\n1 12\n9 10 11 12\n5 6 7 8\n1 2 3 4\n"


@pytest.mark.parametrize("more, heights", [
    ("", [[1, 2, 3, None], [5, 6, 7, 8]]), ("null: 5\n", [[1, 2, 3, None], [None, 6]]),
    ("multiplier: 2\n", [[2, 4, 6, None]]), ("type: float\n", [[1, 2, 3, None]])])
def test_the_null_of_grass_is_no_height(made, here, more, heights):
    (here / "grass.txt").write_text(GRASS.format(more))
    z = made("grass.txt")[0]
    for row, wanted in zip(z, heights):
        assert [None if np.isnan(one) else one for one in row[:len(wanted)]] == wanted


@pytest.mark.parametrize("text, old, line", [
    (GRASS.format(""), "6", 8), (GRASS.format(""), "10 ", 9), (ZMAP, "    11.000", 8), (ISG, "6 ", 15),
    (SURFER, "6 ", 7)])
def test_a_word_in_a_grid_of_text_is_no_height(slope, here, made, text, old, line):
    """GDAL takes it for 0."""
    extra = "--assign-crs EPSG:4326 --crs EPSG:32651 " if text is ISG else ""
    (here / "a.grd").write_text(text)
    made(f"a.grd {extra}")
    os.remove("out.asc")
    for word in ("N/A", "12abc", "1_5") if text is not SURFER else ("12abc",):
        (here / "a.grd").write_text(text.replace(old, f"{word:>{len(old)}}" + " " * old.endswith(" ")))
        refused(slope, f"a.grd {extra}", f"a.grd: line {line}: must hold numbers with a decimal point, got '{word}'")


# --- zips ---

@pytest.mark.parametrize("name", ["a.tif", "a.asc", "a.xyz", "folder/a.txt"])
def test_a_raster_in_the_zip_in_which_it_is_downloaded(made, here, name):
    tif("a.tif")
    write("a.xyz", by_columns(points()), between=" ")
    shutil.copy("a.xyz", "a.txt")
    made("a.tif --origin 0 0")
    shutil.move("out.asc", "a.asc")
    os.remove("out.yaml")
    with zipfile.ZipFile("a.zip", "w") as archive:
        archive.write(Path(name).name, name)
        archive.writestr("readme.txt", "see 1 2 3 of the leaflet\n")
        archive.writestr("__MACOSX/._a.tif", "x")
        archive.writestr(f"{name}.aux.xml", "<PAMDataset/>")
    assert in_place(made("a.zip"))
    assert rasters.is_raster("a.zip")
    assert rasters.read_raster(f"./a.zip/{name}").z.shape == (ROWS, COLUMNS)
    with zipfile.ZipFile("a.zip", "a") as archive:
        archive.writestr("outline.geojson", "{}")
    assert not rasters.is_raster("a.zip")       # a layer, with a raster or a list of its points


@pytest.mark.parametrize("member", ["a.txt", "a.asc", "a.xyz", "a.tif", "a.geojson", "a.shp"])
@pytest.mark.parametrize("password", [False, True])
def test_an_archive_that_is_damaged_or_has_a_password(here, member, password):
    with zipfile.ZipFile("a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(member, "0 1 2\n" * 40)
        archive.writestr(f"{member[:-3]}shx", "")
    data = Path("a.zip").read_bytes()
    begin = 30 + len(member)
    damaged = data[:begin] + b"\xff" * 9 + data[begin + 9:]
    for head, at in ((b"PK\3\4", 4), (b"PK\1\2", 6)):     # where the first bit of the flags says that it is encrypted
        data = re.sub(re.escape(head) + b"." * at, lambda found: found[0][:-2] + b"\1\0", data, flags=re.DOTALL)
    Path("a.zip").write_bytes(data if password else damaged)
    with pytest.raises(SlopeError, match="^a.zip") as raised:
        vectors.read_vector_layer("a.zip", "Polygon") if member in ("a.geojson",
                                                                    "a.shp") else rasters.read_raster("a.zip")
    assert ("a.zip: must be a whole archive without a password" in str(raised.value)) or not password
    Path("a.asc.gz").write_bytes(b"garbage")
    with pytest.raises(SlopeError, match="^a.asc.gz: must be a whole archive"):
        rasters.read_raster("a.asc.gz")
    with pytest.raises(FileNotFoundError), zips.open_text("gone.asc"):      # no archive
        pass


@pytest.mark.parametrize("name", ["A.HGT", "a.dt2", "a.asc.gz", "a.vrt", "a.tif", "folder/w001001.adf"])
def test_the_names_of_rasters(name):
    assert rasters.is_raster(name)


def test_several_rasters_in_a_zip_are_merged(made, slope, here):
    tif("a.tif", columns=6)
    tif("b.tif", columns=6, east=EAST + 5)
    with zipfile.ZipFile("both.zip", "w") as archive:
        archive.write("a.tif")
        archive.write("b.tif")
    assert in_place(made("both.zip"))
    assert yaml.safe_load(Path("out.yaml").read_text())["sources"] == ["both.zip"]
    with pytest.raises(Exception, match="both.zip: must hold one raster; unpack it, it holds a.tif, b.tif, got 2 "):
        rasters.read_raster("both.zip")
    write("a.xyz", points())
    Path("a.xyz.gz").write_bytes(gzip.compress(Path("a.xyz").read_bytes()))
    assert in_place(made("a.xyz.gz"))
    with zipfile.ZipFile("points.zip", "w") as archive:
        archive.writestr("a.las", "LASF")
    assert not rasters.is_raster("points.zip")
    assert "pdal" in slope("points.zip -o x.asc")[2]
    with zipfile.ZipFile("zips.zip", "w") as archive:
        archive.write("both.zip")
    with tarfile.open("a.tar.gz", "w:gz") as archive:
        archive.add("a.tif")
    for name in ("zips.zip", "a.tar.gz"):
        assert "unpack it" in slope(f"{name} -o x.asc")[2]


# --- tiles ---

@pytest.mark.parametrize("shift", [0.36, 0.9675, -0.2, 0.0675])
def test_tiles_of_another_phase_come_to_one_grid(made, slope, here, shift):
    """A plane, so that what is between two centres is known; the second tile begins where the first one ends."""
    plane = [300 + 0.31 * (x - EAST) - 0.17 * (y - NORTH) for x, y in
             (points().T[:2], points(east=EAST + 11 + shift, north=NORTH - shift).T[:2])]
    tif("a.tif", z=plane[0].reshape(ROWS, COLUMNS))
    tif("b.tif", z=plane[1].reshape(ROWS, COLUMNS), east=EAST + 11 + shift, north=NORTH - shift)
    refused(slope, "a.tif b.tif", "b.tif: grid: must share the grid of a.tif, cells of 1 x 1 from 459999.5 101007.5, "
            "unless a --cell is given, to which all are resampled, such as --cell 1, got cells of 1 x 1 from ")
    box = f" --bounds {EAST + 7} {NORTH + 1} {EAST + 15} {NORTH + 5}"
    for order in ("a.tif b.tif", "b.tif a.tif", f"a.tif b.tif{box}", "b.tif a.tif --crs EPSG:6676 --cell 2"):
        z, east, north, out, _ = made(f"{order} --cell 1" if "--cell" not in order else order)
        if "6676" in order:
            east, north = crs.transform(CRS.from_string("EPSG:6676"), CRS.from_string(CRS_M), east, north)
        known = np.isfinite(z)
        assert "1 of 2 rasters resampled to the grid of the finest" in out
        assert np.abs(z - (300 + 0.31 * (east - EAST) - 0.17 * (north - NORTH)))[known].max() < 0.0011
        assert known[2:-2].all()        # nothing is missing where they meet


def test_the_finest_tile_gives_the_grid(made, here):
    tif("coarse.tif", step=2.0, columns=6, rows=5)
    tif("fine.tif", step=0.9993671653521061, columns=20, rows=12, east=EAST + 12, north=NORTH)
    z, east, north, *_ = made("coarse.tif fine.tif --cell 1")
    fine = east > EAST + 13.5
    assert np.nanmax(np.abs(z - ground(east, north))[fine]) < 0.011
    assert np.isfinite(z[fine & (north > NORTH + 0.5)]).all()


def test_tiles_that_differ_are_refused_or_said(made, slope, here):
    """5 m at the median is an error, which --differ accepts; else the largest difference is said, with its place."""
    tif("a.tif")
    high = points()[:, 2].reshape(ROWS, COLUMNS) + 5.1
    tif("b.tif", z=high)
    refused(slope, "a.tif b.tif", "b.tif: must have the heights of the files before it, to 5 m at the median, got 5.1 "
            "m in 88 cells, up to 5.1 m at east 460000, north 101007")
    *found, out, err = made("a.tif b.tif --differ 6")
    assert in_place(found) and "differ by up to 5.1 m" in err and "heights differ by up to 5.100 m" in out
    spot = high - 5.1
    spot[2, 3] += 30
    tif("b.tif", z=spot)
    err = made("a.tif b.tif")[4]
    assert "b.tif: its heights differ by up to 30.0 m" in err and "at east 460003, north 101005" in err
    tif("b.tif", z=high - 4.3)
    assert made("a.tif b.tif")[4] == ""


def test_a_step_where_tiles_meet_is_refused_or_said(made, slope, here):
    """Other heights of one of two tiles that have no cell in common; --differ accepts them."""
    z = points(rows=30, columns=24)[:, 2].reshape(30, 24)
    tif("a.tif", z=z[:, :12], rows=30)
    tif("b.tif", z=z[:, 12:] + 37, rows=30, east=EAST + 12)
    refused(slope, "a.tif b.tif", "b.tif: must meet a.tif without a step of more than 5 m at the median, --differ, got "
            "+37.0 m in 30 pairs of cells, as at east 460011, north 101014")
    refused(slope, "b.tif a.tif --differ 36", "a.tif: must meet b.tif without a step of more than 36 m, got -37.0 m")
    assert "b.tif: its heights are +37.0 m off those of a.tif" in made("a.tif b.tif --differ 40")[4]
    tif("b.tif", z=z[:, 12:] + 3, rows=30, east=EAST + 12)
    assert "b.tif: its heights are +3.0 m off those of a.tif" in made("a.tif b.tif")[4]
    tif("b.tif", z=z[:, 12:], rows=30, east=EAST + 12)
    *found, err = made("a.tif b.tif")
    assert in_place(found) and err == ""
    half = points(rows=30, columns=12, east=EAST + 12.5)[:, 2].reshape(30, 12)      # on another grid
    tif("b.tif", z=half + 3, rows=30, east=EAST + 12.5)
    assert "b.tif: its heights are +3.0 m off those of a.tif" in made("a.tif b.tif --cell 1")[4]


def rough(z):
    return z + np.random.default_rng(4).normal(0, 1, z.shape)


def terraces(z):
    return z + 4 * (np.arange(40) // 4)


def ragged_cliff(z):
    """From 0 to 12 m high along the seam."""
    return z + np.where(np.arange(40) < 20, 0, np.linspace(0, 12, 60)[:, None])


def cliff(at, rows):
    def change(z):
        z = z.copy()
        z[:rows, at:] += 12
        return z
    return change


@pytest.mark.parametrize("change, gap, step", [
    (np.copy, 0, 3.0), (rough, 0, 12.0), (cliff(20, 18), 0, 3.0), (np.copy, 1, 3.0), (np.copy, 2, 3.0),
    (np.copy, 3, None), (rough, 0, None), (cliff(20, 18), 0, None), (cliff(19, 60), 0, None),
    (cliff(21, 60), 0, None), (terraces, 0, None), (ragged_cliff, 0, None)])
@pytest.mark.parametrize("turn", range(4))
def test_the_ground_makes_no_step_of_two_files(change, gap, step, turn):
    """Rough ground, slopes, terraces, and a cliff over a part of the seam, or beside it, are of the ground."""
    x, y = np.meshgrid(np.arange(40.0), np.arange(60.0))
    z = change(0.9 * x - 0.4 * y + 4 * np.sin(y / 5) + 3 * np.cos(x / 6))
    known = x < 20, x >= 20 + gap
    one, other = (terrain.Placed(name, 0, 0, np.rot90(np.where(mask, z + more, np.nan), turn))
                  for name, mask, more in zip("ab", known, (0, step or 0)))
    found = terrain.seam(one, other, Affine.identity(), 20)
    assert (found is None) if step is None else abs(found["median"] - step) < 1.5 and found["pairs"] == 60


def test_tiles_that_meet_at_a_corner_or_overlap_have_no_seam():
    z = np.zeros((20, 20))
    one = terrain.Placed("a", 0, 0, z)
    for top, left in ((20, 20), (22, 0), (19, 0), (23, 0), (20, 12)):
        other = terrain.Placed("b", top, left, z + 9)
        found = terrain.seam(one, other, Affine.identity(), 20)
        assert (found is not None) == ((top, left) == (22, 0)), (top, left)


# --- windows ---

BLOCKS = {"tiled": True, "blockxsize": 256, "blockysize": 256, "compress": "lzw", "SPARSE_OK": True}


def test_of_a_large_file_only_the_window_is_read(here):
    """50,000 x 50,000 cells of 1 m, which would need 100 GB, in less than 0.5 GB."""
    with rasterio.open("large.tif", "w", driver="GTiff", height=50_000, width=50_000, count=1, dtype="float32",
                       crs="EPSG:3035", transform=Affine(1, 0, EAST - 30_000, 0, -1, NORTH + 30_000), nodata=-9999,
                       BIGTIFF="YES", **BLOCKS) as out:
        x, y = out.transform @ np.meshgrid(np.arange(29_900, 30_100) + 0.5, np.arange(29_900, 30_100) + 0.5)
        out.write(ground(x, y).astype("float32"), 1, window=Window(29_900, 29_900, 200, 200))
    code = ("import sys; sys.path[:0] = [sys.argv[1]]; from slope_tools import cli; sys.argv = ['slope', "
            "'terrain', 'large.tif', '--bounds', *sys.argv[2:], '-o', 'out.asc']; status = cli.main(); "
            "peak, = (line for line in open('/proc/self/status') if line.startswith('VmHWM')); "
            "assert int(peak.split()[1]) < 5e5, peak; sys.exit(status)")         # kB
    done = subprocess.run([sys.executable, "-c", code, str(TOOLS), *map(str, (EAST, NORTH, EAST + 60, NORTH + 40))],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "cropped to 60 x 40 of 50000 x 50000 cells" in done.stdout
    z, transform, _, offset = rasters.read_asc_local("out.asc")
    x, y = transform @ np.meshgrid(np.arange(z.shape[1]) + 0.5, np.arange(len(z)) + 0.5)
    assert in_place((z, x + offset[0], y + offset[1]))


@pytest.mark.parametrize("name", ["dem.tif", "dem.asc", "dem.xyz"])
@pytest.mark.parametrize("options", ["", "--cell 0.7", "--cell 3", "--crs EPSG:6676 --cell 1", "--fill 6"])
def test_a_window_is_a_part_of_the_whole(made, here, monkeypatch, options, name):
    """To the digit, holes at its side included."""
    z = points(columns=60, rows=50)[:, 2].reshape(50, 60)
    z[20:22, 29:32] = np.nan
    z = np.where(np.isnan(z), -9999.0, z)
    tif("dem.tif", columns=60, rows=50, z=z)
    box = [EAST + 20, NORTH + 15, EAST + 31, NORTH + 31]
    if "crs" in options:
        x, y = crs.transform(CRS.from_string(CRS_M), CRS.from_string("EPSG:6676"), *np.array(box).reshape(2, 2).T)
        box = [round(one) for one in (x[0], y[0], x[1], y[1])]
    bounds = " ".join(map(str, box))
    whole, transform = rasters.read_raster("dem.tif")[:2]
    if name == "dem.asc":
        made("dem.tif --origin 0 0")
        shutil.move("out.asc", name)
        os.remove("out.yaml")
    elif name == "dem.xyz":
        x, y = transform @ np.meshgrid(np.arange(60) + 0.5, np.arange(50) + 0.5)
        known = np.isfinite(whole)
        write(name, np.column_stack([x[known], y[known], whole[known]]))
    options += f" --assign-crs {CRS_M}"
    part = made(f"{name} {options} --bounds {bounds}")[0]
    monkeypatch.setattr("slope_tools.survey.local_terrain.needed",
                        lambda whole, *_: (0, len(whole.z), 0, whole.z.shape[1]))
    assert np.array_equal(part, made(f"{name} {options} --bounds {bounds}")[0], equal_nan=True)


def test_tiles_beside_the_window_are_not_read(made, here, monkeypatch):
    for k, j in itertools.product(range(3), range(2)):
        tif(f"t{k}{j}.tif", east=EAST + COLUMNS * k, north=NORTH + ROWS * j)
    names = " ".join(sorted(path.name for path in here.glob("t*.tif")))
    read = []
    inner = rasters.in_metres
    monkeypatch.setattr(rasters, "in_metres", lambda path, found, *more, **words: (
        read.append(found.stored.size), inner(path, found, *more, **words))[1])
    assert in_place(made(f"{names} --bounds {EAST + 8} {NORTH + 2} {EAST + 14} {NORTH + 4}"))
    assert 0 < sum(read[:6]) < 2 * COLUMNS * ROWS and read[:6].count(0) == 4


# --- feet ---

@pytest.mark.parametrize("unit, crs_", [("ft", CRS_M), ("US survey foot", CRS_M), ("ft", None),
                                        (None, f"{CRS_M}+6360"), ("ft", "EPSG:4326"), (None, "EPSG:4269+6360")])
def test_heights_in_feet_over_a_plan_that_is_not_are_asked_about(slope, made, here, unit, crs_):
    """A plan in degrees speaks for feet no more than one in metres."""
    degrees = "EPSG:4" in (crs_ or "")
    place = {"step": 2e-5, "east": 140.0, "north": 36.0} if degrees else {}
    tif("dem.tif", z=3300 + 3.1 * np.arange(COLUMNS) + 1.7 * np.arange(ROWS)[:, None], unit=unit, crs_=crs_, **place)
    status, _, err = slope(f"dem.tif -o out.asc --crs {CRS_M}")
    assert status == 2 and "--z-unit m if" in err and "--z-unit ft or us-ft" in err and err.count("got ") == 1
    rise = np.tan(np.radians([float(word) for word in err.replace(",", "").split() if word.replace(".", "").isdigit()]))
    cell = np.array([2e-5 * 111_195 * np.cos(np.radians(36)), 2e-5 * 111_195] if degrees else [1.0, 1.0])
    assert rise == pytest.approx(np.hypot(*(np.array([3.1, 1.7]) / cell)) * np.array([1, 0.3048]), rel=0.02)
    more = f"--crs {CRS_M} --cell 1" if degrees else ""
    assert np.nanmax(made(f"dem.tif --z-unit m {more}")[0]) > 3000 > 1100 > np.nanmax(
        made(f"dem.tif --z-unit us-ft {more}")[0])


@pytest.mark.parametrize("code, east, north", [(32632, 5e5, 5.1e6), (2056, 2.6e6, 1.2e6), (32719, 4e5, 8.1e6)])
def test_a_northing_first_without_a_head_is_seen_by_the_area_of_the_crs(made, slope, here, code, east, north):
    values = points() + [east - EAST, north - NORTH, 0]
    write("n.xyz", values, (1, 0, 2))
    status, _, err = slope(f"n.xyz --crs EPSG:{code} -o out.asc")
    assert status == 2 and f"area of EPSG:{code} (with x and y exchanged it would)" in err and "head" in err
    lines = Path("n.xyz").read_text().splitlines()
    Path("named.xyz").write_text("".join(f"P{k},{line}\n" for k, line in enumerate(lines)))
    status, _, err = slope(f"named.xyz --crs EPSG:{code} -o out.asc")
    assert status == 2 and f"area of EPSG:{code} (with x and y exchanged it would)" in err
    for head, columns in (("", (0, 1, 2)), ("N E Z", (1, 0, 2))):
        write("n.xyz", values, columns, head=head)
        z, x, y, *_ = made(f"n.xyz --crs EPSG:{code}")
        assert in_place((z, x - east + EAST, y - north + NORTH))


def test_a_virtual_raster_has_the_tags_of_its_files(slope, made, here):
    """gdalbuildvrt does not repeat them: of two tiles one says feet."""
    tif("a.tif")
    tif("b.tif", east=EAST + COLUMNS, unit="US survey foot")
    subprocess.run(["gdalbuildvrt", "-q", "both.vrt", "a.tif", "b.tif"], check=True)
    subprocess.run(["gdalbuildvrt", "-q", "of.vrt", "both.vrt"], check=True)
    for name in ("both.vrt", "of.vrt"):
        status, _, err = slope(f"{name} -o out.asc")
        assert status == 2 and "--z-unit m if" in err and err.endswith("got us-ft\n"), err
    assert in_place(made("of.vrt --z-unit m"))
    with zipfile.ZipFile("b.zip", "w") as packed:
        packed.write("b.tif")
    subprocess.run(["gdalbuildvrt", "-q", "packed.vrt", "/vsizip/b.zip/b.tif"], check=True)
    assert slope("packed.vrt -o packed.asc")[2].endswith("got us-ft\n")


def test_a_virtual_raster_of_two_units_or_other_values_has_no_unit_of_its_files(slope, here):
    """Over a plan in feet, too, where heights in feet need no confirmation."""
    tif("m.tif", crs_="EPSG:2227", unit="metre")
    tif("ft.tif", crs_="EPSG:2227", east=EAST + COLUMNS, unit="US survey foot")
    subprocess.run(["gdalbuildvrt", "-q", "mixed.vrt", "m.tif", "ft.tif"], check=True)
    status, _, err = slope("mixed.vrt --crs EPSG:26910 --cell 1 -o out.asc")
    assert status == 2 and "must have heights in one unit" in err and "metre in m.tif, US survey foot in ft.tif" in err
    subprocess.run("gdal_translate -q -of VRT -scale 0 1000 0 304.8 ft.tif scaled.vrt".split(), check=True)
    with rasterio.open("scaled.vrt") as source:
        assert rasters.unit_tag("scaled.vrt", source) == ""
    subprocess.run("gdal_translate -q -of VRT ft.tif same.vrt".split(), check=True)
    with rasterio.open("same.vrt") as source:
        assert rasters.unit_tag("same.vrt", source) == "US survey foot"


@pytest.mark.parametrize("code, at", [(3116, (-75.68, 4.53)), (6676, (137.31, 36.0)), (32632, (13.58, 47.3))])
def test_a_survey_may_go_on_beside_the_area_of_its_crs(made, here, code, at):
    """As a raster, and as points without a head."""
    east, north = np.round(Proj(code)(*at))
    write("n.xyz", points() + [east - EAST, north - NORTH, 0], (0, 1, 2))
    z, x, y, *_ = made(f"n.xyz --crs EPSG:{code}")
    assert in_place((z, x - east + EAST, y - north + NORTH))
    tif("n.tif", crs_=f"EPSG:{code}", east=east, north=north, z=points()[:, 2].reshape(ROWS, COLUMNS))
    assert made("n.tif")[0].shape == z.shape


# --- axes and north ---

LO19 = "ESRI:102562|EPSG:11297"       # in the database of PROJ since 2025


@pytest.mark.parametrize("code, sister", [("ESRI:102482", LO19), (2048, LO19), (5513, "EPSG:5514"),
                                          (2065, "EPSG:5221"), (3052, "a UTM zone")])
def test_axes_that_point_west_or_south_are_refused_with_the_sister(slope, here, code, sister):
    name = f"EPSG:{code}" if isinstance(code, int) else code
    tif("dem.tif", crs_="EPSG:32633")
    for arguments in (f"dem.tif --crs {name}", f"dem.tif --assign-crs {name}"):
        status, _, err = slope(f"{arguments} -o out.asc")
        assert status == 2 and re.search(sister, err) and "must point east and north" in err
        assert f"got {name if isinstance(code, int) else 'Hartebeesthoek94_Lo19'}, " in err
    tif("dem.tif", crs_=name)
    with pytest.raises(Exception, match="must point east and north"):
        rasters.read_asc_local("dem.tif")


@pytest.mark.parametrize("code, east, north, angle", [
    (3413, -2656540.0, 711220.0, "105 degrees west"), (3031, 1e6, 1e6, "45 degrees west"),
    (5514, -743100.0, -1045380.0, "8 degrees west"), (5221, -743100.0, -1045380.0, "8 degrees west"),
    (32654, 400000.0, 4000000.0, None)])
def test_a_grid_whose_north_is_not_north_is_said(made, code, east, north, angle):
    tif("dem.tif", east=east, north=north, z=300 + points()[:, 2].reshape(ROWS, COLUMNS), crs_=f"EPSG:{code}")
    err = made("dem.tif")[4]
    assert f"north of EPSG:{code} is {angle} of north here" in err if angle else "of north here" not in err


# --- the size of the survey's cells ---

def test_the_cells_of_a_survey_are_in_the_crs_that_is_assigned(here):
    tif("dem.tif", step=10.0, east=50.0, north=50.0, crs_="EPSG:4326", z=points()[:, 2].reshape(ROWS, COLUMNS) / 100)

    def surveyed(crs_, of):
        choices = OfMass.of({**of, "terrain": {**of["terrain"], "files": ["dem.tif"], "crs": crs_}})
        return site.terrain(choices, here, ignore, ignore)[1]["surveyed_cell"]
    assert surveyed("EPSG:31254", {"terrain": {"assign_crs": "EPSG:31254"}}) == 10
    of = {"terrain": {"z_unit": "m"}, "crs": {"assigned": {"dem.tif": "EPSG:2225"}}}
    assert surveyed("EPSG:26942", of) == pytest.approx(3.048, abs=1e-3)


def test_a_list_of_points_is_read_once(here, monkeypatch):
    """Also for the size of its cells."""
    write("a.xyz", points(2.0))
    parsed, read = [], xyz.read_xyz_grid
    monkeypatch.setattr(xyz, "read_xyz_grid", lambda name, form: parsed.append(name) or read(name, form))
    choices = OfMass.of({"terrain": {"files": ["a.xyz"], "crs": CRS_M}})
    assert site.terrain(choices, here, ignore, ignore)[1]["surveyed_cell"] == 2 and parsed == ["a.xyz"]


def test_a_vrt_without_a_crs_is_no_list_of_points(succeed):
    """Its second line is a name and numbers."""
    with rasterio.open("tile.tif", "w", driver="GTiff", height=4, width=5, count=1, dtype="float32",
                       transform=Affine(2, 0, 10, 0, -2, 50)) as out:
        out.write(np.arange(20.0, dtype="float32").reshape(1, 4, 5))
    rasterio.shutil.copy("tile.tif", "a.vrt", driver="VRT")
    lines = Path("a.vrt").read_text().splitlines()
    assert lines[1].split()[0] == "<GeoTransform>"
    succeed("a.vrt -o out.asc")
    assert rasters.read_asc_local("out.asc")[0].ravel().tolist() == list(range(20))
