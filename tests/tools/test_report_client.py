"""The first page of a report, for a client: no words of the tools, the number or why there is none, counted caveats."""
import html
import re
import string
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

import made_study
import test_report
from made_rows import changed, row
from test_report import stands

from slope_tools import digits, records
from slope_tools.finding_words import WORDS, words_of
from slope_tools.findings import LIMIT, NOTE, WARNING, Finding, finding, gathered
from slope_tools.plots.obstacles import Obstacles
from slope_tools.report import body, client_part, ensemble_part, limits_part, numbers, structures_part, warnings
from slope_tools.report.numbers import Numbers
from slope_tools.statistics.entries import Kind
from slope_tools.statistics.withheld import Kind as Rule
from slope_tools.studies import letter, outcome, size_runs
from slope_tools.tables import answer_words, how_far, judged, next_step, study_file

made, here, slope = test_report.made, test_report.here, test_report.slope       # its fixtures
# of options, files, runs and variables
TOOLS_WORDS = re.compile(r"--\w|\.yaml|\.csv|\.asc|tools/|slope (?:site|study|report)|rolling_|_steps|xoffset|seed|"
                         r"\bm3\b|<code>")


def client(path):
    """The text of the first page, without its picture and style."""
    page = path.read_text(encoding="utf-8")
    part = page[page.index('<section id="client">'):page.index('id="appendix"')]
    part = re.sub(r'<span class="before">[^<]*</span>', "", part)       # of the next step: what is to be changed
    part = re.sub(r'(<div class="step">.*?)<code>[^<]*</code>', r"\1", part)       # and its command
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


def test_the_number_is_that_of_the_study(slope, here):
    """Of balls of one size: that of the runs, which is no bound; no confidence without repeats."""
    stands("repeated")
    stands("out")
    for folder in ("repeated", "out"):
        about = yaml.safe_load((here / folder / "study.yaml").read_text())
        assert about["headline"]["kind"] == "open"
        assert slope(folder)[0] == 0
        text = client(here / folder / "report.html")
        number, = re.findall(r"([\d,.]+) m³ must be cleared", text)
        assert float(number.replace(",", "")) == pytest.approx(about["conservative"]["rounded"]["volume_m3"], rel=5e-3)
        assert "neither an upper nor a lower bound" in text and "90 %" not in text and "At least" not in text
        assert ("no run was repeated" in text) == (folder == "out")
    best = yaml.safe_load((here / "repeated" / "study.yaml").read_text())["conservative"]
    page = html.unescape((here / "repeated" / "report.html").read_text(encoding="utf-8"))
    again = re.search(r"gives ([\d,.]+) to ([\d,.]+) m³ to remove, in 95 %", page[page.index('<section id="limits"'):])
    assert [float(one.replace(",", "")) for one in again.groups()] == pytest.approx(
        [max(0, best["mean_m3"] - best["chance_m3"]), best["mean_m3"] + best["chance_m3"]], abs=best["place_m3"])


ROAD = {"near_m": 2400.0, "far_m": 2412.0, "reached": [0.2, 0.3], "passed": [0.18, 0.27], "longest_m": 1846.0,
        "brought": {"runs": 6, "reach": 0, "passing": 0, "volume": 0.0, "balls": 0.0}}
BEYOND = {"code": "known beyond runs", "numbers": {"far": 0.12, "longest_m": 2300.0, "most_m3": 15000.0, "runs": 24}}
TERRAIN = {"code": "terrain ends", "numbers": {"share": 0.08, "path_m": 3600.0}}
MISSED = {"code": "road not reached", "numbers": {"low": 0.2, "high": 0.3, "near_m": 2400.0, "longest_m": 1846.0}}
MOVING = {"code": "rule", "numbers": {"source": "paper", "rule": "runs not at rest or failed", "number": 6, "bound": 6}}


def headline_of(kind, **more):
    """An entry of study.yaml as tables.headline writes it."""
    return {"kind": kind, "volume_m3": None, "share": None, "low_m3": None, "high_m3": None, "source": None,
            "paper": {"volume_m3": None, "withheld": [], "runs": 13},
            "ensemble": {"volume_m3": None, "far": 0.03, "withheld": [], "runs": 24},
            "road": ROAD, "reasons": [], "band": [], **more}


