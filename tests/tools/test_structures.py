"""Structures and control lines in study and report: numbers against the runs' own files and closed forms."""
import html
import re
import shlex
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

import made_rows
from run_helpers import called
from tiny_collapse import LMP, edit, rows_of, write_case, write_stl

from slope_tools import cli, digits, errors
from slope_tools.plots import figure_structures
from slope_tools.plots.obstacles import Obstacles
from slope_tools.report import client_part
from slope_tools.report import structures_part as report_structures
from slope_tools.tables import structures

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
ADDED = """\
if "${wall} > 0" then "fix wall soil wall/gran/mesh 3 wall.stl output ${out}.wall 10"
fix         post soil wall/gran/mesh 3 post.stl output ${out}.post 10
fix         ground2 soil wall/gran/mesh 3 post.stl
neighbor    0.2 bin"""
LINE = """\
velocity    soil set -4 0 0
fix         fence soil control/line fence.csv output ${out}.fence
run         ${steps}"""


def slope(arguments, capsys):
    return called(capsys, shlex.split(arguments))


def write_structures(folder):
    """The small collapse above a wall at x 12 to 13, a post that nothing reaches, and a line at x 11."""
    edit(write_case(folder), "index 150", "index 900\nvariable  wall index 1", "neighbor    0.2 bin", ADDED,
         "run         ${steps}", LINE)
    write_stl(folder / "wall.stl", (12, 1, -1), (13, 23, 2))
    write_stl(folder / "post.stl", (2, 11, -1), (3, 12, 2))
    (folder / "fence.csv").write_text("11 23\n11 1\n")


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """A study with and without the wall; in the deck's folder lie outputs of a run by hand, with a wall."""
    folder = tmp_path_factory.mktemp("structures")
    write_structures(folder / "case")
    (folder / "case" / "tiny.wall.csv").write_text("left by an earlier run\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("LMP", LMP)
        assert cli.main(shlex.split("study case/in.tiny --set wall=1,0 --jobs 1 -o out")) == 0
    return folder / "out"


def test_structures_of_each_run_are_those_of_its_files(studied):
    rows = rows_of(studied / "structures.csv")
    # ground2 has no output
    assert [(row["run"], row["structure"]) for row in rows] == [("wall_1", "wall"), ("wall_1", "post"),
                                                                ("wall_0", "post")]
    series = np.genfromtxt(studied / "wall_1" / "tiny.wall.csv", delimiter=",", names=True)
    pressure = np.genfromtxt(studied / "wall_1" / "tiny.wall.triangles.csv", delimiter=",", names=True)
    wall, post = rows[0], rows[2]
    assert float(wall["largest_force_n"]) == series["largest_force"].max() > 0
    assert float(wall["at_s"]) == series["time"][series["largest_force"].argmax()]
    assert float(wall["impulse_ns"]) == pytest.approx(np.sqrt(sum(series[f"j{k}"][-1] ** 2 for k in "xyz")), rel=1e-12)
    assert float(wall["moment_nm"]) == series["largest_moment"].max() > 0
    assert 0 < float(wall["bearing_m"]) <= float(wall["length_m"]) == pytest.approx(22)
    assert int(wall["end_contacts"]) == series["contacts"][-1]
    assert float(wall["largest_pressure_pa"]) == pressure["largest_pressure"].max()
    assert 0 < float(wall["mean_force_n"]) < float(wall["largest_force_n"])
    assert float(post["largest_force_n"]) == float(post["largest_pressure_pa"]) == 0 and post["at_s"] == ""
    study = yaml.safe_load((studied / "study.yaml").read_text())
    assert study["runs"][0]["structures"]["wall"]["largest_force_n"] == float(wall["largest_force_n"])


def test_lines_of_each_run_are_those_of_its_files(studied):
    rows = rows_of(studied / "lines.csv")
    assert [row["line"] for row in rows] == ["fence", "fence"]
    for row in rows:
        about = yaml.safe_load((studied / row["run"] / "tiny.fence.line.yaml").read_text())
        assert float(row["forward_m3"]) == about["forward"]["volume"]
        assert float(row["net_m3"]) == about["net_volume"]
        assert int(row["crossings"]) == about["forward"]["crossings"]
        for entry in about["quantiles"]:        # found anew from the crossings
            for name, unit in (("speed", "m_s"), ("height", "m"), ("energy", "j")):
                assert float(row[f"{name}_{100 * entry['share']:.0f}_{unit}"]) == pytest.approx(entry[name], rel=1e-8)
    held, free = (float(row["net_m3"]) for row in rows)
    assert held < free


def test_report_draws_them(studied, capsys, blank_pictures):
    status, _, err = slope(f"report {studied}", capsys)
    assert status == 0, err
    page = (studied / "report.html").read_text()
    section = re.search(r'<section id="structures".*?</section>', page, re.DOTALL)[0]
    assert len(re.findall(r"<td[^>]*>[\d.]+ kN/m", section)) == 1 and "the same per metre, at least" in section
    for title in ("Force on wall", "Force on post", "Energies at the line fence"):
        assert section.count(f'alt="{title}"') == 1
    assert section.count("<tr>") == 2 + 3 + 2       # heads, structures, lines
    assert re.findall(r"<tr><td>(\d)</td><td class=\"left\">(\w+)", section) == [
        ("1", "wall"), ("1", "post"), ("2", "post"), ("1", "fence"), ("2", "fence")]
    assert re.search(r"(wall|post) is 2.00 m high, [\d.]+ of the model's balls: the loads on it are those of single "
                     "balls", html.unescape(section))
    shown = re.search(r"Maps of the run wall (\d)", page)[1]
    assert section.count('alt="Largest pressure on wall"') == int(shown)
    assert "Largest pressure on post" not in section        # nothing touched it
    blank_pictures()
    assert slope(f"report {studied} --run wall_1 -o {studied}/one.html", capsys)[0] == 0
    assert (studied / "one.html").read_text().count('alt="Largest pressure on wall"') == 1


@pytest.mark.parametrize("moving", [False, True])
def test_of_runs_that_end_in_motion_a_force_is_a_least(moving):
    numbers = {"mean_force_n": 4e6, "length_m": 20.0, "bearing_m": 10.0}
    for force, whole, cut in ((4e6, "4.00 MN, on wall, at least 400 kN per metre of the length that bears it",
                               "at least 4.00 MN, on wall, at least 400 kN per metre of the length that bears it"),
                              (0.0, "nothing touches them", "nothing touches them before the runs end, in motion")):
        rows = [made_rows.row(structures={"wall": {**numbers, "mean_force_n": force}}, ball_m3=1.0, moving=moving)]
        (_, text), = client_part.structures(SimpleNamespace(finished=rows))
        assert text == (cut if moving else whole)


def test_page_1_names_the_structure_that_bears_most_per_metre_too():
    """A pier of 1 m bears a fifth of what a wall does, on a tenth of the length."""
    wall = {"mean_force_n": 4e6, "length_m": 20.0, "bearing_m": 10.0}
    pier = {**wall, "mean_force_n": 8e5, "length_m": 1.0, "bearing_m": 1.0}
    rows = [made_rows.row(structures={"wall": wall, "pier": pier}, ball_m3=1.0)]
    (_, text), = client_part.structures(SimpleNamespace(finished=rows))
    assert text == ("4.00 MN, on wall, at least 400 kN per metre of the length that bears it; at least 800 kN per "
                    "metre on pier")


def test_a_single_run_is_reported_too(studied, capsys, blank_pictures):
    blank_pictures()
    status, _, err = slope(f"report {studied / 'wall_1'} -o {studied}/single.html", capsys)
    assert status == 0, err
    assert (studied / "single.html").read_text().count('alt="Force on wall"') == 1


def test_without_structures_there_is_nothing(tmp_path, monkeypatch, capsys, blank_pictures):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", LMP)
    write_case(tmp_path / "case")
    assert slope("study case/in.tiny --set rolling=0 -o out", capsys)[0] == 0
    assert not (tmp_path / "out" / "structures.csv").exists() and not (tmp_path / "out" / "lines.csv").exists()
    blank_pictures()
    assert slope("report out", capsys)[0] == 0
    assert 'id="structures"' not in (tmp_path / "out" / "report.html").read_text()


# --- numbers and pictures alone ---

def series_of(time, force):
    """A Series of a force (N) in x that jumps to its value at each time."""
    time, force = np.asarray(time, float), np.asarray(force, float)
    impulse = np.concatenate([[0], np.cumsum(force[:-1] * np.diff(time))])
    triple = np.column_stack([force, 0 * force, 0 * force])
    return structures.Series(time, triple, np.column_stack([impulse, 0 * impulse, 0 * impulse]),
                             np.zeros(len(time)), np.abs(force), 0 * force)


def test_mean_force_of_a_constant_force_and_of_a_pulse():
    time, mean = series_of(np.linspace(0, 4, 401), np.full(401, -7.0)).mean_force(0.5)
    assert mean[time >= 0.5] == pytest.approx(7.0, rel=1e-9) and mean[0] == 0
    pulse = np.zeros(401)
    pulse[200:210] = 100.0          # 0.1 s: a fifth of the window
    time, mean = series_of(np.linspace(0, 4, 401), pulse).mean_force(0.5)
    assert mean.max() == pytest.approx(20.0, rel=1e-9)
    assert mean[(time < 2) | (time > 2.61)] == pytest.approx(0, abs=1e-9)


def test_an_impulse_between_rows_that_are_far_apart_may_have_come_at_once():
    time = np.array([0.8, 1.6, 2.4])
    impulse = np.array([[0, 0, 0], [0, -50, 0], [0, -50, 0]], float)
    one = structures.Series(time, 0 * impulse, impulse, *np.zeros((3, 3)))
    assert one.mean_force(0.5)[1] == pytest.approx([0, 100, 0])


def wall_of(length, panel, turn=0.0):
    """A wall along x, 2 m high, of panels of two triangles; turned by an angle about z."""
    x = np.arange(0, length, panel)
    corners = np.array([[[a, 0, 0], [b, 0, 0], [b, 0, 2], [a, 0, 0], [b, 0, 2], [a, 0, 2]] for a, b in
                        zip(x, x + panel)], float).reshape(-1, 3, 3)
    cos, sin = np.cos(turn), np.sin(turn)
    return corners @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])


