"""Fix control/line: what crosses a line, in closed form and against the ledger of fix deposit/grid."""

import csv
import functools
import sys

import numpy as np
import pytest
import yaml
from deck_helpers import (collapse_deck, doc_examples, flight_head, read_dump, run_deck, write_asc, write_balls,
                          write_collapse)

BULK = 2.0
DEPOSIT = f"fix deposit all deposit/grid 10 0 cell 1 terrain ground output out bulk {BULK}\n"
LINE = "fix line all control/line line.csv deposit deposit output out\n"


def crossings(tmp_path, prefix="out"):
    with open(tmp_path / f"{prefix}.line.csv") as file:
        return [{key: float(value) if value else None for key, value in row.items()} for row in csv.DictReader(file)]


def summary(tmp_path, prefix="out"):
    return yaml.safe_load((tmp_path / f"{prefix}.line.yaml").read_text())


def fly(tmp_path, x, v, line, run, d=1.0, omega=None, fixes="", np_=1, ground=None, **settings):
    write_asc(tmp_path / "ground.asc", np.full((20, 20), 3.0) if ground is None else ground, -10, -10, 1)
    write_balls(tmp_path / "balls.data", x, d, v, settings.pop("box", [(-10, 10), (-10, 10), (0, 30)]), omega)
    (tmp_path / "line.csv").write_text(line)
    return run_deck(flight_head(regions="region pit block -9 9 -9 9 0 20 units box", **settings) + DEPOSIT + LINE +
                    fixes + run, tmp_path, np=np_)


def volume(d):
    return BULK * np.pi * np.asarray(d) ** 3 / 6


def test_one_flight_in_closed_form(tmp_path):
    """The line runs to the south: forward is to the west. Balls that lie lower than their ground are so much higher."""
    fly(tmp_path, [[4, -1, 8]], [[-3, 2, -0.5]], "1 5\n1 -5\n", "run 2000\n", d=0.8, omega=[[1, -2, 3]],
        fixes=LINE.replace("line all", "sunk all").replace("output out", "lower 0.4 output sunk"))
    row, = crossings(tmp_path)
    other, = crossings(tmp_path, "sunk")
    assert other == {**row, "height": pytest.approx(row["height"] + 0.4)}
    assert summary(tmp_path, "sunk")["largest"]["height"] == pytest.approx(4.9)
    mass = 1000 * np.pi * 0.8 ** 3 / 6
    expected = dict(time=1.0, step=1000, ball=1, direction=1, along=4.0, x=1, y=1, z=7.5, height=4.5,
                    vx=-3, vy=2, vz=-0.5, speed=13.25 ** 0.5, energy=0.5 * mass * (13.25 + 0.4 * 0.4 ** 2 * 14),
                    volume=volume(0.8), diameter=0.8)
    assert abs(row.pop("step") - expected.pop("step")) <= 1
    assert row == pytest.approx(expected, rel=1e-9)
    about = summary(tmp_path)
    assert about["forward"] == {"crossings": 1, "balls": 1, "volume": pytest.approx(volume(0.8), rel=1e-12)}
    assert about["back"] == {"crossings": 0, "balls": 0, "volume": 0}
    assert about["largest"] == pytest.approx({key: row[key] for key in ("speed", "height", "energy")}, rel=1e-9)
    assert about["length"] == 10 and about["bulk_factor"] == BULK


def test_a_line_drawn_against_the_motion(tmp_path):
    """The same flight over the line to the north: what crosses back is what counts, and a warning says so."""
    log = fly(tmp_path, [[4, -1, 8]], [[-3, 2, -0.5]], "1 -5\n1 5\n", "run 2000\n", d=0.8)
    row, = crossings(tmp_path)
    about = summary(tmp_path)
    assert (about["direction"], about["forward"]["crossings"], about["back"]["crossings"]) == ("back", 0, 1)
    assert about["largest"] == pytest.approx({key: row[key] for key in ("speed", "height", "energy")}, rel=1e-9)
    assert about["largest"]["energy"] > 0 and [q["share"] for q in about["quantiles"]] == [0.5, 0.9, 0.95, 0.99]
    assert about["first_time"] == pytest.approx(1.0, rel=1e-9)
    warning, = [line for line in log.splitlines() if line.startswith("WARNING: Fix control/line line: more volume")]
    assert "back than forward" in warning and "against 0" in warning