HEADLINES = {
    "number": headline_of("number", volume_m3=35812.0, share=0.95, low_m3=21040.0, high_m3=48230.0, source="ensemble",
                          paper={"volume_m3": 1200.0, "withheld": [], "runs": 13}, band=[
                              {"cause": "chance and parameters", "below_m3": 14000.0, "above_m3": 12000.0},
                              {"cause": "finer balls", "below_m3": 400.0, "above_m3": 0.0}]),
    "within": headline_of("number", volume_m3=12012.0, share=0.88, low_m3=9000.0, high_m3=15000.0, source="ensemble",
                          reasons=[BEYOND]),
    "floor": headline_of("floor", volume_m3=12012.0, share=0.9, low_m3=9000.0, source="ensemble",
                         reasons=[BEYOND, TERRAIN]),
    "not reached": headline_of("floor", volume_m3=0.0, share=0.7, source="ensemble", reasons=[MISSED, TERRAIN]),
    "withheld": headline_of("withheld", reasons=[MOVING]),
    "nothing": headline_of("nothing", volume_m3=0.0, share=0.95, source="ensemble",
                           road={**ROAD, "reached": [0.02, 0.07]})}
HEADLINES["open"] = {**HEADLINES["floor"], "kind": "open", "low_m3": None, "reasons": [
    {"code": "size of balls", "numbers": {"sizes": 1, "grown": None}}]}
SAID = {"number": ("35,800 m³ must be cleared from the road; within the model this figure lies with 90 % "
                   "confidence between 21,000 and 48,200 m³. That is what lies on it, and what beside it would slide "
                   "onto it, above 30 degrees from its edges.", "; 3 % go beyond all runs and may leave more than any "
                   "of these; ", " of this volume and height leave no more, by 24 runs ",
                   "13 runs with chosen settings give 1,200 m³. The band, as the root of the squares: chance and "
                   "parameters -14,000 +12,000 m³, a still more detailed model -400 m³."),
        "within": ("12,000 m³ must be cleared", "between 9,000 and 15,000 m³", "88 % of known events",
                   "What would change it: 12 % of known events of this volume and height go farther than all 24 runs "
                   "that they weigh, and may leave more; of these runs the largest leaves 15,000 m³ to remove."),
        "floor": ("At least 12,000 m³", "It is the lower end, with 90 % confidence, of what 90 % of known events",
                  "Why: 12 % of known events of this volume and height go farther", "Next step: a larger "
                  "elevation model"),
        "open": ("12,000 m³ must be cleared from the road by these runs, which is neither an upper nor a lower "
                 "bound",
                 "Why: What a finer model would change is not known: this one has one size", "Next step: a finer "
                 "model"),
        "not reached": ("More than 0 m³ must be cleared from the road, where the mass reaches it",
                        "The road begins after 2,400 m: 20 % to 30 % of known events of this volume and height, and "
                        "none of 6 runs of both kinds, reach it.", "Next step: a larger elevation model"),
        "withheld": ("come down, up to", "How far it goes is not known: ", "The road begins",
                     "How much must be cleared from the road is not known. More than a tenth of the runs failed, or "
                     "had not come to rest when they ended (runs with chosen settings).",
                     "Next step: more time for the mass to come to rest, about"),
        "nothing": ("0 m³ must be cleared from the road, by these runs: in none does anything come to lie on it.",
                    "2 % to 7 % of known events of this volume and height, and none of 6 runs of both kinds, reach "
                    "it.")}


@pytest.mark.parametrize("case", HEADLINES)
def test_what_stands_first(slope, here, case):
    """A number, a floor, one that is withheld, nothing: never only that it is unknown, each number with its unit."""
    path = here / "repeated" / "study.yaml"
    about = yaml.safe_load(path.read_text())
    number = made_study.headline(**HEADLINES[case])
    study = replace(study_file.load_study(path), headline=number)
    step = next_step.of_studies([next_step.Made(study, path.parent)], number)
    about["reach"]["cut"] *= case == "withheld"         # the runs are cut short
    path.write_text(yaml.safe_dump({**about, "headline": HEADLINES[case],
                                    "next_step": step and records.encode_record(step)}))
    assert slope("repeated")[0] == 0
    text = " ".join(client(here / "repeated" / "report.html").split())
    for words in SAID[case]:
        assert words in text
    page = (here / "repeated" / "report.html").read_text(encoding="utf-8")
    main = page[page.index('<div class="main'):page.index("Not in it")]
    assert not TOOLS_WORDS.search(text) and "unknown" not in main and "?" not in main
    # no words of the model but in the last sentence, and one distance in one sentence
    assert not re.search(r"balls?\b|levels?\b|ensemble|sweep", text[:text.index("Computed with")])
    assert text.count("It goes") == text.count("from the crown") == (case != "withheld")
    assert ("Next step" in text) == (case in ("floor", "open", "not reached", "withheld"))
    kind = HEADLINES[case]["kind"]
    assert f'<div class="main{" " + kind if kind != "number" else ""}">' in page
    if case in ("floor", "not reached"):
        assert "the same command with --anew" in page and "tools/slope study in.tiny" not in page
    if case == "withheld":
        remedy, = (one["remedy"] for one in yaml.safe_load(path.read_text())["conservative"]["withheld"])
        assert f"<code>{html.escape(remedy)}</code>" in page


