"""The number of a study: the larger of the sweep's and an ensemble's, a floor, withheld, or nothing; by hand."""
import os
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

import made_study

from slope_tools import disk, records
from slope_tools.commands import study
from slope_tools.errors import SlopeError
from slope_tools.findings import Finding
from slope_tools.sites import site_choices
from slope_tools.sites.site_sections import OfMass
from slope_tools.statistics.entries import Brought, Cause, Code, Headline, Kind, KnownQuantile, Reason, Road, Source
from slope_tools.statistics.withheld import Kind as Rule
from slope_tools.studies import site_study
from slope_tools.studies.letter import Letter, write_letter
from slope_tools.tables import answer_words, headline, next_step, study_file
from slope_tools.tables.headline import Ensemble, Size, Sweep, combine_answers


def sentences(headline, reach=None):
    """Of a letter with this number."""
    return write_letter(Letter(5000.0, headline, None, reach, (), (), "computed"))


STOPPED = Reason(Code.TERRAIN, {"share": 0.12, "path_m": 900.0})


def ensemble(far=0.01, rules=(), values=1000.0, **more):
    """Quantiles of values * share, unknown where known events lie beyond the runs."""
    return Ensemble([KnownQuantile(share, values * share, 0.9 * values * share, 1.1 * values * share)
                     if share <= 1 - far else KnownQuantile(share, None, None, None) for share
                     in headline.choose_known_shares(far)],
                    far, 800.0, [Finding(rule.value) for rule in rules], **more)


def road(low, high, longest=500.0):
    """Runs that bring 50 m3 to a road unless the longest one is short, without a lobe on it."""
    brought = Brought(8, 2, 1, 50.0, 5.0) if longest and longest >= 400 else Brought(8, 0, 0, 9.0, 0.9)
    return Road(400.0, 410.0, [low, high], [0.9 * low, 0.9 * high], longest, brought)


def codes(found):
    return [one.code for one in found.reasons]


def test_the_larger_of_both():
    found = combine_answers(Sweep(700.0), ensemble(), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.source, found.share) == (Kind.NUMBER, 950.0, Source.ENSEMBLE, 0.95)
    assert (found.low_m3, found.high_m3, found.reasons) == (pytest.approx(855), pytest.approx(1045), [])
    found = combine_answers(Sweep(1200.0), ensemble(), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.source, found.share, found.high_m3) == (
        Kind.NUMBER, 1200.0, Source.SWEEP, None, 1200.0)
    # what the other one may be the number may be, too
    found = combine_answers(Sweep(1000.0, transfer=(0.0, 20.0)), ensemble(), road(0.5, 0.6))
    assert (found.volume_m3, found.source, found.high_m3) == (1000.0, Source.SWEEP, pytest.approx(1045))
    assert found.band[-1] == (Cause.OTHER.value, 0.0, pytest.approx((45 ** 2 - 20 ** 2) ** 0.5))
    assert combine_answers(Sweep(5.0), None, None)[:2] == (Kind.NUMBER, 5.0)
    assert combine_answers(None, ensemble(), None)[:2] == (Kind.NUMBER, 950.0)
    assert combine_answers(None, None, None) is None


def test_a_band_has_shares_that_add_as_squares():
    """By hand: chance, transfer and finer balls, on either side."""
    found = combine_answers(Sweep(1000.0, least=940.0, transfer=(80.0, 40.0), size=Size(-0.04, 0.03)), None,
                            None)
    assert [tuple(one) for one in found.band] == [
        (Cause.RUNS.value, 60.0, 0.0), (Cause.TRANSFER.value, 80.0, 40.0), (Cause.SIZE.value, 40.0, 30.0)]
    assert (found.kind, found.volume_m3) == (Kind.NUMBER, 1000.0)
    assert (found.low_m3, found.high_m3) == pytest.approx((1000 - (60 ** 2 + 80 ** 2 + 40 ** 2) ** 0.5, 1050))
    of = [one._replace(transfer=[50.0, 60.0]) for one in ensemble().quantiles]
    found = combine_answers(None, ensemble()._replace(quantiles=of, size=Size(0.0, 0.1)), None)
    assert (found.low_m3, found.high_m3) == pytest.approx(
        (950 - (95 ** 2 + 50 ** 2) ** 0.5, 950 + (95 ** 2 + 60 ** 2 + 95 ** 2) ** 0.5))
    said = sentences(found)
    assert "between 843 and 1,100 m3" in said.clear and "90 %" in said.clear
    assert "detailed" in said.basis and "-50.0 +60.0" in said.basis and "--" not in said.basis
    # without repeats nobody knows what chance adds: no confidence is named
    said = sentences(combine_answers(Sweep(1000.0, transfer=(80.0, 40.0)), None, None))
    assert "between 920 and 1,040 m3" in said.clear and "90 %" not in said.clear and \
        "without what chance changes" in said.clear