@pytest.mark.parametrize("fix, style", [(DEPOSIT + LINE, "Fix deposit/grid"), (LINE, "Fix control/line")])
def test_rerun_is_refused_before_files_are_touched(tmp_path, fix, style):
    """Between snapshots nothing moves: what the true run has written stays."""
    fly(tmp_path, [[4, -1, 8]], [[-3, 2, -0.5]], "1 5\n1 -5\n", "run 2000\n",
        fixes="dump d all custom 10 run.dump id x y z vx vy vz\n")
    before = {file.name: file.read_bytes() for file in tmp_path.glob("out.*")}
    assert before and summary(tmp_path)["forward"]["crossings"] == 1
    if fix == LINE:
        fix = DEPOSIT.replace(" 10 0 ", " 100000 0 ") + LINE       # whose turn comes later
    run_deck(flight_head(regions="region pit block -9 9 -9 9 0 20 units box") + fix +
             "rerun run.dump first 10 dump x y z vx vy vz\n", tmp_path, expect_error=f"{style} needs run, got rerun")
    assert {file.name: file.read_bytes() for file in tmp_path.glob("out.*")} == before


def test_what_rolls_back_is_counted_back(tmp_path):
    """Thrown against a field of 2 m/s2, the first ball comes back over the line in time, the second one does not."""
    log = fly(tmp_path, [[-1, 0, 5], [-1, 3, 5], [-3, -3, 5]], [[3, 0, 0], [4, 0, 0], [3, 0, 0]], "0,-9\n0,9\n",
              "variable t equal time\nthermo_style custom step f_line[1] f_line[2] f_line[3]\nthermo 100\nrun 3500\n",
              fixes="fix weight all gravity 2 vector -1 0 0\n")
    rows = crossings(tmp_path)
    times = sorted((t, ball, way) for ball, speed in ((1, 3), (2, 4)) for way, sign in ((1, -1), (-1, 1))
                   for t in [(speed + sign * np.sqrt(speed ** 2 - 4)) / 2])
    within = [one for one in times if one[0] < 3.5]
    assert [(row["ball"], row["direction"]) for row in rows] == [one[1:] for one in within] and len(within) == 3
    assert [row["time"] for row in rows] == pytest.approx([one[0] for one in within], abs=1e-5)
    assert [row["speed"] for row in rows] == pytest.approx([np.sqrt(12), np.sqrt(5), np.sqrt(5)], rel=1e-3)
    about = summary(tmp_path)
    assert about["forward"]["volume"] == pytest.approx(2 * volume(1))
    assert about["back"]["volume"] == pytest.approx(volume(1))
    assert about["net_volume"] == pytest.approx(volume(1))
    last = [line.split() for line in log.splitlines() if line.split()[:1] == ["3500"]][-1]
    assert [float(word) for word in last[1:3]] == pytest.approx([2 * volume(1), volume(1)], rel=1e-6)


def test_heights_where_there_is_no_ground(tmp_path):
    ground = np.full((20, 20), 3.0)
    ground[10:14, 8:12] = np.nan
    fly(tmp_path, [[-5, 1.5, 8], [-5, -4, 8]], [[5, 0, 0], [5, 0, 0]], "0 -9\n0 9\n", "run 1500\n", ground=ground)
    assert sorted(row["height"] or 0 for row in crossings(tmp_path)) == pytest.approx([0, 5])
    assert summary(tmp_path)["largest"]["height"] == pytest.approx(5)


