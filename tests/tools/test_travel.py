"""tools/slope travel: distributions by hand, axes, bands over runs, run-out, dumps as LAMMPS writes them, bad input."""
import gzip
import math
import os
from pathlib import Path

import numpy as np
import pytest
import yaml

from run_helpers import examples, warned
from tiny_collapse import rows_of

from slope_tools.deposits import travel


COMMAND = "travel"


@pytest.fixture
def no_picture(monkeypatch):
    monkeypatch.setattr(travel, "draw_travel", lambda path, *_: path.touch())


@pytest.fixture
def travelled(slope, no_picture):
    """Run it; it must succeed; gives travel.yaml."""
    def run(arguments):
        status, _, err = slope(f"{arguments} --overwrite -o out")
        assert status == 0, err
        return yaml.safe_load(Path("out/travel.yaml").read_text())
    return run


def snapshot(places, columns="id type diameter x y z", step=100, first=1, extra="", **values):
    """A snapshot as LAMMPS' dump custom writes it; places: x y z of each ball."""
    rows = []
    for i, (x, y, z) in enumerate(places):
        known = {"id": first + i, "type": 1, "diameter": 0.06, "x": x, "y": y, "z": z, "vx": 0, "vy": 0, "vz": 0,
                 "xu": x + 100, "yu": y + 200, "zu": z, **{key: value[i] for key, value in values.items()}}
        rows.append(" ".join(f"{known.get(name, 0)}" for name in columns.split()))
    return (f"{extra}ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(rows)}\nITEM: BOX BOUNDS ff ff ff\n"
            f"-9 9\n-9 9\n-9 9\nITEM: ATOMS {columns} \n" + "".join(f"{row}\n" for row in rows))


def write(path, places, **options):
    Path(path).write_text(snapshot(places, **options))
    return path


def share(direction, position, column="all"):
    """The share in travel.csv at a position."""
    row, = (row for row in rows_of("out/travel.csv")
            if (row["direction"], float(row["position"])) == (direction, position))
    return float(row[column])


FOUR = [(1, 10, 0), (2, 20, 0), (3, 30, 0), (4, 50, 0)]


# --- one run ---

def test_shares_and_percentiles_by_hand(travelled):
    write("a.dump", FOUR)
    about = travelled("a.dump --along 0 5")
    at = 0, 0.95, 1, 1.5, 2, 3.95, 4, 5
    for column in ("all", "lowest", "median", "highest", "a.dump"):
        assert [share("along", position, column) for position in at] == [0, 0, .25, .25, .5, .75, 1, 1]
    assert [share("across", at) for at in (10, 20, 30, 50)] == [.25, .5, .75, 1]
    along = about["along"]["all"]
    assert (along["min"], along["p50"], along["max"], along["mean"]) == (1, 2.5, 4, 2.5)
    assert along["p25"] == pytest.approx(1.75) and along["sd"] == pytest.approx(math.sqrt(1.25))
    assert about["balls"] == 4 and about["each_run"][0]["step"] == 100 and about["warnings"] == []


@pytest.mark.parametrize("axis, along, across", [
    ("x", "x", "y"), ("y", "y", "-x"), ("0", "x", "y"), ("90", "y", "-x"), ("180", "-x", "-y"), ("-90", "-y", "x"),
    ("450", "y", "-x")])
def test_axes(travelled, axis, along, across):
    write("a.dump", FOUR)
    travelled(f"a.dump --axis {axis}")
    sides = {"x": [1, 2, 3, 4], "y": [10, 20, 30, 50]}
    for name, side in (("along", along), ("across", across)):
        sign = -1 if side[0] == "-" else 1
        assert [float(row[name]) for row in rows_of("out/balls.csv")] == [sign * value for value in sides[side[-1]]]


