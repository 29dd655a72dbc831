"""tools/slope terrain on FG-GML, the elevation tiles of Japan's GSI: every trap of the format, against what went in."""
import io
import os
import re
import shlex
import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest
import rasterio.warp
import yaml
from affine import Affine
from rasterio.crs import CRS

from messages import is_one
from run_helpers import examples

from slope_tools import cli
from slope_tools.survey import fggml, japan, rasters, terrain

TOP = Path(__file__).resolve().parents[2]
SECOND = 1 / 3600
GROUND, WATER, MISSING = "\u5730\u8868\u9762", "\u5185\u6c34\u9762", "\u30c7\u30fc\u30bf\u306a\u3057"
CENTRE = 36.625, 139.875    # south-west corner of the tiles below, in Tochigi: zone IX
CRS_M, FIRST = "EPSG:6677", (3600.0, 69300.0)    # a point near to it, for the plane


def plane(x, y):
    """Height (m) of the test slope at east x, north y (m)."""
    return 500 + 0.2 * (x - FIRST[0]) - 0.1 * (y - FIRST[1])


def tuples(z, kind=GROUND):
    return [f"{MISSING},-9999." if np.isnan(height) else f"{kind},{height:.2f}" for height in np.ravel(z)]


def xml(z=None, south=CENTRE[0], west=CENTRE[1], spacing=0.2, list_=None, start="0 0", srs="fguuid:jgd2011.bl",
        encoding="UTF-8", corner="{:.9f}", head="", shape=None):
    """A tile as GSI writes it: heights z (rows from the north), or a list of tuples of its own."""
    rows, columns = shape or z.shape
    list_ = tuples(z) if list_ is None else list_
    lower, upper = ((south, west), (south + rows * spacing * SECOND, west + columns * spacing * SECOND))
    lower, upper = (" ".join(corner.format(value) for value in pair) for pair in (lower, upper))
    return f"""<?xml version="1.0" encoding="{encoding}"?>
{head}<Dataset xsi:schemaLocation="http://fgd.gsi.go.jp/spec/2008/FGD_GMLSchema FGD_GMLSchema.xsd"
 xmlns:gml="http://www.opengis.net/gml/3.2" xmlns="http://fgd.gsi.go.jp/spec/2008/FGD_GMLSchema"
 xmlns:xlink="http://www.w3.org/1999/xlink" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" gml:id="Dataset1">
<gml:description>\u57fa\u76e4\u5730\u56f3\u60c5\u5831\u30e1\u30bf\u30c7\u30fc\u30bf ID=fmdid:15-3101</gml:description>
<gml:name>\u57fa\u76e4\u5730\u56f3\u60c5\u5831\u30c7\u30fc\u30bf\uff08GML\u7248\uff09</gml:name>
<DEM gml:id="DEM001">
<fid>fgoid:10-00100-15-60101-54394030</fid>
<lfSpanFr gml:id="DEM001-1"><gml:timePosition>2016-10-01</gml:timePosition></lfSpanFr>
<orgGILvl>0</orgGILvl>
<type>5m\u30e1\u30c3\u30b7\u30e5\uff08\u6a19\u9ad8\uff09</type>
<mesh>54394030</mesh>
<coverage gml:id="DEM001-3">
<gml:boundedBy>
<gml:Envelope srsName="{srs}">
<gml:lowerCorner>{lower}</gml:lowerCorner>
<gml:upperCorner>{upper}</gml:upperCorner>
</gml:Envelope>
</gml:boundedBy>
<gml:gridDomain>
<gml:Grid gml:id="DEM001-4" dimension="2">
<gml:limits>
<gml:GridEnvelope>
<gml:low>0 0</gml:low>
<gml:high>{columns - 1} {rows - 1}</gml:high>
</gml:GridEnvelope>
</gml:limits>
<gml:axisLabels>x y</gml:axisLabels>
</gml:Grid>
</gml:gridDomain>
<gml:rangeSet>
<gml:DataBlock>
<gml:rangeParameters><gml:QuantityList uom="DEM\u69cb\u6210\u70b9"></gml:QuantityList></gml:rangeParameters>
<gml:tupleList>
{chr(10).join(list_)}
</gml:tupleList>
</gml:DataBlock>
</gml:rangeSet>
<gml:coverageFunction>
<gml:GridFunction>
<gml:sequenceRule order="+x-y">Linear</gml:sequenceRule>
<gml:startPoint>{start}</gml:startPoint>
</gml:GridFunction>
</gml:coverageFunction>
</coverage>
</DEM>
</Dataset>
"""


