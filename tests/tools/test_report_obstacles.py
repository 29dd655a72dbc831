"""Structures, control lines, road and cut on the maps and in the section of a report; palettes; results of nothing."""
import re
from types import SimpleNamespace

import numpy as np
import pytest
from affine import Affine
from matplotlib import colormaps
from shapely.geometry import box

import made_study
from run_helpers import TOOLS

from slope_tools.drawing import figures, palettes
from slope_tools.plots import (figure_charts, figure_maps, figure_structures, obstacles,
                               section as report_section)
from slope_tools.plots.known_reach import KnownReach, Mark
from slope_tools.report import charts
from slope_tools.statistics import hazard
from slope_tools.survey.rasters import Raster
from slope_tools.tables import structures


def box_of(low, high):
    """Triangles of the faces of a box."""
    c = [np.array([x, y, z]) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    faces = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
    return np.array([[c[i], c[j], c[k]] for a, b, d, e in faces for i, j, k in ((a, b, d), (a, d, e))], float)


WALL = box_of((12, 1, -1), (13, 23, 2))


# --- what they are ---

def test_what_a_structure_covers():
    assert obstacles.footprint(WALL).equals(box(12, 1, 13, 23))
    upright = np.array([[[5, 0, 0], [5, 8, 0], [5, 8, 3]]], float)
    assert obstacles.footprint(upright).bounds == (5, 0, 5, 8)
    assert structures.bearing_length(WALL, np.ones(12))[0] == pytest.approx(22)
    assert structures.bearing_length(upright, np.ones(1))[0] == pytest.approx(8)


def test_where_a_section_cuts_a_structure():
    """Along x, with a bend far from it: the outline 12 to 13 and -1 to 2, at the distances of the line."""
    found = obstacles.section_of(WALL, np.array([[2.0, 5.0], [20.0, 5.0], [20.0, 9.0]]))
    assert (found[..., 0].min(), found[..., 0].max()) == pytest.approx((10, 11))
    assert (found[..., 1].min(), found[..., 1].max()) == pytest.approx((-1, 2))
    assert len(obstacles.section_of(WALL, np.array([[2.0, 30.0], [20.0, 30.0]]))) == 0      # beside it
    assert len(obstacles.section_of(WALL, np.array([[2.0, 5.0], [9.0, 5.0]]))) == 0         # in front of it


def test_points_of_a_control_line(tmp_path):
    path = tmp_path / "fence.csv"
    path.write_text("# x y\n11 23\n11,1   # its end\n")
    assert obstacles.read_line_points(path).tolist() == [[11, 23], [11, 1]]


# --- on maps and section ---

@pytest.fixture
def drawn(monkeypatch):
    """Figures that were to become data URIs."""
    found = []
    monkeypatch.setattr(figures, "data_uri", lambda figure, kind="png": found.append(figure) or "uri")
    return found


def texts(figure):
    return {text.get_text() for text in figure.texts}


REACH = KnownReach(np.array([[5.0, 12], [30, 12]]), [
    Mark(0.5, 25.0, np.array([30.0, 12]), np.array([[30.0, 10], [30, 14]]))])


def test_every_map_has_them(drawn):
    z = np.add.outer(np.arange(24.0), np.arange(40.0))
    raster = Raster(z, Affine(1, 0, 0, 0, -1, 24), None, (0, 0))
    layers = figure_maps.Layers(raster, z, (0, 0, 40, 24), None, box(2, 0, 6, 24), np.array([[1.0, 12], [39, 12]]), 5.0,
                                {"wall": obstacles.footprint(WALL)}, {"fence": np.array([[11.0, 23], [11, 1]])}, REACH)
    values, mesh = z / 10, raster._replace(z=np.full((3, 5), 10.0), transform=Affine(8, 0, 0, 0, -8, 24))
    figure_maps.value_map(layers, values, "title", "(m)", [0.0, 1.0, 7.0], palettes.THICKNESS)
    figure_maps.mesh_map(layers, values, mesh, "title")
    figure_maps.terrain_map(layers, layers.shown)
    figure_maps.small_maps(layers, [("one", values)], "(m)", [0.0, 1.0, 7.0], palettes.THICKNESS)
    assert len(drawn) == 4
    for figure in drawn:
        assert {"road", "structure", "control line", "half of known events go farther"} <= texts(figure)
        assert any(np.allclose(line.get_xydata(), REACH.marks[0].ends) for axes in figure.axes for line in axes.lines
                   if len(line.get_xdata()) == 2)
        assert any(np.allclose(sorted(set(line.get_xdata())), [12, 13]) for axes in figure.axes for line in axes.lines
                   if len(line.get_xdata()) == 5)


def test_the_section_has_them(drawn):
    s = np.linspace(0, 40, 81)
    runs = [("run", 0.5 * s + 1, np.where(s < 20, 1.0, 0.0))]
    cut = np.where(s < 10, 0.5 * s + 0.5, np.nan)
    figure_charts.draw_section(s, 0.5 * s, 0.5 * s, runs, [(2, 6)], cut, "title", (), obstacles.section_of(
        WALL, np.array([[0.0, 5.0], [40.0, 5.0]])), [11.0], [(0.1, 30.0)])
    assert {"road", "structure", "control line", "cut surface", "a tenth of known events go farther"} <= texts(drawn[0])
    assert any(list(line.get_xdata()) == [30.0, 30.0] for axes in drawn[0].axes for line in axes.lines)
    figure_charts.draw_section(s, 0.5 * s, 0.5 * s, runs, [], None, "title")
    assert not {"structure", "control line", "cut surface"} & texts(drawn[1])


# --- the line of the section ---

def section_of(road, runs=()):
    """A Section of a ground of 100 x 40 m, without what its constructor reads."""
    found = report_section.Section.__new__(report_section.Section)
    found.data = SimpleNamespace(road=road)
    found.ground = SimpleNamespace(cell=1.0, extent=(0, 0, 100, 40))
    found.runs = runs
    return found


def test_the_section_goes_on_to_the_far_side_of_the_road():
    points = np.array([[40.0, 20.0], [80.0, 20.0]])
    room = 0.04 * 40 + 2
    assert section_of(box(10, 0, 14, 40))._to_road(points).tolist() == [[pytest.approx(10 - room), 20], [80, 20]]
    # it ends on the road
    assert section_of(box(30, 0, 44, 40))._to_road(points).tolist() == [[pytest.approx(30 - room), 20], [80, 20]]
    # it crosses it, or it lies beside or is too far away
    for road in (box(50, 0, 60, 40), box(10, 0, 14, 10), None):
        assert section_of(road)._to_road(points) is points
    short = np.array([[60.0, 20.0], [66.0, 20.0]])
    assert section_of(box(10, 0, 14, 40))._to_road(short) is short
    # no farther than the terrain
    assert section_of(box(1, 0, 3, 40))._to_road(points)[0].tolist() == [0, 20]


def test_the_cut_is_drawn_only_where_it_cuts():
    surface, thickness = np.array([5.0, 5.0, 5.0, 5.0]), np.array([1.0, 1.0, 0.0, 1.0])
    section = section_of(None, [("run", surface, thickness)])
    found = section._where_it_cuts(np.array([4.0, 6.0, 4.0, np.nan]))
    assert found[0] == 4 and np.isnan(found[1:]).all()
    assert section._where_it_cuts(np.array([6.0, 6.0, 4.0, 3000.0])) is None and section._where_it_cuts(None) is None


# --- one palette for each quantity ---

def test_palettes_are_named_in_one_place():
    names = set(colormaps) - {"gray", "terrain", "seismic"}      # of the shaded relief; words of ours
    found = {path.name: re.findall(r'"([A-Za-z_]+)"', path.read_text(encoding="utf-8"))
             for path in (TOOLS / "slope_tools").rglob("*.py") if path.name != "palettes.py"}
    assert {name: used for name, words in found.items() if (used := names & set(words))} == {}
    known = {name: value for name, value in vars(palettes).items() if name.isupper() and isinstance(value, str)}
    assert len(set(known.values())) == len(known) >= 9


def test_pressures_have_letters_of_the_usual_size(drawn):
    """A picture as wide as the page, whatever the shape of the structure."""
    for wall in (WALL, box_of((0, 0, 0), (1, 1, 30))):
        figure_structures.pressure_map(wall, np.ones(len(wall)), np.array([1.0, 0, 0]), "title")
        assert drawn[-1].get_size_inches()[0] == figures.FULL


# --- nothing ---

def test_results_of_nothing(drawn):
    series = figure_charts.Series("", [0.0, 1.0], [0.0, 0.0])
    figure_charts.chart([series], "x", "y", "title")
    figure_charts.bars(["a", "b"], [0.0, 0.0], "y", "title")
    assert drawn[0].axes[0].get_ylim() == (0, 1) and drawn[1].axes[0].get_xlim() == (0, 1)
    assert not any("e-" in text for figure in drawn for text in texts(figure))
    entry = {"variable": "rolling", "smallest_at": "0", "largest_at": "0", "by_m3": 0.0, "chance_m3": 5.0,
             "clear": False}
    data = SimpleNamespace(study=made_study.study(conservative=made_study.conservative(0.0, differences=[entry])))
    assert charts.differences(data, None) == [
        "rolling: the means of all its values are the same, so that there is no trend."]


def test_a_hazard_curve_has_no_value_below_nothing():
    curve = hazard.compute_hazard_curve([0.0, 0.0, 5.0, 8.0], range(4))
    rows = [row.split(",")[1:3] for row in hazard.tabulate_hazard({"remove_m3": curve}).splitlines()[1:]]
    assert rows == [["0", "0.5"], ["5", "0.25"], ["8", "0"]]
    curve = hazard.compute_hazard_curve([3.0, 4.0], range(2))
    rows = [row.split(",")[1:3] for row in hazard.tabulate_hazard({"front_m": curve}).splitlines()[1:]]
    assert rows == [["0", "1"], ["3", "0.5"], ["4", "0"]]
