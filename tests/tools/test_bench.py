"""tools/slope bench, and the inputs that it writes for other codes: all of them must run the same collapse."""
import csv
import os
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from run_helpers import TOP, anew, examples
from tiny_collapse import LMP

sys.path.insert(0, str(TOP / "tests"))

from other_codes import bench_report, bench_runs, bench_scenes, peers  # noqa: E402

COMMAND = "bench"
SMALL = "--quick --balls 300 --steps 40 --runs 1"


@pytest.mark.drawn
def test_every_code_runs_the_same_collapse(succeed):
    """From the same state, 40 steps: energy and displacement of the centroid agree; nothing is left unwritten."""
    out, _ = succeed(f"{SMALL} --only peers")
    about = yaml.safe_load(Path("bench/bench.yaml").read_text())
    installed = [code for code in peers.ALL if code is not peers.Build and not code(LMP).missing()]
    assert list(about["codes"]) == [code.name for code in installed]
    for code in peers.ALL:
        assert code is peers.Build or (code in installed) or f"{code.title}: not measured" in out
    for name, state in about["same_scene"].items():
        assert state["same"], (name, state)
        if name not in bench_report.LOOSE:
            assert state["kinetic_energy_to_ours"] == pytest.approx(1, abs=0.02), name
            assert state["centroid_off"] < 0.02, name
    assert about["same_scene"]["slope"]["centroid_displacement"][0] < -0.01        # m: the mass moves
    rows = list(csv.DictReader(open("bench/bench.csv", encoding="ascii")))
    assert len(rows) == 2 * (len(installed) - 1) and all(float(row["loop_s"]) > 0 for row in rows)
    assert Path("bench/bench.png").stat().st_size > 10_000


def test_two_builds_side_by_side(succeed):
    """Each code with a program of its own; here copies of one, which run the same steps."""
    for name in "other", "stock":
        Path(name).symlink_to(LMP)
    out, _ = succeed(f"{SMALL} --only peers --peers build,granular --lmp build=other --lmp granular=stock")
    about = yaml.safe_load(Path("bench/bench.yaml").read_text())
    assert list(about["codes"]) == ["slope", "build", "granular"] and "SLOPE, another build" in out
    assert about["same_scene"]["build"] == about["same_scene"]["slope"]
    assert set(about["bench"]["programs_sha256"]) == {"build", "granular"}


def test_a_wrong_coefficient_is_noticed(succeed, monkeypatch):
    """Negative control: a peer without the slip surface's contact runs another collapse, and the table says so."""
    law = peers.Granular.law

    def without_slip(self, scene):
        wrong = {**scene.contacts, 2: scene.contacts[2]._replace(kn=scene.contacts[2].kn / 1e4)}
        return law(self, scene._replace(contacts=wrong))

    monkeypatch.setattr(peers.Granular, "law", without_slip)
    out, _ = succeed(f"{anew(SMALL, '--steps 200')} --only peers --peers granular")
    assert not yaml.safe_load(Path("bench/bench.yaml").read_text())["same_scene"]["granular"]["same"]
    assert "pair granular, rolling sds ran another collapse" in out


def test_terrain_and_throughput(succeed):
    succeed(f"{SMALL} --only terrain,throughput")
    measures = yaml.safe_load(Path("bench/bench.yaml").read_text())["measures"]
    assert set(measures) == {"terrain_time", "terrain_bytes", "terrain_bytes_reported", "throughput"}
    rows = list(csv.DictReader(open("bench/bench.csv", encoding="ascii")))
    fixed = sorted({int(row["fixed"]) for row in rows if row["part"] == "terrain"})
    assert len(fixed) == 2 and fixed[1] > 4 * fixed[0]
    # the mass lies on the same balls: what it has run on is part of the larger terrain
    near, wide = (np.loadtxt(f"bench/{name}/fixed.3.xyz") for name in ("slope", "slope_wide"))
    there = {tuple(point) for point in wide.tolist()}
    inner = [tuple(point) for point in near.tolist()
             if (np.abs(point - near.mean(axis=0)) < 0.3 * np.ptp(near, axis=0))[:2].all()]
    assert len(inner) > 20 and all(point in there for point in inner)