def write_zip(path, members, change=None, compress=zipfile.ZIP_DEFLATED):
    """Write a zip of name -> text or bytes; change(info) edits what the directory says of each member."""
    with zipfile.ZipFile(path, "w", compress) as out:
        for name, text in members.items():
            out.writestr(name, text)
        for info in out.filelist:
            if change:
                change(info)


def centres(south, west, spacing, shape):
    """Longitude and latitude of the cell centres."""
    lon = west + (np.arange(shape[1]) + 0.5) * spacing * SECOND
    lat = south + (shape[0] - 0.5 - np.arange(shape[0])) * spacing * SECOND
    return np.meshgrid(lon, lat)


def slope_tile(south=CENTRE[0], west=CENTRE[1], spacing=0.2, shape=(30, 45)):
    """Heights of the plane of zone IX on a tile."""
    lon, lat = centres(south, west, spacing, shape)
    x, y = rasterio.warp.transform("EPSG:6668", CRS_M, lon.ravel(), lat.ravel())
    return plane(np.reshape(x, shape), np.reshape(y, shape))


@pytest.fixture
def slope(here, capsys):
    """Run `slope terrain ARGUMENTS -o out.asc`; gives status, stdout, stderr."""
    def run(arguments):
        capsys.readouterr()
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            status = cli.main(["terrain", *shlex.split(arguments), "-o", "out.asc"])
        return status, *capsys.readouterr()
    return run


@pytest.fixture
def written(slope):
    """Run it, which must succeed; gives heights, east and north of the centres, the sidecar, stdout, stderr."""
    def run(arguments):
        status, out, err = slope(arguments)
        assert status == 0, err
        z, transform, _, offset = rasters.read_asc_local("out.asc")
        rows, columns = np.indices(z.shape) + 0.5
        east, north = Affine.translation(*offset) @ transform @ (columns, rows)
        return z, east, north, yaml.safe_load(Path("out.yaml").read_text()), out, err
    return run


def one(text):
    """The one tile of a file with that content."""
    Path("tile.xml").write_bytes(text.encode() if isinstance(text, str) else text)
    tile, = fggml.read_fggml_tiles("tile.xml")
    return tile


def heights(shape=(7, 5), seed=1):
    return np.round(np.random.default_rng(seed).uniform(-5, 3000, shape), 2)


# --- round trip ---

@pytest.mark.parametrize("spacing", [1 / 30, 0.2, 0.4])
@pytest.mark.parametrize("corner", ["{:.9f}", "{:.12f}", "{!r}"])
def test_a_tile_comes_back_exactly(here, spacing, corner):
    """Heights to the bit, and the grid: its corner and spacing are multiples that the digits only hint at."""
    z = heights()
    z[0, 0] = z[3, 1:3] = np.nan
    tile = one(xml(z, spacing=spacing, corner=corner))
    assert np.array_equal(tile.raster.z, z, equal_nan=True)
    assert tile.raster.crs == CRS.from_epsg(6668) and tile.datum == "JGD2011" and tile.name == "tile.xml"
    t = tile.raster.transform
    assert (t.b, t.d, t.a, t.e) == (0, 0, -t.e, -t.a)
    assert t.a == pytest.approx(spacing * SECOND, rel=1e-14)
    assert t.c == pytest.approx(CENTRE[1], rel=1e-15)
    assert t.f == pytest.approx(CENTRE[0] + 7 * spacing * SECOND, rel=1e-15)


def test_other_spacings_stay_as_they_are(here):
    t = one(xml(heights(), south=36.0001, spacing=0.27)).raster.transform
    assert t.a == pytest.approx(0.27 * SECOND, rel=1e-5) and t.f == pytest.approx(36.0001 + 7 * 0.27 * SECOND, abs=1e-9)


