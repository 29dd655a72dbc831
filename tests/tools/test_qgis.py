"""tools/qgis: every algorithm in QGIS without windows, its layers with their styles, the same numbers as on the command
line; layers that are no files; Cancel; errors; the zip."""
import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import zipfile
from pathlib import Path

import fiona
import numpy as np
import pytest
import rasterio
import yaml
from affine import Affine
from shapely.affinity import translate
from shapely.geometry import LineString, box, shape

from run_helpers import CRS_M, EAST, NORTH, TOOLS, TOP, write_geojson, write_sidecar
from tiny_collapse import COLUMNS, LMP, ROWS, processes_in, read_asc, write_case

PLUGIN = TOOLS / "qgis" / "slope"
INSIDE = Path(__file__).parent / "qgis_inside.py"
# Debian's qgis_process hands an option of the desktop on to qgis_process.bin, which does not know it
QGIS = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
ALGORITHMS = {"terrain", "release", "site", "study", "report", "volume", "export", "mobility", "score", "calibrate",
              "quake", "stability", "fragility"}
ROAD, FAR = (8, 0, 15, ROWS), (16, 0, 20, ROWS)
RELEASE = (16, 5, 30, 19)

pytestmark = [pytest.mark.long, pytest.mark.skipif(QGIS is None, reason="no QGIS (Debian: qgis, python3-qgis)")]


def in_survey(bounds):
    west, south, east, north = bounds
    return EAST + west, NORTH + south, EAST + east, NORTH + north


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """Environment of a user who has the plugin's folder in QGIS_PLUGINPATH and has enabled the plugin."""
    folder = tmp_path_factory.mktemp("home")
    (folder / "run").mkdir(mode=0o700)
    found = {**os.environ, "HOME": str(folder), "XDG_RUNTIME_DIR": str(folder / "run"), "QT_QPA_PLATFORM": "offscreen",
             "QGIS_PLUGINPATH": str(PLUGIN.parent), "SLOPE_TOOLS": str(TOOLS), "LMP": LMP,
             "PYTHONDONTWRITEBYTECODE": "1"}
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "QGIS_CUSTOM_CONFIG_PATH"):
        found.pop(name, None)
    subprocess.run([QGIS, "plugins", "enable", "slope"], env=found, check=True, capture_output=True)
    return found


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    """A run in run/, its deck in deck/, and what a GIS has of the place: dem.tif, road.geojson, release.geojson."""
    folder = tmp_path_factory.mktemp("case")
    for name in ("deck", "run"):
        (folder / name).mkdir()
        write_sidecar(ROWS, COLUMNS, 1.0, path=folder / name / "terrain.asc")
        write_case(folder / name)
    subprocess.run([LMP, "-in", "in.tiny", "-var", "steps", "900"], cwd=folder / "run", check=True,
                   stdout=subprocess.DEVNULL)
    write_geojson(folder / "road.geojson", box(*in_survey(ROAD)), crs=CRS_M)
    write_geojson(folder / "release.geojson", box(*in_survey(RELEASE)), crs=CRS_M)
    for name, crs in (("dem.tif", CRS_M), ("untagged.tif", None)):
        with rasterio.open(folder / name, "w", driver="GTiff", height=ROWS, width=COLUMNS, count=1, dtype="float64",
                           crs=crs, transform=Affine(1, 0, EAST, 0, -1, NORTH + ROWS)) as out:
            out.write(read_asc(folder / "run" / "terrain.asc"), 1)
    return folder


@pytest.fixture
def place(case, tmp_path, monkeypatch):
    """A copy of the case, the working folder."""
    shutil.copytree(case, tmp_path / "case")
    monkeypatch.chdir(tmp_path / "case")
    return tmp_path / "case"


@pytest.fixture
def qgis(home, place):
    """Run an algorithm by qgis_process; gives status, results, messages, standard error."""
    def run(name, **parameters):
        done = subprocess.run([QGIS, "--json", "run", f"slope:{name}", "--",
                               *(f"{key}={value}" for key, value in parameters.items())],
                              env=home, cwd=place, capture_output=True, text=True, check=False, timeout=300)
        about = json.loads(done.stdout) if done.stdout.strip() else {}
        return done.returncode, about.get("results"), about.get("log"), done.stderr
    return run


