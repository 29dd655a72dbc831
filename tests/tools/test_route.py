"""slope route and zones: the corridor, frequencies, what runs made by hand say of a road, wrong input, kills."""
import csv
import dataclasses
import html
import json
import math
import os
import resource
import shutil
import subprocess
import time
from pathlib import Path
from types import SimpleNamespace

import fiona
import numpy as np
import pytest
import rasterio
import yaml
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box, shape

import made_study
import route_stand_in
import run_helpers
import test_export
from run_helpers import TOOLS, called, write_asc
from tiny_collapse import rows_of

from slope_tools.errors import SlopeError
from slope_tools.findings import Finding
from slope_tools import disk, records
from slope_tools.case import run_folders
from slope_tools.commands import route as route_command
from slope_tools.route import choices, corridor, page as route_page, results, runs as route_runs, search, zones
from slope_tools.route.yearly import Yearly
from slope_tools.seismic import chain, fragility
from slope_tools.seismic.fragility_files import Fragility
from slope_tools.statistics import hazard
from slope_tools.survey import geopackage, rasters
from slope_tools.tables import road_runs

LMP = os.environ.get("LMP")
needs_lmp = pytest.mark.skipif(not LMP, reason="needs the LAMMPS program (LMP)")


# --- the corridor ---

def corridor_of(line, rows=40, columns=120, cell=5.0, reach=50.0):
    ground = route_stand_in.raster(np.zeros((rows, columns)), cell)
    return corridor.Corridor(ground, LineString(line), LineString(line).buffer(4, cap_style=2), 1000.0, reach)


def test_windows_overlap_by_half():
    one = corridor_of([(20, 100), (570, 100)])
    found = list(corridor.searches(one))
    assert len(found) == 10         # 550 m, 50 m steps, 100 m each
    spans = [(ground.bounds[0], ground.bounds[2]) for _, ground in found]
    assert spans[0] == pytest.approx((20, 120)) and spans[-1] == pytest.approx((470, 570))
    assert all(b[0] - a[0] == pytest.approx(50) for a, b in zip(spans[:-1], spans[1:]))
    assert all(ground.bounds[3] - ground.bounds[1] == pytest.approx(100) for _, ground in found)
    for window, ground in found:
        assert box(*run_helpers_extent(one.clip(window))).covers(ground)


def run_helpers_extent(raster):
    xlo, yhi = raster.transform @ (0, 0)
    xhi, ylo = raster.transform @ raster.z.shape[::-1]
    return xlo, ylo, xhi, yhi


def test_a_short_road_is_one_window():
    assert len(list(corridor.searches(corridor_of([(20, 100), (80, 100)])))) == 1


def test_the_ground_of_a_body_has_the_road_in_one_piece():
    """A hairpin, which leaves the ground around the body and comes back."""
    one = corridor_of([(20, 95), (300, 95), (300, 110), (60, 110)], reach=30.0)
    window, line, start = corridor.cut_window(one, 90, 120, 120, 150)
    inner = box(*run_helpers_extent(one.clip(window)))
    assert inner.covers(line) and line.length > 400 and one.axis.buffer(1e-6).covers(line)
    assert start == pytest.approx(1000 + one.axis.project(Point(line.coords[0])))


@pytest.mark.parametrize("line", [
    [(20, 2), (580, 2)], [(20, 0), (580, 0)],       # along the terrain's edge
    [(200, 95), (400, 95), (400, 2), (300, 2), (300, 80), (200, 80)]])      # a bend there
def test_a_road_at_the_edge_of_the_terrain(line):
    one = corridor_of(line)
    window, found, start = corridor.cut_window(one, 290, 105, 310, 125)
    assert box(*run_helpers_extent(one.clip(window))).covers(found) and found.length > 50
    assert start == pytest.approx(1000 + one.axis.project(Point(found.coords[0])))


def test_bodies_that_share_more_than_a_tenth_are_one():
    def slip(left, width):
        base = np.full((10, 40), np.nan)
        base[:, left:left + width] = 1.0
        return search.Slip(corridor.Window(0, 10, 10, 50), base, 1.0)
    assert search.shared(slip(0, 10), slip(9, 20)) == pytest.approx(0.1)
    assert search.shared(slip(0, 10), slip(8, 20)) > search.SHARED
    other = slip(0, 10)._replace(window=corridor.Window(0, 14, 10, 54))
    assert search.shared(slip(0, 10), other) == pytest.approx(0.6)      # 4 cells apart
    assert search.shared(slip(0, 10), slip(0, 10)._replace(window=corridor.Window(20, 10, 30, 50))) == 0


# --- frequencies ---

def of_capacity(capacity, peaks=(100.0, 300.0, 900.0), rates=(1e-2, 1e-3, 5e-5)):
    names = [str(k + 1) for k in range(capacity.shape[2])]
    return Fragility(Path("fragility"), names, names, capacity, np.array(peaks), fragility.Hazard(np.array(peaks),
                                                                                                  np.array(rates)), [])


@pytest.fixture(scope="module")
def capacity():
    """Three bodies, 16 x 64 strengths that all share, two records."""
    draw = np.random.default_rng(3)
    strength = draw.normal(0, 0.4, (1024, 1, 1))
    return np.exp(strength + draw.normal(0, 0.2, (1024, 2, 1)) + np.log([250.0, 400.0, 600.0]))


def test_one_body_is_its_frequency_times_its_share(capacity):
    found = of_capacity(capacity)
    yearly = Yearly(found)
    for k in range(3):
        mine = float(fragility.frequency(capacity[:, :, k], found.rate, found.peaks).total.value)
        for share in (1.0, 0.25):
            rate = yearly.of([k + 1], [share])
            assert rate.dependent == pytest.approx(share * mine, rel=1e-9)
            assert rate.independent == pytest.approx(share * mine, rel=1e-3)


def test_several_bodies_against_an_own_integral(capacity):
    """A sum over small steps of the hazard curve, with both limits of dependence counted sample by sample."""
    found, p = of_capacity(capacity), np.array([0.75, 0.25, 0.5])
    rate = Yearly(found).of([1, 2, 3], p)
    peaks = np.exp(np.linspace(np.log(100.0), np.log(900.0), 6001))
    rates = np.exp(np.interp(np.log(peaks), np.log(found.peaks), np.log(found.rate.rates)))
    each = capacity.reshape(-1, 3)
    independent = dependent = least = most = 0.0
    for a, step in zip(np.sqrt(peaks[:-1] * peaks[1:]), rates[:-1] - rates[1:]):
        fails = each < a
        independent += step * (1 - np.prod(1 - fails.mean(axis=0) * p))
        dependent += step * (fails * p).max(axis=1).mean()
        least += step * max(fails.mean(axis=0) * p)
        most += step * min(1.0, sum(fails.mean(axis=0) * p))
    fails = each < 900.0
    independent += rates[-1] * (1 - np.prod(1 - fails.mean(axis=0) * p))
    dependent += rates[-1] * (fails * p).max(axis=1).mean()
    least += rates[-1] * max(fails.mean(axis=0) * p)
    most += rates[-1] * min(1.0, sum(fails.mean(axis=0) * p))
    assert rate.least == pytest.approx(least, rel=2e-3) and rate.most == pytest.approx(most, rel=2e-3)
    assert rate.independent == pytest.approx(independent, rel=2e-3)
    assert rate.dependent == pytest.approx(dependent, rel=2e-3)
    assert rate.counts == rate.independent > rate.dependent


def test_the_chain_of_a_site_lies_between(capacity):
    """Bodies that fail together, runs that are independent: chain.py, of one sample's strength."""
    found = of_capacity(capacity)
    runs = [chain.compute_left_volume([1.0] * k + [0.0] * (4 - k), range(4), 1.0) for k in (3, 1, 2)]
    value = float(chain.frequency(capacity, found.rate, found.peaks, runs, np.zeros(1)).total.value[0])
    rate = Yearly(found).of([1, 2, 3], [0.75, 0.25, 0.5])
    assert rate.dependent < value < rate.independent


def test_bodies_that_exclude_each_other_are_within_the_bounds():
    """Of each two strengths one makes one body fail and the other the other: more often than independent ones."""
    one = np.tile([[[50.0, np.inf]], [[np.inf, 50.0]]], (512, 1, 1))
    rate = Yearly(of_capacity(one)).of([1, 2], [1.0, 1.0])
    assert rate.dependent == pytest.approx(rate.most) == pytest.approx(1e-2)        # these samples say so themselves
    assert rate.independent == pytest.approx(0.75e-2) and rate.least == pytest.approx(0.5e-2)
    other = Yearly(of_capacity(np.sort(one, axis=0))).of([1, 2], [1.0, 1.0])        # the same fragilities
    assert other.dependent == pytest.approx(0.5e-2) and other.counts == pytest.approx(0.75e-2)
    assert other.most == pytest.approx(1e-2)


def test_a_fragility_without_a_hazard_is_refused(capacity):
    with pytest.raises(SlopeError) as error:
        Yearly(of_capacity(capacity)._replace(rate=None))
    assert "--fragility" in str(error.value) and "--hazard" in str(error.value)


# --- results of runs made by hand ---

CELL = 5.0


def blob(rows, columns, r, c, value=1.0):
    z = np.zeros((rows, columns))
    z[r[0]:r[1], c[0]:c[1]] = value
    return z


