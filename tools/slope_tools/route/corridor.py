"""The corridor of a road: its axis on the terrain, parts of the terrain, the windows of the searches."""
import math
from pathlib import Path
from typing import Iterator, NamedTuple, Tuple

import numpy as np
from affine import Affine
from shapely.geometry import LineString, Point, box
from shapely.geometry.base import BaseGeometry
from shapely.ops import substring

from .. import disk, geometry
from ..survey import local_terrain, rasters, roads
from ..survey.rasters import Raster
from .choices import Choices

TERRAIN = "terrain.asc"
ROAD = "road.csv"
EDGE = 3            # cells beside a window, which no body reaches


class Window(NamedTuple):
    """Cells of the terrain: the first row and column, and those after the last."""
    top: int
    left: int
    bottom: int
    right: int

    @property
    def part(self) -> Tuple[slice, slice]:
        return slice(self.top, self.bottom), slice(self.left, self.right)

    def common(self, other: "Window") -> "Window":
        return Window(max(self.top, other.top), max(self.left, other.left), min(self.bottom, other.bottom),
                      min(self.right, other.right))

    def inside(self, whole: "Window") -> Tuple[slice, slice]:
        """Where its cells are in an array of the cells of another one."""
        return (slice(self.top - whole.top, self.bottom - whole.top),
                slice(self.left - whole.left, self.right - whole.left))

    @property
    def empty(self) -> bool:
        return self.bottom <= self.top or self.right <= self.left


class Corridor(NamedTuple):
    """In local metres of the terrain."""
    raster: Raster
    axis: LineString
    road: BaseGeometry
    start: float            # chainage of the axis' first point, m
    reach: float            # M, to each side

    @property
    def cell(self) -> float:
        return float(self.raster.transform.a)

    def window(self, xlo: float, ylo: float, xhi: float, yhi: float) -> Window:
        """The cells that a box touches, cut to the terrain."""
        (left, top), (right, bottom) = ~self.raster.transform @ (xlo, yhi), ~self.raster.transform @ (xhi, ylo)
        rows, columns = self.raster.z.shape
        return Window(max(0, math.floor(top + 1e-6)), max(0, math.floor(left + 1e-6)),
                      min(rows, math.ceil(bottom - 1e-6)), min(columns, math.ceil(right - 1e-6)))

    def clip(self, window: Window) -> Raster:
        """A part of the terrain."""
        move = Affine.translation(window.left, window.top)
        return self.raster._replace(z=self.raster.z[window.part], transform=self.raster.transform @ move)

    def chainage(self, x: float, y: float) -> float:
        return self.start + self.axis.project(Point(x, y))


def make_corridor(choices: Choices, folder: Path, tell, warn) -> Corridor:
    """The corridor of a folder, whose terrain is written unless it is there."""
    path = folder / TERRAIN
    if not path.is_file():
        wanted = local_terrain.Wanted(choices.crs, None, choices.cell, None, choices.fill, choices.assign_crs, {},
                                      choices.z_unit, choices.nodata or (), pits=False, differ=choices.differ)
        tell(local_terrain.describe_terrain(TERRAIN, local_terrain.make_local_terrain(choices.terrain, path, wanted,
                                                                                      tell, warn)))
    return read_corridor(choices, folder, warn)


def read_corridor(choices: Choices, folder: Path, warn=roads.vectors.ignore) -> Corridor:
    raster = rasters.read_asc_local(folder / TERRAIN)
    kept = folder / ROAD        # the line as it was first read: what is beside it may have moved
    found = roads.read_local(kept if kept.is_file() else choices.road, raster, choices.asked, warn=warn,
                             instead="draw the road's axis as a line")
    assert found.line is not None       # as there is a width
    if not kept.is_file():
        write_line(kept, found.line, raster)
    return Corridor(raster, found.line, found.polygon, 1000 * choices.road_from, choices.corridor)


def write_line(path: Path, line: LineString, raster: Raster) -> None:
    """A line as text in the coordinates of the terrain's CRS, which each part of the terrain has."""
    points = np.round(np.asarray(line.coords)[:, :2] + raster.offset, 4) + 0.0
    disk.write_file(path, "# the road's axis, east,north in m\n" + "".join(f"{x!r},{y!r}\n" for x, y
                                                                           in points.tolist()))


def searches(corridor: Corridor) -> Iterator[Tuple[Window, BaseGeometry]]:
    """Windows of twice the corridor's reach along the axis, which overlap by half, and the ground of each."""
    reach, length = corridor.reach, corridor.axis.length
    for k in range(max(1, math.ceil(length / reach) - 1)):
        along = substring(corridor.axis, k * reach, min((k + 2) * reach, length))
        ground = along.buffer(reach, cap_style=2).intersection(geometry.box_of(corridor.raster))
        if not ground.is_empty:
            xlo, ylo, xhi, yhi = ground.bounds
            room = EDGE * corridor.cell
            yield corridor.window(xlo - room, ylo - room, xhi + room, yhi + room), ground


def inside(corridor: Corridor, window: Window) -> BaseGeometry:
    """A window without the cells at its edge; where that is the terrain's own edge, nothing ends there."""
    rows, columns = corridor.raster.z.shape
    xlo, ylo, xhi, yhi = geometry.extent(corridor.clip(window))
    left, bottom, right, top = (corridor.cell * (-1 if at_edge else 1) for at_edge in (
        window.left == 0, window.bottom == rows, window.right == columns, window.top == 0))
    return box(xlo + left, ylo + bottom, xhi - right, yhi - top)


def cut_window(corridor: Corridor, xlo: float, ylo: float, xhi: float, yhi: float) -> Tuple[Window, LineString, float]:
    """The ground for the runs of a body (its box): as far as the corridor reaches around it and the road below it.

    Also the road there, in one piece, and the chainage of its first point.
    """
    body, reach = box(xlo, ylo, xhi, yhi), corridor.reach
    near = corridor.axis.interpolate(corridor.axis.project(body.centroid))
    area = body.union(near.buffer(corridor.cell)).envelope.buffer(reach, join_style=2)
    whole = geometry.box_of(corridor.raster)
    while True:
        area = area.intersection(whole).envelope
        window = corridor.window(*area.bounds)
        inner = inside(corridor, window)
        ends = [corridor.axis.project(Point(point)) for part in geometry.parts_of(
            corridor.axis.intersection(inner)) for point in (part.coords[0], part.coords[-1])]
        line = substring(corridor.axis, min(ends), max(ends))
        if inner.buffer(1e-6).covers(line):
            return window, line, corridor.start + min(ends)
        area = area.union(line.buffer(2 * corridor.cell)).envelope      # the road leaves the ground and comes back
