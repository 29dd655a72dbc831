"""tools/slope report: one page with everything in it, the answer and its doubts, the section by hand."""
import base64
import html
import json
import os
import re
import shlex
import shutil
import struct
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from rasterio.crs import CRS
from rasterio.warp import transform

import made_rows
from run_helpers import called, examples, slope as slope_in
from tiny_collapse import LMP, height, read_asc, rows_of, write_case

from slope_tools import records
from slope_tools.findings import encode_findings
from slope_tools.drawing import figures
from slope_tools.plots import (figure_charts, figure_maps, ground as report_ground,
                               section as report_section)
from slope_tools.report import data as report_data, printing
from slope_tools.deposits import travel_shares
from slope_tools.studies import outcome
from slope_tools.tables import headline, judged, quantities, rows, study_file
from slope_tools.tables.rows import finished_of

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")


@pytest.fixture(scope="module")
def made(shared):
    """A study of two combinations with a road, in out, and the same with a repeat, in repeated; their folder."""
    return shared("report", make_studies)


def make_studies(folder):
    deck = write_case(folder / "case")
    text = deck.read_text()
    # a step above the rule's: a warning in the log
    text = text.replace("timestep    0.002", "timestep    0.0025")
    text = text.replace("variable  kn", "variable  seed index 0\nvariable  kn")
    text = text.replace("neighbor    0.2", "if \"${seed} > 0\" then &\n  \"displace_atoms soil random 0.01 0.01 0.01 "
                        "${seed} units box\"\nneighbor    0.2")
    deck.write_text(text)
    for name, more in (("out", []), ("repeated", ["--repeat", "seed=1,2"])):
        done = slope_in(folder, "study", "case/in.tiny", "--set", "rolling=0,0.3", "--set", "steps=1200", "-o", name,
                        "--road", "case/road.csv", "--mesh", "4", *more)
        assert done.returncode == 0, done.stderr


@pytest.fixture
def here(made, tmp_path, monkeypatch):
    """A copy of the studies in out and repeated, and of a run as a single run in one; the test's folder."""
    for name in ("out", "repeated"):
        shutil.copytree(made / name, tmp_path / name)
    shutil.copytree(made / "out" / "rolling_0.3_steps_1200", tmp_path / "one")
    for name in ("variables.yaml", "finished.yaml"):
        (tmp_path / "one" / name).unlink()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def slope(capsys, blank_pictures):
    """Run `slope report ARGUMENTS`; gives status, stdout, stderr. Pictures are blank."""
    blank_pictures()
    return real_slope(capsys)


@pytest.fixture
def drawing_slope(capsys, monkeypatch):
    """The same, with pictures, small ones."""
    monkeypatch.setattr(figures, "DPI", 80)
    return real_slope(capsys)


def real_slope(capsys):
    def run(arguments):
        return called(capsys, ["report", *shlex.split(arguments)])
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


def change(folder, function):
    """Change every summary in a folder, and the rows of its study.yaml as `slope study` would write them then."""
    about = yaml.safe_load((folder / "study.yaml").read_text()) if (folder / "study.yaml").exists() else None
    for path in sorted(folder.rglob("*.summary.yaml")):
        summary = yaml.safe_load(path.read_text())
        function(summary)
        path.write_text(yaml.safe_dump(summary))
        for row in about["runs"] if about else ():
            if row["status"] == "finished" and row["summary"] == str(path.relative_to(folder)):
                known = {**quantities.of_summary(summary),
                         **judged.list_ending_columns(summary, SimpleNamespace(notes=[], warnings=[]))}
                row.update({key: known[key] for key in known if key not in ("release", "log_warnings", "released_m3")},
                           front_m=summary["travel"]["front"], **travel_shares.read_share_columns(summary))
                key = travel_shares.DISTANCE
                about["largest"].pop(key, None)
    if about:
        finished = finished_of(map(rows.read_row, about["runs"]))
        about["largest"]["front_m"] = records.encode_record(outcome.find_largest_row(finished, "front_m"))
        if all(row.value(key) is not None for row in finished):
            about["largest"][key] = records.encode_record(outcome.find_largest_row(finished, key))
        write_study(folder, about)


def write_study(folder, about, *more):
    """study.yaml with rows that were changed, and their findings, as `slope study` would write them; more: findings."""
    about["warnings"] = [*encode_findings(judged.of_runs([rows.read_row(one) for one in about["runs"]])), *more]
    (folder / "study.yaml").write_text(yaml.safe_dump(about))


def set_moving(folder, share, reason="halted", speed=2.5):
    """Say that so much of the volume moves at the end, and how the run ended."""
    def set_it(summary):
        summary["moving"] = share > 0.1
        summary["stop"]["reason"] = reason
        summary["motion"].update(moving_share=share, fast_share=share, fast_speed=speed,
                                 fast_volume=share * summary["volume"]["released"])
    change(folder, set_it)


def of_an_older_version(summary):
    """Take away what older versions did not write."""
    summary.pop("release", None)
    for key in ("quantiles", "farthest", "top"):
        summary["travel"].pop(key, None)
    for key in ("fast_share", "fast_volume", "fast_speed"):
        summary["motion"].pop(key, None)


def with_travel(summary):
    """Distances by hand: 10, 20, 30, 31.25 m, and a ball at 99."""
    summary["travel"]["quantiles"] = [{"share": share, "distance": distance, "reach_angle": angle} for
                                      share, distance, angle in ((0.5, 10.0, 40.0), (0.9, 20.0, 30.0),
                                                                 (0.95, 30.0, 25.0), (0.99, 31.25, 22.5))]
    summary["travel"]["farthest"] = {"distance": 99.0, "reach_angle": 11.5}
    summary["travel"]["front"] = 99.0


