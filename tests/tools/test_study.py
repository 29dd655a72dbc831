"""tools/slope study: the product of variables, resuming, failing runs; table and maps against the runs' own files."""
import functools
import os
import pty
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import rasterio
import yaml
from shapely.geometry import Polygon

from run_helpers import called, examples, slope as slope_in
from tiny_collapse import LMP, TOP, edit, processes_in, read_asc, rows_of, serial, write_case

from slope_tools.case import decks, logs, run_folders, settings
from slope_tools.releases import release_toe
from slope_tools.runs import job_display, jobs
from slope_tools.statistics import rounding
from slope_tools.studies import body_depth, study
from slope_tools.survey import rasters

TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
MM = 0.0005 + 1e-9          # .asc maps are in whole mm
PROGRAM = [sys.executable, str(TOOLS / "slope")]


@pytest.fixture
def here(tiny_case):
    return tiny_case


@pytest.fixture
def slope(here, capsys):
    """Run `slope study ARGUMENTS` in the test's folder; gives status, stdout, stderr."""
    def run(arguments):
        if re.search(r"--np [2-9]", arguments) and serial():
            pytest.skip("LMP is serial: built with BUILD_MPI=OFF")
        return called(capsys, ["study", *shlex.split(arguments)])
    return run


def summary_of(folder):
    return yaml.safe_load(next(Path(folder).glob("*.summary.yaml")).read_text())


def fake_lmp(path, body):
    """A program in place of lmp, which leaves what one leaves; body: shell commands before that."""
    Path(path).write_text(f"#!/bin/bash\n{body}\ncp {shlex.quote(str(Path('kept').absolute()))}/tiny.* .\n")
    Path(path).chmod(0o755)
    return Path(path).absolute()


@pytest.fixture
def kept(here, slope):
    """Outputs of one real run in the folder kept, for fake_lmp."""
    assert slope("case/in.tiny --set rolling=0 -o first")[0] == 0
    os.rename("first/rolling_0", "kept")


def wait_for(condition, what, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.02)


# --- what --set stands for ---

@pytest.mark.parametrize("text, expected", [
    ("0,0.05,0.10", ["0", "0.05", "0.10"]),
    ("0:0.1:0.05", ["0", "0.05", "0.1"]),
    ("0:1:0.1", ["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"]),
    ("0:0.1:0.03", ["0", "0.03", "0.06", "0.09"]),
    ("30:10:-10", ["30", "20", "10"]),
    ("-0.5:0.5:0.5,7", ["-0.5", "0", "0.5", "7"]),
    ("1e-3:2e-3:5e-4", ["0.001", "0.0015", "0.002"]),
    ("5:5:1", ["5"]),
    ("north.asc,south.asc", ["north.asc", "south.asc"]),
    ("a:b:c", ["a:b:c"]),
])
def test_values(text, expected):
    assert settings.parse_setting_values(f"x={text}", text) == expected


def test_the_product_has_a_folder_per_run_with_all_that_it_needs(slope, here):
    (here / "case" / "data").mkdir()
    (here / "case" / "data" / "extra.txt").write_text("extra\n")
    (here / "case" / "unused").mkdir()
    (here / "case" / "unused" / "extra.txt").write_text("extra\n")
    for name in ("log.lammps", "tiny.restart", "old.png", "tiny.00001000.dump", ".hidden"):
        (here / "case" / name).write_text("left by an earlier run\n")
    edit("case/in.tiny", "group       soil", "shell       cat data/extra.txt\ngroup       soil")
    status, out, err = slope("case/in.tiny --set rolling=0,0.1 --set friction=20:40:20 --set steps=50 -o out --jobs 2")
    assert status == 0, err
    names = [f"rolling_{r}_friction_{f}_steps_50" for r in ("0", "0.1") for f in ("20", "40")]
    assert sorted(path.name for path in (here / "out").iterdir() if path.is_dir()) == sorted(names)
    told = [line for line in out.splitlines() if line.startswith("[4/4]")]
    assert told[0] == f"[4/4] {names[3]}: started" and told[1].startswith(f"[4/4] {names[3]}: finished at 0.1 s, wall")
    for name in names:
        folder = here / "out" / name
        files = {path.name for path in folder.iterdir()}
        assert {"in.tiny", "terrain.asc", "road.csv", "data", "variables.yaml", "log.lammps", "screen.txt",
                "finished.yaml", "tiny.summary.yaml", "tiny.thickness.asc"} <= files
        assert not files & {"tiny.restart", "old.png", "tiny.00001000.dump", ".hidden", "unused"}
        assert (folder / "in.tiny").read_bytes() == (here / "case" / "in.tiny").read_bytes()
        about = yaml.safe_load((folder / "variables.yaml").read_text())
        rolling, friction = name.split("_")[1:4:2]
        assert about["set"] == {"rolling": rolling, "friction": friction, "steps": "50"}
        assert about["variables"] == {**about["set"], "cell": "1.0", "out": "tiny", "terrain": "terrain.asc"}
        assert {"package", "lmp_sha256", "command", "started", "ranks"} <= about.keys()
        # the values reached LAMMPS
        log = (folder / "log.lammps").read_text()
        assert re.search(rf"^pair_coeff  1 1 .* friction {friction} rolling {rolling}$", log, re.MULTILINE)
        assert summary_of(folder)["step"] == 50
        assert set(yaml.safe_load((folder / "finished.yaml").read_text())["inputs"]) == {
            "in.tiny", "terrain.asc", "data/extra.txt"}
    assert not list((here / "out").glob(".inputs")) and not list((here / "out").glob(".*.new"))


