"""Numbers of pages that are made, not typed: tests/made_numbers.py. What decks give now: test_verification.py."""
import csv
import importlib.util
import re
import sys

import pytest

from run_helpers import TOP

sys.path.insert(0, str(TOP / "tests"))

import made_numbers  # noqa: E402  (after the path is set)

from slope_tools.validation import verification, verify  # noqa: E402

MARKED = [path for path in made_numbers.PAGES if made_numbers.filled(text := path.read_text(encoding="utf-8")) and (
    any(mark.search(text) for mark in made_numbers.MARKS) or made_numbers.SERIES.search(text))]
KNOWN = {"01": {"e": 0.24873, "verdict": "rolls", "sum.0": 15003.4, "sum.0.05": 15681.0, "share": 0.123}}


@pytest.mark.parametrize("path", MARKED, ids=lambda path: str(path.relative_to(TOP)))
def test_a_page_has_the_numbers_of_its_file(path):
    text = path.read_text(encoding="utf-8")
    assert made_numbers.filled(text) == text


def test_the_cases_with_kept_numbers_are_filled():
    shown = {path.parent.name for path in MARKED}
    kept = {path.parent.name for path in made_numbers.INPUTS.glob(f"*/{verify.NUMBERS}.yaml")}
    assert kept | {"21_earthquake", "22_structures", "25_authume", "27_tschamut"} <= shown


def test_the_page_on_verification_is_made_of_all_claims():
    outcomes = verify.kept_outcomes()
    assert [one.claim.name for one in outcomes] == [claim.name for claim in verification.all_claims()]
    assert made_numbers.VERIFICATION.read_text(encoding="ascii") == verify.page(outcomes)


@pytest.mark.parametrize("was, now", [
    ("a <!--01.e-->0.2494<!--/--> b", "a <!--01.e-->0.24873<!--/--> b"),
    ("<!--01.e:.2f-->?<!--/-->|<!--01.verdict-->slides<!--/-->",
     "<!--01.e:.2f-->0.25<!--/-->|<!--01.verdict-->rolls<!--/-->"),
    ("<!--01.sum.0:,.0f--><!--/-->", "<!--01.sum.0:,.0f-->15,003<!--/-->"),
    ("* :made:`1<01.e>`, :made:`2 %<01.share:.0%>`", "* :made:`0.24873<01.e>`, :made:`12%<01.share:.0%>`"),
    ("  ours: {0: 1, 0.05: 2}    # 01.sum", "  ours: {0: 15003, 0.05: 15681}    # 01.sum"),
    ("no <!-- comment --> 0.25", "no <!-- comment --> 0.25")])
def test_a_mark_gets_its_number(was, now):
    assert made_numbers.filled(was, dict(KNOWN)) == now == made_numbers.filled(now, dict(KNOWN))


def test_tables_and_data_of_a_case_give_numbers():
    predicted, stones, paper = (made_numbers.kept(case) for case in ("25", "27", "20"))
    assert predicted["prediction_P2.across.0.05.lowest_seed_m"] == "-6.0"
    assert stones["stones"] == 80 and stones["measured.0.5"] == pytest.approx(101.7)
    assert paper["reference.company_I.0.1"] == 14490
    assert paper["reference.company_J.over"] == pytest.approx(26009 / 14225)


@pytest.mark.parametrize("got, form, text", [
    (3.1e-6, ".0e", "3e-6"), (4e6, ".0e", "4e+6"), (2e-10, ".0e", "2e-10"), (2.1e-5, ".2%", "less than 0.01%"),
    (0.0, ".0%", "0%"), (0.004, ".0%", "less than 1%"), (-0.001, ".0%", "-0%"), ("-6.0", ".0f", "-6.0")])
def test_a_number_is_worded(got, form, text):
    assert made_numbers.worded(got, form) == text


