"""Each fact in one place: site.yaml is read once, a length has one ruler, equal runs are one, a gap is no road."""
import math
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from shapely.affinity import rotate
from shapely.geometry import LineString, MultiLineString, MultiPolygon, box

import made_study
from made_rows import changed, row
from run_helpers import called, write_run, write_sidecar
from test_site import BODY, gis, told, write_layer  # noqa: F401
from test_site_anew import inside, mine, once  # noqa: F401
from tiny_collapse import LMP

from slope_tools import disk
from slope_tools.case import settings
from slope_tools.commands import study as study_command
from slope_tools.deposits import road_axis
from slope_tools.ensembles import ensemble, farther, known_events
from slope_tools.errors import SlopeError
from slope_tools.mobility import known
from slope_tools.releases import release_toe
from slope_tools.report import mobility_part
from slope_tools.report.numbers import Numbers
from slope_tools.studies import site_study, study
from slope_tools.survey import rasters, roads
from slope_tools.tables import combinations

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")


@pytest.fixture
def dry(capsys, monkeypatch):
    """`slope study WORDS --dry-run`: status, lines, error."""
    def run(*words):
        monkeypatch.setenv("LMP", LMP)
        status, out, err = called(capsys, ["study", *words, "--dry-run"])
        return status, out.splitlines(), err
    return run


def change(folder, old, new):
    path = folder / "site.yaml"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


# --- site.yaml ---

@pytest.mark.parametrize("words", ["mine", "mine --paper", "mine --sample 8", "mine/in.site --set rolling=0 -o I",
                                   "mine/in.site --sample 8 --vary friction=20:30 --known rock_avalanches -o I"])
def test_a_command_reads_site_yaml_once(mine, dry, monkeypatch, words):  # noqa: F811
    read = []
    parse = disk.parse_yaml
    monkeypatch.setattr(disk, "parse_yaml", lambda path, what: read.append(Path(path).name) or parse(path, what))
    dry(*words.split())
    assert read.count("site.yaml") == 1


def test_what_is_changed_while_the_runs_are_made_does_not_count(mine, monkeypatch):  # noqa: F811
    """Neither in the paper's study nor in the ensemble after it: both have the road and the events of one reading."""
    seen = []

    def perform(setup, settings, todo, collect, **_):
        seen.append((setup.road.cut_angle, collect.__closure__ and [
            cell.cell_contents.known for cell in collect.__closure__ if hasattr(cell.cell_contents, "chain")]))
        (mine / "site.yaml").write_text("broken: [\n")
        return made_study.study()

    for place in (study, study_command):
        monkeypatch.setattr(place, "perform", perform)
    monkeypatch.setattr(study_command, "write_site_report", lambda *_, **__: None)
    monkeypatch.setattr(study_command.results, "write_abouts", lambda *_: None)
    monkeypatch.setenv("LMP", LMP)
    study_command.run_study(study_command.Request(deck=mine))
    assert [angle for angle, _ in seen] == [30, 30, 30] and seen[1][1] == [{"set": None, "confined": "unknown"}]


def test_other_data_between_both_studies_end_the_command(mine, monkeypatch):  # noqa: F811
    def perform(*_, **__):
        (mine / "road.csv").write_text("20,0\n30,0\n30,80\n20,80\n")
        return {"study": {}}

    monkeypatch.setattr(study, "perform", perform)
    monkeypatch.setenv("LMP", LMP)
    with pytest.raises(SlopeError, match="mine: must not change while its study is made"):
        study_command.run_study(study_command.Request(deck=mine))


def test_the_site_is_one_commands_from_end_to_end(mine, monkeypatch):  # noqa: F811
    """Also between its two studies, and while the pages are drawn."""
    def others(*_, **__):
        with pytest.raises(BlockingIOError), open(mine / ".lock", encoding="ascii") as lock:
            import fcntl
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        tried.append(True)
        return made_study.study()

    tried = []
    monkeypatch.setattr(study_command.site_study, "make_site_runs", others)
    monkeypatch.setattr(study_command.site_study, "collect_site_results", lambda *_,
                        **__: site_study.Done(mine, others(), None))
    monkeypatch.setattr(study_command, "run_deck", others)
    monkeypatch.setattr(study_command.results, "write_abouts", lambda *_: None)
    monkeypatch.setattr(study_command, "write_site_report", others)
    study_command.run_study(study_command.Request(deck=mine))
    assert len(tried) == 5
    with disk.alone_in(mine):
        pass


