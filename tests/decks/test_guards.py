"""Guards in a run: what is not sensible is told once, with a number, and stands in the summary of fix deposit/grid."""
import re

import pytest
import yaml

from deck_helpers import run_deck

# one ball falls on a floor of fixed balls, in a box of 10 m
DECK = """
units       si
atom_style  sphere
boundary    f f f
comm_modify vel yes
region      box block 0 10 0 10 -2 10
create_box  2 box
create_atoms 1 single 5.2 5.1 {z}
{atoms}
set         type 1 diameter 1.0 density 2500
group       ball type 1
region      ground terrain flat.asc depth 2 headroom 8
pair_style  {pair} {style}
pair_coeff  {types} stiffness {k} {k} restitution {e} friction 30
{floor}
neighbor    {skin} bin
neigh_modify every 1 delay 0 check yes
{neigh}
timestep    {dt}
{move}
{weight}
fix         deposit ball deposit/grid 10 0 cell 1 terrain ground output out
{extra}
thermo      1000
thermo_modify lost ignore
run         {steps}
"""
MOVE = "fix move ball nve/sphere"
WEIGHT = "fix weight ball gravity 9.80665 vector 0 0 -1"
WALL = "fix floor ball wall/gran/balls 2 1.0 surface ground upper spacing 0.5"


