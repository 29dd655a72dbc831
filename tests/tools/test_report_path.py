"""The line that a mass took: around a bend, from dumps, without stray balls; and where the section of a report goes."""
import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from affine import Affine
from shapely.geometry import LineString, Point

from slope_tools.deposits import flow_path
from slope_tools.plots import section as report_section
from slope_tools.plots.ground import beside_largest
from slope_tools.survey.rasters import Raster

TOP = Path(__file__).resolve().parents[2]
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
CELL = 2.0
CENTRE = LineString([(20, 180), (100, 180), (100, 20)])     # of a channel with a bend of 90 degrees


def site(centre=CENTRE, width=16.0, size=(100, 100), head=30.0):
    """A channel around a line that a mass went down from its first `head` metres; as report_ground.Ground has it."""
    rows, columns = size
    transform = Affine(CELL, 0, 0, 0, -CELL, rows * CELL)
    x, y = transform @ np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    away = np.array([[centre.distance(Point(*at)) for at in zip(*row)] for row in zip(x, y)])
    along = np.array([[centre.project(Point(*at)) for at in zip(*row)] for row in zip(x, y)])
    touched = away < width / 2
    release = touched & (along < head)
    deposit = np.where(touched & (along > 0.5 * centre.length), 1.0, 0.0)
    before = 100 - 0.4 * along + 0.5 * away
    base = np.where(release, before - 4, before)
    raster = Raster(deposit, transform, None)
    ground = SimpleNamespace(
        raster=raster, cell=CELL, x=x, y=y, before=before, base=base, touched=touched, release=release,
        slip_depth=before - base, max_thickness=np.where(touched, 2.0, 0.0), source=release,
        extent=(0.0, 0.0, columns * CELL, rows * CELL), arrival=np.where(touched, along, np.nan),
        beside=beside_largest(before - base, release))
    ground.along = lambda values, px, py: sampled(raster._replace(z=values), px, py)
    result = SimpleNamespace(thickness=deposit, folder=Path("none"), row={}, summary={
        "stop": {"step": 1000}, "balls": {"released": 4}}, deposit=SimpleNamespace(base=base, cell=CELL, raster=raster))
    return ground, result


def sampled(raster, x, y):
    from slope_tools.survey.resampling import sample
    return sample(raster, np.asarray(x), np.asarray(y))


def test_the_line_goes_around_a_bend():
    ground, result = site()
    found = flow_path.path(result, ground)
    line = LineString(found.points)
    assert not found.dumped
    assert max(CENTRE.distance(Point(point)) for point in found.points) < 5     # the corner is cut a little
    # from the middle of the release to nearly the end
    assert np.hypot(*(found.points[0] - (33, 180))) < 3
    assert Point(found.points[-1]).distance(Point(100, 20)) < 12
    assert line.length == pytest.approx(240 - 15, rel=0.08)


def test_stray_balls_do_not_lead_the_line_astray():
    ground, result = site()
    # a ball that rolled back up behind the channel: touched, but next to nothing lies there
    ground.touched = ground.touched | ((ground.y < 24) & (ground.x > 100)) | ((ground.x > 186) & (ground.y < 150))
    ground.max_thickness = np.where(ground.touched, np.maximum(ground.max_thickness, 0.1), 0)
    found = flow_path.path(result, ground)
    assert max(CENTRE.distance(Point(point)) for point in found.points) < 5
    # the test holds: far away something was touched
    assert ground.touched[:, 95].any()


def test_the_line_ends_where_next_to_nothing_lies():
    """As far as 99 % of the deposit goes, although the mass touched, and a little of it lies, farther on."""
    line = LineString([(10, 100), (190, 100)])
    ground, result = site(line)
    along = ground.x - 10
    result.thickness = np.where(ground.touched & (along > 50), np.where(along < 110, 1.0, 0.003), 0)
    assert flow_path.path(result, ground).points[-1][0] == pytest.approx(118, abs=8)
    result.thickness = np.where(ground.touched & (along > 50), 1.0, 0)
    assert flow_path.path(result, ground).points[-1][0] > 175


def test_bands_that_turn_back_are_left_out():
    points = np.array([[0.0, 0.0], [10.0, 0.0]])
    on, back = np.array([20.0, 3.0]), np.array([12.0, 14.0])
    assert flow_path.followed(points, [on]).tolist() == [[0, 0], [10, 0], [20, 3]]
    assert flow_path.followed(points, [on, back]).tolist() == [[0, 0], [10, 0], [20, 3]]


