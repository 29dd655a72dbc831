"""Fix wall/gran/mesh: forces, moments, pressures and files; heaps at rest; nothing passes; what is refused."""

import os
import struct
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from deck_helpers import doc_examples, run_deck, write_asc
from mesh_helpers import RHO, STIFFNESS, bowl, box, mesh_deck, plane, run_case, stl_bytes, stl_text, write_case

MASS = RHO * np.pi / 6


def write_heap(tmp_path):
    """Two hundred balls above the floor of a box without a lid, apart from each other."""
    rng = np.random.default_rng(4)
    x = np.array([(i, j, k) for k in range(8) for i in range(5) for j in range(5)], float)
    x = (x - (2, 2, 0)) * 1.06 + (0, 0, 0.55) + rng.uniform(-0.025, 0.025, x.shape)
    closed = box((-2.7, -2.7, 0), (2.7, 2.7, 12))
    write_case(tmp_path, closed[closed[..., 2].min(axis=1) < 11], x, (0, 0, 0))
    return MASS * len(x) * 9.81


def test_a_heap_in_a_box_presses_with_its_weight(tmp_path):
    weight = write_heap(tmp_path)
    rows, frames, log = run_case(tmp_path, "run 7500", exclude=False, g=9.81, every=100, dump_every=7500,
                                 keywords="output out 1500 point 0 0 5",
                                 coeff="restitution 0.3 friction 25 rolling 0.1")
    assert np.abs(frames[-1, :, 4:7]).max() < 0.01    # at rest
    assert rows[-1, 2] > 40
    assert -rows[-1, 5] == pytest.approx(weight, rel=0.01)
    assert np.abs(rows[-1, 3:5]).max() < 0.01 * weight
    assert np.abs(rows[-1, 6:9]).max() < 0.05 * weight    # about a point of the axis
    assert "grew" not in log and "WARNING" not in log.replace("WARNING: Using", "")

    series = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
    assert list(series["step"]) == [1500, 3000, 4500, 6000, 7500]
    assert series["fz"][-1] == pytest.approx(rows[-1, 5], rel=1e-8)
    assert series["largest_force"][0] > 1.05 * weight > 0.9 * series["largest_force"][-1]
    triangles = np.genfromtxt(tmp_path / "out.triangles.csv", delimiter=",", names=True)
    floor = triangles["z"] == 0
    assert floor.sum() == 2
    assert (triangles["last_pressure"] * triangles["area"])[floor].sum() == pytest.approx(weight, rel=0.1)
    assert (triangles["largest_pressure"] > triangles["last_pressure"]).all()

    piece = ElementTree.parse(tmp_path / "out.vtp").getroot().find("PolyData/Piece")
    assert piece.get("NumberOfPolys") == "10"
    values = {a.get("Name"): np.array(a.text.split(), float) for a in piece.iter("DataArray")}
    assert len(values["corners"]) == 90 and len(values["connectivity"]) == 30
    assert values["last_pressure"].sum() == pytest.approx(triangles["last_pressure"].sum(), rel=1e-8)


