"""Forms of a run that LAMMPS knows beside the usual one: the same trajectories.

pair_style hybrid, run with pre no, a triclinic box, two dimensions.
"""

import numpy as np
import pytest

from deck_helpers import collapse_deck, dump_difference, read_dump, run_deck, write_collapse

BALLS, STEPS = 160, 300
ROUNDING = 1e-7


def hybrid(deck, kind="hybrid", more=""):
    return (deck.replace("pair_style gran/restitution", f"pair_style {kind} gran/restitution")
            .replace(" stiffness", " gran/restitution stiffness")
            .replace("timestep", f"{more}\ntimestep"))


def differences(tmp_path, deck, np_=1, data=None, balls=BALLS):
    """Of a deck, and of the one that it is a form of, in the end."""
    write_collapse(tmp_path, balls)
    run_deck(collapse_deck(f"run {STEPS}", every=STEPS, out="usual"), tmp_path)
    if data:
        file = tmp_path / "balls.data"
        file.write_text(data(file.read_text()))
    run_deck(deck, tmp_path, np=np_)
    usual, other = (read_dump(tmp_path / f"{name}.dump")[STEPS] for name in ("usual", "other"))
    assert abs(usual[:, 7:10]).max() > 0.1     # balls touch: they spin
    return dump_difference(usual, other)


def usual(run=f"run {STEPS}", **settings):
    return collapse_deck(run, every=STEPS, out="other", **settings)


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("kind, more", [
    ("hybrid", ""), ("hybrid/overlay", "pair_coeff * * zero")])
def test_pair_style_hybrid(tmp_path, kind, more, np_):
    deck = hybrid(usual(), kind, more)
    if more:
        deck = deck.replace("scheme exact", "scheme exact zero 1.0")
    assert max(differences(tmp_path, deck, np_)) < ROUNDING


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("scheme", ["exact"])
def test_run_with_pre_no(tmp_path, np_, scheme):
    write_collapse(tmp_path, BALLS)
    for out, run in (("whole", f"run {STEPS}"), ("cut", f"run {STEPS - 100}\nrun 60 pre no\nrun 40 pre no post no")):
        run_deck(collapse_deck(run, every=STEPS, out=out, scheme=scheme), tmp_path, np=np_)
    whole, cut = (read_dump(tmp_path / f"{name}.dump")[STEPS] for name in ("whole", "cut"))
    assert max(dump_difference(whole, cut)) < ROUNDING


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("tilt", ["0 0 0", "6 -4 3"])
def test_triclinic_box(tmp_path, tilt, np_):
    """Boundaries are far, so that its tilt only decides which rank has which balls."""
    def data(text):
        return text.replace("zlo zhi\n", f"zlo zhi\n{tilt} xy xz yz\n")
    assert max(differences(tmp_path, usual(), np_, data)) < ROUNDING


FLAT = """
units si
dimension {dimension}
atom_style sphere
atom_modify map array
boundary f f p
comm_modify vel yes
region box block 0 12 0 12 -0.5 0.5
create_box 2 box
neighbor 0.2 bin
neigh_modify delay 0
lattice {lattice} 1.05
region floor block 0 12 0 0.5 -0.5 0.5 units box
region heap block 3 9 0.6 9 -0.5 0.5 units box
create_atoms 2 region floor
create_atoms 1 region heap
set group all diameter 1 density 2500
group floor type 2
group heap type 1
pair_style gran/restitution scheme {scheme}
pair_coeff * * stiffness 1e7 1e7 restitution 0.4 friction 30 rolling 0.05
fix freeze floor freeze
fix move heap nve/sphere
{flat}
fix weight heap gravity 9.81 vector 0.1 -1 0
velocity heap ramp vx 0 2 x 3 9
timestep 1e-3
run {steps}
write_dump all custom {out} id x y z vx vy vz omegax omegay omegaz modify sort id format float %.17g
"""


@pytest.mark.parametrize("scheme", ["exact", "plain"])
def test_two_dimensions(tmp_path, scheme):
    """As the same balls in space: solid spheres whose centres stay in a plane."""
    found = []
    for dimension, lattice, flat in ((2, "sq", "fix flat all enforce2d"), (3, "sc", "")):
        out = f"{dimension}.dump"
        deck = FLAT.format(dimension=dimension, lattice=lattice, flat=flat, scheme=scheme, steps=600, out=out)
        if dimension == 3:     # the layer at z = 0 alone, and no images of it
            deck = deck.replace("block 0 12 0 12 -0.5 0.5", "block 0 12 0 12 -2 2").replace("f f p", "f f f")
        run_deck(deck, tmp_path)
        found.append(np.loadtxt(tmp_path / out, skiprows=9))
    assert found[0].shape == found[1].shape and len(found[0]) > 40
    assert abs(found[1][:, 9]).max() > 0.1
    assert abs(found[0] - found[1]).max() < ROUNDING