@pytest.mark.parametrize("words", [
    "out=other", "terrain=a.asc,b.asc", "ranks='2 * *,* * *'", "bulk='region slip,1.9'", "law=none,sds", "steps=10,x"])
def test_values_of_which_the_deck_does_not_say_what_they_are(slope, words):
    """Text where the deck has text, numbers or text where no range is known."""
    edit("case/in.tiny", "variable  kn ", "variable  ranks index *\nvariable  bulk index 6/pi\n"
         "variable  law index none\npair_coeff  2 2 rolling ${law}\nvariable  kn ")
    status, out, err = slope(f"case/in.tiny --set {words} -o out --dry-run")
    assert (status, err) == (0, "") and f"{words.count(',') + 1} run" in out


def test_which_variables_only_name_outputs(here):
    path = Path("names")
    path.write_text("variable out index a\nvariable base index b\nvariable d index 1\nvariable n index 2\n"
                    "fix f all deposit/grid 1 1 cell 1 terrain base output ${out}_${d}\nset group all diameter ${d}\n"
                    "dump d all custom 9 ${out}.dump id\nprint 'this is ${out}, $n'\nwrite_data ${base}.data\n"
                    "read_data ${base}.old\nlog log.$n\nvariable half equal v_d/2\n")
    assert decks.only_in_outputs(path) == {"out", "n"}


def test_dry_run_lists_and_makes_nothing(slope, here):
    status, out, err = slope("case/in.tiny --set rolling=0:0.2:0.1 --set friction=30,35 -o out --dry-run")
    assert (status, err) == (0, "")
    assert out.splitlines()[0] == "rolling_0_friction_30: rolling 0 friction 30, new"
    assert len(out.splitlines()) == 7 and out.endswith("6 runs, 0 of them finished\n")
    assert not (here / "out").exists()


# --- table, yaml and summaries are one ---

@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A study with a road, a terrain with a CRS and mass that leaves the grid; its folder, stdout and stderr."""
    folder = tmp_path_factory.mktemp("finished")
    write_case(folder / "case")
    edit(folder / "case" / "in.tiny", "output ${out}", "output ${out} extent 12 40 0 24")
    terrain = rasters.read_raster(folder / "case" / "terrain.asc")
    rasters.write_asc_local(folder / "case" / "terrain.asc", terrain._replace(
        crs=rasterio.crs.CRS.from_epsg(6677), offset=(-12000.0, 34000.0)), {})
    (folder / "case" / "road.csv").write_text("-11987,34000\n-11983,34000\n-11983,34024\n-11987,34024\n")
    done = slope_in(folder, "study", "case/in.tiny", "--set", "rolling=0,0.3", "--set", "friction=10,30", "--set",
                    "steps=900", "-o", "out", "--road", "case/road.csv", "--mesh", "4", "--exceed", "0.1,0.8,5")
    assert done.returncode == 0, done.stderr
    return folder / "out", done.stdout, done.stderr


def load(folder):
    about = yaml.safe_load((folder / "study.yaml").read_text())
    return about, rows_of(folder / "study.csv")


def test_table_yaml_and_summaries_have_the_same_numbers(finished):
    folder, out, _ = finished
    about, table = load(folder)
    assert [row["run"] for row in table] == [row["run"] for row in about["runs"]]
    assert len(table) == 4 and about["study"]["finished"] == 4
    for row, line in zip(about["runs"], table):
        summary = summary_of(folder / row["run"])
        volume, travel = summary["volume"], summary["travel"]
        expected = {**{f"{key}_m3": volume[key] for key in ("released", "on_grid", "off_grid", "lost", "residual")},
                    "front_m": travel["front"], "reach_angle_deg": travel["reach_angle"],
                    "centroid_m": travel["centroid"], "thickness_m": summary["largest"]["thickness"],
                    "max_thickness_m": summary["largest"]["max_thickness"],
                    "max_speed_m_s": summary["largest"]["max_speed"], "stop_time_s": summary["stop"]["time"]}
        for entry in travel["quantiles"]:
            expected[f"distance_{100 * entry['share']:.0f}_m"] = entry["distance"]
            expected[f"reach_{100 * entry['share']:.0f}_deg"] = entry["reach_angle"]
        assert expected["distance_50_m"] < expected["distance_99_m"] <= travel["farthest"]["distance"] == row["front_m"]
        removal = yaml.safe_load((folder / row["run"] / "volume" / "volume.yaml").read_text())
        expected.update(remove_m3=removal["volume"]["remove"], remove_on_road_m3=removal["volume"]["remove_on_road"],
                        blocked_m=removal["clearing"]["blocked_length"])
        for key, value in expected.items():
            assert row[key] == value and float(line[key]) == value, key
        assert (row["stop_reason"], line["stop_reason"]) == (summary["stop"]["reason"],) * 2
        assert row["moving"] is summary["moving"] and line["moving"] == {True: "yes", False: "no"}[summary["moving"]]
        assert line["at_rest"] == "no" and line["end"].startswith("stopped at its duration; ")
        assert (row["status"], line["status"], line["error"]) == ("finished", "finished", "")
        assert [line[name] for name in ("rolling", "friction", "steps")] == list(row["set"].values())
        assert row["wall_s"] > 0 and row["variables"]["cell"] == "1.0"
        assert rounding.format_rounded(row["remove_m3"], rounding.place_of_digits(row["remove_m3"])) in out
    assert any(row["off_grid_m3"] > 0.1 for row in about["runs"])


def test_volume_beyond_the_road_by_hand(finished):
    """With the balls that left in the west, beyond it, and halves of those at the edge."""
    folder, _, _ = finished
    about, table = load(folder)
    for row, line in zip(about["runs"], table):
        place = folder / row["run"]
        lies = read_asc(place / "tiny.thickness.asc")[:, 0].sum()       # x from 12; road 13 to 17
        left = [one.split(",") for one in (place / "tiny.left.csv").read_text().splitlines()[1:]]
        passed = sum(float(one[1]) for one in left if float(one[3]) < 13)
        assert float(line["beyond_road_m3"]) == pytest.approx(lies + passed, abs=row["off_grid_m3"] + 1e-9)
        assert sum(row[key] for key in ("before_road_m3", "on_road_m3", "beyond_road_m3")) == pytest.approx(
            row["released_m3"], rel=1e-9)
    assert max(row["beyond_road_m3"] for row in about["runs"]) > 0.1


@pytest.mark.parametrize("ring, expected", [
    ([(8, 0), (12, 0), (12, 24), (8, 24)], 4 * 16.0),      # across the body
    ([(0, 0), (6, 0), (6, 24), (0, 24)], 0.0),             # a column of it, its rim
    ([(0, 0), (2, 0), (2, 24), (0, 24)], 0.0),             # beside it
])
def test_a_road_on_the_body(ring, expected):
    """Cells of 2 m, the body's balls of 3 m in every other one of those from 4 to 20 m both ways."""
    raster = rasters.Raster(np.zeros((12, 12)), rasters.Affine(2, 0, 0, 0, -2, 24), None)
    released = np.zeros((12, 12), bool)
    released[2:10, 2:10] = True
    released[3:9:2, 3:9:2] = False
    found = release_toe.on_body(body_depth.body_of(released, raster, 27.0), raster, Polygon(ring),
                                release_toe.rim(27.0, 2.0))
    assert (found.area if found else 0.0) == pytest.approx(expected)