def with_release(body, factor):
    """A function that says of a summary that its balls stand for a body (m3, or None)."""
    def set_it(summary):
        summary["bulk_factor"] = factor
        summary["release"] = {"region": "body" if body else None, "body_volume": body, "ball_volume": 10.0, "balls": 9,
                              "bulk_factor": factor, "from_cubic": factor / (6 / np.pi) - 1}
    return set_it


def cards(page):
    """{what: (number, note)} of the cards on top of a page."""
    found = re.findall(r'<div class="what">([^<]*)</div><div class="number[^"]*">(.*?)</div>'
                       r'<div class="note">(.*?)</div>', page)
    return {what: (re.sub("<[^>]*>", "", number).strip(), html.unescape(note)) for what, number, note in found}


def numbers(path):
    """Rows of a report's numbers.csv."""
    return rows_of(path)


# --- one file ---

@pytest.mark.drawn
@pytest.mark.parametrize("folder, least", [("out", 14), ("repeated", 14), ("one", 7)])
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
    for value in (summary["slope_version"], summary["lammps_version"], f"{summary['volume']['released']:,.1f} m³"):
        assert value in text
    # the study's table: its numbers are those of study.csv, rounded; all digits are in numbers.csv
    rows = next(table for table in reader.tables if any("to remove" in cell for cell in table[0]))
    assert len(rows) == 3
    kept = {(row["what"], row["of"]): row for row in numbers("out/report.numbers.csv")}
    for row, cells in zip(about["runs"], rows[1:]):
        assert cells[:2] == [str(about["runs"].index(row) + 1), row["set"]["rolling"]]
        for head, key in (("to remove", "remove_m3"), ("farthest ball", "front_m")):
            cell = cells[next(k for k, name in enumerate(rows[0]) if name.startswith(head))]
            assert float(cell.replace(",", "")) == pytest.approx(row[key], rel=6e-3)    # three digits
            entry = kept[head, f"rolling {row['set']['rolling']}"]
            assert float(entry["value"]) == row[key] and entry["shown"] == cell.replace(",", "")
        assert cells[-1] == row["end_short"]
    # nothing of other sites, nothing of the paper's figures
    for word in ("company", "24,048", "14,225", "Table 5", "Figure 1", "Nakadori"):
        assert word not in text.replace((run / "in.tiny").read_text(), "")


def test_the_shown_run_is_the_one_that_the_volume_rests_on(slope, here):
    about = yaml.safe_load(Path("repeated/study.yaml").read_text())
    names = [row["run"] for row in about["runs"]]
    assert slope("repeated -o page.html")[0] == 0
    best = max((row for row in about["runs"] if row["set"] == about["conservative"]["set"]),
               key=lambda row: row["remove_m3"])
    label = f"rolling {best['set']['rolling']}" + "".join(f", {name} {value}" for name, value in best["repeat"].items())
    assert f"Maps of the run {label}</h2>" in Path("page.html").read_text()
    for name in names[:2]:
        assert slope(f"repeated --run {name} -o page.html")[0] == 0
        label = name.split("_steps")[0].replace("_", " ") + "".join(f", seed {k}" for k in name.split("_seed_")[1:])
        assert f"travel of the run {label}</h2>" in Path("page.html").read_text()
    status, _, err = slope("out --run nothing")
    assert (status, err) == (2, f"slope report: --run: must be a finished run of out/study.yaml, such as {names[0]}, "
                                "got nothing\n")


# --- the answer ---

def stands(name):
    """Let the conservative volume of a study stand, though its runs are cut short; gives its entry in study.yaml."""
    path = Path(name) / "study.yaml"
    about = yaml.safe_load(path.read_text())
    best = about["conservative"]
    assert best["withheld"] and best["volume_m3"] is None
    best["withheld"] = []
    for parts in (best, best["rounded"]):
        parts["volume_m3"] = parts["mean_m3"] + (parts["chance_m3"] or 0)
    path.write_text(yaml.safe_dump(about))
    said = headline.combine_answers(headline.sweep_of(study_file.load_study(path)), None, None)
    path.write_text(yaml.safe_dump({**about, "headline": records.encode_record(said)}))
    return best


def test_a_number_that_is_withheld_is_not_in_the_answer(slope, here):
    """Its place says why, and what mends it."""
    best = yaml.safe_load(Path("repeated/study.yaml").read_text())["conservative"]
    assert slope("repeated")[0] == 0
    page = Path("repeated/report.html").read_text()
    top = page[page.index('<div class="card main'):page.index('<div class="card">')]
    assert "Not usable as a number to design with:" in top and "card main withheld" in top
    for one in best["withheld"]:
        assert html.escape(f"{one['text'][0].upper()}{one['text'][1:]}.") in top and html.escape(one["remedy"]) in top
    assert not re.search(r"[0-9] *(<small>)?m[3³]", top)
    assert "conservative volume, " not in page          # nor is it in the chart


