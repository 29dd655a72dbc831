"""tools/slope crosscheck: a deck's final numbers, and the comparisons; codes that are not installed are skipped."""
import csv
import math
import os
import re
import shlex
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import shapely.geometry
import yaml
from affine import Affine

from run_helpers import TOP, examples
from tiny_collapse import LMP

sys.path.insert(0, str(TOP / "tests"))

from other_codes import crosscheck as crosscheck_command, crosscheck_cases as crosscheck  # noqa: E402
from other_codes import crosscheck_laws, crosscheck_table, granular_suite, peers  # noqa: E402
from slope_tools.errors import SlopeError  # noqa: E402
from slope_tools.survey import rasters  # noqa: E402


COMMAND = "crosscheck"


def checks():
    return yaml.safe_load(Path("crosscheck/crosscheck.yaml").read_text())["checks"]


def test_codes_agree_on_bounce_and_slide(succeed):
    """All installed codes; the peers' bounces at the rule's step are those of scheme plain, drop by drop."""
    out, _ = succeed("--quick --only bounce,slide_roll")
    installed = [code for code in crosscheck.PEERS if not code(LMP).missing()]
    for code in crosscheck.PEERS:
        assert (code in installed) or f"{code.title}: skipped" in out
    found = checks()
    assert {check["code"] for check in found} == {code.name for code in (*crosscheck.OURS, *installed)}
    assert all(check["passed"] in (True, None) for check in found)
    assert sum(check["passed"] is True for check in found) == 5 * (3 + len(installed)) + 2 * len(installed)
    mean = {check["code"]: check["value"] for check in found if check["quantity"].endswith("rule, mean")}
    spread = {check["code"]: check["value"] for check in found if check["quantity"].endswith("rule, spread")}
    assert mean["slope"] == pytest.approx(0.25, abs=0.01)       # the deck's target
    assert mean["plain"] < 0.235 and spread["plain"] > 3 * spread["slope"]      # what the default scheme is for
    rows = list(csv.DictReader(open("crosscheck/crosscheck.csv", encoding="ascii")))
    assert [row["code"] for row in rows] == [check["code"] for check in found]


def test_a_disagreement_is_exit_status_2(slope, monkeypatch):
    """Negative control: pair granular with the mu_r of the deck, not twice as much, does not stand still."""
    law = peers.Granular.law

    def half(self, scene):
        return law(self, scene._replace(contacts={kind: c._replace(rolling=c.rolling / 2)
                                                  for kind, c in scene.contacts.items()}))

    monkeypatch.setattr(peers.Granular, "law", half)
    monkeypatch.setattr(crosscheck, "OURS", (peers.Slope,))
    status, out, err = slope("--only rolling --peers granular")
    assert status == 2 and err.splitlines()[-1] == (
        "slope crosscheck: crosscheck: 3 of 6 comparisons are outside of their tolerance: rolling, "
        "friction 31 degrees, mu_r 0.58, granular")
    assert {check["value"] for check in checks() if check["code"] == "slope"} == {
        "stays still", "slides without rotating", "rotates without sliding"}


def test_final_numbers_of_a_deck(here):
    """Positions, velocities and coefficients of inputs/20 with coarse balls."""
    deck = TOP / "inputs" / "20_embankment" / "in.embankment"
    scene = crosscheck.scene_of(Path(LMP), deck, {"rule": "ours", "d": 6, "rolling": 0.05}, here / "deck")
    share = 6 / 1.25
    assert scene.diameter == 6 and scene.density == pytest.approx(3411.4) and scene.gravity == 9.80665
    assert scene.contacts[1][:6] == pytest.approx((1.96e9 * share, 1.96e9 * share, 1.19e6 * share ** 2,
                                                   1.19e6 * share ** 2, 30, 0.05))
    assert scene.contacts[2].friction == 0 and scene.contacts[3].cn == pytest.approx(3.09e6 * share ** 2)
    assert scene.dt == pytest.approx(0.25 * math.sqrt(scene.mass / scene.contacts[1].kn))
    assert len(scene.moving) > 50 and not scene.moving[:, 3:].any()
    told = re.findall(r"(\d+) (?:fixed )?balls", (here / "deck" / "log.scene").read_text())
    assert str(len(scene.fixed[2])) in told and str(len(scene.fixed[3])) in told
    apart = np.linalg.norm(scene.moving[:, None, :3] - scene.ground[None], axis=2)
    assert apart.min() > 0.999 * 6     # delete_balls: no ball starts inside a fixed one