def weighted(quantities=None, reached=0.9, gap=None, header=None, **entries):
    """The data of a study of three runs that known events weigh."""
    rows = [row(run=name, distance_99_m=far, remove_on_road_m3=on, blocked_m=40.0, beyond_road_m3=0.0)
            for name, far, on in (("a", 200.0, 0.0), ("b", 300.0, 19600.0), ("c", 900.0, 300.0))]
    known = {"reached": reached, "quantities": {
        key: {"quantiles": [{"share": 0.95, "value": value}]} for key, value in (quantities or {}).items()},
        "to_remove": [{"share": 0.95, "value": 9e3, "low": 0.0, "high": None, "gap": gap}]}
    return SimpleNamespace(finished=rows, compared=rows, road=True,
                           study=made_study.study(header, ensemble=made_study.ensemble(known), **entries))


MAP = {"raster": "thickness", "threshold": 0.1}


@pytest.mark.parametrize("study, runs, whom, file", [
    ({"maps": [{**MAP, "file": "own"}], "known_events": {"reached": 0.9, "far": 0.07, "maps": [
        {**MAP, "file": "5", "threshold": 0.5}, {**MAP, "file": "a"}, {"raster": "thickness", "quantile": 0.9},
        {"raster": "max_speed", "threshold": 0.01, "file": "speed"}, {**MAP, "threshold": 0.0, "file": "any"}]}}, 64,
     "known events", "a"),
    ({"maps": [{**MAP, "file": "own"}], "known_events": {"reached": None, "maps": []}}, 64, "runs", "own"),
    ({"maps": [{**MAP, "file": "own"}]}, 20, "runs", "own"), ({"maps": [{**MAP, "file": "own"}]}, 19, None, None),
    ({"maps": []}, 64, None, None), (None, 64, None, None)])
def test_the_map_has_the_outlines_of_an_ensemble(study, runs, whom, file):
    """Of known events where these weigh it; none where 5 % of the runs are no run."""
    about = study and made_study.ensemble(study.get("known_events"), maps=study["maps"])
    data = SimpleNamespace(finished=[{}] * runs, study=made_study.study(ensemble=about), read_map=lambda name: name)
    found = ensemble_part.exceeded(data)
    assert (found and found.whom, found and found.share) == (whom, file)
    assert found is None or found.far == (0.07 if whom == "known events" else 0.0)
    assert found is None or found.thick == 0.1


def test_what_lies_on_the_road_is_of_the_runs_of_the_page():
    """From the least to the most, of which the caption says that each counts alike."""
    found = dict(client_part.on_road(weighted({"remove_on_road_m3": 5230.0}), Numbers()))
    assert found == {"on the road itself": "0 to 19,600 m3", "length of it that is blocked": "40.0 m"}


@pytest.mark.parametrize("gap, source, said", [([2e3, 9e3], "ensemble", True), (None, "ensemble", False),
                                               ([2e3, 9e3], "paper", False)])
def test_the_number_says_that_it_is_in_a_gap(gap, source, said):
    about = replace(weighted(gap=gap).study, runs=[row()], headline=made_study.headline(
        source=source, share=0.95, volume_m3=9e3, low_m3=1e3, high_m3=9e4))
    text = letter.write_letter(letter.make_letter(about)).basis
    assert ("between 2,000 and 9,000 m3" in text) == said and ("no run ends" in text) == said


@pytest.mark.parametrize("warnings", [[], [{"kind": "road on body", "numbers": {"file": "a", "part": "", "Part": ""}}]])
def test_a_road_that_goes_with_the_mass_is_in_the_letter(warnings):
    text = letter.write_letter(letter.make_letter(made_study.study(runs=[row()], warnings=warnings))).lacks
    assert ("; what it takes to build the road anew" in text) == bool(warnings)


