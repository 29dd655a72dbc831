"""Walls along lines: closed meshes that follow the ground, over which no ball comes."""
import collections
import shutil
import subprocess

import numpy as np
import pytest
import yaml
from affine import Affine
from shapely.geometry import LineString

from test_site import BODY, gis, told, write_layer  # noqa: F401
from test_site_anew import inside, once  # noqa: F401
from tiny_collapse import LMP

from slope_tools.errors import SlopeError
from slope_tools.sites import site_choices, site_inputs, site_walls, site_warnings
from slope_tools.survey.rasters import Raster, read_asc_local
from slope_tools.survey.resampling import sample

BENT = LineString([(20, 20), (45, 24), (60, 60), (62, 90)])


def raster(height, side=100, cell=2.0):
    """A terrain of heights over x, y."""
    n = int(side / cell)
    x, y = np.meshgrid((np.arange(n) + 0.5) * cell, side - (np.arange(n) + 0.5) * cell)
    return Raster(height(x, y), Affine(cell, 0, 0, 0, -cell, side), None, (0.0, 0.0))


GROUNDS = {"level": lambda x, y: 0 * x + 50, "plane": lambda x, y: 50 + 0.7 * x - 0.3 * y,
           "bowl": lambda x, y: 50 + ((x - 50) ** 2 + (y - 50) ** 2) / 100,
           "ridge": lambda x, y: 90 - np.abs(x - 50), "steps": lambda x, y: 50 + 8 * np.floor(x / 10)}


@pytest.mark.parametrize("width", [0.3, 1.0, 6.0])
@pytest.mark.parametrize("name", GROUNDS)
def test_it_is_closed_and_as_high_above_the_ground_everywhere(name, width):
    ground = raster(GROUNDS[name])
    found = np.round(site_walls.triangles("line", BENT, ground, 5.0, width), 4)
    edges = collections.Counter((tuple(one[k]), tuple(one[(k + 1) % 3])) for one in found for k in range(3))
    assert set(edges.values()) == {1} and all((b, a) in edges for a, b in edges)     # closed, one sense of turning
    volume = np.einsum("ni,ni->n", found[:, 0], np.cross(found[:, 1], found[:, 2])).sum() / 6
    assert volume > 5 * BENT.length * width          # outwards
    along = np.linspace(0, BENT.length, 300)
    at = np.array([BENT.interpolate(one).coords[0] for one in along])
    z = sample(ground, *at.T)
    assert found[:, :, 2].min() < z.min() - 4.9
    share = np.array([0, 0.5, 1])[:, None]
    points = np.concatenate([a + (b - a) * share for a, b in tops(found)])
    top, under = points[:, 2], sample(ground, *points[:, :2].T)
    assert (top >= under + 5 - 0.05).all(), (top - under).min()
    if name in ("level", "plane", "bowl"):
        assert (top <= under + 5 + 1.2 * (1 + width)).all()


def tops(found):
    """The edges of the top, of its two sides."""
    foot = found[:, :, 2].min()
    for one in found:
        if (one[:, 2] > foot + 1).all():
            for a, b in zip(one, np.roll(one, -1, axis=0)):
                yield a, b


@pytest.mark.parametrize("points, width, start", [
    ([(20, 20), (60, 20), (21, 24)], 1.0, "line: must not turn by more than 150 degrees"),
    ([(20, 20), (60, 20), (60, 60), (40, 60), (40, 10)], 1.0, "line: must not turn so sharply"),
    ([(20, 20), (60, 20), (61, 21), (60, 22)], 8.0, "line: must not turn so sharply"),
    ([(20, 20), (101, 20)], 1.0, "line: must lie within the terrain"),
    ([(20, 99.8), (60, 99.8)], 1.0, "line: must lie within the terrain")])
def test_refused_lines(points, width, start):
    with pytest.raises(SlopeError, match=start):
        site_walls.triangles("line", LineString(points), raster(GROUNDS["level"]), 5.0, width)


def test_where_nothing_is_known_of_the_ground():
    ground = raster(GROUNDS["level"])
    ground.z[20:30, 20:30] = np.nan
    with pytest.raises(SlopeError, match="where its height is known"):
        site_walls.triangles("line", BENT, ground, 5.0, 1.0)


@pytest.mark.parametrize("name, line, lift, stands", [
    ("level", [(30, 50), (70, 50)], 0, True), ("plane", [(50, 20), (50, 80)], 0, True),
    ("level", [(10, 20), (90, 20)], 0, False), ("level", [(10, 30.5), (90, 30.5)], 0, False),      # beside, at the rim
    ("level", [(30, 50), (70, 50)], 30, False), ("level", [(30, 50), (70, 50)], -30, False)])      # above it and below
def test_what_stands_in_the_body_is_named(tmp_path, name, line, lift, stands):
    """A body of 4 m, 40 m x 40 m, and a mesh of 5 m above the ground, or 30 m higher or lower."""
    ground = raster(GROUNDS[name])
    depth = np.zeros(ground.z.shape)
    depth[15:35, 15:35] = 4.0
    mesh = site_walls.triangles("line", LineString(line), ground, 5.0, 1.0) + [0, 0, lift]
    (tmp_path / "one.stl").write_text(site_walls.stl("one", mesh))
    one = site_inputs.placed("one", mesh, 5.0)._replace(given="--wall line.csv")
    if not stands:
        return site_inputs.check_beside_body([one], tmp_path, ground, depth)
    with pytest.raises(SlopeError, match="--wall line.csv: must not stand in the release area.*got local x y [34]. 49"):
        site_inputs.check_beside_body([one], tmp_path, ground, depth)


