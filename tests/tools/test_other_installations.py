"""Variables that lead to libraries and data of another installation: one line, or the same result."""
import os
import shutil
import sqlite3
import subprocess
from pathlib import Path

import numpy as np
import pyproj
import pytest
from shapely.geometry import box

from run_helpers import CRS_M, EAST, NORTH, TOOLS, write_asc, write_geojson, write_sidecar

TOKYO = "polygon tokyo.geojson --terrain terrain.asc -o o.csv --overwrite"


@pytest.fixture
def site(here):
    """A terrain, and a polygon on the old datum of Tokyo."""
    write_sidecar(80, 80, 10)
    write_asc("terrain.asc", np.zeros((80, 80)), 10)
    x, y = pyproj.Transformer.from_crs(CRS_M, "EPSG:30169", always_xy=True).transform(EAST + 400, NORTH + 400)
    write_geojson("tokyo.geojson", box(x - 50, y - 50, x + 50, y + 50), crs="EPSG:30169")
    return here


def slope(words, **variables):
    return subprocess.run([TOOLS / "slope", *words.split()], env={**os.environ, **variables}, capture_output=True,
                          text=True, check=False)


def refused(words, start, **variables):
    done = slope(words, **variables)
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith(start), done.stderr
    return done.stderr


def bases(folder):
    """Folders with databases that do not fit, by what is wrong; good has one that does."""
    source = next(Path(one, "proj.db") for one in (*pyproj.datadir.get_data_dir().split(os.pathsep), "/usr/share/proj")
                  if Path(one, "proj.db").is_file())
    for name in ("good", "layout", "empty", "text", "folder/proj.db"):
        Path(folder, name).mkdir(parents=True)
    for name in ("good", "layout"):
        shutil.copy(source, Path(folder, name))
    with sqlite3.connect(folder / "layout" / "proj.db") as data:
        data.execute("update metadata set value = 0 where key = 'DATABASE.LAYOUT.VERSION.MINOR'")
    Path(folder, "empty/proj.db").touch()
    Path(folder, "text/proj.db").write_text("no database")
    return [str(folder / name) for name in ("nowhere", "layout", "empty", "text", "folder")]


def test_a_database_of_proj_that_does_not_fit(site):
    wrong = bases(site)
    expected = slope(TOKYO)
    assert expected.returncode == 0, expected.stderr
    Path("o.csv").unlink()
    for number, place in enumerate(wrong):
        name = ("PROJ_LIB", "PROJ_DATA")[number % 2]
        err = refused(TOKYO, f"slope polygon: {name}={place}: must have a database (proj.db)", **{name: place})
        assert f"unset {name}" in err and not Path("o.csv").exists()
    for words in ("terrain terrain.asc --crs EPSG:32654 -o x.asc", "release terrain.asc --polygon p.csv --depth 5 -o r",
                  "study in.none --set a=1 -o s"):
        refused(words, f"slope {words.split()[0]}: PROJ_LIB=/nowhere: must have", PROJ_LIB="/nowhere")
    for variables in ({"PROJ_LIB": str(site / "good")}, {"PROJ_DATA": str(site / "good"), "PROJ_LIB": "/nowhere"},
                      {"GDAL_DATA": "/nowhere"}):
        assert slope(TOKYO, **variables).stdout == expected.stdout


def test_libraries_of_another_python(site):
    for library, words, command in (("numpy", TOKYO, ""), ("yaml", "terrain --help", ""),
                                    ("rasterio", TOKYO, " polygon")):
        Path("of", library, library).mkdir(parents=True)
        Path("of", library, library, "__init__.py").write_text("raise ImportError('of another\\nPython')")
        err = refused(words, f"slope{command}: the libraries: must be those of this Python", PYTHONPATH=f"of/{library}")
        assert f"unset PYTHONPATH=of/{library}" in err and "got of another Python" in err