@pytest.mark.parametrize("x, y", [(0, 0), (3, 0), (0, 2), (4, 6)])
@pytest.mark.parametrize("missing", [0, 1, 9])
def test_start_point_and_missing_tail(here, x, y, missing):
    """startPoint is x y; what the list does not have, before and after, is NODATA."""
    z = heights()
    first = y * 5 + x
    z.ravel()[:first] = np.nan
    list_ = tuples(z.ravel()[first:])
    list_ = list_[:max(0, len(list_) - missing)]
    z.ravel()[first + len(list_):] = np.nan
    tile = one(xml(list_=list_, shape=z.shape, start=f"{x} {y}"))
    assert np.array_equal(tile.raster.z, z, equal_nan=True)


def test_no_start_point_is_the_first_cell(here):
    z = heights()
    assert np.array_equal(one(re.sub("<gml:startPoint.*", "", xml(z))).raster.z, z)


def test_missing_values_are_those_of_any_kind(here):
    list_ = [f"{GROUND},-9999.", f"{WATER},-9999.00", f"{MISSING},-9999", f"{MISSING},0.00", f"{WATER},1.5",
             f"{GROUND},-0.25"]
    tile = one(xml(list_=list_, shape=(2, 3)))
    assert np.array_equal(tile.raster.z, [[np.nan, np.nan, np.nan], [np.nan, 1.5, -0.25]], equal_nan=True)


@pytest.mark.parametrize("spell", [
    lambda text: text.replace("UTF-8", "Shift_JIS").encode("cp932"),
    lambda text: text.replace("UTF-8", "shift-jis").encode("cp932"),
    lambda text: text.encode("utf-8-sig"),
    lambda text: text.replace("\n", "\r\n").encode(),
    lambda text: text.replace("gml:", "g:").replace("xmlns:gml", "xmlns:g").encode(),
    lambda text: re.sub(r"(?<=\d)\n(?=\W*" + GROUND + ")", " ", text).encode(),
    lambda text: text.replace("<gml:tupleList>", "<gml:tupleList><!-- a comment -->").encode(),
], ids=["shift_jis", "shift-jis", "bom", "crlf", "prefix", "one line", "comment"])
def test_spellings(here, spell):
    z = heights((40, 50))
    z[1, 1] = np.nan
    text = xml(z)
    tile = one(spell(text))
    assert np.array_equal(tile.raster.z, z, equal_nan=True)


def test_buffers_of_the_decoder_may_end_in_a_character(here, monkeypatch):
    monkeypatch.setattr(fggml, "CHUNK", 997)
    z = heights((20, 20))
    for encoding, codec in (("Shift_JIS", "cp932"), ("UTF-8", "utf-8")):
        assert np.array_equal(one(xml(z, encoding=encoding).encode(codec)).raster.z, z)


# --- files, merging ---

def quarters(shape=(10, 12), spacing=0.2, south=CENTRE[0], west=CENTRE[1]):
    """A field of heights, and the texts of four tiles that make it."""
    z = heights((2 * shape[0], 2 * shape[1]))
    z[3:5, 11:14] = np.nan
    texts = {}
    for j in range(2):
        for i in range(2):
            part = z[shape[0] * (1 - j):shape[0] * (2 - j), shape[1] * i:shape[1] * (i + 1)]
            texts[f"FG-GML-{j}{i}-DEM5A.xml"] = xml(part, south + j * shape[0] * spacing * SECOND,
                                                    west + i * shape[1] * spacing * SECOND, spacing)
    return z, texts


def merged(paths):
    raster, crs, cell = terrain.read_fggml(paths, None, None, tell=lambda step: None, warn=pytest.fail)
    return raster, crs, cell


def test_tiles_are_merged_whatever_they_come_in(here):
    """In one zip, in a zip of zips with other files, and as files with any name: the same raster."""
    z, texts = quarters()
    write_zip("all.zip", {f"folder/{name}": text for name, text in texts.items()})
    inner = {}
    for name, text in texts.items():
        data = io.BytesIO()
        write_zip(data, {name: text, "fmdid15-3101.xml": "<metadata/>", "readme.txt": "x"})
        inner[name.replace("xml", "zip")] = data.getvalue()
    write_zip("pack.ZIP", inner)
    files = []
    for k, text in enumerate(texts.values()):
        files.append(f"tile{k}.gml")
        Path(files[-1]).write_text(text, encoding="utf-8")
    for paths in (["all.zip"], ["pack.ZIP"], files, files[::-1]):
        raster, crs, _ = merged(paths)
        assert np.array_equal(raster.z, z, equal_nan=True), paths
        expected = Affine(0.2 * SECOND, 0, CENTRE[1], 0, -0.2 * SECOND, CENTRE[0] + 4 * SECOND)
        assert raster.transform.almost_equals(expected, 1e-12)
        assert crs == CRS.from_epsg(6677)


