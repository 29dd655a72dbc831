"""The number of a study: the larger of the paper's and an ensemble's, a floor, withheld, or nothing; by hand."""
import os
from pathlib import Path

import pytest
import yaml

import made_study

from slope_tools import disk, records
from slope_tools.commands import study
from slope_tools.errors import SlopeError
from slope_tools.report import client_part
from slope_tools.report.numbers import Numbers
from slope_tools.sites import site_choices
from slope_tools.sites.site_sections import OfMass
from slope_tools.statistics import answer, size_family
from slope_tools.statistics.answer import AtRoad, Code, Ensemble, Kind, Paper, Road, Source, Withheld
from slope_tools.statistics.withheld import Kind as Rule
from slope_tools.studies import site_study
from slope_tools.tables import answer_words, answered, fine_run, next_step

STOPPED = answer.Reason(Code.TERRAIN, {"share": 0.12, "path_m": 900.0})


def ensemble(far=0.01, rules=(), values=1000.0, **more):
    """Quantiles of values * share, unknown where known events lie beyond the runs."""
    return Ensemble({share: (values * share, 0.9 * values * share, 1.1 * values * share) if share <= 1 - far
                     else (None, None, None) for share in answer.shares(far)}, far, 800.0,
                    [Withheld(rule) for rule in rules], **more)


def road(low, high, longest=500.0):
    """Runs that bring 50 m3 to a road unless the longest one is short, without a lobe on it."""
    brought = AtRoad(8, 2, 1, 50.0, 5.0) if longest and longest >= 400 else AtRoad(8, 0, 0, 9.0, 0.9)
    return Road(400.0, 410.0, (high, low), (0.9 * high, 0.9 * low), longest, brought)


def codes(found):
    return [one.code for one in found.reasons]


def test_the_larger_of_both():
    found = answer.of(Paper(700.0), ensemble(), road(0.5, 0.6))
    assert (found.kind, found.volume, found.source, found.share) == (Kind.NUMBER, 950.0, Source.ENSEMBLE, 0.95)
    assert (found.low, found.high, found.reasons) == (pytest.approx(855), pytest.approx(1045), [])
    found = answer.of(Paper(1200.0), ensemble(), road(0.5, 0.6))
    assert (found.kind, found.volume, found.source, found.share, found.high) == (
        Kind.NUMBER, 1200.0, Source.PAPER, None, None)
    assert answer.of(Paper(5.0), None, None)[:2] == (Kind.NUMBER, 5.0)
    assert answer.of(None, ensemble(), None)[:2] == (Kind.NUMBER, 950.0)
    assert answer.of(None, None, None) is None


def test_too_few_balls_over_the_thickness_make_a_floor():
    """Of either study; nothing stays nothing, and what is withheld stays so."""
    few = answer.Reason(Code.SIZE, {"balls_thick": 5.0, "enough": 16.0})
    for paper, other in ((Paper(1200.0, size=few), ensemble()), (Paper(700.0), ensemble(size=few)),
                         (Paper(1200.0), ensemble(size=few))):
        found = answer.of(paper, other, road(0.5, 0.6))
        assert (found.kind, found.volume, found.high) == (Kind.FLOOR, max(paper.volume, 950.0), None)
        assert codes(found) == [Code.SIZE]
    assert answer.of(Paper(0.0, size=few), None, None).kind is Kind.NOTHING
    assert answer.of(Paper(None, [Withheld(Rule.LEFT)], few), None, None).kind is Kind.WITHHELD


def test_the_effect_of_size_raises_the_quantiles_of_an_ensemble():
    """By a factor of ten balls or more, by the difference of fewer; not where the fine run brings less."""
    def volume(**effect):
        quantile = {"share": 0.95, "value": 100.0, "low": 80.0, "high": None}
        about = made_study.study(ensemble=made_study.ensemble({"to_remove": [quantile]}), size={
            "run": "d_1", "open": False, "effects": {"remove_m3": {**made_study.EFFECT, **effect}}})
        return answered.ensemble_of(about).quantiles[0.95]

    assert volume(coarse=50.0, fine=60.0, ratio=True) == pytest.approx((120.0, 96.0, None))
    assert volume(coarse=0.0, fine=7.0, ratio=False) == pytest.approx((107.0, 87.0, None))
    assert volume(coarse=60.0, fine=50.0, ratio=True) == pytest.approx((100.0, 80.0, None))