def test_the_headline_and_its_parts(slope, here):
    best = stands("repeated")
    assert best["chance_m3"] > 0 and best["kind"] == "prediction"
    assert slope("repeated")[0] == 0
    page = Path("repeated/report.html").read_text()
    top = page[page.index('<div class="card main'):page.index('<div class="card">')]
    assert '"card main"' in top
    assert "Conservative volume to remove from the road" in top
    parts = re.findall(r'<div class="sum">([+ ]*)([\d,.]+|unknown)[^<]*</div><div class="name">([^<]*)</div>', top)
    assert [(sign.strip(), name) for sign, _, name in parts] == [("", "mean"), ("+", "chance")]
    values = [value for _, value, _ in parts]
    total = re.search(r'<div class="number">([\d,.]+)', top)[1]
    added = sum(float(value.replace(",", "")) for value in values)
    assert float(total.replace(",", "")) == pytest.approx(added)        # the rounded parts add up
    # rounded to what is known, not below what was computed
    assert 0 <= added - best["volume_m3"] < 2 * best["place_m3"]
    rows = {row["what"]: row for row in numbers("repeated/report.numbers.csv")}
    assert float(rows["conservative: volume_m3"]["value"]) == best["volume_m3"]
    assert f"t {best['quantile']:.3g}" in top and "rolling" in top
    # the table over the combinations
    assert "&plusmn;" in page or "\N{PLUS-MINUS SIGN}" in page


def test_without_repeats_nothing_is_called_conservative(slope, here):
    stands("out")
    assert slope("out")[0] == 0
    page = Path("out/report.html").read_text()
    top = page[page.index('<div class="card main'):page.index('<div class="card">')]
    assert "unsure" in top and "largest of 2 runs; chance unknown" in top and "onservative" not in page.split("<h2")[0]
    assert "chance unknown" in page.split("id=\"study\"")[1]       # the difference over rolling is no trend


def test_what_sizes_of_balls_say(slope, here):
    """On page 1, and where the appendix says how uncertain the numbers are."""
    stands("repeated")
    about = yaml.safe_load(Path("repeated/study.yaml").read_text())
    text = "computed with up to 25,600 balls; finer ones would change the volume by -3 to +1 %"
    about["size"] = {"sizes": [], "parameters": [], "effects": {}, "text": text}
    Path("repeated/study.yaml").write_text(yaml.safe_dump(about))
    assert slope("repeated")[0] == 0
    page = Path("repeated/report.html").read_text()
    assert page.count(f"C{text[1:]}.") == 2 and page.count(f"C{text[1:]}. More may come to lie beyond the road") == 1


@pytest.mark.parametrize("by, chance, clear, told", [
    (30.0, 100.0, False, "within chance (100"), (300.0, 100.0, True, "more than chance (100"),
    (30.0, None, None, "chance unknown")])
def test_differences_are_judged_against_chance(slope, here, by, chance, clear, told):
    about = yaml.safe_load(Path("repeated/study.yaml").read_text())
    [entry] = about["conservative"]["differences"]
    entry.update(by_m3=by, chance_m3=chance, clear=clear)
    Path("repeated/study.yaml").write_text(yaml.safe_dump(about))
    assert slope("repeated")[0] == 0
    [line] = [text for _, text in read("repeated/report.html")[1].warnings if text.startswith("rolling: ")]
    assert told in line and ("no trend" in line) == (clear is False)


def test_a_chart_joins_what_differs_by_more_than_chance(here, slope, monkeypatch):
    drawn = []
    monkeypatch.setattr(figure_charts, "chart", lambda series, *_: drawn.append(series) or "data:,")
    about = yaml.safe_load(Path("repeated/study.yaml").read_text())
    for far, joined in ((0.0, False), (1e4, True)):
        drawn.clear()
        for k, row in enumerate(about["runs"]):
            row["remove_m3"] = 1000 + (k % 3) + far * (row["set"]["rolling"] != "0")
        about["scatter"]["remove_m3"] = {"deviation": 1.0, "degrees_of_freedom": 4.0}
        Path("repeated/study.yaml").write_text(yaml.safe_dump(about))
        assert slope("repeated")[0] == 0
        assert [one.joined for one in drawn[0]] == [joined]
    assert slope("out")[0] == 0 and not any(one.joined for one in drawn[-1])     # one run each


def test_travel_is_what_99_percent_stay_within(slope, here):
    change(here / "one", with_travel)
    assert slope("one")[0] == 0
    page, reader = read("one/report.html")
    number, note = cards(page)["99 % of the volume stays within"]
    assert number == "31.2 m" and "reach angle 22.5 degrees" in note and "farthest ball 99.0 m" in note
    table = next(table for table in reader.tables if table[0][0] == "of the deposit")
    assert [row[:3] for row in table[1:5]] == [
        ["50 % of the volume", "10.0", "40.0"], ["90 % of the volume", "20.0", "30.0"],
        ["95 % of the volume", "30.0", "25.0"], ["99 % of the volume", "31.2", "22.5"]]
    assert any(row[0].startswith("length along the fall path, to the farthest lobe of at least 1 %") for row in table)
    assert ["the one farthest ball", "99.0", "11.5"] in table
    values = {row["what"]: row["value"] for row in numbers("one/report.numbers.csv")}
    assert float(values["99 %: distance"]) == 31.25
    change(here / "out", with_travel)
    assert slope("out")[0] == 0
    number, note = cards(read("out/report.html")[0])["99 % of the volume stays within"]
    assert number == "31.2 m" and "farthest ball 99.0 m" in note


@pytest.mark.parametrize("folder", ["one", "out"])
def test_what_an_older_run_does_not_tell_is_unknown(slope, here, folder):
    change(here / folder, of_an_older_version)
    status, _, err = slope(folder)
    assert (status, err) == (0, "")
    page, reader = read(f"{folder}/report.html")
    number, note = cards(page)["99 % of the volume stays within"]
    assert number == "unknown" and "farthest ball" in note and "older version" in note
    assert "body unknown" in cards(page)["Released"][1]
    table = next(table for table in reader.tables if table[0][0] == "of the deposit")
    assert table[1][1:] == ["unknown", "unknown"]


