"""What the maps and the section of a report share: the ground before and after, where the mass was, what is shown."""
import functools
import math

import numpy as np
from scipy.ndimage import distance_transform_edt, label
from shapely.geometry import LineString, box

from .. import geometry
from ..drawing import maps
from ..errors import SlopeError
from ..mobility import body, known, steeper
from ..survey.resampling import sample
from . import known_reach, obstacles

TALLEST, FLATTEST = 0.7, 0.22       # height / width of a map, where the terrain is large enough


class Ground:
    """Arrays of cells, rows from the north.

    x, y: of the centres (local m); before: ground before (m); base: without the body; slip_depth: between the two;
    arrival (s), max_thickness (m), max_speed (m/s) of the shown run; release: mask of cells that held the mass at the
    start; touched: mask of cells that the mass ever touched, in any of the runs that are drawn; obstacles: structures
    and control lines.
    """

    def __init__(self, data):
        run = data.result
        self.raster, self.base, self.cell = run.deposit.raster, run.deposit.base, run.deposit.cell
        rows, columns = self.base.shape
        self.x, self.y = self.raster.transform @ np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
        self.before, self.slip_depth = body.find_ground_before(self.raster, self.base, run.terrain_path)
        self.arrival, self.max_thickness = run.raster("arrival"), run.raster("max_thickness")
        self.max_speed = run.raster("max_speed")
        # balls larger than the cells leave holes between them
        side = (run.summary["volume"]["released"] / run.summary["balls"]["released"]) ** (1 / 3)
        self.release = closed(self.arrival == 0, math.ceil(side / self.cell / 2))
        self.touched = self.max_thickness > 0
        for other in data.drawn:
            self.touched = self.touched | (other.thickness > 0)
        self.obstacles = obstacles.find_obstacles(run)
        named = data.study.study.body if data.study else None
        self.mapped, self.site = data.mapped, named and data.folder / named
        self.volume = data.largest_release()
        self.events = {"confined": "unknown", **(data.study.study.known if data.study else {})}
        if not self.touched.any():
            raise SlopeError(f"{run.prefix}.max_thickness.asc", "must have a cell that the mass ever touched")

    @functools.cached_property
    def known(self) -> known.Known:
        """The mass among known events."""
        return known.among_events(self.site, self.make_body, self.events)

    def make_body(self) -> body.Body:
        """That of the shown run, on its grid."""
        return body.of_arrays(self.raster._replace(z=self.before), self.slip_depth, "the run")

    @functools.cached_property
    def below(self) -> steeper.Below:
        """The slope below the body; SlopeError for one on level ground."""
        return steeper.below(self.make_body())

    @functools.cached_property
    def reach(self) -> known_reach.KnownReach:
        """How far known events go; nothing where the mass has no fall path."""
        found = self.known.found
        return known_reach.of_mobility(found.decides) if found else known_reach.NOTHING

    @property
    def source(self):
        """Mask of the release and the scar: where the mass was, not where it went."""
        return self.release | (self.slip_depth > 0)

    @property
    def extent(self):
        return geometry.extent(self.raster)

    @functools.cached_property
    def beside(self):
        """Mask of the cells that are nearer to another body than to the largest, whose the section is."""
        return beside_largest(self.slip_depth, self.release)

    def along(self, values, x, y):
        """Values of cells at points, NaN outside."""
        return sample(self.raster._replace(z=values), x, y)

    def boxes(self):
        """Local xlo, ylo, xhi, yhi of what the mass touched, and of what else is shown and not far from it."""
        boxes = [geometry.extent_of(self.raster.transform, self.touched if self.mapped is None else
                                    self.touched | (self.mapped.share > 0))]
        far = max(boxes[0][2] - boxes[0][0], boxes[0][3] - boxes[0][1])
        near = geometry.box_of(self.raster).intersection(box(*boxes[0]).buffer(far))
        for one in (*self.obstacles.footprints.values(), *map(LineString, self.obstacles.lines.values()),
                    *(LineString(mark.ends) for mark in self.reach.marks)):
            part = one.intersection(near)
            boxes += [] if part.is_empty else [part.bounds]
        return boxes

    def window(self, *boxes):
        """The part of the terrain that a map shows: the boxes and some room, of a shape that is good to print."""
        xlo, ylo, xhi, yhi = maps.window(self.raster, *boxes)
        whole = self.extent
        more = (yhi - ylo) / TALLEST - (xhi - xlo)
        if more > 0:
            xlo, xhi = max(whole[0], xlo - more / 2), min(whole[2], xhi + more / 2)
        more = FLATTEST * (xhi - xlo) - (yhi - ylo)
        if more > 0:
            ylo, yhi = max(whole[1], ylo - more / 2), min(whole[3], yhi + more / 2)
        return xlo, ylo, xhi, yhi


def beside_largest(depth, release):
    """Mask of the cells that are nearer to another body, of a depth (m), than to the one of the largest volume.

    release: mask of the cells where balls start; hollows without any are no body.
    """
    parts, count = label(depth > 0, np.ones((3, 3)))
    if count < 2:
        return np.zeros(parts.shape, bool)
    nearest = distance_transform_edt(parts == 0, return_distances=False, return_indices=True)
    volume = np.bincount(parts.ravel(), depth.ravel())
    started = np.isin(np.arange(count + 1), parts[release & (parts > 0)])
    return parts[tuple(nearest)] != np.argmax(np.where(started, volume, 0.0) if started.any() else volume)


def closed(mask, cells):
    """The mask with gaps of up to 2 x cells filled: grown by so many cells, and shrunk again."""
    mask = np.pad(mask, cells)
    for _ in range(2):
        grown = mask.copy()
        for down in range(-cells, cells + 1):
            for right in range(-cells, cells + 1):
                grown |= np.roll(mask, (down, right), (0, 1))
        mask = ~grown
    return mask[cells:-cells, cells:-cells]