def test_what_macos_adds_to_a_zip_is_skipped(here):
    _, texts = quarters()
    more = {f"__MACOSX/folder/._{name}": "\0\5" for name in texts}
    texts = {f"folder/{name}": text for name, text in texts.items()}
    write_zip("mac.zip", {**texts, **more, "._a.xml": "\0", "._b.zip": ""})
    assert len(fggml.read_fggml_tiles("mac.zip")) == len(texts)


def test_all_zips_in_a_zip_share_one_limit(here, monkeypatch):
    inner = []
    for number, text in enumerate(quarters()[1].values()):
        inner.append(zipped({f"{number}.xml": text}))
    (here / "pack.zip").write_bytes(zipped({f"{k}.zip": data for k, data in enumerate(inner)}))
    total = sum(map(len, inner)) + sum(len(text.encode()) for text in quarters()[1].values())
    monkeypatch.setattr(fggml, "LARGEST_ZIP", total)
    assert len(fggml.read_fggml_tiles("pack.zip")) == 4
    monkeypatch.setattr(fggml, "LARGEST_ZIP", total - 1)
    with pytest.raises(rasters.SlopeError, match="pack.zip: 3.zip: must have at most"):
        fggml.read_fggml_tiles("pack.zip")


def test_names_of_members_are_never_paths(here):
    _, texts = quarters()
    write_zip("all.zip", {f"../../{name}": text for name, text in texts.items()})
    merged(["all.zip"])
    assert os.listdir() == ["all.zip"]
    write_zip("bad.zip", {"../\x1b[31m.xml": "<a"})
    with pytest.raises(rasters.SlopeError, match=r"bad.zip: ../\?\[31m.xml: line 1: must be XML"):
        fggml.read_fggml_tiles("bad.zip")


@pytest.mark.parametrize("spacing, cell", [(1 / 30, 1), (0.2, 5), (0.4, 10)])
def test_terrain_of_a_tile(written, spacing, cell):
    """Corners are edges of cells in latitude longitude, rows from the north: an error of these is metres in height."""
    shape = (60, 45)
    Path("tile.xml").write_text(xml(slope_tile(spacing=spacing, shape=shape), spacing=spacing), encoding="utf-8")
    z, east, north, about, out, err = written("tile.xml")
    known = np.isfinite(z)
    assert np.abs(z - plane(east, north))[known].max() < 0.006  # heights have two decimals in the file
    assert about["crs"]["epsg"] == 6677 and about["cell"] == cell and err == ""
    lost = (shape[0] - 1) * (shape[1] - 1) * (spacing * SECOND * 111320) ** 2 * np.cos(np.radians(36.6))
    assert known.sum() * cell ** 2 == pytest.approx(lost, rel=0.1)
    assert "tile.xml: FG-GML, 1 tile of 45 x 60 cells, JGD2011" in out
    assert "CRS EPSG:6677, zone 9 of the plane rectangular system, the site's; --crs names another" in out


def test_options_go_before_defaults(written):
    Path("tile.xml").write_text(xml(slope_tile()), encoding="utf-8")
    _, _, _, about, out, _ = written("tile.xml --crs EPSG:32654 --cell 2")
    assert about["crs"]["epsg"] == 32654 and about["cell"] == 2 and "zone" not in out


def test_holes_are_filled_before_it_is_projected(written):
    z = slope_tile()
    z[10:12, 20] = np.nan
    Path("tile.xml").write_text(xml(z), encoding="utf-8")
    z, east, north, about, out, _ = written("tile.xml --fill 2")
    assert "filled 1 NODATA holes" in out and about["filled_cells"] == 2
    assert np.nanmax(np.abs(z - plane(east, north))) < 0.01


# --- resolutions, datums, zones ---