@pytest.mark.parametrize("folder", ["one", "out"])
def test_how_far_a_mass_went_that_left_the_terrain_is_unknown(slope, here, folder):
    def lost(about):
        about["volume"]["lost"] = 0.02 * about["volume"]["released"]
        about["travel"]["quantiles"][-1].update(distance=None, reach_angle=None)

    with_quantiles = here / folder
    change(with_quantiles, with_travel)
    change(with_quantiles, lost)
    status, _, err = slope(folder)
    assert status == 0
    page, reader = read(f"{folder}/report.html")
    number, note = cards(page)["99 % of the volume stays within"]
    assert number == "unknown" and "left the terrain" in note and "1 %" in note
    table = next(table for table in reader.tables if table[0][0] == "of the deposit")
    assert table[4][1:3] == ["unknown", "unknown"] and "unknown" not in table[3]
    assert "Distance of the farthest ball" not in page       # of those that stayed


def test_the_run_that_lost_most_went_farthest(slope, here):
    """Whatever the distances of the balls that stayed; the report shows it where no volume on a road governs."""
    path = Path("out/study.yaml")
    about = yaml.safe_load(path.read_text())
    first, second = about["runs"]
    about["conservative"] = None
    for lost, distances, fronts, farthest in (((0, 0), (50.0, 60.0), (900.0, 70.0), second),
                                              ((0.02, 0), (None, 60.0), (40.0, 70.0), first),
                                              ((0.02, 0.3), (None, None), (40.0, 30.0), second)):
        for row, share, distance, front in zip(about["runs"], lost, distances, fronts):
            row.update(lost_m3=share * row["released_m3"], distance_99_m=distance, front_m=front)
        path.write_text(yaml.safe_dump(about))
        assert rows.find_farthest_run(finished_of(map(rows.read_row, about["runs"]))).run == farthest["run"]
        assert report_data.Data(Path("out")).result.name == farthest["run"]


@pytest.mark.parametrize("body, factor, words, doubt", [
    (1000.0, 1.14 * 6 / np.pi, ("body 1,000 m³", "bulk factor 2.177, 14 % above 6/pi"), False),
    (1000.0, 1.16 * 6 / np.pi, ("16 % above 6/pi",), True), (None, 6 / np.pi, ("body unknown",), False)])
def test_the_released_mass_and_its_body(slope, here, body, factor, words, doubt):
    def set_it(summary):
        with_release(body, factor)(summary)
        if body:        # what is released is the body
            summary["release"]["body_volume"] = summary["volume"]["released"]
    change(here / "one", set_it)
    log = here / "one" / "log.lammps"
    log.write_text("".join(line for line in log.read_text().splitlines(True) if "Delete_balls" not in line))
    assert slope("one")[0] == 0
    page, reader = read("one/report.html")
    note = cards(page)["Released"][1]
    table = next(row[1] for table in reader.tables for row in table if row[0] == "the released mass")
    for word in words:
        assert word.replace("1,000", cards(page)["Released"][0].split()[0]) in table
    assert "bulk factor" not in note and "body" in note
    assert any("released mass is doubtful" in text for _, text in reader.warnings) == doubt
    assert ("all of it released" in note) == (body is not None)


def test_many_balls_removed_without_a_body_are_doubted(slope, here):
    change(here / "one", of_an_older_version)
    log = here / "one" / "log.lammps"
    log.write_text(re.sub("^Delete_balls: .*", "Delete_balls: 30 balls of group soil removed; 70 balls left",
                          log.read_text(), flags=re.MULTILINE))
    assert slope("one")[0] == 0
    page, reader = read("one/report.html")
    assert "30 % of the balls overlapped the slip surface or the ground" in cards(page)["Released"][1]
    assert any("released mass is doubtful" in text for _, text in reader.warnings)


# --- warnings ---

@pytest.mark.parametrize("folder", ["out", "one"])
def test_red_on_a_deposit_that_moves(slope, here, folder):
    set_moving(here / folder, 0.42)
    status, out, _ = slope(folder)
    page, reader = read(f"{folder}/report.html")
    red = [text for level, text in reader.warnings if level == "red"]
    assert status == 0 and len(red) == 1 and "not at rest" in red[0] and "42 % of the volume" in red[0]
    assert "WARNING: " in out and "not at rest" in out
    assert re.search(r'number status (\w+)', page)[1] == "moving"
    # first in the appendix, on the client's page in its words, and really red
    assert page.index('id="appendix"') < page.index('<li class="red">not at rest') < \
        page.index("<figure", page.index('id="appendix"'))
    assert "more than a tenth of the mass in motion" in page[:page.index('id="appendix"')]
    assert re.search(r"\.warnings \.red \{[^}]*color: #7d0c12", page) and '--red: #b3131b' in page
    assert not [level for level, _ in reader.warnings if level == "green"]


def without_log_warnings(folder):
    for log in folder.rglob("log.lammps"):
        log.write_text(re.sub(r"^WARNING.*\n|^Delete_balls.*\n", "", log.read_text(), flags=re.MULTILINE))
    if (folder / "study.yaml").exists():
        about = yaml.safe_load((folder / "study.yaml").read_text())
        about["conservative"]["doubts"] = []
        for row in about["runs"]:
            row["log_warnings"], row["release"]["removed"] = [], None
        write_study(folder, about)


@pytest.mark.parametrize("share, reason, level", [
    (0.009, "halted", "green"), (0.042, "halted", "amber"), (0.0, "run completed", "amber")])
