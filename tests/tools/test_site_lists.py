"""Lists of a site that change: no run is made that is there, no trial run either, and what is ahead is said before."""
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

import made_rows
import made_study
from run_helpers import write_asc
from test_site import CELL, COLUMNS, ROWS, gis, make_mine, told, work_in, write_files, write_layer  # noqa: F401
from test_site_anew import MAPPED, edit, inside  # noqa: F401
from tiny_collapse import LMP

from slope_tools import cli
from slope_tools.case import decks
from slope_tools.case.data_files import data_files
from slope_tools.commands import study as study_command
from slope_tools.errors import SlopeError
from slope_tools.runs import store
from slope_tools.sites import site_budget, site_choices, site_deck, site_trial
from slope_tools.studies.road_numbers import Made
from slope_tools.studies import ahead, outdated, site_study, size_runs, study
from slope_tools.studies.setup import Setup

POINTS = 8
ENGINE = Setup(Path("in.site"), Path("."))


def measure(folder, deck, lmp, values):
    """A trial run that takes no time."""
    write_asc(folder / "site.max_thickness.asc", np.ones((ROWS, COLUMNS)), CELL)
    assert float(decks.index_variables(folder / deck)["speed"]) == site_budget.SLOW
    return site_budget.Trial(100, 0.0, 22.0, True, 14.0, 2e-7, 0.5, 1.0, 0.0)


