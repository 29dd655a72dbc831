"""tools/slope terrain: survey rasters to terrain.asc, against planes, whose heights are known everywhere."""
import os
import re
import resource
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
import rasterio
import rasterio.warp
import yaml
from affine import Affine
from rasterio.crs import CRS

import country_grids
from messages import says
from run_helpers import examples

from slope_tools.survey import crs, local_terrain, marks, plausible, rasters

TOP = Path(__file__).resolve().parents[2]
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
COMMAND = "terrain"
CRS_M = "EPSG:6677"               # metres, zone IX of Japan
EAST, NORTH = -12000.0, 34000.0   # lower left corner of the surveys below
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
MM = 0.0005 + 1e-9                # heights are written in whole mm


def plane(x, y):
    """Height (m) of the test slope at east x, north y (m): 0.3 up to the east, 0.7 down to the north."""
    return 500 + 0.3 * (x - EAST) - 0.7 * (y - NORTH)


def centres(transform, shape):
    """East and north of the cell centres, each of that shape."""
    return transform @ np.meshgrid(np.arange(shape[1]) + 0.5, np.arange(shape[0]) + 0.5)


def survey(columns=20, rows=16, cell=5.0, east=EAST, north=NORTH):
    """Heights of the plane on a grid, and its transform."""
    transform = Affine(cell, 0, east, 0, -cell, north + rows * cell)
    return plane(*centres(transform, (rows, columns))), transform


def write_tif(path, z, transform, crs=CRS_M, nodata=-9999.0, dtype="float64", tags=None):
    """Write heights (rows, columns), or several bands of them, NaN as nodata if that is not None."""
    bands = np.reshape(z, (-1, *np.shape(z)[-2:]))
    if nodata is not None:
        bands = np.where(np.isnan(bands), nodata, bands)
    with rasterio.open(path, "w", driver="GTiff", height=bands.shape[1], width=bands.shape[2], count=len(bands),
                       dtype=dtype, crs=crs, transform=transform, nodata=nodata) as out:
        out.write(bands.astype(dtype))
        for name, value in (tags or {}).items():
            setattr(out, name, value)
    return path


def asc_text(z, x, y, cell, where="corner", nodata="NODATA_value -9999\n"):
    """An ESRI ASCII grid; x, y of the lower left corner, or of the lower left cell's centre."""
    rows = "\n".join(" ".join("-9999" if np.isnan(value) else repr(float(value)) for value in row) for row in z)
    return (f"ncols {z.shape[1]}\nnrows {z.shape[0]}\nxll{where} {x!r}\nyll{where} {y!r}\ncellsize {cell!r}\n"
            f"{nodata}{rows}\n")


@pytest.fixture
def written(slope):
    """Run it, which must succeed; gives heights, east and north of the centres, the sidecar, stdout."""
    def run(arguments):
        status, out, err = slope(f"{arguments} --overwrite -o out.asc")
        assert status == 0, err
        z, transform, _, offset = rasters.read_asc_local("out.asc")
        east, north = centres(Affine.translation(*offset) @ transform, z.shape)
        return z, east, north, yaml.safe_load(Path("out.yaml").read_text()), out
    return run


def assert_plane(z, east, north, tolerance=MM):
    known = np.isfinite(z)
    assert known.any()
    assert np.abs(z - plane(east, north))[known].max() <= tolerance


# --- what is written ---

def test_the_file_to_the_letter(slope, here):
    (here / "dem.asc").write_text("ncols 3\nnrows 2\nxllcorner 100.25\nyllcorner -7.5\ncellsize 2.5\n"
                                  "NODATA_value -1\n1 2.12349 -1\n-0.0001 1234.5675001 6\n")
    status, out, err = slope("dem.asc -o out.asc --crs EPSG:6677")
    assert (status, err) == (0, "")
    assert (here / "out.asc").read_bytes() == (
        b"ncols 3\nnrows 2\nxllcorner 0.25\nyllcorner 0.5\ncellsize 2.5\nNODATA_value -9999\n"
        b"1.000 2.123 -9999\n0.000 1234.568 6.000\n")
    assert out.splitlines() == [
        "dem.asc has no CRS: taken as EPSG:6677",
        "out.asc: 3 x 2 cells of 2.5 m, x 0.250 to 7.750, y 0.500 to 5.500, z 0.000 to 1234.568 m, 1 NODATA cells, "
        "local origin at east 100, north -8",
        "region ground terrain out.asc"]
    about = yaml.safe_load((here / "out.yaml").read_text())
    assert about.pop("crs")["epsg"] == 6677
    assert about == {"origin": {"east": 100, "north": -8}, "cell": 2.5, "size": {"columns": 3, "rows": 2},
                     "extent": {"xlo": 0.25, "xhi": 7.75, "ylo": 0.5, "yhi": 5.5},
                     "height": {"min": 0.0, "max": 1234.568}, "nodata_cells": 1, "filled_cells": 0,
                     "sources": ["dem.asc"], "steps": ["dem.asc has no CRS: taken as EPSG:6677"]}
    assert sorted(os.listdir()) == ["dem.asc", "out.asc", "out.yaml"]


def test_an_assigned_crs_overrides_the_tag(slope, written, here):
    """A wrong tag, a missing one, and the sidecar of an .asc; --crs then reprojects from the assigned CRS."""
    z, transform = survey()
    write_tif("right.tif", z, transform)
    right = slope("right.tif -o right.asc")
    assert (right[0], right[2]) == (0, "")
    write_tif("wrong.tif", z, transform, crs="EPSG:6676")
    status, out, err = slope(f"wrong.tif -o wrong.asc --assign-crs {CRS_M}")
    assert (status, err) == (0, "") and out.splitlines()[0] == f"wrong.tif says EPSG:6676: taken as {CRS_M}"
    assert (here / "wrong.asc").read_bytes() == (here / "right.asc").read_bytes()
    assert yaml.safe_load((here / "wrong.yaml").read_text())["crs"]["epsg"] == 6677
    (here / "none.asc").write_text(asc_text(z, EAST, NORTH, 5.0))
    assert slope(f"none.asc -o none_out.asc --assign-crs {CRS_M}")[0] == 0
    assert yaml.safe_load((here / "none_out.yaml").read_text())["crs"]["epsg"] == 6677
    assert slope("right.asc -o moved.asc --assign-crs EPSG:6676")[0] == 0
    moved = yaml.safe_load((here / "moved.yaml").read_text())
    assert moved["crs"]["epsg"] == 6676 and moved["origin"]["east"] == EAST
    about = written(f"wrong.tif --assign-crs {CRS_M} --crs EPSG:32654")[3]
    direct = written("right.tif --crs EPSG:32654")[3]
    assert about["origin"] == direct["origin"] != moved["origin"]


