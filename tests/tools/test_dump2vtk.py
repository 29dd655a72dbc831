"""build/dump2vtk: what is in the dump, rasters and ball files comes back from VTK's own readers, value by value."""
import gzip
import os
import re
import resource
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
import zlib
from pathlib import Path

import numpy as np
import pytest

TOP = Path(__file__).resolve().parents[2]
DUMP2VTK = Path(os.environ.get("DUMP2VTK", TOP / "build" / "dump2vtk")).resolve()
if not DUMP2VTK.exists():
    pytest.skip("dump2vtk is not built: VTK is missing", allow_module_level=True)

from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402  (VTK is there if dump2vtk is)
from vtkmodules.vtkFiltersCore import vtkThreshold  # noqa: E402
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter  # noqa: E402
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLStructuredGridReader  # noqa: E402

COLUMNS = "id type diameter x y z vx vy vz omegax omegay omegaz"
BOX = "ITEM: BOX BOUNDS ss ss fs\n0 10\n0 20\n0 30\n"


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*words, **options):
    return subprocess.run([DUMP2VTK, *map(str, words)], capture_output=True, text=True, timeout=60, **options)


def good(*words):
    result = run(*words)
    assert (result.returncode, result.stderr) == (0, "")
    return result.stdout


def bad(*words, **options):
    """The one line of an error; nothing may be left of the output."""
    before = sorted(Path(".").rglob("*"))
    result = run(*words, **options)
    assert result.returncode == 2 and result.stdout == ""
    assert result.stderr.startswith("dump2vtk: ") and result.stderr.count("\n") == 1, result.stderr
    assert sorted(Path(".").rglob("*")) == before
    return result.stderr[len("dump2vtk: "):].rstrip()


def snapshot(rows, step=0, columns=COLUMNS, box=BOX, head="", count=None):
    body = "".join(" ".join(map(str, row)) + " \n" for row in rows)
    count = len(rows) if count is None else count
    return f"{head}ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{count}\n{box}ITEM: ATOMS {columns} \n{body}"


def balls(n, seed=0):
    """Rows of COLUMNS, with all digits that a double has."""
    random = np.random.default_rng(seed)
    return [[i + 1, 1 + i % 3, 1.25, *random.uniform(0, 10, 3), *random.normal(0, 3, 6)] for i in range(n)]


def arrays(attributes):
    return {attributes.GetArrayName(i): vtk_to_numpy(attributes.GetArray(i))
            for i in range(attributes.GetNumberOfArrays())}


