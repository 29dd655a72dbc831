"""What became of each block of a run: where it began and ended, what it had at each line and at the road."""
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, NamedTuple, Optional, Sequence

import numpy as np
from shapely.geometry import LineString, Point

from ..case import run_folders
from ..deposits import dumps, road_sides
from ..sites.site_choices import Folder
from ..sites.site_folder import BODY, TERRAIN
from ..sites.site_roads import ROAD
from ..sites.site_sections import OfBlocks
from ..survey import polygons, rasters, roads
from ..survey.rasters import Raster
from ..tables.structures import table_of
from . import ditch
from .edges import EDGE, Edges, find_edges, touched

PREFIX = "site"         # of a run's files: out of the deck
AT_ROAD = "road"        # the name of its near edge among the lines
QUANTITIES = {"energy": "J", "speed": "m/s", "height": "m"}     # at a line
CROSSING = "ball", "direction", "x", "y", *QUANTITIES      # columns of a line's file
SLOW = 0.05             # m/s: slow of the deck
Columns = Dict[str, np.ndarray]


class Terrain(NamedTuple):
    """Of all runs of a site."""
    raster: Raster
    down: np.ndarray                    # x y, unit vector of the fall line
    road: Optional[roads.Road]
    sides: Optional[road_sides.Sides]   # of what touches it
    edges: Edges                        # of what touches it, at which runs count
    lines: Dict[str, LineString]        # the control lines by name


@dataclass(frozen=True)
class Run:
    """A run, arrays by block."""
    name: str
    folder: Path
    rolling: str
    ground: int
    diameter: np.ndarray    # m
    start: np.ndarray       # x y z
    end: np.ndarray         # x y; of one that left the terrain, where it did
    left: np.ndarray        # bool, also the next four
    moving: np.ndarray      # at the end of the run
    reached: np.ndarray     # the road
    passed: np.ndarray
    behind: np.ndarray      # bool: the road, of those that left the terrain before it
    ahead: Columns          # {line: of those that left the terrain, which may come to it beyond}
    at: Dict[str, Columns]  # {line: {quantity: the largest of a block, NaN of one that does not come there}}
    travel: Columns         # m, in plan: distance from start to end; along and across the fall line; beyond the foot
    ditch: np.ndarray       # m, from the slope's foot to the road, NaN of a block whose way does not lead to it
    overlap: float          # the deepest of a contact, in radii


def terrain_of(site: Folder[OfBlocks]) -> Terrain:
    """What all runs of a site share."""
    raster, road, sides, edges = rasters.read_asc_local(site.folder / TERRAIN), None, None, {}
    names = [Path(name) for name in site.found.files if name.endswith(".csv")]
    lines = {one.stem: LineString(np.loadtxt(site.folder / one, delimiter=",")) for one in names
             if (site.folder / one).read_text(encoding="utf-8").startswith("# control line")}
    if site.choices.road.file:
        road = roads.read_local(site.folder / ROAD, raster, site.choices.road.asked, True)
        text = (site.folder / "blocks.1.data").read_text(encoding="ascii").split("sphere\n")[1]
        columns, rows = ~raster.transform @ np.loadtxt(text.splitlines(), ndmin=2)[:, 4:6].T
        starts = np.zeros(raster.z.shape, bool)
        starts[rows.astype(int), columns.astype(int)] = True
        largest_block = site.choices.blocks.size[-1]
        sides = road_sides.divide(touched(road.polygon, largest_block, raster), road.line, raster, starts)
        release = polygons.read_local(site.folder / f"{BODY}.csv", raster, True)
        edges = find_edges(road.polygon, release, largest_block, raster, site.folder / ROAD, "release area")
    down = np.array(site.found.down[:2])
    return Terrain(raster, down / np.hypot(*down), road, sides, edges, lines)