def test_a_fine_run_that_failed_makes_a_floor_too():
    """Less is known than with one that finished: the number is no firmer."""
    entry = fine_run.evaluate(fine_run.Fine(None, (), 0.0, lambda key: None, "d_1: diverged"))
    about = made_study.study(conservative=made_study.conservative(1200.0), size=entry)
    found = answer.of(answered.paper_of(about), None, None)
    assert (found.kind, found.volume, codes(found)) == (Kind.FLOOR, 1200.0, [Code.SIZE])
    assert "did not finish" in answer_words.text(found.reasons[0]) and "d_1: diverged" in entry.text
    assert "did not finish" in answer_words.client(found.reasons[0])


@pytest.mark.parametrize("balls, kind", [(None, Kind.FLOOR), (5.0, Kind.FLOOR), (16.0, Kind.NUMBER)])
def test_without_a_fine_run_the_number_is_not_conservative(balls, kind):
    """Unless its own balls are small enough; the page says why."""
    about = made_study.study({"balls_thick": balls}, conservative=made_study.conservative(1200.0))
    found = answer.of(answered.paper_of(about), None, None)
    assert (found.kind, found.volume) == (kind, 1200.0)
    for text in (answer_words.text, answer_words.client):
        assert ["conservative" in text(one) and "not known" in text(one) for one in found.reasons] == \
            [True] * (kind is Kind.FLOOR)
    quantile = {"share": 0.95, "value": 100.0, "low": None, "high": None}
    made = next_step.Made(made_study.study(), Path("out"))
    step = next_step.of_studies([made], found.about())
    assert step is None if kind is Kind.NUMBER else step.command == "the same command with --fine 2" == step.before
    about = made_study.study({"balls_thick": balls}, ensemble=made_study.ensemble({"to_remove": [quantile]}))
    assert answer.of(None, answered.ensemble_of(about), None).kind is kind


@pytest.mark.parametrize("slides", [size_family.FEWEST - 1, size_family.FEWEST])
def test_the_growth_of_the_family_stands_beside_a_floor(monkeypatch, slides):
    """Where it tells: not from more balls of thickness than any slide of it has, nor of a few slides."""
    lines = [f"{k},{balls},{100 + k * balls},1,1" for k in range(slides) for balls in (1, 4, 15)]
    known = size_family.read(["case,balls,remove,beyond,length", *lines])
    monkeypatch.setattr(size_family, "family", lambda: known)
    size = {"run": "d_1", "open": True, "balls_thick": 2.0, "effects": {}}
    about = made_study.study(conservative=made_study.conservative(1200.0), size=size)
    floor = answer.of(answered.paper_of(about), None, None)
    said = answer_words.number(floor.about())       # what finer balls bring is open: nothing conservative
    assert said.startswith("at least 1,200 m3 to remove, by the sweep") and "conservative" not in said
    [reason] = floor.reasons
    growth = size_family.growth(2.0)
    if slides < size_family.FEWEST:
        assert reason.numbers["growth"] is None and "times as much" not in answer_words.text(reason)
        return
    assert reason.numbers["growth"] == growth._asdict() and growth.low <= growth.median <= growth.high
    for text in (answer_words.text(reason), answer_words.client(reason)):
        assert f"{growth.median:.2f}" in text and text.endswith("times as much")
    about = made_study.study(conservative=made_study.conservative(1200.0), size={**size, "balls_thick": 15.99})
    [reason] = answer.of(answered.paper_of(about), None, None).reasons
    assert reason.numbers["growth"] is None