@pytest.fixture
def two(tmp_path):
    """Two bodies, four runs each, on grids of their own beside each other; the road is 8 m wide at y = 50."""
    first = [blob(20, 30, (4, 14), (5, 10 + k)) for k in range(4)]
    second = [blob(16, 20, (4, 12), (2, 10), 0.05 if k == 0 else 2.0) for k in range(4)]
    return route_stand_in.make(tmp_path / "R", (40, 120), CELL, [
        ((60.0, 120.0), first, CELL, 10.0, 20.0, [[(20.0, 45.0)], [(20.0, 50.0)], [], [(20.0, 60.0)]]),
        ((100.0, 110.0), second, CELL, 45.0, 30.0, [[], [(55.0, 80.0)], [(55.0, 80.0)], [(90.0, 95.0)]])])


def made(folder, table, **more):
    asked = dataclasses.replace(choices.read_route_choices(folder), **more)
    ground = corridor.read_corridor(asked, folder)
    return results.make_route_results(asked, ground, folder, table), ground


def test_stretches_and_bodies(two):
    found, _ = made(*two)
    assert [(one["from"], one["to"]) for one in found["stretches"]] == [(20.0, 80.0), (90.0, 95.0)]
    one, other = found["stretches"][0]["bodies"]
    assert (one["body"], one["share"], other["body"], other["share"]) == (1, 0.75, 2, 0.5)
    low, high = hazard.share_bounds(3, 4)
    assert (one["share_low"], one["share_high"]) == pytest.approx((float(low), float(high)))
    # 95, 50, 5 % of lengths 25, 30, 0, 40
    assert one["length"] == [0.0, 25.0, 40.0] and one["remove"] == [0.0, 10.0, 40.0]
    assert found["route"]["share"] == 0.75 and found["route"]["per_year"] is None
    by_place = {(one["from"], one["to"]): (one["share"], one["body"]) for one in found["pieces"]}
    assert by_place[20.0, 45.0] == (0.75, 1) and by_place[50.0, 55.0] == (0.25, 1) and by_place[60.0, 80.0] == (0.5, 2)
    assert (45.0, 50.0) in by_place and (80.0, 90.0) not in by_place
    rows = rows_of(two[0] / results.STRETCHES)
    assert [(row["stretch"], row["body"]) for row in rows] == [("1", "1"), ("1", "2"), ("2", "2")]


def test_runs_under_a_condition_are_not_of_the_sample(two):
    path = two[0] / "bodies/1/ensemble/study.yaml"
    about = yaml.safe_load(path.read_text())
    about["runs"][3]["batch"] = 1
    path.write_text(yaml.safe_dump(about))
    found, _ = made(*two)
    assert (found["bodies"][0]["runs"], found["bodies"][0]["share_blocked"]) == (3, pytest.approx(2 / 3))


def test_mass_that_leaves_beside_the_road_is_said_with_what_is_blocked(two):
    """Of body 1 a twentieth left with the road ahead, and body 2 has a run that was cut: shares are least ones."""
    assert "at least" not in " ".join(route_page.sentences(made(*two)[0]))
    for body, about in ((1, {"left_before_road_m3": 50.0}), (2, {"at_rest": False})):
        path = two[0] / f"bodies/{body}/ensemble/study.yaml"
        study = yaml.safe_load(path.read_text())
        study["runs"][2].update(about)
        path.write_text(yaml.safe_dump(study))
    found, _ = made(*two)
    *answer, size = route_page.sentences(found)
    assert all("at least" in text for text in answer)
    balls = min(row.released_m3 / row.ball_m3 for body in two[1]["bodies"] for row in
                results.read_body(two[0], body).finished)
    assert size.startswith(f"bodies are computed with {balls:,.0f} balls or more; what finer ones")
    said = list(route_page.list_route_caveats(choices.read_route_choices(two[0]), found))
    assert said[0].startswith("body 1: 5 % of the released volume left the terrain before, beside or on the road")
    assert said[1].startswith("body 2: 1 of 4 runs failed or are not at rest"), said
    assert [row["left_share"] for row in rows_of(two[0] / results.BODIES)] == ["0.05", "0.0"]
    # one that failed counts with the one that was cut
    study["runs"][3] = {"run": "run_3", "set": {"rolling": "3"}, "repeat": {}, "batch": 0, "status": "failed",
                        "error": "lost atoms"}
    path.write_text(yaml.safe_dump(study))
    said = list(route_page.list_route_caveats(choices.read_route_choices(two[0]), made(*two)[0]))
    assert said[1].startswith("body 2: 2 of 4 runs failed or are not at rest"), said


def test_who_hits_what(two):
    found, ground = made(*two)
    folder = two[0]
    with rasterio.open(folder / results.MAP) as source:
        body, share, number, _ = source.read(masked=True)
        assert source.crs.to_epsg() == 6677
        cells = {name: source.index(run_helpers.EAST + x, run_helpers.NORTH + y) for name, (x, y) in {
            "first": (37.5, 82.5), "both": (72.5, 62.5), "second": (90.0, 72.5), "none": (300.0, 100.0)}.items()}
    assert (body[cells["first"]], share[cells["first"]], number[cells["first"]]) == (1, 1.0, 1)
    assert body.mask[cells["none"]]
    for name, (x, y) in {"both": (72.5, 62.5), "second": (90.0, 72.5)}.items():
        shares = shares_at(folder, x, y)
        assert share[cells[name]] == max(shares.values()) and number[cells[name]] == sum(v > 0 for v in shares.values())
    with fiona.open(folder / results.LAYERS, layer="hits") as layer:
        at = Point(run_helpers.EAST + 72.5, run_helpers.NORTH + 62.5)
        [hit] = [one["properties"] for one in layer if shape(one["geometry"]).contains(at)]
        assert layer.crs["init"] == "epsg:6677" if "init" in layer.crs else True
    assert dict(word.split(":") for word in hit["shares"].split()) == {
        str(one): f"{value:g}" for one, value in shares_at(folder, 72.5, 62.5).items() if value}
    assert fiona.listlayers(folder / results.LAYERS) == ["road", "stretches", "bodies", "bodies_along", "hits"]


def test_which_body_brings_most_to_each_ten_metres(two):
    """Means of 0, 5, 10, 15 m3 of each body, of which the first comes first; and of 4 and 8 m3."""
    found, ground = made(*two)
    wanted = [("20.0", "30.0", "1", 7.5, "1:7.5 2:7.5"), ("50.0", "60.0", "2", 8.0, "1:4 2:8")]
    assert [(row["from_m"], row["to_m"], row["body"], float(row["mean_m3"]), row["bodies"])
            for row in rows_of(two[0] / results.ALONG)] == wanted
    with fiona.open(two[0] / results.LAYERS, layer="bodies_along") as layer:
        first, second = layer
        assert first["properties"]["body"] == "1" and shape(second["geometry"]).length == pytest.approx(10)
        x, y = shape(second["geometry"]).centroid.coords[0]
        assert (x - run_helpers.EAST, y - run_helpers.NORTH) == pytest.approx((CELL + 55, 50))
    route_page.write_route_page(choices.read_route_choices(two[0]), ground, two[0], found, lambda said: None)
    assert "Which body brings most" in (two[0] / route_page.PAGE).read_text()
    # of runs that count differently, and of a body that is left behind
    one, other = road_runs.by_body({"a": [(3.0, [[0.0, 4.0]]), (1.0, [])], "b": [(0.5, [[0.0, 2.9], [10.0, 1.0]])]})
    assert (one["body"], one["mean_m3"], other["body"], other["to_m"]) == ("a", 3.0, "b", 20.0)


def shares_at(folder, x, y):
    """Own counts on a cell, from the rasters of the runs."""
    found = {}
    for one in (1, 2):
        values = []
        for k in range(4):
            with rasterio.open(folder / f"bodies/{one}/runs/run_{k}/run.max_thickness.asc") as source:
                row, column = source.index(x, y)
                inside = 0 <= row < source.height and 0 <= column < source.width
                values.append(bool(inside and source.read(1)[row, column] > 0.1))
        found[one] = float(np.mean(values))
    return found


def with_fragility(two, capacity, monkeypatch):
    """The same route with fragilities of its two bodies, read from nowhere."""
    found = of_capacity(capacity[:, :, :2])
    digests = [results.disk.sha256(two[0] / f"slips/{k}/body.{k}.base.asc") for k in (1, 2)]
    late = Finding("before the curve", {"which": "any body", "percent": 40, "least": 148}).entry()
    monkeypatch.setattr(results.fragility_files, "read_fragility",
                        lambda path: found._replace(bases=digests, warnings=[late]))
    asked = yaml.safe_load((two[0] / choices.NAME).read_text())
    (two[0] / choices.NAME).write_text(yaml.safe_dump({**asked, "fragility": "fragility"}))
    return found