def test_corner_and_center_headers_and_geotiff_are_one_raster(slope, here):
    z, transform = survey()
    z[3, 4] = np.nan
    (here / "corner.asc").write_text(asc_text(z, EAST, NORTH, 5.0))
    (here / "center.asc").write_text(asc_text(z, EAST + 2.5, NORTH + 2.5, 5.0, "center"))
    write_tif("dem.tif", z, transform)
    results = set()
    for name in ("corner.asc", "center.asc", "dem.tif"):
        assert slope(f"{name} --overwrite -o out.asc --crs {CRS_M}")[0] == 0
        results.add((here / "out.asc").read_bytes())
    assert len(results) == 1


@pytest.mark.parametrize("change", [
    lambda text: text.replace("\n", "\r\n"),
    lambda text: text.upper(),
    lambda text: text.replace("NODATA_value -9999\n", ""),           # -9999 is ESRI's default
    lambda text: text.replace("cellsize 5.0", "dx 5.0\ndy 5.0"),
    lambda text: text[:120] + text[120:].replace(" ", "\n", 40),     # wrapped rows
    lambda text: text.replace("-9999 ", "nan "),
], ids=["crlf", "upper case", "no NODATA_value", "dx dy", "wrapped", "nan"])
def test_spellings_of_an_ascii_grid(written, here, change):
    z, _ = survey()
    z[0, 0] = np.nan
    (here / "dem.asc").write_bytes(change(asc_text(z, EAST, NORTH, 5.0)).encode())
    got, east, north, about, _ = written("dem.asc")
    assert_plane(got, east, north)
    assert np.argwhere(np.isnan(got)).tolist() == [[0, 0]] and about["nodata_cells"] == 1


def test_origin(written):
    z, transform = survey(east=EAST + 0.75)
    write_tif("dem.tif", z, transform)
    for option, origin, corner in (("", (-12000, 34000), (0.75, 0)), ("--origin auto", (-12000, 34000), (0.75, 0)),
                                   ("--origin -12100.5 33000", (-12100.5, 33000), (101.25, 1000)),
                                   ("--origin 0 0", (0, 0), (EAST + 0.75, NORTH))):
        _, east, north, about, _ = written(f"dem.tif {option}")
        assert about["origin"] == {"east": origin[0], "north": origin[1]}
        assert (about["extent"]["xlo"], about["extent"]["ylo"]) == corner
        assert (east.min(), north.min()) == (EAST + 0.75 + 2.5, NORTH + 2.5)


def test_a_written_terrain_is_an_input_again(written, here):
    write_tif("dem.tif", *survey())
    written("dem.tif --origin -12345 33000")
    (here / "out.asc").rename("first.asc")
    (here / "out.yaml").rename("first.yaml")
    z, east, north, about, _ = written("first.asc --cell 10")
    assert about["crs"]["epsg"] == 6677
    assert_plane(z, east, north, 2 * MM)
    assert east.min() == EAST + 5


def test_round_trip_of_the_reader(written):
    z, transform = survey()
    z[2, 3] = np.nan
    write_tif("dem.tif", z, transform)
    written("dem.tif")
    raster = rasters.read_asc_local("out.asc")
    assert np.allclose(raster.z, z, rtol=0, atol=MM, equal_nan=True)
    assert raster.crs == CRS.from_string(CRS_M)
    assert raster.offset == (EAST, NORTH)
    assert raster.transform == Affine(5, 0, 0, 0, -5, 80)
    Path("out.yaml").unlink()
    assert rasters.read_asc_local("out.asc")[2:] == (None, (0, 0))


# --- resampling, cropping ---

@pytest.mark.parametrize("cell, size", [(1, (96, 76)), (2.5, (38, 30)), (3, (32, 25)), (4.9, (19, 15)), (5, (20, 16)),
                                        (7, (14, 11)), (10, (10, 8)), (16, (6, 5)), (20, (5, 4))])
def test_resampling_keeps_a_plane(written, cell, size):
    write_tif("dem.tif", *survey())
    z, east, north, about, out = written(f"dem.tif --cell {cell}")
    assert_plane(z, east, north)
    assert not np.isnan(z).any()
    assert about["cell"] == cell and (about["size"]["columns"], about["size"]["rows"]) == size
    assert ("resampled, cells of 5 x 5 m" in out) == (cell != 5)


def test_larger_cells_are_means_not_samples(written):
    z, transform = survey()
    z += np.random.default_rng(3).normal(0, 5, z.shape)
    write_tif("dem.tif", z, transform)
    got = written("dem.tif --cell 20")[0]
    assert np.allclose(got, z.reshape(4, 4, 5, 4).mean(axis=(1, 3)), rtol=0, atol=MM)


def test_rounding_does_not_cost_cells(written):
    """Three new cells to an old one: every third centre is an old one, also the outermost, and beside a hole."""
    cell = 0.1
    z, transform = survey(cell=cell)
    z[5, 5] = np.nan
    write_tif("dem.tif", z, transform)
    got, east, north, about, _ = written(f"dem.tif --cell {cell / 3!r}")
    assert about["size"] == {"columns": 3 * 19 + 1, "rows": 3 * 15 + 1}
    assert_plane(got, east, north)
    assert about["nodata_cells"] == 5 * 5  # between the neighbours' centres, these not included


def test_resampling_does_not_reach_into_nodata(written):
    z, transform = survey()
    z[5:7, 8:11] = np.nan
    write_tif("dem.tif", z, transform)
    got, east, north, _, _ = written("dem.tif --cell 1")
    assert_plane(got, east, north)
    hole = Affine.translation(8, 5), Affine.translation(11, 7)  # outer edges of the hole; heights end half a cell off
    (west, top), (right, bottom) = (transform @ step @ (0, 0) for step in hole)
    empty = (east > west - 2.5) & (east < right + 2.5) & (north < top + 2.5) & (north > bottom - 2.5)
    assert (np.isnan(got) == empty).all()


