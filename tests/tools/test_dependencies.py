"""tools/slope study: what a run depends on; a run, finished or not, of anything else is not taken over."""
import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

from run_helpers import called, write_sidecar
from tiny_collapse import LMP, edit, read_asc, write_stl

from slope_tools.case import decks
from slope_tools.runs import dependencies

RUN = "out/rolling_0_steps_10"


@pytest.fixture
def here(tiny_case):
    return tiny_case


@pytest.fixture
def slope(here, capsys):
    """Run the study of one run; gives status, stdout, stderr."""
    def run(more=""):
        return called(capsys, ["study", *shlex.split(f"case/in.tiny --set rolling=0 --set steps=10 -o out {more}")])
    return run


def higher(path):
    edit(path, "8.0000 8.0000\n", "8.0000 8.1000\n")


def in_deck(old, new):
    edit("case/in.tiny", old, new)


def replace_terrain_by(word):
    in_deck("region      ground terrain ${terrain}", f"region      ground terrain {word}")
    in_deck("index terrain.asc", "index none")


def dot():
    replace_terrain_by("./terrain.asc")
    return lambda: higher("case/terrain.asc")


def in_quotes():
    replace_terrain_by("'terrain.asc'")
    return lambda: higher("case/terrain.asc")


def with_spaces():
    Path("case/terrain.asc").rename("case/my terrain.asc")
    replace_terrain_by('"my terrain.asc"')
    return lambda: higher("case/my terrain.asc")


def absolute():
    Path("data").mkdir()
    shutil.move("case/terrain.asc", "data/dem.asc")
    replace_terrain_by(Path("data/dem.asc").absolute())
    return lambda: higher("data/dem.asc")


def sidecar_of_absolute():
    absolute()
    return lambda: Path("data/dem.prj").write_text("of another zone")


def composed():
    """The name is made of variables, one of which names the other."""
    absolute()
    in_deck(str(Path("data/dem.asc").absolute()), "${whole}")
    in_deck("units       si", f"variable where string {Path('data').absolute()}\nvariable n equal 1\n"
                              "variable whole string ${where}/dem.asc\nunits       si")
    return lambda: higher("data/dem.asc")


def computed():
    """The name is known to LAMMPS alone."""
    shutil.move("case/terrain.asc", "case/dem2.asc")
    replace_terrain_by("dem$(1+1).asc")
    return lambda: higher("case/dem2.asc")


def computed_absolute():
    absolute()
    shutil.move("data/dem.asc", "data/dem2.asc")
    in_deck(str(Path("data/dem.asc").absolute()), f"{Path('data').absolute()}/dem$(1+1).asc")
    return lambda: higher("data/dem2.asc")


def link():
    """A symbolic link in the deck's folder, which then leads elsewhere."""
    Path("data").mkdir()
    shutil.move("case/terrain.asc", "data/old.asc")
    shutil.copy("data/old.asc", "data/new.asc")
    higher("data/new.asc")
    os.symlink("../data/old.asc", "case/terrain.asc")

    def change():
        Path("case/terrain.asc").unlink()
        os.symlink("../data/new.asc", "case/terrain.asc")
    return change


def write_yaml(crs):
    z = read_asc("case/terrain.asc")
    write_sidecar(*z.shape, 1.0, "sidecar.asc", crs=crs)
    shutil.move("sidecar.yaml", "case/terrain.yaml")


def sidecar():
    write_yaml("EPSG:6677")
    return lambda: write_yaml("EPSG:6678")


def new_sidecar():
    return lambda: write_yaml("EPSG:6677")


def included():
    Path("case/more.lmp").write_text("timestep 0.002\n")
    in_deck("timestep    0.002", "variable more string more\ninclude ./${more}.lmp")
    return lambda: edit("case/more.lmp", "0.002", "0.001")


def mesh():
    write_stl("case/house.stl", (2, 10, 0), (4, 14, 3))
    in_deck("neighbor    0.2", "fix house soil wall/gran/mesh 3 'house.stl'\nneighbor    0.2")
    return lambda: write_stl("case/house.stl", (2, 10, 0), (4, 14, 4))


def environment():
    os.environ["SLOPE_TEST_G"] = "9.8"
    in_deck("gravity 9.80665", "gravity ${g}")
    in_deck("units       si", "variable g getenv SLOPE_TEST_G\nunits       si")
    return lambda: os.environ.update(SLOPE_TEST_G="9.7")


def asks_for_it():
    """The deck asks whether a file is there, and it was not."""
    in_deck("timestep    0.002", 'if "$(is_file(fine.txt))" then "timestep 0.001" else "timestep 0.002"')
    return lambda: Path("case/fine.txt").write_text("there\n")


def read_and_overwritten():
    in_deck("timestep    0.002", "include dt.txt")
    Path("case/dt.txt").write_text("timestep 0.002\n")
    with open("case/in.tiny", "a", encoding="ascii") as deck:
        deck.write("shell cp in.tiny dt.txt\n")
    return lambda: edit("case/dt.txt", "0.002", "0.001")


CHANGES = [dot, in_quotes, with_spaces, absolute, sidecar_of_absolute, composed, computed, computed_absolute, link,
           sidecar, new_sidecar, included, mesh, environment, asks_for_it, read_and_overwritten]


