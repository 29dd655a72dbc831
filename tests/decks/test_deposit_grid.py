"""fix deposit/grid: thickness, balance, maxima, travel, halt, files and restart.

Balls fly freely here (no pair style, no wall) unless said otherwise, so that every number has a
closed form: the tests compute it with numpy from the balls that they themselves placed.
"""

import math
import struct

import numpy as np
import pytest
import yaml

from deck_helpers import doc_examples, flat_numbers, flight_head as head, read_asc, run_deck, write_asc, write_balls


def thickness_of(x, d, lo, n, cell, bulk=6 / math.pi):
    """Thickness raster of balls at x: overlap of their squares with the cells, by numpy."""
    volume = bulk * math.pi / 6 * np.broadcast_to(d, len(x)) ** 3
    side = np.cbrt(volume)
    parts = []
    for dim in (0, 1):
        edge = lo[dim] + cell * np.arange(n[dim] + 1)
        a = np.maximum(x[:, dim, None] - side[:, None] / 2, edge[:-1])
        b = np.minimum(x[:, dim, None] + side[:, None] / 2, edge[1:])
        parts.append(np.maximum(b - a, 0) / side[:, None])
    return np.einsum("k,ki,kj->ji", volume, parts[0], parts[1]) / cell**2


def summary(tmp_path, prefix="out"):
    return yaml.safe_load((tmp_path / f"{prefix}.summary.yaml").read_text())


def raster(tmp_path, name, prefix="out"):
    return read_asc(tmp_path / f"{prefix}.{name}.asc")[0]


def numbers(log, tag="numbers:"):
    """What the last 'print "numbers: ..."' of a deck gave."""
    line = [line for line in log.splitlines() if line.startswith(tag)][-1]
    return [float(word) for word in line.split()[1:]]


VECTOR = " ".join(f"$(f_dep[{k}]:%.17g)" for k in range(1, 12))
PRINT = f'\nprint "numbers: {VECTOR}"\n'


def flat(tmp_path, size=20, z=0.0, xlo=0.0, ylo=0.0, cell=1.0):
    write_asc(tmp_path / "ground.asc", np.full((size, size), z), xlo, ylo, cell)


@pytest.mark.parametrize("units, speed, fast", [("si", 0.11, 1), ("cgs", 9.0, 0), ("cgs", 11.0, 1)])
def test_fast_is_one_speed_in_all_units(tmp_path, units, speed, fast):
    flat(tmp_path)
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 1.0, [[speed, 0, 0]], [(0, 20)] * 3)
    run_deck(head().replace("units si", f"units {units}")
             + "fix dep all deposit/grid 1 0 cell 1 terrain ground output out bulk 1.9\nrun 1\n", tmp_path)
    assert summary(tmp_path)["motion"]["fast_share"] == fast


# --- volume ---


def cloud(tmp_path, shift=0.0):
    """300 balls of mixed size that fly apart; box 20 x 20 x 20, many leave it within 1 s."""
    rng = np.random.default_rng(1)
    lo = np.array([shift, -shift / 3, 5.0])
    x = lo + rng.uniform(0.5, 19.5, (300, 3))
    d = rng.choice([0.3, 0.7, 1.25], 300)
    v = rng.normal(0, 8, (300, 3))
    flat(tmp_path, xlo=lo[0], ylo=lo[1], z=7.0)
    box = [(float(low), float(low) + 20.0) for low in lo]
    write_balls(tmp_path / "balls.data", x, d, v, box)
    return x, d, v, lo


