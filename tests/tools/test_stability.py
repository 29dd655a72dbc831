"""slope stability: what find_slip finds on the embankments of Scoops3D, and what is said of it."""
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml
from affine import Affine
from shapely.geometry import box

import run_helpers
import test_depends_on
from run_helpers import anew, called, write_asc
from test_slips import CASES
from tiny_collapse import rows_of

from slope_tools import cli
from slope_tools.commands import stability
from slope_tools.slips import bishop, bodies, columns, doubts
from slope_tools.survey.rasters import Raster

LMP = os.environ.get("LMP")
needs_lmp = pytest.mark.skipif(not LMP, reason="needs the LAMMPS program (LMP)")
LOW = "terrain.asc --cohesion 3e3 --friction 19.6 --density 2039.43"


def write_low(step=1, longer=0):
    """The embankment of 10 m, which slides to the west, in the coordinates of a survey; every so many cells of 0.5 m,

    and so many rows more, as it is the same all along."""
    z = np.pad(CASES[0][0].z[::step, ::step], ((longer, 0), (0, 0)), "edge")
    run_helpers.write_sidecar(*z.shape, 0.5 * step)
    write_asc("terrain.asc", z, 0.5 * step)


@pytest.fixture
def low(here):
    write_low()


@pytest.fixture
def coarse(here):
    write_low(2, 20)


@pytest.fixture(scope="module")
def searched(tmp_path_factory):
    """What a search finds above a bedrock that dips along the slope, and across it towards the middle."""
    folder = tmp_path_factory.mktemp("searched")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        write_low()
        x, y = columns.centres(CASES[0][0])
        write_asc("rock.asc", CASES[0][0].z - 2.2 + 0.05 * np.abs(y - 24) + 0.01 * (x - 20), 0.5)
        assert cli.main(f"stability {LOW} --volume 300 500 --keep 1 --bedrock rock.asc -o slips".split()) == 0
    return folder


@pytest.fixture
def on_rock(searched, here):
    """The same, in the test's folder; gives its table."""
    shutil.copytree(searched, here, dirs_exist_ok=True)
    return table()


def ran(capsys, words):
    return called(capsys, ["stability", *words.split()])


def table(folder="slips"):
    return rows_of(f"{folder}/stability.csv", float)


@pytest.mark.drawn
@needs_lmp
def test_bodies_table_map_and_warnings(low, capsys):
    status, out, err = ran(capsys, f"{LOW} --volume 500 5000 --keep 9 -o slips")
    assert status == 0, err
    rows = table()
    assert rows[0]["factor"] == pytest.approx(1.0389, abs=2e-4) and rows[0]["bearing"] == pytest.approx(270, abs=1)
    assert f"{rows[0]['factor']:.3f}" in out
    factor = bodies.rasters.read_asc_local("slips/body.factor.asc", heights=False)
    assert factor.offset == (run_helpers.EAST, run_helpers.NORTH) and factor.crs.to_epsg() == 6677
    inside = bodies.mask_of(Path("slips/body.1.base.asc"))
    assert inside.sum() == rows[0]["cells"] and (factor.z[inside] <= rows[0]["factor"] * (1 + 1e-6)).all()
    assert rows[0]["cells"] * 0.25 == pytest.approx(rows[0]["area"], rel=0.02)
    about = yaml.safe_load(Path("slips/stability.yaml").read_text())
    assert test_depends_on.SAID["stability"] - {"failed"} <= about.keys() and about["method"] == "bishop"
    assert f"only {len(rows)} of 9 bodies" in about["warnings"][0]["text"] and len(rows) < 9
    assert all(f"stability: warning: {one['text']}\n" in err for one in about["warnings"])
    assert Path("slips/stability.png").stat().st_size > 10000

    # its deck runs from where it lies, and slope fragility reads what it left

    assert "region ground terrain ../terrain.asc" in Path("slips/in.slips").read_text()
    assert [body.name for body in bodies.read_slip_bodies(Path("slips"))] \
        == [f"{row['body']:.0f}" for row in rows]


