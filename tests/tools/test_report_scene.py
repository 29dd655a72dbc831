"""The 3-D view and the film of a report: what is in the scene, and what a browser makes of it; heading and limits."""
import base64
import html
import io
import json
import os
import re
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.interpolate import RegularGridInterpolator

from tiny_collapse import LMP, TOP, height, read_asc, write_case, write_stl

from slope_tools import cli
from slope_tools.animation import film, frames, scene, view
from slope_tools.geometry import extent_of
from slope_tools.plots.ground import Ground
from slope_tools.report.data import Data

TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
library = pytest.mark.skipif(view.library() is None, reason="libjs-three is not installed")

DUMP = """\
dump        view soil custom 75 view.*.dump id diameter x y z vx vy vz
dump_modify view pad 9
"""
BROWSER = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=800,700", "--hide-scrollbars")
SOFTWARE = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")     # no graphics card needed


def run_case(folder, dump):
    """The small collapse, run by hand in a folder, with more lines in its deck."""
    deck = write_case(folder)
    deck.write_text(deck.read_text().replace("run         ${steps}", f"{dump}run         ${{steps}}"))
    subprocess.run([LMP, "-in", deck.name, "-var", "steps", "900", "-screen", "none"], cwd=folder, check=True)
    return folder


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    return run_case(tmp_path_factory.mktemp("ran") / "case", DUMP)


@pytest.fixture(scope="module")
def page(ran):
    """A report with its view, no film; its path. Nobody changes it."""
    if view.library() is None:
        pytest.skip("libjs-three is not installed")
    assert cli.main(["report", str(ran), "--no-film", "-o", str(ran / "shown.html")]) == 0
    return ran / "shown.html"


@pytest.fixture(autouse=True)
def blank(blank_pictures):
    """Maps and charts are blank but in `page`."""
    blank_pictures()


@pytest.fixture
def case(ran, tmp_path, monkeypatch):
    """A copy of the run, in case; the test's folder, which is the current one."""
    shutil.copytree(ran, tmp_path / "case", ignore=shutil.ignore_patterns("shown.*"))
    monkeypatch.chdir(tmp_path)
    return tmp_path / "case"


def dumps_of(folder):
    """{step: {id: (diameter, x, y, z, vx, vy, vz)}} of the dumps, read by hand."""
    found = {}
    for path in sorted(folder.glob("view.*.dump")):
        lines = path.read_text().splitlines()
        found[int(lines[1])] = {int(line.split()[0]): tuple(map(float, line.split()[1:])) for line in lines[9:]}
    return found


def scene_of(page):
    return json.loads(re.search(r'<script type="application/json" id="scene">(.*?)</script>', page.read_text())[1])


def numbers(text, kind):
    return np.frombuffer(base64.b64decode(text), kind)


# --- balls ---

def test_frames_are_the_dumps_ball_by_ball(case):
    steps = dumps_of(case)
    path = case / f"view.{900:09d}.dump"
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[:9] + lines[:8:-1]) + "\n")        # LAMMPS' order is any order
    found, why = frames.read_frames(Data(case).result)
    assert why == "" and found.factor == 1 and found.dumped == len(steps) == 13
    assert found.time == pytest.approx([0.002 * step for step in steps])
    ids = sorted(steps[0])
    assert found.balls == len(ids) > 300
    for k, step in enumerate(steps):
        by_hand = np.array([steps[step][one] for one in ids])
        assert found.place[k] == pytest.approx(by_hand[:, 1:4], abs=1e-5)
        assert found.speed[k] == pytest.approx(np.linalg.norm(by_hand[:, 4:], axis=1), abs=1e-5)
    assert (found.diameter == 1).all()


def test_a_ball_that_is_lost_is_no_longer_there(case):
    path = case / f"view.{900:09d}.dump"
    lines = path.read_text().splitlines()
    lines[3] = str(int(lines[3]) - 1)
    gone = int(lines.pop().split()[0])
    path.write_text("\n".join(lines) + "\n")
    found, _ = frames.read_frames(Data(case).result)
    column = sorted(dumps_of(case)[0]).index(gone)
    there = np.isfinite(found.place[:, column, 0])
    assert there[:-1].all() and not there[-1]
    places, _, _ = scene.quantised(found.place)
    assert (places[-1, column] == 65535).all() and np.count_nonzero(places == 65535) == 3