@pytest.fixture
def inside(home, place):
    """Run a function of qgis_inside.py; gives what it returns."""
    def run(function, *arguments):
        done = subprocess.run(["/usr/bin/python3", str(INSIDE), function, *map(str, arguments)], env=home, cwd=place,
                              capture_output=True, text=True, check=False, timeout=300)
        told = [line for line in done.stdout.splitlines() if line.startswith("JSON ")]
        assert done.returncode == 0 and told, done.stderr[-3000:]
        return json.loads(told[0][5:])
    return run


def slope(*words):
    """The same on the command line."""
    subprocess.run([TOOLS / "slope", *map(str, words)], check=True, capture_output=True,
                   env={**os.environ, "LMP": LMP})


def values(path):
    with rasterio.open(path) as raster:
        return raster.read(1, masked=True).astype(float).filled(np.nan)


def where(path):
    """CRS and bounds of a raster."""
    with rasterio.open(path) as raster:
        return raster.crs, tuple(raster.bounds)


HERE = (rasterio.crs.CRS.from_user_input(CRS_M), in_survey((0, 0, COLUMNS, ROWS)))


# --- what there is ---

def test_every_algorithm_explains_itself_with_units(home, inside):
    listed = subprocess.run([QGIS, "list"], env=home, capture_output=True, text=True, check=True).stdout
    assert set(re.findall(r"slope:(\w+)", listed)) == ALGORITHMS
    found = inside("algorithms")
    assert set(found) == {f"slope:{name}" for name in ALGORITHMS}
    for name, about in found.items():
        assert 100 < len(about["help"]) < 1500 and re.search(r"\bm3?\b", about["help"]), name
        for key, text in {**about["parameters"], **about["outputs"]}.items():
            assert text and text[0].isupper(), (name, key)
    lengths = [text for about in found.values() for text in about["parameters"].values()
               if re.search(r"[Dd]epths?\b.*(below|surface)|[Cc]ell size|side of|thicker", text, re.ASCII)]
    assert len(lengths) > 4 and all("m" in re.split(r"\W+", text) for text in lengths), lengths


def test_the_plugin_has_the_version_of_the_package():
    header = (TOOLS.parent / "src" / "slope_version.h").read_text()
    version = re.search(r'SLOPE_VERSION "(.*)"', header)[1]
    assert f"\nversion={version}\n" in (PLUGIN / "metadata.txt").read_text()


# --- the algorithms ---

def test_export(qgis, inside, place):
    status, results, log, err = qgis("export", RUN="run/tiny.thickness.asc", OUTPUT="gis")
    assert status == 0, err
    slope("export", "run/tiny", "-o", "same")
    kinds = {key.lower() for key in results} - {"output"}
    assert {f"tiny.{kind}.tif" for kind in kinds} == {path.name for path in Path("same").glob("*.tif")}
    for kind in kinds:
        assert np.array_equal(values(results[kind.upper()]), values(f"same/tiny.{kind}.tif"), equal_nan=True)
        assert where(results[kind.upper()]) == HERE
    assert any("still moving" in line for line in log["warning"])       # of the tool
    shown = inside("look", "map.png", *(results[key] for key in ("BASE", "THICKNESS", "MAX_SPEED", "MAX_ENERGY",
                                                                 "ARRIVAL")))
    styles = {path.split(".")[1]: style for path, style in shown["styles"].items()}
    assert styles["base"]["renderer"] == "QgsHillshadeRenderer"
    thickest = np.nanmax(values("same/tiny.thickness.tif"))
    thickness = styles["thickness"]
    assert thickness["labels"][0] == "none" and thickness["clear"] == [True] + [False] * (len(thickness["clear"]) - 1)
    last = re.fullmatch(r"(\S+) to (\S+) m", thickness["labels"][-1])
    assert float(last[1]) < thickest <= float(last[2]) and thickness["bounds"][-1] == "inf"
    assert styles["max_speed"]["labels"][-1].endswith(" m/s")
    powers = np.array([float(bound) for bound in styles["max_energy"]["bounds"][1:-1]])
    assert np.allclose(powers[2:] / powers[:-2], 10) and styles["max_energy"]["labels"][-1].endswith(" J")
    assert not any(styles["arrival"]["clear"]) and styles["arrival"]["labels"][0].endswith(" s")
    assert all(style["crs"] == CRS_M for style in styles.values())
    assert shown["colours"] > 10 and Path("map.png").stat().st_size > 1000