@pytest.mark.parametrize("make", CHANGES)
def test_a_finished_run_of_another_input_is_not_taken(slope, succeed, here, monkeypatch, make):
    monkeypatch.setenv("SLOPE_TEST_G", "")      # restored afterwards
    change = make()
    succeed()
    status, told, err = slope()
    assert status == 0 and "1 of 1 runs are finished already" in told, err
    change()
    for more in ("", "--dry-run"):
        status, _, err = slope(more)
        assert status == 2 and re.match(f"slope study: {RUN}: was run with another ", err), (more, err)


# --- the program ---

def shared(here, monkeypatch):
    """A program that needs a library of its own: LAMMPS, with one that is loaded before it."""
    source = here / "extra.c"
    source.write_text("int slope_extra(void) { return 1; }\n")
    compile_(source, here / "libextra.so")
    monkeypatch.setenv("LD_PRELOAD", str(here / "libextra.so"))
    return source


def compile_(source, target):
    if not shutil.which("cc"):
        pytest.skip("no C compiler")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", str(target), str(source)], check=True)


def test_a_finished_run_of_another_program_is_not_taken(slope, here, monkeypatch):
    shutil.copy(LMP, "lmp")
    monkeypatch.setenv("LMP", str(here / "lmp"))
    assert slope()[0] == 0
    with open("lmp", "ab") as program:
        program.write(b"0")
    for more in ("", "--dry-run"):
        assert slope(more)[::2] == (2, f"slope study: {RUN}: was run with another LAMMPS program than the present one: "
                                    "--anew makes it again, with all others of which that holds\n")


def test_a_finished_run_of_another_library_is_not_taken(slope, here, monkeypatch):
    source = shared(here, monkeypatch)
    assert slope()[0] == 0
    assert "finished already" in slope()[1]
    source.write_text("int slope_extra(void) { return 2; }\n")
    compile_(source, here / "libextra.so")
    status, _, err = slope()
    assert status == 2 and "was run with another libextra.so than the present one" in err


def test_plugins_count(here, monkeypatch):
    """Those that LAMMPS loads by itself, and one that a deck loads by its bare name."""
    source = here / "one.c"
    source.write_text("int one(void) { return 1; }\n")
    compile_(source, here / "oneplugin.so")
    before = dependencies.program(Path(LMP))
    monkeypatch.setenv("LAMMPS_PLUGIN_PATH", str(here))
    assert set(dependencies.program(Path(LMP))) - set(before) == {"oneplugin.so"}
    monkeypatch.setenv("LD_LIBRARY_PATH", f"/nowhere:{here}")
    assert set(dependencies.outside("plugin\nload\noneplugin.so", here / "run")) == {str(here / "oneplugin.so")}


def test_a_script_has_no_libraries(here):
    (here / "lmp").write_text("#!/bin/sh\n")
    assert set(dependencies.program(here / "lmp")) == {"LAMMPS program"}


# --- what does not count ---

def test_what_a_run_does_not_read_may_change(slope, here, monkeypatch):
    assert slope()[0] == 0
    before = yaml.safe_load((here / RUN / "finished.yaml").read_text())
    assert set(before["inputs"]) == {"in.tiny", "terrain.asc"} and before["environment"] == {}
    edit("case/road.csv", "8,0", "9,0")
    Path("case/terrain.md").write_text("about the terrain\n")
    in_deck("group       soil type 1", "# a comment alone\ngroup   soil type 1   # and another")
    monkeypatch.setenv("SLOPE_TEST_G", "1")
    edit(f"{RUN}/variables.yaml", "package: ", "package: x")
    status, told, err = slope()
    assert status == 0 and "1 of 1 runs are finished already" in told, err


def test_a_default_that_a_run_does_not_take_from_the_deck_does_not_count(slope, here):
    """Runs are known by their values, wherever these come from; a run of other ones stays beside them."""
    in_deck("rolling  index 0.0", "rolling  index 0.1")
    assert slope()[0] == 0
    in_deck("rolling  index 0.1", "rolling  index 0.2   # of a list")
    status, told, err = slope()
    assert status == 0 and "1 of 1 runs are finished already" in told, err
    in_deck("friction index 30", "friction index 20")
    status, told, err = slope("--dry-run")
    assert status == 0 and told.endswith("1 run, 0 of them finished\n"), err
    in_deck("friction index 20", "friction index 30")
    assert "1 of 1 runs are finished already" in slope()[1]


def test_a_sidecar_may_name_its_sources_otherwise(slope, here):
    write_yaml("EPSG:6677")
    assert slope()[0] == 0
    path = here / "case" / "terrain.yaml"
    path.write_text(f"# another head\n{path.read_text()}sources:\n- /elsewhere/dem.tif\nsteps: []\n")
    status, told, err = slope()
    assert status == 0 and "1 of 1 runs are finished already" in told, err


@pytest.mark.parametrize("one, other, same", [
    ("run 1 # a\n", "run  1 # b\n\n# c\n", True),
    ("run 1\n", "run 2\n", False),
    ('print "a # b"\n', 'print "a # c"\n', False),
    ('print a" # "b\n', 'print a" # "c\n', False),
    ("# a\nrun 1\n", "# a &\nrun 1\n", False),           # LAMMPS joins the lines first
    ('python f source """\nx = 1 # a\n"""\n', 'python f source """\nx = 1 # b\n"""\n', False)])
def test_comments(here, one, other, same):
    for name, text in (("a", one), ("b", other)):
        Path(name).write_text(text)
    assert (decks.without_comments(Path("a")) == decks.without_comments(Path("b"))) == same