def test_without_repeats_the_largest_volume_is_called_that(finished):
    folder, out, _ = finished
    about, table = load(folder)
    largest = max(float(line["remove_m3"]) for line in table)
    assert largest > 1
    best = about["conservative"]
    assert best["volume_m3"] is None and best["mean_m3"] == best["remove_m3"] == largest
    assert [best[key] for key in ("chance_m3", "scatter_m3", "degrees_of_freedom")] == [None] * 3
    assert best["kind"] == "largest of 4 runs; chance unknown" and best["repeats"] == 1
    assert [line["run"] for line in table if float(line["remove_m3"]) == largest] == [best["run"]]
    # they are cut short: the number is withheld
    assert [one["kind"] for one in best["withheld"]] == ["runs not at rest or failed"]
    assert "not usable as a number to design with:\n  4 of 4 runs" in out and "m3 to remove" not in out
    assert [one["kind"] for one in best["doubts"]].count("no chance") == 1
    ends = {name for name in ("rolling", "friction") if best["set"][name] != "0" and all(
        float(line["remove_m3"]) <= largest for line in table)}
    assert {one["numbers"]["variable"] for one in best["doubts"] if one["kind"] == "end of range"} == ends
    still = sum(line["at_rest"] == "no" for line in table)
    assert still == 4
    assert sum(len(one["runs"]) for one in about["warnings"] if one["kind"] in ("moving", "in motion")) == 4
    for key in ("distance_99_m", "front_m", "thickness_m"):
        assert about["largest"][key]["value"] == max(float(line[key]) for line in table)


def test_envelope_and_exceedance_by_hand(finished):
    folder, _, _ = finished
    about, table = load(folder)
    final = np.array([read_asc(folder / line["run"] / "tiny.thickness.asc") for line in table])
    most = np.array([read_asc(folder / line["run"] / "tiny.max_thickness.asc") for line in table])
    assert final.shape == (4, 24, 28) and not np.array_equal(final[0], final[1])

    def check(entry, expected):
        name = folder / entry["file"]
        assert np.abs(read_asc(name) - expected).max() <= MM
        with rasterio.open(name.with_suffix(".tif")) as tif:
            assert tif.crs.to_epsg() == 6677 and tif.nodata == -9999
            assert tuple(tif.bounds) == (-11988, 34000, -11960, 34024)
            assert np.array_equal(tif.read(1), expected)
        local = rasters.read_asc_local(name)
        assert local.offset == (-12000, 34000) and local.transform.c == 12

    check(about["envelope"]["thickness"], final.max(axis=0))
    check(about["envelope"]["max_thickness"], most.max(axis=0))
    assert about["envelope"]["thickness"]["largest_m"] == final.max()
    assert [entry["threshold_m"] for entry in about["exceedance"]] == [0.1, 0.8, 5.0]
    for entry in about["exceedance"]:
        above = final > entry["threshold_m"]
        check(entry, above.mean(axis=0))
        assert entry["area_in_any_run_m2"] == above.any(axis=0).sum()
        assert entry["area_in_every_run_m2"] == above.all(axis=0).sum()
    shares = {share for entry in about["exceedance"]
              for share in np.unique(read_asc(folder / entry["file"]))}
    assert shares >= {0.0, 0.25, 0.5, 1.0}