def test_resolutions(written, slope):
    """Several need a --cell; then coarser tiles, here 100 m higher, only count where finer ones have no height."""
    fine = slope_tile(shape=(40, 40))
    fine[10:30, 10:30] = np.nan
    coarse = slope_tile(spacing=0.4, shape=(40, 40)) + 100
    write_zip("fine.zip", {"5a.xml": xml(fine)})
    write_zip("coarse.zip", {"10b.xml": xml(coarse, spacing=0.4)})
    status, _, err = slope("coarse.zip fine.zip")
    assert status == 2 and err == (
        "slope terrain: coarse.zip: 10b.xml: must have the resolution of fine.zip: 5a.xml, 0.2 x 0.2 seconds of arc, "
        "unless a --cell is given, got 0.4 x 0.4 seconds of arc\n")
    z, east, north, _, out, _ = written("coarse.zip fine.zip --cell 4")
    assert "where there was no height: bilinear from the tiles of 0.4 x 0.4 seconds of arc" in out
    above = np.round(z - plane(east, north), 1)
    kinds, counts = np.unique(above[np.isfinite(above) & ((above < 0.05) | (above > 99.95))], return_counts=True)
    assert kinds.tolist() == [0, 100]
    assert counts[0] * 16 == pytest.approx((40 * 40 - 20 * 20) * 6.17 * 4.97, rel=0.15)


def test_mixed_datums_are_a_warning(written):
    _, texts = quarters()
    texts = {name: text.replace("jgd2011", "jgd2024") if "10" in name else text for name, text in texts.items()}
    write_zip("all.zip", texts)
    *_, out, err = written("all.zip")
    first, second = err.splitlines()
    assert first == ("slope terrain: warning: tiles of JGD2011 (all.zip: FG-GML-00-DEM5A.xml) and JGD2024 "
                     "(all.zip: FG-GML-10-DEM5A.xml) are mixed and not converted: heights may differ where they meet")
    assert "the ground falls by 89 degrees on average" in second     # it does
    assert "JGD2011 and JGD2024" in out


@pytest.mark.parametrize("name, epsg", [("jgd2000", 2451), ("jgd2011", 6677), ("jgd2024", 6677)])
def test_datums(written, name, epsg):
    Path("tile.xml").write_text(xml(slope_tile(), srs=f"fguuid:{name}.bl"), encoding="utf-8")
    *_, about, out, err = written("tile.xml")
    assert about["crs"]["epsg"] == epsg and err == "" and name.upper() in out


@pytest.mark.parametrize("lat, lon, number", [
    (32.75, 129.88, 1), (28.38, 129.5, 1), (33.6, 130.4, 2), (34.2, 131.5, 3), (34.7, 133.0, 3), (33.6, 133.5, 4),
    (34.7, 135.2, 5), (34.7, 135.5, 6), (35.2, 136.9, 7), (37.9, 139.0, 8), (36.65, 138.2, 8), (36.39, 139.06, 9),
    (37.5, 140.3, 9), (33.1, 139.8, 9), (38.3, 140.9, 10), (40.8, 140.7, 10), (41.8, 140.7, 11), (43.06, 141.35, 12),
    (43.0, 144.4, 13), (27.1, 142.2, 14), (26.2, 127.7, 15), (24.4, 124.2, 16), (25.9, 131.3, 17), (20.4, 136.1, 18),
    (24.3, 154.0, 19)])
def test_zone_of_a_site(lat, lon, number):
    raster = rasters.Raster(np.zeros((2, 2)), Affine(SECOND, 0, lon - SECOND, 0, -SECOND, lat + SECOND), None)
    assert japan.zone(raster, "JGD2011") == (number, CRS.from_epsg(6668 + number))
    assert japan.zone(raster, "JGD2000") == (number, CRS.from_epsg(2442 + number))


# --- the page ---

@pytest.mark.parametrize("command", [one for one in examples("terrain") if "FG-GML" in one])
def test_every_example_of_the_page_and_the_help_runs(slope, command):
    for word in command.split():
        if word.endswith(".zip"):
            spacing = 0.4 if "DEM10" in word else 0.2
            write_zip(word, {"a.xml": xml(slope_tile(spacing=spacing), spacing=spacing)})
    status, out, err = slope(command.split(" -o ")[0])
    assert (status, err) == (0, "") and out.endswith("\nregion ground terrain out.asc\n")


# --- bad input ---

NOT_ONE = "tile.xml: must be a raster or FG-GML elevation data (Dataset with a DEM), got "
SHORT = "is cut short: the XML ends in the middle"
GOOD = xml(np.array([[1.0, 2], [3, 4]]))


def line_of(text, part):
    return text[:text.index(part)].count("\n") + 1