@pytest.mark.parametrize("how", ["moved", "linked above"])
def test_a_folder_may_move_without_its_sources(mine, gis, dry, inside, tmp_path_factory, how):  # noqa: F811
    """To a place from which `..` leads above the root, or reached by a link, from which it leads elsewhere."""
    deep = gis / "a" / "b" / "c" / "d" / "e" / "f"
    deep.mkdir(parents=True)
    inside("--terrain dem.tif --release release.geojson " + " ".join(map(str, BODY)) + f" -o {deep / 'mine'}")
    expected = dry(str(deep / "mine"))
    assert expected[0] == 0, expected
    there = tmp_path_factory.mktemp("x")
    if how == "moved":
        shutil.move(deep / "mine", there / "mine")
    else:
        (there / "up").symlink_to(deep)
    place = there / "mine" if how == "moved" else there / "up" / "mine"
    assert dry(str(place))[:2] == expected[:2]
    if how != "moved":      # its sources are in reach
        inside(f"{place}")
        assert dry(str(deep / "mine"))[0] == 0
    else:
        change(place, "dem.tif", "other.tif")
        assert "must not have been changed since in.site was made from it" in dry(str(place))[2]


@pytest.mark.parametrize("several, expected", [("0.1 0 0.05", "0.05"), ("0 0.05 0.1", "0.05"), ("0.1 0.05", "0.1"),
                                               ("1e-1 0 0.02 0.03 0.05", "0.03"), ("b a c", "a")])
def test_the_middle_is_that_of_the_values(several, expected):
    assert settings.middle(several.split()) == expected


def test_too_few_points_are_named_where_they_stand(mine, dry):  # noqa: F811
    change(mine, "points: 64", "points: 4")
    status, _, err = dry("mine")
    assert status == 2 and "mine/site.yaml: study.points: must be more runs than there are parameters, 5, got 4" in err


def test_half_step_is_at_the_middle_resistance(mine, dry):  # noqa: F811
    change(mine, "rolling: [0, 0.05, 0.1]", "rolling: [0.1, 0, 0.05]")
    status, lines, err = dry("mine", "--paper")
    assert status == 0, err
    mine_ = [line.split(":")[0] for line in lines if "step_" in line]
    assert len(mine_) == 1 and all(line.startswith("rolling_0.05_") for line in mine_), mine_


# --- a road ---

@pytest.mark.parametrize("corners, part", [
    ([(60, 30), (76, 30), (76, 50), (60, 50)], "the road lies on the body"),
    ([(30, 30), (76, 30), (76, 50), (30, 50)], "a part of the road lies on the body"),
    ([(20, 0), (36, 0), (36, 80), (20, 80)], None)])
def test_a_road_on_the_body_is_said_by_slope_site(told, gis, corners, part):  # noqa: F811
    write_layer(gis / "road.geojson", corners)
    status, _, err = told("--terrain", "dem.tif", "--release", "release.geojson", *BODY, "--road", "road.geojson",
                          "--balls", 400, "-o", "mine")
    assert status == 0 and ("lies on the body" in err) == bool(part) and (part or "") in err, err
    assert ("road on body" in (gis / "mine" / "warnings.yaml").read_text()) == bool(part)
    assert part != "the road lies on the body" or "comes out under the road" not in err


def test_all_of_a_road_on_the_body_is_the_road():
    raster = rasters.Raster(np.zeros((30, 30)), rasters.Affine(1, 0, 0, 0, -1, 30), None)
    body = np.zeros((30, 30), bool)
    body[5:25, 5:25] = True
    for road, wholly in ((box(10, 10, 20, 14), True), (box(10, 10, 26, 14), False),
                         (MultiPolygon([box(10, 10, 20, 14), box(0, 0, 4, 4)]), False)):
        found = release_toe.on_body(body, raster, road, 2)
        assert found.wholly == wholly and found.part == ("the road" if wholly else "a part of the road")
    assert release_toe.on_body(body, raster, box(0, 0, 6, 30), 2) is None
    assert release_toe.on_body(body, raster, box(10, 10, 40, 14), 2).wholly is False      # beyond the terrain


def test_a_road_far_from_the_body_is_not_on_it():
    """Whatever the corners of its polygon, whose coverage of the cells elsewhere is rounded."""
    raster = rasters.Raster(np.zeros((64, 256)), rasters.Affine(2.5, 0, -400, 0, -2.5, 160), None)
    body = np.zeros(raster.z.shape, bool)
    body[10:50, 190:230] = True
    random = np.random.default_rng(1)
    for _ in range(50):
        x, slant = random.uniform(-380, -100), random.uniform(-20, 20)
        road = LineString([(x, 3.0), (x + slant, 157.0)]).buffer(5.0, cap_style=2)
        assert release_toe.on_body(body, raster, road, 2) is None