def test_what_known_events_weigh_is_not_said_of_drawn_settings():
    """Without a road the letter says how far, by these events, and not what most of the runs stay within; and a length
    of the runs with chosen settings is theirs."""
    quantities = {"length_m": {"name": "length", "unit": "m", "mean": 90.0, "standard_deviation": 1.0, "smallest": 80.0,
                               "largest": 99.0, "quantiles": [
                                   {"share": 0.9, "value": 95.0, "low": None, "high": 99.0}]}}
    for reached in (0.95, None):
        about = made_study.study(runs=[row()], reach=how_far.pool([60.0, 70.0], None, "paper"), ensemble=(
            made_study.ensemble({"reached": reached}, of="length_m", quantities=quantities)))
        found = letter.write_letter(letter.make_letter(about))
        assert found.clear == ("" if reached else "Length: 90 % of the 64 runs with drawn settings stay within 95.0 m, "
                               "with 90 % confidence at most 99.0 m."), found.clear
        assert "By 2 runs with chosen settings" in found.far


def test_the_next_step_and_its_time(tmp_path):
    """By the first reason that something can be done about; as long as the runs took, several at a time."""
    design = {"points": 64, "variables": {"friction": "2:30", "rolling": "uniform:0:0.15", "slip": "list:a,b"}}
    rows = [row(wall_s=60.0) for _ in range(20)]
    whole = made_study.ensemble({"set": "rock_avalanches.csv"}, design=design)
    made_ = next_step.Made(made_study.study({"jobs": 2, "deck": "in.tiny"}, runs=rows, ensemble=whole),
                           Path("site/ensemble"))

    def step(*codes, of=made_):
        return next_step.of_studies([of], made_study.headline(kind="floor", source="ensemble", reasons=[
            {"code": code, "numbers": numbers} for code, numbers in codes]))

    beyond = ("known beyond runs", BEYOND["numbers"])
    found = step(beyond, ("no more runs", {"points": 32}))
    assert found.seconds == 600 and found.text == "more runs" and found.time.startswith(", about 10 minutes")
    assert found.command == ("tools/slope study in.tiny -o site/ensemble --sample 128 --known rock_avalanches --vary "
                             "friction=2:30 --vary rolling=uniform:0:0.15 --vary slip=list:a,b")
    assert step(beyond).command == found.command
    assert "--sample 64 " in step(("range ends", {"ends": {"friction": "2"}})).command
    wider = step(("range ends", {"ends": {}})).command
    assert "--vary friction=1:30 --vary rolling=0:0.15 --vary slip=list:a,b" in wider
    assert next_step.times(made_, Rule.BALLS, {"number": 0.0045, "bound": 10}) == pytest.approx(600 * 11 ** (4 / 3))
    (tmp_path / "site.yaml").touch()
    assert step(("terrain ends", TERRAIN["numbers"]), of=made_._replace(folder=tmp_path / "ensemble")).command.endswith(
        f"{tmp_path}/site.yaml, then: tools/slope site {tmp_path} && tools/slope study {tmp_path} --anew")
    study = replace(made_.study, runs=[row(wall_s=None), *rows])
    assert step(("too few runs", {}), of=made_._replace(study=study)).time == ""


def test_the_next_step_is_of_the_study_whose_reason_comes_first(tmp_path):
    """Of both of a site, which one command makes: its remedy, and the time of both."""
    (tmp_path / "site.yaml").touch()
    rows = [row(wall_s=30.0, released_m3=100.0)] * 4
    mends = f"more time (model.duration) in {tmp_path}/site.yaml, then: tools/slope site {tmp_path} && ..."
    paper = made_study.study({"jobs": 1}, conservative=made_study.conservative(9.0), runs=rows)
    withheld = [Finding("runs not at rest or failed", {"number": 6, "bound": 20, "most": 10.0}, remedy=mends)]
    ensemble = made_study.study({"jobs": 2}, runs=rows, ensemble=made_study.ensemble(withheld=withheld))
    both = [next_step.Made(paper, tmp_path / "study"), next_step.Made(ensemble, tmp_path / "ensemble")]
    size = {"code": "size of balls", "numbers": {"sizes": 3, "grown": 0.3}}
    rule = {"code": "rule", "numbers": {"source": "ensemble", "rule": "runs not at rest or failed", "number": 6}}
    about = made_study.headline(kind="floor", volume_m3=9.0, source="paper", reasons=[rule, size])
    step = next_step.of_studies(both, about)
    assert (step.command, step.seconds) == (mends, 2 * (120 + 60)) and step.line.startswith("tools/slope site")
    assert step.before.endswith("/site.yaml, then:")
    step = next_step.of_studies(both, about._replace(reasons=about.reasons[::-1]))
    assert step.command == f"tools/slope study {tmp_path} --levels 4" and step.before == ""
    assert next_step.of_studies(both, about._replace(kind=Kind.NUMBER)) is None