@pytest.mark.parametrize("np_, cell, shift, more", [
    (1, 1.0, 0.0, {}),
    (2, 0.37, 0.0, {"newton": "off"}),
    (4, 1.0, -54321.75, {}),
    (4, 7.3, 0.0, {"comm": "tiled"}),
    (2, 0.05, 1000.5, {}),
])
def test_balance_and_thickness(tmp_path, np_, cell, shift, more):
    """Balls leave the box on all sides and lie across the grid's edge: every term is exact."""
    x, d, v, lo = cloud(tmp_path, shift)
    volume = d**3  # bulk 6/pi
    balance = "balance 1.0 rcb" if more.get("comm") == "tiled" else ""
    extent = [lo[0] + 3.0, lo[0] + 15.5, lo[1] + 4.0, lo[1] + 17.0]
    text = head(**more) + balance + f"""
fix dep all deposit/grid 50 0 cell {cell} terrain ground output out &
    extent {extent[0]} {extent[1]} {extent[2]} {extent[3]}
run 500
run 500
""" + PRINT
    log = run_deck(text, tmp_path, np=np_)

    # which balls are left, step by step as LAMMPS looks at them
    inside = np.ones(len(x), bool)
    left = np.full(len(x), 2000)    # step
    for step in range(1, 1001):
        at = x + v * 0.001 * step
        inside &= ((at >= lo) & (at < lo + 20)).all(axis=1)
        left[~inside & (left == 2000)] = step
    at = x + v * 1.0
    n = [math.ceil((extent[1] - extent[0]) / cell), math.ceil((extent[3] - extent[2]) / cell)]
    expected = thickness_of(at[inside], d[inside], (extent[0], extent[2]), n, cell)

    found = summary(tmp_path)
    balls, vol = found["balls"], found["volume"]
    assert balls == {"released": 300, "present": inside.sum(), "lost": (~inside).sum()}
    assert 50 < balls["lost"] < 250
    released = volume.sum()
    assert vol["released"] == pytest.approx(released, rel=1e-12)
    assert vol["lost"] == pytest.approx(volume[~inside].sum(), rel=1e-12)
    assert vol["on_grid"] == pytest.approx(expected.sum() * cell**2, rel=1e-9)
    assert vol["off_grid"] > 0.05 * released
    assert abs(vol["residual"]) < 1e-9 * released
    assert vol["released"] == pytest.approx(
        vol["on_grid"] + vol["off_grid"] + vol["lost"], rel=1e-9)

    h, header = read_asc(tmp_path / "out.thickness.asc")
    assert np.abs(h - expected).max() < 1e-6 * expected.max()
    assert h.sum() * cell**2 == pytest.approx(vol["on_grid"], rel=1e-9)
    assert (header["xllcorner"], header["yllcorner"]) == pytest.approx((extent[0], extent[2]))
    assert raster(tmp_path, "surface") == pytest.approx(7.0 + h, rel=1e-8)

    vector = numbers(log)
    assert vector[:5] == pytest.approx([vol[k] for k in
                                        ("released", "on_grid", "off_grid", "lost", "residual")])
    assert vector[9] == balls["lost"]
    warnings = [line for line in log.splitlines() if "left the box" in line]
    assert len(warnings) == 5 and "lost so far: 5, more are only counted" in warnings[-1]
    lost = [int(line.split(" ball ")[1].split()[0]) for line in warnings]
    assert lost == (np.argsort(left, kind="stable")[:5] + 1).tolist()
    assert "balance does not close" not in log


@pytest.mark.parametrize("side", range(6))
def test_lost_through_every_side(tmp_path, side):
    """Also a ball that in the last step lies exactly on the upper side, which LAMMPS deletes."""
    flat(tmp_path, 10)
    v = np.zeros(3)
    v[side % 3] = -1.0 if side < 3 else 1.0
    x = np.full((3, 3), 5.0)
    x[1][side % 3] = 0.05 if side < 3 else 9.95
    x[2][side % 3] = 0.25 if side < 3 else 9.75  # reaches the side in 256 steps of 2^-10
    write_balls(tmp_path / "balls.data", x, [0.5, 0.25, 0.125], [v, v, v], [(0.0, 10.0)] * 3)
    log = run_deck(head(dt=2**-10) + """
fix dep all deposit/grid 1 0 cell 1 terrain ground output out
run 256
""", tmp_path, np=1 + side % 2)
    found = summary(tmp_path)
    lost = [0.25, 0.125] if side >= 3 else [0.25]
    assert found["balls"]["lost"] == len(lost)
    assert found["volume"]["lost"] == pytest.approx(sum(d**3 for d in lost), rel=1e-12)
    assert abs(found["volume"]["residual"]) < 1e-12
    assert "ball 2 left the box at" in log and ("ball 3 left the box at" in log) == (side >= 3)