def test_a_year_of_a_stretch(two, capacity, monkeypatch):
    with_fragility(two, capacity, monkeypatch)
    found, ground = made(*two)
    yearly = Yearly(of_capacity(capacity[:, :, :2]))
    year = found["stretches"][0]["per_year"]
    assert year["counts"] == yearly.of([1, 2], [0.75, 0.5]).counts == year["independent"]
    low, high = zip(*(hazard.share_bounds(k, 4) for k in (3, 2)))
    assert year["high"] == pytest.approx(yearly.of([1, 2], [float(one) for one in high]).most)
    assert year["low"] == pytest.approx(yearly.of([1, 2], [float(one) for one in low]).least)
    assert found["bodies"][0]["per_year"]["blocks"] == pytest.approx(
        0.75 * found["bodies"][0]["per_year"]["fails"], rel=1e-3)
    said = []
    route_page.write_route_page(choices.read_route_choices(two[0]), ground, two[0], found, said.append)
    page = (two[0] / route_page.PAGE).read_text()
    assert page.count("<figure>") == 2 and "0.020 to 0.080" in page and f"{year['counts']:.2g}" in page
    assert any("--sample" in one for one in said)
    [late] = [one for one in said if one.startswith("fragility: any body: 40 % of its frequency")]
    assert late in html.unescape(page) and "The route is blocked at least " in page


def test_a_fragility_of_other_bodies_is_refused(two, capacity, monkeypatch):
    with_fragility(two, capacity, monkeypatch)
    (two[0] / "slips/2/body.2.base.asc").write_text("other")
    with pytest.raises(SlopeError) as error:
        made(*two)
    assert "--fragility" in str(error.value) and "body 2" in str(error.value)


# --- zones ---

def zones_of(folder, capsys, *words):
    return called(capsys, ["export", str(folder), *words])


def test_zones_of_shares(two, capsys):
    folder = two[0]
    status, out, err = zones_of(folder, capsys, "--zones", "0.9,0.4", "--thicker", "0.5")
    assert status == 0, err
    with fiona.open(folder / "zones/zones.gpkg", layer="zones") as layer:
        assert rasterio.crs.CRS.from_wkt(layer.crs_wkt).to_epsg() == 6677
        found = [(shape(one["geometry"]), one["properties"]) for one in layer]
    bounds = {k: [float(side) for side in hazard.share_bounds(k, 4)] for k in range(5)}
    for x, y in ((37.5, 82.5), (62.5, 72.5), (72.5, 62.5), (150.0, 60.0)):
        shares = shares_at(folder, x, y)
        counts = [round(4 * value) for value in shares.values() if value]
        at = Point(run_helpers.EAST + x, run_helpers.NORTH + y)
        for p in (0.9, 0.4):
            low, high = (max((bounds[k][side] for k in counts), default=0.0) for side in (0, 1))
            wanted = [zones.AT_LEAST] if low >= p else [zones.UNSURE] if high >= p else []
            assert [one["class"] for area, one in found if one["probability"] == p and area.contains(at)] == wanted
    about = yaml.safe_load((folder / "zones/zones.yaml").read_text())
    for entry in about["zones"]:
        for kind, key in ((zones.AT_LEAST, "at_least_m2"), (zones.UNSURE, "cannot_tell_m2")):
            mine = [(area, one) for area, one in found if (one["probability"], one["class"]) == (
                entry["probability"], kind)]
            assert entry[key] == pytest.approx(sum(one["cells"] for _, one in mine) * CELL ** 2)
            for area, one in mine:      # a ring has four corners more to one side than to the other
                rings = 1 - len(area.interiors)
                assert area.area == pytest.approx(one["area_m2"] - rings * CELL ** 2 / 2) and area.is_valid
    assert {one["class"] for _, one in found} == {zones.AT_LEAST, zones.UNSURE}
    assert about["per_year"] is False and about["runs"] == 8


def test_zones_are_said_to_end_where_mass_left_the_terrain(two, capsys):
    """The terrain of a body's runs ends before the corridor does, which the zones are of."""
    assert "left the grid" not in zones_of(two[0], capsys, "--zones", "0.5")[2]
    path = two[0] / "bodies/2/ensemble/study.yaml"
    about = yaml.safe_load(path.read_text())
    about["runs"][1].update(lost_m3=300.0, on_grid_m3=700.0)
    path.write_text(yaml.safe_dump(about))
    status, _, err = zones_of(two[0], capsys, "--zones", "0.5", "--overwrite")
    assert status == 0 and "body 2: 300 m3 (30 % of the released volume) left the grid or the box" in err, err
    [doubt] = yaml.safe_load((two[0] / "zones/zones.yaml").read_text())["doubts"]
    assert doubt["kind"] == "lost much" and doubt["part"] == "body 2"
    # and where runs were cut, of which the maps show the way until then
    about["runs"][1].update(at_rest=False, moving=True, moves_share=0.6, stop_time_s=12.0, end="cut")
    path.write_text(yaml.safe_dump(about))
    status, _, err = zones_of(two[0], capsys, "--zones", "0.5", "--overwrite")
    assert status == 0 and "body 2: not at rest at the end: cut, at 12.0 s" in err, err
    doubts = yaml.safe_load((two[0] / "zones/zones.yaml").read_text())["doubts"]
    assert [one["kind"] for one in doubts] == ["lost much", "in motion"]


@pytest.mark.parametrize("quantity, told", [("energy:1,1e3", True), ("speed:1,5", False), ("thickness:0.5", False)])
def test_zones_of_the_energy_of_a_ball_are_no_classes_of_intensity(two, capsys, quantity, told):
    """They shrink with finer balls, of which the route's have a volume."""
    for path in two[0].glob("bodies/*/runs/*/*.max_thickness.asc"):
        for kind in ("max_energy", "max_speed"):
            shutil.copy(path, path.with_name(path.name.replace("max_thickness", kind)))
    status, _, err = zones_of(two[0], capsys, "--zones", "0.5", "--intensity", quantity, "--overwrite")
    assert status == 0 and ("energy is that of one ball of the model, of " in err) is told, err
    doubts = yaml.safe_load((two[0] / "zones/zones.yaml").read_text())["doubts"]
    assert [one["kind"] for one in doubts] == ["energy of balls"] * told


@pytest.mark.parametrize("words, got", [
    ("1/100,1/1000", "1/100"), ("0.5,1/100", "1/100"), ("1/2", "1/2"), ("0.01,0.001", "0.01 and 0.001"),
    ("0.5,1e-3,1e-4", "0.001 and 0.0001")])
def test_shares_do_not_read_like_return_periods(two, capsys, words, got):
    status, out, err = zones_of(two[0], capsys, "--zones", words)
    assert (status, out, err.count("\n")) == (2, "", 1) and err.rstrip().endswith(f"got {got}"), err
    assert "--zones" in err and "runs" in err and not (two[0] / "zones").exists()
    assert ("--fragility" in err) == ("/" in got)


def test_one_share_may_stand_for_all_runs(two, capsys):
    assert zones_of(two[0], capsys, "--zones", "0.5,0.001")[0] == 0
    few, every = yaml.safe_load((two[0] / "zones/zones.yaml").read_text())["zones"]
    assert every["at_least_m2"] > few["at_least_m2"] and every["cannot_tell_m2"] == 0


@pytest.mark.parametrize("other", [
    "--zones 0.9", "--zones 0.9,0.3", "--zones 0.9,0.4 --thicker 0.5", "--zones 0.9,0.4 --intensity speed:1",
    "--zones 0.9,0.4 --intensity thickness:0.1,1"])
def test_zones_of_another_question_are_kept(two, capsys, other):
    path = two[0] / "zones/zones.yaml"
    assert zones_of(two[0], capsys, "--zones", "0.9,0.4")[0] == 0
    before = path.read_bytes(), (two[0] / "zones/zones.gpkg").read_bytes()
    status, _, err = zones_of(two[0], capsys, *other.split())
    assert status == 2 and err.count("\n") == 1 and "--overwrite" in err and "zones.gpkg" in err, err
    assert (path.read_bytes(), (two[0] / "zones/zones.gpkg").read_bytes()) == before
    assert zones_of(two[0], capsys, "--zones", "0.9,0.4")[0] == 0       # the same question again


def test_zones_of_shares_are_not_those_per_year(two, capsys, capacity, monkeypatch):
    assert zones_of(two[0], capsys, "--zones", "0.002")[0] == 0
    with_fragility(two, capacity, monkeypatch)
    status, _, err = zones_of(two[0], capsys, "--zones", "0.002")
    assert status == 2 and "per year" in err and "--overwrite" in err


def test_beside_the_zones_runs_may_not_tell(two, capsys, capacity, monkeypatch):
    """Four runs of which none comes leave a share of 0.53, and of the frequencies of all bodies that of their sum."""
    none = float(hazard.share_bounds(0, 4)[1])
    for words, said in (("0.9", False), ("0.9,0.5", True)):
        status, out, err = zones_of(two[0], capsys, "--zones", words, "--overwrite")
        assert status == 0 and ("where no run comes" in out and f"{none:.2g}" in out) is said, out
    about = yaml.safe_load((two[0] / "zones/zones.yaml").read_text())
    assert about["unreached_at_most"] == pytest.approx(none)
    with_fragility(two, capacity, monkeypatch)
    assert zones_of(two[0], capsys, "--zones", "1/1000", "--overwrite")[0] == 0
    most = Yearly(of_capacity(capacity[:, :, :2])).of([1, 2], [none, none]).most
    about = yaml.safe_load((two[0] / "zones/zones.yaml").read_text())
    assert about["unreached_at_most"] == pytest.approx(1 - math.exp(-most))


