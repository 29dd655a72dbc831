"""tools/slope study SITE: by a sweep, and weighted by known events, for masses of all sizes."""
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import made_study
from run_helpers import called
from test_site import gis, told  # noqa: F401
from test_site_anew import inside, mine, once  # noqa: F401
from tiny_collapse import LMP

from slope_tools.commands import known_arguments, study as study_command
from slope_tools.ensembles import known_events, known_study, sample
from slope_tools.errors import SlopeError
from slope_tools.mobility import body, known
from slope_tools.sites import site_budget, site_choices
from slope_tools.sites.site_sections import Known
from slope_tools.studies import ensemble_study, results, site_study
from slope_tools.survey import rasters

CELL = 20.0


@pytest.fixture
def large(inside, gis):  # noqa: F811
    """A site of 0.3 million m3 on a slope of 25 degrees and a plain, without a trial run."""
    x = np.arange(0, 3000, CELL) + CELL / 2
    heights = np.maximum(900 - 0.47 * x, 430 - 0.02 * x)
    rows = "\n".join(" ".join(f"{z:.2f}" for z in heights) for _ in range(40))
    (gis / "large.asc").write_text(f"ncols {len(x)}\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize {CELL:g}\n{rows}\n")
    (gis / "large.csv").write_text("200,300\n500,300\n500,500\n200,500\n")
    inside("--terrain large.asc --crs EPSG:6677 --release large.csv --shape ellipsoid --volume 3e5 --balls 100 -o big")
    return gis / "big"


def study(capsys, monkeypatch, words):
    monkeypatch.setenv("LMP", LMP)
    return called(capsys, ["study", *words.split(), "--dry-run"])


@pytest.fixture
def small(mine, gis):  # noqa: F811
    """A site of few m3, which no set covers."""
    return mine


@pytest.mark.parametrize("name, words", [("large", "big"), ("small", "mine")])
def test_both_studies_of_masses_of_all_sizes(request, capsys, monkeypatch, name, words):
    """The sweep's 13 runs, three with the largest restitution, one with half the step where there is a road; 64 that
    known events weigh."""
    request.getfixturevalue(name)
    status, out, err = study(capsys, monkeypatch, words)
    assert status == 0, err
    assert out.startswith("weighted by known events of this volume and height, beside a sweep")
    assert " 64 runs, 0 of them finished" in f" {out.splitlines()[-1]}"
    assert sum("rolling_" in line and "friction_" in line for line in out.splitlines()) == 64
    assert "16 runs, 0 of them finished" in out or "17 runs, 0 of them finished" in out
    assert study(capsys, monkeypatch, f"{words} --unconfined")[0] == 0
    status, _, err = study(capsys, monkeypatch, f"{words} --paper --unconfined")
    assert status == 2 and "must be given with --known" in err
    status, out, _ = study(capsys, monkeypatch, f"{words} --paper")
    assert status == 0 and out.startswith("by a sweep, as asked for\n") and "64 runs" not in out
    path = request.getfixturevalue(name) / "site.yaml"
    path.write_text(path.read_text().replace("points: 64", "points: 0"))
    status, out, _ = study(capsys, monkeypatch, words)
    assert status == 0 and out.startswith("by a sweep; site.yaml asks for no runs") and "64 runs" not in out


def test_the_ensemble_varies_ground_and_restitution(large, capsys, monkeypatch):
    """Friction, rolling, spacing, restitution on the field and the packing; runs that are added go farther."""
    seen = []
    monkeypatch.setattr(study_command.site_study, "make_site_runs", lambda *_: None)
    monkeypatch.setattr(ensemble_study, "run_ensemble", lambda _, questions, *more: seen.append(questions.order))
    assert study(capsys, monkeypatch, "big")[0] == 0
    [order] = seen
    assert {one.name: (one.low, one.high) for one in order.sample.variables} == {
        "friction": (5, 30), "rolling": (0, 0.15), "spacing": (0.3, 0.95), "field_e": (0.05, 0.5),
        "packing": (1, 1000000)}
    assert {one.name: one.wide for one in order.sample.variables if one.wide} == {
        "friction": (2, 30), "spacing": (0.2, 0.95)}
    assert order.condition.found.by_set.in_range and not order.condition.named
    seen.clear()
    assert study(capsys, monkeypatch, "big --sample 16 --vary friction=5:9 --known rock_avalanches")[0] == 0
    assert [one.wide for one in seen[0].sample.variables] == [None] and seen[0].condition.named


def test_other_grounds_at_both_ends_of_rolling(mine, capsys, monkeypatch):  # noqa: F811
    """One packing each, beside the rolling resistances and packings on the site's own ground."""
    status, out, err = study(capsys, monkeypatch, "mine --paper")
    assert status == 0, err
    runs = [line.split(":")[0] for line in out.splitlines() if line.startswith("rolling_") and "_spacing_" in line]
    assert runs == [*(f"rolling_{rolling}_spacing_0.9{more}" for rolling in ("0", "0.05", "0.1")
                      for more in ("", "_packing_2", "_packing_3")),
                    *(f"rolling_{rolling}_spacing_{spacing}" for spacing in ("0.5", "0.7") for rolling in ("0", "0.1"))]
    assert "_d_" not in out and "17 runs, 0 of them finished" in out        # one of half the step
    choices = site_choices.load_site(mine).choices
    own = choices.changed({("study", "spacing"): [0.5, 0.9], ("study", "rolling"): [0.2]})
    assert own.other_grounds == [(0.5, 0.2)]        # its own ground is none of the others