def test_step_numbers_that_recur_neither_lose_a_row_nor_bring_an_old_load(tmp_path):
    write_case(tmp_path, plane(1), (3.0, -1.0, 0.5), (0, 0, -1))
    case = dict(style="scheme plain", keywords="output out 10")
    rows = run_case(tmp_path, "run 60", **case)[0]
    touches = rows[rows[:, 2] > 0]
    last = int(touches[-1, 0])
    assert 2 < last < 50 and touches[-1, 5] != 0
    for step, steps in ((0, last), (50, 10)):    # the ball flies
        run_case(tmp_path, f"run 60\nundump path\nreset_timestep {step}\nrun {steps}", **case)
        series = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True)
        end = step + steps
        assert list(series["step"]) == [*range(10, 61, 10), *range(step // 10 * 10 + 10, end, 10), end]
        triangles = np.genfromtxt(tmp_path / "out.triangles.csv", delimiter=",", names=True)
        assert (triangles["largest_pressure"] > 0) and (triangles["last_pressure"] == 0)


@pytest.mark.parametrize("every", [7, 40, 1000])
def test_what_comes_between_rows_and_after_the_last_one_is_in_the_series(tmp_path, every):
    """Of each step and of many: the same largest force, largest moment and impulse."""
    write_case(tmp_path, plane(5), (3.0, -1.0, 0.5), (0, 0, -1))
    found = []
    for n in (1, every):
        run_case(tmp_path, "run 60", keywords=f"point 0.5 1 7 output out {n}")
        series = np.atleast_1d(np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True))
        assert series["step"][-1] == 60
        found.append([series["largest_force"].max(), series["largest_moment"].max(),
                      *(series[f"j{axis}"][-1] for axis in "xyz")])
        if n == 1:
            assert found[0][1] == pytest.approx(np.sqrt(sum(series[f"m{axis}"] ** 2 for axis in "xyz")).max(), rel=1e-9)
    assert found[0][1] > found[0][0] > 0 and found[1] == found[0]
    # the row at the end, of a continued run without a step, too
    before, keywords = (tmp_path / "out.csv").read_text(), f"point 0.5 1 7 output out {every}"
    run_case(tmp_path, "run 60\nwrite_restart end.restart", keywords=keywords)
    run_case(tmp_path, "run 0", keywords=keywords, begin="read_restart end.restart")
    assert (tmp_path / "out.csv").read_text() == before


def test_what_is_written_of_a_lower_surface_is_that_of_its_file(tmp_path):
    """Balls on a ground that is sunk lie lower, and what stands on it, too: loads, moments and places are the same."""
    found = []
    for lower in (0.0, 0.7):
        write_case(tmp_path, plane(1), (3.0, -1.0, 0.5 - lower), (0, 0, -1))
        rows = run_case(tmp_path, "run 60", keywords=f"lower {lower} point 0.5 1 7 output out 10")[0]
        texts = [(tmp_path / f"out.{name}").read_text() for name in ("triangles.csv", "vtp")]
        piece = ElementTree.fromstring(texts[1]).find("PolyData/Piece")
        found.append((rows, np.genfromtxt(texts[0].splitlines(), delimiter=",", names=True)["z"],
                      [np.array(one.text.split(), float) for one in piece.iter("DataArray")]))
    assert (found[0][0][:, 2] > 0).any()
    for one, other in zip(*found):
        for a, b in zip(np.atleast_1d(one), np.atleast_1d(other)) if not isinstance(one, list) else zip(one, other):
            assert a == pytest.approx(b, rel=1e-6, abs=1e-6 * STIFFNESS * 1e-3)


def test_moment_about_a_point_is_that_of_the_weight(tmp_path):
    write_case(tmp_path, plane(10), (2.0, -1.0, 0.5 - MASS * 9.81 / STIFFNESS), (0, 0, 0))
    rows = run_case(tmp_path, "run 200", g=9.81, keywords="point 0.5 1.0 7.0")[0]
    weight = MASS * 9.81
    assert rows[-1, 6:9] == pytest.approx([2.0 * weight, 1.5 * weight, 0], rel=1e-6, abs=1e-6 * weight)


def test_moment_counts_the_rolling_resistance(tmp_path):
    """A ball that stands on a slope by its rolling resistance: the reaction goes through its centre."""
    slope, x = 0.08, (0.7, 0.3, 0.5 - MASS * 9.81 / STIFFNESS)
    write_case(tmp_path, plane(10), x, (0, 0, 0))
    rows, frames, _ = run_case(tmp_path, "run 4000", g=9.81 * np.hypot(1, slope), down=f"{slope} 0 -1", every=4000,
                               dump_every=4000)
    force = MASS * 9.81 * np.array([slope, 0, -1])
    assert rows[-1, 3:6] == pytest.approx(force, rel=1e-6, abs=1e-3)
    assert rows[-1, 6:9] == pytest.approx(np.cross(frames[-1, 0, 1:4], force), rel=1e-6, abs=1e-3)


def bounce_inside(tmp_path, triangles, outside, balls, steps, speed, seed=3):
    """Balls in a closed mesh, at up to a speed; impacts counted by what is in contact at any time."""
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(balls, 3))
    v = way / np.linalg.norm(way, axis=1)[:, None] * rng.uniform(0.3, 1.0, balls)[:, None] * speed
    x = rng.uniform(-0.7, 0.7, (balls, 3))
    write_case(tmp_path, triangles, x, v)
    rows, frames, log = run_case(tmp_path, f"run {steps}", coeff="restitution 1 friction 0", every=20, skin=0.8,
                                 dump_every=steps // 20, timeout=300 + steps // 10)
    impacts = rows[:, 2].mean() * steps / 12.6    # steps that an undamped contact lasts
    print(f"{impacts} impacts, {log.count('WARNING')} warnings")
    assert not outside(frames[..., 1:4]).any()
    return impacts, log


LIMIT = 0.25 * 0.5 * np.sqrt(STIFFNESS / MASS)    # v/w = R/4
# SLOPE_LONG=1 makes it a long check of its own, of a million impacts on each mesh
BALLS, STEPS = (2000, 75000) if os.environ.get("SLOPE_LONG") else (300, 1500)


@pytest.mark.parametrize("shape", ["box", "bowl", "star"])
def test_nothing_passes_through_a_closed_mesh(tmp_path, shape):
    star = bowl(2.2, 3)
    corners = np.random.default_rng(1).uniform(0.75, 1.25, 1000)
    key = {p: corners[k] for k, p in enumerate(sorted({tuple(np.round(q, 6)) for q in star.reshape(-1, 3)}))}
    meshes = {"box": box((-2, -2, -2), (2, 2, 2)), "bowl": bowl(2.5, 8),
              "star": np.array([[q * key[tuple(np.round(q, 6))] for q in t] for t in star])}
    beyond = {"box": lambda x: np.abs(x).max(axis=-1) > 2, "bowl": lambda x: np.linalg.norm(x, axis=-1) > 2.5,
              "star": lambda x: np.linalg.norm(x, axis=-1) > 2.75}
    impacts, log = bounce_inside(tmp_path, meshes[shape], beyond[shape], BALLS, STEPS, LIMIT)
    assert impacts > 0.004 * BALLS * STEPS


def test_what_is_faster_is_warned_of(tmp_path):
    write_case(tmp_path, plane(10), [(0.3, 0.2, 1.2), (3.0, 0.2, 1.2)], [(0, 0, -1.2 * LIMIT), (0, 0, -0.95 * LIMIT)])
    rows, frames, log = run_case(tmp_path, "run 120", coeff="restitution 1")
    said = [line for line in log.splitlines() if "Fix wall/gran/mesh wall: " in line and "WARNING" in line]
    assert "ball 1 " in said[0] and " 1.2 times the speed" in said[0]
    assert "too fast" in said[-1] and "(ball 1, step " in said[-1] and " 1.2 times the speed" in said[-1]
    assert not any("ball 2" in line for line in said)
    assert frames[-1, :, 6] == pytest.approx([1.2 * LIMIT, 0.95 * LIMIT], rel=1e-3)


def test_smooth_terrain_is_the_mesh_of_its_triangles(tmp_path):
    """A plane up to the rim; and balls slide off where it ends."""
    x = (np.arange(12) - 5.5)[None, :] * np.ones((12, 1))
    write_asc(tmp_path / "ground.asc", 0.25 * x, -6.0, -6.0)
    write_case(tmp_path, plane(1, size=12.0, height=lambda x, y: 0.25 * x), [(0.3, 0.2, 1.0), (3.1, -2.0, 1.8)],
               [(0, 0.5, -1), (0, 0, 0)])
    ends = []
    for wall in ("fix wall all wall/gran/mesh 2 mesh.stl", "fix wall all wall/gran/mesh 2 terrain ground.asc"):
        rows, frames, _ = run_case(tmp_path, "run 1500", g=9.81, wall=wall)
        ends.append((rows, frames))
    assert np.abs(ends[0][1] - ends[1][1]).max() < 1e-9 * np.abs(ends[0][1]).max()
    assert np.abs(ends[0][0] - ends[1][0]).max() < 1e-9 * np.abs(ends[0][0]).max()
    assert ends[0][0][:, 2].max() == 2 and ends[0][1][-1, :, 1].min() < -3


def test_scale_and_move_place_the_mesh(tmp_path):
    triangles = plane(1)
    write_case(tmp_path, triangles * 1000 + (0, 0, 2000), (0.3, 0.2, 1.6), (0, 0, -1))
    rows, frames, log = run_case(tmp_path, "run 100", coeff="restitution 1", keywords="move 0 0 -1 scale 0.001")
    assert frames[:, 0, 3].min() == pytest.approx(1.5, abs=0.15) and rows[:, 2].max() == 1
    assert "2 triangles, area 625, x -12.5 to 12.5, y -12.5 to 12.5, z 1 to 1" in log


def test_text_and_binary_files_are_the_same(tmp_path):
    ends = []
    for data in (stl_bytes(plane(10)), stl_text(plane(10)).encode()):
        write_case(tmp_path, plane(1), (0.3, 0.2, 0.6), (0.5, 0, -1))
        (tmp_path / "mesh.stl").write_bytes(data)
        ends.append(run_case(tmp_path, "run 200", g=9.81)[1])
    assert (ends[0] == ends[1]).all()


DEGENERATE = np.array([[(0, 0, 0), (1, 1, 1), (2, 2, 2)]], float)
START = "fix wall all wall/gran/mesh"


WRONG = {
    "binary, cut": (dict(data=stl_bytes(plane(1))[:-7]),
                    "mesh.stl: the file is cut short, or no STL: 2 triangles need 184 bytes"),
    "millimetres": (dict(data=stl_bytes(plane(1) * 1000)),
                    "the surface of mesh.stl must be at most 100 times as large as the box"),
    "elsewhere": (dict(data=stl_bytes(plane(1) + (0, 50, 0))),
                  "the surface of mesh.stl must reach into the box, y -14 to 14"),
    "in a ball": (dict(data=stl_bytes(plane(1) + (0, 0, 1.3))),
                  "1 pairs overlap at the start by more than 5 % of the radius"),
    "in a ball: what to do": (dict(data=stl_bytes(plane(1) + (0, 0, 1.3))),
                              "(move the surface, or remove the balls there with delete_atoms region)"),
    "grid": (dict(wall=f"{START} 2 ground.asc"), "ground.asc: must be an STL file, got an elevation grid: terrain"),
    "one, cut": (dict(data=stl_bytes(plane(1)[:1])[:-7]), "1 triangle needs 134 bytes"),
    "no file": (dict(wall=f"{START} 2 none.stl"), "cannot read none.stl: No such file"),
    "no grid": (dict(wall=f"{START} 2 terrain none.asc"), "cannot read none.asc"),
    "terrain moved": (dict(wall=f"{START} 2 terrain mesh.stl scale 2"), "scale is for STL files"),
    "no surface": (dict(wall=f"{START} 2"), "needs TYPE and FILE.stl or terrain FILE.asc, got 1 arguments"),
    "no name": (dict(wall=f"{START} 2 terrain"), "terrain: FILE.asc is missing"),
    "type": (dict(wall=f"{START} 3 mesh.stl"), "type must be 1 to 2 (the atom types of the box), got 3"),
    "type word": (dict(wall=f"{START} x mesh.stl"), "type must be a whole number"),
    "keyword": (dict(keywords="size 3"), "unknown keyword size, must be scale, move, lower, point or output"),
    "few values": (dict(keywords="move 1 2"), "move must be followed by dx dy dz, got 2 of 3 values"),
    "scale": (dict(keywords="scale 0"), "scale must be > 0, got 0"),
    "point": (dict(keywords="point 1 inf 2"), "point y must be a finite number, got inf"),
    "every": (dict(keywords="output out 0"), "output Nevery must be >= 1, got 0"),
    "folder": (dict(keywords="output no/such/out 10"), "cannot write no/such/out.csv: No such file"),
    "no pair": (dict(coeff="restitution 0.5\npair_style none"), "requires pair_style gran/restitution"),
}


@pytest.mark.parametrize("change, message", WRONG.values(), ids=WRONG.keys())
def test_what_is_wrong_ends_the_run_with_one_line(tmp_path, change, message):
    write_case(tmp_path, plane(1), (0.3, 0.2, 1.6), (0, 0, -1))
    if "data" in change:
        (tmp_path / "mesh.stl").write_bytes(change["data"])
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)), -10.0, -10.0)
    deck = mesh_deck("run 1", **{key: value for key, value in change.items() if key != "data"})
    run_deck(deck, tmp_path, expect_error=message)
    assert not list(tmp_path.glob("out*"))