def test_volume(qgis, inside, place):
    status, results, _, err = qgis("volume", RUN="run/tiny.summary.yaml", ROAD="road.geojson", MESH=5, CUT_ANGLE=35,
                                   OUTPUT="out")
    assert status == 0, err
    slope("volume", "run/tiny", "--road", "road.geojson", "--mesh", 5, "--cut-angle", 35, "-o", "same")
    about = yaml.safe_load(Path("same/volume.yaml").read_text())
    assert about["volume"]["remove_on_road"] > 10
    assert results["REMOVE"] == about["volume"]["remove"]
    assert results["REMOVE_ON_ROAD"] == about["volume"]["remove_on_road"]
    assert results["REMOVE_BESIDE_ROAD"] == about["volume"]["remove_beside_road"]
    assert results["BLOCKED_LENGTH"] == about["axis"]["blocked_length"]
    assert np.array_equal(values(results["THICKNESS"]), values("same/volume.tif"), equal_nan=True)
    with fiona.open(results["CELLS"]) as cells, fiona.open("same/volume.geojson") as same:
        assert rasterio.crs.CRS.from_wkt(cells.crs_wkt) == HERE[0]
        for one, other in zip(list(cells), list(same), strict=True):
            assert shape(one["geometry"]).equals(shape(other["geometry"]))
            assert dict(one["properties"]) == dict(other["properties"])
    shown = inside("look", "map.png", results["THICKNESS"], results["CELLS"])
    cells = shown["styles"][results["CELLS"]]
    assert cells["renderer"] == "QgsGraduatedSymbolRenderer" and cells["column"] == "remove" and cells["named"]
    assert cells["labels"][0] == "none" and cells["labels"][1].endswith(" m3")
    largest = max(float(row["remove"]) for row in csv.DictReader(Path("same/volume.csv").open()))
    assert cells["bounds"][-2] < largest <= cells["bounds"][-1]
    assert shown["styles"][results["THICKNESS"]]["labels"][-1].endswith(" m") and shown["colours"] > 5


def test_release_from_an_elevation_model_and_from_a_terrain(qgis, inside, place):
    status, results, _, err = qgis("release", DEM="dem.tif", POLYGON="release.geojson", VOLUME=200, OUTPUT="new/out")
    assert status == 0, err
    Path("same").mkdir()
    slope("terrain", "dem.tif", "-o", "same/terrain.asc")
    slope("release", "same/terrain.asc", "--polygon", "release.geojson", "--volume", 200, "-o", "same/release")
    about = yaml.safe_load(Path("same/release.yaml").read_text())["body"]
    assert [results[key] for key in ("RELEASED", "LARGEST_DEPTH", "MEAN_DEPTH", "AREA")] == \
        [about[key] for key in ("volume", "largest_depth", "mean_depth", "area")]
    assert results["RELEASED"] == pytest.approx(200, rel=2e-3)
    assert Path(results["DECK_LINES"]).read_text() == Path("same/release.deck.txt").read_text()
    assert Path(results["PICTURE"]).is_file()
    for key, name in (("DEPTH_LAYER", "depth"), ("SLIP_LAYER", "slip")):
        assert np.array_equal(values(results[key]), read_asc(f"same/release.{name}.asc"), equal_nan=True)
        assert where(results[key]) == HERE
    shown = inside("look", "map.png", results["SLIP_LAYER"], results["DEPTH_LAYER"])
    assert shown["styles"][results["DEPTH_LAYER"]]["labels"][-1].endswith(" m")
    assert shown["styles"][results["SLIP_LAYER"]]["renderer"] == "QgsHillshadeRenderer"
    # a terrain of the algorithm Terrain is taken as it is, from its layer
    status, made, _, err = qgis("terrain", DEM="dem.tif", OUTPUT="part.asc",
                                BOUNDS=f"{EAST + 10},{EAST + 40},{NORTH},{NORTH + 24} [{CRS_M}]")
    assert status == 0, err
    assert where(made["LAYER"]) == (HERE[0], in_survey((10, 0, 40, 24)))
    assert np.array_equal(values(made["LAYER"]), read_asc("part.asc"))
    status, again, log, err = qgis("release", DEM=made["LAYER"], POLYGON="release.geojson", SHAPE="slbl", DEPTH=2,
                                   OUTPUT="again")
    assert status == 0 and not Path("again/terrain.asc").exists(), err
    assert any(" release part.asc " in line for line in log["info"]), log["info"]
    assert again["LARGEST_DEPTH"] == pytest.approx(2, abs=1e-3)
    assert yaml.safe_load(Path("again/release.yaml").read_text())["shape"] == "slbl"