@pytest.mark.parametrize("name, transform", [
    ("non-square", Affine(5, 0, EAST, 0, -4, NORTH + 80)),
    ("south up", Affine(5, 0, EAST, 0, 5, NORTH)),
    ("turned", Affine.translation(EAST, NORTH + 80) @ Affine.rotation(-20) @ Affine.scale(5, -5)),
])
def test_other_grids_are_resampled_to_a_north_up_square_one(written, name, transform):
    write_tif("dem.tif", plane(*centres(transform, (16, 20))), transform)
    z, east, north, about, out = written("dem.tif")
    assert_plane(z, east, north)
    assert about["cell"] == pytest.approx(4 if name == "non-square" else 5, rel=1e-6)
    assert "resampled, cells of 5 x " in out
    assert np.isfinite(z).sum() * about["cell"] ** 2 > 0.8 * 20 * 16 * abs(transform.determinant)


def test_crop_takes_whole_cells(written):
    z, transform = survey()
    write_tif("dem.tif", z, transform)
    got, east, north, _, out = written(f"dem.tif --bounds {EAST + 11} {NORTH + 20} {EAST + 40} {NORTH + 33}")
    assert "cropped to 6 x 3 of 20 x 16 cells" in out
    assert np.allclose(got, z[9:12, 2:8], rtol=0, atol=MM)
    assert (east.min(), east.max()) == (EAST + 12.5, EAST + 37.5)
    assert (north.min(), north.max()) == (NORTH + 22.5, NORTH + 32.5)


def test_crop_with_a_cell_starts_at_the_corner(written):
    write_tif("dem.tif", *survey())
    z, east, north, about, _ = written(f"dem.tif --cell 2 --bounds {EAST + 11} {NORTH + 21} {EAST + 41} {NORTH + 31}")
    assert_plane(z, east, north)
    assert about["size"] == {"columns": 15, "rows": 5}
    assert (east.min(), north.min()) == (EAST + 12, NORTH + 22)


def test_bounds_beyond_the_input_are_cut_with_a_warning(slope):
    write_tif("dem.tif", *survey())
    status, out, err = slope(f"dem.tif -o out.asc --bounds {EAST - 100} {NORTH} {EAST + 50} {NORTH + 40}")
    assert status == 0 and "cropped to 10 x 8" in out
    assert err.startswith("slope terrain: warning: --bounds reaches beyond the input") and err.count("\n") == 1
    assert slope(f"dem.tif -o out.asc --bounds {EAST} {NORTH} {EAST + 100} {NORTH + 80}")[2] == ""


# --- reprojection ---

def degrees_survey(n=80, second=0.2):
    """The plane of EPSG:6677 on a grid of degrees (JGD2011) around EAST, NORTH, cells of 0.2 seconds of arc."""
    lon, lat = (values[0] for values in rasterio.warp.transform(CRS_M, "EPSG:6668", [EAST], [NORTH]))
    transform = Affine(second / 3600, 0, lon, 0, -second / 3600, lat)
    x, y = centres(transform, (n, n))
    east, north = rasterio.warp.transform("EPSG:6668", CRS_M, x.ravel(), y.ravel())
    return plane(np.reshape(east, (n, n)), np.reshape(north, (n, n))), transform


@pytest.mark.parametrize("option, cell", [("", 4.99), ("--cell 2", 2), ("--cell 12", 12)])
def test_degrees_to_metres(written, option, cell):
    write_tif("dem.tif", *degrees_survey(), crs="EPSG:6668")
    z, east, north, about, out = written(f"dem.tif --crs {CRS_M} {option}")
    assert "reprojected from EPSG:6668 to EPSG:6677" in out
    assert about["cell"] == cell and about["crs"]["epsg"] == 6677
    corner = about["origin"]["east"] + about["extent"]["xlo"], about["origin"]["north"] + about["extent"]["ylo"]
    assert np.allclose(np.divide(corner, cell), np.round(np.divide(corner, cell)), rtol=0, atol=1e-6)
    assert_plane(z, east, north, 0.001)  # GDAL's warper, whose points are off by up to 1/8 cell: 0.16 m
    assert np.isnan(z).mean() < 0.15


def test_metres_to_other_metres_with_bounds(written):
    """Zone VIII to zone IX: turned by more than a degree."""
    x, y = (values[0] for values in rasterio.warp.transform(CRS_M, "EPSG:6676", [EAST], [NORTH]))
    transform = Affine(5, 0, x, 0, -5, y)
    east, north = rasterio.warp.transform("EPSG:6676", CRS_M, *(a.ravel() for a in centres(transform, (100, 100))))
    write_tif("dem.tif", np.reshape(plane(np.array(east), np.array(north)), (100, 100)), transform, crs="EPSG:6676")
    z, east, north, about, _ = written(
        f"dem.tif --crs {CRS_M} --bounds {EAST + 100} {NORTH - 300} {EAST + 300} {NORTH - 200}")
    assert about["cell"] == 5 and about["size"] == {"columns": 40, "rows": 20} and about["nodata_cells"] == 0
    assert (east.min(), north.min()) == (EAST + 102.5, NORTH - 297.5)
    assert_plane(z, east, north, 0.001)


def test_an_esri_spelling_of_the_crs_is_not_reprojected(written, here):
    z, _ = survey()
    (here / "dem.asc").write_text(asc_text(z, EAST, NORTH, 5.0))
    (here / "dem.prj").write_text(CRS.from_string(CRS_M).to_wkt(version="WKT1_ESRI"))
    got, _, _, about, out = written(f"dem.asc --crs {CRS_M}")
    assert "reprojected" not in out and np.allclose(got, z, rtol=0, atol=MM)
    assert about["crs"]["epsg"] == 6677


def test_missing_crs(slope, here):
    z, _ = survey()
    (here / "dem.asc").write_text(asc_text(z, EAST, NORTH, 5.0))
    status, _, err = slope("dem.asc -o out.asc")
    assert status == 0 and err.startswith("slope terrain: note: dem.asc has no CRS") and err.count("\n") == 1
    assert yaml.safe_load((here / "out.yaml").read_text())["crs"] is None