def test_a_floor_where_known_events_lie_beyond_the_runs():
    found = answer.of(Paper(0.0), ensemble(0.08, stopped=STOPPED), road(0.5, 0.6))
    assert (found.kind, found.volume, found.share, found.high) == (Kind.FLOOR, 920.0, 0.92, None)
    assert codes(found) == [Code.BEYOND, Code.TERRAIN] and found.reasons[0].numbers == {"far": 0.08, "longest_m": 800.0}
    found = answer.of(Paper(0.0), ensemble(0.7), road(0.5, 0.6))
    assert (found.volume, found.share) == (300.0, 0.3)
    [reason] = answer.of(Paper(0.0), ensemble(0.3, path_end=161.2)._replace(longest=165.9), road(0.5, 0.6)).reasons
    assert all("30 %" in words(reason) and "161 m" in words(reason) and "166 m" in words(reason)
               for words in (answer_words.text, answer_words.client))
    # as files of earlier versions have it
    found = answer.of_ensemble(Ensemble({0.95: (None, 9.0, None), 0.9: (7.0, 5.0, None), 0.75: (3.0, 2.0, 4.0)}, 0.08,
                                        800.0), None)
    assert (found.kind, found.volume, found.share, found.low) == (Kind.FLOOR, 7.0, 0.9, 5.0)
    # the paper's more is a floor, too: what lies beyond is not known
    found = answer.of(Paper(5000.0), ensemble(0.7), road(0.5, 0.6))
    assert (found.kind, found.volume, found.source) == (Kind.FLOOR, 5000.0, Source.PAPER)
    # nor is nothing known at all
    found = answer.of(None, ensemble(1.0, [Rule.MOBILITY]), road(0.5, 0.6))
    assert (found.kind, found.volume, found.share) == (Kind.FLOOR, 0.0, 0.0)


@pytest.mark.parametrize("far, shares", [
    (0.0, [0.95]), (0.05, [0.95]), (0.0501, [0.95, 0.94]), (0.08, [0.95, 0.92]), (0.104, [0.95, 0.89]),
    (1, [0.95, 0.0])])
def test_the_floor_is_of_all_that_the_runs_reach(far, shares):
    assert answer.shares(far) == shares


@pytest.mark.parametrize("low, high, kind, said", [
    (0.02, 0.09, Kind.NOTHING, []), (0.05, 0.2, Kind.NOTHING, [Code.ONE_SCATTER]),
    (0.11, 0.2, Kind.FLOOR, [Code.NOT_REACHED])])
def test_a_road_that_no_run_reaches(low, high, kind, said):
    """The near edge decides: both scatters, one, or none says that more than a tenth of the known events reach it."""
    found = answer.of(Paper(0.0), ensemble(values=0.0), road(low, high, 399.0))
    assert (found.kind, found.volume, codes(found)) == (kind, 0.0, said)
    assert all(one.numbers == {"low": low, "high": high, "near_m": 400.0, "longest_m": 399.0} for one in found.reasons)
    assert answer.of(Paper(0.0), ensemble(values=0.0), road(low, high, None)).kind is kind


@pytest.mark.parametrize("reached, paper, rules, kind, said", [
    (far, paper, rules, kind, said)
    for paper, rules, near, beyond in [
        (0.0, None, (Kind.NOTHING, []), (Kind.FLOOR, [Code.NOT_REACHED])),
        (0.0, [Rule.BALLS], (Kind.NOTHING, [Code.RULE]), (Kind.FLOOR, [Code.NOT_REACHED, Code.RULE])),
        (0.0, [Rule.LEFT], (Kind.FLOOR, [Code.RULE]), (Kind.FLOOR, [Code.NOT_REACHED, Code.RULE])),
        (0.0, [Rule.MOBILITY], (Kind.NOTHING, []), (Kind.FLOOR, [Code.NOT_REACHED])),
        (None, [], (Kind.FLOOR, [Code.RULE]), (Kind.FLOOR, [Code.NOT_REACHED, Code.RULE])),
        (70.0, [Rule.BALLS], (Kind.NUMBER, [Code.RULE]), (Kind.NUMBER, [Code.RULE])),
        (70.0, [], (Kind.NUMBER, []), (Kind.FLOOR, [Code.NOT_REACHED]))]
    for far, (kind, said) in (((0.02, 0.05), near), ((0.3, 0.4), beyond))])
