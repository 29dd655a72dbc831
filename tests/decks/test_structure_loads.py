"""inputs/22_structures with balls of 4 m: a collapse with and without a wall, and the meshes of its script."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy
import pytest
import yaml

from deck_helpers import read_asc, read_dump, run_deck

CASE = Path(__file__).resolve().parents[2] / "inputs" / "22_structures"
DECK = (CASE / "in.structures").read_text()
NAMES = ("wall", "building", "pier")


def collapse(tmp_path, **variables):
    for path in [CASE / "terrain.asc", *CASE.glob("*.stl"), *CASE.glob("be*.csv")]:
        shutil.copy(path, tmp_path)
    log = run_deck(DECK, tmp_path, vars={"d": 4, **variables})
    assert "WARNING" not in log
    return tmp_path


@pytest.fixture(scope="module")
def walled(tmp_path_factory):
    return collapse(tmp_path_factory.mktemp("walled"))


@pytest.fixture(scope="module")
def bare(tmp_path_factory):
    return collapse(tmp_path_factory.mktemp("bare"), wall=0)


def series(folder, name):
    return numpy.genfromtxt(folder / f"structures.{name}.csv", delimiter=",", names=True)


def line(folder, name):
    return yaml.safe_load((folder / f"structures.{name}.line.yaml").read_text())


def volume(folder):
    thickness, header = read_asc(folder / "structures.thickness.asc")
    x = header["xllcorner"] + header["cellsize"] * (numpy.arange(thickness.shape[1]) + 0.5)
    return lambda low, high: thickness[:, (x > low) & (x < high)].sum() * header["cellsize"] ** 2


def test_runs_end_at_rest_with_their_volume(walled, bare):
    for folder in (walled, bare):
        summary = yaml.safe_load((folder / "structures.summary.yaml").read_text())
        assert summary["at_rest"] and abs(summary["volume"]["residual"]) <= 1e-9 * summary["volume"]["released"]


def test_the_wall_holds_most_of_what_passed_its_place(walled, bare):
    with_wall, without = (line(folder, "behind")["net_volume"] for folder in (walled, bare))
    assert 0 < with_wall < 0.5 * without
    assert volume(walled)(60, 80) < 0.5 * volume(bare)(60, 80)
    assert not (bare / "structures.wall.csv").exists()


def test_forces_push_down_the_slope_and_what_leans_on_the_wall_stays(walled):
    rows = series(walled, "wall")
    assert rows["time"][-1] > 10 and numpy.diff(rows["time"]).max() < 0.03
    assert rows["fx"][-1] < 0 and rows["largest_force"].max() > 2 * abs(rows["fx"][-1])
    # nothing moves any more: the impulse grows by the force at the end
    late = rows[rows["time"] > rows["time"][-1] - 1.0]
    grown = (late["jx"][-1] - late["jx"][0]) / (late["time"][-1] - late["time"][0])
    assert grown == pytest.approx(late["fx"].mean(), rel=0.05) and grown == pytest.approx(rows["fx"][-1], rel=0.2)
    # less than the component of the body's weight along a slope as steep as the chord
    weight = 767 * 3411.4 * numpy.pi / 6 * 4 ** 3 * 9.80665
    assert 0.02 * weight < -rows["fx"][-1] < weight * numpy.sin(numpy.arctan(36 / 72))


def test_the_pier_is_hit_without_the_wall(walled, bare):
    free, held = (numpy.linalg.norm([series(folder, "pier")[f"j{axis}"][-1] for axis in "xyz"])
                  for folder in (bare, walled))
    assert held < 0.5 * free and series(bare, "pier")["jx"][-1] < 0


def test_what_crossed_the_line_lies_beyond_it(bare):
    """Balls on the line at the end lie half on either side of it: three of them may be missing."""
    net = line(bare, "beyond")["net_volume"]
    assert net > 0 and volume(bare)(-100, 60) == pytest.approx(net, abs=3 * 4 ** 3)


def test_no_ball_ends_within_a_structure(walled, bare):
    for folder in (walled, bare):
        last = sorted(folder.glob("structures.*.dump"))[-1]
        x = next(iter(read_dump(last).values()))[:, 3:6]
        for name in NAMES if folder == walled else NAMES[1:]:
            corners = read_stl(CASE / f"{name}.stl").reshape(-1, 3) - [0, 0, 0.5 * 4]    # lower, as the mass lies
            inside = ((x > corners.min(axis=0)) & (x < corners.max(axis=0))).all(axis=1)
            assert not inside.any()


# --- the meshes ---

def read_stl(path):
    """Corners of the triangles of a text STL, (n, 3, 3)."""
    rows = [row.split()[1:] for row in path.read_text().splitlines() if row.startswith("vertex")]
    return numpy.array(rows, float).reshape(-1, 3, 3)


def test_the_meshes_are_what_their_script_makes(tmp_path):
    shutil.copy(CASE / "make_structures.py", tmp_path)
    subprocess.run([sys.executable, "make_structures.py"], cwd=tmp_path, check=True)
    for name in NAMES:
        assert read_stl(tmp_path / f"{name}.stl") == pytest.approx(read_stl(CASE / f"{name}.stl"), abs=1e-4)


@pytest.mark.parametrize("name, inside", [("wall", 1.5 * 80 * 6), ("building", 10 * 16 * 11),
                                          ("pier", 12 * 8 * 1.5 ** 2 * numpy.sin(numpy.pi / 8))])
def test_a_mesh_is_closed_and_its_normals_point_outwards(name, inside):
    """Each edge belongs to two triangles, in opposite directions; the volume by the divergence theorem is positive."""
    corners = read_stl(CASE / f"{name}.stl")
    edges = [(tuple(a), tuple(b)) for t in corners for a, b in zip(t, t[[1, 2, 0]])]
    assert len(set(edges)) == len(edges) and {(b, a) for a, b in edges} == set(edges)
    volume = numpy.einsum("ni,ni->", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(inside, rel=1e-4)
    assert max(numpy.linalg.norm(t - t[[1, 2, 0]], axis=1).max() for t in corners) < 2.5 * 2 ** 0.5 + 1e-9