def scatter(tmp_path, np_=1, **settings):
    """Balls that fly all over a line with corners, and out of the box; volume beyond the line by the ledger."""
    rng = np.random.default_rng(5)
    n = 300
    x = np.column_stack([rng.uniform(-9, 9, n), rng.uniform(-9, 9, n), rng.uniform(5, 9, n)])
    v = np.column_stack([rng.uniform(-6, 6, n), rng.uniform(-1, 1, n), 0 * x[:, 0]])
    d = rng.uniform(0.5, 1.0, n)
    # at the end of the run balls lie 0.6 m or more from the line and from the sides of the grid
    end = np.abs(x + 1.5 * v)
    keep = (end[:, 0] > 0.6) & (np.abs(end[:, :2] - 10) > 0.6).all(axis=1)
    x, v, d = x[keep], v[keep], d[keep]
    fly(tmp_path, x, v, "0 -10\n0 -3\n0 10\n", "run 1500\n", d, np_=np_,
        fixes="fix east all deposit/grid 10 0 cell 1 terrain ground extent 0 10 -10 10 "
              f"bulk {BULK} output east\n", **settings)
    return x, v, d


@pytest.mark.parametrize("np_, boundary", [(1, "f f f"), (2, "f f f"), (4, "f f f")])
def test_balance_with_the_ledger(tmp_path, np_, boundary):
    x, v, d = scatter(tmp_path, np_, boundary=boundary)
    about = summary(tmp_path)
    ledger = yaml.safe_load((tmp_path / "out.summary.yaml").read_text())["volume"]
    east = yaml.safe_load((tmp_path / "east.summary.yaml").read_text())["volume"]
    released = volume(d).sum()
    before = volume(d)[x[:, 0] > 0].sum()
    lost_east = volume(d)[(x[:, 0] + 1.5 * v[:, 0]) > 10].sum()    # what left the box on that side
    gone_sideways = np.abs(x[:, 1] + 1.5 * v[:, 1]) > 10
    end = x[:, 0] + v[:, 0] * np.where(gone_sideways, (np.sign(v[:, 1]) * 10 - x[:, 1]) / v[:, 1], 1.5)
    lost_east += volume(d)[gone_sideways & (end > 0) & (x[:, 0] + 1.5 * v[:, 0] <= 10)].sum()
    assert ledger["released"] == pytest.approx(released, rel=1e-9) and ledger["lost"] > 0.1 * released
    assert about["net_volume"] == pytest.approx(east["on_grid"] + lost_east - before, abs=1e-9 * released)
    assert about["forward"]["volume"] > 0.1 * released and about["back"]["volume"] > 0.1 * released


def test_lost_in_the_step_in_which_it_crosses(tmp_path):
    log = fly(tmp_path, [[8.05, 0, 8], [8, 0.001, 6]], [[100, 0, 0], [-1, 0, 0]], "9.995 -9\n9.995 9\n", "run 100\n")
    assert "ball 1 left the box" in log
    assert [row["ball"] for row in crossings(tmp_path)] == [1]


def test_periodic_sides(tmp_path):
    """Around the box and over the line in the first one, once."""
    fly(tmp_path, [[5, 0, 8]], [[30, 0, 0]], "8 -9\n8 9\n", "run 2000\n", boundary="p p f")
    assert [row["time"] for row in crossings(tmp_path)] == pytest.approx([0.1], abs=1e-9)


def test_with_a_motion_of_the_ground(tmp_path):
    """The path against the ground is what counts, wherever the two fixes stand in the deck."""
    (tmp_path / "motion.txt").write_text("0 -4 0 0\n1 -4 0 0\n")
    shake = "fix shake all ground/motion motion.txt\n"
    for fixes in (shake, "unfix line\n" + shake + LINE, "unfix move\n" + shake + "fix move all nve/sphere\n"):
        fly(tmp_path, [[-1, 0, 8]], [[0, 0, 0]], "0 -9\n0 9\n", "run 1000\n", fixes=fixes)
        row, = crossings(tmp_path)
        assert row["time"] == pytest.approx(np.sqrt(0.5), abs=1e-5)
        assert row["vx"] == pytest.approx(4 * np.sqrt(0.5), rel=2e-3)


# --- a collapse: the volume beyond the line is that of the balls there; ranks and restarts agree ---