def test_a_slope_askew_and_its_origin(travelled):
    """On a line at 30 degrees from x, from the origin on: along is the distance, across is 0."""
    way = np.array([math.cos(math.pi / 6), math.sin(math.pi / 6)])
    write("a.dump", [(*(way * r + (5, -7)), 1) for r in (1, 2, 3)])
    about = travelled("a.dump --axis 30 --origin 5 -7")
    assert [about["along"]["all"][key] for key in ("min", "p50", "max")] == pytest.approx([1, 2, 3])
    assert about["across"]["all"]["max"] == pytest.approx(0, abs=1e-8)


def test_limits_leave_no_ball_out_of_the_shares(travelled):
    write("a.dump", FOUR)
    about = travelled("a.dump --along 1.5 3.5")
    assert share("along", 1.5) == 0.25 and share("along", 3.5) == 0.75
    assert about["along"]["all"]["max"] == 4
    assert warned(about)["beyond limits"] == {"option": "--along", "low": 1.5, "high": 3.5, "outside": 2, "balls": 4}


def test_types(travelled):
    write("a.dump", FOUR, type=[1, 2, 3, 2])
    assert travelled("a.dump --type 2")["along"]["all"]["mean"] == 3
    assert travelled("a.dump --type 1 3 7")["along"]["all"]["mean"] == 2


# --- several runs ---

def test_band_over_runs(travelled):
    """Runs with 1, 2 and 4 of 4 balls beyond 0: the band at 0 is from 0 to 0.75, and each run counts the same."""
    for name, beyond, number in (("a", 1, 4), ("b", 2, 4), ("c", 8, 8)):
        write(f"{name}.dump", [(1 if i < beyond else -1, 0, 0) for i in range(number)])
    about = travelled("a.dump b.dump c.dump")
    assert [share("along", 0, name) for name in ("lowest", "median", "highest", "a.dump", "b.dump", "c.dump")] == [
        0, 0.5, 0.75, 0.75, 0.5, 0]
    assert share("along", 0) == pytest.approx(5 / 16)
    assert about["along"]["over_runs"]["mean"] == {"lowest": -0.5, "median": 0, "highest": 1}
    assert about["runs"] == 3 and about["balls"] == 16


def test_the_distribution_of_a_known_one(travelled):
    """Normal deviates: the share at the mean is 1/2, at one deviation 0.841; the band is as wide as chance makes it."""
    random = np.random.default_rng(3)
    for i in range(10):
        write(f"{i}.dump", np.column_stack([random.normal(2, 0.5, 400), random.normal(0, 1, 400), np.zeros(400)]))
    about = travelled(" ".join(f"{i}.dump" for i in range(10)) + " --along 0 4")
    assert share("along", 2) == pytest.approx(0.5, abs=0.03) and share("along", 2.5) == pytest.approx(0.841, abs=0.03)
    assert 0.02 < share("along", 2, "highest") - share("along", 2, "lowest") < 0.2
    assert about["across"]["all"]["sd"] == pytest.approx(1, abs=0.05)


# --- from the start ---

def test_travel_and_run_out(travelled):
    write("start.dump", [(0, 0, 5), (0, 1, 6), (0, 2, 5), (9, 9, 9)])
    # in another order; ball 4 is gone
    Path("rest.dump").write_text(snapshot([(3, 2, 1), (0, 1, 2), (8, 1, 0)], id=[3, 1, 2]))
    about = travelled("rest.dump --start start.dump")
    run, = about["each_run"]
    assert run["missing"] == 1 and warned(about)["missing"]["balls"] == 4
    assert [float(row["travel"]) for row in rows_of("out/balls.csv")] == [1, 8, 3]
    assert [float(row["drop"]) for row in rows_of("out/balls.csv")] == [3, 6, 4]
    assert float(rows_of("out/balls.csv")[1]["angle"]) == pytest.approx(math.degrees(math.atan2(6, 8)))
    assert about["travel"]["all"]["max"] == 8
    # the highest ball was the one that is gone, at 9 9 9; ball 1, at 0 1 2, is farthest from there
    assert [one["share"] for one in run["runout"].pop("quantiles")] == [0.5, 0.9, 0.95, 0.99]
    assert run["runout"] == {"distance": pytest.approx(math.hypot(9, 8)), "drop": 7, "ball": 1,
                             "quantiles_of": "volume",
                             "reach_angle": pytest.approx(math.degrees(math.atan2(7, math.hypot(9, 8))))}


