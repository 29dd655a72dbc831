"""Balls of a lattice that touch without overlap, as rounding has it: ranks and balancing must not matter."""
import numpy as np
import pytest

from deck_helpers import run_deck, serial

HEAD = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
"""
LAW = "pair_style gran/restitution\npair_coeff * * stiffness 2e8 2e8 restitution {e} friction 30 rolling 0.05\n"
TAIL = """
{balance}
fix move soil nve/sphere
fix weight soil gravity 9.81 vector {slope} 0.15 -1
timestep 0.0005
run {steps}
write_dump soil custom {out}.dump id x y z fx fy fz modify sort id format float %.17g
"""
# a block on a mesh, whose lowest balls are one radius above it, or in a nest of fixed balls, and a ball beside it
BLOCK = """
region box block -5 20 -5 20 -3 15
create_box 3 box
# law
region body block 0.2 7.8 0.2 5.8 0.2 4.8 units box
lattice sc 1.0 origin 0.5 0.5 0.5
create_atoms 1 region body
create_atoms 1 single 1.5 2.1 7.1 units box
set type 1 diameter 1.0 density 2500
group soil type 1
region ground block -5 20 -5 20 -3 0 units box
"""
MESH = BLOCK + "fix floor soil wall/gran/mesh 2 floor.stl\n"
NEST = BLOCK + """
displace_atoms soil move 0 0 $(sqrt(0.5)-0.5) units box
fix floor soil wall/gran/balls 2 1.0 surface ground upper spacing 1.0
"""
# a body on a rough slope, as inputs/20 has it
HILL = """
region ground terrain hill.asc depth 20 headroom 20
region sphere sphere 40 15 25 16 units box
region around sphere 40 15 25 16 side out units box
region slip intersect 2 ground sphere
create_box 3 ground
# law
lattice sc 1.0
create_atoms 1 region slip
group soil type 1
set group soil diameter 1.0 density 2500
fix slip soil wall/gran/balls 2 1.0 surface slip lower spacing 0.5 sink 1.0
fix field soil wall/gran/balls 3 1.0 surface ground upper spacing 1.0 outside slip
delete_balls soil overlap 0.0
"""
FLOOR = """solid floor
facet normal 0 0 1
outer loop
vertex -5 -5 0
vertex 20 -5 0
vertex 20 20 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex -5 -5 0
vertex 20 20 0
vertex -5 20 0
endloop
endfacet
endsolid floor
"""


def write_hill(folder):
    x, y = np.arange(60), np.arange(30)[:, None]
    rough = 0.06 * np.random.default_rng(1).normal(size=(30, 60))
    height = np.maximum(0.8 * (x - 24), 0) + 0.01 * (y - 15.0)**2 + rough
    rows = "\n".join(" ".join(f"{value:.3f}" for value in row) for row in height)
    head = "ncols 60\nnrows 30\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n"
    (folder / "hill.asc").write_text(head + rows)


def end(folder, scene, e, slope, steps, *, ranks=1, balance=""):
    """Places and forces at the end, by ball in the order of the places."""
    out = f"{ranks}{bool(balance)}"
    box, rest = scene.split("# law\n")
    deck = HEAD + box + LAW.format(e=e) + rest + TAIL.format(balance=balance, slope=slope, steps=steps, out=out)
    run_deck(deck, folder, np=ranks, timeout=120)
    rows = np.loadtxt(folder / f"{out}.dump", skiprows=9)[:, 1:]
    return rows[np.lexsort(np.round(rows[:, :3], 5).T)]


@pytest.mark.skipif(serial(), reason="LMP is serial: built with BUILD_MPI=OFF")
@pytest.mark.parametrize("scene, e, slope, steps",
                         [(MESH, 0.5, 0.4, 300), (MESH, 0.9, 0.4, 300), (NEST, 0.1, 0.4, 300), (HILL, 0.5, 0, 600)],
                         ids=["mesh", "mesh_elastic", "nest", "hill"])
def test_ranks(tmp_path, scene, e, slope, steps):
    (tmp_path / "floor.stl").write_text(FLOOR)
    write_hill(tmp_path)
    one = end(tmp_path, scene, e, slope, steps)
    assert len(one) > 200 and np.abs(one[:, 3:]).max() > 1e3
    for ranks in (2, 4):
        other = end(tmp_path, scene, e, slope, steps, ranks=ranks,
                    balance="fix spread all balance 50 1.0 shift xyz 10 1.0")
        assert abs(other - one)[:, :3].max() < 1e-9
        assert abs(other - one)[:, 3:].max() < 1e-5 * np.abs(one[:, 3:]).max()