@pytest.mark.parametrize("words, line", [
    ("mine --paper --sample 8", "--paper: must not be given with --sample or --from"),
    ("mine --paper --from fit", "--paper: must not be given with --sample or --from"),
    ("mine --fine 2", "--fine: must not be given any more: --levels says how many sizes of balls there are"),
    ("mine --levels 6", "--levels: must be 1 to 5 for a site, how many sizes of balls, got 6"),
    ("mine --levels d=2,1", "--levels: must be 1 to 5 for a site, how many sizes of balls, got d=2,1"),
    ("mine --minutes 0", "--minutes: must be > 0, got 0"),
    ("mine/in.site --minutes 5 --set rolling=0 -o o", "--minutes: must be given with the folder of a site, got mine"),
    ("mine/in.site --minutes 0 --set rolling=0 -o o", "--minutes: must be given with the folder of a site, got mine"),
    ("mine --vary friction=5:9", "--vary: must not be given with the folder of a site"),
    ("mine/in.site --paper --set rolling=0 -o o", "--paper: must be given with the folder of a site, got mine/in")])
def test_refused(mine, capsys, monkeypatch, words, line):  # noqa: F811
    status, _, err = study(capsys, monkeypatch, words)
    assert status == 2 and err.count("\n") == 1 and err.startswith(f"slope study: {line}"), err


def test_why_not(large, monkeypatch):
    """Level ground has no fall path; any other mass is compared, with a mapped deposit or without."""
    assert known_study.why_not(large) == ""
    whole = body.read_mobility_body(large)
    monkeypatch.setattr(body, "read_mobility_body", lambda _: whole._replace(raster=whole.raster._replace(
        z=np.full_like(whole.raster.z, 7.0))))
    assert "cannot be compared with known events" in known_study.why_not(large) and "flat" in known_study.why_not(large)


def test_known_of_site_yaml_reaches_the_study(mine, capsys, monkeypatch):  # noqa: F811
    """Its row weighs the ensemble, and withholds the sweep's number; without one landslides count, and do not."""
    choices = (mine / "site.yaml").read_text()
    for given, path, named in (("null", "all", False), ("debris_flows:channelized", "channelized", True)):
        (mine / "site.yaml").write_text(choices.replace("  set: null", f"  set: {given}"))
        asked = known_arguments.choice_of(None, [], None, site_choices.load_site(mine))
        condition = known_events.check_condition(asked, None, mine)
        found = known_events.mobility_of(condition, mine, mine)
        assert found.law.path == path and found.in_range and (condition.found.strict is not None) == named
        assert asked.about() == {"set": None if given == "null" else given, "left_out": [], "confined": "unknown"}
        kept = results.Questions({}, {}, (), known=asdict(site_choices.load_site(mine).choices.known)).among
        assert kept == {"set": asked.about()["set"], "confined": "unknown"}
        assert known.of_about(kept).row == asked.row
    with pytest.raises(SlopeError, match="--known: must be a set that covers the mass"):
        known_events.check_condition(known.choice("rock_avalanches"), "rock_avalanches", mine)


def test_the_estimate_is_of_the_study_that_is_made(large):
    choices = site_choices.load_site(large).choices
    assert site_choices.load_site(large).content["found"]["study"]["runs"] == 16 + choices.study.points == 80
    plan = site_budget.plan_budget(choices)
    assert plan.runs == 80 and not plan.half_step and "64 runs weighted by known events" in plan.text
    choices = choices.changed({("study", "points"): 0})
    plan = site_budget.plan_budget(choices)
    assert plan.runs == 16 and not plan.half_step       # no road: nothing to compare
    assert site_budget.plan_budget(choices.changed({("road", "file"): "road.csv"})).half_step
    assert plan.text == ("16 runs: 3 rolling resistances x 3 packings, 4 on other grounds, 3 with the largest "
                         "restitution")
    assert site_budget.plan_budget(choices.changed({("study", "spacing"): []})).runs == 12
    assert site_budget.plan_budget(choices.changed({("study", "largest_restitution"): None})).runs == 13


@pytest.mark.parametrize("left, asked, numbers", [
    (0.0, None, []), (3.9, None, []), (4.0, None, [4]), (43.9, None, [8]), (44.0, None, [12, 4]),
    (0.0, 3, [12, 4]), (1e9, 3, [24, 8]), (1e9, 1, []), (1e9, 2, [8]), (5.0, 2, [5])])