def test_a_road_that_known_events_reach_and_no_run_does(reached, paper, rules, kind, said):
    """0 m3 is nothing only where few known events reach it, whatever study stands beside it; rules: of an ensemble."""
    beside = None if rules is None else ensemble(values=0.0, rules=rules)
    found = answer.of(Paper(paper, [Withheld(Rule.LEFT)] * (paper is None)), beside, road(*reached, 0.0))
    assert (found.kind, found.volume, codes(found)) == (kind, paper or 0.0, said)


@pytest.mark.parametrize("rules", [[], [Rule.BALLS], [Rule.LEFT]])
@pytest.mark.parametrize("reached", [(0.02, 0.05), (0.11, 0.33), (0.9, 0.95)])
def test_nothing_is_said_only_where_no_run_brings_a_ball(rules, reached):
    """Of either study, whatever governs: 2 of 26 runs leave 530 and 614 m3."""
    beside = AtRoad(26, 2, 1, 1621.0, 5.8, 530.0, 614.0).and_of(AtRoad(6, 0, 0, 9.0, 0.1))
    for mass in (ensemble(values=0.0, rules=rules), ensemble(0.7, rules, 0.0), None):
        found = answer.of(Paper(0.0), mass, Road(151.0, 158.0, reached, reached, 165.0, beside))
        assert (found.kind, found.volume, found.high) == (Kind.FLOOR, 0.0, None)
        assert found.reasons[0] == (Code.SOME, {"runs": 32, "reach": 2, "least_m3": 530.0, "most_m3": 614.0})
        said = found.about()
        assert answer_words.number(said).startswith("more than 0 m3") and all(
            "2 of 32" in words(found.reasons[0]) and "530 to 614" in words(found.reasons[0])
            for words in (answer_words.text, answer_words.client))
        first = client_part.of_floor(said, Numbers())
        assert first.number == "more than 0" and "No run" not in first.title + first.band
    found = answer.of(Paper(0.0), ensemble(values=0.0), Road(151.0, 158.0, (0.0, 0.05), (0.0, 0.0), 120.0, AtRoad(
        26, 0, 0, 3.0, 0.4)))
    assert found.kind is Kind.NOTHING


def test_rules_that_withhold_one_of_both():
    mobility, balls, left = (Withheld(rule) for rule in (Rule.MOBILITY, Rule.BALLS, Rule.LEFT))
    for harmless in (mobility, balls):      # which the ensemble makes up for
        found = answer.of(Paper(None, [harmless]), ensemble(), road(0.5, 0.6))
        assert (found.kind, found.volume, found.reasons) == (Kind.NUMBER, 950.0, [])
        assert answer.of(Paper(None, [harmless]), None, None).kind is Kind.WITHHELD     # alone it stands
    found = answer.of(Paper(None, [left]), ensemble(), road(0.5, 0.6))
    assert (found.kind, found.volume, found.high, codes(found)) == (Kind.FLOOR, 950.0, None, [Code.RULE])
    assert found.reasons[0].numbers["source"] == "paper" and found.reasons[0].numbers["rule"] == Rule.LEFT.value
    found = answer.of(Paper(70.0), ensemble(rules=[Rule.LEFT]), road(0.5, 0.6))
    assert (found.kind, found.volume, found.source) == (Kind.FLOOR, 70.0, Source.PAPER)
    found = answer.of(Paper(70.0), ensemble(rules=[Rule.BALLS]), road(0.5, 0.6))     # its largest is less than balls
    assert (found.kind, found.volume) == (Kind.NUMBER, 70.0)
    found = answer.of(Paper(None, [left]), ensemble(rules=[Rule.RUNS]), road(0.5, 0.6))
    assert (found.kind, found.volume, found.source, codes(found)) == (Kind.WITHHELD, None, None, [Code.RULE, Code.RULE])


