"""tools/slope report: one page with everything in it, red on a deposit that moves, and the section by hand."""
import base64
import csv
import html
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import yaml

from tiny_collapse import LMP, TOP, height, read_asc, write_case

TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
sys.path.insert(0, str(TOOLS))

from slope_tools import cli, figures, report  # noqa: E402  (after the path is set)

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A study of two runs, one of them at rest, with a road; its folder."""
    folder = tmp_path_factory.mktemp("made")
    deck = write_case(folder / "case")
    # a step above the rule's: a warning in the log
    deck.write_text(deck.read_text().replace("timestep    0.002", "timestep    0.0025"))
    done = subprocess.run([sys.executable, str(TOOLS / "slope"), "study", "case/in.tiny", "--set", "rolling=0,0.3",
                           "--set", "steps=1200", "-o", "out", "--road", "case/road.csv", "--mesh", "4"],
                          cwd=folder, env={**os.environ, "LMP": LMP}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def here(made, tmp_path, monkeypatch):
    """A copy of the study in out, and of one of its runs as a single run in one; the test's folder."""
    shutil.copytree(made / "out", tmp_path / "out")
    shutil.copytree(made / "out" / "rolling_0.3_steps_1200", tmp_path / "one")
    for name in ("variables.yaml", "finished.yaml"):
        (tmp_path / "one" / name).unlink()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def slope(capsys, monkeypatch):
    """Run `slope report ARGUMENTS`; gives status, stdout, stderr. Pictures are blank, as rendering takes its time."""
    def blank(figure, kind="png"):
        figures.plt.close(figure)
        return f"data:image/{kind};base64,AAAA"
    monkeypatch.setattr(figures, "data_uri", blank)
    return real_slope(capsys)


@pytest.fixture
def drawing_slope(capsys, monkeypatch):
    """The same, with pictures, small ones."""
    monkeypatch.setattr(figures, "DPI", 80)
    return real_slope(capsys)


def real_slope(capsys):
    def run(arguments):
        capsys.readouterr()
        try:
            status = cli.main(["report", *shlex.split(arguments)])
        except SystemExit as error:
            status = error.code
        return status, *capsys.readouterr()
    return run


class Reader(HTMLParser):
    """Pictures, warnings by class, tables as lists of rows, and all attributes of a page."""

    def __init__(self, page):
        super().__init__()
        self.pictures, self.alt, self.warnings, self.tables, self.links, self.tags = [], [], [], [], [], set()
        self.into = None
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.tags.add(tag)
        self.links += [found[key] for key in ("src", "href", "data", "action", "poster", "srcset") if key in found]
        if tag == "img":
            self.pictures.append(found["src"])
            self.alt.append(found["alt"])
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.tables[-1][-1].append("")
            self.into = self.tables[-1][-1]
        if tag == "li":
            self.warnings.append([found.get("class"), ""])
            self.into = self.warnings[-1]

    def handle_endtag(self, tag):
        if tag in ("td", "th", "li"):
            self.into = None

    def handle_data(self, data):
        if self.into is not None:
            self.into[-1] += data


def read(path):
    page = Path(path).read_text(encoding="utf-8")
    return page, Reader(page)


def set_moving(folder, moving, share):
    """Say in summary and study that a run's deposit moves, or not."""
    for path in folder.rglob("*.summary.yaml"):
        text = re.sub(r"^moving: \w+", f"moving: {moving}", path.read_text(), flags=re.MULTILINE)
        path.write_text(re.sub(r"moving_share: \S+", f"moving_share: {share}", text))
    if (folder / "study.yaml").exists():
        about = yaml.safe_load((folder / "study.yaml").read_text())
        for row in about["runs"]:
            row.update(moving=moving == "true", moving_share=share)
        (folder / "study.yaml").write_text(yaml.safe_dump(about))


# --- one file ---