def test_lost_between_runs(tmp_path):
    """Commands between runs drop balls outside of the box as well; they are counted."""
    flat(tmp_path, 10)
    v = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    write_balls(tmp_path / "balls.data", [[5, 5, 5], [9.999, 5, 5], [5, 9.99, 5], [5, 5, 9.98]],
                [0.5, 0.25, 0.125, 0.0625], v, [(0.0, 10.0)] * 3)
    text = head() + """
pair_style zero 1.0
pair_coeff * *
neigh_modify every 1000 delay 1000
fix dep all deposit/grid 1 0 cell 1 terrain ground output out
run 5
""" + PRINT.replace("numbers", "zero") + """
write_restart a.restart
""" + PRINT.replace("numbers", "one") + """
displace_atoms all move 0 0.01 0 units box
write_data a.data
""" + PRINT.replace("numbers", "two") + """
displace_atoms all move 0 0 0.02 units box
delete_atoms overlap 0.001 all all
run 1
""" + PRINT.replace("numbers", "three")
    for np_ in (1, 2):
        log = run_deck(text, tmp_path, np=np_)
        volume = 0.0
        for lost, (word, d) in enumerate([("zero", 0), ("one", 0.25), ("two", 0.125),
                                          ("three", 0.0625)]):
            volume += d**3
            vector = numbers(log, word + ":")
            assert vector[9] == lost and vector[3] == pytest.approx(volume), word
            assert abs(vector[4]) < 1e-15, word


def test_balance_tells_when_it_does_not_close(tmp_path):
    """Negative control: a ball that is deleted behind the fix's back is in no term."""
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[5, 5, 5], [3, 3, 5]], 0.5, None, [(0.0, 10.0)] * 3)
    log = run_deck(head() + """
fix dep all deposit/grid 1 0 cell 1 terrain ground output out
run 1
group one id 1
delete_atoms group one compress no
run 1
""", tmp_path)
    assert summary(tmp_path)["volume"]["residual"] == pytest.approx(0.125)
    assert log.count("the volume balance does not close") == 1


def test_periodic(tmp_path):
    """A square across a periodic boundary goes on at the other side."""
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[0.2, 9.9, 5], [9.0, 0.3, 5]], 1.0,
                [[-3.0, 2.0, 0], [0.5, -1.0, 0]], [(0.0, 10.0)] * 3)
    for np_ in (1, 4):
        run_deck(head(boundary="p p f") + "neigh_modify every 10 delay 10\n" + """
fix dep all deposit/grid 7 0 cell 0.5 terrain ground output out
run 104
""" + PRINT, tmp_path, np=np_)
        x = np.array([[0.2 - 0.312, 9.9 + 0.208, 5], [9.052, 0.196, 5]])
        expected = sum(thickness_of(x + [10 * i, 10 * j, 0], 1.0, (0, 0), (20, 20), 0.5)
                       for i in (-1, 0, 1) for j in (-1, 0, 1))
        assert raster(tmp_path, "thickness") == pytest.approx(expected, abs=1e-9)
        found = summary(tmp_path)
        assert found["volume"]["on_grid"] == pytest.approx(2.0, rel=1e-12)
        assert found["volume"]["off_grid"] == 0.0
        # travel goes on across the boundary
        assert found["travel"]["centroid"] == pytest.approx(math.hypot(-0.13, 0.052), rel=1e-9)


def test_bulk_base_and_scar(tmp_path):
    """The base follows the scar of a slip sphere; volume over NODATA is in the thickness."""
    values = np.full((20, 20), 10.0)
    values[2, 2] = np.nan
    write_asc(tmp_path / "ground.asc", values, -10.0, -10.0)
    write_balls(tmp_path / "balls.data", [[0, 0, 9], [5, 5, 12]], 0.5, [[0, 0, 0], [-12, -12.5, 0]],
                [(-10.0, 10.0), (-10.0, 10.0), (0.0, 40.0)])
    regions = """
region out sphere 0 0 12 5 side out units box
region stays intersect 2 ground out
"""
    run_deck(head(regions=regions) + """
fix dep all deposit/grid 1 0 cell 0.5 terrain stays output out bulk 1.5
run 1000
""", tmp_path, np=3)
    surface, header = read_asc(tmp_path / "out.surface.asc")
    c = -10 + 0.5 * (np.arange(40) + 0.5)
    x, y = np.meshgrid(c, c)
    r2 = x**2 + y**2
    base = np.where(r2 < 25 - 4, 12 - np.sqrt(np.maximum(25 - r2, 0)), 10.0)
    h = raster(tmp_path, "thickness")
    hole = (abs(x + 7.5) < 1) & (abs(y + 7.5) < 1)
    assert np.isnan(surface[hole]).all() and not np.isnan(surface[~hole]).any()
    assert (surface - h)[~hole] == pytest.approx(base[~hole], abs=1e-6)
    written = raster(tmp_path, "base")
    assert np.isnan(written[hole]).all() and written[~hole] == pytest.approx(base[~hole], abs=1e-6)
    assert h[hole].sum() > 0  # the second ball came to rest there
    assert h.sum() * 0.25 == pytest.approx(2 * 1.5 * math.pi / 6 * 0.125, rel=1e-9)


