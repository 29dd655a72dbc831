"""What commands show on a screen: tables that fit it, JSON in every line for programs, what a bare command would do."""
import io
import json
import sys
import warnings
from types import SimpleNamespace

import pytest
from rich.console import Console
from rich.table import Table

import made_study
from made_rows import row
from run_helpers import run_command

from slope_tools import cli
from slope_tools.commands import polygon, run_arguments
from slope_tools.errors import SlopeError
from slope_tools.findings import Finding, finding
from slope_tools.report import document, heading, structures_part, warnings as report_warnings
from slope_tools.report.study_part import ENDS, MOST_ROWS, Runs
from slope_tools.tables import judged, quantities, study_table
from slope_tools.tables.rows import finished_of

CELLS = {"rolling": "0.05", "released": "17,522", "wall s": "1,234", "reach angle deg": "22.1",
         "99 % within m": "123.4", "length m": "130.2", "farthest ball m": "155.1", "end": "at rest",
         "to remove": "12,345", "on the road": "9,876"}


def runs():
    found = Table(title="three runs", caption="in all runs friction 30")
    for head in CELLS:
        found.add_column(head, justify="right")
    for _ in range(3):
        found.add_row(*CELLS.values())
    found.add_row("0.1", "failed")
    return found


@pytest.mark.parametrize("width", [180, 120, 90, 70, 50, 40])
def test_a_table_fits_and_no_number_is_cut(width):
    shown, out = runs(), io.StringIO()
    left_out = study_table.fit_width(shown, width)
    Console(file=out, width=width).print(shown)
    lines = out.getvalue().splitlines()
    kept = [cell for head, cell in CELLS.items() if head not in left_out]
    assert max(map(len, lines)) <= width and "0.05" in kept
    assert sum([cell.strip() for cell in line.strip("│ ").split("│")] == kept for line in lines) == 3
    assert left_out == [head for head in study_table.LESS if head in CELLS][:len(left_out)]
    assert bool(left_out) == (width < study_table.width_of(runs())) and len(left_out) < len(CELLS) - 2


@pytest.mark.parametrize("all_columns", [False, True])
def test_the_rest_is_named_or_asked_for(all_columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    run_arguments.teller(all_columns)(runs())
    out = capsys.readouterr().out
    assert ("--all-columns" in out) != all_columns and "friction 30" in out
    assert ("1,234" in out) == all_columns and "12,345" in out


def test_a_heading_names_the_option_that_is_wrong(tmp_path):
    with pytest.raises(SlopeError, match="--name: must be one line"):
        heading.heading(tmp_path, {"project": "a\nb", "client": None, "author": None})
    with pytest.raises(SlopeError, match="--client: must be one line"):
        heading.heading(tmp_path, {"project": "a", "client": "b\n", "author": None})


# --- --progress json ---

@pytest.mark.parametrize("words, level, text", [
    ("polygon none.csv --terrain none.asc -o out.csv", "error", "none.asc"),
    ("polygon", "error", "the following arguments are required"),
    ("polygon none.csv --terrain none.asc -o out.csv --crs EPSG:6677", "note", "--crs is --assign-crs now"),
    ("nonsense", "error", "invalid choice"),
    ("bench --quick", "error", "must be called in a checkout")])
def test_every_line_is_an_object(words, level, text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    if words.startswith("bench"):
        monkeypatch.setattr(cli, "TESTS", tmp_path)
    try:
        status = cli.main(["--progress", "json", *words.split()])
    except SystemExit as ended:
        status = ended.code
    said = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert status == 2 and [one for one in said if one["level"] == level and text in one["text"]]


@pytest.mark.parametrize("before", [[], ["--progress=json"]])
def test_a_warning_of_a_library_is_a_line_of_ours(before, monkeypatch, capsys):
    def warns(_):
        warnings.warn("two\tnumbers are one", UserWarning)
        for kind in (DeprecationWarning, PendingDeprecationWarning):        # for those who write programs
            warnings.warn("write @ for *", kind)
    monkeypatch.setattr(polygon, "run_polygon", warns)
    mine = warnings.showwarning
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert cli.main([*before, "polygon", "a.csv", "--terrain", "t.asc", "-o", "o.csv"]) == 0
        [line] = capsys.readouterr().err.splitlines()
    if before:
        assert json.loads(line)["level"] == "warning" and json.loads(line)["text"] == "two\tnumbers are one"
    else:
        assert line == "slope polygon: warning: two\tnumbers are one"
    assert warnings.showwarning is mine


# --- commands that take long ---

@pytest.mark.parametrize("command, word", [("verify", "01_restitution"), ("bench", "throughput"),
                                           ("crosscheck", "bounce")])
def test_a_bare_command_says_what_it_would_do(command, word, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    status, out, err = run_command(command, "", capsys)
    assert status == 0 and not err and word in out and "would" in out and f"slope {command} -o DIR" in out
    assert not list(tmp_path.iterdir())


# --- whose fault it is ---

def test_a_fault_of_the_page_is_no_bad_input(tmp_path, monkeypatch, capsys):
    class Broken:
        def __init__(self, _):
            pass

        def content(self):
            raise KeyError("cards")
    monkeypatch.setattr("slope_tools.report.page.Page", Broken)
    with pytest.raises(KeyError):
        document.make_page(document.Asked(tmp_path))


# --- the page ---

def test_that_a_road_has_no_crs_is_said_beside_the_maps_not_in_red(monkeypatch):
    sizes = "sizes of balls"
    several = [Finding("no CRS", {"file": "road.csv", "coordinates": "local"}, (), part) for part in ("", sizes)]
    several.append(finding("too few runs")._replace(part=sizes))
    for module, name in ((judged, "of_runs"), (judged, "limits"), (judged, "of_logs"),
                         (report_warnings, "below_ground"), (structures_part, "coarse_walls")):
        monkeypatch.setattr(module, name, lambda *_: [])
    data = SimpleNamespace(judged=[], repeats=[], study=made_study.study(warnings=several))
    found = report_warnings.rank_warnings(report_warnings.findings(data, None), {})
    assert [(level, text.count("too few runs")) for level, text in found] == [("warning", 1)]


@pytest.mark.parametrize("number", [MOST_ROWS, 96])
def test_of_very_many_runs_the_table_has_the_ends(number):
    volumes = [(37 * k) % 97 for k in range(number)]
    rows = [row(run=f"r{k}", remove_m3=volume) for k, volume in enumerate(volumes)]
    rows[3] = row(run="r3", status="failed")
    data = SimpleNamespace(rows=rows, finished=finished_of(rows))
    page = SimpleNamespace(data=data, counts=lambda: quantities.ALL["remove_m3"])
    found = Runs.in_table(page)
    if number == MOST_ROWS:
        assert found == rows and Runs.which_rows(page) == "All runs"
        return
    left = sorted(volume for k, volume in enumerate(volumes) if k != 3)
    assert [one.at_road.remove_m3 for one in found[:-1]] == [*left[:ENDS], *left[-ENDS:]] and found[-1] is rows[3]
    assert '96 runs' in Runs.which_rows(page) and '"to remove"' in Runs.which_rows(page)
