"""What the console says: numbers without powers of ten, each warning once, all that is missing, hints for lines as for
polygons."""
import re
import shlex
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from shapely.geometry import LineString

from messages import says
from run_helpers import EAST, NORTH, TOP, called, write_asc, write_geojson, write_sidecar

from slope_tools import digits, findings, options
from slope_tools.commands import site as site_command
from slope_tools.errors import SlopeError
from slope_tools.finding_words import WORDS, words_of
from slope_tools.fitting import observations
from slope_tools.report.numbers import Numbers
from slope_tools.runs import job_display
from slope_tools.sites import site_budget
from slope_tools.studies import study
from slope_tools.studies.setup import Road
from slope_tools.survey import lines, rasters, roads
from slope_tools.tables import study_table


@pytest.mark.parametrize("kind", [kind for kind in WORDS if re.search(r"percent:\.[23]g", words_of(kind).text)])
def test_nearly_all_is_no_power_of_ten(kind):
    names = set(re.findall(r"{(\w+)", words_of(kind).text)) - {"percent"}
    text = findings.Finding(kind, {**{name: 1.0 for name in names}, "percent": 99.97}).text
    assert "100 %" in text and "e+" not in text


def test_shares_and_numbers_of_nothing():
    shares = (0.9999, 1.0, 0.0, 0.00021, 0.305)
    assert [digits.cents(one) for one in shares] == ["100 %", "100 %", "0 %", "0.021 %", "30 %"]
    assert digits.cents(0.99996, 3) == "100 %"
    assert [digits.format_plain(one) for one in ("-1.2e+03", "1e-05", "12")] == ["-1200", "1e-05", "12"]
    assert study_table.round_volume(7.62e-11, None) == "0" == Numbers()("beyond it", "m3", 7.62e-11)
    assert study_table.round_volume(0.0762, None) == "0.0762" == Numbers()("beyond it", "m3", 0.0762)
    assert Numbers()("frequency", "per year", 2.5e-7) == "0.000000250"


def test_sizes_are_never_powers_of_ten():
    """Of 105 m .2g makes 1e+02 m, of 1285 m .3g 1.29e+03 m; findings are written by digits of their own."""
    tools = TOP / "tools" / "slope_tools"
    found = [f"{path.relative_to(tools)}: {match}" for path in tools.rglob("*.py") if path.name != "finding_words.py"
             for match in re.findall(r"{[^{}]*:,?\.[123]g} (?:m|m/s|m3|GB|MB|gal)\b", path.read_text(encoding="utf-8"))]
    assert not found
    assert digits.rounded(104.6, 2) == "105" and digits.metres(1285.3) == "1,285 m"


def test_a_warning_is_said_once(capsys):
    warn, kept = findings.warner("site")
    several = [findings.Finding("no line", {"file": name, "kinds": "Point"}) for name in ("a.shp", "a.shp", "b.shp")]
    for one in several:
        warn(one)
    assert capsys.readouterr().err.count("Point") == 2 == len(kept)
    tell = findings.printer("study")
    for one in several:
        tell(one)
    assert capsys.readouterr().err.count("Point") == 2


def test_the_number_of_balls_is_one_number():
    """That of the program, in --help, on the page and in QGIS."""
    assert site_command.Request.__mro__ and any(
        f"--balls {site_budget.DEFAULT})" in vars(one).get("GROUP", "") for one in site_command.Request.__mro__)
    page = (TOP / "doc" / "src" / "tool_site.rst").read_text(encoding="ascii")
    assert f"coarsest ones of the study (:ref:`study_sizes`): {site_budget.DEFAULT:,}, or more" in page
    plugin = (TOP / "tools" / "qgis" / "slope" / "site.py").read_text(encoding="utf-8")
    assert f"Balls in the body (default: {site_budget.DEFAULT})" in plugin


def test_a_time_limit_is_no_estimate(monkeypatch):
    """Where fix halt ends most runs before their last step."""
    job = SimpleNamespace(began=0.0, run=SimpleNamespace(name="a", varied="a", log=SimpleNamespace(
        thermo=1, step=6000, last=2_418_249, first=0, time=3.0)))
    said = []
    monkeypatch.setattr(job_display.Display, "say", lambda self, line: said.append(line))
    for halts in (False, True):
        display = job_display.Display([job.run], [job.run], lambda: 1, halts)
        display.printed["a"], display.live = -1e9, None
        display.update([job], 0)
    assert "6000 of 2418249" in said[1] and " by " not in said[1] and "ends by" in said[0]


def test_what_is_left_is_reckoned_by_size(monkeypatch):
    """Of a size that no run has ended with, by the nearest one: half the diameter is 16 times the work."""
    todo = [SimpleNamespace(name=str(k), varied="", chosen={"d": d} if d else {}) for k, d in enumerate(
        ("1", "1", "0.5", "", "0.25"))]
    display = job_display.Display(todo, todo, lambda: 2)
    display.walls = {1.0: [10.0, 20.0], 0.5: [100.0]}
    assert display._ends(5) == pytest.approx((15 + 15 + 100 + 15 + 1600) / 2)
    assert display._ends(7) == pytest.approx((15 + 15 + 100 + 15 + 1600 + 100) / 2)      # two are under way


