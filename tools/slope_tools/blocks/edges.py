"""Closed control lines around the road of blocks, at which the runs count: they follow the road of the folder."""
from pathlib import Path
from typing import Dict, Optional, Union

import numpy as np
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from .. import disk
from ..digits import metres
from ..errors import SlopeError
from ..geometry import box_of, polygons_of
from ..survey.rasters import Raster

EDGE = "road_edge"      # of their names
SAME = 0.01             # m, by which two lines may differ

Edges = Dict[str, np.ndarray]       # {name: x y}


def touched(road: BaseGeometry, largest: float, raster: Raster) -> BaseGeometry:
    """Where the middle of a block is that touches a road."""
    return road.buffer(largest / 2).intersection(box_of(raster))


def find_edges(road: BaseGeometry, release: BaseGeometry, largest: float, raster: Raster,
               where: Union[str, Path] = "--release", other: str = "road") -> Edges:
    """Around the road, and around what it encloses: forward is onto it. SlopeError, of where, if blocks start on it."""
    around = touched(road, largest, raster)
    if around.intersects(release):
        raise SlopeError(where, f"must be at least half a block, {largest / 2:g} m, away from the {other}",
                         metres(release.distance(road)))
    found = {}
    parts = [orient(part, -1.0) for part in polygons_of(around)]
    for k, ring in enumerate((ring for part in parts for ring in (part.exterior, *part.interiors)), 1):
        points = np.round(np.asarray(ring.coords)[:, :2], 4) + 0.0
        found[f"{EDGE}_{k}"] = points[np.append(True, (points[1:] != points[:-1]).any(axis=1))]
    return found


def write_edges(folder: Path, edges: Edges) -> None:
    for name, points in edges.items():
        disk.write_file(folder / f"{name}.csv", "# around the road, local x,y in m; forward is onto it\n"
                        + "".join(f"{x!r},{y!r}\n" for x, y in points.tolist()))


def has_edges(folder: Path, edges: Edges) -> bool:
    """Whether those in a folder, of a site or of a run, are these."""
    paths = {path.stem: path for path in folder.glob(f"{EDGE}_*.csv")}
    return paths.keys() == edges.keys() and all(
        LineString(points).hausdorff_distance(LineString(np.loadtxt(paths[name], delimiter=","))) <= SAME
        for name, points in edges.items())


def check_number(folder: Path, edges: Edges, road: Path, source: Optional[str]) -> None:
    """Raise SlopeError unless a road, edited in the folder of a site, has as many as its deck; source: the file that
    site.yaml names."""
    had = len(list(folder.glob(f"{EDGE}_*.csv")))
    if had != len(edges):
        raise SlopeError(road, f"must have {had} edges, at which the deck counts: edit {source} instead, and `slope "
                         f"site {folder}` makes both anew", len(edges))