@pytest.mark.parametrize("panel", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_the_force_per_metre_does_not_depend_on_how_long_a_wall_is_drawn(panel, turn):
    """An even load on 20 m, and a stray ball far beside it."""
    bearing = {}
    for length in (20, 60, 200):
        corners = wall_of(length, panel, turn)
        middle = wall_of(length, panel).mean(axis=1)[:, 0]
        impulse = np.where(middle < 20, 7.0, 0.0)
        impulse[-1] += 0.01 * (length > 20)
        whole, bearing[length] = structures.bearing_length(corners, impulse)
        assert whole == pytest.approx(length, rel=1e-3)
    assert list(bearing.values()) == pytest.approx([20, 20, 20], rel=2e-3)


@pytest.mark.parametrize("panel", [0.5, 1.0, 4.0])
def test_a_length_that_bears_little_does_not_share_the_load(panel):
    """Two streams of 10 m onto the ends of a wall of 100 m; one of 20 m with a tenth of the load beside it."""
    corners = wall_of(100, panel)
    middle = corners.mean(axis=1)[:, 0]
    for impulse in (abs(middle - 50) > 40, np.where(abs(middle - 50) < 10, 36.0, 1.0)):
        bearing = structures.bearing_length(corners, impulse.astype(float))[1]
        assert bearing == pytest.approx(20, rel=0.35)


def test_a_shorter_length_than_a_few_balls_bears_the_load_of_single_ones():
    numbers = {"mean_force_n": 60.0, "length_m": 30.0, "bearing_m": 2.0}
    assert structures.per_metre(numbers, 1.0) == 60 / 5 and structures.per_metre(numbers, 10.0) == 60 / 30
    assert structures.per_metre({**numbers, "bearing_m": 20.0}, 1.0) == 3
    assert structures.bearing_length(np.zeros((1, 3, 3)), np.ones(1)) == (0, 0)
    assert structures.bearing_length(wall_of(4, 1), np.zeros(8)) == (4, 0)


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.0])
def test_a_pier_that_is_hit_on_its_end_is_as_long_as_that_is_wide(turn):
    """2 m wide and 10 m long, along the flow; then hit on a flank, from above, and from all around."""
    cos, sin = np.cos(turn), np.sin(turn)
    end, flank = wall_of(2, 0.5) @ [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], wall_of(10, 0.5)
    top = np.array([[[0, 0, 2], [10, 0, 2], [10, 2, 2]], [[0, 0, 2], [10, 2, 2], [0, 2, 2]]], float)
    pier = np.concatenate([end, flank, top]) @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])
    on = np.repeat([0, 1, 2], [len(end), len(flank), len(top)])
    for load, length in ((on == 0, 2), (on == 1, 10), (on == 2, 10), (np.where(on == 0, 5, on == 1), 10), (on < 0, 10)):
        bearing = structures.bearing_length(pier, 3.0 * load)
        assert bearing[0] == pytest.approx(length, rel=1e-6)
    numbers = {"mean_force_n": 60.0, "length_m": 2.0, "bearing_m": 2.0}
    assert structures.per_metre(numbers, 1.0) == 30