@pytest.fixture
def trials(monkeypatch):
    """The rolling resistances of the trial runs that were made."""
    made = []
    monkeypatch.setattr(site_trial, "measure",
                        lambda *words: made.append(words[-1]["rolling"]) or measure(*words))
    return made


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The standard files, and a site with all runs of its study, of which nothing but the folders is there."""
    folder = tmp_path_factory.mktemp("whole")
    write_files(folder)
    write_layer(folder / "mapped.geojson", MAPPED)
    with pytest.MonkeyPatch.context() as patch:
        work_in(folder, patch)
        patch.setattr(site_trial, "measure", measure)
        patch.setenv("LMP", LMP)
        make_mine()
        edit(folder / "mine", "study", points=POINTS, levels=1)
        finish(folder / "mine")
    return folder


@pytest.fixture
def mine(whole, inside, gis, trials, monkeypatch):  # noqa: F811
    """A copy of it."""
    shutil.copytree(whole, gis, dirs_exist_ok=True)
    monkeypatch.setenv("LMP", LMP)
    assert counts(gis / "mine") == (ALL, 0)
    return gis / "mine"


def finish(folder, points=POINTS):
    """Make the folders of all runs that are ahead."""
    planned = site_study.plan_site_study(site_choices.load_site(folder), ENGINE)
    more, _ = ahead.plan_weighted_points(planned, points)
    files = data_files(planned.setup.deck, {**planned.settings, **planned.repeated})
    wanted = site_study.wanted(site_choices.load_site(folder), planned, site_study.Asked(), points)
    fine = [size_runs.SizeRun(planned.setup.runs, one, value) for value, number in zip(wanted.values[1:], wanted.points)
            for one in [*planned.todo, *more][:number]]
    with study.prepared(planned.setup, files, 1) as work:
        for several in (planned.runs, more, fine):
            work.store.admit(several)
            for run in store.select_distinct_runs(several):
                if not run.finished:
                    work._make_folder(run)
                    run.marker.write_text("summary: site.summary.yaml\n")


def counts(folder, points=POINTS):
    found = ahead.look_ahead(site_choices.load_site(folder), ENGINE, points)
    return found.there, found.new


# of 3 rolling resistances x 3 packings, 2 other grounds at both ends, half the step, 3 packings with the largest
# restitution at the least rolling resistance; then the ensemble
ALL = 17 + POINTS
CHANGES = [
    # 0.05 and 0.1 in the middle are there; 0.15 is not, nor is half the step of another middle
    ("study", {"rolling": [0.05, 0.1, 0.15]}, "--rolling 0.05 0.1 0.15", 6 + POINTS, 3 + 4 + 1 + 3),
    ("study", {"rolling": [0.05]}, "--rolling 0.05", 4 + POINTS, 2 + 3),        # other grounds at this one
    ("study", {"spacing": []}, None, ALL - 4, 0),
    ("study", {"spacing": [0.5, 0.6]}, None, ALL - 2, 2),
    ("study", {"packing": [3]}, None, ALL - 4, 0),
    ("study", {"packing": [2, 3, 4]}, None, ALL, 4),
    ("study", {"largest_restitution": None}, None, ALL - 3, 0),
    ("study", {"largest_restitution": 0.6}, None, ALL - 3, 3),
    ("road", {"cut_angle": 45.0}, "--cut-angle 45", ALL, 0),
    ("road", {"lane": 3.5, "clearing": 60.0, "loosening": 1.2}, "--lane 3.5 --clearing 60 --loosening 1.2", ALL, 0),
    ("road", {"loosening": 1.3}, None, ALL, 0),
    ("known", {"set": "rock_avalanches"}, "--known rock_avalanches", ALL, 0),
    ("known", {"confined": "yes"}, "--confined", ALL, 0)]


@pytest.mark.parametrize("section, values, words, there, new", CHANGES)
def test_a_list_that_changes_and_changes_back_keeps_all_runs(mine, inside, trials, section, values, words,  # noqa: F811
                                                             there, new):
    before, variables = site_choices.load_site(mine).choices.entries(), decks.index_variables(mine / site_deck.NAME)
    edit(mine, section, **values)
    assert counts(mine) == (there, new)
    edit(mine, section, **before[section])
    assert counts(mine) == (ALL, 0)
    if words:
        out = inside(f"mine {words}").out
        assert counts(mine) == (there, new) and f"the study: {there} of {there + new} runs are there" in out
        assert site_choices.load_site(mine).choices.entries()[section] == {**before[section], **values}
        edit(mine, section, **before[section])
        inside("mine")
    assert counts(mine) == (ALL, 0) and decks.index_variables(mine / site_deck.NAME) == variables
    assert trials == []        # none was made again
    after = site_choices.load_site(mine).choices.entries()
    assert all(after[section][key] == before[section][key] for section, key in site_choices.DERIVED)


def test_the_number_of_points(mine):
    """The first ones of a larger design are those of a smaller one; its median run is another."""
    for points, there, new in ((16, ALL, 8), (POINTS, ALL, 0), (0, 17, 0)):
        edit(mine, "study", points=points)
        assert counts(mine, points) == (there, new)


def test_the_sizes_of_balls(mine):
    """Runs with finer ones are kept when there are more or fewer sizes, and when time says how many."""
    edit(mine, "study", levels=3)
    there, new = counts(mine)
    assert there == ALL and new >= sum(site_budget.LEAST)
    finish(mine)
    assert counts(mine) == (ALL + new, 0)
    edit(mine, "study", levels=1)
    assert counts(mine) == (ALL, 0)
    more = ahead.look_ahead(site_choices.load_site(mine), ENGINE, POINTS, site_study.Asked(3, 1000.0))
    assert more.there == ALL + new and more.new > 0
    assert ahead.look_ahead(site_choices.load_site(mine), ENGINE, POINTS, site_study.Asked(minutes=1e-3)).new == 0


def test_files_by_any_path_from_any_folder(mine, inside, trials, monkeypatch, tmp_path):  # noqa: F811
    """A sidecar names its sources as they were given: that does not count."""
    place = mine.parent
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    for words in (f"{mine} --road {place}/road.geojson --cut-angle 45", f"../mine --terrain {place}/dem.tif",
                  "../mine --terrain ../dem.tif --release ../release.geojson", "../mine --observed ../mapped.geojson",
                  "../mine --road ../mapped.geojson", str(mine)):
        inside(words)
        assert counts(mine) == (ALL, 0) and trials == [], words
    sources = [yaml.safe_load(path.read_text())["sources"] for path in (
        mine / "terrain.yaml", *mine.glob("runs/*/terrain.yaml"))]
    assert sources[0] != sources[1]


def test_another_place_in_a_sidecar_counts(mine):
    path = mine / "terrain.yaml"
    path.write_text(path.read_text().replace("east: -12000.0", "east: -12001.0"))
    with pytest.raises(SlopeError, match="was run with another terrain.yaml"):
        counts(mine)


def test_other_values_of_the_model_leave_the_runs_where_they_are(mine, inside, trials):  # noqa: F811
    """Those of the sweep are other ones; the ensemble's have a friction of their own."""
    runs = set((mine / "runs").iterdir())
    inside("mine --friction 25")
    assert counts(mine) == (POINTS, 17)
    finish(mine)
    assert set((mine / "runs").iterdir()) > runs and counts(mine) == (ALL, 0)
    inside("mine --friction 30")
    assert counts(mine) == (ALL, 0) and len(trials) == 6        # three each time, as the machine is measured anew


def test_an_ensemble_that_does_not_vary_a_list_takes_its_first_value(mine, monkeypatch):
    edit(mine, "study", rolling=[0.1, 0.05])
    seen = []
    monkeypatch.setattr(study_command, "run_deck", lambda args, _: seen.append((args.set, args.vary)))
    monkeypatch.setattr(study_command, "write_site_report", lambda *_, **__: None)
    request = study_command.Request(deck=mine, sample=8)
    for words in (["friction=5:30"], ["friction=5:30", "rolling=0:0.1"], []):
        study_command.run_site_ensemble(study_command.replace(request, vary=words), site_choices.load_site(mine))
    assert [fixed for fixed, _ in seen] == [["rolling=0.1"], [], []]