def test_a_point_says_which_body_governs_each_part_of_a_zone(two, capsys):
    """Both bodies lie side by side: what governs is by hand from the rasters, at each point and in all of its part."""
    folder = two[0]
    assert zones_of(folder, capsys, "--zones", "0.4,0.2", "--thicker", "0.5")[0] == 0
    areas, points = ([(shape(one["geometry"]), one["properties"]) for one in fiona.open(
        folder / "zones/zones.gpkg", layer=name)] for name in (zones.LAYER, zones.PROCESS))
    assert {(one["body"], one["probability"]) for _, one in points} == {(1, 0.4), (1, 0.2), (2, 0.2)}
    for at, one in points:
        x, y = at.x - run_helpers.EAST, at.y - run_helpers.NORTH
        shares = shares_at(folder, x, y)
        assert one["body"] == max(shares, key=shares.get) and one["known_events"] == "landslides"
        assert (one["quantity"], one["exceeds"], one["return_period"]) == ("thickness", 0.5, None)
        assert any(area.contains(at) for area, zone in areas
                   if zone["class"] == zones.AT_LEAST and zone["probability"] == one["probability"])
    for p in (0.4, 0.2):
        assert sum(one["area_m2"] for _, one in points if one["probability"] == p) == pytest.approx(sum(
            zone["area_m2"] for _, zone in areas if (zone["class"], zone["probability"]) == (zones.AT_LEAST, p)))


def test_zones_have_a_style(two, capsys):
    assert zones_of(two[0], capsys, "--zones", "0.9,0.4")[0] == 0
    with fiona.open(two[0] / "zones/zones.gpkg", layer=geopackage.STYLES) as layer:
        [style] = [one["properties"] for one in layer]
    assert (style["f_table_name"], style["f_geometry_column"]) == ("zones", "geom") and style["useAsDefault"]
    import xml.etree.ElementTree as tree
    root = tree.fromstring(style["styleQML"].split("\n", 1)[1])
    rules = root.findall(".//rule")
    assert len(rules) == 4 and {one.get("symbol") for one in rules} == {one.get("name") for one in root.findall(
        ".//symbol")}
    assert '"probability" = 0.4' in "".join(one.get("filter") for one in rules)


def test_corners_are_cut_at_half_a_cell():
    area = box(0, 0, 30, 30).difference(box(10, 10, 20, 20)).union(box(30, 0, 40, 10))
    found = zones.smoothed(area, 10.0)
    assert found.area == pytest.approx(area.area - 50 + 50) and found.hausdorff_distance(area) < 5
    assert zones.smoothed(box(0, 0, 10, 10), 10.0).area == pytest.approx(50)


def test_zones_per_year(two, capsys, capacity, monkeypatch):
    found = with_fragility(two, capacity, monkeypatch)
    yearly = Yearly(found)
    status, _, err = zones_of(two[0], capsys, "--zones", "1/500,1/1000,1/5000", "--intensity", "thickness:0.5,1.5")
    assert status == 0, err
    with fiona.open(two[0] / "zones/zones.gpkg", layer="zones") as layer:
        several = [(shape(one["geometry"]), one["properties"]) for one in layer]
    at = Point(run_helpers.EAST + 37.5, run_helpers.NORTH + 82.5)      # body 1 alone, all four runs, 1 m
    low, high = (1 - math.exp(-yearly.of([1], [float(side)]).counts) for side in hazard.share_bounds(4, 4))
    for p in (1 / 500, 1 / 1000, 1 / 5000):
        wanted = [zones.AT_LEAST] if low >= p else [zones.UNSURE] if high >= p else []
        here = [one for area, one in several if abs(one["probability"] / p - 1) < 1e-9 and area.contains(at)]
        assert [(one["class"], one["exceeds"]) for one in here] == [(kind, 0.5) for kind in wanted]
        assert all(one["return_period"] == pytest.approx(1 / p) for one in here)


def test_zones_of_a_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run_helpers.write_sidecar(20, 30, 5.0)
    z = blob(20, 30, (4, 14), (5, 12))
    run_helpers.write_run(z, 10.0, 5.0, "run")
    write_asc("run.max_thickness.asc", z, 5.0)
    assert zones_of("run", capsys, "--zones", "0.04")[0] == 0
    about = yaml.safe_load(Path("run.zones/zones.yaml").read_text())
    assert about["zones"][0]["at_least_m2"] == 70 * 25 and about["runs"] == 1     # 0.05 of one run are sure


@pytest.mark.parametrize("command", [one for one in test_export.EXAMPLES if "--zones" in one])
def test_every_example_of_zones_runs(two, capsys, monkeypatch, command):
    monkeypatch.chdir(two[0].parent)
    name, *words = command.split()
    two[0].rename(name)
    status, _, err = zones_of(name, capsys, *words)
    assert (status, err) == (0, "") and len(list(Path().glob("**/zones.gpkg"))) == 1


@pytest.mark.parametrize("words, said", [
    (["--zones", "0.1,0.5"], ("--zones", "fall", "0.1,0.5")), (["--zones", "1/100,1/100"], ("--zones", "fall")),
    (["--zones", "1.5"], ("--zones", "1.5")), (["--zones", "x"], ("--zones", "x")),
    (["--zones", "1/0"], ("--zones", "1/0")),
    (["--zones", "0.5/"], ("--zones", "0.5/")), (["--thicker", "1"], ("--thicker", "--zones")),
    (["--intensity", "speed:1"], ("--intensity", "--zones")),
    (["--zones", "0.5", "--thicker", "-1"], ("--thicker", "-1")),
    (["--zones", "0.5", "--intensity", "height:1"], ("--intensity", "height:1")),
    (["--zones", "0.5", "--intensity", "speed:5,1"], ("--intensity", "rise", "speed:5,1")),
    (["--zones", "0.5", "--intensity", "speed:1", "--thicker", "1"], ("--thicker", "--intensity")),
    (["--zones", "0.5", "--terrain", "t.asc"], ("--terrain", "--zones"))])
def test_wrong_zones(two, capsys, words, said):
    status, out, err = zones_of(two[0], capsys, *words)
    assert status == 2 and err.count("\n") == 1 and all(one in err for one in said), err
    assert not (two[0] / "zones").exists()


def test_a_hazard_that_does_not_reach(two, capsys, capacity, monkeypatch):
    with_fragility(two, capacity, monkeypatch)
    for words in ("1/100,1/50000", "1/50,1/1000"):
        status, _, err = zones_of(two[0], capsys, "--zones", words)
        assert status == 2 and err.count("\n") == 1 and "--zones" in err and "5e-05 to 0.00995" in err, err


# --- a long road ---

LONG = """
import sys, numpy as np
sys.path[:0] = [{tools!r}, {tests!r}]
from pathlib import Path
import route_stand_in
from slope_tools.route import choices, corridor, page as route_page, results
draw = np.random.default_rng(1)
bodies = []
for k in range(300):
    x = 100.0 + 132.0 * k
    several = [np.pad(np.ones((10 + k, 20 + k)), ((0, 30 - k), (0, 20 - k))) for k in range(4)]
    at = x - 60.0 + 40.0 * draw.random(4)
    bodies.append(((x, 120.0), several, 5.0, 5 * round((x - 100) / 5), 20.0, [[(a, a + 60.0)] for a in at.tolist()]))
folder, table = route_stand_in.make(Path({folder!r}), (80, 8000), 5.0, bodies)
asked = choices.read_route_choices(folder)
ground = corridor.read_corridor(asked, folder)
found = results.make_route_results(asked, ground, folder, table)
route_page.write_route_page(asked, ground, folder, found, print)
"""


@pytest.mark.long
def test_a_long_road(tmp_path):
    """40 km, 300 bodies: below 4 GB, the page below 20 MB."""
    folder = tmp_path / "R"
    code = LONG.format(tools=str(TOOLS), tests=str(Path(__file__).parent), folder=str(folder))
    done = subprocess.run(["/usr/bin/python3", "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 4e6      # kB
    page = (folder / route_page.PAGE).stat().st_size
    assert 1e5 < page < 20e6
    about = yaml.load((folder / results.RESULTS).read_text(), yaml.CSafeLoader)
    assert len(about["bodies"]) == 300 and about["chainage_m"][1] == pytest.approx(39990.0)


# --- real runs ---

ROUTE = ("--terrain dem.asc --crs EPSG:6677 --road axis.csv --road-width 8 --corridor 60 --cohesion 9e3 --friction 30 "
         "--density 1900 --bodies slides.geojson --balls 40 --sample 3 --lane 4").split()


@pytest.fixture
def slope(tmp_path, monkeypatch):
    """A plane slope of 30 degrees above a road, and two bodies on it, given as polygons."""
    monkeypatch.chdir(tmp_path)
    y = 3.0 * (39.5 - np.arange(40))
    write_asc("dem.asc", np.add.outer(np.round(0.6 * np.clip(y - 35, 0, 50), 3), np.zeros(70)), 3.0)
    Path("axis.csv").write_text("6,25\n110,25\n204,25\n")
    slides([((40, 45), 4.0), ((150, 45), 3.0)])
    return tmp_path


def slides(several):
    features = [{"type": "Feature", "properties": {"depth": depth},
                 "geometry": box(x, y, x + 24, y + 24).__geo_interface__} for (x, y), depth in several]
    Path("slides.geojson").write_text(json.dumps({
        "type": "FeatureCollection", "features": features,
        "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::6677"}}}))