# --- values ---

@pytest.mark.parametrize("units, option, factor", [
    ("ft", "--z-unit ft", 0.3048), ("US survey foot", "--z-unit us-ft", 1200 / 3937), ("", "--z-unit ft", 0.3048),
    ("m", "--z-unit us-ft", 1200 / 3937), ("ft", "--z-unit m", 1), ("", "--z-unit m", 1), ("unspecified", "", 1),
    ("Unknown", "", 1), (" ", "--z-unit ft", 0.3048), ("unspecified", "--z-unit ft", 0.3048)])
def test_heights_in_feet_become_metres(written, units, option, factor):
    z, transform = survey()
    write_tif("feet.tif", z / factor, transform, tags={"units": (units,)})
    *found, _, out = written(f"feet.tif {option}")
    assert_plane(*found)
    assert ("brought to metres" in out) == (factor != 1)
    assert ("taken as" in out) == (bool(option) and {"m": "m", "ft": "ft"}.get(units, option[9:]) != option[9:])


def test_a_crs_in_feet_with_the_unit_of_its_heights(written):
    """EPSG:2225, and the same with heights of NAVD88 in US survey feet, which says it."""
    z, transform = survey()
    for name, option, factor in (("EPSG:2225", "--z-unit us-ft", 1200 / 3937), ("EPSG:2225", "--z-unit m", 1.0),
                                 ("EPSG:2225+6360", "", 1200 / 3937)):
        write_tif("feet.tif", z, Affine(5, 0, 6e6, 0, -5, 2e6), crs=name)
        found, *_ = written(f"feet.tif --crs EPSG:26910 {option}")
        assert np.nanmax(found) == pytest.approx(z.max() * factor, abs=4), name


def test_pits_are_said_with_the_size_of_the_largest(slope, written):
    z, transform = survey()
    z[5, 5] = z[8, 3:5] = 0.0
    write_tif("pits.tif", z, transform)
    _, _, err = slope("pits.tif -o out.asc")
    assert "3 cells of 0 m lie at least" in err and "--nodata 0 makes them NODATA, with --fill 2 they are filled" in err
    found = written("pits.tif --nodata 0 --fill 2")
    assert_plane(*found[:3])
    assert np.isfinite(found[0]).all() and slope("pits.tif --nodata 0 -o out.asc")[2] == ""


F32 = float(np.finfo("float32").min)
SURFER = 1.70141e38
HOLE = np.s_[6:8, 5:8]      # 6 cells


def with_hole(path, value, dtype="float32", unit=None, factor=1.0, **tags):
    """A survey in a type and a unit, whose six cells hold a value as it is stored."""
    z, transform = survey()
    z = (z / factor).astype(dtype)
    z[HOLE] = value
    return write_tif(path, z, transform, nodata=None, dtype=dtype, tags={"units": (unit or "",), **tags})


def confirmed(unit):
    """The option without which a plan in metres has no heights in feet."""
    return {None: "", "ft": " --z-unit ft", "US survey foot": " --z-unit us-ft"}[unit]


def proposed(err):
    """The options that a message proposes."""
    return " ".join(re.findall(r"--nodata [^ ]+", err))


@pytest.mark.parametrize("value, dtype, unit, factor", [
    (F32, "float32", None, 1), (F32, "float64", None, 1), (-1.7976931348623157e308, "float64", None, 1),
    (1e31, "float32", None, 1), (1e31, "float64", None, 1), (SURFER, "float32", None, 1), (-9999.9, "float32", None, 1),
    (-32767.1, "float32", None, 1), (-32768, "int16", None, 1), (-32767, "int16", None, 1), (65535, "uint16", None, 1),
    (-2147483648, "int32", None, 1), (-99999, "float32", "ft", 0.3048), (-9999, "float32", "ft", 0.3048),
    (-9999, "int16", "US survey foot", 1200 / 3937), (-32768, "float32", "ft", 0.3048), (30000, "int16", "ft", 0.3048)])
def test_the_nodata_that_an_error_proposes_works(slope, written, value, dtype, unit, factor):
    with_hole("dem.tif", value, dtype, unit, factor)
    status, _, err = slope("dem.tif -o out.asc")
    assert status == 2 and "row 7 column 6: must be a height in " in err and err.count("\n") == 1
    assert float(proposed(err).split()[1]) == pytest.approx(value, rel=1e-7)
    z, *_ = written(f"dem.tif {proposed(err)}{confirmed(unit)}")
    assert np.isnan(z[HOLE]).all() and np.isnan(z).sum() == 6


@pytest.mark.parametrize("value, dtype, unit, factor, words", [
    (-3276.8, "float32", None, 1, "6 cells of -3276.8 m lie at least"),
    (-999, "float32", "ft", 0.3048, "6 cells of -304.495 m (-999 in the file) lie at least"),
    (-999, "int16", None, 1, "6 cells of -999 m lie at least"), (0, "uint16", None, 1, "6 cells of 0 m lie at least"),
    (-500, "float32", None, 1, "6 cells of -500 m lie at least"),
    (9999, "float32", "ft", 0.3048, "6 cells of 3047.7 m (9999 in the file) lie at least 2561 m above")])
def test_the_nodata_that_a_warning_of_pits_proposes_works(slope, written, value, dtype, unit, factor, words):
    with_hole("dem.tif", value, dtype, unit, factor)
    status, _, err = slope(f"dem.tif -o out.asc{confirmed(unit)}")
    assert status == 0 and words in err and f"{proposed(err)} makes them NODATA, with --fill 6 they are filled" in err
    z, *_ = written(f"dem.tif {proposed(err)}{confirmed(unit)}")
    assert np.isnan(z[HOLE]).all() and np.isnan(z).sum() == 6
    assert slope(f"dem.tif {proposed(err)} --fill 6 -o out.asc{confirmed(unit)}")[2] == ""