def test_a_floor_is_the_lower_end_rounded_down():
    """Of either study, where sizes of balls are too few; nothing stays nothing, and what is withheld stays so."""
    few = Size(floor=Reason(Code.SIZE, {"sizes": 3, "grown": 0.3}))
    for sweep, other, low in ((Sweep(1200.0, least=1177.0, size=few), ensemble(), 1170.0),
                              (Sweep(700.0), ensemble(size=few), 855.0)):
        found = combine_answers(sweep, other, road(0.5, 0.6))
        assert (found.kind, found.volume_m3, found.low_m3, found.high_m3) == (Kind.FLOOR, low, low, None)
        assert codes(found) == [Code.SIZE]
    # of two lower bounds the larger counts, whoever has the larger number
    found = combine_answers(Sweep(900.0, least=890.0, size=few), ensemble(size=few), road(0.5, 0.6))
    assert (found.volume_m3, found.source) == (890.0, Source.SWEEP)
    # what makes it one comes first, and its remedy with it: the terrain ends behind the road
    found = combine_answers(None, ensemble(0.08, stopped=STOPPED, size=few), road(0.5, 0.6))
    assert (found.kind, codes(found)) == (Kind.FLOOR, [Code.SIZE, Code.BEYOND, Code.TERRAIN])
    assert combine_answers(Sweep(0.0, size=few), None, None).kind is Kind.NOTHING
    assert combine_answers(Sweep(1200.0, size=few), None, None).kind is Kind.OPEN         # chance may be less
    assert combine_answers(Sweep(1200.0, least=0.0, size=few), None, None).kind is Kind.OPEN      # 0 is no bound


def test_what_finer_balls_may_undercut_is_no_lower_bound():
    """Of one size or two nobody knows what finer ones bring: the number stands, without a bound on either side."""
    for sizes in (1, 2):
        few = Size(floor=Reason(Code.SIZE, {"sizes": sizes, "grown": None}))
        for sweep, other, of, volume in ((Sweep(1200.0, least=1177.0, size=few), None, None, 1200.0),
                                         (Sweep(700.0), ensemble(size=few), road(0.5, 0.6), 950.0),
                                         (Sweep(0.0), ensemble(0.08, stopped=STOPPED, size=few),
                                          replace(road(0.5, 0.6), far_m=901.0), 920.0)):
            found = combine_answers(sweep, other, of)
            assert (found.kind, found.volume_m3, found.low_m3, found.high_m3) == (Kind.OPEN, volume, None, None)
            said = sentences(found)
            assert "neither" in said.clear and "least" not in said.clear and "90 %" not in said.clear
            assert answer_words.describe_volume(found.kind, volume, "m3").endswith("m3 (no bound)")
    assert combine_answers(Sweep(None, [Finding(Rule.LEFT.value)], size=few), None, None).kind is Kind.WITHHELD


STEP = {"finer": 2.0, "pairs": 8, "factor": 1.0, "deviation": 0.03, "on_parameters": False}


