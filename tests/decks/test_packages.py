"""Suffixes, bonds, compute fabric: some need packages of LAMMPS that the default build does not have (tests/matrix.sh
--only packages)."""

import os
import re
from datetime import datetime

import deck_helpers
import numpy
import pytest
from deck_helpers import collapse_deck, lammps_help, read_dump, run_deck, write_collapse


def needs(package):
    """Skip where LMP is built without a package of LAMMPS."""
    installed = lammps_help().split("Installed packages:")[1].split("* ")[0].split()
    if package not in installed:
        pytest.skip(f"LMP is built without package {package}")


# --- suffixes ---

OMP = "package omp 1\nsuffix omp\n"
FLOOR = """
units        si
atom_style   sphere
boundary     f f f
comm_modify  vel yes
region       box block 0 10 0 10 -2 10
create_box   2 box
create_atoms 1 single 5.2 5.1 2
create_atoms 2 single 5 5 0
set          type * diameter 1.0 density 2500
group        ball type 1
group        floor type 2
pair_style   gran/restitution
pair_coeff   * * stiffness 1e7 1e7 restitution 0.5 friction 30
neighbor     0.3 bin
neigh_modify every 1 delay 0 check yes
timestep     2e-3
fix          move ball nve/sphere
fix          weight ball gravity 9.80665 vector 0 0 -1
fix          stay floor freeze
info         out log fixes
dump         all all custom 100 out.dump id x y z vx vy vz omegax omegay omegaz
dump_modify  all sort id format float %.17g
run          500
"""


@pytest.mark.parametrize("suffix", ["kk", "kk/device", "kk/host", "omp", "gpu", "intel", "opt"])
def test_every_suffix_is_known(tmp_path, monkeypatch, suffix):
    """By the pair (frozen balls), by the guards (what moves balls and does work); to the bit, by the same fixes."""
    if "LMP_SUFFIXES" not in os.environ:
        pytest.skip("LMP_SUFFIXES is not set: the test program of a build with the styles in it")
    monkeypatch.setattr(deck_helpers, "LMP", os.environ["LMP_SUFFIXES"])
    found = []
    for name, first in (("plain", ""), ("suffix", f"suffix {suffix}\n")):
        folder = tmp_path / name
        folder.mkdir()
        log = run_deck(first + FLOOR, folder)
        found.append(read_dump(folder / "out.dump")[500])
        assert "WARNING: Pair gran/restitution" not in log
        for style in ("freeze", "gravity", "nve/sphere"):
            assert f"style = {style}{'/' + suffix if first else ''}," in log, style
    assert numpy.array_equal(*found) and numpy.abs(found[0][:, 4:]).max() > 0.1


def test_suffix_omp_is_the_run_without(tmp_path):
    """Energy of the balls in the field of fix gravity/omp is counted, or the guard would cry; and all is the same."""
    needs("OPENMP")
    found = {}
    for name, first in (("plain", ""), ("omp", OMP)):
        folder = tmp_path / name
        folder.mkdir()
        log = run_deck(first + FLOOR, folder)
        found[name] = read_dump(folder / "out.dump")
        assert "WARNING: Pair gran/restitution" not in log
    for style in ("nve/sphere/omp", "gravity/omp"):
        assert re.search(rf"style = {style},", log), style
    assert found["plain"].keys() == found["omp"].keys() and len(found["omp"]) == 6
    for step, balls in found["plain"].items():
        assert numpy.allclose(found["omp"][step], balls, rtol=1e-12, atol=1e-12), step
    assert numpy.abs(found["omp"][500] - found["omp"][0]).max() > 0.5      # it has fallen, and touched the other


def test_energy_that_grows_is_seen_with_suffix_omp(tmp_path):
    """The guard is not off there."""
    needs("OPENMP")
    late = FLOOR.replace("restitution 0.5 friction 30", "restitution 1.0 friction 0").replace(
        "neighbor     0.3 bin\nneigh_modify every 1 delay 0 check yes", "neighbor 0.0 bin\n"
        "neigh_modify every 8 delay 8 check no").replace("single 5.2 5.1 2", "single 5.0 5.0 4")
    log = run_deck(OMP + late.replace("run          500", "timestep 1.5e-3\nrun 3000"), tmp_path)
    assert "the energy of the balls grew by" in log


def test_a_collapse_with_suffix_omp(tmp_path):
    """Walls, two ranks; sums are made in another order."""
    needs("OPENMP")
    dumps = []
    for name, first in (("plain", ""), ("omp", OMP)):
        folder = tmp_path / name
        folder.mkdir()
        write_collapse(folder, balls=200)
        run_deck(first + collapse_deck("run 200", every=200), folder, np=2)
        dumps.append(read_dump(folder / "out.dump")[200])
    assert numpy.allclose(*dumps, rtol=1e-9, atol=1e-9)


