"""region terrain: what lies below the ground surface, the bounding box, and bad input."""

import subprocess

import numpy as np
import pytest

from deck_helpers import ENVIRONMENT, LMP, doc_examples, run_deck, serial, write_asc

DECK = """
units si
atom_style sphere
boundary f f f
region ground terrain {file} {options}
create_box 1 ground
lattice sc 0.25
create_atoms 1 region {region} units box
print "box: $(xlo) $(ylo) $(zlo) $(xhi) $(yhi) $(zhi)"
write_dump all custom balls.dump x y z
"""


def deck(file="ground.asc", options="", region="ground", more=""):
    head, tail = DECK.split("create_box")
    return (head + more + "\ncreate_box" + tail).format(file=file, options=options, region=region)


def balls(tmp_path):
    return np.loadtxt(tmp_path / "balls.dump", skiprows=9, ndmin=2)


def plane(xlo, ylo, cell, nx=12, ny=8):
    x = xlo + (np.arange(nx) + 0.5) * cell
    y = ylo + (np.arange(ny) + 0.5) * cell

    def height(x, y):
        return 50.0 + 0.4137 * (x - xlo) - 0.3271 * (y - ylo)

    return height, height(x[None, :], y[:, None])


@pytest.mark.parametrize("np_", [1, 2])
def test_a_plane_is_a_plane_up_to_the_edge(tmp_path, np_):
    """On a sloping plane the region is exactly what lies below it, as far as the cells' edges."""
    xlo, ylo, cell = -1234.6, 678.27, 2.0
    height, values = plane(xlo, ylo, cell)
    write_asc(tmp_path / "ground.asc", values, xlo, ylo, cell)
    log = run_deck(deck(options="depth 3 headroom 4"), tmp_path, np=np_)

    lo, hi = values.min() - 3, values.max() + 4
    box = [line for line in log.splitlines() if line.startswith("box:")][0]
    assert [float(word) for word in box.split()[1:]] == pytest.approx(
        [xlo, ylo, lo, xlo + 24, ylo + 16, hi])

    # the lattice's points in the region, counted by hand
    x, y, z = balls(tmp_path).T
    assert (z <= height(x, y) + 1e-9).all() and (z >= lo).all()
    points = [np.arange(np.ceil(low / 0.25), np.floor(high / 0.25) + 1) * 0.25
              for low, high in [(xlo, xlo + 24), (ylo, ylo + 16), (lo, hi)]]
    px, py, pz = np.meshgrid(*points, indexing="ij")
    assert len(x) == ((pz <= height(px, py)) & (pz >= lo)).sum()


def test_default_depth_and_headroom(tmp_path):
    write_asc(tmp_path / "ground.asc", np.full((3, 3), 7.0), cell=2.0)
    log = run_deck(deck(), tmp_path)
    assert "\nbox: 0 0 -3 6 6 17\n" in log
    assert "3 x 3 cells of 2, x 0 to 6, y 0 to 6, heights 7 to 7, 0 cells without data" in log


def test_nodata_columns_have_no_inside(tmp_path):
    values = np.full((8, 8), 2.0)
    values[4, 4] = np.nan  # centre 4.5 4.5
    write_asc(tmp_path / "ground.asc", values)
    run_deck(deck(), tmp_path)
    x, y, z = balls(tmp_path).T
    hole = (abs(x - 4.5) < 1) & (abs(y - 4.5) < 1)
    assert len(x) > 1000 and not hole.any()
    assert ((abs(x - 4.5) <= 1.3) & (abs(y - 4.5) <= 1.3)).any()