@pytest.mark.parametrize("folder, least", [("out", 14), ("one", 7)])
def test_the_page_needs_nothing_else(drawing_slope, here, folder, least):
    status, out, err = drawing_slope(folder)
    assert (status, err) == (0, "")
    page, reader = read(f"{folder}/report.html")
    assert "http" not in page and "//" not in re.sub(r"base64,[A-Za-z0-9+/=]*", "", page)
    assert not reader.tags & {"script", "link", "iframe", "object", "embed", "base"}
    assert "@import" not in page and "url(" not in page
    assert len(reader.pictures) >= least and f"{len(reader.pictures)} pictures" in out
    assert all(reader.alt) and reader.links == reader.pictures
    for picture in reader.pictures:
        kind, data = re.fullmatch(r"data:image/(png|svg\+xml);base64,(.*)", picture).groups()
        content = base64.b64decode(data, validate=True)
        if kind == "png":
            width, tall = struct.unpack(">II", content[16:24])
            assert content[:8] == b"\x89PNG\r\n\x1a\n" and width > 200 and tall > 80
        else:
            assert b"<svg" in content and b"<image" not in content.replace(b"<image xlink:href=\"data:", b"")
    assert page.count("<html") == page.count("</html>") == 1
    assert str(here) not in page


def test_what_stands_on_the_page(slope, here):
    assert slope("out")[0] == 0
    page, reader = read("out/report.html")
    text = html.unescape(page)
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    run = Path("out") / about["conservative"]["run"]
    summary = yaml.safe_load((run / "tiny.summary.yaml").read_text())
    log = (run / "log.lammps").read_text()
    # the deck, and the pair style's table, word by word
    assert (run / "in.tiny").read_text().strip() in text
    table = re.search(r"Pair gran/restitution: contact coefficients.*\n(  .*\n)+", log)[0]
    assert table.strip() in text
    assert "A small collapse for tests; second line of the head." in text
    assert "Nothing in particular" not in text.split("<h2")[0]
    for value in (summary["slope_version"], summary["lammps_version"], f"{summary['volume']['released']:.3f} m3",
                  f"{summary['travel']['reach_angle']:.2f} degrees"):
        assert value in text
    assert f"{about['conservative']['remove_m3']:,.0f}" in text
    # the study's table
    rows = next(table for table in reader.tables if any("to remove" in cell for cell in table[0]))
    assert len(rows) == 3
    for row, cells in zip(about["runs"], rows[1:]):
        assert cells[0] == row["set"]["rolling"]
        assert [f"{row['remove_m3']:,.0f}", f"{row['front_m']:,.1f}"] == [cells[-4], cells[4]]
        assert cells[-5] == ("moving" if row["moving"] else "at rest")
    # the paper's
    paper = next(table for table in reader.tables if table[0][-1] == "company I")
    assert paper[1:] == [["0.00", "24,048", "22,114"], ["0.05", "26,009", "18,262"], ["0.10", "22,340", "14,490"],
                         ["actual", "14,225"]]
    assert slope("out --no-paper -o other.html")[0] == 0
    assert "26,009" not in Path("other.html").read_text()
    assert slope("one")[0] == 0 and "26,009" not in Path("one/report.html").read_text()


def test_the_shown_run(slope, here):
    names = [row["run"] for row in yaml.safe_load(Path("out/study.yaml").read_text())["runs"]]
    for name in names:
        assert slope(f"out --run {name} -o page.html")[0] == 0
        assert f"Volume balance of the run {name.split('_steps')[0].replace('_', ' ')}" in Path("page.html").read_text()
    status, _, err = slope("out --run nothing")
    assert (status, err) == (2, f"slope report: --run: must be a finished run of out/study.yaml, such as {names[0]}, "
                                "got nothing\n")


# --- warnings ---

@pytest.mark.parametrize("folder", ["out", "one"])
def test_red_on_a_deposit_that_moves(slope, here, folder):
    set_moving(here / folder, "true", 0.42)
    status, out, _ = slope(folder)
    page, reader = read(f"{folder}/report.html")
    red = [text for level, text in reader.warnings if level == "red"]
    assert status == 0 and len(red) == 1 and "still move" in red[0] and "42 % of the volume" in red[0]
    assert "WARNING: " in out and "still move" in out
    # before everything else, and really red
    assert page.index(red[0][:20]) < page.index("<figure")
    assert re.search(r"\.warnings \.red \{[^}]*color: #7d0c12", page) and '--red: #b3131b' in page
    assert not [level for level, _ in reader.warnings if level == "green"]


