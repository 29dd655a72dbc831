"""The energy guard warns where the energy rises, and only there: springs of sliding contacts hold no energy."""
import pytest

from deck_helpers import run_deck

START = """
units        si
atom_style   sphere
boundary     f f f
comm_modify  vel yes
variable     mass equal 2500*PI*0.02^3/6
neighbor     0.005 bin
neigh_modify every 1 delay 0 check yes
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


# --- where the energy grows, and nowhere else: at any height, where balls wrap, are lost or come, with motions ---

# a ball comes to a held one after 300 steps: a dashpot of 69 times the critical one, in steps, throws it back faster
SITE = """
units        si
atom_style   sphere
atom_modify  map array
dimension    {dimension}
boundary     {boundary}
comm_modify  vel yes
variable     mass equal 2500*PI*0.02^3/6
region       box block -1 1 -1 1 {low} {high}
create_box   3 box
create_atoms 2 single 0 0 {z0}
create_atoms 1 single {on_top}
{more}
set          type * diameter 0.02 density 2500
group        held type 2
group        free type 1 3
pair_style   gran/restitution {law}
timestep     $(0.25*sqrt(v_mass/1e6))
neighbor     0.005 bin
neigh_modify every 1 delay 0 check yes
velocity     all set 0 0 0
group        top type 1
velocity     top set {down}
{begin}
fix          weight {pulled} gravity {gravity}
fix          hold held freeze
fix          move free nve/sphere
thermo_modify lost ignore
{fixes}
run          {steps}
print        "balls $(count(all)) third at {where}"
"""
SOUND = "\npair_coeff * * stiffness 1e6 1e6 restitution 0.3 friction 30"
BROKEN = "scheme plain\npair_coeff * * stiffness 1e6 1e6 damping $(138*sqrt(1e6*v_mass)) 0"
THIRD = "create_atoms 3 single {x} 0 {z}\ngroup third type 3"
# beside it, not below: a ball that comes, or goes, must touch nothing
POUR = ("region above block -0.9 -0.5 -0.9 -0.5 $(v_z0+0.5) $(v_z0+0.9)\n"
        "fix pour third pour 8 3 5 vol 0.1 50 region above diam one 0.02 dens 2500 2500 vel -1 1 -1 1 -20\n"
        "fix move2 third nve/sphere")
SHAKE = "fix shake free ground/motion quake.txt\n"
PLACES = {
    "deep": {"z0": -500}, "high": {"z0": 500}, "at 0": {},
    "lost below 0": {"z0": -100, "third": (0.9, 0.5), "begin": "velocity third set 10 0 0", "balls": 2},
    "lost above 0": {"z0": 100, "third": (0.9, 0.5), "begin": "velocity third set 10 0 0", "balls": 2},
    "image wraps": {"boundary": "p p f", "gravity": "9.81 vector 1 0 -1", "third": (0.9, 0.5), "where": "$(x[3])",
                    "at": -0.844, "begin": "set type 3 image 511 NULL NULL\nvelocity third set 10 0 0"},
    "falls through z": {"boundary": "p p p", "third": (0.5, -0.9), "where": "$(z[3])", "at": 0.84,
                        "begin": "set type 3 image NULL NULL -512\nvelocity third set 0 0 -10"},
    "two dimensions": {"dimension": 2, "boundary": "f f p", "gravity": "9.81 vector 0 -1 0"},
    "enforce2d": {"dimension": 2, "boundary": "f f p", "gravity": "9.81 vector 0 -1 0",
                  "fixes": "fix flat all enforce2d"},
    "poured": {"z0": -300, "fixes": POUR, "balls": 10},
    "shaken": {"z0": 250, "fixes": SHAKE},
    "gravity turns": {"gravity": "v_g vector v_gx 0 -1", "begin": "variable g equal 9.81*(1+0.5*sin(step*0.01))\n"
                      "variable gx equal cos(step*0.02)", "third": (0.5, 0.5)},
    "pulled group changes": {"z0": 400, "third": (0.5, 0.5), "pulled": "low",
                             "begin": "variable low atom z<400.5-5e-5\ngroup low dynamic free every 7 var low\n"
                             "velocity third set 0 0 -0.05"},
}


def site(tmp_path, law, z0=0, dimension=3, boundary="f f f", gravity="9.81 vector 0 0 -1", third=None, begin="",
         fixes="", pulled="free", steps=1000, where=0, **_):
    (tmp_path / "quake.txt").write_text("".join(f"{0.0002 * k:g} {30 * (-1) ** k:g} 0 {10 * (-1) ** k:g}\n"
                                                for k in range(200)))
    flat = dimension == 2
    return f"variable z0 equal {z0}\n" + SITE.format(
        dimension=dimension, boundary=boundary, z0=z0, low=-0.01 if flat else z0 - 1, high=0.01 if flat else z0 + 1,
        on_top="0 0.0277 0" if flat else f"0 0 {z0 + 0.0277:.10g}",
        down="0 -1 0" if flat else "0 0 -1", law=law, gravity=gravity, begin=begin, fixes=fixes,
        more=THIRD.format(x=third[0], z=z0 + third[1]) if third else "group third empty", pulled=pulled, steps=steps,
        where=where)


@pytest.mark.parametrize("np", [1, 2])
@pytest.mark.parametrize("place", PLACES)
def test_no_alarm_where_contacts_are_sound(tmp_path, place, np):
    log = run_deck(site(tmp_path, SOUND, **PLACES[place]), tmp_path, np=np)
    assert alarms(log) == [] and "energy is not checked" not in log
    assert f"balls {PLACES[place].get('balls', 3 if 'third' in PLACES[place] else 2)} " in log
    if "at" in PLACES[place]:    # on the other side
        assert float(log.split(" third at ")[-1].split()[0]) == pytest.approx(PLACES[place]["at"], abs=0.02)


@pytest.mark.parametrize("place", PLACES)
def test_an_alarm_where_they_are_not(tmp_path, place):
    assert alarms(run_deck(site(tmp_path, BROKEN, **PLACES[place]), tmp_path))


@pytest.mark.parametrize("fix, name", [("fix push free addforce 0 0 1e-9", "fix push addforce"),
                                       ("fix path third move linear 0 0 1", "fix path move"),
                                       ("fix drag free viscous 1e-9", "fix drag viscous")])
def test_the_log_says_where_the_energy_is_not_checked(tmp_path, fix, name):
    log = run_deck(site(tmp_path, SOUND, fixes=fix, steps=1), tmp_path)
    assert f"energy is not checked: {name} may do work of its own" in log


def test_the_log_says_so_again_when_it_changes(tmp_path):
    deck = site(tmp_path, BROKEN, fixes="fix push free addforce 0 0 1e-9", steps=400) + "unfix push\nrun 1\nrun 1\n"
    log = run_deck(deck, tmp_path)
    assert log.count("energy is not checked") == 1 and log.count("contact coefficients (lightest") == 2
