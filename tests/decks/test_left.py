"""PREFIX.left.csv of fix deposit/grid: which balls left the ground, when, where, and where they started.

Balls fly freely, so that each has a closed form."""

import numpy as np
import pytest
import yaml

from deck_helpers import flight_head as head, run_deck, write_asc, write_balls

SIZE, DT = 20.0, 0.001
BOX = [(-10.0, 30.0), (-10.0, 30.0), (0.0, 20.0)]
FIX = "fix dep all deposit/grid 10 0 cell 1 terrain ground output {} {}\n"


def table(path):
    names = path.read_text().split("\n", 1)[0]
    assert names == "ball,volume,time,x,y,from_x,from_y"
    return np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)


def cloud(tmp_path, hole=False, box=BOX, number=300):
    """Balls of three sizes that fly apart over a flat ground, with a hole of NODATA if asked for."""
    rng = np.random.default_rng(4)
    heights = np.zeros((20, 20))
    if hole:
        heights[8:12, 15:17] = np.nan     # no ground from x 14.5 to 17.5 and y 7.5 to 12.5, between cell centres
    write_asc(tmp_path / "ground.asc", heights)
    x = np.array([5.0, 5.0, 5.0]) + rng.uniform(0, 8.3, (number, 3)) * [0.7 if hole else 1, 1, 1]
    d = rng.choice([0.3, 0.7, 1.25], number)
    v = rng.normal(0, 8, (number, 3)) * [1, 1, 0.1]
    write_balls(tmp_path / "balls.data", x, d, v, box)
    return x, d, v


def expected(x, d, v, time, lo=(0.0, 0.0), hi=(SIZE, SIZE)):
    """Rows of balls that are beyond an edge at a time, by time."""
    rows = []
    for k in range(len(x)):
        end = x[k, :2] + v[k, :2] * time
        if (end >= lo).all() and (end <= hi).all():
            continue
        speed = v[k, :2]
        with np.errstate(divide="ignore"):
            at = np.where(speed > 0, (hi - x[k, :2]) / speed, (lo - x[k, :2]) / speed).min()
        rows.append([k + 1, d[k] ** 3, at, *(x[k, :2] + at * speed), *x[k, :2]])
    return np.array(sorted(rows, key=lambda row: row[2]))


@pytest.mark.parametrize("np_, comm", [(1, "brick"), (2, "brick"), (4, "tiled")])
def test_where_balls_left(tmp_path, np_, comm):
    """Beyond the edge and still there, fallen out of the box, lost while the ranks change."""
    x, d, v = cloud(tmp_path)
    balance = "fix spread all balance 100 1.0 rcb\n" if comm == "tiled" else ""
    log = run_deck(head(comm=comm) + FIX.format("out", "") + balance + "run 700\nrun 723\n", tmp_path, np=np_)
    found, rows = table(tmp_path / "out.left.csv"), expected(x, d, v, 1423 * DT)
    summary = yaml.safe_load((tmp_path / "out.summary.yaml").read_text())
    assert 20 < summary["balls"]["lost"] < len(rows) - 20 < 250
    assert found[:, 0].tolist() == rows[:, 0].tolist()
    assert found[:, 1:] == pytest.approx(rows[:, 1:], rel=1e-9, abs=1e-9)
    assert summary["files"][-1] == "out.left.csv" and "balance does not close" not in log


@pytest.mark.parametrize("np_, then", [(1, 2), (3, 1)])
def test_restart(tmp_path, np_, then):
    """Cut between two samples, on other ranks: the same table as of the uncut run, to the digit."""
    x, d, v = cloud(tmp_path)
    run_deck(head() + FIX.format("whole", "") + "restart 615 cut.*\nrun 1423\n", tmp_path, np=np_)
    again = head().replace("read_data balls.data", "read_restart cut.615")
    assert again != head()
    run_deck(again + FIX.format("out", "") + "run 808\n", tmp_path, np=then)
    whole = (tmp_path / "whole.left.csv").read_text()
    times = table(tmp_path / "whole.left.csv")[:, 2]
    assert (times < 0.6).sum() > 20 and (times > 0.63).sum() > 20
    assert (tmp_path / "out.left.csv").read_text() == whole


@pytest.mark.parametrize("np_", [1, 2])
def test_what_returns_did_not_leave(tmp_path, np_):
    """Thrown over the edge and pulled back: one that is back counts as if it had stayed, one that leaves again by
    where it does so."""
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)))
    x = [[18, 5, 5], [18, 8, 5], [18, 11, 5]]
    v = [[10, 0, 0], [10, 0, 0], [10, 20, 0]]
    # thrown from x 18 by 10 m/s, against 10 m/s2: over 20 from 0.225 to 1.775 s
    write_balls(tmp_path / "balls.data", x, 0.5, v, BOX)
    pull = "fix pull all gravity 10 vector -1 0 0\n"
    run_deck(head() + pull + FIX.format("out", "") + "run 1000\nfix slow all setforce 0 0 0\nrun 0\n", tmp_path, np=np_)
    assert table(tmp_path / "out.left.csv")[:, 0].tolist() == [1, 2, 3]
    run_deck(head() + pull + FIX.format("out", "") + "run 2000\n", tmp_path, np=np_)
    found = table(tmp_path / "out.left.csv")
    assert found[:, 0].tolist() == [3]       # that one went on beyond y 20, and out of the box
    time = 1 - np.sqrt(0.6)
    assert found[0, 2:] == pytest.approx([time, 20, 11 + 20 * time, 18, 11], abs=1e-2)


