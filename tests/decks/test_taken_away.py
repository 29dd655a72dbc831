"""What a deck takes away from a style that still needs it: one line, where freed memory was read."""

import numpy
import pytest
from deck_helpers import run_deck, write_asc

DECK = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region ground terrain ground.asc depth 2 headroom 6
region all block 0 16 0 16 -2 6
create_box 2 all
lattice sc 1.0
region soil block 6 7.5 6 7.5 2 4
create_atoms 1 region soil
set group all diameter 0.9 density 2000
neighbor 0.2 bin
pair_style gran/restitution
pair_coeff * * stiffness 1e6 1e6 restitution 0.5 friction 30
{fixes}
fix move all nve/sphere
velocity all set 5 0 0
timestep 1e-3
{run}
"""
BALLS = "fix balls all wall/gran/balls 2 1.0 surface ground upper spacing 1.0"
OUTSIDE = """region pit sphere 12 12 0 2
fix balls all wall/gran/balls 2 1.0 surface ground upper spacing 1.0 outside pit"""
LINE = """fix dep all deposit/grid 100 0 cell 1 terrain ground output out bulk 1.5
fix line all control/line line.csv output out"""
REGION = "Fix wall/gran/balls balls: region {} must not change after these balls are defined"
KEPT = "Pair gran/restitution: fix {} must not be removed"


@pytest.mark.parametrize("fixes, run, message", [
    (BALLS, "run 0\nregion ground delete\nwrite_restart at.restart noinit", REGION.format("ground")),
    (BALLS, "region ground delete\nwrite_restart at.restart noinit", REGION.format("ground")),
    (OUTSIDE, "run 0\nregion pit delete\nwrite_restart at.restart noinit", REGION.format("pit")),
    (BALLS, "run 0\nregion ground delete\nprint $(f_balls)\nrun 0", REGION.format("ground")),
    (OUTSIDE, "region pit delete\nregion pit sphere 12 12 0 3\nrun 1", REGION.format("pit")),
    (LINE, "run 1\nregion ground delete\nrun 2000 pre no", "region ground must not change"),
    (LINE, "run 1\nunfix dep\nrun 2000", "Fix control/line line needs deposit ID"),
    ("", "run 1\nunfix NEIGH_HISTORY_SLOPE0\nrun 1", KEPT.format("NEIGH_HISTORY_SLOPE0")),
    ("", "unfix NEIGH_HISTORY_SLOPE_DUMMY0\nrun 1", KEPT.format("NEIGH_HISTORY_SLOPE_DUMMY0")),
])
def test_one_line(tmp_path, fixes, run, message):
    write_asc(tmp_path / "ground.asc", numpy.zeros((16, 16)))
    (tmp_path / "line.csv").write_text("10,0\n10,16\n")
    run_deck(DECK.format(fixes=fixes, run=run), tmp_path, expect_error=message)