def bad(old, new, message, at=None):
    """Content with one thing replaced, and the message with the line of it."""
    assert old in GOOD
    text = GOOD.replace(old, new, 1)
    return text, f"tile.xml: line {line_of(text, at or new.split('<')[0] or new)}: {message}"


@pytest.mark.parametrize("content, message", [
    ("<?xml version='1.0'?>\n<html><body/></html>", NOT_ONE + "XML with the root html"),
    (GOOD[:GOOD.index("<DEM")] + "</Dataset>", NOT_ONE + "a Dataset without a DEM"),
    ("<html><p>\n</body>", NOT_ONE + "XML with the root html"),
    ("<\n", "tile.xml: line 1: must be XML (not well-formed (invalid token))"),
    (GOOD[:GOOD.index(f"{GROUND},3") + 5], f"tile.xml: line {line_of(GOOD, GROUND + ',3')}: {SHORT}"),
    (GOOD[:GOOD.index("<gml:startPoint") + 6], f"tile.xml: line {line_of(GOOD, '<gml:startPoint')}: {SHORT}"),
    (GOOD[:-4], f"tile.xml: line {GOOD.count(chr(10))}: {SHORT}"),
    bad(f"{GROUND},3.00", f"{GROUND},3.00\n{GROUND},5.00", "tupleList must have at most 4 tuples (2 x 2 cells, "
        "startPoint 0 0), got 5", "<gml:tupleList"),
    bad("<gml:startPoint>0 0", "<gml:startPoint>1 0", "tupleList must have at most 3 tuples (2 x 2 cells, "
        "startPoint 1 0), got 4", "<gml:tupleList"),
    bad("<gml:startPoint>0 0", "<gml:startPoint>0 2", "startPoint must be in the grid, 0 0 to 1 1, got 0 2",
        "<gml:startPoint"),
    bad(f"{GROUND},3.00", f"{GROUND},3,5", f"must be tuples kind,height, got {GROUND},3,5"),
    bad(f"{GROUND},3.00", ",3.00", "must be tuples kind,height, got ,3.00"),
    bad(f"{GROUND},3.00", f"{GROUND},three", f"must be tuples kind,height, got {GROUND},three"),
    bad(f"{GROUND},3.00", f"{GROUND},nan", f"must be tuples kind,height, got {GROUND},nan"),
    bad(f"{GROUND},3.00", f"{GROUND}", f"must be tuples kind,height, got {GROUND}", f"{GROUND}\n"),
    (GOOD.replace(f"{GROUND},3.00", f"{GROUND},99999"), f"tile.xml: tuple 3 of the list in line "
     f"{line_of(GOOD, '<gml:tupleList')}: must be a height in metres between -9000 and 9000, or -9999, got 99999"),
    bad("fguuid:jgd2011.bl", "fguuid:jgd2099.bl", "srsName must be one of fguuid:jgd2000.bl, fguuid:jgd2011.bl, "
        "fguuid:jgd2024.bl, got fguuid:jgd2099.bl"),
    bad(' srsName="fguuid:jgd2011.bl"', "", "DEM must have srsName, it is missing", "<DEM"),
    bad("<gml:high>1 1</gml:high>", "", "DEM must have high, it is missing", "<DEM"),
    bad("<gml:high>1 1", "<gml:high>1 1 1", "high must be two whole numbers, x and y, got 1 1 1", "<gml:high"),
    bad("<gml:high>1 1", "<gml:high>1 -2", "high must be 0 to 99999, got 1 -2", "<gml:high"),
    bad("<gml:high>1 1", "<gml:high>999999 1", "high must be 0 to 99999, got 999999 1", "<gml:high"),
    bad("<gml:low>0 0", "<gml:low>1 1", "low must be 0 0, got 1 1", "<gml:low>"),
    bad("<gml:lowerCorner>36.6", "<gml:lowerCorner>96.6", "corners must be latitude and longitude, the lower one "
        "in the south-west, got 96.625 139.875 and", "<gml:lowerCorner"),
    bad("<gml:lowerCorner>36.6", "<gml:lowerCorner>nan 3", "lowerCorner must be two numbers, latitude and "
        "longitude, got nan", "<gml:lowerCorner"),
    bad('order="+x-y"', 'order="+x+y"', "order must be +x-y, got +x+y"),
    (GOOD.replace("UTF-8", "EUC-JP"), "tile.xml: line 1: encoding must be UTF-8 or Shift_JIS, got EUC-JP"),
    (GOOD.encode("cp932"), "tile.xml: line 5: must be XML (not well-formed (invalid token))"),
    (GOOD.replace("UTF-8", "Shift_JIS").encode(), "tile.xml: line 1 or after: must be in the encoding that it "
     "declares"),
    (xml(np.ones((2, 2)), head='<!DOCTYPE a [<!ENTITY b "c"><!ENTITY d "&b;&b;&b;&b;&b;&b;&b;&b;">]>\n'),
     "tile.xml: line 2: must have no DOCTYPE, got a"),
    (xml(np.full((2, 2), np.nan)), "tile.xml: must have a height, all cells are NODATA"),
    (xml(np.ones((3, 3)), south=10.0, west=10.0), "--crs: must be given: no zone of Japan's plane rectangular system "
     "is near the site, got latitude 10.0001, longitude 10.0001"),
], ids=lambda value: "")
def test_bad_tiles_are_one_line_and_nothing_is_written(slope, here, content, message):
    (here / "tile.xml").write_bytes(content if isinstance(content, bytes) else content.encode())
    status, out, err = slope("tile.xml")
    assert status == 2 and is_one(err, f"slope terrain: {message}"), err
    assert os.listdir() == ["tile.xml"]


