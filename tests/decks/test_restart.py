"""A dense collapse cut anywhere and continued from its restart file, on other ranks too, is the uncut one.

To the bit on the same ranks where LAMMPS has the atoms in the same order: both runs rebuild their neighbor lists at
the same steps, as "restart N" in both makes them, and sorting, which a run begins with, is off or due at the cut too.
Otherwise forces are summed in another order, and the collapse, which is chaotic, enlarges the rounding: by 1e4 to 1e5
in 1,000 steps.
"""

import filecmp

import numpy as np
import pytest
import yaml

from deck_helpers import (WALL_GROUND, collapse_deck, dump_difference, flat_numbers, read_asc, read_dump, run_deck,
                          write_collapse)

UNSORTED = "sort 0 0"
RASTERS = ["thickness", "surface", "base", "max_thickness", "max_speed", "max_energy", "arrival", "last_motion"]
BALLS = 300


def whole(tmp_path, run, np_, **settings):
    write_collapse(tmp_path, BALLS, mixed=True)
    return run_deck(collapse_deck(run, **settings), tmp_path, np=np_)


def continued(tmp_path, restart, run, np_, out="again", **settings):
    return run_deck(collapse_deck(run, begin=f"read_restart {restart}", out=out, **settings), tmp_path, np=np_)


def differences(tmp_path, cut, one="out", two="again"):
    """Largest differences after the cut, frame by frame: positions, velocities, spins, forces, torques.

    The first frame is left out: LAMMPS begins a run with forces that it finds anew."""
    a, b = read_dump(tmp_path / f"{one}.dump"), read_dump(tmp_path / f"{two}.dump")
    steps = [step for step in a if step > cut]
    assert steps == [step for step in b if step > cut] and len(steps) >= 5
    found = np.array([dump_difference(a[step], b[step]) for step in steps])
    print("last frame: " + " ".join(f"{value:.2g}" for value in found[-1]))    # pytest -rP shows it
    return found


def same_files(tmp_path, one="out", two="again"):
    """Deposit, maxima, arrival times: the same bytes; the volume that changed cell: to rounding."""
    for name in RASTERS:
        assert filecmp.cmp(tmp_path / f"{one}.{name}.asc", tmp_path / f"{two}.{name}.asc", shallow=False), name
    assert filecmp.cmp(tmp_path / f"{one}.left.csv", tmp_path / f"{two}.left.csv", shallow=False)
    a, b = summary(tmp_path, one), summary(tmp_path, two)
    assert a.pop("change_rate") == pytest.approx(b.pop("change_rate"), rel=1e-12)
    # a difference of sums, whose rounding depends on the order of the balls on their ranks
    rounding = 1e-12 * a["volume"]["released"]
    assert a["volume"].pop("residual") == pytest.approx(b["volume"].pop("residual"), abs=rounding)
    for key in ("step", "time", "balls", "volume", "travel", "motion", "largest"):
        assert a[key] == b[key], key


def summary(tmp_path, prefix):
    return yaml.safe_load((tmp_path / f"{prefix}.summary.yaml").read_text())


def close_files(tmp_path, one="out", two="again"):
    """The same to rounding."""
    for name in RASTERS:
        a, b = (read_asc(tmp_path / f"{prefix}.{name}.asc")[0] for prefix in (one, two))
        assert (np.isnan(a) == np.isnan(b)).all(), name
        assert np.nan_to_num(b) == pytest.approx(np.nan_to_num(a), rel=1e-6, abs=1e-6), name
    a, b = summary(tmp_path, one), summary(tmp_path, two)
    assert a["balls"] == b["balls"]
    for key, value in flat_numbers(a).items():
        assert flat_numbers(b)[key] == pytest.approx(value, rel=1e-6, abs=1e-6), key


# --- restart N ---