@pytest.mark.drawn
@pytest.mark.long
@needs_lmp
def test_ellipsoids_are_not_above_spheres_and_go_on_to_their_fragility(low, capsys):
    status, _, err = ran(capsys, f"{LOW} --volume 500 5000 --keep 1 --shape ellipsoid -o wide")
    assert status == 0, err
    [row] = table("wide")
    assert row["factor"] < 1.0389 and 1.5 < row["across"] < 4.0
    [body] = bodies.read_slip_bodies(Path("wide"))
    soil = bishop.Strengths(3e3, np.tan(np.radians(19.6)))
    assert body.columns.normal is None      # the body can turn about its axis
    assert bishop.factor_of_safety(body.columns, soil)[0] == pytest.approx(row["factor"], rel=1e-7)
    assert bishop.yield_coefficient(body.columns, soil)[0] == pytest.approx(row["yield"], abs=1e-7)
    assert Path("wide/stability.png").stat().st_size > 10000

    # a section of a sphere would lie beside the base that find_slip wrote

    [of_table] = bodies.read_body_rows(Path("wide/body.slips.csv"))
    base = bodies.rasters.read_raster(Path("wide/body.1.base.asc"))
    sphere = columns.base_of(base, (row["x"], row["y"], row["z"]), row["radius"])
    exact = columns.base_of(base, (row["x"], row["y"], row["z"]), row["radius"], of_table["direction"],
                            bodies.shape_of(of_table))
    assert np.nanmax(np.abs(exact - base.z)) < 1e-3 < 0.1 < np.nanmax(np.abs(sphere - base.z))


@needs_lmp
def test_a_smaller_search_in_the_same_folder(coarse, capsys):
    """Within a polygon in the coordinates of the survey, with a limit of depth: both are said to bind; on two ranks."""
    part = box(0, 18, 51, 34)
    run_helpers.write_geojson("part.geojson", part, crs=None)
    Path("slips").mkdir()
    for name in ("base.asc", "columns.csv"):
        Path(f"slips/body.2.{name}").write_text("of an earlier search")
    status, out, err = ran(capsys, f"{LOW} --volume 100 5000 --depth 0 2 --within part.geojson --local --keep 1 "
                           "--seismic 0.05 -0.02 --water 0.1 --np 2 -o slips")
    assert status == 0, err
    [row] = table()
    assert row["depth"] <= 2 and "has the largest depth that is allowed, 2 m" in err
    assert "is at the edge of --within" in err and row["factor"] < 1 and "below 1" in err
    assert not list(Path("slips").glob("body.2.*"))
    # water and all: with the inertia of the search the factor is the same
    [body] = bodies.read_slip_bodies(Path("slips"))
    assert bishop.factor_of_safety(body.columns, SOIL, 0.05, -0.02)[0] == pytest.approx(row["factor"], rel=1e-7)
    deck = Path("slips/in.slips").read_text()
    assert all(words in deck for words in ("water ru 0.1", "seismic 0.05 -0.02", "depth 0 2", "within inside"))


def plane_body(cells, rise=0.5):
    """A raster of 20 x 20 cells, a block of cells in it, and its row of a table."""
    raster = Raster(np.tile(rise * np.arange(20.0), (20, 1)), Affine(1, 0, 0, 0, -1, 20), None)
    inside = np.zeros((20, 20), bool)
    inside[5:5 + cells, 5:5 + cells] = True
    row = {"rank": 1, "radius": 20.0, "direction": 180.0, "factor": 1.5, "volume": 300.0, "depth": 3.0,
           "across": 1.0}
    return raster, row, inside


@pytest.mark.parametrize("change, limits, kind", [
    ({}, {}, None), ({"volume": 100.5}, {}, "volume low"), ({"volume": 500}, {"volume": (200, 503)}, "volume high"),
    ({"depth": 1.0}, {"depth": (1.0, 4.0)}, "depth low"), ({"depth": 3.99}, {"depth": (1.0, 4.0)}, "depth high"),
    ({"radius": 60.0}, {}, "flat"), ({"across": 0.251}, {}, "wide"), ({"across": 3.99}, {}, "wide"),
    ({"factor": 0.99}, {}, "fails")])
def test_doubts_of_numbers(change, limits, kind):
    raster, row, inside = plane_body(9)
    given = {"volume": None, "depth": None, "allowed": None, **limits}
    found = [one.kind for one in doubts.find_body_doubts(raster, {**row, **change}, inside, **given)]
    assert found == ([kind] if kind else [])


