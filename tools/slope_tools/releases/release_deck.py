"""The lines of a deck for a body between two terrains: regions, balls, walls, deposit."""
import math
from typing import NamedTuple, Tuple

from ..case.decks import quoted
from ..digits import rounded
from . import packing

BALLS = 20000       # that the suggested diameter makes of the body


class Body(NamedTuple):
    """What the lines need to know; lengths in m, local coordinates."""
    terrain: str            # file of the ground, as the deck finds it
    slip: str               # file of the ground without the body
    output: str             # prefix of the deposit's files
    volume: float           # m3
    cell: float             # of the terrain
    lower: float            # the slip surface's lowest height is so far below the terrain's, >= 0
    box: Tuple[float, float, float, float, float, float]    # xlo xhi ylo yhi zlo zhi of the body
    thick: float            # largest, vertical


def make_deck_lines(body: Body) -> str:
    """The lines, in the order in which a deck needs them; all of it but the contact model and the loading."""
    box = " ".join(f"{value:.10g}" for value in body.box)
    bottom = math.ceil(body.lower)
    return f"""\
# Lines of a deck that release the body, {rounded(body.volume)} m3, in their order, for lmp in the folder of this file

# --- geometry ---

variable    d index {float(f'{packing.compute_diameter(body.volume, BALLS):.2g}'):g}       # diameter of the balls, m
variable    bottom equal {bottom}+10*v_d    # of the ground below its lowest height, and room above the highest
region      ground terrain {quoted(body.terrain)} depth ${{bottom}} headroom ${{bottom}}
region      base terrain {quoted(body.slip)} depth ${{bottom}} headroom ${{bottom}}    # without the body
region      above terrain {quoted(body.slip)} depth ${{bottom}} headroom ${{bottom}} side out
region      around block {box} units box    # of the body: shortens searches
region      slip intersect 3 ground above around    # the body that is released

create_box  3 ground    # 1 soil, 2 slip surface, 3 field
create_balls 1 ${{d}} 2977 fill slip
group       soil type 1

# --- contact model: pair_style gran/restitution, pair_coeff 1 1, 1 2 and 1 3 come here ---

variable    half equal v_d/2
# one surface, the ground without the body
fix         slip soil wall/gran/balls 2 ${{d}} surface base upper spacing ${{half}} sink ${{d}} inside slip
fix         field soil wall/gran/balls 3 ${{d}} surface base upper spacing ${{d}} sink ${{d}} outside slip
delete_balls soil overlap 0.0

# --- output; loading and time step of the deck ---

fix         deposit soil deposit/grid 100 0 cell {body.cell:.10g} terrain base output {quoted(body.output)} &
            bulk region slip
"""