def test_the_largest_number_of_a_type_is_a_mark(slope, written):
    """65535 of heights in centimetres, which stands for 655.35 m; a collar of a mark is not filled."""
    with_hole("dem.tif", 65535, "uint16", factor=0.01, scales=(0.01,))
    err = slope("dem.tif -o out.asc")[2]
    assert "6 cells of 655.35 m (65535 in the file) lie at least" in err and " m above all cells beside them" in err
    assert np.isnan(written(f"dem.tif {proposed(err)}")[0][HOLE]).all()
    z, transform = survey()
    z[:, :4] = -999
    write_tif("collar.tif", z, transform, nodata=None)
    err = slope("collar.tif -o collar.asc")[2]
    assert "64 cells of -999 m" in err
    assert "--nodata -999 makes them NODATA, which stays where it goes on to the edge" in err


def test_a_mark_of_scaled_heights_is_that_of_the_file(slope, written):
    """Heights in decimetres: -9999 stands for -999.9 m, which may be a height, -32768 for -3276.8."""
    for value, shown in ((-9999, "-999.9 m (-9999 in the file)"), (-32768, "-3276.8 m (-32768 in the file)")):
        with_hole("dem.tif", value, "int16", factor=0.1, scales=(0.1,))
        err = slope("dem.tif -o out.asc")[2]
        assert f"6 cells of {shown} lie" in err and proposed(err) == f"--nodata {value}"
        assert np.isnan(written(f"dem.tif --nodata {value}")[0][HOLE]).all()


@pytest.mark.parametrize("given", ["-3.4028234663852886e+38", "-3.4028235e+38", "-3.40282e+38", "-3.4e38"])
def test_a_huge_mark_may_have_few_digits(slope, here, given):
    with_hole("dem.tif", F32)
    with_hole("dem64.tif", F32, "float64")
    for name in ("dem", "dem64"):
        assert slope(f"{name}.tif --nodata {given} -o {name}.asc")[::2] == (0, "")
        assert yaml.safe_load((here / f"{name}.yaml").read_text())["nodata_cells"] == 6
    text = asc_text(survey()[0], EAST, NORTH, 5.0, nodata=f"NODATA_value {given}\n")
    (here / "grid.asc").write_text(text.rsplit(" ", 1)[0] + " -3.40282346638529e+38\n")
    assert slope("grid.asc --crs EPSG:6677 -o out.asc")[::2] == (0, "")


def test_a_mark_of_another_type(slope, here):
    """-9999.9 in single precision is another number than -9999.9; a height beside a mark stays."""
    with_hole("dem.tif", float(np.float32(-9999.9)), "float64")
    assert slope("dem.tif --nodata -9999.9 -o out.asc")[::2] == (0, "")
    z, transform = survey()
    z[0, 0], z[0, 1] = 520.3, 520.300001
    write_tif("dem.tif", z, transform)
    assert slope("dem.tif --nodata 520.3 -o out.asc")[0] == 0
    assert yaml.safe_load((here / "out.yaml").read_text())["nodata_cells"] == 1
    with_hole("dem.tif", -32768, "int16")
    for other in ("-32768.5", "32768", "-3.4e38"):
        status, _, err = slope(f"dem.tif --nodata {other} -o out.asc")
        assert status == 2 and f"--nodata {other.replace('.4e38', '.4e+38')} --nodata -32768" in err


def test_two_marks_are_given_one_after_the_other(slope, written):
    z, transform = survey()
    z[HOLE], z[2, 2] = -9999, -32768
    write_tif("dem.tif", z, transform, nodata=None)
    first = proposed(slope("dem.tif -o out.asc")[2])
    second = proposed(slope(f"dem.tif {first} -o out.asc")[2])
    assert (first, second) == ("--nodata -32768", "--nodata -32768 --nodata -9999")
    assert np.isnan(written(f"dem.tif {second}")[0]).sum() == 7


def test_a_mark_that_no_cell_has_is_said(slope, here):
    with_hole("dem.tif", -9999)
    write_tif("whole.tif", *survey(east=EAST + 100))
    status, _, err = slope("whole.tif --nodata -9999 -o out.asc")
    assert status == 0 and "--nodata -9999: no cell of the input has that value; its heights are 476.5 to 5" in err
    assert slope("dem.tif whole.tif --nodata -9999 -o both.asc")[2] == ""      # one of the tiles has it


@pytest.mark.parametrize("cell, least", [(1.0, 10.0), (10.0, 20.0)])
def test_a_pit_is_deeper_than_10_m_and_than_two_cells(cell, least):
    for height, found in ((least - 0.1, False), (least + 0.1, True)):
        z = np.full((9, 9), height)
        z[4, 4] = 0
        assert bool(plausible.pits(z, cell, marks.in_metres(z))) == found


def test_mountains_in_feet_are_no_marks(slope):
    z, transform = survey()
    write_tif("dem.tif", z / 0.3048 + 15000, transform, tags={"units": ("ft",)})
    assert slope("dem.tif -o out.asc --z-unit ft")[::2] == (0, "")


def test_level_ground_at_the_sea_is_no_pit(slope):
    z, transform = survey()
    z = np.maximum(z - np.median(z), 0.0)
    write_tif("coast.tif", z, transform)
    assert slope("coast.tif -o out.asc")[2] == ""


def test_scale_offset_and_mask_of_a_geotiff(written):
    transform = Affine(5, 0, EAST, 0, -5, NORTH)
    write_tif("dem.tif", np.array([[10, 20], [30, -1]]), transform, nodata=-1, dtype="int16",
              tags={"scales": (0.5,), "offsets": (100.0,), "units": ("metre",)})
    z = written("dem.tif")[0]
    assert z[0].tolist() == [105, 110] and z[1, 0] == 115 and np.isnan(z[1, 1])
    write_tif("dem.tif", np.array([[1, 2], [3, np.nan]]), transform, nodata=None)
    assert np.isnan(written("dem.tif")[0][1, 1])


# --- merging ---

def test_tiles_merge_to_the_whole(written, slope, here):
    z, transform = survey()
    z[4, 4] = np.nan
    write_tif("whole.tif", z, transform)
    slope("whole.tif -o whole.asc")
    write_tif("a.tif", z[:, :12], transform)
    write_tif("b.tif", z[:10, 12:], transform @ Affine.translation(12, 0))
    (here / "c.asc").write_text(asc_text(z[10:, 12:], EAST + 60.002, NORTH, 5.0))  # a coordinate rounded: same grid
    _, _, _, about, out = written(f"c.asc b.tif a.tif --crs {CRS_M}")
    assert "merged 3 rasters; 0 cells in more than one" in out
    assert about["sources"] == ["c.asc", "b.tif", "a.tif"]
    assert (here / "out.asc").read_text().split()[12:] == (here / "whole.asc").read_text().split()[12:]