@pytest.mark.parametrize("ranks, cells", [(1, "0.7,1,2.5"), (2, "0.7,2.5")])
def test_mass_in_every_run_for_any_cell(slope, here, ranks, cells):
    edit("case/in.tiny", "output ${out}", "output ${out} extent 19 40 2 20.5")
    status, _, err = slope(f"case/in.tiny --set cell={cells} --set friction=10 --set steps=100 -o out --np {ranks}")
    assert status == 0, err
    about, table = load(here / "out")
    for row in about["runs"]:
        summary = summary_of(here / "out" / row["run"])
        volume, cell = summary["volume"], summary["grid"]["cell"]
        assert cell == float(row["set"]["cell"]) and summary["ranks"] == row["ranks"] == ranks
        mass = read_asc(here / "out" / row["run"] / "tiny.thickness.asc").sum() * cell ** 2
        stays = volume["released"] - volume["off_grid"] - volume["lost"]
        assert abs(mass - stays) <= 1e-9 * volume["released"]
        assert volume["off_grid"] > 1
        assert row["mass_error"] == pytest.approx((mass - stays) / volume["released"], abs=1e-12)
    # grids of several sizes: no maps over them, and a word about it
    assert about["envelope"] is None and about["exceedance"] is None
    second = about["runs"][1]["run"]
    assert f"no maps over all runs: the rasters of {second} have another grid than those of cell_0.7_" in err
    assert not list((here / "out").glob("e*.asc"))
    lost, = (one for one in about["warnings"] if one["kind"] in ("lost", "lost much"))
    assert len(lost["runs"]) == lost["numbers"]["of"] == len(table)


def test_a_raster_that_lost_mass_is_told(slope, here):
    assert slope("case/in.tiny --set steps=20 -o out")[0] == 0
    path = here / "out" / "steps_20" / "tiny.thickness.asc"
    lines = path.read_text().splitlines()
    row = next(i for i in range(6, len(lines)) if float(max(lines[i].split(), key=float)) > 0)
    lines[row] = " ".join(["0"] * len(lines[row].split()))
    path.write_text("\n".join(lines) + "\n")
    status, _, err = slope("case/in.tiny --set steps=20 -o out")
    assert status == 0 and "the volume in the thickness raster differs from released" in err


# --- interruptions ---

LONG = ["study", "case/in.tiny", "--set", "steps=2000", "--set", "rolling=0,0.1,0.2", "-o", "out", "--jobs", "1"]


def start_long(here):
    return subprocess.Popen([*PROGRAM, *LONG], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            start_new_session=True,     # by a script in the background nobody can interrupt
                            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))


def print_of(folder):
    """What would change if a run were repeated."""
    return {path.name: (path.stat().st_mtime_ns, path.stat().st_ino) for path in folder.iterdir()
            if path.is_file() and path.name != ".row.json"}        # of what was collected


@pytest.mark.parametrize("how, status", [(signal.SIGKILL, -9), (signal.SIGINT, 130), (signal.SIGTERM, 130)])
def test_resume_after_a_kill(slope, here, how, status):
    out = here / "out"
    process = start_long(here)
    second = out / "steps_2000_rolling_0.1"
    wait_for((second / "log.lammps").exists, "the second run")
    wait_for(lambda: "Step" in (second / "log.lammps").read_text(), "its steps")
    assert processes_in(second)
    process.send_signal(how)
    told, complaint = process.communicate(timeout=20)
    assert process.returncode == status
    wait_for(lambda: not processes_in(out), "the end of the run that was under way", 10)
    assert "Loop time" not in (second / "log.lammps").read_text()       # it did not just come to its end
    if how != signal.SIGKILL:
        assert "stopped with 1 of 3 runs finished; the same command continues" in told
        assert complaint == "slope study: interrupted\n"
    assert (out / "steps_2000_rolling_0" / "finished.yaml").exists()
    assert not (second / "finished.yaml").exists() and not (out / "study.yaml").exists()
    before = print_of(out / "steps_2000_rolling_0")

    state, listed, _ = slope(shlex.join(LONG[1:]) + " --dry-run")
    assert [line.rsplit(", ", 1)[1] for line in listed.splitlines()[:3]] == ["finished", "unfinished", "new"]
    (second / "rubbish").write_text("of the run that was cut\n")
    edit(second / "terrain.asc", "ncols", "broken")
    state, told, complaint = slope(shlex.join(LONG[1:-1]) + " 2")       # two at a time
    assert state == 0, complaint
    assert "1 of 3 runs are finished already" in told
    assert "[1/3]" not in told and "[2/3]" in told and "[3/3]" in told
    assert print_of(out / "steps_2000_rolling_0") == before
    assert not (second / "rubbish").exists()
    assert load(out)[0]["study"]["finished"] == 3
    assert not list(out.glob(".*.old")) and not list(out.glob(".*.new"))


def test_nothing_is_repeated_when_all_is_done_and_values_can_be_added(slope, here):
    assert slope("case/in.tiny --set rolling=0,0.1 --set steps=20 -o out")[0] == 0
    folders = [here / "out" / f"rolling_{value}_steps_20" for value in ("0", "0.1")]
    before = [print_of(folder) for folder in folders]
    status, out, _ = slope("case/in.tiny --set rolling=0,0.1,0.2 --set steps=20 -o out")
    assert status == 0 and "2 of 3 runs are finished already" in out
    assert [print_of(folder) for folder in folders] == before
    assert len(load(here / "out")[1]) == 3


