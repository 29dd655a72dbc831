"""Fix wall/gran/mesh: the same whatever the ranks, the order of the atoms, a cut into runs or restarts."""

import re

import numpy as np
import pytest

from deck_helpers import read_dump, run_deck, write_asc
from mesh_helpers import RHO, box, mesh_deck, rule_step, run_case, stack, write_case

STEPS = 900
COEFF = "restitution 0.5 friction 30 rolling 0.1"


def write_container(tmp_path, seed=1, top=4.9):
    """Thirty balls of three sizes above an open box with a ridge in it; and a hilly ground."""
    rng = np.random.default_rng(seed)
    x = np.array([(i, j, k) for k in (0.9, 2.1) for i in range(-2, 3) for j in (-1, 0, 1)], float) * (1.1, 1.2, 1.1)
    x += rng.uniform(-0.04, 0.04, x.shape)
    v = rng.uniform(-2.0, 2.0, x.shape)
    ridge = [((-3, 0, 0), (3, -0.6, 0), (3, 0, 0.45)), ((-3, 0, 0), (3, 0, 0.45), (3, 0.6, 0))]
    closed = box((-3, -2, 0), (3, 2, 5))
    walls = np.concatenate([closed[closed[..., 2].min(axis=1) < top], np.array(ridge, float)])
    d = np.resize((1.0, 0.9, 0.8), len(x))
    write_case(tmp_path, walls, x + [0, 0, 0.2], v, d=d, box_size=6.0)
    write_asc(tmp_path / "hills.asc", rng.uniform(-0.5, 0.1, (14, 14)), -7.0, -7.0)


def run(tmp_path, commands=f"run {STEPS}", np=1, **settings):
    values = dict(exclude=False, g=9.81, coeff=COEFF, dt=rule_step(0.8), dump_every=50, every=50)
    values.update(settings)
    return run_case(tmp_path, commands, np=np, **values)


def difference(a, b):
    """Of frames: places, velocities and spins, each relative to its largest."""
    assert a.shape == b.shape and (a[..., 0] == b[..., 0]).all()
    parts = [np.abs(a[..., k:k + 3] - b[..., k:k + 3]).max() / np.abs(a[..., k:k + 3]).max() for k in (1, 4, 7)]
    print(f"difference {max(parts):.3g}")
    return max(parts)


def compare_rows(a, b, tolerance):
    assert (a[:, :3] == b[:, :3]).all() or np.abs(a[:, 1] - b[:, 1]).max() < 1e-9
    for columns in (slice(3, 6), slice(6, 9), slice(9, 12)):
        assert np.abs(a[:, columns] - b[:, columns]).max() <= tolerance * np.abs(a[:, columns]).max()


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reference")
    write_container(folder)
    rows, frames, _ = run(folder, keywords="output out 100")
    assert 20 < rows[-1, 2] < 200 and np.abs(frames[-1, :, 1:3]).max() < 3
    return rows, frames, folder


@pytest.mark.parametrize("settings", [
    dict(np=2, newton="off"), dict(np=4, processors="2 2 1"), dict(sort="sort 10 0.9"), dict(skin=0.05),
    dict(np=2, balance="fix shift all balance 100 1.0 shift x 5 1.05")])
def test_ranks_sorting_and_skin_do_not_matter(tmp_path, reference, settings):
    write_container(tmp_path)
    rows, frames, _ = run(tmp_path, keywords="output out 100", **settings)
    assert difference(reference[1], frames) < 1e-7
    compare_rows(reference[0], rows, 1e-6)
    for name in ("out.csv", "out.triangles.csv"):
        a, b = (np.genfromtxt(folder / name, delimiter=",", skip_header=1) for folder in (reference[2], tmp_path))
        assert a.shape == b.shape and np.abs(a - b).max(axis=0) == pytest.approx(0, abs=1e-6 * np.abs(a).max())


def test_several_runs_are_one(tmp_path, reference):
    write_container(tmp_path)
    rows, frames, _ = run(tmp_path, f"run 233\nrun 0\nrun 467\nrun {STEPS - 700}")
    frames = {row: frame for row, frame in read_dump(tmp_path / "path.txt").items() if row % 50 == 0}
    assert difference(reference[1], stack(frames)) < 1e-9
    last = rows[-1]
    assert np.abs(last[9:] - reference[0][-1, 9:]).max() < 1e-9 * np.abs(last[9:]).max()