@pytest.mark.parametrize("folder", ["out", "one"])
def test_no_red_on_a_deposit_at_rest(slope, here, folder):
    set_moving(here / folder, "false", 0.01)
    assert slope(folder)[0] == 0
    _, reader = read(f"{folder}/report.html")
    assert not [text for level, text in reader.warnings if level == "red"]
    assert ["amber"] == sorted({level for level, _ in reader.warnings} - {"green"})   # the log's


def test_green_without_any_warning(slope, here):
    set_moving(here / "one", "false", 0.01)
    log = here / "one" / "log.lammps"
    log.write_text(re.sub(r"^WARNING.*\n", "", log.read_text(), flags=re.MULTILINE))
    assert slope("one")[0] == 0
    assert [level for level, _ in read("one/report.html")[1].warnings] == ["green"]


def test_warnings_of_the_logs_and_failed_runs_are_on_top(slope, here):
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    about["runs"].append({"run": "rolling_9", "status": "failed", "set": {"rolling": "9", "steps": "1200"},
                          "error": "ERROR: lost <b>all</b> atoms", "log_warnings": []})
    Path("out/study.yaml").write_text(yaml.safe_dump(about))
    assert slope("out")[0] == 0
    page, reader = read("out/report.html")
    texts = [text for _, text in reader.warnings]
    assert any(text.startswith("LAMMPS: Pair gran/restitution: time step 0.0025 s is") for text in texts)
    assert ["red", "Run rolling_9 failed: ERROR: lost <b>all</b> atoms"] in reader.warnings
    assert "<b>all</b>" not in page


def test_lost_mass_is_told(slope, here):
    path = here / "one" / "tiny.summary.yaml"
    path.write_text(re.sub(r"^  lost: 0.0", "  lost: 12.5", path.read_text(), flags=re.MULTILINE))
    assert slope("one")[0] == 0
    assert any("12.5 m3" in text and "left the grid or the box" in text
               for _, text in read("one/report.html")[1].warnings)


# --- the section ---