STANDARD = " ".join(["--terrain dem.tif --release release.geojson", *BODY])


def write_wall_lines(folder):
    write_layer(folder / "wall.geojson", [(44, 1), (40, 30), (39, 50), (44, 79)], kind=LineString)


def test_options_and_keys(inside, gis):  # noqa: F811
    write_wall_lines(gis)
    write_layer(gis / "second.geojson", [(20, 10), (20, 70)], "EPSG:4326", kind=LineString)
    assert "\nslope site: --height: must be given" in "\n" + inside(f"{STANDARD} --wall wall.geojson -o none", 2).err
    out = inside(f"{STANDARD} --wall wall.geojson --wall second.geojson --height 8 -o mine").out
    choices = site_choices.load_site(gis / "mine").choices.structures
    assert choices.height == 8 and choices.width is None and len(choices.walls) == 2
    assert "wall.stl: " in out and "second.stl" in out
    deck = (gis / "mine" / "in.site").read_text()
    assert "wall/gran/mesh 4 wall.stl point" in deck and "create_box  4" in deck
    corners = site_inputs.corners(str(gis / "mine" / "second.stl"))
    assert np.ptp(corners[..., 0]) == pytest.approx(1, abs=0.01)
    assert np.ptp(corners[..., 1]) == pytest.approx(60, abs=0.1)
    write_layer(gis / "within.geojson", [(60, 35), (60, 45)], kind=LineString)
    # in the body, and in the site as it was; too high for a wall, and a mesh for no volume.csv
    assert "--wall within.geojson: must not stand in the" in inside("mine --wall within.geojson", 2).err
    assert "--mesh: must give at most" in inside("mine --mesh 1e-3 --road release.geojson", 2).err
    assert "--height 400: is it in m" in inside("mine --height 400 --verbose").err
    # lower than a ball: both walls in a line, with what smaller balls take; the meshes alone say it, too
    err = inside("mine --height 1.5 --diameter 3").err
    [line] = [one for one in err.splitlines() if "lower" in one or "less than a ball" in one]
    assert "wall, second: the wall is 1.5 m high, less than a ball of 3 m" in line
    assert "--diameter 1.5, about 16.0" in line
    found = yaml.safe_load((gis / "mine" / site_warnings.NAME).read_text())
    assert [one["numbers"]["name"] for one in found if one["kind"] == "low wall"] == ["wall", "second"]
    ground = read_asc_local(gis / "mine" / "terrain.asc")
    again = site_inputs.structure(str(gis / "mine" / "second.stl"), ground, gis, set())
    assert again.above == pytest.approx(1.5, abs=0.5) and site_warnings.of_walls([again], again.above) == []
    assert "low wall" not in (inside("mine --height 9 --width 2") and (gis / "mine" / site_warnings.NAME).read_text())
    again = site_inputs.corners(str(gis / "mine" / "second.stl"))
    assert again[..., 2].max() == pytest.approx(corners[..., 2].max() + 1)
    # the same mesh, made by hand
    shutil.copy(gis / "mine" / "wall.stl", gis / "hand.stl")
    inside(f"{STANDARD} --structure hand.stl -o hand")
    assert np.array_equal(site_inputs.corners(str(gis / "hand" / "hand.stl")),
                          site_inputs.corners(str(gis / "mine" / "wall.stl")))


def test_no_ball_passes_a_wall_that_is_higher_than_the_mass(inside, gis, monkeypatch):  # noqa: F811
    """Without it most of the mass does; the force is that of the same mesh given as a file."""
    write_wall_lines(gis)
    inside(f"{STANDARD} --balls 150 --wall wall.geojson --height 12 -o mine")
    shutil.copy(gis / "mine" / "wall.stl", gis / "hand.stl")
    inside(f"{STANDARD} --balls 150 --structure hand.stl -o hand")
    inside(f"{STANDARD} --balls 150 -o open")
    line = LineString([(44, -50), (44, 1), (40, 30), (39, 50), (44, 79), (44, 130)])
    beyond, forces = {}, {}
    for name in ("mine", "hand", "open"):
        subprocess.run([LMP, "-in", "in.site"], cwd=gis / name, check=True, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL)
        head, *rows = sorted((gis / name).glob("site.*.dump"))[-1].read_text().split("ITEM: ATOMS ")[1].splitlines()
        x, y = (np.array([float(row.split()[head.split().index(key)]) for row in rows]) for key in "xy")
        wall_x = np.interp(y, [p[1] for p in line.coords], [p[0] for p in line.coords])
        beyond[name] = int((x < wall_x).sum())
        forces[name] = [path.read_text() for path in sorted((gis / name).glob("site.[wh]a*.csv"))]
        assert len(rows) > 100
    assert beyond["mine"] == beyond["hand"] == 0 and beyond["open"] > 50
    assert forces["mine"] == forces["hand"] and len(forces["mine"]) == 2 and forces["open"] == []
