"""tools/slope study: a run that was killed goes on from its last restart file, and ends as the uncut one."""
import csv
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml

from tiny_collapse import LMP, TOP, edit, processes_in, read_asc, serial, write_case

from slope_tools.case import logs, restarts, run_folders
from slope_tools.runs import jobs

COMMAND = "study"
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
PROGRAM = [sys.executable, str(TOOLS / "slope")]
# Rounding differs after a restart, and in a collapse it grows: measured here by a factor of 30 in 200 steps. The runs
# of these tests end 200 to 300 steps after the restart.
CLOSE = 1e-9
STEPS = 700
FOLDER = f"rolling_0.1_steps_{STEPS}"

# what a deck needs so that its runs can be continued; ../../gate kills it at step 550
EDITS = [
    ("create_box  3 ground\nlattice     sc 1.0\ncreate_atoms 1 region slip\n",
     "variable  continued equal is_defined(variable,restart)\nlattice     sc 1.0\n"
     'if "${continued}" then "read_restart ${restart}" else "create_box 3 ground" "create_atoms 1 region slip"\n'),
    ("set         group soil diameter 1.0 density 3411.4\n",
     'if "!${continued}" then "set group soil diameter 1.0 density 3411.4"\n'),
    ("delete_balls soil overlap 0.0\n", 'if "!${continued}" then "delete_balls soil overlap 0.0"\n'),
    ("thermo_style custom step time", "variable time equal step*dt\nthermo_style custom step v_time"),
    ("run         ${steps}\n", "restart     100 ${out}.1.restart ${out}.2.restart\n"
                               'run         ${steps} upto every 550 "shell ../../gate"\n'),
]
GATE = """\
#!/bin/sh
test -n "$DIES" || exit 0
lmp=$PPID       # or the shell between
test "$(cat /proc/$lmp/comm)" != sh || lmp=$(awk '{print $4}' /proc/$lmp/stat)
kill -9 $lmp
sleep 1
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", LMP)
    monkeypatch.delenv("DIES", raising=False)
    make(tmp_path)
    return tmp_path


def make(folder):
    """The case, with a deck that can be continued."""
    edit(write_case(folder / "case"), *sum(EDITS, ()))
    (folder / "gate").write_text(GATE)
    (folder / "gate").chmod(0o755)


def arguments(np=1, output="out"):
    return f"case/in.tiny --set rolling=0.1 --set steps={STEPS} --np {np} -o {output}"


@pytest.fixture
def cut(here, slope, monkeypatch):
    """Folder of a run that was killed between steps 500, in tiny.1.restart, and 600; 400 is in tiny.2.restart."""
    monkeypatch.setenv("DIES", "yes")
    assert slope(arguments())[0] == 2
    monkeypatch.delenv("DIES")
    folder = here / "out" / FOLDER
    assert not (folder / "finished.yaml").exists()
    found = [(step, path.name) for step, path in restarts.restarts(folder)]
    assert found == [(500, "tiny.1.restart"), (400, "tiny.2.restart")]
    return folder


def numbers(folder):
    """All numbers of the summary and of the rasters of a run."""
    about = yaml.safe_load((folder / "tiny.summary.yaml").read_text())
    found = {f"{key}: {entry}": value for key in ("volume", "balls", "travel", "largest", "motion", "stop")
             for entry, value in about[key].items() if entry not in ("reason", "residual")}
    # shares of travel are a list of mappings, the farthest ball is one
    for name in [name for name, value in found.items() if isinstance(value, (dict, list))]:
        value = found.pop(name)
        parts = enumerate(value) if isinstance(value, list) else [("", value)]
        for k, part in parts:
            found.update({f"{name} {k} {entry}": one for entry, one in part.items()} if isinstance(part, dict)
                         else {f"{name} {k}": part})
    found["change_rate"] = about["change_rate"]
    for name in about["files"]:
        found[name] = read_asc(folder / name)
    return found


def assert_same(one, other):
    assert one.keys() == other.keys()
    for key, value in one.items():
        most = np.nanmax(np.abs(value), initial=0)
        near = CLOSE * most
        if np.ndim(value) and most > 0:      # rasters have nine digits: the last one may be rounded the other way
            near = max(near, 1.1e-9 * 10 ** np.ceil(np.log10(most)))
        assert np.allclose(value, other[key], rtol=0, atol=near, equal_nan=True), key


@pytest.mark.parametrize("before, after", [(1, 1), (2, 1)])
def test_a_continued_run_ends_as_the_uncut_one(slope, here, monkeypatch, before, after):
    if max(before, after) > 1 and serial():
        pytest.skip("LMP is serial: built with BUILD_MPI=OFF")
    assert slope(arguments(before, "whole"))[0] == 0
    monkeypatch.setenv("DIES", "yes")
    status, told, err = slope(arguments(before))
    assert status == 2 and "1 of 1 runs failed" in err
    monkeypatch.delenv("DIES")
    folder = here / "out" / FOLDER
    status, told, err = slope(arguments(after))
    assert status == 0, err
    lines = [line for line in told.splitlines() if line.startswith("[1/1]")]
    assert lines[0] == f"[1/1] {FOLDER}: continues at step 500, from out/{FOLDER}/tiny.1.restart"
    assert re.fullmatch(rf"\[1/1\] {FOLDER}: finished at 1.4 s, wall time .* s since step 500", lines[1])
    assert len(lines) == 2
    assert_same(numbers(here / "whole" / FOLDER), numbers(folder))
    # what was continued stands in the folder, and the logs are read as one
    about = yaml.safe_load((folder / "variables.yaml").read_text())
    assert [entry["step"] for entry in about["continued"]] == [500] and about["ranks"] == after
    log = logs.Log(folder / "log.lammps").update()
    whole = logs.Log(here / "whole" / FOLDER / "log.lammps").update()
    assert (folder / "log.1.lammps").exists() and (log.step, log.error) == (STEPS, None)
    assert (log.terrain, log.table) == (whole.terrain, whole.table) and set(whole.warnings) <= set(log.warnings)
    assert set(whole.notes) <= set(log.notes) and set(whole.settings) <= set(log.settings)
    rows = [next(csv.DictReader(open(here / output / "study.csv", encoding="ascii"))) for output in ("out", "whole")]
    assert float(rows[0]["front_m"]) == pytest.approx(float(rows[1]["front_m"]), rel=CLOSE)
    # nothing is left to do
    assert "1 of 1 runs are finished already" in slope(arguments(after))[1]


def test_the_numbers_of_another_run_are_not_the_same(slope, here):
    """The comparison above can fail."""
    assert slope(arguments(output="whole"))[0] == 0
    assert slope(f"case/in.tiny --set rolling=0.1 --set steps={STEPS - 1} -o other")[0] == 0
    with pytest.raises(AssertionError):
        assert_same(numbers(here / "whole" / FOLDER), numbers(here / "other" / f"rolling_0.1_steps_{STEPS - 1}"))


def test_a_study_that_was_killed(slope, here):
    """The study and its run, at whatever step; twice."""
    command = shlex.split("case/in.tiny --set steps=4000 -o out")
    folder = here / "out" / "steps_4000"
    last = -1
    for _ in range(2):
        process = subprocess.Popen([*PROGRAM, "study", *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        end = time.monotonic() + 30
        while not (folder.exists() and any(step >= last + 100 for step, _ in restarts.restarts(folder))):
            assert time.monotonic() < end and process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.communicate(timeout=20)
        while processes_in(folder):
            assert time.monotonic() < end
            time.sleep(0.02)
        last = restarts.restarts(folder)[0][0]
    status, told, err = slope(shlex.join(command))
    assert status == 0, err
    assert f"[1/1] steps_4000: continues at step {last}, from " in told
    assert len(yaml.safe_load((folder / "variables.yaml").read_text())["continued"]) == 2
    assert run_folders.load_summary(folder / "tiny.summary.yaml")["stop"]["step"] == 4000
    assert sorted(path.name for path in folder.glob("log.*")) == ["log.1.lammps", "log.2.lammps", "log.lammps"]


# --- restart files that are no use ---

def truncate(path):
    os.truncate(path, os.path.getsize(path) // 2)


def spoil(path):
    """As long as it was and with its end, but not what LAMMPS wrote."""
    with open(path, "r+b") as file:
        file.seek(200)
        file.write(b"\xff" * 200)


@pytest.mark.parametrize("break_it", [truncate, os.remove, lambda path: os.truncate(path, 0), spoil])
def test_it_falls_back_to_the_restart_file_before(slope, here, cut, break_it):
    assert slope(arguments(output="whole"))[0] == 0
    break_it(cut / "tiny.1.restart")
    status, told, err = slope(arguments())
    assert status == 0, err
    lines = [line.split(": ", 1)[1] for line in told.splitlines() if line.startswith("[1/1]")]
    if break_it is spoil:       # seen by LAMMPS only
        assert lines.pop(0) == f"continues at step 500, from out/{FOLDER}/tiny.1.restart"
    assert lines[0] == f"continues at step 400, from out/{FOLDER}/tiny.2.restart"
    assert lines[1].startswith("finished at 1.4 s") and len(lines) == 2
    assert_same(numbers(here / "whole" / FOLDER), numbers(cut))


@pytest.mark.parametrize("break_it", [truncate, spoil])
def test_without_a_restart_file_it_starts_anew(slope, here, cut, break_it):
    for name in ("tiny.1.restart", "tiny.2.restart"):
        break_it(cut / name)
    status, told, err = slope(arguments())
    assert status == 0, err
    assert f"[1/1] {FOLDER}: starts again: it left no complete restart file\n" in told
    assert not (cut / "log.1.lammps").exists()


def test_the_step_of_a_restart_file(here, cut):
    path = cut / "tiny.1.restart"
    whole = path.read_bytes()
    assert restarts.restart_step(path) == 500
    for length in (*range(0, 200, 3), len(whole) // 2, len(whole) - 16, len(whole) - 1):
        (here / "part").write_bytes(whole[:length])
        assert restarts.restart_step(here / "part") is None, length
    (here / "ends").write_bytes(restarts.MAGIC * 2)
    assert restarts.restart_step(here / "ends") is None
    assert restarts.restart_step(here / "none") is None and restarts.restart_step(here) is None


def test_a_restart_file_of_the_end_is_not_taken(slope, here):
    """LAMMPS would go on beyond the step at which fix halt had ended the run."""
    deck = here / "case" / "in.tiny"
    deck.write_text(deck.read_text().replace("thermo      50", "variable now equal step\n"
                                             "fix rest all halt 100 v_now >= 600 error continue\nthermo 50"))
    assert slope(arguments())[0] == 0
    before = numbers(here / "out" / FOLDER)
    assert before["stop: step"] == 600 and restarts.restarts(here / "out" / FOLDER)[0][0] == 600
    (here / "out" / FOLDER / "finished.yaml").unlink()      # killed before it was written
    status, told, err = slope(arguments())
    assert status == 0 and f"continues at step 500, from out/{FOLDER}/tiny.1.restart" in told, err
    assert_same(before, numbers(here / "out" / FOLDER))


# --- another run ---

@pytest.mark.parametrize("change, why", [
    (lambda cut: edit("case/in.tiny", "restitution 0.1", "restitution 0.2"), "it was started with another in.tiny"),
    (lambda cut: edit("case/terrain.asc", "8.0000 8.0000\n", "8.0000 8.1000\n"),
     "it was started with another terrain.asc"),
    (lambda cut: edit(cut / "variables.yaml", "LAMMPS program: ", "LAMMPS program: 0"),
     "it was started with another LAMMPS program"),
    (lambda cut: edit(cut / "terrain.asc", "8.0000 8.0000\n", "8.0000 8.1000\n"),     # the copy that it would read
     "it was started with another terrain.asc"),
    (lambda cut: (edit("case/in.tiny", "read_restart ${restart}", "read_restart none"),
                  edit(cut / "in.tiny", "read_restart ${restart}", "read_restart none")),
     "in.tiny has no read_restart ${restart}"),
])
def test_a_run_of_something_else_starts_anew(slope, here, cut, change, why):
    (cut / "rubbish").write_text("of the run that was cut\n")
    change(cut)
    status, told, err = slope(arguments())
    assert status == 0, err
    assert f"[1/1] {FOLDER}: starts again: {why}\n" in told
    assert not (cut / "rubbish").exists()


def test_what_the_run_does_not_name_may_change(slope, here, cut):
    (here / "case" / "notes.txt").write_text("not named by the deck\n")
    edit(cut / "variables.yaml", "package: ", "package: x")     # of a commit that changed no program
    assert f"{FOLDER}: continues at step 500" in slope(arguments())[1]


# --- the case of the package ---

def test_the_embankment_can_be_continued(here):
    case = TOP / "inputs" / "20_embankment"

    def run(folder, *more):
        folder.mkdir()
        for name in ("in.embankment", "terrain.asc"):
            (folder / name).write_text((case / name).read_text())
        words = ["-var", "rule", "ours", "-var", "d", "4", "-var", "out", "tiny", "-var", "duration"]
        return subprocess.run([LMP, "-in", "in.embankment", *words, *more], cwd=folder, check=False,
                              capture_output=True, text=True)

    assert jobs.CONTINUES in (case / "in.embankment").read_text()
    assert run(here / "whole", "2.2").returncode == 0
    (here / "tiny.restart").write_bytes((here / "whole" / "tiny.2.restart").read_bytes())
    assert restarts.restarts(here / "whole")[1:] == [(1800, here / "whole" / "tiny.2.restart"),
                                                     (900, here / "whole" / "tiny.1.restart")]
    done = run(here / "part", "2.2", "-var", "restart", "../tiny.restart")
    assert done.returncode == 0, done.stdout
    assert_same(numbers(here / "whole"), numbers(here / "part"))


def test_a_run_that_is_made_anew_tells_its_own_error(slope, here):
    deck = here / "case" / "in.tiny"
    whole = deck.read_text()
    for command in ("first_nonsense 1 2 3 4 5 6 7 8 9", "second_nonsense"):     # the second log is the shorter one
        deck.write_text(whole.replace("thermo      50\n", f"{command}\n"))
        status, out, err = slope(arguments())
        assert status == 2 and f"Unknown command: {command}" in err, err
    assert "starts again: it was started with another in.tiny" in out