def test_what_is_ahead_is_said_before_anything_runs(mine, monkeypatch, capsys):
    edit(mine, "study", rolling=[0.05, 0.1, 0.15])
    said = []
    monkeypatch.setattr(study_command, "run_both", lambda *_: said.append(capsys.readouterr().out) or Made((), None))
    study_command.run_study(study_command.Request(deck=mine))
    assert re.search(rf"^{6 + POINTS} of {17 + POINTS} runs are there, 11 to make, (\d+ s|\d+ minutes); up to {POINTS} "
                     "more where known events go farther$", said[0], re.MULTILINE), said
    seconds = ahead.look_ahead(site_choices.load_site(mine), ENGINE, POINTS).seconds
    finish(mine)
    assert ahead.look_ahead(site_choices.load_site(mine), ENGINE, POINTS).seconds is None and seconds > 0


def test_a_site_is_made_without_a_third_trial(mine, inside, trials, monkeypatch):  # noqa: F811
    """One that does not end, or fails, makes the forecast a guess, and nothing else."""
    right = site_trial.measure

    def failing(*words):
        if len(trials) == 2:
            raise SlopeError("trial run", "must end within 600 s")
        return right(*words)

    monkeypatch.setattr(site_trial, "measure", failing)
    out = inside("mine --friction 26").out
    assert len(trials) == 2 and "a third one, spacing 0.5: trial run: must end within 600 s" in out
    assert site_choices.found(mine).trial.late is None and not (mine / "trial").exists()


def test_points_that_are_there_count_whatever_time_is_left(mine, monkeypatch):
    monkeypatch.setattr(site_budget, "FEW_POINTS", 2)
    site, short = site_choices.load_site(mine), site_study.Asked(minutes=1e-6)
    assert site_study.points_of(site, ENGINE) == POINTS and site_study.points_of(site, ENGINE, short) == 2
    assert ahead.choose_points(site, ENGINE, short) == POINTS
    last = ahead.plan_weighted_points(site_study.plan_site_study(site, ENGINE), POINTS)[0][-1]
    shutil.rmtree(last.folder)
    assert ahead.choose_points(site, ENGINE, short) == POINTS // 2 and ahead.choose_points(site, ENGINE) == POINTS


def test_a_trial_run_is_kept_until_what_it_depends_on_changes(mine, inside, trials, monkeypatch):  # noqa: F811
    out = inside("mine --client somebody --rolling 0.1 0.2").out
    assert "the trial run is there" in out and trials == []
    assert (mine / site_trial.REACHED).is_file()
    inside("mine --balls 90")       # what is determined anew would be that of another rolling resistance
    assert trials == [0.1]
    inside("mine --depth 4")
    assert trials == [0.1, 0.1]
    (mine / site_trial.REACHED).unlink()
    inside("mine")
    assert len(trials) == 3
    monkeypatch.setattr(site_trial.provenance, "machine", lambda: {"processor": "another"})
    inside("mine")
    assert len(trials) == 4


def test_the_deck_holds_no_value_of_a_list(mine, inside):  # noqa: F811
    first = (mine / site_deck.NAME).read_bytes()
    inside("mine --rolling 0.2 0.3")
    assert (mine / site_deck.NAME).read_bytes() == first


def test_keys_without_an_option_are_named(capsys):
    with pytest.raises(SystemExit):
        cli.main(["site", "--help"])
    out = " ".join(capsys.readouterr().out.split())
    assert "study.spacing" in out and "study.packing" in out and "study.points" in out and "study.levels" in out


@pytest.mark.parametrize("words, changed", [
    (None, None), ("--rolling 0.05 0.1 0.15", None), ("--cut-angle 45", None),       # lists and the road: the runs stay
    ("--friction 25", "in.site"), ("--depth 4", "in.site"), ("--spacing 0.8", "in.site")])
def test_a_study_of_other_choices_is_no_answer(mine, inside, monkeypatch, words, changed):  # noqa: F811
    """A page, files and scenarios of a site that was rebuilt since do not show its old numbers as its own."""
    (mine / "study").mkdir(exist_ok=True)
    name = next(path.name for path in (mine / "runs").iterdir() if "restitution" not in path.name)
    row = made_rows.row(run=name, summary=f"../runs/{name}/site.summary.yaml")
    made_study.write(mine / "study", [row])
    monkeypatch.setattr(outdated, "road_changed", lambda *_: None)      # the runs alone count here
    if words:
        inside(f"mine {words}")
    assert outdated.changed(mine, mine / "study") == changed
    if changed is None:
        return outdated.check_study_current(mine, mine / "study")
    with pytest.raises(SlopeError, match="must be as it was studied: .* `slope study .* the study of now"):
        outdated.check_study_current(mine, mine / "study")
    return outdated.check_study_current(mine / "study", mine / "study")       # the folder of the study itself shows it