def test_study_and_report(qgis, inside, place):
    status, results, log, err = qgis("study", DECK="deck/in.tiny", SET="rolling=0,0.1\nsteps=600", ROAD="road.geojson",
                                     MESH=5, JOBS=1, EXCEED="0.2,1", OUTPUT="study")
    assert status == 0, err
    slope("study", "deck/in.tiny", "--set", "rolling=0,0.1", "--set", "steps=600", "--road", "road.geojson", "--mesh",
          5, "--exceed", "0.2,1", "-o", "same")
    tables = [list(csv.DictReader(Path(path).open())) for path in (results["TABLE"], "same/study.csv")]
    for table in tables:
        for row in table:
            row.pop("wall_s")
    assert tables[0] == tables[1] and len(tables[0]) == 2
    about = yaml.safe_load(Path("same/study.yaml").read_text())
    withheld = about["conservative"]["withheld"]        # balls that move, and few of them on the road
    assert withheld and about["conservative"]["volume_m3"] is None and "CONSERVATIVE" not in results
    assert any(withheld[0]["text"] in line for line in log["info"] + log["warning"])
    for key in ("THICKNESS", "MAX_THICKNESS"):
        path = Path(results[key])
        assert np.array_equal(values(path), values(Path("same") / path.name)) and where(path) == HERE
    shown = inside("look", "map.png", results["MAX_THICKNESS"], "study/exceedance_0.2m.tif")
    assert shown["styles"][results["MAX_THICKNESS"]]["labels"][-1].endswith(" m")
    assert shown["styles"]["study/exceedance_0.2m.tif"]["labels"][-1] == "0.75 to 1 of the runs"
    status, page, _, err = qgis("report", FOLDER="study", OUTPUT="page.html")
    assert status == 0, err
    slope("report", "study", "-o", "same.html")
    assert Path(page["OUTPUT"]).read_text().startswith("<!DOCTYPE html>")
    assert Path(page["NUMBERS"]).read_text() == Path("same.numbers.csv").read_text()
    assert Path(page["SECTION_TABLE"]).read_text() == Path("same.section.csv").read_text()


# --- layers, project, Cancel ---

def test_layers_that_are_no_files_of_their_own(inside, place):
    road, far = (",".join(map(str, in_survey(one))) for one in (ROAD, FAR))
    for name, crs, several in (("untagged.shp", None, (ROAD,)), ("both.shp", CRS_M, (ROAD, FAR))):
        with fiona.open(name, "w", driver="ESRI Shapefile", crs=crs,
                        schema={"geometry": "Polygon", "properties": {"id": "int"}}) as out:
            for i, bounds in enumerate(several, 1):
                out.write({"type": "Feature", "geometry": box(*in_survey(bounds)).__geo_interface__,
                           "properties": {"id": i}})
    for layer, bounds in (("other", FAR), ("road", ROAD)):
        with fiona.open("several.gpkg", "w", driver="GPKG", layer=layer, crs=CRS_M,
                        schema={"geometry": "Polygon", "properties": {}}) as out:
            out.write({"type": "Feature", "geometry": box(*in_survey(bounds)).__geo_interface__, "properties": {}})
    Path("road.csv").write_text("".join(f"{x},{y}\n" for x, y in box(*ROAD).exterior.coords[:-1]))
    slope("volume", "run/tiny", "--road", "road.geojson", "--mesh", 5, "-o", "same")
    expected = yaml.safe_load(Path("same/volume.yaml").read_text())["volume"]["remove"]
    found = inside("memory", "run/tiny.thickness.asc", CRS_M, road, far)
    for name in ("one", "selected", "tagged", "layer", "text", "filtered"):
        assert found[name]["REMOVE"] == expected, name
    assert found["both"]["REMOVE"] > expected + 10
    for name in ("none", "untagged"):
        assert re.fullmatch(r"slope volume: \S+: must have a CRS, [^\n]*", found[name]["error"].strip())
        assert not Path(name).exists()


