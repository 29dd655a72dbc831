"""The folder of the runs: each is known by the values of its deck's variables, made once, and again when asked."""
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

from tiny_collapse import LMP

from slope_tools.runs import jobs, store

DECK = Path("case/in.tiny")
LONG = {f"a_variable_with_a_long_name_{k}": "0.123456789" for k in range(8)}


@pytest.fixture
def here(tiny_case):
    return tiny_case


def make(chosen, name=None, deck="in.tiny", done=True, **defaults):
    """A run's folder in out, as one of a study leaves it."""
    folder = Path("out") / (name or jobs.name_run(chosen))
    folder.mkdir(parents=True)
    variables = {"rolling": "0.0", "friction": "30", "cell": "1.0", "steps": "150", "out": "tiny",
                 "terrain": "terrain.asc", **defaults, **chosen}
    (folder / "variables.yaml").write_text(yaml.safe_dump({"deck": deck, "set": chosen, "variables": variables}))
    if done:
        (folder / "finished.yaml").write_text("summary: tiny.summary.yaml\n")
    return folder


def folders(*several, older=()):
    """Where the store puts runs of these values, in one command; nothing that they depend on has changed."""
    depends = SimpleNamespace(deck=DECK, changed=lambda run: None)
    todo = [jobs.Run("out", chosen) for chosen in several]
    store.Store(Path("out"), depends, older).admit(todo)
    assert all(run.name == run.folder.name and run.log.path.parent == run.folder for run in todo)
    return [str(run.folder) for run in todo]


@pytest.mark.parametrize("one, other", [
    ({"rolling": "0.1"}, {"rolling": "0.1", "friction": "30"}),     # the deck's own value
    ({"rolling": "0.10"}, {"friction": "30.0", "rolling": "0.1"})])
def test_runs_of_the_same_values_are_one(here, one, other):
    name = jobs.name_run(one)
    assert folders(one, other) == [f"out/{name}"] * 2
    make(other)
    assert folders(one) == [f"out/{jobs.name_run(other)}"]


@pytest.mark.parametrize("about", [{"friction": "29"}, {"deck": "in.other"}, {"name": ".rolling_0.1_friction_30.new"}])
def test_runs_of_other_values_or_decks_are_not(here, about):
    make({"rolling": "0.1", "friction": about.pop("friction", "30")}, **about)
    assert folders({"rolling": "0.1"}) == ["out/rolling_0.1"]


def test_a_folder_that_one_run_gets_is_no_others(here):
    """A deck whose default has changed: the folder of a name has the values of another run, which stays."""
    make({"rolling": "0.1"}, friction="25")
    one, other = folders({"rolling": "0.1"}, {"friction": "25", "rolling": "0.1"})
    assert re.fullmatch("out/rolling_0.1_[0-9a-f]{6}", one) and other == "out/rolling_0.1"
    make({"rolling": "0.1"}, Path(one).name)
    assert folders({"rolling": "0.1"}) == [one]


def test_a_folder_of_a_deck_with_other_variables_is_looked_at(here):
    """Whether it may be taken over: its values cannot be compared."""
    make({"rolling": "0.1"}, friction="25", more="1")
    assert folders({"rolling": "0.1"}) == ["out/rolling_0.1"]


def test_of_two_folders_the_finished_one_counts(here):
    make({"rolling": "0.1", "friction": "30"}, done=False)
    make({"rolling": "0.1", "cell": "1"})
    assert folders({"rolling": "0.1"}) == ["out/rolling_0.1_cell_1"]


def test_folders_of_older_versions(here):
    make({"rolling": "0.1"})
    Path("out").rename("sizes")
    assert folders({"rolling": "0.1"}, {"rolling": "0.2"}, older=[Path("sizes")]) == [
        "sizes/rolling_0.1", "out/rolling_0.2"]


@pytest.mark.parametrize("prepare", [
    lambda: Path("out/terrain_a-b").mkdir(parents=True),                                # somebody else's
    lambda: make({"terrain": "a-b"}), lambda: make({"terrain": "a-b"}, steps="9")])
def test_a_name_that_is_taken_gets_a_digest(here, prepare):
    prepare()
    [first] = folders({"terrain": "a/b"})
    assert first.startswith("out/terrain_a-b_") and len(first) == len("out/terrain_a-b_") + store.LETTERS
    assert folders({"terrain": "a/b"}) == [first] != folders({"terrain": "a?b"})


def test_two_runs_of_one_name_in_one_study(here):
    one, other = folders({"terrain": "a/b"}, {"terrain": "a?b"})
    assert one == "out/terrain_a-b" and other.startswith("out/terrain_a-b_")


def test_a_long_name_ends_in_a_digest(here):
    [long], [other] = folders(LONG), folders({**LONG, "rolling": "0.1"})
    assert long != other and len(Path(long).name) == store.MOST_LETTERS + 1 + store.LETTERS
    assert Path(long).name.startswith("a_variable_with_a_long_name_0_0.123456789_")


# --- with runs ---

def times(folder):
    return {path: path.stat().st_mtime_ns for path in Path(folder).glob("*/finished.yaml")}


def test_an_analysis_takes_over_the_runs_of_another(slope):
    assert slope("study case/in.tiny --set rolling=0,0.1 --set steps=10 -o out")[0] == 0
    before = times("out")
    status, out, err = slope("sensitivity case/in.tiny --set steps=10 --try rolling=0.1,0.2 --of front_m "
                             "-o out")
    assert status == 0 and "2 of 3 runs are finished already" in out, err
    assert {path: when for path, when in times("out").items() if path in before} == before and len(before) == 2
    runs = [line.split(",")[0] for line in Path("out/sensitivity.csv").read_text().splitlines()[1:]]
    assert runs == ["rolling_0_steps_10", "rolling_0.1_steps_10", "steps_10_rolling_0.2"]


def test_anew_makes_again_what_is_of_another_program(slope, here, monkeypatch):
    """Not the others; and again after it was made: nothing."""
    study = "study case/in.tiny --set steps=10 --set rolling="
    shutil.copy(LMP, "lmp")
    monkeypatch.setenv("LMP", str(here / "lmp"))
    assert slope(f"{study}0,0.1 -o out")[0] == 0
    with open("lmp", "ab") as program:
        program.write(b"0")
    assert slope(f"{study}0.2 -o out")[0] == 0
    before = times("out")
    status, out, err = slope(f"{study}0,0.1,0.2 -o out")
    assert status == 2 and err == ("slope study: out/steps_10_rolling_0: was run with another LAMMPS program than the "
                                   "present one: --anew makes it again, with all others of which that holds\n")
    status, out, err = slope(f"{study}0,0.2 -o out --anew --dry-run")
    assert [line.rpartition(", ")[2] for line in out.splitlines()] == ["made again", "finished", "1 of them finished"]
    assert times("out") == before
    status, out, err = slope(f"{study}0,0.2 -o out --anew")
    assert status == 0 and "[1/2] steps_10_rolling_0: starts again: " in out and "1 of 2 runs are finished" in out, err
    changed = {path.parent.name for path, when in times("out").items() if when != before[path]}
    assert changed == {"steps_10_rolling_0"}
    assert "2 of 2 runs are finished already" in slope(f"{study}0,0.2 -o out")[1]
    assert slope(f"{study}0,0.1 -o out")[0] == 2        # what was not asked for is as it was