def zipped(members=None, change=None, edit=lambda data: data, compress=zipfile.ZIP_DEFLATED):
    data = io.BytesIO()
    write_zip(data, members or {"a.xml": GOOD}, change, compress)
    return edit(data.getvalue())


def declare(size):
    def change(info):
        info.file_size = size
    return change


def encrypted(info):
    info.flag_bits |= 1


def flip(data):
    """One byte of the first member's data changed."""
    at = data.index(b"Dataset1")
    return data[:at] + b"X" + data[at + 1:]


NO_TILES = "z.zip: must hold a raster, or FG-GML elevation tiles (.xml), it has none"
BOMB = zipped({"a.xml": b" " * 50_000_000})


@pytest.mark.parametrize("content, message", [
    (zipped({"readme.txt": "x", "meta.xml": "<a/>"}), f"{NO_TILES}, got 2 files"),
    (zipped({"inner.zip": zipped({"readme.txt": "x"})}), NO_TILES),
    (zipped()[:-30], "z.zip: must be a whole zip file (File is not a zip file)"),
    (b"PK\x03\x04", "z.zip: must be a whole zip file"),
    (zipped({"a.xml": GOOD[:900]}), f"z.zip: a.xml: line {GOOD[:900].count(chr(10)) + 1}: {SHORT}"),
    (zipped(edit=flip, compress=zipfile.ZIP_STORED), "z.zip: a.xml: is damaged (Bad CRC-32 for file 'a.xml')"),
    (zipped(change=encrypted), "z.zip: a.xml: must not be encrypted"),
    (zipped(change=declare(300_000_000)), "z.zip: must have at most 4000 MB unpacked, and 1100 times its size, got "
     "300 MB in"),
    (zipped({"a.xml": GOOD, "pad.bin": os.urandom(400_000)}, change=declare(300_000_000)),
     "z.zip: a.xml: must have at most 256 MB unpacked, got 300 MB"),
    (BOMB, "z.zip: a.xml: line 1: must be XML (no element found)"),
    (zipped({"i.zip": zipped({"j.zip": BOMB})}), NO_TILES),
    (zipped({f"{k}.xml": GOOD for k in range(20)} | {"pad.bin": os.urandom(5_000_000)}, change=declare(250_000_000)),
     "z.zip: must have at most 4000 MB unpacked, and 1100 times its size, got 5000 MB in"),
], ids=lambda value: "")
def test_bad_zips_are_one_line(slope, here, content, message):
    (here / "z.zip").write_bytes(content)
    status, out, err = slope("z.zip")
    assert status == 2 and is_one(err, f"slope terrain: {message}"), err
    assert os.listdir() == ["z.zip"]


def test_other_rasters_are_not_mixed_with_tiles(slope, here):
    (here / "tile.xml").write_text(GOOD, encoding="utf-8")
    (here / "a.asc").write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n")
    status, _, err = slope("tile.xml a.asc")
    assert status == 2 and err == (
        "slope terrain: a.asc: must be FG-GML as other inputs are: make a terrain of each kind\n")