# --- bodies that are given: their attributes and geometries ---

PLACES = (40, 45), (150, 45)


def bodies_file(*several, geometries=None):
    """slides.geojson with a feature of each of these attributes; geometries: of some of them, others are squares."""
    features = []
    for k, (about, (x, y)) in enumerate(zip(several, PLACES)):
        own = (geometries or {}).get(k, box(x, y, x + 24, y + 24))
        features.append({"type": "Feature", "properties": about, "geometry": own and own.__geo_interface__})
    Path("slides.geojson").write_text(json.dumps({
        "type": "FeatureCollection", "features": features,
        "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::6677"}}}))


def given_bodies(**more):
    asked = dataclasses.replace(choices.Choices(["dem.asc"], "axis.csv", 8.0, 60.0, 9e3, 30.0, 1900.0, crs="EPSG:6677",
                                                bodies="slides.geojson"), **more)
    said = []
    Path("R").mkdir(exist_ok=True)
    return search.given(asked, corridor.make_corridor(asked, Path("R"), lambda _: None, lambda _: None),
                        said.append), said


@pytest.mark.parametrize("about, got", [
    ({"depth": "6,0"}, "depth must be a number of m > 0, with a decimal point and without a unit, got 6,0"),
    ({"depth": "6 m"}, "got 6 m"), ({"depth": "nan"}, "got nan"), ({"depth": -3.0}, "got -3"),
    ({"depth": 0}, "got 0"), ({"depth": "inf"}, "got inf"), ({"depth": True}, "got True"), ({"depth": [5]}, "depth"),
    ({"volume": "1.200,5"}, "volume must be a number of m3 > 0"),
    ({"depth": 3.0, "volume": 900.0}, "must have one attribute, depth or thickness (m), or volume (m3)"),
    ({"depth": None}, "must have one attribute, depth or thickness (m), or volume (m3)"),
    ({"Depth": "six"}, "got six"), ({"thickness": "1.5 m"}, "thickness must be a number of m > 0"),
    ({"depth": ""}, "must have one attribute"),
    ({"depth": 1e6}, "depth: must be at most"), ({"volume": 1e9}, "volume: must be at most"),
    ({"volume": 0.1}, "must hold a body"), ({"volume": 4.0}, "below the ground somewhere")])
def test_an_attribute_that_is_no_size(slope, about, got):
    bodies_file(about)
    with pytest.raises(SlopeError) as error:
        given_bodies()
    line = str(error.value)
    assert line.startswith("slides.geojson: feature 1: ") and got in line, line


def test_a_size_may_be_text(slope):
    bodies_file({"depth": "4.0"}, {"depth": " 3 "})
    found, _ = given_bodies()
    bodies_file({"depth": 4.0}, {"depth": 3})
    for one, other in zip(found, given_bodies()[0], strict=True):
        assert np.array_equal(one.base, other.base, equal_nan=True) and one.factor == other.factor


def test_a_feature_without_a_geometry_is_left_out(slope):
    bodies_file({"depth": 4.0}, {"depth": 3.0}, geometries={0: None})
    found, said = given_bodies()
    assert [one.name for one in found] == ["feature 2"]
    [warning] = [one for one in said if one.kind == "no geometry"]
    assert "slides.geojson: feature 1 has no geometry (1 of 2" in str(warning)
    bodies_file({"depth": 4.0}, geometries={0: None})
    with pytest.raises(SlopeError, match="slides.geojson: must hold polygons, none of its features has a geometry"):
        given_bodies()


@pytest.mark.parametrize("geometry, said", [
    (MultiPolygon([box(120, 45, 140, 69), box(150, 45, 174, 69)]), "must be one polygon"),
    (box(150, 45, 152, 47), "must hold at least 9 centres of the cells of the terrain"),
    (box(190, 45, 260, 69), "must stay at least 2 cells away from NODATA and from the edge of the terrain"),
    (box(5000, 45, 5020, 69), "must overlap the terrain"), (box(150, 9, 174, 24), "the ground in it must fall"),
    (LineString([(150, 45), (170, 60)]), "must be a polygon"), (Point(150, 45), "must be a polygon"),
    (Polygon([(150, 45), (174, 69), (174, 45), (150, 69)]), "must be polygons that do not cross or touch themselves")])
def test_a_geometry_that_is_no_body(slope, geometry, said):
    """The line names the file and the feature, and no file of ours."""
    bodies_file({"depth": 4.0}, {"depth": 3.0}, geometries={1: geometry})
    with pytest.raises(SlopeError) as error:
        given_bodies()
    line = str(error.value)
    assert line.startswith("slides.geojson: feature 2: ") and said in line, line
    assert not any(word in line for word in ("/tmp", "polygon.geojson", "--assign-crs EPSG:n;"))


def test_a_ground_that_bulges(slope):
    """No sphere through toe and shoulder is so shallow: the line names feature, attribute and the least depth."""
    y = 3.0 * (39.5 - np.arange(40))
    write_asc("dem.asc", np.add.outer(30 * np.sin(np.clip((y - 35) / 50, 0, 1) * np.pi / 2), np.zeros(70)), 3.0)
    bodies_file({"depth": 4.0}, {"depth": 0.001}, geometries={k: box(x, 37, x + 24, 84) for k, (x, _) in enumerate(
        PLACES)})
    with pytest.raises(SlopeError) as error:
        given_bodies()
    line = str(error.value)
    assert line.startswith("slides.geojson: feature") and ": depth: must be at least" in line, line
    assert "--shape slab" in line


def test_bodies_of_a_thickness(slope):
    """As release features of AvaFrame and RAMMS: a slab of it, in all parts of a feature."""
    parts = MultiPolygon([box(120, 45, 132, 69), box(138, 45, 150, 69)])
    bodies_file({"depth": 4.0}, {"Thickness": 1.5}, geometries={1: parts})
    found, _ = given_bodies(shape="slab", cohesion=None, friction=None)
    assert found[1].mask.sum() * 9 == pytest.approx(parts.area)
    for one, depth in zip(found, (4.0, 1.5)):
        z = rasters.read_asc_local("R/terrain.asc").z[one.window.part]
        assert (z - one.base)[one.mask] == pytest.approx(depth, abs=1e-3)
    bodies_file({"depth": 4.0}, {"thickness": 1.5})
    assert len(given_bodies(shape="slbl")[0]) == 2


def test_heights_are_taken_as_slope_terrain_takes_them(slope):
    """In feet, with another value of no height, and of two models whose heights differ."""
    def terrain(*more, **given):
        shutil.rmtree("R", ignore_errors=True)
        assert given.keys() <= {field.name for field in dataclasses.fields(route_command.Request)}
        asked = choices.settle(Path("R"), {
            "terrain": ["dem.asc", *more], "road": "axis.csv", "road_width": 8.0, "corridor": 60.0, "density": 1900.0,
            "bodies": "slides.geojson", "crs": "EPSG:6677", **given})
        corridor.make_corridor(asked, Path("R"), lambda _: None, lambda _: None)
        return rasters.read_asc_local("R/terrain.asc").z

    usual = terrain()
    assert terrain(z_unit="ft") == pytest.approx(0.3048 * usual, abs=1e-3)
    top = usual == usual.max()
    assert np.array_equal(np.isnan(terrain(nodata=[float(usual.max())])), top) and 0 < top.sum() < usual.size
    lines = Path("dem.asc").read_text().splitlines()
    higher = [" ".join(f"{float(word) + 9:g}" for word in line.split()) for line in lines[6:]]
    Path("other.asc").write_text("\n".join([*lines[:6], *higher]) + "\n")
    with pytest.raises(SlopeError, match="--differ"):
        terrain("other.asc")
    assert np.isfinite(terrain("other.asc", differ=20.0)).all()


def test_given_bodies_need_no_strength(slope):
    bodies_file({"depth": 4.0}, {"depth": 3.0})
    found, _ = given_bodies(cohesion=None, friction=None)
    assert [one.factor for one in found] == [None, None]
    assert all(one.factor > 0 for one in given_bodies()[0])


@pytest.mark.parametrize("given, said", [
    ({}, "--cohesion: must be given, unless --bodies are"),
    ({"friction": 30.0}, "--cohesion: must be given with --friction"),
    ({"cohesion": 9e3, "bodies": "slides.geojson"}, "--friction: must be given with --cohesion")])
def test_a_search_needs_strengths(tmp_path, given, said):
    first = {"terrain": ["dem.asc"], "road": "axis.csv", "road_width": 8.0, "corridor": 60.0, "density": 1900.0}
    with pytest.raises(SlopeError) as error:
        choices.settle(tmp_path / "R", {**first, **given})
    assert str(error.value) == said and not (tmp_path / "R").exists()
    assert choices.settle(tmp_path / "R", {**first, "bodies": "slides.geojson"}).cohesion is None
    assert choices.read_route_choices(tmp_path / "R").friction is None


