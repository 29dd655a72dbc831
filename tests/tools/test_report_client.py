"""The first page of a report, for a client: no words of the tools, the number or why there is none, counted caveats."""
import html
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

import test_report
from test_report import stands

from slope_tools import digits
from slope_tools.ensembles import known_study
from slope_tools.plots.obstacles import Obstacles
from slope_tools.report import body, caveats, client_part, warnings
from slope_tools.report.numbers import Numbers
from slope_tools.statistics.withheld import Kind as Rule
from slope_tools.tables import next_step
from slope_tools.warned import Warned, warned

made, here, slope = test_report.made, test_report.here, test_report.slope       # its fixtures
# of options, files, runs and variables
TOOLS_WORDS = re.compile(r"--\w|\.yaml|\.csv|\.asc|slope |rolling_|_steps|xoffset|seed|\bm3\b|<code>")


def client(path):
    """The text of the first page, without its picture and style."""
    page = path.read_text(encoding="utf-8")
    part = page[page.index('<section id="client">'):page.index('id="appendix"')]
    part = re.sub(r'(<div class="step">.*?)<code>[^<]*</code>', r"\1", part)       # the command of the next step
    return html.unescape(re.sub(r"<[^>]*>", " ", part))


@pytest.mark.parametrize("folder", ["out", "repeated", "one"])
def test_the_first_page_has_no_words_of_the_tools(slope, here, folder):
    assert slope(f"{folder} --name Slope")[0] == 0
    text = client(here / folder / "report.html")
    assert not TOOLS_WORDS.search(text), TOOLS_WORDS.search(text)[0]
    page = (here / folder / "report.html").read_text(encoding="utf-8")
    first = page[:page.index('id="appendix"')]
    assert 1 <= first.count('class="caveat"') <= 3 and first.count("<figure") == 1
    assert "bulk density is 1,786 kg/m³" in text         # 3411.4 kg/m3 x pi/6


def test_number_and_band_are_those_of_the_study(slope, here):
    stands("repeated")
    best = yaml.safe_load((here / "repeated" / "study.yaml").read_text())["conservative"]["rounded"]
    assert slope("repeated")[0] == 0
    text = client(here / "repeated" / "report.html")
    assert f"{best['volume_m3']:,.6g}" in text
    low, high = re.search(r"Another run gives ([\d,.]+) to ([\d,.]+) m³", text).groups()
    assert float(high.replace(",", "")) == pytest.approx(best["mean_m3"] + best["chance_m3"])
    assert float(low.replace(",", "")) == pytest.approx(max(0, best["mean_m3"] - best["chance_m3"]))
    stands("out")
    assert slope("out")[0] == 0
    text = client(here / "out" / "report.html")
    assert "No band: no run was repeated" in text and "No run was repeated: how much chance" in text


def test_a_number_that_is_withheld_gives_way_to_its_reasons(slope, here):
    path = here / "out" / "study.yaml"
    about = yaml.safe_load(path.read_text())
    best = about["conservative"]
    best.update(withheld=[{"kind": "balls on the road", "number": 3.0, "bound": 10, "text": "on the road lie 3 balls",
                           "remedy": "slope study --set d=1"}], volume_m3=None)
    best["rounded"]["volume_m3"] = None
    path.write_text(yaml.safe_dump(about))
    assert slope("out")[0] == 0
    text = client(here / "out" / "report.html")
    assert "Not usable as a conservative volume" in text and "On the road lie 3 balls." in text
    assert not TOOLS_WORDS.search(text) and "slope study --set d=1" in (here / "out" / "report.html").read_text()