def test_speeds_without_velocities_are_those_of_the_way(case):
    full, _ = frames.read_frames(Data(case).result)
    for path in case.glob("view.*.dump"):
        lines = path.read_text().splitlines()
        lines[8:] = ["ITEM: ATOMS id x y z"] + [" ".join(np.take(line.split(), [0, 2, 3, 4])) for line in lines[9:]]
        path.write_text("\n".join(lines) + "\n")
    found, _ = frames.read_frames(Data(case).result)
    way = np.linalg.norm(full.place[5] - full.place[4], axis=1) / 0.15
    assert found.speed[5] == pytest.approx(way, rel=1e-3, abs=1e-4) and way.max() > 1
    # without a diameter too: the balls' volume is the released one over the bulk factor
    about = Data(case).result.summary
    solid = np.pi / 6 * float(found.diameter[0]) ** 3 * about["balls"]["released"]
    assert solid == pytest.approx(about["volume"]["released"] / about["bulk_factor"], rel=1e-6)


@pytest.mark.parametrize("dumped, balls, size, shots, most", [
    (18, 3161, 3e5, 18, 33333), (60, 9000, 1e6, 60, 10000), (900, 9000, 1e6, 60, 10000),
    (61, 1_000_000, 1e7, 40, 15000), (20, 1_000_000, 1e7, 20, 30000), (60, 1_000_000, 5e7, 20, 30000),
    (60, 1_000_000, 9e9, 12, 50000)])
def test_budget(dumped, balls, size, shots, most):
    chosen, room = frames.budget(dumped, balls, size)
    assert (len(chosen), room) == (shots, most)
    assert chosen[0] == 0 and chosen[-1] == dumped - 1
    assert np.ptp(np.diff(chosen)) <= 1
    assert shots * min(room, balls) <= frames.MOST_PLACES


@library
def test_what_is_thinned_out_is_said_and_keeps_its_volume(case, monkeypatch):
    all_of_them, _ = frames.read_frames(Data(case).result)
    monkeypatch.setattr(frames, "MOST_PLACES", 13 * 100)
    found, _ = frames.read_frames(Data(case).result)
    assert found.place.shape == (13, 100, 3) and found.balls == all_of_them.balls
    assert (found.diameter ** 3).sum() == pytest.approx((all_of_them.diameter ** 3).sum(), rel=1e-5)
    # the balls that are left are balls of the run, on their own ways
    column = int(np.flatnonzero((all_of_them.place[0] == found.place[0, 7]).all(axis=1))[0])
    assert (all_of_them.place[:, column] == found.place[:, 7]).all()
    assert cli.main(["report", "case", "--no-film"]) == 0
    text = html.unescape((case / "report.html").read_text())
    assert f"100 of the {found.balls} balls, chosen at random; each stands for {found.factor:.3g}" in text
    assert scene_of(case / "report.html")["balls"]["count"] == 100


# --- the scene in the page ---

def test_places_in_the_page_are_those_of_the_dumps(page, ran):
    about = scene_of(page)
    balls, steps = about["balls"], dumps_of(ran)
    values = numbers(balls["places"], "<u2").reshape(len(steps), balls["count"], 4)
    places = np.array(balls["low"]) + values[..., :3] / 65534 * balls["span"]
    speeds = values[..., 3] / 65534 * about["speed"]["top"]
    ids = sorted(steps[0])
    for k, step in enumerate(steps):
        by_hand = np.array([steps[step][one] for one in ids])
        assert np.abs(places[k] - by_hand[:, 1:4]).max() < 40 / 65534       # no side of the box is longer
        fast = np.linalg.norm(by_hand[:, 4:], axis=1)
        assert np.abs(speeds[k] - np.minimum(fast, about["speed"]["top"])).max() < 1e-3
    assert about["times"] == pytest.approx([0.002 * step for step in steps])
    assert about["height"]["low"] == pytest.approx(min(one[3] for one in steps[0].values()), abs=1e-4)