def test_the_page_has_the_stop_angles_of_their_table():
    with open(TOP / "tools" / "slope_tools" / "sites" / "stop_angles.csv", encoding="ascii", newline="") as file:
        known = {(row["pattern"], *(float(row[name]) for name in ("spacing_d", "layers", "friction_deg", "rolling"))):
                 float(row["stop_angle_deg"]) for row in csv.DictReader(file) if row["restitution"] == "0.3"}
    lines = (TOP / "doc" / "src" / "choosing_parameters.rst").read_text(encoding="utf-8").splitlines()
    first, = (i for i, line in enumerate(lines) if line.lstrip().startswith("spacing, d "))
    columns = [match.span() for match in re.finditer("=+", lines[first + 1])]
    singles = lines[first - 1].rindex(" ---")       # the second of two heads
    shown = {}
    for line in lines[first + 2:lines.index(lines[first + 1], first + 2)]:
        for column in columns[1:]:
            if value := line[slice(*column)].strip():
                grounds = tuple(map(float, lines[first][slice(*column)].split(",")))
                shown["scattered", float(line[slice(*columns[0])]), 0.3 if column[0] > singles else 3.0, *grounds] = \
                    float(value)
    assert len(shown) > 60 and shown == {key: known[key] for key in shown}


def test_the_pages_show_the_number_alone():
    spec = importlib.util.spec_from_file_location("pages_conf", TOP / "doc" / "src" / "conf.py")
    conf = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(conf)
    (shown,), _ = conf.made_number("made", "", "15,003<20.e.0:,.0f>", 1, None)
    assert str(shown) == "15,003"


def test_a_mark_of_no_number_is_refused():
    with pytest.raises(KeyError):
        made_numbers.filled("<!--01.none-->1<!--/-->", dict(KNOWN))


def test_what_was_not_made_anew_stays(tmp_path, monkeypatch):
    monkeypatch.setattr(made_numbers, "INPUTS", tmp_path)
    place = tmp_path / "01_a" / "numbers.yaml"
    place.parent.mkdir()
    made_numbers.put(place, {"claims": {"a": {"got": 1.0}}, "seen": {"x": 1}})
    made_numbers.put(place, {"claims": {"b": {"got": 2.0}}, "seen": {"x": 2}})
    assert made_numbers.yaml.safe_load(place.read_text()) == {
        "claims": {"a": {"got": 1.0}, "b": {"got": 2.0}}, "seen": {"x": 2}}


TABLE = "run,wall,line,m3,word\na,1,behind,3000,x\nb,1,behind,3500,x\nc,0,behind,0,y\n"


def test_a_table_that_a_command_wrote_gives_what_pages_have(tmp_path, monkeypatch):
    """Rows of one name are several runs; of what no page has nothing is kept, and what a page has must be there."""
    monkeypatch.setattr(made_numbers, "INPUTS", tmp_path)
    place = tmp_path / "01_a" / "numbers.yaml"
    place.parent.mkdir()
    (tmp_path / "lines.csv").write_text(TABLE)
    text = "<!--01.lines.1.behind.m3.low:.1f/1e3-->?<!--/--> :made:`?<01.lines.0.behind.m3>`"
    made_numbers.take_table(f"01.lines={tmp_path}/lines.csv:wall,line", [text])
    kept = made_numbers.yaml.safe_load(place.read_text())["seen"]
    assert kept == {"lines.0.behind.m3": 0.0, "lines.1.behind.m3.low": 3000.0}
    assert made_numbers.filled(text, {"01": kept}) == text.replace("?", "3.0", 1).replace("?", "0")
    found = made_numbers.written(tmp_path / "lines.csv", ["wall"])
    assert [found[f"1.m3.{what}"] for what in ("mean", "low", "high", "above_0", "count")] == [3250, 3000, 3500, 2, 2]
    assert found["1.m3.sd"] == pytest.approx(500 / 2 ** 0.5) and found["0.word"] == "y" and "0.word.mean" not in found
    (tmp_path / "f.yaml").write_text("curves:\n- body: 'a b'\n  median: 958.5\nlevels: [0.1, 0.2]\n"
                                     "zones:\n- of: speed\n  above: 1.0\n- of: speed\n  above: 10.0\n")
    assert made_numbers.written(tmp_path / "f.yaml") == {
        "curves.a_b.body": "a b", "curves.a_b.median": 958.5, "levels.0": 0.1, "levels.1": 0.2,
        "zones.speed.1.of": "speed", "zones.speed.1.above": 1.0, "zones.speed.10.of": "speed",
        "zones.speed.10.above": 10.0}
    with pytest.raises(SystemExit, match="must have lines.1.behind.none; it has lines.0"):
        made_numbers.take_table(f"01.lines={tmp_path}/lines.csv:wall,line", [text.replace("m3.low", "none")])
    assert made_numbers.yaml.safe_load(place.read_text())["seen"] == kept