def section(path):
    with open(path, newline="", encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    return {key: np.array([float(row[key] or "nan") for row in rows]) for key in rows[0]}


def test_the_section_goes_through_the_centroid_along_the_fall_line(slope, here):
    assert slope("one")[0] == 0
    line = section("one/report.section.csv")
    assert np.ptp(line["y"]) < 0.5      # the face falls along x
    assert abs(line["y"].mean() - 12) < 1
    assert (np.diff(line["x"]) > 0).all()
    thickness = read_asc("one/tiny.thickness.asc")
    columns = np.flatnonzero((thickness > 0).any(axis=0))
    assert line["x"][0] <= columns[0] and line["x"][-1] >= columns[-1] + 1
    assert line["distance"] == pytest.approx(np.hypot(line["x"] - line["x"][0], line["y"] - line["y"][0]), abs=2e-4)


def test_heights_of_a_section_by_hand(slope, here):
    assert slope("one --section 6.5 12.5 38.5 12.5")[0] == 0      # along the centres of a row of cells
    line = section("one/report.section.csv")
    thickness, surface = (read_asc(f"one/tiny.{name}.asc")[11] for name in ("thickness", "surface"))
    centres = np.arange(40) + 0.5
    name = next(key for key in line if key.startswith("thickness "))
    assert line[name] == pytest.approx(np.interp(line["x"], centres, thickness), abs=1e-4)
    base = np.interp(line["x"], centres, surface - thickness)
    assert line["base"] == pytest.approx(base, abs=1e-4)
    assert line[name.replace("thickness", "surface")] == pytest.approx(base + line[name], abs=2e-4)
    # terrain.asc has the heights at the centres, and is linear between them
    assert line["ground_before"] == pytest.approx(np.interp(line["x"], centres, height(centres)), abs=1e-4)
    assert (line["ground_before"] - line["base"]).max() > 2


def test_the_cut_and_the_road_on_the_section(here):
    class Args:
        folder, shown, no_paper, section = Path("out"), None, False, [2.0, 12.5, 38.0, 12.5]
    page = report.Page(Args)
    s, x, y, *_ = page.profile()
    spans, cut = page._road_on(s, x, y)
    assert spans == [[pytest.approx(6.0), pytest.approx(11.0)]]      # x 8 to 13, from 2
    beyond = x > 13
    base = (read_asc(page.result.prefix.with_suffix(".surface.asc")) - page.result.thickness)[11]
    edge = np.interp(13, np.arange(40) + 0.5, base)
    assert cut[beyond] == pytest.approx(edge + (x[beyond] - 13) * np.tan(np.radians(30)), abs=1e-9)
    assert np.isnan(cut[(x > 8) & (x < 13)]).all()


# --- pictures ---

@pytest.mark.parametrize("largest", [0.004, 0.03, 0.3, 0.9, 1.9, 2.0, 4.9, 7, 19, 20, 33, 120, 1e4])
def test_classes_hold_the_largest(largest):
    bounds = figures.classes(largest)
    assert bounds == sorted(set(bounds)) and 3 <= len(bounds) <= 12
    assert bounds[-1] >= largest > bounds[-2] or len(bounds) <= 9
    assert 0 < bounds[0] <= largest / 2


@pytest.mark.parametrize("length, expected", [(1, 1), (1.99, 1), (2, 2), (60, 50), (0.37, 0.2), (5000, 5000)])
def test_nice(length, expected):
    assert figures.nice(length) == pytest.approx(expected)


def test_gaps_of_a_mask_are_closed():
    mask = np.zeros((9, 12), bool)
    mask[2:7:2, 1:8:2] = True
    filled = np.zeros((9, 12), bool)
    filled[2:7, 1:8] = True
    assert np.array_equal(report.closed(mask, 1), filled)
    mask = np.zeros((5, 12), bool)
    mask[2, [0, 3, 11]] = True      # gaps of 2 and of 7
    assert np.flatnonzero(report.closed(mask, 1)[2]).tolist() == [0, 1, 2, 3, 11]


def test_shade_of_planes():
    x, y = np.meshgrid(np.arange(9.0), np.arange(9.0))      # y to the south
    flat = figures.shade(0 * x, 1.0)
    assert flat == pytest.approx(np.sqrt(0.5))
    to_the_light = figures.shade(0.3 * (x + y), 1.0)        # falls to the north-west
    away = figures.shade(-0.3 * (x + y), 1.0)
    assert to_the_light.min() > flat.max() > away.max()


# --- bad input: one line, status 2, nothing written ---

def without(path):
    return lambda: os.remove(path)


def text_of(path, text):
    return lambda: Path(path).write_text(text)


def only_failed():
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    about["runs"] = [{"run": "a", "status": "failed", "error": "E", "set": {}}]
    about["conservative"], about["largest"] = None, {}
    Path("out/study.yaml").write_text(yaml.safe_dump(about))


RUN = "out/rolling_0_steps_1200"
BAD = {
    "no folder": (lambda: None, "none", "none: must be an existing folder"),
    "an empty folder": (lambda: Path("empty").mkdir(), "empty", "empty: must be the folder of a study, with "
                        "study.yaml, or of one run, with one PREFIX.summary.yaml, got 0 summaries"),
    "two summaries": (text_of("one/b.summary.yaml", ""), "one", "one: must be the folder of a study, with study.yaml, "
                      "or of one run, with one PREFIX.summary.yaml, got 2 summaries"),
    "no thickness": (without("one/tiny.thickness.asc"), "one", "one/tiny.thickness.asc: must be"),
    "no surface": (without("one/tiny.surface.asc"), "one", "one/tiny.surface.asc: must be"),
    "no speed": (without("one/tiny.max_speed.asc"), "one", "one/tiny.max_speed.asc: must be there: fix deposit/grid"),
    "no arrival": (without("one/tiny.arrival.asc"), "one", "one/tiny.arrival.asc: must be there: fix deposit/grid"),
    "no summary": (without("one/tiny.summary.yaml"), "one", "one: must be the folder of a study"),
    "broken summary": (text_of("one/tiny.summary.yaml", "volume: {released: 3}"), "one", "one/tiny.summary.yaml: must "
                       "be a summary that fix deposit/grid wrote, with volume: on_grid"),
    "cut raster": (lambda: Path("one/tiny.arrival.asc").write_text(Path("one/tiny.arrival.asc").read_text()[:900]),
                   "one", "one/tiny.arrival.asc: values: must be 24 rows of 40"),
    "broken study": (text_of("out/study.yaml", "runs: ["), "out", "out/study.yaml: must be what `slope study` wrote"),
    "study without runs": (text_of("out/study.yaml", "study: 1\n"), "out", "out/study.yaml: must be what `slope"),
    "only failed runs": (only_failed, "out", "out/study.yaml: must have a finished run, got 1 that failed"),
    "a run is gone": (lambda: shutil.rmtree(RUN), "out", f"{RUN}/tiny.summary.yaml: must be a summary"),
    "a raster of a run": (without(f"{RUN}/tiny.surface.asc"), "out", f"{RUN}/tiny.surface.asc: must be"),
    "the envelope": (without("out/envelope_max_thickness.asc"), "out", "out/envelope_max_thickness.asc: must be"),
    "an exceedance": (without("out/exceedance_0.5m.asc"), "out", "out/exceedance_0.5m.asc: must be an existing file"),
    "the volume": (without(f"{RUN}/volume/volume_mesh.tif"), f"out --run {Path(RUN).name}",
                   f"{RUN}/volume/volume_mesh.tif: must be an exist"),
    "the road": (without("out/road.csv"), "out", "out/road.csv: must be an existing file"),
    "output suffix": (lambda: None, "one -o page.pdf", "-o: must be a file that ends in .html, got page.pdf"),
    "output folder": (lambda: None, "one -o none/page.html", "-o: must be in an existing folder, got none/page.html"),
    "section of a point": (lambda: None, "one --section 3 4 3 4", "--section: must have two different ends, got 3 4"),
    "section elsewhere": (lambda: None, "one --section 100 4 120 4", "--section: must cross the grid of the run, 0 0 "),
    "section of words": (lambda: None, "one --section 1 2 3 x", "argument --section: must be a finite number, got 'x'"),
    "run of a single run": (lambda: None, "one --run a", "--run: needs a study, with study.yaml, in one, got a"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line_and_leaves_no_trace(slope, here, name):
    make, arguments, message = BAD[name]
    make()
    before = {path: path.stat().st_mtime_ns for path in here.rglob("*")}
    status, out, err = slope(arguments)
    assert (status, out) == (2, "") and err.count("\n") == 1
    assert err.startswith(f"slope report: {message}")
    assert {path: path.stat().st_mtime_ns for path in here.rglob("*")} == before


def test_a_run_by_hand_without_terrain_in_reach(slope, here):
    os.remove("one/terrain.asc")
    os.remove("one/in.tiny")
    status, _, err = slope("one")
    assert (status, err) == (0, "")
    page, _ = read("one/report.html")
    assert "Slope collapse: run of tiny" in page and "Map of the slip surface" not in page


def test_cells_that_reach_beyond_the_terrain(slope, here):
    write_case(here / "case")
    subprocess.run([LMP, "-in", "in.tiny", "-var", "cell", "0.7", "-var", "steps", "20", "-screen", "none"],
                   cwd=here / "case", check=True)
    about = yaml.safe_load((here / "case" / "tiny.summary.yaml").read_text())
    assert about["grid"]["extent"] == pytest.approx([0, 40.6, 0, 24.5])       # the terrain: 40 x 24
    status, _, err = slope("case")
    assert (status, err) == (0, "")


def test_help_has_units_and_an_example(slope):
    status, out, _ = slope("--help")
    assert status == 0 and "units: metres" in out and "\n  tools/slope report " in out


def doc_examples():
    page = TOP / "doc" / "src" / "tool_report.rst"
    text = page.read_text(encoding="ascii").replace("\\\n", " ")
    return [command for command in re.findall(r"^ +tools/slope (report .*)", text, re.MULTILINE)
            if " DIR " not in command]


@pytest.mark.parametrize("command", [*doc_examples(), report.EPILOG.split("tools/slope ")[1].split("\n")[0]])
def test_every_example_of_the_page_and_the_help_runs(slope, here, command):
    status, _, err = slope(command.removeprefix("report "))
    assert (status, err) == (0, "")