# --- lines and roads ---

def terrain(size=60):
    write_asc("terrain.asc", np.zeros((size, size)), 2.0)
    write_sidecar(size, size, 2.0)
    return rasters.read_place(Path("terrain.asc"))


@pytest.mark.parametrize("crs", ["EPSG:6677", None])
def test_a_line_with_the_northing_first_gets_the_hint_of_a_polygon(here, crs):
    """Of metres, and of degrees of a place where both are below 90."""
    place = terrain()
    line = LineString([(EAST + 20, NORTH + 30), (EAST + 80, NORTH + 30)])
    if crs is None:
        line = LineString(np.transpose(lines.transform(rasters.CRS.from_epsg(6677), rasters.CRS.from_epsg(4326),
                                                       *np.transpose(line.coords))))
        swapped = LineString([(y, x) for x, y in line.coords])
        assert max(np.abs(swapped.coords).ravel()) > 90        # of Japan: degrees beyond the pole
    write_geojson("road.geojson", LineString([(y, x) for x, y in line.coords]), crs=crs)
    with pytest.raises(SlopeError) as caught:
        roads.read_local("road.geojson", place, roads.Asked(6.0))
    assert "with x and y exchanged" in str(caught.value)
    assert crs or "must be longitude and latitude" in str(caught.value)


def test_latitude_first_in_europe(here):
    """Both are below 90: only the other order tells."""
    write_asc("terrain.asc", np.zeros((60, 60)), 2.0)
    write_sidecar(60, 60, 2.0, crs="EPSG:32632")
    place = rasters.read_place(Path("terrain.asc"))._replace(offset=np.array([500000.0, 5100000.0]))
    to = lines.transform(rasters.CRS.from_epsg(32632), rasters.CRS.from_epsg(4326),
                         np.array([500020.0, 500080.0]), np.array([5100030.0, 5100030.0]))
    write_geojson("road.geojson", LineString(np.transpose(to[::-1])))
    with pytest.raises(SlopeError) as caught:
        roads.read_local("road.geojson", place, roads.Asked(6.0))
    assert says(str(caught.value), "road.geojson: must overlap the terrain (with x and y exchanged it would)")


def test_a_road_of_a_layer_is_there(here):
    """FILE|layername=NAME, as QGIS has it."""
    write_geojson("road.geojson", LineString([(1, 2), (3, 4)]))
    Path("in.none").write_text("variable rolling index 0\n")
    study.check_deck_road(Road(Path("road.geojson|layername=road")), Path("in.none"), {})
    mapped = observations.Wanted(Path("road.geojson|layername=road"), None, None, None, 0.1, 0.1, False)
    mapped.check(False)
    for check in (lambda: study.check_deck_road(Road(Path("no.geojson|layername=road")), Path("in.none"), {}),
                  lambda: replace(mapped, observed=Path("no.geojson|layername=road")).check(False)):
        with pytest.raises(SlopeError, match="must be an existing file"):
            check()


def test_all_that_is_missing_is_said_at_once(here, capsys):
    """Before the body is computed."""
    terrain()
    for name in ("road.geojson", "second.geojson"):
        write_geojson(name, LineString([(EAST + 20, NORTH + 30), (EAST + 80, NORTH + 30)]), crs="EPSG:6677")
    status, _, err = called(capsys, shlex.split("site --terrain terrain.asc --release release.geojson --road "
                                                "road.geojson --road second.geojson --wall road.geojson -o mine"))
    assert status == 2 and err.count("\n") == 1, err
    for item in ("--depth", "road.geojson: ", "second.geojson: ", "--road-width", "--height"):
        assert item in err, err


@pytest.mark.parametrize("names, keys", [
    (("ncols", "nrows", "xllcorner", "yllcorner", "cellsize", "NODATA_value"), "ncols 3, nrows 2, xllcorner 0"),
    (("mx", "my", "xlower", "ylower", "dx", "nodata_value"), "ncols 3, nrows 2, xllcenter 0"),
    (("columns", "rows", "west", "south", "cell", "none"), None)])
def test_a_grid_with_its_head_turned(here, capsys, names, keys):
    """As GeoClaw and D-Claw write it."""
    head = "".join(f"{value} {name}\n" for value, name in zip((3, 2, 0, 0, 10, -9999), names))
    Path("topo.asc").write_text(head + "1 2 3\n4 5 6\n")
    status, _, err = called(capsys, ["terrain", "topo.asc", "-o", "out.asc"])
    assert status == 2 and err.count("\n") == 1 and ("values before the keys" in err) == bool(keys), err
    assert not keys or f"write {keys}" in err


def test_the_words_of_a_request_are_those_that_were_typed():
    """Of every kind of option."""
    asked = site_command.Request(terrain=["a.tif", "b c.tif"], bounds=[1.5, -2.0, 3.0, 4.0], rolling=[0.1], balls=300)
    words = options.words_of(asked)
    assert words[words.index("--bounds"):][:5] == ["--bounds", "1.5", "-2", "3", "4"] and "b c.tif" in words