def test_an_elevation_model_whose_crs_only_qgis_knows(inside, place):
    found = inside("rasters", "dem.tif", "untagged.tif", "release.geojson", CRS_M)
    assert found["tagged"].get("RELEASED") == found["file"]["RELEASED"] > 100
    assert where(found["tagged"]["DEPTH_LAYER"]) == HERE
    assert "must have a CRS" in found["none"]["error"] and not Path("none").exists()


def test_a_crs_is_assigned_to_files_that_say_another(qgis, place):
    wrong = "EPSG:6676"
    write_geojson("wrong.geojson", box(*in_survey(RELEASE)), crs=wrong)
    with rasterio.open("dem.tif") as dem, rasterio.open("wrong.tif", "w", **{**dem.profile, "crs": wrong}) as out:
        out.write(dem.read())
    box_ = ",".join(map(str, (EAST + 10, EAST + COLUMNS, NORTH, NORTH + ROWS)))
    status, made, _, err = qgis("terrain", DEM="wrong.tif", ASSIGNED_CRS=CRS_M, BOUNDS=box_, OUTPUT="terrain.asc")
    assert status == 0 and where(made["LAYER"]) == (HERE[0], in_survey((10, 0, COLUMNS, ROWS))), err
    asked = {"DEM": made["LAYER"], "POLYGON": "wrong.geojson", "VOLUME": 200}
    assert qgis("release", **asked, OUTPUT="astray")[0] != 0
    status, results, _, err = qgis("release", **asked, POLYGON_CRS=CRS_M, OUTPUT="out")
    assert status == 0 and results["RELEASED"] == pytest.approx(200, rel=2e-3), err


def test_the_volume_of_a_road_that_is_a_line(inside, place):
    """As of its polygon, with stretches and a lane."""
    west, south, east, north = ROAD
    write_geojson("line.geojson", translate(LineString([((west + east) / 2, south), ((west + east) / 2, north)]),
                                            EAST, NORTH), crs=CRS_M)
    found = inside("volume", "run/tiny.thickness.asc", "line.geojson", east - west)
    slope("volume", "run/tiny", "--road", "road.geojson", "--mesh", 5, "--lane", 3, "-o", "same")
    about = yaml.safe_load(Path("same/volume.yaml").read_text())
    assert found["REMOVE"] == pytest.approx(about["volume"]["remove"], rel=1e-6)
    with fiona.open(found["STRETCHES"]) as stretches:
        taken = [one["properties"]["remove_lane"] for one in stretches]
    assert taken == pytest.approx([one["remove_lane"] for one in about["stretches"]], rel=1e-5) and taken


def test_layers_come_into_the_project_with_their_styles(inside, place):
    found = inside("project", "run/tiny.thickness.asc", "road.geojson")
    assert sorted(style["renderer"] for style in found.values()) == \
        ["QgsGraduatedSymbolRenderer", "QgsSingleBandPseudoColorRenderer", "QgsSingleSymbolRenderer"]
    assert all(style["crs"] == CRS_M for style in found.values())


def test_a_study_is_cancelled_and_goes_on(inside, place):
    stopped, ended = inside("study", "deck/in.tiny", "[2/3] rolling_0.1_steps_600: started", "rolling=0,0.1,0.2",
                            "steps=600")
    assert stopped["results"] == {"error": "slope study: stopped"} and 100 not in stopped["percents"], stopped
    assert any("same command" in line for line in stopped["lines"]), stopped["lines"]
    assert len(stopped["folders"]) == 2
    assert set(processes_in(place)) <= {os.getpid()}      # the test itself stands there
    assert ended["percents"][-1] == 100 and ended["percents"] == sorted(ended["percents"]) and ended["percents"][0] > 30
    assert len(ended["folders"]) == 3 and Path(ended["results"]["TABLE"]).is_file()
    assert any(line.startswith("1 of 3 runs are finished already") for line in ended["lines"])