def test_overlap_and_gap(written):
    z, transform = survey()
    left, right = z[:, :8].copy(), z[:, 6:].copy() + 2
    left[0, 7] = np.nan
    write_tif("a.tif", left, transform)
    write_tif("b.tif", right, transform @ Affine.translation(6, 0))
    got, _, _, _, out = written("a.tif b.tif")
    assert "31 cells in more than one, the first file counts, heights differ by up to 2.000 m" in out
    expected = np.hstack([z[:, :8], z[:, 8:] + 2])
    expected[0, 7] += 2  # the first file has no height there
    assert np.allclose(got, expected, rtol=0, atol=MM)
    write_tif("c.tif", z[:, 15:], transform @ Affine.translation(15, 0))
    assert np.isnan(written("a.tif c.tif")[0][:, 8:15]).all()


# --- holes ---

def test_only_small_holes_inside_are_filled(written):
    z, transform = survey()
    known = z.copy()
    for row, column in ((3, 3), (4, 4), (8, 10), (0, 8), (12, 0)):  # a diagonal pair, one alone, two at the edge
        z[row, column] = np.nan
    z[10:13, 14:17] = np.nan                                       # nine
    write_tif("dem.tif", z, transform)

    for option, holes, cells, left in (("", 0, 0, 14), ("--fill 1", 1, 1, 13), ("--fill 2", 2, 3, 11),
                                       ("--fill 8", 2, 3, 11), ("--fill 9", 3, 12, 2), ("--fill 1000", 3, 12, 2)):
        got, _, _, about, out = written(f"dem.tif {option}")
        assert (about["filled_cells"], about["nodata_cells"]) == (cells, left)
        assert ("filled" in out) == bool(option)
        if option:
            assert f"filled {holes} NODATA holes of at most {option[7:]} cells, {cells} cells" in out
        assert np.nanmax(np.abs(got - known)) <= MM  # the plane goes through (GDAL's fillnodata: off by up to 2.6 m)


def test_a_large_hole_is_filled_by_the_plane(written):
    z, transform = survey(60, 60)
    z[10:45, 12:50] = np.nan
    z[20:22, 20:30] = 7  # heights inside the hole: an island
    write_tif("dem.tif", z, transform)
    got, east, north, about, _ = written("dem.tif --fill 2000")
    assert about["nodata_cells"] == 0 and about["filled_cells"] == 35 * 38 - 20
    z[20:22, 20:30] = plane(east, north)[20:22, 20:30]
    write_tif("dem.tif", z, transform)
    assert_plane(*written("dem.tif --fill 2000")[:3])


def test_small_holes_against_a_flood_fill():
    random = np.random.default_rng(7)
    for density in (0.1, 0.3, 0.5, 0.7):
        for _ in range(20):
            empty = random.random((13, 17)) < density
            expected, count = np.zeros_like(empty), 0
            todo = set(map(tuple, np.argwhere(empty)))
            while todo:
                group = [todo.pop()]
                for row, column in group:
                    near = {(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)} & todo
                    todo -= near
                    group += near
                if len(group) <= 4 and all(0 < r < 12 and 0 < c < 16 for r, c in group):
                    count += 1
                    expected[tuple(zip(*group))] = True
            mask, holes = local_terrain.small_holes(empty, 4)
            assert (mask == expected).all() and holes == count


# --- bad input: what test_wrong_inputs.py does not have ---

BAD_GRIDS = [       # a text of bad.asc, what replaces it, and what is said of it
    ("5.0 6.0", "5.0", "values: must be 2 rows of 3, 6 values, got 5, first at line 8, which has 2"),
    ("4.0 5.0 6.0\n", "", "values: must be 2 rows of 3, 6 values, got 3, in 1 rows"),
    ("3.0", "3.0 3.5", "values: must be 2 rows of 3, 6 values, got 7, first at line 7, which has 4"),
    ("6.0\n", "6.0\n7 8 9\n", "values: must be 2 rows of 3, 6 values, got 9, in 3 rows"),
    ("3.0\n4.0", "3.0 4.0\n", "values: must be 2 rows of 3, 6 values, got 6, first at line 7, which has 4"),
    ("xllcorner 0.0", "xllcorner west", "line 3: must be a name and a number, got xllcorner west"),
    ("cellsize 2.0", "cellsize 0", "header: cellsize: must be > 0, got 0"),
    ("cellsize 2.0", "cellsize 2.0\ncellsize 4.0", "line 6: header key cellsize is given twice"),
    ("yllcorner", "xllcenter 1.0\nyllcorner", "line 4: xllcorner and xllcenter are both given"),
    ("cellsize 2.0", "cellsize 2.0\ndx 4.0", "line 6: cellsize and dx are both given"),
    ("cellsize 2.0", "cellsize 2_0", "line 5: must be a name and a number, got cellsize 2_0")]
BAD_OPTIONS = [
    ("--z-unit metres", "argument --z-unit: invalid choice: 'metres'"),
    ("--crs EPSG:6668", "--crs: CRS must be in metres"), ("--crs EPSG:4978", "--crs: CRS must be in metres"),
    (f"--bounds {EAST + 1} {NORTH + 1} {EAST + 2} {NORTH + 2}", "output: must have at least 2 x 2 cells, got 1 x 1"),
    ("--cell 0.04", "--cell: must be at least 1/100 of the input's, 5 m, got 0.04"),
    ("--origin 5", "--origin: must be auto or two numbers, E N, got 5"), ("--fill -1", "--fill: must be >= 0, got -1")]


def bad_tif(**changes):
    z, transform = survey()
    return lambda: write_tif("bad.tif", **{"z": z, "transform": transform, **changes})


def moved(cells):
    return Affine(5, 0, EAST + 5 * cells, 0, -5, NORTH + 80 - 5 * int(cells))


def text(words, name="bad.asc"):
    return lambda: Path(name).write_text(words)