@pytest.mark.parametrize("folder", ["out", "one"])
def test_green_only_at_rest(slope, here, folder, share, reason, level):
    """As test_repeats.py has it."""
    set_moving(here / folder, share, reason, 12.5)
    without_log_warnings(here / folder)
    assert slope(folder)[0] == 0
    page, reader = read(f"{folder}/report.html")
    [found] = [(level, text) for level, text in reader.warnings if level]
    assert found[0] == level
    assert re.search(r'number status (\w+)', page)[1] == {"green": "rest", "amber": "doubt"}[level]
    if level != "green":
        volume = share * yaml.safe_load(next((here / folder).rglob("*.summary.yaml")).read_text())["volume"]["released"]
        assert f"{volume:,.3g} m³" in found[1] and "up to 12 m/s" in found[1]
        assert ("stopped at its duration" in found[1] or "stopped at their duration" in found[1]) == (
            reason == "run completed")
        if folder == "out":     # of a study the card counts the deposits
            assert "At rest at the end" in page and re.search(r"At rest at the end.{0,200}\b0 of 2\b", page, re.DOTALL)
        else:
            assert "At the end of the run" in page and "At rest at the end" not in page


def test_one_line_for_each_kind_of_warning(slope, here):
    about = yaml.safe_load(Path("repeated/study.yaml").read_text())
    for k, row in enumerate(about["runs"]):
        row["log_warnings"] = [f"Pair gran/restitution: {k + 3} contacts were seen deeper than 10 %", "Neighbor lists"]
    about["runs"][0]["log_warnings"] += ["Pair gran/restitution: 99 contacts were seen deeper than 10 %"]
    about["runs"][4]["log_warnings"] = ["Only here"]
    for k, share in ((1, 1e-5), (2, 3e-5)):
        about["runs"][k]["mass_error"] = share
    for name in ("a", "b", "c"):
        about["runs"].append({"run": name, "status": "failed", "set": {"rolling": name, "steps": "1200"}, "repeat": {},
                              "batch": 0, "error": f"ERROR: 1{len(about['runs'])} <b>atoms lost", "log_warnings": []})
    write_study(Path("repeated"), about, {"kind": "of another version", "text": "the road ends in the grid"})
    assert slope("repeated")[0] == 0
    page, reader = read("repeated/report.html")
    texts = [text for level, text in reader.warnings if level]
    assert sum("contacts were seen" in text for text in texts) == 1
    [deep] = [text for text in texts if "contacts were seen" in text]
    assert deep.startswith("LAMMPS: Pair gran/restitution: ") and "5 of 9 runs: " in deep
    assert "and 1 more" in deep and "other numbers in some" in deep
    [neighbor] = [text for text in texts if "Neighbor lists" in text]
    assert "5 of 9 runs" in neighbor and "other numbers" not in neighbor
    [only] = [text for text in texts if "Only here" in text]
    assert only.endswith("(1 of 9 runs: rolling 0.3, seed 1)")
    assert "the road ends in the grid" in texts
    [differ] = [text for text in texts if "differs from released" in text]
    assert "3.0e-05" in differ      # the gravest comes first
    assert "2 of 6 runs: rolling 0, seed 2; rolling 0, seed 1; other numbers in some" in differ
    [failed] = [text for text in texts if "atoms lost" in text]
    assert ["red", failed] in reader.warnings and "<b>atoms" not in page
    assert failed.startswith("failed: ERROR: ") and "(3 of 9 runs: rolling a; rolling b; rolling c; " in failed


def test_lost_mass_is_named(slope, here):
    path = here / "one" / "tiny.summary.yaml"
    path.write_text(re.sub(r"^  lost: 0.0", "  lost: 12.5", path.read_text(), flags=re.MULTILINE))
    assert slope("one")[0] == 0
    [(level, text)] = [one for one in read("one/report.html")[1].warnings if "left the grid or the box" in one[1]]
    assert level == "red" and "12.5 m³" in text and "how far they went is unknown" in text      # 4 %
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    for row, lost in zip(about["runs"], (1.5, 2.5)):
        row["lost_m3"] = lost
    write_study(Path("out"), about)
    assert slope("out")[0] == 0
    [(level, text)] = [one for one in read("out/report.html")[1].warnings if "left the grid or the box" in one[1]]
    assert level == "amber" and "unknown" not in text       # 0.7 %
    assert text.startswith("up to 2.5 m³") and text.endswith("(all 2 runs)")


def test_what_lies_beyond_the_road_is_explained(slope, here):
    assert slope("out")[0] == 0
    assert "the two overlap and cannot be added" in Path("out/report.html").read_text()
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    for row in about["runs"]:
        row["beyond_road_m3"] = None
    Path("out/study.yaml").write_text(yaml.safe_dump(about))
    assert slope("out")[0] == 0
    page = Path("out/report.html").read_text()
    assert "How much lies beyond the road is unknown" in page and "--line" in page and "cannot be added" not in page


def test_the_fix_s_lines_of_lost_balls_are_folded_into_that(slope, here):
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    for row in about["runs"]:
        row["log_warnings"] = ["Fix deposit/grid deposit: ball 805 left the box at 1 2 3, step 4, lost so far: 1"]
    for lost, said in ((0.0, "ball 805"), (12.5, "left the grid or the box")):
        about["runs"][0]["lost_m3"] = lost
        write_study(Path("out"), about)
        assert slope("out")[0] == 0
        [text] = [text for _, text in read("out/report.html")[1].warnings if "left the" in text]
        assert said in text