def sized(*grown):
    """What a study says of sizes, whose steps raised the volume to remove by these shares."""
    left = {"low": -0.03, "best": 0.01, "high": 0.02, "grown": grown[-1], "order": 1.0, "observed": False}
    return {"sizes": [{"d": 4 / 2 ** k, "balls": 400 * 8 ** k, "balls_thick": None, "runs": 5}
                      for k in range(len(grown) + 1)], "parameters": [], "text": "",
            "effects": {"remove_m3": {"steps": [STEP] * len(grown), "left": left if len(grown) > 1 else None}}}


@pytest.mark.parametrize("size, kind, words", [
    (None, Kind.OPEN, "one size"), (sized(0.1), Kind.OPEN, "2 sizes"), (sized(0.4, 0.26), Kind.FLOOR, "26 %"),
    (sized(0.4, 0.24), Kind.NUMBER, "")])
def test_fewer_than_two_halvings_make_no_bound_and_one_that_grows_a_floor(size, kind, words):
    """Of both studies; what is to be done next is one size more."""
    quantile = {"share": 0.95, "value": 1200.0, "low": 1000.0, "high": 1400.0}
    about = made_study.study(conservative=made_study.conservative(1200.0, chance_m3=50.0), size=size)
    other = made_study.study(ensemble=made_study.ensemble({"to_remove": [quantile]}), size=size)
    for found in (combine_answers(headline.sweep_of(about), None, None),
                  combine_answers(None, headline.ensemble_of(other), None)):
        assert found.kind is kind and [one.code for one in found.reasons] == [Code.SIZE] * (kind is not Kind.NUMBER)
        assert all(words in text(one) for one in found.reasons for text
                   in (answer_words.describe_reason, answer_words.client))
        step = next_step.of_studies([next_step.Made(about, Path("out"))], found)
        assert (step is None) == (kind is Kind.NUMBER) and (step is None or "--levels" in step.command)
    if kind is Kind.NUMBER:
        assert found.band[-1] == (Cause.SIZE.value, pytest.approx(36), pytest.approx(24))


def test_where_known_events_lie_beyond_the_runs_the_number_is_of_those_within():
    """A floor only where the terrain ends before the road does: the lower end."""
    found = combine_answers(Sweep(0.0), ensemble(0.08, stopped=STOPPED), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, codes(found)) == (Kind.NUMBER, 920.0, [Code.BEYOND, Code.TERRAIN])
    found = combine_answers(Sweep(0.0), ensemble(0.08, stopped=STOPPED), replace(road(0.5, 0.6), far_m=901.0))
    assert (found.kind, found.volume_m3, found.share, found.high_m3) == (Kind.FLOOR, 828.0, 0.92, None)
    assert codes(found) == [Code.BEYOND, Code.TERRAIN]
    assert found.reasons[0].numbers == {"far": 0.08, "longest_m": 800.0, "most_m3": 0.0, "runs": 0}
    other = Reason(Code.RUNS, {"points": 8})
    found = combine_answers(Sweep(0.0), ensemble(0.08, stopped=other), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.share, found.high_m3) == (Kind.NUMBER, 920.0, 0.92, pytest.approx(1012))
    assert codes(found) == [Code.BEYOND, Code.RUNS]
    found = combine_answers(Sweep(0.0), ensemble(0.7), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.share) == (Kind.NUMBER, 300.0, 0.3)
    [reason] = combine_answers(Sweep(0.0), ensemble(0.3, path_end=161.2, most=77.0, runs=24),
                               road(0.5, 0.6)).reasons
    assert reason.numbers["path_end_m"] == 161.2
    # only of its own runs is known what they leave, and how far others go is said once, by one ruler
    assert all(words in answer_words.client(reason) for words in ("30 %", "24 runs", "77 m3")) and \
        "161" not in answer_words.client(reason)
    # without an upper bound it is what no run exceeded
    several = [KnownQuantile(0.95, None, 9.0, None), KnownQuantile(0.9, 7.0, 5.0, None)]
    found = combine_answers(None, Ensemble(several, 0.08, 800.0, most=11.0), None)
    assert (found.kind, found.volume_m3, found.share, found.low_m3, found.high_m3) == (Kind.NUMBER, 7.0, 0.9, 5.0, 11.0)
    # the sweep's more is a number, too
    found = combine_answers(Sweep(5000.0), ensemble(0.7), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.source) == (Kind.NUMBER, 5000.0, Source.SWEEP)
    # nor is nothing known at all
    found = combine_answers(None, ensemble(1.0, [Rule.MOBILITY]), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.share) == (Kind.FLOOR, 0.0, 0.0)