def test_what_is_no_object_of_the_tool_is_text(inside):
    progress = {"level": "progress", "share": 0.5, "runs": 2, "ended": 1, "failed": 0}
    words = ["no word of it", "3", '{"share": 1}', '{"level"']
    assert inside("said", json.dumps(progress), *words) == [progress, *({"level": "", "text": word} for word in words)]


# --- errors ---

@pytest.mark.parametrize("name, parameters, message", [
    ("volume", {"RUN": "run/tiny.thickness.asc", "ROAD": "road.geojson", "MESH": "0", "OUTPUT": "new"},
     "slope volume: --mesh: must be > 0, got 0"),
    ("volume", {"RUN": "run/terrain.asc", "ROAD": "road.geojson", "OUTPUT": "new"},
     "RUN: must be a file that a run wrote, such as PREFIX.thickness.asc, got run/terrain.asc"),
    ("release", {"DEM": "dem.tif", "POLYGON": "release.geojson", "VOLUME": "1e9", "OUTPUT": "new"},
     "slope release: --volume: must be at most"),
    ("release", {"DEM": "dem.tif", "POLYGON": "release.geojson", "EXTRA": "'open", "OUTPUT": "new"},
     "EXTRA: must be words with blanks between (No closing quotation), got 'open"),
    ("report", {"FOLDER": "deck", "OUTPUT": "new"}, "slope report: -o: must be a file that ends in .html, got new"),
    ("study", {"DECK": "deck/in.tiny", "SET": "none=1", "OUTPUT": "new"}, "slope study: --set"),
])
def test_bad_input_is_the_tools_own_line(qgis, place, name, parameters, message):
    status, results, _, err = qgis(name, **parameters)
    assert status != 0 and not results
    told = [line for line in err.splitlines() if message in line]
    assert told and told[0].startswith(message) and "Traceback" not in err, err
    assert not Path("new").exists()


def test_without_the_tools_a_line_says_where_to_name_them(home, place, tmp_path):
    shutil.copytree(PLUGIN, tmp_path / "alone" / "slope")
    environment = {**home, "QGIS_PLUGINPATH": str(tmp_path / "alone"), "PATH": "/usr/bin:/bin"}
    environment.pop("SLOPE_TOOLS")
    done = subprocess.run([QGIS, "run", "slope:export", "--", "RUN=run/tiny.thickness.asc", "OUTPUT=new"], cwd=place,
                          env=environment, capture_output=True, text=True, check=False)
    assert done.returncode != 0 and "Settings > Options > Processing > Providers > SLOPE" in done.stderr


# --- installation ---