def collapse(tmp_path, run, np_=1, out="out", **settings):
    write_collapse(tmp_path, 300, mixed=True, fast=True)
    (tmp_path / "line.csv").write_text("9 20\n8 10\n8 -13\n")
    text = collapse_deck(run, out=out, sort="sort 0 0", **settings)
    line = f"\nfix line soil control/line line.csv deposit deposit output {out}\n"
    run_deck(text.replace("\nthermo 1000", line + "thermo 1000", 1), tmp_path, np=np_)
    return crossings(tmp_path, out)


def test_volume_beyond_the_line(tmp_path):
    rows = collapse(tmp_path, "run 1500", every=1500)
    frames = read_dump(tmp_path / "out.dump")
    kind = np.loadtxt(tmp_path / "balls.data", skiprows=11, max_rows=300, usecols=1)

    def beyond(frame):
        x, y = frame[:, 1], frame[:, 2]
        return 6 / np.pi * np.pi / 6 * np.where(kind == 1, 1.0, 0.8) ** 3 @ (x < np.interp(y, [-13, 10, 20], [8, 8, 9]))

    net = sum(row["direction"] * row["volume"] for row in rows)
    assert len(rows) > 50
    assert net == pytest.approx(beyond(frames[1500]) - beyond(frames[0]), abs=1e-9 * 300)
    assert summary(tmp_path)["net_volume"] == pytest.approx(net, abs=1e-9)
    forward = [row for row in rows if row["direction"] > 0]
    quantiles = summary(tmp_path)["quantiles"]
    assert [q["share"] for q in quantiles] == [0.5, 0.9, 0.95, 0.99]
    for q in quantiles:
        for key in ("speed", "height", "energy"):
            expected = np.sort([row[key] for row in forward])[int(np.ceil(q["share"] * len(forward) - 1e-9)) - 1]
            assert q[key] == pytest.approx(expected, rel=1e-8)


def close(a, b):
    assert [(r["step"], r["ball"], r["direction"]) for r in a] == [(r["step"], r["ball"], r["direction"]) for r in b]
    for key in a[0]:
        assert [r[key] for r in a] == pytest.approx([r[key] for r in b], rel=1e-5, abs=1e-6), key


def test_ranks_agree(tmp_path):
    one, four = collapse(tmp_path, "run 600"), collapse(tmp_path, "run 600", 4, out="four")
    assert len(one) > 20
    close(one, four)


def test_restart(tmp_path):
    collapse(tmp_path, "restart 400 cut.*.restart\nrun 800", 2)
    settings = dict(begin="read_restart cut.400.restart")
    collapse(tmp_path, "restart 400 later.*.restart\nrun 400", 2, out="again", **settings)
    whole, again = ((tmp_path / f"{name}.line.csv").read_text() for name in ("out", "again"))
    assert whole == again and len(whole.splitlines()) > 20
    close(crossings(tmp_path), collapse(tmp_path, "run 100\nrun 300", 1, out="other", **settings))


@pytest.mark.parametrize("closed", ["-4 -4\n4 -4\n4 4\n-4 4\n-4 -4\n", "4 4\n4 -4\n-4 -4\n-4 4\n4 4\n"])
def test_a_closed_line(tmp_path, closed):
    """Counterclockwise, forward is outwards; volume forward less back is what has left."""
    rng = np.random.default_rng(8)
    x = np.column_stack([rng.uniform(-8, 8, (60, 2)), rng.uniform(5, 9, 60)])
    v = np.column_stack([rng.uniform(-9, 9, (60, 2)), 0 * x[:, 0]])
    keep = (np.abs(x + 0.5 * v)[:, :2] < 9.5).all(axis=1)
    fly(tmp_path, x[keep], v[keep], closed, "run 500\n")
    inside = [(np.abs(at[keep, :2]) < 4).all(axis=1).sum() for at in (x, x + 0.5 * v)]
    left = inside[0] - inside[1]
    about = summary(tmp_path)
    outwards = 1 if closed.startswith("-4 -4") else -1
    assert about["net_volume"] == pytest.approx(outwards * left * volume(1), abs=1e-9) and left != 0
    assert min(about["forward"]["crossings"], about["back"]["crossings"]) > 3


