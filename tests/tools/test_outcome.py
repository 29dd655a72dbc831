"""The way of the data: evaluation writes and tells nothing, and a page is drawn when something of it has changed."""
import ast
import inspect
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

import made_study
from made_rows import row

import slope_tools
from slope_tools import kept
from slope_tools.ensembles import ensemble, known_events
from slope_tools.report import document
from slope_tools.report.heading import Asked
from slope_tools.seismic import chain_files
from slope_tools.studies import outcome
from slope_tools.tables import combinations, intensity, road_runs, step_check

ROOM = Path(slope_tools.__file__).parent
WRITES = {"disk", "files", "console", "provenance"}


def test_outcome_imports_nothing_that_writes_or_tells():
    names = {alias.name for node in ast.walk(ast.parse((ROOM / "studies" / "outcome.py").read_text()))
             if isinstance(node, (ast.Import, ast.ImportFrom)) for alias in node.names}
    assert "combinations" in names and not names & WRITES


@pytest.mark.parametrize("evaluate", [
    outcome.evaluate_study, ensemble.evaluate_ensemble, known_events.evaluate_known_events, chain_files.evaluate_chain,
    intensity.evaluate_intensity, road_runs.evaluate_road_runs, step_check.compare, combinations.conservative],
    ids=lambda one: f"{one.__module__.split('.')[-1]}.{one.__name__}")
def test_an_evaluation_has_no_folder_and_writes_nothing(evaluate):
    """Neither a folder nor something that tells is among its parameters, and it calls nothing that writes."""
    assert not {"output", "folder", "tell", "say", "warn", "place"} & set(inspect.signature(evaluate).parameters)
    called = {node.func.attr for node in ast.walk(ast.parse(inspect.getsource(evaluate)))
              if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)}
    assert not called & {"write", "unlink", "mkdir", "tell", "write_text", "print"}


# --- when a page is drawn ---

@pytest.fixture
def page(tmp_path, monkeypatch):
    """A study of a run, and what draws its page: a stand-in that counts."""
    folder = tmp_path / "study"
    run = folder / "one"
    run.mkdir(parents=True)
    (run / "finished.yaml").write_text("summary: site.summary.yaml\n")
    (run / "site.thickness.asc").write_text("1 2 3\n")
    about = made_study.study({"collected": "then", "machine": {"name": "here"}, "jobs": 2},
                             runs=[row(run="one", summary="one/site.summary.yaml")], farthest="one")
    drawn = []

    def make(asked):
        drawn.append(asked)
        table = SimpleNamespace(table=lambda: "a,b\n")
        film = SimpleNamespace(content=b"film", text="", failed=False)
        return SimpleNamespace(section=table, numbers=table, film=film, warnings=[]), {}

    monkeypatch.setattr(document, "make_page", make)
    monkeypatch.setattr(document, "render", lambda content: "<html><head>\n" + (
        f'<meta name="slope-made-of" content="{content["made_of"]}">' if content["made_of"] else "") + "</head></html>")

    def update(site=None, place=tmp_path, **change):
        output = place / "report.html"
        before = len(drawn)
        asked = Asked(place / folder.name, film=output.with_suffix(".mp4"), study=replace(about, **change),
                      site=site or {})
        lines = document.update(asked, output)
        assert ("unchanged" in lines[0]) == (len(drawn) == before)
        return len(drawn) - before
    update.folder, update.about, update.page = folder, about, tmp_path / "report.html"
    return update


def test_a_page_is_drawn_once(page):
    assert [page() for _ in range(3)] == [1, 0, 0]
    again = replace(page.about.study, collected="now", machine={"name": "there"}, jobs=4)
    assert page(study=again) == 0


def test_a_page_is_drawn_once_however_its_folder_is_named(page, monkeypatch):
    assert page() == 1
    above = page.folder.parent
    for here, name in ((above, "."), (page.folder, ".."), (above.parent, above.name)):
        monkeypatch.chdir(here)
        assert page(place=Path(name)) == 0, name


@pytest.mark.parametrize("what", ["number", "run", "raster", "site", "tools", "page", "table", "film"])
def test_a_page_is_drawn_when_something_of_it_has_changed(page, monkeypatch, what):
    assert page() == 1
    change = {}
    if what == "number":
        change = {"farthest": "another"}
    elif what == "run":
        (page.folder / "one" / "finished.yaml").write_text("summary: site.summary.yaml\nfinished: later\n")
    elif what == "raster":
        (page.folder / "one" / "site.thickness.asc").write_text("1 2 4 5\n")
    elif what == "site":
        change = {"site": {"project": {"name": "another"}}}
    elif what == "tools":
        monkeypatch.setattr(kept, "tools", lambda: "others")
    else:
        page.page.with_suffix({"page": ".html", "table": ".numbers.csv", "film": ".mp4"}[what]).unlink()
    assert page(**change) == 1 and page(**change) == 0


def test_a_page_whose_film_failed_is_drawn_again(page, monkeypatch):
    make = document.make_page

    def failed(asked):
        found, content = make(asked)
        found.film = SimpleNamespace(content=None, text="No film: ffmpeg could not make it", failed=True)
        return found, content

    monkeypatch.setattr(document, "make_page", failed)
    assert [page(), page()] == [1, 1]
    monkeypatch.setattr(document, "make_page", make)
    assert [page(), page()] == [1, 0]