@pytest.mark.parametrize("scheme, ranks, other", [("exact", 1, 2), ("exact", 4, 1), ("plain", 2, 4)])
def test_restart_in_a_run(tmp_path, scheme, ranks, other):
    settings = dict(scheme=scheme, sort=UNSORTED, every=50)
    whole(tmp_path, "restart 400 cut.*.restart\nrun 1400", ranks, **settings)
    continued(tmp_path, "cut.400.restart", "restart 400 later.*.restart\nrun 1000", ranks, **settings)
    assert (differences(tmp_path, 400) == 0.0).all()
    same_files(tmp_path)

    continued(tmp_path, "cut.400.restart", "run 1000", other, out="other", **settings)
    found = differences(tmp_path, 400, two="other")
    assert found[:, 0].max() < 1e-10 and found.max() < 1e-7
    close_files(tmp_path, two="other")


def test_with_sorting_and_atoms_as_ground(tmp_path):
    """A run begins with sorting: to the bit where it was due at the cut. The ground's balls come along."""
    freeze = "group floor type 3\nfix freeze floor freeze"
    settings = dict(sort="sort 150 1.0", every=10)
    whole(tmp_path, "restart 300 cut.*.restart\nrun 450", 2, **settings,
          ground="create_balls 3 1.0 3411.4 surface ground upper spacing 1.0\n" + freeze)
    continued(tmp_path, "cut.300.restart", "run 150", 2, ground=freeze, **settings)
    assert (differences(tmp_path, 300) == 0.0).all()
    same_files(tmp_path)


# --- write_restart ---


def test_write_restart_anywhere(tmp_path):
    """In the first step, when lists are built, when they are not, with most balls in the middle of contacts."""
    log = whole(tmp_path, "thermo_style custom step nbuild\nthermo 1\nrun 500", 1, sort=UNSORTED, every=20)
    rows = [line.split() for line in log.splitlines()]
    builds = {int(row[0]): int(row[1]) for row in rows if len(row) == 2 and all(word.isdigit() for word in row)}
    later = [step for step in range(380, 440) if step % 20]
    built = next(step for step in later if builds[step] > builds[step - 1])
    not_built = next(step for step in later if builds[step] == builds[step - 1])
    for cut, ranks in ((1, 1), (built, 1), (not_built, 2)):
        run = f"run {cut}\nwrite_restart cut.restart\nrun {500 - cut}"
        whole(tmp_path, run, ranks, sort=UNSORTED, every=20, out="pieces")
        continued(tmp_path, "cut.restart", f"run {500 - cut}", ranks, sort=UNSORTED, every=20)
        assert (differences(tmp_path, cut, "pieces") == 0.0).all(), cut
        same_files(tmp_path, "pieces")
        assert differences(tmp_path, cut)[:, 0].max() < 1e-10, cut
        close_files(tmp_path)


def test_cut_of_a_cut(tmp_path):
    """Every 97 steps another process, each on other ranks than the one before."""
    whole(tmp_path, "run 582", 1, every=20)
    whole(tmp_path, "run 97\nwrite_restart cut.restart", 1, out="again")
    for ranks in (2, 4, 1, 2):
        continued(tmp_path, "cut.restart", "run 97\nwrite_restart cut.restart", ranks)
    continued(tmp_path, "cut.restart", "run 97", 2)
    last = [read_dump(tmp_path / f"{name}.dump")[580] for name in ("out", "again")]
    assert dump_difference(*last)[0] < 1e-10
    close_files(tmp_path)


# --- what it would be without ---


def test_forgetting(tmp_path):
    """Negative controls: without the contacts a run does not begin, without half-step velocities it is another one."""
    whole(tmp_path, "restart 400 cut.*.restart\nrun 600", 1, every=20)
    read = "read_restart cut.400.restart\n"
    again = dict(begin=read, out="again", every=20)
    run_deck(collapse_deck("run 1", **{**again, "ground": WALL_GROUND.replace("field", "other")}), tmp_path,
             expect_error="Fix wall/gran/balls other: ")

    # the internal fix gets another name, as its own is in use
    taken = read + 'pair_style none\nfix NEIGH_HISTORY_SLOPE_DUMMY0 all print 1000 "taken"'
    run_deck(collapse_deck("run 1", **{**again, "begin": taken}), tmp_path, expect_error="Pair gran/restitution: ")

    run_deck(collapse_deck("run 200", **{**again, "begin": read + "reset_timestep 0"}), tmp_path)
    other = read_dump(tmp_path / "again.dump")[200]
    assert dump_difference(read_dump(tmp_path / "out.dump")[600], other)[0] > 1e-6