# --- maxima, times, travel ---


def test_maxima_and_times(tmp_path):
    """One ball along a row of cells at 2 m/s, spinning; sampled every 0.01 s. The time begins with
    the fix and goes on over runs, changes of the time step and of the step number."""
    flat(tmp_path, 10)
    d, spin = 0.8, 5.0
    write_balls(tmp_path / "balls.data", [[1.3, 3.5, 5], [7.5, 7.5, 5]], d,
                [[2.0, 0, 0], [0, 0, 0]],
                [(0.0, 10.0)] * 3, [[0, spin, 0], [0, 0, 0]])
    run_deck(head() + """
run 100
fix dep all deposit/grid 10 0 cell 1 terrain ground output out
timestep 0.0005
run 1000
reset_timestep 30
timestep 0.001
run 1500
""", tmp_path, np=2)
    arrival, last = raster(tmp_path, "arrival"), raster(tmp_path, "last_motion")
    speed, energy = raster(tmp_path, "max_speed"), raster(tmp_path, "max_energy")
    m = 1000 * math.pi / 6 * d**3
    for i in range(1, 6):
        # enters at x = i; the next sample at or after that
        assert arrival[3, i] == pytest.approx(0 if i == 1 else (i - 1.5) / 2, abs=0.0101)
        assert arrival[3, i] >= (0 if i == 1 else (i - 1.5) / 2 - 1e-9)
        assert last[3, i] == pytest.approx(min(2.0, (i - 0.5) / 2), abs=0.0101)
        assert speed[3, i] == pytest.approx(2.0)
        assert energy[3, i] == pytest.approx(0.5 * m * 4 + 0.5 * 0.4 * m * 0.16 * spin**2)
    assert arrival[7, 7] == 0 and np.isnan(last[7, 7]) and speed[7, 7] == 0
    visited = np.zeros((10, 10), bool)
    visited[3, 1:6] = visited[7, 7] = True
    assert np.isnan(arrival[~visited]).all() and np.isnan(last[~visited]).all()
    assert (speed[~visited] == 0).all() and (energy[~visited] == 0).all()
    # the ball's square is 0.8 wide: alone in a cell it is 0.512 thick, in the rows beside 0
    most = raster(tmp_path, "max_thickness")
    assert most[3, 1:5] == pytest.approx(0.512, rel=0.03) and most[2, 1] == 0
    assert summary(tmp_path)["time"] == pytest.approx(2.0, rel=1e-12)
    assert summary(tmp_path)["motion"]["largest_speed"] == pytest.approx(2.0)


@pytest.mark.parametrize("np_", [1, 2])
def test_travel(tmp_path, np_):
    """Front, reach angle and centroid of three balls of different mass."""
    flat(tmp_path, 20)
    x = np.array([[2.0, 2, 15], [3.0, 2, 14], [2.0, 5, 14.5]])
    d = np.array([0.5, 1.0, 0.5])
    v = np.array([[0.0, 0, 0], [10.0, 7, -9], [1.0, 0, 0]])
    write_balls(tmp_path / "balls.data", x, d, v, [(0.0, 20.0)] * 3)
    log = run_deck(head() + """
fix dep all deposit/grid 10 0 cell 1 terrain ground output out
run 1000
""" + PRINT, tmp_path, np=np_)
    end = x + v
    front = math.hypot(11, 7)
    mass = d**3 / (d**3).sum()
    centroid = np.hypot(*((mass[:, None] * v).sum(axis=0)[:2]))
    travel = summary(tmp_path)["travel"]
    assert travel["front"] == pytest.approx(front)
    assert travel["front_at_release"] == pytest.approx(3.0)
    assert travel["reach_angle"] == pytest.approx(math.degrees(math.atan2(15 - end[1, 2], front)))
    assert travel["centroid"] == pytest.approx(centroid)
    assert numbers(log)[6:9] == pytest.approx([front, travel["reach_angle"], centroid])