PARTS = {"two": [box(60, 0, 80, 70), box(60, 90, 80, 160)], "small gap": [box(60, 0, 80, 79), box(60, 80, 80, 160)],
         "three": [box(60, 0, 80, 40), box(60, 60, 80, 100), box(60, 130, 80, 160)],
         "offset": [box(60, 0, 80, 70), box(90, 100, 110, 160)]}


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.parametrize("angle", [0, 30])
def test_the_axis_of_a_road_has_its_gaps(name, angle):
    road = rotate(MultiPolygon(PARTS[name]), angle, origin=(0, 0))
    axis, _ = road_axis.middle(road)
    assert len(axis.geoms) == len(PARTS[name])
    assert axis.length == pytest.approx(sum(one.bounds[3] - one.bounds[1] for one in PARTS[name]))
    assert axis.intersection(road.buffer(1e-6)).length == pytest.approx(axis.length)
    # chainage goes on across a gap
    axes, ends = road_axis.number_axes(axis.geoms, 2.0), {"two": 160, "small gap": 160, "three": 160,
                                                          "offset": 130 + math.hypot(30, 30)}
    assert axes[0].s[0] == 2000 and axes[-1].s[-1] == pytest.approx(2000 + ends[name], abs=1e-6)


@pytest.mark.parametrize("lines, ends", [
    ([(0, 0, 100, 0), (0, 20, 100, 20)], [(0, 100), (100, 200)]),                               # beside each other
    ([(0, 0, 100, 0), (90, 20, 200, 20)], [(0, 100), (100, 210)]),
    ([(0, 0, 100, 0), (100, 20, 0, 20)], [(0, 100), (100, 200)]),
    ([(0, 0, 100, 0), (100, 0, 200, 0)], [(0, 100), (100, 200)]),                               # touch
    ([(0, 0, 100, 0), (130, 40, 230, 40)], [(0, 100), (150, 250)]),                             # follow each other
])
def test_chainage_counts_gaps_of_lines_that_follow_each_other(lines, ends):
    axes = road_axis.number_axes([LineString([line[:2], line[2:]]) for line in lines], 0.0)
    assert [(axis.s[0], axis.s[-1]) for axis in axes] == ends


def test_chainage_is_that_of_the_whole_road_beyond_the_grid():
    """Which it leaves and enters again; one that turns back out there counts from the grid's edge, with a warning."""
    raster, asked, found = rasters.Raster(np.zeros((16, 20)), rasters.Affine(10, 0, 0, 0, -10, 160), None), \
        roads.Asked(start=2.0), []
    lines = MultiLineString([[(-150, 20), (100, 20), (100, 200), (150, 200), (150, -30)]])
    assert [(axis.s[0], axis.s[-1]) for axis in road_axis.axes_of_lines(lines, asked, raster, "a")] == [
        (2150, 2390), (2520, 2680)]
    along = MultiLineString([[(-50, 0), (250, 0)]])         # the edge itself
    assert [(axis.s[0], axis.s[-1]) for axis in road_axis.axes_of_lines(along, asked, raster, "a")] == [(2050, 2250)]
    for road, starts in ((box(60, -500, 80, 300), [2500]), (box(60, 0, 80, 160), [2000]),
                         (MultiPolygon([box(60, -80, 80, -20), box(60, 10, 80, 160)]), [2090]),
                         (LineString([(90, 20), (-900, 20), (-900, 300), (90, 300)]).buffer(10), [2000])):
        axes, source = road_axis.axes_of([], road, asked, raster, found.append)
        assert [axis.s[0] for axis in axes] == pytest.approx(starts)
    assert source.endswith("in the grid") and [one.kind for one in found] == ["chainage from the edge"]