ROAD = {"near_m": 2400.0, "far_m": 2412.0, "reached": [0.2, 0.3], "passed": [0.18, 0.27], "longest_m": 1846.0}
BEYOND = {"code": "known beyond runs", "numbers": {"far": 0.12, "longest_m": 2300.0}}
TERRAIN = {"code": "terrain ends", "numbers": {"share": 0.08, "path_m": 3600.0}}
MISSED = {"code": "road not reached", "numbers": {"low": 0.2, "high": 0.3, "near_m": 2400.0, "longest_m": 1846.0}}
MOVING = {"code": "rule", "numbers": {"source": "paper", "rule": "runs not at rest or failed", "number": 6, "bound": 6}}


def headline_of(kind, **more):
    """An entry of study.yaml as statistics.answer writes it."""
    return {"kind": kind, "volume_m3": None, "share": None, "low_m3": None, "high_m3": None, "source": None,
            "paper": {"volume_m3": None, "withheld": []}, "ensemble": {"volume_m3": None, "far": 0.03, "withheld": []},
            "road": ROAD, "reasons": [], **more}


HEADLINES = {
    "number": headline_of("number", volume_m3=35812.0, share=0.95, low_m3=21040.0, high_m3=48230.0, source="ensemble",
                          paper={"volume_m3": 1200.0, "withheld": []}),
    "floor": headline_of("floor", volume_m3=12012.0, share=0.9, low_m3=9000.0, source="ensemble",
                         reasons=[BEYOND, TERRAIN]),
    "not reached": headline_of("floor", volume_m3=0.0, share=0.7, source="ensemble", reasons=[MISSED, TERRAIN]),
    "withheld": headline_of("withheld", reasons=[MOVING]),
    "nothing": headline_of("nothing", volume_m3=0.0, share=0.95, source="ensemble",
                           road={**ROAD, "reached": [0.02, 0.07]})}
SAID = {"number": ("35,800 m³", "Between 21,000 m³ and 48,200 m³, with 90 % confidence.", "gives 1,200 m³"),
        "floor": ("at least 12,000 m³", "90 % of known events of this volume and height stay within 12,000 m³",
                  "12 % of known events of this volume and height go farther than the longest run, which ends after "
                  "2,300 m.", "Next step: a larger elevation model"),
        "not reached": ("20 % to 30 % of known events reach it", "More than 0 m³", "the longest run ends after 1,846 m",
                        "Next step: a larger elevation model"),
        "withheld": ("Volume to remove from the road: not usable:", "had not come to rest",
                     "Next step: more time for the mass to come to rest, about"),
        "nothing": ("0 m³", "2 % to 7 % of known events of this volume and height reach the road.")}


@pytest.mark.parametrize("case", HEADLINES)
def test_what_stands_first(slope, here, case):
    """A number, a floor, one that is withheld, nothing: never only that it is unknown, each number with its unit."""
    path = here / "repeated" / "study.yaml"
    path.write_text(yaml.safe_dump({**yaml.safe_load(path.read_text()), "headline": HEADLINES[case]}))
    assert slope("repeated")[0] == 0
    text = " ".join(client(here / "repeated" / "report.html").split())
    for words in SAID[case]:
        assert words in text
    page = (here / "repeated" / "report.html").read_text(encoding="utf-8")
    main = page[page.index('<div class="main'):page.index('<div class="note">')]
    assert not TOOLS_WORDS.search(text) and "unknown" not in main and "?" not in main
    assert ("Next step" in text) == (case in ("floor", "not reached", "withheld"))
    kind = HEADLINES[case]["kind"]
    assert f'<div class="main{" " + kind if kind != "number" else ""}">' in page
    if case in ("floor", "not reached"):
        assert "<code>tools/slope study in.tiny ... --anew</code>" in page
    if case == "withheld":
        remedy, = (one["remedy"] for one in yaml.safe_load(path.read_text())["conservative"]["withheld"])
        assert f"<code>{html.escape(remedy)}</code>" in page