def test_dashpots_are_those_of_the_style():
    """From a restitution: e of the closed form comes back; Table 4's dashpot is 0.48 for the mass of one ball."""
    mass = 3411.4 * math.pi / 6 * 1.25 ** 3
    law = crosscheck.contact("stiffness 1.96e9 1.96e9 restitution 0.48 friction 30 rolling 0.05".split(), mass)
    assert law.cn == pytest.approx(1.19e6, rel=2e-3) and law[4:] == (30, 0.05, None, None)
    zeta = law.cn / (2 * math.sqrt(law.kn * mass))
    assert crosscheck.restitution(zeta, True) == pytest.approx(0.48, rel=1e-12)
    assert crosscheck.restitution(zeta, False) > 0.53     # a force that never pulls
    assert crosscheck.restitution(1e-9, False) == pytest.approx(1)
    with pytest.raises(SlopeError, match="must print kn, kt, cn of types 1 2"):
        crosscheck.check_printed("log", "  1   2    1.96e+09 1.96e+09 1.00e+06 x", {2: law})


def test_deposit_by_hand():
    moving = np.zeros((3, 9))
    moving[:, :3] = [[150, 80, 40], [120, 80, 20], [110, 80, 10]]
    final = moving.copy()
    final[:, 0] = [90, 70, 61]
    scene = peers.Scene(2.0, 1.0, moving, {2: np.zeros((1, 3))}, {}, 1.0, 0.1)
    found = crosscheck.deposit(scene, final)
    assert found["volume on the road m3"] == pytest.approx(2 * 8)
    assert found["displacement of the centroid m"] == pytest.approx((150 + 120 + 110 - 90 - 70 - 61) / 3)
    assert found["run-out m"] == pytest.approx(89, abs=0.3)
    edges, values = crosscheck.profile(scene, final)
    assert sum(values) * 5 == pytest.approx(3 * 8) and values[edges.index(60)] == pytest.approx(8 / 5)


TRUE = [[17636, 17300, 17900], [17199, 16900, 17450], [17067, 17300, 16800]]


@pytest.mark.parametrize("factor, verdict", [(1.0, "agrees"), (1.01, "agrees"), (1.04, "cannot tell"),
                                             (1.15, "differs"), (0.85, "differs")])
def test_agreement_is_an_interval_within_the_bound(factor, verdict):
    mine = [[factor * one + by for one, by in zip(row, (200, -300, 100))] for row in TRUE]
    found = crosscheck_table.differences(mine, TRUE)
    assert [one.verdict(0.05) for one in found] == [verdict] * 3
    for one in found:
        assert one.low < one.share < one.high and one.share == pytest.approx(factor - 1)
    more = crosscheck_table.differences([2 * row for row in mine], [2 * row for row in TRUE])
    assert all(m.high - m.low < 0.7 * (one.high - one.low) for m, one in zip(more, found))


def test_the_intervals_hold_the_truth():
    """95 % of all three of a quantity, where the variance grows with the mean."""
    random, held = np.random.default_rng(5), 0
    means = np.array([[439.0], [215.0], [81.0]])
    for _ in range(400):
        a, b = (random.normal(means, np.sqrt(20 * means), (3, 3)) for _ in range(2))
        held += all(one.low <= 0 <= one.high for one in crosscheck_table.differences(a, b))
    assert 0.92 < held / 400 < 0.99


def test_a_wrong_law_is_found_in_the_table():
    """Volumes of runs with twice the rolling resistance; nothing lies beyond in one: no share of it."""
    beyond = [[439, 470, 410], [215, 240, 190], [81, 70, 92]]
    wrong = [beyond[0][::-1], beyond[2], [0, 4, 0]]
    found = crosscheck_table.differences(wrong, beyond)
    assert [one.verdict(0.05) for one in found] == ["cannot tell", "differs", "differs"]
    none, = crosscheck_table.differences([[1.0, 2.0, 3.0]], [[0.0, 0.0, 0.0]])
    assert none.verdict(0.05) == "cannot tell" and math.isnan(none.share)
    rows = crosscheck_table.about({"slope": made(beyond), "granular": made(wrong),
                                   "yade": made(wrong)}, {"d": 2.5})["rows"]
    checks_ = [crosscheck_table.check_of("table", row) for row in rows if row["verdict"]]
    of = {code: [check.passed for check in checks_ if check.code == code and check.case == "table"
                 and check.quantity.startswith("beyond")] for code in ("granular", "yade")}
    assert of == {"granular": [None, False, False], "yade": [None, None, None]}     # of another law: for information


def made(values):
    return [[dict.fromkeys(crosscheck_table.QUANTITIES, one) for one in row] for row in values]


