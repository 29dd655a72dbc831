"""Fix wall/gran/mesh: single balls hit, slide, roll and rest on triangles as on a ball of infinite radius."""

import numpy as np
import pytest

from mesh_helpers import RHO, STIFFNESS, box, energy, plane, rule_step, run_case, write_case

MASS = RHO * np.pi / 6
OMEGA = np.sqrt(STIFFNESS / MASS)


# places and velocities of four balls above the plane, some over its diagonal and its corners
BOUNCING = ([(0.0, 0.0, 0.9), (-3.2, -2.5, 0.0), (2.5, 2.5, 1.5), (0.013, -1.31, 1.0)],
            [(1.0, 1.0, -1.0), (1.5, 1.0, 0.0), (0.0, 0.0, -2.0), (-0.3, 0.7, -0.5)])


def tilted(x, y):
    return 0.5 * x - 0.25 * y


@pytest.fixture(scope="module")
def two_triangles(tmp_path_factory):
    return bouncing(tmp_path_factory.mktemp("two"), 1)


def bouncing(folder, n):
    """Balls that bounce, slide and roll over a tilted plane of 2 n^2 triangles, diagonals and corners too."""
    write_case(folder, plane(n, height=tilted), *BOUNCING)
    return run_case(folder, "run 1200", g=9.81, down="0.1 0 -1")[:2]


@pytest.mark.parametrize("n", [10, 100])
def test_number_of_triangles_of_a_plane_does_not_matter(tmp_path, two_triangles, n):
    rows, frames = bouncing(tmp_path, n)
    assert rows[:, 2].max() == 4    # one contact of each ball
    assert (np.diff(frames[:, :, 3], axis=0) > 0).any(axis=1).sum() > 50    # they bounce
    assert np.abs(rows - two_triangles[0]).max() <= 1e-9 * np.abs(rows).max()
    for k in (1, 4, 7):
        a, b = frames[..., k:k + 3], two_triangles[1][..., k:k + 3]
        assert np.abs(a - b).max() <= 1e-9 * np.abs(b).max()


def test_gaps_between_rows_of_triangles_make_no_contact_of_their_own(tmp_path, two_triangles):
    """Hanging nodes: the halves of the plane have other corners along their common side."""
    fine, coarse = plane(10, height=tilted), plane(2, height=tilted)
    mixed = np.concatenate([fine[fine[..., 0].mean(axis=1) < 0], coarse[coarse[..., 0].mean(axis=1) > 0]])
    assert len(mixed) == 100 + 4
    write_case(tmp_path, mixed, *BOUNCING)
    frames = run_case(tmp_path, "run 1200", g=9.81, down="0.1 0 -1")[1]
    assert np.abs(frames - two_triangles[1]).max() <= 1e-9 * np.abs(frames).max()


def test_balls_of_any_sizes_are_each_as_alone(tmp_path):
    """All are in one list of contacts; alone, a ball's list has one size.  The largest comes first and last."""
    d = np.array([1.0, 0.61, 0.8, 0.99, 0.62, 1.0])
    x = np.array([(-5 + 2 * k, 0.3 * k, 0.5 * d[k] + 0.1 * k) for k in range(len(d))])
    v = np.array([(0.5, 0.3 * k, -1.0) for k in range(len(d))])
    settings = dict(g=9.81, down="0.1 0 -1", dt=rule_step(0.6))
    write_case(tmp_path, plane(10, height=lambda x, y: 0.1 * y), x, v, d=d)
    rows, together, _ = run_case(tmp_path, "run 800", **settings)
    assert rows[:, 2].max() >= 4
    for k in range(len(d)):
        folder = tmp_path / str(k)
        folder.mkdir()
        write_case(folder, plane(10, height=lambda x, y: 0.1 * y), x[k], v[k], d=d[k])
        alone = run_case(folder, "run 800", **settings)[1][:, 0]
        assert (np.diff(alone[:, 6]) > 0).sum() > 5
        assert np.abs(together[:, k, 1:] - alone[:, 1:]).max() <= 1e-9 * np.abs(alone[:, 1:]).max()


@pytest.mark.parametrize("e", [0.3, 0.48, 0.7, 1.0])
@pytest.mark.parametrize("share, tolerance, rebound", [(1.0, 0.02, 0.01), (0.2, 0.01, 0.001)])
def test_rebound_and_largest_force_of_an_impact(tmp_path, e, share, tolerance, rebound):
    """Eight balls, at eight moments within a step; the force of the damped oscillator in closed form."""
    dt = rule_step(share=share)
    zeta = -np.log(e) / np.hypot(np.pi, np.log(e))
    root = np.sqrt(1 - zeta ** 2)
    phase = (2 * np.pi - 3 * np.arccos(-zeta)) % np.pi
    closed = np.exp(-zeta / root * phase) * abs(np.sin(phase + 2 * np.arccos(-zeta))) / root * MASS * OMEGA
    forces, speeds = [], []
    for k in range(8):
        folder = tmp_path / str(k)
        folder.mkdir()
        write_case(folder, plane(1), (0.3, 0.2, 0.5 + 2.01 * dt + dt * k / 8), (0, 0, -1))
        rows, frames, _ = run_case(folder, "run 160", coeff=f"restitution {e}", dt=dt)
        forces.append(-rows[:, 5].min())
        speeds.append(frames[-1, 0, 6])
    assert np.abs(np.array(speeds) - e).max() < rebound
    print(np.array(forces) / closed - 1)
    assert np.abs(np.array(forces) / closed - 1).max() < tolerance


