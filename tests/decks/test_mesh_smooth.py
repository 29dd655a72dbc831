"""Fix wall/gran/mesh: a surface acts the same however it is divided into triangles.

Edges of up to 30 degrees are part of one surface, and the rebound from it is that from a plane; beyond, a ball has a
contact with each face. Bowls, cones, terrains that are sampled finer and finer, and seams that are not welded.
"""

import numpy as np
import pytest

from deck_helpers import write_asc
from mesh_helpers import RHO, STIFFNESS, plane, rule_step, run_case, write_case

MASS = RHO * np.pi / 6
PHASES = 8


def strip(x, z, half=9.0):
    """Quadrangles along y between points of a profile."""
    triangles = []
    for (a, p), (b, q) in zip(zip(x, z), zip(x[1:], z[1:])):
        corners = (a, -half, p), (b, -half, q), (b, half, q), (a, half, p)
        triangles += [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
    return np.array(triangles)


def wedge(degrees):
    """Two faces that turn by an angle at x = 0, and the height of a ball that touches both."""
    half = np.radians(degrees / 2)
    return strip([-9.0, 0.0, 9.0], [9 * np.tan(half), 0.0, 9 * np.tan(half)]), 0.5 / np.cos(half)


def trough(n, radius=10.0):
    """The lower part of a cylinder of n faces, an edge at its bottom."""
    angle = 2 * np.pi / n * np.arange(-(n // 4), n // 4 + 1)
    return strip(radius * np.sin(angle), radius * (1 - np.cos(angle))), 0.5 / np.cos(np.pi / n)


def cone(n, degrees):
    """n faces that rise from a point by an angle, and the height of a ball that touches all."""
    turn, slope = 2 * np.pi / n * np.arange(n + 1), np.radians(degrees)
    radius = 1.5 / np.tan(slope) / np.cos(np.pi / n)
    rim = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(n + 1, 1.5)], axis=1)
    return np.array([((0, 0, 0), p, q) for p, q in zip(rim, rim[1:])]), 0.5 / np.cos(slope)


def rebound(tmp_path, mesh, height, e, scheme="exact", along=1.0, speed=1.0):
    """Rebound over impact speed of central falls at several moments within a step, and the most contacts of one."""
    step = speed * rule_step()
    x = [(0.0, along * (k - 3.5), height + step * (2 + (k + 0.5) / PHASES)) for k in range(PHASES)]
    write_case(tmp_path, mesh, x, (0, 0, -speed))
    rows, frames, _ = run_case(tmp_path, "run 60", coeff=f"restitution {e}", style=f"scheme {scheme}", dump_every=60)
    print(e, scheme, frames[-1, :, 6].mean(), np.ptp(frames[-1, :, 6]))
    return frames[-1, :, 6] / speed, rows[:, 2].max() / PHASES


def law_of_two(e, degrees):
    """Of two contacts whose springs and dashpots act along their normals."""
    zeta = -np.log(e) / np.hypot(np.pi, np.log(e)) * np.sqrt(2) * np.cos(np.radians(degrees / 2))
    return np.exp(-np.pi * zeta / np.sqrt(1 - zeta ** 2))


@pytest.mark.parametrize("degrees", [0.2, 29])
@pytest.mark.parametrize("e", [0.1, 0.5, 0.9])
def test_an_edge_of_up_to_30_degrees_is_no_edge(tmp_path, degrees, e):
    speeds, contacts = rebound(tmp_path, *wedge(degrees), e)
    assert contacts == 1
    assert speeds.mean() == pytest.approx(e, abs=0.002) and np.abs(speeds - e).max() < 0.01


def test_an_edge_is_no_edge_with_scheme_plain_either(tmp_path):
    flat = rebound(tmp_path, plane(1), 0.5, 0.5, "plain")[0]
    assert rebound(tmp_path, *wedge(29), 0.5, "plain")[0] == pytest.approx(flat, abs=0.02)


@pytest.mark.parametrize("degrees", [31, 60])
@pytest.mark.parametrize("speed", [1.0, 8.0])
def test_a_sharper_edge_is_two_contacts(tmp_path, degrees, speed):
    """Up to an overlap of a fifth of the radius."""
    for e in (0.1, 0.5):
        speeds, contacts = rebound(tmp_path, *wedge(degrees), e, speed=speed)
        assert contacts == 2
        assert np.abs(speeds - law_of_two(e, degrees)).max() < 0.03


@pytest.mark.parametrize("faces", [16, 128, 512])
@pytest.mark.parametrize("shape", ["trough", "cone of 20", "cone of 45"])
def test_bowls_and_cones_act_as_if_they_were_smooth(tmp_path, shape, faces):
    mesh, height = trough(faces) if shape == "trough" else cone(faces, int(shape[-2:]))
    for e in (0.1, 0.5):
        speeds, contacts = rebound(tmp_path, mesh, height, e, along=1.0 if shape == "trough" else 0.0)
        assert contacts == 1
        assert speeds.mean() == pytest.approx(e, abs=0.002) and np.abs(speeds - e).max() < 0.01


@pytest.mark.parametrize("n, degrees", [(8, 20), (24, 45), (64, 45)])
def test_a_cone_gives_an_elastic_ball_no_energy(tmp_path, n, degrees):
    mesh, height = cone(n, degrees)
    rng = np.random.default_rng(2)
    x = rng.uniform(-0.25, 0.25, (24, 3))
    x[:, 2] += height + 0.3 + 0.25 * (degrees == 45)
    write_case(tmp_path, mesh, x, (0, 0, -1))
    frames = run_case(tmp_path, "run 500", coeff="restitution 1", dump_every=20, every=500)[1]
    assert (frames[-1, :, 4:7] == frames[-2, :, 4:7]).all()    # they are off again
    energy = (frames[-1, :, 4:7] ** 2).sum(axis=1)
    print(energy.mean(), energy.min(), energy.max())
    assert energy.max() < 1.01 and energy.mean() == pytest.approx(1, abs=0.002)


@pytest.mark.parametrize("cell, noise", [(1.0, 0), (0.25, 0), (0.1, 0), (0.1, 5)])
def test_a_terrain_gives_back_the_same_at_any_cell(tmp_path, cell, noise):
    """Drops at random on waves of 5 degrees, root mean square, or on noise of 5 degrees in each cell.

    What is left of the energy of an impact along a normal n is 1 - (1 - e^2) n_z^2, and its velocity changes along n.
    """
    centers = (np.arange(round(22 / cell)) + 0.5) * cell - 11.0
    x, y = np.meshgrid(centers, centers)
    z = np.sin(x * 2 * np.pi / 6) * np.cos(y * 2 * np.pi / 6) * np.tan(np.radians(5)) * 6 / (2 * np.pi) * np.sqrt(2)
    if noise:
        z = np.random.default_rng(7).normal(size=x.shape) * np.tan(np.radians(noise)) * cell / 2
    write_asc(tmp_path / "ground.asc", z, -11.0, -11.0, cell)
    drops = np.random.default_rng(1).uniform(-9, 9, (200, 3))
    drops[:, 2] = 0.51 + z.max()
    write_case(tmp_path, plane(1), drops, (0, 0, -1.0))
    frames = run_case(tmp_path, "run 400", coeff="restitution 0.5", dump_every=5, every=400,
                      wall="fix wall all wall/gran/mesh 2 terrain ground.asc {keywords}")[1]
    v = frames[:, :, 4:7]
    left, expected = [], []
    for k in range(v.shape[1]):
        moves = np.abs(np.diff(v[:, k], axis=0)).max(axis=1) > 0
        first = np.argmax(moves)
        last = first + np.argmin(moves[first:])
        change = v[last, k] - v[0, k]
        left.append((v[last, k] ** 2).sum())
        expected.append(1 - 0.75 * change[2] ** 2 / (change ** 2).sum())
    ratio = np.array(left) / expected
    print(np.mean(left), ratio.mean(), ratio.min(), ratio.max())
    assert abs(ratio.mean() - 1) < 0.005
    assert 0.25 * 0.97 < np.mean(left) < 0.25 * 1.03


@pytest.mark.parametrize("scheme", ["exact", "plain"])
@pytest.mark.parametrize("drop, gap", [(1e-9, 0.0), (0.0, 1e-3), (1e-9, 1e-3)])
def test_a_seam_that_is_not_welded_is_not_felt(tmp_path, scheme, drop, gap):
    """A ball rolls from one level sheet to another one, a little lower or apart, whose corners are elsewhere."""
    mesh = np.concatenate([strip([-9.0, 0.0], [0.0, 0.0]), strip([gap, 3.0, 9.0], [-drop, -drop, -drop], half=8.0)])
    weight = MASS * 9.81
    write_case(tmp_path, mesh, (-1.0, 0.1, 0.5 - weight / STIFFNESS), (3, 0, 0), omega=(0, 6, 0))
    rows, frames, _ = run_case(tmp_path, "run 250", coeff="restitution 0.1 friction 30", style=f"scheme {scheme}",
                               g=9.81, dump_every=250)
    assert frames[-1, 0, 1] > 1.0
    force = -rows[20:, 5] / weight
    assert 0.99 < force.min() and force.max() < 1.01


def test_ranks_restarts_and_the_impulse_of_a_contact_with_many_faces(tmp_path):
    """The run is cut while balls touch, where the way out of the faces is kept by its normal alone."""
    mesh, height = cone(24, 45)
    x = np.random.default_rng(2).uniform(-0.25, 0.25, (24, 3)) + (0, 0, height + 0.5)
    ends = []
    for ranks, commands, begin in [(1, "run 300", "read_data balls.data"), (2, "run 300", "read_data balls.data"),
                                   (2, "run 130\nwrite_restart half.restart", "read_data balls.data"),
                                   (1, "run 170", "read_restart half.restart")]:
        write_case(tmp_path, mesh, x, (0, 0, -1), omega=(1, 0, 2))
        rows, frames, _ = run_case(tmp_path, commands, np=ranks, begin=begin, dump_every=10,
                                   coeff="restitution 0.5 friction 30 rolling 0.1")
        if "write" in commands:
            assert rows[-1, 2] > 4
        else:
            ends.append((frames[-1], rows[-1, 9:]))
    momentum = MASS * (ends[0][0][:, 4:7] - (0, 0, -1)).sum(axis=0)
    scale = MASS * len(x)
    for frame, impulse in ends:
        assert np.abs(frame - ends[0][0]).max() < 1e-9
        assert np.abs(impulse + momentum).max() < 1e-9 * scale
    assert np.abs(momentum).max() > 0.5 * scale