@pytest.mark.parametrize("far, shares", [
    (0.0, [0.95]), (0.05, [0.95]), (0.0501, [0.95, 0.94]), (0.08, [0.95, 0.92]), (0.104, [0.95, 0.89]),
    (1, [0.95, 0.0])])
def test_the_number_is_of_all_that_the_runs_reach(far, shares):
    assert headline.choose_known_shares(far) == shares


@pytest.mark.parametrize("low, high, kind, said", [
    (0.02, 0.09, Kind.NOTHING, []), (0.05, 0.2, Kind.NOTHING, [Code.ONE_SCATTER]),
    (0.11, 0.2, Kind.FLOOR, [Code.NOT_REACHED])])
def test_a_road_that_no_run_reaches(low, high, kind, said):
    """The near edge decides: both scatters, one, or none says that more than a tenth of the known events reach it."""
    found = combine_answers(Sweep(0.0), ensemble(values=0.0), road(low, high, 399.0))
    assert (found.kind, found.volume_m3, codes(found)) == (kind, 0.0, said)
    assert all(one.numbers == {"low": low, "high": high, "near_m": 400.0, "longest_m": 399.0} for one in found.reasons)
    assert combine_answers(Sweep(0.0), ensemble(values=0.0), road(low, high, None)).kind is kind


@pytest.mark.parametrize("reached, sweep, rules, kind, said", [
    (far, sweep, rules, kind, said)
    for sweep, rules, near, beyond in [
        (0.0, None, (Kind.NOTHING, []), (Kind.FLOOR, [Code.NOT_REACHED])),
        (0.0, [Rule.BALLS], (Kind.NOTHING, [Code.RULE]), (Kind.FLOOR, [Code.NOT_REACHED, Code.RULE])),
        (0.0, [Rule.LEFT], (Kind.FLOOR, [Code.RULE]), (Kind.FLOOR, [Code.NOT_REACHED, Code.RULE])),
        (0.0, [Rule.MOBILITY], (Kind.NOTHING, []), (Kind.FLOOR, [Code.NOT_REACHED])),
        (None, [], (Kind.FLOOR, [Code.RULE]), (Kind.FLOOR, [Code.NOT_REACHED, Code.RULE])),
        (70.0, [Rule.BALLS], (Kind.NUMBER, [Code.RULE]), (Kind.NUMBER, [Code.RULE])),
        (70.0, [], (Kind.NUMBER, []), (Kind.FLOOR, [Code.NOT_REACHED]))]
    for far, (kind, said) in (((0.02, 0.05), near), ((0.3, 0.4), beyond))])
def test_a_road_that_known_events_reach_and_no_run_does(reached, sweep, rules, kind, said):
    """0 m3 is nothing only where few known events reach it, whatever study stands beside it; rules: of an ensemble."""
    beside = None if rules is None else ensemble(values=0.0, rules=rules)
    found = combine_answers(Sweep(sweep, [Finding(Rule.LEFT.value)] * (sweep is None), sweep), beside,
                            road(*reached, 0.0))
    assert (found.kind, found.volume_m3, codes(found)) == (kind, sweep or 0.0, said)