@pytest.mark.parametrize("name", ["out.csv", "out.triangles.csv", "out.vtp", "out.lock"])
def test_a_folder_where_a_file_must_be_ends_the_run_before_it_begins(tmp_path, name):
    write_case(tmp_path, plane(1), (0.3, 0.2, 1.6), (0, 0, -1))
    (tmp_path / name).mkdir()
    log = run_deck(mesh_deck("run 1", keywords="output out 10"), tmp_path,
                   expect_error=f"Fix wall/gran/mesh wall: cannot write {name}: Is a directory")
    assert "Step" not in log and [path.name for path in tmp_path.glob("out*")] == [name]


def test_a_coefficient_that_is_missing_ends_the_run(tmp_path):
    write_case(tmp_path, plane(1), (0.3, 0.2, 1.6), (0, 0, -1))
    deck = mesh_deck("run 1").replace("pair_coeff * *", "pair_coeff 1 1")
    run_deck(deck, tmp_path, expect_error="Fix wall/gran/mesh: pair_coeff 1 2 is not set (moving type 1, wall type 2)")


def test_triangles_without_an_area_are_said_and_skipped(tmp_path):
    write_case(tmp_path, np.concatenate([plane(1), DEGENERATE]), (0.3, 0.2, 1.6), (0, 0, -1))
    log = run_case(tmp_path, "run 1")[2]
    assert "WARNING: Fix wall/gran/mesh wall: 1 of the 3 triangles of mesh.stl have no area and are skipped" in log
    assert "Fix wall/gran/mesh wall: 2 triangles" in log