def test_the_ground_in_the_page_is_the_terrain_and_the_slip_surface(page, ran):
    about = scene_of(page)["ground"]
    shape = about["rows"], about["columns"]
    z = {name: about["low"] + about["span"] * numbers(about[name], "<u2").reshape(shape) / 65534
         for name in ("base", "before")}
    xlo, ylo, xhi, yhi = about["box"]
    x, y = np.linspace(xlo, xhi, shape[1]), np.linspace(ylo, yhi, shape[0])
    inner = (x > 1) & (x < 39) & ~np.isclose(x % 12, 4, atol=1)     # toe and shoulder are bilinear between cells
    assert np.abs(z["before"][:, inner] - height(x[inner])).max() < 0.01
    base = read_asc(ran / "tiny.base.asc")[::-1]        # rows from the south, as in the page
    between = RegularGridInterpolator((np.arange(base.shape[0]) + 0.5, np.arange(base.shape[1]) + 0.5), base)
    expected = between(np.stack(np.meshgrid(y, x, indexing="ij"), axis=-1))
    assert np.abs(z["base"] - expected)[:, inner].max() < 0.01
    assert (z["before"] - z["base"]).max() > 2


def test_the_largest_scene_and_the_library_leave_room_in_15_MB():
    count = frames.MOST_PLACES // frames.MOST_FRAMES
    values = np.zeros((frames.MOST_FRAMES, count, 4))
    library_size = sum(map(len, view.library())) if view.library() else 1e6
    assert len(scene.packed(values, "<u2")) + 16 * scene.MOST_NODES * 2 / 6 + library_size < 9e6


def test_a_text_does_not_end_the_script(page, case):
    scripts = re.findall(r"<script[^>]*>(.*?)</script>", page.read_text(), re.DOTALL)
    assert len(scripts) == 5
    assert scripts[0].startswith("{") and all("</script" not in one for one in scripts)
    assert "MIT licence" in scripts[1] and "THE SOFTWARE IS PROVIDED" in scripts[1]


# --- structures ---

@pytest.fixture(scope="module")
def walled(tmp_path_factory):
    """The run with a wall across the slope, a post, and a structure without an output."""
    folder = tmp_path_factory.mktemp("walled") / "case"
    folder.mkdir()
    write_stl(folder / "wall.stl", (12, 1, -1), (13, 23, 2))
    write_stl(folder / "post.stl", (2, 11, -1), (3, 12, 2))
    walls = "".join(f"fix {name} soil wall/gran/mesh 3 {file}.stl{more}\n" for name, file, more in (
        ("wall", "wall", " output ${out}.wall 10"), ("post", "post", " output ${out}.post 10"), ("silent", "post", "")))
    return run_case(folder, walls + DUMP)


@library
def test_structures_in_the_page_are_those_of_the_run(walled):
    assert cli.main(["report", str(walled), "--no-film", "-o", str(walled / "numbers.html")]) == 0
    one, post = scene_of(walled / "numbers.html")["structures"]
    assert post["name"] == "post"
    corners = numbers(one["corners"], "<f4").reshape(-1, 3, 3)
    assert (one["name"], one["triangles"]) == ("wall", 12) and len(corners) == 12
    assert corners.reshape(-1, 3).min(axis=0).tolist() == [12, 1, -1]
    assert corners.reshape(-1, 3).max(axis=0).tolist() == [13, 23, 2]


@pytest.mark.parametrize("box, inside", [((0, 0, 2.5, 24), True), ((3.5, 0, 11, 24), False), ((0, 12.5, 9, 24), False),
                                         ((2.5, 11.5, 2.6, 11.6), True)])
def test_structures_in_the_ground_that_is_shown(box, inside):
    assert scene.meets(np.array([[[2, 11, 0], [3, 11, 0], [3, 12, 5]]], float), box) == inside