@pytest.mark.parametrize("rules", [[], [Rule.BALLS], [Rule.LEFT]])
@pytest.mark.parametrize("reached", [(0.02, 0.05), (0.11, 0.33), (0.9, 0.95)])
def test_nothing_is_said_only_where_no_run_brings_a_ball(rules, reached):
    """Of either study, whatever governs: 2 of 26 runs leave 530 and 614 m3."""
    beside = Brought(26, 2, 1, 1621.0, 5.8, 530.0, 614.0).and_of(Brought(6, 0, 0, 9.0, 0.1))
    for mass in (ensemble(values=0.0, rules=rules), ensemble(0.7, rules, 0.0), None):
        found = combine_answers(Sweep(0.0), mass, Road(151.0, 158.0, reached, reached, 165.0, beside))
        assert (found.kind, found.volume_m3, found.high_m3) == (Kind.FLOOR, 0.0, None)
        assert found.reasons[0] == (Code.SOME, {"runs": 32, "reach": 2, "least_m3": 530.0, "most_m3": 614.0})
        first = sentences(found)
        assert first.clear.startswith("More than 0 m3") and "no run" not in (first.clear + first.basis).lower()
        assert "2 of 32" in first.change and "530 to 614" in first.change and "2 of 32 runs" in first.roads
    found = combine_answers(Sweep(0.0), ensemble(values=0.0),
                            Road(151.0, 158.0, (0.0, 0.05), (0.0, 0.0), 120.0, Brought(26, 0, 0, 3.0, 0.4)))
    assert found.kind is Kind.NOTHING


def test_rules_that_withhold_one_of_both():
    mobility, balls, left = (Finding(rule.value) for rule in (Rule.MOBILITY, Rule.BALLS, Rule.LEFT))
    for harmless in (mobility, balls):      # which the ensemble makes up for
        found = combine_answers(Sweep(None, [harmless]), ensemble(), road(0.5, 0.6))
        assert (found.kind, found.volume_m3, found.reasons) == (Kind.NUMBER, 950.0, [])
        assert combine_answers(Sweep(None, [harmless]), None, None).kind is Kind.WITHHELD     # alone it stands
    found = combine_answers(Sweep(None, [left]), ensemble(), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.high_m3, codes(found)) == (Kind.FLOOR, 855.0, None, [Code.RULE])
    assert found.reasons[0].numbers["source"] == "paper" and found.reasons[0].numbers["rule"] == Rule.LEFT.value
    found = combine_answers(Sweep(70.0, least=65.0), ensemble(rules=[Rule.LEFT]), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.source) == (Kind.FLOOR, 65.0, Source.SWEEP)
    assert combine_answers(Sweep(70.0), ensemble(rules=[Rule.LEFT]), road(0.5, 0.6)).kind is Kind.OPEN
    found = combine_answers(Sweep(70.0), ensemble(rules=[Rule.BALLS]),
                            road(0.5, 0.6))     # its largest is less than balls
    assert (found.kind, found.volume_m3) == (Kind.NUMBER, 70.0)
    # but a narrow road, or one below a steep hillside, has few balls on it and much to remove
    for volume, kind in ((1045.0, Kind.NUMBER), (1046.0, Kind.FLOOR)):
        large = [Finding(Rule.BALLS.value, {"number": 1.5, "bound": 10, "volume": volume})]
        found = combine_answers(Sweep(None, large), ensemble(), road(0.5, 0.6))
        assert (found.kind, codes(found)) == (kind, [Code.RULE] * (kind is Kind.FLOOR)), volume
        found = combine_answers(Sweep(1045.0, least=1000.0), ensemble()._replace(withheld=large), road(0.5, 0.6))
        assert (found.kind, found.source) == (kind, Source.SWEEP), volume
    found = combine_answers(Sweep(None, [left]), ensemble(rules=[Rule.RUNS]), road(0.5, 0.6))
    assert (found.kind, found.volume_m3, found.source) == (Kind.WITHHELD, None, None)
    assert codes(found) == [Code.RULE, Code.RULE]


def test_what_only_runs_bound_is_said_so():
    """As where the known events beyond all runs leave the quantile without an upper end."""
    of = [one._replace(high=None) for one in ensemble().quantiles]
    for quantiles, ends in ((of, ("95 %", "above 855", "as far as these runs go")),
                            (ensemble().quantiles, ("90 %", "between 855"))):
        said = sentences(combine_answers(None, ensemble()._replace(quantiles=quantiles, most=1200.0),
                                         None)).clear
        assert all(one in said for one in ends)


