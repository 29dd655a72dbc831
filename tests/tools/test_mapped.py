"""The runs of a study against a mapped deposit: overlap, run-out and volume by hand, and on the page."""
import html
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from affine import Affine
from rasterio.features import shapes
from shapely.geometry import shape
from shapely.ops import unary_union

import test_report
from made_rows import row
from tiny_collapse import read_asc

from slope_tools import disk, records
from slope_tools.deposits import deposit, score
from slope_tools.mobility import run_length
from slope_tools.plots import figure_maps
from slope_tools.studies import mapped
from slope_tools.survey import rasters
from slope_tools.tables import study_file, study_table

made, here, slope = test_report.made, test_report.here, test_report.slope       # its fixtures
LOW, HIGH = (10.0, 6.0), (26.0, 18.0)       # corners of what is mapped, local m


def compared(folder, path):
    """What study.yaml says of a mapped deposit, entered in it."""
    file = folder / "study.yaml"
    about = study_file.load_study(file)
    terrains = [folder / one.run / "terrain.asc" for one in about.runs]
    found, observed = mapped.compare(path, folder, about.runs, terrains)
    about = replace(about, runs=found, observed=observed)
    file.write_text(yaml.safe_dump(disk.make_plain(study_file.encode_study(about))))
    return about


def outline(path):
    (xlo, ylo), (xhi, yhi) = LOW, HIGH
    path.write_text(f"{xlo},{ylo}\n{xhi},{ylo}\n{xhi},{yhi}\n{xlo},{yhi}\n")
    return path


def thickness(folder, path, of=2.0):
    """A raster of so much thickness in the same rectangle, on the grid of the runs."""
    raster = rasters.read_raster(next(iter(sorted(folder.glob("*/tiny.thickness.asc")))), heights=False)
    rows, columns = np.indices(raster.z.shape)
    x, y = raster.transform @ (columns + 0.5, rows + 0.5)
    inside = (x > LOW[0]) & (x < HIGH[0]) & (y > LOW[1]) & (y < HIGH[1])
    rasters.write_geotiff(path, {"thickness": np.where(inside, of, 0.0)}, raster)
    return path, inside, raster.transform.a


def test_overlap_and_run_out_by_hand(here):
    about = compared(here / "repeated", outline(here / "observed.csv"))
    entry, rows = records.encode_record(about.observed), about.runs
    assert entry["file"] == "../observed.csv" and entry["volume_m3"] is None
    assert entry["area_m2"] == pytest.approx((HIGH[0] - LOW[0]) * (HIGH[1] - LOW[1]))
    _, inside, _ = thickness(here / "repeated", here / "other.tif")
    for one in rows:
        mine = read_asc(here / "repeated" / one.run / "tiny.thickness.asc") > 0.1
        assert one.mapped.overlap == pytest.approx((mine & inside).sum() / (mine | inside).sum())
        assert one.mapped.beyond_mapped_m == pytest.approx(one.length_m - entry["length_m"])
    assert entry["best"] == max(rows, key=lambda one: one.mapped.overlap).run
    assert min(one.length_m for one in rows) < entry["length_m"] + 10
    run = deposit.read_deposit(str(here / "repeated" / rows[0].run / "tiny"), None,
                               lambda text: None)     # by its own outline
    mask, _ = run_length.lobes(run)
    own = unary_union([shape(one) for one, _ in shapes(mask.astype("uint8"), mask, transform=run.raster.transform)])
    length = mapped.length_of(run, None, score.from_polygon(own, run.raster))
    assert length == pytest.approx(run_length.measure_run_length(run, None).distance, abs=1e-3)
    beyond = mapped.length_of(run, None, score.from_polygon(own.union(own.buffer(1000)), run.raster))
    assert beyond > length + 900        # what lies beside the grid counts
    z = np.pad(np.where(mask, 1.0, 0.0), 200)
    z[:, :200][z.shape[0] // 2] = 1.0       # a strip to 200 cells west of the grid
    west, cell = run.raster.transform.c, run.cell
    for thick, far in ((1.0, west - 199.5 * cell), (0.004, None)):
        wide = run.raster._replace(z=np.where(np.arange(z.shape[1]) < 200, thick * z, z),
                                   transform=run.raster.transform @ Affine.translation(-200, -200))
        got = mapped.length_of(run, None, score.from_raster("wide.tif", wide, run.raster, 0.1))
        assert got == pytest.approx(deposit.top(run).x - far if far else length, abs=2 * cell)
    text, = mapped.describe_mapped(about.observed, rows)
    assert re.search(rf"overlap \(Jaccard\) \d\.\d\d to \d\.\d\d, best of {entry['best']}, [+-]\d+ m in run-out", text)
    assert "overlap,beyond_mapped_m" in study_table.tabulate_study({"rolling": ["0", "0.3"], "steps": ["1200"]}, {},
                                                                   rows, {
        "seed": "0"}).splitlines()[0]


def test_the_mass_of_a_mapped_thickness(here):
    path, inside, cell = thickness(here / "repeated", here / "observed.tif", 1.0)
    entry = compared(here / "repeated", path).observed
    volume = inside.sum() * cell ** 2
    assert entry.volume_m3 == pytest.approx(volume) and entry.released_m3 == pytest.approx(349, abs=1)
    assert f"{100 * (1 - volume / entry.released_m3):.0f} % less than is released" in mapped.describe_mapped(entry, [
        row(run=entry.best, overlap=0.5)])[1]


def test_without_a_mapped_deposit_nothing_is_compared(here):
    assert mapped.find_mapped_deposit(None) is None and mapped.find_mapped_deposit(here) is None
    assert mapped.find_mapped_deposit(outline(here / "observed.csv").parent) == here / "observed.csv"
    rows = [row(status="failed")]
    assert mapped.compare(None, here, [row()], [None]) == ([row()], None)
    assert mapped.compare(here / "observed.csv", here, rows, [None]) == (rows, None)


@pytest.mark.parametrize("kind", ["outline", "thickness"])
def test_the_page_compares_whatever_the_method(here, slope, kind, monkeypatch):
    """On the first page in a sentence, in a table, and as an outline on the maps."""
    folder, layers = here / "repeated", []
    path = outline(here / "observed.csv") if kind == "outline" else thickness(folder, here / "observed.tif", 1.0)[0]
    about = compared(folder, path)
    monkeypatch.setattr(figure_maps, "value_map", lambda one, *_, **__: layers.append(one) or "data:,")
    assert slope("repeated")[0] == 0
    assert all(one.mapped is not None for one in layers)
    assert any(entry.text == "mapped deposit" for entry in figure_maps.list_legend_entries(layers[0]))
    page = html.unescape((folder / "report.html").read_text(encoding="utf-8"))
    best = next(one.mapped for one in about.runs if one.run == about.observed.best)
    first = page[:page.index('id="appendix"')]
    assert f"The best of 6 runs shares {best.overlap:.3g}" in first
    assert re.search(r"and ends [\d.]+ m (beyond|short of) its tip\.", first)
    assert ("% less than is released" in first) == (kind == "thickness")
    table = page[page.index('<section id="mapped">'):]
    table = table[:table.index("</section>")]
    assert "all 6 runs" in table and f"{best.overlap:.3g}" in table
    assert ("volume of the deposit" in table) == (kind == "thickness")
    numbers = Path("repeated/report.numbers.csv").read_text(encoding="utf-8")
    assert "overlap with the mapped deposit" in numbers


def test_a_page_without_a_mapped_deposit_has_none(here, slope):
    assert slope("repeated")[0] == 0
    assert "mapped" not in (here / "repeated" / "report.html").read_text(encoding="utf-8")