def test_change_and_halt(tmp_path):
    """A ball of half the mass crosses one cell per window: 0.5 per window; when it has left the
    grid nothing changes, and fix halt ends the run."""
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[0.5, 4.5, 5], [0.5, 2.5, 5]], 1.0,
                [[2.0, 0, 0], [0, 0, 0]], [(-1.0, 30.0)] * 3)
    text = head() + """
fix dep all deposit/grid 10 0 cell 1 terrain ground output out window 500
print "before: $(f_dep[6])"
thermo_style custom step time f_dep f_dep[6] f_dep[2]
thermo 250
variable rest equal f_dep[6]
fix stop all halt 100 v_rest < 0.002 error continue
run 20000
""" + PRINT
    log = run_deck(text, tmp_path, np=2)
    rows = [line.split() for line in log.splitlines()]
    change = {int(r[0]): float(r[3]) for r in rows if len(r) == 5 and r[0].isdigit()}
    assert numbers(log, "before:") == [1.0]
    assert change[0] == change[250] == 1.0
    assert change[500] == pytest.approx(1.0)  # 0.5 of the mass in 0.5 s
    assert change[4500] == pytest.approx(1.0)
    assert change[5000] == pytest.approx(0.5)  # it leaves: one cell less, none more
    assert change[5500] == 0.0
    found = summary(tmp_path)
    assert found["stop"] == {"step": 5500, "time": pytest.approx(5.5), "reason": "halted"}
    assert found["change_rate"] == 0.0
    assert found["moving"] is True and found["motion"]["moving_share"] == pytest.approx(0.5)


@pytest.mark.parametrize("number", [0, 130, 400])
def test_change_whatever_the_steps_are_called(tmp_path, number):
    """A window is over after so many steps made: here 40 steps after the number has been set."""
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[0.5, 4.5, 5], [0.5, 2.5, 5]], 1.0,
                [[1.0, 0, 0], [0, 0, 0]], [(-1.0, 30.0)] * 3)
    log = run_deck(head() + f"""
fix dep all deposit/grid 10 0 cell 1 terrain ground output out window 100
run 60
reset_timestep {number}
run 30
print "before: $(f_dep[6])"
run 10
print "then: $(f_dep[6])"
""", tmp_path)
    assert numbers(log, "before:") == [1.0]
    assert numbers(log, "then:") == pytest.approx([0.5])     # half of the mass by a tenth of a cell in 0.1 s


# --- files ---


def test_files_and_summary(tmp_path):
    flat(tmp_path, 10)
    (tmp_path / "it's").mkdir()
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 0.5, [[0, 0, -0.001]], [(0.0, 10.0)] * 3)
    text = head() + """
fix dep all deposit/grid 10 20 cell 1 terrain ground output "it's/out" series yes
variable step equal step
fix crash all halt 50 v_step >= 50 error hard
run 40
"""
    run_deck(text, tmp_path)
    names = ["thickness", "surface", "base", "max_thickness", "max_speed", "max_energy", "arrival",
             "last_motion"]
    files = [f"out.{name}.asc" for name in names]
    expected = sorted(files + ["out.summary.yaml", "out.left.csv", "out.20.thickness.asc", "out.40.thickness.asc"])
    assert sorted(f.name for f in (tmp_path / "it's").iterdir()) == expected
    found = summary(tmp_path / "it's")
    assert found["files"] == ["out.40.thickness.asc"] + files + ["out.left.csv"]
    assert found["stop"]["reason"] == "run completed" and found["moving"] is False
    assert found["fix"] == "dep" and found["ranks"] == 1 and found["step"] == 40
    assert found["slope_version"] and found["lammps_version"]
    assert found["dt"] == 0.001 and found["bulk_factor"] == pytest.approx(6 / math.pi)
    assert found["grid"] == {"cell": 1.0, "columns": 10, "rows": 10, "extent": [0, 10, 0, 10]}
    assert found["motion"]["median_speed"] == pytest.approx(0.001)
    assert all(isinstance(value, float) for value in found["volume"].values())

    # a run that dies leaves the files of the last Nfreq, whole
    run_deck(text.replace("run 40", "run 60"), tmp_path,
             expect_error="Fix halt condition for fix-id crash")
    found = summary(tmp_path / "it's")
    assert found["stop"] == {"step": 40, "time": pytest.approx(0.04), "reason": "running"}
    assert sorted(f.name for f in (tmp_path / "it's").iterdir()) == expected