# --- bonds ---

BONDS = """
units        si
atom_style   hybrid sphere bond
boundary     f f f
comm_modify  vel yes cutoff 3.0
special_bonds {special}
region       box block -5 5 -5 5 -5 5
create_box   1 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
create_atoms 1 single 0 0 0
create_atoms 1 single 0.999 0 0
set          type 1 diameter 1.0 density 2500
bond_style   zero
bond_coeff   1
create_bonds single/bond 1 1 2
pair_style   gran/restitution
pair_coeff   1 1 stiffness 1e6 1e6 restitution 0.5
neighbor     0.3 bin
neigh_modify every 1 delay 0 check yes
timestep     1e-3
fix          move all nve/sphere
thermo_style custom step fmax
thermo_modify format float %.10g
run          0
"""


def test_bonded_balls_touch(tmp_path):
    needs("MOLECULE")
    log = run_deck(BONDS.format(special="lj/coul 1 1 1"), tmp_path)
    assert float(re.search(r"^ +0 +(\S+)\s*$", log, re.MULTILINE)[1]) == pytest.approx(1000.0, rel=1e-6)


def test_bonded_balls_do_not_touch_where_lammps_can_leave_them_out(tmp_path):
    """LAMMPS before 23Jun2022 would make them touch: the run ends."""
    needs("MOLECULE")
    date = re.search(r"\d+ \w{3} \d{4}", lammps_help())[0]
    if datetime.strptime(date, "%d %b %Y") < datetime(2022, 6, 23):
        run_deck(BONDS.format(special="lj/coul 0 1 1"), tmp_path,
                 expect_error="special_bonds must be lj/coul 1 1 1 where balls have bonds")
        return
    log = run_deck(BONDS.format(special="lj/coul 0 1 1"), tmp_path)
    assert float(re.search(r"^ +0 +(\S+)\s*$", log, re.MULTILINE)[1]) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("special, values", [("lj/coul 0.5 1 1", "lj 0.5 1 1 coul 0.5 1 1"),
                                             ("lj 0 1 1 coul 1 1 1", "lj 0 1 1 coul 1 1 1")])
def test_parts_of_contacts_are_refused(tmp_path, special, values):
    needs("MOLECULE")
    run_deck(BONDS.format(special=special), tmp_path,
             expect_error="Pair gran/restitution: special_bonds must be 0 or 1, "
             f"the same for lj and coul, as balls that are bonded touch fully or not at all, got {values}")


def test_special_bonds_without_bonds_do_not_matter(tmp_path):
    run_deck("special_bonds lj/coul 0.5 1 1\n" + FLOOR, tmp_path)


# --- compute fabric ---

def fabric(n, weight):
    """15/6 of the deviator of the mean of weight n n, over a third of its trace; n: normals of the contacts."""
    sum_of = numpy.einsum("k,ki,kj->ij", weight, n, n) / len(n)
    third = numpy.trace(sum_of) / 3
    tensor = 15 / 6 * (sum_of / third - numpy.eye(3))
    return [tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


@pytest.mark.parametrize("np_", [1, 2])
def test_compute_fabric(tmp_path, np_):
    """Of the contacts between balls that compute pair/local has; the normal forces are weighed by the first tensor."""
    needs("GRANULAR")
    write_collapse(tmp_path, balls=200)
    more = """
compute now all fabric radius contact force/normal
compute pairs all pair/local dist force fx fy fz
dump pairs all local 200 pairs.dump c_pairs[*]
dump_modify pairs format float %.12g
thermo_style custom step c_now[*]
thermo_modify format float %.12g lost ignore
run 200"""
    log = run_deck(collapse_deck(more), tmp_path, np=np_)
    got = [float(word) for word in re.search(r"^ +200 +([-\d. e+]*)$", log, re.MULTILINE)[1].split()]
    frame = (tmp_path / "pairs.dump").read_text().split("ITEM: ENTRIES")[2]
    rows = numpy.array([row.split() for row in frame.splitlines()[1:]], float)
    rows = rows[rows[:, 1] != 0.0]
    assert len(rows) > 10 and (rows[:, 0] < 1.0).all()
    force, n = rows[:, 1], rows[:, 2:] / rows[:, 1:2]
    first = fabric(n, numpy.ones(len(n)))
    assert got[:6] == pytest.approx(first, abs=1e-8)
    a = numpy.array([[first[0], first[3], first[4]], [first[3], first[1], first[5]], [first[4], first[5], first[2]]])
    assert got[6:] == pytest.approx(fabric(n, force / (1 + numpy.einsum("ki,ij,kj->k", n, a, n))), abs=1e-6)