def test_more_balls_on_one_rank_and_on_two(succeed, monkeypatch):
    monkeypatch.setattr(bench_runs, "MANY", 1000)
    succeed("--only weak --balls 300 --steps 40 --runs 1 --np 2")
    measures = yaml.safe_load(Path("bench/bench.yaml").read_text())["measures"]
    assert set(measures) == {"weak_time", "weak_time_2", "weak_bytes", "weak_bytes_reported"}
    assert all(measures[name]["target"] == "<= 1.3" for name in ("weak_time", "weak_time_2"))
    rows = [row for row in csv.DictReader(open("bench/bench.csv", encoding="ascii")) if row["part"] == "weak"]
    few, many = int(rows[0]["moving"]), int(rows[1]["moving"])
    assert many >= 1000 and many % few == 0
    assert [(int(row["ranks"]), int(row["moving"])) for row in rows] == [(1, few), (1, many), (2, few), (2, many)]
    times = [float(row["ns_per_ball_step"]) for row in rows]
    assert measures["weak_time"]["value"] == pytest.approx(times[1] / times[0], rel=1e-4)
    assert measures["weak_time_2"]["value"] == pytest.approx(times[3] / times[2], rel=1e-4)


def test_copies_do_not_touch_each_other():
    moving = np.zeros((2, 9))
    moving[:, :3] = [[0, 0, 5], [0, 3, 5]]
    ground = np.array([[0.0, 0.0, 0.0], [0.0, 10.0, 0.0]])
    scene = peers.Scene(1.0, 1.0, moving, {2: ground}, bench_scenes.contacts(), 1.0, 0.1)
    many = bench_scenes.copies(scene, 3, 12.0)
    assert len(many.moving) == 6 and len(many.ground) == 6
    assert many.ground[:, 1].tolist() == [0, 10, 12, 22, 24, 34] and (many.moving[:, 3:] == 0).all()


def test_two_materials_of_yade_give_the_wanted_contact():
    for own, wanted in ((1.19e6, 1.19e6), (1.19e6, 3.09e6), (2.0, 0.5)):
        a, b = peers.partner(own, own), peers.partner(own, wanted)
        assert a * a / (a + a) == pytest.approx(own) and a * b / (a + b) == pytest.approx(wanted)
    a = peers.partner(1.0, 1.0)
    assert a * peers.partner(1.0, 2.0) / (a + peers.partner(1.0, 2.0)) == pytest.approx(2.0)


@pytest.mark.parametrize("arguments, message", [
    ("--only speed", "--only: must be of peers, terrain, ranks, throughput, weak, got speed"),
    ("--peers pfc", "--peers: must be of granular, hooke, liggghts, yade, got pfc"),
    ("--field-factor 0.5", "--field-factor: must be >= 1, got 0.5"),
    ("--balls 5", "--balls: must be >= 100, got 5"),
    ("--np 2,x", "--np: must be a whole number >= 1, got 'x'"),
    ("--lmp none", "--lmp: must lead to the LAMMPS program"),
    ("--lmp granular=none", "--lmp: must lead to the LAMMPS program"),
    ("--lmp yade=lmp", "--lmp: must be FILE, or CODE=FILE with CODE of build, granular, hooke, got yade=lmp"),
    ("--lmp one --lmp two", "--lmp: must name one program for all, others as CODE=FILE, got two"),
    ("--peers build", "--peers: must be of granular, hooke, liggghts, yade, got build"),
    ("-o file", "-o: must be a folder, got file"),
    ("--quick --only weak", "--only: must name a part with runs to time: weak has none with --quick, got weak"),
    ("--only ranks --np 1", "--only: must name a part with runs to time: ranks has none with --np 1, got ranks"),
    ("--quick --only weak,ranks --np 1", "weak has none with --quick"),
])
def test_bad_input_is_one_line(slope, arguments, message):
    Path("file").touch()
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1 and err.startswith("slope bench: ") and message in err
    assert os.listdir() == ["file"]


def test_a_run_that_fails_is_one_line(slope, monkeypatch):
    monkeypatch.setattr(peers.Granular, "law", lambda *_: ["pair_style nonsense"])
    status, out, err = slope(f"{SMALL} --only peers --peers granular")
    assert status == 2 and err.splitlines()[-1].startswith(
        "slope bench: bench/granular/log.scene: pair granular, rolling sds did not end well, got ERROR: Unrecognized")


@pytest.mark.parametrize("command", examples("bench", "other_codes"))
def test_every_example_of_the_page_and_the_help_is_understood(slope, monkeypatch, command):
    """They would take minutes: here the plan is made, and not run."""
    plans = []
    monkeypatch.setattr(bench_runs.Plan, "do", lambda self, *what: plans.append(what))
    status, out, err = slope(command)
    assert (status, err) == (0, "") and (len(plans) == 1 or "--help" in shlex.split(command))