def test_run_out_over_runs(travelled):
    """One start for both; the run-out told is that of the farthest, the angle that of the flattest."""
    write("start.dump", [(0, 0, 4), (1, 0, 2)])
    write("a.dump", [(4, 0, 0), (2, 0, 0)])
    write("b.dump", [(3, 0, 0), (8, 0, 0)])
    about = travelled("a.dump b.dump --start start.dump")
    assert about["runout"]["distance"] == {"lowest": 4, "median": 6, "highest": 8}
    assert about["runout"]["reach_angle"]["lowest"] == pytest.approx(math.degrees(math.atan(0.5)))
    assert [one["runout"]["distance"] for one in about["each_run"]] == [4, 8]


def test_each_run_from_its_own_start(travelled):
    write("start.1.dump", [(0, 0, 4)])
    write("start.2.dump", [(1, 0, 4)])
    write("a.dump", [(4, 0, 0)])
    write("b.dump", [(4, 0, 0)])
    about = travelled("a.dump b.dump --start start.1.dump start.2.dump")
    assert [one["runout"]["distance"] for one in about["each_run"]] == [4, 3]


def test_shares_that_stay_within(travelled, slope):
    """100 balls at 1 to 100 m; the front is one ball's, 99 % are within 99 m. By volume, where the dump has it."""
    start = [(0, 0, 60), *[(0, 0, 0)] * 99]
    write("start.dump", start)
    places = [(k + 1, 0, 30) for k in range(100)]
    write("a.dump", places)
    about = travelled("a.dump --start start.dump")["each_run"][0]["runout"]
    assert about["distance"] == 100 and about["quantiles_of"] == "volume"
    assert [(one["share"], one["distance"]) for one in about["quantiles"]] == [(0.5, 50), (0.9, 90), (0.95, 95),
                                                                               (0.99, 99)]
    assert [one["reach_angle"] for one in about["quantiles"]] == pytest.approx(
        [math.degrees(math.atan(30 / far)) for far in (50, 90, 95, 99)])

    # the last ball has 3 of 102 parts of the volume
    write("b.dump", places, radius=[1] * 99 + [3 ** (1 / 3)], columns="id x y z radius")
    write("c.dump", places, columns="id x y z")
    every = travelled("b.dump --start start.dump")["each_run"][0]["runout"]
    assert [one["distance"] for one in every["quantiles"]] == [51, 92, 97, 100]
    plain = travelled("c.dump --start start.dump")["each_run"][0]["runout"]
    assert plain["quantiles_of"] == "balls" and plain["quantiles"] == about["quantiles"]
    runs = travelled("a.dump b.dump --start start.dump")["runout"]["quantiles"]
    assert runs[1]["share"] == 0.9 and runs[1]["distance"] == {"lowest": 90, "median": 91, "highest": 92}
    status, out, _ = slope("a.dump --start start.dump")
    assert status == 0 and "run-out: 99 % within 99.000 m, reach angle 16.9 degrees\n" in out
    assert "farthest ball: 100.000 m, reach angle 16.7 degrees\n" in out


@pytest.mark.parametrize("columns, of, shares", [
    ("id type diameter x y z", "volume", [9, None, None, None]),        # the one that is gone has 8 of 17 parts
    ("id type x y z", "balls", [5, 9, None, None])])