def test_what_follows_the_last_triangle_is_said(tmp_path):
    write_case(tmp_path, plane(1), (0.3, 0.2, 1.6), (0, 0, -1))
    (tmp_path / "mesh.stl").write_bytes(stl_bytes(plane(1))[:80] + struct.pack("<I", 1) + stl_bytes(plane(1))[84:])
    log = run_case(tmp_path, "run 1")[2]
    assert ("WARNING: Fix wall/gran/mesh wall: mesh.stl should end after the 1 triangle that its head says, "
            "got 50 bytes more, which are not read") in log
    assert "Fix wall/gran/mesh wall: 1 triangle, area" in log


@pytest.mark.parametrize("text, origin, said", [(False, 3954321.13, True), (True, 3954321.13, False),
                                                (False, 54321.13, False)])
def test_a_binary_file_far_from_its_origin_has_too_few_digits(tmp_path, text, origin, said):
    """Coordinates of a projection in a binary file are rounded to a quarter of a metre."""
    triangles = plane(1) + [0, origin, 0]
    write_case(tmp_path, plane(1), (0.3, 0.2, 1.6), (0, 0, -1))
    (tmp_path / "mesh.stl").write_bytes(stl_text(triangles).encode() if text else stl_bytes(triangles))
    log = run_case(tmp_path, "run 1\nrun 1", keywords=f"move 0 {-origin} 0")[2]
    warned = [line for line in log.splitlines() if "WARNING" in line and "digits" not in line]
    assert len(warned) == said
    if said:
        assert "Fix wall/gran/mesh wall: a binary STL file" in warned[0]
        assert "5 % of the smallest radius, 0.5, got 0.125:" in warned[0]