def test_a_map_is_seen_from_where_the_load_comes():
    """Looking along -x: y to the right; the nearer face is drawn last."""
    near = np.array([[5, 0, 0], [5, 2, 0], [5, 0, 1]], float)
    far = near - [3, 0, 0]
    places, order = figure_structures.seen_from(np.array([near, far]), np.array([-1.0, 0.0, 0.4]))
    assert list(order) == [1, 0] and places[1] == pytest.approx(near[:, 1:])
    assert figure_structures.seen_from(np.array([near, far]), np.array([2.0, 0, 0]))[1].tolist() == [0, 1]


@pytest.mark.parametrize("line, found", [
    ("fix a soil wall/gran/mesh 4 wall.stl output out.a 10", {"a": "out.a"}),
    ("fix a soil wall/gran/mesh 4 wall.stl point 1 2 3", {}),
    ("fix a soil wall/gran/mesh 4 terrain ground.asc output out.a 10", {}),
    ("fix a soil control/line line.csv output out.a", {})])
def test_structures_are_known_from_the_log(line, found):
    assert structures.outputs([line], "wall/gran/mesh") == found


@pytest.mark.parametrize("text", ["", "<VTKFile/>", "<VTKFile><DataArray Name='corners'>1 2 3</DataArray></VTKFile>"])
def test_a_mesh_file_that_is_none(tmp_path, text):
    (tmp_path / "a.vtp").write_text(text)
    with pytest.raises(errors.SlopeError, match="a.vtp: must be what fix wall/gran/mesh wrote"):
        structures.polydata(tmp_path / "a.vtp")