def test_the_ground_that_is_shown_reaches_to_structures_nearby(ran):
    """Near is what is no farther than the mass is long; what lies beyond the terrain does not count."""
    ground = Ground(Data(ran))
    alone = scene.frame_scene(ground, {})
    box = extent_of(ground.raster.transform, ground.touched | ground.source)
    size = max(box[2] - box[0], box[3] - box[1])

    def post(x):
        return {"post": np.array([[[x, 12, 0], [x + 0.5, 12, 0], [x, 12, 1]]], float)}
    assert scene.frame_scene(ground, post(box[0] + 1)).tolist() == alone.tolist()
    assert scene.frame_scene(ground, post(box[0] - 2 * size)).tolist() == alone.tolist()
    assert scene.frame_scene(ground, post(max(1, box[0] - 0.9 * size)))[0] <= 1 < alone[0]


@library
def test_a_structure_of_too_many_triangles_is_left_out_and_said(walled, monkeypatch):
    monkeypatch.setattr(scene, "MOST_TRIANGLES", 11)
    assert cli.main(["report", str(walled), "--no-film", "-o", str(walled / "large.html")]) == 0
    assert "Not drawn, for its size: wall, post." in html.unescape((walled / "large.html").read_text())
    found = scene_of(walled / "large.html")["structures"]
    assert [(one["triangles"], one["corners"]) for one in found] == 2 * [(0, "")]


# --- where there is no view ---

@library
def test_the_lines_that_the_page_asks_for_give_a_view(case, tmp_path):
    """Word by word, and the group and the step are those of this deck."""
    for path in case.glob("view.*.dump"):
        path.unlink()
    assert cli.main(["report", "case"]) == 0
    text = html.unescape((case / "report.html").read_text())
    assert 'id="scene"' not in text and "<script" not in text
    lines = re.search(r"No 3-D view: .*?\n<pre>(dump view soil custom .*?)</pre>", text, re.DOTALL)[1]
    run_case(tmp_path / "again", f"{lines}\n")
    assert cli.main(["report", "again", "--no-film"]) == 0
    gaps = np.diff(scene_of(tmp_path / "again" / "report.html")["times"])
    assert len(gaps) >= 3 and gaps == pytest.approx(frames.SECONDS, rel=0.25)


def test_a_broken_dump_is_said_and_the_page_is_made(case, capsys):
    path = case / f"view.{900:09d}.dump"
    path.write_text(path.read_text()[:-40])
    assert cli.main(["report", "case"]) == 0
    text = html.unescape((case / "report.html").read_text())
    assert re.search(rf"No 3-D view: The dumps cannot be read: \S*{path.name}", text)
    assert "3-D view" not in capsys.readouterr().out and not (case / "report.mp4").exists()


def test_without_the_library_the_page_names_its_package(case, monkeypatch):
    monkeypatch.setattr(view, "FOLDERS", (case / "nothing",))
    assert cli.main(["report", "case", "--no-film"]) == 0
    text = (case / "report.html").read_text()
    assert "No 3-D view: It needs" in text and "libjs-three" in text and "<script" not in text


# --- in the browser ---

@pytest.fixture
def browser():
    """open(*options): a Chromium without a screen, driven by Selenium."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="python3-selenium is not installed")
    from selenium.webdriver.chrome.service import Service
    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not (program and driver):
        pytest.skip("chromium or chromium-driver is not installed")
    opened = []

    def start(*more):
        options = webdriver.ChromeOptions()
        options.binary_location = program
        for option in (*BROWSER, *more):
            options.add_argument(option)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        opened.append(webdriver.Chrome(service=Service(driver), options=options))
        opened[-1].set_page_load_timeout(280)
        opened[-1].set_script_timeout(120)
        return opened[-1]

    yield start
    for one in opened:
        one.quit()


def said(driver):
    """What the console said, and which addresses were asked for."""
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    urls = {one["params"]["request"]["url"] for one in messages if one["method"] == "Network.requestWillBeSent"}
    return [entry["message"] for entry in driver.get_log("browser")], urls


def act(driver, script, *values):
    """Run a script, and come back when what it changed is drawn."""
    return driver.execute_async_script(
        "const done = arguments[arguments.length - 1], found = (function () {" + script + "}).apply(null, arguments);"
        "requestAnimationFrame(() => requestAnimationFrame(() => done(found)));", *values)


def at(driver, seconds):
    """Move the slider to a time; the picture of the canvas then, as an array."""
    act(driver, "const slider = document.getElementById('view-time'); slider.value = arguments[0];"
                "slider.dispatchEvent(new Event('input'));", seconds)
    return picture(driver)


def picture(driver):
    from PIL import Image
    from selenium.common.exceptions import TimeoutException
    for left in (3, 2, 1, 0):       # the driver waits 10 s, which a busy machine may need for a picture
        try:
            content = driver.find_element("id", "view-canvas").screenshot_as_png
            return np.asarray(Image.open(io.BytesIO(content)).convert("RGB")).astype(int)
        except TimeoutException:
            if not left:
                raise
    return None


def coloured(picture):
    """Mean column and number of the pixels in full colour: balls by their height, and some of the road's line."""
    found = np.argwhere(np.ptp(picture, axis=2) > 70)
    return found[:, 1].mean(), len(found)