def test_the_zip_in_a_profile(home, place, tmp_path):
    """package.sh makes a zip that the plugin manager unpacks into the profile; tools/slope is found on the PATH."""
    subprocess.run([TOOLS / "qgis" / "package.sh", tmp_path / "slope.zip"], check=True, capture_output=True)
    plugins = tmp_path / "home" / ".local/share/QGIS/QGIS3/profiles/default/python/plugins"
    with zipfile.ZipFile(tmp_path / "slope.zip") as packed:
        assert sorted(packed.namelist()) == sorted(f"slope/{path.name}" for path in PLUGIN.iterdir() if path.is_file())
        packed.extractall(plugins)
    (tmp_path / "run").mkdir(mode=0o700)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "slope").symlink_to(TOOLS / "slope")
    environment = {**home, "HOME": str(tmp_path / "home"), "PATH": f"{tmp_path / 'bin'}:/usr/bin:/bin"}
    for name in ("QGIS_PLUGINPATH", "SLOPE_TOOLS"):
        environment.pop(name)
    subprocess.run([QGIS, "plugins", "enable", "slope"], env=environment, check=True, capture_output=True)
    done = subprocess.run([QGIS, "run", "slope:export", "--", "RUN=run/tiny.thickness.asc", "OUTPUT=new"], cwd=place,
                          env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and Path("new/tiny.thickness.qml").is_file(), done.stderr


# --- the page ---

def page_examples():
    text = (TOP / "doc" / "src" / "tool_qgis.rst").read_text(encoding="ascii").replace("\\\n", " ")
    return re.findall(r"^ +qgis_process run slope:(\w+) -- (.*)", text, re.MULTILINE)


def test_the_page_names_every_algorithm():
    assert {name for name, _ in page_examples()} == ALGORITHMS
    text = (TOP / "doc" / "src" / "tool_qgis.rst").read_text(encoding="ascii")
    assert set(re.findall(r"^   \* - slope:(\w+)", text, re.MULTILINE)) == ALGORITHMS


def test_every_example_of_the_page_runs(qgis, inside, place):
    shutil.copy("deck/in.tiny", "in.collapse")
    for path in Path("run").glob("tiny.*"):
        shutil.copy(path, path.with_name(path.name.replace("tiny", "collapse")))
    write_geojson("deposit.geojson", box(*in_survey((5, 2, 20, 22))), crs=CRS_M)
    times = np.arange(0, 4, 0.02)
    Path("record.csv").write_text("time,EW (gal)\n" + "".join(f"{t:.2f},{100 * np.sin(12 * t):.6g}\n" for t in times))
    found = {}
    for name, words in page_examples():
        parameters = dict(word.split("=", 1) for word in shlex.split(words))
        status, results, _, err = qgis(name, **parameters)
        assert status == 0 and results, (name, err)
        found[name] = results
        if name == "site":
            site = results
            ours, heading, text = Path(site["SITE"]).read_text().partition("\nstudy:")
            for change in ("rolling: [0.05]", "spacing: []", "packing: []", "levels: 1", "points: 0"):       # few runs
                text, changed = re.subn(rf"(?m)^  {change.partition(' ')[0]} .*$", f"  {change}", text, count=1)
                assert changed, change
            Path(site["SITE"]).write_text(ours + heading + text)
        if parameters.get("DECK") == "mine/site.yaml":
            study = results
    assert Path(site["SITE"]).is_file() and 200 < site["NUMBER_OF_BALLS"] < 450 and site["RELEASED"] > 100
    assert where(site["DEPTH_LAYER"]) == where(site["TERRAIN_LAYER"]) == HERE
    assert study["THICKNESS"].startswith("mine/study/")
    conservative = yaml.safe_load(Path("mine/study/study.yaml").read_text())["conservative"]
    assert study["NO_BOUND"] == conservative["rounded"]["volume_m3"]        # as page 1 says it
    assert study["REPORT"] == "mine/report.html" and "<html" in Path(study["REPORT"]).read_text()[:300]
    numbers = {name: yaml.safe_load(Path(path).read_text()) for name, path in (
        ("score", "score/score.yaml"), ("calibrate", "fit/calibrate.yaml"), ("mobility", "known/mobility.yaml"),
        ("stability", "slips/stability.yaml"), ("fragility", "fragility/fragility.yaml"))}
    assert found["score"]["JACCARD"] == numbers["score"]["area"]["jaccard"] > 0
    assert found["calibrate"]["BEST"] == f"friction={numbers['calibrate']['best']['set']['friction']}"
    assert 0 < found["mobility"]["AT_ROAD"] == numbers["mobility"]["road"]["exceedance"] < 1
    assert found["stability"]["FACTOR"] == numbers["stability"]["bodies"][0]["factor"]
    assert found["quake"]["LARGEST"] == pytest.approx(300)
    assert found["fragility"]["MEDIAN"] == numbers["fragility"]["curves"][-1]["lognormal"]["median_gal"]
    for name, results in found.items():
        for key in ("TABLE", "PICTURE", "PROFILE", "SPECTRUM", "MAP"):
            assert key not in results or Path(results[key]).is_file(), (name, key)
    factor = found["stability"]["FACTOR_LAYER"]
    assert where(factor) == HERE and np.nanmin(values(factor)) == pytest.approx(found["stability"]["FACTOR"], rel=1e-4)
    shown = inside("look", "map.png", site["TERRAIN_LAYER"], site["DEPTH_LAYER"], factor)["styles"]
    assert shown[factor]["labels"][2:4] + shown[factor]["labels"][-1:] == ["0.9 to 1", "1 to 1.1", "above 3"]
    assert shown[site["TERRAIN_LAYER"]]["renderer"] == "QgsHillshadeRenderer"
    assert shown[site["DEPTH_LAYER"]]["labels"][-1].endswith(" m")


def test_modules_are_small():
    assert max(len(path.read_text().splitlines()) for path in PLUGIN.glob("*.py")) <= 400
    assert TOP in INSIDE.parents