def test_what_study_yaml_says():
    about = answer.of(Paper(700.0), ensemble(0.08, stopped=STOPPED), road(0.5, 0.6)).about()
    about = records.plain(about)
    assert disk.plain(about) == about and list(about) == ["kind", "volume_m3", "share", "low_m3", "high_m3", "source",
                                                          "paper", "ensemble", "road", "reasons"]
    assert about["paper"] == {"volume_m3": 700.0, "withheld": []}
    assert about["ensemble"] == {"volume_m3": None, "far": 0.08, "withheld": []}
    assert about["road"]["reached"] == [0.5, 0.6] and about["reasons"][1] == {
        "code": "terrain ends", "numbers": {"share": 0.12, "path_m": 900.0}}


def test_the_volume_is_the_one_that_the_study_shows():
    best = made_study.conservative(21700.6, rounded={"volume_m3": 21710.0})
    done = {"run": "d_1", "open": False, "effects": {}}
    assert answered.paper_of(made_study.study(conservative=best, size=done)) == Paper(21710.0, [])


# --- which study governs ---

def written(folder, governs, made, at=0):
    """A study.yaml that was made at an hour and written, or copied, later."""
    folder.mkdir(exist_ok=True)
    path = folder / "study.yaml"
    path.write_text(yaml.safe_dump({"study": {"governs": governs, "collected": f"2026-11-27T{made:02}:00:00+00:00"}}))
    os.utime(path, (at, at))


@pytest.mark.parametrize("last", ["study", "ensemble"])
def test_which_study_governs_is_what_the_files_say(tmp_path, last):
    """Of both, of one command; else the one that was made last: never that whose file is the newer one."""
    paper, other = tmp_path / "study", tmp_path / "ensemble"
    for newer in (paper, other):
        for folder in (paper, other):
            written(folder, last, 10, 200 if folder == newer else 100)
        assert answered.governing(paper, other).name == last
        for folder in (paper, other):       # the last one alone since, as study --paper
            written(folder, folder.name, 12 if folder.name == last else 10, 200 if folder == newer else 100)
        assert answered.governing(paper, other).name == last
        (tmp_path / last / "study.yaml").unlink()
        assert answered.governing(paper, other).name != last


@pytest.mark.parametrize("fails, merged", [(True, 0), (False, 1)])
def test_an_older_result_is_not_merged_where_all_runs_failed(tmp_path, monkeypatch, fails, merged):
    for name in ("study", "ensemble"):
        written(tmp_path / name, name, 9)
    calls = []

    def runs(failed):
        if failed:
            raise study.RunsFailed(tmp_path, "all runs failed")
        return made_study.study({"collected": "2026-11-27T10:00:00+00:00"})

    monkeypatch.setattr(study.site_study, "run", lambda *_, **__: site_study.Done(tmp_path, runs(False), None))
    monkeypatch.setattr(study, "run_deck", lambda _: runs(fails))
    monkeypatch.setattr(study, "of_ensemble", lambda *_: None)
    monkeypatch.setattr(study, "write_report", lambda *_, **__: None)
    monkeypatch.setattr(study.answered, "of_both", lambda *several: calls.append(several))
    asked, site = study.Request(deck=tmp_path), site_choices.unread(OfMass.of({}), tmp_path)
    files = [tmp_path / name / "study.yaml" for name in ("study", "ensemble")]
    before = [path.read_bytes() for path in files]
    if fails:
        with pytest.raises(SlopeError, match="must have an ensemble for its number, --paper"):
            study.run_both(asked, site, 4)
        assert before == [path.read_bytes() for path in files]
    else:
        study.run_both(asked, site, 4)
        assert {yaml.safe_load(path.read_text())["study"]["governs"] for path in files} == {"ensemble"}
    assert len(calls) == merged
