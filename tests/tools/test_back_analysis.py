"""slope stability --failed: the strengths with which a body has F = 1, for spheres and for other surfaces."""
from pathlib import Path

import numpy as np
import pytest
import yaml

from run_helpers import called, write_asc
from test_slips import CASES, embankment, ground, plane, write_columns
from tiny_collapse import rows_of

from slope_tools.commands import stability
from slope_tools.slips import back, bishop, columns, failed
from slope_tools.slips.bishop import Strengths

HIGH = CASES[1]


@pytest.mark.parametrize("k, kv, water", [(0.0, 0.0, 0.0), (0.2, -0.1, 0.0), (0.1, 0.0, 0.3)])
def test_the_factor_is_1_along_the_line(k, kv, water):
    body = columns.of_sphere(*HIGH[:3], 180.0, 1900.0)
    found = back.line(body, k, kv, water)
    assert found.friction[0] == 0 and found.friction[-1] > 10 and found.cohesion[-1] < 1e-6 * found.cohesion[0]
    assert (np.diff(found.cohesion) < 0).all()
    for phi, c in list(zip(*found))[::15]:
        soil = Strengths(c, np.tan(np.radians(phi)), water)
        assert bishop.factor_of_safety(body, soil, k, kv)[0] == pytest.approx(1, abs=1e-6)


def test_the_line_goes_through_the_published_strength_over_its_factor():
    """Scoops3D's sphere: F 1.5982 with 41.65 kPa and 15 degrees, so F is 1 with both divided by it."""
    z, centre, radius, c, phi, gamma, factor, _ = HIGH
    body = columns.of_sphere(z, centre, radius, 180.0, gamma / columns.GRAVITY)
    assert back.cohesion_of(body, np.tan(np.radians(phi)) / factor)[0] == pytest.approx(c / factor, rel=0.01)


def test_the_raster_of_a_sphere_is_the_sphere():
    z, centre, radius = HIGH[:3]
    exact = columns.of_sphere(z, centre, radius, 180.0, 1900.0)
    base = columns.base_of(z, centre, radius)
    inside = columns.find_largest_part(z, base)
    found, size = back.sphere_of(back.list_base_points(z, base, inside))
    assert found == pytest.approx(centre, abs=1e-6) and size == pytest.approx(radius, abs=1e-6)
    assert back.steepest(z, base, inside, found) == pytest.approx(180, abs=1e-6)
    raster = columns.of_raster(z, base, inside, found, 180.0, 1900.0)
    assert np.abs(raster.normal).max() < 0.05 * radius        # the dip is that of differences
    assert raster.volume == pytest.approx(exact.volume, rel=1e-9)
    for phi in (0.0, 15.0, 30.0):
        of = [back.cohesion_of(one, np.tan(np.radians(phi)), 0.3)[0] for one in (exact, raster)]
        assert of[1] == pytest.approx(of[0], rel=0.01)


def test_a_long_ellipsoid_is_that_of_the_core():
    """The least circle of the profile, 15 times as wide as high: F 1.526 by exact columns (test_slip_factor.cpp)."""
    terrain = embankment(15.0, 18.25, 1 / 1.5, (133, 2161))
    x, y = columns.centres(terrain)
    middle = 0.5 * 2161 * 0.5
    left = 32.26 ** 2 - (x - 25.94) ** 2 - ((y - middle) / 15) ** 2
    base = 46.34 - np.sqrt(np.where(left > 0, left, np.nan))
    body = columns.of_raster(terrain, base, columns.find_largest_part(terrain, base), (25.94, middle, 46.34), 180.0,
                             18.82e3 / columns.GRAVITY)
    soil = Strengths(41.65e3, np.tan(np.radians(15.0)))
    assert bishop.factor_of_safety(body, soil)[0] == pytest.approx(1.526, rel=0.01)