def test_doubts_of_places():
    raster, row, inside = plane_body(7)
    assert [one.kind for one in doubts.find_body_doubts(raster, row, inside, None, None, None)] == ["columns"]
    raster, row, inside = plane_body(9)
    hole = raster._replace(z=np.where(np.indices((20, 20))[0] == 15, np.nan, raster.z))
    assert [one.kind for one in doubts.find_body_doubts(hole, row, inside, None, None, None)] == ["terrain"]
    assert doubts.at_edge(raster, np.roll(inside, -3, axis=1)) and not doubts.at_edge(raster, inside)
    allowed = doubts.cells_in(raster, box(4, 4, 16, 16))
    assert not doubts.find_body_doubts(raster, row, inside, None, None, allowed)
    allowed = doubts.cells_in(raster, box(5, 4, 16, 16))
    assert [one.kind for one in doubts.find_body_doubts(raster, row, inside, None, None, allowed)] == ["within"]
    assert doubts.length(raster, inside, 180.0) == pytest.approx(9)


@needs_lmp
@pytest.mark.parametrize("words, rule", [
    ("--cohesion -3", "Find_slip strength C must be >= 0 (Pa), got -3"),
    ("--friction 95", "Find_slip strength PHI must be 0 to below 90"),
    ("--water-table high.asc", "water table"),
    ("--bedrock none.asc", "none.asc: must be an existing file"),
    ("--layer none.asc 1 2 3", "none.asc: must be an existing file"),
    ("--layer terrain.asc 1 x 3", "--layer: must be a finite number, got 'x'"),
    ("--seismic 0.1 0.2 0.3", "--seismic: must be KH, or KH KV, got 0.1 0.2 0.3"),
    ("--lmp nowhere", "--lmp: must lead to the LAMMPS program"),
])
def test_bad_input_is_one_line(low, capsys, words, rule):
    write_asc("high.asc", CASES[0][0].z + 1, 0.5)
    status, _, err = ran(capsys, f"{anew(LOW, words)} -o out")
    assert status == 2 and err.count("\n") == 1 and rule in err
    assert not Path("out").exists() and not list(Path().glob(".out*"))


def several_bodies(site, rows):
    """Without --body all of them are in the deck, each with its own volume."""
    assert site("--slips slips -o all")[0] == 0
    about = yaml.safe_load(Path("all/site.yaml").read_text())
    assert about["release"]["bodies"] == ["../slips/body.1.base.asc", "../slips/body.2.base.asc"]
    volumes = [about["found"]["bodies"][rank]["volume_m3"] for rank in (1, 2)]
    assert volumes == pytest.approx([row["volume"] for row in rows], rel=2e-3)
    at = []
    for rank, volume in enumerate(volumes, 1):
        subprocess.run([LMP, "-in", "in.site", "-var", "body", str(rank), "-var", "duration", "0.1", "-var", "out",
                        f"run{rank}"], cwd="all", check=True, stdout=subprocess.DEVNULL)
        summary = yaml.safe_load(Path(f"all/run{rank}.summary.yaml").read_text())
        assert summary["volume"]["released"] == pytest.approx(volume, rel=2e-3)
        start = bodies.rasters.read_raster(Path(f"all/run{rank}.arrival.asc"), heights=False)
        y = start.transform.f + start.transform.e * (np.nonzero(start.z == 0)[0] + 0.5)
        at.append(y.mean())
    # spheres of one size beside each other along the embankment
    assert abs(rows[1]["y"] - rows[0]["y"]) > 2
    assert at[1] - at[0] == pytest.approx(rows[1]["y"] - rows[0]["y"], abs=0.5)


@needs_lmp
def test_a_site_of_a_body(coarse, capsys):
    """Its release is the body of that rank, on the terrain where it was found."""
    assert ran(capsys, f"{LOW} --volume 300 5000 --keep 2 -o slips")[0] == 0
    rows = table()

    def site(words):
        return called(capsys, ["site", "--terrain", "terrain.asc", "--balls", "100", *words.split()])

    status, out, err = site("--slips slips --body 2 -o mine")
    assert status == 0, err
    about = yaml.safe_load(Path("mine/site.yaml").read_text())
    assert about["release"]["scar"] == "../slips/body.2.base.asc" and about["release"]["scar_is"] == "surface"
    body = yaml.safe_load(Path("mine/release.yaml").read_text())
    assert body["body"]["volume"] == pytest.approx(rows[1]["volume"], rel=2e-3)
    several_bodies(site, rows)
    for words, rule in (("--slips slips --body 3", "--body: must be one of slips/body.slips.csv, 1, 2, got 3"),
                        ("--body 1", "--body: must be given with --slips, got 1"),
                        ("--slips nowhere", "nowhere: must be PREFIX.slips.csv"),
                        ("--slips slips --scar terrain.asc", "--slips: must be given without --scar")):
        status, _, err = site(f"{words} -o other")
        assert status == 2 and err.count("\n") == 1 and rule in err
        assert not Path("other").exists()