def test_each_reason_is_told_once():
    """Of both studies; the console and the first page, in the same order."""
    other = {**MOVING, "numbers": {**MOVING["numbers"], "source": "ensemble"}}
    size = {"code": "size of balls", "numbers": {"sizes": 1, "grown": None}}
    about = made_study.headline(**headline_of("withheld", reasons=[other, size, MOVING, size]))
    said = [answer_words.client(one) for one in answer_words.told(about)]
    assert len(said) == 2 and said[0].startswith("More than a tenth of the runs failed")
    assert all(letter.describe_change(about).lower().count(text.lower()) == 1 for text in said)


def test_the_first_page_in_order(slope, here):
    """What comes down, what must be cleared, of which runs, how far, why, what is not in it, the size of the balls as
    the last sentence; then the next step, the map of the run, a table."""
    stands("repeated")
    path = here / "repeated" / "study.yaml"
    about = yaml.safe_load(path.read_text())
    step = {"text": "a larger elevation model", "command": "more in mine/site.yaml, then: tools/slope site mine",
            "seconds": 60.0}
    size = {"code": "size of balls", "numbers": {"sizes": 3, "grown": 0.31}}
    about["reach"]["cut"] = 0
    path.write_text(yaml.safe_dump({**about, "next_step": step, "headline": headline_of(
        "floor", volume_m3=12.0, source="paper", ensemble=None, reasons=[size])}))
    assert slope("repeated")[0] == 0
    text = " ".join(client(here / "repeated" / "report.html").split())
    wanted = ["come down", "At least 12.0 m³ must be cleared", "of what those of 13 runs with chosen settings",
              "It goes",
              "count half each", "The road begins", "raised the volume by 31 %", "Not in it: water", "Computed with",
              "Next step: a larger elevation model, about 60 s", "Final thickness", "A run that leaves about as much",
              "on the road itself", "The appendix has"]
    places = [text.find(words) for words in wanted]
    assert -1 not in places and places == sorted(places), (places, text)
    page = (here / "repeated" / "report.html").read_text()
    assert '<span class="before">more in mine/site.yaml, then:</span><br><code>tools/slope site mine</code>' in page


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
    """Of a run at its rest."""
    assert slope("one")[0] == 0
    text = client(here / "one" / "report.html")
    assert "How far it goes is not known: 1 of 1 run had not come to rest at the end." in " ".join(text.split())
    path, = (here / "one").glob("*.summary.yaml")
    summary = yaml.safe_load(path.read_text())
    summary["stop"]["reason"], summary["motion"]["fast_share"] = "halted", 0.0
    path.write_text(yaml.safe_dump(summary))
    assert slope("one")[0] == 0
    text = client(here / "one" / "report.html")
    assert re.search(r"It goes about [\d.]+ m \([^)]*\) along the fall path from the crown", text)
    assert "1 run and known events" in text and "cleared" not in text


# --- caveats ---

RELEASE = {"released": 50000.0, "body": 50000.0, "factor": 1.91, "from_cubic": 0.0, "removed": None, "packed": False}


def rows_of(*masses, **more):
    """The rows of runs that finished, of (lost m3, released m3) of each."""
    return [row(**{"run": f"run {k}", "lost_m3": lost, "released_m3": released, "release": RELEASE, **more})
            for k, (lost, released) in enumerate(masses)]


def data_of(rows, **more):
    """What the findings are made of, of a study."""
    names = {one.run: one.run for one in rows}
    result = SimpleNamespace(summary={"volume": {"released": 50000.0}, "balls": {"released": 1000}})
    return SimpleNamespace(**{"study": made_study.study(), "judged": rows, "repeats": {},
                              "below_ground": lambda: None, "names": lambda: names, "result": result, **more})


GROUND = SimpleNamespace(obstacles=Obstacles({}, {}))
LEFT = [{"side": "south", "volume": 5000.0, "balls": 50, "where": "before", "distance": 120.4, "add": 170.0},
        {"side": "west", "volume": 900.0, "balls": 9, "where": "past", "distance": 20.0, "add": 1230.0},
        {"side": "south", "volume": 80.0, "balls": 1, "where": "on", "distance": 0.0, "add": 60.0},
        {"side": "a hole", "volume": 20.0, "balls": 1, "where": "past its end", "distance": 8.0, "add": None}]


