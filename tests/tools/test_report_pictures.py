"""The pictures of slope report: nothing overlaps at any shape of site, classes that suit the deposit, exaggeration."""
import itertools
import os
from pathlib import Path

import numpy as np
import pytest
from affine import Affine
from matplotlib.figure import Figure
from rasterio.crs import CRS
from shapely.geometry import box

from slope_tools.drawing import figures, maps
from slope_tools.plots import figure_charts, figure_maps, sheets
from slope_tools.plots.figure_charts import Convergence, Series
from slope_tools.survey.rasters import Raster

TOP = Path(__file__).resolve().parents[2]
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
LONG = "Thickness of the deposit at the end of a run with a name that is longer than most sheets of paper are wide"
RUN = "rolling 0.050000001, friction 27.5, restitution 0.48, field_e 0.12, spacing 1.25, quiet 0.0003, seed 1234567"
# rows, columns, cell, local corner: a usual site, a flume, a gully down the map, a steep corner, one of many digits
SITES = {"usual": (60, 90, 2.5, (0, 0)), "across": (12, 400, 1.0, (-200, 30)), "down": (400, 14, 1.0, (0, -15)),
         "small": (6, 5, 0.5, (0, 0)), "digits": (80, 100, 25.0, (-123450, 3456700))}
CRS_OF = {"usual": None, "across": "EPSG:6677", "down": "EPSG:6677", "small": None, "digits": "EPSG:32633"}


def site(name):
    """Layers of a site, and a thickness on it."""
    rows, columns, cell, (xlo, ylo) = SITES[name]
    transform = Affine(cell, 0, xlo, 0, -cell, ylo + rows * cell)
    x, y = transform @ np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    ground = 0.6 * (x - xlo) + 0.1 * (y - ylo)
    crs = CRS_OF[name] and CRS.from_user_input(CRS_OF[name])
    raster = Raster(ground, transform, crs, (1234567.0, 7654321.0) if crs else (0.0, 0.0))
    wide, tall = columns * cell, rows * cell
    shown = (xlo, ylo, xlo + wide, ylo + tall)
    release = (x - xlo > 0.6 * wide) & (x - xlo < 0.8 * wide)
    thickness = np.clip(8 - 10 * np.abs((x - xlo) / wide - 0.4), 0, None) + np.where(release, 30, 0)
    line = np.array([[xlo + 0.1 * wide, ylo + 0.5 * tall], [xlo + 0.5 * wide, ylo + 0.6 * tall],
                     [xlo + 0.9 * wide, ylo + 0.5 * tall]])
    road = box(xlo + 0.2 * wide, ylo, xlo + 0.3 * wide, ylo + tall)
    return figure_maps.Layers(raster, ground, shown, release, road, line, figures.contour_interval(ground)), thickness


@pytest.fixture
def drawn(monkeypatch):
    """Figures that were to become data URIs, laid out as they would be saved."""
    found = []

    def keep(figure, kind="png"):
        figure.draw_without_rendering()
        found.append(figure)
        return f"data:image/{kind};base64,AAAA"
    monkeypatch.setattr(figures, "data_uri", keep)
    return found