def test_the_force_at_rest_scatters_between_equal_runs_only():
    def row(rolling, force):
        return made_rows.row(set={"rolling": rolling}, structures={"dam": {"end_force_n": force}})
    rows = [row("0", 90.0), row("0", 110.0), row("1", 1000.0)]
    assert structures.scatter_at_rest(rows)["dam"] == (pytest.approx(0.1 * 2 ** 0.5), 2)
    assert structures.scatter_at_rest(rows[1:]) == structures.scatter_at_rest([]) == {}


def test_a_series_of_a_run_without_output(tmp_path):
    """Its head alone: no force, and no end of the study."""
    (tmp_path / "a.csv").write_text(",".join(structures.SERIES) + "\n")
    (tmp_path / "a.triangles.csv").write_text("x,y,z,largest_pressure\n")
    numbers = structures.of_structure(tmp_path, "a")
    assert numbers["largest_force_n"] == numbers["mean_force_n"] == 0 and numbers["at_s"] is None
    assert structures.per_metre(numbers, 1.0) is None
    header = (tmp_path / "a.csv").read_text()
    (tmp_path / "a.csv").write_text(header.replace(",largest_moment", ""))
    with pytest.raises(errors.SlopeError, match="without largest_moment: of an older version.*--anew"):
        structures.of_structure(tmp_path, "a")
    (tmp_path / "a.csv").write_text(header)
    assert numbers["end_contacts"] == 0
    (tmp_path / "a.vtp").write_text("<VTKFile><DataArray Name='corners'>0 0 0 0 2 0 0 0 1</DataArray>"
                                    "<DataArray Name='largest_pressure'>5</DataArray></VTKFile>")
    data = SimpleNamespace(result=SimpleNamespace(folder=tmp_path), drawn=[])
    part = report_structures.Structures(data, None, SimpleNamespace(obstacles=Obstacles({}, {})))
    assert part.pressures(("wall", "a")).alt == "Largest pressure on wall"
    data.drawn.append(SimpleNamespace(folder=tmp_path))
    assert part.forces("wall", [(data.drawn[0], "a")]).alt == "Force on wall"


@pytest.mark.parametrize("back", [10, 30])
def test_a_line_that_was_drawn_against_the_motion(tmp_path, back):
    """Its numbers are those of the direction in which more crossed, as the fix's own."""
    (tmp_path / "a.line.yaml").write_text(f"forward: {{volume: 20, crossings: 2}}\nback: {{volume: {back}, crossings: "
                                          f"1}}\nnet_volume: {20 - back}\n")
    (tmp_path / "a.line.csv").write_text("time,direction,speed,height,energy,volume\n1,1,2,0,5,10\n3,1,2,0,6,10\n"
                                         f"2,-1,9,0,800,{back}\n")
    found = structures.of_line(tmp_path, "a")
    wanted = ("back", 1, 2, 800, 9) if back > 20 else ("forward", 2, 1, 6, 2)
    assert tuple(found[key] for key in ("direction", "crossings", "first_s", "largest_energy_j",
                                        "speed_95_m_s")) == wanted


@pytest.mark.parametrize("largest, unit", [(5.6e11, "GN"), (2e6, "MN"), (900, "N")])
def test_the_unit_of_an_axis_suits_its_values(largest, unit):
    factor, prefix = digits.prefix(largest)
    assert f"{prefix}N" == unit and 1 <= largest / factor < 1000


@pytest.mark.parametrize("text", ["", "time,fx\n1,2\n", "left by an earlier run\n", "not,text\n\x00\n"])
def test_a_series_that_is_none(tmp_path, text):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(errors.SlopeError, match="a.csv: must be what the run wrote"):
        structures.series(tmp_path, "a")