class Stub:
    """Runs that do nothing; what they were given is kept."""
    quick, about_table = True, None

    def __init__(self, output, codes):
        self.output, self.codes, self.checks, self.given = output, codes, [], []

    def scene(self, name, deck, settings):
        law = peers.Contact(1.0, 1.0, 1.0, 1.0, 30.0, settings["rolling"])
        return peers.Scene(settings["d"], 1.0, np.zeros((1, 9)), {2: np.zeros((1, 3))},
                           {1: law, 2: law._replace(rolling=0.0), 3: law}, 0.1, 0.1)

    def run(self, name, scene, steps, codes):
        self.given.append((name, codes[0].name, scene, steps))
        return {code.name: (scene, None) for code in codes}


def volumes_by_rolling(factor):
    """The more rolling resistance on the field, the less of all: by twice as much as ours if factor is 2."""
    return lambda work, folder, settings, scene, final: dict.fromkeys(
        crosscheck_table.QUANTITIES, 1000.0 - factor * 500 * final.contacts[3].rolling + settings["xoffset"])


@pytest.mark.parametrize("quick", [True, False])
@pytest.mark.parametrize("factor, verdict, passed", [(5, "found", True), (0.1, "not found", False)])
def test_the_table_must_find_a_doubled_rolling_resistance(here, monkeypatch, factor, verdict, passed, quick):
    """With balls of 4 m, whatever those of the table: the paper's rule, or with --quick the same."""
    monkeypatch.setattr(crosscheck_table, "numbers_of", volumes_by_rolling(factor))
    work = Stub(here, [peers.Slope(LMP), peers.Granular(LMP)])
    work.quick = quick
    crosscheck_table.table(work, "table")
    last = work.checks[-1]
    assert last.quantity == "rolling doubled, as a control"
    assert (last.code, last.value, last.passed) == ("granular", verdict, passed)
    wrong = [scene.contacts[3].rolling for name, code, scene, _ in work.given if name.endswith("_control")]
    assert wrong == [0.1] * 3 + [0.2] * 3
    sizes = [(scene.diameter, name.endswith(("_control", "_coarse"))) for name, _, scene, _ in work.given]
    assert {size for size, coarse in sizes if not coarse} == {4.0 if quick else 1.25}
    assert {size for size, coarse in sizes if coarse} == {4.0} and len(sizes) == (15 if quick else 21)
    assert (work.about_table["rule"], work.about_table["d"]) == (("ours", 4.0) if quick else ("paper", 1.25))
    assert {check.value for check in work.checks[:-1]} == {"agrees"}       # the same law


def test_other_laws_differ_in_one_thing_each():
    law = peers.Contact(1e9, 1e9, 1e6, 1e6, 30.0, 0.05)
    laws = {1: law, 2: law._replace(friction=0.0, rolling=0.0), 3: law}
    scene = peers.Scene(2.5, 1.0, np.zeros((1, 9)), {}, laws, 0.1, 0.1)
    found = crosscheck_laws.variants(scene)
    assert found.pop("half the time step") == scene._replace(dt=0.05)
    changed = {name: {kind: {key: value for key, value in one.contacts[kind]._asdict().items()
                             if value != scene.contacts[kind]._asdict()[key]} for kind in (1, 2, 3)}
               for name, one in found.items()}
    assert changed == {"rolling without a spring": {kind: {"kr": 0.0} for kind in (1, 2, 3)},
                       "rolling with half the coefficient": {1: {"rolling": 0.025}, 2: {}, 3: {"rolling": 0.025}},
                       "rolling with twice the coefficient": {1: {"rolling": 0.1}, 2: {}, 3: {"rolling": 0.1}},
                       "rolling on the slip surface, too": {1: {}, 2: {"rolling": 0.05}, 3: {}}}


def test_a_law_without_a_spring_is_one_of_the_deck(here):
    law = peers.Contact(1e9, 1e9, 1e6, 2e6, 30.0, 0.05)
    scene = peers.Scene(2.5, 1.0, np.zeros((1, 9)), {3: np.ones((1, 3))}, {1: law, 2: law, 3: law}, 0.1, 0.1)
    peers.Slope(LMP).write(crosscheck_laws.variants(scene)["rolling without a spring"], here, 10)
    assert "rolling 0.05 rolling_spring 0.0 2000000.0" in (here / "in.scene").read_text()