def read_vtp(path):
    """Points, point arrays and the data set."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    data = reader.GetOutput()
    assert data.GetNumberOfVerts() == data.GetNumberOfPoints()
    return vtk_to_numpy(data.GetPoints().GetData()).reshape(-1, 3), arrays(data.GetPointData()), data


def read_vts(path):
    """Points, values and what shows, each [row, column] from the south-west; the data set."""
    reader = vtkXMLStructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    data = reader.GetOutput()
    nx, ny, nz = np.diff(np.reshape(data.GetExtent(), (3, 2)))[:, 0] + 1
    assert nz == 1
    points = vtk_to_numpy(data.GetPoints().GetData()).reshape(ny, nx, 3)
    values = {name: value.reshape(ny, nx) for name, value in arrays(data.GetPointData()).items()}
    shows = np.array([bool(data.IsPointVisible(i)) for i in range(nx * ny)]).reshape(ny, nx)
    return points, values, shows, data


def read_pvd(path):
    root = ET.parse(path).getroot()
    assert root.tag == "VTKFile" and root.get("type") == "Collection"
    return [(float(entry.get("timestep")), entry.get("file")) for entry in root.iter("DataSet")]


def write_asc(path, z, x=0.0, y=0.0, cell=2.0):
    """z[row, column] from the south-west, NaN as NODATA."""
    rows = "\n".join(" ".join("-9999" if np.isnan(v) else repr(float(v)) for v in row) for row in z[::-1])
    Path(path).write_text(f"ncols {z.shape[1]}\nnrows {z.shape[0]}\nxllcorner {x}\nyllcorner {y}\ncellsize {cell}\n"
                          f"NODATA_value -9999\n{rows}\n")


# --- dumps ---

def test_every_value_of_a_snapshot(here):
    rows = balls(50)
    Path("a.dump").write_text(snapshot(rows, step=900))
    assert good("a.dump", "-o", "run") == ("run.pvd: 1 snapshots, step 900 to 900, time 900 to 900, "
                                           "50 balls in the last\n")
    points, values, data = read_vtp("run/run_00000900.vtp")
    rows = np.array(rows)
    assert np.array_equal(points, rows[:, 3:6])
    assert sorted(values) == ["diameter", "id", "omega", "speed", "spin", "type", "velocity"]
    assert np.array_equal(values["velocity"], rows[:, 6:9]) and np.array_equal(values["omega"], rows[:, 9:12])
    for name, column in (("id", 0), ("type", 1), ("diameter", 2)):
        assert np.array_equal(values[name], rows[:, column])
    assert values["id"].dtype == np.int64 and values["type"].dtype == np.int64
    assert np.allclose(values["speed"], np.linalg.norm(rows[:, 6:9], axis=1), rtol=1e-15)
    assert np.allclose(values["spin"], np.linalg.norm(rows[:, 9:12], axis=1), rtol=1e-15)
    field = arrays(data.GetFieldData())
    assert field["TimeValue"] == [900] and field["step"] == [900]
    assert data.GetPointData().GetScalars().GetName() == "speed"
    assert sorted(os.listdir()) == ["a.dump", "run", "run.pvd"] and os.listdir("run") == ["run_00000900.vtp"]
    text = Path("run/run_00000900.vtp").read_bytes()
    assert b'compressor="vtkZLibDataCompressor"' in text and b'encoding="raw"' in text


def test_columns_in_any_order_and_others_by_name():
    Path("a.dump").write_text(snapshot([[3, "Fe", 0.5, 7, -1e-3, 1, 2, 4, "nan"],
                                        [6, "O", 1.5, 8, 2e300, 5, 6, 7, 1e-320]],
                                       columns="z element radius id c_stress fx fy fz v_q", box="").replace(
                          "ATOMS z", "ATOMS x y z").replace("\n3 Fe", "\n1 2 3 Fe").replace("\n6 O", "\n4 5 6 O"))
    result = run("a.dump", "-o", "run")
    assert result.returncode == 0
    assert result.stderr == "dump2vtk: warning: a.dump: column element holds words and is left out\n"
    points, values, _ = read_vtp("run/run_00000000.vtp")
    assert points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert sorted(values) == ["c_stress", "diameter", "force", "id", "radius", "v_q"]
    assert values["diameter"].tolist() == [1, 3] and values["radius"].tolist() == [0.5, 1.5]
    assert values["force"].tolist() == [[1, 2, 4], [5, 6, 7]] and values["c_stress"].tolist() == [-1e-3, 2e300]
    assert np.isnan(values["v_q"][0]) and values["v_q"][1] == 1e-320


def test_a_column_of_the_dump_goes_before_an_array_of_ours():
    Path("a.dump").write_text(snapshot([[1, 2, 3, 4, 5, 6, 7]], columns="x y z vx vy vz speed"))
    good("a.dump", "-o", "run")
    _, values, _ = read_vtp("run/run_00000000.vtp")
    assert values["speed"].tolist() == [7] and values["velocity"].tolist() == [[4, 5, 6]]


@pytest.mark.parametrize("columns, box, expected", [
    ("xu yu zu", BOX, [0.5, 0.25, 2]),
    ("xs ys zs", "ITEM: BOX BOUNDS pp pp pp\n-1 9\n5 25\n0 30\n", [4, 10, 60]),
    ("zsu ysu xsu", "ITEM: BOX BOUNDS pp pp pp\n-1 9\n5 25\n0 30\n", [19, 10, 15]),
    # a box from 0 to 10, 20, 30 with tilts 1, -2, 3: LAMMPS writes the bounds of the whole
    ("xs ys zs", "ITEM: BOX BOUNDS xy xz yz pp pp pp\n-2 11 1\n0 23 -2\n0 30 3\n", [5 + 0.25 - 4, 5 + 6, 60]),
])
def test_unwrapped_and_scaled_positions(columns, box, expected):
    Path("a.dump").write_text(snapshot([[0.5, 0.25, 2]], columns=columns, box=box))
    good("a.dump", "-o", "run")
    assert read_vtp("run/run_00000000.vtp")[0].tolist() == [expected]


def test_several_files_and_snapshots_sorted_by_step(here):
    parts = {step: snapshot(balls(3 + step, seed=step), step) for step in (0, 2, 5, 10, 20)}
    Path("b.dump").write_text(parts[10] + "\n" + parts[20])
    with gzip.open("a.dump.gz", "wt") as file:
        file.write(parts[5] + parts[0])
    with gzip.open("a.dump.gz", "at") as file:       # a second member, as an appending run writes
        file.write(parts[2])
    Path("empty.dump").write_text(snapshot([], 3))
    good("b.dump", "a.dump.gz", "empty.dump", "--dt", "0.1", "-o", "run.pvd")
    series = read_pvd("run.pvd")
    assert series == [(step / 10, f"run/run_{step:08d}.vtp") for step in (0, 2, 3, 5, 10, 20)]    # 0.3 to the letter
    for step in parts:
        assert np.array_equal(read_vtp(f"run/run_{step:08d}.vtp")[0], np.array(balls(3 + step, seed=step))[:, 3:6])
    assert read_vtp("run/run_00000003.vtp")[2].GetNumberOfPoints() == 0
    assert arrays(read_vtp("run/run_00000005.vtp")[2].GetFieldData())["TimeValue"] == [0.5]


def test_a_step_that_comes_twice_is_dropped_with_a_word():
    one, two = snapshot(balls(2), 100), snapshot(balls(3), 100)
    Path("a.dump").write_text(one)
    Path("b.dump").write_text(two + two + snapshot(balls(4), 200))
    result = run("a.dump", "b.dump", "-o", "run")
    assert result.returncode == 0
    assert result.stderr == ("dump2vtk: warning: b.dump, line 1: step 100 is dropped, it is in a.dump, line 1; "
                             "so are 1 more of this file\n")
    assert len(read_vtp("run/run_00000100.vtp")[0]) == 2 and len(read_pvd("run.pvd")) == 2


def test_snapshots_of_a_longer_run_before_are_noticed():
    for step, written in ((100, 5000), (200, 5010), (300, 4000)):
        Path(f"a.{step}.dump").write_text(snapshot(balls(2), step))
        os.utime(f"a.{step}.dump", (written, written))
    result = run("a.100.dump", "a.200.dump", "a.300.dump", "-o", "run")
    assert result.returncode == 0 and len(read_pvd("run.pvd")) == 3
    assert result.stderr == ("dump2vtk: warning: a.300.dump, line 1: step 300 was written before step 200 of "
                             "a.200.dump, line 1: is it of another run?\n")
    os.utime("a.300.dump", (5010, 5010))
    assert run("a.100.dump", "a.200.dump", "a.300.dump", "-o", "again").stderr == ""


def test_time_of_the_dump():
    head = "ITEM: UNITS\nsi\nITEM: TIME\n"
    Path("a.dump").write_text(snapshot(balls(1), 7, head=head + "0.25\n") +
                              snapshot(balls(1), 9, head="ITEM: TIME\n0.3125\n"))
    good("a.dump", "-o", "run")
    assert [time for time, _ in read_pvd("run.pvd")] == [0.25, 0.3125]
    good("a.dump", "-o", "run", "--dt", "2")         # what is typed counts
    assert [time for time, _ in read_pvd("run.pvd")] == [14, 18]
    Path("b.dump").write_text(snapshot(balls(1), 8))
    assert bad("a.dump", "b.dump", "-o", "new") == ("b.dump, line 1: ITEM: TIME must be in all snapshots or in none, "
                                                    "the one of a.dump, line 1 is different; give --dt")


def test_single_precision_is_smaller():
    rows = balls(2000)
    Path("a.dump").write_text(snapshot(rows))
    good("a.dump", "-o", "double")
    good("a.dump", "-o", "single", "--single")
    points, values, _ = read_vtp("single/single_00000000.vtp")
    assert points.dtype == np.float32 and np.array_equal(points, np.array(rows, np.float32)[:, 3:6])
    assert values["id"].tolist() == list(range(1, 2001))
    size = [os.path.getsize(f"{name}/{name}_00000000.vtp") for name in ("single", "double")]
    assert size[0] < 0.6 * size[1]


def test_a_new_series_replaces_the_old_one(here):
    """Old snapshots would show up between the new ones; other files are not touched."""
    Path("sub").mkdir()
    for step in (0, 123456789):
        Path("a.dump").write_text(snapshot(balls(2), step))
        good("a.dump", "-o", "sub/run")
        Path("sub/run/run_notes.vtp").write_text("mine")
    assert sorted(os.listdir("sub/run")) == ["run_123456789.vtp", "run_notes.vtp"]
    assert read_pvd("sub/run.pvd") == [(123456789, "run/run_123456789.vtp")]
    assert sorted(os.listdir("sub")) == ["run", "run.pvd"]


PEAK = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL);"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")


def test_memory_does_not_grow_with_the_number_of_snapshots(here):
    n = 50000
    line = "".join(f"{i} 1 1.25 {i % 211} {i % 97} {i % 41} {i % 13} 0 0 0 0 1\n" for i in range(n))
    head = "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n%d\n%sITEM: ATOMS %s\n" % (n, BOX, COLUMNS)
    peak = {}
    for count in (2, 20):
        with gzip.open("a.dump.gz", "wt", compresslevel=1) as file:
            for step in range(count):
                file.write(head.format(step) + line)
        # by a small process: to the system a program has at first the memory of the one that starts it
        peak[count] = int(subprocess.run([sys.executable, "-c", PEAK, DUMP2VTK, "a.dump.gz", "-o", f"run{count}"],
                                         check=True, stdout=subprocess.PIPE).stdout)
    assert peak[20] < 1.1 * peak[2] and peak[20] < 100000     # kB; the dump has 60 MB


# --- rasters and fixed balls ---

def test_terrain_with_nodata(here):
    z = np.arange(12.0).reshape(3, 4) + 0.123456789
    z[1, 2] = np.nan
    write_asc("terrain.asc", z, x=100.0, y=-5.0)
    assert good("--terrain", "terrain.asc", "-o", "run") == "run.terrain.vts: 4 x 3 points, 1 of them hidden\n"
    points, values, shows, data = read_vts("run.terrain.vts")
    assert np.array_equal(points[0, :, 0], [101, 103, 105, 107]) and np.array_equal(points[:, 0, 1], [-4, -2, 0])
    assert np.array_equal(shows, ~np.isnan(z))
    assert np.array_equal(points[..., 2][shows], z[shows]) and np.array_equal(values["height"][shows], z[shows])
    assert np.isnan(values["height"][1, 2]) and data.GetBounds()[4:] == (z[0, 0], z[2, 3])
    threshold = vtkThreshold()                        # what the page advises where hidden faces are drawn
    threshold.SetInputData(data)
    threshold.SetInputArrayToProcess(0, 0, 0, 0, "height")
    threshold.SetLowerThreshold(np.nanmin(z))
    threshold.SetUpperThreshold(np.nanmax(z))
    threshold.Update()
    assert threshold.GetOutput().GetNumberOfCells() == 2
    surface = vtkDataSetSurfaceFilter()               # and what ParaView does: this filter alone keeps hidden faces
    surface.SetInputData(data)
    surface.Update()
    surface.GetOutput().RemoveGhostCells()
    assert surface.GetOutput().GetNumberOfCells() == 2
    hidden = [cell for cell in range(6) if not data.IsCellVisible(cell)]
    assert hidden == [1, 2, 4, 5]                     # those with the point as a corner
    assert vtk_to_numpy(data.GetCellData().GetArray("vtkGhostType")).tolist() == [0, 32, 32, 0, 32, 32]


def test_a_raster_is_laid_on_the_terrain_or_on_the_surface(here):
    y, x = np.mgrid[1:21:2, 1:31:2]
    terrain = 3.0 + 0.5 * x - 0.25 * y               # a plane: bilinear is exact
    terrain[9, 14] = np.nan
    write_asc("terrain.asc", terrain)
    thickness = np.linspace(0, 2, 12).reshape(3, 4)
    thickness[0, 0] = np.nan
    write_asc("p.thickness.asc", thickness, x=4.5, y=3.0, cell=5.0)
    write_asc("p.00000900.thickness.asc", thickness, x=20.5, y=6.0, cell=5.0)     # beyond the terrain in the east
    good("--terrain", "terrain.asc", "--raster", "p.thickness.asc", "p.00000900.thickness.asc", "-o", "run")
    assert sorted(os.listdir(".")) == ["p.00000900.thickness.asc", "p.thickness.asc", "run.00000900.thickness.vts",
                                       "run.terrain.vts", "run.thickness.vts", "terrain.asc"]
    points, values, shows, _ = read_vts("run.thickness.vts")
    assert np.array_equal(shows, ~np.isnan(thickness))
    assert np.allclose(points[..., 2][shows], (3 + 0.5 * points[..., 0] - 0.25 * points[..., 1])[shows], atol=1e-12)
    assert np.array_equal(values["thickness"][shows], thickness[shows])
    _, values, shows, _ = read_vts("run.00000900.thickness.vts")
    assert np.array_equal(shows, [[False, True, False, False], [True, True, False, False], [True, False, False, False]])
    assert values["thickness"][0, 1] == thickness[0, 1]

    # beside a NODATA cell a centre of the surface keeps its own height
    surface = np.full((3, 4), 7.125)
    surface[1, 1] = np.nan
    write_asc("p.surface.asc", surface, x=4.1, y=3.3, cell=0.7)
    write_asc("p.thickness.asc", np.ones((3, 4)), x=4.1, y=3.3, cell=0.7)
    good("--raster", "p.thickness.asc", "--surface", "p.surface.asc", "-o", "run")
    points, _, shows, _ = read_vts("run.thickness.vts")
    assert np.array_equal(shows, ~np.isnan(surface)) and np.all(points[..., 2] == 7.125)


def write_sidecar(path, east, north, epsg=32654):
    Path(path).write_text(f"# About it.\ncrs:\n  epsg: {epsg}\n  wkt: PROJCS[\"WGS 84 / UTM\n    54N\"]\norigin:\n"
                          f"  east: {east}\n  north: {north}\ncell: 2.0\n")


def test_a_raster_of_another_origin_is_moved_or_refused(here):
    """Its sidecar says where it lies; without one it is in the terrain's coordinates."""
    write_asc("terrain.asc", np.zeros((4, 5)))
    write_asc("p.wide.asc", np.arange(42.0).reshape(6, 7))
    write_asc("p.near.asc", np.ones((4, 5)))
    write_sidecar("terrain.yaml", 380000.0, 4000000.0)
    write_sidecar("p.wide.yaml", 379998.0, 3999998.5)
    command = "--terrain", "terrain.asc", "--raster", "p.wide.asc", "p.near.asc", "-o", "run"
    good(*command)
    x, y = (read_vts("run.wide.vts")[0][..., k] for k in (0, 1))
    assert (x.min(), x.max(), y.min(), y.max()) == (-1, 11, -0.5, 9.5)
    assert read_vts("run.near.vts")[0][..., :2].min() == 1
    write_sidecar("p.wide.yaml", 379998.0, 3999998.5, epsg="null")
    good(*command)
    for text, message in ((379998.0, None), ("x", "p.wide.yaml, line 7: origin must be numbers, got x")):
        write_sidecar("p.wide.yaml", text, 3999998.5, epsg=6677)
        assert (message or "p.wide.asc must be in the CRS of terrain.asc, EPSG:32654, got EPSG:6677") in bad(*command)
    Path("p.wide.yaml").write_text("warnings: []\n")
    assert "p.wide.yaml must be the sidecar of p.wide.asc" in bad(*command)