def test_balls_that_are_gone_went_farthest(travelled, slope, columns, of, shares):
    """Ten balls at 1 to 10 m, of which the last one left; it was twice as large as the others."""
    sizes = [0.06] * 9 + [0.12]
    write("start.dump", [(0, 0, 60), *[(0, 0, 0)] * 9], columns=columns, diameter=sizes)
    write("whole.dump", [(k + 1, 0, 0) for k in range(10)], diameter=sizes)
    write("rest.dump", [(k + 1, 0, 0) for k in range(9)])
    runs = travelled("rest.dump whole.dump --start start.dump")
    one, whole = [run["runout"] for run in runs["each_run"]]
    found = one["quantiles"]
    assert one["quantiles_of"] == of and [share["distance"] for share in found] == shares
    assert found[3]["reach_angle"] is None and found[0]["reach_angle"] is not None
    assert whole["quantiles_of"] == "volume" and whole["quantiles"][3]["distance"] == 10
    assert runs["runout"]["quantiles"][3]["distance"] == {"lowest": 10, "median": None, "highest": None}
    assert runs["runout"]["quantiles"][3]["reach_angle"]["lowest"] is None
    status, out, err = slope("rest.dump --start start.dump")
    assert status == 0 and "run-out: 99 % within an unknown distance: 1 of 10 balls of the start are missing\n" in out
    assert "1 of 10 balls of the start are not there" in err


# --- dumps ---

def test_columns_by_name_and_the_last_snapshot(travelled):
    old = snapshot([(7, 7, 7)], step=0)
    new = snapshot(FOUR, columns="vx z element y id x", step=300, extra="ITEM: UNITS\nsi\nITEM: TIME\n0.5\n")
    Path("a.dump").write_text(old + new)
    about = travelled("a.dump")
    assert about["each_run"][0]["step"] == 300 and about["along"]["all"]["max"] == 4
    with gzip.open("a.dump.gz", "wt") as packed:
        packed.write(old + new)
    assert travelled("a.dump.gz")["along"]["all"] == about["along"]["all"]
    write("u.dump", FOUR, columns="id x y z xu yu zu")
    assert travelled("u.dump")["along"]["all"]["max"] == 104


def test_lines_that_end_as_those_of_windows(slope, no_picture):
    good = Path(write("good.dump", FOUR)).read_bytes()
    Path("windows.dump").write_bytes(b"ITEM: TIMESTEP\r\n0\r\n" + good.replace(b"\n", b"\r\n"))
    slope("good.dump -o good")
    status, _, err = slope("windows.dump -o windows")
    assert (status, err) == (0, "")
    balls = [Path(name, "balls.csv").read_text().replace(f"{name}.dump", "") for name in ("good", "windows")]
    assert balls[0] == balls[1] and balls[0].count("\n") == 5
    Path("word.dump").write_bytes(good.replace(b" 20 ", b" 2O ").replace(b"\n", b"\r\n"))
    assert slope("word.dump")[2] == "slope travel: word.dump: line 11: y must be a finite number, got 2O\n"


def test_moving_balls_are_told(travelled):
    write("a.dump", FOUR, columns="id x y z vx vy vz", vx=[0, 0.05, 0, 0.09], vz=[0, 0, -0.11, 0.09])
    about = travelled("a.dump")
    assert about["each_run"][0]["moving"] == warned(about)["not arrived"]["moving"] == 2


# --- files, bad input ---

@pytest.mark.drawn
def test_files_and_text(slope):
    write("a.dump", FOUR)
    write("b.dump", [(1, 1, 1)])
    status, out, err = slope("a.dump b.dump")
    assert (status, err) == (0, "") and sorted(os.listdir("travel")) == ["balls.csv", "travel.csv", "travel.png",
                                                                         "travel.yaml"]
    assert "5 balls of 2 runs" in out and "along: median 2.000 m (1.000 to 2.500 in the runs)" in out
    assert Path("travel/travel.png").stat().st_size > 5000