def test_no_release_or_no_motion_has_no_line():
    ground, result = site()
    ground.release = ground.release & False
    assert flow_path.path(result, ground) is None
    ground, result = site()
    ground.touched, result.thickness = ground.release, ground.release * 1.0
    assert flow_path.path(result, ground) is None


def write_dump(path, step, places, more=0):
    rows = [f"{k + 1} {x} {y} 0 1.0" for k, (x, y) in enumerate(places)]
    rows += [f"{100 + k} 0 0 0 1.0" for k in range(more)]
    head = f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(rows)}\nITEM: BOX BOUNDS f f f\n0 1\n0 1\n0 1\n"
    path.write_text(head + "ITEM: ATOMS id x y z diameter\n" + "\n".join(rows) + "\n")


def test_dumps_tell_where_the_centroid_was(tmp_path):
    ground, result = site()
    result.folder = tmp_path
    middles = [CENTRE.interpolate(at).coords[0] for at in np.linspace(15, 150, 12)]
    for k, (x, y) in enumerate(middles):
        write_dump(tmp_path / f"run.{100 * k:06d}.dump", 100 * k,
                   [(x - 3, y), (x + 3, y), (x, y - 3), (x, y + 3)])
    found = flow_path.path(result, ground)
    assert found.dumped and found.points[0] == pytest.approx(middles[0])
    # the centroid's way, and then to the front
    for middle in middles[1:-1]:
        assert LineString(found.points).distance(Point(middle)) < 8
    assert Point(found.points[-1]).distance(Point(100, 20)) < 12
    # dumps of later steps than the run's last one are of another run
    result.summary["stop"]["step"] = 150
    assert not flow_path.path(result, ground).dumped
    # more balls than the mass has: fixed ones among them
    result.summary["stop"]["step"] = 1100
    write_dump(tmp_path / "run.000500.dump", 500, [(0, 0)], more=9)
    assert not flow_path.path(result, ground).dumped
    (tmp_path / "run.000500.dump").write_text("ITEM: TIMESTEP\n500\n")
    assert not flow_path.path(result, ground).dumped


def test_a_mass_that_runs_back_has_one_line(tmp_path):
    """Its centroid goes up the other side of a valley and back: the line goes there and on to the front, not back."""
    ground, result = site()
    result.folder = tmp_path
    way = [*np.linspace(15, 200, 14), *np.linspace(190, 150, 5)]
    for k, (x, y) in enumerate(CENTRE.interpolate(at).coords[0] for at in way):
        write_dump(tmp_path / f"run.{50 * k:06d}.dump", 50 * k, [(x - 3, y), (x + 3, y), (x, y - 3), (x, y + 3)])
    found = flow_path.path(result, ground)
    line = LineString(found.points)
    assert found.dumped and line.is_simple and Point(found.points[-1]).distance(Point(100, 20)) < 12
    assert line.length == pytest.approx(240 - 15, rel=0.08)
    points = section(ground, result).points
    assert LineString(points).is_simple and points[0][1] < 22


def test_a_finer_grid_is_thinned_out(monkeypatch):
    ground, result = site()
    whole = flow_path.path(result, ground)
    monkeypatch.setattr(flow_path, "MOST_CELLS", 3000)
    thin = flow_path.path(result, ground)
    assert LineString(thin.points).hausdorff_distance(LineString(whole.points)) < 4 * CELL


