"""region polygon: the prism over it, alone and with other regions and commands, and bad input."""

import re

import numpy as np
import pytest
from shapely.geometry import Point, Polygon, box

from deck_helpers import doc_examples, run_deck, write_asc

from slope_tools.survey import polygons, rasters

SQUARE = "0,0\n10,0\n10,10\n0,10\n"
HOLE = SQUARE + "\n4,4\n4,7\n7,7\n7,4\n"

DECK = """
units si
atom_style sphere
boundary f f f
region box block -5 25 -5 25 0 5
create_box 1 box
{regions}
lattice sc 1
create_atoms 1 region {region} units box
write_dump all custom balls.dump x y z
"""


def deck(regions="region road polygon road.csv", region="road"):
    return DECK.format(regions=regions, region=region)


def balls(tmp_path):
    return np.loadtxt(tmp_path / "balls.dump", skiprows=9, ndmin=2)


def plan(tmp_path):
    return {(round(x), round(y)) for x, y, _ in balls(tmp_path)}


def nodes(xlo, xhi, ylo, yhi):
    return {(x, y) for x in range(xlo, xhi) for y in range(ylo, yhi)}


@pytest.mark.parametrize("np_", [1, 2])
def test_a_prism_with_a_hole(tmp_path, np_):
    """As many lattice points as the area, at all heights: an edge belongs to its east and north."""
    (tmp_path / "road.csv").write_text(HOLE)
    log = run_deck(deck(), tmp_path, np=np_)
    assert plan(tmp_path) == nodes(0, 10, 0, 10) - nodes(4, 7, 4, 7)
    assert sorted(set(balls(tmp_path)[:, 2])) == [0, 1, 2, 3, 4]  # not on the box's upper face
    assert len(balls(tmp_path)) == 5 * 91
    assert log.count("Region polygon road: 2 rings, 8 points, x 0 to 10, y 0 to 10, area 91\n") == 1


def test_sides_and_motion(tmp_path):
    (tmp_path / "road.csv").write_text(HOLE)
    road, everywhere = nodes(0, 10, 0, 10) - nodes(4, 7, 4, 7), nodes(-5, 25, -5, 25)
    run_deck(deck("region road polygon road.csv side out"), tmp_path)
    assert plan(tmp_path) == everywhere - road
    run_deck(deck("variable a equal 8\nregion road polygon road.csv side out move v_a NULL NULL units box"), tmp_path)
    assert plan(tmp_path) == everywhere - {(x + 8, y) for x, y in road}


def test_other_regions(tmp_path):
    """Two polygons that share an edge share no ball and lose none; union and intersect have bounding boxes."""
    (tmp_path / "road.csv").write_text(SQUARE)
    (tmp_path / "next.csv").write_text("10,10\n10,0\n20,3\n")
    regions = "region road polygon road.csv\nregion next polygon next.csv\n"
    run_deck(deck(regions, "next"), tmp_path)
    beside = plan(tmp_path)
    run_deck(deck(regions + "region both union 2 road next", "both"), tmp_path)
    assert beside and not beside & nodes(0, 10, 0, 10)
    assert plan(tmp_path) == beside | nodes(0, 10, 0, 10)
    run_deck(deck(regions + "region low block 5 INF INF INF INF 2\nregion part intersect 2 road low",
                  "part"), tmp_path)
    assert plan(tmp_path) == nodes(5, 10, 0, 10)
    assert set(balls(tmp_path)[:, 2]) == {0, 1, 2}


def test_the_box_of_the_mass_below_the_terrain(tmp_path):
    """create_box before there is a box, on the intersection with a terrain."""
    write_asc(tmp_path / "ground.asc", np.full((16, 16), 7.0), cell=2.0)
    (tmp_path / "road.csv").write_text("5,5\n15,5\n15,20\n5,20\n")
    log = run_deck("""
units si
atom_style sphere
boundary f f f
region ground terrain ground.asc depth 3 headroom 2
region plan polygon road.csv
region mass intersect 2 ground plan
create_box 1 mass
print "box: $(xlo) $(ylo) $(zlo) $(xhi) $(yhi) $(zhi)"
lattice sc 0.5
create_atoms 1 region mass units box
write_dump all custom balls.dump x y z
""", tmp_path)
    assert "\nbox: 5 5 4 15 20 9\n" in log
    # a ball volume of 0.125 m3 each: those of 10 x 15 x 3 m, and z = 4 and 7 both in
    assert len(balls(tmp_path)) == 20 * 30 * 7


def test_fixed_balls_on_a_polygon(tmp_path):
    """surface, inside and outside of create_balls: the polygon parts the ground's balls."""
    write_asc(tmp_path / "ground.asc", np.full((16, 16), 3.0), cell=2.0)
    (tmp_path / "road.csv").write_text(HOLE)
    counts = []
    for filters in ("", "inside road", "outside road"):
        log = run_deck(f"""
units si
atom_style sphere
boundary f f f
region ground terrain ground.asc depth 3 headroom 2
region road polygon road.csv
create_box 1 ground
create_balls 1 1.0 2600 surface ground upper spacing 1.0 origin 0.5 0.5 {filters}
""", tmp_path)
        counts.append(int(log.split("Create_balls: ")[1].split()[0]))
    assert counts[1] == 91 and counts[1] + counts[2] == counts[0]


def test_bad_file(tmp_path):
    """It ends the run on all ranks with one line, and does not hang; one rank: test_wrong_input.py."""
    run_deck(deck(), tmp_path, np=2, timeout=60,
             expect_error="Region polygon: cannot read road.csv: No such file or directory")


def test_what_slope_polygon_writes(tmp_path):
    """The tool's rings are the tool's polygons: the same area, the same lattice points inside."""
    x, y = np.meshgrid(np.arange(-5, 25) + 0.0, np.arange(-5, 25) + 0.0)
    angle = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    radius = 7 + 2 * np.sin(9 * angle)
    star = Polygon(np.transpose([9.3 + radius * np.cos(angle), 8.7 + radius * np.sin(angle)]))
    whole = star.difference(box(8.5, 6.5, 12.5, 9.5)).union(box(18.5, 18.5, 21.5, 22.5)).union(box(9.5, 7.5, 10.5, 8.5))
    place = rasters.Place(None, (0.0, 0.0), (30, 30), (-5.0, -5.0, 25.0, 25.0))
    written = polygons.write_polygon(tmp_path / "road.csv", whole, place)
    log = run_deck(deck(), tmp_path)
    said = log.split("Region polygon road: ")[1].splitlines()[0]
    assert said.startswith("4 rings, ") and float(said.split()[-1]) == pytest.approx(written.area, rel=1e-7)
    assert plan(tmp_path) == {(i, j) for i, j in zip(x.ravel(), y.ravel()) if written.contains(Point(i, j))}


def test_doc_examples(tmp_path):
    write_asc(tmp_path / "terrain.asc", np.full((30, 40), 200.0), cell=10.0)
    for name in ("road.csv", "release.csv"):
        (tmp_path / name).write_text("90,60\n130,60\n130,100\n90,100\n")
    log = run_deck("units si\natom_style sphere\nboundary f f f\n" + doc_examples("region_polygon") + """
create_box 1 mass
lattice sc 5
create_atoms 1 region mass
""", tmp_path)
    corners = re.search(r"orthogonal box = \((.*)\) to \((.*)\)", log)
    assert [float(word) for word in " ".join(corners.groups()).split()] == [90, 60, 150, 130, 100, 250]