def test_the_page_of_bodies_without_a_factor(two):
    table = yaml.safe_load((two[0] / choices.TABLE).read_text())
    for one in table["bodies"]:
        one["factor"] = None
    found, ground = made(two[0], table)
    route_page.write_route_page(choices.read_route_choices(two[0]), ground, two[0], found, lambda _: None)
    assert "None" not in (two[0] / route_page.PAGE).read_text()
    assert [row["factor"] for row in csv.DictReader((two[0] / results.BODIES).read_text().splitlines())] == ["", ""]


@pytest.mark.parametrize("factor", [math.inf, math.nan])
def test_a_body_that_nothing_drives_has_no_factor_and_every_table_says_why(two, factor):
    table = yaml.safe_load((two[0] / choices.TABLE).read_text())
    table["bodies"][1].update(search.make_factor_entry(factor))
    why = table["bodies"][1]["no_factor"]
    disk.write_yaml(two[0] / choices.TABLE, table, "a route")
    found, ground = made(two[0], search.table_of(two[0]))
    route_page.write_route_page(choices.read_route_choices(two[0]), ground, two[0], found, lambda _: None)
    assert f">{why}<" in (two[0] / route_page.PAGE).read_text()
    for name in (results.BODIES, results.STRETCHES):
        rows = list(csv.DictReader((two[0] / name).read_text().splitlines()))
        assert {(row["body"], row["factor"], row["no_factor"]) for row in rows} == {("1", "1.2", ""), ("2", "", why)}
    with fiona.open(two[0] / results.LAYERS, layer="bodies") as layer:
        assert [(one["properties"]["factor"], one["properties"]["no_factor"]) for one in layer] == [
            (1.2, ""), (None, why)]


@pytest.mark.parametrize("name, value", [("lane", 4.0), ("clearing", 60.0), ("blocked", 0.5), ("mesh", 5.0),
                                         ("cut_angle", 35.0), ("name", "A route")])
def test_what_runs_do_not_depend_on_may_be_given_later(two, name, value):
    more = {"clearing": {"loosening": 1.3}}.get(name, {})
    assert getattr(choices.settle(two[0], {name: value, **more}), name) == value
    assert getattr(choices.read_route_choices(two[0]), name) == value


def route_of(capsys, *words):
    return called(capsys, ["route", "R", *words])