@pytest.mark.parametrize("np_, name", [(1, "out.line.csv"), (2, "out.line.yaml")])
def test_a_folder_where_a_file_must_be(tmp_path, monkeypatch, np_, name):
    (tmp_path / name).mkdir()
    monkeypatch.setattr(sys.modules[__name__], "run_deck", functools.partial(
        run_deck, expect_error=f"Fix control/line: cannot write {name}: Is a directory"))
    log = fly(tmp_path, [[-1, 0, 8]], [[3, 0, 0]], "0 -9\n0 9\n", "run 500\n", np_=np_)
    # mpirun may end the writing rank before that removes its lock file, which the next run takes over
    left = {path.name for path in tmp_path.glob("out*")} - ({"out.lock"} if np_ > 1 else set())
    assert "Step" not in log and left == {name}


@pytest.mark.parametrize("np_", (1, 2))
def test_balls_that_go_between_two_steps(tmp_path, np_):
    """With pre no: which ball was where is not known, and the crossings of a step would be lost."""
    balls = [[-1, 0, 8], [-1, 3, 8], [-3, 0, 8]]
    gone = "group gone id 1\nrun 10\ndelete_atoms group gone compress no\nrun 1000"
    fly(tmp_path, balls, [[3, 0, 0]] * 3, "0 -9\n0 9\n", gone + "\n", np_=np_)
    assert sorted(row["ball"] for row in crossings(tmp_path)) == [2, 3]
    with pytest.raises(AssertionError) as failed:
        fly(tmp_path, balls, [[3, 0, 0]] * 3, "0 -9\n0 9\n", gone + " pre no\n", np_=np_)
    assert "ERROR" in str(failed.value) and "Fix control/line line: the number of balls must not change between" in str(
        failed.value)


# --- only balls that can reach the line are tested in each step: the others are none the worse for it ---

BENT = "-6 -8\n1 -2\n-1 1.5\n2 4\n5 9\n"
EACH = "every 1 delay 0 check yes"


def thrown(tmp_path, neigh, skin=0.5, boundary="f f f", np_=1, extra="", run="run 900\n", line=BENT):
    """Balls thrown against a field of 20 m/s2, to and fro over a line with bends; what was written."""
    rng = np.random.default_rng(3)
    n = 150
    x = np.column_stack([rng.uniform(-9, 9, n), rng.uniform(-9, 9, n), rng.uniform(5, 9, n)])
    v = np.column_stack([rng.uniform(-15, 25, n), rng.uniform(-8, 8, n), 0 * x[:, 0]])
    write_asc(tmp_path / "ground.asc", np.full((20, 20), 3.0), -10, -10, 1)
    side = (-10, 10) if boundary[0] == "p" else (-40, 40)
    write_balls(tmp_path / "balls.data", x, rng.uniform(0.5, 1.0, n), v, [side, side, (0, 30)])
    (tmp_path / "line.csv").write_text(line)
    head = flight_head(boundary=boundary).replace("neighbor 0.5 bin", f"neighbor {skin} bin")
    head = head.replace("neigh_modify every 1 delay 0 check no", f"neigh_modify {neigh}")
    run_deck(head + "fix weight all gravity 20 vector -1 0 0\n" + DEPOSIT + LINE + extra + run, tmp_path, np=np_)
    return [(tmp_path / f"out.line.{kind}").read_text() for kind in ("csv", "yaml")]


@pytest.fixture(scope="module", params=["f f f", "p p f"])
def all_tested(request, tmp_path_factory):
    """Lists that are built in each step tell nothing of what moves between two of them: every ball is tested."""
    found = thrown(tmp_path_factory.mktemp("all"), "every 1 delay 0 check no", boundary=request.param)
    assert len(found[0].splitlines()) > 50
    return request.param, found


