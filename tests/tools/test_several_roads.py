"""Several roads of a site: each is studied as if it were alone, over the same runs; the worst stands for the site."""
import csv
import html
import json
import math
import shutil

import pytest
import yaml
from shapely.geometry import LineString
from shapely.ops import substring

from run_helpers import blank_figures
from test_site import BALLS, EAST, NORTH, ROAD, gis, make, slope, told, write_files, write_layer  # noqa: F401

from slope_tools import digits
from slope_tools.commands import study as study_command
from slope_tools.deposits import volume_files
from slope_tools.errors import SlopeError
from slope_tools.sites import site_choices, site_layers, site_roads
from slope_tools.statistics.entries import Kind
from slope_tools.studies import road_numbers
from slope_tools.studies.road_numbers import Number
from slope_tools.survey import network, rasters, roads
from slope_tools.tables import named_run
from slope_tools.tables.study_file import load_study

NEAR, FAR = [(38, 0), (46, 0), (46, 80), (38, 80)], [(4, 0), (12, 0), (12, 80), (4, 80)]
OF_ONE = ("body", "collected", "machine", "jobs", "package", "road")     # which are of the time, or the name


def write_lines(path, *features):
    """Lines with the attribute name, in local metres."""
    path.write_text(json.dumps({"type": "FeatureCollection", "crs": {"type": "name", "properties": {
        "name": "urn:ogc:def:crs:EPSG::6677"}}, "features": [
            {"type": "Feature", "properties": {"Name": name} if name else {}, "geometry": {
                "type": "LineString", "coordinates": [[x + EAST, y + NORTH] for x, y in points]}}
            for name, points in features]}))