def test_the_deposit_of_a_run(here):
    """Its base is the ground, where the scar shows, and its time step gives the time of dumps that have none."""
    terrain = np.full((5, 6), 20.0)
    base = terrain.copy()
    base[1:4, 2:5] = 12.5                             # the scar
    thickness = np.where(np.arange(6) < 2, 1.5, 0.0) * np.ones((5, 1))
    write_asc("terrain.asc", terrain)
    for name, values in (("base", base), ("thickness", thickness), ("surface", base + thickness)):
        write_asc(f"p.{name}.asc", values)
    Path("p.summary.yaml").write_text("# of the fix\nfix: 'deposit'\ntime: 7.5\ndt: 0.0025\nranks: 1\n")
    Path("a.dump").write_text(snapshot(balls(3), 0) + snapshot(balls(3), 3000))
    good("a.dump", "--deposit", "p", "-o", "run")
    points, values, _, _ = read_vts("run.terrain.vts")
    assert np.array_equal(points[..., 2], base) and np.array_equal(values["height"], base)
    points, values, _, _ = read_vts("run.thickness.vts")
    assert np.array_equal(points[..., 2], base + thickness) and np.array_equal(values["thickness"], thickness)
    assert [time for time, _ in read_pvd("run.pvd")] == [0, 7.5]

    # --terrain takes it by its name, and goes before it; so do a time step and the dump's own times
    good("--terrain", "p.base.asc", "-o", "other")
    assert np.array_equal(read_vts("other.terrain.vts")[0][..., 2], base)
    good("a.dump", "--deposit", "p", "--terrain", "terrain.asc", "--surface", "terrain.asc", "--dt", "1", "-o", "run")
    assert np.array_equal(read_vts("run.terrain.vts")[0][..., 2], terrain)
    assert np.array_equal(read_vts("run.thickness.vts")[0][..., 2], terrain)
    assert [time for time, _ in read_pvd("run.pvd")] == [0, 3000]
    timed = "".join(f"ITEM: TIME\n{time}\n" + snapshot(balls(3), step) for step, time in ((0, 1.5), (3000, 9.0)))
    Path("b.dump").write_text(timed)
    good("b.dump", "--deposit", "p", "-o", "timed")
    assert [time for time, _ in read_pvd("timed.pvd")] == [1.5, 9]