def test_the_canvas_shows_balls_that_move(page, browser):
    driver = browser(*SOFTWARE)
    driver.get(page.as_uri())
    driver.execute_script("document.getElementById('view').scrollIntoView()")
    act(driver, "const c = document.getElementById('view-colour'); c.value = 'height';"
                "c.dispatchEvent(new Event('change')); document.getElementById('view-overlay').style.display = 'none';"
                "document.getElementById('view-above').click();")
    end = scene_of(page)["times"][-1]
    first, last, again = at(driver, 0), at(driver, end), at(driver, 0)
    assert (first == again).all()
    assert np.count_nonzero(np.abs(last - first).max(axis=2) > 40) > 0.01 * first.shape[0] * first.shape[1]
    (x0, balls0), (x1, balls1) = coloured(first), coloured(last)
    assert balls0 > 1000 and balls1 > 1000
    assert x1 < x0 - 20         # down the slope is west, the left with north on top
    # between two snapshots, the balls are between their places
    gap = scene_of(page)["times"][1]
    places = [coloured(at(driver, 5 * gap + share * gap))[0] for share in (0, 0.5, 1)]
    assert places[0] > places[1] > places[2]
    console, urls = said(driver)
    assert console == []
    assert {url for url in urls if not url.startswith("data:")} == {page.as_uri()}


@library
@pytest.mark.long
def test_the_canvas_shows_a_wall(page, walled, browser):
    """What is bluish grey, which nothing else is, from above."""
    assert cli.main(["report", str(walled), "--no-film", "-o", str(walled / "drawn.html")]) == 0
    found = []
    for one in (page, walled / "drawn.html"):
        driver = browser(*SOFTWARE)
        driver.get(one.as_uri())
        driver.execute_script("document.getElementById('view').scrollIntoView()")
        legend = driver.find_element("id", "view-legend").text
        act(driver, "document.getElementById('view-overlay').style.display = 'none';"
                    "document.getElementById('view-above').click();")
        seen = at(driver, 0)
        found.append(("structure" in legend, np.count_nonzero(seen[..., 2] - seen[..., 0] > 24)))
        assert said(driver)[0] == []
    (without, none), (shown, pixels) = found
    assert not without and shown and pixels > 500 and none < 0.02 * pixels, found


def test_play_orbit_and_buttons(page, browser):
    driver = browser(*SOFTWARE)
    driver.get(page.as_uri())
    driver.execute_script("document.getElementById('view').scrollIntoView()")
    oblique = at(driver, 0)
    assert "0.0 s" in driver.find_element("id", "view-clock").text
    legend = driver.find_element("id", "view-legend").text
    assert "speed of the balls (m/s)" in legend and "slip surface" in legend
    assert re.fullmatch(r"(1|2|5)0? m", driver.find_element("id", "view-scale").text)
    # a drag turns the view
    from selenium.webdriver import ActionChains
    canvas = driver.find_element("id", "view-canvas")
    ActionChains(driver).move_to_element(canvas).click_and_hold().move_by_offset(120, 0).release().perform()
    act(driver, "")
    assert np.count_nonzero(np.abs(picture(driver) - oblique).max(axis=2) > 40) > 0.05 * oblique[..., 0].size
    # each button shows another picture, the first one that of the beginning
    seen = []
    for name in ("front", "side", "above", "oblique"):
        act(driver, f"document.getElementById('view-{name}').click()")
        seen.append(picture(driver))
    assert (seen[3] == oblique).all() and not any((one == oblique).all() for one in seen[:3])
    # the ground before hides what is below it
    act(driver, "document.getElementById('view-body').click()")
    assert not (picture(driver) == oblique).all()
    # time goes on by itself, at the pace that is asked for, to the end
    act(driver, "document.getElementById('view-rate').value = '5'; document.getElementById('view-play').click()")
    end, before = scene_of(page)["times"][-1], time.monotonic()
    while driver.find_element("id", "view-play").text == "Pause" and time.monotonic() < before + 120:
        time.sleep(0.1)
    assert float(driver.execute_script("return document.getElementById('view-time').value")) == pytest.approx(end)
    assert said(driver)[0] == []