def test_the_next_step_and_its_time(tmp_path):
    """By the first reason that something can be done about; as long as the runs took, several at a time."""
    design = {"points": 64, "variables": {"friction": "2:30", "rolling": "uniform:0:0.15", "slip": "list:a,b"}}
    rows = [{"status": "finished", "wall_s": 60.0} for _ in range(20)]
    made_ = next_step.Made({"study": {"jobs": 2, "deck": "in.tiny"}, "conservative": None, "runs": rows, "ensemble": {
        "design": design, "known_events": {"set": "rock_avalanches.csv"}}}, Path("site/ensemble"))

    def step(*codes, of=made_):
        return next_step.of_reasons(of, {"reasons": [{"code": code, "numbers": numbers} for code, numbers in codes]})

    beyond = ("known beyond runs", BEYOND["numbers"])
    found = step(beyond, ("no more runs", {"points": 32}))
    assert found.seconds == 600 and found.text == "more runs" and found.time.startswith(", about 10 minutes")
    assert found.command == ("tools/slope study in.tiny -o site/ensemble --sample 128 --known rock_avalanches --vary "
                             "friction=2:30 --vary rolling=uniform:0:0.15 --vary slip=list:a,b")
    assert step(beyond).command == found.command
    assert "--sample 64 " in step(("range ends", {"ends": "friction 2"})).command
    assert "--vary friction=1:30 --vary rolling=0:0.15 --vary slip=list:a,b" in step(("range ends", {})).command
    assert next_step.times(made_, Rule.BALLS, {"number": 0.0045, "bound": 10}) == pytest.approx(600 * 10 ** (4 / 3))
    (tmp_path / "site.yaml").touch()
    assert step(("terrain ends", TERRAIN["numbers"]), of=made_._replace(folder=tmp_path / "ensemble")).command.endswith(
        f"{tmp_path}/site.yaml, then: tools/slope site {tmp_path} && tools/slope study {tmp_path} --anew")
    rows[0]["wall_s"] = None
    assert step(("too few runs", {})).time == ""


def test_only_a_report_on_the_same_folder_is_replaced(slope, here):
    """In the folder itself any report is, as that may have moved; files of the user's only with --overwrite."""
    assert slope("one -o page.html")[0] == slope("one -o page.html")[0] == 0
    page = (here / "page.html").read_bytes()
    status, out, err = slope("repeated -o page.html")
    assert (status, out, err) == (2, "", "slope report: -o: page.html must be the result of slope report repeated "
                                         "to be replaced: give another name, or --overwrite\n")
    assert (here / "page.html").read_bytes() == page
    assert slope("repeated -o page.html --overwrite")[0] == 0
    assert slope("one")[0] == 0
    (here / "one").rename(here / "two")
    assert slope("two")[0] == 0
    for name in ("two/report.html", "mine.section.csv"):
        (here / name).write_text("of the user\n")
    assert "-o: two/report.html must be the result of slope report two" in slope("two")[2]
    assert "-o: mine.section.csv must be the result of slope report two" in slope("two -o mine.html")[2]


def test_without_a_road_the_reach_is_the_number(slope, here):
    assert slope("one")[0] == 0
    text = client(here / "one" / "report.html")
    assert re.search(r"99 % of the volume stays within\s+[\d.]+\s+m\s+One run: no band", text)


# --- caveats ---

def study_of(masses, **more):
    """What caveats() takes of a study, of (lost m3, released m3) of each run."""
    finished = [{"off_grid_m3": 0.0, "lost_m3": lost, "released_m3": released} for lost, released in masses]
    found = {"study": {"conservative": None, "warnings": []}, "rows": finished, "finished": finished, "repeats": {},
             "ends": lambda: [], "warnings": lambda: [], "releases": lambda: [], "below_ground": lambda: None,
             "largest_release": lambda: max(released for _, released in masses),
             "result": SimpleNamespace(summary={"volume": {"released": masses[0][1]}, "balls": {"released": 1000}})}
    return SimpleNamespace(**{**found, **more})