@pytest.mark.parametrize("np_first, np_second", [(1, 2), (2, 1)])
def test_a_restart_continues_motion_impulse_and_output(tmp_path, reference, np_first, np_second):
    write_container(tmp_path)
    run(tmp_path, "run 433\nwrite_restart half.restart", np=np_first, keywords="output out 100", dump="first.txt")
    rows, frames, _ = run(tmp_path, f"run {STEPS - 433}", np=np_second, keywords="output out 100",
                          begin="read_restart half.restart")
    frames = {row: frame for row, frame in read_dump(tmp_path / "path.txt").items() if row % 50 == 0}
    whole = {row: frame for row, frame in read_dump(reference[2] / "path.txt").items() if row in frames}
    assert len(frames) == 10
    assert difference(stack(whole), stack(frames)) < 1e-7
    assert np.abs(rows[-1, 3:] - reference[0][-1, 3:]).max() < 1e-6 * np.abs(rows[-1, 3:]).max()
    for name in ("out.csv", "out.triangles.csv"):
        a, b = (np.genfromtxt(folder / name, delimiter=",", skip_header=1) for folder in (reference[2], tmp_path))
        assert a.shape == b.shape
        assert np.abs(a - b).max() < 1e-6 * np.abs(a).max()


def test_a_restart_in_the_middle_of_contacts_would_differ_without_their_history(tmp_path, reference):
    """Another fix ID: the file's history is not found, and the balls that overlap have no past."""
    write_container(tmp_path)
    run(tmp_path, "run 433\nwrite_restart half.restart", dump="first.txt")
    rows, frames, log = run(tmp_path, f"run {STEPS - 433}", begin="read_restart half.restart",
                            wall="fix other all wall/gran/mesh 2 mesh.stl", columns="f_other "
                            + " ".join(f"f_other[{k}]" for k in range(1, 10)))
    frames = {row: frame for row, frame in read_dump(tmp_path / "path.txt").items() if row % 50 == 0}
    whole = {row: frame for row, frame in read_dump(reference[2] / "path.txt").items() if row in frames}
    assert difference(stack(whole), stack(frames)) > 1e-4


def test_another_mesh_than_the_restart_files_is_refused(tmp_path):
    write_container(tmp_path)
    run(tmp_path, "run 10\nwrite_restart half.restart", dump="first.txt")
    (tmp_path / "mesh.stl").write_bytes((tmp_path / "mesh.stl").read_bytes())
    write_case(tmp_path, box((-3, -2, 0), (3, 2, 5)), [(0, 0, 2)], (0, 0, 0))
    run_deck(mesh_deck("run 1", begin="read_restart half.restart"), tmp_path,
             expect_error="Fix wall/gran/mesh wall: the restart file was written with another surface (12 triangles")


def test_terrain_too(tmp_path):
    wall = "fix wall all wall/gran/mesh 2 terrain hills.asc {keywords}"
    ends = []
    for part, (ranks, commands, begin) in enumerate([(1, "run 600", "read_data balls.data"), (2, "run 600",
                                                     "read_data balls.data"),
                                                     (1, "run 333\nwrite_restart half.restart", "read_data balls.data"),
                                                     (1, "run 267", "read_restart half.restart")]):
        write_container(tmp_path)
        rows, frames, _ = run(tmp_path, commands, np=ranks, begin=begin, wall=wall)
        ends.append(frames[-1])
    assert rows[-1, 2] > 8
    assert difference(ends[0][None], ends[1][None]) < 1e-6
    assert difference(ends[0][None], ends[3][None]) < 1e-6


def test_ranks_share_the_raster(tmp_path):
    """What one rank of a node has the others do not have."""
    write_container(tmp_path)
    cells = 800
    write_asc(tmp_path / "hills.asc", np.zeros((cells, cells)), -7.0, -7.0, 14 / cells)
    _, _, log = run(tmp_path, "run 0", np=2, wall="fix wall all wall/gran/mesh 2 terrain hills.asc {keywords}")
    least, most = map(float, re.search(r"Per MPI rank memory.* = (\S+) \| \S+ \| (\S+) Mbytes", log).groups())
    assert most - least == pytest.approx(8 * (cells + 2) ** 2 / 2 ** 20, abs=0.5)


def test_impulse_is_the_change_of_momentum(tmp_path):
    """Over impacts, rest, two runs and a restart; no gravity, so that all momentum comes from the mesh."""
    write_container(tmp_path, top=9.9)    # closed
    rows, frames, _ = run(tmp_path, "run 333\nrun 100\nwrite_restart half.restart", g=0.0, every=1, dump_every=1)
    more, frames2, _ = run(tmp_path, "run 467", g=0.0, begin="read_restart half.restart", np=2, every=1, dump_every=1)
    d = np.resize((1.0, 0.9, 0.8), frames.shape[1])
    mass = RHO * np.pi / 6 * d ** 3
    rows = np.concatenate([rows, more])
    steps = {int(row[0]): row[9:] for row in rows}
    every = {**read_dump(tmp_path / "path.txt")}
    momentum = {step: (mass[:, None] * frame[:, 4:7]).sum(axis=0) for step, frame in every.items()}
    momentum0 = (mass[:, None] * frames[0, :, 4:7]).sum(axis=0)
    scale = (mass[:, None] * np.abs(frames[0, :, 4:7])).sum()
    worst = max(np.abs(momentum[step] - momentum0 + steps[step]).max() for step in momentum)
    print(worst / scale, rows[:, 2].max())
    assert rows[:, 2].max() > 2 and np.abs(rows[:, 9:]).max() > 0.05 * scale
    assert worst < 1e-9 * scale