def plain(about):
    """What study.yaml says, without what another road or time makes different."""
    return {**{key: value for key, value in about.items() if key not in ("roads", "next_step")},
            "warnings": [one for one in about["warnings"] if one["kind"] != "roads meet"],
            "runs": [{key: value for key, value in row.items() if key != "summary"} for row in about["runs"]],
            "study": {key: value for key, value in about["study"].items() if key not in OF_ONE}}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A site with three roads and its study by the sweep; the folder and what the study printed."""
    folder = tmp_path_factory.mktemp("roads")
    write_files(folder)
    for name, points in (("near", NEAR), ("far", FAR)):
        write_layer(folder / f"{name}.geojson", points)
    made = make(folder, "--shape", "ellipsoid", "--depth", "5", "--balls", BALLS, "--road", "far.geojson", "--road",
                "road.geojson", "--road", "near.geojson")
    assert made.returncode == 0, made.stderr
    site = folder / "mine" / "site.yaml"
    site.write_text(site.read_text().replace("rolling: [0.0, 0.05, 0.1]", "rolling: [0.05, 0.1]").replace(
        "spacing: [0.5, 0.7]", "spacing: []").replace("largest_restitution: 0.9", "largest_restitution: null"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(volume_files, "draw_removal", lambda path, *_: path.touch())
        blank_figures(patch)
        study = slope(folder, "study", "mine", "--paper", "--levels", "1")
    assert study.returncode == 0, study.stderr
    return folder, made.stdout, study.stdout


def about_in(folder):
    return yaml.safe_load((folder / "study.yaml").read_text())


def test_each_road_has_the_numbers_of_a_site_with_it_alone(done, tmp_path, monkeypatch):
    folder, said, _ = done
    mine = folder / "mine"
    assert site_choices.found(mine).roads == ("far", "road", "near")
    assert "far.road.csv: 1 polygon" in said and "near.road.csv" in said
    monkeypatch.setattr(study_command, "write_site_report", lambda *_, **__: None)
    with open(mine / "roads.csv", encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    alone = tmp_path / "near"
    shutil.copytree(folder, alone)
    made = slope(alone, "site", "mine", "--road", "near.geojson")
    assert made.returncode == 0, made.stderr
    made = slope(alone, "study", "mine", "--paper", "--levels", "1")
    assert made.returncode == 0 and "are finished already" in made.stdout, made.stderr
    own, beside, far = (about_in(part / "study") for part in (alone / "mine", *(
        mine / "roads" / name for name in ("near", "far"))))
    assert plain(own) == plain(beside)
    assert own["roads"] == beside["roads"] == [] and beside["study"]["road"]["name"] == "near"
    removed = [row["remove_m3"] for row in own["runs"]]
    assert [float(row["remove_m3"]) for row in table if row["road"] == "near"] == removed
    assert removed != [row["remove_m3"] for row in far["runs"]] == [
        float(row["remove_m3"]) for row in table if row["road"] == "far"]
    assert not (alone / "mine" / "roads.csv").exists()      # studies of the other roads stay, and are refused
    assert not list((alone / "mine" / "roads").glob("*/report.*"))
    made = slope(alone, "report", "mine/roads/far", "--no-film")
    assert made.returncode == 2 and "its study had another choice of roads" in made.stderr
    assert len(table) == 3 * len(own["runs"])


def test_files_of_the_user_stay(done, tmp_path, monkeypatch):
    """In a folder called roads, or a roads.csv of his own, which a study of several roads refuses before its runs."""
    monkeypatch.setattr(study_command, "run_site_of", lambda *_: road_numbers.Made((), None))
    for words, status in (("--road far.geojson", 0), ("--road far.geojson --road near.geojson", 2)):
        folder = tmp_path / str(status)
        shutil.copytree(done[0], folder)
        assert slope(folder, "site", "mine", *words.split()).returncode == 0
        mine = folder / "mine"
        theirs = [mine / one for one in ("roads/mine/axis.gpkg", "roads/mine/report.html", "roads/far/notes.txt",
                                         "roads/far/report.docx", "roads.csv")]
        for path in theirs:
            path.parent.mkdir(exist_ok=True)
            path.write_text("of the user\n")
        made = slope(folder, "study", "mine", "--levels", "1")
        assert made.returncode == status and ("roads.csv: must not exist" in made.stderr) is bool(status)
        for path in theirs:
            assert path.read_text() == "of the user\n"
        assert (mine / "study" / "study.yaml").is_file()


def test_a_lane_wider_than_a_road_is_refused_before_the_runs(done, tmp_path):
    folder = tmp_path / "wide"
    shutil.copytree(done[0], folder)
    path = folder / "mine" / "site.yaml"
    path.write_text(path.read_text().replace("lane: null", "lane: 9.5"))
    shutil.rmtree(folder / "mine" / "runs")
    made = slope(folder, "study", "mine", "--paper", "--levels", "1")
    assert made.returncode == 2 and "--lane: must be at most as wide as the road, 8 m, got 9.5" in made.stderr
    assert not (folder / "mine" / "runs").exists()


def test_the_worst_stands_for_the_site(done):
    """In the folder of the site, on its first page, and for whatever takes its folder."""
    folder, _, said = done
    mine = folder / "mine"
    whole = about_in(mine / "study")
    first, *others = road_numbers.read_road_numbers(load_study(mine / "study" / "study.yaml"))
    assert first.counts_m3 == max(one.counts_m3 for one in (first, *others)) and len(others) == 2
    assert plain(whole) == plain(about_in(mine / "roads" / first.road / "study"))
    assert (mine / "road.csv").read_text() == (mine / f"{first.road}.road.csv").read_text()
    assert named_run.read_named_run(str(mine)).study == mine / "study"
    page = html.unescape((mine / "report.html").read_text(encoding="utf-8"))
    assert f'Of 3 roads this is the worst, "{first.road}"; "' in page
    for one in others:
        assert f'"{one.road}": {digits.typeset(one.text)}, {one.reaching} of {one.runs} runs' in page
    for one in (first, *others):
        assert f"roads/{one.road}/report.html" in page and (mine / "roads" / one.road / "report.html").is_file()
        assert one.text.partition(" m3")[0] in page and one.text in said
    assert f"report.html is of the worst, {first.road}" in said
    assert said.count("conservative volume to remove") == 1       # of the worst alone
    again = slope(folder, "report", f"mine/roads/{others[0].road}", "--no-film")
    assert again.returncode == 0, again.stderr


def test_a_study_of_other_roads_is_no_answer(done, tmp_path, blank_pictures):
    """Of a site or of one of its roads, by whatever path, for page, rasters and zones; `study` makes it anew."""
    blank_pictures()
    folder = tmp_path / "other"
    shutil.copytree(done[0], folder)
    for words in ("report mine --no-film", "export mine", "export mine --zones 0.9", "report mine/roads/far --no-film",
                  "export mine/roads/far --zones 0.9 -o far"):
        made = slope(folder, *words.split())
        assert made.returncode == 0, made.stderr
    assert "10 runs cannot tell" not in made.stdout and " 1 runs cannot tell" not in made.stdout
    assert slope(folder, "site", "mine", "--road", "far.geojson", "--road", "near.geojson").returncode == 0
    for words in ("report mine --no-film", "export mine", "export mine --zones 0.9", "report mine/roads/road --no-film",
                  "export mine/roads/road"):
        made = slope(folder, *words.split())
        assert made.returncode == 2 and "as it was studied: its study had another choice of roads" in made.stderr
    for words in ("report road --no-film", "export road"):
        made = slope(folder / "mine" / "roads", *words.split())
        assert made.returncode == 2 and "must be as it was studied" in made.stderr
    assert slope(folder, "report", "mine/roads/far", "--no-film").returncode == 0
    assert slope(folder, "site", "mine", "--road", "far.geojson", "--road", "near.geojson", "--cut-angle",
                 "45").returncode == 0
    made = slope(folder, "report", "mine/roads/far", "--no-film")
    assert made.returncode == 2 and "its study had another cut_angle of the road" in made.stderr


def test_a_road_elsewhere_is_not_on_the_body(done):
    """Nor are warnings of another road on its page."""
    mine = done[0] / "mine"
    for name in ("far", "road"):
        about = about_in(mine / "roads" / name / "study")
        assert all(row["road_on_body_m2"] == 0 for row in about["runs"])
        assert all(one["numbers"].get("file") in (None, name, f"{name}.road.csv") for one in about["warnings"]
                   if one["kind"] != "roads meet"), name
        assert ("roads meet" in [one["kind"] for one in about["warnings"]]) == (name != "far")


def test_a_run_on_a_road_is_drawn_with_its_own_volume(done):
    """Each road has its own folder in that of a run; the site's page would show another road's volume otherwise."""
    mine = done[0] / "mine"
    run = next(one for one in (mine / "runs").iterdir() if (one / "volume" / "volume.yaml").is_file())
    found = {name: yaml.safe_load((run / name / "volume.yaml").read_text())["volume"]["remove"]
             for name in ("volume", "volume_far", "volume_road", "volume_near")}
    worst = road_numbers.read_road_numbers(load_study(mine / "study" / "study.yaml"))[0].road
    assert found["volume"] == found[f"volume_{worst}"] and len(set(found.values())) == 3


NUMBER, FLOOR, WITHHELD, NOTHING = Kind.NUMBER, Kind.FLOOR, Kind.WITHHELD, Kind.NOTHING


@pytest.mark.parametrize("several, order, words", [
    ([("a", NUMBER, 500.0, 450.0), ("b", FLOOR, 700.0, 650.0)], "ba", ["at least 700 m3", "500 m3"]),
    ([("a", NUMBER, 500.0, 450.0), ("b", FLOOR, 450.0, 900.0)], "ba", ["at least 450 m3", "500 m3"]),
    ([("a", NUMBER, 500.0, 450.0), ("b", WITHHELD, None, 800.0)], "ba", ["not usable", "500 m3"]),
    ([("a", NUMBER, 500.0, 450.0), ("b", WITHHELD, 900.0, 300.0)], "ab", ["500 m3", "not usable"]),
    ([("a", NOTHING, 0.0, 0.0), ("b", FLOOR, 0.0, 0.0), ("c", NUMBER, 12.34, 12.0)], "cba",
     ["12.3 m3", "more than 0 m3", "0 m3"]),
    ([("a", NOTHING, 0.0, 0.0), ("b", WITHHELD, None, 0.0)], "ba", ["not usable", "0 m3"]),
    ([("a", NOTHING, 0.0, 0.0, 1, 2, 0.04), ("b", NOTHING, 0.0, 0.0, 1, 2, 0.17)], "ba", ["0 m3", "0 m3"]),
    ([("a", None, None, 12.0), ("b", NUMBER, 11.0, 10.0)], "ab", ["no number, up to 12 m3 in a run", "11 m3"])])
def test_the_worst_is_the_largest(several, order, words):
    found = road_numbers.in_order([Number(*one, *(1, 2)[:6 - len(one)]) for one in several])
    assert "".join(one.road for one in found) == order
    assert [one.text.replace("12.0", "12").replace("11.0", "11").replace("0.00", "0") for one in found] == words


@pytest.mark.parametrize("names, found", [
    (("Old road", "Route 4"), ["Old road", "Route 4"]), (("A", "A"), ["A", "A_2", "A both carriageways"]),
    ((None, None), ["two_1", "two_2"]), (("A", None), ["A", "two_2"])])
def test_lines_that_do_not_meet_are_each_a_road(tmp_path, gis, names, found):  # noqa: F811
    points = [(10, 5), (10, 70)], [(30, 5), (30, 40), (34, 70)]
    write_lines(tmp_path / "two.geojson", *zip(names, points))
    raster = rasters.read_raster(gis / "dem.tif")
    raster = raster._replace(transform=type(raster.transform).translation(-EAST, -NORTH) @ raster.transform,
                             offset=(EAST, NORTH))
    each = roads.read_each(tmp_path / "two.geojson", raster, roads.Asked(width=6.0))
    assert list(each) == found
    assert [one.line.coords[0][0] for one in each.values()][:2] == pytest.approx([10, 30])
    one = tmp_path / "one.geojson"
    write_lines(one, ("A", points[0]), ("B", [(10, 70), (12, 76)]))
    assert list(roads.read_each(one, raster, roads.Asked(width=6.0))) == ["one"]       # they meet
    with pytest.raises(SlopeError, match="must hold one line, for --road-width"):
        roads.read_local(tmp_path / "two.geojson", raster, roads.Asked(width=6.0))


def drawn(*lines, **about):
    return [network.Drawn(LineString(points), {**about, **more}) for points, more in (
        one if isinstance(one[-1], dict) else (one, {}) for one in lines)]


def lengths(*lines):
    return [round(one.line.length, 2) for one in network.roads_of(drawn(*lines))]


A, B = {"NAME": "A"}, {"name": "B"}
SOUTH, NORTH_, SIDE = [(70, 0), (70, 80)], [(70, 80), (70, 160)], [(70, 80), (20, 80)]
RING = [(10 * math.sin(k * math.pi / 8), 10 * math.cos(k * math.pi / 8)) for k in range(17)]
ROUND = math.dist(*RING[:2]) * 16      # m


@pytest.mark.parametrize("lines, found", [
    ((SOUTH, NORTH_, SIDE), [160, 50]), ((SIDE, NORTH_[::-1], SOUTH), [50, 160]),       # T
    (([(70, 0), (70, 160)], SIDE), [160, 50]), (([(70, 0), (70, 160)], SIDE[::-1]), [160, 50]),
    (([(0, 0), (0, 100)], [(0, 100), (-60, 180)], [(0, 100), (30, 200)]), [204.4, 100]),      # Y
    ((([(0, 0), (0, 100)], A), ([(0, 100), (-60, 180)], A), ([(0, 100), (0, 200)], B)), [200, 100]),
    ((([(0, 0), (0, 100)], {"ref": "4"}), ([(0, 100), (-60, 180)], {"Ref": "4", **A}), [(0, 100), (0, 200)]),
     [200, 100]),
    (([(0, -50), (0, 0)], [(0, 0), (0, 50)], [(-50, 0), (0, 0)], [(0, 0), (50, 0)]), [100, 100]),     # crossing
    (([(0, -50), (0, 50)], [(-50, 0), (0, 0)], [(0, 0), (50, 0)]), [100, 100]),
    (([(0, -50), (0, 50)], [(-50, 0), (50, 0)]), [100, 100]),
    (([(0, -50), (0, 50)], [(-50, -50), (0, 0)], [(0, 0), (-50, 50)]), [100, 70.71, 70.71]),     # two side roads
    (([(0, -80), RING[8]], RING, [RING[0], (0, 80)]), [140 + ROUND / 2, ROUND / 2]),     # roundabout
    (([(0, -80), RING[8]], RING[3:9], RING[8:], RING[:4], [RING[0], (0, 80)]), [140 + ROUND / 2, ROUND / 2]),
    (([(0, -80), RING[8]], RING, [RING[0], (0, 80)], [RING[4], (80, 0)]), [140 + ROUND / 2, ROUND / 2, 70]),
    (([(0, -80), RING[8]], RING, [RING[0], (0, 80)], [RING[4], (80, 0)], [RING[12], (-80, 0)]),
     [140 + ROUND / 2, ROUND / 2, 140 + ROUND / 2]),
    (([(0, 0), (0, 100)], [(0, 100), (60, 110), (60, 190), (0, 200)], [(0, 100), (0, 200)], [(0, 200), (0, 300)]),
     [300, 201.66]),    # an old loop of a road
    (([(0, 0), (0, 99)], [(0, 99), (40, 150), (-40, 150), (0, 99)]), [99, 209.63]),
    (([(0, 0), (9, 0)], [(9, 0), (9, 9)], [(9, 9), (0, 9)], [(0, 9), (0, 0)]), [36])])
def test_ways_that_meet_are_roads(lines, found):
    assert lengths(*lines) == pytest.approx(found, abs=0.05)


@pytest.mark.parametrize("cut", [(40,), (10, 80, 130), (80,)])
@pytest.mark.parametrize("turned", [False, True])
def test_where_the_ways_of_a_road_are_cut_does_not_matter(cut, turned):
    """A bend at a side road, carriageways that part and come together: the same lines, whoever drew them."""
    road = LineString([(0, 0), (0, 80), (40, 140), (40, 200)])
    for other in ([(0, 80), (-50, 80)], [(0, 80), (-20, 110), (-20, 190), (40, 170)], [
            (0, 80), (-20, 110), (-20, 190), (40, 200)]):
        ends = (0, *cut, road.length)
        parts = [substring(road, *pair).coords[::-1 if turned else 1] for pair in zip(ends[:-1], ends[1:])]
        found = [one for one in network.roads_of(drawn(*map(list, parts), name="A") + drawn(other)) if one.names]
        assert len(found) == 1 and found[0].line.hausdorff_distance(road) < 1e-6
        assert found[0].line.coords[0][1] == (200 if turned else 0)       # chainage runs as it was drawn


def test_carriageways_have_a_number_together(tmp_path, gis):  # noqa: F811
    """Of one name, or without any and next to each other; a service road beside is none, nor is a side road."""
    raster = rasters.read_raster(gis / "dem.tif")
    raster = raster._replace(transform=type(raster.transform).translation(-EAST, -NORTH) @ raster.transform,
                             offset=(EAST, NORTH))
    north, south, lane = [(10, 5), (10, 70)], [(18, 70), (18, 5)], [(14, 20), (14, 60)]
    for names, number in ((("M1", "M1"), 3), ((None, None), 3), (("M1", None), 2), (("M1", "M2"), 2)):
        write_lines(tmp_path / "m.geojson", *zip(names, (north, south)))
        each = roads.read_each(tmp_path / "m.geojson", raster, roads.Asked(width=6.0))
        assert len(each) == number
    write_lines(tmp_path / "m.geojson", ("M1", north), ("M1", south), (None, lane), (None, [(18, 40), (38, 40)]))
    each = roads.read_each(tmp_path / "m.geojson", raster, roads.Asked(width=6.0))
    assert list(each) == ["M1", "M1_2", "m_3", "m_4", "M1 both carriageways"]
    said, = roads.meetings({name: ("m.geojson", one) for name, one in each.items()}, raster)
    assert said.kind == "roads meet" and said.numbers["places"].startswith(
        f"M1_2 and m_4 at east {EAST + 18:.1f} north {NORTH + 40:.1f}") and "M1 and M1_2" not in said.numbers["places"]
    both = each["M1 both carriageways"]
    assert both.polygon.equals(each["M1"].polygon.union(each["M1_2"].polygon)) and len(both.lines) == 2
    assert site_layers.describe_road_shape(both, 6.0) == "2 lines of 65 and 65 m, 6 m wide"
    touching = both._replace(polygon=both.polygon.buffer(2))        # of one polygon, where they come together
    assert site_layers.describe_road_shape(touching, 6.0).startswith("2 lines of 65 and 65 m")
    roads.write_road(tmp_path / "both.csv", both, raster)
    again = roads.read_local(tmp_path / "both.csv", raster, roads.Asked(width=6.0), local=True)
    assert again.polygon.symmetric_difference(both.polygon).area < 1e-6 and len(again.lines) == 2
    with pytest.raises(SlopeError, match=f"got 4 that meet at east {EAST + 18:.1f} north {NORTH + 40:.1f}"):
        roads.read_local(tmp_path / "m.geojson", raster, roads.Asked(width=6.0))


def test_roads_that_nearly_meet_are_told(tmp_path, gis):  # noqa: F811
    """Ends drawn by eye, pieces of one road in files of their own, and polygons."""
    raster = rasters.read_raster(gis / "dem.tif")
    raster = raster._replace(transform=type(raster.transform).translation(-EAST, -NORTH) @ raster.transform,
                             offset=(EAST, NORTH))
    asked = roads.Asked(width=6.0)
    for gap in (0.0, 0.5, 1.9, 2.5, 6.0):
        halves = [(10, 5), (10, 40)], [(10, 40 + gap), (10, 70)]
        write_lines(tmp_path / "one.geojson", *((None, half) for half in halves))
        each = roads.read_each(tmp_path / "one.geojson", raster, asked)
        assert len(each) == 1 + (gap > network.GAP)
        assert sum(one.line.length for one in each.values()) == pytest.approx(65 - gap * (len(each) - 1))
        assert len(roads.meetings({name: ("one", one) for name, one in each.items()}, raster)) == (gap == 2.5)
        apart, shapes = {}, {}
        for name, half in zip("ab", halves):
            write_lines(tmp_path / f"{name}.geojson", (None, half))
            apart[name] = name, *roads.read_each(tmp_path / f"{name}.geojson", raster, asked).values()
            shapes[name] = name, roads.Road(apart[name][1].polygon)
        for several in (apart, shapes):
            found = roads.meetings(several, raster)
            assert len(found) == (gap < 5) and all(one.numbers["file"] == "a, b" for one in found)


def test_roads_of_one_name_and_of_a_layer(told, gis):  # noqa: F811
    write_lines(gis / "two.geojson", ("Old road", [(10, 5), (10, 70)]), ("Route 4", [(30, 5), (30, 70)]))
    (gis / "b").mkdir()
    write_lines(gis / "b" / "two.geojson", ("Route 4", [(20, 5), (20, 70)]), ("国道4号", [(24, 5), (24, 70)]))
    status, out, err = told("--terrain", "dem.tif", "--release", "release.geojson", "--shape", "ellipsoid", "--depth",
                            5, "--road", "two.geojson", "--road", "b/two.geojson", "--road-width", 2, "-o", "mine")
    assert status == 0, err
    site = site_choices.load_site(gis / "mine")
    assert site_roads.names(site) == ["Old_road", "Route_4", "Route_4_2", "国道4号"]
    assert site.choices.road.file.endswith("two.geojson")
    assert len(site.choices.road.others) == 1 and "Route_4_2.road.csv: 1 line of 65 m, 2 m wide" in out
    status, out, err = told("mine", "--road", "road.geojson")
    assert status == 2 and "--road-width" in err        # it is a polygon
    edited = yaml.safe_load((gis / "mine" / "site.yaml").read_text())
    assert edited["road"]["others"]                      # nothing has changed
    assert sorted(path.name for path in (gis / "mine").glob("*road.csv")) == [
        "Old_road.road.csv", "Route_4.road.csv", "Route_4_2.road.csv", "road.csv", "国道4号.road.csv"]


def test_blocks_have_one_road(told, gis):  # noqa: F811
    write_layer(gis / "far.geojson", FAR)
    status, _, err = told("--terrain", "dem.tif", "--release", "release.geojson", "--blocks", 40, "--size", 1, "--road",
                          "road.geojson", "--road", "far.geojson", "-o", "cliff")
    assert status == 2 and "--road: must be one with single blocks; --line takes others" in err
    write_lines(gis / "two.geojson", ("a", [(10, 5), (10, 70)]), ("b", [(30, 5), (30, 70)]))
    status, _, err = told("--terrain", "dem.tif", "--release", "release.geojson", "--blocks", 40, "--size", 1, "--road",
                          "two.geojson", "--road-width", 4, "-o", "cliff")
    assert status == 2 and "--road: must be one with single blocks; --line takes others, got a, b" in err