def test_fixed_balls(here):
    Path("slip.xyz").write_text("# x y z\n1 2 3\n\n4.5 -5e-1 6 # last\n")
    Path("field.xyz").write_text("7 8 9\n")
    good("--balls", "slip.xyz", "field.xyz", "--diameter", "1.25", "-o", "run")
    points, values, _ = read_vtp("run.balls.vtp")
    assert points.tolist() == [[1, 2, 3], [4.5, -0.5, 6], [7, 8, 9]]
    assert values["diameter"].tolist() == [1.25] * 3 and values["file"].tolist() == [1, 1, 2]


def test_diameter_for_a_dump_without_one():
    Path("a.dump").write_text(snapshot([[1, 2, 3]], columns="x y z"))
    good("a.dump", "--diameter", "2.5", "-o", "run")
    assert read_vtp("run/run_00000000.vtp")[1]["diameter"].tolist() == [2.5]


# --- bad input ---

GOOD = snapshot(balls(3), 5)


def xyz(*rows, columns="x y z", box=BOX):
    return snapshot(rows, columns=columns, box=box)


BAD_DUMPS = [       # a text, and what is said of its lines
    ("ncols 3\n", "1: must begin with ITEM:, as a text dump of LAMMPS does, got ncols 3"),
    ("\x00\x01\x02binary\n", "1: must begin with ITEM:, as a text dump of LAMMPS does, got ???binary"),
    ("x" * 3000000, "1: must be a line of text, got more than 1048576 characters"),
    ("\n\n", "2: must be a LAMMPS dump with ITEM: TIMESTEP, got none"),
    ("ITEM: TIMESTEP\n0\nITEM: GRID\n1\n", "3: must be an item of dump style atom or custom, got ITEM: GRID"),
    (GOOD + "1 2\n", "13: must be an ITEM line, got 1 2"),
    (GOOD.replace("\n5\n", "\nfive\n"), "2: TIMESTEP must be a number, got five"),
    (GOOD.replace("\n5\n", "\n-5\n"), "2: TIMESTEP must be a whole number >= 0, got -5"),
    (GOOD.replace("\n3\n", "\n2.5\n"), "4: NUMBER OF ATOMS must be a whole number >= 0, got 2.5"),
    (GOOD.replace("0 20", "0 up"), "7: BOX BOUNDS must be numbers, got up"),
    (GOOD.replace("ITEM: NUMBER OF ATOMS\n3\n", ""), "7: ITEM: NUMBER OF ATOMS must stand before ITEM: ATOMS"),
    (GOOD.replace("ITEM: TIMESTEP\n5\n", ""), "7: ITEM: TIMESTEP must stand before ITEM: ATOMS"),
    (xyz([1, 2], columns="x y"), "9: there must be columns x y z, xu yu zu, xs ys zs or xsu ysu zsu, got x y"),
    (xyz([1, 2, 3], columns="xs ys zs", box=""),
     "5: scaled positions need ITEM: BOX BOUNDS with lo hi or lo hi tilt"),
    (xyz([1, 2, 3, 4], columns="x y z x"), "9: columns must have different names, got twice x"),
    (xyz([1, 2, 3], [1, 2]), "11: must have 3 columns, as in line 9, got 2"),
    (xyz([1, 2, "3m"]), "10: column z must be a number, got 3m"),
    (xyz([1, "nan", 3]), "10: column y must be finite, got nan"),
    (xyz([1, 2, 3, 1.5], columns="x y z id"), "10: column id must be a whole number, got 1.5"),
    # cut short
    (snapshot(balls(3), 5, count=4), "12: the snapshot of step 5 is cut short, got 3 of 4 balls"),
    (snapshot(balls(3), 5, count=10**15) + GOOD, f"13: the snapshot of step 5 is cut short, got 3 of {10**15} balls"),
    (GOOD[:-5], "12: the snapshot of step 5 is cut short, got 2 of 3 balls"),
    (GOOD[:-1], "12: the snapshot of step 5 is cut short, got 2 of 3 balls"),
    (GOOD + "ITEM: TIMESTEP\n", "13: the file ends in the header of a snapshot, at TIMESTEP"),
    (GOOD + "ITEM: TIMESTEP\n6\n", "14: the file ends in the header of a snapshot"),
    (GOOD + "ITEM: TIMESTEP\n1", "14: the file ends in the header of a snapshot, at TIMESTEP")]