@pytest.mark.parametrize("axis", ["", "--axis line.csv"])
def test_nothing_is_blocked_where_there_is_no_road(tmp_path, monkeypatch, capsys, axis):
    """A road with a gap of 20 m under a deposit of 100 m: 80 m are blocked."""
    monkeypatch.chdir(tmp_path)
    thickness = np.zeros((160, 120))
    thickness[30:130, 40:100] = 2.0
    write_run(thickness, 0.0, 1.0)
    write_sidecar(160, 120, 1.0)
    Path("two.csv").write_text("60,0\n80,0\n80,70\n60,70\n\n60,90\n80,90\n80,160\n60,160\n")
    Path("line.csv").write_text("70,0\n70,160\n")
    status, _, err = called(capsys, ["volume", "run", "--road", "two.csv", "--local", "--mesh", "10", "-o", "v",
                                     "--no-picture", *axis.split()])
    assert status == 0, err
    about = yaml.safe_load(Path("v/volume.yaml").read_text())
    assert about["axis"]["length"] == pytest.approx(160 if axis else 140)
    assert about["axis"]["blocked_length"] == pytest.approx(80) == pytest.approx(about["clearing"]["blocked_length"])
    assert [[one["from"], one["to"]] for one in about["stretches"]] == [[30, 70], [90, 130]] == \
        about["axis"]["blocked_stretches"]
    assert [start for start, _ in about["by_10_m"]] == [30, 40, 50, 60, 90, 100, 110, 120]


# --- one run ---

def rows_of(lengths, **equal):
    """Rows of an ensemble over x, whose runs have these lengths and volumes."""
    return [row(run=f"x_{k}", set={"x": str(k)}, centroid_m=length, front_m=length, remove_m3=10 * length,
                length_m=length, **equal) for k, length in enumerate(lengths)]


PLAN = SimpleNamespace(names=["x"], number=8, places=lambda rows: np.array([[float(one.set["x"])] for one in rows]))


@pytest.mark.parametrize("lengths, points", [([50.0] * 8, 1), ([50.0, 60.0] * 4, 2), ([50.0] * 4 + [61.0, 62.0], 3),
                                             ([50.0, 51.0, 52.0], 3)])
def test_runs_that_are_the_same_are_one(lengths, points):
    rows = rows_of(lengths)
    assert len(set(ensemble.number_design_points(PLAN, rows))) == points
    values = ensemble.summarise_quantity("length", "m", np.array(lengths), ensemble.number_design_points(PLAN, rows), 0)
    doubts = ensemble.no_effect(rows)
    assert [one.kind for one in doubts] == ["no effect"] * (points < len(lengths))
    if points == 1:
        assert all(one.low is one.high is None and one.value == 50 for one in values.quantiles)
        assert doubts[0].text == ("what was varied has no effect on 8 of 8 runs, to the last digit: they are one run, "
                                  "which has no bounds")
    found = SimpleNamespace(exceedance=lambda length: np.interp(length, [0, 100], [1, 0]))
    runs = known_events.Runs(PLAN, [], rows, found)
    assert len(set(runs.point)) == points and runs.several == len(lengths) / points
    assert combinations.same_as(rows) == [lengths.index(one) for one in lengths]


def test_one_run_of_known_events_has_no_bounds():
    rows = rows_of([50.0] * 8)
    found = SimpleNamespace(exceedance=lambda length: np.interp(length, [0, 100], [1, 0]))
    runs = known_events.Runs(PLAN, [], rows, found)
    from slope_tools.ensembles import conditioned
    curve = conditioned.compute_known_curve(runs.column("remove_m3"), runs.mass, None, runs.several, 0.0)
    assert all(one.low is one.high is None
               for one in known_events.list_known_quantiles(curve, runs, "remove_m3", (0.5, 0.9)))


# --- one ruler ---

def test_no_run_is_longer_than_the_way_that_the_terrain_shows():
    """The path ends at 162.5 m; a run ends 166.9 m from where it begins, beside the path's end."""
    path = SimpleNamespace(length=np.array([0.0, 100.0, 162.5]))
    mobility = known.Mobility(path, 0.05, SimpleNamespace(), {"k": np.array([1.0, 0.6, 0.55])}, "k",
                              np.ones(3, bool), [])
    assert mobility.end(166.9) == 166.9 and mobility.end(120.0) == 162.5
    rows = [changed(one, length_by_lobe_m=[one.length_m] * 2) for one in rows_of([100.0, 140.0, 166.9])]
    runs = known_events.Runs(PLAN, [], rows, mobility)
    assert runs.lengths.max() == mobility.end(float(runs.lengths.max())) == 166.9 and mobility.beyond_path() == 0.55
    text = mobility_part.beyond_the_terrain(mobility_part.Lies([100.0, 166.9], mobility, ""), ["k", "k"], Numbers(), "")
    assert "167 m" in text and "162" not in text and "163" not in text
    added = farther.next_runs(farther.Added(PLAN), np.zeros((3, 1)), np.array([100.0, 140.0, 166.9]),
                              np.array([0.6, 0.57, 0.55]), farther.End(mobility.end(166.9), 0.55), None)
    assert added.stopped.numbers == {"share": 0.55, "path_m": 166.9} and not added.batches
