"""Small elevation models in the forms in which countries give them: the rows of the table in gis.rst.

A function writes a product's files into the current folder. All have the heights of ground() in the coordinates of the
file; sizes are cut down, those of the tiles of 50 km too.
"""
import zipfile
from pathlib import Path

import numpy as np
import rasterio
from affine import Affine
from rasterio.crs import CRS

SIZE = 30       # cells in a row and in a column


def ground(x, y):
    """Height (m) at a place in the coordinates of the file, metres or degrees."""
    scale = 3600 if np.max(np.abs(x)) <= 180 else 1
    return 400 + 0.3 * np.remainder(scale * x, 1000) - 0.2 * np.remainder(scale * y, 1000)


def centres(west, south, cell, size=SIZE):
    """x and y of the middles of the cells, rows from the north."""
    return np.meshgrid(west + cell * (np.arange(size) + 0.5), south + cell * (size - 0.5 - np.arange(size)))


def tif(path, crs, west, south, cell=1.0, nodata=-9999.0, hole=True, unit=None, **how):
    """A GeoTIFF, with one cell of NODATA; west, south: of its corner."""
    z = ground(*centres(west, south, cell))
    if hole:
        z[3, 4] = nodata
    with rasterio.open(path, "w", driver="GTiff", height=SIZE, width=SIZE, count=1, dtype="float32", crs=crs,
                       transform=Affine(cell, 0, west, 0, -cell, south + SIZE * cell),
                       **{"nodata": nodata, "compress": "lzw", **how}) as out:
        out.write(z.astype("float32"), 1)
        if unit:
            out.units = [unit]


def asc(path, head, west, south, cell=1.0, mark="-9999", first=""):
    """An ESRI ASCII grid; head: its lines; first: before the numbers of a line."""
    words = [[f"{value:.3f}" for value in row] for row in ground(*centres(west, south, cell))]
    words[3][4] = mark
    Path(path).write_text(head.format(size=SIZE) + "".join(f"{first}{' '.join(row)}\n" for row in words))


def points(west, south, cell=1.0, by_column=False, from_south=False):
    """x, y, height of every cell's middle, in lines of the order of a file."""
    x, y = centres(west, south, cell)
    found = np.dstack([x, y, ground(x, y)])
    found = found[::-1] if from_south else found
    return (found.transpose(1, 0, 2) if by_column else found).reshape(-1, 3)


def packed(path, *names):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as out:
        for name in names:
            out.write(name)
            Path(name).unlink()


def austria():
    tif("ALS_DTM.tif", "EPSG:3035", 4425100.0, 2624400.0, tiled=True, blockxsize=256, blockysize=256)


def canada():
    tif("ALS_DTM.tif", "EPSG:3979", 1500000.0, -200000.0, nodata=-32767.0)


def denmark():
    tif("DTM.tif", "EPSG:25832", 720000.0, 6171000.0, 0.4, compress="deflate")


def england():
    tif("DTM.tif", "EPSG:27700", 340000.0, 520000.0, nodata=-3.4028234663852886e38)


def france_rge():
    asc("RGEALTI.asc", "ncols {size}\nnrows {size}\nxllcorner 989999.500000000000\nyllcorner 6319999.500000000000\n"
        "cellsize 1.000000000000\nNODATA_value  -99999.00\n", 989999.5, 6319999.5, mark="-99999.00", first=" ")


def france_lidar():
    tif("LHD_FXX_0446_6807", "EPSG:2154", 445999.75, 6806000.25, 0.5)


def bavaria():
    tif("DTM.tif", "EPSG:25832", 690000.0, 5330000.0)


def baden_wuerttemberg():
    tif("wcs.tif", "EPSG:25832", 510000.0, 5380000.0, nodata=0.0)
    with rasterio.open("wcs.tif", "r+") as raster:
        raster.nodata = None


def westphalia():
    lines = points(349000.0, 5700000.0, from_south=True)
    Path("dgm1_32_349_5700.xyz").write_text("".join(f"{x:.1f} {y:.1f} {z:.2f}\n" for x, y, z in lines))


def hong_kong():
    asc("Whole_HK_DTM_5m.asc", "ncols {size}\nnrows {size}\nxllcorner 830000\nyllcorner 820000\ncellsize 5\n"
        "NODATA_value -9999\n", 830000.0, 820000.0, 5.0)
    packed("Whole_HK_DTM_5m.zip", "Whole_HK_DTM_5m.asc")


def bologna():
    asc("dtm.ASC", "NCOLS {size}\nNROWS {size}\nCELLSIZE 1\nXLLCENTER 686000.5\nYLLCENTER 4928000.5\n"
        "NODATA_VALUE -9999.0000\n", 686000.0, 4928000.0)


def netherlands():
    tif("DTM.tif", CRS.from_user_input("EPSG:7415"), 130000.0, 455000.0, 0.5, nodata=3.4028234663852886e38,
        compress="deflate", predictor=3)


def new_zealand():
    tif("DTM.tif", "EPSG:2193", 1570000.0, 5180000.0, 1.0000000000000349)


def norway():
    tif("ALS_DTM.tif", CRS.from_wkt(CRS.from_epsg(25833).to_wkt(version="WKT1_ESRI")), 245425.0, 7026005.0)


def poland():
    head = "ncols {{size}}\nnrows {{size}}\nxllcenter {0}\nyllcenter 704200.0\ncellsize 5\nnodata_value -9999\n"
    asc("1.asc", head.format(535000.0), 534997.5, 704197.5, 5.0)
    asc("2.asc", head.format(535145.2), 535142.7, 704197.5, 5.0)


def slovenia():
    lines = [line for i, line in enumerate(points(511000.0, 122000.0, by_column=True, from_south=True)) if i % 7 != 3]
    Path("TM1_511_122.txt").write_text("".join(f"{x:.2f};{y:.2f};{z:.2f}\n" for x, y, z in lines))


def spain():
    tif("DTM.tif", "EPSG:25830", 500000.0, 4300000.0, 2.0)


def switzerland():
    name = "swissalti3d.xyz"
    lines = points(2600000.0, 1200000.0, 2.0)
    Path(name).write_text("X Y Z\n" + "".join(f"{x:.0f} {y:.0f} {z:.2f}\n" for x, y, z in lines))
    packed(f"{name}.zip", name)


def taiwan():
    tif("DTM.tif", "EPSG:3826", 250000.0, 2650000.0, 20.0)


def usa():
    tif("USGS_1M.tif", "EPSG:26913", 260000.0, 4490000.0, nodata=-999999.0, unit="US survey foot")


def glo_30():
    tif("GLO30.tif", "EPSG:4326", 7.5, 46.2, 1 / 3600, hole=False, nodata=None)
