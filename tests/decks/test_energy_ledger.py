"""Fix energy/ledger: what impacts, sliding, rolling and a heap dissipate, by kind, and that the sum closes."""
import math

import pytest

from deck_helpers import run_deck

ITEMS = "kinetic gravity others stored dashpots sliding rolling begin_end residual".split()
HEAD = """
units        si
atom_style   sphere
boundary     f f f
comm_modify  vel yes
atom_modify  map array
"""
MASS = 2500 * math.pi / 6
TAIL = """
timestep     $(0.25*sqrt(2500*PI/6/1e7))
neighbor     0.3 bin
fix          ledger all energy/ledger
thermo_style custom step """ + " ".join(f"f_ledger[{k + 1}]" for k in range(len(ITEMS))) + """
thermo_modify format float %.15g
thermo       {every}
run          {steps}
"""

IMPACT = HEAD + """
region       box block -2 2 -2 62 -2 3
create_box   2 box
{pairs}
set          type * diameter 1 density 2500
group        ball type 1
group        held type 2
velocity     ball set 0 0 -1 units box
pair_style   gran/restitution
pair_coeff   * * stiffness 1e7 1e7 restitution {e} friction 0
fix          hold held freeze
fix          move ball nve/sphere
""" + TAIL.format(every=40, steps=40)

# on a ball of 2 km, so flat that a metre of way does not tell
WAY = HEAD + """
region       box block -1010 1010 -1010 1010 -2010 10
create_box   2 box
create_atoms 1 single 0 0 $(0.5-2500*PI/6*9.81/1e7)
create_atoms 2 single 0 0 -1000
set          type 1 diameter 1 density 2500
set          type 2 diameter 2000 density 2500
group        ball type 1
group        held type 2
velocity     ball set 2 0 0 units box
set          type 1 omega 0 {spin} 0
pair_style   gran/restitution
pair_coeff   * * stiffness 1e7 1e7 restitution 0.5 friction {friction} rolling {rolling}
fix          down ball gravity 9.81 vector 0 0 -1
fix          hold held freeze
fix          move ball nve/sphere
variable     way equal x[1]
""" + TAIL.format(every=100, steps=300).replace("f_ledger[1]", "v_way f_ledger[1]", 1)

HEAP = HEAD + """
newton       {newton}
region       box block -8 8 -8 8 -2 12
create_box   2 box
lattice      sc 1.02
region       mass block -2.1 2.1 -2.1 1.9 2 6.1
create_atoms 1 region mass
set          type * diameter 1 density 2500
set          type * omega 1 2 3
pair_style   gran/restitution
pair_coeff   * * stiffness 1e7 1e7 restitution 0.3 friction 30 rolling 0.05
fix          ground all wall/gran/balls 2 1 file floor.xyz
fix          down all gravity 9.81 vector 0 0 -1
fix          move all nve/sphere
""" + TAIL.format(every=500, steps=3000)


def ledger(log):
    """Rows of the items, as the thermo output has them."""
    lines = log.splitlines()
    start = next(k for k, line in enumerate(lines) if line.split()[:1] == ["Step"])
    names = ["step"] + (["way"] if "v_way" in lines[start] else []) + ITEMS
    end = next(k for k, line in enumerate(lines) if line.startswith("Loop time"))
    return [dict(zip(names, map(float, line.split()))) for line in lines[start + 1:end]
            if len(line.split()) == len(names)]


def closes(rows):
    dissipated = sum(abs(rows[-1][name]) for name in ("dashpots", "sliding", "rolling"))
    most = max(row["kinetic"] for row in rows)
    return max(abs(row["residual"]) for row in rows) < 1e-9 * (dissipated + most)


def pairs(offset, phases=20):
    """A ball above each of some frozen ones; they meet at different times within a step."""
    gaps = [0.003 + 0.25 * math.sqrt(MASS / 1e7) * k / phases for k in range(phases)]
    heights = [math.sqrt((1 + gap) ** 2 - offset ** 2) for gap in gaps]
    return "\n".join(f"create_atoms 1 single {offset} {3 * k} {height}\ncreate_atoms 2 single 0 {3 * k} 0"
                     for k, height in enumerate(heights))


@pytest.mark.parametrize("offset", [0, 0.5])
@pytest.mark.parametrize("e", [0.1, 0.5, 1])
def test_impact(tmp_path, e, offset):
    rows = ledger(run_deck(IMPACT.format(e=e, pairs=pairs(offset)), tmp_path))
    last, energy = rows[-1], 20 * MASS / 2
    assert closes(rows) and last["stored"] == 0
    assert max(abs(last[name]) for name in ("gravity", "others", "sliding", "rolling")) < 1e-9 * energy
    lost = energy - last["kinetic"]
    assert last["dashpots"] + last["begin_end"] == pytest.approx(lost, abs=1e-9 * energy)
    along = energy * (1 - offset ** 2)
    assert lost == pytest.approx((1 - e ** 2) * along, abs=0.006 * along)
    assert abs(last["begin_end"]) < 0.02 * (lost if e < 1 else along)


def test_sliding(tmp_path):
    """A ball that slides until it rolls has lost 2/7 of its energy to friction."""
    rows = ledger(run_deck(WAY.format(friction=5, rolling=0, spin=0), tmp_path))
    assert closes(rows)
    # the ledger begins in the middle of the second step
    before = math.tan(math.radians(5)) * MASS * 9.81 * 2 * 1.5 * 0.25 * math.sqrt(MASS / 1e7)
    assert rows[-1]["sliding"] == pytest.approx(2 / 7 * MASS / 2 * 2 ** 2 - before, rel=0.01)
    assert abs(rows[-1]["rolling"]) < 1e-3 * rows[-1]["sliding"]


def test_rolling(tmp_path):
    """The torque of the rolling resistance is its coefficient times weight times the rolling radius, 1 m here."""
    first, *_, last = rows = ledger(run_deck(WAY.format(friction=30, rolling=0.05, spin=4), tmp_path))
    assert closes(rows)
    assert last["rolling"] == pytest.approx(2 * 0.05 * MASS * 9.81 * (last["way"] - first["way"]), rel=0.02)
    assert abs(last["sliding"]) < 0.01 * last["rolling"]


@pytest.mark.parametrize("ranks, newton", [(1, "on"), (2, "on"), (2, "off")])
def test_heap(tmp_path, ranks, newton):
    """Balls fall into a bowl of fixed ones and come to rest: what they fell is in dashpots, friction and springs."""
    nodes = "".join(f"{x / 2} {y / 2} {(x * x + y * y) / 100}\n" for x in range(-14, 15) for y in range(-14, 15))
    (tmp_path / "floor.xyz").write_text(nodes)
    last = ledger(run_deck(HEAP.format(newton=newton), tmp_path, np=ranks))[-1]
    taken = last["dashpots"] + last["sliding"] + last["rolling"]
    assert abs(last["residual"]) < 1e-3 * taken and abs(last["others"]) < 1e-3 * taken
    assert abs(last["begin_end"]) < 0.02 * taken
    assert last["kinetic"] < 1e-3 * taken
    assert min(last[name] for name in ("gravity", "dashpots", "sliding", "rolling")) > 0.01 * taken


@pytest.mark.parametrize("old, new, error", [
    ("all energy/ledger", "ball energy/ledger", "Fix energy/ledger: the group must be all, got ball"),
    ("all energy/ledger", "all energy/ledger 10", "Fix energy/ledger takes no arguments, got 10"),
])
def test_wrong_input(tmp_path, old, new, error):
    run_deck(IMPACT.format(e=1, pairs=pairs(0)).replace(old, new), tmp_path, expect_error=error)