def test_warnings_of_the_study_s_tools_are_shown_each(slope, here):
    """Those of the study as a whole are in red."""
    texts = ["the body is thinner than 3 balls everywhere: the numbers will be rough",
             "the body is in 2 parts",
             "the slip surface is above the ground"]
    set_moving(here / "out", 0.0)
    without_log_warnings(here / "out")
    stands("out")
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    about["warnings"] = [{"kind": "of another version", "text": text} for text in texts]
    Path("out/study.yaml").write_text(yaml.safe_dump(about))
    status, out, _ = slope("out")
    page, reader = read("out/report.html")
    assert status == 0 and [text for level, text in reader.warnings if level == "red"] == [
        text.replace("m3", "m\N{SUPERSCRIPT THREE}") for text in texts]
    assert [level for level, _ in reader.warnings if level] == ["red"] * 3
    assert all(f"WARNING: {text}" in out for text in texts)
    assert "What smaller balls change is not known" in page


@pytest.mark.parametrize("folder", ["out", "one"])
def test_a_mass_of_a_million_m3_is_said_to_run_farther(slope, here, folder):
    for volume, said in ((0.99e6, False), (1e6, True), (36e6, True)):
        def set_it(summary, volume=volume):
            summary["volume"]["released"] = volume
        change(here / folder, set_it)
        if folder == "out":
            about = yaml.safe_load(Path("out/study.yaml").read_text())
            about["runs"][0]["released_m3"] = volume
            write_study(Path("out"), about)
        assert slope(folder)[0] == 0
        page, reader = read(f"{folder}/report.html")
        found = [text for level, text in reader.warnings if level == "amber" and "run-out is not conservative" in text]
        assert len(found) == said == ("Masses of 1 million m³ and more" in page)
        assert all(f"{volume / 1e6:.3g} million m³" in text for text in found)


def test_what_lies_above_a_cut_below_the_ground_is_told(slope, here):
    """In the answer; with a warning where it is more than 10 % of the volume to remove."""
    best = stands("out")
    path = Path("out") / best["run"] / "volume" / "volume.yaml"
    about = yaml.safe_load(path.read_text())
    for share, warned in ((0, False), (0.05, False), (0.6, True)):
        about["volume"]["remove_where_cut_below_ground"] = share * about["volume"]["remove"]
        path.write_text(yaml.safe_dump(about))
        assert slope("out")[0] == 0
        page, reader = read("out/report.html")
        top = page[page.index('<div class="card main'):page.index('<div class="card">')]
        assert ("where the cut surface is below the ground" in top) == (share > 0)
        found = [text for _, text in reader.warnings if "where the cut surface is below the ground" in text]
        assert bool(found) == warned and all("60 % of it" in text for text in found)
    path.unlink()       # of an older version
    assert slope("out")[0] == 0


# --- numbers from elsewhere ---

REFERENCE = """\
title: Somebody's measurements
remark: Of another slope.
quantities:
  remove_m3:
    variable: rolling
    series: {theirs: {0.3: 120.5, 0: 4711}}
    levels: {measured: 1234}
  front_m:
    levels: {mapped: 33.5}
"""


def test_numbers_from_elsewhere_stand_beside(slope, here):
    Path("ref.yaml").write_text(REFERENCE)
    assert slope("out --reference ref.yaml")[0] == 0
    page, reader = read("out/report.html")
    assert "Somebody&#39;s measurements" in page and "Of another slope." in page
    assert ["rolling", "0", "0.3"] in [row for table in reader.tables for row in table]
    assert ["theirs", "4,711", "120.5"] in [row for table in reader.tables for row in table]
    assert ["measured", "1,234"] in [row for table in reader.tables for row in table]
    assert ["mapped", "33.5"] in [row for table in reader.tables for row in table]
    # a single run has no road, but a front
    Path("ref.yaml").write_text("title: T\nquantities: {front_m: {levels: {mapped: 33.5}}}\n")
    assert slope("one --reference ref.yaml")[0] == 0
    assert ["mapped", "33.5"] in [row for table in read("one/report.html")[1].tables for row in table]


def test_no_paper_is_still_taken(slope, here):
    status, out, err = slope("out --no-paper")
    assert (status, err) == (0, "") and "--no-paper is the default now" in out


# --- the size of the balls ---

def write_converge(path):
    entry = {"name": "to remove", "unit": "m3", "resolved": False, "sizes": [
        {"value": 4.0, "mean": 12600.0, "scatter": 300.0, "balls_thick": 4.5},
        {"value": 2.0, "mean": 14432.0, "scatter": None, "balls_thick": 9.0}]}
    Path(path).write_text(yaml.safe_dump({"study": {"variable": "d", "deck": "in.other", "finished": 7},
                                          "quantities": {"remove_m3": entry}}))


def test_the_report_takes_the_convergence_in(slope, here):
    Path("sizes").mkdir()
    write_converge("sizes/converge.yaml")
    pages = []
    for name in ("sizes", "sizes/converge.yaml"):
        assert slope(f"out --converge {name}")[0] == 0
        page, reader = read("out/report.html")
        row = next(row for table in reader.tables for row in table if row[0] == "to remove m³" and len(row) == 3)
        assert row[1:] == ["4 (4.5 balls thick): 12,600; 2 (9.0 balls thick): 14,400", "no"]
        assert "To remove against the size of the balls" in reader.alt and "7 runs of in.other" in page
        pages.append(len(reader.pictures))
    assert slope("out")[0] == 0
    _, reader = read("out/report.html")
    assert len(reader.pictures) == pages[0] - 1 and "To remove against the size of the balls" not in reader.alt


# --- the section ---

def test_known_events_are_of_the_body_that_study_yaml_names(here):
    """Not of a site in whose folder the study only lies."""
    (here / "site.yaml").write_text("{}\n")
    (here / "release.depth.asc").touch()
    found = []
    for body in (None, "../mine"):
        path = here / "out" / "study.yaml"
        about = yaml.safe_load(path.read_text())
        path.write_text(yaml.safe_dump({**about, "study": {**about["study"], "body": body}}))
        found.append(report_ground.Ground(report_data.Data(Path("out"))).site)
    assert found == [None, Path("out/../mine")]