@pytest.mark.parametrize("step", [1, 2, 3])
def test_thinned_masks_keep_what_they_hold(step):
    mask = np.zeros((7, 11), bool)
    mask[3, 5] = mask[6, 10] = True
    thin = flow_path.thinned(mask, step)
    assert thin.shape == (-(-7 // step), -(-11 // step))
    assert thin[3 // step, 5 // step] and thin[6 // step, 10 // step] and thin.sum() == 2


def test_distances_within_a_mask():
    within = np.ones((3, 5), bool)
    within[0:2, 2] = False      # a wall with a gap below
    start = np.zeros((3, 5), bool)
    start[0, 0] = True
    found = flow_path.compute_path_distances(within, start, 10.0)
    assert found[0, 1] == 10 and found[1, 1] == pytest.approx(10 * np.sqrt(2))
    # through the gap: two diagonals down to it, two up again
    assert found[0, 4] == pytest.approx(10 * 4 * np.sqrt(2))
    assert np.isinf(found[0, 2])


# --- where the section goes ---

def section(ground, result, asked=None):
    data = SimpleNamespace(result=result, drawn=[result], road=None, label=lambda one: "run", study=None)
    return report_section.Section(data, ground, asked, False)


def test_the_section_follows_a_mass_around_a_bend():
    ground, result = site()
    found = section(ground, result)
    assert "along the middle of the flow" in found.how and len(found.points) > 3
    assert max(CENTRE.distance(Point(point)) for point in found.points[1:-1]) < 5
    # from behind the front to behind the head of the release, the south first
    assert found.points[0][1] < 22 and found.points[-1][0] < 21
    # what it shows is what lies on the line
    [(_, surface, thickness)] = found.runs
    at = found.line.project(Point(100, 180)) - found.s
    assert thickness[(at > 45) & (at < 140)] == pytest.approx(1.0, abs=0.01)
    assert (surface - found.base - thickness)[thickness > 0] == pytest.approx(0, abs=1e-9)
    assert found.bends == []        # a curve has none


def test_the_section_goes_on_through_the_deposit():
    """From where the path ends, straight on as far as the deposit is contiguous, and some room."""
    ground, result = site()
    found = section(ground, result)
    path = np.array([(20.0, 180.0), (100.0, 180.0), (100.0, 100.0)])
    assert found._continued(path, 4.0)[-1][1] < 20
    result.thickness = np.where(ground.y > 90, result.thickness, 0)
    assert found._continued(path, 4.0)[-1] == pytest.approx((100, 86), abs=CELL)


def test_a_straight_path_gives_the_fall_line():
    ground, result = site(LineString([(20, 100), (180, 100)]))
    found = section(ground, result)
    assert "fall line" in found.how and len(found.points) == 2
    assert found.points[:, 1] == pytest.approx(100, abs=1.5)
    assert section(ground, result, ["fall"]).points == pytest.approx(found.points)


def test_the_fall_line_is_there_on_demand():
    ground, result = site()
    found = section(ground, result, ["fall"])
    assert len(found.points) == 2 and "fall line" in found.how


@pytest.mark.parametrize("dumped", [False, True])
@pytest.mark.parametrize("centre", [LineString([(20, 160), (180, 160)]), CENTRE])
def test_of_two_bodies_the_section_is_the_largests(tmp_path, dumped, centre):
    """Between the two, through the centroid of both, is none. One of less volume lies on the other flank."""
    ground, result = site(centre)
    alone = section(*site(centre)).line
    small = (ground.y < 40) & (ground.x > 150)
    ground.release |= small & (ground.x > 180)
    ground.slip_depth[small & (ground.x > 180)] = 1.5
    ground.touched |= small
    ground.max_thickness[small] = 9.0
    hollow = (ground.y > ground.y.max() - 8) & (ground.x > ground.x.max() - 20)
    assert hollow.any() and not (hollow & ground.release).any()
    ground.slip_depth[hollow] = 500.0        # in which no ball starts
    ground.source, ground.beside = ground.release, beside_largest(ground.slip_depth, ground.release)
    if dumped:
        result.folder = tmp_path
        for k, at in enumerate(np.linspace(15, 150, 12)):
            x, y = centre.interpolate(at).coords[0]
            write_dump(tmp_path / f"run.{100 * k:06d}.dump", 100 * k, [(x, y), (x, y), (190, 20), (180, 20)])
    for asked in (None, ["fall"]):
        found = section(ground, result, asked)
        assert "largest body" in found.how
        depths = ground.along(ground.slip_depth, *found.xy.T)
        assert np.nanmax(depths) == pytest.approx(4.0)
    assert section(ground, result).line.hausdorff_distance(alone) < (20 if dumped else 6)


@pytest.mark.parametrize("reverse", [False, True])
def test_west_is_left(reverse):
    line = list(CENTRE.coords)
    ground, result = site(LineString(line[::-1]) if reverse else CENTRE)
    first, *_, last = section(ground, result).points
    way = last - first
    assert way[np.argmax(np.abs(way))] > 0