def test_what_was_lost_is_counted_in_one_line_with_its_side():
    rows = rows_of(*[(0.0, 50000.0)] * 6, *[(6000.0 - 10 * k, 50000.0) for k in range(9)])
    found, = judged.lost(rows)
    assert (found.kind, found.level, found.runs[0], len(found.runs)) == ("lost much", WARNING, "run 6", 9)
    assert found.numbers["volume"] == 6000 and found.numbers["percent"] == 12 and found.numbers["of"] == 15
    assert warnings.first_page([found]) == [
        "9 of 15 runs lost mass over the edge, up to 6,000 m³: enlarge the terrain."]
    rows[6] = changed(rows[6], left=LEFT)
    found, = judged.lost(rows)
    assert found.text == (
        "up to 6,000 m3 (12 % of the released volume) left the grid or the box and are not on the maps (5,000 m3 in "
        "the south, 120 m before the road; 900 m3 in the west, 20 m beyond the road; 80 m3 in the south, on the road; "
        "20 m3 elsewhere), and how far they went is unknown: enlarge the terrain and the box by about 1,230 m in the "
        "west, about 170 m in the south, heights in the hole (slope terrain --fill)")
    assert warnings.first_page([found]) == [
        "9 of 15 runs lost mass over the edge, up to 6,000 m³: enlarge the terrain by about 1,230 m in the west, "
        "about 170 m in the south, heights in the hole (slope terrain --fill)."]
    found, = judged.lost(rows_of((1.0, 50000.0)))
    assert (found.kind, found.level) == ("lost", NOTE) and judged.lost(rows_of((0.01, 50000.0))) == []


def moved(rows, *shares):
    ends = [changed(one, at_rest=False, moving=share > 0.1, moves_share=share, end=f"{share} moves",
                    stop_reason="run completed") for one, share in zip(rows, shares)]
    return [*ends, *rows[len(ends):]]


def test_the_weightiest_come_first_and_three_are_shown():
    """Each kind once, whatever its runs."""
    rows = moved(rows_of(*[(6000.0, 2e6)] * 4), 0.2, 0.02, 0.05)
    rows.append(row(run="cut", status="failed", error="ERROR: 3 atoms lost"))
    rows.append(row(run="cut too", status="failed", error="ERROR: no memory"))
    thin = Finding("thin", {"balls": 1.83, "limit": 3.0})
    data = data_of(rows, study=made_study.study(warnings=[*judged.of_runs(rows), thin]))
    found = warnings.findings(data, GROUND)
    told = warnings.first_page(found)
    by_kind = {one.kind: one for one in found}
    assert by_kind["in motion"].runs == ("run 0",) and by_kind["moving"].runs == ("run 2", "run 1")
    assert by_kind["moving"].numbers["share"] == 0.05 and by_kind["moving"].numbers["differ"]
    assert told[0].startswith("2 of 6 runs failed") and told[1].startswith("1 of 4 runs ended")
    assert len(told) == 9
    assert "1 million" in told[2] and told[3].startswith("2 of 4 runs") and "coarse" in told[6]
    assert "All 4 runs lost mass over the edge, up to 6,000 m" in told[7] and told[8].startswith("The slip surface")
    levels = [level for level, _ in warnings.rank_warnings(found, data.names())]
    assert levels == sorted(levels, reverse=True) and levels.count(NOTE) == 3      # large, moving, lost
    assert warnings.rest_of(7) == "The appendix has all 7 warnings, the settings, the runs and the checks."


def test_what_no_run_tells_is_on_the_first_page_alone():
    rows = rows_of((0.0, 50000.0))
    found = warnings.findings(data_of(rows), GROUND)
    assert [one.kind for one in found] == ["no repeats", "no sizes", "slip assumed"]
    assert warnings.rank_warnings(found, {}) == [] and len(warnings.first_page(found)) == 3
    found = warnings.findings(data_of(rows, repeats={"seed": ["1"]}, study=made_study.study(
        conservative=made_study.conservative(1.0), size={})), GROUND)
    assert [one.kind for one in found] == ["slip assumed"]