def read_block_run(name: str, folder: Path, chosen: Dict[str, str], terrain: Terrain) -> Run:
    """A finished run."""
    prefix = folder / PREFIX
    summary = run_folders.load_summary(f"{prefix}.summary.yaml")
    (_, first), (heads, last) = (dumps.frames(folder / f"{when}.dump")[0] for when in ("start", "end"))
    diameter, end, left = first[:, 1], first[:, 2:4].copy(), np.ones(len(first), bool)
    moving, reached, passed, behind = np.zeros((4, len(first)), bool)
    gone, there = table_of(Path(f"{prefix}.left.csv"), ("ball", "x", "y")), last[:, 0].astype(int) - 1
    left[there] = False
    end[there] = last[:, 1:3]
    end[gone["ball"].astype(int) - 1] = np.column_stack([gone["x"], gone["y"]])
    left[gone["ball"].astype(int) - 1] = True
    if "halt" not in str(summary["stop"]["reason"]):
        moving[there] = np.linalg.norm(last[:, heads.index("vx"):heads.index("vx") + 3], axis=1) > SLOW
    at = {line: find_largest_crossings(table_of(Path(f"{prefix}.{line}.line.csv"), CROSSING), diameter) for line
          in terrain.lines}
    start = first[:, 2:4]
    ahead = {line: spread_over_blocks(left, road_sides.not_behind(start[left], end[left], one))
             for line, one in terrain.lines.items()}
    if terrain.sides:
        parts = [table_of(path, CROSSING) for path in sorted(folder.glob(f"{PREFIX}.{EDGE}_*.line.csv"))]
        crossed = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
        at[AT_ROAD] = find_largest_crossings({key: value[crossed["direction"] > 0] for key, value in crossed.items()},
                                             diameter)
        reached = np.isfinite(at[AT_ROAD]["energy"])
        passed = reached & beyond_road(crossed, end, terrain.sides)
        part = terrain.sides.of_places(end[left])
        ahead[AT_ROAD] = spread_over_blocks(left, (part == road_sides.ON) |
                                            terrain.sides.ahead_of(start[left], end[left], part))
        behind = spread_over_blocks(left, part == road_sides.BEFORE) & ~ahead[AT_ROAD]
    way, feet = end - start, ditch.feet(terrain.raster, start, end, terrain.down,
                                        terrain.road and terrain.road.polygon)
    travel = {"distance": np.hypot(*way.T), "along": way @ terrain.down,
              "across": way @ np.array([-terrain.down[1], terrain.down[0]]), "beyond_foot": feet.beyond}
    return Run(name, folder, chosen["rolling"], int(chosen["ground"]), diameter, first[:, 2:5], end, left, moving,
               reached, passed, behind, ahead, at, travel, feet.road, float(summary["guards"]["largest_overlap"]))


def find_farthest_run(runs: Sequence[Run]) -> Run:
    """The run that has the block that travels farthest."""
    return max(runs, key=lambda run: run.travel["distance"].max())


def find_largest_crossings(crossings: Columns, diameter: np.ndarray) -> Columns:
    """By block, of all its crossings; the height is that of its lower edge above the terrain."""
    block = crossings["ball"].astype(int) - 1
    values = {**crossings, "height": crossings["height"] - diameter[block] / 2}
    found = {name: np.full(len(diameter), np.nan) for name in QUANTITIES}
    for name, most in found.items():
        np.fmax.at(most, block, values[name])
    return found


def beyond_road(crossed: Columns, end: np.ndarray, sides: road_sides.Sides) -> np.ndarray:
    """Whether a block ended beyond the road, or left it there at any time."""
    found = sides.of_places(end) == road_sides.PAST
    for x, y, block in zip(*(crossed[key][crossed["direction"] < 0] for key in ("x", "y", "ball"))):
        place = Point(x, y)
        found[int(block) - 1] |= sides.past.distance(place) < sides.before.distance(place)
    return found


def spread_over_blocks(left: np.ndarray, values: np.ndarray) -> np.ndarray:
    """What was found of those that left the terrain, of all blocks."""
    every = np.zeros(len(left), bool)
    every[left] = values
    return every
