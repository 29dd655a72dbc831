"""Reach and area with the largest restitution: runs beside those of a site's study, none of which the volume is of."""
import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from affine import Affine

import made_rows
from made_rows import changed

from slope_tools.runs import jobs
from slope_tools.studies import site_study
from slope_tools.survey import rasters
from slope_tools.tables import elastic
from slope_tools.tables.study_types import ElasticQuantity, Span

VARIABLES = {"rolling": "0", "spacing": "0.9", "restitution": "0.48", "field_e": "0.1", "packing": "1"}
SET = {"rolling": "0", "spacing": "0.9"}


def row(here, name, distance, cells, variables, **more):
    """A finished run with a deposit that covers so many cells of 2 m."""
    thickness = np.zeros((5, 10))
    thickness.flat[:cells] = 0.3
    thickness.flat[40:] = elastic.THICK        # no more than that: not covered
    (here / name).mkdir()
    rasters.write_asc_local(here / name / "site.thickness.asc", rasters.Raster(
        thickness, Affine(2, 0, 0, 0, -2, 10), None), {"what": "thickness"})
    return made_rows.row(**{"run": name, "set": SET, "length_m": distance, "distance_99_m": distance,
                            "front_m": distance + 5, "variables": {**VARIABLES, **variables},
                            "summary": f"{name}/site.summary.yaml", **more})


@pytest.fixture
def rows(tmp_path):
    """Usual runs, the third with another rolling resistance, the fourth added by an ensemble."""
    smooth = {"rolling": "0.1"}
    return [row(tmp_path, "a", 80.0, 10, {}), row(tmp_path, "b", 90.0, 12, {"packing": "2"}, repeat={"packing": "2"}),
            row(tmp_path, "c", 95.0, 14, smooth, set={**SET, **smooth}), row(tmp_path, "d", 500.0, 30, {}, batch=1)]


def most(here, **more):
    high = {"restitution": "0.9", "field_e": "0.9"}
    return [row(here, f"e{k}", distance, cells, {**high, "packing": str(k)}, set={"rolling": "0", **high}, **more)
            for k, distance, cells in ((1, 100.0, 20), (2, 110.0, 22), (3, 120.0, 27))]


def evaluated(here, made, rows):
    return elastic.evaluate_elastic(elastic.read_elastic_runs(elastic.Made(0.9, "0", made), rows, here))


def test_reach_and_area_beside_the_usual_runs(tmp_path, rows):
    made = most(tmp_path)
    about = evaluated(tmp_path, made, rows)
    assert about.quantities["distance_99_m"] == ElasticQuantity(
        110, 100, 120, Span(85, 80, 90), Span(pytest.approx(265 / 3), 80, 95))
    assert about.quantities["area_m2"] == ElasticQuantity(92, 80, 108, Span(44, 40, 48), Span(48, 40, 56))
    assert about.text == (
        "restitution 0.9 of soil, slip surface and ground, rolling 0, 3 runs: 99 % of the volume stays within 110 m "
        "(100 to 120) instead of 85 m (80 to 90); all other runs, up to 95 m; the deposit covers 92 m2 (80 to 108) "
        "instead of 44 m2 (40 to 48); all other runs, up to 56 m2")
    text = elastic.tabulate_elastic(elastic.read_elastic_runs(elastic.Made(0.9, "0", made), rows, tmp_path))
    table = list(csv.DictReader(text.splitlines()))
    assert [(one["run"], one["largest_restitution"]) for one in table] == [
        ("e1", "yes"), ("e2", "yes"), ("e3", "yes"), ("a", "no"), ("b", "no"), ("c", "no")]
    assert [float(one["area_m2"]) for one in table] == [80, 88, 108, 40, 48, 56]


def test_what_left_the_terrain_is_no_distance(tmp_path, rows):
    about = evaluated(tmp_path, [changed(one, distance_99_m=None) for one in most(tmp_path)], rows)
    assert "how far the mass goes is not known, as more than 1 % of it left the terrain; the deposit" in about.text
    assert "distance_99_m" not in about.quantities


def test_failed_and_moving_runs_are_said(tmp_path, rows):
    made = most(tmp_path, at_rest=False)
    made[0] = made_rows.row(run="e1", status="failed", error="diverged")
    about = evaluated(tmp_path, made, rows)
    assert about.text.endswith("; 1 failed; 2 had not come to rest") and about.runs == ["e2", "e3"]
    none = evaluated(tmp_path, made[:1], rows)
    assert none.text == "not known: e1 failed"
    alone = evaluated(tmp_path, made[1:], [])        # none of the usual ones finished
    assert "instead of" not in alone.text and alone.quantities["distance_99_m"].usual is None


@pytest.mark.parametrize("largest, variables, expected", [
    (0.9, VARIABLES, {"0.9"}), (0.9, {**VARIABLES, "restitution": "0.95"}, {"0.95"}), (0.7, VARIABLES, {"0.7"}),
    (None, VARIABLES, set()), (0.9, {"rolling": "0", "restitution": "0.48"}, set())])
def test_runs(largest, variables, expected):
    """Never less elastic than the others; none where the deck does not know its ground's restitution."""
    setup = SimpleNamespace(runs=Path("runs"))
    runs = site_study.elastic_runs(setup, largest, ["0.05", "0", "0.1"], {"packing": ["2", "3"]}, variables)
    assert {one.chosen["restitution"] for one in runs} == {one.chosen["field_e"] for one in runs} == expected
    assert [one.chosen["rolling"] for one in runs] == ["0"] * 3 * bool(expected)
    assert {one.key for one in runs} == ({"base", "packing 2", "packing 3"} if expected else set())
    assert len({jobs.Run("runs", one.chosen).folder for one in runs}) == len(runs)