def test_doubtful_input_is_named():
    half = np.array([[1.0, np.nan], [np.nan, np.nan]])
    masks = [half == 1.0, np.ones((2, 2), bool)]
    given = [stability.Given(kind, "", "rock.asc", half) for kind in ("bedrock", "water table", "layer")]
    found = list(map(str, stability.find_stability_warnings(8.0, 19.0, [{"rank": 1}, {"rank": 2}], masks, given)))
    assert [one.split(":")[0] for one in found] == ["--cohesion 8", "--density 19", *3 * ["body 2"]]
    assert all(f"{what} has no value below 75 % of its cells" in one for what, one in zip(
        ("--bedrock", "--water-table", "--layer rock.asc"), found[2:]))
    assert not list(stability.find_stability_warnings(0.0, 1900.0, [], [], []))


SOIL = bishop.Strengths(3e3, np.tan(np.radians(19.6)))


@needs_lmp
def test_bodies_above_a_bedrock(on_rock):
    """The columns that slope fragility uses have the factor, yield coefficient and volume of find_slip."""
    rock = bodies.rasters.read_raster(Path("rock.asc")).z
    found = bodies.read_slip_bodies(Path("slips"))
    assert [body.name for body in found] == [f"{row['body']:.0f}" for row in on_rock]
    for body, row in zip(found, on_rock):
        base = bodies.rasters.read_raster(body.base).z
        inside = np.isfinite(base)
        assert (base[inside] >= rock[inside] - 1e-6).all()
        assert 0.2 < (base[inside] < rock[inside] + 1e-4).mean() < 1
        assert body.columns.volume == pytest.approx(row["volume"], rel=1e-7) and body.cells == row["cells"]
        assert bishop.factor_of_safety(body.columns, SOIL)[0] == pytest.approx(row["factor"], rel=1e-7)
        assert bishop.yield_coefficient(body.columns, SOIL)[0] == pytest.approx(row["yield"], abs=1e-7)
        sphere = columns.of_sphere(CASES[0][0], bodies.centre_of(row), row["radius"], 90.0 - row["bearing"], 2039.43)
        assert sphere.volume > 1.05 * row["volume"]


@needs_lmp
def test_back_analysis_fragility_and_site_of_a_body_above_a_bedrock(on_rock, capsys):
    row = on_rock[0]
    sphere = ",".join(f"{row[name]:.10g}" for name in ("x", "y", "z", "radius"))
    lines = []
    for words in ("slips", f"{sphere} --bedrock rock.asc --direction {row['bearing']}"):
        status, _, err = ran(capsys, f"terrain.asc --failed {words} --density 2039.43 -o back --overwrite")
        assert status == 0, err
        about = yaml.safe_load(Path("back/back.yaml").read_text())
        assert about["volume"] == pytest.approx(row["volume"], rel=5e-3)
        lines.append(about["cohesion_without_friction"])
    assert lines[1] == pytest.approx(lines[0], rel=5e-3)
    status, _, err = ran(capsys, "terrain.asc --failed slips --bedrock rock.asc --density 2000 -o back --overwrite")
    assert status == 2 and "--bedrock: must be given with X,Y,Z,R" in err

    status, _, err = called(capsys, "fragility slips --cohesion 2e3:6e3 "
                            "--friction 18:30 --peaks 50:900:50 --pseudo-static 1 --sample 256 -o curves".split())
    assert status == 0, err
    status, _, err = called(capsys, "site --terrain terrain.asc --balls 100 --slips slips --body 1 -o mine".split())
    assert status == 0, err
    about = yaml.safe_load(Path("mine/release.yaml").read_text())
    assert about["body"]["volume"] == pytest.approx(row["volume"], rel=2e-3)


@needs_lmp
def test_flat_ground(low, capsys):
    write_asc("terrain.asc", np.full((16, 16), 10.0), 0.5)
    Path("terrain.yaml").unlink()
    status, _, err = ran(capsys, f"{LOW} -o out")
    assert status == 2 and err.count("\n") == 1 and "terrain.asc: must be steep enough" in err
    assert not Path("out").exists()