def ground_of(*touched, crs="EPSG:6677"):
    """A ground whose edges were reached at these rows and columns."""
    z = np.zeros((5, 6))
    for row, column, value in touched:
        z[row, column] = value
    return SimpleNamespace(max_thickness=z, raster=SimpleNamespace(crs=crs), obstacles=Obstacles({}, {}))


def test_what_was_lost_is_counted_in_one_line_with_its_side():
    rows = [(0.0, 50000.0)] * 6 + [(6000.0 - 10 * k, 50000.0) for k in range(9)]
    found = caveats.lost(study_of(rows), ground_of((4, 2, 3.0), (2, 0, 2.5)))
    assert found.text == ("9 of 15 runs lost up to 6,000 m³ over the edge: enlarge the terrain to the south-west.")
    assert found.order == caveats.LOST_MUCH
    little = caveats.lost(study_of([(1.0, 50000.0)]), ground_of((4, 2, 3.0), (2, 0, 0.5)))
    assert little.text == "The run lost 1.00 m³ over the edge: enlarge the terrain to the south."
    assert little.order == caveats.LOST
    assert caveats.lost(study_of([(0.0, 5.0)]), ground_of()) is None
    assert caveats.lost(study_of([(2.0, 5.0)]), ground_of((2, 5, 1), crs=None)).text.endswith(
        "enlarge the terrain beyond the right edge of the map.")
    assert caveats.side_of(ground_of((0, 2, 1), (4, 2, 1))) == "to the north and the south"


def test_the_weightiest_come_first_and_three_are_shown():
    rows = [(6000.0, 2e6)] * 4
    data = study_of(rows, rows=[*study_of(rows).finished, {}],
                    warnings=lambda: [Warned("thin", {"balls": 1.83, "limit": 3.0})],
                    ends=lambda: [SimpleNamespace(at_rest=k > 1, moving=k == 0) for k in range(4)])
    found = caveats.caveats(data, ground_of())
    assert [one.order for one in found] == sorted(one.order for one in found)
    told, rest = caveats.shown(found, 7)
    assert told == ["1 of 5 runs failed and are not in the numbers.",
                    "1 of 4 runs ended with more than a tenth of the mass in motion: the numbers are not those of a "
                    "deposit.",
                    "Masses of 1 million m³ and more are known to run farther than laboratory friction suggests: "
                    "the reach is not conservative unless a past event was used to calibrate it."]
    assert rest == "The appendix has all 7 warnings, the settings, the runs and the checks."
    assert any("only 1.8 of the model's balls" in one.text for one in found)


def test_runs_of_several_sizes_are_one_line():
    sizes = [Warned("lost", {"volume": volume}, (f"rolling_0_d_{volume:g}",), "sizes of balls")
             for volume in (4.21, 337.0)]
    several = [sizes[0], warned("the slope is steep"), sizes[1], warned("the toe is wet"), Warned("moving", {})]
    data = SimpleNamespace(rows=[], finished=[], warnings=lambda: several)
    assert warnings.of_study(data) == [("red", text) for text in (
        "sizes of balls: 4.21 m3 left the grid or the box (2 runs, other numbers in the others)", "the slope is steep",
        "the toe is wet")]
    del several[2:]
    assert warnings.of_study(data)[0] == ("red", "sizes of balls: 4.21 m3 left the grid or the box")


def test_a_warning_survives_its_file():
    """Also one of another version, of which the text counts, and a plain line of an older one."""
    one = Warned("lost", {"volume": 12345.678}, ("a", "b"), "sizes of balls")
    assert str(one) == "a, b: sizes of balls: 12,346 m3 left the grid or the box"
    assert warned(yaml.safe_load(yaml.safe_dump(one.entry()))) == one
    newer = {"kind": "of tomorrow", "text": "it rains", "numbers": {"mm": 3}}
    assert str(warned(newer)) == str(warned("it rains")) == "it rains"
    assert str(warned({"kind": "lost", "text": "12 m3 left"})) == "12 m3 left"


