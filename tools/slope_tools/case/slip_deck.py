"""The deck with find_slip that `slope stability` runs: what is asked for, and its lines."""
from pathlib import Path
from typing import Callable, List, NamedTuple, Optional, Tuple

from .decks import quoted

NAME = "in.slips"
PREFIX = "body"         # of the files of find_slip
WITHIN = "within.csv"   # the polygon, beside the deck
TABLE, BEDROCK, LAYER = "water_table.asc", "bedrock.asc", "layer.{}.asc"        # rasters there


class Strength(NamedTuple):
    cohesion: float     # Pa
    friction: float     # degrees
    density: float      # kg/m3

    def words(self) -> str:
        return " ".join(f"{value:.12g}" for value in self)


class Layer(NamedTuple):
    top: str            # raster of heights, below which the strength is this one
    strength: Strength


class Asked(NamedTuple):
    """What find_slip takes, in its units; None: its default. Rasters but the terrain are files beside the deck."""
    terrain: Path
    strength: Strength
    layers: Tuple[Layer, ...] = ()
    ratio: Optional[float] = None           # of pore pressure
    table: Optional[str] = None             # raster of the heights of the water table
    seismic: Tuple[float, float] = (0.0, 0.0)
    within: bool = False                    # the polygon in WITHIN
    volume: Optional[Tuple[float, float]] = None    # m3
    depth: Optional[Tuple[float, float]] = None     # m
    direction: Optional[float] = None       # degrees counterclockwise from +x
    method: str = "bishop"
    keep: int = 3
    shape: str = "sphere"
    bedrock: Optional[str] = None           # raster of its heights


def make_slip_deck(asked: Asked, named: Callable[[Path], str]) -> str:
    """The deck; named: how it names the terrain."""
    words: List[str] = [f"strength {asked.strength.words()}"]
    for layer in asked.layers:
        words.append(f"layer {quoted(layer.top)} {layer.strength.words()}")
    if asked.table is not None:
        words.append(f"water table {quoted(asked.table)}")
    elif asked.ratio is not None:
        words.append(f"water ru {asked.ratio:.12g}")
    if asked.bedrock is not None:
        words.append(f"bedrock {quoted(asked.bedrock)}")
    if any(asked.seismic):
        words.append("seismic {:.12g} {:.12g}".format(*asked.seismic))
    for name, limits in (("volume", asked.volume), ("depth", asked.depth)):
        if limits is not None:
            words.append("{} {:.12g} {:.12g}".format(name, *limits))
    if asked.direction is not None:
        words.append(f"direction {asked.direction:.12g}")
    if asked.within:
        words.append("within inside")
    if asked.shape != "sphere":
        words.append(f"shape {asked.shape}")
    words += [f"method {asked.method}", f"keep {asked.keep}", f"output {PREFIX}"]
    lines = ["# slip surfaces with the least factor of safety, made by slope stability", "units si",
             f"region ground terrain {quoted(named(asked.terrain))}"]
    if asked.within:
        lines.append(f"region inside polygon {WITHIN}")
    return "\n".join([*lines, "find_slip ground " + " &\n    ".join(words)]) + "\n"
