"""Numbers of pages that are made, not typed: tests/made_numbers.py. What decks give now: test_verification.py."""
import importlib.util
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


def test_the_cases_of_the_paper_are_filled():
    shown = {str(path.relative_to(TOP)) for path in MARKED}
    assert {f"inputs/{name}/README.md" for name in ("01_restitution", "04_rolling_resistance", "06_oblique_impact",
                                                    "08_collisions")} <= shown


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