@pytest.mark.parametrize("axis", [(-5.0, 20.0, 60.0), (30.0, 20.0, 300.0)])
def test_a_plane_slab_is_the_infinite_slope_about_any_axis(axis):
    """Of even thickness, so that the ends do not count: F = c / (gamma h sin cos) + tan phi / tan beta."""
    beta, thick = np.radians(30.0), 2.0
    slope = plane(beta, 0.5)
    inside = np.zeros(slope.z.shape, bool)
    inside[100:200, 50:350] = True
    body = columns.of_raster(slope, slope.z - thick, inside, axis, 180.0, 2000.0)
    assert np.abs(body.normal).max() > 1
    expected = 5e3 / (2000 * columns.GRAVITY * thick * np.sin(beta) * np.cos(beta)) + 0.4 / np.tan(beta)
    assert bishop.factor_of_safety(body, Strengths(5e3, 0.4))[0] == pytest.approx(expected, rel=1e-6)
    assert back.cohesion_of(body, 0.4 / expected)[0] == pytest.approx(5e3 / expected, rel=1e-6)


def test_what_a_raster_has_beside_the_body_does_not_count(tmp_path):
    """The coarse sphere, with the ground around it and with nothing: one line, that of the sphere; no cell is lost."""
    _, centre, radius, *_ = HIGH
    z = ground(lambda x: np.clip(15 + (x - 18.25) / 1.5, 15, 35), 27, 27, 2.5)
    base = columns.base_of(z, centre, radius)
    body = columns.find_largest_part(z, base + failed.LEAST)
    exact = columns.of_sphere(z, centre, radius, 180.0, 1900.0)
    found = []
    for beside in (z.z, z.z - 0.04, np.nan, base):
        write_asc(tmp_path / "scar.asc", np.where(body, base, beside), 2.5)
        found.append(failed.read_failed_body(str(tmp_path / "scar.asc"), z, 180.0, 1900.0))
        assert found[-1].cells == body.sum() and found[-1].columns.volume == pytest.approx(exact.volume, rel=1e-3)
    for phi in (0.0, 10.0, 20.0):
        lines = [back.cohesion_of(one, np.tan(np.radians(phi)))[0] for one in (exact, *(one.columns for one in found))]
        assert lines[2:] == pytest.approx([lines[1]] * 3, rel=1e-9)
        assert lines[1] == pytest.approx(lines[0], abs=0.03 * back.cohesion_of(exact, 0.0)[0])


def test_cells_without_a_neighbour_have_the_dip_of_the_nearest():
    """An even slab three cells wide with a tip of one: all of it dips as the slope; a strip is level across."""
    slope = plane(np.radians(30.0), 0.5)
    inside = np.zeros(slope.z.shape, bool)
    inside[100:103, 50:80] = inside[101, 80:90] = inside[103:105, 60] = True
    body = columns.of_raster(slope, slope.z - 2, inside, (30.0, 20.0, 300.0), 180.0, 2000.0)
    assert body.sine == pytest.approx(0.5, abs=1e-9) and body.cosine == pytest.approx(np.cos(np.radians(30)), abs=1e-9)
    assert columns.count_alone(inside) == 12
    inside[:] = False
    inside[100, 50:80] = True
    strip = columns.of_raster(slope, slope.z - 2, inside, (30.0, 20.0, 300.0), 180.0, 2000.0)
    assert strip.sine == pytest.approx(0.5, abs=1e-9) and columns.count_alone(inside) == 30


# --- the command ---

@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_asc("terrain.asc", HIGH[0].z, 0.5)
    return tmp_path


def ran(capsys, words):
    return called(capsys, ["stability", *f"terrain.asc --density 1919.1 {words}".split()])


def table():
    return np.array([list(row.values()) for row in rows_of("out/back.csv", float)]).T


@pytest.mark.drawn
def test_a_sphere_its_table_and_its_raster(here, capsys):
    (x, y, z), radius = HIGH[1:3]
    base = columns.base_of(HIGH[0], HIGH[1], radius)
    write_asc("scar.asc", np.where(columns.find_largest_part(HIGH[0], base), base, HIGH[0].z), 0.5)
    area = write_columns("crit.1.columns.csv", *HIGH[:3], 1919.1)
    volume = columns.of_sphere(*HIGH[:3], 180.0, 1919.1).volume
    Path("crit.slips.csv").write_text("rank,x,y,z,radius,direction,volume,area\n"
                                      f"1,{x},{y},{z},{radius},180,{volume},{area}\n")
    write_asc("crit.1.base.asc", base, 0.5)
    found = []
    for name in (f"{x},{y},{z},{radius}", "crit.slips.csv", "scar.asc"):
        status, out, err = ran(capsys, f"--failed {name} --seismic 0.2939 --overwrite -o out")
        assert status == 0, err
        found.append(table())
        assert "sliding to 270.0 degrees" in out
    assert np.interp(15.0, *found[0]) == pytest.approx(41.65e3, rel=0.01)     # its yield coefficient is 0.2939
    assert found[1] == pytest.approx(found[0], rel=1e-6, abs=1e-2)
    assert found[2][1][0] == pytest.approx(found[0][1][0], rel=0.03)
    assert found[2][0][-1] == pytest.approx(found[0][0][-1], rel=0.03)
    about = yaml.safe_load(Path("out/back.yaml").read_text())
    assert about["radius"] == pytest.approx(radius, rel=0.02) and about["seismic"] == [0.2939, 0.0]
    assert Path("out/back.png").stat().st_size > 5000