def speeds_on_slopes(tmp_path, tangent, **settings):
    """Speed gained in the second half of a run down slopes of 0.99 and 1.01 times a tangent; and its duration."""
    gained = []
    for share in (0.99, 1.01):
        slope = share * tangent
        write_case(tmp_path, plane(10), (0.013, 0.02, 0.5 - MASS * 9.81 / STIFFNESS), (0, 0, 0))
        frames = run_case(tmp_path, "run 6000", g=9.81 * np.hypot(1, slope), down=f"{slope} 0 -1", dump_every=3000,
                          every=1000, **settings)[1]
        gained.append(frames[2, 0, 4] - frames[1, 0, 4])
        assert share > 1 or abs(frames[2, 0, 4]) < 1e-9
    return gained, 3000 * rule_step()


def test_a_ball_slides_above_the_friction_angle_and_stands_below(tmp_path):
    """Locked by its rolling resistance it is a block."""
    tangent = np.tan(np.radians(30))
    gained, time = speeds_on_slopes(tmp_path, tangent, coeff="restitution 0.5 friction 30 rolling 5")
    assert abs(gained[0]) < 1e-9
    assert gained[1] == pytest.approx(0.01 * tangent * 9.81 * time, rel=0.01)


@pytest.mark.parametrize("style", ["", "rolling_radius reduced"])
def test_a_ball_rolls_above_the_rolling_threshold_and_stands_below(tmp_path, style):
    """The rolling radius on a mesh is the ball's, whatever the pair style takes between balls."""
    gained, time = speeds_on_slopes(tmp_path, 0.1, coeff="restitution 0.5 friction 45 rolling 0.1", style=style)
    assert abs(gained[0]) < 1e-9
    assert gained[1] == pytest.approx(5 / 7 * 0.01 * 0.1 * 9.81 * time, rel=0.01)


@pytest.mark.parametrize("friction", [0, 30])
def test_impacts_on_edges_and_corners_conserve_energy(tmp_path, friction):
    """Balls fly at a cube from all sides; each energy after is that before, and many hit edges and corners."""
    rng = np.random.default_rng(5)
    n = 400
    way = rng.normal(size=(n, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    x = 3.5 * way
    v = (rng.uniform(-1.0, 1.0, (n, 3)) - x)
    v *= 2.0 / np.linalg.norm(v, axis=1)[:, None]
    write_case(tmp_path, box((-1, -1, -1), (1, 1, 1)), x, v)
    rows, frames, _ = run_case(tmp_path, "run 1200", coeff=f"restitution 1 friction {friction}", dump_every=40)
    before, after = energy(frames[0]), energy(frames[-1])
    hit = np.abs(frames[-1, :, 4:7] - frames[0, :, 4:7]).max(axis=1) > 0.1
    turned = frames[-1, hit, 4:7] - frames[0, hit, 4:7]
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    oblique = (np.sort(np.abs(turned), axis=1)[:, 1] > 0.2).sum()    # not along an axis: edges and corners
    assert hit.sum() > 300 and (friction or oblique > 100)
    print(np.abs(after[hit] / before[hit] - 1).max())
    if not friction:
        assert np.abs(after[hit] / before[hit] - 1).max() < 0.002
    assert rows[:, 2].max() > 50 and rows[-1, 2] == 0


def rolled(tmp_path, sign, n):
    """Energy lost on the way over a hill (sign -1) or through a hollow of n facets, over that of the rolling."""
    slope, v = sign * -0.2, 2.4
    x = (-4.0, 0.1, sign * 0.4 + 0.5 * np.hypot(1, slope) + 0.02)
    write_case(tmp_path, plane(n, height=lambda x, y: sign * x * x / 40), x, (v, 0, v * slope),
               omega=(0, v * np.hypot(1, slope) / 0.5, 0))
    rows, frames, _ = run_case(tmp_path, "run 1200", coeff="restitution 0.5 friction 30", g=9.81, dump_every=10,
                               every=10)
    e = energy(frames, g=9.81)[:, 0]
    assert (frames[-1, 0, 1] > 0.1 or sign < 0) and rows[15:, 2].max() <= 2
    print(e[15] - e[-1], rows[15:, 2].min())
    return (e[15] - e[-1]) / (0.7 * MASS * v * v), rows[15:, 2].min()


@pytest.mark.parametrize("n", [10, 40, 100])
def test_rolling_over_convex_edges_loses_nothing(tmp_path, n):
    """The normal turns steadily around an edge; the spring of the contact goes on with it."""
    loss, contacts = rolled(tmp_path, -1, n)
    assert abs(loss) < 0.002 and contacts == 1


def test_rolling_over_concave_edges_loses_what_a_polygon_does(tmp_path):
    """At a concave edge the ball hits the next face; the loss is that of the angle, and vanishes with it."""
    losses = []
    for n in (10, 100):
        (tmp_path / str(n)).mkdir()
        losses.append(rolled(tmp_path / str(n), 1, n)[0])
    assert 0.03 < losses[0] < 0.1 and 0.0 < losses[1] < 0.2 * losses[0]
