"""Pictures do not depend on a user's settings of matplotlib, and change none of a script that calls the package."""
import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from run_helpers import CRS_M, TOOLS, write_asc, write_run, write_sidecar, write_tif

from slope_tools.drawing import figures, pictures

OTHERS = """image.origin: lower
text.usetex: True
backend: nonsense
font.size: 20
font.family: cursive
axes.grid: True
image.interpolation: bicubic
image.cmap: jet
savefig.bbox: tight
savefig.transparent: True
savefig.facecolor: red
figure.dpi: 30
axes.prop_cycle: cycler('color', ['red'])
svg.hashsalt: other
no such key
"""
GROUND = 100 - 0.5 * np.add.outer(np.zeros(30), np.arange(40.0)) + 0.3 * np.arange(30.0)[:, None]
RELEASE = "release terrain.asc --polygon p.csv --local --shape slbl --depth 6 -o o/r"
COMMANDS = {
    "release": RELEASE, "back": "stability terrain.asc --failed 60,75,115,40 --density 2000 --direction 90 -o o/b",
    "score": "score run --observed mapped.tif -o o/s", "volume": "volume run --road p.csv --local --mesh 20 -o o/v",
    "quake": "quake a.csv -o o/q.txt",
}


@pytest.fixture
def site(here):
    write_asc("terrain.asc", GROUND, 5.0)
    about = Path("terrain.yaml")
    write_sidecar(30, 40, 5.0)
    assert about.is_file()
    write_asc("terrain.asc", GROUND, 5.0)
    Path("p.csv").write_text("x,y\n40,60\n100,60\n100,100\n40,100\n")
    thickness = np.zeros((30, 40))
    thickness[12:20, 14:26] = 1.5
    write_run(thickness, GROUND, 5.0)
    write_tif("mapped.tif", thickness, 5.0, crs=CRS_M)
    Path("a.csv").write_text("time,EW (gal)\n" + "".join(f"{0.01 * k:g},{100 * np.sin(0.2 * k):g}\n"
                                                         for k in range(500)))
    return here


def draw(words, **environment):
    """The pictures of a command, by name."""
    Path("o").mkdir(exist_ok=True)
    done = subprocess.run([TOOLS / "slope", *words.split(), "--overwrite"], env={**os.environ, **environment},
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "matplotlib" not in done.stderr and "Traceback" not in done.stderr, done.stderr
    found = {str(path): path.read_bytes() for path in Path("o").rglob("*.png")}
    assert found
    return found


@pytest.mark.drawn
@pytest.mark.parametrize("command", [pytest.param(name, marks=[pytest.mark.long] * (name != "release"))
                                     for name in COMMANDS])
def test_pictures_are_those_without_a_matplotlibrc(site, command):
    expected = draw(COMMANDS[command])
    Path("matplotlibrc").write_text(OTHERS)
    assert draw(COMMANDS[command]) == expected


@pytest.mark.drawn
@pytest.mark.long
def test_wherever_the_settings_are(site):
    expected = draw(RELEASE)
    Path("matplotlibrc").write_bytes(b"font.family: \xe9\xff\n")
    assert draw(RELEASE, MPLBACKEND="nonsense") == expected
    Path("matplotlibrc").unlink()
    Path("elsewhere").mkdir()
    Path("elsewhere/matplotlibrc").write_text(OTHERS)
    assert draw(RELEASE, MATPLOTLIBRC="elsewhere", MPLBACKEND="TkAgg") == expected
    assert draw(RELEASE, MPLCONFIGDIR="elsewhere") == expected


SCRIPT = """
import warnings
import matplotlib
from matplotlib import pyplot as plt
plt.style.use("dark_background")
matplotlib.rcParams.update({"image.origin": "lower", "text.usetex": True, "backend": "svg"})
mine = plt.figure()
before, filters = matplotlib.rcParams.copy(), list(warnings.filters)
from slope_tools.commands import release
from slope_tools.options import declare, request
import argparse
parser = argparse.ArgumentParser()
declare(parser, release.Request)
from slope_tools.releases import release_chart
from slope_tools import animation, plots, report
from slope_tools.plots import figure_charts, figure_maps, figure_structures, site_map
from slope_tools.animation import film
assert matplotlib.rcParams == before
release.run_release(request(release.Request, parser.parse_args("WORDS".split())))
assert matplotlib.rcParams == before and matplotlib.get_backend() == "svg", "settings"
assert [f for f in warnings.filters if "Glyph" in str(f)] == [f for f in filters if "Glyph" in str(f)]
assert plt.get_fignums() == [mine.number]
"""


@pytest.mark.drawn
def test_a_script_keeps_its_settings_and_gets_the_same_picture(site):
    expected = draw(RELEASE)["o/r.png"]
    Path("o/r.png").unlink()
    words = f"{RELEASE.removeprefix('release ')} --overwrite"
    subprocess.run([sys.executable, "-c", SCRIPT.replace("WORDS", words)], check=True,
                   env={**os.environ, "PYTHONPATH": str(TOOLS)})
    assert Path("o/r.png").read_bytes() == expected


def test_drawing_outside_of_the_settings_is_found():
    with pictures.settings():
        made = pictures.figure()
        usual = figures.text_width("abc", 8)
        text = made.text(0, 0, "abc", fontsize=8).get_window_extent(made.canvas.get_renderer())
        assert usual == pytest.approx(text.width / made.dpi, rel=0.05)
    for wrong in (pictures.figure, lambda: pictures.encode_figure(made)):
        with pytest.raises(RuntimeError, match="within settings"):
            wrong()
    with matplotlib.rc_context({"font.family": "monospace", "font.style": "italic"}):
        assert figures.text_width("abc", 8) == usual


def test_figures_are_made_in_one_place():
    for path in (TOOLS / "slope_tools").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if path.name != "pictures.py":
            assert not re.search(r"\bpyplot\b|rc_context|rcParams|\.savefig\(|\bFigure\(|matplotlib\.use", text), path