def section(path):
    rows = rows_of(path)
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
    data = report_data.Data(Path("out"))
    line = report_section.Section(data, report_ground.Ground(data), ["2.0", "12.5", "38.0", "12.5"], False)
    spans, cut = line.road()
    x = line.xy[:, 0]
    assert spans == [[pytest.approx(6.0), pytest.approx(11.0)]]      # x 8 to 13, from 2
    beyond = x > 13
    base = (read_asc(data.result.prefix.with_suffix(".surface.asc")) - data.result.thickness)[11]
    edge = np.interp(13, np.arange(40) + 0.5, base)
    assert cut[beyond] == pytest.approx(edge + (x[beyond] - 13) * np.tan(np.radians(30)), abs=1e-7)
    assert np.isnan(cut[(x > 8) & (x < 13)]).all()


BENT = [[4.5, 4.5], [20.5, 4.5], [20.5, 20.5], [36.5, 20.5]]


def test_the_section_follows_a_line(slope, here):
    name = "line.wkt"
    Path(name).write_text("LINESTRING (" + ", ".join(f"{x} {y}" for x, y in BENT) + ")")
    assert slope(f"one --section {name}")[0] == 0
    line = section("one/report.section.csv")
    assert line["distance"][-1] == pytest.approx(48, abs=1e-3) and line["distance"][0] == 0
    # every point lies on the line, at its distance
    along = line["distance"]
    x = np.interp(along, [0, 16, 32, 48], [4.5, 20.5, 20.5, 36.5])
    y = np.interp(along, [0, 16, 32, 48], [4.5, 4.5, 20.5, 20.5])
    assert line["x"] == pytest.approx(x, abs=1e-3) and line["y"] == pytest.approx(y, abs=1e-3)
    centres = np.arange(40) + 0.5
    assert line["ground_before"] == pytest.approx(np.interp(x, centres, height(centres)), abs=1e-3)
    assert f"along the line of {name}" in Path("one/report.html").read_text()
    # the folder may stand behind
    shutil.copy("one/report.section.csv", "before.csv")
    assert slope(f"--section {name} one")[0] == 0 and slope("--section 4 12 38 12 one")[0] == 0


def test_a_line_in_degrees_comes_to_the_run(slope, here):
    """A GeoJSON is in longitude and latitude; the sidecar of the terrain tells where the run's metres lie."""
    crs, east, north = CRS.from_epsg(6677), -12000.0, 34000.0
    Path("one/terrain.yaml").write_text(yaml.safe_dump({
        "crs": {"epsg": 6677, "wkt": crs.to_wkt()}, "origin": {"east": east, "north": north}, "cell": 1.0,
        "size": {"columns": 40, "rows": 24}, "extent": {"xlo": 0.0, "xhi": 40.0, "ylo": 0.0, "yhi": 24.0}}))
    x, y = np.transpose(BENT)
    points = np.transpose(transform(crs, CRS.from_epsg(4326), x + east, y + north)).tolist()
    Path("line.geojson").write_text(json.dumps({"type": "LineString", "coordinates": points}))
    assert slope("one --section line.geojson")[0] == 0
    line = section("one/report.section.csv")
    assert (line["x"][0], line["y"][0]) == pytest.approx(BENT[0], abs=1e-3)
    assert (line["x"][-1], line["y"][-1]) == pytest.approx(BENT[-1], abs=1e-3)
    assert line["east"] == pytest.approx(line["x"] + east) and line["north"] == pytest.approx(line["y"] + north)
    # the same numbers as local metres, on demand
    Path("line.csv").write_text("".join(f"{x},{y}\n" for x, y in BENT))
    assert slope("one --section line.csv --local")[0] == 0
    assert section("one/report.section.csv")["x"][0] == pytest.approx(BENT[0][0], abs=1e-3)
    status, _, err = slope("one --section line.csv")
    assert status == 2 and err.startswith("slope report: line.csv: must cross the grid of the run")


def test_the_scar_is_there_with_and_without_the_base_raster(slope, here):
    assert Path("one/tiny.base.asc").is_file()
    assert slope("one --section 6.5 12.5 38.5 12.5")[0] == 0
    with_base = section("one/report.section.csv")
    os.remove("one/tiny.base.asc")      # of an older version
    assert slope("one --section 6.5 12.5 38.5 12.5")[0] == 0
    without = section("one/report.section.csv")
    assert without["base"] == pytest.approx(with_base["base"], abs=2e-4)
    assert (with_base["ground_before"] - with_base["base"]).max() > 2


def test_one_map_for_each_combination(slope, here, monkeypatch):
    drawn = []
    monkeypatch.setattr(figure_maps, "small_maps", lambda layers, panels, *_: drawn.append(panels) or "data:,")
    assert slope("repeated")[0] == 0
    best = yaml.safe_load(Path("repeated/study.yaml").read_text())["conservative"]["run"]
    names = [name for name, _ in drawn[0]]
    assert len(names) == 2 and sorted(name.split(",")[0] for name in names) == ["rolling 0", "rolling 0.3"]
    # the run of the other maps stands for its own combination
    assert best.replace("_steps_1200", "").replace("_seed_", ", seed ").replace("rolling_", "rolling ") in names
    assert "2 of the 6 runs are shown" in Path("repeated/report.html").read_text()


# --- bad input: one line, status 2, nothing written ---

def without(path):
    return lambda: os.remove(path)


def text_of(path, text):
    return lambda: Path(path).write_text(text)