@pytest.mark.parametrize("np_, name", [(1, "out.summary.yaml"), (2, "out.last_motion.asc"), (2, "out.left.csv"),
                                       (1, "out.lock")])
def test_a_folder_where_a_file_must_be(tmp_path, np_, name):
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 0.5, None, [(0.0, 10.0)] * 3)
    (tmp_path / name).mkdir()
    log = run_deck(head() + "fix dep all deposit/grid 1 0 cell 1 terrain ground output out\nrun 10\n", tmp_path, np=np_,
                   expect_error=f"Fix deposit/grid: cannot write {name}: Is a directory")
    assert "Step" not in log and [path.name for path in tmp_path.glob("out*")] == [name]


@pytest.mark.parametrize("np_", [1, 2])
def test_a_folder_that_comes_in_the_run_leaves_all_files_as_they_were(tmp_path, np_):
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 0.5, [[1, 0, 0]], [(0.0, 10.0)] * 3)
    run_deck(head() + "fix dep all deposit/grid 1 2 cell 1 terrain ground series yes output out\nrun 2\n"
             "run 2 pre no post no every 1 'shell rm -f out.last_motion.asc' 'shell mkdir -p out.last_motion.asc'\n",
             tmp_path, np=np_, expect_error="Fix deposit/grid: cannot write out.last_motion.asc: Is a directory")
    assert summary(tmp_path)["step"] == 3 and not list(tmp_path.glob("*.4.*")) and not list(tmp_path.glob("*.tmp"))


# --- restart ---

HEAP = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region ground terrain ground.asc
{begin}
pair_style gran/hooke/history 2e5 NULL 50 NULL 0.5 1
pair_coeff * *
timestep 0.0005
fix g all gravity 9.81 vector 0.7 0 -1
fix move all nve/sphere
fix floor all wall/gran hooke/history 2e5 NULL 50 NULL 0.5 1 zplane 0 NULL
thermo_modify lost ignore
{dep}
{run}
"""
DEP = ("fix dep all deposit/grid 20 0 cell 0.7 terrain ground output {} window 200 "
       "extent -2 8.5 -2 8")


def heap(begin, dep, run):
    return HEAP.format(begin=begin, dep=dep, run=run)


@pytest.mark.parametrize("np_write, np_read", [(1, 4), (4, 2)])
def test_restart(tmp_path, np_write, np_read):
    """A restarted run ends with the files of the continuous one: all maxima, times, balls lost
    before and after. The restart is written in the run, in the middle of a window."""
    flat(tmp_path, 12, z=0.0, xlo=-2.0, ylo=-2.0, cell=1.0)
    begin = """