@pytest.mark.parametrize("change, kind, numbers", [
    ({"from_cubic": 0.2, "factor": 2.29}, "bulk factor", {"off": "20 %", "side": "above"}),
    ({"from_cubic": -0.2, "factor": 1.53}, "bulk factor", {"off": "20 %", "side": "below"}),
    ({"from_cubic": -0.1273, "factor": 1.667, "packed": True}, None, {}),
    ({"from_cubic": 0.05, "factor": 2.0, "packed": True}, "bulk factor",
     {"off": "20 %", "side": "above", "usual": "1/0.60"}),
    ({"body": 60000.0}, "body volume", {"off": "17 %", "side": "less"}),
    ({"body": None, "removed": 0.3}, "balls removed", {"off": "30 %"}),
    ({"body": None, "removed": 0.1}, None, {})])
def test_a_release_that_is_not_the_body(change, kind, numbers):
    found = judged.released(rows_of((0.0, 50000.0), release={**RELEASE, **change}))
    assert [one.kind for one in found] == ([kind] if kind else [])
    for one in found:
        assert {**one.numbers, **numbers} == one.numbers and one.level == NOTE and one.runs == ("run 0",)
        assert "50,000 m" in one.client()


def test_soft_contacts_are_one_line_with_the_softest():
    """Runs of other versions, and those without a body, have no number, and are not judged."""
    rows = [changed(one, stiffness_number=number) for one, number in zip(
        rows_of(*[(0.0, 50000.0)] * 4), (4970.0, 12000.0, None, 4450.0))]
    found, = judged.soft(rows)
    assert (found.kind, found.level, found.runs) == ("soft", NOTE, ("run 3", "run 0"))
    assert found.numbers["number"] == 4450 and found.numbers["limit"] == 1e4
    assert found in judged.of_runs(rows) and judged.soft(rows[1:3]) == []


def test_runs_of_several_sizes_are_one_line():
    sizes, = gathered([Finding("lost much", {"volume": volume, "percent": 3.0, "up_to": "up to ", "where": "",
                                             "add": ""},
                               (f"rolling_0_d_{volume:g}",), "sizes of balls") for volume in (337.0, 4.21)], 4)
    several = [sizes, finding("the slope is steep"), finding("the toe is wet")]
    found = warnings.findings(data_of([], study=made_study.study(warnings=several), repeats={"x": []}), GROUND)
    assert [one.text for one in found if one.level == WARNING][1:] == ["the slope is steep", "the toe is wet"]
    assert sizes.numbers["volume"] == 337 and sizes.numbers["of"] == 4 and len(sizes.runs) == 2
    assert found[0] == sizes and warnings.first_page([sizes]) == []


def test_runs_that_failed_are_told_beside_finer_ones_that_did(monkeypatch):
    """With both sizes; the first page counts the study's own."""
    failed = {name: row(run=name, status="failed", error="ERROR: 3 atoms lost") for name in ("cut", "fine")}
    monkeypatch.setattr(size_runs, "read_run_rows", lambda *_: [failed["fine"]])
    monkeypatch.setattr(size_runs.sizes, "combine_sizes", lambda _: None)
    at = size_runs.at_finest(None, SimpleNamespace(finer={2.0: [SimpleNamespace(error="lost")]}, points=[]))
    rows = [*rows_of((0.0, 50000.0)), failed["cut"]]
    told = outcome.collect_study_warnings(SimpleNamespace(notes=at.warnings, order=None), SimpleNamespace(
        rows=rows, problem=None))
    assert [(one.runs, bool(one.part)) for one in told if one.kind == "failed"] == [
        (("fine",), True), (("cut",), False)]
    assert warnings.first_page(told) == ["1 of 2 runs failed and are not in the numbers."]


def test_a_finding_survives_its_file():
    """Also one of another version, of which the text counts, and a plain line of an older one."""
    one = Finding("balance", {"share": 2e-5, "of": 4}, ("a", "b"), "sizes of balls", "more of it")
    assert str(one).startswith("sizes of balls: ") and str(one).endswith("(2 of 4 runs: a; b); more of it")
    assert one.shown({"a": "first"}).endswith("(2 of 4 runs: first; b); more of it")
    entry = yaml.safe_load(yaml.safe_dump(one.entry()))
    assert finding(entry) == one and entry["level"] == NOTE and "more of it" not in entry["text"]
    newer = {"kind": "of tomorrow", "text": "it rains", "numbers": {"mm": 3}}
    assert str(finding(newer)) == str(finding("it rains")) == "it rains"
    assert str(finding({"kind": "lost", "text": "12 m3 left"})) == "12 m3 left"


class Any_:
    """Whatever a table of words asks for."""

    def __format__(self, spec):
        return format(1.5, "" if spec == "cubic" else spec)


class Numbers_(dict):
    def __missing__(self, key):
        return Any_()


