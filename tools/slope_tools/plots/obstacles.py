"""Structures and control lines of a run, as maps and section show them."""
from pathlib import Path
from typing import Dict, NamedTuple

import numpy as np
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from ..tables import structures

FLAT = 1e-9         # of the largest triangle in plan: smaller ones are upright


class Obstacles(NamedTuple):
    """By name: corners of the triangles (n, 3, 3) of structures, points of control lines, rows of x y; local metres."""
    walls: Dict[str, np.ndarray]
    lines: Dict[str, np.ndarray]

    @property
    def footprints(self) -> Dict[str, BaseGeometry]:
        return {name: footprint(corners) for name, corners in self.walls.items() if len(corners)}


def find_obstacles(run) -> Obstacles:
    """Those of a data.Result."""
    folder = Path(run.folder)
    walls = {name: structures.polydata(folder / f"{prefix}.vtp")[0]
             for name, prefix in structures.outputs(run.log.settings, "wall/gran/mesh").items()}
    files = {words[1]: folder / words[4] for words in map(str.split, run.log.settings)
             if words[0] == "fix" and words[3:4] == ["control/line"] and len(words) > 4}
    return Obstacles(walls, {name: read_line_points(path) for name, path in files.items() if path.is_file()})


def read_line_points(path: Path) -> np.ndarray:
    """Points of a control line, rows of x y: the file that the fix read."""
    rows = (line.replace(",", " ") for line in path.read_text(encoding="utf-8").splitlines())
    return np.loadtxt(rows, comments="#", ndmin=2, usecols=(0, 1))


def footprint(corners: np.ndarray) -> BaseGeometry:
    """What a structure covers in plan: polygons, or lines where it is upright."""
    plan = corners[..., :2]
    one, other = plan[:, 1] - plan[:, 0], plan[:, 2] - plan[:, 0]
    size = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    closed = np.concatenate([plan, plan[:, :1]], axis=1)
    lying = size > FLAT * max(size.max(), 1e-30)
    if size.max() > 1e-6 and lying.any():
        return unary_union([Polygon(ring) for ring in closed[lying]])
    return unary_union([LineString(ring) for ring in closed])


def section_of(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Where the vertical plane over a line (rows of x y) cuts triangles: (k, 2, 2), ends of pieces as (s, z)."""
    crossings, start = [], 0.0
    for a, b in zip(points[:-1], points[1:]):
        length = float(np.hypot(*(b - a)))
        along = (b - a) / length
        s = (corners[..., :2] - a) @ along
        off = (corners[..., :2] - a) @ np.array([-along[1], along[0]])
        for k in np.flatnonzero((off.min(axis=1) <= 0) & (off.max(axis=1) >= 0)):
            ends = []
            for i, j in ((0, 1), (1, 2), (2, 0)):
                if (off[k, i] <= 0) != (off[k, j] <= 0):
                    share = off[k, i] / (off[k, i] - off[k, j])
                    ends.append((s[k, i] + share * (s[k, j] - s[k, i]),
                                 corners[k, i, 2] + share * (corners[k, j, 2] - corners[k, i, 2])))
            if len(ends) == 2 and 0 <= max(one[0] for one in ends) and min(one[0] for one in ends) <= length:
                crossings.append([(start + at, z) for at, z in ends])
        start += length
    return np.array(crossings).reshape(-1, 2, 2)