def only_failed():
    about = yaml.safe_load(Path("out/study.yaml").read_text())
    about["runs"] = [rows.encode_row(made_rows.row(status="failed"))]
    about["conservative"], about["largest"] = None, {}
    Path("out/study.yaml").write_text(yaml.safe_dump(about))


RUN = "out/rolling_0_steps_1200"
REFERENCES = "r.yaml: must be a file of reference values (see the page on `slope report`)"
BAD = {     # what else a file may have: test_schemas.py
    "no folder": (lambda: None, "none", "none: must be an existing folder"),
    "an empty folder": (lambda: Path("empty").mkdir(), "empty", "empty: must be the folder of a study, with "
                        "study.yaml, or of one run, with one PREFIX.summary.yaml, got 0 summaries"),
    "two summaries": (text_of("one/b.summary.yaml", ""), "one", "one: must be the folder of a study, with study.yaml, "
                      "or of one run, with one PREFIX.summary.yaml, got 2 summaries"),
    "no thickness": (without("one/tiny.thickness.asc"), "one", "one/tiny.thickness.asc: must be"),
    "no arrival": (without("one/tiny.arrival.asc"), "one", "one/tiny.arrival.asc: must be there: fix deposit/grid"),
    "broken summary": (text_of("one/tiny.summary.yaml", "volume: {released: 3}"), "one", "one/tiny.summary.yaml: must "
                       "be a summary that fix deposit/grid wrote: must have travel"),
    "broken study": (text_of("out/study.yaml", "runs: ["), "out", "out/study.yaml: must be what `slope study` wrote"),
    "only failed runs": (only_failed, "out", "out/study.yaml: must have a finished run, got 1 that failed"),
    "a run is gone": (lambda: shutil.rmtree(RUN), "out", f"{RUN}/tiny.summary.yaml: must be a summary"),
    "the envelope": (without("out/envelope_max_thickness.asc"), "out", "out/envelope_max_thickness.asc: must be"),
    "an exceedance": (without("out/exceedance_0.5m.asc"), "out", "out/exceedance_0.5m.asc: must be an existing file"),
    "the volume": (without(f"{RUN}/volume/volume_mesh.tif"), f"out --run {Path(RUN).name}",
                   f"{RUN}/volume/volume_mesh.tif: must be an exist"),
    "the road": (without("out/road.csv"), "out", "out/road.csv: must be an existing file"),
    "output suffix": (lambda: None, "one -o page.pdf", "-o: must be a file that ends in .html, got page.pdf"),
    "output folder": (lambda: None, "one -o none/page.html", "-o: must be in an existing folder, got none/page.html"),
    "section of a point": (lambda: None, "one --section 3 4 3 4", "--section: must have two different ends, got 3 4"),
    "section of three numbers": (lambda: None, "one --section 3 4 3", "--section: must be X1 Y1 X2 Y2, the file of a "),
    "section of two lines": (text_of("p.wkt", "MULTILINESTRING ((0 0, 1 0), (3 3, 9 9))"), "one --section p.wkt",
                             "p.wkt: must hold one line, for --section, got 2 lines"),
    "section line elsewhere": (text_of("p.wkt", "LINESTRING (100 0, 110 0, 120 9)"), "one --section p.wkt", "p.wkt: "
                               "must cross the grid of the run, 0 0 40 24 (local metres), got 100 0 120 9"),
    "no folder at all": (lambda: None, "--section 1 2 3 4", "DIR: must be given"),
    "no reference": (lambda: None, "out --reference none.yaml", "none.yaml: must be a file of reference values"),
    "reference without quantities": (text_of("r.yaml", "title: T\n"), "out --reference r.yaml", f"{REFERENCES}: must "
                                     "have quantities"),
    "quantity of a road, without one": (text_of("r.yaml", "title: T\nquantities: {remove_m3: {levels: {a: 1}}}"),
                                        "one --reference r.yaml",
                                        "r.yaml: quantities: must be columns that all runs have"),
    "reference without variable": (text_of("r.yaml", "title: T\nquantities: {front_m: {series: {a: {0: 1}}}}"),
                                   "out --reference r.yaml", f"{REFERENCES}: quantities: front_m: must have "
                                   "levels: {NAME: VALUE}, or variable and series: {NAME: {X: VALUE}}, or both"),
    "no convergence": (lambda: None, "out --converge none", "--converge: must be a converge.yaml of `slope "),
    "section of nan": (lambda: None, "one --section 1 2 3 nan", "--section: must be X1 Y1 X2 Y2 (finite numbers, "),
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
    assert "<h1>one</h1>" in page and "Map of the slip surface" not in page


def test_cells_that_reach_beyond_the_terrain(slope, here):
    write_case(here / "case")
    subprocess.run([LMP, "-in", "in.tiny", "-var", "cell", "0.7", "-var", "steps", "20", "-screen", "none"],
                   cwd=here / "case", check=True)
    about = yaml.safe_load((here / "case" / "tiny.summary.yaml").read_text())
    assert about["grid"]["extent"] == pytest.approx([0, 40.6, 0, 24.5])       # the terrain: 40 x 24
    status, _, err = slope("case")
    assert (status, err) == (0, "")


@pytest.mark.parametrize("command", examples("report"))
def test_every_example_of_the_page_and_the_help_runs(slope, here, command):
    if "--pdf" in command and not printing.browser():
        pytest.skip("no browser that prints")
    Path("thalweg.geojson").write_text('{"type": "LineString", "coordinates": %s}' % BENT)
    Path("sizes").mkdir()
    write_converge("sizes/converge.yaml")
    Path("reference.yaml").write_text(REFERENCE)
    status, _, err = slope(command)
    assert (status, err) == (0, "")