GRID = asc_text(np.array([[1., 2, 3], [4, 5, 6]]), 0.0, 0.0, 2.0)
BAD = [     # what is written, arguments, message
    (None, ". -o out.asc", ".: must be an existing file"),
    (text("hello\n", "bad.tif"), "bad.tif -o out.asc", "bad.tif: must be a raster"),
    (text(""), "bad.asc -o out.asc", "bad.asc: must be a raster"),
    *((text(GRID.replace(old, new)), "bad.asc -o out.asc", f"bad.asc: {words}") for old, new, words in BAD_GRIDS),
    *((None, f"ok.tif -o out.asc {options}", words) for options, words in BAD_OPTIONS),
    (bad_tif(dtype="complex64"), "bad.tif -o out.asc", "bad.tif: must hold real numbers, got complex64"),
    (bad_tif(transform=Affine(5, 0, 1e9, 0, -5, 1e9)), "bad.tif -o out.asc --crs EPSG:32654",
     "--crs: must cover the input, whose coordinates are in EPSG:6677 (--assign-crs EPSG:n"),
    (bad_tif(crs="EPSG:6676"), "ok.tif bad.tif -o out.asc",
     "bad.tif: CRS: must be that of ok.tif, EPSG:6677, got EPSG:6676"),
    (text(GRID), "ok.tif bad.asc -o out.asc", "bad.asc: CRS: must be that of ok.tif, EPSG:6677, got none"),
    (lambda: write_tif("bad.tif", *survey(cell=10.0)), "ok.tif bad.tif -o out.asc",
     "bad.tif: grid: must share the grid of ok.tif, cells of 5 x 5 from -12000 34080, got cells of 10"),
    (bad_tif(transform=moved(3.5)), "ok.tif bad.tif -o out.asc", "bad.tif: grid: must share the grid of ok.tif"),
    (bad_tif(transform=moved(10 ** 7)), "ok.tif bad.tif -o out.asc", "merged raster: must fit in the "),
    (bad_tif(z=np.where(np.arange(20) < 10, np.nan, survey()[0])),
     f"bad.tif -o out.asc --bounds {EAST} {NORTH} {EAST + 30} {NORTH + 30}",
     "--bounds: must hold a height, all cells are NODATA"),
    (None, "ok.tif -o out.tif", "-o: must be a file that ends in .asc, got out.tif"),
    (lambda: Path("x.asc").mkdir(), "ok.tif -o x.asc", "-o: must be a file that ends in"),
    (lambda: (text(GRID)(), text("size: 3\n", "bad.yaml")()), "bad.asc -o out.asc",
     "bad.yaml: must be a sidecar that `slope terrain` wrote")]


@pytest.mark.parametrize("make, arguments, message", BAD)
def test_bad_input_is_one_line_and_leaves_no_trace(slope, here, make, arguments, message):
    write_tif("ok.tif", *survey())
    if make:
        make()
    before = {path.name: path.is_file() and path.read_bytes() for path in here.iterdir()}
    status, _, err = slope(arguments)
    lines = [line for line in err.splitlines() if "warning: " not in line and "note: " not in line]
    assert status == 2 and len(lines) == 1 and says(lines[0], f"slope terrain: {message}"), err
    assert {path.name: path.is_file() and path.read_bytes() for path in here.iterdir()} == before


def test_output_too_large_says_how_much_memory(slope, monkeypatch):
    write_tif("ok.tif", *survey())
    monkeypatch.setattr(os, "sysconf", lambda name: {"SC_PAGE_SIZE": 1024, "SC_PHYS_PAGES": 1000}[name])
    assert slope("ok.tif -o out.asc --cell 2")[0] == 0
    status, _, err = slope("ok.tif -o out.asc --cell 0.5")
    assert (status, err) == (2, "slope terrain: output: must fit in the 0.00102 GB of memory of this machine, "
                                "got 200 x 160 cells, which need 0.00128 GB\n")


@pytest.mark.parametrize("cells", [20_000, 100_000])
def test_input_too_large_is_one_line(here, cells):
    """What the machine does not have, 16 or 400 GB, and what it has, but not for a process of 2 GB."""
    Path("huge.asc").write_text(f"ncols {cells}\nnrows {cells}\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n")
    done = subprocess.run([sys.executable, TOOLS / "slope", "terrain", "huge.asc", "-o", "out.asc"], text=True,
                          check=False, capture_output=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (2 ** 31, 2 ** 31)),
                          env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert done.stderr.startswith(("slope terrain: huge.asc: must fit in the ",
                                   "slope terrain: huge.asc: must be a raster that GDAL can read (Too large",     # 3.13
                                   "slope terrain: not enough memory: Unable to allocate 2.98 GiB")), done.stderr
    assert os.listdir() == ["huge.asc"]


def test_a_sidecar_of_another_grid_is_refused(written, slope, here):
    write_tif("dem.tif", *survey())
    written("dem.tif")
    (here / "out.asc").write_text(asc_text(survey(21)[0], 0.0, 0.0, 5.0))
    status, _, err = slope("out.asc -o again.asc")
    assert (status, err) == (2, "slope terrain: out.yaml: must be the sidecar of out.asc: size and extent differ\n")


@pytest.mark.parametrize("failing", ["safe_dump", "replace"])
def test_a_full_disk_leaves_the_old_files(slope, here, monkeypatch, failing):
    write_tif("dem.tif", *survey())
    assert slope("dem.tif -o out.asc")[0] == 0
    before = {path.name: path.read_bytes() for path in here.iterdir()}

    def full(*_, **__):
        raise OSError(28, "No space left on device")
    monkeypatch.setattr({"safe_dump": yaml, "replace": os}[failing], failing, full)
    assert slope("dem.tif -o out.asc --cell 10")[::2] == (
        2, "slope terrain: out.asc: cannot be written: No space left on device\n")
    assert {path.name: path.read_bytes() for path in here.iterdir()} == before


# --- the program ---

