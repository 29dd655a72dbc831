"""A site has no direction: turned in plan and mirrored, its body brings the same volumes, and does not drift aside.

Small sites of a few hundred balls; each packing of the body, with its ground, is a repeat. With the cubic lattice and
plan grids of fixed balls, as sites once had, the thin body drifts.
"""
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from run_helpers import EAST, NORTH, centres, write_tif
from test_site import inside, work_in
from tiny_collapse import LMP

from slope_tools.survey import rasters

pytestmark = [pytest.mark.long, pytest.mark.skipif(not os.environ.get("LMP"), reason="needs the LAMMPS program (LMP)")]

SIDE, CELL = 150.0, 1.0         # m, of the terrain
SLOPE = np.tan(np.radians(33))
TURNS = {"0": (0.0, 1), "22.5": (22.5, 1), "45": (45.0, 1), "mirrored": (22.5, -1)}
SEEDS = (1, 2, 3, 4, 5, 6)
ERRORS = 3.5                    # standard errors of a mean, as of tests/ground_direction.py
# once: a lattice, and plan grids below it
LATTICE = {"create_balls 1 ${d} ${density} fill body seed $(floor(v_packing))\n":
           "variable off equal v_packing/7\nlattice sc ${d} origin ${off} ${off} ${off}\ncreate_atoms 1 region body\n",
           "group       soil type 1\n": "group soil type 1\nset group soil diameter ${d} density 3411.4\n",
           "inside body &\n            pattern scattered ${which}\n": "inside body\n",
           "outside body &\n            pattern scattered ${which}\n": "outside body\n"}


def along(turn, x, y):
    """Distances down the slope from its toe and aside, of a turn (degrees, side)."""
    angle, side = np.radians(turn[0]), turn[1]
    u, v = x - SIDE / 2, side * (y - SIDE / 2)
    return u * np.cos(angle) + v * np.sin(angle), v * np.cos(angle) - u * np.sin(angle)


def site(folder, turn, depth, changed):
    """A folder with a site: a body 44 m long and 32 m wide on 33 degrees, then level.

    Both are smooth, so that the cells of the rasters, which do not turn, hardly show.
    """
    folder.mkdir()
    n = round(SIDE / CELL)
    u, v = along(turn, *centres(n, n, CELL))
    write_tif(folder / "dem.tif", (np.hypot(u, 6) - u) / 2 * SLOPE, CELL, EAST, NORTH)
    cap = 1 - ((u + 26) / 22) ** 2 - (v / 16) ** 2
    write_tif(folder / "depth.tif", np.maximum(cap, 0) * depth, CELL, EAST, NORTH)
    made = inside(folder, "site", "--terrain", "dem.tif", "--scar", "depth.tif", "--scar-is", "depth", "--balls", 300,
                  "-o", "mine")
    assert made.returncode == 0, made.stderr
    deck = folder / "mine" / "in.site"
    text = deck.read_text()
    for old, new in changed.items():
        assert old in text, old
        text = text.replace(old, new)
    deck.write_text(text)
    return folder / "mine"


def run(folder, turn, seed):
    """Volumes beyond the toe and 8 m farther, and the way aside of the deposit's middle (m3, m)."""
    words = {"packing": seed, "rolling": 0.05, "film": 900, "out": f"run{seed}"}
    subprocess.run([Path(LMP).absolute(), "-in", "in.site", "-log", f"{seed}.log", "-screen", "none",
                    *(str(word) for name in words for word in ("-var", name, words[name]))], cwd=folder, check=True,
                   env={**os.environ, "OMP_NUM_THREADS": "1"}, stdin=subprocess.DEVNULL)
    z = np.nan_to_num(rasters.read_asc_local(folder / f"run{seed}.thickness.asc").z)
    about = rasters.read_asc_local(folder / f"run{seed}.thickness.asc").transform
    x = about.c + about.a * (np.arange(z.shape[1]) + 0.5)
    y = about.f + about.e * (np.arange(z.shape[0]) + 0.5)
    u, v = along(turn, *np.meshgrid(x, y))
    volume = z * about.a ** 2
    return volume[u > 0].sum(), volume[u > 8].sum(), (volume * v).sum() / volume.sum()


def runs(folder, depth, turns, changed=()):
    """An array by turn, seed and quantity."""
    made = {name: site(folder / name, TURNS[name], depth, dict(changed)) for name in turns}
    with ThreadPoolExecutor(2) as pool:
        todo = {(name, seed): pool.submit(run, made[name], TURNS[name], seed) for name in turns for seed in SEEDS}
    return np.array([[todo[name, seed].result() for seed in SEEDS] for name in turns])


def off(found):
    """How many standard errors the means of the turns are off the mean of all, and the ways aside off 0."""
    means = found.mean(axis=1)
    errors = np.sqrt(found.var(axis=1, ddof=1).mean(axis=0) / len(SEEDS))
    middle = np.array([*means[:, :2].mean(axis=0), 0.0])
    return np.abs(means - middle) / errors


@pytest.mark.parametrize("depth", [8.0, 3.0])
def test_a_site_that_is_turned_or_mirrored(tmp_path, monkeypatch, depth):
    work_in(tmp_path, monkeypatch)
    found = runs(tmp_path, depth, TURNS)
    print(found.mean(axis=1), off(found))
    assert (found[:, :, 0] > 100).all() and (off(found) < ERRORS).all()


def test_the_grids_of_older_sites_have_a_direction(tmp_path, monkeypatch):
    work_in(tmp_path, monkeypatch)
    found = runs(tmp_path, 3.0, ("0", "22.5"), LATTICE.items())
    print(found.mean(axis=1), off(found))
    assert (off(found) > ERRORS).any()