region box block -2 10 -2 10 -0.5 8 units box
create_box 1 box
lattice sc 0.55
region block block 4 9.5 0 4 0.3 3 units box
create_atoms 1 region block
set group all diameter 0.5
set group all density 2000
"""
    run_deck(heap(begin, DEP.format("one"), "restart 1500 a.*.restart\nrun 1500\nrun 1500"),
             tmp_path, np=np_write)
    log = run_deck(heap("read_restart a.1500.restart", DEP.format("two"),
                        "run 0\n" + PRINT + "run 1500"), tmp_path, np=np_read)

    one, two = summary(tmp_path, "one"), summary(tmp_path, "two")
    assert one["balls"]["lost"] > 10 and one["volume"]["off_grid"] > 0
    assert 0 < numbers(log)[9] < one["balls"]["lost"]
    for key in ("step", "time", "balls", "change_rate", "grid"):
        assert two[key] == one[key] or two[key] == pytest.approx(one[key], rel=1e-6), key
    for key, value in flat_numbers(one).items():
        assert flat_numbers(two)[key] == pytest.approx(value, rel=1e-6, abs=1e-9), key
    assert abs(two["volume"]["residual"]) < 1e-9 * two["volume"]["released"]
    assert two["warnings"][:2] == one["warnings"][:2] and len(two["warnings"]) == len(one["warnings"]) == 6
    for name in ("thickness", "max_thickness", "max_speed", "max_energy", "arrival", "last_motion"):
        a, b = raster(tmp_path, name, "one"), raster(tmp_path, name, "two")
        assert (np.isnan(a) == np.isnan(b)).all(), name
        assert np.nan_to_num(b) == pytest.approx(np.nan_to_num(a), rel=1e-5, abs=1e-6), name

    # and none of it is made up after the restart
    before = [np.nansum(raster(tmp_path, name, "one") < 0.75)
              for name in ("arrival", "last_motion")]
    assert min(before) > 4

    # data of an older version is refused, and a file without the cells, which would have taken more than 2 GB
    data = (tmp_path / "a.1500.restart").read_bytes()
    number = struct.pack("<2d", 1.0, -2.0)
    style, left_out = (name.ljust(24, b"\0") + number for name in (b"deposit/grid", b"cells_left_out"))
    assert data.count(style + struct.pack("<d", 8.0)) == data.count(left_out + struct.pack("<d", 0.0)) == 1
    for name, member, value, message in [
            ("old", style, 7.0,
             "Fix deposit/grid dep: the restart file must have data of version 8, got 7: start again"),
            ("large", left_out, 4e7,
             "Fix deposit/grid dep: nothing can go on from this restart file, in which it may have 38347849 cells that "
             "the mass touched, got 40000000: start again, with a larger cell")]:
        at = data.index(member) + len(member)
        (tmp_path / f"{name}.restart").write_bytes(data[:at] + struct.pack("<d", value) + data[at + 8:])
        run_deck(heap(f"read_restart {name}.restart", DEP.format("two"), "run 0"), tmp_path, expect_error=message)


@pytest.mark.parametrize("np_", [1, 2])
def test_restart_of_a_mass_in_the_south(tmp_path, np_):
    """Rows in the north, of either rank, that have nothing to say."""
    flat(tmp_path, 20)
    write_balls(tmp_path / "balls.data", [[5, 2, 5]], 0.5, None, [(0.0, 20.0)] * 3)
    run_deck(head() + "fix dep all deposit/grid 10 0 cell 0.5 terrain ground output out\nrun 10\n"
             "write_restart a.restart\n", tmp_path, np=np_)


# --- ranks ---

RASTERS = ["thickness", "surface", "base", "max_thickness", "max_speed", "max_energy", "arrival", "last_motion"]


@pytest.mark.parametrize("np_, processors, cell", [(2, "2 1 1", 0.03), (3, "1 3 1", 0.5), (4, "1 1 4", 0.11)])
def test_ranks_agree(tmp_path, np_, processors, cell):
    """All rasters of one rank, on ranks beside and above each other; also where a rank has more cells than it sends
    at once (0.03: 3,500 blocks of 8 x 8 cells, all of one rank)."""
    rng = np.random.default_rng(3)
    x = np.array([10.7, 0.7, 2.0]) + rng.uniform(0, 1, (300, 3)) * [8.6, 18.6, 16.0]
    flat(tmp_path, z=3.0)
    write_balls(tmp_path / "balls.data", x, 1.25, rng.normal(0, 2, x.shape), [(0.0, 20.0)] * 3)
    text = head().replace("read_data", "processors {}\nread_data") + f"""