def run(tmp_path, text=DECK, expect_error=None, np=1, **settings):
    (tmp_path / "flat.asc").write_text("ncols 10\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + "0 " * 99 + "0\n")
    deck = {"z": 2.0, "atoms": "", "pair": "gran/restitution", "style": "", "types": "* *", "e": 0.5, "k": 1e7,
            "floor": WALL, "move": MOVE, "weight": WEIGHT, "skin": 0.3, "neigh": "", "dt": 2e-3, "extra": "",
            "steps": 1000, **settings}
    log = run_deck(text.format(**deck), tmp_path, np=np, expect_error=expect_error)
    if expect_error is not None:
        return log, None
    return warnings_of(log), yaml.safe_load((tmp_path / "out.summary.yaml").read_text())


def warnings_of(log):
    """Ours: newer LAMMPS also tells that there are no fixes with time integration."""
    return [re.sub(r" \(\S+:\d+\)$", "", line.removeprefix("WARNING: ")) for line in log.splitlines()
            if line.startswith("WARNING: ") and "No fixes with time" not in line]


@pytest.mark.parametrize("np", [1, 2])
def test_a_sound_run_has_nothing_to_tell(tmp_path, np):
    warnings, summary = run(tmp_path, np=np)
    assert warnings == [] and summary["warnings"] == []
    assert 0.0 < summary["guards"]["largest_overlap"] < 0.1
    assert summary["guards"]["energy_growth"] < 1e-3 and summary["guards"]["dangerous_builds"] == 0


def test_growing_energy(tmp_path):
    """Contacts that are found late begin deep, and give back what nobody put in."""
    warnings, summary = run(tmp_path, e=1.0, z=4.0, skin=0.0, neigh="neigh_modify every 8 delay 8 check no", dt=1.5e-3,
                            steps=3000)
    told, = (w for w in warnings if "the energy of the balls grew by" in w)
    assert float(re.search(r"grew by (\S+) % of the largest .* until step \d+", told)[1]) > 10
    assert summary["guards"]["energy_growth"] > 0.1
    assert told in summary["warnings"]
    grown, every = map(int, re.search(r"grown at (\d+) of the checks every (\d+) steps", " ".join(warnings)).groups())
    assert every == 200 and 1 < grown <= 3000 // every + 1      # a check costs less than 1 % of the steps in between


def test_time_step_and_overlap(tmp_path):
    warnings, summary = run(tmp_path, k=5e4, dt=0.09, z=1.0, steps=200)
    step, deep = (next(w for w in warnings if text in w) for text in ("time step 0.09 s is", "deeper than 10 %"))
    assert {step, deep} <= set(summary["warnings"])
    most = float(re.search(r"the deepest (\S+) %", deep)[1])
    assert summary["guards"]["largest_overlap"] == pytest.approx(most / 100, rel=0.01)
    assert summary["guards"]["deep_contacts"] == int(re.search(r": (\d+) contacts", deep)[1])


def test_dangerous_builds(tmp_path):
    warnings, summary = run(tmp_path, z=9.0, skin=0.001, steps=800)
    told, = (w for w in warnings if "(dangerous builds)" in w)
    assert int(re.search(r": (\d+) neighbor lists came late", told)[1]) == summary["guards"]["dangerous_builds"] > 0
    assert told in summary["warnings"]


LIFTED = "\ndisplace_atoms ball move 0 0 3\nvelocity ball set 0 0 0"


@pytest.mark.parametrize("settings", [
    {"k": 5e4, "z": 4.0, "skin": 0.001, "steps": 500},
    {"e": 1.0, "z": 4.0, "skin": 0.0, "neigh": "neigh_modify every 8 delay 8 check no", "dt": 1.5e-3, "steps": 800}])
@pytest.mark.parametrize("again", ["", "\nrun 2\nwrite_restart side\nrun 2 pre no"])
def test_findings_of_all_runs(tmp_path, settings, again):
    """A run that finds something, then some that find nothing."""
    _, first = run(tmp_path, **settings)
    wanted = first["guards"]
    assert wanted["energy_growth"] > 0.1 or wanted["deep_contacts"] > 1 and wanted["dangerous_builds"] > 1
    _, all_runs = run(tmp_path, **{**settings, "extra": f"run {settings['steps']}{LIFTED}{again}", "steps": 3})
    assert all_runs["guards"] == wanted


def test_findings_before_a_restart(tmp_path):
    """The summary of a run that goes on is that of the uncut one."""
    settings = {"k": 5e4, "z": 4.0, "skin": 0.001}
    _, uncut = run(tmp_path, DECK + "write_restart cut.restart\nrun 3\n", steps=500, **settings)
    assert uncut["guards"]["deep_contacts"] > 1 and len(uncut["warnings"]) > 1
    begin, end = DECK.index("region      box"), DECK.index("region      ground")
    again = DECK[:begin] + "read_restart cut.restart\n" + DECK[end:]
    _, found = run(tmp_path, again, steps=3, **settings)
    assert found["guards"] == uncut["guards"] and found["warnings"] == uncut["warnings"]


FIXED = "create_atoms 2 single 5 5 0\nset type 2 diameter 1.0 density 2500"


@pytest.mark.parametrize("frozen", [False, True])
@pytest.mark.parametrize("guide", ["move linear 0 0 0", "setforce 0 0 0", "nve/noforce"])
def test_guided_balls(tmp_path, guide, frozen):
    """A ball on a path of its own is as good as infinitely heavy, which the law does not know."""
    extra = f"group stay type 2\nfix path stay {guide}\n" + ("fix stay stay freeze" if frozen else "")
    if guide.startswith("setforce"):
        extra += "\nfix free stay nve/sphere"
    warnings, summary = run(tmp_path, atoms=FIXED, floor="", extra=extra, steps=10)
    told = [w for w in warnings if f"1 balls are guided by fix {guide.split()[0]} " in w]
    assert len(told) == (not frozen)
    assert all(w in summary["warnings"] for w in told)


@pytest.mark.parametrize("frozen", [False, True])
def test_missing_freeze(tmp_path, frozen):
    extra = "group stay type 2\nfix stay stay freeze" if frozen else ""
    warnings, summary = run(tmp_path, atoms=FIXED, floor="", extra=extra, steps=10)
    told = [w for w in warnings if "no integrator moves 1 balls and no fix freeze holds them" in w]
    assert len(told) == (0 if frozen else 1)
    assert summary["warnings"] == told


# --- what moves balls turns them, and what rests is held ---

@pytest.mark.parametrize("style", ["nve", "nve/limit 0.1", "nvt temp 1 1 1"])
def test_spins_that_nothing_integrates(tmp_path, style):
    """Friction holds such a ball on any slope: with fix nve one on a plane of 20 degrees had 1e-17 for 2.4 m/s2."""
    message = f"must integrate their spins, got fix move {style.split()[0]},"
    run(tmp_path, expect_error=message, move=f"fix move ball {style}")


def test_spins_of_balls_that_are_not_there_yet(tmp_path):
    run(tmp_path, expect_error="got fix move nve,", move="fix move none nve", atoms="group none empty")


def test_balls_that_move_or_are_frozen_as_they_should(tmp_path):
    """fix nve of frozen balls moves none."""
    extra = """
group stay type 2
fix stay stay freeze
fix nothing stay nve
group low dynamic ball every 1 var is_low
fix weight2 low gravity 1 vector 0 0 -1
"""
    warnings, _ = run(tmp_path, atoms=FIXED + "\nvariable is_low atom z<1", floor="", extra=extra, steps=10)
    assert warnings == []


def test_a_ball_that_two_fixes_move(tmp_path):
    run(tmp_path, expect_error="each ball must be moved by one fix, got 1 balls with more, of move nve/sphere, "
                               "again nve/sphere", move=MOVE + "\nfix again all nve/sphere")


POUR = ("group new empty\nregion above block 2 8 2 8 4 6\n"
        "fix pour new pour 3 1 5 vol 0.1 100 region above diam one 1.0 dens 2500 2500")
NOTHING_MOVES = "no integrator moves {} balls and no fix freeze holds them"


@pytest.mark.parametrize("np", [1, 2])
def test_a_ball_that_nothing_moves(tmp_path, np):
    warnings, summary = run(tmp_path, np=np, move="", steps=10)
    assert len(warnings) == 1 and NOTHING_MOVES.format(1) in warnings[0] and summary["warnings"] == warnings


def test_where_nothing_should_move(tmp_path):
    """run 0, with a force to look at, and rerun."""
    extra = "dump d all custom 1 run.dump id type x y z vx vy vz\nrun 0\nrun 0"
    warnings, _ = run(tmp_path, move="", extra=extra, steps=0)
    assert warnings == []
    assert (tmp_path / "run.dump").exists()
    again = "unfix deposit\nrerun run.dump dump x y z vx vy vz"
    warnings, _ = run(tmp_path, move="", extra=again, steps=0)
    assert warnings == []


def test_balls_that_come_and_that_nothing_moves(tmp_path):
    warnings, summary = run(tmp_path, extra=POUR, steps=600)
    assert [NOTHING_MOVES.format(3) in w for w in warnings if "integrator" in w] == [True]
    assert set(warnings) == set(summary["warnings"])


@pytest.mark.parametrize("other", ["", "create_atoms 1 single 8 8 5"])
def test_a_ball_that_nothing_pulls(tmp_path, other):
    """Without gravity on any ball, and where its group has one of two."""
    weight = "group pulled id 1\nfix weight pulled gravity 9.80665 vector 0 0 -1" if other else ""
    warnings, summary = run(tmp_path, weight=weight, atoms=other, steps=400)
    told, = warnings
    assert "1 balls hang at rest" in told and told in summary["warnings"]


@pytest.mark.parametrize("weight, up", [
    ("9.81 vector 0 0 1", "9.81"), ("-9.81 vector 0 0 -1", "9.81"), ("10 spherical 0 0", "10"),
    ("v_up vector 0 0 -1", "2.5"), ("5 vector 0 0 -1\nfix more ball gravity 7 vector 0 0 1", "2")])
def test_gravity_upwards(tmp_path, weight, up):
    warnings, summary = run(tmp_path, weight=f"variable up equal -2.5\nfix weight ball gravity {weight}", steps=10)
    told, = warnings
    assert f"z of the gravity should be <= 0, got {up}, which pulls 1 balls upwards" in told
    assert told in summary["warnings"]


@pytest.mark.parametrize("weight", ["9.81 chute 25", "5 vector 1 0 0",
                                    "7 vector 0 0 -1\nfix more all gravity 5 vector 0 0 1"])
def test_gravity_that_is_not(tmp_path, weight):
    warnings, _ = run(tmp_path, weight=f"fix weight ball gravity {weight}", steps=10)
    assert warnings == []


@pytest.mark.parametrize("spin, told", [(1e9, True), (501.0, True), (499.0, False)])
def test_spins_that_no_step_follows(tmp_path, spin, told):
    """1 rad in a step of 2 ms is 500 rad/s."""
    warnings, summary = run(tmp_path, extra=f"set type 1 omega 0 0 {spin}", steps=10)
    assert [("at most 500 rad/s" in w and "got 1 balls" in w) for w in warnings] == [True] * told
    assert summary["warnings"] == warnings


@pytest.mark.parametrize("dt, got", [("0", "0"), ("-1e-4", "-0.0001"), ("1e999", "inf")])
def test_time_that_does_not_go_on(tmp_path, dt, got):
    log, _ = run(tmp_path, expect_error="", dt=dt)
    assert f"needs timestep > 0, got {got}" in log or "number 1e999" in log    # newer LAMMPS refuses it before


def test_forces_that_are_scaled(tmp_path):
    run(tmp_path, expect_error="pair_style must be hybrid or hybrid/overlay with others, got hybrid/scaled",
        pair="hybrid/scaled 0.5 gran/restitution 0.5 zero 2.0", types="* * gran/restitution",
        neigh="pair_coeff * * zero")


def test_force_that_is_no_number(tmp_path):
    run(tmp_path, expect_error="velocity or force that is not finite at step 50", steps=100,
        extra="variable huge equal 1e308*(step==50)\nfix push ball addforce v_huge v_huge 0\n"
              "fix push2 ball addforce v_huge 0 0")


def test_a_ball_that_leaves(tmp_path):
    warnings, summary = run(tmp_path, floor="", steps=1000)
    told, = (w for w in warnings if "ball 1 left the box at 5.2 5.1" in w)
    assert told in summary["warnings"] and summary["balls"]["lost"] == 1
    assert summary["volume"]["lost"] == pytest.approx(summary["volume"]["released"])


# --- what changes between two looks ---

BELOW = "fix floor ball wall/gran/balls 2 1.0 file below.xyz"      # one fixed ball below the first one


@pytest.mark.parametrize("np", [1, 2])
def test_rerun_has_nothing_to_tell(tmp_path, np):
    """A ball that rests 8 % of its radius deep, and comes from above: no snapshot follows from the one before."""
    (tmp_path / "below.xyz").write_text("5.2 5.1 0\n")
    soft = {"floor": BELOW, "k": 3.2e5, "z": 1.2, "e": 0.3, "np": np}
    again = "unfix deposit\nrerun run.dump dump x y z vx vy vz"
    dumped = "dump d ball custom 200 run.dump id type x y z vx vy vz\nthermo_style custom step f_floor[3]"
    warnings, summary = run(tmp_path, extra=dumped, **soft)
    assert 0.05 < summary["guards"]["largest_overlap"] and warnings == summary["warnings"]
    assert run(tmp_path, extra=dumped, steps=f"1000\nundump d\n{again}", **soft)[0] == warnings
    assert run(tmp_path, DECK.replace("run         {steps}", again), extra="thermo_style custom step f_floor[3]",
               **soft)[0] == []


GROWS = "variable d equal ramp(1.0,{})\nfix grow ball adapt 1 atom diameter v_d"


@pytest.mark.parametrize("atoms, z, most, neigh, told", [
    ("", 1.2, 1.6, "", ["at most half the skin, 0.1, while there is one neighbor list, got 0.15"]),
    ("", 1.2, 1.6, "neigh_modify check no", []),
    ("", 1.2, 1.19, "", []),
    ("create_atoms 1 single 6.7 5.1 {z}", 5, 1.6, "neigh_modify check no",
     ["at most half the skin, 0.1, farther than the largest at the start of the run, got 0.3"]),
    ("create_atoms 1 single 8.7 5.1 {z}", 5, 1.09, "", [])])
def test_balls_that_grow(tmp_path, atoms, z, most, neigh, told):
    """Neither lists nor their reach follow: balls grew through each other, and through the ground."""
    (tmp_path / "below.xyz").write_text("5.2 5.1 0\n")
    warnings, summary = run(tmp_path, DECK.replace("sphere", "sphere 1", 1), atoms=atoms.format(z=z), z=z, floor=BELOW,
                            neigh=neigh, extra=GROWS.format(most), weight="", skin=0.2, steps=400)
    found = [w for w in warnings if "half the skin" in w]
    assert len(found) == len(told) and all(text in w for w, text in zip(found, told))
    assert set(warnings) == set(summary["warnings"])


def test_what_grew_in_an_earlier_run_does_not_count(tmp_path):
    """Nor is a ball that is made larger between two runs one that grows: the lists of the second are its own."""
    again = f"run 100\nunfix grow\nset atom 1 diameter 1.5\n{POUR}\nrun 100"
    warnings, _ = run(tmp_path, DECK.replace("sphere", "sphere 1", 1).replace("run         {steps}", again), z=5,
                      floor="", extra=GROWS.format(1.01), skin=0.2)
    assert not any("half the skin" in w for w in warnings)


@pytest.mark.parametrize("np", [1, 2])
@pytest.mark.parametrize("before", [True, False])
def test_frozen_balls_with_a_force(tmp_path, np, before):
    """A freeze takes away the forces of the fixes before it: the frozen ground fell."""
    fix = "fix weight2 all gravity 9.81 vector 0 0 -1"
    freeze = "group stay type 2\nfix stay stay freeze\nfix moved stay nve/sphere"
    warnings, summary = run(tmp_path, atoms=FIXED, floor="", weight="", steps=10, np=np,
                            extra="\n".join([freeze, fix] if before else [fix, freeze]))
    message = "balls of fix freeze must have no force, got 1 "
    told = [w for w in warnings if message in w and w.endswith("fix weight2 gravity")]
    assert len(told) == before and summary["warnings"] == told


@pytest.mark.parametrize("where, message", [
    ("{pair}\n{fix}", None),
    ("{fix}\n{pair}", "Pair gran/restitution: fix evap evaporate must be defined after pair_style, got it before"),
])
def test_balls_that_are_taken_away(tmp_path, where, message):
    """Their contacts went to the balls that took their indices."""
    pair = "pair_style  {pair} {style}"
    text = DECK.replace(pair, where.format(pair=pair, fix="fix evap ball evaporate 1000 1 ground 1"))
    run(tmp_path, text, steps=20, expect_error=message)


@pytest.mark.parametrize("width, other, message", [
    (2.0, "create_atoms 1 single 1.5 5.1 5", "a periodic box must be wider than 2, got 2 along x"),
    (2.0, POUR.replace("2 8", "0 2", 1), "a periodic box must be wider than 2, got 2 along x"),
    (2.02, "create_atoms 1 single 1.51 5.1 5", None),
    (2.0, "", None)])
def test_two_balls_that_would_touch_at_both_sides(tmp_path, width, other, message):
    """LAMMPS finds the history of a contact by the ID of the other ball: both contacts had one."""
    text = DECK.replace("f f f", "p f f").replace("5.2 5.1", "0.5 5.1")
    where = "extra" if "pour" in other else "atoms"       # balls that are to come touch at both sides, too
    run(tmp_path, text.replace("0 10 0 10 -2 10", f"0 {width} 0 10 -2 10"), z=5, steps=2, floor="", **{where: other},
        expect_error=message and f"Pair gran/restitution: {message}")