def test_a_mesh_much_larger_than_the_box_is_doubted(tmp_path):
    write_case(tmp_path, plane(1) * 20, (0.3, 0.2, 1.6), (0, 0, -1))
    assert "is 17.9 times as large as the box, 28: is it in other units" in run_case(tmp_path, "run 1")[2]


def test_two_fixes_cannot_write_the_same_files(tmp_path):
    write_case(tmp_path, plane(1), (0.3, 0.2, 1.6), (0, 0, -1))
    keywords = f"output out 10\n{START.replace('wall', 'other', 1)} 2 mesh.stl output out 10"
    run_deck(mesh_deck("run 1", keywords=keywords), tmp_path,
             expect_error="Fix wall/gran/mesh wall output must differ from that of fix other, got out")


def test_reduced_output_of_terrain_has_the_touched_triangles_alone(tmp_path):
    write_asc(tmp_path / "ground.asc", np.zeros((20, 20)), -10.0, -10.0)
    write_case(tmp_path, plane(1), (0.3, 0.2, 0.6), (0, 0, -1))
    run_case(tmp_path, "run 100", wall="fix wall all wall/gran/mesh 2 terrain ground.asc output out 50")
    piece = ElementTree.parse(tmp_path / "out.vtp").getroot().find("PolyData/Piece")
    assert piece.get("NumberOfPolys") == "1"
    assert len((tmp_path / "out.triangles.csv").read_text().splitlines()) == 2


def test_examples_of_the_page(tmp_path):
    write_case(tmp_path, plane(1), (0.3, 0.2, 1.6), (0, 0, -1), box_size=40.0)
    for name in ("wall", "pier"):
        scale = 1000 if name == "pier" else 1
        (tmp_path / f"{name}.stl").write_bytes(stl_bytes(scale * box((-3, -1, 0), (-2, 1, 4))))
    write_asc(tmp_path / "field.asc", np.zeros((40, 40)), -20.0, -20.0)
    text = (tmp_path / "balls.data").read_text().replace("2 atom types", "3 atom types")
    (tmp_path / "balls.data").write_text(text)
    examples = doc_examples("fix_wall_gran_mesh")
    assert examples.count("wall/gran/mesh") == 3
    run_deck(mesh_deck("run 200", wall="group soil type 1\n" + examples, columns="f_wall f_pier f_field"), tmp_path)
    assert (tmp_path / "wall.csv").exists()