@pytest.mark.parametrize("text, message", BAD_DUMPS, ids=range(len(BAD_DUMPS)))
def test_bad_dump(text, message):
    Path("a.dump").write_text(text)
    assert bad("a.dump", "-o", "run") == f"a.dump, line {message}"


def test_an_empty_dump():
    Path("a.dump").touch()
    assert bad("a.dump", "-o", "run") == "a.dump is empty"


def test_the_second_of_two_files_is_bad():
    """Nothing is written of the first one either, and an earlier result stays."""
    Path("a.dump").write_text(GOOD)
    Path("b.dump").write_text(snapshot(balls(3), 6, count=9))
    good("a.dump", "-o", "run")
    assert "b.dump, line 12" in bad("a.dump", "b.dump", "-o", "run")
    assert "b.dump, line 12" in bad("a.dump", "b.dump", "-o", "new")


@pytest.mark.parametrize("text", [
    GOOD + snapshot(balls(3), 6, count=9), GOOD + "ITEM: TIMESTEP\n", GOOD + "ITEM: TIMESTEP\n6\nITEM: NUM",
    snapshot(balls(3), 6, count=9) + GOOD, "ITEM: TIMESTEP\n6\n" + GOOD, "ITEM: TIMESTEP\n" + GOOD,
    "ITEM: TIMESTEP\n6\nITEM: NUMBER OF ATOMS\n" + GOOD,
], ids=range(7))
def test_skip_truncated(text):
    Path("a.dump").write_text(text)
    bad("a.dump", "-o", "run")
    result = run("a.dump", "-o", "run", "--skip-truncated")
    assert result.returncode == 0 and re.fullmatch(r"dump2vtk: warning: a.dump, line \d+: .*; skipped\n", result.stderr)
    assert read_pvd("run.pvd") == [(5, "run/run_00000005.vtp")]