fix dep all deposit/grid 10 0 cell {cell} terrain ground output {{}} extent 10 20 0 20 window 10
run 40
"""
    run_deck(text.format("* * *", "one"), tmp_path)
    run_deck(text.format(processors, "several"), tmp_path, np=np_)
    for name in RASTERS:
        a, b = raster(tmp_path, name, "one"), raster(tmp_path, name, "several")
        assert b == pytest.approx(a, rel=1e-9, abs=1e-11, nan_ok=True), name
    assert raster(tmp_path, "thickness", "one").sum() > 0
    one, several = summary(tmp_path, "one"), summary(tmp_path, "several")
    assert several["ranks"] == np_ and several["change_rate"] == pytest.approx(one["change_rate"], rel=1e-9) != 1.0
    for key, value in flat_numbers(one).items():
        assert flat_numbers(several)[key] == pytest.approx(value, rel=1e-9, abs=1e-9), key


# --- bad input ---


@pytest.mark.parametrize("np_", [1, 2])
def test_larger_than_the_memory(tmp_path, np_):
    """Refused before anything is allocated: by the sum over the ranks of the machine."""
    available = [line.split()[1] for line in open("/proc/meminfo") if line.startswith("MemAvailable")]
    if 1024 * int(available[0]) > 175e9:
        pytest.skip("this machine has the memory for as many cells as there may be")
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 0.5, None, [(0.0, 10.0)] * 3)
    ranks = ["1 rank", "2 ranks"][np_ - 1]
    run_deck(head() + "fix dep all deposit/grid 10 0 cell 0.00022 terrain ground output out\nrun 1\n", tmp_path,
             np=np_, expect_error="Fix deposit/grid cell 0.00022: 45455 x 45455 cells need 182 GB of memory on a node "
             f"({ranks}), which has ")
    assert not list(tmp_path.glob("out.*"))


GOOD = "fix dep all deposit/grid 10 0 cell 1 terrain ground output out"


@pytest.mark.parametrize("np_, region", [(1, "ground"), (2, "stays")])
def test_hole_under_the_release(tmp_path, np_, region):
    """No ground within one diameter of ball 2: the run ends. Just beyond: it goes on."""
    values = np.full((10, 10), 3.0)
    values[5, 5] = np.nan  # no ground in 4.5 < x, y < 6.5
    write_asc(tmp_path / "ground.asc", values)
    regions = """
region out sphere 1 1 3 1 side out units box
region stays intersect 2 ground out
"""
    text = head(regions=regions) + GOOD.replace("ground", region) + "\nrun 1\n"
    box = [(0.0, 10.0)] * 3
    write_balls(tmp_path / "balls.data", [[1, 1, 5], [4.01, 5.5, 5], [5.5, 5.5, 5]], 0.5, None, box)
    run_deck(text, tmp_path, np=np_,
             expect_error=f"Fix deposit/grid terrain region {region} must have a height within one "
             "diameter 0.5 of every released ball, got none at ball 2, 4.01 5.5 5")
    write_balls(tmp_path / "balls.data", [[1, 1, 5], [3.99, 5.5, 5]], 0.5, None, box)
    run_deck(text, tmp_path, np=np_)


def test_release_beside_the_ground(tmp_path):
    """Beyond the ground's edge only a ball's own column counts."""
    flat(tmp_path, 10)
    write_balls(tmp_path / "balls.data", [[0.1, 5, 5]], 0.5, None, [(-5.0, 10.0)] * 3)
    run_deck(head() + GOOD + "\nrun 1\n", tmp_path)
    write_balls(tmp_path / "balls.data", [[-0.1, 5, 5]], 0.5, None, [(-5.0, 10.0)] * 3)
    run_deck(head() + GOOD + "\nrun 1\n", tmp_path, expect_error="got none at ball 1, -0.1 5 5")


def test_doc_examples(tmp_path):
    flat(tmp_path, 60)
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 0.5, None, [(0.0, 60.0)] * 3)
    regions = """
region out sphere 30 30 0 5 side out units box
region stays intersect 2 ground out
region body sphere 5 5 5 0.4 units box
"""
    run_deck(head(regions=regions) + "group soil type 1\n" + doc_examples("fix_deposit_grid") +
             "\nrun 30000\n", tmp_path)
    # the last of them: a ball that lies still is at rest when the deck has waited long enough
    found = summary(tmp_path, "collapse")
    assert found["stop"]["step"] == 21000 and found["stop"]["reason"] == "halted"
    assert found["grid"]["extent"] == [0, 60, 0, 40] and found["bulk_factor"] == 1.7
    assert found["motion"]["rest_share"] == 0.03