def test_what_the_deck_writes_is_no_data(slope, here):
    """A trial run in the deck's folder leaves it there; the runs begin without it, and go on though it changes."""
    with open("case/in.tiny", "a", encoding="ascii") as deck:
        deck.write("write_restart ${out}.last\nwrite_data end.txt\nprint hello append said.txt\n")
    edit("case/in.tiny", "group       soil", "restart 10 a.1.restart b\ngroup       soil")
    names = ["a.1.restart", "b", "tiny.last", "end.txt", "said.txt"]
    for text in ("trial", "another trial"):
        for name in names:
            (here / "case" / name).write_text(text)
        status, _, err = slope("case/in.tiny --set rolling=0 --set steps=20 -o out")
        assert status == 0, err
    folder = here / "out" / "rolling_0_steps_20"
    assert set(yaml.safe_load((folder / "finished.yaml").read_text())["inputs"]) == {"in.tiny", "terrain.asc"}
    assert (folder / "said.txt").read_text() == "hello\n"


def test_files_that_a_deck_reads_and_writes(here):
    Path("in.files").write_text("""variable out index heap pile
        fix a all wall/gran/balls 2 1 file slip.xyz
        fix b all wall/gran/balls 3 1 surface ground upper write field.xyz
        fix c all wall/gran/balls 3 1 file both.xyz write both.xyz
        fix d all ave/time 1 1 1 v_x file ave.txt
        fix e all print 10 "step" file steps.txt
        restart 100 ${out}.1 $out.2    # a $ with several letters is $o and more
        read_restart first.restart
        dump d all custom 10 ${out}.*.dump id
        write_dump all custom last.txt id\n""")
    read, written = decks.named_files(Path("in.files"))
    assert {"slip.xyz", "both.xyz", "first.restart"} <= read
    assert written == {"field.xyz", "both.xyz", "ave.txt", "steps.txt", "${out}.1", "heap.1", "$out.2", "heap.*.dump",
                       "${out}.*.dump", "last.txt"}


def test_the_terrain_of_a_deck_by_its_variables(here):
    """As LAMMPS fills them in: ${name}, and $x of one letter."""
    deck = Path("case/in.tiny")
    deck.write_text("variable t index terrain\nvariable ending index txt\nregion ground terrain $t.${ending}\n")
    assert study.terrain_of(deck, {}) is None
    assert study.terrain_of(deck, {"ending": "asc"}) == Path("case/terrain.asc")


@pytest.mark.parametrize("path, word", [("a.asc", "a.asc"), ("a b.asc", '"a b.asc"'), ("a\tb.asc", '"a\tb.asc"')])
def test_a_path_is_one_word_of_a_deck(tmp_path, path, word):
    assert decks.quoted(path) == word
    (tmp_path / "in.deck").write_text(f"region ground terrain {word}\n")
    assert decks.commands(tmp_path / "in.deck")[0][3] == path


def test_an_edit_while_the_study_runs_does_not_reach_later_runs(slope, here, kept):
    lmp = fake_lmp("lmp.sh", f"echo '# edited' >> {here}/case/in.tiny")
    deck = (here / "case" / "in.tiny").read_bytes()
    assert slope(f"case/in.tiny --set rolling=0,0.1 -o out --jobs 1 --lmp {lmp}")[0] == 0
    assert all((here / "out" / f"rolling_{value}" / "in.tiny").read_bytes() == deck for value in ("0", "0.1"))


def test_two_studies_do_not_share_a_folder(slope, here, kept):
    lmp = fake_lmp("lmp.sh", "touch began; while [ ! -e ../../go ]; do sleep 0.05; done")
    first = subprocess.Popen([*PROGRAM, "study", "case/in.tiny", "--set", "rolling=0", "-o", "out", "--lmp", str(lmp)],
                             stdout=subprocess.DEVNULL)
    wait_for((here / "out" / "rolling_0" / "began").exists, "the first study")
    assert slope(f"case/in.tiny --set rolling=0.1 -o out --lmp {lmp}")[::2] == (
        2, "slope study: out: must not be in use by another study: wait for it, or end it\n")
    (here / "go").touch()
    assert first.wait(20) == 0


# --- runs that fail ---

def test_a_failing_run_is_told_and_the_others_go_on(slope, here):
    shutil.copy("case/terrain.asc", "case/same.asc")
    status, out, err = slope("case/in.tiny --set terrain=terrain.asc,none.asc,same.asc --set steps=20 -o out")
    assert status == 2
    assert err.splitlines()[-1].startswith(
        "slope study: out: 1 of 3 runs failed: terrain_none.asc_steps_20: ERROR: Region terrain: ")
    assert err.endswith("(ended with status 1; see out/terrain_none.asc_steps_20/log.lammps)\n")
    assert "[2/3] terrain_none.asc_steps_20: failed: ERROR: Region terrain" in out
    about, table = load(here / "out")
    assert [line["status"] for line in table] == ["finished", "failed", "finished"]
    assert "none.asc" in table[1]["error"] and table[1]["released_m3"] == ""
    assert about["study"]["finished"] == 2 and about["exceedance"][0]["area_in_every_run_m2"] > 0
    # it is tried again, and only it
    edit(here / "out" / "terrain_terrain.asc_steps_20" / "variables.yaml", "package:", "kept: true\npackage:")
    assert slope("case/in.tiny --set terrain=terrain.asc,none.asc,same.asc --set steps=20 -o out")[0] == 2
    assert "kept: true" in (here / "out" / "terrain_terrain.asc_steps_20" / "variables.yaml").read_text()


