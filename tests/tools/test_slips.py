"""Bodies above slip surfaces: factor of safety and yield coefficient against Scoops3D and closed forms."""
import numpy as np
import pytest
from affine import Affine
from scipy.integrate import trapezoid

from slope_tools.slips import bishop, chart, columns
from slope_tools.slips.bishop import Strengths
from slope_tools.survey.rasters import Raster

CELL = 0.5


def ground(height, columns_, rows, cell=CELL):
    """A terrain z = height(x), rows from the north."""
    x = cell * (np.arange(columns_) + 0.5)
    return Raster(np.tile(height(x), (rows, 1)), Affine(cell, 0, 0, 0, -cell, rows * cell), None)


def embankment(low, foot, rise, size):
    """Rising to +x from low to 35 m."""
    return ground(lambda x: np.clip(low + (x - foot) * rise, low, 35.0), *size)


# Scoops3D 1.0 with columns of a quarter of a cell; unit weights as given, 20 and 18.82 kN/m3
CASES = [(embankment(25.0, 10.25, 0.5, (102, 101)), (10.25, 25.25, 54.0), 28.9617, 3e3, 19.6, 20e3,
          1.0405, 788.48),
         (embankment(15.0, 18.25, 1 / 1.5, (133, 133)), (25.75, 33.25, 49.0), 36.6347, 41.65e3, 15.0, 18.82e3,
          1.5982, 14419.9)]


def write_columns(path, raster, centre, radius, density, water=0.0):
    """PREFIX.N.columns.csv of a sphere, with a column per cell; returns their area. water: the height of its table."""
    x, y = columns.centres(raster)
    dx, dy = x - centre[0], y - centre[1]
    e = np.sqrt(np.maximum(radius ** 2 - dx ** 2 - dy ** 2, 1e-9))
    kept = columns.find_largest_part(raster, np.where(e > 1e-4, centre[2] - e, np.nan))
    dx, dy, e, top = (one[kept] for one in (dx, dy, e, raster.z))
    low, area = centre[2] - e, np.full(len(e), raster.transform.a ** 2)
    rows = np.column_stack([dx, dy, e, area, dx / e, dy / e, density * columns.GRAVITY * area * (top - low),
                            centre[2] - (top + low) / 2, 1e3 * columns.GRAVITY * np.maximum(water - low, 0)])
    np.savetxt(path, rows, "%.8g", ",", header=columns.HEAD, comments="")
    return float(area.sum())


@pytest.mark.parametrize("z, centre, radius, c, phi, gamma, factor, volume", CASES, ids=["10m", "20m"])
def test_spheres_of_scoops3d(z, centre, radius, c, phi, gamma, factor, volume):
    body = columns.of_sphere(z, centre, radius, 180.0, gamma / columns.GRAVITY)
    soil = Strengths(c, np.tan(np.radians(phi)))
    assert body.volume == pytest.approx(volume, rel=5e-3)
    assert bishop.factor_of_safety(body, soil)[0] == pytest.approx(factor, rel=5e-3)


@pytest.mark.parametrize("water, vertical", [(0.0, 0.0), (0.3, 0.0), (0.2, 0.15), ("table", -0.1)])
def test_factor_is_1_at_the_yield_coefficient_of_every_strength(water, vertical):
    z, centre, radius = CASES[1][:3]
    table = np.full(z.z.shape, 22.0) if water == "table" else None
    body = columns.of_sphere(z, centre, radius, 170.0, 1900.0, table=table)
    c, t = np.random.default_rng(1).uniform([1e3, 0.1], [6e4, 0.7], (200, 2)).T
    soil = Strengths(c, t, 0.0 if table is not None else water)
    k = bishop.yield_coefficient(body, soil, vertical)
    found = [bishop.factor_of_safety(body, Strengths(*(one[i] for one in soil.arrays())), float(k[i]), vertical)[0]
             for i in range(0, 200, 20)]
    assert np.abs(np.array(found) - 1).max() < 1e-6
    assert np.ptp(k) > 0.3


def test_what_nothing_drives_has_an_infinite_factor_and_what_is_not_found_none(monkeypatch):
    """Normal forces that outweigh the load at every F; a cohesion that makes them do so at small F alone, of which
    there is a larger one; and too few steps."""
    z, centre, radius, *_ = CASES[0]
    body, soil = columns.of_sphere(z, centre, radius, 180.0, 2000.0), Strengths(np.array([3e3, 6e3]), 0.4)
    load = float(bishop.driving(body))
    push = load / body.weight.sum()         # m, a lever that makes normal forces about as large as the load
    assert (bishop.factor_of_safety(body._replace(normal=np.full(len(body.u), -2 * push)), soil) == np.inf).all()
    assert (bishop.factor_of_safety(body, soil, -1.0) == np.inf).all()
    late, stiff = body._replace(normal=2 * push * body.sine), Strengths(np.array([3e3, 3e5]), 0.4)
    found = bishop.factor_of_safety(late, stiff)
    first = load + bishop.resistance(body, stiff, np.ones(2)) - bishop.resistance(late, stiff, np.ones(2))
    assert first[0] > 0 > first[1] and found[0] < 1 < found[1] < 1000
    assert bishop.resistance(late, stiff, found) == pytest.approx(load, rel=1e-6)
    monkeypatch.setattr(bishop, "MOST_STEPS", 2)
    assert np.isnan(bishop.factor_of_safety(body, soil)).all()