@pytest.mark.parametrize("kind", WORDS)
def test_the_words_of_each_kind_can_be_rendered(kind):
    """All the table: levels that exist, words that end without a full stop, and on the first page with one."""
    words = words_of(kind)
    assert words.level in (WARNING, NOTE, LIMIT)
    text = string.Formatter().vformat(words.text, (), Numbers_())
    assert text and not text.endswith((".", " ")) and "{" not in text
    client = string.Formatter().vformat(words.client, (), Numbers_())
    assert not client or client.endswith(".") and not TOOLS_WORDS.search(client.replace("slope fails", ""))
    assert words.level != LIMIT or client


def test_a_structure_of_few_balls_is_a_caveat():
    """Its height is that above the ground, wherever that lies."""
    wall = np.array([[[2, 2, 95.0], [2, 8, 95], [2, 8, 112]]])
    ground = SimpleNamespace(before=None, along=lambda _, x, y: np.full(len(x), 100.0), obstacles=Obstacles(
        {"dam": wall}, {}))
    summary = {"volume": {"released": 64.0e3}, "balls": {"released": 1000}}
    data = SimpleNamespace(result=SimpleNamespace(summary=summary))
    found, = structures_part.coarse_walls(data, ground)
    assert (found.kind, found.level) == ("few balls high", LIMIT)
    assert found.numbers == {"name": "dam", "height": 12.0, "balls": pytest.approx(3.0)}
    summary["balls"]["released"] = 8000
    assert structures_part.coarse_walls(data, ground) == []


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


BEST = {"set": {"rolling": "0.1", "spacing": "0.5"}, "chance_m3": 3.0, "repeats": 3, "run": "b"}


@pytest.mark.parametrize("best, headline, own, shown", [
    (BEST, {"source": "paper"}, "b", " A run that leaves about as much, 2 of the appendix: rolling resistance 0.1."),
    ({**BEST, "chance_m3": None, "repeats": 1}, {"source": "paper"}, "a",
     " Run 1 of the appendix: rolling resistance 0.05."),
    (BEST, {"source": "ensemble"}, "b", " Run 2 of the appendix: rolling resistance 0.1."),
    (BEST, {"source": "paper", "volume_m3": None}, "b", " Run 2 of the appendix: rolling resistance 0.1.")])
def test_whether_the_map_is_of_a_run_on_which_the_number_rests(best, headline, own, shown):
    rows = [row(run="a", set={"rolling": "0.05"}), row(run="b", set={"rolling": "0.1"})]
    study = made_study.study(conservative=made_study.conservative(5.0, **best), runs=rows,
                             headline=made_study.headline(**{"volume_m3": 5.0, **headline}))
    data = SimpleNamespace(study=study, finished=rows, repeats={}, number=lambda name: 1 + "ab".index(name),
                           settings={"rolling": ["0.05", "0.1"], "spacing": ["0.5"]},
                           result=SimpleNamespace(name=own, row=rows["ab".index(own)]))
    assert numbers.shown_run(data) == shown


def test_the_body_in_a_sentence():
    known = body.Body(14808.9, 3584.0, 8.0, 35.02, body.SHAPES["slbl"], 1786.2, "EPSG:6677", True, "release.geojson")
    assert body.sentence(known) == (
        "14,809 m³ of ground would come down, up to 8.00 m deep and of 3,580 m² in plan, above a slip surface by the "
        "sloping local base level, on ground of 35 degrees on average. Its bulk density is 1,786 kg/m³. Coordinates: "
        "EPSG:6677 (assigned).")
    assert body.sentence(body.Body(119e6, None, None, None, "a given slip surface", None, None, False, None)) == (
        "119 million m³ of ground would come down, above a given slip surface. Coordinates: local metres.")


def test_the_stop_angle_of_a_run_alone():
    """One of a study's folder knows its deck's variables, and has no others beside it."""
    def said(*rows, finished=()):
        data = SimpleNamespace(result=SimpleNamespace(row=rows[0]), compared=rows, finished=finished,
                               label=lambda one: "a")
        ground = SimpleNamespace(below=SimpleNamespace(steeper=lambda degrees: 0.25))
        [(_, text)] = limits_part.resistance(data, ground, Numbers())
        return text
    alone = row(run="", stop_angle_deg=20.0)
    assert "below 20.0 degrees (stop angle, run a). Of the slope below the body 25 % is steeper" in said(alone)
    several = [row(stop_angle_deg=degrees) for degrees in (20.0, 24.0)]
    assert "in all runs 20.0 to 24.0" in said(*several, finished=several)