def test_time_decides_how_many_points_run_with_finer_balls(left, asked, numbers):
    """Each size takes eight times as long as the one before; first one size more, then more points of the finest."""
    found = site_budget.within(50, lambda k: 8.0 ** (k - 1), left, asked)
    assert found == numbers
    assert asked or sum(number * 8 ** k for k, number in enumerate(found)) <= left
    assert len(site_budget.within(50, lambda k: 8.0 ** (k - 1), 1e9)) == site_budget.MOST_SIZES - 1
    assert site_budget.within(5, lambda k: 1.0, 1e9, 3) == [5, 5]


def test_the_method_is_in_the_results(mine, monkeypatch, capsys):  # noqa: F811
    """It goes from the command to study.yaml through the questions."""
    seen = []
    monkeypatch.setattr(site_study.results, "collect_results", lambda setup, questions,
                        *_: seen.append(questions.method))
    monkeypatch.setattr(site_study.study, "perform", lambda *words, **_: words[3](words[2], None))
    monkeypatch.setattr(site_study.size_runs, "make_finer_runs", lambda *_: site_study.size_runs.Made((), {}))
    monkeypatch.setattr(site_study.size_runs.Wanted, "with_finished", lambda wanted, _: wanted)
    monkeypatch.setattr(site_study, "judge_step_run", lambda *_: None)
    monkeypatch.setattr(site_study, "elastic_of", lambda *_: None)
    monkeypatch.setattr(study_command.ahead, "choose_points", lambda *_: pytest.fail("runs of no sweep"))
    study(capsys, monkeypatch, "mine --paper")
    assert seen.pop() == known_study.ASKED and not seen
    monkeypatch.setattr(study_command, "run_deck", lambda args, beside: setattr(
        beside, "at", site_study.size_runs.AtFinest(site_study.size_runs.Made((), {}), None)) or made_study.study())
    with pytest.raises(AssertionError):       # there is no study.yaml, as nothing is collected
        study_command.run_both(study_command.Request(deck=mine), site_choices.load_site(mine), 8)
    assert seen.pop() == known_study.BESIDE


def test_failed_finer_runs_are_told_once(monkeypatch):
    """By the sweep, where there is one beside the ensemble, else by the ensemble."""
    seen = []
    for module, name, fake in ((sample, "plan_sample", lambda *_: []), (sample, "check_growth", lambda *_: None),
                               (sample, "settings_of", lambda _: {}), (sample, "all_values", lambda *_: {}),
                               (ensemble_study.size_runs, "settle", lambda *_: SimpleNamespace(warnings=["failed"])),
                               (ensemble_study.study, "perform", lambda setup, values, todo, collect, begin: collect(
                                   todo, None)),
                               (ensemble_study.results, "collect_results", lambda setup, questions, *_: seen.append(
                                   list(questions.notes)))):
        monkeypatch.setattr(module, name, fake)
    order = SimpleNamespace(sample=SimpleNamespace(names=()), condition=None)
    setup = SimpleNamespace(site=Path("mine"), runs=Path("runs"), output=Path("out"))
    for planned in (None, SimpleNamespace(todo=[])):
        ensemble_study.run_ensemble(setup, results.Questions({}, {}, (), order), {}, {}, None,
                                    site_study.Beside(planned, None))
    assert seen == [["failed"], []]


def test_a_site_of_a_mass_on_top_of_the_terrain(large, inside):  # noqa: F811
    """Its ground before is the sum; what is said of known events stands in site.yaml, no without quotes, too."""
    ground = rasters.read_asc_local(large / "terrain.asc")
    mass = np.where(np.hypot(*(values - 400 for values in np.meshgrid(
        CELL * (np.arange(150) + 0.5), CELL * (39.5 - np.arange(40))))) < 100, 8.0, 0.0)
    rows = "\n".join(" ".join(f"{value:g}" for value in row) for row in mass)
    head = f"ncols 150\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize {CELL:g}"
    (large.parent / "mass.asc").write_text(f"{head}\n{rows}\n")
    inside("--terrain large.asc --crs EPSG:6677 --scar mass.asc --scar-is height --confined no --known rockfalls "
           "--balls 100 -o top")
    top = large.parent / "top"
    before, depth = (rasters.read_asc_local(top / name) for name in ("terrain.asc", "release.depth.asc"))
    assert before.z == pytest.approx(ground.z + mass, abs=2e-3) and (before.crs, before.offset) == (ground.crs,
                                                                                                    ground.offset)
    assert np.nan_to_num(depth.z) == pytest.approx(mass, abs=2e-3)
    assert body.read_mobility_body(top).base == pytest.approx(ground.z, abs=2e-3)
    text = (top / "site.yaml").read_text()
    assert "confined: 'no'" in text and "set: rockfalls" in text
    (top / "site.yaml").write_text(text.replace("confined: 'no'", "confined: yes"))
    assert site_choices.load_site(top).choices.known == Known("rockfalls", "yes")
    inside("top --name again")
    assert rasters.read_asc_local(top / "terrain.asc").z == pytest.approx(before.z, abs=1e-6)      # once, not twice