def plane(beta, cell=0.1):
    return ground(lambda x: np.tan(beta) * x, 400, 400, cell)


def test_no_friction_on_a_plane_slope_is_the_closed_form():
    """F = c int sqrt(R^2 - v^2) dA / (gamma V zbar sin beta), here for a sphere with its centre above the slope."""
    beta, radius, height = np.radians(30.0), 16.0, 10.0     # height of the centre above the slope, along its normal
    foot = np.array([20.0, 20.0, 20.0 * np.tan(beta)])
    centre = foot + height * np.array([-np.sin(beta), 0.0, np.cos(beta)])
    body = columns.of_sphere(plane(beta), centre, radius, 180.0, 2000.0)
    zbar_v = np.pi * (radius ** 2 - height ** 2) ** 2 / 4       # of the cap, about the centre
    v = np.linspace(-1, 1, 200001)[1:-1] * np.sqrt(radius ** 2 - height ** 2)
    ring = np.sqrt(radius ** 2 - v ** 2)        # the cap's arc at v has the angle 2 acos(height / ring)
    surface = 2 * ring * np.arccos(height / ring) * radius / ring
    moment = 5e4 * trapezoid(ring * surface, v)
    expected = moment / (2000.0 * columns.GRAVITY * zbar_v * np.sin(beta))
    assert bishop.factor_of_safety(body, Strengths(5e4, 0.0))[0] == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("k, water", [(0.0, 0.0), (0.2, 0.0), (0.0, 0.2)])
def test_dry_cap_without_cohesion_is_the_infinite_slope(k, water):
    beta, radius = np.radians(25.0), 150.0
    height = radius * np.cos(np.radians(5.0))
    centre = np.array([20.0, 20.0, 20.0 * np.tan(beta)]) + height * np.array([-np.sin(beta), 0.0, np.cos(beta)])
    body = columns.of_sphere(plane(beta), centre, radius, 180.0, 1800.0)
    tan, slope = 0.6, np.tan(beta)
    expected = tan * ((1 - k * slope) - water / np.cos(beta) ** 2) / (slope + k)
    found = bishop.factor_of_safety(body, Strengths(0.0, tan, water), k)[0]
    assert found == pytest.approx(expected, rel=5e-3)
    if not k and not water:     # the weight does not matter
        assert bishop.factor_of_safety(body, Strengths(0.0, tan), 0.0, 0.3)[0] == pytest.approx(found, rel=1e-9)


@pytest.mark.parametrize("direction", [180.0, 165.0])
def test_columns_of_a_file_are_those_of_the_sphere(tmp_path, direction):
    z, centre, radius = CASES[0][:3]
    write_columns(tmp_path / "a.1.columns.csv", z, centre, radius, 1900.0, 29.0)
    found = columns.read_slip_columns(tmp_path / "a.1.columns.csv", direction)
    expected = columns.of_sphere(z, centre, radius, direction, 1900.0, np.full(z.z.shape, 29.0))
    assert found.normal is None and expected.normal is None
    for name in set(columns.Columns._fields) - {"normal", "volume"}:
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-6, abs=1e-5), name


def test_what_is_connected_and_what_is_not_below_ground():
    z = CASES[0][0]
    with pytest.raises(columns.SlopeError, match="must be below the ground somewhere"):
        columns.of_sphere(z, (10.0, 25.0, 80.0), 20.0, 180.0, 2000.0)
    ridges = ground(lambda x: 10 + 3 * np.cos(x / 3), 100, 60)
    kept = columns.find_largest_part(ridges, columns.base_of(ridges, (23.0, 15.0, 40.0), 30.5))
    x = columns.centres(ridges)[0]
    assert 5 < np.ptp(x[kept]) < 19       # one ridge of several below


@pytest.mark.drawn
def test_the_map_of_a_search_has_all_that_was_searched(tmp_path, monkeypatch):
    """50 x 20 m: x from west to east, y from south to north."""
    def save(figure, *_, **__):
        shown.extend((*figure.axes[0].get_xlim(), *figure.axes[0].get_ylim()))
    shown = []
    monkeypatch.setattr(chart.pictures, "save", save)
    raster = ground(lambda x: 10 + x / 2, 100, 40)
    chart.draw_slips(tmp_path / "a.png", raster, np.ones((40, 100)), [], [], "a search")
    assert shown == [0, 50, 0, 20]