@pytest.mark.parametrize("body, message", [
    ("exit 3", "no word in its log (ended with status 3; see out/rolling_0/screen.txt)"),
    ("touch log.lammps; exit 3", "no word in its log (ended with status 3; see out/rolling_0/log.lammps)"),
    ("echo 'mpirun was unable to launch'; exit 1", "mpirun was unable to launch (ended with status 1"),
    ("echo 'ERROR on proc 1: lost (src/pair.cpp:12)'; exit 1", "ERROR on proc 1: lost (ended with status 1"),
    ("echo 'ERROR: bad (src/a/pair.cpp:12)' > log.lammps; kill -SEGV $$", "ERROR: bad (ended by SIGSEGV"),
    ("exit 0", "no word in its log (lmp ended with status 0, but left no complete run"),
    ("echo 'step: 3' > tiny.summary.yaml; exit 0", "out/rolling_0/tiny.summary.yaml: must be a summary that fix "
                                                   "deposit/grid wrote: must have volume"),
])
def test_how_a_run_failed(slope, here, body, message):
    Path("lmp.sh").write_text(f"#!/bin/bash\n{body}\n")
    Path("lmp.sh").chmod(0o755)
    status, _, err = slope("case/in.tiny --set rolling=0 -o out --lmp ./lmp.sh")
    assert status == 2 and err.splitlines()[-1].startswith(
        f"slope study: out: 1 of 1 runs failed: rolling_0: {message}")
    assert not (here / "out" / "rolling_0" / "finished.yaml").exists()
    assert [line["status"] for line in load(here / "out")[1]] == ["failed"]


def test_a_run_that_fails_at_its_very_end_is_not_finished(slope, here):
    deck = here / "case" / "in.tiny"
    deck.write_text(deck.read_text() + "nonsense\n")
    status, _, err = slope("case/in.tiny --set steps=20 -o out")
    assert status == 2 and "steps_20: ERROR: Unknown command: nonsense (ended with status 1" in err
    assert (here / "out" / "steps_20" / "tiny.summary.yaml").exists()
    assert not (here / "out" / "steps_20" / "finished.yaml").exists()


def test_warnings_of_the_logs_are_kept(slope, here):
    edit("case/in.tiny", "timestep    0.002", "timestep    0.004")
    assert slope("case/in.tiny --set steps=20 -o out")[0] == 0
    row = load(here / "out")[0]["runs"][0]
    removed, step = row["log_warnings"]
    assert removed.startswith("Delete_balls: 46 % of the volume ")
    assert step.startswith("Pair gran/restitution: time step 0.004 s is ")


# --- progress ---

LOG = """\
LAMMPS (29 Sep 2021 - Update 2)
region ground terrain ${where} depth 8
region ground terrain dem.asc depth 8
WARNING: Something is odd (src/some.cpp:77)
run         ${steps}
run         200
Pair gran/restitution: contact coefficients (lightest balls of each type pair)
  types    kn N/m
  1   1    1e+05
Per MPI rank memory allocation (min/avg/max) = 6.1 | 6.1 | 6.1 Mbytes
   Step          Time          Atoms          KinEng
        50   0.1            351            0
WARNING: Something is odd (src/some.cpp:77)
       100   0.2            351            1.5e3
"""


def test_the_log_is_read_as_it_grows(tmp_path):
    path = tmp_path / "log.lammps"
    log = logs.Log(path)
    assert log.update().step is None
    for i in range(0, len(LOG), 7):
        with open(path, "a", encoding="ascii") as out:
            out.write(LOG[i:i + 7])
        log.update()
    assert (log.step, log.time, log.first, log.last) == (100, 0.2, 50, 250)
    assert log.warnings == ["Something is odd"] and log.terrain == "dem.asc" and log.table[1:] == [
        "  types    kn N/m", "  1   1    1e+05"]
    with open(path, "a", encoding="ascii") as out:
        out.write("Loop time of 1 on 1 procs\nrun 500 upto\n   Step          Time\n       100   0.2\n")
    assert (log.update().last, log.step, log.thermo) == (500, 100, 1)
    with open(path, "a", encoding="ascii") as out:
        out.write("ERROR: Lost atoms: original 3 current 2 (../thermo.cpp:438)\nLast command: run 5\n")
    assert log.update().error == "ERROR: Lost atoms: original 3 current 2"


@pytest.mark.parametrize("lines, density, packed", [
    ("lattice sc 2\ncreate_atoms 1 region body\nset group soil diameter 2 density 3411.4", 3411.4, False),
    ("create_balls 1 ${d} ${density} fill body seed 3\ncreate_balls 1 2 2977 fill body seed 3\n"
     "Create_balls: 351 balls of diameter 2 fill region body, packing 3", 2977, True),
    ("create_balls 2 2 2977 surface ground upper spacing 2\n"
     "Create_balls: 351 fixed balls of diameter 2 (351 on the plan grid every 2", None, False)])
def test_the_log_tells_how_the_balls_begin(tmp_path, lines, density, packed):
    path = tmp_path / "log.lammps"
    path.write_text(f"{LOG}{lines}\n")
    log = logs.Log(path).update()
    assert log.density == density and logs.packed(log.notes) == packed


def test_a_terminal_gets_a_live_display(here):
    leader, follower = pty.openpty()
    process = subprocess.Popen([*PROGRAM, "study", "case/in.tiny", "--set", "steps=7000", "--set", "rolling=0,0.1",
                                "-o", "out", "--jobs", "1"], stdout=subprocess.DEVNULL, stderr=follower,
                               env={**os.environ, "TERM": "xterm", "COLUMNS": "120"})
    os.close(follower)
    shown = b""
    while True:
        try:
            part = os.read(leader, 65536)
        except OSError:
            break
        if not part:
            break
        shown += part
    os.close(leader)
    assert process.wait(20) == 0
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.decode())
    assert re.search(r"\[1/2\] rolling 0 .*step \d+ of 7000, \d+\.\d\d s +\d\d:\d\d:\d\d", text)
    assert "[1/2] steps_7000_rolling_0: finished at 14.0 s, wall time" in text
    assert "0 of 2 finished" in text and "1 waiting" in text