@pytest.mark.parametrize("neigh, skin, np_", [
    (EACH, 0.5, 1), (EACH, 0.5, 2), (EACH, 3.0, 4), (EACH, 0.02, 1), (EACH, 0.1, 2), (EACH, 1e-12, 1),
    ("every 1 delay 20 check yes", 0.5, 1), ("every 7 delay 0 check yes", 0.5, 2), ("every 1 delay 0 check no", 0.1, 1),
    (f"{EACH} once yes", 0.5, 1)])
def test_the_same_crossings_whatever_the_lists_do(tmp_path, all_tested, neigh, skin, np_):
    boundary, expected = all_tested
    assert thrown(tmp_path, neigh, skin, boundary, np_) == expected


@pytest.mark.parametrize("run", [
    "run 400\nrun 500 pre no\n", "run 400 post no\nrun 500\n", "run 400\nneigh_modify delay 30\nrun 500 pre no\n",
    "run 400\nneigh_modify check no\nrun 500 pre no\n", "run 900 every 100 NULL\n",
    "run 300\nneigh_modify delay 30\nrun 300\nneigh_modify delay 0\nrun 300 pre no\n"])
def test_the_same_crossings_in_several_runs(tmp_path, all_tested, run):
    boundary, expected = all_tested
    assert thrown(tmp_path, EACH, boundary=boundary, run=run)[0] == expected[0]


@pytest.mark.parametrize("skin", [0.2, 1.0])
def test_a_ball_that_is_thrown_over_the_line_in_one_step(tmp_path, skin):
    """Slow and far from the line when the lists were built, it is on the other side a step later."""
    throw = "variable throw equal (step==200)*8e8\nfix throw all addforce v_throw 0 0\n"
    found = []
    for neigh in (EACH, "every 1 delay 0 check no"):
        head = flight_head().replace("neighbor 0.5 bin\nneigh_modify every 1 delay 0 check no",
                                     f"neighbor {skin} bin\nneigh_modify {neigh}")
        write_asc(tmp_path / "ground.asc", np.full((20, 20), 3.0), -10, -10, 1)
        write_balls(tmp_path / "balls.data", [[-2, 0, 8], [-5, 4, 8]], 1.0, [[0.1, 0, 0], [0, 0, 0]],
                    [(-10, 10), (-10, 10), (0, 30)])
        (tmp_path / "line.csv").write_text("-0.5 -9\n-0.7 9\n")
        run_deck(head + throw + DEPOSIT + LINE + "run 220\n", tmp_path)
        found.append(crossings(tmp_path))
    assert [row["ball"] for row in found[0]] == [1, 2]
    assert found[0][0]["step"] == 201 and 0.001 * found[0][0]["speed"] > skin
    close(*found)


@pytest.mark.parametrize("skin, np_", [(0.2, 1), (0.6, 2), (0.05, 4)])
def test_a_collapse_crosses_where_its_places_do(tmp_path, skin, np_):
    """Against the places of all balls in each step."""
    rows = collapse(tmp_path, "run 500", np_, every=1, skin=skin)
    frames = read_dump(tmp_path / "out.dump")
    ways = []
    for step in range(1, 501):
        side = [at[:, 1] < np.interp(at[:, 2], [-13, 10, 20], [8, 8, 9]) for at in (frames[step - 1], frames[step])]
        ways += [(step, ball, 1 if after else -1) for ball, before, after in zip(frames[step][:, 0], *side)
                 if before != after]
    assert len(ways) > 20
    assert sorted((row["step"], row["ball"], row["direction"]) for row in rows) == sorted(ways)


def test_doc_examples(tmp_path):
    for name in ("fence.csv", "kerb.csv"):
        (tmp_path / name).write_text("0 -9\n0 9\n")
    fly(tmp_path, [[-1, 0, 8]], [[3, 0, 0]], "0 -9\n0 9\n",
        "unfix line\ngroup soil type 1\n" + doc_examples("fix_control_line") + "run 500\n")
    assert len(crossings(tmp_path, "fence")) == len(crossings(tmp_path, "kerb")) == 1