def slurm(folder, monkeypatch):
    """Programs in place of Slurm's: each array is done at once."""
    folder.mkdir()
    sbatch = """for word; do case $word in --array=*) range=${word#--array=};; esac; script=$word; done
echo $range >> CALLS
for ((i = 0; i <= ${range#0-}; i++)); do SLURM_ARRAY_TASK_ID=$i bash "$script"; done
echo 7
"""
    for name, text in {"sbatch": sbatch, "squeue": "", "scancel": ""}.items():
        (folder / name).write_text("#!/bin/bash\n" + text.replace("CALLS", str(folder / "calls")))
        (folder / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")


def without_times(path):
    rows = list(csv.DictReader(Path(path).read_text().splitlines()))
    assert rows
    return [{key: value for key, value in row.items() if key != "wall_s"} for row in rows]


@pytest.mark.long
@needs_lmp
def test_a_body_alone_is_that_of_a_site(slope, capsys, monkeypatch):
    status, out, err = route_of(capsys, *ROUTE)
    assert status == 0, err
    about = yaml.safe_load(Path("R/results.yaml").read_text())
    assert [one["body"] for one in about["bodies"]] == [1, 2]
    assert [one["chainage_m"] for one in about["bodies"]] == pytest.approx([46, 156], abs=2)
    assert all(one["runs"] == 3 and one["volume_m3"] > 100 for one in about["bodies"])
    start = yaml.safe_load(Path("R/bodies.yaml").read_text())["bodies"][1]["road_from_m"] / 1000
    words = ("site --terrain R/slips/2/terrain.asc --scar R/slips/2/body.2.base.asc --scar-is surface --road "
             f"R/slips/2/road.csv --road-width 8 --lane 4 --density 1900 --balls 40 --road-from {start} -o alone")
    assert called(capsys, words.split())[0] == 0
    words = "study alone --levels 1 --sample 3 --seed 2 --vary rolling=0:0.1 --vary packing=1:1000000"
    status, _, err = called(capsys, words.split())
    assert status == 0, err
    assert without_times("alone/ensemble/study.csv") == without_times("R/bodies/2/ensemble/study.csv")
    # slope fragility takes the folder; without a hazard the route does not take that
    status, _, err = called(capsys, "fragility R --density 1900 --cohesion 5e3:15e3 --friction 25:35 --peaks 100:1200 "
                            "--pseudo-static 0.65 --sample 256 -o fragility".split())
    assert status == 0, err
    fragile = yaml.safe_load(Path("fragility/fragility.yaml").read_text())["bodies"]
    volumes = [one["volume_m3"] for one in about["bodies"]]
    assert [one["volume_m3"] for one in fragile] == pytest.approx(volumes, rel=0.01)
    status, _, err = route_of(capsys, "--fragility", "fragility")
    assert status == 2 and "--hazard" in err
    kept = Path("R/route.yaml").read_text()
    assert "fragility: null" in kept
    Path("R/route.yaml").write_text(kept.replace("fragility: null", "fragility: gone"))
    assert [route_of(capsys)[0] for _ in range(2)] == [2, 2] and "fragility: gone" in Path("R/route.yaml").read_text()
    Path("R/route.yaml").write_text(kept)
    # with more runs only these are made
    made_ = {path: path.stat().st_mtime for path in Path("R/bodies").glob("*/runs/*/*.summary.yaml")}
    slurm(slope / "slurm", monkeypatch)
    assert route_of(capsys, "--sample", "4", "--engine", "slurm")[0] == 0
    assert Path("slurm/calls").read_text().split() == ["0-1"]       # one array for the runs of both bodies
    assert {path: path.stat().st_mtime for path in made_} == made_
    assert len(list(Path("R/bodies").glob("*/runs/*/*.summary.yaml"))) == len(made_) + 2 == 8


@pytest.mark.long
@needs_lmp
def test_a_lane_later_is_evaluated_without_new_runs(slope, capsys):
    """Of a body without strengths; page, tables and the body's own site have it."""
    slides([((40, 45), 4.0)])
    words = [word for word in ROUTE if word not in ("--cohesion", "9e3", "--friction", "30", "--lane", "4")]
    status, out, err = route_of(capsys, *words)
    assert status == 0 and "factor of safety" not in out, err
    runs_ = {path: path.stat().st_mtime for path in Path("R/bodies").glob("*/runs/*/finished.yaml")}
    [before] = csv.DictReader(Path("R/stretches.csv").read_text().splitlines())
    assert len(runs_) == 3 and before["remove_lane_50"] == before["factor"] == ""
    assert route_of(capsys, "--lane", "4", "--name", "Later")[0] == 0
    assert {path: path.stat().st_mtime for path in runs_} == runs_
    [after] = csv.DictReader(Path("R/stretches.csv").read_text().splitlines())
    assert 0 < float(after["remove_lane_50"]) < float(after["remove_50"]) == float(before["remove_50"])
    site = yaml.safe_load(Path("R/bodies/1/site.yaml").read_text())
    assert site["road"]["lane"] == 4 and site["project"]["name"].startswith("Later, ")
    assert "its runs are evaluated" not in route_of(capsys)[1]
    disk.write_file(Path("R/bodies/1/ensemble") / route_runs.EVALUATED, "of another version")
    assert "its runs are evaluated" in route_of(capsys)[1]


@pytest.mark.parametrize("tools, collected", [(None, False), ("of another version", False), ("of this one", True)])
def test_what_another_version_evaluated_is_evaluated_again(two, monkeypatch, tools, collected):
    monkeypatch.setattr(route_runs.kept, "tools", lambda: "of this one")
    output = two[0] / "bodies/1/ensemble"
    todo = [SimpleNamespace(folder=Path(f"run_{k}"), name=f"run_{k}", error=None) for k in range(4)]
    asked = route_runs.Asked(SimpleNamespace(output=output, road=SimpleNamespace(about=dict)), None, None, todo)
    if tools:
        disk.write_file(output / route_runs.EVALUATED, tools)
    assert route_runs.is_collected(asked, set()) == collected


@pytest.mark.long
@needs_lmp
def test_killed_at_random(slope):
    """Five times, then to the end: the same numbers as at once, of runs that were not cut after a restart file: these
    go on to rounding (doc/src/robustness.rst), which grows."""
    def begun(folder):
        return subprocess.Popen([str(TOOLS / "slope"), "route", folder, *ROUTE], stdout=subprocess.DEVNULL,
                                stderr=subprocess.PIPE)
    began = time.monotonic()
    once = begun("R")
    assert once.wait() == 0, once.stderr.read()
    whole = time.monotonic() - began
    draw = np.random.default_rng(5)
    for _ in range(5):
        one = begun("K")
        time.sleep(float(draw.uniform(0.15, 0.6)) * whole)
        one.kill()
        one.wait()
    last = begun("K")
    assert last.wait() == 0, last.stderr.read()
    cut = {path.parent.name for path in Path("K").rglob(run_folders.VARIABLES)
           if "continued" in run_folders.begun(path.parent)}
    found, wanted = ({name: {**yaml.safe_load(Path(folder, name).read_text()), "collected": None} for name in (
        "results.yaml", "bodies.yaml")} for folder in "KR")
    assert found["bodies.yaml"] == wanted["bodies.yaml"] and (cut or found == wanted)
    for k in (1, 2):
        many, one = (without_times(f"{folder}/bodies/{k}/ensemble/study.csv") for folder in "KR")
        assert [row["run"] for row in many] == [row["run"] for row in one]
        for row, other in zip(many, one):
            assert row == other or row["run"] in cut
            assert float(row["centroid_m"]) == pytest.approx(float(other["centroid_m"]), rel=0.05)


@pytest.mark.parametrize("change, said", [
    pytest.param({"--bodies": None, "--below": "0.01", "--volume": "60 800"}, ("axis.csv", "60 m", "0.01"),
                 marks=pytest.mark.long),        # it searches
    ({"slides": [((40, 45), 4.0), ((55, 45), 4.0)]}, ("slides.geojson", "feature 1", "feature 2", "0.1")),
    ({"slides": [((40, 45), None)]}, ("slides.geojson", "feature 1", "depth")),
    ({"--reach": "1"}, ("--reach", "1")), ({"--corridor": "-5"}, ("--corridor", "-5")),
    ({"--friction": None}, ("--friction", "must be given")),
    ({"--road": "slides.geojson"}, ("slides.geojson", "draw the road's axis as a line")),
    ({"--fragility": "nowhere"}, ("nowhere",)), ({"--minutes": "3"}, ("--minutes", "--balls")),
    ({"--reach": "0.9999"}, ("axis.csv", "--reach"))])
@needs_lmp
def test_wrong_routes(slope, capsys, change, said):
    if "slides" in change:
        slides(change["slides"])
    words = ROUTE[:]
    for option, value in change.items():
        if option in words:
            at = words.index(option)
            words[at:at + 2] = [] if value is None else [option, value]
        elif option.startswith("--"):
            words += [option, *value.split()]
    status, out, err = route_of(capsys, *words)
    lines = [line for line in err.splitlines() if "warning" not in line]
    assert status == 2 and len(lines) == 1 and all(one in lines[0] for one in said), err
    assert not Path("R/results.yaml").exists()


def test_another_choice_is_refused(two, capsys):
    status, _, err = called(capsys, ["route", str(two[0]), "--cohesion", "8e3"])
    assert status == 2 and err.count("\n") == 1 and "--cohesion" in err and "8000" in err and "another folder" in err


@pytest.mark.parametrize("words", [
    "--cut-angle 95", "--cut-angle 0", "--sample 2", "--mesh 0", "--mesh 1e-3", "--lane 40", "--blocked -1",
    "--name " + 201 * "x", "--loosening 1.2", "--clearing 0", "--fragility nowhere"])
@needs_lmp
def test_a_refused_choice_is_not_kept(two, capsys, words):
    """Or the next command, without it, would fail, too."""
    site = two[0] / "bodies/1/site.yaml"
    before = (two[0] / choices.NAME).read_text()
    status, _, err = called(capsys, ["route", str(two[0]), "--lane", "2", *words.split()])
    assert status == 2 and err.count("\n") == 1 and (words.split()[0] in err or "nowhere" in err), err
    assert (two[0] / choices.NAME).read_text() == before and not site.exists()


def test_choices_that_fail_later_are_undone(tmp_path):
    first = {"terrain": ["dem.asc"], "road": "axis.csv", "road_width": 8.0, "corridor": 60.0, "cohesion": 9e3,
             "friction": 30.0, "density": 1900.0}
    folder = tmp_path / "R"

    def fails(given, *files):
        with pytest.raises(SlopeError), choices.undone_if_refused(folder, given):
            for file in files:
                (folder / file).parent.mkdir(exist_ok=True)
                (folder / file).write_text("")
            raise SlopeError("--crs", "must be known")
        return sorted(path.name for path in folder.iterdir())

    assert fails({**first, "crs": "EPSG:1"}, "terrain.asc", ".lock") == [".lock"]
    (folder / ".lock").unlink()
    assert fails({**first, "crs": "EPSG:1"}, "terrain.asc") == []
    (folder / ".lock").write_text("")       # of a command that was refused
    with choices.undone_if_refused(folder, first):
        (folder / "terrain.asc").write_text("")
    before = (folder / choices.NAME).read_text()
    (folder / ".lock").unlink()
    assert fails({"reach": 0.5}) == ["route.yaml", "terrain.asc"]
    assert fails({"crs": "EPSG:1"}, "terrain.asc") == ["route.yaml"] and (folder / choices.NAME).read_text() == before
    # bodies are of the new choices, which stay; what they vary may change until there are runs
    assert fails({"corridor": 80.0, "vary": ["roling=0:1"]}, choices.TABLE) == [choices.TABLE, "route.yaml"]
    assert choices.read_route_choices(folder).corridor == 80
    with choices.undone_if_refused(folder, {"vary": ["rolling=0:1"]}):
        (folder / "bodies/1/runs/a").mkdir(parents=True)
    with pytest.raises(SlopeError, match="--vary: must be that of"):
        choices.settle(folder, {"vary": ["rolling=0:2"]})


@pytest.mark.parametrize("name", ["terrain", "road", "bodies", "ground", "ground_table"])
def test_an_edit_of_what_a_route_has_read_is_seen(tmp_path, name):
    """Not an old number beside a new map: before there are bodies all is begun anew, then it is refused."""
    first = {"terrain": ["dem.vrt"], "road": "axis.csv", "bodies": "slides.csv", "ground": "zones.tif",
             "ground_table": "zones.csv", "road_width": 8.0, "corridor": 60.0, "density": 1900.0}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        for file in ("tile.tif", "axis.csv", "slides.csv", "zones.tif", "zones.csv"):
            Path(file).write_text("as it was")
        Path("dem.vrt").write_text(
            "<VRTDataset><SourceFilename relativeToVRT='1'>tile.tif</SourceFilename></VRTDataset>")
        choices.settle(Path("R"), first)
        Path("R/terrain.asc").write_text("")
        choices.settle(Path("R"), {})
        assert Path("R/terrain.asc").is_file()
        edited = Path({"terrain": "tile.tif"}.get(name, np.ravel(first[name])[0]))
        edited.write_text("edited")
        choices.settle(Path("R"), {})
        assert Path("R/terrain.asc").is_file() == (name in ("bodies", "ground", "ground_table"))
        Path("R", choices.TABLE).write_text("")
        choices.settle(Path("R"), {"sample": 8})
        edited.write_text("edited again")
        with pytest.raises(SlopeError) as error:
            choices.settle(Path("R"), {})
        assert str(error.value).startswith(f"--{name.replace('_', '-')}: must not have changed")
        Path(np.ravel(first[name])[0]).unlink()         # the folder may have gone without what it was made of
        assert choices.settle(Path("R"), {}).sample == 8


def test_before_there_are_bodies_choices_may_change(tmp_path):
    first = {"terrain": ["dem.asc"], "road": "axis.csv", "road_width": 8.0, "corridor": 60.0, "cohesion": 9e3,
             "friction": 30.0, "density": 1900.0}
    choices.settle(tmp_path / "R", first)
    for name in ("road.csv", "terrain.asc"):
        (tmp_path / "R" / name).write_text("")
    (tmp_path / "R/windows/1").mkdir(parents=True)
    assert choices.settle(tmp_path / "R", {"reach": 0.5}).reach == 0.5 and (tmp_path / "R/windows/1").is_dir()
    assert choices.settle(tmp_path / "R", {"road": "other.csv"}).road.endswith("other.csv")
    assert sorted(path.name for path in (tmp_path / "R").iterdir()) == ["route.yaml"]
    assert choices.read_route_choices(tmp_path / "R").reach == 0.5


@pytest.mark.parametrize("name, value", [
    ("volume", [1.0]), ("volume", []), ("depth", [1.0, 2.0, 3.0]), ("sample", 0), ("keep", -3), ("confined", "maybe"),
    ("terrain", []), ("corridor", math.nan), ("road", None), ("extra", 1)])
def test_a_route_yaml_that_was_edited(two, capsys, name, value):
    path = two[0] / choices.NAME
    path.write_text(yaml.safe_dump({**yaml.safe_load(path.read_text()), name: value}))
    status, _, err = zones_of(two[0], capsys, "--zones", "0.5")
    assert status == 2 and err.count("\n") == 1 and choices.NAME in err and name in err, err


def test_no_run_is_no_choice(two, capsys):
    status, _, err = called(capsys, ["route", str(two[0].parent / "new"), *ROUTE[:-6], "--minutes", "3", "--sample",
                                     "0"])
    assert status == 2 and err.count("\n") == 1 and "--sample" in err, err


def test_a_study_of_no_road_is_refused(two, capsys):
    path = two[0] / "bodies/1/ensemble/study.yaml"
    about = yaml.safe_load(path.read_text())
    for key in ("stretches", "clearing"):
        rows = [{**row, key: None} for row in about["runs"]]
        path.write_text(yaml.safe_dump({**about, "runs": rows}))
        status, _, err = zones_of(two[0], capsys, "--zones", "0.5")
        assert status == 2 and err.count("\n") == 1 and "run_0" in err and key in err, err


def test_a_body_without_a_finished_run(two, capsys, monkeypatch):
    """The error is that of its runs."""
    from slope_tools.route import runs
    program = two[0] / "lmp"
    program.write_text("#!/bin/sh\nexit 1\n")
    program.chmod(0o755)
    (two[0] / "bodies/2/ensemble/study.yaml").unlink()
    todo = type("Run", (), {"error": "exit status 1"})
    monkeypatch.setattr(runs, "make_body_site", lambda *rest: None)
    monkeypatch.setattr(runs, "make_route_study", lambda *rest: runs.Asked(None, None, None, [todo]))
    monkeypatch.setattr(runs, "make_route_runs", lambda *rest: ["body 2: 4 of 4 runs failed"])
    status, _, err = called(capsys, ["route", str(two[0]), "--lmp", str(program)])
    assert status == 2 and err.count("\n") == 1 and "body 2: 4 of 4 runs failed" in err, err


def test_runs_of_other_grids_are_not_counted_together(two):
    write_asc(two[0] / "bodies/1/runs/run_2/run.max_thickness.asc", np.zeros((3, 3)), CELL)
    with pytest.raises(SlopeError) as error:
        made(*two)
    assert "bodies/1/runs/run_2" in str(error.value) and "grid" in str(error.value)


def test_zones_of_a_study(two, capsys):
    """Of a study by itself, with the weights of known events if it has them."""
    folder = two[0] / "bodies/1/ensemble"
    for k in range(4):
        run_helpers.write_run(blob(20, 30, (4, 14), (5, 10 + k)), 10.0, CELL,
                              str(two[0] / f"bodies/1/runs/run_{k}/run"), 10.0, 20.0)
    assert zones_of(folder, capsys, "--zones", "0.4")[0] == 0
    [entry] = yaml.safe_load((folder / "zones/zones.yaml").read_text())["zones"]
    assert (entry["at_least_m2"], entry["cannot_tell_m2"]) == (50 * 25, 30 * 25)    # 4 of 4; 3, 2 and 1 of 4
    about = yaml.safe_load((folder / "study.yaml").read_text())
    weights = {"run_0": 0.02, "run_1": 0.02, "run_2": 0.02, "run_3": 0.94}
    about["ensemble"] = records.encode_record(made_study.ensemble({"weights": weights}))
    (folder / "study.yaml").write_text(yaml.safe_dump(about))
    assert zones_of(folder, capsys, "--zones", "0.4", "--overwrite")[0] == 0
    [entry] = yaml.safe_load((folder / "zones/zones.yaml").read_text())["zones"]
    worth = 1 / sum(one ** 2 for one in weights.values())
    low, high = (float(side) for side in hazard.share_bounds(worth, worth))
    assert (low < 0.4) and entry["at_least_m2"] == 0 and entry["cannot_tell_m2"] == 80 * 25
    # of a site whose number is of the paper's study: the weighted runs all the same
    site, paper = folder.parent, folder.parent / "study"
    paper.mkdir()
    about["study"]["governs"] = "study"
    (folder / "study.yaml").write_text(yaml.safe_dump(about))
    (paper / "study.yaml").write_text(yaml.safe_dump({**about, "ensemble": None}))
    status, out, _ = zones_of(site, capsys, "--zones", "0.4", "--overwrite")
    assert status == 0 and f"of the runs of {folder}" in out
    assert yaml.safe_load((site / "zones/zones.yaml").read_text())["zones"] == [entry]


def test_repeats_of_a_point_are_worth_one_run(two, capsys):
    """Four runs of two points: as two; and a study that has only runs of a condition, which do not count alike."""
    folder = two[0] / "bodies/1/ensemble"
    for k in range(4):
        run_helpers.write_run(blob(20, 30, (4, 14), (5, 10)), 10.0, CELL, str(two[0] / f"bodies/1/runs/run_{k}/run"),
                              10.0, 20.0)
    path = folder / "study.yaml"
    about = yaml.safe_load(path.read_text())
    for points, of_all in ((4, 1250), (2, 0)):
        for k, row in enumerate(about["runs"]):
            row["set"] = {"rolling": str(k % points)}
        path.write_text(yaml.safe_dump(about))
        assert zones_of(folder, capsys, "--zones", "0.4", "--overwrite")[0] == 0
        found = yaml.safe_load((folder / "zones/zones.yaml").read_text())
        assert found["zones"][0]["at_least_m2"] == of_all
        assert found["unreached_at_most"] == pytest.approx(float(hazard.share_bounds(0, points)[1]))
    for row in about["runs"]:
        row["batch"] = 1
    path.write_text(yaml.safe_dump(about))
    status, _, err = zones_of(folder, capsys, "--zones", "0.4", "--overwrite")
    assert status == 2 and err.count("\n") == 1 and "ensemble" in err, err


def test_a_folder_of_something_else(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("mine").mkdir()
    Path("mine/notes.txt").write_text("")
    status, _, err = called(capsys, ["route", "mine", *ROUTE])
    assert status == 2 and "mine" in err and not Path("mine/route.yaml").exists()


# --- a body that was given ---

def hill(folder):
    """A slope of 31 degrees to the south with a body on it; gives the body as a mass, and the corridor's choices."""
    y = 5.0 * (59.5 - np.arange(60))
    ground = route_stand_in.raster(np.add.outer(0.6 * np.clip(y - 100, 0, 120), np.zeros(40)), 5.0)
    x, y = run_helpers.centres(60, 40, 5.0)
    depth = np.clip(8.0 * (1 - ((x - 100) ** 2 + (y - 180) ** 2) / 25 ** 2), 0, None)
    folder.mkdir(parents=True)
    search.rasters.write_asc_local(folder / "terrain.asc", ground, {}, exact=True)
    search.rasters.write_asc_local(folder / "body.1.base.asc", ground._replace(z=ground.z - depth), {}, exact=True)
    given = choices.Choices(["dem.asc"], "axis.csv", 8.0, 100.0, 9e3, 30.0, 1900.0)
    return search.falling.of_arrays(ground, depth, "body 1"), given


def test_a_given_body_has_a_factor_and_a_fragility(tmp_path):
    mass, given = hill(tmp_path / "slips" / "1")
    found = search.read_route_body(tmp_path, 1, 1900.0)
    assert found.name == "1" and found.direction == pytest.approx(270, abs=2)
    assert found.columns.volume == pytest.approx(mass.volume, rel=0.03)
    factor = search.bishop_factor(given, mass.raster, tmp_path / "base.asc", mass.base)
    strengths = search.bishop.Strengths(9e3, math.tan(math.radians(30)), 0.0)
    assert factor == pytest.approx(float(search.bishop.factor_of_safety(found.columns, strengths)[0]))
    assert 1 < factor < 3
    assert search.make_factor_entry(factor) == {"factor": factor, "no_factor": ""}


@pytest.mark.parametrize("ends, reach, said", [
    (((20, 90), (180, 90)), 0.01, ""), (((20, 20), (180, 20)), 0.9, "known events"),
    (((10, 20), (10, 280)), 0.01, "away from the road")])
def test_whether_a_body_reaches_the_road(tmp_path, ends, reach, said):
    mass, given = hill(tmp_path / "slips" / "1")
    found = search.reaches(dataclasses.replace(given, reach=reach), mass, LineString(ends).buffer(4, cap_style=2))
    assert (said in found["why_not"]) and bool(said) == bool(found["why_not"])
    assert 0 < found["known_share"] <= 1


def test_a_flank_of_a_wide_body_reaches_a_road_beside_the_path_of_its_middle(tmp_path):
    mass, given = hill(tmp_path / "slips" / "1")
    x, y = run_helpers.centres(60, 40, 5.0)
    depth = 1.5 * ((abs(x - 100) <= 80) & (abs(y - 180) <= 10))
    road, margin = LineString([(25, 20), (25, 280)]).buffer(4), mass.volume ** (1 / 3)
    assert search.reaches(given, mass, road)["why_not"]
    wide = mass._replace(depth=depth * mass.volume / (depth.sum() * 25))
    assert wide.volume ** (1 / 3) == pytest.approx(margin) and margin < 100 - 29 and not search.reaches(
        given, wide, road)["why_not"]


def test_the_share_of_a_wide_body_is_that_of_the_flank_that_reaches_the_road_first(tmp_path):
    """A road that runs down across the slope, 15 m below the left flank and 150 m below the middle."""
    mass, given = hill(tmp_path / "slips" / "1")
    x, y = run_helpers.centres(60, 40, 5.0)
    depth = 1.5 * ((abs(x - 100) <= 80) & (abs(y - 180) <= 10))
    wide = mass._replace(depth=depth * mass.volume / (depth.sum() * 25))
    oblique = LineString([(185, 155), (95, 10)]).buffer(4)
    below = LineString([(15, 155), (185, 155)]).buffer(4)
    mobility = search.known.compute_known_mobility(wide, search.known.choice()).decides
    middle = search.known.fall_path.at_road(mobility.path, oblique, wide.raster, mobility.width)
    assert middle.met and mobility.exceedance(middle.length) < 0.5
    flank, all_of_it = (search.reaches(dataclasses.replace(given, reach=0.5), wide, road) for road in (oblique, below))
    assert flank["known_share"] == pytest.approx(all_of_it["known_share"], abs=0.05) and not flank["why_not"]
