"""The section of a report: along which line, the heights on it, its picture and its table."""
import csv
import io
import math
from pathlib import Path
from typing import Union

import numpy as np
from scipy.ndimage import label
from shapely.geometry import LineString, Point, box

from .. import geometry
from ..deposits import cut, flow_path
from ..errors import SlopeError
from ..options import parse_number
from ..survey import lines
from . import figure_charts, known_reach, obstacles

FALL = "fall"           # --section fall
NEAR = 0.04             # of its length: a path that is no farther from the fall line is shown by that
MOST_BENDS = 8          # that are marked on the picture


class Section:
    """A line across the terrain, from A to A': points (local m), and what line it is."""

    def __init__(self, data, ground, asked, local):
        self.data, self.ground = data, ground
        self.asked = bool(asked)
        self.points, self.how = self._line(asked, local)
        self.line = LineString(self.points)
        self.bends = [self.line.project(Point(point)) for point in self.points[1:-1]] \
            if self.asked and len(self.points) - 2 <= MOST_BENDS else []
        self.s, self.xy, self.before, self.base, self.runs = self._profile()

    # --- which line ---

    def _line(self, asked, local):
        bounds = self.ground.extent
        if not asked:
            return self._default()
        if asked == [FALL]:
            return self._fall_line(), self._straight()
        if len(asked) == 4:
            try:
                points = np.reshape([parse_number(value) for value in asked], (2, 2))
            except Exception as error:
                raise SlopeError("--section", "must be X1 Y1 X2 Y2 (finite numbers, local m), the file of a line, or "
                                 f"{FALL}", " ".join(asked)) from error
            where: Union[str, Path] = "--section"
            how = "as --section asked"
            if (points[0] == points[1]).all():
                raise SlopeError("--section", "must have two different ends", " ".join(f"{v:g}" for v in points.flat))
        elif len(asked) == 1:
            where, how = Path(asked[0]), f"along the line of {Path(asked[0]).name}"
            raster = self.ground.raster
            found = lines.read_local(where, raster, local or raster.crs is None, "section")
            if len(found.geoms) != 1:
                raise SlopeError(where, "must hold one line, for --section", f"{len(found.geoms)} lines")
            points = np.asarray(found.geoms[0].coords)
            points = points[np.concatenate([[True], (np.diff(points, axis=0) != 0).any(axis=1)])]
        else:
            raise SlopeError("--section", f"must be X1 Y1 X2 Y2, the file of a line, or {FALL}", " ".join(asked))
        if not LineString(points).intersection(box(*bounds)).length > 0:
            got = " ".join(f"{v:g}" for v in points.flat) if len(points) == 2 else \
                geometry.format_numbers(LineString(points).bounds)
            raise SlopeError(where, f"must cross the grid of the run, {geometry.format_numbers(bounds)} (local metres)",
                             got)
        return points, how

    def _default(self):
        """The path of the mass, or the fall line where that is about the same."""
        fall = self._fall_line()
        path = flow_path.path(self.data.result, self.ground)
        straight = self._to_road(fall), self._straight()
        if path is None:
            return straight
        length = LineString(path.points).length
        line = LineString(fall)
        off = max(line.distance(Point(point)) for point in path.points)
        if off <= max(NEAR * length, 2.5 * self.ground.cell):
            return straight
        points = self._to_road(self._continued(path.points, 0.06 * length + 2 * self.ground.cell))
        if self._westward(points[-1] - points[0]):
            points = points[::-1]
        how = "along the path of the centroid" if path.dumped else "along the middle of the flow"
        how += " of the largest body" * bool(self._others().any())
        return points, f"{how}, straight on through the scar and the rest of the deposit"

    def _others(self):
        """Mask of the bodies beside the largest."""
        return self.ground.source & self.ground.beside

    def _straight(self):
        """What the fall line is."""
        body = "largest body" if self._others().any() else "released mass"
        return f"through the centroid of the {body}, along its mean fall line"

    def _westward(self, way):
        return way[np.argmax(np.abs(way))] < 0

    def _continued(self, points, room):
        """The line, straight on at both ends to the last of release and deposit there, and some room."""
        ends = []
        held_at = (self.ground.source | (self.data.result.thickness > 0)).astype(float)
        for point, before in ((points[0], points[1]), (points[-1], points[-2])):
            way = (point - before) / np.hypot(*(point - before))
            most = max(0.0, inside(point, way, self.ground.extent)[1])
            steps = np.arange(0, most, self.ground.cell / 2)
            places = point[:, None] + way[:, None] * steps
            held = np.nan_to_num(self.ground.along(held_at, *places)) > 0.5
            far = steps[held][-1] if held.any() else 0.0
            ends.append(point + min(far + room, most) * way)
        return np.concatenate([ends[:1], points, ends[1:]])

    def _to_road(self, points):
        """The line, straight on to the far side of the road ahead, if that is no farther away than the line is long."""
        road = self.data.road
        line = LineString(points)
        if road is None or not (line.disjoint(road) or any(road.intersects(Point(end)) for end in points[[0, -1]])):
            return points
        room = 0.04 * line.length + 2 * self.ground.cell
        ways = []
        for end, before in ((0, 1), (-1, -2)):
            way = (points[end] - points[before]) / np.hypot(*(points[end] - points[before]))
            most = max(0.0, inside(points[end], way, self.ground.extent)[1])
            ahead = LineString([points[end], points[end] + most * way]).intersection(road)
            if not ahead.is_empty and ahead.distance(Point(points[end])) <= line.length:
                far = np.hypot(*(geometry.coordinates(ahead) - points[end]).T).max()
                ways.append((ahead.distance(Point(points[end])), end, points[end] + min(far + room, most) * way))
        if not ways:
            return points
        _, end, place = min(ways, key=lambda way: way[0])
        return np.concatenate([[place], points[1:]] if end == 0 else [points[:-1], [place]])

    def _fall_line(self):
        """Both ends, west or south end first."""
        ground, touched = self.ground, self.ground.touched & ~self._others()
        release = ground.release & ~self._others() if ground.release.any() else touched
        parts, _ = label(touched, np.ones((3, 3)))
        mine = touched & np.isin(parts, parts[release & touched])       # not what another body went over elsewhere
        touched = mine if mine.any() else touched
        weight = np.where(release, np.where(ground.slip_depth > 0, ground.slip_depth, 1e-3), 0)
        centre = np.array([(ground.x * weight).sum(), (ground.y * weight).sum()]) / weight.sum()
        south, east = np.gradient(ground.before, ground.cell)
        steep = release & np.isfinite(south) & np.isfinite(east)
        way = np.array([-east[steep].mean(), south[steep].mean()]) if steep.any() else np.zeros(2)
        if np.hypot(*way) < 1e-3:       # no slope: to where the mass went
            volume = self.data.result.thickness
            way = np.array([(ground.x * volume).sum(), (ground.y * volume).sum()]) / max(volume.sum(), 1e-30) - centre
        way = way / np.hypot(*way) if np.hypot(*way) > 1e-6 else np.array([1.0, 0.0])
        if self._westward(way):
            way = -way
        along = (ground.x[touched] - centre[0]) * way[0] + (ground.y[touched] - centre[1]) * way[1]
        room = 0.12 * np.ptp(along) + 2 * ground.cell
        low, high = inside(centre, way, ground.extent)
        return np.array([centre + max(along.min() - room, low) * way, centre + min(along.max() + room, high) * way])

    # --- what is on it ---

    def _profile(self):
        """Distance; x, y; ground before; base; (name, surface, thickness) of each drawn run, the shown one first."""
        length, cell = self.line.length, self.ground.cell
        count = min(max(int(math.ceil(2 * length / cell)), 50), 2000) + 1
        s = np.linspace(0, length, count)
        xy = np.array([self.line.interpolate(at).coords[0] for at in s])

        def along(values):
            return self.ground.along(values, *xy.T)

        base = along(self.ground.base)
        known = np.flatnonzero(np.isfinite(base))
        if not len(known):
            raise SlopeError("--section", "must cross cells whose ground is known")
        part = slice(known[0], known[-1] + 1)       # ends without ground are left out
        s, xy, base = s[part], xy[part], base[part]
        runs = []
        for one in sorted(self.data.drawn, key=lambda run: run is not self.data.result):
            thickness = np.nan_to_num(along(one.thickness))
            runs.append((self.data.label(one), along(one.deposit.base) + thickness, thickness))
        return s, xy, along(self.ground.before), base, runs

    def road(self):
        """Where the line crosses the road, list of (from, to), and the height of the cut above it at every point."""
        road = self.data.road
        spans = []
        for part in lines.lines_of(self.line.intersection(road)).geoms:
            spans.append(sorted(self.line.project(Point(end)) for end in (part.coords[0], part.coords[-1])))
        tangent = math.tan(math.radians(self.data.of_study.study.the_road["cut_angle"]))
        raster = self.ground.raster
        inside = geometry.to_index(geometry.as_multi(road.intersection(geometry.box_of(raster))), raster)
        return spans, cut.heights(inside, cut.Ground(self.ground.base), tangent * self.ground.cell,
                                  *(~raster.transform @ tuple(self.xy.T)))

    def _where_it_cuts(self, height):
        """The cut surface on the ground that it takes away from the shown run; None where that is nowhere."""
        if height is None:
            return None
        _, surface, thickness = self.runs[0]
        with np.errstate(invalid="ignore"):
            cuts = (thickness > 0) & (height < surface)
        return np.where(cuts, height, np.nan) if cuts.any() else None

    def walls(self):
        """Where the line cuts the structures: pieces (k, 2, 2) of (distance, height)."""
        found = [obstacles.section_of(corners, self.points) for corners in self.ground.obstacles.walls.values()]
        return np.concatenate([np.zeros((0, 2, 2)), *found])

    def crossings(self):
        """Distances at which the line crosses control lines."""
        found = [self.line.intersection(LineString(points)) for points in self.ground.obstacles.lines.values()]
        return sorted(self.line.project(Point(place)) for one in found for place in geometry.coordinates(one))

    def marks(self):
        """(share, distance) of the marks of known events that are not far beside the line."""
        return [(mark.share, at) for mark, at in known_reach.on_line(self.ground.reach, self.line)]

    def picture(self):
        """The picture's data URI, what it shows, and its caption."""
        spans, height = self.road() if self.data.road is not None else ([], None)
        uri, factor, thickness_factor = figure_charts.draw_section(
            self.s, self.before, self.base, self.runs, spans, self._where_it_cuts(height), "Section A-A'", self.bends,
            self.walls(), self.crossings(), self.marks())
        (x1, y1), (x2, y2) = self.points[0], self.points[-1]
        caption = (f"Section from A ({x1:.1f}, {y1:.1f}) to A' ({x2:.1f}, {y2:.1f}), local metres, {self.how}; "
                   + ("heights not exaggerated" if factor == 1 else f"heights exaggerated {factor:g} times"))
        if thickness_factor:
            caption += (f"; below, the thickness on a scale of its own, exaggerated {thickness_factor:g} times, "
                        "because it would not show at the scale of the heights")
        if self._where_it_cuts(height) is not None:
            caption += (f"; cut surface rising at {self.data.of_study.study.the_road['cut_angle']:g} degrees from the "
                        "road's edges")
        return uri, "Section through the slope before and after", caption + "."

    def table(self):
        """The section as CSV."""
        east, north = self.ground.raster.offset
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        placed = self.ground.raster.crs is not None
        writer.writerow(["distance", "x", "y", *(["east", "north"] if placed else []), "ground_before", "base"]
                        + [f"{what} {name}" for name, *_ in self.runs for what in ("surface", "thickness")])
        for i, (x, y) in enumerate(self.xy):
            values = [self.s[i], x, y] + ([x + east, y + north] if placed else [])
            values += [self.before[i], self.base[i]] + [value for _, surface, thickness in self.runs
                                                        for value in (surface[i], thickness[i])]
            writer.writerow("" if math.isnan(value) else f"{value:.4f}" for value in values)
        return text.getvalue()


def inside(point, way, bounds):
    """Range of t for which point + t way lies within bounds; the point does."""
    low, high = -math.inf, math.inf
    for value, step, least, most in zip(point, way, bounds[:2], bounds[2:]):
        if abs(step) > 1e-12:
            ends = sorted(((least - value) / step, (most - value) / step))
            low, high = max(low, ends[0]), min(high, ends[1])
    return low, high