def labels(axis):
    """The labels of an axis that are seen."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-9 * (high - low)
    return [text for tick in axis.get_major_ticks() if low - slack <= tick.get_loc() <= high + slack
            for text in (tick.label1, tick.label2) if text.get_visible() and text.get_text()]


def texts_of(figure):
    """(text, its box in pixels) of all text but what is written into a map."""
    renderer = figure.canvas.get_renderer()
    found = list(figure.texts)
    for axes in figure.axes:
        for each in (axes, *axes.child_axes):
            if each.axison:
                found += [*labels(each.xaxis), *labels(each.yaxis), each.xaxis.label, each.yaxis.label, each.title]
    return [(text.get_text(), text.get_window_extent(renderer)) for text in found
            if text.get_visible() and text.get_text().strip()]


def overlap(one, other, slack=1.0):
    return (min(one.x1, other.x1) - max(one.x0, other.x0) > slack
            and min(one.y1, other.y1) - max(one.y0, other.y0) > slack)


def check_layout(figure):
    """No text on another one, on a map or beyond the paper."""
    texts = texts_of(figure)
    assert texts
    for (one, first), (other, second) in itertools.combinations(texts, 2):
        assert not overlap(first, second), f"{one!r} on {other!r}"
    boxes = [axes.get_window_extent() for axes in figure.axes if axes.axison]
    for text, place in texts:
        assert not any(overlap(place, box) for box in boxes), f"{text!r} on a map or a bar"
        assert -2 < place.x0 and place.x1 < figure.bbox.x1 + 2, f"{text!r} beyond the paper"
    for one, other in itertools.combinations(boxes, 2):
        assert not overlap(one, other)


def the_only(drawn):
    [figure] = drawn
    return figure


@pytest.mark.parametrize("width", [figures.FULL, figures.HALF])
@pytest.mark.parametrize("name", SITES)
def test_a_map_has_a_place_for_everything(drawn, name, width):
    layers, thickness = site(name)
    figure_maps.value_map(layers, thickness, LONG, "thickness of what lies there (m)", figures.classes_of(thickness),
                          "YlOrBr", width)
    figure = the_only(drawn)
    check_layout(figure)
    # the map keeps its shape
    map_ = figure.axes[0].get_window_extent()
    xlo, ylo, xhi, yhi = layers.shown
    assert map_.height / map_.width == pytest.approx((yhi - ylo) / (xhi - xlo), rel=1e-6)
    assert figure.get_size_inches()[0] == width


@pytest.mark.parametrize("name", SITES)
def test_the_terrain_and_the_mesh(drawn, name):
    layers, thickness = site(name)
    xlo, ylo, xhi, yhi = layers.shown
    inner = (xlo, ylo, xlo + (xhi - xlo) / 2, yhi)
    figure_maps.terrain_map(layers, inner)
    side = max(xhi - xlo, yhi - ylo) / 8
    mesh = Raster(np.full((3, 4), 1234.0), Affine(side, 0, xlo, 0, -side, yhi), None)
    figure_maps.mesh_map(layers, thickness, mesh, LONG)
    for figure in drawn:
        check_layout(figure)


def test_the_numbers_of_a_mesh_are_drawn_where_they_can_be_read(drawn):
    layers, thickness = site(next(iter(SITES)))
    xlo, _, xhi, yhi = layers.shown
    for parts, read in ((12, True), (80, False)):
        side = (xhi - xlo) / parts
        mesh = Raster(np.full((3, 4), 1234.0), Affine(side, 0, xlo, 0, -side, yhi), None)
        assert figure_maps.mesh_map(layers, thickness, mesh, LONG)[1] == read
        texts = [text.get_text() for axes in drawn[-1].axes for text in axes.texts]
        assert texts.count("1,234") == (12 if read else 0)


@pytest.mark.parametrize("count", [2, 9])
@pytest.mark.parametrize("name", SITES)
def test_maps_of_several_runs(drawn, name, count):
    layers, thickness = site(name)
    figure_maps.small_maps(layers, [(f"{RUN} {k}", thickness / (k + 1)) for k in range(count)], "thickness (m)",
                           figures.classes_of(thickness), "YlOrBr")
    figure = the_only(drawn)
    check_layout(figure)
    assert sum(axes.get_window_extent().height > 30 or name == "across" for axes in figure.axes) >= count


def check_overlap_is_found(figure):
    figure.text(0.01, 0.5, "x" * 400)
    with pytest.raises(AssertionError):
        check_layout(figure)


def test_the_outline_of_a_mapped_raster_is_that_of_its_cells(drawn):
    layers = site("usual")[0]
    mask = np.zeros(layers.raster.z.shape, bool)
    mask[10:20, 30:50] = True       # of 60 rows; cells of 2.5 m
    axes = Figure().add_subplot()
    figure_maps.draw_mapped(axes, layers._replace(mapped=mask))
    points = np.concatenate([path.vertices for one in axes.collections for path in one.get_paths()])
    assert [*points.min(axis=0), *points.max(axis=0)] == pytest.approx([75, 100, 125, 125])


@pytest.mark.parametrize("name, most, far, shares", [
    *((name, 1.0, 0, [95, 50, 5]) for name in SITES), ("usual", 0.7, 0, [50, 5]), ("usual", 0.3, 0, [5]),
    ("usual", 0.04, 0, []), ("usual", 1.0, 0.05, [95, 50]), ("usual", 1.0, 0.6, [95])])
def test_outlines_of_an_ensemble(drawn, name, most, far, shares):
    """A line and an entry of the legend for each share that the ensemble reaches and that is not beyond all runs."""
    layers, thickness = site(name)
    exceeded = figure_maps.Exceeded(most * thickness / thickness.max(), "known events", 0.1, far)
    for each in (layers, layers._replace(exceeded=exceeded)):
        figure_maps.value_map(each, thickness, LONG, "thickness (m)", figures.classes_of(thickness), "YlOrBr",
                              figures.FULL)
        check_layout(drawn[-1])
    before, after = (len(one.axes[0].collections) for one in drawn)
    texts = [text for text, _ in texts_of(drawn[-1]) if "of known events" in text]
    assert after - before == len(shares) or after > before and shares       # one for each, or for each of its parts
    assert texts == [f"thicker than 0.1 m in {one} % of known events" for one in shares]


def test_an_overlap_would_be_found(drawn):
    layers, thickness = site("usual")
    figure_maps.value_map(layers, thickness, LONG, "m", [0.1, 1, 40], "YlOrBr", figures.FULL)
    check_overlap_is_found(the_only(drawn))


# --- sections ---

def heights(length, drop, thick, count=200):
    """Distance, ground before, base, runs of a slope with a deposit of that thickness."""
    s = np.linspace(0, length, count)
    base = drop * (1 - s / length)
    thickness = np.where((s > 0.3 * length) & (s < 0.8 * length), thick, 0.0)
    before = base + np.where(s < 0.2 * length, thick, 0)
    return s, before, base, [(f"{RUN} {k}", base + thickness / (k + 1), thickness / (k + 1)) for k in range(3)]


@pytest.mark.parametrize("length, drop, thick", [(120, 40, 8), (3000, 1000, 3), (500, 900, 4), (4000, 1, 0.5),
                                                 (30, 0, 1), (9000, 40, 0.2)])
def test_a_section_has_a_place_for_everything(drawn, length, drop, thick):
    s, before, base, runs = heights(length, drop, thick)
    road = [(0.1 * length, 0.11 * length), (0.12 * length, 0.13 * length)]
    figure_charts.draw_section(s, before, base, runs, road, base + 1, LONG, bends=[0.4 * length, 0.6 * length])
    figure = the_only(drawn)
    check_layout(figure)


@pytest.mark.parametrize("length, drop, thick, factor, below", [
    (120, 40, 8, 1, False),             # all is seen as it is
    (600, 20, 2, 5, False),             # exaggerated until it is seen
    (3000, 1000, 3, 1, True)])          # no exaggeration would do: a panel of its own
def test_the_deposit_is_seen_on_the_section(drawn, length, drop, thick, factor, below):
    s, before, base, runs = heights(length, drop, thick)
    _, told, told_below = figure_charts.draw_section(s, before, base, runs, [], None, "Section")
    figure = the_only(drawn)
    axes = figure.axes[0]
    place = axes.get_window_extent()
    per_metre = place.height / np.ptp(axes.get_ylim()) / (place.width / np.ptp(axes.get_xlim()))
    assert told == factor and per_metre == pytest.approx(factor, rel=1e-6)
    names = [text for text, _ in texts_of(figure)]
    assert ("height (m)" if factor == 1 else f"height (m), {factor} times exaggerated") in names
    assert (told_below is not None) == below
    seen = figure.axes[1] if below else axes
    inches = seen.get_window_extent().height / figure.dpi / np.ptp(seen.get_ylim()) * thick
    assert inches >= 0.9 * figure_charts.VISIBLE
    if below:
        place = seen.get_window_extent()
        shown = place.height / np.ptp(seen.get_ylim()) / (place.width / np.ptp(seen.get_xlim()))
        assert shown == pytest.approx(told_below, rel=1e-6)
        assert f"thickness (m), {told_below:g} times exaggerated" in names


# --- charts ---

def test_charts_have_a_place_for_everything(drawn):
    x = [0.0, 0.0, 0.05, 0.05, 0.1, 0.1]
    series = [Series(f"{RUN} {k}", x, [14000.0 + 100 * k + i for i in range(6)], 350.0, bool(k)) for k in range(4)]
    others = [Series(f"elsewhere {LONG}", [0, 0.1], [2e4, 3e4])]
    for width in (figures.FULL, figures.WIDE, figures.HALF):
        figure_charts.chart(series, "rolling resistance (-)", "to remove (m3)", LONG, others, [(LONG, 14225.0)],
                            (0.05, 14100.0, f"largest of 6 runs, {LONG}"), width)
    figure_charts.bars([RUN, "b", "c"], [3.0, 1e5, 2.0], "to remove (m3)", LONG)
    figure_charts.convergence(Convergence([4, 8, 16], [8000, 12000, 15000], [300, None, 100]),
                              "balls over the thickness of the body", "to remove (m3)", LONG)
    assert len(drawn) == 5
    for figure in drawn:
        check_layout(figure)


@pytest.mark.parametrize("joined", [True, False])
def test_a_line_is_drawn_only_for_a_trend(drawn, joined):
    figure_charts.chart([Series("", [0, 0, 1, 1], [1.0, 3.0, 5.0, 7.0], 1.4, joined)], "x", "y", "t")
    axes = max(the_only(drawn).axes, key=lambda axes: axes.get_window_extent().height)
    lines = [line for line in axes.lines if len(line.get_xdata()) == 2 and line.get_linewidth() > 1.5]
    means = [line for line in axes.lines if np.array_equal(line.get_ydata(), [2.0, 6.0])]
    assert len(means) == 1 and bool(lines) == joined


# --- classes and ticks ---

@pytest.mark.parametrize("largest", [0.004, 0.03, 0.3, 0.9, 1.9, 2.0, 4.9, 7, 19, 20, 33, 120, 1e4])
def test_classes_hold_the_largest(largest):
    bounds = figures.classes(largest)
    assert bounds == sorted(set(bounds)) and 3 <= len(bounds) <= 12
    assert bounds[-1] >= largest > bounds[-2]
    assert 0 < bounds[0] <= largest / 2


def test_classes_are_those_of_the_deposit_not_of_the_release():
    deposit, release = np.linspace(0.2, 3.9, 400), np.full(200, 60.0)
    apart = np.arange(600) >= 400
    values = np.concatenate([deposit, release])
    bounds = figures.classes_of(values, apart)
    assert bounds == [0.1, 0.5, 1, 2, 3, 4, 60]
    assert figures.classes_of(values) != bounds         # the mask decides
    # a few thick cells do not set them either
    assert figures.classes_of(np.concatenate([deposit, [45.0]])) == [0.1, 0.5, 1, 2, 3, 4, 50]
    # next to nothing outside: all cells count
    assert figures.classes_of(release, np.ones(200, bool))[-1] == 60
    assert figures.classes_of(np.zeros(50)) == [0.1, 1.0]
    assert figures.classes_of(np.full(50, 0.02))[-1] >= 0.02


def test_bounds_are_round_numbers():
    for largest in (0.3, 3.3, 17.0, 61.3, 440.0):
        values = np.linspace(0, largest, 500)
        for bound in figures.classes_of(values)[1:]:
            assert float(f"{bound:.2g}") == pytest.approx(bound, rel=1e-9)


@pytest.mark.parametrize("value, expected", [(7, 8), (1, 1), (45, 50), (0.31, 0.4), (8.1, 10), (60, 60)])
def test_above(value, expected):
    assert figures.round_up_nicely(value) == pytest.approx(expected)


@pytest.mark.parametrize("low, high", [(0, 1), (-5, 3), (1e6, 1e6 + 7), (0.1, 0.11), (3, 997), (-0.2, 0.3)])
@pytest.mark.parametrize("most", [1, 2, 3, 7])
def test_ticks_are_few_round_and_inside(low, high, most):
    found = figures.ticks(low, high, most)
    assert 1 <= len(found) <= most and all(low <= value <= high for value in found)
    assert len(found) >= most / 4
    if len(found) > 2:
        assert np.ptp(np.diff(found)) == pytest.approx(0, abs=1e-9)


def test_no_ticks_where_there_is_no_range():
    assert figures.ticks(1, 1, 3) == [] and figures.ticks(0, 1, 0) == []


@pytest.mark.parametrize("length, expected", [(1, 1), (1.99, 1), (2, 2), (60, 50), (0.37, 0.2), (5000, 5000)])
def test_nice(length, expected):
    assert figures.nice(length) == pytest.approx(expected)


def test_text_is_wrapped_and_cut_to_its_room():
    lines = figures.wrapped(LONG, 1.5, 7, most=3)
    assert len(lines) == 3 and lines[-1].endswith("...")
    assert all(figures.text_width(line, 7) <= 1.5 for line in lines)
    assert figures.wrapped("short", 1.5, 7) == ["short"]
    assert figures.wrapped("x" * 500, 1.0, 7)[0].endswith("...")
    assert " ".join(figures.wrapped(LONG, 3, 7, most=9)) == LONG


def test_shade_of_planes():
    x, y = np.meshgrid(np.arange(9.0), np.arange(9.0))      # y to the south
    flat = maps.shade(0 * x, 1.0)
    assert flat == pytest.approx(np.sqrt(0.5))
    to_the_light = maps.shade(0.3 * (x + y), 1.0)        # falls to the north-west
    away = maps.shade(-0.3 * (x + y), 1.0)
    assert to_the_light.min() > flat.max() > away.max()


def test_names_may_hold_dollars(drawn):
    layers, thickness = site("usual")
    figure_maps.small_maps(layers, [("a_$x^{2$", thickness), ("$", thickness)], "m", [0.1, 1, 40], "YlOrBr")
    figure_charts.bars(["$a_", "b$^"], [1.0, 2.0], "y", "cost in $ and $")
    for figure in drawn:
        check_layout(figure)


def test_layout_takes_the_columns_that_make_the_maps_largest():
    frame = sheets.Frame((0, 0, 1000, 100), False)
    assert sheets.layout(3, frame, 6.0, 8.0)[0] == 1
    assert sheets.layout(3, frame._replace(shown=(0, 0, 100, 1000)), 6.0, 8.0)[0] == 3