def test_without_webgl_the_page_says_so_and_the_rest_is_there(page, browser):
    driver = browser("--disable-3d-apis")
    driver.get(page.as_uri())
    message = driver.find_element("id", "view-message")
    assert message.is_displayed() and "WebGL" in message.text
    assert not driver.find_element("id", "view-controls").is_displayed()
    assert all(driver.execute_script("return [...document.querySelectorAll('img:not(#view-still)')]"
                                     ".map((one) => one.complete && one.naturalWidth > 0)"))
    assert said(driver)[0] == []


# --- film ---

@pytest.mark.drawn
@pytest.mark.skipif(not (shutil.which("ffmpeg") and shutil.which("ffprobe")), reason="ffmpeg is not installed")
def test_the_film_shows_the_run(case, capsys):
    assert cli.main(["report", "case"]) == 0
    assert "case/report.mp4" in capsys.readouterr().out
    told = subprocess.run(["ffprobe", "-loglevel", "error", "-count_frames", "-show_entries",
                           "stream=nb_read_frames,width,height,codec_name", "-of", "json", "case/report.mp4"],
                          check=True, capture_output=True, text=True).stdout
    stream, = json.loads(told)["streams"]
    pictures = int(stream["nb_read_frames"])
    # 1.8 s at a quarter of the pace, and the last picture for a second
    assert stream["codec_name"] == "h264" and pictures == pytest.approx(film.RATE * (1.8 / 0.25 + film.HOLD), abs=1)
    text = html.unescape((case / "report.html").read_text())
    assert "report.mp4, beside this page" in text and "4 times slower than real time" in text
    raw = subprocess.run(["ffmpeg", "-nostdin", "-loglevel", "error", "-i", "case/report.mp4", "-f", "rawvideo",
                          "-pix_fmt", "gray", "-"], check=True, capture_output=True).stdout
    gray = np.frombuffer(raw, np.uint8).reshape(pictures, stream["height"], stream["width"]).astype(int)
    moved = [np.count_nonzero(np.abs(one - gray[0]) > 40) for one in gray]
    assert moved[-1] > 0.01 * gray[0].size and moved[pictures // 4] < moved[-1]
    # it stays, but for what the compression makes of single pixels
    assert np.count_nonzero(np.abs(gray[-1] - gray[-5]) > 40) < 1e-4 * gray[0].size


def test_between_and_on_line_by_hand():
    found = frames.Frames(np.array([0.0, 2.0, 3.0]), np.array([[[0, 0, 4]], [[2, 0, 0]], [[np.nan] * 3]], float),
                          np.array([[0.0], [4.0], [np.nan]]), np.ones(1), 1, 3, 1.0)
    place, speed = film.between(found, 0.5)
    assert place.tolist() == [[0.5, 0, 3]] and speed.tolist() == [1.0]
    assert np.isnan(film.between(found, 2.5)[0]).all()
    along, off = film.on_line(np.array([[0, 0], [10, 0], [10, 10]], float), np.array([[4, 3], [12, 5], [-3, 4]], float))
    assert along.tolist() == [4, 15, 0] and off.tolist() == [3, 2, 5]


def test_without_ffmpeg_a_note_and_no_film(case, monkeypatch, capsys):
    monkeypatch.setattr(film.shutil, "which", lambda name: None)
    assert cli.main(["report", "case"]) == 0
    assert "note: No film: it needs ffmpeg" in capsys.readouterr().out
    assert not (case / "report.mp4").exists() and "No film: it needs ffmpeg" in (case / "report.html").read_text()


@pytest.mark.drawn
def test_an_ffmpeg_that_fails_leaves_no_film(case, monkeypatch, capsys):
    bad = case / "ffmpeg"
    bad.write_text("#!/bin/sh\necho no such codec >&2\nexit 1\n")
    bad.chmod(0o755)
    monkeypatch.setattr(film.shutil, "which", lambda name: str(bad))
    assert cli.main(["report", "case"]) == 0
    assert "note: No film: ffmpeg could not make it (no such codec" in capsys.readouterr().out
    assert not (case / "report.mp4").exists()


# --- heading ---

@pytest.fixture
def plain(case):
    """The run without dumps: no view, no film."""
    for path in case.glob("view.*.dump"):
        path.unlink()
    return case


def test_project_client_and_author_from_options(plain):
    assert cli.main(["report", "case", "--name", "Cut <4> & 5", "--client", "Road office", "--author", "A. B."]) == 0
    text = (plain / "report.html").read_text()
    assert "<h1>Cut &lt;4&gt; &amp; 5</h1>" in text and "<b>Slope collapse, one run</b>" in text
    assert "<small>Client</small> Road office" in text and "<small>Author</small> A. B." in text


def test_project_client_and_author_from_the_site(plain):
    """Its file lies in the folder, or above it; options come first."""
    about = {"slope_site": 1, "project": {"name": "Site 7", "client": None, "author": "C. D."}}
    Path("site.yaml").write_text(yaml.safe_dump(about))
    assert cli.main(["report", "case", "--author", "E. F."]) == 0
    text = (plain / "report.html").read_text()
    assert "<h1>Site 7</h1>" in text and "<small>Author</small> E. F." in text and "<small>Client" not in text
    (plain / "site.yaml").write_text(yaml.safe_dump({**about, "project": {"name": "Inside"}}))
    assert cli.main(["report", "case"]) == 0
    assert "<h1>Inside</h1>" in (plain / "report.html").read_text()
    # a site without a name has that of its folder, and its survey is named
    (plain / "site.yaml").write_text(yaml.safe_dump({"project": {"name": None}, "terrain": {"files": ["../dem.tif"]}}))
    assert cli.main(["report", "case"]) == 0
    text = (plain / "report.html").read_text()
    assert "<h1>case</h1>" in text and "Survey: dem.tif." in text
    assert re.search(r"Report made \d{4}-\d\d-\d\d \d\d:\d\d UTC", text)


def test_only_the_first_line_of_the_deck_s_head_is_the_purpose(plain):
    deck = plain / "in.tiny"
    first, rest = deck.read_text().split("\n", 1)
    deck.write_text(f"{first}\n# By hand: lmp -in in.tiny\n{rest}")
    assert cli.main(["report", "case"]) == 0
    text = (plain / "report.html").read_text()
    assert f'<p class="purpose">{first.lstrip("# ")}</p>' in text and "By hand" not in text.split("<h2>")[0]


# --- limits ---

def limits_of(path):
    """{what: text} of the table of limits."""
    text = path.read_text()
    part = text[text.index('<section id="limits"'):]
    rows = re.findall(r'<tr><th scope="row">(.*?)</th><td>(.*?)</td></tr>', part[:part.index("</section>")])
    return {what: html.unescape(words) for what, words in rows}


def test_limits_of_a_run(plain):
    assert cli.main(["report", "case"]) == 0
    found = limits_of(plain / "report.html")
    assert list(found) == ["Known events", "Chance", "Size of the balls", "Time step", "Varied", "The body",
                           "The mass", "The ground"]
    assert "not tried" in found["Time step"]
    assert "of landslides of this volume and height" in found["Known events"]
    assert found["Chance"].startswith("Unknown") and found["Varied"].startswith("Nothing")
    # balls of 1 m, of which each stands for a cube: 6/pi of its volume
    assert "1.00 m³ of ground, a cube of 1.00 m" in found["The mass"] and "Dry" in found["The mass"]
    assert "cells of 1 m" in found["The ground"]
