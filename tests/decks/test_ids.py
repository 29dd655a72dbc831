"""Balls that get other IDs between runs keep the histories of their contacts."""

import pytest
from scipy.spatial import cKDTree

from deck_helpers import collapse_deck, read_dump, run_deck, write_collapse

BALLS, BEFORE, AFTER = 160, 400, 100
DELETE = f"group gone id 1:{BALLS}:7\ndelete_atoms group gone compress"


def run(tmp_path, between, out, np_=1, **settings):
    """Places, velocities, spins, forces and torques in the end, with these commands between two runs."""
    run_deck(collapse_deck(f"run {BEFORE}\n{between}\nrun {AFTER}", every=AFTER, out=out, **settings), tmp_path, np=np_)
    return read_dump(tmp_path / f"{out}.dump")


def difference(one, other):
    """Largest difference of the rows of two frames with other IDs, each vector relative to the largest of its kind."""
    assert one.shape == other.shape
    far, row = cKDTree(other[:, 1:4]).query(one[:, 1:4])
    assert len(set(row)) == len(row) and far.max() < 1e-6
    return [abs(one[:, k:k + 3] - other[row, k:k + 3]).max() / abs(one[:, k:k + 3]).max()
            for k in range(1, one.shape[1], 3)]


@pytest.mark.parametrize("np_, newton", [(1, "on"), (3, "on"), (3, "off")])
def test_delete_atoms_keeps_the_contacts_of_the_others(tmp_path, np_, newton):
    """With the IDs closed up, as is LAMMPS' default, as with the IDs left; into a restart file, too."""
    write_collapse(tmp_path, BALLS)
    left = run(tmp_path, f"{DELETE} no", "left", newton=newton)
    closed = run(tmp_path, f"{DELETE} yes\nwrite_restart closed.restart", "closed", np_, newton=newton)
    last = max(left)
    assert len(left[last]) < BALLS and max(closed[last][:, 0]) == len(closed[last])
    assert max(difference(left[last], closed[last])) < 1e-7
    begin = "read_restart closed.restart"
    run_deck(collapse_deck(f"run {AFTER}", begin=begin, every=AFTER, out="again", newton=newton),
             tmp_path, np=np_)
    assert max(difference(left[last], read_dump(tmp_path / "again.dump")[last])) < 1e-7