def test_skip_truncated_without_a_complete_snapshot():
    Path("a.dump").write_text(snapshot(balls(3), 6, count=9))
    result = run("a.dump", "-o", "run", "--skip-truncated")
    assert result.returncode == 2 and result.stderr.endswith("\ndump2vtk: the dumps have no complete snapshot\n")
    assert os.listdir() == ["a.dump"]


def test_bad_gz():
    data = gzip.compress((snapshot(balls(3000), 1) + snapshot(balls(3000), 2)).encode())
    Path("a.dump.gz").write_bytes(data[:len(data) * 3 // 4])
    message = bad("a.dump.gz", "-o", "run")
    assert re.fullmatch(r"a.dump.gz, (after line \d+: the compressed file is cut short"
                        r"|line \d+: the snapshot of step 2 is cut short, got \d+ of 3000 balls)", message)
    result = run("a.dump.gz", "-o", "run", "--skip-truncated")
    assert result.returncode == 0 and read_pvd("run.pvd") == [(1, "run/run_00000001.vtp")]
    # cut between two snapshots: only the missing end of the compressed stream tells
    stream = zlib.compressobj(wbits=31)
    Path("c.dump.gz").write_bytes(stream.compress(GOOD.encode()) + stream.flush(zlib.Z_FULL_FLUSH))
    assert bad("c.dump.gz", "-o", "c") == "c.dump.gz, after line 12: the compressed file is cut short"
    assert run("c.dump.gz", "-o", "c", "--skip-truncated").returncode == 0
    Path("b.dump.gz").write_bytes(data[:2000] + bytes(100) + data[2100:])
    assert re.fullmatch(r"b.dump.gz, .*", bad("b.dump.gz", "-o", "b"))


@pytest.mark.parametrize("words, message", [
    ("missing.dump -o run", "cannot read missing.dump: No such file or directory"),
    ("folder -o run", "cannot read folder: Is a directory"),
    ("a.dump", "-o OUT is missing; see --help"),
    ("-o run", "no input: give dumps, --deposit, --terrain, --raster or --balls; see --help"),
    ("a.dump -o", "-o must have a value"),
    ("a.dump -o folder/", "-o must end in a name, got folder/"),
    ("a.dump -o run -o other", "-o is given twice"),
    ("a.dump -o run --colour red", "unknown option --colour; see --help"),
    ("a.dump -o run --single=yes", "--single takes no value, got yes"),
    ("a.dump -o run --dt 0", "--dt must be a number > 0, got 0"),
    ("--balls b.xyz -o run", "--balls needs --diameter"),
    ("--raster t.asc -o run", "--raster needs --terrain or --surface to lie on"),
    ("a.dump --surface t.asc -o run", "--surface needs --raster"),
    ("--deposit none -o run", "cannot read none.base.asc: No such file or directory"),
    ("a.dump --deposit none -o run", "cannot read none.summary.yaml: No such file or directory"),
    ("a.dump --deposit p -o run", "p.summary.yaml, line 2: dt must be a number > 0, got -1"),
    ("a.dump --deposit q -o run", "q.summary.yaml must be a summary of fix deposit/grid, with a line dt:, got none"),
    ("--terrain a.dump -o run", "a.dump, line 1: must be a header key of an ESRI ASCII grid or a number, got ITEM:"),
    ("--terrain t.asc --raster t.asc far.asc -o run",
     "far.asc must have a value somewhere on t.asc, which is x 0 to 6, y 0 to 4, got x 6 to 12, y 0 to 4"),
    ("--terrain t.asc --raster p.h.asc folder/q.h.asc -o run",
     "--raster: p.h.asc and folder/q.h.asc would both become run.h.vts"),
    ("--balls a.dump --diameter 1 -o run", "a.dump, line 1: must be x y z of a ball, got 2 words"),
    ("--balls bad.xyz --diameter 1 -o run", "bad.xyz, line 2: must be three finite numbers x y z, got z"),
    ("--balls none.xyz --diameter 1 -o run", "none.xyz must have lines x y z, got none"),
    ("a.dump -o no/run", "cannot write no/run.*: No such file or directory"),
    ("a.dump -o a.dump/run", "cannot write a.dump/run.*: Not a directory"),
    ("a.dump -o t.asc", "cannot write t.asc/: a file has this name"),
    ("a.dump -o /proc/run", "cannot write /proc/run.*: No such file or directory"),
])
def test_bad_command(words, message, here):
    Path("a.dump").write_text(GOOD)
    Path("folder").mkdir()
    Path("b.xyz").write_text("1 2 3\n")
    Path("bad.xyz").write_text("1 2 3\n1 2 z\n")
    Path("none.xyz").write_text("# x y z\n")
    Path("p.summary.yaml").write_text("time: 0.5\ndt: -1\n")
    Path("q.summary.yaml").write_text("time: 0.5\n")
    for path in ("t.asc", "p.h.asc", "folder/q.h.asc"):
        write_asc(path, np.ones((2, 3)))
    write_asc("far.asc", np.ones((2, 3)), x=6.0)
    assert bad(*words.split()) == message


def test_a_full_disk(here):
    """The limit stands for it; the last block of a file may be missed at closing only, so several limits."""
    Path("a.dump").write_text(snapshot(balls(500)))
    good("a.dump", "-o", "whole")
    size = os.path.getsize("whole/whole_00000000.vtp")
    for limit in (100, size // 2, size - 4096, size - 1):
        message = bad("a.dump", "-o", "run",
                      preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        assert message.startswith("cannot write ") and "run_00000000.vtp" in message


def test_interrupt_leaves_nothing(here):
    with open("a.dump", "w") as file:
        for step in range(400):
            file.write(snapshot(balls(300), step))
    process = subprocess.Popen([DUMP2VTK, "a.dump", "-o", "run"], stderr=subprocess.PIPE, text=True)
    while not list(Path(".").glob("run.tmp.*/*.vtp")) and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=20)[1] == "dump2vtk: interrupted, nothing is written\n"
    assert process.returncode == 130 and os.listdir() == ["a.dump"]


def test_help():
    text = good("--help")
    assert "Example:" in text and "metres" in text
    page = (TOP / "doc" / "src" / "tool_dump2vtk.rst").read_text()
    for option in re.findall(r"--[a-z-]+", text):
        assert option in page
