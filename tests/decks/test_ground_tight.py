"""The ground of fixed balls does not leak, however steep: balls are pressed on slopes of 30 to 85
degrees and on a vertical step, and stay in front of the surface.

A ball passes a point of the surface only where no fixed centre is within two radii of it. On a
plan grid with spacing 2R this happens on slopes steeper than 54.7 degrees
(doc/src/surface_sampling.rst); the plain plan grid is the negative control."""

import math

import numpy
import pytest

from deck_helpers import run_deck, write_asc

R = 0.5

# heavy pressing: gravity acts along the normal into the surface and down the slope alike
DECK = """
units       si
atom_style  sphere
boundary    f f f
comm_modify vel yes
read_data   balls.data
region      ground terrain ground.asc
pair_style  gran/restitution
pair_coeff  1 1 stiffness 1.0e6 1.0e6 restitution 0.4 friction 20
pair_coeff  1 2 stiffness 1.0e6 1.0e6 restitution 0.4 friction 20
fix         ground all wall/gran/balls 2 1.0 {balls} write fixed.xyz
neighbor    0.2 bin
neigh_modify every 1 delay 0 check yes binsize 3
timestep    2.0e-4
fix         move all nve/sphere
fix         weight all gravity 9.81 vector {gx} 0 {gz}
thermo_modify lost ignore
dump        end all custom 10000 end.dump id x y z
run         10000
"""


def slope_grid(angle):
    """Heights of a plane of this angle that falls along +x, 60 x 20 cells of half a metre."""
    x = 0.5 * (numpy.arange(60) + 0.5)
    return numpy.tile((15.0 - x) * math.tan(math.radians(angle)), (20, 1))


def write_balls(path, places, radius=R):
    lines = ["balls", "", f"{len(places)} atoms", "2 atom types", "", "-10 40 xlo xhi",
             "-10 20 ylo yhi", "-400 400 zlo zhi", "", "Atoms # sphere", ""]
    lines += [f"{k + 1} 1 {2 * radius} 2500 {x} {y} {z}" for k, (x, y, z) in enumerate(places)]
    path.write_text("\n".join(lines) + "\n")


def plan_nodes(angle):
    """The plan grid alone: what the ground was without the sampler's extra balls."""
    t = math.tan(math.radians(angle))
    return "\n".join(f"{x} {y} {(15.0 - x) * t}" for x in range(31) for y in range(11))


def last_places(tmp_path):
    lines = (tmp_path / "end.dump").read_text().splitlines()
    start = max(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS")) + 1
    return numpy.array([[float(word) for word in line.split()[1:]] for line in lines[start:]])


def depth_below_slope(tmp_path, angle, balls, radius=R):
    """Deepest place of a ball centre behind the plane, after two seconds of pressing; radii."""
    a = math.radians(angle)
    normal = numpy.array([math.sin(a), 0.0, math.cos(a)])
    down = numpy.array([math.cos(a), 0.0, -math.sin(a)])
    write_asc(tmp_path / "ground.asc", slope_grid(angle), cell=0.5)
    rng = numpy.random.default_rng(7)
    places = []
    for row in range(8):        # a layer over the upper half, random within its places
        for column in range(6):
            along = 1.5 * (column - 4.0) + 0.3 * rng.random()
            start = numpy.array([15.0, 0.0, 0.0]) + along * down + 1.6 * normal
            places.append((start[0], 0.8 + 1.1 * row + 0.08 * rng.random(), start[2]))
    write_balls(tmp_path / "balls.data", places, radius)
    pull = -normal + 0.3 * down
    deck = DECK.format(balls=balls, gx=pull[0], gz=pull[2])
    run_deck(deck, tmp_path)
    inside = last_places(tmp_path)
    inside = inside[(inside[:, 0] > 1) & (inside[:, 0] < 29) & (inside[:, 1] > 0.5) & (inside[:, 1] < 9.5)]
    assert len(inside) >= 10, "too few balls stayed on the slope to tell"
    behind = -((inside - numpy.array([15.0, 0.0, 0.0])) @ normal)
    return behind.max() / R


SURFACE = "surface ground upper spacing 1.0"


@pytest.mark.parametrize("angle", [30, 45, 54, 60, 70, 80, 85])
def test_slope_is_tight(tmp_path, angle):
    assert depth_below_slope(tmp_path, angle, SURFACE) < 0.1


SMALL = 0.55 * R
FOR_SMALL = "surface ground upper spacing 0.9"


@pytest.mark.parametrize("angle", [45, 60, 75])
def test_slope_is_tight_for_balls_smaller_than_its_own(tmp_path, angle):
    """The fix looks at the balls that there are."""
    assert depth_below_slope(tmp_path, angle, FOR_SMALL, SMALL) < 0.1
    assert "WARNING: Fix wall/gran/balls" not in (tmp_path / "log.deck").read_text()


def test_slope_for_equal_balls_leaks_smaller_ones_and_says_so(tmp_path):
    assert depth_below_slope(tmp_path, 60, FOR_SMALL + f" smallest {2 * R}", SMALL) > 2.0
    assert "balls of diameter 0.55 may pass between these" in (tmp_path / "log.deck").read_text()


@pytest.mark.parametrize("angle", [65, 80])
def test_plan_grid_alone_leaks(tmp_path, angle):
    (tmp_path / "nodes.xyz").write_text(plan_nodes(angle))
    assert depth_below_slope(tmp_path, angle, "file nodes.xyz") > 2.0


def test_plan_spacing_is_kept_below_45_degrees(tmp_path):
    depth_below_slope(tmp_path, 45, SURFACE)
    lines = [line for line in (tmp_path / "fixed.xyz").read_text().splitlines() if not line.startswith("#")]
    assert len(lines) == 31 * 11


def test_vertical_step_is_tight(tmp_path):
    """A step of 10 m between two cells: balls are pressed against its face."""
    heights = numpy.full((20, 60), 10.0)
    heights[:, 30:] = 0.0
    write_asc(tmp_path / "ground.asc", heights, cell=0.5)
    places = [(17.3 + 0.1 * (k % 3), 0.8 + 1.05 * k, z) for k in range(8) for z in (1.5, 4.0, 6.5, 9.0)]
    write_balls(tmp_path / "balls.data", places)
    deck = DECK.format(balls=SURFACE, gx=-1.0, gz=-0.05)
    run_deck(deck, tmp_path)
    end = last_places(tmp_path)
    pressed = end[(end[:, 1] > 0.5) & (end[:, 1] < 9.5) & (end[:, 2] < 9.0)]
    assert len(pressed) >= 10
    # nodes at x 14, 15 and 16 turn the cliff at 15 into a face from 14 (top) to 16 (foot)
    assert pressed[:, 0].min() > 14.0
