"""The energy guard warns where the energy rises, and only there: springs of sliding contacts hold no energy."""
import pytest

from deck_helpers import run_deck

START = """
units        si
atom_style   sphere
boundary     f f f
comm_modify  vel yes
variable     mass equal 2500*PI*0.02^3/6
"""

# a ball of 2 cm grazes a frozen one of its size without friction: the springs of its contact slide at all times
GRAZE = START + """
region       box block -1 1 -1 1 -1 1
create_box   2 box
create_atoms 1 single 0 0 0.02002
create_atoms 2 single 0 0 0
set          type * diameter 0.02 density 2500
group        ball type 1
group        held type 2
pair_style   gran/restitution
pair_coeff   * * stiffness 1e6 1e6 restitution {e} friction 0
timestep     $({part}*0.25*sqrt(v_mass/1e6))
neighbor     0.005 bin
neigh_modify every 1 delay 0 check yes
velocity     all set 0 0 0
velocity     ball set 3 0 -1
fix          hold held freeze
fix          move ball nve/sphere
compute      motion ball ke
thermo_style custom step c_motion
thermo       10
run          $(round(40/{part}))
"""

# a ball lands on a frozen ball of 200 m, at 2 m/s along it, and slides with a friction of 5 degrees until it rolls
LAND = START + """
region       box block -120 120 -120 120 -220 10
create_box   2 box
create_atoms 1 single 0 0 0.0101
create_atoms 2 single 0 0 -100
set          type 1 diameter 0.02 density 2500
set          type 2 diameter 200 density 2500
group        ball type 1
group        held type 2
pair_style   gran/restitution
pair_coeff   * * stiffness 1e5 1e5 restitution {e} friction 5
timestep     $({part}*0.25*sqrt(v_mass/1e5))
neighbor     0.01 bin
neigh_modify every 1 delay 0 check yes
velocity     all set 0 0 0
velocity     ball set 2 0 0
fix          weight ball gravity 9.81 vector 0 0 -1
fix          hold held freeze
fix          move ball nve/sphere
compute      motion ball ke
compute      spin ball erotate/sphere
thermo_style custom step c_motion c_spin
thermo       $(round(20/{part}))
run          $(round(4000/{part}))
"""

# a ball is put on a frozen one; the dashpot is 69 times the critical one, which scheme plain does not follow
BURST = START + """
region       box block -1 1 -1 1 -1 1
create_box   2 box
create_atoms 1 single 0 0 0.02
create_atoms 2 single 0 0 0
set          type * diameter 0.02 density 2500
group        ball type 1
group        held type 2
pair_style   gran/restitution scheme plain
pair_coeff   * * stiffness 1e6 1e6 damping $(138*sqrt(1e6*v_mass)) 0
timestep     $(0.25*sqrt(v_mass/1e6))
neighbor     0.005 bin
neigh_modify every 1 delay 0 check yes
velocity     all set 0 0 0
fix          weight ball gravity 9.81 vector 0 0 -1
fix          hold held freeze
fix          move ball nve/sphere
thermo_modify lost ignore
run          600
"""

# two free balls without dashpots that have just met at the check of step 200
ELASTIC = START + """
region       box block -1 1 -1 1 -1 1
create_box   1 box
variable     dt equal 0.25*sqrt(v_mass/1e6)
create_atoms 1 single 0 0 0
create_atoms 1 single $(0.02+199.56*v_dt) 0 0
set          type 1 diameter 0.02 density 2500
pair_style   gran/restitution
pair_coeff   * * stiffness 1e6 1e6 restitution 1 friction 0
timestep     ${dt}
neighbor     0.005 bin
neigh_modify every 1 delay 0 check yes
velocity     all set 0 0 0
group        first id 1
group        second id 2
velocity     first set 0.5 0 0
velocity     second set -0.5 0 0
fix          move all nve/sphere
run          400
"""


def alarms(log):
    return [line for line in log.splitlines() if line.startswith("WARNING") and "the energy of the balls" in line]


@pytest.mark.parametrize("part", [1, 0.1])
@pytest.mark.parametrize("e", [0.05, 0.1, 0.5])
@pytest.mark.parametrize("deck", [GRAZE, LAND], ids=["graze", "land"])
def test_sliding_is_no_alarm(tmp_path, deck, e, part):
    assert alarms(run_deck(deck.format(e=e, part=part), tmp_path)) == []


def test_impact_is_no_alarm(tmp_path):
    """A contact that begins has up to kn dt^2/(4 m) = 3.1 % less energy at the rule's step; the bound is 4 %."""
    assert alarms(run_deck(ELASTIC, tmp_path)) == []


def test_growing_energy_is_one(tmp_path):
    assert alarms(run_deck(BURST, tmp_path))


def test_sizes_that_vary_are_no_alarm(tmp_path):
    """A ball at rest on a frozen one is blown up by fix adapt: energy that comes from neither contacts nor gravity."""
    grown = BURST.replace("atom_style   sphere", "atom_style sphere 1").replace("scheme plain", "")
    grown = grown.replace("damping $(138*sqrt(1e6*v_mass)) 0", "restitution 0.9")
    adapt = "variable size equal 0.02*(1+0.001*step)\nfix grow ball adapt 1 atom diameter v_size\n"
    log = run_deck(grown.replace("run          600", adapt + "run 600"), tmp_path)
    assert alarms(log) == []


def with_others(deck, pair, more):
    """The deck with another pair style, and more before its run."""
    style = "gran/restitution scheme plain" if "scheme plain" in deck else "gran/restitution"
    if pair:
        deck = deck.replace(style, pair.replace("OURS", style)).replace("* * ", "* * gran/restitution ")
    before, run = deck.split("run  ")
    return f"{before}{more}\nrun {run}"


# two balls that touch no more are driven apart, one that falls is put back with each step: no contact's doing
FALL = BURST.replace("create_atoms 1 single 0 0 0.02\n", "create_atoms 1 single 0 0 0.5\n")
SOFT = "pair_coeff * * soft 1.0\ncomm_modify cutoff 0.2"


@pytest.mark.parametrize("deck, pair, more", [
    (ELASTIC, "hybrid/overlay OURS soft 0.1", SOFT), (ELASTIC, "hybrid/overlay soft 0.1 OURS", SOFT),
    (FALL, "", "fix back ball recenter INIT INIT INIT"), (ELASTIC, "", "fix hot all temp/rescale 1 1e22 1e22 0 1"),
    (FALL, "", "fix spin ball momentum 1 linear 0 0 1 rescale\nfix back ball recenter INIT INIT INIT")],
    ids=["overlay", "overlay last", "recenter", "temp", "momentum"])
def test_work_of_others_is_no_alarm(tmp_path, deck, pair, more):
    assert alarms(run_deck(with_others(deck, pair, more), tmp_path)) == []


OBSERVERS = """
compute e all ke
fix mean all ave/time 10 1 10 c_e
fix say all print 100 on
fix even all balance 100 1.1 shift xyz 5 1.1
group near dynamic ball every 10 region box
fix stop all halt 100 tlimit > 1e6
fix keep all store/force"""


@pytest.mark.parametrize("pair, more", [
    ("hybrid/overlay OURS zero 0.1", "pair_coeff * * zero"), ("hybrid OURS", ""), ("", OBSERVERS)],
    ids=["zero", "alone", "observers"])
def test_others_that_do_no_work_hide_none(tmp_path, pair, more):
    assert alarms(run_deck(with_others(BURST, pair, more), tmp_path))
