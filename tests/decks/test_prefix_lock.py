"""Two runs never write files of one prefix at a time; a run that was killed is in nobody's way."""

import fcntl
import os
import signal
import subprocess

import numpy
import pytest
from deck_helpers import ALONE, ENVIRONMENT, LMP, run_deck, write_asc
from mesh_helpers import box, stl_bytes

DECK = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region ground terrain ground.asc depth 2 headroom 6
region all block 0 16 0 16 -2 6
create_box 3 all
create_atoms 1 single 6 6 2
set group all diameter 0.9 density 2000
pair_style gran/restitution
pair_coeff * * stiffness 1e6 1e6 restitution 0.5 friction 30
fix move all nve/sphere
timestep 1e-3
{command}
run {steps}
"""
DEPOSIT = "fix dep all deposit/grid 1 0 cell 1 terrain ground output {} bulk 1.5"
WRITERS = {
    "Fix deposit/grid": DEPOSIT.format("out"),
    "Fix control/line": DEPOSIT.format("other") + "\nfix line all control/line line.csv output out",
    "Fix wall/gran/mesh house": "fix house all wall/gran/mesh 3 house.stl output out 10",
    "Find_slip": "find_slip hill strength 3000 19.6 2039 surface sphere 10.25 25.25 54.0 28.9617 output out",
}


@pytest.fixture
def site(tmp_path):
    write_asc(tmp_path / "ground.asc", numpy.zeros((16, 16)))
    write_asc(tmp_path / "hill.asc", numpy.tile(25 + 0.5 * numpy.clip(numpy.arange(51) - 10, 0, 20), (51, 1)))
    (tmp_path / "line.csv").write_text("10,0\n10,16\n")
    (tmp_path / "house.stl").write_bytes(stl_bytes(box((12, 12, 1), (13, 13, 2))))
    return tmp_path


def deck(command, steps=2):
    return DECK.format(command="region hill terrain hill.asc\n" + command, steps=steps)


@pytest.mark.parametrize("caller, ranks", [*((caller, 1) for caller in WRITERS), ("Fix deposit/grid", 2)])
def test_the_prefix_of_another_run(site, caller, ranks):
    (site / "out.lock").write_text("a run on host far, process 77, since 2026-11-25 12:00:00\n")
    with open(site / "out.lock") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        run_deck(deck(WRITERS[caller]), site, np=ranks, expect_error=f"{caller}: output out must be that of one run at "
                 "a time, got a run on host far, process 77, since 2026-11-25 12:00:00")
        assert [path.name for path in site.glob("out*")] == ["out.lock"]
    run_deck(deck(WRITERS[caller]), site, np=ranks)                  # what is left of it does no harm
    assert len(list(site.glob("out.*"))) > 1 and not list(site.glob("*.lock")) and not list(site.glob("*.tmp"))


def test_a_run_that_is_killed(site):
    (site / "in.killed").write_text(deck(WRITERS["Fix deposit/grid"] + "\nthermo 1", steps=100_000_000))
    with subprocess.Popen([LMP, "-in", "in.killed", "-log", "none"], cwd=site, env={**ENVIRONMENT, **ALONE}, text=True,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as run:
        try:
            while run.stdout.readline().split()[:1] != ["Step"]:
                assert run.poll() is None
            assert f", process {run.pid}, since 2" in (site / "out.lock").read_text()
            run_deck(deck(WRITERS["Fix deposit/grid"]), site,
                     expect_error=f"Fix deposit/grid: output out must be that of one "
                     f"run at a time, got a run on host {os.uname().nodename}, process {run.pid}, since ")
        finally:
            os.kill(run.pid, signal.SIGKILL)
    assert (site / "out.lock").exists()
    run_deck(deck(WRITERS["Fix deposit/grid"]), site)
    assert not (site / "out.lock").exists()


def test_several_writers_and_runs_of_a_deck(site):
    """One prefix for files of several kinds, a fix again, find_slip again, and after clear."""
    all_of_them = "\n".join(command.replace("other", "out").replace(DEPOSIT.format("out") + "\nfix line", "fix line")
                            for command in WRITERS.values())
    again = "run 1\nunfix line\nunfix dep\n" + WRITERS["Fix deposit/grid"] + "\n" + WRITERS["Find_slip"] + "\nrun 1\n"
    run_deck(deck(all_of_them) + again + "clear\n" + deck(all_of_them), site)
    assert (site / "out.line.csv").exists() and not list(site.glob("*.lock"))