def test_with_other_regions(tmp_path):
    """intersect, side out and move work as on any region."""
    write_asc(tmp_path / "ground.asc", np.full((10, 10), 5.0))
    more = """
region slip sphere 5 5 8 5 units box
region out terrain ground.asc side out
variable up equal 1.0
variable zero equal 0.0
region raised terrain ground.asc move v_zero v_zero v_up
region mass intersect 2 ground slip
region air intersect 2 out slip
region lifted intersect 2 raised slip
"""
    for region, inside in [("mass", lambda z: z <= 5), ("air", lambda z: z > 5),
                           ("lifted", lambda z: z <= 6)]:
        run_deck(deck(options="headroom 9", region=region, more=more), tmp_path)
        x, y, z = balls(tmp_path).T
        assert len(z) > 20 and inside(z).all(), region
        assert ((x - 5) ** 2 + (y - 5) ** 2 + (z - 8) ** 2 <= 25 + 1e-9).all()
    assert z.max() > 5


def test_no_smooth_wall(tmp_path):
    write_asc(tmp_path / "ground.asc", np.full((4, 4), 5.0))
    text = deck() + """
pair_style none
comm_modify cutoff 1
fix nve all nve/sphere
fix w all wall/gran/region hooke/history 1e5 NULL 10 NULL 0.5 1 region ground
run 1
"""
    run_deck(text, tmp_path, expect_error="Region terrain ground makes no wall: take fix wall/gran/balls "
             "or fix wall/gran/mesh")


GOOD = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"


@pytest.mark.parametrize("content, message", [
    (None, "Region terrain: cannot read bad.asc: No such file or directory"),
    (GOOD + "1 2\n3 x{y\n", "Region terrain: bad.asc, line 7: height must be a number, got x{y"),
])
def test_bad_files(tmp_path, content, message):
    """A bad file ends the run on all ranks with one line, and does not hang; one rank: test_wrong_input.py."""
    if content is not None:
        (tmp_path / "bad.asc").write_text(content)
    run_deck(deck(file="bad.asc"), tmp_path, np=2, expect_error=message, timeout=60)


def test_doc_examples(tmp_path):
    write_asc(tmp_path / "terrain.asc", np.full((30, 40), 200.0), cell=10.0)
    run_deck("units si\natom_style sphere\nboundary f f f\n" + doc_examples("region_terrain") + """
lattice sc 5
create_atoms 1 region mass
create_atoms 2 region stays
""", tmp_path)


# --- memory that ranks share ---

SMALL_SHM = ["unshare", "-m", "sh", "-c", 'mount -t tmpfs -o size=16m tmpfs /dev/shm && exec "$@"', "sh"]


@pytest.mark.skipif(serial(), reason="LMP is serial")
@pytest.mark.skipif(subprocess.run([*SMALL_SHM, "true"], capture_output=True).returncode != 0,
                    reason="/dev/shm cannot be made small here")
@pytest.mark.parametrize("used, said", [
    ("region ground terrain ground.asc depth 2 headroom 1\nlattice sc 100.0 origin 0 0 0.07\n"
     "create_atoms 1 region ground", "Created 225 atoms"),
    ("fix ground all wall/gran/mesh 1 terrain ground.asc", "smooth ground, 1500 x 1500 cells")])
def test_a_container_with_little_shared_memory(tmp_path, used, said):
    """A raster of 18 MB where ranks share 16 MB: each has its own, instead of a run that hangs or dies."""
    n = 1500
    row = " ".join(["7.5"] * n) + "\n"
    header = f"ncols {n}\nnrows {n}\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n"
    (tmp_path / "ground.asc").write_text(header + row * n)
    (tmp_path / "in.deck").write_text(
        f"units si\natom_style sphere\nregion box block 0 {n} 0 {n} 0 9\ncreate_box 1 box\n{used}\n")
    command = ["mpirun", "--oversubscribe", "-np", "2", LMP, "-in", "in.deck", "-log", "none"]
    run = subprocess.run([*SMALL_SHM, *command], cwd=tmp_path, env=ENVIRONMENT, capture_output=True, text=True,
                         timeout=60)
    assert run.returncode == 0, run.stdout + run.stderr
    assert said in run.stdout