def test_a_hole(tmp_path):
    """Ground with NODATA inside: balls over it left, by the ways of all of them, step by step."""
    x, d, v = cloud(tmp_path, hole=True)
    run_deck(head() + FIX.format("out", "").replace(" 10 0 ", " 1 0 ") + "run 400\n", tmp_path, np=2)
    found = table(tmp_path / "out.left.csv")
    end = x[:, :2] + 0.4 * v[:, :2]
    in_hole = (abs(end - [16, 10]) < [1.5, 2.5]).all(axis=1)
    beyond = ((end < 0) | (end > SIZE)).any(axis=1)
    assert in_hole.sum() > 3
    assert sorted(found[:, 0]) == (np.nonzero(in_hole | beyond)[0] + 1).tolist()
    rows = found[in_hole[found[:, 0].astype(int) - 1]]
    rim = np.abs(np.abs(rows[:, 3:5] - [16, 10]) - [1.5, 2.5])
    assert (rim.min(axis=1) < 1e-6).all() and (np.abs(rows[:, 3:5] - [16, 10]) < [1.5 + 1e-6, 2.5 + 1e-6]).all()


def test_the_grid_is_smaller_than_the_ground(tmp_path):
    """Beyond the edge of the grid nothing is seen, though there is ground."""
    x, d, v = cloud(tmp_path)
    run_deck(head() + FIX.format("out", "extent 2 17 3 18") + "run 423\n", tmp_path)
    found, rows = table(tmp_path / "out.left.csv"), expected(x, d, v, 423 * DT, np.array([2, 3]), np.array([17, 18]))
    assert len(rows) > 30 and found == pytest.approx(rows, rel=1e-9)


@pytest.mark.parametrize("np_", [1, 2])
def test_lost_above_ground(tmp_path, np_):
    """A box that ends above the ground: what leaves it there is listed, too, in a run and in a command."""
    box = [(0.0, 10.0), (0.0, 20.0), (0.0, 20.0)]
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)))
    write_balls(tmp_path / "balls.data", [[5, 5, 5], [8, 8, 5], [9.99, 6, 5]], [0.5, 1, 0.7],
                [[0, 0, 0], [10, 0, 0], [1, 0, 0]], box)
    quiet = "pair_style zero 1.0\npair_coeff * *\nneigh_modify every 1000 delay 1000 check no\n"
    run_deck(head() + quiet + FIX.format("out", "") + "run 20\n", tmp_path, np=np_)
    assert len(table(tmp_path / "out.left.csv")) == 0      # one is outside of the box, and still there
    run_deck(head() + quiet + FIX.format("out", "") + "run 20\nwrite_restart cut\nrun 0\n", tmp_path, np=np_)
    assert table(tmp_path / "out.left.csv") == pytest.approx(np.array([[3, 0.343, 0.02, 10.01, 6, 9.99, 6]]))
    run_deck(head() + FIX.format("out", "") + "run 300\n", tmp_path, np=np_)
    found = table(tmp_path / "out.left.csv")
    assert found[:, 0].tolist() == [3, 2] and found[:, 2] == pytest.approx([0.01, 0.2], abs=0.002)
    assert found[:, 3] == pytest.approx(10, abs=0.02)


def test_periodic_sides(tmp_path):
    """A ball that goes around stays above ground; where another leaves is in the box."""
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)))
    write_balls(tmp_path / "balls.data", [[5, 5, 5], [5, 8, 5]], 0.5, [[30, 0, 0], [30, 10, 0]],
                [(0.0, 20.0), (-10.0, 30.0), (0.0, 20.0)])
    for np_ in (1, 2):
        run_deck(head(boundary="p f f") + FIX.format("out", "") + "run 1500\n", tmp_path, np=np_)
        assert table(tmp_path / "out.left.csv") == pytest.approx(np.array([[2, 0.125, 1.2, 1, 20, 5, 8]]))


def test_balls_that_come_later(tmp_path):
    """They start where they are first seen."""
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)))
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 0.5, None, BOX)
    run_deck(head() + FIX.format("out", "") + "run 20\ncreate_atoms 1 single 18 7 5\nset group all diameter 0.5\n"
             "velocity all set 10 0 0\nrun 400\n", tmp_path)
    found = table(tmp_path / "out.left.csv")
    assert found[:, 0].tolist() == [2]
    assert found[0, 2:] == pytest.approx([0.22, 20, 7, 18.1, 7], abs=1e-6)