def test_other_ways_to_count_the_volume(here):
    """Balls of 2 m on level ground beside and on a road: 30 degrees rise to 5.77 m within 10 m of its edge."""
    base = np.zeros((10, 20))
    raster = rasters.Raster(base, Affine(2, 0, 0, 0, -2, 20), None)
    run = SimpleNamespace(base=base, raster=raster, cell=2.0, bulk=2.0)
    removal = SimpleNamespace(run=run, road=shapely.geometry.box(0, 0, 10, 20))
    #              on the road   below the cut   above it       in the same cell, lower
    final = np.array([[5.1, 9, 1], [21, 9, 5.5], [21, 5, 7.5], [21.2, 5.2, 6.7]])
    assert crosscheck_laws.by_centres(removal, final, 2.0) == pytest.approx(3 * 2.0 * math.pi / 6 * 2 ** 3)


@pytest.mark.parametrize("arguments, message", [
    ("--only fall", "--only: must be of bounce, slide_roll, rolling, collapse, table, laws, got fall"),
    ("--peers pfc", "--peers: must be of granular, liggghts, yade, got pfc"),
    ("--lmp none", "--lmp: must lead to the LAMMPS program"),
    ("-o file", "-o: must be a folder, got file"),
])
def test_bad_input_is_one_line(slope, arguments, message):
    Path("file").touch()
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1 and err.startswith("slope crosscheck: ") and message in err
    assert os.listdir() == ["file"]


@pytest.mark.parametrize("command", examples("crosscheck", "other_codes"))
def test_every_example_of_the_page_and_the_help_is_understood(slope, monkeypatch, command):
    """They would take minutes: here no case is run."""
    done = []
    monkeypatch.setattr(crosscheck_command, "CASES",
                        {name: lambda work, case: done.append(case) for name in crosscheck_command.CASES})
    status, out, err = slope(command)
    assert (status, err) == (0, "") and (done or "--help" in shlex.split(command))


# --- LAMMPS' own granular verifications ---

GRANULAR = """---
lammps_version: 1 Jan 2026
pre_commands: ! |
  units si
  boundary p p f
  atom_style sphere
  region box block -1 1 -1 1 -0.5 2 units box
  create_box 1 box
  create_atoms 1 single 0.0 0.0 0.55 units box
  set group all diameter ${diam} density 1.0
  velocity all set ${vx_in} 0.0 -${vz_in}
  comm_modify vel yes
  neighbor 0.3 bin
  timestep 2.0e-4
post_commands: ! |
  fix integr all nve/sphere
  fix floor all wall/gran MODEL zplane 0.0 NULL
variables: ! |
  diam 1.0
  knorm 1.0e4
  en 0.6
  xmu 0.3
  vx_in 4.0
  vz_in 1.0
  radius 0.5
pair_style: granular
pair_coeff: ! |
  * * MODEL
run_segments: ! |-
  400 400
analytic_model: oblique_impact
analytic_segment: 1
run_pos: ! |2
  1   1  0.5  0.0  0.5
run_vel: ! |2
  1   1  3.5  0.0  0.61
run_omega: ! |2
  1   1  0.0  2.4  0.0
...
"""


def test_a_case_of_the_granular_suite(tmp_path, monkeypatch, capsys):
    """Its deck in our words meets the closed form, its own numbers are in the table; a case of Hertz has a reason."""
    cases = tmp_path / "unittest" / "granular" / "tests"
    cases.mkdir(parents=True)
    for name, model in (("linear", "hooke ${knorm} ${en} tangential linear_history 2857.0 0.0 ${xmu}"),
                        ("springs", "hertz/material ${knorm} ${en} 0.3 tangential mindlin NULL 0.0 ${xmu}")):
        words = f"granular {model} damping coeff_restitution"
        (cases / f"dem05-{name}.yaml").write_text(GRANULAR.replace("MODEL", words).replace("* * granular", "* *"))
    monkeypatch.setenv("LMP", LMP)
    granular_suite.main(str(tmp_path))
    page = capsys.readouterr().out
    rows = list(csv.reader(page.split("12\n\n")[1].strip().splitlines(), skipinitialspace=True))[1:]
    assert [row[:2] for row in rows[:3]] == [["dem05-linear", "vz"], ["", "vx"], ["", "spin"]]
    assert [float(row[2]) for row in rows[:3]] == pytest.approx([0.6, 3.52, 2.4])
    assert [float(row[3]) for row in rows[:3]] == [0.61, 3.5, 2.4]
    assert all(abs(float(row[6])) < 0.01 for row in rows[:3]) and abs(float(rows[0][6])) < 1e-4, rows
    assert rows[3][0] == "dem05-springs" and "Hertz" in rows[3][1] and len(rows) == 4