def test_what_study_yaml_says():
    """What is read from it is what was evaluated."""
    said = combine_answers(Sweep(700.0), ensemble(0.08, stopped=STOPPED), road(0.5, 0.6))
    about = records.encode_record(said)
    for each in (said, combine_answers(Sweep(None, [Finding(Rule.LEFT.value)]), ensemble(rules=[Rule.RUNS]), None)):
        assert records.read_record(Headline, yaml.safe_load(yaml.safe_dump(records.encode_record(each)))) == each
    with pytest.raises(records.NoRecord, match="kind: must be one of number, floor, open, withheld, nothing, got 'x'"):
        records.read_record(Headline, {**about, "kind": "x"})
    assert disk.make_plain(about) == about and list(about) == ["kind", "volume_m3", "share", "low_m3", "high_m3",
                                                               "source", "paper", "ensemble", "road", "reasons", "band",
                                                               "open_above"]
    assert about["paper"] == {"volume_m3": 700.0, "withheld": [], "runs": 0}
    assert about["ensemble"] == {"volume_m3": None, "far": 0.08, "withheld": [], "runs": 0}
    assert about["road"]["reached"] == [0.5, 0.6] and about["reasons"][1] == {
        "code": "terrain ends", "numbers": {"share": 0.12, "path_m": 900.0}}


def test_the_volume_is_the_one_that_the_study_shows():
    best = made_study.conservative(21700.6, rounded={"volume_m3": 21710.0})
    assert headline.sweep_of(made_study.study(conservative=best))[:2] == (21710.0, [])


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
    sweep, other = tmp_path / "study", tmp_path / "ensemble"
    for newer in (sweep, other):
        for folder in (sweep, other):
            written(folder, last, 10, 200 if folder == newer else 100)
        assert study_file.find_governing_study(sweep, other).name == last
        for folder in (sweep, other):       # the last one alone since, as study --paper
            written(folder, folder.name, 12 if folder.name == last else 10, 200 if folder == newer else 100)
        assert study_file.find_governing_study(sweep, other).name == last
        (tmp_path / last / "study.yaml").unlink()
        assert study_file.find_governing_study(sweep, other).name != last


@pytest.mark.parametrize("fails, merged", [(True, 0), (False, 1)])
def test_an_older_result_is_not_merged_where_all_runs_failed(tmp_path, monkeypatch, fails, merged):
    for name in ("study", "ensemble"):
        written(tmp_path / name, name, 9)
    calls = []

    def runs(failed):
        if failed:
            raise study.RunsFailed(tmp_path, "all runs failed")
        return made_study.study({"collected": "2026-11-27T10:00:00+00:00"})

    for name in ("plan_site_study", "make_site_runs", "wanted"):
        monkeypatch.setattr(study.site_study, name, lambda *_: None)
    monkeypatch.setattr(study.site_study, "collect_site_results", lambda *_,
                        **__: site_study.Done(tmp_path, runs(False), None))
    monkeypatch.setattr(study, "run_deck", lambda *_: runs(fails))
    monkeypatch.setattr(study, "of_ensemble", lambda *_: None)
    monkeypatch.setattr(study, "write_site_report", lambda *_, **__: None)
    monkeypatch.setattr(headline, "make_headline", lambda *several: calls.append(several))
    asked, site = study.Request(deck=tmp_path, quiet=True), site_choices.unread(OfMass.of({}), tmp_path)
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


def test_no_number_exceeds_what_was_released():
    """Neither its upper end, where chance or finer balls would take it there."""
    found = combine_answers(Sweep(900.0, least=850.0, size=Size(0.0, 0.5), released=1000.0), None, None)
    assert (found.kind, found.volume_m3, found.high_m3) == (Kind.NUMBER, 900.0, 1000.0)
    found = combine_answers(Sweep(1200.0, least=1100.0, size=Size(0.0, 0.1), released=1000.0), None, None)
    assert (found.volume_m3, found.high_m3) == (1000.0, 1000.0) and found.low_m3 <= 1000
