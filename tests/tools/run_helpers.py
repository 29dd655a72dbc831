"""Runs of fix deposit/grid made by hand, for the tests of the commands that evaluate them."""
import contextlib
import importlib
import io
import json
import math
import os
import re
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
import rasterio
import yaml
from affine import Affine
from rasterio.crs import CRS
from shapely.geometry import mapping

import tiny_collapse

from slope_tools import cli

TOP = Path(__file__).resolve().parents[2]
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
BULK = 6 / math.pi
CRS_M = "EPSG:6677"               # metres, zone IX of Japan
EAST, NORTH = -12000.0, 34000.0   # of local 0 0


def anew(words, more):
    """A command's words and more, without those of its options (each with a value) that more gives anew."""
    old, new = shlex.split(words), shlex.split(more)
    again = [k for k, word in enumerate(old) if word.startswith("--") and word in new]
    return shlex.join([word for k, word in enumerate(old) if k not in again and k - 1 not in again] + new)


def centres(rows, columns, cell, xlo=0.0, ylo=0.0):
    """x and y of the cell centres, rows from the north."""
    return np.meshgrid(xlo + cell * (np.arange(columns) + 0.5), ylo + cell * (rows - 0.5 - np.arange(rows)))


def write_asc(path, z, cell, xlo=0.0, ylo=0.0):
    with open(path, "w", encoding="ascii") as out:
        out.write(f"ncols {z.shape[1]}\nnrows {z.shape[0]}\nxllcorner {xlo!r}\nyllcorner {ylo!r}\n"
                  f"cellsize {cell!r}\nNODATA_value -9999\n")
        for row in z:
            out.write(" ".join("-9999" if math.isnan(value) else repr(value) for value in row.tolist()) + "\n")


def write_tif(path, z, cell, xlo=EAST, ylo=NORTH, crs=CRS_M, nodata=-9999.0):
    """A GeoTIFF of z, rows from the north, NaN as NODATA; xlo, ylo: of its south-western corner."""
    z = np.asarray(z, float)
    with rasterio.open(path, "w", driver="GTiff", height=len(z), width=len(z[0]), count=1, dtype="float64", crs=crs,
                       nodata=nodata, transform=Affine(cell, 0, xlo, 0, -cell, ylo + len(z) * cell)) as out:
        out.write(np.where(np.isnan(z), nodata, z), 1)


def write_run(thickness, base, cell, prefix="run", xlo=0.0, ylo=0.0, **summary):
    """What fix deposit/grid writes: thickness an array, rows from the north; ground another one, or a height."""
    z = base * np.ones_like(thickness)
    write_asc(f"{prefix}.thickness.asc", thickness, cell, xlo, ylo)
    write_asc(f"{prefix}.surface.asc", z + thickness, cell, xlo, ylo)
    volume = float(thickness.sum()) * cell ** 2
    about = {"slope_version": "0.1.0", "time": 12.5, "bulk_factor": BULK, "moving": False,
             "volume": {"released": volume, "on_grid": volume, "off_grid": 0.0, "lost": 0.0, "residual": 0.0}}
    about.update(summary)
    Path(f"{prefix}.summary.yaml").write_text(yaml.safe_dump(about))


def write_sidecar(rows, columns, cell, path="terrain.asc", xlo=0.0, ylo=0.0, crs=CRS_M):
    """terrain.asc, of which only the sidecar counts, as slope terrain writes it."""
    write_asc(path, np.zeros((rows, columns)), cell, xlo, ylo)
    about = {"crs": crs and {"epsg": CRS.from_user_input(crs).to_epsg(), "wkt": CRS.from_user_input(crs).to_wkt()},
             "origin": {"east": EAST, "north": NORTH}, "cell": cell, "size": {"columns": columns, "rows": rows},
             "extent": {"xlo": xlo, "xhi": xlo + columns * cell, "ylo": ylo, "yhi": ylo + rows * cell}}
    Path(path).with_suffix(".yaml").write_text(yaml.safe_dump(about))


def write_geojson(path, *geometries, crs=None):
    about = {"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": mapping(g)}
                                                       for g in geometries]}
    if crs:
        about["crs"] = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{crs.split(':')[1]}"}}
    Path(path).write_text(json.dumps(about))
    return path


def warned(about):
    """{kind: numbers} of the warnings in a YAML file."""
    return {one["kind"]: one.get("numbers", {}) for one in about["warnings"]}


def called(capsys, words):
    """Run `slope WORDS` in this process; gives status, stdout, stderr."""
    capsys.readouterr()
    try:
        status = cli.main(words)
    except SystemExit as error:
        status = error.code
    return status, *capsys.readouterr()


def inside(folder, *words):
    """Run `slope WORDS` in a folder, in this process; gives what a finished one has."""
    out, err, back = io.StringIO(), io.StringIO(), os.getcwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = cli.main([str(word) for word in words])
    except SystemExit as error:
        status = error.code
    finally:
        os.chdir(back)
    return subprocess.CompletedProcess(words, status, out.getvalue(), err.getvalue())


def slope(folder, *words):
    """The same with a LAMMPS program: half a second less than a process of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LMP", str(Path(tiny_collapse.LMP).absolute()))
        return inside(folder, *words)


def examples(command, package="slope_tools.commands"):
    """The examples on a command's page and in its help, without its name: not what has the syntax."""
    page = (TOP / "doc" / "src" / f"tool_{command}.rst").read_text(encoding="ascii")
    text = (page + importlib.import_module(f"{package}.{command}").EPILOG).replace("\\\n", " ")
    found = [line for line in re.findall(rf"^ +tools/slope {command} (.*)", text, re.M) if "keyword" not in line]
    assert len(found) >= 4
    return found


def blank_figures(patch):
    """The maps and charts of reports, of which not even the figures are made up, are blank from now on."""
    png, svg = "data:image/png;base64,AAAA", "data:image/svg+xml;base64,AAAA"
    for name in ("value_map", "terrain_map", "small_maps", "road_map"):
        patch.setattr(f"slope_tools.plots.figure_maps.{name}", lambda *_, **__: png)
    patch.setattr("slope_tools.plots.figure_maps.mesh_map", lambda *_, **__: (png, False))
    for name in ("chart", "bars", "convergence"):
        patch.setattr(f"slope_tools.plots.figure_charts.{name}", lambda *_, **__: svg)
    patch.setattr("slope_tools.plots.figure_charts.draw_section", lambda *_: (svg, 1, None))


def run_command(command, arguments, capsys):
    """Run `slope COMMAND ARGUMENTS`; gives status, stdout, stderr."""
    return called(capsys, [command, *shlex.split(arguments)])