def test_the_program_itself(here):
    slope = TOOLS / "slope"
    assert slope.read_text().splitlines()[0] == "#!/usr/bin/python3"
    write_tif("cut.tif", *survey(200, 200))
    Path("cut.tif").write_bytes(Path("cut.tif").read_bytes()[:5000])
    write_tif("nowhere.tif", survey()[0], None, crs=None)
    for arguments, message in (("terrain cut.tif -o out.asc", "slope terrain: cut.tif: "),
                               ("terrain nowhere.tif -o out.asc", "slope terrain: nowhere.tif: "),
                               ("terrain none.tif -o out.asc --crs EPSG:999999", "slope terrain: --crs: "),
                               ("nothing", "slope: "), ("", "slope: ")):
        done = subprocess.run([slope, *arguments.split()], capture_output=True, text=True)
        assert done.returncode == 2 and done.stdout == ""
        assert done.stderr.startswith(message) and done.stderr.count("\n") == 1
    write_tif("dem.tif", *survey())
    done = subprocess.run([slope, "terrain", "dem.tif", "-o", "out.asc"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "") and done.stdout.endswith("\nregion ground terrain out.asc\n")


@pytest.mark.parametrize("command", [one for one in examples("terrain") if "FG-GML" not in one])  # these: test_fggml
def test_every_example_of_the_page_and_the_help_runs(slope, here, command):
    z, transform = degrees_survey(200)
    write_tif("north.tif", z[:100], transform, crs="EPSG:6668")
    write_tif("south.tif", z[100:], transform @ Affine.translation(0, 100), crs="EPSG:6668")
    z, transform = survey(200, 200)
    write_tif("survey.tif", z, transform)
    (here / "survey.asc").write_text(asc_text(z, EAST, NORTH, 5.0))
    x, y = centres(transform, z.shape)
    np.savetxt("points.xyz", np.column_stack([x[:9].ravel(), y[:9].ravel(), z[:9].ravel()]), fmt="%.3f")
    with zipfile.ZipFile("tiles.zip", "w") as archive:
        archive.write("north.tif")
        archive.write("south.tif")
    status, out, err = slope(command)
    assert (status, err) == (0, "")
    if "--help" not in command:
        assert out.endswith("\nregion ground terrain terrain.asc\n")


def test_a_real_survey(written):
    path = TOP.parent / "shared" / "data" / "hit.asc"
    if not path.exists():
        pytest.skip("needs hit.asc, the elevation model of Hintertux, which is not part of the package")
    z, east, north, about, _ = written(f"{path} --crs EPSG:31287")
    raw = np.loadtxt(path, skiprows=6)
    assert z.shape == (446, 526)
    assert (np.isnan(z) == (raw == -9999)).all() and np.nanmax(np.abs(z - np.where(raw == -9999, np.nan, raw))) <= MM
    assert (east[0, 0], north[-1, 0]) == pytest.approx((272771.421744369, 357502.69532628), abs=1e-6)
    assert about["origin"] == {"east": 272768, "north": 357500}
    coarse, _, _, about, _ = written(f"{path} --crs EPSG:31287 --cell 10 --fill 50")
    assert about["cell"] == 10 and abs(np.nanmean(coarse) - np.nanmean(z)) < 2


def test_a_copy_of_a_system_in_feet_is_another_system():
    """PROJ takes it for EPSG:6677 with a confidence of 50."""
    wkt = CRS.from_epsg(6677).to_wkt().replace('UNIT["metre",1', 'UNIT["US survey foot",0.304800609601219')
    wkt = wkt.replace(',AUTHORITY["EPSG","6677"]]', "]").replace(',AUTHORITY["EPSG","9001"]', "")
    feet = CRS.from_wkt(wkt)
    assert feet.linear_units_factor[1] == pytest.approx(0.3048006, rel=1e-6)
    assert rasters.epsg(feet) is None and rasters.epsg(CRS.from_epsg(6677)) == 6677
    assert not crs.same_crs(feet, CRS.from_epsg(6677))
    assert rasters.epsg(CRS.from_wkt(CRS.from_epsg(6677).to_wkt(version="WKT1_ESRI"))) == 6677


# --- the table of countries ---

COUNTRIES = {                   # first words of a row in gis.rst: functions of country_grids.py
    "Austria": ["austria", "canada", "norway"],
    "Bavaria": ["bavaria", "denmark", "england", "netherlands", "new_zealand", "spain", "taiwan"],
    "France, LiDAR": ["france_lidar"], "France, RGE": ["france_rge"], "Germany, Baden": ["baden_wuerttemberg"],
    "Germany, North": ["westphalia"], "Hong Kong": ["hong_kong"], "Italy": ["bologna"], "Poland": ["poland"],
    "Slovenia": ["slovenia"], "Switzerland": ["switzerland"], "USA": ["usa"], "Copernicus": ["glo_30"]}


def country_rows():
    """{first cell: what to type} of the table in gis.rst."""
    page = (TOP / "doc" / "src" / "gis.rst").read_text(encoding="ascii")
    table = page[page.index("Elevation models by country"):page.index("Coordinate systems\n")]
    return {row[0]: row[2].strip("`") for row in (re.split(r"\n     - ", part.strip())
                                                  for part in table.split("   * - ")[2:])}


def test_every_country_has_its_files():
    rows = [row for row in country_rows() if not row.startswith("Japan")]       # those: test_fggml.py
    assert [[name for name in COUNTRIES if row.startswith(name)] for row in rows] == [[name] for name in COUNTRIES]


@pytest.mark.parametrize("country, name", [(country, name) for country, names in COUNTRIES.items() for name in names])
def test_files_of_a_country_are_read_by_what_its_row_says(written, here, country, name):
    getattr(country_grids, name)()
    words = next(words for row, words in country_rows().items() if row.startswith(country))
    assert set(words.partition(" --")[0].split()) == {path.name for path in here.iterdir()}
    if "W S E N" in words:
        with rasterio.open(words.split()[0]) as raster:
            west, south, east, north = (float(value) for value in raster.bounds)
        words = words.replace("W S E N", f"{west + 5} {south + 5} {east - 5} {north - 5}")
    z, east, north, about, _ = written(words)
    known = np.isfinite(z)
    given = re.search(r"--crs EPSG:(\d+)", words)
    assert known.sum() > 300 and about["crs"] and (not given or about["crs"]["epsg"] == int(given[1]))
    if name == "glo_30":
        east, north = (np.reshape(values, z.shape) for values in
                       rasterio.warp.transform("EPSG:32632", "EPSG:4326", east.ravel(), north.ravel()))
    off = np.abs(z - country_grids.ground(east, north))[known].max()
    assert off < (0.2 if name == "glo_30" else 0.006), off