def test_a_plane_scar_has_a_far_axis(here, capsys):
    """A slab of 0.5 m on a slope of 1:1.5: the infinite slope, at its rim, too."""
    slab = HIGH[0].z.copy()
    slab[40:90, 50:90] -= 0.5
    write_asc("scar.asc", slab, 0.5)
    status, out, err = ran(capsys, "--failed scar.asc -o out")
    assert (status, err) == (0, "")
    about = yaml.safe_load(Path("out/back.yaml").read_text())
    assert about["volume"] == pytest.approx(250, rel=1e-6) and about["bearing"] == pytest.approx(270, abs=0.5)
    assert np.isinf(about["radius"])
    beta = np.arctan(1 / 1.5)
    assert table()[1][0] == pytest.approx(1919.1 * columns.GRAVITY * 0.5 * np.sin(beta) * np.cos(beta), rel=1e-5)
    assert table()[0][-1] == pytest.approx(np.degrees(beta), rel=1e-5)


def test_a_hollow_that_is_no_sphere(here, capsys):
    """Twice as curved across: the nearest sphere is nearer than a plane; what a far axis changes is said."""
    x, y = columns.centres(HIGH[0])
    depth = 9 - 0.02 * (x - 36) ** 2 - 0.035 * (y - 33) ** 2
    write_asc("scar.asc", HIGH[0].z - np.maximum(depth, 0), 0.5)
    status, _, err = ran(capsys, "--failed scar.asc -o out")
    about = yaml.safe_load(Path("out/back.yaml").read_text())
    assert status == 0 and 15 < about["radius"] < 50
    assert not err and not about["warnings"]        # by less than a tenth
    body = failed.read_failed_body("scar.asc", HIGH[0], None, 1919.1)
    line = back.line(body.columns)
    assert abs(back.line(body.far).cohesion[0] / line.cohesion[0] - 1) < 0.1
    [text] = map(str, stability.failed_warnings(body, line, line._replace(cohesion=1.2 * line.cohesion)))
    assert "depends on the axis of moments" in text and "+20 %" in text
    some = [list(stability.failed_warnings(body._replace(alone=int(share * body.cells)), line, None))
            for share in (0.09, 0.12)]
    assert [[one.kind for one in of] for of in some] == [[], ["narrow"]]


@pytest.mark.parametrize("words, rule", [
    ("--failed nowhere", "--failed: must be X,Y,Z,R"),
    ("--failed 25,33,90,20", "the slip surface: must be below the ground somewhere"),
    ("--failed 25.75,33.25,49,36.6 --cohesion 3", "--cohesion: must not be given with --failed"),
    ("--failed 25.75,33.25,49,36.6 --keep 2", "--keep: must not be given with --failed"),
    ("--failed 25.75,33.25,49,36.6 --seismic -1", "--seismic: must be KH >= 0"),
    ("--failed 25.75,33.25,49,36.6 --water 1", "--water: must be 0 to below 1, got 1"),
    ("--failed 25.75,33.25,49,36.6 --direction 90", "--failed: must be a body that its weight"),
    ("--failed small.asc", "small.asc: must be on the cells of the terrain"),
    ("--friction 30", "--cohesion: must be given, or --failed"),
])
def test_bad_input_is_one_line(here, capsys, words, rule):
    write_asc("small.asc", np.zeros((4, 4)), 0.5)
    status, _, err = ran(capsys, f"{words} -o out")
    assert status == 2 and err.count("\n") == 1 and rule in err
    assert not Path("out").exists()
