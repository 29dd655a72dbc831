"""Balls inside a closed mesh at the start: a warning with their number; none for an open mesh or a smooth terrain."""

import numpy as np
import pytest
from deck_helpers import run_deck, write_asc
from mesh_helpers import bowl, box, mesh_deck, plane, write_case

# 2 x 2 x 2 balls of 1 m, clear of the sides of a mesh of 8 m; the one at 3.4 3.4 3.4 is in the box, outside the bowl
BALLS = [(1.1 * i, 1.1 * j, 1.1 * k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
MESHES = {"box": box((-4, -4, -4), (4, 4, 4)), "bowl": bowl(4.0, 8)}
SAID = "WARNING: Fix wall/gran/mesh wall: a closed surface should hold no balls at the start"


def warnings(log):
    return [line for line in log.splitlines() if SAID in line]


def run(folder, mesh, np_=1, text="run 1\nrun 1", x=BALLS + [(3.4, 3.4, 3.4)], **settings):
    write_case(folder, mesh, x, (0, 0, 0))
    return warnings(run_deck(mesh_deck(text, **settings), folder, np=np_))


@pytest.mark.parametrize("np_", [1, 2])
@pytest.mark.parametrize("shape, inside", [("box", 8), ("bowl", 8)])
def test_balls_inside_are_counted_once(tmp_path, shape, inside, np_):
    x = BALLS + ([(3.4, 3.4, 3.4)] if shape == "bowl" else [(5.5, 0, 0)])
    said = run(tmp_path, MESHES[shape], np_, x=x)
    assert len(said) == 1 and f"got {inside} balls inside" in said[0]


def test_a_single_ball_and_those_that_are_held(tmp_path):
    freeze = "group held id 1:7\nfix freeze held freeze\n"
    said = run(tmp_path, MESHES["box"], text=freeze + "run 1", x=BALLS)
    assert len(said) == 1 and "got 1 ball inside" in said[0]


@pytest.mark.parametrize("mesh", [MESHES["box"][:-1], np.concatenate([MESHES["box"], MESHES["box"][:1]]),
                                  np.concatenate([MESHES["box"], box((-5, -5, -5), (5, 5, 5))])],
                         ids=["open", "one triangle twice", "hollow"])
def test_no_inside_no_warning(tmp_path, mesh):
    assert not run(tmp_path, mesh, x=BALLS)


def test_no_ball_inside_no_warning(tmp_path):
    assert not run(tmp_path, MESHES["bowl"], x=[(3.4, 3.4, 3.4), (8, 0, 0)])
    assert not run(tmp_path, plane(4) - (0, 0, 3), x=BALLS)
    write_asc(tmp_path / "ground.asc", np.tile(np.abs(np.arange(12) - 5.5) - 6, (12, 1)), -6.0, -6.0)
    assert not run(tmp_path, plane(1), x=BALLS, wall="fix wall all wall/gran/mesh 2 terrain ground.asc")