def test_one_place_for_all_balls(slope):
    write("a.dump", [(2, 3, 4)] * 3)
    assert slope("a.dump")[0] == 0


@pytest.mark.parametrize("arguments, message", [
    ("good.dump --axis z", "argument --axis: must be x, y or degrees, got 'z'"),
    ("good.dump --axis nan", "argument --axis: must be x, y or degrees, got 'nan'"),
    ("good.dump --along 3 -5", "--along: LO must be < HI, got 3 -5"),
    ("good.dump --across 1 1", "--across: LO must be < HI, got 1 1"),
    ("good.dump --type 4", "good.dump: must have balls of type 4 (--type), got type 1"),
    ("notype.dump --type 4", "notype.dump: must have the column type, for --type"),
    ("good.dump good.dump", "DUMP: must be another one for each run"),
    ("good.dump twice.dump text.dump --start good.dump good.dump",
     "--start: must be one dump, or one for each of the 3 runs, got 2"),
    ("good.dump --start other.dump", "other.dump: must have the balls of good.dump, got none with id 1"),
    ("good.dump -o good.dump", "-o: must be a folder, got good.dump"),
    ("none.dump", "none.dump: must be a LAMMPS dump (No such file or directory)"),
    ("text.dump", "text.dump: must be a LAMMPS text dump: ITEM: TIMESTEP"),
    ("bad.gz", "bad.gz: must be a LAMMPS dump (Not a gzipped file"),
    ("empty.dump", "empty.dump: must have balls at step 100, got none"),
    ("short.dump", "short.dump: must have 4 balls at step 100, as its head says (is the run still writing?), got 3"),
    ("scaled.dump", "scaled.dump: must have the columns id x y z (or xu yu zu), got id type xs ys zs"),
    ("noid.dump", "noid.dump: must have the columns id x y z (or xu yu zu), got type x y z"),
    ("word.dump", "word.dump: line 11: y must be a finite number, got 2O"),
    ("nan.dump", "nan.dump: line 10: x must be a finite number, got nan"),
    ("ragged.dump", "ragged.dump: line 12: must have 6 columns, got 5"),
    ("twice.dump", "twice.dump: must have each ball once at step 100, got id 2 2 times"),
])
def test_bad_input_is_one_line(slope, no_picture, here, arguments, message):
    good = Path(write("good.dump", FOUR)).read_text()
    write("notype.dump", FOUR, columns="id x y z")
    write("other.dump", FOUR, first=11)
    write("empty.dump", [])
    write("scaled.dump", FOUR, columns="id type xs ys zs")
    write("noid.dump", FOUR, columns="type x y z")
    write("twice.dump", FOUR, id=[1, 2, 2, 4])
    write("nan.dump", [(math.nan, 0, 0)])
    Path("text.dump").write_text("1 2 3\n")
    Path("bad.gz").write_text("1 2 3\n")
    Path("short.dump").write_text("\n".join(good.splitlines()[:-1]) + "\n")
    Path("word.dump").write_text(good.replace(" 20 ", " 2O "))
    Path("ragged.dump").write_text(good.replace(" 30 ", " "))
    before = sorted(here.rglob("*"))
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1 and err.startswith("slope travel: ") and message in err
    assert sorted(here.rglob("*")) == before


# --- the page ---

@pytest.mark.parametrize("command", examples("travel"))
def test_every_example_of_the_page_and_the_help_runs(slope, no_picture, here, command):
    for name in ("embankment.00044000", "rest.1", "rest.2", "start.1", "start.2"):
        write(f"{name}.dump", [(1, -1, 2), (2, 3, 1)])
    for pattern in ("rest.*.dump", "start.*.dump"):      # as the shell does
        command = command.replace(pattern, " ".join(sorted(path.name for path in here.glob(pattern))))
    status, out, err = slope(command)
    assert (status, err) == (0, "")
    assert "--help" in command or "along: median " in out