def test_lines_now_and_then_without_a_terminal(slope, here, monkeypatch):
    monkeypatch.setattr(job_display, "TELL", 0.05)
    status, out, _ = slope("case/in.tiny --set steps=14000 -o out")
    assert status == 0
    assert re.search(r"^\[1/1\] steps_14000: step \d+ of 14000, \d+\.\d\d s, ends by \d\d:\d\d:\d\d$", out,
                     re.MULTILINE)


# --- bad input: one line, status 2, nothing made ---

def deck(change):
    return lambda: Path("case/in.tiny").write_text(change(Path("case/in.tiny").read_text()))


def nothing():
    pass


OK = "case/in.tiny --set rolling=0 -o out"
BAD = {
    "out of range": (nothing, "case/in.tiny --set friction=20,95 -o out",
                     "--set: friction must stay within the deck's range, >= 0 and < 90, got friction=20,95"),
    "out of range, dry": (nothing, "case/in.tiny --set cell=0 -o out --dry-run",
                          "--set: cell must stay within the deck's range, > 0, got cell=0"),
    "infinite": (nothing, "case/in.tiny --set rolling=inf -o out", "--set: rolling must be a number, >= 0, got roll"),
    "no number": (nothing, "case/in.tiny --set rolling=0,a -o out", "--set: rolling must be a number, >= 0, got roll"),
    "stated range": (deck(lambda text: "variable xoffset index 0 # 0 <= offset < 1\n" + text),
                     "case/in.tiny --set rolling=0 --repeat xoffset=0.5,1 -o out",
                     "--repeat: xoffset must stay within the deck's range, >= 0 and < 1, got xoffset=0.5,1"),
    "names of files": (nothing, "case/in.tiny --set out=a,b -o out --dry-run",
                       "--set: must not vary out, which only names the files that a run writes"),
    "volumes without an intensity": (nothing, OK + " --road case/road.csv --more-than 5 --dry-run",
                                     "--more-than: needs an intensity"),
    "volumes without a road": (deck(lambda text: "variable peak index 1\n" + text),
                               "case/in.tiny --set peak=1,2 -o out --more-than 5,10",
                               "--more-than: needs an intensity"),
    "unknown variable": (nothing, "case/in.tiny --set colour=1 -o out",
                         "--set: must name an index variable of case/in.tiny (cell, friction, out, rolling, steps, "
                         "terrain), got colour"),
    "not an index variable": (nothing, "case/in.tiny --set kn=1 -o out", "--set: must name an index variable of "
                              "case/in.tiny (cell, friction, out, rolling, steps, terrain), got kn of style equal"),
    "no variables": (deck(lambda text: text.replace(" index ", " string ")), OK,
                     "--set: must name an index variable of case/in.tiny (none), got rolling of style string"),
    "no equals": (nothing, "case/in.tiny --set rolling -o out", "--set: must be NAME=V1,V2,... or NAME=A:B:STEP"),
    "no value": (nothing, "case/in.tiny --set rolling=0,,1 -o out", "--set: must have no empty value"),
    "twice": (nothing, "case/in.tiny --set rolling=0 --set rolling=1 -o out", "--set: must name a variable once"),
    "value twice": (nothing, "case/in.tiny --set rolling=0.1,0.10 -o out",
                    "--set: must have every value once, got rolling=0.1,0.10 with 0.10 twice"),
    "range without way": (nothing, "case/in.tiny --set rolling=0:1:-1 -o out", "--set: A:B:STEP must have a STEP that"),
    "range without step": (nothing, "case/in.tiny --set rolling=0:1:0 -o out", "--set: A:B:STEP must have a STEP that"),
    "range of nan": (nothing, "case/in.tiny --set rolling=0:nan:1 -o out", "--set: A:B:STEP must have a STEP that"),
    "huge range": (nothing, "case/in.tiny --set rolling=0:1:1e-9 -o out", "--set: must make at most 10000 runs"),
    "huge product": (nothing, "case/in.tiny --set rolling=0:1:0.001 --set friction=0:80:1 -o out",
                     "--set: must make at most 10000 runs, got 81081"),
    "no deck": (nothing, "case/in.none --set rolling=0 -o out", "case/in.none: must be a LAMMPS input deck (No such"),
    "deck is a folder": (nothing, "case --set rolling=0 -o out", "case: must be a LAMMPS input deck (Is a directory"),
    "no deposit": (deck(lambda text: text.replace("deposit/grid", "nve/none")), OK,
                   "case/in.tiny: must have one fix deposit/grid, which gives the deposit, got 0"),
    "data above": (deck(lambda text: text.replace("index terrain.asc", "index ../dem.asc")), OK,
                   "case/in.tiny: must find its data in its own folder (a symbolic link will do) or by an absolute "
                   "path, got ../dem.asc"),
    "output is a file": (lambda: Path("out").write_text(""), OK, "-o: must be a folder, got out"),
    "output is the deck's": (nothing, "case/in.tiny --set rolling=0 -o case", "-o: must not be the folder of the deck"),
    "lmp": (nothing, OK + " --lmp none/lmp", "--lmp: must lead to the LAMMPS program, got "),
    "thresholds": (nothing, OK + " --exceed 0.1,x", "--exceed: must be different thicknesses >= 0, with commas"),
    "thresholds twice": (nothing, OK + " --exceed 1,1", "--exceed: must be different thicknesses >= 0, with commas"),
    "output below a file": (lambda: Path("file").write_text(""), "case/in.tiny --set rolling=0 -o file/out",
                            "file/out: cannot be used: Not a directory"),
    "no road": (nothing, OK + " --road none.csv", "--road: must be an existing file, got none.csv"),
    "road elsewhere": (lambda: Path("far.csv").write_text("100,0\n110,0\n110,10\n"), OK + " --road far.csv",
                       "far.csv: must overlap the terrain, local x y 0 0 40 24"),
    "cut angle": (nothing, OK + " --road case/road.csv --cut-angle 90", "--cut-angle: must be > 0 and < 90 degrees"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line_and_leaves_no_trace(slope, here, name):
    make, arguments, message = BAD[name]
    Path("dem.asc").write_text(Path("case/terrain.asc").read_text())
    make()
    before = sorted(str(path) for path in here.rglob("*"))
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1
    assert err.startswith(f"slope study: {message}")
    assert sorted(str(path) for path in here.rglob("*")) == before


def test_lmp_from_the_environment(slope, here, monkeypatch):
    monkeypatch.setenv("LMP", "nowhere/lmp")
    status, _, err = slope(OK)
    assert status == 2 and err.startswith("slope study: LMP in the environment: must lead to the LAMMPS program, got ")
    assert not (here / "out").exists()


@pytest.mark.parametrize("command", [one for one in examples("study") if one.startswith("inputs")])    # or of a site
def test_every_example_of_the_page_and_the_help_runs(slope, here, command):
    """On a deck of this test with the variables and files that the examples name, and no more than 20 steps."""
    folder = here / "inputs" / "20_embankment"
    folder.parent.mkdir()
    (here / "case").rename(folder)
    (folder / "in.tiny").rename(folder / "in.embankment")
    edit(folder / "in.embankment", "index 150", "index 20")
    edit(folder / "in.embankment", "variable  kn", "variable  d index 1\nvariable  xoffset index 0\nvariable  "
         "spacing index 1\nvariable  kn")
    command = command.replace("--sample 100", "--sample 6")
    if "--engine slurm" in command:     # test_slurm.py has a cluster
        command = command.replace("srun", "sh") + " --dry-run"
    (here / "road.csv").write_text((folder / "road.csv").read_text())
    status, _, err = slope(command)
    assert status == 0, err


@pytest.mark.parametrize("times", [1, 2])
def test_a_launch_that_failed_is_made_again_once(slope, here, monkeypatch, times):
    """As that of Open MPI 4, now and then, when two programs start at once."""
    program = here / "lmp"
    program.write_text(f"""#!/bin/sh
count=$(cat {here}/count 2>/dev/null || echo 0)
echo $((count + 1)) > {here}/count
for one in $OMPI_MCA_orte_tmpdir_base $TMPDIR $OMPI_MCA_btl_sm_backing_directory; do echo $one; done >> {here}/sessions
if [ $count -lt {times} ]; then
  echo '[host:4711] [[1,0],0] ORTE_ERROR_LOG: Error in file orte_init.c: orte_session_dir failed, File exists'
  exit 213
fi
exec {LMP} "$@"
""")
    program.chmod(0o755)
    monkeypatch.setenv("LMP", str(program))
    monkeypatch.delenv("OMPI_MCA_orte_tmpdir_base", raising=False)
    status, out, err = slope("case/in.tiny --set rolling=0 --set steps=20 -o out")
    assert status == (0 if times == 1 else 2), err
    assert "its launch failed once: [host:4711]" in out and (here / "count").read_text() == "2\n"
    sessions = (here / "sessions").read_text().split()      # for Open MPI 4, and two for later ones
    assert len(sessions) == 6 and len(set(sessions)) == 2 and not any(Path(one).exists() for one in sessions)


@pytest.mark.parametrize("busy, program, ranks", [
    (0, "", 2), (1, "", 1), (0, "[ $OMPI_COMM_WORLD_SIZE ] && exit 1", 1)])
def test_a_run_that_is_alone_has_all_cores(slope, here, monkeypatch, busy, program, ranks):
    """Unless others want them, or the program cannot have them."""
    if serial():
        pytest.skip("the program has no MPI")
    (here / "lmp").write_text(f'#!/bin/sh\n{program}\nexec {LMP} "$@"\n')
    (here / "lmp").chmod(0o755)
    monkeypatch.setenv("LMP", str(here / "lmp"))
    for name, value in (("busy", busy), ("cores", 2)):
        monkeypatch.setattr(jobs, name, lambda value=value: value)
    monkeypatch.setattr(jobs.Work, "do", functools.partialmethod(jobs.Work.do, share=True))
    status, _, err = slope("case/in.tiny --set rolling=0 --set steps=20 -o out")
    assert status == 0, err
    [made] = (here / "out").rglob(run_folders.VARIABLES)
    assert run_folders.begun(made.parent)["ranks"] == ranks


def test_a_program_that_fails_by_itself_is_not_started_again(slope, here, monkeypatch):
    program = here / "lmp"
    program.write_text(f"#!/bin/sh\necho x >> {here}/count\necho no such library\nexit 1\n")
    program.chmod(0o755)
    monkeypatch.setenv("LMP", str(program))
    assert slope("case/in.tiny --set rolling=0 --set steps=20 -o out")[0] == 2
    assert (here / "count").read_text() == "x\n"