def test_a_structure_of_few_balls_is_a_caveat():
    """Its height is that above the ground, wherever that lies."""
    wall = np.array([[[2, 2, 95.0], [2, 8, 95], [2, 8, 112]]])
    ground = SimpleNamespace(before=None, along=lambda _, x, y: np.full(len(x), 100.0), obstacles=Obstacles(
        {"dam": wall}, {}))
    summary = {"volume": {"released": 64.0e3}, "balls": {"released": 1000}}
    data = SimpleNamespace(result=SimpleNamespace(summary=summary))
    assert caveats.coarse(data, ground).text == ("dam is 3 of the model's balls high: the forces on it are those of "
                                                 "single balls, and rough.")
    summary["balls"]["released"] = 8000
    assert caveats.coarse(data, ground) is None


def test_a_mean_has_the_digits_that_its_scatter_leaves():
    found = Numbers()
    assert found.mean("x", "m", 448724.0, 84123.0, "") == "449,000 ± 84,000"
    assert found.mean("x", "m", 1471.3, 1.234, "") == "1,471 ± 1"
    assert found.mean("x", "m", 2787.6, 96.8, "") == "2,788 ± 97" and found.mean("x", "m", 5.126, None, "") == "5.13"


# --- words ---

@pytest.mark.parametrize("value, unit, text", [
    (1.63e10, "N", "16.3 GN"), (6e9, "J", "6.00 GJ"), (999.6e3, "N", "1.00 MN"), (0.0, "N", "0 N"),
    (0.5, "Pa", "0.500 Pa"),
    (290e6, "Pa", "290 MPa"), (12.34, "kg", "12.3 kg"), (5e15, "J", "5,000 TJ")])
def test_si(value, unit, text):
    assert digits.si(value, unit) == text


def test_volumes_and_units_as_they_are_read():
    assert [digits.cubic(value) for value in (0.0, 104.4, 6128.0, 119e6)] == [
        "0 m³", "104 m³", "6,130 m³", "119 million m³"]
    assert digits.typeset("5 m3 on 3 m2, 2 m30 of dam3") == "5 m³ on 3 m², 2 m30 of dam3"


def test_what_the_runs_differ_in_is_said_without_names_of_variables():
    data = SimpleNamespace(study={"study": {}}, repeats={"xoffset": ["0.5"]}, finished=[{}] * 8,
                           settings={"rolling": ["0", "1"], "d": ["1", "2"], "zeta": ["1", "2"], "x": ["1"]})
    assert client_part.basis(data) == (
        "8 runs of a computer model of equal balls, which differ in the rolling resistance, the size of the model's "
        "balls and 1 other setting and, by chance, in how the balls lie at the start.")
    data.study["study"]["method"] = "by the paper's method; no set of known events covers this volume, 900 m3"
    assert client_part.basis(data).endswith(
        "at the start. Known events of this size do not count in them: no set of known events covers this volume, "
        "900 m3.")
    for method in (known_study.WEIGHTED, known_study.BESIDE):
        data.study["study"]["method"] = method
        assert client_part.basis(data).endswith("at the start.")


def test_the_body_in_a_sentence():
    known = body.Body(14808.9, 3584.0, 8.0, 35.02, body.SHAPES["slbl"], 1786.2, "EPSG:6677", True, "release.geojson")
    assert body.sentence(known) == (
        "The body has 14,809 m³, is up to 8.00 m deep and covers 3,580 m² in plan, above a slip surface by the sloping "
        "local base level on ground of 35 degrees on average. Its bulk density is 1,786 kg/m³. Coordinates: EPSG:6677 "
        "(assigned).")
    assert body.sentence(body.Body(119e6, None, None, None, "a given slip surface", None, None, False, None)) == (
        "The body has 119 million m³, above a given slip surface. Coordinates: local metres.")
